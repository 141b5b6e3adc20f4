//! The bridge: one task between the async world, the command channel and the real-time thread.
//!
//! The bridge drives the lifecycle of motions, and is the only user of the thread's queues and
//! slots. Waking other tasks takes locks, so the bridge does this, never the thread.

mod closing;
mod inputs;
mod planning;
mod wakeups;
mod warnings;

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Duration;

use franka_proto::RobotState;
use franka_rt::driver::{Driver, Event, Order};
use franka_rt::lifecycle::{CloseReason, Lifecycle, MotionError, Outcome, Output};
use franka_rt::queue::{Receiver, Sender};
use franka_rt::session::{GoalError, GoalId};
use franka_rt::stats::Stats;
use franka_rt::supervision::Seen;
use franka_rt::thread::{Handle, Notice, Thread};
use tokio::sync::{mpsc, watch};
use tokio_util::sync::CancellationToken;
use tracing::{Instrument, Span};

use crate::command_channel::{Channel, Connection, Report};
use crate::input::{BridgeHandle, Input, Replies};
use crate::progress::Course;
use crate::publish::Publisher;
use crate::supervisor::Supervisor;
use crate::telemetry::Telemetry;
use crate::thresholds::Thresholds;
use crate::world::{self, Instant, Wake};

use planning::{Planning, planned};

pub(crate) struct Bridge {
    lifecycle: Lifecycle,
    wake: Wake,
    orders: Sender<Order>,
    notices: Receiver<Notice<Event>>,
    publisher: Publisher,
    telemetry: Telemetry,
    stats: Arc<Stats>,
    course: Course,
    thresholds: Thresholds,
    thread: Option<Thread<Driver>>,
    channel: Channel,
    connection: Option<Connection>,
    callers: HashMap<GoalId, Caller>,
    started: Instant,
    phase: BridgePhase,
    /// True if the thread that runs active control does not read states.
    stalled: bool,
    supervisor: Arc<Supervisor>,
    /// The motions whose paths are being planned, the newest one last.
    planning: Vec<Planning>,
    /// The state that the supervisor saw last.
    seen: Option<Seen>,
    /// `message_id` of the newest state when a silence was noticed; `None` once a newer state
    /// comes.
    silent_since: Option<u64>,
    awaited: Option<Awaited>,
}

/// Phases of the bridge on the way to its end.
#[derive(Clone, Copy)]
enum BridgePhase {
    /// The bridge accepts inputs.
    Serving,
    /// The bridge accepts no inputs, and ends when nothing moves any more, or at `until`.
    Closing { until: Instant },
    /// The robot or the thread is out of reach for good, so the bridge ends now.
    Lost,
}

/// A caller that awaits the end of a goal or a program.
struct Caller {
    replies: Replies,
    span: Span,
    /// The reason why a target was refused, if the goal is cancelled for that reason.
    refused: Option<GoalError>,
}

/// A deadline of the lifecycle that is being awaited.
struct Awaited {
    deadline: Duration,
    /// `message_id` of the newest state; no newer state has come since the time `since`.
    newest: u64,
    since: Duration,
    /// Number of turns of the control thread when the deadline was set.
    turns: u64,
}

/// A bridge that is not yet running, with its receivers.
pub(crate) struct Prepared {
    bridge: Bridge,
    inbox: mpsc::UnboundedReceiver<Input>,
    reports: mpsc::UnboundedReceiver<Report>,
}

impl Prepared {
    /// Runs the bridge as a task. The task ends when all senders to it are gone, when the
    /// connection is lost, or on request (an input or `cancellation`).
    pub(crate) fn start(self, cancellation: CancellationToken) {
        let Self {
            bridge,
            inbox,
            reports,
        } = self;
        world::spawn(bridge.run(inbox, reports, cancellation).in_current_span());
    }
}

impl Bridge {
    /// Returns a bridge that publishes to `states` and reports to `supervisor`.
    pub(crate) fn new(
        lifecycle: Lifecycle,
        handle: Handle,
        wake: Wake,
        (channel, connection): (Channel, Connection),
        states: Arc<watch::Sender<RobotState>>,
        (course, thresholds): (Course, Thresholds),
        supervisor: Arc<Supervisor>,
    ) -> Self {
        Self {
            lifecycle,
            wake,
            orders: handle.orders,
            notices: handle.notices,
            publisher: Publisher::new(
                handle.states,
                handle.sequence,
                handle.records,
                handle.state_wakeups,
                states,
            ),
            telemetry: Telemetry::new(handle.stats.clone()),
            stats: handle.stats,
            course,
            thresholds,
            thread: Some(handle.thread),
            channel,
            connection: Some(connection),
            callers: HashMap::new(),
            started: world::now(),
            phase: BridgePhase::Serving,
            stalled: false,
            supervisor,
            planning: Vec::new(),
            seen: None,
            silent_since: None,
            awaited: None,
        }
    }

    /// Returns a sender to the bridge, whose inputs wait until the bridge is started.
    pub(crate) fn prepare(
        self,
        reports: mpsc::UnboundedReceiver<Report>,
    ) -> (BridgeHandle, Prepared) {
        let (sender, inbox) = mpsc::unbounded_channel();
        let handle = BridgeHandle {
            inbox: sender,
            subscriptions: self.publisher.subscriptions(),
        };
        let prepared = Prepared {
            bridge: self,
            inbox,
            reports,
        };
        (handle, prepared)
    }

