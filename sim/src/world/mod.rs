//! The world behind the terminals: interface board, mechanism and specimens.
//!
//! ```text
//! terminals -> wiring -> signals -> board      (coil supply, gates, contact source, monitors)
//!                                -> mechanism  (cylinders, axis, sensors; places and parts)
//!                 board <-> probes <-> specimen of the part in the nest (a folder per kind: relay, resistor, ssr)
//! instruments -> electrical -> ssr_board, the board of a rig with instruments (fixture chooses the board)
//! terminals -> thermostat, a world of its own: chamber (oven) and rack in place of board and mechanism
//! ```
//!
//! Time runs from event to event: strokes and falls in the mechanism, contacts and timers on the board. Every subject
//! has its own random stream, so that the same seed and stimuli give the same world. The world reacts to its terminals
//! alone and knows nothing of the controller's intentions.

pub mod axis;
pub mod board;
#[cfg_attr(not(feature = "bodies"), path = "no_bodies.rs")]
pub mod bodies;
pub mod cylinder;
pub mod defect;
pub mod draw;
pub mod edges;
mod electrical;
pub mod environment;
pub mod fault;
pub mod fixture;
pub mod gates;
pub mod magazine;
pub mod mechanism;
pub mod oven;
pub mod places;
pub mod posture;
pub mod probes;
mod record;
pub mod relay;
pub mod resistor;
pub mod signal;
pub mod specimen;
pub mod ssr;
pub mod ssr_board;
pub mod table;
pub mod thermostat;
pub mod wiring;

use std::path::PathBuf;

use crate::config::{ConfigError, Files, RigFile, SupplyRange, read_rig};
use crate::rig::WorldModel;
use crate::scpi::circuit::Circuit;
use crate::terminal::Plant;
use axis::Axis;
use bodies::Bodies;
use draw::{Draw, Subject};
use edges::Edges;
use environment::Environment;
use fault::{Fault, WorldFaults};
use fixture::{Fixture, Probes};
use magazine::{Magazine, Part};
use mechanism::Mechanism;
use signal::{Commands, In, Out};
use specimen::Specimen;
use table::{MechanismTable, present, read_world};
use thermostat::OvenWorld;
use wiring::{Wire, Wiring};

/// Configuration of a world.
#[derive(Debug, Clone, Default)]
pub struct WorldOptions {
    /// Files `rig.toml`, `scene.toml`, `sim.toml`, `golden.toml` and `recipes/`.
    pub files: Files,
    /// World file that overrides keys of `sim.toml`.
    pub world_file: Option<PathBuf>,
    /// Seed of the rig's errors and of the lot.
    pub seed: u64,
    /// Recipe of the parts in the magazine.
    pub recipe: String,
    /// Number of lot parts in the magazine; `None` never runs out.
    pub parts: Option<u64>,
    /// True when reference parts precede the lot.
    pub reference_parts: bool,
    /// Faults of the world by name and value; NaN selects the default of the table.
    pub faults: Vec<(String, f64)>,
}

/// Builds the world of a rig: a chamber where the world file has `[chamber]`, else a line with a nest. Also returns the
/// seed of noise and temperatures where it differs from the seed of the rig.
///
/// # Errors
/// Fails when a configuration file is missing or wrong, or a fault is unknown.
pub fn build(options: &WorldOptions) -> Result<(Box<dyn WorldModel>, Option<u64>), ConfigError> {
    let table = read_world(&options.files, options.world_file.as_deref())?;
    if table.chamber.is_some() {
        return Ok((Box::new(OvenWorld::build(options)?), None));
    }
    let world = World::build(options)?;
    let noise_seed = world.noise_seed();
    Ok((Box::new(world), noise_seed))
}

/// The simulated world.
#[derive(Debug, Clone)]
pub struct World {
    wiring: Wiring,
    fixture: Fixture,
    mechanism: Mechanism,
    environment: Environment,
    commands: Commands,
    /// True while the interlock keeps the jaws from opening.
    holds_jaws: bool,
    edges: Vec<(Wire<In>, Edges)>,
    drift: Option<f64>,
    film: Option<f64>,
    stuck_range: Option<SupplyRange>,
    noise_seed: Option<u64>,
    clock_hz: f64,
    now_us: u64,
}

