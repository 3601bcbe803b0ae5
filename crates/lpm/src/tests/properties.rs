//! Tests of properties that must hold for many random scenes.
use super::*;
use crate::distance::tests::Dice;

fn scene(dice: &mut Dice, count: usize) -> Vec<(Shape, Pose)> {
    turned_scene(dice, count, Dice::rotation)
}

fn turned_scene(
    dice: &mut Dice,
    count: usize,
    turn: fn(&mut Dice) -> [f64; 4],
) -> Vec<(Shape, Pose)> {
    (0..count)
        .map(|_| {
            let place = dice.vector().map(|member| 400.0 * member);
            let rotation = turn(dice);
            let mut size = || 15.0 * (1.1 + dice.signed());
            let shape = match size() as u64 % 3 {
                0 => block(size(), size(), size()),
                1 => cylinder(size(), size()),
                _ => Shape::Compound(vec![
                    (Pose::IDENTITY, block(size(), size(), size())),
                    (Pose::at([0.0, 0.0, 20.0]), cylinder(size(), size())),
                ]),
            };
            (
                shape,
                Pose {
                    position: place,
                    rotation,
                },
            )
        })
        .collect()
}

#[test]
fn the_broad_phase_loses_no_contact() {
    for seed in 0..40 {
        let mut dice = Dice::new(seed);
        // In every second scene all bodies stand upright, as closed forms want them.
        let turn = if seed % 2 == 0 {
            Dice::rotation
        } else {
            |_: &mut Dice| Pose::IDENTITY.rotation
        };
        let elements = turned_scene(&mut dice, 60, turn);
        let mut model = Model::new();
        let mut keys = Vec::new();
        for (shape, pose) in &elements {
            keys.push(model.insert("e", shape, pose).unwrap());
        }
        model
            .insert("far", &block(1.0, 1.0, 1.0), &Pose::at([9e5, -9e5, 3.0]))
            .unwrap();
        for key in keys.iter().take(20) {
            model.remove(*key);
        }
        let alone: Vec<Model> = elements[20..]
            .iter()
            .map(|(shape, pose)| standing(shape, *pose))
            .collect();
        for _ in 0..20 {
            let (mover, _) = scene(&mut dice, 1).remove(0);
            let rotation = turn(&mut dice);
            let ends = [0, 1].map(|_| Pose {
                position: dice.vector().map(|member| 700.0 * member),
                rotation,
            });
            let move_ = Move {
                margin_mm: dice.signed().max(0.0),
                ..way(ends[0], ends[1])
            };
            let first = alone
                .iter()
                .filter_map(|one| stop(one, &mover, &move_))
                .min_by(f64::total_cmp);
            assert_eq!(stop(&model, &mover, &move_), first, "seed {seed}");
            let met = |at: &usize| alone[*at].any_hit(&mover, &move_).is_some();
            let each: Vec<ElementKey> = (0..alone.len())
                .filter(met)
                .map(|at| keys[20 + at])
                .collect();
            assert_eq!(model.every_hit(&mover, &move_), each, "seed {seed}");
            let nearest = alone
                .iter()
                .map(|one| least(one, &mover, &move_))
                .fold(f64::INFINITY, f64::min);
            assert!(
                (least(&model, &mover, &move_) - nearest).abs() < 1e-8,
                "seed {seed}"
            );
        }
    }
}

#[test]
fn reversed_and_halved_moves_give_the_same_verdict() {
    for seed in 1000..1400 {
        let mut dice = Dice::new(seed);
        let (element, pose) = scene(&mut dice, 1).remove(0);
        let model = standing(
            &element,
            Pose {
                position: pose.position.map(|member| member / 20.0),
                ..pose
            },
        );
        let (mover, _) = scene(&mut dice, 1).remove(0);
        let rotation = dice.rotation();
        let [from, to] = [0, 1].map(|_| Pose {
            position: dice.vector().map(|member| 90.0 * member),
            rotation,
        });
        let middle =
            from.moved_to([0, 1, 2].map(|axis| (from.position[axis] + to.position[axis]) / 2.0));
        let whole = stop(&model, &mover, &way(from, to));
        assert_eq!(
            whole.is_some(),
            stop(&model, &mover, &way(to, from)).is_some(),
            "seed {seed}"
        );
        let halves =
            [way(from, middle), way(middle, to)].map(|half| stop(&model, &mover, &half).is_some());
        assert_eq!(whole.is_some(), halves[0] || halves[1], "seed {seed}");
        let clearance = least(&model, &mover, &way(from, to));
        assert_eq!(
            whole.is_some(),
            clearance <= 0.0,
            "seed {seed}: {clearance}"
        );
    }
}
