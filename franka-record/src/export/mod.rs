//! Exports recordings as tables and datasets for other programs.
//!
//! * `cells`: the columns of a table. [`franka_rt::driver::Column`] defines their names, units and
//!   shapes.
//! * `new_file`: files that appear under their names once they are complete, and never replace
//!   another file.
//! * `csv`: text. `table`, `parquet`: Parquet files (feature `export`).
//! * [`lerobot`]: episodes for training (feature `export`).

mod cells;
mod csv;
mod error;
#[cfg(feature = "export")]
pub mod lerobot;
mod new_file;
#[cfg(feature = "export")]
mod parquet;
#[cfg(feature = "export")]
mod table;

pub use cells::{Columns, UnknownColumn};
pub use csv::write_csv;
pub use error::ExportError;
pub use new_file::NewFile;
#[cfg(feature = "export")]
pub use table::write_parquet;
