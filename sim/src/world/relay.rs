//! A relay on the probes: coil, armature and two contacts, moved from event to event.
//!
//! The armature rests, grows away from its stop while the mode of [`super::mode`] builds up, flies
//! to the other side and is seated; the way back is the same. NC opens as the mode starts (the
//! pickup fold is NC lift-off), NO makes after the flight and bounces; NO opens as the release
//! mode is complete, NC makes after the fall and bounces. A pulse that ends too early lets the
//! armature fall back on its stop and NC close again. Thresholds follow the copper's temperature
//! and scatter from operation to operation.

mod armature;
pub mod lumped;

use std::collections::VecDeque;

use super::draw::Draw;
use super::mode::{Lagged, Laws, Stretch};
use super::record::Record;
use super::specimen::Specimen;
use super::table::{RelayTable, WorldTable};
use super::thermal::Thermal;
use crate::world::defect::Defect;

/// Temperature at which thresholds and coil resistance are stated, degrees Celsius.
pub const REFERENCE_C: f64 = 23.0;

/// One of the two contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contact {
    /// Normally open.
    No,
    /// Normally closed.
    Nc,
}

/// A contact has opened or closed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// Instant, microseconds.
    pub t_us: f64,
    /// Which contact.
    pub contact: Contact,
    /// Closed from now on.
    pub closed: bool,
}

/// What stands at the coil.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Supply {
    /// A source of so many volts.
    Volts(f64),
    /// Nothing but the clamp, volts across it while current flows.
    Off {
        /// Forward voltage of the clamp.
        clamp_v: f64,
        /// The slow clamp, a plain diode.
        slow: bool,
    },
}

