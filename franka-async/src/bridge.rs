//! The bridge: one task between the async world, the command channel and the real-time thread.
//!
//! It drives the lifecycle of motions and is the only one that touches the thread's queues and
//! slots. Waking other tasks takes locks; that is why it happens here and never on the thread.

use std::collections::HashMap;
use std::io;
use std::sync::Arc;
use std::time::Duration;

use franka_proto::{RobotMode, RobotState};
use franka_rt::driver::{Driver, Event, Order};
use franka_rt::event_fd::EventFd;
use franka_rt::law::Gains;
use franka_rt::lifecycle::{CloseReason, Lifecycle, MotionError, NewMotion, Outcome, Output};
use franka_rt::queue::{Receiver, Sender};
use franka_rt::session::{Chunk, ForceCap, GoalId, Margin, Target};
use franka_rt::supervision::Seen;
use franka_rt::thread::{Handle, Notice, Thread};
use tokio::io::Interest;
use tokio::io::unix::AsyncFd;
use tokio::sync::{mpsc, oneshot, watch};
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;
use tracing::{Instrument, Span};

use crate::command_channel::{Channel, Connection, Report};
use crate::destination::Now;
use crate::input::{Beginning, BridgeHandle, EndReply, Input, Replies};
use crate::progress::Course;
use crate::publish::Publisher;
use crate::robot::{pose_at, pose_of};
use crate::supervisor::Supervisor;
use crate::telemetry::{self, Telemetry};
use crate::thresholds::Thresholds;

/// Time that a motion gets to brake and finish when the last handle is dropped.
const CLOSING_TIMEOUT: Duration = Duration::from_secs(15);

/// Time that an arm on its way to a goal gets to come to rest when the connection is lost, before
/// the thread that brakes it ends.
const BRAKING_TIMEOUT: Duration = Duration::from_secs(3);

/// Registers the eventfd of the thread with this runtime.
///
/// # Errors
/// If the runtime's poll does not take the descriptor.
pub(crate) fn attach(wake: EventFd) -> io::Result<AsyncFd<EventFd>> {
    // SAFETY: an `EventFd` owns its eventfd through an `Arc` that nothing replaces: the descriptor
    // is open, and the same, for as long as the `EventFd` lives, and the `AsyncFd` owns the
    // `EventFd`.
    let attached = unsafe { AsyncFd::register_with_interest(wake, Interest::READABLE) };
    attached.map_err(Into::into)
}

/// Waits until the thread has written to its eventfd, and drains it.
///
/// # Cancel safety
/// A wake-up is not lost: the next call returns at once.
pub(crate) async fn woken(wake: &AsyncFd<EventFd>) -> io::Result<()> {
    let mut guard = wake.readable().await?;
    wake.get_ref().drain();
    guard.clear_ready();
    Ok(())
}

pub(crate) struct Bridge {
    lifecycle: Lifecycle,
    wake: AsyncFd<EventFd>,
    orders: Sender<Order>,
    notices: Receiver<Notice<Event>>,
    publisher: Publisher,
    telemetry: Telemetry,
    course: Course,
    thresholds: Thresholds,
    thread: Option<Thread<Driver>>,
    channel: Channel,
    connection: Option<Connection>,
    replies: HashMap<GoalId, (Replies, Span)>,
    started: Instant,
    /// Whether robot or thread is out of reach, for good.
    lost: bool,
    /// Whether the thread that runs active control reads no states.
    stalled: bool,
    supervisor: Arc<Supervisor>,
    /// What the supervisor was last shown.
    seen: Option<Seen>,
    /// `message_id` of the newest state when a silence was noticed, until one comes.
    silent_since: Option<u64>,
}

/// A bridge that is not yet running, with what it will receive.
pub(crate) struct Prepared {
    bridge: Bridge,
    inbox: mpsc::UnboundedReceiver<Input>,
    reports: mpsc::UnboundedReceiver<Report>,
}

impl Prepared {
    /// Runs the bridge as a task until all ways into it are gone, the connection is lost, or it is
    /// told to end: by an input, or by `cancellation`.
    pub(crate) fn start(self, cancellation: CancellationToken) {
        let Self {
            bridge,
            inbox,
            reports,
        } = self;
        tokio::spawn(bridge.run(inbox, reports, cancellation).in_current_span());
    }
}

