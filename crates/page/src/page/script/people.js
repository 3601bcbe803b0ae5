// Login and logout.

async function askWho() {
  try { me = await (await fetch("/api/me")).json(); } catch { /* without the rig the last answer stays */ }
  showWho();
}

function showWho() {
  at("who").textContent = me ? me.name + " · " + word("logout") : word("login");
  showView();
}

at("who").addEventListener("click", async () => {
  if (me) {
    try { await post("/api/logout", {}); } catch { return; }
    me = null;
    showWho();
    return;
  }
  at("login_answer").textContent = "";
  at("login").showModal();
});
at("login_cancel").addEventListener("click", () => at("login").close());
at("login").addEventListener("submit", async (event) => {
  event.preventDefault();
  try {
    const answer = await post("/api/login", {user: at("user").value, password: at("password").value});
    const body = await answer.json();
    if (answer.ok) {
      me = body;
      at("password").value = "";
      at("login").close();
    } else {
      at("login_answer").textContent = wordOr("login-" + answer.status, whyRefused(body));
    }
  } catch {
    at("login_answer").textContent = word("stop-lost");
  }
  showWho();
});
