//! Facts about the collision core: the hard cases by name.
#![allow(clippy::unwrap_used)]
use super::distance::tests::Dice;
use super::*;

fn block(x: f64, y: f64, z: f64) -> Shape {
    Shape::Block { half: [x, y, z] }
}

fn cylinder(radius: f64, height: f64) -> Shape {
    Shape::Cylinder { radius, height }
}

fn standing(shape: &Shape, pose: Pose) -> Model {
    let mut model = Model::new();
    model.insert("element", shape, &pose).unwrap();
    model
}

fn way(from: Pose, to: Pose) -> Move<'static> {
    Move {
        from,
        to,
        margin_mm: 0.0,
        ignore: &[],
    }
}

fn straight(from: [f64; 3], to: [f64; 3]) -> Move<'static> {
    way(Pose::at(from), Pose::at(to))
}

/// `None` when clear; the three questions must agree.
fn stop(model: &Model, mover: &Shape, way: &Move) -> Option<f64> {
    let stop = match model.first_contact(mover, way) {
        Answer::Clear => None,
        Answer::Blocked(contact) => Some(contact.t_stop),
    };
    assert_eq!(
        stop.is_some(),
        model.any_hit(mover, way).is_some(),
        "{way:?}"
    );
    stop
}

fn least(model: &Model, mover: &Shape, way: &Move) -> f64 {
    model.clearance(mover, way, 1e6).unwrap().distance_mm
}

#[test]
fn a_move_of_no_length_is_judged_where_it_stands() {
    let model = standing(&block(1.0, 1.0, 1.0), Pose::IDENTITY);
    let still = |x| straight([x, 0.0, 0.0], [x, 0.0, 0.0]);
    assert_eq!(stop(&model, &block(1.0, 1.0, 1.0), &still(2.0)), Some(0.0));
    assert_eq!(stop(&model, &cylinder(1.0, 2.0), &still(1.0)), Some(0.0));
    assert_eq!(stop(&model, &cylinder(1.0, 2.0), &still(2.000_01)), None);
}

#[test]
fn leaving_a_contact_is_blocked_at_its_start() {
    let model = standing(&block(10.0, 10.0, 1.0), Pose::IDENTITY);
    let leave = straight([0.0, 0.0, 2.0], [0.0, 0.0, 30.0]);
    assert_eq!(stop(&model, &block(1.0, 1.0, 1.0), &leave), Some(0.0));
}

#[test]
fn a_foil_is_not_tunnelled_by_a_ten_metre_move() {
    let foil = standing(&block(0.0005, 50.0, 50.0), Pose::at([5000.0, 0.0, 0.0]));
    let way = straight([0.0, 0.0, 0.0], [10_000.0, 3.0, 7.0]);
    let t = stop(&foil, &cylinder(0.5, 1.0), &way).unwrap();
    assert!((t - (5000.0 - 0.0005 - 0.5) / 10_000.0).abs() < 1e-9);
    let tilted = standing(
        &block(0.0005, 50.0, 50.0),
        Pose {
            position: [5000.0, 0.0, 0.0],
            rotation: [0.9, 0.1, 0.2, 0.3],
        },
    );
    assert!(stop(&tilted, &cylinder(0.5, 1.0), &way).is_some());
}

#[test]
fn overlaps_at_the_start_that_others_missed_are_blocked() {
    // Cylinder on cylinder, 1 mm deep, sliding: a published miss.
    let model = standing(&cylinder(13.5625, 55.75), Pose::IDENTITY);
    let slide = straight([0.0, 0.0, 39.203125], [1.0, 0.5, 39.203125]);
    assert_eq!(
        stop(&model, &cylinder(26.90625, 24.65625), &slide),
        Some(0.0)
    );
    // Two coaxial cylinders, one inside the other, at rest.
    let rest = straight([0.0; 3], [0.0; 3]);
    assert_eq!(stop(&model, &cylinder(5.0, 10.0), &rest), Some(0.0));
    // A box going down into a box by 1 mm.
    let base = standing(&block(20.0, 20.0, 10.0), Pose::IDENTITY);
    let down = straight([0.0, 0.0, 30.0], [0.0, 0.0, 19.0]);
    let t = stop(&base, &block(5.0, 5.0, 10.0), &down).unwrap();
    assert!((t - 10.0 / 11.0).abs() < 1e-12);
}

