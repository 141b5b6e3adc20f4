//! The last cycles of a motion.

use std::sync::Arc;

use franka_async::connection::Version;
use franka_async::record;
use pyo3::prelude::*;

use crate::state::RobotState;

/// The last cycles of a motion, oldest first: what the robot said, and what it had been sent.
#[pyclass(frozen, sequence, module = "franka_async")]
pub(crate) struct ControlLog {
    log: Arc<record::ControlLog>,
    version: Version,
}

impl ControlLog {
    pub(crate) fn new(log: Arc<record::ControlLog>, version: Version) -> Self {
        Self { log, version }
    }
}

#[pymethods]
impl ControlLog {
    /// The states, oldest first.
    fn states(&self) -> Vec<RobotState> {
        let entries = self.log.iter();
        entries
            .map(|entry| RobotState::new(entry.state, self.version))
            .collect()
    }

    /// Comma-separated values, a line for each cycle; columns are named as by libfranka.
    fn to_csv(&self) -> String {
        self.log.to_csv()
    }

    fn __len__(&self) -> usize {
        self.log.len()
    }

    fn __repr__(&self) -> String {
        format!("<ControlLog of {} cycles>", self.log.len())
    }
}
