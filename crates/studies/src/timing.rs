//! Error of times and bounces: how much a counter latch that ends the count at the first make reduces the error, and
//! what reference clock, gate delay and bus add.
//!
//! Gate 0 is latched: its count ends at the first make. Gate 1 is raw: it counts while the contact is open, bounces
//! included. Gate 1 alone would report the time plus the bounce, so the row "raw gate" adds both values of the same
//! test. A count is the number of whole clock periods, whose phase is random: its error is 8.2 us rms at 50 kHz and any
//! baud rate. A bounce is the difference of two counts. The truth holds the time of the last operation only, so the
//! study measures a single operation instead of averaging several.

use super::error::Pooled;
use super::figure::{Bar, Figure};
use super::lot::{Lot, Part};
use super::method::{self, BAUDS, TimedParameter};
use super::order::Order;
use super::output::Report;
use super::variant::{Change, Variant};
use machine::dut::em_relay::Parameter;

const OPERATE: &[&str] = &["timed_operate"];
const RELEASE: &[&str] = &["timed_release"];
/// Name of each direction (operate, release), its time and its bounce.
const DIRECTIONS: [(&str, TimedParameter, TimedParameter); 2] = [
    (
        "operate",
        TimedParameter::of(Parameter::OperateTime, OPERATE),
        TimedParameter::of(Parameter::OperateBounce, OPERATE),
    ),
    (
        "release",
        TimedParameter::of(Parameter::ReleaseTime, RELEASE),
        TimedParameter::of(Parameter::ReleaseBounce, RELEASE),
    ),
];
/// Greatest rms error of a time with the default recipe and all errors, ms.
const TIME_MS: f64 = 0.02;
/// Greatest rms error of a bounce with the default recipe and all errors, ms.
const BOUNCE_MS: f64 = 0.05;

/// Runs the lots and makes the report.
///
/// # Errors
/// Fails when a lot cannot be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let mut gates = Vec::new();
    for baud in BAUDS {
        let lots = method::lots(&Variant::exact(baud, Vec::new()), order)?;
        gates.extend(rows(&baud.to_string(), &lots));
    }
    let groups = vec![gates, errors(order)?];
    let marks = vec![TIME_MS, BOUNCE_MS];
    Ok(method::report("timing", order, groups, 2, marks))
}

/// Returns the rows of both directions: latched gate, raw gate, bounce.
fn rows(name: &str, lots: &[Lot]) -> Vec<Figure> {
    let of = |(direction, time, bounce): &(&str, TimedParameter, TimedParameter)| {
        let raw = Pooled::by(lots, |part| raw(part, time.parameter, bounce.parameter));
        [
            time.row(format!("{direction}, latched gate, {name}"), lots),
            time.row_of(format!("{direction}, raw gate, {name}"), lots, &raw),
            bounce.row(format!("{direction} bounce, {name}"), lots),
        ]
    };
    DIRECTIONS.iter().flat_map(of).collect()
}

/// Returns the error that the raw counter gate 1 alone would make, ms: measured time plus measured bounce, minus the
/// true time.
fn raw(part: &Part, time: Parameter, bounce: Parameter) -> Option<f64> {
    let (time, bounce) = (part.reading(time)?, part.reading(bounce)?);
    Some(time.value + bounce.value - time.truth)
}

/// Measures in worlds with one kind of error each, and in the world with all of them.
fn errors(order: &Order) -> anyhow::Result<Vec<Figure>> {
    let worlds: [(&str, Vec<Change>); 2] = [
        (
            "reference clock up to 50 ppm off",
            vec![("devices.clock_ppm", 50.0.into())],
        ),
        (
            "gates up to 10 us late",
            vec![("board.gate_delay_us", 10.0.into())],
        ),
    ];
    let mut figures = Vec::new();
    for (name, world) in worlds {
        let variant = Variant::exact(BAUDS[0], Vec::new()).in_world(world);
        let lots = method::lots(&variant, order)?;
        let rows = rows(name, &lots).into_iter();
        figures.extend(rows.filter(|row| !row.name.contains("raw")));
    }
    let lots = method::lots(&Variant::erring(BAUDS[0], Vec::new()), order)?;
    for (direction, time, bounce) in DIRECTIONS {
        let of = |timed: TimedParameter, what: &str, bar: f64| {
            let name = format!("{direction}{what}, every error of the world");
            timed.row(name, &lots).bar(Bar::AtMost(bar))
        };
        figures.extend([of(time, "", TIME_MS), of(bounce, " bounce", BOUNCE_MS)]);
    }
    Ok(figures)
}
