//! The model of the connected arm, from the robot's description if it has one.

#[cfg(feature = "urdf")]
use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};
use std::time::Duration;

use franka_model::Model;
#[cfg(feature = "urdf")]
use franka_proto::Command;
use franka_proto::{Architecture, Request, System, Version};

use crate::builder::Builder;
use crate::command_channel::{Channel, Response};
use crate::error::CommandError;
#[cfg(not(feature = "urdf"))]
use crate::error::ConnectError;
#[cfg(feature = "urdf")]
use crate::error::ModelError;
#[cfg(feature = "urdf")]
use crate::parameters;
use crate::robot::Robot;
use crate::state_model::nominal;

/// Time limit for the download of a library.
const DOWNLOAD: Duration = Duration::from_secs(30);

/// Returns the model of the arm and a hash of the robot's description. The model comes from the
/// description, if there is one and it is wanted. Otherwise, it contains the constants of the kind
/// of robot.
#[cfg(feature = "urdf")]
pub(crate) async fn of(
    version: Version,
    channel: &Channel,
    builder: &Builder,
) -> Result<(Model, Option<u64>), ModelError> {
    if version.supports(Command::GetRobotModel) && !builder.nominal_model {
        let text = parameters::urdf(channel, builder.connect_timeout).await?;
        let hash = BuildHasherDefault::<DefaultHasher>::default().hash_one(&text);
        return Ok((Model::from_urdf(&text)?, Some(hash)));
    }
    Ok((nominal(version), None))
}

/// Returns the model of the arm, with the constants of the kind of robot.
#[cfg(not(feature = "urdf"))]
pub(crate) async fn of(
    version: Version,
    _: &Channel,
    _: &Builder,
) -> Result<(Model, Option<u64>), ConnectError> {
    Ok((nominal(version), None))
}

impl Robot {
    /// Returns the bytes of the model library of a Franka Emika Robot, which is a shared library in
    /// the format of the system. Protocol 5 only.
    ///
    /// # Errors
    /// Returns [`CommandError`] if the robot does not send the library. If the version has no such
    /// command, returns [`CommandError::Request`] without asking the robot.
    ///
    /// # Cancel safety
    /// Dropping the future loses only the answer.
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
            Response::Library(bytes) => Ok(bytes),
            _ => unreachable!("the session matches replies to the commands they answer"),
        }
    }
}

#[cfg(all(feature = "model-library", target_os = "linux"))]
mod library {
    use franka_model::model_library::{LibraryError, ModelLibrary};
    use franka_proto::{Architecture, System};

    use crate::error::ModelLibraryError;
    use crate::robot::Robot;

    impl Robot {
        /// Asks a Franka Emika Robot for its model library and loads it into this process. This
        /// needs the feature `model-library`, and Linux.
        ///
        /// The call is unsafe, but the future is not: `unsafe { robot.model_library() }.await`.
        ///
        /// # Errors
        /// Returns [`ModelLibraryError`] if the robot does not send the library, or if it cannot be
        /// loaded.
        ///
        /// # Cancel safety
        /// Dropping the future loses only the answer.
        ///
        /// # Safety
        /// You must trust the robot to run code in this process: see [`ModelLibrary::load`].
        pub async unsafe fn model_library(&self) -> Result<ModelLibrary, ModelLibraryError> {
            let architecture = host_architecture().ok_or(LibraryError::Architecture)?;
            let bytes = self.load_model_library(architecture, System::Linux).await?;
            // SAFETY: the caller guarantees that the library of the robot may be loaded.
            Ok(unsafe { ModelLibrary::load(&bytes) }?)
        }
    }

    /// Returns the protocol's name of the processor for which this was compiled, if it has one.
    fn host_architecture() -> Option<Architecture> {
        Some(match std::env::consts::ARCH {
            "x86_64" => Architecture::X64,
            "x86" => Architecture::X86,
            "arm" => Architecture::Arm,
            "aarch64" => Architecture::Arm64,
            _ => return None,
        })
    }
}
