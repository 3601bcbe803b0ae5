//! The last clear pose of a refused stroke, at which it may stop or to which it may return.
//!
//! The guard tries each pose before it offers it. A pose that just reaches the margin is not clear, so the offer lies
//! a little before it.

use super::judge::judge;
use super::motion::Motion;
use super::scene::Scene;
use super::situation::Situation;
use super::space::Space;
use super::sweep::FirstContact;

/// Distance of the offer before the contact, mm: the resolution of the axis's point table.
const BEFORE_MM: f64 = 0.01;

/// Returns the position in mm of the stroke; `None` when the start is blocked, unknown, or nearer than [`BEFORE_MM`].
pub(super) fn last_clear_mm(
    scene: &Scene,
    space: &mut Space,
    situation: &Situation,
    finding: &FirstContact,
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
