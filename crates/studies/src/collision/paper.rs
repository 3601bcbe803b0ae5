//! The method of the paper (layer-based projection model of Peng and others, 2010), rebuilt from its published part: it
//! checks single poses along a move, and not the motion between them.
//!
//! The heights between neighbouring bottoms and tops of the elements are layers; each layer holds a square grid of
//! element numbers. A pose passes the tests in the paper's order: layers, silhouettes on x and y, oriented boxes,
//! polygons. The polygons are the outlines as a display draws them: a cylinder has [`CORNERS`] corners on its lateral
//! surface, at an arbitrary rotation. Every body is upright, so that an outline and a height describe it and the
//! polygon test adds no error. Details may differ from the authors' own program.

use super::outline::Outline;
use super::world::{TestMove, UNIT_MM};
use lpm::exact::{Body, Form};

/// Number of corners of the polygon of a cylinder.
const CORNERS: usize = 32;
/// Pitch of the grid of a layer, mm.
const PITCH_MM: f64 = 64.0;

/// A body with its precomputed bounds and outlines, mm.
#[derive(Debug)]
struct Prepared {
    low: [f64; 3],
    high: [f64; 3],
    oriented_box: Outline,
    polygon: Outline,
}

/// A layer: range of heights, mm, and grid of element numbers.
#[derive(Debug)]
struct Layer {
    from: f64,
    to: f64,
    cells: Vec<Vec<u32>>,
}

/// The paper's method, which steps a mover through one scene.
#[derive(Debug)]
pub struct Stepping {
    elements: Vec<Prepared>,
    layers: Vec<Layer>,
    columns: usize,
    parts: Vec<Prepared>,
    /// For each element, the last query that tested it: although several cells hold an element, a query tests it only
    /// once.
    tested: Vec<u64>,
    /// Number of queries so far; each is one part at one pose.
    queries: u64,
}

impl Stepping {
    /// Prepares scene and mover.
    pub fn new(elements: &[Body], parts: &[Body]) -> Stepping {
        let elements: Vec<Prepared> = prepared_bodies(elements);
        let extent = elements
            .iter()
            .fold(0.0_f64, |most, it| most.max(it.high[0]).max(it.high[1]));
        let columns = (extent / PITCH_MM) as usize + 1;
        Stepping {
            layers: layers(&elements, columns),
            columns,
            parts: prepared_bodies(parts),
            tested: vec![0; elements.len()],
            queries: 0,
            elements,
        }
    }

    /// Returns the last pose before the first colliding one, as a fraction of the move; `None` when no pose collides.
    pub fn first_contact(&mut self, test_move: &TestMove, step_mm: f64) -> Option<f64> {
        let poses = (test_move.length_mm() / step_mm).ceil().max(1.0);
        let from = test_move.from.map(|it| it as f64 * UNIT_MM);
        let run = test_move.run.map(|it| it as f64 * UNIT_MM);
        for pose in 0..=poses as u64 {
            let t = pose as f64 / poses;
            if self.collides([0, 1, 2].map(|axis| from[axis] + t * run[axis])) {
                return Some((pose as f64 - 1.0).max(0.0) / poses);
            }
        }
        None
    }

    fn collides(&mut self, at: [f64; 3]) -> bool {
        let mut tested = std::mem::take(&mut self.tested);
        let mut query = self.queries;
        let found = self.parts.iter().any(|part| {
            query += 1;
            let low = [0, 1, 2].map(|axis| part.low[axis] + at[axis]);
            let high = [0, 1, 2].map(|axis| part.high[axis] + at[axis]);
            self.numbers(low, high).any(|number| {
                let (element, last) = (&self.elements[number], &mut tested[number]);
                std::mem::replace(last, query) != query
                    && element.meets_silhouette(low, high)
                    && element.meets(part, [at[0], at[1]])
            })
        });
        (self.tested, self.queries) = (tested, query);
        found
    }

