// Tooling: plans by which people take tooling off and put it on; a started plan is ticked off step by step.

const PLAN_KINDS = ["changeover", "disassembly"];
const SIDES = {"+x": "right", "-x": "left", "+y": "rear", "-y": "front", "+z": "top", "-z": "bottom"};
// Time between two reads of the plans, ms, because another screen may tick off a step.
const PLANS_MS = 3000;
let scenes = [];
// The plan on the page: a started plan, or a preview, which has no number.
let shownPlan = null;
// Number of the plan that a person chose from the list; without a choice the page shows the plan under way.
let chosenPlan = null;
let drawnPlan = "";

const toolingAnswer = (text) => { at("t_answer").textContent = text; };
const sideText = (direction) => word("tooling_side-" + SIDES[direction]) + bracketed(direction);
const elementsText = (ids) => ids.map(bodyText).join(comma());
const mayPlan = () => me !== null && me.role !== "operator";

// --- the question ---

function showQuestion() {
  const isChangeover = at("t_kind").value === "changeover";
  at("t_to_field").hidden = !isChangeover;
  at("t_elements").hidden = isChangeover || isUnderWay();
  const elements = scenes.find((it) => it.name === at("t_from").value)?.elements ?? [];
  const chosen = new Set(chosenElements());
  const boxes = elements.map((id) => {
    const label = make("label"), box = make("input");
    box.type = "checkbox";
    box.value = id;
    box.checked = chosen.has(id);
    label.append(box, make("span", bodyText(id)));
    return label;
  });
  at("t_elements").replaceChildren(at("t_elements").firstElementChild, ...boxes);
}

const chosenElements = () => Array.from(at("t_elements").querySelectorAll("input:checked"), (it) => it.value);

function planQuestion() {
  const kind = at("t_kind").value;
  const question = {kind, scene: at("t_from").value, forbid: at("t_forbid").value ? [at("t_forbid").value] : []};
  return kind === "changeover" ? {...question, to: at("t_to").value} : {...question, remove: chosenElements()};
}

async function readScenes() {
  try {
    scenes = await (await ask("/api/plans/scenes")).json();
    const names = scenes.map((it) => [it.name, it.name]);
    const isFirst = at("t_to").value === "";
    fillSelect(at("t_from"), names);
    fillSelect(at("t_to"), names);
    if (isFirst && names.length > 1) at("t_to").value = names[1][0];
    showQuestion();
  } catch (error) {
    toolingAnswer(error.message);
  }
}

// --- orders ---

// Sends a question or an order about a plan; returns the answer, or null after showing the refusal.
async function askPlan(path, body) {
  try {
    const reply = await post("/api/plans/" + path, body);
    const found = await reply.json();
    toolingAnswer(reply.ok ? "" : said(found, "reason"));
    return reply.ok ? found : null;
  } catch {
    toolingAnswer(word("stop-lost"));
    return null;
  }
}

async function orderPlan(path, body) {
  if (me === null) { toolingAnswer(word("stop-login")); return; }
  const found = await askPlan(path, body);
  if (!found) return;
  chosenPlan = found.plan;
  showPlan(found);
  readPlans();
}

at("t_form").addEventListener("submit", async (event) => {
  event.preventDefault();
  const found = await askPlan("preview", planQuestion());
  if (!found) return;
  chosenPlan = null;
  showPlan({plan: null, end: null, shown: found});
});
at("t_start").addEventListener("click", () => orderPlan("start", planQuestion()));
at("t_print").addEventListener("click", () => open("/api/plans/paper" + query({plan: shownPlan.plan, lang: language}), "_blank"));
at("t_abandon").addEventListener("click", () => { at("t_reason").value = ""; at("t_ask").showModal(); });
at("t_ask_cancel").addEventListener("click", () => at("t_ask").close());
at("t_ask").addEventListener("submit", (event) => {
  event.preventDefault();
  at("t_ask").close();
  orderPlan("abandon", {plan: shownPlan.plan, reason: at("t_reason").value.trim()});
});
for (const id of ["t_kind", "t_from"]) at(id).addEventListener("change", showQuestion);

// --- the plan ---

const isUnderWay = () => shownPlan !== null && shownPlan.plan !== null && shownPlan.end === null;

// Adds a drawing of the server to the page; the drawing holds only shapes and classes.
function drawing(text, label) {
  const svg = document.importNode(new DOMParser().parseFromString(text, "image/svg+xml").documentElement, true);
  if (label) svg.setAttribute("aria-label", label);
  return svg;
}

function stepText(step) {
  const ways = [{direction: step.direction, distance_mm: step.distance_mm}, ...step.then];
  const far = step.clearance_mm === null ? word("tooling-beyond") : Math.floor(step.clearance_mm * 1000) / 1000 + " mm";
  const lines = [[word("tooling-way"), ways.map((it) => sideText(it.direction) + " " + it.distance_mm + " mm").join(comma())],
    [word("tooling-clearance"), far], [word("tooling-tool"), sideText(step.tool_side)]];
  if (step.slides_on.length) lines.push([word("tooling-slides"), elementsText(step.slides_on)]);
  const list = make("ul");
  list.append(...lines.map(([name, text]) => {
    const item = make("li");
    item.append(make("span", name), " " + text);
    return item;
  }));
  return list;
}

function stepOrder(code, step) {
  const order = button(word("tooling-" + code), () => orderPlan(code, {plan: shownPlan.plan, step: step.step}), "plan_" + code);
  order.dataset[code] = step.step;
  return order;
}

