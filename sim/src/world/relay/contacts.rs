//! Contact events that follow from the motion of the armature.
//!
//! A first make is the first touch of a contact after the other one was closed. It starts a new closure with its own
//! resistance, and a bounce list determines the bounce until the contact settles. All other makes and breaks follow the
//! motion directly, for example the flutter after a pulse that is too short.

use super::lumped::{Element, Event};
use super::{Relay, SETTLING_US};
use crate::world::probes::{Change, Contact};

impl Relay {
    /// Handles a contact that the motion has touched or left.
    pub(super) fn touched(&mut self, event: &Event) -> Option<Change> {
        let contact = match event.element {
            Element::No => Contact::No,
            Element::Nc => Contact::Nc,
            Element::Backstop | Element::Seat | Element::CoilBlocked => return None,
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

    /// Applies the next entry of the bounce list, which is due.
    pub(super) fn bounced(&mut self) -> Option<Change> {
        let change = self.bounce.pop_front()?;
        self.set(change.t_us, change.contact, change.closed)
    }

    /// After the bounce list has ended, sets the contact to the state that the motion gives it.
    pub(super) fn synchronised(&mut self, t_us: f64) -> Option<Change> {
        if t_us < self.settled_us || !self.bounce.is_empty() {
            return None;
        }
        let closed = self.motion.touches(match self.side {
            Contact::No => Element::No,
            Contact::Nc => Element::Nc,
        });
        self.set(t_us, self.side, closed)
    }

    /// Opens a contact and ends its bounce.
    fn part(&mut self, contact: Contact, t_us: f64) -> Option<Change> {
        self.bounce.clear();
        self.set(t_us, contact, false)
    }

    /// Handles the first make after a flight: starts a closure, an operation and a bounce.
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
