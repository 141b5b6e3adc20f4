//! Goals of several robots in one thread.

use franka_model::READY;
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{GoalId, Target};

use super::Lockstep;

/// Returns the outcome of one goal per robot, without the report. An entry is `None` while its goal
/// has no outcome.
pub fn outcomes_of<const N: usize>(
    robots: [&Lockstep; N],
    goals: [GoalId; N],
) -> Option<[Result<(), MotionError>; N]> {
    let mut outcomes = [const { Ok(()) }; N];
    for ((outcome, robot), goal) in outcomes.iter_mut().zip(robots).zip(goals) {
        *outcome = robot.client.outcome(goal)?.clone().map(drop);
    }
    Some(outcomes)
}

/// Returns the ready pose with the first joint turned by `by`, `[rad]`.
pub fn turned(by: f64) -> Target {
    let mut q: [f64; 7] = READY.into();
    q[0] += by;
    Target::Joints(q)
}
