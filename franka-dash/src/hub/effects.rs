//! Performs the effects of requests that the lease has allowed.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use franka_async::Robot;
use tokio::sync::watch;

use super::{Command, Hub};
use crate::hold::{self, Ended, Hold, Settings, Task};
use crate::plan::{Plan, Question};
use crate::reply::Level;
use crate::request::{Disturbance, GripperAction, Motion};
use crate::source::Source;
use crate::viewer_lease::{Effect, ViewerId};

impl Hub {
    /// Performs an effect. If the effect is a question, returns the question, which the viewer's
    /// socket then answers.
    pub(super) fn perform(
        self: &Arc<Self>,
        command: &mut Command,
        viewer: ViewerId,
        effect: Effect,
    ) -> Option<Question> {
        match effect {
            Effect::Preview {
                number,
                motion,
                speed,
            } => {
                return Some(Question {
                    number,
                    motion,
                    speed,
                });
            }
            Effect::KeepAlive => {
                if let Some(hold) = &command.hold {
                    hold.keep_alive();
                }
            }
            Effect::Begin {
                hold,
                motion,
                speed,
            } => {
                command.settings.send_modify(|it| it.speed = speed);
                command.hold = self.begin(hold, motion, command.settings.subscribe());
            }
            Effect::Tune(tuning) => command.settings.send_modify(|it| it.tuning = tuning),
            Effect::Tare(on) => self.tare(on),
            Effect::Speed(speed) => command.settings.send_modify(|it| it.speed = speed),
            Effect::Gripper(action) => self.move_fingers(viewer, action),
            Effect::Record(on) => self.record(on),
            Effect::Stop => self.stop(),
            Effect::Recover => {
                if let Source::Robot(robot) = &self.source {
                    tokio::spawn(recover(robot.clone(), self.clone()));
                }
            }
            Effect::Disturb(disturbance) => self.disturb(disturbance),
        }
        None
    }

    fn begin(
        self: &Arc<Self>,
        number: u64,
        motion: Motion,
        settings: watch::Receiver<Settings>,
    ) -> Option<Hold> {
        let robot = self.source.robot()?.clone();
        let (hold, deadman, end) = Hold::new(self.permissions.patience);
        let hub = self.clone();
        let task = Task {
            motion,
            settings,
            keep_out: self.keep_out.clone(),
            deadman,
            end,
        };
        tokio::spawn(async move {
            let show = |plan| drop(hub.heading.send_replace(Some((number, plan))));
            let ended = hold::run(&robot, task, show).await;
            // A newer hold may have begun while the arm was released.
            hub.heading.send_if_modified(|heading| {
                let own = |(of, _): &mut (u64, Plan)| *of == number;
                heading.take_if(own).is_some()
            });
            if let Ended::Failed(text, detail) = ended {
                hub.tell(Level::Error, text, detail);
            }
            hub.motion_ended(number);
        });
        Some(hold)
    }

    fn move_fingers(self: &Arc<Self>, viewer: ViewerId, action: GripperAction) {
        let Some(fingers) = &self.fingers else { return };
        let (acting, hub) = (fingers.begin(viewer, action), self.clone());
        tokio::spawn(async move {
            let (done, text) = acting.await;
            let level = if done { Level::Info } else { Level::Warning };
            hub.tell(level, text, None);
        });
    }

    fn record(self: &Arc<Self>, on: bool) {
        let (Some(recordings), Some(robot)) = (&self.recordings, self.source.robot()) else {
            return;
        };
        if !on {
            return recordings.end();
        }
        let (robot, hub) = (robot.clone(), self.clone());
        tokio::spawn(async move {
            let Some(recordings) = &hub.recordings else {
                return;
            };
            let gripper = hub.fingers.as_ref().map(|fingers| &fingers.gripper);
            match recordings.record(&robot, gripper).await {
                Some(Ok(text)) => hub.tell(Level::Info, text, None),
                Some(Err(why)) => hub.tell(Level::Error, format!("Recording failed: {why}"), None),
                None => {}
            }
        });
    }

    /// Brakes any motion and ends the action of the fingers. If another program controls the
    /// simulated robot, this function presses the robot's user stop.
    fn stop(self: &Arc<Self>) {
        if let Some(fingers) = &self.fingers {
            fingers.end();
        }
        match &self.source {
            Source::Watched(_) => self.disturb(Disturbance::UserStop { pressed: true }),
            Source::Robot(robot) => {
                if self.stopping.swap(true, Ordering::Relaxed) {
                    return; // an action is already running
                }
                let (robot, hub) = (robot.clone(), self.clone());
                tokio::spawn(async move {
                    let stopped = robot.stop().await;
                    hub.stopping.store(false, Ordering::Relaxed);
                    match stopped {
                        Ok(()) => hub.tell(Level::Warning, "Stopped by a viewer".into(), None),
                        Err(error) => hub.tell(Level::Error, format!("Stop failed: {error}"), None),
                    }
                });
            }
        }
    }

    fn disturb(self: &Arc<Self>, disturbance: Disturbance) {
        if let Some(simulated) = self.simulated.clone() {
            let hub = self.clone();
            tokio::spawn(async move {
                if let Err(why) = simulated.disturb(disturbance).await {
                    hub.tell(Level::Warning, format!("Disturbance refused: {why}"), None);
                }
            });
        }
    }
}

async fn recover(robot: Robot, hub: Arc<Hub>) {
    if let Err(error) = robot.recover().await {
        hub.tell(Level::Error, format!("Recovery failed: {error}"), None);
    }
}
