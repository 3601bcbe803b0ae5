//! Prediction and uncertainty of the overshoot model after few and many parts.

use super::*;

/// A part of a lot whose overshoot of 0.85 V follows its times, and its threshold less; every part differs.
fn part(at: u32) -> (CoarseResults, Volt) {
    let turn = |by: f64| (f64::from(at) * by).fract() - 0.5;
    let (slow, holding, high) = (0.16 * turn(0.618), 0.15 * turn(0.382_7), 0.11 * turn(0.271));
    let fine = 7.88 * (1.0 + high);
    let overshoot = 0.85 + 0.9 * slow - 0.1 * holding + 0.3 * high;
    let shown = CoarseResults {
        indicated: Volt(fine + overshoot),
        operate: Volt(fine + overshoot),
        operate_ms: 4.7 * (1.0 + slow),
        release_ms: 2.9 * (1.0 + holding),
        coil_ohm: 400.0 * (1.0 + 0.05 * turn(0.724)),
    };
    (shown, Volt(fine))
}

/// The model after `parts` parts, whose indications err by `noise_v` alternately upwards and downwards.
fn taught(parts: u32, noise_v: f64) -> OvershootModel {
    let mut law = OvershootModel::guess(0.80, 1.0);
    for at in 0..parts {
        let (shown, fine) = part(at);
        let off = if at % 2 == 0 { noise_v } else { -noise_v };
        law.learn(&shown, fine - Volt(off));
    }
    law
}

fn error_v(law: &OvershootModel, at: u32) -> f64 {
    let (shown, fine) = part(at);
    (law.of(&shown).volts - (shown.indicated - fine).0).abs()
}

#[test]
fn before_any_part_the_guess_is_the_prediction() {
    let predicted = OvershootModel::guess(0.85, 1.0).of(&part(0).0);
    assert_eq!((predicted.volts, predicted.alike), (0.85, false));
    assert!(predicted.u_v > GUESS_SD_V, "{predicted:?}");
}

#[test]
fn a_slow_relay_gets_its_own_overshoot() {
    let law = taught(17, 0.0);
    let worst = (17..60).map(|at| error_v(&law, at)).fold(0.0, f64::max);
    assert!(worst < 0.006, "{worst} V, where the lot scatters by 0.05 V");
}

#[test]
fn the_uncertainty_holds_from_the_second_part_on() {
    for parts in 1..60 {
        let law = taught(parts, 0.002);
        let u_v = law.of(&part(parts).0).u_v;
        let error_v = error_v(&law, parts);
        assert!(error_v < 3.0 * u_v, "{parts} parts: {error_v}, u {u_v}");
    }
}

#[test]
fn scatter_about_the_line_remains_in_the_uncertainty() {
    let u_v = |parts| taught(parts, 0.006).of(&part(3).0).u_v;
    assert!(u_v(6) > u_v(500), "{} {}", u_v(6), u_v(500));
    assert!((u_v(500) - 0.006).abs() < 0.0005, "{}", u_v(500));
}

#[test]
fn fitted_terms_reduce_the_degrees_of_freedom() {
    // Ten parts and six terms: the residual about the line is less than the scatter of the parts.
    let u_v = taught(10, 0.006).of(&part(7).0).u_v;
    assert!(u_v > 0.006, "{u_v}");
    for parts in [15, 20, 30] {
        let law = taught(parts, 0.006);
        let beyond_two_u = (parts..parts + 200)
            .filter(|at| {
                let (shown, fine) = part(*at);
                let off = if at % 2 == 0 { 0.006 } else { -0.006 };
                let predicted = law.of(&shown);
                (predicted.volts - (shown.indicated - fine).0 - off).abs() > 2.0 * predicted.u_v
            })
            .count();
        assert!(
            beyond_two_u <= 10,
            "{beyond_two_u} of 200 after {parts} parts"
        );
    }
}

