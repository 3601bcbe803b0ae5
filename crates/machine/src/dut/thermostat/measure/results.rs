//! Turns instants and the record of the reference thermometer into results and verdicts of the parts.

use super::Ended;
use super::contacts::Events;
use super::creep::{self, Pulse};
use super::drop::Found;
use super::passes::Work;
use super::windows::shown;
use crate::dut::batch::{BatchOrder, BatchTrouble, HeatTrouble, SocketResult};
use crate::dut::record::Own;
use crate::dut::thermostat::certificate::Certificate;
use crate::dut::thermostat::device::{Device, Lesson, SENSOR_LAG_S};
use crate::dut::thermostat::{Finding, Parameter};
use crate::dut::{Characteristic, TestRecord, Verdict};
use crate::gauge::{Budget, Reading};
use crate::rig::sample::Sample;
use chamber::budget::Calibrations;
use chamber::lag::{
    Estimate, LAG_SPREAD, LotLag, Noise, Record, Switching, Value, estimate, lot_lag, lot_scatter,
};
use std::sync::Arc;
use units::Unit;

/// Least scatter of a switching from cycle to cycle that estimates assume, K.
pub const SCATTER_K: f64 = 0.15;
/// Standard uncertainty of a lag that only the recipe states, as a share of it.
const STATED_LAG: f64 = 0.3;

/// Departure of the lag of a part from that of its lot above which the part is slow, in spreads of the lot: double at the
/// usual spread of 15 %.
const SLOW: f64 = 4.6;
/// Departure of the lag of a lot from the expected one, as a share of the latter, above which a batch reports it.
const ODD_LAG: f64 = 0.4;

/// What a batch has recorded.
pub struct Recorded<'a> {
    /// Readings of the reference thermometer.
    pub record: &'a Record,
    /// Switchings by socket, in the order of the batch.
    pub events: Vec<Events>,
    /// True for each contact that was open before heating.
    pub cold_open: Vec<bool>,
    /// Contact resistances before heating with the numbers of their sockets; not of a contact that was open, or not read.
    pub drops: &'a [(u16, Found)],
    /// Resistances in the last rise, by the place of the contact in the batch.
    pub pulses: &'a [(usize, Pulse)],
    /// Temperature of the room, C.
    pub ambient_c: f64,
    /// Last reading of the reference thermometer; `None` for a model that reads none.
    pub last: Option<&'a Sample>,
}

impl Recorded<'_> {
    /// Returns the contact resistance of a socket before heating; `None` when it was not measured.
    fn drop_of(&self, socket: u16) -> Option<&Found> {
        let of_socket = |(number, _): &&(u16, Found)| *number == socket;
        self.drops.iter().find(of_socket).map(|(_, found)| found)
    }
}

/// Returns lag and scatter of the lot, and true when passes have measured the lag. The lag comes from this batch, else
/// from an earlier one, else from the recipe. At least half of the parts must show a lag: in a batch of a single pass,
/// a defective part that switches twice shows none.
pub fn lot(device: &Device, record: &Record, events: &[Events]) -> (LotLag, bool, f64) {
    let all: Vec<Switching> = events.iter().map(|it| it.switching.clone()).collect();
    let test = &device.thermostat.test;
    let assumed = Noise {
        scatter_k: device.lesson.as_ref().map_or(SCATTER_K, |it| it.scatter_k),
        sensor_lag_s: SENSOR_LAG_S,
    };
    let told = test
        .has_two_rates()
        .then(|| lot_lag(record, &all, &assumed))
        .flatten()
        .filter(|it| 2 * it.parts >= all.len());
    let known = told.or(device.lesson.as_ref().and_then(|it| it.lag));
    let stated_s = (device.thermostat.part.lag_s - SENSOR_LAG_S).max(2.0);
    let lag = known.unwrap_or(LotLag {
        seconds: stated_s,
        u_s: STATED_LAG * device.thermostat.part.lag_s,
        spread: LAG_SPREAD,
        parts: 0,
    });
    let scatter_k = lot_scatter(record, &all, &lag, &assumed);
    (lag, known.is_some(), scatter_k)
}

/// Returns the trouble of a batch whose measured lag departs by more than [`ODD_LAG`] from the lag of the batch before,
/// or else from that of the recipe.
pub fn unexpected_lag(device: &Device, recorded: &Recorded) -> Option<BatchTrouble> {
    let (found, is_told, _) = lot(device, recorded.record, &recorded.events);
    let lesson = device.lesson.as_ref().and_then(|it| it.lag);
    let stated_s = device.thermostat.part.lag_s - SENSOR_LAG_S;
    let expected_s = lesson.map_or(stated_s, |it| it.seconds);
    let is_off = is_told && (found.seconds - expected_s).abs() > ODD_LAG * expected_s.abs();
    let whole = |seconds: f64| (seconds + SENSOR_LAG_S).max(0.0).round() as u32;
    is_off.then(|| BatchTrouble::LagUnexpected(whole(found.seconds), whole(expected_s)))
}

