//! Passes of a batch: approach, rise through the operate window, turn, fall through the reset window.
//!
//! A pass turns as soon as the last live socket has switched, at the end of the window at the latest. Outside the windows
//! the set point moves at [`TRAVEL_K_PER_MIN`].

use crate::ramp::{BLEND_S, Ramp, SetPoint};

/// Rate between the windows, K/min.
pub const TRAVEL_K_PER_MIN: f64 = 10.0;
/// Distance before and after a window at which the set point moves at the rate of the pass, K, besides the lag at that
/// rate.
pub const MARGIN_K: f64 = 3.0;

/// Corners of a pass, at each of which the rate blends.
const CORNERS: f64 = 4.0;

/// A range of switching temperatures of parts, C.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Lowest, C.
    pub low_c: f64,
    /// Highest, C.
    pub high_c: f64,
}

/// One rise and one fall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pass {
    /// Rate within the windows, K/min.
    pub rate_k_per_min: f64,
    /// Temperatures at which parts may operate.
    pub operate: Window,
    /// Temperatures at which parts may reset.
    pub reset: Window,
}

impl Pass {
    /// Returns the pass with its slow rate from where parts switch on. It still goes to the far ends of its windows for a
    /// part that waits.
    #[must_use]
    pub fn entered(self, operate: Window, reset: Window) -> Self {
        Self {
            operate: Window {
                low_c: operate.low_c,
                ..self.operate
            },
            reset: Window {
                high_c: reset.high_c,
                ..self.reset
            },
            ..self
        }
    }

    /// Returns the planned time of the pass, s, with a part that waits to the ends of both windows and with the way from
    /// the end of another such pass; `lag_s`: the lag of the parts.
    pub fn longest_s(self, lag_s: f64) -> f64 {
        let planned = Planned { pass: self, lag_s };
        let ([start_c, turn_c], [top_c, end_c]) = (planned.rise(), planned.fall());
        let within_k = turn_c - start_c + top_c - end_c;
        let between_k = (start_c - end_c).abs() + (turn_c - top_c).abs();
        let minutes = within_k / self.rate_k_per_min + between_k / TRAVEL_K_PER_MIN;
        60.0 * minutes + CORNERS * BLEND_S
    }
}

/// A pass with the lag for which its corners leave room. Both change together, so that a pass under way keeps the
/// corners that its set point heads for.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Planned {
    pass: Pass,
    lag_s: f64,
}

impl Planned {
    /// Returns the temperatures at which the air begins and ends its rise at the rate of the pass, C.
    fn rise(&self) -> [f64; 2] {
        let (Window { low_c, high_c }, reach_k) = (self.pass.operate, self.reach_k());
        [low_c - reach_k, high_c + reach_k]
    }

    /// Returns the temperatures at which the air begins and ends its fall at the rate of the pass, C.
    fn fall(&self) -> [f64; 2] {
        let (Window { low_c, high_c }, reach_k) = (self.pass.reset, self.reach_k());
        [high_c + reach_k, low_c - reach_k]
    }

    fn reach_k(&self) -> f64 {
        MARGIN_K + self.pass.rate_k_per_min / 60.0 * self.lag_s
    }
}

/// Numbers of live sockets that have yet to switch in this pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Waiting {
    /// Sockets that have not operated.
    pub operate: usize,
    /// Sockets that have operated and not reset.
    pub reset: usize,
}

/// Phase of a pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// At [`TRAVEL_K_PER_MIN`] to the operate window.
    Approach,
    /// Through the operate window.
    Rise,
    /// At [`TRAVEL_K_PER_MIN`] to the reset window.
    Descent,
    /// Through the reset window.
    Fall,
    /// All passes are over; the set point heads for the temperature at which a person unloads.
    Cool,
}

/// State of the passes of a batch, stepped once a second.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    ramp: Ramp,
    passes: Vec<Planned>,
    number: usize,
    phase: Phase,
    unload_c: f64,
}

impl Program {
    /// Starts at the present temperature; `lag_s` is the expected lag of the parts, `unload_c` the temperature after
    /// the last pass.
    pub fn new(measured_c: f64, passes: Vec<Pass>, lag_s: f64, unload_c: f64) -> Self {
        let planned = |pass: Pass| Planned { pass, lag_s };
        let mut program = Self {
            ramp: Ramp::at(measured_c),
            passes: passes.into_iter().map(planned).collect(),
            number: 0,
            phase: Phase::Approach,
            unload_c,
        };
        program.enter(Phase::Approach);
        program
    }

    /// Returns the phase of this second.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// Returns the number of the pass, from 0.
    pub fn pass(&self) -> usize {
        self.number
    }

