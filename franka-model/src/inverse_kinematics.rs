//! Joint positions for a pose, by iteration.
//!
//! Use this module to check before a motion if a target can be reached. The search starts from the
//! seed, and then from postures that are spread over the joint ranges. Each iteration is a damped
//! Gauss-Newton step inside the joint limits. The search returns one solution, near the seed if
//! possible. If the search finds no solution, the target is almost certainly out of reach, but this
//! is not proven.

use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::box_qp::{JointBox, PASSES_MAX, Problem, minimise};
use crate::frame::{EndEffector, Frame};
use crate::limits::JointLimits;
use crate::model::Model;
use crate::{Jacobian, JointVector, READY, Twist, rotation, transform};

/// Reason why the search found no solution.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum IkError {
    /// The arm cannot reach the pose within the joint limits. The fields describe how close the
    /// search came.
    Unreachable {
        /// Remaining distance from the target, `[m]`, of the search that came closest.
        position: f64,
        /// Remaining angle from the target, `[rad]`, of the search that came closest.
        orientation: f64,
    },
    /// The target or the seed contains a number that is not finite.
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
                "the pose is out of reach: the nearest pose found is {:.1} mm and {:.1} mrad away",
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

/// Returns positions within the limits that bring the end effector to `target`, within
/// [`TOLERANCE`].
///
/// `seed` selects one of the infinitely many solutions, usually a solution near the seed. If the
/// end-effector frame is slightly non-rigid, the search uses the nearest rigid frame.
///
/// # Errors
/// Returns [`IkError`] if the search finds no solution in up to 32 starts of 60 iterations each
/// (about 2 ms), or if an argument is invalid.
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
    let limits = model.joint_limits();
    let spread = (0..SPREAD_STARTS).map(|index| spread(limits, index));
    for start in [*seed, READY].into_iter().chain(spread) {
        match from_seed(model, &flange, &start) {
            Ok(q) => return Ok(q),
            Err(gap) => best = best.smaller(gap),
        }
    }
    Err(best.into())
}

/// Returns positions within the limits that bring the origin of the end effector to `point` `[m]`,
/// in the base frame, within [`TOLERANCE`], with any orientation.
///
/// # Errors
/// Returns [`IkError`], with an `orientation` of zero, if the search finds no solution or an
/// argument is invalid.
pub fn solve_position(
    model: &Model,
    point: &Vector3<f64>,
    ee: &EndEffector,
    seed: &JointVector,
) -> Result<JointVector, IkError> {
    let finite = |x: &f64| x.is_finite();
    if !(point.iter().all(finite) && seed.iter().all(finite)) {
        return Err(IkError::NotFinite);
    }
    let tool = transform::isometry(&ee.f_t_ee).ok_or(IkError::EndEffectorNotRigid)?;
    let place = Task::Position(tool.translation.vector, *point);
    let limits = model.joint_limits();
    let mut best = Gap::INFINITE;
    let spread = (0..POSITION_STARTS).map(|index| spread(limits, index));
    for start in [*seed, READY].into_iter().chain(spread) {
        match descend(model, &place, &start) {
            Ok(q) => return Ok(q),
            Err(gap) => best = best.smaller(gap),
        }
    }
    Err(best.into())
}

/// Returns positions within the limits that bring the flange to a pose, from one start.
pub(crate) fn from_seed(
    model: &Model,
    flange: &Isometry3<f64>,
    seed: &JointVector,
) -> Result<JointVector, Gap> {
    descend(model, &Task::Pose(*flange), seed)
}

/// Largest residual of a solution at the flange, in metres and radians.
pub const TOLERANCE: f64 = 1e-9;

