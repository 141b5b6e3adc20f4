//! The connection to an end effector: one task that owns both of its sockets.
//!
//! An action has one answer, when it has ended, and no deadline: homing takes seconds, and a
//! blocked move takes minutes. The task sends a stop when the future of the running action is
//! dropped. States come by UDP at a low rate, so a task of the runtime is fast enough for them.

use std::collections::HashMap;
use std::fmt;
use std::net::{IpAddr, SocketAddr};

use franka_proto::client::{Event, Session};
use franka_proto::gripper::{Failure, Reply};
use franka_proto::{CommandId, DecodeError, Protocol, Violation, gripper, vacuum};
use franka_rt::lifecycle::CloseReason;
use futures::StreamExt;
use tokio::sync::{mpsc, oneshot, watch};
use tokio_util::codec::Framed;

use crate::close::Closing;
use crate::codec::{self, Frame, MessageCodec};
use crate::dial::{TCP_TIMEOUT, dial, resolve};
use crate::endpoint::Endpoint;
use crate::error::{ActionError, ConnectError};
use crate::handshake::shake_hands;
#[cfg(feature = "record")]
use crate::journal::{ActionEnd, Journal, What};
use crate::states::States;
use crate::world::{self, Datagrams, StatePort, Stream, timeout};

/// Largest number of states that are read before an answer.
const DATAGRAMS: usize = 64;

/// Largest length of a datagram that is read, in bytes.
const DATAGRAM_SIZE: usize = 64;

/// Differences between the end effectors.
pub(crate) trait Device: for<'a> Protocol<Reply<'a> = Reply> + Default {
    /// State that the device sends.
    type State: Copy + fmt::Debug;

    const TCP_PORT: u16;
    const STOP: Self::Request;

    fn state(datagram: &[u8]) -> Result<Self::State, DecodeError>;

    /// Returns the device's clock, `[ms]`.
    fn clock(state: &Self::State) -> u32;

    /// Returns the reason why the device cannot carry out the request; `None` if the request is
    /// within its range.
    fn out_of_range(_request: &Self::Request, _state: &Self::State) -> Option<String> {
        None
    }

    /// Returns the journal entry for an action that has ended.
    #[cfg(feature = "record")]
    fn ended(request: Self::Request, ended: ActionEnd) -> What;

    /// Returns the journal entry for a state.
    #[cfg(feature = "record")]
    fn seen(state: Self::State) -> What;
}

impl Device for gripper::Version {
    type State = gripper::State;

    const TCP_PORT: u16 = Self::TCP_PORT;
    const STOP: gripper::Request = gripper::Request::Stop;

    fn state(datagram: &[u8]) -> Result<gripper::State, DecodeError> {
        gripper::State::decode(datagram)
    }

    fn out_of_range(request: &gripper::Request, state: &gripper::State) -> Option<String> {
        let (width, speed, grasp) = match request {
            gripper::Request::Move(to) => (to.width, to.speed, None),
            gripper::Request::Grasp(grasp) => (grasp.width, grasp.speed, Some(grasp)),
            _ => return None,
        };
        let most = state.max_width;
        if !(0.0..=most).contains(&width) {
            return Some(if most > 0.0 {
                format!("width {width} m, expected 0 to {most} m")
            } else {
                format!(
                    "width {width} m, but the gripper does not know its greatest width yet: home \
                     it first"
                )
            });
        }
        let above_zero = |name: &str, got: f64, unit: &str| {
            let fits = got.is_finite() && got > 0.0;
            (!fits).then(|| format!("{name} {got} {unit}, expected more than 0"))
        };
        let tolerance = |name: &str, got: f64| {
            let fits = got.is_finite() && got >= 0.0;
            (!fits).then(|| format!("{name} {got} m, expected 0 or more"))
        };
        above_zero("speed", speed, "m/s").or_else(|| {
            let grasp = grasp?;
            above_zero("force", grasp.force, "N")
                .or_else(|| tolerance("epsilon_inner", grasp.epsilon_inner))
                .or_else(|| tolerance("epsilon_outer", grasp.epsilon_outer))
        })
    }

