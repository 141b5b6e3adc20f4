//! The error for a device that uses another version.

use core::fmt;

use super::Protocol;
use crate::version::Version;

/// The device uses a different protocol version from the version that the client announced.
///
/// `Display` prints libfranka's message: the message of release 0.21 if the client uses protocol
/// 10, and of release 0.9 if it uses protocol 5. [`IncompatibleVersion::explanation`] describes the
/// same problem in plain words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct IncompatibleVersion<P: Protocol = Version> {
    /// The device's version.
    pub server_version: u16,
    /// The version that the client announced.
    pub library_version: P,
}

impl<P: Protocol> IncompatibleVersion<P> {
    /// Returns an explanation. It names the device, its system image, and what the user can do.
    ///
    /// ```
    /// use franka_proto::{IncompatibleVersion, Version};
    ///
    /// let error = IncompatibleVersion { server_version: 5, library_version: Version::V10 };
    /// assert_eq!(
    ///     error.explanation().to_string(),
    ///     "a Franka Emika Robot (Panda) with system image 4.2.1 or later speaks version 5: \
    ///      connect with version 5, which this driver also supports",
    /// );
    /// ```
    #[must_use]
    pub fn explanation(&self) -> Explanation<P> {
        Explanation(*self)
    }
}

impl<P: Protocol> fmt::Display for IncompatibleVersion<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (server, library) = (self.server_version, self.library_version.number());
        let [updates, images] = self.library_version.incompatible_advice();
        write!(
            f,
            "libfranka: Incompatible library version (server version: {server}, library version: \
             {library}). Please check {updates} or choose a libfranka version that uses the server \
             version {server} from the table at {images} ."
        )
    }
}

impl<P: Protocol> core::error::Error for IncompatibleVersion<P> {}

/// Prints the text of [`IncompatibleVersion::explanation`] with `Display`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Explanation<P: Protocol = Version>(IncompatibleVersion<P>);

impl<P: Protocol> fmt::Display for Explanation<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let server = self.0.server_version;
        match P::field(server) {
            Some(field) => {
                let (name, system) = (field.name, field.system);
                write!(
                    f,
                    "a {name} with system image {system} speaks version {server}: "
                )?;
                match field.update {
                    Some(update) => write!(
                        f,
                        "update the robot's system to {update} (Desk, Settings, System)"
                    ),
                    None => write!(
                        f,
                        "connect with version {server}, which this driver also supports"
                    ),
                }
            }
            None => {
                let device = self.0.library_version.device();
                write!(
                    f,
                    "this driver knows no {device} with version {server}; it supports"
                )?;
                for (position, number) in P::spoken().iter().enumerate() {
                    let before = if position == 0 { "" } else { " and" };
                    write!(f, "{before} {number}")?;
                }
                match P::spoken().last() {
                    Some(newest) if server > *newest => {
                        f.write_str("; a newer release of this driver may support it")
                    }
                    _ => Ok(()),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gripper;
    use std::string::ToString;

    #[test]
    fn the_incompatible_text_is_that_of_the_versions_libfranka() {
        let text = |library_version, server_version| {
            let error = IncompatibleVersion {
                server_version,
                library_version,
            };
            error.to_string()
        };
        assert_eq!(
            text(Version::V10, 5),
            "libfranka: Incompatible library version (server version: 5, library version: 10). Please check https://frankarobotics.github.io for system updates or choose a libfranka version that uses the server version 5 from the table at https://frankarobotics.github.io/docs/libfranka/docs/compatibility_with_images.html ."
        );
        assert_eq!(
            text(Version::V5, 10),
            "libfranka: Incompatible library version (server version: 10, library version: 5). Please check https://frankaemika.github.io for Panda system updates or choose a libfranka version that uses the server version 10 from the table at https://frankaemika.github.io/docs/compatibility.html ."
        );
    }

    #[test]
    fn every_version_in_the_field_is_explained() {
        let explanation = |server_version| {
            let error = IncompatibleVersion {
                server_version,
                library_version: Version::V10,
            };
            error.explanation().to_string()
        };
        for (number, robot, system) in [
            (3, "Franka Emika Robot (Panda)", "3.x"),
            (4, "Franka Emika Robot (Panda)", "4.0"),
            (6, "Franka Research 3", "5.2"),
            (7, "Franka Research 3", "5.5"),
            (8, "Franka Research 3", "5.7.0"),
            (9, "Franka Research 3", "5.7.2"),
        ] {
            let update = if number < 5 { "4.2.1" } else { "5.9.0" };
            assert_eq!(
                explanation(number),
                std::format!(
                    "a {robot} with system image {system} speaks version {number}: update the \
                     robot's system to {update} or later (Desk, Settings, System)"
                )
            );
        }
        for (number, robot, system) in [
            (5, "Franka Emika Robot (Panda)", "4.2.1"),
            (10, "Franka Research 3", "5.9.0"),
        ] {
            assert_eq!(
                explanation(number),
                std::format!(
                    "a {robot} with system image {system} or later speaks version {number}: \
                     connect with version {number}, which this driver also supports"
                )
            );
        }
        assert_eq!(
            explanation(11),
            "this driver knows no robot with version 11; it supports 5 and 10; a newer release of \
             this driver may support it"
        );
    }

    #[test]
    fn an_end_effector_has_the_same_text() {
        let error = IncompatibleVersion {
            server_version: 2,
            library_version: gripper::Version::V3,
        };
        let text = error.to_string();
        assert!(text.starts_with(
            "libfranka: Incompatible library version (server version: 2, library version: 3). "
        ));
        assert_eq!(
            error.explanation().to_string(),
            "this driver knows no Franka Hand with version 2; it supports 3"
        );
    }
}
