//! Contacts on a way: closed forms at once, searches later.
//!
//! Upright pairs on a straight way are judged as soon as the broad phase shows them
//! ([`meeting`](super::meeting)). Whatever needs a search (tilted pieces, triangles, turns) is put on a
//! list, each pair once, and searched in the order in which the boxes meet. A contact shortens the
//! way for all that comes after it, so for the first contact the pair whose boxes meet first is judged
//! first.

use super::candidates::Candidates;
use super::distance::Gap;
use super::meeting::{Meeting, Run};
use super::mover::{Group, MOST_OF_A_GROUP};
use super::passage::{Passage, Pending};
use super::prism::Prism;
use super::space::{Boxes, Bundle, Cover, LANES, Sweep, Visit, above};
use super::standing::Stands;
use super::straight::{self, Hit};
use super::touch::touch;
use super::vector::sub;

/// What a contact is wanted for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Whether there is one: the gate.
    Any,
    /// The first one.
    First,
}

/// A pair within the margin at `t`.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    t: f64,
    /// Number of the standing piece.
    pub(crate) element: u32,
    how: How,
}

/// What is known of a contact.
#[derive(Debug, Clone)]
enum How {
    /// Index of the piece of the mover, both upright: the rest follows in closed form.
    Closed(u32),
    /// A search has found it. (Apart, so that closed forms carry no load.)
    Searched(Box<Gap>),
}

impl Found {
    pub(crate) fn searched(element: u32, hit: Hit) -> Found {
        Found {
            t: hit.t,
            element,
            how: How::Searched(Box::new(hit.gap)),
        }
    }

    /// Where and when.
    #[inline]
    pub(crate) fn hit(&self, passage: &Passage) -> Hit {
        let gap = match (&self.how, &passage.element(self.element).form) {
            (How::Closed(local), Stands::Upright(element)) => {
                let mover = passage.prism_at(*local, self.t);
                mover.map(|mover| touch(element, &mover, sub(mover.centre, element.centre)))
            }
            (How::Closed(_), Stands::Askew(_)) => None,
            (How::Searched(gap), _) => Some(**gap),
        };
        Hit {
            t: self.t,
            gap: gap.expect("closed forms are of upright pieces"),
        }
    }
}

impl Passage<'_> {
    /// Looks for a contact within the margin; when there is none in the end, that is proof.
    pub(crate) fn contact<'a>(&'a self, found: &mut Findings<'a>) {
        for group in &self.body.groups {
            let hull = group.hull(&self.whereabouts(self.way.margin_mm));
            let sweep = Sweep::new(hull, self.path.displacement);
            let until = found.until();
            let mut search = Search::new(self, group, found, &sweep);
            self.model.space.walk(&sweep, until, &mut search);
            if found.until() < 0.0 {
                return;
            }
        }
        self.searches(found);
    }
}

/// What is found so far.
pub(crate) struct Findings<'a> {
    wanted: Wanted,
    pub(crate) best: Option<Found>,
    pub(crate) pending: Vec<Pending>,
    /// When it was wanted before.
    run: Option<Run<'a>>,
}

impl Findings<'_> {
    /// Nothing yet.
    #[inline]
    pub(crate) fn wanted(wanted: Wanted) -> Self {
        Findings {
            wanted,
            best: None,
            pending: Vec::new(),
            run: None,
        }
    }

    /// The part of the way that still matters; below 0: nothing does.
    #[inline]
    pub(crate) fn until(&self) -> f64 {
        match (&self.best, self.wanted) {
            (None, _) => 1.0,
            (Some(_), Wanted::Any) => -1.0,
            (Some(best), Wanted::First) if best.t <= 0.0 => -1.0,
            (Some(best), Wanted::First) => best.t,
        }
    }

    #[inline]
    pub(crate) fn offer(&mut self, found: Option<Found>) {
        if let Some(found) = found
            && self.best.as_ref().is_none_or(|known| found.t < known.t)
        {
            self.best = Some(found);
        }
    }
}

/// One group of pieces on its way.
struct Search<'a, 'b> {
    passage: &'a Passage<'a>,
    group: &'a Group,
    found: &'b mut Findings<'a>,
    sweep: &'b Sweep,
    /// The boxes of the pieces, when they were wanted before.
    boxes: Option<Boxes<MOST_OF_A_GROUP>>,
    /// The pieces where the way begins, as far as they were looked at.
    prisms: [Option<Prism>; MOST_OF_A_GROUP],
    candidates: Candidates,
}

