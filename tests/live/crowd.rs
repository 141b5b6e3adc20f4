//! Ten simulators and ten driven robots in one process: no robot gets data of another, and
//! everything resolves.
//!
//! The arms keep to separate lanes, have different loads and tools, and move from goal to goal.
//! Data for the wrong robot is visible: a state in the lane, the load or the tool of a neighbour,
//! or a command in an arm that leaves its lane.
//!
//! The test takes [`SECONDS`]. To run it longer, with more in the report:
//!
//! ```text
//! FRANKA_CROWD_SECONDS=60 cargo test --package franka-tests --test live crowd -- --nocapture
//! ```
//!
//! `FRANKA_CROWD_STRICT=1` has the robots not wait for late commands, which takes a machine that
//! carries twenty threads at 1 kHz.

use std::future::IntoFuture;
use std::time::{Duration, Instant};

use franka_async::connection::Version;
use franka_async::settings::Load;
use franka_async::state::{RobotError, RobotState};
use franka_async::{MotionError, MotionReport, Pose, Robot};
use franka_model::READY;
use franka_sim::{Running, Sim, Tool};
use franka_tests::PATIENCE;
use tokio::task::{JoinHandle, JoinSet};
use tokio::time::timeout;

use crate::{alone, connect, robot_time, until};

type Outcome = Result<MotionReport, MotionError>;

/// Events of one robot.
#[derive(Debug, Default)]
struct Counts {
    arrived: u32,
    superseded: u32,
    stopped: u32,
    /// Motions that the robot ended because commands were missing.
    starved: u32,
    /// States that were checked against this robot's own values.
    states: u64,
    /// Smallest success rate of the motions that arrived.
    success_rate_min: f64,
}

/// One arm and its simulator.
struct Member {
    number: usize,
    robot: Robot,
    sim: Running,
    counts: Counts,
}

/// `READY`, turned at the base into this robot's lane.
fn home(number: usize) -> [f64; 7] {
    let mut q: [f64; 7] = READY.into();
    q[0] += LANE * (number as f64 - 4.5);
    q
}

/// Load on the flange, `[kg]`.
fn mass(number: usize) -> f64 {
    0.05 * (number + 1) as f64
}

/// Distance of the individual tool beyond the Hand, `[m]`.
fn reach(number: usize) -> f64 {
    0.01 * (number + 1) as f64
}

/// Checks a state against the values that only this robot has.
fn assert_own(number: usize, state: &RobotState) {
    let aside = state.q[0] - home(number)[0];
    assert!(aside.abs() < LANE / 2.0, "robot {number}: {aside} rad off");
    let load = state.m_load - mass(number);
    assert!(load.abs() < 1e-6, "robot {number}: {} kg", state.m_load);
    let tool = state.NE_T_EE[14] - reach(number);
    assert!(tool.abs() < 1e-6, "robot {number}: {:?}", state.NE_T_EE);
}

/// Checks every state to the end of the connection; returns how many.
fn watch(number: usize, robot: &Robot) -> JoinHandle<u64> {
    let mut states = robot.state_stream();
    tokio::spawn(async move {
        let (mut count, mut newest) = (0, 0);
        while let Some(update) = states.next().await {
            let state = &update.state;
            assert!(state.message_id > newest, "robot {number}: {newest} again");
            newest = state.message_id;
            assert_own(number, state);
            count += 1;
        }
        count
    })
}

