// Shows views, and starts everything.

function showView() {
  showLink();
  if (!view) return;
  at("simulated").hidden = !view.simulated;
  for (const id of ["lot", "recipe"]) {
    at(id).textContent = view[id] || NONE;
    at(id).title = view[id];
  }
  showAlarmBar(view.alarms);
  showPrompt();
  sound(view.alarms);
  recordActivity();
  showOrders();
  PAGES[current]?.show?.();
}

// Writes the words that the scripts of the operator's page add.
function translateMore() {
  nameBodies();
  showWho();
}

makeOrders();
showAll();
askWho();
fetchMimic();
connect();
