// Reads the state of the rigs again and again, shows whether the answer is fresh, and starts the page.

const EVERY_MS = 5000;
// Age of the last answer at which the page counts as old, ms.
const OLD_MS = 30000;
let answered = -Infinity;

async function readFleet() {
  try {
    fleet = await (await ask("/api/fleet")).json();
    answered = performance.now();
  } catch { /* the age of the last answer shows it */ }
  showView();
}

const showLost = () => performance.now() - answered > OLD_MS;

// Shows the state of the link; the page is grey unless the answer is fresh.
function showLink() {
  const state = showLost() ? "lost" : fleet.trouble ? "no_database" : fleet.now ? "fresh" : "waiting";
  document.body.classList.toggle("stale", state === "lost" || state === "no_database");
  at("link").className = state === "fresh" || state === "waiting" ? "" : "bad";
  at("link").lastElementChild.textContent = word("rigs-link-" + state);
  const trouble = fleet?.trouble;
  at("trouble").hidden = !trouble;
  if (!trouble) return;
  const [what, more] = at("trouble").children;
  showMarked(what.firstElementChild, word("rigs_remedy-" + trouble.remedy));
  what.lastElementChild.textContent = word("rigs-trouble_since") + " " + clock(trouble.since);
  more.textContent = trouble.text;
}

function showView() {
  showLink();
  at("as_of").textContent = clock(fleet?.now?.at);
  if (current === HOME) showFleet();
}

// Writes what depends on the language besides the words of the markup.
function translateMore() {
  at("of_rig").textContent = ownRig ? rigName(ownRig) : word("rigs-all");
  document.title = (ownRig ? rigName(ownRig) + " \u00b7 " : "") + "relayrig";
  at("all_rigs").hidden = !ownRig;
  // Only the page of one rig has control charts.
  at("of_quality").hidden = !ownRig;
}

showAll();
readFleet();
setInterval(readFleet, EVERY_MS);
