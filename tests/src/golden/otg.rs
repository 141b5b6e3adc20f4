//! The trajectory generator against time-optimal motions made with Ruckig 0.19.4.
//!
//! Optimal motions of one axis are unique, so they are compared completely. Motions of several axes
//! are not unique: for axes that wait for the slowest one, only the common duration is. The test
//! checks the constraints of these axes instead.

use anyhow::bail;
use franka_otg::{Generator, Limits, PlanError, State, Synchronisation};
use serde::Deserialize;

use super::{Case, Report};

/// Tolerance of durations, relative. The files hold the durations on which independent solutions
/// agree to 4e-8 at worst, near stop points and in their own arithmetic. The two generators agree
/// to 1e-11.
const DURATION: f64 = 1e-9;
/// Tolerance of samples, relative to the distance of the motion and to the limits.
const SAMPLE: f64 = 1e-8;
/// Tolerance of limits, relative.
const EXCESS: f64 = 1e-9;
/// Samples of a motion whose limits are checked.
const SAMPLES: u32 = 200;
/// Instants of the samples in the file, as parts of the duration.
const INSTANTS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];

#[derive(Deserialize)]
struct File<T> {
    cases: Vec<T>,
}

/// A motion of one axis.
#[derive(Deserialize)]
struct SingleAxis {
    kind: String,
    p0: f64,
    v0: f64,
    a0: f64,
    target: f64,
    /// Zero if the file has none.
    #[serde(default)]
    target_velocity: f64,
    vmax: f64,
    amax: f64,
    jmax: f64,
    duration: f64,
    /// Position, velocity and acceleration at [`INSTANTS`].
    samples: [[f64; 3]; INSTANTS.len()],
    /// Durations that are impossible, from and to.
    #[serde(default)]
    blocked: Vec<[f64; 2]>,
}

/// A motion of several axes.
#[derive(Deserialize)]
struct MultiAxis {
    p0: Vec<f64>,
    v0: Vec<f64>,
    a0: Vec<f64>,
    target: Vec<f64>,
    vmax: Vec<f64>,
    amax: Vec<f64>,
    jmax: Vec<f64>,
    axis_duration: Vec<f64>,
    duration: f64,
}

/// Checks `otg/single_axis.json`. Starts outside the limits are included: both generators brake by
/// the same rule.
pub(super) fn single_axis(text: &[u8]) -> anyhow::Result<Report> {
    let mut report = Report::default();
    let file: File<SingleAxis> = serde_json::from_slice(text)?;
    for (index, vector) in file.cases.iter().enumerate() {
        let problem = Problem::of_one_axis(vector);
        let duration = vector.duration;
        report.case(vector.name(index), |case| match problem.plan() {
            Ok(plan) => {
                problem.check_duration(case, &plan, duration);
                problem.check_samples(case, &plan, duration, &vector.samples);
                problem.check_end(case, &plan);
            }
            Err(error) => case.fail(error.to_string()),
        });
    }
    Ok(report)
}

/// Checks `otg/single_axis_target_velocity.json`: the least motion, its mirror image in time, and
/// the durations that are blocked.
///
/// The mirror image in time ends with the acceleration at the start of the case. It checks targets
/// that accelerate, which the file does not contain.
pub(super) fn target_velocity(text: &[u8]) -> anyhow::Result<Report> {
    let mut report = Report::default();
    let file: File<SingleAxis> = serde_json::from_slice(text)?;
    for (index, vector) in file.cases.iter().enumerate() {
        let problem = Problem::of_one_axis(vector);
        let duration = vector.duration;
        report.case(vector.name(index), |case| {
            match problem.plan() {
                Ok(plan) => {
                    problem.check_duration(case, &plan, duration);
                    problem.check_samples(case, &plan, duration, &vector.samples);
                    problem.check_end(case, &plan);
                    problem.check_limits(case, &plan);
                }
                Err(error) => case.fail(error.to_string()),
            }
            let mirrored = problem.mirrored_in_time();
            match mirrored.plan() {
                // A start that can be left inside the limits cannot always be reached inside them.
                Err(PlanError::TargetMotion { .. }) if !problem.starts_reachably() => {}
                Ok(plan) => {
                    mirrored.check_duration(case, &plan, duration);
                    mirrored.check_end(case, &plan);
                    mirrored.check_limits(case, &plan);
                }
                Err(error) => case.fail(format!("mirrored in time: {error}")),
            }
            if let Err(error) = problem.check_blocked(case, duration, &vector.blocked) {
                case.fail(error.to_string());
            }
        });
    }
    Ok(report)
}

impl SingleAxis {
    fn name(&self, index: usize) -> String {
        format!("cases[{index}] ({})", self.kind)
    }
}

