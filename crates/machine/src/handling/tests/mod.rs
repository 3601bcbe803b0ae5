//! Tests of feed, nest and sorter on the default rig with given sensor states.
#![allow(clippy::unwrap_used)]

mod feed;
mod graph;
mod inside;

mod ledger;
mod mechanism;
mod mock_rig;
mod nest;
mod recovery;
mod serial;
mod sort;

pub(crate) use crate::dut::em_relay::tests::{context, device, device_of, reference_parts};
pub(crate) use mock_rig::{MockRig, mechanism as mechanism_of};

use crate::rig::settings::RigSettings;
use crate::rig::wiring::Wiring;
use std::sync::Arc;

const RIG: &str = include_str!("../../../../../config/rig.toml");

/// The default rig.
pub(crate) fn wiring() -> Arc<Wiring> {
    let settings: RigSettings = toml::from_str(RIG).unwrap();
    Arc::new(Wiring::resolve(&settings, crate::dut::FIXTURES).unwrap())
}
