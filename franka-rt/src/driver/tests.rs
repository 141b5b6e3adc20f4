//! The driver beside states that a robot should not send.

use franka_model::{Model, READY};
use franka_proto::{ControllerMode, MotionGeneratorMode, RobotMode, RobotState, Version};

use super::*;
use crate::law::Gains;
use crate::session::{Budget, Goal, GoalId, Target, TargetSession, Then, Tolerance};
use crate::slot;

const MODES: Modes = Modes {
    generator: MotionGeneratorMode::None,
    controller: ControllerMode::ExternalController,
};

fn moving(time: u64) -> RobotState {
    RobotState {
        message_id: time,
        q: READY.into(),
        motion_generator_mode: MODES.generator,
        controller_mode: MODES.controller,
        robot_mode: RobotMode::Move,
        ..RobotState::default()
    }
}

fn armed(target: Target) -> Driver {
    let (mut goals, reader) = slot::slot();
    goals.write(&Goal {
        id: GoalId(1),
        target,
        then: Then::Finish,
        budget: Budget::of(Model::fr3().joint_limits()),
        gains: Gains::joint(),
        tolerance: Tolerance::default(),
    });
    let mut driver = Driver::new(Version::V10);
    driver.on_order(Order::Arm {
        motion: MotionId(1),
        modes: MODES,
        program: Program::Target(Box::new(TargetSession::new(Model::fr3(), reader))),
        log: ControlLog::with_capacity(5),
    });
    driver
}

#[test]
fn a_state_that_is_not_finite_gets_no_answer_and_does_no_harm() {
    let mut target: [f64; 7] = READY.into();
    target[0] += 0.1;
    for spoil in [
        |state: &mut RobotState| state.q[3] = f64::NAN,
        |state: &mut RobotState| state.dq[0] = f64::INFINITY,
        |state: &mut RobotState| state.tau_J_d[6] = f64::NAN,
    ] {
        let mut driver = armed(Target::Joints(target));
        let mut time = 100;
        for step in 0..60 {
            time += 1;
            let mut state = moving(time);
            let bad = step < 2 || step % 7 == 0;
            if bad {
                spoil(&mut state);
            }
            let command = driver.on_state(&state);
            assert_eq!(command.is_none(), bad, "cycle {step}");
            if let Some(command) = command {
                assert!(command.tau_J_d.iter().all(|tau| tau.is_finite()));
            }
        }
        let mut state = moving(time + 1);
        state.q[3] = f64::NAN;
        state.robot_mode = RobotMode::Reflex;
        assert!(driver.on_state(&state).is_none());
        assert!(driver.is_watching(), "a reflex is seen all the same");
    }
}
