//! Conditions over the state of the robot and the time, which the control thread checks in every
//! cycle: what a motion goes on until.
//!
//! ```
//! use std::time::Duration;
//!
//! use franka_rt::session::condition::{Axis, Quantity, contact, elapsed, force_z};
//!
//! // A table, but not the jerk of the beginning.
//! let touched = force_z(8.0) & elapsed(Duration::from_millis(200));
//! // Or the robot says so, or it has gone on for too long.
//! let given_up = elapsed(Duration::from_secs(5));
//! let end = touched | contact() | given_up;
//! let is_low = Quantity::Position(Axis::Z).below(0.15);
//! let end = end & !is_low;
//! end.check().expect("finite thresholds, and few enough of them");
//! ```
//!
//! # Thresholds of forces
//!
//! The robot's estimate of the external force shows the friction of its joints, too. Simulated arms
//! with the friction of real ones, moving at up to 0.1 m/s with nothing touched, show up to 7.1 N
//! along z and 8.8 N in all, and bad ones twice as much. A threshold below 8 N along z, or 10 N
//! along another axis or for the norm, reacts to nothing on some arm; at the default pace they have
//! to be a quarter higher. Tool and payload have to be declared, or their weight counts, too: see
//! [`Condition::relative`].

mod quantity;
#[cfg(test)]
mod tests;
mod watch;
mod words;

use core::ops::{BitAnd, BitOr, Not};
use core::time::Duration;

pub use quantity::{Axis, Quantity};

use crate::tare::WrenchTare;

pub(super) use watch::{Observed, Watch};

/// What has to be the case in a state: comparisons of [quantities](Quantity), flags of the robot
/// and the time since the goal began, joined by `&`, `|` and `!`.
///
/// A small value without memory of its own; it has room for [`Self::ROOM`] comparisons and
/// operators. What does not fit, or cannot be, is refused when the motion begins: see
/// [`Self::check`].
///
/// A quantity that is not finite, which a robot does not send, fulfils no comparison and no
/// negation of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// In postfix order; [`Node::UNUSED`] beyond the length.
    nodes: [Node; Self::ROOM],
    /// How many nodes it takes: more than there is room for, and it is refused.
    length: usize,
    /// What tared comparisons take off.
    tare: Offset,
}

/// Wrench at the stiffness frame, in axes of the base, and joint torques.
type Offset = [f64; 13];

/// What a comparison is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Since {
    /// The value.
    Never,
    /// Its change since the first state of the goal.
    Beginning,
    /// Its change since a tare.
    Tare,
}

/// An operand or an operator.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Node {
    Compare {
        quantity: Quantity,
        bound: Bound,
        /// What it is compared with.
        value: f64,
        since: Since,
    },
    Flag(Flag),
    /// So many milliseconds since the goal began.
    Elapsed(u64),
    /// The operand has been true for so many milliseconds.
    HeldFor(u64),
    Not,
    And,
    Or,
}

/// On which side of a value a quantity has to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Bound {
    Above,
    Below,
    /// Its magnitude above.
    Beyond,
}

/// What the robot itself says of contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Flag {
    /// Of any joint, or along or about any axis.
    Contact,
    JointContact(u8),
    CartesianContact,
    /// Of any joint, or along or about any axis.
    Collision,
}

/// Why a condition is not accepted.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConditionError {
    /// It has too many comparisons and operators.
    #[error(
        "the condition has {got} comparisons and operators, expected at most {}",
        Condition::ROOM
    )]
    TooLong {
        /// How many it has.
        got: usize,
    },
    /// A threshold is not finite, or that of a magnitude not above zero.
    #[error("threshold {got} for {quantity:?}, expected a finite number, above 0 for a magnitude")]
    Threshold {
        /// Of what.
        quantity: Quantity,
        /// The value given.
        got: f64,
    },
    /// The arm has no such joint.
    #[error("joint {got}, expected 1 to 7")]
    Joint {
        /// The number given.
        got: u8,
    },
    /// The tare is not finite, or the condition has two different ones.
    #[error("expected one tare of finite numbers for all comparisons of a condition")]
    Tare,
    /// What follows the reaction cannot be hand guiding.
    #[error("a reaction goes on to joint positions, a pose or rest, not to hand guiding")]
    Guided,
}

