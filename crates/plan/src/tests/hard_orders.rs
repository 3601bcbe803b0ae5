//! Orders that need more than the rule of the paper: ways of two steps, subassemblies, groups, locked sets.
use super::*;

/// A box with a bottom, a lid and four walls around a cube.
fn boxed(open: bool) -> Vec<Element> {
    let mut elements = vec![
        between("bottom", [0.0, 0.0, 0.0], [10.0, 10.0, 1.0]),
        between("west", [0.0, 0.0, 1.0], [1.0, 10.0, 9.0]),
        between("east", [9.0, 0.0, 1.0], [10.0, 10.0, 9.0]),
        between("south", [1.0, 0.0, 1.0], [9.0, 1.0, 9.0]),
        between("north", [1.0, 9.0, 1.0], [9.0, 10.0, 9.0]),
        between("cube", [3.0, 3.0, 1.0], [6.0, 6.0, 4.0]),
    ];
    if !open {
        elements.push(between("lid", [0.0, 0.0, 9.0], [10.0, 10.0, 10.0]));
    }
    elements
}

#[test]
fn only_what_must_come_off_comes_off() {
    let assembly = assembled(boxed(false));
    let demands = Demands {
        remove: vec!["cube".to_owned()],
        ..Demands::default()
    };
    let sequence = sequence_of(&assembly, &demands);
    assert!(sequence.is_fewest_elements);
    assert_eq!(sequence.steps.len(), 2);
    let ids: Vec<&str> = sequence
        .steps
        .iter()
        .map(|step| assembly.id(step.elements[0]))
        .collect();
    assert_eq!(ids[1], "cube");
    let kept = Demands {
        stay: ["lid", "west", "east"].map(str::to_owned).to_vec(),
        forbidden: vec![Direction::MinusZ],
        ..demands
    };
    let told = told(&assembly, &sequence_of(&assembly, &kept).steps);
    assert!(
        [["south -y", "cube -y"], ["north +y", "cube +y"]]
            .iter()
            .any(|it| told == it),
        "{told:?}"
    );
}

#[test]
fn a_locked_set_names_what_holds_it() {
    let assembly = assembled(boxed(false));
    let demands = Demands {
        remove: vec!["cube".to_owned()],
        stay: ["lid", "bottom", "west", "east", "north", "south"]
            .map(str::to_owned)
            .to_vec(),
        ..Demands::default()
    };
    let Outcome::Locked(locked) = planned(&assembly, &demands) else {
        panic!("solved")
    };
    assert_eq!(locked.elements, [5]);
    assert_eq!(locked.by, [vec![0, 1, 2, 3, 4, 6]]);
}

#[test]
fn two_links_of_a_chain_lock_each_other() {
    let ring = |id: &str, at: [f64; 3], turned: bool| {
        let mut ring = holed(id, 6.0, 4.0, -1.0, 1.0);
        ring.pose = Pose {
            position: at,
            rotation: if turned {
                [0.5_f64.sqrt(), 0.5_f64.sqrt(), 0.0, 0.0]
            } else {
                [1.0, 0.0, 0.0, 0.0]
            },
        };
        ring
    };
    let assembly = assembled(vec![
        ring("first", [0.0; 3], false),
        ring("second", [5.0 + 2.0, 0.0, 0.0], true),
        between("free", [20.0, 0.0, 0.0], [22.0, 2.0, 2.0]),
    ]);
    let Outcome::Locked(locked) = planned(&assembly, &Demands::default()) else {
        panic!("solved")
    };
    assert_eq!(locked.elements, [0, 1]);
    assert_eq!(locked.by, [vec![1], vec![0]]);
    assert!(locked.is_smallest);
}

