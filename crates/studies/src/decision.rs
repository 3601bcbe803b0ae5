//! False accepts and false rejects: counted against the truth, and predicted by the decision rule ([`super::risk`])
//! from the rows.
//!
//! A lot in the middle of its limits has almost no risk, so that a count of zero proves little. A second set of lots
//! therefore has its mean operate voltage one standard deviation inside the limit: one part in six lies beyond the
//! limit, and one in twenty gets a confirmation measurement.
//!
//! The errors of reference parts and instruments are common to all parts of a lot, so that lots differ by more than
//! chance. A count must lie within three standard deviations of its prediction; the standard deviation is that of the
//! sum over lots, from the scatter between lots.

use super::bins;
use super::chart::Chart;
use super::figure::{Bar, Figure};
use super::lot::{Lot, Part, Reading};
use super::method::{self, BAUDS};
use super::order::Order;
use super::output::Report;
use super::risk::DecisionRisk;
use super::variant::Variant;
use machine::dut::Characteristic;
use machine::dut::em_relay::Parameter;
use quality::Spread;
use quality::spread::median;
use std::ops::RangeInclusive;

/// Parts per million.
const PPM: f64 = 1e6;
/// Rated coil voltage of the part that the table `[lot]` of a world describes, V.
const LOT_V: f64 = 12.0;
/// Share of the usual uncertainty below which a value must have had a confirmation measurement: noise alone changes an
/// uncertainty by less than 2 %.
const AGAIN: f64 = 0.98;

/// Runs the lots and makes the report.
///
/// # Errors
/// Fails when a lot cannot be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let lots = order.run_all()?;
    let (rows, risks): (Vec<Figure>, Vec<Option<(f64, f64)>>) = order
        .admitted()
        .iter()
        .map(|(characteristic, limits)| predicted(*characteristic, limits, &lots))
        .unzip();
    let about = order.about();
    let title = format!("rejects of good parts that the rule predicts: {about}");
    let chart = Chart::of(title, "ppm", Vec::new(), &rows);
    let sum = |all: (f64, f64), it: (f64, f64)| (all.0 + it.0, all.1 + it.1);
    let risks = risks.into_iter().flatten().fold((0.0, 0.0), sum);
    let groups = vec![
        counted("", &lots, risks),
        at_limit(order, &lots)?,
        bins::outcome(&lots),
        rows,
    ];
    Ok(Report::new("decision", about, groups, chart))
}

/// Predicts the false rejects and accepts of one characteristic by the decision rule. Returns a row in parts per
/// million with and without guard band, and the probabilities of a false accept and of a false reject with guard band.
fn predicted(
    characteristic: Characteristic,
    limits: &RangeInclusive<f64>,
    lots: &[Lot],
) -> (Figure, Option<(f64, f64)>) {
    let readings = readings(characteristic, lots);
    let chance = chance(&readings);
    let [guarded, unguarded] = [1.0, 0.0].map(|guard| chance?.of(limits, guard));
    let accept = |risk: Option<(f64, f64)>| risk.map(|it| it.0 * PPM);
    let reject = |risk: Option<(f64, f64)>| risk.map(|it| it.1 * PPM);
    let (name, n) = (characteristic.key(), readings.len() as u64);
    let row = Figure::new(name, n, reject(guarded), "ppm")
        .with("false_accept", accept(guarded))
        .with("unguarded_reject", reject(unguarded))
        .with("unguarded_accept", accept(unguarded));
    (row, guarded)
}

fn readings(characteristic: impl Into<Characteristic> + Copy, lots: &[Lot]) -> Vec<Reading> {
    lots.iter()
        .flat_map(Lot::good)
        .filter_map(|part| part.reading(characteristic))
        .collect()
}

