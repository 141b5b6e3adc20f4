//! Configuration of a simulated robot.

mod unpublished;

pub use unpublished::{
    ErrorBits, Extrapolation, FirstCycles, ForceAxes, Instability, SelfCollision, SetterBounds,
    Setters, StartTolerance, Unpublished,
};

use bytes::Bytes;
use franka_model::{JointVector, Load, READY, RobotKind};
use franka_proto::VirtualWall;
use nalgebra::{Matrix3, Matrix4, Rotation3, Vector3};

use crate::arm::Arm;

/// Configuration of one simulated robot. The default is a Franka Research 3 with a bare flange in
/// the ready pose. It enforces its limits as a real robot does.
#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    /// Kind of the robot. The kind also sets the protocol version.
    pub kind: RobotKind,
    /// Joint positions at the start, `[rad]`.
    pub q: JointVector,
    /// Tool on the flange, as set up in Desk. The robot's model includes it.
    pub tool: Tool,
    /// Load on the flange in addition to the tool. The robot does not know it until a client
    /// declares it with `SetLoad`.
    pub payload: Load,
    /// The arm: friction, drives, sensors, and differences from its model. `None` selects the
    /// [ideal](Arm::ideal) arm of the robot's kind. [`Sim::fr3`](crate::Sim::fr3) and
    /// [`Sim::fer`](crate::Sim::fer) select a realistic arm.
    pub arm: Option<Arm>,
    /// Seed of all random numbers. The same seed and the same input give the same states.
    pub seed: u64,
    /// Value of `message_id` before the first cycle: milliseconds since the robot started.
    pub clock: u64,
    /// True if commands and motions outside the limits cause a reflex (the robot stops itself). If
    /// false, only physics limits the arm.
    pub enforce_limits: bool,
    /// Factor by which the robot multiplies the acceleration and jerk limits of commanded joints.
    /// Use a value above 1 for clients whose commands are rougher than a real robot allows. Default
    /// 1.
    pub joint_discontinuity_scale: f64,
    /// True if 20 lost commands in a row cause a reflex. If false, the motion generator keeps its
    /// setpoint until the next command arrives. A client may then be slower than 1 kHz, or stopped
    /// in a debugger.
    pub enforce_communication: bool,
    /// URDF that the robot serves instead of the built-in description (protocol 10). The simulator
    /// does not check it. Use this field to test clients.
    pub urdf: Option<String>,
    /// Model library that the robot serves to clients of every architecture and operating system
    /// (protocol 5). The licence of the vendor's library does not permit us to distribute it here.
    /// If `None`, the robot answers with an error.
    pub model_library: Option<Bytes>,
    /// Virtual walls, as set up in Desk, each with the number by which clients request it (protocol
    /// 5). Each wall is a cuboid from the origin of its frame to its corner. The end effector stays
    /// inside the cuboid of each active wall.
    pub walls: Vec<(i32, VirtualWall)>,
    /// Assumptions about behaviour that the vendor has not published.
    pub unpublished: Unpublished,
}

impl Config {
    /// Returns [`arm`](Self::arm), or the ideal arm if the field is `None`.
    pub fn chosen_arm(&self) -> Arm {
        self.arm.clone().unwrap_or_else(|| Arm::ideal(self.kind))
    }
}

impl Default for Config {
    fn default() -> Self {
        Self {
            kind: RobotKind::Fr3,
            q: READY,
            tool: Tool::NONE,
            payload: Load::NONE,
            arm: None,
            seed: 1,
            clock: 100_000,
            enforce_limits: true,
            joint_discontinuity_scale: 1.0,
            enforce_communication: true,
            urdf: None,
            model_library: None,
            walls: Vec::new(),
            unpublished: Unpublished::default(),
        }
    }
}

/// A tool on the flange: the nominal end effector of Desk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tool {
    /// Pose of the nominal end effector in the flange frame, `F_T_NE`.
    pub f_t_ne: Matrix4<f64>,
    /// Mass, centre of mass and inertia of the tool: `m_ee`, `F_x_Cee`, `I_ee`.
    pub load: Load,
    /// True if the tool has the shape of the Franka Hand, which the robot includes in its
    /// self-collision check. The robot does not know the shape of any other tool.
    pub has_hand_shape: bool,
}

impl Tool {
    /// The bare flange.
    pub const NONE: Self = Self {
        f_t_ne: Matrix4::new(
            1.0, 0.0, 0.0, 0.0, //
            0.0, 1.0, 0.0, 0.0, //
            0.0, 0.0, 1.0, 0.0, //
            0.0, 0.0, 0.0, 1.0,
        ),
        load: Load::NONE,
        has_hand_shape: false,
    };

    /// Returns the Franka Hand, turned by -45 degrees about the flange axis. Its fingertips are
    /// 0.1034 m from the flange. Its mass is 0.73 kg, the value that Desk declares (the description
    /// files contain 0.7126 kg).
    pub fn hand() -> Self {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), -core::f64::consts::FRAC_PI_4);
        let mut f_t_ne = turn.to_homogeneous();
        f_t_ne[(2, 3)] = 0.1034;
        Self {
            f_t_ne,
            load: Load {
                mass: 0.73,
                com: Vector3::new(-0.01, 0.0, 0.03),
                inertia: Matrix3::from_diagonal(&Vector3::new(0.001, 0.0025, 0.0017)),
            },
            has_hand_shape: true,
        }
    }
}
