//! Mates: faces and axes by which two elements fit each other.
//!
//! Three kinds, as in the paper: plane on plane (normals against each other), aligned planes (normals alike), and a
//! common axis. The library finds mates in the geometry within [`Tolerance::mate_mm`](crate::Tolerance), or checks
//! given mates against it. Plane and axis mates appear in the local table by themselves, since the bodies block each
//! other there; aligned planes hold nothing, and only say where an element belongs. The axes of common-axis mates are
//! the priority directions of the paper.

use crate::assembly::{Assembly, modelled};
use crate::direction::Direction;
use crate::error::PlanError;
use crate::extent::own_z;
use crate::table::Interference;
use lpm::{Answer, Model, Move, Pose, Shape};

/// Normals whose members differ by less are one.
const SAME_NORMAL: f64 = 1e-6;

/// Kind of a mate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// A plane of one element lies on a plane of the other one.
    Plane {
        /// Unit normal from the first element to the second one.
        normal: [f64; 3],
    },
    /// Planes of both elements lie in one plane and face the same side; found for sides of their boxes.
    Align {
        /// The side that both planes face.
        side: Direction,
    },
    /// A cylinder of one element and a hole of the other one have a common axis; found for axes of the frame.
    Axis {
        /// The axis: 0 is x, 1 is y, 2 is z.
        axis: usize,
    },
}

/// Two elements that fit each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mate {
    /// Number of the first element, the lower one.
    pub a: usize,
    /// Number of the second element.
    pub b: usize,
    /// Kind of the mate.
    pub kind: Kind,
}

/// Name of a kind of mate, as a scene gives it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MateWanted {
    /// Plane on plane.
    Plane,
    /// Aligned planes.
    Align,
    /// Common axis.
    Axis,
}

impl Kind {
    /// Returns the name under which a scene gives this kind.
    pub fn wanted(self) -> MateWanted {
        match self {
            Kind::Plane { .. } => MateWanted::Plane,
            Kind::Align { .. } => MateWanted::Align,
            Kind::Axis { .. } => MateWanted::Axis,
        }
    }
}

/// Finds all mates from the geometry; `local` is the local table of the assembly.
///
/// # Errors
/// Fails on a body that the collision core refuses.
pub fn mates(assembly: &Assembly, local: &Interference) -> Result<Vec<Mate>, PlanError> {
    let mut found = Vec::new();
    for a in 0..assembly.len() {
        let mut partners: Vec<u32> = Direction::ALL
            .into_iter()
            .flat_map(|direction| local.blockers(a, direction).iter().copied())
            .filter(|b| *b as usize > a)
            .collect();
        partners.sort_unstable();
        partners.dedup();
        for b in partners {
            let b = b as usize;
            found.extend(of_pair(assembly, local, a, b)?);
        }
    }
    Ok(found)
}

/// Returns the priority directions: both directions of the axis of each common-axis mate, the most frequent axis first.
pub fn priority(mates: &[Mate]) -> Vec<Direction> {
    let count = |axis: usize| {
        let of_axis = |mate: &&Mate| mate.kind == Kind::Axis { axis };
        mates.iter().filter(of_axis).count()
    };
    let mut axes: Vec<usize> = (0..3).filter(|axis| count(*axis) > 0).collect();
    axes.sort_by_key(|axis| std::cmp::Reverse(count(*axis)));
    let both = |axis: usize| [Direction::ALL[2 * axis], Direction::ALL[2 * axis + 1]];
    axes.into_iter().flat_map(both).collect()
}

/// Checks a given mate against the mates found in the geometry.
///
/// # Errors
/// Fails when the elements have no mate of this kind within the tolerance of the assembly.
pub fn checked(
    assembly: &Assembly,
    found: &[Mate],
    (a, b): (usize, usize),
    wanted: MateWanted,
) -> Result<Mate, PlanError> {
    let is_pair = |it: &&Mate| (it.a, it.b) == (a.min(b), a.max(b));
    let of_pair: Vec<&Mate> = found.iter().filter(is_pair).collect();
    if let Some(mate) = of_pair.iter().find(|it| it.kind.wanted() == wanted) {
        return Ok(**mate);
    }
    let kinds: Vec<&str> = of_pair.iter().map(|it| it.kind.wanted().name()).collect();
    Err(PlanError::Mate {
        a: assembly.id(a).to_owned(),
        b: assembly.id(b).to_owned(),
        found: if kinds.is_empty() {
            format!("no contact within {} mm", assembly.tolerance().mate_mm)
        } else {
            kinds.join(", ")
        },
        expected: wanted.name(),
    })
}