/// Checks `otg/multi_axis.json`.
pub(super) fn multi_axis(text: &[u8]) -> anyhow::Result<Report> {
    let mut report = Report::default();
    let file: File<MultiAxis> = serde_json::from_slice(text)?;
    for (index, vector) in file.cases.iter().enumerate() {
        let name = format!("cases[{index}] ({} axes)", vector.p0.len());
        match vector.p0.len() {
            3 => synchronised::<3>(&mut report, &name, vector)?,
            7 => synchronised::<7>(&mut report, &name, vector)?,
            _ => bail!("{name}: expected 3 or 7"),
        }
    }
    Ok(report)
}

fn synchronised<const N: usize>(
    report: &mut Report,
    name: &str,
    vector: &MultiAxis,
) -> anyhow::Result<()> {
    let numbers = |list: &Vec<f64>| <[f64; N]>::try_from(list.as_slice());
    let problem = Problem {
        start: State {
            position: numbers(&vector.p0)?,
            velocity: numbers(&vector.v0)?,
            acceleration: numbers(&vector.a0)?,
        },
        target: State::at_rest(numbers(&vector.target)?),
        velocity: numbers(&vector.vmax)?,
        acceleration: numbers(&vector.amax)?,
        jerk: numbers(&vector.jmax)?,
    };
    let axis_durations = numbers(&vector.axis_duration)?;
    report.case(name, |case| {
        for (axis, &duration) in axis_durations.iter().enumerate() {
            let alone = problem.axis(axis);
            match alone.plan() {
                Ok(plan) => alone.check_duration(case, &plan, duration),
                Err(error) => case.fail(format!("axis {axis}: {error}")),
            }
        }
        match problem.plan() {
            Ok(plan) => {
                problem.check_duration(case, &plan, vector.duration);
                problem.check_limits(case, &plan);
                problem.check_end(case, &plan);
            }
            Err(error) => case.fail(error.to_string()),
        }
    });
    Ok(())
}

struct Problem<const N: usize> {
    start: State<N>,
    target: State<N>,
    velocity: [f64; N],
    acceleration: [f64; N],
    jerk: [f64; N],
}

impl<const N: usize> Problem<N> {
    fn plan(&self) -> Result<Generator<N>, PlanError> {
        let limits = Limits::from_arrays(self.velocity, self.acceleration, self.jerk)?;
        let generator = Generator::new(self.start, limits)?;
        let mut generator = generator.with_synchronisation(Synchronisation::Time);
        generator.set_moving_target(&self.target)?;
        Ok(generator)
    }

    /// One axis of the motion alone.
    fn axis(&self, axis: usize) -> Problem<1> {
        let alone = |state: &State<N>| State {
            position: [state.position[axis]],
            velocity: [state.velocity[axis]],
            acceleration: [state.acceleration[axis]],
        };
        Problem {
            start: alone(&self.start),
            target: alone(&self.target),
            velocity: [self.velocity[axis]],
            acceleration: [self.acceleration[axis]],
            jerk: [self.jerk[axis]],
        }
    }

    fn check_duration(&self, case: &mut Case<'_>, plan: &Generator<N>, duration: f64) {
        let tolerance = DURATION * duration;
        let got = plan.time_to_target();
        case.near("duration", &[got], &[duration], tolerance);
    }

    /// The motion leads to the target. A millionth of the duration earlier, its distance is the
    /// distance that the target's motion and the jerk cause in that time, except for the rounding
    /// of positions. A motion that ends at rest ends exactly at the target.
    fn check_end(&self, case: &mut Case<'_>, plan: &Generator<N>) {
        let duration = plan.time_to_target();
        if self.target.is_at_rest() {
            case.equal("end", plan.sample(duration), self.target);
        }
        let left = 1e-6 * duration;
        let before = plan.sample(duration - left);
        for i in 0..N {
            let (from, to) = (self.start.position[i], self.target.axis(i));
            let size = from.abs() + to.position.abs() + self.velocity[i] * duration;
            let expected = to.position - left * (to.velocity - 0.5 * left * to.acceleration);
            let reach = self.jerk[i] * left.powi(3) / 6.0 + 4.0 * f64::EPSILON * size;
            let lands = (before.position[i] - expected).abs() <= reach;
            case.equal("motion leads to its end", lands, true);
        }
    }

    /// The largest velocity and acceleration that a motion from the start must reach at least. They
    /// are the limits, or more if the start is outside them or cannot stay inside.
    fn unavoidable(&self, axis: usize) -> [f64; 2] {
        let (start, jerk) = (self.start.axis(axis), self.jerk[axis]);
        let rise = 0.5 * start.acceleration * start.acceleration.abs() / jerk;
        // The velocity that is left when the acceleration is ramped to zero under the jerk limit.
        let peak = start.velocity.abs().max((start.velocity + rise).abs());
        [
            self.velocity[axis].max(peak),
            self.acceleration[axis].max(start.acceleration.abs()),
        ]
    }

