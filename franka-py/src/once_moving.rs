//! What happens to a simulated robot as soon as its arm moves, by the robot's own time.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use franka_sim::Robot;

/// What waits for the arm to move, in order. Clones are of the same robot.
#[derive(Clone, Default)]
pub(crate) struct OnceMoving(Arc<Mutex<Waiting>>);

#[derive(Default)]
struct Waiting {
    jobs: Vec<(JobId, Job)>,
    /// How many there were.
    count: u64,
}

type Job = Box<dyn FnOnce(&mut Robot) + Send>;

/// Names a job, to take it back.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct JobId(u64);

impl OnceMoving {
    /// Has `job` done before the first millisecond at which the arm moves.
    pub(crate) fn push(&self, job: impl FnOnce(&mut Robot) + Send + 'static) -> JobId {
        let mut waiting = self.waiting();
        waiting.count += 1;
        let id = JobId(waiting.count);
        waiting.jobs.push((id, Box::new(job)));
        id
    }

    /// Takes a job back. Returns whether it still waited.
    pub(crate) fn take_back(&self, id: JobId) -> bool {
        let jobs = &mut self.waiting().jobs;
        let before = jobs.len();
        jobs.retain(|(other, _)| *other != id);
        jobs.len() < before
    }

    /// How many jobs wait.
    pub(crate) fn count(&self) -> usize {
        self.waiting().jobs.len()
    }

    /// Takes all jobs back.
    pub(crate) fn clear(&self) {
        self.waiting().jobs.clear();
    }

    /// To be called before each millisecond of the robot.
    pub(crate) fn look_at(&self, robot: &mut Robot) {
        let mut waiting = self.waiting();
        if !waiting.jobs.is_empty() && robot.dq().amax() > MOVING {
            waiting.jobs.drain(..).for_each(|(_, job)| job(robot));
        }
    }

    fn waiting(&self) -> MutexGuard<'_, Waiting> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Speed of the fastest joint from which on the arm counts as moving, `[rad/s]`.
const MOVING: f64 = 0.05;
