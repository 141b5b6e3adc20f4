//! A simulated robot that viewers can disturb.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use franka_async::model::{Frame, Load, RobotKind};
use franka_async::nalgebra::{Matrix3, Vector3};
use franka_async::state::{RobotError, RobotState};
use franka_sim::network::{self, BurstLoss, Loss, Stalls};
use franka_sim::{Arm, Network, Robot, Running, Stopped, Touch, TouchId};
use serde::Serialize;

use crate::request::{ArmKind, Conditions, Disturbance, PUSH_MS};

#[derive(Clone)]
pub(crate) struct Simulated {
    running: Arc<Running>,
    pushing: Arc<Mutex<Option<TouchId>>>,
    setting: Arc<Mutex<Setting>>,
}

/// The current conditions of the simulation. A value is `None` if it has not changed since the
/// simulator started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Setting {
    /// Seed of the simulator's random numbers; `None` if unknown.
    seed: Option<u64>,
    arm: Option<ArmKind>,
    network: Option<Conditions>,
    /// Width of the object between the fingers, `[m]`.
    object: Option<f64>,
    /// Mass attached to the flange, `[kg]`.
    load: f64,
    /// Ratio of robot time to wall-clock time in virtual time. 0 is a pause, and `None` is as fast
    /// as possible.
    speed: Option<f64>,
}

impl Simulated {
    pub(crate) fn new(running: Arc<Running>) -> Self {
        Self {
            running,
            pushing: Arc::default(),
            setting: Arc::default(),
        }
    }

    /// Returns true if the robot has a Hand, which can hold an object.
    pub(crate) fn has_hand(&self) -> bool {
        self.running.hand().is_some()
    }

    /// Returns true if the speed of robot time can be set.
    pub(crate) fn is_in_virtual_time(&self) -> bool {
        self.running.is_in_virtual_time()
    }

    pub(crate) fn setting(&self) -> Setting {
        Setting {
            speed: self.running.speed(),
            ..*self.lock()
        }
    }

    /// Reads the options with which the simulator was started.
    pub(crate) async fn look(&self) {
        let started = self.running.with(|robot| {
            let config = robot.config();
            let arm = config.chosen_arm();
            let kinds = [
                ArmKind::Ideal,
                ArmKind::Nominal,
                ArmKind::Realistic,
                ArmKind::Bad,
            ];
            let arm = kinds
                .into_iter()
                .find(|it| simulate(*it, config.kind) == arm);
            (config.seed, arm, config.payload.mass)
        });
        if let Ok((seed, arm, load)) = started.await {
            *self.lock() = Setting {
                seed: Some(seed),
                arm,
                load,
                ..Setting::default()
            };
        }
    }

    /// Performs a [checked](crate::request::Request::check) disturbance.
    ///
    /// # Errors
    /// Returns the reason if the disturbance could not be performed.
    pub(crate) async fn disturb(&self, disturbance: Disturbance) -> Result<(), String> {
        self.apply(disturbance).await?;
        let mut setting = self.lock();
        match disturbance {
            Disturbance::Network { conditions } => setting.network = Some(conditions),
            Disturbance::Object { width } => setting.object = width,
            Disturbance::Load { mass } => setting.load = mass,
            Disturbance::Arm { arm } => setting.arm = Some(arm),
            _ => {}
        }
        Ok(())
    }

    async fn apply(&self, disturbance: Disturbance) -> Result<(), String> {
        let stopped = |stopped: Stopped| stopped.to_string();
        match disturbance {
            Disturbance::Network { conditions } => {
                let seed = self.setting().seed.unwrap_or_default();
                let set = self
                    .running
                    .with_network(move |network, _| *network = network_under(conditions, seed));
                set.await.map_err(stopped)
            }
            Disturbance::Speed { speed } => {
                let set = self.running.set_speed(speed);
                set.map_err(|error| error.to_string())
            }
            Disturbance::Cut { milliseconds } => {
                let time = Duration::from_millis(milliseconds.into());
                let cut = self.running.with_network(move |network, now| {
                    let network = network.get_or_insert_with(Network::perfect);
                    network.to_client.cut(now..now + time);
                    network.to_robot.cut(now..now + time);
                });
                cut.await.map_err(stopped)
            }
            Disturbance::Object { width } => {
                let hand = self.running.hand().ok_or("this simulator has no Hand")?;
                let placed = hand.with(move |hand| {
                    let fingers = hand.mechanism_mut();
                    match width {
                        Some(width) => fingers.place_object(width),
                        None => {
                            // The error is ignored, because there may be no object to remove.
                            let _ = fingers.take_object();
                            true
                        }
                    }
                });
                match placed.await.map_err(stopped)? {
                    true => Ok(()),
                    false => Err(format!(
                        "got an object of {} m, which does not fit between the fingers: open them \
                         wider. \
                         With MuJoCo, objects come from the scene",
                        width.unwrap_or_default()
                    )),
                }
            }
            _ => {
                let pushing = self.pushing.clone();
                let job = move |robot: &mut Robot| {
                    let mut pushing = pushing.lock().unwrap_or_else(PoisonError::into_inner);
                    apply(disturbance, robot, &mut pushing);
                };
                self.running.with(job).await.map_err(stopped)
            }
        }
    }