impl MateWanted {
    /// Returns the name in scene files: `plane`, `align` or `axis`.
    pub fn name(self) -> &'static str {
        match self {
            MateWanted::Plane => "plane",
            MateWanted::Align => "align",
            MateWanted::Axis => "axis",
        }
    }
}

fn of_pair(
    assembly: &Assembly,
    local: &Interference,
    a: usize,
    b: usize,
) -> Result<Vec<Mate>, PlanError> {
    let is_blocked = |direction: Direction| {
        let row = local.blockers(a, direction);
        row.binary_search(&(b as u32)).is_ok()
    };
    let blocked: Vec<Direction> = Direction::ALL
        .into_iter()
        .filter(|it| is_blocked(*it))
        .collect();
    let axis = (0..3).find(|axis| {
        let across = blocked.iter().filter(|it| it.axis() != *axis).count();
        let along = blocked.len() - across;
        across == 4 && along < 2 && (has_axis(assembly, a, *axis) || has_axis(assembly, b, *axis))
    });
    let mut kinds: Vec<Kind> = axis.map(|axis| Kind::Axis { axis }).into_iter().collect();
    let planes = blocked
        .into_iter()
        .filter(|it| axis.is_none_or(|axis| axis == it.axis()));
    for direction in planes {
        let Some(normal) = normal(assembly, a, b, direction)? else {
            continue;
        };
        let is_same = |kind: &Kind| match kind {
            Kind::Plane { normal: known } => {
                (0..3).all(|at| (known[at] - normal[at]).abs() < SAME_NORMAL)
            }
            Kind::Align { .. } | Kind::Axis { .. } => false,
        };
        if !kinds.iter().any(is_same) {
            kinds.push(Kind::Plane { normal });
        }
    }
    let within_mm = assembly.tolerance().mate_mm;
    for side in Direction::ALL {
        let reach = |number: usize| {
            let extent = assembly.extent(number);
            if side.sign() > 0.0 {
                extent.high[side.axis()]
            } else {
                extent.low[side.axis()]
            }
        };
        if (reach(a) - reach(b)).abs() <= within_mm {
            kinds.push(Kind::Align { side });
        }
    }
    Ok(kinds.into_iter().map(|kind| Mate { a, b, kind }).collect())
}

/// Returns true when the element is or contains a cylinder along an axis of the frame.
fn has_axis(assembly: &Assembly, number: usize, axis: usize) -> bool {
    let element = &assembly.elements()[number];
    contains_axis(&element.shape, &[element.pose], axis)
}

fn contains_axis(shape: &Shape, poses: &[Pose], axis: usize) -> bool {
    match shape {
        Shape::Cylinder { .. } => {
            let own = poses
                .iter()
                .rev()
                .skip(1)
                .fold(own_z(poses[poses.len() - 1].rotation), |z, pose| {
                    crate::extent::rotated(pose.rotation, z)
                });
            own[axis].abs() > 1.0 - SAME_NORMAL
        }
        Shape::Compound(parts) => parts.iter().any(|(pose, part)| {
            let all = [poses, &[*pose]].concat();
            contains_axis(part, &all, axis)
        }),
        Shape::Block { .. } | Shape::Mesh(_) => false,
    }
}

/// Returns the unit normal from `a` to `b` where `a`, moved in a direction, meets `b`.
fn normal(
    assembly: &Assembly,
    a: usize,
    b: usize,
    direction: Direction,
) -> Result<Option<[f64; 3]>, PlanError> {
    let pair = [
        assembly.elements()[a].clone(),
        assembly.elements()[b].clone(),
    ];
    let depth_mm = assembly.tolerance().contact_mm;
    let (movers, whole) = modelled(&pair, depth_mm, assembly.origin())?;
    let mut model: Model = whole;
    let own = model.keys().next();
    own.into_iter().for_each(|key| {
        model.remove(key);
    });
    let reach_mm = assembly.tolerance().mate_mm + 4.0 * depth_mm;
    let way = Move {
        from: assembly.pose(a, [0.0; 3]),
        to: assembly.pose(a, direction.displacement(reach_mm)),
        margin_mm: 0.0,
        ignore: &[],
    };
    Ok(match model.first_contact(&movers[0], &way) {
        Answer::Blocked(contact) => Some(contact.normal.map(|member| 0.0 - member)),
        Answer::Clear => None,
    })
}
