//! Elementary functions, from the platform's library with `std` and from `libm` without.
//!
//! `core` has none of them; nalgebra's traits dispatch to whichever is there.

use nalgebra::{ComplexField, RealField};

pub(crate) fn sin_cos(angle: f64) -> (f64, f64) {
    ComplexField::sin_cos(angle)
}

pub(crate) fn sqrt(x: f64) -> f64 {
    ComplexField::sqrt(x)
}

pub(crate) fn acos(x: f64) -> f64 {
    ComplexField::acos(x)
}

pub(crate) fn atan2(y: f64, x: f64) -> f64 {
    RealField::atan2(y, x)
}

pub(crate) fn ln(x: f64) -> f64 {
    ComplexField::ln(x)
}

pub(crate) fn exp(x: f64) -> f64 {
    ComplexField::exp(x)
}

pub(crate) fn tanh(x: f64) -> f64 {
    ComplexField::tanh(x)
}
