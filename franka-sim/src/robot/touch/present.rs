//! The touches that act now, and the torques of each on the arm.

use franka_model::{AsBuilt, CYCLE, EndEffector, JointVector, Twist, Wrench, rotation, transform};
use nalgebra::{Matrix3, Vector3};

use super::{Effort, FIRM_JOINT, JOINT_INERTIA, Spring, Touch, TouchId};
use crate::signal::{halves, stack};

/// Everything that touches the arm now.
#[derive(Debug, Default)]
pub(in crate::robot) struct Touches {
    touches: Vec<Present>,
    count: u64,
}

#[derive(Debug)]
struct Present {
    id: TouchId,
    touch: Touch,
    since: u64,
    /// Of a touch as a function of time, in this millisecond.
    wrench: Wrench,
    /// What it has done to the arm in this millisecond: the mean of the last `steps` steps, about
    /// its place, base axes.
    felt: Wrench,
    steps: u32,
}

impl Touches {
    pub(in crate::robot) fn add(&mut self, touch: Touch, now: u64) -> TouchId {
        self.count += 1;
        let id = TouchId(self.count);
        self.touches.push(Present {
            id,
            touch,
            since: now,
            wrench: Wrench::zeros(),
            felt: Wrench::zeros(),
            steps: 0,
        });
        id
    }

    pub(in crate::robot) fn remove(&mut self, id: TouchId) -> bool {
        let count = self.touches.len();
        self.touches.retain(|present| present.id != id);
        self.touches.len() < count
    }

    /// What a touch has done to the arm in the last millisecond.
    pub(in crate::robot) fn felt(&self, id: TouchId) -> Option<Wrench> {
        let mut touches = self.touches.iter();
        touches.find(|present| present.id == id).map(|p| p.felt)
    }

    pub(in crate::robot) fn clear(&mut self) {
        self.touches.clear();
    }

    /// Begins the millisecond that ends at `now`: what is over ends, functions of time are asked.
    pub(in crate::robot) fn advance(&mut self, now: u64) {
        self.touches.retain(|present| {
            let end = present
                .touch
                .lasts
                .map(|lasts| present.since.saturating_add(lasts));
            end.is_none_or(|end| now <= end)
        });
        for present in &mut self.touches {
            (present.felt, present.steps) = (Wrench::zeros(), 0);
            // At the beginning of the millisecond.
            let elapsed = now.saturating_sub(present.since + 1) as f64 * CYCLE;
            match &mut present.touch.effort {
                Effort::OverTime(wrench) => present.wrench = wrench(elapsed),
                Effort::Carry {
                    path,
                    point,
                    velocity,
                    ..
                } => {
                    *point = path(elapsed);
                    *velocity = (path(elapsed + CYCLE) - *point) / CYCLE;
                }
                _ => {}
            }
        }
    }

    /// Their torques on the joints in this state of the arm, `[N·m]`, so many seconds into the
    /// millisecond.
    pub(in crate::robot) fn torque(
        &mut self,
        model: &AsBuilt,
        frames: &EndEffector,
        q: &JointVector,
        dq: &JointVector,
        into: f64,
    ) -> JointVector {
        let mut sum = JointVector::zeros();
        for present in &mut self.touches {
            sum += present.torque(model, frames, q, dq, into);
        }
        sum
    }
}

impl Present {
    fn torque(
        &mut self,
        model: &AsBuilt,
        frames: &EndEffector,
        q: &JointVector,
        dq: &JointVector,
        into: f64,
    ) -> JointVector {
        let frame = self.touch.frame;
        match &mut self.touch.effort {
            Effort::Torque(torque) => return *torque,
            Effort::Block { joint, angle } => {
                let angle = angle.get_or_insert(q[*joint]);
                let spring = Spring::damped(FIRM_JOINT, JOINT_INERTIA);
                let mut torque = JointVector::zeros();
                torque[*joint] =
                    spring.stiffness * (*angle - q[*joint]) - spring.damping * dq[*joint];
                return torque;
            }
            _ => {}
        }
        let (pose, jacobian) = model.pose_and_jacobian(frame, q, frames);
        let turn: Matrix3<f64> = pose.fixed_view::<3, 3>(0, 0).into_owned();
        let arm = turn * self.touch.offset;
        let position = Vector3::new(pose.m14, pose.m24, pose.m34) + arm;
        let (linear, angular) = halves(&Twist::from(jacobian * dq));
        let velocity = linear + angular.cross(&arm);
        let (force, torque) = match &mut self.touch.effort {
            Effort::Wrench(wrench) => halves(wrench),
            Effort::OverTime(_) => halves(&self.wrench),
            Effort::Spring { to, spring } => {
                (spring.pull(*to - position, &velocity), Vector3::zeros())
            }
            Effort::Carry {
                point,
                velocity: carried,
                spring,
                ..
            } => {
                let stretch = *point + *carried * into - position;
                let pull = spring.pull(stretch, &(velocity - *carried));
                (pull, Vector3::zeros())
            }
            Effort::Hold {
                pose: held,
                linear,
                angular: turning,
            } => {
                let Some(mut here) = transform::isometry(&pose) else {
                    return JointVector::zeros();
                };
                here.translation.vector = position;
                let held = held.get_or_insert(here);
                let way = held.translation.vector - position;
                let off = rotation::error(&held.rotation, &here.rotation);
                (linear.pull(way, &velocity), turning.pull(off, &angular))
            }
            Effort::Wall {
                point,
                normal,
                spring,
            } => {
                let depth = (*point - position).dot(normal);
                // Nothing sticks to a wall.
                let push = if depth > 0.0 {
                    (spring.stiffness * depth - spring.damping * velocity.dot(normal)).max(0.0)
                } else {
                    0.0
                };
                (*normal * push, Vector3::zeros())
            }
            Effort::Torque(_) | Effort::Block { .. } => return JointVector::zeros(),
        };
        self.steps += 1;
        self.felt += (stack(&force, &torque) - self.felt) / f64::from(self.steps);
        jacobian.tr_mul(&stack(&force, &(torque + arm.cross(&force))))
    }
}
