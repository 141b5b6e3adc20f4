//! The deadman token of an arm.

use std::sync::{Mutex, PoisonError};

use franka_async::error::GoalError;
use franka_async::goal::{Deadman as Token, DeadmanMonitor};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::operation::seconds;

/// A token that the program must keep alive with `keep_alive()`. If no call comes for `silence`
/// seconds (0.01 or more), or the token is released or dropped, the arm that `Robot.engage` bound
/// to it brakes and is held. Every goal then raises `held`, as does the next call of `chunk`. The
/// control thread monitors the token, independent of Python.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Deadman {
    token: Mutex<Option<Token>>,
    monitor: Mutex<Option<DeadmanMonitor>>,
    silence: f64,
}

impl Deadman {
    /// Returns the other end of the token, for one session.
    pub(crate) fn bind(&self) -> PyResult<DeadmanMonitor> {
        let monitor = self
            .monitor
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        monitor.ok_or_else(|| {
            PyValueError::new_err("deadman is or was bound to a session, expected a new Deadman")
        })
    }
}

#[pymethods]
impl Deadman {
    #[new]
    fn new(silence: f64) -> PyResult<Self> {
        let got = seconds("silence", silence)?;
        if got < Token::SILENCE_MIN {
            return Err(PyValueError::new_err(
                GoalError::Silence { got }.to_string(),
            ));
        }
        let (token, monitor) = Token::new(got);
        Ok(Self {
            token: Mutex::new(Some(token)),
            monitor: Mutex::new(Some(monitor)),
            silence,
        })
    }

    /// Longest allowed silence, s.
    #[getter]
    fn silence(&self) -> f64 {
        self.silence
    }

    /// Restarts the time of silence. Any thread may call this. After `release()`, it has no effect.
    fn keep_alive(&self) {
        let token = self.token.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(token) = &*token {
            token.keep_alive();
        }
    }

    /// Releases the token: the arm brakes, and is held from then on.
    fn release(&self) {
        self.token
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
    }

    fn __repr__(&self) -> String {
        format!("Deadman({})", self.silence)
    }
}