impl World {
    /// Builds the world.
    ///
    /// # Errors
    /// Fails when a configuration file is missing or wrong, or a fault is unknown.
    pub fn build(options: &WorldOptions) -> Result<Self, ConfigError> {
        let rig = read_rig(&options.files)?;
        let table = read_world(&options.files, options.world_file.as_deref())?;
        let path = options.files.path("sim.toml");
        let faults = WorldFaults::resolve(&options.faults, &table.fault, &path)?;
        let mut draw = Draw::new(options.seed, Subject::Rig, 0);
        let environment = present(&table.environment, "environment", &options.files)?;
        let environment = Environment::new(&environment, &mut draw);
        let (track, ambient) = (environment.track_c, environment.ambient_c);
        let magazine = Magazine::load(options, &table, &faults, track, ambient)?;
        let drift = faults.values(Fault::Drift).next();
        let film = faults.values(Fault::ProbeFilm).next();
        let stuck_range = faults.stuck_range(&rig.supply_ranges, &path)?;
        let noise_seed = faults.noise_seed();
        let wiring = Wiring::new(&rig);
        let recipe = (&options.files, options.recipe.as_str());
        let fixture = Fixture::new(recipe, &rig, &table, &wiring, &mut draw)?;
        let clock_hz =
            rig.reference.counter_clock_hz * (1.0 + draw.half(table.devices.clock_ppm * 1e-6));
        let strokes = Draw::new(options.seed, Subject::Mechanism, 0);
        let strokes_table = present(&table.mechanism, "mechanism", &options.files)?;
        let axis = sort_axis(&rig, &strokes_table);
        let bodies = Bodies::read(&options.files, &options.recipe)?;
        let mechanism = Mechanism::new(
            &strokes_table,
            axis,
            (rig.bins, bodies),
            (
                magazine.with_codes(rig.code_reader.is_some()),
                rig.code_reader,
            ),
            faults,
            strokes,
        );
        let commands = Commands::default();
        let edges = Vec::new();
        let mut world = Self {
            wiring,
            fixture,
            mechanism,
            environment,
            commands,
            holds_jaws: false,
            edges,
            drift,
            film,
            stuck_range,
            noise_seed,
            clock_hz,
            now_us: 0,
        };
        if !options.reference_parts {
            world.stick_range();
        }
        world.begin_edges();
        Ok(world)
    }

    /// Returns the seed of noise and temperatures, where it differs from the seed of the rig.
    pub fn noise_seed(&self) -> Option<u64> {
        self.noise_seed
    }

    /// Returns the specimen in the nest.
    fn specimen(&self) -> Option<&Specimen> {
        self.mechanism
            .places
            .nest
            .as_deref()
            .map(|part| &part.specimen)
    }

    /// Returns a digital signal at this instant.
    fn signal(&self, signal: In) -> bool {
        let own = self.mechanism.signal(signal, self.now_us);
        own.or_else(|| self.fixture.signal(signal, self.specimen()))
            .unwrap_or(false)
    }

    fn begin_edges(&mut self) {
        let wires: Vec<Wire<In>> = self
            .wiring
            .inputs
            .values()
            .flatten()
            .map(|(_, wire)| *wire)
            .collect();
        for wire in wires {
            let mut edges = Edges::default();
            edges.begin(self.signal(wire.signal) != wire.active_low, self.now_us);
            self.edges.push((wire, edges));
        }
    }

    /// Makes the range relays of the supply stick if that fault is active and has not struck yet.
    fn stick_range(&mut self) {
        if let Some(range) = self.stuck_range.take() {
            self.fixture.stick(range);
        }
    }

    /// Returns the instant of the next event that the world causes by itself, microseconds; `None` without one.
    fn next_us(&self) -> Option<u64> {
        let mechanism_us = Some(self.mechanism.next_us()).filter(|next_us| *next_us < u64::MAX);
        let fixture_us = self.fixture.next_us();
        [mechanism_us, fixture_us].into_iter().flatten().min()
    }

    /// Passes the commands to the mechanism, without the valve of the jaws while the interlock holds them.
    fn move_mechanism(&mut self) {
        self.holds_jaws = !self.fixture.frees_jaws();
        let open = self.commands.is_on(Out::ClampOpen) && !self.holds_jaws;
        let commands = self.commands.with(Out::ClampOpen, open);
        self.mechanism.command(commands, self.now_us);
    }

    /// Follows the interlock of the jaws.
    fn watch_jaws(&mut self) {
        if self.holds_jaws == self.fixture.frees_jaws() {
            self.move_mechanism();
            self.mechanism_changed();
        }
    }

