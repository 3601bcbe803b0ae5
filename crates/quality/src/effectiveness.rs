//! Overall equipment effectiveness (OEE), and how much time each kind of loss takes.
//!
//! OEE = availability x performance x quality. Of the four times below, each factor divides one by the time before it:
//!
//! 1. planned: from the start of a run to its end;
//! 2. running: planned time without the time in alarm and without set-up (calibration, reference parts), which
//!    ISO 22400-2 takes out of the production time and hence out of availability;
//! 3. net: the time that the tested parts take at the ideal cycle;
//! 4. valuable: the time that the good parts take at the ideal cycle.
//!
//! So every second is either valuable or belongs to exactly one of four losses.

use serde::Serialize;

/// Times and numbers of parts in a period of production.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Observed {
    /// Time planned for production, s.
    pub planned_s: f64,
    /// Part of the planned time in which an alarm stopped the line, s.
    pub stopped_s: f64,
    /// Part of the planned time, without alarms, in which the line was set up, s.
    pub setup_s: f64,
    /// Shortest time per part that the line can achieve, s.
    pub ideal_cycle_s: f64,
    /// Number of parts tested.
    pub parts: u64,
    /// Number of parts that passed.
    pub good: u64,
}

/// The three factors, their product, and the losses of time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Effectiveness {
    /// Running / planned.
    pub availability: f64,
    /// Net / running; above 1 when the ideal cycle is set too long.
    pub performance: f64,
    /// Valuable / net.
    pub quality: f64,
    /// Product of the three factors.
    pub oee: f64,
    /// Time lost by alarms, s.
    pub stopped_s: f64,
    /// Time lost by set-up, s.
    pub setup_s: f64,
    /// Time lost by waiting and by slow cycles, s.
    pub slow_s: f64,
    /// Time lost on parts that did not pass, s.
    pub rejected_s: f64,
}

/// Computes the effectiveness; `None` when there was no running time or no part was tested.
pub fn effectiveness(observed: Observed) -> Option<Effectiveness> {
    let running = observed.planned_s - observed.stopped_s - observed.setup_s;
    let net = observed.ideal_cycle_s * observed.parts as f64;
    let valuable = observed.ideal_cycle_s * observed.good as f64;
    (running > 0.0 && net > 0.0).then(|| Effectiveness {
        availability: running / observed.planned_s,
        performance: net / running,
        quality: valuable / net,
        oee: valuable / observed.planned_s,
        stopped_s: observed.stopped_s,
        setup_s: observed.setup_s,
        slow_s: running - net,
        rejected_s: net - valuable,
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn every_second_is_valuable_or_in_one_loss() {
        let observed = Observed {
            planned_s: 28_800.0,
            stopped_s: 1_880.0,
            setup_s: 1_000.0,
            ideal_cycle_s: 1.2,
            parts: 18_000,
            good: 17_100,
        };
        let it = effectiveness(observed).unwrap();
        assert!((it.availability - 0.9).abs() < 1e-12);
        assert!((it.performance - 21_600.0 / 25_920.0).abs() < 1e-12);
        assert!((it.quality - 0.95).abs() < 1e-12);
        assert!((it.oee - it.availability * it.performance * it.quality).abs() < 1e-12);
        let valuable = 1.2 * 17_100.0;
        let all = valuable + it.stopped_s + it.setup_s + it.slow_s + it.rejected_s;
        assert!((all - 28_800.0).abs() < 1e-9);
    }

    /// Worked example of Vorne's text on OEE, one shift: 480 min less 60 min of breaks, 47 min down, ideal cycle 1.0 s,
    /// 19,271 pieces, 423 rejected.
    #[test]
    fn a_published_shift_has_its_published_factors() {
        let shift = Observed {
            planned_s: 420.0 * 60.0,
            stopped_s: 47.0 * 60.0,
            setup_s: 0.0,
            ideal_cycle_s: 1.0,
            parts: 19_271,
            good: 19_271 - 423,
        };
        let it = effectiveness(shift).unwrap();
        for (factor, percent) in [
            (it.availability, 88.81),
            (it.performance, 86.11),
            (it.quality, 97.80),
            (it.oee, 74.79),
        ] {
            assert!(
                (100.0 * factor - percent).abs() < 0.0051,
                "{factor}: {percent}"
            );
        }
    }

    #[test]
    fn no_tested_part_gives_no_effectiveness() {
        assert_eq!(effectiveness(Observed::default()), None);
    }
}
