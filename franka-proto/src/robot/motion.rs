//! The request that starts a motion.

use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

use crate::command::CommandId;
use crate::framing::Message;
use crate::outgoing::Outgoing;
use crate::protocol::payload;
use crate::protocol::{DecodeError, RequestError};
use crate::robot::{ControllerMode, MotionGeneratorMode};
use crate::version::Version;
use crate::wire::{self, from_wire, to_wire};

/// The parameters of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MoveRequest {
    /// Controller of the motion: one of the robot's own controllers, or the client's torques.
    pub controller: MoveControllerMode,
    /// The kind of commands that the client sends.
    pub generator: MoveGeneratorMode,
    /// Allowed deviation during the motion.
    pub maximum_path_deviation: Deviation,
    /// Allowed deviation at the goal.
    pub maximum_goal_pose_deviation: Deviation,
    /// Largest joint velocities `[rad/s]` of an asynchronous motion, in which the robot itself
    /// plans between sparse joint targets. `None` means one command per cycle. Only protocol 10
    /// supports asynchronous motions.
    pub asynchronous: Option<[f64; 7]>,
}

impl MoveRequest {
    /// Creates a request with the allowed deviations that libfranka sends
    /// ([`Deviation::LIBFRANKA`]), and with one command per cycle.
    #[must_use]
    pub fn new(controller: MoveControllerMode, generator: MoveGeneratorMode) -> Self {
        Self {
            controller,
            generator,
            maximum_path_deviation: Deviation::LIBFRANKA,
            maximum_goal_pose_deviation: Deviation::LIBFRANKA,
            asynchronous: None,
        }
    }
}

/// Largest allowed deviation of the robot from its commanded pose.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Deviation {
    /// Deviation of the position `[m]`.
    pub translation: f64,
    /// Deviation of the orientation `[rad]`.
    pub rotation: f64,
    /// Deviation of the elbow `[rad]`.
    pub elbow: f64,
}

impl Deviation {
    /// The deviations that libfranka 0.9 and 0.21 send with every motion. They are larger than any
    /// motion.
    pub const LIBFRANKA: Self = Self {
        translation: 10.0,
        rotation: 3.12,
        elbow: 2.0 * core::f64::consts::PI,
    };

    fn to_wire(self) -> wire::service::Deviation {
        wire::service::Deviation {
            translation: self.translation.into(),
            rotation: self.rotation.into(),
            elbow: self.elbow.into(),
        }
    }

    fn from_wire(wire: &wire::service::Deviation) -> Self {
        Self {
            translation: wire.translation.get(),
            rotation: wire.rotation.get(),
            elbow: wire.elbow.get(),
        }
    }
}

/// The controller of a `Move` request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum MoveControllerMode {
    /// The robot's joint impedance controller.
    JointImpedance,
    /// The robot's Cartesian impedance controller.
    CartesianImpedance,
    /// The client's torques.
    ExternalController,
}

impl MoveControllerMode {
    const ALL: [Self; 3] = [
        Self::JointImpedance,
        Self::CartesianImpedance,
        Self::ExternalController,
    ];

    /// Returns the mode that states report while the motion runs.
    #[must_use]
    pub fn in_state(self) -> ControllerMode {
        match self {
            Self::JointImpedance => ControllerMode::JointImpedance,
            Self::CartesianImpedance => ControllerMode::CartesianImpedance,
            Self::ExternalController => ControllerMode::ExternalController,
        }
    }
}

/// The motion generator of a `Move` request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum MoveGeneratorMode {
    /// Joint positions.
    JointPosition,
    /// Joint velocities.
    JointVelocity,
    /// End-effector poses.
    CartesianPosition,
    /// End-effector twists.
    CartesianVelocity,
    /// Only torques; protocol 10 only. See [`Version::torque_generator`].
    None,
}

impl MoveGeneratorMode {
    const ALL: [Self; 5] = [
        Self::JointPosition,
        Self::JointVelocity,
        Self::CartesianPosition,
        Self::CartesianVelocity,
        Self::None,
    ];

    /// Returns the mode that states report while the motion runs.
    #[must_use]
    pub fn in_state(self) -> MotionGeneratorMode {
        match self {
            Self::JointPosition => MotionGeneratorMode::JointPosition,
            Self::JointVelocity => MotionGeneratorMode::JointVelocity,
            Self::CartesianPosition => MotionGeneratorMode::CartesianPosition,
            Self::CartesianVelocity => MotionGeneratorMode::CartesianVelocity,
            Self::None => MotionGeneratorMode::None,
        }
    }
}

