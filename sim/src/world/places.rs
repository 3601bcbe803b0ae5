//! Parts by place: each place owns its part, so no part is in two places at once.

use super::magazine::Part;
use crate::truth::{BodyTruth, PartTruth, Place};

/// Places of the line between magazine and bin.
#[derive(Debug, Clone, Default)]
pub struct Places {
    /// Part in the pocket, in front of the pusher at rest.
    pub pocket: Option<Box<Part>>,
    /// Part in front of the moving pusher.
    pub pushed: Option<Box<Part>>,
    /// Part in the nest.
    pub nest: Option<Box<Part>>,
    /// True while the fingers hold the part in the nest.
    pub gripped: bool,
    /// Part in the gripper, clear of the nest.
    pub carried: Option<Box<Part>>,
    entered: u64,
    done: Vec<BodyTruth>,
}

impl Places {
    /// Moves a part into the nest; counts a lot part at its first entry.
    pub fn enter_nest(&mut self, mut part: Box<Part>, now_us: u64) {
        if part.number.is_some() && part.seq == 0 {
            self.entered += 1;
            part.seq = self.entered;
        }
        part.arrive(now_us, Place::Nest);
        while part.specimen.advance(now_us as f64).is_some() {}
        self.nest = Some(part);
    }

    /// Returns the number of lot parts that have entered the nest.
    pub fn entered(&self) -> u64 {
        self.entered
    }

    /// Records a part that has left the line.
    pub fn finish(&mut self, part: &Part) {
        self.done.extend(part.bodies());
    }

    /// Forgets the parts that have left the line.
    pub fn forget_finished(&mut self) {
        self.done.clear();
    }

    /// Returns the truth of every lot part that has entered the nest and is not forgotten, in order of entry.
    pub fn truth(&self) -> Vec<PartTruth> {
        let inside = [&self.nest, &self.carried].into_iter().flatten();
        let done = self.done.iter().map(|body| body.part.clone());
        let mut all: Vec<PartTruth> = done.chain(inside.map(|p| p.truth())).collect();
        all.retain(|t| t.seq > 0);
        all.sort_by_key(|t| t.seq);
        all
    }

    /// Returns every body that has left the magazine and is not falling, in arbitrary order.
    pub fn bodies(&self) -> impl Iterator<Item = BodyTruth> + '_ {
        let inside = [&self.pocket, &self.pushed, &self.nest, &self.carried];
        let inside = inside.into_iter().flatten().flat_map(|part| part.bodies());
        self.done.iter().cloned().chain(inside)
    }
}
