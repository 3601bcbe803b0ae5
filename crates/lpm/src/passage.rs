//! One body on one way through the model.

use super::answer::Move;
use super::model::Model;
use super::mover::{Mover, Orientation, Whereabouts};
use super::path::Path;
use super::piece::Piece;
use super::pose::Frame;
use super::prism::Prism;
use super::standing::Standing;

/// A body, its way and the model.
pub(crate) struct Passage<'a> {
    pub(crate) model: &'a Model,
    pub(crate) body: &'a Mover,
    pub(crate) path: &'a Path,
    pub(crate) way: &'a Move<'a>,
    /// A straight way on which upright pieces stay upright: closed forms apply.
    pub(crate) level: bool,
    orientation: Orientation<'a>,
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
        let level = path.turn.is_none() && path.turned().is_none_or(Frame::is_upright);
        Passage {
            model,
            body,
            path,
            way,
            level,
            orientation: path.orientation(),
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
        self.way.ignore.is_empty() || !self.way.ignore.contains(&element.owner)
    }

    /// A piece of the mover at `t` of a level way, if it is upright.
    #[inline]
    pub(crate) fn prism_at(&self, index: u32, t: f64) -> Option<Prism> {
        let own = self.body.prisms[index as usize].as_ref()?;
        Some(own.carried(self.path.turned(), self.path.origin(t)))
    }

    /// Where the body is when its boxes are asked for, to be widened by `margin_mm`.
    #[inline(always)]
    pub(crate) fn whereabouts(&self, margin_mm: f64) -> Whereabouts<'a> {
        Whereabouts {
            origin: self.path.from,
            orientation: self.orientation,
            run: self.path.displacement,
            margin_mm,
        }
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
