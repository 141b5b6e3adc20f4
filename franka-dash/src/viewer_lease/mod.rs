//! The lease of a viewer who moves the arm, with its time limits, as a state machine without clock
//! and sockets.
//!
//! ```text
//!             take                begin                 hold 1, 2, 3 .. in time
//!  free ───────────────> leased ──────────> holding ─────────────────────────┐
//!    ^  release, silence,   ^                │    ^──────────────────────────┘
//!    └─ socket closed       └── end, gap, silence, stop, arrival, socket closed
//! ```
//!
//! The inputs are requests and the time ([`ViewerLease::handle`], [`ViewerLease::tick`]). The
//! outputs are effects and refusals. Time may count from any moment. If the time decreases, it
//! counts as unchanged.
//!
//! The lease (the exclusive right to move the arm) belongs to the robot, so other services can have
//! it too. During a hold, the arm moves while a viewer holds a button. When a hold has ended, only
//! another `Begin` moves the arm.

mod refusal;
#[cfg(test)]
mod tests;

use core::time::Duration;
use std::time::Instant;

pub(crate) use refusal::Refusal;

use franka_async::connection::lease::{Holder, Lease};
use serde::Serialize;

use crate::request::{Disturbance, GripperAction, Motion, Request, Tuning};

pub(crate) type ViewerId = u64;

/// The kinds of requests that the server accepts from viewers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Permissions {
    /// True if viewers may move and recover the robot.
    pub(crate) motion: bool,
    /// True if viewers may disturb a simulated robot.
    pub(crate) disturbances: bool,
    /// True if viewers may move the fingers. This also requires `motion`.
    pub(crate) gripper: bool,
    pub(crate) recording: bool,
    /// Additional time for late messages. It is zero unless the robot is simulated.
    pub(crate) patience: Duration,
}

/// The current commander (the viewer that may move the arm) and the commander's hold.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Status {
    /// Number of the viewer that has the lease; `None` if no viewer has it.
    pub(crate) commander: Option<u64>,
    /// Name of the holder of the lease.
    pub(crate) name: Option<String>,
    pub(crate) holding: bool,
    /// True if the commander's last hold ended because a message was late.
    pub(crate) expired: bool,
}

impl Permissions {
    /// Returns true if the server accepts any command.
    pub(crate) fn any(&self) -> bool {
        self.motion || self.disturbances || self.recording
    }
}

/// An action that the server must perform.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Effect {
    /// Begin the motion of this hold.
    Begin {
        hold: u64,
        motion: Motion,
        speed: f64,
    },
    /// Preview a motion.
    Preview {
        number: u32,
        motion: Motion,
        speed: f64,
    },
    /// Keep the deadman of the hold alive.
    KeepAlive,
    /// Brake any motion, including the motions of other programs.
    Stop,
    Recover,
    /// Set the stiffness of the arm for this hold and all later holds.
    Tune(Tuning),
    /// Take a tare (the zero) of the wrench, or clear it.
    Tare(bool),
    /// Continue at this speed, `[m/s]`.
    Speed(f64),
    Gripper(GripperAction),
    /// Begin or end a recording.
    Record(bool),
    Disturb(Disturbance),
}

/// Reason why a hold ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum Lost {
    #[error("the button was released")]
    LetGo,
    #[error("the page sent no keep-alive for 150 ms")]
    Silent,
    #[error("a keep-alive of the page is out of sequence: got number {got}, expected {expected}")]
    Sequence { expected: u32, got: u32 },
    #[error("the connection of the commanding page has closed")]
    Disconnected,
    #[error("the commanding page has released the lease")]
    Released,
    #[error("another motion was requested while the button was held")]
    Replaced,
    #[error("stopped by a viewer")]
    Stopped,
}

/// Result of a request.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Step {
    /// Reason why the hold ended, if it did. The server must brake before it performs the effect.
    pub(crate) ended: Option<Lost>,
    pub(crate) effect: Option<Effect>,
    pub(crate) refusal: Option<Refusal>,
}

/// The state machine; see the [module](self).
#[derive(Debug)]
pub(crate) struct ViewerLease {
    permissions: Permissions,
    lease: Lease,
    /// Instant that corresponds to the time zero.
    start: Instant,
    now: Duration,
    commander: Option<Commander>,
    holds: u64,
}

