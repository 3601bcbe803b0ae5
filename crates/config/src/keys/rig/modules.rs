//! Keys of serial lines, modules and instruments, and of the settings that every line shares.

use machine::form::{Form, Key, above_zero, from_to, key, optional, whole};
use machine::rig::model::Model;

pub(super) const LINE: &[Key] = keys! {
    key("port", Form::Text, "bus", "path of the serial port, 8N1");
    key("baud", Form::Listed(&[1200, 2400, 4800, 9600, 19200, 38400, 57600, 115_200]), "bus", "bits per second");
    key("checksum", Form::Flag, "bus", "whether the modules check and send check sums");
};

pub(super) const BUS: &[Key] = keys! {
    key("digital_allowance_ms", from_to(1.0, 1000.0, "ms"), "bus",
        "reply time of a digital, counter or analog output module beyond the wire");
    key("analog_allowance_ms", from_to(1.0, 1000.0, "ms"), "bus", "reply time of an analog input module beyond the wire");
    key("tries", whole(1, 10, ""), "bus",
        "attempts at a command that may be repeated; one on the line of the emergency stop");
    key("heartbeat_ms", from_to(10.0, 10_000.0, "ms"), "cycle", "period of the host-OK broadcast on every line");
    key("host_watchdog_ms", from_to(100.0, 25_500.0, "ms"), "rig",
        "silence after which outputs go to their safe values; whole tenths of a second");
    key("scan_period_ms", from_to(0.0, 1000.0, "ms"), "cycle",
        "pause of the motion scan while no motion may arrive; 0 polls without rest");
};

pub(super) const HISTORY: &[Key] = keys! {
    optional("give_up_s", from_to(0.0, 86_400.0, "s"), "app",
        "time after which a program ends with status 3 because it cannot write the history; default 600");
    optional("traces", whole(0, 10_000, ""), "app",
        "number of alarms whose traces of the lines stay beside the history; default 200");
    optional("trace_days", whole(0, 3650, "days"), "app", "time after which the traces of an alarm are deleted; default 90");
};

pub(super) const RECIPES: &[Key] = keys! {
    optional("approval", Form::Choice(&["none", "second_person"]), "app, page",
        "whether a recipe needs two engineers before a lot may use it, one who saved it and one who approved it; default none");
};

pub(super) const SERIAL_READER: &[Key] = keys! {
    key("port", Form::Text, "bus", "path of the serial port, 8N1");
    key("baud", Form::Listed(&[1200, 2400, 4800, 9600, 19200, 38400, 57600, 115_200]), "bus", "bits per second");
    optional("timeout_ms", from_to(50.0, 60_000.0, "ms"), "station",
        "longest time from the arrival of a part in the pocket to its code; default 1000");
    optional("no_code", Form::Text, "bus", "what the reader sends when it finds no code, for example NOREAD");
};

pub(super) const SAFETY: &[Key] = keys! {
    key("estop_reaction_ms", above_zero(2000.0, "ms"), "rig",
        "longest reaction to the emergency-stop contact that the plant accepts");
};

pub(super) const MODULE: &[Key] = keys! {
    key("line", Form::Text, "rig", "name of its line");
    key("address", Form::Hex(2), "rig", "address on that line, as on the module");
    key("model", Form::Choice(Model::NAMES), "rig", "model; decides what may be wired to it");
    key("type", Form::Hex(2), "rig", "type code TT of the configuration word");
    optional("format", Form::Choice(&["hex", "engineering", "percent"]), "rig",
        "data format; analog modules only, and there needed");
    optional("fast", Form::Flag, "rig", "fast mode of an I-7017F or I-7017R; default false");
    optional("mask", Form::Hex(2), "rig", "enabled channels of a 7017, bit n = channel n; there needed");
    optional("slew", Form::Hex(1), "rig", "slew code of a 7021; there needed");
    optional("watchdog", Form::Flag, "rig", "whether the host watchdog must be on; needed with outputs");
    optional("safe", from_to(0.0, 10.0, "V"), "rig", "safe value of a 7021 at its terminal; there needed");
    optional("safe_outputs", Form::Hex(4), "rig", "safe value of digital outputs, bit n = channel n; needed with them");
};

pub(super) const INSTRUMENT: &[Key] = keys! {
    key("profile", Form::Text, "rig", "name of its profile, a file of instruments/");
    key("link", Form::Text, "bus",
        "tcp:HOST:PORT, serial:PATH:BAUD, gpib-tcp:HOST:PORT:ADDRESS or gpib-serial:PATH:BAUD:ADDRESS");
};
