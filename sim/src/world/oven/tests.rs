//! Tests of the chamber against a fine integration, and against the figures of its design.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::world::draw::{Draw, Subject};

/// Returns the derivatives of the five bodies as the equations of the chamber state them.
fn rates(v: &ChamberValues, t: [f64; 5], heater_w: f64, drive: &Drive) -> [f64; 5] {
    let f = drive.fan.powf(0.8).max(0.08);
    let [h, a, w, r, i] = t;
    let out = v.leak_w_per_k
        + v.vent_w_per_k * drive.vent
        + if drive.door_open { v.door_w_per_k } else { 0.0 };
    let ha = v.heater_air_w_per_k * f * (h - a);
    let aw = v.air_wall_w_per_k * f * (a - w);
    let ar = v.air_rack_w_per_k * f * (a - r);
    let wi = v.wall_insulation_w_per_k * (w - i);
    let io = v.insulation_ambient_w_per_k * (i - v.ambient_c);
    let fan_w = v.fan_w * drive.fan.powi(3);
    let heat = [
        heater_w - ha,
        ha - aw - ar - out * (a - v.ambient_c) + fan_w,
        aw - wi,
        ar,
        wi - io,
    ];
    std::array::from_fn(|n| heat[n] / v.capacity_j_per_k[n])
}

/// Integrates one second with steps of a millisecond (Runge-Kutta), the heater on for its first part.
fn fine_second(v: &ChamberValues, mut t: [f64; 5], on_ms: u32, drive: &Drive) -> [f64; 5] {
    let plus = |t: [f64; 5], k: [f64; 5], h: f64| std::array::from_fn(|n| t[n] + h * k[n]);
    let h = 1e-3;
    for ms in 0..1000 {
        let watts = if ms < on_ms {
            v.heater_w * drive.power
        } else {
            0.0
        };
        let k1 = rates(v, t, watts, drive);
        let k2 = rates(v, plus(t, k1, h / 2.0), watts, drive);
        let k3 = rates(v, plus(t, k2, h / 2.0), watts, drive);
        let k4 = rates(v, plus(t, k3, h), watts, drive);
        t = std::array::from_fn(|n| t[n] + h / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]));
    }
    t
}

fn array(t: &Temperatures) -> [f64; 5] {
    [t.heater_c, t.air_c, t.wall_c, t.rack_c, t.insulation_c]
}

#[test]
fn each_design_agrees_with_a_fine_integration() {
    for values in [ChamberValues::AIR, ChamberValues::OIL, ChamberValues::BLOCK] {
        let mut chamber = Chamber::new(&values, 25.0);
        let mut fine = [25.0; 5];
        let mut worst: f64 = 0.0;
        for second in 0..300u32 {
            let n = f64::from(second);
            let drive = Drive {
                duty: f64::from(second * 37 % 101) / 100.0,
                power: if second > 200 { 0.5 } else { 1.0 },
                vent: (n / 30.0).sin().max(0.0),
                fan: if second % 90 > 60 {
                    0.0
                } else {
                    1.0 - n / 400.0
                },
                door_open: (100..120).contains(&second),
            };
            chamber.step(1.0, &drive);
            fine = fine_second(&values, fine, second * 37 % 101 * 10, &drive);
            for (own, other) in array(&chamber.temperatures()).iter().zip(fine) {
                worst = worst.max((own - other).abs());
            }
        }
        assert!(worst < 1e-8, "{worst} K");
    }
}

