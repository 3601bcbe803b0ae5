//! The simulated rig for solid-state relays, driven by hand: the bytes and lines that a client would send.

mod alternating;
mod defects;
mod figures;
mod hand;
mod interlocks;
mod links;
