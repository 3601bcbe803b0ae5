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
/** Sizes of panel PCs, of an office screen and of a phone, pixels. */
export const SIZES = [{ width: 1280, height: 800 }, { width: 1024, height: 768 }, { width: 1920, height: 1080 }, { width: 390, height: 844 }];
/** Widest screen that shows the pages in one column, which scrolls. */
const NARROW = 899;
/** Widest screen that a finger uses, and the least size of what it hits, pixels. */
const TOUCHED = 1199, FINGER = 44;
/** Least size of a text in a drawing, pixels. */
const READABLE = 9;
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

/** Clicks a button of the header, which a narrow screen has in its menu. */
export async function press(page, button) {
  if (!await page.isVisible(button)) await page.click("#menu");
  await page.click(button);
}

/** Clicks a button that may be disabled, once it is visible: the page answers with its reason. */
export async function clickRefused(button) {
  await button.waitFor();
  await button.click({ force: true });
}

export async function logIn(page, rig, role) {
  await press(page, "#who");
  await page.fill("#user", rig.who(role));
  await page.fill("#password", PASSWORD);
  await page.click("#login_go");
  await page.waitForFunction((name) => document.getElementById("who").textContent.includes(name), rig.who(role));
}

/** Resolves when the text of the first element of `selector` contains `expected`; fails with the text that it shows. */
export async function shown(page, selector, expected) {
  const contains = ([selector, expected]) => document.querySelector(selector)?.textContent.includes(expected);
  await page.waitForFunction(contains, [selector, expected]).catch(async (error) => {
    const found = await page.textContent(selector, { timeout: 1_000 }).catch(() => "no element");
    throw new Error(`${selector} shows "${found}", expected "${expected}"`, { cause: error });
  });
}

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

/** Returns what does not fit: a scrolling window, cut-off elements, elements beyond the edge. Only a narrow screen may scroll, and only down. */
export const tooLarge = (page) => page.evaluate((narrow) => {
  const root = document.scrollingElement;
  const found = [];
  for (const it of document.querySelectorAll("main, [data-scrolls]")) {
    if (it.scrollWidth > it.clientWidth) found.push(`${it.tagName} .${it.className} scrolls sideways by ${it.scrollWidth - it.clientWidth}`);
  }
  if (root.scrollHeight > innerHeight || root.scrollWidth > innerWidth) found.push(`page ${root.scrollWidth}x${root.scrollHeight}`);
  for (const it of document.querySelectorAll("body > *, main > section, main > section > *, main > section > * > *, button")) {
    if (it.closest("[hidden], dialog:not([open]), [data-scrolls]") || it.scrollHeight === 0 || innerWidth <= narrow && it.matches("main")) continue;
    const over = [it.scrollWidth - it.clientWidth, it.scrollHeight - it.clientHeight];
    if (Math.max(...over) > 1 && getComputedStyle(it).overflow !== "visible") found.push(`${it.tagName} #${it.id} .${it.className} by ${over}`);
    const box = it.getBoundingClientRect();
    if (box.right > innerWidth + 1 || box.bottom > innerHeight + 1 && (innerWidth > narrow || !it.closest("main"))) found.push(`${it.tagName} #${it.id} ends at ${box.right},${box.bottom}`);
  }
  return found;
}, NARROW);

/** Returns the controls in view that overlap another one or are too small for a finger. */
export const untouchable = (page) => page.evaluate(([touched, finger]) => {
  // Returns the part of an element that is not cut off.
  const seen = (it) => {
    const box = it.getBoundingClientRect();
    let [left, top, right, bottom] = [box.left, box.top, box.right, box.bottom];
    for (let up = it.parentElement; up; up = up.parentElement) {
      if (getComputedStyle(up).overflow === "visible") continue;
      const clip = up.getBoundingClientRect();
      [left, top, right, bottom] = [Math.max(left, clip.left), Math.max(top, clip.top), Math.min(right, clip.right), Math.min(bottom, clip.bottom)];
    }
    return { it, box, left, top, right, bottom };
  };
  const said = (it) => `${it.tagName} #${it.id} ${it.textContent.slice(0, 20)}`;
  const open = document.querySelector("dialog[open]") ?? document;
  const all = Array.from(open.querySelectorAll("a, button, input, select, summary"), seen).filter((it) => it.right - it.left > 1 && it.bottom - it.top > 1);
  const small = innerWidth > touched ? [] : all.filter(({ box }) => Math.min(box.width, box.height) < finger - .5);
  const pairs = all.flatMap((a, place) => all.slice(place + 1).filter((b) =>
    Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1).map((b) => [a.it, b.it]));
  return [...small.map(({ it, box }) => `${said(it)} is ${box.width} x ${box.height}`), ...pairs.map(([a, b]) => `${said(a)} over ${said(b)}`)];
}, [TOUCHED, FINGER]);

/** Returns the texts of drawings that are too small to read. */
const unreadable = (page) => page.evaluate((least) => Array.from(document.querySelectorAll("svg text"), (it) => {
  const size = it.getScreenCTM() ? parseFloat(getComputedStyle(it).fontSize) * it.getScreenCTM().a : least;
  return it.getClientRects().length && size < least ? `${it.textContent} has ${size.toFixed(1)} pixels` : "";
}).filter(Boolean), READABLE);

/** Saves a picture to SCREENSHOTS. */
export async function picture(page, name) {
  mkdirSync(PICTURES, { recursive: true });
  await page.screenshot({ path: join(PICTURES, name + ".png") });
}

/** Checks in both languages, at the first size also in both themes, that the page fits and is readable; saves pictures. */
export async function looks(page, name) {
  const isFirst = page.viewportSize().width === SIZES[0].width;
  for (const button of isFirst ? ["#language", "#theme", "#language", "#theme"] : ["#language", "#language"]) {
    const [language, theme] = await page.$eval("html", (it) => [it.lang.slice(0, 2), it.dataset.theme]);
    const which = `${name}-${language}-${theme}`;
    await picture(page, which);
    assert.deepEqual([await tooLarge(page), await untouchable(page), await unreadable(page)], [[], [], []], which);
    // Colours depend on the theme alone.
    if (isFirst || language === "en") assert.deepEqual(await faults(page), [], which);
    await press(page, button);
  }
}
