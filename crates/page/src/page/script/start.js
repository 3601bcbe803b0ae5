// Which page is open, and everything begun.

let current = "operator";

function openPage() {
  const name = location.hash.slice(1).split("?")[0];
  current = Object.hasOwn(PAGES, name) ? name : "operator";
  for (const page of document.querySelectorAll("main")) page.hidden = page.dataset.page !== current;
  for (const tab of document.querySelectorAll("nav a")) {
    const open = tab.hash === "#" + (["part", "rejudge"].includes(current) ? "history" : current);
    tab.toggleAttribute("aria-current", open);
    if (open) tab.setAttribute("aria-current", "page");
  }
  if (PAGES[current].enter) PAGES[current].enter();
  showView();
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
  sound(view.alarms);
  notice();
  if (PAGES[current].show) PAGES[current].show();
}

function showAll() {
  document.documentElement.lang = language === "zh" ? "zh-CN" : "en";
  document.documentElement.dataset.theme = theme;
  for (const element of document.querySelectorAll("[data-word]")) element.textContent = word(element.dataset.word);
  for (const element of document.querySelectorAll("[data-label]")) element.setAttribute("aria-label", word(element.dataset.label));
  showWho();
  openPage();
}

at("language").addEventListener("click", () => {
  language = language === "zh" ? "en" : "zh";
  // What was said in the other language is over.
  for (const id of ["order_answer", "io_answer", "alarm_answer", "l_answer", "login_answer"]) at(id).textContent = "";
  kept.set("lang", language);
  showAll();
});
at("theme").addEventListener("click", () => {
  theme = theme === "dark" ? "light" : "dark";
  kept.set("theme", theme);
  showAll();
});
addEventListener("hashchange", openPage);

makeOrders();
makeJogs();
showAll();
askWho();
fetchMimic();
connect();
