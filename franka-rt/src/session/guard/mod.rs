//! Guards: what holds a command back, one file each.

mod binding;
pub(super) mod force_cap;
pub(super) mod leash;

pub use binding::{Bindings, Guard};
