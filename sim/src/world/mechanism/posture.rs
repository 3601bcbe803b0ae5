//! Where the actuators stand and parts lie, for the bodies; and the look back over the way that they have moved.

use std::collections::BTreeSet;

use super::{Mechanism, Stroke};
use crate::world::bodies::Bodies;
use crate::world::posture::Posture;

/// The bodies, and up to when they were looked at.
#[derive(Debug, Clone)]
pub(super) struct Lookout {
    bodies: Bodies,
    /// The last look, microseconds, and where everything stood.
    last: Option<(u64, Posture)>,
    touching: BTreeSet<(usize, usize)>,
    /// The part of the pocket is still before the pusher that takes it back there.
    pub pulled_back: bool,
    /// Rising fingers leave their part in the nest, by a fault.
    pub slides_off: bool,
}

impl Lookout {
    /// Nobody has looked yet.
    pub fn over(bodies: Bodies) -> Self {
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
    /// Looks at everything that moved since the last look. Whoever changes a course or a place looks first.
    pub(super) fn watch(&mut self, now_us: u64) {
        let now = self.posture(now_us);
        let Some((from_us, before)) = self.lookout.last.replace((now_us, now)) else {
            return;
        };
        // Places have not changed since then, or somebody would have looked.
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
        for (n, stroke) in Stroke::ALL.into_iter().enumerate() {
            mm[n] = self.at(stroke).position(t_us) * self.lookout.bodies.stroke_mm(n);
        }
        mm[Stroke::ALL.len()] = self.axis.x_mm(t_us);
        let places = &self.places;
        // Jaws hold more than fingers: what both hold stays in the nest.
        let jaws_open = [Stroke::JawLeft, Stroke::JawRight].map(|jaw| self.at(jaw).at_rest(t_us));
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
