//! The controllers that the study compares, by name.

use chamber::control::increment::{Increment, Rules};
use chamber::control::pid::Pid;
use chamber::control::scheduled::{FuzzyPid, Symmetry};
use chamber::control::split_range::SplitRange;
use chamber::control::{Controller, Law};
use chamber::tune::{Identified, Settings};

/// Name of the default controller, to which the bars apply.
pub const DEFAULT: &str = "PID tc=th + FF";

/// A feedback law with its settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// PID with this closed-loop time constant, in delays of the chamber.
    Pid(u8),
    Furnace,
    MacVicarWhelan,
    FuzzyPid(Symmetry),
}

/// One row of the comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Contender {
    /// Name in reports.
    pub name: &'static str,
    kind: Kind,
    /// True for a controller with feed-forward.
    pub forward: bool,
}

const fn of(name: &'static str, kind: Kind, forward: bool) -> Contender {
    Contender {
        name,
        kind,
        forward,
    }
}

/// All rows.
pub const CONTENDERS: [Contender; 9] = [
    of("PID tc=2th", Kind::Pid(2), false),
    of("PID tc=th", Kind::Pid(1), false),
    of("fuzzy furnace", Kind::Furnace, false),
    of("fuzzy MacVicar-Whelan", Kind::MacVicarWhelan, false),
    of("fuzzy-PID book", Kind::FuzzyPid(Symmetry::Book), false),
    of("fuzzy-PID even", Kind::FuzzyPid(Symmetry::Even), false),
    of(DEFAULT, Kind::Pid(1), true),
    of("fuzzy furnace + FF", Kind::Furnace, true),
    of("fuzzy-PID even + FF", Kind::FuzzyPid(Symmetry::Even), true),
];

impl Contender {
    /// Returns the row with this name. Panics for an unknown name.
    pub fn named(name: &str) -> Self {
        let found = CONTENDERS.into_iter().find(|it| it.name == name);
        found.expect("a name of the table")
    }

    /// Returns true for a law whose settings follow from the identification alone. The scales of fuzzy tables fit only
    /// an air chamber.
    pub fn fits_any_chamber(self) -> bool {
        match self.kind {
            Kind::Pid(_) | Kind::FuzzyPid(_) => true,
            Kind::Furnace | Kind::MacVicarWhelan => false,
        }
    }

    /// Makes the controller for an identified chamber.
    pub fn controller(self, chamber: &Identified) -> Controller {
        let tight = Settings::simc(&chamber.first_order, 1.0);
        let law = match self.kind {
            Kind::Pid(calm) => Law::Pid(Pid::new(Settings::simc(
                &chamber.first_order,
                f64::from(calm),
            ))),
            Kind::Furnace => Law::Fuzzy(Increment::new(Rules::FURNACE)),
            Kind::MacVicarWhelan => Law::Fuzzy(Increment::new(Rules::MACVICAR_WHELAN)),
            Kind::FuzzyPid(symmetry) => Law::FuzzyPid(FuzzyPid::new(tight, symmetry)),
        };
        let plain = Controller::new(law, SplitRange::of(chamber));
        if self.forward {
            plain.with_feed_forward(chamber)
        } else {
            plain
        }
    }
}
