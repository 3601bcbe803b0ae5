//! The output image: the wanted value of every output, and the writes that send it to the modules.
//!
//! - Writes are absolute: one command sets all outputs of a module, so the next write also repairs a lost one.
//! - Only [`Outputs::apply`], with a motion cleared by the guard, switches an output that moves something.
//!   [`Outputs::everything_safe`] is the one exception: it has the same effect as the host watchdog and the hard
//!   emergency stop.
//! - The sort axis travels on a rising edge of `axis_drive`: one write with the point bits and the drive low, a second
//!   with the drive high. The drive stays high until the next travel.
//! - An unconfirmed write stays open ([`Outputs::settled`]); [`Outputs::failed`] makes it due again.

use super::axis::AxisStation;
use super::level::{Correction, SupplyError, nearest_level};
use super::model::Terminals;
use super::point::{AnalogOutput, DigitalOut, DigitalOutput};
use super::wiring::{LineId, Module, ModuleId, Wiring};
use crate::guard::{Actuator, Cleared};
use dcon::{Command, Digital, Level, OutputWord, Width};
use std::sync::Arc;
use thiserror::Error;
use units::Volt;

/// Reason why an output keeps its value.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DriveError {
    /// The output moves something and needs a cleared motion.
    #[error("{point} moves something and needs a cleared motion")]
    NeedsClearance {
        /// The output.
        point: DigitalOut,
    },
    /// The motion names only one jaw, or sends both to different ends; one valve drives both.
    #[error("one valve drives both jaws: the motion must move both the same way")]
    LoneJaw,
    /// The axis has no point at the target.
    #[error("the sort axis has no point at {x_mm} mm")]
    NoSuchStation {
        /// The target, mm.
        x_mm: f64,
    },
}

/// A write to send.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Write {
    /// The line on which to send the write.
    pub line: LineId,
    /// The addressed module; the caller passes it to [`Outputs::confirmed`] or [`Outputs::failed`].
    pub module: ModuleId,
    /// The command.
    pub command: Command,
}

/// Output values of a module.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Image {
    /// Digital outputs, bit n = channel n.
    Bits {
        word: u16,
        /// A word to write before `word`, so that `word` makes a rising edge.
        before: Option<u16>,
        width: Width,
    },
    /// Analog outputs by channel; `None` beyond the last one of the module.
    Levels([Option<Level>; MOST_LEVELS]),
}

/// Greatest number of analog outputs that a module has.
const MOST_LEVELS: usize = 4;

#[derive(Debug, Clone, Copy)]
struct Output {
    image: Image,
    due: bool,
    in_flight: u32,
}

/// Values of all outputs.
#[derive(Debug, Clone)]
pub struct Outputs {
    wiring: Arc<Wiring>,
    modules: Vec<Option<Output>>,
}

impl Outputs {
    /// Makes outputs at their safe values, all due to be written.
    pub fn new(wiring: Arc<Wiring>) -> Self {
        let safe = |module| {
            Some(Output {
                image: safe_image(&wiring, module)?,
                due: true,
                in_flight: 0,
            })
        };
        let modules = wiring.module_ids().map(safe).collect();
        Self { wiring, modules }
    }

    /// Switches an output that moves nothing.
    ///
    /// # Errors
    /// Fails with [`DriveError::NeedsClearance`] for an output that moves something, in either direction.
    pub fn set(&mut self, point: impl Into<DigitalOutput>, on: bool) -> Result<(), DriveError> {
        let point = point.into();
        match point.of_machine().filter(|known| known.moves()) {
            Some(point) => Err(DriveError::NeedsClearance { point }),
            None => {
                self.switch(point, on);
                Ok(())
            }
        }
    }

