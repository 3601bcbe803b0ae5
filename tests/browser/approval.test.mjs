// New recipes, and recipes that a second engineer approves before a lot may use them.

import assert from "node:assert/strict";
import { cpSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { clickRefused, leave, looks, open, picture, shown, visit } from "./browser.mjs";
import { WORDS, addPerson, serveIn } from "./rig.mjs";

const CONFIG = "config-approval";
const HIGH = '#r_fields [data-path="limits.operate_voltage_v.high"]';
let rig, browser;
before(async () => {
  rmSync(CONFIG, { recursive: true, force: true });
  cpSync("config", CONFIG, { recursive: true });
  writeFileSync(`${CONFIG}/rig.toml`, readFileSync(`${CONFIG}/rig.toml`) + '\n[recipes]\napproval = "second_person"\n');
  [rig, browser] = await Promise.all([serveIn(CONFIG, "approval", "--speed", "20"), open()]);
  addPerson("approval", "chen", "engineer");
});
after(async () => {
  await browser?.close();
  await rig?.kill();
});

const recipes = async (role) => {
  const page = await visit(browser, rig, { role, path: "/#recipes" });
  await page.waitForSelector("#r_fields td");
  return page;
};

async function startLot(recipe) {
  const page = await visit(browser, rig, { role: "operator", path: "/#lots" });
  await page.waitForSelector('#l_start[aria-disabled="false"]');
  await page.fill("#l_lot", "A");
  await page.selectOption("#l_recipe", recipe);
  await page.fill("#l_count", "1");
  await page.click("#l_start");
  return page;
}

test("an engineer saves a new recipe under a name", async () => {
  const page = await recipes("engineer");
  await page.selectOption("#r_name", "jzc-22f-012");
  await page.waitForSelector('#r_card[href*="jzc-22f-012"]');
  await page.fill(HIGH, "8.7");
  for (const [name, refused] of [["jzc-22f-006", WORDS["refusal-recipe_taken"].en], ["../rig", WORDS["refusal-recipe_name"].en], ["customer-a"]]) {
    await page.click("#r_save_as");
    await page.fill("#r_new_name", name);
    await page.fill("#r_new_reason", "order 4711");
    await picture(page, "recipes-new");
    await page.click("#r_new_go");
    await shown(page, "#r_answer", refused ? refused.split("{")[0] : WORDS["r-created"].en + " customer-a");
    assert.equal(await page.inputValue(HIGH), "8.7");
  }
  assert.equal(await page.inputValue("#r_name"), "customer-a");
  await page.click("summary:has(+ #r_history)");
  await shown(page, "#r_history li", "order 4711");
  await shown(page, "#r_history li ul", "name: jzc-22f-012 -> customer-a");
  await shown(page, "#r_history li ul", "limits.operate_voltage_v.high: 9.0 V -> 8.7 V");
  await page.selectOption("#r_name", "jzc-22f-012");
  await page.waitForFunction((high) => document.querySelector(high).value === "9", HIGH);
  await leave(page);
});

test("an unapproved recipe starts no lot", async () => {
  const page = await startLot("customer-a");
  await shown(page, "#l_answer", WORDS["refusal-not_approved"].en.replace("{ $recipe }", "customer-a"));
  await page.click("#language");
  await page.click("#l_start");
  await shown(page, "#l_answer", WORDS["refusal-not_approved"].zh.replace("{ $recipe }", "customer-a"));
  await leave(page);
});

test("a second engineer approves what the first one saved", async () => {
  const saver = await recipes("engineer");
  await saver.selectOption("#r_name", "customer-a");
  await shown(saver, "#r_approval", WORDS["r-waits"].en + " " + rig.who("engineer"));
  await looks(saver, "recipes-waiting-1280");
  let letGo;
  const late = new Promise((resolve) => { letGo = resolve; });
  await saver.route("**/api/recipes/show*", (route) => late.then(() => route.continue()), { times: 1 });
  const read = saver.waitForResponse("**/api/recipes/show*");
  await saver.click("#language");
  await clickRefused(saver.locator("#r_approve"));
  await shown(saver, "#r_answer", WORDS["r-signed"].zh);
  // The answer outlasts a read that began before the order, and follows the language.
  letGo();
  await (await read).finished();
  await saver.click("#language");
  await shown(saver, "#r_answer", WORDS["r-signed"].en);
  await leave(saver);
  const second = await recipes("chen");
  await second.selectOption("#r_name", "customer-a");
  await second.waitForSelector('#r_approve[aria-disabled="false"]');
  await second.click("#r_approve");
  await shown(second, "#r_approval", WORDS["r-approved"].en + " " + rig.who("engineer"));
  await shown(second, "#r_approval", "chen");
  assert.equal(await second.isVisible("#r_approve"), false);
  await picture(second, "recipes-approved");
  const audit = await (await fetch(rig.url + "/api/history/orders?order=approve")).json();
  assert.deepEqual(audit.map((it) => [it.who, it.role, it.what.recipe, it.what.revision, it.refused]), [["chen", "engineer", "customer-a", 1, null]]);
  await leave(second);
});

test("an approved recipe starts a lot", async () => {
  const page = await startLot("customer-a");
  await rig.until("the lot runs", (view) => view.lot === "A" && view.recipe === "customer-a");
  await leave(page);
});