impl Supply {
    /// Volts that a source applies.
    pub fn volts(self) -> f64 {
        match self {
            Self::Volts(v) => v,
            Self::Off { .. } => 0.0,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    Rest,
    Growing,
    Flying { until_us: f64 },
    Seated,
    Leaving,
    Falling { until_us: f64 },
}

/// A relay whose coil and contacts somebody can touch.
#[derive(Debug, Clone)]
pub struct Relay {
    specimen: Specimen,
    operate: Laws,
    release: Laws,
    zener_lag: f64,
    diode_lag: f64,
    copper_zero_c: f64,
    inductance: [f64; 2],
    flight_us: [f64; 2],
    scatter_v: f64,
    bounce_ln_sd: f64,
    ambient_c: f64,
    thermal: Thermal,
    draw: Draw,
    phase: Phase,
    supply: Supply,
    stretch: Stretch,
    z0: f64,
    since_us: f64,
    checked_us: f64,
    threshold_v: f64,
    operation_v: f64,
    current_a: f64,
    closed: [bool; 2],
    bounce: VecDeque<Change>,
    /// What this relay has shown so far.
    pub record: Record,
}

/// Longest stretch over which resistance and thresholds are held still, microseconds.
const STILL_US: f64 = 50_000.0;

impl Relay {
    /// Puts a specimen into the world at an instant; `draw` is the chance of its operations.
    pub fn new(
        specimen: Specimen,
        world: &WorldTable,
        mut draw: Draw,
        t_us: f64,
        track_c: f64,
        ambient_c: f64,
    ) -> Self {
        let table = &world.relay;
        let (operate, release) = laws(table);
        let welded = specimen.defect == Some(Defect::StuckNo);
        let above = track_c + specimen.offset_k - ambient_c;
        let film = if welded {
            specimen.film_no
        } else {
            specimen.film_nc
        };
        let mut record = Record::new(&specimen);
        record.close(
            if welded { Contact::No } else { Contact::Nc },
            film.close(&mut draw),
        );
        let flight_us = [specimen.operate_flight_ms(operate), {
            let zener = Laws {
                coil_lag: table.release_zener_lag_ms,
                ..release
            };
            specimen.release_flight_ms(zener)
        }]
        .map(|ms| ms * 1000.0);
        let mut relay = Self {
            operate,
            release,
            zener_lag: table.release_zener_lag_ms,
            diode_lag: table.release_diode_lag_ms,
            copper_zero_c: table.copper_zero_c,
            inductance: [table.inductance_open_h, table.inductance_sealed_h]
                .map(|l| l * specimen.ohm_scale),
            flight_us,
            scatter_v: world.lot.threshold_scatter_sd_mv * 1e-3 * specimen.volt_scale,
            bounce_ln_sd: world.lot.bounce_ln_sd,
            ambient_c,
            thermal: Thermal::new(table, above),
            draw,
            phase: if welded { Phase::Seated } else { Phase::Rest },
            supply: Supply::Off {
                clamp_v: world.board.zener_v,
                slow: false,
            },
            stretch: Stretch::new(operate, Lagged::default(), 0.0),
            z0: 0.0,
            since_us: t_us,
            checked_us: t_us,
            threshold_v: 1.0,
            operation_v: 0.0,
            current_a: 0.0,
            closed: [welded, !welded],
            bounce: VecDeque::new(),
            record,
            specimen,
        };
        relay.operation_v = relay.draw.normal(0.0, relay.scatter_v);
        relay.restart(t_us, Lagged::default(), 0.0);
        relay
    }

    /// The specimen behind it.
    pub fn specimen(&self) -> &Specimen {
        &self.specimen
    }

    /// Whether a contact is closed now.
    pub fn is_closed(&self, contact: Contact) -> bool {
        self.closed[contact as usize]
    }

    /// Coil resistance now, ohm.
    pub fn coil_ohm(&self) -> f64 {
        self.specimen.coil_ohm * self.copper_ratio()
    }

    /// Coil current at an instant not before the last event, ampere.
    pub fn coil_current_a(&self, t_us: f64) -> f64 {
        let ohm = self.coil_ohm();
        if ohm.is_infinite() {
            return 0.0;
        }
        let still = match self.supply {
            Supply::Volts(v) => v / ohm,
            Supply::Off { clamp_v, .. } => -clamp_v / ohm,
        };
        let henry = self.inductance[usize::from(self.is_seated())];
        let decay = (-(t_us - self.since_us) * 1e-6 * ohm / henry).exp();
        let current = still + (self.current_a - still) * decay;
        match self.supply {
            Supply::Volts(_) => current,
            Supply::Off { .. } => current.max(0.0),
        }
    }

    /// Another supply from now on; the relay must have been advanced to `t_us`.
    pub fn drive(&mut self, t_us: f64, supply: Supply) {
        if supply == self.supply {
            return;
        }
        let old = self.supply.volts();
        self.settle(t_us);
        self.supply = supply;
        let (state, z) = (self.arrived(t_us), self.mode_at(t_us));
        self.restart(t_us, state, z);
        let still = matches!(self.phase, Phase::Rest | Phase::Seated);
        self.record.supply_step(t_us, old, supply.volts(), still);
    }

    /// Goes on to `t_us`, or to the first change of a contact before it.
    pub fn advance(&mut self, t_us: f64) -> Option<Change> {
        loop {
            let until = t_us.min(self.since_us + STILL_US);
            let own = self.next_turn(until);
            let bounce = self
                .bounce
                .front()
                .filter(|c| c.t_us <= own.unwrap_or(until))
                .copied();
            let change = match (bounce, own) {
                (Some(change), _) => {
                    self.bounce.pop_front();
                    self.record
                        .bounce(change.contact, change.t_us, change.closed);
                    self.set(change)
                }
                (None, Some(at)) => self.turn(at),
                (None, None) if until < t_us => {
                    self.settle(until);
                    let (state, z) = (self.arrived(until), self.mode_at(until));
                    self.restart(until, state, z);
                    None
                }
                (None, None) => {
                    self.checked_us = t_us;
                    return None;
                }
            };
            if change.is_some() {
                return change;
            }
        }
    }

    fn is_seated(&self) -> bool {
        matches!(self.phase, Phase::Seated | Phase::Leaving)
    }

    fn copper_ratio(&self) -> f64 {
        let above_zero = self.ambient_c + self.thermal.coil_k() - self.copper_zero_c;
        above_zero / (REFERENCE_C - self.copper_zero_c)
    }

    /// Heat and current up to `t_us`; the supply has been still since the last call.
    fn settle(&mut self, t_us: f64) {
        let volts = self.supply.volts();
        self.current_a = self.coil_current_a(t_us);
        self.thermal.advance(
            (t_us - self.since_us) * 1e-6,
            volts * volts / self.coil_ohm(),
        );
    }

    /// A new stretch from `t_us`.
    fn restart(&mut self, t_us: f64, state: Lagged, z: f64) {
        let dead = self.specimen.coil_ohm.is_infinite();
        let volts = if dead { 0.0 } else { self.supply.volts() };
        let base = match self.phase {
            Phase::Rest | Phase::Growing | Phase::Flying { .. } => self.operate,
            Phase::Seated | Phase::Leaving | Phase::Falling { .. } => self.release,
        };
        let coil_lag = match self.supply {
            Supply::Volts(_) => base.coil_lag,
            Supply::Off { slow: true, .. } => self.diode_lag.min(base.coil_lag),
            Supply::Off { slow: false, .. } => self.zener_lag,
        };
        self.stretch = Stretch::new(Laws { coil_lag, ..base }, state, volts);
        self.threshold_v = self.threshold_now();
        self.z0 = z;
        self.since_us = t_us;
        self.checked_us = t_us;
    }

    fn threshold_now(&self) -> f64 {
        let at_reference = match self.phase {
            Phase::Rest | Phase::Growing | Phase::Flying { .. } => self.specimen.operate_v,
            Phase::Seated | Phase::Leaving | Phase::Falling { .. } => self.specimen.release_v,
        };
        at_reference * self.copper_ratio() + self.operation_v
    }
}

/// Laws of operating and of releasing.
pub fn laws(table: &RelayTable) -> (Laws, Laws) {
    let operate = Laws {
        coil_lag: table.operate_coil_lag_ms,
        armature_lag: table.operate_armature_lag_ms,
        growth: table.operate_growth_ms,
        gain: table.operate_gain_per_ms,
    };
    let release = Laws {
        coil_lag: table.release_coil_lag_ms,
        armature_lag: table.release_armature_lag_ms,
        growth: table.release_growth_ms,
        gain: -table.release_gain_per_ms,
    };
    (operate, release)
}
