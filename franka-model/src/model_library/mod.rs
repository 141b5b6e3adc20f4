//! The FER's own model library: compiled code that a robot of FCI version 5 hands to its clients.
//!
//! [`Model::fer`](crate::Model::fer) meets that library to the last digits in everything that was
//! compared (the book's page on the model). This module is for comparisons on a particular robot,
//! and for programs that do not rely on that comparison. Needs the feature `model-library`, and
//! Linux.
//!
//! The code is loaded into this process. It runs with its rights, unchecked: hence
//! [`ModelLibrary::load`] is `unsafe`.

mod error;
mod symbols;

pub use error::LibraryError;

use libloading::{Error, Library};
use nalgebra::{Matrix4, Vector3};
use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::PathBuf;
use std::string::ToString;
use std::sync::atomic::{AtomicU64, Ordering};
use std::{env, fmt, format, process};

use crate::{EndEffector, Frame, Jacobian, JointVector, Load, MassMatrix};
use symbols::{Jacobians, Symbols};

/// A library that is loaded, and unloaded when this is dropped.
///
/// It answers the questions that [`Model`](crate::Model) answers, with the same arguments.
pub struct ModelLibrary {
    symbols: Symbols,
    /// The symbols point into it.
    _library: Library,
}

impl fmt::Debug for ModelLibrary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ModelLibrary").finish_non_exhaustive()
    }
}

impl ModelLibrary {
    /// Loads the bytes that the robot sent, by way of a temporary file that only this user can read
    /// and that is gone when this returns.
    ///
    /// # Errors
    /// [`LibraryError`].
    ///
    /// # Safety
    /// The bytes must be the vendor's model library, or another one whose initialisers and
    /// functions may be run, from any thread and at any time, and whose functions called `M_NE`,
    /// `c_NE`, `g_NE`, `O_T_J*`, `Ji_J_J*` and `O_J_J*` have the vendor's signatures. Loading
    /// what a robot sends trusts that robot, and every host that can pose as it on the network,
    /// with this process.
    pub unsafe fn load(bytes: &[u8]) -> Result<Self, LibraryError> {
        let file = Temporary::with(bytes).map_err(LibraryError::Save)?;
        // SAFETY: the caller vouches for the initialisers.
        let library = unsafe { Library::new(&file.path) }.map_err(|error| match error {
            Error::DlOpen { source } => LibraryError::Load {
                reason: source.to_string(),
            },
            other => LibraryError::Loader {
                reason: other.to_string(),
            },
        })?;
        // SAFETY: the caller vouches for the signatures.
        let symbols = unsafe { Symbols::of(&library) }?;
        Ok(Self {
            symbols,
            _library: library,
        })
    }

    /// Pose of `frame` in the base frame.
    pub fn pose(&self, frame: Frame, q: &JointVector, ee: &EndEffector) -> Matrix4<f64> {
        let mut pose = Matrix4::zeros();
        let out = pose.as_mut_slice().as_mut_ptr();
        // SAFETY: `load` was told the signatures; 7 and 16 numbers go in, 16 come out, and the
        // library is loaded as long as `self` is there.
        unsafe {
            match on_flange(frame, ee) {
                Some(f_t_frame) => {
                    (self.symbols.pose_ee)(q.as_ptr(), f_t_frame.as_slice().as_ptr(), out);
                }
                None => (self.symbols.poses[frame as usize])(q.as_ptr(), out),
            }
        }
        pose
    }

    /// See [`Model::zero_jacobian`](crate::Model::zero_jacobian).
    pub fn zero_jacobian(&self, frame: Frame, q: &JointVector, ee: &EndEffector) -> Jacobian {
        jacobian(&self.symbols.zero_jacobians, frame, q, ee)
    }

    /// See [`Model::body_jacobian`](crate::Model::body_jacobian).
    pub fn body_jacobian(&self, frame: Frame, q: &JointVector, ee: &EndEffector) -> Jacobian {
        jacobian(&self.symbols.body_jacobians, frame, q, ee)
    }

    /// Joint-space inertia, without rotors, `[kg·m²]`.
    pub fn mass(&self, q: &JointVector, load: &Load) -> MassMatrix {
        let mut mass = MassMatrix::zeros();
        // SAFETY: as in `pose`; 7, 9 and 3 numbers go in, 49 come out.
        unsafe {
            (self.symbols.mass)(
                q.as_ptr(),
                load.inertia.as_slice().as_ptr(),
                load.mass,
                load.com.as_ptr(),
                mass.as_mut_slice().as_mut_ptr(),
            );
        }
        mass
    }