#[test]
fn a_hook_leaves_in_two_steps() {
    // The slot opens upward only left of the roof: the foot goes left, then up.
    let elements = vec![
        between("floor", [0.0, 0.0, 0.0], [20.0, 4.0, 1.0]),
        between("wall", [18.0, 0.0, 1.0], [20.0, 4.0, 5.0]),
        between("stop", [0.0, 0.0, 1.0], [2.0, 4.0, 8.0]),
        between("roof", [10.0, 0.0, 4.0], [18.0, 4.0, 5.0]),
        between("front", [0.0, -1.0, 0.0], [20.0, 0.0, 8.0]),
        between("back", [0.0, 4.0, 0.0], [20.0, 5.0, 8.0]),
        between("foot", [11.0, 0.0, 1.0], [17.0, 4.0, 4.0]),
    ];
    let assembly = assembled(elements);
    let demands = Demands {
        remove: vec!["foot".to_owned()],
        stay: ["floor", "wall", "stop", "roof", "front", "back"]
            .map(str::to_owned)
            .to_vec(),
        ..Demands::default()
    };
    let sequence = sequence_of(&assembly, &demands);
    assert_eq!(told(&assembly, &sequence.steps), ["foot -x +z"]);
    assert!((sequence.steps[0].legs[0].distance_mm - 7.0).abs() < 1e-6);
    let straight = Demands {
        straight_only: true,
        ..demands
    };
    assert!(matches!(planned(&assembly, &straight), Outcome::Locked(_)));
}

#[test]
fn a_subassembly_leaves_whole_and_comes_apart_outside() {
    // Two interlocked combs fill a pocket that is open upward; they part sideways, for which the pocket has no room.
    let elements = vec![
        between("floor", [-2.0, -2.0, -1.0], [12.0, 6.0, 0.0]),
        between("west", [-2.0, 0.0, 0.0], [0.0, 4.0, 6.0]),
        between("east", [10.0, 0.0, 0.0], [12.0, 4.0, 6.0]),
        between("south", [-2.0, -2.0, 0.0], [12.0, 0.0, 6.0]),
        between("north", [-2.0, 4.0, 0.0], [12.0, 6.0, 6.0]),
        element(
            "lower comb",
            Shape::Compound(vec![
                (Pose::at([2.5, 2.0, 1.0]), block([2.5, 2.0, 1.0])),
                (Pose::at([1.0, 2.0, 3.0]), block([1.0, 2.0, 1.0])),
                (Pose::at([2.5, 2.0, 5.0]), block([2.5, 2.0, 1.0])),
            ]),
            [0.0; 3],
        ),
        element(
            "upper comb",
            Shape::Compound(vec![
                (Pose::at([6.0, 2.0, 3.0]), block([4.0, 2.0, 1.0])),
                (Pose::at([7.5, 2.0, 1.0]), block([2.5, 2.0, 1.0])),
                (Pose::at([7.5, 2.0, 5.0]), block([2.5, 2.0, 1.0])),
            ]),
            [0.0; 3],
        ),
    ];
    let assembly = assembled(elements);
    let demands = Demands {
        stay: ["floor", "west", "east", "south", "north"]
            .map(str::to_owned)
            .to_vec(),
        ..Demands::default()
    };
    let sequence = sequence_of(&assembly, &demands);
    let told = told(&assembly, &sequence.steps);
    assert_eq!(told[0], "lower comb+upper comb +z");
    assert_eq!(sequence.steps.len(), 3);
    assert_eq!(sequence.steps[1].bench, Some(0));
    // As a group, both combs leave in one step.
    let grouped = Demands {
        groups: vec![["lower comb", "upper comb"].map(str::to_owned).to_vec()],
        ..demands
    };
    assert_eq!(sequence_of(&assembly, &grouped).steps.len(), 1);
}

#[test]
fn the_rule_of_the_paper_is_stuck_where_a_search_is_not() {
    let free = |direction: Direction| Way {
        legs: vec![Leg {
            direction,
            distance_mm: 1.0,
        }],
        blockers: Vec::new(),
    };
    let behind = |direction: Direction, blocker: u32| Way {
        blockers: vec![blocker],
        ..free(direction)
    };
    let (up, aside) = (Direction::PlusZ, Direction::PlusX);
    // Up, aside, up again: a direction that the rule has used does not come back.
    let ways = vec![
        vec![free(up)],
        vec![free(up)],
        vec![behind(aside, 0)],
        vec![behind(up, 2)],
    ];
    let problem = Problem::new(ways, vec![true; 4]);
    assert_eq!(greedy(&problem, &[]).left, 1);
    let found = ordered(&problem, &[]).unwrap();
    assert_eq!(problem.first_fault(&found.order), None);
    assert_eq!(problem.cost(&found.order).changes, 2);
}

