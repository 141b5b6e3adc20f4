//! Joint positions for a pose, by iteration.
//!
//! Good for accepting or refusing a target before moving: each iteration is a damped Gauss-Newton
//! step inside the joint limits, from the seed first and then from a few postures spread over the
//! workspace. It finds one solution near the seed where there is one; it does not list them, and a
//! refusal is strong evidence, not a proof.

use nalgebra::{Isometry3, Rotation3, UnitQuaternion};

use crate::box_qp::{JointBox, minimise};
use crate::frame::{EndEffector, Frame};
use crate::limits::JointLimits;
use crate::model::Model;
use crate::{JointVector, READY, Twist, joint_vector, rotation, transform};

/// Why there is no solution.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum IkError {
    /// No start came closer than this; the pose is out of reach within the joint limits.
    Unreachable {
        /// Distance left, `[m]`.
        position: f64,
        /// Angle left, `[rad]`.
        orientation: f64,
    },
    /// The target or the seed has a number that is not finite.
    NotFinite,
    /// The end-effector frame is not a rigid transform.
    EndEffectorNotRigid,
}

impl core::fmt::Display for IkError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Unreachable {
                position,
                orientation,
            } => write!(
                f,
                "the pose is out of reach: {:.1} mm and {:.1} mrad remain",
                position * 1e3,
                orientation * 1e3
            ),
            Self::NotFinite => f.write_str("the target or the seed is not finite"),
            Self::EndEffectorNotRigid => {
                f.write_str("the end-effector frame is not a rigid transform")
            }
        }
    }
}

impl core::error::Error for IkError {}

/// Positions within the limits that bring the end effector to `target`, to [`TOLERANCE`].
///
/// `seed` decides which of the infinitely many solutions is found: usually one nearby. An
/// end-effector frame that is not quite rigid counts as its nearest rigid one.
///
/// # Errors
/// See [`IkError`]. A refusal takes up to `9 × 60` iterations, below 2 ms.
pub fn solve(
    model: &Model,
    target: &Isometry3<f64>,
    ee: &EndEffector,
    seed: &JointVector,
) -> Result<JointVector, IkError> {
    let tool = transform::isometry(&ee.f_t_ee).ok_or(IkError::EndEffectorNotRigid)?;
    let flange = target * tool.inverse();
    let finite = |x: &f64| x.is_finite();
    if !(transform::matrix(&flange).iter().all(finite) && seed.iter().all(finite)) {
        return Err(IkError::NotFinite);
    }
    let mut best = Gap::INFINITE;
    for start in core::iter::once(seed).chain(&STARTS) {
        match descend(model, &flange, start) {
            Ok(q) => return Ok(q),
            Err(gap) => best = best.smaller(gap),
        }
    }
    Err(IkError::Unreachable {
        position: best.position,
        orientation: best.orientation,
    })
}

/// Residual of a solution at the flange: metres and radians.
pub const TOLERANCE: f64 = 1e-9;

/// What is left to a target.
#[derive(Clone, Copy)]
struct Gap {
    position: f64,
    orientation: f64,
}

impl Gap {
    const INFINITE: Self = Self {
        position: f64::INFINITY,
        orientation: f64::INFINITY,
    };

    fn smaller(self, other: Self) -> Self {
        let size = |gap: Self| gap.position + ORIENTATION_WEIGHT * gap.orientation;
        if size(other) < size(self) {
            other
        } else {
            self
        }
    }
}

/// Gauss-Newton from one start.
fn descend(
    model: &Model,
    flange: &Isometry3<f64>,
    start: &JointVector,
) -> Result<JointVector, Gap> {
    let limits = model.joint_limits();
    let mut q = JointBox::new(&limits.lower, &limits.upper).clamp(start);
    let mut active = Default::default();
    let mut gap = Gap::INFINITE;
    for _ in 0..ITERATIONS_MAX {
        let error = error_at(model, flange, &q);
        gap = Gap {
            position: error.fixed_rows::<3>(0).norm(),
            orientation: error.fixed_rows::<3>(3).norm(),
        };
        if gap.position < TOLERANCE && gap.orientation < TOLERANCE {
            return Ok(q);
        }
        let jacobian = model.zero_jacobian(Frame::Flange, &q, &EndEffector::default());
        let (mut weighted, mut task) = (jacobian, error);
        weighted
            .fixed_rows_mut::<3>(3)
            .scale_mut(ORIENTATION_WEIGHT);
        task.fixed_rows_mut::<3>(3).scale_mut(ORIENTATION_WEIGHT);
        // Damping in proportion to the error left converges from afar and near singularities,
        // and fades where Gauss-Newton is quadratic (Sugihara, 2011).
        let damping = 0.5 * task.norm_squared() + DAMPING_FLOOR;
        let mut hessian = weighted.tr_mul(&weighted);
        for i in 0..7 {
            hessian[(i, i)] += damping;
        }
        let step = minimise(
            &hessian,
            &weighted.tr_mul(&task),
            &step_box(limits, &q),
            &JointVector::zeros(),
            active,
        );
        active = step.active;
        q += step.x;
    }
    Err(gap)
}

/// Position error and rotation vector, base axes, from the flange at `q` to `flange`.
fn error_at(model: &Model, flange: &Isometry3<f64>, q: &JointVector) -> Twist {
    let pose = model.pose(Frame::Flange, q, &EndEffector::default());
    let rotation = Rotation3::from_matrix_unchecked(pose.fixed_view::<3, 3>(0, 0).into_owned());
    let actual = UnitQuaternion::from_rotation_matrix(&rotation);
    let mut error = Twist::zeros();
    error
        .fixed_rows_mut::<3>(0)
        .copy_from(&(flange.translation.vector - pose.fixed_view::<3, 1>(0, 3)));
    error
        .fixed_rows_mut::<3>(3)
        .copy_from(&rotation::error(&flange.rotation, &actual));
    error
}

/// Displacements that stay within the limits and within what a linear model is good for.
fn step_box(limits: &JointLimits, q: &JointVector) -> JointBox {
    let reach = JointVector::from_element(STEP_MAX);
    JointBox::new(
        &(limits.lower - q).sup(&-reach),
        &(limits.upper - q).inf(&reach),
    )
}

/// Metres per radian, about half the forearm.
const ORIENTATION_WEIGHT: f64 = 0.2;
/// Keeps the problem strictly convex at the solution, `[m²]`.
const DAMPING_FLOOR: f64 = 1e-9;
/// Largest move of a joint in one iteration, `[rad]`.
const STEP_MAX: f64 = 0.5;
const ITERATIONS_MAX: usize = 60;

/// Where to start when the seed leads nowhere: combinations of shoulder, elbow and wrist over the
/// joint ranges.
static STARTS: [JointVector; 8] = [
    READY,
    joint_vector([1.5, 0.5, 0.5, -1.5, 0.0, 2.0, 0.0]),
    joint_vector([-1.5, 0.5, -0.5, -1.5, 0.0, 2.0, 0.0]),
    joint_vector([0.0, 1.2, 0.0, -2.0, 0.0, 3.2, -1.5]),
    joint_vector([2.5, -0.8, -1.0, -2.2, 1.5, 1.5, 1.5]),
    joint_vector([-2.5, -0.8, 1.0, -2.2, -1.5, 1.5, -1.5]),
    joint_vector([0.0, 1.2, 0.0, -0.6, 0.0, 1.2, 0.8]),
    joint_vector([0.0, -1.2, 2.5, -2.6, 0.0, 3.8, 0.0]),
];
