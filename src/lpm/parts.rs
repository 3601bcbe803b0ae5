//! The pieces of a group of the mover where they stand at the start, ready to be compared.

use super::mover::{Group, MOST_OF_A_GROUP, reach_of};
use super::passage::Passage;
use super::piece::NOISE;
use super::prism::Prism;
use super::space::{Cover, Sweep};
use super::vector::reach;

/// One piece.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    /// Index of the piece in its body.
    pub(crate) local: u32,
    pub(crate) sweep: Sweep,
    /// Of what is left of the way.
    pub(crate) cover: Cover,
    /// Of a piece to which closed forms apply.
    pub(crate) prism: Option<Prism>,
}

/// The pieces of one group; placed when the first of them is needed.
#[derive(Debug, Clone)]
pub(crate) struct Parts {
    parts: [Part; MOST_OF_A_GROUP],
    count: usize,
}

impl Part {
    const NONE: Part = Part {
        local: 0,
        sweep: Sweep {
            low: [0.0; 3],
            high: [0.0; 3],
            displacement: [0.0; 3],
        },
        cover: Cover {
            low: [0.0; 3],
            high: [0.0; 3],
        },
        prism: None,
    };

    #[inline]
    fn of(passage: &Passage, index: usize, margin: f64, until: f64) -> Part {
        let (path, piece) = (passage.path, &passage.body.pieces[index]);
        let prism = (passage.level && piece.upright)
            .then(|| Prism::placed(piece, path.start(), path.origin(0.0)));
        let bounds = match &prism {
            Some(prism) => prism.bounds(),
            None if path.turn.is_none() => path.piece_at(piece, 0.0).bounds(),
            None => {
                let origin = path.origin(0.0);
                let ball =
                    reach_of(piece) + NOISE * (piece.span + reach(piece.centre) + reach(origin));
                (
                    origin.map(|member| member - ball),
                    origin.map(|member| member + ball),
                )
            }
        };
        let sweep = path.sweep(bounds, margin);
        Part {
            local: index as u32,
            cover: sweep.cover(until),
            sweep,
            prism,
        }
    }
}

impl Parts {
    pub(crate) const UNPLACED: Parts = Parts {
        parts: [Part::NONE; MOST_OF_A_GROUP],
        count: 0,
    };

    /// Each piece of the group where it stands, as long as the way up to `until` matters.
    #[inline]
    pub(crate) fn placed(
        &mut self,
        passage: &Passage,
        group: &Group,
        margin: f64,
        until: f64,
    ) -> &mut [Part] {
        if self.count == 0 {
            let places = self
                .parts
                .iter_mut()
                .zip(group.first..group.first + group.count);
            places.for_each(|(part, index)| *part = Part::of(passage, index, margin, until));
            self.count = group.count;
        }
        &mut self.parts[..self.count]
    }
}
