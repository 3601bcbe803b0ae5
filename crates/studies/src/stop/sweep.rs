//! The instants at which a lot presses the emergency stop, and the script that does so.

use super::LATE_MS;
use crate::order::Order;

/// Number of parts from one stop to the next: after a stop two parts go to retest, then the line runs evenly again.
const PARTS_BETWEEN: u64 = 5;
/// Time after a nest exit, seconds, when a test is half done: jaws closed, probes up, z down, the next part in the
/// pocket, so that homing has long strokes.
const MID_TEST_S: f64 = 1.0;
/// Orders of the operator after a stop: clear and reset.
const CLEAR: &str = "after state Aborted +4 order clear\nafter state Stopped order reset\n";
/// Order of the operator after [`CLEAR`]: start.
const START: &str = "after state Idle order start\n";

/// Interval over which the stops are spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sweep {
    /// A cycle, from nest exit to nest exit.
    Cycle,
    /// Homing and the discharge of the parts inside, after a stop in the middle of a test.
    Homing,
}

impl Sweep {
    /// Both sweeps, in the order of the report.
    pub const ALL: [Self; 2] = [Self::Cycle, Self::Homing];

    /// Returns the length of the swept interval with a margin, seconds.
    pub const fn span_s(self) -> f64 {
        match self {
            Self::Cycle => 2.0,
            Self::Homing => 3.5,
        }
    }

    /// Returns the name in the report.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cycle => "in a cycle",
            Self::Homing => "in homing",
        }
    }

    /// Returns the number of presses of the emergency stop that the script makes for one instant. Only the last press
    /// falls on that instant, and only the reaction to this press counts; an earlier press brings the rig into homing.
    pub const fn presses(self) -> usize {
        match self {
            Self::Cycle => 1,
            Self::Homing => 2,
        }
    }

    /// Returns the instants at which this lot presses the stop, seconds from the start of the swept interval. The lots
    /// of a sweep interleave their instants.
    pub fn instants(self, order: &Order, lot: u64) -> Vec<f64> {
        let all = (order.lots * order.parts) as f64;
        let instant = |stop: u64| self.span_s() * (stop * order.lots + lot) as f64 / all;
        (0..order.parts).map(instant).collect()
    }

    /// Returns the script of a lot; with `slow`, every reply comes [`LATE_MS`] late.
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
