//! The rigid-body models and the velocity envelope of the FR3 against the vendor's libraries.

use anyhow::{Context as _, ensure};
use franka_model::limits::CLIENT_MARGIN;
use franka_model::{EndEffector, Frame, JointVector, Load, Model, RobotKind, joint_vector};
use nalgebra::Matrix4;
use serde::Deserialize;

use super::loads::{Parts, Total};
use super::{Case, Report};

// Tolerances of the numbers in the files, which went through other orders of summation. The
// vendor's own two routes to the Coriolis torques differ by 2.5e-14.
const POSE: f64 = 1e-13;
const JACOBIAN: f64 = 1e-13;
const MASS: f64 = 1e-13;
const TORQUE: f64 = 1e-12;
/// Largest deviation of the physically consistent FER from the vendor's without a load: the figures
/// of its documentation, rounded up.
const FIT_MASS: f64 = 0.02;
const FIT_GRAVITY: f64 = 0.02;
const FIT_CORIOLIS: f64 = 0.09;

#[derive(Deserialize)]
struct File {
    meta: Meta,
    load_configs: Vec<Tool>,
    samples: Vec<Sample>,
}

#[derive(Deserialize)]
struct Meta {
    gravity: [f64; 3],
    gravity_alt: [f64; 3],
}

/// A configuration of frames and loads, and the totals that the vendor's client computes from it.
#[derive(Deserialize)]
#[allow(non_snake_case)]
struct Tool {
    F_T_EE: [f64; 16],
    EE_T_K: [f64; 16],
    /// The file of the FER has totals only.
    #[serde(flatten)]
    parts: Option<Parts>,
    #[serde(flatten)]
    total: Total,
}

#[derive(Deserialize)]
struct Sample {
    q: [f64; 7],
    dq: [f64; 7],
    #[serde(flatten)]
    frames: Frames,
    loads: Vec<Loaded>,
}

/// A configuration with one of the loads.
#[derive(Deserialize)]
struct Loaded {
    load: usize,
    #[serde(flatten)]
    frames: Frames,
    mass: Vec<f64>,
    coriolis: [f64; 7],
    gravity: [f64; 7],
    gravity_alt: [f64; 7],
}

/// Poses and Jacobians of some frames: concatenated matrices, column-major.
#[derive(Deserialize)]
struct Frames {
    pose: Vec<f64>,
    zero_jacobian: Vec<f64>,
    body_jacobian: Vec<f64>,
}

#[derive(Deserialize)]
struct Envelope {
    vectors: Vec<VelocityLimits>,
}

#[derive(Deserialize)]
struct VelocityLimits {
    q: [f64; 7],
    lower: [f64; 7],
    upper: [f64; 7],
}

/// Checks `model_vectors_fr3.json`: libfranka 0.20.4 with the FR3 URDF.
pub(super) fn fr3(text: &[u8]) -> anyhow::Result<Report> {
    rigid_body(text, Model::fr3())
}

/// Checks `model_vectors_fer.json`: the FER's own model library.
pub(super) fn fer(text: &[u8]) -> anyhow::Result<Report> {
    rigid_body(text, Model::fer())
}

/// Checks in `model_vectors_fer.json` how far the physically consistent FER is from the vendor's
/// library, at the configurations without a load.
pub(super) fn fer_physically_consistent(text: &[u8]) -> anyhow::Result<Report> {
    let mut report = Report::default();
    let file: File = serde_json::from_slice(text)?;
    let (model, none) = (Model::physically_consistent(RobotKind::Fer), &Load::NONE);
    let gravity = file.meta.gravity.into();
    for (index, sample) in file.samples.iter().enumerate() {
        let (q, dq) = (joint_vector(sample.q), joint_vector(sample.dq));
        let want = sample.loads.first().context("a sample without loads")?;
        report.case(format!("samples[{index}]"), |case| {
            let mass = model.mass(&q, none);
            case.near("mass", mass.as_slice(), &want.mass, FIT_MASS);
            let torques = model.gravity(&q, none, &gravity);
            case.near("gravity", torques.as_slice(), &want.gravity, FIT_GRAVITY);
            let torques = model.coriolis(&q, &dq, none);
            case.near("Coriolis", torques.as_slice(), &want.coriolis, FIT_CORIOLIS);
        });
    }
    Ok(report)
}

/// A case is one configuration with one load; the frames that no load moves are checked with each.
fn rigid_body(text: &[u8], model: &Model) -> anyhow::Result<Report> {
    let mut report = Report::default();
    let file: File = serde_json::from_slice(text)?;
    report.each("load_configs", &file.load_configs, |case, tool| {
        tool.total.check(case, &tool.load());
    });
    let (common, per_load) = Frame::ALL.split_at(8);
    for (index, sample) in file.samples.iter().enumerate() {
        let (q, dq) = (joint_vector(sample.q), joint_vector(sample.dq));
        sample.frames.check_length(common)?;
        for (position, loaded) in sample.loads.iter().enumerate() {
            let tool = file.load_configs.get(loaded.load);
            let tool = tool.context("a load that is not in load_configs")?;
            let ee = tool.end_effector();
            loaded.frames.check_length(per_load)?;
            report.case(format!("samples[{index}].loads[{position}]"), |case| {
                sample.frames.check(case, common, model, &q, &ee);
                loaded.frames.check(case, per_load, model, &q, &ee);
                loaded.check(case, model, &file.meta, &q, &dq, &ee, &tool.load());
            });
        }
    }
    Ok(report)
}

