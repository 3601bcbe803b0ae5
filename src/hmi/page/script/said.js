// Words made of what the rig says.

function stateText(state) {
  const testing = /^testing: (\w+)/.exec(state);
  if (!testing) return known("state-" + state, state);
  return word("state-testing") + ": " + known("stage-" + testing[1], testing[1]);
}

// Why a part did not pass.
const reasonTexts = (part) => part.reason_codes.map((it) => it[language]);
