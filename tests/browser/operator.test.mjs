// The operator's page over a lot on the simulated rig.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { SIZES, clickRefused, forgive, leave, logIn, looks, open, picture, press, shown, visit } from "./browser.mjs";
import { WORDS, start } from "./rig.mjs";

let rig, browser;
before(async () => {
  [rig, browser] = await Promise.all([start("operator", "--speed", "4"), open()]);
});
after(async () => {
  await browser?.close();
  await rig?.kill();
});

const text = (page, selector) => page.textContent(selector);
test("the page loads without errors and shows SIMULATION", async () => {
  const page = await visit(browser, rig);
  assert.match(await text(page, "#simulated"), /SIMULATION/);
  assert.match(await page.title(), /SIMULATION/);
  assert.ok(await page.isVisible("#mimic polygon"));
  await leave(page);
});

test("parts move in the picture; the last verdict stays", async () => {
  const page = await visit(browser, rig);
  await rig.until("a part is judged", (view) => view.last !== null);
  const where = () => page.$$eval("#mimic .moving", (all) => all.map((it) => it.style.transform).join());
  const first = await where();
  await page.waitForFunction((first) => Array.from(document.querySelectorAll("#mimic .moving"), (it) => it.style.transform).join() !== first, first);
  await page.waitForSelector("#mimic .part.held", { state: "attached" });
  await shown(page, "#verdict", "PASS");
  assert.equal(await page.$$eval("#values tr", (rows) => rows.length), 9);
  assert.ok(await page.$$eval("#values svg", (bands) => bands.length) >= 5);
  await leave(page);
});

test("without login buttons and rig refuse orders", async () => {
  const page = await visit(browser, rig);
  await clickRefused(page.locator('#orders [data-order="stop"]'));
  await shown(page, "#order_answer", WORDS["stop-login"].en);
  const status = await page.evaluate(async () => (await fetch("/api/orders", { method: "POST",
    headers: { "Content-Type": "application/json" }, body: '{"order":"stop"}' })).status);
  assert.equal(status, 401);
  await leave(page);
});

test("login takes the right password and logout ends it", async () => {
  const page = await visit(browser, rig);
  await page.click("#who");
  await page.fill("#user", rig.who("operator"));
  await page.fill("#password", "guessed wrong");
  await page.click("#login_go");
  await shown(page, "#login_answer", WORDS["login-401"].en);
  await page.click("#login_cancel");
  await logIn(page, rig, "operator");
  await page.reload();
  await shown(page, "#who", rig.who("operator"));
  await page.click("#who");
  await page.click("#account_logout");
  await shown(page, "#who", WORDS.login.en);
  assert.equal(await page.evaluate(async () => (await fetch("/api/me")).json()), null);
  await leave(page);
});

test("a role that is too weak is refused", async () => {
  const page = await visit(browser, rig, { role: "operator" });
  const answer = await page.evaluate(async () => {
    const reply = await fetch("/api/orders", { method: "POST", headers: { "Content-Type": "application/json" }, body: '{"order":"mode","mode":"manual"}' });
    return [reply.status, (await reply.json()).reason];
  });
  assert.equal(answer[0], 403);
  assert.match(answer[1], /maintainer; you are operator/);
  await leave(page);
});

test("a held lot continues; disabled buttons give their reason", async () => {
  const page = await visit(browser, rig, { role: "operator" });
  await rig.until("the lot runs", (view) => view.machine.state === "Execute");
  await clickRefused(page.locator('#orders [data-order="unhold"]'));
  await shown(page, "#order_answer", WORDS["next-already"].en);
  await page.click('#orders [data-order="hold"]');
  await rig.until("held", (view) => view.machine.state === "Held");
  await picture(page, "operator-held");
  await page.click('#orders [data-order="unhold"]');
  await rig.until("executes", (view) => view.machine.state === "Execute");
  await leave(page);
});

test("language and theme change without a reload", async () => {
  const page = await visit(browser, rig);
  await page.evaluate(() => { window.same = true; });
  await page.click("#language");
  await shown(page, "#simulated", WORDS.simulation.zh);
  assert.equal(await page.getAttribute("html", "lang"), "zh-CN");
  await page.click("#theme");
  assert.equal(await page.getAttribute("html", "data-theme"), "dark");
  assert.ok(await page.evaluate(() => window.same));
  await page.reload();
  assert.equal(await page.getAttribute("html", "lang"), "zh-CN", "kept");
  await leave(page);
});

for (const size of SIZES) {
  test(`at ${size.width}x${size.height} nothing scrolls, nothing is cut off and everything can be read`, async () => {
    const page = await visit(browser, rig, { size, role: "operator" });
    await rig.until("a part is judged", (view) => view.last !== null);
    await looks(page, `operator-${size.width}`);
    await leave(page);
  });
}

