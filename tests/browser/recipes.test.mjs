// Recipes: reading by all, revisions by an engineer, refused values.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { SIZES, leave, looks, open, shown, visit } from "./browser.mjs";
import { WORDS, start, startAlone } from "./rig.mjs";

let rig, browser;
before(async () => {
  [rig, browser] = await Promise.all([start("recipes", "--speed", "1"), open()]);
});
after(async () => {
  await browser?.close();
  await rig?.kill();
});

const HIGH = '#r_fields [data-path="limits.operate_voltage_v.high"]';
const newest = async () => (await fetch(rig.url + "/api/recipes/show?name=jzc-22f-006")).json();
const choose = async (page) => {
  await page.selectOption("#r_name", "jzc-22f-006");
  await page.waitForSelector('#r_card[href*="jzc-22f-006"]');
};

for (const size of SIZES) {
  test(`at ${size.width}x${size.height} the recipes fit and can be read, by a stranger and by an engineer`, async () => {
    for (const role of [undefined, "engineer"]) {
      const page = await visit(browser, rig, { size, role, path: "/#recipes" });
      await page.waitForSelector("#r_fields td");
      if (role) await page.waitForSelector(HIGH);
      await looks(page, `recipes-${role ?? "stranger"}-${size.width}`);
      await leave(page);
    }
  });
}

test("only the recipes of a demo alone last until it ends", async () => {
  const alone = await startAlone();
  for (const [served, noted] of [[alone, true], [rig, false]]) {
    const page = await visit(browser, served, { path: "/#recipes" });
    await page.waitForSelector("#r_fields td");
    assert.equal(await page.isVisible("#r_kept"), noted);
    if (noted) await looks(page, "recipes-alone-1280");
    await leave(page);
  }
  await alone.kill();
});

test("without the role engineer recipes are read-only texts", async () => {
  for (const role of [undefined, "operator"]) {
    const page = await visit(browser, rig, { role, path: "/#recipes" });
    await choose(page);
    await shown(page, "#r_fields", WORDS["field-decision-slow_repeats"].en);
    assert.equal(await page.$$eval("#r_fields input, #r_fields select", (all) => all.length), 0);
    assert.equal(await page.isVisible("#r_save"), false);
    await leave(page);
  }
});

test("fields refuse bad values and save good ones", async () => {
  const page = await visit(browser, rig, { role: "engineer", path: "/#recipes" });
  await choose(page);
  const { number } = await newest();
  await page.fill(HIGH, "44");
  await page.click("#r_save");
  await shown(page, "#r_answer", "why the values change");
  await page.fill("#r_reason", "order 4711");
  await page.click("#r_save");
  await shown(page, "#r_fields tr:has(" + HIGH.slice(10) + ") + tr .trouble", "5.50");
  assert.equal((await newest()).number, number);
  await page.click("#language");
  await shown(page, "#r_fields .trouble", WORDS["r-found"].zh + " 44");
  await shown(page, "#r_answer", WORDS["r-refused"].zh);
  assert.equal(await page.inputValue(HIGH), "44", "what was typed stays");
  await looks(page, "recipes-refused-1280");
  await page.click("#language");
  await page.fill(HIGH, "4.4");
  await page.click("#r_save");
  await shown(page, "#r_answer", WORDS["r-saved"].en + " " + (number + 1));
  const saved = await newest();
  assert.equal(saved.number, number + 1);
  await page.click("summary:has(+ #r_history)");
  await shown(page, "#r_history li", "order 4711");
  await shown(page, "#r_history li li", "limits.operate_voltage_v.high: 4.5 V -> 4.4 V");
  await looks(page, "recipes-revisions-1280");
  assert.equal(saved.fields.find((it) => it.path === "limits.operate_voltage_v.high").value, 4.4);
  await page.selectOption("#r_revision", String(number));
  await shown(page, "#r_fields", "4.5");
  assert.equal(await page.isVisible("#r_save"), false, "an earlier revision is read only");
  const readAgain = page.waitForResponse((it) => it.url().includes("/api/recipes/show"));
  await page.click("#language");
  await readAgain;
  await shown(page, "#r_fields", WORDS["field-decision-slow_repeats"].zh);
  await shown(page, "#r_fields", "4.5");
  assert.equal(await page.inputValue("#r_revision"), String(number), "another language shows the same revision");
  await leave(page);
});

test("a second revision is refused and keeps its text", async () => {
  const pages = [];
  for (const value of ["0.61", "0.62"]) {
    const page = await visit(browser, rig, { role: "engineer", path: "/#recipes" });
    await choose(page);
    await page.fill('[data-path="limits.release_voltage_v.low"]', value);
    await page.fill("#r_reason", "order 4711");
    pages.push(page);
  }
  await pages[0].click("#r_save");
  await shown(pages[0], "#r_answer", WORDS["r-saved"].en);
  await pages[1].click("#r_save");
  await shown(pages[1], "#r_answer", "no longer the newest");
  assert.equal(await pages[1].inputValue('[data-path="limits.release_voltage_v.low"]'), "0.62");
  await pages[1].click("#r_discard");
  await pages[1].waitForFunction(() => document.querySelector('[data-path="limits.release_voltage_v.low"]').value === "0.61");
  for (const page of pages) await leave(page);
});