    /// Returns the set point of this second.
    pub fn set_point(&self) -> SetPoint {
        self.ramp.now()
    }

    /// Adds a pass after the last one and begins it; `lag_s` is the lag of the parts.
    pub fn repeat(&mut self, pass: Pass, lag_s: f64) {
        assert!(
            self.phase == Phase::Cool,
            "a repeat before the last pass is over"
        );
        self.passes.push(Planned { pass, lag_s });
        self.enter(Phase::Approach);
    }

    /// Changes lag and begin of the windows ([`Pass::entered`]) of the passes to come, and of the present one during its
    /// approach. The caller does this when earlier passes have shown where the parts switch.
    pub fn narrow(&mut self, operate: Window, reset: Window, lag_s: f64) {
        let approaches = self.phase == Phase::Approach;
        let first = self.number + usize::from(!approaches);
        for planned in self.passes.iter_mut().skip(first) {
            planned.lag_s = lag_s;
            planned.pass = planned.pass.entered(operate, reset);
        }
        if approaches {
            self.enter(Phase::Approach);
        }
    }

    /// Returns the set point of this second.
    pub fn step(&mut self, measured_c: f64, waiting: Waiting) -> SetPoint {
        if let Some(next) = self.next(waiting) {
            self.enter(next);
        }
        self.ramp.step(measured_c)
    }

    fn next(&self, waiting: Waiting) -> Option<Phase> {
        let planned = self.passes.get(self.number)?;
        let value_c = self.ramp.now().value_c;
        let [start_c, turn_c] = planned.rise();
        let [top_c, end_c] = planned.fall();
        let blend_k = (TRAVEL_K_PER_MIN + planned.pass.rate_k_per_min) / 2.0 * BLEND_S / 60.0;
        let go = |when: bool, next: Phase| when.then_some(next);
        match self.phase {
            Phase::Approach => go(value_c >= start_c - blend_k, Phase::Rise),
            Phase::Rise => go(waiting.operate == 0 || value_c >= turn_c, Phase::Descent),
            Phase::Descent => go(value_c <= top_c + blend_k, Phase::Fall),
            Phase::Fall => {
                let over = waiting.reset == 0 || value_c <= end_c;
                let last = self.number + 1 == self.passes.len();
                go(over, if last { Phase::Cool } else { Phase::Approach })
            }
            Phase::Cool => None,
        }
    }

