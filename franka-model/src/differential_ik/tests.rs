use super::*;
use crate::analytic_ik::reach;
use crate::jacobian::squared_manipulabilities;
use crate::oracle::minimum_by_enumeration;
use crate::random::Random;
use crate::{CYCLE, EndEffector, Frame, Model, READY, RobotKind, joint_vector, rotation};
use nalgebra::{Isometry3, Vector3};

const UNBOUNDED: JointVector = joint_vector([f64::INFINITY; 7]);

fn jacobian(q: &JointVector) -> Jacobian {
    Model::fr3().zero_jacobian(Frame::EndEffector, q, &EndEffector::default())
}

fn solve(
    jacobian: &Jacobian,
    twist: &Twist,
    posture: &JointVector,
    bound: &JointVector,
) -> Solution {
    let bounds = JointBox::symmetric(bound);
    DifferentialIk::default().solve(jacobian, twist, posture, &bounds, Default::default())
}

#[test]
fn the_twist_is_met_where_nothing_binds() {
    let mut random = Random::new(51);
    let jacobian = jacobian(&READY);
    for _ in 0..100 {
        let twist = jacobian * random.joints(1.0);
        let solution = solve(&jacobian, &twist, &JointVector::zeros(), &UNBOUNDED);
        assert_eq!(solution.outcome, Outcome::Optimal);
        assert!(solution.residual.norm() < 1e-4 * twist.norm());
        assert!(solution.residual.fixed_rows::<3>(0).norm() < 1e-8);
    }
}

#[test]
fn the_posture_moves_the_joints_without_moving_the_hand() {
    let mut random = Random::new(52);
    let jacobian = jacobian(&READY);
    for _ in 0..100 {
        let posture = random.joints(1.0);
        let solution = solve(&jacobian, &Twist::zeros(), &posture, &UNBOUNDED);
        assert!(solution.residual.norm() < 1e-3 * posture.norm());
        assert!(solution.residual.fixed_rows::<3>(0).norm() < 1e-8);
        // The solution is the posture's part in the nullspace, orthogonal to the rest.
        let rest = posture - solution.velocity;
        assert!(solution.velocity.dot(&rest).abs() < 1e-3);
        let nullspace_share = jacobian
            .transpose()
            .svd(true, false)
            .u
            .map(|range| (posture - range * range.tr_mul(&posture) - solution.velocity).norm());
        assert!(nullspace_share.expect("asked for") < 1e-3);
    }
}

#[test]
fn a_bound_joint_leaves_its_share_to_the_others() {
    // The elbow may not move fast, but the hand moves sideways as commanded.
    let jacobian = jacobian(&READY);
    let twist = Twist::new(0.0, 0.1, 0.0, 0.0, 0.0, 0.0);
    let free = solve(&jacobian, &twist, &JointVector::zeros(), &UNBOUNDED);
    let mut bound = UNBOUNDED;
    bound[0] = 0.5 * free.velocity[0].abs();
    let bound = solve(&jacobian, &twist, &JointVector::zeros(), &bound);
    assert_eq!(bound.velocity[0].abs(), 0.5 * free.velocity[0].abs());
    assert!(bound.active[0] != Side::Free);
    assert!(bound.residual.norm() < 1e-4 * twist.norm());
}

#[test]
fn velocities_stay_inside_the_box_everywhere() {
    let mut random = Random::new(53);
    let limits = Model::fr3().joint_limits();
    for _ in 0..5000 {
        let q = random.posture(Model::fr3());
        let (lower, upper) = limits.velocity_envelope(&q, 0.0);
        let bounds = JointBox::new(&lower, &upper);
        let twist = Twist::from_fn(|_, _| random.uniform(-2.0, 2.0));
        let ik = DifferentialIk::default();
        let solution = ik.solve(
            &jacobian(&q),
            &twist,
            &random.joints(0.5),
            &bounds,
            Default::default(),
        );
        assert_eq!(solution.outcome, Outcome::Optimal);
        assert_eq!(bounds.clamp(&solution.velocity), solution.velocity);
    }
}

