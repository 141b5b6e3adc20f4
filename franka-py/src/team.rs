//! Several arms as one: motions that begin together, and a common stop.

use std::future::Future;
use std::pin::Pin;
use std::sync::Arc;
use std::time::Duration;

use franka_async::error::Lapse;
use franka_async::motion::Outcome;
use franka_async::team::{MEMBERS_MAX, MemberMotion, SILENCE, Team as Joint, TeamStop};
use franka_async::{Engage, MotionError, Pose};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyAny, PyDict, PyList, PyTuple};

use crate::arm::Arm;
use crate::arrays::{pose, pose_array};
use crate::destination::destination;
use crate::errors::Raise;
use crate::motion::{Member, Report};
use crate::names::Named;
use crate::operation::{Operation, seconds};
use crate::options::{Keywords, Options, with_options};
use crate::robot::Robot;
use crate::runtime::Threaded;
use crate::told::Told;

/// A team of any size.
pub(crate) enum Members {
    Two(Joint<2>),
    Three(Joint<3>),
    Four(Joint<4>),
}

/// Runs the same code with a team of any size.
macro_rules! with_team {
    ($members:expr, $team:ident => $act:expr) => {
        match $members {
            Members::Two($team) => $act,
            Members::Three($team) => $act,
            Members::Four($team) => $act,
        }
    };
}

type Outcomes = Pin<Box<dyn Future<Output = Vec<Outcome>> + Send>>;

/// Two to four arms that move and stop together: `async with await Team.engage(left, right) as
/// team:`. Their motions begin within a millisecond of each other, and a fault of one arm brakes
/// the other arms within two cycles of their control threads, independent of Python.
///
/// A team motion returns a list of one `MotionReport` for each arm. If an arm has not arrived, the
/// motion raises `TeamError` with `outcomes`, one for each arm; the error of the arm at fault is
/// the `TeamError`'s cause. Cancelling a team motion brakes all arms. When the last reference to
/// the team and its arms is dropped, all arms brake and their sessions end.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Team {
    pub(crate) members: Threaded<Arc<Members>>,
    arms: Vec<Py<Arm>>,
}

