//! What the motion of the armature means for the contacts.
//!
//! A first make is the first touch of a contact after the other one was closed: it is a new closure
//! with a resistance of its own, and its bounce list speaks for it until it has settled. Every other
//! touch and break is passed on as it is, the flutter of a failing pulse for one.

use super::lumped::{Event, Kind};
use super::{Relay, SETTLING_US};
use crate::world::probes::{Change, Contact};

impl Relay {
    /// A mode of the motion has changed.
    pub(super) fn touched(&mut self, event: &Event) -> Option<Change> {
        let contact = match event.kind {
            Kind::No => Contact::No,
            Kind::Nc => Contact::Nc,
            Kind::Backstop | Kind::Seat | Kind::CoilBlocked => return None,
        };
        let t_us = event.t_s * 1e6;
        if event.on && contact != self.side {
            return self.make(contact, t_us);
        }
        if contact == self.side && t_us < self.settled_us {
            return None;
        }
        match event.on {
            true => self.set(t_us, contact, true),
            false => self.part(contact, t_us),
        }
    }

    /// The next entry of the bounce list is due.
    pub(super) fn bounced(&mut self) -> Option<Change> {
        let change = self.bounce.pop_front()?;
        self.set(change.t_us, change.contact, change.closed)
    }

    /// Once a closure has settled, the contact is what the motion says.
    pub(super) fn synchronised(&mut self, t_us: f64) -> Option<Change> {
        if t_us < self.settled_us || !self.bounce.is_empty() {
            return None;
        }
        let closed = self.motion.touches(match self.side {
            Contact::No => Kind::No,
            Contact::Nc => Kind::Nc,
        });
        self.set(t_us, self.side, closed)
    }

    /// A contact opens for good; its bounce ends.
    fn part(&mut self, contact: Contact, t_us: f64) -> Option<Change> {
        self.bounce.clear();
        self.set(t_us, contact, false)
    }

    /// First make after a flight: a new closure, a new operation, a new bounce.
    fn make(&mut self, contact: Contact, t_us: f64) -> Option<Change> {
        self.side = contact;
        self.settled_us = t_us + SETTLING_US;
        self.bounce.clear();
        self.operation_v = self.draw.normal(0.0, self.scatter_v);
        let (film, pattern) = match contact {
            Contact::No => (self.drawn.film_no, &self.drawn.bounce_no_us),
            Contact::Nc => (self.drawn.film_nc, &self.drawn.bounce_nc_us),
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
        self.settled_us = self.settled_us.max(at);
        self.set(t_us, contact, true)
    }

    fn set(&mut self, t_us: f64, contact: Contact, closed: bool) -> Option<Change> {
        let now = &mut self.closed[contact as usize];
        let news = *now != closed;
        *now = closed;
        if news {
            self.record.moved(contact, t_us, closed);
        }
        news.then_some(Change {
            t_us,
            contact,
            closed,
        })
    }
}
