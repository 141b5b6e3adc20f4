//! The control cycle, over 10^5 cycles of each program.

use franka_proto::{MoveControllerMode, MoveRequest, RobotMode, RobotState, Version};
use franka_rt::control::{
    AsynchronousPositions, AsynchronousTarget, Callback, CartesianPose, JointVelocities, Torques,
};
use franka_rt::driver::{ControlLog, Driver, Modes, MotionId, Order, Program};
use franka_rt::shaping::Shaper;
use franka_tests::lockstep::Wander;

use crate::calls_during;

#[test]
fn a_hundred_thousand_cycles_of_target_control_allocate_and_free_nothing() {
    let seed = 7;
    let mut wander = Wander::new(seed);
    let (mut cycles, mut calls) = (0, 0);
    while cycles < 100_000 {
        wander.tick_around(|cycle| {
            calls += calls_during(cycle);
            cycles += 1;
        });
    }
    assert!(
        wander.lockstep.client.record.goal > 100,
        "the arm was sent about"
    );
    assert_eq!(
        calls, 0,
        "seed {seed}: calls of the allocator in {cycles} cycles"
    );
}

/// Has `program` answer states of the motion that `request` asks for; counts the calls of the allocator meanwhile.
/// `before` is called ahead of each state, from outside the cycle.
fn calls_of(
    version: Version,
    program: Program,
    request: &MoveRequest,
    mut before: impl FnMut(u64),
) -> u64 {
    const CYCLES: u64 = 100_000;
    let modes = Modes::of(request);
    let mut driver = Driver::new(version);
    driver.on_order(Order::Arm {
        motion: MotionId(1),
        modes,
        program,
        log: ControlLog::with_capacity(50),
    });
    let mut state = RobotState {
        robot_mode: RobotMode::Move,
        motion_generator_mode: modes.generator,
        controller_mode: modes.controller,
        ..RobotState::default()
    };
    let (mut calls, mut commands) = (0, 0);
    for time in 1..=CYCLES {
        before(time);
        state.message_id = time;
        calls += calls_during(|| commands += u64::from(driver.on_state(&state).is_some()));
    }
    assert!(commands >= CYCLES / 10, "{commands} commands");
    calls
}

#[test]
fn control_functions_and_sparse_targets_allocate_and_free_nothing() {
    for version in Version::ALL {
        let shaper = Shaper::new(version, true, 100.0);
        let callbacks = [
            Callback::torques(version, |state, _| Torques(state.tau_J_d)),
            Callback::motion(version, |_, _| JointVelocities([1e-3; 7])),
            Callback::motion(version, |state, _| CartesianPose {
                O_T_EE: state.O_T_EE_c,
                elbow: Some([0.1, 1.0]),
            })
            .with_torques(|_, step| Torques([step.as_secs_f64(); 7])),
        ];
        for callback in callbacks {
            let callback = callback.with_shaper(shaper);
            let request = callback.request(version, MoveControllerMode::JointImpedance);
            let program = Program::Callback(Box::new(callback));
            let calls = calls_of(version, program, &request, |_| {});
            assert_eq!(calls, 0, "{request:?}");
        }
    }
    let (program, mut targets) = AsynchronousPositions::new();
    let request = AsynchronousPositions::request([0.5; 7]);
    let program = Program::Asynchronous(program);
    let calls = calls_of(Version::V10, program, &request, |time| {
        if time % 5 == 0 {
            targets.write(&AsynchronousTarget {
                q: [time as f64; 7],
                finished: false,
            });
        }
    });
    assert_eq!(calls, 0, "sparse targets");
}
