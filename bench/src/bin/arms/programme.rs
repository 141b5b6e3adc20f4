//! The programme of every arm, in virtual time.

use franka_bench::figures::HighPass;
use franka_lockstep::{Link, Lockstep};
use franka_model::{JointVector, Load, RobotKind, Wrench};
use franka_proto::{CollisionBehavior, Request, RobotMode};
use franka_rt::lifecycle::Engagement;
use franka_rt::session::{Backend, Free, Goal, GoalId, OnArrival, PoseError, Target};
use franka_sim::arm::Arm;
use franka_sim::{Config, Network, Touch};
use franka_tests::held_push::HeldPush;
use franka_tests::push::{ArmInertia, PUSH, STIFFNESS, hand};
use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use crate::LawUnderTest;
use crate::figures::ArmFigures;

/// Runs the programme with one arm, under this law.
pub(crate) fn run(kind: RobotKind, arm: Arm, seed: u64, law: LawUnderTest) -> ArmFigures {
    let stalls = arm.stalls;
    let mut lockstep = Lockstep::new(Config {
        arm: Some(arm),
        seed,
        ..Lockstep::config_of(kind)
    });
    if let Some(stalls) = stalls {
        lockstep.link = Link::over(Network::stalling(seed, stalls));
    }
    // A pushing hand must not trigger a reflex.
    let tolerant = CollisionBehavior::uniform([100.0; 7], [100.0; 7], [500.0; 6], [500.0; 6]);
    lockstep.request(&Request::SetCollisionBehavior(tolerant));
    lockstep.run(5);
    let home = lockstep.arm_pose();
    let mut programme = Programme {
        law,
        engaged: None,
        home,
        lockstep,
        figures: ArmFigures {
            seed,
            ..ArmFigures::default()
        },
    };
    let ended = programme
        .unknown()
        .and_then(|()| programme.alone())
        .and_then(|()| {
            programme.engage();
            programme.all()
        });
    if let Err(reflex) = ended {
        programme.figures.reflex = Some(reflex);
    }
    programme.figures
}

struct Programme {
    law: LawUnderTest,
    /// The session's goal; `None` if each goal is a separate motion.
    engaged: Option<GoalId>,
    home: Isometry3<f64>,
    lockstep: Lockstep,
    figures: ArmFigures,
}

/// The reason for the end of the session.
type Ended = String;

impl Programme {
    fn engage(&mut self) -> GoalId {
        let engaged = self.lockstep.engage_with(Engagement {
            backend: self.law.backend(),
            ..Engagement::default()
        });
        self.engaged = Some(engaged);
        engaged
    }

    /// Holds, and is pushed, before anything is known of the arm: by the law that goals have by
    /// default, as the motions after such pushes do.
    fn unknown(&mut self) -> Result<(), Ended> {
        if !self.law.is_default() {
            return Ok(());
        }
        let engaged = self.engage();
        self.head_for(self.home.into(), OnArrival::Hold);
        self.held_pushes(engaged, 1)?;
        self.engaged = None;
        self.lockstep.client.lifecycle.disengage(engaged);
        self.lockstep.until_idle(2000);
        Ok(())
    }

    /// Is pushed while it holds its pose, by pushes that end.
    fn held_pushes(&mut self, engaged: GoalId, count: u64) -> Result<(), Ended> {
        for i in 0..count {
            let seed = self.figures.seed.wrapping_mul(97).wrapping_add(i);
            let push = HeldPush::random(&mut SmallRng::seed_from_u64(seed));
            for _ in 0..push.after {
                self.tick()?;
            }
            let after = push.leave(&mut self.lockstep, engaged, &self.home);
            self.tick()?;
            let figures = &mut self.figures;
            figures.pushed_mm.push(after.later.translation * 1e3);
            figures.pushed_mrad.push(after.later.rotation * 1e3);
            figures.pushed_short += usize::from(!after.arrived);
        }
        Ok(())
    }

