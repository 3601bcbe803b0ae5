//! Kills the controller of a batch at random instants, in virtual time, on one rig that keeps its heat from life to
//! life.
//!
//! After each kill the host watchdogs must make every output safe in time. The next start finds the chamber as it is:
//! while the rack is hot it must neither unlock the door nor close the contactor of the heater.

use crate::dice::Dice;
use crate::figure::Figure;
use crate::storm::life::{End, Runner};
use crate::storm::scenario::Life;
use anyhow::Context;
use config::{Folder, Plant, load_recipe};
use rigsim::journal::Entry;
use rigsim::{Options, SharedRig};
use std::sync::mpsc::Receiver;
use tempfile::TempDir;

const RECIPE: &str = "thermostat-ksd9700";
/// Module that drives contactor, fan and lock.
const MODULE: &str = "relay_do";
/// Bit of the heater's contactor.
const CONTACTOR: u16 = 1;
/// Bit of the fan.
const FAN: u16 = 1 << 1;
/// Bit that unlocks the door.
const LOCK_RELEASE: u16 = 1 << 2;
/// Number of modules with a host watchdog.
const WATCHED: usize = 3;
/// Request for the temperature of the rack, with its checksum.
const RACK: &[u8] = b"#212B8";
/// Full scale of the reply to [`RACK`], C.
const FULL_C: f64 = 200.0;
/// Earliest and latest kill after the start of a life, s: the range covers loading, identification and passes.
const INSTANTS_S: [u64; 2] = [400, 3000];
/// Time for which the study watches the next start, s: nothing may heat or unlock while the rack is hot.
const LOOK_S: u64 = 30;
const SECOND_US: u64 = 1_000_000;

/// Result of the kills.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Kills {
    /// Number of kills while the contactor of the heater was closed.
    pub heating: u64,
    /// Number of kills after which an output was not safe within the time of the watchdog.
    pub unsafe_after: u64,
    /// Number of starts on a hot rack.
    pub hot: u64,
    /// Number of starts on a hot rack that unlocked the door, closed the contactor or did not cool.
    pub wrong_starts: u64,
    /// Causes of the lives that ended by themselves.
    pub ended: Vec<String>,
}

/// Follows the outputs of the rig.
struct Watch {
    journal: Receiver<Entry>,
    bits: u16,
}

impl Watch {
    /// Takes the entries of the journal since the last call. Returns the states of the outputs, first the one before
    /// these entries, and the watchdogs that expired.
    fn entries(&mut self) -> (Vec<u16>, Vec<(u64, f64)>) {
        let (mut states, mut expired) = (vec![self.bits], Vec::new());
        while let Ok(entry) = self.journal.try_recv() {
            match entry {
                Entry::Output { module, bits, .. } if module == MODULE => {
                    states.push(bits);
                    self.bits = bits;
                }
                Entry::Expired {
                    t_us,
                    last_request_us,
                    carries,
                    ..
                } => expired.push((t_us - last_request_us, carries)),
                Entry::Output { .. }
                | Entry::Level { .. }
                | Entry::Struck { .. }
                | Entry::Late { .. }
                | Entry::CoilOverdriven(_)
                | Entry::Contact(_)
                | Entry::Chamber(_) => {}
            }
        }
        (states, expired)
    }
}

/// Returns the temperature of the rack as its module reports it, C.
///
/// # Errors
/// Fails without a reply, or when it holds no reading.
pub fn rack_c(rig: &SharedRig) -> anyhow::Result<f64> {
    let reply = rig.exchange(0, RACK, rig.now_us());
    let reply = reply.context("no reply of the thermometer in the rack")?;
    let text = String::from_utf8_lossy(&reply.bytes).into_owned();
    let hex = text.get(1..5).context("a reply without a reading")?;
    let whole = i64::from_str_radix(hex, 16).with_context(|| format!("reading {text:?}"))?;
    Ok(whole as f64 / 32767.0 * FULL_C)
}

