//! The client of this project.

use std::net::SocketAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use anyhow::Context as _;
use franka_async::settings::CollisionBehavior;
use franka_async::{Arm, Engage, Pose, Realtime, Robot};
use nalgebra::Translation3;

use crate::witness::Followed;

/// The record of one cycle.
#[derive(Clone, Copy)]
struct Cycle {
    /// The robot's time, `[ms]`.
    time: u64,
    goal: u64,
    q_ref: [f64; 7],
}

/// Number of cycles in a recording: a minute.
const CYCLES: usize = 60_000;

/// An engaged arm that is held in place.
pub(crate) struct Ours {
    robot: Robot,
    arm: Arm,
    cycles: Arc<Mutex<Vec<Cycle>>>,
}

impl Ours {
    /// Connects to `robot`, and holds the arm in place.
    pub(crate) async fn hold(robot: SocketAddr) -> anyhow::Result<Self> {
        let builder = Robot::builder(robot).realtime(Realtime::Ignore);
        let robot = builder.connect().await?;
        // Pushes must not trigger a reflex.
        let (joints, forces) = ([100.0; 7], [500.0; 6]);
        let behavior = CollisionBehavior::uniform(joints, joints, forces, forces);
        robot.set_collision_behavior(behavior).await?;
        let cycles = Arc::new(Mutex::new(Vec::with_capacity(CYCLES)));
        let recorded = cycles.clone();
        // An observer must not lock; here it may, because the robot's virtual time waits.
        let engage = Engage::default().observer(move |record, _| {
            let mut cycles = recorded.lock().unwrap_or_else(PoisonError::into_inner);
            if cycles.len() < CYCLES {
                cycles.push(Cycle {
                    time: record.time,
                    goal: record.goal,
                    q_ref: record.q_ref,
                });
            }
        });
        let arm = robot.engage(engage).await?;
        Ok(Self { robot, arm, cycles })
    }

    /// Steps the target, `[m]`, and waits for `seconds`. Also returns the joint positions of the
    /// reference.
    pub(crate) async fn step(
        &self,
        by: [f64; 3],
        seconds: f64,
    ) -> anyhow::Result<(Followed, Vec<[f64; 7]>)> {
        let target: Pose = Translation3::from(by) * self.robot.pose();
        let recorded = || self.cycles.lock().unwrap_or_else(PoisonError::into_inner);
        let held = recorded().last().context("no cycle was seen")?.goal;
        recorded().clear();
        let begin = self.robot.state().message_id;
        self.arm.set(target).await?;
        while ((self.robot.state().message_id - begin) as f64) < seconds * 1e3 {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
        let cycles = recorded().clone();
        let under_way = || cycles.iter().skip_while(|cycle| cycle.goal == held);
        let position = |q: &[f64; 7]| self.robot.pose_at(*q).translation.vector;
        let reference = under_way().map(|cycle| (cycle.time, position(&cycle.q_ref)));
        let followed = Followed {
            target: target.translation.vector,
            reference: reference.collect(),
        };
        Ok((followed, under_way().map(|cycle| cycle.q_ref).collect()))
    }

    /// Ends the session and disconnects.
    pub(crate) async fn end(self) -> anyhow::Result<()> {
        self.arm.disengage().await?;
        self.robot.shutdown().await;
        Ok(())
    }
}
