//! The native part of the Python package `franka_async`: the driver's futures as awaitables, its
//! values as numpy arrays.
//!
//! ```text
//!  Python thread ── call ──> Operation ── first step ──> task on the Tokio runtime ──> franka-async
//!     await / wait() <── result, exception, made under the interpreter's lock <──┘
//! ```
//!
//! No thread that a motion waits for takes the interpreter's lock: tasks run on the runtime, and
//! results become Python objects where they are awaited.

mod arrays;
mod batch;
mod destination;
mod errors;
mod exit;
mod log;
mod model;
mod motion;
mod operation;
mod otg;
mod robot;
mod runtime;
mod simulator;
mod state;
mod state_views;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    use super::*;

    #[pymodule_export]
    use crate::log::ControlLog;
    #[pymodule_export]
    use crate::model::{CartesianLimits, Clearance, Dynamics, JointLimits, Model, MotionLimits};
    #[pymodule_export]
    use crate::motion::Motion;
    #[pymodule_export]
    use crate::operation::Operation;
    #[pymodule_export]
    use crate::otg::{AxisLimits, Trajectory, plan_trajectory};
    #[pymodule_export]
    use crate::robot::Robot;
    #[pymodule_export]
    use crate::simulator::Sim;
    #[pymodule_export]
    use crate::state::{_state_of_json, RobotState};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::exit::register(module.py())?;
        module.add("FLAT_LAYOUT", crate::state_views::FLAT_LAYOUT)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