#[test]
fn grazing_passes_are_told_from_contact_to_a_hundredth_of_a_micrometre() {
    for offset in [0.0, 1e3, 1e5, 9.9e5] {
        for gap in [1e-3, 1e-4, 1e-5] {
            let model = standing(&block(10.0, 10.0, 10.0), Pose::at([offset, offset, 0.0]));
            let pass = |height: f64| {
                straight(
                    [offset - 900.0, offset, height],
                    [offset + 900.0, offset + 3.0, height],
                )
            };
            let mover = cylinder(4.0, 6.0);
            assert_eq!(
                stop(&model, &mover, &pass(13.0 + gap)),
                None,
                "{offset} {gap}"
            );
            assert!(stop(&model, &mover, &pass(13.0)).is_some());
            let clearance = least(&model, &mover, &pass(13.0 + gap));
            assert!(
                (clearance - gap).abs() < 5e-8 + 1e-15 * offset,
                "{clearance} {gap} {offset}"
            );
        }
    }
}

#[test]
fn near_parallel_edges_are_never_separated_by_noise() {
    for exponent in 4..=14 {
        let angle = 10f64.powi(-exponent);
        let lower = standing(&block(100.0, 5.0, 5.0), Pose::IDENTITY);
        let rotation = [1.0, 0.0, 0.5 * angle, 0.5 * angle];
        let at = |height: f64| Pose {
            position: [0.0, 0.0, height],
            rotation,
        };
        let still = |height: f64| way(at(height), at(height));
        // The upper bar dips by about 100 mm times the angle.
        let dip = 100.0 * angle;
        assert!(
            stop(&lower, &block(100.0, 5.0, 5.0), &still(10.0 + 0.9 * dip)).is_some(),
            "{angle}"
        );
        assert!(
            stop(
                &lower,
                &block(100.0, 5.0, 5.0),
                &still(10.0 + 1.1 * dip + 1e-5)
            )
            .is_none(),
            "{angle}"
        );
    }
}

#[test]
fn a_tilt_of_a_picoradian_changes_nothing() {
    let model = standing(&block(30.0, 30.0, 10.0), Pose::IDENTITY);
    let rotation = [1.0, 0.5e-12, 0.3e-12, 0.0];
    for mover in [cylinder(8.0, 20.0), block(8.0, 4.0, 10.0)] {
        let slide = |height: f64| {
            let at = |x: f64| Pose {
                position: [x, 0.0, height],
                rotation,
            };
            way(at(-100.0), at(100.0))
        };
        assert!(stop(&model, &mover, &slide(20.0)).is_some());
        assert_eq!(stop(&model, &mover, &slide(20.000_001_1)), None);
    }
}

#[test]
fn crossed_and_tangent_cylinders_touch_where_their_mantles_do() {
    let lying = [
        std::f64::consts::FRAC_1_SQRT_2,
        std::f64::consts::FRAC_1_SQRT_2,
        0.0,
        0.0,
    ];
    let model = standing(
        &cylinder(7.0, 80.0),
        Pose {
            position: [0.0; 3],
            rotation: lying,
        },
    );
    let across = |gap: f64| {
        let rotation = [0.5, 0.5, 0.5, 0.5];
        let at = |z: f64| Pose {
            position: [0.0, 0.0, z],
            rotation,
        };
        way(at(50.0), at(12.0 + gap))
    };
    assert!(stop(&model, &cylinder(5.0, 60.0), &across(0.0)).is_some());
    assert_eq!(stop(&model, &cylinder(5.0, 60.0), &across(1e-6)), None);
    let upright = standing(&cylinder(7.0, 80.0), Pose::IDENTITY);
    let tangent = |y: f64| straight([-500.0, y, 0.0], [500.0, y, 0.0]);
    assert!(stop(&upright, &cylinder(5.0, 60.0), &tangent(12.0)).is_some());
    assert_eq!(
        stop(&upright, &cylinder(5.0, 60.0), &tangent(12.000_001)),
        None
    );
}

