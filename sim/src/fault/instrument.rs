//! Faults of instruments and their links; `value` describes the form of a value, with `INSTRUMENT:` before it where
//! only one instrument or adapter has the fault.

use rand_chacha::ChaCha8Rng;

use super::FaultInfo;
use super::value::{Chances, FaultRequest, wrong};
use crate::error::SimError;
use crate::module::tolerances;

/// A fault of an instrument or its link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)] // LIST says what each does.
pub enum InstrumentFault {
    ReplyLost,
    ReplyLate,
    ReplyTwice,
    ReplyJoined,
    ReplySplit,
    ReplyCrlf,
    BlockCut,
    BlockEmpty,
    BlockHuge,
    BlockNewline,
    ClosedBefore,
    ClosedInside,
    HalfKept,
    PortBusy,
    SendPaused,
    ErrorsOverflow,
    Local,
    PowerCycle,
    OverRange,
    NotANumber,
    WrongIdentity,
    AddressChanged,
}
use InstrumentFault as F;

/// Faults with name, unit, default and effect.
#[rustfmt::skip]
const LIST: [(F, &str, &str, &str); 22] = [
    (F::ReplyLost, "reply_lost", "0.01", "a reply never leaves"),
    (F::ReplyLate, "reply_late", "0.01/1500", "a reply leaves later by the given ms"),
    (F::ReplyTwice, "reply_twice", "0.01", "a reply leaves twice"),
    (F::ReplyJoined, "reply_joined", "0.01", "a reply waits and leaves before the next one"),
    (F::ReplySplit, "reply_split", "0.01", "a reply leaves byte by byte"),
    (F::ReplyCrlf, "reply_crlf", "1", "a reply ends in CR LF"),
    (F::BlockCut, "block_cut", "0.01", "a block ends in its middle"),
    (F::BlockEmpty, "block_empty", "0.01", "a block announces no byte"),
    (F::BlockHuge, "block_huge", "0.01", "a block announces 999999999 bytes"),
    (F::BlockNewline, "block_newline", "0.01", "the data of a block contain line feeds"),
    (F::ClosedBefore, "closed_before", "0.01", "the connection ends before a reply"),
    (F::ClosedInside, "closed_inside", "0.01", "the connection ends inside a reply"),
    (F::HalfKept, "half_kept", "1", "half a command of an ended connection precedes the next one's"),
    (F::PortBusy, "port_busy", "0.1", "a new connection is closed at once"),
    (F::SendPaused, "send_paused", "0.01/500", "the instrument sends nothing for the given ms, as after XOFF"),
    (F::ErrorsOverflow, "errors_overflow", "0.01", "the error queue overflows"),
    (F::Local, "local", "0.01", "the front panel takes control (local mode)"),
    (F::PowerCycle, "power_cycle", "0.01", "the instrument restarts and loses message and set-up"),
    (F::OverRange, "over_range", "0.01", "a measured value reads 9.9E37"),
    (F::NotANumber, "not_a_number", "0.01", "a measured value reads 9.91E37"),
    (F::WrongIdentity, "wrong_identity", "1", "another instrument answers *IDN?"),
    (F::AddressChanged, "address_changed", "0.01", "another program changes the address of the adapter"),
];

/// Returns name, unit, default and effect of every fault of this layer.
pub fn list() -> Vec<FaultInfo> {
    let info = |(_, name, default, what): &(F, &str, &str, &str)| FaultInfo {
        name: (*name).into(),
        unit: if default.contains('/') {
            "[NAME:]probability/ms"
        } else {
            "[NAME:]probability"
        }
        .into(),
        default: (*default).into(),
        what: (*what).into(),
    };
    LIST.iter().map(info).collect()
}

/// A requested fault.
struct Active {
    fault: InstrumentFault,
    /// Instrument or adapter; `None` for all.
    target: Option<String>,
    chances: Chances,
    for_us: u64,
}

/// Active faults of instruments, with their random stream.
pub struct InstrumentFaults {
    rng: ChaCha8Rng,
    active: Vec<Active>,
}

impl InstrumentFaults {
    /// Creates a layer without faults; `seed` selects its random stream.
    pub fn none(seed: u64) -> Self {
        let rng = tolerances::stream(seed, "faults of instruments");
        Self {
            rng,
            active: Vec::new(),
        }
    }

    /// Adds a fault; returns `false` when this layer has no fault of that name.
    ///
    /// # Errors
    /// Fails when the value does not have the form that the fault expects.
    pub fn add(&mut self, name: &str, value: Option<&str>) -> Result<bool, SimError> {
        self.add_from(0, name, value)
    }

    /// Adds a fault whose times count from `now_us`.
    ///
    /// # Errors
    /// Fails as [`InstrumentFaults::add`] does.
    pub fn add_from(
        &mut self,
        now_us: u64,
        name: &str,
        value: Option<&str>,
    ) -> Result<bool, SimError> {
        let Some((fault, _, default, _)) = LIST.iter().find(|(_, known, ..)| *known == name) else {
            return Ok(false);
        };
        let text = value.unwrap_or(default);
        let (target, text) = match text.split_once(':') {
            Some((target, rest)) => (Some(target.to_owned()), rest),
            None => (None, text),
        };
        let request = FaultRequest::read(name, text)?.from(now_us);
        let (probability, ms) = match (request.value.split_once('/'), default.split_once('/')) {
            (Some((probability, ms)), Some(_)) => (probability, ms),
            (None, Some((_, ms))) => (request.value, ms),
            (None, None) => (request.value, "0"),
            (Some(_), None) => return Err(wrong(name, text, "a probability from 0 to 1")),
        };
        let chances = Chances::one(request.probability_in(probability)?, request.window);
        let for_us = request.ms(ms)?;
        self.active.push(Active {
            fault: *fault,
            target,
            chances,
            for_us,
        });
        Ok(true)
    }

    /// Returns every instrument or adapter that a fault names.
    pub fn targets(&self) -> impl Iterator<Item = &str> {
        self.active.iter().filter_map(|it| it.target.as_deref())
    }

    /// Draws whether a fault strikes now; returns its duration, microseconds.
    pub fn strikes(&mut self, fault: InstrumentFault, name: &str, now_us: u64) -> Option<u64> {
        let rng = &mut self.rng;
        let mut mine = self.active.iter().filter(|it| {
            it.fault == fault && it.target.as_deref().is_none_or(|target| target == name)
        });
        let struck = mine.find(|it| it.chances.occurs(rng, now_us));
        struck.map(|it| it.for_us)
    }
}
