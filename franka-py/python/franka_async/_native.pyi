"""The native part of the package: see ``franka_async``."""

from collections.abc import AsyncIterable, Callable, Coroutine, Generator, Iterable, Iterator, Sequence
from os import PathLike
from types import GenericAlias
from typing import Any, ClassVar, Generic, Literal, TypeAlias, TypeVar, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Unpack, disjoint_base

from .errors import ControlError
from .explanation import Approach, Contact, Moment, Peak
from .goal import Budget, Chunk, Controller, Destination, Gains, Joints, Margin, Target, Waypoint
from .motion import MotionReport, Progress, Reference
from .options import EngageOptions, FollowOptions, GoalOptions, MotionOptions, RecordOptions, SimOptions, TeamOptions, TuneOptions
from .otg import Synchronisation
from .recording import Episode, RecordedEvent, RecordedRobot, RecordStatus, Recovery, ReplayReport
from .settings import VirtualWall
from .streams import Reading, Stream, TaredState
from .supervision import CloseReason, Event, Health, Policy, Reflex

_T_co = TypeVar("_T_co", covariant=True)
_Array: TypeAlias = NDArray[np.float64]

ERROR_NAMES: list[str]
READY: tuple[float, float, float, float, float, float, float]
FLAT_LAYOUT: list[tuple[str, int, int]]
__version__: str

_RobotMode: TypeAlias = Literal[
    "other", "idle", "move", "guiding", "reflex", "user_stopped", "automatic_error_recovery"
]

@final
class RobotState:
    """The robot's state of one millisecond, with the vendor's names: O base, F flange, NE nominal end
    effector, EE end effector, K stiffness frame; `X_T_Y` is the pose of Y in X, with the
    translation in the last column.

    The state is immutable. Each access returns a new array, which the program may change.
    """

    FLAT_LAYOUT: ClassVar[list[tuple[str, int, int]]]
    FLAT_LEN: ClassVar[int]
    @property
    def q(self) -> _Array:
        """Measured joint positions, `(7,)` rad."""
    @property
    def q_d(self) -> _Array:
        """Desired joint positions, `(7,)` rad."""
    @property
    def dq(self) -> _Array:
        """Measured joint velocities, `(7,)` rad/s."""
    @property
    def dq_d(self) -> _Array:
        """Desired joint velocities, `(7,)` rad/s."""
    @property
    def ddq_d(self) -> _Array:
        """Desired joint accelerations, `(7,)` rad/s^2."""
    @property
    def tau_J(self) -> _Array:
        """Measured link-side joint torques, gravity included, `(7,)` N m."""
    @property
    def tau_J_d(self) -> _Array:
        """Desired joint torques, gravity excluded, `(7,)` N m."""
    @property
    def dtau_J(self) -> _Array:
        """Derivatives of the measured joint torques, `(7,)` N m/s."""
    @property
    def theta(self) -> _Array:
        """Motor positions, `(7,)` rad."""
    @property
    def dtheta(self) -> _Array:
        """Motor velocities, `(7,)` rad/s."""
    @property
    def joint_contact(self) -> _Array:
        """Contact level of each joint, `(7,)`, 0 or 1."""
    @property
    def joint_collision(self) -> _Array:
        """Collision level of each joint until the recovery, `(7,)`, 0 or 1."""
    @property
    def tau_ext_hat_filtered(self) -> _Array:
        """Estimated external joint torques, `(7,)` N m."""
    @property
    def cartesian_contact(self) -> _Array:
        """Contact level of each Cartesian axis, `(6,)`, 0 or 1."""
    @property
    def cartesian_collision(self) -> _Array:
        """Collision level of each Cartesian axis until the recovery, `(6,)`, 0 or 1."""
    @property
    def O_F_ext_hat_K(self) -> _Array:
        """Estimated external wrench in the base frame, `(6,)` N and N m, its torque about the origin
        of the base, positive when the robot pushes. Zeros near a singularity.
        """
    @property
    def K_F_ext_hat_K(self) -> _Array:
        """Estimated external wrench on the stiffness frame in the stiffness frame, `(6,)` N and N m,
        positive when the robot pushes. Zeros near a singularity.
        """
    @property
    def O_dP_EE_d(self) -> _Array:
        """Desired twist of the end effector in the base frame, `(6,)` m/s and rad/s."""
    @property
    def O_dP_EE_c(self) -> _Array:
        """Last commanded twist of the end effector in the base frame, `(6,)` m/s and rad/s."""
    @property
    def O_ddP_EE_c(self) -> _Array:
        """Last commanded acceleration of the end effector in the base frame, `(6,)` m/s^2 and rad/s^2."""
    @property
    def O_ddP_O(self) -> _Array:
        """Acceleration of the base, gravity included, `(3,)` m/s^2."""
    @property
    def F_x_Cee(self) -> _Array:
        """Centre of mass of the end effector in the flange frame, `(3,)` m."""
    @property
    def F_x_Cload(self) -> _Array:
        """Centre of mass of the load in the flange frame, `(3,)` m."""
    @property
    def elbow(self) -> _Array:
        """Measured elbow, `(2,)`: angle of joint 3 in rad and sign of joint 4."""
    @property
    def elbow_d(self) -> _Array:
        """Desired elbow, `(2,)`: angle of joint 3 in rad and sign of joint 4."""
    @property
    def elbow_c(self) -> _Array:
        """Last commanded elbow, `(2,)`: angle of joint 3 in rad and sign of joint 4."""
    @property
    def delbow_c(self) -> _Array:
        """Velocity of the commanded elbow, `(2,)`: velocity of joint 3 in rad/s, then 0."""
    @property
    def ddelbow_c(self) -> _Array:
        """Acceleration of the commanded elbow, `(2,)`: acceleration of joint 3 in rad/s^2, then 0."""
    @property
    def O_T_EE(self) -> _Array:
        """Measured pose of the end effector in the base frame, `(4, 4)`."""
    @property
    def O_T_EE_d(self) -> _Array:
        """Desired pose of the end effector in the base frame, `(4, 4)`."""
    @property
    def O_T_EE_c(self) -> _Array:
        """Last commanded pose of the end effector in the base frame, `(4, 4)`."""
    @property
    def F_T_EE(self) -> _Array:
        """Pose of the end effector in the flange frame, `(4, 4)`."""
    @property
    def EE_T_K(self) -> _Array:
        """Pose of the stiffness frame in the end-effector frame, `(4, 4)`."""
    @property
    def F_T_NE(self) -> _Array:
        """Pose of the nominal end effector in the flange frame, `(4, 4)`."""
    @property
    def NE_T_EE(self) -> _Array:
        """Pose of the end effector in the nominal end-effector frame, `(4, 4)`."""
    @property
    def I_ee(self) -> _Array:
        """Inertia of the end effector about its centre of mass, `(3, 3)` kg m^2."""
    @property
    def I_load(self) -> _Array:
        """Inertia of the load about its centre of mass, `(3, 3)` kg m^2."""
    @property
    def m_ee(self) -> float:
        """Mass of the end effector, kg."""
    @property
    def m_load(self) -> float:
        """Mass of the load, kg."""
    @property
    def control_command_success_rate(self) -> float:
        """Share of the last 100 commands that arrived in time, 0 to 1; 0 while no control runs."""
    @property
    def m_total(self) -> float:
        """Mass of end effector and load, kg."""
    @property
    def F_x_Ctotal(self) -> _Array:
        """Common centre of mass of end effector and load in the flange frame, `(3,)` m."""
    @property
    def I_total(self) -> _Array:
        """Inertia of end effector and load about their common centre of mass, `(3, 3)` kg m^2."""
    @property
    def accelerometer_top(self) -> _Array:
        """Upper accelerometers of joints 1 to 6, `(6, 3)` m/s^2; zero on a Franka Emika Robot."""
    @property
    def accelerometer_bottom(self) -> _Array:
        """Lower accelerometers of joints 1 to 6, `(6, 3)` m/s^2; zero on a Franka Emika Robot."""
    @property
    def time(self) -> float:
        """The robot's clock, s: a thousandth more with each cycle."""
    @property
    def time_ms(self) -> int:
        """The robot's clock, ms: one more with each cycle."""
    @property
    def robot_mode(self) -> _RobotMode:
        """Overall mode of the robot: `other`, `idle`, `move`, `guiding`, `reflex`, `user_stopped` or
        `automatic_error_recovery`.
        """
    @property
    def motion_generator_mode(self) -> str:
        """The active motion generator."""
    @property
    def controller_mode(self) -> str:
        """The active controller."""
    @property
    def current_errors(self) -> list[str]:
        """Errors that block the robot now, by the vendor's names."""
    @property
    def last_motion_errors(self) -> list[str]:
        """Errors that ended the last motion, by the vendor's names."""
    def flat(self) -> _Array:
        """The usual observation of a policy as one array, `(69,)`: see `FLAT_LAYOUT`."""
    def to_dict(self) -> dict[str, Any]:
        """All attributes by name."""
    def _repr_html_(self) -> str: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

def _state_of_json(json: str, version: int) -> RobotState:
    """The state written by `pickle`."""
def _log_of_json(entries: Sequence[str], version: int) -> ControlLog:
    """The log written by `pickle`. An entry with numbers that JSON cannot represent is left out."""

_Frame: TypeAlias = Literal[
    "joint1", "joint2", "joint3", "joint4", "joint5", "joint6", "joint7", "flange", "ee", "stiffness"
]

