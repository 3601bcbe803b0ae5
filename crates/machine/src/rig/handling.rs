//! How parts get to their test on this rig: a feeder brings them one by one, or a person fills a rack.
//!
//! A rig has one of the two: a rack when `config/rig.toml` has `[rack]`, else a feeder.

use super::axis::AxisTable;
use super::bin::Bin;
use super::point::DigitalInput;
use super::rack::Rack;
use super::stroke::StrokeLimits;
use super::wiring::Wiring;

/// How parts get to their test.
#[derive(Debug, Clone, PartialEq)]
pub enum Handling {
    /// Actuators bring parts to one nest and sort them into bins.
    Feeder(FeederTable),
    /// A person loads all sockets, closes the door, and unloads list by list.
    Rack(Rack),
}

/// Data of a feeder.
#[derive(Debug, Clone, PartialEq)]
pub struct FeederTable {
    /// Point table of the sort axis, with the bins.
    pub axis: AxisTable,
    /// Longest time of each stroke.
    pub strokes: StrokeLimits,
}

impl Handling {
    /// Returns the name of this handling, for messages about a kind of device that needs the other one.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Feeder(_) => "a feeder",
            Self::Rack(_) => "a rack",
        }
    }
}

impl Wiring {
    /// Returns the data of the feeder; `None` on a rig with a rack.
    pub fn feeder(&self) -> Option<&FeederTable> {
        match &self.handling {
            Handling::Feeder(table) => Some(table),
            Handling::Rack(_) => None,
        }
    }

    /// Returns the rack; `None` on a rig with a feeder.
    pub fn rack(&self) -> Option<&Rack> {
        match &self.handling {
            Handling::Feeder(_) => None,
            Handling::Rack(rack) => Some(rack),
        }
    }

    /// Returns the point table of the sort axis.
    ///
    /// # Panics
    /// Panics on a rig without a feeder, where nothing moves along an axis.
    pub fn axis(&self) -> &AxisTable {
        match &self.handling {
            Handling::Feeder(table) => &table.axis,
            Handling::Rack(_) => panic!("a rack has no sort axis"),
        }
    }

    /// Returns the bins in the order of the line, or the unloading lists of a rack in their order.
    pub fn bins(&self) -> Vec<Bin> {
        match &self.handling {
            Handling::Feeder(table) => table.axis.bins().collect(),
            Handling::Rack(rack) => rack.lists().to_vec(),
        }
    }

    /// Returns true when the rig has this bin or unloading list.
    pub fn has_bin(&self, bin: Bin) -> bool {
        self.bins().contains(&bin)
    }

    /// Returns the inputs that the scan reads besides those of the machine: beams of bins; with a rack contacts of
    /// sockets, and inputs of fixtures, because the test of a batch watches its safety chain all the time.
    pub fn scanned_inputs(&self) -> Vec<DigitalInput> {
        match &self.handling {
            Handling::Feeder(table) => table.axis.bins().map(|bin| table.axis.beam(bin)).collect(),
            Handling::Rack(rack) => {
                let contacts = rack.sockets().iter().map(|it| it.contact);
                contacts.chain(self.fixture_inputs()).collect()
            }
        }
    }
}
