//! Faults of lines and modules: a layer between the modules and their host that loses, delays or alters replies.
//!
//! | file | family |
//! |---|---|
//! | `loss` | lost requests and replies, silent modules |
//! | `timing` | late replies |
//! | `damage` | altered replies |
//! | `upset` | modules that restart, trip, or are replaced by another product |
//! | `port` | dead lines, ports that vanish and come back |
//!
//! `instrument` has the faults of SCPI instruments, which `scpi/` applies. A new fault of instruments is a variant in
//! that file, with its line in that file's `LIST`.
//!
//! Faults combine freely, and a name may appear more than once. `value.rs` parses the text after the name: probability,
//! duration, window. The faults draw from their own random stream, so that adding a fault changes no other draw of the
//! rig. `sim.toml` lists the faults of the world (mechanism, board, part).

mod damage;
pub mod instrument;
mod loss;
mod port;
mod timing;
mod upset;
mod value;

use rand_chacha::ChaCha8Rng;

use crate::error::SimError;
use crate::module::tolerances;
pub use upset::{Event, TimedEvent};
use value::FaultRequest;

/// One fault that `--fault` accepts, for listing.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct FaultInfo {
    /// Name for `--fault`.
    pub name: String,
    /// Unit or form of the value, as text.
    pub unit: String,
    /// Value that applies when the command gives none.
    pub default: String,
    /// Effect of the fault, one English phrase.
    pub what: String,
}

/// One line of a family's fault list.
struct FaultEntry {
    name: &'static str,
    unit: &'static str,
    default: &'static str,
    what: &'static str,
}

/// A family of faults, with those of its faults that the command line or a script has requested.
trait Family {
    fn list(&self) -> &'static [FaultEntry];

