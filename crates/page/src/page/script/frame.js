// The frame around all pages: menu, language, light or dark, and the open page.

// The page that opens without a name in the address.
const HOME = document.querySelector("main").dataset.page;
let current = HOME;

function openPage() {
  const name = location.hash.slice(1).split("?")[0];
  current = Object.hasOwn(SCRIPTS, name) ? name : HOME;
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

// Writes the words of the markup in the language of the page.
function translate() {
  for (const element of document.querySelectorAll("[data-word]")) element.textContent = word(element.dataset.word);
  for (const element of document.querySelectorAll("[data-label]")) element.setAttribute("aria-label", word(element.dataset.label));
}

function showAll() {
  document.documentElement.lang = language === "zh" ? "zh-CN" : "en";
  document.documentElement.dataset.theme = theme;
  translate();
  translateMore();
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
