//! The task of a supervised robot: it reconnects, recovers the robot, and asks for permission.
//! `franka_rt::supervision::policy` decides when.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use franka_model::Model;
use franka_proto::{RecoveryStatus, RobotState, Status};
use franka_rt::lifecycle::CloseReason;
use franka_rt::supervision::{ConnectFailure, RecoveryFailure, Reflex};
use futures::FutureExt;
use futures::future::{BoxFuture, OptionFuture};
use tokio::sync::{mpsc, oneshot, watch};
use tokio_util::sync::CancellationToken;
use tracing::Instrument;

use crate::builder::{Builder, VersionPolicy};
use crate::error::{CommandError, ConnectError};
use crate::input::Input;
use crate::open::{Opened, open};
use crate::parameters;
use crate::robot::{Robot, WeakRobot};
use crate::supervisor::{Job, Supervisor};
use crate::world;

/// Resources for reconnecting a supervised robot.
pub(crate) struct Reconnector {
    robot: WeakRobot,
    supervisor: Arc<Supervisor>,
    builder: Builder,
    /// This stays the same from connection to connection, and ends with the task.
    states: Arc<watch::Sender<RobotState>>,
    connecting: OptionFuture<BoxFuture<'static, Result<Opened, ConnectError>>>,
    recovering: OptionFuture<BoxFuture<'static, (u64, Result<(), CommandError>)>>,
    configuring: OptionFuture<BoxFuture<'static, ()>>,
    /// True if this program closes the connection.
    is_closing: bool,
}

impl Reconnector {
    pub(crate) fn new(
        robot: &Robot,
        mut builder: Builder,
        states: Arc<watch::Sender<RobotState>>,
    ) -> Self {
        builder.versions = VersionPolicy::Exact(robot.version());
        builder.geometry_before = Some(robot.geometry_check());
        Self {
            robot: robot.downgrade(),
            supervisor: robot.supervisor().clone(),
            builder,
            states,
            connecting: None.into(),
            recovering: None.into(),
            configuring: None.into(),
            is_closing: false,
        }
    }

    /// Runs until there is no connection and will be no other one. `handles` is cancelled when the
    /// last handle is dropped. `shutdowns` receives the senders that are notified of the end.
    pub(crate) async fn run(
        mut self,
        mut shutdowns: mpsc::UnboundedReceiver<oneshot::Sender<()>>,
        handles: CancellationToken,
    ) {
        let cancellation = self.builder.cancellation.clone();
        let mut done = Vec::new();
        loop {
            while let Some(job) = self.supervisor.take_job() {
                self.start(job);
            }
            if self.is_closing {
                self.give_up();
            }
            if self.supervisor.is_closed() {
                break;
            }
            let deadline = self.supervisor.deadline();
            let deadline = OptionFuture::from(deadline.map(world::sleep_until));
            tokio::select! {
                () = self.supervisor.worked() => {}
                Some(()) = deadline => self.supervisor.on_time(),
                Some(opened) = &mut self.connecting => {
                    self.connecting = None.into();
                    self.on_opened(opened);
                }
                Some((reflex, answer)) = &mut self.recovering => {
                    self.recovering = None.into();
                    self.on_answer(reflex, answer);
                }
                Some(()) = &mut self.configuring => self.configuring = None.into(),
                Some(ended) = shutdowns.recv() => {
                    done.push(ended);
                    self.close();
                }
                // The bridge sees both signals, too.
                () = cancellation.cancelled(), if !self.is_closing => self.is_closing = true,
                () = handles.cancelled(), if !self.is_closing => self.is_closing = true,
            }
        }
        shutdowns.close();
        while let Some(ended) = shutdowns.recv().await {
            done.push(ended);
        }
        // Drop everything that ends with this task before the waiting callers are notified.
        drop(self);
        for ended in done {
            // This fails if the caller was dropped.
            let _ = ended.send(());
        }
    }

    fn start(&mut self, job: Job) {
        match job {
            Job::Connect => self.connect(),
            Job::Disconnect { reason } => {
                if let Some(robot) = self.robot.upgrade() {
                    robot.link().send(Input::Lose { reason });
                }
            }
            Job::Recover { reflex } => self.recover(reflex),
            Job::Configure => self.configure(),
            Job::Ask(reflex) => self.ask(reflex),
        }
    }

    /// Sends all settings of this program again.
    fn configure(&mut self) {
        if let Some(robot) = self.robot.upgrade() {
            let setting = parameters::Again::at(&robot).run();
            self.configuring = Some(setting.boxed()).into();
        }
    }