function stepItem(step, isNext, isLast) {
  const item = make("li", undefined, step.done ? "done" : isNext ? "next" : "");
  const title = word(step.action === "remove" ? "tooling-take_off" : "tooling-put_on") + " " + elementsText(step.elements);
  const views = make("div", undefined, "plan_views");
  views.append(...["above", "front"].map((view) => {
    const figure = make("figure");
    figure.append(drawing(step[view], title + colon() + word("tooling-" + view)), make("figcaption", word("tooling-" + view)));
    return figure;
  }));
  const text = make("div", undefined, "plan_text");
  text.append(make("h3", step.step + ". " + title), ...(step.on_bench ? [make("p", word("tooling-on_bench"))] : []), stepText(step));
  if (step.done) text.append(make("p", "\u2713 " + word("tooling-done") + colon() + step.done.who + " \u00b7 " + clock(step.done.at), "plan_done"));
  if (isNext) text.append(stepOrder("tick", step));
  if (isLast) text.append(stepOrder("untick", step));
  item.append(text, views);
  return item;
}

function aboutPlan({summary}) {
  const groups = Object.entries(summary ?? {}).filter(([, ids]) => ids.length);
  return groups.map(([code, ids]) => {
    const line = make("p");
    line.append(make("b", word("tooling-" + code)), " " + elementsText(ids));
    return line;
  });
}

function planTitle() {
  const {plan, end, shown} = shownPlan;
  const state = plan === null ? word("tooling-preview") : end ? word("tooling_end-" + end.how) : word("tooling-under_way");
  return (plan === null ? "" : plan + " \u00b7 ") + word("tooling_kind-" + shown.kind) + " \u00b7 " + state;
}

function showPlan(plan) {
  shownPlan = plan;
  const now = JSON.stringify([plan, language]);
  if (now !== drawnPlan) {
    drawnPlan = now;
    const {shown} = plan;
    const next = isUnderWay() ? shown.steps.find((it) => !it.done) : undefined;
    const last = isUnderWay() ? shown.steps.findLast((it) => it.done) : undefined;
    at("t_title").textContent = planTitle();
    at("t_about").replaceChildren(...aboutPlan(shown));
    at("t_shapes").replaceChildren(drawing(shown.shapes));
    at("t_steps").replaceChildren(...shown.steps.map((it) => stepItem(it, it === next, it === last)));
    document.querySelector("#t_steps .next")?.scrollIntoView({block: "nearest"});
  }
  showControls();
}

// A plan under way takes the place of the question.
function showControls() {
  const isOpen = isUnderWay();
  at("t_form").classList.toggle("plan_open", isOpen);
  for (const element of at("t_form").querySelectorAll("label, button")) element.hidden = isOpen || element.id === "t_to_field" && at("t_kind").value !== "changeover";
  at("t_elements").hidden = isOpen || at("t_kind").value === "changeover";
  at("t_under_way").hidden = shownPlan === null;
  for (const id of ["t_safe", "t_key"]) at(id).hidden = shownPlan === null;
  at("t_print").hidden = shownPlan === null || shownPlan.plan === null;
  at("t_abandon").hidden = !isOpen;
  const why = me === null ? word("stop-login") : "";
  for (const element of [at("t_start"), at("t_abandon"), ...document.querySelectorAll("[data-tick], [data-untick]")]) {
    element.setAttribute("aria-disabled", !mayPlan());
    element.title = why;
  }
}

// --- the list ---

function planRow(it) {
  const number = button(String(it.plan), async () => { chosenPlan = it.plan; await readPlan(it.plan); });
  const ended = it.end ? word("tooling_end-" + it.end.how) + " " + clock(it.end.at) + " " + it.end.who + (it.end.why ? colon() + it.end.why : "")
    : word("tooling-under_way");
  return row(number, word("tooling_kind-" + it.kind), it.scene + (it.to ? " \u2192 " + it.to : ""), clock(it.started), whoText(it),
    it.done + " / " + it.steps, ended);
}

async function readPlan(plan) {
  const isNewest = newest(readPlan);
  const found = await (await ask("/api/plans/show" + query({plan}))).json();
  if (isNewest()) showPlan(found);
}

let listedPlans = "";

async function readPlans() {
  if (current !== "tooling") return;
  try {
    const reply = await fetch("/api/plans/list");
    // A rig that never ran has no history.
    const plans = reply.ok ? await reply.json() : [];
    const now = JSON.stringify([plans, language]);
    if (now === listedPlans) return;
    listedPlans = now;
    at("t_past").replaceChildren(...plans.map(planRow));
    if (!plans.length) at("t_past").append(row(word("tooling-none")));
    const open = plans.find((it) => !it.end);
    if (open) await readPlan(open.plan);
    else if (chosenPlan !== null) await readPlan(chosenPlan);
  } catch (error) {
    toolingAnswer(error.message);
  }
}

setInterval(readPlans, PLANS_MS);

PAGES.tooling = {show: showControls, enter() {
  listedPlans = "";
  fillSelect(at("t_kind"), PLAN_KINDS.map((it) => [it, word("tooling_kind-" + it)]));
  fillSelect(at("t_forbid"), [["", NONE], ...Object.keys(SIDES).map((it) => [it, sideText(it)])]);
  readScenes();
  if (shownPlan) showPlan(shownPlan);
  readPlans();
}};
