//! Temperature relays in a heated chamber with a rack of sockets, which a person loads and unloads.
//!
//! ```text
//! terminals -> wiring -> commands -> chain (limiter, airflow, door, emergency stop) -> chamber (crate::world::oven)
//!           <- gauges <- air, rack, heater;  sockets <- air;  parts <- sockets;  contacts of the parts -> terminals
//! ```
//!
//! The physics advance in steps of 0.1 s, and only when a client reads or writes a terminal. Contacts change at their
//! own microseconds between two steps; a command takes effect at the next step, as with a contactor.

pub mod chain;
pub mod contact;
pub mod defect;
pub mod fault;
pub mod gauge;
pub mod lot;
pub mod part;
pub mod person;
pub mod rack;
mod record;
mod strike;
pub mod table;
pub mod truth;
pub mod wiring;

use crate::config::{ConfigError, RigFile, read_rig, read_world};
use crate::terminal::Plant;
use crate::truth::ChamberMove;
use crate::world::WorldOptions;
use crate::world::draw::{Draw, Subject};
use crate::world::oven::{Chamber, Drive, SensorValues};
use crate::world::table::present;
use crate::world::wiring::{at, on};
use chain::Chain;
use fault::Pending;
use gauge::Gauge;
use lot::Lot;
use person::{Person, Sight, Task};
use rack::Rack;
use table::{ChamberTable, SensorsTable, ThermostatTable};
use wiring::{Commands, In, Input, Out, Power, Quantity, Thermometer, Wiring};

pub use defect::Defect;
pub use truth::{SocketTruth, ThermostatTruth};

/// Length of a step, microseconds.
const STEP_US: u64 = 100_000;

/// Voltage of an analog output that stands for 100 %.
const FULL_V: f64 = 10.0;

/// The chamber with everything in and around it.
#[derive(Debug, Clone)]
pub struct OvenWorld {
    table: ThermostatTable,
    wiring: Wiring,
    commands: Commands,
    duty: f64,
    vent: f64,
    chamber: Chamber,
    broken: Broken,
    chain: Chain,
    gauges: [Gauge; 4],
    rack: Rack,
    person: Person,
    lot: Lot,
    supply: Supply,
    faults: Pending,
    /// Releases of the lock and closings of the contactor so far.
    moves: Vec<ChamberMove>,
    noise: Draw,
    now_us: u64,
    /// End of the last step: `now_us`, or less than a step later.
    done_us: u64,
}

/// State of heater, fan, vent and mains under the present faults.
#[derive(Debug, Clone, Copy)]
struct Broken {
    /// Share of the heater that works, 0 to 1.
    heater: f64,
    /// Speed of the fan while it is on, 0 to 1.
    fan: f64,
    /// Ratio of the mains voltage to the nominal one.
    mains: f64,
    /// True while the power unit conducts all the time.
    power_stuck: bool,
    /// Opening at which the vent is stuck, 0 to 1; `None` while it moves.
    vent: Option<f64>,
}

impl Broken {
    const NOTHING: Self = Self {
        heater: 1.0,
        fan: 1.0,
        mains: 1.0,
        power_stuck: false,
        vent: None,
    };
}

/// Parts of the lot that are still outside the rack.
#[derive(Debug, Clone, Copy, Default)]
struct Supply {
    /// Index of the next lot part.
    next: u64,
    /// Parts that may still be loaded; `None` for an endless lot.
    left: Option<u64>,
    /// Parts loaded so far.
    loaded: u64,
    batches: u64,
}

impl OvenWorld {
    /// Builds the world from its files.
    ///
    /// # Errors
    /// Fails when a configuration file is missing or wrong, or a fault is unknown.
    pub fn build(options: &WorldOptions) -> Result<Self, ConfigError> {
        let rig = read_rig(&options.files)?;
        let world = read_world(&options.files, options.world_file.as_deref())?;
        let table = present(&world.thermostat, "thermostat", &options.files)?;
        let chamber = present(&world.chamber, "chamber", &options.files)?;
        let lot = Lot::read(&options.files, &options.recipe, &table, options.seed)?;
        let mut built = Self::new(&rig, table, &chamber, lot, options);
        built.add_faults(options, &world)?;
        Ok(built)
    }

