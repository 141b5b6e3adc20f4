//! Deviation of a replayed motion from the recorded motion.

use franka_model::Model;
use franka_proto::RobotState;

use super::plan::{PERIOD, ReplayPlan, ReplayTargets, pose_at};

/// Collects the distances of the arm from the recorded arm during a replay.
#[derive(Clone, Debug, Default)]
pub struct ReplayDeviation {
    joints: Vec<f64>,
    position: Vec<f64>,
}

/// Distance of the arm from its recorded position, in one state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distance {
    /// Largest distance of any joint from its recorded position, `[rad]`.
    pub joints: f64,
    /// Distance of the end effector from its recorded position, `[m]`.
    pub position: f64,
}

/// Median, 95th percentile and maximum of a set of distances.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Median. Half of the distances are smaller.
    pub median: f64,
    /// 95th percentile. 95 % of the distances are smaller.
    pub p95: f64,
    /// Largest distance.
    pub max: f64,
}

impl ReplayDeviation {
    /// Processes a state that arrived `since_begin` milliseconds after the first target. Returns
    /// the arm's distance in this state.
    pub fn note(
        &mut self,
        plan: &ReplayPlan,
        model: &Model,
        since_begin: u64,
        state: &RobotState,
    ) -> Distance {
        let q = plan.measured_at(since_begin);
        let distances = q.iter().zip(&state.q).map(|(a, b)| (a - b).abs());
        let joints = distances.fold(0.0, f64::max);
        let [then, now] = [q, state.q].map(|q| pose_at(model, &q, &plan.tool).translation.vector);
        let position = (now - then).norm();
        self.joints.push(joints);
        self.position.push(position);
        Distance { joints, position }
    }

    /// Returns the spread of the joint distances of all states, `[rad]`.
    pub fn joints(&self) -> Spread {
        Spread::of(&self.joints)
    }

    /// Returns the spread of the end effector's distances of all states, `[m]`.
    pub fn position(&self) -> Spread {
        Spread::of(&self.position)
    }

    /// Returns the number of processed states.
    pub fn len(&self) -> usize {
        self.joints.len()
    }

    /// Returns true if no state was processed.
    pub fn is_empty(&self) -> bool {
        self.joints.is_empty()
    }
}

impl ReplayPlan {
    /// Joint distance above which a replay by joints should be aborted, `[rad]`. Springs, friction
    /// and lag cause a tenth of this distance.
    pub const JOINTS_OFF_MAX: f64 = 0.15;

    /// Distance of the end effector above which a replay by poses should be aborted, `[m]`.
    pub const POSITION_OFF_MAX: f64 = 0.05;

    /// If the replay should be aborted, returns the distance and the limit as text.
    pub fn too_far(&self, distance: Distance) -> Option<(String, String)> {
        let (what, got, most, unit) = match self.targets {
            ReplayTargets::Joints => ("a joint", distance.joints, Self::JOINTS_OFF_MAX, "rad"),
            ReplayTargets::Poses => (
                "the end effector",
                distance.position,
                Self::POSITION_OFF_MAX,
                "m",
            ),
        };
        let is_far = got > most;
        is_far.then(|| {
            let got = format!("{what} is {got:.3} {unit} from its recorded position");
            (got, format!("{most} {unit}"))
        })
    }

    /// Returns the recorded joint positions of the arm, `since_begin` milliseconds after the start
    /// of the replay.
    fn measured_at(&self, since_begin: u64) -> [f64; 7] {
        let period = PERIOD.as_millis() as u64;
        let last = self.measured.len() - 1;
        let place = (since_begin / period) as usize;
        let share = (since_begin % period) as f64 / period as f64;
        let [a, b] = [place, place + 1].map(|place| self.measured[place.min(last)]);
        core::array::from_fn(|i| a[i] + (b[i] - a[i]) * share)
    }
}

impl Spread {
    fn of(distances: &[f64]) -> Self {
        let mut sorted = distances.to_vec();
        sorted.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let place = (share * sorted.len() as f64) as usize;
            sorted.get(place).or(sorted.last()).copied()
        };
        Self {
            median: at(0.5).unwrap_or_default(),
            p95: at(0.95).unwrap_or_default(),
            max: sorted.last().copied().unwrap_or_default(),
        }
    }
}
