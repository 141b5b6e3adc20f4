//! Refusals of requests.

use core::time::Duration;

use franka_async::connection::lease::Taken;

use super::ROUND_TRIP_MAX;

/// Reason why a request has no effect. The text contains the received and the expected value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum Refusal {
    #[error("this server is view-only: it was started without permission to move the arm")]
    ViewOnly,
    #[error(transparent)]
    Taken(#[from] Taken),
    #[error("this page has no permission to command the arm: take the lease first")]
    NoLease,
    #[error("{0}")]
    Value(String),
    #[error(
        "the round trip to the page was not measured within the last second: wait a moment, \
        then press again"
    )]
    Unmeasured,
    #[error(
        "the round trip to the page takes {0:.0?}, expected {ROUND_TRIP_MAX:?} or less for \
        motions"
    )]
    Latency(Duration),
    #[error("another motion was running and was stopped: press again")]
    Holding,
    #[error("the motion has already ended: release the button, and press it again")]
    NoHold,
    #[error("only a simulated robot can be disturbed")]
    NoSimulator,
    #[error("this server has no gripper: it was started without one")]
    NoGripper,
    #[error("this server records nothing: it was started without a folder for recordings")]
    NoRecordings,
}
