//! Pose of a body: position in millimetres and a unit quaternion, right-handed, z up.

use super::vector::{Vec3, add, cross, dot, length, scale};

/// Position and orientation of a body in its parent frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Origin of the body, mm.
    pub position: [f64; 3],
    /// Quaternion `[w, x, y, z]`, normalised wherever it is used; a zero quaternion is a [`Flaw`](super::Flaw).
    pub rotation: [f64; 4],
}

impl Pose {
    /// Pose of the parent frame itself.
    pub const IDENTITY: Pose = Pose {
        position: [0.0; 3],
        rotation: [1.0, 0.0, 0.0, 0.0],
    };

    /// Returns an upright pose at `position` (mm).
    pub fn at(position: [f64; 3]) -> Pose {
        Pose {
            position,
            rotation: [1.0, 0.0, 0.0, 0.0],
        }
    }

    /// Returns a pose turned by `yaw_rad` about z at `position` (mm).
    pub fn yawed(position: [f64; 3], yaw_rad: f64) -> Pose {
        let (sin, cos) = (yaw_rad / 2.0).sin_cos();
        Pose {
            position,
            rotation: [cos, 0.0, 0.0, sin],
        }
    }

    /// Returns true when the rotation is the identity.
    #[inline(always)]
    pub(crate) fn is_unturned(&self) -> bool {
        let [_, x, y, z] = self.rotation;
        (x == 0.0) & (y == 0.0) & (z == 0.0)
    }

    /// Returns the same rotation at another position (mm).
    pub fn moved_to(self, position: [f64; 3]) -> Pose {
        Pose { position, ..self }
    }
}

/// Rotation as a matrix: its three columns are the images of x, y and z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    pub(crate) x: Vec3,
    pub(crate) y: Vec3,
    pub(crate) z: Vec3,
}

impl Frame {
    pub(crate) const IDENTITY: Frame = Frame {
        x: [1.0, 0.0, 0.0],
        y: [0.0, 1.0, 0.0],
        z: [0.0, 0.0, 1.0],
    };

    /// Converts a quaternion of any length but zero.
    ///
    /// Dividing by the squared length, instead of normalising first, keeps quarter turns exact:
    /// `[0.7071067811865476, 0, 0, 0.7071067811865475]` must not tilt or stretch a block.
    #[inline]
    pub(crate) fn of(rotation: [f64; 4]) -> Frame {
        let [w, x, y, z] = rotation;
        if (x == 0.0) & (y == 0.0) {
            return Yaw::of(w, z).frame();
        }
        let twice = 2.0 / (w * w + x * x + y * y + z * z);
        let (xx, yy, zz) = (x * x * twice, y * y * twice, z * z * twice);
        let (xy, xz, yz) = (x * y * twice, x * z * twice, y * z * twice);
        let (wx, wy, wz) = (w * x * twice, w * y * twice, w * z * twice);
        Frame {
            x: [1.0 - (yy + zz), xy + wz, xz - wy],
            y: [xy - wz, 1.0 - (xx + zz), yz + wx],
            z: [xz + wy, yz - wx, 1.0 - (xx + yy)],
        }
    }

    /// Returns true when z is mapped exactly onto z or -z.
    #[inline]
    pub(crate) fn is_vertical(&self) -> bool {
        self.z[0] == 0.0 && self.z[1] == 0.0 && self.z[2].abs() == 1.0
    }

    /// Returns true when the rotation is exactly about z or turns z upside down, so that upright bodies stay upright.
    #[inline]
    pub(crate) fn is_upright(&self) -> bool {
        self.is_vertical() && self.x[2] == 0.0 && self.y[2] == 0.0
    }

    /// Returns the rotation as a turn about z; `None` when it is not one.
    #[inline]
    pub(crate) fn yaw(&self) -> Option<Yaw> {
        let [cos, sin, rise] = self.x;
        let is_yaw = self.z == Frame::IDENTITY.z && (rise == 0.0) & (self.y[2] == 0.0);
        is_yaw.then_some(Yaw { cos, sin })
    }

    /// Returns true when the rotation is the identity. For frames made by [`Frame::of`] it suffices to compare x and z.
    #[inline]
    pub(crate) fn is_identity(&self) -> bool {
        self.x == Frame::IDENTITY.x && self.z == Frame::IDENTITY.z
    }

    #[inline]
    pub(crate) fn apply(&self, v: Vec3) -> Vec3 {
        add(
            add(scale(self.x, v[0]), scale(self.y, v[1])),
            scale(self.z, v[2]),
        )
    }

    pub(crate) fn then(&self, inner: &Frame) -> Frame {
        Frame {
            x: self.apply(inner.x),
            y: self.apply(inner.y),
            z: self.apply(inner.z),
        }
    }
}

/// A turn about z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Yaw {
    pub(crate) cos: f64,
    pub(crate) sin: f64,
}

impl Yaw {
    /// Converts the quaternion `[w, 0, 0, z]`.
    #[inline]
    pub(crate) fn of(w: f64, z: f64) -> Yaw {
        if z == 0.0 {
            return Yaw { cos: 1.0, sin: 0.0 };
        }
        let twice = 2.0 / (w * w + z * z);
        Yaw {
            cos: 1.0 - z * z * twice,
            sin: w * z * twice,
        }
    }

    /// Rounds to single precision, for boxes.
    #[inline(always)]
    pub(crate) fn rough(self) -> RoughYaw {
        RoughYaw {
            cos: self.cos as f32,
            sin: self.sin as f32,
        }
    }

