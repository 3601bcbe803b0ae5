//! Searches for contacts on a path: first by closed forms, then by iterative searches.
//!
//! A closed form decides a pair of upright pieces on a straight path as soon as the broad phase reports the pair
//! ([`meeting`](super::meeting)). A pair that needs a search (tilted pieces, triangles, turns) goes onto a list, once.
//! The search takes the pairs on the list in the order in which their boxes meet: a contact shortens the path for all
//! later pairs, so this order finds the first contact soonest.

use super::answer::ElementKey;
use super::candidates::Candidates;
use super::distance::Gap;
use super::meeting::{Meeting, Run};
use super::mover::{Group, MOST_OF_A_GROUP};
use super::passage::{Passage, Pending};
use super::prism::Prism;
use super::space::{Boxes, Bundle, LANES, Onset, Sweep, Visit, above};
use super::stationary::{Stationary, Stored};
use super::straight::{self, Hit};
use super::touch::touch;
use super::vector::sub;

/// Which contact a question asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Any contact; enough for a gate that only needs to know whether there is one.
    Any,
    /// The first contact on the path.
    First,
    /// Every piece that the body meets anywhere on the path; places and order do not matter.
    Every,
}

/// A pair that comes within the margin at the fraction `t` of the path.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    t: f64,
    /// Number of the stationary piece.
    pub(crate) element: u32,
    evidence: Evidence,
}

/// How a contact was found, with the data from which its place and normal follow.
#[derive(Debug, Clone)]
enum Evidence {
    /// Index of the piece of the mover; this piece and that of the element are upright, so a closed form gives place
    /// and normal.
    Closed(u32),
    /// Result of a search. Boxed, so that the closed forms, which are more frequent, stay small.
    Searched(Box<Gap>),
}

impl Found {
    pub(crate) fn searched(element: u32, hit: Hit) -> Found {
        Found {
            t: hit.t,
            element,
            evidence: Evidence::Searched(Box::new(hit.gap)),
        }
    }

    /// Returns the contact: fraction of the path, place and normal.
    #[inline]
    pub(crate) fn hit(&self, passage: &Passage) -> Hit {
        let gap = match (&self.evidence, &passage.element(self.element).form) {
            (Evidence::Closed(local), Stored::Upright(element)) => {
                let mover = passage.prism_at(*local, self.t);
                mover.map(|mover| touch(element, &mover, sub(mover.centre, element.centre)))
            }
            (Evidence::Closed(_), Stored::Askew(_)) => None,
            (Evidence::Searched(gap), _) => Some(**gap),
        };
        Hit {
            t: self.t,
            gap: gap.expect("closed forms apply to upright pieces only"),
        }
    }
}

impl Passage<'_> {
    /// Searches for a contact within the margin. When `found` holds none afterwards, there is provably none.
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

/// Contact found so far, and pairs that still need a search.
pub(crate) struct Findings<'a> {
    wanted: Wanted,
    pub(crate) best: Option<Found>,
    /// Elements met, for [`Wanted::Every`]; an element may be listed more than once.
    pub(crate) met: Vec<ElementKey>,
    pub(crate) pending: Vec<Pending>,
    /// The straight path with the reciprocals of its displacement, computed when first needed.
    run: Option<Run<'a>>,
}

impl Findings<'_> {
    /// Starts with no contact found; `wanted` says which contact the question asks for.
    #[inline]
    pub(crate) fn wanted(wanted: Wanted) -> Self {
        Self::into(wanted, Vec::new())
    }

    /// Starts with no contact found, and lists elements in `met`, which must be empty; several questions can share the
    /// memory of `met`.
    #[inline]
    pub(crate) fn into(wanted: Wanted, met: Vec<ElementKey>) -> Self {
        Findings {
            wanted,
            best: None,
            met,
            pending: Vec::new(),
            run: None,
        }
    }

    /// Returns the fraction of the path up to which a contact still matters; below 0 when none does.
    #[inline]
    pub(crate) fn until(&self) -> f64 {
        match (&self.best, self.wanted) {
            (None, _) | (Some(_), Wanted::Every) => 1.0,
            (Some(_), Wanted::Any) => -1.0,
            (Some(best), Wanted::First) if best.t <= 0.0 => -1.0,
            (Some(best), Wanted::First) => best.t,
        }
    }

    #[inline]
    pub(crate) fn offer(&mut self, found: Option<Found>, owner: ElementKey) {
        if self.wanted == Wanted::Every {
            self.met.extend(found.map(|_| owner));
        } else if let Some(found) = found
            && self.best.as_ref().is_none_or(|known| found.t < known.t)
        {
            self.best = Some(found);
        }
    }
}

