//! Panics of the user's code: their messages, and destructors that panic.

use core::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Returns the text of a panic; for other payloads, a replacement.
pub(crate) fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("no message").to_owned()
}

/// Frees a value of the user. Call it on other threads than the control thread.
///
/// # Errors
/// The message of the panic, if the value's destructor panics.
pub fn free<T>(value: T) -> Result<(), String> {
    // Nothing sees the half-finished state of a destructor.
    let freed = catch_unwind(AssertUnwindSafe(|| drop(value)));
    freed.map_err(|payload| {
        let text = message(&*payload);
        let payload_freed = catch_unwind(AssertUnwindSafe(|| drop(payload)));
        // The payload's destructor panics as well. The next payload might do the same, without end.
        payload_freed.unwrap_or_else(core::mem::forget);
        text
    })
}
