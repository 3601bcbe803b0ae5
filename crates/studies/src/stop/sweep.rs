//! Where the stops of a lot fall, and the script that presses them.

use super::LATE_MS;
use crate::order::Order;

/// Parts from one stop to the next: two go to retest, and the line is in step again.
const PARTS_BETWEEN: u64 = 5;
/// In the middle of a test: jaws closed, probes up, z down, the next part in the pocket. What is to be homed is far
/// from home.
const MID_TEST_S: f64 = 1.0;
/// A person clears, resets and starts anew.
const CLEAR: &str = "after state Aborted +4 order clear\nafter state Stopped order reset\n";
const START: &str = "after state Idle order start\n";

/// What the stops are spread over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sweep {
    /// A cycle, from one part that leaves the nest to the next.
    Cycle,
    /// Homing and the discharge of the parts inside, after a stop in the middle of a test.
    Homing,
}

impl Sweep {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Cycle, Self::Homing];

    /// Length of what is swept, seconds, and a little more.
    pub const fn span_s(self) -> f64 {
        match self {
            Self::Cycle => 2.0,
            Self::Homing => 3.5,
        }
    }

    /// In a report.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cycle => "in a cycle",
            Self::Homing => "in homing",
        }
    }

    /// Stops that are pressed for one instant; the last of them is the one that counts.
    pub const fn presses(self) -> usize {
        match self {
            Self::Cycle => 1,
            Self::Homing => 2,
        }
    }

    /// When the stops of a lot are pressed, seconds from the begin; lots lie between each other.
    pub fn instants(self, order: &Order, lot: u64) -> Vec<f64> {
        let all = (order.lots * order.parts) as f64;
        let instant = |stop: u64| self.span_s() * (stop * order.lots + lot) as f64 / all;
        (0..order.parts).map(instant).collect()
    }

    /// The story of a lot; `slow`: its replies come late.
    pub fn script(self, instants: &[f64], slow: bool) -> String {
        let parts = (instants.len() as u64 + 1) * PARTS_BETWEEN;
        let mut text = format!("# Emergency stops\nparts {parts}\n");
        if slow {
            text += &format!("fault delay={LATE_MS}\n");
        }
        for (part, instant) in (1..).map(|stop| stop * PARTS_BETWEEN).zip(instants) {
            text += &match self {
                Self::Cycle => {
                    format!("after left {part} +{instant:.4} fault estop\n{CLEAR}{START}")
                }
                Self::Homing => format!(
                    "after left {part} +{MID_TEST_S} fault estop\n{CLEAR}\
                     after state Resetting +{instant:.4} fault estop\n{CLEAR}{START}"
                ),
            };
        }
        text
    }
}
