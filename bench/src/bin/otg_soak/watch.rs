//! Compares every plan, every cycle and every arrival with the generator's guarantees.

use franka_otg::{AxisLimits, AxisState, CYCLE, Generator, Limits, State, Synchronisation};

use crate::oracle::{least_duration, stop_point};
use crate::report::SoakReport;

/// The checks that span several plans.
pub(crate) struct Watch<const N: usize> {
    seed: u64,
    synchronisation: Synchronisation,
    /// True if the state could stay inside the limits at some cycle since they were set; then it
    /// must.
    inside: bool,
    axes: [Axis; N],
}

#[derive(Clone, Copy, Default)]
struct Axis {
    /// Position at rest at the target: no bit may change.
    still: Option<f64>,
    /// A target at rest that can be reached without overshooting, and its direction.
    ahead: Option<(f64, f64)>,
    /// Magnitude of the positions of the motion.
    size: f64,
}

/// Relative excess over a limit that counts as rounding.
const EXACT: f64 = 1e-9;
/// Relative error of a position.
const PLACE: f64 = 1e-12;
/// Relative error of durations compared with the search, whose position is rounded: near a stop
/// point its square root counts.
const OPTIMUM: f64 = 1e-6;

impl<const N: usize> Watch<N> {
    pub(crate) fn new(seed: u64, synchronisation: Synchronisation) -> Self {
        Self {
            seed,
            synchronisation,
            inside: false,
            axes: [Axis::default(); N],
        }
    }

    pub(crate) fn seed(&self) -> u64 {
        self.seed
    }

    pub(crate) fn synchronisation(&self) -> Synchronisation {
        self.synchronisation
    }

    pub(crate) fn limits_changed(&mut self) {
        self.inside = false;
    }

    /// Checks a new plan of a generator, towards a target or to rest.
    pub(crate) fn planned(
        &mut self,
        generator: &Generator<N>,
        target: Option<&State<N>>,
        check_optimum: bool,
        report: &mut SoakReport,
    ) {
        report.replans += 1;
        let (state, limits) = (generator.state(), generator.limits());
        self.inside |= can_stay(state, limits);
        let duration = generator.time_to_target();
        let on_their_own = self.synchronisation == Synchronisation::Time;
        let mut optimum = 0.0_f64;
        for i in 0..N {
            let (now, limits) = (state.axis(i), limits.axis(i));
            let start = [0.0, now.velocity, now.acceleration];
            let to = target.map_or(AxisState::at_rest(generator.end()[i]), |to| to.axis(i));
            let way = to.position - now.position;
            let reach = (limits.velocity * duration)
                .min(limits.acceleration * duration * duration)
                .min(limits.jerk * duration.powi(3));
            let at_rest = now == AxisState::at_rest(now.position);
            let ends = to == AxisState::at_rest(to.position);
            let stop = stop_point(start, limits);
            // The end of a stop is reached in the direction of the stop.
            let ahead = way - stop;
            let is_stop = ahead.abs() <= PLACE * (way.abs() + stop.abs());
            let side = 1_f64.copysign(if is_stop { stop } else { ahead });
            self.axes[i] = Axis {
                still: (now == to && ends).then_some(now.position),
                ahead: (ends
                    && self.inside
                    && (on_their_own || at_rest)
                    && goes_on(start, limits)
                    && side * way >= 0.0)
                    .then_some((to.position, side)),
                size: now.position.abs()
                    + to.position.abs()
                    + now.velocity.abs() * duration
                    + reach,
            };
            if check_optimum && ends && now != to {
                optimum = optimum.max(least_duration(start, way, limits));
            }
        }
        let rests = target.is_some_and(State::is_at_rest);
        if check_optimum && rests && self.inside && on_their_own && optimum > 0.0 {
            report.optima += 1;
            let slower = duration / optimum - 1.0;
            report.slower.see(slower, self.seed);
            // An arrival is rounded to a cycle anyway.
            if slower > OPTIMUM && duration - optimum > 1e-3 * CYCLE {
                self.fail(report, format!("{duration} s instead of {optimum} s"));
            }
        }
        if let Some(target) = target {
            self.landing(generator, target, report);
            self.together(generator, target, report);
        }
    }

    /// Checks that the motion leads to the target.
    fn landing(&self, generator: &Generator<N>, target: &State<N>, report: &mut SoakReport) {
        let duration = generator.time_to_target();
        if target.is_at_rest() && generator.sample(duration) != *target {
            self.fail(report, "does not end at its target".to_owned());
        }
        let met = generator.sample(duration * (1.0 + f64::EPSILON));
        let left = 1e-6 * duration;
        let before = generator.sample(duration - left);
        for i in 0..N {
            let (to, jerk) = (target.axis(i), generator.limits().axis(i).jerk);
            let expected = to.position - left * (to.velocity - 0.5 * left * to.acceleration);
            let error = (before.position[i] - expected).abs() - jerk * left.powi(3);
            let error = error.max((met.position[i] - to.position).abs());
            let error = (error / self.axes[i].size).max(0.0);
            report.landing.see(error, self.seed);
            if error > PLACE {
                self.fail(report, format!("axis {i} lands {error:e} off, size {:e}, {:?} to {to:?}, {duration} s, {:?} {before:?}", self.axes[i].size, generator.state().axis(i), generator.limits().axis(i)));
            }
        }
    }