    /// Drives a cleared motion.
    ///
    /// # Errors
    /// Fails for a motion that the valves or the point table cannot make, and then changes nothing.
    pub fn apply(&mut self, cleared: Cleared) -> Result<(), DriveError> {
        let motion = cleared.motion();
        let to_work = |actuator| motion.target_mm(actuator).map(|to_mm| to_mm > 0.0);
        if to_work(Actuator::JawLeft) != to_work(Actuator::JawRight) {
            return Err(DriveError::LoneJaw);
        }
        let station = match motion.target_mm(Actuator::SortAxis) {
            Some(x_mm) => Some(
                self.wiring
                    .axis()
                    .station_at(x_mm)
                    .ok_or(DriveError::NoSuchStation { x_mm })?,
            ),
            None => None,
        };
        for stroke in motion.strokes() {
            self.stroke(stroke.actuator, stroke.to_mm > 0.0);
        }
        if let Some(station) = station {
            self.travel(station);
        }
        Ok(())
    }

    /// Switches the outputs of one actuator's valve, towards the actuator's working end or its rest end.
    fn stroke(&mut self, actuator: Actuator, work: bool) {
        match actuator {
            Actuator::Escapement => self.switch(DigitalOut::EscapementRelease, work),
            Actuator::Pusher => self.switch(DigitalOut::PusherExtend, work),
            Actuator::JawLeft | Actuator::JawRight => {
                self.switch(DigitalOut::ClampClose, work);
                self.switch(DigitalOut::ClampOpen, !work);
            }
            Actuator::ProbeLift => self.switch(DigitalOut::ProbeLift, work),
            Actuator::SortZ => self.switch(DigitalOut::SortZLower, work),
            Actuator::Gripper => {
                self.switch(DigitalOut::GripperClose, work);
                self.switch(DigitalOut::GripperRelease, !work);
            }
            Actuator::SortAxis => {}
        }
    }

    fn travel(&mut self, station: AxisStation) {
        let number = self.wiring.axis().point(station).number;
        self.switch(DigitalOut::AxisPoint0, number & 1 != 0);
        self.switch(DigitalOut::AxisPoint1, number & 2 != 0);
        self.switch(DigitalOut::AxisPoint2, number & 4 != 0);
        self.switch(DigitalOut::AxisDrive, true);
        self.prepare_edge(self.wiring.digital_out(DigitalOut::AxisDrive).module);
    }

    /// Inserts a write before the next one of the module that starts the axis: the same values with the drive low. A rig
    /// with a rack has no axis.
    fn prepare_edge(&mut self, module: ModuleId) {
        let drive = self.wiring.wired_out(DigitalOut::AxisDrive);
        let Some(drive) = drive.filter(|it| it.module == module) else {
            return;
        };
        if let Some(Output {
            image: Image::Bits { word, before, .. },
            due,
            ..
        }) = &mut self.modules[module.0]
            && *word & drive.bit() != 0
        {
            *before = Some(*word & !drive.bit());
            *due = true;
        }
    }

    fn switch(&mut self, point: impl Into<DigitalOutput>, on: bool) {
        let terminal = self.wiring.digital_out(point);
        if let Some(Output {
            image: Image::Bits { word, before, .. },
            due,
            ..
        }) = &mut self.modules[terminal.module.0]
        {
            let switched = |bits: u16| match on {
                true => bits | terminal.bit(),
                false => bits & !terminal.bit(),
            };
            *due |= switched(*word) != *word;
            *word = switched(*word);
            *before = before.map(switched);
        }
    }

    /// Sets one of the analog outputs whose sum is the coil supply. `supply` is its share, volts of the supply. Returns
    /// the share that the nearest step of the output gives.
    ///
    /// # Errors
    /// Fails for a voltage beyond the range of the output, and then changes nothing.
    pub fn set_supply(
        &mut self,
        point: AnalogOutput,
        supply: Volt,
        correction: Correction,
    ) -> Result<Volt, SupplyError> {
        let terminal = self.wiring.analog_out(point);
        let module = self.wiring.module(terminal.module);
        let name = self.wiring.source_name(point);
        let (level, really) = nearest_level(name, module, terminal.gain, supply, correction)?;
        if let Some(Output {
            image: Image::Levels(levels),
            due,
            ..
        }) = &mut self.modules[terminal.module.0]
        {
            let present = &mut levels[usize::from(terminal.channel.get())];
            *due |= *present != Some(level);
            *present = Some(level);
        }
        Ok(really)
    }

