// What a browser fetches and when: the operator's page at once, each other page when it is first opened.

import assert from "node:assert/strict";
import { request } from "node:http";
import { after, before, test } from "node:test";
import { forgive, leave, looks, open, shown, visit } from "./browser.mjs";
import { WORDS, start } from "./rig.mjs";

/** Largest first answer as sent, bytes. */
const FIRST_BYTES = 60_000;
const PAGES = { lots: "#l_book tr", alarms: "#standing li", history: "#h_go", quality: "#q_stats", recipes: "#r_fields td",
  calibration: "#c_golden td", bus: "#bus tr", io: "#inputs li", trace: "#trace tr", rejudge: "#j_lot option" };

let rig, browser;
before(async () => {
  [rig, browser] = await Promise.all([start("fetching", "--speed", "8"), open()]);
  await rig.until("a part is judged", (view) => view.judged >= 1);
});
after(async () => {
  await browser?.close();
  await rig?.kill();
});

/** Returns headers and body of `GET path` as sent, not decompressed. */
const sent = (path, headers) => new Promise((resolve, reject) => {
  request(rig.url + path, { headers }, async (answer) => {
    const pieces = [];
    for await (const piece of answer) pieces.push(piece);
    resolve([answer.headers, Buffer.concat(pieces)]);
  }).on("error", reject).end();
});

/** Returns a list that collects the paths of the scripts that `page` fetches. */
function fetched(page) {
  const paths = [];
  page.on("request", (asked) => {
    const { pathname } = new URL(asked.url());
    if (pathname.startsWith("/page/")) paths.push(pathname);
  });
  return paths;
}

test("the first answer has at most 60 kB", async () => {
  const [headers, packed] = await sent("/", { "Accept-Encoding": "gzip, deflate, br" });
  assert.equal(headers["content-encoding"], "gzip");
  assert.ok(packed.length <= FIRST_BYTES, `${packed.length} bytes`);
  const [plain, page] = await sent("/", {});
  assert.equal(plain["content-encoding"], undefined);
  assert.match(page.toString(), /^<!doctype html>/);
});

test("each page but the operator's fetches a script once", async () => {
  const page = await visit(browser, rig);
  const paths = fetched(page);
  assert.equal(await page.$$eval("main", (all) => all.length), 2);
  let before = 0;
  for (const [name, ready] of Object.entries(PAGES)) {
    await page.evaluate((name) => { location.hash = name; }, name);
    await page.waitForSelector(`main[data-page="${name}"]:not([hidden])`);
    await page.waitForSelector(ready, { state: "attached" });
    // Bus and I/O share a script.
    assert.equal(paths.length, before += name === "io" ? 0 : 1, name);
    assert.equal(await page.isVisible("#fetching"), false);
  }
  await page.click("#language");
  for (const name of Object.keys(PAGES)) await page.evaluate((name) => { location.hash = name; }, name);
  assert.equal(paths.length, before, "fetched once");
  await leave(page);
});

test("each page opens without the scripts of the others", async () => {
  for (const [name, ready] of Object.entries(PAGES)) {
    const page = await visit(browser, rig, { path: "/#" + name });
    await page.waitForSelector(`main[data-page="${name}"]:not([hidden])`);
    await page.waitForSelector(ready, { state: "attached" });
    assert.equal(await page.$$eval("script[src]", (all) => all.length), 1, name);
    await leave(page);
  }
});

test("the next visit takes fetched scripts from the cache", async () => {
  const page = await visit(browser, rig, { path: "/#lots" });
  await page.waitForSelector(PAGES.lots);
  await page.reload();
  await page.waitForSelector(PAGES.lots);
  const bytes = await page.evaluate(() => performance.getEntriesByType("resource").find((it) => it.name.includes("/page/")).transferSize);
  assert.equal(bytes, 0, "from the cache");
  await leave(page);
});

test("after a failed fetch a page offers another try", async () => {
  const page = await visit(browser, rig, { role: "operator" });
  await page.click('nav a[href="#lots"]');
  await page.waitForSelector(PAGES.lots);
  await page.route("**/page/*", (route) => route.abort("connectionrefused"));
  await page.click('nav a[href="#history"]');
  await shown(page, "#fetch_state", WORDS["fetch-missing"].en);
  await looks(page, "fetch-missing");
  await page.click("#fetch_again");
  await shown(page, "#fetch_state", WORDS["fetch-missing"].en);
  await page.click('nav a[href="#lots"]');
  await page.waitForSelector("#l_book tr");
  await page.click('nav a[href="#history"]');
  await page.unroute("**/page/*");
  await page.click("#fetch_again");
  await page.waitForSelector("#parts tr");
  assert.equal(await page.isVisible("#fetching"), false);
  forgive(page);
  await leave(page);
});

test("fetched pages stay without the rig in both languages", async () => {
  const page = await visit(browser, rig, { path: "/#recipes" });
  await page.waitForSelector(PAGES.recipes);
  await rig.kill();
  await page.waitForSelector("body.stale");
  await page.click("#language");
  await page.click('nav a[href="#operator"]');
  await shown(page, "#link", WORDS["link-lost"].zh);
  await page.click('nav a[href="#recipes"]');
  await page.waitForSelector("#r_fields td");
  await page.click('nav a[href="#trace"]');
  await shown(page, "#fetch_state", WORDS["fetch-missing"].zh);
  await rig.again();
  await page.waitForSelector("body:not(.stale)");
  await page.click("#fetch_again");
  await page.waitForSelector(PAGES.trace);
  forgive(page);
  await leave(page);
});
