// Texts for codes of the rig.

// Returns the state of the station and, during a test, its stage.
const stateTexts = ({doing, stage}) => [word("state-" + (doing || "none")), ...(stage ? [wordOr("stage-" + stage, stage)] : [])];

// Returns the reasons for the verdict of a part.
const reasonTexts = (part) => part.reason_codes.map((it) => it[language]);
