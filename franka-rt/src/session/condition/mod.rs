//! Conditions over the robot's state and the time. The control thread checks them in every cycle. A
//! motion continues until its condition becomes true.
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
//! The robot's estimate of the external force also shows the friction of its joints. For simulated
//! arms with realistic friction that move at up to 0.1 m/s without contact, the estimate reaches
//! 7.1 N along z and 8.8 N as a norm. For bad arms it reaches twice these values.
//!
//! Use at least 8 N along z, and at least 10 N along another axis or for the norm. With a lower
//! threshold, some arms react without a contact. At the default speed, thresholds must be a quarter
//! higher. Declare the tool and the payload, or their weight counts as a force: see
//! [`Condition::relative`].

mod quantity;
#[cfg(test)]
mod tests;
mod watch;

use core::ops::{BitAnd, BitOr, Not};
use core::time::Duration;

pub use quantity::{Axis, Quantity};

use crate::tare::WrenchTare;

pub(super) use watch::{Observed, Watch};

/// A predicate over a state. It joins comparisons of [quantities](Quantity), flags of the robot and
/// the time since the goal began with `&`, `|` and `!`.
///
/// A condition is a small value without heap memory, with room for [`Self::ROOM`] comparisons and
/// operators. If a condition is invalid or does not fit, it is refused when the motion begins: see
/// [`Self::check`].
///
/// If the robot has no estimate of a quantity, that quantity is not finite. Then neither a
/// comparison with it nor the negation of the comparison is true.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// Nodes in postfix order; nodes beyond the length are [`Node::UNUSED`].
    nodes: [Node; Self::ROOM],
    /// Number of nodes. If there is no room for all of them, the condition is refused.
    length: usize,
    /// Offset that tared comparisons subtract.
    tare: Offset,
}

/// Wrench at the stiffness frame, in axes of the base frame, and the joint torques.
type Offset = [f64; 13];

/// Value from which a comparison measures the quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Since {
    /// The value of the quantity itself.
    Never,
    /// The change of the quantity since the first state of the goal.
    Beginning,
    /// The change of the quantity relative to a tare.
    Tare,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Node {
    Compare {
        quantity: Quantity,
        bound: Bound,
        /// Threshold.
        value: f64,
        since: Since,
    },
    Flag(Flag),
    /// Milliseconds since the goal began.
    Elapsed(u64),
    /// Milliseconds for which the operand has been true.
    HeldFor(u64),
    Not,
    And,
    Or,
}

/// Side of the threshold on which the quantity must be for the comparison to be true.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Bound {
    Above,
    Below,
    /// The magnitude of the quantity is above the threshold.
    Beyond,
}

/// Contacts that the robot itself reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Flag {
    /// Contact of any joint, or of the end effector along or about any axis.
    Contact,
    JointContact(u8),
    CartesianContact,
    /// Collision of any joint, or of the end effector along or about any axis.
    Collision,
}

/// Reason for refusing a condition.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConditionError {
    /// The condition has too many comparisons and operators.
    #[error(
        "the condition has {got} comparisons and operators, expected at most {}",
        Condition::ROOM
    )]
    TooLong {
        /// Number of comparisons and operators.
        got: usize,
    },
    /// A threshold is not finite, or the threshold of a magnitude is not above zero.
    #[error(
        "the threshold for {quantity:?} is {got}, expected a finite number (above 0 for a \
         magnitude)"
    )]
    Threshold {
        /// Quantity of the comparison.
        quantity: Quantity,
        /// The given value.
        got: f64,
    },
    /// The arm has no such joint.
    #[error("the condition names joint {got}, expected 1 to 7")]
    Joint {
        /// The given number of the joint.
        got: u8,
    },
    /// The tare is not finite, or the condition has two different tares.
    #[error(
        "the condition has several tares, or a tare that is not finite; expected one finite tare \
         for all its comparisons"
    )]
    Tare,
    /// The target after the reaction is hand guiding, which is not supported there.
    #[error(
        "got hand guiding as the target of a reaction, expected joint positions, a pose or rest"
    )]
    Guided,
}

