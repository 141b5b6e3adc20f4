//! The arm in MuJoCo, with objects that it touches and fingers that grasp by friction.

mod fingers;
mod mjcf;
mod scene;
mod shared;
#[cfg(test)]
mod tests;

pub use scene::{Scene, SceneError};
pub use shared::{Mount, SharedArm, shared_world};

use franka_model::{CYCLE, JointVector, Load, RobotKind};
use mujoco_rs::prelude::{MjData, MjModel, MjtState};
use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};

use super::{External, FingerDrive, LinkTorque, Plant};
use crate::arm::Arm;
use crate::plant::STEPS;
use fingers::FingerJoints;
use scene::{JOINT, Places};

/// The links of [`Model::physically_consistent`](franka_model::Model::physically_consistent) in
/// MuJoCo, with the end stops of a [`RigidArm`](super::RigidArm) and the surroundings of a
/// [`Scene`].
///
/// Without contact, this arm moves like a `RigidArm`. Each step solves the same equation in the
/// same way, with MuJoCo's own inertia and bias forces. Drives and end stops act as forces, and
/// their slopes act as dampers that the integrator treats implicitly. External torques act in the
/// same way, but a larger diagonal matrix replaces their slope. While something firm touches the
/// arm, the inertia of the joints is therefore up to 0.2 kg·m² higher.
///
/// For contact with the surroundings and between outer and inner links, the links have the capsules
/// of [`Shape::covering`](franka_model::collision::Shape::covering). These capsules are up to 3.5
/// cm thicker than the links. The Hand and its fingers have separate shapes (see
/// [`Scene::with_hand`]).
#[derive(Debug)]
pub struct MujocoArm {
    kind: RobotKind,
    arm: Arm,
    armature: JointVector,
    scene: Scene,
    load: Load,
    data: MjData<Box<MjModel>>,
    places: Places,
    fingers: Option<FingerJoints>,
    q: JointVector,
    dq: JointVector,
}

impl MujocoArm {
    /// An ideal arm of this kind at rest in the ready pose, with a bare flange. The robot that owns
    /// this plant [fits](Plant::fit) it with the parameters of the robot's arm.
    ///
    /// # Errors
    /// Returns [`SceneError`] if MuJoCo cannot build the scene.
    pub fn new(kind: RobotKind, scene: Scene) -> Result<Self, SceneError> {
        let (arm, load) = (Arm::ideal(kind), Load::NONE);
        let armature = link_inertia(&arm);
        let (model, places) = scene.compile(kind, &arm.body, &armature, &load)?;
        let fingers = scene.fingers(&model)?;
        let mut plant = Self {
            kind,
            arm,
            armature,
            scene,
            load,
            data: MjData::new(Box::new(model)),
            places,
            fingers,
            q: franka_model::READY,
            dq: JointVector::zeros(),
        };
        if let Some(fingers) = &plant.fingers {
            fingers.open(&mut plant.data);
        }
        plant.place(&franka_model::READY);
        Ok(plant)
    }

    /// Pose of a body of the scene, in the base frame, at the start of the last step; `None` if no
    /// body has this name. The names of the robot's bodies begin with `franka_`.
    pub fn body_pose(&self, name: &str) -> Option<Isometry3<f64>> {
        body_pose(&self.data, name)
    }

    /// Moves a body of the scene to this pose in the base frame, at rest. Returns false if no body
    /// with a free joint has this name. Objects that overlap the body at its new pose push it away.
    ///
    /// ```no_run
    /// # use std::any::Any;
    /// # use franka_sim::{Robot, plant::MujocoArm};
    /// # fn example(robot: &mut Robot, between_the_fingers: nalgebra::Isometry3<f64>) {
    /// let plant: &mut dyn Any = robot.plant_mut();
    /// let arm: &mut MujocoArm = plant.downcast_mut().expect("made with one");
    /// assert!(arm.put_body("block", &between_the_fingers));
    /// # }
    /// ```
    pub fn put_body(&mut self, name: &str, pose: &Isometry3<f64>) -> bool {
        let Some((qpos, dof)) = scene::free_body(self.data.model(), name) else {
            return false;
        };
        let Vector3 { data, .. } = pose.translation.vector;
        let [[x, y, z]] = data.0;
        let turn = pose.rotation;
        let place = [x, y, z, turn.w, turn.i, turn.j, turn.k];
        self.data.qpos_mut()[qpos..qpos + 7].copy_from_slice(&place);
        self.data.qvel_mut()[dof..dof + 6].fill(0.0);
        self.data.forward();
        true
    }

    /// Torques that contacts exert on the joints in the last step, `[N·m]`; positive torques push
    /// towards positive angles.
    pub fn contact_torque(&self) -> JointVector {
        let force = self.data.qfrc_constraint();
        self.places.dof.map(|dof| force[dof]).into()
    }

