//! The decision of `move_to`: whether the arm can follow a straight line to a pose, and with which
//! elbow.

use std::hint::black_box;
use std::time::Instant;

use franka_model::{EndEffector, Frame, JointVector, Model, transform};
use franka_proto::RobotState;
use franka_rt::session::{Goal, GoalId, OnArrival, Target};
use nalgebra::Isometry3;
use rand::{Rng, SeedableRng, rngs::SmallRng};

use super::{Benchmark, Statistic};

/// Benchmark of lines from a random posture to the pose of another one. Most take a single check;
/// the slowest are refused after all postures have been tried.
pub fn all() -> Vec<Benchmark> {
    let lines = lines();
    vec![Benchmark {
        key: "model.plan_line_ns",
        statistics: &[Statistic::P50, Statistic::P99, Statistic::Max],
        round: Box::new(move || lines.iter().map(time).collect()),
    }]
}

/// Returns the shortest of several durations of the decision, because each may be interrupted.
fn time((state, goal): &(RobotState, Goal)) -> u64 {
    let repetition = |_| {
        let (mut goal, start) = (*goal, Instant::now());
        let _ = black_box(goal.plan_line(&state.q, &state.q, Model::fr3(), state));
        u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    };
    (0..REPETITIONS).map(repetition).min().unwrap_or(0)
}

fn lines() -> Vec<(RobotState, Goal)> {
    let (mut random, model) = (SmallRng::seed_from_u64(SEED), Model::fr3());
    let limits = model.joint_limits();
    let rigid = transform::array(&Isometry3::identity());
    let mut posture =
        || JointVector::from_fn(|i, _| random.random_range(limits.lower[i]..limits.upper[i]));
    let line = || {
        let (start, end) = (posture(), posture());
        let there = model.pose(Frame::EndEffector, &end, &EndEffector::default());
        let there = transform::isometry(&there).expect("the frame is rigid");
        let state = RobotState {
            q: start.into(),
            F_T_EE: rigid,
            EE_T_K: rigid,
            ..RobotState::default()
        };
        let target = Target::Pose(there);
        let goal = Goal::new(GoalId(1), target, OnArrival::ReportAndFinish, limits);
        (state, goal)
    };
    let lines = std::iter::repeat_with(line);
    let in_reach = |(state, goal): &(RobotState, Goal)| goal.check(model, state).is_ok();
    lines.filter(in_reach).take(LINES).collect()
}

const SEED: u64 = 5;
const LINES: usize = 1000;
const REPETITIONS: usize = 3;
