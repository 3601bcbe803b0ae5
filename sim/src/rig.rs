//! The rig: modules on lines, the world behind them, and the order of events.
//!
//! The rig runs from event to event. Before a module answers a request, every earlier event happens in order of
//! time: conversions, steps of ramps, expiries of watchdogs, timed faults; events of one instant follow the order
//! of modules in the configuration. The world advances to each of these instants. Rig time never runs backwards:
//! a request with a time before the last event counts as arriving at that event. A module serves one request at a
//! time: its replies keep their order, and a late reply delays the next one. Meanwhile the module keeps one
//! request and misses all others. Instruments act in the same order of events, at one instant after the modules.

use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

use crate::config::{LineSpec, READER};
use crate::dcon;
use crate::error::SimError;
use crate::fault::{Event, LineFaults};
use crate::journal::{Entry, JournaledWorld, LateReplies};
use crate::line::wire_us;
use crate::module::Module;
use crate::scpi::bench::Instruments;
use crate::shared;
use crate::terminal::Plant;
use crate::truth::WorldRecord;
use crate::uart;

/// A world: terminals for the modules, facts for the tests.
pub trait WorldModel: Plant + WorldRecord + Send {}

impl<T: Plant + WorldRecord + Send> WorldModel for T {}

/// Bytes that a line sends to its host.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reply {
    /// Rig time at which the last character arrives, microseconds.
    pub at_us: u64,
    /// All bytes, CR included.
    pub bytes: Vec<u8>,
}

/// Modules, lines and world, with the clock of the rig.
pub struct Rig {
    scene: JournaledWorld,
    modules: Vec<Module>,
    /// Instant of the next event of each module, microseconds.
    due_us: Vec<u64>,
    /// Interval in which each module is busy with a late reply, microseconds.
    serving_us: Vec<(u64, u64)>,
    lines: Vec<LineSpec>,
    faults: LineFaults,
    instruments: Option<Instruments>,
    /// Instant of the wall clock at rig time 0, once the rig runs in real time.
    origin: Option<Instant>,
    now_us: u64,
}

impl Rig {
    /// Builds a rig at rig time 0 with all modules powered.
    pub fn new(
        scene: Box<dyn WorldModel>,
        modules: Vec<Module>,
        lines: Vec<LineSpec>,
        faults: LineFaults,
    ) -> Self {
        let mut rig = Self {
            due_us: vec![u64::MAX; modules.len()],
            serving_us: vec![(0, 0); modules.len()],
            scene: JournaledWorld::new(scene),
            modules,
            lines,
            faults,
            instruments: None,
            origin: None,
            now_us: 0,
        };
        rig.scene.advance(0);
        for place in 0..rig.modules.len() {
            let module = &mut rig.modules[place];
            if rig.faults.is_wrong_type(module.id()) {
                module.base_mut().replace_product("7000");
            }
            module.energise(&mut rig.scene, 0);
            rig.due_us[place] = module.next_us();
        }
        rig
    }

    /// Puts instruments around the circuit of the world.
    pub fn with_instruments(self, instruments: Option<Instruments>) -> Self {
        Self {
            instruments,
            ..self
        }
    }

    /// Returns the instruments; `None` for a rig without them.
    pub(crate) fn instruments_mut(&mut self) -> Option<&mut Instruments> {
        self.instruments.as_mut()
    }

    /// Starts to follow the wall clock from the present rig time. Returns the instant of rig time 0.
    pub(crate) fn start_real_time(&mut self) -> Instant {
        let passed = Duration::from_micros(self.now_us);
        let origin = Instant::now().checked_sub(passed);
        let origin = origin.unwrap_or_else(Instant::now);
        self.origin = Some(origin);
        origin
    }

    /// Returns the instant of the wall clock at rig time 0.
    pub(crate) fn real_origin(&mut self) -> Instant {
        self.origin.unwrap_or_else(|| self.start_real_time())
    }

    /// Returns the lines in the order of the configuration.
    pub fn lines(&self) -> &[LineSpec] {
        &self.lines
    }

    /// Returns rig time, microseconds.
    pub fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Runs every event that is due up to `t_us`.
    pub fn advance(&mut self, t_us: u64) {
        self.strike_timed(t_us);
        self.run_events(t_us);
        self.now_us = self.now_us.max(t_us);
        self.scene.advance(self.now_us);
    }

    /// Delivers a request (without CR) on a line at `t_us`; returns the reply, if any.
    pub fn exchange(&mut self, line: usize, text: &[u8], t_us: u64) -> Option<Reply> {
        self.exchange_at(line, None, text, t_us)
    }

