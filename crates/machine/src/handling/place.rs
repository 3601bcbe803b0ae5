//! Places of parts between magazine and bin.

/// Which nest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NestId(pub u8);

impl NestId {
    /// The nest of a rig that has one, and the first of one that has several.
    pub const FIRST: Self = Self(0);
}

/// Where a part may be. Each place holds one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Place {
    /// Between escapement and pusher; parts have no number there.
    Pocket,
    /// Where parts are tested.
    Nest(NestId),
    /// Between the fingers.
    Gripper,
    /// Let go, on the way to the beam of a bin.
    Falling,
    /// A socket that a person fills, by its number.
    Socket(u16),
}

impl Place {
    /// The nest of a rig that has one.
    pub const NEST: Self = Self::Nest(NestId::FIRST);

    /// The name in alarms and views; every nest is `nest`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pocket => "pocket",
            Self::Nest(_) => "nest",
            Self::Gripper => "gripper",
            Self::Falling => "falling",
            Self::Socket(_) => "socket",
        }
    }
}
