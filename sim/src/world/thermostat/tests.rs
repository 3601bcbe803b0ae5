//! Tests of parts on prescribed temperatures, of lots, and of the switches of the safety chain.
#![allow(clippy::unwrap_used)]

use super::contact::Contact;
use super::defect::Limits;
use super::part::{Chatter, Intermittent, Stuck, Thermostat, Values};
use super::person::{Person, Sight, Task};
use super::table::{LoadingTable, SafetyTable};
use super::*;
use crate::config::Files;

/// Returns a part without scatter that operates at 85 C and resets at 65 C.
fn values() -> Values {
    Values {
        operate_c: 85.0,
        reset_c: 65.0,
        scatter_k: 0.0,
        drift_k: 0.0,
        lag_s: [35.0, 4.0],
        breaks: true,
        contact_mohm: 15.0,
        closure_ln_sd: 0.1,
        bounce_ms: [0.2, 3.0],
        creep_k: 0.0,
        chatter: None,
        intermittent: None,
        stuck: None,
    }
}

fn part(values: Values) -> Thermostat {
    Thermostat::new(values, None, 25.0, Draw::new(5, Subject::LotOperations, 0))
}

/// Moves the socket linearly to `celsius` at a rate, K/s, in steps of `step_s`; returns the changes of the contact,
/// each with the temperature of the disc.
fn ramp(
    part: &mut Thermostat,
    t_us: &mut u64,
    [from_c, to_c]: [f64; 2],
    rate: f64,
    step_s: f64,
) -> Vec<(f64, bool, f64)> {
    let seconds = (to_c - from_c).abs() / rate;
    let steps = (seconds / step_s).round();
    let mut changes = Vec::new();
    for n in 1..=steps as u32 {
        let celsius = from_c + (to_c - from_c) * f64::from(n) / steps;
        part.step(*t_us, step_s, celsius);
        *t_us += (step_s * 1e6).round() as u64;
        while let Some((at_us, closed)) = part.contact_mut().next(*t_us) {
            changes.push((at_us as f64 * 1e-6, closed, part.disc_c()));
        }
    }
    changes
}

/// Heats from 25 to 110 C at 5 K/min, then cools to 45 C; returns the changes of both directions.
fn cycle(part: &mut Thermostat) -> [Vec<(f64, bool, f64)>; 2] {
    let mut t_us = 0;
    let up = ramp(part, &mut t_us, [25.0, 110.0], 5.0 / 60.0, 0.1);
    [up, ramp(part, &mut t_us, [110.0, 25.0], 5.0 / 60.0, 0.1)]
}

#[test]
fn a_part_operates_late_by_the_sum_of_its_lags() {
    for (rate_k_min, step_s) in [(5.0, 0.1), (5.0, 0.04), (1.0, 0.1)] {
        let rate = rate_k_min / 60.0;
        let changes = ramp(&mut part(values()), &mut 0, [25.0, 110.0], rate, step_s);
        let expected_s = 60.0 / rate + 39.0;
        let [(at_s, closed, _)] = changes[..] else {
            panic!("{changes:?}");
        };
        assert!(!closed);
        assert!((at_s - expected_s).abs() < 1e-3, "{at_s} {expected_s}");
    }
}

#[test]
fn a_part_resets_with_a_bounce_of_milliseconds() {
    let [up, down] = cycle(&mut part(values()));
    assert_eq!(up.len(), 1);
    let states: Vec<bool> = down.iter().map(|it| it.1).collect();
    assert_eq!(states, [true, false, true]);
    assert!((down[0].2 - 65.0).abs() < 0.01, "{down:?}");
    let bounce_s = down[2].0 - down[0].0;
    assert!((0.2e-3..3e-3).contains(&bounce_s), "{bounce_s}");
}

#[test]
fn scatter_moves_each_event_by_itself() {
    let mut drawn = part(Values {
        scatter_k: 0.15,
        ..values()
    });
    let mut t_us = 0;
    let mut operated_c = Vec::new();
    for _ in 0..300 {
        for goal_c in [100.0, 50.0] {
            let changes = ramp(&mut drawn, &mut t_us, [goal_c, goal_c + 1e-6], 5e-9, 0.1);
            operated_c.extend(
                changes
                    .iter()
                    .filter(|it| !it.1 && goal_c > 85.0)
                    .map(|it| it.2),
            );
        }
    }
    let n = operated_c.len() as f64;
    assert_eq!(n, 300.0);
    let mean_c = operated_c.iter().sum::<f64>() / n;
    let squares = operated_c
        .iter()
        .map(|it| (it - mean_c).powi(2))
        .sum::<f64>();
    let sd_k = (squares / n).sqrt();
    assert!((sd_k / 0.15 - 1.0).abs() < 0.12, "{sd_k}");
}