#[test]
fn extrapolation_widens_with_the_squared_distance() {
    let law = taught(40, 0.002);
    let (lot, fine) = part(3);
    let at = |further: f64| CoarseResults {
        indicated: Volt(fine.0 * (1.0 + further)),
        operate: Volt(fine.0 * (1.0 + further)),
        ..lot
    };
    let (far, twice) = (law.of(&at(0.6)), law.of(&at(1.2)));
    assert!(!far.alike && !twice.alike);
    assert!(twice.u_v > 4.0 * far.u_v, "{far:?} {twice:?}");
}

#[test]
fn only_parts_like_the_lot_are_alike() {
    for parts in [20, 500] {
        let law = taught(parts, 0.002);
        let strangers = (500..600).filter(|at| !law.of(&part(*at).0).alike);
        assert!(strangers.count() < 5, "{parts} parts");
        let (lot, fine) = part(3);
        let weak = CoarseResults {
            indicated: Volt(fine.0 * 0.83),
            operate: Volt(fine.0 * 0.83),
            ..lot
        };
        let slow = CoarseResults {
            operate_ms: 9.0,
            ..lot
        };
        for odd in [weak, slow] {
            assert!(!law.of(&odd).alike, "{parts} parts: {odd:?}");
            assert!(law.of(&odd).u_v > law.of(&lot).u_v);
        }
    }
}

#[test]
fn a_part_with_a_missing_result_teaches_nothing() {
    let law = taught(20, 0.0);
    let (shown, fine) = part(3);
    for odd in [
        CoarseResults::NONE,
        CoarseResults {
            release_ms: f64::NAN,
            ..shown
        },
        CoarseResults {
            coil_ohm: f64::INFINITY,
            ..shown
        },
    ] {
        let mut after = law;
        after.learn(&odd, fine);
        assert_eq!(after, law);
        assert!(!law.of(&odd).alike);
    }
    let mut after = law;
    after.learn(&shown, Volt(f64::NAN));
    assert_eq!(after, law);
}

#[test]
fn one_outlier_bends_the_line_within_its_uncertainty() {
    let (law, (shown, fine)) = (taught(12, 0.002), part(12));
    let before = law.of(&shown);
    let after = |off_v: f64| {
        let mut after = law;
        after.learn(&shown, fine - Volt(off_v));
        after.of(&shown)
    };
    let (odd, odder) = (after(0.1), after(0.5));
    assert!((odd.volts - odder.volts).abs() < 1e-9);
    assert!(odd.volts - before.volts < OUTLIER * before.u_v);
    assert!(odd.u_v > before.u_v, "{odd:?} {before:?}");
}

#[test]
fn persistent_disagreement_bends_the_line() {
    let mut law = taught(12, 0.002);
    for at in 12..60 {
        let (shown, fine) = part(at);
        law.learn(&shown, fine - Volt(0.2));
    }
    let (shown, fine) = part(60);
    let now = law.of(&shown);
    let error_v = now.volts - (shown.indicated - fine).0 - 0.2;
    // The first twelve parts, whose overshoot lacked the 0.2 V, still have a fifth of the weight.
    assert!(
        error_v.abs() < 0.06 && error_v.abs() < 2.0 * now.u_v,
        "{error_v} {now:?}"
    );
}

#[test]
fn the_prior_expects_a_late_armature_to_overshoot() {
    let (one, _) = part(0);
    let late = CoarseResults {
        operate_ms: one.operate_ms * 1.1,
        ..one
    };
    let further = |guess_v: f64| {
        let mut law = OvershootModel::guess(guess_v, 1.0);
        law.learn(&one, one.indicated - Volt(guess_v));
        law.of(&late).volts - law.of(&one).volts
    };
    let expected = RISING[2] * 0.85 * 1.1f64.ln();
    assert!((further(0.85) - expected).abs() < 1e-9);
    assert!(further(-1.05).abs() < 1e-9, "flux knows no armature");
}
