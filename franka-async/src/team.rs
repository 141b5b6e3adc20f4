//! Several arms that move together: motions with a common start, one stop for all, and one outcome
//! for each arm.
//!
//! ```text
//!             +-- Arm 0 --> session, real-time thread 0 <--+
//!  Team ------+                                            |  one atomic word
//!             +-- Arm 1 --> session, real-time thread 1 <--+
//! ```
//!
//! The real-time threads of the arms share one atomic word, which each thread reads once in each
//! cycle. Therefore the arms begin within a millisecond of each other. If one arm has a fault, the
//! others brake within two of their cycles after the thread of that arm has seen the fault, even
//! while the runtime is busy. [`MemberFault`] lists the faults. It is no fault if an arm arrives,
//! or if its [condition](crate::condition) becomes true.
//!
//! ```no_run
//! use franka_async::team::Team;
//! use franka_async::{Engage, Pose, Robot};
//!
//! # async fn run(left: Robot, right: Robot) -> Result<(), Box<dyn std::error::Error>> {
//! let team = Team::engage([(&left, Engage::default()), (&right, Engage::default())]).await?;
//! let up = Pose::translation(0.0, 0.0, 0.1);
//! let [one, other] = team.move_to([up * left.pose(), up * right.pose()]).await;
//! println!("{:?}, {:?}", one?.duration, other?.duration);
//! team.disengage().await;
//! # Ok(())
//! # }
//! ```

mod grasp;

use std::future::{Future, IntoFuture};
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll};
use std::time::Duration;

use franka_rt::lifecycle::{MotionError, MotionReport};
use franka_rt::team::{Coordinator, Member, Round, team_tolerating};
use futures::future::join_all;

pub use grasp::Grasp;

pub use franka_rt::team::{MEMBERS_MAX, MemberFault, SILENCE, START_TIMEOUT, TeamStop};

use crate::arm::{Arm, Engage};
use crate::destination::Destination;
use crate::error::any::Error;
use crate::motion::Follow;
use crate::move_to::Motion;
use crate::robot::Robot;

type Outcome = Result<MotionReport, MotionError>;

/// `N` arms with one session each, and one stop for all. Members are numbered from 0, in the order
/// in which they were given.
///
/// The [`arms`](Self::arms) can also be moved alone. Such a motion does not wait for the other
/// arms, and its end does not affect them. But every motion of a member, even outside a team
/// motion, brakes when the team is stopped. It also brakes when the session of another member ends
/// in any way other than [`Arm::disengage`]. A motion that begins later is not affected.
///
/// Dropping the team brakes all arms and ends their sessions in the background, unless other
/// handles of the arms exist.
#[derive(Debug)]
#[must_use = "dropping the team brakes its arms"]
pub struct Team<const N: usize> {
    arms: [Arm; N],
    coordinator: Coordinator,
    /// This lock is held while the goals of a team motion are sent, so that all arms get the goals
    /// of two motions in the same order.
    submission: Arc<Mutex<()>>,
}

/// Error of the caller, the robot or the link: an arm did not join its team.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("member {member} of the team: {error}")]
pub struct NotEngaged {
    /// Number of the member whose arm could not be engaged.
    pub member: usize,
    /// Reason why the arm could not be engaged.
    #[source]
    pub error: MotionError,
}

impl From<NotEngaged> for Error {
    fn from(error: NotEngaged) -> Self {
        error.error.into()
    }
}

impl<const N: usize> Team<N> {
    /// Begins a session for each robot, as [`Robot::engage`] does, and resolves when all sessions
    /// have begun. If one session does not begin, the others end.
    ///
    /// # Errors
    /// Returns [`NotEngaged`] with the first member whose session did not begin, and the reason.
    ///
    /// # Cancel safety
    /// Dropping the future ends all sessions, in the background.
    pub async fn engage(robots: [(&Robot, Engage); N]) -> Result<Self, NotEngaged> {
        Self::engage_tolerating(SILENCE, robots).await
    }

