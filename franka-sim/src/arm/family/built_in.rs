//! The built-in families of the simulator. The documentation of each field of an arm names the
//! source of its figures.

use super::{Distribution, Elastic, Family, SystemLimits, Values};

impl Family {
    /// Good arms, better than the arms that were measured: little friction, rigid joints.
    pub fn nominal() -> Self {
        Self {
            static_friction: constant([0.33, 0.53, 0.39, 0.77, 0.5, 0.18, 0.34]),
            static_friction_scale: uniform(0.8, 1.2),
            kinetic_ratio: uniform(0.8, 1.0),
            stribeck_speed: constant(0.03),
            bristle_stiffness: constant(2000.0),
            bristle_damping: constant(5.0),
            viscous_friction: uniform(0.0, 0.2),
            link_share: constant(1.0),
            rotor_inertia: constant([0.606, 0.606, 0.462, 0.462, 0.2055, 0.2055, 0.2055]),
            torque_loop_gain: constant(0.0),
            torque_lag: uniform(0.001, 0.003),
            command_delay: constant(1.0),
            elasticity: None,
            ripple_amplitude: constant(0.0),
            ripple_order: constant(0.0),
            pose_torque: constant(0.0),
            torque_offset: normal(0.0, [0.1, 0.15, 0.1, 0.15, 0.08, 0.05, 0.03]),
            torque_quantum: constant([0.025, 0.025, 0.025, 0.025, 0.006, 0.006, 0.006]),
            torque_noise_at_rest: constant([0.03, 0.03, 0.03, 0.03, 0.01, 0.01, 0.01]),
            torque_noise_in_motion: constant([0.03, 0.03, 0.03, 0.03, 0.01, 0.01, 0.01]),
            velocity_noise_at_rest: constant(0.0002),
            velocity_noise_in_motion: constant(0.001),
            position_noise: constant(1e-06),
            mass_error: constant(0.0),
            com_error: constant(0.0),
            axis_error: constant(0.0),
            length_error: constant(0.0),
            state_length_excess: constant(0.0002),
            state_axis_error: constant(0.0),
            state_length_error: constant(0.0),
            undeclared_mass: uniform(0.0, 0.03),
            load_com_error: normal(0.0, 0.005),
            base_tilt: normal(0.0, 0.00105),
            stalls_per_second: constant(0.0),
            motor_offset: constant(0.0),
            limits: SystemLimits::From5_9,
        }
    }

    /// Arms like the arms that were measured.
    pub fn realistic() -> Self {
        Self {
            static_friction: uniform(
                [0.8, 0.85, 0.7, 1.0, 0.65, 0.45, 0.38],
                [1.265, 1.3225, 1.0925, 1.495, 1.2075, 0.69, 0.575],
            ),
            static_friction_scale: uniform(0.8, 1.2),
            kinetic_ratio: uniform(
                [0.8, 0.65, 0.6, 0.65, 0.6, 0.55, 0.45],
                [1.0, 0.95, 0.95, 0.95, 0.95, 0.95, 0.9],
            ),
            stribeck_speed: uniform(
                [0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 0.03],
                [0.1, 0.1, 0.1, 0.1, 0.12, 0.12, 0.15],
            ),
            bristle_stiffness: uniform(
                800.0,
                [6000.0, 6000.0, 6000.0, 6000.0, 6000.0, 6000.0, 20_000.0],
            ),
            bristle_damping: constant(5.0),
            viscous_friction: uniform(
                [0.3, 0.05, 0.25, 0.3, 0.0, 0.0, 0.0],
                [1.5, 0.8, 1.2, 1.2, 0.9, 0.5, 0.4],
            ),
            link_share: uniform(0.3, 0.7),
            rotor_inertia: constant([0.606, 0.606, 0.462, 0.462, 0.2055, 0.2055, 0.2055]),
            torque_loop_gain: uniform(1.5, 4.0),
            torque_lag: uniform(0.002, 0.005),
            command_delay: uniform(1.0, 2.0),
            elasticity: Some(Elastic {
                stiffness: constant([14250.0, 14250.0, 14250.0, 14250.0, 9000.0, 9000.0, 9000.0]),
                damping: constant([30.0, 30.0, 30.0, 30.0, 5.0, 5.0, 5.0]),
            }),
            ripple_amplitude: uniform(
                [0.08, 0.14, 0.03, 0.14, 0.01, 0.01, 0.0],
                [0.22, 0.24, 0.11, 0.22, 0.025, 0.025, 0.005],
            ),
            ripple_order: uniform(
                [239.5, 239.5, 239.5, 239.5, 160.0, 160.0, 160.0],
                [243.0, 243.0, 243.0, 243.0, 160.0, 160.0, 160.0],
            ),
            pose_torque: normal(0.0, [0.15, 0.15, 0.15, 0.15, 0.08, 0.08, 0.08]),
            torque_offset: normal(0.0, [0.25, 0.3, 0.25, 0.3, 0.2, 0.15, 0.2]),
            torque_quantum: constant([0.025, 0.025, 0.025, 0.025, 0.006, 0.006, 0.006]),
            torque_noise_at_rest: constant([0.023, 0.026, 0.023, 0.021, 0.007, 0.007, 0.017]),
            torque_noise_in_motion: constant([0.06, 0.06, 0.06, 0.06, 0.035, 0.035, 0.035]),
            velocity_noise_at_rest: constant(0.0008),
            velocity_noise_in_motion: constant(0.003),
            position_noise: constant(2e-06),
            mass_error: uniform(-0.03, 0.03),
            com_error: uniform(-0.005, 0.005),
            axis_error: normal(0.0, 0.004),
            length_error: normal(0.0, 0.0005),
            state_length_excess: constant(0.0002),
            state_axis_error: constant(0.0),
            state_length_error: constant(0.0),
            undeclared_mass: uniform(0.0, 0.1),
            load_com_error: normal(0.0, 0.02),
            base_tilt: normal(0.0, 0.00436),
            stalls_per_second: constant(7.0),
            motor_offset: uniform(-0.0038, 0.0026),
            limits: SystemLimits::From5_9,
        }
    }

