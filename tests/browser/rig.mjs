// Runs the program under test, `relayrig demo` or `serve --sim`, on a free port with a history and people of its own.
//
// Virtual time follows the wall clock at a given speed: a busy machine makes the rig slow, never wrong.
// Environment: RELAYRIG, the absolute path of the program. The working folder holds `config/`.

import { spawn, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

export const PASSWORD = "open sesame";
const PEOPLE = { operator: "li", maintainer: "wang", engineer: "zhao" };
const PROGRAM = process.env.RELAYRIG;

/** Starts `relayrig demo` with `words` over the files `name`, which must be unique; resolves when the server listens. */
export const start = (name, ...words) => begin(name, ["demo", ...words]);

/** Does the same over the configuration in the folder `config`. */
export const startIn = (config, name, ...words) => begin(name, ["demo", ...words], config);

/** Does the same with `relayrig serve --sim`, which starts no lot. */
export const serve = (name, ...words) => begin(name, ["serve", "--sim", ...words]);

/** Does the same over the configuration in the folder `config`. */
export const serveIn = (config, name, ...words) => begin(name, ["serve", "--sim", ...words], config);

/** Starts `relayrig demo` with nothing but the program: in an empty folder, which goes when the program is killed. */
export async function startAlone() {
  const rig = new Rig(["--log", "warn", "demo", "--listen", "127.0.0.1:0"], mkdtempSync(join(tmpdir(), "relayrig-")));
  await rig.listening;
  return rig;
}

/** Starts the page of all rigs of the database in `config/fleet.toml`. */
export async function serveFleet(config, name) {
  const rigs = new Rig(["--config", config, "--log", "warn", "--db", name + ".db", "fleet", "serve", "--listen", "127.0.0.1:0"]);
  await rigs.listening;
  return rigs;
}

/** Runs a command of the program to its end; fails with what it says. */
export async function command(config, name, words) {
  const child = spawn(PROGRAM, ["--config", config, "--log", "warn", "--db", name + ".db", ...words], { stdio: ["ignore", "ignore", "pipe"] });
  let told = "";
  child.stderr.on("data", (text) => told += text);
  const status = await new Promise((resolve) => child.on("close", resolve));
  if (status !== 0) throw new Error(`${words.join(" ")}: ${told}`);
}

/** Adds a person to the people of the rig with the files `name`. */
export function addPerson(name, user, role) {
  const added = spawnSync(PROGRAM, ["--db", name + ".db", "user", "add", user, "--role", role, "--stdin"], { input: PASSWORD + "\n" });
  if (added.status !== 0) throw new Error(String(added.stderr));
}

async function begin(name, words, config = "config") {
  for (const end of [".db", ".db-wal", ".db-shm", "-access.db"]) rmSync(name + end, { force: true });
  for (const [role, user] of Object.entries(PEOPLE)) addPerson(name, user, role);
  const rig = new Rig(["--config", config, "--log", "warn", "--db", name + ".db", ...words, "--listen", "127.0.0.1:0"]);
  await rig.listening;
  return rig;
}

class Rig {
  constructor(words, folder) {
    this.words = words;
    this.folder = folder;
    this.run();
  }

  run() {
    this.told = "";
    this.process = spawn(PROGRAM, this.words, { cwd: this.folder, stdio: ["ignore", "ignore", "pipe"] });
    this.ended = new Promise((resolve) => this.process.on("exit", resolve));
    this.listening = new Promise((resolve, reject) => {
      this.process.stderr.on("data", (text) => {
        this.told += text;
        const found = /page (?:of all rigs )?at (http:\/\/[^/]+)\//.exec(this.told);
        if (found) resolve(this.url = found[1]);
      });
      this.process.on("exit", () => reject(new Error("the program ended: " + this.told)));
    });
    // A killed program rejects `listening` too, which no test awaits then.
    this.listening.catch(() => {});
  }

  /** Name of the person with this role; a name that is no role stays. */
  who(role) {
    return PEOPLE[role] ?? role;
  }

  async view() {
    return (await fetch(this.url + "/api/view")).json();
  }

  /** Returns the first view that satisfies `test`. */
  async until(what, test, seconds = 180) {
    const end = Date.now() + seconds * 1000;
    for (;;) {
      const view = await this.view();
      if (await test(view)) return view;
      if (Date.now() > end) throw new Error(`not within ${seconds} s: ${what}; state ${view.state}, ${JSON.stringify(view.alarms)}`);
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
  }

  /** Kills the program. */
  async kill() {
    this.process.kill("SIGKILL");
    await this.ended;
    if (this.folder) rmSync(this.folder, { recursive: true });
  }

  /** Starts the program again at the same address. */
  async again() {
    this.words[this.words.indexOf("--listen") + 1] = new URL(this.url).host;
    this.run();
    await this.listening;
  }
}

/** Returns the texts of a language by id, without attributes. */
function texts(tag) {
  const file = readFileSync(new URL(`../../locale/${tag}.ftl`, import.meta.url), "utf8");
  return file.split("\n").map((line) => /^([a-z][\w-]*) = (.*)$/i.exec(line)).filter(Boolean).map(([, id, text]) => [id, text]);
}

const ZH = Object.fromEntries(texts("zh"));

/** Every text in both languages. */
export const WORDS = Object.fromEntries(texts("en").map(([id, en]) => [id, {en, zh: ZH[id]}]));
