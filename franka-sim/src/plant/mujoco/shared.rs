//! Several arms in one world. A separate robot moves each arm, and all arms share the same objects.
//!
//! The world takes a step once the drives of all arms have reported their torques. Robots advance
//! one after the other, by a millisecond each. The arm of the first robot runs ahead of the world,
//! on a copy in which the other arms keep their last torques. When the last robot advances, the
//! world takes the missing steps with the true torques of all arms, and every arm reads its
//! position from the world. If the robots are in step, the first robot sees the other arms with a
//! delay of a millisecond at most.

use std::collections::VecDeque;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use franka_model::{CYCLE, JointVector, Load, RobotKind};
use mujoco_rs::prelude::{MjData, MjModel, MjtState};
use nalgebra::Isometry3;

use super::scene::{Places, Scene, SceneError};
use super::{apply, body_pose, link_inertia, mjcf, read};
use crate::arm;
use crate::plant::{External, LinkTorque, Plant, STEPS};

/// Position of an arm in a world that it shares.
#[derive(Debug, Clone, PartialEq)]
pub struct Mount {
    /// Kind of the arm.
    pub kind: RobotKind,
    /// Prefix of the names of the arm's bodies. The arm's flange is the body `{name}_flange`.
    pub name: String,
    /// Base frame of the arm in the world. The gravity of the first arm, converted to the axes of
    /// the world, applies to all arms.
    pub base: Isometry3<f64>,
}

/// One of several arms in one world of MuJoCo; see [`shared_world`]. It is a plant like
/// [`MujocoArm`](super::MujocoArm), without a hand.
///
/// The times of the robots that move the arms must not differ by more than 10 ms. If a robot is
/// later, the world advances without it, and its drives keep their last torques.
/// [`Sim::in_step`](crate::Sim::in_step) keeps the robots in step.
pub struct SharedArm {
    world: Arc<Mutex<World>>,
    number: usize,
    q: JointVector,
    dq: JointVector,
}

/// Returns `N` arms in one world. They are ideal arms at rest in the ready pose until their robots
/// fit and place them. The MJCF of the scene may name the bodies of the arms. For example, a
/// `<weld>` between a flange and an object represents a grasp.
///
/// # Errors
/// Returns [`SceneError`] if MuJoCo cannot build the scene, or if the scene has a hand.
pub fn shared_world<const N: usize>(
    scene: Scene,
    mounts: [Mount; N],
) -> Result<[SharedArm; N], SceneError> {
    if scene.has_hand() {
        let text = "got an arm with a Hand in a shared world, expected arms without Hands";
        return Err(SceneError::Impossible(text.into()));
    }
    let arms: Vec<_> = mounts.into_iter().map(Standing::ideal).collect();
    let (data, places) = compile(&scene, &arms)?;
    let mut world = World {
        scene,
        arms,
        ahead: copy(&data),
        ahead_is_of: None,
        data,
        places,
    };
    for number in 0..N {
        world.place(number, &franka_model::READY);
    }
    let world = Arc::new(Mutex::new(world));
    Ok(core::array::from_fn(|number| SharedArm {
        world: world.clone(),
        number,
        q: franka_model::READY,
        dq: JointVector::zeros(),
    }))
}

impl SharedArm {
    /// Pose of a body in the world, at the start of the world's last step; `None` if no body has
    /// this name.
    pub fn body_pose(&self, name: &str) -> Option<Isometry3<f64>> {
        body_pose(&self.world().data, name)
    }

    /// Torques that contacts and grasps exert on the joints in the last step of the world, `[N·m]`;
    /// positive torques push towards positive angles.
    pub fn contact_torque(&self) -> JointVector {
        let world = self.world();
        let force = world.data.qfrc_constraint();
        world.places[self.number].dof.map(|dof| force[dof]).into()
    }

