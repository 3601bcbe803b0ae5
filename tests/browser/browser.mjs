// A page in headless Chromium that collects its faults: errors, and requests to other hosts.
//
// Environment: MODULES, the folder with `node_modules`; CHROMIUM, the browser; SCREENSHOTS, the folder for pictures.

import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { PASSWORD } from "./rig.mjs";

const require = createRequire(join(process.env.MODULES, "from.js"));
const { chromium } = require("playwright-core");
const axe = require("axe-core").source;

const PICTURES = process.env.SCREENSHOTS;
/** Sizes of a panel PC and of an office screen, pixels. */
export const SIZES = [{ width: 1280, height: 800 }, { width: 1920, height: 1080 }];
const QUIET = ["--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--disable-background-networking",
  "--disable-component-update", "--disable-sync", "--no-first-run", "--autoplay-policy=no-user-gesture-required"];

export const open = () => chromium.launch({ executablePath: process.env.CHROMIUM, args: QUIET });

/** Opens a fresh page of `rig` at `path`, logged in with `role` if given. */
export async function visit(browser, rig, { path = "/", role, language = "en", theme = "light", size = SIZES[0] } = {}) {
  const context = await browser.newContext({ viewport: size, locale: language === "zh" ? "zh-CN" : "en-GB", colorScheme: theme, acceptDownloads: true });
  const page = await context.newPage();
  page.setDefaultTimeout(60_000);
  page.faults = [];
  page.on("pageerror", (error) => page.faults.push("error: " + error));
  page.on("console", (line) => {
    if (line.type() === "error" && !refusedOnPurpose(line)) page.faults.push("console: " + line.text());
  });
  page.on("request", (request) => {
    const url = request.url();
    if (!url.startsWith(rig.url + "/") && !url.startsWith("data:") && !url.startsWith("blob:")) page.faults.push("request: " + url);
  });
  await page.goto(rig.url + path);
  await page.waitForSelector("body:not(.stale)");
  if (role) await logIn(page, rig, role);
  return page;
}

// Chromium logs every refusal as an error; tests provoke refusals on purpose.
const refusedOnPurpose = (line) => /the server responded with a status of 4(00|01|03|04|09|22|29)/.test(line.text());

export async function logIn(page, rig, role) {
  await page.click("#who");
  await page.fill("#user", rig.who(role));
  await page.fill("#password", PASSWORD);
  await page.click("#login_go");
  await page.waitForFunction((name) => document.getElementById("who").textContent.includes(name), rig.who(role));
}

/** Resolves when the text of the first element of `selector` contains `expected`. */
export const shown = (page, selector, expected) => page.waitForFunction(
  ([selector, expected]) => document.querySelector(selector)?.textContent.includes(expected), [selector, expected]);

/** Drops the faults of requests that found no rig, which some tests provoke. */
export function forgive(page) {
  page.faults = page.faults.filter((it) => !/ERR_(CONNECTION_REFUSED|INCOMPLETE_CHUNKED_ENCODING|EMPTY_RESPONSE|CONNECTION_RESET)/.test(it));
}

/** Checks that the page has no fault, and closes it. */
export async function leave(page) {
  assert.deepEqual(page.faults, []);
  await page.context().close();
}

/** Returns the findings of axe, mainly contrast. */
async function faults(page) {
  // Wait for transitions, whose intermediate colours axe would measure.
  await page.evaluate(() => Promise.all(document.getAnimations().map((it) => it.finished.catch(() => {}))));
  const found = await page.evaluate(async (source) => {
    new Function(source)();
    const rules = { runOnly: ["wcag2a", "wcag2aa", "wcag21aa"] };
    return (await window.axe.run(document, rules)).violations;
  }, axe).catch((error) => { throw new Error("axe: " + error); });
  return found.map((it) => it.id + ": " + it.nodes.map((node) => node.target.join(" ") + " " + node.failureSummary).join("; "));
}

/** Returns what does not fit: a scrolling window, cut-off elements, elements beyond the edge. */
const tooLarge = (page) => page.evaluate(() => {
  const root = document.scrollingElement;
  const found = [];
  if (root.scrollHeight > innerHeight || root.scrollWidth > innerWidth) found.push(`page ${root.scrollWidth}x${root.scrollHeight}`);
  for (const it of document.querySelectorAll("body > *, main > section, main > section > *, main > section > * > *, button")) {
    if (it.closest("[hidden], dialog:not([open])") || it.closest("[data-scrolls], main[hidden]") || it.scrollHeight === 0) continue;
    const over = [it.scrollWidth - it.clientWidth, it.scrollHeight - it.clientHeight];
    if (Math.max(...over) > 1 && getComputedStyle(it).overflow !== "visible") found.push(`${it.tagName} #${it.id} .${it.className} by ${over}`);
    const box = it.getBoundingClientRect();
    if (box.bottom > innerHeight + 1 || box.right > innerWidth + 1) found.push(`${it.tagName} #${it.id} ends at ${box.right},${box.bottom}`);
  }
  return found;
});

/** Saves a picture to SCREENSHOTS. */
export async function picture(page, name) {
  mkdirSync(PICTURES, { recursive: true });
  await page.screenshot({ path: join(PICTURES, name + ".png") });
}

/** Checks in both languages and themes that the page fits and is readable, and saves pictures. */
export async function looks(page, name) {
  for (const button of ["#language", "#theme", "#language", "#theme"]) {
    const [language, theme] = await page.$eval("html", (it) => [it.lang.slice(0, 2), it.dataset.theme]);
    const which = `${name}-${language}-${theme}`;
    await picture(page, which);
    assert.deepEqual(await tooLarge(page), [], which);
    // Contrast does not depend on the size.
    if (page.viewportSize().width === SIZES[0].width) assert.deepEqual(await faults(page), [], which);
    await page.click(button);
  }
}
