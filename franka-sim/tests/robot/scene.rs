//! A robot with objects that it touches.

use std::any::Any;

use franka_model::READY;
use franka_proto::gripper::{self, Grasp, Reply, Request as HandRequest, Status as HandStatus};
use nalgebra::{Isometry3, Vector3};

use crate::pair::*;
use franka_sim::end_effector::{Fingers, Hand};
use franka_sim::plant::{MujocoArm, Scene};
use franka_sim::{Config, Tool};

/// Position of the fingertips in the ready pose: x and z, `[m]`.
const TCP: (f64, f64) = (0.306_89, 0.486_88);

/// A robot with a hand, and the client of both. One counter represents time.
struct Cell {
    pair: Pair,
    hand: Hand,
    grip: gripper::Client,
    /// State in the hand's newest datagram.
    state: gripper::State,
}

impl Cell {
    /// Puts a box of 40 mm and 200 g, with this friction, on a column between the fingers.
    fn with_box(kind: RobotKind, friction: f64) -> Self {
        let ((x, z), top) = (TCP, TCP.1 - 0.02);
        let height = top / 2.0;
        let scene = format!(
            "<mujoco><worldbody>\
             <geom type='box' size='0.015 0.015 {height}' pos='{x} 0 {height}'/>\
             <body name='box' pos='{x} 0 {z}'><freejoint/>\
             <geom type='box' size='0.02 0.02 0.02' mass='0.2' friction='{friction} 0.005 0.0001'/>\
             </body></worldbody></mujoco>"
        );
        Self::of(kind, &scene)
    }

    fn new(scene: &str) -> Self {
        Self::of(RobotKind::Fr3, scene)
    }

    fn of(kind: RobotKind, scene: &str) -> Self {
        let config = Config {
            kind,
            tool: Tool::hand(),
            ..Config::default()
        };
        let scene = Scene::mjcf(scene).with_hand();
        let arm = MujocoArm::new(config.kind, scene).expect("a scene");
        let mut cell = Self {
            pair: Pair::with(Robot::with_plant(config, Box::new(arm))),
            hand: Hand::new(Fingers::new()),
            grip: gripper::Client::new(gripper::Version::V3),
            state: gripper::State::default(),
        };
        assert!(cell.hand.connect());
        let hello = cell.grip.connect(PORT + 1);
        cell.hand.receive(hello.as_bytes()).expect("a handshake");
        assert!(cell.replies().is_empty() && cell.grip.is_connected());
        cell
    }

    /// Returns the answers of the hand so far.
    fn replies(&mut self) -> Vec<(CommandId, HandStatus)> {
        let mut answers = Vec::new();
        while let Some(reply) = self.hand.take_reply() {
            let message = gripper::next_message(&reply).expect("a message");
            let message = message.expect("the whole of it");
            if let client::Event::Reply {
                id,
                reply: Reply::Done(status),
                ..
            } = self.grip.on_message(message).expect("a conforming hand")
            {
                answers.push((id, status));
            }
        }
        answers
    }

    fn tick(&mut self, command: Option<RobotCommand>) -> Vec<(CommandId, HandStatus)> {
        self.pair.tick(command);
        self.pair.robot.couple(&mut self.hand);
        if let Some(datagram) = self.hand.tick() {
            self.state = gripper::State::decode(datagram.bytes).expect("a state");
        }
        self.replies()
    }

    /// Makes the hand execute a request, and returns its result.
    fn ask(&mut self, request: &HandRequest) -> HandStatus {
        let message = self.grip.request(request).expect("a session");
        self.hand.receive(message.as_bytes()).expect("a request");
        for _ in 0..10_000 {
            let answers = self.tick(None);
            if let [(id, status)] = answers[..] {
                assert_eq!(id, message.id());
                return status;
            }
        }
        panic!("{request:?} takes longer than 10 s");
    }