#[pymethods]
impl Team {
    /// Begins a session for each robot, like `Robot.engage`, with the same options for all:
    /// `speed`, `limits`, `gains`, `force_cap`, `leash`, `deviation`, `posture`, `speed_cap`;
    /// returns a `Team`. If a robot is silent for `silence` seconds, the other arms brake. Raises
    /// `MotionError` of the first arm that could not be engaged; the other arms are then released.
    /// Cancelling ends all sessions.
    #[staticmethod]
    #[pyo3(signature = (*robots, silence = SILENCE.as_secs_f64(), **options))]
    fn engage(
        robots: &Bound<'_, PyTuple>,
        silence: f64,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Operation> {
        let silence = seconds("silence", silence)?;
        let mut engaged = Vec::with_capacity(robots.len());
        for robot in robots.iter() {
            let robot = robot.cast::<Robot>()?.get().connected()?;
            let mut keywords = Keywords::new("Team.engage", options)?;
            let common = Options::of_session(&mut keywords, robot.model())?;
            let mut engage = with_options!(Engage::default(), common, session);
            if let Some(cap) = keywords.take("speed_cap")? {
                engage = engage.speed_cap(cap.extract()?);
            }
            keywords.end()?;
            engaged.push((robot, engage));
        }
        if !(2..=MEMBERS_MAX.min(4)).contains(&engaged.len()) {
            let text = format!("got {} robots, expected 2 to 4", engaged.len());
            return Err(PyValueError::new_err(text));
        }
        Ok(Operation::new("Team.engage", async move {
            let members = match engaged.len() {
                2 => Members::Two(begin(engaged, silence).await?),
                3 => Members::Three(begin(engaged, silence).await?),
                _ => Members::Four(begin(engaged, silence).await?),
            };
            Ok::<_, franka_async::Error>(Engaged(members))
        }))
    }

    /// The arms, in the order of the robots.
    #[getter]
    fn arms(&self, py: Python<'_>) -> Vec<Py<Arm>> {
        self.arms.iter().map(|arm| arm.clone_ref(py)).collect()
    }

    /// A motion of all arms, each to its own target as in `Arm.move_to`, with the same options for
    /// all arms.
    #[pyo3(signature = (targets, **options))]
    fn move_to(
        &self,
        targets: Vec<Bound<'_, PyAny>>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Operation> {
        self.check_count("targets", targets.len())?;
        let mut motions = Vec::with_capacity(targets.len());
        for (arm, target) in self.arms.iter().zip(&targets) {
            let arm = arm.get().session()?;
            let mut keywords = Keywords::new("Team.move_to", options)?;
            let options = Options::of_goal(&mut keywords, arm.robot().model())?;
            keywords.end()?;
            let target = destination("targets", target)?;
            motions.push(with_options!(arm.move_to(target), options).into());
        }
        self.joint("Team.move_to", motions)
    }

    /// A motion of all arms: `motions` contains one motion for each arm, in the order of the arms,
    /// `[team.arms[0].move_to(a), team.arms[1].move_by(b)]`; do not await these motions themselves.
    /// All motions begin together. An arm can also follow a `Latest`,
    /// `team.arms[1].follow(latest)`: this arm begins with the first target. The team motion ends
    /// when the other arms have arrived and the `Latest` is closed.
    fn run(&self, motions: Vec<Bound<'_, PyAny>>) -> PyResult<Operation> {
        self.check_count("motions", motions.len())?;
        let arms = self.arms.iter().map(|arm| &arm.get().told);
        let motions = Member::take_all(&motions, arms)?;
        self.joint("Team.run", motions)
    }

    /// Brakes all arms, each within two of its cycles. Never waits, and can be called from any
    /// thread. Motions raise; the sessions continue and hold the arms. A team motion that begins
    /// before every arm has seen the stop does not start, and raises in the same way.
    fn stop(&self) {
        with_team!(&**self.members, team => team.stop());
    }

    /// Brakes all arms like `stop`, ends their sessions and latches the stop of each robot: see
    /// `Robot.latch_stop`. Waits until all are at rest, and raises the `MotionError` of the first
    /// arm that was not seen at rest.
    fn latch_stop(&self) -> Operation {
        let members = Arc::clone(&self.members);
        Operation::new("Team.latch_stop", async move {
            with_team!(&*members, team => {
                let stops = team.latch_stop().await;
                stops.into_iter().collect::<Result<(), _>>()
            })
        })
    }

    /// Releases the latched stop of each robot, and returns `True` if one was latched. The sessions
    /// have ended: the next motions need a new team.
    fn release_stop(&self) -> bool {
        with_team!(&**self.members, team => team.release_stop())
    }

    /// Reason why the newest team motion, or the team after that motion, has stopped: `requested`,
    /// or the name of the event with the number of the arm, `("robot_stopped", 1)`; `None` without
    /// a stop.
    fn stopped<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let stopped = with_team!(&**self.members, team => team.stopped());
        Ok(match stopped {
            None => None,
            Some(TeamStop::Member { member, fault }) => {
                Some((fault.python_name(), member).into_pyobject(py)?.into_any())
            }
            Some(other) => Some(other.python_name().into_pyobject(py)?.into_any()),
        })
    }

    /// Declares an object as held by all arms from now on, in its current place: `bases` are the
    /// robots' base frames and `object` is the object's, poses in one frame of the program's
    /// choice. The arms do not move. Raises `MotionError` if a session has ended.
    fn grasp(
        this: &Bound<'_, Self>,
        bases: Vec<Bound<'_, PyAny>>,
        object: &Bound<'_, PyAny>,
    ) -> PyResult<TeamGrasp> {
        let team = this.get();
        team.check_count("bases", bases.len())?;
        let bases: PyResult<Vec<Pose>> = bases.iter().map(|base| pose("bases", base)).collect();
        let (bases, object) = (bases?, pose("object", object)?);
        let hands = with_team!(&**team.members, joint => {
            joint.grasp(sized(&bases), object).map(|grasp| grasp.hands().to_vec())
        });
        Ok(TeamGrasp {
            hands: hands.map_err(|error| error.raise(this.py()))?,
            team: this.clone().unbind(),
            bases,
        })
    }

    /// Brakes and releases all arms and ends their sessions. Raises `TeamError` if a session ended
    /// in another way.
    fn disengage(&self) -> PyResult<Operation> {
        let (sessions, ended) = self.ending()?;
        Ok(Operation::new("Team.disengage", async move {
            judge(ended.await, sessions)
        }))
    }

    fn __aenter__(this: Py<Self>) -> Operation {
        Operation::infallible("Team", async move { this })
    }

