//! States of the fixture, and the acts that bring it from one to another while the sources are off.

use crate::dut::ssr::points::{Device, DigitalOut, Points};
use crate::instrument::act::Act;
use units::Span;

/// Time until the relays of the fixture have switched and ceased to bounce.
pub const RELAY: Span = Span::ms(5);

/// Connections of the fixture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Position {
    /// Control input at its source; output at nothing, discharged.
    #[default]
    Isolated,
    /// Output at its source through 1 kohm.
    Load,
    /// Output at its source through 1 kohm; pulse source at the control input.
    Pulsed,
    /// Output at its source, four wires.
    Direct,
    /// The line feeds the output; the SMU drives the control input.
    Line,
    /// The line feeds the output; the pulse source drives the control input.
    LinePulsed,
    /// The loop feeds the output with its rated current.
    Loop,
}

impl Position {
    /// Returns the outputs that are on.
    pub const fn outputs(self) -> &'static [DigitalOut] {
        use DigitalOut::{
            BleedOpen, DriveSelect, LineContactor, LoopContactor, SmuLoad, SmuToOutput,
        };
        match self {
            Self::Isolated => &[],
            Self::Load => &[BleedOpen, SmuToOutput, SmuLoad],
            Self::Pulsed => &[BleedOpen, SmuToOutput, SmuLoad, DriveSelect],
            Self::Direct => &[BleedOpen, SmuToOutput],
            Self::Line => &[BleedOpen, LineContactor],
            Self::LinePulsed => &[BleedOpen, LineContactor, DriveSelect],
            Self::Loop => &[BleedOpen, LoopContactor],
        }
    }

    /// Returns true when one of the contactors is closed.
    pub const fn is_on_mains(self) -> bool {
        match self {
            Self::Line | Self::LinePulsed | Self::Loop => true,
            Self::Isolated | Self::Load | Self::Pulsed | Self::Direct => false,
        }
    }
}

/// Returns the acts that bring the fixture to a position with both sources off; none when it is there already.
pub fn change(points: &Points, from: Position, to: Position) -> Vec<Act> {
    if from == to {
        return Vec::new();
    }
    let mut acts = Vec::new();
    if from != Position::Isolated {
        let off = [Device::SmuIn, Device::SmuOut].map(|it| points.off(it));
        acts.push(Act::Query(off.to_vec()));
    }
    acts.push(Act::Set(points.outputs(to.outputs())));
    acts.push(Act::Wait(RELAY));
    acts
}
