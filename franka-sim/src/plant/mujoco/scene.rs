//! The surroundings of the arm, and the MuJoCo model of the arm and its surroundings.

use std::path::{Path, PathBuf};

use franka_model::{JointVector, Load, RobotKind};
use mujoco_rs::mujoco_c::{mjtCone, mjtDisableBit, mjtIntegrator};
use mujoco_rs::prelude::{Attach as _, MjModel, MjSpec, MjtJoint, MjtObjBase};

use nalgebra::Isometry3;

use super::fingers::FingerJoints;
use super::{joint_name, mjcf};
use crate::arm;

/// The surroundings of the arm, and optionally a Franka Hand on its flange.
///
/// Surroundings are written in MJCF, the format of MuJoCo's models. The world of the MJCF is the
/// robot's base frame: x forwards, z up, in metres. Bodies with a free joint are objects that the
/// arm can push and grasp. All elements of MJCF are available. In `<option>`, the simulator
/// overrides `timestep`, `integrator`, `gravity`, `cone` and `impratio`. Names that begin with
/// `franka_` are reserved for the robot.
///
/// ```xml
/// <mujoco>
///   <worldbody>
///     <geom type="box" size="0.5 0.5 0.02" pos="0.5 0 -0.02"/>
///     <body name="block" pos="0.5 0 0.02">
///       <freejoint/>
///       <geom type="box" size="0.02 0.02 0.02" mass="0.2"/>
///     </body>
///   </worldbody>
/// </mujoco>
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Scene {
    surroundings: Surroundings,
    has_hand: bool,
}

#[derive(Debug, Clone, PartialEq, Eq, Default)]
enum Surroundings {
    #[default]
    Table,
    Text(String),
    File(PathBuf),
}

/// Reason why a scene cannot be built. The contained text comes from MuJoCo and names the line of
/// the error.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The surroundings are not valid MJCF.
    #[error("cannot read the scene: {0}")]
    Unreadable(String),
    /// The arm cannot be added to the surroundings.
    #[error("cannot put the robot into the scene: {0}")]
    Conflict(String),
    /// MuJoCo cannot simulate the surroundings.
    #[error("cannot make the scene: {0}")]
    Impossible(String),
    /// A part of the robot is missing from the model. Surroundings cannot cause this error.
    #[error("the scene lacks {0}")]
    Lacks(String),
}

impl Scene {
    /// A table of two by two metres with the robot in the middle. The top of the table is the plane
    /// z = 0. This scene is the default.
    pub fn table() -> Self {
        Self::default()
    }

    /// No surroundings: the arm alone.
    pub fn empty() -> Self {
        Self::mjcf("<mujoco/>")
    }

    /// Surroundings from this MJCF text.
    pub fn mjcf(text: impl Into<String>) -> Self {
        Self {
            surroundings: Surroundings::Text(text.into()),
            has_hand: false,
        }
    }

    /// Surroundings from this MJCF file. Paths in this file are relative to the file's folder.
    pub fn file(path: impl AsRef<Path>) -> Self {
        Self {
            surroundings: Surroundings::File(path.as_ref().to_owned()),
            has_hand: false,
        }
    }

    /// Adds the body and the two fingers of a Franka Hand to the flange. A [`Hand`](crate::Hand)
    /// then moves the fingers. The mass of the Hand is not included, because
    /// [`Tool::hand`](crate::Tool::hand) contains it.
    ///
    /// MuJoCo uses the larger friction of two surfaces, and the fingers have no friction. The
    /// `friction` of the object alone therefore decides how firmly the fingers hold it.
    #[must_use]
    pub fn with_hand(mut self) -> Self {
        self.has_hand = true;
        self
    }

    /// Compiles the surroundings and the arm as one model, and returns the arm's indices in the
    /// model.
    pub(super) fn compile(
        &self,
        kind: RobotKind,
        body: &arm::Body,
        armature: &JointVector,
        load: &Load,
    ) -> Result<(MjModel, Places), SceneError> {
        let base = Isometry3::identity();
        let text = mjcf::arm(kind, body, armature, load, self.has_hand, &base);
        let model = self.compile_around(&[(PREFIX, text)], body.gravity_earth.into())?;
        let places = Places::of(&model, PREFIX)?;
        Ok((model, places))
    }

