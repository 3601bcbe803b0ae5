//! The last clear pose of a refused stroke: where it may stop, or be taken back to.
//!
//! Found by trying, like the advice: what is offered, the guard clears. A pose in which the margin
//! is just reached is not clear, so the offer stands a little before it.

use super::judge::judge;
use super::motion::Motion;
use super::scene::Scene;
use super::situation::Situation;
use super::space::Space;
use super::sweep::Finding;

/// How far before the contact the offer stands, mm: what a point table of the axis can tell apart.
const BEFORE_MM: f64 = 0.01;

/// Position in mm of the stroke; `None` when the start itself is not clear, not known, or nearer
/// than [`BEFORE_MM`].
pub(super) fn last_clear_mm(
    scene: &Scene,
    space: &mut Space,
    situation: &Situation,
    finding: &Finding,
) -> Option<f64> {
    let (from, reached) = finding.clear_way_mm?;
    if (reached - from).abs() <= BEFORE_MM {
        return None;
    }
    let offered = reached - BEFORE_MM.copysign(reached - from);
    let alone = Motion::to(finding.stroke.actuator, offered);
    let clear = judge(scene, space, &alone, situation).is_ok_and(|found| found.is_none());
    clear.then_some(offered)
}
