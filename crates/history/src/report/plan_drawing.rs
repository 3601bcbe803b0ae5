//! Draws the steps of a plan: the bodies around the moving elements from above and from the front, and the path.
//!
//! Every body is drawn once, in [`shapes`]; the picture of a step refers to the bodies by id and has a view box of its
//! own around the moving elements. Lengths are millimetres; y points down, as SVG has it. Colours are classes, so that
//! page and paper choose their own.

use crate::tooling::{PlanAction, PlanBody, PlanStep, ToolingPlan};
use std::fmt::Write;

/// Least width of what a picture shows, mm.
const LEAST_MM: f64 = 70.0;

/// Width of a picture, as a multiple of the width of the moving elements.
const AROUND: f64 = 1.7;

/// Height of a picture, as a share of its width.
const TALL: f64 = 0.62;

/// Direction from which a picture shows the bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlanView {
    /// From above: x to the right, y up.
    Above,
    /// From the front: x to the right, z up.
    Front,
}

impl PlanView {
    /// Both views.
    pub const BOTH: [Self; 2] = [Self::Above, Self::Front];

    /// Returns the word in ids and classes.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Above => "above",
            Self::Front => "front",
        }
    }

    fn polygons(self, body: &PlanBody) -> &[Vec<[f64; 2]>] {
        match self {
            Self::Above => &body.above,
            Self::Front => &body.front,
        }
    }

    /// Returns how near a body is to the viewer; nearer ones are drawn later.
    fn nearness(self, body: &PlanBody) -> f64 {
        match self {
            Self::Above => extent(&body.front).map_or(0.0, |it| it.high[1]),
            // From the front (-y) the smallest y is nearest.
            Self::Front => extent(&body.above).map_or(0.0, |it| -it.low[1]),
        }
    }

    /// Returns a direction as a vector of the drawing; `None` for a direction along the line of sight.
    fn seen(self, direction: &str) -> Option<[f64; 2]> {
        match (self, direction) {
            (_, "+x") => Some([1.0, 0.0]),
            (_, "-x") => Some([-1.0, 0.0]),
            (Self::Above, "+y") | (Self::Front, "+z") => Some([0.0, -1.0]),
            (Self::Above, "-y") | (Self::Front, "-z") => Some([0.0, 1.0]),
            _along_the_sight => None,
        }
    }

    /// Returns true for a direction towards the viewer.
    fn is_towards(self, direction: &str) -> bool {
        match self {
            Self::Above => direction == "+z",
            Self::Front => direction == "-y",
        }
    }
}

/// Bounding box in a view, mm, while y still points up.
#[derive(Debug, Clone, Copy)]
struct Extent {
    low: [f64; 2],
    high: [f64; 2],
}

fn extent(polygons: &[Vec<[f64; 2]>]) -> Option<Extent> {
    polygons
        .iter()
        .flatten()
        .fold(None, |known: Option<Extent>, at| {
            let known = known.unwrap_or(Extent {
                low: *at,
                high: *at,
            });
            Some(known.with(&Extent {
                low: *at,
                high: *at,
            }))
        })
}

impl Extent {
    fn with(self, other: &Extent) -> Extent {
        let each = [0, 1];
        Extent {
            low: each.map(|axis: usize| self.low[axis].min(other.low[axis])),
            high: each.map(|axis: usize| self.high[axis].max(other.high[axis])),
        }
    }
}

/// Returns an SVG without a size that holds every body of the plan, for the pictures in the same document.
pub fn shapes(plan: &ToolingPlan) -> String {
    let mut text = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plan_shapes\" width=\"0\" height=\"0\" aria-hidden=\"true\"><defs>",
    );
    for (scene, bodies) in plan.scenes.iter().enumerate() {
        for (number, body) in bodies.iter().enumerate() {
            for view in PlanView::BOTH {
                let _ = write!(text, "<g id=\"{}\">", id(view, scene, number));
                for polygon in view.polygons(body) {
                    let _ = write!(text, "<polygon points=\"{}\"/>", points(polygon));
                }
                text += "</g>";
            }
        }
    }
    text + "</defs></svg>"
}

fn id(view: PlanView, scene: usize, body: usize) -> String {
    format!("plan-{}-{scene}-{body}", view.word())
}

fn points(polygon: &[[f64; 2]]) -> String {
    let corners = polygon.iter();
    let corners: Vec<String> = corners
        .map(|[x, up]| format!("{},{}", mm(*x), mm(-up)))
        .collect();
    corners.join(" ")
}

/// Rounds to 0.01 mm, which is finer than a pixel.
fn mm(value: f64) -> f64 {
    // Adding zero turns a negative zero into a positive one.
    (value * 100.0).round() / 100.0 + 0.0
}

/// Returns the picture of the step with index `place` in one view. Moving elements have the class `moves`, elements
/// that hold them or along which they slide `holds`, all others in place `stands`.
pub fn picture(plan: &ToolingPlan, place: usize, view: PlanView, label: &str) -> String {
    let (step, picture) = (&plan.steps[place], &plan.pictures[place]);
    let bodies = &plan.scenes[picture.scene];
    let moving: Vec<usize> = (0..bodies.len())
        .filter(|it| step.elements.contains(&bodies[*it].id))
        .collect();
    let boxes = moving.iter();
    let boxes = boxes.filter_map(|it| extent(view.polygons(&bodies[*it])));
    let around = boxes.reduce(|all, one| all.with(&one)).unwrap_or(Extent {
        low: [0.0; 2],
        high: [0.0; 2],
    });
    let window = Window::around(&around);
    let mut text = window.open(view, label);
    for (number, class) in standing(plan, place, view) {
        let _ = write!(text, "{}", used(view, picture.scene, number, class));
    }
    for number in moving {
        let _ = write!(text, "{}", used(view, picture.scene, number, "moves"));
    }
    arrows(&mut text, step, view, &window);
    text + "</svg>"
}

