//! Warnings about accepted goals with risky options.

use franka_proto::RobotState;
use franka_rt::law::Gains;
use franka_rt::session::{ForceCap, GoalId, Margin};

use super::Bridge;

impl Bridge {
    /// Warns if an arm may oscillate under these gains.
    pub(super) fn warn_of_margin(&self, goal: GoalId, gains: Option<Gains>, state: &RobotState) {
        let margin = gains.and_then(|gains| self.lifecycle.margin(&gains, state));
        if let Some(Margin { damping, stiffness }) = margin.filter(|margin| !margin.is_wanted()) {
            tracing::warn!(
                goal = goal.0,
                damping,
                stiffness,
                wanted = Margin::WANTED,
                "the arm may oscillate with these gains: they leave less than the expected \
                 factors to instability, for damping and stiffness"
            );
        }
    }

    /// Warns if the collision threshold is below the force cap.
    pub(super) fn warn_of_thresholds(&self, goal: GoalId, force_cap: Option<ForceCap>) {
        if let Some((least, most)) = force_cap.and_then(|cap| self.thresholds.within(cap)) {
            tracing::warn!(
                goal = goal.0,
                threshold_newtons = least,
                push_newtons = most,
                "the collision threshold is below the force cap: a push triggers a reflex before \
                 the arm yields"
            );
        }
    }
}
