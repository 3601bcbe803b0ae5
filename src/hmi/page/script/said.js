// Words made of what the rig says.

function stateText(state) {
  const testing = /^testing: (\w+)/.exec(state);
  if (!testing) return known("state." + state, state);
  return word("state.testing") + ": " + known("stage." + testing[1], testing[1]);
}

function reasonText(reason) {
  if (Object.hasOwn(WORDS, "text." + reason)) return word("text." + reason);
  const space = reason.indexOf(" ");
  const key = reason.slice(0, space), rest = reason.slice(space + 1);
  if (!KEYS.includes(key)) return reason;
  return word("key." + key) + " " + known("reason." + rest, rest);
}
