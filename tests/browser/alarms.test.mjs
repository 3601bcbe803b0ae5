// A dropped part: its alarm, the way back to production, and jogging.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { SIZES, leave, looks, open, picture, press, shown, visit } from "./browser.mjs";
import { start } from "./rig.mjs";

let rig, browser;
before(async () => {
  [rig, browser] = await Promise.all([start("alarms", "--speed", "8", "--fault", "fall"), open()]);
  await rig.until("the part has fallen", (view) => view.alarms.length > 0);
});
after(async () => {
  await browser?.close();
  await rig?.kill();
});

const order = (page, word, path = "#orders") => page.click(`${path} [data-order="${word}"]`);
const live = (page, selector) => page.waitForSelector(selector + ':not([aria-disabled="true"])');

test("an alarm sounds, has cause and action, is searchable", async () => {
  const page = await visit(browser, rig);
  await shown(page, "#alarms", "part_dropped");
  assert.equal(await page.getAttribute("#mute", "data-sounding"), "true");
  await page.click("#mute");
  assert.equal(await page.getAttribute("#mute", "data-sounding"), "false");
  await page.click('nav a[href="#alarms"]');
  await page.waitForSelector('#standing [data-code="part_dropped"] dd');
  await page.waitForSelector("#past tr");
  await page.fill("#alarm_search", "nothing like it");
  await page.waitForFunction(() => document.querySelectorAll("#past tr, #standing [data-code]").length === 0);
  await page.fill("#alarm_search", "dropped");
  await page.waitForSelector('#standing [data-code="part_dropped"]');
  await leave(page);
});

for (const size of SIZES) {
  test(`at ${size.width}x${size.height} the alarm page and the operator's page with an alarm fit and can be read`, async () => {
    const page = await visit(browser, rig, { size, role: "operator" });
    await looks(page, `alarm-bar-${size.width}`);
    await press(page, 'nav a[href="#alarms"]');
    await page.waitForSelector("#past tr");
    await looks(page, `alarms-${size.width}`);
    await leave(page);
  });
}

test("the list of alarms prints", async () => {
  const page = await visit(browser, rig, { path: "/#alarms" });
  await page.waitForSelector("#past tr");
  const [paper] = await Promise.all([page.context().waitForEvent("page"), page.click("#alarm_print")]);
  await paper.waitForLoadState();
  assert.match(await paper.textContent("body"), /part_dropped/);
  assert.equal((await paper.pdf()).subarray(0, 5).toString(), "%PDF-");
  await leave(page);
});

test("only a maintainer shelves an alarm, with a reason", async () => {
  const page = await visit(browser, rig, { role: "operator", path: "/#alarms" });
  await page.click('[data-code="part_dropped"] .shelve');
  await page.fill("#shelve_reason", "not mine to decide");
  await page.click("#shelve_go");
  await shown(page, "#alarm_answer", "maintainer");
  await page.click('[data-code="part_dropped"] .acknowledge');
  await rig.until("acknowledged", (view) => view.alarms.every((it) => it.state !== "unacknowledged"));
  await page.waitForSelector('#mute[data-sounding="false"]');
  await leave(page);
  const other = await visit(browser, rig, { role: "maintainer", path: "/#alarms" });
  await other.click('[data-code="part_dropped"] .shelve');
  await other.fill("#shelve_reason", "looked at, part taken out");
  await other.click("#shelve_go");
  await rig.until("shelved", (view) => view.alarms.every((it) => it.shelved));
  await leave(other);
});

test("after a reset jogging works; the guard refuses collisions", async () => {
  const page = await visit(browser, rig, { role: "maintainer" });
  await live(page, '#orders [data-order="clear"]');
  await order(page, "clear");
  await rig.until("stopped", (view) => view.machine.state === "Stopped");
  await page.click('nav a[href="#io"]');
  await live(page, '#modes [data-with="manual"]');
  await page.click('#modes [data-with="manual"]');
  await page.click('nav a[href="#operator"]');
  await live(page, '#orders [data-order="reset"]');
  await order(page, "reset");
  await rig.until("idle", (view) => view.machine.state === "Idle");
  await page.click('nav a[href="#io"]');
  await shown(page, '#jogs [data-motion="probes_up"] .clearance', "clearance");
  await live(page, '#jogs [data-with="probes_up"]');
  await page.click('#jogs [data-with="probes_up"]');
  await page.waitForSelector('#jogs li.blocked[data-motion="pusher_extend"]');
  await picture(page, "io-blocked");
  const stood = (await rig.view()).machine.actuators.find((it) => it.name === "pusher").from_mm;
  await live(page, '#jogs [data-with="pusher_extend"]');
  await page.click('#jogs [data-with="pusher_extend"]');
  await shown(page, "#io_answer", "refused");
  const pusher = (await rig.view()).machine.actuators.find((it) => it.name === "pusher");
  assert.deepEqual([pusher.from_mm, pusher.moving], [stood, false]);
  await page.click('nav a[href="#operator"]');
  await page.waitForSelector("#mimic .swept", { state: "attached" });
  assert.equal(await page.$$eval("#mimic .mover", (all) => all.length), 2, "in both views");
  assert.equal(await page.$$eval("#mimic .blocker", (all) => all.length), 2, "in both views");
  await shown(page, "#refused", "clear up to");
  await looks(page, "collision-1280");
  await leave(page);
});
