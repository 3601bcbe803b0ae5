//! The report: results of all moves as figures and plots.

use super::score::Outcome;
use super::small_world::SmallWorldCounts;
use super::world::{KINDS, TestMove};
use super::{OURS, ROUNDING_MM};
use crate::chart::Chart;
use crate::figure::{Bar, Figure, mean};
use crate::scatter::{Point, Scatter};
use quality::spread::median;
use quality::{Ordered, Spread};

/// Lowest value of the error axis, mm: the plot shows smaller errors there.
const LEAST_MM: f64 = 1e-10;

/// A method with its results.
pub(super) struct Scored {
    pub(super) name: String,
    pub(super) outcomes: Vec<Outcome>,
}

impl Scored {
    fn times(&self, share: f64) -> Option<f64> {
        let times: Vec<f64> = self.outcomes.iter().map(|it| it.us).collect();
        Ordered::of(&times).quantile(share)
    }

    fn mean_us(&self) -> Option<f64> {
        mean(self.outcomes.iter().map(|it| it.us))
    }

    fn count(&self, is: impl Fn(&Outcome) -> bool) -> u64 {
        self.outcomes.iter().filter(|it| is(it)).count() as u64
    }

    fn missed(&self) -> u64 {
        self.count(|it| it.missed)
    }

    fn false_blocks(&self) -> u64 {
        self.count(|it| it.false_block)
    }

    fn wrong(&self) -> u64 {
        self.missed() + self.false_blocks()
    }

    fn moves(&self) -> u64 {
        self.outcomes.len() as u64
    }

    fn late_mm(&self) -> impl Iterator<Item = f64> + '_ {
        self.outcomes.iter().filter_map(|it| it.late_mm)
    }

    /// Returns the 99 % quantile of the absolute error over all contacts, mm.
    fn error_mm(&self) -> Option<f64> {
        let errors: Vec<f64> = self.late_mm().map(f64::abs).collect();
        Ordered::of(&errors).quantile(0.99)
    }

    fn latest_mm(&self) -> f64 {
        self.late_mm().fold(0.0, f64::max)
    }

    fn earliest_mm(&self) -> f64 {
        -self.late_mm().fold(0.0, f64::min)
    }
}

fn ours(scored: &[Scored]) -> Option<&Scored> {
    scored.iter().find(|it| it.name == OURS)
}

/// Returns, for each method, the wall time of one move and its ratio to the time of [`OURS`], each as median, 99 %
/// quantile and mean.
pub(super) fn speeds(scored: &[Scored]) -> Vec<Figure> {
    let row = |it: &Scored| {
        let ratio = |of: &dyn Fn(&Scored) -> Option<f64>| Some(of(it)? / of(ours(scored)?)?);
        Figure::new(&it.name, it.moves(), it.times(0.5), "us")
            .with("p99_us", it.times(0.99))
            .with("mean_us", it.mean_us())
            .with("ratio_median", ratio(&|of| of.times(0.5)))
            .with("ratio_p99", ratio(&|of| of.times(0.99)))
            .with("ratio_mean", ratio(&Scored::mean_us))
    };
    scored.iter().map(row).collect()
}

pub(super) fn errors(scored: &[Scored]) -> Vec<Figure> {
    let row = |it: &Scored| {
        let um = |mm: f64| Some(1e3 * mm);
        // Only a contact deeper than one unit is more than a touch.
        let deep = it.count(|it| it.missed && it.deep);
        let name = format!("wrong verdicts: {}", it.name);
        Figure::count(name, it.moves(), Some(it.wrong()))
            .with("missed", Some(it.missed() as f64))
            .with("missed_over_1um", Some(deep as f64))
            .with("false_blocks", Some(it.false_blocks() as f64))
            .with("stop_error_p99_um", it.error_mm().and_then(um))
            .with("latest_um", um(it.latest_mm()))
            .with("earliest_um", um(it.earliest_mm()))
    };
    scored.iter().map(row).collect()
}

