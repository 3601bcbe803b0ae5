// Draws the operator's page for README.md, 1280 x 800, once thirty parts of a lot are judged and the last one passed.

import { open, visit } from "./browser.mjs";
import { start } from "./rig.mjs";

const [file] = process.argv.slice(2);
const [rig, browser] = await Promise.all([start("picture", "--speed", "4"), open()]);
try {
  const page = await visit(browser, rig, { role: "operator" });
  await rig.until("thirty parts are judged", (view) => view.judged >= 30);
  // A stage with a short name, so that the heading keeps to one line.
  await page.waitForFunction(() => document.querySelector("#state").textContent.length < 18 &&
    document.querySelector("#verdict").textContent.includes("PASS"), null, { polling: 20 });
  await page.screenshot({ path: file });
} finally {
  await browser.close();
  await rig.kill();
}
