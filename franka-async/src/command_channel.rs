//! The command channel: one task that owns the TCP connection, sends requests and routes the
//! replies.
//!
//! Replies are matched to requests by their command id. Every request has a deadline except `Move`,
//! whose two replies belong to the lifecycle of the motion. Motions have their own queue and
//! reserved places, so other requests never delay a stop. When the connection ends, pending and
//! later calls return the reason.

use std::collections::HashMap;
use std::time::Duration;

use franka_proto::client::{Event, Session};
use franka_proto::{
    Command, CommandId, MoveStatus, Refusal, Reply, Request, RobotMode, Violation, VirtualWall,
};
use franka_rt::driver::MotionId;
use franka_rt::lifecycle::CloseReason;
use futures::StreamExt;
use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinHandle;
use tokio_util::codec::Framed;
use tokio_util::sync::CancellationToken;

use crate::close::Closing;
use crate::codec::{self, Frame, MessageCodec};
use crate::error::CommandError;
#[cfg(feature = "record")]
use crate::journal::{Journal, What};
use crate::world::{self, Instant, Stream};

/// Number of requests that may wait for the task. Further callers wait until there is room.
const CAPACITY: usize = 32;

/// Number of callers' requests that may wait for an answer. Two places are reserved for a motion's
/// `Move` and `StopMove`.
const CALLS: usize = <Session>::PENDING_LIMIT - 2;

/// Sender of requests to the task. Clones share the task.
#[derive(Clone, Debug)]
pub(crate) struct Channel {
    calls: mpsc::Sender<QueuedRequest>,
    /// Unbounded, but in practice short: two requests per motion, and motions follow one another.
    motions: mpsc::UnboundedSender<QueuedRequest>,
    closing: Closing,
    #[cfg(feature = "record")]
    journal: Journal,
}

/// The task, owned by the bridge.
#[derive(Debug)]
pub(crate) struct Connection {
    task: JoinHandle<()>,
    close: CancellationToken,
}

impl Connection {
    /// Closes the connection and returns once the socket is gone.
    ///
    /// # Cancel safety
    /// Once the future has been polled, the connection closes, even if the future is then dropped.
    pub(crate) async fn close(self) {
        self.close.cancel();
        if let Err(error) = self.task.await {
            tracing::error!(%error, "command channel");
        }
    }
}

/// Report of the channel to the bridge.
#[derive(Debug)]
pub(crate) enum Report {
    /// A reply to the `Move` of a motion.
    Move {
        motion: MotionId,
        status: MoveStatus,
    },
    /// The answer to the `Move` of a motion could not be read.
    MoveViolation {
        motion: MotionId,
        violation: Violation,
    },
    /// The connection is gone.
    Closed { reason: CloseReason },
}

/// Answer of the robot to an accepted request that is not a motion.
#[derive(Debug)]
pub(crate) enum Response {
    Done,
    /// The robot's description as URDF.
    Model(Vec<u8>),
    /// The model library, in the format of the requested system.
    Library(Vec<u8>),
    Wall(VirtualWall),
}

#[derive(Debug)]
struct QueuedRequest {
    request: Request,
    reply_to: ReplyTo,
}

#[derive(Debug)]
enum ReplyTo {
    /// The lifecycle of a motion: the bridge receives the replies, without a deadline.
    Motion(MotionId),
    /// No one receives the reply, because the lifecycle sends `StopMove` and then watches the
    /// states.
    Discarded,
    Caller {
        answer: oneshot::Sender<Result<Response, CommandError>>,
        deadline: Duration,
    },
}

impl Channel {
    /// Starts the task on a connection whose handshake has succeeded. Refusals name the robot mode
    /// that `mode` returns.
    pub(crate) fn start(
        stream: Framed<Stream, MessageCodec>,
        session: Session,
        mode: impl Fn() -> RobotMode + Send + 'static,
    ) -> (Self, Connection, mpsc::UnboundedReceiver<Report>) {
        let (calls, queue) = mpsc::channel(CAPACITY);
        let (motions, first) = mpsc::unbounded_channel();
        // Unbounded, but in practice short: two replies per motion, and motions follow one another.
        let (reports, inbox) = mpsc::unbounded_channel();
        let closing = Closing::default();
        let task = CommandTask {
            stream,
            session,
            mode: Box::new(mode),
            reports,
            pending: HashMap::new(),
        };
        let close = CancellationToken::new();
        let task = world::spawn(task.run((first, queue), closing.clone(), close.clone()));
        let channel = Self {
            calls,
            motions,
            closing,
            #[cfg(feature = "record")]
            journal: Journal::default(),
        };
        (channel, Connection { task, close }, inbox)
    }

