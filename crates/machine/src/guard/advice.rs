//! The remedy for a refused motion, found by trial: a change after which the guard clears the motion.
//!
//! The search tries one change at a time, in this order: an actuator that carries the blocking or the moving body goes
//! to rest, another actuator goes to rest, the same actuators go to their other ends, a part is removed. The first
//! change that clears the motion is the advice.

use super::actuator::{Actuator, Position};
use super::judge::judge;
use super::motion::Motion;
use super::part::Role;
use super::refusal::words;
use super::scene::Scene;
use super::situation::Situation;
use super::space::Space;
use super::sweep::FirstContact;

/// Returns the remedy in words for a mechanic.
pub(super) fn advice(
    scene: &Scene,
    space: &mut Space,
    situation: &Situation,
    motion: &Motion,
    finding: &FirstContact,
) -> String {
    let mut helps =
        |tried: &Situation| judge(scene, space, motion, tried).is_ok_and(|found| found.is_none());
    let order = by_relevance(scene, motion, finding);
    for to_end in [false, true] {
        for actuator in &order {
            let axis = scene.axis(*actuator);
            let (mm, words) = if to_end {
                (axis.stroke_mm.1, &axis.to_end)
            } else {
                (0.0, &axis.to_rest)
            };
            let there = Some(Position::At(mm));
            if situation.position(*actuator) != there
                && helps(&situation.with(*actuator, Position::At(mm)))
            {
                return format!("would help: {words}");
            }
        }
    }
    for role in Role::ALL {
        if let Some(without) = without_part(situation, role)
            && helps(&without)
        {
            return format!("would help: take out {}", words(role.id()));
        }
    }
    "no single action makes room: bring every actuator to rest and look for what is in the way"
        .to_owned()
}

/// Returns every actuator that the motion does not use, those that carry the two bodies first.
fn by_relevance(scene: &Scene, motion: &Motion, finding: &FirstContact) -> Vec<Actuator> {
    let blocker = finding
        .blocker
        .map(|number| scene.rides(number))
        .unwrap_or_default();
    let mover = scene.rides(finding.mover);
    let mut order: Vec<Actuator> = Vec::with_capacity(Actuator::ALL.len());
    let concerned = blocker.iter().chain(mover).map(|ride| ride.actuator);
    for actuator in concerned.chain(Actuator::ALL) {
        if motion.target_mm(actuator).is_none() && !order.contains(&actuator) {
            order.push(actuator);
        }
    }
    order
}

fn without_part(situation: &Situation, role: Role) -> Option<Situation> {
    let mut without = *situation;
    let place = match role {
        Role::Feed => return None,
        Role::Pocket => &mut without.parts.pocket,
        Role::Pusher => &mut without.parts.on_pusher,
        Role::Nest => &mut without.parts.nest,
        Role::Gripper => &mut without.parts.gripper,
    };
    std::mem::take(place).then_some(without)
}
