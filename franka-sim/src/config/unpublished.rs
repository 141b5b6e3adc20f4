//! Assumptions about properties of the robot that the vendor has not published.

use franka_model::{JointVector, Twist, joint_vector};
use franka_proto::CollisionBehavior;

/// Assumptions that replace unpublished properties of the robot. None has been measured. If a
/// client depends on a value, test it with other values, too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unpublished {
    /// Largest permitted distance of the first command of a motion from the commanded values in the
    /// state.
    pub start: StartTolerance,
    /// Smallest singular value of the end effector's Jacobian at which a Cartesian motion may not
    /// start. Default 0.05. A pose that a real robot refuses has the value 0.011. Ordinary poses
    /// have 0.14 to 0.23.
    pub singular: f64,
    /// Smallest singular value of the stiffness frame's Jacobian up to which the estimated wrench
    /// is zero. Default 0.1. In recordings of two Franka Research 3, the first robot reports no
    /// wrench at 0.076 (three states). The second robot reports a wrench at 0.159. The threshold
    /// between these values is unknown.
    pub wrench_singular: f64,
    /// Extrapolation of the orientation in a cycle whose command is lost.
    pub extrapolation: Extrapolation,
    /// Cutoff of a first-order low-pass that the robot itself applies to commands, `[Hz]`. Default
    /// `None`: no filter. A robot of protocol 5 starts with this value, and a client can change it.
    pub command_filter: Option<f64>,
    /// Divisor of `control_command_success_rate` in the first 100 cycles of a motion (100 cycles
    /// are the length of the averaging window).
    pub first_cycles: FirstCycles,
    /// True if an accepted `Move` clears `reflex_reason`. Default true.
    pub move_clears_reason: bool,
    /// True if fields that a motion does not use are zero, as recorded at rest: `O_T_EE_c`,
    /// `elbow_c` and their derivatives under joint setpoints, `tau_J_d` under the robot's own
    /// controllers. No recording of a motion is known. Default true.
    pub zero_fields: bool,
    /// Number of errors that a cycle latches if its command violates several bounds.
    pub error_bits: ErrorBits,
    /// Modes other than Idle in which the robot accepts setters (requests that change a setting).
    pub setters: Setters,
    /// The largest load and frames that setters accept.
    pub setter_bounds: SetterBounds,
    /// Axes of the wrench that the robot compares with the force thresholds.
    pub force_axes: ForceAxes,
    /// Measured joint velocity above which no motion under an external controller may finish,
    /// `[rad/s]`. Infinity permits every velocity. Default 0.1. Under an internal controller, real
    /// robots are known to refuse a motion that finishes while the arm moves.
    pub finish_velocity: f64,
    /// Stiffness of the internal joint impedance controller until a client sets a different one,
    /// `[N·m/rad]`. Default: the values of libfranka 0.21, `examples_common.cpp`.
    pub joint_stiffness: JointVector,
    /// Stiffness of the internal Cartesian impedance controller until a client sets a different
    /// one, in stiffness-frame axes, `[N/m, N·m/rad]`. Default: the values of libfranka 0.21,
    /// `examples_common.cpp`.
    pub cartesian_stiffness: Twist,
    /// Thresholds of contact and collision until a client sets its own thresholds. The defaults for
    /// contact are close to the values in the vendor's examples (20 N·m falling to 12 N·m at the
    /// wrist, 20 N and 25 N·m). The defaults for collision are twice these values.
    pub thresholds: CollisionBehavior,
    /// Joint acceleration above which the thresholds for acceleration phases apply, `[rad/s²]`. The
    /// robot compares the desired acceleration under its own controllers, and the measured
    /// acceleration under a client's controller. Default 1.
    pub accelerating: f64,
    /// Gain of the momentum observer that computes `tau_ext_hat_filtered`, `[1/s]`. It is the
    /// inverse of the observer's time constant. Default 100, about 16 Hz.
    pub observer_gain: f64,
    /// Bounds at which the robot reports that the arm is about to collide with itself.
    pub self_collision: SelfCollision,
    /// Total mechanical power of all joints above which the robot raises `power_limit_violation`,
    /// `[W]`. Default 600. A Franka Research 3 without a load never needs this much power within
    /// its limits.
    pub power: f64,
    /// Condition for the error `instability_detected`.
    pub instability: Instability,
    /// Range of the torque sensors, as a multiple of the nominal torque. Default 1.1.
    pub sensor_range: f64,
    /// Stiffness between motor and link, `[N·m/rad]`. The simulator computes `theta` from it for an
    /// arm with rigid joints. Default 10 000, the published magnitude for joints of this kind.
    pub joint_elasticity: f64,
}

impl Default for Unpublished {
    fn default() -> Self {
        let torque = [20.0, 20.0, 18.0, 18.0, 16.0, 14.0, 12.0];
        let force = [20.0, 20.0, 20.0, 25.0, 25.0, 25.0];
        Self {
            start: StartTolerance::default(),
            singular: 0.05,
            wrench_singular: 0.1,
            extrapolation: Extrapolation::BaseAxes,
            command_filter: None,
            first_cycles: FirstCycles::SoFar,
            move_clears_reason: true,
            zero_fields: true,
            error_bits: ErrorBits::All,
            setters: Setters::default(),
            setter_bounds: SetterBounds::default(),
            force_axes: ForceAxes::default(),
            finish_velocity: 0.1,
            joint_stiffness: joint_vector([3000.0, 3000.0, 3000.0, 2500.0, 2500.0, 2000.0, 2000.0]),
            cartesian_stiffness: Twist::new(3000.0, 3000.0, 3000.0, 300.0, 300.0, 300.0),
            thresholds: CollisionBehavior::uniform(
                torque,
                torque.map(|t| 2.0 * t),
                force,
                force.map(|f| 2.0 * f),
            ),
            accelerating: 1.0,
            observer_gain: 100.0,
            self_collision: SelfCollision::default(),
            power: 600.0,
            instability: Instability::default(),
            sensor_range: 1.1,
            joint_elasticity: 1e4,
        }
    }
}

