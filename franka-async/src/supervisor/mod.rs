//! Supervision of a robot: connects the state machine `franka_rt::supervision` to the handles, to
//! the bridge of the newest connection, and to the task that reconnects and recovers.
//!
//! Handles and bridge call the supervisor. Therefore it knows of a mishap before the affected
//! motion resolves. Its lock is held for some microseconds at a time, and never on the control
//! thread.

mod events;

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

use franka_proto::{Request, RobotState};
use franka_rt::lifecycle::{CloseReason, MotionError, NewMotion, Outcome};
use franka_rt::sched::SchedError;
use franka_rt::session::GoalId;
use franka_rt::supervision::{
    Admission, Answer, Condition, ConnectFailure, Event, EventKind, Health, Output, Policy,
    RecoveryFailure, Reflex, SettingId, Supervision,
};
use tokio::sync::{Notify, broadcast, watch};

use crate::close::Closing;
use crate::input::{Beginning, Input, Replies};
#[cfg(feature = "record")]
use crate::journal::{Journal, What};
use crate::link::Link;
#[cfg(feature = "metrics")]
use crate::tally::Tally;
use crate::world::{self, Instant};

pub use events::{Events, Notification};

/// A job for the task that reconnects and recovers.
#[derive(Debug)]
pub(crate) enum Job {
    Connect,
    Disconnect { reason: CloseReason },
    Recover { reflex: u64 },
    Configure,
    Ask(Reflex),
}

/// Watches a robot, and decides when to reconnect and recover.
pub(crate) struct Supervisor {
    begun: Instant,
    is_supervised: bool,
    inner: Mutex<Inner>,
    health: watch::Receiver<Health>,
    /// Reason why no further connection will come.
    closing: Closing,
    /// Notified when there is a job, or the deadline has changed.
    work: Notify,
}

struct Inner {
    core: Supervision,
    /// Connection on which a waiting motion begins. The reference is weak, because a waiting motion
    /// does not keep the connection open.
    link: Weak<Link>,
    waiting: Option<Waiting>,
    refused: Vec<Refused>,
    jobs: VecDeque<Job>,
    /// Sender of events; `None` once closed, like the sender of health.
    events: Option<broadcast::Sender<Event>>,
    health: Option<watch::Sender<Health>>,
    #[cfg(feature = "metrics")]
    tally: Tally,
    #[cfg(feature = "record")]
    journal: Journal,
}

/// A motion that waits until the robot is ready.
struct Waiting {
    motion: Beginning,
    replies: Replies,
    /// True if the stream of targets of this motion has ended.
    is_closed: bool,
}

/// A motion that is refused. It is dropped without holding the lock, because it may own values of
/// the user.
struct Refused {
    motion: Beginning,
    replies: Replies,
    error: MotionError,
}

impl Supervisor {
    /// Returns a supervisor for a robot that is about to be connected to. Without a policy, it only
    /// watches.
    pub(crate) fn new(policy: Option<Policy>) -> Self {
        let core = Supervision::new(policy);
        let (health, shown) = watch::channel(core.health());
        Self {
            begun: world::now(),
            is_supervised: policy.is_some(),
            inner: Mutex::new(Inner {
                core,
                link: Weak::new(),
                waiting: None,
                refused: Vec::new(),
                jobs: VecDeque::new(),
                events: Some(broadcast::channel(events::CAPACITY).0),
                health: Some(health),
                #[cfg(feature = "metrics")]
                tally: Tally::default(),
                #[cfg(feature = "record")]
                journal: Journal::default(),
            }),
            health: shown,
            closing: Closing::default(),
            work: Notify::new(),
        }
    }

    /// True if there is no connection and will be no other one.
    pub(crate) fn is_closed(&self) -> bool {
        self.lock().core.health().condition == Condition::Closed
    }

    /// True if there is a connection, or an earlier connection still holds resources.
    pub(crate) fn is_connected(&self) -> bool {
        self.lock().core.has_connection()
    }

