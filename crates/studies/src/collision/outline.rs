//! Convex polygons on the baseplate, and a separating-axis test whether two of them meet.

/// A convex polygon, mm.
#[derive(Debug, Clone)]
pub struct Outline {
    corners: Vec<[f64; 2]>,
    /// Outward normal of each edge, as long as the edge, and the greatest scalar product of a corner with it.
    edges: Vec<([f64; 2], f64)>,
}

impl Outline {
    /// Creates a polygon from its corners in counter-clockwise order, mm.
    pub fn of(corners: Vec<[f64; 2]>) -> Outline {
        let next = corners.iter().cycle().skip(1);
        let edges = corners.iter().zip(next).map(|(a, b)| {
            let normal = [b[1] - a[1], a[0] - b[0]];
            (normal, normal[0] * a[0] + normal[1] * a[1])
        });
        Outline {
            edges: edges.collect(),
            corners,
        }
    }

    /// Creates a rectangle with half extents (mm) about `centre`, turned by `turn` (rad).
    pub fn rectangle(centre: [f64; 2], half: [f64; 2], turn: f64) -> Outline {
        let (sin, cos) = turn.sin_cos();
        let corner =
            |x: f64, y: f64| [centre[0] + cos * x - sin * y, centre[1] + sin * x + cos * y];
        let [x, y] = half;
        Outline::of(vec![
            corner(x, y),
            corner(-x, y),
            corner(-x, -y),
            corner(x, -y),
        ])
    }

    /// Creates a regular polygon: its corners lie on a circle of `radius` (mm), the first at the angle `first` (rad).
    pub fn regular(centre: [f64; 2], radius: f64, corners: usize, first: f64) -> Outline {
        let corner = |number: usize| {
            let angle = first + std::f64::consts::TAU * number as f64 / corners as f64;
            let (sin, cos) = angle.sin_cos();
            [centre[0] + radius * cos, centre[1] + radius * sin]
        };
        Outline::of((0..corners).map(corner).collect())
    }

    /// Returns lowest and highest coordinates, mm.
    pub fn bounds(&self) -> ([f64; 2], [f64; 2]) {
        let start = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        self.corners.iter().fold(start, |(low, high), corner| {
            (
                [low[0].min(corner[0]), low[1].min(corner[1])],
                [high[0].max(corner[0]), high[1].max(corner[1])],
            )
        })
    }

    /// Returns whether this polygon meets `other` displaced by `shift` (mm); touching counts.
    pub fn meets(&self, other: &Outline, shift: [f64; 2]) -> bool {
        let back = [-shift[0], -shift[1]];
        !self.separates(other, shift) && !other.separates(self, back)
    }

    fn separates(&self, other: &Outline, shift: [f64; 2]) -> bool {
        self.edges.iter().any(|([nx, ny], reach)| {
            let limit = reach - nx * shift[0] - ny * shift[1];
            other.corners.iter().all(|[x, y]| nx * x + ny * y > limit)
        })
    }
}
