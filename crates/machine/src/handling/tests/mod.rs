//! Tests of feed, nest and sorter on the default rig with given sensor states.
#![allow(clippy::unwrap_used)]

mod feed;
mod graph;
mod inside;

mod ledger;
mod mechanism;
mod mock_rack;
mod mock_rig;
mod nest;
mod recovery;
mod serial;
mod sort;

pub(crate) use crate::dut::em_relay::tests::{context, device, device_of, reference_parts};
pub(crate) use mock_rack::RackRig;
pub(crate) use mock_rig::{MockRig, mechanism as mechanism_of};

use crate::rig::image::Image;
use crate::rig::point::DigitalInput;
use crate::rig::settings::RigSettings;
use crate::rig::wiring::{ModuleId, Wiring};
use dcon::{Bits, Reply};
use std::collections::BTreeSet;
use std::sync::Arc;
use units::RigTime;

const RIG: &str = include_str!("../../../../../config/rig.toml");

/// The default rig.
pub(crate) fn wiring() -> Arc<Wiring> {
    let settings: RigSettings = toml::from_str(RIG).unwrap();
    Arc::new(Wiring::resolve(&settings, crate::dut::FIXTURES).unwrap())
}

/// Polls every digital module: `is_on` says which signals are on.
pub(crate) fn scan(
    wiring: &Wiring,
    image: &mut Image,
    now: RigTime,
    is_on: impl Fn(DigitalInput) -> bool,
) {
    let modules: BTreeSet<ModuleId> = wiring
        .digital_inputs()
        .map(|(_, point)| wiring.digital_in(point).module)
        .collect();
    for module in modules {
        let mut word = 0;
        for (_, point) in wiring.digital_inputs() {
            let terminal = wiring.digital_in(point);
            if terminal.module == module && is_on(point) != terminal.active_low {
                word |= terminal.bit();
            }
        }
        let [first, second] = u16::to_be_bytes(word);
        let reply = Reply::Bits(Bits { first, second });
        let line = wiring.module(module).line;
        let command = wiring.poll(module);
        image.accept(line, &command, &reply, "", now).unwrap();
    }
}
