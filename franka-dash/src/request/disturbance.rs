//! Disturbances of a simulated robot by viewers.

use serde::{Deserialize, Serialize};

use super::within;

/// A disturbance of a simulated robot by a viewer.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Disturbance {
    /// Pushes one of links 1 to 7 for [`PUSH_MS`], or until the next push. The point is an offset
    /// from the link's frame, in the axes of this frame, `[m]`. The force is in base axes, `[N]`.
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
    /// Causes a reflex, as a collision would.
    Reflex {},
    /// Sets the network conditions in both directions.
    Network { conditions: Conditions },
    /// Drops every state and every command for this duration, `[ms]`.
    Cut { milliseconds: u32 },
    /// Puts an object of this width between the fingers, `[m]`. It replaces any other object.
    /// `null` removes the object.
    Object { width: Option<f64> },
    /// Attaches this mass to the flange, 5 cm from it, `[kg]`. It replaces any other attached mass.
    /// The robot's load setting does not change.
    Load { mass: f64 },
    /// Replaces the arm with another arm, which is at rest in the current position.
    Arm { arm: ArmKind },
    /// Sets the ratio of robot time to wall-clock time. 0 is a pause, and `null` is as fast as
    /// possible. Only a simulation in virtual time supports this request.
    Speed { speed: Option<f64> },
}

/// Kinds of simulated arms, which deviate from the model by different amounts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum ArmKind {
    Ideal,
    Nominal,
    Realistic,
    Bad,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Conditions {
    /// Share of datagrams that are lost, in `[0, 1]`.
    pub(crate) loss: f64,
    /// Mean number of consecutive lost datagrams.
    pub(crate) burst: f64,
    /// Delay in each direction, `[ms]`.
    pub(crate) delay_ms: f64,
    /// Largest additional delay, `[ms]`.
    pub(crate) jitter_ms: f64,
    /// Rate of pauses of the robot's network interface, `[1/s]`.
    pub(crate) stalls_per_second: f64,
    /// Duration of a pause, `[ms]`.
    pub(crate) stall_ms: f64,
}

impl Conditions {
    fn check(&self) -> Result<(), String> {
        within("the share of lost datagrams", "", self.loss, 0.0..=0.5)?;
        within("the length of bursts", "", self.burst, 1.0..=100.0)?;
        within("the delay", " ms", self.delay_ms, 0.0..=20.0)?;
        within("the jitter", " ms", self.jitter_ms, 0.0..=20.0)?;
        let often = self.stalls_per_second;
        within("the number of stalls per second", "", often, 0.0..=50.0)?;
        within("the length of stalls", " ms", self.stall_ms, 0.0..=50.0)
    }
}

impl Disturbance {
    /// Checks that all numbers are in range. The error states the valid range.
    pub(super) fn check(&self) -> Result<(), String> {
        match self {
            Self::Push {
                link,
                offset,
                force,
            } => {
                within("the link to push", "", *link, 1..=7)?;
                let each = |what, unit, numbers: &[f64; 3], most: f64| {
                    let mut numbers = numbers.iter();
                    numbers.try_for_each(|x| within(what, unit, *x, -most..=most))
                };
                let what = "the push's offset from the link's frame";
                each(what, " m", offset, OFFSET_MAX)?;
                each("a component of the push", " N", force, FORCE_MAX)
            }
            Self::Network { conditions } => conditions.check(),
            Self::Cut { milliseconds } => within("the cut", " ms", *milliseconds, 1..=10_000),
            Self::Object { width: Some(width) } => within("the width", " m", *width, 0.001..=0.08),
            Self::Load { mass } => within("the load", " kg", *mass, 0.0..=5.0),
            Self::UserStop { .. }
            | Self::Guide { .. }
            | Self::Brakes { .. }
            | Self::Reflex {}
            | Self::Object { width: None }
            // The simulator itself checks the speed.
            | Self::Speed { .. }
            | Self::Arm { .. } => Ok(()),
        }
    }
}

/// Duration of one push, `[ms]`. The page renews the push every 50 ms while the user drags the
/// pointer.
pub(crate) const PUSH_MS: u64 = 200;

const OFFSET_MAX: f64 = 1.0;
const FORCE_MAX: f64 = 200.0;