impl Visit for Search<'_, '_> {
    /// For any contact every one is as good, so pieces are judged at once; for the first one they wait.
    #[inline]
    fn in_order(&self) -> bool {
        self.found.wanted == Wanted::First
    }

    #[inline]
    fn bundle(
        &mut self,
        (number, bundle): (u32, &Bundle),
        lanes: u32,
        entry: &[f32; LANES],
    ) -> bool {
        if self.in_order() {
            if self.candidates.is_full() && self.pause() < 0.0 {
                return true;
            }
            self.candidates.push(number, lanes, entry);
            return false;
        }
        let mut left = lanes;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            self.piece(bundle.piece(lane), &bundle.cover(lane));
            if self.found.until() < 0.0 {
                return true;
            }
        }
        false
    }

    #[inline]
    fn pause(&mut self) -> f64 {
        let mut last = None;
        while let Some(place) = self.candidates.earliest(self.found.until()) {
            let bundle = self.passage.model.space.bundle(place.bundle());
            let piece = bundle.piece(place.lane());
            // Equally early, so next to each other: the same for another cell.
            if last != Some(piece) {
                last = Some(piece);
                self.piece(piece, &bundle.cover(place.lane()));
            }
        }
        self.found.until()
    }
}

impl<'a, 'b> Search<'a, 'b> {
    #[inline]
    fn new(
        passage: &'a Passage<'a>,
        group: &'a Group,
        found: &'b mut Findings<'a>,
        sweep: &'b Sweep,
    ) -> Search<'a, 'b> {
        Search {
            passage,
            group,
            found,
            sweep,
            boxes: None,
            prisms: [None; MOST_OF_A_GROUP],
            candidates: Candidates::NONE,
        }
    }

    /// A standing piece that the group may meet: which of its pieces do?
    #[inline]
    fn piece(&mut self, element: u32, cover: &Cover) {
        let until = self.found.until();
        let (passage, margin) = (self.passage, self.passage.way.margin_mm);
        let boxes = self
            .boxes
            .get_or_insert_with(|| self.group.boxes(&passage.whereabouts(margin)));
        let crossing = boxes.crossing(cover, &self.sweep.pace.reversed(), above(until));
        let mut places = crossing.lanes & self.group.used();
        while places != 0 {
            let place = places.trailing_zeros() as usize % MOST_OF_A_GROUP;
            places &= places - 1;
            let entry = f64::from(crossing.entry[place]);
            if entry <= self.found.until() {
                self.judge(entry, element, place);
            }
        }
    }

    #[inline]
    fn judge(&mut self, entry: f64, number: u32, place: usize) {
        let passage = self.passage;
        let element = passage.element(number);
        if !passage.counts(element) {
            return;
        }
        let local = self.group.first + place;
        match (&element.form, &passage.body.prisms[local]) {
            (Stands::Upright(standing), Some(own)) if passage.level => {
                let path = passage.path;
                let mover =
                    self.prisms[place].get_or_insert_with(|| own.carried(path.turned(), path.from));
                let until = self.found.until();
                let run = self.found.run.get_or_insert_with(|| Run::of(path));
                let found = passage.met(run, standing, mover, until);
                self.found.offer(found.map(|(t, gap)| Found {
                    t,
                    element: number,
                    how: gap.map_or(How::Closed(local as u32), |gap| {
                        How::Searched(Box::new(gap))
                    }),
                }));
            }
            _ => self.found.pending.push(Pending {
                order: entry,
                element: number,
                local: local as u32,
            }),
        }
    }
}

impl Passage<'_> {
    /// Two upright pieces on a level way; with a margin the place of the contact has been searched, too.
    #[inline]
    fn met(
        &self,
        run: &Run,
        element: &Prism,
        mover: &Prism,
        until: f64,
    ) -> Option<(f64, Option<Gap>)> {
        let margin = self.way.margin_mm;
        let t = Meeting::new(element, mover, run, margin).first(until)?;
        if margin == 0.0 {
            return Some((t, None));
        }
        // Within the margin in height and in the plane: over an edge the distance is larger.
        let (element, mover) = (element.piece(), mover.piece());
        let hit = straight::first_within(&element, &mover, run.way, margin, t, until)?;
        Some((hit.t, Some(hit.gap)))
    }
}