    /// Engages the arms as [`Self::engage`] does, but sets how long a robot may be silent before
    /// the other robots brake; the default is [`SILENCE`]. Use this for simulators on a busy
    /// machine. A real robot stops on its own after 20 ms without commands.
    ///
    /// # Errors
    /// See [`Self::engage`].
    ///
    /// # Cancel safety
    /// See [`Self::engage`].
    pub async fn engage_tolerating(
        silence: Duration,
        robots: [(&Robot, Engage); N],
    ) -> Result<Self, NotEngaged> {
        let (coordinator, members) = team_tolerating::<N>(silence);
        let engage = |((robot, engage), member): ((&Robot, Engage), Member)| {
            let robot = robot.clone();
            async move { robot.engage(engage.in_team(member)).await }
        };
        let engaging: Vec<_> = robots.into_iter().zip(members).map(engage).collect();
        let mut arms = Vec::with_capacity(N);
        for (member, arm) in join_all(engaging).await.into_iter().enumerate() {
            arms.push(arm.map_err(|error| NotEngaged { member, error })?);
        }
        Ok(Self {
            arms: arms.try_into().expect("one for each robot"),
            coordinator,
            submission: Arc::default(),
        })
    }

    /// Returns the arms, in the order of the members.
    pub fn arms(&self) -> &[Arm; N] {
        &self.arms
    }

    /// Returns a motion of all arms, each to its own destination; see [`Arm::move_to`]. For other
    /// options, use [`Self::run`].
    pub fn move_to<D: Into<Destination>>(&self, destinations: [D; N]) -> TeamMotion<N> {
        let mut destinations = destinations.into_iter();
        self.run(|_, arm| {
            let destination = destinations.next().expect("one for each arm");
            arm.move_to(destination)
        })
    }

    /// Returns a motion of all arms. `motion` is called for each member with its arm, and returns
    /// the motion of that member. All motions begin together, once the goals of all members have
    /// arrived; until then, an arm that moves continues. If some members follow targets and others
    /// do not, convert each motion `into` a [`MemberMotion`].
    ///
    /// If one member has a fault, the others brake and resolve as [`MotionError::Braked`] with
    /// [`Lapse::Team`](crate::error::Lapse::Team), which names the faulty member. All arms are held
    /// where they stop. If one motion is refused or cancelled before the start, no arm begins its
    /// motion.
    ///
    /// # Panics
    /// Panics if a motion was not made by the arm that is given for it.
    pub fn run<M: Into<MemberMotion>>(
        &self,
        mut motion: impl FnMut(usize, &Arm) -> M,
    ) -> TeamMotion<N> {
        let motions = core::array::from_fn(|member| {
            let arm = &self.arms[member];
            let motion = motion(member, arm).into();
            assert!(
                motion.is_of(arm),
                "the motion of member {member} must be made by the arm of that member"
            );
            motion
        });
        TeamMotion {
            coordinator: self.coordinator.clone(),
            submission: self.submission.clone(),
            stage: Stage::Ready(motions),
        }
    }

    /// Brakes all arms, each within two of its cycles, even while the runtime is busy, because the
    /// real-time threads see the stop directly. Motions resolve as [`MotionError::Braked`] with
    /// [`TeamStop::Requested`]. The sessions continue and hold the arms.
    ///
    /// A newer motion does not cancel the stop. A team motion that is requested before every arm
    /// has seen the stop does not start, and resolves in the same way.
    pub fn stop(&self) {
        self.coordinator.stop();
    }

    /// Brakes all arms as [`Self::stop`] does, ends their sessions, and latches the stop of each
    /// robot: see [`Robot::latch_stop`]. Until the stop is released, team motions and motions of
    /// single arms are refused. Returns the outcome of the stop of each arm.
    ///
    /// # Cancel safety
    /// Once the future has been polled, the stops are latched and all arms are braked, even if the
    /// future is then dropped.
    pub async fn latch_stop(&self) -> [Result<(), MotionError>; N] {
        self.coordinator.stop();
        let stops = self.arms.iter().map(|arm| arm.robot().latch_stop());
        let stops = join_all(stops).await;
        stops.try_into().expect("one for each arm")
    }

    /// Releases the latched stop of each robot: see [`Robot::release_stop`]. The sessions have
    /// ended, so the next motions need a new team. Returns true if a stop was latched.
    pub fn release_stop(&self) -> bool {
        let release = |released, arm: &Arm| arm.robot().release_stop() | released;
        self.arms.iter().fold(false, release)
    }

    /// Returns a handle that stops the team from any task or thread.
    pub fn stopper(&self) -> Stopper {
        Stopper(self.coordinator.clone())
    }

    /// Returns the reason why the newest team motion, or a motion after it, was stopped; `None` if
    /// no such motion was stopped.
    pub fn stopped(&self) -> Option<TeamStop> {
        self.coordinator.stopped()
    }

