//! Contacts on a way: closed forms at once, searches later.
//!
//! Upright pairs on a straight way are judged as soon as the broad phase shows them
//! ([`prism`](super::prism)). Whatever needs a search (tilted pieces, triangles, turns) is put on a
//! list, each pair once, and searched in the order in which the boxes meet. A contact shortens the
//! way for all that comes after it.

use super::distance::Gap;
use super::mover::Group;
use super::parts::{Part, Parts};
use super::passage::{Passage, Pending, once_in_order};
use super::prism::{Meeting, Prism};
use super::space::{Bundle, LANES};
use super::standing::Stands;
use super::straight::{self, Hit};
use super::turning::Turning;

/// What a contact is wanted for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Whether there is one: the gate.
    Any,
    /// The first one.
    First,
}

/// A pair within the margin at `t`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    t: f64,
    /// Number of the standing piece.
    pub(crate) element: u32,
    local: u32,
    /// When a search has found it.
    searched: Option<Gap>,
}

impl Found {
    /// Where and when.
    pub(crate) fn hit(&self, passage: &Passage) -> Hit {
        match self.searched {
            Some(gap) => Hit { t: self.t, gap },
            None => passage.touch(&passage.piece(self.element), self.local, self.t),
        }
    }
}

impl Passage<'_> {
    /// A contact within the margin; `None` is proof that there is none.
    #[inline]
    pub(crate) fn contact(&self, wanted: Wanted) -> Option<Found> {
        let mut search = Search {
            passage: self,
            wanted,
            best: None,
            pending: Vec::new(),
        };
        for group in &self.body.groups {
            search.group(group);
            if search.is_done() {
                return search.best;
            }
        }
        if !search.pending.is_empty() {
            search.searches();
        }
        search.best
    }
}

struct Search<'a> {
    passage: &'a Passage<'a>,
    wanted: Wanted,
    best: Option<Found>,
    pending: Vec<Pending>,
}

impl Search<'_> {
    /// Nothing that is still to come can matter.
    #[inline]
    fn is_done(&self) -> bool {
        match (&self.best, self.wanted) {
            (None, _) => false,
            (Some(_), Wanted::Any) => true,
            (Some(best), Wanted::First) => best.t <= 0.0,
        }
    }

    /// The part of the way that still matters.
    #[inline]
    fn until(&self) -> f64 {
        match &self.best {
            Some(_) if self.is_done() => -1.0,
            Some(best) => best.t,
            None => 1.0,
        }
    }

    fn group(&mut self, group: &Group) {
        let passage = self.passage;
        let margin = passage.way.margin_mm;
        let sweep = group.sweep(passage.path, margin);
        let mut parts = None;
        passage.model.space.walk(&sweep, |bundle, lanes| {
            let parts = parts.get_or_insert(Parts::UNPLACED);
            let parts = parts.placed(passage, group, margin, self.until());
            self.bundle(bundle, lanes, parts);
            self.until()
        });
    }

    #[inline]
    fn bundle(&mut self, bundle: &Bundle, lanes: u32, parts: &mut [Part]) {
        for index in 0..parts.len() {
            let mut meeting = lanes & bundle.meeting(&parts[index].cover);
            while meeting != 0 {
                let lane = meeting.trailing_zeros() as usize % LANES;
                meeting &= meeting - 1;
                let before = self.until();
                self.pair(bundle, lane, &parts[index]);
                let until = self.until();
                if until < 0.0 {
                    return;
                }
                if until < before {
                    parts
                        .iter_mut()
                        .for_each(|part| part.cover = part.sweep.cover(until));
                    meeting &= bundle.meeting(&parts[index].cover);
                }
            }
        }
    }

    #[inline]
    fn pair(&mut self, bundle: &Bundle, lane: usize, part: &Part) {
        let number = bundle.piece(lane);
        let element = self.passage.element(number);
        if !self.passage.counts(element) {
            return;
        }
        match (&part.prism, &element.form) {
            (Some(prism), Stands::Upright(standing)) => {
                let found = self.met(number, standing, part, prism);
                self.offer(found);
            }
            (Some(_), Stands::Askew(_)) | (None, _) => self.pending.push(Pending {
                order: part.sweep.first_over(&bundle.cover(lane)),
                element: number,
                local: part.local,
            }),
        }
    }

    #[inline]
    fn offer(&mut self, found: Option<Found>) {
        if let Some(found) = found
            && self.best.is_none_or(|known| found.t < known.t)
        {
            self.best = Some(found);
        }
    }

    /// Both upright, the way straight.
    #[inline]
    fn met(&self, number: u32, standing: &Prism, part: &Part, mover: &Prism) -> Option<Found> {
        let (run, margin) = (self.passage.path.displacement, self.passage.way.margin_mm);
        let t = Meeting::new(standing, mover, run, margin).first(self.until())?;
        let found = |t, searched| Found {
            t,
            element: number,
            local: part.local,
            searched,
        };
        if margin == 0.0 {
            return Some(found(t, None));
        }
        // Within the margin in height and in the plane: over an edge the distance is larger.
        let at_start = self
            .passage
            .path
            .piece_at(self.passage.local(part.local), 0.0);
        let hit =
            straight::first_within(&standing.piece(), &at_start, run, margin, t, self.until())?;
        Some(found(hit.t, Some(hit.gap)))
    }

    fn searches(&mut self) {
        let mut pending = std::mem::take(&mut self.pending);
        once_in_order(&mut pending);
        for pair in pending {
            if pair.order > self.until() {
                return;
            }
            let found = self.searched(&pair);
            self.offer(found);
        }
    }

    fn searched(&self, pair: &Pending) -> Option<Found> {
        let path = self.passage.path;
        let element = &self.passage.piece(pair.element);
        let local = self.passage.local(pair.local);
        let (margin, until) = (self.passage.way.margin_mm, self.until());
        let hit = match &path.turn {
            None => {
                let at_start = path.piece_at(local, 0.0);
                straight::first_within(element, &at_start, path.displacement, margin, 0.0, until)
            }
            Some(turn) => Turning {
                element,
                local,
                path,
                turn,
            }
            .first_within(margin, until),
        }?;
        Some(Found {
            t: hit.t,
            element: pair.element,
            local: pair.local,
            searched: Some(hit.gap),
        })
    }
}
