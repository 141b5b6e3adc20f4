//! Tests of a law at 1 kHz: a file to copy to the `tests` of your crate.

use std::time::Duration;

use franka_async::control::{Finish, Next, Torques};
use franka_async::model::{JointVector, StateModel};
use franka_async::prelude::*;
use franka_async::record::{Activity, Record};
use franka_async::state::RobotState;
use franka_lockstep::{Callback, Lockstep};
use franka_sim::Sim;

/// The program under test: springs and dampers move joint 4 along a wave around `start`, for five
/// seconds.
fn wave(
    model: StateModel,
    start: [f64; 7],
) -> impl FnMut(&RobotState, Duration) -> Next<Torques> + Send + 'static {
    let stiffness = JointVector::from([600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0]);
    let damping = JointVector::from([50.0, 50.0, 50.0, 50.0, 20.0, 15.0, 10.0]);
    let mut time = 0.0;
    move |state, step| {
        time += step.as_secs_f64();
        let wanted = JointVector::from(wanted(start, time));
        let (q, dq) = (JointVector::from(state.q), JointVector::from(state.dq));
        let torques = stiffness.component_mul(&(wanted - q)) - damping.component_mul(&dq)
            + model.dynamics(state).coriolis;
        Torques(torques.into()).finish_if(time >= 5.0)
    }
}

/// Returns the target of the joints after `time`, `[s]`: it begins and ends at `start` at rest.
fn wanted(start: [f64; 7], time: f64) -> [f64; 7] {
    let mut q = start;
    q[3] += 0.1 * (1.0 - (std::f64::consts::TAU * time / 5.0).cos());
    q
}

/// An arm with realistic stiction, over the wire, in virtual time.
#[tokio::test]
async fn the_arm_follows_the_wave_and_no_torque_leaps() -> anyhow::Result<()> {
    for sim in [Sim::fr3(), Sim::fer()] {
        let patience = Duration::from_secs(10);
        let sim = sim.virtual_time(patience / 2).start().await?;
        let robot = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
        let robot = robot.link_timeout(patience).connect().await?;
        let start = robot.state().q_d;
        let mut cycles = robot.cycles(8192)?; // sufficient for the test: 5 s are 5000
        let law = wave(robot.state_model(), start);
        let report = robot.control_torques(law).limit_rate(false).await?;
        assert_eq!(report.lost_states, 0, "{report:?}");

        let mut running = Vec::new();
        while let Some(cycle) = cycles.pop() {
            if cycle.record.activity == Activity::Running {
                running.push(cycle.record);
            }
        }
        let begun = running[0].time;
        let off = |record: &Record| {
            let time = (record.time - begun) as f64 * 1e-3;
            (JointVector::from(record.q) - JointVector::from(wanted(start, time))).amax()
        };
        let off = running.iter().map(off).fold(0.0, f64::max);
        assert!(off < 0.02, "{off} rad from where it is to be");
        for (joint, rate) in robot.model().joint_limits().torque_rate.iter().enumerate() {
            let step = |pair: &[Record]| (pair[1].tau_c[joint] - pair[0].tau_c[joint]).abs();
            let step = running.windows(2).map(step).fold(0.0, f64::max);
            assert!(
                step < rate * 1e-3,
                "joint {} leaps by {step} N m",
                joint + 1
            );
        }

        // A figure of this machine, which is not asserted: the bound on 999 of 1000 answers.
        let mut turnarounds: Vec<_> = running.iter().map(|record| record.turnaround).collect();
        turnarounds.sort_unstable();
        println!(
            "{off:.4} rad, {:?}",
            turnarounds[turnarounds.len() * 999 / 1000]
        );
        robot.shutdown().await;
        sim.stop().await;
    }
    Ok(())
}

/// The result is bit-identical in every run: driver and robot in one thread, without sockets or a
/// clock.
#[test]
fn the_wave_is_the_same_in_each_run() {
    let run = || {
        let mut lockstep = Lockstep::ready();
        let (version, start) = (lockstep.robot.version(), lockstep.robot.state().q_d);
        let law = wave(StateModel::nominal(version), start);
        let function = Callback::torques(version, law);
        let id = lockstep.control_function(function);
        let ended = lockstep.until_resolved(id.expect("nothing else moves"), 10_000);
        ended.expect("the wave ends");
        lockstep.robot.q().map(f64::to_bits)
    };
    assert_eq!(run(), run());
}