    /// Returns the numbers of the elements in the layers and cells that the box from `low` to `high` reaches; a number
    /// may repeat.
    fn numbers(&self, low: [f64; 3], high: [f64; 3]) -> impl Iterator<Item = usize> + '_ {
        let cell = |place: f64| ((place / PITCH_MM).max(0.0) as usize).min(self.columns - 1);
        let (xs, ys) = (cell(low[0])..=cell(high[0]), cell(low[1])..=cell(high[1]));
        let first = self.layers.partition_point(|layer| layer.to < low[2]);
        let reached = self.layers[first..]
            .iter()
            .take_while(move |layer| layer.from <= high[2]);
        let columns = self.columns;
        reached.flat_map(move |layer| {
            let xs = xs.clone();
            let cells = ys
                .clone()
                .flat_map(move |y| xs.clone().map(move |x| y * columns + x));
            cells.flat_map(|cell| layer.cells[cell].iter().map(|number| *number as usize))
        })
    }
}

impl Prepared {
    fn meets_silhouette(&self, low: [f64; 3], high: [f64; 3]) -> bool {
        (0..3).all(|axis| self.low[axis] <= high[axis] && low[axis] <= self.high[axis])
    }

    fn meets(&self, part: &Prepared, shift: [f64; 2]) -> bool {
        self.oriented_box.meets(&part.oriented_box, shift)
            && self.polygon.meets(&part.polygon, shift)
    }
}

fn prepared_bodies(bodies: &[Body]) -> Vec<Prepared> {
    // The golden angle gives every cylinder another rotation, so that no direction of the first corner prevails.
    let angle = |number: usize| 2.399_963 * number as f64;
    let each = bodies.iter().enumerate();
    each.map(|(number, body)| prepared(body, angle(number)))
        .collect()
}

fn prepared(body: &Body, first_corner: f64) -> Prepared {
    let [x, y, z] = body.centre.map(|it| it as f64 * UNIT_MM);
    let mm = |units: i64| units as f64 * UNIT_MM;
    let (polygon, oriented_box, half_height) = match body.form {
        Form::Block { half, rotation } => {
            let (w, z) = (rotation[0] as f64, rotation[3] as f64);
            let turn = 2.0 * z.atan2(w);
            let outline = Outline::rectangle([x, y], [mm(half[0]), mm(half[1])], turn);
            (outline.clone(), outline, mm(half[2]))
        }
        Form::Cylinder { radius, half } => {
            let radius = mm(radius);
            let around = Outline::rectangle([x, y], [radius; 2], 0.0);
            (
                Outline::regular([x, y], radius, CORNERS, first_corner),
                around,
                mm(half),
            )
        }
        Form::Triangle(corners) => {
            let flat = corners.map(|[a, b, _]| [x + mm(a), y + mm(b)]);
            let outline = Outline::of(flat.to_vec());
            (outline.clone(), outline, 0.0)
        }
    };
    let (low, high) = oriented_box.bounds();
    Prepared {
        low: [low[0], low[1], z - half_height],
        high: [high[0], high[1], z + half_height],
        oriented_box,
        polygon,
    }
}

/// Builds the layers between neighbouring bottoms or tops.
fn layers(elements: &[Prepared], columns: usize) -> Vec<Layer> {
    let mut heights: Vec<f64> = elements
        .iter()
        .flat_map(|it| [it.low[2], it.high[2]])
        .collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    let mut layers: Vec<Layer> = heights
        .windows(2)
        .map(|ends| Layer {
            from: ends[0],
            to: ends[1],
            cells: vec![Vec::new(); columns * columns],
        })
        .collect();
    let cell = |place: f64| ((place / PITCH_MM).max(0.0) as usize).min(columns - 1);
    for (number, element) in (0..).zip(elements) {
        let reached =
            |layer: &&mut Layer| layer.from < element.high[2] && element.low[2] < layer.to;
        for layer in layers.iter_mut().filter(reached) {
            for y in cell(element.low[1])..=cell(element.high[1]) {
                for x in cell(element.low[0])..=cell(element.high[0]) {
                    layer.cells[y * columns + x].push(number);
                }
            }
        }
    }
    layers
}
