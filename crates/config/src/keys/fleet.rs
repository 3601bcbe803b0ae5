//! Keys of `fleet.toml`.

use machine::form::{Form, Key, key, optional, whole};

const TARGET: &[Key] = keys! {
    key("url", Form::Text, "fleet",
        "database: postgres://USER@HOST:PORT/DATABASE, without password; that comes from PGPASSWORD or the file of PGPASSFILE");
    optional("tls", Form::Choice(&["verify", "off"]), "fleet",
        "verify: encrypted, certificate checked against ca (without the key); off: plain text, for a network of your own");
    optional("ca", Form::Text, "fleet", "PEM file with the certificate of the authority that signed that of the server");
    optional("samples", Form::Choice(&["none", "rejects", "all"]), "fleet",
        "raw replies to send: none (without the key), of parts that did not pass, all");
    optional("alarm_after_s", whole(10, 2_592_000, "s"), "fleet",
        "age of the oldest part that the database lacks at which an alarm is raised; 3600 without it");
};

const SHIFT: &[Key] = keys! {
    key("name", Form::Text, "fleet", "name of the shift, for example early");
    key("start", Form::Text, "fleet", "local time at which it begins, HH:MM");
    key("end", Form::Text, "fleet", "local time at which it ends, HH:MM; at or before start: on the next day");
};

/// All keys of `fleet.toml`.
pub const FILE: &[Key] = keys! {
    optional("site", Form::Text, "fleet", "name of the plant; needed with a target");
    optional("rig", Form::Text, "fleet", "name of the rig, unique in its plant; needed with a target");
    optional("target", Form::List(&Form::Table(TARGET)), "fleet", "databases; each gets everything, at its own pace");
    optional("shift", Form::List(&Form::Table(SHIFT)), "fleet", "shifts of the plant, for yield and output by shift; they do not overlap");
};
