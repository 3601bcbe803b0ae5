//! Kelvin check and pin map: tests that each pin has its force and sense contact, and that both contacts of the relay
//! are in their rest position.
//!
//! | seen | meaning |
//! |---|---|
//! | one bit open | missing pin or dirty probe: void |
//! | COM open, the other four good | a misoriented part, or a dirty COM probe: void |
//! | five good, NC open or NO closed | a contact out of its rest position: fail, contact |

use super::state::TestState;
use super::{Context, Stage, set};
use crate::dut::em_relay::Finding;
use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::points::DigitalOut::KelvinTest;
use crate::dut::em_relay::readings::Readings;
use crate::rig::supply::SWITCHING_TIMEOUT;
use units::Span;

/// Names of the pins in reasons; `coil A` and `coil B` have texts in each language, `pin-coil_A` and `pin-coil_B`.
const PINS: [&str; 5] = ["coil A", "coil B", "COM", "NO", "NC"];
const COM: usize = 2;

/// Returns the acts of the check. They also select the supply range, because no range is selected after safe outputs,
/// and all sources are at zero then, as the selection requires.
pub(super) fn acts(context: &Context) -> Vec<Act> {
    let (code, within) = (context.range_code(), SWITCHING_TIMEOUT);
    let read = match code {
        Some(code) => Act::ConfirmRange { code, within },
        None => Act::Read(Read::Board),
    };
    let mut acts = Vec::from_iter(code.map(Act::SelectRange));
    acts.extend([set(&[(KelvinTest, true)]), Act::Wait(Span::ms(1)), read]);
    acts
}

pub(super) fn conclude(readings: &Readings, state: &mut TestState) -> Option<Stage> {
    let record = &mut state.record;
    let Some(seen) = readings.boards.first() else {
        record.stop(Finding::BoardNotRead);
        return None;
    };
    if !seen.probe_chain {
        record.stop(Finding::ProbeChainOpen);
        return None;
    }
    let open: Vec<usize> = (0..5).filter(|pin| !seen.kelvin[*pin]).collect();
    match open.as_slice() {
        [] if seen.nc_closed && !seen.no_closed => {}
        [] if seen.no_closed => record.stop(Finding::NoClosedAtRest),
        [] => record.stop(Finding::NcOpenAtRest),
        [COM] => record.stop(Finding::Misoriented),
        [pin] => record.stop(Finding::PinOpen.with(PINS[*pin])),
        several => {
            let names: Vec<&str> = several.iter().map(|pin| PINS[*pin]).collect();
            record.stop(Finding::PinsOpen.with(names.join(", ")));
        }
    }
    None
}
