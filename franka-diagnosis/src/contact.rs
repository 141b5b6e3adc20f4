//! External forces and torques, as the robot estimates them.

use franka_proto::{RobotError, RobotState};

use super::cause::Cause;
use super::evidence::Evidence;
use super::finding::{Bound, Finding, Origin, Quantity, Subject};

/// Place where the robot senses a contact: the joints, or the axes of the base frame at the
/// stiffness frame. The vendor does not document to which axes the flags belong. The simulator
/// makes the same assumption.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Sense {
    Joints,
    Axes,
}

impl Sense {
    const ALL: [Self; 2] = [Self::Joints, Self::Axes];

    /// Returns the external loads in a state. For axes, only six of the numbers are used.
    fn load(self, state: &RobotState) -> [f64; 7] {
        match self {
            Self::Joints => state.tau_ext_hat_filtered,
            Self::Axes => {
                let [x, y, z, a, b, c] = state.wrench_at_stiffness_frame();
                [x, y, z, a, b, c, 0.0]
            }
        }
    }

    fn contact(self, state: &RobotState) -> &[f64] {
        match self {
            Self::Joints => &state.joint_contact,
            Self::Axes => &state.cartesian_contact,
        }
    }

    fn collision(self, state: &RobotState) -> &[f64] {
        match self {
            Self::Joints => &state.joint_collision,
            Self::Axes => &state.cartesian_collision,
        }
    }

    fn subject(self, index: usize) -> Subject {
        match self {
            Self::Joints => Subject::joint(index),
            Self::Axes => Subject::component(index),
        }
    }

    fn index(self, subject: Subject) -> Option<usize> {
        (0..6 + usize::from(self == Self::Joints)).find(|&i| self.subject(i) == subject)
    }
}

/// Returns the finding for the collision that the flags of the last state report.
pub(super) fn collision(
    evidence: &Evidence<'_>,
    error: RobotError,
    sense: Sense,
) -> Option<Finding> {
    let last = evidence.last()?;
    let index = largest(&sense.load(last), sense.collision(last))?;
    let value = sense.load(last)[index];
    let mut states = evidence.states().rev().skip(1);
    let mut since = last.message_id;
    let before = states.find(|state| {
        let collides = sense.collision(state)[index] != 0.0;
        if collides {
            since = state.message_id;
        }
        !collides
    });
    let passed = before.map(|state| sense.load(state)[index].abs());
    Some(Finding {
        error,
        subject: sense.subject(index),
        quantity: Quantity::ExternalLoad,
        origin: Origin::Estimated,
        value,
        // The load before the flag was set was below the threshold, unless the threshold changed
        // with the acceleration.
        bound: match passed {
            Some(passed) if since == last.message_id && passed < value.abs() => {
                Bound::Between(passed, value.abs())
            }
            _ => Bound::Unknown,
        },
        since,
    })
}

/// Returns the contact at the end of the motion. If `of` has a contact, this is its contact.
/// Otherwise it is the strongest contact of a joint, or of an axis if no joint has a contact.
pub(super) fn contact(evidence: &Evidence<'_>, of: Option<Subject>) -> Option<Cause> {
    let state = evidence.last()?;
    let named = of.and_then(|subject| {
        Sense::ALL.into_iter().find_map(|sense| {
            let index = sense.index(subject)?;
            (sense.contact(state)[index] != 0.0).then_some((sense, index))
        })
    });
    let (sense, index) = named.or_else(|| {
        Sense::ALL
            .into_iter()
            .find_map(|sense| Some((sense, largest(&sense.load(state), sense.contact(state))?)))
    })?;
    let mut since = state.message_id;
    let mut value = sense.load(state)[index];
    let held = evidence
        .states()
        .rev()
        .take_while(|state| sense.contact(state)[index] != 0.0);
    for state in held {
        since = state.message_id;
        let load = sense.load(state)[index];
        if load.abs() > value.abs() {
            value = load;
        }
    }
    Some(Cause::Contact {
        subject: sense.subject(index),
        value,
        since,
    })
}

/// The push on a joint that no contact flag shows, because the thresholds are high: the joint of
/// the finding, or otherwise the joint with the largest load relative to its torque limit.
pub(super) fn push(evidence: &Evidence<'_>, of: Option<Subject>) -> Option<Cause> {
    let limit = &evidence.model.joint_limits().torque;
    let share = |state: &RobotState, i: usize| Sense::Joints.load(state)[i].abs() / limit[i];
    let last = evidence.last()?;
    let index = of.and_then(|subject| Sense::Joints.index(subject));
    let joints = (0..7).filter(|&i| share(last, i) >= PUSH);
    let index = joints
        .filter(|i| index.is_none_or(|index| index == *i))
        .max_by(|&a, &b| share(last, a).total_cmp(&share(last, b)))?;
    let (mut since, mut value) = (last.message_id, 0.0_f64);
    let held = evidence.states().rev();
    for state in held.take_while(|state| share(state, index) >= PUSH) {
        since = state.message_id;
        let load = Sense::Joints.load(state)[index];
        if load.abs() > value.abs() {
            value = load;
        }
    }
    Some(Cause::Contact {
        subject: Subject::joint(index),
        value,
        since,
    })
}

/// Smallest share of a joint's torque limit at which an external torque counts as a push.
const PUSH: f64 = 0.3;

/// Index of the largest load whose flag is set.
fn largest(loads: &[f64], flags: &[f64]) -> Option<usize> {
    (0..flags.len())
        .filter(|&i| flags[i] != 0.0 && loads[i].is_finite())
        .max_by(|&a, &b| loads[a].abs().total_cmp(&loads[b].abs()))
}
