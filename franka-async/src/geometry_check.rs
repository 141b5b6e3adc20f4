//! Comparison of the model of a connected robot with the poses that the robot reports.

use std::fmt;

use franka_model::Model;
use franka_model::geometry::Lengths;
use franka_proto::RobotState;
use franka_rt::session::geometry::{RESIDUAL_MAX, residual};

use crate::error::ConnectError;

/// Number of states that are tried until one fits a known geometry. While a robot is guided by
/// hand, its pose and its joint positions may belong to different moments.
const STATES: usize = 10;

/// Result of comparing a robot's model with its reported poses when connecting: see
/// [`Robot::geometry_check`](crate::Robot::geometry_check).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GeometryCheck {
    /// Lengths in the robot's description, or in the constants of its kind.
    pub described: Lengths,
    /// Lengths with which the model computes. They differ from the described lengths if the robot's
    /// poses fit other [known](Lengths::KNOWN) lengths.
    pub used: Lengths,
    /// Distance of the reported pose from the pose of the model at the same joint positions, `[m]`,
    /// or the largest difference between elements of their rotation matrices times 0.1 m, whichever
    /// is greater. `None` if the robot reported no pose.
    pub residual: Option<f64>,
}

impl GeometryCheck {
    /// Largest residual that counts as agreement, `[m]`.
    pub const RESIDUAL_MAX: f64 = RESIDUAL_MAX;

    /// True unless the poses were compared and disagree.
    pub fn agrees(&self) -> bool {
        self.residual
            .is_none_or(|residual| residual <= RESIDUAL_MAX)
    }

    /// True if the poses were compared and agree with the lengths in the description.
    pub fn is_as_described(&self) -> bool {
        self.agrees() && self.residual.is_some() && self.used == self.described
    }

    /// Compares this state with `model`. If they disagree, also tries the known lengths.
    fn of(model: &Model, state: &RobotState) -> Self {
        let described = *model.lengths();
        let with = |used: Lengths| Self {
            described,
            used,
            residual: residual(&model.clone().with_lengths(used), state),
        };
        let found = with(described);
        if found.agrees() {
            return found;
        }
        let mut others = Lengths::KNOWN.into_iter().map(with);
        others.find(Self::agrees).unwrap_or(found)
    }
}

/// Prints one sentence for people.
impl fmt::Display for GeometryCheck {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            described, used, ..
        } = self;
        let Some(residual) = self.residual else {
            f.write_str("the robot reports no pose: its geometry was not checked")?;
            if used != described {
                write!(f, "; the model keeps {}", Told(used))?;
            }
            return Ok(());
        };
        let um = residual * 1e6;
        let most = RESIDUAL_MAX * 1e6;
        if !self.agrees() {
            return write!(
                f,
                "the robot's pose is {um:.1} µm from the pose of its model, expected {most:.0} µm at most; accepted, as requested by accept_geometry_error"
            );
        }
        write!(
            f,
            "the robot's pose is within {most:.0} µm of the pose of its model"
        )?;
        if used != described {
            write!(
                f,
                "; the model now has {}, while the robot's description has {} m and {} m",
                Told(used),
                described.upper_arm,
                described.forearm
            )?;
        }
        Ok(())
    }
}

/// Prints lengths in a sentence for people.
struct Told<'a>(&'a Lengths);

impl fmt::Display for Told<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Lengths { upper_arm, forearm } = self.0;
        write!(
            f,
            "an upper arm of {upper_arm} m and a forearm of {forearm} m"
        )
    }
}

/// A comparison of a model with states, which continues until a state fits a known geometry.
#[derive(Debug)]
pub(crate) struct Comparison {
    model: Model,
    best: GeometryCheck,
    /// Number of states that may still be tried.
    left: usize,
}

impl Comparison {
    pub(crate) fn new(model: Model, first: &RobotState) -> Self {
        Self {
            best: GeometryCheck::of(&model, first),
            model,
            left: STATES - 1,
        }
    }

    /// True if another state may change the result.
    pub(crate) fn needs_more(&self) -> bool {
        self.left > 0 && !self.best.agrees()
    }

