//! Options of a connection to a robot.

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use franka_proto::Version;
use franka_rt::driver::ControlLog;
use franka_rt::identify::Identified;
use franka_rt::sched::{Realtime, Scheduling};
use franka_rt::supervision::{Policy, Reflex};
use tokio_util::sync::CancellationToken;

use crate::dial::TCP_TIMEOUT;
use crate::endpoint::Endpoint;
use crate::geometry_check::GeometryCheck;
use crate::robot::Robot;
use crate::user_value::UserValue;

/// The protocol versions that the driver accepts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum VersionPolicy {
    /// Announces the newest version. If the robot refuses it and names an older version that this
    /// driver knows, announces that version.
    #[default]
    Negotiate,
    /// Announces this version and no other.
    Exact(Version),
}

/// Options of a connection, made by [`Robot::builder`].
#[derive(Clone, Debug)]
#[must_use = "a builder does nothing until `connect` is awaited"]
pub struct Builder {
    pub(crate) endpoint: Endpoint,
    pub(crate) versions: VersionPolicy,
    pub(crate) scheduling: Scheduling,
    pub(crate) connect_timeout: Duration,
    pub(crate) link_timeout: Duration,
    pub(crate) nominal_model: bool,
    pub(crate) accept_geometry_error: bool,
    /// Result of the check at an earlier connection to the robot.
    pub(crate) geometry_before: Option<GeometryCheck>,
    pub(crate) log_size: usize,
    pub(crate) known: Option<Box<Identified>>,
    pub(crate) policy: Option<Policy>,
    pub(crate) ask: Option<Ask>,
    pub(crate) cancellation: CancellationToken,
}

/// A question to the program before a recovery.
#[derive(Clone)]
pub(crate) struct Ask(pub(crate) Arc<dyn Fn(&Reflex) -> bool + Send + Sync>);

impl fmt::Debug for Ask {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Ask")
    }
}

impl Robot {
    /// Returns the options of a connection to the robot at `endpoint`.
    pub fn builder(endpoint: impl Into<Endpoint>) -> Builder {
        Builder::new(endpoint.into())
    }
}

impl Builder {
    fn new(endpoint: Endpoint) -> Self {
        Self {
            endpoint,
            versions: VersionPolicy::default(),
            scheduling: Scheduling::default(),
            connect_timeout: TCP_TIMEOUT,
            link_timeout: franka_rt::driver::LINK_TIMEOUT,
            nominal_model: false,
            accept_geometry_error: false,
            geometry_before: None,
            log_size: ControlLog::DEFAULT_CAPACITY,
            known: None,
            policy: None,
            ask: None,
            cancellation: CancellationToken::new(),
        }
    }

    /// Sets the TCP port; 1337 by default, as on a robot.
    pub fn port(mut self, port: u16) -> Self {
        self.endpoint.set_port(port);
        self
    }

    /// Sets whether connecting fails if the control thread cannot run in real time. This needs a
    /// `PREEMPT_RT` kernel, and the right to use `SCHED_FIFO`. The default is
    /// [`Realtime::Enforce`]; use [`Realtime::Ignore`] for simulators.
    pub fn realtime(mut self, realtime: Realtime) -> Self {
        self.scheduling.realtime = realtime;
        self
    }

    /// Sets the `SCHED_FIFO` priority of the control thread, 1 to 99; by default, the highest
    /// priority of the system. If the system refuses the priority, this is an error under
    /// [`Realtime::Enforce`], and is ignored under [`Realtime::Ignore`].
    pub fn priority(mut self, priority: i32) -> Self {
        self.scheduling.priority = Some(priority);
        self
    }

    /// Sets the processor on which the control thread runs; by default, any processor.
    pub fn cpu(mut self, cpu: usize) -> Self {
        self.scheduling.cpu = Some(cpu);
        self
    }

    /// Sets whether the pages of the process are locked into memory; off by default.
    pub fn lock_memory(mut self, lock: bool) -> Self {
        self.scheduling.lock_memory = lock;
        self
    }

    /// Sets which protocol versions are accepted; by default, the version is negotiated.
    pub fn version(mut self, versions: VersionPolicy) -> Self {
        self.versions = versions;
        self
    }

    /// Sets the time limit for each step of connecting; 1 s by default. The steps are: finding the
    /// host, the TCP connection to each address, the handshake, the first state, the description,
    /// and the states whose poses are compared with the model.
    pub fn connect_timeout(mut self, timeout: Duration) -> Self {
        self.connect_timeout = timeout;
        self
    }

    /// Sets how many bytes of the control thread's stack are paged in before the first cycle: 512
    /// KiB by default, 64 MiB at most. The whole stack is larger, because a reserve is added.
    /// Control functions that use much stack need a larger value. A size out of range is refused as
    /// [`ConnectError::Realtime`](crate::error::ConnectError::Realtime).
    pub fn prefault_stack(mut self, bytes: usize) -> Self {
        self.scheduling.prefault_stack = bytes;
        self
    }

    /// Makes the control thread poll the network card for `duration` before each wait for a state
    /// (`SO_BUSY_POLL`). The range is 1 to 900 us, in whole microseconds; by default, the thread
    /// does not poll. The kernel requires `CAP_NET_ADMIN`. A refusal by the kernel is an error
    /// under [`Realtime::Enforce`], and is ignored under [`Realtime::Ignore`]; [`Robot::granted`]
    /// reports the refusal.
    pub fn busy_poll(mut self, duration: Duration) -> Self {
        self.scheduling.busy_poll = Some(duration);
        self
    }

