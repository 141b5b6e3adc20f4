//! Values that messages encode as numbers: modes, guards and times.

use core::time::Duration;

use franka_proto::{MotionGeneratorMode, RobotMode};
use franka_rt::session::{Bindings, Guard};

/// Returns the mode with this number; `Other` for an undefined number.
pub(super) fn robot_mode(number: i32) -> RobotMode {
    u8::try_from(number).map_or(RobotMode::Other, RobotMode::from_byte)
}

pub(super) fn generator_number(mode: MotionGeneratorMode) -> u32 {
    match mode {
        MotionGeneratorMode::Idle => 0,
        MotionGeneratorMode::JointPosition => 1,
        MotionGeneratorMode::JointVelocity => 2,
        MotionGeneratorMode::CartesianPosition => 3,
        MotionGeneratorMode::CartesianVelocity => 4,
        MotionGeneratorMode::None => 5,
        MotionGeneratorMode::Unknown(byte) => 256 + u32::from(byte),
    }
}

pub(super) fn generator(number: u32) -> MotionGeneratorMode {
    match number {
        0 => MotionGeneratorMode::Idle,
        1 => MotionGeneratorMode::JointPosition,
        2 => MotionGeneratorMode::JointVelocity,
        3 => MotionGeneratorMode::CartesianPosition,
        4 => MotionGeneratorMode::CartesianVelocity,
        5 => MotionGeneratorMode::None,
        unknown => MotionGeneratorMode::Unknown((unknown & 0xff) as u8),
    }
}

/// Returns the number of a guard in messages. It is the guard's own number plus one, because 0
/// represents an unnamed guard.
pub(super) fn guard_number(guard: Guard) -> i32 {
    guard as i32 + 1
}

pub(super) fn guard(number: i32) -> Option<Guard> {
    let index = usize::try_from(number).ok()?.checked_sub(1)?;
    Guard::ALL.get(index).copied()
}

pub(super) fn bindings(numbers: &[i32]) -> Bindings {
    let mut bindings = Bindings::default();
    for guard in numbers.iter().filter_map(|&number| guard(number)) {
        bindings.insert(guard);
    }
    bindings
}

/// Converts a time in seconds from a message. Returns zero if the time is invalid.
pub(super) fn seconds(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::franka;

    #[test]
    fn guards_have_the_numbers_of_their_names() {
        for named in Guard::ALL {
            let number = guard_number(named);
            let message = franka::Guard::try_from(number).unwrap();
            assert_eq!(format!("{message:?}"), format!("{named:?}"));
            assert_eq!(guard(number), Some(named));
        }
        assert_eq!(guard(Guard::ALL.len() as i32 + 1), None);
        assert_eq!((guard(0), guard(-1)), (None, None));
    }

    #[test]
    fn modes_keep_their_numbers() {
        for mode in RobotMode::ALL {
            let name = franka::RobotMode::try_from(i32::from(mode.byte())).unwrap();
            assert_eq!(format!("{name:?}"), format!("{mode:?}"));
            assert_eq!(robot_mode(name.into()), mode);
        }
        for byte in 0..=u8::MAX {
            let mode = MotionGeneratorMode::Unknown(byte);
            assert_eq!(generator(generator_number(mode)), mode);
        }
        for number in 0..6 {
            assert_eq!(generator_number(generator(number)), number);
        }
    }
}
