//! The protocol against complete messages and datagrams, both ways: values to bytes, bytes to
//! values.

use franka_proto::framing::{Message, next_message};
use franka_proto::{
    Architecture, CollisionBehavior, Command, CommandId, ConnectStatus, Deviation, Filters, Load,
    MoveControllerMode, MoveGeneratorMode, MoveRequest, Outgoing, Reply, Request, SuccessRate,
    System, Version, VirtualWall, server,
};

use super::wire_datagrams::{command, state};
use super::{Malformed, Node, Report, wire_end_effectors};

/// Checks `wire_golden.json`: bytes made by the compiled protocol headers.
pub(super) fn messages(root: &Node<'_>) -> Result<Report, Malformed> {
    let mut report = Report::default();
    for version in Version::ALL {
        for node in root.get(&format!("v{version}"))?.list()? {
            check_message(&mut report, version, &node)?;
        }
    }
    wire_end_effectors::messages(&mut report, root)?;
    for node in root.get("control_exception_suffixes")?.list()? {
        let rate = node.get("second_to_last_success_rate")?.number()?;
        let lost = node.get("lost_packets")?.integer()?;
        let suffix = node.get("suffix")?.text()?;
        report.case(node.path(), |case| {
            let text = SuccessRate::of_log(rate, 1000, 1001 + lost).to_string();
            case.equal("suffix", text.as_str(), suffix);
        });
    }
    Ok(report)
}

fn check_message(report: &mut Report, version: Version, node: &Node<'_>) -> Result<(), Malformed> {
    let name = node.get("message")?.text()?;
    let golden = Golden {
        version,
        name: format!("{} {version} {name}", node.path()),
        values: node.get("values")?,
        bytes: node.get("hex")?.bytes()?,
    };
    match name.split_once(' ') {
        Some((command, "request")) => golden.request(report, known(command, node)?),
        Some((command, "reply")) => golden.reply(report, known(command, node)?),
        _ if name == "RobotCommand" => command(report, &golden),
        _ if name == "RobotState" => state(report, &golden),
        _ => Err(node.malformed("a message of the protocol")),
    }
}

/// The command with the vendor's name, which is also the name of the variant.
fn known(name: &str, node: &Node<'_>) -> Result<Command, Malformed> {
    let mut commands = Command::ALL.into_iter();
    commands
        .find(|command| format!("{command:?}") == name)
        .ok_or_else(|| node.malformed("a command of the protocol"))
}

/// One message or datagram of the file.
pub(super) struct Golden<'a> {
    pub(super) version: Version,
    pub(super) name: String,
    pub(super) values: Node<'a>,
    pub(super) bytes: Vec<u8>,
}

