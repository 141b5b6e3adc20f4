//! Permissions of viewers.

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

/// Permissions of viewers. By default, viewers on this computer can only watch.
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
    /// Names of all robots of the server, if it has several robots.
    pub(crate) siblings: Arc<[String]>,
}

impl Options {
    /// Allows the viewer that has the lease to move the arm and recover the robot.
    pub fn allow_motion(mut self) -> Self {
        self.motion = true;
        self
    }

    /// Sets the token that every page must send. A page receives the token in the fragment of its
    /// address: `http://HOST/#TOKEN`. With a token, the server also accepts other computers.
    pub fn token(mut self, token: Token) -> Self {
        self.admission = self.admission.token(token);
        self
    }

    /// Accepts requests with this host name, in addition to `localhost` and IP addresses.
    pub fn host(mut self, name: impl Into<String>) -> Self {
        self.admission = self.admission.host(name);
        self
    }

    /// Allows the viewer that has the lease to disturb `running`. This must be the simulated robot
    /// that the page shows.
    pub fn simulated(mut self, running: &Arc<Running>) -> Self {
        self.simulated = Some(Simulated::new(running.clone()));
        self
    }

    /// Shows a Franka Hand with the robot. If motions are allowed, the viewer that has the lease
    /// can also move the fingers.
    pub fn gripper(mut self, gripper: Gripper) -> Self {
        self.gripper = Some(gripper);
        self
    }

    /// Allows the viewer that has the lease to record the robot and its gripper. Each recording is
    /// a new file in `folder`, which must exist, and the file's name contains the time. A recording
    /// ends after an hour, or when the connection to the robot ends. See
    /// [`Self::recordings_ended`].
    pub fn record_to(mut self, folder: impl Into<PathBuf>) -> Self {
        self.recordings = Some(folder.into());
        self
    }

    /// Returns a future that resolves when all recordings under these options, or under clones of
    /// them, have been written. Before the program ends, call
    /// [`Robot::shutdown`](franka_async::Robot::shutdown) and then await this future. Otherwise a
    /// recording can lack its index and its last second. Writing takes at most 10 s.
    pub fn recordings_ended(&self) -> impl Future<Output = ()> + Send + 'static {
        self.writing.clone().none()
    }

    /// Keeps the arm out of these regions of the base frame in all motions of the page. The page
    /// shows the regions. See [`Engage::keep_out`](franka_async::Engage::keep_out) for the largest
    /// number of regions.
    pub fn keep_out(mut self, regions: impl IntoIterator<Item = Obstacle>) -> Self {
        self.keep_out = regions.into_iter().collect();
        self
    }

    /// Sets how late the messages of a held button may be. Use this option to test the page on a
    /// busy computer. It has an effect only together with [`Self::simulated`], never with a real
    /// robot.
    pub fn patience(mut self, patience: Duration) -> Self {
        self.patience = patience;
        self
    }
}

impl std::fmt::Debug for Options {
    /// Formats the options without the token.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Options")
            .field("motion", &self.motion)
            .field("simulated", &self.simulated.is_some())
            .field("gripper", &self.gripper)
            .field("recordings", &self.recordings)
            .finish_non_exhaustive()
    }
}
