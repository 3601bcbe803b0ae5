// History, quality, calibration, bus and trace over a lot with parts.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { SIZES, leave, looks, open, press, shown, visit } from "./browser.mjs";
import { WORDS, start } from "./rig.mjs";

let rig, browser;
before(async () => {
  [rig, browser] = await Promise.all([start("pages", "--speed", "8"), open()]);
  await rig.until("twelve parts are judged", (view) => view.judged >= 12);
});
after(async () => {
  await browser?.close();
  await rig?.kill();
});

const rows = (page, body) => page.$$eval(body + " tr", (all) => all.length);

test("the history filters parts and shows raw replies", async () => {
  const page = await visit(browser, rig, { path: "/#history" });
  await page.waitForSelector("#parts tr");
  const all = await rows(page, "#parts");
  await page.selectOption("#h_verdict", "void");
  await page.click("#h_go");
  await page.waitForFunction((all) => document.querySelectorAll("#parts tr").length < all, all);
  await page.selectOption("#h_verdict", "pass");
  await page.selectOption("#h_param", "operate_voltage_v");
  await page.fill("#h_min", "9");
  await page.fill("#h_max", "8");
  await page.click("#h_go");
  await shown(page, "#h_trouble", "min");
  await page.fill("#h_max", "");
  await page.fill("#h_min", "1");
  await page.click("#h_go");
  await page.waitForSelector("#parts tr");
  assert.equal(await page.textContent("#h_trouble"), "");
  await page.click("#parts tr a");
  await page.waitForSelector("#part_replies tr");
  await page.waitForSelector("#part_bars rect");
  assert.ok(await page.$$eval("#part_bars rect", (all) => all.length) >= 8, "a bar for every quantity");
  assert.ok(await rows(page, "#part_replies") > 20);
  assert.match(await page.textContent("#part_replies"), /!|>/);
  await leave(page);
});

test("rejudging a lot lists what another recipe would change", async () => {
  const { lot } = await rig.view();
  const page = await visit(browser, rig, { path: "/#history" });
  await page.waitForSelector("#parts tr");
  await page.fill("#h_lot", lot);
  await page.click("#h_go");
  await page.click("#h_rejudge");
  await page.waitForSelector("#j_recipe option", { state: "attached" });
  assert.equal(await page.inputValue("#j_lot"), lot);
  await page.selectOption("#j_recipe", "jzc-22f-012-adaptive");
  await page.click("#j_go");
  await shown(page, "#j_changes", "PASS → PASS");
  await page.selectOption("#j_recipe", "jzc-22f-006");
  await page.click("#j_go");
  await shown(page, "#j_trouble", "was measured at 12 V");
  await leave(page);
});

test("the filtered parts are exported", async () => {
  const page = await visit(browser, rig, { path: "/#history" });
  await page.waitForSelector("#parts tr");
  const [saved] = await Promise.all([page.waitForEvent("download"), page.click("#export_csv")]);
  assert.equal(saved.suggestedFilename(), "relayrig-parts.csv");
  await leave(page);
});

test("a report prints", async () => {
  const page = await visit(browser, rig, { path: "/#history" });
  await page.waitForSelector("#parts tr");
  await page.fill("#h_lot", (await rig.view()).lot);
  await page.click("#h_go");
  const [paper] = await Promise.all([page.context().waitForEvent("page"), page.click("#h_lot_report")]);
  await paper.waitForLoadState();
  const pdf = await paper.pdf({ format: "A4" });
  assert.equal(pdf.subarray(0, 5).toString(), "%PDF-");
  assert.ok(pdf.length > 10_000);
  await leave(page);
});

test("charts and histograms of the reports show with capability", async () => {
  const page = await visit(browser, rig, { path: "/#quality" });
  await page.waitForSelector("#q_charts svg");
  await page.waitForSelector("#q_histograms svg");
  await page.waitForSelector("#q_cycle rect");
  await page.waitForSelector("#q_stored rect");
  assert.ok(await page.$$eval("#q_stored rect", (all) => all.length) >= 12, "test and way of the last parts");
  assert.equal(await rows(page, "#q_stats"), 12);
  await page.selectOption("#q_param", "release_time_ms");
  await shown(page, "#q_charts", "elease time");
  await leave(page);
});

test("calibration shows factors with due dates and reference parts", async () => {
  const page = await visit(browser, rig, { path: "/#calibration" });
  await page.waitForSelector("#c_factors .due");
  assert.equal(await page.$$eval("#c_factors .due.bad", (all) => all.length), 0);
  await shown(page, "#c_factors", WORDS["factor-operate_lag"].en);
  await shown(page, "#c_golden", "G-12-1");
  await shown(page, "#c_check", WORDS["c-agreed"].en);
  await leave(page);
});

test("bus shows the health of modules, trace their traffic", async () => {
  const page = await visit(browser, rig, { path: "/#bus" });
  await page.waitForSelector("#bus tr");
  assert.equal(await rows(page, "#bus"), 13);
  await page.click('nav a[href="#trace"]');
  await page.waitForSelector("#trace tr");
  await page.selectOption("#trace_line", "motion");
  await page.waitForFunction(() => Array.from(document.querySelectorAll("#trace tr"), (it) => it.children[1].textContent).every((it) => it === "motion"));
  await shown(page, "#trace", WORDS["signal-door_closed"].en);
  await page.click("#trace_freeze");
  await leave(page);
});

for (const size of SIZES) {
  test(`at ${size.width}x${size.height} every page fits and can be read`, async () => {
    const page = await visit(browser, rig, { size, role: "engineer", path: "/#history" });
    await page.waitForSelector("#parts tr a");
    await looks(page, `history-${size.width}`);
    await page.click("#parts tr a");
    await page.waitForSelector("#part_replies tr");
    await looks(page, `part-${size.width}`);
    await page.goto(rig.url + "/#rejudge");
    await page.waitForSelector("#j_recipe option", { state: "attached" });
    await page.click("#j_go");
    await page.waitForSelector("#j_changes dd");
    await looks(page, `rejudge-${size.width}`);
    for (const [name, ready] of [["quality", "#q_histograms svg"], ["calibration", "#c_golden td"], ["bus", "#bus tr"], ["trace", "#trace tr"], ["io", "#inputs li"]]) {
      await press(page, `nav a[href="#${name}"]`);
      await page.waitForSelector(ready);
      await looks(page, `${name}-${size.width}`);
    }
    await leave(page);
  });
}