    fn new(
        rig: &RigFile,
        table: ThermostatTable,
        chamber: &ChamberTable,
        lot: Lot,
        options: &WorldOptions,
    ) -> Self {
        let mut draw = Draw::new(options.seed, Subject::Chamber, 0);
        let mut values = chamber.values.drawn(&chamber.spread, &mut draw);
        values.ambient_c = draw.between(chamber.ambient_c);
        let ambient_c = values.ambient_c;
        let error_k = rig.certificate.error_k;
        let gauges = gauges(
            &table.sensors,
            (chamber.sensor, error_k),
            ambient_c,
            &mut draw,
        );
        let emf_uv = table.emf_uv_sd;
        Self {
            wiring: Wiring::new(rig),
            commands: Commands::default(),
            duty: 0.0,
            vent: 0.0,
            chamber: Chamber::new(&values, ambient_c),
            broken: Broken::NOTHING,
            chain: Chain::new(table.safety.clone()),
            gauges,
            rack: Rack::new(
                (&rig.sockets, &rig.certificate.offsets_k),
                &table.rack,
                emf_uv,
                ambient_c,
                &mut draw,
            ),
            person: Person::new(table.loading.clone()),
            lot,
            supply: Supply {
                left: options.parts,
                ..Supply::default()
            },
            faults: Pending::default(),
            moves: Vec::new(),
            noise: Draw::new(options.seed, Subject::ChamberNoise, 0),
            now_us: 0,
            done_us: 0,
            table,
        }
    }

    /// Runs all steps that begin before the present instant, then carries out the changes of the contacts.
    fn catch_up(&mut self) {
        while self.done_us < self.now_us {
            self.step();
        }
        self.rack.settle(self.now_us);
    }

    /// Runs one step of 0.1 s.
    fn step(&mut self) {
        while let Some(fault) = self.faults.due(self.done_us) {
            self.strike(fault);
        }
        self.attend();
        let heater_c = self.chamber.temperatures().heater_c;
        self.chain.step(self.done_us, self.fan(), heater_c);
        let drive = self.drive();
        let mut from_us = self.done_us;
        for gauge in &mut self.gauges {
            gauge.begin_step();
        }
        let (gauges, rack) = (&mut self.gauges, &mut self.rack);
        self.chamber
            .step_with(STEP_US as f64 * 1e-6, &drive, |dt_s, now| {
                let around = [now.air_c, now.air_c, now.rack_c, now.heater_c];
                for (gauge, celsius) in gauges.iter_mut().zip(around) {
                    gauge.step(dt_s, celsius);
                }
                rack.step(from_us, dt_s, now.air_c);
                from_us += (dt_s * 1e6).round() as u64;
            });
        self.done_us += STEP_US;
    }

    /// Lets the person look at the rack and act.
    fn attend(&mut self) {
        let sight = Sight {
            unlocked: !self.locked() || self.chain.person_at_door,
            testing: self.commands.is_on(Out::LampTesting),
            unload: self.commands.is_on(Out::LampUnload),
            rack_filled: self.rack.is_filled(),
            parts_wait: self.supply.left != Some(0),
        };
        match self.person.step(self.done_us, &sight) {
            Some(Task::Unload) => {
                self.rack.settle(self.done_us);
                self.rack.unload(self.done_us);
            }
            Some(Task::Load) => self.load(),
            None => {}
        }
        self.chain.person_at_door = self.person.at_door(self.done_us);
    }

    /// Fills the sockets with parts of the lot.
    fn load(&mut self) {
        self.supply.batches += 1;
        let room = self.rack.size() as u64;
        let count = self.supply.left.map_or(room, |left| left.min(room));
        for place in 0..count {
            let part = self.lot.part(self.supply.next + place, self.ambient_c());
            let seq = self.supply.loaded + place + 1;
            let name = (seq, self.supply.batches);
            self.rack.load(place as usize, name, part, self.done_us);
        }
        self.supply.next += count;
        self.supply.loaded += count;
        self.supply.left = self.supply.left.map(|left| left - count);
    }

    fn ambient_c(&self) -> f64 {
        self.chamber.values().ambient_c
    }

    fn fan(&self) -> f64 {
        let runs = self.commands.is_on(Out::Fan) && self.chain.mains;
        if runs { self.broken.fan } else { 0.0 }
    }

    fn drive(&self) -> Drive {
        let contactor = self.commands.is_on(Out::MainContactor) && self.chain.conducts();
        let power = self.broken.mains.powi(2) * self.broken.heater;
        Drive {
            duty: if self.broken.power_stuck {
                1.0
            } else {
                self.duty
            },
            power: if contactor { power } else { 0.0 },
            vent: self.broken.vent.unwrap_or(self.vent),
            fan: self.fan(),
            door_open: !self.chain.door_closed(),
        }
    }

    /// Checks whether the door is closed and its lock engaged.
    fn locked(&self) -> bool {
        self.chain.door_closed() && !self.commands.is_on(Out::DoorLockRelease)
    }

    fn input(&self, input: Input) -> bool {
        match input {
            Input::Socket(place) => self.rack.is_closed(place),
            Input::Signal(In::EmergencyStopOk) => self.chain.emergency_stop_ok(),
            Input::Signal(In::DoorClosed) => self.chain.door_closed(),
            Input::Signal(In::DoorLocked) => self.locked(),
            Input::Signal(In::LimiterOk) => self.chain.limiter_ok(),
            Input::Signal(In::AirflowOk) => self.chain.airflow_ok(),
            Input::Signal(In::MainsOk) => self.chain.mains,
        }
    }