#[test]
fn a_changeover_returns_what_was_in_the_way() {
    let base = between("base", [0.0, 0.0, 0.0], [20.0, 20.0, 2.0]);
    let clamp = between("clamp", [0.0, 0.0, 6.0], [20.0, 20.0, 8.0]);
    let walls = [
        between("left", [0.0, 0.0, 2.0], [5.0, 20.0, 6.0]),
        between("right", [15.0, 0.0, 2.0], [20.0, 20.0, 6.0]),
        between("back", [5.0, 15.0, 2.0], [15.0, 20.0, 6.0]),
        between("front", [5.0, 0.0, 2.0], [15.0, 5.0, 6.0]),
    ];
    let with = |nest: Element| {
        let mut all = vec![base.clone(), clamp.clone(), nest];
        all.extend(walls.clone());
        assembled(all)
    };
    let small = with(between("small", [8.0, 8.0, 2.0], [12.0, 12.0, 4.0]));
    let large = with(between("large", [6.0, 6.0, 2.0], [14.0, 14.0, 6.0]));
    let [from, to] = [&small, &large].map(|it| Planner::new(it, Vec::new()).unwrap());
    let demands = Demands {
        stay: ["base", "left", "right", "back", "front"]
            .map(str::to_owned)
            .to_vec(),
        ..Demands::default()
    };
    let Planned::Changeover(plan) = changeover(&from, &to, &demands).unwrap() else {
        panic!("locked")
    };
    assert_eq!(
        (plan.goes, plan.comes),
        (vec!["small".to_owned()], vec!["large".to_owned()])
    );
    assert_eq!(plan.returns, ["clamp"]);
    assert_eq!(plan.stays.len(), 5);
    let (off, on) = (plan.off.unwrap(), plan.on.unwrap());
    assert_eq!(told(&small, &off.steps)[1], "small +z");
    assert_eq!(told(&large, &on.reversed())[0], "large -z");
    for (assembly, steps) in [(&small, &off.steps), (&large, &on.steps)] {
        assert!(verified(assembly, steps).unwrap().is_ok());
    }
}

#[test]
fn nothing_leaves_from_under_what_rests_on_it() {
    let assembly = assembled(vec![
        between("plate", [0.0, 0.0, 0.0], [20.0, 20.0, 2.0]),
        between("block", [5.0, 5.0, 2.0], [15.0, 15.0, 6.0]),
        between("cover", [5.0, 5.0, 6.0], [15.0, 15.0, 7.0]),
    ]);
    let sideways = Demands {
        forbidden: vec![Direction::PlusZ, Direction::MinusZ],
        ..Demands::default()
    };
    let ids = |demands: &Demands| -> Vec<String> {
        let sequence = sequence_of(&assembly, demands);
        let each = sequence.steps.iter();
        each.map(|step| assembly.id(step.elements[0]).to_owned())
            .collect()
    };
    let remove = Demands {
        remove: vec!["plate".to_owned()],
        ..sideways
    };
    assert_eq!(ids(&remove), ["plate"]);
    let supported = Demands {
        keeps_supports: true,
        ..remove
    };
    assert_eq!(ids(&supported), ["cover", "block", "plate"]);
}

#[test]
fn a_rod_and_its_cylinder_do_not_rest_on_each_other() {
    let elements = vec![
        between("cylinder", [0.0, 0.0, 0.0], [10.0, 10.0, 10.0]),
        between("rod", [5.0, 4.0, 4.0], [20.0, 6.0, 6.0]),
        between("lid", [0.0, 0.0, 10.0], [10.0, 10.0, 11.0]),
    ];
    let runs = Guided {
        a: 0,
        b: 1,
        axis: Some(0),
    };
    let assembly = Assembly::new(elements, None, Tolerance::default(), vec![runs]).unwrap();
    let demands = Demands {
        remove: vec!["cylinder".to_owned()],
        keeps_supports: true,
        ..Demands::default()
    };
    assert_eq!(
        told(&assembly, &sequence_of(&assembly, &demands).steps),
        ["lid -x", "cylinder -x"]
    );
}
