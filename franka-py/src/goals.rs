//! Motions of a robot that is not engaged.

use pyo3::prelude::*;
use pyo3::types::{PyAny, PyDict};

use crate::arrays::vector;
use crate::destination::{destination, offset, waypoints};
use crate::engagement::Engagement;
use crate::follow::{self, Leader};
use crate::motion::{Follow, Motion, reference};
use crate::options::{Keywords, Options, budget_object, with_options};
use crate::robot::Robot;
use crate::start::StartTicket;

/// Creates the motion `begun` of `robot` with the options of the call `name`.
pub(crate) fn motion(
    py: Python<'_>,
    name: &'static str,
    robot: &franka_async::Robot,
    options: Option<&Bound<'_, PyDict>>,
    begun: franka_async::Motion,
) -> PyResult<Py<Motion>> {
    let mut keywords = Keywords::new(name, options)?;
    let options = Options::of_goal(&mut keywords, robot.model())?;
    let ticket = keywords.take("start_with")?;
    let joint_fallback = keywords.value("joint_fallback")?.unwrap_or(false);
    keywords.end()?;
    let mut begun = with_options!(begun, options);
    if joint_fallback {
        begun = begun.joint_fallback();
    }
    let begun = match ticket {
        Some(ticket) => begun.start_with(ticket.cast::<StartTicket>()?.get().take()?),
        None => begun,
    };
    Motion::new(py, name, begun)
}

#[pymethods]
impl Robot {
    /// A motion of the end effector to `target` in the base frame. A pose is `(4, 4)`, or 3 + 4
    /// numbers with a quaternion `x y z w`, which can be a pair. 3 numbers are a position, reached
    /// with constant orientation. `(3, 3)` or 4 numbers are an orientation. `Joints` are joint
    /// positions. The path to a pose is a straight line.
    ///
    /// Options of every motion: `speed`, a factor; `limits`, a `Budget`; `gains`, `Gains`;
    /// `stiffness` at the end effector, 6 numbers; `force_cap`, N, or `None` for off; `leash`,
    /// `deviation`, `tolerance`, `settling`; `posture`, 7 joint positions; `until`, a condition;
    /// `start_with`, a `StartTicket`; and `joint_fallback`, true for a joint motion if the arm
    /// cannot follow the line. Raises `ValueError` for invalid arguments, and `MotionError` when it
    /// is awaited.
    #[pyo3(signature = (target, **options))]
    fn move_to(
        &self,
        py: Python<'_>,
        target: &Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<Motion>> {
        let (robot, target) = (self.connected()?, destination("target", target)?);
        motion(py, "Robot.move_to", &robot, options, robot.move_to(target))
    }

    /// A motion of the joints to `q`, 7 numbers, rad; all joints arrive together. Options as for
    /// `move_to`.
    #[pyo3(signature = (q, **options))]
    fn move_joints(
        &self,
        py: Python<'_>,
        q: &Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<Motion>> {
        let (robot, q) = (self.connected()?, vector("q", q)?);
        motion(
            py,
            "Robot.move_joints",
            &robot,
            options,
            robot.move_joints(q),
        )
    }

    /// A motion of the end effector relative to its position, or to the target of the current
    /// motion. The offset is 3 numbers, m, or 6, with a rotation vector, rad, along and about the
    /// axes of the `base` or the `tool`. With `from_arm` it is always relative to the measured
    /// position. Options as for `move_to`.
    #[pyo3(signature = (way, frame = "base", from_arm = false, **options))]
    fn move_by(
        &self,
        py: Python<'_>,
        way: &Bound<'_, PyAny>,
        frame: &str,
        from_arm: bool,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<Motion>> {
        let (robot, offset) = (self.connected()?, offset("way", way, frame, from_arm)?);
        motion(py, "Robot.move_by", &robot, options, robot.move_by(offset))
    }

    /// A motion through several poses, or several `Joints`, to the last of them, without a stop at
    /// rounded corners: within `blend` (m; rad for joints), or within the blend of each `Waypoint`.
    /// Options as for `move_to`.
    #[pyo3(signature = (waypoints, blend = 0.0, **options))]
    fn move_through(
        &self,
        py: Python<'_>,
        waypoints: &Bound<'_, PyAny>,
        blend: f64,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<Motion>> {
        let (robot, path) = (self.connected()?, self::waypoints(waypoints, blend)?);
        let through = robot.move_through(path);
        motion(py, "Robot.move_through", &robot, options, through)
    }

    /// Follows the newest of `targets` until they end, and then stops at the last target. A target
    /// is a pose or `Joints`, alone or in a pair with its velocity. `targets` is a `Latest`, which
    /// any thread sets; an asynchronous iterator, which runs in the event loop that awaits; or a
    /// plain iterator, which runs on a separate thread and may wait.
    ///
    /// Options as for `move_to`, and `lead`, a `Lead`: the largest distance of a target ahead of
    /// the arm; and `watchdog`, a pair of a time in seconds and the reaction, `brake` or `hold`, if
    /// no target arrives for this time. The motion and the watchdog begin with the first target. An
    /// exception of the iterator brakes the arm and is raised.
    #[pyo3(signature = (targets, **options))]
    fn follow(
        this: &Bound<'_, Self>,
        targets: &Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<Follow>> {
        let robot = Leader::Robot(this.get().connected()?);
        follow::operation(this, "Robot.follow", robot, targets, options)
    }

    /// Begins a session that holds the arm in place and moves from goal to goal without a stop in
    /// between: `async with robot.engage() as arm`, or `arm = await robot.engage()`.
    ///
    /// Options: `speed`, `limits`, `gains`, `force_cap`, `leash`, `deviation`, `posture` as for
    /// `move_to`, for all goals of the session; `keep_out`, regions (`Plane`, `Box`) that the arm
    /// must avoid; `speed_cap`, the largest speed of the joints, the flange and the end effector,
    /// m/s; `deadman`, a `Deadman`; and `backend`, `torques` or a pair of a controller of the robot
    /// and its setpoints.
    #[pyo3(signature = (**options))]
    fn engage(
        &self,
        py: Python<'_>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<Engagement>> {
        Engagement::new(py, self.connected()?, options)
    }

    /// Commanded position of target control in this millisecond: a `Reference`; `None` while target
    /// control is not active.
    fn reference<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let newest = self.connected()?.reference();
        newest.map(|newest| reference(py, &newest)).transpose()
    }

    /// The default limits of a motion: a `Budget`.
    fn budget<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let robot = self.connected()?;
        let default = franka_async::goal::Budget::of(robot.model().joint_limits());
        budget_object(py, &default)
    }
}
