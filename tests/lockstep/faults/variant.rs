//! The ways to control a robot.

use franka_model::RobotKind;
use franka_proto::{MoveControllerMode, MoveGeneratorMode};

/// A robot, and a way to control it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Variant {
    pub(crate) kind: RobotKind,
    pub(crate) way: Way,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Way {
    /// Control functions, called with every state.
    Callback(Channel),
    /// Active control: commands are written from outside.
    Active(Channel),
    /// Sparse targets, between which the robot plans.
    Asynchronous,
    /// Goals.
    Target(Gesture),
}

/// The commanded quantity, and the controller that turns it into torques. No generator with an
/// external controller means torques alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Channel {
    pub(crate) generator: MoveGeneratorMode,
    pub(crate) controller: MoveControllerMode,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Gesture {
    MoveTo,
    MoveJoints,
    Follow,
}

impl Channel {
    pub(crate) const ALL: [Self; 13] = {
        use MoveControllerMode::{
            CartesianImpedance as C, ExternalController as E, JointImpedance as J,
        };
        use MoveGeneratorMode as G;
        const fn of(generator: MoveGeneratorMode, controller: MoveControllerMode) -> Channel {
            Channel {
                generator,
                controller,
            }
        }
        [
            of(G::None, E),
            of(G::JointPosition, J),
            of(G::JointPosition, C),
            of(G::JointPosition, E),
            of(G::JointVelocity, J),
            of(G::JointVelocity, C),
            of(G::JointVelocity, E),
            of(G::CartesianPosition, J),
            of(G::CartesianPosition, C),
            of(G::CartesianPosition, E),
            of(G::CartesianVelocity, J),
            of(G::CartesianVelocity, C),
            of(G::CartesianVelocity, E),
        ]
    };

    /// True if torques are commanded.
    pub(crate) fn is_external(self) -> bool {
        self.controller == MoveControllerMode::ExternalController
    }
}

impl Variant {
    /// Returns every way of every robot.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        RobotKind::ALL.into_iter().flat_map(|kind| {
            let goals = [Gesture::MoveTo, Gesture::MoveJoints, Gesture::Follow];
            // Protocol 10 only.
            let asynchronous = (kind == RobotKind::Fr3).then_some(Way::Asynchronous);
            (Channel::ALL.map(Way::Callback).into_iter())
                .chain(Channel::ALL.map(Way::Active))
                .chain(goals.map(Way::Target))
                .chain(asynchronous)
                .map(move |way| Self { kind, way })
        })
    }

    /// Returns the variants with a command in every cycle.
    pub(crate) fn cyclic() -> impl Iterator<Item = (Self, Channel)> {
        Self::all().filter_map(|variant| variant.channel().map(|channel| (variant, channel)))
    }

    /// Command of a program in every cycle.
    pub(crate) fn channel(self) -> Option<Channel> {
        match self.way {
            Way::Callback(channel) | Way::Active(channel) => Some(channel),
            Way::Asynchronous | Way::Target(_) => None,
        }
    }

    /// True if goals are set instead of commands.
    pub(crate) fn is_target(self) -> bool {
        matches!(self.way, Way::Target(_))
    }
}

/// Formats the name of a case: `fr3/callback/CartesianPosition/JointImpedance`.
impl std::fmt::Display for Variant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kind = format!("{:?}", self.kind).to_lowercase();
        let (how, channel) = match self.way {
            Way::Callback(channel) => ("callback", channel),
            Way::Active(channel) => ("active", channel),
            Way::Asynchronous => return write!(f, "{kind}/asynchronous"),
            Way::Target(gesture) => return write!(f, "{kind}/{gesture:?}"),
        };
        let Channel {
            generator,
            controller,
        } = channel;
        write!(f, "{kind}/{how}/{generator:?}/{controller:?}")
    }
}
