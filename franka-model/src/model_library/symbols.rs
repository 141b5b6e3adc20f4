//! The functions of the library, by their C names.

use libloading::{Error, Library};
use std::format;
use std::string::ToString;

use super::LibraryError;

/// A function without inputs; its result is the same at every posture.
pub(super) type OfNothing = unsafe extern "C" fn(*mut f64);
/// A function of `q`.
pub(super) type OfPosture = unsafe extern "C" fn(*const f64, *mut f64);
/// A function of `q` and `F_T_EE`.
pub(super) type OfFrame = unsafe extern "C" fn(*const f64, *const f64, *mut f64);
/// A function of `q`, `I_total`, `m_total` and `F_x_Ctotal`.
pub(super) type Mass = unsafe extern "C" fn(*const f64, *const f64, f64, *const f64, *mut f64);
/// A function of `q`, `dq`, `I_total`, `m_total` and `F_x_Ctotal`.
pub(super) type Coriolis =
    unsafe extern "C" fn(*const f64, *const f64, *const f64, f64, *const f64, *mut f64);
/// A function of `q`, the gravitational acceleration, `m_total` and `F_x_Ctotal`.
pub(super) type Gravity = unsafe extern "C" fn(*const f64, *const f64, f64, *const f64, *mut f64);

/// Addresses of functions in a library, valid while the library is loaded.
pub(super) struct Symbols {
    pub(super) mass: Mass,
    pub(super) coriolis: Coriolis,
    pub(super) gravity: Gravity,
    /// Poses of joints 1 to 7 and the flange.
    pub(super) poses: [OfPosture; 8],
    pub(super) pose_ee: OfFrame,
    pub(super) body_jacobians: Jacobians,
    pub(super) zero_jacobians: Jacobians,
}

pub(super) struct Jacobians {
    /// Jacobian of joint 1, whose axis does not move.
    pub(super) first: OfNothing,
    /// Jacobians of joints 2 to 7 and the flange.
    pub(super) others: [OfPosture; 7],
    pub(super) ee: OfFrame,
}

impl Symbols {
    /// # Safety
    /// Functions that the library has under these names must have these signatures.
    pub(super) unsafe fn of(library: &Library) -> Result<Self, LibraryError> {
        // SAFETY: the caller guarantees every name and signature below.
        unsafe {
            Ok(Self {
                mass: get(library, "M_NE")?,
                coriolis: get(library, "c_NE")?,
                gravity: get(library, "g_NE")?,
                poses: numbered(library, "O_T_J", 1)?,
                pose_ee: get(library, "O_T_J9")?,
                body_jacobians: Jacobians::of(library, "Ji_J_J")?,
                zero_jacobians: Jacobians::of(library, "O_J_J")?,
            })
        }
    }
}

impl Jacobians {
    /// # Safety
    /// The conditions of [`Symbols::of`].
    unsafe fn of(library: &Library, name: &str) -> Result<Self, LibraryError> {
        // SAFETY: the caller guarantees every name and signature below.
        unsafe {
            Ok(Self {
                first: get(library, &format!("{name}1"))?,
                others: numbered(library, name, 2)?,
                ee: get(library, &format!("{name}9"))?,
            })
        }
    }
}

/// Returns the functions named `name` and a number, counted from `first`.
///
/// # Safety
/// The conditions of [`Symbols::of`].
unsafe fn numbered<const N: usize>(
    library: &Library,
    name: &str,
    first: usize,
) -> Result<[OfPosture; N], LibraryError> {
    // Fills the array with one function; every place is then replaced. SAFETY: the caller
    // guarantees the signature.
    let mut found = [unsafe { get(library, &format!("{name}{first}"))? }; N];
    for (i, place) in found.iter_mut().enumerate() {
        // SAFETY: the caller guarantees the signature.
        *place = unsafe { get(library, &format!("{name}{}", first + i))? };
    }
    Ok(found)
}

/// # Safety
/// If the symbol exists, it must be a function with the pointer type `F`.
unsafe fn get<F: Copy>(library: &Library, name: &str) -> Result<F, LibraryError> {
    // SAFETY: the caller guarantees the type.
    let symbol = unsafe { library.get::<F>(name) };
    symbol.map(|symbol| *symbol).map_err(|error| match error {
        Error::DlSym { source } => LibraryError::Symbol {
            reason: source.to_string(),
        },
        other => LibraryError::Symbols {
            reason: other.to_string(),
        },
    })
}