#[test]
fn a_rim_stops_on_a_corner() {
    // Corner of the block at 45 degrees: the rim touches at distance r from the corner.
    let model = standing(&block(10.0, 10.0, 10.0), Pose::IDENTITY);
    let mover = cylinder(5.0, 10.0);
    let slide = straight([40.0, 40.0, 15.0], [0.0, 0.0, 15.0]);
    let t = stop(&model, &mover, &slide).unwrap();
    let truth = 1.0 - (10.0 + 5.0 / 2f64.sqrt()) / 40.0;
    assert!(t <= truth && truth - t < 1e-12, "{t} {truth}");
}

#[test]
fn the_order_of_the_corners_of_a_triangle_does_not_matter() {
    let orders = [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ];
    let mesh = |vertices: [[f64; 3]; 3], order| {
        Shape::Mesh(Mesh {
            vertices: vertices.to_vec(),
            triangles: vec![order],
        })
    };
    let flat = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0]];
    let touching = [[2.0, 2.0, 0.0], [2.0, 2.0, 5.0], [3.0, 2.5, 5.0]];
    let apart = touching.map(|corner| [corner[0], corner[1], corner[2] + 1e-5]);
    for first in orders {
        for second in orders {
            let model = standing(&mesh(flat, first), Pose::IDENTITY);
            let still = straight([0.0; 3], [0.0; 3]);
            assert!(stop(&model, &mesh(touching, second), &still).is_some());
            assert!(stop(&model, &mesh(apart, second), &still).is_none());
        }
    }
}

#[test]
fn slivers_segments_and_points_are_legal_triangles() {
    let thin = |third: [f64; 3]| {
        Shape::Mesh(Mesh {
            vertices: vec![[0.0; 3], [100.0, 0.0, 0.0], third],
            triangles: vec![[0, 1, 2]],
        })
    };
    for third in [
        [50.0, 1e-9, 0.0],
        [50.0, 0.0, 0.0],
        [100.0, 0.0, 0.0],
        [100.0, 0.0, 1e-300],
    ] {
        let model = standing(&thin(third), Pose::IDENTITY);
        let down = |to: f64| straight([70.0, 0.0, 60.0], [70.0, 0.0, to]);
        let t = stop(&model, &block(5.0, 5.0, 5.0), &down(0.0)).unwrap();
        assert!((t - 55.0 / 60.0).abs() < 1e-9, "{t}");
        assert_eq!(stop(&model, &block(5.0, 5.0, 5.0), &down(5.000_001)), None);
    }
    let point = Shape::Mesh(Mesh {
        vertices: vec![[1.0, 2.0, 3.0]],
        triangles: vec![[0, 0, 0]],
    });
    let model = standing(&point, Pose::IDENTITY);
    assert!(
        stop(
            &model,
            &cylinder(1.0, 2.0),
            &straight([1.0, 2.0, 9.0], [1.0, 2.0, 4.0])
        )
        .is_some()
    );
}

/// A closed box as a mesh, optionally without its lid.
fn box_mesh(half: f64, lid: bool) -> Shape {
    let corner =
        |index: usize| [0, 1, 2].map(|axis| if index >> axis & 1 == 1 { half } else { -half });
    let mut faces = vec![
        [0, 1, 3, 2],
        [0, 1, 5, 4],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 3, 7, 5],
    ];
    if lid {
        faces.push([4, 5, 7, 6]);
    }
    let triangles = faces
        .iter()
        .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    Shape::Mesh(Mesh {
        vertices: (0..8).map(corner).collect(),
        triangles: triangles.collect(),
    })
}

#[test]
fn a_closed_mesh_is_solid_and_an_open_one_is_hollow() {
    let inside = straight([0.5, 0.2, 0.1], [1.0, 1.0, 1.0]);
    let mover = block(1.0, 1.0, 1.0);
    assert_eq!(
        stop(
            &standing(&box_mesh(20.0, true), Pose::IDENTITY),
            &mover,
            &inside
        ),
        Some(0.0)
    );
    let open = standing(&box_mesh(20.0, false), Pose::IDENTITY);
    assert_eq!(stop(&open, &mover, &inside), None);
    assert!((least(&open, &mover, &inside) - 18.0).abs() < 1e-9);
    // The other way round: the mover surrounds the element.
    let pin = standing(&cylinder(1.0, 2.0), Pose::IDENTITY);
    assert_eq!(stop(&pin, &box_mesh(20.0, true), &inside), Some(0.0));
    assert_eq!(stop(&pin, &box_mesh(20.0, false), &inside), None);
}

