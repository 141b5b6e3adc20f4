//! The active-set method against enumeration and the conditions of optimality.

use super::*;
use crate::random::Random;

type Matrix7 = SMatrix<f64, 7, 7>;

struct Problem {
    hessian: Matrix7,
    linear: JointVector,
    bounds: JointBox,
}

impl Problem {
    /// Like those of differential IK: rank 6 and damping; some intervals without width, some
    /// bounds infinite, some touching where the free minimum is.
    fn random(random: &mut Random, damping: f64) -> Self {
        let jacobian = SMatrix::<f64, 6, 7>::from_fn(|_, _| random.uniform(-1.0, 1.0));
        let bound = JointVector::from_fn(|_, _| match random.bits() % 8 {
            0 => 0.0,
            1 => f64::INFINITY,
            _ => random.uniform(0.0, 2.0),
        });
        let shift = random.joints(0.5);
        let twist = SMatrix::<f64, 6, 1>::from_fn(|_, _| random.uniform(-2.0, 2.0));
        Self {
            hessian: jacobian.tr_mul(&jacobian) + Matrix7::identity() * damping,
            linear: jacobian.tr_mul(&twist) + random.joints(damping),
            bounds: JointBox::new(&(shift - bound), &(shift + bound)),
        }
    }

    fn solve(&self, near: &JointVector, active: [Side; 7], passes_max: usize) -> Minimum {
        let start = Start {
            near,
            active,
            passes_max,
        };
        minimise(&self.hessian, &self.linear, &self.bounds, &start)
    }

    fn value(&self, x: &JointVector) -> f64 {
        0.5 * x.dot(&(self.hessian * x)) - self.linear.dot(x)
    }

    fn holds(&self, x: &JointVector) -> bool {
        self.bounds.clamp(x) == *x
    }

    /// The largest violation of the optimality conditions: a gradient that points into the box,
    /// or any at all inside it.
    fn fault(&self, x: &JointVector) -> f64 {
        let gradient = self.hessian * x - self.linear;
        let fault = |i: usize| {
            let up = x[i] < self.bounds.upper[i] && gradient[i] < 0.0;
            let down = x[i] > self.bounds.lower[i] && gradient[i] > 0.0;
            if up || down { gradient[i].abs() } else { 0.0 }
        };
        (0..7).map(fault).fold(0.0, f64::max)
    }

    /// The minimum by trying every one of the 3⁷ active sets.
    fn oracle(&self) -> JointVector {
        let mut best = (f64::INFINITY, JointVector::zeros());
        for code in 0..3_usize.pow(7) {
            let mut fixed = [None; 7];
            for (i, slot) in fixed.iter_mut().enumerate() {
                *slot = match code / 3_usize.pow(i as u32) % 3 {
                    0 => None,
                    1 => Some(self.bounds.lower[i]),
                    _ => Some(self.bounds.upper[i]),
                };
            }
            if fixed.iter().flatten().any(|bound| !bound.is_finite()) {
                continue;
            }
            let mut matrix = self.hessian;
            let mut right = self.linear;
            for (i, bound) in fixed.iter().enumerate() {
                if let Some(bound) = bound {
                    matrix.set_row(i, &Matrix7::identity().row(i));
                    right[i] = *bound;
                }
            }
            let x = matrix.lu().solve(&right).expect("regular");
            let inside = (0..7).all(|i| {
                self.bounds.lower[i] - 1e-9 <= x[i] && x[i] <= self.bounds.upper[i] + 1e-9
            });
            if inside && self.value(&x) < best.0 {
                best = (self.value(&x), x);
            }
        }
        best.1
    }
}

#[test]
fn the_minimum_is_the_best_of_all_active_sets() {
    let mut random = Random::new(21);
    for _ in 0..60 {
        let problem = Problem::random(&mut random, 1e-2);
        let found = problem.solve(&JointVector::zeros(), Default::default(), PASSES_MAX);
        assert_eq!(found.outcome, Outcome::Optimal);
        assert!((found.x - problem.oracle()).amax() < 1e-8);
    }
}