    /// Rotates a vector in the plane.
    #[inline(always)]
    pub(crate) fn apply(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x * self.cos - y * self.sin, x * self.sin + y * self.cos]
    }

    #[inline]
    fn frame(&self) -> Frame {
        Frame {
            x: [self.cos, self.sin, 0.0],
            y: [-self.sin, self.cos, 0.0],
            z: [0.0, 0.0, 1.0],
        }
    }
}

/// A turn about z in single precision, accurate enough only for boxes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RoughYaw {
    pub(crate) cos: f32,
    pub(crate) sin: f32,
}

/// Deviation from 1 of the squared length of a quaternion up to which [`RoughYaw`] skips the division: a sixtieth of
/// the loss by rounding to single precision.
const NEARLY_UNIT: f64 = 1e-9;

impl RoughYaw {
    /// Converts the quaternion `[w, 0, 0, z]`. Nearly all quaternions have length 1 and need no division, which saves
    /// time.
    #[inline(always)]
    pub(crate) fn of(w: f64, z: f64) -> RoughYaw {
        let (ww, zz) = (w * w, z * z);
        if (ww + zz - 1.0).abs() > NEARLY_UNIT {
            return Yaw::of(w, z).rough();
        }
        RoughYaw {
            cos: (ww - zz) as f32,
            sin: (2.0 * w * z) as f32,
        }
    }
}

/// The shortest turn from one orientation to another, as an axis in the parent frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turn {
    /// Unit axis in the parent frame.
    pub(crate) axis: Vec3,
    /// Whole angle of the turn, radians, 0 to pi.
    pub(crate) angle: f64,
    start: Frame,
}

impl Turn {
    /// Returns the turn; `None` when both orientations agree (also as `q` and `-q`): the move is then a translation.
    ///
    /// Orientations agree when the angle between them is below 1e-15 rad, that is, when the quaternions are
    /// proportional but for rounding.
    pub(crate) fn between(from: [f64; 4], to: [f64; 4]) -> Option<Turn> {
        let (a, b) = (normalised(from), normalised(to));
        let (va, vb) = ([a[1], a[2], a[3]], [b[1], b[2], b[3]]);
        let w = a[0] * b[0] + dot(va, vb);
        let v = add(
            add(scale(vb, a[0]), scale(va, -b[0])),
            scale(cross(vb, va), -1.0),
        );
        let v = if w < 0.0 { scale(v, -1.0) } else { v };
        let sin = length(v);
        // The bound is two units in the last place of a normalised quaternion.
        if sin <= 4.0 * f64::EPSILON {
            return None;
        }
        Some(Turn {
            axis: scale(v, 1.0 / sin),
            angle: 2.0 * sin.atan2(w.abs()),
            start: Frame::of(from),
        })
    }

    /// Returns the orientation after the fraction `t` of the turn.
    pub(crate) fn frame_at(&self, t: f64) -> Frame {
        let (sin, cos) = (self.angle * t).sin_cos();
        Frame {
            x: rotated(self.start.x, self.axis, sin, cos),
            y: rotated(self.start.y, self.axis, sin, cos),
            z: rotated(self.start.z, self.axis, sin, cos),
        }
    }
}

fn rotated(v: Vec3, axis: Vec3, sin: f64, cos: f64) -> Vec3 {
    let across = cross(axis, v);
    let lengthwise = scale(axis, dot(axis, v) * (1.0 - cos));
    add(add(scale(v, cos), scale(across, sin)), lengthwise)
}

fn normalised(q: [f64; 4]) -> [f64; 4] {
    let norm = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
    [q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_quarter_turn_keeps_a_block_upright() {
        // A quarter turn as typical files write it: the two members differ in the last place.
        let w = std::f64::consts::FRAC_1_SQRT_2;
        let frame = Frame::of([w, 0.0, 0.0, w.next_down()]);
        assert_eq!(frame.z, [0.0, 0.0, 1.0]);
        assert!((frame.x[1] - 1.0).abs() < 1e-15 && frame.x[0].abs() < 1e-15);
    }

    #[test]
    fn a_turn_ends_at_its_end_orientation() {
        let (from, to) = ([0.9, 0.1, -0.3, 0.2], [-0.2, 0.5, 0.4, 0.7]);
        let turn = Turn::between(from, to).unwrap();
        let (reached, wanted) = (turn.frame_at(1.0), Frame::of(to));
        for (a, b) in [
            (reached.x, wanted.x),
            (reached.y, wanted.y),
            (reached.z, wanted.z),
        ] {
            assert!(length([a[0] - b[0], a[1] - b[1], a[2] - b[2]]) < 1e-14);
        }
    }

    #[test]
    fn a_rough_yaw_is_accurate_to_single_precision() {
        for step in 0..4_000 {
            let (sin, cos) = (f64::from(step) * 0.001_571).sin_cos();
            for long in [1.0, 1.0 + 4.9e-10, 1.0 - 5.1e-10, 1e-3, 7.0] {
                let (w, z) = (long * cos, long * sin);
                let (rough, yaw) = (RoughYaw::of(w, z), Yaw::of(w, z));
                // The error is at most half a unit of single precision plus the deviation of the length.
                assert!((f64::from(rough.cos) - yaw.cos).abs() < 3.1e-8, "{w} {z}");
                assert!((f64::from(rough.sin) - yaw.sin).abs() < 3.1e-8, "{w} {z}");
            }
        }
    }

    #[test]
    fn opposite_quaternions_are_no_turn() {
        assert!(Turn::between([0.6, 0.0, 0.8, 0.0], [-0.6, 0.0, -0.8, 0.0]).is_none());
    }
}
