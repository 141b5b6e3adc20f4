//! Who may see and do what.

use std::future::Future;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use franka_async::connection::admission::{Admission, Token};
use franka_async::gripper::Gripper;
use franka_async::model::collision::Obstacle;
use franka_sim::Running;

use crate::recording::Writing;
use crate::simulated::Simulated;

/// Who may see and do what. The default is view-only, for this computer.
#[derive(Clone, Default)]
#[must_use = "options do nothing until `router` takes them"]
pub struct Options {
    pub(crate) admission: Admission,
    pub(crate) motion: bool,
    pub(crate) simulated: Option<Simulated>,
    pub(crate) gripper: Option<Gripper>,
    pub(crate) recordings: Option<PathBuf>,
    pub(crate) writing: Writing,
    pub(crate) patience: Duration,
    pub(crate) keep_out: Vec<Obstacle>,
    /// The names of all robots of the server, if there are several.
    pub(crate) siblings: Arc<[String]>,
}

impl Options {
    /// Lets the viewer that has the lease move the arm and recover the robot.
    pub fn allow_motion(mut self) -> Self {
        self.motion = true;
        self
    }

    /// Asks every page for this token, in the fragment of its address: `http://HOST/#TOKEN`. With
    /// it, other computers are served as well.
    pub fn token(mut self, token: Token) -> Self {
        self.admission = self.admission.token(token);
        self
    }

    /// Accepts requests under this name, besides `localhost` and addresses.
    pub fn host(mut self, name: impl Into<String>) -> Self {
        self.admission = self.admission.host(name);
        self
    }

    /// Lets the viewer that has the lease disturb this simulated robot, which has to be the one
    /// that is shown.
    pub fn simulated(mut self, running: &Arc<Running>) -> Self {
        self.simulated = Some(Simulated::new(running.clone()));
        self
    }

    /// Shows this Franka Hand beside the robot and, where motions are allowed, lets the viewer that
    /// has the lease move its fingers.
    pub fn gripper(mut self, gripper: Gripper) -> Self {
        self.gripper = Some(gripper);
        self
    }

    /// Lets the viewer that has the lease record the robot, and its gripper, to new files in this
    /// folder, which has to be there. They are named by the time; one ends when it is an hour long,
    /// and with the connection to the robot. See [`Self::recordings_ended`].
    pub fn record_to(mut self, folder: impl Into<PathBuf>) -> Self {
        self.recordings = Some(folder.into());
        self
    }

    /// Resolves when no recording is being written that a viewer has begun by these options, or by
    /// clones of them. Await it before the program ends, after
    /// [`Robot::shutdown`](franka_async::Robot::shutdown): a recording has no index and not its last
    /// second until then. The disk has 10 s for that.
    pub fn recordings_ended(&self) -> impl Future<Output = ()> + Send + 'static {
        self.writing.clone().none()
    }

    /// Keeps the arm out of these regions, base frame, in the motions of the page, which shows
    /// them. See [`Engage::keep_out`](franka_async::Engage::keep_out), which says how many there
    /// may be.
    pub fn keep_out(mut self, regions: impl IntoIterator<Item = Obstacle>) -> Self {
        self.keep_out = regions.into_iter().collect();
        self
    }

    /// Lets messages of a held button come this much later than they must: for tests of the page on
    /// a busy computer. Counts with [`Self::simulated`] only: a robot has no patience.
    pub fn patience(mut self, patience: Duration) -> Self {
        self.patience = patience;
        self
    }
}

impl std::fmt::Debug for Options {
    /// Without the token.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Options")
            .field("motion", &self.motion)
            .field("simulated", &self.simulated.is_some())
            .field("gripper", &self.gripper)
            .field("recordings", &self.recordings)
            .finish_non_exhaustive()
    }
}