test("a panel shows verdict, limits and orders without scrolling", async () => {
  const page = await visit(browser, rig, { size: SIZES[1], role: "operator" });
  await rig.until("a part is judged", (view) => view.last !== null);
  await page.waitForSelector("#values tr");
  // In one step: between the two steps of `$$eval` the page may replace what the first one found.
  const outOfView = (selector) => page.evaluate((selector) => {
    const all = Array.from(document.querySelectorAll(selector), (it) => it.getBoundingClientRect());
    if (all.length === 0) return "no element";
    const out = all.find((box) => box.width === 0 || box.left < 0 || box.right > innerWidth || box.top < 0 || box.bottom > innerHeight);
    return out && JSON.stringify(out);
  }, selector);
  for (const selector of ["#verdict", "#values tr", "#values small", ...["start", "stop", "clear"].map((it) => `#orders [data-order="${it}"]`)]) {
    assert.equal(await outOfView(selector), undefined, selector);
  }
  assert.match(await text(page, "#values"), /≤ 9/);
  await leave(page);
});

test("a phone has Stop in view on every page", async () => {
  const page = await visit(browser, rig, { size: SIZES[3], role: "operator" });
  const stop = '#stop_bar [data-order="stop"]';
  for (const name of ["operator", "lots", "alarms", "history", "quality", "recipes", "calibration", "bus", "io", "trace"]) {
    await press(page, `nav a[href="#${name}"]`);
    await page.waitForSelector(`main[data-page="${name}"]:not([hidden])`);
    const box = await page.evaluate(([main, stop]) => {
      const shown = document.querySelector(main);
      shown.scrollTop = shown.scrollHeight;
      return document.querySelector(stop).getBoundingClientRect().toJSON();
    }, [`main[data-page="${name}"]`, stop]);
    assert.ok(box.height >= 44 && box.top > 600 && box.bottom <= 844, `${name}: ${JSON.stringify(box)}`);
  }
  await rig.until("the lot runs", (view) => view.machine.state === "Execute");
  await page.click(stop);
  await rig.until("stopped", (view) => view.machine.state === "Stopped");
  await shown(page, "#stop_answer", WORDS["order-stop"].en);
  for (const [order, state] of [["reset", "Idle"], ["start", "Execute"]]) {
    await press(page, 'nav a[href="#operator"]');
    await page.waitForSelector(`#orders [data-order="${order}"][aria-disabled="false"]`);
    await page.click(`#orders [data-order="${order}"]`);
    await rig.until(state, (view) => view.machine.state === state);
  }
  await leave(page);
});

test("no state or stage overlaps the figures below it", async () => {
  const page = await visit(browser, rig, { role: "operator" });
  const codes = (family) => Object.keys(WORDS).filter((it) => it.startsWith(family + "-")).map((it) => it.slice(family.length + 1));
  const overlaps = () => page.evaluate(([states, stages]) => {
    const drawn = (id) => { const range = document.createRange(); range.selectNodeContents(at(id)); return range.getBoundingClientRect(); };
    const shown = [...states.map((doing) => ({ doing, stage: null })), ...stages.map((stage) => ({ doing: "testing", stage }))];
    return shown.filter((it) => {
      view = { ...view, ...it };
      showOperator();
      const [column, answer] = [at("state").parentElement, at("order_answer").getBoundingClientRect()];
      return drawn("state").bottom > drawn("judged").top || column.scrollHeight > column.clientHeight ||
        answer.bottom > column.getBoundingClientRect().bottom;
    });
  }, [codes("state"), codes("stage")]);
  assert.deepEqual(await overlaps(), []);
  await picture(page, "operator-stage");
  await page.click("#language");
  assert.deepEqual(await overlaps(), []);
  await leave(page);
});

test("values turn grey within 3 s without the rig", async () => {
  const page = await visit(browser, rig);
  // Measured by the page's clock from its last event, because this test may wake up late.
  await page.evaluate(() => {
    window.same = true;
    new MutationObserver(() => { window.took ??= performance.now() - heard; }).observe(document.body, { attributes: true });
  });
  await rig.kill();
  await page.waitForSelector("body.stale");
  const took = await page.evaluate(() => window.took);
  assert.ok(took < 3000, `${took} ms`);
  await picture(page, "operator-stale");
  await rig.again();
  await page.waitForSelector("body:not(.stale)");
  assert.ok(await page.evaluate(() => window.same), "without a reload");
  forgive(page);
  await leave(page);
});