    /// Makes the channel write requests and their answers to `journal`.
    #[cfg(feature = "record")]
    pub(crate) fn with_journal(mut self, journal: Journal) -> Self {
        self.journal = journal;
        self
    }

    /// Sends a request and waits for its answer.
    ///
    /// # Cancel safety
    /// If the future is dropped, the request may have been sent; its answer is discarded.
    pub(crate) async fn call(
        &self,
        request: Request,
        deadline: Duration,
    ) -> Result<Response, CommandError> {
        self.call_in_turn(request, deadline, ()).await
    }

    /// Does the same as [`Self::call`], and drops `turn` once the request has its place in the
    /// order of requests.
    ///
    /// # Cancel safety
    /// See [`Self::call`].
    pub(crate) async fn call_in_turn<T>(
        &self,
        request: Request,
        deadline: Duration,
        turn: T,
    ) -> Result<Response, CommandError> {
        let answered = self.ask(request, deadline, turn).await;
        #[cfg(feature = "record")]
        self.journal.write(|| {
            let error = answered.as_ref().err().map(ToString::to_string);
            let request = Box::new(request);
            Some(What::Answered { request, error })
        });
        answered
    }

    async fn ask<T>(
        &self,
        request: Request,
        deadline: Duration,
        turn: T,
    ) -> Result<Response, CommandError> {
        let (answer, answered) = oneshot::channel();
        let call = QueuedRequest {
            request,
            reply_to: ReplyTo::Caller { answer, deadline },
        };
        if self.calls.send(call).await.is_err() {
            return Err(self.closed());
        }
        drop(turn);
        answered.await.unwrap_or_else(|_| Err(self.closed()))
    }

    /// Sends a request on behalf of a motion, ahead of all requests that wait for room. Replies to
    /// a `Move` come as [`Report`]s, as does the end of the channel.
    pub(crate) fn send(&self, motion: MotionId, request: Request) {
        let reply_to = match request {
            Request::Move(_) => ReplyTo::Motion(motion),
            _ => ReplyTo::Discarded,
        };
        if self
            .motions
            .send(QueuedRequest { request, reply_to })
            .is_err()
        {
            tracing::debug!("request of a motion not sent: the command channel has ended");
        }
    }

    /// Returns the reason why the connection ended, once it has ended.
    pub(crate) fn closing(&self) -> &Closing {
        &self.closing
    }

    fn closed(&self) -> CommandError {
        CommandError::ConnectionClosed {
            reason: self.closing.reason(),
        }
    }
}

/// The two queues into the task: motions, and everything else.
type Queues = (
    mpsc::UnboundedReceiver<QueuedRequest>,
    mpsc::Receiver<QueuedRequest>,
);

struct CommandTask {
    stream: Framed<Stream, MessageCodec>,
    session: Session,
    mode: Box<dyn Fn() -> RobotMode + Send>,
    reports: mpsc::UnboundedSender<Report>,
    pending: HashMap<CommandId, Pending>,
}

struct Pending {
    command: Command,
    reply_to: ReplyTo,
    until: Option<Instant>,
}

impl CommandTask {
    async fn run(mut self, mut queues: Queues, closing: Closing, close: CancellationToken) {
        let reason = tokio::select! {
            reason = self.serve(&mut queues) => reason,
            () = close.cancelled() => CloseReason::ClosedByUs,
        };
        // Note the reason before the queues close, so that a caller who finds them closed finds the
        // reason. A request that is being sent while its queue is dropped would stay in the queue,
        // and its caller would wait forever. So wait for such requests, and drop them.
        let reason = closing.note(reason);
        let (mut motions, mut calls) = queues;
        motions.close();
        calls.close();
        while motions.recv().await.is_some() || calls.recv().await.is_some() {}
        for (_, waiting) in self.pending.drain() {
            if let ReplyTo::Caller { answer, .. } = waiting.reply_to {
                // This fails if the caller was dropped.
                let _ = answer.send(Err(CommandError::ConnectionClosed {
                    reason: reason.clone(),
                }));
            }
        }
        let _ = self.reports.send(Report::Closed { reason });
    }

    /// Serves until the connection ends, and returns the reason.
    async fn serve(&mut self, (motions, calls): &mut Queues) -> CloseReason {
        loop {
            let until = self
                .pending
                .values()
                .filter_map(|waiting| waiting.until)
                .min();
            let deadline = async {
                match until {
                    Some(until) => world::sleep_until(until).await,
                    None => std::future::pending().await,
                }
            };
            tokio::select! {
                frame = self.stream.next() => match frame {
                    Some(Ok(frame)) => {
                        if let Err(violation) = self.on_frame(&frame) {
                            let text = violation.to_string();
                            return CloseReason::Protocol { text };
                        }
                    }
                    Some(Err(error)) => return error.into(),
                    None => return CloseReason::ClosedByPeer,
                },
                Some(call) = motions.recv() => {
                    if let Err(reason) = self.on_call(call).await {
                        return reason;
                    }
                }
                // A call waits in the queue until there is room for its answer.
                call = calls.recv(), if self.session.pending() < CALLS => match call {
                    Some(call) => {
                        if let Err(reason) = self.on_call(call).await {
                            return reason;
                        }
                    }
                    None => return CloseReason::ClosedByUs,
                },
                () = deadline => self.on_deadline(world::now()),
            }
        }
    }