#[test]
fn chatter_flips_inside_its_band_only() {
    let mut chattering = part(Values {
        chatter: Some(Chatter {
            band_k: 0.5,
            per_s: 20.0,
        }),
        ..values()
    });
    let [up, down] = cycle(&mut chattering);
    assert!(up.len() > 20, "{}", up.len());
    for (_, _, disc_c) in &up {
        assert!((disc_c - 85.0).abs() < 0.52, "{disc_c}");
    }
    assert!(!up.last().unwrap().1 && down.last().unwrap().1);
    assert!(chattering.truth().chatter_edges > 20);
}

#[test]
fn an_intermittent_contact_is_open_for_its_share() {
    let mut bad = part(Values {
        intermittent: Some(Intermittent {
            share: 0.03,
            open_ms: [5.0, 50.0],
        }),
        ..values()
    });
    let (mut open_s, mut since_s) = (0.0, 0.0);
    for (at_s, closed, _) in ramp(&mut bad, &mut 0, [25.0, 75.0], 0.05, 0.1) {
        if closed {
            let once_s = at_s - since_s;
            assert!((0.0049..0.0501).contains(&once_s), "{once_s}");
            open_s += once_s;
        }
        since_s = at_s;
    }
    let share = open_s / 1000.0;
    assert!((0.02..0.04).contains(&share), "{share}");
}

#[test]
fn a_creeping_contact_rises_before_it_opens() {
    let mut creeping = part(Values {
        creep_k: 2.0,
        reset_c: 84.7,
        ..values()
    });
    let mut t_us = 0;
    ramp(&mut creeping, &mut t_us, [25.0, 70.0], 0.02, 0.1);
    let cold = creeping.ohm().unwrap();
    ramp(&mut creeping, &mut t_us, [70.0, 85.4], 0.02, 0.1);
    let before = creeping.ohm().unwrap();
    assert!(before > 20.0 * cold, "{cold} {before}");
    let changes = ramp(&mut creeping, &mut t_us, [85.4, 90.0], 0.02, 0.1);
    assert_eq!(changes.len(), 1);
    assert_eq!(creeping.ohm(), None);
}

#[test]
fn a_stuck_part_stays_as_it_is() {
    for (stuck, up, closed) in [
        (Stuck::Closed, 0, true),
        (Stuck::Open, 0, false),
        (Stuck::Operated, 1, false),
    ] {
        let mut stuck_part = part(Values {
            stuck: Some(stuck),
            ..values()
        });
        let changes = cycle(&mut stuck_part);
        assert_eq!((changes[0].len(), changes[1].len()), (up, 0), "{stuck:?}");
        assert_eq!(stuck_part.contact().is_closed(), closed, "{stuck:?}");
        assert_eq!(stuck_part.truth().reset_temperature_c, None);
    }
}

#[test]
fn a_contact_keeps_the_order_of_its_changes() {
    let mut contact = Contact::new(true);
    contact.change(50, false);
    contact.change(40, true);
    contact.change(45, true);
    assert_eq!(contact.next(49), None);
    assert_eq!(contact.next(50), Some((50, false)));
    assert_eq!(contact.next(50), Some((50, true)));
    assert_eq!(contact.next(1000), None);
}

fn folder() -> Files {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../config/rigs/thermostat");
    let text = |name: &str| std::fs::read_to_string(format!("{path}/{name}")).unwrap();
    let recipe = "[limits]\n\
        operate_temperature_c = { low = 95.0, high = 105.0 }\n\
        reset_temperature_c = { low = 60.0, high = 90.0 }\n";
    let texts = [
        ("rig.toml", text("rig.toml")),
        ("sim.toml", text("sim.toml")),
        ("recipes/thermostat-ksd301.toml", recipe.to_owned()),
    ];
    Files::Texts(texts.map(|(name, text)| (name.to_owned(), text)).into())
}