    fn check_limits(&self, case: &mut Case<'_>, plan: &Generator<N>) {
        // To rest, which for a target in motion is behind it.
        let dt = plan.duration() / f64::from(SAMPLES);
        let mut before = self.start;
        let mut excess = [0.0_f64; 3];
        for k in 1..=SAMPLES {
            let now = plan.sample(dt * f64::from(k));
            for i in 0..N {
                let jerk = (now.acceleration[i] - before.acceleration[i]) / dt;
                // The last bit of an acceleration at its limit, expressed as a jerk.
                let rounding = 4.0 * f64::EPSILON * self.acceleration[i] / dt;
                let [velocity, acceleration] = self.unavoidable(i);
                let parts = [
                    now.velocity[i].abs() / velocity,
                    now.acceleration[i].abs() / acceleration,
                    (jerk.abs() - rounding) / self.jerk[i],
                ];
                for (excess, part) in excess.iter_mut().zip(parts) {
                    *excess = excess.max(part - 1.0);
                }
            }
            before = now;
        }
        case.near("excess over limits", &excess, &[0.0; 3], EXCESS);
    }
}

impl Problem<1> {
    fn of_one_axis(vector: &SingleAxis) -> Self {
        Self {
            start: State {
                position: [vector.p0],
                velocity: [vector.v0],
                acceleration: [vector.a0],
            },
            target: State {
                position: [vector.target],
                velocity: [vector.target_velocity],
                acceleration: [0.0],
            },
            velocity: [vector.vmax],
            acceleration: [vector.amax],
            jerk: [vector.jmax],
        }
    }

    /// The same motion backwards: positions and accelerations stay, velocities change their sign.
    fn mirrored_in_time(&self) -> Self {
        let backwards = |state: &State<1>| State {
            velocity: [-state.velocity[0]],
            ..*state
        };
        Self {
            start: backwards(&self.target),
            target: backwards(&self.start),
            ..*self
        }
    }

    /// True if a motion inside the limits can lead through the start.
    fn starts_reachably(&self) -> bool {
        let (velocity, acceleration) = (self.start.velocity[0], self.start.acceleration[0]);
        velocity.abs() + 0.5 * acceleration * acceleration / self.jerk[0] <= self.velocity[0]
    }

    /// Checks the possible durations with a second axis that takes a chosen duration from rest to
    /// rest: both arrive as soon after that duration as the first axis can.
    fn check_blocked(
        &self,
        case: &mut Case<'_>,
        least: f64,
        blocked: &[[f64; 2]],
    ) -> Result<(), PlanError> {
        let mut expected = vec![(0.5 * least, least), (1.5 * least, 1.5 * least)];
        for &[from, to] in blocked {
            expected.retain(|&(asked, _)| asked < from || asked > to);
            let before = from - 1e-6 * (from - least);
            let behind = to + 1e-6 * (to - from);
            expected.extend([(before, before), (behind, behind)]);
            for part in [1e-4, 0.5, 1.0 - 1e-6] {
                expected.push((from + part * (to - from), to));
            }
        }
        for (asked, expected) in expected {
            let both = self.beside_one_that_takes(asked);
            let plan = both.plan()?;
            let got = plan.time_to_target();
            case.near("synchronised", &[got], &[expected], DURATION * expected);
            both.check_end(case, &plan);
            both.check_limits(case, &plan);
        }
        Ok(())
    }

    fn beside_one_that_takes(&self, duration: f64) -> Problem<2> {
        // Four ramps of the jerk that neither velocity nor acceleration limit: distance 2 ramp^3.
        let ramp = 0.25 * duration;
        let beside = |one: &State<1>, position| State {
            position: [one.position[0], position],
            velocity: [one.velocity[0], 0.0],
            acceleration: [one.acceleration[0], 0.0],
        };
        Problem {
            start: beside(&self.start, 0.0),
            target: beside(&self.target, 2.0 * ramp * ramp * ramp),
            velocity: [self.velocity[0], 2.0 * ramp * ramp],
            acceleration: [self.acceleration[0], 2.0 * ramp],
            jerk: [self.jerk[0], 1.0],
        }
    }

    fn check_samples(
        &self,
        case: &mut Case<'_>,
        plan: &Generator<1>,
        duration: f64,
        samples: &[[f64; 3]],
    ) {
        let start = self.start.position[0];
        let positions = samples.iter().map(|sample| sample[0]);
        let distance = positions
            .chain(self.target.position)
            .fold(0.0_f64, |farthest, p| farthest.max((p - start).abs()));
        // The last bits of a position may be more than the distance moved.
        let rounding = 4.0 * f64::EPSILON * start.abs().max(self.target.position[0].abs());
        for (instant, [p, v, a]) in INSTANTS.iter().zip(samples) {
            let got = plan.sample(instant * duration);
            let tolerance = SAMPLE * distance + rounding;
            case.near("position", &got.position, &[*p], tolerance);
            case.near("velocity", &got.velocity, &[*v], SAMPLE * self.velocity[0]);
            let tolerance = SAMPLE * self.acceleration[0];
            case.near("acceleration", &got.acceleration, &[*a], tolerance);
        }
    }
}
