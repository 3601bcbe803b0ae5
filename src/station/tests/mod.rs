//! Facts about the sequence, on the default rig with sensors set by hand.
#![allow(clippy::unwrap_used)]

mod annunciator;
mod clamp;
mod feed;
mod gates;
mod graph;
mod inside;
mod ledger;
mod machine;
mod mechanism;
mod orders;
mod packml;
mod panel;
mod recovery;
mod run;
mod safety;
mod shop;
mod sort;
mod trouble;

pub(crate) use crate::dut::em_relay::tests::{context, device, device_of, golden_parts};
pub(crate) use shop::Shop;

use crate::rig::settings::RigSettings;
use crate::rig::wiring::Wiring;
use std::sync::Arc;

const RIG: &str = include_str!("../../../config/rig.toml");

pub(crate) fn wiring() -> Arc<Wiring> {
    let settings: RigSettings = toml::from_str(RIG).unwrap();
    Arc::new(Wiring::resolve(&settings, crate::dut::FIXTURES).unwrap())
}
