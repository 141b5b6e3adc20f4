//! What a viewer can do to a simulated robot.

use serde::Deserialize;

use super::within;

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
    pub(super) fn check(&self) -> Result<(), String> {
        match self {
            Self::Push {
                link,
                offset,
                force,
            } => {
                within("a link to push", "", *link, 1..=7)?;
                let each = |what, unit, numbers: &[f64; 3], most: f64| {
                    let mut numbers = numbers.iter();
                    numbers.try_for_each(|x| within(what, unit, *x, -most..=most))
                };
                each(
                    "a push's offset from the link's frame",
                    " m",
                    offset,
                    OFFSET_MAX,
                )?;
                each("a component of a push", " N", force, FORCE_MAX)
            }
            Self::UserStop { .. } | Self::Guide { .. } | Self::Brakes { .. } | Self::Reflex {} => {
                Ok(())
            }
        }
    }
}

/// How long one push lasts, `[ms]`; the page renews it every 50 ms while the pointer drags.
pub(crate) const PUSH_MS: u64 = 200;

const OFFSET_MAX: f64 = 1.0;
const FORCE_MAX: f64 = 200.0;
