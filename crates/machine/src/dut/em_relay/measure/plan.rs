//! Data that earlier stages pass to later ones; the test record does not keep it.

use super::TestRecord;
use super::ramp::Expected;
use super::search::Search;
use crate::dut::em_relay::Finding;
use crate::dut::em_relay::threshold::Direction;
use units::Volt;

/// Scatter of a repeated fine ramp around the first, volts (1 sd).
const REPEAT_SD_V: f64 = 0.008;

/// Data of earlier stages for later ones.
#[derive(Debug, Clone, Default)]
pub struct Plan {
    operate: Option<Expected>,
    release: Option<Expected>,
    /// The search by levels under way.
    pub search: Option<Search>,
    /// Terminal voltage of the contact drop without current.
    pub drop_zero: Option<Volt>,
    /// NC drops of the closures read so far, free of offset.
    pub nc_drops: Vec<Volt>,
    /// The contact that does not move at nominal voltage: the part fails by it unless its coil is the cause.
    pub unmoved: Option<Finding>,
}

impl Plan {
    /// Sends the next fine ramp of a direction over this interval.
    pub fn expect(&mut self, direction: Direction, interval: Expected) {
        match direction {
            Direction::Rising => self.operate = Some(interval),
            Direction::Falling => self.release = Some(interval),
        }
    }

    /// Where the stages so far expect the event of a direction.
    pub fn expected(&self, direction: Direction) -> Option<Expected> {
        match direction {
            Direction::Rising => self.operate,
            Direction::Falling => self.release,
        }
    }

    /// The interval of the next fine ramp: around the indication of the first one where it repeats that.
    /// Panics without an expectation: no stage sends a fine ramp at random.
    pub fn interval(&self, record: &TestRecord, direction: Direction) -> Expected {
        let repeated = record
            .ramp(direction)
            .and_then(|ramp| ramp.fine)
            .map(|fine| Expected::new(fine, REPEAT_SD_V));
        let Some(interval) = repeated.or(self.expected(direction)) else {
            panic!("a fine ramp without an expectation, {direction:?}");
        };
        interval
    }
}