#[test]
fn a_lot_follows_its_recipe_and_holds_every_defect() {
    let table = read_world(&folder(), None).unwrap().thermostat.unwrap();
    let lot = Lot::read(&folder(), "thermostat-ksd301", &table, 3).unwrap();
    let truths: Vec<ThermostatTruth> = (0..400).map(|n| lot.part(n, 23.0).truth()).collect();
    for defect in Defect::ALL {
        let found = truths.iter().filter(|it| it.defect == Some(defect.name()));
        assert!(found.count() >= 2, "{}", defect.name());
    }
    let good: Vec<&ThermostatTruth> = truths.iter().filter(|it| it.defect.is_none()).collect();
    let n = good.len() as f64;
    let mean = |of: fn(&ThermostatTruth) -> f64| good.iter().map(|it| of(it)).sum::<f64>() / n;
    assert!((mean(|it| it.operate_temperature_c.unwrap()) - 100.0).abs() < 0.3);
    assert!((mean(|it| it.reset_temperature_c.unwrap()) - 75.0).abs() < 0.5);
    assert!((mean(|it| it.lag_s[0]) - 90.0).abs() < 3.0);
    assert!(good.iter().all(|it| it.lag_s[0] > 40.0));
}

#[test]
fn a_part_out_of_limits_is_far_outside() {
    let table = read_world(&folder(), None).unwrap().thermostat.unwrap();
    let limits = Limits {
        operate_c: [80.0, 90.0],
        reset_c: [55.0, 75.0],
        differential_k: [15.0, 25.0],
    };
    for seed in 0..200 {
        let mut draw = Draw::new(seed, Subject::LotPart, 0);
        let mut damaged = |defect: Defect| {
            let mut own = values();
            defect.damage(&mut own, &limits, &table.defects, &mut draw);
            own
        };
        let outside = |value: f64, ends: [f64; 2]| value < ends[0] - 3.9 || value > ends[1] + 3.9;
        let operate = damaged(Defect::Operate);
        assert!(outside(operate.operate_c, limits.operate_c));
        assert!((operate.differential_k() - 20.0).abs() < 1e-9);
        assert!(outside(damaged(Defect::Reset).reset_c, limits.reset_c));
        let wide = damaged(Defect::Differential);
        assert!(outside(wide.differential_k(), limits.differential_k));
        assert!(wide.differential_k() > 0.0);
        assert!(outside(
            damaged(Defect::WrongTemperature).operate_c,
            limits.operate_c
        ));
    }
}

fn safety() -> SafetyTable {
    let table = read_world(&folder(), None).unwrap().thermostat.unwrap();
    table.safety
}

#[test]
fn each_switch_of_the_chain_opens_it() {
    let ready = || {
        let mut chain = Chain::new(safety());
        chain.step(0, 1.0, 25.0);
        chain.step(3_000_000, 1.0, 25.0);
        assert!(chain.conducts());
        chain
    };
    let mut hot = ready();
    hot.step(4_000_000, 1.0, safety().limiter_c);
    hot.step(5_000_000, 1.0, 25.0);
    assert!(
        !hot.limiter_ok() && !hot.conducts(),
        "until somebody resets it"
    );
    hot.reset_limiter();
    assert!(hot.conducts());
    let mut still = ready();
    still.step(4_000_000, 0.3, 25.0);
    assert!(!still.airflow_ok() && !still.conducts());
    let mut open = ready();
    open.open_door();
    assert!(!open.door_closed() && !open.conducts());
    open.step(3_000_000 + 20_000_000, 1.0, 25.0);
    assert!(open.conducts());
    let mut stopped = ready();
    stopped.stop();
    assert!(!stopped.emergency_stop_ok() && !stopped.conducts());
    let mut dark = ready();
    dark.mains = false;
    assert!(!dark.conducts());
}

#[test]
fn the_person_acts_behind_an_unlocked_door_only() {
    let mut person = Person::new(LoadingTable {
        loading_min: 4.0,
        reaction_s: 5.0,
    });
    let idle = Sight {
        unlocked: false,
        testing: false,
        unload: false,
        rack_filled: false,
        parts_wait: true,
    };
    assert_eq!(person.step(0, &idle), None);
    assert_eq!(person.step(60_000_000, &idle), None);
    let ready = Sight {
        unlocked: true,
        ..idle
    };
    assert_eq!(person.step(61_000_000, &ready), None);
    assert!(!person.at_door(65_000_000) && person.at_door(66_000_000));
    assert_eq!(person.step(185_000_000, &ready), None);
    assert_eq!(person.step(186_000_000, &ready), Some(Task::Load));
    let unload = Sight {
        rack_filled: true,
        unload: true,
        ..ready
    };
    assert_eq!(person.step(200_000_000, &unload), None);
    assert_eq!(person.step(204_000_000, &idle), None, "locked again");
    assert!(!person.at_door(300_000_000));
}
