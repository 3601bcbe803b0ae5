//! The armature's way from phase to phase, and the contacts it moves.

use super::{Change, Contact, Phase, Relay};
use crate::world::defect::Defect;
use crate::world::mode::{Lagged, crossing};

impl Relay {
    pub(super) fn arrived(&self, t_us: f64) -> Lagged {
        self.stretch.at((t_us - self.since_us) / 1000.0)
    }

    pub(super) fn mode_at(&self, t_us: f64) -> f64 {
        match self.phase {
            Phase::Growing | Phase::Leaving => {
                self.stretch
                    .mode((t_us - self.since_us) / 1000.0, self.z0, self.threshold_v)
            }
            Phase::Rest | Phase::Seated | Phase::Flying { .. } | Phase::Falling { .. } => 0.0,
        }
    }

    /// Instant of the next turn of the armature not after `until_us`.
    pub(super) fn next_turn(&self, until_us: f64) -> Option<f64> {
        let [from, to] = [self.checked_us, until_us].map(|t| (t - self.since_us) / 1000.0);
        let at = |dt: f64| Some(self.since_us + dt * 1000.0);
        let mode = |dt: f64| self.stretch.mode(dt, self.z0, self.threshold_v);
        match self.phase {
            Phase::Rest | Phase::Seated if self.is_stuck() => None,
            Phase::Rest | Phase::Seated => {
                let excess = |dt: f64| self.stretch.excess(dt, self.threshold_v);
                (excess(to) > 0.0)
                    .then(|| crossing(from, to, excess))
                    .and_then(at)
            }
            Phase::Growing | Phase::Leaving => match mode(to) {
                z if z >= 1.0 => at(crossing(from, to, |dt| mode(dt) - 1.0)),
                z if z < -1e-9 => at(crossing(from, to, |dt| -mode(dt) - 1e-9)),
                _ => None,
            },
            Phase::Flying { until_us: end } | Phase::Falling { until_us: end } => {
                (end <= until_us).then_some(end)
            }
        }
    }

    pub(super) fn is_stuck(&self) -> bool {
        matches!(
            self.specimen.defect,
            Some(Defect::StuckNo | Defect::StuckNc)
        )
    }

    /// The armature passes from one phase to the next.
    pub(super) fn turn(&mut self, at_us: f64) -> Option<Change> {
        let (state, complete) = (self.arrived(at_us), self.mode_at(at_us) > 0.5);
        self.settle(at_us);
        let (phase, change) = match self.phase {
            Phase::Rest => (Phase::Growing, self.part(Contact::Nc, at_us)),
            Phase::Growing if complete => (
                Phase::Flying {
                    until_us: at_us + self.flight_us[0],
                },
                None,
            ),
            Phase::Growing => (
                Phase::Rest,
                self.set(Change {
                    t_us: at_us,
                    contact: Contact::Nc,
                    closed: true,
                }),
            ),
            Phase::Flying { .. } => (Phase::Seated, self.make(Contact::No, at_us)),
            Phase::Seated => (Phase::Leaving, None),
            Phase::Leaving if complete => (
                Phase::Falling {
                    until_us: at_us + self.flight_us[1],
                },
                self.part(Contact::No, at_us),
            ),
            Phase::Leaving => (Phase::Seated, None),
            Phase::Falling { .. } => (Phase::Rest, self.make(Contact::Nc, at_us)),
        };
        self.phase = phase;
        self.restart(at_us, state, 0.0);
        change
    }

    /// A contact opens for good; its bounce ends.
    pub(super) fn part(&mut self, contact: Contact, t_us: f64) -> Option<Change> {
        self.bounce.clear();
        self.record.part(contact);
        self.set(Change {
            t_us,
            contact,
            closed: false,
        })
    }

    /// First make after a flight: a new closure, a new operation, a new bounce.
    pub(super) fn make(&mut self, contact: Contact, t_us: f64) -> Option<Change> {
        self.operation_v = self.draw.normal(0.0, self.scatter_v);
        let (film, pattern) = match contact {
            Contact::No => (self.specimen.film_no, &self.specimen.bounce_no_us),
            Contact::Nc => (self.specimen.film_nc, &self.specimen.bounce_nc_us),
        };
        self.record.close(contact, film.close(&mut self.draw));
        self.record.make(contact, t_us);
        let mut at = t_us;
        for (i, &us) in pattern.iter().enumerate() {
            at += self.draw.lognormal(us, self.bounce_ln_sd);
            self.bounce.push_back(Change {
                t_us: at,
                contact,
                closed: i % 2 == 1,
            });
        }
        self.set(Change {
            t_us,
            contact,
            closed: true,
        })
    }

    pub(super) fn set(&mut self, change: Change) -> Option<Change> {
        let closed = &mut self.closed[change.contact as usize];
        let news = *closed != change.closed;
        *closed = change.closed;
        news.then_some(change)
    }
}