    #[pyo3(signature = (kind = None, *_rest))]
    fn __aexit__(
        &self,
        kind: Option<&Bound<'_, PyAny>>,
        _rest: &Bound<'_, PyAny>,
    ) -> PyResult<Operation> {
        let raised = kind.is_some_and(|kind| !kind.is_none());
        let (sessions, ended) = self.ending()?;
        Ok(Operation::new("Team.disengage", async move {
            match judge(ended.await, sessions) {
                // The block's exception is not replaced, and known errors are not repeated.
                Err(error) if !raised && !error.is_known() => Err(error),
                _ => Ok(()),
            }
        }))
    }

    fn __len__(&self) -> usize {
        self.arms.len()
    }

    fn __repr__(&self) -> String {
        format!("<Team of {} arms>", self.arms.len())
    }
}

impl Team {
    pub(crate) fn check_count(&self, name: &str, got: usize) -> PyResult<()> {
        let expected = self.arms.len();
        if got == expected {
            return Ok(());
        }
        let text = format!("got {got} {name}, expected {expected}, one for each arm");
        Err(PyTypeError::new_err(text))
    }

    fn sessions(&self) -> PyResult<Vec<Session>> {
        let sessions = self.arms.iter().map(|arm| arm.get().told_session());
        sessions.collect()
    }

    /// Returns the sessions, and their end.
    fn ending(&self) -> PyResult<(Vec<Session>, impl Future<Output = Vec<Outcome>> + use<>)> {
        let sessions = self.sessions()?;
        let ending = sessions.iter().map(|(_, arm)| arm.clone().disengage());
        let ended = futures::future::join_all(ending);
        Ok((sessions, ended))
    }

    fn joint(&self, name: &'static str, motions: Vec<MemberMotion>) -> PyResult<Operation> {
        let members = Arc::clone(&self.members);
        let sessions = self.sessions()?;
        Ok(Operation::new(name, async move {
            let running: Outcomes = with_team!(&*members, team => {
                let mut motions = motions.into_iter();
                let motion = team.run(|_, _| motions.next().expect("one for each arm"));
                Box::pin(async move { motion.await.into() })
            });
            judge(running.await, sessions)
        }))
    }
}

/// An object that all arms of a team hold: created by `Team.grasp`.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct TeamGrasp {
    team: Py<Team>,
    bases: Vec<Pose>,
    /// The object in the frame of each end effector.
    hands: Vec<Pose>,
}

#[pymethods]
impl TeamGrasp {
    /// A motion of the object to this pose, in the frame of the bases, on a straight line; with
    /// options of `Arm.move_to` except `limits`, the same for all arms. If one arm is blocked, the
    /// others wait.
    #[pyo3(signature = (object, **options))]
    fn move_to(
        &self,
        object: &Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Operation> {
        let object = pose("object", object)?;
        let team = self.team.get();
        let mut chosen = Vec::with_capacity(team.arms.len());
        for arm in &team.arms {
            let mut keywords = Keywords::new("TeamGrasp.move_to", options)?;
            let model = arm.get().session()?;
            chosen.push(Options::of_goal(&mut keywords, model.robot().model())?);
            keywords.end()?;
        }
        let members = Arc::clone(&team.members);
        let sessions = team.sessions()?;
        let (bases, hands) = (self.bases.clone(), self.hands.clone());
        Ok(Operation::new("TeamGrasp.move_to", async move {
            let running: Outcomes = with_team!(&*members, team => {
                let grasp = team.grasp_at(sized(&bases), sized(&hands));
                // The options of the members are in their order.
                let chosen = std::cell::RefCell::new(chosen.into_iter());
                let motion = grasp.move_with(object, |motion| {
                    let options = chosen.borrow_mut().next().expect("one for each arm");
                    with_options!(motion, options)
                });
                Box::pin(async move { motion.await.into() })
            });
            judge(running.await, sessions)
        }))
    }

    /// Pose of the object from the newest state of each arm, in the frame of the bases: a list of
    /// `(4, 4)`.
    fn measured<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let measured: Vec<Pose> = with_team!(&**self.team.get().members, team => {
            team.grasp_at(sized(&self.bases), sized(&self.hands)).measured().into()
        });
        PyList::new(py, measured.iter().map(|pose| pose_array(py, pose)))
    }
}

/// Converts to an array; the number of members was checked.
fn sized<const N: usize>(poses: &[Pose]) -> [Pose; N] {
    poses.try_into().expect("one for each arm")
}

