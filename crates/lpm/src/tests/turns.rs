//! Tests: turning moves, compared with dense sampling by an independent rotation.
use super::*;
use crate::distance::tests::Dice;

/// How early a turning move may be blocked, mm.
const FALSE_BLOCK_MM: f64 = 1e-3;
/// How far the clearance of a turning move may exceed the truth, mm.
const ABOVE_MM: f64 = 5e-4;
const SAMPLES: usize = 160;

fn rotated(pose: &Pose) -> [f64; 4] {
    let size = pose.rotation.iter().map(|it| it * it).sum::<f64>().sqrt();
    pose.rotation.map(|it| it / size)
}

/// Returns the pose at fraction `t`: position linear, rotation along the shorter great circle.
fn pose_at(from: &Pose, to: &Pose, t: f64) -> Pose {
    let (a, mut b) = (rotated(from), rotated(to));
    let mut cos: f64 = (0..4).map(|i| a[i] * b[i]).sum();
    if cos < 0.0 {
        (b, cos) = (b.map(|it| -it), -cos);
    }
    let across = (0..4)
        .map(|i| (b[i] - cos * a[i]).powi(2))
        .sum::<f64>()
        .sqrt();
    let angle = across.atan2(cos);
    let rotation = [0, 1, 2, 3]
        .map(|i| a[i] * (t * angle).cos() + (b[i] - cos * a[i]) / across * (t * angle).sin());
    Pose {
        position: [0, 1, 2].map(|i| from.position[i] + t * (to.position[i] - from.position[i])),
        rotation,
    }
}

struct Turned {
    model: Model,
    mover: Mover,
    from: Pose,
    to: Pose,
}

impl Turned {
    fn drawn(seed: u64) -> Turned {
        let mut dice = Dice::new(seed);
        let mut shape = || match dice.pick(3) {
            0 => block(
                2.0 + dice.pick(40) as f64,
                1.0 + dice.pick(9) as f64,
                1.0 + dice.pick(9) as f64,
            ),
            1 => cylinder(1.0 + dice.pick(15) as f64, 2.0 + dice.pick(60) as f64),
            _ => Shape::Mesh(Mesh {
                vertices: [0; 3].map(|_| dice.vector().map(|it| 30.0 * it)).to_vec(),
                triangles: vec![[0, 1, 2]],
            }),
        };
        let (element, mover) = (shape(), shape());
        let mut pose = |reach: f64| Pose {
            position: dice.vector().map(|it| reach * it),
            rotation: [0; 4].map(|_| dice.signed()),
        };
        let (at, from, to) = (pose(10.0), pose(70.0), pose(70.0));
        Turned {
            model: standing(&element, at),
            mover: Mover::new(&mover).unwrap(),
            from,
            to,
        }
    }

    /// Returns the distance of the bodies at fraction `t`, found by a move of length zero.
    fn distance(&self, t: f64) -> f64 {
        let pose = pose_at(&self.from, &self.to, t);
        let found = self.model.clearance(&self.mover, &way(pose, pose), 1e6);
        found.unwrap().distance_mm
    }

    fn order(&self, margin_mm: f64) -> Move<'static> {
        Move {
            margin_mm,
            ..way(self.from, self.to)
        }
    }
}

#[test]
fn dense_samples_confirm_every_clear_turn_and_stop() {
    let mut blocked = 0;
    for seed in 0..250 {
        let turned = Turned::drawn(seed);
        let margin_mm = [0.0, 0.5, 3.0][seed as usize % 3];
        let samples: Vec<f64> = (0..=SAMPLES)
            .map(|step| turned.distance(step as f64 / SAMPLES as f64))
            .collect();
        let first = samples.iter().position(|distance| *distance <= margin_mm);
        match turned
            .model
            .first_contact(&turned.mover, &turned.order(margin_mm))
        {
            Answer::Clear => assert_eq!(first, None, "seed {seed}"),
            Answer::Blocked(contact) => {
                blocked += 1;
                if let Some(first) = first {
                    assert!(
                        contact.t_stop <= first as f64 / SAMPLES as f64,
                        "seed {seed}: late"
                    );
                }
                let there = turned.distance(contact.t_stop);
                assert!(
                    there <= margin_mm + FALSE_BLOCK_MM,
                    "seed {seed}: {there} mm left"
                );
                let before = samples
                    .iter()
                    .take((contact.t_stop * SAMPLES as f64) as usize);
                assert!(before.copied().all(|it| it > margin_mm), "seed {seed}");
            }
        }
        assert_eq!(
            turned
                .model
                .any_hit(&turned.mover, &turned.order(margin_mm))
                .is_some(),
            matches!(
                turned
                    .model
                    .first_contact(&turned.mover, &turned.order(margin_mm)),
                Answer::Blocked(_)
            ),
        );
    }
    assert!((40..220).contains(&blocked), "{blocked}");
}

#[test]
fn the_clearance_of_a_turn_matches_dense_samples() {
    for seed in 500..620 {
        let turned = Turned::drawn(seed);
        let found = turned
            .model
            .clearance(&turned.mover, &turned.order(0.0), 1e6)
            .unwrap();
        for step in 0..=SAMPLES {
            let sample = turned.distance(step as f64 / SAMPLES as f64);
            assert!(
                found.distance_mm <= sample + ABOVE_MM,
                "seed {seed}: {} of {sample}",
                found.distance_mm
            );
        }
        let there = turned.distance(found.t);
        assert!(
            (there - found.distance_mm).abs() < FALSE_BLOCK_MM,
            "seed {seed}: {there} {found:?}"
        );
    }
}