    fn world(&self) -> MutexGuard<'_, World> {
        // The world is complete even after a panic, because a panic in MuJoCo ends the process.
        self.world.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Plant for SharedArm {
    fn q(&self) -> &JointVector {
        &self.q
    }

    fn dq(&self) -> &JointVector {
        &self.dq
    }

    /// Rebuilds the world if the arm has changed, which takes milliseconds.
    ///
    /// # Panics
    /// See [`attach`](Self::attach).
    fn fit(&mut self, kind: RobotKind, arm: &arm::Arm) {
        let mut world = self.world();
        let own = &mut world.arms[self.number];
        if (own.kind, &own.arm) != (kind, arm) {
            (own.kind, own.arm) = (kind, arm.clone());
            own.armature = link_inertia(arm);
            world.remake();
        }
    }

    fn step(&mut self, drive: &LinkTorque, external: &External, dt: f64) {
        let mut world = self.world();
        let push = Push {
            drive: *drive,
            external: *external,
        };
        let (q, dq) = world.step(self.number, push, dt);
        drop(world);
        (self.q, self.dq) = (q, dq);
    }

    fn place(&mut self, q: &JointVector) -> JointVector {
        let holding = self.world().place(self.number, q);
        (self.q, self.dq) = (*q, JointVector::zeros());
        holding
    }

    /// Replaces the load and rebuilds the world, which takes milliseconds.
    ///
    /// # Panics
    /// See [`MujocoArm`](super::MujocoArm).
    fn attach(&mut self, load: Load) {
        let mut world = self.world();
        let own = &mut world.arms[self.number];
        if own.load != load {
            own.load = load;
            world.remake();
        }
    }
}

impl fmt::Debug for SharedArm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SharedArm")
            .field("number", &self.number)
            .field("q", &self.q)
            .finish_non_exhaustive()
    }
}

struct World {
    scene: Scene,
    arms: Vec<Standing>,
    places: Vec<Places>,
    data: MjData<Box<MjModel>>,
    /// A copy that runs ahead of `data`.
    ahead: MjData<Box<MjModel>>,
    /// Index of the arm to which the copy belongs; `None` if the copy is out of date.
    ahead_is_of: Option<usize>,
}

struct Standing {
    kind: RobotKind,
    prefix: String,
    base: Isometry3<f64>,
    arm: arm::Arm,
    armature: JointVector,
    load: Load,
    /// Torques of the arm's drives in the steps that the world has not taken yet.
    pending: VecDeque<Push>,
    /// Torques of the arm's drives in the newest known step.
    newest: Push,
    /// Number of steps that the world has taken without this arm.
    missed: usize,
}

#[derive(Clone, Copy)]
struct Push {
    drive: LinkTorque,
    external: External,
}

impl Standing {
    fn ideal(mount: Mount) -> Self {
        let arm = arm::Arm::ideal(mount.kind);
        Self {
            kind: mount.kind,
            prefix: format!("{}_", mount.name),
            base: mount.base,
            armature: link_inertia(&arm),
            arm,
            load: Load::NONE,
            pending: VecDeque::new(),
            newest: Push {
                drive: LinkTorque::ZERO,
                external: External::NONE,
            },
            missed: 0,
        }
    }
}

impl World {
    /// Takes a step of one arm; returns its new positions and velocities.
    fn step(&mut self, number: usize, push: Push, dt: f64) -> (JointVector, JointVector) {
        let own = &mut self.arms[number];
        own.newest = push;
        if own.missed > 0 {
            own.missed -= 1;
            return read(&self.data, &self.places[number]);
        }
        own.pending.push_back(push);
        let late = own.pending.len() > AHEAD_MAX;
        if late || self.arms.iter().all(|arm| !arm.pending.is_empty()) {
            self.catch_up(dt);
        }
        if self.arms[number].pending.is_empty() {
            return read(&self.data, &self.places[number]);
        }
        self.go_ahead(number, dt);
        read(&self.ahead, &self.places[number])
    }

