//! Estimates the place of a contact on the arm from the external torques.

use std::time::Duration;

use franka_async::model::collision::{Body, Shape};
use franka_async::model::contacts::{Tare, TorqueError, locate};
use franka_async::model::{JointVector, Model};
use franka_async::state::RobotState;
use serde::Serialize;

/// A contact on the arm, in the base frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Contact {
    /// Number of the link, 1 to 7, or 8 for the tool on the flange.
    link: u8,
    /// Point of the contact, `[m]`.
    point: [f64; 3],
    /// Force on the arm, `[N]`.
    force: [f64; 3],
    /// Uncertainty of the point on this link, `[m]`.
    spread: f64,
    /// Probability that the contact is on this link, in `[0, 1]`.
    probability: f64,
}

/// Finds contacts in states. It learns the torques that the robot reports without a contact.
#[derive(Debug, Default)]
pub(crate) struct Watch {
    tare: Tare,
    /// `message_id` of the last state, `[ms]`.
    last: Option<u64>,
}

impl Watch {
    /// Returns the contact in this state, if any. It is enough to pass a few dozen states per
    /// second.
    pub(crate) fn update(&mut self, model: &Model, state: &RobotState) -> Option<Contact> {
        let last = self.last.replace(state.message_id);
        let passed = state
            .message_id
            .saturating_sub(last.unwrap_or(state.message_id));
        let (q, dq) = (JointVector::from(state.q), JointVector::from(state.dq));
        // The robot reports the torque that it exerts. The contact estimate needs the opposite
        // sign.
        let read = -JointVector::from(state.tau_ext_hat_filtered);
        let torque = self.tare.update(&read, &dq, passed as f64 * 1e-3);
        if !self.tare.is_touched() || self.tare.learned() < LEARNED {
            return None;
        }
        let error = match dq.amax() > STILL {
            true => TorqueError::IN_MOTION,
            false => TorqueError::AT_REST,
        };
        let shape = Shape::covering(model.kind()).with_lengths(*model.lengths());
        let shape = match state.m_ee > 0.0 {
            true => shape.with_hand(),
            false => shape,
        };
        // If several links could explain the torques, no contact is shown.
        let found = locate(&shape.at(&q), &torque, &error).ok()?;
        Some(Contact {
            link: match found.body {
                Body::Link(link) => link,
                _ => 8,
            },
            point: found.point.into(),
            force: found.force.into(),
            spread: found.spread,
            probability: found.probability,
        })
    }
}

/// Interval between two evaluations.
pub(crate) const EVERY: Duration = Duration::from_millis(50);

/// Joint velocity below which the arm is at rest, `[rad/s]`.
const STILL: f64 = 0.02;

/// Duration of learning before contacts are shown, `[s]`.
const LEARNED: f64 = 0.5;

#[cfg(test)]
mod tests {
    use franka_async::model::Frame;
    use franka_async::nalgebra::Vector3;
    use franka_sim::{Config, Robot, Tool, Touch};

    use super::*;

    #[test]
    fn contact_matches_the_force_and_place_of_the_push() {
        for push in [[0.0, 40.0, 0.0], [0.0, -40.0, 0.0]] {
            let push = Vector3::from(push);
            let mut robot = Robot::new(Config {
                tool: Tool::hand(),
                ..Config::default()
            });
            let mut watch = Watch::default();
            let mut look = |robot: &mut Robot, milliseconds: u32| {
                let mut seen = None;
                for passed in 1..=milliseconds {
                    robot.tick();
                    if passed % 50 == 0 {
                        seen = watch.update(Model::of(robot.config().kind), robot.state());
                    }
                }
                seen
            };
            assert_eq!(look(&mut robot, 1000), None);
            robot.touch(Touch::force(push).at(Frame::Flange));
            let contact = look(&mut robot, 300).expect("a contact");
            let force = Vector3::from(contact.force);
            assert!(force.dot(&push) > 0.8 * push.norm_squared(), "{contact:?}");
            assert!(contact.link >= 7, "{contact:?}");
        }
    }
}
