//! Two arms that face each other and hold the ends of one bar, in one world of MuJoCo.

mod arriving;
mod held_back;

use std::any::Any;

use franka_lockstep::{Lockstep, force_of, outcomes_of, pose_of};
use franka_model::{EndEffector, READY, RobotKind};
use franka_proto::{CollisionBehavior, Request};
use franka_rt::lifecycle::{Engagement, MotionError};
use franka_rt::session::{ForceCap, Goal, GoalId, OnArrival, Target, Tolerance};
use franka_rt::team::{Coordinator, team};
use franka_sim::arm::Family;
use franka_sim::plant::{Mount, Scene, SharedArm, shared_world};
use franka_sim::{Arm, Config, Robot, Touch, TouchId};
use franka_tests::thorough;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// Distance of the bases, which face each other, `[m]`.
const APART: f64 = 1.2;

/// Mass of the bar, `[kg]`; neither robot knows it.
const MASS: f64 = 0.6;

/// With how much force the springs of each arm may press, `[N]`.
const CAP: f64 = 20.0;

/// Two robots that stick and lag as real arms do, and the bar between their flanges.
struct Carriers {
    robots: [Lockstep; 2],
    sessions: [GoalId; 2],
    coordinator: Coordinator,
    /// The greatest internal force so far, `[N]`.
    strain: f64,
    ticks: u64,
}

fn bases() -> [Isometry3<f64>; 2] {
    let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI);
    let other = Isometry3::from_parts(Translation3::new(APART, 0.0, 0.0), turned);
    [Isometry3::identity(), other]
}

/// Pose of the bar at the start, in the world.
fn bar() -> Isometry3<f64> {
    let flange = pose_of(&READY, &EndEffector::default());
    Translation3::new(APART / 2.0, 0.0, flange.translation.z).into()
}

fn scene() -> Scene {
    let numbers = |pose: &Isometry3<f64>| {
        let (p, r) = (pose.translation, pose.rotation);
        format!("{} {} {} {} {} {} {}", p.x, p.y, p.z, r.w, r.i, r.j, r.k)
    };
    let flange = pose_of(&READY, &EndEffector::default());
    let half = APART / 2.0 - flange.translation.x;
    let [left, right] = [(bases()[0], -half), (bases()[1], half)].map(|(base, end)| {
        let end = bar() * Translation3::new(end, 0.0, 0.0);
        numbers(&((base * flange).inverse() * end))
    });
    let z = bar().translation.z;
    // A grasp yields by less than a millimetre under the forces here.
    let grasp = "solref='0.01 1'";
    Scene::mjcf(format!(
        "<mujoco><worldbody><body name='bar' pos='{} 0 {z}'><freejoint/>
           <geom type='box' size='{half} 0.01 0.01' mass='{MASS}' contype='0' conaffinity='0'/>
           <body name='left_end' pos='-{half} 0 0'/><body name='right_end' pos='{half} 0 0'/>
         </body></worldbody><equality>
           <weld body1='left_flange' body2='left_end' relpose='{left}' {grasp}/>
           <weld body1='right_flange' body2='right_end' relpose='{right}' {grasp}/>
         </equality></mujoco>",
        APART / 2.0
    ))
}

impl Carriers {
    fn new() -> Self {
        Self::pair(0)
    }

    /// The central arm of the realistic family twice, or two sampled arms of it. They stick
    /// differently, and each reports its hand some millimetres from its true position.
    fn pair(number: u64) -> Self {
        let (kind, family) = (RobotKind::Fr3, Family::realistic());
        let sampled = |seed| Arm::sample(kind, seed, &family);
        Self::with(match number {
            0 => [Arm::realistic(kind), Arm::realistic(kind)],
            pair => [sampled(2 * pair), sampled(2 * pair + 1)],
        })
    }

    fn with(arms: [Arm; 2]) -> Self {
        let kind = RobotKind::Fr3;
        let [left, right] = bases();
        let mount = |name: &str, base| Mount {
            kind,
            name: name.into(),
            base,
        };
        let plants = shared_world(scene(), [mount("left", left), mount("right", right)]);
        let mut arms = arms.into_iter();
        let mut robots = plants.expect("a world").map(|plant| {
            let config = Config {
                kind,
                arm: arms.next(),
                ..Config::default()
            };
            Lockstep::with_robot(Robot::with_plant(config, Box::new(plant)))
        });
        let tolerant = CollisionBehavior::uniform([100.0; 7], [100.0; 7], [100.0; 6], [100.0; 6]);
        for robot in &mut robots {
            robot.request(&Request::SetCollisionBehavior(tolerant));
        }
        let (coordinator, members) = team::<2>();
        let mut this = Self {
            robots,
            sessions: [GoalId::default(); 2],
            coordinator,
            strain: 0.0,
            ticks: 0,
        };
        this.run(5);
        for (i, member) in members.into_iter().enumerate() {
            this.sessions[i] = this.robots[i].begin_session(Engagement {
                team: Some(member),
                ..Engagement::default()
            });
        }
        this.run(200);
        this
    }

