//! Numbers on the wire.

use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

/// A little-endian `f32`, the number type of states in protocol 10.
pub type F32 = zerocopy::byteorder::little_endian::F32;

/// A little-endian `f64`, the number type of states in protocol 5, and of commands and requests in
/// both versions.
pub type F64 = zerocopy::byteorder::little_endian::F64;

/// A floating-point number on the wire. Its width depends on the version.
pub trait Real:
    Copy + FromBytes + IntoBytes + Immutable + KnownLayout + Unaligned + sealed::Sealed
{
    /// Returns the value as `f64`, without loss of precision.
    fn widen(self) -> f64;

    /// Returns the nearest value that the wire type can represent.
    fn narrow(value: f64) -> Self;

    /// Returns the sum, rounded to the wire's width.
    fn add(self, other: Self) -> Self;
}

impl Real for F32 {
    #[inline]
    fn widen(self) -> f64 {
        f64::from(self.get())
    }

    #[inline]
    fn narrow(value: f64) -> Self {
        Self::new(value as f32)
    }

    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.get() + other.get())
    }
}

impl Real for F64 {
    #[inline]
    fn widen(self) -> f64 {
        self.get()
    }

    #[inline]
    fn narrow(value: f64) -> Self {
        Self::new(value)
    }

    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.get() + other.get())
    }
}

/// Converts an array of wire numbers.
#[inline]
#[must_use]
pub fn from_wire<R: Real, const N: usize>(array: &[R; N]) -> [f64; N] {
    array.map(R::widen)
}

/// Converts numbers to an array of wire numbers.
#[inline]
#[must_use]
pub fn to_wire<R: Real, const N: usize>(array: &[f64; N]) -> [R; N] {
    array.map(R::narrow)
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::F32 {}
    impl Sealed for super::F64 {}
}