/// Judges every part of a batch; each record keeps the [`Lesson`] of the batch.
pub fn batch(
    device: &Device,
    order: &BatchOrder,
    recorded: &Recorded,
    work: Option<&Work>,
) -> Vec<SocketResult> {
    let Some(chamber) = work.and_then(Work::chamber) else {
        return void(
            device,
            order,
            Some(Ended::Found(Finding::Heat(HeatTrouble::NotIdentified))),
        );
    };
    let (lag, is_known, scatter_k) = lot(device, recorded.record, &recorded.events);
    let expected = device.thermostat.windows(&device.recipe.limits);
    let windows = expected.map(|it| shown(recorded.record, &recorded.events, lag.seconds, it));
    let Some(windows) = windows else {
        panic!("a recipe without windows is not feasible");
    };
    let lesson = Arc::new(Lesson {
        batch: order.number,
        ambient_c: recorded.ambient_c,
        chamber,
        lag: is_known.then_some(lag),
        windows,
        scatter_k,
    });
    judged(device, &order.sockets, recorded, &lesson, &lag)
}

fn judged(
    device: &Device,
    sockets: &[u16],
    recorded: &Recorded,
    lesson: &Arc<Lesson>,
    lag: &LotLag,
) -> Vec<SocketResult> {
    let noise = Noise {
        scatter_k: lesson.scatter_k,
        sensor_lag_s: SENSOR_LAG_S,
    };
    let filtered = recorded.record.filtered(lag.seconds);
    let one = |(index, socket): (usize, &u16)| {
        let mut record = TestRecord::default();
        record.own = Own::Thermostat(Arc::clone(lesson));
        let events = &recorded.events[index];
        if recorded.cold_open[index] {
            record.stop(Finding::OpenCold);
        } else {
            let cold = recorded.drop_of(*socket);
            let own = recorded.pulses.iter().filter(|(place, _)| *place == index);
            let pulses: Vec<Pulse> = own.map(|(_, pulse)| *pulse).collect();
            contact(&mut record, cold, &pulses, &events.switching);
            if let Some((cold, samples)) = cold.and_then(Option::as_ref) {
                let width = creep::width(&pulses, cold.value, &events.switching, &filtered);
                if let Some(width) = width {
                    record.found(Parameter::Creep, width, samples);
                }
            }
            let found = estimate(recorded.record, &events.switching, lag, &noise);
            if found.is_some_and(|it| is_slow(&it, lag)) {
                record.stop(Finding::Slow);
            }
            if events.is_intermittent() {
                record.stop(Finding::Intermittent);
            }
            let site = Site::of(device, *socket, recorded.ambient_c);
            temperatures(&mut record, events, found, (&site, recorded));
        }
        result(device, *socket, record)
    };
    sockets.iter().enumerate().map(one).collect()
}

/// Returns true for a part whose lag is far beyond that of its lot. Passes of one rate tell no lag but that of the lot.
fn is_slow(part: &Estimate, lot: &LotLag) -> bool {
    let behind_air_s = |lag_s: f64| lag_s + SENSOR_LAG_S;
    let ratio = behind_air_s(part.lag_s) / behind_air_s(lot.seconds);
    ratio.ln() > SLOW * lot.spread
}

/// Returns void results for all parts of a batch that ended before it could judge them.
pub fn void(device: &Device, order: &BatchOrder, why: Option<Ended>) -> Vec<SocketResult> {
    let one = |socket: &u16| {
        let mut record = TestRecord::default();
        match &why {
            Some(Ended::Found(found)) => record.stop(*found),
            Some(Ended::Trouble(why)) => record.trouble(why.clone()),
            None => record.stop(Finding::NoTemperature),
        }
        result(device, *socket, record)
    };
    order.sockets.iter().map(one).collect()
}

/// Stores the contact resistance: that before heating, or its mean with the resistance that pulses have met at another
/// closure of the contact.
fn contact(
    record: &mut TestRecord,
    found: Option<&Found>,
    pulses: &[Pulse],
    switching: &Switching,
) {
    match found {
        Some(Some((reading, samples))) => {
            let other = creep::sound_mohm(pulses, reading.value, switching);
            let reading = Reading {
                value: other.map_or(reading.value, |it| f64::midpoint(it, reading.value)),
                ..reading.clone()
            };
            record.found(Parameter::Contact, reading, samples);
        }
        Some(None) => record.stop(Finding::OpenCold),
        None => record.stop(Finding::DropNotReadable),
    }
}

/// Socket of a part, with the certificate that corrects temperatures there.
pub struct Site<'a> {
    certificate: Option<&'a Certificate>,
    /// Place of the socket in the order of the numbers, from 0.
    place: usize,
    ambient_c: f64,
}

