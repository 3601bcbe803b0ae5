// Draws the operator's page for README.md, 1280 x 800, after thirty judged parts of a lot, the last of which passed.

import { open, shown, visit } from "./browser.mjs";
import { start } from "./rig.mjs";

const [file] = process.argv.slice(2);
const [rig, browser] = await Promise.all([start("picture", "--speed", "4"), open()]);
try {
  const page = await visit(browser, rig, { role: "operator" });
  await rig.until("thirty parts are judged", (view) => view.judged >= 30);
  await shown(page, "#verdict", "PASS");
  await page.screenshot({ path: file });
} finally {
  await browser.close();
  await rig.kill();
}
