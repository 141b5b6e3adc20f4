//! The socket of one viewer. It receives requests, and sends frames, events and statistics.
//!
//! The server sends the newest state after the viewer has acknowledged the previous frame.
//! Therefore it never creates frames that a slow viewer would not read. The server continues to
//! read while a send waits, so it receives a stop. It disconnects a viewer that does not accept a
//! message within [`SEND`], or that is silent for [`SILENCE`].

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::extract::ws::{Message, Utf8Bytes, WebSocket};
use futures::stream::{SplitSink, SplitStream};
use futures::{SinkExt, StreamExt};
use serde::Serialize;
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::{mpsc, watch};
use tokio::time::{MissedTickBehavior, interval, sleep, timeout};

use crate::describe::Hello;
use crate::fingers::Fingers;
use crate::frame;
use crate::hub::Hub;
use crate::plan::{Question, in_background};
use crate::reply::{Reply, Status};
use crate::request::Request;
use crate::statistics::{Counts, Statistics};
use crate::viewer_lease::ViewerId;

/// Serves a viewer until the viewer disconnects, and then ends its hold.
pub(crate) async fn attend(hub: Arc<Hub>, socket: WebSocket) {
    let viewer = hub.next_viewer();
    let (sink, stream) = socket.split();
    let (replies, outbox) = mpsc::channel(REPLIES);
    let link = Arc::new(Link::default());
    let (ask, questions) = watch::channel(None);
    let answering = answer(&hub, questions, replies.clone());
    tokio::select! {
        () = read(&hub, viewer, stream, &link, replies, &ask) => {}
        _ = write(&hub, viewer, sink, &link, outbox) => {}
        _ = answering => {}
    }
    hub.gone(viewer);
}

/// The state of the connection to the page.
#[derive(Default)]
struct Link {
    /// Server time of the newest frame sent, `[ms]`.
    sent: AtomicU64,
    /// True until the viewer has acknowledged the newest frame.
    in_flight: AtomicBool,
    /// Number of this viewer's processed requests to begin a hold.
    begun: AtomicU64,
    round_trip: Mutex<Option<(Instant, Duration)>>,
}

impl Link {
    /// Processes an acknowledgement. Ignores acknowledgements of older frames.
    fn seen(&self, server_ms: u64, now_ms: u64) {
        if server_ms != self.sent.load(Ordering::Relaxed)
            || !self.in_flight.swap(false, Ordering::Relaxed)
        {
            return;
        }
        let took = Duration::from_millis(now_ms.saturating_sub(server_ms));
        *self.lock() = Some((Instant::now(), took));
    }

    /// Returns the newest round trip if it is recent. If a frame has waited for its acknowledgement
    /// for longer than this round trip, returns the waiting time instead.
    fn round_trip(&self, now_ms: u64) -> Option<Duration> {
        let (at, took) = (*self.lock())?;
        let waiting = match self.in_flight.load(Ordering::Relaxed) {
            true => now_ms.saturating_sub(self.sent.load(Ordering::Relaxed)),
            false => 0,
        };
        (at.elapsed() < FRESH).then(|| took.max(Duration::from_millis(waiting)))
    }

    fn begun(&self) -> u64 {
        self.begun.load(Ordering::Relaxed)
    }

