//! One body on one way through the model.

use super::answer::Move;
use super::distance::gap;
use super::model::Model;
use super::mover::Mover;
use super::path::Path;
use super::piece::Piece;
use super::standing::Standing;
use super::straight::Hit;
use super::vector::{length, scale};

/// How far before a contact its plane is looked for, mm: of bodies that touch no plane between
/// them is better than any other.
const BEFORE_CONTACT_MM: f64 = 1e-6;

/// A body, its way and the model.
pub(crate) struct Passage<'a> {
    pub(crate) model: &'a Model,
    pub(crate) body: &'a Mover,
    pub(crate) path: &'a Path,
    pub(crate) way: &'a Move<'a>,
    /// A straight way on which upright pieces stay upright: closed forms apply.
    pub(crate) level: bool,
}

/// Pieces of an element and of the mover that a search has to look at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pending {
    /// What to begin with: the least is searched first.
    pub(crate) order: f64,
    pub(crate) element: u32,
    pub(crate) local: u32,
}

impl<'a> Passage<'a> {
    #[inline]
    pub(crate) fn new(
        model: &'a Model,
        body: &'a Mover,
        path: &'a Path,
        way: &'a Move<'a>,
    ) -> Passage<'a> {
        let level = path.turn.is_none() && path.start().is_upright();
        Passage {
            model,
            body,
            path,
            way,
            level,
        }
    }

    /// A piece that stands, by its number.
    #[inline]
    pub(crate) fn element(&self, number: u32) -> &'a Standing {
        self.model.pieces.at(number)
    }

    /// The same as a whole, for searches.
    pub(crate) fn piece(&self, number: u32) -> Piece {
        self.model.pieces.piece(number)
    }

    /// A piece of the mover, by its index.
    #[inline]
    pub(crate) fn local(&self, index: u32) -> &'a Piece {
        &self.body.pieces[index as usize]
    }

    /// Whether a piece belongs to an element that is not to be ignored.
    #[inline]
    pub(crate) fn counts(&self, element: &Standing) -> bool {
        self.way.ignore.is_empty() || !self.way.ignore.contains(&self.model.key(element.owner))
    }

    /// Where and along which normal an element and a piece of the mover come to touch at `t`.
    pub(crate) fn touch(&self, element: &Piece, local: u32, t: f64) -> Hit {
        let run = self.path.displacement;
        let back = BEFORE_CONTACT_MM / length(run);
        let before = if back < t { t - back } else { 0.0 };
        let mover = self.path.piece_at(self.local(local), 0.0);
        let mut gap = gap(element, &mover, scale(run, before), None);
        gap.lower = 0.0;
        Hit { t, gap }
    }
}

/// Sorts by order and leaves every pair once. (The order is a function of the pair.)
pub(crate) fn once_in_order(pending: &mut Vec<Pending>) {
    pending.sort_unstable_by(|a, b| {
        let pair = |pair: &Pending| (pair.element, pair.local);
        a.order.total_cmp(&b.order).then(pair(a).cmp(&pair(b)))
    });
    pending.dedup_by_key(|pair| (pair.element, pair.local));
}
