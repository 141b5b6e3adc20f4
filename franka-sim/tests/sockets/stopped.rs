//! The simulator's process is stopped and continued in the middle of a motion. A busy host stops
//! the process in the same way, for shorter times. A real robot's clock never stops, so stops must
//! not affect the client's motion. The robots wait for late commands, so delays of the client have
//! no effect.

use std::f64::consts::PI;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, sleep};
use std::time::Duration;

use franka_async::control::{CartesianPose, Finish as _, JointPositions, Torques};
use franka_async::{MotionError, MotionReport, Realtime, Robot};
use tokio::runtime::Builder;

use crate::alone;
use crate::binary::Binary;

/// Time from one stop to the next.
const PERIOD: Duration = Duration::from_millis(250);

/// Stops the process for `stop`, four times a second, while `work` runs.
fn stopping<R>(binary: &Binary, stop: Duration, work: impl FnOnce() -> R) -> R {
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                binary.stop_for(stop);
                sleep(PERIOD - stop);
            }
        });
        let _over = EndOnDrop(&over);
        work()
    })
}

/// Ends the stops when it is dropped, even if the work panics.
struct EndOnDrop<'a>(&'a AtomicBool);

impl Drop for EndOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Returns the value at `time` of a cosine path to 1 and back to 0 within a second.
fn there_and_back(time: f64) -> f64 {
    0.5 - 0.5 * (2.0 * PI * time.min(DURATION) / DURATION).cos()
}

/// Duration of a motion by a generator, `[s]`.
const DURATION: f64 = 1.5;

async fn joint_positions(robot: &Robot) -> Result<MotionReport, MotionError> {
    let (mut time, mut start) = (0.0, None);
    let control = robot.control_joint_positions(move |state, step| {
        time += step.as_secs_f64();
        let mut q = *start.get_or_insert(state.q_d);
        q[3] += 0.1 * there_and_back(time);
        JointPositions(q).finish_if(time >= DURATION)
    });
    control.await
}

async fn cartesian_pose(robot: &Robot) -> Result<MotionReport, MotionError> {
    let (mut time, mut start) = (0.0, None);
    let control = robot.control_cartesian_pose(move |state, step| {
        time += step.as_secs_f64();
        let mut pose = *start.get_or_insert(state.O_T_EE_c);
        pose[14] -= 0.04 * there_and_back(time);
        let command = CartesianPose {
            O_T_EE: pose,
            elbow: None,
        };
        command.finish_if(time >= DURATION)
    });
    control.await
}

fn connected<R>(binary: &Binary, work: impl AsyncFnOnce(&Robot) -> R) -> R {
    let mut builder = Builder::new_multi_thread();
    let runtime = builder.worker_threads(1).enable_all().build();
    runtime.expect("a runtime").block_on(async {
        let robot = Robot::builder(binary.robot().address).realtime(Realtime::Ignore);
        let robot = robot.connect().await.expect("a session");
        let result = work(&robot).await;
        robot.shutdown().await;
        result
    })
}

#[test]
fn a_stop_takes_no_patience_from_a_client_in_virtual_time() {
    let _alone = alone();
    let options = ["--robot", "fr3", "--virtual-time=0.5"];
    let binary = Arc::new(Binary::start_with(&options));
    let stopped = binary.clone();
    let mut calls = 0;
    let report = connected(&binary, async |robot| {
        let control = robot.control_torques(move |_, _| {
            calls += 1;
            if calls == 100 {
                // Each stop is longer than the robot waits. A fifth of this time without a stop
                // follows.
                stopped.stop_for(Duration::from_millis(800));
                sleep(Duration::from_millis(100));
            }
            Torques([0.0; 7]).finish_if(calls == 200)
        });
        control.await.expect("a motion to its end")
    });
    assert_eq!(report.success_rate_min, 1.0);
}

#[test]
fn a_stopped_simulator_disturbs_no_motion() {
    let _alone = alone();
    for kind in ["fr3", "fer"] {
        for stop in [Duration::from_millis(4), Duration::from_millis(50)] {
            let binary = Binary::start_with(&["--robot", kind, "--wait-for-commands"]);
            stopping(&binary, stop, || {
                connected(&binary, async |robot| {
                    let mut q = robot.state().q;
                    q[0] += 0.3;
                    for (motion, ended) in [
                        ("torques", robot.move_joints(q).await),
                        ("joint positions", joint_positions(robot).await),
                        ("poses", cartesian_pose(robot).await),
                    ] {
                        let case = format!("{motion}, {kind}, stopped for {stop:?}");
                        let report = ended.unwrap_or_else(|error| panic!("{case}: {error}"));
                        assert_eq!(report.success_rate_min, 1.0, "{case}: {report:?}");
                    }
                });
            });
            binary.interrupt();
            binary.assert_logged("the clock slipped");
        }
    }
}
