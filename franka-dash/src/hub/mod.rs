//! The state that all viewers share: the robot, its commander, and the events.

mod effects;
mod taring;
mod watching;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use franka_async::model::collision::Obstacle;
use tokio::sync::{Semaphore, broadcast, watch};

use crate::contact::Contact;
use crate::fingers::Fingers;
use crate::hold::{Hold, Settings};
use crate::options::Options;
use crate::plan::{Plan, Question};
use crate::recording::Recordings;
use crate::reply::{Level, News, Status};
use crate::request::{Request, Tuning};
use crate::simulated::Simulated;
use crate::source::Source;
use crate::viewer_lease::{Lost, Permissions, Refusal, Step, ViewerId, ViewerLease};
use taring::Tared;

/// The state that all viewers share.
pub(crate) struct Hub {
    pub(crate) source: Source,
    pub(crate) permissions: Permissions,
    pub(crate) news: broadcast::Sender<News>,
    pub(crate) status: watch::Sender<Status>,
    /// Number of the active hold and the plan of its motion; `None` without a plan.
    pub(crate) heading: watch::Sender<Option<(u64, Plan)>>,
    /// The current contact on the arm, if any.
    pub(crate) contact: watch::Sender<Option<Contact>>,
    /// The tare (the zero) of the wrench.
    pub(crate) tare: watch::Sender<Tared>,
    /// Regions that the arm must avoid.
    pub(crate) keep_out: Vec<Obstacle>,
    /// Names of all robots of the server, if it has several robots.
    pub(crate) siblings: Arc<[String]>,
    /// Permits for viewers. Each viewer takes one.
    pub(crate) seats: Arc<Semaphore>,
    pub(crate) simulated: Option<Simulated>,
    pub(crate) fingers: Option<Fingers>,
    pub(crate) recordings: Option<Recordings>,
    command: Mutex<Command>,
    stopping: AtomicBool,
    viewers: AtomicU64,
    start: Instant,
    /// Time at which the server started, `[ms]` since 1970.
    pub(crate) began_ms: u64,
}

struct Command {
    viewer_lease: ViewerLease,
    hold: Option<Hold>,
    settings: watch::Sender<Settings>,
}

impl Hub {
    /// Starts the background tasks, which end when the last handle is dropped. Call this function
    /// within a Tokio runtime.
    pub(crate) fn start(source: Source, options: Options) -> Arc<Self> {
        let Options {
            admission: _,
            motion,
            simulated,
            gripper,
            recordings,
            writing,
            patience,
            keep_out,
            siblings,
        } = options;
        let connected = source.robot().is_some();
        let permissions = Permissions {
            motion: motion && connected,
            disturbances: simulated.is_some(),
            gripper: gripper.is_some(),
            recording: recordings.is_some() && connected,
            patience: match simulated {
                Some(_) => patience,
                None => Duration::ZERO,
            },
        };
        let lease = source.robot().map(|robot| robot.lease().clone());
        let (lease, start) = (lease.unwrap_or_default(), Instant::now());
        let hub = Arc::new(Self {
            permissions,
            news: broadcast::Sender::new(NEWS),
            status: watch::Sender::default(),
            heading: watch::Sender::default(),
            contact: watch::Sender::default(),
            tare: watch::Sender::default(),
            keep_out,
            siblings,
            seats: Arc::new(Semaphore::new(VIEWERS_MAX)),
            simulated,
            fingers: gripper.map(Fingers::new),
            recordings: recordings.map(|folder| Recordings::new(folder, writing)),
            command: Mutex::new(Command {
                viewer_lease: ViewerLease::new(permissions, lease, start),
                hold: None,
                settings: watch::Sender::default(),
            }),
            stopping: AtomicBool::new(false),
            viewers: AtomicU64::new(0),
            start,
            began_ms: {
                let since = SystemTime::now()
                    .duration_since(UNIX_EPOCH)
                    .unwrap_or_default();
                u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
            },
            source,
        });
        watching::begin(&hub);
        hub
    }

    /// Returns the time since the server started.
    pub(crate) fn now(&self) -> Duration {
        self.start.elapsed()
    }

    pub(crate) fn now_ms(&self) -> u64 {
        u64::try_from(self.now().as_millis()).unwrap_or(u64::MAX)
    }

    /// Returns a viewer number that is not in use.
    pub(crate) fn next_viewer(&self) -> ViewerId {
        self.viewers.fetch_add(1, Ordering::Relaxed) + 1
    }

    pub(crate) fn tell(&self, level: Level, text: String, detail: Option<String>) {
        let news = News {
            server_ms: self.now_ms(),
            level,
            text,
            detail,
        };
        // The send fails if no viewer is connected. This is not an error.
        let _ = self.news.send(news);
    }

    /// Processes a viewer's request. Returns a refusal, or a message for the viewer.
    pub(crate) fn handle(
        self: &Arc<Self>,
        viewer: ViewerId,
        round_trip: Option<Duration>,
        request: Request,
    ) -> Result<Option<Question>, Refusal> {
        let mut command = self.command.lock().unwrap_or_else(PoisonError::into_inner);
        let now = self.now();
        let Step {
            ended,
            effect,
            refusal,
        } = command
            .viewer_lease
            .handle(now, viewer, round_trip, request);
        self.end(&mut command, ended);
        let question = effect.and_then(|effect| self.perform(&mut command, viewer, effect));
        self.publish(&command);
        refusal.map_or(Ok(question), Err)
    }

    /// Processes the disconnection of a viewer. The viewer's hold ends.
    pub(crate) fn gone(&self, viewer: ViewerId) {
        let mut command = self.command.lock().unwrap_or_else(PoisonError::into_inner);
        let ended = command.viewer_lease.gone(viewer);
        self.end(&mut command, ended);
        self.publish(&command);
    }

    fn tick(&self) {
        let mut command = self.command.lock().unwrap_or_else(PoisonError::into_inner);
        let ended = command.viewer_lease.tick(self.now());
        self.end(&mut command, ended);
        self.publish(&command);
    }

    /// Processes the end of the motion of hold `number`.
    fn motion_ended(&self, number: u64) {
        let mut command = self.command.lock().unwrap_or_else(PoisonError::into_inner);
        let holding = command.viewer_lease.status().holding;
        command.viewer_lease.ended(number);
        if holding && !command.viewer_lease.status().holding {
            command.hold = None;
        }
        self.publish(&command);
    }

    fn end(&self, command: &mut Command, ended: Option<Lost>) {
        let Some(lost) = ended else { return };
        command.hold = None;
        if !matches!(lost, Lost::LetGo) {
            self.tell(Level::Warning, format!("Hold ended: {lost}"), None);
        }
    }

    /// Publishes changes to all viewers. When the lease of a commander ends, the commander's
    /// settings are reset.
    fn publish(&self, command: &Command) {
        let viewer_lease = command.viewer_lease.status();
        if viewer_lease.commander != self.status.borrow().viewer_lease.commander {
            let settings = &command.settings;
            settings.send_modify(|settings| settings.tuning = Tuning::default());
        }
        if let Some(fingers) = &self.fingers {
            fingers.end_unless(viewer_lease.commander);
        }
        let newest = Status {
            viewer_lease,
            tuning: command.settings.borrow().tuning,
            simulation: self.simulated.as_ref().map(Simulated::setting),
        };
        self.status.send_if_modified(|status| {
            let changed = *status != newest;
            *status = newest;
            changed
        });
    }
}

/// Number of events by which a viewer may lag behind before it loses events.
const NEWS: usize = 64;

/// Largest number of simultaneous viewers.
const VIEWERS_MAX: usize = 256;