    fn grasp(&mut self) -> HandStatus {
        assert_eq!(self.ask(&HandRequest::Homing), HandStatus::Success);
        let grasp = Grasp::new(0.04, 0.1, 40.0);
        self.ask(&HandRequest::Grasp(grasp))
    }

    /// Leans the arm back by a quarter of a radian within 2 s. This lifts the hand.
    fn lift(&mut self) {
        let id = self.pair.start_joints();
        let from = self.pair.q_d();
        let mut to = JointVector::zeros();
        to[1] = -0.25;
        for cycle in 0..2500 {
            let q_c = from + to * ramp(f64::from(cycle) * 1e-3, 2.0);
            self.tick(Some(positions(&q_c)));
        }
        assert_eq!(self.pair.statuses(id).len(), 1, "the motion goes on");
        let finished = RobotCommand {
            motion_generation_finished: true,
            ..positions(&(from + to))
        };
        self.tick(Some(finished));
        assert_eq!(self.pair.outcome(id), MoveStatus::Success);
        for _ in 0..1000 {
            self.tick(None);
        }
    }

    /// Returns the estimated vertical force, `[N]`; positive for a load in the hand.
    fn weight(&self) -> f64 {
        self.pair.state.O_F_ext_hat_K[2]
    }

    fn pose(&self, name: &str) -> Isometry3<f64> {
        let plant: &dyn Any = self.pair.robot.plant();
        let arm = plant
            .downcast_ref::<MujocoArm>()
            .expect("the arm in MuJoCo");
        arm.body_pose(name).expect("a body")
    }

    fn height(&self, name: &str) -> f64 {
        self.pose(name).translation.z
    }

    /// Returns the position of the box relative to the hand, `[m]`.
    fn in_hand(&self) -> Vector3<f64> {
        let inside = self.pose("franka_hand").inverse() * self.pose("box");
        inside.translation.vector
    }
}

#[test]
fn box_is_grasped_lifted_and_felt() {
    for kind in RobotKind::ALL {
        let mut cell = Cell::with_box(kind, 1.0);
        for _ in 0..500 {
            cell.tick(None);
        }
        let before = cell.weight();
        let hand = cell.height("franka_hand");
        assert_eq!(cell.grasp(), HandStatus::Success);
        assert!(cell.state.is_grasped);
        let held = cell.in_hand();
        cell.lift();
        let width = cell.state.width;
        assert!(cell.state.is_grasped, "{kind:?}");
        assert!((width - 0.04).abs() < 1e-3, "{kind:?}: {width} m");
        let lifted = cell.height("franka_hand") - hand;
        assert!(lifted > 0.05, "{kind:?}: the hand rises by {lifted} m");
        let slipped = (cell.in_hand() - held).norm();
        assert!(slipped < 2e-3, "{kind:?}: it slips by {slipped} m");
        let felt = cell.weight() - before;
        println!("{kind:?}: lifted by {lifted} m, slipped by {slipped} m, weighs {felt} N");
        assert!((felt - 0.2 * 9.81).abs() < 0.1, "{kind:?}: {felt} N");
        // After the release, the box is no longer in the hand.
        let open = gripper::Move {
            width: 0.07,
            speed: 0.1,
        };
        assert_eq!(cell.ask(&HandRequest::Move(open)), HandStatus::Success);
        for _ in 0..500 {
            cell.tick(None);
        }
        assert!(!cell.state.is_grasped);
        let fallen = (cell.in_hand() - held).norm();
        assert!(fallen > 0.05, "{kind:?}: it has fallen by {fallen} m");
        let felt = cell.weight() - before;
        assert!(felt.abs() < 0.1, "{kind:?}: {felt} N of nothing");
    }
}

