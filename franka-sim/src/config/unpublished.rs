//! Assumptions about the robot where the vendor has published nothing.

use franka_model::{JointVector, Twist, joint_vector};
use franka_proto::CollisionBehavior;

/// Assumptions about the robot where nothing is published. None has been measured; a client that
/// depends on one of them may be tested against others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unpublished {
    /// Largest distance of the first command of a motion from the values that the state publishes
    /// as commanded.
    pub start: StartTolerance,
    /// Smallest singular value of the end effector's Jacobian at which a Cartesian motion may not
    /// start. Default 0.05. A pose that a robot refuses has 0.011; ordinary poses have 0.14
    /// to 0.23.
    pub singular: f64,
    /// Smallest singular value of the stiffness frame's Jacobian up to which the estimated wrench
    /// is zero. Default 0.1. Of two recorded Franka Research 3, one has no wrench at 0.076, in
    /// three states, and the other has one at 0.159. The range between is unknown.
    pub wrench_singular: f64,
    /// Extrapolation of the orientation in a cycle whose command is lost.
    pub extrapolation: Extrapolation,
    /// Cutoff of a first-order low-pass that the robot itself applies to commands, `[Hz]`. Default
    /// `None`: no filter. Protocol 5 begins with this and has a request to change it.
    pub command_filter: Option<f64>,
    /// Divisor of `control_command_success_rate` while a motion is younger than its window of 100
    /// cycles.
    pub first_cycles: FirstCycles,
    /// True if an accepted `Move` clears `reflex_reason`. Default yes.
    pub move_clears_reason: bool,
    /// True if fields that a motion does not use are zero, as recorded at rest: `O_T_EE_c`,
    /// `elbow_c` and their derivatives under joint setpoints, `tau_J_d` under the robot's own
    /// controllers. In motion nothing was recorded. Default yes.
    pub zero_fields: bool,
    /// Number of errors that a cycle latches if it breaks several bounds.
    pub error_bits: ErrorBits,
    /// The modes besides Idle in which the robot accepts setters.
    pub setters: Setters,
    /// The largest load and frames that setters accept.
    pub setter_bounds: SetterBounds,
    /// Axes in which force thresholds are compared.
    pub force_axes: ForceAxes,
    /// Measured joint velocity above which no motion under an external controller may finish,
    /// `[rad/s]`; infinite for a robot that permits it. Default 0.1: robots are known to refuse
    /// motions under internal controllers that finish at speed.
    pub finish_velocity: f64,
    /// Stiffness of the internal joint impedance controller until a client sets another,
    /// `[N·m/rad]`. Default: the values of libfranka 0.21, `examples_common.cpp`.
    pub joint_stiffness: JointVector,
    /// Stiffness of the internal Cartesian impedance controller until a client sets another, in
    /// stiffness-frame axes, `[N/m, N·m/rad]`. Default: from the same file.
    pub cartesian_stiffness: Twist,
    /// Thresholds of contact and collision until a client sets others. Default for contact: near
    /// the values of the vendor's examples (20 N·m falling to 12 N·m at the wrist, 20 N and 25
    /// N·m). Default for collision: twice these values.
    pub thresholds: CollisionBehavior,
    /// Joint acceleration from which the thresholds for acceleration phases hold, `[rad/s²]`: the
    /// desired one under the robot's own controllers, the measured one under a client's. Default 1.
    pub accelerating: f64,
    /// Gain of the momentum observer behind `tau_ext_hat_filtered`, `[1/s]`: the inverse of the
    /// time constant with which it follows. Default 100, about 16 Hz.
    pub observer_gain: f64,
    /// Bounds from which the arm counts as about to hit itself.
    pub self_collision: SelfCollision,
    /// Mechanical power of all joints together that raises `power_limit_violation`, `[W]`.
    /// Default 600, more than any motion within the limits of a Franka Research 3 requires without
    /// a load.
    pub power: f64,
    /// Condition for `instability_detected`.
    pub instability: Instability,
    /// Range of the torque sensors over the nominal torque. Default 1.1.
    pub sensor_range: f64,
    /// Stiffness between motor and link used to compute `theta` for an arm with rigid joints,
    /// `[N·m/rad]`. Default 10 000, about the magnitude that is published for this kind of joint.
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

/// Largest distance of a first command from the published values. The defaults lie between the
/// commands of clients that start from measured values and the commands that robots are known to
/// refuse (0.2 rad on joint 1, 0.5 rad of elbow).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartTolerance {
    /// Per joint, `[rad]`. Default 0.1.
    pub joint: f64,
    /// `[m]`. Default 0.05.
    pub translation: f64,
    /// `[rad]`. Default 0.1.
    pub rotation: f64,
    /// `[rad]`. Default 0.1.
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

/// Extrapolation of the orientation of a lost Cartesian command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Extrapolation {
    /// With constant angular acceleration in base axes, like the translation.
    #[default]
    BaseAxes,
    /// With constant angular acceleration in the axes of the end effector.
    BodyAxes,
    /// The orientation stays.
    Held,
}

/// Divisor of the success rate before 100 cycles have passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FirstCycles {
    /// The cycles since the first command.
    #[default]
    SoFar,
    /// The whole window.
    Window,
}

/// Errors of a cycle that breaks several bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ErrorBits {
    /// All of them, as public reports of robots show.
    #[default]
    All,
    /// The first in the order of the wire.
    First,
}

/// Modes besides Idle in which the robot accepts setters. It never accepts them in a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Setters {
    /// After a reflex. Default yes.
    pub reflex: bool,
    /// While guided. Default yes.
    pub guiding: bool,
    /// With the user stop pressed. Default yes.
    pub user_stopped: bool,
    /// With the brakes closed, and during a recovery. Default yes.
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

/// Bounds of a setter's arguments; values beyond them are invalid. Larger values would be physical,
/// but would drive the controllers of an arm at rest out of any range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SetterBounds {
    /// Mass of a declared load, `[kg]`. Default 10: three times the arms' payload.
    pub mass: f64,
    /// Distance of the load's centre of mass from the flange, `[m]`. Default 1.
    pub com: f64,
    /// Largest principal moment of inertia of the load, `[kg·m²]`. Default 1.
    pub inertia: f64,
    /// Translation of `NE_T_EE` and `EE_T_K`, `[m]`. Default 2.
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

/// Axes of the wrench that is compared with force thresholds. Its point is the origin of the
/// stiffness frame in either case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ForceAxes {
    /// Axes of the base.
    #[default]
    Base,
    /// Axes of the stiffness frame: `K_F_ext_hat_K`.
    Stiffness,
}

/// Collision of the arm with itself, by the vendor's capsules.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SelfCollision {
    /// Distance between two capsules below which they must not approach each other, `[m]`.
    /// Default 0.05.
    pub margin: f64,
    /// Distance that they may still approach, from their largest distance so far, `[m]`.
    /// Default 0.001. A motion out of the margin is always possible.
    pub closing: f64,
    /// Least number of links between the two along the chain; a tool counts as link 8. Default 3:
    /// closer links come near each other in everyday postures.
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

/// A joint that shakes: its velocity reverses again and again, faster and wider than any motion
/// within the limits on acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instability {
    /// Velocity to either side that counts, `[rad/s]`. Default 0.15.
    pub velocity: f64,
    /// Reversals within [`window`](Self::window). Default 8. With 0.15 rad/s to each side, 8
    /// reversals in 0.1 s require 24 rad/s² on average. Commands may have 20 rad/s² at most, on the
    /// robot with the widest limits.
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
