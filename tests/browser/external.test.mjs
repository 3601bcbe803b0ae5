// Results from outside of the rig: the form of page Lots takes them, refuses bad ones, and says whether the lot is acceptable.

import assert from "node:assert/strict";
import { appendFileSync, cpSync, rmSync } from "node:fs";
import { after, before, test } from "node:test";
import { SIZES, leave, open, picture, shown, tooLarge, untouchable, visit } from "./browser.mjs";
import { WORDS, startIn } from "./rig.mjs";

const CONFIG = "config-external";
const EXTERNAL = "\n[external]\ndv_dt_v_us = { low = 500.0 }\nr_iso_ohm = { low = 1e9 }\n";

let rig, browser;
before(async () => {
  rmSync(CONFIG, { recursive: true, force: true });
  cpSync("config/rigs/ssr", CONFIG, { recursive: true });
  appendFileSync(CONFIG + "/recipes/ssr-dc-60v-3a.toml", EXTERNAL);
  [rig, browser] = await Promise.all([startIn(CONFIG, "external", "--speed", "20", "--count", "2"), open()]);
  await rig.until("the lot is complete", (view) => !view.under_way && view.judged >= 2);
});
after(async () => {
  await browser?.close();
  await rig?.kill();
});

/** Opens the results of the only lot. */
async function opened(language, size) {
  const page = await visit(browser, rig, { role: "engineer", path: "/#lots", language, size });
  await page.click(`#l_book button:text-is("${WORDS["x-open"][language]}")`);
  await page.waitForSelector("#external[open]");
  return page;
}

async function enter(page, typed) {
  for (const [field, text] of Object.entries({ serial: "", seq: "", value: "", u: "", ...typed, key: undefined })) {
    if (text !== undefined) await page.fill("#x_" + field, text);
  }
  await page.selectOption("#x_key", typed.key);
  await page.click("#x_enter");
}

/** Checks that the dialog fits; saves a picture. A dialog keeps the buttons of the header, which other tests press, out of reach. */
async function fits(page, name) {
  await picture(page, name);
  assert.deepEqual([await tooLarge(page), await untouchable(page)], [[], []], name);
}

const rows = (page) => page.$$eval("#x_results tr", (all) => all.length);

test("bad input enters nothing and says what was expected", async () => {
  for (const language of ["en", "zh"]) {
    const page = await opened(language);
    await shown(page, "#x_standing", WORDS["x-not_acceptable"][language]);
    for (const [typed, expected] of [
      [{ key: "r_iso_ohm", value: "-1", u: "1" }, { en: 'found "-1", expected a number of ohm above 0', zh: '数值 "-1" 不在' }],
      [{ key: "r_iso_ohm", value: "4e10" }, { en: 'which rule "guard_band" needs', zh: "按保护带规则判定时必须填写" }],
      [{ key: "r_iso_ohm", value: "4e10", u: "-4" }, { en: 'u: found "-4"', zh: "须为大于 0 的数" }],
      [{ key: "r_iso_ohm", value: "4e10", u: "4e9", serial: "none" }, { en: 'serial: found "none"', zh: '没有序列号为 "none"' }],
      [{ key: "r_iso_ohm", value: "4e10", u: "4e9", seq: "99" }, { en: 'seq: found "99"', zh: '没有工件号为 "99"' }],
      [{ key: "dwv_ua", value: "3", u: "1" }, { en: 'key: found "dwv_ua"', zh: '没有机外测试项目 "dwv_ua"' }],
    ]) {
      await enter(page, typed);
      await shown(page, "#x_answer", expected[language]);
      assert.equal(await rows(page), 0);
    }
    await page.fill("#x_value", "");
    await page.click("#x_enter");
    assert.ok(await page.$eval("#x_value", (it) => !it.validity.valid), "an empty value is sent");
    await fits(page, "external-bad-" + language);
    await leave(page);
  }
});

test("a maintainer cannot enter a result", async () => {
  const page = await visit(browser, rig, { role: "maintainer", path: "/#lots" });
  await page.click(`#l_book button:text-is("${WORDS["x-open"].en}")`);
  await enter(page, { key: "r_iso_ohm", value: "4e10", u: "4e9" });
  await shown(page, "#x_answer", "takes the role engineer");
  await leave(page);
});

test("results make the lot acceptable, a correction supersedes the earlier one", async () => {
  const page = await opened("en");
  await enter(page, { key: "r_iso_ohm", value: "4.2e10", u: "4e9", seq: "1" });
  await shown(page, "#x_answer", WORDS["x-entered"].en);
  await shown(page, "#x_standing", WORDS["x-missing"].en);
  await enter(page, { key: "dv_dt_v_us", value: "300", u: "20" });
  await shown(page, "#x_results tr:nth-child(2)", WORDS["verdict-fail"].en);
  await shown(page, "#x_standing", WORDS["x-not_acceptable"].en);
  await enter(page, { key: "dv_dt_v_us", value: "620", u: "30" });
  await shown(page, "#x_results tr:nth-child(3)", WORDS["verdict-pass"].en);
  await shown(page, "#x_results tr:nth-child(2)", WORDS["x-superseded"].en);
  await shown(page, "#x_standing", WORDS["x-acceptable"].en);
  assert.equal(await rows(page), 3);
  await leave(page);
});

for (const size of SIZES) {
  for (const language of ["en", "zh"]) {
    test(`at ${size.width}x${size.height} the results fit and can be read (${language})`, async () => {
      const page = await opened(language, size);
      assert.equal(await rows(page), 3);
      await fits(page, `external-${size.width}-${language}`);
      await leave(page);
    });
  }
}
