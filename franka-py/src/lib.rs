//! The native part of the Python package `franka_async`: the driver's futures as awaitables, its
//! values as numpy arrays.
//!
//! ```text
//!  Python thread ── call ──> Operation ── first step ──> task on the Tokio runtime ──> franka-async
//!     await / wait() <── result, exception, made under the interpreter's lock <──┘
//! ```
//!
//! No thread that a motion waits for takes the interpreter's lock: tasks run on the runtime, and
//! results become Python objects when they are awaited.

mod active;
mod arm;
mod arrays;
mod asynchronous_control;
mod batch;
mod chunk;
mod condition;
mod control;
mod deadman;
mod destination;
mod device;
mod disturbance;
mod engagement;
mod errors;
mod exit;
mod explanation;
mod follow;
mod gains;
mod goals;
mod gripper;
mod identify;
mod law;
mod log;
mod logging;
mod model;
mod motion;
mod names;
mod once_moving;
mod operation;
mod options;
mod otg;
mod pose;
mod record;
mod recorder;
mod recording;
mod replay;
mod robot;
mod runtime;
mod settings;
mod simulator;
mod simulator_options;
mod start;
mod state;
mod state_views;
mod states;
mod stats;
mod stream;
mod supervision;
mod tare;
mod team;
mod told;
mod vacuum_gripper;
mod virtual_robots;

use pyo3::prelude::*;
use pyo3::types::PyTuple;

#[pymodule(gil_used = true)]
mod _native {
    use super::*;

    #[pymodule_export]
    use crate::active::ActiveControl;
    #[pymodule_export]
    use crate::arm::Arm;
    #[pymodule_export]
    use crate::arrays::_row;
    #[pymodule_export]
    use crate::asynchronous_control::AsynchronousControl;
    #[pymodule_export]
    use crate::condition::{
        Condition, Quantity, Then, cartesian_contact, collision, contact, elapsed, force, force_x,
        force_y, force_z, joint_contact, joint_position, joint_torque, joint_torques,
        joint_velocity, torque,
    };
    #[pymodule_export]
    use crate::deadman::Deadman;
    #[pymodule_export]
    use crate::disturbance::Touch;
    #[pymodule_export]
    use crate::engagement::Engagement;
    #[pymodule_export]
    use crate::explanation::{Explanation, explain};
    #[pymodule_export]
    use crate::follow::Latest;
    #[pymodule_export]
    use crate::gains::{_gains, _softened};
    #[pymodule_export]
    use crate::gripper::{Gripper, GripperState};
    #[pymodule_export]
    use crate::identify::{IdentificationPlan, PyIdentified};
    #[pymodule_export]
    use crate::law::{_law_layout, Law};
    #[pymodule_export]
    use crate::log::{_log_of_json, ControlLog};
    #[pymodule_export]
    use crate::logging::enable_logging;
    #[pymodule_export]
    use crate::model::{CartesianLimits, Clearance, Dynamics, JointLimits, Model, MotionLimits};
    #[pymodule_export]
    use crate::motion::{Follow, Motion, MotionHandle};
    #[pymodule_export]
    use crate::names::_names;
    #[pymodule_export]
    use crate::operation::{_complete, Operation};
    #[pymodule_export]
    use crate::otg::{AxisLimits, Trajectory, plan_trajectory};
    #[pymodule_export]
    use crate::pose::{from_xyzw, rotated, to_xyzw};
    #[pymodule_export]
    use crate::record::{Recording, record_columns};
    #[pymodule_export]
    use crate::recorder::{EpisodeUnderWay, Recorder};
    #[pymodule_export]
    use crate::recording::{Cycles, RecordedCycle, RecordingFile, recording_columns};
    #[pymodule_export]
    use crate::robot::Robot;
    #[pymodule_export]
    use crate::simulator::Sim;
    #[pymodule_export]
    use crate::start::{StartTicket, start_tickets};
    #[pymodule_export]
    use crate::state::{_state_of_json, RobotState};
    #[pymodule_export]
    use crate::stats::_metrics;
    #[pymodule_export]
    use crate::stream::Source;
    #[pymodule_export]
    use crate::supervision::_check_policy;
    #[pymodule_export]
    use crate::tare::PyWrenchTare;
    #[pymodule_export]
    use crate::team::{Team, TeamGrasp};
    #[pymodule_export]
    use crate::vacuum_gripper::{VacuumGripper, VacuumGripperState};
    #[pymodule_export]
    use crate::virtual_robots::VirtualRobots;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::condition::add_quantities(module)?;
        crate::gains::add_defaults(module)?;
        crate::log::add_fields(module.py())?;
        crate::exit::register(module.py())?;
        let all = franka_async::state::Errors::from_flags(&[1; 41]);
        let ready = <[f64; 7]>::from(franka_async::READY);
        module.add("READY", PyTuple::new(module.py(), ready)?)?;
        module.add("ERROR_NAMES", crate::state::names(all))?;
        module.add("FLAT_LAYOUT", crate::state_views::FLAT_LAYOUT)?;
        let thresholds = crate::settings::COLLISION_THRESHOLDS;
        module.add("COLLISION_THRESHOLDS", thresholds)?;
        module.add("_METRICS_CONTENT_TYPE", franka_async::metrics::CONTENT_TYPE)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