    async fn on_call(
        &mut self,
        QueuedRequest { request, reply_to }: QueuedRequest,
    ) -> Result<(), CloseReason> {
        if matches!(reply_to, ReplyTo::Motion(_)) {
            self.forget_motions();
        }
        let outgoing = match self.session.request(&request) {
            Ok(outgoing) => outgoing,
            Err(error) => {
                match reply_to {
                    ReplyTo::Caller { answer, .. } => {
                        let _ = answer.send(Err(error.into()));
                    }
                    ReplyTo::Motion(_) | ReplyTo::Discarded => {
                        tracing::error!(%error, "request of a motion not sent: the command \
                            channel has ended");
                    }
                }
                return Ok(());
            }
        };
        let id = outgoing.id();
        let command = request.command();
        match reply_to {
            ReplyTo::Discarded => {
                self.session.abandon(id);
            }
            ReplyTo::Motion(_) => self.wait(id, command, reply_to, None),
            ReplyTo::Caller { deadline, .. } => {
                self.wait(id, command, reply_to, Some(world::now() + deadline));
            }
        }
        codec::send(&mut self.stream, outgoing).await
    }

    fn wait(&mut self, id: CommandId, command: Command, reply_to: ReplyTo, until: Option<Instant>) {
        let waiting = Pending {
            command,
            reply_to,
            until,
        };
        self.pending.insert(id, waiting);
    }

    /// Stops waiting for replies to motions that have ended for the lifecycle.
    fn forget_motions(&mut self) {
        let over = self
            .pending
            .extract_if(|_, waiting| matches!(waiting.reply_to, ReplyTo::Motion(_)));
        for (id, _) in over {
            self.session.abandon(id);
        }
    }

    /// Routes one message. An error ends the connection.
    fn on_frame(&mut self, frame: &Frame) -> Result<(), Violation> {
        match self.session.on_message(frame.message()) {
            Ok(Event::Reply { id, command, reply }) => self.on_reply(id, command, &reply),
            Ok(Event::Unmatched { id }) => tracing::debug!(%id, "reply without a request"),
            Ok(other) => tracing::warn!(?other, "unexpected message"),
            Err(violation) if violation.is_fatal() => return Err(violation),
            Err(violation) => self.on_violation(violation),
        }
        Ok(())
    }

    fn on_reply(&mut self, id: CommandId, command: Command, reply: &Reply<'_>) {
        if let Reply::Move(status) = *reply {
            let is_last = status != MoveStatus::MotionStarted;
            let waiting = if is_last {
                self.pending.remove(&id)
            } else {
                None
            };
            let motion = waiting.as_ref().or_else(|| self.pending.get(&id));
            if let Some(&Pending {
                reply_to: ReplyTo::Motion(motion),
                ..
            }) = motion
            {
                // This fails only if the bridge has ended, and the motion with it.
                let _ = self.reports.send(Report::Move { motion, status });
            }
            return;
        }
        let Some(Pending {
            reply_to: ReplyTo::Caller { answer, .. },
            ..
        }) = self.pending.remove(&id)
        else {
            return;
        };
        let mode = (self.mode)();
        let outcome = match (Refusal::from_reply(command, reply, mode), reply) {
            (Some(refusal), _) => Err(refusal.into()),
            (None, Reply::Model { text, .. }) => Ok(Response::Model(text.to_vec())),
            (None, Reply::ModelLibrary { library, .. }) => Ok(Response::Library(library.to_vec())),
            (None, Reply::CartesianLimit { wall, .. }) => Ok(Response::Wall(*wall)),
            (None, _) => Ok(Response::Done),
        };
        let _ = answer.send(outcome);
    }

    fn on_violation(&mut self, violation: Violation) {
        let id = match &violation {
            Violation::Reply { id, .. } | Violation::SecondMotionStarted { id } => *id,
            other => return tracing::warn!(%other, "the robot violated the protocol"),
        };
        match self.pending.remove(&id).map(|waiting| waiting.reply_to) {
            Some(ReplyTo::Motion(motion)) => {
                let _ = self
                    .reports
                    .send(Report::MoveViolation { motion, violation });
            }
            Some(ReplyTo::Caller { answer, .. }) => {
                let _ = answer.send(Err(violation.into()));
            }
            Some(ReplyTo::Discarded) | None => {
                tracing::warn!(%violation, "the robot violated the protocol")
            }
        }
    }

