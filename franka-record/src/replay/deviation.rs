//! The deviation of a replay from the recorded motion.

use franka_model::Model;
use franka_proto::RobotState;

use super::plan::{PERIOD, ReplayPlan, ReplayTargets, pose_at};

/// Collects the distances between the arm and the recorded arm during a replay.
#[derive(Clone, Debug, Default)]
pub struct ReplayDeviation {
    joints: Vec<f64>,
    position: Vec<f64>,
}

/// Distance of the arm from the recorded arm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distance {
    /// Largest distance of a joint, `[rad]`.
    pub joints: f64,
    /// Distance of the end effector from the recorded end effector, `[m]`.
    pub position: f64,
}

/// Median, 95th percentile and maximum of some distances.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Median: half of the distances are smaller.
    pub median: f64,
    /// 95th percentile: 95 % of the distances are smaller.
    pub p95: f64,
    /// Largest distance.
    pub max: f64,
}

impl ReplayDeviation {
    /// Records a state that came `since_begin` milliseconds after the first target. Returns its
    /// distance.
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

    /// Returns the spread of the largest joint distance per state, `[rad]`.
    pub fn joints(&self) -> Spread {
        Spread::of(&self.joints)
    }

    /// Returns the spread of the end effector's distance per state, `[m]`.
    pub fn position(&self) -> Spread {
        Spread::of(&self.position)
    }

    /// Number of recorded states.
    pub fn len(&self) -> usize {
        self.joints.len()
    }

    /// True if no state was recorded.
    pub fn is_empty(&self) -> bool {
        self.joints.is_empty()
    }
}

impl ReplayPlan {
    /// Distance of a joint, `[rad]`, above which a replay by joints should be aborted. Springs,
    /// friction and lag cause a tenth of this distance.
    pub const JOINTS_OFF_MAX: f64 = 0.15;

    /// Distance of the end effector, `[m]`, above which a replay by poses should be aborted.
    pub const POSITION_OFF_MAX: f64 = 0.05;

    /// Returns the distance and its limit as text, if the replay should be aborted.
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

    /// Returns the recorded position of the arm, `since_begin` milliseconds after the start of the
    /// replay.
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
