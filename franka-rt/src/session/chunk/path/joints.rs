//! Paths over joint positions.

use franka_model::JointVector;
use franka_model::limits::JointLimits;
use franka_otg::AxisLimits;

use super::Waypoint;
use super::fastest::{Limits, Timed};
use super::legs::{limits_of_leg, share, timed};
use super::timing::{Leg, corner_time};
use crate::session::chunk::pace::Pace;
use crate::session::reference::Reference;
use crate::session::{Budget, Target};

/// Plans straight lines in joint space, beginning at `start`.
pub(super) fn through_joints(
    waypoints: &[Waypoint],
    start: JointVector,
    budget: &Budget,
    robot: &JointLimits,
) -> Timed<Reference> {
    let limits: [AxisLimits; 7] = core::array::from_fn(|i| {
        let AxisLimits {
            velocity,
            acceleration,
            jerk,
        } = budget.joints[i];
        share(AxisLimits {
            velocity: velocity.min(robot.velocity[i]),
            acceleration: acceleration.min(robot.acceleration[i]),
            jerk: jerk.min(robot.jerk[i]),
        })
    });
    let mut places = vec![(start, 0.0)];
    for waypoint in waypoints {
        if let Target::Joints(q) = waypoint.target {
            places.push((JointVector::from(q), waypoint.blend));
        }
    }
    places.dedup_by(|next, last| {
        let same = next.0 == last.0;
        last.1 = if same { next.1 } else { last.1 };
        same
    });
    let each = |way: &JointVector| -> [(f64, AxisLimits); 7] {
        core::array::from_fn(|i| (way[i].abs(), limits[i]))
    };
    let legs: Vec<Leg<7>> = places
        .windows(2)
        .map(|ends| {
            let way = ends[1].0 - ends[0].0;
            let limits = limits_of_leg(each(&way).into_iter());
            Leg { way, limits }
        })
        .collect();
    let duration = |way: &JointVector| {
        let times = each(way).map(|(way, limits)| corner_time(way, &limits));
        times.into_iter().fold(0.0, f64::max)
    };
    let blends: Vec<f64> = places.iter().map(|(_, blend)| *blend).collect();
    let lengths: Vec<f64> = legs.iter().map(|leg| leg.way.norm()).collect();
    let knots = timed(&legs, &lengths, &blends, duration);
    let states = knots.iter().map(|knot| {
        let Some(Leg { way, .. }) = legs.get(knot.leg) else {
            return Reference::at_rest(start);
        };
        Reference {
            q: places[knot.leg].0 + way * knot.s,
            dq: way * knot.v,
            ddq: way * knot.a,
        }
    });
    let timed = Timed {
        times: knots.iter().map(|knot| knot.time).collect(),
        states: states.collect(),
        legs: knots.iter().map(|knot| knot.leg).collect(),
    };
    timed.hurried(&within(limits))
}

/// Returns the pace at which the time of a path through these states may stop.
pub(super) fn pace(states: &[Reference], budget: &Budget) -> Pace {
    let fastest = |i: usize| {
        states
            .iter()
            .map(|state| state.dq[i].abs())
            .fold(0.0, f64::max)
    };
    Pace::of((0..7).map(|i| (fastest(i), budget.joints[i])))
}

/// Limits each joint separately.
pub(super) fn within(limits: [AxisLimits; 7]) -> Limits<Reference, 1, 7> {
    Limits {
        of_groups: limits,
        derivatives: |state| [state.dq, state.ddq].map(|of| of.transpose()),
    }
}
