//! Compares the search with an enumeration of all active sets and with the optimality conditions.

use super::*;
use crate::oracle::minimum_by_enumeration;
use crate::random::Random;
use crate::{Jacobian, Twist};

struct Case {
    rows: Jacobian,
    task: Twist,
    posture: JointVector,
    damping: f64,
    bounds: JointBox,
}

impl Case {
    /// Returns a problem as in differential IK, with rank 6 and damping. Some intervals
    /// have no width, some bounds are infinite, and some bounds are at the free minimum.
    fn random(random: &mut Random, damping: f64) -> Self {
        let rows = Jacobian::from_fn(|_, _| random.uniform(-1.0, 1.0));
        let bound = JointVector::from_fn(|_, _| match random.bits() % 8 {
            0 => 0.0,
            1 => f64::INFINITY,
            _ => random.uniform(0.0, 2.0),
        });
        let shift = random.joints(0.5);
        Self {
            rows,
            task: Twist::from_fn(|_, _| random.uniform(-2.0, 2.0)),
            posture: random.joints(1.0),
            damping,
            bounds: JointBox::new(&(shift - bound), &(shift + bound)),
        }
    }

    fn problem(&self) -> Problem<'_> {
        Problem::new(&self.rows, &self.task, &self.posture, self.damping)
    }

    fn solve(&self, active: [Side; 7], passes_max: usize) -> Minimum {
        minimise(&self.problem(), &self.bounds, active, passes_max)
    }

    fn holds(&self, x: &JointVector) -> bool {
        self.bounds.clamp(x) == *x
    }

    /// Returns the largest violation of the optimality conditions. A violation is a gradient that
    /// points into the box at a bound, or any gradient inside the box.
    fn fault(&self, x: &JointVector) -> f64 {
        let residual = self.rows * x - self.task;
        let gradient = self.rows.tr_mul(&residual) + (x - self.posture) * self.damping;
        let fault = |i: usize| {
            let up = x[i] < self.bounds.upper[i] && gradient[i] < 0.0;
            let down = x[i] > self.bounds.lower[i] && gradient[i] > 0.0;
            if up || down { gradient[i].abs() } else { 0.0 }
        };
        (0..7).map(fault).fold(0.0, f64::max)
    }
}

fn sides(random: &mut Random) -> [Side; 7] {
    core::array::from_fn(|_| match random.bits() % 3 {
        0 => Side::Free,
        1 => Side::Lower,
        _ => Side::Upper,
    })
}

/// Number of cases. With `--release`, it is the number that the docs state.
const CASES: usize = if cfg!(debug_assertions) { 300 } else { 10_000 };

#[test]
fn the_minimum_is_that_of_all_active_sets() {
    let mut random = Random::new(21);
    for case in 0..CASES {
        let damping = [1e-6, 1e-4, 1e-2][case % 3];
        let case = Case::random(&mut random, damping);
        let found = case.solve(Default::default(), PASSES_MAX);
        assert_eq!(found.outcome, Outcome::Optimal);
        let expected = minimum_by_enumeration(&case.problem(), &case.bounds);
        let off = (found.x - expected).amax();
        assert!(off < 1e-9, "{off:e} at {damping:e}");
    }
}

#[test]
fn the_conditions_of_optimality_hold_from_any_start() {
    let mut random = Random::new(22);
    let mut passes = 0;
    for case in 0..100 * CASES {
        let damping = [1e-10, 1e-4, 1.0][case % 3];
        let problem = Case::random(&mut random, damping);
        for active in [Default::default(), sides(&mut random)] {
            let found = problem.solve(active, PASSES_MAX);
            assert_eq!(found.outcome, Outcome::Optimal, "case {case}");
            assert!(problem.holds(&found.x), "case {case}");
            let fault = problem.fault(&found.x);
            assert!(fault < 1e-11, "case {case}: gradient {fault:e}");
            passes = passes.max(found.passes);
        }
    }
    assert!(passes < PASSES_MAX, "{passes} passes");
}

#[test]
fn the_active_set_of_the_answer_is_the_best_start() {
    let mut random = Random::new(23);
    for _ in 0..1000 {
        let problem = Case::random(&mut random, 1e-4);
        let cold = problem.solve(Default::default(), PASSES_MAX);
        let warm = problem.solve(cold.active, PASSES_MAX);
        assert_eq!((warm.outcome, warm.passes), (Outcome::Optimal, 1));
        assert!((warm.x - cold.x).amax() < 1e-9);
    }
}

