//! Chunks through the ring, the player and the servo, as in a session.

use core::time::Duration;
use std::sync::Arc;

use franka_model::{EndEffector, Frame, JointVector, Model, READY, rotation};
use franka_otg::{CYCLE, Generator, Limits, State};
use franka_proto::{RobotState, Version};
use nalgebra::{Isometry3, Translation3, Vector3};
use proptest::prelude::*;

use super::course::{ChunkCourse, ChunkStart};
use super::curve_state::stacked;
use super::{Chunk, ChunkReader, ChunkWriter, Fate, chunk_ring};
use crate::session::kinematics::{Drift, Posture};
use crate::session::pose::PoseState;
use crate::session::reference::Reference;
use crate::session::{
    Budget, Goal, GoalId, OnArrival, SessionEvent, Settlement, Target, TargetSession, rigid,
};
use crate::together::Gate;
use crate::triple_buffer::{Writer, triple_buffer};

mod replanning;

const GOAL: GoalId = GoalId(1);

/// An arm that follows its reference exactly, and the session's part in following chunks.
struct Arm {
    model: &'static Model,
    budget: Budget,
    writer: ChunkWriter,
    reader: ChunkReader,
    course: Option<ChunkCourse>,
    reference: Reference,
    now: u64,
}

impl Arm {
    fn new(budget: Budget) -> Self {
        let (writer, reader) = chunk_ring();
        Self {
            model: Model::fr3(),
            budget,
            writer,
            reader,
            course: None,
            reference: Reference::at_rest(READY),
            now: 10_000,
        }
    }

    fn default_budget() -> Self {
        Self::new(Budget::of(Model::fr3().joint_limits()))
    }

    /// Answers the state that arrives `later` milliseconds after the last state.
    fn cycle(&mut self, later: u64) {
        self.now += later;
        let idle = self
            .course
            .as_ref()
            .is_none_or(|course| course.is_over(self.now));
        if let Some(chunk) = self.reader.poll(GOAL, self.now, idle) {
            let start = ChunkStart {
                reference: &self.reference,
                pose: self.pose(),
                drift: Drift::of(self.reference.dq),
                before: self.course.as_ref(),
                now: self.now,
            };
            let next = ChunkCourse::new(self.model, GOAL, self.budget, chunk, start);
            if let Some(before) = self.course.replace(next) {
                before.end(&mut self.reader, self.now);
            }
        }
        if let Some(course) = &mut self.course {
            let ee = EndEffector::default();
            let step = course.step(
                self.model,
                &ee,
                (&Posture::kept(READY), None),
                &self.reference,
                self.now,
            );
            self.reference = step.reference;
        }
        while self.writer.collect().is_some() {}
    }

    fn pose(&self) -> PoseState {
        let course = self.course.as_ref().and_then(ChunkCourse::pose);
        course.map_or_else(
            || PoseState {
                pose: start(self.model),
                twist: stacked(&Vector3::zeros(), &Vector3::zeros()),
                acceleration: stacked(&Vector3::zeros(), &Vector3::zeros()),
            },
            |(pose, _)| pose,
        )
    }
}

fn start(model: &Model) -> Isometry3<f64> {
    rigid(&model.pose(Frame::EndEffector, &READY, &EndEffector::default()))
}

fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

/// A chunk that no program should send: points anywhere, at any distance from each other.
#[derive(Clone, Debug)]
struct Wild {
    /// Milliseconds after the previous point, and seven numbers in -1..1.
    points: Vec<(u64, [f64; 7])>,
    latency: u64,
    blend: u64,
    /// Cycles until the next chunk. Each contains the milliseconds since the previous state.
    cycles: Vec<u64>,
    size: f64,
}

fn wild() -> impl Strategy<Value = Wild> {
    let point = (1_u64..120, prop::array::uniform7(-1.0..1.0));
    let later = prop_oneof![12 => Just(1_u64), 1 => 2_u64..20];
    (
        prop::collection::vec(point, 1..24),
        0_u64..300,
        prop_oneof![Just(0_u64), 1_u64..300],
        prop::collection::vec(later, 1..400),
        prop_oneof![Just(1.0), Just(0.05), Just(0.005)],
    )
        .prop_map(|(points, latency, blend, cycles, size)| Wild {
            points,
            latency,
            blend,
            cycles,
            size,
        })
}

