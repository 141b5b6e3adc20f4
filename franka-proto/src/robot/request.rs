//! The requests of a client, and their encoding.
#![allow(non_snake_case)]

use super::{Architecture, CollisionBehavior, Filters, MoveRequest, System, library};
use crate::command::{Command, CommandId};
use crate::framing::Message;
use crate::outgoing::Outgoing;
use crate::protocol::{DecodeError, RequestError, payload};
use crate::version::Version;
use crate::wire::{self, from_wire, to_wire};

/// A request with its parameters.
///
/// The robot, not this crate, checks the ranges of the parameters.
// The large variant is not boxed, because a box requires an allocator, and few requests exist at a
// time.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Request {
    /// Opens a session.
    Connect {
        /// Protocol version of the client. It may be unknown to this crate.
        version: u16,
        /// UDP port of the client.
        udp_port: u16,
    },
    /// Starts a motion.
    Move(MoveRequest),
    /// Stops the motion.
    StopMove,
    /// Sets the thresholds of contact and collision.
    SetCollisionBehavior(CollisionBehavior),
    /// Sets the joint stiffnesses of the robot's own controller, 0 to 14250 `[N m/rad]`.
    SetJointImpedance([f64; 7]),
    /// Sets the stiffnesses of the robot's own Cartesian controller in the stiffness frame: 10 to
    /// 3000 `[N/m]`, then 1 to 300 `[N m/rad]`.
    SetCartesianImpedance([f64; 6]),
    /// Sets the axes that can be guided by hand.
    SetGuidingMode {
        /// For each of x, y, z, roll, pitch and yaw, true if the axis is free.
        guiding_mode: [bool; 6],
        /// True if the elbow is free.
        nullspace: bool,
    },
    /// Sets the stiffness frame, `EE_T_K`, column-major `[m]`.
    SetEEToK([f64; 16]),
    /// Sets the end-effector frame, `NE_T_EE`, column-major `[m]`.
    SetNEToEE([f64; 16]),
    /// Sets the load.
    SetLoad(Load),
    /// Clears errors after a reflex. The robot answers when the recovery has ended.
    AutomaticErrorRecovery,
    /// Fetches the robot's description as URDF text; protocol 10 only.
    GetRobotModel,
    /// Reads a virtual wall (libfranka's `getVirtualWall`); protocol 5 only.
    GetCartesianLimit {
        /// Number of the wall.
        id: i32,
    },
    /// Sets the filters of the robot's interfaces; protocol 5 only.
    SetFilters(Filters),
    /// Fetches the robot's model as a shared library; protocol 5 only.
    LoadModelLibrary {
        /// Processor of the client.
        architecture: Architecture,
        /// Operating system of the client.
        system: System,
    },
}

/// The load that the end effector holds. The end effector itself is configured in Desk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Load {
    /// Mass `[kg]`.
    pub m_load: f64,
    /// Centre of mass in the flange frame `[m]`.
    pub F_x_Cload: [f64; 3],
    /// Inertia about the centre of mass, column-major `[kg m^2]`.
    pub I_load: [f64; 9],
}

impl Request {
    /// Returns the command of this request.
    #[must_use]
    pub fn command(&self) -> Command {
        match self {
            Self::Connect { .. } => Command::Connect,
            Self::Move(_) => Command::Move,
            Self::StopMove => Command::StopMove,
            Self::SetCollisionBehavior(_) => Command::SetCollisionBehavior,
            Self::SetJointImpedance(_) => Command::SetJointImpedance,
            Self::SetCartesianImpedance(_) => Command::SetCartesianImpedance,
            Self::SetGuidingMode { .. } => Command::SetGuidingMode,
            Self::SetEEToK(_) => Command::SetEEToK,
            Self::SetNEToEE(_) => Command::SetNEToEE,
            Self::SetLoad(_) => Command::SetLoad,
            Self::AutomaticErrorRecovery => Command::AutomaticErrorRecovery,
            Self::GetRobotModel => Command::GetRobotModel,
            Self::GetCartesianLimit { .. } => Command::GetCartesianLimit,
            Self::SetFilters(_) => Command::SetFilters,
            Self::LoadModelLibrary { .. } => Command::LoadModelLibrary,
        }
    }

