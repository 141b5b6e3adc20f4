//! What all viewers share: the robot, who may command it, and what happened.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::{Duration, Instant};

use franka_async::Robot;
use franka_async::model::collision::Obstacle;
use tokio::sync::{Semaphore, broadcast, watch};
use tokio::time::{MissedTickBehavior, interval};

use crate::admission::Admission;
use crate::authority::{Authority, Effect, Lost, Permissions, Refusal, Step, ViewerId};

use crate::contact::{self, Contact};
use crate::fingers::Fingers;
use crate::hold::{self, Ended, Hold, Settings, Task};
use crate::news;
use crate::options::Options;
use crate::plan::{Plan, Question};
use crate::recording::Recordings;
use crate::reply::{Level, News, Status};
use crate::request::{Disturbance, GripperAction, Motion, Request, Tuning};
use crate::simulated::Simulated;
use crate::source::Source;

/// What all viewers share.
pub(crate) struct Hub {
    pub(crate) source: Source,
    pub(crate) admission: Admission,
    pub(crate) permissions: Permissions,
    pub(crate) news: broadcast::Sender<News>,
    pub(crate) status: watch::Sender<Status>,
    /// The number of the hold that goes on, and what its motion does, if that is planned.
    pub(crate) heading: watch::Sender<Option<(u64, Plan)>>,
    /// Where something touches the arm.
    pub(crate) contact: watch::Sender<Option<Contact>>,
    /// Regions that the arm is kept out of.
    pub(crate) keep_out: Vec<Obstacle>,
    /// The names of all robots of the server, if there are several.
    pub(crate) siblings: Arc<[String]>,
    /// One permit per viewer.
    pub(crate) seats: Arc<Semaphore>,
    pub(crate) simulated: Option<Simulated>,
    pub(crate) fingers: Option<Fingers>,
    pub(crate) recordings: Option<Recordings>,
    command: Mutex<Command>,
    stopping: AtomicBool,
    viewers: AtomicU64,
    start: Instant,
}

struct Command {
    authority: Authority,
    hold: Option<Hold>,
    settings: watch::Sender<Settings>,
}

impl Hub {
    /// Starts the tasks that end with the last handle. Needs a Tokio runtime.
    pub(crate) fn start(source: Source, options: Options) -> Arc<Self> {
        let Options {
            admission,
            motion,
            simulated,
            gripper,
            recordings,
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
        let hub = Arc::new(Self {
            admission,
            permissions,
            news: broadcast::Sender::new(NEWS),
            status: watch::Sender::default(),
            heading: watch::Sender::default(),
            contact: watch::Sender::default(),
            keep_out,
            siblings,
            seats: Arc::new(Semaphore::new(VIEWERS_MAX)),
            simulated,
            fingers: gripper.map(Fingers::new),
            recordings: recordings.map(Recordings::new),
            command: Mutex::new(Command {
                authority: Authority::new(permissions),
                hold: None,
                settings: watch::Sender::default(),
            }),
            stopping: AtomicBool::new(false),
            viewers: AtomicU64::new(0),
            start: Instant::now(),
            source,
        });
        tokio::spawn(watch_silence(Arc::downgrade(&hub)));
        tokio::spawn(watch_contacts(Arc::downgrade(&hub)));
        if let Some(simulated) = hub.simulated.clone() {
            let hub = hub.clone();
            tokio::spawn(async move {
                simulated.look().await;
                hub.tick();
            });
        }
        match &hub.source {
            Source::Robot(robot) => {
                tokio::spawn(tell_events(robot.events(), Arc::downgrade(&hub)));
            }
            Source::Watched(_) => {
                if let Some(simulated) = hub.simulated.clone() {
                    tokio::spawn(follow_simulation(simulated, Arc::downgrade(&hub)));
                }
            }
        }
        hub
    }

    /// Time since the start of the server.
    pub(crate) fn now(&self) -> Duration {
        self.start.elapsed()
    }

    pub(crate) fn now_ms(&self) -> u64 {
        u64::try_from(self.now().as_millis()).unwrap_or(u64::MAX)
    }

    /// A number that no viewer had before.
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
        // There may be no viewer.
        let _ = self.news.send(news);
    }