    /// Adds one fault of the list.
    fn add(&mut self, request: &FaultRequest<'_>) -> Result<(), SimError>;

    /// Returns every module or line that a fault names.
    fn targets(&self) -> Vec<&str>;
}

/// Returns name, unit, default and effect of every fault of this layer.
pub fn list() -> Vec<FaultInfo> {
    let info = |known: &FaultEntry| FaultInfo {
        name: known.name.into(),
        unit: known.unit.into(),
        default: known.default.into(),
        what: known.what.into(),
    };
    let none = LineFaults::none(0);
    let families = none.families().into_iter();
    families
        .flat_map(|family| family.list().iter().map(info))
        .collect()
}

/// Active faults of lines and modules, with the random stream of their draws.
pub struct LineFaults {
    rng: ChaCha8Rng,
    loss: loss::Loss,
    timing: timing::Timing,
    damage: damage::Damage,
    upset: upset::Upset,
    port: port::Port,
}

impl LineFaults {
    /// Creates a layer without faults; `seed` selects its random stream.
    pub fn none(seed: u64) -> Self {
        Self {
            rng: tolerances::stream(seed, "faults of the line"),
            loss: loss::Loss::default(),
            timing: timing::Timing::default(),
            damage: damage::Damage::default(),
            upset: upset::Upset::default(),
            port: port::Port::default(),
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
    /// Fails as [`LineFaults::add`] does.
    pub fn add_from(
        &mut self,
        now_us: u64,
        name: &str,
        value: Option<&str>,
    ) -> Result<bool, SimError> {
        let families: [&mut dyn Family; 5] = [
            &mut self.loss,
            &mut self.timing,
            &mut self.damage,
            &mut self.upset,
            &mut self.port,
        ];
        for family in families {
            let known = family.list().iter().find(|known| known.name == name);
            if let Some(known) = known {
                let request = FaultRequest::read(name, value.unwrap_or(known.default))?;
                family.add(&request.from(now_us))?;
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn families(&self) -> [&dyn Family; 5] {
        [
            &self.loss,
            &self.timing,
            &self.damage,
            &self.upset,
            &self.port,
        ]
    }

    /// Returns every module or line that a fault names.
    pub fn targets(&self) -> impl Iterator<Item = &str> {
        let families = self.families().into_iter();
        families.flat_map(|family| family.targets())
    }

    /// Checks whether the line is dead now.
    pub fn line_dead(&self, line: &str, now_us: u64) -> bool {
        self.port.line_dead(line, now_us)
    }

    /// Returns the instant at which a lost port comes back; `None` while the port is present.
    pub fn port_back_us(&self, line: &str, now_us: u64) -> Option<u64> {
        self.port.restored_us(line, now_us)
    }

    /// Returns the instant at which the port of a line vanishes next.
    pub fn next_port_loss_us(&self, line: &str, now_us: u64) -> Option<u64> {
        self.port.next_loss_us(line, now_us)
    }

    /// Draws whether the request that has just arrived makes the port vanish.
    pub fn may_lose_port(&mut self, line: &str, now_us: u64) {
        self.port.may_lose(line, &mut self.rng, now_us);
    }

    /// Draws whether the request that has just arrived is lost.
    pub fn loses_request(&mut self, now_us: u64) -> bool {
        self.loss.loses_request(&mut self.rng, now_us)
    }

    /// Checks whether a fault suppresses every reply of the module.
    pub fn silent(&self, module: &str, now_us: u64) -> bool {
        self.loss.silences(module, now_us)
    }

    /// Checks whether another product replaces this module.
    pub fn is_wrong_type(&self, module: &str) -> bool {
        self.upset.is_wrong_type(module)
    }

    /// Draws an upset that strikes a module just before it receives a request.
    pub fn before_a_request(&mut self, now_us: u64) -> Option<Event> {
        self.upset.before_a_request(&mut self.rng, now_us)
    }

    /// Removes and returns the next timed event that is due.
    pub fn due(&mut self, now_us: u64) -> Option<TimedEvent> {
        self.upset.due(now_us)
    }

    /// When the fault strikes, superposes on the reply of `module` that of a second module at the same address.
    pub fn clash(&mut self, module: &str, reply: &mut Vec<u8>, now_us: u64) {
        self.damage.clash(module, reply, &mut self.rng, now_us);
    }

    /// Applies loss, damage and delay to a reply; returns the extra delay in microseconds and the bytes, or `None` when
    /// nothing arrives.
    pub fn apply(
        &mut self,
        request: &[u8],
        mut reply: Vec<u8>,
        now_us: u64,
    ) -> Option<(u64, Vec<u8>)> {
        let rng = &mut self.rng;
        self.loss.apply(&mut reply, rng, now_us);
        self.damage.apply(request, &mut reply, rng, now_us);
        let extra_us = self.timing.extra_us(rng, now_us);
        (!reply.is_empty()).then_some((extra_us, reply))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn every_listed_fault_has_a_default_value() {
        let mut all = LineFaults::none(1);
        for fault in list() {
            assert!(all.add(&fault.name, None).unwrap(), "{}", fault.name);
        }
        assert!(!all.add("jam", None).unwrap());
        assert!(all.targets().any(|target| target == "board_do"));
    }

    #[test]
    fn a_rig_without_faults_changes_nothing_and_draws_nothing() {
        let mut faults = LineFaults::none(1);
        for now_us in [0, 5_000_000] {
            assert!(!faults.loses_request(now_us) && !faults.line_dead("measure", now_us));
            assert_eq!(faults.before_a_request(now_us), None);
            let reply = faults.apply(b"#01", b">\r".to_vec(), now_us);
            assert_eq!(reply, Some((0, b">\r".to_vec())));
        }
        assert_eq!(faults.rng, LineFaults::none(1).rng);
    }

    #[test]
    fn a_fault_added_later_counts_its_times_from_now() {
        let mut faults = LineFaults::none(1);
        let value = Some("motion@1..3");
        assert!(faults.add_from(10_000_000, "line_cut", value).unwrap());
        for (now_us, dead) in [
            (2_000_000, false),
            (10_999_999, false),
            (11_000_000, true),
            (13_000_000, false),
        ] {
            assert_eq!(faults.line_dead("motion", now_us), dead, "{now_us}");
        }
    }

    #[test]
    fn faults_combine() {
        let mut faults = LineFaults::none(1);
        for (name, value) in [("echo", "1"), ("late", "1/350"), ("delay", "1")] {
            assert!(faults.add(name, Some(value)).unwrap());
        }
        let reply = faults.apply(b"#010", b">7FFF\r".to_vec(), 0);
        assert_eq!(reply, Some((351_000, b"#010\r>7FFF\r".to_vec())));
    }
}