impl Member {
    /// An FR3 or an FER, in its lane, with its load and its tool.
    async fn new(number: usize, strict: bool) -> Self {
        let sim = match number % 2 {
            0 => Sim::fr3().ideal(),
            _ => Sim::fer().ideal(),
        };
        let payload = franka_model::Load {
            mass: mass(number),
            ..franka_model::Load::NONE
        };
        let sim = sim.tool(Tool::hand()).configure(|config| {
            config.q = home(number).into();
            config.payload = payload;
        });
        let sim = match strict {
            true => sim,
            false => sim.wait_for_commands(PATIENCE),
        };
        let sim = sim.start().await.expect("a simulator starts");
        let robot = connect(&sim).await;
        let expected = [Version::V10, Version::V5][number % 2];
        assert_eq!(robot.version(), expected, "robot {number}");
        let load = Load {
            m_load: mass(number),
            F_x_Cload: [0.0; 3],
            I_load: [0.0; 9],
        };
        robot.set_load(load).await.expect("at rest");
        let tool = Pose::translation(0.0, 0.0, reach(number));
        robot.set_ee(tool).await.expect("at rest");
        Self {
            number,
            robot,
            sim,
            counts: Counts {
                success_rate_min: 1.0,
                ..Counts::default()
            },
        }
    }

    /// A goal in the lane that no other robot has.
    fn goal(&self, round: u32) -> [f64; 7] {
        let mut q = home(self.number);
        let side = if round.is_multiple_of(2) { 1.0 } else { -1.0 };
        q[0] += side * 0.2 * LANE;
        q[1 + self.number % 6] += side * (0.04 + 0.004 * self.number as f64);
        q
    }

    /// The outcome of a motion, which must resolve.
    async fn outcome(&self, motion: impl IntoFuture<Output = Outcome>) -> Outcome {
        let number = self.number;
        let outcome = timeout(LONGEST, motion.into_future()).await;
        outcome.unwrap_or_else(|_| panic!("robot {number}: a future is lost"))
    }

    /// Records the result of a motion that must end as `expected`. A robot that lacked commands is
    /// recovered.
    async fn note(
        &mut self,
        outcome: Outcome,
        expected: fn(&mut Counts, &Outcome) -> bool,
    ) -> bool {
        if expected(&mut self.counts, &outcome) {
            return true;
        }
        let number = self.number;
        let Err(MotionError::Control(error)) = &outcome else {
            panic!("robot {number}: {outcome:?}")
        };
        let reasons = error.failure.reflex_reason;
        assert!(
            reasons.contains(RobotError::CommunicationConstraintsViolation),
            "robot {number}: {error}"
        );
        self.counts.starved += 1;
        let recovered = timeout(LONGEST, self.robot.recover()).await;
        recovered.expect("it resolves").expect("it takes motions");
        false
    }

    /// The arm of this robot's own simulator is at the driver's goal.
    async fn assert_there(&self, goal: &[f64; 7]) {
        let truth = self.sim.state().await.expect("it runs");
        for (whose, state) in [("driver", self.robot.state()), ("simulator", truth)] {
            for (joint, (is, goal)) in state.q.iter().zip(goal).enumerate() {
                let error = (is - goal).abs();
                let number = self.number;
                assert!(
                    error < 5e-3,
                    "robot {number}, {whose}: joint {joint} by {error}"
                );
            }
        }
    }

    /// Waits until a motion has begun, or has failed to.
    async fn head_start(&self) {
        let begun = until(&self.robot, RobotState::motion_running);
        // The outcome is checked elsewhere.
        let _ = timeout(HEAD_START, begun).await;
    }