    /// Sets every output to its safe value, at once and without the guard.
    pub fn everything_safe(&mut self) {
        for module in self.wiring.module_ids() {
            if let (Some(output), Some(image)) = (
                &mut self.modules[module.0],
                safe_image(&self.wiring, module),
            ) {
                output.image = image;
                output.due = true;
            }
        }
    }

    /// Returns the due writes by line and address, and marks them as in flight.
    pub fn writes(&mut self) -> Vec<Write> {
        let mut writes = Vec::new();
        for module in self.wiring.module_ids() {
            let at = self.wiring.module(module);
            let Some(output) = self.modules[module.0].as_mut().filter(|output| output.due) else {
                continue;
            };
            output.due = false;
            for command in output.commands(at) {
                output.in_flight += 1;
                writes.push(Write {
                    line: at.line,
                    module,
                    command,
                });
            }
        }
        writes
    }

    /// Marks the write to this module as accepted.
    pub fn confirmed(&mut self, module: ModuleId) {
        if let Some(output) = &mut self.modules[module.0] {
            output.in_flight = output.in_flight.saturating_sub(1);
        }
    }

    /// Marks the write to this module as lost.
    pub fn failed(&mut self, module: ModuleId) {
        self.confirmed(module);
        self.refresh(module);
    }

    /// Makes the outputs of a module due again after a lost write or a reset, with the rising edge of the axis drive.
    pub fn refresh(&mut self, module: ModuleId) {
        if let Some(output) = &mut self.modules[module.0] {
            output.due = true;
        }
        self.prepare_edge(module);
    }

    /// Returns true when every output of a module is sent and confirmed, or the module has none.
    pub fn settled(&self, module: ModuleId) -> bool {
        self.modules[module.0].is_none_or(|output| !output.due && output.in_flight == 0)
    }

    /// Returns true when every output of every module is sent and confirmed.
    pub fn all_settled(&self) -> bool {
        self.wiring.module_ids().all(|module| self.settled(module))
    }

    /// Returns the commanded value of an output.
    pub fn is_on(&self, point: impl Into<DigitalOutput>) -> bool {
        let terminal = self.wiring.digital_out(point);
        match self.modules[terminal.module.0].map(|output| output.image) {
            Some(Image::Bits { word, .. }) => word & terminal.bit() != 0,
            Some(Image::Levels(_)) | None => false,
        }
    }
}

impl Output {
    fn commands(&mut self, module: &Module) -> Vec<Command> {
        let address = module.address;
        match &mut self.image {
            Image::Bits {
                word,
                before,
                width,
            } => {
                let words = before.take().into_iter().chain(Some(*word));
                let outputs = words.filter_map(|word| OutputWord::new(*width, word));
                outputs
                    .map(|outputs| Digital::Write(outputs).to(address))
                    .collect()
            }
            Image::Levels(levels) => {
                let write = |(channel, level): (_, Option<Level>)| {
                    let level = level?;
                    Some(dcon::AnalogOut::Write { channel, level }.to(address))
                };
                let levels = module.level_channels().into_iter().zip(*levels);
                levels.filter_map(write).collect()
            }
        }
    }
}

/// Returns the safe value of a module's outputs; `None` when it has none.
fn safe_image(wiring: &Wiring, module: ModuleId) -> Option<Image> {
    let module = wiring.module(module);
    if let Some(form) = module.output_form() {
        let safe = Level::nearest(form, module.type_code, module.safe_volts).ok()?;
        let outputs = usize::from(module.model.channels(Terminals::AnalogOut));
        let levels = std::array::from_fn(|channel| (channel < outputs).then_some(safe));
        return Some(Image::Levels(levels));
    }
    let width = module.model.write_width()?;
    Some(Image::Bits {
        word: module.safe_outputs,
        before: None,
        width,
    })
}
