//! One millisecond of control and physics.

use franka_model::{GRAVITY_EARTH, JointVector, Model};
use franka_proto::MoveControllerMode;

use super::{Activity, Robot};
use crate::generator::Arm;
use crate::law::{Law, cartesian_impedance, joint_impedance};
use crate::plant::Plant;
use crate::settings::JOINT_STIFFNESS;
use crate::signal::{CYCLE, JointSignal};

/// Steps of the plant, and of the innermost control loops, per millisecond.
const STEPS: u32 = 4;

/// What the sensors read over the last millisecond.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measurement {
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
            let arm = Arm {
                kind: self.kind,
                model: self.model,
                frames: &self.settings.frames,
            };
            self.desired.follow_joints(&arm);
            if brake.is_over() {
                self.activity = Activity::Holding;
            }
        }
        let law = self.law();
        let external = self.external_torque();
        let limit = self.model.joint_limits().torque;
        let (q, dq) = (*self.plant.q(), *self.plant.dq());
        let mut torque = JointVector::zeros();
        let mut sensed = JointVector::zeros();
        for _ in 0..STEPS {
            torque = law.torque(self.plant.q(), self.plant.dq());
            let motor = (torque + self.dynamics.gravity).zip_map(&limit, |t, l| t.clamp(-l, l));
            self.plant.step(&motor, &external, CYCLE / f64::from(STEPS));
            sensed += self.plant.sensed_torque();
        }
        self.measure(&(sensed / f64::from(STEPS)), &q, &dq);
        if let Activity::Moving(motion) = &self.activity
            && motion.is_torque_only()
        {
            // Nothing generates a motion: what is desired is what happens.
            self.desired.joints = self.measured_signal();
            let arm = Arm {
                kind: self.kind,
                model: self.model,
                frames: &self.settings.frames,
            };
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
            return joint(&JOINT_STIFFNESS);
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

    /// Takes in the mean sensor torque of the millisecond that began at `q`, `dq`.
    fn measure(&mut self, sensed: &JointVector, q: &JointVector, dq: &JointVector) {
        let ddq = (self.plant.dq() - dq) / CYCLE;
        let explained = self.model.inverse_dynamics(
            &((self.plant.q() + q) / 2.0),
            &((self.plant.dq() + dq) / 2.0),
            &ddq,
            &self.settings.declared_load(),
            &GRAVITY_EARTH,
        );
        let torque = sensed + self.random.joints(self.config.noise.torque);
        self.measurement = Measurement {
            torque_rate: (torque - self.measurement.torque) / CYCLE,
            torque,
            ddq,
        };
        let model: &'static Model = self.model;
        let arm = Arm {
            kind: self.kind,
            model,
            frames: &self.settings.frames,
        };
        self.estimate
            .update(&(torque - explained), self.plant.q(), &arm);
        self.refresh_dynamics();
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
