//! Defects of a relay.

use crate::world::signal::vocabulary;

vocabulary! {
    /// A defect of the simulated lot, with its name in the truth file.
    Defect {
        /// The coil carries no current.
        OpenCoil = "open_coil",
        /// The coil resistance is too low.
        ShortedTurns = "shorted_turns",
        /// The winding is for another voltage.
        WrongCoil = "wrong_coil",
        /// The release voltage is too low.
        WeakSpring = "weak_spring",
        /// The operate voltage is too high.
        StiffSpring = "stiff_spring",
        /// The operate time or the release time is too long.
        Slow = "slow",
        /// One contact bounces too long.
        Bouncing = "bouncing",
        /// NC is welded: it never opens, and NO never makes.
        StuckNc = "stuck_nc",
        /// NO is welded: it never opens, and NC never makes.
        StuckNo = "stuck_no",
        /// The resistance of one contact is too high.
        HighContact = "high_contact",
        /// The resistance of one contact differs at every closure and is always too high.
        UnstableContact = "unstable_contact",
        /// The relay is misoriented in the nest: coil and common miss their pins.
        Misoriented = "turned",
        /// One pin is missing.
        MissingPin = "missing_pin",
    }
}
