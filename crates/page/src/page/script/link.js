// The link to the rig: receives views and beats, and marks the page as stale when none come.

// Silence after which the link counts as lost, ms: a beat comes each second, and one may be missing.
const STALE_MS = 2200;
const AGAIN_MS = 1000;
let heard = -Infinity;
let alive = true;
let source = null;

const linkNow = () => (performance.now() - heard > STALE_MS ? "lost" : alive ? "live" : "ended");

// Shows the state of the link; the page is grey unless the link is live.
function showLink() {
  const link = linkNow();
  document.body.classList.toggle("stale", link !== "live");
  at("link").className = link === "live" ? "" : "bad";
  at("link").lastElementChild.textContent = word("link-" + link);
  document.title = (view && view.simulated ? word("simulation") + " · " : "") + "relayrig";
}

function connect() {
  if (source) source.close();
  source = new EventSource("/api/events");
  source.addEventListener("view", (event) => {
    view = JSON.parse(event.data);
    heard = performance.now();
    showView();
    showLink();
  });
  source.addEventListener("beat", (event) => {
    alive = JSON.parse(event.data).alive;
    heard = performance.now();
    showLink();
  });
}

let tried = performance.now();
setInterval(() => {
  if (!source) return;
  showLink();
  const now = performance.now();
  const dead = source.readyState === EventSource.CLOSED || now - heard > 2 * STALE_MS;
  if (dead && now - tried > (source.readyState === EventSource.CLOSED ? AGAIN_MS : 2 * STALE_MS)) {
    tried = now;
    connect();
  }
}, 250);
