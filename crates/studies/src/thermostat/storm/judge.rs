//! The rules of the storm. Each holds whatever faults have struck.

use super::super::heat::{CONTACTOR, heated};
use super::scenario::{Demand, Strike};
use super::{Case, SECOND_US};
use crate::storm::life::{EPOCH_US, End, EndedLife};
use app::exit::Exit;
use history::Part;
use rigsim::journal::Entry;
use std::ops::Range;

/// Time within which the heater must be off after a fault that an input or a reading shows, microseconds.
const OFF_US: u64 = 2 * SECOND_US;
/// Bits of the fan, and of the release of the lock, at the module of the contactor.
const FAN: u16 = 1 << 1;
const LOCK_RELEASE: u16 = 1 << 2;
/// Longest time for which the simulated door or emergency stop stays disturbed, microseconds.
const DISTURBED_US: u64 = 30 * SECOND_US;
/// Temperature by which a rack that was cool may warm before it counts as hot, and error of its thermometer, K.
const COOL_K: f64 = 1.2;

/// A rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// A life ends by itself, with an exit.
    Ends,
    /// A fault switches the heater off in time.
    HeaterOff,
    /// No part that a fault has met while it was heated gets a verdict.
    Void,
    /// No good part fails by more than its uncertainty.
    Good,
    /// Every part has one row, or the batch has none.
    Rows,
    /// No module writes its EEPROM in the first life.
    Eeprom,
    /// Lock and contactor keep still while the rack is hot.
    Hot,
    /// After a life outputs are safe in the time of the watchdog.
    Safe,
    /// The next start cools a hot rack.
    Cools,
}

impl Rule {
    /// Every rule.
    pub const ALL: [Self; 9] = [
        Self::Ends,
        Self::HeaterOff,
        Self::Void,
        Self::Good,
        Self::Rows,
        Self::Eeprom,
        Self::Hot,
        Self::Safe,
        Self::Cools,
    ];

    /// Returns the text in reports, of what breaks the rule.
    pub fn text(self) -> &'static str {
        match self {
            Self::Ends => "lives that failed or hung",
            Self::HeaterOff => "faults after which the heater stayed on",
            Self::Void => "parts judged after a fault that ends a batch",
            Self::Good => "good parts failed beyond U",
            Self::Rows => "lots with missing or double rows",
            Self::Eeprom => "lots with an EEPROM write",
            Self::Hot => "locks released or contactors closed at a hot rack",
            Self::Safe => "lives after which outputs were not safe in the time of the watchdog",
            Self::Cools => "starts that did not cool a hot rack",
        }
    }
}

impl Case {
    /// Returns the broken rules, each with what was found.
    pub fn broken(&self) -> Vec<(Rule, String)> {
        let all = [
            (Rule::Ends, self.not_ended()),
            (Rule::HeaterOff, self.heats_on()),
            (Rule::Void, self.judged_in_trouble()),
            (Rule::Good, self.wrongly_failed()),
            (Rule::Rows, self.wrong_rows()),
            (Rule::Eeprom, self.eeprom()),
            (Rule::Hot, self.moved_hot()),
            (Rule::Safe, self.unsafe_after()),
            (Rule::Cools, self.not_cooled()),
        ];
        let each = all.into_iter();
        each.filter_map(|(rule, what)| Some((rule, what?)))
            .collect()
    }

    fn not_ended(&self) -> Option<String> {
        let [first, _] = &self.lives;
        let is_killed = self.scenario.killed_after_s.is_some();
        match &first.end {
            End::Killed if is_killed => None,
            End::Exit(_) => None,
            End::Killed | End::Failed(_) | End::Hung => Some(format!("{:?}", first.end)),
        }
    }

    /// Yields the faults of the chamber that demand something, with the life in which each struck.
    fn demands(&self) -> impl Iterator<Item = (&Strike, &EndedLife)> {
        let strikes = self.scenario.strikes.iter();
        strikes.filter_map(move |strike| {
            let at_us = strike.at_s * SECOND_US;
            let mut lives = self.lives.iter();
            let life = lives.find(|it| (it.began_us..it.ended_us).contains(&at_us))?;
            (strike.demand != Demand::Nothing).then_some((strike, life))
        })
    }

    /// Returns the time in which a fault must switch the heater off, microseconds: longer while a fault of the line may
    /// leave that to the watchdog.
    fn off_us(&self) -> u64 {
        let by_watchdog = if self.scenario.of_line.is_empty() {
            0
        } else {
            self.watchdog_us
        };
        OFF_US + by_watchdog
    }

    fn heats_on(&self) -> Option<String> {
        let heated = heated(&self.journal);
        self.demands().find_map(|(strike, life)| {
            let at_us = strike.at_s * SECOND_US;
            let until_us = match strike.demand {
                Demand::OffForGood => u64::MAX,
                Demand::OffForThisLife | Demand::Nothing => life.ended_us + self.watchdog_us,
            };
            let was_on = heated.iter().any(|it| it.contains(&at_us));
            let counts = was_on || strike.demand == Demand::OffForGood;
            let late = heated
                .iter()
                .find(|it| it.start < until_us && it.end > at_us + self.off_us())?;
            counts.then(|| {
                let Range { start, end } = late;
                format!(
                    "{} at {} s, heater on from {start} to {end} us",
                    strike.name, strike.at_s
                )
            })
        })
    }