impl Wild {
    fn timed<T>(&self, value: impl Fn(&[f64; 7]) -> T) -> Vec<(Duration, T)> {
        let mut time = 0;
        let place = |(later, numbers): &(u64, [f64; 7])| {
            time += later;
            (ms(time), value(&numbers.map(|x| self.size * x)))
        };
        self.points.iter().map(place).collect()
    }

    fn sent(&self, chunk: Chunk, now: u64) -> Chunk {
        chunk.observed_at(now - self.latency).blend(ms(self.blend))
    }

    fn joints(&self) -> Chunk {
        Chunk::joints(self.timed(|x| (READY + JointVector::from(*x) * 0.7).into())).unwrap()
    }

    fn poses(&self, from: &Isometry3<f64>) -> Chunk {
        let pose = |x: &[f64; 7]| {
            // At most 80 degrees from the start, so that two poses are always less than half a turn
            // apart.
            let turn = Vector3::new(x[3], x[4], x[5]) * 0.8;
            Isometry3::from_parts(
                Translation3::from(from.translation.vector + Vector3::new(x[0], x[1], x[2]) * 0.3),
                rotation::exp(&turn) * from.rotation,
            )
        };
        Chunk::poses(self.timed(pose)).unwrap()
    }
}

/// Slightly more than 1, to compare with a limit in spite of rounding.
const ROUNDING: f64 = 1.0 + 1e-9;

