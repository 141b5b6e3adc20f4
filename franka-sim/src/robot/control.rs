//! One millisecond of control and physics.

use franka_model::{
    CYCLE, EndEffector, GRAVITY_EARTH, JointVector, MassMatrix, Twist, joint_vector,
};
use franka_proto::{MoveControllerMode, MoveStatus, RobotError};
use nalgebra::Matrix4;

use super::operation::Guidance;
use super::recovery::Recovery;
use super::{Activity, Robot};
use crate::arm::Sensors;
use crate::generator::ArmModel;
use crate::law::{Firmness, Law, POSTURE_STIFFNESS, cartesian_impedance, joint_impedance};
use crate::observer::Instant;
use crate::plant::STEPS;
use crate::signal::JointSignal;

/// Sensor readings over the last millisecond.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measurement {
    /// Measured joint positions `q`, `[rad]`.
    pub(super) q: JointVector,
    /// Measured joint velocities `dq`, `[rad/s]`.
    pub(super) dq: JointVector,
    /// Measured joint torques `tau_J`, `[N·m]`.
    pub(super) torque: JointVector,
    /// Derivatives of the measured torques, `dtau_J`, `[N·m/s]`.
    pub(super) torque_rate: JointVector,
    /// Mean joint acceleration, `[rad/s²]`.
    pub(super) ddq: JointVector,
    /// Error of `q` relative to the arm's true position, `[rad]`.
    q_error: JointVector,
    /// Error of `dq` relative to the arm's true velocity, `[rad/s]`.
    dq_error: JointVector,
}

impl Measurement {
    /// Readings of the sensors of an arm that has always been at rest.
    pub(super) fn resting(q: &JointVector, holding: &JointVector, sensors: &Sensors) -> Self {
        Self {
            q: *q,
            dq: JointVector::zeros(),
            torque: holding + sensors.torque_offset,
            torque_rate: JointVector::zeros(),
            ddq: JointVector::zeros(),
            q_error: JointVector::zeros(),
            dq_error: JointVector::zeros(),
        }
    }
}

impl Robot {
    /// Controls the arm for one millisecond. Returns the controller's last torques, without
    /// gravity.
    ///
    /// If control or physics diverges, this function puts the arm at rest in its last position and
    /// raises `instability_detected`. Otherwise a non-finite number would also affect all later
    /// clients.
    pub(super) fn control(&mut self) -> JointVector {
        let before = *self.plant.q();
        let torque = self.drive();
        if self.is_physical() && torque.iter().all(|value| value.is_finite()) {
            return torque;
        }
        self.forget_motion(MoveStatus::ReflexAborted);
        self.place(&before);
        self.reflex(RobotError::InstabilityDetected.into());
        JointVector::zeros()
    }

    /// True if the arm is in a physically possible state: finite, and at velocities below
    /// [`VELOCITY_MAX`].
    fn is_physical(&self) -> bool {
        let Measurement { torque, ddq, .. } = &self.measurement;
        let rest = [
            self.plant.q(),
            torque,
            ddq,
            &self.dynamics.gravity,
            &self.estimate.torque,
        ];
        let mut rest = rest.into_iter().flat_map(|joints| joints.iter());
        let is_slow = self.plant.dq().iter().all(|dq| dq.abs() <= VELOCITY_MAX);
        is_slow && rest.all(|value| value.is_finite())
    }

