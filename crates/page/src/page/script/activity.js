// Records moving actuators and tests of the last seconds, from the first view on, for the page of quality.

const SPAN_MS = 10000;
let activity = [];

function recordActivity() {
  const now = performance.now();
  const busy = view.machine.actuators.filter((it) => it.moving).map((it) => it.name);
  if (view.stage) busy.push("test");
  activity = [...activity.filter((it) => now - it.at < SPAN_MS), {at: now, busy}];
}
