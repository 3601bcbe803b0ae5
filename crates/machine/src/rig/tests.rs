//! Tests of points, samples, outputs and commissioning, on the default rig.
#![allow(clippy::unwrap_used)]

mod commission;
mod drive;
mod image;
mod reaction;
mod supply;

use super::settings::RigSettings;
use super::wiring::{LineId, ModuleId, Wiring};
use dcon::Command;
use std::sync::Arc;

fn wiring() -> Arc<Wiring> {
    let settings: RigSettings =
        toml::from_str(include_str!("../../../../config/rig.toml")).unwrap();
    Arc::new(Wiring::resolve(&settings, crate::dut::FIXTURES).unwrap())
}

fn module(wiring: &Wiring, name: &str) -> ModuleId {
    let mut ids = wiring.module_ids();
    ids.find(|id| wiring.module(*id).name == name).unwrap()
}

fn motion(wiring: &Wiring) -> LineId {
    wiring.line_named("motion").unwrap()
}

/// Returns the request as sent on a line without checksum, CR left off.
fn text(command: &Command) -> String {
    let mut bytes = Vec::new();
    command.encode(false, &mut bytes);
    String::from_utf8(bytes).unwrap().trim_end().to_owned()
}
