//! Observes an arm for some time. The result is the mean pose, the fields of the states that are
//! always zero, and how well the states match the model.

use std::ops::ControlFlow;
use std::time::Duration;

use franka_async::error::ReadError;
use franka_async::model::geometry::Lengths;
use franka_async::model::{EndEffector, Frame, Model};
use franka_async::nalgebra::Vector3;
use franka_async::state::RobotState;
use franka_async::{Pose, Robot, pose};

#[derive(Clone, Debug, Default)]
pub(super) struct Mean {
    count: u32,
    pose: [f64; 16],
    q: [f64; 7],
}

impl Mean {
    pub(super) fn push(&mut self, state: &RobotState) {
        self.count += 1;
        for (sum, value) in self.pose.iter_mut().zip(state.O_T_EE) {
            *sum += value;
        }
        for (sum, value) in self.q.iter_mut().zip(state.q) {
            *sum += value;
        }
    }

    pub(super) fn pose(&self) -> Option<Pose> {
        let count = f64::from(self.count);
        pose::from_array(&self.pose.map(|sum| sum / count)).ok()
    }

    /// Returns the mean joint positions, `[rad]`.
    pub(super) fn q(&self) -> [f64; 7] {
        let count = f64::from(self.count);
        self.q.map(|sum| sum / count)
    }
}

/// Returns the distance, `[m]`, and the angle, `[rad]`, between two poses.
pub(super) fn apart(one: &Pose, other: &Pose) -> (f64, f64) {
    let way = one.translation.vector - other.translation.vector;
    (way.norm(), one.rotation.angle_to(&other.rotation))
}

/// Fields that some robots do not fill in.
pub(super) const SPARSE: [&str; 4] = ["O_T_EE_c", "elbow_c", "tau_J_d", "O_ddP_O"];

/// Statistics of the states in an observation.
#[derive(Debug)]
pub(super) struct Look {
    /// `message_id` of the first and the last state.
    ids: Option<(u64, u64)>,
    pub(super) states: u64,
    /// Mean over the third second. Initial transients have then ended.
    pub(super) begin: Mean,
    /// Mean over the last second.
    pub(super) end: Mean,
    /// For each field of [`SPARSE`]: true if the field was zero in every state.
    pub(super) zero: [bool; SPARSE.len()],
    /// Distances between the reported pose and the pose of each model in [`sets`], one array per
    /// state, `[m]`.
    gaps: Vec<[f64; SETS]>,
}

impl Look {
    /// Creates empty statistics.
    fn new() -> Self {
        Self {
            ids: None,
            states: 0,
            begin: Mean::default(),
            end: Mean::default(),
            zero: [true; SPARSE.len()],
            gaps: Vec::new(),
        }
    }

    /// Observes the arm for this duration, measured by the robot's clock.
    pub(super) async fn over(robot: &Robot, duration: Duration) -> Result<Self, ReadError> {
        let mut look = Self::new();
        let sets = sets(&described(robot));
        let duration = duration.as_millis() as u64;
        robot
            .read(|state| {
                let since = look.push(state, &sets, duration);
                match since < duration {
                    true => ControlFlow::Continue(()),
                    false => ControlFlow::Break(()),
                }
            })
            .await?;
        Ok(look)
    }

    /// Processes a state. Returns the time since the first state, `[ms]`.
    fn push(&mut self, state: &RobotState, sets: &[Model; SETS], duration: u64) -> u64 {
        let id = state.message_id;
        let (first, _) = self.ids.unwrap_or((id, id));
        self.ids = Some((first, id));
        self.states += 1;
        let since = id - first;
        if (SETTLED..SETTLED + SECOND).contains(&since) {
            self.begin.push(state);
        }
        if since + SECOND > duration {
            self.end.push(state);
        }
        let sparse: [&[f64]; SPARSE.len()] = [
            &state.O_T_EE_c,
            &state.elbow_c,
            &state.tau_J_d,
            &state.O_ddP_O,
        ];
        for (zero, field) in self.zero.iter_mut().zip(sparse) {
            *zero &= field.iter().all(|value| *value == 0.0);
        }
        // Every tenth state is enough for a median, and keeps the computation cheap.
        if self.states % 10 == 1 {
            self.gaps
                .push(std::array::from_fn(|i| gap(&sets[i], state)));
        }
        since
    }

