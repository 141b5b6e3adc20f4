//! Panics of the user's code: their messages, and destructors that panic.

use core::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Returns the text of a panic, or a replacement for payloads that are not text.
pub(crate) fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("no message").to_owned()
}

/// Frees a value of the user. Call it on a thread other than the control thread.
///
/// # Errors
/// Returns the message of the panic if the value's destructor panics.
pub fn free<T>(value: T) -> Result<(), String> {
    // No code reads the inconsistent state of the value.
    let freed = catch_unwind(AssertUnwindSafe(|| drop(value)));
    freed.map_err(|payload| {
        let text = message(&*payload);
        let payload_freed = catch_unwind(AssertUnwindSafe(|| drop(payload)));
        // The payload's destructor panicked too. Its payload might do the same, and so on.
        payload_freed.unwrap_or_else(core::mem::forget);
        text
    })
}