    /// True if lost connections and reflexes are handled, not only reported.
    pub(crate) fn is_supervised(&self) -> bool {
        self.is_supervised
    }

    pub(crate) fn closing(&self) -> &Closing {
        &self.closing
    }

    pub(crate) fn events(&self) -> Events {
        let inner = self.lock();
        Events::new(match &inner.events {
            Some(events) => events.subscribe(),
            // The supervision has ended, so return a closed channel.
            None => broadcast::channel(1).1,
        })
    }

    pub(crate) fn health(&self) -> watch::Receiver<Health> {
        self.health.clone()
    }

    #[cfg(feature = "record")]
    pub(crate) fn journal(&self) -> Journal {
        self.lock().journal.clone()
    }

    #[cfg(feature = "metrics")]
    pub(crate) fn tally(&self) -> Tally {
        self.lock().tally.clone()
    }

    /// Accepts a connection that has just been made. Returns false if no connection is wanted any
    /// more.
    pub(crate) fn on_connected(
        &self,
        link: &Arc<Link>,
        state: &RobotState,
        refusals: &[SchedError],
    ) -> bool {
        // Announce the connection before anything begins on it.
        #[cfg(feature = "record")]
        self.journal().connected(&link.cycles);
        self.with(|inner, now| {
            inner.link = Arc::downgrade(link);
            inner
                .core
                .on_connected(link.description, state, refusals, now)
        })
    }

    pub(crate) fn on_connect_failed(&self, failure: ConnectFailure) {
        self.with(|inner, now| inner.core.on_connect_failed(failure, now));
    }

    /// Reads the newest state, as all other methods do first.
    pub(crate) fn observe(&self) {
        self.with(|_, _| ());
    }

    pub(crate) fn on_silence(&self, silence: Duration) {
        self.with(|inner, now| inner.core.on_silence(silence, now));
    }

    pub(crate) fn on_lost(&self, reason: CloseReason) {
        self.with(|inner, now| inner.core.on_lost(reason, now));
    }

    pub(crate) fn on_released(&self) {
        self.with(|inner, now| inner.core.on_released(now));
    }

    pub(crate) fn on_recovery(&self, reflex: u64, answer: Result<(), RecoveryFailure>) {
        self.with(|inner, now| inner.core.on_recovery(reflex, answer, now));
    }

    /// Notes a setting that is about to be sent over the connection that `newest` returns. Returns
    /// that connection, and the identifier for [`Self::on_set`].
    pub(crate) fn declare(
        &self,
        request: Request,
        newest: impl FnOnce() -> Arc<Link>,
    ) -> (Arc<Link>, SettingId) {
        self.with(|inner, _| (newest(), inner.core.declare(request)))
    }

    pub(crate) fn on_set(&self, id: SettingId, answer: &Answer) {
        self.with(|inner, now| inner.core.on_set(id, answer, now));
    }

    pub(crate) fn next_setting(&self) -> Option<(SettingId, Request)> {
        self.with(|inner, now| inner.core.next_setting(now))
    }

    pub(crate) fn on_set_again(&self, id: SettingId, answer: Answer) {
        self.with(|inner, _| inner.core.on_set_again(id, answer));
    }

    pub(crate) fn on_ended(&self, goal: GoalId, outcome: &Outcome) {
        #[cfg(feature = "doctor")]
        if let Err(error) = outcome {
            let link = self.lock().link.upgrade();
            if let Some(link) = link {
                crate::doctor::warn(error, link.address.ip());
            }
        }
        self.with(|inner, now| {
            #[cfg(feature = "record")]
            inner.journal.ended(goal, outcome);
            inner.core.on_ended(goal, outcome, now);
        });
    }

    /// Records in the journal the end of a goal or program that the supervision does not follow.
    #[cfg(feature = "record")]
    pub(crate) fn write_down(&self, goal: GoalId, outcome: &Outcome) {
        self.with(|inner, _| inner.journal.ended(goal, outcome));
    }

    pub(crate) fn on_time(&self) {
        self.with(|inner, now| inner.core.on_time(now));
    }

