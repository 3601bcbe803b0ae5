// The link to the rig: views and beats down, and what the page says when they stay away.

// A beat comes each second: one may be missing, and what is older than 3 s is grey for certain.
const STALE_MS = 2200;
const AGAIN_MS = 1000;
let heard = -Infinity;
let alive = true;
let source = null;

const linkNow = () => (performance.now() - heard > STALE_MS ? "lost" : alive ? "live" : "ended");

// Live, lost or ended; a page that is not live says so and is grey.
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