    /// Returns the message that carries this request with `id`.
    ///
    /// # Errors
    /// Returns [`RequestError::Unsupported`] if the version has no such command, or does not
    /// support these parameters.
    pub fn encode(&self, version: Version, id: CommandId) -> Result<Outgoing, RequestError> {
        let number = version
            .command_number(self.command())
            .ok_or(RequestError::Unsupported {
                what: self.command().display_name(),
                version,
            })?;
        Ok(match self {
            &Self::Connect { version, udp_port } => {
                let payload = wire::service::ConnectRequest {
                    version: version.into(),
                    udp_port: udp_port.into(),
                };
                Outgoing::new(number, id, &payload, 0)
            }
            Self::Move(request) => {
                (version.table().move_codec.encode)(request, version, number, id)?
            }
            Self::StopMove | Self::AutomaticErrorRecovery | Self::GetRobotModel => {
                Outgoing::new(number, id, &(), 0)
            }
            Self::SetCollisionBehavior(thresholds) => {
                Outgoing::new(number, id, &thresholds.to_wire(), 0)
            }
            Self::SetJointImpedance(stiffness) => {
                let K_theta = to_wire(stiffness);
                Outgoing::new(number, id, &wire::service::SetJointImpedance { K_theta }, 0)
            }
            Self::SetCartesianImpedance(stiffness) => {
                let K_x = to_wire(stiffness);
                Outgoing::new(number, id, &wire::service::SetCartesianImpedance { K_x }, 0)
            }
            &Self::SetGuidingMode {
                guiding_mode,
                nullspace,
            } => {
                let payload = wire::service::SetGuidingMode {
                    guiding_mode: guiding_mode.map(u8::from),
                    nullspace: u8::from(nullspace),
                };
                Outgoing::new(number, id, &payload, 0)
            }
            Self::SetEEToK(transform) | Self::SetNEToEE(transform) => {
                let transform = to_wire(transform);
                Outgoing::new(number, id, &wire::service::SetFrame { transform }, 0)
            }
            Self::SetLoad(load) => {
                let payload = wire::service::SetLoad {
                    m_load: load.m_load.into(),
                    F_x_Cload: to_wire(&load.F_x_Cload),
                    I_load: to_wire(&load.I_load),
                };
                Outgoing::new(number, id, &payload, 0)
            }
            &Self::GetCartesianLimit { id: wall } => {
                let payload = wire::service::GetCartesianLimit { id: wall.into() };
                Outgoing::new(number, id, &payload, 0)
            }
            Self::SetFilters(filters) => Outgoing::new(number, id, &filters.to_wire(), 0),
            &Self::LoadModelLibrary {
                architecture,
                system,
            } => Outgoing::new(number, id, &library::to_wire(architecture, system), 0),
        })
    }

    /// Decodes the request from a client's message. Bytes after the request's struct are ignored.
    ///
    /// # Errors
    /// Returns [`DecodeError::UnknownCommand`] if the version has no command with this number, and
    /// [`DecodeError::MessageSize`] if the payload is too short. Returns
    /// [`DecodeError::UnknownValue`] if the version does not define an enumerator, such as a mode
    /// of a `Move`.
    pub fn decode(version: Version, message: &Message<'_>) -> Result<Self, DecodeError> {
        let number = message.header.command;
        let command = version
            .command_from_number(number)
            .ok_or(DecodeError::UnknownCommand {
                number,
                version: version.number(),
            })?;
        Ok(match command {
            Command::Connect => {
                let payload: &wire::service::ConnectRequest = payload(message)?;
                Self::Connect {
                    version: payload.version.get(),
                    udp_port: payload.udp_port.get(),
                }
            }
            Command::Move => Self::Move((version.table().move_codec.decode)(message)?),
            Command::StopMove => Self::StopMove,
            Command::SetCollisionBehavior => {
                Self::SetCollisionBehavior(CollisionBehavior::from_wire(payload(message)?))
            }
            Command::SetJointImpedance => {
                let payload: &wire::service::SetJointImpedance = payload(message)?;
                Self::SetJointImpedance(from_wire(&payload.K_theta))
            }
            Command::SetCartesianImpedance => {
                let payload: &wire::service::SetCartesianImpedance = payload(message)?;
                Self::SetCartesianImpedance(from_wire(&payload.K_x))
            }
            Command::SetGuidingMode => {
                let payload: &wire::service::SetGuidingMode = payload(message)?;
                Self::SetGuidingMode {
                    guiding_mode: payload.guiding_mode.map(|axis| axis != 0),
                    nullspace: payload.nullspace != 0,
                }
            }
            Command::SetEEToK => Self::SetEEToK(frame(message)?),
            Command::SetNEToEE => Self::SetNEToEE(frame(message)?),
            Command::SetLoad => {
                let payload: &wire::service::SetLoad = payload(message)?;
                Self::SetLoad(Load {
                    m_load: payload.m_load.get(),
                    F_x_Cload: from_wire(&payload.F_x_Cload),
                    I_load: from_wire(&payload.I_load),
                })
            }
            Command::AutomaticErrorRecovery => Self::AutomaticErrorRecovery,
            Command::GetRobotModel => Self::GetRobotModel,
            Command::GetCartesianLimit => {
                let payload: &wire::service::GetCartesianLimit = payload(message)?;
                let id = payload.id.get();
                Self::GetCartesianLimit { id }
            }
            Command::SetFilters => Self::SetFilters(Filters::from_wire(payload(message)?)),
            Command::LoadModelLibrary => {
                let (architecture, system) = library::from_wire(payload(message)?)?;
                Self::LoadModelLibrary {
                    architecture,
                    system,
                }
            }
        })
    }
}

fn frame(message: &Message<'_>) -> Result<[f64; 16], DecodeError> {
    let payload: &wire::service::SetFrame = payload(message)?;
    Ok(from_wire(&payload.transform))
}
