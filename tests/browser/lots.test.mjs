// Lots under `serve`: start, hold, close, and the next lot.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { SIZES, clickRefused, leave, looks, open, picture, shown, visit } from "./browser.mjs";
import { WORDS, serve } from "./rig.mjs";

let rig, browser;
before(async () => {
  [rig, browser] = await Promise.all([serve("lots", "--speed", "20"), open()]);
});
after(async () => {
  await browser?.close();
  await rig?.kill();
});

const lotRow = (page, lot) => page.locator("#l_book tr", { has: page.locator("b", { hasText: new RegExp(`^${lot}$`) }) });

/** Waits until the row of `lot` shows `state`; the page draws the row anew at every change. */
const lotIs = (page, lot, state) => lotRow(page, lot).locator(".lot_state." + state, { hasText: new RegExp("^" + WORDS["lot_state-" + state].en) }).waitFor();

async function startLot(page, lot, count) {
  await page.waitForSelector('#l_start[aria-disabled="false"]');
  await page.fill("#l_lot", lot);
  await page.selectOption("#l_recipe", "jzc-22f-012");
  await page.fill("#l_count", String(count));
  await page.click("#l_start");
}

async function decide(page, lot, order, reason) {
  await lotRow(page, lot).locator(`[data-lot-order="${order}"][aria-disabled="false"]`).click();
  await page.fill("#decide_reason", reason);
  await page.click("#decide_go");
}

test("start without a lot points to the page Lots", async () => {
  const page = await visit(browser, rig, { role: "operator" });
  await rig.until("stopped", (view) => view.machine.state === "Stopped");
  await page.click('#orders [data-order="reset"]');
  await page.waitForSelector(`#orders [data-order="start"][title="${WORDS["refusal-no_lot"].en}"]`);
  await clickRefused(page.locator('#orders [data-order="start"]'));
  await shown(page, "#order_answer", WORDS["refusal-no_lot"].en);
  await looks(page, "operator-no-lot");
  await leave(page);
});

test("one lot starts, holds and closes, another starts", async () => {
  const page = await visit(browser, rig, { role: "operator", path: "/#lots" });
  await startLot(page, "A", 500);
  await rig.until("a part is judged", (view) => view.lot === "A" && view.judged >= 2);
  await page.click('nav a[href="#operator"]');
  await shown(page, "#lot", "A");
  await page.waitForSelector("#mimic .part.held", { state: "attached" });
  await page.click('#orders [data-order="hold"]');
  await rig.until("held", (view) => view.machine.state === "Held");
  await page.click('nav a[href="#lots"]');
  await lotRow(page, "A").waitFor();
  await clickRefused(page.locator("#l_start"));
  assert.equal(await page.textContent("#l_answer"), WORDS["next-stop"].en);
  await decide(page, "A", "close_lot", "rest of the reel returned");
  await rig.until("closed", (view) => !view.under_way);
  await lotIs(page, "A", "complete");
  await startLot(page, "B", 2);
  await rig.until("complete", (view) => view.lot === "B" && !view.under_way && view.judged === 2);
  await lotIs(page, "B", "complete");
  await page.click('nav a[href="#operator"]');
  await shown(page, "#state", WORDS["state-complete"].en);
  await picture(page, "operator-complete");
  await page.click('nav a[href="#lots"]');
  await shown(page, "#l_audit", "li (operator)");
  await leave(page);
});

test("a held lot waits until a maintainer releases it", async () => {
  const operator = await visit(browser, rig, { role: "operator", path: "/#lots" });
  await lotRow(operator, "A").waitFor();
  await decide(operator, "A", "hold_lot", "wrong label");
  await lotRow(operator, "A").getByText("wrong label (li)").waitFor();
  await clickRefused(lotRow(operator, "A").locator('[data-lot-order="start"]'));
  await shown(operator, "#l_answer", WORDS["refusal-release_first"].en);
  await startLot(operator, "A", 1);
  await shown(operator, "#l_answer", "lot A is held: wrong label (li)");
  await decide(operator, "A", "release_lot", "");
  await shown(operator, "#l_answer", "takes the role maintainer");
  await leave(operator);
  const maintainer = await visit(browser, rig, { role: "maintainer", path: "/#lots" });
  await lotRow(maintainer, "A").waitFor();
  await decide(maintainer, "A", "release_lot", "label was corrected");
  await lotIs(maintainer, "A", "complete");
  await leave(maintainer);
});

test("an engineer reopens a complete lot with a reason", async () => {
  const maintainer = await visit(browser, rig, { role: "maintainer", path: "/#lots" });
  await startLot(maintainer, "A", 1);
  await shown(maintainer, "#l_answer", "lot A is complete");
  await decide(maintainer, "A", "reopen_lot", "late parts");
  await shown(maintainer, "#l_answer", "takes the role engineer");
  await leave(maintainer);
  const engineer = await visit(browser, rig, { role: "engineer", path: "/#lots" });
  await lotRow(engineer, "A").waitFor();
  await decide(engineer, "A", "reopen_lot", "late parts");
  await lotIs(engineer, "A", "open");
  await lotRow(engineer, "A").getByText("late parts (zhao)").waitFor();
  await leave(engineer);
});

test("a replacement resets its wear counter", async () => {
  const page = await visit(browser, rig, { role: "maintainer", path: "/#lots" });
  const probes = page.locator("#l_wear li", { hasText: WORDS["counter-probe_touches"].en });
  await probes.getByRole("button").click();
  await page.waitForFunction(() => document.querySelector("#l_wear li:last-child b").textContent === "0");
  await leave(page);
});

for (const size of SIZES) {
  test(`at ${size.width}x${size.height} the page of lots fits and can be read`, async () => {
    const page = await visit(browser, rig, { size, role: "maintainer", path: "/#lots" });
    await lotRow(page, "A").waitFor();
    await looks(page, `lots-${size.width}`);
    await lotRow(page, "B").locator('[data-lot-order="hold_lot"]').click();
    await picture(page, `lots-decide-${size.width}`);
    await leave(page);
  });
}
