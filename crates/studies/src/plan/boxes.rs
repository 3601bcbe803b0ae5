//! Counts how often extruded boxes block what exact sweeps prove free.

use crate::figure::{Figure, percent};
use app::planning::PlanScene;
use config::{Folder, SCENE};
use lpm::{Mesh, Pose, Shape};
use plan::fixture::Dice;
use plan::{Assembly, Direction, Element, Interference, PlanError, Tolerance};

/// Number of scenes with shafts, and of scenes with bevels.
const SCENES: u64 = 100;

/// Numbers of cases in which an element, the blocker, keeps another element from leaving in a direction.
#[derive(Default)]
struct Blocks {
    /// Cases that the boxes of the elements show.
    boxes: u64,
    /// Cases that boxes show and the true bodies do not.
    wrong: u64,
    /// Cases that the true bodies show and boxes do not.
    missed: u64,
    /// Those of `wrong` in which the element leaves along z, the one axis on which the scene leaves an element free.
    along: u64,
}

impl Blocks {
    fn add(&mut self, assembly: &Assembly) -> Result<(), PlanError> {
        let (swept, boxes) = (
            Interference::swept(assembly)?,
            Interference::extruded(assembly),
        );
        for number in 0..assembly.len() {
            for direction in Direction::ALL {
                let [exact, by_box] = [&swept, &boxes].map(|it| it.blockers(number, direction));
                let wrong = by_box.iter().filter(|it| !exact.contains(it)).count() as u64;
                self.boxes += by_box.len() as u64;
                self.wrong += wrong;
                self.missed += exact.iter().filter(|it| !by_box.contains(it)).count() as u64;
                self.along += wrong * u64::from(direction.axis() == 2);
            }
        }
        Ok(())
    }

    fn figures(&self, of: &str) -> [Figure; 2] {
        let name = format!("false blocks of boxes, {of}");
        let share = percent(self.wrong, self.boxes);
        [
            Figure::new(name, self.boxes, share, "%")
                .with("false", Some(self.wrong as f64))
                .with("false along z", Some(self.along as f64)),
            Figure::none(
                format!("blocks that boxes miss, {of}"),
                self.boxes,
                self.missed,
            ),
        ]
    }
}

pub(super) fn figures(config: &Folder) -> anyhow::Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for (name, scene) in [
        ("shafts in holes", shafts as fn(&mut Dice) -> Vec<Element>),
        ("bevels", bevels),
    ] {
        let mut blocks = Blocks::default();
        for seed in 0..SCENES {
            let elements = scene(&mut Dice::new(seed));
            let made = Assembly::new(elements, None, Tolerance::default(), Vec::new())?;
            blocks.add(&made)?;
        }
        figures.extend(blocks.figures(name));
    }
    let mut blocks = Blocks::default();
    blocks.add(&PlanScene::of_folder(config, SCENE, None)?.assembly)?;
    figures.extend(blocks.figures("default fixture"));
    // Groups the figures with equal columns.
    figures.sort_by_key(|it| it.bar.is_some());
    Ok(figures)
}

fn element(id: String, shape: Shape, position: [f64; 3]) -> Element {
    Element {
        id,
        shape,
        pose: Pose::at(position),
    }
}

/// Draws a stack of plates, each with a square hole, and a shaft through all of them with a clearance of 0 to 0.1 mm.
fn shafts(dice: &mut Dice) -> Vec<Element> {
    let radius = dice.between(2.0, 8.0);
    let mut elements = Vec::new();
    let mut low = 0.0;
    for plate in 0..3 {
        let (half, tall) = (radius + dice.between(4.0, 12.0), dice.between(2.0, 8.0));
        let hole = radius + dice.between(0.0, 0.1);
        elements.push(element(
            format!("plate{plate}"),
            holed(half, hole, tall),
            [0.0, 0.0, low + 0.5 * tall],
        ));
        low += tall;
    }
    let shaft = Shape::Cylinder {
        radius,
        height: low,
    };
    elements.push(element("shaft".into(), shaft, [0.0, 0.0, 0.5 * low]));
    elements
}

fn holed(half: f64, hole: f64, tall: f64) -> Shape {
    let (bar, middle) = (0.5 * (half - hole), 0.5 * (half + hole));
    let block = |half: [f64; 3]| Shape::Block { half };
    let along_x = block([half, bar, 0.5 * tall]);
    let along_y = block([bar, hole, 0.5 * tall]);
    Shape::Compound(vec![
        (Pose::at([0.0, middle, 0.0]), along_x.clone()),
        (Pose::at([0.0, -middle, 0.0]), along_x),
        (Pose::at([middle, 0.0, 0.0]), along_y.clone()),
        (Pose::at([-middle, 0.0, 0.0]), along_y),
    ])
}

/// Draws two wedges whose slanted faces are in contact.
fn bevels(dice: &mut Dice) -> Vec<Element> {
    let [wide, deep, tall] = [0, 1, 2].map(|_| dice.between(4.0, 20.0));
    let lower = wedge([[0.0, 0.0], [wide, 0.0], [0.0, tall]], deep);
    let upper = wedge([[wide, tall], [0.0, tall], [wide, 0.0]], deep);
    vec![
        element("lower".into(), lower, [0.0; 3]),
        element("upper".into(), upper, [0.0; 3]),
    ]
}

/// Makes a prism over a triangle in x and z, `deep` along y.
fn wedge(corners: [[f64; 2]; 3], deep: f64) -> Shape {
    let side = |y: f64| corners.map(|[x, z]| [x, y, z]);
    Shape::Mesh(Mesh {
        vertices: [side(0.0), side(deep)].concat(),
        triangles: vec![
            [0, 1, 3],
            [1, 4, 3],
            [1, 2, 4],
            [2, 5, 4],
            [2, 0, 5],
            [0, 3, 5],
            [0, 2, 1],
            [3, 4, 5],
        ],
    })
}
