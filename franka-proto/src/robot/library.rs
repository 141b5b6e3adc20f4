//! The model libraries that a client of protocol 5 can load.

use super::motion::nth;
use crate::protocol::DecodeError;
use crate::wire::service::LoadModelLibrary;

/// Processor of a client that requests the model library.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Architecture {
    /// x86, 64 bits.
    X64,
    /// x86, 32 bits.
    X86,
    /// ARM, 32 bits.
    Arm,
    /// ARM, 64 bits.
    Arm64,
}

/// Operating system of a client that requests the model library.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum System {
    /// Linux.
    Linux,
    /// Windows.
    Windows,
}

pub(super) fn to_wire(architecture: Architecture, system: System) -> LoadModelLibrary {
    LoadModelLibrary {
        architecture: architecture as u8,
        system: system as u8,
    }
}

pub(super) fn from_wire(wire: &LoadModelLibrary) -> Result<(Architecture, System), DecodeError> {
    let architectures = [
        Architecture::X64,
        Architecture::X86,
        Architecture::Arm,
        Architecture::Arm64,
    ];
    let systems = [System::Linux, System::Windows];
    Ok((
        nth(&architectures, "architecture", wire.architecture.into())?,
        nth(&systems, "system", wire.system.into())?,
    ))
}
