//! A course that slows down and brakes before the arm comes too near to itself or to a keep-out
//! region. `clearance` decides how near is too near.

use franka_model::{EndEffector, Model};

use crate::session::aim::Aim;
use crate::session::chunk::{ChunkCourse, ChunkStart};
use crate::session::course::{self, Course};
use crate::session::guard::clearance::{Ahead, Clearance};
use crate::session::guard::speed_cap::SpeedCap;
use crate::session::kinematics::Posture;
use crate::session::reference::Reference;
use crate::session::running::Measured;
use crate::session::{Budget, Chunk, Lapse, Target};

/// Factor that reduces a goal's velocity near an obstacle.
const SLOW: f64 = 0.3;

/// Number of cycles without an obstacle ahead after which a goal has its full velocity again.
const CLEAR: u32 = 100;

/// Number of cycles from a brake to the next attempt to reach the aim.
const RETRY: u32 = 100;

/// Number of cycles after a brake for which a course counts as hindered.
const HINDERED: u32 = 250;

/// Moves the reference along a course, and brakes it in time before an obstacle.
#[derive(Debug)]
pub(in crate::session) struct ObstacleBraking {
    pub(in crate::session) course: Course,
    clearance: Clearance,
    pace: Pace,
    /// True if the course must be planned anew before its next step, because its target, budget or
    /// pace has changed.
    stale: bool,
    /// Number of cycles for which the course still counts as hindered.
    hindered: u32,
    /// Obstacle of the last brake: the region with this index, or the arm itself if `None`.
    obstacle: Option<usize>,
    /// Budget of the last check that found the path to rest clear.
    judged: Budget,
    /// A chunk whose course has been replaced. It is returned in the next cycle, so that it is
    /// freed outside the thread.
    pub(in crate::session) retired_chunk: Option<ChunkCourse>,
    /// Target at which the goal's last chunk has ended, if no chunk runs.
    pub(in crate::session) chunk_end: Option<Target>,
    /// True if a brake has ended the chunk early. The caller did not request a straight line to the
    /// chunk's end, so the course rests until another target or chunk arrives.
    left_chunk: bool,
    /// True if a plan has failed since the last answer.
    failed: bool,
}

#[derive(Debug)]
enum Pace {
    /// The goal continues at its full pace.
    Full,
    /// The goal continues slowly. The value is the number of cycles without an obstacle ahead.
    Slow(u32),
    /// The course braked before an obstacle. The value is the number of cycles since then.
    Braked(u32),
}

/// Joint velocity below which a reference may be stopped at once, `[rad/s]`. Stopping within one
/// cycle is then a deceleration of 0.1 rad/s^2.
const AT_REST: f64 = 1e-4;

impl ObstacleBraking {
    /// Returns the course of an arm at rest. It begins with this budget.
    pub(in crate::session) fn new(clearance: Clearance, budget: Budget) -> Self {
        Self {
            course: Course::Rest,
            clearance,
            pace: Pace::Full,
            stale: false,
            hindered: 0,
            obstacle: None,
            judged: budget,
            retired_chunk: None,
            chunk_end: None,
            left_chunk: false,
            failed: false,
        }
    }

    /// Requests a new plan of the course before its next step.
    pub(in crate::session) fn outdate(&mut self) {
        self.stale = true;
    }

    /// Plans anew toward `aim` if a new plan was requested.
    pub(in crate::session) fn renew(
        &mut self,
        model: &Model,
        ee: &EndEffector,
        reference: &Reference,
        aim: &Aim,
    ) {
        if self.stale && !self.left_chunk {
            self.head_for(model, ee, reference, aim);
        }
        self.stale = false;
    }

    /// Plans the course from the reference toward `aim`. A current chunk is kept, within the budget
    /// of `aim`. The pace does not change, except that it is slow after a brake.
    fn head_for(&mut self, model: &Model, ee: &EndEffector, reference: &Reference, aim: &Aim) {
        let paced = self.paced(aim);
        match &mut self.course {
            Course::Chunk(chunk) => {
                chunk.keep_to(model, reference, paced.budget);
                chunk.set_paused(paced.paused);
            }
            _ => self.plan(model, ee, reference, &paced),
        }
    }

    fn plan(&mut self, model: &Model, ee: &EndEffector, reference: &Reference, aim: &Aim) {
        let planned = self.course.head_for(model, ee, reference, aim);
        self.failed |= planned.is_err();
    }

    /// Returns true if a plan has failed since the last call.
    pub(in crate::session) fn take_failure(&mut self) -> bool {
        core::mem::take(&mut self.failed)
    }

    /// Follows a chunk toward its end, `aim`, at the present pace. Returns the previous chunk.
    pub(in crate::session) fn follow(
        &mut self,
        model: &Model,
        ee: &EndEffector,
        reference: &Reference,
        aim: &Aim,
        chunk: Chunk,
        now: u64,
    ) -> Option<ChunkCourse> {
        let budget = self.paced(aim).budget;
        let (pose, drift) = self.course.pose(model, ee, reference);
        let before = match &self.course {
            Course::Chunk(before) => Some(before),
            _ => None,
        };
        let start = ChunkStart {
            reference,
            pose,
            drift,
            before,
            now,
        };
        let mut next = ChunkCourse::new(model, aim.goal, budget, chunk, start);
        next.set_paused(aim.paused);
        self.left_chunk = false;
        match core::mem::replace(&mut self.course, Course::Chunk(next)) {
            Course::Chunk(before) => Some(before),
            _ => None,
        }
    }

