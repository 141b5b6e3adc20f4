//! Elementary functions, from the platform's library if `std` is available, and from `libm`
//! otherwise.
//!
//! `core` has no such functions: the methods come from `std`, or from nalgebra's traits.

#[cfg(not(any(test, feature = "std")))]
use nalgebra::{ComplexField, RealField};

pub(crate) fn sin_cos(angle: f64) -> (f64, f64) {
    angle.sin_cos()
}

pub(crate) fn sqrt(x: f64) -> f64 {
    x.sqrt()
}

pub(crate) fn acos(x: f64) -> f64 {
    x.acos()
}

pub(crate) fn atan2(y: f64, x: f64) -> f64 {
    y.atan2(x)
}

pub(crate) fn ln(x: f64) -> f64 {
    x.ln()
}

pub(crate) fn exp(x: f64) -> f64 {
    x.exp()
}

pub(crate) fn tanh(x: f64) -> f64 {
    x.tanh()
}
