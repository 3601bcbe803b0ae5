//! One module of a line: its plate, its family, and the events it makes by itself.
//!
//! A module acts at three kinds of instants: when a request for it has arrived, when its own next
//! event is due (a sample of the converter, a refresh of a ramp), and when its host watchdog
//! expires. Between them nothing happens, so the rig runs from event to event.
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
pub mod converter;
pub mod counter;
pub mod digital;
pub mod habit;
mod output;
pub mod plate;
mod pulse;
pub mod ramp;
pub mod range;
pub mod setting;
pub mod shape;
pub mod watchdog;

use rand_chacha::ChaCha8Rng;

use crate::dcon::{self, Address, Answer, Request};
use crate::error::SimError;
use crate::terminal::{ModuleSpec, Plant};
use habit::Habit;
use plate::{Commissioning, Plate};

/// The screw terminals of one module at one instant.
pub struct Terminals<'a> {
    /// The world, already advanced to `now_us`.
    pub plant: &'a mut dyn Plant,
    /// Identifier of the module.
    pub module: &'a str,
    /// Rig time, microseconds.
    pub now_us: u64,
}

/// What distinguishes one product from another.
pub trait Family: Send {
    /// Takes a type code and a format word.
    fn fits(&self, type_code: u8, format: u8) -> bool;

    /// Carries out a command of the family.
    fn answer(
        &mut self,
        plate: &mut Plate,
        request: &Request<'_>,
        at: &mut Terminals<'_>,
    ) -> Answer;