    fn on_deadline(&mut self, now: Instant) {
        let late = self
            .pending
            .extract_if(|_, waiting| waiting.until.is_some_and(|until| until <= now));
        for (id, waiting) in late {
            self.session.abandon(id);
            if let ReplyTo::Caller { answer, deadline } = waiting.reply_to {
                let _ = answer.send(Err(CommandError::Timeout {
                    command: waiting.command,
                    deadline,
                }));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use franka_proto::{RecoveryStatus, SetterStatus, Version, server};
    use futures::SinkExt;

    use super::*;
    use crate::handshake::shake_hands;

    /// No byte leaves the process, and time passes only while all tasks wait. Therefore a deadline
    /// of half a minute is exact to the millisecond, and costs no real time.
    #[tokio::test(start_paused = true)]
    async fn a_robot_in_memory_answers_on_a_clock_that_is_counted() {
        let (ours, theirs) = tokio::io::duplex(4096);
        let [mut stream, mut robot] = [ours, theirs].map(|end| {
            let end: Stream = Box::new(end);
            Framed::new(end, MessageCodec::ROBOT)
        });
        let robot = world::spawn(async move {
            let mut session = server::Session::new(Version::V10);
            let mut recoveries = 0;
            while let Some(Ok(frame)) = robot.next().await {
                let reply = match session.on_message(frame.message()) {
                    Ok(server::Event::Connect { reply, .. }) => reply,
                    Ok(server::Event::Request { id, request }) => {
                        let reply = match request {
                            // The robot leaves the first recovery unanswered.
                            Request::AutomaticErrorRecovery if recoveries == 0 => {
                                recoveries += 1;
                                continue;
                            }
                            Request::AutomaticErrorRecovery => {
                                world::sleep(Duration::from_secs(29)).await;
                                Reply::Recovery(RecoveryStatus::Success)
                            }
                            _ => Reply::Setter(SetterStatus::CommandNotPossibleRejected),
                        };
                        session.reply(id, reply).expect("it fits the request")
                    }
                    other => panic!("{other:?}"),
                };
                robot.send(reply).await.expect("the client is there");
            }
        });

        let mut session = Session::new(Version::V10);
        let shaken = shake_hands(&mut stream, &mut session, 1).await;
        shaken.expect("both speak version 10");
        let (channel, connection, _reports) = Channel::start(stream, session, || RobotMode::Reflex);
        let recovery = async || {
            let begin = world::now();
            let limit = Duration::from_secs(30);
            let answer = channel.call(Request::AutomaticErrorRecovery, limit).await;
            (answer, (world::now() - begin).as_secs_f64().round())
        };
        let (answer, seconds) = recovery().await;
        assert!(
            matches!(answer, Err(CommandError::Timeout { .. })) && seconds == 30.0,
            "{answer:?} after {seconds} s"
        );
        let (answer, seconds) = recovery().await;
        assert!(
            answer.is_ok() && seconds == 29.0,
            "{answer:?} after {seconds} s"
        );

        let guiding = Request::SetGuidingMode {
            guiding_mode: [true; 6],
            nullspace: true,
        };
        let refused = channel.call(guiding, Duration::from_secs(1)).await;
        let Err(CommandError::Refused(refusal)) = refused else {
            panic!("{refused:?}");
        };
        assert_eq!(refusal.mode(), RobotMode::Reflex);
        connection.close().await;
        robot.await.expect("it saw the end of the stream");
    }

    /// A caller may have its place in the queue when the connection ends, and send its request
    /// afterwards.
    #[tokio::test(start_paused = true)]
    async fn request_sent_while_the_connection_ends_is_answered() {
        let (ours, theirs) = tokio::io::duplex(4096);
        let stream: Stream = Box::new(ours);
        let stream = Framed::new(stream, MessageCodec::ROBOT);
        let session = Session::new(Version::V10);
        let (channel, _connection, mut reports) =
            Channel::start(stream, session, || RobotMode::Idle);
        let place = channel.calls.reserve().await.expect("it is open");
        drop(theirs);
        while matches!(channel.closing.reason(), CloseReason::RuntimeEnded) {
            tokio::task::yield_now().await;
        }
        let (answer, answered) = oneshot::channel();
        let deadline = Duration::from_secs(1);
        place.send(QueuedRequest {
            request: Request::StopMove,
            reply_to: ReplyTo::Caller { answer, deadline },
        });
        assert!(
            answered.await.is_err(),
            "the task that would answer is gone"
        );
        assert!(matches!(reports.recv().await, Some(Report::Closed { .. })));
    }
}
