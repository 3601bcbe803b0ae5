//! Tests of the relay model and of the scatter of the lot.

#![allow(clippy::unwrap_used)]

mod coil;
mod contacts;
mod drawn;
mod levels;
mod transients;

use super::values::{ContactFilm, Scale};
use super::*;
use crate::config::read_world;
use crate::world::draw::Subject;
use crate::world::tests::files;

/// Returns the default world without scatter.
fn still_world() -> RelayWorld {
    let mut world = read_world(&files(), None)
        .unwrap()
        .relays(&files())
        .unwrap();
    world.lot.threshold_scatter_sd_mv = 0.0;
    world.lot.bounce_ln_sd = 0.0;
    world
}

/// Removes the heating of the copper, which moves pickup by 1.7 mV on a ramp of half a second.
fn cool(mut world: RelayWorld) -> RelayWorld {
    world.relay.coil_heat_j_per_k = 1e9;
    world
}

/// Creates the relay of the reference figures: pickup 7.8835 V, release 2.3429 V.
fn reference_relay(world: &RelayWorld) -> Relay {
    let scale = Scale {
        nominal_v: 12.0,
        nominal_coil_ohm: 400.0,
    };
    let mut specimen = RelayValues::of_lot(world, scale, 1, 0);
    specimen.defect = None;
    specimen.coil_ohm = 400.0;
    specimen.operate_v = 7.883_477_479_837_58;
    specimen.release_v = 2.342_888_313_119_52;
    specimen.operate_ms = 4.730_797_252;
    specimen.release_ms = 2.864_980_410;
    specimen.offset_k = 0.0;
    specimen.film_no = ContactFilm::Steady {
        median_mohm: 18.0,
        ln_sd: 0.0,
    };
    Relay::new(
        specimen,
        world,
        Draw::new(1, Subject::LotOperations, 0),
        0.0,
        23.0,
        23.0,
    )
}

/// Returns the first instant up to `t_us` at which a contact reaches a state.
fn first(relay: &mut Relay, t_us: f64, contact: Contact, closed: bool) -> Option<f64> {
    while let Some(change) = relay.advance(t_us) {
        if change.contact == contact && change.closed == closed {
            return Some(change.t_us);
        }
    }
    None
}
