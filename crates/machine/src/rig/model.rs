//! The module models that the wiring supports, and their terminals.

use dcon::Width;

named! {
    /// A model of the I-7000 family. A module answers `$AAM` with its name, without the `I-`.
    Model {
        /// 8 analog inputs, 16 bit at 10 conversions a second.
        I7017 = "I-7017",
        /// 8 analog inputs with a fast mode.
        I7017F = "I-7017F",
        /// 8 protected analog inputs with a fast mode.
        I7017R = "I-7017R",
        /// 8 thermocouples.
        I7018 = "I-7018",
        /// 1 analog output, 12 bit.
        I7021 = "I-7021",
        /// 1 analog output, 16 bit.
        I7021P = "I-7021P",
        /// 4 analog outputs, 14 bit.
        I7024 = "I-7024",
        /// 3 resistance thermometers.
        I7033 = "I-7033",
        /// 14 isolated digital inputs.
        I7041 = "I-7041",
        /// 16 digital outputs.
        I7043 = "I-7043",
        /// 16 isolated digital outputs.
        I7045 = "I-7045",
        /// 7 digital inputs and 8 outputs.
        I7050 = "I-7050",
        /// 16 isolated digital inputs with event counters.
        I7051 = "I-7051",
        /// 4 digital inputs and 4 relays.
        I7060 = "I-7060",
        /// 8 digital inputs and 3 relays.
        I7063 = "I-7063",
        /// 4 digital inputs and 5 relays.
        I7065 = "I-7065",
        /// 7 relays.
        I7067 = "I-7067",
        /// 2 gated 32-bit counters.
        I7080 = "I-7080",
    }
}

/// The kind of terminal a point needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Terminals {
    /// Voltage inputs.
    AnalogIn,
    /// Resistance thermometers or thermocouples.
    Temperature,
    /// Voltage or current output.
    AnalogOut,
    /// Gated counters.
    Counter,
    /// Digital inputs.
    DigitalIn,
    /// Digital outputs.
    DigitalOut,
}

impl Model {
    /// Returns the number of terminals of a kind; 0 for none.
    pub fn channels(self, kind: Terminals) -> u8 {
        let count = |has: bool, channels: u8| if has { channels } else { 0 };
        match kind {
            Terminals::AnalogIn => {
                count(matches!(self, Self::I7017 | Self::I7017F | Self::I7017R), 8)
            }
            Terminals::Temperature => {
                count(matches!(self, Self::I7033), 3) + count(matches!(self, Self::I7018), 8)
            }
            Terminals::AnalogOut => {
                count(matches!(self, Self::I7021 | Self::I7021P), 1)
                    + count(matches!(self, Self::I7024), 4)
            }
            Terminals::Counter => count(matches!(self, Self::I7080), 2),
            Terminals::DigitalIn => self.digital().0,
            Terminals::DigitalOut => self.digital().1,
        }
    }

    /// Returns the numbers of digital inputs and outputs.
    fn digital(self) -> (u8, u8) {
        match self {
            Self::I7041 => (14, 0),
            Self::I7051 => (16, 0),
            Self::I7043 | Self::I7045 => (0, 16),
            Self::I7050 => (7, 8),
            Self::I7060 => (4, 4),
            Self::I7063 => (8, 3),
            Self::I7065 => (4, 5),
            Self::I7067 => (0, 7),
            Self::I7017
            | Self::I7017F
            | Self::I7017R
            | Self::I7018
            | Self::I7021
            | Self::I7021P
            | Self::I7024
            | Self::I7033
            | Self::I7080 => (0, 0),
        }
    }

    /// Returns true for a type code whose range the rig can scale.
    pub fn accepts_type(self, code: u8) -> bool {
        self.type_codes().contains(&code)
    }

    /// Returns the type codes that the rig supports: voltage inputs, outputs from 0 to 10 V, Pt100, thermocouples J, K,
    /// T and E, and for counters the counting (not the frequency) mode. A code means different ranges on different
    /// models.
    pub fn type_codes(self) -> &'static [u8] {
        match self {
            Self::I7017 | Self::I7017F | Self::I7017R => &[0x08, 0x09, 0x0A, 0x0B, 0x0C],
            Self::I7018 => &[0x0E, 0x0F, 0x10, 0x11],
            Self::I7021 | Self::I7021P | Self::I7024 => &[0x32],
            Self::I7033 => &[0x20, 0x21, 0x22, 0x23, 0x24, 0x25, 0x26, 0x27],
            Self::I7041
            | Self::I7043
            | Self::I7045
            | Self::I7050
            | Self::I7051
            | Self::I7060
            | Self::I7063
            | Self::I7065
            | Self::I7067 => &[0x40],
            Self::I7080 => &[0x50],
        }
    }

    /// Returns true for a model whose readings or settings have a data format.
    pub fn is_analog(self) -> bool {
        self.is_analog_in() || self.channels(Terminals::AnalogOut) > 0
    }

    /// Returns true for a converter, whose replies take longer than those of other modules.
    pub fn is_analog_in(self) -> bool {
        self.channels(Terminals::AnalogIn) > 0 || self.channels(Terminals::Temperature) > 0
    }

    /// Returns true for a module with outputs, whose host watchdog matters.
    pub fn has_outputs(self) -> bool {
        self.channels(Terminals::AnalogOut) > 0 || self.channels(Terminals::DigitalOut) > 0
    }

    /// Returns true when the digital inputs count events (slow pulses, up to 100 a second).
    pub fn counts_events(self) -> bool {
        self.channels(Terminals::DigitalIn) > 0
    }

    /// Returns the width of an absolute output write `@AA(data)`; `None` without digital outputs.
    pub fn write_width(self) -> Option<Width> {
        match self.digital().1 {
            0 => None,
            1..=4 => Some(Width::One),
            5..=8 => Some(Width::Two),
            9.. => Some(Width::Four),
        }
    }

    /// Returns the input bits of a digital reply; where a module has both, the outputs come first.
    pub fn input_bits(self, word: u16) -> u16 {
        if self.digital().1 > 0 {
            word & 0x00FF
        } else {
            word
        }
    }
}

impl Terminals {
    /// Returns the words that messages use for these terminals.
    pub fn words(self) -> &'static str {
        match self {
            Self::AnalogIn => "analog inputs",
            Self::Temperature => "thermometers",
            Self::AnalogOut => "an analog output",
            Self::Counter => "counters",
            Self::DigitalIn => "digital inputs",
            Self::DigitalOut => "digital outputs",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_answers_to_its_name() {
        for &model in Model::ALL {
            assert_eq!(Model::from_name(model.name()), Some(model));
        }
        assert_eq!(Model::I7021P.name(), "I-7021P");
        assert_eq!(Model::I7063.write_width(), Some(Width::One));
        assert_eq!(Model::I7065.write_width(), Some(Width::Two));
    }
}