    fn clock(state: &gripper::State) -> u32 {
        state.message_id
    }

    #[cfg(feature = "record")]
    fn ended(request: gripper::Request, ended: ActionEnd) -> What {
        What::Hand { request, ended }
    }

    #[cfg(feature = "record")]
    fn seen(state: gripper::State) -> What {
        What::HandState(state)
    }
}

impl Device for vacuum::Version {
    type State = vacuum::State;

    const TCP_PORT: u16 = Self::TCP_PORT;
    const STOP: vacuum::Request = vacuum::Request::Stop;

    fn state(datagram: &[u8]) -> Result<vacuum::State, DecodeError> {
        vacuum::State::decode(datagram)
    }

    fn clock(state: &vacuum::State) -> u32 {
        state.message_id
    }

    #[cfg(feature = "record")]
    fn ended(request: vacuum::Request, ended: ActionEnd) -> What {
        What::Vacuum { request, ended }
    }

    #[cfg(feature = "record")]
    fn seen(state: vacuum::State) -> What {
        What::VacuumState(state)
    }
}

/// Result of an action.
type ActionResult<D> = Result<bool, ActionError<<D as Protocol>::Command>>;

type ActionReply<D> = oneshot::Sender<ActionResult<D>>;

struct QueuedAction<D: Device> {
    request: D::Request,
    answer: ActionReply<D>,
}

/// Sender of requests to the task. Clones share the task.
pub(crate) struct DeviceConnection<D: Device> {
    address: SocketAddr,
    /// Unbounded, but in practice short, because the task reads requests at once, and refuses those
    /// that do not fit into the session.
    calls: mpsc::UnboundedSender<QueuedAction<D>>,
    states: watch::Receiver<D::State>,
    closing: Closing,
    #[cfg(feature = "record")]
    journal: Journal,
}

impl<D: Device> Clone for DeviceConnection<D> {
    fn clone(&self) -> Self {
        Self {
            address: self.address,
            calls: self.calls.clone(),
            states: self.states.clone(),
            closing: self.closing.clone(),
            #[cfg(feature = "record")]
            journal: self.journal.clone(),
        }
    }
}

impl<D: Device> fmt::Debug for DeviceConnection<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut link = f.debug_struct("DeviceConnection");
        link.field("address", &self.address).finish_non_exhaustive()
    }
}

impl<D: Device + Send + Sync + 'static> DeviceConnection<D>
where
    D::Command: Send + Sync,
    D::Request: Send,
    D::State: Send + Sync,
{
    pub(crate) async fn connect(endpoint: Endpoint) -> Result<Self, ConnectError<D>> {
        let addresses = resolve::<D>(&endpoint, D::TCP_PORT, TCP_TIMEOUT).await?;
        let (tcp, address) = dial::<D>(&addresses, TCP_TIMEOUT).await?;
        let port = StatePort::open(address.ip())?;
        let (port, socket) = (port.number()?, port.datagrams()?);
        let mut stream = Framed::new(tcp, MessageCodec::END_EFFECTOR);
        let mut session = Session::new(D::default());
        timeout(TCP_TIMEOUT, shake_hands(&mut stream, &mut session, port))
            .await
            .unwrap_or(Err(ConnectError::HandshakeTimeout { address }))?;
        let first = timeout(TCP_TIMEOUT, first_state::<D>(&socket, address.ip()))
            .await
            .unwrap_or(Err(ConnectError::NoState { address }))?;

        #[cfg(feature = "record")]
        let journal = Journal::default();
        let (states, published) = watch::channel(first);
        let (calls, queue) = mpsc::unbounded_channel();
        let closing = Closing::default();
        let task = DeviceTask {
            stream,
            session,
            socket,
            peer: address.ip(),
            states,
            running: None,
            waiting: HashMap::new(),
            #[cfg(feature = "record")]
            journal: journal.clone(),
        };
        world::spawn(task.run(queue, closing.clone()));
        Ok(Self {
            address,
            calls,
            states: published,
            closing,
            #[cfg(feature = "record")]
            journal,
        })
    }

    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    pub(crate) fn state(&self) -> D::State {
        *self.states.borrow()
    }

    pub(crate) fn states(&self) -> States<D::State> {
        States::new(self.states.clone(), self.closing.clone())
    }

    #[cfg(feature = "record")]
    pub(crate) fn journal(&self) -> &Journal {
        &self.journal
    }

    /// Sends a request, and waits until its action has ended.
    ///
    /// # Cancel safety
    /// Dropping the future stops the action, unless a newer action has replaced it.
    pub(crate) async fn act(&self, request: D::Request) -> ActionResult<D> {
        let asked = request.clone();
        let ended = self.ask(request).await.map_err(|error| match error {
            ActionError::Failure(failure @ Failure::Failed { .. }) => {
                match D::out_of_range(&asked, &self.state()) {
                    Some(why) => ActionError::OutOfRange { failure, why },
                    None => error,
                }
            }
            error => error,
        });
        #[cfg(feature = "record")]
        self.journal.write(|| {
            let ended = ended.as_ref().map(|done| *done);
            Some(D::ended(asked.clone(), ended.map_err(ToString::to_string)))
        });
        ended
    }

    async fn ask(&self, request: D::Request) -> ActionResult<D> {
        let (answer, answered) = oneshot::channel();
        if self.calls.send(QueuedAction { request, answer }).is_err() {
            return Err(self.closed());
        }
        answered.await.unwrap_or_else(|_| Err(self.closed()))
    }

    fn closed(&self) -> ActionError<D::Command> {
        ActionError::ConnectionClosed {
            reason: self.closing.reason(),
        }
    }
}