/// The viewer that has the lease, and this viewer's hold.
#[derive(Debug)]
struct Commander {
    viewer: ViewerId,
    holder: Holder,
    hold: Option<Hold>,
    expired: bool,
}

#[derive(Debug)]
struct Hold {
    number: u64,
    seq: u32,
    heard: Duration,
}

impl ViewerLease {
    /// Creates the lease of the viewers, which uses the robot's `lease`. Times are relative to
    /// `start`.
    pub(crate) fn new(permissions: Permissions, lease: Lease, start: Instant) -> Self {
        Self {
            permissions,
            lease,
            start,
            now: Duration::ZERO,
            commander: None,
            holds: 0,
        }
    }

    pub(crate) fn status(&self) -> Status {
        let commander = self.commander.as_ref();
        Status {
            commander: commander.map(|commander| commander.viewer),
            name: self.lease.holder(self.instant()),
            holding: commander.is_some_and(|commander| commander.hold.is_some()),
            expired: commander.is_some_and(|commander| commander.expired),
        }
    }

    fn instant(&self) -> Instant {
        self.start + self.now
    }

    /// Processes a request of a viewer. `round_trip` is the newest measured round trip to this
    /// viewer; `None` if it was not measured recently.
    pub(crate) fn handle(
        &mut self,
        now: Duration,
        viewer: ViewerId,
        round_trip: Option<Duration>,
        request: Request,
    ) -> Step {
        // A late request must not continue a hold that has expired.
        let mut silent = self.tick(now);
        let now = self.instant();
        if let Some(commander) = self.commander_mut(viewer)
            && commander.holder.keep_alive(now).is_err()
        {
            // Another service has checked the lease since `now`.
            silent = silent.or(self.lose());
        }
        let valid = request.check().map_err(Refusal::Value);
        let step = match request {
            Request::Stop {} => {
                let commander = self.commander.as_mut();
                let hold = commander.and_then(|commander| commander.hold.take());
                Ok(Step {
                    ended: hold.map(|_| Lost::Stopped),
                    ..effect(Effect::Stop)
                })
            }
            Request::Seen { .. } => Ok(Step::default()),
            Request::Take { name } => valid.and_then(|()| self.take(viewer, name)),
            request => self.commanded(viewer, round_trip, request, valid),
        };
        let step = step.unwrap_or_else(|refusal| Step {
            refusal: Some(refusal),
            ..Step::default()
        });
        Step {
            ended: silent.or(step.ended),
            ..step
        }
    }

    /// Ends holds and leases that have been silent for too long. Call this function every few
    /// milliseconds.
    pub(crate) fn tick(&mut self, now: Duration) -> Option<Lost> {
        self.now = self.now.max(now);
        let (deadman, now) = (DEADMAN + self.permissions.patience, self.instant());
        let commander = self.commander.as_mut()?;
        let silent = |hold: &mut Hold| self.now - hold.heard > deadman;
        let lost = commander.hold.take_if(silent).map(|_| Lost::Silent);
        commander.expired |= lost.is_some();
        match commander.holder.is_held(now) {
            true => lost,
            false => lost.or(self.lose()),
        }
    }

    /// Ends the command of a viewer that has lost the lease. Returns the reason if a hold ended.
    fn lose(&mut self) -> Option<Lost> {
        let commander = self.commander.take()?;
        commander.hold.map(|_| Lost::Silent)
    }

    /// Processes the disconnection of a viewer.
    pub(crate) fn gone(&mut self, viewer: ViewerId) -> Option<Lost> {
        let commander = self.commander.take_if(|it| it.viewer == viewer)?;
        commander.hold.map(|_| Lost::Disconnected)
    }

    /// Processes the end of a hold's motion.
    pub(crate) fn ended(&mut self, number: u64) {
        if let Some(commander) = &mut self.commander {
            commander.hold.take_if(|hold| hold.number == number);
        }
    }

    fn take(&mut self, viewer: ViewerId, name: String) -> Result<Step, Refusal> {
        if !self.permissions.any() {
            return Err(Refusal::ViewOnly);
        }
        if self.commander_mut(viewer).is_none() {
            let silence = LEASE + self.permissions.patience;
            let holder = self.lease.take(name, silence, self.instant())?;
            self.commander = Some(Commander {
                viewer,
                holder,
                hold: None,
                expired: false,
            });
        }
        Ok(Step::default())
    }

