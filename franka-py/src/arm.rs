//! An engaged arm: one session, many goals.

use franka_async::MotionError;
use franka_async::goal::Free;
use futures::FutureExt;
use pyo3::prelude::*;
use pyo3::types::{PyAny, PyDict};

use crate::arrays::vector;
use crate::chunk::chunk;
use crate::destination::{destination, is, offset, target_object, waypoints};
use crate::follow::{self, Leader};
use crate::goals::motion;
use crate::motion::{Follow, Motion, Report, reference};
use crate::operation::{Operation, seconds};
use crate::options::{Keywords, tuning};
use crate::runtime::{self, Threaded};
use crate::told::{Told, leave, telling};

/// A session of target control: the arm is held, and moves from goal to goal without a stop in
/// between, for all kinds of goals. Created by `Robot.engage`.
///
/// When its last reference is dropped, the arm brakes and the session ends, in the background;
/// `disengage()` does the same and can be awaited. `Robot.stop` or a reflex also ends the session:
/// later calls then raise the reason. During the session, motions of the `Robot` itself are refused
/// as `busy`.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Arm {
    arm: Threaded<franka_async::Arm>,
    /// Identifies the session to its motions.
    pub(crate) told: Told,
}

impl Arm {
    pub(crate) fn new(arm: franka_async::Arm, told: Told) -> Self {
        let arm = Threaded::new(arm);
        Self { arm, told }
    }

    /// Returns the session.
    ///
    /// # Errors
    /// `RuntimeError` in a forked child.
    pub(crate) fn session(&self) -> PyResult<franka_async::Arm> {
        runtime::runtime()?;
        Ok(self.arm.clone())
    }

    fn motion(
        &self,
        py: Python<'_>,
        name: &'static str,
        options: Option<&Bound<'_, PyDict>>,
        begun: franka_async::Motion,
    ) -> PyResult<Py<Motion>> {
        let motion = motion(py, name, self.arm.robot(), options, begun)?;
        motion.get().member.is_of(self.told_session()?);
        Ok(motion)
    }

    /// Returns the session, with its raised errors.
    pub(crate) fn told_session(&self) -> PyResult<(Told, franka_async::Arm)> {
        Ok((self.told.clone(), self.session()?))
    }

    /// Returns the operation `name` of the session.
    fn operation<T, W>(
        &self,
        name: &'static str,
        work: impl FnOnce(franka_async::Arm) -> W,
    ) -> PyResult<Operation>
    where
        T: for<'py> IntoPyObject<'py> + Send + 'static,
        W: Future<Output = Result<T, MotionError>> + Send + 'static,
    {
        let session = self.told_session()?;
        let work = work(session.1.clone());
        Ok(telling(name, session, work))
    }
}