/// The search for contacts of one group of the mover's pieces along its path.
struct Search<'a, 'b> {
    passage: &'a Passage<'a>,
    group: &'a Group,
    found: &'b mut Findings<'a>,
    sweep: &'b Sweep,
    /// Boxes of the group's pieces; the search computes them when it first needs them.
    boxes: Option<Boxes<MOST_OF_A_GROUP>>,
    /// The group's pieces at the start of the path; the search computes each when it first needs it.
    prisms: [Option<Prism>; MOST_OF_A_GROUP],
    candidates: Candidates,
    recent: Recent,
}

/// Number of pieces that [`Recent`] remembers: as many as squares lie side by side across a path.
const REMEMBERED: usize = 16;

/// The pieces checked last, for [`Wanted::Every`]. The walk visits a piece once for each square that the piece covers,
/// in close succession.
struct Recent {
    pieces: [u32; REMEMBERED],
    next: usize,
}

impl Recent {
    const NONE: Recent = Recent {
        pieces: [u32::MAX; REMEMBERED],
        next: 0,
    };

    /// Remembers a piece; returns false when it is remembered already.
    #[inline]
    fn is_new(&mut self, piece: u32) -> bool {
        let known = (self.pieces.iter()).fold(false, |known, it| known | (*it == piece));
        if !known {
            self.pieces[self.next % REMEMBERED] = piece;
            self.next += 1;
        }
        !known
    }
}

impl Visit for Search<'_, '_> {
    /// Returns true when the question asks for the first contact: pieces then wait as candidates, so that the search
    /// checks them in order. When the question asks for any contact, the search checks pieces at once.
    #[inline]
    fn in_order(&self) -> bool {
        self.found.wanted == Wanted::First
    }

    #[inline]
    fn bundle(&mut self, bundle: &Bundle, lanes: u32, onset: Option<&Onset>) -> bool {
        if let Some(onset) = onset {
            if self.candidates.is_full() && self.pause() < 0.0 {
                return true;
            }
            self.candidates.push(bundle, lanes, onset);
            return false;
        }
        let mut left = lanes;
        let is_every = self.found.wanted == Wanted::Every;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            let piece = bundle.piece(lane);
            if is_every && !self.recent.is_new(piece) {
                continue;
            }
            if is_every && self.group.count == 1 {
                // The walk has compared the boxes of the only piece already.
                self.judge(0.0, (piece, self.passage.element(piece)), 0);
            } else {
                self.piece(piece);
            }
            if self.found.until() < 0.0 {
                return true;
            }
        }
        false
    }

    #[inline]
    fn pause(&mut self) -> f64 {
        while let Some(piece) = self.candidates.earliest(self.found.until()) {
            self.piece(piece);
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
            recent: Recent::NONE,
        }
    }

    /// Checks this stationary piece against the pieces of the group whose boxes meet its box.
    #[inline]
    fn piece(&mut self, number: u32) {
        let until = self.found.until();
        let (passage, margin) = (self.passage, self.passage.way.margin_mm);
        let boxes = self
            .boxes
            .get_or_insert_with(|| self.group.boxes(&passage.whereabouts(margin)));
        let element = passage.element(number);
        let crossing = boxes.crossing(&element.cover(), &self.sweep.pace.reversed(), above(until));
        let mut places = crossing.lanes & self.group.used();
        while places != 0 {
            let place = places.trailing_zeros() as usize % MOST_OF_A_GROUP;
            places &= places - 1;
            let entry = f64::from(crossing.entry[place]);
            if entry <= self.found.until() {
                self.judge(entry, (number, element), place);
            }
        }
    }

    #[inline]
    fn judge(&mut self, entry: f64, (number, element): (u32, &Stationary), place: usize) {
        let passage = self.passage;
        if !passage.counts(element) {
            return;
        }
        let local = self.group.first + place;
        match (&element.form, &passage.body.prisms[local]) {
            (Stored::Upright(fixed), Some(own)) if passage.level => {
                let path = passage.path;
                let mover =
                    self.prisms[place].get_or_insert_with(|| own.carried(path.turned(), path.from));
                let until = self.found.until();
                let run = self.found.run.get_or_insert_with(|| Run::of(path));
                if self.found.wanted == Wanted::Every && passage.way.margin_mm == 0.0 {
                    if Meeting::new(fixed, mover, run, 0.0).is_any() {
                        self.found.met.push(element.owner);
                    }
                    return;
                }
                let found = passage.met(run, fixed, mover, until);
                let found = found.map(|(t, gap)| Found {
                    t,
                    element: number,
                    evidence: gap.map_or(Evidence::Closed(local as u32), |gap| {
                        Evidence::Searched(Box::new(gap))
                    }),
                });
                self.found.offer(found, element.owner);
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
    /// Returns the contact of two upright pieces on a level path; with a margin, also searches for its place.
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
        // Heights and footprints are each within the margin, but the diagonal distance over an edge may still exceed
        // the margin.
        let (element, mover) = (element.piece(), mover.piece());
        let hit = straight::first_within(&element, &mover, run.way, margin, t, until)?;
        Some((hit.t, Some(hit.gap)))
    }
}
