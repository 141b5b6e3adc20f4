//! An object in the hand, carried by this arm alone or together with the arms of a team.

use franka_model::rotation;
use franka_otg::AxisLimits;
use nalgebra::Isometry3;

use super::{GoalStage, RunningSession};
use crate::session::course::Course;
use crate::session::reference::Reference;
use crate::session::{Budget, Goal, Target, Tolerance};
use crate::team::Carrying;

/// Distance of the arm from its reference above which the arm counts as lagging, `[m]`. Realistic
/// arms that nothing holds stay within half of it: 7.4 mm at most (measured as for [`NEAR`], at
/// full speed).
const LAG: f64 = 0.015;

/// Distance within which the arm no longer lags, `[m]`. Arms that hold one object and disagree
/// about its place stop within 5.0 mm of the reference if nothing else holds them.
const CAUGHT_UP: f64 = 0.012;

/// Joint velocity below which a reference may be stopped at once, `[rad/s]`. Stopping within one
/// cycle is then a deceleration of 0.1 rad/s^2.
const AT_REST: f64 = 1e-4;

/// Deceleration of a reference that halts for another arm, `[m/s^2]` and `[rad/s^2]`: a quarter of
/// the robot's limits.
const HALT: [f64; 2] = [2.5, 4.0];

/// Time to build up that deceleration, `[s]`.
const RAMP: f64 = 0.025;

/// Length that converts a rotation to a distance, `[m/rad]`.
const LEVER: f64 = 0.2;

/// Least tolerance of arms that hold one object. The arms' models of themselves differ, so the
/// object keeps them from reaching all targets at once. In 48 motions of 12 pairs of realistic arms
/// (`tests/lockstep/carrying`), the errors were at most 3.1 mm and 5.3 mrad. The force caps were 20
/// N.
const NEAR: Tolerance = Tolerance {
    translation: 5e-3,
    rotation: 10e-3,
};

impl RunningSession {
    /// Continues from the pose of the goal's object, or from the pose of the hand. The joint
    /// reference does not change, and the goal is planned from there.
    pub(super) fn take_hold(&mut self) {
        let grasp = self.goal.grasp;
        if grasp == self.grasp {
            return;
        }
        self.grasp = grasp;
        self.place_object();
        self.leave_pose_course();
        self.lags = false;
        // Arms at rest plan the same motion of the same object. If a small motion remained from
        // rounding, each arm's plan would get another direction and other limits.
        if self.reference.dq.amax() < AT_REST {
            self.reference = Reference::at_rest(self.reference.q);
        }
    }

    /// Halts the reference on its line, or resumes it.
    pub(super) fn wait_for_team(&mut self, waits: bool) {
        if waits != self.waits {
            self.waits = waits;
            self.route.outdate();
        }
    }

    /// Returns the tolerance for an arm that holds an object with other arms and stops outside its
    /// own tolerance.
    pub(super) fn tolerance_with_others(&self) -> Option<Tolerance> {
        let Goal {
            round, tolerance, ..
        } = self.goal;
        let with_others = self.grasp.is_some() && round.is_some() && tolerance.is_none();
        with_others.then_some(NEAR)
    }

    /// Returns the progress of the carried object. Returns `None` if the arm carries no object.
    pub(in crate::session) fn carrying(&mut self) -> Option<Carrying> {
        self.grasp?;
        let (Course::Pose(generator, _), Target::Pose(target)) =
            (&self.route.course, self.heading())
        else {
            self.lags = false;
            return Some(Carrying::default());
        };
        let pose = generator.pose();
        let most = if self.lags { CAUGHT_UP } else { LAG };
        let under_way = matches!(self.stage, GoalStage::UnderWay);
        self.lags = under_way && apart(&pose, &self.arm.object) > most;
        Some(Carrying {
            remaining: apart(&target, &pose),
            lags: self.lags,
        })
    }
}

/// Returns the budget of a reference that halts for another arm. The reference should get ahead of
/// the other arm as little as the joints allow without a jolt. From 0.3 m/s it stops after about 25
/// mm; with the default budget it would need about 90 mm.
pub(super) fn quick_to_halt(budget: Budget) -> Budget {
    let raised = |limits: AxisLimits, acceleration: f64| AxisLimits {
        acceleration: limits.acceleration.max(acceleration),
        jerk: limits.jerk.max(acceleration / RAMP),
        ..limits
    };
    Budget {
        translation: raised(budget.translation, HALT[0]),
        rotation: raised(budget.rotation, HALT[1]),
        ..budget
    }
}

/// Returns the distance between two poses, `[m]`.
fn apart(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    let way = a.translation.vector - b.translation.vector;
    way.norm() + LEVER * rotation::error(&a.rotation, &b.rotation).norm()
}
