//! Tests of the sequence on the default rig with given sensor states.
#![allow(clippy::unwrap_used)]

mod annunciator;
mod gates;
mod machine;
mod orders;
mod packml;
mod panel;
mod prompts;
mod rack;
mod run;
mod safety;
mod trouble;

pub(crate) use crate::handling::tests::{MockRig, context, device, device_of, reference_parts};