fn cases(count: u32) -> ProptestConfig {
    ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(count)
    }
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn joints_keep_budget_and_range_for_any_chunks(
        chunks in prop::collection::vec(wild(), 1..5),
    ) {
        let mut arm = Arm::default_budget();
        let robot = *arm.model.joint_limits();
        for wild in &chunks {
            arm.writer.send(GOAL, wild.sent(wild.joints(), arm.now)).unwrap();
            for &later in &wild.cycles {
                let before = arm.reference;
                arm.cycle(later);
                let now = arm.reference;
                for i in 0..7 {
                    let limits = arm.budget.joints[i];
                    let jerk = (now.ddq[i] - before.ddq[i]) / CYCLE;
                    prop_assert!(now.dq[i].abs() <= limits.velocity * ROUNDING);
                    prop_assert!(now.ddq[i].abs() <= limits.acceleration * ROUNDING);
                    prop_assert!(jerk.abs() <= limits.jerk * ROUNDING, "{}", jerk);
                    prop_assert!((robot.lower[i]..=robot.upper[i]).contains(&now.q[i]), "{}", now.q);
                    let moved = CYCLE * (before.dq[i] + CYCLE * (before.ddq[i] / 2.0 + CYCLE * jerk / 6.0));
                    prop_assert!((now.q[i] - before.q[i] - moved).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn poses_keep_the_budget_of_the_norms_whatever_chunks_ask_for(
        chunks in prop::collection::vec(wild(), 1..5),
    ) {
        let mut arm = Arm::default_budget();
        let from = start(arm.model);
        for wild in &chunks {
            arm.writer.send(GOAL, wild.sent(wild.poses(&from), arm.now)).unwrap();
            for &later in &wild.cycles {
                let before = arm.pose();
                arm.cycle(later);
                let now = arm.pose();
                let jerk = (now.acceleration - before.acceleration) / CYCLE;
                for (part, limits) in [(0, arm.budget.translation), (3, arm.budget.rotation)] {
                    let norm = |twist: &franka_model::Twist| twist.fixed_rows::<3>(part).norm();
                    prop_assert!(norm(&now.twist) <= limits.velocity * ROUNDING);
                    prop_assert!(norm(&now.acceleration) <= limits.acceleration * ROUNDING);
                    prop_assert!(norm(&jerk) <= limits.jerk * ROUNDING, "{}", norm(&jerk));
                }
            }
        }
    }
}

/// Returns the joint positions of a policy at the robot's time `now`. All joints move on sines of
/// 0.1 rad and 2 s.
fn sine(now: u64) -> [f64; 7] {
    let phase = core::f64::consts::PI * (now as f64 * 1e-3);
    (READY + JointVector::repeat(0.1 * phase.sin())).into()
}

/// Returns the prediction of a policy at `observed`: 16 points, 50 ms apart.
fn prediction(observed: u64) -> Vec<(Duration, [f64; 7])> {
    let point = |k: u64| (ms(50 * k), sine(observed + 50 * k));
    (0..16).map(point).collect()
}

const LATENCY: u64 = 150;

#[test]
fn late_chunks_at_10_hz_follow_sine_to_0_1_milliradian() {
    let mut arm = Arm::default_budget();
    let mut worst = 0.0_f64;
    for cycle in 0..6000 {
        if arm.now.is_multiple_of(100) {
            let observed = arm.now - LATENCY;
            let chunk = Chunk::joints(prediction(observed))
                .unwrap()
                .observed_at(observed);
            arm.writer.send(GOAL, chunk).unwrap();
        }
        arm.cycle(1);
        if cycle > 1000 {
            let wanted = JointVector::from(sine(arm.now));
            worst = worst.max((arm.reference.q - wanted).amax());
        }
    }
    assert!(worst < 1e-4, "{worst}");
    let naive = naive_error();
    assert!(naive > 300.0 * worst, "{worst} against {naive}");
}

/// Returns the error of the same policy if each of its points is set as the target for 50 ms,
/// beginning when the prediction arrives.
fn naive_error() -> f64 {
    let budget = Budget::of(Model::fr3().joint_limits());
    let limits = Limits::per_axis(budget.joints).unwrap();
    let mut generator = Generator::new(State::at_rest(READY.into()), limits).unwrap();
    let mut worst = 0.0_f64;
    for now in 10_000..16_000_u64 {
        let arrived = now - now % 100;
        let point = (now - arrived) / 50;
        generator
            .set_target(&sine(arrived - LATENCY + 50 * point))
            .unwrap();
        let q = JointVector::from(generator.step().position);
        if now > 11_000 {
            worst = worst.max((q - JointVector::from(sine(now))).amax());
        }
    }
    worst
}

#[test]
fn lost_states_are_made_up_for() {
    let mut arm = Arm::default_budget();
    let observed = arm.now;
    let points = (0..100).map(|k| (ms(50 * k), sine(observed + 50 * k)));
    let chunk = Chunk::joints(points).unwrap().observed_at(observed);
    arm.writer.send(GOAL, chunk).unwrap();
    let error = |arm: &Arm| (arm.reference.q - JointVector::from(sine(arm.now))).amax();
    for _ in 0..2000 {
        arm.cycle(1);
    }
    assert!(error(&arm) < 1e-4, "{}", error(&arm));
    arm.cycle(15);
    assert!(error(&arm) > 2e-3, "14 ms of motion are missing");
    for _ in 0..300 {
        arm.cycle(1);
    }
    assert!(error(&arm) < 1e-4, "{}", error(&arm));
}

#[test]
fn a_chunk_of_poses_is_walked_to_its_end_and_rests_there() {
    let mut arm = Arm::default_budget();
    let from = start(arm.model);
    let pose = |k: u64| {
        let s = k as f64 / 20.0;
        let s = s * s * s * (10.0 - s * (15.0 - 6.0 * s));
        Isometry3::from_parts(
            Translation3::from(from.translation.vector + Vector3::new(0.05, -0.1, 0.05) * s),
            rotation::exp(&(Vector3::new(0.2, -0.1, 0.3) * s)) * from.rotation,
        )
    };
    let points = (0..=20).map(|k| (ms(100 * k), pose(k)));
    let chunk = Chunk::poses(points).unwrap().observed_at(arm.now);
    arm.writer.send(GOAL, chunk).unwrap();
    let mut passed = 0;
    for cycle in 1..=2000 {
        arm.cycle(1);
        if cycle % 100 == 0 {
            let off = arm.pose().pose.translation.vector - pose(cycle / 100).translation.vector;
            let turned = rotation::error(&arm.pose().pose.rotation, &pose(cycle / 100).rotation);
            assert!(
                off.norm() < 1e-4 && turned.norm() < 1e-3,
                "{cycle}: {off} {turned}"
            );
            passed += 1;
        }
    }
    assert_eq!(passed, 20);
    assert!(
        arm.course
            .as_ref()
            .is_some_and(|course| course.is_over(arm.now))
    );
    let reached = rigid(&arm.model.pose(
        Frame::EndEffector,
        &arm.reference.q,
        &EndEffector::default(),
    ));
    assert!((reached.translation.vector - pose(20).translation.vector).norm() < 2e-4);
    assert!(arm.reference.dq.amax() < 5e-3, "{}", arm.reference.dq);
}

/// A session whose arm is always at its reference.
struct Session {
    session: TargetSession,
    goals: Writer<Goal>,
    chunks: ChunkWriter,
    state: RobotState,
}

impl Session {
    fn new() -> Self {
        let (goals, reader) = triple_buffer();
        let (chunks, chunk_reader) = chunk_ring();
        let identity = Isometry3::<f64>::identity().to_homogeneous();
        let rigid: [f64; 16] = identity.as_slice().try_into().expect("sixteen numbers");
        Self {
            session: TargetSession::new(Arc::new(Model::fr3().clone()), Version::V10, reader)
                .with_chunks(chunk_reader),
            goals,
            chunks,
            state: RobotState {
                message_id: 20_000,
                q: READY.into(),
                F_T_EE: rigid,
                EE_T_K: rigid,
                ..RobotState::default()
            },
        }
    }

    fn set(&mut self, id: u64, target: Target, on_arrival: OnArrival) {
        let goal = Goal::new(GoalId(id), target, on_arrival, Model::fr3().joint_limits());
        self.goals.write(Goal {
            along_path: on_arrival == OnArrival::ReportAndHold,
            ..goal
        });
    }

    fn run(&mut self, cycles: u64) -> Option<SessionEvent> {
        let mut event = None;
        for _ in 0..cycles {
            self.state.message_id += 1;
            let step = self.session.answer(Gate::Open, &self.state, &mut event);
            self.session.prepare();
            self.state.q = step.trace.reference.q.into();
            self.state.dq = step.trace.reference.dq.into();
        }
        event
    }

    fn fates(&mut self) -> Vec<Fate> {
        core::iter::from_fn(|| self.chunks.collect())
            .map(|returned| returned.fate)
            .collect()
    }

    /// Returns a smooth motion of 0.1 rad over a second.
    fn way() -> Chunk {
        let point = |k: u64| {
            let s = k as f64 / 20.0;
            let s = s * s * s * (10.0 - s * (15.0 - 6.0 * s));
            (ms(50 * k), (READY + JointVector::repeat(0.1 * s)).into())
        };
        Chunk::joints((0..=20).map(point)).unwrap()
    }
}

#[test]
fn session_follows_the_chunks_of_its_goal_to_their_end() {
    let mut session = Session::new();
    session.chunks.send(GOAL, Session::way()).unwrap();
    session.set(1, Target::Rest, OnArrival::ReportAndHold);
    assert_eq!(session.run(501), None);
    let half = JointVector::from(session.state.q) - READY;
    assert!((half.add_scalar(-0.05)).amax() < 2e-4, "{half}");
    let event = session.run(1000);
    assert!(
        matches!(
            event,
            Some(SessionEvent::Settled {
                goal: GOAL,
                settlement: Settlement::Arrived(_),
                ..
            })
        ),
        "{event:?}"
    );
    assert_eq!(session.fates(), [Fate::Ended]);
    // Another chunk starts the reference again.
    session.chunks.send(GOAL, Session::way()).unwrap();
    session.run(300);
    assert!(JointVector::from(session.state.dq).amax() > 0.01);
}

#[test]
fn another_goal_takes_over_from_a_chunk_whose_memory_goes_back() {
    let mut session = Session::new();
    session.chunks.send(GOAL, Session::way()).unwrap();
    session.set(1, Target::Rest, OnArrival::Hold);
    session.run(500);
    session.set(2, Target::Joints(READY.into()), OnArrival::Hold);
    session.run(2);
    assert_eq!(session.fates(), [Fate::Replaced]);
    session.chunks.send(GOAL, Session::way()).unwrap();
    session.run(3000);
    assert!((JointVector::from(session.state.q) - READY).amax() < 1e-6);
    session.chunks.send(GoalId(2), Session::way()).unwrap();
    session.run(2);
    assert_eq!(session.fates(), [Fate::Obsolete]);
}
