//! The control cycle, over 10^5 cycles of each program.

use std::sync::Arc;
use std::time::Duration;

use franka_lockstep::{Lockstep, Part, Wander};
use franka_proto::{MoveControllerMode, MoveRequest, RobotMode, RobotState, Version};
use franka_rt::control::{
    AsynchronousPositions, AsynchronousTarget, Callback, CartesianPose, CartesianVelocities,
    JointPositions, JointVelocities, Modes, Shaper, Torques,
};
use franka_rt::driver::{ControlLog, Driver, MotionId, Order, Program};
use franka_rt::session::{OnArrival, Target};
use franka_rt::stats::{Arrival, CycleTimes};
use nalgebra::Translation3;

use crate::calls_during;

#[test]
fn target_control_never_calls_the_allocator() {
    let seed = 7;
    let mut wander = Wander::new(seed);
    let (mut cycles, mut calls) = (0, 0);
    while cycles < 100_000 {
        wander.tick_around(|part, work| {
            calls += calls_during(work);
            cycles += u64::from(part == Part::Answer);
        });
    }
    assert!(
        wander.lockstep.client.record.goal > 100,
        "the arm has moved"
    );
    assert_eq!(
        calls, 0,
        "seed {seed}: calls of the allocator in {cycles} cycles"
    );
}

/// Arrivals, fade-outs and ends of motions, with a goal of the other kind in the middle of every
/// third motion.
#[test]
fn reached_targets_never_call_the_allocator() {
    let mut lockstep = Lockstep::ready();
    let home = lockstep.arm_pose();
    let q = lockstep.robot.state().q;
    let (mut cycles, mut calls, mut arrived) = (0, 0, 0);
    for round in 0.. {
        let way = if round % 2 == 0 { 0.03 } else { 0.0 };
        let pose = Target::Pose(Translation3::new(0.0, way, way) * home);
        let joints = Target::Joints(core::array::from_fn(|joint| q[joint] + way));
        let targets = if round % 3 == 0 {
            [Some(pose), Some(joints)]
        } else {
            [None, Some(pose)]
        };
        for target in targets.into_iter().flatten() {
            let goal = lockstep.goal(target, OnArrival::ReportAndFinish);
            let id = lockstep.submit(goal).expect("it is near the ready pose");
            let superseded = targets[0] == Some(target);
            for _ in 0..if superseded { 100 } else { u32::MAX } {
                lockstep.tick_around(|part, work| {
                    calls += calls_during(work);
                    cycles += u64::from(part == Part::Answer);
                });
                if let Some(outcome) = lockstep.client.outcome(id) {
                    arrived += u32::from(outcome.is_ok());
                    break;
                }
            }
        }
        if cycles >= 100_000 {
            break;
        }
    }
    assert!(arrived >= 20, "{arrived} arrivals");
    assert_eq!(calls, 0, "calls of the allocator in {cycles} cycles");
}

/// Makes `program` answer states of the motion of `request`, and returns the number of calls of the
/// allocator meanwhile. `before` is called ahead of each state, outside the cycle.
pub(crate) fn calls_of(
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
        ticket: None,
        times: Arc::default(),
        observer: None,
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
        let cycle = CycleTimes::new(time, Duration::ZERO, Duration::from_nanos(time));
        calls += calls_during(|| {
            let sent = driver.on_state(&state).map(|_| &cycle);
            driver.after_send(&state, &Arrival::default(), sent);
            if let Some(sent) = sent {
                driver.note_cycle(sent);
                commands += 1;
            }
            driver.prepare();
        });
    }
    assert!(commands >= CYCLES / 10, "{commands} commands");
    calls
}

/// Control functions of the four generators.
fn generators(version: Version) -> [Callback; 4] {
    [
        Callback::motion(version, |_, step| JointPositions([step.as_secs_f64(); 7])),
        Callback::motion(version, |_, _| JointVelocities([1e-3; 7])),
        Callback::motion(version, |state, _| CartesianPose {
            O_T_EE: state.O_T_EE_c,
            elbow: Some([0.1, 1.0]),
        }),
        Callback::motion(version, |_, _| CartesianVelocities {
            O_dP_EE: [1e-3; 6],
            elbow: None,
        }),
    ]
}

#[test]
fn control_functions_never_call_the_allocator() {
    for version in Version::ALL {
        let torques = Callback::torques(version, |state, _| Torques(state.tau_J_d));
        let both = generators(version)
            .map(|motion| motion.with_torques(|_, step| Torques([step.as_secs_f64(); 7])));
        let alone = generators(version);
        for callback in [torques].into_iter().chain(alone).chain(both) {
            let callback = callback.with_shaper(Shaper::new(version, true, 100.0));
            let request = callback.request(version, MoveControllerMode::JointImpedance);
            let program = Program::Callback(Box::new(callback));
            let calls = calls_of(version, program, &request, |_| {});
            assert_eq!(calls, 0, "{request:?}");
        }
    }
}

#[test]
fn sparse_targets_allocate_and_free_nothing() {
    let (program, mut targets) = AsynchronousPositions::new();
    let request = AsynchronousPositions::request([0.5; 7]);
    let program = Program::Asynchronous(program);
    let calls = calls_of(Version::V10, program, &request, |time| {
        if time % 5 == 0 {
            targets.write(AsynchronousTarget {
                q: [time as f64; 7],
                finished: false,
            });
        }
    });
    assert_eq!(calls, 0);
}
