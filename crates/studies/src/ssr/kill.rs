//! Kills the controller at instants spread over the tests of AC parts, in virtual time, each time on a new rig.
//!
//! The module with the contactors must open them by its host watchdog, which needs neither controller nor instrument.
//! The journal of the rig tells when the main contacts have opened.

use crate::dice::Dice;
use crate::figure::{Bar, Figure};
use crate::pool;
use crate::storm::life::{End, Runner};
use crate::storm::scenario::Life;
use anyhow::{Context, ensure};
use config::{Folder, Plant, load_recipe};
use machine::dut::Recipe;
use rigsim::Options;
use rigsim::journal::Entry;
use rigsim::truth::ContactMove;
use std::collections::BTreeSet;
use std::sync::Arc;
use tempfile::TempDir;

/// Recipe of the lots: its test uses the line (mains) and the loop (load current), each with a contactor.
const RECIPE: &str = "ssr-ac-240v-5a-zc";
/// Parts of each lot. The rig measures the references of the fixture before it tests the first part, and not again
/// before the second.
const PARTS: u64 = 2;
/// The study also kills within this time before the first contact closes and after the last one opens, microseconds.
const MARGIN_US: u64 = 50_000;
/// Longest time from the end of the current in a contactor's coil to open main contacts, microseconds.
const RELEASE_US: u64 = 10_000;
/// A contactor still closed at this time after the watchdog has expired counts as closed for good, microseconds.
const AFTER_US: u64 = 500_000;

/// Result of the kills.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Kills {
    /// For each kill that found a main contact closed: time until all were open, microseconds.
    pub open_us: Vec<u64>,
    /// Kills after which main contacts stayed closed.
    pub closed: u64,
    /// Lives that ended before their kill.
    pub ended: u64,
    /// Longest admissible time from a kill to open contacts, microseconds.
    pub limit_us: u64,
}

/// One life and the moves of the main contacts in it and after it.
struct Course {
    end: End,
    /// Rig time of the end of the life, microseconds.
    ended_us: u64,
    moves: Vec<ContactMove>,
}

impl Course {
    /// Returns the contactors that are closed at an instant.
    fn closed_at(&self, at_us: u64) -> BTreeSet<&'static str> {
        let mut closed = BTreeSet::new();
        for it in self.moves.iter().filter(|it| it.t_us <= at_us) {
            match it.closed {
                true => closed.insert(it.contactor),
                false => closed.remove(it.contactor),
            };
        }
        closed
    }

    /// Returns the moves after the end of the life.
    fn behind(&self) -> impl Iterator<Item = &ContactMove> {
        self.moves.iter().filter(|it| it.t_us > self.ended_us)
    }
}

/// The rig that comes with the program.
struct Bench {
    folder: Folder,
    plant: Plant,
    recipe: Arc<Recipe>,
    place: TempDir,
}

impl Bench {
    fn new() -> anyhow::Result<Self> {
        let folder = Folder::built_in_rig("ssr").context("a rig that comes with the program")?;
        Ok(Self {
            plant: Plant::load(&folder)?,
            recipe: Arc::new(load_recipe(&folder, RECIPE)?),
            place: TempDir::new()?,
            folder,
        })
    }

    fn watchdog_us(&self) -> u64 {
        (self.plant.wiring.bus.host_watchdog_ms * 1e3) as u64
    }

    /// Runs one life on a new rig, until its kill if it has one; then lets the rig go on until its watchdogs have
    /// expired.
    fn live(&self, name: &str, killed_after_us: Option<u64>) -> anyhow::Result<Course> {
        let rig = rigsim::build(&Options {
            files: app::simulated::files(&self.folder),
            world: None,
            seed: 1,
            recipe: RECIPE.into(),
            parts: None,
            reference_parts: false,
            faults: Vec::new(),
        })?;
        let journal = rig.journal();
        let runner = Runner {
            plant: &self.plant,
            recipe: &self.recipe,
            db: &self.place.path().join(format!("{name}.db")),
            rig: &rig,
        };
        let life = Life {
            killed_after_us,
            ..Life::calm(PARTS, 0)
        };
        let life = runner.run_life(name, &life, None, Dice::new(0))?;
        rig.advance(rig.now_us() + self.watchdog_us() + AFTER_US);
        let moves = journal.try_iter().filter_map(|entry| {
            if let Entry::Contact(it) = entry {
                Some(it)
            } else {
                None
            }
        });
        Ok(Course {
            end: life.end,
            ended_us: life.ended_us,
            moves: moves.collect(),
        })
    }
}

/// Kills `count` lives at equal distances over the time in which a contactor is closed.
///
/// # Errors
/// Fails when the configuration does not load, a runtime cannot be built, or no contactor closes in a life without
/// kill.
pub fn kills(count: u64) -> anyhow::Result<Kills> {
    let bench = Bench::new()?;
    let calm = bench.live("calm", None)?;
    let ends = calm.moves.first().zip(calm.moves.last());
    let (first, last) = ends.context("a lot that closes no contactor")?;
    ensure!(
        calm.closed_at(u64::MAX).is_empty(),
        "a lot leaves a contactor closed"
    );
    let from_us = first.t_us.saturating_sub(MARGIN_US);
    let length_us = last.t_us + MARGIN_US - from_us;
    let instants: Vec<u64> = (0..count)
        .map(|it| from_us + length_us * it / count)
        .collect();
    let courses = pool::map(&instants, pool::cores(), |after_us| {
        bench.live(&after_us.to_string(), Some(*after_us))
    })?;
    let mut found = Kills {
        limit_us: bench.watchdog_us() + RELEASE_US,
        ..Kills::default()
    };
    for course in courses {
        found.ended += u64::from(course.end != End::Killed);
        found.closed += u64::from(!course.closed_at(u64::MAX).is_empty());
        let was_closed = !course.closed_at(course.ended_us).is_empty();
        if was_closed || course.behind().count() > 0 {
            let last_us = course.behind().map(|it| it.t_us).max();
            found.open_us.extend(last_us.map(|it| it - course.ended_us));
        }
    }
    Ok(found)
}

/// Returns the figures of `count` kills.
///
/// # Errors
/// Fails as [`kills`] does.
pub fn figures(count: u64) -> anyhow::Result<Vec<Figure>> {
    let found = kills(count)?;
    let worst_ms = found.open_us.iter().max().map(|us| *us as f64 / 1e3);
    let closed = found.open_us.len() as u64;
    Ok(vec![
        Figure::new(
            "kills with a closed contactor, until it is open",
            closed,
            worst_ms,
            "ms",
        )
        .bar(Bar::AtMost(found.limit_us as f64 / 1e3)),
        Figure::none(
            "kills after which a contactor stayed closed",
            count,
            found.closed,
        ),
        Figure::none("lives that ended before their kill", count, found.ended),
    ])
}