#[test]
fn the_length_of_a_step_does_not_change_the_chamber() {
    let drive = Drive {
        duty: 0.437,
        ..Drive::RUNNING
    };
    let [mut one, mut many] = [0; 2].map(|_| Chamber::new(&ChamberValues::AIR, 23.0));
    one.step(100.0, &drive);
    for n in 0..400 {
        many.step(if n % 2 == 0 { 0.017 } else { 0.483 }, &drive);
    }
    for (a, b) in array(&one.temperatures())
        .iter()
        .zip(array(&many.temperatures()))
    {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
}

#[test]
fn a_follower_of_long_steps_stays_within_3_millikelvin() {
    let full = Drive {
        duty: 1.0,
        ..Drive::RUNNING
    };
    let start = || {
        let chamber = Chamber::new(&ChamberValues::AIR, 23.0);
        (chamber, Sensor::new(SensorValues::AIR, 23.0))
    };
    let ((mut coarse, mut usual), (mut fine, mut exact)) = (start(), start());
    let mut worst: f64 = 0.0;
    for second in 0..60 {
        let drive = if second % 20 < 10 {
            full
        } else {
            Drive::RUNNING
        };
        coarse.step_with(1.0, &drive, |dt_s, now| usual.step(dt_s, now.air_c));
        for _ in 0..1000 {
            fine.step_with(0.001, &drive, |dt_s, now| exact.step(dt_s, now.air_c));
        }
        worst = worst.max((usual.celsius() - exact.celsius()).abs());
    }
    assert!(worst > 0.0 && worst < 3e-3, "{worst} K");
}

/// Returns the seconds until `done` holds, in steps of 0.1 s.
fn seconds(chamber: &mut Chamber, drive: &Drive, done: impl Fn(&Temperatures) -> bool) -> f64 {
    let mut steps = 0.0;
    while !done(&chamber.step(0.1, drive)) {
        steps += 1.0;
        assert!(steps < 100_000.0, "never done");
    }
    steps * 0.1
}

#[test]
fn full_power_heats_from_25_to_80_in_90_seconds() {
    let mut chamber = Chamber::new(&ChamberValues::AIR, 25.0);
    let full = Drive {
        duty: 1.0,
        ..Drive::RUNNING
    };
    let s = seconds(&mut chamber, &full, |now| now.air_c >= 80.0);
    let now = chamber.temperatures();
    assert!((s / 90.0 - 1.0).abs() < 0.05, "{s} s");
    assert!((now.air_c - now.wall_c - 37.0).abs() < 4.0, "{now:?}");
}

#[test]
fn the_open_vent_cools_94_to_45_in_nine_minutes() {
    let mut chamber = Chamber::new(&ChamberValues::AIR, 94.0);
    let open = Drive {
        vent: 1.0,
        ..Drive::RUNNING
    };
    let s = seconds(&mut chamber, &open, |now| now.air_c <= 45.0);
    assert!((s / 522.0 - 1.0).abs() < 0.1, "{s} s");
}

#[test]
fn the_fan_alone_holds_25_kelvin_above_ambient() {
    let mut chamber = Chamber::new(&ChamberValues::AIR, 23.0);
    let now = chamber.step(100_000.0, &Drive::RUNNING);
    assert!((now.air_c - 23.0 - 25.0).abs() < 0.5, "{now:?}");
}

/// Response of the reading to a step of the duty: `k (1 - exp(-(t - theta)/tau)) + ki (t - theta)`.
#[derive(Debug, Clone, Copy)]
struct Identified {
    k: f64,
    tau_s: f64,
    theta_s: f64,
    ki: f64,
    squares: f64,
}

/// Returns the best fit to 300 s of full power, by least squares over a grid of tau and theta.
fn identified(values: &ChamberValues, sensor: SensorValues, tau_s: [u32; 2]) -> Identified {
    let readings = step_response(values, sensor);
    let mut best: Option<Identified> = None;
    for theta in 40..90 {
        for tau in tau_s[0]..tau_s[1] {
            let found = linear_fit(&readings, f64::from(tau), f64::from(theta) / 10.0);
            if best.is_none_or(|it| found.squares < it.squares) {
                best = Some(found);
            }
        }
    }
    best.unwrap()
}

/// Returns the reading of every second at full power minus the reading without power.
fn step_response(values: &ChamberValues, sensor: SensorValues) -> Vec<(f64, f64)> {
    let runs = [1.0, 0.0].map(|duty| {
        let drive = Drive {
            duty,
            ..Drive::RUNNING
        };
        let mut chamber = Chamber::new(values, values.ambient_c);
        let mut sensor = Sensor::new(sensor, values.ambient_c);
        let mut read = || {
            chamber.step_with(1.0, &drive, |dt_s, now| sensor.step(dt_s, now.air_c));
            sensor.celsius()
        };
        (0..300).map(|_| read()).collect::<Vec<f64>>()
    });
    let [heated, idle] = runs;
    let times = (1..).map(f64::from);
    times
        .zip(heated.iter().zip(idle).map(|(a, b)| a - b))
        .collect()
}

/// Fits k and ki for a given tau and theta.
fn linear_fit(readings: &[(f64, f64)], tau_s: f64, theta_s: f64) -> Identified {
    let terms = |t_s: f64| {
        let late_s = (t_s - theta_s).max(0.0);
        (1.0 - (-late_s / tau_s).exp(), late_s)
    };
    let (mut pp, mut pq, mut qq, mut py, mut qy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (t_s, y) in readings {
        let (p, q) = terms(*t_s);
        pp += p * p;
        pq += p * q;
        qq += q * q;
        py += p * y;
        qy += q * y;
    }
    let det = pp * qq - pq * pq;
    let (k, ki) = ((py * qq - qy * pq) / det, (qy * pp - py * pq) / det);
    let miss = |(t_s, y): &(f64, f64)| {
        let (p, q) = terms(*t_s);
        (y - k * p - ki * q).powi(2)
    };
    Identified {
        k,
        tau_s,
        theta_s,
        ki,
        squares: readings.iter().map(miss).sum(),
    }
}

#[test]
fn each_design_has_its_identified_response() {
    let designs = [
        (
            ChamberValues::AIR,
            SensorValues::AIR,
            [10, 40],
            [30.6, 21.9, 6.7, 0.264],
        ),
        (
            ChamberValues::OIL,
            SensorValues::OIL,
            [80, 140],
            [2.0, 109.0, 7.1, 0.148],
        ),
        (
            ChamberValues::BLOCK,
            SensorValues::BLOCK,
            [140, 200],
            [3.8, 169.0, 5.1, 0.203],
        ),
    ];
    for (values, sensor, tau_s, expected) in designs {
        let found = identified(&values, sensor, tau_s);
        let figures = [found.k, found.tau_s, found.theta_s, found.ki];
        for (figure, expected) in figures.iter().zip(expected) {
            assert!(
                (figure / expected - 1.0).abs() < 0.07,
                "{found:?}, not {expected}"
            );
        }
    }
}

#[test]
fn a_drawn_chamber_repeats_and_keeps_the_spread() {
    let drawn = |seed| {
        let mut draw = Draw::new(seed, Subject::Rig, 0);
        ChamberValues::AIR.drawn(&Spread::USUAL, &mut draw)
    };
    assert_eq!(drawn(4), drawn(4));
    let n = 2000;
    let squares = |of: fn(&ChamberValues) -> f64| {
        let nominal = of(&ChamberValues::AIR);
        let each = (0..n).map(|seed| (of(&drawn(seed)) / nominal - 1.0).powi(2));
        (each.sum::<f64>() / n as f64).sqrt()
    };
    for (of, sd) in [
        (squares(|it| it.capacity_j_per_k[3]), 0.15),
        (squares(|it| it.door_w_per_k), 0.20),
        (squares(|it| it.heater_w), 0.10),
    ] {
        assert!((of / sd - 1.0).abs() < 0.06, "{of} {sd}");
    }
}
