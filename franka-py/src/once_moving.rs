//! What happens to a simulated robot as soon as its arm moves, by the robot's own time.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use franka_sim::{Robot, TouchId};

/// What waits for the arm to move, in order. Clones are of the same robot.
#[derive(Clone, Default)]
pub(crate) struct OnceMoving(Arc<Mutex<Vec<Waiting>>>);

struct Waiting {
    job: Box<dyn FnOnce(&mut Robot) + Send>,
    /// The touch that `job` begins, if it begins one.
    touch: Option<Begun>,
}

impl OnceMoving {
    /// Has `job` done before the first millisecond at which the arm moves. `touch` is what it
    /// begins, which may be released before.
    pub(crate) fn push(&self, job: impl FnOnce(&mut Robot) + Send + 'static, touch: Option<Begun>) {
        let job = Box::new(job);
        self.waiting().push(Waiting { job, touch });
    }

    /// How many wait, without touches that were released.
    pub(crate) fn count(&self) -> usize {
        let waits = |touch: &Begun| matches!(*touch.stage(), Stage::Waits);
        let waiting = self.waiting();
        let live = waiting
            .iter()
            .filter(|one| one.touch.as_ref().is_none_or(waits));
        live.count()
    }

    /// Drops all that waits.
    pub(crate) fn clear(&self) {
        self.waiting().clear();
    }

    /// To be called before each millisecond of the robot.
    pub(crate) fn look_at(&self, robot: &mut Robot) {
        let mut waiting = self.waiting();
        if !waiting.is_empty() && robot.dq().amax() > MOVING {
            waiting.drain(..).for_each(|one| (one.job)(robot));
        }
    }

    fn waiting(&self) -> MutexGuard<'_, Vec<Waiting>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A touch that has begun, or that begins when the arm moves.
#[derive(Clone, Default)]
pub(crate) struct Begun(Arc<Mutex<Stage>>);

#[derive(Default)]
enum Stage {
    #[default]
    Waits,
    Acts(TouchId),
    /// Released before it had begun.
    Dropped,
}

impl Begun {
    /// Begins it, unless it was released.
    pub(crate) fn begin(&self, robot: &mut Robot, touch: franka_sim::Touch) {
        let mut stage = self.stage();
        if let Stage::Waits = *stage {
            *stage = Stage::Acts(robot.touch(touch));
        }
    }

    /// Ends it. Returns whether it was still there.
    pub(crate) fn release(&self, robot: &mut Robot) -> bool {
        let mut stage = self.stage();
        match *stage {
            Stage::Acts(id) => robot.release(id),
            Stage::Waits => {
                *stage = Stage::Dropped;
                true
            }
            Stage::Dropped => false,
        }
    }

    /// What it is called by the robot, if it has begun.
    pub(crate) fn id(&self) -> Option<TouchId> {
        match *self.stage() {
            Stage::Acts(id) => Some(id),
            Stage::Waits | Stage::Dropped => None,
        }
    }

    fn stage(&self) -> MutexGuard<'_, Stage> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Speed of the fastest joint from which on the arm counts as moving, `[rad/s]`.
const MOVING: f64 = 0.05;
