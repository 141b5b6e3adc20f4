//! The versions of the robot's protocol.

use core::fmt;

/// A version of the robot's protocol (FCI) that this crate supports.
///
/// `Display` prints the number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Version {
    /// Franka Emika Robot (Panda), system image 4.2.1 and later.
    V5,
    /// Franka Research 3, system image 5.9.0 and later.
    V10,
}

impl Version {
    /// All versions, in ascending order.
    pub const ALL: [Self; 2] = [Self::V5, Self::V10];

    /// TCP port of the robot in all versions.
    pub const TCP_PORT: u16 = 1337;

    /// Returns the number of this version in the handshake.
    #[must_use]
    pub fn number(self) -> u16 {
        match self {
            Self::V5 => 5,
            Self::V10 => 10,
        }
    }

    /// Returns the version with this number, if this crate supports it.
    #[must_use]
    pub fn from_number(number: u16) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|version| version.number() == number)
    }

    /// Returns the vendor's name of the robot that uses this version.
    #[must_use]
    pub fn robot(self) -> &'static str {
        match self {
            Self::V5 => "Franka Emika Robot",
            Self::V10 => "Franka Research 3",
        }
    }
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.number(), f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_found_by_their_number_alone() {
        for version in Version::ALL {
            assert_eq!(Version::from_number(version.number()), Some(version));
        }
        for number in [0, 3, 4, 6, 7, 8, 9, 11] {
            assert_eq!(Version::from_number(number), None);
        }
    }
}