#[test]
fn the_clearance_of_a_turn_finds_the_deeper_valley() {
    // The samples lead into the other, shallower valley, 14.92486 mm. On the slope of the deeper one a distance is
    // lower by just the resolution, 2e-4 mm; a search that demands more than the resolution cannot advance there.
    let model = standing(&Shape::Block { half: [3.0; 3] }, Pose::IDENTITY);
    let block = Shape::Block { half: [5.0; 3] };
    let swung = Shape::Compound(vec![(Pose::at([5.0, 0.0, 0.0]), block)]);
    let from = Pose {
        position: [15.858059743240645, -1.1727218118222495, 37.514833948496076],
        rotation: [
            -1.2305917950416343,
            2.1655820996120987,
            2.027566346173307,
            -0.4326471016116851,
        ],
    };
    let to = Pose {
        position: [-33.90752309280117, -52.90991954304864, -10.256143184496771],
        rotation: [
            -0.5166633180814252,
            0.09840390704769587,
            0.4260378141827282,
            -0.6687123696163187,
        ],
    };
    let found = model.clearance(&swung, &way(from, to), 100.0).unwrap();
    assert!((found.distance_mm - 14.92425).abs() < 1e-5, "{found:?}");
    // The clearance lies just within the range, then just beyond it.
    let at = |range_mm: f64| model.clearance(&swung, &way(from, to), range_mm);
    assert!(at(found.distance_mm + 1e-3).is_some());
    assert!(at(found.distance_mm - 1e-3).is_none());
}

#[test]
fn a_reversed_turn_has_the_same_verdict() {
    for seed in 900..1_050 {
        let turned = Turned::drawn(seed);
        let back = way(turned.to, turned.from);
        let (there, back) = [turned.order(0.0), back]
            .map(|it| turned.model.any_hit(&turned.mover, &it).is_some())
            .into();
        let near = turned
            .model
            .clearance(&turned.mover, &turned.order(0.0), 1e6)
            .unwrap()
            .distance_mm;
        assert!(
            there == back || near < FALSE_BLOCK_MM,
            "seed {seed}: {near}"
        );
    }
}

#[test]
fn a_disc_turning_near_a_wall_stays_clear() {
    // The distance never changes, which is hardest for conservative advancement: the disc turns in place, or as it
    // slides.
    let wall = standing(&block(5.0, 100.0, 100.0), Pose::IDENTITY);
    let disc = cylinder(30.0, 8.0);
    for (gap, is_blocked) in [(-1e-3, true), (0.0, true), (1e-3, false), (0.1, false)] {
        let place = [35.0 + gap, 0.0, 0.0];
        let turn = way(Pose::at(place), Pose::yawed(place, 3.0));
        assert_eq!(wall.any_hit(&disc, &turn).is_some(), is_blocked, "{gap}");
        let slide = way(Pose::at(place), Pose::yawed([place[0], 40.0, 20.0], -2.5));
        assert_eq!(wall.any_hit(&disc, &slide).is_some(), is_blocked, "{gap}");
    }
}

#[test]
fn a_tiny_turn_equals_the_straight_move() {
    let post = standing(&cylinder(4.0, 30.0), Pose::at([50.0, 0.0, 0.0]));
    let mover = block(3.0, 3.0, 3.0);
    let straight_stop = stop(&post, &mover, &straight([0.0; 3], [100.0, 0.0, 0.0])).unwrap();
    for angle in [1e-14, 1e-12, 1e-9, 1e-7] {
        let order = way(Pose::IDENTITY, Pose::yawed([100.0, 0.0, 0.0], angle));
        let found = stop(&post, &mover, &order).unwrap();
        assert!((found - straight_stop).abs() < 1e-7, "{angle}: {found}");
        let beside = way(
            Pose::at([0.0, 7.01, 0.0]),
            Pose::yawed([100.0, 7.01, 0.0], angle),
        );
        assert_eq!(stop(&post, &mover, &beside), None, "{angle}");
    }
}

#[test]
fn a_long_arm_sweeps_its_arc_not_its_chord() {
    // The part lies 400 mm from the axis; on a quarter turn its arc is up to 117 mm away from the chord.
    let arm = Shape::Compound(vec![(Pose::at([400.0, 0.0, 0.0]), block(2.0, 2.0, 2.0))]);
    let quarter = way(
        Pose::IDENTITY,
        Pose::yawed([0.0; 3], std::f64::consts::FRAC_PI_2),
    );
    let on_arc = standing(
        &block(1.0, 1.0, 1.0),
        Pose::at([400.0 / 2f64.sqrt(), 400.0 / 2f64.sqrt(), 0.0]),
    );
    let on_chord = standing(&block(1.0, 1.0, 1.0), Pose::at([200.0, 200.0, 0.0]));
    let t = stop(&on_arc, &arm, &quarter).unwrap();
    assert!(t < 0.5 && t > 0.49, "{t}");
    assert_eq!(stop(&on_chord, &arm, &quarter), None);
}
