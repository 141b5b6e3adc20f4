//! The tare (the zero) of the displayed wrench.

use std::sync::Arc;

use franka_async::state::WrenchTare;
use franka_async::supervision::EventKind;

use super::Hub;
use crate::reply::Level;

/// The tare of the wrench, and the number of the request for it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tared {
    /// Number of requests so far that took or cleared the tare.
    number: u64,
    pub(crate) tare: Option<WrenchTare>,
}

impl Hub {
    /// Takes or clears the tare of the wrench. Only the newest request has an effect.
    pub(super) fn tare(self: &Arc<Self>, on: bool) {
        let Some(robot) = self.source.robot() else {
            return;
        };
        let mut number = 0;
        self.tare.send_modify(|tared| {
            tared.number += 1;
            number = tared.number;
            tared.tare = tared.tare.filter(|_| on);
        });
        if !on {
            return;
        }
        let (robot, hub) = (robot.clone(), self.clone());
        tokio::spawn(async move {
            let taken = robot.tare().await;
            let newest = hub.tare.send_if_modified(|tared| {
                let newest = tared.number == number;
                if let (true, Ok(tare)) = (newest, &taken) {
                    tared.tare = Some(*tare);
                }
                newest
            });
            match taken {
                _ if !newest => {}
                Ok(_) => hub.tell(Level::Info, "Tare taken".into(), None),
                Err(error) => hub.tell(Level::Warning, format!("Tare failed: {error}"), None),
            }
        });
    }

    /// Clears the tare, and cancels a tare in progress, if the event changed how the robot computes
    /// the wrench.
    pub(super) fn check_tare(&self, event: &EventKind) {
        let why = match event {
            EventKind::LoadChanged { .. } => "the load has changed",
            EventKind::Unrecognised { .. } => {
                "the robot is not as it was before the \
                connection was lost"
            }
            _ => return,
        };
        let mut was_tared = false;
        self.tare.send_if_modified(|tared| {
            tared.number += 1;
            was_tared = tared.tare.take().is_some();
            was_tared
        });
        if was_tared {
            let text = format!("Tare cleared: {why}. Take a new tare");
            self.tell(Level::Warning, text, None);
        }
    }
}
