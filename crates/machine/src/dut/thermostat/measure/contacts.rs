//! Edges of the contacts, as the scan reads them, and the switchings that they form.

use crate::rig::image::Image;
use crate::rig::point::DigitalInput;
use chamber::lag::{Switching, Transition};
use units::{RigTime, Span};

/// Greatest age at which a reading of a contact still counts.
const FRESH: Span = Span::ms(2_000);
/// Edges at most this far apart belong to one switching, s.
const GAP_S: f64 = 1.0;
/// A contact has switched once it has kept its state for longer than this.
const SETTLED: Span = Span::ms(1_000);
/// Number of bursts of edges without a switching from which a contact is intermittent; fewer may be knocks at the rack.
const STRAY: usize = 3;

/// An edge of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Edge {
    /// Instant of the edge: the middle of the two polls around it.
    at: RigTime,
    /// True when the contact is closed after the edge.
    closed: bool,
}

/// Contact of one socket.
#[derive(Debug, Clone)]
pub struct Contact {
    input: DigitalInput,
    polled: Option<(RigTime, bool)>,
    cold: Option<bool>,
    /// True once a first poll comes too late to tell the state when cold.
    is_warm: bool,
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
            is_warm: false,
            edges: Vec::new(),
        }
    }

    /// Takes the last reading of the scan.
    pub fn poll(&mut self, image: &Image, now: RigTime) {
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
        if !self.is_warm {
            self.cold.get_or_insert(closed);
        }
        let Some((last, was)) = before else { return };
        if was != closed {
            let at = last + Span(at.since(last).0 / 2);
            self.edges.push(Edge { at, closed });
        }
    }

    /// Ends the time in which a first poll tells the state when cold.
    pub fn warm(&mut self) {
        self.is_warm = true;
    }

    /// Returns the state at the first poll; `None` before it, and for a contact that was first polled when warm.
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
    pub fn is_open(&self, now: RigTime) -> bool {
        let settled = self
            .edges
            .last()
            .is_none_or(|it| now.since(it.at) > SETTLED);
        settled && self.polled.is_some_and(|(_, closed)| !closed)
    }

    /// Returns switchings and stray bursts of all edges; their times count from `origin`, the time zero of the record.
    pub fn events(&self, origin: RigTime) -> Events {
        let seconds = |it: &Edge| (it.at.0 as f64 - origin.0 as f64) / 1e6;
        let edges: Vec<(f64, bool)> = self
            .edges
            .iter()
            .map(|it| (seconds(it), it.closed))
            .collect();
        events(self.cold.unwrap_or(true), &edges)
    }
}

/// Groups edges, each an instant with the state after it, into switchings and stray bursts; `closed` is the state before
/// the first edge.
fn events(mut closed: bool, edges: &[(f64, bool)]) -> Events {
    let mut events = Events::default();
    for burst in edges.chunk_by(|(a_s, _), (b_s, _)| b_s - a_s <= GAP_S) {
        let (Some(&(first_s, _)), Some(&(last_s, ends_closed))) = (burst.first(), burst.last())
        else {
            continue;
        };
        if ends_closed == closed {
            events.stray += 1;
            continue;
        }
        closed = ends_closed;
        let all = match closed {
            false => &mut events.switching.operate,
            true => &mut events.switching.reset,
        };
        all.push(Transition {
            first_s,
            last_s,
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

    /// Returns true for a contact that an earlier pass has left in its state although it went through the whole window;
    /// `later_pass_s`: when the present pass began, `None` in the first one.
    pub fn is_stuck(&self, later_pass_s: Option<f64>) -> bool {
        let Some(began_s) = later_pass_s else {
            return false;
        };
        let Switching { operate, reset } = &self.switching;
        let never_resets = |first: &Transition| reset.is_empty() && first.first_s < began_s;
        operate.first().is_none_or(never_resets)
    }

    /// Returns the greatest number of edges of one switching in addition to its own; `None` without a switching.
    pub fn most_extra_edges(&self) -> Option<u32> {
        let all = self.switching.operate.iter().chain(&self.switching.reset);
        all.map(|it| it.edges - 1).max()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::rig::settings::RigSettings;
    use crate::rig::wiring::Wiring;
    use std::sync::Arc;

    const RIG: &str = include_str!("../../../../../../config/rigs/thermostat/rig.toml");

    /// Polls of the contact in socket 1.
    struct Polls {
        image: Image,
        contact: Contact,
    }

    impl Polls {
        fn new() -> Self {
            let settings: RigSettings = toml::from_str(RIG).unwrap();
            let wiring = Arc::new(Wiring::resolve(&settings, crate::dut::FIXTURES).unwrap());
            let contact = Contact::new(wiring.rack().unwrap().socket(1).unwrap().contact);
            let image = Image::new(wiring);
            Self { image, contact }
        }

        /// Polls at a second of the rig.
        fn poll(&mut self, second: u64, closed: bool) {
            let wired = self.image.wiring().wired_in(self.contact.input).unwrap();
            let command = self.image.wiring().poll(wired.module);
            let line = self.image.wiring().module(wired.module).line;
            let word = if closed { "FFFE" } else { "FFFF" };
            let text = format!(">{word}");
            let reply = command
                .decode(format!("{text}\r").as_bytes(), false)
                .unwrap();
            let now = RigTime(second * 1_000_000);
            self.image
                .accept(line, &command, &reply, &text, now)
                .unwrap();
            self.contact.poll(&self.image, now);
        }
    }

    #[test]
    fn an_edge_after_the_record_leaves_earlier_switchings_alone() {
        let mut polls = Polls::new();
        [
            (10, true),
            (300, true),
            (302, false),
            (900, false),
            (902, true),
        ]
        .into_iter()
        .for_each(|(second, closed)| polls.poll(second, closed));
        let found = polls.contact.events(RigTime(100_000_000)).switching;
        let times = |all: &[Transition]| all.iter().map(|it| it.first_s).collect::<Vec<f64>>();
        assert_eq!(
            (times(&found.operate), times(&found.reset)),
            (vec![201.0], vec![801.0])
        );
    }

    #[test]
    fn a_contact_first_read_when_warm_is_not_cold() {
        let mut polls = Polls::new();
        polls.contact.warm();
        polls.poll(10, true);
        assert_eq!(polls.contact.cold(), None);
    }

    #[test]
    fn only_a_contact_that_kept_its_state_is_stuck() {
        let passes =
            |edges: &[(f64, bool)], later_pass_s| events(true, edges).is_stuck(later_pass_s);
        assert!(!passes(&[], None) && passes(&[], Some(900.0)));
        let (operate, reset) = ((100.0, false), (500.0, true));
        assert!(!passes(&[operate, reset], Some(900.0)));
        assert!(passes(&[operate], Some(900.0)));
        assert!(!passes(&[(1000.0, false)], Some(900.0)));
    }

    fn found(edges: &[(f64, bool)]) -> Events {
        events(true, edges)
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