    /// Sets how long the robot may be silent before a running motion fails as `LinkLost`: 20 ms to
    /// 10 s, by default 1 s. Use longer timeouts only for a simulated robot on a busy host, whose
    /// states may come that late. Other values are refused as
    /// [`ConnectError::LinkTimeout`](crate::error::ConnectError::LinkTimeout). Detection may take
    /// up to a quarter longer than the timeout. If no state shows a requested motion within 5 s,
    /// the motion fails regardless of this timeout.
    pub fn link_timeout(mut self, timeout: Duration) -> Self {
        self.link_timeout = timeout;
        self
    }

    /// Sets whether the driver always computes with the vendor's published constants; off by
    /// default. By default, the driver asks a Franka Research 3 for its description, and stays
    /// within the limits in it. Use the constants for a robot whose description this driver
    /// refuses, once you know that they fit its arm. A Franka Emika Robot sends no description.
    pub fn nominal_model(mut self, nominal: bool) -> Self {
        self.nominal_model = nominal;
        self
    }

    /// Sets whether to connect to a robot whose reported poses disagree with its model with all
    /// known [link lengths](crate::model::geometry::Lengths::KNOWN). This is off by default: such a
    /// robot is refused as [`ConnectError::Geometry`](crate::error::ConnectError::Geometry). If the
    /// robot is accepted, goals move the arm to poses as the robot reports them; in simulation, the
    /// errors were up to 1 mm and 3 mrad. Inverse kinematics, clearances and previews are wrong by
    /// the geometric error. [`Robot::geometry_check`] returns this error, and a warning (`tracing`)
    /// states it.
    pub fn accept_geometry_error(mut self, accept: bool) -> Self {
        self.accept_geometry_error = accept;
        self
    }

    /// Sets how many of the last cycles an error contains when the robot ends a motion: see
    /// [`ControlError::log`](crate::error::ControlError::log). The default is 50. The maximum is
    /// 10000, which covers ten seconds. A number above the maximum is refused as
    /// [`ConnectError::LogSize`](crate::error::ConnectError::LogSize). With 0, the text of the
    /// error contains no success rate. [`Robot::records`](crate::Robot::records) yields the cycles
    /// of whole motions.
    pub fn log_size(mut self, cycles: usize) -> Self {
        self.log_size = cycles;
        self
    }

    /// Sets an earlier result of [`Robot::identify`] for this arm, so that the driver compensates
    /// for friction and bias from the first motion on. A part of the identified load that is
    /// declared when that motion begins is not counted again. By default, nothing is known. A
    /// result of a different kind of arm, or with implausible numbers, is refused as
    /// [`ConnectError::Known`](crate::error::ConnectError::Known).
    pub fn known(mut self, found: Identified) -> Self {
        self.known = Some(Box::new(found));
        self
    }

    /// Supervises the robot: reconnects after the connection was lost, and recovers the robot from
    /// reflexes as the policy states. Handles stay valid across connections. [`Robot::events`] and
    /// [`Robot::health`] report reconnects and recoveries. Earlier motions do not resume. If
    /// [`connect`](Self::connect) fails, the driver does not try again.
    ///
    /// After each reconnect, once the robot is idle, the driver sends the settings of this program
    /// again (load, frames, thresholds, impedance, guiding mode, filters). It compares them with
    /// the robot's states, if the states show them. Motions wait until this is done. If the robot
    /// does not accept a setting, motions are refused as
    /// [`Unready::NotConfigured`](crate::error::Unready::NotConfigured) until it does; see
    /// [`EventKind::NotConfigured`](crate::supervision::EventKind::NotConfigured).
    pub fn supervise(mut self, policy: Policy) -> Self {
        self.policy = Some(policy);
        self
    }

    /// Calls `agrees` before each recovery that the policy allows, to ask for permission. The
    /// argument contains the reflex. If the reflex ended a motion of this program, it also contains
    /// the log and the [diagnosis](crate::diagnosis::Diagnose). Implies
    /// [`Policy::ask_first`](crate::supervision::Policy::ask_first). The function runs on a thread
    /// for blocking work ([`spawn_blocking`](tokio::task::spawn_blocking)). Only the recovery waits
    /// for the answer; dropping the runtime also waits for it. An answer that comes too late has no
    /// effect: see [`Robot::agree`]. A panic of the function counts as a refusal. Without
    /// [`Self::supervise`], connecting fails as
    /// [`ConnectError::Unsupervised`](crate::error::ConnectError::Unsupervised).
    pub fn ask_before_recovery(
        mut self,
        agrees: impl Fn(&Reflex) -> bool + Send + Sync + 'static,
    ) -> Self {
        let agrees = UserValue::new("the function that agrees to recoveries", agrees);
        self.ask = Some(Ask(Arc::new(move |reflex| (*agrees)(reflex))));
        self
    }

    /// Ends the connection when `token` is cancelled, as [`Robot::shutdown`] does. Use it if one
    /// token ends all tasks of the program. To know when the connection has ended, also await
    /// `shutdown`. The token does not cancel `connect` itself; to do so, drop its future.
    pub fn cancellation(mut self, token: CancellationToken) -> Self {
        self.cancellation = token;
        self
    }
}
