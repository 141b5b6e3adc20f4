//! Guards: what holds a command back, one file each.

mod binding;
pub(super) mod clearance;
pub(super) mod deviation;
pub(super) mod force_cap;
pub(super) mod lead;
pub(super) mod leash;
pub(super) mod velocity_barrier;

pub use binding::{Bindings, Guard};