    /// Torques of Coriolis and centrifugal forces, `C(q, dq) dq`, `[N·m]`.
    pub fn coriolis(&self, q: &JointVector, dq: &JointVector, load: &Load) -> JointVector {
        let mut torques = JointVector::zeros();
        // SAFETY: as in `pose`; 7, 7, 9 and 3 numbers go in, 7 come out.
        unsafe {
            (self.symbols.coriolis)(
                q.as_ptr(),
                dq.as_ptr(),
                load.inertia.as_slice().as_ptr(),
                load.mass,
                load.com.as_ptr(),
                torques.as_mut_slice().as_mut_ptr(),
            );
        }
        torques
    }

    /// Torques that hold the arm still against gravity, `[N·m]`.
    pub fn gravity(
        &self,
        q: &JointVector,
        load: &Load,
        gravity_earth: &Vector3<f64>,
    ) -> JointVector {
        let mut torques = JointVector::zeros();
        // SAFETY: as in `pose`; 7, 3 and 3 numbers go in, 7 come out.
        unsafe {
            (self.symbols.gravity)(
                q.as_ptr(),
                gravity_earth.as_ptr(),
                load.mass,
                load.com.as_ptr(),
                torques.as_mut_slice().as_mut_ptr(),
            );
        }
        torques
    }
}

fn jacobian(symbols: &Jacobians, frame: Frame, q: &JointVector, ee: &EndEffector) -> Jacobian {
    let mut jacobian = Jacobian::zeros();
    let out = jacobian.as_mut_slice().as_mut_ptr();
    // SAFETY: as in `ModelLibrary::pose`; at most 7 and 16 numbers go in, 42 come out.
    unsafe {
        match (on_flange(frame, ee), frame) {
            (Some(f_t_frame), _) => {
                (symbols.ee)(q.as_ptr(), f_t_frame.as_slice().as_ptr(), out);
            }
            (None, Frame::Joint1) => (symbols.first)(out),
            (None, frame) => (symbols.others[frame as usize - 1])(q.as_ptr(), out),
        }
    }
    jacobian
}

/// Where a frame is on the flange, for those that the user places.
fn on_flange(frame: Frame, ee: &EndEffector) -> Option<Matrix4<f64>> {
    match frame {
        Frame::EndEffector => Some(ee.f_t_ee),
        Frame::Stiffness => Some(ee.f_t_ee * ee.ee_t_k),
        _ => None,
    }
}

/// A file that is removed when this is dropped.
struct Temporary {
    path: PathBuf,
}

impl Temporary {
    /// Writes a new file: a file that exists already is left alone, and another name is tried.
    fn with(bytes: &[u8]) -> io::Result<Self> {
        loop {
            let number = COUNT.fetch_add(1, Ordering::Relaxed);
            let name = format!("franka-model-{}-{number}.so", process::id());
            let path = env::temp_dir().join(name);
            let mut options = OpenOptions::new();
            options.write(true).create_new(true).mode(0o600);
            match options.open(&path) {
                Ok(mut file) => {
                    let temporary = Self { path };
                    file.write_all(bytes)?;
                    return Ok(temporary);
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }
}

/// Files made by this process.
static COUNT: AtomicU64 = AtomicU64::new(0);

impl Drop for Temporary {
    fn drop(&mut self) {
        // One that has gone by itself is gone.
        let _ = fs::remove_file(&self.path);
    }
}

/// Handles go anywhere: the functions are of their arguments alone.
const _: () = {
    const fn shared<T: Send + Sync + 'static>() {}
    shared::<ModelLibrary>();
};

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn a_temporary_file_is_for_this_user_only_and_gone_when_it_is_dropped() {
        let first = Temporary::with(b"one").expect("a file");
        let second = Temporary::with(b"two").expect("a file");
        assert_ne!(first.path, second.path);
        assert_eq!(fs::read(&first.path).expect("a file"), b"one");
        let metadata = fs::metadata(&first.path).expect("a file");
        assert_eq!(metadata.permissions().mode() & 0o777, 0o600);
        let paths = [first.path.clone(), second.path.clone()];
        drop((first, second));
        assert!(paths.iter().all(|path| !path.exists()));
    }
}