    /// Checks that all moving axes arrive at the same time.
    fn together(&self, generator: &Generator<N>, target: &State<N>, report: &mut SoakReport) {
        if !target.is_at_rest() {
            return; // behind a moving target each axis stops separately
        }
        let last = generator.remaining();
        // In a duration of years, seconds are rounding.
        let earlier = generator.sample(last - CYCLE - PLACE * last);
        for i in 0..N {
            let (now, to) = (generator.state().axis(i), target.axis(i));
            let start = [0.0, now.velocity, now.acceleration];
            let stop = stop_point(start, generator.limits().axis(i));
            // An axis whose stop ends at its target waits there: no other axis stays short of its
            // target.
            let waits = (to.position - now.position - stop).abs() <= PLACE * self.axes[i].size;
            if last > CYCLE && !waits && earlier.axis(i) == to {
                self.fail(
                    report,
                    format!(
                        "axis {i} arrives more than a cycle before the last, {now:?} to {to:?}, stop {stop}, {:?}",
                        generator.limits().axis(i)
                    ),
                );
            }
        }
    }

    /// Checks the step from one state to the next, `dt` seconds later.
    pub(crate) fn step(
        &mut self,
        limits: &Limits<N>,
        before: &State<N>,
        after: &State<N>,
        dt: f64,
        report: &mut SoakReport,
    ) {
        report.cycles += 1;
        for i in 0..N {
            let (l, p, q) = (limits.axis(i), before.axis(i), after.axis(i));
            let Axis { still, ahead, size } = self.axes[i];
            let rounding = 4.0 * f64::EPSILON * l.acceleration.max(p.acceleration.abs()) / dt;
            let jerk = ((q.acceleration - p.acceleration).abs() / dt - rounding) / l.jerk - 1.0;
            report.jerk.see(jerk, self.seed);
            let mut excess = jerk;
            if self.inside {
                let velocity = q.velocity.abs() / l.velocity - 1.0;
                let acceleration = q.acceleration.abs() / l.acceleration - 1.0;
                report.velocity.see(velocity, self.seed);
                report.acceleration.see(acceleration, self.seed);
                excess = excess.max(velocity).max(acceleration);
            }
            if excess > EXACT || excess.is_nan() {
                self.fail(
                    report,
                    format!("axis {i} exceeds a limit by {excess:e}: {p:?} {q:?}"),
                );
            }
            // Trapezoids differ from the integrals by at most the bound of the next derivative.
            let bend = 0.25 * l.jerk * dt * dt * (1.0 + EXACT);
            let fastest = l.velocity.max(p.velocity.abs());
            let gap =
                (q.velocity - p.velocity - 0.5 * dt * (p.acceleration + q.acceleration)).abs();
            if gap > bend + 10.0 * PLACE * fastest {
                self.fail(
                    report,
                    format!("axis {i} jumps by {gap:e} in velocity: {p:?} {q:?}"),
                );
            }
            let highest = l
                .acceleration
                .max(p.acceleration.abs())
                .max(q.acceleration.abs());
            let bend = 0.25 * highest * dt * dt * (1.0 + EXACT);
            let gap = (q.position - p.position - 0.5 * dt * (p.velocity + q.velocity)).abs();
            if gap > bend + PLACE * size {
                self.fail(report, format!("axis {i} jumps by {gap:e}: {p:?} {q:?}"));
            }
            if let Some(position) = still
                && q != AxisState::at_rest(position)
            {
                self.fail(report, format!("axis {i} does not stay where it is: {q:?}"));
            }
            if let Some((target, side)) = ahead {
                let beyond = side * (q.position - target) / size;
                report.overshoot.see(beyond, self.seed);
                if beyond > PLACE {
                    self.fail(report, format!("axis {i} overshoots by {beyond:e}: {p:?} {q:?} target {target} side {side} {l:?}"));
                }
            }
        }
        self.inside |= can_stay(after, limits);
    }

    pub(crate) fn fail(&self, report: &mut SoakReport, what: String) {
        report.failures.push(format!(
            "seed {}, {N} axes, {:?}: {what}",
            self.seed, self.synchronisation
        ));
    }
}

/// True if an axis that stops does not reverse first. An axis that reverses may be at its target
/// before it can stop.
fn goes_on([_, v, a]: [f64; 3], limits: AxisLimits) -> bool {
    v * (v + 0.5 * a * a.abs() / limits.jerk) >= 0.0
}

/// True if the velocity limits can be kept from here on.
fn can_stay<const N: usize>(state: &State<N>, limits: &Limits<N>) -> bool {
    (0..N).all(|i| {
        let (l, s) = (limits.axis(i), state.axis(i));
        let coasting = s.velocity + 0.5 * s.acceleration * s.acceleration.abs() / l.jerk;
        s.velocity.abs() <= l.velocity
            && s.acceleration.abs() <= l.acceleration
            && coasting.abs() <= l.velocity
    })
}