    /// Does what a viewer asks for, or returns why not; or returns what the viewer is to be told.
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
        } = command.authority.handle(now, viewer, round_trip, request);
        self.end(&mut command, ended);
        let question = effect.and_then(|effect| self.perform(&mut command, viewer, effect));
        self.publish(&command);
        refusal.map_or(Ok(question), Err)
    }

    /// A viewer has gone: what it held ends.
    pub(crate) fn gone(&self, viewer: ViewerId) {
        let mut command = self.command.lock().unwrap_or_else(PoisonError::into_inner);
        let ended = command.authority.gone(viewer);
        self.end(&mut command, ended);
        self.publish(&command);
    }

    fn tick(&self) {
        let mut command = self.command.lock().unwrap_or_else(PoisonError::into_inner);
        let ended = command.authority.tick(self.now());
        self.end(&mut command, ended);
        self.publish(&command);
    }

    /// The motion of this hold has ended by itself.
    fn motion_ended(&self, number: u64) {
        let mut command = self.command.lock().unwrap_or_else(PoisonError::into_inner);
        let holding = command.authority.status().holding;
        command.authority.ended(number);
        if holding && !command.authority.status().holding {
            command.hold = None;
        }
        self.publish(&command);
    }

    /// Brakes, where a hold has ended.
    fn end(&self, command: &mut Command, ended: Option<Lost>) {
        let Some(lost) = ended else { return };
        command.hold = None;
        if !matches!(lost, Lost::LetGo) {
            self.tell(Level::Warning, format!("Hold ended: {lost}"), None);
        }
    }

    /// Shows all viewers what has changed. What a commander has set ends with its lease.
    fn publish(&self, command: &Command) {
        let authority = command.authority.status();
        if authority.commander != self.status.borrow().authority.commander {
            let settings = &command.settings;
            settings.send_modify(|settings| settings.tuning = Tuning::default());
        }
        if let Some(fingers) = &self.fingers {
            fingers.end_unless(authority.commander);
        }
        let newest = Status {
            authority,
            tuning: command.settings.borrow().tuning,
            simulation: self.simulated.as_ref().map(Simulated::setting),
        };
        self.status.send_if_modified(|status| {
            let changed = *status != newest;
            *status = newest;
            changed
        });
    }

    fn perform(
        self: &Arc<Self>,
        command: &mut Command,
        viewer: ViewerId,
        effect: Effect,
    ) -> Option<Question> {
        match effect {
            Effect::Preview {
                number,
                motion,
                speed,
            } => {
                return Some(Question {
                    number,
                    motion,
                    speed,
                });
            }
            Effect::KeepAlive => {
                if let Some(hold) = &command.hold {
                    hold.keep_alive();
                }
            }
            Effect::Begin {
                hold,
                motion,
                speed,
            } => {
                command.settings.send_modify(|it| it.speed = speed);
                command.hold = self.begin(hold, motion, command.settings.subscribe());
            }
            Effect::Tune(tuning) => command.settings.send_modify(|it| it.tuning = tuning),
            Effect::Speed(speed) => command.settings.send_modify(|it| it.speed = speed),
            Effect::Gripper(action) => self.move_fingers(viewer, action),
            Effect::Record(on) => self.record(on),
            Effect::Stop => self.stop(),
            Effect::Recover => {
                if let Source::Robot(robot) = &self.source {
                    tokio::spawn(recover(robot.clone(), self.clone()));
                }
            }
            Effect::Disturb(disturbance) => self.disturb(disturbance),
        }
        None
    }

    fn begin(
        self: &Arc<Self>,
        number: u64,
        motion: Motion,
        settings: watch::Receiver<Settings>,
    ) -> Option<Hold> {
        let robot = self.source.robot()?.clone();
        let (hold, deadman, end) = Hold::new(self.permissions.patience);
        let hub = self.clone();
        let task = Task {
            motion,
            settings,
            keep_out: self.keep_out.clone(),
            deadman,
            end,
        };
        tokio::spawn(async move {
            let show = |plan| drop(hub.heading.send_replace(Some((number, plan))));
            let ended = hold::run(&robot, task, show).await;
            // A newer hold may have begun while the arm was let go.
            hub.heading.send_if_modified(|heading| {
                let own = |(of, _): &mut (u64, Plan)| *of == number;
                heading.take_if(own).is_some()
            });
            if let Ended::Failed(text, detail) = ended {
                hub.tell(Level::Error, text, detail);
            }
            hub.motion_ended(number);
        });
        Some(hold)
    }

    fn move_fingers(self: &Arc<Self>, viewer: ViewerId, action: GripperAction) {
        let Some(fingers) = &self.fingers else { return };
        let (acting, hub) = (fingers.begin(viewer, action), self.clone());
        tokio::spawn(async move {
            let (done, text) = acting.await;
            let level = if done { Level::Info } else { Level::Warning };
            hub.tell(level, text, None);
        });
    }

    fn record(self: &Arc<Self>, on: bool) {
        let (Some(recordings), Some(robot)) = (&self.recordings, self.source.robot()) else {
            return;
        };
        if !on {
            return recordings.end();
        }
        let (robot, hub) = (robot.clone(), self.clone());
        tokio::spawn(async move {
            let Some(recordings) = &hub.recordings else {
                return;
            };
            let gripper = hub.fingers.as_ref().map(|fingers| &fingers.gripper);
            match recordings.record(&robot, gripper).await {
                Some(Ok(text)) => hub.tell(Level::Info, text, None),
                Some(Err(why)) => hub.tell(Level::Error, format!("Recording: {why}"), None),
                None => {}
            }
        });
    }

    /// Brakes whatever moves, and ends what the fingers do. Another program's simulated robot is
    /// stopped by its user stop.
    fn stop(self: &Arc<Self>) {
        if let Some(fingers) = &self.fingers {
            fingers.end();
        }
        match &self.source {
            Source::Watched(_) => self.disturb(Disturbance::UserStop { pressed: true }),
            Source::Robot(robot) => {
                if self.stopping.swap(true, Ordering::Relaxed) {
                    return; // one is under way
                }
                let (robot, hub) = (robot.clone(), self.clone());
                tokio::spawn(async move {
                    let stopped = robot.stop().await;
                    hub.stopping.store(false, Ordering::Relaxed);
                    match stopped {
                        Ok(()) => hub.tell(Level::Warning, "Stopped by a viewer".into(), None),
                        Err(error) => hub.tell(Level::Error, format!("Stop: {error}"), None),
                    }
                });
            }
        }
    }

    fn disturb(self: &Arc<Self>, disturbance: Disturbance) {
        if let Some(simulated) = self.simulated.clone() {
            let hub = self.clone();
            tokio::spawn(async move {
                if let Err(why) = simulated.disturb(disturbance).await {
                    hub.tell(Level::Warning, format!("Not done: {why}"), None);
                }
            });
        }
    }
}

