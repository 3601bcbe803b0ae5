//! The motions of the machine by their shop-floor names, and the sensors that show their end.

use crate::guard::{Actuator, Motion, Position, Stroke};
use crate::rig::axis::AxisStation;
use crate::rig::bin::Bin;
use crate::rig::point::DigitalIn;
use crate::rig::stroke::ActuatorKey;

/// One motion of the machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Move {
    /// Escapement lets one part into the pocket.
    EscapementRelease,
    /// Escapement holds the track again.
    EscapementHold,
    /// Pusher takes the part from the pocket to the nest.
    PusherExtend,
    /// Pusher returns.
    PusherRetract,
    /// Both jaws of the nest close.
    ClampClose,
    /// Both jaws of the nest open.
    ClampOpen,
    /// Probes up to the pins.
    ProbesUp,
    /// Probes down.
    ProbesDown,
    /// Sort axis to a point of its table.
    AxisTo(AxisStation),
    /// Gripper down.
    SortDown,
    /// Gripper up.
    SortUp,
    /// Fingers close.
    GripperClose,
    /// Fingers open.
    GripperOpen,
}

/// Lengths of all strokes, mm, in the order of [`Actuator::ALL`], and x of the axis points.
#[derive(Debug, Clone, PartialEq)]
pub struct Strokes {
    /// Stroke of each actuator; the entry of the sort axis is unused.
    pub length_mm: [f64; 8],
    /// Least distance from an end at which its sensor goes off, mm, in the same order; 0 where it proves nothing.
    pub sensor_off_mm: [f64; 8],
    /// Position of each point of the sort axis, mm.
    pub axis_mm: Vec<(AxisStation, f64)>,
    /// True when the guard lets the probes rise beside a pusher whose end sensor is off.
    pub probes_beside_pusher: bool,
}

impl Strokes {
    /// Returns the full stroke of an actuator, mm.
    pub fn of(&self, actuator: Actuator) -> f64 {
        self.length_mm[actuator.index()]
    }

    /// Returns the position of a station, mm; NaN for one outside the table, which the guard refuses.
    pub fn axis(&self, station: AxisStation) -> f64 {
        self.axis_mm
            .iter()
            .find(|(known, _)| *known == station)
            .map_or(f64::NAN, |(_, x)| *x)
    }