    fn drive(&mut self) -> JointVector {
        self.advance_desired();
        let law = self.law();
        self.touches.advance(self.clock);
        let limit = match self.are_brakes_holding() {
            true => JointVector::repeat(f64::INFINITY),
            false => self.model.joint_limits().torque,
        };
        let is_external = match &self.activity {
            Activity::Moving(motion) => motion.is_external() && self.frozen.is_none(),
            _ => false,
        };
        if !is_external {
            self.interface.clear();
        }
        let command = match is_external {
            true => self.interface.delayed(law.feedforward),
            false => law.feedforward,
        };
        // The robot's own controllers close their loops around the motors. The brakes close no
        // loop.
        let deflection = self.train.deflection(&self.dynamics.gravity);
        let (q_error, dq_error) = match self.are_brakes_holding() {
            true => (JointVector::zeros(), JointVector::zeros()),
            false => (self.measurement.q_error, self.measurement.dq_error),
        };
        let dq = *self.plant.dq();
        let dt = CYCLE / f64::from(STEPS);
        let mut torque = JointVector::zeros();
        let mut sensed = JointVector::zeros();
        for step in 0..STEPS {
            let into = dt * f64::from(step);
            torque = if is_external {
                self.interface.lagged(&command, dt)
            } else {
                let q = self.train.theta() - deflection + q_error;
                law.torque(&q, &(self.train.dtheta() + dq_error))
            };
            let motor = (torque + self.dynamics.gravity).zip_map(&limit, |t, l| t.clamp(-l, l));
            let (frames, (q, dq)) = (&self.settings.frames, (self.plant.q(), self.plant.dq()));
            let before = *dq;
            let touches = &mut self.touches;
            let external = touches.act(&self.as_built, frames, (q, dq), into, dt);
            self.train.step(self.plant.as_mut(), &motor, &external, dt);
            touches.feel(&((self.plant.dq() - before) / dt));
            sensed += self.train.torque();
        }
        self.measure(&(sensed / f64::from(STEPS)), &dq);
        let is_led = match &self.activity {
            Activity::Moving(motion) => motion.is_torque_only(),
            Activity::Guided(_) => true,
            _ => false,
        };
        if is_led {
            // No generator runs, so the desired motion is the measured motion.
            self.desired.joints = self.measured_signal();
            let arm = ArmModel::new(self.kind, &self.model, &self.settings.frames, &self.config);
            self.desired.follow_joints(&arm);
        }
        torque
    }

    /// Advances a desired motion that the robot itself plans: a stop, or the motion of a recovery.
    fn advance_desired(&mut self) {
        match &mut self.activity {
            Activity::Braking(brake) => {
                self.desired.joints = brake.advance(CYCLE);
                if brake.is_over() {
                    self.activity = Activity::Holding;
                }
            }
            Activity::Holding => match self.recovery.as_mut().and_then(Recovery::way) {
                Some(way) => self.desired.joints = way.advance(&self.desired.joints),
                None => return,
            },
            Activity::Moving(_) | Activity::Guided(_) => return,
        }
        let arm = ArmModel::new(self.kind, &self.model, &self.settings.frames, &self.config);
        self.desired.follow_joints(&arm);
    }

    /// True if the brakes hold the motors to the links. The brakes close once the arm has stopped.
    fn are_brakes_holding(&self) -> bool {
        self.frozen.is_some()
            || self.lock.brakes_closed && matches!(self.activity, Activity::Holding)
    }

    /// Recomputes everything that depends on frames and load.
    pub(super) fn refresh_dynamics(&mut self) {
        self.dynamics = self.model.dynamics(
            &self.measurement.q,
            &self.measurement.dq,
            &self.settings.frames,
            &self.settings.declared_load(),
            &GRAVITY_EARTH,
        );
    }

    fn law(&self) -> Law {
        let armature = self.train.felt_inertia();
        if let Some(frozen) = &self.frozen {
            let stands = JointSignal::resting(frozen.q);
            return joint_impedance(&BRAKE_STIFFNESS, &stands, &self.dynamics, armature);
        }
        let desired = self.attainable();
        let joint = |stiffness: &JointVector| {
            joint_impedance(stiffness, &desired, &self.dynamics, armature)
        };
        let motion = match &self.activity {
            Activity::Moving(motion) => motion,
            Activity::Guided(guidance) => return self.guiding_law(guidance),
            _ if self.are_brakes_holding() => return joint(&BRAKE_STIFFNESS),
            // The robot holds and brakes without the client's stiffness, which may be too low.
            _ => return joint(&self.config.unpublished.joint_stiffness),
        };
        match motion.request().controller {
            MoveControllerMode::ExternalController => Law::constant(*motion.torque()),
            MoveControllerMode::JointImpedance => joint(&self.settings.joint_stiffness),
            MoveControllerMode::CartesianImpedance => cartesian_impedance(
                &Firmness {
                    task: self.settings.cartesian_stiffness,
                    posture: POSTURE_STIFFNESS,
                },
                &self.arm().pose(&desired.q),
                &desired,
                &self.measurement.q,
                &self.model,
                &self.settings.frames,
                &self.dynamics,
                armature,
            ),
        }
    }