    /// Returns the number of missing states between the first and the last state.
    pub(super) fn missing(&self) -> u64 {
        let (first, last) = self.ids.unwrap_or_default();
        (last - first + 1).saturating_sub(self.states)
    }

    /// Returns each set of lengths, with the median distance between the reported poses and the
    /// model's poses, `[m]`. The first set belongs to `model`.
    pub(super) fn geometry(&self, model: &Model) -> [(Lengths, f64); SETS] {
        let lengths = sets(model).map(|model| *model.lengths());
        std::array::from_fn(|i| {
            let mut gaps: Vec<f64> = self.gaps.iter().map(|gaps| gaps[i]).collect();
            gaps.sort_by(f64::total_cmp);
            (
                lengths[i],
                gaps.get(gaps.len() / 2).copied().unwrap_or(f64::NAN),
            )
        })
    }
}

pub(super) fn described(robot: &Robot) -> Model {
    let described = robot.geometry_check().described;
    robot.model().clone().with_lengths(described)
}

/// Returns the given model, and copies of it with each known set of lengths.
fn sets(model: &Model) -> [Model; SETS] {
    std::array::from_fn(|i| match i {
        0 => model.clone(),
        i => model.clone().with_lengths(Lengths::KNOWN[i - 1]),
    })
}

/// Returns the distance between a state's reported pose and the model's pose, `[m]`.
fn gap(model: &Model, state: &RobotState) -> f64 {
    let ee = EndEffector::from_arrays(&state.F_T_EE, &state.EE_T_K);
    let pose = model.pose(Frame::EndEffector, &state.q.into(), &ee);
    let reported = Vector3::from_column_slice(&state.O_T_EE[12..15]);
    (pose.fixed_view::<3, 1>(0, 3) - reported).norm()
}

const SETS: usize = 1 + Lengths::KNOWN.len();

/// Time at which the measurement of the drift begins, `[ms]`.
const SETTLED: u64 = 2000;

/// One second, `[ms]`.
const SECOND: u64 = 1000;

#[cfg(test)]
mod tests {
    use franka_async::READY;
    use franka_async::pose::to_array;

    use super::*;

    /// Returns an observation of an arm that has these lengths and drifts upwards at `creep` metres
    /// per second.
    fn look(lengths: Lengths, creep: f64) -> Look {
        let arm = Model::fr3().clone().with_lengths(lengths);
        let pose = arm.pose(Frame::EndEffector, &READY, &EndEffector::default());
        let identity = to_array(&Pose::identity());
        let mut state = RobotState {
            q: READY.into(),
            F_T_EE: identity,
            EE_T_K: identity,
            tau_J_d: [0.1; 7],
            O_T_EE_c: [0.0; 16],
            ..RobotState::default()
        };
        state.O_T_EE.copy_from_slice(pose.as_slice());
        let mut look = Look::new();
        for id in (0..=10_000).filter(|id| id % 100 != 7) {
            state.message_id = 500 + id;
            state.O_T_EE[14] = pose[(2, 3)] + creep * id as f64 * 1e-3;
            look.push(&state, &sets(Model::fr3()), 10_000);
        }
        look
    }

    #[test]
    fn lengths_are_found_by_the_poses_that_are_reported() {
        for (lengths, good, bad) in [
            (Lengths::DESCRIBED, [0, 1], 2),
            (Lengths::RECORDED_FR3, [2, 2], 0),
        ] {
            let found = look(lengths, 0.0).geometry(Model::fr3());
            for good in good {
                assert!(found[good].1 < 1e-9, "{found:?}");
                assert_eq!(found[good].0, lengths);
            }
            assert!((1e-4..1e-3).contains(&found[bad].1), "{found:?}");
        }
    }

    #[test]
    fn a_drift_a_gap_and_zeros_are_seen() {
        let look = look(Lengths::DESCRIBED, 1e-4);
        let [begin, end] = [&look.begin, &look.end].map(|mean| mean.pose().expect("a pose"));
        let (drift, turn) = apart(&begin, &end);
        assert!((drift - 7e-4).abs() < 1e-5 && turn < 1e-9, "{drift}");
        assert_eq!(look.missing(), 100);
        assert_eq!(look.zero, [true, true, false, true]);
    }
}
