//! All inverse kinematics solutions for a pose and an angle of joint 7 or joint 4, against an
//! enumeration that a numerical search found nothing to add to.

use franka_model::analytic_ik::{self, Branch, Redundancy, Solution, Solutions};
use franka_model::{EndEffector, Frame, JointVector, Model, RobotKind, joint_vector, transform};
use nalgebra::Matrix4;

use super::{Case, Malformed, Node, Report};

/// Of joint angles, `[rad]`: no pose of the file is nearer than 1e-7 to a double root, where
/// rounding weighs a thousand times.
const ANGLE: f64 = 1e-10;
/// Of the pose that a solution has, `[m]` and elements of the rotation.
const POSE: f64 = 1e-12;

/// Checks `ik_vectors.json`: the complete set of every pose for joint 7, which of it is within the
/// limits of each robot, and the set for joint 4 where there is one.
pub(super) fn all(root: &Node<'_>) -> Result<Report, Malformed> {
    let mut report = Report::default();
    for vector in root.get("vectors")?.list()? {
        let pose = Matrix4::from_column_slice(&vector.get("O_T_F")?.numbers::<16>()?);
        let flange = transform::isometry(&pose).ok_or_else(|| vector.malformed("a rigid pose"))?;
        let q7 = vector.get("q7")?.number()?;
        let wanted = vector.get("solutions")?.list()?;
        let wanted: Vec<Wanted> = wanted.iter().map(Wanted::read).collect::<Result<_, _>>()?;
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
        let joint_4 = vector.find("q4_free");
        let joint_4 = joint_4.as_ref().map(read_joint_4).transpose()?;
        report.case(vector.path(), |case| {
            let found = analytic_ik::all(&flange, Redundancy::Joint7(q7));
            check_set(case, &found, &wanted, &pose);
            for (kind, branches) in &within {
                check_limits(case, &found, *kind, branches);
            }
            if let Some((q4, postures)) = &joint_4 {
                let found = analytic_ik::all(&flange, Redundancy::Joint4(*q4));
                check_postures(case, &found, postures, &pose);
            }
        });
    }
    Ok(report)
}

/// A solution of the file.
struct Wanted {
    q: JointVector,
    branch: Branch,
}

impl Wanted {
    fn read(node: &Node<'_>) -> Result<Self, Malformed> {
        let [elbow, wrist, shoulder] = node.get("branch")?.numbers()?.map(|bit| bit == 1.0);
        Ok(Self {
            q: joint_vector(node.get("q")?.numbers()?),
            branch: Branch {
                elbow,
                wrist,
                shoulder,
            },
        })
    }
}

/// The angle of joint 4 and all postures that have it; these are listed without branches.
fn read_joint_4(node: &Node<'_>) -> Result<(f64, Vec<JointVector>), Malformed> {
    let postures = node.get("solutions")?.list()?;
    let postures = postures.iter().map(|q| Ok(joint_vector(q.numbers()?)));
    Ok((
        node.get("q4")?.number()?,
        postures.collect::<Result<_, _>>()?,
    ))
}

fn check_set(case: &mut Case<'_>, found: &Solutions, wanted: &[Wanted], pose: &Matrix4<f64>) {
    case.equal("number of solutions", found.len(), wanted.len());
    for want in wanted {
        let Some(got) = found.iter().find(|got| got.branch == want.branch) else {
            case.fail(format!("{:?} is missing", want.branch));
            continue;
        };
        check_posture(case, &got.q, &want.q, pose);
    }
}

fn check_postures(
    case: &mut Case<'_>,
    found: &Solutions,
    wanted: &[JointVector],
    pose: &Matrix4<f64>,
) {
    case.equal("number with joint 4 given", found.len(), wanted.len());
    for want in wanted {
        let off = |got: &&Solution| turns_off(&(got.q - want)).amax();
        match found.iter().min_by(|a, b| off(a).total_cmp(&off(b))) {
            Some(got) => check_posture(case, &got.q, want, pose),
            None => case.fail("a posture with joint 4 given is missing"),
        }
    }
}

fn check_posture(case: &mut Case<'_>, got: &JointVector, want: &JointVector, pose: &Matrix4<f64>) {
    let apart = turns_off(&(got - want));
    case.near("angles", apart.as_slice(), &[0.0; 7], ANGLE);
    let reached = Model::fr3().pose(Frame::Flange, got, &EndEffector::default());
    case.near("pose", reached.as_slice(), pose.as_slice(), POSE);
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