    fn commander_mut(&mut self, viewer: ViewerId) -> Option<&mut Commander> {
        self.commander.as_mut().filter(|it| it.viewer == viewer)
    }

    /// Processes a request that only the commander may make.
    fn commanded(
        &mut self,
        viewer: ViewerId,
        round_trip: Option<Duration>,
        request: Request,
        valid: Result<(), Refusal>,
    ) -> Result<Step, Refusal> {
        let may = self.permissions;
        let now = self.now;
        let commander = self.commander.as_mut().filter(|it| it.viewer == viewer);
        let commander = commander.ok_or(Refusal::NoLease)?;
        if let Request::Begin { .. } = request
            && let hold @ Some(_) = commander.hold.take()
        {
            return Ok(Step {
                refusal: Some(Refusal::Holding),
                ..ended(hold, Lost::Replaced)
            });
        }
        valid?;
        Ok(match request {
            Request::Release {} => {
                let hold = commander.hold.take();
                self.commander = None;
                ended(hold, Lost::Released)
            }
            Request::Begin { motion, speed } => {
                if !may.motion {
                    return Err(Refusal::ViewOnly);
                }
                match round_trip {
                    None => return Err(Refusal::Unmeasured),
                    Some(got) if got > ROUND_TRIP_MAX + may.patience => {
                        return Err(Refusal::Latency(got));
                    }
                    Some(_) => {}
                }
                self.holds += 1;
                commander.expired = false;
                commander.hold = Some(Hold {
                    number: self.holds,
                    seq: 0,
                    heard: now,
                });
                effect(Effect::Begin {
                    hold: self.holds,
                    motion,
                    speed,
                })
            }
            Request::Hold { seq } => {
                let hold = commander.hold.as_mut().ok_or(Refusal::NoHold)?;
                let expected = hold.seq.saturating_add(1);
                if seq != expected {
                    let lost = Lost::Sequence { expected, got: seq };
                    return Ok(ended(commander.hold.take(), lost));
                }
                hold.seq = seq;
                hold.heard = now;
                effect(Effect::KeepAlive)
            }
            // The request has no effect if the motion has already ended.
            Request::End {} => ended(commander.hold.take(), Lost::LetGo),
            Request::Speed { .. } if commander.hold.is_none() => return Err(Refusal::NoHold),
            Request::Speed { speed } => effect(Effect::Speed(speed)),
            Request::Disturb { disturbance } if may.disturbances => {
                effect(Effect::Disturb(disturbance))
            }
            Request::Disturb { .. } => return Err(Refusal::NoSimulator),
            Request::Record { on } if may.recording => effect(Effect::Record(on)),
            Request::Record { .. } => return Err(Refusal::NoRecordings),
            Request::Gripper { .. } if !may.gripper => return Err(Refusal::NoGripper),
            Request::Preview { .. }
            | Request::Recover {}
            | Request::Tune { .. }
            | Request::Tare { .. }
            | Request::Gripper { .. }
                if !may.motion =>
            {
                return Err(Refusal::ViewOnly);
            }
            Request::Preview {
                number,
                motion,
                speed,
            } => effect(Effect::Preview {
                number,
                motion,
                speed,
            }),
            Request::Recover {} => effect(Effect::Recover),
            Request::Tune { tuning } => effect(Effect::Tune(tuning)),
            Request::Tare { on } => effect(Effect::Tare(on)),
            Request::Gripper { action } => effect(Effect::Gripper(action)),
            Request::Alive {} | Request::Seen { .. } | Request::Take { .. } | Request::Stop {} => {
                Step::default()
            }
        })
    }
}

fn effect(effect: Effect) -> Step {
    Step {
        effect: Some(effect),
        ..Step::default()
    }
}

/// Returns the step that reports the end of a hold. If no hold was active, the step is empty.
fn ended(hold: Option<Hold>, lost: Lost) -> Step {
    Step {
        ended: hold.map(|_| lost),
        ..Step::default()
    }
}

/// Silence after which a hold ends. The page sends a message every 50 ms, so two messages can be
/// late.
pub(crate) const DEADMAN: Duration = Duration::from_millis(150);

/// Silence after which another viewer may take the lease.
pub(crate) const LEASE: Duration = Duration::from_secs(5);

/// Longest round trip to a viewer at which a motion may begin.
pub(crate) const ROUND_TRIP_MAX: Duration = Duration::from_millis(100);

const _: () = assert!(DEADMAN.as_millis() <= 200);