    /// Delivers a request as [`Self::exchange`] does, sent at the baud rate of the host; with `None` every module
    /// receives it.
    pub fn exchange_at(
        &mut self,
        line: usize,
        host_baud: Option<u32>,
        text: &[u8],
        t_us: u64,
    ) -> Option<Reply> {
        self.advance(t_us);
        let now_us = self.now_us;
        self.scene.note_request(now_us);
        let spec = self.lines.get(line)?;
        let (name, baud) = (spec.name.clone(), host_baud.unwrap_or(spec.baud));
        self.faults.may_lose_port(&name, now_us);
        if self.faults.line_dead(&name, now_us)
            || self.faults.port_back_us(&name, now_us).is_some()
            || self.faults.loses_request(now_us)
        {
            return None;
        }
        let address = dcon::addressee(text)?;
        let mut reply: Option<(u64, Vec<u8>)> = None;
        let mut last = None;
        for place in 0..self.modules.len() {
            let module = &self.modules[place];
            if module.line() != name || !module.is_reached_by(address, host_baud) {
                continue;
            }
            let answer = self.answer(place, text);
            last = Some(place);
            reply = match (reply, answer) {
                (Some(first), Some(second)) => Some(merged_replies(first, second, baud)),
                (first, second) => first.or(second),
            };
        }
        let (latency_us, bytes) = reply?;
        let (extra_us, bytes) = self.faults.apply(text, bytes, now_us)?;
        let at_us = now_us + latency_us + extra_us + wire_us(bytes.len(), baud);
        if let Some(place) = last
            && (extra_us > 0 || self.serving_us[place].0 > now_us)
        {
            self.serving_us[place].1 = at_us;
        }
        Some(Reply { at_us, bytes })
    }

    /// Returns the bytes that a line sends by itself up to `t_us`: the codes of the code reader. Nothing arrives while
    /// the line is dead or its port is lost.
    pub fn unprompted(&mut self, line: usize, t_us: u64) -> Vec<Reply> {
        let is_reader = |spec: &&LineSpec| spec.name == READER;
        let Some(spec) = self.lines.get(line).filter(is_reader).cloned() else {
            return Vec::new();
        };
        self.advance(t_us);
        let now_us = self.now_us;
        let codes = self.record().take_codes();
        if self.faults.line_dead(READER, now_us) || self.port_back_us(line, now_us).is_some() {
            return Vec::new();
        }
        let sent = codes.into_iter().filter_map(|code| {
            let bytes = [code.as_bytes(), b"\r"].concat();
            let (extra_us, bytes) = self.faults.apply(b"", bytes, now_us)?;
            let at_us = now_us + extra_us + wire_us(bytes.len(), spec.baud);
            Some(Reply { at_us, bytes })
        });
        sent.collect()
    }

    /// Lets one module answer; returns the delay in microseconds and the bytes.
    fn answer(&mut self, place: usize, text: &[u8]) -> Option<(u64, Vec<u8>)> {
        let now_us = self.now_us;
        let (begun_us, free_us) = self.serving_us[place];
        if now_us < begun_us {
            return None;
        }
        let upset = self.faults.before_a_request(now_us);
        let module = &mut self.modules[place];
        if let Some(event) = upset {
            apply_event(module, event, &mut self.scene, now_us);
        }
        let silent = self.faults.silent(module.id(), now_us);
        let heard = module.serve(text, &mut self.scene, now_us);
        self.due_us[place] = module.next_us();
        let mut bytes = heard.filter(|_| !silent)?;
        let begin_us = now_us.max(free_us);
        self.serving_us[place].0 = begin_us;
        let latency_us = begin_us - now_us + module.next_latency_us();
        self.faults.clash(module.id(), &mut bytes, now_us);
        Some((latency_us, bytes))
    }

    /// Returns the instant at which a lost port comes back; `None` while the port is present at `t_us`.
    pub fn port_back_us(&self, line: usize, t_us: u64) -> Option<u64> {
        let spec = self.lines.get(line)?;
        self.faults.port_back_us(&spec.name, t_us)
    }

    /// Returns the instant after `t_us` at which the port of a line vanishes next.
    pub fn next_port_loss_us(&self, line: usize, t_us: u64) -> Option<u64> {
        let spec = self.lines.get(line)?;
        self.faults.next_port_loss_us(&spec.name, t_us)
    }

    /// Counts the EEPROM writes of all modules.
    pub fn eeprom_writes(&self) -> u64 {
        self.modules
            .iter()
            .map(|module| module.base().eeprom_writes)
            .sum()
    }

