//! Selects the robot, connects to it, and checks that it may be moved.

use std::fmt;
use std::net::SocketAddr;

use anyhow::Context as _;
use clap::Args;
use franka_async::connection::{Builder, Endpoint};
use franka_async::error::{CloseReason, ConnectError};
use franka_async::gripper::Gripper;
use franka_async::model::RobotKind;
use franka_async::state::{RobotMode, RobotState};
use franka_async::{Error, Robot};

use crate::ending::{Ending, Failure};
use crate::output::say;
use crate::robots_file::{Realtime, RobotsFile, check_name};

/// Classifies a `ConnectError` of any device by how the robot responded.
macro_rules! seen {
    ($error:expr) => {
        match &$error {
            ConnectError::Refused { .. } => Seen::Refused,
            ConnectError::Timeout { .. } | ConnectError::HandshakeTimeout { .. } => Seen::Silent,
            ConnectError::ConnectionClosed {
                reason: CloseReason::ClosedByPeer | CloseReason::Io { .. },
            } => Seen::Closed,
            ConnectError::NoState { .. } => Seen::NoState,
            ConnectError::Realtime(_) => Seen::Realtime,
            ConnectError::Endpoint(_) => Seen::Caller,
            ConnectError::NoAddress { attempts }
                if attempts
                    .iter()
                    .all(|attempt| matches!(attempt.error, ConnectError::Refused { .. })) =>
            {
                Seen::Refused
            }
            _ => Seen::Other,
        }
    };
}

/// The robot of a command.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct Which {
    /// Name or address of the robot [default: FRANKA_ROBOT, or the only robot with a name]
    #[arg(value_name = "ROBOT")]
    pub(crate) robot: Option<String>,
}

/// The address of a robot.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    /// Name or address of the robot, as the user wrote it.
    name: String,
    /// Address from the robots file, if the file contains the robot's name.
    listed: Option<String>,
    pub(crate) address: Endpoint,
    pub(crate) hand: Endpoint,
    realtime: Option<Realtime>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.with(self.listed.as_ref()))
    }
}

impl Which {
    /// Selects the robot named `robot`, or the default robot.
    pub(crate) fn of(robot: Option<String>) -> Self {
        Self { robot }
    }

    /// Returns the name and the address of the robot.
    pub(crate) fn place(&self) -> anyhow::Result<Place> {
        let variable = || {
            std::env::var("FRANKA_ROBOT")
                .ok()
                .filter(|name| !name.is_empty())
        };
        let named = self.robot.clone().or_else(variable);
        let endpoint = |text: &str| {
            let parsed = text.parse::<Endpoint>();
            parsed.map_err(|error| Failure::usage(error.to_string()))
        };
        // A port in the address belongs to the device that the command uses.
        let unlisted = |name: String| {
            let address = endpoint(&name)?;
            Ok(Place {
                listed: None,
                hand: address.clone(),
                address,
                name,
                realtime: None,
            })
        };
        // In a container or a service, the directory for the file may not exist.
        if let Some(address) = named.clone().filter(|name| check_name(name).is_err()) {
            return unlisted(address);
        }
        let file = RobotsFile::read()?;
        let only = || match file.robots.len() {
            1 => file.robots.keys().next().cloned(),
            _ => None,
        };
        let name = named.or_else(only).ok_or_else(|| {
            let known = match file.robots.len() {
                0 => format!("{} has no robots", file.path.display()),
                count => format!("{} has {count} robots", file.path.display()),
            };
            Failure::usage(format!(
                "got no robot, expected a name or an address: {known}"
            ))
            .advice("Give a name or an address, or add one: franka robots add NAME ADDRESS")
        })?;
        let Some(entry) = file.robots.get(&name) else {
            return unlisted(name);
        };
        let address = endpoint(&entry.address)?;
        let hand = match &entry.hand {
            Some(hand) => endpoint(hand)?,
            None => address.clone().at_port(HAND),
        };
        Ok(Place {
            listed: Some(entry.address.clone()),
            address,
            hand,
            realtime: entry.realtime,
            name,
        })
    }

