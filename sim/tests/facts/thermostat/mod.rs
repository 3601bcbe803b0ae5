//! Tests of the rig for temperature relays from the host's side.

mod hand;

mod batch;
mod chain;
mod sensors;
