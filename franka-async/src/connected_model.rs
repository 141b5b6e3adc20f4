//! The model of the connected arm, from the robot's description if it has one, and a hash of what
//! the robot sends about its model.

use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};
use std::time::Duration;

use franka_model::Model;
use franka_proto::{Architecture, Command, Request, System, Version};

use crate::builder::Builder;
use crate::command_channel::{Channel, Response};
use crate::error::CommandError;
#[cfg(not(feature = "urdf"))]
use crate::error::ConnectError;
#[cfg(feature = "urdf")]
use crate::error::ModelError;
use crate::parameters;
use crate::robot::Robot;
use crate::state_model::nominal;

/// Time limit for the download of a library.
const DOWNLOAD: Duration = Duration::from_secs(30);

/// Returns the model of the arm, and a hash of the robot's description if the model comes from it.
/// Without a description, or if it is not wanted, the model contains the constants of the kind of
/// robot.
#[cfg(feature = "urdf")]
pub(crate) async fn of(
    version: Version,
    channel: &Channel,
    builder: &Builder,
) -> Result<(Model, Option<u64>), ModelError> {
    if version.supports(Command::GetRobotModel) && !builder.nominal_model {
        let text = parameters::urdf(channel, builder.connect_timeout).await?;
        return Ok((Model::from_urdf(&text)?, Some(hash(text.as_bytes()))));
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

/// Asks the robot for its description, or else for its model library, and returns a hash of it. A
/// robot that sends neither in time has no hash.
pub(crate) async fn hash_of(version: Version, channel: &Channel, limit: Duration) -> Option<u64> {
    let sent = if version.supports(Command::GetRobotModel) {
        parameters::urdf(channel, limit)
            .await
            .map(String::into_bytes)
    } else {
        library(channel, (Architecture::X64, System::Linux), limit).await
    };
    match sent {
        Ok(bytes) => Some(hash(&bytes)),
        Err(error) => {
            tracing::debug!(%error, "the robot is recognised without a model");
            None
        }
    }
}

fn hash(bytes: &[u8]) -> u64 {
    BuildHasherDefault::<DefaultHasher>::default().hash_one(bytes)
}

/// Returns the bytes of the robot's model library; waits for `limit` at most.
async fn library(
    channel: &Channel,
    (architecture, system): (Architecture, System),
    limit: Duration,
) -> Result<Vec<u8>, CommandError> {
    let request = Request::LoadModelLibrary {
        architecture,
        system,
    };
    match channel.call(request, limit).await? {
        Response::Library(bytes) => Ok(bytes),
        _ => unreachable!("the session matches replies to the commands they answer"),
    }
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
        library(&self.channel(), (architecture, system), DOWNLOAD).await
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