@final
class Model:
    """Kinematics, dynamics and limits of one arm, without a connection: `Model.fr3()`, `Model.fer()`,
    `Model.from_urdf(text)`.

    Joint positions `q` (rad), velocities `dq` (rad/s) and so on are one vector, `(7,)`, or a batch,
    `(n, 7)`: results of a batch have a leading axis of length n. If a function has several
    arguments, a single one is used for the whole batch of the other. Batches release the
    interpreter to other threads.

    Frames are `joint1` to `joint7`, `flange`, `ee` (the end effector, `F_T_EE` from the flange) and
    `stiffness` (`EE_T_K` from the end effector); both poses are the identity unless given. The base
    frame is the frame of link 0, z upwards along the axis of joint 1. Wrong shapes and numbers that
    are not finite raise `ValueError`.
    """

    @staticmethod
    def fr3() -> Model:
        """The Franka Research 3, with the vendor's numbers."""
    @staticmethod
    def fer() -> Model:
        """The Franka Emika Robot (Panda), as computed by its own model library."""
    @staticmethod
    def from_urdf(text: str) -> Model:
        """The model from the URDF `text` of a Franka Research 3, with the masses and limits of that
        arm. `ValueError` describes the error in another text.
        """
    @property
    def kind(self) -> Literal["fr3", "fer"]:
        """Kind of robot: `fr3` or `fer`."""
    @property
    def joint_limits(self) -> JointLimits:
        """Limits of the joints."""
    @property
    def cartesian_limits(self) -> CartesianLimits:
        """Limits of Cartesian motion commands."""
    def pose(
        self, frame: _Frame, q: ArrayLike, F_T_EE: ArrayLike | None = None, EE_T_K: ArrayLike | None = None
    ) -> _Array:
        """The pose of `frame` in the base frame, `(4, 4)` or `(n, 4, 4)`.

        `F_T_EE` and `EE_T_K` are the identity unless given, even if a robot has a tool: pass the
        values of its state for its own `ee` and `stiffness`. `Robot.pose_at` uses the robot's
        `F_T_EE`.
        """
    def zero_jacobian(
        self, frame: _Frame, q: ArrayLike, F_T_EE: ArrayLike | None = None, EE_T_K: ArrayLike | None = None
    ) -> _Array:
        """Twist of `frame` per joint velocity, in base axes about the frame's origin, linear rows
        first: `(6, 7)` or `(n, 6, 7)`. Tools as for `pose`: the identity unless given.
        """
    def body_jacobian(
        self, frame: _Frame, q: ArrayLike, F_T_EE: ArrayLike | None = None, EE_T_K: ArrayLike | None = None
    ) -> _Array:
        """`zero_jacobian` in the frame's own axes. Tools as for `pose`: the identity unless given."""
    def link_poses(self, q: ArrayLike) -> _Array:
        """The poses of link 1 to link 7 and of the flange in the base frame, `(8, 4, 4)` or
        `(n, 8, 4, 4)`: for drawing the arm.
        """
    def manipulability(self, q: ArrayLike) -> _Array:
        """Distance of an arm from a singularity: `sqrt(det(J J'))`, 0 in a singularity, 0.080 in the
        ready pose. A number, or `(n,)`.
        """
    def mass(
        self,
        q: ArrayLike,
        I_total: ArrayLike | None = None,
        m_total: float = 0.0,
        F_x_Ctotal: ArrayLike | None = None,
    ) -> _Array:
        """Joint-space inertia without rotors, `(7, 7)` or `(n, 7, 7)` kg m^2.

        A load has the mass `m_total` in kg, its centre of mass `F_x_Ctotal` in the flange frame,
        `(3,)` m, and its inertia about that point in flange axes, `I_total`, `(3, 3)` kg m^2, as in
        states. This applies to all methods. The default is no load and no tool: pass a robot's
        values from its state.
        """
    def coriolis(
        self,
        q: ArrayLike,
        dq: ArrayLike,
        I_total: ArrayLike | None = None,
        m_total: float = 0.0,
        F_x_Ctotal: ArrayLike | None = None,
    ) -> _Array:
        """Torques of Coriolis and centrifugal forces, `(7,)` or `(n, 7)` N m. Without tool and load
        unless given, as for `mass`.
        """
    def gravity(
        self,
        q: ArrayLike,
        m_total: float = 0.0,
        F_x_Ctotal: ArrayLike | None = None,
        gravity_earth: ArrayLike | None = None,
    ) -> _Array:
        """Torques that hold the arm still against gravity, `(7,)` or `(n, 7)` N m. `gravity_earth` is
        the gravitational acceleration in the base frame, `(3,)` m/s^2, by default for an upright
        robot. Without tool and load unless given, as for `mass`.
        """
    def dynamics(
        self,
        q: ArrayLike,
        dq: ArrayLike,
        *,
        F_T_EE: ArrayLike | None = None,
        I_total: ArrayLike | None = None,
        m_total: float = 0.0,
        F_x_Ctotal: ArrayLike | None = None,
        gravity_earth: ArrayLike | None = None,
    ) -> Dynamics:
        """Pose, Jacobian, mass, Coriolis and gravity torques from one pass, for the end effector
        `F_T_EE`, the identity unless given. Without tool and load unless given, as for `mass`.
        """
    def inverse_dynamics(
        self,
        q: ArrayLike,
        dq: ArrayLike,
        ddq: ArrayLike,
        *,
        I_total: ArrayLike | None = None,
        m_total: float = 0.0,
        F_x_Ctotal: ArrayLike | None = None,
        gravity_earth: ArrayLike | None = None,
    ) -> _Array:
        """Torques for the accelerations `ddq`, `M ddq + C dq + g`: `(7,)` or `(n, 7)` N m. Without
        tool and load unless given, as for `mass`.
        """
    def forward_dynamics(
        self,
        q: ArrayLike,
        dq: ArrayLike,
        tau: ArrayLike,
        *,
        I_total: ArrayLike | None = None,
        m_total: float = 0.0,
        F_x_Ctotal: ArrayLike | None = None,
        gravity_earth: ArrayLike | None = None,
        armature: ArrayLike | None = None,
    ) -> _Array:
        """Accelerations under the joint torques `tau`, gravity included: `(7,)` or `(n, 7)` rad/s^2.
        `armature` is the reflected rotor inertia of the joints, `(7,)` kg m^2, zero unless given.
        If mass and armature are not physical, the result is NaN. Without tool and load unless
        given, as for `mass`.
        """
    def ik(
        self,
        pose: ArrayLike,
        *,
        joint7: float | None = None,
        joint4: float | None = None,
        swivel: float | None = None,
        F_T_EE: ArrayLike | None = None,
    ) -> _Array:
        """Every posture within the joint limits that brings the end effector to `pose`, `(k, 7)` rad,
        for one additional number that selects from the arm's self-motion: the angle of `joint7`, of
        `joint4`, or the `swivel` angle of the elbow about the line from shoulder to wrist, rad,
        zero with the elbow on top. k is 0 if no posture exists; with joint 7 or 4 it is at most 8.
        """
    def ik_many(
        self,
        poses: ArrayLike,
        *,
        joint7: float | None = None,
        joint4: float | None = None,
        swivel: float | None = None,
        F_T_EE: ArrayLike | None = None,
    ) -> list[_Array]:
        """`ik` for each of many poses, `(n, 4, 4)` or `(n, 7)`: a list of n arrays `(k, 7)`."""
    def ik_near(self, pose: ArrayLike, q: ArrayLike, F_T_EE: ArrayLike | None = None) -> _Array:
        """The posture within the joint limits that brings the end effector to `pose` and is nearest to
        `q` (least sum of squares): `(7,)` rad, some 0.3 ms. `ValueError` if the pose is out of
        reach.

        For many poses or many `q` the result is `(n, 7)`, with NaN in the rows of unreachable
        poses.
        """
    def ik_from(self, pose: ArrayLike, seed: ArrayLike, F_T_EE: ArrayLike | None = None) -> _Array:
        """A posture within the joint limits that brings the end effector to `pose`, `(7,)` rad, by
        iteration from `seed`, which selects the posture: usually one nearby. It takes some 10
        microseconds near the seed, and 2 ms until an unreachable pose raises `ValueError`.
        `ik_near` examines all postures instead.

        For many poses or many seeds the result is `(n, 7)`, with NaN in the rows of unreachable
        poses.
        """
    def differential_ik(
        self,
        q: ArrayLike,
        twist: ArrayLike,
        *,
        posture: ArrayLike | None = None,
        lower: ArrayLike | None = None,
        upper: ArrayLike | None = None,
        smooth: bool = False,
        F_T_EE: ArrayLike | None = None,
    ) -> tuple[_Array, _Array]:
        """Joint velocities for the `twist` of the end effector, `[linear; angular]`, m/s and rad/s in
        base axes, and the missing part of the twist. The results are `(7,)` rad/s and `(6,)`, with
        a leading axis for many `q` or twists. It also works with displacements, in m and rad.

        The velocities are exactly within `lower` and `upper`, `(7,)` or `(n, 7)`, by default the
        limits at `q`. In the nullspace they follow `posture`, by default zero. Near singularities
        and at bounds the position has priority; with `smooth`, position and orientation have equal
        priority.
        """
    def clearance(
        self, q: ArrayLike, *, hand: bool = True, shape: Literal["vendor", "covering"] = "vendor"
    ) -> Clearance:
        """The least distance within the arm, and its bodies. `hand` is true for a Franka Hand on the
        flange.

        `shape` is `vendor`, the vendor's capsules for self-collision, which do not cover the links
        everywhere, or `covering`, which contain them and are up to 3.5 cm thicker.
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Dynamics:
    """The quantities that a control law needs at a state of the arm, from one pass. Results of a batch
    have a leading axis.
    """

    @property
    def pose(self) -> _Array:
        """Pose of the end effector in the base frame, `(4, 4)`."""
    @property
    def jacobian(self) -> _Array:
        """Zero Jacobian of the end effector, `(6, 7)`."""
    @property
    def mass(self) -> _Array:
        """Joint-space inertia, `(7, 7)` kg m^2."""
    @property
    def coriolis(self) -> _Array:
        """Torques of Coriolis and centrifugal forces, `(7,)` N m."""
    @property
    def gravity(self) -> _Array:
        """Torques that hold the arm still against gravity, `(7,)` N m."""
    @property
    def jdot_dq(self) -> _Array:
        """`dJ/dt dq`: acceleration of the end effector while the joints keep their velocity, `(6,)`
        m/s^2 and rad/s^2 in base axes.
        """

@final
class Clearance:
    """The least distance between two bodies of the arm; with a leading axis for a batch."""

    @property
    def distance(self) -> _Array:
        """Distance between the surfaces, m: an array without axes, or `(n,)`. Negative for overlapping
        bodies.
        """
    @property
    def bodies(self) -> NDArray[np.int64]:
        """Numbers of the bodies, the inner one first, `(2,)`: 0 is the base, 1 to 7 are the links, 8
        is the tool on the flange.
        """
    @property
    def gradient(self) -> _Array:
        """Change of the distance per joint position, `(7,)` m/rad."""
    @property
    def points(self) -> _Array:
        """The nearest points of the axes of the two capsules in the base frame, `(2, 3)` m."""

@final
class JointLimits:
    """Limits of the seven joints; each array is a new one, `(7,)`."""

    @property
    def lower(self) -> _Array:
        """Smallest commanded positions, rad, slightly inside `hard_lower`."""
    @property
    def upper(self) -> _Array:
        """Largest commanded positions, rad, slightly inside `hard_upper`."""
    @property
    def hard_lower(self) -> _Array:
        """Lower ends of the velocity envelope, rad."""
    @property
    def hard_upper(self) -> _Array:
        """Upper ends of the velocity envelope, rad."""
    @property
    def velocity(self) -> _Array:
        """Largest speeds at any position, rad/s; near position limits see `velocity_envelope`."""
    @property
    def acceleration(self) -> _Array:
        """Largest accelerations of a commanded motion, rad/s^2."""
    @property
    def jerk(self) -> _Array:
        """Largest jerks of a commanded motion, rad/s^3."""
    @property
    def torque(self) -> _Array:
        """Largest torques, N m."""
    @property
    def torque_rate(self) -> _Array:
        """Largest rates of commanded torques, N m/s."""
    def velocity_envelope(self, q: ArrayLike, margin: float = 0.0) -> tuple[_Array, _Array]:
        """Smallest and largest joint velocities at the positions `q`, two arrays `(7,)` or `(n, 7)`,
        rad/s. On a Franka Research 3, the speed towards a position limit is bounded so that the
        joint can stop before it. `margin` in rad/s is subtracted on both sides: the robot checks
        with 0, libfranka limits with 0.001.
        """
    def distance(self, q: ArrayLike) -> _Array:
        """Distances of the positions `q` to the nearer of `lower` and `upper`, `(7,)` or `(n, 7)` rad,
        negative outside.
        """
    def contains(self, q: ArrayLike) -> NDArray[np.bool_]:
        """True if every position is within `lower` and `upper`: one value, or an array `(n,)`."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class MotionLimits:
    """Bounds on a motion along one coordinate, or on the norm of a vector of them, per second and its
    powers.
    """

    @property
    def velocity(self) -> float:
        """Velocity, m/s or rad/s."""
    @property
    def acceleration(self) -> float:
        """Acceleration, m/s^2 or rad/s^2."""
    @property
    def jerk(self) -> float:
        """Jerk, m/s^3 or rad/s^3."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class CartesianLimits:
    """Limits of Cartesian motion commands."""

    @property
    def translation(self) -> MotionLimits:
        """Limits of the end effector's position: bounds on the norm, m."""
    @property
    def rotation(self) -> MotionLimits:
        """Limits of the end effector's orientation: bounds on the norm, rad."""
    @property
    def elbow(self) -> MotionLimits:
        """Limits of the elbow's angle, joint 3, rad."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class AxisLimits:
    """Largest velocity, acceleration and jerk of each axis, in both directions. The program chooses
    the units: rad or m, per second and its powers.

    Each limit is one number for all axes, or one number for each axis, `(n,)`; all must be positive
    and finite.
    """

    def __new__(cls, velocity: ArrayLike, acceleration: ArrayLike, jerk: ArrayLike) -> AxisLimits: ...
    @staticmethod
    def fr3() -> AxisLimits:
        """Limits of the joints of a Franka Research 3. Near a position limit the robot allows less:
        see `JointLimits.velocity_envelope`.
        """
    @staticmethod
    def fer() -> AxisLimits:
        """Limits of the joints of a Franka Emika Robot (Panda)."""
    def scaled(self, velocity: float = 1.0, acceleration: float = 1.0, jerk: float = 1.0) -> AxisLimits:
        """The same limits times these factors."""
    @property
    def velocity(self) -> _Array:
        """Largest velocities: `(n,)`, or `(1,)` for all axes."""
    @property
    def acceleration(self) -> _Array:
        """Largest accelerations: `(n,)`, or `(1,)` for all axes."""
    @property
    def jerk(self) -> _Array:
        """Largest jerks: `(n,)`, or `(1,)` for all axes."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class Trajectory:
    """A planned motion. It begins at time 0 in its start state, and is at rest from `duration` on."""

    @property
    def duration(self) -> float:
        """Time until rest, s."""
    @property
    def arrival(self) -> float:
        """Time at which the target is met, s: the duration, unless the target moves."""
    @property
    def axes(self) -> int:
        """Number of axes."""
    @property
    def end(self) -> _Array:
        """Position of rest, `(axes,)`."""
    def at(self, t: ArrayLike) -> tuple[_Array, _Array, _Array]:
        """Position, velocity and acceleration at the time `t` in s, `(axes,)` each, or at many times,
        `(m,)`, `(m, axes)` each. Before the beginning it returns the start state, after the end the
        state at rest.
        """
    def sample(self, dt: float = 0.001) -> tuple[_Array, _Array, _Array, _Array]:
        """Times every `dt` seconds from the beginning to the first one at rest, `(m,)`, with position,
        velocity and acceleration, `(m, axes)` each.
        """

def plan_trajectory(
    start: ArrayLike,
    target: ArrayLike | None,
    limits: AxisLimits,
    *,
    start_velocity: ArrayLike | None = None,
    start_acceleration: ArrayLike | None = None,
    target_velocity: ArrayLike | None = None,
    target_acceleration: ArrayLike | None = None,
    synchronisation: Synchronisation = "straight",
) -> Trajectory:
    """Plans the fastest motion from `start` to `target`, both `(n,)`, inside `limits`; of one axis to
    64. Without a target, `None`, to rest as early as possible.

    The motion may begin with `start_velocity` and `start_acceleration`, and pass the target with
    `target_velocity` and `target_acceleration`, `(n,)` each, zero by default. If the target has a
    velocity, the motion passes it and stops behind it. All axes are at the target at the same time.
    With `synchronisation` `straight`, they move on a straight line if the start state allows it;
    with `time`, each axis moves on its own path.

    `ValueError` for shapes that do not match, numbers that are not finite, and a target that moves
    faster than the limits allow.
    """

@final
class VirtualRobots:
    """Simulated robots in one process, without sockets, each with a separate motion: `step` sets an
    action for each and simulates some milliseconds.

    Actions depend on `control`: `joint_velocity`, `(7,)` rad/s to approach; `joint_delta`, `(7,)`
    rad by which the target moves; `cartesian_delta`, `(6,)` m and a rotation vector in base axes by
    which the end effector's target moves; `torque`, `(7,)` N m in addition to gravity. Motions keep
    the robot's limits of velocity, acceleration and jerk, torques its rate limit; positions stay
    away from the ends of the joint ranges. `speed` is the share of the largest velocity that
    motions use.

    The arm is `realistic` (with stiction and elasticity), `ideal`, `nominal`, `bad`, or `sampled`:
    a different realistic arm for each seed. Robots have a Franka Hand unless `hand` is false.
    `threads` share the work of a step.
    """

    def __new__(
        cls,
        kind: Literal["fr3", "fer"] = "fr3",
        count: int = 1,
        *,
        control: Literal["joint_velocity", "joint_delta", "cartesian_delta", "torque"] = "joint_velocity",
        arm: Literal["realistic", "ideal", "nominal", "bad", "sampled"] = "realistic",
        hand: bool = True,
        speed: float = 0.5,
        threads: int = 1,
    ) -> VirtualRobots: ...
    def __len__(self) -> int: ...
    @property
    def action_size(self) -> int:
        """Length of an action: 6 or 7."""
    def action_bound(self, cycles: int = 1) -> _Array:
        """Largest effective action of each axis in one step of `cycles`: rad/s, rad, m and rad, or N
        m. Larger actions are clipped.
        """
    def reset(self, index: int, *, seed: int = 0, q: ArrayLike | None = None) -> None:
        """Restarts robot `index`, counted from 0: at rest at the joint positions `q`, `(7,)` rad, by
        default the ready pose. Noise, and a sampled arm, come from `seed`: the same seed and
        actions give the same states.
        """
    def step(self, actions: ArrayLike, cycles: int = 1) -> tuple[_Array, NDArray[np.bool_]]:
        """Sets the action of every robot, `(n, 6 or 7)`, and simulates `cycles` milliseconds. Returns
        `flat()` of the states after that, `(n, 69)`, and flags for the moving robots, `(n,)`: a
        robot that has stopped itself (see `errors`) does not move until its `reset`.
        """
    def observations(self) -> _Array:
        """`flat()` of the newest states, `(n, 69)`."""
    def state(self, index: int) -> RobotState:
        """Newest state of robot `index`."""
    def errors(self, index: int) -> list[str]:
        """The errors that stopped robot `index`, by the vendor's names; empty while it moves."""
    def push(self, index: int, wrench: ArrayLike, duration: int) -> None:
        """Pushes the end effector of robot `index` with `wrench`, `(6,)` N and N m in base axes, for
        this number of milliseconds of its time.
        """

_Controller: TypeAlias = Literal["joint_impedance", "cartesian_impedance", "external_controller"]
_Command: TypeAlias = Literal[
    "torques", "joint_positions", "joint_velocities", "cartesian_pose", "cartesian_velocities"
]