    pub(crate) fn close(&self, reason: CloseReason) {
        self.with(|inner, now| inner.core.close(reason, now));
    }

    pub(crate) fn agree(&self, reflex: u64, agreed: bool) -> bool {
        self.with(|inner, now| inner.core.agree(reflex, agreed, now))
    }

    pub(crate) fn release_stop(&self) -> bool {
        self.with(|inner, now| inner.core.release_stop(now))
    }

    pub(crate) fn is_stop_latched(&self) -> bool {
        self.lock().core.is_stop_latched()
    }

    /// See [`Supervision::check_latch`].
    pub(crate) fn check_latch(&self) -> Result<(), MotionError> {
        self.lock().core.check_latch()
    }

    /// Returns the time at which [`Self::on_time`] must be called; `None` also if no clock can show
    /// that time.
    pub(crate) fn deadline(&self) -> Option<Instant> {
        let after = self.lock().core.deadline()?;
        self.begun.checked_add(after)
    }

    pub(crate) fn take_job(&self) -> Option<Job> {
        self.lock().jobs.pop_front()
    }

    /// Waits until there is a job or the deadline has changed.
    ///
    /// # Cancel safety
    /// A notification is not lost: the next call returns at once.
    pub(crate) async fn worked(&self) {
        self.work.notified().await;
    }

    /// Passes an input to the bridge of the newest connection, or keeps the input with the waiting
    /// motion. Returns that connection, which `newest` looks up under the lock. A waiting motion
    /// also begins under the lock, so a cancel or a stop never goes to an older connection.
    pub(crate) fn pass(&self, input: Input, newest: impl FnOnce() -> Arc<Link>) -> Arc<Link> {
        self.with(|inner, now| {
            let link = newest();
            inner.pass(input, &link, now);
            link
        })
    }

