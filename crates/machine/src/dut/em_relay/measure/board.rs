//! State of interface board, coil supply and armature between two stages of a test.
//!
//! Each stage builds its acts on the state that the stage before left, and returns the state that these acts leave. Its
//! conclusion corrects that state when the part has not moved as planned.
//!
//! "The mark" is the last instant marked by any stage. ARM is the output `arm`: its rising edge makes the board wait
//! for the next contact event.

use super::{Context, INTERLOCK, set};
use crate::dut::em_relay::act::Act;
use crate::dut::em_relay::points::DigitalOut::{
    Arm, ClampDiode, CoilDrive, SourceOn, SourceReverse,
};
use crate::dut::em_relay::recipe::Suppression;
use crate::dut::em_relay::supply::Supply;
use units::{Span, Volt};

/// Rounding error of a difference between two sums of the same three voltages, volts.
const ROUNDING_V: f64 = 1e-6;

/// State of board and supply between two stages.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoardState {
    /// Commanded voltages of the supply.
    pub supply: Supply,
    /// State of drive and armature.
    pub armature: Armature,
    /// The ramp that the present stage sends.
    pub ramp: Option<SentRamp>,
    /// Time from the last `Act::Mark` to the end of the last ramp, if no stage has waited for that end yet.
    pub still_ramping: Span,
}

/// State of drive and armature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Armature {
    /// Unknown: the next stage first takes the drive off or seals the armature.
    Unknown,
    /// At rest with the drive off, supply at nominal, source on, board armed, counters read: switching the drive on
    /// starts a timed operation.
    ReadyForTiming,
    /// At rest on the pre-bias, armed in ramp mode: the coarse operate ramp may begin.
    ReadyForRamp,
    /// Operated after the last `Act::Mark`, and driven.
    Operated,
    /// Released: the drive went off at the last `Act::Mark` or before it.
    Released,
    /// Released, and the supply at the start level of the next part: the last stage only checks the coil current.
    Rested,
}

/// Ramp from ARM to its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SentRamp {
    /// Supply voltage when the board was armed.
    pub start: Volt,
    /// Distance that the supply moves from `start`, positive.
    pub span: Volt,
    /// Longest time until the output arrives at the end of the ramp.
    pub takes: Span,
}

impl Armature {
    /// Returns true when the drive went off at the last `Act::Mark` or before it.
    pub fn is_released(self) -> bool {
        match self {
            Self::ReadyForTiming | Self::Released | Self::Rested => true,
            Self::Unknown | Self::ReadyForRamp | Self::Operated => false,
        }
    }
}

impl BoardState {
    /// Returns the state before a test: all outputs at zero.
    pub fn new(context: &Context) -> Self {
        Self {
            supply: Supply::new(&context.calibration),
            armature: Armature::Unknown,
            ramp: None,
            still_ramping: Span(0),
        }
    }

    /// Returns the ramp of the stage that has just ended; panics when it has sent none.
    pub fn sent(&self) -> SentRamp {
        let Some(ramp) = self.ramp else {
            panic!("a stage concludes a ramp that it has not sent");
        };
        ramp
    }

    /// Panics when the commanded supply contradicts the state of the armature.
    pub fn check(&self, context: &Context) {
        let test = &context.relay.test;
        let supply_v = match self.armature {
            Armature::ReadyForTiming => Some(context.relay.part.nominal_v),
            Armature::ReadyForRamp | Armature::Rested => Some(test.prebias_v),
            Armature::Unknown | Armature::Operated | Armature::Released => None,
        };
        let off_v = supply_v.map_or(0.0, |volts| (self.supply.total().0 - volts).abs());
        assert!(off_v < ROUNDING_V, "{off_v} V off: {self:?}");
        let ramps_rest = matches!(self.armature, Armature::ReadyForRamp | Armature::Rested);
        assert!(!ramps_rest || self.supply.ramps_are_down(), "{self:?}");
        assert!(
            self.ramp.is_none_or(|ramp| ramp.span > Volt(0.0)),
            "{self:?}"
        );
    }
}

/// Selects the coil suppression of the recipe when `on`, else the zener; returns no act for a recipe that uses the
/// zener. The board switches the suppression only below 1 mA of coil current.
pub(super) fn select_diode(context: &Context, on: bool) -> Option<Act> {
    match context.relay.test.suppression {
        Suppression::Zener => None,
        Suppression::Diode => Some(set(&[(ClampDiode, on)])),
    }
}

/// Takes the drive off and marks the instant; returns no acts when the drive is off already.
pub(super) fn drive_off(armature: Armature) -> Vec<Act> {
    if armature.is_released() {
        return Vec::new();
    }
    let off = [
        (SourceOn, false),
        (SourceReverse, false),
        (CoilDrive, false),
        (Arm, false),
    ];
    vec![set(&off), Act::Wait(INTERLOCK), Act::Mark]
}
