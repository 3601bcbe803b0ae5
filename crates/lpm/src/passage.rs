//! One body on one path through the model.

use super::answer::Move;
use super::model::Model;
use super::mover::{Mover, Orientation, Whereabouts};
use super::path::Path;
use super::piece::Piece;
use super::pose::Frame;
use super::prism::Prism;
use super::stationary::Stationary;

/// A body, its path and the model.
pub(crate) struct Passage<'a> {
    pub(crate) model: &'a Model,
    pub(crate) body: &'a Mover,
    pub(crate) path: &'a Path,
    pub(crate) way: &'a Move<'a>,
    /// True when the path is straight and upright pieces stay upright, so that closed forms apply.
    pub(crate) level: bool,
    orientation: Orientation<'a>,
}

/// A piece of an element and a piece of the mover that still need a search.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pending {
    /// Sort key: the search takes the pair with the least key first.
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

    /// Returns a stationary piece by its number.
    #[inline]
    pub(crate) fn element(&self, number: u32) -> &'a Stationary {
        self.model.pieces.at(number)
    }

    /// Returns a stationary piece in the general form that searches need.
    pub(crate) fn piece(&self, number: u32) -> Piece {
        self.model.pieces.piece(number)
    }

    /// Returns a piece of the mover by its index.
    #[inline]
    pub(crate) fn local(&self, index: u32) -> &'a Piece {
        &self.body.pieces[index as usize]
    }

    /// Returns true unless the move ignores the element of this piece.
    #[inline]
    pub(crate) fn counts(&self, element: &Stationary) -> bool {
        self.way.ignore.is_empty() || !self.way.ignore.contains(&element.owner)
    }

    /// Returns a piece of the mover at fraction `t` of a level path, if the piece is upright.
    #[inline]
    pub(crate) fn prism_at(&self, index: u32, t: f64) -> Option<Prism> {
        let own = self.body.prisms[index as usize].as_ref()?;
        Some(own.carried(self.path.turned(), self.path.origin(t)))
    }

    /// Returns place and path of the body, for boxes that are widened by `margin_mm`.
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

/// Sorts the pairs and removes repeated ones, which have equal keys.
pub(crate) fn once_in_order(pending: &mut Vec<Pending>) {
    pending.sort_unstable_by(|a, b| {
        let pair = |pair: &Pending| (pair.element, pair.local);
        a.order.total_cmp(&b.order).then(pair(a).cmp(&pair(b)))
    });
    pending.dedup_by_key(|pair| (pair.element, pair.local));
}
