// People: an engineer adds, unlocks and removes them, and gives roles and passwords; the audit of these changes.

const ROLES = ["operator", "maintainer", "engineer"];
const AUDIT_DAYS = 90;
const AUDIT_LINES = 100;

const roleOptions = () => ROLES.map((it) => [it, word("role-" + it)]);

async function readPeople() {
  try {
    const people = await (await ask("/api/people")).json();
    at("p_list").replaceChildren(...people.map(personRow));
    const since = new Date(Date.now() - AUDIT_DAYS * 24 * 3600 * 1000).toISOString();
    const read = async (order) => (await ask("api/history/orders" + query({since, order}))).json();
    const lines = (await Promise.all(["people", "login"].map(read))).flat();
    lines.sort((a, b) => (a.at < b.at ? 1 : -1));
    at("p_audit").replaceChildren(...lines.slice(0, AUDIT_LINES).map((it) =>
      row(clock(it.at), whoText(it), it.origin, orderedText(it.what), outcomeText(it))));
  } catch (error) {
    at("p_list").replaceChildren();
    at("p_answer").textContent = error.message;
  }
}

// Sends a change, and shows its answer: a refusal, or the password that the rig drew.
async function changePerson(change) {
  const answer = at("p_answer");
  try {
    const reply = await post("/api/people/change", change);
    const body = await reply.json();
    answer.textContent = !reply.ok ? said(body, "reason")
      : body.password ? change.name + " " + word("people-logs_in") + " " + body.password
        : orderedText({order: "people", ...change, password: undefined}) + colon() + word("order-taken");
    // The change may concern the role of the logged-in person.
    await askWho();
    readPeople();
    return reply.ok;
  } catch {
    answer.textContent = word("stop-lost");
    return false;
  }
}

function personRow({name, role, since, locked_until: until}) {
  const roles = make("select");
  roles.setAttribute("aria-label", word("people-role") + " " + name);
  fillSelect(roles, roleOptions());
  roles.value = role;
  roles.addEventListener("change", () => changePerson({change: "role", name, role: roles.value}));
  const unlock = button(word("people-unlock"), () => changePerson({change: "unlock", name}));
  unlock.hidden = until === null;
  const field = make("div", undefined, "field");
  field.append(roles);
  const changes = make("div", undefined, "row");
  changes.append(button(word("people-password"), () => askPerson("password", name)),
    button(word("people-remove"), () => askPerson("remove", name)), unlock);
  return row(make("b", name), field, clock(since), until ? word("people-locked_until") + " " + clock(until) : NONE, changes);
}

function askPerson(change, name) {
  at("p_ask").dataset.change = change;
  at("p_ask").dataset.name = name;
  at("p_ask_title").textContent = name + " · " + word("people-" + change);
  at("p_ask_about").textContent = word("people-about-" + change);
  at("p_ask_field").hidden = change !== "password";
  at("p_ask_password").value = "";
  at("p_ask_password").placeholder = word("people-drawn");
  at("p_ask_go").textContent = word("people-" + change);
  at("p_ask").showModal();
}

at("p_ask_cancel").addEventListener("click", () => at("p_ask").close());
at("p_ask").addEventListener("submit", (event) => {
  event.preventDefault();
  at("p_ask").close();
  const {change, name} = at("p_ask").dataset;
  changePerson({change, name, password: at("p_ask_password").value || undefined});
  at("p_ask_password").value = "";
});
at("p_form").addEventListener("submit", async (event) => {
  event.preventDefault();
  const password = at("p_password").value || undefined;
  if (await changePerson({change: "add", name: at("p_name").value.trim(), role: at("p_role").value, password})) at("p_form").reset();
});

// Name and role of the person for whom the page last read the list; after another login the page reads the list again.
let peopleFor = "";

function showPeople() {
  const now = me ? me.name + " " + me.role : "";
  if (now === peopleFor) return;
  peopleFor = now;
  at("p_answer").textContent = "";
  readPeople();
}

PAGES.people = {show: showPeople, enter() {
  fillSelect(at("p_role"), roleOptions());
  at("p_password").placeholder = word("people-drawn");
  peopleFor = null;
}};