    pub(crate) fn look_at(&mut self, state: &RobotState) {
        self.left = self.left.saturating_sub(1);
        let newer = GeometryCheck::of(&self.model, state);
        if newer.residual.is_some() && newer.residual < self.best.residual {
            self.best = newer;
        }
    }

    /// Returns the model with the lengths that fit the robot's own poses, and the result of the
    /// check. If the robot reports no pose, the lengths that were found `before` are used, provided
    /// that its description contains the same lengths as then.
    ///
    /// # Errors
    /// Returns [`ConnectError::Geometry`] if no known lengths agree, unless any geometry is
    /// `accepted`.
    pub(crate) fn conclude(
        self,
        accepted: bool,
        before: Option<&GeometryCheck>,
    ) -> Result<(Model, GeometryCheck), ConnectError> {
        let Self {
            model, mut best, ..
        } = self;
        match (best.residual, before) {
            (Some(residual), _) if !best.agrees() && !accepted => {
                return Err(ConnectError::Geometry { residual });
            }
            (None, Some(before)) if before.described == best.described => best.used = before.used,
            _ => {}
        }
        if best.is_as_described() {
            return Ok((model, best));
        }
        tracing::warn!("{best}");
        let model = match best.used == best.described {
            true => model,
            false => model.with_lengths(best.used),
        };
        Ok((model, best))
    }
}

#[cfg(test)]
mod tests {
    use franka_model::{EndEffector, Frame, JointVector, READY, transform};
    use franka_proto::Version;

    use super::*;

    fn state_of(model: &Model, off: f64) -> RobotState {
        let pose = model.pose(Frame::EndEffector, &READY, &EndEffector::default());
        let mut pose = transform::isometry(&pose).expect("rigid");
        pose.translation.x += off;
        RobotState {
            q: READY.into(),
            O_T_EE: transform::array(&pose),
            ..RobotState::default()
        }
    }

    fn checked(
        model: &Model,
        states: &[RobotState],
        accepted: bool,
    ) -> Result<(Model, GeometryCheck), ConnectError> {
        let [first, newer @ ..] = states else {
            panic!("one at least")
        };
        let mut comparison = Comparison::new(model.clone(), first);
        for state in newer {
            if comparison.needs_more() {
                comparison.look_at(state);
            }
        }
        comparison.conclude(accepted, None)
    }

    #[test]
    fn the_lengths_are_those_that_the_poses_have() {
        let all = Lengths::KNOWN.map(|lengths| Model::fr3().clone().with_lengths(lengths));
        for described in &all {
            for robots in &all {
                let (model, found) = checked(described, &[state_of(robots, 0.0)], false)
                    .expect("one of the known ones");
                assert_eq!(&model, robots);
                assert_eq!(
                    (found.described, found.used),
                    (*described.lengths(), *robots.lengths())
                );
                assert!(found.agrees() && found.residual.is_some());
                assert_eq!(found.is_as_described(), described == robots);
                let lengths = "the model now has an upper arm of 0.3162 m and a forearm of 0.3842 \
                    m";
                let is_told = found.to_string().contains(lengths);
                assert_eq!(is_told, described != robots && robots == &all[1], "{found}");
            }
        }
    }

    /// A state of a Franka Emika Robot with the Hand from 2017, printed with six digits in the
    /// documentation of the Franka Control Interface.
    #[test]
    #[expect(clippy::approx_constant, reason = "four digits are reported")]
    fn a_printed_state_of_a_real_robot_has_the_described_lengths() {
        #[rustfmt::skip]
        let state = RobotState {
            q: [0.0167305, -0.762614, -0.0207622, -2.34352, -0.0305686, 1.53975, 0.753872],
            O_T_EE: [
                0.998578, 0.0328747, -0.0417381, 0.0, 0.0335224, -0.999317, 0.0149157, 0.0,
                -0.04122, -0.016294, -0.999017, 0.0, 0.305468, -0.00814133, 0.483198, 1.0,
            ],
            F_T_EE: [
                0.7071, -0.7071, 0.0, 0.0, 0.7071, 0.7071, 0.0, 0.0,
                0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.1034, 1.0,
            ],
            ..RobotState::default()
        };
        let (model, found) = checked(Model::fer(), &[state], false).expect("its own lengths");
        assert_eq!(&model, Model::fer());
        assert!(found.is_as_described(), "{found}");
        let other = Model::fer().clone().with_lengths(Lengths::RECORDED_FR3);
        let residual = residual(&other, &state).expect("a pose");
        assert!(residual > 1e-4, "{residual:e}");
    }