/// Returns the bodies that stand during a step, each with its class, the farthest from the viewer first.
fn standing(plan: &ToolingPlan, place: usize, view: PlanView) -> Vec<(usize, &'static str)> {
    let (step, bodies) = (&plan.steps[place], &plan.scenes[plan.pictures[place].scene]);
    let holds = |id: &String| step.held_by.contains(id) || step.slides_on.contains(id);
    let class = |number: usize| match holds(&bodies[number].id) {
        true => "holds",
        false => "stands",
    };
    let standing = plan.standing(place).into_iter();
    let mut all: Vec<(usize, &str)> = standing.map(|it| (it, class(it))).collect();
    let nearness = |it: &(usize, &str)| view.nearness(&bodies[it.0]);
    all.sort_by(|a, b| nearness(a).total_cmp(&nearness(b)));
    all
}

fn used(view: PlanView, scene: usize, number: usize, class: &str) -> String {
    format!(
        "<use href=\"#{}\" class=\"{class}\"/>",
        id(view, scene, number)
    )
}

/// What a picture shows, mm, with y down.
struct Window {
    middle: [f64; 2],
    width: f64,
}

impl Window {
    fn around(moving: &Extent) -> Window {
        let size = [0, 1].map(|axis: usize| moving.high[axis] - moving.low[axis]);
        let width = (AROUND * size[0])
            .max(AROUND * size[1] / TALL)
            .max(LEAST_MM);
        Window {
            middle: [
                0.5 * (moving.low[0] + moving.high[0]),
                -0.5 * (moving.low[1] + moving.high[1]),
            ],
            width,
        }
    }

    fn open(&self, view: PlanView, label: &str) -> String {
        let height = TALL * self.width;
        let corner = [
            self.middle[0] - 0.5 * self.width,
            self.middle[1] - 0.5 * height,
        ];
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plan_picture {}\" role=\"img\" aria-label=\"{}\" \
             viewBox=\"{} {} {} {}\">",
            view.word(),
            super::svg::escaped(label),
            mm(corner[0]),
            mm(corner[1]),
            mm(self.width),
            mm(height)
        )
    }
}

/// Draws the path: an arrow per leg, or a ring with a dot (towards the viewer) or a cross (away).
fn arrows(text: &mut String, step: &PlanStep, view: PlanView, window: &Window) {
    let legs: Vec<&str> = step.legs().map(|(direction, _)| direction).collect();
    let length = 0.3 * window.width * TALL / legs.len() as f64;
    let total = legs
        .iter()
        .filter_map(|it| view.seen(it))
        .fold([0.0; 2], |sum, it| {
            [sum[0] + length * it[0], sum[1] + length * it[1]]
        });
    let mut at = match step.action {
        PlanAction::Remove => window.middle,
        // An element that is put on ends in the middle.
        PlanAction::Add => [window.middle[0] - total[0], window.middle[1] - total[1]],
    };
    let head = 0.03 * window.width;
    for direction in legs {
        match view.seen(direction) {
            Some(way) => {
                let to = [at[0] + length * way[0], at[1] + length * way[1]];
                let _ = write!(text, "{}", arrow(at, to, way, head));
                at = to;
            }
            None => {
                let _ = write!(text, "{}", sight(at, head, view.is_towards(direction)));
            }
        }
    }
}

fn arrow(from: [f64; 2], to: [f64; 2], [x, y]: [f64; 2], head: f64) -> String {
    let base = [to[0] - head * x, to[1] - head * y];
    let side = 0.6 * head;
    let corners = [
        [to[0] + head * x, to[1] + head * y],
        [base[0] - side * y, base[1] + side * x],
        [base[0] + side * y, base[1] - side * x],
    ];
    let corners = corners.map(|[x, y]| format!("{},{}", mm(x), mm(y)));
    format!(
        "<path class=\"way\" stroke-width=\"{}\" d=\"M{} {}L{} {}\"/><polygon class=\"way_end\" points=\"{}\"/>",
        mm(0.4 * head),
        mm(from[0]),
        mm(from[1]),
        mm(base[0]),
        mm(base[1]),
        corners.join(" ")
    )
}

/// Draws a leg along the line of sight.
fn sight([x, y]: [f64; 2], size: f64, is_towards: bool) -> String {
    let (x, y, size) = (mm(x), mm(y), mm(1.3 * size));
    let width = mm(0.25 * size);
    let ring = format!(
        "<circle class=\"sight\" stroke-width=\"{width}\" cx=\"{x}\" cy=\"{y}\" r=\"{size}\"/>"
    );
    if is_towards {
        let dot = mm(0.35 * size);
        return format!("{ring}<circle class=\"way_end\" cx=\"{x}\" cy=\"{y}\" r=\"{dot}\"/>");
    }
    let (a, b) = (mm(0.6 * size), mm(1.2 * size));
    format!(
        "{ring}<path class=\"way\" stroke-width=\"{width}\" d=\"M{} {}l{b} {b}m-{b} 0l{b} -{b}\"/>",
        mm(x - a),
        mm(y - a)
    )
}