    /// Connects to the robot for commands that do not move the arm. Such commands need no real-time
    /// scheduling and accept any geometry.
    pub(crate) async fn connect(&self) -> anyhow::Result<(Robot, Place)> {
        let place = self.place()?;
        let robot = place
            .connect(Some(Realtime::Ignore), |builder| {
                builder.accept_geometry_error(true)
            })
            .await?;
        Ok((robot, place))
    }
}

impl Place {
    /// Returns the name of a device of this robot. If the robots file contains `address` for the
    /// device, this is the robot's name.
    fn with(&self, address: Option<impl fmt::Display>) -> String {
        match address {
            Some(address) => format!("{} ({address})", self.name),
            None => self.name.clone(),
        }
    }

    /// Returns the name or address of the robot, as the user wrote it.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Returns true if the robots file contains the robot's name.
    pub(crate) fn is_listed(&self) -> bool {
        self.listed.is_some()
    }

    /// Connects to the robot. `realtime` is the user's option. Without this option, the setting in
    /// the robots file applies.
    pub(crate) async fn connect(
        &self,
        realtime: Option<Realtime>,
        options: impl FnOnce(Builder) -> Builder,
    ) -> anyhow::Result<Robot> {
        let robot = self.attempt(realtime, options).await;
        robot.map_err(|(_, failure)| failure.into())
    }

    /// Like [`Self::connect`], but returns the reason if the connection fails.
    pub(crate) async fn attempt(
        &self,
        realtime: Option<Realtime>,
        options: impl FnOnce(Builder) -> Builder,
    ) -> Result<Robot, (Seen, Failure)> {
        let realtime = match realtime.or(self.realtime).unwrap_or(Realtime::Enforce) {
            Realtime::Enforce => franka_async::Realtime::Enforce,
            Realtime::Ignore => franka_async::Realtime::Ignore,
        };
        let builder = Robot::builder(self.address.clone()).realtime(realtime);
        let robot = options(builder).connect().await;
        if let Ok(robot) = &robot
            && !robot.geometry_check().is_as_described()
        {
            say(&format!("note: {}", robot.geometry_check()));
        }
        robot.map_err(|error| {
            let seen = seen!(error);
            let robot = ("robot", self.to_string());
            (seen, self.no_connection(robot, seen, error.into()))
        })
    }

    pub(crate) async fn connect_hand(&self) -> anyhow::Result<Gripper> {
        let gripper = Gripper::connect(self.hand.clone()).await;
        gripper.map_err(|error| {
            let seen = seen!(error);
            let at = self.with(self.is_listed().then_some(&self.hand));
            self.no_connection(("Hand", at), seen, error.into()).into()
        })
    }

    fn no_connection(&self, (device, at): (&str, String), seen: Seen, error: Error) -> Failure {
        let host = self.name.as_str();
        let failure = match seen {
            Seen::Refused => Failure::new(
                Ending::NoRobot,
                format!("no {device} at {at}: the connection was refused"),
            )
            .advice(
                "Is it the right address, and is FCI activated in Desk? franka doctor asks Desk for the reason. For a simulator: does `franka sim` run?",
            ),
            Seen::Silent => Failure::new(
                Ending::NoRobot,
                format!("no {device} answers at {at}"),
            )
            .advice("Check the cable, the address, and the network settings of this computer."),
            Seen::Closed => Failure::new(
                Ending::Taken,
                format!(
                    "the {device} at {at} closed the connection at once: another client is probably connected"
                ),
            )
            .advice(
                "A robot accepts one client at a time. End the other program, then try again. Press the user stop if the arm must stop now.",
            ),
            Seen::NoState => Failure::new(
                Ending::NoRobot,
                format!("the {device} at {at} answers, but its states do not arrive"),
            )
            .advice("The usual cause is a firewall that blocks UDP."),
            Seen::Realtime => Failure::new(Ending::Host, error.to_string()).advice(
                "For a simulator, use --realtime ignore. For a robot, franka doctor shows what is missing.",
            ),
            Seen::Caller => Failure::usage(error.to_string()),
            Seen::Other if self.listed.is_none() && !host.contains(['.', ':']) => Failure::new(
                Ending::NoRobot,
                format!("no {device} at `{host}`: {error}"),
            )
            .advice(format!("No robot has the name `{host}` either; franka robots list shows all \
                names.")),
            Seen::Other => {
                let message = format!("no connection to the {device} at {at}: {error}");
                Failure::new(Ending::NoRobot, message)
            }
        };
        failure.of(error.party(), error.entry())
    }
}