    /// Returns the span of the whole axis.
    pub fn axis_span(&self) -> Position {
        let xs = self.axis_mm.iter().map(|(_, x)| *x);
        Position::Between {
            from_mm: xs.clone().fold(f64::INFINITY, f64::min),
            to_mm: xs.fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

impl Move {
    /// Returns the motion as actuators with their target positions, as guard and drive take it.
    pub fn motion(self, strokes: &Strokes) -> Motion {
        let full = |actuator| Motion::to(actuator, strokes.of(actuator));
        let rest = |actuator| Motion::to(actuator, 0.0);
        let jaws = |to: fn(&Strokes, Actuator) -> f64| {
            Motion::group(
                &[Actuator::JawLeft, Actuator::JawRight].map(|actuator| Stroke {
                    actuator,
                    to_mm: to(strokes, actuator),
                }),
            )
        };
        match self {
            Move::EscapementRelease => full(Actuator::Escapement),
            Move::EscapementHold => rest(Actuator::Escapement),
            Move::PusherExtend => full(Actuator::Pusher),
            Move::PusherRetract => rest(Actuator::Pusher),
            Move::ClampClose => jaws(|strokes, actuator| strokes.of(actuator)),
            Move::ClampOpen => jaws(|_, _| 0.0),
            Move::ProbesUp => full(Actuator::ProbeLift),
            Move::ProbesDown => rest(Actuator::ProbeLift),
            Move::AxisTo(station) => Motion::to(Actuator::SortAxis, strokes.axis(station)),
            Move::SortDown => full(Actuator::SortZ),
            Move::SortUp => rest(Actuator::SortZ),
            Move::GripperClose => full(Actuator::Gripper),
            Move::GripperOpen => rest(Actuator::Gripper),
        }
    }

    /// Returns the sensors that show the end of the motion, each with its state there.
    pub fn arrival(self) -> &'static [(DigitalIn, bool)] {
        match self {
            Move::EscapementRelease => &[(DigitalIn::EscapementHold, false)],
            Move::EscapementHold => &[(DigitalIn::EscapementHold, true)],
            Move::PusherExtend => &[
                (DigitalIn::PusherExtended, true),
                (DigitalIn::PusherRetracted, false),
            ],
            Move::PusherRetract => &[
                (DigitalIn::PusherRetracted, true),
                (DigitalIn::PusherExtended, false),
            ],
            Move::ClampClose => &[
                (DigitalIn::JawLeftClosed, true),
                (DigitalIn::JawRightClosed, true),
            ],
            Move::ClampOpen => &[
                (DigitalIn::JawLeftOpen, true),
                (DigitalIn::JawRightOpen, true),
            ],
            Move::ProbesUp => &[(DigitalIn::ProbeUp, true), (DigitalIn::ProbeDown, false)],
            Move::ProbesDown => &[(DigitalIn::ProbeDown, true), (DigitalIn::ProbeUp, false)],
            Move::AxisTo(_) => &[
                (DigitalIn::AxisInPosition, true),
                (DigitalIn::AxisBusy, false),
            ],
            Move::SortDown => &[(DigitalIn::SortZDown, true), (DigitalIn::SortZUp, false)],
            Move::SortUp => &[(DigitalIn::SortZUp, true), (DigitalIn::SortZDown, false)],
            Move::GripperClose => &[
                (DigitalIn::GripperPart, true),
                (DigitalIn::GripperOpen, false),
            ],
            Move::GripperOpen => &[(DigitalIn::GripperOpen, true)],
        }
    }

    /// Returns the stroke to rest that precedes a repetition of this one; `None` for a stroke to rest, and for one
    /// whose return would release a part in the wrong place.
    pub fn way_back(self) -> Option<Move> {
        match self {
            Move::EscapementRelease => Some(Move::EscapementHold),
            Move::PusherExtend => Some(Move::PusherRetract),
            Move::ClampClose => Some(Move::ClampOpen),
            Move::ProbesUp => Some(Move::ProbesDown),
            Move::SortDown => Some(Move::SortUp),
            Move::GripperClose => Some(Move::GripperOpen),
            Move::EscapementHold
            | Move::PusherRetract
            | Move::ClampOpen
            | Move::ProbesDown
            | Move::AxisTo(_)
            | Move::SortUp
            | Move::GripperOpen => None,
        }
    }

    /// Returns the sensors of the other end, if it has any; when they and those of the own end are on, a sensor is
    /// broken.
    pub fn other_end(self) -> &'static [DigitalIn] {
        match self {
            Move::PusherExtend => &[DigitalIn::PusherRetracted],
            Move::PusherRetract => &[DigitalIn::PusherExtended],
            Move::ClampClose => &[DigitalIn::JawLeftOpen, DigitalIn::JawRightOpen],
            Move::ClampOpen => &[DigitalIn::JawLeftClosed, DigitalIn::JawRightClosed],
            Move::ProbesUp => &[DigitalIn::ProbeDown],
            Move::ProbesDown => &[DigitalIn::ProbeUp],
            Move::SortDown => &[DigitalIn::SortZUp],
            Move::SortUp => &[DigitalIn::SortZDown],
            Move::GripperClose => &[DigitalIn::GripperOpen],
            Move::EscapementRelease
            | Move::EscapementHold
            | Move::AxisTo(_)
            | Move::GripperOpen => &[],
        }
    }

    /// Returns the target station of the sort axis; `None` for any other motion.
    pub fn station(self) -> Option<AxisStation> {
        let Move::AxisTo(station) = self else {
            return None;
        };
        Some(station)
    }

    /// Returns the actuator that performs the motion.
    pub const fn key(self) -> ActuatorKey {
        match self {
            Move::EscapementRelease | Move::EscapementHold => ActuatorKey::Escapement,
            Move::PusherExtend | Move::PusherRetract => ActuatorKey::Pusher,
            Move::ClampClose | Move::ClampOpen => ActuatorKey::Clamp,
            Move::ProbesUp | Move::ProbesDown => ActuatorKey::ProbeLift,
            Move::AxisTo(_) => ActuatorKey::Axis,
            Move::SortDown | Move::SortUp => ActuatorKey::SortZ,
            Move::GripperClose | Move::GripperOpen => ActuatorKey::Gripper,
        }
    }

    /// Returns the key of the actuator's time-out in `config/rig.toml`.
    pub const fn actuator_key(self) -> &'static str {
        self.key().name()
    }

    /// Returns the name in orders, views and alarms; the axis goes to a bin ([`Self::bin`]) as `axis_bin`.
    pub const fn code(self) -> &'static str {
        match self {
            Move::EscapementRelease => "escapement_release",
            Move::EscapementHold => "escapement_hold",
            Move::PusherExtend => "pusher_extend",
            Move::PusherRetract => "pusher_retract",
            Move::ClampClose => "clamp_close",
            Move::ClampOpen => "clamp_open",
            Move::ProbesUp => "probes_up",
            Move::ProbesDown => "probes_down",
            Move::SortDown => "sort_down",
            Move::SortUp => "sort_up",
            Move::GripperClose => "gripper_close",
            Move::GripperOpen => "gripper_open",
            Move::AxisTo(AxisStation::Nest) => "axis_nest",
            Move::AxisTo(AxisStation::Park) => "axis_park",
            Move::AxisTo(AxisStation::Bin(Bin::RETEST)) => "axis_retest",
            Move::AxisTo(AxisStation::Bin(_)) => "axis_bin",
        }
    }

    /// Returns the bin that the axis goes to; `None` for any other motion.
    pub fn bin(self) -> Option<Bin> {
        match self.station()? {
            AxisStation::Bin(bin) => Some(bin),
            AxisStation::Nest | AxisStation::Park => None,
        }
    }
}
