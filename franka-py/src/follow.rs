//! Following of targets from Python.

use std::sync::{Mutex, PoisonError};

use franka_async::goal::{Lead, Target};
use franka_async::motion::Follow as Following;
use futures::{Stream, StreamExt, future, stream};
use pyo3::exceptions::{PyRuntimeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyAny, PyDict};
use tokio::sync::{oneshot, watch};

use crate::destination::target;
use crate::errors::Raise;
use crate::exit;
use crate::motion::{Follow, Member, Report};
use crate::operation::Operation;
use crate::options::{Bounds, Keywords, Options, watchdog, with_options};
use crate::told::{Telling, Told};

/// The newest target of a program: `set` it from any thread, at any rate, and `follow` it. When it
/// is closed or its last reference is dropped, the motion ends at the last target.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Latest(Mutex<Option<watch::Sender<Option<Target>>>>);

#[pymethods]
impl Latest {
    /// Begins with `target`, or without one: a motion that follows it then begins with the first
    /// target.
    #[new]
    #[pyo3(signature = (target = None))]
    fn new(target: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let first = target
            .map(|target| self::target("target", target))
            .transpose()?;
        Ok(Self(Mutex::new(Some(watch::Sender::new(first)))))
    }

    /// Replaces the target with a pose, `Joints`, or a pair with velocities. Never waits.
    fn set(&self, target: &Bound<'_, PyAny>) -> PyResult<()> {
        let target = self::target("target", target)?;
        match &*self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(sender) => drop(sender.send_replace(Some(target))),
            None => return Err(PyRuntimeError::new_err("set() after close()")),
        }
        Ok(())
    }

    /// Ends the motions that follow it, at the last target. Motions of an arm whose deadman is
    /// silent raise `held`.
    fn close(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take();
    }

    fn __repr__(&self) -> &'static str {
        match &*self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            None => "<Latest, closed>",
            Some(sender) if sender.borrow().is_none() => "<Latest, without a target yet>",
            Some(_) => "<Latest, with a target>",
        }
    }
}

impl Latest {
    /// Returns the targets from now on, beginning with the current one.
    fn targets(&self) -> impl Stream<Item = Target> + Send + 'static {
        let receiver = match &*self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(sender) => sender.subscribe(),
            None => watch::channel(None).1,
        };
        let mut receiver = receiver;
        receiver.mark_changed();
        let targets = stream::unfold(receiver, async |mut receiver| {
            receiver.changed().await.ok()?;
            let target = *receiver.borrow_and_update();
            Some((target, receiver))
        });
        targets.filter_map(future::ready)
    }
}

/// The source of targets.
pub(crate) enum Leader {
    Robot(franka_async::Robot),
    Arm((Told, franka_async::Arm)),
}

impl Leader {
    fn robot(&self) -> &franka_async::Robot {
        match self {
            Self::Robot(robot) => robot,
            Self::Arm((_, arm)) => arm.robot(),
        }
    }

    fn follow(&self, targets: impl Stream<Item = Target> + Send + 'static) -> Following {
        match self {
            Self::Robot(robot) => robot.follow_stream(targets),
            Self::Arm((_, arm)) => arm.follow_stream(targets),
        }
    }

    fn session(self) -> Option<(Told, franka_async::Arm)> {
        match self {
            Self::Robot(_) => None,
            Self::Arm(session) => Some(session),
        }
    }
}

/// Returns the operation `name` of `owner`: `leader` follows `targets`.
pub(crate) fn operation(
    owner: &Bound<'_, PyAny>,
    name: &'static str,
    leader: Leader,
    targets: &Bound<'_, PyAny>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Py<Follow>> {
    let py = owner.py();
    let mut keywords = Keywords::new(name, options)?;
    let common = Options::of_goal(&mut keywords, leader.robot().model())?;
    let lead: Option<Bounds> = keywords.value("lead")?;
    let given_up = keywords.read("watchdog", watchdog)?;
    keywords.end()?;
    let configured = move |follow: Following| {
        let mut follow = with_options!(follow, common);
        if let Some(lead) = lead {
            follow = follow.lead(Lead {
                translation: lead.translation,
                rotation: lead.rotation,
                joints: lead.joints,
            });
        }
        match given_up {
            Some((silence, on_timeout)) => follow.watchdog(silence, on_timeout),
            None => follow,
        }
    };
    if let Ok(latest) = targets.cast::<Latest>() {
        let follow = configured(leader.follow(latest.get().targets()));
        let (operation, member) = Member::new(name, follow);
        return Follow::new(py, operation, Some(member));
    }
    if targets.hasattr("__aiter__")? {
        // Follows a `Latest` that a coroutine sets, in the event loop.
        let follow = py.import("franka_async.following")?.getattr("follow")?;
        let coroutine = follow.call1((owner.getattr("follow")?, targets, options))?;
        return Follow::new(py, Operation::of_coroutine(name, coroutine.unbind()), None);
    }
    let Ok(iterator) = targets.try_iter() else {
        return Err(PyTypeError::new_err(format!(
            "targets is {}, expected a Latest, an asynchronous iterator or an iterator",
            targets.repr()?
        )));
    };
    let (failed, failure) = oneshot::channel();
    let follow = configured(leader.follow(stepped(iterator.into_any().unbind(), failed)));
    let of = leader.session();
    let operation = Operation::new(name, async move {
        tokio::select! {
            biased;
            Ok(error) = failure => Err(Failure::Iterator(error)),
            outcome = follow.into_future() => {
                if let Some((told, _)) = &of {
                    told.saw(&outcome);
                }
                outcome.map(Report).map_err(|error| Failure::Motion(Telling { error, of }))
            }
        }
    });
    Follow::new(py, operation, None)
}

/// Returns the targets of a Python iterator. Each is fetched on a thread that may wait, once the
/// previous target has been passed on. An exception goes to `failed` and ends the targets.
fn stepped(
    iterator: Py<PyAny>,
    failed: oneshot::Sender<PyErr>,
) -> impl Stream<Item = Target> + Send + 'static {
    stream::unfold((iterator, failed), async |(iterator, failed)| {
        let step = move || {
            exit::in_python(|py| {
                let next = iterator.bind(py).call_method0("__next__");
                let next = next.and_then(|next| target("a target", &next));
                match next {
                    Ok(target) => Ok(Some((target, iterator))),
                    Err(end) if end.is_instance_of::<pyo3::exceptions::PyStopIteration>(py) => {
                        Ok(None)
                    }
                    Err(error) => Err(error),
                }
            })
            .unwrap_or(Ok(None))
        };
        let stepped = tokio::task::spawn_blocking(step).await;
        match stepped.expect("it is neither cancelled nor does it panic") {
            Ok(Some((target, iterator))) => Some((target, (iterator, failed))),
            Ok(None) => None,
            Err(error) => {
                // Fails if the motion has ended.
                let _ = failed.send(error);
                future::pending().await
            }
        }
    })
}

/// The reason why following an iterator ended early.
enum Failure {
    Motion(Telling),
    Iterator(PyErr),
}

impl Raise for Failure {
    fn raise(self, py: Python<'_>) -> PyErr {
        match self {
            Self::Motion(error) => error.raise(py),
            Self::Iterator(error) => error,
        }
    }
}