async fn first_state<D: Device>(
    socket: &Datagrams,
    peer: IpAddr,
) -> Result<D::State, ConnectError<D>> {
    let mut buffer = [0; DATAGRAM_SIZE];
    loop {
        let (length, source) = socket.recv_from(&mut buffer).await?;
        if source.ip() == peer
            && let Ok(state) = D::state(&buffer[..length])
        {
            return Ok(state);
        }
    }
}

struct DeviceTask<D: Device> {
    stream: Framed<Stream, MessageCodec>,
    session: Session<D>,
    socket: Datagrams,
    peer: IpAddr,
    states: watch::Sender<D::State>,
    /// The newest action, until its answer has come.
    running: Option<(CommandId, ActionReply<D>)>,
    /// Stop requests, and actions that newer actions have replaced.
    waiting: HashMap<CommandId, ActionReply<D>>,
    #[cfg(feature = "record")]
    journal: Journal,
}

impl<D: Device> DeviceTask<D> {
    async fn run(mut self, mut calls: mpsc::UnboundedReceiver<QueuedAction<D>>, closing: Closing) {
        let Err(reason) = self.serve(&mut calls).await;
        // Note the reason before the answers are dropped, so that a caller who finds them dropped
        // finds the reason.
        closing.note(reason);
        // A request that is being sent while the queue is dropped would stay in the queue, and its
        // caller would wait forever.
        calls.close();
        while calls.recv().await.is_some() {}
    }

    /// Serves until the connection ends, and returns the reason as the error.
    async fn serve(
        &mut self,
        calls: &mut mpsc::UnboundedReceiver<QueuedAction<D>>,
    ) -> Result<std::convert::Infallible, CloseReason> {
        let mut buffer = [0; DATAGRAM_SIZE];
        loop {
            tokio::select! {
                received = self.socket.recv_from(&mut buffer) => match received {
                    Ok((length, source)) => self.on_datagram(&buffer[..length], source),
                    Err(error) => return Err(codec::failed("UDP receive", &error)),
                },
                frame = self.stream.next() => match frame {
                    Some(Ok(frame)) => self.on_frame(&frame).map_err(|violation| {
                        let text = violation.to_string();
                        CloseReason::Protocol { text }
                    })?,
                    Some(Err(error)) => return Err(error.into()),
                    None => return Err(CloseReason::ClosedByPeer),
                },
                () = abandoned::<D>(&mut self.running) => self.stop().await?,
                call = calls.recv() => match call {
                    Some(call) => self.on_call(call).await?,
                    None => {
                        if self.running.is_some() {
                            self.stop().await?;
                        }
                        return Err(CloseReason::ClosedByUs);
                    }
                },
            }
        }
    }