/// Kills the controller `count` times, and starts it again after each kill.
///
/// # Errors
/// Fails when the configuration does not load, or a runtime cannot be built.
pub fn kills(count: u64, seed: u64) -> anyhow::Result<Kills> {
    let folder = Folder::built_in_rig("thermostat").context("a rig that comes with the program")?;
    let (plant, recipe) = (Plant::load(&folder)?, load_recipe(&folder, RECIPE)?);
    let rig = rigsim::build(&Options {
        files: app::simulated::files(&folder),
        world: None,
        seed,
        recipe: RECIPE.into(),
        parts: None,
        reference_parts: false,
        faults: Vec::new(),
    })?;
    let limit_us = (plant.wiring.bus.host_watchdog_ms * 1e3) as u64;
    let hot_c = plant.wiring.rack().map_or(0.0, |it| it.unlock_below.0);
    let place = TempDir::new()?;
    let runner = Runner {
        plant: &plant,
        recipe: &std::sync::Arc::new(recipe),
        db: &place.path().join("history.db"),
        rig: &rig,
    };
    let (mut dice, mut found) = (Dice::new(seed), Kills::default());
    let mut watch = Watch {
        journal: rig.journal(),
        bits: 0,
    };
    for round in 0..count {
        let [from, to] = INSTANTS_S;
        let until_s = dice.between(from, to);
        let end = live(&runner, &format!("K{round}"), until_s)?;
        found.ended.extend(cause(&end));
        let (states, _) = watch.entries();
        let heats = states.last().is_some_and(|it| it & CONTACTOR != 0);
        found.heating += u64::from(heats);
        rig.advance(rig.now_us() + limit_us + SECOND_US);
        let (_, expired) = watch.entries();
        let in_time = |it: &&(u64, f64)| it.0 <= limit_us && it.1.abs() < 0.01;
        let safe = expired.iter().filter(in_time).count() >= WATCHED && watch.bits == 0;
        found.unsafe_after += u64::from(!safe);
        if rack_c(&rig)? < hot_c {
            continue;
        }
        found.hot += 1;
        live(&runner, &format!("H{round}"), LOOK_S)?;
        let (states, _) = watch.entries();
        let wrong = states.iter().any(|it| it & (CONTACTOR | LOCK_RELEASE) != 0);
        let cools = states.iter().any(|it| it & FAN != 0);
        found.wrong_starts += u64::from(rack_c(&rig)? >= hot_c && (wrong || !cools));
    }
    Ok(found)
}

fn live(runner: &Runner, lot: &str, seconds: u64) -> anyhow::Result<End> {
    let life = Life {
        killed_after_us: Some(seconds * SECOND_US),
        ..Life::calm(1_000_000, SECOND_US)
    };
    Ok(runner.run_life(lot, &life, None, Dice::new(0))?.end)
}

/// Returns why a life ended; `None` after a kill.
fn cause(end: &End) -> Option<String> {
    match end {
        End::Killed => None,
        End::Exit(exit) => Some(exit.cause().map_or("done".into(), |it| it.code.clone())),
        End::Failed(why) => Some(why.clone()),
        End::Hung => Some("hung".into()),
    }
}

/// Returns the figures of `count` kills.
///
/// # Errors
/// Fails as [`kills`] does.
pub fn figures(count: u64) -> anyhow::Result<Vec<Figure>> {
    let found = kills(count, 1)?;
    let heating = "kills while the heater was on, outputs not safe in the time of the watchdog";
    Ok(vec![
        Figure::none(heating, found.heating, found.unsafe_after),
        Figure::none(
            "starts on a hot rack that heated, unlocked or did not cool",
            found.hot,
            found.wrong_starts,
        ),
        Figure::none(
            "lives that ended before their kill",
            count,
            found.ended.len() as u64,
        ),
    ])
}
