//! Keys of a resistor's recipe.

use crate::dut::keys::{BODY, PIN_LENGTH, REFERENCE_TEMPERATURE, Sections, limit, table};
use crate::form::{Key, above_zero, from_to, key, whole};

/// Keys of the sections `[part]`, `[limits]` and `[test]`.
pub const SECTIONS: Sections = Sections {
    part: PART,
    limits: LIMITS,
    external: &[],
    test: TEST,
};

const PART: &[Key] = table! {
    BODY;
    PIN_LENGTH;
    REFERENCE_TEMPERATURE;
    key("tcr_ppm_per_k", from_to(-1000.0, 1000.0, "ppm/K"), "gauge", "temperature coefficient of the resistor");
};

const LIMITS: &[Key] = table! {
    key("resistance_ohm", limit!("ohm", 100_000.0), "gauge", "resistance between the coil pins");
};

const TEST: &[Key] = table! {
    key("level_v", above_zero(1000.0, "V"), "station", "voltage across the resistor");
    key("settles_ms", whole(1, 1000, "ms"), "station", "from the drive to the first conversion that counts");
    key("readings", whole(1, 100, ""), "station", "readings that are averaged");
};
