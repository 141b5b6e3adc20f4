//! One generator and its sequence of events.

use franka_otg::{
    AxisLimits, AxisState, CYCLE, Generator, Limits, PlanError, State, Synchronisation,
};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use crate::problem::{self, Kind};
use crate::report::SoakReport;
use crate::watch::Watch;

/// Creates a plan to targets in motion, with limits of all kinds, from a random state.
///
/// Single plans cover more kinds of starts than a closed loop.
pub(crate) fn plan(seed: u64, report: &mut SoakReport) {
    let mut random = SmallRng::seed_from_u64(seed);
    match random.random_range(0..4) {
        0 => single::<1>(seed, &mut random, report),
        1 => single::<2>(seed, &mut random, report),
        2 => single::<3>(seed, &mut random, report),
        _ => single::<7>(seed, &mut random, report),
    }
}

fn single<const N: usize>(seed: u64, random: &mut SmallRng, report: &mut SoakReport) {
    let limits = Kind::Mixed.limits::<N>(random);
    let state = problem::departure(random, &limits);
    let target = if random.random_bool(0.5) {
        problem::target(random, &state, &limits, true)
    } else {
        problem::arrival(random, &state, &limits)
    };
    let failures = report.failures.len();
    let check_optimum = random.random_bool(0.01);
    if let Some(least) = follow(seed, limits, state, &target, check_optimum, report) {
        blocked(
            seed,
            random,
            (limits.axis(0), state.axis(0), target.axis(0)),
            least,
            report,
        );
    }
    report.failures.truncate(failures + 1);
}

/// Checks one plan from its start to rest; returns when it is at the target.
fn follow<const N: usize>(
    seed: u64,
    limits: Limits<N>,
    state: State<N>,
    target: &State<N>,
    check_optimum: bool,
    report: &mut SoakReport,
) -> Option<f64> {
    let mut watch = Watch::new(seed, Synchronisation::Time);
    let planned = Generator::new(state, limits).and_then(|generator| {
        let mut generator = generator.with_synchronisation(Synchronisation::Time);
        generator.set_moving_target(target)?;
        Ok(generator)
    });
    let generator = planned
        .inspect_err(|error| watch.fail(report, error.to_string()))
        .ok()?;
    watch.planned(&generator, Some(target), check_optimum, report);
    let dt = generator.remaining() / SAMPLES;
    let mut before = state;
    for k in 1..=SAMPLES as u32 {
        let after = generator.sample(dt * f64::from(k));
        watch.step(&limits, &before, &after, dt, report);
        before = after;
    }
    Some(generator.time_to_target())
}

