//! Touches: external actions on the arm, such as pushes, springs, grips, walls, and blocked joints.

mod present;

use franka_model::{Frame, JointVector, Wrench};
use nalgebra::{Isometry3, Vector3};

use crate::signal::stack;

pub(super) use present::Touches;

/// An external action on the arm, at one place and for a limited time.
///
/// Positive torques push joints towards positive angles. Forces, positions and velocities are in
/// base axes. The effects of several touches add up. Pass a touch to
/// [`Robot::touch`](super::Robot::touch):
///
/// ```
/// use franka_model::{Frame, Wrench};
/// use franka_sim::{Config, Robot, Touch};
/// use nalgebra::Vector3;
///
/// let mut robot = Robot::new(Config::default());
/// // Two seconds of a swaying push on the elbow.
/// let sway = |t: f64| Wrench::new(0.0, 4.0 * (3.0 * t).sin(), 0.0, 0.0, 0.0, 0.0);
/// robot.touch(Touch::over_time(sway).at(Frame::Joint4).lasting(2000));
/// // A table below the hand, until it is taken away.
/// let table = robot.touch(Touch::wall(Vector3::new(0.0, 0.0, 0.3), Vector3::z()));
/// for _ in 0..2000 {
///     robot.tick();
/// }
/// robot.release(table);
/// ```
pub struct Touch {
    effort: Effort,
    frame: Frame,
    /// Offset of the touched point from the frame's origin, in the axes of the frame, `[m]`.
    offset: Vector3<f64>,
    lasts: Option<u64>,
}

/// Identifier of a touch, to read its effect and to end it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TouchId(u64);

enum Effort {
    Torque(JointVector),
    Wrench(Wrench),
    OverTime(Box<dyn FnMut(f64) -> Wrench + Send>),
    Spring {
        to: Vector3<f64>,
        spring: Spring,
    },
    /// A spring between the touched point and a moving point.
    Carry {
        path: Box<dyn FnMut(f64) -> Vector3<f64> + Send>,
        /// Position and velocity of the point at the beginning of this millisecond, `[m]`, `[m/s]`.
        point: Vector3<f64>,
        velocity: Vector3<f64>,
        spring: Spring,
    },
    /// Holds the pose that the touched frame had at the beginning of the touch.
    Hold {
        pose: Option<Isometry3<f64>>,
        linear: Spring,
        angular: Spring,
    },
    /// Holds the angle that a joint had at the beginning of the touch.
    Block {
        index: usize,
        angle: Option<f64>,
    },
    Wall {
        point: Vector3<f64>,
        normal: Vector3<f64>,
        spring: Spring,
    },
}

/// Stiffness and damping, `[N/m]` and `[N·s/m]`, or in rotational units.
#[derive(Debug, Clone, Copy)]
struct Spring {
    stiffness: f64,
    damping: f64,
}

impl Touch {
    /// Constant torques on the joints, `[N·m]`.
    pub fn torque(torque: JointVector) -> Self {
        Self::new(Effort::Torque(torque))
    }

    /// A constant force, `[N]`.
    pub fn force(force: Vector3<f64>) -> Self {
        Self::wrench(stack(&force, &Vector3::zeros()))
    }

    /// A constant wrench `[force; torque]` about the touched point, `[N, N·m]`.
    pub fn wrench(wrench: Wrench) -> Self {
        Self::new(Effort::Wrench(wrench))
    }

    /// A wrench `[N, N·m]` as a function of the time since the touch began, `[s]`. The simulator
    /// calls the function once per millisecond.
    pub fn over_time(wrench: impl FnMut(f64) -> Wrench + Send + 'static) -> Self {
        Self::new(Effort::OverTime(Box::new(wrench)))
    }

    /// A spring that pulls the touched point to `to`, `[m]`, with this stiffness, `[N/m]`. The
    /// damping is nearly critical for the apparent mass of the end of an arm.
    pub fn spring(to: Vector3<f64>, stiffness: f64) -> Self {
        Self::new(Effort::Spring {
            to,
            spring: Spring::damped(stiffness, FELT_MASS),
        })
    }

    /// A spring of this stiffness, `[N/m]`, to a moving point. It can represent a hand that leads
    /// the arm, or an object that hits the arm and stays in contact. `path` returns the point `[m]`
    /// for the time since the touch began, `[s]`. The simulator calls `path` once per millisecond.
    /// The damper acts on the velocity relative to the point.
    pub fn carry(path: impl FnMut(f64) -> Vector3<f64> + Send + 'static, stiffness: f64) -> Self {
        Self::new(Effort::Carry {
            path: Box::new(path),
            point: Vector3::zeros(),
            velocity: Vector3::zeros(),
            spring: Spring::damped(stiffness, FELT_MASS),
        })
    }

    /// A firm grip that keeps the current position and orientation of the touched frame.
    pub fn hold() -> Self {
        Self::new(Effort::Hold {
            pose: None,
            linear: Spring::damped(FIRM, FELT_MASS),
            angular: Spring::damped(FIRM_TURN, FELT_INERTIA),
        })
    }

