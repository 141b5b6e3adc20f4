//! The options that motions, streams and sessions have in common.

use franka_model::Model;
use franka_rt::lifecycle::Tuning;
use franka_rt::session::{Budget, Goal, GoalError, Reaction, Settling, Tolerance};
use franka_rt::team::Round;
use nalgebra::Isometry3;

/// Options of one or more goals. For an option that is `None`, the default for the kind of goal
/// applies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct GoalOptions {
    pub(crate) tuning: Tuning,
    pub(crate) speed: Option<f64>,
    pub(crate) stiffness: Option<[f64; 6]>,
    pub(crate) tolerance: Option<Tolerance>,
    pub(crate) settling: Option<Settling>,
    pub(crate) reaction: Option<Reaction>,
    /// The team motion that the goal is part of.
    pub(crate) round: Option<Round>,
    /// Pose of the object in the hand, in the frame of the end effector, if the goal is a pose of
    /// that object.
    pub(crate) grasp: Option<Isometry3<f64>>,
}

impl GoalOptions {
    /// Returns these options, completed by the tuning of the session.
    pub(crate) fn within(self, session: Option<Tuning>) -> Self {
        Self {
            tuning: self.tuning.or(session.unwrap_or_default()),
            ..self
        }
    }

    /// Returns the goal with these options, for a robot of this model.
    ///
    /// # Errors
    /// Returns [`GoalError::Speed`] if the speed is not accepted.
    pub(crate) fn apply(&self, goal: Goal, model: &Model) -> Result<Goal, GoalError> {
        let goal = self.tuning.apply(goal);
        let softened = |stiffness| goal.gains.with_cartesian_stiffness(stiffness);
        Ok(Goal {
            gains: self.stiffness.map_or(goal.gains, softened),
            budget: self.at_speed(goal.budget, model)?,
            tolerance: self.tolerance.or(goal.tolerance),
            settling: self.settling.unwrap_or(goal.settling),
            reaction: self.reaction.or(goal.reaction),
            round: self.round.or(goal.round),
            grasp: self.grasp.or(goal.grasp),
            ..goal
        })
    }

    /// Returns the tuning that a session keeps: the speed becomes part of its budget.
    ///
    /// # Errors
    /// Returns [`GoalError::Speed`] if the speed is not accepted.
    pub(crate) fn session_tuning(&self, model: &Model) -> Result<Tuning, GoalError> {
        let mut tuning = self.tuning;
        if self.speed.is_some() {
            let budget = tuning
                .budget
                .unwrap_or_else(|| Budget::of(model.joint_limits()));
            tuning.budget = Some(self.at_speed(budget, model)?);
        }
        Ok(tuning)
    }

    fn at_speed(&self, budget: Budget, model: &Model) -> Result<Budget, GoalError> {
        match self.speed {
            Some(factor) => budget.at_speed(factor, model),
            None => Ok(budget),
        }
    }
}

