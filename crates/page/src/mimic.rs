//! The machine to scale, as SVG: the front view, and below it the view from above, with a common x axis.
//!
//! Units of the drawing are millimetres. A body that rides on actuators is a group with
//! `data-rides='[["sort_z",0,-1], ..]'`: actuator, and millimetres that the group moves to the right and down per
//! millimetre of stroke. The drawing has a part in every place that can hold one. From `view.machine` the page moves
//! the groups and shows the parts.
//!
//! Bodies are drawn back to front: the lowest first in the view from above, the farthest first in the front view.

use super::answers::{As, Svg};
use super::router::App;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use machine::view::{Mimic, MimicBody};
use maud::{Markup, html};

/// Margin around each view, mm.
const BORDER_MM: f64 = 6.0;

/// Extent of one view in its own axes, mm.
#[derive(Debug, Clone, Copy)]
struct Extent {
    low: [f64; 2],
    high: [f64; 2],
}

/// One of the two views.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Front,
    Above,
}

impl Side {
    fn name(self) -> &'static str {
        match self {
            Self::Front => "front",
            Self::Above => "above",
        }
    }

    fn polygons(self, body: &MimicBody) -> &[Vec<[f64; 2]>] {
        match self {
            Self::Front => &body.front,
            Self::Above => &body.above,
        }
    }

    /// Projects a displacement in space onto the drawing; returns its components to the right and down, mm.
    fn shift(self, [x, y, z]: [f64; 3]) -> (f64, f64) {
        match self {
            Self::Front => (x, -z),
            Self::Above => (x, -y),
        }
    }

    /// Returns how near a body is to the viewer; a nearer body has a greater value and is drawn later.
    fn nearness(self, body: &MimicBody) -> f64 {
        match self {
            // From the front (-y) the smallest y is nearest.
            Self::Front => -extent(body.above.iter().flatten()).map_or(0.0, |it| it.low[1]),
            Self::Above => extent(body.front.iter().flatten()).map_or(0.0, |it| it.high[1]),
        }
    }
}

/// `GET /mimic.svg`.
pub(super) async fn picture(State(app): App) -> As<Svg, impl IntoResponse> {
    let svg = drawing(&app.shared.mimic).into_string();
    As::new(([(CONTENT_TYPE, "image/svg+xml")], svg))
}

/// Draws both views; returns an empty drawing for a machine without bodies.
pub(super) fn drawing(mimic: &Mimic) -> Markup {
    let all = |side: Side| {
        extent(
            mimic
                .bodies
                .iter()
                .flat_map(|it| side.polygons(it))
                .flatten(),
        )
    };
    let (Some(front), Some(above)) = (all(Side::Front), all(Side::Above)) else {
        return html! { svg xmlns="http://www.w3.org/2000/svg" {} };
    };
    let left = front.low[0] - BORDER_MM;
    let width = front.high[0] - front.low[0] + 2.0 * BORDER_MM;
    let height = |it: Extent| it.high[1] - it.low[1] + 2.0 * BORDER_MM;
    let top = -front.high[1] - BORDER_MM;
    // The view from above lies this far down, below the front view.
    let down = top + height(front) + above.high[1] + BORDER_MM;
    let whole = height(front) + height(above);
    html! {
        svg xmlns="http://www.w3.org/2000/svg" role="img"
            viewBox={ (mm(left)) " " (mm(top)) " " (mm(width)) " " (mm(whole)) } {
            (view(mimic, Side::Front, 0.0))
            (view(mimic, Side::Above, down))
        }
    }
}

fn view(mimic: &Mimic, side: Side, down: f64) -> Markup {
    let mut bodies: Vec<&MimicBody> = mimic.bodies.iter().collect();
    bodies.sort_by(|a, b| side.nearness(a).total_cmp(&side.nearness(b)));
    html! {
        g class={ "view " (side.name()) } transform={ "translate(0 " (mm(down)) ")" } {
            @for body in bodies { (drawn(body, side)) }
        }
    }
}

fn drawn(body: &MimicBody, side: Side) -> Markup {
    let class = match (body.id.starts_with("part_"), body.rides.is_empty()) {
        (true, _) => "body part",
        (false, true) => "body fixed",
        (false, false) => "body moving",
    };
    html! {
        g class=(class) data-body=(body.id) data-rides=(rides(body, side)) {
            title { (body.id) }
            @for polygon in side.polygons(body) { polygon points=(points(polygon)) {} }
        }
    }
}

fn rides(body: &MimicBody, side: Side) -> String {
    let rides = body.rides.iter().map(|(actuator, way)| {
        let (right, down) = side.shift(*way);
        serde_json::json!([actuator, right, down])
    });
    serde_json::Value::Array(rides.collect()).to_string()
}

fn points(polygon: &[[f64; 2]]) -> String {
    let points: Vec<String> = polygon
        .iter()
        .map(|[x, up]| format!("{},{}", mm(*x), mm(-up)))
        .collect();
    points.join(" ")
}

/// Rounds to 0.01 mm, which is finer than a pixel.
fn mm(value: f64) -> f64 {
    // Adding zero turns a negative zero into a positive one.
    (value * 100.0).round() / 100.0 + 0.0
}

fn extent<'a>(points: impl Iterator<Item = &'a [f64; 2]>) -> Option<Extent> {
    points.fold(None, |known, point| {
        let known = known.unwrap_or(Extent {
            low: *point,
            high: *point,
        });
        Some(Extent {
            low: [known.low[0].min(point[0]), known.low[1].min(point[1])],
            high: [known.high[0].max(point[0]), known.high[1].max(point[1])],
        })
    })
}