    fn tick(&mut self) {
        self.ticks += 1;
        for robot in &mut self.robots {
            robot.tick();
        }
        self.strain = self.strain.max(self.internal().norm());
    }

    fn run(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds {
            self.tick();
        }
    }

    fn arm(&self, member: usize) -> &SharedArm {
        let plant: &dyn Any = self.robots[member].robot.plant();
        plant.downcast_ref().expect("an arm in a shared world")
    }

    fn bar(&self) -> Isometry3<f64> {
        self.arm(0).body_pose("bar").expect("there is a bar")
    }

    /// Force of the bar on a flange, in the axes of the world, `[N]`.
    fn force_on(&self, member: usize) -> Vector3<f64> {
        let q = self.robots[member].robot.q();
        bases()[member].rotation * force_of(q, &self.arm(member).contact_torque())
    }

    /// The force with which the arms pull at each other through the bar, `[N]`: the part that
    /// neither carries nor moves it.
    fn internal(&self) -> Vector3<f64> {
        (self.force_on(0) - self.force_on(1)) / 2.0
    }

    fn hand(&self, member: usize) -> Isometry3<f64> {
        pose_of(self.robots[member].robot.q(), &EndEffector::default())
    }

    fn until_resolved(&mut self, goals: [GoalId; 2], most: u64) -> [Result<(), MotionError>; 2] {
        for _ in 0..most {
            if let Some(outcomes) = outcomes_of(self.robots.each_ref(), goals) {
                return outcomes;
            }
            self.tick();
        }
        panic!("unresolved after {most} ms");
    }
}

/// Largest internal force at an impact, `[N]`: the force cap, plus the forces from the inertia of
/// the bar and the arms.
const MOST: f64 = CAP + 15.0;

/// Pairs of arms. The bounds below hold for all 12; the sample has the worst ones.
fn pairs(sample: &'static [u64]) -> Vec<u64> {
    match thorough() {
        true => (0..12).collect(),
        false => sample.to_vec(),
    }
}

impl Carriers {
    /// Begins to carry the bar to this pose in the world, with the poses of the hands kept.
    fn carry(&mut self, to: Isometry3<f64>) -> [GoalId; 2] {
        self.carry_within(to, None)
    }

    fn carry_within(&mut self, to: Isometry3<f64>, tolerance: Option<Tolerance>) -> [GoalId; 2] {
        let round = Some(self.coordinator.begin());
        let grasps = self.grasps();
        [0, 1].map(|i| {
            let grasp = grasps[i];
            let target = Target::Pose(bases()[i].inverse() * to);
            let goal = self.robots[i].goal(target, OnArrival::ReportAndHold);
            let goal = Goal {
                round,
                grasp: Some(grasp),
                tolerance,
                force_cap: ForceCap::Newtons(CAP),
                ..goal
            };
            let session = self.sessions[i];
            let taken = self.robots[i].submit_within(session, goal);
            taken.expect("the session takes it")
        })
    }

    /// Pose of the bar in each hand, according to the hand's reference.
    fn grasps(&self) -> [Isometry3<f64>; 2] {
        let bar = self.bar();
        self.references().map(|hand| hand.inverse() * bar)
    }

    /// Distance of the bar from its reference, for the arm that is farther behind, as each measures
    /// it. Turns count as 0.2 m per radian, `[m]`.
    fn lag(&self, grasps: &[Isometry3<f64>; 2]) -> f64 {
        let of = |i: usize| {
            let robot = &self.robots[i];
            let reference = robot.reference_pose() * grasps[i];
            let arm = robot.pose_at(&robot.client.state.q.into()) * grasps[i];
            let way = reference.translation.vector - arm.translation.vector;
            way.norm() + 0.2 * reference.rotation.angle_to(&arm.rotation)
        };
        of(0).max(of(1))
    }

    /// Change of the distance between the arms' references since they began to hold the bar, `[m]`.
    fn gap(&self, begun: &Isometry3<f64>) -> f64 {
        let [left, right] = self.references();
        (left.inverse() * right)
            .translation
            .vector
            .metric_distance(&begun.translation.vector)
    }

    fn references(&self) -> [Isometry3<f64>; 2] {
        [0, 1].map(|i| bases()[i] * self.robots[i].reference_pose())
    }

    /// A wall at this distance above the left hand, which withstands any force.
    fn wall_above(&mut self, distance: f64) -> TouchId {
        let hand = self.robots[0].robot.true_pose().translation.vector;
        let wall = Touch::wall(hand + Vector3::z() * distance, -Vector3::z());
        self.robots[0].robot.touch(wall.stiffness(5000.0))
    }
}

/// The bar this much higher, and turned.
fn raised(bar: &Isometry3<f64>, by: f64, yaw: f64, tilt: f64) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_euler_angles(0.0, tilt, yaw);
    let place = bar.translation.vector + Vector3::new(0.0, 0.02, by);
    Isometry3::from_parts(place.into(), turn * bar.rotation)
}