/// True while the external force along x is at or beyond `newtons`, in either direction; as are its
/// siblings along y and z. [`Quantity`] has comparisons with a sign, and more to compare.
pub fn force_x(newtons: f64) -> Condition {
    Quantity::Force(Axis::X).beyond(newtons)
}

/// See [`force_x`].
pub fn force_y(newtons: f64) -> Condition {
    Quantity::Force(Axis::Y).beyond(newtons)
}

/// See [`force_x`].
pub fn force_z(newtons: f64) -> Condition {
    Quantity::Force(Axis::Z).beyond(newtons)
}

/// True while the external force, whatever its direction, is at or beyond `newtons`.
pub fn force(newtons: f64) -> Condition {
    Quantity::ForceNorm.beyond(newtons)
}

/// True while the external torque at the end effector, whatever its axis, is at or beyond
/// `newton_metres`.
pub fn torque(newton_metres: f64) -> Condition {
    Quantity::TorqueNorm.beyond(newton_metres)
}

/// True while the external torque of any joint is at or beyond `newton_metres`.
pub fn joint_torques(newton_metres: f64) -> Condition {
    Quantity::LargestJointTorque.beyond(newton_metres)
}

/// True while the robot reports any contact, of a joint or at the end effector: while an estimate
/// is above a lower threshold of its collision behaviour.
pub fn contact() -> Condition {
    Node::Flag(Flag::Contact).into()
}

/// True while the robot reports a contact of this joint, 1 to 7.
pub fn joint_contact(joint: u8) -> Condition {
    Node::Flag(Flag::JointContact(joint)).into()
}

/// True while the robot reports a contact at the end effector, along or about any axis.
pub fn cartesian_contact() -> Condition {
    Node::Flag(Flag::CartesianContact).into()
}

/// True while the robot reports any collision. It stops itself for those in motion, which ends the
/// motion with an error: a reaction to a [`contact`] comes earlier.
pub fn collision() -> Condition {
    Node::Flag(Flag::Collision).into()
}

/// True from `time` after the first state of the goal on, by the robot's clock, whole milliseconds.
pub fn elapsed(time: Duration) -> Condition {
    Node::Elapsed(milliseconds(time)).into()
}

impl Condition {
    /// The number of comparisons and operators that a condition has room for, `&`, `|`, `!` and
    /// [`held_for`](Self::held_for) included: twelve comparisons, joined.
    pub const ROOM: usize = 24;

    /// Compares the changes since the first state of the goal instead of the values, in every
    /// comparison of this condition; of norms, the norm of the change.
    ///
    /// For loads that the robot does not know of, whose weight shows in its estimate; for
    /// displacements; and for what a torque sensor is off by. Friction changes as the arm begins to
    /// move, so a force needs the same threshold as without: see the [module](self). A goal that
    /// takes over in mid-motion, in a session, compares with the friction in motion, and needs
    /// about two thirds of it.
    #[must_use]
    pub fn relative(mut self) -> Self {
        for node in &mut self.nodes {
            if let Node::Compare { since, .. } = node {
                *since = Since::Beginning;
            }
        }
        self
    }

    /// Takes a tare off the forces, moments and joint torques of this condition; what else it
    /// compares stays as it is, and so do changes: what is [`relative`](Self::relative), made so
    /// before or after, has no tare. The moment is then about the origin of the stiffness frame.
    ///
    /// A tare belongs to the posture in which it was taken: see [`tare`](crate::tare). Where the
    /// robot has no estimate, near a singularity, no tared comparison of the wrench is true, and no
    /// negation of one.
    #[must_use]
    pub fn tared(mut self, tare: &WrenchTare) -> Self {
        for node in &mut self.nodes {
            if let Node::Compare {
                quantity, since, ..
            } = node
                && quantity.is_estimate()
                && *since != Since::Beginning
            {
                *since = Since::Tare;
            }
        }
        self.tare = core::array::from_fn(|i| match i {
            0..6 => tare.wrench[i],
            _ => tare.joint_torques[i - 6],
        });
        self
    }