/// If a duration above `least` is infeasible although a shorter one is feasible, finds the
/// beginning of the blocked interval. Then checks plans of exactly this duration, slightly shorter
/// and slightly longer.
fn blocked(
    seed: u64,
    random: &mut SmallRng,
    axis: (AxisLimits, AxisState, AxisState),
    least: f64,
    report: &mut SoakReport,
) {
    let (limits, from, to) = axis;
    let mut plan = |duration: f64| {
        let (limits, state, target) = problem::beside_one_that_takes(duration, limits, from, to);
        follow(seed, limits, state, &target, false, report)
    };
    let mut delayed =
        |duration: f64| plan(duration).is_some_and(|arrival| arrival > duration * (1.0 + EDGE));
    let mut high = least * random.random_range(1.0..4.0);
    let mut low = least;
    if least == 0.0 || !delayed(high) || delayed(low) {
        return;
    }
    while high - low > EDGE * high {
        let middle = 0.5 * (low + high);
        if delayed(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    for _ in 0..10 {
        let part = 10_f64.powf(random.random_range(-12.0..-1.0));
        plan(high * (1.0 + part));
        plan(low * (1.0 - part));
    }
}

/// Runs the episode of a seed.
pub(crate) fn run(seed: u64, report: &mut SoakReport) {
    let mut random = SmallRng::seed_from_u64(seed);
    match random.random_range(0..4) {
        0 => episode::<1>(seed, &mut random, report),
        1 => episode::<3>(seed, &mut random, report),
        2 => episode::<6>(seed, &mut random, report),
        _ => episode::<7>(seed, &mut random, report),
    }
}

fn episode<const N: usize>(seed: u64, random: &mut SmallRng, report: &mut SoakReport) {
    let kind = Kind::random(random);
    let limits = kind.limits::<N>(random);
    let synchronisation = if random.random_bool(0.6) {
        Synchronisation::Time
    } else {
        Synchronisation::Straight
    };
    let state = problem::state(random, &limits);
    let watch = Watch::new(seed, synchronisation);
    let failures = report.failures.len();
    let result = if random.random_bool(0.9) {
        Loop::new(state, limits, watch, report).and_then(|mut run| run.kept_plans(random, kind))
    } else {
        Loop::new(state, limits, watch, report).and_then(|mut run| run.plans_anew(random))
    };
    if let Err(error) = result {
        let failure = format!("seed {seed}, {N} axes, {synchronisation:?}: {error}");
        report.failures.push(failure);
    }
    // One defect appears in many cycles.
    report.failures.truncate(failures + 1);
}

struct Loop<'a, const N: usize> {
    generator: Generator<N>,
    synchronisation: Synchronisation,
    /// The current target; without one the generator stops.
    target: Option<State<N>>,
    watch: Watch<N>,
    report: &'a mut SoakReport,
}

impl<'a, const N: usize> Loop<'a, N> {
    fn new(
        state: State<N>,
        limits: Limits<N>,
        watch: Watch<N>,
        report: &'a mut SoakReport,
    ) -> Result<Self, PlanError> {
        let synchronisation = watch.synchronisation();
        let generator = Generator::new(state, limits)?.with_synchronisation(synchronisation);
        let mut new = Self {
            generator,
            synchronisation,
            target: None,
            watch,
            report,
        };
        new.planned(false);
        Ok(new)
    }

    /// Targets in bursts, gaps, changed limits and stops; the plan is followed in between.
    fn kept_plans(&mut self, random: &mut SmallRng, kind: Kind) -> Result<(), PlanError> {
        for _ in 0..EVENTS {
            match random.random_range(0..40) {
                0 => {
                    self.generator.brake();
                    self.target = None;
                    self.planned(false);
                }
                1 => self.change_limits(kind.limits(random))?,
                2 => self.nudge(random)?,
                _ => {
                    for _ in 0..random.random_range(1..4) {
                        self.new_target(random)?;
                    }
                }
            }
            let gap = match random.random_range(0..10) {
                0..5 => random.random_range(0..4),
                5..9 => random.random_range(4..40),
                _ => random.random_range(40..400),
            };
            for _ in 0..gap {
                self.step();
            }
        }
        self.finish();
        Ok(())
    }

    /// A sequence of targets, with a new plan in every cycle by a generator that only knows the
    /// state.
    fn plans_anew(&mut self, random: &mut SmallRng) -> Result<(), PlanError> {
        for _ in 0..3 {
            let target = self.new_target(random)?;
            let duration = self.generator.time_to_target();
            let cycles = ((duration / CYCLE) as usize).min(CYCLES_MAX);
            for k in 1..cycles {
                self.step();
                let state = *self.generator.state();
                self.generator = Generator::new(state, *self.generator.limits())?
                    .with_synchronisation(self.synchronisation);
                self.generator.set_moving_target(&target)?;
                self.planned(false);
                self.report.anew += 1;
                // If rounding hides the line, the axes continue separately, and arrive earlier.
                let late = (self.generator.time_to_target() - duration) / CYCLE + k as f64;
                self.report.late.see(late, self.watch.seed());
                if late > 1.0 {
                    let what = format!("{late} cycles late after {k} of {cycles}");
                    self.watch.fail(self.report, what);
                    return Ok(());
                }
            }
        }
        self.finish();
        Ok(())
    }

    fn new_target(&mut self, random: &mut SmallRng) -> Result<State<N>, PlanError> {
        let moving = random.random_bool(0.4);
        let (now, limits) = (*self.generator.state(), *self.generator.limits());
        let target = problem::target(random, &now, &limits, moving);
        self.generator.set_moving_target(&target)?;
        self.target = Some(target);
        self.planned(random.random_bool(0.1));
        Ok(target)
    }

    /// Sets other limits. A target in motion may be too fast for them; then they are refused.
    fn change_limits(&mut self, limits: Limits<N>) -> Result<(), PlanError> {
        match self.generator.set_limits(limits) {
            Err(PlanError::TargetMotion { .. }) => return Ok(()),
            other => other?,
        }
        self.watch.limits_changed();
        self.planned(false);
        Ok(())
    }

    /// An external event moves the position.
    fn nudge(&mut self, random: &mut SmallRng) -> Result<(), PlanError> {
        let mut state = *self.generator.state();
        for position in &mut state.position {
            *position += random.random_range(-1e-3..1e-3);
        }
        self.generator.set_state(state)?;
        self.planned(false);
        Ok(())
    }

    fn planned(&mut self, check_optimum: bool) {
        self.watch.planned(
            &self.generator,
            self.target.as_ref(),
            check_optimum,
            self.report,
        );
    }

    fn step(&mut self) {
        let before = *self.generator.state();
        let after = *self.generator.step();
        self.watch
            .step(self.generator.limits(), &before, &after, CYCLE, self.report);
    }

    /// Steps until rest, which must match the generator's report.
    fn finish(&mut self) {
        let cycles = self.generator.remaining() / CYCLE;
        if cycles > CYCLES_MAX as f64 {
            return;
        }
        let mut taken = 0.0;
        while !self.generator.is_done() && taken < cycles + 2.0 {
            self.step();
            taken += 1.0;
        }
        self.report.arrivals += 1;
        if taken > (cycles + 1.0).floor() || !self.generator.is_done() {
            let what = format!("still moves after {taken} cycles of {cycles}");
            self.watch.fail(self.report, what);
        }
    }
}

/// Number of targets and other events of an episode.
const EVENTS: usize = 150;
/// Relative precision of the search for the beginning of blocked durations.
const EDGE: f64 = 1e-12;
/// Number of instants at which a single plan is checked.
const SAMPLES: f64 = 100.0;
/// Number of cycles above which motions are checked as plans and not followed to their end.
const CYCLES_MAX: usize = 4000;
