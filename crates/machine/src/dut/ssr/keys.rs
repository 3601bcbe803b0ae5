//! Keys of the recipe of a solid-state relay.

use crate::dut::keys::{BODY, PIN_LENGTH, Sections, limit, table};
use crate::form::{Form, Key, above_zero, from_to, key, optional};

/// Keys of the sections `[part]`, `[limits]` and `[test]`.
pub const SECTIONS: Sections = Sections {
    part: PART,
    limits: LIMITS,
    test: TEST,
};

const PART: &[Key] = table! {
    BODY;
    PIN_LENGTH;
    key("output", Form::Choice(&["dc"]), "station", "what the output switches: a DC load, with MOSFETs");
    key("control_v", above_zero(19.0, "V"), "station", "nominal control voltage");
    key("rated_v", above_zero(200.0, "V"), "station", "voltage of the blocked output");
    key("rated_a", above_zero(100.0, "A"), "gauge", "current of the conducting output");
    optional("body_diode", Form::Flag, "station", "whether the output conducts when reversed; default false");
};

const LIMITS: &[Key] = table! {
    key("v_on_v", limit!("V", 32.0), "gauge", "control voltage at and above which the output conducts");
    key("v_off_v", limit!("V", 32.0), "gauge", "control voltage at and below which the output blocks");
    key("i_in_ma", limit!("mA", 1000.0), "gauge", "current of the control input at control_v");
    key("i_rev_ua", limit!("uA", 10_000.0), "gauge", "current of the reversed control input at reverse_v");
    key("t_on_us", limit!("us", 100_000.0), "gauge", "control edge to 90 % of the load voltage");
    key("t_off_us", limit!("us", 100_000.0), "gauge", "control edge to 10 % of the load voltage");
    key("v_drop_v", limit!("V", 100.0), "gauge", "drop of the conducting output at rated_a");
    key("r_on_mohm", limit!("mOhm", 100_000.0), "gauge", "resistance of the conducting output");
    key("i_leak_ua", limit!("uA", 10_000.0), "gauge", "current of the blocked output at rated_v, before it has conducted");
    key("i_leak_hot_ua", limit!("uA", 10_000.0), "gauge", "the same after it has conducted");
    key("drift_mv", limit!("mV", 1000.0), "gauge", "rise of the drop from 10 ms to 200 ms at 1 A, or at rated_a below 1 A");
};

const TEST: &[Key] = table! {
    key("method", Form::Choice(&["conformity", "bisect"]), "station",
        "whether a search finds v_on_v and v_off_v after the conformity test, which alone decides");
    key("resolution_mv", from_to(1.0, 1000.0, "mV"), "station",
        "width of the interval at which a search ends; its middle is the result");
    key("time_constant_ms", from_to(0.01, 100.0, "ms"), "station",
        "longest time constant of the output; near a threshold it turns on many time constants late");
    key("reverse_v", above_zero(60.0, "V"), "station", "voltage at the reversed control input");
};
