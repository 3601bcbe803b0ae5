//! Scenes of many elements: rows that a removal touches, symmetry, orders without a fault.
use super::*;

/// A block of cubes of 4 mm, each in contact with its neighbours, with some left out and some twice as tall.
fn wall(count: usize) -> Vec<Element> {
    let side = (count as f64).cbrt().ceil() as usize;
    let places = (0..side * side * side).filter(|at| at % 7 != 3);
    let cube = |at: usize| {
        let cell = [at % side, at / side % side, at / (side * side)];
        let low = cell.map(|it| 4.0 * it as f64);
        let shorter = if at.is_multiple_of(5) { 1.0 } else { 0.0 };
        between(
            &format!("e{at}"),
            low,
            [low[0] + 4.0, low[1] + 4.0 - shorter, low[2] + 4.0],
        )
    };
    places.take(count).map(cube).collect()
}

#[test]
fn six_sweeps_agree_with_three_and_their_mirror() {
    let assembly = assembled(wall(60));
    let table = Interference::swept(&assembly).unwrap();
    for number in 0..assembly.len() {
        for direction in Direction::ALL {
            let distance_mm = assembly.distance_out_mm(assembly.extent(number), direction);
            let way = direction.displacement(distance_mm);
            let met = assembly.met(number, [0.0; 3], way).unwrap();
            assert_eq!(
                table.blockers(number, direction),
                met,
                "{number} {direction}"
            );
        }
    }
}

#[test]
fn a_removal_touches_only_the_rows_it_is_in() {
    let assembly = assembled(wall(100));
    let table = Interference::swept(&assembly).unwrap();
    let rows = |unit: usize| {
        let all =
            (0..assembly.len()).flat_map(|it| Direction::ALL.map(|way| table.blockers(it, way)));
        all.filter(|row| row.contains(&(unit as u32))).count()
    };
    let way = |number: usize, direction| Way {
        legs: vec![Leg {
            direction,
            distance_mm: 1.0,
        }],
        blockers: table.blockers(number, direction).to_vec(),
    };
    let ways = (0..assembly.len()).map(|it| Direction::ALL.map(|one| way(it, one)).to_vec());
    let problem = Problem::new(ways.collect(), vec![true; assembly.len()]);
    let mut remaining = Remaining::all(&problem);
    let mut touched = 0;
    for unit in [99, 50, 3] {
        remaining.remove(unit, |_| {});
        touched += rows(unit);
        assert_eq!(remaining.touched(), touched);
        assert!(touched < 6 * assembly.len());
    }
}

#[test]
fn many_elements_come_apart_in_a_verified_order() {
    let assembly = assembled(wall(150));
    let demands = Demands {
        forbidden: vec![Direction::MinusZ],
        ..Demands::default()
    };
    let sequence = sequence_of(&assembly, &demands);
    assert_eq!(sequence.steps.len(), 150);
    assert_eq!(sequence.cost().changes, 0);
}
