//! The robot among things that it touches.

use std::any::Any;

use franka_model::READY;
use franka_proto::gripper::{Grasp, Request as HandRequest, Status as HandStatus};

use super::*;
use crate::end_effector::{Fingers, Hand, Mechanism as _};
use crate::plant::{MujocoArm, Scene};
use crate::{Config, Tool};

/// Where the fingertips are in the ready pose: x and z, `[m]`.
const TCP: (f64, f64) = (0.306_89, 0.486_88);

/// A robot with a hand, and its client; time is one counter.
struct Cell {
    pair: Pair,
    hand: Hand,
}

impl Cell {
    /// Between the fingers, a box of 40 mm and 200 g with this friction stands on a column.
    fn with_box(friction: f64) -> Self {
        let ((x, z), top) = (TCP, TCP.1 - 0.02);
        let height = top / 2.0;
        Self::new(&format!(
            "<mujoco><worldbody>\
             <geom type='box' size='0.015 0.015 {height}' pos='{x} 0 {height}'/>\
             <body name='box' pos='{x} 0 {z}'><freejoint/>\
             <geom type='box' size='0.02 0.02 0.02' mass='0.2' friction='{friction} 0.005 0.0001'/>\
             </body></worldbody></mujoco>"
        ))
    }

    fn new(scene: &str) -> Self {
        let config = Config {
            tool: Tool::hand(),
            ..Config::default()
        };
        let scene = Scene::mjcf(scene).with_hand();
        let arm = MujocoArm::new(config.kind, scene).expect("a scene");
        Self {
            pair: Pair::with(Robot::with_plant(config, Box::new(arm))),
            hand: Hand::new(Fingers::new()),
        }
    }

    fn tick(&mut self, command: Option<RobotCommand>) -> Option<HandStatus> {
        self.pair.tick(command);
        self.pair.robot.couple(&mut self.hand);
        self.hand.mechanism_mut().tick()
    }

    /// Lets the hand do something, and says how it ended.
    fn ask(&mut self, request: &HandRequest) -> HandStatus {
        if let Some(status) = self.hand.mechanism_mut().begin(request) {
            return status;
        }
        for _ in 0..10_000 {
            if let Some(status) = self.tick(None) {
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

    /// Leans the arm back by a quarter of a radian within 2 s, which lifts the hand.
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
    }

    fn height(&self, name: &str) -> f64 {
        let plant: &dyn Any = self.pair.robot.plant();
        let arm = plant
            .downcast_ref::<MujocoArm>()
            .expect("the arm in MuJoCo");
        arm.body_pose(name).expect("a body").translation.z
    }
}

#[test]
fn a_box_is_grasped_lifted_and_felt() {
    let mut cell = Cell::with_box(1.0);
    for _ in 0..500 {
        cell.tick(None);
    }
    let before = cell.pair.state.O_F_ext_hat_K[2];
    let (start, hand) = (cell.height("box"), cell.height("franka_hand"));
    assert_eq!(cell.grasp(), HandStatus::Success);
    cell.lift();
    let state = cell.hand.state();
    assert!(state.is_grasped);
    assert!((state.width - 0.04).abs() < 1e-3, "{} m", state.width);
    let lifted = cell.height("franka_hand") - hand;
    assert!(lifted > 0.05, "the hand rises by {lifted} m");
    assert!((cell.height("box") - start - lifted).abs() < 0.01);
    // 200 g hang on it.
    let felt = cell.pair.state.O_F_ext_hat_K[2] - before;
    assert!((felt - 1.96).abs() < 0.3, "{felt} N");
}

#[test]
fn a_slippery_box_is_lost_and_the_hand_says_so() {
    let mut cell = Cell::with_box(0.01);
    let start = cell.height("box");
    assert_eq!(cell.grasp(), HandStatus::Success);
    assert!(cell.hand.state().is_grasped);
    cell.lift();
    let state = cell.hand.state();
    assert!(!state.is_grasped);
    assert!(state.width < 0.035, "{} m", state.width);
    assert!(cell.height("box") < start + 0.01);
}

#[test]
fn nothing_is_grasped_where_nothing_is() {
    let mut cell = Cell::new("<mujoco/>");
    assert_eq!(cell.grasp(), HandStatus::Unsuccessful);
    assert!(!cell.hand.state().is_grasped);
    assert!(cell.hand.state().width < 1e-3);
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
    let state = cell.hand.state();
    assert!((state.width - 0.03).abs() < 3e-4, "{} m", state.width);
}

#[test]
fn what_stands_in_the_way_is_felt_where_it_is() {
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