@final
class ActiveControl:
    """A motion under active control: from the first `read_once()` on, the thread that calls it runs
    the control cycle. The thread must answer each state within the millisecond. If it neither reads
    nor writes, the robot receives no commands and stops. Commands are neither filtered nor limited.

    As a context manager, it stops the robot at the end of the block, unless the last command has
    been written. Only one thread at a time may use it.
    """

    def read_once(self) -> tuple[RobotState, float]:
        """Waits for the next state of the motion, with the interpreter released. Returns it with the
        robot's time since the last state read, in seconds: 0 for the first state, and more than
        0.001 after a loss.

        Raises `MotionError` with the reason for the end of the motion. Later calls raise
        `ActiveError` of the kind `ended`, or `finished` after the last command.
        """
    def write_once(
        self,
        command: ArrayLike,
        finished: bool = False,
        *,
        torques: ArrayLike | None = None,
        elbow: ArrayLike | None = None,
    ) -> MotionReport | None:
        """Sends the command that answers the newest state. With `finished` it is the last command: the
        call then waits, with the interpreter released, until the robot has ended the motion, and
        returns a `MotionReport`.

        `torques`, `(7,)` N m, are required in addition to the command of a motion generator under
        `external_controller`. `elbow` is for poses and twists: position of joint 3 in rad, and sign
        of joint 4.

        Raises `ValueError` for numbers that are not finite or of the wrong shape. Raises
        `ActiveError` if the command cannot be sent; the motion then continues. Raises `MotionError`
        if the motion ended for any reason other than the last command.
        """
    def stop(self) -> None:
        """Stops the robot, unless the last command has been written. First waits until a call of
        another thread has returned.
        """
    def __enter__(self) -> ActiveControl: ...
    def __exit__(self, *_exception: object) -> None: ...

@final
class AsynchronousControl:
    """A motion between sparse joint targets that the robot itself plans. Any thread may set targets.
    The robot stops if you call `stop()` or drop this object.
    """

    def set_target(self, q: ArrayLike) -> None:
        """Moves the robot to `q`, `(7,)` rad, replacing the previous target. Raises the reason if the
        motion has ended.
        """
    def status(self) -> tuple[Literal["idle", "executing", "target_reached", "aborted"], str | None]:
        """Status of the newest target: `idle`, `executing`, `target_reached` or `aborted`; and the
        reason if it was aborted.
        """
    def reached(self) -> Operation[None]:
        """Waits until the newest target is reached. Raises the reason if the motion ends earlier.
        Cancelling does not stop the robot.
        """
    def stop(self) -> None:
        """Stops the robot. A second call has no effect."""
    def __enter__(self) -> AsynchronousControl: ...
    def __exit__(self, *_exception: object) -> None: ...

@final
class Law:
    """A control law: a C function that the real-time thread calls with every state, without the
    interpreter. `include/franka_async_law.h` documents its input and its return value.

    `code` is a `numba.cfunc`, a result of `franka_async.laws.compiled`, a function of a library
    loaded by `ctypes` or `cffi`, or an address as an integer, whose code the program must keep.
    `command` is the kind of the law's output: `torques`, `joint_positions`, `joint_velocities`,
    `cartesian_pose` or `cartesian_velocities`. With `elbow=True`, the elbow follows the output of
    the latter two: position of joint 3, rad, and the sign of joint 4; otherwise the robot chooses
    the elbow. `parameters` and `memory`, `(n,)` with at most 256 numbers, are the initial values in
    the first cycle.

    The function runs on the real-time thread, with some 300 us to answer. It must not lock,
    allocate, print or wait. Code that writes to invalid memory is not detected.
    """

    @property
    def parameters(self) -> _Array:
        """The newest parameters, `(n,)`. A running law receives new ones in its next cycle, all at
        once; their number is fixed. Raises `ValueError`.
        """
    @parameters.setter
    def parameters(self, parameters: ArrayLike, /) -> None: ...
    def __new__(
        cls,
        code: object,
        *,
        command: _Command = "torques",
        elbow: bool = False,
        parameters: ArrayLike | None = None,
        memory: ArrayLike | None = None,
    ) -> Law: ...
    @property
    def command(self) -> _Command:
        """Kind of the law's output."""
    @property
    def memory(self) -> _Array:
        """The memory after the newest cycle of the newest run, `(n,)`; before the first run, the
        initial memory.
        """
    def step(self, state: RobotState, dt: float = 0.001) -> tuple[_Array, int]:
        """Calls the law once, with `state` and `dt` seconds after the previous state, without a robot.
        Returns its output, `(7,)`, `(4, 4)` or `(6,)`, or with an elbow the raw output, `(18,)` or
        `(8,)`; and its return value. Numbers that it did not write are NaN. Time and memory
        continue from call to call; `reset()` starts again. Model terms use the vendor's constants
        for the state's kind of robot.
        """
    def reset(self) -> None:
        """Makes the next `step` begin with time 0 and the initial memory."""

def _law_layout() -> tuple[list[tuple[str, int, list[int], str]], int]:
    """Places of a law's input fields: name, offset in bytes, shape, numpy format; and the total size."""

@disjoint_base
class Operation(Coroutine[Any, Any, _T_co], Generic[_T_co]):
    """An operation that takes time: `await` it in a coroutine, or call `wait()` on a thread without an
    event loop. It begins then and not before. Cancelling the wait cancels the operation; a motion
    brakes.

    It is a coroutine in the sense of `collections.abc`, so `asyncio.create_task`, `TaskGroup`,
    `gather`, `wait_for` and `timeout` accept it.
    """

    def __class_getitem__(cls, key: Any) -> GenericAlias: ...
    def wait(self, timeout: float | None = None) -> _T_co:
        """Waits on this thread, with the interpreter released, and returns the result. After `timeout`
        seconds the operation is cancelled (a motion brakes) and `TimeoutError` is raised; Ctrl-C
        cancels it and raises `KeyboardInterrupt`.
        """
    def __await__(self) -> Generator[Any, Any, _T_co]: ...
    def __next__(self) -> Any: ...
    def send(self, value: Any) -> Any:
        """Coroutine protocol: continues from the last `await`."""
    def throw(self, kind: Any, value: Any = None, traceback: Any = None) -> Any:
        """Coroutine protocol: raises an exception inside of it."""
    def close(self) -> None:
        """Coroutine protocol: cancels the operation. A motion brakes."""

def _complete(future: Any, method: str, value: Any) -> None:
    """Completes a future, in its event loop, unless it is done."""

@final
class Motion(Operation[MotionReport]):
    """A motion: it begins when it is awaited, and then arrives, with a `MotionReport`, or raises
    `MotionError`. Cancelling it brakes the arm.
    """

    def handle(self) -> MotionHandle:
        """Handle for the progress of the motion, and to pause or brake it from elsewhere."""
    def progress(self) -> Progress | None:
        """Progress of the motion: a `Progress`; `None` before it has begun and after its end."""
    def pause(self) -> None:
        """Pauses the motion on its path, until `resume()`; the arm is held there. Without effect
        before it has begun and after its end.
        """
    def resume(self) -> None:
        """Resumes the motion."""
    def cancel(self) -> None:
        """Brakes and ends the motion, from any thread; awaiting it raises `MotionError` of the kind
        `stopped`. A motion that has not begun never begins.
        """

@final
class Follow(Operation[MotionReport]):
    """Following targets: it begins when it is awaited, and ends at the last target, with a
    `MotionReport`, or raises `MotionError`. Cancelling it brakes the arm.
    """

@final
class MotionHandle:
    """A handle of a motion: progress, pausing and braking. It does not keep the motion alive."""

    def progress(self) -> Progress | None:
        """Like `Motion.progress`."""
    def pause(self) -> None:
        """Like `Motion.pause`."""
    def resume(self) -> None:
        """Like `Motion.resume`."""
    def cancel(self) -> None:
        """Like `Motion.cancel`."""

@final
class Latest:
    """The newest target of a program: `set` it from any thread, at any rate, and `follow` it. When it
    is closed or its last reference is dropped, the motion ends at the last target.
    """

    def __new__(cls, target: Target | None = None) -> Latest: ...
    def set(self, target: Target) -> None:
        """Replaces the target with a pose, `Joints`, or a pair with velocities. Never waits."""
    def close(self) -> None:
        """Ends the motions that follow it, at the last target. Motions of an arm whose deadman is
        silent raise `held`.
        """

