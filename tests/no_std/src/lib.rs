//! Builds only if none of `franka-proto`, `franka-model` and `franka-otg`, nor anything they depend
//! on, uses the standard library or an allocator.
//!
//! The standard library defines a panic handler, and a program may have one: whoever brings it in
//! collides with the one below, on every target. Whoever brings in `alloc` needs a global
//! allocator, and there is none. A bare target proves the first by not having a standard library at
//! all.

#![no_std]

use franka_model as _;
use franka_otg as _;
use franka_proto as _;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