#[pymethods]
impl Arm {
    /// Like `Robot.move_to`; the arm is then held at the target. Cancelling it brakes and holds the
    /// arm.
    #[pyo3(signature = (target, **options))]
    fn move_to(
        &self,
        py: Python<'_>,
        target: &Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<Motion>> {
        let target = destination("target", target)?;
        self.motion(py, "Arm.move_to", options, self.session()?.move_to(target))
    }

    /// Like `Robot.move_joints`; the arm is then held.
    #[pyo3(signature = (q, **options))]
    fn move_joints(
        &self,
        py: Python<'_>,
        q: &Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<Motion>> {
        let q = vector("q", q)?;
        self.motion(
            py,
            "Arm.move_joints",
            options,
            self.session()?.move_joints(q),
        )
    }

    /// Like `Robot.move_by`, relative to the target at which the arm is held; the arm is then held.
    #[pyo3(signature = (way, frame = "base", from_arm = false, **options))]
    fn move_by(
        &self,
        py: Python<'_>,
        way: &Bound<'_, PyAny>,
        frame: &str,
        from_arm: bool,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<Motion>> {
        let offset = offset("way", way, frame, from_arm)?;
        self.motion(py, "Arm.move_by", options, self.session()?.move_by(offset))
    }

    /// Like `Robot.move_through`; the arm is then held.
    #[pyo3(signature = (waypoints, blend = 0.0, **options))]
    fn move_through(
        &self,
        py: Python<'_>,
        waypoints: &Bound<'_, PyAny>,
        blend: f64,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<Motion>> {
        let path = self::waypoints(waypoints, blend)?;
        let through = self.session()?.move_through(path);
        self.motion(py, "Arm.move_through", options, through)
    }

    /// Brakes the arm in any motion, and completes when it is at rest; the arm is then held there.
    #[pyo3(signature = (**options))]
    fn hold(&self, py: Python<'_>, options: Option<&Bound<'_, PyDict>>) -> PyResult<Py<Motion>> {
        self.motion(py, "Arm.hold", options, self.session()?.hold())
    }

    /// Moves to `target` from now on, replacing any other goal, and holds it. Accepts the targets
    /// of `move_to`, and targets with velocities. Completes as soon as the goal is accepted.
    /// Cancelling does not revoke the goal.
    fn set(&self, target: &Bound<'_, PyAny>) -> PyResult<Operation> {
        let target = destination("target", target)?;
        self.operation("Arm.set", |arm| async move { arm.set(target).await })
    }

    /// Like `set`, without waiting for an answer: for loops with their own rate, on any thread. If
    /// goals come faster than they are accepted, the newest counts. Raises `MotionError` for a goal
    /// that is refused, and for the end of the session.
    fn try_set(&self, py: Python<'_>, target: &Bound<'_, PyAny>) -> PyResult<()> {
        use crate::errors::Raise;
        let (arm, target) = (self.session()?, destination("target", target)?);
        let set = py.detach(|| arm.try_set(target));
        self.told.saw(&set);
        set.map_err(|error| {
            self.told.note(&arm, &error);
            error.raise(py)
        })
    }

    /// The target at which the arm is held or to which it moves: a pose, `(4, 4)`, `Joints`, or a
    /// pair with the twist. `None` along a chunk, at the beginning, after an aborted goal, and once
    /// the session has ended.
    fn target<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        match self.session()?.target() {
            Some(target) => target_object(py, target),
            None => Ok(None),
        }
    }

    /// The commanded position of the arm in this millisecond: a `Reference`; `None` once the
    /// session has ended.
    fn reference<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let newest = self.session()?.reference();
        newest.map(|newest| reference(py, &newest)).transpose()
    }

    /// Waits until the arm is at rest at the last accepted target, or where that target was
    /// aborted; returns `True` if it is. Without a `timeout` it waits indefinitely for an arm that
    /// is pushed or blocked, or that follows a stream; `False` means that it was not at rest within
    /// `timeout` seconds. Cancelling has no effect on the arm.
    #[pyo3(signature = (timeout = None))]
    fn at_rest(&self, timeout: Option<f64>) -> PyResult<Operation> {
        let timeout = timeout.map(|timeout| seconds("timeout", timeout));
        let timeout = timeout.transpose()?;
        self.operation("Arm.at_rest", |arm| async move {
            let Some(timeout) = timeout else {
                return arm.at_rest().await.map(|()| true);
            };
            let rests = tokio::time::timeout(timeout, arm.at_rest()).await;
            rests.map_or(Ok(false), |rests| rests.map(|()| true))
        })
    }

    /// Begins to follow points with times, such as a policy's predictions; completes as soon as the
    /// points are accepted. The arm stops at the last point unless another chunk or goal follows.
    ///
    /// `points` are positions `(N, 3)`, poses `(N, 7)` or `(N, 4, 4)`, or with `joints` joint
    /// positions `(N, 7)`, rad; or a `Chunk`, whose fields replace the other arguments. `dt` is the
    /// time between two points, s, or `times` is the time of each point. `velocities` are twists
    /// `(N, 6)` or joint velocities `(N, 7)`. `observed_at` is the `RobotState` of the policy's
    /// observation: the times count from this state. `blend` is the time of the transition from the
    /// previous chunk, 0.1 s by default. A chunk has at most 1024 points and 60 s. Send the rest as
    /// the next chunk, with the same `observed_at`: this chunk takes effect at the time of its
    /// first point.
    ///
    /// Raises `ValueError` for invalid arrays. Awaiting raises `MotionError` for a chunk that is
    /// too late or ends out of reach; the previous chunk then continues. It raises the kind `held`
    /// or `braked`, once, if the previous chunk was aborted, for example by a silent `Deadman`.
    #[pyo3(signature = (points, dt = None, times = None, *, velocities = None, joints = false, observed_at = None, blend = None))]
    #[expect(clippy::too_many_arguments, reason = "keywords")]
    fn chunk(
        &self,
        points: &Bound<'_, PyAny>,
        dt: Option<f64>,
        times: Option<&Bound<'_, PyAny>>,
        velocities: Option<&Bound<'_, PyAny>>,
        joints: bool,
        observed_at: Option<&Bound<'_, PyAny>>,
        blend: Option<f64>,
    ) -> PyResult<Operation> {
        let arm = self.session()?;
        let made = if is(points, "Chunk")? {
            points.clone()
        } else {
            let class = points.py().import("franka_async.goal")?.getattr("Chunk")?;
            class.call1((points, dt, times, velocities, joints, observed_at, blend))?
        };
        let chunk = chunk(&made, &arm)?;
        self.operation("Arm.chunk", |arm| async move { arm.chunk(chunk).await })
    }

    /// Allows hand guiding, once the arm is at rest, until the next goal; `hold()` ends the
    /// guiding. `axes` are the free directions: along x y z and about x y z of the base frame, six
    /// truth values; the other directions are held. Completes as soon as the request is accepted.
    /// Declare the load first, or it pulls the arm down.
    #[pyo3(signature = (axes = [true; 6], elbow = true))]
    fn guide(&self, axes: [bool; 6], elbow: bool) -> PyResult<Operation> {
        let free = Free { axes, elbow };
        self.operation("Arm.guide", |arm| async move { arm.guide(free).await })
    }

    /// Like `Robot.follow`; the arm is then held at the last target.
    #[pyo3(signature = (targets, **options))]
    fn follow(
        this: &Bound<'_, Self>,
        targets: &Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<Follow>> {
        let session = this.get().told_session()?;
        let arm = Leader::Arm(session.clone());
        let follow = follow::operation(this, "Arm.follow", arm, targets, options)?;
        if let Some(member) = &follow.get().member {
            member.is_of(session);
        }
        Ok(follow)
    }

    /// Changes the given options among `gains`, `limits`, `force_cap`, `leash`, `deviation` and
    /// `posture`, for the current goal and for later goals. Gains change gradually over 0.3 s.
    #[pyo3(signature = (**options))]
    fn tune(&self, options: Option<&Bound<'_, PyDict>>) -> PyResult<Operation> {
        let arm = self.session()?;
        let mut keywords = Keywords::new("Arm.tune", options)?;
        let tuning = tuning(&mut keywords, arm.robot().model())?;
        keywords.end()?;
        self.operation("Arm.tune", |arm| async move { arm.tune(tuning).await })
    }

    /// Brakes and releases the arm, ends the session, and returns a `MotionReport`. The motion
    /// under way raises `stopped`. If the session ended for a different reason, raises this reason.
    fn disengage(&self) -> PyResult<Operation> {
        self.operation("Arm.disengage", |arm| async move {
            arm.disengage().await.map(Report)
        })
    }

    /// Waits until the session has ended, and returns its report or raises the reason. Cancelling
    /// has no effect on the arm.
    fn ended(&self) -> PyResult<Operation> {
        self.operation(
            "Arm.ended",
            |arm| async move { arm.ended().await.map(Report) },
        )
    }

    fn __repr__(&self) -> PyResult<String> {
        let arm = self.session()?;
        let state = match arm.ended().now_or_never() {
            None => "engaged",
            Some(_) => "disengaged",
        };
        Ok(format!("<Arm of {}, {state}>", arm.robot().address()))
    }

    fn __aenter__(this: Py<Self>) -> Operation {
        Operation::infallible("Arm", async move { this })
    }

    #[pyo3(signature = (kind = None, *_rest))]
    fn __aexit__(
        &self,
        kind: Option<&Bound<'_, PyAny>>,
        _rest: &Bound<'_, PyAny>,
    ) -> PyResult<Operation> {
        Ok(leave(self.told_session()?, kind))
    }
}
