//! Square and cube root: from the standard library with `std` and from `libm` without.
//!
//! Only these two elementary functions are used; `core` has neither of them.

#[cfg(feature = "std")]
pub(crate) fn sqrt(x: f64) -> f64 {
    x.sqrt()
}

#[cfg(feature = "std")]
pub(crate) fn cbrt(x: f64) -> f64 {
    x.cbrt()
}

#[cfg(not(feature = "std"))]
pub(crate) use libm::{cbrt, sqrt};
