//! Paths over poses.

use franka_model::{Twist, rotation};
use franka_otg::AxisLimits;
use nalgebra::{Isometry3, SMatrix, SVector, Translation3, Vector3};

use super::fastest::{Limits, Timed};
use super::legs::{limits_of_leg, share, timed};
use super::timing::{Leg, corner_time};
use super::{PathError, Waypoint};
use crate::session::chunk::curve_state::stacked;
use crate::session::chunk::pace::Pace;
use crate::session::chunk::value::TURN_MAX;
use crate::session::pose::PoseState;
use crate::session::{Budget, Target};

/// Plans straight lines with rotations about one axis, beginning at `start`. A waypoint at the same
/// place as the previous waypoint makes no leg.
pub(super) fn through_poses(
    waypoints: &[Waypoint],
    start: Isometry3<f64>,
    budget: &Budget,
) -> Result<Timed<PoseState>, PathError> {
    let (translation, turning) = (share(budget.translation), share(budget.rotation));
    let mut places = vec![(start, 0.0)];
    let mut legs: Vec<Leg<6>> = Vec::new();
    let each = |way: &Twist| {
        [
            (moved(way).norm(), translation),
            (turned(way).norm(), turning),
        ]
    };
    for (waypoint, place) in (1..).zip(waypoints) {
        let (from, Target::Pose(to)) = (places[places.len() - 1].0, place.target) else {
            continue;
        };
        let turn = rotation::error(&to.rotation, &from.rotation);
        if turn.norm() >= TURN_MAX {
            let degrees = turn.norm().to_degrees().round() as u16;
            return Err(PathError::Turn { waypoint, degrees });
        }
        let way = stacked(&(to.translation.vector - from.translation.vector), &turn);
        if way == Twist::zeros() {
            let last = places.len() - 1;
            places[last].1 = place.blend;
            continue;
        }
        let limits = limits_of_leg(each(&way).into_iter());
        legs.push(Leg { way, limits });
        places.push((to, place.blend));
    }
    let duration = |way: &SVector<f64, 6>| {
        let [t, r] = each(way).map(|(way, limits)| corner_time(way, &limits));
        t.max(r)
    };
    let blends: Vec<f64> = places.iter().map(|(_, blend)| *blend).collect();
    let per_turn = translation.velocity / turning.velocity;
    let length = |leg: &Leg<6>| {
        moved(&leg.way)
            .norm()
            .max(per_turn * turned(&leg.way).norm())
    };
    let lengths: Vec<f64> = legs.iter().map(length).collect();
    let knots = timed(&legs, &lengths, &blends, duration);
    let states = knots.iter().map(|knot| {
        let from = places[knot.leg].0;
        let way = legs.get(knot.leg).map_or(Twist::zeros(), |leg| leg.way);
        PoseState {
            pose: Isometry3::from_parts(
                Translation3::from(from.translation.vector + moved(&way) * knot.s),
                rotation::exp(&(turned(&way) * knot.s)) * from.rotation,
            ),
            twist: way * knot.v,
            acceleration: way * knot.a,
        }
    });
    let timed = Timed {
        times: knots.iter().map(|knot| knot.time).collect(),
        states: states.collect(),
        legs: knots.iter().map(|knot| knot.leg).collect(),
    };
    Ok(timed.hurried(&within([translation, turning])))
}

/// Limits the norms of translation and rotation.
pub(super) fn within(limits: [AxisLimits; 2]) -> Limits<PoseState, 3, 2> {
    Limits {
        of_groups: limits,
        derivatives: |state| {
            let twists = [state.twist, state.acceleration];
            twists.map(|of| SMatrix::<f64, 3, 2>::from_column_slice(of.as_slice()))
        },
    }
}

pub(super) fn pace(states: &[PoseState], budget: &Budget) -> Pace {
    let fastest = |part: fn(&Twist) -> Vector3<f64>| {
        let speeds = states.iter().map(|state| part(&state.twist).norm());
        speeds.fold(0.0, f64::max)
    };
    Pace::of(
        [
            (fastest(moved), budget.translation),
            (fastest(turned), budget.rotation),
        ]
        .into_iter(),
    )
}

fn moved(way: &Twist) -> Vector3<f64> {
    way.fixed_rows::<3>(0).into_owned()
}

fn turned(way: &Twist) -> Vector3<f64> {
    way.fixed_rows::<3>(3).into_owned()
}