/// Reader and writer of one version's `Move`, for the version table.
#[derive(Clone, Copy)]
pub(crate) struct MoveCodec {
    pub(super) decode: fn(&Message<'_>) -> Result<MoveRequest, DecodeError>,
    pub(super) encode: fn(&MoveRequest, Version, u32, CommandId) -> Result<Outgoing, RequestError>,
}

impl MoveCodec {
    /// Creates the codec for the layout that ends with `A`.
    pub(crate) const fn of<A: AsynchronousPart>() -> Self {
        Self {
            decode: decode::<A>,
            encode: encode::<A>,
        }
    }
}

/// The fields that a version appends to a `Move` for an asynchronous motion.
pub(crate) trait AsynchronousPart:
    Copy + FromBytes + IntoBytes + Immutable + KnownLayout + Unaligned
{
    /// True if the version has these fields.
    const EXISTS: bool;
    /// Number of the first modes of [`MoveGeneratorMode::ALL`] that the version has.
    const GENERATORS: usize;
    fn velocities(&self) -> Option<[f64; 7]>;
    fn of(velocities: Option<[f64; 7]>) -> Option<Self>;
}

impl AsynchronousPart for wire::service::AsynchronousMotion {
    const EXISTS: bool = true;
    const GENERATORS: usize = 5;

    fn velocities(&self) -> Option<[f64; 7]> {
        (self.use_async_motion_generator != 0).then(|| from_wire(&self.maximum_velocity))
    }

    fn of(velocities: Option<[f64; 7]>) -> Option<Self> {
        Some(Self {
            use_async_motion_generator: u8::from(velocities.is_some()),
            maximum_velocity: to_wire(&velocities.unwrap_or_default()),
        })
    }
}

impl AsynchronousPart for () {
    const EXISTS: bool = false;
    const GENERATORS: usize = 4;

    fn velocities(&self) -> Option<[f64; 7]> {
        None
    }

    fn of(velocities: Option<[f64; 7]>) -> Option<Self> {
        velocities.is_none().then_some(())
    }
}

fn encode<A: AsynchronousPart>(
    request: &MoveRequest,
    version: Version,
    number: u32,
    id: CommandId,
) -> Result<Outgoing, RequestError> {
    let generator = request.generator as u32;
    if generator as usize >= A::GENERATORS {
        let what = "motion without a generator";
        return Err(RequestError::Unsupported { what, version });
    }
    let asynchronous = A::of(request.asynchronous).ok_or(RequestError::Unsupported {
        what: "asynchronous motion",
        version,
    })?;
    let payload = wire::service::MoveRequest {
        controller_mode: (request.controller as u32).into(),
        motion_generator_mode: generator.into(),
        maximum_path_deviation: request.maximum_path_deviation.to_wire(),
        maximum_goal_pose_deviation: request.maximum_goal_pose_deviation.to_wire(),
        asynchronous,
    };
    Ok(Outgoing::new(number, id, &payload, 0))
}

fn decode<A: AsynchronousPart>(message: &Message<'_>) -> Result<MoveRequest, DecodeError> {
    let wire: &wire::service::MoveRequest<A> = payload(message)?;
    let (controller, generator) = (wire.controller_mode.get(), wire.motion_generator_mode.get());
    let generators = &MoveGeneratorMode::ALL[..A::GENERATORS];
    Ok(MoveRequest {
        controller: nth(&MoveControllerMode::ALL, "controller_mode", controller)?,
        generator: nth(generators, "motion_generator_mode", generator)?,
        maximum_path_deviation: Deviation::from_wire(&wire.maximum_path_deviation),
        maximum_goal_pose_deviation: Deviation::from_wire(&wire.maximum_goal_pose_deviation),
        asynchronous: wire.asynchronous.velocities(),
    })
}

/// Returns the enumerator with the number `value`.
pub(super) fn nth<T: Copy>(all: &[T], field: &'static str, value: u32) -> Result<T, DecodeError> {
    let index = usize::try_from(value).unwrap_or(usize::MAX);
    let known = all.get(index).copied();
    known.ok_or(DecodeError::UnknownValue { field, value })
}
