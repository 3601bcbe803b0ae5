//! Trouble of feeder and mechanism, as data; the station makes an alarm of it, with its texts.

use super::moves::Move;
use super::place::Place;
use crate::rig::bin::Bin;
use units::Span;

/// What went wrong, and with what.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Trouble {
    /// A stroke did not show its end within its time, at the second try where there is one.
    NotReached(Move, Span),
    /// A stroke did not arrive in time and is tried once more.
    Retried(Move, Span),
    /// An actuator left its end by itself.
    LeftEnd(Move),
    /// Both ends of an actuator are seen at once.
    BothEnds(Move),
    /// The drive of the sort axis has tripped.
    AxisDrive,
    /// No part came into the pocket although parts wait in the track.
    NoPart,
    /// No part came, and none waits.
    MagazineEmpty,
    /// The pusher is at a nest that shows no part.
    NestEmpty,
    /// The beam of a bin counted so many parts where one was let go.
    Beam(Bin, u32),
    /// A part that does not belong to this run.
    Found(Place),
    /// A part that was there is nowhere.
    Lost(Place),
    /// A part that a run before left there is nowhere.
    Gone(Place),
    /// A run before let a part go, and no beam had confirmed it.
    FallUnseen(Bin),
    /// The fingers lost their part.
    Dropped,
    /// The open fingers still hold their part.
    Sticks,
    /// The part of a nest that the fingers should have taken is still there.
    Stuck,
    /// A golden part is tested again: its serial, and why.
    GoldenRepeated(String, String),
}
