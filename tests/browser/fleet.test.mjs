// The page of all rigs: from their state to a raw reply, in both languages, and while the database is lost.
//
// Environment: DATABASE, the address (HOST:PORT) of an empty database `relayrig` of the user `owner`, without password.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { cpSync, rmSync, writeFileSync } from "node:fs";
import { connect, createServer } from "node:net";
import { SIZES, leave, looks, open, press, shown, visit } from "./browser.mjs";
import { WORDS, command, serveFleet } from "./rig.mjs";

const CONFIG = "config-fleet";
const RIG = "suzhou / rig-07";

/** Passes connections on to the database; `lose` cuts them all, `find` takes new ones again. */
class Way {
  async begin() {
    const [host, port] = (process.env.DATABASE ?? "").split(":");
    if (!port) throw new Error("DATABASE: found none, expected HOST:PORT of an empty database");
    this.open = new Set();
    this.server = createServer((near) => {
      const far = connect(Number(port), host);
      for (const [one, other] of [[near, far], [far, near]]) {
        this.open.add(one);
        one.on("error", () => {}).on("close", () => { this.open.delete(one); other.destroy(); });
        one.pipe(other);
      }
    });
    await this.find(0);
    this.port = this.server.address().port;
  }

  find(port = this.port) {
    return new Promise((resolve) => this.server.listen(port, "127.0.0.1", resolve));
  }

  lose() {
    const closed = new Promise((resolve) => this.server.close(resolve));
    for (const it of this.open) it.destroy();
    return closed;
  }
}

const way = new Way();
let fleet, browser;
before(async () => {
  await way.begin();
  cpSync("config", CONFIG, { recursive: true });
  writeFileSync(CONFIG + "/fleet.toml", `site = "suzhou"
rig = "rig-07"
[[target]]
url = "postgres://owner@127.0.0.1:${way.port}/relayrig"
tls = "off"
samples = "all"
[[shift]]
name = "day"
start = "00:00"
end = "00:00"
`);
  for (const end of [".db", ".db-wal", ".db-shm"]) rmSync("fleet" + end, { force: true });
  for (const words of ["fleet init", "fleet generate --rigs 3 --parts 900 --days 1",
    "run --sim --lot A --recipe jzc-22f-012 --count 6 --seed 1", "fleet push"]) {
    await command(CONFIG, "fleet", words.split(" "));
  }
  [fleet, browser] = await Promise.all([serveFleet(CONFIG, "fleet"), open()]);
});
after(async () => {
  await browser?.close();
  await fleet?.kill();
  await way.lose();
});

test("the page leads from all rigs to a raw reply", async () => {
  const page = await visit(browser, fleet);
  await page.waitForFunction(() => document.querySelectorAll("#rigs tr").length === 4);
  await shown(page, "#rigs", RIG);
  await shown(page, "#link", WORDS["rigs-link-fresh"].en);
  await page.waitForFunction(() => document.querySelectorAll("#shifts tr").length >= 4);
  await page.click(`#rigs a:text-is("${RIG}")`);
  await page.waitForSelector("#rig:visible");
  assert.equal(await page.$$eval("#rigs tr", (all) => all.length), 1);
  await page.click("#rig_lot");
  await page.waitForFunction(() => document.querySelectorAll("#parts tr").length === 6);
  await page.click("#parts tr a");
  await page.waitForSelector("#part_replies tr");
  assert.match(await page.textContent("#part_replies"), /!|>/);
  await leave(page);
});

test("the page of a rig shows no order and no login", async () => {
  const page = await visit(browser, fleet, { path: "/rigs/suzhou/rig-07/" });
  await shown(page, "#of_rig", RIG);
  assert.equal(await page.$$eval("#who, #login", (all) => all.length), 0);
  const refused = await fetch(fleet.url + "/api/orders", { method: "POST", body: "{}" });
  assert.equal(refused.status, 404);
  await page.click('nav a[href="#quality"]');
  await page.waitForSelector("#q_charts svg");
  await leave(page);
});

test("a lost database is named, and forgotten when it answers", async () => {
  const page = await visit(browser, fleet, { language: "zh" });
  await shown(page, "#rigs", RIG);
  await way.lose();
  await shown(page, "#link", WORDS["rigs-link-no_database"].zh);
  await shown(page, "#trouble", WORDS["rigs_remedy-network"].zh);
  await shown(page, "#rigs", RIG);
  await way.find();
  await shown(page, "#link", WORDS["rigs-link-fresh"].zh);
  assert.equal(await page.isVisible("#trouble"), false);
  await leave(page);
});

for (const size of SIZES) {
  test(`at ${size.width}x${size.height} the rigs fit and can be read`, async () => {
    const page = await visit(browser, fleet, { size });
    await page.waitForFunction(() => document.querySelectorAll("#shifts tr").length >= 4);
    await looks(page, `fleet-${size.width}`);
    await page.goto(fleet.url + "/rigs/suzhou/rig-07/");
    await page.waitForSelector("#rig:visible");
    await looks(page, `fleet-rig-${size.width}`);
    await press(page, 'nav a[href="#history"]');
    await page.waitForSelector("#parts tr a");
    await looks(page, `fleet-history-${size.width}`);
    await leave(page);
  });
}