    fn connect(&mut self) {
        // Drop the task of the previous connection.
        self.configuring = None.into();
        let span = tracing::info_span!("reconnect");
        let (builder, states) = (self.builder.clone(), self.states.clone());
        let supervisor = self.supervisor.clone();
        let opening = async move {
            let opened = open(&builder, &states, &supervisor).await;
            if let Err(error) = &opened {
                tracing::warn!(%error, "connection attempt failed");
            }
            opened
        };
        self.connecting = Some(opening.instrument(span).boxed()).into();
    }

    fn on_opened(&mut self, opened: Result<Opened, ConnectError>) {
        let opened = match opened {
            Ok(opened) => opened,
            Err(error) => return self.supervisor.on_connect_failed(failure(&error)),
        };
        // Without handles, no program needs the connection, and dropping it closes it.
        let Some(robot) = self.robot.upgrade() else {
            return;
        };
        if *opened.model != *robot.model() {
            let text = difference(robot.model(), &opened.model);
            tracing::error!(%text, "another robot answers");
            let failure = ConnectFailure::AnotherRobot { text };
            return self.supervisor.on_connect_failed(failure);
        }
        let (link, first) = (Arc::new(opened.link), opened.first);
        // Replace the state even by a lower number, because a restarted robot counts from the
        // beginning.
        self.states.send_replace(first);
        robot.set_link(link.clone());
        if self
            .supervisor
            .on_connected(&link, &first, &link.granted.refusals)
        {
            let health = robot.health().newest();
            tracing::info!(address = %link.address, after = ?health.last_reconnect, "connected again");
            opened.bridge.start(self.builder.cancellation.clone());
        }
    }

    fn recover(&mut self, reflex: u64) {
        let Some(channel) = self.robot.upgrade().map(|robot| robot.channel()) else {
            return;
        };
        let span = tracing::info_span!("recovery", reflex);
        let recovering = async move {
            let answer = parameters::recover(&channel).await;
            match &answer {
                Ok(()) => tracing::info!("recovered"),
                Err(error) => tracing::warn!(%error, "recovery failed"),
            }
            (reflex, answer)
        };
        self.recovering = Some(recovering.instrument(span).boxed()).into();
    }

    fn on_answer(&mut self, reflex: u64, answer: Result<(), CommandError>) {
        let by_hand = Status::Recovery(RecoveryStatus::ManualErrorRecoveryRequiredRejected);
        let answer = answer.map_err(|error| match error {
            CommandError::Refused(refusal) if refusal.status() == by_hand => {
                RecoveryFailure::ByHand
            }
            _ => RecoveryFailure::Other,
        });
        self.supervisor.on_recovery(reflex, answer);
    }

    /// Asks the program's function for permission, which may take its time. Without a function, the
    /// answer comes by [`Robot::agree`].
    fn ask(&mut self, reflex: Reflex) {
        let Some(ask) = self.builder.ask.clone() else {
            return;
        };
        let supervisor = self.supervisor.clone();
        // An answer that comes too late has no effect.
        world::spawn_blocking(move || {
            let agreed = catch_unwind(AssertUnwindSafe(|| (ask.0)(&reflex)));
            let agreed = agreed.unwrap_or_else(|_| {
                tracing::error!(
                    "the function of ask_before_recovery panicked; the recovery is declined"
                );
                false
            });
            supervisor.agree(reflex.number, agreed);
        });
    }

    /// Closes this program's connection, if there is one.
    fn close(&mut self) {
        self.is_closing = true;
        if let Some(robot) = self.robot.upgrade() {
            let (ended, _) = oneshot::channel();
            // The supervisor receives a report of the bridge's end.
            robot.link().send(Input::Shutdown { ended });
        }
    }

    /// Ends the attempts to connect.
    fn give_up(&mut self) {
        if !self.supervisor.is_connected() {
            self.connecting = None.into();
            self.supervisor.close(CloseReason::ClosedByUs);
        }
    }
}

/// This also runs when the runtime drops the task.
impl Drop for Reconnector {
    fn drop(&mut self) {
        self.supervisor.close(CloseReason::RuntimeEnded);
    }
}

fn failure(error: &ConnectError) -> ConnectFailure {
    let text = error.to_string();
    match error {
        ConnectError::IncompatibleVersion(_) => ConnectFailure::AnotherRobot { text },
        _ => ConnectFailure::Other { text },
    }
}

/// Describes the differences between two models, for people.
fn difference(expected: &Model, got: &Model) -> String {
    if expected.kind() != got.kind() {
        return format!("got {:?}, expected {:?}", got.kind(), expected.kind());
    }
    if expected.lengths() != got.lengths() {
        return "the link lengths in its description or its poses differ from before".into();
    }
    let what = match expected.joint_limits() == got.joint_limits() {
        true => "masses",
        false => "limits",
    };
    format!("the {what} in its description differ from before")
}
