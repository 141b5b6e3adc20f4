//! Records a simulated robot, one sample per millisecond, and measures the performance of its
//! client.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use anyhow::Context as _;
use franka_bench::figures::HighPass;
use franka_sim::Robot;
use nalgebra::Vector3;
use tokio::time::timeout;

use crate::PATIENCE;

/// The state of one millisecond.
#[derive(Clone, Copy, Debug)]
struct Sample {
    time: u64,
    /// Measured position of the end effector, `[m]`.
    position: Vector3<f64>,
    /// `tau_J_d`, from the client or the robot's own controller, `[N·m]`.
    torque: [f64; 7],
}

/// The states of a robot since it started.
#[derive(Clone, Debug, Default)]
pub(crate) struct Witness(Arc<Mutex<Vec<Sample>>>);

/// The answer of a client to the command to move the end effector.
#[derive(Clone, Debug)]
pub(crate) struct Followed {
    pub(crate) target: Vector3<f64>,
    /// Millisecond of each state since the first with that target, and the position commanded by
    /// the client, `[m]`.
    pub(crate) reference: Vec<(u64, Vector3<f64>)>,
}

impl Followed {
    /// Returns the millisecond of the first state with the target.
    pub(crate) fn begin(&self) -> anyhow::Result<u64> {
        Ok(self.reference.first().context("no cycle saw the target")?.0)
    }
}

impl Witness {
    pub(crate) fn note(&self, robot: &Robot) {
        let state = robot.state();
        let sample = Sample {
            time: state.message_id,
            position: Vector3::from_column_slice(&state.O_T_EE[12..15]),
            torque: state.tau_J_d,
        };
        self.samples(|samples| samples.push(sample));
    }

    /// Returns the time of the last state, `[ms]`.
    pub(crate) fn now(&self) -> u64 {
        self.samples(|samples| samples.last().map_or(0, |last| last.time))
    }

    /// Waits until the robot has reached this millisecond.
    pub(crate) async fn wait(&self, until: u64) -> anyhow::Result<()> {
        let come = async {
            while self.now() < until {
                tokio::time::sleep(Duration::from_millis(1)).await;
            }
        };
        timeout(PATIENCE, come)
            .await
            .context("the robot stands still")
    }

    /// Returns the distance of the end effector from `point` in this millisecond, `[m]`.
    pub(crate) fn distance(&self, time: u64, point: &Vector3<f64>) -> anyhow::Result<f64> {
        let at = self.between(time, time + 1)?;
        Ok((at[0].position - point).norm())
    }

    /// Returns the distances from the reference and its velocities, `[m, m/s]`, for the recorded
    /// states.
    pub(crate) fn lags(&self, followed: &Followed) -> anyhow::Result<Vec<(f64, f64)>> {
        let mut before = followed.reference.first().copied();
        let lag = |&(time, reference): &(u64, Vector3<f64>)| {
            let (then, there) = before.replace((time, reference)).expect("not the first");
            let cycles = time.saturating_sub(then).max(1) as f64;
            let velocity = (reference - there).norm() / (cycles * 1e-3);
            Ok((self.distance(time, &reference)?, velocity))
        };
        let now = self.now();
        let seen = followed
            .reference
            .iter()
            .take_while(|(time, _)| *time <= now);
        seen.map(lag).collect()
    }

    /// Returns the time after which the end effector stayed within `distance` of the target until
    /// `watched` milliseconds after `begin`, `[s]`; `None` if it did not.
    pub(crate) fn within(
        &self,
        followed: &Followed,
        distance: f64,
        watched: u64,
    ) -> anyhow::Result<Option<f64>> {
        let begin = followed.begin()?;
        let samples = self.between(begin, begin + watched)?;
        let is_off = |sample: &Sample| (sample.position - followed.target).norm() > distance;
        let cycles = samples.iter().rposition(is_off).map_or(0, |last| last + 1);
        Ok((cycles < samples.len()).then_some(cycles as f64 * 1e-3))
    }

    /// Returns the torque above 30 Hz over these milliseconds, rms of the worst joint, `[N·m]`.
    pub(crate) fn torque_noise(&self, from: u64, to: u64) -> anyhow::Result<f64> {
        let mut high = HighPass::default();
        for sample in self.between(from, to)? {
            high.add(&sample.torque);
        }
        Ok(high.rms())
    }

    fn between(&self, from: u64, to: u64) -> anyhow::Result<Vec<Sample>> {
        self.samples(|samples| {
            let index = |time| samples.binary_search_by_key(&time, |sample| sample.time);
            let range = index(from).and_then(|from| Ok(from..=index(to - 1)?));
            let range = range.ok().context("the robot has no such millisecond")?;
            Ok(samples[range].to_vec())
        })
    }

    fn samples<T>(&self, of: impl FnOnce(&mut Vec<Sample>) -> T) -> T {
        of(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
