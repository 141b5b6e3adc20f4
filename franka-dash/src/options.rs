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

/// Permissions of viewers. By default, viewers on this computer can watch, and do nothing else.
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
    /// The names of all robots of the server, if it has several.
    pub(crate) siblings: Arc<[String]>,
}

impl Options {
    /// Allows the viewer with the lease to move the arm and recover the robot.
    pub fn allow_motion(mut self) -> Self {
        self.motion = true;
        self
    }

    /// Requires this token from every page, in the fragment of the page's address:
    /// `http://HOST/#TOKEN`. The server then also accepts other computers.
    pub fn token(mut self, token: Token) -> Self {
        self.admission = self.admission.token(token);
        self
    }

    /// Accepts requests with this host name, in addition to `localhost` and IP addresses.
    pub fn host(mut self, name: impl Into<String>) -> Self {
        self.admission = self.admission.host(name);
        self
    }

    /// Allows the viewer with the lease to disturb this simulated robot. It must be the displayed
    /// robot.
    pub fn simulated(mut self, running: &Arc<Running>) -> Self {
        self.simulated = Some(Simulated::new(running.clone()));
        self
    }

    /// Shows this Franka Hand with the robot. If motions are allowed, the viewer with the lease can
    /// move its fingers.
    pub fn gripper(mut self, gripper: Gripper) -> Self {
        self.gripper = Some(gripper);
        self
    }

    /// Allows the viewer with the lease to record the robot, and its gripper, to new files in this
    /// existing folder. The time gives the name of a file. A recording ends after an hour, or when
    /// the connection to the robot ends. See [`Self::recordings_ended`].
    pub fn record_to(mut self, folder: impl Into<PathBuf>) -> Self {
        self.recordings = Some(folder.into());
        self
    }

    /// Resolves when all recordings that viewers started under these options, or under clones of
    /// them, have been written. Before the program ends, call
    /// [`Robot::shutdown`](franka_async::Robot::shutdown) and then await this future. Otherwise a
    /// recording may lack its index and its last second. Writing takes at most 10 s.
    pub fn recordings_ended(&self) -> impl Future<Output = ()> + Send + 'static {
        self.writing.clone().none()
    }

    /// Keeps the arm out of these regions, given in the base frame, in the motions of the page. The
    /// page shows them. See [`Engage::keep_out`](franka_async::Engage::keep_out) for the number of
    /// regions allowed.
    pub fn keep_out(mut self, regions: impl IntoIterator<Item = Obstacle>) -> Self {
        self.keep_out = regions.into_iter().collect();
        self
    }

    /// Allows messages of a held button to be late by this duration. Use it to test the page on a
    /// busy computer. It has an effect only with [`Self::simulated`], never with a real robot.
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