pub(super) fn missed_by_kind(scored: &[Scored]) -> Vec<Figure> {
    let row = |it: &Scored| {
        let name = format!("missed by kind: {}", it.name);
        let counted = Figure::count(name, it.moves(), Some(it.missed()));
        (0..KINDS.len()).fold(counted, |figure, kind| {
            let missed = it.count(|one| one.kind == kind && one.missed);
            figure.with(KINDS[kind], Some(missed as f64))
        })
    };
    scored.iter().map(row).collect()
}

/// Returns, for each kind of move, statistics of the number of bodies near a move: only these bodies need an exact
/// test.
pub(super) fn bodies_near(moves: &[TestMove]) -> Vec<Figure> {
    let row = |kind: usize| {
        let of_kind = moves.iter().filter(|it| it.kind == kind);
        let near: Vec<f64> = of_kind.map(|it| it.near as f64).collect();
        let (spread, name) = (
            Spread::of(&near),
            format!("bodies near a move: {}", KINDS[kind]),
        );
        Figure::new(name, spread.n(), spread.mean(), "")
            .with("median", median(&near))
            .with("most", spread.max())
    };
    (0..KINDS.len()).map(row).collect()
}

pub(super) fn bars(scored: &[Scored], small: &SmallWorldCounts) -> Vec<Figure> {
    let ours = ours(scored);
    let moves = ours.map_or(0, Scored::moves);
    let zero = |name: &str, n: u64, count: Option<u64>| {
        Figure::count(name, n, count).bar(Bar::AtMost(0.0))
    };
    let counted =
        |name: &str, count| zero(&format!("small world: {name}"), small.moves, Some(count));
    let latest = ours.map(Scored::latest_mm);
    vec![
        zero(
            "swept exact: missed contacts",
            moves,
            ours.map(Scored::missed),
        ),
        zero(
            "swept exact: false blocks",
            moves,
            ours.map(Scored::false_blocks),
        ),
        Figure::new("swept exact: latest stop", moves, latest, "mm").bar(Bar::AtMost(ROUNDING_MM)),
        counted("missed contacts", small.missed),
        counted("false blocks", small.false_blocks),
        counted("wrong times", small.wrong_times),
    ]
}

pub(super) fn notes() -> Vec<String> {
    vec![
        "Modelled: every body of the scene in its true shape; the mover as five rigid parts. Left out, because no \
         move needs it: bodies whose box the swept boxes of the mover do not meet (counted above: of 1,000 only \
         those are bodies_near), tilts, meshes, margins."
            .to_owned(),
        "paper: our own rebuilding of a method whose later chapters are not at hand; a cylinder is drawn with 32 \
         corners on its mantle. Its stop is the last clear pose."
            .to_owned(),
        "missed_over_1um: of the missed contacts those that remain when every part of the mover is thinner by 1/1024 mm."
            .to_owned(),
        "ratio: how many moves swept exact judges in the same time.".to_owned(),
    ]
}

pub(super) fn wrong_verdicts(scored: &[Scored]) -> Chart {
    let bar = |it: &Scored| (it.name.clone(), Some(it.wrong() as f64));
    let title = format!("Wrong verdicts of {} moves", moves(scored));
    Chart::new(title, "", Vec::new(), scored.iter().map(bar))
}

fn moves(scored: &[Scored]) -> u64 {
    scored.first().map_or(0, Scored::moves)
}

pub(super) fn speed_against_error(scored: &[Scored]) -> Scatter {
    let point = |it: &Scored| {
        let family = ["paper", "swept boxes", OURS, "parry"];
        Point {
            name: it.name.clone(),
            x: it.mean_us().unwrap_or(0.0),
            y: it.error_mm().unwrap_or(0.0),
            wrong: it.wrong(),
            series: family
                .iter()
                .position(|name| it.name.starts_with(name))
                .unwrap_or(family.len()),
        }
    };
    Scatter {
        title: format!(
            "Checking a move: time against error ({} moves among 1,000 bodies; hollow: wrong verdicts)",
            moves(scored)
        ),
        x_title: "mean time per move, us".to_owned(),
        y_title: "error of the stop (99 of 100), mm".to_owned(),
        points: scored.iter().map(point).collect(),
        is_joined: true,
        least: Some(LEAST_MM),
    }
}
