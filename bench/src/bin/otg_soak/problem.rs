//! Random limits, states and targets.

// By path, because the generator's tests are not part of its library.
#[path = "../../../../franka-otg/src/tests/allowed.rs"]
mod allowed;

use franka_otg::{AxisLimits, AxisState, Limits, State};
use rand::Rng;
use rand::rngs::SmallRng;

pub(crate) use allowed::beside_one_that_takes;
use allowed::{inside, target_motion, way_to_speed};

use crate::oracle::stop_point;

/// The kind of an episode's limits.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    /// Limits similar to the limits of an arm's joints and tools, down to a tenth of full speed.
    Arm,
    /// Mixed limits: each may or may not reach the others.
    Mixed,
    /// Limits up to nine decades apart.
    Extreme,
}

impl Kind {
    pub(crate) fn random(random: &mut SmallRng) -> Self {
        match random.random_range(0..10) {
            0..5 => Self::Arm,
            5..9 => Self::Mixed,
            _ => Self::Extreme,
        }
    }

    pub(crate) fn limits<const N: usize>(self, random: &mut SmallRng) -> Limits<N> {
        let limits = std::array::from_fn(|_| {
            let [velocity, acceleration, jerk] = match self {
                Self::Arm => [(-1.0, 0.7), (0.0, 1.3), (2.0, 4.0)],
                Self::Mixed => [(-1.0, 1.0), (-1.0, 1.5), (0.0, 4.0)],
                Self::Extreme => [(-3.0, 6.0); 3],
            }
            .map(|(low, high)| 10_f64.powf(random.random_range(low..high)));
            AxisLimits {
                velocity,
                acceleration,
                jerk,
            }
        });
        Limits::per_axis(limits).expect("powers of ten are positive and finite")
    }
}

/// Returns a state inside the limits that can stay there; at rest in half of the cases.
pub(crate) fn state<const N: usize>(random: &mut SmallRng, limits: &Limits<N>) -> State<N> {
    let mut state = State::at_rest(std::array::from_fn(|_| random.random_range(-1.0..1.0)));
    if random.random_bool(0.5) {
        for i in 0..N {
            let (velocity, acceleration) = motion(random, limits.axis(i));
            state.velocity[i] = velocity;
            state.acceleration[i] = acceleration;
        }
    }
    state
}

/// Returns a state that can stay inside the limits, although motions inside them may not lead to
/// it.
pub(crate) fn departure<const N: usize>(random: &mut SmallRng, limits: &Limits<N>) -> State<N> {
    let mut state = State::at_rest(std::array::from_fn(|_| random.random_range(-1.0..1.0)));
    for i in 0..N {
        let (bend, coasting) = (part(random), part(random));
        let axis = inside(limits.axis(i), state.position[i], coasting, bend);
        state.velocity[i] = axis.velocity;
        state.acceleration[i] = axis.acceleration;
    }
    state
}

/// Returns a share of a limit, including zero and all of it.
fn part(random: &mut SmallRng) -> f64 {
    match random.random_range(0..6) {
        0 => 1.0,
        1 => 0.0,
        _ => random.random_range(-1.0..1.0),
    }
}

/// Returns velocity and acceleration that can be met, and left, inside the limits.
fn motion(random: &mut SmallRng, limits: AxisLimits) -> (f64, f64) {
    let speed = random.random_range(-1.0..=1.0);
    let bend = match random.random_bool(0.5) {
        true => 0.0,
        false => random.random_range(-1.0..=1.0),
    };
    target_motion(limits, speed, bend)
}

/// Returns a new target, as far away as the axes can move in some tenths of a second to some
/// seconds, or very close.
///
/// Axes at rest sometimes keep their place; `moving` targets move along some axes.
pub(crate) fn target<const N: usize>(
    random: &mut SmallRng,
    now: &State<N>,
    limits: &Limits<N>,
    moving: bool,
) -> State<N> {
    let far = random.random_range(-1.5..0.3);
    let mut target = State::at_rest(now.position);
    for i in 0..N {
        let axis = limits.axis(i);
        let at_rest = now.velocity[i] == 0.0 && now.acceleration[i] == 0.0;
        if at_rest && random.random_bool(0.2) {
            continue;
        }
        let decades = if random.random_bool(0.1) {
            random.random_range(-12.0..far)
        } else {
            far
        };
        // The distance that the axis can move in this time, limited by the precision of positions.
        let t = 10_f64.powf(far);
        let reach = (axis.velocity * t)
            .min(axis.acceleration * t * t)
            .min(axis.jerk * t * t * t);
        let way = reach.min(1e3) * 10_f64.powf(decades - far);
        target.position[i] += way * random.random_range(-1.0..1.0);
        if moving && random.random_bool(0.7) {
            let (velocity, acceleration) = motion(random, axis);
            target.velocity[i] = velocity;
            target.acceleration[i] = acceleration;
        }
    }
    target
}

/// Returns a target for single plans: from far away to within a millionth of the stop point; at
/// rest, at its velocity limit, hardly moving, or anything in between.
pub(crate) fn arrival<const N: usize>(
    random: &mut SmallRng,
    now: &State<N>,
    limits: &Limits<N>,
) -> State<N> {
    let mut target = *now;
    for i in 0..N {
        let axis = limits.axis(i);
        let exponent = match random.random_range(0..5) {
            0..3 => random.random_range(-1.0..1.5),
            _ => random.random_range(-6.0..-1.0),
        };
        let side = [-1.0, 1.0][random.random_range(0..2)];
        let way = side * way_to_speed(axis) * 10_f64.powf(exponent);
        let stop = stop_point([0.0, now.velocity[i], now.acceleration[i]], axis);
        let speed = match random.random_range(0..9) {
            0 => 0.0,
            1 => random.random_range(-1e-9..1e-9),
            2 => 1.0,
            _ => random.random_range(-1.0..1.0),
        };
        let bend = match random.random_range(0..3) {
            0 => random.random_range(-1.0..1.0_f64),
            _ => 0.0,
        };
        target.position[i] += stop + way;
        (target.velocity[i], target.acceleration[i]) = target_motion(axis, speed, bend);
    }
    target
}
