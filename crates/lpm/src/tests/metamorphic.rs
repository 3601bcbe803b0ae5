//! Tests of changes that must not alter an answer: exchanging mover and element, mirrors, other axes, a shift, an
//! element inserted and removed again; and of changes that may alter it in one direction only.
use super::*;
use crate::distance::tests::Dice;

/// A random pair of bodies near each other; places are multiples of 1/64 mm, so that sums are exact.
struct Drawn {
    element: Shape,
    mover: Shape,
    at: Pose,
    from: Pose,
    run: [f64; 3],
}

fn drawn(dice: &mut Dice) -> Drawn {
    let grid = |value: f64| (64.0 * value).round() / 64.0;
    let mut shape = || match dice.pick(3) {
        0 => block(
            1.0 + dice.pick(20) as f64,
            1.0 + dice.pick(20) as f64,
            1.0 + dice.pick(20) as f64,
        ),
        1 => cylinder(1.0 + dice.pick(20) as f64, 1.0 + dice.pick(20) as f64),
        _ => Shape::Mesh(Mesh {
            vertices: [0; 3]
                .map(|_| dice.vector().map(|it| grid(20.0 * it)))
                .to_vec(),
            triangles: vec![[0, 1, 2]],
        }),
    };
    let (element, mover) = (shape(), shape());
    let mut pose = |reach: f64| Pose {
        position: dice.vector().map(|it| grid(reach * it)),
        rotation: dice.rotation(),
    };
    let (at, from, goal) = (pose(10.0), pose(60.0), pose(60.0));
    Drawn {
        element,
        mover,
        at,
        from,
        run: [0, 1, 2].map(|axis| goal.position[axis] - from.position[axis]),
    }
}

fn answer(
    element: &Shape,
    at: Pose,
    mover: &Shape,
    from: Pose,
    run: [f64; 3],
) -> (Option<f64>, f64) {
    let model = standing(element, at);
    let to = from.moved_to([0, 1, 2].map(|axis| from.position[axis] + run[axis]));
    let way = way(from, to);
    (stop(&model, mover, &way), least(&model, mover, &way))
}

fn same(a: (Option<f64>, f64), b: (Option<f64>, f64), seed: u64) {
    assert_eq!(a.0.is_some(), b.0.is_some(), "seed {seed}: {a:?} {b:?}");
    if let (Some(t), Some(u)) = (a.0, b.0) {
        assert!((t - u).abs() < 1e-6, "seed {seed}: {a:?} {b:?}");
    }
    assert!((a.1 - b.1).abs() < 2e-6, "seed {seed}: {a:?} {b:?}");
}

#[test]
fn exchanging_mover_and_element_changes_no_answer() {
    for seed in 0..500 {
        let it = drawn(&mut Dice::new(seed));
        let back = it.run.map(|member| -member);
        same(
            answer(&it.element, it.at, &it.mover, it.from, it.run),
            answer(&it.mover, it.from, &it.element, it.at, back),
            seed,
        );
    }
}

#[test]
fn shifts_and_changes_of_axes_change_no_answer() {
    for seed in 1_000..1_400 {
        let it = drawn(&mut Dice::new(seed));
        let plain = answer(&it.element, it.at, &it.mover, it.from, it.run);
        let shifted = |pose: Pose| {
            pose.moved_to([0, 1, 2].map(|axis| pose.position[axis] + [4096.0, -512.0, 64.0][axis]))
        };
        same(
            plain,
            answer(
                &it.element,
                shifted(it.at),
                &it.mover,
                shifted(it.from),
                it.run,
            ),
            seed,
        );
        // A third of a turn about the diagonal takes x to y to z to x, exactly.
        let turned = |pose: Pose| {
            let ([x, y, z], [w, i, j, k]) = (pose.position, pose.rotation);
            Pose {
                position: [z, x, y],
                rotation: [w - i - j - k, w + i + k - j, w + j + i - k, w + k + j - i],
            }
        };
        let [x, y, z] = it.run;
        same(
            plain,
            answer(
                &it.element,
                turned(it.at),
                &it.mover,
                turned(it.from),
                [z, x, y],
            ),
            seed,
        );
    }
}

#[test]
fn larger_margins_and_longer_moves_stop_no_later() {
    for seed in 2_000..2_300 {
        let it = drawn(&mut Dice::new(seed));
        let model = standing(&it.element, it.at);
        let to = |share: f64| {
            it.from
                .moved_to([0, 1, 2].map(|axis| it.from.position[axis] + share * it.run[axis]))
        };
        let mut last = 2.0;
        for margin_mm in [0.0, 0.25, 1.0, 4.0, 16.0] {
            let order = Move {
                margin_mm,
                ..way(it.from, to(1.0))
            };
            let t = stop(&model, &it.mover, &order).unwrap_or(1.5);
            assert!(
                t <= last + 1e-9,
                "seed {seed}: margin {margin_mm} stops at {t}, less at {last}"
            );
            last = t;
        }
        let blocked = |share: f64| stop(&model, &it.mover, &way(it.from, to(share))).is_some();
        assert!(!blocked(0.5) || blocked(1.0), "seed {seed}");
    }
}

