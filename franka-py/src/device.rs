//! End effectors: each has its own connection and one Python object.

use std::sync::{Mutex, MutexGuard, PoisonError};

use franka_async::connection::Endpoint;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::errors::misuse;
use crate::runtime::{self, Threaded};

/// An end effector at an address, with its connection if there is one.
pub(crate) struct Device<D> {
    name: &'static str,
    endpoint: Endpoint,
    connection: Threaded<Mutex<Option<D>>>,
}

impl<D: Clone> Device<D> {
    pub(crate) fn new(name: &'static str, endpoint: Endpoint) -> Self {
        Self {
            name,
            endpoint,
            connection: Threaded::new(Mutex::new(None)),
        }
    }

    pub(crate) fn endpoint(&self) -> &Endpoint {
        &self.endpoint
    }

    /// Returns the connected device.
    ///
    /// # Errors
    /// `FrankaError` of the kind `not_connected`; `RuntimeError` in a forked child.
    pub(crate) fn connected(&self) -> PyResult<D> {
        runtime::runtime()?;
        self.open().ok_or_else(|| {
            let text = format!(
                "not connected to the {} at {}: call connect() before, or use 'async with' ('with' in sync)",
                self.name, self.endpoint
            );
            Python::attach(|py| misuse(py, "not_connected", &text))
        })
    }

    pub(crate) fn open(&self) -> Option<D> {
        self.connection().clone()
    }

    pub(crate) fn set(&self, connected: Option<D>) {
        // The previous one is dropped without the lock.
        let before = std::mem::replace(&mut *self.connection(), connected);
        drop(before);
    }

    pub(crate) fn repr(&self) -> String {
        let state = match &*self.connection() {
            Some(_) => "",
            None => ", not connected",
        };
        format!("<{} at {}{state}>", self.name, self.endpoint)
    }

    fn connection(&self) -> MutexGuard<'_, Option<D>> {
        // No code panics while the lock is held.
        self.connection
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }
}

/// The common methods of end effectors, for the class `$class` with the driver's `$device`.
macro_rules! device_methods {
    ($class:ty, $device:ty, $connect:literal) => {
        #[pymethods]
        impl $class {
            /// Connects, and returns this object; without effect while it is connected. Raises
            /// `ConnectError`. Cancelling aborts the connection.
            fn connect(this: &Bound<'_, Self>) -> Operation {
                let this = this.clone().unbind();
                Operation::new($connect, async move {
                    let device = &this.get().0;
                    if device.open().is_none() {
                        let endpoint = device.endpoint().clone();
                        device.set(Some(<$device>::connect(endpoint).await?));
                    }
                    Ok::<_, franka_async::Error>(this)
                })
            }

            /// Closes the connection, without waiting. A running action is stopped. Without effect
            /// if there is no connection.
            fn disconnect(&self) {
                self.0.set(None);
            }

            /// True if there is a connection. A lost connection counts until `disconnect()`.
            #[getter]
            fn is_connected(&self) -> bool {
                self.0.open().is_some()
            }

            /// Address: as given, and resolved once it is connected.
            #[getter]
            fn address(&self) -> String {
                match self.0.open() {
                    Some(device) => device.address().to_string(),
                    None => self.0.endpoint().to_string(),
                }
            }

            fn __aenter__(this: &Bound<'_, Self>) -> Operation {
                Self::connect(this)
            }

            #[pyo3(signature = (*_exception))]
            fn __aexit__(&self, _exception: &Bound<'_, PyAny>) -> Operation {
                self.disconnect();
                Operation::infallible("disconnect", async {})
            }

            fn __repr__(&self) -> String {
                self.0.repr()
            }
        }
    };
}

pub(crate) use device_methods;

/// Returns the address of a device, `what`, which the simulator only has with the option `option`.
///
/// # Errors
/// `TypeError` if the address is missing.
pub(crate) fn given<'a>(address: Option<&'a str>, what: &str, option: &str) -> PyResult<&'a str> {
    address.ok_or_else(|| {
        PyTypeError::new_err(format!(
            "address is None, expected host or host:port: only a simulator with {option}=True has \
             a {what}"
        ))
    })
}

/// Checks the argument `name`, which has a unit.
///
/// # Errors
/// `ValueError` unless it is finite and not negative.
pub(crate) fn at_least_zero(name: &str, got: f64) -> PyResult<f64> {
    if got.is_finite() && got >= 0.0 {
        return Ok(got);
    }
    let text = format!("{name} is {got}, expected a finite number of 0 or more");
    Err(PyValueError::new_err(text))
}
