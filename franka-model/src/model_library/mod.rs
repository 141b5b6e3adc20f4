//! The FER's own model library: compiled code that a robot of FCI version 5 sends to its clients.
//!
//! [`Model::fer`](crate::Model::fer) matches that library to the last digits in all comparisons
//! (see the book's page on the model). Use this module to compare both on a particular robot, or if
//! a program must not rely on earlier comparisons. The module requires Linux and the feature
//! `model-library`.
//!
//! The code is loaded into this process, and runs unchecked with the rights of the process.
//! Therefore [`ModelLibrary::load`] is `unsafe`.

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

/// A loaded model library. Dropping it unloads the library.
///
/// It has some of the functions of [`Model`](crate::Model), with the same arguments.
pub struct ModelLibrary {
    symbols: Symbols,
    /// The symbols point into this library.
    _library: Library,
}

impl fmt::Debug for ModelLibrary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ModelLibrary").finish_non_exhaustive()
    }
}

impl ModelLibrary {
    /// Loads the library from the bytes that the robot sent, through a temporary file. Only the
    /// current user can read the file, and it is deleted before this function returns.
    ///
    /// # Errors
    /// Returns [`LibraryError`] if the library cannot be stored, loaded or used.
    ///
    /// # Safety
    /// The bytes must be the vendor's model library, or a library that meets these conditions. The
    /// library's initialisers and functions must be safe to run from any thread at any time. Its
    /// functions named `M_NE`, `c_NE`, `g_NE`, `O_T_J*`, `Ji_J_J*` and `O_J_J*` must have the
    /// vendor's signatures. The caller trusts the robot, and every host that can impersonate the
    /// robot on the network.
    pub unsafe fn load(bytes: &[u8]) -> Result<Self, LibraryError> {
        let file = Temporary::with(bytes).map_err(LibraryError::Save)?;
        // SAFETY: the caller guarantees safe initialisers.
        let library = unsafe { Library::new(&file.path) }.map_err(|error| match error {
            Error::DlOpen { source } => LibraryError::Load {
                reason: source.to_string(),
            },
            other => LibraryError::Loader {
                reason: other.to_string(),
            },
        })?;
        // SAFETY: the caller guarantees the signatures.
        let symbols = unsafe { Symbols::of(&library) }?;
        Ok(Self {
            symbols,
            _library: library,
        })
    }

    /// Returns the pose of `frame` in the base frame.
    pub fn pose(&self, frame: Frame, q: &JointVector, ee: &EndEffector) -> Matrix4<f64> {
        let mut pose = Matrix4::zeros();
        let out = pose.as_mut_slice().as_mut_ptr();
        // SAFETY: the caller of `load` guarantees the signatures. The function reads and writes
        // arrays of these lengths, and the library stays loaded as long as `self` exists.
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

    /// Returns the Jacobian in base axes; see
    /// [`Model::zero_jacobian`](crate::Model::zero_jacobian).
    pub fn zero_jacobian(&self, frame: Frame, q: &JointVector, ee: &EndEffector) -> Jacobian {
        jacobian(&self.symbols.zero_jacobians, frame, q, ee)
    }

    /// Returns the Jacobian in the frame's own axes; see
    /// [`Model::body_jacobian`](crate::Model::body_jacobian).
    pub fn body_jacobian(&self, frame: Frame, q: &JointVector, ee: &EndEffector) -> Jacobian {
        jacobian(&self.symbols.body_jacobians, frame, q, ee)
    }

    /// Returns the joint-space inertia, `[kg·m²]`. Rotor inertias are not included.
    pub fn mass(&self, q: &JointVector, load: &Load) -> MassMatrix {
        let mut mass = MassMatrix::zeros();
        // SAFETY: as in `pose`; 7, 9 and 3 numbers are read, 49 are written.
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

    /// Returns the torques of Coriolis and centrifugal forces, `C(q, dq) dq`, `[N·m]`.
    pub fn coriolis(&self, q: &JointVector, dq: &JointVector, load: &Load) -> JointVector {
        let mut torques = JointVector::zeros();
        // SAFETY: as in `pose`; 7, 7, 9 and 3 numbers are read, 7 are written.
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

    /// Returns the torques that hold the arm still against gravity, `[N·m]`.
    pub fn gravity(
        &self,
        q: &JointVector,
        load: &Load,
        gravity_earth: &Vector3<f64>,
    ) -> JointVector {
        let mut torques = JointVector::zeros();
        // SAFETY: as in `pose`; 7, 3 and 3 numbers are read, 7 are written.
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
    // SAFETY: as in `ModelLibrary::pose`; at most 7 and 16 numbers are read, 42 are written.
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

/// Returns the pose, in the flange frame, of a frame that the user defines, or `None` for other
/// frames.
fn on_flange(frame: Frame, ee: &EndEffector) -> Option<Matrix4<f64>> {
    match frame {
        Frame::EndEffector => Some(ee.f_t_ee),
        Frame::Stiffness => Some(ee.f_t_ee * ee.ee_t_k),
        _ => None,
    }
}

/// A file that is removed when this value is dropped.
struct Temporary {
    path: PathBuf,
}

impl Temporary {
    /// Writes a new file. If the name exists, the function tries another name and leaves the
    /// existing file unchanged.
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

/// Number of files created by this process.
static COUNT: AtomicU64 = AtomicU64::new(0);

impl Drop for Temporary {
    fn drop(&mut self) {
        // A missing file needs no removal.
        let _ = fs::remove_file(&self.path);
    }
}

/// Threads may send and share the library, because its functions depend only on their arguments.
const _: () = {
    const fn shared<T: Send + Sync + 'static>() {}
    shared::<ModelLibrary>();
};

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn temporary_file_is_private_and_removed_on_drop() {
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
