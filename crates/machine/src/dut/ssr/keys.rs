//! Keys of the recipe of a solid-state relay.

use crate::dut::External;
use crate::dut::keys::{BODY, PIN_LENGTH, Sections, at_least, at_most, limit, signed_limit, table};
use crate::form::{Form, Key, above_zero, from_to, key, optional};

/// Keys of the sections `[part]`, `[limits]`, `[external]` and `[test]`.
pub const SECTIONS: Sections = Sections {
    part: PART,
    limits: LIMITS,
    external: EXTERNAL,
    test: TEST,
};

const PART: &[Key] = table! {
    BODY;
    PIN_LENGTH;
    key("output", Form::Choice(&["dc", "ac_zero_cross", "ac_random"]), "station",
        "what the output switches: a DC load with MOSFETs; an AC load at the zero of the mains, or at any instant");
    key("control_v", above_zero(19.0, "V"), "station", "nominal control voltage");
    key("rated_v", above_zero(480.0, "V"), "station", "voltage of the blocked output; of AC parts rms");
    key("rated_a", above_zero(100.0, "A"), "gauge", "current of the conducting output; of AC parts rms");
    optional("body_diode", Form::Flag, "station", "whether the output conducts when reversed; default false");
    optional("mains_v", above_zero(300.0, "V"), "station", "AC parts: voltage of the mains in the test, rms; default 230");
    optional("mains_hz", from_to(45.0, 500.0, "Hz"), "station", "AC parts: frequency of the mains in the test; default 50");
    optional("least_a", above_zero(1.0, "A"), "station", "AC parts: least load current at which the output works, rms; default 0.04");
};

const LIMITS: &[Key] = table! {
    optional("v_on_v", limit!("V", 32.0), "gauge", "control voltage at and above which the output conducts");
    optional("v_off_v", limit!("V", 32.0), "gauge", "control voltage at and below which the output blocks");
    optional("i_in_ma", limit!("mA", 1000.0), "gauge", "current of the control input at control_v");
    optional("i_rev_ua", limit!("uA", 10_000.0), "gauge", "current of the reversed control input at reverse_v");
    optional("t_on_us", signed_limit!("us", 100_000.0), "gauge",
        "control edge to 90 % of the load voltage; of ac_zero_cross first zero of the mains after the edge to turn-on");
    optional("t_off_us", signed_limit!("us", 100_000.0), "gauge",
        "control edge to 10 % of the load voltage; of AC parts first zero of the current after the edge to turn-off");
    optional("v_drop_v", limit!("V", 100.0), "gauge", "drop of the conducting output at rated_a; of AC parts peak");
    optional("v_drop_rms_v", limit!("V", 100.0), "gauge", "AC parts: the same rms");
    optional("r_on_mohm", limit!("mOhm", 100_000.0), "gauge", "DC parts: resistance of the conducting output");
    optional("i_leak_ua", limit!("uA", 10_000.0), "gauge", "current of the blocked output at rated_v, of AC parts at mains_v, before it has conducted");
    optional("i_leak_hot_ua", limit!("uA", 10_000.0), "gauge", "the same after it has conducted");
    optional("i_leak_resistive_ua", limit!("uA", 10_000.0), "gauge", "AC parts: part of i_leak_ua in phase with the voltage");
    optional("i_leak_capacitive_ua", limit!("uA", 10_000.0), "gauge", "AC parts: part of i_leak_ua a quarter of a period ahead");
    optional("v_zc_v", limit!("V", 500.0), "gauge", "ac_zero_cross: voltage at the output when it turns on");
    optional("v_retrig_v", limit!("V", 500.0), "gauge", "AC parts: greatest voltage at the beginning of later half cycles");
    optional("dc_offset_mv", signed_limit!("mV", 10_000.0), "gauge", "AC parts: mean of the voltage at the conducting output");
    optional("wave_dist_mv", limit!("mV", 10_000.0), "gauge", "AC parts: what the conducting output adds to the sine, rms");
    optional("halfwave_pct", limit!("%", 100.0), "gauge", "AC parts: difference of the charges of both half cycles over their sum");
    optional("drift_mv", signed_limit!("mV", 1000.0), "gauge",
        "rise of the drop from 10 ms to 200 ms at 1 A, or at rated_a below 1 A; of AC parts at rated_a");
};

const EXTERNAL: &[Key] = table! {
    optional("dv_dt_v_us", at_least!(External::StaticDvDt), "history",
        "static dv/dt: greatest slope of the rated voltage at which the blocked output stays blocked");
    optional("r_iso_ohm", at_least!(External::IsolationResistance), "history", "isolation resistance from input to output");
    optional("dwv_ua", at_most!(External::WithstandLeakage), "history",
        "leakage current from input to output at the voltage of the dielectric withstand test");
};

const TEST: &[Key] = table! {
    key("method", Form::Choice(&["conformity", "ramp", "bisect"]), "station",
        "whether a ramp (DC parts) or a search finds v_on_v and v_off_v after the conformity test, which alone decides");
    key("resolution_mv", from_to(1.0, 1000.0, "mV"), "station",
        "width of the interval at which a search ends, whose middle is the result; a ramp changes by as much in two time constants");
    optional("phases", Form::Whole { unit: "", low: 2, high: 24 }, "station",
        "AC parts: pulses of the train, at as many phases of the mains; default 6");
    optional("sampling", Form::Whole { unit: "", low: 1, high: 10_000 }, "station",
        "AC parts: number of parts of a lot of which dc_offset_mv and wave_dist_mv are measured; without it, of all");
    optional("searched", Form::Whole { unit: "", low: 1, high: 10_000 }, "station",
        "number of parts of a lot of which a search finds v_on_v and v_off_v; without it, of all");
    key("time_constant_ms", from_to(0.01, 100.0, "ms"), "station",
        "longest time constant of the output; near a threshold it turns on many time constants late");
    key("reverse_v", above_zero(60.0, "V"), "station", "voltage at the reversed control input");
};
