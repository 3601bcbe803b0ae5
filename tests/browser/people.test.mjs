// People at the page: the first engineer, changes of people, one's own password.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { SIZES, leave, logIn, looks, open, picture, press, shown, untouchable, visit } from "./browser.mjs";
import { PASSWORD, WORDS, serve, startAlone } from "./rig.mjs";

let rig, browser;
before(async () => {
  [rig, browser] = await Promise.all([serve("people", "--speed", "5"), open()]);
});
after(async () => {
  await browser?.close();
  await rig?.kill();
});

const personRow = (page, name) => page.locator("#p_list tr", { has: page.locator("b", { hasText: new RegExp(`^${name}$`) }) });

async function enter(page, user, password) {
  await page.click("#who");
  await page.fill("#user", user);
  await page.fill("#password", password);
  await page.click("#login_go");
}

async function leaveSession(page) {
  await page.click("#who");
  await page.click("#account_logout");
  await shown(page, "#who", WORDS.login.en);
}

test("the set-up code of the program adds the first engineer", async (t) => {
  const alone = await startAlone();
  t.after(() => alone.kill());
  const [, code] = /set-up code (\S+),/.exec(alone.told);
  const page = await visit(browser, alone);
  await page.click("#who");
  await shown(page, "#login_title", WORDS["setup-title"].en);
  await picture(page, "people-setup");
  await page.fill("#user", "zhao");
  await page.fill("#password", PASSWORD);
  await page.fill("#setup_code", "AAAA-AAAA");
  await page.click("#login_go");
  await shown(page, "#login_answer", WORDS["refusal-wrong_code"].en);
  await page.fill("#setup_code", code);
  await page.click("#login_go");
  await shown(page, "#who", "zhao");
  await leaveSession(page);
  await page.click("#who");
  assert.equal(await page.isVisible("#setup_code"), false);
  await leave(page);
});

test("an engineer adds, promotes, unlocks and removes a person", async () => {
  const page = await visit(browser, rig, { role: "engineer" });
  await page.click("#who");
  await picture(page, "people-account");
  await page.click("#account_people");
  await personRow(page, rig.who("operator")).waitFor();
  await page.fill("#p_name", "sun");
  await page.click('#p_form button[type="submit"]');
  await shown(page, "#p_answer", WORDS["people-logs_in"].en);
  const drawn = (await page.textContent("#p_answer")).split(" ").at(-1);
  await personRow(page, "sun").locator("select").selectOption("maintainer");
  await shown(page, "#p_answer", WORDS["people-change_role"].en);
  const guess = await visit(browser, rig);
  for (let tries = 0; tries < 5; tries += 1) {
    await guess.click("#who");
    await guess.fill("#user", "sun");
    await guess.fill("#password", "guessed wrong");
    const answered = guess.waitForResponse("**/api/login");
    await guess.click("#login_go");
    assert.equal((await answered).status(), 401);
    await guess.click("#login_cancel");
  }
  await enter(guess, "sun", drawn);
  await shown(guess, "#login_answer", WORDS["login-429"].en);
  await guess.click("#login_cancel");
  await page.reload();
  await shown(page, "#p_audit", WORDS["refusal-wrong_password"].en);
  await personRow(page, "sun").getByRole("button", { name: WORDS["people-unlock"].en }).click();
  await shown(page, "#p_answer", WORDS["people-unlock"].en);
  await enter(guess, "sun", drawn);
  await shown(guess, "#who", WORDS["role-maintainer"].en);
  await personRow(page, "sun").getByRole("button", { name: WORDS["people-remove"].en }).click();
  await picture(page, "people-remove");
  await page.click("#p_ask_go");
  await personRow(page, "sun").waitFor({ state: "detached" });
  await guess.reload();
  await shown(guess, "#who", WORDS.login.en);
  await leave(guess);
  await leave(page);
});

test("the last engineer cannot be lost at the page", async () => {
  const page = await visit(browser, rig, { role: "engineer", path: "/#people" });
  await personRow(page, rig.who("engineer")).locator("select").selectOption("operator");
  await shown(page, "#p_answer", "is the only engineer");
  await leave(page);
});

for (const size of SIZES) {
  test(`at ${size.width}x${size.height} the page of people and its dialogs fit and can be read`, async () => {
    const page = await visit(browser, rig, { role: "engineer", path: "/#people", size });
    await personRow(page, rig.who("engineer")).waitFor();
    await looks(page, `people-${size.width}`);
    await press(page, "#who");
    await picture(page, `people-account-${size.width}`);
    assert.deepEqual(await untouchable(page), []);
    await leave(page);
  });
}

test("everybody changes the own password", async () => {
  const page = await visit(browser, rig, { role: "maintainer" });
  await page.click("#who");
  await page.fill("#own_present", PASSWORD);
  await page.fill("#own_new", "another one");
  await page.fill("#own_again", "another two");
  await page.click("#account_go");
  await shown(page, "#account_answer", WORDS["account-differ"].en);
  await page.fill("#own_again", "another one");
  await page.click("#account_go");
  await shown(page, "#account_answer", WORDS["account-changed"].en);
  assert.equal(await page.isVisible("#account_people"), false);
  await page.click("#account_cancel");
  await leaveSession(page);
  await enter(page, rig.who("maintainer"), "another one");
  await shown(page, "#who", rig.who("maintainer"));
  await leave(page);
});

test("the page of people shows nothing without an engineer", async () => {
  const page = await visit(browser, rig, { path: "/#people" });
  await shown(page, "#p_answer", WORDS["refusal-not_logged_in"].en);
  await logIn(page, rig, "operator");
  await page.reload();
  await shown(page, "#p_answer", WORDS["role-operator"].en);
  assert.equal(await page.locator("#p_list tr").count(), 0);
  await leave(page);
});
