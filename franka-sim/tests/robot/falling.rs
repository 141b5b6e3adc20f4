//! A hand that descends to a table, on every plant. The configured thresholds stop the hand, but
//! thresholds that are 30 % higher do not.

use std::any::Any;

use franka_model::Load;
use franka_proto::CollisionBehavior;
use nalgebra::{Matrix3, Vector3};

use crate::pair::*;
use crate::plants::robots;
use franka_sim::Touch;
use franka_sim::config::Tool;
use franka_sim::plant::RigidArm;

const HIGH: f64 = 1e4;

/// The threshold under test. All other thresholds are too high to be reached.
#[derive(Debug, Clone, Copy)]
enum Threshold {
    /// Threshold of the wrench at the stiffness frame, `[N, N·m]`.
    Force(f64),
    /// Threshold of the joints, `[N·m]`.
    Torque(f64),
}

impl Threshold {
    fn behavior(self) -> CollisionBehavior {
        let (torque, force) = match self {
            Self::Force(bound) => (HIGH, bound),
            Self::Torque(bound) => (bound, HIGH),
        };
        CollisionBehavior::uniform([HIGH; 7], [torque; 7], [HIGH; 6], [force; 6])
    }

    /// Returns the largest of the values that the robot compares with the threshold.
    fn felt(self, state: &RobotState) -> f64 {
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        match self {
            Self::Force(_) => largest(&state.K_F_ext_hat_K),
            Self::Torque(_) => largest(&state.tau_ext_hat_filtered),
        }
    }

    fn at(self, bound: f64) -> Self {
        match self {
            Self::Force(_) => Self::Force(bound),
            Self::Torque(_) => Self::Torque(bound),
        }
    }

    fn reflex(self) -> RobotError {
        match self {
            Self::Force(_) => RobotError::CartesianReflex,
            Self::Torque(_) => RobotError::JointReflex,
        }
    }
}

/// Returns a robot whose fingertips are 9 cm above the base and point down.
fn above_the_table() -> Config {
    Config {
        q: JointVector::from([0.0, 0.37, 0.0, -2.35, 0.0, 2.72, 0.785]),
        tool: Tool::hand(),
        ..Config::default()
    }
}

#[derive(Debug, Clone, Copy)]
enum Descent {
    /// The client commands 0.1 m/s, to a point 3 cm below the table.
    Commanded,
    /// The client lets the arm yield, and the hand carries an undeclared kilogram.
    Free,
}

struct Landing {
    /// Largest value until the motion ended or the hand reached the table.
    most: f64,
    before: f64,
    cycle: usize,
    state: RobotState,
}

/// Lets the hand descend to the table of the scene, or without a scene to a table that only the
/// fingertips can touch.
fn come_down(pair: &mut Pair, descent: Descent, threshold: Threshold) -> Landing {
    pair.request(&Request::SetCollisionBehavior(threshold.behavior()));
    let plant: &dyn Any = pair.robot.plant();
    if plant.is::<RigidArm>() {
        // In MuJoCo, the scene contains a table, which every part of the hand can touch.
        let table = Touch::wall(Vector3::zeros(), Vector3::z());
        pair.robot.touch(table);
    }
    let height = |pair: &Pair| pair.state.O_T_EE[14];
    let start = height(pair);
    match descent {
        Descent::Commanded => {
            pair.start(
                MoveControllerMode::CartesianImpedance,
                MoveGeneratorMode::CartesianVelocity,
            );
        }
        Descent::Free => {
            pair.robot.attach(Load {
                mass: 1.0,
                com: Vector3::new(0.0, 0.0, 0.08),
                inertia: Matrix3::identity() * 1e-3,
            });
            pair.start_torques();
        }
    }
    let way = start + 0.03;
    let mut landing = Landing {
        most: 0.0,
        before: 0.0,
        cycle: 0,
        state: pair.state,
    };
    for cycle in 0..2000 {
        let mut command = RobotCommand::default();
        if let Descent::Commanded = descent {
            let t = cycle as f64 * 1e-3;
            let end = way / 0.1;
            command.O_dP_EE_c[2] = -0.1 * (ramp(t, 0.1) - ramp(t - end, 0.1));
        }
        pair.tick(Some(command));
        landing.state = pair.state;
        if pair.state.robot_mode != RobotMode::Move {
            break;
        }
        let felt = threshold.felt(&pair.state);
        if height(pair) > 0.02 {
            landing.before = landing.before.max(felt);
        }
        if felt > landing.most {
            (landing.most, landing.cycle) = (felt, cycle);
        }
    }
    landing
}

#[test]
fn fall_trips_its_thresholds_but_none_30_percent_higher() {
    for descent in [Descent::Commanded, Descent::Free] {
        for kind in [Threshold::Force(HIGH), Threshold::Torque(HIGH)] {
            let count = robots(&above_the_table()).len();
            for n in 0..count {
                let fall = |threshold| {
                    let (name, mut pair) = robots(&above_the_table()).swap_remove(n);
                    (name, come_down(&mut pair, descent, threshold))
                };
                let (name, free) = fall(kind);
                let name = format!("{name}, {descent:?}, {:?}", kind.reflex());
                println!(
                    "{name}: {} before, {} at {}",
                    free.before, free.most, free.cycle
                );
                assert!(
                    free.state.errors.is_empty(),
                    "{name}: {}",
                    free.state.errors
                );
                assert!(free.most > 2.0 * free.before, "{name}: no blow");
                // The impact is 1.15 times this threshold.
                let bound = free.most / 1.15;
                let (_, tripped) = fall(kind.at(bound));
                assert_eq!(tripped.state.errors, kind.reflex().into(), "{name}");
                let (_, passed) = fall(kind.at(1.3 * bound));
                assert!(passed.state.errors.is_empty(), "{name}");
                assert_eq!(passed.most, free.most, "{name}: another fall");
            }
        }
    }
}
