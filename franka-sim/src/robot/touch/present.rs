//! The active touches, and the effect of each on the arm.

use franka_model::{
    AsBuilt, CYCLE, EndEffector, Jacobian, JointVector, MassMatrix, Twist, Wrench, rotation,
    transform,
};
use nalgebra::{Matrix3, Vector3};

use super::{Effort, FIRM_JOINT, JOINT_INERTIA, Spring, Touch, TouchId};
use crate::plant::External;
use crate::signal::{halves, stack};

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
    /// Wrench in this millisecond, for a touch whose wrench is a function of time.
    wrench: Wrench,
    /// Wrench in the newest step, about the touched point and in base axes, and the reduction of
    /// this wrench per unit of joint acceleration.
    step: (Wrench, Option<Jacobian>),
    /// Wrench on the arm in this millisecond: the mean of the last `steps` steps, about the touched
    /// point, in base axes.
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
            step: (Wrench::zeros(), None),
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

    /// Effect of a touch on the arm in the last millisecond.
    pub(in crate::robot) fn felt(&self, id: TouchId) -> Option<Wrench> {
        let mut touches = self.touches.iter();
        touches.find(|present| present.id == id).map(|p| p.felt)
    }

    pub(in crate::robot) fn clear(&mut self) {
        self.touches.clear();
    }

    /// Begins the millisecond that ends at `now`: ends touches whose duration is over, and calls
    /// the users' functions of time.
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
            // Time since the touch began, at the beginning of the millisecond.
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

    /// Effect of all touches on the joints over a step of `dt` seconds. The step begins with this
    /// state of the arm, `into` seconds after the beginning of the millisecond.
    pub(in crate::robot) fn act(
        &mut self,
        model: &AsBuilt,
        frames: &EndEffector,
        (q, dq): (&JointVector, &JointVector),
        into: f64,
        dt: f64,
    ) -> External {
        let acts = |present: &mut Present| present.act(model, frames, (q, dq), into, dt);
        let none = External::NONE;
        let touches = self.touches.iter_mut();
        touches.map(acts).fold(none, |sum, one| sum.and(&one))
    }

    /// Computes the wrenches of the last step from its joint acceleration.
    pub(in crate::robot) fn feel(&mut self, ddq: &JointVector) {
        for present in &mut self.touches {
            present.steps += 1;
            let (wrench, slope) = &present.step;
            let acted = slope.map_or(*wrench, |slope| wrench - slope * ddq);
            present.felt += (acted - present.felt) / f64::from(present.steps);
        }
    }
}

impl Present {
    fn act(
        &mut self,
        model: &AsBuilt,
        frames: &EndEffector,
        (q, dq): (&JointVector, &JointVector),
        into: f64,
        dt: f64,
    ) -> External {
        let frame = self.touch.frame;
        match &mut self.touch.effort {
            Effort::Torque(torque) => return External::from(*torque),
            Effort::Block { index, angle } => {
                let index = *index;
                let angle = *angle.get_or_insert(q[index]);
                return block(index, angle - q[index], dq[index], dt);
            }
            _ => {}
        }
        let (pose, jacobian) = model.pose_and_jacobian(frame, q, frames);
        let turn: Matrix3<f64> = pose.fixed_view::<3, 3>(0, 0).into_owned();
        let arm = turn * self.touch.offset;
        let position = Vector3::new(pose.m14, pose.m24, pose.m34) + arm;
        let jacobian = displaced(jacobian, &arm);
        let (velocity, angular_velocity) = halves(&Twist::from(jacobian * dq));
        let none = Vector3::zeros();
        let slope_of = |spring: &Spring| Matrix3::identity() * spring.slope(dt);
        // Force, torque, and the reduction of both per unit of acceleration.
        let (force, torque, slope) = match &mut self.touch.effort {
            Effort::Wrench(wrench) => {
                let (force, torque) = halves(wrench);
                (force, torque, None)
            }
            Effort::OverTime(_) => {
                let (force, torque) = halves(&self.wrench);
                (force, torque, None)
            }
            Effort::Spring { to, spring } => {
                let pull = spring.pull(*to - position, &velocity, dt);
                (pull, none, Some((slope_of(spring), 0.0)))
            }
            Effort::Carry {
                point,
                velocity: carried,
                spring,
                ..
            } => {
                let stretch = *point + *carried * into - position;
                let pull = spring.pull(stretch, &(velocity - *carried), dt);
                (pull, none, Some((slope_of(spring), 0.0)))
            }
            Effort::Hold {
                pose: held,
                linear,
                angular: turning,
            } => {
                let Some(mut here) = transform::isometry(&pose) else {
                    return External::NONE;
                };
                here.translation.vector = position;
                let held = held.get_or_insert(here);
                let way = held.translation.vector - position;
                let off = rotation::error(&held.rotation, &here.rotation);
                let slope = (slope_of(linear), turning.slope(dt));
                let force = linear.pull(way, &velocity, dt);
                let torque = turning.pull(off, &angular_velocity, dt);
                (force, torque, Some(slope))
            }
            Effort::Wall {
                point,
                normal,
                spring,
            } => {
                let across = *normal * normal.transpose();
                let depth = across * (*point - position);
                let push = spring.pull(depth, &(across * velocity), dt);
                // The wall must not pull. It therefore acts neither on a point outside nor on a
                // point that leaves faster than the wall follows. The arm's acceleration is not
                // known yet. For one step, the wall may therefore pull a leaving point with the
                // slope times the acceleration.
                let is_behind = (depth - across * velocity * dt).dot(normal) > 0.0;
                if !is_behind || push.dot(normal) <= 0.0 {
                    (none, none, None)
                } else {
                    (push, none, Some((across * spring.slope(dt), 0.0)))
                }
            }
            Effort::Torque(_) | Effort::Block { .. } => return External::NONE,
        };
        let wrench = stack(&force, &torque);
        let slope = slope.map(|(linear, angular)| {
            let mut slope = jacobian * angular;
            let upper = linear * jacobian.fixed_rows::<3>(0);
            slope.fixed_rows_mut::<3>(0).copy_from(&upper);
            slope
        });
        self.step = (wrench, slope);
        External {
            torque: jacobian.tr_mul(&wrench),
            slope: slope.map(|slope| jacobian.tr_mul(&slope)),
        }
    }
}

