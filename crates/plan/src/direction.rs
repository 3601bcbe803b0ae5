//! The six directions in which an element may leave.

use std::fmt;
use std::str::FromStr;

/// A direction along an axis of the frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Direction {
    /// Along x.
    PlusX,
    /// Against x.
    MinusX,
    /// Along y.
    PlusY,
    /// Against y.
    MinusY,
    /// Along z, upward.
    PlusZ,
    /// Against z, downward.
    MinusZ,
}

/// A text that names no direction.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("direction: found {found:?}, expected +x, -x, +y, -y, +z or -z")]
pub struct UnknownDirection {
    /// The text found.
    pub found: String,
}

impl Direction {
    /// All directions, in the order of [`Direction::index`].
    pub const ALL: [Direction; 6] = [
        Direction::PlusX,
        Direction::MinusX,
        Direction::PlusY,
        Direction::MinusY,
        Direction::PlusZ,
        Direction::MinusZ,
    ];

    /// Returns the place of the direction in tables, 0 to 5.
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Returns the axis: 0 is x, 1 is y, 2 is z.
    pub const fn axis(self) -> usize {
        self.index() / 2
    }

    /// Returns 1 along the axis and -1 against it.
    pub const fn sign(self) -> f64 {
        if self.index().is_multiple_of(2) {
            1.0
        } else {
            -1.0
        }
    }

    /// Returns the direction that leads back.
    pub const fn opposite(self) -> Direction {
        Direction::ALL[self.index() ^ 1]
    }

    /// Returns the displacement of a way of `distance_mm` in this direction, mm.
    pub fn displacement(self, distance_mm: f64) -> [f64; 3] {
        let mut displacement = [0.0; 3];
        displacement[self.axis()] = self.sign() * distance_mm;
        displacement
    }

    /// Returns the name: `+x`, `-x`, `+y`, `-y`, `+z` or `-z`.
    pub const fn name(self) -> &'static str {
        ["+x", "-x", "+y", "-y", "+z", "-z"][self.index()]
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Direction {
    type Err = UnknownDirection;

    fn from_str(text: &str) -> Result<Direction, UnknownDirection> {
        let known = Direction::ALL.into_iter().find(|it| it.name() == text);
        known.ok_or_else(|| UnknownDirection {
            found: text.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_leads_back_to_its_direction() {
        for direction in Direction::ALL {
            assert_eq!(direction.name().parse(), Ok(direction));
            assert_eq!(direction.opposite().opposite(), direction);
            assert_eq!(direction.opposite().axis(), direction.axis());
            assert_eq!(direction.opposite().sign(), -direction.sign());
        }
        assert!("up".parse::<Direction>().is_err());
    }
}