/// The target, in the base frame.
enum Task {
    /// The pose of the flange.
    Pose(Isometry3<f64>),
    /// A point in flange axes, and its target position.
    Position(Vector3<f64>, Vector3<f64>),
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Gap {
    position: f64,
    orientation: f64,
}

impl From<Gap> for IkError {
    fn from(gap: Gap) -> Self {
        Self::Unreachable {
            position: gap.position,
            orientation: gap.orientation,
        }
    }
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

/// Runs Gauss-Newton from one start.
fn descend(model: &Model, task: &Task, start: &JointVector) -> Result<JointVector, Gap> {
    let limits = model.joint_limits();
    let mut q = JointBox::new(&limits.lower, &limits.upper).clamp(start);
    let mut active = Default::default();
    let mut gap = Gap::INFINITE;
    for _ in 0..ITERATIONS_MAX {
        let (error, mut weighted) = task.linearised(model, &q);
        gap = Gap {
            position: error.fixed_rows::<3>(0).norm(),
            orientation: error.fixed_rows::<3>(3).norm(),
        };
        if gap.position < TOLERANCE && gap.orientation < TOLERANCE {
            return Ok(q);
        }
        let mut task = error;
        weighted
            .fixed_rows_mut::<3>(3)
            .scale_mut(ORIENTATION_WEIGHT);
        task.fixed_rows_mut::<3>(3).scale_mut(ORIENTATION_WEIGHT);
        // With a damping in proportion to the remaining error, the iteration converges from afar
        // and near singularities, and quadratically close to the solution (Sugihara, 2011).
        let damping = 0.5 * task.norm_squared() + DAMPING_FLOOR;
        let zero = JointVector::zeros();
        let problem = Problem::new(&weighted, &task, &zero, damping);
        let step = minimise(&problem, &step_box(limits, &q), active, PASSES_MAX);
        active = step.active;
        q += step.x;
    }
    Err(gap)
}

impl Task {
    /// Returns the remaining error at `q` (position error and rotation vector in base axes) and its
    /// derivative. Components without a target are zero.
    fn linearised(&self, model: &Model, q: &JointVector) -> (Twist, Jacobian) {
        let flange = EndEffector::default();
        let pose = model.pose(Frame::Flange, q, &flange);
        let mut jacobian = model.zero_jacobian(Frame::Flange, q, &flange);
        let place: Vector3<f64> = pose.fixed_view::<3, 1>(0, 3).into_owned();
        let axes: Matrix3<f64> = pose.fixed_view::<3, 3>(0, 0).into_owned();
        let (shift, turn) = match self {
            Self::Pose(target) => {
                let rotation = Rotation3::from_matrix_unchecked(axes);
                let actual = UnitQuaternion::from_rotation_matrix(&rotation);
                let turn = rotation::error(&target.rotation, &actual);
                (target.translation.vector - place, turn)
            }
            Self::Position(point, target) => {
                let lever = axes * point;
                for mut column in jacobian.column_iter_mut() {
                    let turn: Vector3<f64> = column.fixed_rows::<3>(3).into_owned();
                    let mut linear = column.fixed_rows_mut::<3>(0);
                    linear += turn.cross(&lever);
                    column.fixed_rows_mut::<3>(3).fill(0.0);
                }
                (target - place - lever, Vector3::zeros())
            }
        };
        let error = Twist::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z);
        (error, jacobian)
    }
}

/// Returns bounds on the displacement of one step. Within them, the joints stay inside the limits,
/// and the linear model is valid.
fn step_box(limits: &JointLimits, q: &JointVector) -> JointBox {
    let reach = JointVector::from_element(STEP_MAX);
    JointBox::new(
        &(limits.lower - q).sup(&-reach),
        &(limits.upper - q).inf(&reach),
    )
}

/// Weight of the orientation, in metres per radian: about half the forearm.
const ORIENTATION_WEIGHT: f64 = 0.2;
/// Smallest damping, `[m²]`. It keeps the problem strictly convex at the solution.
const DAMPING_FLOOR: f64 = 1e-9;
/// Largest move of a joint in one iteration, `[rad]`.
const STEP_MAX: f64 = 0.5;
const ITERATIONS_MAX: usize = 60;
/// Number of starts after the seed and the ready pose.
const SPREAD_STARTS: u32 = 30;
/// Number of starts for a point.
const POSITION_STARTS: u32 = 6;

/// Returns posture `index` of a sequence that fills the joint ranges evenly.
///
/// Each joint advances by a power of the reciprocal of 1.1127756842787055, the root of `x⁸ = x + 1`
/// (Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018, for seven dimensions).
fn spread(limits: &JointLimits, index: u32) -> JointVector {
    let mut step = 1.0;
    JointVector::from_fn(|i, _| {
        step /= 1.1127756842787055;
        let share = (0.5 + step * f64::from(index)) % 1.0;
        limits.lower[i] + share * (limits.upper[i] - limits.lower[i])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use nalgebra::{Matrix4, Translation3};

    fn pose(q: &JointVector, ee: &EndEffector) -> Isometry3<f64> {
        let pose = Model::fr3().pose(Frame::EndEffector, q, ee);
        transform::isometry(&pose).expect("a rigid frame")
    }

    fn tool() -> EndEffector {
        let f_t_ee = Isometry3::from_parts(
            Translation3::new(0.02, 0.0, 0.15),
            rotation::exp(&Vector3::new(0.1, 0.4, -0.8)),
        );
        EndEffector {
            f_t_ee: transform::matrix(&f_t_ee),
            ..EndEffector::default()
        }
    }

    #[test]
    fn every_pose_of_the_arm_is_found_again() {
        let mut random = Random::new(61);
        let ee = tool();
        for _ in 0..1000 {
            let target = pose(&random.posture(Model::fr3()), &ee);
            let q = solve(Model::fr3(), &target, &ee, &READY).expect("within reach");
            assert!(Model::fr3().joint_limits().contains(&q));
            let reached = pose(&q, &ee);
            let distance = (reached.translation.vector - target.translation.vector).norm();
            let angle = rotation::error(&target.rotation, &reached.rotation).norm();
            assert!(
                distance < 2e-9 && angle < 2e-9,
                "{distance:e} m, {angle:e} rad"
            );
        }
    }

    #[test]
    fn every_point_of_the_tool_is_found_again() {
        let mut random = Random::new(63);
        let ee = tool();
        for _ in 0..1000 {
            let target = pose(&random.posture(Model::fr3()), &ee).translation.vector;
            let q = solve_position(Model::fr3(), &target, &ee, &READY).expect("within reach");
            assert!(Model::fr3().joint_limits().contains(&q));
            assert!((pose(&q, &ee).translation.vector - target).norm() < 2e-9);
        }
    }

    #[test]
    fn a_good_seed_is_kept() {
        let mut random = Random::new(62);
        for _ in 0..200 {
            let seed = random.posture(Model::fr3());
            let target = pose(&seed, &EndEffector::default());
            let q = solve(Model::fr3(), &target, &EndEffector::default(), &seed);
            assert!((q.expect("the seed itself") - seed).amax() < 1e-12);
        }
    }

    #[test]
    fn a_seed_outside_the_limits_is_brought_inside_first() {
        let limits = Model::fr3().joint_limits();
        let target = pose(&READY, &EndEffector::default());
        let seed = READY + JointVector::from_element(10.0);
        let q = solve(Model::fr3(), &target, &EndEffector::default(), &seed).expect("reachable");
        assert!(limits.contains(&q));
    }

    #[test]
    fn a_pose_out_of_reach_is_refused_with_what_remains() {
        let mut target = pose(&READY, &EndEffector::default());
        target.translation.vector.x = 2.0;
        match solve(Model::fr3(), &target, &EndEffector::default(), &READY) {
            // The flange's distance from the shoulder is at most the sum of the arm's, the wrist's
            // and the flange's lengths.
            Err(IkError::Unreachable { position, .. }) => assert!(position > 1.0, "{position}"),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn input_that_means_nothing_is_refused() {
        let (model, ee) = (Model::fr3(), EndEffector::default());
        let target = pose(&READY, &ee);
        let mut nowhere = target;
        nowhere.translation.vector.y = f64::NAN;
        assert_eq!(solve(model, &nowhere, &ee, &READY), Err(IkError::NotFinite));
        let nothing = JointVector::from_element(f64::INFINITY);
        assert_eq!(
            solve(model, &target, &ee, &nothing),
            Err(IkError::NotFinite)
        );
        let flat = EndEffector {
            f_t_ee: Matrix4::zeros(),
            ..ee
        };
        assert_eq!(
            solve(model, &target, &flat, &READY),
            Err(IkError::EndEffectorNotRigid)
        );
    }
}