    /// Brakes and releases all arms and ends their sessions. Resolves when all sessions have ended,
    /// with the outcome of each: see [`Arm::disengage`].
    ///
    /// # Cancel safety
    /// Once the future has been polled, the sessions end, even if the future is then dropped.
    pub async fn disengage(self) -> [Outcome; N] {
        let ended = join_all(self.arms.map(Arm::disengage)).await;
        ended.try_into().expect("one for each arm")
    }
}

/// A handle that stops a team. It does not keep the sessions open.
#[derive(Clone, Debug)]
pub struct Stopper(Coordinator);

impl Stopper {
    /// Stops the team: see [`Team::stop`]. This never waits, and may be called on any thread.
    pub fn stop(&self) {
        self.0.stop();
    }
}

/// Motion of one member in a team motion.
#[derive(Debug)]
#[must_use = "a motion does nothing until it is awaited"]
#[non_exhaustive]
pub enum MemberMotion {
    /// The member moves to one target.
    Motion(Motion),
    /// The member follows a stream of targets. It is ready for the start when the first target has
    /// come.
    Follow(Follow),
}

impl From<Motion> for MemberMotion {
    fn from(motion: Motion) -> Self {
        Self::Motion(motion)
    }
}

impl From<Follow> for MemberMotion {
    fn from(follow: Follow) -> Self {
        Self::Follow(follow)
    }
}

type Running = Pin<Box<dyn Future<Output = Outcome> + Send>>;

impl MemberMotion {
    fn is_of(&self, arm: &Arm) -> bool {
        match self {
            Self::Motion(motion) => arm.owns(motion.session()),
            Self::Follow(follow) => arm.owns(follow.session()),
        }
    }

    fn begin(self, round: Round) -> Running {
        match self {
            Self::Motion(motion) => Box::pin(motion.in_round(round).into_future()),
            Self::Follow(follow) => follow.in_round(round).into_future(),
        }
    }
}

/// A motion of all arms of a team as a future. The motion begins with the first poll. The future
/// resolves when the motions of all members have ended, with the outcomes in the order of the
/// members.
///
/// A newer team motion supersedes this one. Motions of members that are under way continue until
/// the newer team motion begins.
///
/// # Cancel safety
/// Dropping the future, at any time, brakes all arms, each within two of its cycles; the arms are
/// then held where they stop. Dropping it before the first poll has no effect.
///
/// # Panics
/// Panics if polled after it has resolved, as futures may.
#[must_use = "futures do nothing unless polled"]
pub struct TeamMotion<const N: usize> {
    coordinator: Coordinator,
    submission: Arc<Mutex<()>>,
    stage: Stage<N>,
}

enum Stage<const N: usize> {
    Ready([MemberMotion; N]),
    Begun {
        round: Round,
        members: [Result<Outcome, Running>; N],
    },
    Over,
}

impl<const N: usize> Future for TeamMotion<N> {
    type Output = [Outcome; N];

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<[Outcome; N]> {
        let Self {
            coordinator,
            submission,
            stage,
        } = &mut *self;
        let (round, mut members, _first) = match std::mem::replace(stage, Stage::Over) {
            Stage::Ready(motions) => {
                // A panic cannot leave the submission half done.
                let first = submission.lock().unwrap_or_else(PoisonError::into_inner);
                let round = coordinator.begin();
                let members = motions.map(|motion| Err(motion.begin(round)));
                (round, members, Some(first))
            }
            Stage::Begun { round, members } => (round, members, None),
            Stage::Over => panic!("a motion is not polled after it has resolved"),
        };
        for (number, member) in members.iter_mut().enumerate() {
            if let Err(running) = member
                && let Poll::Ready(outcome) = running.as_mut().poll(context)
            {
                // The thread has reported this already, unless the goal never reached it.
                if outcome.is_err() {
                    coordinator.refuse(round, number);
                }
                *member = Ok(outcome);
            }
        }
        if members.iter().any(Result::is_err) {
            *stage = Stage::Begun { round, members };
            return Poll::Pending;
        }
        let ended = |member: Result<Outcome, Running>| member.ok().expect("all have ended");
        Poll::Ready(members.map(ended))
    }
}

impl<const N: usize> Drop for TeamMotion<N> {
    fn drop(&mut self) {
        if let Stage::Begun { round, .. } = self.stage {
            self.coordinator.take_back(round);
        }
    }
}

impl<const N: usize> std::fmt::Debug for TeamMotion<N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TeamMotion")
            .field("coordinator", &self.coordinator)
            .finish_non_exhaustive()
    }
}