    /// Runs steps that are separate motions, under our law: the first ones have no knowledge of the
    /// arm.
    fn alone(&mut self) -> Result<(), Ended> {
        if self.law.backend() != Backend::Torques {
            return Ok(());
        }
        for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
            self.step(Translation3::from(axis * 0.05) * self.home, true)?;
            self.step(self.home, true)?;
        }
        self.lockstep.until_idle(1000);
        Ok(())
    }

    fn all(&mut self) -> Result<(), Ended> {
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        for axis in axes {
            for (length, signs) in [(0.05, [1.0, -1.0]), (0.01, [1.0, 1.0]), (0.2, [-1.0, -1.0])] {
                // The table is closer than 20 cm.
                let length = if axis == Vector3::z() {
                    f64::min(length, 0.15)
                } else {
                    length
                };
                let is_standard = length == 0.05;
                let times = if is_standard { 2 } else { 1 };
                for sign in signs.into_iter().take(times) {
                    let away = Translation3::from(axis * sign * length) * self.home;
                    self.step(away, is_standard)?;
                    self.step(self.home, is_standard)?;
                }
            }
            for degrees in [5.0, -20.0, 40.0, -60.0] {
                // The wrist cannot turn further about x and y.
                let most = if axis == Vector3::z() { 60.0 } else { 40.0 };
                let angle = f64::clamp(degrees, -most, most).to_radians();
                let turn = UnitQuaternion::from_scaled_axis(axis * angle);
                let turned = turn * self.home.rotation;
                self.step(Isometry3::from_parts(self.home.translation, turned), false)?;
                self.step(self.home, false)?;
            }
        }
        if !self.law.backend().is_cartesian() {
            self.joints()?;
        }
        self.hold()?;
        self.stream()?;
        self.circle()?;
        // Guiding requires torques. So does an arm that yields to a continuing push, because the
        // robot's controllers resist until a torque sensor is out of its range.
        if self.law.backend() == Backend::Torques {
            if let Some(engaged) = self.engaged.filter(|_| self.law.is_default()) {
                self.held_pushes(engaged, 3)?;
            }
            self.push()?;
            self.guide()?;
        } else {
            self.lean()?;
        }
        self.carry()
    }

    fn tick(&mut self) -> Result<(), Ended> {
        self.lockstep.tick();
        let client = &self.lockstep.client;
        if let Some(outcome) = self.engaged.and_then(|engaged| client.outcome(engaged)) {
            return Err(format!("{outcome:?}").chars().take(300).collect());
        }
        match client.state.robot_mode {
            RobotMode::Idle | RobotMode::Move => Ok(()),
            mode => Err(format!("{mode:?}: {:?}", client.state.errors)),
        }
    }

    fn head_for(&mut self, target: Target, on_arrival: OnArrival) -> GoalId {
        let goal = self.lockstep.goal(target, on_arrival);
        let goal = Goal {
            gains: self.law.gains(&goal),
            ..goal
        };
        let submitted = match self.engaged {
            Some(engaged) => self.lockstep.submit_within(engaged, goal),
            None => self.lockstep.submit(goal),
        };
        submitted.expect("near the ready pose everything is within reach")
    }

    /// Moves to a pose: see [`Self::go`].
    fn step(&mut self, target: Isometry3<f64>, timed: bool) -> Result<(), Ended> {
        self.go(target.into(), target, timed)
    }

    /// Moves to `target`, where the end effector has the pose `there`; waits for the driver's
    /// result and slightly longer.
    fn go(&mut self, target: Target, there: Isometry3<f64>, timed: bool) -> Result<(), Ended> {
        let on_arrival = match self.engaged {
            Some(_) => OnArrival::ReportAndHold,
            None => OnArrival::ReportAndFinish,
        };
        let goal = self.head_for(target, on_arrival);
        let (mut within, mut told, mut cycle) = (0, 0, 0);
        let off = |lockstep: &Lockstep| PoseError::between(&lockstep.arm_pose(), &there);
        while told == 0 || cycle < told + 300 {
            self.tick()?;
            cycle += 1;
            if off(&self.lockstep).translation > 1e-3 && (told == 0 || self.engaged.is_some()) {
                within = cycle;
            }
            if told == 0 && self.lockstep.client.outcome(goal).is_some() {
                told = cycle;
            }
        }
        let mut error = off(&self.lockstep);
        if let Some(Ok(report)) = self.lockstep.client.outcome(goal)
            && self.engaged.is_none()
            && let Some(reported) = report.final_error
        {
            // By now the robot's own controller has taken over.
            let left = (error.translation - reported.translation) * 1e3;
            self.figures.handover_mm = self.figures.handover_mm.max(left);
            error = reported;
            if let Some(released) = report.released_error {
                self.figures.released_mm = self
                    .figures
                    .released_mm
                    .max((released.translation - reported.translation) * 1e3);
            }
        }
        let f = self.lockstep.client.state.O_F_ext_hat_K;
        self.figures
            .estimates_n
            .push((f[0] * f[0] + f[1] * f[1] + f[2] * f[2]).sqrt());
        let outcome = self.lockstep.client.outcome(goal);
        let figures = &mut self.figures;
        figures.goals += 1;
        if let Some(Err(error)) = outcome {
            figures
                .short
                .push(format!("goal {}: {error}", figures.goals));
        }
        figures.errors_mm.push(error.translation * 1e3);
        figures.errors_mrad.push(error.rotation * 1e3);
        if timed {
            let settled = within < cycle;
            figures
                .arrive_s
                .push(if settled { within as f64 * 1e-3 } else { 10.0 });
            figures.told_s.push(told as f64 * 1e-3);
        }
        Ok(())
    }

    /// Moves to joint positions on either side of home, and back.
    fn joints(&mut self) -> Result<(), Ended> {
        let home = *self.lockstep.robot.q();
        let limits = *self.lockstep.robot.model().joint_limits();
        for by in [0.1, -0.1, 0.4, -0.4] {
            let q = JointVector::from_fn(|i, _| {
                // Neighbouring joints turn in opposite directions, so that the arm stays above the
                // table.
                let turned = home[i] + if i % 2 == 0 { by } else { -by / 2.0 };
                turned.clamp(limits.lower[i] + 0.1, limits.upper[i] - 0.1)
            });
            for q in [q, home] {
                self.go(Target::Joints(q.into()), self.lockstep.pose_at(&q), false)?;
            }
        }
        self.step(self.home, false)
    }

    /// Follows a point on a circle of 4 cm, thirty times per second, for four turns of 2 s.
    fn circle(&mut self) -> Result<(), Ended> {
        for update in 0..240 {
            let (y, z) = (f64::from(update) / 60.0 * core::f64::consts::TAU).sin_cos();
            let away = Translation3::new(0.0, 0.02 * y, 0.02 * (1.0 - z));
            let target = away * self.home;
            self.head_for(target.into(), OnArrival::Hold);
            for _ in 0..33 {
                self.tick()?;
                let reference = self.lockstep.reference_pose().translation.vector;
                let lag = (self.lockstep.arm_pose().translation.vector - reference).norm();
                self.figures.circle_lags_mm.push(lag * 1e3);
            }
        }
        self.step(self.home, false)
    }

    /// Lets a hand guide the arm 10 cm to the side and back and then release it, and moves home.
    fn guide(&mut self) -> Result<(), Ended> {
        let from = self.lockstep.robot.true_pose().translation.vector;
        // The springs have released the arm by then.
        let turned = |t: f64| ((t - 0.4) / 2.0).clamp(0.0, 1.0) * core::f64::consts::TAU;
        let path = move |t: f64| from + Vector3::y() * (0.05 * (1.0 - turned(t).cos()));
        let leading = self.lockstep.robot.touch(Touch::carry(path, STIFFNESS));
        self.head_for(Target::Guide(Free::ALL), OnArrival::Hold);
        for _ in 0..2500 {
            self.tick()?;
            let felt = self.lockstep.robot.felt(leading).expect("it has not ended");
            let force = felt.fixed_rows::<3>(0).norm();
            self.figures.guide_force_n = self.figures.guide_force_n.max(force);
        }
        self.head_for(self.home.into(), OnArrival::Hold);
        self.lockstep.robot.release(leading);
        self.step(self.home, false)
    }

    /// Grips an undeclared load, continues with it, and drops it.
    fn carry(&mut self) -> Result<(), Ended> {
        let gripped = Load {
            mass: GRIPPED,
            com: Vector3::new(0.0, 0.0, 0.12),
            inertia: Matrix3::identity() * (GRIPPED * 1e-3),
        };
        for load in [gripped, Load::NONE] {
            self.lockstep.robot.attach(load);
            for _ in 0..1000 {
                self.tick()?;
            }
            for away in [Vector3::z(), -Vector3::y()] {
                self.step(Translation3::from(away * 0.05) * self.home, false)?;
                self.step(self.home, false)?;
            }
        }
        Ok(())
    }

    /// Holds for 10 s.
    fn hold(&mut self) -> Result<(), Ended> {
        for _ in 0..1000 {
            self.tick()?;
        }
        let mut high = HighPass::default();
        let first = self.lockstep.arm_pose().translation.vector;
        let (mut least, mut most) = (first, first);
        for _ in 0..9000 {
            self.tick()?;
            let at = self.lockstep.arm_pose().translation.vector;
            (least, most) = (least.inf(&at), most.sup(&at));
            high.add(&self.lockstep.client.record.tau_c);
        }
        self.figures.hold_move_mm = (most - least).norm() * 1e3;
        self.figures.hold_torque_hf_nm = high.rms();
        Ok(())
    }

    /// Follows ten random targets per second.
    fn stream(&mut self) -> Result<(), Ended> {
        let mut random = SmallRng::seed_from_u64(self.figures.seed);
        let mut high = HighPass::default();
        let mut way = Vector3::<f64>::zeros();
        for _ in 0..80 {
            way += Vector3::from_fn(|_, _| random.random_range(-0.02..0.02));
            way = way.map(|x| x.clamp(-0.1, 0.1));
            self.head_for(
                (Translation3::from(way) * self.home).into(),
                OnArrival::Hold,
            );
            for _ in 0..100 {
                self.tick()?;
                let reference = self.lockstep.reference_pose().translation.vector;
                let lag = (self.lockstep.arm_pose().translation.vector - reference).norm();
                self.figures.lags_mm.push(lag * 1e3);
                high.add(&self.lockstep.client.record.tau_c);
            }
        }
        self.figures.moving_torque_hf_nm = high.rms();
        self.step(self.home, false)
    }

    /// Pushes the held arm along three axes with [`BORNE`], for an arm that yields only by its
    /// springs, and releases it.
    fn lean(&mut self) -> Result<(), Ended> {
        for way in [Vector3::x(), Vector3::y(), -Vector3::z()] {
            self.step(self.home, false)?;
            let from = self.lockstep.arm_pose().translation.vector;
            let f = way * BORNE;
            let push = Wrench::new(f.x, f.y, f.z, 0.0, 0.0, 0.0);
            self.lockstep.robot.push_end_effector(push, PUSH);
            for _ in 0..PUSH {
                self.tick()?;
                let yielded = (self.lockstep.arm_pose().translation.vector - from).norm();
                self.figures.push_yield_mm = self.figures.push_yield_mm.max(yielded * 1e3);
            }
        }
        self.step(self.home, false)
    }

    /// Pushes the held arm along three axes, regardless of its displacement, and releases it.
    fn push(&mut self) -> Result<(), Ended> {
        for way in [Vector3::x(), Vector3::y(), -Vector3::z()] {
            self.head_for(self.home.into(), OnArrival::Hold);
            for _ in 0..1500 {
                self.tick()?;
            }
            let from = self.lockstep.robot.true_pose().translation.vector;
            let push = self
                .lockstep
                .robot
                .touch(Touch::carry(move |t| from + way * hand(t), STIFFNESS));
            let body = ArmInertia::of(&self.lockstep);
            for _ in 0..PUSH {
                let (q, dq) = (*self.lockstep.robot.q(), *self.lockstep.robot.dq());
                self.tick()?;
                let ddq = (self.lockstep.robot.dq() - dq) / 1e-3;
                let felt = self.lockstep.robot.felt(push).expect("it has not ended");
                let force = felt.fixed_rows::<3>(0).into_owned() - body.inertial(&q, &dq, &ddq);
                self.figures.push_force_n = self.figures.push_force_n.max(force.norm());
            }
            self.lockstep.robot.release(push);
            for _ in 0..3000 {
                self.tick()?;
                let off =
                    self.lockstep.arm_pose().translation.vector - self.home.translation.vector;
                let beyond = -off.dot(&way) * 1e3;
                self.figures.release_overshoot_mm = self.figures.release_overshoot_mm.max(beyond);
            }
        }
        Ok(())
    }
}

/// Force of a push that every controller tolerates, `[N]`.
const BORNE: f64 = 30.0;

/// Mass of the gripped, undeclared load, `[kg]`.
const GRIPPED: f64 = 0.3;
