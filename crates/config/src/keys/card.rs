//! Keys of `card.toml`.

use machine::form::{Form, Key, from_to, key, whole};

const QUOTA: &[Key] = keys! {
    key("machine_s", from_to(0.0, 3600.0, "s"), "report", "planned time of the step itself");
    key("auxiliary_s", from_to(0.0, 3600.0, "s"), "report", "planned time beside it that overlaps nothing else");
};

/// All keys of `card.toml`.
pub const FILE: &[Key] = keys! {
    key("workshop", Form::Text, "report", "workshop of the card");
    key("operation_no", Form::Text, "report", "number of the operation in the process");
    key("equipment_model", Form::Text, "report", "type of the rig");
    key("equipment_no", Form::Text, "report", "inventory number of the rig");
    key("fixture_no", Form::Text, "report", "number of nest and pin block");
    key("pieces_at_once", whole(1, 100, ""), "report", "parts tested at the same time");
    key("preparation_min", from_to(0.0, 1440.0, "min"), "report", "preparing and ending a lot");
    key("quota", Form::Each(machine::dut::card::STEPS, &Form::Table(QUOTA)), "report",
        "time quota of each step of the card");
};
