//! The drawing of the line in README.md shows `config/scene.toml`: side view, one character for 8 mm by 8 mm.
//!
//! All actuators are at rest; a part of the default recipe lies in the pocket and one in the nest.

use std::fs;
use std::path::Path;
use toml::{Table, Value};

/// Size of a character in both directions, mm.
const CELL_MM: f64 = 8.0;
const X_MM: [f64; 2] = [-240.0, 440.0];
const Z_MM: [f64; 2] = [-24.0, 152.0];

/// Prefixes of element ids with their marks, from back to front.
const MARKS: &[(&str, char)] = &[
    ("baseplate_", '='),
    ("axis_beam", '-'),
    ("axis_post_", '|'),
    ("nest_sensor_", ':'),
    ("beam_bracket_", ':'),
    ("pocket_sensor_", ':'),
    ("chute_pass", '1'),
    ("chute_coil", '2'),
    ("chute_voltage", '3'),
    ("chute_time", '4'),
    ("chute_contact", '5'),
    ("chute_retest", '6'),
    ("pusher_", 'p'),
    ("jaw_post_", 'j'),
    ("part", 'R'),
    ("jaw_left_pad", 'J'),
    ("jaw_right_pad", 'J'),
    ("probe_", 'K'),
    ("sort_z_rod", 'Z'),
    ("axis_carriage", 'A'),
    ("gripper_palm", 'G'),
    ("finger_", 'F'),
];

/// An axis-aligned box from the side: centre and half width in x and z, mm.
struct Flat {
    id: String,
    middle: [f64; 2],
    half: [f64; 2],
}

#[test]
fn the_drawing_in_the_readme_matches_the_scene() {
    let picture = drawn(&flats());
    let readme = include_str!("../../README.md");
    assert!(
        readme.contains(&picture),
        "README.md does not hold this picture:\n\n{picture}"
    );
}

fn drawn(flats: &[Flat]) -> String {
    let columns = ((X_MM[1] - X_MM[0]) / CELL_MM) as usize;
    let rows = ((Z_MM[1] - Z_MM[0]) / CELL_MM) as usize;
    let mut cells = vec![vec![' '; columns]; rows];
    for (start, mark) in MARKS {
        for flat in flats.iter().filter(|flat| flat.id.starts_with(start)) {
            for (row, line) in cells.iter_mut().enumerate() {
                for (column, cell) in line.iter_mut().enumerate() {
                    if covers(flat, 0, X_MM[0], column) && covers(flat, 1, Z_MM[0], row) {
                        *cell = *mark;
                    }
                }
            }
        }
    }
    let lines = cells
        .iter()
        .rev()
        .map(|line| line.iter().collect::<String>().trim_end().to_owned());
    lines.collect::<Vec<_>>().join("\n")
}

/// Returns true when the centre of the cell lies in the box; a thinner box fills the cell of its centre.
fn covers(flat: &Flat, axis: usize, from: f64, cell: usize) -> bool {
    let off = from + CELL_MM * (cell as f64 + 0.5) - flat.middle[axis];
    let half = flat.half[axis].max(CELL_MM / 2.0);
    (-half..half).contains(&off)
}

fn flats() -> Vec<Flat> {
    let scene = read("config/scene.toml");
    let mut flats = Vec::new();
    for element in scene["elements"].as_array().unwrap() {
        collect(
            element["id"].as_str().unwrap(),
            element,
            [0.0; 3],
            &mut flats,
        );
    }
    let body = numbers(&read("config/recipes/jzc-22f-012.toml")["part"]["body_mm"]);
    for place in ["pocket", "nest"] {
        let rear = numbers(&scene["guard"][place]);
        let half = [body[0] / 2.0, body[2] / 2.0];
        flats.push(Flat {
            id: "part".into(),
            middle: [rear[0] + half[0], rear[2] + half[1]],
            half,
        });
    }
    flats
}

fn collect(id: &str, body: &Value, origin: [f64; 3], flats: &mut Vec<Flat>) {
    let pose = body.get("pose");
    let position = pose
        .and_then(|pose| pose.get("position"))
        .map_or([0.0; 3], numbers);
    let middle = [0, 1, 2].map(|axis| origin[axis] + position[axis]);
    let number = |key: &str| {
        body[key]
            .as_float()
            .or(body[key].as_integer().map(|whole| whole as f64))
            .unwrap()
    };
    let half = match body["kind"].as_str().unwrap() {
        "block" => numbers(&body["half"]),
        "cylinder" => [number("radius"), number("radius"), number("height") / 2.0],
        "compound" => {
            let parts = body["parts"].as_array().unwrap();
            return parts
                .iter()
                .for_each(|part| collect(id, part, middle, flats));
        }
        other => panic!("{id}: the picture cannot show a {other}"),
    };
    // The only turned body lies along x: then x and z change places.
    let turned = pose.is_some_and(|pose| pose.get("rotation").is_some());
    let half = if turned {
        [half[2], half[0]]
    } else {
        [half[0], half[2]]
    };
    flats.push(Flat {
        id: id.to_owned(),
        middle: [middle[0], middle[2]],
        half,
    });
}

fn numbers(list: &Value) -> [f64; 3] {
    let numbers: Vec<f64> = list
        .as_array()
        .unwrap()
        .iter()
        .map(|number| number.as_float().unwrap())
        .collect();
    numbers.try_into().unwrap()
}

fn read(file: &str) -> Table {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap();
    text.parse().unwrap()
}
