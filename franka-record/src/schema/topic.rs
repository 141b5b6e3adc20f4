//! The channels of a recording.

use prost::Name as _;

use super::{foxglove, franka};
use crate::event::Level;

/// Name of the metadata record of the whole recording.
pub(crate) const METADATA: &str = "recording";

/// Prefix of the name of a robot's metadata record. The robot's name follows the prefix.
pub(crate) const ROBOT_METADATA: &str = "robot:";

/// Name of the first metadata record of a cassette.
pub(crate) const CASSETTE_METADATA: &str = "franka cassette";

/// A channel of one robot. Its full name begins with the robot's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub(crate) enum Topic {
    /// Every cycle.
    Cycle,
    /// The tool, written again at each change.
    Tool,
    /// Events, as values.
    Event,
    /// Events, as text.
    Log,
    /// Poses of links, end effector, reference and target.
    Tf,
    /// The pose towards which the reference moves.
    Target,
    /// Joint positions, velocities and torques.
    Joints,
    /// The external force as an arrow.
    Scene,
    /// The states of the gripper.
    Gripper,
}

impl Topic {
    pub(crate) const ALL: [Self; 9] = [
        Self::Cycle,
        Self::Tool,
        Self::Event,
        Self::Log,
        Self::Tf,
        Self::Target,
        Self::Joints,
        Self::Scene,
        Self::Gripper,
    ];

    /// Returns the name of a robot's channel. The robot's name can be empty if it is the only
    /// robot.
    pub(crate) fn channel(self, robot: &str) -> String {
        match robot {
            "" => format!("/{}", self.name()),
            robot => format!("/{robot}/{}", self.name()),
        }
    }

    /// Returns the topic and the robot for a channel name from [`Self::channel`].
    #[cfg(test)]
    pub(crate) fn of_channel(channel: &str) -> Option<(Self, &str)> {
        let (before, name) = channel.rsplit_once('/')?;
        let robot = before.strip_prefix('/').unwrap_or(before);
        let topic = Self::ALL.into_iter().find(|topic| topic.name() == name)?;
        (channel == topic.channel(robot)).then_some((topic, robot))
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Cycle => "cycle",
            Self::Tool => "tool",
            Self::Event => "event",
            Self::Log => "log",
            Self::Tf => "tf",
            Self::Target => "target",
            Self::Joints => "joints",
            Self::Scene => "scene",
            Self::Gripper => "gripper",
        }
    }

    /// Returns the full name of the type of this channel's messages.
    pub(crate) fn schema(self) -> String {
        match self {
            Self::Cycle => franka::Cycle::full_name(),
            Self::Tool => franka::Tool::full_name(),
            Self::Event => franka::Event::full_name(),
            Self::Log => foxglove::Log::full_name(),
            Self::Tf => foxglove::FrameTransforms::full_name(),
            Self::Target => foxglove::PoseInFrame::full_name(),
            Self::Joints => foxglove::JointStates::full_name(),
            Self::Scene => foxglove::SceneUpdate::full_name(),
            Self::Gripper => franka::Gripper::full_name(),
        }
    }
}

impl From<Level> for foxglove::log::Level {
    fn from(level: Level) -> Self {
        match level {
            Level::Debug => Self::Debug,
            Level::Info => Self::Info,
            Level::Warning => Self::Warning,
            Level::Error => Self::Error,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_name_their_robot_and_topic() {
        for (index, topic) in Topic::ALL.into_iter().enumerate() {
            assert_eq!(topic as usize, index);
            for robot in ["", "left", "cycle"] {
                let channel = topic.channel(robot);
                assert_eq!(Topic::of_channel(&channel), Some((topic, robot)));
            }
        }
        for other in ["", "/", "cycle", "//cycle", "/camera/image"] {
            assert_eq!(Topic::of_channel(other), None, "{other}");
        }
    }
}
