//! Motions under way.

use franka_async::motion::MotionHandle;
use pyo3::prelude::*;

use crate::operation::Operation;

/// A motion: it begins when it is awaited, and then arrives or raises what kept it from that. Cancelling
/// it brakes the arm.
#[pyclass(frozen, extends = Operation, module = "franka_async")]
pub(crate) struct Motion {
    handle: MotionHandle,
}

impl Motion {
    /// The awaitable of `motion`, called `name`.
    pub(crate) fn new(
        py: Python<'_>,
        name: &'static str,
        motion: franka_async::Motion,
    ) -> PyResult<Py<Self>> {
        let handle = motion.handle();
        let operation = Operation::new(name, async move { motion.await.map(|_| ()) });
        Py::new(
            py,
            PyClassInitializer::from(operation).add_subclass(Self { handle }),
        )
    }
}

#[pymethods]
impl Motion {
    /// Brakes the motion, from any thread; whoever awaits it gets `MotionError` of the kind `stopped`.
    fn cancel(&self) {
        self.handle.cancel();
    }
}