/// Largest distance of the first command of a motion from the commanded values in the state. The
/// defaults permit the commands of clients that start from measured values. The defaults are below
/// the distances that robots are known to refuse: 0.2 rad on joint 1, 0.5 rad of the elbow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartTolerance {
    /// Largest distance of each joint, `[rad]`. Default 0.1.
    pub joint: f64,
    /// Largest distance of the end effector's position, `[m]`. Default 0.05.
    pub translation: f64,
    /// Largest angle between the orientations, `[rad]`. Default 0.1.
    pub rotation: f64,
    /// Largest distance of the elbow angle, `[rad]`. Default 0.1.
    pub elbow: f64,
}

impl Default for StartTolerance {
    fn default() -> Self {
        Self {
            joint: 0.1,
            translation: 0.05,
            rotation: 0.1,
            elbow: 0.1,
        }
    }
}

/// Extrapolation of the orientation in a cycle whose Cartesian command is lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Extrapolation {
    /// Constant angular acceleration in the axes of the base, as for the translation.
    #[default]
    BaseAxes,
    /// Constant angular acceleration in the axes of the end effector.
    BodyAxes,
    /// The orientation does not change.
    Held,
}

/// Divisor of the success rate before 100 cycles of a motion have passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FirstCycles {
    /// Number of cycles since the first command.
    #[default]
    SoFar,
    /// Length of the whole window, 100 cycles.
    Window,
}

/// Errors that the robot latches in a cycle whose command violates several bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ErrorBits {
    /// All errors, as public reports of robots show.
    #[default]
    All,
    /// Only the first error, in the order of the protocol.
    First,
}

/// Modes other than Idle in which the robot accepts setters. It never accepts setters in a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Setters {
    /// True if the robot accepts setters after a reflex. Default true.
    pub reflex: bool,
    /// True if the robot accepts setters while a person guides the arm. Default true.
    pub guiding: bool,
    /// True if the robot accepts setters while the user stop is pressed. Default true.
    pub user_stopped: bool,
    /// True if the robot accepts setters while the brakes are closed and during a recovery. Default
    /// true.
    pub other: bool,
}

impl Default for Setters {
    fn default() -> Self {
        Self {
            reflex: true,
            guiding: true,
            user_stopped: true,
            other: true,
        }
    }
}

/// Bounds on the arguments of setters. The robot refuses values beyond them as invalid. Larger
/// values are physically possible, but the controllers could not hold such an arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SetterBounds {
    /// Largest mass of a declared load, `[kg]`. Default 10, about three times the payload of the
    /// arms.
    pub mass: f64,
    /// Largest distance of the load's centre of mass from the flange, `[m]`. Default 1.
    pub com: f64,
    /// Largest principal moment of inertia of the load, `[kg·m²]`. Default 1.
    pub inertia: f64,
    /// Largest translation of `NE_T_EE` and `EE_T_K`, `[m]`. Default 2.
    pub translation: f64,
}

impl Default for SetterBounds {
    fn default() -> Self {
        Self {
            mass: 10.0,
            com: 1.0,
            inertia: 1.0,
            translation: 2.0,
        }
    }
}

/// Axes of the wrench that the robot compares with the force thresholds. With both values, the
/// wrench refers to the origin of the stiffness frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ForceAxes {
    /// Axes of the base.
    #[default]
    Base,
    /// Axes of the stiffness frame: `K_F_ext_hat_K`.
    Stiffness,
}

/// Bounds of the robot's check for self-collision, which uses the vendor's capsules.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SelfCollision {
    /// Distance `[m]` between two capsules below which the robot does not let them approach each
    /// other. Default 0.05.
    pub margin: f64,
    /// Distance by which two capsules within the margin may approach each other, measured from
    /// their largest distance so far, `[m]`. Default 0.001. A motion out of the margin is always
    /// possible.
    pub closing: f64,
    /// Least difference of the link numbers of a checked pair; a tool counts as link 8. Default 3,
    /// because links with a smaller difference come close to each other in ordinary postures.
    pub apart: u8,
}

impl Default for SelfCollision {
    fn default() -> Self {
        Self {
            margin: 0.05,
            closing: 0.001,
            apart: 3,
        }
    }
}

/// Condition for a joint that oscillates: its velocity reverses more often, and with a larger
/// amplitude, than the acceleration limits permit in a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instability {
    /// Smallest velocity in each direction for a reversal to count, `[rad/s]`. Default 0.15.
    pub velocity: f64,
    /// Number of reversals within [`window`](Self::window). Default 8. With 0.15 rad/s to each
    /// side, 8 reversals in 0.1 s require 24 rad/s² on average. No robot permits commands above 20
    /// rad/s².
    pub reversals: u32,
    /// Length of the window in milliseconds. Default 100.
    pub window: u32,
}

impl Default for Instability {
    fn default() -> Self {
        Self {
            velocity: 0.15,
            reversals: 8,
            window: 100,
        }
    }
}
