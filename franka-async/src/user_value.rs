//! Values of the user that tasks of the driver free.

use std::ops::{Deref, DerefMut};

use franka_rt::panic;

/// A function of the user, with everything that it has captured. The bridge or another task frees
/// it when its motion has ended or was refused.
///
/// If the function's destructor panics, the panic is logged and caught. Otherwise it would end the
/// task that frees the function, and with it the connection.
#[derive(Debug)]
pub(crate) struct UserValue<T> {
    /// The value; `None` only while it is being dropped.
    value: Option<T>,
    /// Name of the value, for the log.
    what: &'static str,
}

impl<T> UserValue<T> {
    pub(crate) fn new(what: &'static str, value: T) -> Self {
        let value = Some(value);
        Self { value, what }
    }
}

const PRESENT: &str = "the value is present until the drop";

impl<T> Deref for UserValue<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.value.as_ref().expect(PRESENT)
    }
}

impl<T> DerefMut for UserValue<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.value.as_mut().expect(PRESENT)
    }
}

impl<T> Drop for UserValue<T> {
    fn drop(&mut self) {
        if let Err(message) = panic::free(self.value.take()) {
            let what = self.what;
            tracing::warn!(panic = %message, "a value that {what} captured panicked in its drop");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_destructor_that_panics_harms_nobody() {
        struct Bad;
        impl Drop for Bad {
            fn drop(&mut self) {
                panic!("a bug of the user's");
            }
        }
        struct Worse;
        impl Drop for Worse {
            fn drop(&mut self) {
                std::panic::panic_any(Bad);
            }
        }
        drop(UserValue::new("a function", Bad));
        drop(UserValue::new("a function", Worse));
        let mut count = UserValue::new("a number", 7);
        *count += 1;
        assert_eq!(*count, 8);
    }
}