/// True while the external force along x is at or beyond `newtons`, in either direction. For the
/// other axes see [`force_y`] and [`force_z`]. [`Quantity`] provides signed comparisons, and
/// comparisons of other quantities.
pub fn force_x(newtons: f64) -> Condition {
    Quantity::Force(Axis::X).beyond(newtons)
}

/// True while the external force along y is at or beyond `newtons`: see [`force_x`].
pub fn force_y(newtons: f64) -> Condition {
    Quantity::Force(Axis::Y).beyond(newtons)
}

/// True while the external force along z is at or beyond `newtons`: see [`force_x`].
pub fn force_z(newtons: f64) -> Condition {
    Quantity::Force(Axis::Z).beyond(newtons)
}

/// True while the norm of the external force is at or beyond `newtons`.
pub fn force(newtons: f64) -> Condition {
    Quantity::ForceNorm.beyond(newtons)
}

/// True while the norm of the external torque at the end effector is at or beyond `newton_metres`.
pub fn torque(newton_metres: f64) -> Condition {
    Quantity::TorqueNorm.beyond(newton_metres)
}

/// True while the external torque of any joint is at or beyond `newton_metres`.
pub fn joint_torques(newton_metres: f64) -> Condition {
    Quantity::LargestJointTorque.beyond(newton_metres)
}

/// True while the robot reports any contact, of a joint or at the end effector. The robot reports a
/// contact when an estimate exceeds a lower threshold of its collision behaviour.
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

/// True while the robot reports any collision. In motion, the robot stops itself after a collision,
/// and the motion ends with an error. A reaction to a [`contact`] comes earlier than a collision.
pub fn collision() -> Condition {
    Node::Flag(Flag::Collision).into()
}

/// True once `time` (in whole milliseconds) has passed since the first state of the goal, by the
/// robot's clock.
pub fn elapsed(time: Duration) -> Condition {
    Node::Elapsed(milliseconds(time)).into()
}

impl Condition {
    /// Maximum number of comparisons and operators in a condition, enough to join twelve
    /// comparisons. The operators `&`, `|`, `!` and [`held_for`](Self::held_for) count.
    pub const ROOM: usize = 24;

    /// Makes every comparison in this condition use the change since the first state of the goal
    /// instead of the value. For a norm, this is the norm of the change.
    ///
    /// Use this for displacements, for offsets of torque sensors, and for undeclared loads, whose
    /// weight is part of the robot's estimate. Friction changes when the arm begins to move, so a
    /// force needs the same threshold as without this option: see the [module](self). If a goal of
    /// a session begins while the arm moves, the change does not contain this step in friction.
    /// Then about two thirds of that threshold are enough.
    #[must_use]
    pub fn relative(mut self) -> Self {
        for node in &mut self.nodes {
            if let Node::Compare { since, .. } = node {
                *since = Since::Beginning;
            }
        }
        self
    }

    /// Subtracts a tare from the forces, moments and joint torques in this condition. Other
    /// comparisons do not change. [`relative`](Self::relative) comparisons ignore the tare,
    /// regardless of the order of the calls. A tared moment is about the origin of the stiffness
    /// frame.
    ///
    /// A tare is valid only in the posture in which it was taken: see [`tare`](crate::tare). Near a
    /// singularity, the robot has no estimate. There, neither a tared comparison of the wrench nor
    /// its negation is true.
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

    /// True once this condition has been true for `time` (in whole milliseconds) without a break,
    /// by the robot's clock. A lost state counts like the states before and after it.
    #[must_use]
    pub fn held_for(self, time: Duration) -> Self {
        self.then_node(Node::HeldFor(milliseconds(time)))
    }

    /// Checks that the condition fits and that its thresholds are valid.
    ///
    /// # Errors
    /// Returns a [`ConditionError`] that names the first problem.
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
        // A condition with two different tares is refused.
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
    /// Fills the unused room of a condition.
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

fn milliseconds(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}
