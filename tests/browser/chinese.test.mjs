// The page and the paper in Chinese have no Latin words but units, names and codes.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { userInfo } from "node:os";
import { clickRefused, leave, open, picture, visit } from "./browser.mjs";
import { WORDS, start } from "./rig.mjs";

const UNITS = ["V", "mV", "A", "mA", "Ω", "mΩ", "mm", "s", "ms", "µs", "min", "C", "V/s", "mΩ/V"];
// Symbols of statistics and metrology, terminals of a relay, coordinates, formats of files.
const SYMBOLS = ["U", "k", "n", "p", "I", "MR", "X", "R", "Cp", "Cpk", "Ppk", "OEE", "SHA-256", "CSV", "NO", "NC", "COM", "x", "y", "z",
  "A", "B", "SCHED_FIFO"];
// The audit names who gives an order on the command line by the account of the system.
const NAMES = ["relayrig", "English", "Bissell", "li", "wang", "zhao", userInfo().username, "JZC-22F", "I-7017F"];
// Words of commands, keys and columns that texts quote.
const COMMANDS = ["calibrate", "config", "check", "host", "wear", "replaced", "init", "DIR", "Ctrl", "Shift", "part", "operator",
  "trial", "value"];
const ALARMS = Object.keys(WORDS).filter((id) => id.startsWith("alarm-")).map((id) => id.slice(6));

// Elements that show raw characters of the lines, or names for maintenance.
const CODES = "#trace td:nth-child(4), #part_replies td:nth-child(n+4):nth-child(-n+6), .signals li";

/** Returns every Latin word that a person sees or hears on the page and that is no unit, name or code. */
async function latin(page, names = []) {
  const texts = await page.evaluate((codes) => {
    const found = [], walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
      const of = walker.currentNode.parentElement;
      const hidden = ["SCRIPT", "STYLE"].includes(of.tagName) || (of.closest(codes) && of.closest("table"));
      if (!hidden && (of.tagName === "OPTION" || of.closest("svg") || of.checkVisibility())) found.push(walker.currentNode.textContent);
    }
    for (const of of document.querySelectorAll("[title], [aria-label], [placeholder]")) {
      if (of.closest(codes) || !of.checkVisibility()) continue;
      for (const name of ["title", "aria-label", "placeholder"]) found.push(of.getAttribute(name) ?? "");
    }
    return found;
  }, CODES);
  return [...new Set(texts.flatMap((text) => foreign(text, names)))];
}

function foreign(text, names) {
  // A hash is no word.
  const words = text.replace(/\b[0-9a-f]{12,}\b/g, "").match(/[\p{Script=Latin}µΩ][\p{Script=Latin}µΩ\d_/.-]*/gu) ?? [];
  const known = new Set([...UNITS, ...SYMBOLS, ...NAMES, ...COMMANDS, ...names]);
  // Names of lots, recipes and reference parts, and numbers of modules.
  const isCode = (word) => known.has(word) || ALARMS.some((code) => word.endsWith(code)) || /^(G-|D\d|x\d)/.test(word);
  const bare = words.map((word) => word.replace(/[./-]+$/, ""));
  return bare.filter((word) => !isCode(word)).map((word) => word + " in: " + text.trim().slice(0, 80));
}

// Latin words that the current test has found so far; `done` fails with all of them.
let found = [];
const none = async (page, where, names) => found.push(...(await latin(page, names)).map((it) => where + ": " + it));

async function done(page) {
  assert.deepEqual([...new Set(found.splice(0))], []);
  await leave(page);
}

let rig, browser, names;
before(async () => {
  [rig, browser] = await Promise.all([start("chinese", "--speed", "8", "--fault", "fall=3"), open()]);
  const recipes = await (await fetch(rig.url + "/api/recipes")).json();
  const { lot } = await rig.view();
  names = [...lot.split(" "), ...recipes.map((it) => it.name), ...recipes.flatMap((it) => it.title_en.split(/[ ,]+/))];
});
after(async () => {
  await browser?.close();
  await rig?.kill();
});

const chinese = (options) => visit(browser, rig, { language: "zh", ...options });