    fn judged_in_trouble(&self) -> Option<String> {
        let heated = heated(&self.journal);
        let [first, _] = &self.lives;
        self.demands().find_map(|(strike, life)| {
            let at_us = strike.at_s * SECOND_US;
            let counts = life.lot == first.lot && heated.iter().any(|it| it.contains(&at_us));
            let after = |it: &&Part| it.time.0 > EPOCH_US + at_us as i64;
            let mut judged = self.rows.iter().filter(after);
            let part = judged.find(|it| it.verdict != "void")?;
            counts.then(|| format!("{} at {} s, part {}", strike.name, strike.at_s, part.seq))
        })
    }

    fn wrongly_failed(&self) -> Option<String> {
        let is_good = |part: &&Part| {
            let truth = self.truth.iter().find(|it| it["seq"] == part.seq);
            truth.is_some_and(|it| it["defect"].is_null())
        };
        let near = |it: &String| it.ends_with("not proven");
        let beyond = |part: &&Part| part.verdict == "fail" && !part.reasons.iter().all(near);
        let part = self.rows.iter().filter(is_good).find(beyond)?;
        Some(format!("part {}: {:?}", part.seq, part.reasons))
    }

    /// A life that ended by itself has all rows, or none when trouble came before the parts got their numbers; one that
    /// is done has all.
    fn wrong_rows(&self) -> Option<String> {
        let mut found: Vec<u64> = self.rows.iter().map(|it| it.seq).collect();
        found.sort_unstable();
        let is_whole = found.iter().copied().eq(1..=self.scenario.parts);
        let [first, _] = &self.lives;
        let right = match &first.end {
            End::Exit(Exit::Done) => is_whole,
            End::Exit(_) => is_whole || found.is_empty(),
            End::Killed | End::Failed(_) | End::Hung => found.windows(2).all(|it| it[0] < it[1]),
        };
        (!right).then(|| format!("rows {found:?}, {:?}", first.end))
    }

    fn eeprom(&self) -> Option<String> {
        let writes = self.eeprom_writes;
        (writes > 0).then(|| format!("{writes} writes"))
    }

    fn moved_hot(&self) -> Option<String> {
        let moves = self.journal.iter().filter_map(|it| match it {
            Entry::Chamber(moved) => Some(moved),
            Entry::Level { .. }
            | Entry::Output { .. }
            | Entry::Struck { .. }
            | Entry::Expired { .. }
            | Entry::Late { .. }
            | Entry::CoilOverdriven(_)
            | Entry::Contact(_) => None,
        });
        let mut hot = moves.filter(|it| it.rack_c >= self.unlock_below_c + COOL_K);
        hot.next().map(|it| format!("{it:?}"))
    }

    /// Returns the states of the module of the contactor with their times, microseconds.
    fn states(&self) -> impl Iterator<Item = (u64, u16)> {
        self.journal.iter().filter_map(|it| match it {
            Entry::Output { t_us, module, bits } if module == CONTACTOR.0 => Some((*t_us, *bits)),
            Entry::Level { .. }
            | Entry::Output { .. }
            | Entry::Struck { .. }
            | Entry::Expired { .. }
            | Entry::Late { .. }
            | Entry::CoilOverdriven(_)
            | Entry::Contact(_)
            | Entry::Chamber(_) => None,
        })
    }

    fn unsafe_after(&self) -> Option<String> {
        let [first, _] = &self.lives;
        let until_us = first.ended_us + self.watchdog_us;
        let last = self.states().filter(|(t_us, _)| *t_us <= until_us).last();
        let (_, bits) = last?;
        let is_safe = bits & (CONTACTOR.1 | LOCK_RELEASE) == 0;
        // A program that ends by itself leaves the door of a cool rack as it is.
        let is_killed = first.end == End::Killed;
        let heats = bits & CONTACTOR.1 != 0;
        (heats || is_killed && !is_safe).then(|| format!("outputs {bits:06b}, {:?}", first.end))
    }

    /// Checks the second start. Faults of the line may keep it from its work, as the door and the emergency stop do.
    fn not_cooled(&self) -> Option<String> {
        let [_, second] = &self.lives;
        let Range { start, end } = second.began_us..second.ended_us;
        let disturbs = |it: &Strike| {
            let at_us = it.at_s * SECOND_US;
            let lasts = matches!(it.name, "door" | "estop") && at_us + DISTURBED_US > start;
            lasts && at_us < end
        };
        let is_disturbed =
            !self.scenario.of_line.is_empty() || self.scenario.strikes.iter().any(disturbs);
        let is_hot = |it: &Option<f64>| it.is_some_and(|it| it >= self.unlock_below_c);
        let is_hot = self.rack_c.iter().all(is_hot);
        let mut states = self
            .states()
            .filter(|(t_us, _)| (start..=end).contains(t_us));
        let cools = states.any(|(_, bits)| bits & FAN != 0);
        (is_hot && !is_disturbed && !cools).then(|| "the fan stayed off".to_owned())
    }
}
