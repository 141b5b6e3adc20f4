//! The datagram that the vacuum gripper sends.

use core::fmt;

use zerocopy::FromBytes;

use crate::number_text::General;
use crate::protocol::DecodeError;
use crate::wire::vacuum::VacuumGripperState;

/// All values of one datagram of the vacuum gripper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    /// Time of the gripper's clock `[ms]`.
    pub message_id: u32,
    /// True if the vacuum is within its range.
    pub in_control_range: bool,
    /// True if the object has been dropped off.
    pub part_detached: bool,
    /// True if the gripper holds an object.
    pub part_present: bool,
    /// Status light of the device.
    pub device_status: DeviceStatus,
    /// Power of the pump `[%]`. libfranka converts this value to an unsigned 16-bit number.
    pub actual_power: i32,
    /// Vacuum `[mbar]`. libfranka converts this value to an unsigned 16-bit number.
    pub vacuum: i32,
}

/// The status light of a vacuum gripper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum DeviceStatus {
    /// The device works.
    #[default]
    Green,
    /// The device works, with warnings.
    Yellow,
    /// The device works, with severe warnings.
    Orange,
    /// The device does not work.
    Red,
    /// A byte that the protocol does not define.
    Unknown(u8),
}

impl DeviceStatus {
    /// Returns the status of a wire byte.
    #[must_use]
    pub fn from_byte(byte: u8) -> Self {
        match byte {
            0 => Self::Green,
            1 => Self::Yellow,
            2 => Self::Orange,
            3 => Self::Red,
            unknown => Self::Unknown(unknown),
        }
    }

    /// Returns the wire byte of this status.
    #[must_use]
    pub fn byte(self) -> u8 {
        match self {
            Self::Green => 0,
            Self::Yellow => 1,
            Self::Orange => 2,
            Self::Red => 3,
            Self::Unknown(byte) => byte,
        }
    }
}

impl fmt::Display for DeviceStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Green => "Green",
            Self::Yellow => "Yellow",
            Self::Orange => "Orange",
            Self::Red => "Red",
            Self::Unknown(_) => "Unknown",
        })
    }
}

impl State {
    /// Length of the datagram in bytes.
    pub const SIZE: usize = size_of::<VacuumGripperState>();

    /// Reads a datagram of the vacuum gripper. Additional bytes are ignored.
    ///
    /// # Errors
    /// Returns [`DecodeError::DatagramSize`] if there are fewer than [`State::SIZE`] bytes.
    pub fn decode(bytes: &[u8]) -> Result<Self, DecodeError> {
        let (wire, _) = VacuumGripperState::ref_from_prefix(bytes)
            .map_err(|_| DecodeError::datagram::<VacuumGripperState>(bytes))?;
        Ok(Self {
            message_id: wire.message_id.get(),
            in_control_range: wire.in_control_range != 0,
            part_detached: wire.part_detached != 0,
            part_present: wire.part_present != 0,
            device_status: DeviceStatus::from_byte(wire.device_status),
            actual_power: wire.actual_power.get(),
            vacuum: wire.vacuum.get(),
        })
    }

    /// Returns the datagram for a client.
    #[must_use]
    pub fn encode(&self) -> [u8; Self::SIZE] {
        zerocopy::transmute!(VacuumGripperState {
            message_id: self.message_id.into(),
            in_control_range: u8::from(self.in_control_range),
            part_detached: u8::from(self.part_detached),
            part_present: u8::from(self.part_present),
            device_status: self.device_status.byte(),
            actual_power: self.actual_power.into(),
            vacuum: self.vacuum.into(),
        })
    }
}

/// Prints libfranka's text: a JSON object on one line. The time is in seconds, and booleans are
/// numbers.
impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{{\"in_control_range\": {}, \"part_detached\": {}, \"part_present\": {}, \
             \"device_status\": \"{}\", \"actual_power\": {}, \"vacuum\": {}, \"time\": {}}}",
            u8::from(self.in_control_range),
            u8::from(self.part_detached),
            u8::from(self.part_present),
            self.device_status,
            self.actual_power as u16,
            self.vacuum as u16,
            General(f64::from(self.message_id) * 1e-3)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn device_status_bytes_survive_even_when_unknown() {
        for byte in 0..=u8::MAX {
            assert_eq!(DeviceStatus::from_byte(byte).byte(), byte);
        }
    }
}
