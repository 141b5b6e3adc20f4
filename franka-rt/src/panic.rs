//! What a panic said.

use core::any::Any;

/// The text that came with a panic, if it was text.
pub(crate) fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("no text came with it").to_owned()
}
