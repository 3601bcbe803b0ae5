// Opens pages, shows views, and starts everything.

let current = "operator";

function openPage() {
  const name = location.hash.slice(1).split("?")[0];
  current = Object.hasOwn(SCRIPTS, name) ? name : "operator";
  const shown = Object.hasOwn(PAGES, current) ? current : "fetching";
  for (const page of document.querySelectorAll("main")) page.hidden = page.dataset.page !== shown;
  for (const tab of document.querySelectorAll("nav a")) {
    const open = tab.hash === "#" + ({part: "history", rejudge: "history", tooling: "io"}[current] ?? current);
    tab.toggleAttribute("aria-current", open);
    if (open) tab.setAttribute("aria-current", "page");
  }
  showMenu(false);
  showFetching();
  PAGES[current]?.enter?.();
  showView();
}

// Shows or hides the menu of a narrow screen; wide screens show it always.
function showMenu(open) {
  document.body.classList.toggle("menu", open);
  at("menu").setAttribute("aria-expanded", open);
}

function showView() {
  showLink();
  if (!view) return;
  at("simulated").hidden = !view.simulated;
  for (const id of ["lot", "recipe"]) {
    at(id).textContent = view[id] || NONE;
    at(id).title = view[id];
  }
  showAlarmBar(view.alarms);
  showPrompt();
  sound(view.alarms);
  recordActivity();
  showOrders();
  PAGES[current]?.show?.();
}

// Writes the words of the markup in the language of the page.
function translate() {
  for (const element of document.querySelectorAll("[data-word]")) element.textContent = word(element.dataset.word);
  for (const element of document.querySelectorAll("[data-label]")) element.setAttribute("aria-label", word(element.dataset.label));
}

function showAll() {
  document.documentElement.lang = language === "zh" ? "zh-CN" : "en";
  document.documentElement.dataset.theme = theme;
  translate();
  nameBodies();
  showWho();
  openPage();
}

at("menu").addEventListener("click", () => showMenu(!document.body.classList.contains("menu")));
at("language").addEventListener("click", () => {
  language = language === "zh" ? "en" : "zh";
  // Clear the answers, which are in the other language.
  for (const element of document.querySelectorAll(".answer")) element.textContent = "";
  stored.set("lang", language);
  showAll();
});
at("theme").addEventListener("click", () => {
  theme = theme === "dark" ? "light" : "dark";
  stored.set("theme", theme);
  showAll();
});
addEventListener("hashchange", openPage);

makeOrders();
showAll();
askWho();
fetchMimic();
connect();