    /// Compiles the surroundings and these arms as one model. Each arm consists of its MJCF text
    /// and the prefix of its names.
    pub(super) fn compile_around(
        &self,
        arms: &[(&str, String)],
        gravity_earth: [f64; 3],
    ) -> Result<MjModel, SceneError> {
        let mut spec = match &self.surroundings {
            Surroundings::Table => MjSpec::from_xml_string(TABLE),
            Surroundings::Text(text) => MjSpec::from_xml_string(text),
            Surroundings::File(path) => MjSpec::from_xml(path),
        }
        .map_err(|error| SceneError::Unreadable(error.to_string()))?;
        let conflict =
            |error: mujoco_rs::error::MjEditError| SceneError::Conflict(error.to_string());
        for (prefix, text) in arms {
            let mut arm = MjSpec::from_xml_string(text).map_err(conflict)?;
            spec.world_body_mut()
                .attach_by_deep_copy(&mut arm, prefix, "")
                .map_err(conflict)?;
        }
        let mut model = spec
            .compile()
            .map_err(|error| SceneError::Impossible(error.to_string()))?;
        let options = model.opt_mut();
        options.gravity = gravity_earth;
        // With this integrator, MuJoCo treats the dampers of the joints implicitly.
        options.integrator = mjtIntegrator::mjINT_IMPLICITFAST as i32;
        // Without these two options, grasped objects creep: friction is as soft as the contact, and
        // weaker along diagonals.
        options.cone = mjtCone::mjCONE_ELLIPTIC as i32;
        options.impratio = 10.0;
        // Without this option, MuJoCo resets an unstable simulation to its initial state.
        options.disableflags |= mjtDisableBit::mjDSBL_AUTORESET as i32;
        Ok(model)
    }

    pub(super) fn has_hand(&self) -> bool {
        self.has_hand
    }

    pub(super) fn fingers(&self, model: &MjModel) -> Result<Option<FingerJoints>, SceneError> {
        self.has_hand.then(|| FingerJoints::of(model)).transpose()
    }
}

/// Indices of the joints' values in MuJoCo's arrays.
#[derive(Debug, Clone, Copy)]
pub(super) struct Places {
    pub(super) qpos: [usize; 7],
    pub(super) dof: [usize; 7],
    pub(super) damper: [usize; 7],
}

impl Places {
    /// Indices of the arm whose names have this prefix.
    pub(super) fn of(model: &MjModel, prefix: &str) -> Result<Self, SceneError> {
        let mut places = Self {
            qpos: [0; 7],
            dof: [0; 7],
            damper: [0; 7],
        };
        for i in 0..7 {
            let name = joint_name(i);
            (places.qpos[i], places.dof[i]) = joint_of(model, prefix, &name)?;
            places.damper[i] = find(model, MjtObjBase::mjOBJ_ACTUATOR, prefix, &name)?;
        }
        Ok(places)
    }
}

/// Indices of a joint with one coordinate in `qpos` and `qvel`.
pub(super) fn joint(model: &MjModel, name: &str) -> Result<(usize, usize), SceneError> {
    joint_of(model, PREFIX, name)
}

fn joint_of(model: &MjModel, prefix: &str, name: &str) -> Result<(usize, usize), SceneError> {
    let id = find(model, MjtObjBase::mjOBJ_JOINT, prefix, name)?;
    let place = |addresses: &[i32]| addresses[id] as usize;
    Ok((place(model.jnt_qposadr()), place(model.jnt_dofadr())))
}

/// Indices of a body with a free joint in `qpos` and `qvel`.
pub(super) fn free_body(model: &MjModel, name: &str) -> Option<(usize, usize)> {
    let first = model.body_jntadr()[body(model, name)?];
    let joint = usize::try_from(first).ok()?;
    let place = |addresses: &[i32]| addresses[joint] as usize;
    (model.jnt_type()[joint] == MjtJoint::mjJNT_FREE)
        .then(|| (place(model.jnt_qposadr()), place(model.jnt_dofadr())))
}

/// MuJoCo's index of a body.
pub(super) fn body(model: &MjModel, name: &str) -> Option<usize> {
    model.name_to_id(MjtObjBase::mjOBJ_BODY, name)
}

fn find(model: &MjModel, kind: MjtObjBase, prefix: &str, name: &str) -> Result<usize, SceneError> {
    let name = format!("{prefix}{name}");
    model.name_to_id(kind, &name).ok_or(SceneError::Lacks(name))
}

/// Prefix of the names of the robot's parts. The constants after it are the prefixes of the names
/// of joints and of their dampers.
const PREFIX: &str = "franka_";
pub(super) const JOINT: &str = "joint";

const TABLE: &str = r#"
<mujoco>
  <worldbody>
    <body name="table">
      <geom type="box" size="1 1 0.05" pos="0 0 -0.05"/>
    </body>
  </worldbody>
</mujoco>
"#;