    /// The least favourable state: in `f32`, with a tool that reaches a metre from the flange.
    #[test]
    fn rounding_on_the_wire_is_half_of_what_is_accepted() {
        let model = Model::fr3();
        let mut tool = transform::array(&nalgebra::Isometry3::identity());
        (tool[12], tool[14]) = (0.6, 0.8);
        for k in 0..500 {
            let q = READY + JointVector::from_fn(|i, _| (1.7 * f64::from(k) + i as f64).sin());
            let ee = EndEffector::from_arrays(&tool, &RobotState::default().EE_T_K);
            let pose = model.pose(Frame::EndEffector, &q, &ee);
            let exact = RobotState {
                q: q.into(),
                F_T_EE: tool,
                O_T_EE: transform::array(&transform::isometry(&pose).expect("rigid")),
                ..RobotState::default()
            };
            let mut bytes = [0; RobotState::MAX_SIZE];
            let length = exact.encode(Version::V10, &mut bytes).expect("room for it");
            let state = RobotState::decode(Version::V10, &bytes[..length]).expect("a state");
            let residual = residual(model, &state).expect("a pose");
            assert!(residual < 0.5 * RESIDUAL_MAX, "{residual:e} m");
        }
    }

    #[test]
    fn an_unknown_geometry_is_refused_unless_it_is_accepted() {
        let model = Model::fer();
        let off = [state_of(model, 1.2e-4), state_of(model, 1e-4)];
        let error = checked(model, &off, false).expect_err("100 µm off");
        assert!(error.to_string().contains("100.0 µm"), "{error}");
        let (kept, found) = checked(model, &off, true).expect("accepted");
        assert_eq!((&kept, found.used), (model, found.described));
        assert!(!found.agrees(), "{found:?}");
        assert!(found.to_string().contains("100.0 µm"), "{found}");
    }

    #[test]
    fn one_state_that_agrees_is_enough() {
        let model = Model::fr3();
        let states = [
            state_of(model, 1e-3),
            state_of(model, 1e-6),
            state_of(model, 1e-3),
        ];
        let (_, found) = checked(model, &states, false).expect("the second");
        let residual = found.residual.expect("compared");
        assert!((residual - 1e-6).abs() < 1e-9, "{residual:e}");
        let none = RobotState {
            O_T_EE: [0.0; 16],
            ..states[0]
        };
        let (_, found) = checked(model, &[none], false).expect("nothing to compare");
        assert_eq!((found.residual, found.is_as_described()), (None, false));
    }

    #[test]
    fn robot_without_pose_keeps_lengths_of_same_description() {
        let model = Model::fr3();
        let [described, recorded] = Lengths::KNOWN;
        let none = RobotState {
            O_T_EE: [0.0; 16],
            ..state_of(model, 0.0)
        };
        let longer = Lengths {
            upper_arm: 0.33,
            ..described
        };
        for (described_before, expected) in [(described, recorded), (longer, described)] {
            let before = GeometryCheck {
                described: described_before,
                used: recorded,
                residual: Some(0.0),
            };
            let comparison = Comparison::new(model.clone(), &none);
            let (model, found) = comparison
                .conclude(false, Some(&before))
                .expect("nothing to compare");
            assert_eq!((model.lengths(), found.used), (&expected, expected));
            assert_eq!((found.residual, found.is_as_described()), (None, false));
            let is_told = found.to_string().contains("0.3162 m");
            assert_eq!(is_told, expected == recorded, "{found}");
        }
    }
}
