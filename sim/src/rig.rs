//! The rig: modules on lines, the world behind them, and the order of events.
//!
//! Nothing is stepped through in small steps. Before a request is answered everything that is due
//! earlier happens in order of time: conversions, steps of ramps, expiries of watchdogs, timed
//! faults. At equal times modules come in the order of the configuration. The world is advanced to
//! each of these instants. Rig time never runs backwards: a request that comes in with an earlier
//! time than something already done is taken as coming now.

use crate::config::LineSpec;
use crate::dcon;
use crate::fault::{Event, Faults};
use crate::line::wire_us;
use crate::module::Module;
use crate::terminal::Plant;

/// What the world knows and no module ever tells.
pub trait Record {
    /// One object per lot part that has entered the nest, in order.
    fn truth(&mut self) -> Vec<serde_json::Value>;

    /// Bodies that touched where they must not, in words.
    fn crashes(&mut self) -> Vec<String>;
}

/// A world: terminals in front, truth behind.
pub trait Scene: Plant + Record + Send {}

impl<T: Plant + Record + Send> Scene for T {}

/// Bytes that a line sends to its host.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reply {
    /// Rig time at which the last character has arrived, microseconds.
    pub at_us: u64,
    /// Everything, CR included.
    pub bytes: Vec<u8>,
}

/// Modules, lines and world.
pub struct Rig {
    scene: Box<dyn Scene>,
    modules: Vec<Module>,
    /// Next event of each module.
    due_us: Vec<u64>,
    lines: Vec<LineSpec>,
    faults: Faults,
    now_us: u64,
}

impl Rig {
    /// Puts everything together at rig time 0, modules under power.
    pub fn new(
        scene: Box<dyn Scene>,
        modules: Vec<Module>,
        lines: Vec<LineSpec>,
        faults: Faults,
    ) -> Self {
        let mut rig = Self {
            due_us: vec![u64::MAX; modules.len()],
            scene,
            modules,
            lines,
            faults,
            now_us: 0,
        };
        rig.scene.advance(0);
        for place in 0..rig.modules.len() {
            let module = &mut rig.modules[place];
            if rig.faults.wrong_type.iter().any(|id| id == module.id()) {
                module.plate_mut().pose_as("7000");
            }
            module.energise(rig.scene.as_mut(), 0);
            rig.due_us[place] = module.next_us();
        }
        rig
    }

    /// Lines in the order of the configuration.
    pub fn lines(&self) -> &[LineSpec] {
        &self.lines
    }

    /// Rig time, microseconds.
    pub fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Lets everything happen that is due up to `t_us`.
    pub fn advance(&mut self, t_us: u64) {
        self.strike_timed(t_us);
        self.run_events(t_us);
        self.now_us = self.now_us.max(t_us);
        self.scene.advance(self.now_us);
    }

    /// A request (without CR) has arrived on a line at `t_us`; gives the reply, if there is one.
    pub fn exchange(&mut self, line: usize, text: &[u8], t_us: u64) -> Option<Reply> {
        self.advance(t_us);
        let now_us = self.now_us;
        let address = dcon::addressee(text)?;
        let spec = self.lines.get(line)?;
        if self.faults.line_dead(&spec.name, now_us) {
            return None;
        }
        let mut reply: Option<(u64, Vec<u8>)> = None;
        for (place, module) in self.modules.iter_mut().enumerate() {
            if module.line() != spec.name || !module.hears(address) {
                continue;
            }
            let silent = self.faults.silent(module.id(), now_us);
            let heard = module.hear(text, self.scene.as_mut(), now_us);
            self.due_us[place] = module.next_us();
            let Some(mut bytes) = heard.filter(|_| !silent) else {
                continue;
            };
            let latency_us = module.next_latency_us();
            if self.faults.clashes(module.id()) {
                Faults::collide(&mut bytes, b"?00\r");
            }
            match &mut reply {
                None => reply = Some((latency_us, bytes)),
                Some((_, first)) => Faults::collide(first, &bytes),
            }
        }
        let (latency_us, bytes) = reply?;
        let (extra_us, bytes) = self.faults.strike(text, bytes)?;
        let at_us = now_us + latency_us + extra_us + wire_us(bytes.len(), spec.baud);
        Some(Reply { at_us, bytes })
    }

    /// EEPROM writes of all modules so far.
    pub fn eeprom_writes(&self) -> u64 {
        self.modules
            .iter()
            .map(|module| module.plate().eeprom_writes)
            .sum()
    }

    /// EEPROM writes of each module so far.
    pub fn eeprom_writes_by_module(&self) -> Vec<(String, u64)> {
        self.modules
            .iter()
            .map(|module| (module.id().to_owned(), module.plate().eeprom_writes))
            .collect()
    }

    /// See [`Record::truth`].
    pub fn truth(&mut self) -> Vec<serde_json::Value> {
        self.scene.truth()
    }

    /// See [`Record::crashes`].
    pub fn crashes(&mut self) -> Vec<String> {
        self.scene.crashes()
    }

    fn run_events(&mut self, t_us: u64) {
        while let Some((place, due_us)) = self.earliest()
            && due_us <= t_us
        {
            let due_us = due_us.max(self.now_us);
            self.now_us = due_us;
            self.scene.advance(due_us);
            self.modules[place].run(self.scene.as_mut(), due_us);
            self.due_us[place] = self.modules[place].next_us();
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
        while self
            .faults
            .timed
            .first()
            .is_some_and(|timed| timed.at_us <= t_us)
        {
            let timed = self.faults.timed.remove(0);
            self.run_events(timed.at_us);
            self.now_us = self.now_us.max(timed.at_us);
            self.scene.advance(self.now_us);
            let target = |module: &Module| module.id() == timed.target;
            if let Some(place) = self.modules.iter().position(target) {
                let module = &mut self.modules[place];
                match timed.event {
                    Event::Reset => module.reset(self.scene.as_mut(), self.now_us),
                    Event::Trip => module.trip(self.scene.as_mut(), self.now_us),
                }
                self.due_us[place] = module.next_us();
            }
        }
    }
}
