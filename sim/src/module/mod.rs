//! One module of a line: its common part, its family, and its own events.
//!
//! A module acts at three kinds of instants: when a request for it arrives, when its own next event is due (a
//! sample of the converter, a refresh of a ramp), and when its host watchdog expires. Nothing happens in between,
//! so the rig runs from event to event.
//!
//! | family | models |
//! |---|---|
//! | [`analog_in`] | 7017 7017F 7017R 7017RC 7018 7018P 7018R, RTD 7033 |
//! | [`analog_out`] | 7021 7021P 7022 7024 |
//! | [`digital`] | 7041 7042 7043 7044 7045 7050 7051 7052 7053 7060 7063 7065 7066 7067 |
//! | [`counter`] | 7080 7080B 7080D |

mod alarm;
pub mod analog_in;
pub mod analog_out;
pub mod base;
pub mod converter;
pub mod counter;
pub mod digital;
mod output;
mod pulse;
pub mod ramp;
pub mod range;
pub mod setting;
pub mod shape;
pub mod tolerances;
pub mod watchdog;

use rand_chacha::ChaCha8Rng;

use crate::config::ConfigError;
use crate::dcon::{self, Address, Answer, Request};
use crate::terminal::{ModuleSpec, Plant};
use base::{Commissioning, ModuleBase};
use tolerances::Tolerances;

/// Screw terminals of one module at one instant.
pub struct Terminals<'a> {
    /// The world, already advanced to `now_us`.
    pub plant: &'a mut dyn Plant,
    /// Identifier of the module in the configuration.
    pub module: &'a str,
    /// Rig time, microseconds.
    pub now_us: u64,
}

/// Behaviour in which product families differ.
pub trait Family: Send {
    /// Checks whether the family accepts a type code and a format word.
    fn fits(&self, type_code: u8, format: u8) -> bool;

    /// Carries out a command of the family.
    fn answer(
        &mut self,
        base: &mut ModuleBase,
        request: &Request<'_>,
        at: &mut Terminals<'_>,
    ) -> Answer;

