//! Passes only if none of `franka-proto`, `franka-model` and `franka-otg`, nor anything they depend
//! on, uses the standard library or an allocator. A program may have only one panic handler. The
//! standard library defines one, so a crate that uses it conflicts with the handler below, on every
//! target. A crate that uses `alloc` needs a global allocator, which does not exist here. A bare
//! target has no standard library at all.

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
