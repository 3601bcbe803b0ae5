//! Tests of cases that defeat a careless integration.

use super::*;

/// Least voltage that operates the default relay when it is applied as a step from 0 V, V.
const DYNAMIC_V: f64 = 7.855922331955684;

#[test]
fn near_pickup_each_decade_adds_the_same_time() {
    let model = relay(&[]);
    let operate_s = |above: f64| {
        let run = model.transient(
            model.at_rest(0.0),
            &step(DYNAMIC_V * (1.0 + above)),
            0.08,
            1e-13,
        );
        let seen = Outcome::of(&run.unwrap().events);
        seen.no_first_make.unwrap_or(f64::NAN)
    };
    let [coarse, fine, finest] = [1e-3, 1e-6, 1e-9].map(operate_s);
    near(Some(coarse), 29.54008383e-3, 1e-9);
    near(Some(fine), 43.79521229e-3, 1e-9);
    near(Some(finest), 60.806111e-3, 1e-6);
    near(Some((finest - fine) / 3.0), 5.6703e-3, 2e-6);
}

#[test]
fn a_step_from_zero_operates_below_static_pickup() {
    let model = relay(&[]);
    let below_v = model.pickup().volts - DYNAMIC_V;
    near(Some(below_v), 0.0276, 5e-5);
    let operates = |volts: f64| outcome(&model, &step(volts), 0.06).no_first_make.is_some();
    assert!(operates(DYNAMIC_V + 1e-6) && !operates(DYNAMIC_V - 1e-6));
}

#[test]
fn a_step_from_just_below_operates_near_static_pickup() {
    let model = relay(&[]);
    let pickup = model.pickup().volts;
    let floating = from_rest(&model, &step(0.97 * pickup), 0.4).state;
    let operates = |below_v: f64, rtol: f64| {
        let run = model
            .transient(floating, &step(pickup - below_v), 0.08, rtol)
            .unwrap();
        Outcome::of(&run.events).no_first_make.is_some()
    };
    assert!(operates(0.0015, FINE) && !operates(0.0030, FINE));
    for below_v in [0.0016, 0.0018, 0.0021, 0.0024] {
        assert_eq!(
            operates(below_v, 1e-8),
            operates(below_v, FINE),
            "in between it depends on the swing"
        );
    }
}

#[test]
fn a_short_pulse_opens_and_recloses_only_nc() {
    let model = relay(&[]);
    let seen = outcome(&model, &step(0.99 * model.pickup().volts), 0.04);
    near(seen.nc_first_open, 9.249e-3, 5e-7);
    near(seen.nc_first_make, 10.833e-3, 5e-7);
    assert_eq!(seen.no_first_make, None);
}

#[test]
fn a_hung_armature_makes_no_long_before_it_seats() {
    let model = relay(&[("k_l", 12_000.0), ("d0", -0.01e-3), ("G", 0.30e-3)]);
    let rise = ramp(&[[0.0, 8.0], [0.5, 8.0], [0.8, 11.0]]);
    let seen = outcome(&model, &rise, 0.8);
    let volts = |t: Option<f64>| t.map(|t| 8.0 + (t - 0.5) * 10.0);
    near(volts(seen.no_first_make), 8.555, 2e-3);
    near(volts(seen.seat_first), 10.094, 2e-3);
}

#[test]
fn stiffer_contacts_bounce_more_and_operate_alike() {
    let makes = [1, 1, 4, 8, 16, 34, 72];
    let mut steps = Vec::new();
    for (exponent, makes) in (6..).zip(makes) {
        let model = relay(&[("k_c", 10f64.powi(exponent))]);
        let run = model
            .transient(model.at_rest(0.0), &step(12.0), 0.008, 1e-8)
            .unwrap();
        let seen = Outcome::of(&run.events);
        assert_eq!(seen.no_makes, makes, "k_c 1e{exponent}");
        let expected = match exponent {
            6 => 4.8713e-3,
            9.. => 4.7259e-3,
            _ => 4.73e-3,
        };
        near(
            seen.no_first_make,
            expected,
            if exponent < 9 { 4e-5 } else { 1e-6 },
        );
        steps.push(run.steps);
    }
    assert!(steps[6] < 12 * steps[0], "{steps:?}");
}

#[test]
fn hard_contacts_and_stops_keep_all_their_events() {
    let model = relay(&[("k_c", 1e10), ("k_s", 1e12)]);
    let run = from_rest(&model, &step(12.0), 0.008);
    let seen = Outcome::of(&run.events);
    near(seen.no_first_make, 4.725888385292e-3, 1e-10);
    assert_eq!(seen.no_makes, 16);
}

#[test]
fn a_loose_tolerance_still_detects_a_graze() {
    let model = relay(&[]);
    let makes = |width_s: f64, rtol: f64| {
        let pulse = ramp(&[[0.0, 12.0], [width_s, 12.0], [width_s, 0.0]]);
        let run = model
            .transient(model.at_rest(0.0), &pulse, 0.012, rtol)
            .unwrap();
        Outcome::of(&run.events).no_makes
    };
    let (mut short, mut long) = (1e-3, 6e-3);
    while long - short > 1e-9 {
        let middle = 0.5 * (short + long);
        if makes(middle, FINE) == 0 {
            short = middle;
        } else {
            long = middle;
        }
    }
    for past_s in [1e-8, 1e-7, 1e-6] {
        assert_eq!(
            makes(long + past_s, 1e-6),
            makes(long + past_s, FINE),
            "{past_s} s past the graze"
        );
        assert_eq!(makes(short - past_s, 1e-6), 0, "{past_s} s short of it");
    }
}

#[test]
fn a_warm_coil_operates_later() {
    let model = relay(&[("T", 60.0)]);
    near(
        outcome(&model, &step(12.0), 0.012).no_first_make,
        5.300259450614e-3,
        1e-10,
    );
}

#[test]
fn chatter_between_near_rigid_bodies_comes_to_rest() {
    let model = relay(&[("k_s", 1e13), ("chi_s", 1.0), ("k_c", 1e12), ("chi_c", 1.0)]);
    let run = model
        .transient(
            model.sealed(12.0),
            &Excitation::Suppression(60.0),
            0.04,
            1e-8,
        )
        .unwrap();
    assert!(run.events.len() > 100, "{} events", run.events.len());
    let late = run.events.iter().filter(|e| e.t_s > 0.035).count();
    assert!(
        late < run.events.len() / 4,
        "{late} of {} after 35 ms",
        run.events.len()
    );
}