@final
class Robot:
    """A robot at an address. `async with Robot(address) as robot:` connects, and shuts down at the
    end: motions are braked. Its methods may be called from any thread.

    When the last reference to a connected robot is dropped, it is braked and closed in the
    background; the exit of the interpreter waits for this.

    Options: `realtime` is `enforce` or `ignore`; `enforce` refuses a host without real-time
    scheduling. `None` uses the environment variable `FRANKA_REALTIME`, or else `enforce`.
    `priority` (1 to 99) and `cpu` apply to the control thread, not to threads of Python. `version`
    is the protocol version, 5 or 10; if `None`, it is negotiated. `connect_timeout` applies to each
    step of connecting. `link_timeout` is the silence of the robot after which a motion fails with
    `link_lost`, 0.02 to 10 s, 1 s by default; longer times are for simulated robots on busy hosts.
    `log_size` is the number of cycles in an error, at most 10000. `nominal_model` uses the vendor's
    constants instead of the robot's description. `accept_geometry_error` connects to a robot whose
    reported poses disagree with its model; `geometry_residual` is the difference. `known` is an
    `Identified` of this arm. `supervise` is a `Policy`, or `True` for the default policy: lost
    connections are restored, and the robot is recovered according to the policy.
    `ask_before_recovery` is called with the `Reflex` before each recovery, on a separate thread,
    and must return `True` to allow it; it implies `ask_first`. `ValueError` for invalid options.
    """

    def __new__(
        cls,
        address: str,
        *,
        realtime: Literal["enforce", "ignore"] | None = None,
        priority: int | None = None,
        cpu: int | None = None,
        version: Literal[5, 10] | None = None,
        connect_timeout: float | None = None,
        link_timeout: float | None = None,
        log_size: int | None = None,
        nominal_model: bool = False,
        accept_geometry_error: bool = False,
        known: Identified | None = None,
        supervise: Policy | bool | None = None,
        ask_before_recovery: Callable[[Reflex], bool] | None = None,
    ) -> Robot: ...
    def connect(self) -> Operation[Robot]:
        """Connects, and returns this robot. If the robot is already connected, nothing changes. Raises
        `ConnectError`. Cancelling aborts the connection.
        """
    def shutdown(self) -> Operation[None]:
        """Brakes and ends any motion, and closes the connection, if there is one. Once begun, it
        continues even if it is cancelled.
        """
    def __aenter__(self) -> Operation[Robot]: ...
    def __aexit__(self, *_exception: object) -> Operation[None]: ...
    @property
    def address(self) -> str:
        """Address of the robot: as given, and resolved once it is connected."""
    @property
    def is_connected(self) -> bool:
        """True if there is a connection, or a supervised robot will be reconnected."""
    @property
    def fci_version(self) -> int:
        """Protocol version of the robot: 10 for a Franka Research 3, 5 for a Franka Emika Robot."""
    @property
    def geometry_residual(self) -> float | None:
        """Difference between the reported pose at connect and the pose of `model()` at the same joint
        positions, m; or a tenth of a metre times the largest difference of an element of their
        rotation matrices, if this is larger. It is at most 2e-6, or an accepted error. `None` if
        the robot reported no pose.
        """
    def state(self) -> RobotState:
        """Newest state, without waiting. After the link is lost, this remains the last received state;
        `health()` shows the loss.
        """
    def states(self, rate: float | None = None) -> Stream[RobotState]:
        """Newest state as it changes, for `async for` or `for`. If `rate` is given, at most `rate`
        states per second, by the robot's clock. If several states arrive while the program is busy,
        only the newest is returned. Ends with the connection.
        """
    def tared_states(self, tare: WrenchTare, rate: float | None = None) -> Stream[TaredState]:
        """The stream of `states()` with each state's wrench minus `tare`, as `TaredState`s."""
    def state_stream(self) -> Stream[Reading]:
        """Every state from now on, each once and in order, for `async for` or `for`: pairs of the
        state and the number of states `missed` before it. No state is missed unless the program is
        more than about a second behind. Ends with the connection.
        """
    def pose(self) -> _Array:
        """Measured pose of the end effector in the base frame, `(4, 4)`, from the newest state."""
    def pose_at(self, q: ArrayLike) -> _Array:
        """Pose of the end effector in the base frame, `(4, 4)`, at joint positions `q`, `(7,)` rad."""
    def reference(self) -> Reference | None:
        """Commanded position of target control in this millisecond: a `Reference`; `None` while target
        control is not active.
        """
    def budget(self) -> Budget:
        """The default limits of a motion: a `Budget`."""
    def margin(self, gains: Gains) -> Margin | None:
        """Margin of gains to the first oscillation of such an arm in its current posture: a `Margin`.
        `None` for gains that are out of range.
        """
    def stop(self) -> Operation[None]:
        """Brakes any motion, and waits until it has ended and a state shows the arm at rest. The
        braked motion raises `MotionError` of the kind `stopped` at once, while the arm still
        brakes. If another task requests a motion meanwhile, this motion begins: `stop` then raises
        `MotionError` of the kind `superseded`. It raises other kinds if the arm was not seen to be
        at rest: `protocol`, `not_at_rest`, `link_lost`, `connection_closed`. If people keep the arm
        in motion for two seconds, the robot's own controller stops it; the wait ends within eight
        seconds. Once begun, it continues even if it is cancelled.
        """
    def latch_stop(self) -> Operation[None]:
        """Stops like `stop`, and latches the stop: until `release_stop`, every motion, session and
        goal of any caller is refused, as `MotionError` of the kind `not_ready`. The latch survives
        reconnects, and stays set even if this call raises. It is not a safety function.
        """
    def release_stop(self) -> bool:
        """Releases a latched stop: motions are allowed again. It does not move the arm. Returns `True`
        if a stop was latched.
        """
    @property
    def is_stop_latched(self) -> bool:
        """True if a stop is latched."""
    def recover(self) -> Operation[None]:
        """Recovers the robot from a reflex, and waits until it accepts motions again. If no recovery
        is needed, nothing happens. It does not command a motion. Raises `CommandError`.
        """
    def move_to(self, target: Destination, **options: Unpack[MotionOptions]) -> Motion:
        """A motion of the end effector to `target` in the base frame. A pose is `(4, 4)`, or 3 + 4
        numbers with a quaternion `x y z w`, which can be a pair. 3 numbers are a position, reached
        with constant orientation. `(3, 3)` or 4 numbers are an orientation. `Joints` are joint
        positions. The path to a pose is a straight line.

        Options of every motion: `speed`, a factor; `limits`, a `Budget`; `gains`, `Gains`;
        `stiffness` at the end effector, 6 numbers; `force_cap`, N, or `None` for off; `leash`,
        `deviation`, `tolerance`, `settling`; `posture`, 7 joint positions; `until`, a condition;
        `start_with`, a `StartTicket`; and `joint_fallback`, true for a joint motion if the arm
        cannot follow the line. Raises `ValueError` for invalid arguments, and `MotionError` when it
        is awaited.
        """
    def replay(
        self,
        recording: RecordingFile,
        *,
        speed: float = 1.0,
        source: Literal["reference", "measured"] = "reference",
        targets: Literal["joints", "poses"] = "joints",
    ) -> Operation[ReplayReport]:
        """Moves to the beginning of a recorded motion, repeats it, and releases the arm. This is
        `Arm.replay` in a session with default options.
        """
    def move_joints(self, q: ArrayLike, **options: Unpack[MotionOptions]) -> Motion:
        """A motion of the joints to `q`, 7 numbers, rad; all joints arrive together. Options as for
        `move_to`.
        """
    def move_by(
        self,
        way: ArrayLike,
        frame: Literal["base", "tool"] = "base",
        from_arm: bool = False,
        **options: Unpack[MotionOptions],
    ) -> Motion:
        """A motion of the end effector relative to its position, or to the target of the current
        motion. The offset is 3 numbers, m, or 6, with a rotation vector, rad, along and about the
        axes of the `base` or the `tool`. With `from_arm` it is always relative to the measured
        position. Options as for `move_to`.
        """
    def move_through(
        self, waypoints: Iterable[Target | Waypoint], blend: float = 0.0, **options: Unpack[MotionOptions]
    ) -> Motion:
        """A motion through several poses, or several `Joints`, to the last of them, without a stop at
        rounded corners: within `blend` (m; rad for joints), or within the blend of each `Waypoint`.
        Options as for `move_to`.
        """
    def follow(
        self,
        targets: Latest | Iterable[Target] | AsyncIterable[Target],
        **options: Unpack[FollowOptions],
    ) -> Follow:
        """Follows the newest of `targets` until they end, and then stops at the last target. A target
        is a pose or `Joints`, alone or in a pair with its velocity. `targets` is a `Latest`, which
        any thread sets; an asynchronous iterator, which runs in the event loop that awaits; or a
        plain iterator, which runs on a separate thread and may wait.

        Options as for `move_to`, and `lead`, a `Lead`: the largest distance of a target ahead of
        the arm; and `watchdog`, a pair of a time in seconds and the reaction, `brake` or `hold`, if
        no target arrives for this time. The motion and the watchdog begin with the first target. An
        exception of the iterator brakes the arm and is raised.
        """
    def engage(self, **options: Unpack[EngageOptions]) -> Engagement:
        """Begins a session that holds the arm in place and moves from goal to goal without a stop in
        between: `async with robot.engage() as arm`, or `arm = await robot.engage()`.

        Options: `speed`, `limits`, `gains`, `force_cap`, `leash`, `deviation`, `posture` as for
        `move_to`, for all goals of the session; `keep_out`, regions (`Plane`, `Box`) that the arm
        must avoid; `speed_cap`, the largest speed of the joints, the flange and the end effector,
        m/s; `deadman`, a `Deadman`; and `backend`, `torques` or a pair of a controller of the robot
        and its setpoints.
        """
    def events(self) -> Stream[Event]:
        """Events of the robot from now on, for `async for`: connections lost and made, reflexes,
        recoveries, user stop, guiding, brakes, motions, loads; see `Event`. Also available for a
        robot without supervision. Ends when the connection has ended permanently.
        """
    def health(self) -> Health:
        """Current health of the robot: readiness for motions, the reason if it is not ready, and
        counts of reconnects and recoveries.
        """
    def health_changes(self) -> Stream[Health]:
        """Health of the robot, now and as it changes, for `async for`. Ends like `events()`."""
    def agree(self, reflex: int, yes: bool = True) -> bool:
        """Approves or rejects the recovery from the reflex with this number, for a `Policy` that asks
        first. Returns `True` if the policy was waiting for the answer. The number is in the event
        and in `health().reflex`.
        """
    def closed(self) -> Operation[CloseReason]:
        """Waits until the connection has ended permanently, and returns the reason: a `CloseReason`.
        Cancelling has no effect on the robot.
        """
    def gripper(self) -> Gripper:
        """The Franka Hand of this robot, at its host and the port after the robot's, not yet
        connected: `async with robot.gripper() as gripper:`. If a simulator listens on a free port,
        its Hand has a different port, and another program could listen at this one. Then use
        `Gripper(sim.hand_address)` of a `Sim` with `hand=True`.
        """
    def vacuum_gripper(self) -> VacuumGripper:
        """The vacuum gripper of this robot, at its host and the second port after the robot's, not yet
        connected, like `gripper()`.
        """
    def set_collision_behavior(self, *thresholds: ArrayLike, **named: ArrayLike) -> Operation[None]:
        """Sets the torques and forces at which the robot reports contact (lower) and stops itself
        (upper).

        Either one of the names `careful` (10 N and 10 N m, for the robot's own controllers),
        `compliant` (60, for an arm that is pushed by hand) and `insensitive` (100, for tasks that
        press); or four arrays: `lower_torque_thresholds`, `upper_torque_thresholds`, `(7,)` N m,
        `lower_force_thresholds`, `upper_force_thresholds`, `(6,)` N and N m; or eight, each of the
        four twice: `..._acceleration` while the arm accelerates, and `..._nominal`, in the order of
        `COLLISION_THRESHOLDS`. Positional or by name. Below about 10 N the friction of an arm
        without contact is enough for a reflex.

        The vendor does not document their ranges. The simulator refuses negative values.

        Raises `ValueError`, `TypeError` and `CommandError`; a moving robot refuses the request.
        Once the request has begun, the robot can execute it even if you cancel.
        """
    def set_joint_impedance(self, stiffness: ArrayLike) -> Operation[None]:
        """Sets the stiffness of the robot's own joint impedance controller, `(7,)` N m/rad, each 0 to
        14250. Raises and is cancelled like `set_collision_behavior`.
        """
    def set_cartesian_impedance(self, stiffness: ArrayLike) -> Operation[None]:
        """Sets the stiffness of the robot's own Cartesian impedance controller in the stiffness frame,
        `(6,)`: x y z, 10 to 3000 N/m, and roll pitch yaw, 1 to 300 N m/rad. Raises and is cancelled
        like `set_collision_behavior`.
        """
    def set_guiding_mode(self, free: Sequence[bool], elbow: bool = True) -> Operation[None]:
        """Sets the free directions in hand guiding: six truth values, x y z and roll pitch yaw, and
        the `elbow`. Raises and is cancelled like `set_collision_behavior`.
        """
    def set_k(self, EE_T_K: ArrayLike) -> Operation[None]:
        """Sets the stiffness frame in the end effector's, `EE_T_K`: a pose. The vendor does not
        document a range; the simulator refuses a distance of more than 2 m. Resolves when a state
        shows it. Raises and is cancelled like `set_collision_behavior`.
        """
    def set_ee(self, NE_T_EE: ArrayLike) -> Operation[None]:
        """Sets the end effector in the nominal end effector's frame, `NE_T_EE`: a pose. Range and
        completion are as for `set_k`. Raises and is cancelled like `set_collision_behavior`.
        """
    def set_load(
        self, mass: float, center: ArrayLike | None = None, inertia: ArrayLike | None = None
    ) -> Operation[None]:
        """Declares the load in addition to the end effector: `mass`, kg; `center` of mass in the
        flange frame, `(3,)` m; `inertia` about it, `(3, 3)` or its nine numbers, kg m^2, zero
        unless given.

        The vendor does not document a range. The simulator refuses more than 10 kg, a centre more
        than 1 m away, and an inertia that is not physical or has a principal moment above 1 kg m^2.
        Resolves when a state shows it. Raises and is cancelled like `set_collision_behavior`.
        """
    def set_filters(
        self,
        *,
        joint_position: float = 1000.0,
        joint_velocity: float = 1000.0,
        cartesian_position: float = 1000.0,
        cartesian_velocity: float = 1000.0,
        controller: float = 1000.0,
    ) -> Operation[None]:
        """Sets the cutoff frequencies of the robot's own low-pass filters, each 1 to 1000 Hz; 1000
        disables a filter. Franka Emika Robot only, and deprecated by the vendor. Raises and is
        cancelled like `set_collision_behavior`; `CommandError` of the kind `request` if the robot
        has no such command.
        """
    def virtual_wall(self, id: int) -> Operation[VirtualWall]:
        """Reads the virtual wall `id` from the configuration in Desk; returns a `VirtualWall`. Franka
        Emika Robot only. Raises `CommandError`, of the kind `request` if the robot has no such
        command.
        """
    def urdf(self) -> Operation[str]:
        """Reads the robot's description; returns URDF text. Franka Research 3 only. Raises
        `CommandError`, of the kind `request` if the robot has no such command.
        """
    def identify(self) -> IdentificationPlan:
        """Plans motions that determine friction and bias of the joints and the load at the flange. In
        each of six poses around the current position, all joints move 0.2 rad back and forth twice,
        at 0.2 rad/s: about a minute in total. The arm does not move before `run()` of the plan is
        awaited. It must have free space, see `reach`, and carry the tool to be identified.
        """
    def tare(self, duration: float = 0.5) -> Operation[WrenchTare]:
        """Averages the robot's estimates of external forces and torques over `duration` seconds of its
        clock (0.02 to 60), and returns a `WrenchTare`. The arm must be at rest and untouched:
        raises `TareError` otherwise, and `ReadError` if states stop arriving. A tare is valid near
        the posture in which it was taken. The arm does not move, and the robot's settings do not
        change; if cancelled, no tare is taken.
        """
    def stats(self) -> dict[str, Any]:
        """Counters and times of the control thread since the connection was made, as a new `dict`;
        without waiting, also during motions.

        Counters: `states`, `commands`, `skipped`, `lost`, `stale`, `foreign`, `malformed`,
        `receive_errors`, `send_errors`, `records_lost`, `states_lost`, `reports_lost`. Times, each
        a `dict` of `count`, `min`, `p50`, `p90`, `p99`, `p999` and `max`, s, `None` before the
        first one; quantiles are exact to 1/16: `interval` between two states, `turnaround` from a
        state to its command, `slack` that is left when a command leaves, `overrun` of those that
        left too late. `worst_cycle` and `newest_overrun` are the times of one cycle, or `None`:
        `time` of the robot's clock, `late`, `turnaround`, `slack` (negative for an overrun),
        `phases` and the `longest` of these. `motion` counts over the motion that runs or ran last,
        or is `None`.
        """
    def granted(self) -> dict[str, Any]:
        """Rights granted to the control thread by the operating system, as a new `dict`: its
        `SCHED_FIFO` `priority` or `None`, `busy_poll` in s or `None`, and `refusals`, texts, under
        `realtime="ignore"`.
        """
    def metrics(self) -> str:
        """The robot's metrics as OpenMetrics text, for Prometheus and compatible tools; the label
        `robot` is its address. `franka_async.metrics.text` is the text of several robots.
        """
    def record(self, columns: Iterable[str], *, longest: float = 3600.0) -> Recording:
        """Records these columns of every cycle, of `record_columns()`, while a `with` or `async with`
        block runs: see `Recording`. It keeps the first `longest` seconds. Raises `ValueError` for
        an unknown column.
        """
    def active_torques(self) -> Operation[ActiveControl]:
        """Begins control by torques, `(7,)` N m, without gravity and friction. Returns an
        `ActiveControl`. The first command is due within a few milliseconds: read at once on the
        controlling thread. Raises `MotionError`, of the kind `busy` while another motion controls
        the arm. Cancelling stops the robot.
        """
    def active_joint_positions(self, controller: Controller = "joint_impedance") -> Operation[ActiveControl]:
        """Begins control by joint positions, `(7,)` rad, for one of the robot's own controllers,
        `joint_impedance` or `cartesian_impedance`; with `external_controller` every command also
        needs torques. Otherwise like `active_torques`.
        """
    def active_joint_velocities(self, controller: Controller = "joint_impedance") -> Operation[ActiveControl]:
        """Begins control by joint velocities, `(7,)` rad/s; otherwise like `active_joint_positions`."""
    def active_cartesian_pose(self, controller: Controller = "joint_impedance") -> Operation[ActiveControl]:
        """Begins control by poses of the end effector in the base frame, `(4, 4)` or 3 + 4 numbers
        with a quaternion `x y z w`; otherwise like `active_joint_positions`.
        """
    def active_cartesian_velocities(self, controller: Controller = "joint_impedance") -> Operation[ActiveControl]:
        """Begins control by twists of the end effector in the base frame, `(6,)` m/s and rad/s;
        otherwise like `active_joint_positions`.
        """
    def asynchronous_joint_positions(
        self, maximum_joint_velocities: ArrayLike | None = None, goal_tolerance: float | None = None
    ) -> Operation[AsynchronousControl]:
        """Begins a motion in which the robot itself moves to sparse joint targets. Returns an
        `AsynchronousControl`. Protocol 10 (Franka Research 3) only, and experimental there.

        `maximum_joint_velocities` are `(7,)` rad/s. A target counts as reached within
        `goal_tolerance`, in rad as Euclidean norm. Raises `MotionError`: `unsupported` with another
        protocol, `busy` while another motion controls the arm. Cancelling stops the robot.
        """
    def run_law(
        self,
        law: Any,
        *,
        command: _Command | None = None,
        elbow: bool = False,
        parameters: ArrayLike | None = None,
        memory: ArrayLike | None = None,
        controller: Controller = "joint_impedance",
        limit_rate: bool | None = None,
        cutoff_frequency: float | None = None,
    ) -> Operation[MotionReport]:
        """Controls by a law without the interpreter in the cycle: a `Law`, or code for one with
        `command`, `elbow`, `parameters` and `memory`. Resolves with a `MotionReport` when the law
        has returned a positive number and the robot has ended the motion.

        `controller` selects the robot's own controller for commands other than torques.
        `limit_rate` enables the limiter: by default on a Franka Emika Robot and not on a Franka
        Research 3, as in the vendor's library. `cutoff_frequency` is the frequency of the low-pass
        filter, Hz; 1000 disables it.

        Raises `MotionError` of the kind `given_up` if the law returned a negative number, which is
        its `code`; of the kind `invalid` for output that is not finite; and `busy` while another
        motion controls the arm. Cancelling stops the robot.
        """
    def model(self) -> Model:
        """The model of the connected arm, used by control. For a Franka Research 3 it comes from the
        robot's description, for a Franka Emika Robot from the constants of its own library.
        """

@final
class Engagement(Operation[Arm]):
    """A session that begins when it is awaited, or entered with `async with`, and is then an `Arm`."""

    def __aenter__(self) -> Engagement: ...
    def __aexit__(self, kind: object = None, *_rest: object) -> Operation[None]: ...