/// Estimates the distributions of process and measurement from `readings`. The process is normal; its variance is that
/// of the values minus that of the measurement. The uncertainty of one measurement is the median over parts; the
/// uncertainty after a confirmation measurement is the median of the uncertainties that are clearly smaller.
fn chance(readings: &[Reading]) -> Option<DecisionRisk> {
    let values = Spread::of(&readings.iter().map(|it| it.value).collect::<Vec<f64>>());
    let stated: Vec<f64> = readings.iter().filter_map(|it| it.uncertainty).collect();
    let u = median(&stated)? / 2.0;
    let again: Vec<f64> = stated
        .iter()
        .map(|expanded| expanded / 2.0)
        .filter(|it| *it < AGAIN * u)
        .collect();
    let sd = values.sd()?;
    Some(DecisionRisk {
        mean: values.mean()?,
        sd: (sd * sd - u * u).max(sd * sd * 0.01).sqrt(),
        u,
        again: median(&again),
    })
}

/// Runs lots whose mean operate voltage lies one standard deviation inside its limit.
fn at_limit(order: &Order, lots: &[Lot]) -> anyhow::Result<Vec<Figure>> {
    let admitted = order.admitted();
    let operate = Characteristic::from(Parameter::OperateVoltage);
    let known = |(characteristic, _): &&(Characteristic, _)| *characteristic == operate;
    let limits = admitted.iter().find(known).map(|(_, limits)| limits);
    let usual = chance(&readings(Parameter::OperateVoltage, lots));
    let (Some(limits), Some(usual)) = (limits.filter(|it| it.end().is_finite()), usual) else {
        return Ok(Vec::new());
    };
    let mean = limits.end() - usual.sd;
    let of_lot = LOT_V / order.nominal_v()?;
    let recipe = vec![("test.expected_operate_v", mean.into())];
    let variant = Variant::erring(BAUDS[0], recipe)
        .in_world(vec![("lot.operate_v_mean", (mean * of_lot).into())]);
    let lots = method::lots(&variant, order)?;
    let chance = chance(&readings(Parameter::OperateVoltage, &lots));
    let risks = chance
        .and_then(|it| it.of(limits, 1.0))
        .unwrap_or((f64::NAN, f64::NAN));
    let mut figures = counted("at the limit: ", &lots, risks);
    let rows = readings(Parameter::OperateVoltage, &lots);
    let again = rows.iter().filter(|row| is_again(row, chance)).count();
    figures.push(Figure::count(
        "at the limit: measured again",
        rows.len() as u64,
        Some(again as u64),
    ));
    Ok(figures)
}

fn is_again(reading: &Reading, chance: Option<DecisionRisk>) -> bool {
    let (u, usual) = (reading.uncertainty, chance.map(|it| 2.0 * it.u));
    u.zip(usual).is_some_and(|(u, usual)| u < AGAIN * usual)
}

/// Counts false accepts and false rejects over good and bad parts, and shows each count beside its prediction for the
/// same number of parts.
fn counted(which: &str, lots: &[Lot], (accept, reject): (f64, f64)) -> Vec<Figure> {
    let row = |what: &str, risk: f64, is: fn(&Part) -> bool| {
        let each: Vec<f64> = lots
            .iter()
            .map(|lot| lot.parts.iter().filter(|part| is(part)).count() as f64)
            .collect();
        let n: u64 = lots.iter().map(|lot| lot.parts.len() as u64).sum();
        let (found, expected) = (each.iter().sum::<f64>(), risk * n as f64);
        let by_lots = Spread::of(&each).sd().unwrap_or(0.0) * (each.len() as f64).sqrt();
        let sd = by_lots.max(expected.sqrt());
        let (low, high) = ((expected - 3.0 * sd).ceil(), (expected + 3.0 * sd).floor());
        Figure::count(format!("{which}{what}, counted"), n, Some(found as u64))
            .with("predicted", Some(expected))
            .bar(Bar::Within(low.max(0.0), high))
    };
    vec![
        row("false accepts", accept, |part| {
            !part.is_conforming() && part.has_passed()
        }),
        row("false rejects", reject, |part| {
            part.is_conforming() && part.verdict == "fail"
        }),
    ]
}
