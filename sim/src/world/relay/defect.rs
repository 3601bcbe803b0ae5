//! What can be wrong with a relay.

macro_rules! defects {
    ($($(#[$doc:meta])* $name:ident = $text:literal),* $(,)?) => {
        /// A defect of the simulated lot.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Defect { $($(#[$doc])* $name),* }

        impl Defect {
            /// Every kind.
            pub const ALL: &'static [Defect] = &[$(Defect::$name),*];

            /// Name in the truth.
            pub fn name(self) -> &'static str {
                match self { $(Defect::$name => $text),* }
            }
        }
    };
}

defects! {
    /// No current at all.
    OpenCoil = "open_coil",
    /// Resistance too low.
    ShortedTurns = "shorted_turns",
    /// A winding for another voltage.
    WrongCoil = "wrong_coil",
    /// Releases too low.
    WeakSpring = "weak_spring",
    /// Operates too high.
    StiffSpring = "stiff_spring",
    /// Operates or releases late.
    Slow = "slow",
    /// Bounces too long on one contact.
    Bouncing = "bouncing",
    /// NC welded: never opens, NO never makes.
    StuckNc = "stuck_nc",
    /// NO welded: never opens, NC never makes.
    StuckNo = "stuck_no",
    /// One contact has too much resistance.
    HighContact = "high_contact",
    /// One contact has another, always too high, resistance at every closure.
    UnstableContact = "unstable_contact",
    /// Lies in the nest the wrong way round: coil and common miss their pins.
    Turned = "turned",
    /// One pin is not there.
    MissingPin = "missing_pin",
}
