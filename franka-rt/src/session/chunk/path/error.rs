//! Reasons for refusing waypoints.

use super::Waypoint;
use super::reach::{OFF_ROTATION, OFF_TRANSLATION};
use crate::session::GoalError;

/// Reason for refusing a path. Nothing has moved. Waypoints are numbered from 1.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PathError {
    /// There are no waypoints.
    #[error("the path has no waypoints, expected at least one")]
    Empty,
    /// There are more waypoints than a path may have.
    #[error(
        "the path has too many waypoints, expected {} at most: put the other waypoints into the \
         next path",
        Waypoint::COUNT_MAX
    )]
    TooMany,
    /// A waypoint is neither a pose nor joint positions, or differs in kind from the first
    /// waypoint.
    #[error(
        "waypoint {waypoint} is of another kind than the first waypoint, expected all poses or \
         all joint positions"
    )]
    Kind {
        /// Number of the waypoint.
        waypoint: usize,
    },
    /// The blend distance of a waypoint is NaN or negative.
    #[error("the blend of waypoint {waypoint} is {got}, expected 0 or more")]
    Blend {
        /// Number of the waypoint.
        waypoint: usize,
        /// The given distance.
        got: f64,
    },
    /// The arm cannot reach the waypoint.
    #[error("waypoint {waypoint}: {error}")]
    Waypoint {
        /// Number of the waypoint.
        waypoint: usize,
        /// Reason why the arm cannot reach the waypoint.
        #[source]
        error: GoalError,
    },
    /// On the way to a waypoint, the end effector rotates so far that the direction of the rotation
    /// is ambiguous.
    #[error(
        "the orientation turns by {degrees} degrees on the way to waypoint {waypoint}, expected \
         less than 170 degrees"
    )]
    Turn {
        /// Number of the waypoint.
        waypoint: usize,
        /// Angle of the rotation.
        degrees: u16,
    },
    /// The arm cannot follow the path between two waypoints.
    #[error(
        "between {} and waypoint {to}, the end effector leaves the path by {:.1} mm and {:.1} mrad \
         at ({x:.3}, {y:.3}, {z:.3}) m{}, expected {:.0} mm and {:.0} mrad at most: add a waypoint",
        begin_of(*from),
        translation * 1e3,
        rotation * 1e3,
        reason_of(*joint),
        OFF_TRANSLATION * 1e3,
        OFF_ROTATION * 1e3
    )]
    Way {
        /// Number of the previous waypoint. 0 is the place of the arm when the path begins.
        from: usize,
        /// Number of the next waypoint.
        to: usize,
        /// Coordinate x of the place where the arm leaves the path, in the base frame, `[m]`.
        x: f64,
        /// Coordinate y of that place.
        y: f64,
        /// Coordinate z of that place.
        z: f64,
        /// Distance of the arm from the path at that place, `[m]`.
        translation: f64,
        /// Angle between the end effector and the path's orientation at that place, `[rad]`.
        rotation: f64,
        /// Number of the joint at the end of its range, from 1; `None` if the arm cannot reach
        /// further.
        joint: Option<usize>,
    },
}

fn begin_of(waypoint: usize) -> String {
    match waypoint {
        0 => "the start".to_owned(),
        waypoint => format!("waypoint {waypoint}"),
    }
}

fn reason_of(joint: Option<usize>) -> String {
    joint.map_or(String::new(), |joint| {
        format!(" with joint {joint} at the end of its range")
    })
}
