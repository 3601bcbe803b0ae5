// The bus page of a rig with SCPI instruments, and their traffic on the trace page.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { SIZES, leave, looks, open, shown, visit } from "./browser.mjs";
import { WORDS, startIn } from "./rig.mjs";

let rig, browser;
before(async () => {
  [rig, browser] = await Promise.all([startIn("config/rigs/ssr", "instruments", "--speed", "8"), open()]);
  await rig.until("two parts are judged", (view) => view.judged >= 2);
});
after(async () => {
  await browser?.close();
  await rig?.kill();
});

const INSTRUMENTS = ["ac_source", "digitizer", "pulse_source", "smu_in", "smu_out"];

for (const language of ["en", "zh"]) {
  test(`bus shows link, profile, identity and programs of each instrument (${language})`, async () => {
    const page = await visit(browser, rig, { path: "/#bus", language });
    await page.waitForSelector("#instruments tr");
    const names = await page.$$eval("#instruments tr td:first-child", (all) => all.map((it) => it.textContent));
    assert.deepEqual(names, INSTRUMENTS);
    const source = "#instruments tr:nth-child(4)";
    for (const text of ["smu-2450", "tcp:192.168.10.11:5025", "KEITHLEY"]) await shown(page, source, text);
    const programs = await page.textContent(source + " td:nth-child(5)");
    assert.ok(Number(programs.replace(/\D/g, "")) > 10, programs);
    await shown(page, "#instruments_shown h2", WORDS["bus-instruments"][language]);
    await looks(page, "instruments-" + language);
    await leave(page);
  });
}

test("a narrow screen shows the instruments too", async () => {
  const page = await visit(browser, rig, { path: "/#bus", size: SIZES[3] });
  await page.waitForSelector("#instruments tr");
  await looks(page, "instruments-narrow");
  await leave(page);
});

test("trace shows the exchanges of an instrument", async () => {
  const page = await visit(browser, rig, { path: "/#trace" });
  await page.waitForSelector("#trace tr");
  await page.selectOption("#trace_line", "smu_in");
  await page.waitForFunction(() => Array.from(document.querySelectorAll("#trace tr"), (it) => it.children[1].textContent).every((it) => it === "smu_in"));
  await shown(page, "#trace", ":OUTP OFF");
  await leave(page);
});