    /// Returns `aim`, with less velocity if an obstacle is near. Also ends a brake: the goal then
    /// continues slowly, and its pace may change again.
    fn paced(&mut self, aim: &Aim) -> Aim {
        self.stale = false;
        if matches!(self.pace, Pace::Braked(_)) {
            self.pace = Pace::Slow(0);
        }
        match (aim.target, &self.pace) {
            (Target::Rest | Target::Guide(_), _) => self.braking(aim),
            (_, Pace::Full) => *aim,
            (_, Pace::Slow(_) | Pace::Braked(_)) => aim.slowed(SLOW),
        }
    }

    /// Returns `aim`, with joint limits at least as high as in the last check that found the path
    /// clear. Then the braking distance is no longer than the checked distance.
    fn braking(&self, aim: &Aim) -> Aim {
        let mut budget = aim.budget;
        for (joint, judged) in budget.joints.iter_mut().zip(&self.judged.joints) {
            joint.velocity = joint.velocity.max(judged.velocity);
            joint.acceleration = joint.acceleration.max(judged.acceleration);
            joint.jerk = joint.jerk.max(judged.jerk);
        }
        Aim { budget, ..*aim }
    }

    /// Plans anew toward `aim` from a reference that something else has moved. Does nothing if the
    /// reference has arrived and rests.
    pub(in crate::session) fn begin_again(
        &mut self,
        model: &Model,
        ee: &EndEffector,
        reference: &Reference,
        aim: &Aim,
    ) {
        if self.course.is_done() && reference.dq.amax() < AT_REST {
            return;
        }
        if let Course::Chunk(chunk) = &mut self.course {
            let pose = course::end_effector(model, ee, reference);
            return chunk.begin_again(model, reference, pose);
        }
        self.course = Course::Rest;
        if matches!(self.pace, Pace::Braked(_)) {
            self.brake(model, ee, reference, aim);
        } else {
            self.head_for(model, ee, reference, aim);
        }
    }

    /// Ends the motion to the previous target, so that a motion to the next target is planned.
    pub(in crate::session) fn turn(&mut self) {
        self.retire_chunk();
        self.left_chunk = false;
        self.stale = true;
    }

    fn retire_chunk(&mut self) {
        if matches!(self.course, Course::Chunk(_))
            && let Course::Chunk(chunk) = core::mem::replace(&mut self.course, Course::Rest)
        {
            self.retired_chunk = Some(chunk);
        }
    }

    fn brake(&mut self, model: &Model, ee: &EndEffector, reference: &Reference, aim: &Aim) {
        if let Course::Chunk(chunk) = &self.course {
            self.chunk_end = Some(chunk.target());
            self.left_chunk = true;
            self.retire_chunk();
        }
        let rest = Aim {
            target: Target::Rest,
            ..*aim
        };
        let rest = self.braking(&rest);
        self.plan(model, ee, reference, &rest);
    }

    /// Removes the course and resets its pace. The reference stays where it is.
    pub(in crate::session) fn rest(&mut self) {
        self.course = Course::Rest;
        self.pace = Pace::Full;
        self.stale = false;
    }

    /// Advances by one nominal millisecond toward `aim`, for the answer to the state `now`. Brakes
    /// instead if an obstacle would be too near.
    #[expect(clippy::too_many_arguments, reason = "each is of another type")]
    pub(in crate::session) fn step(
        &mut self,
        model: &Model,
        ee: &EndEffector,
        posture: (&Posture, Option<SpeedCap<'_>>),
        reference: &Reference,
        arm: &Measured,
        aim: &Aim,
        now: u64,
    ) -> course::CourseStep {
        self.hindered = self.hindered.saturating_sub(1);
        let guided = (arm, &aim.leash);
        if let Pace::Braked(since) = &mut self.pace {
            *since = since.saturating_add(1);
            if *since < RETRY || self.left_chunk || !self.course.is_done() {
                self.hindered = HINDERED;
                return self.course.step(model, ee, posture, reference, guided, now);
            }
            self.head_for(model, ee, reference, aim);
        }
        let step = self.course.step(model, ee, posture, reference, guided, now);
        // The path of a brake was checked before the step at which the brake begins. Hand guiding
        // is not checked.
        if matches!(aim.target, Target::Rest | Target::Guide(_)) {
            return step;
        }
        let next = &step.reference;
        let end = course::end_of_brake(model, next, &aim.budget);
        let ahead = self.clearance.ahead(&reference.q, &next.q, &end);
        match (ahead, &mut self.pace) {
            (Ahead::TooNear(region), _) => {
                self.obstacle = region;
                self.pace = Pace::Braked(0);
                self.hindered = HINDERED;
                self.brake(model, ee, reference, aim);
                return self.course.step(model, ee, posture, reference, guided, now);
            }
            (Ahead::Near, pace @ Pace::Full) => {
                *pace = Pace::Slow(0);
                self.stale = true;
            }
            (Ahead::Near, pace) => *pace = Pace::Slow(0),
            (Ahead::Clear, Pace::Slow(clear)) => {
                *clear += 1;
                if *clear >= CLEAR {
                    self.pace = Pace::Full;
                    self.stale = true;
                }
            }
            (Ahead::Clear, Pace::Full | Pace::Braked(_)) => {}
        }
        self.judged = aim.budget;
        step
    }

    /// True if an obstacle slows the course down or keeps it from its aim.
    pub(in crate::session) fn is_bound(&self) -> bool {
        !matches!(self.pace, Pace::Full)
    }

    /// Returns the obstacle that keeps the course from its goal, or did so until a moment ago.
    pub(in crate::session) fn hindrance(&self) -> Option<Lapse> {
        let region = self.obstacle.map(|index| index + 1);
        (self.hindered > 0).then_some(Lapse::Blocked { region })
    }

    pub(in crate::session) fn is_done(&self) -> bool {
        !self.stale && self.course.is_done() && !matches!(self.pace, Pace::Braked(_))
    }
}
