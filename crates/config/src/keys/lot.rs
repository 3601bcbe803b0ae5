//! Keys of `lot.toml`.

use machine::form::{Form, Key, above_zero, key, optional, whole};

const GOLDEN_CHECK: &[Key] = keys! {
    optional("at_start", Form::Flag, "station", "check before a lot that runs on a stored calibration");
    optional("after_parts", whole(1, 1_000_000, ""), "station",
        "number of parts between checks; the reference part lies there in the magazine");
    optional("after_h", above_zero(1000.0, "h"), "station",
        "hours between checks; the line holds until the reference part is loaded");
};

const WEAR: &[Key] = keys! {
    optional("probe_touches", whole(1, 1_000_000_000, ""), "station", "times that the probes rise before they are worn");
    optional("jaw_closings", whole(1, 1_000_000_000, ""), "station", "times that the jaws close before they are worn");
    optional("probe_contact_ohm", above_zero(20.0, "ohm"), "station",
        "both force contacts of the coil in series, mean over the last parts, beyond what they were at the calibration");
};

const SERIAL: &[Key] = keys! {
    key("source", Form::Choice(&["counted", "reader", "wedge"]), "station",
        "the rig counts; a reader at the pocket ([serial_reader] of rig.toml) reads each part; a person scans each part before loading it");
    optional("template", Form::Text, "station",
        "form of a counted number, with {lot} and {number} (or {number:06}: six digits); default {lot}-{number:06}");
};

/// All keys of `lot.toml`.
pub const FILE: &[Key] = keys! {
    optional("first_article_parts", whole(0, 1000, ""), "station",
        "parts at the begin of a run that get confirmation measurements; 0 without it");
    optional("discard_limit_pct", above_zero(100.0, "%"), "station",
        "reject-rate limit: failed parts that a lot may have, of its size; one more holds the line");
    optional("golden_check", Form::Table(GOLDEN_CHECK), "station",
        "when a reference part is measured and compared with its certificate");
    optional("prompt", Form::List(&Form::Table(super::recipe::PROMPT)), "station", "as in a recipe, for every lot; these come first");
    optional("serial", Form::Table(SERIAL), "station", "where the serial number of each part comes from; without it parts have none");
    optional("wear", Form::Table(WEAR), "station", "uses of probes and jaws at which an alarm says that they are worn");
};
