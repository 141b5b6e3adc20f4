//! Differences of a robot that answers after a lost connection.

use core::fmt;

/// Differences between the robot that answers after a lost connection and the robot before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Differences {
    /// Its description of itself, or the fact that it has one.
    pub description: bool,
    /// A frame of its end effector (`F_T_NE`, `NE_T_EE`, `EE_T_K`), or the end effector's mass,
    /// centre of mass or inertia.
    pub frames: bool,
    /// Its clock advanced by another time than has passed: it was restarted, or is another robot.
    pub clock: bool,
    /// The first joint, from 1, that is more than 5 mrad from where it was. A joint that moved may
    /// also have run on for as long as braking takes.
    pub joint: Option<u8>,
}

impl Differences {
    /// True if nothing differs.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// One line, such as `its clock does not continue, as after a restart; joint 3 has moved`.
impl fmt::Display for Differences {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let flags = [
            (self.description, "its description has changed"),
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