    /// Compiles the scene again, and keeps the state.
    fn remake(&mut self) {
        let load = &self.load;
        let (model, _) = self
            .scene
            .compile(self.kind, &self.arm.body, &self.armature, load)
            .unwrap_or_else(|error| panic!("the scene with the load {load:?}: {error}"));
        let everything = MjtState::mjSTATE_INTEGRATION as u32;
        let state = self.data.state(everything);
        self.data = MjData::new(Box::new(model));
        self.data
            .set_state(&state, everything)
            .unwrap_or_else(|error| {
                panic!(
                    "cannot read the scene again, perhaps its file has \
                changed: {error}"
                )
            });
        self.data.forward();
    }

    /// Reads positions and velocities of the joints from MuJoCo.
    fn read(&mut self) {
        (self.q, self.dq) = read(&self.data, &self.places);
    }
}

impl Plant for MujocoArm {
    fn q(&self) -> &JointVector {
        &self.q
    }

    fn dq(&self) -> &JointVector {
        &self.dq
    }

    /// Rebuilds the scene if the arm has changed, which takes milliseconds.
    ///
    /// # Panics
    /// See [`attach`](Self::attach).
    fn fit(&mut self, kind: RobotKind, arm: &Arm) {
        if (self.kind, &self.arm) != (kind, arm) {
            (self.kind, self.arm) = (kind, arm.clone());
            self.armature = link_inertia(arm);
            self.remake();
        }
    }

    fn step(&mut self, drive: &LinkTorque, external: &External, dt: f64) {
        let (places, armature) = (&self.places, &self.armature);
        apply(
            &mut self.data,
            places,
            &self.arm,
            armature,
            (drive, external, dt),
        );
        if let Some(fingers) = &mut self.fingers {
            fingers.drive(&mut self.data, dt);
        }
        self.data.model_opt_mut().timestep = dt;
        self.data.step();
        self.read();
    }

    fn place(&mut self, q: &JointVector) -> JointVector {
        for i in 0..7 {
            self.data.qpos_mut()[self.places.qpos[i]] = q[i];
            self.data.qvel_mut()[self.places.dof[i]] = 0.0;
        }
        self.data.forward();
        self.read();
        let bias = self.data.qfrc_bias();
        self.places.dof.map(|dof| bias[dof]).into()
    }

    /// Replaces the load and rebuilds the scene, which takes milliseconds.
    ///
    /// # Panics
    /// Panics if the load is impossible (a non-finite number, a negative mass), or if the scene's
    /// file has changed.
    fn attach(&mut self, load: Load) {
        if load != self.load {
            self.load = load;
            self.remake();
        }
    }

    fn drive_fingers(&mut self, drive: &FingerDrive) -> Option<f64> {
        let fingers = self.fingers.as_mut()?;
        fingers.set(*drive);
        Some(fingers.width(&self.data))
    }
}

/// Positions and velocities of the joints of an arm.
fn read(data: &MjData<Box<MjModel>>, places: &Places) -> (JointVector, JointVector) {
    let (q, dq) = (data.qpos(), data.qvel());
    (
        places.qpos.map(|place| q[place]).into(),
        places.dof.map(|place| dq[place]).into(),
    )
}

fn body_pose(data: &MjData<Box<MjModel>>, name: &str) -> Option<Isometry3<f64>> {
    let id = scene::body(data.model(), name)?;
    let position = Vector3::from(data.xpos()[id]);
    let [w, x, y, z] = data.xquat()[id];
    let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
    Some(Isometry3::from_parts(position.into(), rotation))
}

/// Sets the forces on an arm for a step of `dt` seconds.
fn apply(
    data: &mut MjData<Box<MjModel>>,
    places: &Places,
    arm: &Arm,
    armature: &JointVector,
    (drive, external, dt): (&LinkTorque, &External, f64),
) {
    let (q, dq) = read(data, places);
    let (stop, stop_slope) = arm.body.stops.resistance(&q, &dq, dt);
    // The model contains only the smallest inertia of the drives. The remaining inertia acts like a
    // damper over one step.
    let rest = (drive.inertia - armature).map(|inertia| inertia.max(0.0));
    let rest = (rest + external.diagonal()) / dt;
    // The dampers subtract slope · dq at the start of the step; the remainder is a force.
    let slope = drive.damping + rest + stop_slope;
    let force = drive.torque + external.torque - stop + slope.component_mul(&dq);
    for i in 0..7 {
        data.ctrl_mut()[places.damper[i]] = slope[i];
        data.qfrc_applied_mut()[places.dof[i]] = force[i];
    }
}

/// Smallest inertia that the drives add to the links, `[kg·m²]`.
fn link_inertia(arm: &Arm) -> JointVector {
    arm.drive.link_inertia(CYCLE / f64::from(STEPS))
}

/// The name of joint `i`, 0 to 6.
fn joint_name(i: usize) -> String {
    format!("{JOINT}{}", i + 1)
}
