//! Lower bounds that stored curves prove for a parameter without a value: as long as the contact has not moved, the
//! threshold or time exceeds what the curve shows.
//!
//! | parameter | is at least |
//! |---|---|
//! | operate voltage | the greatest supply command that left NO of the driven coil open, up to the last sample before the next change of a command; stages wait for the end of a ramp |
//! | operate time | from the drive at nominal voltage to the last sample with NO open |
//! | release time | from the last switch-off to the last sample with NC open |
//!
//! A bound is neither corrected nor converted to the reference temperature, so it decides only with the margin
//! [`DOUBT`].

use super::Parameter;
use super::points::{AnalogOut, BOARD, DigitalOut};
use crate::instrument::curve::Curve;

/// Margin as a share of the bound. It covers a copper temperature 5 K from the reference (2 %), the tolerance of the
/// supply, and one poll of the board.
pub const DOUBT: f64 = 0.03;
/// Supply command, as a share of the nominal voltage, from which the coil counts as driven at nominal.
const NOMINAL: f64 = 0.98;

/// Returns the lower bound of `parameter` in its unit, for a coil of `nominal_v`; `None` when the curves prove nothing.
pub fn at_least(curves: &[Curve], parameter: Parameter, nominal_v: f64) -> Option<f64> {
    let proven = Bounds::of(curves, nominal_v);
    let ms = |us: i64| us as f64 / 1e3;
    let bounds = [
        (Parameter::OperateVoltage, proven.unmoved_v),
        (Parameter::OperateTime, proven.unmade_us.map(ms)),
        (Parameter::ReleaseTime, proven.unreleased_us.map(ms)),
    ];
    let bound = bounds.into_iter().find(|(of, _)| *of == parameter);
    bound.and_then(|(_, at_least)| at_least)
}

enum Event {
    /// Command of a supply output, by its index in [`SUPPLY`], volts.
    Command(usize, f64),
    /// Drive on or off.
    Drive(bool),
    /// Contacts NO and NC, true when closed.
    Contacts { no: bool, nc: bool },
}

#[derive(Default)]
struct Bounds {
    unmoved_v: Option<f64>,
    unmade_us: Option<i64>,
    unreleased_us: Option<i64>,
}

const SUPPLY: [AnalogOut; 3] = [
    AnalogOut::SupplyLevel,
    AnalogOut::SupplyCoarse,
    AnalogOut::SupplyFine,
];

impl Bounds {
    fn of(curves: &[Curve], nominal_v: f64) -> Self {
        let mut seen = Self::default();
        let mut commands = [0.0; SUPPLY.len()];
        let (mut driven, mut since_us) = (false, None);
        let mut open = false;
        for (at_us, event) in events(curves) {
            let total: f64 = commands.iter().sum();
            match event {
                Event::Command(output, volts) => {
                    seen.unmoved(driven && open, total);
                    open = false;
                    commands[output] = volts;
                }
                Event::Drive(on) if on != driven => {
                    seen.unmoved(driven && open, total);
                    open = false;
                    driven = on;
                    since_us = (!on || total >= NOMINAL * nominal_v).then_some(at_us);
                    if !on {
                        seen.unreleased_us = None;
                    }
                }
                Event::Drive(_) => {}
                Event::Contacts { no, nc } => {
                    open = !no;
                    let waited = since_us.map(|since| at_us - since);
                    match (driven, no, nc) {
                        (true, false, _) => seen.unmade_us = waited.or(seen.unmade_us),
                        (true, true, _) => since_us = None,
                        (false, _, false) => seen.unreleased_us = waited,
                        (false, _, true) => since_us = None,
                    }
                }
            }
        }
        seen.unmoved(driven && open, commands.iter().sum());
        seen
    }

    fn unmoved(&mut self, is_so: bool, volts: f64) {
        if is_so {
            self.unmoved_v = Some(self.unmoved_v.map_or(volts, |most| most.max(volts)));
        }
    }
}

