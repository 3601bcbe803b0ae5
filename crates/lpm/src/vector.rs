//! Arithmetic of three-dimensional vectors on plain arrays: lengths in millimetres, or directions without unit.

/// A point, a displacement or a direction.
pub(crate) type Vec3 = [f64; 3];

#[inline]
pub(crate) fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline]
pub(crate) fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
pub(crate) fn scale(a: Vec3, factor: f64) -> Vec3 {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

/// Returns `a + factor * b`.
#[inline]
pub(crate) fn along(a: Vec3, factor: f64, b: Vec3) -> Vec3 {
    [
        a[0] + factor * b[0],
        a[1] + factor * b[1],
        a[2] + factor * b[2],
    ]
}

#[inline]
pub(crate) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline]
pub(crate) fn length(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// Returns the sum of the magnitudes of the members: a cheap upper bound of the length.
#[inline]
pub(crate) fn reach(a: Vec3) -> f64 {
    a[0].abs() + a[1].abs() + a[2].abs()
}

/// Returns the unit vector along `a`; `None` when `a` is too short to have a direction, or not finite.
///
/// The function first scales the vector by its largest member, so that vectors as short as 1e-150 mm keep all digits of
/// direction.
#[inline]
pub(crate) fn unit(a: Vec3) -> Option<Vec3> {
    let largest = a[0].abs().max(a[1].abs()).max(a[2].abs());
    if !(largest > 1e-150 && largest < 1e150) {
        return None;
    }
    let scaled = [a[0] / largest, a[1] / largest, a[2] / largest];
    Some(scale(scaled, 1.0 / length(scaled)))
}

#[inline]
pub(crate) fn negate(a: Vec3) -> Vec3 {
    [-a[0], -a[1], -a[2]]
}
