//! Tests of modules and lines from the host's side.

mod facts {
    mod bench;
    mod conformance;
    mod converter;
    mod fuzz;
    mod line;
    mod rig;
    mod terminal;
}
