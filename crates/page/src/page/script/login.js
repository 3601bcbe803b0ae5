// Login, logout, one's own password, and the set-up of the first engineer.

async function askWho() {
  try { me = await (await fetch("/api/me")).json(); } catch { /* without the rig the last answer stays */ }
  showWho();
}

function showWho() {
  at("who").textContent = me ? me.name + " · " + word("role-" + me.role) : word("login");
  showView();
}

// Sends `session` to a route that opens a session; shows a refusal at `answer`. Returns true when the session is open.
async function openSession(path, session, answer) {
  answer.textContent = "";
  try {
    const reply = await post(path, session);
    const body = await reply.json();
    if (reply.ok) me = body;
    else answer.textContent = wordOr(path === "/api/login" ? "login-" + reply.status : "", said(body, "reason"));
    return reply.ok;
  } catch {
    answer.textContent = word("stop-lost");
    return false;
  } finally {
    showWho();
  }
}

function clearPasswords() {
  for (const id of ["password", "own_present", "own_new", "own_again"]) at(id).value = "";
}

at("who").addEventListener("click", async () => {
  showMenu(false);
  clearPasswords();
  for (const id of ["login_answer", "account_answer"]) at(id).textContent = "";
  if (me) {
    at("account_title").textContent = at("who").textContent;
    at("account_people").hidden = me.role !== "engineer";
    at("account").showModal();
    return;
  }
  let needed = false;
  try { ({needed} = await (await ask("/api/setup/needed")).json()); } catch { /* the login says what is wrong */ }
  at("login").dataset.setup = needed;
  for (const element of document.querySelectorAll("#login .setup")) element.hidden = !needed;
  at("setup_code").required = needed;
  at("login_title").textContent = word(needed ? "setup-title" : "login");
  at("login").showModal();
});
at("login_cancel").addEventListener("click", () => at("login").close());
at("login").addEventListener("submit", async (event) => {
  event.preventDefault();
  const session = {user: at("user").value, password: at("password").value};
  const opened = at("login").dataset.setup === "true"
    ? await openSession("/api/setup", {...session, code: at("setup_code").value}, at("login_answer"))
    : await openSession("/api/login", session, at("login_answer"));
  if (!opened) return;
  clearPasswords();
  at("login").close();
});

at("account_cancel").addEventListener("click", () => at("account").close());
at("account_people").addEventListener("click", () => at("account").close());
at("account_logout").addEventListener("click", async () => {
  try { await post("/api/logout", {}); } catch { return; }
  me = null;
  at("account").close();
  showWho();
});
at("account").addEventListener("submit", async (event) => {
  event.preventDefault();
  const answer = at("account_answer");
  if (at("own_new").value !== at("own_again").value) {
    answer.textContent = word("account-differ");
    return;
  }
  if (!await openSession("/api/password", {present: at("own_present").value, new: at("own_new").value}, answer)) return;
  clearPasswords();
  answer.textContent = word("account-changed");
});
