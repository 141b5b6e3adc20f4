//! What a person beside the robot can do: push it, press the stop, hang a load on it.

use franka_model::{Frame, JointVector, Load, Wrench};
use franka_proto::{Errors, RobotError};

use super::{Activity, Robot};
use crate::end_effector::Hand;
use crate::estimate::Estimate;
use crate::generator::{Arm, Desired};
use crate::observer::MomentumObserver;

/// A push that lasts for a while.
#[derive(Debug, Clone, Copy)]
pub(super) struct Push {
    force: Force,
    /// Clock of the last millisecond in which it acts.
    until: u64,
}

#[derive(Debug, Clone, Copy)]
enum Force {
    Joints(JointVector),
    EndEffector(Wrench),
}

impl Robot {
    /// Lets torques act on the joints from outside for `duration` milliseconds, `[N·m]`; positive
    /// ones push towards positive angles. Pushes add up.
    pub fn push_joints(&mut self, torque: JointVector, duration: u64) {
        self.push(Force::Joints(torque), duration);
    }

    /// Lets a wrench `[force; torque]` act on the end effector from outside for `duration`
    /// milliseconds, in base axes, `[N, N·m]`. Pushes add up.
    pub fn push_end_effector(&mut self, wrench: Wrench, duration: u64) {
        self.push(Force::EndEffector(wrench), duration);
    }

    /// Takes all hands off the arm.
    pub fn let_go(&mut self) {
        self.pushes.clear();
    }

    /// Presses or releases the user stop. Pressed, it ends any motion and allows no other.
    pub fn press_user_stop(&mut self, pressed: bool) {
        self.set_user_stop(pressed);
    }

    /// Makes the robot believe in an error: a reflex with all that follows from it.
    pub fn trip(&mut self, error: RobotError) {
        self.reflex(Errors::from(error));
    }

    /// Puts the arm at rest at `q`, `[rad]`, as if someone had guided it there. A motion under way
    /// ends as by a stop.
    pub fn place(&mut self, q: &JointVector) {
        self.forget_motion();
        self.plant.place(q);
        self.desired = Desired::resting(&self.arm(), *q);
        self.activity = Activity::Holding;
        self.refresh_dynamics();
        let arm = Arm::new(self.kind, self.model, &self.settings.frames, &self.config);
        self.observer = MomentumObserver::new();
        self.estimate = Estimate::new();
        self.estimate
            .update(&JointVector::zeros(), self.plant.q(), &arm);
        self.measurement = super::Measurement::resting(self.plant.as_ref());
    }

    /// Hangs a load on the flange, beside the tool, without telling the robot.
    pub fn attach(&mut self, load: Load) {
        self.plant.attach(self.config.tool.load.combine(&load));
    }

    /// Lets the fingers of the plant, if it has some, do what `hand` wants, and lets `hand` feel them. To be called once per
    /// millisecond, between this robot's [`tick`](Self::tick) and the hand's.
    pub fn couple(&mut self, hand: &mut Hand) {
        let fingers = hand.mechanism_mut();
        if let Some(width) = self.plant.drive_fingers(&fingers.drive()) {
            fingers.feel(width);
        }
    }

    /// True joint positions, `[rad]`.
    pub fn q(&self) -> &JointVector {
        self.plant.q()
    }

    /// True joint velocities, `[rad/s]`.
    pub fn dq(&self) -> &JointVector {
        self.plant.dq()
    }

    /// Joint torques of everything that pushes in this millisecond, `[N·m]`.
    pub(super) fn external_torque(&mut self) -> JointVector {
        if self.pushes.is_empty() {
            return JointVector::zeros();
        }
        let clock = self.clock;
        self.pushes.retain(|push| push.until >= clock);
        let jacobian =
            self.model
                .zero_jacobian(Frame::EndEffector, self.plant.q(), &self.settings.frames);
        self.pushes
            .iter()
            .map(|push| match &push.force {
                Force::Joints(torque) => *torque,
                Force::EndEffector(wrench) => jacobian.tr_mul(wrench),
            })
            .sum()
    }

    fn push(&mut self, force: Force, duration: u64) {
        self.pushes.push(Push {
            force,
            until: self.clock.saturating_add(duration),
        });
    }
}
