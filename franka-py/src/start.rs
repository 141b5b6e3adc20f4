//! Motions of several robots that begin together.

use std::sync::{Mutex, PoisonError};

use franka_async::motion::{StartBarrier, StartTicket as Ticket};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use crate::operation::seconds;

/// Tickets of a common start, a list of one for each of `members` motions. `left.move_to(a,
/// start_with=tickets[0])` and `right.move_to(b, start_with=tickets[1])`, awaited together, begin
/// within a millisecond of each other, once all robots are ready. Such a motion supersedes nothing.
/// If the other motions are not ready within `timeout` seconds, or a ticket is dropped before the
/// start, each motion raises `MotionError` of the kind `start`, and no arm has moved.
#[pyfunction]
#[pyo3(signature = (members, timeout = 10.0))]
pub(crate) fn start_tickets(members: usize, timeout: f64) -> PyResult<Vec<StartTicket>> {
    if !(1..=StartBarrier::MEMBERS_MAX).contains(&members) {
        let most = StartBarrier::MEMBERS_MAX;
        let text = format!("members is {members}, expected 1 to {most}");
        return Err(PyValueError::new_err(text));
    }
    let tickets = StartBarrier::new()
        .timeout(seconds("timeout", timeout)?)
        .tickets_for(members);
    let ticket = |ticket| StartTicket(Mutex::new(Some(ticket)));
    Ok(tickets.into_iter().map(ticket).collect())
}

/// The part of one motion in a common start: created by `start_tickets`. If it is dropped before
/// the start, the other motions fail.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct StartTicket(Mutex<Option<Ticket>>);

impl StartTicket {
    pub(crate) fn take(&self) -> PyResult<Ticket> {
        let ticket = self.0.lock().unwrap_or_else(PoisonError::into_inner).take();
        ticket.ok_or_else(|| {
            PyRuntimeError::new_err(
                "this ticket already belongs to a motion, expected a separate ticket for each \
                 motion",
            )
        })
    }
}
