//! The motion during a hold.

use serde::Deserialize;

use super::within;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Axes {
    Base,
    Tool,
}

/// The motion while a button is held.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Motion {
    /// Moves the end effector along a direction.
    Translate { direction: [f64; 3], axes: Axes },
    /// Turns the end effector about an axis through its origin.
    Rotate { direction: [f64; 3], axes: Axes },
    /// Moves one of joints 1 to 7 towards the upper or lower end of its range.
    Joint { joint: usize, up: bool },
    /// Moves all joints to these positions, `[rad]`.
    Joints { q: [f64; 7] },
    /// Moves all joints to the ready pose.
    Ready {},
    /// Holds the arm in place with its current stiffness.
    Stay {},
    /// Moves the end effector to a pose in the base frame on a straight line.
    Pose {
        /// Position x y z, `[m]`.
        position: [f64; 3],
        /// Orientation as a quaternion x y z w. Its length must not be zero.
        orientation: [f64; 4],
    },
}

impl Motion {
    /// Checks that the numbers form a valid motion. Otherwise returns the error text.
    pub(super) fn check(&self) -> Result<(), String> {
        match self {
            Self::Translate { direction, .. } | Self::Rotate { direction, .. } => {
                let norm = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
                match norm.is_finite() && norm > 1e-6 {
                    true => Ok(()),
                    false => Err(format!(
                        "got the direction {direction:?}, expected three finite numbers, not all \
                         zero"
                    )),
                }
            }
            Self::Joint { joint, .. } => within("the joint", "", *joint, 1..=7),
            Self::Joints { q } if !q.iter().all(|x| x.is_finite()) => Err(format!(
                "got the joint positions {q:?}, expected finite numbers"
            )),
            Self::Pose {
                position,
                orientation,
            } => {
                for x in position {
                    within("a coordinate", " m", *x, -FAR..=FAR)?;
                }
                let norm = orientation.iter().map(|x| x * x).sum::<f64>().sqrt();
                within("the length of a quaternion", "", norm, 1e-3..=1e3)
            }
            Self::Joints { .. } | Self::Ready {} | Self::Stay {} => Ok(()),
        }
    }
}

/// Largest speed of any point of the arm, `[m/s]`. It is the reduced speed of ISO 10218-1.
pub(crate) const SPEED_MAX: f64 = 0.25;

/// Smallest speed, `[m/s]`.
pub(crate) const SPEED_MIN: f64 = 0.001;

/// Largest magnitude of a coordinate, `[m]`. No arm reaches this far.
const FAR: f64 = 2.0;
