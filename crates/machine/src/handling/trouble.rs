//! Troubles of feeder and mechanism, as data; the station turns them into alarms with texts.

use super::moves::Move;
use super::place::Place;
use crate::dut::Reason;
use crate::dut::batch::BatchTrouble;
use crate::rig::bin::Bin;
use crate::rig::supply::RangeMismatch;
use units::Span;

/// A trouble, with the motion, place, bin or part concerned.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Trouble {
    /// A stroke, or its repetition if there is one, did not reach its end within this time.
    NotReached(Move, Span),
    /// A stroke did not reach its end within this time and is repeated.
    Retried(Move, Span),
    /// An actuator left its end without a command.
    LeftEnd(Move),
    /// Both end sensors of an actuator are on.
    BothEnds(Move),
    /// The drive of the sort axis has tripped.
    AxisDrive,
    /// No part came into the pocket although parts wait in the track.
    NoPart,
    /// No part came, and the sensor of the track shows none.
    MagazineEmpty,
    /// The pusher is at a nest whose sensor shows no part.
    NestEmpty,
    /// The beam of a bin counted this number of parts after one release.
    Beam(Bin, u32),
    /// A part that does not belong to this run was found in this place.
    Found(Place),
    /// A part has disappeared from this place.
    Lost(Place),
    /// A part that an earlier run left in this place has disappeared.
    Gone(Place),
    /// An earlier run released a part over this bin without a confirmation by its beam.
    FallUnseen(Bin),
    /// The fingers lost their part.
    Dropped,
    /// The open fingers still hold their part.
    Sticks,
    /// The fingers closed, but the part is still in the nest.
    Stuck,
    /// A reference part is tested again: serial number and reason.
    ReferenceRepeated(String, Reason),
    /// The supply is in another range than the one selected.
    SupplyRange(RangeMismatch),
    /// A test has ended without proof that the socket is free of dangerous voltage.
    SocketLive,
    /// The closed door of the rack does not show that it is locked.
    DoorNotLocked,
    /// The thermometer in the rack has had no usable reading for too long.
    RackUnread,
    /// The reading of the thermometer in the rack stands still while the temperature of the air changes.
    RackStuck,
    /// The rack has not cooled within this time; it goes on cooling.
    CoolsSlowly(Span),
    /// The test of a batch has met trouble of the rig.
    Batch(BatchTrouble),
    /// The step of this name in family `step` has taken this long.
    TooLong(&'static str, Span),
}