@final
class Arm:
    """A session of target control: the arm is held, and moves from goal to goal without a stop in
    between, for all kinds of goals. Created by `Robot.engage`.

    When its last reference is dropped, the arm brakes and the session ends, in the background;
    `disengage()` does the same and can be awaited. `Robot.stop` or a reflex also ends the session:
    later calls then raise the reason. During the session, motions of the `Robot` itself are refused
    as `busy`.
    """

    def move_to(self, target: Destination, **options: Unpack[MotionOptions]) -> Motion:
        """Like `Robot.move_to`; the arm is then held at the target. Cancelling it brakes and holds the
        arm.
        """
    def replay(
        self,
        recording: RecordingFile,
        *,
        speed: float = 1.0,
        source: Literal["reference", "measured"] = "reference",
        targets: Literal["joints", "poses"] = "joints",
    ) -> Operation[ReplayReport]:
        """Moves to the beginning of the recorded motion, like `move_joints`, and then follows the
        motion of a `RecordingFile`, or of a part from `between`, with all guards of the session.
        Returns a `recording.ReplayReport` once the arm is at rest.

        `speed` is 0.01 to 1, as a share of the recorded speed. `source` is `reference`, the
        commanded positions, or `measured`, the measured positions: for arms that were moved by
        hand. `targets` is `joints`, or `poses`: the hand moves as recorded, but the elbow can
        differ.

        Raises `ReplayError` for a motion that is invalid for this arm, before the arm moves, and of
        the kind `off` if the arm is far from its recorded position; `MotionError`,
        `RecordingError`, `ValueError`. Cancelling brakes the arm.
        """
    def move_joints(self, q: ArrayLike, **options: Unpack[MotionOptions]) -> Motion:
        """Like `Robot.move_joints`; the arm is then held."""
    def move_by(
        self,
        way: ArrayLike,
        frame: Literal["base", "tool"] = "base",
        from_arm: bool = False,
        **options: Unpack[MotionOptions],
    ) -> Motion:
        """Like `Robot.move_by`, relative to the target at which the arm is held; the arm is then held."""
    def move_through(
        self, waypoints: Iterable[Target | Waypoint], blend: float = 0.0, **options: Unpack[MotionOptions]
    ) -> Motion:
        """Like `Robot.move_through`; the arm is then held."""
    def follow(
        self,
        targets: Latest | Iterable[Target] | AsyncIterable[Target],
        **options: Unpack[FollowOptions],
    ) -> Follow:
        """Like `Robot.follow`; the arm is then held at the last target."""
    def hold(self, **options: Unpack[MotionOptions]) -> Motion:
        """Brakes the arm in any motion, and completes when it is at rest; the arm is then held there."""
    def set(self, target: Destination) -> Operation[None]:
        """Moves to `target` from now on, replacing any other goal, and holds it. Accepts the targets
        of `move_to`, and targets with velocities. Completes as soon as the goal is accepted.
        Cancelling does not revoke the goal.
        """
    def try_set(self, target: Destination) -> None:
        """Like `set`, without waiting for an answer: for loops with their own rate, on any thread. If
        goals come faster than they are accepted, the newest counts. Raises `MotionError` for a goal
        that is refused, and for the end of the session.
        """
    def target(self) -> _Array | tuple[_Array, _Array] | Joints | None:
        """The target at which the arm is held or to which it moves: a pose, `(4, 4)`, `Joints`, or a
        pair with the twist. `None` along a chunk, at the beginning, after an aborted goal, and once
        the session has ended.
        """
    def reference(self) -> Reference | None:
        """The commanded position of the arm in this millisecond: a `Reference`; `None` once the
        session has ended.
        """
    def at_rest(self, timeout: float | None = None) -> Operation[bool]:
        """Waits until the arm is at rest at the last accepted target, or where that target was
        aborted; returns `True` if it is. Without a `timeout` it waits indefinitely for an arm that
        is pushed or blocked, or that follows a stream; `False` means that it was not at rest within
        `timeout` seconds. Cancelling has no effect on the arm.
        """
    def chunk(
        self,
        points: ArrayLike | Chunk,
        dt: float | None = None,
        times: ArrayLike | None = None,
        *,
        velocities: ArrayLike | None = None,
        joints: bool = False,
        observed_at: RobotState | int | None = None,
        blend: float | None = None,
    ) -> Operation[None]:
        """Begins to follow points with times, such as a policy's predictions; completes as soon as the
        points are accepted. The arm stops at the last point unless another chunk or goal follows.

        `points` are positions `(N, 3)`, poses `(N, 7)` or `(N, 4, 4)`, or with `joints` joint
        positions `(N, 7)`, rad; or a `Chunk`, whose fields replace the other arguments. `dt` is the
        time between two points, s, or `times` is the time of each point. `velocities` are twists
        `(N, 6)` or joint velocities `(N, 7)`. `observed_at` is the `RobotState` of the policy's
        observation: the times count from this state. `blend` is the time of the transition from the
        previous chunk, 0.1 s by default. A chunk has at most 1024 points and 60 s. Send the rest as
        the next chunk, with the same `observed_at`: this chunk takes effect at the time of its
        first point.

        Raises `ValueError` for invalid arrays. Awaiting raises `MotionError` for a chunk that is
        too late or ends out of reach; the previous chunk then continues. It raises the kind `held`
        or `braked`, once, if the previous chunk was aborted, for example by a silent `Deadman`.
        """
    def guide(self, axes: Sequence[bool] = ..., elbow: bool = True) -> Operation[None]:
        """Allows hand guiding, once the arm is at rest, until the next goal; `hold()` ends the
        guiding. `axes` are the free directions: along x y z and about x y z of the base frame, six
        truth values; the other directions are held. Completes as soon as the request is accepted.
        Declare the load first, or it pulls the arm down.
        """
    def tune(self, **options: Unpack[TuneOptions]) -> Operation[None]:
        """Changes the given options among `gains`, `limits`, `force_cap`, `leash`, `deviation` and
        `posture`, for the current goal and for later goals. Gains change gradually over 0.3 s.
        """
    def disengage(self) -> Operation[MotionReport]:
        """Brakes and releases the arm, ends the session, and returns a `MotionReport`. The motion
        under way raises `stopped`. If the session ended for a different reason, raises this reason.
        """
    def ended(self) -> Operation[MotionReport]:
        """Waits until the session has ended, and returns its report or raises the reason. Cancelling
        has no effect on the arm.
        """
    def __aenter__(self) -> Operation[Arm]: ...
    def __aexit__(self, kind: object = None, *_rest: object) -> Operation[None]: ...

@final
class Deadman:
    """A token that the program must keep alive with `keep_alive()`. If no call comes for `silence`
    seconds (0.01 or more), or the token is released or dropped, the arm that `Robot.engage` bound
    to it brakes and is held. Every goal then raises `held`, as does the next call of `chunk`. The
    control thread monitors the token, independent of Python.
    """

    def __new__(cls, silence: float) -> Deadman: ...
    @property
    def silence(self) -> float:
        """Longest allowed silence, s."""
    def keep_alive(self) -> None:
        """Restarts the time of silence. Any thread may call this. After `release()`, it has no effect."""
    def release(self) -> None:
        """Releases the token: the arm brakes, and is held from then on."""

@final
class Source:
    """The source of the items of `franka_async.streams.Stream`.

    An item is awaited and taken in two steps, so that no item is lost if the wait is cancelled:
    `ready()` waits and changes nothing visible, and `take()` returns at once.
    """

    def ready(self) -> Operation[None]:
        """Resolves when `take()` has an item."""
    def take(self) -> tuple[Any] | None:
        """Next item, as a tuple of one; `None` if another task has taken it. Raises
        `StopAsyncIteration` at the end.
        """

@final
class ControlLog:
    """The last cycles of a motion, oldest first: the robot's states, and the commands before them.

    Every field of `RobotState` is here as one array over the cycles: `log.q` is `(N, 7)`,
    `log.O_T_EE` is `(N, 4, 4)`, `log.time` is `(N,)`. The command sent before each state is
    `log.sent("tau_J_d")`.
    """

    def states(self) -> list[RobotState]:
        """The states, oldest first."""
    def sent(self, name: Literal["tau_J_d", "q_c", "dq_c", "O_T_EE_c", "O_dP_EE_c"]) -> _Array:
        """Command sent before each state, `(N, ...)`; zeros before the first. `name` is `tau_J_d`,
        `q_c`, `dq_c`, `O_T_EE_c` or `O_dP_EE_c`.
        """
    def to_csv(self) -> str:
        """Comma-separated values, one line for each cycle, with libfranka's column names."""
    def __len__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @property
    def q(self) -> _Array:
        """A row for each cycle: Measured joint positions, `(7,)` rad."""
    @property
    def q_d(self) -> _Array:
        """A row for each cycle: Desired joint positions, `(7,)` rad."""
    @property
    def dq(self) -> _Array:
        """A row for each cycle: Measured joint velocities, `(7,)` rad/s."""
    @property
    def dq_d(self) -> _Array:
        """A row for each cycle: Desired joint velocities, `(7,)` rad/s."""
    @property
    def ddq_d(self) -> _Array:
        """A row for each cycle: Desired joint accelerations, `(7,)` rad/s^2."""
    @property
    def tau_J(self) -> _Array:
        """A row for each cycle: Measured link-side joint torques, gravity included, `(7,)` N m."""
    @property
    def tau_J_d(self) -> _Array:
        """A row for each cycle: Desired joint torques, gravity excluded, `(7,)` N m."""
    @property
    def dtau_J(self) -> _Array:
        """A row for each cycle: Derivatives of the measured joint torques, `(7,)` N m/s."""
    @property
    def theta(self) -> _Array:
        """A row for each cycle: Motor positions, `(7,)` rad."""
    @property
    def dtheta(self) -> _Array:
        """A row for each cycle: Motor velocities, `(7,)` rad/s."""
    @property
    def joint_contact(self) -> _Array:
        """A row for each cycle: Contact level of each joint, `(7,)`, 0 or 1."""
    @property
    def joint_collision(self) -> _Array:
        """A row for each cycle: Collision level of each joint until the recovery, `(7,)`, 0 or 1."""
    @property
    def tau_ext_hat_filtered(self) -> _Array:
        """A row for each cycle: Estimated external joint torques, `(7,)` N m."""
    @property
    def cartesian_contact(self) -> _Array:
        """A row for each cycle: Contact level of each Cartesian axis, `(6,)`, 0 or 1."""
    @property
    def cartesian_collision(self) -> _Array:
        """A row for each cycle: Collision level of each Cartesian axis until the recovery, `(6,)`, 0 or 1."""
    @property
    def O_F_ext_hat_K(self) -> _Array:
        """A row for each cycle: Estimated external wrench in the base frame, `(6,)` N and N m, its torque about the origin
        of the base, positive when the robot pushes. Zeros near a singularity.
        """
    @property
    def K_F_ext_hat_K(self) -> _Array:
        """A row for each cycle: Estimated external wrench on the stiffness frame in the stiffness frame, `(6,)` N and N m,
        positive when the robot pushes. Zeros near a singularity.
        """
    @property
    def O_dP_EE_d(self) -> _Array:
        """A row for each cycle: Desired twist of the end effector in the base frame, `(6,)` m/s and rad/s."""
    @property
    def O_dP_EE_c(self) -> _Array:
        """A row for each cycle: Last commanded twist of the end effector in the base frame, `(6,)` m/s and rad/s."""
    @property
    def O_ddP_EE_c(self) -> _Array:
        """A row for each cycle: Last commanded acceleration of the end effector in the base frame, `(6,)` m/s^2 and rad/s^2."""
    @property
    def O_ddP_O(self) -> _Array:
        """A row for each cycle: Acceleration of the base, gravity included, `(3,)` m/s^2."""
    @property
    def F_x_Cee(self) -> _Array:
        """A row for each cycle: Centre of mass of the end effector in the flange frame, `(3,)` m."""
    @property
    def F_x_Cload(self) -> _Array:
        """A row for each cycle: Centre of mass of the load in the flange frame, `(3,)` m."""
    @property
    def elbow(self) -> _Array:
        """A row for each cycle: Measured elbow, `(2,)`: angle of joint 3 in rad and sign of joint 4."""
    @property
    def elbow_d(self) -> _Array:
        """A row for each cycle: Desired elbow, `(2,)`: angle of joint 3 in rad and sign of joint 4."""
    @property
    def elbow_c(self) -> _Array:
        """A row for each cycle: Last commanded elbow, `(2,)`: angle of joint 3 in rad and sign of joint 4."""
    @property
    def delbow_c(self) -> _Array:
        """A row for each cycle: Velocity of the commanded elbow, `(2,)`: velocity of joint 3 in rad/s, then 0."""
    @property
    def ddelbow_c(self) -> _Array:
        """A row for each cycle: Acceleration of the commanded elbow, `(2,)`: acceleration of joint 3 in rad/s^2, then 0."""
    @property
    def O_T_EE(self) -> _Array:
        """A row for each cycle: Measured pose of the end effector in the base frame, `(4, 4)`."""
    @property
    def O_T_EE_d(self) -> _Array:
        """A row for each cycle: Desired pose of the end effector in the base frame, `(4, 4)`."""
    @property
    def O_T_EE_c(self) -> _Array:
        """A row for each cycle: Last commanded pose of the end effector in the base frame, `(4, 4)`."""
    @property
    def F_T_EE(self) -> _Array:
        """A row for each cycle: Pose of the end effector in the flange frame, `(4, 4)`."""
    @property
    def EE_T_K(self) -> _Array:
        """A row for each cycle: Pose of the stiffness frame in the end-effector frame, `(4, 4)`."""
    @property
    def F_T_NE(self) -> _Array:
        """A row for each cycle: Pose of the nominal end effector in the flange frame, `(4, 4)`."""
    @property
    def NE_T_EE(self) -> _Array:
        """A row for each cycle: Pose of the end effector in the nominal end-effector frame, `(4, 4)`."""
    @property
    def I_ee(self) -> _Array:
        """A row for each cycle: Inertia of the end effector about its centre of mass, `(3, 3)` kg m^2."""
    @property
    def I_load(self) -> _Array:
        """A row for each cycle: Inertia of the load about its centre of mass, `(3, 3)` kg m^2."""
    @property
    def m_ee(self) -> _Array:
        """A row for each cycle: Mass of the end effector, kg."""
    @property
    def m_load(self) -> _Array:
        """A row for each cycle: Mass of the load, kg."""
    @property
    def control_command_success_rate(self) -> _Array:
        """A row for each cycle: Share of the last 100 commands that arrived in time, 0 to 1; 0 while no control runs."""
    @property
    def m_total(self) -> _Array:
        """A row for each cycle: Mass of end effector and load, kg."""
    @property
    def F_x_Ctotal(self) -> _Array:
        """A row for each cycle: Common centre of mass of end effector and load in the flange frame, `(3,)` m."""
    @property
    def I_total(self) -> _Array:
        """A row for each cycle: Inertia of end effector and load about their common centre of mass, `(3, 3)` kg m^2."""
    @property
    def accelerometer_top(self) -> _Array:
        """A row for each cycle: Upper accelerometers of joints 1 to 6, `(6, 3)` m/s^2; zero on a Franka Emika Robot."""
    @property
    def accelerometer_bottom(self) -> _Array:
        """A row for each cycle: Lower accelerometers of joints 1 to 6, `(6, 3)` m/s^2; zero on a Franka Emika Robot."""
    @property
    def time(self) -> _Array:
        """A row for each cycle: The robot's clock, s: a thousandth more with each cycle."""
    @property
    def time_ms(self) -> NDArray[np.int64]:
        """A row for each cycle: The robot's clock, ms: one more with each cycle."""
    @property
    def robot_mode(self) -> NDArray[np.str_]:
        """A row for each cycle: Overall mode of the robot: `other`, `idle`, `move`, `guiding`, `reflex`, `user_stopped` or
        `automatic_error_recovery`.
        """
    @property
    def motion_generator_mode(self) -> NDArray[np.str_]:
        """A row for each cycle: The active motion generator."""
    @property
    def controller_mode(self) -> NDArray[np.str_]:
        """A row for each cycle: The active controller."""
    @property
    def current_errors(self) -> list[list[str]]:
        """A row for each cycle: Errors that block the robot now, by the vendor's names."""
    @property
    def last_motion_errors(self) -> list[list[str]]:
        """A row for each cycle: Errors that ended the last motion, by the vendor's names."""

