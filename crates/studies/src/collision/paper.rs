//! The method of the paper, rebuilt: poses are checked one after the other, nothing between them.
//!
//! Our own reading of what is known of it. Layers between the bottoms and tops of the elements hold
//! a square grid of element numbers each; a pose goes through them in the paper's order: layers,
//! silhouettes on x and y, oriented boxes, polygons. The box of a cylinder is a box. The polygons
//! are the outlines as a display draws them: a cylinder has [`CORNERS`] corners on its mantle, the first one
//! anywhere. Every
//! body stands upright here, so an outline and a height say everything and the polygon test has no
//! error of its own. What the authors laid out differently is not known.

use super::outline::Outline;
use super::world::{UNIT_MM, Way};
use lpm::exact::{Body, Form};

/// Corners of a drawn cylinder.
const CORNERS: usize = 32;
/// Pitch of the grid of a layer, mm.
const PITCH_MM: f64 = 64.0;

/// A body with everything that was worked out beforehand, mm.
#[derive(Debug)]
struct Prepared {
    low: [f64; 3],
    high: [f64; 3],
    oriented_box: Outline,
    polygon: Outline,
}

/// A layer: height and grid of element numbers.
#[derive(Debug)]
struct Layer {
    from: f64,
    to: f64,
    cells: Vec<Vec<u32>>,
}

/// The model of the paper over one scene, and a mover.
#[derive(Debug)]
pub struct Stepping {
    elements: Vec<Prepared>,
    layers: Vec<Layer>,
    columns: usize,
    parts: Vec<Prepared>,
    /// Question at which each element was looked at last: it may stand in several layers and cells.
    asked: Vec<u64>,
    /// Parts times poses so far.
    questions: u64,
}

impl Stepping {
    /// Works the scene out.
    pub fn new(elements: &[Body], parts: &[Body]) -> Stepping {
        let elements: Vec<Prepared> = numbered(elements);
        let extent = elements
            .iter()
            .fold(0.0_f64, |most, it| most.max(it.high[0]).max(it.high[1]));
        let columns = (extent / PITCH_MM) as usize + 1;
        Stepping {
            layers: layers(&elements, columns),
            columns,
            parts: numbered(parts),
            asked: vec![0; elements.len()],
            questions: 0,
            elements,
        }
    }

    /// Last clear pose before the first pose that collides, as a fraction of the move.
    pub fn first_contact(&mut self, way: &Way, step_mm: f64) -> Option<f64> {
        let poses = (way.length_mm() / step_mm).ceil().max(1.0);
        let from = way.from.map(|it| it as f64 * UNIT_MM);
        let run = way.run.map(|it| it as f64 * UNIT_MM);
        for pose in 0..=poses as u64 {
            let t = pose as f64 / poses;
            if self.collides([0, 1, 2].map(|axis| from[axis] + t * run[axis])) {
                return Some((pose as f64 - 1.0).max(0.0) / poses);
            }
        }
        None
    }

    fn collides(&mut self, at: [f64; 3]) -> bool {
        let mut asked = std::mem::take(&mut self.asked);
        let mut question = self.questions;
        let found = self.parts.iter().any(|part| {
            question += 1;
            let low = [0, 1, 2].map(|axis| part.low[axis] + at[axis]);
            let high = [0, 1, 2].map(|axis| part.high[axis] + at[axis]);
            self.numbers(low, high).any(|number| {
                let (element, last) = (&self.elements[number], &mut asked[number]);
                std::mem::replace(last, question) != question
                    && element.meets_silhouette(low, high)
                    && element.meets(part, [at[0], at[1]])
            })
        });
        (self.asked, self.questions) = (asked, question);
        found
    }

    /// Elements of the layers and cells that the box reaches; some more than once.
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

fn numbered(bodies: &[Body]) -> Vec<Prepared> {
    // Golden angle: the first corners lie anywhere, no direction is preferred.
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

/// Layers between any two neighbouring bottoms or tops.
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