    fn enter(&mut self, phase: Phase) {
        if self.phase == Phase::Fall {
            self.number += 1;
        }
        self.phase = phase;
        let Some(planned) = self.passes.get(self.number) else {
            self.phase = Phase::Cool;
            return self.ramp.head_for(self.unload_c, TRAVEL_K_PER_MIN);
        };
        // Heading far beyond the next corner keeps the rate up to it.
        let (end_c, rate) = match phase {
            Phase::Approach => (planned.rise()[1], TRAVEL_K_PER_MIN),
            Phase::Rise => (planned.rise()[1], planned.pass.rate_k_per_min),
            Phase::Descent => (planned.fall()[1], TRAVEL_K_PER_MIN),
            Phase::Fall => (planned.fall()[1], planned.pass.rate_k_per_min),
            Phase::Cool => (self.unload_c, TRAVEL_K_PER_MIN),
        };
        self.ramp.head_for(end_c, rate);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PASS: Pass = Pass {
        rate_k_per_min: 2.0,
        operate: Window {
            low_c: 80.0,
            high_c: 90.0,
        },
        reset: Window {
            low_c: 58.0,
            high_c: 72.0,
        },
    };

    /// Follows the set point exactly; every socket switches at one temperature.
    fn phases(passes: usize, switches_c: [f64; 2]) -> Vec<(Phase, f64)> {
        let mut program = Program::new(25.0, vec![PASS; passes], 39.0, 45.0);
        let mut corners = vec![(program.phase(), 25.0)];
        let (mut at_c, mut operated) = (25.0, false);
        for _ in 0..20_000 {
            operated = if operated {
                at_c > switches_c[1]
            } else {
                at_c >= switches_c[0]
            };
            let waiting = Waiting {
                operate: usize::from(!operated),
                reset: usize::from(operated),
            };
            at_c = program.step(at_c, waiting).value_c;
            if corners.last().map(|(phase, _)| *phase) != Some(program.phase()) {
                corners.push((program.phase(), at_c));
            }
        }
        corners
    }

    #[test]
    fn a_pass_turns_when_the_last_socket_has_switched() {
        let found = phases(1, [85.0, 65.0]);
        let names: Vec<Phase> = found.iter().map(|(phase, _)| *phase).collect();
        use Phase::{Approach, Cool, Descent, Fall, Rise};
        assert_eq!(names, [Approach, Rise, Descent, Fall, Cool]);
        assert!(
            (found[2].1 - 85.0).abs() < 0.2 && (found[4].1 - 65.0).abs() < 0.2,
            "{found:?}"
        );
    }

    #[test]
    fn a_socket_that_never_operates_ends_at_the_window() {
        let found = phases(1, [200.0, 65.0]);
        assert!((found[2].1 - (90.0 + 3.0 + 1.3)).abs() < 0.2, "{found:?}");
    }

    #[test]
    fn a_pass_keeps_its_planned_time() {
        let mut program = Program::new(54.0, vec![PASS], 39.0, 45.0);
        let mut took_s = 0.0;
        while program.phase() != Phase::Cool {
            let set = program.set_point();
            let waiting = Waiting {
                operate: 1,
                reset: 1,
            };
            program.step(set.value_c, waiting);
            took_s += 1.0;
        }
        let planned_s = PASS.longest_s(39.0);
        assert!(
            (0.8..=1.0).contains(&(took_s / planned_s)),
            "{took_s} of {planned_s}"
        );
    }

    #[test]
    fn two_passes_visit_both_windows_twice() {
        assert_eq!(phases(2, [85.0, 65.0]).len(), 9);
    }

    /// Steps to a second that `until` names, every socket waiting; the chamber follows exactly.
    fn run_until(program: &mut Program, until: impl Fn(&Program) -> bool) -> f64 {
        let mut at_c = program.ramp.now().value_c;
        for _ in 0..20_000 {
            if until(program) {
                return at_c;
            }
            let waiting = Waiting {
                operate: 1,
                reset: 1,
            };
            at_c = program.step(at_c, waiting).value_c;
        }
        panic!("stays in {:?} at {at_c}", program.phase)
    }

    const NARROW: [Window; 2] = [
        Window {
            low_c: 84.0,
            high_c: 86.0,
        },
        Window {
            low_c: 64.0,
            high_c: 66.0,
        },
    ];

    #[test]
    fn a_narrowed_pass_goes_on_to_its_far_ends() {
        let mut program = Program::new(25.0, vec![PASS; 2], 39.0, 45.0);
        run_until(&mut program, |it| it.pass() == 1);
        program.narrow(NARROW[0], NARROW[1], 39.0);
        let start_c = run_until(&mut program, |it| it.phase() == Phase::Rise);
        let turn_c = run_until(&mut program, |it| it.phase() == Phase::Descent);
        run_until(&mut program, |it| it.phase() == Phase::Fall);
        let end_c = run_until(&mut program, |it| it.phase() == Phase::Cool);
        let reach_k = 3.0 + 1.3;
        let found = [start_c + 6.0, turn_c, end_c];
        let expected = [84.0 - reach_k, 90.0 + reach_k, 58.0 - reach_k];
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < 0.3, "{found}, {expected}");
        }
    }

    #[test]
    fn a_second_tray_beyond_the_first_switches() {
        let narrow = PASS.entered(NARROW[0], NARROW[1]);
        let mut program = Program::new(25.0, vec![narrow], 39.0, 45.0);
        run_until(&mut program, |it| it.phase() == Phase::Rise);
        let turn_c = run_until(&mut program, |it| it.phase() == Phase::Descent);
        assert!((turn_c - (90.0 + 3.0 + 1.3)).abs() < 0.3, "{turn_c}");
    }

    #[test]
    fn a_repeat_visits_its_own_windows_after_the_last_pass() {
        let mut program = Program::new(25.0, vec![PASS], 39.0, 45.0);
        run_until(&mut program, |it| it.phase() == Phase::Cool);
        let slow = Pass {
            rate_k_per_min: 1.0,
            operate: NARROW[0],
            reset: NARROW[1],
        };
        program.repeat(slow, 39.0);
        assert_eq!((program.phase(), program.pass()), (Phase::Approach, 1));
        let turn_c = run_until(&mut program, |it| it.phase() == Phase::Descent);
        assert!((turn_c - (86.0 + 3.0 + 0.65)).abs() < 0.3, "{turn_c}");
        run_until(&mut program, |it| it.phase() == Phase::Cool);
    }

    #[test]
    fn a_longer_lag_never_holds_up_a_pass() {
        for phase in [Phase::Approach, Phase::Rise, Phase::Descent, Phase::Fall] {
            let mut program = Program::new(25.0, vec![PASS; 2], 39.0, 45.0);
            run_until(&mut program, |it| it.phase() == phase);
            program.narrow(PASS.operate, PASS.reset, 300.0);
            run_until(&mut program, |it| it.phase() == Phase::Cool);
        }
    }
}
