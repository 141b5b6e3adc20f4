//! All inverse kinematics solutions for a pose and an angle of joint 7 or joint 4, against an
//! enumeration. A numerical search found no further solutions.

use anyhow::Context as _;
use franka_model::analytic_ik::{self, Branch, Redundancy, Solution, Solutions};
use franka_model::geometry::Lengths;
use franka_model::{EndEffector, Frame, JointVector, Model, RobotKind, joint_vector, transform};
use nalgebra::Matrix4;
use serde::Deserialize;

use super::{Case, Report};

/// Tolerance of joint angles, `[rad]`: no pose of the file is nearer than 1e-7 to a double root,
/// where rounding weighs a thousand times.
const ANGLE: f64 = 1e-10;
/// Tolerance of the pose of a solution, `[m]` and elements of the rotation.
const POSE: f64 = 1e-12;

#[derive(Deserialize)]
struct File {
    vectors: Vec<Vector>,
}

#[derive(Deserialize)]
#[allow(non_snake_case)]
struct Vector {
    O_T_F: [f64; 16],
    q7: f64,
    solutions: Vec<Listed>,
    /// Indices into `solutions`.
    in_limits_fr3: Vec<usize>,
    in_limits_fer: Vec<usize>,
    q4_free: Option<WithJoint4>,
}

#[derive(Deserialize)]
struct Listed {
    q: [f64; 7],
    branch: [u8; 3],
}

/// An angle of joint 4 and all postures that have it; these are listed without branches.
#[derive(Deserialize)]
struct WithJoint4 {
    q4: f64,
    solutions: Vec<[f64; 7]>,
}

/// Checks `ik_vectors.json`: the complete set of every pose for joint 7, its part within the limits
/// of each robot, and the set for joint 4 if one exists.
pub(super) fn all(text: &[u8]) -> anyhow::Result<Report> {
    let mut report = Report::default();
    let file: File = serde_json::from_slice(text)?;
    for (index, vector) in file.vectors.iter().enumerate() {
        let pose = Matrix4::from_column_slice(&vector.O_T_F);
        let flange = transform::isometry(&pose).context("a pose that is not rigid")?;
        let branches: Vec<_> = vector.solutions.iter().map(Listed::branch).collect();
        let of = |indices: &[usize]| -> anyhow::Result<Vec<Branch>> {
            let branch = |&index| branches.get(index).copied();
            let found: Option<_> = indices.iter().map(branch).collect();
            found.context("an index that is not one of the solutions")
        };
        let within = [
            (RobotKind::Fr3, of(&vector.in_limits_fr3)?),
            (RobotKind::Fer, of(&vector.in_limits_fer)?),
        ];
        report.case(format!("vectors[{index}]"), |case| {
            let found =
                analytic_ik::all(&Lengths::DESCRIBED, &flange, Redundancy::Joint7(vector.q7));
            check_set(case, &found, &vector.solutions, &pose);
            for (kind, branches) in &within {
                check_limits(case, &found, *kind, branches);
            }
            if let Some(WithJoint4 { q4, solutions }) = &vector.q4_free {
                let found = analytic_ik::all(&Lengths::DESCRIBED, &flange, Redundancy::Joint4(*q4));
                check_postures(case, &found, solutions, &pose);
            }
        });
    }
    Ok(report)
}

impl Listed {
    fn branch(&self) -> Branch {
        let [elbow, wrist, shoulder] = self.branch.map(|bit| bit == 1);
        Branch {
            elbow,
            wrist,
            shoulder,
        }
    }
}

fn check_set(case: &mut Case<'_>, found: &Solutions, wanted: &[Listed], pose: &Matrix4<f64>) {
    case.equal("number of solutions", found.len(), wanted.len());
    for want in wanted {
        match found.iter().find(|got| got.branch == want.branch()) {
            Some(got) => check_posture(case, &got.q, &joint_vector(want.q), pose),
            None => case.fail(format!("{:?} is missing", want.branch())),
        }
    }
}

fn check_postures(
    case: &mut Case<'_>,
    found: &Solutions,
    wanted: &[[f64; 7]],
    pose: &Matrix4<f64>,
) {
    case.equal("number with joint 4 given", found.len(), wanted.len());
    for want in wanted.iter().copied().map(joint_vector) {
        let off = |got: &&Solution| turns_off(&(got.q - want)).amax();
        match found.iter().min_by(|a, b| off(a).total_cmp(&off(b))) {
            Some(got) => check_posture(case, &got.q, &want, pose),
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
