//! Which guards bound a command: a field of every record.

/// A guard that can hold a command back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(u8)]
#[non_exhaustive]
pub enum Guard {
    /// The reference ran ahead of the measured arm by the length of the leash and was held there.
    Leash,
    /// On the way to a pose a joint reached the bound of its acceleration or jerk.
    InverseKinematics,
    /// A spring and damper torque reached its clamp.
    TorqueClamp,
    /// Spring and damper would have pressed with more force than the goal allows, and what was
    /// beyond it was taken off.
    ForceCap,
    /// A joint came near the robot's velocity limit and was braked.
    VelocityBarrier,
    /// The torque changed faster than the robot accepts and was slowed.
    TorqueRate,
    /// The targets stopped coming; the arm comes to rest, or rests, for that reason.
    Watchdog,
    /// The deadman is silent; as above.
    Deadman,
    /// The limiter before the robot's own controller changed a setpoint.
    Backstop,
    /// On the way to a pose a joint reached the cap of its velocity.
    JointVelocity,
    /// On the way to a pose a joint came to the end of its range, or had to be able to stop before
    /// it.
    PositionEnvelope,
    /// The arm came near itself or a region to keep out of: the reference goes slowly, or brakes
    /// before it.
    Clearance,
    /// The arm was displaced from its path, and its goal given up for that.
    Deviation,
    /// The target was further ahead of the arm than it may be, and was drawn nearer.
    Lead,
    /// No plan could be made to the target (only by a defect); the previous course goes on.
    PlanFailure,
    /// The condition of the goal was true: the arm comes to rest or goes to the other target, or is
    /// there, for that reason.
    Reaction,
    /// A member of the team has a fault, or the team was stopped: the arm comes to rest, or rests,
    /// for that reason.
    Team,
    /// On the way to a pose a point of the arm came to the session's speed cap and the joints were
    /// slowed; or the arm was faster, and its goal given up for that.
    SpeedCap,
    /// The arm stood still under commands that should have moved it, without an error, and its goal
    /// was given up for that.
    Unresponsive,
}

/// A set of guards.
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Bindings(u32);

impl core::fmt::Debug for Bindings {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_set().entries(self.iter()).finish()
    }
}

impl Guard {
    /// All guards.
    pub const ALL: [Self; 19] = [
        Self::Leash,
        Self::InverseKinematics,
        Self::TorqueClamp,
        Self::ForceCap,
        Self::VelocityBarrier,
        Self::TorqueRate,
        Self::Watchdog,
        Self::Deadman,
        Self::Backstop,
        Self::JointVelocity,
        Self::PositionEnvelope,
        Self::Clearance,
        Self::Deviation,
        Self::Lead,
        Self::PlanFailure,
        Self::Reaction,
        Self::Team,
        Self::SpeedCap,
        Self::Unresponsive,
    ];
}

/// What people call it, such as `joint range`.
impl core::fmt::Display for Guard {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::Leash => "leash",
            Self::InverseKinematics => "joint acceleration",
            Self::TorqueClamp => "torque clamp",
            Self::ForceCap => "force cap",
            Self::VelocityBarrier => "velocity limit",
            Self::TorqueRate => "torque rate",
            Self::Watchdog => "watchdog",
            Self::Deadman => "deadman",
            Self::Backstop => "setpoint limiter",
            Self::JointVelocity => "joint velocity",
            Self::PositionEnvelope => "joint range",
            Self::Clearance => "clearance",
            Self::Deviation => "deviation",
            Self::Lead => "lead",
            Self::PlanFailure => "no plan",
            Self::Reaction => "reaction",
            Self::Team => "team",
            Self::SpeedCap => "speed cap",
            Self::Unresponsive => "no response",
        })
    }
}

impl Bindings {
    /// Adds `guard` where `binds`.
    pub(crate) fn set(&mut self, guard: Guard, binds: bool) {
        self.0 |= u32::from(binds) << guard as u32;
    }

    /// The set of these guards.
    pub fn of(guards: &[Guard]) -> Self {
        let mut bindings = Self::default();
        guards.iter().for_each(|guard| bindings.insert(*guard));
        bindings
    }

    /// The guards of either.
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// A bit for each guard, in the order of [`Guard::ALL`] from the lowest on.
    pub fn to_bits(self) -> u32 {
        self.0
    }

    pub(crate) fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// Adds `guard`.
    pub fn insert(&mut self, guard: Guard) {
        self.set(guard, true);
    }

    /// True if `guard` bound the command.
    pub fn contains(self, guard: Guard) -> bool {
        self.0 & (1 << guard as u32) != 0
    }

    /// The guards that did.
    pub fn iter(self) -> impl Iterator<Item = Guard> {
        let all = Guard::ALL.into_iter();
        all.filter(move |guard| self.contains(*guard))
    }

    /// True if no guard did.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Bindings {
    /// A sequence of the guards.
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Bindings {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut bindings = Self::default();
        for guard in Vec::<Guard>::deserialize(deserializer)? {
            bindings.insert(guard);
        }
        Ok(bindings)
    }
}