#[test]
fn one_bound_at_a_time_leads_to_the_same_minimum() {
    let mut random = Random::new(24);
    for _ in 0..2000 {
        let case = Case::random(&mut random, 1e-4);
        let problem = case.problem();
        let mut search = Search {
            problem: &problem,
            bounds: &case.bounds,
            linear: problem.linear(),
            x: case.bounds.clamp(&case.posture),
            active: [Side::Free; 7],
        };
        for (i, side) in sides(&mut random).into_iter().enumerate() {
            search.hold(i, side);
        }
        let mut passes = 0;
        loop {
            passes += 1;
            assert!(case.holds(&search.x));
            let factor = search.factor().expect("positive definite");
            let (mut goal, _) = search.minimum_of_free(&factor);
            let gradient = search.refine(&factor, &mut goal);
            if search.descend(&goal, &gradient) {
                break;
            }
        }
        assert!(passes <= PASSES_MAX - GUESSES, "{passes} passes");
        let expected = case.solve(Default::default(), PASSES_MAX).x;
        assert!((search.x - expected).amax() < 1e-9);
    }
}

#[test]
fn stopped_early_it_is_inside_the_box() {
    let mut random = Random::new(25);
    let (mut ended, mut stopped) = (0, 0);
    for _ in 0..2000 {
        let problem = Case::random(&mut random, 1e-4);
        for passes in 0..6 {
            let found = problem.solve(Default::default(), passes);
            assert!(problem.holds(&found.x));
            match found.outcome {
                Outcome::Optimal => {
                    assert!(problem.fault(&found.x) < 1e-11);
                    ended += 1;
                }
                outcome => {
                    assert_eq!(outcome, Outcome::PassLimit);
                    stopped += 1;
                }
            }
        }
    }
    assert!(
        ended > 1000 && stopped > 1000,
        "{ended} ended, {stopped} stopped"
    );
}

#[test]
fn crossing_bounds_fix_a_variable_at_their_midpoint() {
    let mut random = Random::new(26);
    let mut problem = Case::random(&mut random, 1e-2);
    let (mut lower, mut upper) = (problem.bounds.lower, problem.bounds.upper);
    (lower[2], upper[2]) = (0.3 + 1e-12, 0.3 - 1e-12);
    (lower[5], upper[5]) = (f64::INFINITY, f64::NEG_INFINITY);
    problem.bounds = JointBox::new(&lower, &upper);
    let found = problem.solve(Default::default(), PASSES_MAX);
    assert!((found.x[2] - 0.3).abs() < 1e-15);
}

#[test]
fn non_finite_numbers_end_the_search_without_panic() {
    let mut random = Random::new(27);
    let good = Case::random(&mut random, 1e-2);
    let solve = |problem: &Problem<'_>, bounds: &JointBox| {
        for active in [[Side::Free; 7], [Side::Lower; 7], [Side::Upper; 7]] {
            assert!(minimise(problem, bounds, active, PASSES_MAX).passes <= PASSES_MAX);
        }
    };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for i in 0..7 {
            let (mut rows, mut task, mut posture) = (good.rows, good.task, good.posture);
            rows[(i % 6, i)] = bad;
            task[i % 6] = bad;
            posture[i] = bad;
            let (mut lower, mut upper) = (good.bounds.lower, good.bounds.upper);
            lower[i] = bad;
            upper[6 - i] = bad;
            let bounds = JointBox::new(&lower, &upper);
            let problem = good.problem();
            solve(&problem, &bounds);
            let damping = good.damping;
            solve(
                &Problem::new(&rows, &good.task, &good.posture, damping),
                &bounds,
            );
            solve(
                &Problem {
                    posture: &posture,
                    ..problem
                },
                &bounds,
            );
            let nowhere = Problem {
                task: &task,
                ..problem
            };
            solve(&nowhere, &bounds);
            let found = minimise(&nowhere, &good.bounds, Default::default(), PASSES_MAX);
            assert_eq!(found.outcome, Outcome::Degenerate);
            assert!(good.holds(&found.x), "{}", found.x);
        }
    }
}
