//! Sensor errors.

use franka_model::{JointVector, joint_vector};

/// Errors of the sensors. Noise is white: its values in successive milliseconds are independent.
/// Each noise is given as its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensors {
    /// Zero error of the torque sensors, `[N·m]`: `tau_J` is higher by this value, and the torque
    /// of the torque loop is lower by this value. Sources: `tau_J` at rest minus the gravity
    /// torques of the model, in published states of two FERs and two FR3s; MTI TU Berlin, five
    /// Pandas.
    pub torque_offset: JointVector,
    /// Steps of `tau_J`, `[N·m]`; 0 for none. Source: states in documentation and issues, 0.025
    /// (joints 1 to 4) and 0.006 (joints 5 to 7).
    pub torque_quantum: JointVector,
    /// Noise of `tau_J` at rest, `[N·m]`. Source: a recorded Franka Research 3, 0.007 to 0.027,
    /// including the effect of the steps.
    pub torque_noise_at_rest: JointVector,
    /// Noise of `tau_J` at 1 rad/s and above, `[N·m]`. Between rest and 1 rad/s, the noise grows
    /// with the speed. Source: the log of Gaz et al., in motion, 0.03 to 0.08.
    pub torque_noise_in_motion: JointVector,
    /// Noise of `dq` at rest, `[rad/s]`. Sources: published states, 5e-4; a recorded Franka
    /// Research 3, 7e-4 to 9e-4.
    pub velocity_noise_at_rest: JointVector,
    /// Noise of `dq` at 1 rad/s and above, `[rad/s]`. Between rest and 1 rad/s, the noise grows
    /// with the speed. Source: the log of Gaz et al., 0.002 to 0.01.
    pub velocity_noise_in_motion: JointVector,
    /// Noise of `q`, `[rad]`. Source: a recorded Franka Research 3, 1.5e-6 to 2.2e-6.
    pub position_noise: JointVector,
    /// Zero error of the motors' positions: `theta` is higher by this value, `[rad]`. Source: a
    /// Franka Research 3, -3.8e-3 to 2.6e-3, different in each session. A Franka Emika Robot has no
    /// such error.
    pub motor_offset: JointVector,
}

impl Sensors {
    /// Perfect sensors.
    pub const PERFECT: Self = Self {
        torque_offset: joint_vector([0.0; 7]),
        torque_quantum: joint_vector([0.0; 7]),
        torque_noise_at_rest: joint_vector([0.0; 7]),
        torque_noise_in_motion: joint_vector([0.0; 7]),
        velocity_noise_at_rest: joint_vector([0.0; 7]),
        velocity_noise_in_motion: joint_vector([0.0; 7]),
        position_noise: joint_vector([0.0; 7]),
        motor_offset: joint_vector([0.0; 7]),
    };

    /// Sensors whose noise a controller must handle. The magnitudes are choices of this simulator,
    /// not measurements.
    pub const NOISY: Self = Self {
        torque_noise_at_rest: joint_vector([0.05; 7]),
        torque_noise_in_motion: joint_vector([0.05; 7]),
        velocity_noise_at_rest: joint_vector([2e-3; 7]),
        velocity_noise_in_motion: joint_vector([2e-3; 7]),
        position_noise: joint_vector([5e-6; 7]),
        ..Self::PERFECT
    };

    /// Noise of `dq` at these velocities, `[rad/s]`.
    pub(crate) fn velocity_noise(&self, dq: &JointVector) -> JointVector {
        between(
            &self.velocity_noise_at_rest,
            &self.velocity_noise_in_motion,
            dq,
        )
    }

    /// Noise of `tau_J` at these velocities, `[N·m]`.
    pub(crate) fn torque_noise(&self, dq: &JointVector) -> JointVector {
        between(&self.torque_noise_at_rest, &self.torque_noise_in_motion, dq)
    }

    /// Rounds a torque to the sensors' steps, `[N·m]`.
    pub(crate) fn quantised(&self, torque: &JointVector) -> JointVector {
        torque.zip_map(&self.torque_quantum, |torque, quantum| match quantum {
            0.0 => torque,
            _ => (torque / quantum).round() * quantum,
        })
    }
}

/// Standard deviation between `rest` and `motion`. The value is `motion` at 1 rad/s and above.
fn between(rest: &JointVector, motion: &JointVector, dq: &JointVector) -> JointVector {
    JointVector::from_fn(|i, _| rest[i] + (motion[i] - rest[i]) * dq[i].abs().min(1.0))
}