#[test]
fn a_turning_bar_stops_where_geometry_says_and_never_later() {
    // Bar 200 x 10 about z, pin of radius 4 at 80 mm under 60 degrees.
    let (distance, angle) = (80.0, 60f64.to_radians());
    let model = standing(
        &cylinder(4.0, 50.0),
        Pose::at([distance * angle.cos(), distance * angle.sin(), 0.0]),
    );
    let quarter = way(Pose::IDENTITY, Pose::yawed([0.0; 3], 90f64.to_radians()));
    let t = stop(&model, &block(100.0, 5.0, 5.0), &quarter).unwrap();
    let truth = (angle - (9.0_f64 / distance).asin()) / 90f64.to_radians();
    assert!(t <= truth && truth - t < 1e-6, "{t} {truth}");
}

#[test]
fn half_a_turn_meets_what_stands_beside_both_ends_of_it() {
    // Start and end look alike; the pin is only met on the way.
    let model = standing(&cylinder(4.0, 50.0), Pose::at([0.0, 90.0, 0.0]));
    let turn = way(Pose::IDENTITY, Pose::yawed([0.0; 3], 179f64.to_radians()));
    assert!(stop(&model, &block(100.0, 5.0, 5.0), &turn).is_some());
    let shorter = block(80.0, 5.0, 5.0);
    assert_eq!(stop(&model, &shorter, &turn), None);
    let truth = 90.0 - 4.0 - 80f64.hypot(5.0);
    let found = least(&model, &shorter, &turn);
    let flat = 6.0; // the end face passes the pin squarely, its corners swing nearer
    assert!(
        found <= flat && (found - truth).abs() < 1e-3,
        "{found} {truth}"
    );
}

#[test]
fn what_is_not_a_number_is_blocked_by_nothing_in_particular() {
    let model = Model::new();
    let nan = straight([0.0; 3], [f64::NAN, 0.0, 0.0]);
    let Answer::Blocked(contact) = model.first_contact(&block(1.0, 1.0, 1.0), &nan) else {
        panic!("clear")
    };
    assert_eq!(contact.blocker, ElementKey::UNDECIDABLE);
    assert_eq!(model.id(contact.blocker), "(undecidable)");
    let negative = Move {
        margin_mm: -1.0,
        ..straight([0.0; 3], [1.0, 0.0, 0.0])
    };
    assert!(model.any_hit(&block(1.0, 1.0, 1.0), &negative).is_some());
    assert!(
        model
            .any_hit(
                &block(1.0, f64::INFINITY, 1.0),
                &straight([0.0; 3], [0.0; 3])
            )
            .is_some()
    );
    let zero = way(
        Pose {
            position: [0.0; 3],
            rotation: [0.0; 4],
        },
        Pose::IDENTITY,
    );
    assert!(model.any_hit(&block(1.0, 1.0, 1.0), &zero).is_some());
}

#[test]
fn an_element_that_was_taken_out_blocks_no_more_and_its_name_is_not_reused() {
    let mut model = Model::new();
    let plate = model
        .insert("plate", &block(500.0, 500.0, 5.0), &Pose::IDENTITY)
        .unwrap();
    let pin = model
        .insert("pin", &cylinder(4.0, 30.0), &Pose::at([50.0, 0.0, 25.0]))
        .unwrap();
    let pass = straight([-100.0, 0.0, 20.0], [100.0, 0.0, 20.0]);
    let mover = block(2.0, 2.0, 2.0);
    assert_eq!(model.any_hit(&mover, &pass), Some(pin));
    assert_eq!(
        model.any_hit(
            &mover,
            &Move {
                ignore: &[pin],
                ..pass
            }
        ),
        None
    );
    assert!(model.remove(pin) && !model.remove(pin));
    assert_eq!((model.any_hit(&mover, &pass), model.len()), (None, 1));
    let again = model
        .insert("other", &cylinder(4.0, 30.0), &Pose::at([50.0, 0.0, 25.0]))
        .unwrap();
    assert_ne!(again, pin);
    assert_eq!(
        (model.id(pin), model.id(again), model.id(plate)),
        ("(removed)", "other", "plate")
    );
    assert_eq!(model.any_hit(&mover, &pass), Some(again));
}