async fn recover(robot: Robot, hub: Arc<Hub>) {
    if let Err(error) = robot.recover().await {
        hub.tell(Level::Error, format!("Recovery: {error}"), None);
    }
}

/// Ends holds and leases that have gone silent.
async fn watch_silence(hub: Weak<Hub>) {
    let mut clock = interval(Duration::from_millis(10));
    clock.set_missed_tick_behavior(MissedTickBehavior::Skip);
    loop {
        clock.tick().await;
        let Some(hub) = hub.upgrade() else { return };
        hub.tick();
    }
}

/// Estimates contacts while there are viewers.
async fn watch_contacts(hub: Weak<Hub>) {
    let mut clock = interval(contact::EVERY);
    clock.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let mut watch = contact::Watch::default();
    loop {
        clock.tick().await;
        let Some(hub) = hub.upgrade() else { return };
        if hub.contact.receiver_count() == 0 {
            watch = contact::Watch::default();
            continue;
        }
        let newest = watch.update(hub.source.model(), &hub.source.newest().state);
        hub.contact.send_if_modified(|contact| {
            let changed = *contact != newest;
            *contact = newest;
            changed
        });
    }
}

async fn tell_events(mut events: franka_async::supervision::Events, hub: Weak<Hub>) {
    while let Some(notification) = events.next().await {
        let Some(hub) = hub.upgrade() else { return };
        if let Some((level, text, detail)) = news::of_event(&notification.event.kind) {
            hub.tell(level, text, detail);
        }
    }
}

/// Copies the states of a simulated robot that another program controls, and tells of changes.
async fn follow_simulation(simulated: Simulated, hub: Weak<Hub>) {
    let copy = |state| {
        let Some(hub) = hub.upgrade() else {
            return false;
        };
        if let Source::Watched(watched) = &hub.source {
            let before = hub.source.newest().state;
            if let Some((level, text, detail)) = news::of_states(&before, &state) {
                hub.tell(level, text, detail);
            }
            watched.set(state);
        }
        true
    };
    simulated.copy_to(copy).await;
}

/// Events that a viewer may lag behind before it misses some.
const NEWS: usize = 64;

/// Viewers at once.
const VIEWERS_MAX: usize = 256;
