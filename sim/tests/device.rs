//! Tests of modules, lines, instruments and rigs from the host's side.
#![allow(clippy::unwrap_used)]

mod facts {
    mod bench;
    mod conformance;
    mod converter;
    mod fuzz;
    mod line;
    mod rig;
    mod ssr;
    mod terminal;
    mod thermostat;
}