    /// Returns how much of the last step the present instant has reached, 0 to 1.
    fn share(&self) -> f64 {
        1.0 - (self.done_us - self.now_us.min(self.done_us)) as f64 / STEP_US as f64
    }

    fn drop_v(&mut self) -> f64 {
        let on = self.commands.is_on(Out::ContactCurrent);
        let amps = if on {
            self.table.contact_current_ma * 1e-3
        } else {
            0.0
        };
        let most_v = self.table.compliance_v;
        self.rack.drop_v(self.commands.selected(), amps, most_v)
    }
}

/// Draws the sensors: control, reference, rack, heater; `error_k`: of the reference sensor by its certificate.
fn gauges(
    table: &SensorsTable,
    (air, error_k): (SensorValues, f64),
    ambient_c: f64,
    draw: &mut Draw,
) -> [Gauge; 4] {
    let noise_k = table.noise_k;
    let pt100 = SensorValues { noise_k, ..air };
    let thermocouple = SensorValues {
        delay_s: 0.0,
        lag_s: table.thermocouple_lag_s,
        noise_k: table.thermocouple_noise_k,
        ..air
    };
    let kinds = [
        (pt100, table.bias_sd_k),
        (
            SensorValues {
                bias_k: error_k,
                ..pt100
            },
            table.bias_sd_k,
        ),
        (pt100, table.bias_sd_k),
        (thermocouple, table.thermocouple_bias_sd_k),
    ];
    kinds.map(|(values, bias_sd_k)| {
        Gauge::new(values.drawn(bias_sd_k, table.times_sd_pct, draw), ambient_c)
    })
}

impl Plant for OvenWorld {
    fn advance(&mut self, t_us: u64) {
        self.now_us = self.now_us.max(t_us);
    }

    fn analog_in(&mut self, module: &str, channel: u8) -> f64 {
        self.catch_up();
        if let Some(wire) = at(&self.wiring.thermometers, module, channel) {
            let place = match wire.signal {
                Thermometer::Control => 0,
                Thermometer::Reference => 1,
                Thermometer::Rack => 2,
                Thermometer::Heater => 3,
            };
            let share = self.share();
            return self.gauges[place].sample(share, &mut self.noise);
        }
        let limit_v = self.table.input_limit_v;
        match at(&self.wiring.quantities, module, channel) {
            Some(wire) => match wire.signal {
                Quantity::SocketDrop => (self.drop_v() * wire.gain).clamp(-limit_v, limit_v),
            },
            None => f64::NAN,
        }
    }

    fn analog_out(&mut self, module: &str, channel: u8, volts: f64) {
        self.catch_up();
        let share = (volts / FULL_V).clamp(0.0, 1.0);
        match at(&self.wiring.powers, module, channel).map(|wire| wire.signal) {
            Some(Power::Heater) => self.duty = share,
            Some(Power::Vent) => self.vent = share,
            None => {}
        }
    }

    fn digital_in(&mut self, module: &str) -> u16 {
        self.catch_up();
        on(&self.wiring.inputs, module)
            .iter()
            .fold(0xFFFF, |bits, (channel, wire)| {
                let high = self.input(wire.signal) != wire.active_low;
                if high { bits } else { bits & !(1 << channel) }
            })
    }

    fn digital_out(&mut self, module: &str, bits: u16) {
        self.catch_up();
        for (channel, wire) in on(&self.wiring.outputs, module) {
            let is_on = (bits >> channel & 1 == 1) != wire.active_low;
            let goes_on = is_on && !self.commands.is_on(wire.signal);
            self.commands.set(wire.signal, is_on);
            if goes_on && matches!(wire.signal, Out::MainContactor | Out::DoorLockRelease) {
                self.moves.push(ChamberMove {
                    t_us: self.now_us,
                    output: wire.signal.name(),
                    rack_c: self.chamber.temperatures().rack_c,
                });
            }
        }
    }

    /// Counts the edges of contacts; other inputs have no counter.
    fn edges(&mut self, module: &str, channel: u8) -> u64 {
        self.catch_up();
        match at(&self.wiring.inputs, module, channel).map(|wire| wire.signal) {
            Some(Input::Socket(place)) => self.rack.edges(place, self.now_us),
            Some(Input::Signal(_)) | None => 0,
        }
    }

    fn gate_open_us(&mut self, _module: &str, _channel: u8) -> f64 {
        0.0
    }

    fn reference_clock_hz(&self) -> f64 {
        0.0
    }
}

#[cfg(test)]
mod tests;
