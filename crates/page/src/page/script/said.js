// Words made of the codes of the rig.

function stateText({doing, stage}) {
  const state = word("state-" + (doing || "none"));
  return stage ? state + ": " + known("stage-" + stage, stage) : state;
}

// Why a part did not pass.
const reasonTexts = (part) => part.reason_codes.map((it) => it[language]);
