//! One millisecond of control and physics.

use franka_model::{GRAVITY_EARTH, JointVector};
use franka_proto::MoveControllerMode;

use super::{Activity, Robot};
use crate::generator::Arm;
use crate::law::{Law, cartesian_impedance, joint_impedance};
use crate::observer::Instant;
use crate::plant::Plant;
use crate::signal::{CYCLE, JointSignal};

/// Steps of the plant, and of the innermost control loops, per millisecond.
const STEPS: u32 = 4;

/// What the sensors read over the last millisecond.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measurement {
    /// `q`, `[rad]`.
    pub(super) q: JointVector,
    /// `dq`, `[rad/s]`.
    pub(super) dq: JointVector,
    /// `tau_J`, `[N·m]`.
    pub(super) torque: JointVector,
    /// `dtau_J`, `[N·m/s]`.
    pub(super) torque_rate: JointVector,
    /// Mean joint acceleration, `[rad/s²]`.
    pub(super) ddq: JointVector,
}

impl Measurement {
    /// An arm that has always been still.
    pub(super) fn resting(plant: &dyn Plant) -> Self {
        Self {
            q: *plant.q(),
            dq: *plant.dq(),
            torque: *plant.sensed_torque(),
            torque_rate: JointVector::zeros(),
            ddq: JointVector::zeros(),
        }
    }
}

impl Robot {
    /// Drives the arm for one millisecond; returns the controller's last torques, gravity excluded.
    pub(super) fn control(&mut self) -> JointVector {
        if let Activity::Braking(brake) = &mut self.activity {
            self.desired.joints = brake.advance(CYCLE);
            let arm = Arm::new(self.kind, self.model, &self.settings.frames, &self.config);
            self.desired.follow_joints(&arm);
            if brake.is_over() {
                self.activity = Activity::Holding;
            }
        }
        let law = self.law();
        let external = self.external_torque();
        let limit = self.model.joint_limits().torque;
        let dq = *self.plant.dq();
        let mut torque = JointVector::zeros();
        let mut sensed = JointVector::zeros();
        for _ in 0..STEPS {
            torque = law.torque(self.plant.q(), self.plant.dq());
            let motor = (torque + self.dynamics.gravity).zip_map(&limit, |t, l| t.clamp(-l, l));
            self.plant.step(&motor, &external, CYCLE / f64::from(STEPS));
            sensed += self.plant.sensed_torque();
        }
        self.measure(&(sensed / f64::from(STEPS)), &dq);
        if let Activity::Moving(motion) = &self.activity
            && motion.is_torque_only()
        {
            // Nothing generates a motion: what is desired is what happens.
            self.desired.joints = self.measured_signal();
            let arm = Arm::new(self.kind, self.model, &self.settings.frames, &self.config);
            self.desired.follow_joints(&arm);
        }
        torque
    }

    /// Recomputes what depends on frames and load.
    pub(super) fn refresh_dynamics(&mut self) {
        self.dynamics = self.model.dynamics(
            self.plant.q(),
            self.plant.dq(),
            &self.settings.frames,
            &self.settings.declared_load(),
            &GRAVITY_EARTH,
        );
    }

    fn law(&self) -> Law {
        let armature = self.plant.armature();
        let desired = self.attainable();
        let joint = |stiffness: &JointVector| {
            joint_impedance(stiffness, &desired, &self.dynamics, armature)
        };
        let Activity::Moving(motion) = &self.activity else {
            // Holding and braking are the robot's own business: a soft setting does not weaken it.
            return joint(&self.config.unpublished.joint_stiffness);
        };
        match motion.request().controller {
            MoveControllerMode::ExternalController => Law::constant(*motion.torque()),
            MoveControllerMode::JointImpedance => joint(&self.settings.joint_stiffness),
            MoveControllerMode::CartesianImpedance => cartesian_impedance(
                &self.settings.cartesian_stiffness,
                &self.arm().pose(&desired.q),
                &desired,
                self.plant.q(),
                self.model,
                &self.settings.frames,
                &self.dynamics,
                armature,
            ),
        }
    }

    /// The desired joints with derivatives that the arm can have. They always can unless limits are
    /// not enforced: then a jump in position must not become a blow of feedforward torque.
    fn attainable(&self) -> JointSignal {
        let limits = self.model.joint_limits();
        let within =
            |value: &JointVector, limit: &JointVector| value.zip_map(limit, |v, l| v.clamp(-l, l));
        let desired = &self.desired.joints;
        if let Activity::Moving(motion) = &self.activity
            && motion.is_paused()
        {
            return JointSignal::resting(desired.q);
        }
        JointSignal {
            q: desired.q,
            dq: within(&desired.dq, &limits.velocity),
            ddq: within(&desired.ddq, &limits.acceleration),
        }
    }

    /// Takes in the mean sensor torque of the millisecond that began with joint velocities `dq`.
    fn measure(&mut self, sensed: &JointVector, dq: &JointVector) {
        let noise = self.config.noise;
        let torque = sensed + self.random.joints(noise.torque);
        let measured = Measurement {
            q: self.plant.q() + self.random.joints(noise.position),
            dq: self.plant.dq() + self.random.joints(noise.velocity),
            ddq: (self.plant.dq() - dq) / CYCLE,
            torque_rate: (torque - self.measurement.torque) / CYCLE,
            torque,
        };
        let before = Instant::new(&self.measurement.dq, &self.dynamics);
        self.measurement = measured;
        self.refresh_dynamics();
        let after = Instant::new(&self.measurement.dq, &self.dynamics);
        let gain = self.config.unpublished.observer_gain;
        self.observer.update(&before, &after, &torque, gain);
        let arm = Arm::new(self.kind, self.model, &self.settings.frames, &self.config);
        let external = self.observer.external_torque();
        self.estimate.update(external, self.plant.q(), &arm);
    }

    /// The reference from which a stop begins: the desired motion where the arm follows it, else
    /// the arm's own.
    pub(super) fn brake_start(&self, follows_desired: bool) -> JointSignal {
        let measured = self.measured_signal();
        let desired = &self.desired.joints;
        if follows_desired && (desired.q - measured.q).amax() < FOLLOWING {
            *desired
        } else {
            measured
        }
    }
}

/// Up to this tracking error a stop continues the desired motion, `[rad]`.
const FOLLOWING: f64 = 0.02;
