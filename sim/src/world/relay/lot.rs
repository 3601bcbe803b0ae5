//! A lot of relays with its reference parts.

use super::Relay;
use super::drawn::{Drawn, Scale};
use super::golden::{Certificate, read_golden, read_scale};
use crate::config::ConfigError;
use crate::world::WorldOptions;
use crate::world::specimen::Arrival;
use crate::world::table::WorldTable;

/// Relays of one recipe.
#[derive(Debug, Clone)]
pub struct Lot {
    world: WorldTable,
    scale: Scale,
    golden: Vec<Certificate>,
}

impl Lot {
    /// Reads the relays of a recipe; with `options.golden` also the reference parts of their nominal voltage.
    ///
    /// # Errors
    /// Fails when the recipe or the certificates cannot be read.
    pub fn read(options: &WorldOptions, world: &WorldTable) -> Result<Self, ConfigError> {
        let dir = &options.config_dir;
        let scale = read_scale(dir, &options.recipe)?;
        let golden = match options.golden {
            true => read_golden(dir, scale.nominal_v)?,
            false => Vec::new(),
        };
        Ok(Self {
            world: world.clone(),
            scale,
            golden,
        })
    }

    /// Returns the number of reference parts.
    pub fn golden(&self) -> u64 {
        self.golden.len() as u64
    }

    /// Returns the lot part at an index under a seed.
    pub fn part(&self, seed: u64, index: u64, arrival: Arrival) -> Relay {
        self.arrive(Drawn::of_lot(&self.world, self.scale, seed, index), arrival)
    }

    /// Returns the reference part at an index, `None` past the last; `other_day` gives the same body another
    /// temperature.
    pub fn golden_part(
        &self,
        seed: u64,
        index: u64,
        other_day: bool,
        mut arrival: Arrival,
    ) -> Option<Relay> {
        let paper = self.golden.get(index as usize)?;
        let mut drawn = Drawn::of_certificate(&self.world, self.scale, seed, index, paper);
        if other_day {
            let sd_k = self.world.environment.part_minus_track_sd_k;
            drawn.offset_k = arrival.draw.normal(0.0, sd_k);
        }
        Some(self.arrive(drawn, arrival))
    }

    fn arrive(&self, mut drawn: Drawn, arrival: Arrival) -> Relay {
        if let Some(pin) = arrival.dirty_pin {
            drawn.pins.lose(pin);
        }
        if arrival.turned {
            drawn.turn();
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
