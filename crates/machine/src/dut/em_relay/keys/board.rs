//! Keys of the interface board in `config/rig.toml`: references, and accuracies for relays.

use crate::dut::keys::table;
use crate::form::{Key, above_zero, from_to, key};

/// Keys of `[reference]`.
pub const REFERENCE: &[Key] = table! {
    key("coil_ohm", above_zero(100_000.0, "ohm"), "gauge", "reference resistor in place of the coil");
    key("coil_tolerance_pct", from_to(0.0, 10.0, "%"), "gauge", "its tolerance");
    key("contact_mohm", above_zero(100_000.0, "mOhm"), "gauge", "four-wire reference in place of the contact");
    key("contact_tolerance_pct", from_to(0.0, 10.0, "%"), "gauge", "its tolerance");
    key("voltage_v", above_zero(10.0, "V"), "gauge", "voltage at reference_voltage");
    key("voltage_tolerance_pct", from_to(0.0, 10.0, "%"), "gauge", "its tolerance");
    key("gate_pulse_ms", above_zero(1000.0, "ms"), "gauge", "pulse at the counter gates that ARM gives with the contact reference");
    key("counter_clock_hz", from_to(1000.0, 100_000.0, "Hz"), "gauge", "clock of the gated counters");
    key("counter_clock_tolerance_ppm", from_to(0.0, 10_000.0, "ppm"), "gauge", "its tolerance");
};

/// Key of `[accuracy]`: delay of the counter gates.
pub const GATE_DELAY: Key = key(
    "gate_delay_us",
    from_to(0.0, 1000.0, "us"),
    "gauge",
    "delay of the counter gates",
);

/// Key of `[accuracy]`: scatter of a threshold from operation to operation.
pub const OPERATION_SCATTER: Key = key(
    "operation_scatter_mv",
    from_to(0.0, 1000.0, "mV"),
    "gauge",
    "threshold of a 12 V coil from operation to operation, standard deviation; of other coils in proportion",
);