    async fn run(
        mut self,
        mut inbox: mpsc::UnboundedReceiver<Input>,
        mut reports: mpsc::UnboundedReceiver<Report>,
        cancellation: CancellationToken,
    ) {
        let mut done = Vec::new();
        loop {
            self.carry_out();
            let closing = match self.phase {
                BridgePhase::Serving => None,
                BridgePhase::Closing { .. } if self.lifecycle.is_idle() => break,
                BridgePhase::Closing { until } => Some(until),
                BridgePhase::Lost => break,
            };
            self.note_deadline();
            let deadline = [
                self.awaited.as_ref().map(|it| self.started + it.deadline),
                closing,
            ];
            let deadline = deadline.into_iter().flatten().min();
            tokio::select! {
                woken = self.wake.woken() => {
                    if let Err(error) = woken {
                        let text = format!("its eventfd cannot be read: {error}");
                        self.lose(CloseReason::ThreadEnded { text });
                    }
                    self.on_wakeup();
                }
                () = cancellation.cancelled(), if closing.is_none() => self.begin_closing(),
                input = inbox.recv(), if closing.is_none() => match input {
                    Some(Input::Shutdown { ended: reply }) => {
                        done.push(reply);
                        self.begin_closing();
                    }
                    Some(input) => self.on_input(input),
                    None => self.begin_closing(),
                },
                Some(report) = reports.recv() => self.on_report(report),
                // Earlier inputs come first: one of them may cancel the path.
                () = planned(&mut self.planning) => if inbox.is_empty() {
                    self.catch_up();
                    self.on_planned();
                },
                () = sleep_until(deadline) => {
                    if closing.is_some_and(|closing| closing <= world::now()) {
                        tracing::error!("the motion did not end in time; closing the connection \
                            anyway");
                        break;
                    }
                    self.publisher.refresh();
                    self.lifecycle.on_time(self.now(), self.unseen());
                }
            }
        }
        self.end(inbox, &mut done).await;
        for done in done {
            // This fails if the caller was dropped.
            let _ = done.send(());
        }
    }

    fn now(&self) -> Duration {
        world::now() - self.started
    }

    /// Notes since when a deadline has been awaited.
    fn note_deadline(&mut self) {
        let deadline = self.lifecycle.deadline();
        if deadline == self.awaited.as_ref().map(|it| it.deadline) {
            return;
        }
        self.publisher.refresh();
        let newest = self.publisher.state().message_id;
        let before = self.awaited.as_ref();
        let since = before.filter(|it| it.newest == newest).map(|it| it.since);
        self.awaited = deadline.map(|deadline| Awaited {
            deadline,
            newest,
            since: since.unwrap_or_else(|| self.now()),
            turns: self.stats.turns.get(),
        });
    }

    /// If no state has come since then, returns the reason why no state could show the awaited
    /// change.
    fn unseen(&self) -> Option<MotionError> {
        let awaited = self.awaited.as_ref()?;
        if self.publisher.state().message_id != awaited.newest {
            return None;
        }
        let silence = self.now().saturating_sub(awaited.since);
        Lifecycle::unseen(silence, self.stats.turns.get() != awaited.turns)
    }

    fn carry_out(&mut self) {
        let now = self.now();
        self.lifecycle.on_state(&self.publisher.state(), now);
        self.course.head_for(self.lifecycle.heading());
        while let Some(output) = self.lifecycle.poll() {
            match output {
                Output::Order(order) => {
                    if self.orders.push(order).is_err() {
                        let text = "its queue of orders is full".into();
                        self.lose(CloseReason::ThreadEnded { text });
                    }
                }
                Output::Send { motion, request } => self.channel.send(motion, request),
                Output::Began { id } => {
                    let caller = self.callers.get_mut(&id);
                    if let Some(began) = caller.and_then(|caller| caller.replies.began.take()) {
                        // The future that began the program may have been dropped.
                        let _ = began.send(());
                    }
                }
                Output::Resolve { goal, mut result } => {
                    let caller = self.callers.remove(&goal);
                    let refused = caller.as_ref().and_then(|caller| caller.refused);
                    if let (Ok(_) | Err(MotionError::Stopped), Some(error)) = (&result, refused) {
                        result = Err(error.into());
                    }
                    if let Err(MotionError::Hung { silence }) = &result {
                        // No state is read until the control thread continues.
                        self.publisher.tell_silence(*silence);
                    }
                    self.supervisor.on_ended(goal, &result);
                    match caller {
                        Some(Caller { replies, span, .. }) => {
                            span.in_scope(|| log(goal, &result));
                            replies.ended.send(result);
                        }
                        None => log(goal, &result),
                    }
                }
            }
        }
    }

    fn on_report(&mut self, report: Report) {
        let now = self.now();
        self.publisher.refresh();
        self.observe();
        match report {
            Report::Move { motion, status } => self.lifecycle.on_move_reply(motion, status, now),
            Report::MoveViolation { motion, violation } => {
                self.lifecycle.on_move_violation(motion, violation, now);
            }
            Report::Closed { reason } => self.lose(reason),
        }
    }
}

/// Logs the end of a goal or program, which may have been detached.
fn log(goal: GoalId, outcome: &Outcome) {
    match outcome {
        Ok(_) if goal == closing::CLOSING => tracing::info!("the arm rests; releasing it"),
        Ok(report) => tracing::info!(goal = goal.0, duration = ?report.duration, "motion ended"),
        Err(error) => tracing::info!(goal = goal.0, %error, "motion ended"),
    }
}

async fn sleep_until(deadline: Option<Instant>) {
    match deadline {
        Some(deadline) => world::sleep_until(deadline).await,
        None => std::future::pending().await,
    }
}
