//! Signals of the mechanism's sensors.

use super::{CylinderId, Mechanism};
use crate::world::fault::Fault;
use crate::world::signal::In;

/// Off time of a loose contact, microseconds; its on time is three times as long.
const FLICKER_US: u64 = 10_000;

impl Mechanism {
    /// Returns a signal of the mechanism; `None` for a signal of another source.
    pub fn signal(&self, signal: In, now_us: u64) -> Option<bool> {
        let rest = |s: CylinderId| Some(self.at(s).at_rest(now_us));
        let far = |s: CylinderId| Some(self.at(s).at_far(now_us));
        match signal {
            In::EmergencyStopOk => Some(!self.is_disturbed(Fault::Estop)),
            In::DoorClosed => Some(!self.is_disturbed(Fault::Door)),
            In::AirOk => Some(self.has_air()),
            In::EscapementHold => rest(CylinderId::Escapement),
            In::PocketPresent => Some(self.places.pocket.is_some()),
            In::TrackLevel if self.is_disturbed(Fault::Starved) => Some(false),
            In::TrackLevel => Some(self.magazine.waiting() >= self.table.track_level_parts),
            In::PusherRetracted if self.is_disturbed(Fault::SensorBounce) => Some(
                self.at(CylinderId::Pusher).at_rest(now_us)
                    && !(now_us / FLICKER_US).is_multiple_of(4),
            ),
            In::PusherRetracted => rest(CylinderId::Pusher),
            In::PusherExtended if self.is_disturbed(Fault::SensorStuck) => Some(true),
            In::PusherExtended => far(CylinderId::Pusher),
            In::NestPresent => Some(self.places.nest.is_some()),
            In::JawLeftOpen => rest(CylinderId::JawLeft),
            In::JawLeftClosed => far(CylinderId::JawLeft),
            In::JawRightOpen => rest(CylinderId::JawRight),
            In::JawRightClosed => far(CylinderId::JawRight),
            In::ProbeDown if self.is_disturbed(Fault::SensorLost) => Some(false),
            In::ProbeDown => rest(CylinderId::ProbeLift),
            In::ProbeUp => far(CylinderId::ProbeLift),
            In::AxisInPosition => Some(self.axis.is_in_position()),
            In::AxisBusy => Some(self.axis.is_moving()),
            In::AxisAlarm => Some(self.axis.is_alarmed()),
            In::SortZUp => rest(CylinderId::SortZ),
            In::SortZDown => far(CylinderId::SortZ),
            In::GripperOpen => rest(CylinderId::Gripper),
            In::GripperPart => Some(self.places.gripped || self.places.carried.is_some()),
            In::ButtonStart => Some(self.is_disturbed(Fault::StartButton)),
            In::ButtonReset => Some(self.is_disturbed(Fault::ResetButton)),
            In::ButtonStop => Some(self.is_disturbed(Fault::StopButton)),
            In::BeamPass if self.is_disturbed(Fault::BinFull) => Some(true),
            In::BeamPass
            | In::BeamCoil
            | In::BeamVoltage
            | In::BeamTime
            | In::BeamContact
            | In::BeamInput
            | In::BeamOutput
            | In::BeamLeakage
            | In::BeamRetest => Some(self.dark.contains(&signal)),
            _ => None,
        }
    }
}
