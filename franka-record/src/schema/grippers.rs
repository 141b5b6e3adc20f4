//! Conversion of gripper states to messages, and back.

use franka_proto::{gripper, vacuum};

use super::franka;
use crate::event::GripperState;

impl From<&GripperState> for franka::Gripper {
    fn from(state: &GripperState) -> Self {
        let (time, kind) = match *state {
            GripperState::Hand(hand) => {
                let kind = franka::gripper::Kind::Hand(franka::gripper::Hand {
                    width: hand.width,
                    max_width: hand.max_width,
                    is_grasped: hand.is_grasped,
                    temperature: u32::from(hand.temperature),
                });
                (hand.message_id, kind)
            }
            GripperState::Vacuum(vacuum) => {
                let kind = franka::gripper::Kind::Vacuum(franka::gripper::Vacuum {
                    vacuum: vacuum.vacuum,
                    actual_power: vacuum.actual_power,
                    part_present: vacuum.part_present,
                    part_detached: vacuum.part_detached,
                    in_control_range: vacuum.in_control_range,
                    device_status: u32::from(vacuum.device_status.byte()),
                });
                (vacuum.message_id, kind)
            }
        };
        Self {
            time,
            kind: Some(kind),
        }
    }
}

impl franka::Gripper {
    /// Returns the state in this message; `None` for a kind of gripper that this version does not
    /// know.
    pub fn to_state(&self) -> Option<GripperState> {
        Some(match self.kind.as_ref()? {
            franka::gripper::Kind::Hand(hand) => GripperState::Hand(gripper::State {
                message_id: self.time,
                width: hand.width,
                max_width: hand.max_width,
                is_grasped: hand.is_grasped,
                temperature: u16::try_from(hand.temperature).unwrap_or(u16::MAX),
            }),
            franka::gripper::Kind::Vacuum(vacuum) => {
                let status = u8::try_from(vacuum.device_status).unwrap_or(u8::MAX);
                GripperState::Vacuum(vacuum::State {
                    message_id: self.time,
                    in_control_range: vacuum.in_control_range,
                    part_detached: vacuum.part_detached,
                    part_present: vacuum.part_present,
                    device_status: vacuum::DeviceStatus::from_byte(status),
                    actual_power: vacuum.actual_power,
                    vacuum: vacuum.vacuum,
                })
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use prost::Message as _;

    #[test]
    fn gripper_states_survive_their_messages() {
        for state in [
            GripperState::Hand(gripper::State {
                message_id: 9,
                width: 0.05,
                max_width: 0.08,
                is_grasped: true,
                temperature: 31,
            }),
            GripperState::Vacuum(vacuum::State {
                message_id: 9,
                in_control_range: true,
                part_detached: false,
                part_present: true,
                device_status: vacuum::DeviceStatus::Unknown(17),
                actual_power: 80,
                vacuum: -5,
            }),
        ] {
            let bytes = franka::Gripper::from(&state).encode_to_vec();
            let message = franka::Gripper::decode(&*bytes).unwrap();
            assert_eq!(message.to_state(), Some(state));
        }
        assert_eq!(franka::Gripper::default().to_state(), None);
    }
}
