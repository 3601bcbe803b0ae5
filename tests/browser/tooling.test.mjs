// Tooling: plans are tried, started, ticked off, and survive a restart.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { SIZES, clickRefused, forgive, leave, looks, open, picture, press, shown, visit } from "./browser.mjs";
import { WORDS, serve } from "./rig.mjs";

let rig, browser;
before(async () => {
  [rig, browser] = await Promise.all([serve("tooling", "--speed", "5"), open()]);
});
after(async () => {
  await browser?.close();
  await rig?.kill();
});

async function takeOff(page, element) {
  await page.selectOption("#t_kind", "disassembly");
  await page.check(`#t_elements input[value="${element}"]`);
}

test("a preview draws every step and stores nothing", async () => {
  const page = await visit(browser, rig, { path: "/#tooling" });
  await page.waitForSelector("#t_from option", { state: "attached" });
  await page.click("#t_show");
  await shown(page, "#t_title", WORDS["tooling-preview"].en);
  const steps = await page.$$eval("#t_steps > li", (all) => all.length);
  assert.ok(steps >= 10, `${steps} steps`);
  assert.equal(await page.$$eval("#t_steps svg .moves", (all) => all.length >= 20), true);
  assert.ok(await page.$eval("#t_steps svg", (it) => it.getBoundingClientRect().height) > 40);
  const box = await page.$eval("#t_steps svg .moves", (it) => it.getBBox().width);
  assert.ok(box > 0, "the moving body has a shape");
  await clickRefused(page.locator("#t_start"));
  await shown(page, "#t_answer", WORDS["stop-login"].en);
  assert.deepEqual(await (await fetch(rig.url + "/api/plans/list")).json(), []);
  await leave(page);
});

test("a maintainer ticks off a plan, which a restart keeps", async () => {
  let page = await visit(browser, rig, { role: "maintainer", path: "/#tooling" });
  await page.waitForSelector("#t_from option", { state: "attached" });
  await page.click("#t_start");
  await shown(page, "#t_title", WORDS["tooling-under_way"].en);
  assert.equal(await page.isVisible("#t_form button"), false);
  await page.click('[data-tick="1"]');
  await page.waitForSelector('[data-tick="2"]');
  await shown(page, "#t_steps .plan_done", rig.who("maintainer"));
  await picture(page, "tooling-under-way");
  await press(page, 'nav a[href="#io"]');
  await shown(page, "#to_tooling", "1 / ");
  await page.click("#to_tooling");
  await rig.kill();
  await rig.again();
  await page.reload();
  forgive(page);
  await page.waitForSelector('[data-tick="2"]');
  await shown(page, "#t_steps .plan_done", rig.who("maintainer"));
  const other = await visit(browser, rig, { path: "/#tooling" });
  await other.waitForSelector('[data-tick="2"]');
  await clickRefused(other.locator('[data-tick="2"]'));
  await shown(other, "#t_answer", WORDS["stop-login"].en);
  await leave(other);
  await page.click('[data-untick="1"]');
  await page.waitForSelector('[data-tick="1"]');
  await page.waitForSelector(".plan_done", { state: "detached" });
  await page.click("#t_abandon");
  await page.fill("#t_reason", "wrong nest");
  await page.click("#t_ask_go");
  await shown(page, "#t_title", WORDS["tooling_end-abandoned"].en);
  await shown(page, "#t_past", "wrong nest");
  await page.waitForSelector("#t_show:visible");
  await page.goto(rig.url + "/api/history/orders");
  assert.ok((await page.textContent("body")).includes("plan_abandon"));
  forgive(page);
  await leave(page);
});

test("what is chosen comes off, step by step to the end", async () => {
  const page = await visit(browser, rig, { role: "maintainer", path: "/#tooling" });
  await page.waitForSelector("#t_from option", { state: "attached" });
  await takeOff(page, "probe_housing");
  await page.click("#t_start");
  await page.waitForSelector("[data-tick]");
  const steps = await page.$$eval("#t_steps > li", (all) => all.length);
  for (let step = 1; step <= steps; step += 1) await page.click(`[data-tick="${step}"]`);
  await shown(page, "#t_title", WORDS["tooling_end-done"].en);
  const [paper] = await Promise.all([page.context().waitForEvent("page"), page.click("#t_print")]);
  await paper.waitForLoadState();
  assert.ok((await paper.textContent("body")).includes("☑ " + rig.who("maintainer")));
  await picture(paper, "tooling-paper");
  await leave(page);
});

test("an operator sees a plan and cannot start one", async () => {
  const page = await visit(browser, rig, { role: "operator", path: "/#tooling" });
  await page.waitForSelector("#t_from option", { state: "attached" });
  await clickRefused(page.locator("#t_start"));
  await shown(page, "#t_answer", WORDS["role-maintainer"].en);
  page.faults = page.faults.filter((it) => !it.includes("403"));
  await leave(page);
});

for (const size of SIZES) {
  test(`at ${size.width}x${size.height} the page of tooling fits and can be read`, async () => {
    const page = await visit(browser, rig, { role: "maintainer", path: "/#tooling", size });
    await page.waitForSelector("#t_from option", { state: "attached" });
    await page.selectOption("#t_kind", "disassembly");
    await looks(page, `tooling-choice-${size.width}`);
    await page.selectOption("#t_kind", "changeover");
    await press(page, "#t_show");
    await page.waitForSelector("#t_steps li");
    await looks(page, `tooling-${size.width}`);
    await leave(page);
  });
}