/// Checks `velocity_limit_vectors_fr3.json`, libfranka 0.21.3: equal to the last bit.
pub(super) fn velocity_envelope(text: &[u8]) -> anyhow::Result<Report> {
    let mut report = Report::default();
    let file: Envelope = serde_json::from_slice(text)?;
    report.each("vectors", &file.vectors, |case, v| {
        let limits = Model::fr3().joint_limits();
        let (lower, upper) = limits.velocity_envelope(&joint_vector(v.q), CLIENT_MARGIN);
        case.near("lower", lower.as_slice(), &v.lower, 0.0);
        case.near("upper", upper.as_slice(), &v.upper, 0.0);
    });
    Ok(report)
}

impl Tool {
    fn end_effector(&self) -> EndEffector {
        EndEffector {
            f_t_ee: Matrix4::from_column_slice(&self.F_T_EE),
            ee_t_k: Matrix4::from_column_slice(&self.EE_T_K),
        }
    }

    /// The load of both parts, combined by the model.
    fn load(&self) -> Load {
        let total = || self.total.load();
        self.parts.as_ref().map_or_else(total, Parts::combined)
    }
}

impl Frames {
    fn check_length(&self, frames: &[Frame]) -> anyhow::Result<()> {
        for (numbers, size) in [
            (&self.pose, 16),
            (&self.zero_jacobian, 42),
            (&self.body_jacobian, 42),
        ] {
            let (got, expected) = (numbers.len(), size * frames.len());
            ensure!(got == expected, "{got} numbers, expected {expected}");
        }
        Ok(())
    }

    fn check(
        &self,
        case: &mut Case<'_>,
        frames: &[Frame],
        model: &Model,
        q: &JointVector,
        ee: &EndEffector,
    ) {
        let poses = self.pose.chunks(16).zip(frames);
        let jacobians = self
            .zero_jacobian
            .chunks(42)
            .zip(self.body_jacobian.chunks(42));
        for ((pose, &frame), (zero, body)) in poses.zip(jacobians) {
            let got = model.pose(frame, q, ee);
            case.near(&format!("pose of {frame:?}"), got.as_slice(), pose, POSE);
            let got = model.zero_jacobian(frame, q, ee);
            let name = format!("zero Jacobian of {frame:?}");
            case.near(&name, got.as_slice(), zero, JACOBIAN);
            let got = model.body_jacobian(frame, q, ee);
            let name = format!("body Jacobian of {frame:?}");
            case.near(&name, got.as_slice(), body, JACOBIAN);
        }
    }
}

impl Loaded {
    /// Each quantity on its own, and all of them from one pass; the end effector is the first of
    /// the frames that a load moves.
    #[allow(clippy::too_many_arguments)]
    fn check(
        &self,
        case: &mut Case<'_>,
        model: &Model,
        meta: &Meta,
        q: &JointVector,
        dq: &JointVector,
        ee: &EndEffector,
        load: &Load,
    ) {
        let (gravity, tilted) = (meta.gravity.into(), meta.gravity_alt.into());
        let all = model.dynamics(q, dq, ee, load, &gravity);
        for (name, got, want, tolerance) in [
            ("mass", model.mass(q, load).as_slice(), &self.mass[..], MASS),
            (
                "Coriolis",
                model.coriolis(q, dq, load).as_slice(),
                &self.coriolis,
                TORQUE,
            ),
            (
                "gravity",
                model.gravity(q, load, &gravity).as_slice(),
                &self.gravity,
                TORQUE,
            ),
            (
                "gravity, tilted",
                model.gravity(q, load, &tilted).as_slice(),
                &self.gravity_alt,
                TORQUE,
            ),
            (
                "one pass: pose",
                all.pose.as_slice(),
                &self.frames.pose[..16],
                POSE,
            ),
            (
                "one pass: Jacobian",
                all.jacobian.as_slice(),
                &self.frames.zero_jacobian[..42],
                JACOBIAN,
            ),
            ("one pass: mass", all.mass.as_slice(), &self.mass[..], MASS),
            (
                "one pass: Coriolis",
                all.coriolis.as_slice(),
                &self.coriolis,
                TORQUE,
            ),
            (
                "one pass: gravity",
                all.gravity.as_slice(),
                &self.gravity,
                TORQUE,
            ),
        ] {
            case.near(name, got, want, tolerance);
        }
    }
}