    /// Adopts a changed configuration word.
    fn configured(&mut self, base: &ModuleBase, at: &mut Terminals<'_>);

    /// Returns the instant of the family's next event; `u64::MAX` for none.
    fn next_us(&self) -> u64;

    /// Carries out the family's event that is due.
    fn run(&mut self, base: &ModuleBase, at: &mut Terminals<'_>);

    /// Samples the inputs now (`#**`).
    fn sample(&mut self, at: &mut Terminals<'_>);

    /// Sets the outputs to their safe values at once.
    fn make_safe(&mut self, base: &ModuleBase, at: &mut Terminals<'_>);

    /// Sets the outputs to their power-on values, or to the safe values after a watchdog trip.
    fn restart(&mut self, base: &ModuleBase);

    /// Applies the registers to the terminals and starts the converters.
    fn energise(&mut self, base: &ModuleBase, at: &mut Terminals<'_>);
}

/// A module on its line.
pub struct Module {
    id: String,
    line: String,
    base: ModuleBase,
    family: Box<dyn Family>,
    tolerances: Tolerances,
    rng: ChaCha8Rng,
}

impl Module {
    /// Returns the constant signals that a bench file gives for the inputs.
    pub fn inputs(&self) -> &[f64] {
        &self.base.inputs
    }

    /// Builds a module from its table.
    ///
    /// # Errors
    /// Fails when the model is not simulated, or a key has an unfit value.
    pub fn new(
        spec: &ModuleSpec,
        line: Commissioning,
        tolerances: Tolerances,
        rng: ChaCha8Rng,
    ) -> Result<Self, ConfigError> {
        let model = model_number(&spec.model);
        let (base, family) = if analog_in::MODELS.contains(&model) {
            analog_in::build(spec, model, line, &tolerances, rng.clone())?
        } else if analog_out::MODELS.contains(&model) {
            analog_out::build(spec, model, line, &tolerances)?
        } else if counter::MODELS.contains(&model) {
            counter::build(spec, model, line)?
        } else if let Some(shape) = shape::shape(model) {
            digital::build(spec, shape, line)?
        } else {
            return Err(spec.settings.wrong("model", &models()));
        };
        Ok(Self {
            id: spec.id.clone(),
            line: spec.line.clone(),
            base,
            family,
            tolerances,
            rng,
        })
    }

    /// Returns the key of its table.
    pub fn id(&self) -> &str {
        &self.id
    }

    /// Returns the name of its line.
    pub fn line(&self) -> &str {
        &self.line
    }

    /// Returns the common part: address, configuration word, watchdog, EEPROM.
    pub fn base(&self) -> &ModuleBase {
        &self.base
    }

    /// Returns the common part of the module, for faults that change it.
    pub fn base_mut(&mut self) -> &mut ModuleBase {
        &mut self.base
    }

    /// Checks whether a request for `address` at the host's rate reaches the module; a rate of `None` matches.
    pub fn is_reached_by(&self, address: Address, host_baud: Option<u32>) -> bool {
        let meant = match address {
            Address::Everybody => true,
            Address::Module(address) => self.base.is_addressed_by(address),
        };
        meant && host_baud.is_none_or(|baud| baud == self.base.baud())
    }

    /// Draws the time from the end of a request to the first character of its reply, microseconds.
    pub fn next_latency_us(&mut self) -> u64 {
        self.tolerances.next_latency_us(&mut self.rng) + self.base.response_delay_us()
    }

    /// Returns the instant of its next event of any kind; `u64::MAX` for none.
    pub fn next_us(&self) -> u64 {
        let expiry = self.base.watchdog.expires_us().unwrap_or(u64::MAX);
        expiry.min(self.family.next_us())
    }

    /// Carries out every event that is due at `now_us`.
    pub fn run(&mut self, plant: &mut dyn Plant, now_us: u64) {
        let mut at = Terminals {
            plant,
            module: &self.id,
            now_us,
        };
        if self
            .base
            .watchdog
            .expires_us()
            .is_some_and(|due| due <= now_us)
        {
            trip(&mut self.base, self.family.as_mut(), &mut at);
        }
        if self.family.next_us() <= now_us {
            self.family.run(&self.base, &mut at);
        }
    }

    /// Starts the module in the state that its table describes, as if it had long been powered.
    pub fn energise(&mut self, plant: &mut dyn Plant, now_us: u64) {
        let mut at = Terminals {
            plant,
            module: &self.id,
            now_us,
        };
        self.family.energise(&self.base, &mut at);
    }

    /// Restarts the running module (a fault, or its own hardware watchdog).
    pub fn reset(&mut self, plant: &mut dyn Plant, now_us: u64) {
        self.base.power_cycled();
        self.family.restart(&self.base);
        self.energise(plant, now_us);
    }

    /// Lets the host watchdog expire now, even if a host has just fed it.
    pub fn trip(&mut self, plant: &mut dyn Plant, now_us: u64) {
        let mut at = Terminals {
            plant,
            module: &self.id,
            now_us,
        };
        trip(&mut self.base, self.family.as_mut(), &mut at);
    }

    /// Processes `text` (without CR); returns the bytes of the reply, if any.
    pub fn serve(&mut self, text: &[u8], plant: &mut dyn Plant, now_us: u64) -> Option<Vec<u8>> {
        let with_checksum = self.base.uses_checksum();
        let bare = if with_checksum {
            dcon::without_checksum(text)?
        } else {
            text
        };
        let request = dcon::request(bare)?;
        let mut at = Terminals {
            plant,
            module: &self.id,
            now_us,
        };
        if request.address == Address::Everybody {
            broadcast(&mut self.base, self.family.as_mut(), &request, &mut at);
            return None;
        }
        match self.obey(&request, plant, now_us) {
            Answer::Reply(reply) => Some(dcon::framed(reply, with_checksum)),
            Answer::Silence | Answer::Unknown => None,
        }
    }

    fn obey(&mut self, request: &Request<'_>, plant: &mut dyn Plant, now_us: u64) -> Answer {
        let mut at = Terminals {
            plant,
            module: &self.id,
            now_us,
        };
        let answer = self.family.answer(&mut self.base, request, &mut at);
        if answer != Answer::Unknown {
            return answer;
        }
        let family = &self.family;
        let answer = self
            .base
            .answer(request, now_us, |code, format| family.fits(code, format));
        if request.lead == b'%' {
            self.family.configured(&self.base, &mut at);
        }
        answer
    }
}

fn trip(base: &mut ModuleBase, family: &mut dyn Family, at: &mut Terminals<'_>) {
    base.watchdog.trip();
    base.eeprom_writes += 1;
    family.make_safe(base, at);
}

fn broadcast(
    base: &mut ModuleBase,
    family: &mut dyn Family,
    request: &Request<'_>,
    at: &mut Terminals<'_>,
) {
    match (request.lead, request.body) {
        (b'~', []) => base.watchdog.feed(at.now_us),
        (b'#', []) => family.sample(at),
        (_, _) => {}
    }
}

/// Returns the model number: `7017F` for `I-7017F`, and, except for the 7080D, without the `D` of a model with LEDs.
fn model_number(model: &str) -> &str {
    let number = model.trim_start_matches("I-").trim_start_matches("M-");
    match number {
        "7080D" => number,
        other => other.strip_suffix('D').unwrap_or(other),
    }
}

/// Returns the list of all models; a name may also begin with `I-` or `M-` and end in `D` (LED).
fn models() -> String {
    let digital = shape::SHAPES.map(|(number, ..)| number);
    let all: [&[&str]; 4] = [
        &analog_in::MODELS,
        &analog_out::MODELS,
        &counter::MODELS,
        &digital,
    ];
    format!("one of {}", all.concat().join(" "))
}

/// Common part and family of a module, before it joins a line.
pub type Built = (ModuleBase, Box<dyn Family>);