#[test]
fn a_margin_must_be_exceeded_and_not_only_kept() {
    let model = standing(&block(10.0, 10.0, 10.0), Pose::IDENTITY);
    let pass = |margin_mm| Move {
        margin_mm,
        ..straight([-50.0, 0.0, 15.5], [50.0, 0.0, 15.5])
    };
    assert!(stop(&model, &block(5.0, 5.0, 5.0), &pass(0.5)).is_some());
    assert_eq!(stop(&model, &block(5.0, 5.0, 5.0), &pass(0.499_999)), None);
}

fn scene(dice: &mut Dice, count: usize) -> Vec<(Shape, Pose)> {
    (0..count)
        .map(|_| {
            let place = dice.vector().map(|member| 400.0 * member);
            let rotation = dice.rotation();
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
fn the_broad_phase_loses_nobody() {
    for seed in 0..40 {
        let mut dice = Dice(seed);
        let elements = scene(&mut dice, 60);
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
            let rotation = dice.rotation();
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
fn there_and_back_and_in_two_halves_give_the_same_verdict() {
    for seed in 1000..1400 {
        let mut dice = Dice(seed);
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

#[test]
fn every_box_and_move_of_a_small_world_is_judged_as_whole_numbers_say() {
    let mut counted = 0;
    let element = standing(&block(1.0, 0.5, 1.5), Pose::IDENTITY);
    for size in [[1, 1, 1], [2, 1, 3], [1, 4, 2]] {
        let mover = block(
            f64::from(size[0]) / 2.0,
            f64::from(size[1]) / 2.0,
            f64::from(size[2]) / 2.0,
        );
        // Everything doubled: whole numbers. Sum of the half extents of both bodies.
        let reach = [2 + size[0], 1 + size[1], 3 + size[2]];
        for code in 0..7 * 7 * 7 * 5 * 5 * 5 {
            let digit = |index: u32, base: i32| {
                code / 7_i32.pow(index.min(3)) / 5_i32.pow(index.saturating_sub(3)) % base
            };
            let start = [
                2 * digit(0, 7) - 6,
                2 * digit(1, 7) - 6,
                2 * digit(2, 7) - 6,
            ];
            let run = [
                4 * digit(3, 5) - 8,
                4 * digit(4, 5) - 8,
                4 * digit(5, 5) - 8,
            ];
            let from = start.map(|member| f64::from(member) / 2.0);
            let to = [0, 1, 2].map(|axis| f64::from(start[axis] + run[axis]) / 2.0);
            let found = stop(&element, &mover, &straight(from, to));
            assert_eq!(
                found.is_some(),
                slabs_meet(start, run, reach),
                "{start:?} {run:?} {reach:?}"
            );
            counted += 1;
        }
    }
    assert_eq!(counted, 3 * 343 * 125);
}

/// Exact: is there a `t` in 0..=1 with `|start + t run| <= reach` on every axis?
fn slabs_meet(start: [i32; 3], run: [i32; 3], reach: [i32; 3]) -> bool {
    // t as a fraction (numerator, positive denominator).
    let (mut low, mut high) = ((0, 1), (1, 1));
    for axis in 0..3 {
        let (s, r, limit) = (start[axis], run[axis], reach[axis]);
        if r == 0 {
            if s.abs() > limit {
                return false;
            }
            continue;
        }
        let ends = [(-limit - s) * r.signum(), (limit - s) * r.signum()];
        let (enter, leave) = (
            (ends[0].min(ends[1]), r.abs()),
            (ends[0].max(ends[1]), r.abs()),
        );
        if enter.0 * low.1 > low.0 * enter.1 {
            low = enter;
        }
        if leave.0 * high.1 < high.0 * leave.1 {
            high = leave;
        }
    }
    low.0 * high.1 <= high.0 * low.1
}
