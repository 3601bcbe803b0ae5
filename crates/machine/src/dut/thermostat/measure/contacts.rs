//! Edges of the contacts, as the scan reads them, and the switchings that they form.

use crate::rig::image::Image;
use crate::rig::point::DigitalInput;
use chamber::lag::{Switching, Transition};
use units::{RigTime, Span};

/// Greatest age at which a reading of a contact still counts.
const FRESH: Span = Span::ms(2_000);
/// Edges at most this far apart belong to one switching, s.
const GAP_S: f64 = 1.0;
/// A contact has switched once it has kept its state for longer than this, s.
const SETTLED_S: f64 = 1.0;
/// Number of bursts of edges without a switching from which a contact is intermittent; fewer may be knocks at the rack.
const STRAY: usize = 3;

/// An edge of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Edge {
    /// Instant of the edge, s of the record: the middle of the two polls around it.
    at_s: f64,
    /// True when the contact is closed after the edge.
    closed: bool,
}

/// Contact of one socket.
#[derive(Debug, Clone)]
pub struct Contact {
    input: DigitalInput,
    polled: Option<(RigTime, bool)>,
    cold: Option<bool>,
    edges: Vec<Edge>,
}

/// Switchings and stray bursts of one contact.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Events {
    /// Switchings.
    pub switching: Switching,
    /// Number of bursts of edges after which the contact was in the same state as before.
    pub stray: usize,
}

impl Contact {
    /// Makes the contact of a socket, not yet polled.
    pub fn new(input: DigitalInput) -> Self {
        Self {
            input,
            polled: None,
            cold: None,
            edges: Vec::new(),
        }
    }

    /// Takes the last reading of the scan; times count from `origin`, the time zero of the record.
    pub fn poll(&mut self, image: &Image, now: RigTime, origin: RigTime) {
        let Some(at) = image.input_at(self.input) else {
            return;
        };
        let before = self.polled;
        if before.is_some_and(|(last, _)| last >= at) {
            return;
        }
        let Some(closed) = image.input(self.input, now, FRESH) else {
            return;
        };
        self.polled = Some((at, closed));
        self.cold.get_or_insert(closed);
        let Some((last, was)) = before else { return };
        if was != closed {
            let seconds = |at: RigTime| at.0 as f64 / 1e6 - origin.0 as f64 / 1e6;
            let at_s = f64::midpoint(seconds(last), seconds(at));
            self.edges.push(Edge { at_s, closed });
        }
    }

    /// Returns true when the contact was closed at the first poll; `None` before that poll.
    pub fn cold(&self) -> Option<bool> {
        self.cold
    }

    /// Returns the input of the contact.
    pub fn input(&self) -> DigitalInput {
        self.input
    }

    /// Returns true for a contact that was closed when cold and is closed now.
    pub fn is_live_and_closed(&self) -> bool {
        self.cold == Some(true) && self.polled.is_some_and(|(_, closed)| closed)
    }

    /// Returns true once the contact is open and has been for a second.
    pub fn is_open(&self, now_s: f64) -> bool {
        let settled = self
            .edges
            .last()
            .is_none_or(|it| now_s - it.at_s > SETTLED_S);
        settled && self.polled.is_some_and(|(_, closed)| !closed)
    }

    /// Returns the switchings and stray bursts so far.
    pub fn events(&self) -> Events {
        events(self.cold.unwrap_or(true), &self.edges)
    }
}

/// Groups edges into switchings and stray bursts; `closed` is the state before the first edge.
fn events(mut closed: bool, edges: &[Edge]) -> Events {
    let mut events = Events::default();
    for burst in edges.chunk_by(|a, b| b.at_s - a.at_s <= GAP_S) {
        let (Some(first), Some(last)) = (burst.first(), burst.last()) else {
            continue;
        };
        if last.closed == closed {
            events.stray += 1;
            continue;
        }
        closed = last.closed;
        let all = match closed {
            false => &mut events.switching.operate,
            true => &mut events.switching.reset,
        };
        all.push(Transition {
            first_s: first.at_s,
            last_s: last.at_s,
            edges: u32::try_from(burst.len()).unwrap_or(u32::MAX),
        });
    }
    events
}

impl Events {
    /// Returns true for a contact with at least three bursts of edges that returned to the state before.
    pub fn is_intermittent(&self) -> bool {
        self.stray >= STRAY
    }

    /// Returns the greatest number of edges of one switching beyond the one it needs; `None` without a switching.
    pub fn most_extra_edges(&self) -> Option<u32> {
        let all = self.switching.operate.iter().chain(&self.switching.reset);
        all.map(|it| it.edges - 1).max()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(edges: &[(f64, bool)]) -> Events {
        let edge = |&(at_s, closed): &(f64, bool)| Edge { at_s, closed };
        let edges: Vec<Edge> = edges.iter().map(edge).collect();
        events(true, &edges)
    }

    #[test]
    fn a_chattering_switching_counts_once_with_its_edges() {
        let found = found(&[(10.0, false), (10.2, true), (10.5, false), (90.0, true)]);
        let [operate, reset] = [&found.switching.operate, &found.switching.reset];
        assert_eq!((operate.len(), reset.len(), found.stray), (1, 1, 0));
        assert_eq!((operate[0].first_s, operate[0].last_s), (10.0, 10.5));
        assert_eq!(found.most_extra_edges(), Some(2));
    }

    #[test]
    fn a_contact_that_opens_for_a_moment_has_not_switched() {
        let pairs: Vec<(f64, bool)> = (0..4)
            .flat_map(|it| {
                [
                    (f64::from(it) * 9.0, false),
                    (f64::from(it) * 9.0 + 0.03, true),
                ]
            })
            .collect();
        let all = found(&pairs);
        assert!(all.is_intermittent() && all.switching == Switching::default());
        assert!(!found(&pairs[..2]).is_intermittent());
    }
}
