// Texts for codes of the rig.

// State of the station, and the stage of a test under way.
const stateTexts = ({doing, stage}) => [word("state-" + (doing || "none")), ...(stage ? [wordOr("stage-" + stage, stage)] : [])];

// Reasons for the verdict of a part.
const reasonTexts = (part) => part.reason_codes.map((it) => it[language]);