    /// Returns gravity compensation with a light damper, and springs in the locked directions.
    fn guiding_law(&self, guidance: &Guidance) -> Law {
        let guiding = &self.settings.guiding;
        // The axes belong to the end effector, not to the stiffness frame.
        let frames = EndEffector {
            ee_t_k: Matrix4::identity(),
            ..self.settings.frames
        };
        let firmness = Firmness {
            task: Twist::from_fn(|i, _| if guiding.axes[i] { 0.0 } else { LOCKED[i] }),
            posture: if guiding.elbow { 0.0 } else { LOCKED_ELBOW },
        };
        let mut law = cartesian_impedance(
            &firmness,
            &self.arm().pose(&guidance.start),
            &JointSignal::resting(guidance.start),
            &self.measurement.q,
            &self.model,
            &frames,
            &self.dynamics,
            self.train.felt_inertia(),
        );
        if let Some(spring) = &mut law.spring {
            spring.damping += MassMatrix::from_diagonal(&GUIDING_DAMPING);
        }
        law
    }

    /// The desired joint signal, with its derivatives limited to the abilities of the arm. The
    /// limits matter only if the robot does not enforce limits on commands: a jump of the desired
    /// position must not cause a jump of the feedforward torque.
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

    /// Records the mean sensor torque of a millisecond. `dq` are the joint velocities at its
    /// beginning.
    fn measure(&mut self, sensed: &JointVector, dq: &JointVector) {
        let sensors = &self.arm.sensors;
        let noise = self.random.joints(&sensors.torque_noise(self.plant.dq()));
        let torque = sensors.quantised(&(sensed + sensors.torque_offset + noise));
        let q_error = self.random.joints(&sensors.position_noise);
        let deviation = sensors.velocity_noise(self.plant.dq());
        let dq_error = self.random.joints(&deviation);
        let measured = Measurement {
            q: self.plant.q() + q_error,
            dq: self.plant.dq() + dq_error,
            q_error,
            dq_error,
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
        let arm = ArmModel::new(self.kind, &self.model, &self.settings.frames, &self.config);
        let external = self.observer.external_torque();
        self.estimate.update(external, &self.measurement.q, &arm);
        if self.kind.version.has_accelerometers() {
            self.boards
                .advance(&self.model, self.plant.q(), self.plant.dq());
        }
    }

    /// Joint signal from which a stop begins: the desired motion if the arm follows it, otherwise
    /// the measured motion of the arm.
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

/// Joint velocity that no arm reaches, `[rad/s]`. Above this velocity, the physics has diverged.
const VELOCITY_MAX: f64 = 1e3;

/// Stiffness of closed brakes, `[N·m/rad]`: the highest stiffness of the internal controller.
const BRAKE_STIFFNESS: JointVector = joint_vector([14_250.0; 7]);

/// Damping of a guided arm, `[N·m·s/rad]`, a choice of the simulator. It stops the arm when nothing
/// pushes it.
const GUIDING_DAMPING: JointVector = joint_vector([2.0, 2.0, 2.0, 2.0, 0.5, 0.5, 0.5]);

/// Stiffness of locked directions of a guided arm, `[N/m, N·m/rad]`: the highest setting of the
/// Cartesian controller.
const LOCKED: [f64; 6] = [3000.0, 3000.0, 3000.0, 300.0, 300.0, 300.0];

/// Stiffness of a locked elbow, `[N·m/rad]`.
const LOCKED_ELBOW: f64 = 300.0;

/// Largest tracking error at which a stop continues from the desired motion, `[rad]`.
const FOLLOWING: f64 = 0.02;