#[test]
fn damping_bounds_the_joint_velocities_near_singularities() {
    let mut random = Random::new(54);
    let stretched = crate::elbow::FLIP_ANGLE;
    let mut singular = 0;
    for case in 0..20_000 {
        let mut q = random.posture(Model::fr3());
        let near = random.uniform(-0.1, 0.1);
        match case % 4 {
            0 => q[1] = near,                                // shoulder
            1 => q[4] = core::f64::consts::FRAC_PI_2 + near, // wrist
            2 => q[3] = stretched + near,                    // elbow
            _ => {}
        }
        let jacobian = jacobian(&q);
        let direction = random.vector3(1.0).normalize();
        let twist = Twist::new(direction.x, direction.y, direction.z, 0.0, 0.0, 0.0);
        let solution = solve(&jacobian, &twist, &JointVector::zeros(), &UNBOUNDED);
        // The solver keeps the position at the cost of the orientation, even if the orientation
        // then changes fast.
        assert!(solution.velocity.norm() < 1000.0);
        let turn = Twist::new(0.0, 0.0, 0.0, direction.x, direction.y, direction.z);
        let solution = solve(&jacobian, &turn, &JointVector::zeros(), &UNBOUNDED);
        assert!(solution.velocity.norm() < 15.0);
        let smooth = DifferentialIk::smooth().solve(
            &jacobian,
            &twist,
            &JointVector::zeros(),
            &JointBox::symmetric(&UNBOUNDED),
            Default::default(),
        );
        assert!(smooth.velocity.norm() < 50.0);
        singular += usize::from(squared_manipulabilities(&jacobian)[1] < 1e-6);
    }
    assert!(singular > 1000);
}

#[test]
fn damping_is_smooth_along_a_path_into_a_singularity() {
    let ik = DifferentialIk::default();
    // With all angles zero, no axis points along x: the hand cannot roll.
    let at = |s: f64| ik.squared_damping(&jacobian(&(READY * (1.0 - s))));
    let steps = 2000;
    let values: std::vec::Vec<f64> = (0..=steps)
        .map(|k| at(f64::from(k) / f64::from(steps)))
        .collect();
    let Damping { floor, ceiling, .. } = ik.damping;
    let least = (ik.orientation_weight * floor).powi(2);
    assert!((values[0] / least - 1.0).abs() < 1e-12);
    let top = values[values.len() - 1];
    assert!(top > (0.99 * ik.orientation_weight * ceiling).powi(2));
    // First differences change gradually: the derivative has no step.
    for window in values.windows(3) {
        let bend = window[0] - 2.0 * window[1] + window[2];
        assert!(bend.abs() < 1e-4 * top, "{bend:e}");
    }
}

/// Number of cases. With `--release`, it is the number that the docs state.
const CASES: usize = if cfg!(debug_assertions) { 300 } else { 100_000 };

#[test]
fn solution_matches_the_minimum_over_all_active_sets() {
    let mut random = Random::new(55);
    let ik = DifferentialIk::default();
    let (mut passes, mut worst) = (0, 0.0_f64);
    for case in 0..CASES {
        let model = Model::of(RobotKind::ALL[case % 2]);
        let q = random.posture(model);
        let jacobian = jacobian(&q);
        // Some boxes do not contain zero, and some joints may not move at all.
        let middle = random.joints(0.3);
        let width = JointVector::from_fn(|_, _| match random.bits() % 8 {
            0 => 0.0,
            _ => random.uniform(0.0, 1.5),
        });
        let bounds = JointBox::new(&(middle - width), &(middle + width));
        let twist = Twist::from_fn(|_, _| random.uniform(-1.0, 1.0));
        let posture = random.joints(1.0);
        let start = core::array::from_fn(|_| match random.bits() % 4 {
            0 => Side::Lower,
            1 => Side::Upper,
            _ => Side::Free,
        });
        let found = ik.solve(&jacobian, &twist, &posture, &bounds, start);
        assert_eq!(found.outcome, Outcome::Optimal);
        passes = passes.max(found.passes);
        let (rows, mut task) = ik.weighted(&jacobian, &twist);
        let enumerate = |task: &Twist| {
            let damping = ik.squared_damping(&jacobian);
            let problem = Problem::new(&rows, task, &posture, damping);
            minimum_by_enumeration(&problem, &bounds)
        };
        let first = jacobian * enumerate(&task) - twist;
        let lacking = first.fixed_rows::<3>(0).amax() > NOTHING;
        for i in 0..3 {
            task[i] -= if lacking { first[i] } else { 0.0 };
        }
        let off = (found.velocity - enumerate(&task)).amax();
        worst = worst.max(off);
    }
    assert!(worst < 1e-9, "{worst:e}");
    assert!(passes < PASSES_MAX, "{passes} passes");
}

