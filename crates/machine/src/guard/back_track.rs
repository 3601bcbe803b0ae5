//! The last clear pose of a refused stroke: the actuator may stop there, or return to it.
//!
//! The guard checks the pose before it offers the pose to the station. A pose that just reaches the margin is not
//! clear, so the offered pose lies a little before it.

use super::judge::judge;
use super::motion::Motion;
use super::scene::Scene;
use super::situation::Situation;
use super::space::Space;
use super::sweep::FirstContact;

/// How far before the first contact the offered pose lies, mm: the resolution of the axis's point table.
const BEFORE_MM: f64 = 0.01;

/// Returns the last clear position, mm of the stroke; `None` when the start is blocked, unknown, or within
/// [`BEFORE_MM`] of the contact.
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
