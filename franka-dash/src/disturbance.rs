//! What a viewer can do to a simulated robot.

use franka_async::model::Frame;
use franka_async::nalgebra::Vector3;
use franka_async::state::RobotError;
use franka_sim::{Robot, Touch, TouchId};
use serde::Deserialize;

/// What a viewer can do to a simulated robot.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Disturbance {
    /// Pushes link 1 to 7 at an offset from its frame, in the axes of the link, `[m]`, with a force
    /// in base axes, `[N]`, for
    /// [`PUSH_MS`] or until the next push.
    Push {
        link: usize,
        offset: [f64; 3],
        force: [f64; 3],
    },
    /// Presses or releases the user stop.
    UserStop { pressed: bool },
    /// Presses or releases the guiding buttons.
    Guide { pressed: bool },
    /// Closes or opens the brakes.
    Brakes { closed: bool },
    /// Causes a reflex, as by a collision.
    Reflex {},
}

impl Disturbance {
    /// Whether its numbers are within bounds; otherwise what they have to be.
    pub(crate) fn check(&self) -> Result<(), &'static str> {
        let Self::Push {
            link,
            offset,
            force,
        } = self
        else {
            return Ok(());
        };
        let within = |v: &[f64; 3], most: f64| v.iter().all(|x| x.abs() <= most);
        if !(1..=7).contains(link) {
            Err("links 1 to 7 can be pushed")
        } else if !within(offset, OFFSET_MAX) {
            Err("a link is pushed within 1 m of its frame")
        } else if !within(force, FORCE_MAX) {
            Err("each component of a push is 200 N at most")
        } else {
            Ok(())
        }
    }

    /// Does it, to be [checked](Self::check) before. `pushing` is the push that may still go on.
    pub(crate) fn apply(self, robot: &mut Robot, pushing: &mut Option<TouchId>) {
        match self {
            Self::Push {
                link,
                offset,
                force,
            } => {
                let push = Touch::force(Vector3::from(force))
                    .at(Frame::ALL[link - 1])
                    .offset(Vector3::from(offset))
                    .lasting(PUSH_MS);
                if let Some(before) = pushing.replace(robot.touch(push)) {
                    robot.release(before);
                }
            }
            Self::UserStop { pressed } => robot.press_user_stop(pressed),
            Self::Guide { pressed } => {
                robot.guide(pressed);
            }
            Self::Brakes { closed: true } => robot.close_brakes(),
            Self::Brakes { closed: false } => robot.open_brakes(),
            Self::Reflex {} => robot.trip(RobotError::CartesianReflex),
        }
    }
}

/// How long one push lasts, `[ms]`; the page renews it every 50 ms while the pointer drags.
pub(crate) const PUSH_MS: u64 = 200;

const OFFSET_MAX: f64 = 1.0;
const FORCE_MAX: f64 = 200.0;