    /// Worn and badly calibrated arms, with an undeclared load.
    pub fn bad() -> Self {
        Self {
            static_friction: uniform(
                [1.045, 1.265, 1.045, 1.43, 1.155, 0.66, 0.55],
                [1.52, 1.84, 1.52, 2.08, 1.68, 0.96, 0.8],
            ),
            static_friction_scale: constant(1.0),
            kinetic_ratio: uniform(0.6, 0.85),
            stribeck_speed: uniform(
                [0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 0.05],
                [0.08, 0.08, 0.08, 0.08, 0.08, 0.08, 0.05],
            ),
            bristle_stiffness: constant(1000.0),
            bristle_damping: constant(5.0),
            viscous_friction: uniform(
                [0.1, 0.08, 0.08, 0.1, 0.09, 0.05, 0.04],
                [1.2, 0.96, 0.96, 1.2, 1.08, 0.6, 0.48],
            ),
            link_share: uniform(0.3, 0.9),
            rotor_inertia: constant([0.606, 0.606, 0.462, 0.462, 0.2055, 0.2055, 0.2055]),
            torque_loop_gain: constant(4.0),
            torque_lag: uniform(0.004, 0.01),
            command_delay: uniform(2.0, 4.0),
            elasticity: Some(Elastic {
                stiffness: constant(7000.0),
                damping: constant([15.0, 15.0, 15.0, 15.0, 3.0, 3.0, 3.0]),
            }),
            ripple_amplitude: constant([0.25, 0.25, 0.25, 0.25, 0.03, 0.03, 0.0]),
            ripple_order: constant([242.0, 242.0, 242.0, 242.0, 160.0, 160.0, 0.0]),
            pose_torque: normal(0.0, [0.25, 0.25, 0.25, 0.25, 0.12, 0.12, 0.12]),
            torque_offset: normal(0.0, [0.45, 0.6, 0.45, 0.6, 0.35, 0.3, 0.25]),
            torque_quantum: constant([0.036, 0.036, 0.036, 0.036, 0.006, 0.006, 0.006]),
            torque_noise_at_rest: constant([0.05, 0.05, 0.05, 0.05, 0.025, 0.025, 0.035]),
            torque_noise_in_motion: constant([0.1, 0.1, 0.1, 0.1, 0.05, 0.05, 0.05]),
            velocity_noise_at_rest: constant(0.0013),
            velocity_noise_in_motion: constant(0.01),
            position_noise: constant(2e-05),
            mass_error: uniform(-0.06, 0.06),
            com_error: uniform(-0.012, 0.012),
            axis_error: normal(0.0, 0.005),
            length_error: normal(0.0, 0.0015),
            state_length_excess: constant(0.0002),
            state_axis_error: constant(0.0),
            state_length_error: constant(0.0),
            undeclared_mass: uniform(0.1, 0.5),
            load_com_error: normal(0.0, 0.04),
            base_tilt: normal(0.0, 0.01222),
            stalls_per_second: constant(15.0),
            motor_offset: uniform(-0.0038, 0.0026),
            limits: SystemLimits::From5_9,
        }
    }
}

fn constant(value: impl Into<Values>) -> Distribution {
    Distribution::Constant(value.into())
}

fn uniform(low: impl Into<Values>, high: impl Into<Values>) -> Distribution {
    let (low, high) = (low.into(), high.into());
    Distribution::Uniform { low, high }
}

fn normal(mean: impl Into<Values>, rms: impl Into<Values>) -> Distribution {
    let (mean, rms) = (mean.into(), rms.into());
    Distribution::Normal { mean, rms }
}