    /// Applies `act` after the newest state was read, and then handles the consequences.
    fn with<T>(&self, act: impl FnOnce(&mut Inner, Duration) -> T) -> T {
        let mut inner = self.lock();
        let now = world::now() - self.begun;
        inner.observe(now);
        let result = act(&mut inner, now);
        inner.carry_out(&self.closing, now);
        let refused = std::mem::take(&mut inner.refused);
        drop(inner);
        self.work.notify_one();
        for Refused {
            motion,
            replies,
            error,
        } in refused
        {
            tracing::info!(goal = motion.motion.id().0, %error, "the motion did not begin");
            replies.ended.send(Err(error));
        }
        result
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        // Nothing panics while the lock is held.
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Inner {
    /// Shows the state machine the newest state. A motion that is requested right after a reflex
    /// then finds the robot in the reflex.
    fn observe(&mut self, now: Duration) {
        if let Some(link) = self.link.upgrade() {
            self.core.on_state(&link.newest.state(), now);
        }
    }

    fn pass(&mut self, input: Input, link: &Link, now: Duration) {
        #[cfg(feature = "record")]
        self.journal.asked(&input);
        let Some(input) = self.check_latch(input) else {
            return;
        };
        let input = match input {
            Input::Begin {
                mut motion,
                replies,
            } => {
                // A motion whose line could not be planned must not wait, because it would replace
                // another waiting motion.
                let unready = matches!(self.core.health().condition, Condition::Unready(_));
                if let Some(error) = motion.refused.take_if(|_| unready) {
                    let latched = self.core.check_latch().err();
                    let error = latched.unwrap_or_else(|| error.into());
                    self.refuse(motion, replies, error);
                    return;
                }
                match self.core.submit(&motion.motion, now) {
                    Admission::Begin => return self.begin(motion, replies, link, now),
                    Admission::Wait => {
                        tracing::info!(
                            goal = motion.motion.id().0,
                            "the motion waits until the robot is ready"
                        );
                        let waiting = Waiting {
                            motion,
                            replies,
                            is_closed: false,
                        };
                        if let Some(before) = self.waiting.replace(waiting) {
                            self.refuse(before.motion, before.replies, MotionError::Superseded);
                        }
                    }
                    Admission::Refuse(error) => self.refuse(motion, replies, error),
                }
                return;
            }
            Input::Update {
                goal,
                target,
                taken,
            } => match &mut self.waiting {
                Some(Waiting {
                    motion:
                        Beginning {
                            motion: NewMotion::Goal { goal: waiting, .. },
                            destination,
                            path,
                            refused: _,
                            joint_fallback: _,
                        },
                    ..
                }) if waiting.id == goal => {
                    (waiting.target, *destination, *path) = (target, None, None);
                    // The caller may have dropped the receiver.
                    let _ = taken.send(Ok(true));
                    return;
                }
                _ => Input::Update {
                    goal,
                    target,
                    taken,
                },
            },
            Input::Close { goal } => match &mut self.waiting {
                Some(waiting) if waiting.motion.motion.id() == goal => {
                    waiting.is_closed = true;
                    return;
                }
                _ => Input::Close { goal },
            },
            Input::Pause { goal, paused } => match &mut self.waiting {
                Some(Waiting {
                    motion:
                        Beginning {
                            motion: NewMotion::Goal { goal: waiting, .. },
                            ..
                        },
                    ..
                }) if waiting.id == goal => {
                    waiting.paused = paused;
                    return;
                }
                _ => Input::Pause { goal, paused },
            },
            Input::Cancel { goal, .. } if self.core.withdraw(goal) => {
                if let Some(Waiting {
                    motion, replies, ..
                }) = self.waiting.take()
                {
                    self.refuse(motion, replies, MotionError::Stopped);
                }
                return;
            }
            Input::Stop { latches, .. } => {
                match latches {
                    true => self.core.latch_stop(now),
                    false => self.core.stop(),
                }
                input
            }
            other => other,
        };
        link.send(input);
    }

    /// Answers an input that would move the arm while a stop is latched. Returns all other inputs.
    /// Motions that begin are refused where they are submitted.
    fn check_latch(&mut self, input: Input) -> Option<Input> {
        let Err(error) = self.core.check_latch() else {
            return Some(input);
        };
        // The callers may have dropped the receivers.
        match input {
            Input::Set { motion, taken } => {
                self.note_refused(motion.motion.id(), &error);
                let _ = taken.send(Err(error));
            }
            Input::SetNewest { waiting } => {
                if let Some(motion) = waiting.take() {
                    self.note_refused(motion.motion.id(), &error);
                }
            }
            Input::Chunk { goal, taken, .. } => {
                self.note_refused(goal.id, &error);
                let _ = taken.send(Err(error));
            }
            // The motion itself reports that it was stopped.
            Input::Update { taken, .. } => drop(taken.send(Ok(false))),
            input => return Some(input),
        }
        None
    }

    /// Records a goal that its session does not receive.
    fn note_refused(&self, goal: GoalId, error: &MotionError) {
        tracing::info!(goal = goal.0, %error, "goal refused");
        #[cfg(feature = "record")]
        self.journal.ended(goal, &Err(error.clone()));
    }

    fn begin(&mut self, motion: Beginning, replies: Replies, link: &Link, now: Duration) {
        let goal = motion.motion.id();
        // Note the motion before passing it on, because the robot must not be recovered until the
        // motion has ended.
        self.core.on_begun(goal, now);
        let sent = link.try_send(Input::Begin { motion, replies });
        if let Err(Input::Begin { motion, replies }) = sent {
            let error = link.closed();
            self.core.on_ended(goal, &Err(error.clone()), now);
            self.refuse(motion, replies, error);
        }
    }

    fn refuse(&mut self, motion: Beginning, replies: Replies, error: MotionError) {
        #[cfg(feature = "record")]
        self.journal.ended(motion.motion.id(), &Err(error.clone()));
        self.refused.push(Refused {
            motion,
            replies,
            error,
        });
    }

    /// Carries out the decisions of the state machine, in order, and publishes the robot's health.
    fn carry_out(&mut self, closing: &Closing, now: Duration) {
        // Compute the health first, so that a receiver of the event finds the health after that
        // event.
        let health = self.core.health();
        if let Some(shown) = &self.health {
            shown.send_if_modified(|before| std::mem::replace(before, health) != health);
        }
        while let Some(output) = self.core.poll() {
            match output {
                Output::Event(event) => self.tell(event, closing),
                Output::Connect => self.jobs.push_back(Job::Connect),
                Output::Disconnect { reason } => self.jobs.push_back(Job::Disconnect { reason }),
                Output::Recover { reflex } => self.jobs.push_back(Job::Recover { reflex }),
                Output::Configure => self.jobs.push_back(Job::Configure),
                Output::Ask(reflex) => self.jobs.push_back(Job::Ask(reflex)),
                Output::Begin { goal } => self.begin_waiting(goal, now),
                Output::Refuse { goal, error } => {
                    if let Some(waiting) = self.take_waiting(goal) {
                        self.refuse(waiting.motion, waiting.replies, error);
                    }
                }
            }
        }
        // No further events are sent.
        if self.events.is_none() {
            self.health = None;
        }
    }

    fn begin_waiting(&mut self, goal: GoalId, now: Duration) {
        let (Some(waiting), Some(link)) = (self.take_waiting(goal), self.link.upgrade()) else {
            // The last handle has just been dropped, and the future with it.
            return;
        };
        // A waiting motion begins only while its caller awaits it.
        if waiting.replies.ended.is_closed() {
            return self.refuse(waiting.motion, waiting.replies, MotionError::Stopped);
        }
        self.begin(waiting.motion, waiting.replies, &link, now);
        if waiting.is_closed {
            link.send(Input::Close { goal });
        }
    }

    fn take_waiting(&mut self, goal: GoalId) -> Option<Waiting> {
        self.waiting
            .take_if(|waiting| waiting.motion.motion.id() == goal)
    }

    fn tell(&mut self, event: Event, closing: &Closing) {
        #[cfg(feature = "metrics")]
        self.tally.note(&event.kind);
        #[cfg(feature = "record")]
        self.journal.write(|| Some(What::Event(event.clone())));
        let reason = match &event.kind {
            EventKind::Closed { reason } => Some(reason.clone()),
            _ => None,
        };
        if let Some(events) = &self.events {
            // Sending fails without listeners.
            let _ = events.send(event);
        }
        if let Some(reason) = reason {
            closing.note(reason);
            self.events = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};

    use super::*;

    /// A connection may be replaced after it was read and before the lock is taken.
    #[test]
    fn connection_of_an_input_is_looked_up_under_the_lock() {
        let supervisor = Supervisor::new(None);
        let (ended, _outcome) = tokio::sync::oneshot::channel();
        let stop = Input::Stop {
            goal: GoalId(1),
            latches: false,
            ended,
        };
        let cancel = Input::Cancel {
            goal: GoalId(2),
            refused: None,
        };
        for input in [stop, cancel] {
            let mut is_locked = false;
            let passed = catch_unwind(AssertUnwindSafe(|| {
                supervisor.pass(input, || {
                    is_locked = supervisor.inner.try_lock().is_err();
                    // This call replaces a connection in the test.
                    std::panic::resume_unwind(Box::new(()))
                })
            }));
            assert!(passed.is_err() && is_locked);
            supervisor.inner.clear_poison();
        }
    }

    #[test]
    fn a_deadline_that_no_clock_shows_is_none() {
        let silence = |silence| {
            let supervisor = Supervisor::new(Some(Policy::default().silence(silence)));
            supervisor.with(|inner, now| {
                let state = RobotState::default();
                inner.core.on_connected(None, &state, &[], now);
                inner.core.on_silence(Duration::from_secs(1), now);
            });
            supervisor.deadline()
        };
        assert!(silence(Duration::from_secs(3)).is_some());
        assert_eq!(silence(Duration::MAX), None);
    }
}
