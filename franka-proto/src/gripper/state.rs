//! The datagram that the Hand sends.

use core::fmt;

use zerocopy::FromBytes;

use crate::number_text::General;
use crate::protocol::DecodeError;
use crate::wire::gripper::GripperState;

/// All values of one datagram.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    /// Time of the Hand's clock `[ms]`.
    pub message_id: u32,
    /// Distance between the fingers `[m]`.
    pub width: f64,
    /// Distance between the fully open fingers `[m]`, measured during homing.
    pub max_width: f64,
    /// True if the hand holds an object of the requested width.
    pub is_grasped: bool,
    /// Temperature of the hand `[deg C]`.
    pub temperature: u16,
}

impl State {
    /// Length of the datagram in bytes.
    pub const SIZE: usize = size_of::<GripperState>();

    /// Reads a datagram of the Hand. Additional bytes are ignored.
    ///
    /// # Errors
    /// Returns [`DecodeError::DatagramSize`] if there are fewer than [`State::SIZE`] bytes.
    pub fn decode(bytes: &[u8]) -> Result<Self, DecodeError> {
        let (wire, _) = GripperState::ref_from_prefix(bytes)
            .map_err(|_| DecodeError::datagram::<GripperState>(bytes))?;
        Ok(Self {
            message_id: wire.message_id.get(),
            width: wire.width.get(),
            max_width: wire.max_width.get(),
            is_grasped: wire.is_grasped != 0,
            temperature: wire.temperature.get(),
        })
    }

    /// Returns the datagram for a client.
    #[must_use]
    pub fn encode(&self) -> [u8; Self::SIZE] {
        zerocopy::transmute!(GripperState {
            message_id: self.message_id.into(),
            width: self.width.into(),
            max_width: self.max_width.into(),
            is_grasped: u8::from(self.is_grasped),
            temperature: self.temperature.into(),
        })
    }
}

/// Prints libfranka's text: a JSON object on one line. The time is in seconds, and booleans are
/// numbers.
impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{{\"width\": {}, \"max_width\": {}, \"is_grasped\": {}, \"temperature\": {}, \
             \"time\": {}}}",
            General(self.width),
            General(self.max_width),
            u8::from(self.is_grasped),
            self.temperature,
            General(f64::from(self.message_id) * 1e-3)
        )
    }
}