#[test]
fn a_slippery_box_is_lost_and_the_hand_says_so() {
    for kind in RobotKind::ALL {
        let mut cell = Cell::with_box(kind, 0.01);
        let start = cell.height("box");
        let before = cell.weight();
        assert_eq!(cell.grasp(), HandStatus::Success);
        assert!(cell.state.is_grasped);
        cell.lift();
        assert!(!cell.state.is_grasped, "{kind:?}");
        let width = cell.state.width;
        assert!(width < 0.035, "{kind:?}: {width} m");
        assert!(cell.height("box") < start + 0.01);
        let felt = cell.weight() - before;
        assert!(felt.abs() < 0.1, "{kind:?}: {felt} N of nothing");
    }
}

#[test]
fn a_box_that_is_dropped_into_the_hand_is_grasped() {
    let mut cell = Cell::new(
        "<mujoco><worldbody><geom type='plane' size='2 2 1'/>\
         <body name='box' pos='0.6 0.3 0.02'><freejoint/>\
         <geom type='box' size='0.02 0.02 0.02' mass='0.2' friction='1 0.005 0.0001'/>\
         </body></worldbody></mujoco>",
    );
    assert_eq!(cell.ask(&HandRequest::Homing), HandStatus::Success);
    let nearly = gripper::Move {
        width: 0.042,
        speed: 0.1,
    };
    assert_eq!(cell.ask(&HandRequest::Move(nearly)), HandStatus::Success);
    let tips = Isometry3::translation(TCP.0, 0.0, TCP.1 + 0.005);
    let plant: &mut dyn Any = cell.pair.robot.plant_mut();
    let arm: &mut MujocoArm = plant.downcast_mut().expect("the arm in MuJoCo");
    assert!(arm.put_body("box", &tips));
    assert!(!arm.put_body("franka_hand", &tips), "the robot's own");
    assert!(!arm.put_body("ball", &tips), "there is none");
    let grasp = Grasp::new(0.04, 0.1, 40.0);
    assert_eq!(cell.ask(&HandRequest::Grasp(grasp)), HandStatus::Success);
    for _ in 0..1000 {
        cell.tick(None);
    }
    assert!(cell.state.is_grasped);
    assert!((cell.height("box") - TCP.1).abs() < 0.015);
}

#[test]
fn grasp_of_nothing_is_unsuccessful() {
    let mut cell = Cell::new("<mujoco/>");
    assert_eq!(cell.grasp(), HandStatus::Unsuccessful);
    assert!(!cell.state.is_grasped);
    assert!(cell.state.width < 1e-3);
}

#[test]
fn the_width_of_the_hand_is_that_of_the_fingers_in_the_scene() {
    let mut cell = Cell::new("<mujoco/>");
    assert_eq!(cell.ask(&HandRequest::Homing), HandStatus::Success);
    let wanted = franka_proto::gripper::Move {
        width: 0.03,
        speed: 0.05,
    };
    assert_eq!(cell.ask(&HandRequest::Move(wanted)), HandStatus::Success);
    for _ in 0..500 {
        cell.tick(None);
    }
    let width = cell.state.width;
    assert!((width - 0.03).abs() < 3e-4, "{width} m");
}

#[test]
fn obstacle_is_felt_where_it_stands() {
    let ((x, z), top) = (TCP, TCP.1 - 0.03);
    let height = top / 2.0;
    let mut cell = Cell::new(&format!(
        "<mujoco><worldbody><geom type='box' size='0.1 0.1 {height}' pos='{x} 0 {height}'/>\
         </worldbody></mujoco>"
    ));
    assert!(z > top);
    cell.pair.start_joints();
    let from = cell.pair.q_d();
    let mut to = JointVector::zeros();
    to[1] = 0.08;
    for cycle in 0..3000 {
        let q_c = from + to * ramp(f64::from(cycle) * 1e-3, 2.5);
        cell.tick(Some(positions(&q_c)));
        if cell.pair.state.robot_mode != RobotMode::Move {
            break;
        }
    }
    // The robot pushes down on the block.
    let felt = cell.pair.state.O_F_ext_hat_K[2];
    assert!(felt < -10.0, "{felt} N");
    assert!((cell.pair.q() - READY).amax() < 0.08);
}
