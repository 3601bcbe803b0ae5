// Words made of what the rig says.

function stateText(state) {
  const testing = /^testing: (\w+)/.exec(state);
  if (!testing) return known("state." + state, state);
  return word("state.testing") + ": " + known("stage." + testing[1], testing[1]);
}

// Why a part did not pass: by code, where the page has words for it, else as the rig says it.
function reasonTexts(part) {
  return part.reasons.map((text, place) => {
    const {code, param, side} = part.reason_codes[place];
    const said = FINDINGS[code]?.[language] ?? known("reason." + code + (side ? "." + side : ""), null);
    return said === null ? text : (param ? nameOf(param) + " " : "") + said;
  });
}
