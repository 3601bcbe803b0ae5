//! The output image: what every output should be, and the writes that make it so.
//!
//! - Writes are absolute: all outputs of a module in one command, so a lost one is repaired by sending the next.
//! - An output that moves something is switched only by [`Outputs::apply`], with a motion that the guard has
//!   cleared. [`Outputs::everything_safe`] is the one exception: it brings about what the host watchdog and the
//!   hard emergency stop bring about too.
//! - The sort axis travels on a rising edge of `axis_drive`: one write with the point bits and the drive low, a
//!   second with the drive high. The drive stays high until the next travel.
//! - What was sent but not confirmed stays open ([`Outputs::settled`]); [`Outputs::failed`] makes it due again.

use super::axis::AxisStation;
use super::level::{Correction, SupplyError, nearest_level};
use super::point::{AnalogOutput, DigitalOut, DigitalOutput};
use super::wiring::{LineId, ModuleId, Wiring};
use crate::guard::{Actuator, Cleared};
use dcon::{Command, Digital, Level, OutputWord, Width};
use std::sync::Arc;
use thiserror::Error;
use units::Volt;

/// Why an output was not switched.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DriveError {
    /// The output moves something: only a cleared motion may switch it.
    #[error("{point} moves something and needs a cleared motion")]
    NeedsClearance {
        /// The output.
        point: DigitalOut,
    },
    /// One valve drives both jaws, and the motion names one, or sends them apart.
    #[error("one valve drives both jaws: the motion must move both the same way")]
    LoneJaw,
    /// The axis can only go to the points of its table.
    #[error("the sort axis has no point at {x_mm} mm")]
    NoSuchStation {
        /// The wanted position.
        x_mm: f64,
    },
}

/// A write that is due.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Write {
    /// The line to send it on.
    pub line: LineId,
    /// The module it is for; to be given to [`Outputs::confirmed`] or [`Outputs::failed`].
    pub module: ModuleId,
    /// The command.
    pub command: Command,
}

/// What a module should put out.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Image {
    /// Digital outputs, bit n = channel n.
    Bits {
        word: u16,
        /// A word to be written before `word`: makes a rising edge.
        before: Option<u16>,
        width: Width,
    },
    /// An analog output.
    Level(Level),
}

#[derive(Debug, Clone, Copy)]
struct Output {
    image: Image,
    due: bool,
    in_flight: u32,
}

/// What every output should be.
#[derive(Debug, Clone)]
pub struct Outputs {
    wiring: Arc<Wiring>,
    modules: Vec<Option<Output>>,
}

impl Outputs {
    /// Everything at its safe value, and everything due.
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
    /// [`DriveError::NeedsClearance`] for an output that does, whichever way it is switched.
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
    /// A motion that the valves or the point table cannot make; nothing is changed.
    pub fn apply(&mut self, cleared: Cleared) -> Result<(), DriveError> {
        let motion = cleared.motion();
        let to_work = |actuator| motion.target_mm(actuator).map(|to_mm| to_mm > 0.0);
        if to_work(Actuator::JawLeft) != to_work(Actuator::JawRight) {
            return Err(DriveError::LoneJaw);
        }
        let station = match motion.target_mm(Actuator::SortAxis) {
            Some(x_mm) => Some(
                self.wiring
                    .axis
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

    /// The coils of one actuator, towards its working end or its rest end.
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
        let number = self.wiring.axis.point(station).number;
        self.switch(DigitalOut::AxisPoint0, number & 1 != 0);
        self.switch(DigitalOut::AxisPoint1, number & 2 != 0);
        self.switch(DigitalOut::AxisPoint2, number & 4 != 0);
        self.switch(DigitalOut::AxisDrive, true);
        self.prepare_edge(self.wiring.digital_out(DigitalOut::AxisDrive).module);
    }

    /// Before the next write of the module that starts the axis: the same with the drive low.
    fn prepare_edge(&mut self, module: ModuleId) {
        let drive = self.wiring.digital_out(DigitalOut::AxisDrive);
        if drive.module != module {
            return;
        }
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
            let next = if on {
                *word | terminal.bit()
            } else {
                *word & !terminal.bit()
            };
            let edge_low = before.map(|low| {
                if on {
                    low | terminal.bit()
                } else {
                    low & !terminal.bit()
                }
            });
            *due |= next != *word;
            *word = next;
            *before = edge_low;
        }
    }

    /// Sets one of the outputs whose sum is a supply. `supply` is its share, V at the supply; the result is what it
    /// will really be: the nearest step.
    ///
    /// # Errors
    /// A voltage that the output cannot give; nothing is changed.
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
        if let Some(output) = &mut self.modules[terminal.module.0] {
            output.due |= output.image != Image::Level(level);
            output.image = Image::Level(level);
        }
        Ok(really)
    }

    /// Every output to its safe value, at once and without asking the guard.
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

    /// The writes that are due, by line and address; they are then in flight.
    pub fn writes(&mut self) -> Vec<Write> {
        let mut writes = Vec::new();
        for module in self.wiring.module_ids() {
            let at = self.wiring.module(module);
            let Some(output) = self.modules[module.0].as_mut().filter(|output| output.due) else {
                continue;
            };
            output.due = false;
            for command in output.commands(at.address) {
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

    /// A write to this module was accepted.
    pub fn confirmed(&mut self, module: ModuleId) {
        if let Some(output) = &mut self.modules[module.0] {
            output.in_flight = output.in_flight.saturating_sub(1);
        }
    }

    /// A write to this module was not confirmed.
    pub fn failed(&mut self, module: ModuleId) {
        self.confirmed(module);
        self.refresh(module);
    }

    /// Makes the outputs of a module due again, edge of the axis drive included: after a lost write or a reset.
    pub fn refresh(&mut self, module: ModuleId) {
        if let Some(output) = &mut self.modules[module.0] {
            output.due = true;
        }
        self.prepare_edge(module);
    }

    /// Whether everything wanted of a module was sent and confirmed. True for modules without outputs.
    pub fn settled(&self, module: ModuleId) -> bool {
        self.modules[module.0].is_none_or(|output| !output.due && output.in_flight == 0)
    }

    /// Whether everything wanted of every module was sent and confirmed.
    pub fn all_settled(&self) -> bool {
        self.wiring.module_ids().all(|module| self.settled(module))
    }

    /// What an output should be.
    pub fn is_on(&self, point: impl Into<DigitalOutput>) -> bool {
        let terminal = self.wiring.digital_out(point);
        match self.modules[terminal.module.0].map(|output| output.image) {
            Some(Image::Bits { word, .. }) => word & terminal.bit() != 0,
            Some(Image::Level(_)) | None => false,
        }
    }
}

impl Output {
    fn commands(&mut self, address: dcon::Address) -> Vec<Command> {
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
            Image::Level(level) => vec![
                dcon::AnalogOut::Write {
                    channel: None,
                    level: *level,
                }
                .to(address),
            ],
        }
    }
}

/// The safe value of a module's outputs; `None` when it has none.
fn safe_image(wiring: &Wiring, module: ModuleId) -> Option<Image> {
    let module = wiring.module(module);
    if let Some(form) = module.output_form() {
        return Level::nearest(form, module.type_code, module.safe_volts)
            .ok()
            .map(Image::Level);
    }
    let width = module.model.write_width()?;
    Some(Image::Bits {
        word: module.safe_outputs,
        before: None,
        width,
    })
}
