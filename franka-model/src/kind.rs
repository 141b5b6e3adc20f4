//! The kinds of robot. Their constants are in [`robots`](crate::robots).

/// The kinds of robot supported by the crate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
}