/// Holds the joint of this index at its current angle plus `ahead`.
fn block(index: usize, ahead: f64, dq: f64, dt: f64) -> External {
    let spring = Spring::damped(FIRM_JOINT, JOINT_INERTIA);
    let mut torque = JointVector::zeros();
    torque[index] = spring.stiffness * (ahead - dq * dt) - spring.damping * dq;
    let mut slope = MassMatrix::zeros();
    slope[(index, index)] = spring.slope(dt);
    External {
        torque,
        slope: Some(slope),
    }
}

/// Jacobian of the point at `arm` from the point to which `jacobian` belongs.
fn displaced(mut jacobian: Jacobian, arm: &Vector3<f64>) -> Jacobian {
    for mut joint in jacobian.column_iter_mut() {
        let turning = joint.fixed_rows::<3>(3).cross(arm);
        let mut linear = joint.fixed_rows_mut::<3>(0);
        linear += turning;
    }
    jacobian
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::Arm;
    use crate::plant::{LinkTorque, Plant, RigidArm};
    use franka_model::{Frame, GRAVITY_EARTH, Load, Model, READY, RobotKind};

    const STEP: f64 = 0.000_25;

    #[test]
    fn felt_force_is_the_one_that_accelerates_the_arm() {
        let (kind, frames) = (RobotKind::Fr3, EndEffector::default());
        let arm = Arm::ideal(kind);
        let as_built = arm.body.as_built(kind);
        let model = Model::physically_consistent(kind);
        let offset = Vector3::new(0.03, -0.02, 0.1);
        let pose = model.pose(Frame::EndEffector, &READY, &frames);
        let here = transform::isometry(&pose).expect("a pose") * nalgebra::Point3::from(offset);
        let floor = here.coords - Vector3::new(0.0, 0.0, 0.001);
        let touches = [
            Touch::hold(),
            Touch::hold().stiffness(1e6),
            Touch::spring(here.coords + Vector3::repeat(0.01), 1e5),
            Touch::carry(move |t| here.coords * (1.0 - t), 1e4),
            Touch::wall(floor, Vector3::new(0.1, -0.2, 1.0)),
            Touch::wrench(Wrench::new(1.0, 2.0, 3.0, 0.1, 0.2, 0.3)),
        ];
        for touch in touches {
            let name = format!("{touch:?}");
            let mut plant = RigidArm::new(kind, &arm, READY, Load::NONE);
            let mut touches = Touches::default();
            let id = touches.add(touch.offset(offset), 0);
            let mut most = 0.0_f64;
            // The loop ends before the end stops act.
            for step in 1..=100 {
                // Each step counts as a millisecond, so that the felt wrench belongs to the step.
                touches.advance(step);
                let (q, dq) = (*plant.q(), *plant.dq());
                let external = touches.act(&as_built, &frames, (&q, &dq), 0.0, STEP);
                plant.step(&LinkTorque::ZERO, &external, STEP);
                let ddq = (plant.dq() - dq) / STEP;
                touches.feel(&ddq);
                let felt = touches.felt(id).expect("it lasts");
                most = most.max(felt.amax());

                let (force, torque) = halves(&felt);
                let (pose, jacobian) = model.pose_and_jacobian(Frame::EndEffector, &q, &frames);
                let lever = pose.fixed_view::<3, 3>(0, 0) * offset;
                let at_frame = stack(&force, &(torque + lever.cross(&force)));
                let acted = jacobian.tr_mul(&at_frame);
                let expected = model.inverse_dynamics(&q, &dq, &ddq, &Load::NONE, &GRAVITY_EARTH);
                let off = (acted - expected).amax();
                assert!(off < 1e-6, "{name}, step {step}: {off} N·m");
            }
            assert!(most > 1.0, "{name}: {most}");
        }
    }
}
