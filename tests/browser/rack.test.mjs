// The operator's page of a rig with a rack.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { SIZES, leave, looks, open, picture, shown, visit } from "./browser.mjs";
import { WORDS, startIn } from "./rig.mjs";

// A batch takes an hour of rig time; a busy machine makes the rig slow.
const LONG_S = 800;

let rig, browser;
before(async () => {
  [rig, browser] = await Promise.all([startIn("config/rigs/thermostat", "rack", "--speed", "300"), open()]);
});
after(async () => {
  await browser?.close();
  await rig?.kill();
});

test("the rack takes the place of the machine and of its beams", async () => {
  const page = await visit(browser, rig);
  await page.waitForSelector("#rack_plan li");
  assert.equal(await page.$$eval("#rack_plan li", (all) => all.length), 40);
  assert.ok(!await page.isVisible("#mimic"));
  const headings = await page.$$eval("h3", (all) => all.filter((it) => it.checkVisibility()).map((it) => it.textContent));
  assert.ok(headings.includes(WORDS["rack-lists"].en) && !headings.includes(WORDS.bins.en), headings.join());
  await leave(page);
});

test("curve and sockets follow the batch", async () => {
  const page = await visit(browser, rig, { role: "operator" });
  await page.click("#prompt_choices button");
  await rig.until("the chamber heats", (view) => (view.machine.rack.test?.curve.t_s.length ?? 0) > 10, LONG_S);
  await page.waitForSelector("#air .reference[d^=M]", { state: "attached" });
  await shown(page, "#rack_phase", WORDS["rack_phase-testing"].en);
  const view = await rig.until("a part has operated", (view) => view.machine.rack.test?.switched.some((it) => it.opened_s.length), LONG_S);
  const socket = view.machine.rack.test.switched.find((it) => it.opened_s.length).socket;
  await page.waitForSelector("#air .opened[d^=M]", { state: "attached" });
  const title = await page.getAttribute(`#rack_plan li:nth-child(${socket})`, "title");
  assert.match(title, new RegExp(WORDS["rack-opened"].en));
  await picture(page, "rack-testing");
  await rig.until("parts have verdicts", (view) => Object.values(view.machine.places).some((it) => it.bin), LONG_S);
  await page.waitForSelector("#rack_plan .pass");
  await leave(page);
});

test("a part in the history shows the curve of its batch", async () => {
  const page = await visit(browser, rig, { path: "/#history" });
  await page.waitForFunction(() => document.querySelectorAll("#parts tr a").length > 10);
  await page.click("#parts tr a");
  await page.waitForSelector("#part_batch:visible");
  await page.waitForSelector("#part_air .reference[d^=M]", { state: "attached" });
  await page.waitForSelector("#part_air .opened[d^=M]", { state: "attached" });
  const times = await page.$eval("#part_air .reference", (it) => it.getAttribute("d").split("L").length);
  assert.ok(times > 100, `${times} points`);
  await looks(page, "rack-part");
  await leave(page);
});

for (const size of SIZES) {
  test(`at ${size.width}x${size.height} the rack fits and can be read`, async () => {
    const page = await visit(browser, rig, { size, role: "operator" });
    await page.waitForSelector("#rack_plan li");
    await looks(page, `rack-${size.width}`);
    await leave(page);
  });
}
