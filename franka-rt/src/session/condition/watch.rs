//! Checks a condition in every cycle.

use franka_proto::RobotState;

use super::quantity::Sample;
use super::{Bound, Condition, Flag, Node, Since};
use crate::session::running::Measured;

/// Parts of a state that conditions need, in addition to the joints and the pose that the session
/// measures.
///
/// The session copies them before the answer to the state leaves, and evaluates the condition
/// afterwards.
#[derive(Clone, Copy, Debug)]
pub(in crate::session) struct Observed {
    /// Wrench in base axes, with its torque about the origin of the stiffness frame.
    pub(in crate::session) wrench: [f64; 6],
    /// Joint torques, `tau_ext_hat_filtered`.
    pub(super) joint_torques: [f64; 7],
    pub(super) dq: [f64; 7],
    joint_contact: [f64; 7],
    cartesian_contact: [f64; 6],
    joint_collision: [f64; 7],
    cartesian_collision: [f64; 6],
}

impl Observed {
    pub(in crate::session) fn of(state: &RobotState) -> Self {
        Self {
            wrench: state.wrench_at_stiffness_frame(),
            joint_torques: state.tau_ext_hat_filtered,
            dq: state.dq,
            joint_contact: state.joint_contact,
            cartesian_contact: state.cartesian_contact,
            joint_collision: state.joint_collision,
            cartesian_collision: state.cartesian_collision,
        }
    }
}

/// A condition, and its memory from state to state.
#[derive(Debug)]
pub(in crate::session) struct Watch {
    condition: Condition,
    is_tared: bool,
    /// `message_id` of the state with which the goal began.
    since: u64,
    /// The first state of the goal.
    first: Option<Sample>,
    /// For each node, the `message_id` of the state since which its operand has been true.
    held: [Option<u64>; Condition::ROOM],
}

impl Watch {
    /// Watches a condition for a goal that begins with the state whose `message_id` is `since`.
    pub(in crate::session) fn new(condition: Condition, since: u64) -> Self {
        Self {
            condition,
            is_tared: condition.is_tared(),
            since,
            first: None,
            held: [None; Condition::ROOM],
        }
    }

    /// True if the condition is true in this state, with the arm as measured in it. The work is
    /// bounded and the same in every cycle.
    pub(in crate::session) fn is_met(&mut self, state: &Observed, arm: &Measured) -> bool {
        let now = Sample::of(state, arm);
        let first = self.first.get_or_insert(now);
        first.complete_from(&now);
        let change = now.since(first);
        let tared = match self.is_tared {
            true => now.tared(&self.condition.tare),
            false => now,
        };
        let mut stack = Stack::default();
        for (node, held) in self.condition.nodes().iter().zip(&mut self.held) {
            match *node {
                Node::Compare {
                    quantity,
                    bound,
                    value,
                    since,
                } => {
                    let number = quantity.of(match since {
                        Since::Never => &now,
                        Since::Beginning => &change,
                        Since::Tare => &tared,
                    });
                    stack.push(number.is_finite().then(|| bound.admits(number, value)));
                }
                Node::Flag(flag) => stack.push(flag.is_set(state)),
                Node::Elapsed(time) => {
                    stack.push(Some(arm.time.saturating_sub(self.since) >= time));
                }
                Node::HeldFor(time) => {
                    let operand = stack.pop();
                    *held = match operand {
                        Some(true) => held.or(Some(arm.time)),
                        Some(false) | None => None,
                    };
                    stack.push(
                        operand.map(|_| {
                            held.is_some_and(|since| arm.time.saturating_sub(since) >= time)
                        }),
                    );
                }
                Node::Not => {
                    let operand = stack.pop();
                    stack.push(operand.map(|operand| !operand));
                }
                Node::And => stack.join(|a, b| a & b, false),
                Node::Or => stack.join(|a, b| a | b, true),
            }
        }
        stack.pop() == Some(true)
    }
}

impl Bound {
    fn admits(self, number: f64, value: f64) -> bool {
        match self {
            Self::Above => number >= value,
            Self::Below => number <= value,
            Self::Beyond => number.abs() >= value,
        }
    }
}

impl Flag {
    /// Returns whether the flag is set, or `None` if a NaN makes the flag unknown.
    fn is_set(self, state: &Observed) -> Option<bool> {
        let any = |flags: &[f64]| {
            let set = flags.iter().any(|&flag| flag > 0.0);
            let known = set || !flags.iter().any(|flag| flag.is_nan());
            known.then_some(set)
        };
        let either = |joints: &[f64], axes: &[f64]| match (any(joints), any(axes)) {
            (Some(true), _) | (_, Some(true)) => Some(true),
            (Some(false), Some(false)) => Some(false),
            _ => None,
        };
        match self {
            Self::Contact => either(&state.joint_contact, &state.cartesian_contact),
            Self::Collision => either(&state.joint_collision, &state.cartesian_collision),
            Self::CartesianContact => any(&state.cartesian_contact),
            Self::JointContact(joint) => {
                let index = usize::from(joint).checked_sub(1)?;
                any(core::slice::from_ref(state.joint_contact.get(index)?))
            }
        }
    }
}

/// Operands during the evaluation of a condition. The newest operand is in bit 0. An operand
/// without either bit is unknown.
#[derive(Debug, Default)]
struct Stack {
    yes: u32,
    no: u32,
}

const _: () = assert!(Condition::ROOM <= 32, "a stack has a bit for each operand");

impl Stack {
    fn push(&mut self, operand: Option<bool>) {
        self.yes = self.yes << 1 | u32::from(operand == Some(true));
        self.no = self.no << 1 | u32::from(operand == Some(false));
    }

    fn pop(&mut self) -> Option<bool> {
        let known = (self.yes | self.no) & 1 == 1;
        let operand = known.then_some(self.yes & 1 == 1);
        self.yes >>= 1;
        self.no >>= 1;
        operand
    }

    /// Joins two operands. If one operand is `decisive`, the other operand may be unknown.
    fn join(&mut self, by: impl Fn(bool, bool) -> bool, decisive: bool) {
        let joined = match (self.pop(), self.pop()) {
            (Some(a), Some(b)) => Some(by(a, b)),
            (Some(a), None) | (None, Some(a)) if a == decisive => Some(decisive),
            _ => None,
        };
        self.push(joined);
    }
}