    /// Blocks a joint, 1 to 7, in both directions.
    ///
    /// # Panics
    /// Panics if no joint has this number.
    pub fn block(joint: usize) -> Self {
        assert!((1..=7).contains(&joint), "joint {joint}, expected 1 to 7");
        Self::new(Effort::Block {
            index: joint - 1,
            angle: None,
        })
    }

    /// A wall or table: the touched point cannot move behind the plane through `point`, `[m]`.
    /// `normal` points to the free side. The wall has no friction and yields by a millimetre at 20
    /// N. When an arm leaves the wall, the wall adds 0.1 kg to the arm's apparent mass for a
    /// quarter of a millisecond.
    ///
    /// # Panics
    /// Panics if the length of the normal is zero.
    pub fn wall(point: Vector3<f64>, normal: Vector3<f64>) -> Self {
        let length = normal.norm();
        assert!(length > 0.0, "a plane without a normal");
        Self::new(Effort::Wall {
            point,
            normal: normal / length,
            spring: Spring::damped(FIRM, FELT_MASS),
        })
    }

    /// Sets the stiffness, `[N/m]`, of a spring, a wall, or the translation of a grip, and the
    /// damping that matches the stiffness. Other touches have no stiffness. Any stiffness is
    /// stable. If a touch begins far from its point, its first force is the stiffness times the
    /// distance.
    pub fn stiffness(mut self, stiffness: f64) -> Self {
        match &mut self.effort {
            Effort::Spring { spring, .. }
            | Effort::Carry { spring, .. }
            | Effort::Wall { spring, .. }
            | Effort::Hold { linear: spring, .. } => {
                *spring = Spring::damped(stiffness, FELT_MASS);
            }
            Effort::Torque(_) | Effort::Wrench(_) | Effort::OverTime(_) | Effort::Block { .. } => {}
        }
        self
    }

    /// Selects the frame on which the touch acts. Default: the end effector.
    pub fn at(mut self, frame: Frame) -> Self {
        self.frame = frame;
        self
    }

    /// Sets the touched point to `offset` from the frame's origin, in the frame's axes, `[m]`.
    pub fn offset(mut self, offset: Vector3<f64>) -> Self {
        self.offset = offset;
        self
    }

    /// Limits the duration of the touch, in milliseconds. Default: until
    /// [`Robot::release`](super::Robot::release).
    pub fn lasting(mut self, milliseconds: u64) -> Self {
        self.lasts = Some(milliseconds);
        self
    }

    fn new(effort: Effort) -> Self {
        Self {
            effort,
            frame: Frame::EndEffector,
            offset: Vector3::zeros(),
            lasts: None,
        }
    }
}

impl core::fmt::Debug for Touch {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let effort: &dyn core::fmt::Debug = match &self.effort {
            Effort::Torque(torque) => torque,
            Effort::Wrench(wrench) => wrench,
            Effort::OverTime(_) => &"over time",
            Effort::Spring { .. } => &"spring",
            Effort::Carry { .. } => &"moving spring",
            Effort::Hold { .. } => &"hold",
            Effort::Block { .. } => &"block",
            Effort::Wall { .. } => &"wall",
        };
        f.debug_struct("Touch")
            .field("effort", effort)
            .field("frame", &self.frame)
            .field("lasts", &self.lasts)
            .finish_non_exhaustive()
    }
}

impl Spring {
    /// A spring that is critically damped for a mass or inertia.
    fn damped(stiffness: f64, inertia: f64) -> Self {
        Self {
            stiffness,
            damping: 2.0 * (stiffness * inertia).sqrt(),
        }
    }

    /// Force at the end of a step of `dt` seconds without acceleration. `stretch` is the spring's
    /// stretch at the start, which `velocity` shortens.
    fn pull(&self, stretch: Vector3<f64>, velocity: &Vector3<f64>, dt: f64) -> Vector3<f64> {
        (stretch - velocity * dt) * self.stiffness - velocity * self.damping
    }

    /// Reduction of the force per unit of acceleration, `[kg]` or `[kg·m²]`.
    fn slope(&self, dt: f64) -> f64 {
        dt * (self.damping + dt * self.stiffness)
    }
}

// These stiffnesses and masses are choices of the simulator. The plants are also stable with higher
// stiffness (`tests/robot/firm.rs` goes up to 1e8 N/m).

/// Stiffness of a table or a firm grip, `[N/m]`.
const FIRM: f64 = 20_000.0;

/// Stiffness of a firm grip against turning, `[N·m/rad]`.
const FIRM_TURN: f64 = 500.0;

/// Stiffness of a blocked joint, `[N·m/rad]`.
const FIRM_JOINT: f64 = 20_000.0;

/// Apparent mass of the end of an arm, `[kg]`.
const FELT_MASS: f64 = 3.0;

/// Apparent inertia of the end of an arm, `[kg·m²]`.
const FELT_INERTIA: f64 = 0.05;

/// Inertia of a joint with its rotor, `[kg·m²]`, for the damper of a blocked joint. The lightest
/// joint has 0.075.
const JOINT_INERTIA: f64 = 0.075;
