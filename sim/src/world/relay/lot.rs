//! A lot of relays with its reference parts.

use super::Relay;
use super::certificate::{Certificate, read_certificates};
use super::values::{RelayValues, Scale};
use crate::config::ConfigError;
use crate::table::Table;
use crate::world::WorldOptions;
use crate::world::specimen::Arrival;
use crate::world::table::RelayWorld;

/// Relays of one recipe.
#[derive(Debug, Clone)]
pub struct Lot {
    world: RelayWorld,
    scale: Scale,
    certificates: Vec<Certificate>,
}

impl Lot {
    /// Reads the relays of a recipe; with `options.reference_parts` also the reference parts of their nominal voltage.
    ///
    /// # Errors
    /// Fails when the recipe lacks the nominal values, or the certificates cannot be read.
    pub fn read(
        recipe: &Table,
        options: &WorldOptions,
        world: &RelayWorld,
    ) -> Result<Self, ConfigError> {
        let scale: Scale = recipe.get("part")?;
        let certificates = match options.reference_parts {
            true => read_certificates(&options.files, scale.nominal_v)?,
            false => Vec::new(),
        };
        Ok(Self {
            world: world.clone(),
            scale,
            certificates,
        })
    }

    /// Returns the number of reference parts.
    pub fn reference_parts(&self) -> u64 {
        self.certificates.len() as u64
    }

    /// Returns the lot part at an index under a seed.
    pub fn part(&self, seed: u64, index: u64, arrival: Arrival) -> Relay {
        self.arrive(
            RelayValues::of_lot(&self.world, self.scale, seed, index),
            arrival,
        )
    }

    /// Returns the reference part at an index, `None` past the last; `other_day` gives the same body another
    /// temperature.
    pub fn reference_part(
        &self,
        seed: u64,
        index: u64,
        other_day: bool,
        mut arrival: Arrival,
    ) -> Option<Relay> {
        let paper = self.certificates.get(index as usize)?;
        let mut drawn = RelayValues::of_certificate(&self.world, self.scale, seed, index, paper);
        if other_day {
            let sd_k = self.world.environment.part_minus_track_sd_k;
            drawn.offset_k = arrival.draw.normal(0.0, sd_k);
        }
        Some(self.arrive(drawn, arrival))
    }

    fn arrive(&self, mut drawn: RelayValues, arrival: Arrival) -> Relay {
        if let Some(pin) = arrival.dirty_pin {
            drawn.pins.lose(pin);
        }
        if arrival.misoriented {
            drawn.misorient();
        }
        let (track, ambient) = (arrival.track_c, arrival.ambient_c);
        Relay::new(
            drawn,
            &self.world,
            arrival.draw,
            arrival.t_us,
            track,
            ambient,
        )
    }
}
