//! Postures of the mechanism for crash detection, and the check of the motion between two postures.

use std::collections::BTreeSet;

use super::{CylinderId, Mechanism};
use crate::world::bodies::Bodies;
use crate::world::posture::Posture;

/// Crash detection of the mechanism: the bodies, and the instant up to which it has checked them.
#[derive(Debug, Clone)]
pub(super) struct CrashWatch {
    bodies: Bodies,
    /// Last check: instant (microseconds) and posture.
    last: Option<(u64, Posture)>,
    touching: BTreeSet<(usize, usize)>,
    /// True while the part that counts as in the pocket still lies in front of the returning pusher.
    pub pulled_back: bool,
    /// True when a fault makes the rising fingers leave their part in the nest.
    pub slides_off: bool,
}

impl CrashWatch {
    /// Creates the crash detection before its first check.
    pub fn new(bodies: Bodies) -> Self {
        Self {
            bodies,
            last: None,
            touching: BTreeSet::new(),
            pulled_back: false,
            slides_off: false,
        }
    }
}

impl Mechanism {
    /// Checks all motion since the last check. Code that changes a stroke or a place must call this first.
    pub(super) fn watch(&mut self, now_us: u64) {
        let now = self.posture(now_us);
        let Some((from_us, before)) = self.lookout.last.replace((now_us, now)) else {
            return;
        };
        // The places have not changed since the last check, because a check precedes every change.
        let from = Posture {
            mm: before.mm,
            ..now
        };
        if from.mm == now.mm {
            return;
        }
        let span = (now_us - from_us) as f64;
        let mut touching = std::mem::take(&mut self.lookout.touching);
        let between = |share: f64| self.posture(from_us + (span * share) as u64);
        let found = self
            .lookout
            .bodies
            .watch(&from, &now, between, &mut touching);
        self.lookout.touching = touching;
        for what in found {
            self.crash(now_us, &what);
        }
    }

    fn posture(&self, t_us: u64) -> Posture {
        let mut mm = [0.0; 8];
        for (n, stroke) in CylinderId::ALL.into_iter().enumerate() {
            mm[n] = self.at(stroke).position(t_us) * self.lookout.bodies.stroke_mm(n);
        }
        mm[CylinderId::ALL.len()] = self.axis.x_mm(t_us);
        let places = &self.places;
        // The jaws grip harder than the fingers: a part in both grips stays in the nest.
        let jaws_open =
            [CylinderId::JawLeft, CylinderId::JawRight].map(|jaw| self.at(jaw).at_rest(t_us));
        let lifted = places.gripped && jaws_open == [true, true];
        Posture {
            mm,
            pocket: places.pocket.is_some() && !self.lookout.pulled_back,
            pushed: places.pushed.is_some() || self.lookout.pulled_back,
            nest: places.nest.is_some() && !lifted,
            held: places.carried.is_some() || lifted,
            slack: self.only_springs_move() || self.lookout.slides_off,
        }
    }
}