    /// Updates board, sensors and edges after a change in the mechanism.
    fn mechanism_changed(&mut self) {
        let now = self.now_us;
        let probes = Probes {
            up: self.mechanism.probes_up(now),
            touch: self.mechanism.probes_touch(now),
            stay: self.mechanism.probes_stay(now),
            door_closed: self.signal(In::DoorClosed),
        };
        let mechanism = &self.mechanism;
        self.fixture.trouble(|fault| mechanism.is_disturbed(fault));
        self.fixture.probe(probes, in_nest(&mut self.mechanism));
        for (wire, edges) in &mut self.edges {
            if let Some(present) = self.mechanism.signal(wire.signal, now) {
                edges.level(present != wire.active_low, now);
            }
        }
        if self.mechanism.places.entered() > 0 {
            if let Some(drift) = self.drift.take() {
                self.fixture.drift(drift);
            }
            if let Some(film) = self.film.take() {
                self.fixture.add_film_per_touch(film / 100.0);
            }
            self.stick_range();
        }
    }
}

impl Plant for World {
    fn advance(&mut self, t_us: u64) {
        while let Some(next_us) = self.next_us().filter(|next_us| *next_us <= t_us) {
            self.now_us = next_us.max(self.now_us);
            self.fixture
                .advance(self.now_us as f64, in_nest(&mut self.mechanism));
            self.watch_jaws();
            if self.mechanism.next_us() <= self.now_us {
                self.mechanism.process(self.now_us);
                self.mechanism_changed();
            }
        }
        if t_us > self.now_us {
            self.now_us = t_us;
            self.fixture
                .advance(t_us as f64, in_nest(&mut self.mechanism));
        }
    }

    fn analog_in(&mut self, module: &str, channel: u8) -> f64 {
        if let Some(wire) = wiring::at(&self.wiring.sensors, module, channel) {
            return self.environment.sensor_c(wire.signal);
        }
        match wiring::at(&self.wiring.quantities, module, channel) {
            Some(wire) => self
                .fixture
                .analog_v(wire.signal, wire.gain, self.specimen()),
            None => f64::NAN,
        }
    }

    fn analog_out(&mut self, module: &str, channel: u8, volts: f64) {
        if let Some(wire) = wiring::at(&self.wiring.sources, module, channel) {
            self.fixture
                .supply(wire.signal, volts, in_nest(&mut self.mechanism));
        }
    }

    fn digital_in(&mut self, module: &str) -> u16 {
        wiring::on(&self.wiring.inputs, module)
            .iter()
            .fold(0xFFFF, |bits, (channel, wire)| {
                let high = self.signal(wire.signal) != wire.active_low;
                if high { bits } else { bits & !(1 << channel) }
            })
    }

    fn digital_out(&mut self, module: &str, bits: u16) {
        let mut commands = self.commands;
        for (channel, wire) in wiring::on(&self.wiring.outputs, module) {
            let on = (bits >> channel & 1 == 1) != wire.active_low;
            commands = commands.with(wire.signal, on);
        }
        if commands == self.commands {
            return;
        }
        self.commands = commands;
        self.move_mechanism();
        self.mechanism_changed();
        self.fixture.command(commands, in_nest(&mut self.mechanism));
    }

    fn edges(&mut self, module: &str, channel: u8) -> u64 {
        let Some(wire) = wiring::at(&self.wiring.inputs, module, channel) else {
            return 0;
        };
        let now = self.now_us;
        let own = self.edges.iter_mut().find(|(w, _)| w.signal == wire.signal);
        own.map_or(0, |(_, edges)| edges.count(now))
    }

    fn gate_open_us(&mut self, module: &str, channel: u8) -> f64 {
        let wire = wiring::at(&self.wiring.gates, module, channel);
        wire.map_or(0.0, |w| self.fixture.gate_open_us(w.signal as usize))
    }

    fn circuit(&mut self) -> Option<&mut dyn Circuit> {
        Some(self)
    }

    fn reference_clock_hz(&self) -> f64 {
        self.clock_hz
    }
}

fn in_nest(mechanism: &mut Mechanism) -> Option<&mut Specimen> {
    mechanism
        .places
        .nest
        .as_deref_mut()
        .map(|part: &mut Part| &mut part.specimen)
}

/// Builds the slide with the stops and bins of the rig file, braked at its park position.
fn sort_axis(rig: &RigFile, mechanism: &MechanismTable) -> Axis {
    let mut points = [None; 8];
    let stops = rig
        .axis
        .values()
        .copied()
        .chain(rig.bins.iter().map(|b| (b.point, b.x_mm)));
    for (point, x_mm) in stops {
        if let Some(place) = points.get_mut(usize::from(point)) {
            *place = Some(x_mm);
        }
    }
    let park = rig.axis.get("park").map_or(0.0, |&(_, x)| x);
    Axis::new(
        mechanism.axis_mm_per_s,
        mechanism.axis_mm_per_s2,
        points,
        park,
    )
}

#[cfg(test)]
mod tests;