/// Reason why a connection to any device failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Seen {
    Refused,
    Silent,
    Closed,
    NoState,
    Realtime,
    Caller,
    Other,
}

/// Checks that the robot would accept a motion. It must be at rest and ready, and no other program
/// may be moving the arm.
pub(crate) fn check_ready(state: &RobotState, place: &Place) -> Result<(), Failure> {
    let refused =
        |ending, message: String, advice: &str| Err(Failure::new(ending, message).advice(advice));
    match state.robot_mode {
        RobotMode::Idle => Ok(()),
        RobotMode::Move => refused(
            Ending::Taken,
            format!("the robot at {place} is already in motion"),
            "Another program moves it: wait until that motion has ended.",
        ),
        RobotMode::Guiding => refused(
            Ending::Taken,
            format!("the robot at {place} is guided by hand"),
            "Release the guiding button, then try again.",
        ),
        RobotMode::AutomaticErrorRecovery => refused(
            Ending::Taken,
            format!("the robot at {place} is being recovered"),
            "Wait until the recovery has ended.",
        ),
        RobotMode::Reflex => refused(
            Ending::Failed,
            format!("the robot at {place} has stopped itself: {}", state.errors),
            "Remove the cause, then: franka recover",
        ),
        RobotMode::UserStopped => refused(
            Ending::Person,
            format!(
                "the user stop of the robot at {place} is pressed, or a safety function is active"
            ),
            "Release the user stop, or acknowledge the safety function in Desk.",
        ),
        RobotMode::Other => refused(
            Ending::Person,
            format!(
                "the robot at {place} is not ready: the brakes are closed, or the robot is \
                starting"
            ),
            "Open the brakes in Desk.",
        ),
    }
}

pub(crate) fn kind_name(kind: RobotKind) -> &'static str {
    match kind {
        RobotKind::Fr3 => "FR3",
        RobotKind::Fer => "FER (Panda)",
        _ => "robot",
    }
}

/// Port of a Hand at the robot's address.
const HAND: u16 = 1338;

/// Returns the first address of an endpoint. If the endpoint has no port, uses `port`, the usual
/// port of the device.
pub(crate) async fn resolve(endpoint: &Endpoint, port: u16) -> anyhow::Result<SocketAddr> {
    let text = endpoint.to_string();
    let has_port = match text.rsplit_once(':') {
        Some((_, port)) => port.parse::<u16>().is_ok(),
        None => false,
    };
    let text = match has_port {
        true => text,
        false => format!("{text}:{port}"),
    };
    let mut found = tokio::net::lookup_host(&text)
        .await
        .map_err(|error| Failure::new(Ending::NoRobot, format!("no address of {text}: {error}")))?;
    found
        .next()
        .with_context(|| format!("no address of {text}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_port_is_the_devices_own_unless_it_is_given() {
        for (text, expected) in [
            ("127.0.0.1", "127.0.0.1:1337"),
            ("127.0.0.1:40000", "127.0.0.1:40000"),
            ("::1", "[::1]:1337"),
            ("[::1]:40000", "[::1]:40000"),
        ] {
            let endpoint = text.parse().expect("an endpoint");
            let resolved = resolve(&endpoint, 1337).await.expect("an address");
            assert_eq!(resolved.to_string(), expected);
        }
    }
}
