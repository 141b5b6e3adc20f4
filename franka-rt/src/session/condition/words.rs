//! Encoding of a condition in the slot to the control thread.
//!
//! A word for the length comes first, then two for each node: its kind, and its number. The tare
//! follows. The kind has five bytes, from the lowest: the kind of node; the kind of quantity or
//! flag; its axis or joint; the kind of bound; the reference of a change.

use super::{Axis, Bound, Condition, Flag, Node, Quantity, Since};
use crate::slot::Words;

/// Words for the length and the nodes.
const NODES: usize = 1 + 2 * Condition::ROOM;

impl Words for Condition {
    const WORDS: usize = NODES + 13;

    fn store(&self, words: &mut [u64]) {
        let nodes = self.nodes.iter().flat_map(|node| node.to_words());
        let length = self.length as u64;
        let tare = self.tare.map(f64::to_bits);
        let values = [length].into_iter().chain(nodes).chain(tare);
        for (word, value) in words.iter_mut().zip(values) {
            *word = value;
        }
    }

    fn load(words: &[u64]) -> Self {
        Self {
            length: words[0] as usize,
            nodes: core::array::from_fn(|i| Node::from_words([words[1 + 2 * i], words[2 + 2 * i]])),
            tare: core::array::from_fn(|i| f64::from_bits(words[NODES + i])),
        }
    }
}

impl Node {
    fn to_words(self) -> [u64; 2] {
        let code = |bytes: [u8; 5]| {
            let [a, b, c, d, e] = bytes;
            u64::from_le_bytes([a, b, c, d, e, 0, 0, 0])
        };
        match self {
            Self::Compare {
                quantity,
                bound,
                value,
                since,
            } => {
                let (kind, part) = quantity.to_bytes();
                let what = [0, kind, part, bound as u8, since as u8];
                [code(what), value.to_bits()]
            }
            Self::Flag(flag) => {
                let (kind, joint) = match flag {
                    Flag::Contact => (0, 0),
                    Flag::JointContact(joint) => (1, joint),
                    Flag::CartesianContact => (2, 0),
                    Flag::Collision => (3, 0),
                };
                [code([1, kind, joint, 0, 0]), 0]
            }
            Self::Elapsed(time) => [2, time],
            Self::HeldFor(time) => [3, time],
            Self::Not => [4, 0],
            Self::And => [5, 0],
            Self::Or => [6, 0],
        }
    }

    fn from_words([what, number]: [u64; 2]) -> Self {
        let [node, kind, part, bound, since, ..] = what.to_le_bytes();
        match node {
            0 => Self::Compare {
                quantity: Quantity::from_bytes(kind, part),
                bound: match bound {
                    0 => Bound::Above,
                    1 => Bound::Below,
                    _ => Bound::Beyond,
                },
                value: f64::from_bits(number),
                since: match since {
                    0 => Since::Never,
                    1 => Since::Beginning,
                    _ => Since::Tare,
                },
            },
            1 => Self::Flag(match kind {
                0 => Flag::Contact,
                1 => Flag::JointContact(part),
                2 => Flag::CartesianContact,
                _ => Flag::Collision,
            }),
            2 => Self::Elapsed(number),
            3 => Self::HeldFor(number),
            4 => Self::Not,
            5 => Self::And,
            _ => Self::Or,
        }
    }
}

impl Quantity {
    fn to_bytes(self) -> (u8, u8) {
        match self {
            Self::Force(axis) => (0, axis as u8),
            Self::ForceNorm => (1, 0),
            Self::Torque(axis) => (2, axis as u8),
            Self::TorqueNorm => (3, 0),
            Self::JointTorque(joint) => (4, joint),
            Self::LargestJointTorque => (5, 0),
            Self::Position(axis) => (6, axis as u8),
            Self::Velocity(axis) => (7, axis as u8),
            Self::Speed => (8, 0),
            Self::AngularVelocity(axis) => (9, axis as u8),
            Self::AngularSpeed => (10, 0),
            Self::JointPosition(joint) => (11, joint),
            Self::JointVelocity(joint) => (12, joint),
        }
    }

    fn from_bytes(kind: u8, part: u8) -> Self {
        let axis = match part {
            0 => Axis::X,
            1 => Axis::Y,
            _ => Axis::Z,
        };
        match kind {
            0 => Self::Force(axis),
            1 => Self::ForceNorm,
            2 => Self::Torque(axis),
            3 => Self::TorqueNorm,
            4 => Self::JointTorque(part),
            5 => Self::LargestJointTorque,
            6 => Self::Position(axis),
            7 => Self::Velocity(axis),
            8 => Self::Speed,
            9 => Self::AngularVelocity(axis),
            10 => Self::AngularSpeed,
            11 => Self::JointPosition(part),
            _ => Self::JointVelocity(part),
        }
    }
}
