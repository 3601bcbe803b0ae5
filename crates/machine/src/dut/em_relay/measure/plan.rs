//! Data that earlier stages pass to later ones and that the test record does not keep.

use super::ramp::Expected;
use super::search::Search;
use crate::dut::em_relay::Finding;
use crate::dut::em_relay::contact::{ContactDrop, Zero};
use crate::dut::em_relay::scale::Scale;
use crate::dut::em_relay::threshold::Direction;
use units::Volt;

/// Scatter of repeated fine ramps around the first, volts (1 sd).
const REPEAT_SD: Volt = Volt(0.008);

/// What earlier stages found and later ones need, but the test record does not keep: expected thresholds, the search
/// under way, contact drops.
#[derive(Debug, Clone, Default)]
pub struct Plan {
    operate: Option<Expected>,
    release: Option<Expected>,
    /// The search by levels under way.
    pub search: Option<Search>,
    /// Contact drop without current; `None` until read.
    pub zero: Option<Zero>,
    /// Drops of the NO closures read so far.
    pub no: Vec<ContactDrop>,
    /// Drops of the NC closures read so far.
    pub nc: Vec<ContactDrop>,
    /// Contact that does not move at nominal voltage: the part fails for this finding unless the coil proves to be the
    /// cause.
    pub unmoved: Option<Finding>,
}

impl Plan {
    /// Sets the interval for the next fine ramp of a direction.
    pub fn expect(&mut self, direction: Direction, interval: Expected) {
        match direction {
            Direction::Rising => self.operate = Some(interval),
            Direction::Falling => self.release = Some(interval),
        }
    }

    /// Returns the interval in which the stages so far expect the contact event of a direction.
    pub fn expected(&self, direction: Direction) -> Option<Expected> {
        match direction {
            Direction::Rising => self.operate,
            Direction::Falling => self.release,
        }
    }

    /// Expects the event of a repeated fine ramp around the indication of the first one.
    pub fn expect_again(&mut self, direction: Direction, first: Volt, scale: Scale) {
        let repeated = Expected::new(first, scale.of_coil(REPEAT_SD).0);
        self.expect(direction, repeated);
    }

    /// Returns the interval of the next fine ramp. Panics when no stage has set an expectation.
    pub fn interval(&self, direction: Direction) -> Expected {
        let Some(interval) = self.expected(direction) else {
            panic!("a fine ramp without an expectation, {direction:?}");
        };
        interval
    }
}
