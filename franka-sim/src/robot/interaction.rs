//! Actions on the arm by a person next to the robot: push, hold, add a load. The stop, brakes and
//! buttons are in [`operation`](super::operation).

use franka_model::{Frame, JointVector, Load, Wrench, transform};
use franka_proto::MoveStatus;
use nalgebra::Isometry3;

use super::boards::Boards;
use super::interface::TorqueInterface;
use super::touch::{Touch, TouchId};
use super::{Activity, Measurement, Robot};
use crate::arm::Arm;
use crate::end_effector::Hand;
use crate::estimate::Estimate;
use crate::generator::{ArmModel, Desired};
use crate::observer::MomentumObserver;
use crate::plant::DriveTrain;

impl Robot {
    /// Starts an external action on the arm, a [`Touch`], and returns its identifier.
    pub fn touch(&mut self, touch: Touch) -> TouchId {
        self.touches.add(touch, self.clock)
    }

    /// Ends a touch. Returns false if it has already ended.
    pub fn release(&mut self, touch: TouchId) -> bool {
        self.touches.remove(touch)
    }

    /// Mean wrench of a touch on the arm in the last millisecond: `[force; torque]` about the
    /// touched point, in base axes, `[N, N·m]`. `None` once the touch has ended. The wrench is zero
    /// for torques on joints.
    pub fn felt(&self, touch: TouchId) -> Option<Wrench> {
        self.touches.felt(touch)
    }

    /// Ends all touches.
    pub fn let_go(&mut self) {
        self.touches.clear();
    }

    /// Applies [`Touch::torque`] for `duration` milliseconds.
    pub fn push_joints(&mut self, torque: JointVector, duration: u64) {
        self.touch(Touch::torque(torque).lasting(duration));
    }

    /// Applies [`Touch::wrench`] to the end effector for `duration` milliseconds.
    pub fn push_end_effector(&mut self, wrench: Wrench, duration: u64) {
        self.touch(Touch::wrench(wrench).lasting(duration));
    }

    /// Puts the arm at rest at `q`, `[rad]`, as if a person had guided it there. A running motion
    /// ends as if the client had stopped it.
    pub fn place(&mut self, q: &JointVector) {
        self.forget_motion(MoveStatus::Preempted);
        let holding = self.plant.place(q);
        self.train.rest(q, &holding);
        self.interface.clear();
        self.measurement = Measurement::resting(q, &holding, &self.arm.sensors);
        self.desired = Desired::resting(&self.arm(), *q);
        self.activity = Activity::Holding;
        self.refresh_dynamics();
        self.observer = MomentumObserver::new();
        self.estimate = Estimate::new();
        let arm = ArmModel::new(self.kind, &self.model, &self.settings.frames, &self.config);
        self.estimate
            .update(&JointVector::zeros(), self.plant.q(), &arm);
        self.boards = Boards::resting(&self.model, q);
    }

    /// Adds a load to the flange, in addition to the tool and in place of any earlier load. The
    /// robot is not informed. [`Load::NONE`] removes it.
    pub fn attach(&mut self, load: Load) {
        self.load = load;
        self.plant
            .attach(self.arm.body.load(&self.config.tool.load, &load));
    }

    /// Replaces the arm by another arm, at rest in the same position and with the same load, as
    /// [`place`](Self::place) does.
    ///
    /// Tool, settings, client and errors stay. The joint limits and the geometry of the states also
    /// stay, because clients have read them. The [stalls](Arm::stalls) of the robot's network
    /// interface do not change here: see [`Running::with_network`](crate::Running::with_network).
    pub fn fit(&mut self, arm: Arm) {
        let limits = self.arm.limits;
        let mut arm = Arm { limits, ..arm };
        arm.body.state_geometry = self.arm.body.state_geometry;
        let q = *self.plant.q();
        self.plant.fit(self.config.kind, &arm);
        self.as_built = arm.body.as_built(self.config.kind);
        self.interface = TorqueInterface::new(&arm.drive);
        self.arm = arm.clone();
        self.config.arm = Some(arm);
        self.attach(self.load);
        let holding = self.plant.place(&q);
        self.train = DriveTrain::new(&self.arm, &q, &holding);
        self.place(&q);
    }

    /// Passes the command of `hand` to the fingers of the plant, if the plant has fingers, and the
    /// width of these fingers to `hand`. Call this once per millisecond, between
    /// [`tick`](Self::tick) of this robot and `tick` of the hand.
    pub fn couple(&mut self, hand: &mut Hand) {
        let fingers = hand.mechanism_mut();
        if let Some(width) = self.plant.drive_fingers(&fingers.drive()) {
            fingers.feel(width);
        }
    }

    /// True pose of the end effector in the base frame. It includes the errors of the arm as built,
    /// which `O_T_EE` does not show.
    pub fn true_pose(&self) -> Isometry3<f64> {
        let frames = &self.settings.frames;
        let pose = self
            .as_built
            .pose(Frame::EndEffector, self.plant.q(), frames);
        // Frames are rigid transforms, because setters refuse all others.
        transform::isometry(&pose).unwrap_or_else(Isometry3::identity)
    }

    /// True joint positions, `[rad]`.
    pub fn q(&self) -> &JointVector {
        self.plant.q()
    }

    /// True joint velocities, `[rad/s]`.
    pub fn dq(&self) -> &JointVector {
        self.plant.dq()
    }
}
