//! Inverse kinematics: joint positions for a pose, joint velocities for a twist.
#![allow(non_snake_case)]

use franka_async::Pose;
use franka_model::analytic_ik::{self, Redundancy};
use franka_model::differential_ik::{DifferentialIk, JointBox};
use franka_model::inverse_kinematics::{self, IkError};
use franka_model::{EndEffector, Frame, JointVector, Twist, transform};
use numpy::{PyArray2, PyArrayDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use super::arguments::{Poses, end_effector};
use super::{Array, Model};
use crate::arrays::{self, table};
use crate::batch::{Batch, Cost, common_count, output, outputs};

/// A velocity of the joints, and the missing part of the twist.
type Step<'py> = (Array<'py>, Array<'py>);

#[pymethods]
impl Model {
    /// Every posture within the joint limits that brings the end effector to `pose`, `(k, 7)` rad,
    /// for one additional number that selects from the arm's self-motion: the angle of `joint7`, of
    /// `joint4`, or the `swivel` angle of the elbow about the line from shoulder to wrist, rad,
    /// zero with the elbow on top. k is 0 if no posture exists; with joint 7 or 4 it is at most 8.
    #[pyo3(signature = (pose, *, joint7 = None, joint4 = None, swivel = None, F_T_EE = None))]
    fn ik<'py>(
        &self,
        py: Python<'py>,
        pose: &Bound<'py, PyAny>,
        joint7: Option<f64>,
        joint4: Option<f64>,
        swivel: Option<f64>,
        F_T_EE: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let given = redundancy(joint7, joint4, swivel)?;
        let (pose, ee) = (arrays::pose("pose", pose)?, end_effector(F_T_EE, None)?);
        let found = py.detach(|| self.solutions(&pose, &ee, given))?;
        Ok(table(py, &found, 7))
    }

    /// `ik` for each of many poses, `(n, 4, 4)` or `(n, 7)`: a list of n arrays `(k, 7)`.
    #[pyo3(signature = (poses, *, joint7 = None, joint4 = None, swivel = None, F_T_EE = None))]
    fn ik_many<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        joint7: Option<f64>,
        joint4: Option<f64>,
        swivel: Option<f64>,
        F_T_EE: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
        let given = redundancy(joint7, joint4, swivel)?;
        let (poses, ee) = (Poses::read("poses", poses)?, end_effector(F_T_EE, None)?);
        let Some(count) = poses.count() else {
            let text = "poses is a single pose, expected (n, 4, 4) or (n, 7)";
            return Err(PyValueError::new_err(text));
        };
        let found: PyResult<Vec<_>> = py.detach(|| {
            let each = (0..count).map(|i| self.solutions(poses.get(i), &ee, given));
            each.collect()
        });
        Ok(found?.iter().map(|found| table(py, found, 7)).collect())
    }

    /// The posture within the joint limits that brings the end effector to `pose` and is nearest to
    /// `q` (least sum of squares): `(7,)` rad, some 0.3 ms. `ValueError` if the pose is out of
    /// reach.
    ///
    /// For many poses or many `q` the result is `(n, 7)`, with NaN in the rows of unreachable
    /// poses.
    #[pyo3(signature = (pose, q, F_T_EE = None))]
    fn ik_near<'py>(
        &self,
        py: Python<'py>,
        pose: &Bound<'py, PyAny>,
        q: &Bound<'py, PyAny>,
        F_T_EE: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Array<'py>> {
        let (q, ee) = (Batch::<7>::read("q", q)?, end_effector(F_T_EE, None)?);
        let poses = Poses::read("pose", pose)?;
        let count = common_count(("pose", poses.count()), ("q", q.count()))?;
        let model = &self.numbers;
        let found = output(py, count, &[7], Cost::Much, |i, row| {
            let q = (*q.row(i)).into();
            match analytic_ik::nearest(model, poses.get(i), &ee, &q) {
                Ok(Some(solution)) => row.copy_from_slice(solution.q.as_slice()),
                Ok(None) | Err(_) => row.fill(f64::NAN),
            }
        });
        self.within_reach(count, found, &poses, &ee)
    }

    /// A posture within the joint limits that brings the end effector to `pose`, `(7,)` rad, by
    /// iteration from `seed`, which selects the posture: usually one nearby. It takes some 10
    /// microseconds near the seed, and 2 ms until an unreachable pose raises `ValueError`.
    /// `ik_near` examines all postures instead.
    ///
    /// For many poses or many seeds the result is `(n, 7)`, with NaN in the rows of unreachable
    /// poses.
    #[pyo3(signature = (pose, seed, F_T_EE = None))]
    fn ik_from<'py>(
        &self,
        py: Python<'py>,
        pose: &Bound<'py, PyAny>,
        seed: &Bound<'py, PyAny>,
        F_T_EE: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Array<'py>> {
        let (seed, ee) = (Batch::<7>::read("seed", seed)?, end_effector(F_T_EE, None)?);
        let poses = Poses::read("pose", pose)?;
        let count = common_count(("pose", poses.count()), ("seed", seed.count()))?;
        let model = &self.numbers;
        let found = output(py, count, &[7], Cost::Much, |i, row| {
            let seed = (*seed.row(i)).into();
            match inverse_kinematics::solve(model, poses.get(i), &ee, &seed) {
                Ok(q) => row.copy_from_slice(q.as_slice()),
                Err(_) => row.fill(f64::NAN),
            }
        });
        self.within_reach(count, found, &poses, &ee)
    }

    /// Joint velocities for the `twist` of the end effector, `[linear; angular]`, m/s and rad/s in
    /// base axes, and the missing part of the twist. The results are `(7,)` rad/s and `(6,)`, with
    /// a leading axis for many `q` or twists. It also works with displacements, in m and rad.
    ///
    /// The velocities are exactly within `lower` and `upper`, `(7,)` or `(n, 7)`, by default the
    /// limits at `q`. In the nullspace they follow `posture`, by default zero. Near singularities
    /// and at bounds the position has priority; with `smooth`, position and orientation have equal
    /// priority.
    #[pyo3(signature = (q, twist, *, posture = None, lower = None, upper = None, smooth = false, F_T_EE = None))]
    #[allow(clippy::too_many_arguments)] // the caller names each argument
    fn differential_ik<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        twist: &Bound<'py, PyAny>,
        posture: Option<&Bound<'py, PyAny>>,
        lower: Option<&Bound<'py, PyAny>>,
        upper: Option<&Bound<'py, PyAny>>,
        smooth: bool,
        F_T_EE: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Step<'py>> {
        let ee = end_effector(F_T_EE, None)?;
        let (q, twist) = (Batch::<7>::read("q", q)?, Batch::<6>::read("twist", twist)?);
        let mut count = q.count_with(&twist)?;
        let posture = Batch::<7>::or_zeros("posture", posture)?;
        let lower = lower.map(|lower| Batch::<7>::read("lower", lower));
        let upper = upper.map(|upper| Batch::<7>::read("upper", upper));
        let (lower, upper) = (lower.transpose()?, upper.transpose()?);
        let rest = [Some(&posture), lower.as_ref(), upper.as_ref()];
        for argument in rest.into_iter().flatten() {
            count = common_count(("q or twist", count), argument.named_count())?;
        }
        for i in 0..count.unwrap_or(1) {
            let (Some(lower), Some(upper)) = (&lower, &upper) else {
                break;
            };
            check_order(lower.row(i), upper.row(i))?;
        }
        let solver = match smooth {
            true => DifferentialIk::smooth(),
            false => DifferentialIk::default(),
        };
        let model = &self.numbers;
        let shapes: [&[usize]; 2] = [&[7], &[6]];
        let arrays = outputs(py, count, shapes, Cost::Little, |i, [velocity, missing]| {
            let q = JointVector::from(*q.row(i));
            let jacobian = model.zero_jacobian(Frame::EndEffector, &q, &ee);
            let (least, greatest) = model.joint_limits().velocity_envelope(&q, 0.0);
            let or = |given: &Option<Batch<7>>, default: JointVector| {
                given
                    .as_ref()
                    .map_or(default, |given| (*given.row(i)).into())
            };
            let bounds = JointBox::new(&or(&lower, least), &or(&upper, greatest));
            let (twist, posture) = (Twist::from(*twist.row(i)), (*posture.row(i)).into());
            let found = solver.solve(&jacobian, &twist, &posture, &bounds, Default::default());
            velocity.copy_from_slice(found.velocity.as_slice());
            missing.copy_from_slice((-found.residual).as_slice());
        });
        Ok(arrays.into())
    }
}