async fn begin<const N: usize>(
    robots: Vec<(franka_async::Robot, Engage)>,
    silence: Duration,
) -> Result<Joint<N>, franka_async::Error> {
    let (robots, engages): (Vec<_>, Vec<_>) = robots.into_iter().unzip();
    let mut engages = engages.into_iter();
    let members: [_; N] =
        core::array::from_fn(|i| (&robots[i], engages.next().expect("one for each robot")));
    Ok(Joint::engage_tolerating(silence, members).await?)
}

/// A new team, converted to a `Team`.
struct Engaged(Members);

impl<'py> IntoPyObject<'py> for Engaged {
    type Target = Team;
    type Output = Bound<'py, Team>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Bound<'py, Team>> {
        let arms: Vec<franka_async::Arm> = with_team!(&self.0, team => team.arms().to_vec());
        let arms: PyResult<Vec<_>> = arms
            .into_iter()
            .map(|arm| Py::new(py, Arm::new(arm, Told::default())))
            .collect();
        let team = Team {
            members: Threaded::new(Arc::new(self.0)),
            arms: arms?,
        };
        Bound::new(py, team)
    }
}

/// The reports of all members, if all have arrived.
struct Reports(Vec<Report>);

impl<'py> IntoPyObject<'py> for Reports {
    type Target = PyList;
    type Output = Bound<'py, PyList>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let reports: PyResult<Vec<_>> = self
            .0
            .into_iter()
            .map(|report| report.into_pyobject(py))
            .collect();
        PyList::new(py, reports?)
    }
}

/// The outcomes of a motion in which a member has not arrived.
struct Failed {
    outcomes: Vec<Outcome>,
    /// One session for each.
    sessions: Vec<Session>,
}

/// A session, with its raised errors.
type Session = (Told, franka_async::Arm);

fn judge(outcomes: Vec<Outcome>, sessions: Vec<Session>) -> Result<Reports, Failed> {
    for (outcome, (told, _)) in outcomes.iter().zip(&sessions) {
        told.saw(outcome);
    }
    if outcomes.iter().any(Result::is_err) {
        return Err(Failed { outcomes, sessions });
    }
    let reports = outcomes.into_iter().flatten().map(Report);
    Ok(Reports(reports.collect()))
}

impl Failed {
    /// Returns the errors, each with its session.
    fn errors(&self) -> impl Iterator<Item = (&MotionError, &Session)> {
        let each = self.outcomes.iter().zip(&self.sessions);
        each.filter_map(|(outcome, session)| Some((outcome.as_ref().err()?, session)))
    }

    /// True if all errors were raised before.
    fn is_known(&self) -> bool {
        self.errors().all(|(error, (told, _))| told.knows(error))
    }
}

impl Raise for Failed {
    fn raise(self, py: Python<'_>) -> PyErr {
        for (error, (told, arm)) in self.errors() {
            told.note(arm, error);
        }
        raised(py, self.outcomes).unwrap_or_else(|broken| broken)
    }
}

fn raised(py: Python<'_>, outcomes: Vec<Outcome>) -> PyResult<PyErr> {
    // The arm at fault, rather than the arms that were braked because of it.
    let follows = |error: &MotionError| matches!(error, MotionError::Braked(Lapse::Team(_)));
    let failed = |outcome: &Outcome| outcome.is_err();
    let at_fault = |outcome: &Outcome| outcome.as_ref().is_err_and(|error| !follows(error));
    let member = outcomes.iter().position(at_fault);
    let member = member
        .or_else(|| outcomes.iter().position(failed))
        .unwrap_or_default();
    let all = PyList::empty(py);
    for outcome in outcomes {
        match outcome {
            Ok(report) => all.append(Report(report).into_pyobject(py)?)?,
            Err(error) => all.append(error.raise(py).into_value(py))?,
        }
    }
    let cause = all.get_item(member)?;
    let class = py.import("franka_async.errors")?.getattr("TeamError")?;
    let error = class.call1((format!("arm {member}: {}", cause.str()?),))?;
    for name in ["kind", "party", "is_ready_for_more"] {
        error.setattr(name, cause.getattr(name)?)?;
    }
    error.setattr("member", member)?;
    error.setattr("outcomes", all)?;
    error.setattr("__cause__", cause)?;
    Ok(PyErr::from_value(error))
}