impl<'a> Site<'a> {
    /// Makes the site of a socket.
    pub fn of(device: &'a Device, socket: u16, ambient_c: f64) -> Self {
        let all = device.points.sockets.iter();
        Self {
            certificate: device.certificate.as_deref(),
            place: all.filter(|it| it.number < socket).count(),
            ambient_c,
        }
    }

    /// Converts an estimate from readings of the reference thermometer to temperatures of the part at its socket.
    pub fn corrected(&self, found: Estimate) -> Estimate {
        let correct = |it: Value| Value {
            value: self.certificate.map_or(it.value, |of_rack| {
                of_rack.correct(it.value, self.place, self.ambient_c)
            }),
            ..it
        };
        let (operate, reset) = (found.operate.map(correct), found.reset.map(correct));
        let both = operate.zip(reset).zip(found.differential);
        Estimate {
            operate,
            reset,
            differential: both.map(|((operate, reset), it)| Value {
                value: operate.value - reset.value,
                ..it
            }),
            ..found
        }
    }

    /// Returns the calibrations behind the correction.
    pub fn calibrations(&self) -> Calibrations {
        self.certificate
            .map_or_else(Calibrations::default, Certificate::remaining)
    }
}

fn temperatures(
    record: &mut TestRecord,
    events: &Events,
    found: Option<Estimate>,
    (site, recorded): (&Site, &Recorded),
) {
    let samples = recorded.last;
    if let Some(edges) = events.most_extra_edges() {
        let reading = Reading {
            value: f64::from(edges),
            unit: Unit::One,
            budget: Budget::default(),
        };
        record.found(Parameter::Chatter, reading, samples);
    }
    if let Some(found) = found {
        let (found, of) = (site.corrected(found), site.calibrations());
        let mut keep = |of: Parameter,
                        value: Option<Value>,
                        unit: Unit,
                        budget: &dyn Fn(&Value) -> chamber::budget::Budget| {
            if let Some(value) = value {
                record.found(of, reading(&value, unit, &budget(&value)), samples);
            }
        };
        let ambient_c = site.ambient_c;
        let absolute = |it: &Value| of.of_temperature(it.value - ambient_c, it.u_k);
        keep(Parameter::Operate, found.operate, Unit::Celsius, &absolute);
        keep(Parameter::Reset, found.reset, Unit::Celsius, &absolute);
        let relative = |it: &Value| of.of_differential(it.value, it.u_k);
        keep(
            Parameter::Differential,
            found.differential,
            Unit::Kelvin,
            &relative,
        );
        if let Some(value) = found.range_k {
            let u_k = found.operate.map_or(0.0, |it| it.u_k);
            let reading = Reading {
                value,
                unit: Unit::Kelvin,
                budget: Budget::default().with_random("fit", u_k),
            };
            record.found(Parameter::Repeatability, reading, samples);
        }
    }
    let Switching { operate, reset } = &events.switching;
    if operate.is_empty() {
        record.stop(Finding::NeverOperates);
    } else if reset.is_empty() {
        record.stop(Finding::NeverResets);
    } else if found.is_none() {
        record.stop(Finding::NoTemperature);
    }
}

/// Returns a temperature with its budget. On a rig without calibration of chain and sockets, a term `calibration`
/// raises the uncertainty to its least value.
fn reading(value: &Value, unit: Unit, terms: &chamber::budget::Budget) -> Reading {
    let budget = Budget::default()
        .with("chain", terms.chain_k)
        .with("socket", terms.map_k)
        .with_random("fit", terms.fit_k);
    let least = terms.expanded_k() / crate::gauge::budget::COVERAGE_FACTOR;
    let lacking = (least.powi(2) - budget.combined().powi(2)).max(0.0).sqrt();
    let budget = match lacking > 1e-9 {
        true => budget.with("calibration", lacking),
        false => budget,
    };
    Reading {
        value: value.value,
        unit,
        budget,
    }
}

fn result(device: &Device, socket: u16, record: TestRecord) -> SocketResult {
    let expected = expected(device);
    let judgements = record.judged(&device.recipe, expected.iter().copied());
    SocketResult {
        socket,
        verdict: Verdict::after(record.why_stopped(), &expected, judgements.clone()),
        judgements,
        record,
    }
}

/// Returns the characteristics that each part must have: all but the repeatability of a single pass, and a creep that no
/// pulse has shown.
fn expected(device: &Device) -> Vec<Characteristic> {
    let single = device.thermostat.test.least_passes() < 2;
    Parameter::ALL
        .into_iter()
        .filter(|it| *it != Parameter::Repeatability || !single)
        .filter(|it| *it != Parameter::Creep || has_creep_limit(device))
        .map(Into::into)
        .collect()
}

fn has_creep_limit(device: &Device) -> bool {
    !device.recipe.limits.of(Parameter::Creep).is_open()
}
