//! Actions of a person on the arm: push, hold, add a load. The user stop, the brakes and the
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

    /// Mean wrench of a touch on the arm in the last millisecond, as `[force; torque]` about the
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

    /// Puts the arm at rest at `q`, `[rad]`, as if a person had guided it there. If a motion is
    /// running, it ends as if the client had stopped it.
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

    /// Adds a load to the flange, in addition to the tool. The load replaces any load that was
    /// attached before. The robot's model does not include it. [`Load::NONE`] removes the load.
    pub fn attach(&mut self, load: Load) {
        self.load = load;
        self.plant
            .attach(self.arm.body.load(&self.config.tool.load, &load));
    }

    /// Replaces the arm by another arm, at rest in the same position and with the same load, as
    /// [`place`](Self::place) does.
    ///
    /// Tool, settings, client and errors do not change. The joint limits and the geometry of the
    /// states do not change either, because clients have read them. This function does not change
    /// the [stalls](Arm::stalls) of the robot's network interface: see
    /// [`Running::with_network`](crate::Running::with_network).
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

    /// If the plant has fingers, passes the command of `hand` to these fingers, and their width to
    /// `hand`. Call this function once per millisecond, after the robot's [`tick`](Self::tick) and
    /// before the hand's `tick`.
    pub fn couple(&mut self, hand: &mut Hand) {
        let fingers = hand.mechanism_mut();
        if let Some(width) = self.plant.drive_fingers(&fingers.drive()) {
            fingers.feel(width);
        }
    }

    /// True pose of the end effector in the base frame. It includes the deviations of the real arm
    /// from its model, which `O_T_EE` does not show.
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
