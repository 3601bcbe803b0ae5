//! Tests of modules, lines and instruments from the host's side.

mod facts {
    mod bench;
    mod conformance;
    mod converter;
    mod fuzz;
    mod line;
    mod rig;
    mod ssr;
    mod terminal;
}
