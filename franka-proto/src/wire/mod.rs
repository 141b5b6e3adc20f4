//! The structs of the wire: little-endian, packed, declared once for all versions and services.
//!
//! What differs between the versions is a type parameter: the width of a state's numbers
//! ([`Real`]), and the parts that protocol 10 appended and protocol 5 fills with `()`. The field
//! names are the vendor's. Size, alignment and every offset are asserted at compile time.
//!
//! All types here are plain bytes: `zerocopy` reads them from any slice that is long enough and no
//! accessor can panic. Meaning (enums, options, `f64`) starts one level up.

/// Asserts at compile time that a wire struct has no padding and its fields sit where they should.
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
