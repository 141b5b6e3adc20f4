//! The wire structs, which are little-endian and packed. Each struct is declared once for all
//! versions and services.
//!
//! Type parameters express the differences between the versions: the width of a state's numbers
//! ([`Real`]), and the parts that only protocol 10 has. Protocol 5 has `()` in their place. The
//! field names are the vendor's. Size, alignment and every offset are asserted at compile time.
//!
//! All types here are plain bytes: `zerocopy` reads them from any sufficiently long slice, and no
//! accessor can panic. The types outside of this module use enums, options and `f64` instead.

/// Asserts at compile time that a wire struct has no padding, and that its fields have the expected
/// offsets.
macro_rules! assert_layout {
    ($type:ty, size: $size:literal, { $($($field:ident).+: $offset:literal),* $(,)? }) => {
        const _: () = {
            assert!(size_of::<$type>() == $size);
            assert!(align_of::<$type>() == 1);
            $(assert!(core::mem::offset_of!($type, $($field).+) == $offset);)*
        };
    };
}

pub mod gripper;
mod header;
mod real;
mod robot_command;
mod robot_state;
pub mod service;
pub mod vacuum;

pub use header::{CommandHeader, CommandNumber};
pub use real::{F32, F64, Real, from_wire, to_wire};
pub use robot_command::{ControllerCommand, MotionGeneratorCommand, RobotCommand};
pub use robot_state::{Accelerometers, RobotState};