    /// A motion of each kind of end.
    async fn round(&mut self, round: u32) {
        let arrived = |counts: &mut Counts, outcome: &Outcome| match outcome {
            Ok(report) => {
                counts.arrived += 1;
                counts.success_rate_min = counts.success_rate_min.min(report.success_rate_min);
                true
            }
            Err(_) => false,
        };
        let goal = self.goal(round);
        let outcome = self.outcome(self.robot.move_joints(goal)).await;
        if self.note(outcome, arrived).await {
            self.assert_there(&goal).await;
        }

        let up = Pose::translation(0.0, 0.0, 0.02) * self.robot.pose();
        let outcome = self.outcome(self.robot.move_to(up)).await;
        self.note(outcome, arrived).await;

        let slow = self.robot.move_joints(self.goal(round + 1)).speed(0.05);
        let slow = tokio::spawn(slow.into_future());
        self.head_start().await;
        let outcome = self.outcome(self.robot.move_joints(goal)).await;
        if self.note(outcome, arrived).await {
            self.assert_there(&goal).await;
        }
        let outcome = timeout(LONGEST, slow).await.expect("it resolves");
        let superseded = |counts: &mut Counts, outcome: &Outcome| {
            counts.superseded += 1;
            matches!(outcome, Err(MotionError::Superseded))
        };
        self.note(outcome.expect("no panic"), superseded).await;

        let slow = self.robot.move_joints(self.goal(round + 1)).speed(0.05);
        let slow = tokio::spawn(slow.into_future());
        self.head_start().await;
        let halted = timeout(LONGEST, self.robot.stop()).await;
        let halted = halted.expect("it resolves");
        let outcome = timeout(LONGEST, slow).await.expect("it resolves");
        let stopped = |counts: &mut Counts, outcome: &Outcome| {
            counts.stopped += 1;
            matches!(outcome, Err(MotionError::Stopped))
        };
        if self.note(outcome.expect("no panic"), stopped).await {
            halted.unwrap_or_else(|error| panic!("robot {}: {error}", self.number));
        }
    }

    /// Runs rounds until `end`; then disconnects, and reports.
    async fn run(mut self, end: Instant) -> (usize, Counts) {
        // By then, all states from before the settings have arrived.
        robot_time(&self.robot, 100).await;
        let watching = watch(self.number, &self.robot);
        let mut round = 0;
        while Instant::now() < end {
            self.round(round).await;
            round += 1;
        }
        assert_own(self.number, &self.sim.state().await.expect("it runs"));
        self.robot.shutdown().await;
        let states = timeout(LONGEST, watching).await.expect("it ends");
        self.counts.states = states.expect("no state of another robot");
        let (stats, pace) = (self.robot.stats(), self.sim.pace().await.expect("it runs"));
        println!(
            "robot {}: {:?}; {} states, {} commands, {} lost, {} skipped, {} foreign; {pace:?}",
            self.number,
            self.counts,
            stats.states.get(),
            stats.commands.get(),
            stats.lost.get(),
            stats.skipped.get(),
            stats.foreign.get(),
        );
        assert_eq!(stats.foreign.get(), 0, "robot {}", self.number);
        assert_eq!(stats.malformed.get(), 0, "robot {}", self.number);
        self.sim.stop().await;
        (self.number, self.counts)
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn ten_robots_in_one_process_mind_their_own_business() {
    let _alone = alone();
    let seconds = std::env::var("FRANKA_CROWD_SECONDS").ok();
    let seconds = seconds.map_or(SECONDS, |text| text.parse().expect("a number"));
    let strict = std::env::var("FRANKA_CROWD_STRICT").is_ok_and(|value| value == "1");
    let mut members = Vec::new();
    for number in 0..ROBOTS {
        members.push(Member::new(number, strict).await);
    }
    let end = Instant::now() + Duration::from_secs(seconds);
    let mut running = JoinSet::new();
    for member in members {
        running.spawn(member.run(end));
    }
    let mut told = 0;
    while let Some(done) = running.join_next().await {
        let (number, counts) = done.expect("nothing goes wrong");
        told += 1;
        assert!(counts.arrived > 0, "robot {number}: {counts:?}");
        assert!(counts.states > 0, "robot {number}: {counts:?}");
    }
    assert_eq!(told, ROBOTS);
}

const ROBOTS: usize = 10;

/// Default duration, in seconds.
const SECONDS: u64 = 6;

/// Distance between the base joints of neighbouring homes, `[rad]`.
const LANE: f64 = 0.3;

/// A motion that has not begun by then has already ended.
const HEAD_START: Duration = Duration::from_secs(5);

/// A motion that resolves later than this is lost.
const LONGEST: Duration = Duration::from_secs(60);
