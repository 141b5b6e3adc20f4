//! Motions: built, then awaited.

use std::future::IntoFuture;
use std::pin::Pin;
use std::task::{Context, Poll};

use franka_proto::MoveRequest;
use franka_rt::control::Callback;
use franka_rt::driver::Program;
use franka_rt::law::Gains;
use franka_rt::lifecycle::{Engagement, MotionError, MotionReport};
use franka_rt::session::{Budget, ForceCap, Goal, GoalError, GoalId, Tolerance};
use franka_rt::together::StartTicket;
use tokio::sync::oneshot;

use crate::input::Outcome;
use crate::{Arm, Robot};

/// What a motion does, on its way to the bridge.
#[derive(Debug)]
pub(crate) enum Work {
    Goal {
        goal: Box<Goal>,
        ticket: Option<StartTicket>,
        /// The session that it is for, if it is not to begin a motion of its own.
        within: Option<GoalId>,
    },
    Engage {
        goal: Box<Goal>,
        engagement: Engagement,
    },
    Control {
        id: GoalId,
        callback: Box<Callback>,
        request: Box<MoveRequest>,
        ticket: Option<StartTicket>,
    },
    Program {
        id: GoalId,
        program: Program,
        request: Box<MoveRequest>,
    },
    /// Was given options that are not accepted.
    Refused { id: GoalId, error: GoalError },
}

impl Work {
    /// Names it, and whoever awaits it.
    pub(crate) fn id(&self) -> GoalId {
        match self {
            Self::Goal { goal, .. } | Self::Engage { goal, .. } => goal.id,
            Self::Control { id, .. } | Self::Program { id, .. } | Self::Refused { id, .. } => *id,
        }
    }

    pub(crate) fn goal(goal: Goal, ticket: Option<StartTicket>, arm: Option<&Arm>) -> Self {
        Self::Goal {
            goal: Box::new(goal),
            ticket,
            within: arm.map(Arm::id),
        }
    }
}

/// The ticket of a motion that has not begun. A clone of the motion has none.
#[derive(Debug, Default)]
pub(crate) struct Held(pub(crate) Option<StartTicket>);

impl Clone for Held {
    fn clone(&self) -> Self {
        Self(None)
    }
}

/// A motion that has not begun: nothing is sent before it is awaited or detached. A clone is a
/// motion of its own, with its own [`canceller`](Self::canceller) and without the
/// [`start_with`](Self::start_with) of the original.
#[derive(Debug)]
#[must_use = "a motion does nothing until it is awaited or detached"]
pub struct Motion {
    robot: Robot,
    arm: Option<Arm>,
    goal: Goal,
    /// Why its speed is not accepted.
    refused: Option<GoalError>,
    ticket: Held,
}

impl Clone for Motion {
    fn clone(&self) -> Self {
        let goal = Goal {
            id: self.robot.next_goal(),
            ..self.goal
        };
        Self {
            robot: self.robot.clone(),
            arm: self.arm.clone(),
            goal,
            refused: self.refused,
            ticket: self.ticket.clone(),
        }
    }
}

impl Motion {
    pub(crate) fn new(robot: Robot, arm: Option<Arm>, goal: Goal) -> Self {
        let ticket = Held::default();
        Self {
            robot,
            arm,
            goal,
            refused: None,
            ticket,
        }
    }

    /// Walks the same path `factor` times as fast as by default: velocities scale with it,
    /// accelerations with its square, jerks with its cube. A factor that is not positive, or takes
    /// a limit beyond the robot's, is refused as [`GoalError::Speed`] when the motion begins.
    pub fn speed(mut self, factor: f64) -> Self {
        match self.goal.budget.at_speed(factor, self.robot.model()) {
            Ok(budget) => self.goal.budget = budget,
            Err(error) => self.refused = Some(error),
        }
        self
    }

    /// Replaces the limits of the motion; by default those of [`Budget::of`].
    pub fn limits(mut self, budget: Budget) -> Self {
        self.goal.budget = budget;
        self.refused = None;
        self
    }

    /// Sets the stiffness at the end effector, x y z `[N/m]` and about x y z `[N m/rad]`, base
    /// axes; dampings keep their ratio.
    pub fn stiffness(mut self, stiffness: [f64; 6]) -> Self {
        self.goal.gains = self.goal.gains.with_cartesian_stiffness(stiffness);
        self
    }

    /// Replaces the law and all gains; by default [`Gains::cartesian`] for poses and
    /// [`Gains::joint`] for joint positions. The law is [`Gains::law`]:
    /// [`Law::OperationalSpace`](crate::Law::OperationalSpace) moves the arm by the springs at the
    /// end effector, and gains without any are refused under it.
    pub fn gains(mut self, gains: Gains) -> Self {
        self.goal.gains = gains;
        self
    }