/// A control loop of one millisecond that follows a pose with its joints inside their limits.
struct Follower {
    q: JointVector,
    active: [Side; 7],
    /// Number of cycles in which a position limit held a joint.
    pinned: u32,
}

impl Follower {
    /// Feedback rate of errors, `[1/s]`.
    const FEEDBACK: f64 = 100.0;
    /// Deceleration of the braking envelope, `[rad/s²]`.
    const BRAKING: f64 = 8.0;

    fn new(q: JointVector) -> Self {
        Self {
            q,
            active: Default::default(),
            pinned: 0,
        }
    }

    /// Computes one cycle towards `target`, which moves at `velocity` without turning. Returns the
    /// remaining distance.
    fn step(&mut self, model: &Model, target: &Isometry3<f64>, velocity: &Vector3<f64>) -> f64 {
        let here = flange(&self.q);
        let offset = target.translation.vector - here.translation.vector;
        let turn = rotation::error(&target.rotation, &here.rotation) * Self::FEEDBACK;
        let linear = velocity + offset * Self::FEEDBACK;
        let twist = Twist::new(linear.x, linear.y, linear.z, turn.x, turn.y, turn.z);
        let limits = model.joint_limits();
        let speed = |i: usize, distance: f64| {
            let braking = (2.0 * Self::BRAKING * distance.max(0.0)).sqrt();
            let there = distance.max(0.0) / CYCLE;
            braking.min(there).min(limits.velocity[i])
        };
        let bounds = JointBox::new(
            &JointVector::from_fn(|i, _| -speed(i, self.q[i] - limits.lower[i])),
            &JointVector::from_fn(|i, _| speed(i, limits.upper[i] - self.q[i])),
        );
        let solution = DifferentialIk::default().solve(
            &jacobian(&self.q),
            &twist,
            &JointVector::zeros(),
            &bounds,
            self.active,
        );
        assert_eq!(solution.outcome, Outcome::Optimal);
        self.active = solution.active;
        let at_limit = |i: usize| {
            speed(i, self.q[i] - limits.lower[i]).min(speed(i, limits.upper[i] - self.q[i])) < 1e-3
        };
        self.pinned += u32::from((0..7).any(|i| self.active[i] != Side::Free && at_limit(i)));
        self.q += solution.velocity * CYCLE;
        assert!(limits.contains(&self.q));
        (flange(&self.q).translation.vector - target.translation.vector - velocity * CYCLE).norm()
    }

    /// Follows a straight line of `length` at `speed` from the current position, with constant
    /// orientation. Returns the largest distance from the reference.
    fn line(&mut self, model: &Model, direction: &Vector3<f64>, length: f64, speed: f64) -> f64 {
        let mut target = flange(&self.q);
        let velocity = direction * speed;
        let cycles = (length / speed / CYCLE) as u32;
        let mut worst = 0.0_f64;
        for _ in 0..cycles {
            worst = worst.max(self.step(model, &target, &velocity));
            target.translation.vector += velocity * CYCLE;
        }
        worst
    }
}

fn flange(q: &JointVector) -> Isometry3<f64> {
    let pose = Model::fr3().pose(Frame::Flange, q, &EndEffector::default());
    crate::transform::isometry(&pose).expect("rigid")
}

