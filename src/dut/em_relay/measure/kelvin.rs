//! Kelvin check and pin map: every pin has its force and sense contact, and the contacts rest.
//!
//! | seen | meaning |
//! |---|---|
//! | one bit open | missing pin or dirty probe: void |
//! | COM open, the other four good | a turned part, or a dirty COM probe: void |
//! | five good, NC open or NO closed | a contact that does not rest: fail, contact |

use super::{Bench, Findings, Stage, board};
use crate::dut::em_relay::bins;
use crate::instrument::act::{Act, Read, Readings};
use crate::rig::point::DigitalOut::KelvinTest;
use crate::units::Span;

const PINS: [&str; 5] = ["coil A", "coil B", "COM", "NO", "NC"];
const COM: usize = 2;

pub(super) fn acts() -> Vec<Act> {
    vec![
        board(&[(KelvinTest, true)]),
        Act::Wait(Span::ms(1)),
        Act::Read(Read::Board),
    ]
}

pub(super) fn conclude(_: &Bench, readings: &Readings, findings: &mut Findings) -> Option<Stage> {
    let Some(seen) = readings.boards.first() else {
        findings.void("interface board not read");
        return None;
    };
    if !seen.probe_chain {
        findings.void("probe-up chain open");
        return None;
    }
    let open: Vec<usize> = (0..5).filter(|pin| !seen.kelvin[*pin]).collect();
    match open.as_slice() {
        [] if seen.nc_closed && !seen.no_closed => {}
        [] if seen.no_closed => findings.fail("contact stuck: NO closed at rest", bins::CONTACT),
        [] => findings.fail("contact stuck: NC open at rest", bins::CONTACT),
        [COM] => findings.void("part turned or COM probe without contact"),
        [pin] => findings.void(format!(
            "no Kelvin contact at {}: missing pin or dirty probe",
            PINS[*pin]
        )),
        several => {
            let names: Vec<&str> = several.iter().map(|pin| PINS[*pin]).collect();
            findings.void(format!("no Kelvin contact at {}", names.join(", ")));
        }
    }
    None
}
