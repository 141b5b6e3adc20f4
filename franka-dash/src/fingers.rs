//! Controls a Franka Hand for viewers. A stop ends an action. An action also ends when its viewer
//! loses the lease. A held object stays held.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use franka_async::connection::CancellationToken;
use franka_async::error::GripperError;
use franka_async::gripper::{Grasp, Gripper};
use serde::Serialize;

use crate::request::GripperAction;
use crate::viewer_lease::ViewerId;

/// A Franka Hand that viewers can move.
#[derive(Clone)]
pub(crate) struct Fingers {
    pub(crate) gripper: Gripper,
    under_way: Arc<Mutex<Option<UnderWay>>>,
}

/// The current action of the fingers. Dropping this value ends the action.
struct UnderWay {
    viewer: ViewerId,
    end: CancellationToken,
}

impl Drop for UnderWay {
    fn drop(&mut self) {
        self.end.cancel();
    }
}

#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct FingerState {
    width: f64,
    max_width: f64,
    is_grasped: bool,
    temperature: u16,
    /// True while an action of the fingers is running.
    acting: bool,
}

impl Fingers {
    pub(crate) fn new(gripper: Gripper) -> Self {
        Self {
            gripper,
            under_way: Arc::default(),
        }
    }

    /// Distance between the fingers, `[m]`.
    pub(crate) fn width(&self) -> f64 {
        self.gripper.state().width
    }

    pub(crate) fn state(&self) -> FingerState {
        let state = self.gripper.state();
        FingerState {
            width: state.width,
            max_width: state.max_width,
            is_grasped: state.is_grasped,
            temperature: state.temperature,
            acting: self.lock().is_some(),
        }
    }

    /// Starts an action for a viewer and ends the previous action. The future resolves with the
    /// result: true for success, and a line of text.
    pub(crate) fn begin(
        &self,
        viewer: ViewerId,
        action: GripperAction,
    ) -> impl Future<Output = (bool, String)> + Send + use<> {
        let end = CancellationToken::new();
        let under_way = UnderWay {
            viewer,
            end: end.clone(),
        };
        *self.lock() = Some(under_way);
        let fingers = self.clone();
        async move {
            let outcome = tokio::select! {
                biased;
                // Dropping an action stops the fingers.
                () = end.cancelled() => return (false, "Gripper: stopped".to_owned()),
                outcome = act(&fingers.gripper, action) => outcome,
            };
            // Clears the action unless a newer action has replaced it.
            fingers.lock().take_if(|_| !end.is_cancelled());
            let text = match &outcome {
                Ok(done) => word(action, *done),
                Err(error) => &error.to_string(),
            };
            (matches!(outcome, Ok(true)), format!("Gripper: {text}"))
        }
    }

    pub(crate) fn end(&self) {
        self.lock().take();
    }

    pub(crate) fn end_unless(&self, commander: Option<ViewerId>) {
        self.lock().take_if(|it| Some(it.viewer) != commander);
    }

    fn lock(&self) -> MutexGuard<'_, Option<UnderWay>> {
        self.under_way
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }
}

async fn act(gripper: &Gripper, action: GripperAction) -> Result<bool, GripperError> {
    match action {
        GripperAction::Home {} => gripper.homing().await,
        GripperAction::Move { width, speed } => gripper.move_to(width, speed).await,
        GripperAction::Grasp {
            width,
            tolerance,
            speed,
            force,
        } => {
            let grasp = Grasp {
                width,
                epsilon_inner: tolerance,
                epsilon_outer: tolerance,
                speed,
                force,
            };
            gripper.grasp(grasp).await
        }
        GripperAction::Stop {} => gripper.stop().await,
    }
}

fn word(action: GripperAction, done: bool) -> &'static str {
    match (action, done) {
        (GripperAction::Home {}, true) => "homed: the greatest width is known",
        (GripperAction::Home {}, false) => "homing failed: the greatest width is unknown",
        (GripperAction::Move { .. }, true) => "reached the width",
        (GripperAction::Move { .. }, false) => {
            "did not reach the width: home the gripper first, and choose at most its greatest width"
        }
        (GripperAction::Grasp { .. }, true) => "holds the object",
        (GripperAction::Grasp { .. }, false) => {
            "closed, but not at the width of the object; the force remains until Stop"
        }
        (GripperAction::Stop {}, true) => "released",
        (GripperAction::Stop {}, false) => "did not stop",
    }
}
