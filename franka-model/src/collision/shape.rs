//! Capsules that describe the links and the tool.

use nalgebra::Vector3;

use super::capsules::{
    COVERING_HAND, COVERING_PAIRS, FER, FR3, LinkCapsule, VENDOR, VENDOR_HAND, VENDOR_PAIRS,
};
use crate::geometry::Lengths;
use crate::kind::RobotKind;

/// A capsule: all points within `radius` of a segment. It is a ball if both ends coincide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule {
    /// One end of the axis, `[m]`.
    pub start: Vector3<f64>,
    /// The other end, `[m]`.
    pub end: Vector3<f64>,
    /// Radius, `[m]`.
    pub radius: f64,
}

impl Capsule {
    /// Creates a capsule from the ends of the axis and the radius, `[m]`.
    pub const fn new(start: [f64; 3], end: [f64; 3], radius: f64) -> Self {
        let ([a, b, c], [x, y, z]) = (start, end);
        Self {
            start: Vector3::new(a, b, c),
            end: Vector3::new(x, y, z),
            radius,
        }
    }

    /// Returns true if all numbers are finite and the radius is not negative.
    fn is_valid(&self) -> bool {
        let mut ends = self.start.iter().chain(self.end.iter());
        ends.all(|x| x.is_finite()) && self.radius.is_finite() && self.radius >= 0.0
    }
}

/// Capsules on the links of the arm and on the flange.
///
/// Two sets of capsules describe the arm: [`vendor`](Self::vendor) for self-collision and
/// [`covering`](Self::covering) for obstacles. Neither set depends on the end effector. Add the
/// [Hand](Self::with_hand) or [another tool](Self::with_tool) to either set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape<'a> {
    /// Capsules of the arm, ordered by link from the base.
    pub(super) arm: &'static [LinkCapsule],
    /// Indices into `arm` of capsules that can meet, with the inner capsule first.
    pub(super) pairs: &'static [(u8, u8)],
    /// Capsules in the flange frame.
    pub(super) tool: &'a [Capsule],
    /// Capsules of the Hand from the same set as `arm`, in the flange frame.
    hand: &'static [Capsule],
    pub(super) lengths: Lengths,
}

impl Shape<'static> {
    /// Returns the vendor's capsules for self-collision, the same for both robots.
    ///
    /// The vendor made these capsules for links that are far from each other along the chain. The
    /// capsules **do not cover** the links: for example, the elbow extends several centimetres
    /// beyond them. For obstacles use [`covering`](Self::covering).
    ///
    /// The shape contains a pair of capsules if at least one link is between their links, and if
    /// they come within 5 cm of each other within the position limits of either robot. Links 1 and
    /// 3 are no pair, because their capsules overlap around the shoulder, where the links
    /// themselves fit together.
    pub const fn vendor() -> Self {
        Self {
            arm: &VENDOR,
            pairs: &VENDOR_PAIRS,
            tool: &[],
            hand: &VENDOR_HAND,
            lengths: Lengths::DESCRIBED,
        }
    }

    /// Returns capsules that contain the links, for the distance to obstacles.
    ///
    /// The capsules contain the collision and visual meshes of the FR3, or the visual meshes of the
    /// FER. [`with_hand`](Self::with_hand) adds the Hand's body, and its fingers at any width.
    /// Cables, cameras, covers and other parts mounted on an arm are not included.
    ///
    /// The capsules are up to 3.5 cm thicker than the links, so a small negative distance is not
    /// always a collision. Each of the base, link 1 and link 2 forms pairs with links 5 to 7. Links
    /// that are closer to each other form no pairs, because their capsules touch in common
    /// postures.
    pub const fn covering(kind: RobotKind) -> Self {
        let arm: &[LinkCapsule] = match kind {
            RobotKind::Fr3 => &FR3,
            RobotKind::Fer => &FER,
        };
        Self {
            arm,
            pairs: &COVERING_PAIRS,
            tool: &[],
            hand: &COVERING_HAND,
            lengths: Lengths::DESCRIBED,
        }
    }

    /// Sets the lengths of the arm, usually to [`Model::lengths`](crate::Model::lengths). The
    /// default is [`Lengths::DESCRIBED`].
    pub const fn with_lengths(self, lengths: Lengths) -> Self {
        Self { lengths, ..self }
    }

    /// Adds the Franka Hand on the flange, turned by -45° about its axis as the vendor mounts it.
    pub const fn with_hand(self) -> Self {
        Self {
            tool: self.hand,
            ..self
        }
    }
}

impl Shape<'_> {
    /// Replaces any tool with the given capsules, in the flange frame.
    ///
    /// Distances are computed between the tool and links 0 to 5.
    ///
    /// # Errors
    /// Returns [`ToolError`] if there are more than 8 capsules, if a number is not finite, or if a
    /// radius is negative.
    pub fn with_tool<'a>(&self, capsules: &'a [Capsule]) -> Result<Shape<'a>, ToolError> {
        if capsules.len() > TOOL_MAX {
            return Err(ToolError::TooMany {
                got: capsules.len(),
            });
        }
        if let Some(index) = capsules.iter().position(|capsule| !capsule.is_valid()) {
            return Err(ToolError::NotACapsule {
                index,
                got: capsules[index],
            });
        }
        Ok(Shape {
            arm: self.arm,
            pairs: self.pairs,
            tool: capsules,
            hand: self.hand,
            lengths: self.lengths,
        })
    }

    pub(super) fn len(&self) -> usize {
        self.arm.len() + self.tool.len()
    }
}

/// Reason why capsules are not valid as a tool.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ToolError {
    /// The tool has more than 8 capsules.
    TooMany {
        /// Number of capsules.
        got: usize,
    },
    /// A number is not finite, or the radius is negative.
    NotACapsule {
        /// Index of the capsule.
        index: usize,
        /// The capsule.
        got: Capsule,
    },
}

impl core::fmt::Display for ToolError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooMany { got } => {
                write!(
                    f,
                    "the tool has {got} capsules, expected {TOOL_MAX} at most"
                )
            }
            Self::NotACapsule { index, got } => write!(
                f,
                "capsule {index} of the tool extends from {:?} m to {:?} m with a radius of {} m, \
                 expected finite numbers and a radius of 0 or more",
                got.start.as_slice(),
                got.end.as_slice(),
                got.radius
            ),
        }
    }
}

impl core::error::Error for ToolError {}

/// Largest number of capsules of a tool.
pub(super) const TOOL_MAX: usize = 8;
