//! The model of the connected arm: from what the robot says of itself, where it says something.

use std::time::Duration;

use franka_model::{Model, RobotKind};
#[cfg(feature = "urdf")]
use franka_proto::Command;
use franka_proto::{Architecture, Request, System, Version};

#[cfg(not(feature = "urdf"))]
use crate::ConnectError;
use crate::channel::{Answer, Channel};
#[cfg(feature = "urdf")]
use crate::parameters;
use crate::{Builder, CommandError, Robot};

/// Time for a library to come over the network.
const DOWNLOAD: Duration = Duration::from_secs(30);

#[cfg(feature = "urdf")]
pub use described::ModelError;
#[cfg(all(feature = "model-library", target_os = "linux"))]
pub use library::ModelLibraryError;

/// The model of the arm: from its description if it has one and that is wanted, the constants of
/// its kind otherwise.
#[cfg(feature = "urdf")]
pub(crate) async fn of(
    version: Version,
    channel: &Channel,
    builder: &Builder,
) -> Result<Model, ModelError> {
    if version.supports(Command::GetRobotModel) && !builder.nominal_model {
        let text = parameters::urdf(channel, builder.connect_timeout).await?;
        return Ok(Model::from_urdf(&text)?);
    }
    Ok(nominal(version))
}

/// The model of the arm: the constants of its kind.
#[cfg(not(feature = "urdf"))]
pub(crate) async fn of(version: Version, _: &Channel, _: &Builder) -> Result<Model, ConnectError> {
    Ok(nominal(version))
}

/// The constants of the robot that speaks `version`: a version belongs to one kind.
fn nominal(version: Version) -> Model {
    let kind = match version {
        Version::V5 => RobotKind::Fer,
        Version::V10 => RobotKind::Fr3,
    };
    Model::of(kind).clone()
}

impl Robot {
    /// Asks for the model library of a Franka Emika Robot, and gives its bytes: a shared library in
    /// the format of the system. Protocol 5 only.
    ///
    /// # Errors
    /// [`CommandError`]; [`CommandError::Request`] for a version that has no such command, without
    /// asking the robot.
    ///
    /// # Cancel safety
    /// Nothing is lost but the answer.
    pub async fn load_model_library(
        &self,
        architecture: Architecture,
        system: System,
    ) -> Result<Vec<u8>, CommandError> {
        let request = Request::LoadModelLibrary {
            architecture,
            system,
        };
        match self.channel().call(request, DOWNLOAD).await? {
            Answer::Library(bytes) => Ok(bytes),
            _ => unreachable!("the session matches replies to the commands they answer"),
        }
    }
}

#[cfg(feature = "urdf")]
mod described {
    use franka_model::urdf::UrdfError;

    use crate::CommandError;
    use crate::error::Party;

    /// Why there is no model of the connected arm.
    /// [`Builder::nominal_model`](crate::Builder::nominal_model) does without its description.
    #[derive(Clone, Debug, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum ModelError {
        /// The robot was asked for its description and did not give it.
        #[error(transparent)]
        Command(#[from] CommandError),
        /// Robot: its description is not that of an arm that this driver knows.
        #[error(transparent)]
        Urdf(#[from] UrdfError),
    }

    impl ModelError {
        /// Who can act on it.
        pub fn party(&self) -> Party {
            match self {
                Self::Command(error) => error.party(),
                Self::Urdf(_) => Party::Peer,
            }
        }
    }

    #[cfg(test)]
    mod tests {
        use franka_model::Model;

        use super::*;
        use crate::error::{ConnectError, Error};

        #[test]
        fn a_description_that_cannot_be_read_is_nobodys_fault_here() {
            let error = Model::from_urdf("<sdf/>").expect_err("no description");
            let text = error.to_string();
            let error: ConnectError = ModelError::from(error).into();
            let error = Error::from(error);
            assert_eq!((error.to_string(), error.party()), (text, Party::Peer));
        }
    }
}

#[cfg(all(feature = "model-library", target_os = "linux"))]
mod library {
    use franka_model::model_library::{LibraryError, ModelLibrary};
    use franka_proto::{Architecture, System};

    use crate::error::Party;
    use crate::{CommandError, Robot};

    impl Robot {
        /// Asks a Franka Emika Robot for its model library and loads it into this process. Needs
        /// the feature `model-library`, and Linux.
        ///
        /// The call is unsafe, the future is not: `unsafe { robot.model_library() }.await`.
        ///
        /// # Errors
        /// [`ModelLibraryError`].
        ///
        /// # Cancel safety
        /// Nothing is lost but the answer.
        ///
        /// # Safety
        /// The robot must be one that may run code in this process: see [`ModelLibrary::load`].
        pub async unsafe fn model_library(&self) -> Result<ModelLibrary, ModelLibraryError> {
            let architecture = host_architecture().ok_or(LibraryError::Architecture)?;
            let bytes = self.load_model_library(architecture, System::Linux).await?;
            // SAFETY: the caller vouches for what the robot sends.
            Ok(unsafe { ModelLibrary::load(&bytes) }?)
        }
    }

    /// What the protocol calls the processor that this was compiled for, if it has a name for it.
    fn host_architecture() -> Option<Architecture> {
        Some(match std::env::consts::ARCH {
            "x86_64" => Architecture::X64,
            "x86" => Architecture::X86,
            "arm" => Architecture::Arm,
            "aarch64" => Architecture::Arm64,
            _ => return None,
        })
    }

    /// Why the robot's model library cannot be used.
    #[derive(Debug, thiserror::Error)]
    #[non_exhaustive]
    pub enum ModelLibraryError {
        /// The robot was asked for it and did not give it.
        #[error(transparent)]
        Command(#[from] CommandError),
        /// It cannot be loaded.
        #[error(transparent)]
        Library(#[from] LibraryError),
    }

    impl ModelLibraryError {
        /// Who can act on it.
        pub fn party(&self) -> Party {
            match self {
                Self::Command(error) => error.party(),
                Self::Library(LibraryError::Load { .. } | LibraryError::Symbol { .. }) => {
                    Party::Peer
                }
                Self::Library(_) => Party::Host,
            }
        }
    }

    #[cfg(test)]
    mod tests {
        use super::*;
        use crate::error::Error;

        #[test]
        fn an_architecture_without_a_library_is_this_computers() {
            let error = Error::from(ModelLibraryError::from(LibraryError::Architecture));
            assert_eq!(error.to_string(), "libfranka: Unsupported architecture!");
            assert_eq!(error.party(), Party::Host);
        }
    }
}
