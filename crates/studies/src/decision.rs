//! False accepts and false rejects: counted against the truth, and as the rule predicts them.
//!
//! Predicted from what the rows say ([`super::chance`]). A lot in the middle of its limits has next to no risk, and
//! a count of nothing proves little; so a second lot stands at the limit of the operate voltage, one standard
//! deviation inside, where one part in six is beyond it and one in twenty is measured again.
//!
//! What every part of a lot shares (golden parts, instruments) makes lots differ by more than chance does: a count is
//! held against its prediction with three standard deviations of the sum over lots, as the lots themselves scatter.

use super::bins;
use super::chance::Chance;
use super::chart::Chart;
use super::figure::{Bar, Figure};
use super::fleet::Order;
use super::lot::{Lot, Part, Reading};
use super::method::{self, BAUDS};
use super::output::Report;
use super::variant::Variant;
use anyhow::Context as _;
use config::load_recipe;
use machine::dut::em_relay::Parameter;
use quality::Spread;
use quality::spread::median;
use std::ops::RangeInclusive;

/// Parts per million.
const PPM: f64 = 1e6;
/// Voltage of the part that `[lot]` of a world describes.
const LOT_V: f64 = 12.0;
/// What a U must fall by to be that of a slow repetition: noise alone moves it by less.
const AGAIN: f64 = 0.98;

/// Runs the lots and makes the report.
///
/// # Errors
/// A lot that could not be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let lots = order.run_all()?;
    let rows: Vec<Figure> = order
        .admitted
        .iter()
        .map(|(parameter, limits)| predicted(*parameter, limits, &lots))
        .collect();
    let chart = Chart::of(
        format!(
            "rejects of good parts that the rule predicts: {}",
            order.about()
        ),
        "ppm",
        Vec::new(),
        &rows,
    );
    let told = |what: fn(&Figure) -> Option<f64>| rows.iter().filter_map(what).sum::<f64>() / PPM;
    let risks = (told(false_accept), told(|row| row.value));
    let groups = vec![
        counted("", &lots, risks),
        at_limit(order, &lots)?,
        bins::outcome(&lots),
        rows,
    ];
    Ok(Report {
        study: "decision",
        about: order.about(),
        groups,
        notes: Vec::new(),
        chart,
    })
}

fn false_accept(row: &Figure) -> Option<f64> {
    let mut more = row.more.iter();
    more.find(|(key, _)| *key == "false_accept")
        .and_then(|(_, value)| *value)
}

/// What the rule predicts of one parameter, parts per million; beside it, without a guard band.
fn predicted(parameter: Parameter, limits: &RangeInclusive<f64>, lots: &[Lot]) -> Figure {
    let readings = readings(parameter, lots);
    let chance = chance(&readings);
    let with = |guard: f64| chance.and_then(|it| it.of(limits, guard));
    let ppm = |chance: Option<f64>| chance.map(|it| it * PPM);
    Figure::new(
        parameter.name(),
        readings.len() as u64,
        ppm(with(1.0).map(|it| it.1)),
        "ppm",
    )
    .with("false_accept", ppm(with(1.0).map(|it| it.0)))
    .with("unguarded_reject", ppm(with(0.0).map(|it| it.1)))
    .with("unguarded_accept", ppm(with(0.0).map(|it| it.0)))
}

fn readings(parameter: Parameter, lots: &[Lot]) -> Vec<Reading> {
    lots.iter()
        .flat_map(Lot::good)
        .filter_map(|part| part.reading(parameter))
        .collect()
}

/// Process and measurement behind the rows: the values are normal, less the variance of measurement; U is that
/// of most parts, and that of those whose U is clearly smaller is the one of slow repetitions.
fn chance(readings: &[Reading]) -> Option<Chance> {
    let values = Spread::of(&readings.iter().map(|it| it.value).collect::<Vec<f64>>());
    let stated: Vec<f64> = readings.iter().filter_map(|it| it.uncertainty).collect();
    let u = median(&stated)? / 2.0;
    let again: Vec<f64> = stated
        .iter()
        .map(|expanded| expanded / 2.0)
        .filter(|it| *it < AGAIN * u)
        .collect();
    let sd = values.sd()?;
    Some(Chance {
        mean: values.mean()?,
        sd: (sd * sd - u * u).max(sd * sd * 0.01).sqrt(),
        u,
        again: median(&again),
    })
}

/// The same rig with a lot whose operate voltage stands one standard deviation inside its limit.
fn at_limit(order: &Order, lots: &[Lot]) -> anyhow::Result<Vec<Figure>> {
    let known = |(parameter, _): &&(Parameter, _)| *parameter == Parameter::OperateVoltage;
    let limits = order.admitted.iter().find(known).map(|(_, limits)| limits);
    let usual = chance(&readings(Parameter::OperateVoltage, lots));
    let (Some(limits), Some(usual)) = (limits.filter(|it| it.end().is_finite()), usual) else {
        return Ok(Vec::new());
    };
    let mean = limits.end() - usual.sd;
    let recipe = load_recipe(&order.config, &order.recipe)?;
    let nominal_v = recipe
        .device
        .part()
        .nominal_v
        .context("the study needs a recipe of a relay")?;
    let of_lot = LOT_V / nominal_v;
    let variant = Variant {
        exact: false,
        world: vec![("lot.operate_v_mean", (mean * of_lot).into())],
        ..Variant::exact(BAUDS[0], vec![("test.expected_operate_v", mean.into())])
    };
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

fn is_again(reading: &Reading, chance: Option<Chance>) -> bool {
    let (u, usual) = (reading.uncertainty, chance.map(|it| 2.0 * it.u));
    u.zip(usual).is_some_and(|(u, usual)| u < AGAIN * usual)
}

/// What happened, over good and bad parts alike, beside what was to be expected of so many.
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
            !part.deserves_to_pass() && bins::has_passed(part)
        }),
        row("false rejects", reject, |part| {
            part.deserves_to_pass() && part.verdict == "fail"
        }),
    ]
}