impl Golden<'_> {
    fn id(&self) -> Result<CommandId, Malformed> {
        let id = self.values.get("command_id")?;
        let id = u32::try_from(id.integer()?).map_err(|_| id.malformed("a 32-bit integer"))?;
        Ok(CommandId(id))
    }

    fn message(&self) -> Result<Message<'_>, Malformed> {
        let message = next_message(&self.bytes).ok().flatten();
        message.ok_or_else(|| self.values.malformed("a whole message"))
    }

    fn request(&self, report: &mut Report, command: Command) -> Result<(), Malformed> {
        let (id, message) = (self.id()?, self.message()?);
        let decoded = Request::decode(self.version, &message);
        let request = self.request_values(command)?;
        report.case(&self.name, |case| {
            case.equal("id", message.header.id(), id);
            case.equal("values", decoded, Ok(request));
            let encoded = request.encode(self.version, id);
            let encoded = encoded.as_ref().map(Outgoing::as_bytes);
            case.equal("bytes", encoded, Ok(&self.bytes[..]));
        });
        Ok(())
    }

    /// The request with the values of the file.
    fn request_values(&self, command: Command) -> Result<Request, Malformed> {
        let values = &self.values;
        Ok(match command {
            Command::Connect => Request::Connect {
                version: narrow(&values.get("version")?)?,
                udp_port: narrow(&values.get("udp_port")?)?,
            },
            Command::Move => Request::Move(self.motion()?),
            Command::StopMove => Request::StopMove,
            Command::SetCollisionBehavior => Request::SetCollisionBehavior(self.thresholds()?),
            Command::SetJointImpedance => {
                Request::SetJointImpedance(values.get("K_theta")?.numbers()?)
            }
            Command::SetCartesianImpedance => {
                Request::SetCartesianImpedance(values.get("K_x")?.numbers()?)
            }
            Command::SetGuidingMode => {
                let axes = values.get("guiding_mode")?;
                let free: Vec<bool> = axes
                    .list()?
                    .iter()
                    .map(Node::boolean)
                    .collect::<Result<_, _>>()?;
                Request::SetGuidingMode {
                    guiding_mode: free.try_into().map_err(|_| axes.malformed("6 booleans"))?,
                    nullspace: values.get("nullspace")?.boolean()?,
                }
            }
            Command::SetEEToK => Request::SetEEToK(values.get("EE_T_K")?.numbers()?),
            Command::SetNEToEE => Request::SetNEToEE(values.get("NE_T_EE")?.numbers()?),
            Command::SetLoad => Request::SetLoad(Load {
                m_load: values.get("m_load")?.number()?,
                F_x_Cload: values.get("F_x_Cload")?.numbers()?,
                I_load: values.get("I_load")?.numbers()?,
            }),
            Command::AutomaticErrorRecovery => Request::AutomaticErrorRecovery,
            Command::GetRobotModel => Request::GetRobotModel,
            Command::GetCartesianLimit => {
                let id = values.get("id")?.number()?;
                Request::GetCartesianLimit { id: id as i32 }
            }
            Command::SetFilters => Request::SetFilters(self.filters()?),
            Command::LoadModelLibrary => Request::LoadModelLibrary {
                architecture: match values.get("architecture")?.integer()? {
                    0 => Architecture::X64,
                    1 => Architecture::X86,
                    2 => Architecture::Arm,
                    3 => Architecture::Arm64,
                    _ => return Err(values.malformed("an architecture")),
                },
                system: match values.get("system")?.integer()? {
                    0 => System::Linux,
                    1 => System::Windows,
                    _ => return Err(values.malformed("an operating system")),
                },
            },
        })
    }

    fn filters(&self) -> Result<Filters, Malformed> {
        let frequency = |name: &str| {
            self.values
                .get(&format!("{name}_filter_frequency"))?
                .number()
        };
        Ok(Filters {
            joint_position_filter_frequency: frequency("joint_position")?,
            joint_velocity_filter_frequency: frequency("joint_velocity")?,
            cartesian_position_filter_frequency: frequency("cartesian_position")?,
            cartesian_velocity_filter_frequency: frequency("cartesian_velocity")?,
            controller_filter_frequency: frequency("controller")?,
        })
    }

    fn motion(&self) -> Result<MoveRequest, Malformed> {
        let values = &self.values;
        let (controller, generator) = (
            values.get("controller_mode")?,
            values.get("motion_generator_mode")?,
        );
        let deviation = |name: &str| {
            let part = |part| values.get(&format!("{name}.{part}"))?.number();
            Ok(Deviation {
                translation: part("translation")?,
                rotation: part("rotation")?,
                elbow: part("elbow")?,
            })
        };
        let asynchronous = match values.find("use_async_motion_generator") {
            Some(flag) if flag.boolean()? => Some(values.get("maximum_velocity")?.numbers()?),
            _ => None,
        };
        Ok(MoveRequest {
            controller: match controller.integer()? {
                0 => MoveControllerMode::JointImpedance,
                1 => MoveControllerMode::CartesianImpedance,
                2 => MoveControllerMode::ExternalController,
                _ => return Err(controller.malformed("a controller")),
            },
            generator: match generator.integer()? {
                0 => MoveGeneratorMode::JointPosition,
                1 => MoveGeneratorMode::JointVelocity,
                2 => MoveGeneratorMode::CartesianPosition,
                3 => MoveGeneratorMode::CartesianVelocity,
                4 => MoveGeneratorMode::None,
                _ => return Err(generator.malformed("a motion generator")),
            },
            maximum_path_deviation: deviation("maximum_path_deviation")?,
            maximum_goal_pose_deviation: deviation("maximum_goal_pose_deviation")?,
            asynchronous,
        })
    }

    fn thresholds(&self) -> Result<CollisionBehavior, Malformed> {
        let torques = |name: &str| self.values.get(name)?.numbers::<7>();
        let forces = |name: &str| self.values.get(name)?.numbers::<6>();
        Ok(CollisionBehavior {
            lower_torque_thresholds_acceleration: torques("lower_torque_thresholds_acceleration")?,
            upper_torque_thresholds_acceleration: torques("upper_torque_thresholds_acceleration")?,
            lower_torque_thresholds_nominal: torques("lower_torque_thresholds_nominal")?,
            upper_torque_thresholds_nominal: torques("upper_torque_thresholds_nominal")?,
            lower_force_thresholds_acceleration: forces("lower_force_thresholds_acceleration")?,
            upper_force_thresholds_acceleration: forces("upper_force_thresholds_acceleration")?,
            lower_force_thresholds_nominal: forces("lower_force_thresholds_nominal")?,
            upper_force_thresholds_nominal: forces("upper_force_thresholds_nominal")?,
        })
    }

    fn reply(&self, report: &mut Report, command: Command) -> Result<(), Malformed> {
        let (id, message) = (self.id()?, self.message()?);
        let decoded = Reply::decode(self.version, command, &message);
        let status: usize = narrow(&self.values.get("status")?)?;
        let status_name = match self.values.find("status_name") {
            Some(name) => name.text()?,
            // The file names no status here; these are the vendor's.
            None => ["kSuccess", "kIncompatibleLibraryVersion"][status.min(1)],
        };
        let version = match self.values.find("version") {
            Some(version) => Some(narrow(&version)?),
            None => None,
        };
        let wall = match self.values.find("object_frame") {
            Some(frame) => Some(VirtualWall {
                object_world_size: self.values.get("object_world_size")?.numbers()?,
                object_frame: frame.numbers()?,
                object_activation: self.values.get("object_activation")?.boolean()?,
            }),
            None => None,
        };
        let model = match self.values.find("robot_model") {
            Some(text) => text.text()?,
            None => "",
        };
        report.case(&self.name, |case| {
            case.equal("id", message.header.id(), id);
            let Ok(reply) = decoded else {
                return case.fail(format!("{decoded:?}"));
            };
            case.equal("status", status_of(&reply), status_name.to_owned());
            match reply {
                Reply::Connect { version: got, .. } => case.equal("version", Some(got), version),
                Reply::Model { text, .. } => case.equal("text", text, model.as_bytes()),
                Reply::CartesianLimit { wall: got, .. } => case.equal("wall", Some(got), wall),
                _ => {}
            }
            match self.server_bytes(command, id, reply) {
                Ok(bytes) => case.equal("bytes", &bytes, &self.bytes),
                Err(error) => case.fail(error),
            }
        });
        Ok(())
    }

    /// What a server session sends to give this reply to a request of this id.
    fn server_bytes(
        &self,
        command: Command,
        id: CommandId,
        reply: Reply<'_>,
    ) -> Result<Vec<u8>, String> {
        let version = self.version;
        let mut session = server::Session::new(version);
        let mut hello = |announced, id| {
            let hello = Request::Connect {
                version: announced,
                udp_port: 1,
            };
            deliver(&mut session, &hello, version, id)
        };
        if let Reply::Connect { status, .. } = reply {
            let same = status == ConnectStatus::Success;
            let announced = version.number() + u16::from(!same);
            return match hello(announced, id)? {
                server::Event::Connect { reply, .. } if same => Ok(reply.as_bytes().to_vec()),
                server::Event::Incompatible { reply, .. } => Ok(reply.as_bytes().to_vec()),
                event => Err(format!("{event:?}")),
            };
        }
        hello(version.number(), CommandId(u32::MAX))?;
        let request = match command {
            Command::Move => Request::Move(MoveRequest::new(
                MoveControllerMode::JointImpedance,
                MoveGeneratorMode::JointPosition,
            )),
            Command::StopMove => Request::StopMove,
            Command::AutomaticErrorRecovery => Request::AutomaticErrorRecovery,
            Command::GetRobotModel => Request::GetRobotModel,
            Command::GetCartesianLimit => Request::GetCartesianLimit { id: 0 },
            _ => Request::SetEEToK([0.0; 16]),
        };
        deliver(&mut session, &request, version, id)?;
        match reply {
            Reply::Model { text, .. } => {
                let header = session.model_header(id, text.len());
                let header = header.map_err(|error| error.to_string())?;
                Ok([header.as_bytes(), text].concat())
            }
            reply => {
                let outgoing = session.reply(id, reply);
                Ok(outgoing
                    .map_err(|error| error.to_string())?
                    .as_bytes()
                    .to_vec())
            }
        }
    }
}

