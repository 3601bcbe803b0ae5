//! Faults of lines and modules: a layer between what a module answers and what the host receives.
//!
//! | file | family |
//! |---|---|
//! | `loss` | what does not arrive |
//! | `timing` | what arrives too late |
//! | `damage` | what arrives as something else |
//! | `upset` | modules that restart, trip, or are other products |
//! | `port` | lines that are dead, ports that vanish and come back |
//!
//! Any number of them can be asked for together, and one more than once. How a value is written: `value`.
//! Draws come from a stream of their own, so that a fault changes nothing else of the rig. LineFaults of the world
//! (mechanism, board, part) are listed in `sim.toml`.

mod damage;
mod loss;
mod port;
mod timing;
mod upset;
mod value;

use rand_chacha::ChaCha8Rng;

use crate::error::SimError;
use crate::module::habit;
pub use upset::{Event, Timed};
use value::Asked;

/// One fault that can be asked for.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct FaultInfo {
    /// Name for `--fault`.
    pub name: String,
    /// Unit or form of the value.
    pub unit: String,
    /// Value when none is given.
    pub default: String,
    /// What happens.
    pub what: String,
}

/// A fault of this layer.
struct Known {
    name: &'static str,
    unit: &'static str,
    default: &'static str,
    what: &'static str,
}

/// Faults that are of one kind.
trait Family {
    fn list(&self) -> &'static [Known];

    /// Takes one of the list.
    fn add(&mut self, asked: &Asked<'_>) -> Result<(), SimError>;

    /// Every module or line that was named.
    fn targets(&self) -> Vec<&str>;
}

/// Names, units and defaults of the faults of this layer.
pub fn list() -> Vec<FaultInfo> {
    let info = |known: &Known| FaultInfo {
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

/// The faults that strike lines and modules.
pub struct LineFaults {
    rng: ChaCha8Rng,
    loss: loss::Loss,
    timing: timing::Timing,
    damage: damage::Damage,
    upset: upset::Upset,
    port: port::Port,
}

impl LineFaults {
    /// None at all.
    pub fn none(seed: u64) -> Self {
        Self {
            rng: habit::stream(seed, "faults of the line"),
            loss: loss::Loss::default(),
            timing: timing::Timing::default(),
            damage: damage::Damage::default(),
            upset: upset::Upset::default(),
            port: port::Port::default(),
        }
    }

    /// Adds one; `false` when the name is none of this layer's.
    ///
    /// # Errors
    /// The value does not have the form of the fault.
    pub fn add(&mut self, name: &str, value: Option<&str>) -> Result<bool, SimError> {
        self.add_from(0, name, value)
    }

    /// Adds one whose times are counted from `now_us`.
    ///
    /// # Errors
    /// As [`LineFaults::add`].
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
                let asked = Asked::read(name, value.unwrap_or(known.default))?;
                family.add(&asked.from(now_us))?;
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

    /// Every module or line that a fault names.
    pub fn targets(&self) -> impl Iterator<Item = &str> {
        let families = self.families().into_iter();
        families.flat_map(|family| family.targets())
    }

    /// The line carries nothing now.
    pub fn line_dead(&self, line: &str, now_us: u64) -> bool {
        self.port.line_dead(line, now_us)
    }

    /// When the port of a line is back, if it is away now.
    pub fn port_back_us(&self, line: &str, now_us: u64) -> Option<u64> {
        self.port.back_us(line, now_us)
    }

    /// When the port of a line goes away next.
    pub fn next_port_loss_us(&self, line: &str, now_us: u64) -> Option<u64> {
        self.port.next_loss_us(line, now_us)
    }

    /// A request has come in: it may cost the port.
    pub fn may_lose_port(&mut self, line: &str, now_us: u64) {
        self.port.may_lose(line, &mut self.rng, now_us);
    }

    /// Nobody hears the request that has just come in.
    pub fn swallows(&mut self, now_us: u64) -> bool {
        self.loss.swallows(&mut self.rng, now_us)
    }

    /// The module hears, but is silent.
    pub fn silent(&self, module: &str, now_us: u64) -> bool {
        self.loss.silences(module, now_us)
    }

    /// Another product sits at the address of this module.
    pub fn is_wrong_type(&self, module: &str) -> bool {
        self.upset.is_wrong_type(module)
    }

    /// What happens to a module just before it hears a request.
    pub fn before_a_request(&mut self, now_us: u64) -> Option<Event> {
        self.upset.before_a_request(&mut self.rng, now_us)
    }

    /// The next event that was asked for by name and is due, taken out.
    pub fn due(&mut self, now_us: u64) -> Option<Timed> {
        self.upset.due(now_us)
    }

    /// A second module may answer together with `module`.
    pub fn clash(&mut self, module: &str, reply: &mut Vec<u8>, now_us: u64) {
        self.damage.clash(module, reply, &mut self.rng, now_us);
    }

    /// What becomes of a reply: extra microseconds and the bytes, `None` when nothing arrives.
    pub fn strike(
        &mut self,
        request: &[u8],
        mut reply: Vec<u8>,
        now_us: u64,
    ) -> Option<(u64, Vec<u8>)> {
        let rng = &mut self.rng;
        self.loss.strike(&mut reply, rng, now_us);
        self.damage.strike(request, &mut reply, rng, now_us);
        let extra_us = self.timing.extra_us(rng, now_us);
        (!reply.is_empty()).then_some((extra_us, reply))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn every_listed_fault_can_be_asked_for_without_a_value() {
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
            assert!(!faults.swallows(now_us) && !faults.line_dead("measure", now_us));
            assert_eq!(faults.before_a_request(now_us), None);
            let reply = faults.strike(b"#01", b">\r".to_vec(), now_us);
            assert_eq!(reply, Some((0, b">\r".to_vec())));
        }
        assert_eq!(faults.rng, LineFaults::none(1).rng);
    }

    #[test]
    fn a_fault_of_a_running_rig_counts_its_times_from_now() {
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
        let struck = faults.strike(b"#010", b">7FFF\r".to_vec(), 0);
        assert_eq!(struck, Some((351_000, b"#010\r>7FFF\r".to_vec())));
    }
}
