// The curves of a part that did not pass, on the page of the part and on its test record.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { leave, looks, open, picture, shown, visit } from "./browser.mjs";
import { WORDS, startIn } from "./rig.mjs";

// A reject comes in a hundred parts or so; a busy machine makes the rig slow.
const LONG_S = 600;

let browser;
before(async () => { browser = await open(); });
after(async () => { await browser?.close(); });

/** Returns the first part that did not pass and whose curves hold all of these signals. */
async function reject(rig, signals) {
  const ask = async (path) => (await fetch(rig.url + "/api/history/" + path)).json();
  let found;
  await rig.until("a reject with " + signals, async () => {
    for (const { lot, run, seq } of [...await ask("query?verdict=fail&limit=50"), ...await ask("query?verdict=void&limit=50")]) {
      const part = (await ask(`show?lot=${lot}&run=${run}&seq=${seq}&kind=lot`))[0];
      const has = (name) => part.curves?.some((it) => it.signal.endsWith(name));
      if (signals.every(has)) return found = part;
    }
    return false;
  }, LONG_S);
  return found;
}

for (const [recipe, figures, signals] of [
  ["ssr-ac-240v-5a-zc", "zero-cross", ["record.Timing", "mark.switch_on", "mark.next_zero", "control_voltage", "output_voltage", "load_current"]],
  ["ssr-dc-60v-3a", "dc", ["record.Timing", "mark.switch_on", "mark.switch_off", "control_voltage", "load_voltage", "load_current"]],
]) {
  test(`a rejected ${figures} relay shows its records with marks`, async () => {
    const rig = await startIn("config/rigs/ssr", "curves-" + figures, "--recipe", recipe, "--speed", "60");
    try {
      const part = await reject(rig, signals);
      const path = `/?lang=en#part?lot=${part.lot}&run=${part.run}&seq=${part.seq}&kind=lot`;
      const page = await visit(browser, rig, { path });
      await page.waitForSelector("#part_records figure svg");
      await shown(page, "#part_records", WORDS["stage-Timing"].en);
      const drawn = await page.$$eval("#part_records figure:has(.mark.switch_on)", (all) => all.map((it) => it.querySelectorAll("svg").length));
      assert.ok(drawn.length > 0 && drawn[0] >= 3, drawn.join());
      for (const language of ["en", "zh"]) {
        await page.$eval("#part_records figure:has(.mark.switch_on)", (it) => it.scrollIntoView());
        await shown(page, "#part_records figure:has(.mark.switch_on) figcaption", WORDS["mark-switch_on"][language]);
        await picture(page, `curves-${figures}-${language}`);
        await page.click("#language");
        await page.waitForSelector("#part_records figure svg");
      }
      await looks(page, "curves-" + figures);
      const paper = await (await fetch(`${rig.url}/api/history/report/certificate?lot=${part.lot}&run=${part.run}&seq=${part.seq}&lang=zh`)).text();
      assert.ok(paper.includes(WORDS["mark-switch_on"].zh) && paper.includes(WORDS["curve-load_current"].zh));
      await leave(page);
    } finally {
      await rig.kill();
    }
  });
}