#[test]
fn removed_elements_leave_every_answer_identical_in_bits() {
    for seed in 3_000..3_060 {
        let mut dice = Dice::new(seed);
        let it = drawn(&mut dice);
        let mut model = standing(&it.element, it.at);
        let to = it
            .from
            .moved_to([0, 1, 2].map(|axis| it.from.position[axis] + it.run[axis]));
        let order = way(it.from, to);
        let before = (
            model.first_contact(&it.mover, &order),
            model.clearance(&it.mover, &order, 50.0),
        );
        for _ in 0..20 {
            let other = drawn(&mut dice);
            let key = model.insert("guest", &other.element, &other.from).unwrap();
            assert!(model.remove(key));
        }
        let after = (
            model.first_contact(&it.mover, &order),
            model.clearance(&it.mover, &order, 50.0),
        );
        assert_eq!(before, after, "seed {seed}");
    }
}

#[test]
fn the_clearance_reaches_zero_at_the_stop() {
    // The path up to just before the stop is clear, and the stop itself is within the margin.
    for seed in 4_000..4_400 {
        let it = drawn(&mut Dice::new(seed));
        let model = standing(&it.element, it.at);
        let to = |share: f64| {
            it.from
                .moved_to([0, 1, 2].map(|axis| it.from.position[axis] + share * it.run[axis]))
        };
        let Some(t) = stop(&model, &it.mover, &way(it.from, to(1.0))) else {
            continue;
        };
        if t > 1e-3 {
            let short = way(it.from, to(t * (1.0 - 1e-6)));
            assert_eq!(stop(&model, &it.mover, &short), None, "seed {seed}");
        }
        let there = least(&model, &it.mover, &way(to(t), to(t)));
        assert!(there < 1e-6, "seed {seed}: {there} mm left at the stop");
    }
}

#[test]
fn a_body_at_rest_is_checked_like_a_start() {
    let mut dice = Dice::new(41);
    let (mut met, mut clear) = (0, 0);
    for round in 0..60 {
        let mut model = Model::new();
        for _ in 0..30 {
            let Drawn { element, at, .. } = drawn(&mut dice);
            let upright = Pose::yawed(at.position.map(|it| 8.0 * it), f64::from(round % 3));
            let tilted = at.moved_to(upright.position);
            let pose = if dice.pick(4) == 0 { tilted } else { upright };
            model.insert("element", &element, &pose).unwrap();
        }
        let parts = [(); 6].map(|()| {
            let part = drawn(&mut dice);
            (Pose::at(part.at.position.map(|it| 2.0 * it)), part.mover)
        });
        let hand = Mover::new(&Shape::Compound(parts.into())).unwrap();
        for _ in 0..20 {
            let from = Pose {
                position: dice.vector().map(|it| 110.0 * it),
                rotation: [[1.0, 0.0, 0.0, 0.0], [0.8, 0.0, 0.0, -0.6], dice.rotation()]
                    [dice.pick(3) as usize],
            };
            let margin_mm = [0.0, 0.0, 2.5][dice.pick(3) as usize];
            let asked = |to| Move {
                margin_mm,
                ..way(from, to)
            };
            let there = from.moved_to(dice.vector().map(|it| 200.0 * it));
            let begins = match model.first_contact(&hand, &asked(there)) {
                Answer::Blocked(contact) => contact.t_stop == 0.0,
                Answer::Clear => false,
            };
            let rests = model.any_hit(&hand, &asked(from)).is_some();
            assert_eq!(rests, begins, "{from:?} {margin_mm}");
            let first = model.first_contact(&hand, &asked(from));
            assert_eq!(first != Answer::Clear, begins, "{from:?} {margin_mm}");
            // The negated quaternion is the same rotation, so the path has length zero, but its ends differ in
            // their bits.
            let negated = from.rotation.map(|member| -member);
            let reworded = model.any_hit(
                &hand,
                &asked(Pose {
                    rotation: negated,
                    ..from
                }),
            );
            assert_eq!(reworded.is_some(), begins, "{from:?} {margin_mm}");
            met += u32::from(rests);
            clear += u32::from(!rests);
        }
    }
    assert!(met > 200 && clear > 200, "{met} {clear}");
}
