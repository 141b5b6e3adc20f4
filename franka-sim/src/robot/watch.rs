//! Supervision of a motion: self-collision, virtual walls, power, stability. The other checks are
//! in `reflex`.

use franka_model::JointVector;
use franka_model::collision::Shape;
use franka_proto::{Errors, RobotError, VirtualWall};
use nalgebra::{Matrix4, Vector3};

use super::ratchet::Ratchet;
use super::shaking::Shaking;
use crate::config::Config;

/// Supervision of self-collision, virtual walls, power and stability.
#[derive(Debug, Clone)]
pub(super) struct Watch {
    shape: Shape<'static>,
    pairs: Vec<Ratchet>,
    /// Joint positions at the last check that found the arm clear of itself, `[rad]`, and its
    /// distance beyond the margin then, `[m]`.
    clear: Option<(JointVector, f64)>,
    walls: Vec<Ratchet>,
    shaking: Shaking,
}

/// The arm at one instant.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight<'a> {
    /// Joint positions, `[rad]`.
    pub(super) q: &'a JointVector,
    /// Joint velocities, `[rad/s]`.
    pub(super) dq: &'a JointVector,
    /// Torques between motors and links, `[N·m]`.
    pub(super) torque: &'a JointVector,
    /// Pose of the end effector.
    pub(super) pose: &'a Matrix4<f64>,
}

impl Watch {
    pub(super) fn new(config: &Config) -> Self {
        let lengths = config.chosen_arm().body.state_geometry.lengths;
        let arm = Shape::vendor().with_lengths(lengths);
        let shape = match config.tool.has_hand_shape {
            true => arm.with_hand(),
            false => arm,
        };
        Self {
            shape,
            pairs: vec![Ratchet::new(); shape.at(&config.q).pairs().count()],
            clear: None,
            walls: vec![Ratchet::new(); config.walls.len()],
            shaking: Shaking::new(),
        }
    }

    /// Begins the supervision of a motion. The motion may start at any position.
    pub(super) fn begin(&mut self) {
        self.pairs.fill(Ratchet::new());
        self.clear = None;
        self.walls.fill(Ratchet::new());
        self.shaking = Shaking::new();
    }

    /// Checks a millisecond of the motion.
    pub(super) fn violations(&mut self, sight: &Sight<'_>, config: &Config) -> Errors {
        let unpublished = &config.unpublished;
        let position = Vector3::new(sight.pose.m14, sight.pose.m24, sight.pose.m34);
        [
            (
                self.closes_in_on_itself(sight.q, config),
                RobotError::SelfCollisionAvoidanceViolation,
            ),
            (
                self.leaves_walls(&position, config),
                RobotError::CartesianPositionLimitsViolation,
            ),
            (
                sight.torque.dot(sight.dq).abs() > unpublished.power,
                RobotError::PowerLimitViolation,
            ),
            (
                self.shaking.is_seen(sight.dq, &unpublished.instability),
                RobotError::InstabilityDetected,
            ),
        ]
        .into_iter()
        .filter_map(|(violated, error)| violated.then_some(error))
        .collect()
    }

    fn closes_in_on_itself(&mut self, q: &JointVector, config: &Config) -> bool {
        // In nearly all cases, the arm has moved too little since the last clear position to lose
        // its clearance.
        if let Some((seen, spare)) = &self.clear
            && LEVER * (q - seen).abs().sum() < *spare
        {
            return false;
        }
        let rule = &config.unpublished.self_collision;
        let arm = self.shape.at(q);
        let spare = arm.nearest_pair().distance - rule.margin;
        if spare >= 0.0 {
            self.pairs.fill(Ratchet::outside(rule.margin));
            self.clear = Some((*q, spare));
            return false;
        }
        self.clear = None;
        let mut violated = false;
        for (pair, ratchet) in arm.pairs().zip(&mut self.pairs) {
            let (inner, outer) = pair.bodies;
            let passed = ratchet.is_passed(pair.distance, rule.margin, rule.closing);
            violated |= passed && outer.number() - inner.number() >= rule.apart;
        }
        violated
    }