/// Defines setters for a type with the field `options: GoalOptions`. With `target`, it also defines
/// the setters of a type that has one target or one stream of targets.
macro_rules! goal_options {
    () => {
        /// Makes the arm follow the same paths `factor` times as fast as the limits allow.
        /// Velocities scale with `factor`, accelerations with its square, and jerks with its cube.
        /// A factor that is not positive, or that raises a limit above the robot's limit, is
        /// refused as [`GoalError::Speed`](crate::error::GoalError::Speed) when the motion begins.
        pub fn speed(mut self, factor: f64) -> Self {
            self.options.speed = Some(factor);
            self
        }

        /// Replaces the limits, which [`Self::speed`] then scales. By default, the limits of the
        /// session or of [`Budget::of`](crate::goal::Budget::of) apply.
        pub fn limits(mut self, budget: crate::goal::Budget) -> Self {
            self.options.tuning.budget = Some(budget);
            self
        }

        /// Replaces the control law and all gains. By default, the gains of the session apply, or
        /// [`Gains::cartesian`](crate::goal::Gains::cartesian) for poses and
        /// [`Gains::joint`](crate::goal::Gains::joint) for joint positions. For a stream, the kind
        /// of the first target selects the default. [`Gains::law`](crate::goal::Gains::law) selects
        /// the law. Under [`Law::OperationalSpace`](crate::goal::Law::OperationalSpace), springs at
        /// the end effector move the arm, so gains without such springs are refused.
        pub fn gains(mut self, gains: crate::goal::Gains) -> Self {
            self.options.tuning.gains = Some(gains);
            self
        }

        /// Limits the force of the springs and dampers at the end effector, `[N]`, to a value
        /// between 5 and 200. The default is the cap of the session, or
        /// [`ForceCap::DEFAULT_NEWTONS`](crate::goal::ForceCap::DEFAULT_NEWTONS). The springs also
        /// carry the weight of an undeclared load: if it exceeds the cap, the arm sinks and the
        /// motion does not arrive.
        /// [`Backend::RobotController`](crate::goal::Backend::RobotController) cannot limit the
        /// force, so it refuses this option.
        pub fn force_cap(mut self, newtons: f64) -> Self {
            self.options.tuning.force_cap = Some(crate::goal::ForceCap::Newtons(newtons));
            self
        }

        /// Removes the force cap, unless [`Self::force_cap`] is called before or after this. The
        /// largest deflection of the springs still limits their force.
        pub fn without_force_cap(mut self) -> Self {
            let cap = &mut self.options.tuning.force_cap;
            *cap = cap.or(Some(crate::goal::ForceCap::Off));
            self
        }

        /// Sets how far the reference (the commanded motion) may be ahead of the arm, between
        /// [`Leash::LEAST`](crate::goal::Leash::LEAST) and
        /// [`Leash::MOST`](crate::goal::Leash::MOST). The defaults are 25 mm and 0.15 rad for the
        /// end effector, and 0.1 rad for each joint. If the arm is blocked, its springs are
        /// stretched by this distance at most. This option has no effect under
        /// [`Backend::RobotController`](crate::goal::Backend::RobotController).
        pub fn leash(mut self, leash: crate::goal::Leash) -> Self {
            self.options.tuning.leash = Some(leash);
            self
        }

        /// Sets how far the arm may be pushed off its path. If the arm is pushed further, the
        /// motion is given up as [`Lapse::Displaced`](crate::error::Lapse::Displaced). The defaults
        /// are 30 cm and 0.5 rad for the hand, and 1 rad for a joint. This option has no effect
        /// under [`Backend::RobotController`](crate::goal::Backend::RobotController).
        pub fn deviation(mut self, deviation: crate::goal::Deviation) -> Self {
            self.options.tuning.deviation = Some(deviation);
            self
        }

        /// Sets the posture that the arm approaches while it moves to poses and holds them: joint
        /// positions, `[rad]`. The posture acts in the null space, so it does not change the pose
        /// of the end effector. The elbow uses at most half of the limits in the joints'
        /// [`Budget`](crate::goal::Budget). An awaited motion arrives only when the elbow rests,
        /// too. By default, the elbow stays near its position at the start of the motion or
        /// session. An engaged arm keeps its posture until a different one is set. Positions out of
        /// range are refused as [`GoalError::OutOfRange`](crate::error::GoalError::OutOfRange).
        pub fn posture(mut self, posture: impl Into<[f64; 7]>) -> Self {
            self.options.tuning.posture = Some(posture.into());
            self
        }
    };
    (target) => {
        goal_options!();

        /// Sets the stiffness at the end effector along and about the base axes: x, y, z in
        /// `[N/m]`, then rotations about them in `[N m/rad]`. It replaces the stiffness of the
        /// gains, regardless of the order of the calls. The damping ratios do not change.
        pub fn stiffness(mut self, stiffness: [f64; 6]) -> Self {
            self.options.stiffness = Some(stiffness);
            self
        }

        /// Sets how close to the target the arm must be to have arrived; for a stream, how close to
        /// its last target. The default is the accuracy of the control law, or of the robot's
        /// controller, on an arm with friction: see [`Tolerance::of`](crate::goal::Tolerance::of)
        /// and [`Tolerance::under`](crate::goal::Tolerance::under).
        pub fn tolerance(mut self, tolerance: crate::goal::Tolerance) -> Self {
            self.options.tolerance = Some(tolerance);
            self
        }

        /// Sets how long the arm must rest at the target before it counts as arrived, and the time
        /// limit for this wait. The defaults are 250 ms and 5 s.
        pub fn settling(mut self, settling: crate::goal::Settling) -> Self {
            self.options.settling = Some(settling);
            self
        }

        /// Ends the motion early if a condition becomes true before the arrival. The arm then stops
        /// as quickly as the jerk limit allows. If a [`Reaction`](crate::condition::Reaction) has a
        /// different target, the arm brakes and then moves to that target. The control thread
        /// checks the condition in every cycle until the motion has ended, and acts in the next
        /// cycle. This replaces an earlier condition.
        ///
        /// Both an arrival and a reaction resolve as `Ok`:
        /// [`MotionReport::reacted`](crate::MotionReport::reacted) distinguishes them. See
        /// [`condition`](crate::condition) for the quantities that can be compared.
        ///
        /// ```no_run
        /// # use std::time::Duration;
        /// # use franka_async::{MotionError, Pose, Robot};
        /// use franka_async::condition::{elapsed, force_z};
        ///
        /// # async fn run(robot: Robot) -> Result<(), MotionError> {
        /// let down = Pose::translation(0.0, 0.0, -0.2) * robot.pose();
        /// let touched = force_z(10.0) & elapsed(Duration::from_millis(200));
        /// let report = robot.move_to(down).speed(0.3).until(touched).await?;
        /// match report.reacted {
        ///     Some(contact) => println!("contact at {:.3} m", contact.pose.translation.z),
        ///     None => println!("nothing there"),
        /// }
        /// # Ok(())
        /// # }
        /// ```
        pub fn until(mut self, reaction: impl Into<crate::condition::Reaction>) -> Self {
            self.options.reaction = Some(reaction.into());
            self
        }
    };
}

