//! Readings of a stage, sorted into board inputs, scans of the coil and pairs of counters.

use super::points::{AnalogIn, Counter, DigitalIn, Points};
use crate::instrument::readings::Readings as ByPoint;
use crate::rig::sample::{CountSample, Sample};
use crate::rig::supply::code_of;

/// Inputs of the interface board at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BoardInputs {
    /// True where force and sense contact of a pin are connected by less than 5 ohm: coil A, coil B, COM, NO, NC.
    pub kelvin: [bool; 5],
    /// True when the normally open contact is closed.
    pub no_closed: bool,
    /// True when the normally closed contact is closed.
    pub nc_closed: bool,
    /// True when the contact source cannot drive its current.
    pub compliance: bool,
    /// True when the hard-wired chain reports the probes up.
    pub probe_chain: bool,
    /// Code of the supply range; `None` on a rig with one range.
    pub range: Option<u8>,
}

/// One scan of the coil converter; `None` for a channel outside the scan. The stated current ranges are those of the
/// shipped rig.
#[derive(Debug, Clone)]
pub struct CoilScan {
    /// Coil voltage.
    pub voltage_fine: Option<Sample>,
    /// Coil current, up to 16 mA.
    pub current_fine: Option<Sample>,
    /// Coil current, up to 50 mA.
    pub current_wide: Option<Sample>,
    /// Coil current, up to 166 mA.
    pub current_high: Option<Sample>,
    /// The 5 V reference.
    pub reference: Option<Sample>,
    /// The supply in front of the drive.
    pub supply: Option<Sample>,
}

/// All readings of a stage, sorted by type, each type in order of time.
#[derive(Debug, Clone, Default)]
pub struct Readings {
    /// Board inputs.
    pub boards: Vec<BoardInputs>,
    /// Scans of the coil converter.
    pub coil: Vec<CoilScan>,
    /// Coil currents, of scans and of single readings.
    pub currents: Vec<Sample>,
    /// Contact drops.
    pub drops: Vec<Sample>,
    /// Gate counters 0 and 1.
    pub gates: Vec<[CountSample; 2]>,
    /// For each awaited input, true when it became active in time.
    pub seen: Vec<bool>,
    /// Track temperatures.
    pub track: Vec<Sample>,
}

impl Readings {
    /// Sorts the readings of a stage by type; `before` holds the last counts of the previous stage.
    pub fn of(read: &ByPoint, points: &Points, before: Option<[CountSample; 2]>) -> Self {
        let analog = |input| analog(read, points, input);
        let count = |counter| read.counts(points.counter(counter)).cloned();
        let gates = count(Counter::Gate0).zip(count(Counter::Gate1));
        let gates = gates.map(|(first, second)| [first, second]);
        let currents = analog(AnalogIn::CoilCurrentFine)
            .chain(analog(AnalogIn::CoilCurrent))
            .chain(analog(AnalogIn::CoilCurrentHigh));
        Self {
            boards: boards(read, points),
            coil: scans(read, points),
            currents: currents.collect(),
            drops: analog(AnalogIn::ContactDrop).collect(),
            gates: before.into_iter().chain(gates).collect(),
            seen: read.seen.clone(),
            track: read.temperatures(points.track).cloned().collect(),
        }
    }
}

/// Yields the samples of an analog input; yields nothing where the rig lacks the input.
fn analog<'a>(
    read: &'a ByPoint,
    points: &Points,
    input: AnalogIn,
) -> impl Iterator<Item = Sample> + use<'a> {
    let input = points.wired_analog(input).into_iter();
    input.flat_map(|input| read.analog(input)).cloned()
}

fn boards(read: &ByPoint, points: &Points) -> Vec<BoardInputs> {
    let states = |point| read.states(points.input(point));
    let mut kelvin = [
        DigitalIn::KelvinCoilA,
        DigitalIn::KelvinCoilB,
        DigitalIn::KelvinCom,
        DigitalIn::KelvinNo,
        DigitalIn::KelvinNc,
    ]
    .map(states);
    let mut range = points
        .range
        .as_ref()
        .map(|it| it.inputs.map(|bit| read.states(bit)));
    let contacts = states(DigitalIn::NoClosed).zip(states(DigitalIn::NcClosed));
    let board = states(DigitalIn::SourceCompliance).zip(states(DigitalIn::ProbeChain));
    let board = contacts.zip(board);
    board
        .map(
            |((no_closed, nc_closed), (compliance, probe_chain))| BoardInputs {
                // The board's inputs arrive in one reading.
                kelvin: kelvin.each_mut().map(|pin| pin.next() == Some(true)),
                no_closed,
                nc_closed,
                compliance,
                probe_chain,
                range: range
                    .as_mut()
                    .map(|bits| code_of(bits.each_mut().map(|bit| bit.next() == Some(true)))),
            },
        )
        .collect()
}

fn scans(read: &ByPoint, points: &Points) -> Vec<CoilScan> {
    let channel = |input| analog(read, points, input);
    let mut fine = channel(AnalogIn::CoilCurrentFine);
    let mut wide = channel(AnalogIn::CoilCurrent);
    let mut high = channel(AnalogIn::CoilCurrentHigh);
    let mut reference = channel(AnalogIn::ReferenceVoltage);
    let mut supply = channel(AnalogIn::SupplyVoltage);
    channel(AnalogIn::CoilVoltageFine)
        .map(|voltage| CoilScan {
            voltage_fine: Some(voltage),
            current_fine: fine.next(),
            current_wide: wide.next(),
            current_high: high.next(),
            reference: reference.next(),
            supply: supply.next(),
        })
        .collect()
}
