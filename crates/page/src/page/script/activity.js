// What moved and tested over the last seconds, kept from the first view on: the page of quality draws it.

const SPAN_MS = 10000;
let seen = [];

function notice() {
  const now = performance.now();
  const busy = view.machine.actuators.filter((it) => it.moving).map((it) => it.name);
  if (view.stage) busy.push("test");
  seen = [...seen.filter((it) => now - it.at < SPAN_MS), {at: now, busy}];
}
