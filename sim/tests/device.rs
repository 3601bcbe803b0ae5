//! Facts about modules and lines, seen from the host's side.

mod facts {
    mod conformance;
    mod converter;
    mod fuzz;
    mod line;
    mod rig;
    mod terminal;
}
