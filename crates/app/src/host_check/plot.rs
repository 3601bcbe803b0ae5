//! Draws the waits of both phases as an SVG picture, with the tolerated lateness. Lengths are px.

use super::phase::{Phase, PhaseResult};
use history::report::svg::Svg;
use machine::view::Bucket;

const LEFT: f64 = 70.0;
const WIDTH: f64 = 720.0;
const RIGHT: f64 = 30.0;
const TOP: f64 = 92.0;
const HEIGHT: f64 = 260.0;
const BELOW: f64 = 46.0;
/// Height of the bar of a single wait, decades; the logarithm alone would give this bar no height.
const ONE: f64 = 0.25;
const LIMIT: &str = "#a11212";

const fn colour(phase: Phase) -> &'static str {
    match phase {
        Phase::AsItIs => "#1f5f99",
        Phase::Loaded => "#e08a1e",
    }
}

/// Axes of the picture: classes of lateness to the right, number of waits upwards in decades.
struct Axes {
    classes: usize,
    decades: f64,
}

impl Axes {
    fn of(phases: &[PhaseResult], tolerated_ms: f64) -> Self {
        let all = || {
            phases
                .iter()
                .flat_map(|it| it.lateness.buckets.iter().enumerate())
        };
        let reached = |(_, it): &(usize, &Bucket)| it.count > 0 || it.up_to_ms < tolerated_ms;
        let last = all().filter(reached).map(|(at, _)| at).max().unwrap_or(0);
        let most = all().map(|(_, it)| it.count).max().unwrap_or(0);
        Self {
            // One class more than needed holds the line of the tolerated lateness.
            classes: last + 2,
            decades: (most.max(10) as f64).log10(),
        }
    }

    fn x(&self, class: f64) -> f64 {
        LEFT + WIDTH * (class / self.classes as f64).min(1.0)
    }

    fn height(&self, count: f64) -> f64 {
        HEIGHT * (count.log10() + ONE) / (self.decades + ONE)
    }
}

/// Returns the position of a lateness on the x axis, in classes from the left; each class of `edges` has twice the
/// upper edge of the class before.
fn place(edges: &[Bucket], ms: f64) -> f64 {
    let first = edges.first().map_or(1.0, |it| it.up_to_ms);
    match ms < first {
        true => ms / first,
        false => 1.0 + (ms / first).log2(),
    }
}

/// Returns the picture as an SVG file.
pub fn svg(phases: &[PhaseResult], tolerated_ms: f64) -> String {
    let axes = Axes::of(phases, tolerated_ms);
    let mut svg = Svg::new([LEFT + WIDTH + RIGHT, TOP + HEIGHT + BELOW]);
    let edges = phases.first().map_or(&[][..], |it| &it.lateness.buckets);
    scales(&mut svg, &axes, edges);
    for (at, result) in phases.iter().enumerate() {
        bars(&mut svg, &axes, at, result);
        legend(&mut svg, at, result);
    }
    let x = axes.x(place(edges, tolerated_ms));
    let dashed = format!("stroke=\"{LIMIT}\" stroke-width=\"1.5\" stroke-dasharray=\"5 3\"");
    svg.line([x, TOP], [x, TOP + HEIGHT], &dashed);
    let text = format!("tolerated {tolerated_ms:.3} ms");
    svg.text([x + 4.0, TOP + 12.0], &format!("fill=\"{LIMIT}\""), &text);
    svg.file("Lateness of this computer at the timing of the rig")
}

fn scales(svg: &mut Svg, axes: &Axes, edges: &[Bucket]) {
    let bottom = TOP + HEIGHT;
    for decade in 0..=axes.decades as i32 {
        let waits = 10f64.powi(decade);
        let y = bottom - axes.height(waits);
        svg.line([LEFT, y], [LEFT + WIDTH, y], "stroke=\"#e3e8ed\"");
        svg.text(
            [LEFT - 6.0, y + 4.0],
            "text-anchor=\"end\"",
            &format!("{waits}"),
        );
    }
    svg.text([12.0, TOP - 8.0], "", "waits");
    for (at, edge) in edges.iter().enumerate().take(axes.classes) {
        let x = axes.x(at as f64 + 1.0);
        svg.line([x, bottom], [x, bottom + 4.0], "stroke=\"#8a97a5\"");
        let middle = "text-anchor=\"middle\" font-size=\"10\"";
        svg.text([x, bottom + 17.0], middle, &format!("{:.3}", edge.up_to_ms));
    }
    svg.line([LEFT, bottom], [LEFT + WIDTH, bottom], "stroke=\"#8a97a5\"");
    let middle = "text-anchor=\"middle\"";
    svg.text(
        [LEFT + WIDTH / 2.0, bottom + 36.0],
        middle,
        "lateness up to, ms",
    );
}

fn bars(svg: &mut Svg, axes: &Axes, at: usize, result: &PhaseResult) {
    let width = (axes.x(1.0) - axes.x(0.0)) * 0.4;
    for (class, bucket) in result.lateness.buckets.iter().enumerate() {
        if bucket.count > 0 {
            let height = axes.height(bucket.count as f64);
            let left = axes.x(class as f64 + 0.1) + width * at as f64;
            let corner = [left, TOP + HEIGHT - height];
            svg.rect(corner, [width, height], colour(result.phase));
        }
    }
}

fn legend(svg: &mut Svg, at: usize, result: &PhaseResult) {
    let top = 34.0 + 18.0 * at as f64;
    svg.rect([LEFT, top], [12.0, 12.0], colour(result.phase));
    let it = &result.lateness;
    let text = format!(
        "{}: median {:.3}, p99.9 {:.3}, worst {:.3} ms",
        result.phase.name(),
        it.p50_ms,
        it.p999_ms,
        it.worst_ms
    );
    svg.text([LEFT + 18.0, top + 11.0], "", &text);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host_check::cpu_time::CpuTime;
    use machine::view::LatenessView;

    #[test]
    fn a_lateness_has_its_place_between_doubling_edges() {
        let edges = [0.064, 0.128].map(|up_to_ms| Bucket { up_to_ms, count: 0 });
        let table = [
            (0.0, 0.0),
            (0.032, 0.5),
            (0.064, 1.0),
            (0.128, 2.0),
            (2.048, 6.0),
        ];
        for (ms, expected) in table {
            assert!((place(&edges, ms) - expected).abs() < 1e-9, "{ms}");
        }
    }

    #[test]
    fn the_picture_shows_phases_and_limit() {
        let result = |phase, counts: [u64; 3]| PhaseResult {
            phase,
            lateness: LatenessView {
                worst_ms: 0.25,
                buckets: counts
                    .iter()
                    .zip([0.064, 0.128, 0.256])
                    .map(|(count, up_to_ms)| Bucket {
                        up_to_ms,
                        count: *count,
                    })
                    .collect(),
                ..LatenessView::default()
            },
            cpu_time: CpuTime::default(),
        };
        let phases = [
            result(Phase::AsItIs, [900, 1, 0]),
            result(Phase::Loaded, [800, 0, 100]),
        ];
        let svg = svg(&phases, 0.1);
        // A bar per class with waits, a square per phase in the legend, and the white ground.
        assert_eq!(svg.matches("<rect").count(), 4 + 2 + 1, "{svg}");
        assert!(svg.contains("tolerated 0.100 ms") && svg.contains("under load"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }
}
