//! Places of parts between magazine and bin.

/// Number of a nest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NestId(pub u8);

impl NestId {
    /// The only nest, or the first of several.
    pub const FIRST: Self = Self(0);
}

/// A place for one part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Place {
    /// Between escapement and pusher; a part has no number yet.
    Pocket,
    /// Test position.
    Nest(NestId),
    /// Between the fingers.
    Gripper,
    /// Released, on the way to the beam of a bin.
    Falling,
    /// Socket that a person fills, by number.
    Socket(u16),
}

impl Place {
    /// The only nest, or the first of several.
    pub const NEST: Self = Self::Nest(NestId::FIRST);

    /// Returns the name in alarms and views; every nest is `nest`.
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
