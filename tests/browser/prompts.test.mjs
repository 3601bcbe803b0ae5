// Prompts and scans: a person answers, scans a part as a keyboard types, and finds it again; an engineer edits a prompt.

import assert from "node:assert/strict";
import { appendFileSync, cpSync, mkdirSync, rmSync } from "node:fs";
import { after, before, test } from "node:test";
import { leave, looks, open, picture, shown, visit } from "./browser.mjs";
import { serveIn } from "./rig.mjs";

const CONFIG = "config-prompts";
const PROMPT = `
[[prompt]]
name = "nest"
when = "lot_start"
text_en = "Change the nest"
text_zh = "更换测试位"
picture = "nest.png"
choices = [
  { name = "changed", text_en = "Changed", text_zh = "已更换" },
  { name = "stop", text_en = "Stop the lot", text_zh = "停止批次", stops = true },
]
`;
const PANEL = { width: 1024, height: 768 };
const PHONE = { width: 390, height: 844 };

let rig, browser;
before(async () => {
  rmSync(CONFIG, { recursive: true, force: true });
  cpSync("config", CONFIG, { recursive: true });
  mkdirSync(CONFIG + "/pictures");
  cpSync(new URL("../../docs/operator.png", import.meta.url), CONFIG + "/pictures/nest.png");
  appendFileSync(CONFIG + "/recipes/jzc-22f-006.toml", PROMPT.replaceAll("nest", "track").replace("track.png", "nest.png"));
  appendFileSync(CONFIG + "/lot.toml", '\n[serial]\nsource = "wedge"\n' + PROMPT);
  [rig, browser] = await Promise.all([serveIn(CONFIG, "prompts", "--speed", "20"), open()]);
});
after(async () => {
  await browser?.close();
  await rig?.kill();
});

test("a lot waits for an answer, then for scans", async () => {
  const page = await visit(browser, rig, { role: "operator" });
  const start = { order: "start", lot: "P", recipe: "resistor-390", count: 1 };
  const status = await page.evaluate(async (order) => (await fetch("/api/orders", { method: "POST",
    headers: { "Content-Type": "application/json" }, body: JSON.stringify(order) })).status, start);
  assert.equal(status, 200);
  await shown(page, "#prompt_text", "Change the nest");
  await page.waitForFunction(() => document.getElementById("prompt_picture").naturalWidth > 0);
  await looks(page, "prompt");
  await page.setViewportSize(PANEL);
  const reached = await page.evaluate(() => {
    const box = document.querySelector("#orders .stop").getBoundingClientRect();
    const hit = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
    return hit?.className === "stop" && box.bottom <= innerHeight;
  });
  assert.ok(reached, "the prompt hides Stop");
  await page.click("#language");
  await shown(page, "#prompt_text", "更换测试位");
  await page.click("#language");
  await page.click("#prompt_choices button");
  await page.waitForSelector("#prompt", { state: "hidden" });
  await rig.until("the line waits for a scan", (view) => view.machine.state === "Execute" && view.machine.scans?.length === 0);
  await page.focus("#language");
  await page.keyboard.press("Space");
  await shown(page, "#language", "English");
  await page.click("#language");
  await page.locator("body").click({ position: { x: 5, y: 5 } });
  await page.keyboard.type("S-17\n");
  await picture(page, "scan");
  // Its row is in the history before the fingers open.
  await rig.until("the part has landed", (view) => Object.values(view.bins).includes(1));
  await page.goto(rig.url + "/#history");
  await page.fill("#h_serial", "S-17");
  await page.click("#h_go");
  await shown(page, "#h_count", "1 – 1");
  await leave(page);
});

test("scans that a lot leaves are named and stop further scans", async () => {
  const page = await visit(browser, rig, { role: "operator" });
  const order = (body) => page.evaluate(async (body) => {
    const reply = await fetch("/api/orders", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
    return [reply.status, await reply.text()];
  }, body);
  const taken = async (body) => assert.equal((await order(body))[0], 200, JSON.stringify(body));
  const begin = async (lot) => {
    await taken({ order: "start", lot, recipe: "resistor-390", count: 1 });
    await rig.until("the prompt opens", (view) => view.lot === lot && view.machine.prompt);
    await taken({ order: "answer", prompt: "nest", choice: "changed" });
    await rig.until("the line waits for a scan", (view) => view.machine.state === "Execute" && view.machine.scans?.length === 0);
  };
  await begin("Q");
  await taken({ order: "stop" });
  await rig.until("the line rests", (view) => view.machine.state === "Stopped");
  await taken({ order: "scan", serial: "S-18" });
  await taken({ order: "close_lot", lot: "Q" });
  const named = `S-18 (${rig.who("operator")})`;
  await rig.until("an alarm names the scan", (view) => view.alarms.some((it) => it.code === "scans_dropped" && it.text_en.includes(named)));
  await begin("R");
  const [status, why] = await order({ order: "scan", serial: "S-19" });
  assert.ok(status === 409 && why.includes(named), why);
  await taken({ order: "acknowledge", alarm: "scans_dropped" });
  await taken({ order: "scan", serial: "S-19" });
  await rig.until("the part is judged", (view) => view.lot === "R" && view.judged === 1);
  await leave(page);
});

test("an engineer edits the prompts of a recipe", async () => {
  const page = await visit(browser, rig, { role: "engineer", path: "/#recipes" });
  await page.selectOption("#r_name", "jzc-22f-006");
  const request = '#r_fields [data-path="prompt.0.text_en"]';
  await page.waitForSelector(request);
  assert.equal(await page.inputValue('#r_fields [data-path="prompt.0.picture"]'), "nest.png");
  await shown(page, "#r_fields table:last-child", "Change the nest — Changed / Stop the lot");
  await page.fill(request, "Empty the track");
  await page.selectOption('#r_fields [data-path="prompt.0.choices.0.stops"]', "true");
  await page.fill("#r_reason", "order 4711");
  await page.click("#r_save");
  await shown(page, "#r_fields .trouble", "a choice with which the lot goes on");
  await page.selectOption('#r_fields [data-path="prompt.0.choices.0.stops"]', "false");
  await page.click("#r_save");
  await shown(page, "#r_history li li", "prompt.0.text_en: Change the track -> Empty the track");
  await shown(page, "#r_answer", "Saved as revision 2");
  await looks(page, "recipes-prompts");
  await page.setViewportSize(PHONE);
  await page.$eval(request, (it) => it.scrollIntoView());
  await looks(page, "recipes-prompts-390");
  await leave(page);
});
