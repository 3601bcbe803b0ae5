//! Sums of three outputs with different gains and offsets.

use crate::dut::em_relay::Calibration;
use crate::dut::em_relay::act::Act;
use crate::dut::em_relay::calibration::OutputLine;
use crate::dut::em_relay::points::AnalogOut;
use crate::dut::em_relay::supply::Supply;
use crate::dut::em_relay::tests::context;
use crate::gauge::Factor;
use units::{Span, Volt};

/// Outputs at the limits of their accuracy, each with a different error.
fn crooked() -> Calibration {
    let line = |gain, offset_v| OutputLine {
        gain: Factor::new(gain, 0.0),
        offset_v: Factor::new(offset_v, 0.0),
    };
    Calibration {
        level: line(1.0005, 0.003),
        coarse: line(0.9995, 0.0),
        fine: line(1.0004, -0.002),
        ..(*context().calibration).clone()
    }
}

fn commanded(act: &Act) -> (AnalogOut, Volt) {
    match act {
        Act::Supply(outputs) => outputs[0],
        other => panic!("{other:?} is no supply act"),
    }
}

fn near(a: Volt, b: f64) -> bool {
    (a.0 - b).abs() < 1e-9
}

#[test]
fn a_step_sets_the_sum_at_any_ramp_voltage() {
    let mut supply = Supply::new(&crooked());
    for (coarse, fine, total) in [
        (0.0, 0.0, 5.0),
        (6.0, 0.0, 7.8),
        (6.0, 0.3, 12.0),
        (2.0, 0.1, 2.5),
        (0.0, 0.25, 11.4),
    ] {
        supply.ramp_coarse(Volt(coarse));
        supply.ramp_fine(Volt(fine));
        let act = supply.step_to(Volt(total));
        assert!(near(supply.total(), total), "{total} V: {}", supply.total());
        let (point, level) = commanded(&act);
        assert_eq!(point, AnalogOut::SupplyLevel);
        let delivered = crooked().level.delivers(level) + supply.coarse() + supply.fine();
        assert!(near(delivered, total), "{total} V: {delivered}");
    }
}

#[test]
fn a_ramp_leaves_the_other_outputs() {
    let mut supply = Supply::new(&crooked());
    supply.step_to(Volt(5.0));
    let (before, fine) = (supply.total(), supply.fine());
    let (act, takes) = supply.ramp_coarse(Volt(6.0));
    assert_eq!(commanded(&act).0, AnalogOut::SupplyCoarse);
    assert!(near(supply.coarse(), 6.0) && supply.fine() == fine);
    assert!(near(supply.total() - before, 6.0));
    assert!(takes >= Span::seconds(6.0 / 96.0));
    let (act, takes) = supply.ramp_fine(Volt(0.15));
    assert_eq!(commanded(&act).0, AnalogOut::SupplyFine);
    assert!(near(supply.fine(), 0.15));
    assert!(takes >= Span::ms(100) && takes < Span::ms(110));
}

#[test]
fn no_output_is_commanded_below_zero() {
    for calibration in [crooked(), (*context().calibration).clone()] {
        let mut supply = Supply::new(&calibration);
        let (coarse, _) = supply.ramp_coarse(Volt(-1.0));
        let (fine, _) = supply.ramp_fine(Volt(-0.5));
        let below = supply.step_to(Volt(-2.0));
        for act in [coarse, fine, below] {
            assert!(commanded(&act).1.0 >= 0.0, "{act:?}");
        }
        supply.ramp_coarse(Volt(6.0));
        assert!(commanded(&supply.step_to(Volt(2.0))).1.0 == 0.0);
        let least = calibration.level.offset_v.value + supply.coarse().0 + supply.fine().0;
        assert!(near(supply.total(), least), "the sum stays true");
    }
}

#[test]
fn a_ramp_without_distance_only_settles() {
    let mut supply = Supply::new(&crooked());
    supply.ramp_coarse(Volt(6.0));
    let (_, again) = supply.ramp_coarse(Volt(6.0));
    let (_, up_and_down) = (
        supply.ramp_coarse(Volt(3.0)),
        supply.ramp_coarse(Volt(6.0)).1,
    );
    assert!(again <= Span::ms(5));
    assert!(up_and_down > Span::ms(31));
}