    /// Takes a step of the world with the pending torques. An arm without pending torques misses
    /// this step.
    fn catch_up(&mut self, dt: f64) {
        for (arm, places) in self.arms.iter_mut().zip(&self.places) {
            let push = arm.pending.pop_front().unwrap_or_else(|| {
                arm.missed += 1;
                arm.newest
            });
            push.apply(&mut self.data, places, arm, dt);
        }
        self.data.step();
        self.ahead_is_of = None;
    }

    /// Advances the copy of the world to this arm's step.
    fn go_ahead(&mut self, number: usize, dt: f64) {
        let taken = if self.ahead_is_of == Some(number) {
            self.arms[number].pending.len() - 1
        } else {
            self.ahead
                .copy_state_from_data(&self.data, STATE)
                .expect("two copies of one world");
            0
        };
        for step in taken..self.arms[number].pending.len() {
            for (arm, places) in self.arms.iter().zip(&self.places) {
                arm.push_at(step).apply(&mut self.ahead, places, arm, dt);
            }
            self.ahead.step();
        }
        self.ahead_is_of = Some(number);
    }

    fn place(&mut self, number: usize, q: &JointVector) -> JointVector {
        let places = &self.places[number];
        for i in 0..7 {
            self.data.qpos_mut()[places.qpos[i]] = q[i];
            self.data.qvel_mut()[places.dof[i]] = 0.0;
        }
        self.data.forward();
        let own = &mut self.arms[number];
        own.pending.clear();
        own.missed = 0;
        self.ahead_is_of = None;
        let bias = self.data.qfrc_bias();
        places.dof.map(|dof| bias[dof]).into()
    }

    /// Compiles the world again, and keeps the state.
    fn remake(&mut self) {
        let (data, _) = compile(&self.scene, &self.arms)
            .unwrap_or_else(|error| panic!("the world with other arms: {error}"));
        let state = self.data.state(STATE);
        self.data = data;
        self.data.set_state(&state, STATE).unwrap_or_else(|error| {
            panic!(
                "cannot read the scene again, perhaps its file has \
                changed: {error}"
            )
        });
        self.data.forward();
        self.ahead = copy(&self.data);
        self.ahead_is_of = None;
    }
}

impl Standing {
    /// Torques of the arm's drives, `step` steps after the world's newest step.
    fn push_at(&self, step: usize) -> Push {
        self.pending.get(step).copied().unwrap_or(self.newest)
    }
}

impl Push {
    fn apply(&self, data: &mut MjData<Box<MjModel>>, places: &Places, arm: &Standing, dt: f64) {
        let push = (&self.drive, &self.external, dt);
        apply(data, places, &arm.arm, &arm.armature, push);
    }
}

fn compile(
    scene: &Scene,
    arms: &[Standing],
) -> Result<(MjData<Box<MjModel>>, Vec<Places>), SceneError> {
    let texts: Vec<_> = arms
        .iter()
        .map(|it| {
            let body = &it.arm.body;
            let text = mjcf::arm(it.kind, body, &it.armature, &it.load, false, &it.base);
            (it.prefix.as_str(), text)
        })
        .collect();
    let gravity = arms
        .first()
        .map_or([0.0; 3], |it| it.arm.body.gravity_earth.into());
    let mut model = scene.compile_around(&texts, gravity)?;
    model.opt_mut().timestep = CYCLE / f64::from(STEPS);
    let places = arms.iter().map(|it| Places::of(&model, &it.prefix));
    let places = places.collect::<Result<_, _>>()?;
    Ok((MjData::new(Box::new(model)), places))
}

/// A new world of the same model, in its initial state.
fn copy(data: &MjData<Box<MjModel>>) -> MjData<Box<MjModel>> {
    MjData::new(Box::new(data.model().clone()))
}

/// Flags of the parts of MuJoCo's state that are inputs of a step.
const STATE: u32 = MjtState::mjSTATE_INTEGRATION as u32;

/// Number of steps by which an arm may be ahead of the world: 10 ms.
const AHEAD_MAX: usize = 10 * STEPS as usize;
