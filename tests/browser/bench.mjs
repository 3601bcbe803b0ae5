// Speed of the page over `relayrig demo --speed 1`: prints each figure with its bar; exits with 1 when one is missed.
//
// - Time from the turn of the cycle that publishes a view to the frame that shows it, in one browser.
// - Share of the cycle's wall time in the phase `publish`, with one open stream and with 50 more.
// - Time from the start of a demo in an empty folder to its first page.
// - First answer: compressed bytes, and time until it is drawn, each time in a fresh browser context.
//
// With `--json` each figure is a line of JSON.

import { request } from "node:http";
import { open, visit } from "./browser.mjs";
import { start, startAlone } from "./rig.mjs";

const VIEWS_S = 20;
const SCREENS = 50;
const COST_S = 15;
const VISITS = 20;
const STARTS = 10;

const at = (sorted, share) => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
let missed = false;

const asJson = process.argv.includes("--json");

// Prints a figure of `n` measurements; a value above its bar is missed, a null bar is none.
function told(figure, n, value, unit, bar = null) {
  const isMissed = bar !== null && value > bar;
  missed ||= isMissed;
  if (asJson) {
    const text = bar === null ? null : `<= ${bar}`;
    console.log(JSON.stringify({ type: "figure", study: "page", figure, n, value, unit, bar: text }));
    return;
  }
  const verdict = bar === null ? "" : ` bar ${bar}${isMissed ? "  MISSED" : ""}`;
  console.log(`${figure.padEnd(52)} ${value.toFixed(2).padStart(9)} ${unit.padEnd(3)}${verdict}`);
}

const pause = (seconds) => new Promise((resolve) => setTimeout(resolve, seconds * 1000));

// Wall time of the phase `publish` since the start, s.
async function publishing(rig) {
  const text = await (await fetch(rig.url + "/metrics")).text();
  return Number(/relayrig_cycle_seconds\{phase="publish"\} (\S+)/.exec(text)[1]);
}

async function share(rig) {
  const [before, began] = [await publishing(rig), performance.now()];
  await pause(COST_S);
  return 100 * (await publishing(rig) - before) * 1000 / (performance.now() - began);
}

function listen(rig) {
  return new Promise((resolve, reject) => {
    const asked = request(rig.url + "/api/events", (answer) => { answer.resume(); resolve(asked); });
    asked.on("error", () => {});
    asked.once("error", reject);
    asked.end();
  });
}

const starts = [];
for (let start = 0; start < STARTS; start += 1) {
  const began = performance.now();
  const alone = await startAlone();
  await (await fetch(alone.url + "/")).text();
  starts.push(performance.now() - began);
  await alone.kill();
}
told("demo in an empty folder: first page, longest", STARTS, Math.max(...starts) / 1000, "s", 3);

const [rig, browser] = await Promise.all([start("bench", "--speed", "1"), open()]);
await rig.until("the lot runs", (view) => view.judged > 0, 120);

const page = await visit(browser, rig);
await page.evaluate(() => {
  window.lateness = [];
  const show = showView;
  // `showView` is a function of the page's script.
  showView = () => {
    show();
    if (view.at_us === window.shownLast) return;
    const shown = window.shownLast = view.at_us;
    requestAnimationFrame(() => { window.lateness.push(performance.timeOrigin + performance.now() - shown / 1000); });
  };
});
await pause(VIEWS_S);
const lateness = (await page.evaluate(() => window.lateness)).sort((a, b) => a - b);
const views = lateness.length;
told("from step to pixel, median", views, at(lateness, .5), "ms");
told("from step to pixel, p95", views, at(lateness, .95), "ms", 100);
told("from step to pixel, p99", views, at(lateness, .99), "ms");

const one = await share(rig);
const screens = await Promise.all(Array.from({ length: SCREENS }, () => listen(rig)));
const fifty = await share(rig);
for (const screen of screens) screen.destroy();
told("the cycle's time on screens, one connected", 1, one, "%");
told(`the cycle's time on screens, ${SCREENS} more`, 1, fifty, "%", 1);

const drawn = [];
const bytes = await page.evaluate(() => performance.getEntriesByType("navigation")[0].encodedBodySize);
for (let visit = 0; visit < VISITS; visit += 1) {
  const context = await browser.newContext();
  const fresh = await context.newPage();
  await fresh.goto(rig.url + "/", { waitUntil: "commit" });
  const paint = await fresh.waitForFunction(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime);
  drawn.push(await paint.jsonValue());
  await context.close();
}
drawn.sort((a, b) => a - b);
told("first page, compressed", 1, bytes / 1000, "kB", 60);
told("first page, drawn, median", VISITS, at(drawn, .5), "ms", 200);
told("first page, drawn, p99", VISITS, at(drawn, .99), "ms");

await browser.close();
await rig.kill();
process.exit(missed ? 1 : 0);
