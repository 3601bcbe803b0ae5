//! Keys of `instruments/NAME.toml`.

use machine::form::{Form, Key, above_zero, from_to, key, optional, whole};

const STEP: &[Key] = keys! {
    optional("send", Form::Text, "scpi", "command without reply");
    optional("ask", Form::Text, "scpi", "one query, which may be repeated");
    optional("reply", Form::Choice(&["line", "number", "numbers", "text", "block"]), "scpi",
        "form of the reply, which is a value of the program");
    optional("most_bytes", whole(1, 16_777_216, ""), "scpi", "length that a block may have");
    optional("timeout_ms", whole(1, 60_000, "ms"), "scpi", "time until the reply; without it that of the profile");
    optional("expect", Form::Text, "scpi", "in place of `reply`: the reply that proves a setting, as text or as number");
};

const STEPS: Form = Form::List(&Form::Table(STEP));

const BOUNDS: &[Key] = keys! {
    key("low", from_to(-1e9, 1e9, ""), "scpi", "least value");
    key("high", from_to(-1e9, 1e9, ""), "scpi", "greatest value");
};

const PROGRAM: &[Key] = keys! {
    key("steps", STEPS, "scpi", "commands and queries, with the names of arguments in braces");
    optional("argument", Form::Named(&Form::Table(BOUNDS)), "scpi", "numbers that a caller fills in");
};

const ACCURACY: &[Key] = keys! {
    key("quantity", Form::Choice(&["voltage_v", "source_voltage_v", "current_a", "source_current_a", "frequency_hz", "time_s"]), "gauge",
        "quantity with its unit");
    key("full_scale", above_zero(1e9, ""), "gauge", "end of the range, in the unit of the quantity");
    key("reading_pct", from_to(0.0, 100.0, "%"), "gauge", "error as a share of the reading");
    key("offset", from_to(0.0, 1e9, ""), "gauge", "error beside it, in the unit of the quantity");
    optional("noise", from_to(0.0, 1e9, ""), "gauge",
        "standard deviation of a reading averaged over one period of the mains, in the unit of the quantity; default 0");
};

/// All keys of a profile.
pub const FILE: &[Key] = keys! {
    key("name", Form::Text, "scpi", "name of the profile, as the file is called");
    key("class", Form::Choice(&["smu", "dmm", "ac_source", "digitizer", "pulse_source"]), "nothing yet", "kind of instrument");
    key("dialect", Form::Choice(&["scpi", "rigol", "keysight"]), "scpi", "how waveforms are coded; `scpi` without waveforms");
    key("makers", Form::List(&Form::Text), "scpi", "beginnings of the first field of `*IDN?`, one of which must fit");
    key("models", Form::List(&Form::Text), "scpi", "beginnings of its second field, one of which must fit");
    key("timeout_ms", whole(1, 60_000, "ms"), "scpi", "time until the reply to a query");
    key("latency_ms", above_zero(60_000.0, "ms"), "scpi", "usual time until the reply to `*IDN?`");
    key("error_depth", whole(1, 255, ""), "scpi", "entries that the error queue holds");
    optional("echo", Form::Choice(&["ese", "identity"]), "scpi",
        "proof that replies are in step: a number in `*ESE`, or `*IDN?` for an instrument without it; `ese` without it");
    optional("terminator", Form::Choice(&["lf", "crlf"]), "scpi", "end of a command; `lf` without it; a reply ends with a line feed");
    optional("flow", Form::Choice(&["none", "xon", "rts"]), "scpi", "flow control of a serial port; `none` without it");
    optional("remote", Form::Text, "scpi", "command that ends local mode, sent first");
    key("set_up", STEPS, "scpi", "sent at the start and after every doubt");
    key("safe", STEPS, "scpi", "makes the instrument safe");
    key("program", Form::Named(&Form::Table(PROGRAM)), "scpi", "programs by name");
    optional("accuracy", Form::List(&Form::Table(ACCURACY)), "gauge", "errors that the maker states");
};
