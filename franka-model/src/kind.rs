//! Which robots there are, and everything that differs between them.

use crate::limits::CartesianLimits;
use crate::model::Model;
use crate::{fer, fr3};

/// The kinds of robot that the crate describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RobotKind {
    /// Franka Research 3, FCI version 10.
    Fr3,
    /// Franka Emika Robot, known as Panda, FCI version 5.
    Fer,
}

impl RobotKind {
    /// Every kind.
    pub const ALL: [Self; 2] = [Self::Fr3, Self::Fer];

    /// The one place that tells the kinds apart.
    pub(crate) const fn description(self) -> &'static Description {
        match self {
            Self::Fr3 => &fr3::FR3,
            Self::Fer => &fer::FER,
        }
    }
}

/// What differs between the kinds; the [geometry](crate::geometry) does not.
pub(crate) struct Description {
    /// The vendor's model, for clients.
    pub(crate) client: &'static Model,
    /// A model that a physical arm could have, for simulation.
    pub(crate) physically_consistent: &'static Model,
    pub(crate) cartesian: CartesianLimits,
}