    /// Counts the EEPROM writes of each module, by identifier.
    pub fn eeprom_writes_by_module(&self) -> Vec<(String, u64)> {
        self.modules
            .iter()
            .map(|module| (module.id().to_owned(), module.base().eeprom_writes))
            .collect()
    }

    /// Records that the reply of line `number`, due at `t_us`, was sent late.
    pub(crate) fn record_late(&mut self, number: usize, t_us: u64, late_us: u64) {
        let name = self.lines.get(number).map_or("", |line| line.name.as_str());
        self.scene.record_late(name, t_us, late_us);
    }

    /// Returns the replies that this computer sent late, in real time.
    pub fn late_replies(&self) -> LateReplies {
        self.scene.late()
    }

    /// Starts a journal of the outputs, from now on.
    pub fn journal(&mut self) -> Receiver<Entry> {
        self.scene.listen()
    }

    /// Activates a fault, `NAME` or `NAME=VALUE`; times in the value count from now.
    ///
    /// # Errors
    /// Fails when the fault is unknown, its value is unfit, or it applies only to the start.
    pub fn inject(&mut self, text: &str) -> Result<(), SimError> {
        let (name, value) = shared::split(text);
        self.scene.record_fault(text);
        if self.faults.add_from(self.now_us, name, value)? {
            let known = |target: &str| {
                self.modules.iter().any(|module| module.id() == target)
                    || self.lines.iter().any(|line| line.name == target)
            };
            return shared::check_targets(self.faults.targets(), shared::RIG_TARGETS, known);
        }
        if let Some(instruments) = &mut self.instruments
            && instruments.faults.add_from(self.now_us, name, value)?
        {
            return instruments.check_targets();
        }
        let number = value.map(|text| shared::number(name, text)).transpose()?;
        self.record().inject(name, number)
    }

    /// Returns the record of the world, which also starts and ends the faults of the world, but not those of lines and
    /// modules: these end with their windows.
    pub fn record(&mut self) -> &mut dyn WorldRecord {
        self.scene.record()
    }

    fn run_events(&mut self, t_us: u64) {
        while let Some((place, due_us)) = self.earliest()
            && due_us <= t_us
        {
            self.run_instruments(due_us);
            let due_us = due_us.max(self.now_us);
            self.now_us = due_us;
            self.scene.advance(due_us);
            let module = &mut self.modules[place];
            let was_tripped = module.base().watchdog.tripped();
            module.run(&mut self.scene, due_us);
            if module.base().watchdog.tripped() && !was_tripped {
                self.scene.record_expiry(module.id());
            }
            self.due_us[place] = module.next_us();
        }
        self.run_instruments(t_us.saturating_add(1));
    }

    /// Lets the instruments act at each of their instants before `end_us`.
    fn run_instruments(&mut self, end_us: u64) {
        let Some(instruments) = &mut self.instruments else {
            return;
        };
        while let Some((at_us, number)) = instruments.next().filter(|(at_us, _)| *at_us < end_us) {
            self.now_us = self.now_us.max(at_us);
            self.scene.advance(self.now_us);
            let Some(circuit) = self.scene.circuit() else {
                return;
            };
            self.now_us = instruments.act(number, self.now_us, end_us, circuit);
        }
    }

    fn earliest(&self) -> Option<(usize, u64)> {
        self.due_us
            .iter()
            .copied()
            .enumerate()
            .min_by_key(|(_, due_us)| *due_us)
    }

    fn strike_timed(&mut self, t_us: u64) {
        while let Some(timed) = self.faults.due(t_us) {
            self.run_events(timed.at_us);
            self.now_us = self.now_us.max(timed.at_us);
            self.scene.advance(self.now_us);
            let target = |module: &Module| module.id() == timed.target;
            if let Some(place) = self.modules.iter().position(target) {
                let module = &mut self.modules[place];
                apply_event(module, timed.event, &mut self.scene, self.now_us);
                self.due_us[place] = module.next_us();
            }
        }
    }
}

fn apply_event(module: &mut Module, event: Event, plant: &mut dyn Plant, now_us: u64) {
    match event {
        Event::Reset => module.reset(plant, now_us),
        Event::Trip => module.trip(plant, now_us),
    }
}

/// Merges the replies of two modules at one address; the earlier reply sets the delay.
fn merged_replies(first: (u64, Vec<u8>), second: (u64, Vec<u8>), baud: u32) -> (u64, Vec<u8>) {
    let apart_us = second.0 as i64 - first.0 as i64;
    let apart_bits = apart_us * i64::from(baud) / 1_000_000;
    let heard = uart::superposed(&first.1, &second.1, apart_bits);
    (first.0.min(second.0), heard)
}
