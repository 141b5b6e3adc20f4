//! All inverse kinematics solutions for a pose and an angle of joint 7, against an enumeration that a numerical search
//! found nothing to add to.

use franka_model::analytic_ik::{self, Branch, Solution, Solutions};
use franka_model::{EndEffector, Frame, JointVector, Model, RobotKind, joint_vector, transform};
use nalgebra::Matrix4;

use super::{Case, Malformed, Node, Report};

/// Of joint angles, `[rad]`: no pose of the file is nearer than 1e-7 to a double root, where rounding weighs a
/// thousand times.
const ANGLE: f64 = 1e-10;
/// Of the pose that a solution has, `[m]` and elements of the rotation.
const POSE: f64 = 1e-12;

/// Checks `ik_vectors.json`: the complete set of every pose, and which of it is within the limits of each robot.
///
/// The sets for a given angle of joint 4, which are in the file too, are not checked: that parameter is not offered.
pub(super) fn all(root: &Node<'_>) -> Result<Report, Malformed> {
    let mut report = Report::default();
    for vector in root.get("vectors")?.list()? {
        let pose = Matrix4::from_column_slice(&vector.get("O_T_F")?.numbers::<16>()?);
        let flange = transform::isometry(&pose).ok_or_else(|| vector.malformed("a rigid pose"))?;
        let q7 = vector.get("q7")?.number()?;
        let wanted = vector.get("solutions")?.list()?;
        let wanted: Vec<Solution> = wanted.iter().map(solution).collect::<Result<_, _>>()?;
        let mut within = Vec::new();
        for (kind, name) in [
            (RobotKind::Fr3, "in_limits_fr3"),
            (RobotKind::Fer, "in_limits_fer"),
        ] {
            let indices = vector.get(name)?.list()?;
            let branch = |index: &Node<'_>| -> Result<Branch, Malformed> {
                let position = usize::try_from(index.integer()?).ok();
                let solution = position.and_then(|position| wanted.get(position));
                Ok(solution
                    .ok_or_else(|| index.malformed("the index of a solution"))?
                    .branch)
            };
            let branches = indices.iter().map(branch).collect::<Result<Vec<_>, _>>()?;
            within.push((kind, branches));
        }
        report.case(vector.path(), |case| {
            let found = analytic_ik::all(&flange, q7);
            check_set(case, &found, &wanted, &pose);
            for (kind, branches) in &within {
                check_limits(case, &found, *kind, branches);
            }
        });
    }
    Ok(report)
}

fn solution(node: &Node<'_>) -> Result<Solution, Malformed> {
    let [elbow, wrist, shoulder] = node.get("branch")?.numbers()?.map(|bit| bit == 1.0);
    Ok(Solution {
        q: joint_vector(node.get("q")?.numbers()?),
        branch: Branch {
            elbow,
            wrist,
            shoulder,
        },
    })
}

fn check_set(case: &mut Case<'_>, found: &Solutions, wanted: &[Solution], pose: &Matrix4<f64>) {
    case.equal("number of solutions", found.len(), wanted.len());
    for want in wanted {
        let Some(got) = found.iter().find(|got| got.branch == want.branch) else {
            case.fail(format!("{:?} is missing", want.branch));
            continue;
        };
        let apart = turns_off(&(got.q - want.q));
        case.near("angles", apart.as_slice(), &[0.0; 7], ANGLE);
        let reached = Model::fr3().pose(Frame::Flange, &got.q, &EndEffector::default());
        case.near("pose", reached.as_slice(), pose.as_slice(), POSE);
    }
}

/// The limits of the file are the hard ones.
fn check_limits(case: &mut Case<'_>, found: &Solutions, kind: RobotKind, wanted: &[Branch]) {
    let limits = Model::of(kind).joint_limits();
    let within = found.within(&limits.hard_lower, &limits.hard_upper);
    case.equal("number within the limits", within.len(), wanted.len());
    for branch in wanted {
        let there = within.iter().any(|solution| solution.branch == *branch);
        case.equal(
            "within the limits",
            (kind, branch, there),
            (kind, branch, true),
        );
    }
}

/// Angles less their nearest whole turns.
fn turns_off(angles: &JointVector) -> JointVector {
    angles.map(|angle| angle - std::f64::consts::TAU * (angle / std::f64::consts::TAU).round())
}