@final
class Condition:
    """A condition: comparisons of quantities, flags of the robot and the time, joined by `&`, `|` and
    `~`. See `franka_async.condition`.
    """

    def __and__(self, other: Condition, /) -> Condition: ...
    def __rand__(self, other: Condition, /) -> Condition: ...
    def __or__(self, other: Condition, /) -> Condition: ...
    def __ror__(self, other: Condition, /) -> Condition: ...
    def __invert__(self) -> Condition: ...
    def __bool__(self) -> bool: ...
    def __eq__(self, other: object, /) -> bool: ...
    def relative(self) -> Condition:
        """Compares the changes since the beginning of the motion instead of the values, in every
        comparison of this condition: for undeclared loads, and for displacements.
        """
    def tared(self, tare: WrenchTare, /) -> Condition:
        """Subtracts a tare from the forces, moments and joint torques of this condition, as returned
        by `await robot.tare()`. The moment is then about the origin of the stiffness frame.
        """
    def held_for(self, seconds: float, /) -> Condition:
        """True once this condition has been true for `seconds` without a break, by the robot's clock."""
    def then(self, target: Target) -> Reaction:
        """Moves to `target`, a pose or `Joints`, once the condition is true; without a target the arm
        stops. The arm turns to the target at once, without waiting for the program.
        """

@final
class Reaction:
    """A condition with the target once it is true: created by `Condition.then(target)`."""

    def __eq__(self, other: object, /) -> bool: ...

@final
class Quantity:
    """A number that changes while the arm moves: compare it with `<`, `<=`, `>` or `>=` to create a
    condition.

    Forces and torques are the robot's estimates, positive where the arm exerts them. Axes are the
    base frame's.
    """

    def above(self, value: float) -> Condition:
        """True while it is at or above `value`: the same as `quantity >= value`."""
    def below(self, value: float) -> Condition:
        """True while it is at or below `value`: the same as `quantity <= value`."""
    def beyond(self, value: float) -> Condition:
        """True while its magnitude is at or above `value`, which must be above zero."""
    def __lt__(self, other: float, /) -> Condition: ...
    def __le__(self, other: float, /) -> Condition: ...
    def __gt__(self, other: float, /) -> Condition: ...
    def __ge__(self, other: float, /) -> Condition: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

FORCE_X: Quantity
FORCE_Y: Quantity
FORCE_Z: Quantity
TORQUE_X: Quantity
TORQUE_Y: Quantity
TORQUE_Z: Quantity
POSITION_X: Quantity
POSITION_Y: Quantity
POSITION_Z: Quantity
VELOCITY_X: Quantity
VELOCITY_Y: Quantity
VELOCITY_Z: Quantity
ANGULAR_VELOCITY_X: Quantity
ANGULAR_VELOCITY_Y: Quantity
ANGULAR_VELOCITY_Z: Quantity
FORCE_NORM: Quantity
TORQUE_NORM: Quantity
LARGEST_JOINT_TORQUE: Quantity
SPEED: Quantity
ANGULAR_SPEED: Quantity

def force_x(newtons: float, /) -> Condition:
    """True while the external force along x is at or beyond `newtons`, in either direction."""
def force_y(newtons: float, /) -> Condition:
    """True while the external force along y is at or beyond `newtons`, in either direction."""
def force_z(newtons: float, /) -> Condition:
    """True while the external force along z is at or beyond `newtons`, in either direction."""
def force(newtons: float, /) -> Condition:
    """True while the external force in any direction is at or beyond `newtons`."""
def torque(newton_metres: float, /) -> Condition:
    """True while the external torque at the end effector about any axis is at or beyond
    `newton_metres`.
    """
def joint_torques(newton_metres: float, /) -> Condition:
    """True while the external torque of any joint is at or beyond `newton_metres`."""
def joint_contact(joint: int, /) -> Condition:
    """True while the robot reports a contact of this joint, 1 to 7."""
def elapsed(seconds: float, /) -> Condition:
    """True from `seconds` after the beginning of the motion on, by the robot's clock."""
def contact() -> Condition:
    """True while the robot reports any contact, of a joint or at the end effector."""
def cartesian_contact() -> Condition:
    """True while the robot reports a contact at the end effector."""
def collision() -> Condition:
    """True while the robot reports any collision."""
def joint_torque(joint: int, /) -> Quantity:
    """External torque of a joint, 1 to 7, N m."""
def joint_position(joint: int, /) -> Quantity:
    """Measured position of a joint, 1 to 7, rad."""
def joint_velocity(joint: int, /) -> Quantity:
    """Measured velocity of a joint, 1 to 7, rad/s."""

_LEASH: tuple[float, float, float]
_DEVIATION: tuple[float, float, float]
_TOLERANCE: tuple[float, float]
_SETTLING: tuple[float, float]
_MARGIN: float

def _gains(name: str) -> dict[str, Any]:
    """Returns the gains with this name, as arguments of `Gains`."""
def _softened(gains: Gains, stiffness: ArrayLike) -> dict[str, Any]:
    """Returns these gains with another stiffness at the end effector, as arguments of `Gains`."""
def _row(name: str, argument: ArrayLike, length: int) -> _Array:
    """Returns a new array of `length` numbers from the argument `name`."""

@final
class Sim:
    """A simulated robot on a free port of this host, from the call until `stop()` or the end of the
    `with` or `async with` block. Its methods release the interpreter, and act between two
    milliseconds of the robot.
    """

    @staticmethod
    def fr3(**options: Unpack[SimOptions]) -> Sim:
        """Starts a Franka Research 3 in the ready pose, with realistic stiction, elasticity and lag of
        the arm.

        Options: `virtual_time`, true if its next millisecond begins with the command, which may
        take up to `patience` seconds (0.5): for tests, and for learning. `patience` alone waits for
        late commands, but is never faster than the wall clock. `arm`, `ideal`, `nominal`,
        `realistic` or `bad`: an exact arm for precise tests, or worse ones; with `arm_seed`, a
        random arm of this kind; `ideal=True` is `arm="ideal"`. `limits`, `5.9` (the default) or
        `before-5.9`: the joint limits of the robot's system, of an FR3. `state_geometry`,
        `recorded` (upper arm 0.3162 m, forearm 0.3842 m; the default unless `ideal`), `described`
        (0.316 m, 0.384 m) or `random` (1 mm and 3 mrad off, by `seed`): the geometry of its own
        poses. `kinematic_error`, `none` or `random` (by `seed`): errors of the true links against
        these poses, instead of the arm's own. `seed` of all other randomness. `q`, joint
        positions at the start, 7 numbers, rad, within the joint ranges. `tool`, `hand` or a tuple
        of its frame on the flange (a pose), its mass, kg, and its centre of mass in the flange
        frame, m: declared to the robot. `load`, a tuple of mass and centre: not declared. `hand`
        serves a Franka Hand and mounts it, `vacuum_gripper` a vacuum gripper, each at a separate
        address: use `Gripper(sim.hand_address)`, because `robot.gripper()` uses the port after the
        robot's, which is the Hand's with `address` only. `network`, a `Network` between robot and
        clients. `address`, the address to listen on; the grippers then listen on the following
        ports, as on a robot. `enforce_limits`, true if commands outside the limits cause a reflex.
        """
    @staticmethod
    def fer(**options: Unpack[SimOptions]) -> Sim:
        """Starts a Franka Emika Robot (Panda). Apart from that, it is like `fr3`."""
    @staticmethod
    def in_step(*kinds: Literal["fr3", "fer"], **options: Unpack[SimOptions]) -> list[Sim]:
        """Starts two to four robots, each `fr3` or `fer`, that begin every millisecond together, and
        returns them in a list. If one robot waits for a command, all robots wait. For several arms
        of one program, especially teams: `left, right = Sim.in_step("fr3", "fer",
        virtual_time=True)`. Options as for `fr3` except `address`; they apply to all robots. If a
        robot was stopped, the other robots do not wait for it.
        """
    @property
    def address(self) -> str:
        """Address of the robot: `host:port`."""
    @property
    def hand_address(self) -> str | None:
        """Address of the Hand; `None` without one."""
    @property
    def vacuum_gripper_address(self) -> str | None:
        """Address of the vacuum gripper; `None` without one."""
    @property
    def waiting(self) -> int:
        """Number of calls with `once_moving=True` that still wait for a motion, without those
        cancelled by `let_go()` or `release()`.
        """
    def state(self) -> RobotState:
        """The newest state, in full precision."""
    def true_pose(self) -> _Array:
        """True pose of the end effector, base frame, `(4, 4)`: the pose that the robot reports can
        deviate, because its joint sensors have errors.
        """
    def stop(self, *, once_moving: bool = False) -> None:
        """Stops the simulation: now or, with `once_moving`, in mid-motion, as in `push`. Connections
        to it are lost. Without effect if it has stopped.
        """
    def __enter__(self) -> Sim: ...
    def __exit__(self, *_exception: object) -> None: ...
    def __aenter__(self) -> Operation[Sim]: ...
    def __aexit__(self, *_exception: object) -> Operation[None]: ...
    def push(
        self,
        force: ArrayLike,
        torque: ArrayLike | None = None,
        *,
        duration: float | None = None,
        once_moving: bool = False,
        at: _Frame = "ee",
        offset: ArrayLike | None = None,
    ) -> Touch:
        """Pushes the arm `at` a frame (`ee`, `flange`, `joint4`, ...), `offset` from its origin in its
        axes, m. The push has a force, base axes, N, and a torque, N m, and lasts for `duration`
        seconds of the robot's clock; if `None`, until it is released. It begins now. With
        `once_moving` it begins in the millisecond in which a joint becomes faster than 0.05 rad/s.
        Use this in virtual time, where a motion can be over before a program sees the arm move.
        Without a motion, the push never begins: see `waiting`.
        """
    def push_joints(self, torques: ArrayLike, *, duration: float | None = None, once_moving: bool = False) -> Touch:
        """Pushes the joints with torques, 7 numbers, N m. Apart from that, it is like `push`."""
    def pull(
        self,
        to: ArrayLike,
        stiffness: float,
        *,
        duration: float | None = None,
        once_moving: bool = False,
        at: _Frame = "ee",
        offset: ArrayLike | None = None,
    ) -> Touch:
        """Pulls the arm to the point `to`, base frame, m, with a spring of this stiffness, N/m;
        otherwise like `push`.
        """
    def hold(
        self,
        *,
        duration: float | None = None,
        once_moving: bool = False,
        at: _Frame = "ee",
        offset: ArrayLike | None = None,
    ) -> Touch:
        """Grips the arm firmly in its current place; otherwise like `push`."""
    def block(self, joint: int, *, duration: float | None = None, once_moving: bool = False) -> Touch:
        """Blocks a joint, 1 to 7, at its current angle."""
    def wall(
        self,
        point: ArrayLike,
        normal: ArrayLike,
        *,
        duration: float | None = None,
        once_moving: bool = False,
        at: _Frame = "ee",
        offset: ArrayLike | None = None,
    ) -> Touch:
        """Places a wall for the end effector: through `point`, base frame, m, with an outward
        `normal`.
        """
    def let_go(self) -> None:
        """Ends every touch, and cancels all that wait for the arm to move."""
    def press_user_stop(self, pressed: bool = True, *, once_moving: bool = False) -> None:
        """Presses the user stop, or releases it; `once_moving` as in `push`."""
    def activate_safety_function(self, active: bool = True) -> None:
        """Activates a safety function that forbids motion, as configured in Desk, or deactivates it."""
    def guide(self, pressed: bool = True) -> bool:
        """Presses the guiding buttons, or releases them. Returns `True` if the arm is then guided."""
    def lock(self, closed: bool = True) -> None:
        """Closes the brakes of the joints, or opens them, as Desk locks and unlocks a robot."""
    def freeze(self, what: Literal["joints", "controllers"] | None = "joints") -> None:
        """Makes the arm ignore its commands while the robot reports the motion and no error: its
        `"joints"` do not move, or its `"controllers"` accept nothing; `None` ends this.
        """
    def trip(self, error: str, *, once_moving: bool = False) -> None:
        """Raises an error of the robot, by the vendor's name, such as `cartesian_reflex`: the robot
        stops itself. `once_moving` as in `push`.
        """
    def recover_manually(self) -> None:
        """Performs the recovery that needs a person."""
    def place(self, q: ArrayLike) -> None:
        """Places the arm at joint positions, 7 numbers, rad, at rest. Raises `ValueError` for
        impossible positions.
        """
    def attach(self, mass: float, center: ArrayLike, inertia: ArrayLike | None = None) -> None:
        """Attaches an undeclared body to the flange, replacing the previous one: mass, kg, centre of
        mass in the flange frame, m, and inertia about it, `(3, 3)` kg m^2.
        """
    def place_object(self, width: float) -> None:
        """Places an object of this width, m, between the fingers of the Hand. Raises `ValueError` if
        it does not fit, or if there is no Hand.
        """
    def place_part(self) -> None:
        """Places a part in front of the vacuum gripper. Raises `ValueError` if there is no vacuum
        gripper.
        """

@final
class Touch:
    """A contact with the arm of a simulated robot, created by the methods of `Sim`."""

    def release(self) -> bool:
        """Ends it, also before it has begun. Returns `True` if it still existed."""
    def felt(self) -> _Array | None:
        """The wrench that it currently exerts on the arm, base axes, `(6,)` N and N m; `None` if it is
        over, has not begun, or acts on joints.
        """

def from_xyzw(position: ArrayLike, quaternion: ArrayLike) -> _Array:
    """Returns the pose, `(4, 4)`, of a position, 3 numbers, m, and a quaternion `x y z w` of any
    non-zero length.
    """
def to_xyzw(pose: ArrayLike) -> tuple[_Array, _Array]:
    """Returns the position, `(3,)` m, and the quaternion, `(4,)` `x y z w` of length 1 with w >= 0, of
    a pose, `(4, 4)`.
    """
def rotated(pose: ArrayLike, rotation_vector: ArrayLike, frame: Literal["base", "tool"] = "base") -> _Array:
    """Returns the pose, `(4, 4)`, rotated by a rotation vector, 3 numbers, rad, about the axes of the
    `base`, or of the `tool`, through its position, which stays the same.
    """

COLLISION_THRESHOLDS: list[str]

