//! The four-part example: a base with a hole, a shaft in it, a plate with a hole around the shaft, a cap on the shaft.
//!
//! The paper shows tables for an assembly of four parts, but its text does not give the entries. The tables here are of
//! the same kinds, for the parts named above.
use super::*;

fn parts() -> Assembly {
    let shaft = Shape::Cylinder {
        radius: 5.0,
        height: 30.0,
    };
    assembled(vec![
        holed("1", 20.0, 5.0, 0.0, 10.0),
        element("2", shaft, [0.0, 0.0, 15.0]),
        holed("3", 15.0, 5.0, 10.0, 16.0),
        between("4", [-10.0, -10.0, 30.0], [10.0, 10.0, 34.0]),
    ])
}

/// Writes a table as the paper does: a row per part, a column per direction, `#` for nothing.
fn written(assembly: &Assembly, table: &Interference) -> Vec<String> {
    let row = |number: usize| {
        let cells = Direction::ALL.map(|direction| {
            let row = table.blockers(number, direction).iter();
            let ids: Vec<&str> = row.map(|it| assembly.id(*it as usize)).collect();
            if ids.is_empty() {
                "#".to_owned()
            } else {
                ids.join(",")
            }
        });
        format!("{}: {}", assembly.id(number), cells.join(" "))
    };
    (0..assembly.len()).map(row).collect()
}

#[test]
fn the_global_table_names_blockers_in_six_directions() {
    let parts = parts();
    let table = Interference::swept(&parts).unwrap();
    assert_eq!(
        written(&parts, &table),
        [
            "1: 2 2 2 2 3,4 #",
            "2: 1,3 1,3 1,3 1,3 4 #",
            "3: 2 2 2 2 4 1",
            "4: # # # # # 1,2,3",
        ]
    );
}

#[test]
fn boxes_block_the_shaft_that_a_sweep_frees() {
    let parts = parts();
    let table = Interference::extruded(&parts);
    assert_eq!(
        written(&parts, &table),
        [
            "1: 2 2 2 2 2,3,4 2",
            "2: 1,3 1,3 1,3 1,3 1,3,4 1,3",
            "3: 2 2 2 2 2,4 1,2",
            "4: # # # # # 1,2,3",
        ]
    );
    // The remedy of the paper: along the common axis a mated pair does not count.
    let local = Interference::local(&parts).unwrap();
    let mates = mates(&parts, &local).unwrap();
    let is_free = |a: usize, b: usize, direction: Direction| {
        let axis = Kind::Axis {
            axis: direction.axis(),
        };
        let pair = (a.min(b), a.max(b));
        mates
            .iter()
            .any(|it| (it.a, it.b) == pair && it.kind == axis)
    };
    let swept = Interference::swept(&parts).unwrap();
    assert_eq!(table.without(is_free), swept);
}

#[test]
fn the_local_table_names_what_holds_each_part() {
    let parts = parts();
    let local = Interference::local(&parts).unwrap();
    assert_eq!(
        written(&parts, &local),
        [
            "1: 2 2 2 2 3 #",
            "2: 1,3 1,3 1,3 1,3 4 #",
            "3: 2 2 2 2 # 1",
            "4: # # # # # 2",
        ]
    );
}

#[test]
fn the_table_of_mates_has_all_three_kinds() {
    let parts = parts();
    let local = Interference::local(&parts).unwrap();
    let found = mates(&parts, &local).unwrap();
    let named = |mate: &Mate| {
        let kind = match mate.kind {
            Kind::Plane { normal } => format!("plane {:.0?}", normal),
            Kind::Align { side } => format!("align {side}"),
            Kind::Axis { axis } => format!("axis {axis}"),
        };
        format!("{}-{} {kind}", parts.id(mate.a), parts.id(mate.b))
    };
    let named: Vec<String> = found.iter().map(named).collect();
    assert_eq!(
        named,
        [
            "1-2 axis 2",
            "1-2 align -z",
            "1-3 plane [0, 0, 1]",
            "2-3 axis 2",
            "2-4 plane [0, 0, 1]",
        ]
    );
    assert_eq!(priority(&found), [Direction::PlusZ, Direction::MinusZ]);
    assert!(checked(&parts, &found, (1, 0), MateWanted::Axis).is_ok());
    assert!(checked(&parts, &found, (0, 3), MateWanted::Plane).is_err());
}

#[test]
fn the_rule_of_the_paper_takes_the_parts_upward() {
    let parts = parts();
    let demands = Demands {
        forbidden: vec![Direction::MinusZ],
        ..Demands::default()
    };
    let planner = Planner::new(&parts, vec![Direction::PlusZ, Direction::MinusZ]).unwrap();
    let Outcome::Sequence(sequence) = planner.disassembly(&demands).unwrap() else {
        panic!("locked")
    };
    assert_eq!(
        told(&parts, &sequence.steps),
        ["4 +z", "2 +z", "3 +z", "1 +z"]
    );
    assert_eq!(sequence.method, Method::Greedy);
    let back = sequence.reversed();
    assert_eq!(told(&parts, &back), ["1 -z", "3 -z", "2 -z", "4 -z"]);
    let clear = verified(&parts, &sequence.steps).unwrap().unwrap();
    assert_eq!(clear[1].slides_on, [0, 2]);
    assert_eq!(clear[1].clearance_mm, Some(0.0));
}

#[test]
fn a_search_finds_the_shorter_way_down() {
    let parts = parts();
    let sequence = sequence_of(&parts, &Demands::default());
    assert_eq!(
        told(&parts, &sequence.steps),
        ["2 -z", "1 -z", "3 -z", "4 -z"]
    );
    let cost = sequence.cost();
    assert_eq!(cost.changes, 0);
    assert!((cost.length_mm - 90.0).abs() < 1e-6, "{cost:?}");
    assert_eq!(sequence.method, Method::Search);
}
