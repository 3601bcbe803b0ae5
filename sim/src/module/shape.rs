//! Number of inputs and outputs of each digital module, and the widths of its data.

/// Channels of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Digital inputs.
    pub inputs: u8,
    /// Digital outputs.
    pub outputs: u8,
}

/// Digital models: number, inputs, outputs.
pub(super) const SHAPES: [(&str, u8, u8); 18] = [
    ("7041", 14, 0),
    ("7042", 0, 13),
    ("7043", 0, 16),
    ("7044", 4, 8),
    ("7045", 0, 16),
    ("7050", 7, 8),
    ("7051", 16, 0),
    ("7052", 8, 0),
    ("7053", 16, 0),
    ("7060", 4, 4),
    ("7063", 8, 3),
    ("7063A", 8, 3),
    ("7063B", 8, 3),
    ("7065", 4, 5),
    ("7065A", 4, 5),
    ("7065B", 4, 5),
    ("7066", 0, 7),
    ("7067", 0, 7),
];

/// Returns the channels of a model number; `None` for a module that is not digital.
pub fn shape(number: &str) -> Option<Shape> {
    let (_, inputs, outputs) = *SHAPES.iter().find(|it| it.0 == number)?;
    Some(Shape { inputs, outputs })
}

impl Shape {
    /// Returns the mask of all outputs.
    pub(super) fn all_outputs(self) -> u16 {
        ones(self.outputs)
    }

    /// Returns the number of data digits in `@AA(data)`.
    pub(super) fn output_digits(self) -> usize {
        match self.outputs {
            0..=4 => 1,
            5..=8 => 2,
            _ => 4,
        }
    }

    /// Returns the first and second byte of a data reply as one word.
    pub(super) fn first_and_second(self, inputs: u16, outputs: u16) -> u16 {
        if self.inputs > 8 {
            inputs
        } else if self.outputs == 0 {
            inputs << 8
        } else if self.outputs > 8 {
            outputs
        } else {
            outputs << 8 | (inputs & 0xFF)
        }
    }
}

/// Returns the mask of the lowest `channels` channels.
pub(super) fn ones(channels: u8) -> u16 {
    ((1u32 << channels) - 1) as u16
}
