//! Jobs on a simulated robot that run as soon as its arm moves, by the robot's own time.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use franka_sim::Robot;

/// Jobs that wait for the arm to move, in order. Clones belong to the same robot.
#[derive(Clone, Default)]
pub(crate) struct OnceMoving(Arc<Mutex<Waiting>>);

#[derive(Default)]
struct Waiting {
    jobs: Vec<(JobId, Job)>,
    /// Total number of jobs.
    count: u64,
}

type Job = Box<dyn FnOnce(&mut Robot) + Send>;

/// Identifies a job, to cancel it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct JobId(u64);

impl OnceMoving {
    /// Runs `job` before the first millisecond in which the arm moves.
    pub(crate) fn push(&self, job: impl FnOnce(&mut Robot) + Send + 'static) -> JobId {
        let mut waiting = self.waiting();
        waiting.count += 1;
        let id = JobId(waiting.count);
        waiting.jobs.push((id, Box::new(job)));
        id
    }

    /// Cancels a job. Returns true if it still waited.
    pub(crate) fn take_back(&self, id: JobId) -> bool {
        let jobs = &mut self.waiting().jobs;
        let before = jobs.len();
        jobs.retain(|(other, _)| *other != id);
        jobs.len() < before
    }

    /// Number of waiting jobs.
    pub(crate) fn count(&self) -> usize {
        self.waiting().jobs.len()
    }

    /// Cancels all jobs.
    pub(crate) fn clear(&self) {
        self.waiting().jobs.clear();
    }

    /// Runs the due jobs. Call it before each millisecond of the robot.
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

/// Speed of the fastest joint from which the arm counts as moving, `[rad/s]`.
const MOVING: f64 = 0.05;