    /// True once this condition has been true for `time` without a break, by the robot's clock,
    /// whole milliseconds. Of states that were lost it is assumed that they were like those around
    /// them.
    #[must_use]
    pub fn held_for(self, time: Duration) -> Self {
        self.then_node(Node::HeldFor(milliseconds(time)))
    }

    /// Checks that there is room for the condition and that its thresholds can be.
    ///
    /// # Errors
    /// [`ConditionError`] names the first thing that is wrong.
    pub fn check(&self) -> Result<(), ConditionError> {
        if self.length > Self::ROOM {
            return Err(ConditionError::TooLong { got: self.length });
        }
        if !self.tare.iter().all(|number| number.is_finite()) {
            return Err(ConditionError::Tare);
        }
        self.nodes().iter().try_for_each(Node::check)
    }

    fn is_tared(&self) -> bool {
        let tared = |node: &Node| {
            matches!(
                node,
                Node::Compare {
                    since: Since::Tare,
                    ..
                }
            )
        };
        self.nodes().iter().any(tared)
    }

    fn nodes(&self) -> &[Node] {
        &self.nodes[..self.length.min(Self::ROOM)]
    }

    fn then_node(mut self, node: Node) -> Self {
        if let Some(free) = self.nodes.get_mut(self.length) {
            *free = node;
        }
        self.length += 1;
        self
    }

    fn joined(self, other: Self, by: Node) -> Self {
        let length = self.length + other.length + 1;
        let both = other
            .nodes()
            .iter()
            .fold(self, |all, node| all.then_node(*node));
        // Two tares in one condition are refused.
        let (ours, theirs) = (self.is_tared(), other.is_tared());
        let tare = match (ours, theirs) {
            (true, true) if self.tare != other.tare => [f64::NAN; 13],
            (false, true) => other.tare,
            _ => self.tare,
        };
        Self {
            length,
            tare,
            ..both.then_node(by)
        }
    }
}

impl From<Node> for Condition {
    fn from(node: Node) -> Self {
        let empty = Self {
            nodes: [Node::UNUSED; Self::ROOM],
            length: 0,
            tare: [0.0; 13],
        };
        empty.then_node(node)
    }
}

impl BitAnd for Condition {
    type Output = Self;

    fn bitand(self, other: Self) -> Self {
        self.joined(other, Node::And)
    }
}

impl BitOr for Condition {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        self.joined(other, Node::Or)
    }
}

impl Not for Condition {
    type Output = Self;

    fn not(self) -> Self {
        self.then_node(Node::Not)
    }
}

impl Node {
    /// Fills the room that a condition does not need.
    const UNUSED: Self = Self::Or;

    fn compare(quantity: Quantity, bound: Bound, value: f64) -> Self {
        Self::Compare {
            quantity,
            bound,
            value,
            since: Since::Never,
        }
    }

    fn check(&self) -> Result<(), ConditionError> {
        let joint = match *self {
            Self::Compare {
                quantity,
                bound,
                value: got,
                ..
            } => {
                let accepted = got.is_finite() && (bound != Bound::Beyond || got > 0.0);
                if !accepted {
                    return Err(ConditionError::Threshold { quantity, got });
                }
                quantity.joint()
            }
            Self::Flag(Flag::JointContact(joint)) => Some(joint),
            _ => None,
        };
        match joint {
            Some(got) if !(1..=7).contains(&got) => Err(ConditionError::Joint { got }),
            _ => Ok(()),
        }
    }
}

/// Whole milliseconds.
fn milliseconds(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}