#[test]
fn the_conditions_of_optimality_hold_from_any_start() {
    let mut random = Random::new(22);
    let mut passes = 0;
    for case in 0..20_000 {
        let damping = [1e-8, 1e-4, 1.0][case % 3];
        let problem = Problem::random(&mut random, damping);
        let active = core::array::from_fn(|_| match random.bits() % 3 {
            0 => Side::Free,
            1 => Side::Lower,
            _ => Side::Upper,
        });
        for active in [Default::default(), active] {
            let found = problem.solve(&random.joints(3.0), active, PASSES_MAX);
            assert_eq!(found.outcome, Outcome::Optimal, "case {case}");
            assert!(problem.holds(&found.x), "case {case}");
            let fault = problem.fault(&found.x);
            assert!(fault < 1e-11, "case {case}: gradient {fault:e}");
            passes = passes.max(found.passes);
        }
    }
    assert!(passes <= PASSES_MAX / 2, "{passes} passes");
}

#[test]
fn the_active_set_of_the_answer_is_the_best_start() {
    let mut random = Random::new(23);
    for _ in 0..1000 {
        let problem = Problem::random(&mut random, 1e-4);
        let cold = problem.solve(&JointVector::zeros(), Default::default(), PASSES_MAX);
        let warm = problem.solve(&cold.x, cold.active, PASSES_MAX);
        assert_eq!((warm.outcome, warm.passes), (Outcome::Optimal, 1));
        assert!((warm.x - cold.x).amax() < 1e-9);
    }
}

#[test]
fn stopped_early_it_is_inside_the_box_and_no_worse_than_before() {
    let mut random = Random::new(24);
    for _ in 0..2000 {
        let problem = Problem::random(&mut random, 1e-4);
        let near = random.joints(2.0);
        let mut value = problem.value(&problem.bounds.clamp(&near));
        for passes in 0..6 {
            let found = problem.solve(&near, Default::default(), passes);
            assert!(problem.holds(&found.x));
            assert!(problem.value(&found.x) <= value + 1e-12);
            value = problem.value(&found.x);
            let finished = found.outcome == Outcome::Optimal;
            assert!(finished || found.outcome == Outcome::PassLimit);
            assert!(!finished || problem.fault(&found.x) < 1e-11);
        }
    }
}

#[test]
fn crossing_bounds_fix_a_variable_at_their_midpoint() {
    let mut random = Random::new(25);
    let mut problem = Problem::random(&mut random, 1e-2);
    let (mut lower, mut upper) = (problem.bounds.lower, problem.bounds.upper);
    (lower[2], upper[2]) = (0.3 + 1e-12, 0.3 - 1e-12);
    (lower[5], upper[5]) = (f64::INFINITY, f64::NEG_INFINITY);
    problem.bounds = JointBox::new(&lower, &upper);
    let found = problem.solve(&JointVector::zeros(), Default::default(), PASSES_MAX);
    assert!((found.x[2] - 0.3).abs() < 1e-15);
}

#[test]
fn numbers_that_are_not_finite_end_the_search_without_panic() {
    let mut random = Random::new(26);
    let good = Problem::random(&mut random, 1e-2);
    let active = [Side::Lower; 7];
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for i in 0..7 {
            let mut hessian = good.hessian;
            hessian[(i, 0)] = bad;
            let mut linear = good.linear;
            linear[i] = bad;
            let (mut lower, mut upper) = (good.bounds.lower, good.bounds.upper);
            lower[i] = bad;
            upper[6 - i] = bad;
            let mut near = JointVector::zeros();
            near[i] = bad;
            let start = |active| Start {
                near: &near,
                active,
                passes_max: PASSES_MAX,
            };
            for bounds in [good.bounds, JointBox::new(&lower, &upper)] {
                for active in [Default::default(), active] {
                    let found = minimise(&hessian, &linear, &bounds, &start(active));
                    assert!(found.passes <= PASSES_MAX);
                    minimise(&good.hessian, &good.linear, &bounds, &start(active));
                }
            }
            let found = minimise(
                &good.hessian,
                &linear,
                &good.bounds,
                &start(Default::default()),
            );
            assert_eq!(found.outcome, Outcome::Degenerate);
            assert!(good.holds(&found.x), "{}", found.x);
        }
    }
}