    async fn on_call(
        &mut self,
        QueuedAction { request, answer }: QueuedAction<D>,
    ) -> Result<(), CloseReason> {
        // The caller's future was dropped before the request was sent. A stop is sent nevertheless.
        if answer.is_closed() && request != D::STOP {
            return Ok(());
        }
        // A device that does not answer must not use up all places.
        for (id, _) in self.waiting.extract_if(|_, answer| answer.is_closed()) {
            self.session.abandon(id);
        }
        let outgoing = match self.session.request(&request) {
            Ok(outgoing) => outgoing,
            Err(error) => {
                // This fails if the caller was dropped.
                let _ = answer.send(Err(error.into()));
                return Ok(());
            }
        };
        let id = outgoing.id();
        let replaced = if request == D::STOP {
            Some((id, answer))
        } else {
            self.running.replace((id, answer))
        };
        self.waiting.extend(replaced);
        codec::send(&mut self.stream, outgoing).await
    }

    /// Stops the action whose future was dropped.
    async fn stop(&mut self) -> Result<(), CloseReason> {
        if let Some((id, _)) = self.running.take() {
            self.session.abandon(id);
        }
        match self.session.request(&D::STOP) {
            Ok(stop) => {
                self.session.abandon(stop.id());
                codec::send(&mut self.stream, stop).await
            }
            // Without the connection, the device stops on its own.
            Err(error) => {
                tracing::warn!(%error, "too many pending requests to send a stop; closing the \
                    connection instead");
                Err(CloseReason::ClosedByUs)
            }
        }
    }

    /// Publishes a state, unless it is older than the newest one.
    fn on_datagram(&mut self, datagram: &[u8], source: SocketAddr) {
        if source.ip() != self.peer {
            return;
        }
        match D::state(datagram) {
            Ok(state) => {
                let newest = D::clock(&self.states.borrow());
                if D::clock(&state).wrapping_sub(newest) <= u32::MAX / 2 {
                    self.states.send_replace(state);
                    #[cfg(feature = "record")]
                    self.journal.write(|| Some(D::seen(state)));
                }
            }
            Err(error) => tracing::debug!(%error, "invalid state datagram"),
        }
    }

    /// Routes one message. An error ends the connection.
    fn on_frame(&mut self, frame: &Frame) -> Result<(), Violation<D::Command>> {
        // First read the states that were sent before this answer, because they show its result.
        let mut buffer = [0; DATAGRAM_SIZE];
        for _ in 0..DATAGRAMS {
            match self.socket.try_recv_from(&mut buffer) {
                Ok((length, source)) => self.on_datagram(&buffer[..length], source),
                Err(_) => break,
            }
        }
        let (id, outcome) = match self.session.on_message(frame.message()) {
            Ok(Event::Reply { id, command, reply }) => match reply {
                Reply::Done(status) => (id, status.result(command).map_err(Into::into)),
                Reply::Connect { .. } => unreachable!("the session answers its handshake itself"),
            },
            Ok(Event::Unmatched { id }) => {
                tracing::debug!(%id, "reply without a request");
                return Ok(());
            }
            Ok(other) => {
                tracing::warn!(?other, "unexpected message");
                return Ok(());
            }
            Err(violation) => match violation.id().filter(|_| !violation.is_fatal()) {
                Some(id) => (id, Err(violation.into())),
                None => return Err(violation),
            },
        };
        let answer = match self.running.take() {
            Some((running, answer)) if running == id => Some(answer),
            other => {
                self.running = other;
                self.waiting.remove(&id)
            }
        };
        if let Some(answer) = answer {
            let _ = answer.send(outcome);
        }
        Ok(())
    }
}

/// Waits until the future of the running action is dropped.
async fn abandoned<D: Device>(running: &mut Option<(CommandId, ActionReply<D>)>) {
    match running {
        Some((_, answer)) => answer.closed().await,
        None => std::future::pending().await,
    }
}