test("the operator's page has Chinese words while a lot runs", async () => {
  const page = await chinese({ role: "operator" });
  await rig.until("a part is judged", (view) => view.last !== null);
  await page.waitForSelector("#values svg");
  await none(page, "operator", names);
  for (const order of ["reset", "start", "unhold", "clear"]) {
    await clickRefused(page.locator(`#orders [data-order="${order}"]`));
    const answer = await page.textContent("#order_answer");
    assert.match(answer, /^[^、，]{2,14}$/, `${order}: one next step, found ${answer}`);
    await none(page, order, names);
  }
  await page.click("#who");
  await none(page, "account", names);
  await page.click("#account_logout");
  await page.click("#who");
  await page.fill("#user", "li");
  await page.fill("#password", "guessed wrong");
  await page.click("#login_go");
  await page.waitForFunction(() => document.getElementById("login_answer").textContent !== "");
  await none(page, "login", names);
  await done(page);
});

test("every page has Chinese words, for a maintainer and an engineer", async () => {
  await rig.until("the part has fallen", (view) => view.alarms.length > 0);
  for (const role of ["maintainer", "engineer"]) {
    const page = await chinese({ role });
    for (const [name, ready] of [["operator", "#alarms.bad"], ["lots", "#l_book b"], ["alarms", "#past tr"], ["history", "#parts tr a"],
      ["quality", "#q_histograms svg"], ["recipes", "#r_fields td"], ["calibration", "#c_golden td"], ["bus", "#bus tr"], ["io", "#inputs li"],
      ["trace", "#trace tr"]]) {
      await page.click(`nav a[href="#${name}"]`);
      await page.waitForSelector(ready, { state: "attached" });
      if (role === "maintainer") await picture(page, `chinese-${name}`);
      await none(page, `${name} for ${role}`, names);
    }
    await page.click('nav a[href="#history"]');
    await page.click("#parts tr a");
    await page.waitForSelector("#part_replies tr");
    await none(page, "part", names);
    await picture(page, `chinese-part`);
    await page.goto(rig.url + "/#rejudge");
    await page.waitForSelector("#j_recipe option", { state: "attached" });
    await page.click("#j_go");
    await page.waitForSelector("#j_changes dd");
    await none(page, "rejudge", names);
    await done(page);
  }
});

test("dialogs and refusals have Chinese words", async () => {
  const page = await chinese({ role: "operator", path: "/#alarms" });
  await page.click('[data-code="part_dropped"] .shelve');
  await none(page, "shelve", names);
  await page.fill("#shelve_reason", "传感器待更换");
  await page.click("#shelve_go");
  await page.waitForFunction(() => document.getElementById("alarm_answer").textContent !== "");
  await none(page, "shelving refused", names);
  await page.click('nav a[href="#lots"]');
  await page.waitForSelector("#l_book b");
  for (const order of ["hold_lot", "release_lot", "close_lot", "reopen_lot"]) {
    await clickRefused(page.locator(`#l_book [data-lot-order="${order}"]`).first());
    await none(page, order, names);
    if (await page.isVisible("#decide")) await page.click("#decide_cancel");
  }
  await page.click('nav a[href="#io"]');
  for (const kind of ["#modes", "#jogs"]) await page.waitForSelector(kind + " button");
  for (const button of await page.locator("#modes button, #jogs button").all()) {
    await clickRefused(button);
    await page.waitForFunction(() => document.getElementById("io_answer").textContent !== "");
    await none(page, "io", names);
  }
  await page.click('nav a[href="#history"]');
  await page.selectOption("#h_param", "operate_voltage_v");
  await page.fill("#h_min", "9");
  await page.fill("#h_max", "8");
  await page.click("#h_go");
  await page.waitForFunction(() => document.getElementById("h_trouble").textContent !== "");
  await none(page, "bad filter", names);
  await done(page);
});

test("refused values of a recipe have Chinese words", async () => {
  const page = await chinese({ role: "engineer", path: "/#recipes" });
  await page.waitForSelector("#r_fields input");
  await page.fill("#r_reason", "4711");
  for (const text of ["4400", "x", "-1"]) {
    await page.fill('[data-path="limits.operate_voltage_v.high"]', text);
    await page.click("#r_save");
    await page.waitForSelector("#r_fields .trouble");
    await none(page, text, [...names, "x"]);
  }
  await page.click("#r_save_as");
  await none(page, "new recipe", [...names, "x"]);
  await page.fill("#r_new_name", "jzc-22f-006");
  await page.fill("#r_new_reason", "4711");
  await page.click("#r_new_go");
  await page.waitForFunction(() => document.getElementById("r_answer").textContent.includes("jzc-22f-006"));
  await none(page, "taken name", [...names, "x"]);
  await done(page);
});