    fn status(&self, status: Status) -> Reply {
        let begun = self.begun();
        Reply::Status { status, begun }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Option<(Instant, Duration)>> {
        self.round_trip
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }
}

/// Processes requests until the socket ends, or until the viewer stops reading the replies.
async fn read(
    hub: &Arc<Hub>,
    viewer: ViewerId,
    mut stream: SplitStream<WebSocket>,
    link: &Link,
    replies: mpsc::Sender<Reply>,
    ask: &watch::Sender<Option<Question>>,
) {
    let mut window = (Instant::now(), 0);
    while let Ok(Some(Ok(message))) = timeout(SILENCE, stream.next()).await {
        window.1 += 1;
        if window.0.elapsed() > Duration::from_secs(1) {
            window = (Instant::now(), 0);
        } else if window.1 > MESSAGES_PER_SECOND {
            // Meanwhile, more messages wait in the viewer's own connection.
            sleep(Duration::from_secs(1).saturating_sub(window.0.elapsed())).await;
        }
        let why = match message {
            Message::Text(text) => match serde_json::from_str(&text) {
                Ok(Request::Seen { server_ms }) => {
                    link.seen(server_ms, hub.now_ms());
                    continue;
                }
                Ok(request) => {
                    let round_trip = link.round_trip(hub.now_ms());
                    let begins = matches!(request, Request::Begin { .. });
                    let is_stop = matches!(request, Request::Stop {});
                    let handled = hub.handle(viewer, round_trip, request);
                    // This task also sends messages, so no message is sent between these lines.
                    link.begun.fetch_add(u64::from(begins), Ordering::Relaxed);
                    if is_stop && replies.try_send(Reply::Stopping {}).is_err() {
                        return;
                    }
                    match handled {
                        Ok(None) => None,
                        Ok(question) => {
                            ask.send_replace(question);
                            None
                        }
                        Err(refusal) => Some(refusal.to_string()),
                    }
                }
                Err(error) => Some(format!("not a request: {error}")),
            },
            Message::Binary(_) => Some("requests are text".to_owned()),
            Message::Ping(_) | Message::Pong(_) => None,
            Message::Close(_) => return,
        };
        if let Some(why) = why {
            let begun = link.begun();
            if replies.try_send(Reply::Refused { why, begun }).is_err() {
                return;
            }
        }
    }
}

/// Answers questions until the viewer disconnects, one at a time and the newest first.
async fn answer(
    hub: &Hub,
    mut questions: watch::Receiver<Option<Question>>,
    replies: mpsc::Sender<Reply>,
) -> Option<()> {
    loop {
        questions.changed().await.ok()?;
        let question = *questions.borrow_and_update();
        if let (Some(question), Some(robot)) = (question, hub.source.robot()) {
            let Question {
                number,
                motion,
                speed,
            } = question;
            let planned = in_background(robot, motion, speed, hub.keep_out.clone()).await;
            replies.send(Reply::preview(number, planned)).await.ok()?;
        }
    }
}

/// Sends all messages until the socket fails.
async fn write(
    hub: &Hub,
    viewer: ViewerId,
    mut sink: SplitSink<WebSocket, Message>,
    link: &Link,
    mut outbox: mpsc::Receiver<Reply>,
) -> Option<()> {
    let mut news = hub.news.subscribe();
    let mut status = hub.status.subscribe();
    let mut heading = hub.heading.subscribe();
    let mut contact = hub.contact.subscribe();
    let mut tared = hub.tare.subscribe();
    send(&mut sink, text(&Hello::new(hub, viewer))).await?;
    let first = status.borrow_and_update().clone();
    send(&mut sink, text(&link.status(first))).await?;
    let way = heading.borrow_and_update().clone();
    send(&mut sink, text(&Reply::heading(way))).await?;
    let tare = tared.borrow_and_update().tare.map(Into::into);
    send(&mut sink, text(&Reply::Tare { tare })).await?;
    let mut frames = interval(FRAME);
    let mut before = Counts::default();
    let mut slow = interval(STATISTICS);
    frames.set_missed_tick_behavior(MissedTickBehavior::Skip);
    slow.set_missed_tick_behavior(MissedTickBehavior::Skip);
    loop {
        let message = tokio::select! {
            biased;
            reply = outbox.recv() => text(&reply?),
            changed = status.changed() => {
                changed.ok()?;
                let status = status.borrow_and_update().clone();
                text(&link.status(status))
            }
            changed = heading.changed() => {
                changed.ok()?;
                let way = heading.borrow_and_update().clone();
                text(&Reply::heading(way))
            }
            changed = contact.changed() => {
                changed.ok()?;
                let contact = *contact.borrow_and_update();
                text(&Reply::Contact { contact })
            }
            changed = tared.changed() => {
                changed.ok()?;
                let tare = tared.borrow_and_update().tare.map(Into::into);
                text(&Reply::Tare { tare })
            }
            news = news.recv() => match news {
                Ok(news) => text(&Reply::Event(news)),
                Err(RecvError::Lagged(events)) => text(&Reply::Missed { events }),
                Err(RecvError::Closed) => return None,
            },
            _ = slow.tick() => {
                for reply in figures(hub, link, &mut before) {
                    send(&mut sink, text(&reply)).await?;
                }
                continue;
            }
            _ = frames.tick() => {
                if link.in_flight.load(Ordering::Relaxed) {
                    continue;
                }
                let now = hub.now_ms();
                let holding = status.borrow().viewer_lease.holding;
                let server = frame::Server {
                    ms: now,
                    holding,
                    width: hub.fingers.as_ref().map(Fingers::width),
                };
                let frame = frame::encode(&hub.source.newest(), hub.source.model(), server);
                link.sent.store(now, Ordering::Relaxed);
                link.in_flight.store(true, Ordering::Relaxed);
                Message::Binary(frame.into())
            }
        };
        send(&mut sink, message).await?;
    }
}

/// Returns the values that change continuously. The server sends these values a few times per
/// second.
fn figures(hub: &Hub, link: &Link, before: &mut Counts) -> impl Iterator<Item = Reply> + use<> {
    let round_trip = link.round_trip(hub.now_ms());
    let statistics = Statistics::of(hub.source.robot(), round_trip, before);
    let fingers = hub.fingers.as_ref().map(Fingers::state);
    let recordings = hub.recordings.as_ref();
    let recording = recordings.map(|it| Reply::Recording {
        recording: it.progress(),
    });
    let fingers = fingers.map(Reply::Gripper);
    [Some(Reply::Statistics(statistics)), fingers, recording]
        .into_iter()
        .flatten()
}

/// Sends a message within the time limit. Returns `None` if this fails.
async fn send(sink: &mut SplitSink<WebSocket, Message>, message: Message) -> Option<()> {
    timeout(SEND, sink.send(message)).await.ok()?.ok()
}

fn text(message: &impl Serialize) -> Message {
    let text = serde_json::to_string(message).expect("messages are plain data");
    Message::Text(Utf8Bytes::from(text))
}

const FRAME: Duration = Duration::from_nanos(16_666_667);
const STATISTICS: Duration = Duration::from_millis(200);

/// Time within which a viewer must accept a message.
const SEND: Duration = Duration::from_secs(2);

/// Silence after which a viewer counts as disconnected. A connected viewer acknowledges frames all
/// the time.
const SILENCE: Duration = Duration::from_secs(10);

/// Age above which a round trip is no longer used.
const FRESH: Duration = Duration::from_secs(1);

/// Largest number of replies that may wait for a viewer.
const REPLIES: usize = 32;

/// Largest number of messages per second from one viewer. The page sends fewer: 60
/// acknowledgements, 20 holds and 20 pushes.
const MESSAGES_PER_SECOND: u32 = 250;