    /// Bounds the force with which springs and dampers press at the end effector, `[N]`, between 5
    /// and 200; by default [`DEFAULT_FORCE_CAP`](crate::DEFAULT_FORCE_CAP). What the arm carries
    /// without having been told counts: it sinks under more weight than the cap, and the motion
    /// does not arrive. Refused under
    /// [`Backend::RobotController`](crate::Backend::RobotController), which cannot keep it.
    pub fn force_cap(mut self, newtons: f64) -> Self {
        self.goal.force_cap = ForceCap::Newtons(newtons);
        self
    }

    /// Lets springs and dampers press with as much force as they come to. The reach of the springs
    /// still bounds theirs.
    pub fn without_force_cap(mut self) -> Self {
        self.goal.force_cap = ForceCap::Off;
        self
    }

    /// How near to the target counts as arrived; 1 mm and 1 mrad by default.
    pub fn tolerance(mut self, tolerance: Tolerance) -> Self {
        self.goal.tolerance = tolerance;
        self
    }

    /// Begins together with the motions of other robots: the robot starts the motion, and holds the
    /// arm until all that have a ticket of the same [`StartBarrier`](crate::StartBarrier) are
    /// there; then they begin within a millisecond of each other. Such a motion supersedes nothing:
    /// it is refused as [`MotionError::Busy`] while anything controls the arm. If the others do not
    /// all come, it resolves as [`MotionError::Start`], and the arm has not moved.
    ///
    /// # Cancel safety
    /// Dropped, stopped or superseded before the start, it lets the others go, with
    /// [`MotionError::Start`].
    pub fn start_with(mut self, ticket: StartTicket) -> Self {
        self.ticket = Held(Some(ticket));
        self
    }

    /// Begins the motion and lets it run without anybody who waits for it. How it ends is in the
    /// log. It is no handle: the last handle of its session or robot, dropped, still brakes it.
    pub fn detach(self) {
        let robot = self.robot.clone();
        robot.begin(self.work().0);
    }

    /// What is asked of the bridge, and the session that it keeps.
    fn work(self) -> (Work, Option<Arm>) {
        let work = match self.refused {
            Some(error) => Work::Refused {
                id: self.goal.id,
                error,
            },
            None => Work::goal(self.goal, self.ticket.0, self.arm.as_ref()),
        };
        (work, self.arm)
    }

    /// A way to brake the motion from elsewhere.
    pub fn canceller(&self) -> Canceller {
        Canceller::new(self.robot.clone(), self.goal.id)
    }
}

impl IntoFuture for Motion {
    type Output = Result<MotionReport, MotionError>;
    type IntoFuture = Moving;

    fn into_future(self) -> Moving {
        let robot = self.robot.clone();
        let (work, arm) = self.work();
        Moving::new(robot, arm, work)
    }
}

/// Brakes a motion. Clones brake the same one.
#[derive(Clone, Debug)]
pub struct Canceller {
    robot: Robot,
    goal: GoalId,
}

impl Canceller {
    pub(crate) fn new(robot: Robot, goal: GoalId) -> Self {
        Self { robot, goal }
    }

    /// Brakes the motion, which resolves as [`MotionError::Stopped`]. Without effect before it
    /// begins and after it has ended or was superseded.
    pub fn cancel(&self) {
        self.robot.cancel(self.goal);
    }
}

/// A motion as a future. It begins with the first poll and resolves when the arm has arrived,
/// rests, and is no longer controlled; or with the reason why not.
///
/// # Cancel safety
/// Dropping it brakes the arm, in the background: within about a quarter of a second and the
/// robot's limits.
///
/// # Panics
/// When polled after it has resolved, as futures may.
#[derive(Debug)]
#[must_use = "futures do nothing unless polled"]
pub struct Moving {
    robot: Robot,
    /// Keeps the session of the goal.
    arm: Option<Arm>,
    stage: Stage,
    goal: GoalId,
}

#[derive(Debug)]
enum Stage {
    Ready(Work),
    Begun(oneshot::Receiver<Outcome>),
    Over,
}

impl Moving {
    pub(crate) fn new(robot: Robot, arm: Option<Arm>, work: Work) -> Self {
        Self {
            robot,
            arm,
            goal: work.id(),
            stage: Stage::Ready(work),
        }
    }

    pub(crate) fn id(&self) -> GoalId {
        self.goal
    }
}

impl Future for Moving {
    type Output = Outcome;

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Outcome> {
        let mut outcome = match std::mem::replace(&mut self.stage, Stage::Over) {
            Stage::Ready(work) => self.robot.begin(work),
            Stage::Begun(outcome) => outcome,
            Stage::Over => panic!("a motion is not polled after it has resolved"),
        };
        let Poll::Ready(outcome) = Pin::new(&mut outcome).poll(context) else {
            self.stage = Stage::Begun(outcome);
            return Poll::Pending;
        };
        let outcome = outcome.unwrap_or_else(|_| self.robot.closed());
        Poll::Ready(match &self.arm {
            Some(arm) => outcome.map_err(|error| arm.explain(error)),
            None => outcome,
        })
    }
}

impl Drop for Moving {
    fn drop(&mut self) {
        if matches!(self.stage, Stage::Begun(_)) {
            self.robot.cancel(self.goal);
        }
    }
}