impl Model {
    /// Returns rows of seven numbers, one posture each.
    fn solutions(&self, pose: &Pose, ee: &EndEffector, given: Redundancy) -> PyResult<Vec<f64>> {
        let found = analytic_ik::solve(&self.numbers, pose, ee, given).map_err(refused)?;
        Ok(found.iter().flat_map(|found| found.q.data.0[0]).collect())
    }

    /// Returns `found`.
    ///
    /// # Errors
    /// The reason if a single pose was given and has no posture.
    fn within_reach<'py>(
        &self,
        count: Option<usize>,
        found: Bound<'py, PyArrayDyn<f64>>,
        poses: &Poses,
        ee: &EndEffector,
    ) -> PyResult<Array<'py>> {
        use numpy::PyArrayMethods;
        let is_missing =
            |found: &Array<'py>| found.readonly().as_array().iter().any(|x| x.is_nan());
        if transform::isometry(&ee.f_t_ee).is_none() {
            return Err(refused(IkError::EndEffectorNotRigid));
        }
        if count.is_none() && is_missing(&found) {
            let pose = poses.get(0);
            let why = inverse_kinematics::solve(&self.numbers, pose, ee, &franka_model::READY);
            let text = match why {
                Err(why) => why.to_string(),
                // The sweep misses poses that allow only a hundredth of a radian of joint 7.
                Ok(_) => "no posture was found for this redundant joint: try ik_from".into(),
            };
            return Err(PyValueError::new_err(format!("pose: {text}")));
        }
        Ok(found)
    }
}

fn refused(error: IkError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn check_order(lower: &[f64; 7], upper: &[f64; 7]) -> PyResult<()> {
    match (0..7).find(|&i| lower[i] > upper[i]) {
        None => Ok(()),
        Some(i) => Err(PyValueError::new_err(format!(
            "lower is {} for joint {}, expected at most upper, {}",
            lower[i],
            i + 1,
            upper[i]
        ))),
    }
}

/// Returns the given one of the three numbers.
///
/// # Errors
/// `ValueError` unless exactly one is given, and finite.
fn redundancy(
    joint7: Option<f64>,
    joint4: Option<f64>,
    swivel: Option<f64>,
) -> PyResult<Redundancy> {
    let (given, angle) = match (joint7, joint4, swivel) {
        (Some(angle), None, None) => (Redundancy::Joint7(angle), angle),
        (None, Some(angle), None) => (Redundancy::Joint4(angle), angle),
        (None, None, Some(angle)) => (Redundancy::Swivel(angle), angle),
        _ => {
            let text = "expected exactly one of joint7, joint4 and swivel";
            return Err(PyValueError::new_err(text));
        }
    };
    match angle.is_finite() {
        true => Ok(given),
        false => Err(PyValueError::new_err(format!(
            "the angle is {angle}, expected a finite number"
        ))),
    }
}