/// Largest position error on a line, `[m]`.
const POSITION: f64 = 1e-4;
/// Length of a line, `[m]`.
const LINE: f64 = 0.12;
const LINES: usize = if cfg!(debug_assertions) { 28 } else { 140 };

/// Returns true if every point of a line is at least three centimetres within the reach of the
/// flange.
fn reachable(from: &JointVector, direction: &Vector3<f64>, length: f64) -> bool {
    let start = flange(from).translation.vector;
    (0..=5).all(|k| {
        let point = start + direction * (length * f64::from(k) / 5.0);
        let found = reach::position(Model::fr3(), &point, &EndEffector::default());
        found.is_ok_and(|reach| reach.margin > 0.03)
    })
}

#[test]
fn line_along_a_joint_limit_gives_up_orientation_only() {
    let mut random = Random::new(56);
    let model = Model::fr3();
    let limits = model.joint_limits();
    let (mut lines, mut pinned, mut turned) = (0, 0, 0);
    while lines < LINES {
        let mut q = READY + random.joints(0.4);
        let i = lines % 7;
        q[i] = [limits.lower[i], limits.upper[i]][(random.bits() % 2) as usize];
        let direction = random.vector3(1.0).normalize();
        if !limits.contains(&q) || !reachable(&q, &direction, LINE) {
            continue;
        }
        lines += 1;
        let mut follower = Follower::new(q);
        let worst = follower.line(model, &direction, LINE, 0.1);
        assert!(worst < POSITION, "joint {i}: {worst:e} m at {q}");
        pinned += usize::from(follower.pinned > 100);
        let turn = rotation::error(&flange(&q).rotation, &flange(&follower.q).rotation);
        turned += usize::from(turn.norm() > 0.05);
    }
    // The test covers the limits only if some were active, and the priority only if a part of the
    // task failed.
    assert!(
        3 * pinned > lines && 20 * turned > lines,
        "{pinned}, {turned} of {lines}"
    );
}

/// Returns a posture with joint 5 a quarter turn off, with the least manipulability near a random
/// posture.
fn singular_wrist(random: &mut Random) -> JointVector {
    let limits = Model::fr3().joint_limits();
    let mut q = random.posture(Model::fr3());
    q[4] = core::f64::consts::FRAC_PI_2;
    let value = |q: &JointVector| squared_manipulabilities(&jacobian(q))[1];
    let mut step = 0.5;
    while step > 1e-6 {
        let mut next = q + random.joints(step);
        next[4] = q[4];
        if limits.contains(&next) && value(&next) < value(&q) {
            q = next;
        } else {
            step *= 0.99;
        }
    }
    q
}

#[test]
fn a_line_through_a_wrist_singularity_keeps_the_position() {
    let mut random = Random::new(57);
    let model = Model::fr3();
    let (mut lines, mut crossed, mut singular) = (0, 0, 0);
    while lines < LINES {
        // With joint 7 locked, the wrist is singular in all of these postures. In every second
        // posture, the whole arm is singular, or almost, within the limits.
        let mut q = READY + random.joints(0.4);
        q[4] = core::f64::consts::FRAC_PI_2;
        if lines % 2 == 1 {
            q = singular_wrist(&mut random);
        }
        let direction = random.vector3(1.0).normalize();
        if !(reachable(&q, &direction, 0.5 * LINE) && reachable(&q, &-direction, 0.5 * LINE)) {
            continue;
        }
        lines += 1;
        let mut follower = Follower::new(q);
        let back = follower.line(model, &-direction, 0.5 * LINE, 0.1);
        let before = follower.q[4];
        let through = follower.line(model, &direction, LINE, 0.1);
        let worst = back.max(through);
        assert!(worst < POSITION, "{worst:e} m through {q}");
        crossed += usize::from((before > q[4]) != (follower.q[4] > q[4]));
        singular += usize::from(squared_manipulabilities(&jacobian(&q))[1] < 1e-6);
    }
    assert!(2 * crossed > lines, "{crossed} of {lines}");
    assert!(4 * singular > lines, "{singular} of {lines}");
}
