//! The posture nearest to a reference posture, among all postures for a pose.

use nalgebra::Isometry3;

use super::{Solution, flange_of, joint_7, sweep};
use crate::JointVector;
use crate::frame::EndEffector;
use crate::inverse_kinematics::{self, IkError};
use crate::model::Model;

/// Returns the posture nearest to `q` that brings the end effector to `target`, within the limits.
/// The nearest posture has the smallest sum of squared joint differences. Returns `None` if no
/// posture was found.
///
/// The search sweeps joint 7 through its range and refines the best posture of every branch. The
/// search takes about 0.3 ms. The sweep can miss solutions that exist only in a range of joint 7 of
/// a hundredth of a radian. [`reach`](super::reach) searches more finely.
///
/// # Errors
/// Returns [`IkError`] if an argument is not finite or the end-effector frame is not rigid.
pub fn nearest(
    model: &Model,
    target: &Isometry3<f64>,
    ee: &EndEffector,
    q: &JointVector,
) -> Result<Option<Solution>, IkError> {
    let flange = flange_of(target, ee)?;
    if !q.iter().all(|x| x.is_finite()) {
        return Err(IkError::NotFinite);
    }
    let limits = model.joint_limits();
    // Smallest distance for each branch. Along joint 7, the postures of one branch are continuous.
    let mut least = [None; 8];
    let near = inverse_kinematics::from_seed(model, &flange, q).unwrap_or(*q)[6];
    let places = [q[6], near].into_iter();
    let places = places.flat_map(|q7| at(model, &flange, q7));
    for solution in sweep(model, &flange, STEPS).chain(places) {
        let solution = solution.slid_towards(q);
        let place: &mut Option<Solution> = &mut least[solution.branch.index()];
        *place = best([*place, Some(solution)].into_iter().flatten(), q);
    }
    // Refines the result between samples by descending steps, and halves the step size each time.
    for found in least.iter_mut().flatten() {
        let mut step = (limits.upper[6] - limits.lower[6]) / f64::from(STEPS);
        while step > RESOLUTION {
            let (centre, branch) = (found.q[6], found.branch);
            let around = [centre - step, centre + step].into_iter();
            let around = around
                .flat_map(|q7| at(model, &flange, q7))
                .filter(|solution| solution.branch == branch)
                .map(|solution| solution.slid_towards(q));
            match best(around, q) {
                Some(nearer) if distance(&nearer, q) < distance(found, q) => *found = nearer,
                _ => step *= 0.5,
            }
        }
    }
    Ok(best(least.into_iter().flatten(), q))
}

fn at(model: &Model, flange: &Isometry3<f64>, q7: f64) -> impl Iterator<Item = Solution> + use<> {
    let limits = model.joint_limits();
    let found = joint_7::all(model.lengths(), flange, q7).within(&limits.lower, &limits.upper);
    (0..found.len()).map(move |index| found[index])
}

fn best(solutions: impl Iterator<Item = Solution>, q: &JointVector) -> Option<Solution> {
    solutions.min_by(|a, b| distance(a, q).total_cmp(&distance(b, q)))
}

fn distance(solution: &Solution, q: &JointVector) -> f64 {
    (solution.q - q).norm_squared()
}

const STEPS: u32 = 96;
/// Resolution of joint 7, `[rad]`.
const RESOLUTION: f64 = 1e-9;
