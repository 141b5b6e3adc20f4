//! Guards that limited a command. The record of each cycle contains them.

/// A guard that can limit a command or give up a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(u8)]
#[non_exhaustive]
pub enum Guard {
    /// The reference was ahead of the measured position by the length of the leash, and was held
    /// there.
    Leash,
    /// On the way to a pose, a joint reached its limit of acceleration or jerk.
    InverseKinematics,
    /// The torque of springs and dampers at a joint reached its clamp.
    TorqueClamp,
    /// Springs and dampers would have exerted more force than the goal allows. The excess was
    /// removed.
    ForceCap,
    /// A joint came near the robot's velocity limit, and was braked.
    VelocityBarrier,
    /// The torque would have changed faster than the robot accepts. The change was slowed.
    TorqueRate,
    /// The targets stopped arriving, so the arm brakes or rests.
    Watchdog,
    /// The deadman is silent, so the arm brakes or rests.
    Deadman,
    /// The limiter in front of the robot's own controller changed a setpoint.
    Backstop,
    /// On the way to a pose, a joint reached its velocity cap.
    JointVelocity,
    /// On the way to a pose, a joint reached the end of its range, or was slowed so that it could
    /// stop before the end.
    PositionEnvelope,
    /// The arm came near itself or near a keep-out region. The reference slowed down, or stopped in
    /// time.
    Clearance,
    /// The arm was pushed off its path, and its goal was given up.
    Deviation,
    /// The target was further ahead of the arm than the lead allows, and was moved closer.
    Lead,
    /// No plan to the target could be made (only a defect can cause this). The previous plan
    /// continues.
    PlanFailure,
    /// The condition of the goal became true. Therefore the arm brakes, moves to the other target,
    /// or has reached it.
    Reaction,
    /// A member of the team has a fault, or the team was stopped, so the arm brakes or rests.
    Team,
    /// On the way to a pose, a point of the arm reached the session's speed cap and the joints were
    /// slowed. Or the arm exceeded the cap and its goal was given up.
    SpeedCap,
    /// The arm stood still under commands that should have moved it, although the robot reported no
    /// error. Its goal was given up.
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

/// Writes the common name of the guard, such as `joint range`.
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
    pub(crate) fn set(&mut self, guard: Guard, binds: bool) {
        self.0 |= u32::from(binds) << guard as u32;
    }

    /// Returns the set of these guards.
    pub fn of(guards: &[Guard]) -> Self {
        let mut bindings = Self::default();
        guards.iter().for_each(|guard| bindings.insert(*guard));
        bindings
    }

    /// Returns the guards that are in either set.
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Returns a bit for each guard, in the order of [`Guard::ALL`] from the lowest bit.
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

    /// True if `guard` limited the command.
    pub fn contains(self, guard: Guard) -> bool {
        self.0 & (1 << guard as u32) != 0
    }

    /// Returns the guards that limited the command.
    pub fn iter(self) -> impl Iterator<Item = Guard> {
        let all = Guard::ALL.into_iter();
        all.filter(move |guard| self.contains(*guard))
    }

    /// True if no guard limited the command.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Bindings {
    /// Serializes the guards as a sequence.
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