fn deliver(
    session: &mut server::Session,
    request: &Request,
    version: Version,
    id: CommandId,
) -> Result<server::Event, String> {
    let outgoing = request
        .encode(version, id)
        .map_err(|error| error.to_string())?;
    let message = next_message(outgoing.as_bytes()).map_err(|error| error.to_string())?;
    let message = message.ok_or("half a message")?;
    session
        .on_message(message)
        .map_err(|error| error.to_string())
}

/// The vendor's name of a status: that of the variant behind a `k`.
pub(super) fn status_of(reply: &Reply<'_>) -> String {
    match reply {
        Reply::Connect { status, .. } => format!("k{status:?}"),
        Reply::Move(status) => format!("k{status:?}"),
        Reply::StopMove(status) => format!("k{status:?}"),
        Reply::Setter(status) => format!("k{status:?}"),
        Reply::Recovery(status) => format!("k{status:?}"),
        Reply::Model { status, .. } => format!("k{status:?}"),
        Reply::CartesianLimit { status, .. } => format!("k{status:?}"),
        Reply::ModelLibrary { status, .. } => format!("k{status:?}"),
        reply => format!("{reply:?}"),
    }
}

/// An integer of the file as a narrower type.
pub(super) fn narrow<T: TryFrom<u64>>(node: &Node<'_>) -> Result<T, Malformed> {
    T::try_from(node.integer()?).map_err(|_| node.malformed("a smaller integer"))
}