fn events(curves: &[Curve]) -> Vec<(i64, Event)> {
    let mut events = Vec::new();
    for curve in curves {
        let supply = SUPPLY.iter().position(|it| it.name() == curve.signal);
        let samples = curve.samples().filter_map(|(at, value)| Some((at, value?)));
        for (at, value) in samples {
            let bit = |n: u32| value as u64 >> n & 1 == 1;
            if let Some(output) = supply {
                events.push((at, Event::Command(output, value)));
            } else if curve.signal == DigitalOut::CoilDrive.name() {
                events.push((at, Event::Drive(bit(0))));
            } else if curve.signal == BOARD {
                let (no, nc) = (bit(0), bit(1));
                events.push((at, Event::Contacts { no, nc }));
            }
        }
    }
    events.sort_by_key(|(at, _)| *at);
    events
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dut::characteristic::KindCharacteristic;

    fn curve(signal: &str, samples: &[(i64, f64)]) -> Curve {
        Curve {
            signal: signal.into(),
            unit: String::new(),
            begin_us: 1_000_000,
            t_us: samples.iter().map(|(ms, _)| ms * 1_000).collect(),
            values: samples.iter().map(|(_, value)| Some(*value)).collect(),
        }
    }

    const RESTS: f64 = 2.0;
    const MADE: f64 = 1.0;
    const BETWEEN: f64 = 0.0;

    #[test]
    fn the_top_of_a_ramp_bounds_the_operate_voltage() {
        let curves = [
            curve("supply_level", &[(0, 5.0)]),
            curve("supply_coarse", &[(20, 6.0), (200, 0.0)]),
            curve("coil_drive", &[(5, 1.0), (210, 0.0)]),
            curve("board", &[(10, RESTS), (100, RESTS), (190, RESTS)]),
        ];
        let bound = |parameter| at_least(&curves, parameter, 12.0);
        assert_eq!(bound(Parameter::OperateVoltage), Some(11.0));
        assert_eq!(
            bound(Parameter::OperateTime),
            None,
            "never at nominal voltage"
        );
        let sure = Parameter::OperateVoltage.lower_bound(&curves, Some(12.0));
        assert!(sure.is_some_and(|volts| volts > 10.6 && volts < 10.7));
    }

    #[test]
    fn a_make_bounds_by_the_voltage_before_it() {
        let curves = [
            curve("supply_level", &[(0, 5.0), (50, 7.0), (100, 9.0)]),
            curve("coil_drive", &[(5, 1.0)]),
            curve("board", &[(10, RESTS), (90, RESTS), (150, MADE)]),
        ];
        let bound = at_least(&curves, Parameter::OperateVoltage, 12.0);
        assert_eq!(bound, Some(7.0));
    }

    #[test]
    fn a_contact_that_does_not_come_bounds_its_time() {
        let curves = [
            curve("supply_level", &[(0, 12.0)]),
            curve("coil_drive", &[(10, 1.0), (60, 0.0), (70, 0.0)]),
            curve(
                "board",
                &[
                    (5, RESTS),
                    (20, BETWEEN),
                    (55, BETWEEN),
                    (65, BETWEEN),
                    (90, BETWEEN),
                ],
            ),
        ];
        let bound = |parameter| at_least(&curves, parameter, 12.0);
        assert_eq!(bound(Parameter::OperateTime), Some(45.0));
        assert_eq!(bound(Parameter::ReleaseTime), Some(30.0));
        assert_eq!(bound(Parameter::OperateVoltage), Some(12.0));
    }

    #[test]
    fn a_good_part_is_bounded_by_its_own_times() {
        let curves = [
            curve("supply_level", &[(0, 12.0)]),
            curve("coil_drive", &[(10, 1.0), (60, 0.0)]),
            curve("board", &[(12, RESTS), (16, MADE), (61, MADE), (64, RESTS)]),
        ];
        let bound = |parameter| at_least(&curves, parameter, 12.0);
        assert_eq!(bound(Parameter::OperateTime), Some(2.0));
        assert_eq!(bound(Parameter::ReleaseTime), Some(1.0));
    }

    #[test]
    fn without_curves_there_is_no_bound() {
        for parameter in Parameter::ALL {
            assert_eq!(at_least(&[], parameter, 12.0), None);
        }
    }
}