    fn leaves_walls(&mut self, position: &Vector3<f64>, config: &Config) -> bool {
        let mut violated = false;
        for ((_, wall), ratchet) in config.walls.iter().zip(&mut self.walls) {
            if wall.object_activation {
                violated |= ratchet.is_passed(depth(wall, position), 0.0, WALL_ALLOWANCE);
            }
        }
        violated
    }
}

/// Depth of a point inside the cuboid, `[m]`; negative outside.
fn depth(wall: &VirtualWall, position: &Vector3<f64>) -> f64 {
    let frame = Matrix4::from_column_slice(&wall.object_frame);
    let origin = Vector3::new(frame.m14, frame.m24, frame.m34);
    let inside = frame.fixed_view::<3, 3>(0, 0).tr_mul(&(position - origin));
    (0..3)
        .map(|axis| {
            let corner = wall.object_world_size[axis];
            let (low, high) = (corner.min(0.0), corner.max(0.0));
            (inside[axis] - low).min(high - inside[axis])
        })
        .fold(f64::INFINITY, f64::min)
}

/// Largest distance of the end effector beyond a virtual wall, `[m]`: a choice of this simulator,
/// above the drift of an arm at rest.
const WALL_ALLOWANCE: f64 = 0.001;

/// Largest distance of a point of arm and Hand from the axis of a joint, `[m]`, rounded up: the
/// lengths and offsets from the shoulder outwards are 1.18 m. A joint that turns by an angle brings
/// two bodies nearer by at most this length times the angle.
const LEVER: f64 = 1.25;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Tool;
    use crate::noise::Random;
    use franka_model::{Model, READY};

    #[test]
    fn a_hand_of_another_mass_keeps_its_shape() {
        let bodies = |tool: Tool| {
            let config = Config {
                tool,
                ..Config::default()
            };
            Watch::new(&config).pairs.len()
        };
        let mut heavy = Tool::hand();
        heavy.load.mass += 0.1;
        heavy.f_t_ne.m34 += 0.02;
        assert_eq!(bodies(heavy), bodies(Tool::hand()));
        assert!(bodies(Tool::NONE) < bodies(heavy));
    }

    #[test]
    fn an_arm_that_is_left_unseen_is_clear() {
        let config = Config {
            tool: Tool::hand(),
            ..Config::default()
        };
        let limits = Model::fr3().joint_limits();
        let margin = config.unpublished.self_collision.margin;
        let mut watch = Watch::new(&config);
        let mut random = Random::new(5);
        let (mut q, mut clear, mut close) = (READY, 0, 0);
        for _ in 0..60 {
            let part = random
                .joints(&JointVector::repeat(2.0))
                .map(|x| 0.5 + 0.5 * x.sin());
            let target = limits.lower + part.component_mul(&(limits.upper - limits.lower));
            let step = (target - q) / 200.0;
            for _ in 0..200 {
                q += step;
                watch.closes_in_on_itself(&q, &config);
                let is_clear = watch.shape.at(&q).nearest_pair().distance >= margin;
                assert_eq!(watch.clear.is_some(), is_clear, "{q}");
                *(if is_clear { &mut clear } else { &mut close }) += 1;
            }
        }
        assert!(clear > 1000 && close > 100, "{clear} clear, {close} close");
    }

    #[test]
    fn depth_is_measured_to_nearest_face_for_any_corner_signs() {
        let mut frame = Matrix4::<f64>::identity();
        frame.m14 = 1.0;
        let mut object_frame = [0.0; 16];
        object_frame.copy_from_slice(frame.as_slice());
        let wall = VirtualWall {
            object_world_size: [2.0, -1.0, 4.0],
            object_frame,
            object_activation: true,
        };
        for (point, expected) in [
            ([1.5, -0.4, 1.0], 0.4),
            ([0.8, -0.5, 1.0], -0.2),
            ([2.0, 0.1, 1.0], -0.1),
        ] {
            let found = depth(&wall, &Vector3::from(point));
            assert!((found - expected).abs() < 1e-12, "{point:?}: {found}");
        }
    }
}