pub(crate) use goal_options;

#[cfg(test)]
mod tests {
    use franka_rt::law::Gains;
    use franka_rt::session::{ForceCap, GoalId, OnArrival, Target};

    use super::*;

    #[test]
    fn the_kind_of_a_target_decides_what_is_not_set() {
        let model = Model::fr3();
        let limits = model.joint_limits();
        let joints = Target::Joints(franka_model::READY.into());
        let plain = Goal::new(GoalId(7), joints, OnArrival::Hold, limits);
        assert_eq!(GoalOptions::default().apply(plain, model), Ok(plain));
        let mut options = GoalOptions {
            tuning: Tuning {
                gains: Some(Gains::droid()),
                force_cap: Some(ForceCap::Newtons(0.5 * ForceCap::DEFAULT_NEWTONS)),
                ..Tuning::default()
            },
            ..GoalOptions::default()
        };
        let tuned = options.apply(plain, model).unwrap();
        assert_eq!(tuned.gains, Gains::droid());
        assert_eq!(
            tuned.force_cap,
            ForceCap::Newtons(0.5 * ForceCap::DEFAULT_NEWTONS)
        );
        assert_eq!(tuned.budget, plain.budget);
        let stiffness = [200.0, 200.0, 200.0, 10.0, 10.0, 10.0];
        options.stiffness = Some(stiffness);
        let soft = options.apply(plain, model).unwrap().gains;
        assert_eq!(soft, Gains::droid().with_cartesian_stiffness(stiffness));
    }

    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    struct Built {
        options: GoalOptions,
    }

    #[expect(unreachable_pub, reason = "as in the types for users")]
    impl Built {
        goal_options!(target);
    }

    fn both(first: fn(Built) -> Built, second: fn(Built) -> Built) -> GoalOptions {
        let built = second(first(Built::default()));
        assert_eq!(built, first(second(Built::default())));
        built.options
    }

    const SOFT: [f64; 6] = [200.0, 200.0, 200.0, 10.0, 10.0, 10.0];

    #[test]
    fn order_of_setters_changes_nothing() {
        let setters: [fn(Built) -> Built; 12] = [
            |it| it.speed(0.4),
            |it| it.limits(Budget::of(Model::fr3().joint_limits()).scaled(0.5)),
            |it| it.gains(Gains::droid()),
            |it| it.stiffness(SOFT),
            |it| it.force_cap(20.0),
            Built::without_force_cap,
            |it| it.leash(crate::goal::Leash::LEAST),
            |it| it.deviation(crate::goal::Deviation::default()),
            |it| it.posture(franka_model::READY),
            |it| it.tolerance(Tolerance::MOST),
            |it| it.settling(Settling::default()),
            |it| it.until(crate::condition::contact()),
        ];
        for (i, first) in setters.iter().enumerate() {
            for second in &setters[i + 1..] {
                both(*first, *second);
            }
        }
    }

    #[test]
    fn stiffness_counts_over_gains() {
        let model = Model::fr3();
        let joints = Target::Joints(franka_model::READY.into());
        let plain = Goal::new(GoalId(7), joints, OnArrival::Hold, model.joint_limits());
        let options = both(|it| it.stiffness(SOFT), |it| it.gains(Gains::droid()));
        let gains = options.apply(plain, model).unwrap().gains;
        assert_eq!(gains, Gains::droid().with_cartesian_stiffness(SOFT));
    }

    #[test]
    fn force_cap_counts_over_its_removal() {
        let options = both(|it| it.force_cap(20.0), Built::without_force_cap);
        assert_eq!(options.tuning.force_cap, Some(ForceCap::Newtons(20.0)));
        let off = Built::default().without_force_cap().options;
        assert_eq!(off.tuning.force_cap, Some(ForceCap::Off));
    }

    #[test]
    fn speed_scales_the_limits_whichever_was_set_first() {
        let model = Model::fr3();
        let limits = model.joint_limits();
        let budget = Budget::of(limits).scaled(0.5);
        let options = GoalOptions {
            speed: Some(0.4),
            tuning: Tuning {
                budget: Some(budget),
                ..Tuning::default()
            },
            ..GoalOptions::default()
        };
        let goal = Goal::new(GoalId(7), Target::Rest, OnArrival::Hold, limits);
        let goal = options.apply(goal, model).unwrap();
        assert_eq!(goal.budget, budget.scaled(0.4));
        let kept = options.session_tuning(model).unwrap();
        assert_eq!(kept.budget, Some(budget.scaled(0.4)));
    }
}
