//! Differences between the robot before a lost connection and the robot after it.

use core::fmt;

/// Differences between the robot before a lost connection and the robot that answers after it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Differences {
    /// True if the robots' descriptions (URDF) differ, or if only one robot sent one. A robot
    /// without a description has its model library instead.
    pub description: bool,
    /// True if a frame of the end effector differs (`F_T_NE`, `NE_T_EE`, `EE_T_K`), or if the end
    /// effector's mass, centre of mass or inertia differs.
    pub frames: bool,
    /// True if the robot's clock did not advance by the time that has passed: the robot was
    /// restarted, or a different robot answers.
    pub clock: bool,
    /// The first joint, from 1, that is more than 5 mrad from its earlier position. The reason may
    /// also be that the joint was moving when the connection was lost, and moved on while it
    /// braked.
    pub joint: Option<u8>,
}

impl Differences {
    /// True if nothing differs.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// Prints one line, such as `its clock does not continue; joint 3 is elsewhere`.
impl fmt::Display for Differences {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let flags = [
            (self.description, "the model that it sends has changed"),
            (
                self.frames,
                "the frames or mass of its end effector have changed",
            ),
            (
                self.clock,
                "its clock does not continue, as after a restart",
            ),
        ];
        let mut first = true;
        for (_, text) in flags.into_iter().filter(|(differs, _)| *differs) {
            f.write_str(if first { "" } else { "; " })?;
            f.write_str(text)?;
            first = false;
        }
        match self.joint {
            Some(joint) if first => write!(f, "joint {joint} has moved"),
            Some(joint) => write!(f, "; joint {joint} has moved"),
            None => Ok(()),
        }
    }
}
