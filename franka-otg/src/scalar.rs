//! Square and cube root: from the standard library if `std` is available, and from `libm`
//! otherwise.
//!
//! The crate uses only these two elementary functions, and `core` has neither.

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
