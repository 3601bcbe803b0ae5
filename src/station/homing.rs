//! Homing: every actuator to its rest end, in an order that never meets another one.
//!
//! Servo on; z up before anything else moves in the nest; then probes down, pusher back, jaws open,
//! fingers open, axis over the nest. A part found in nest or gripper at the start is an alarm.

use super::moves::Move;
use super::trouble::Alarm;
use super::turn::Turn;
use crate::rig::axis::AxisStation;
use crate::rig::point::{DigitalIn, DigitalOut};

const ORDER: [Move; 7] = [
    Move::SortUp,
    Move::ProbesDown,
    Move::PusherRetract,
    Move::EscapementHold,
    Move::ClampOpen,
    Move::GripperOpen,
    Move::AxisTo(AxisStation::Nest),
];

/// How far homing has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Homing {
    step: usize,
    asked: bool,
    checked: bool,
}

impl Homing {
    /// One turn; true when everything is home.
    pub fn step(&mut self, turn: &mut Turn) -> bool {
        if !self.checked {
            let (nest, gripper) = (
                turn.input(DigitalIn::NestPresent),
                turn.input(DigitalIn::GripperPart),
            );
            let (Some(nest), Some(gripper)) = (nest, gripper) else {
                return false;
            };
            if nest {
                turn.alarm(Alarm::not_empty("nest"));
            } else if gripper {
                turn.alarm(Alarm::not_empty("gripper"));
            }
            turn.wants.outputs.push((DigitalOut::AxisServoOn, true));
            self.checked = true;
            return false;
        }
        let Some(movement) = ORDER.get(self.step) else {
            return true;
        };
        if turn.arrived(*movement) {
            self.step += 1;
            self.asked = false;
        } else if !self.asked {
            turn.drive(*movement);
            self.asked = true;
        }
        self.step == ORDER.len()
    }
}