    /// The configuration word has changed.
    fn configured(&mut self, plate: &Plate, at: &mut Terminals<'_>);

    /// Instant of its next own event, `u64::MAX` for none.
    fn next_us(&self) -> u64;

    /// Its own event is due.
    fn run(&mut self, plate: &Plate, at: &mut Terminals<'_>);

    /// `#**`: sample the inputs now.
    fn sample(&mut self, at: &mut Terminals<'_>);

    /// Outputs go to their safe values at once.
    fn make_safe(&mut self, plate: &Plate, at: &mut Terminals<'_>);

    /// Outputs take their power-on values, or the safe ones when the watchdog had tripped.
    fn restart(&mut self, plate: &Plate);

    /// Terminals carry what the registers say, converters run.
    fn energise(&mut self, plate: &Plate, at: &mut Terminals<'_>);
}

/// A module on its line.
pub struct Module {
    id: String,
    line: String,
    plate: Plate,
    family: Box<dyn Family>,
    habit: Habit,
    rng: ChaCha8Rng,
}

impl Module {
    /// Commissions a module as its table says.
    ///
    /// # Errors
    /// The model is not simulated, or a key has a value it cannot take.
    pub fn new(
        spec: &ModuleSpec,
        line: Commissioning,
        habit: Habit,
        rng: ChaCha8Rng,
    ) -> Result<Self, SimError> {
        let model = model_number(&spec.model);
        let (plate, family) = match model {
            "7017" | "7017F" | "7017R" | "7017RC" | "7018" | "7018P" | "7018R" | "7033" => {
                analog_in::build(spec, model, line, &habit, rng.clone())?
            }
            "7021" | "7021P" | "7022" | "7024" => analog_out::build(spec, model, line, &habit)?,
            "7080" | "7080B" | "7080D" => counter::build(spec, model, line)?,
            other => match shape::shape(other) {
                Some(shape) => digital::build(spec, shape, line)?,
                None => return Err(unknown_model(spec)),
            },
        };
        Ok(Self {
            id: spec.id.clone(),
            line: spec.line.clone(),
            plate,
            family,
            habit,
            rng,
        })
    }

    /// Key of its table.
    pub fn id(&self) -> &str {
        &self.id
    }

    /// Line it hangs on.
    pub fn line(&self) -> &str {
        &self.line
    }

    /// Plate, for counts and faults.
    pub fn plate(&self) -> &Plate {
        &self.plate
    }

    /// Plate, for faults.
    pub fn plate_mut(&mut self) -> &mut Plate {
        &mut self.plate
    }

    /// Is meant by a request for `address`, and listens at the rate of its host; none is any.
    pub fn hears(&self, address: Address, host_baud: Option<u32>) -> bool {
        let meant = match address {
            Address::Everybody => true,
            Address::Module(address) => self.plate.hears_at(address),
        };
        meant && host_baud.is_none_or(|baud| baud == self.plate.baud())
    }

    /// Microseconds from the end of a request to the first character of its reply.
    pub fn next_latency_us(&mut self) -> u64 {
        self.habit.next_latency_us(&mut self.rng) + self.plate.response_delay_us()
    }

    /// Instant of its next event of any kind, `u64::MAX` for none.
    pub fn next_us(&self) -> u64 {
        let expiry = self.plate.watchdog.expires_us().unwrap_or(u64::MAX);
        expiry.min(self.family.next_us())
    }

    /// Carries out what is due at `now_us`.
    pub fn run(&mut self, plant: &mut dyn Plant, now_us: u64) {
        let mut at = Terminals {
            plant,
            module: &self.id,
            now_us,
        };
        if self
            .plate
            .watchdog
            .expires_us()
            .is_some_and(|due| due <= now_us)
        {
            trip(&mut self.plate, self.family.as_mut(), &mut at);
        }
        if self.family.next_us() <= now_us {
            self.family.run(&self.plate, &mut at);
        }
    }

    /// The module is found under power, in the state its table says.
    pub fn energise(&mut self, plant: &mut dyn Plant, now_us: u64) {
        let mut at = Terminals {
            plant,
            module: &self.id,
            now_us,
        };
        self.family.energise(&self.plate, &mut at);
    }

    /// The module restarts in operation (a fault, or its own hardware watchdog).
    pub fn reset(&mut self, plant: &mut dyn Plant, now_us: u64) {
        self.plate.power_cycled();
        self.family.restart(&self.plate);
        self.energise(plant, now_us);
    }

    /// The host watchdog expires now, whoever fed it.
    pub fn trip(&mut self, plant: &mut dyn Plant, now_us: u64) {
        let mut at = Terminals {
            plant,
            module: &self.id,
            now_us,
        };
        trip(&mut self.plate, self.family.as_mut(), &mut at);
    }

    /// Hears `text` (without CR) and gives the bytes of its reply, if it replies.
    pub fn hear(&mut self, text: &[u8], plant: &mut dyn Plant, now_us: u64) -> Option<Vec<u8>> {
        let with_checksum = self.plate.uses_checksum();
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
            broadcast(&mut self.plate, self.family.as_mut(), &request, &mut at);
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
        let answer = self.family.answer(&mut self.plate, request, &mut at);
        if answer != Answer::Unknown {
            return answer;
        }
        let family = &self.family;
        let answer = self
            .plate
            .answer(request, now_us, |code, format| family.fits(code, format));
        if request.lead == b'%' {
            self.family.configured(&self.plate, &mut at);
        }
        answer
    }
}

fn trip(plate: &mut Plate, family: &mut dyn Family, at: &mut Terminals<'_>) {
    plate.watchdog.trip();
    plate.eeprom_writes += 1;
    family.make_safe(plate, at);
}

fn broadcast(
    plate: &mut Plate,
    family: &mut dyn Family,
    request: &Request<'_>,
    at: &mut Terminals<'_>,
) {
    match (request.lead, request.body) {
        (b'~', []) => plate.watchdog.feed(at.now_us),
        (b'#', []) => family.sample(at),
        (_, _) => {}
    }
}

/// `I-7017F` is a `7017F`; the LED variants of other families behave like the plain ones.
fn model_number(model: &str) -> &str {
    let number = model.trim_start_matches("I-").trim_start_matches("M-");
    match number {
        "7080D" => number,
        other => other.strip_suffix('D').unwrap_or(other),
    }
}

fn unknown_model(spec: &ModuleSpec) -> SimError {
    SimError::UnknownModel {
        module: spec.id.clone(),
        model: spec.model.clone(),
    }
}

/// A family together with its plate, ready to be put on a line.
pub type Built = (Plate, Box<dyn Family>);
