//! How far a replay is from the motion that was recorded.

use franka_model::Model;
use franka_proto::RobotState;

use super::plan::{PERIOD, ReplayPlan, ReplayTargets, pose_at};

/// Distances between the arm and where it was in the recording, collected over a replay.
#[derive(Clone, Debug, Default)]
pub struct ReplayDeviation {
    joints: Vec<f64>,
    position: Vec<f64>,
}

/// How far an arm is from where it was in a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distance {
    /// Of the joint that is furthest off, `[rad]`.
    pub joints: f64,
    /// Of the end effector that was recorded, `[m]`.
    pub position: f64,
}

/// Median, 95th percentile and greatest of some distances.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Half of them are less.
    pub median: f64,
    /// 95 % of them are less.
    pub p95: f64,
    /// The greatest.
    pub max: f64,
}

impl ReplayDeviation {
    /// Notes a state, `since_begin` milliseconds after the first target was due. Returns how far
    /// off it is.
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

    /// The joint that is furthest off in each state, `[rad]`.
    pub fn joints(&self) -> Spread {
        Spread::of(&self.joints)
    }

    /// The distance of the end effector that was recorded, `[m]`.
    pub fn position(&self) -> Spread {
        Spread::of(&self.position)
    }

    /// How many states were noted.
    pub fn len(&self) -> usize {
        self.joints.len()
    }

    /// True if none was.
    pub fn is_empty(&self) -> bool {
        self.joints.is_empty()
    }
}

impl ReplayPlan {
    /// From this distance of a joint on, `[rad]`, a replay by joints is to be given up. Springs,
    /// friction and lag make a tenth of it.
    pub const JOINTS_OFF_MAX: f64 = 0.15;

    /// From this distance of the end effector on, `[m]`, a replay by poses is to be given up.
    pub const POSITION_OFF_MAX: f64 = 0.05;

    /// The distance and what it may be, in words, if the replay is to be given up.
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
            let got = format!("{what} is {got:.3} {unit} from where it was recorded");
            (got, format!("{most} {unit}"))
        })
    }

    /// Where the arm was when the replay is so many milliseconds under way.
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