@final
class Gripper:
    """A Franka Hand, with its own connection in addition to the robot's.

    `async with Gripper(address) as gripper:` connects, and disconnects at the end; `await
    gripper.connect()` does so without a block. On threads without an event loop, use `.wait()` in
    place of `await`. A grasped object stays grasped when the connection ends.

    One action runs at a time. A newer action, or `stop()` from any task or thread, aborts it; it
    then raises `ActionError` of the kind `aborted`. Cancelling the task that awaits an action, or a
    timeout around it, stops the fingers. An action has no deadline: a move that an obstacle blocks
    takes minutes. Waiting for an action releases the interpreter.
    """

    def __new__(cls, address: str) -> Gripper: ...
    @property
    def address(self) -> str:
        """Address: as given, and resolved once it is connected."""
    @property
    def is_connected(self) -> bool:
        """True if there is a connection. A lost connection counts until `disconnect()`."""
    def connect(self) -> Operation[Gripper]:
        """Connects, and returns this object; without effect while it is connected. Raises
        `ConnectError`. Cancelling aborts the connection.
        """
    def disconnect(self) -> Operation[None]:
        """Closes the connection, without waiting. A running action is stopped. Without effect
        if there is no connection.
        """
    def __aenter__(self) -> Operation[Gripper]: ...
    def __aexit__(self, *_exception: object) -> Operation[None]: ...
    def state(self) -> GripperState:
        """Newest state, without waiting."""
    def states(self) -> Stream[GripperState]:
        """Newest state as it changes, for `async for`. Ends with the connection."""
    def homing(self) -> Operation[bool]:
        """Determines the largest opening of the fingers, `max_width` of the state; returns `True` on
        success. Needed once after power-on and after a change of fingers. Raises `ActionError`;
        cancelling stops the fingers.
        """
    def move_to(self, width: float, speed: float = 0.1) -> Operation[bool]:
        """Moves the fingers to `width`, m, at `speed`, m/s (the Hand's largest speed is 0.1, and
        higher values are not refused); returns `True` if they arrived. Raises `ActionError`;
        cancelling stops the fingers.
        """
    def grasp(
        self,
        width: float,
        speed: float = 0.1,
        force: float = 20.0,
        epsilon_inner: float = 0.005,
        epsilon_outer: float = 0.005,
    ) -> Operation[bool]:
        """Closes the fingers on an object of this `width`, m, at `speed`, m/s, and holds it with
        `force`, N. Returns `True` if they ended at most `epsilon_inner` narrower and
        `epsilon_outer` wider, m. The force stays applied in both cases, until the next action or
        `stop()`. Raises `ActionError`; cancelling stops the fingers and releases the object.
        """
    def stop(self) -> Operation[bool]:
        """Stops the fingers and releases the object; returns `True` on success. The running action
        raises `ActionError`. Once begun, the stop continues even if it is cancelled.
        """

@final
class GripperState:
    """The state of a Franka Hand. It is immutable."""

    @property
    def width(self) -> float:
        """Distance of the fingers, m."""
    @property
    def max_width(self) -> float:
        """Largest distance of the fingers, m, from the last homing."""
    @property
    def is_grasped(self) -> bool:
        """True if the Hand holds an object of the requested width."""
    @property
    def temperature(self) -> int:
        """Temperature of the Hand, degrees Celsius."""
    @property
    def time(self) -> float:
        """The Hand's clock, s."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class VacuumGripper:
    """A vacuum gripper, with its own connection in addition to the robot's. Connection, actions and
    their ends work as for `Gripper`; cancelling an action stops the pump.
    """

    def __new__(cls, address: str) -> VacuumGripper: ...
    @property
    def address(self) -> str:
        """Address: as given, and resolved once it is connected."""
    @property
    def is_connected(self) -> bool:
        """True if there is a connection. A lost connection counts until `disconnect()`."""
    def connect(self) -> Operation[VacuumGripper]:
        """Connects, and returns this object; without effect while it is connected. Raises
        `ConnectError`. Cancelling aborts the connection.
        """
    def disconnect(self) -> Operation[None]:
        """Closes the connection, without waiting. A running action is stopped. Without effect
        if there is no connection.
        """
    def __aenter__(self) -> Operation[VacuumGripper]: ...
    def __aexit__(self, *_exception: object) -> Operation[None]: ...
    def state(self) -> VacuumGripperState:
        """Newest state, without waiting."""
    def states(self) -> Stream[VacuumGripperState]:
        """Newest state as it changes, for `async for`. Ends with the connection."""
    def vacuum(self, vacuum: int, timeout: float, profile: int = 0) -> Operation[bool]:
        """Picks up an object and holds it; returns `True` if the vacuum was reached within `timeout`
        seconds, which are sent in whole milliseconds. `vacuum` is in units of 10 mbar, 0 to 255;
        `profile` is a production set-up profile of the device, 0 to 3. Raises `ActionError`;
        cancelling stops the pump.
        """
    def drop_off(self, timeout: float) -> Operation[bool]:
        """Drops the object; returns `True` if this succeeded within `timeout` seconds. Raises
        `ActionError`; cancelling stops the pump.
        """
    def stop(self) -> Operation[bool]:
        """Stops the current action, which raises `ActionError`; returns `True` on success. Once begun,
        the stop continues even if it is cancelled.
        """

@final
class VacuumGripperState:
    """The state of a vacuum gripper. It is immutable."""

    @property
    def in_control_range(self) -> bool:
        """True if the vacuum is within its range."""
    @property
    def part_detached(self) -> bool:
        """True if the object has been dropped off."""
    @property
    def part_present(self) -> bool:
        """True if the gripper holds an object."""
    @property
    def device_status(self) -> str:
        """The status light: `green`, `yellow` (warnings), `orange` (severe ones), `red` (does not
        work) or `unknown`.
        """
    @property
    def actual_power(self) -> int:
        """Power of the pump, per cent."""
    @property
    def vacuum(self) -> int:
        """Vacuum, mbar."""
    @property
    def time(self) -> float:
        """The gripper's clock, s."""
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class IdentificationPlan:
    """Motions that identify an arm. `str()` is a line for each of them."""

    @property
    def waypoints(self) -> _Array:
        """The joint positions of the motions, `(n, 7)` rad, one row for each; the last one is the
        current position.
        """
    @property
    def duration(self) -> float:
        """Approximate duration, s."""
    @property
    def reach_of_joints(self) -> _Array:
        """Largest displacement of each joint from its current position, in either direction, `(7,)`
        rad.
        """
    @property
    def reach(self) -> float:
        """Largest displacement of the end effector from its current position, m."""
    @property
    def reach_down(self) -> float:
        """Largest downward displacement of the end effector, base frame, m."""
    def run(self) -> Operation[Identified]:
        """Moves the arm, and returns an `Identified`. The robot's settings do not change: pass the
        result to `Robot(address, known=...)` of later connections, and declare the load with
        `set_load` if needed. Raises `MotionError`, and `IdentifyError` if the arm has moved since
        the plan, or was held or pushed. Cancelling brakes the arm and discards the measurement.
        """

@final
class Identified:
    """The identified parameters of one arm: friction and bias of its joints, and the load at its
    flange. `str()` is a readable table.
    """

    @property
    def kind(self) -> str:
        """The kind of the robot: `fr3` or `fer`."""
    @property
    def friction(self) -> _Array:
        """Friction of each joint at 0.2 rad/s, in addition to the robot's own compensation, `(7,)` N
        m.
        """
    @property
    def friction_deviation(self) -> _Array:
        """Standard deviation of `friction`, `(7,)` N m."""
    @property
    def bias(self) -> _Array:
        """Torque that each joint needs in both directions and in every pose, `(7,)` N m."""
    @property
    def bias_deviation(self) -> _Array:
        """Standard deviation of `bias`, `(7,)` N m."""
    @property
    def mass(self) -> float:
        """Mass at the flange in addition to the configured end effector, kg. It includes a declared
        load.
        """
    @property
    def mass_deviation(self) -> float:
        """Standard deviation of `mass`, kg."""
    @property
    def center(self) -> _Array | None:
        """Its centre of mass in the flange frame, `(3,)` m; `None` if the mass is less than three of
        its deviations, and the centre therefore unknown.
        """
    def to_json(self) -> str:
        """All values as text, for `from_json`."""
    @staticmethod
    def from_json(text: str) -> Identified:
        """Parses the output of `to_json`. Raises `ValueError` for other text and implausible numbers."""
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class WrenchTare:
    """The robot's estimate for an untouched arm at rest, to be subtracted later. It is valid near the
    posture in which it was taken.
    """

    NEAR: float
    @property
    def wrench(self) -> _Array:
        """Force, then moment about the origin of the stiffness frame, in axes of the base, `(6,)` N
        and N m.
        """
    @property
    def deviation(self) -> _Array:
        """Standard deviation of `wrench` over the average, `(6,)` N and N m."""
    @property
    def joint_torques(self) -> _Array:
        """External joint torques, `(7,)` N m."""
    @property
    def q(self) -> _Array:
        """Joint positions of the tare, `(7,)` rad."""
    @property
    def states(self) -> int:
        """Number of averaged states."""
    def compensate(self, state: RobotState) -> _Array | None:
        """The wrench of a state minus the tare: force, then moment about the origin of the stiffness
        frame, in axes of the base, `(6,)` N and N m, positive when the arm pushes. `None` if the
        robot has no estimate, near a singularity.
        """
    def compensate_torques(self, state: RobotState) -> _Array:
        """The external joint torques of a state minus the tare, `(7,)` N m."""
    def turned(self, state: RobotState) -> float:
        """Largest change of a joint since the tare, rad: beyond `NEAR`, take a new tare."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class Recording:
    """Columns of every cycle: `with robot.record(["q", "tau_c"]) as recording:` begins, and the end of
    the block ends it. `recording["q"]` is an array of one row for each cycle, `recording["time"]`
    its time, s.

    The data is collected without the interpreter, so nothing is lost while Python is busy. The
    columns of a state and of the control thread for the same cycle are in the same row. The
    recording can be read while it runs.
    """

    def __enter__(self) -> Recording: ...
    def __exit__(self, *_exception: object) -> None: ...
    def __aenter__(self) -> Operation[Recording]: ...
    def __aexit__(self, *_exception: object) -> Operation[None]: ...
    def keys(self) -> list[str]:
        """Names of the columns, `time` first."""
    def __contains__(self, name: object, /) -> bool: ...
    def __iter__(self) -> Iterator[str]: ...
    def __getitem__(self, name: str, /) -> _Array: ...
    def arrays(self) -> dict[str, _Array]:
        """All columns, a new `dict` of arrays."""
    def __len__(self) -> int: ...
    @property
    def lost(self) -> int:
        """Number of missing cycles since the beginning: their states did not arrive, were skipped by
        the control thread for a newer one, or came after the longest time.
        """
    def save(self, path: str | PathLike[str]) -> None:
        """Writes all columns to a file, `.npz`: `numpy.load(path)["q"]`."""

@final
class Recorder:
    """Records robots to a file, with every cycle and every request: `async with
    Recorder.to_file("run.mcap") as recorder:`, and in it `await recorder.attach(robot)`. The end of
    the block ends the recording and waits until it is on the disk.

    Separate threads write the file, without the interpreter. The recorder cannot delay a cycle:
    data without space is dropped and counted. Without a block, `await recorder.finish()` ends it.
    When its last reference is dropped it ends in the background, possibly without the newest
    events; after the exit of the interpreter, the data written by then is readable.
    """

    @staticmethod
    def to_file(path: str | PathLike[str], **options: Unpack[RecordOptions]) -> Recorder:
        """Begins a recording in a new MCAP file at `path`, whose folder must exist.

        Options: `thinned`, true to keep the full rate only around notable cycles (reflexes,
        contacts, failures), and otherwise every tenth cycle. `flush`, the longest time between two
        writes, 0.01 to 1 s (1): the largest loss in a crash. `sync`, true to force each write to
        the disk, against power failures (`True`). `rotate_bytes` and `rotate_time`, s: when to
        begin a new file, `run-0002.mcap` after `run.mcap`. `metadata`, a `dict` of texts, and
        `attachments`, a `dict` of file names and bytes, are stored in the file. `black_box`, a
        `recording.BlackBox`, also writes the last seconds before an incident to a separate file.

        Raises `RecordError` if the file exists or cannot be created, `ValueError`.
        """
    @staticmethod
    def black_box(
        directory: str | PathLike[str], *, before: float = 30.0, after: float = 1.0, keep: int = 20
    ) -> Recorder:
        """Keeps only the last `before` seconds, 1 to 300, in memory. When a motion ends because of a
        reflex, a lost link or a guard, it writes them to a file in `directory`, together with the
        following `after` seconds, at most 60. The file is named by time, robot and cause. The
        newest `keep` files are kept.

        Raises `RecordError`, `ValueError`.
        """
    def attach(
        self, robot: Robot, name: str = "", *, with_address: bool = False, capacity: int | None = None
    ) -> Operation[None]:
        """Records a connected robot from now on: every cycle, goals and their outcomes, diagnoses,
        events and requests; if the robot is supervised, also after a reconnect. `name`, of letters,
        digits, `-` and `_`, distinguishes the robots of a recording. `with_address` stores the
        network address. `capacity` is the number of cycles that may wait for the recorder, 4096 by
        default. Raises `RecordError`, `ValueError`. Cancelling aborts it.
        """
    def attach_team(
        self, team: Team, names: Sequence[str], *, with_address: bool = False, capacity: int | None = None
    ) -> Operation[None]:
        """Records the robots of a team, each with its name and its member number; otherwise like
        `attach`. If an error concerns one robot, the previous ones are recorded.
        """
    def attach_gripper(self, gripper: Gripper | VacuumGripper, robot: str = "") -> None:
        """Records an end effector, a connected `Gripper` or `VacuumGripper`, with the robot of this
        name: its states, and completed actions. Raises `RecordError` unless that robot is attached.
        """
    def note(self, text: str) -> None:
        """Records a remark, for all robots. Raises `RecordError` if the recording has ended."""
    def episode(self, name: str, *, task: str) -> EpisodeUnderWay:
        """An episode, an attempt at a task, while a `with` block runs: `with
        recorder.episode("pick-1", task="pick the cube") as episode:`. The block sets
        `episode.success` to `True` or `False`. Otherwise it is `None`, not judged, or `False` if
        the block raises. One episode runs at a time. `name` has letters, digits, `-` and `_`;
        raises `ValueError`.
        """
    def status(self) -> RecordStatus:
        """Progress and failures of the recording, a `recording.RecordStatus`."""
    def finish(self) -> Operation[RecordStatus]:
        """Ends the recording and waits, at most 10 s, until all of it is on the disk, including the
        events before the call. Returns the `recording.RecordStatus`, also if it has already ended.
        Raises `RecordError` if the files could not be completed; the written data is readable. Once
        begun, it continues even if it is cancelled.
        """
    def __aenter__(self) -> Operation[Recorder]: ...
    def __aexit__(self, kind: object = None, *_rest: object) -> Operation[None]: ...

@final
class EpisodeUnderWay:
    """An episode of a recording: `with recorder.episode(name, task=task) as episode:`."""

    @property
    def name(self) -> str:
        """Its name."""
    @property
    def task(self) -> str:
        """Description of the task."""
    @property
    def success(self) -> bool | None:
        """Success of the task; `None` until it is set."""
    @success.setter
    def success(self, success: bool | None, /) -> None: ...
    def __enter__(self) -> EpisodeUnderWay: ...
    def __exit__(self, kind: object = None, *_rest: object) -> None: ...

@final
class RecordingFile:
    """The recording of a robot in a file, or a part of its time, as returned by
    `RecordingFile.open("run.mcap")`.

    Data is read on request only, and only the requested part. Reading releases the interpreter.
    `column("q")` is an array with a row for each cycle; `for cycle in recording:` provides the
    whole state of each. A damaged part raises `RecordingError`.

    Times in the file are this computer's clock, whole nanoseconds since 1970.
    """

    @staticmethod
    def open(path: str | PathLike[str]) -> RecordingFile:
        """Opens a recording. A recording without an end is read up to the last whole part: see
        `damage`. Raises `RecordingError`.
        """
    @staticmethod
    def recover(damaged: str | PathLike[str], whole: str | PathLike[str]) -> Recovery:
        """Writes the intact parts of the file `damaged` to a new file, with the missing index. Returns
        a `recording.Recovery`. Raises `RecordingError`.
        """
    @property
    def damage(self) -> str | None:
        """Damage of the file, after a crash, a power failure or on a full disk; `None` if it is
        complete. The flushed data can still be read.
        """
    @property
    def span(self) -> tuple[int, int] | None:
        """Times of the first and the last message of the file; `None` if it has no messages."""
    @property
    def metadata(self) -> dict[str, str]:
        """Metadata of the whole recording: versions, host, kernel, options."""
    @property
    def robots(self) -> list[RecordedRobot]:
        """The robots of the file, each a `recording.RecordedRobot`."""
    def model(self) -> Model:
        """The model of the robot, with the limits of its attached description. Raises `ValueError` if
        the file does not name the kind of robot.
        """
    def attachments(self) -> list[str]:
        """Names of the attached files."""
    def attachment(self, name: str) -> bytes | None:
        """Returns the bytes of an attached file; `None` if no file has this name, or it is damaged."""
    def robot(self, name: str) -> RecordingFile:
        """The recording of the robot with this name, if there are several. Raises `RecordingError`."""
    def between(self, begin: int | None = None, end: int | None = None) -> RecordingFile:
        """The part from one time to another, both included; `None` means no bound."""
    def resampled(self, rate: float) -> RecordingFile:
        """The recording at `rate` cycles per second of the robot's clock, at most 1000: at each time
        the newest cycle before it. Events and grippers are unchanged.
        """
    def __iter__(self) -> Iterator[RecordedCycle]: ...
    def column(self, name: str) -> NDArray[Any]:
        """Returns a column as a new array with a row for each cycle: one of `recording_columns()`, or
        `time`, the robot's clock, s, or `host_time`. Raises `ValueError`.
        """
    def columns(self, names: Sequence[str]) -> dict[str, NDArray[Any]]:
        """Returns columns as new arrays, in one pass: a `dict` by name, `time` and `host_time`
        included.
        """
    def events(self) -> list[RecordedEvent]:
        """The events, oldest first: a list of `recording.RecordedEvent`."""
    def episodes(self) -> list[Episode]:
        """The episodes, in their order: a list of `recording.Episode`. An episode without an end is
        left out.
        """
    def gripper_states(self) -> list[tuple[int, GripperState | VacuumGripperState]]:
        """The gripper's states, oldest first: a list of tuples of time and `GripperState` or
        `VacuumGripperState`.
        """
    def to_csv(self, path: str | PathLike[str], columns: Sequence[str] | None = None, *, units: bool = True) -> int:
        """Writes a table as comma-separated text, one line for each cycle, and returns the number of
        cycles. The first columns are `time`, ms of the robot's clock, and `host_time`; then these
        columns of `recording_columns()`, or all. The file gets its name once it is complete, and
        never replaces another. With `units` the first line contains the units. Raises
        `ExportError`, `ValueError`.
        """
    def to_parquet(self, path: str | PathLike[str], columns: Sequence[str] | None = None) -> int:
        """Writes a Parquet table, one row for each cycle, and returns the number of cycles; columns as
        for `to_csv`. The metadata of the file contains the units, as JSON with the key `units`. The
        file gets its name once it is complete, and never replaces another. Raises `ExportError`,
        `ValueError`.
        """
    def to_lerobot(
        self,
        folder: str | PathLike[str],
        *,
        fps: int = 30,
        robot_type: str | None = None,
        gripper: bool | None = None,
        action: Literal["reference", "measured"] = "reference",
        append: bool = False,
        episodes: Sequence[str] | None = None,
    ) -> tuple[int, int]:
        """Writes the episodes as a dataset in LeRobot's layout v3.0 to `folder`, which must not exist
        or be empty; returns the numbers of episodes and frames. `append` adds them to an existing
        dataset: twice, if the same recording is given twice. `fps` are frames per second.
        `robot_type` is `franka_fr3` or `franka_fer` unless given. `gripper` includes the width in
        states and actions; the default is true if the recording contains a Hand. `action` is
        `reference`, the commanded position at the next frame, or `measured`, the measured one: for
        demonstrations by hand. `episodes` are the names of the episodes to write; all by default.
        Raises `ExportError`, `ValueError`; an existing dataset is then unchanged.
        """

@final
class _Cycles:
    """The cycles of a recording, one after the other. After an error `next()` continues behind the
    damage.
    """
    def __iter__(self) -> _Cycles: ...
    def __next__(self) -> RecordedCycle: ...

@final
class RecordedCycle:
    """One cycle of a recording."""

    @property
    def host_time(self) -> int:
        """Time at which this computer received the state, ns since 1970."""
    @property
    def state(self) -> RobotState:
        """The robot's state. Fields that are not recorded are zero."""
    def __getitem__(self, name: str, /) -> Any: ...