test("the guard's refusal has Chinese words", async () => {
  const page = await chinese({ role: "maintainer", path: "/#io" });
  await page.evaluate(() => post("/api/orders", { order: "clear" }));
  await rig.until("stopped", (view) => view.machine.state === "Stopped");
  await page.evaluate(() => post("/api/orders", { order: "mode", mode: "manual" }));
  await page.evaluate(() => post("/api/orders", { order: "reset" }));
  await rig.until("idle", (view) => view.machine.state === "Idle");
  await page.click('#jogs [data-with="probes_up"]:not([aria-disabled="true"])');
  await page.waitForSelector('#jogs li.blocked[data-motion="pusher_extend"]');
  await page.click('#jogs [data-with="pusher_extend"]:not([aria-disabled="true"])');
  await page.waitForFunction(() => document.getElementById("io_answer").textContent.includes("防碰撞"));
  await none(page, "io", names);
  await picture(page, "chinese-jog-refused");
  await page.click('nav a[href="#operator"]');
  await page.waitForSelector("#refused:not([hidden])");
  await none(page, "collision", names);
  await done(page);
});

test("plans for tooling have Chinese words", async () => {
  const page = await chinese({ role: "maintainer", path: "/#tooling" });
  const files = [...names, "scene.toml", "nests/body-18x12.toml", "x", "y", "z"];
  await page.waitForSelector("#t_from option", { state: "attached" });
  await page.selectOption("#t_kind", "disassembly");
  await none(page, "choice", files);
  await page.click("#t_show");
  await page.waitForFunction(() => document.getElementById("t_answer").textContent !== "");
  await none(page, "nothing chosen", files);
  await page.selectOption("#t_kind", "changeover");
  await page.click("#t_start");
  await page.waitForSelector("[data-tick]");
  await page.click("[data-tick]");
  await page.waitForSelector("#t_steps .done");
  await none(page, "under way", files);
  await picture(page, "chinese-tooling");
  await page.click("#t_abandon");
  await page.fill("#t_reason", "4711");
  await page.click("#t_ask_go");
  await page.waitForSelector("#t_show:visible");
  await none(page, "abandoned", files);
  await page.goto(rig.url + "/api/plans/paper?plan=1&lang=zh");
  await picture(page, "chinese-paper-plan");
  await none(page, "plan on paper", files);
  await done(page);
});

test("paper has Chinese words", async () => {
  const page = await chinese({});
  const { lot, recipe } = await rig.view();
  const [part] = await (await fetch(`${rig.url}/api/history/query?lot=${lot}&limit=1`)).json();
  for (const [name, path] of [["lot", `history/report/lot?lot=${lot}`], ["alarms", "history/report/alarms?"], ["card", `recipes/card?name=${recipe}`],
    ["certificate", `history/report/certificate?lot=${lot}&run=${part.run}&seq=${part.seq}`],
    ["chart", `history/report/chart?lot=${lot}&param=operate_voltage_v`]]) {
    await page.goto(`${rig.url}/api/${path}&lang=zh`);
    await picture(page, `chinese-paper-${name}`);
    await none(page, name, names);
  }
  await done(page);
});

// Returns the number of alarms on the page, in the history and in the log.
async function counts(of) {
  const listed = (await of.view()).alarms.reduce((sum, it) => sum + it.count, 0);
  const stored = (await (await fetch(of.url + "/api/history/alarms")).json()).length;
  return [listed, stored, (of.told.match(/ ERROR .* code=/g) ?? []).length];
}

// A fault for each family of alarms: safety, actuators, parts, lines, modules, supply.
for (const fault of ["door", "stuck_lift", "beam_blind", "silence=mech_di_a@32", "line_cut=motion@32", "reset=board_do@32", "supply_range_stuck=0"]) {
  test(`alarms after ${fault} have Chinese words`, async () => {
    const other = await start(`chinese-${fault.replace(/\W/g, "-")}`, "--speed", "20", "--fault", fault);
    try {
      await other.until("an alarm", (view) => view.alarms.length > 0);
      const page = await visit(browser, other, { language: "zh", role: "operator", path: "/#alarms" });
      await page.waitForSelector("#standing [data-code] dd");
      await page.waitForSelector("#past tr");
      await none(page, fault, names);
      await other.until("page, list and log count alike", async () => new Set(await counts(other)).size === 1)
        .catch(async () => found.push("page, list, log: " + await counts(other)));
      await page.click('nav a[href="#operator"]');
      await clickRefused(page.locator('#orders [data-order="clear"]'));
      await none(page, fault, names);
      await page.click('nav a[href="#lots"]');
      await page.waitForSelector("#l_book b");
      await none(page, fault, names);
      await done(page);
    } finally {
      await other.kill();
    }
  });
}