impl Bridge {
    /// Returns a bridge that publishes to `states` and reports to `supervisor`.
    pub(crate) fn new(
        lifecycle: Lifecycle,
        handle: Handle,
        wake: AsyncFd<EventFd>,
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
            telemetry: Telemetry::new(handle.stats),
            course,
            thresholds,
            thread: Some(handle.thread),
            channel,
            connection: Some(connection),
            replies: HashMap::new(),
            started: Instant::now(),
            lost: false,
            stalled: false,
            supervisor,
            seen: None,
            silent_since: None,
        }
    }

    /// Returns the way into the bridge, which takes nothing before it is started.
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
        let mut closing = None;
        let mut done = Vec::new();
        loop {
            self.carry_out();
            if self.lost || closing.is_some() && self.lifecycle.is_idle() {
                break;
            }
            let deadline = [
                self.lifecycle.deadline().map(|after| self.started + after),
                closing,
            ];
            let deadline = deadline.into_iter().flatten().min();
            tokio::select! {
                woken = woken(&self.wake) => {
                    if let Err(error) = woken {
                        let text = format!("its eventfd cannot be read: {error}");
                        self.lose(CloseReason::ThreadEnded { text });
                    }
                    self.on_wakeup();
                }
                () = cancellation.cancelled(), if closing.is_none() => {
                    closing = Some(self.begin_closing());
                }
                input = inbox.recv(), if closing.is_none() => match input {
                    Some(Input::Shutdown { ended: reply }) => {
                        done.push(reply);
                        closing = Some(self.begin_closing());
                    }
                    Some(input) => self.on_input(input),
                    None => closing = Some(self.begin_closing()),
                },
                Some(report) = reports.recv() => self.on_report(report),
                () = sleep_until(deadline) => {
                    if closing.is_some_and(|closing| closing <= Instant::now()) {
                        tracing::error!("the motion did not end; closing all the same");
                        break;
                    }
                    self.lifecycle.on_time(self.now());
                }
            }
        }
        self.end(inbox, &mut done).await;
        for done in done {
            // Fails if the caller was dropped.
            let _ = done.send(());
        }
    }

    fn now(&self) -> Duration {
        self.started.elapsed()
    }

    /// Carries out what the lifecycle has decided, in its order.
    fn carry_out(&mut self) {
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
                    let replies = self.replies.get_mut(&id);
                    if let Some(began) = replies.and_then(|(replies, _)| replies.began.take()) {
                        // The future that began it may have been dropped.
                        let _ = began.send(());
                    }
                }
                Output::Resolve { goal, result } => {
                    self.supervisor.on_ended(goal, &result);
                    match self.replies.remove(&goal) {
                        Some((replies, span)) => {
                            span.in_scope(|| log(goal, &result));
                            replies.ended.send(result);
                        }
                        None => log(goal, &result),
                    }
                }
            }
        }
    }

    /// Takes everything that the thread has published.
    fn on_wakeup(&mut self) {
        self.publisher.publish();
        // Before a motion resolves: what comes next finds a robot that is in a reflex.
        self.observe();
        self.telemetry.watch(Instant::now());
        self.take_notices();
        self.look_for_a_stall();
        if self.thread_has_ended() {
            let text = "it has ended".into();
            self.lose(CloseReason::ThreadEnded { text });
        }
    }

    /// Passes the thread's events on to the lifecycle.
    fn take_notices(&mut self) {
        while let Some(notice) = self.notices.pop() {
            match notice {
                Notice::Core(event) => {
                    match &event {
                        Event::Ended(ended) => telemetry::sum_up(ended),
                        Event::Unobserved { motion } => {
                            tracing::error!(
                                motion = motion.0,
                                "the observer panicked and is not called again"
                            );
                        }
                        Event::LinkLost { silence } => {
                            self.publisher.tell_silence(*silence);
                            self.silent_since = Some(self.publisher.state().message_id);
                            self.supervisor.on_silence(*silence);
                        }
                        _ => {}
                    }
                    let now = self.now();
                    self.lifecycle.on_event(event, now);
                }
                Notice::Link(fault) => tracing::warn!(%fault, "control link"),
            }
        }
    }

    /// Takes note that the thread that runs active control reads no states, or that it does again.
    fn look_for_a_stall(&mut self) {
        let stalled = self.thread.as_ref().and_then(Thread::stalled);
        if stalled.is_some() != self.stalled {
            self.stalled = stalled.is_some();
            if let Some(silence) = stalled {
                tracing::error!(?silence, "active control does not read states");
                self.publisher.tell_silence(silence);
            }
            self.lifecycle.on_stall(stalled, self.now());
        }
    }

    fn thread_has_ended(&self) -> bool {
        self.thread.as_ref().is_none_or(Thread::has_ended)
    }

    /// Waits until an arm that is being braked rests, for [`BRAKING_TIMEOUT`] at most.
    async fn rest(&mut self) {
        let deadline = Instant::now() + BRAKING_TIMEOUT;
        while self.lifecycle.is_braking() && !self.thread_has_ended() {
            match tokio::time::timeout_at(deadline, woken(&self.wake)).await {
                Ok(Ok(())) => self.on_wakeup(),
                Ok(Err(_)) | Err(_) => {
                    tracing::warn!("the arm was not seen to rest; the control thread ends");
                    break;
                }
            }
        }
    }

    /// Takes note that robot or thread is out of reach. Everything else ends with it, after an arm
    /// on its way to a goal has been braked: a thread without a connection would go on towards a
    /// goal that can no longer be taken back.
    fn lose(&mut self, reason: CloseReason) {
        let reason = self.channel.closing().note(reason);
        // Before the motions resolve: what comes next finds a connection that is lost.
        self.supervisor.on_lost(reason.clone());
        self.lifecycle.on_connection_closed(reason);
        self.lost = true;
    }

    fn refuse(&self, goal: GoalId, replies: Replies, error: MotionError) {
        let refused = Err(error);
        log(goal, &refused);
        self.supervisor.on_ended(goal, &refused);
        replies.ended.send(refused);
    }

    /// Shows the supervisor the newest state, if it shows anything new of the robot as a whole.
    fn observe(&mut self) {
        let (newest, mode, seen) = {
            let state = self.publisher.state();
            (state.message_id, state.robot_mode, Some(Seen::of(&state)))
        };
        let resumed = self.silent_since.is_some_and(|since| newest > since);
        if resumed || self.seen != seen {
            (self.seen, self.silent_since) = (seen, None);
            // Recovery is over soon: motions wait for it.
            self.publisher
                .watch(mode == RobotMode::AutomaticErrorRecovery);
            self.supervisor.observe();
        }
    }

    /// Says so if an arm may oscillate under these gains.
    fn warn_of_margin(&self, goal: GoalId, gains: Option<Gains>, state: &RobotState) {
        let margin = gains.and_then(|gains| self.lifecycle.margin(&gains, state));
        if let Some(Margin { damping, stiffness }) = margin.filter(|margin| !margin.is_wanted()) {
            tracing::warn!(
                goal = goal.0,
                damping,
                stiffness,
                wanted = Margin::WANTED,
                "gains are near an oscillation: dampers and springs may grow by these factors"
            );
        }
    }

    /// Says so if the robot stops itself at less than what the arm may be pushed with.
    fn warn_of_thresholds(&self, goal: GoalId, force_cap: Option<ForceCap>) {
        if let Some((least, most)) = force_cap.and_then(|cap| self.thresholds.within(cap)) {
            tracing::warn!(
                goal = goal.0,
                threshold_newtons = least,
                push_newtons = most,
                "the robot stops itself by a reflex before the arm gives way to a push"
            );
        }
    }

    fn on_input(&mut self, input: Input) {
        let now = self.now();
        // If no wake-up per state is requested, the state that was published last is old.
        self.publisher.refresh();
        self.observe();
        // The caller may react to an event that is in the queue and not yet read by this task: the
        // queue is read before the input is handled.
        self.look_for_a_stall();
        self.take_notices();
        match input {
            Input::Begin { motion, replies } => {
                let id = motion.motion.id();
                let compliant = motion.motion.compliant_goal();
                let gains = compliant.map(|goal| goal.gains);
                let force_cap = compliant.map(|goal| goal.force_cap);
                match self.begin(motion) {
                    Ok(()) => {
                        self.warn_of_margin(id, gains, &self.publisher.state());
                        self.warn_of_thresholds(id, force_cap);
                        let span = tracing::info_span!("motion", goal = id.0);
                        self.replies.insert(id, (replies, span));
                    }
                    Err(error) => self.refuse(id, replies, error),
                }
            }
            Input::Update {
                goal,
                target,
                taken,
            } => {
                let updated = self.lifecycle.update(goal, target, &self.publisher.state());
                self.course.head_for(self.lifecycle.heading());
                let _ = taken.send(updated);
            }
            Input::Set { motion, taken } => {
                let begun = self.begin(motion);
                self.course.head_for(self.lifecycle.heading());
                let _ = taken.send(begun);
            }
            Input::SetNewest { waiting } => {
                let Some(motion) = waiting.take() else {
                    return;
                };
                let id = motion.motion.id();
                if let Err(error) = self.begin(motion) {
                    log(id, &Err(error));
                }
            }
            Input::Chunk {
                id,
                goal,
                chunk,
                taken,
            } => {
                let state = &self.publisher.state();
                let sent = self.lifecycle.chunk(id, *goal, *chunk, state);
                self.course.head_for(self.lifecycle.heading());
                let _ = taken.send(sent);
            }
            Input::Tune { id, tuning, taken } => {
                let state = &self.publisher.state();
                let tuned = self.lifecycle.tune(id, *tuning, state);
                if tuned.is_ok() {
                    self.warn_of_margin(id, tuning.gains, state);
                }
                let _ = taken.send(tuned);
            }
            Input::Disengage { id } => self.lifecycle.disengage(id),
            Input::Close { goal } => self.lifecycle.close(goal),
            Input::Pause { goal, paused } => self.lifecycle.pause(goal, paused),
            Input::Cancel { goal } => self.lifecycle.cancel(goal, now),
            Input::Stop { goal, ended } => {
                if self.lifecycle.stop(goal, now) {
                    let ended = EndReply::One(ended);
                    let span = tracing::info_span!("stop", goal = goal.0);
                    self.replies
                        .insert(goal, (Replies { began: None, ended }, span));
                }
                // Otherwise nothing moves, and dropping `ended` says so.
            }
            Input::Lose { reason } => self.lose(reason),
            Input::Shutdown { .. } => unreachable!("taken where the loop decides to close"),
        }
    }

    /// Completes a motion by where the robot is, and begins it.
    fn begin(&mut self, beginning: Beginning) -> Result<(), MotionError> {
        let (now, state) = (self.now(), &self.publisher.state());
        let Beginning {
            mut motion,
            destination,
            path,
        } = beginning;
        let NewMotion::Goal { goal, .. } = &mut motion else {
            return self.lifecycle.begin(motion, state, now);
        };
        if let Some(destination) = destination {
            goal.target = destination.seen_from(&self.poses(state));
        }
        let Some(path) = path else {
            return self.lifecycle.begin(motion, state, now);
        };
        let reference = self.course.reference();
        let q = reference.map_or(state.q, |reference| reference.q);
        let path = Chunk::through(&path, &q, &goal.budget, self.lifecycle.model(), state)?;
        self.lifecycle.begin_along(path, motion, state, now)
    }

    /// The poses that a destination may be relative to.
    fn poses(&self, state: &RobotState) -> Now {
        let pose_at = |q| pose_at(self.lifecycle.model(), state, q);
        let arm = pose_of(state).unwrap_or_else(|| pose_at(state.q));
        // What is held or followed has no pose of its own.
        let reference = || self.course.reference().map(|newest| pose_at(newest.q));
        let target = match self.lifecycle.heading() {
            Some((_, Target::Pose(pose))) => pose,
            Some((_, Target::Joints(q))) => pose_at(q),
            Some(_) => reference().unwrap_or(arm),
            None => arm,
        };
        Now { target, arm }
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

    /// Brakes what moves. Returns when to give up on it.
    fn begin_closing(&mut self) -> Instant {
        // An id that no handle uses: handles count up from 1.
        self.lifecycle.stop(GoalId(u64::MAX), self.now());
        Instant::now() + CLOSING_TIMEOUT
    }

    /// Resolves what is pending, brakes an arm that moves, closes the connection and ends the
    /// thread. Requests to shut down that come meanwhile are added to `done`.
    async fn end(
        mut self,
        mut inbox: mpsc::UnboundedReceiver<Input>,
        done: &mut Vec<oneshot::Sender<()>>,
    ) {
        let reason = self.channel.closing().note(CloseReason::ClosedByUs);
        inbox.close();
        self.supervisor.on_lost(reason.clone());
        self.lifecycle.on_connection_closed(reason.clone());
        self.carry_out();
        while let Some(input) = inbox.recv().await {
            match input {
                Input::Shutdown { ended: reply } => done.push(reply),
                Input::Begin { motion, replies } => {
                    let reason = reason.clone();
                    self.refuse(
                        motion.motion.id(),
                        replies,
                        MotionError::ConnectionClosed { reason },
                    );
                }
                // Who waits for another answer sees the end by its channel being closed.
                _ => {}
            }
        }
        self.rest().await;
        if let Some(connection) = self.connection.take() {
            connection.close().await;
        }
        if let Some(thread) = self.thread.take() {
            match tokio::task::spawn_blocking(move || thread.join()).await {
                Ok(Ok(_)) => {}
                Ok(Err(panicked)) => tracing::error!(%panicked, "control thread"),
                Err(error) => tracing::error!(%error, "control thread"),
            }
        }
    }
}

/// Also when the runtime drops the task.
impl Drop for Bridge {
    fn drop(&mut self) {
        self.supervisor.on_lost(self.channel.closing().reason());
        self.supervisor.on_released();
    }
}

/// Notes how something ended, which may have been detached.
fn log(goal: GoalId, outcome: &Outcome) {
    match outcome {
        Ok(report) => tracing::info!(goal = goal.0, duration = ?report.duration, "motion ended"),
        Err(error) => tracing::info!(goal = goal.0, %error, "motion ended"),
    }
}

async fn sleep_until(deadline: Option<Instant>) {
    match deadline {
        Some(deadline) => tokio::time::sleep_until(deadline).await,
        None => std::future::pending().await,
    }
}