def explain(of: RecordingFile | ControlError | ControlLog) -> Explanation:
    """Explains why a motion ended, from a `RecordingFile` or a part of one, from a `ControlError`, or
    from its log. It explains the last motion that the robot stopped, a guard aborted or a lost link
    ended; without such an end, it covers the time up to the newest cycle. Raises `TypeError`, and
    `ValueError` for a recording that does not name its kind of robot.
    """

@final
class Explanation:
    """The explanation of a series of cycles and of the end of a motion, returned by `explain`. `print`
    shows a report of one page, a notebook also the figure. Times are the robot's clock, ms.
    """

    @property
    def robot(self) -> str:
        """The robot, `fr3` or `fer`."""
    @property
    def fallback(self) -> str | None:
        """Reason why the limits are the constants for systems before 5.9; `None` if they are the
        robot's own.
        """
    @property
    def cycles(self) -> int:
        """Number of cycles."""
    @property
    def first_ms(self) -> int:
        """The first cycle."""
    @property
    def last_ms(self) -> int:
        """The last cycle."""
    @property
    def end_ms(self) -> int:
        """The cycle that shows the end of the last motion that the robot stopped, a guard aborted or a
        lost link ended. For a guard, it is the cycle in which the arm was at rest. Without such an
        end, it is the last cycle.
        """
    @property
    def end_host_time(self) -> int | None:
        """Time at which this host received that cycle, ns since 1970:
        `recording.between(end=end_host_time - 1)` contains the part before it. `None` if unknown.
        """
    @property
    def earlier(self) -> int:
        """Number of earlier ends of this kind."""
    @property
    def under_way(self) -> int | None:
        """The newest goal whose end was not recorded, if no end of a motion was found."""
    @property
    def failed(self) -> str | None:
        """Text of the last goal if it failed on its own, for example after a user stop or at an
        obstacle; `None` if it did not fail.
        """
    @property
    def cause(self) -> str | None:
        """Reason for the end of that motion, as text: the exceeded limit, its causes, and the
        recommended changes; `None` without such an end.
        """
    @property
    def errors(self) -> list[str]:
        """The errors named by the robot; empty if a guard or a lost link ended the motion."""
    @property
    def findings(self) -> dict[str, Any] | None:
        """The diagnosis as data, as in `ControlError`; `None` if unknown."""
    @property
    def timeline(self) -> list[Moment]:
        """The changes, oldest first: a list of `explanation.Moment`."""
    @property
    def margins(self) -> dict[str, Approach]:
        """The smallest distance from each limit, an `explanation.Approach` by quantity: `position`,
        `velocity` and `torque` of joints, `translation` and `rotation` of the end effector.
        """
    @property
    def peaks(self) -> dict[str, Peak]:
        """The largest values, an `explanation.Peak` by quantity: `external_torque`, `force`,
        `following_error`.
        """
    @property
    def contact(self) -> Contact | None:
        """The contact at the end of the motion, an `explanation.Contact`; `None` if the torques do not
        determine it: `contact_unknown` contains the reason.
        """
    @property
    def contact_unknown(self) -> str | None:
        """Reason why the contact is uncertain or unknown; `None` if it is known."""
    @property
    def lost(self) -> int:
        """Number of lost states."""
    @property
    def late(self) -> int:
        """Number of commands that left after the next state was due."""
    def svg(self) -> str:
        """The last second before the end as an SVG image: contact torques, velocities and torques
        relative to their limits, the events, and the place of the contact on the arm. It has no
        background, and its colours are distinguishable on white and on black.
        """
    def _repr_html_(self) -> str:
        """The content of a notebook cell: the figure and the report."""

def recording_columns() -> dict[str, tuple[str, tuple[int, ...]]]:
    """The columns of recordings in files: a `dict` of each column's name to its unit and shape in one
    cycle.
    """
def record_columns() -> dict[str, tuple[str, tuple[int, ...]]]:
    """The columns that can be recorded: a `dict` of each column's name to its unit and shape in one
    cycle.
    """
def enable_logging(level: int | str | None = None, *, queue: int = 4096) -> None:
    """Forwards the reports of the driver and the simulator to Python's `logging` from now on, to
    loggers below `franka_async`, such as `franka_async.bridge`.
    `logging.getLogger("franka_async").setLevel(...)` and handlers filter them as usual. Off by
    default: without this call, nothing is forwarded.

    Reports below `level` are not created: `trace`, `debug`, `info`, `warning` or `error`, in any
    case, or a number of `logging`; a later call changes it. The message and the record's `fields`,
    a `dict`, contain the data of an event and of the spans around it; `record.rust_target` is the
    module. `trace` is the number 5.

    A separate thread forwards them, so no motion waits for it. If more than `queue` reports wait
    (the value of the first call), new reports are dropped; a later warning contains the number of
    dropped reports.

    Raises `ValueError` for another level, and `RuntimeError` if another library in the process
    already receives Rust's reports.
    """
def _check_policy(policy: Policy) -> None:
    """Raises `ValueError` for an invalid policy."""

_METRICS_CONTENT_TYPE: str

def _metrics(robots: Sequence[tuple[str, Robot]]) -> str:
    """Returns the metrics of the connected robots, each with its value of the label `robot`, as one
    text.
    """
def _names() -> dict[str, dict[str, list[str]]]:
    """Returns all names, for the tests, which compare them with the types of Python and with the book:
    `errors` by class, `variants` by enum in the book, `values` by type in Python.
    """

@final
class StartTicket:
    """The part of one motion in a common start: created by `start_tickets`. If it is dropped before
    the start, the other motions fail.
    """

def start_tickets(members: int, timeout: float = 10.0) -> list[StartTicket]:
    """Tickets of a common start, a list of one for each of `members` motions. `left.move_to(a,
    start_with=tickets[0])` and `right.move_to(b, start_with=tickets[1])`, awaited together, begin
    within a millisecond of each other, once all robots are ready. Such a motion supersedes nothing.
    If the other motions are not ready within `timeout` seconds, or a ticket is dropped before the
    start, each motion raises `MotionError` of the kind `start`, and no arm has moved.
    """

@final
class Team:
    """Two to four arms that move and stop together: `async with await Team.engage(left, right) as
    team:`. Their motions begin within a millisecond of each other, and a fault of one arm brakes
    the other arms within two cycles of their control threads, independent of Python.

    A team motion returns a list of one `MotionReport` for each arm. If an arm has not arrived, the
    motion raises `TeamError` with `outcomes`, one for each arm; the error of the arm at fault is
    the `TeamError`'s cause. Cancelling a team motion brakes all arms. When the last reference to
    the team and its arms is dropped, all arms brake and their sessions end.
    """

    @staticmethod
    def engage(*robots: Robot, silence: float = ..., **options: Unpack[TeamOptions]) -> Operation[Team]:
        """Begins a session for each robot, like `Robot.engage`, with the same options for all:
        `speed`, `limits`, `gains`, `force_cap`, `leash`, `deviation`, `posture`, `speed_cap`;
        returns a `Team`. If a robot is silent for `silence` seconds, the other arms brake. Raises
        `MotionError` of the first arm that could not be engaged; the other arms are then released.
        Cancelling ends all sessions.
        """
    @property
    def arms(self) -> list[Arm]:
        """The arms, in the order of the robots."""
    def move_to(
        self, targets: Sequence[Destination], **options: Unpack[GoalOptions]
    ) -> Operation[list[MotionReport]]:
        """A motion of all arms, each to its own target as in `Arm.move_to`, with the same options for
        all arms.
        """
    def run(self, motions: Sequence[Motion | Follow]) -> Operation[list[MotionReport]]:
        """A motion of all arms: `motions` contains one motion for each arm, in the order of the arms,
        `[team.arms[0].move_to(a), team.arms[1].move_by(b)]`; do not await these motions themselves.
        All motions begin together. An arm can also follow a `Latest`,
        `team.arms[1].follow(latest)`: this arm begins with the first target. The team motion ends
        when the other arms have arrived and the `Latest` is closed.
        """
    def stop(self) -> None:
        """Brakes all arms, each within two of its cycles. Never waits, and can be called from any
        thread. Motions raise; the sessions continue and hold the arms. A team motion that begins
        before every arm has seen the stop does not start, and raises in the same way.
        """
    def latch_stop(self) -> Operation[None]:
        """Brakes all arms like `stop`, ends their sessions and latches the stop of each robot: see
        `Robot.latch_stop`. Waits until all are at rest, and raises the `MotionError` of the first
        arm that was not seen at rest.
        """
    def release_stop(self) -> bool:
        """Releases the latched stop of each robot, and returns `True` if one was latched. The sessions
        have ended: the next motions need a new team.
        """
    def stopped(self) -> str | tuple[str, int] | None:
        """Reason why the newest team motion, or the team after that motion, has stopped: `requested`,
        or the name of the event with the number of the arm, `("robot_stopped", 1)`; `None` without
        a stop.
        """
    def grasp(self, bases: Sequence[ArrayLike], object: ArrayLike) -> TeamGrasp:
        """Declares an object as held by all arms from now on, in its current place: `bases` are the
        robots' base frames and `object` is the object's, poses in one frame of the program's
        choice. The arms do not move. Raises `MotionError` if a session has ended.
        """
    def disengage(self) -> Operation[list[MotionReport]]:
        """Brakes and releases all arms and ends their sessions. Raises `TeamError` if a session ended
        in another way.
        """
    def __aenter__(self) -> Operation[Team]: ...
    def __aexit__(self, kind: object = None, *_rest: object) -> Operation[None]: ...
    def __len__(self) -> int: ...

@final
class TeamGrasp:
    """An object that all arms of a team hold: created by `Team.grasp`."""

    def move_to(self, object: ArrayLike, **options: Unpack[GoalOptions]) -> Operation[list[MotionReport]]:
        """A motion of the object to this pose, in the frame of the bases, on a straight line; with
        options of `Arm.move_to` except `limits`, the same for all arms. If one arm is blocked, the
        others wait.
        """
    def measured(self) -> list[_Array]:
        """Pose of the object from the newest state of each arm, in the frame of the bases: a list of
        `(4, 4)`.
        """
