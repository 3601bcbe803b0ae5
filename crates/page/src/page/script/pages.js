// Pages besides the operator's: fetches the script of a page when the page first opens, and keeps the script.

// Path of the script by name of the page; a changed script has another path.
const SCRIPTS = JSON.parse(at("scripts").textContent);
// Longest wait for a script, ms, before the page offers to try again; a script that arrives later still counts.
const SCRIPT_MS = 10000;
// State by path: "coming", "missing" or "here".
const scripts = {};

function fetchScript(path) {
  scripts[path] = "coming";
  const element = make("script");
  const miss = () => {
    if (scripts[path] !== "coming") return;
    scripts[path] = "missing";
    showFetching();
  };
  element.addEventListener("error", miss);
  setTimeout(miss, SCRIPT_MS);
  element.src = path;
  document.head.append(element);
}

// Adds `markup` to the page and runs `begin`, once for each path; every fetched script is one call of this function.
function addPages(path, markup, begin) {
  if (scripts[path] === "here") return;
  scripts[path] = "here";
  at("fetching").insertAdjacentHTML("beforebegin", markup);
  translate();
  begin();
  if (!at("fetching").hidden) openPage();
}

// Fetches the script of the open page, unless fetching is under way or has failed, and shows the progress.
function showFetching() {
  const path = SCRIPTS[current];
  if (Object.hasOwn(PAGES, current)) return;
  if (!Object.hasOwn(scripts, path)) fetchScript(path);
  const missing = scripts[path] === "missing";
  at("fetch_state").textContent = word(missing ? "fetch-missing" : "fetch-coming");
  at("fetch_again").hidden = !missing;
}

at("fetch_again").addEventListener("click", () => {
  delete scripts[SCRIPTS[current]];
  showFetching();
});