    /// Passes the newest state to `watched` at the frame rate of the page. Returns when the
    /// simulation has ended.
    pub(crate) async fn copy_to(&self, watched: impl Fn(RobotState) -> bool) {
        let mut clock = tokio::time::interval(Duration::from_millis(10));
        clock.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Skip);
        loop {
            clock.tick().await;
            match self.running.state().await {
                Ok(state) if watched(state) => {}
                _ => return,
            }
        }
    }

    fn lock(&self) -> MutexGuard<'_, Setting> {
        self.setting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Applies a disturbance to the robot itself. `pushing` is the push that might still be active.
fn apply(disturbance: Disturbance, robot: &mut Robot, pushing: &mut Option<TouchId>) {
    match disturbance {
        Disturbance::Push {
            link,
            offset,
            force,
        } => {
            let push = Touch::force(Vector3::from(force))
                .at(Frame::ALL[link - 1])
                .offset(Vector3::from(offset))
                .lasting(PUSH_MS);
            if let Some(before) = pushing.replace(robot.touch(push)) {
                robot.release(before);
            }
        }
        Disturbance::UserStop { pressed } => robot.press_user_stop(pressed),
        Disturbance::Guide { pressed } => {
            robot.guide(pressed);
        }
        Disturbance::Brakes { closed: true } => robot.close_brakes(),
        Disturbance::Brakes { closed: false } => robot.open_brakes(),
        Disturbance::Reflex {} => robot.trip(RobotError::CartesianReflex),
        Disturbance::Load { mass } => robot.attach(Load {
            mass,
            com: Vector3::new(0.0, 0.0, 0.05),
            inertia: Matrix3::zeros(),
        }),
        Disturbance::Arm { arm } => robot.fit(simulate(arm, robot.config().kind)),
        // These disturbances do not act on the robot itself.
        Disturbance::Network { .. }
        | Disturbance::Cut { .. }
        | Disturbance::Object { .. }
        | Disturbance::Speed { .. } => {}
    }
}

fn simulate(arm: ArmKind, kind: RobotKind) -> Arm {
    match arm {
        ArmKind::Ideal => Arm::ideal(kind),
        ArmKind::Nominal => Arm::nominal(kind),
        ArmKind::Realistic => Arm::realistic(kind),
        ArmKind::Bad => Arm::bad(kind),
    }
}

/// Returns the network with these conditions; `None` for the conditions of the host.
fn network_under(conditions: Conditions, seed: u64) -> Option<Network> {
    let Conditions {
        loss,
        burst,
        delay_ms,
        jitter_ms,
        stalls_per_second,
        stall_ms,
    } = conditions;
    let milliseconds = |ms: f64| Duration::from_secs_f64(ms * 1e-3);
    let each_way = network::Conditions {
        loss: match loss {
            0.0 => Loss::Never,
            _ if burst > 1.0 => Loss::Bursts(BurstLoss::of(loss, burst)),
            _ => Loss::Independent(loss),
        },
        delay: milliseconds(delay_ms),
        jitter: milliseconds(jitter_ms),
        ..network::Conditions::default()
    };
    // The robot's network interface causes the pauses.
    let stalls = (stalls_per_second > 0.0 && stall_ms > 0.0).then(|| Stalls {
        per_second: stalls_per_second,
        shortest: milliseconds(stall_ms),
        longest: milliseconds(stall_ms),
        excess: Duration::ZERO,
        single: 0.0,
        period: Duration::ZERO,
    });
    let to_client = network::Conditions { stalls, ..each_way };
    (to_client != network::Conditions::default()).then(|| Network::new(seed, to_client, each_way))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERFECT: Conditions = Conditions {
        loss: 0.0,
        burst: 1.0,
        delay_ms: 0.0,
        jitter_ms: 0.0,
        stalls_per_second: 0.0,
        stall_ms: 0.0,
    };

    #[test]
    fn conditions_become_those_of_the_network() {
        assert!(network_under(PERFECT, 1).is_none());
        let network = |conditions| network_under(conditions, 1).expect("not perfect");
        let slow = network(Conditions {
            delay_ms: 2.0,
            jitter_ms: 0.5,
            ..PERFECT
        });
        for path in [&slow.to_client, &slow.to_robot] {
            assert_eq!(path.conditions().delay, Duration::from_millis(2));
            assert_eq!(path.conditions().jitter, Duration::from_micros(500));
            assert_eq!(path.conditions().loss, Loss::Never);
        }
        let lossy = |burst| {
            let loss = 0.02;
            let lossy = Conditions {
                loss,
                burst,
                ..PERFECT
            };
            network(lossy).to_robot.conditions().loss
        };
        assert_eq!(lossy(1.0), Loss::Independent(0.02));
        assert_eq!(lossy(8.0), Loss::Bursts(BurstLoss::of(0.02, 8.0)));
        let stalling = network(Conditions {
            stalls_per_second: 7.0,
            stall_ms: 3.0,
            ..PERFECT
        });
        let stalls = stalling.to_client.conditions().stalls.expect("some");
        assert_eq!(stalls.mean(), Duration::from_millis(3));
        assert_eq!(stalling.to_robot.conditions().stalls, None);
    }
}
