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

/// Makes the motion `begun` of `robot` with the options of the call `name`.
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
    /// A motion of the end effector to `target` in the base frame: a pose, `(4, 4)`, or 3 + 4
    /// numbers with a quaternion `x y z w`, which may be a pair; 3 numbers, a position that is
    /// reached with the orientation kept; `(3, 3)` or 4 numbers, an orientation; or `Joints`.
    /// To a pose it is a straight line.
    ///
    /// Options of every motion: `speed`, a factor; `limits`, a `Budget`; `gains`, `Gains`;
    /// `stiffness` at the end effector, 6 numbers; `force_cap`, N, or `None` for off; `leash`,
    /// `deviation`, `tolerance`, `settling`; `posture`, 7 joint positions; `until`, a
    /// condition; `start_with`, a `StartTicket`; and `joint_fallback`, whether the joints go there
    /// where the arm cannot follow the line. Raises `ValueError` for arguments that make no sense,
    /// and `MotionError` when it is awaited.
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

    /// A motion of the joints to `q`, 7 numbers, rad; all arrive together. Options as of `move_to`.
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

    /// A motion of the end effector away from where it is, or from the target of a motion under
    /// way: 3 numbers, m, or 6, with a rotation vector, rad; along and about the axes of the
    /// `base` or the `tool`. `from_arm` counts from the measured arm in any case. Options as of
    /// `move_to`.
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

    /// A motion through several poses, or several `Joints`, to the last of them, without a stop
    /// where the corner is rounded: within `blend` (m; rad for joints), or as each `Waypoint`
    /// says. Options as of `move_to`.
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

    /// Follows the newest of `targets`, poses or `Joints`, alone or with velocities as a pair,
    /// until they end, and then comes to rest at the last one. `targets` is a `Latest`, which
    /// any thread sets; an asynchronous iterator, which runs in the event loop that awaits; or
    /// a plain one, which runs on a thread of its own and may wait.
    ///
    /// Options as of `move_to`, and `lead`, a `Lead`: how far ahead of the arm a target may be; and
    /// `watchdog`, a pair of seconds and `brake` or `hold`: what happens if no target comes for so
    /// long. Nothing begins before the first target, and no watchdog counts until then. What the
    /// iterator raises brakes the arm and is raised.
    #[pyo3(signature = (targets, **options))]
    fn follow(
        this: &Bound<'_, Self>,
        targets: &Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<Follow>> {
        let robot = Leader::Robot(this.get().connected()?);
        follow::operation(this, "Robot.follow", robot, targets, options)
    }

    /// Begins a session that holds the arm where it is and goes from goal to goal without a stop in
    /// between: `async with robot.engage() as arm`, or `arm = await robot.engage()`.
    ///
    /// Options: `speed`, `limits`, `gains`, `force_cap`, `leash`, `deviation`, `posture` as of
    /// `move_to`, for all its goals; `keep_out`, regions (`Plane`, `Box`) that the arm keeps
    /// out of; `speed_cap`, in m/s, the most of any joint, the flange and the end effector;
    /// `deadman`, a `Deadman`; and `backend`, `torques` or a pair of a controller of
    /// the robot and its setpoints.
    #[pyo3(signature = (**options))]
    fn engage(
        &self,
        py: Python<'_>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<Engagement>> {
        Engagement::new(py, self.connected()?, options)
    }

    /// Where target control has the arm go in this millisecond: a `Reference`; `None` while it
    /// moves nothing.
    fn reference<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let newest = self.connected()?.reference();
        newest.map(|newest| reference(py, &newest)).transpose()
    }

    /// The limits that a motion keeps unless it is given others: a `Budget`.
    fn budget<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let robot = self.connected()?;
        let default = franka_async::goal::Budget::of(robot.model().joint_limits());
        budget_object(py, &default)
    }
}
