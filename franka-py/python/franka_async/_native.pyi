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
from .streams import Reading, Stream
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
    """Everything that the robot says in one millisecond, by the vendor's names: O base, F flange, NE
    nominal end effector, EE end effector, K stiffness frame; `X_T_Y` is the pose of Y in X, with
    the translation in the last column.

    It does not change. Each array is a new one, which the program may change.
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
        """Velocity of the commanded elbow, `(2,)`: of joint 3 in rad/s, then 0."""
    @property
    def ddelbow_c(self) -> _Array:
        """Acceleration of the commanded elbow, `(2,)`: of joint 3 in rad/s^2, then 0."""
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
        """What the robot does: `other`, `idle`, `move`, `guiding`, `reflex`, `user_stopped` or
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
        """Errors that hold the robot now, by the vendor's names."""
    @property
    def last_motion_errors(self) -> list[str]:
        """Errors that ended the last motion, by the vendor's names."""
    def flat(self) -> _Array:
        """The numbers that a policy wants, as one array, `(69,)`: see `FLAT_LAYOUT`."""
    def to_dict(self) -> dict[str, Any]:
        """All attributes by name."""
    def _repr_html_(self) -> str: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

def _state_of_json(json: str, version: int) -> RobotState:
    """The state that `pickle` wrote."""
def _log_of_json(entries: Sequence[str], version: int) -> ControlLog:
    """The log that `pickle` wrote. An entry with numbers that JSON has no words for is left out."""

_Frame: TypeAlias = Literal[
    "joint1", "joint2", "joint3", "joint4", "joint5", "joint6", "joint7", "flange", "ee", "stiffness"
]

@final
class Model:
    """Kinematics, dynamics and limits of one arm, without a connection: `Model.fr3()`, `Model.fer()`,
    `Model.from_urdf(text)`.

    Joint positions `q` (rad), velocities `dq` (rad/s) and so on are one vector, `(7,)`, or a batch,
    `(n, 7)`: results of a batch have a leading axis of length n. Where a function takes several,
    a single one goes with a batch of the other. Batches leave the interpreter to other threads.

    Frames are `joint1` to `joint7`, `flange`, `ee` (the end effector, `F_T_EE` from the flange) and
    `stiffness` (`EE_T_K` from the end effector); both poses are the identity unless given. The base
    frame is that of link 0, z upwards along the axis of joint 1. Wrong shapes and numbers that are
    not finite raise `ValueError`.
    """

    @staticmethod
    def fr3() -> Model:
        """The Franka Research 3, by the vendor's numbers."""
    @staticmethod
    def fer() -> Model:
        """The Franka Emika Robot (Panda), as its own model library computes it."""
    @staticmethod
    def from_urdf(text: str) -> Model:
        """The model in the URDF `text` that a Franka Research 3 serves, with the masses and limits of
        that arm. `ValueError` says what is wrong with another text.
        """
    @property
    def kind(self) -> Literal["fr3", "fer"]:
        """Which robot it is: `fr3` or `fer`."""
    @property
    def joint_limits(self) -> JointLimits:
        """What the joints may do."""
    @property
    def cartesian_limits(self) -> CartesianLimits:
        """What Cartesian motion commands may do."""
    def pose(
        self, frame: _Frame, q: ArrayLike, F_T_EE: ArrayLike | None = None, EE_T_K: ArrayLike | None = None
    ) -> _Array:
        """The pose of `frame` in the base frame, `(4, 4)` or `(n, 4, 4)`.

        `F_T_EE` and `EE_T_K` are the identity unless given, whatever tool a robot has: pass those
        of its state for its own `ee` and `stiffness`. `Robot.pose_at` has the former.
        """
    def zero_jacobian(
        self, frame: _Frame, q: ArrayLike, F_T_EE: ArrayLike | None = None, EE_T_K: ArrayLike | None = None
    ) -> _Array:
        """Twist of `frame` per joint velocity, in base axes about the frame's origin, linear rows
        first: `(6, 7)` or `(n, 6, 7)`. Tools as of `pose`: the identity unless given.
        """
    def body_jacobian(
        self, frame: _Frame, q: ArrayLike, F_T_EE: ArrayLike | None = None, EE_T_K: ArrayLike | None = None
    ) -> _Array:
        """`zero_jacobian` in the frame's own axes. Tools as of `pose`: the identity unless given."""
    def link_poses(self, q: ArrayLike) -> _Array:
        """The poses of link 1 to link 7 and of the flange in the base frame, `(8, 4, 4)` or
        `(n, 8, 4, 4)`: for drawing the arm.
        """
    def manipulability(self, q: ArrayLike) -> _Array:
        """How far an arm is from a singularity: `sqrt(det(J J'))`, 0 in one, 0.080 in the ready pose.
        A number, or `(n,)`.
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
        `(3,)` m, and its inertia about that in flange axes, `I_total`, `(3, 3)` kg m^2, as states
        have them. So everywhere. There is none unless given, nor a tool: what a robot carries is
        passed from its state.
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
        unless given, as of `mass`.
        """
    def gravity(
        self,
        q: ArrayLike,
        m_total: float = 0.0,
        F_x_Ctotal: ArrayLike | None = None,
        gravity_earth: ArrayLike | None = None,
    ) -> _Array:
        """Torques that hold the arm still against gravity, `(7,)` or `(n, 7)` N m. `gravity_earth` is
        the gravitational acceleration in the base frame, `(3,)` m/s^2, that of an upright robot
        unless given. Without tool and load unless given, as of `mass`.
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
        `F_T_EE`, the identity unless given. Without tool and load unless given, as of `mass`.
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
        tool and load unless given, as of `mass`.
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
        `armature` is the inertia of the rotors felt at the joints, `(7,)` kg m^2, none unless
        given. Where mass and armature make no physical arm, the result is NaN. Without tool and
        load unless given, as of `mass`.
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
        for one more number that picks from the arm's self-motion: the angle of `joint7`, of
        `joint4`, or the `swivel` angle of the elbow about the line from shoulder to wrist, rad,
        zero with the elbow on top. k is 0 if there is none; with joint 7 or 4 it is 8 at most.
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
        """`ik` of each of many poses, `(n, 4, 4)` or `(n, 7)`: a list of n arrays `(k, 7)`."""
    def ik_near(self, pose: ArrayLike, q: ArrayLike, F_T_EE: ArrayLike | None = None) -> _Array:
        """The posture within the joint limits that brings the end effector to `pose` and is nearest to
        `q` in the sum of squares, of all that there are: `(7,)` rad, some 0.3 ms. `ValueError` if
        the pose is out of reach.

        Of many poses or many `q`, `(n, 7)`, with NaN in the rows of poses that are out of reach.
        """
    def ik_from(self, pose: ArrayLike, seed: ArrayLike, F_T_EE: ArrayLike | None = None) -> _Array:
        """A posture within the joint limits that brings the end effector to `pose`, `(7,)` rad, by
        iteration from `seed`, which decides which one: usually one nearby. Some 10 microseconds
        near the seed, 2 ms until a pose out of reach raises `ValueError`. `ik_near` looks at all
        postures instead.

        Of many poses or many seeds, `(n, 7)`, with NaN in the rows of poses that are out of reach.
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
        """Joint velocities that give the end effector the `twist` `[linear; angular]`, m/s and rad/s
        in base axes, as far as they can, and what is missing of it: `(7,)` rad/s and `(6,)`, or of
        many `q` or twists with a leading axis. It also works on displacements, in m and rad.

        The velocities are exactly within `lower` and `upper`, `(7,)` or `(n, 7)`, by default what
        the arm may do at `q`. Where the twist leaves freedom they follow `posture`, by default
        zero. Near singularities and at bounds the position comes first; with `smooth` position and
        orientation give way alike.
        """
    def clearance(
        self, q: ArrayLike, *, hand: bool = True, shape: Literal["vendor", "covering"] = "vendor"
    ) -> Clearance:
        """The least distance of the arm to itself, and between which bodies. `hand` says whether there
        is a Franka Hand on the flange.

        `shape` is `vendor`, the vendor's capsules for self-collision, which do not cover the links
        everywhere, or `covering`, which contain them and are up to 3.5 cm thicker.
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Dynamics:
    """Everything that a control law needs about a state of the arm, from one pass. Results of a batch
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
    """The least distance between two bodies of the arm; of a batch, with a leading axis."""

    @property
    def distance(self) -> _Array:
        """Between the surfaces, m: an array without axes, or `(n,)`. Negative where they overlap."""
    @property
    def bodies(self) -> NDArray[np.int64]:
        """Which bodies, the inner one first, `(2,)`: 0 is the base, 1 to 7 are the links, 8 is what is
        on the flange.
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
        """Least positions to command, rad, a little inside `hard_lower`."""
    @property
    def upper(self) -> _Array:
        """Greatest positions to command, rad, a little inside `hard_upper`."""
    @property
    def hard_lower(self) -> _Array:
        """Positions, rad, where the velocity envelope towards them ends."""
    @property
    def hard_upper(self) -> _Array:
        """Positions, rad, where the velocity envelope towards them ends."""
    @property
    def velocity(self) -> _Array:
        """Greatest speeds anywhere, rad/s; near position limits see `velocity_envelope`."""
    @property
    def acceleration(self) -> _Array:
        """Greatest accelerations of a commanded motion, rad/s^2."""
    @property
    def jerk(self) -> _Array:
        """Greatest jerks of a commanded motion, rad/s^3."""
    @property
    def torque(self) -> _Array:
        """Greatest torques, N m."""
    @property
    def torque_rate(self) -> _Array:
        """Greatest rates of commanded torques, N m/s."""
    def velocity_envelope(self, q: ArrayLike, margin: float = 0.0) -> tuple[_Array, _Array]:
        """Least and greatest joint velocities at the positions `q`, two arrays `(7,)` or `(n, 7)`,
        rad/s. On a Franka Research 3 the speed towards a position limit is bounded by what stops
        before it. `margin` in rad/s comes off both sides: the robot checks with 0, libfranka limits
        with 0.001.
        """
    def distance(self, q: ArrayLike) -> _Array:
        """Distances of the positions `q` to the nearer of `lower` and `upper`, `(7,)` or `(n, 7)` rad,
        negative outside.
        """
    def contains(self, q: ArrayLike) -> NDArray[np.bool_]:
        """Whether every position is within `lower` and `upper`: one, or an array `(n,)`."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class MotionLimits:
    """Bounds on a motion along one coordinate, or on the norm of a vector of them, per second and its
    powers.
    """

    @property
    def velocity(self) -> float:
        """m/s or rad/s."""
    @property
    def acceleration(self) -> float:
        """m/s^2 or rad/s^2."""
    @property
    def jerk(self) -> float:
        """m/s^3 or rad/s^3."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class CartesianLimits:
    """Limits of Cartesian motion commands."""

    @property
    def translation(self) -> MotionLimits:
        """Of the end effector's position: bounds on the norm, m."""
    @property
    def rotation(self) -> MotionLimits:
        """Of the end effector's orientation: bounds on the norm, rad."""
    @property
    def elbow(self) -> MotionLimits:
        """Of the elbow's angle, joint 3, rad."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class AxisLimits:
    """Greatest velocity, acceleration and jerk of each axis, in both directions. Units are the
    program's: rad or m, per second and its powers.

    Each is one number for all axes or one for each, `(n,)`; all have to be positive and finite.
    """

    def __new__(cls, velocity: ArrayLike, acceleration: ArrayLike, jerk: ArrayLike) -> AxisLimits: ...
    @staticmethod
    def fr3() -> AxisLimits:
        """Those of the joints of a Franka Research 3. Near a position limit it allows less: see
        `JointLimits.velocity_envelope`.
        """
    @staticmethod
    def fer() -> AxisLimits:
        """Those of the joints of a Franka Emika Robot (Panda)."""
    def scaled(self, velocity: float = 1.0, acceleration: float = 1.0, jerk: float = 1.0) -> AxisLimits:
        """The same limits times these factors."""
    @property
    def velocity(self) -> _Array:
        """Greatest velocities: `(n,)`, or `(1,)` for all axes alike."""
    @property
    def acceleration(self) -> _Array:
        """Greatest accelerations: `(n,)`, or `(1,)` for all axes alike."""
    @property
    def jerk(self) -> _Array:
        """Greatest jerks: `(n,)`, or `(1,)` for all axes alike."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class Trajectory:
    """A planned motion. It begins at time 0 in the state that it was planned from, and is at rest from
    `duration` on.
    """

    @property
    def duration(self) -> float:
        """The time until rest, s."""
    @property
    def arrival(self) -> float:
        """When the target is met, s: the duration, unless the target moves."""
    @property
    def axes(self) -> int:
        """The number of axes."""
    @property
    def end(self) -> _Array:
        """Where it comes to rest, `(axes,)`."""
    def at(self, t: ArrayLike) -> tuple[_Array, _Array, _Array]:
        """Position, velocity and acceleration at the time `t` in s, `(axes,)` each, or at many times,
        `(m,)`, `(m, axes)` each. Before the beginning it is at its beginning, after its end at
        rest.
        """
    def sample(self, dt: float = 0.001) -> tuple[_Array, _Array, _Array, _Array]:
        """Times every `dt` seconds from the beginning to the first one at rest, `(m,)`, and position,
        velocity and acceleration there, `(m, axes)` each.
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
    `target_velocity` and `target_acceleration`, `(n,)` each, zero unless given; past a target in
    motion it comes to rest. All axes are at the target at the same time: with `synchronisation`
    `straight` on a straight line wherever the state at the start allows one, with `time` each on
    its own.

    `ValueError` for shapes that do not fit each other, numbers that are not finite, and a target
    that moves faster than the limits allow.
    """

@final
class VirtualRobots:
    """Simulated robots in one process, without sockets, each under a motion of its own: `step` gives
    every one an action and lets it run for some milliseconds of its time.

    Actions are, by `control`: `joint_velocity`, `(7,)` rad/s to approach; `joint_delta`, `(7,)` rad
    by which the target moves; `cartesian_delta`, `(6,)` m and a rotation vector in base axes by
    which the end effector's target moves; `torque`, `(7,)` N m on top of gravity. Motions keep the
    robot's limits of velocity, acceleration and jerk, torques its rate limit; positions keep off
    the ends of the joints' ranges. `speed` is the share of the greatest velocity that motions use.

    The arm is `realistic` (it sticks and flexes), `ideal`, `nominal`, `bad`, or `sampled`: another
    realistic one by each seed. Robots have a Franka Hand unless `hand` is false. `threads` share
    the work of a step.
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
        """The length of an action: 6 or 7."""
    def action_bound(self, cycles: int = 1) -> _Array:
        """Greatest action of each axis that means anything in one step of `cycles`: rad/s, rad, m and
        rad, or N m. Larger ones are cut.
        """
    def reset(self, index: int, *, seed: int = 0, q: ArrayLike | None = None) -> None:
        """Begins anew with robot `index`, counted from 0: at rest at the joint positions `q`, `(7,)`
        rad, by default the ready pose. Noise, and a sampled arm, come from `seed`: the same seed
        and actions give the same states.
        """
    def step(self, actions: ArrayLike, cycles: int = 1) -> tuple[_Array, NDArray[np.bool_]]:
        """Gives every robot its action, `(n, 6 or 7)`, and lets it run for `cycles` milliseconds.
        Returns `flat()` of the states after that, `(n, 69)`, and which robots still move, `(n,)`:
        one that the robot itself has stopped (see `errors`) stands until its `reset`.
        """
    def observations(self) -> _Array:
        """`flat()` of the newest states, `(n, 69)`."""
    def state(self, index: int) -> RobotState:
        """The newest state of robot `index`."""
    def errors(self, index: int) -> list[str]:
        """The errors with which robot `index` has stopped, by the vendor's names; none while it moves."""
    def push(self, index: int, wrench: ArrayLike, duration: int) -> None:
        """Pushes the end effector of robot `index` with `wrench`, `(6,)` N and N m in base axes, for
        so many milliseconds of its time.
        """

_Controller: TypeAlias = Literal["joint_impedance", "cartesian_impedance", "external_controller"]
_Command: TypeAlias = Literal[
    "torques", "joint_positions", "joint_velocities", "cartesian_pose", "cartesian_velocities"
]

@final
class ActiveControl:
    """A motion under active control: from the first `read_once()` on, the thread that calls it is the
    control cycle. Each state is to be answered within the millisecond; one that neither reads nor
    writes leaves the robot without commands, which stops it. Commands pass no filter and no
    limiter.

    As a context manager it has the robot stop at the end of the block, unless the last command was
    written before. One thread at a time may use it.
    """

    def read_once(self) -> tuple[RobotState, float]:
        """Waits for the next state of the motion, with the interpreter released. Returns it with the
        robot's time since the state read before, in seconds: 0 at first, and more than 0.001 after
        a loss.

        Raises `MotionError` with what ended the motion, and `ActiveError` of the kind `ended` when
        read again after that, `finished` after the last command.
        """
    def write_once(
        self,
        command: ArrayLike,
        finished: bool = False,
        *,
        torques: ArrayLike | None = None,
        elbow: ArrayLike | None = None,
    ) -> MotionReport | None:
        """Sends the command that answers the newest state; with `finished` the last one, after which
        it waits, with the interpreter released, until the robot has ended the motion, and returns a
        `MotionReport`.

        `torques`, `(7,)` N m, go beside a command to a motion generator under
        `external_controller`. `elbow` goes with poses and twists: position of joint 3 in rad, and
        sign of joint 4.

        Raises `ValueError` for numbers that are not finite or of the wrong shape, `ActiveError` for
        a command that cannot be sent, after which others may be, and `MotionError` if the robot
        ended the motion otherwise than asked.
        """
    def stop(self) -> None:
        """Has the robot stop, unless the last command was written before. Waits for a call of another
        thread.
        """
    def __enter__(self) -> ActiveControl: ...
    def __exit__(self, *_exception: object) -> None: ...

@final
class AsynchronousControl:
    """A motion between sparse joint targets that the robot itself plans. Any thread may set targets.
    `stop()`, or dropping it, has the robot stop.
    """

    def set_target(self, q: ArrayLike) -> None:
        """Sends the robot to `q`, `(7,)` rad, wherever it was going before. Raises what ended the
        motion, if it has ended.
        """
    def status(self) -> tuple[Literal["idle", "executing", "target_reached", "aborted"], str | None]:
        """How far the newest target has been followed: `idle`, `executing`, `target_reached` or
        `aborted`; and why it was aborted, if it was.
        """
    def reached(self) -> Operation[None]:
        """Waits until the newest target is reached. Raises what ended the motion before. Cancelling
        leaves the robot on its way.
        """
    def stop(self) -> None:
        """Has the robot stop. Without effect once it was stopped."""
    def __enter__(self) -> AsynchronousControl: ...
    def __exit__(self, *_exception: object) -> None: ...

@final
class Law:
    """A control law: a C function that the real-time thread calls with every state, without the
    interpreter. `include/franka_async_law.h` says what the function gets and returns.

    `code` is a `numba.cfunc`, what `franka_async.laws.compiled` makes, a function of a library that
    `ctypes` or `cffi` has loaded, or an address as an integer, whose code the program then has to
    keep. `command` is what the law's output is: `torques`, `joint_positions`, `joint_velocities`,
    `cartesian_pose` or `cartesian_velocities`. With `elbow=True` the latter two have that of the
    elbow behind them: position of joint 3, rad, and the sign of joint 4; otherwise it is left to
    the robot. `parameters` and `memory`, `(n,)` with 256 numbers at most, are what the law finds
    in its first cycle.

    The function runs on the real-time thread, with some 300 us to answer: it must not lock,
    allocate, print or wait, and nothing guards against code that writes where it should not.
    """

    @property
    def parameters(self) -> _Array:
        """The newest parameters, `(n,)`. Setting them reaches a law that runs with its next cycle, all
        of them at once; their number stays. Raises `ValueError`.
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
        """What the law's output is."""
    @property
    def memory(self) -> _Array:
        """The memory after the newest cycle of the newest run, `(n,)`; before the first one, what the
        law was made with.
        """
    def step(self, state: RobotState, dt: float = 0.001) -> tuple[_Array, int]:
        """Calls the law once, with `state` and `dt` seconds after the state before, without a robot.
        Returns its output, `(7,)`, `(4, 4)` or `(6,)`, or with an elbow as it was written, `(18,)`
        or `(8,)`; and what it returned. Numbers that it did not write are NaN. Time and memory go
        on from call to call; `reset()` begins anew. Model terms are those of the vendor's
        constants for the kind of robot that the state is from.
        """
    def reset(self) -> None:
        """Has the next `step` begin with time 0 and the memory that the law was made with."""

def _law_layout() -> tuple[list[tuple[str, int, list[int], str]], int]:
    """Where each field of what a law gets is: name, offset in bytes, shape, numpy format; and the size
    of it all.
    """

@disjoint_base
class Operation(Coroutine[Any, Any, _T_co], Generic[_T_co]):
    """Something that takes time: `await` it in a coroutine, or call `wait()` on a thread without an
    event loop. It begins then and not before. Where the waiting is cancelled, so is the operation;
    a motion brakes.

    It is a coroutine in the sense of `collections.abc`, so `asyncio.create_task`, `TaskGroup`,
    `gather`, `wait_for` and `timeout` take it.
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
        """Part of being a coroutine: goes on from the last `await`."""
    def throw(self, kind: Any, value: Any = None, traceback: Any = None) -> Any:
        """Part of being a coroutine: raises inside of it."""
    def close(self) -> None:
        """Part of being a coroutine: gives the operation up. A motion brakes."""

def _complete(future: Any, method: str, value: Any) -> None:
    """Completes a future, in its event loop, unless it is done."""

@final
class Motion(Operation[MotionReport]):
    """A motion: it begins when it is awaited, and then arrives, with a `MotionReport`, or raises
    `MotionError`. Cancelling it brakes the arm.
    """

    def handle(self) -> MotionHandle:
        """A handle that says from elsewhere how far the motion is, and pauses or brakes it."""
    def progress(self) -> Progress | None:
        """How far the motion has come: a `Progress`; `None` before it has begun and after its end."""
    def pause(self) -> None:
        """Stops the motion on its way, until `resume()`; the arm is held there. Without effect before
        it has begun and after its end.
        """
    def resume(self) -> None:
        """Lets the motion go on."""
    def cancel(self) -> None:
        """Brakes the motion for good, from any thread; whoever awaits it gets `MotionError` of the
        kind `stopped`. One that has not begun never begins.
        """

@final
class Follow(Operation[MotionReport]):
    """Following targets: it begins when it is awaited, and ends at the last target, with a
    `MotionReport`, or raises `MotionError`. Cancelling it brakes the arm.
    """

@final
class MotionHandle:
    """A motion from elsewhere: how far it is, and pausing or braking it. It does not keep the motion
    going.
    """

    def progress(self) -> Progress | None:
        """As `Motion.progress`."""
    def pause(self) -> None:
        """As `Motion.pause`."""
    def resume(self) -> None:
        """As `Motion.resume`."""
    def cancel(self) -> None:
        """As `Motion.cancel`."""

@final
class Latest:
    """The newest target of a program: `set` it from any thread, at any rate, and `follow` it. When it
    is closed or its last reference is dropped, the motion ends at the target that was set last.
    """

    def __new__(cls, target: Target | None = None) -> Latest: ...
    def set(self, target: Target) -> None:
        """Replaces the target by a pose, `Joints`, or a pair with velocities. Never waits."""
    def close(self) -> None:
        """Ends the motions that follow it, at the target that was set last. Those of an arm whose
        deadman is silent raise `held`.
        """

@final
class Robot:
    """A robot at an address. `async with Robot(address) as robot:` connects, and shuts down at the
    end: what moves is braked. Its methods may be called from any thread.

    When the last reference to a connected robot goes, it is braked and closed in the background;
    when the interpreter exits, it is waited for.

    Options: `realtime` is `enforce` or `ignore`: whether a host without real-time scheduling is
    refused. `None` is the environment variable `FRANKA_REALTIME`, and `enforce` without one.
    `priority` (1 to 99) and `cpu` are for the control thread; threads of Python keep theirs.
    `version` is the protocol version, 5 or 10; negotiated if `None`. `connect_timeout` is for each
    step of connecting, and `link_timeout` the silence of the robot after which a motion fails with
    `link_lost`, 0.02 to 10 s, 1 s by default; more than that is for simulated robots on busy hosts.
    `log_size` is how many cycles an error carries, 10000 at most. `nominal_model` computes with the
    vendor's constants whatever the robot says of itself. `accept_geometry_error` connects to a
    robot whose poses have another geometry than its model; `geometry_residual` is by how much.
    `known` is an `Identified` of this arm.
    `supervise` is a `Policy`, or `True` for the default one: lost connections are made again, and
    the robot is recovered as the policy says. `ask_before_recovery` is called with the `Reflex`
    before each recovery, on a thread of its own, and has to return whether it may be; it implies
    `ask_first`. `ValueError` for options that make no sense.
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
        """Connects, and returns this robot; without effect while it is connected. Raises
        `ConnectError`. Cancelling gives it up.
        """
    def shutdown(self) -> Operation[None]:
        """Brakes whatever moves, ends it and closes the connection; without effect if there is none.
        Once it has begun, it goes on even if it is cancelled.
        """
    def __aenter__(self) -> Operation[Robot]: ...
    def __aexit__(self, *_exception: object) -> Operation[None]: ...
    @property
    def address(self) -> str:
        """Where the robot is: as given, and resolved once it is connected."""
    @property
    def is_connected(self) -> bool:
        """Whether there is a connection, or of a supervised robot will be one again."""
    @property
    def fci_version(self) -> int:
        """The protocol version that the robot speaks: 10 for a Franka Research 3, 5 for a Franka Emika
        Robot.
        """
    @property
    def geometry_residual(self) -> float | None:
        """How far the pose that the robot reported at connect was from that of `model()` at the same
        joint positions, m, or a tenth of a metre times the largest difference of an element of
        their rotation matrices, whichever is greater: at most 2e-6, or an error that was accepted.
        `None` if the robot reported no pose.
        """
    def state(self) -> RobotState:
        """The newest state, without waiting, however old it is: once the link is gone the last one
        stays. `health()` tells.
        """
    def states(self, rate: float | None = None) -> Stream[RobotState]:
        """The newest state as it changes, for `async for` or `for`; at most `rate` of them per second,
        by the robot's clock, if that is given. States that come while the program does
        something else are skipped for the newest. Ends when the connection does.
        """
    def state_stream(self) -> Stream[Reading]:
        """Every state from now on, each once and in order, for `async for` or `for`: pairs of the
        state and how many are `missed` before it. A program may lag about a second behind
        before it misses any. Ends when the connection does.
        """
    def pose(self) -> _Array:
        """The measured pose of the end effector in the base frame, `(4, 4)`, of the newest state."""
    def pose_at(self, q: ArrayLike) -> _Array:
        """The pose in the base frame, `(4, 4)`, that the end effector has at joint positions `q`,
        `(7,)` rad.
        """
    def reference(self) -> Reference | None:
        """Where target control has the arm go in this millisecond: a `Reference`; `None` while it
        moves nothing.
        """
    def budget(self) -> Budget:
        """The limits that a motion keeps unless it is given others: a `Budget`."""
    def margin(self, gains: Gains) -> Margin | None:
        """How far gains are from the first oscillation of an arm like this where it is: a `Margin`.
        `None` for gains that are out of their bounds.
        """
    def stop(self) -> Operation[None]:
        """Brakes whatever moves, and waits until the motion has ended and a state shows the arm at
        rest; that motion raises `MotionError` of the kind `stopped` at once, while the arm still
        brakes. A motion that another task asks for meanwhile takes over: `stop` then raises
        `MotionError` of the kind `superseded`. It raises others if the arm was not seen to rest:
        `protocol`, `not_at_rest`, `link_lost`, `connection_closed`. An arm that hands keep in motion
        for two seconds is stopped by the robot's own controller; the wait is over after eight. Once
        it has begun, it goes on even if it is cancelled.
        """
    def latch_stop(self) -> Operation[None]:
        """Stops as `stop` does, and latches the stop: until `release_stop` every motion, session and
        goal is refused, as `MotionError` of the kind `not_ready`, whoever asks for it. The latch
        outlives connections, and holds whatever this raises. It is no safety function.
        """
    def release_stop(self) -> bool:
        """Releases a latched stop: motions are admitted again. Nothing moves by it. Returns whether
        one was latched.
        """
    @property
    def is_stop_latched(self) -> bool:
        """Whether a stop is latched."""
    def recover(self) -> Operation[None]:
        """Recovers the robot from a reflex, and waits until it takes motions again; without effect if
        there is nothing to recover from. Moves nothing. Raises `CommandError`.
        """
    def move_to(self, target: Destination, **options: Unpack[MotionOptions]) -> Motion:
        """A motion of the end effector to `target` in the base frame: a pose, `(4, 4)`, or 3 + 4
        numbers with a quaternion `x y z w`, which may be a pair; 3 numbers, a position that is
        reached with the orientation kept; `(3, 3)` or 4 numbers, an orientation; or `Joints`.
        To a pose it is a straight line.

        Options of every motion: `speed`, a factor; `limits`, a `Budget`; `gains`, `Gains`;
        `stiffness` at the end effector, 6 numbers; `force_cap`, N, or `None` for off; `leash`,
        `deviation`, `tolerance`, `settling`; `posture`, 7 joint positions; `until`, a
        condition; `start_with`, a `StartTicket`; and `joint_fallback`, whether the joints go there
        where the arm cannot follow the line. Raises `ValueError` for arguments that make no sense,
        and `MotionError` when it is awaited.
        """
    def replay(
        self,
        recording: RecordingFile,
        *,
        speed: float = 1.0,
        source: Literal["reference", "measured"] = "reference",
        targets: Literal["joints", "poses"] = "joints",
    ) -> Operation[ReplayReport]:
        """Moves to where a recorded motion begins, makes it again, and lets the arm go: a session with
        the defaults, and `Arm.replay` in it.
        """
    def move_joints(self, q: ArrayLike, **options: Unpack[MotionOptions]) -> Motion:
        """A motion of the joints to `q`, 7 numbers, rad; all arrive together. Options as of `move_to`."""
    def move_by(
        self,
        way: ArrayLike,
        frame: Literal["base", "tool"] = "base",
        from_arm: bool = False,
        **options: Unpack[MotionOptions],
    ) -> Motion:
        """A motion of the end effector away from where it is, or from the target of a motion under
        way: 3 numbers, m, or 6, with a rotation vector, rad; along and about the axes of the
        `base` or the `tool`. `from_arm` counts from the measured arm in any case. Options as of
        `move_to`.
        """
    def move_through(
        self, waypoints: Iterable[Target | Waypoint], blend: float = 0.0, **options: Unpack[MotionOptions]
    ) -> Motion:
        """A motion through several poses, or several `Joints`, to the last of them, without a stop
        where the corner is rounded: within `blend` (m; rad for joints), or as each `Waypoint`
        says. Options as of `move_to`.
        """
    def follow(
        self,
        targets: Latest | Iterable[Target] | AsyncIterable[Target],
        **options: Unpack[FollowOptions],
    ) -> Follow:
        """Follows the newest of `targets`, poses or `Joints`, alone or with velocities as a pair,
        until they end, and then comes to rest at the last one. `targets` is a `Latest`, which
        any thread sets; an asynchronous iterator, which runs in the event loop that awaits; or
        a plain one, which runs on a thread of its own and may wait.

        Options as of `move_to`, and `lead`, a `Lead`: how far ahead of the arm a target may be; and
        `watchdog`, a pair of seconds and `brake` or `hold`: what happens if no target comes for so
        long. Nothing begins before the first target, and no watchdog counts until then. What the
        iterator raises brakes the arm and is raised.
        """
    def engage(self, **options: Unpack[EngageOptions]) -> Engagement:
        """Begins a session that holds the arm where it is and goes from goal to goal without a stop in
        between: `async with robot.engage() as arm`, or `arm = await robot.engage()`.

        Options: `speed`, `limits`, `gains`, `force_cap`, `leash`, `deviation`, `posture` as of
        `move_to`, for all its goals; `keep_out`, regions (`Plane`, `Box`) that the arm keeps
        out of; `speed_cap`, in m/s, the most of any joint, the flange and the end effector;
        `deadman`, a `Deadman`; and `backend`, `torques` or a pair of a controller of
        the robot and its setpoints.
        """
    def events(self) -> Stream[Event]:
        """What happens to the robot from now on, for `async for`: connections lost and made, reflexes,
        recoveries, user stop, guiding, brakes, motions, loads; see `Event`. It is there for a robot
        that is not supervised, too. Ends when there is no connection and will be none.
        """
    def health(self) -> Health:
        """How the robot is now: whether it takes motions, why not, how often it was reconnected and
        recovered.
        """
    def health_changes(self) -> Stream[Health]:
        """How the robot is, now and as it changes, for `async for`. Ends as `events()` does."""
    def agree(self, reflex: int, yes: bool = True) -> bool:
        """Agrees, or not, to the recovery from the reflex of this number: for a `Policy` that asks
        first. Returns whether that was awaited. The number is that of the event or of
        `health().reflex`.
        """
    def closed(self) -> Operation[CloseReason]:
        """Waits until there is no connection and will be none, and returns why: a `CloseReason`.
        Cancelling has no effect on the robot.
        """
    def gripper(self) -> Gripper:
        """The Franka Hand of this robot, at its host and the port after the robot's; it is yet to be
        connected: `async with robot.gripper() as gripper:`. That of a simulator on a free port has
        another one, and nothing or something else listens at this: `Gripper(sim.hand_address)`, of
        a `Sim` with `hand=True`.
        """
    def vacuum_gripper(self) -> VacuumGripper:
        """The vacuum gripper of this robot, at its host and the second port after the robot's; it is
        yet to be connected, as `gripper()`.
        """
    def set_collision_behavior(self, *thresholds: ArrayLike, **named: ArrayLike) -> Operation[None]:
        """Sets the torques and forces at which the robot reports contact (lower) and stops itself
        (upper).

        Either one of the names `careful` (10 N and 10 N m, for the robot's own controllers),
        `compliant` (60, for an arm that a hand pushes) and `insensitive` (100, for work that
        presses); or four arrays: `lower_torque_thresholds`, `upper_torque_thresholds`, `(7,)` N m,
        `lower_force_thresholds`, `upper_force_thresholds`, `(6,)` N and N m; or eight, each of the
        four twice: `..._acceleration` while the arm accelerates, and `..._nominal`, in the order of
        `COLLISION_THRESHOLDS`. Positional or by name. Below about 10 N the friction of an arm that
        touches nothing is enough for a reflex.

        The vendor documents no range of them. The simulator refuses what is negative.

        Raises `ValueError`, `TypeError` and `CommandError`; a robot that moves refuses it. Once it
        has begun, the robot may carry it out even if it is cancelled.
        """
    def set_joint_impedance(self, stiffness: ArrayLike) -> Operation[None]:
        """Sets the stiffness of the robot's own joint impedance controller, `(7,)` N m/rad, each 0 to
        14250. Raises and is cancelled as `set_collision_behavior`.
        """
    def set_cartesian_impedance(self, stiffness: ArrayLike) -> Operation[None]:
        """Sets the stiffness of the robot's own Cartesian impedance controller in the stiffness frame,
        `(6,)`: x y z, 10 to 3000 N/m, and roll pitch yaw, 1 to 300 N m/rad. Raises and is cancelled
        as `set_collision_behavior`.
        """
    def set_guiding_mode(self, free: Sequence[bool], elbow: bool = True) -> Operation[None]:
        """Sets which directions are free in hand guiding: six truth values, x y z and roll pitch yaw,
        and whether the `elbow` is. Raises and is cancelled as `set_collision_behavior`.
        """
    def set_k(self, EE_T_K: ArrayLike) -> Operation[None]:
        """Sets the stiffness frame in the end effector's, `EE_T_K`: a pose. The vendor documents no
        range; the simulator refuses what is more than 2 m away. Resolves when a state shows it.
        Raises and is cancelled as `set_collision_behavior`.
        """
    def set_ee(self, NE_T_EE: ArrayLike) -> Operation[None]:
        """Sets the end effector in the nominal end effector's frame, `NE_T_EE`: a pose. Its range,
        and when it resolves, are as of `set_k`. Raises and is cancelled as
        `set_collision_behavior`.
        """
    def set_load(
        self, mass: float, center: ArrayLike | None = None, inertia: ArrayLike | None = None
    ) -> Operation[None]:
        """Declares the load beyond the end effector: `mass`, kg; `center` of mass in the flange frame,
        `(3,)` m; `inertia` about it, `(3, 3)` or its nine numbers, kg m^2, zero unless given.

        The vendor documents no range. The simulator refuses more than 10 kg, a centre more than 1 m
        away, and an inertia that no body has or with a principal moment above 1 kg m^2. Resolves
        when a state shows it. Raises and is cancelled as `set_collision_behavior`.
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
        switches a filter off. Franka Emika Robot only, and deprecated by the vendor. Raises and is
        cancelled as `set_collision_behavior`; `CommandError` of the kind `request` from a robot
        that has no such command.
        """
    def virtual_wall(self, id: int) -> Operation[VirtualWall]:
        """Reads the virtual wall `id` as it is set up in Desk; returns a `VirtualWall`. Franka Emika
        Robot only. Raises `CommandError`, of the kind `request` from a robot that has no such
        command.
        """
    def urdf(self) -> Operation[str]:
        """Reads the robot's description of itself; returns URDF text. Franka Research 3 only. Raises
        `CommandError`, of the kind `request` from a robot that has no such command.
        """
    def identify(self) -> IdentificationPlan:
        """Plans motions that show friction and bias of the joints and the load at the flange: in each
        of six poses around where the arm is, all joints go 0.2 rad to and fro twice, at 0.2 rad/s,
        about a minute in all. Nothing moves before `run()` of the plan is awaited. The arm has to
        be free to go so far, see `reach`, and to carry what it is to be identified with.
        """
    def tare(self, duration: float = 0.5) -> Operation[WrenchTare]:
        """Takes the average of what the robot estimates of external forces and torques, over
        `duration` seconds of its clock (0.02 to 60), and returns a `WrenchTare`. The arm has to
        rest, untouched: raises `TareError` otherwise, and `ReadError` if states no longer come. A
        tare belongs to the posture in which it was taken. Nothing moves, and nothing is changed at
        the robot; cancelled, it takes no tare.
        """
    def stats(self) -> dict[str, Any]:
        """Counters and times of the control thread since the connection was made, as a new `dict`;
        without waiting, whatever moves.

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
        """What the operating system granted the control thread, as a new `dict`: its `SCHED_FIFO`
        `priority` or `None`, `busy_poll` in s or `None`, and `refusals`, texts, under
        `realtime="ignore"`.
        """
    def metrics(self) -> str:
        """The robot's metrics as OpenMetrics text, for Prometheus and whatever else reads that; the
        label `robot` is its address. `franka_async.metrics.text` is the text of several robots.
        """
    def record(self, columns: Iterable[str], *, longest: float = 3600.0) -> Recording:
        """Records these columns of every cycle, of `record_columns()`, while a `with` or `async with`
        block runs: see `Recording`. It keeps the first `longest` seconds. Raises `ValueError` for a
        column that is not known.
        """
    def active_torques(self) -> Operation[ActiveControl]:
        """Begins control by torques, `(7,)` N m, without gravity and friction. Returns an
        `ActiveControl`. The first command is due within a few milliseconds: read on the thread that
        controls at once. Raises `MotionError`, of the kind `busy` while anything else controls the
        arm. Cancelling has the robot stop.
        """
    def active_joint_positions(self, controller: Controller = "joint_impedance") -> Operation[ActiveControl]:
        """Begins control by joint positions, `(7,)` rad, for one of the robot's own controllers,
        `joint_impedance` or `cartesian_impedance`; with `external_controller` every command needs
        torques beside it. Otherwise like `active_torques`.
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

        `maximum_joint_velocities` are `(7,)` rad/s; within `goal_tolerance`, in rad as Euclidean
        norm, a target counts as reached. Raises `MotionError`: `unsupported` by another protocol,
        `busy` while anything else controls the arm. Cancelling has the robot stop.
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
        """Control by a law that needs no interpreter in the cycle, a `Law`, or code that one is made
        of with `command`, `elbow`, `parameters` and `memory`. Resolves with a `MotionReport` when
        the law has returned a positive number and the robot has ended the motion.

        `controller` is which of the robot's own controllers follows, where no torques are
        commanded. `limit_rate` is whether commands pass the limiter: by default on a Franka Emika
        Robot and not on a Franka Research 3, as with the vendor's library. `cutoff_frequency` is
        that of the low-pass filter, Hz; 1000 switches it off.

        Raises `MotionError` of the kind `given_up` if the law returned a negative number, which is
        its `code`, of the kind `invalid` for output that is not finite, and `busy` while anything
        else controls the arm. Cancelling has the robot stop.
        """
    def model(self) -> Model:
        """The model of the connected arm, which control computes with: of a Franka Research 3 its
        description of itself, of a Franka Emika Robot the constants of its own library.
        """

@final
class Engagement(Operation[Arm]):
    """A session that begins when it is awaited, or entered by `async with`, and is then an `Arm`."""

    def __aenter__(self) -> Engagement: ...
    def __aexit__(self, kind: object = None, *_rest: object) -> Operation[None]: ...

@final
class Arm:
    """A session of target control: the arm is held, and goes from goal to goal without a stop in
    between, whatever their kinds. Made by `Robot.engage`.

    When the last reference to it goes, the arm brakes and the session ends, in the background;
    `disengage()` does the same and can be awaited. `Robot.stop` ends it from outside, as does the
    robot by a reflex: whatever is asked of the session afterwards raises the reason. While it
    lasts, motions of the `Robot` itself are refused as `busy`.
    """

    def move_to(self, target: Destination, **options: Unpack[MotionOptions]) -> Motion:
        """As `Robot.move_to`; the arm is then held at the target. Cancelling it brakes the arm and
        holds it.
        """
    def replay(
        self,
        recording: RecordingFile,
        *,
        speed: float = 1.0,
        source: Literal["reference", "measured"] = "reference",
        targets: Literal["joints", "poses"] = "joints",
    ) -> Operation[ReplayReport]:
        """Moves to where the recorded motion begins, as `move_joints` does, and then follows the
        motion of a `RecordingFile`, or of the part of one that `between` gives, with all guards of
        the session. Returns a `recording.ReplayReport` once the arm rests.

        `speed` is 0.01 to 1, as a share of the recorded one. `source` is `reference`, where the arm
        was to be, or `measured`, where it was: of arms that were moved by hand. `targets` is
        `joints`, or `poses`: the hand moves as recorded, the elbow as it can.

        Raises `ReplayError` for a motion that is not one for this arm, before anything moves, and
        of the kind `off` once the arm is far from where it was in the recording; `MotionError`,
        `RecordingError`, `ValueError`. Cancelling brakes the arm.
        """
    def move_joints(self, q: ArrayLike, **options: Unpack[MotionOptions]) -> Motion:
        """As `Robot.move_joints`; the arm is then held."""
    def move_by(
        self,
        way: ArrayLike,
        frame: Literal["base", "tool"] = "base",
        from_arm: bool = False,
        **options: Unpack[MotionOptions],
    ) -> Motion:
        """As `Robot.move_by`, from the target that the arm is held at; the arm is then held."""
    def move_through(
        self, waypoints: Iterable[Target | Waypoint], blend: float = 0.0, **options: Unpack[MotionOptions]
    ) -> Motion:
        """As `Robot.move_through`; the arm is then held."""
    def follow(
        self,
        targets: Latest | Iterable[Target] | AsyncIterable[Target],
        **options: Unpack[FollowOptions],
    ) -> Follow:
        """As `Robot.follow`; the arm is then held at the last target."""
    def hold(self, **options: Unpack[MotionOptions]) -> Motion:
        """Brakes, whatever the arm is doing, and is over when it rests; it is then held there."""
    def set(self, target: Destination) -> Operation[None]:
        """Heads for `target` from now on, in the place of whatever came before, and holds it; what
        `move_to` takes, and targets with velocities. Over as soon as the goal is taken.
        Cancelling takes nothing back.
        """
    def try_set(self, target: Destination) -> None:
        """As `set`, without waiting for an answer: for loops at a rate of their own, on any thread.
        The newest of goals that come faster than they are taken counts. Raises `MotionError`
        for a goal that is not accepted, and for what ended the session.
        """
    def target(self) -> _Array | tuple[_Array, _Array] | Joints | None:
        """What the arm is held at or heads for: a pose, `(4, 4)`, `Joints`, or a pair with the twist.
        `None` along a chunk, at the beginning, where a goal was given up, and once the session
        has ended.
        """
    def reference(self) -> Reference | None:
        """Where the arm is to be in this millisecond: a `Reference`; `None` once the session has
        ended.
        """
    def at_rest(self, timeout: float | None = None) -> Operation[bool]:
        """Waits until the arm rests at the target that was taken last, or where that has been given
        up; returns whether it does. Without a `timeout` it waits for ever for an arm that is pushed
        or held back, or that follows a stream; `False` says that it did not rest within so many
        seconds. Cancelling has no effect on the arm.
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
        """Follows points with times, as a policy predicts them, from now on; over as soon as they are
        taken. The arm rests at the last one unless another chunk or goal comes.

        `points` are positions `(N, 3)`, poses `(N, 7)` or `(N, 4, 4)`, or with `joints` joint
        positions `(N, 7)`, rad; or a `Chunk`, whose fields are the other arguments. `dt` is the
        time between two points, s, or `times` that of each. `velocities` are twists `(N, 6)` or
        joint velocities `(N, 7)`. `observed_at` is the `RobotState` that the policy saw: times
        count from it. `blend` is the time to fade over from the chunk before, 0.1 s by default. A
        chunk has 1024 points and 60 s at most: the rest is the next chunk, with the same
        `observed_at`, and waits for its first point.

        Raises `ValueError` for arrays that are no chunk, and `MotionError` when it is awaited: for
        one that comes too late or ends out of reach, and then the chunk before goes on; and of the
        kind `held` or `braked`, once, if the chunk before was given up, as by a silent `Deadman`.
        """
    def guide(self, axes: Sequence[bool] = ..., elbow: bool = True) -> Operation[None]:
        """Lets a hand guide the arm, once it rests, until the next goal; `hold()` ends it. `axes` are
        free: x y z and about x y z of the base frame, six truth values; the others stay where
        they are. Over as soon as it is taken. The load has to be declared, or it pulls the arm
        down.
        """
    def tune(self, **options: Unpack[TuneOptions]) -> Operation[None]:
        """Changes `gains`, `limits`, `force_cap`, `leash`, `deviation` and `posture`, as far as they
        are given, of the goal under way and of those to come. Gains fade over 0.3 s.
        """
    def disengage(self) -> Operation[MotionReport]:
        """Brakes, lets the arm go and ends the session, with a `MotionReport`; a goal under way raises
        `stopped`. Raises how the session ended if it ended otherwise.
        """
    def ended(self) -> Operation[MotionReport]:
        """Waits until the session has ended, and returns or raises how. Cancelling has no effect on
        the arm.
        """
    def __aenter__(self) -> Operation[Arm]: ...
    def __aexit__(self, kind: object = None, *_rest: object) -> Operation[None]: ...

@final
class Deadman:
    """A token that has to be kept alive: while it is silent for longer than `silence` seconds (0.01 or
    more), and once it is released or gone, the arm that it was given to by `Robot.engage` brakes
    and holds, and every goal raises `held`; so does the first chunk after it. The control thread
    watches it, whatever Python is busy with.
    """

    def __new__(cls, silence: float) -> Deadman: ...
    @property
    def silence(self) -> float:
        """How long it may be silent, s."""
    def keep_alive(self) -> None:
        """Restarts the time of silence; from any thread. Without effect once it was released."""
    def release(self) -> None:
        """Gives the token up: the arm brakes, and holds from then on."""

@final
class Source:
    """Where the items of `franka_async.streams.Stream` come from.

    An item is waited for and taken in two steps, so that none is lost where the waiting is
    cancelled: `ready()` takes time and changes nothing that a program sees, `take()` does not.
    """

    def ready(self) -> Operation[None]:
        """Resolves when `take()` has something."""
    def take(self) -> tuple[Any] | None:
        """The next item, as a tuple of one; `None` if another task has taken it. Raises
        `StopAsyncIteration` at the end.
        """

@final
class ControlLog:
    """The last cycles of a motion, oldest first: what the robot said, and what it had been sent.

    Every field of `RobotState` is here as one array over the cycles: `log.q` is `(N, 7)`,
    `log.O_T_EE` is `(N, 4, 4)`, `log.time` is `(N,)`. What was sent before each state is
    `log.sent("tau_J_d")`.
    """

    def states(self) -> list[RobotState]:
        """The states, oldest first."""
    def sent(self, name: Literal["tau_J_d", "q_c", "dq_c", "O_T_EE_c", "O_dP_EE_c"]) -> _Array:
        """What had been sent before each state, `(N, ...)`; zeros before the first. `name` is
        `tau_J_d`, `q_c`, `dq_c`, `O_T_EE_c` or `O_dP_EE_c`.
        """
    def to_csv(self) -> str:
        """Comma-separated values, a line for each cycle; columns are named as by libfranka."""
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
        """A row for each cycle: Velocity of the commanded elbow, `(2,)`: of joint 3 in rad/s, then 0."""
    @property
    def ddelbow_c(self) -> _Array:
        """A row for each cycle: Acceleration of the commanded elbow, `(2,)`: of joint 3 in rad/s^2, then 0."""
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
        """A row for each cycle: What the robot does: `other`, `idle`, `move`, `guiding`, `reflex`, `user_stopped` or
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
        """A row for each cycle: Errors that hold the robot now, by the vendor's names."""
    @property
    def last_motion_errors(self) -> list[list[str]]:
        """A row for each cycle: Errors that ended the last motion, by the vendor's names."""

@final
class Condition:
    """What has to be the case: comparisons of quantities, flags of the robot and the time, joined by
    `&`, `|` and `~`. See `franka_async.condition`.
    """

    def __and__(self, other: Condition, /) -> Condition: ...
    def __rand__(self, other: Condition, /) -> Condition: ...
    def __or__(self, other: Condition, /) -> Condition: ...
    def __ror__(self, other: Condition, /) -> Condition: ...
    def __invert__(self) -> Condition: ...
    def __bool__(self) -> bool: ...
    def __eq__(self, other: object, /) -> bool: ...
    def relative(self) -> Condition:
        """Compares the changes since the motion began instead of the values, in every comparison of
        this condition: for loads that the robot does not know of, and for displacements.
        """
    def tared(self, tare: WrenchTare, /) -> Condition:
        """Takes a tare off the forces, moments and joint torques of this condition, as
        `await robot.tare()` returns it. The moment is then about the origin of the stiffness frame.
        """
    def held_for(self, seconds: float, /) -> Condition:
        """True once this condition has been true for so many seconds without a break, by the robot's
        clock.
        """
    def then(self, target: Target) -> Reaction:
        """Has the motion go on to `target`, a pose or `Joints`, once the condition is true; without,
        it comes to rest. The arm turns there at once, without waiting for the program.
        """

@final
class Reaction:
    """A condition, and where the motion goes once it is true: made by `Condition.then(target)`."""

    def __eq__(self, other: object, /) -> bool: ...

@final
class Quantity:
    """A number that changes while the arm moves: compare it by `<`, `<=`, `>` or `>=` for a condition.

    Forces and torques are the robot's estimates, positive where the arm exerts them. Axes are those
    of the base frame.
    """

    def above(self, value: float) -> Condition:
        """True while it is at or above `value`: the same as `quantity >= value`."""
    def below(self, value: float) -> Condition:
        """True while it is at or below `value`: the same as `quantity <= value`."""
    def beyond(self, value: float) -> Condition:
        """True while its magnitude is at or above `value`, which has to be above zero."""
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
    """True while the external force along x is at or beyond so many newtons, in either direction."""
def force_y(newtons: float, /) -> Condition:
    """True while the external force along y is at or beyond so many newtons, in either direction."""
def force_z(newtons: float, /) -> Condition:
    """True while the external force along z is at or beyond so many newtons, in either direction."""
def force(newtons: float, /) -> Condition:
    """True while the external force, whatever its direction, is at or beyond so many newtons."""
def torque(newton_metres: float, /) -> Condition:
    """True while the external torque at the end effector, whatever its axis, is at or beyond so
    many N m.
    """
def joint_torques(newton_metres: float, /) -> Condition:
    """True while the external torque of any joint is at or beyond so many N m."""
def joint_contact(joint: int, /) -> Condition:
    """True while the robot reports a contact of this joint, 1 to 7."""
def elapsed(seconds: float, /) -> Condition:
    """True from so many seconds after the beginning of the motion on, by the robot's clock."""
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
    """The gains of this name, as arguments of `Gains`."""
def _softened(gains: Gains, stiffness: ArrayLike) -> dict[str, Any]:
    """These gains with another stiffness at the end effector, as arguments of `Gains`."""
def _row(name: str, argument: ArrayLike, length: int) -> _Array:
    """A new array of `length` numbers from the argument called `name`."""

@final
class Sim:
    """A simulated robot on a free port of this host, from the call on until `stop()` or the end of the
    `with` or `async with` block. Its methods release the interpreter, and act between two of its
    milliseconds.
    """

    @staticmethod
    def fr3(**options: Unpack[SimOptions]) -> Sim:
        """Starts a Franka Research 3 in the ready pose, with an arm that sticks, flexes and lags like
        real ones.

        Options: `virtual_time`, whether its next millisecond begins with the command, however long
        that takes up to `patience` seconds (0.5): for tests, and for programs that learn.
        `patience` alone waits for commands that come late, but is never faster than the clock
        on the wall. `arm`, `ideal`, `nominal`, `realistic` or `bad`: a good arm for tests that
        need exactness, or worse ones; with `arm_seed`, one that is drawn at random from such
        arms; `ideal=True` is `arm="ideal"`. `limits`, `5.9` (the default) or `before-5.9`: the
        joint limits of the robot's system, of an FR3. `state_geometry`, `recorded` (upper arm 0.3162
        m, forearm 0.3842 m; by default, unless `ideal`), `described` (0.316 m, 0.384 m) or `random`
        (1 mm and 3 mrad off, by `seed`): what it computes its own poses with. `seed` of all other
        randomness. `q`, joint positions at the start, 7 numbers, rad, where the joints can be. `tool`, `hand` or a
        tuple of its frame on the flange (a pose), its mass, kg, and its centre of mass in the
        flange frame, m: what the robot knows of. `load`, a tuple of mass and centre: what it does
        not know of. `hand` serves a Franka Hand and mounts it, `vacuum_gripper` a vacuum gripper,
        each at an address of its own: `Gripper(sim.hand_address)`, since `robot.gripper()` looks at
        the port after the robot's, where the Hand is with `address` only. `network`, a `Network`
        between robot and clients. `address`, where to listen; the grippers then listen on the ports
        that follow, as on a robot. `enforce_limits`, whether commands outside the limits end in a
        reflex.
        """
    @staticmethod
    def fer(**options: Unpack[SimOptions]) -> Sim:
        """Starts a Franka Emika Robot (Panda); otherwise like `fr3`."""
    @staticmethod
    def in_step(*kinds: Literal["fr3", "fer"], **options: Unpack[SimOptions]) -> list[Sim]:
        """Starts two to four robots, each `fr3` or `fer`, that begin every millisecond together, and
        returns them in a list: where one waits for a command, all do. For arms of one program,
        teams above all: `left, right = Sim.in_step("fr3", "fer", virtual_time=True)`. Options as of
        `fr3`, the same for all, but for `address`. One that has stopped is not waited for.
        """
    @property
    def address(self) -> str:
        """Where to connect to: `host:port`."""
    @property
    def hand_address(self) -> str | None:
        """Where the Hand is; `None` without one."""
    @property
    def vacuum_gripper_address(self) -> str | None:
        """Where the vacuum gripper is; `None` without one."""
    @property
    def waiting(self) -> int:
        """How many of the calls with `once_moving=True` still wait for a motion, without those that
        `let_go()` or `release()` took back.
        """
    def state(self) -> RobotState:
        """The newest state, in full precision."""
    def true_pose(self) -> _Array:
        """Where the end effector really is, base frame, `(4, 4)`: the robot's own joint sensors may be
        off.
        """
    def stop(self, *, once_moving: bool = False) -> None:
        """Stops the simulation: now or, `once_moving`, in mid-motion, as of `push`. Connections to it
        are lost. Without effect if it has stopped.
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
        axes, m, with a force, base axes, N, and a torque, N m, for `duration` seconds of its
        own clock; until it is released if `None`. It begins now or, `once_moving`, in the
        millisecond in which a joint is faster than 0.05 rad/s: in virtual time, where a motion
        may be over before a program sees it move. Without a motion it never begins: see `waiting`.
        """
    def push_joints(self, torques: ArrayLike, *, duration: float | None = None, once_moving: bool = False) -> Touch:
        """Pushes the joints with torques, 7 numbers, N m; otherwise like `push`."""
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
        """Pulls the arm to the point `to`, base frame, m, by a spring of this stiffness, N/m;
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
        """Grips the arm firmly where it is now; otherwise like `push`."""
    def block(self, joint: int, *, duration: float | None = None, once_moving: bool = False) -> Touch:
        """Blocks a joint, 1 to 7, at its angle of now."""
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
        """Puts a wall in the way of the end effector: through `point`, base frame, m, with a `normal`
        out of it.
        """
    def let_go(self) -> None:
        """Ends every touch, and drops all that was to begin once the arm moves."""
    def press_user_stop(self, pressed: bool = True, *, once_moving: bool = False) -> None:
        """Presses the user stop, or releases it; `once_moving` as of `push`."""
    def activate_safety_function(self, active: bool = True) -> None:
        """Activates a safety function that forbids motion, as set up in Desk, or deactivates it."""
    def guide(self, pressed: bool = True) -> bool:
        """Presses the guiding buttons, or lets go of them. Returns whether the arm is guided then."""
    def lock(self, closed: bool = True) -> None:
        """Closes the brakes of the joints, or opens them: as Desk locks and unlocks a robot."""
    def freeze(self, what: Literal["joints", "controllers"] | None = "joints") -> None:
        """Lets the arm ignore its commands while the robot reports the motion and no error: its
        `"joints"` stand still, or its `"controllers"` take nothing over; `None` lets it obey again.
        """
    def trip(self, error: str, *, once_moving: bool = False) -> None:
        """Raises an error of the robot, by the vendor's name, such as `cartesian_reflex`: it stops
        itself. `once_moving` as of `push`.
        """
    def recover_manually(self) -> None:
        """Performs the recovery that takes a person."""
    def place(self, q: ArrayLike) -> None:
        """Puts the arm to joint positions, 7 numbers, rad, at rest. Raises `ValueError` where a joint
        cannot be.
        """
    def attach(self, mass: float, center: ArrayLike, inertia: ArrayLike | None = None) -> None:
        """Attaches a body to the flange that the robot does not know of, in the place of the one
        before: mass, kg, centre of mass in the flange frame, m, and inertia about it, `(3, 3)`
        kg m^2.
        """
    def place_object(self, width: float) -> None:
        """Puts an object of this width, m, between the fingers of the Hand. Raises `ValueError` if it
        does not fit, and without a Hand.
        """
    def place_part(self) -> None:
        """Puts a part in front of the vacuum gripper. Raises `ValueError` without one."""

@final
class Touch:
    """Something that acts on the arm of a simulated robot, made by the methods of `Sim`."""

    def release(self) -> bool:
        """Ends it, also before it has begun. Returns whether it was still there."""
    def felt(self) -> _Array | None:
        """The wrench that it exerts on the arm now, base axes, `(6,)` N and N m; `None` if it is over,
        has not begun, or acts on joints.
        """

def from_xyzw(position: ArrayLike, quaternion: ArrayLike) -> _Array:
    """The pose, `(4, 4)`, of a position, 3 numbers, m, and a quaternion `x y z w` of any length but
    zero.
    """
def to_xyzw(pose: ArrayLike) -> tuple[_Array, _Array]:
    """The position, `(3,)` m, and the quaternion, `(4,)` `x y z w` of length 1 with w >= 0, of a pose,
    `(4, 4)`.
    """
def rotated(pose: ArrayLike, rotation_vector: ArrayLike, frame: Literal["base", "tool"] = "base") -> _Array:
    """The pose, `(4, 4)`, turned in place by a rotation vector, 3 numbers, rad: about the axes of the
    `base`, or of the `tool`, through its position, which stays.
    """

COLLISION_THRESHOLDS: list[str]

@final
class Gripper:
    """A Franka Hand, which has a connection of its own beside the robot's.

    `async with Gripper(address) as gripper:` connects, and disconnects at the end; `await
    gripper.connect()` does so without a block. On threads without an event loop, `.wait()`
    stands in the place of `await`. What is grasped stays grasped when the connection ends.

    One action runs at a time. A newer one aborts it, which then raises `ActionError` of the kind
    `aborted`, and so does `stop()`, from any task or thread. Cancelling the task that awaits an
    action stops the fingers, and so does a timeout around it. An action has no deadline of its own:
    a move that an obstacle blocks takes minutes. None holds the interpreter while it is awaited or
    waited for.
    """

    def __new__(cls, address: str) -> Gripper: ...
    @property
    def address(self) -> str:
        """Where it is: as given, and resolved once it is connected."""
    @property
    def is_connected(self) -> bool:
        """Whether there is a connection. One that was lost counts until `disconnect()`."""
    def connect(self) -> Operation[Gripper]:
        """Connects, and returns this object; without effect while it is connected. Raises
        `ConnectError`. Cancelling gives it up.
        """
    def disconnect(self) -> Operation[None]:
        """Closes the connection, without waiting. An action under way is stopped. Without
        effect if there is no connection.
        """
    def __aenter__(self) -> Operation[Gripper]: ...
    def __aexit__(self, *_exception: object) -> Operation[None]: ...
    def state(self) -> GripperState:
        """The newest state, without waiting."""
    def states(self) -> Stream[GripperState]:
        """The newest state as it changes, for `async for`. Ends when the connection does."""
    def homing(self) -> Operation[bool]:
        """Finds how wide the fingers open, `max_width` of the state; returns whether that succeeded.
        Needed once after power-on and after a change of fingers. Raises `ActionError`; cancelling
        stops the fingers.
        """
    def move_to(self, width: float, speed: float = 0.1) -> Operation[bool]:
        """Moves the fingers to `width`, m, at `speed`, m/s (the Hand's most is 0.1, and more is not
        refused); returns whether they arrived. Raises `ActionError`; cancelling stops the fingers.
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
        `force`, N. Returns whether they ended at most `epsilon_inner` narrower and `epsilon_outer`
        wider, m; the force stays applied either way, until the next action or `stop()`. Raises
        `ActionError`; cancelling stops the fingers and lets go.
        """
    def stop(self) -> Operation[bool]:
        """Stops the fingers and lets go of what they hold; returns whether that succeeded. The action
        that runs raises `ActionError`. Once it has begun, it goes on even if it is cancelled.
        """

@final
class GripperState:
    """What a Franka Hand says of itself. It does not change."""

    @property
    def width(self) -> float:
        """Distance of the fingers, m."""
    @property
    def max_width(self) -> float:
        """Distance of the open fingers, m, as the last homing found it."""
    @property
    def is_grasped(self) -> bool:
        """Whether the Hand holds an object of the width that was asked for."""
    @property
    def temperature(self) -> int:
        """Temperature of the Hand, degrees Celsius."""
    @property
    def time(self) -> float:
        """The Hand's clock, s."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class VacuumGripper:
    """A vacuum gripper, which has a connection of its own beside the robot's. What `Gripper` says of
    connecting, of actions and of their ends holds for it as well; cancelling an action stops the
    pump.
    """

    def __new__(cls, address: str) -> VacuumGripper: ...
    @property
    def address(self) -> str:
        """Where it is: as given, and resolved once it is connected."""
    @property
    def is_connected(self) -> bool:
        """Whether there is a connection. One that was lost counts until `disconnect()`."""
    def connect(self) -> Operation[VacuumGripper]:
        """Connects, and returns this object; without effect while it is connected. Raises
        `ConnectError`. Cancelling gives it up.
        """
    def disconnect(self) -> Operation[None]:
        """Closes the connection, without waiting. An action under way is stopped. Without
        effect if there is no connection.
        """
    def __aenter__(self) -> Operation[VacuumGripper]: ...
    def __aexit__(self, *_exception: object) -> Operation[None]: ...
    def state(self) -> VacuumGripperState:
        """The newest state, without waiting."""
    def states(self) -> Stream[VacuumGripperState]:
        """The newest state as it changes, for `async for`. Ends when the connection does."""
    def vacuum(self, vacuum: int, timeout: float, profile: int = 0) -> Operation[bool]:
        """Sucks an object on and holds it; returns whether the vacuum was reached within `timeout`
        seconds, which go out in whole milliseconds. `vacuum` is in units of 10 mbar, 0 to 255;
        `profile` is a production set-up profile of the device, 0 to 3. Raises `ActionError`;
        cancelling stops the pump.
        """
    def drop_off(self, timeout: float) -> Operation[bool]:
        """Drops the object; returns whether that was done within `timeout` seconds. Raises
        `ActionError`; cancelling stops the pump.
        """
    def stop(self) -> Operation[bool]:
        """Stops the action that runs, which raises `ActionError`; returns whether that succeeded. Once
        it has begun, it goes on even if it is cancelled.
        """

@final
class VacuumGripperState:
    """What a vacuum gripper says of itself. It does not change."""

    @property
    def in_control_range(self) -> bool:
        """Whether the vacuum is inside its range."""
    @property
    def part_detached(self) -> bool:
        """Whether the object has been dropped off."""
    @property
    def part_present(self) -> bool:
        """Whether the gripper holds an object."""
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
        """The joint positions that the arm goes to, `(n, 7)` rad, one row for each motion; the last
        one is where it is now.
        """
    @property
    def duration(self) -> float:
        """About how long it will take, s."""
    @property
    def reach_of_joints(self) -> _Array:
        """Farthest that each joint goes from where it is, either way, `(7,)` rad."""
    @property
    def reach(self) -> float:
        """Farthest that the end effector goes from where it is, m."""
    @property
    def reach_down(self) -> float:
        """Farthest that the end effector goes down, base frame, m."""
    def run(self) -> Operation[Identified]:
        """Moves the arm, and returns an `Identified`. Nothing is changed at the robot: pass the result
        to `Robot(address, known=...)` of later connections, and declare the load by `set_load` if
        you like. Raises `MotionError`, and `IdentifyError` if the arm is no longer where this was
        planned, or was held or pushed. Cancelling brakes the arm; what was measured is lost.
        """

@final
class Identified:
    """What is known of one arm: friction and bias of its joints, and the load at its flange. `str()`
    is a table to read.
    """

    @property
    def kind(self) -> str:
        """The kind of the robot: `fr3` or `fer`."""
    @property
    def friction(self) -> _Array:
        """Friction of each joint at 0.2 rad/s, beyond what the robot compensates itself, `(7,)` N m."""
    @property
    def friction_deviation(self) -> _Array:
        """Standard deviation of `friction`, `(7,)` N m."""
    @property
    def bias(self) -> _Array:
        """Torque that each joint takes in either direction and in every pose, `(7,)` N m."""
    @property
    def bias_deviation(self) -> _Array:
        """Standard deviation of `bias`, `(7,)` N m."""
    @property
    def mass(self) -> float:
        """Mass of what the flange carries beside the end effector that the robot is configured with,
        kg. A declared load is part of it.
        """
    @property
    def mass_deviation(self) -> float:
        """Standard deviation of `mass`, kg."""
    @property
    def center(self) -> _Array | None:
        """Its centre of mass in the flange frame, `(3,)` m; `None` where the mass is less than three
        of its deviations, and the centre therefore unknown.
        """
    def to_json(self) -> str:
        """Everything as text, for `from_json`."""
    @staticmethod
    def from_json(text: str) -> Identified:
        """What `to_json` wrote. Raises `ValueError` for other text and implausible numbers."""
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class WrenchTare:
    """The robot's estimate for an untouched arm at rest, to take off later. It belongs to the
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
        """Joint positions in which it was taken, `(7,)` rad."""
    @property
    def states(self) -> int:
        """How many states it is the average of."""
    def compensate(self, state: RobotState) -> _Array | None:
        """The wrench of a state without the tare: force, then moment about the origin of the stiffness
        frame, in axes of the base, `(6,)` N and N m, positive where the arm exerts it. `None` where
        the robot has no estimate, near a singularity.
        """
    def compensate_torques(self, state: RobotState) -> _Array:
        """The external joint torques of a state without the tare, `(7,)` N m."""
    def turned(self, state: RobotState) -> float:
        """The largest change of a joint since the tare, rad: beyond `NEAR`, take a new one."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class Recording:
    """Columns of every cycle: `with robot.record(["q", "tau_c"]) as recording:` begins, the end of the
    block ends it, and `recording["q"]` is an array of one row for each cycle, `recording["time"]`
    its time, s.

    It is collected beside the interpreter: however long Python is busy, nothing is lost by that.
    The columns of a state and those of the control thread that belong to the same cycle are in the
    same row. Reading it is possible while it goes on.
    """

    def __enter__(self) -> Recording: ...
    def __exit__(self, *_exception: object) -> None: ...
    def __aenter__(self) -> Operation[Recording]: ...
    def __aexit__(self, *_exception: object) -> Operation[None]: ...
    def keys(self) -> list[str]:
        """The names of the columns, `time` first."""
    def __contains__(self, name: object, /) -> bool: ...
    def __iter__(self) -> Iterator[str]: ...
    def __getitem__(self, name: str, /) -> _Array: ...
    def arrays(self) -> dict[str, _Array]:
        """All columns, a new `dict` of arrays."""
    def __len__(self) -> int: ...
    @property
    def lost(self) -> int:
        """How many cycles of the robot since the begin are missing: their states did not arrive, were
        skipped by the control thread for a newer one, or came after the longest time.
        """
    def save(self, path: str | PathLike[str]) -> None:
        """Writes all columns into a file, `.npz`: `numpy.load(path)["q"]`."""

@final
class Recorder:
    """Records robots in a file, every cycle and what was asked of them: `async with
    Recorder.to_file("run.mcap") as recorder:`, and in it `await recorder.attach(robot)`. The end of
    the block ends the recording and waits until it is on the disk.

    Threads of its own write the file, beside the interpreter. Nothing that it does delays a cycle:
    what there is no room for is dropped and counted. Without a block, `await recorder.finish()`
    ends it. When the last reference goes it ends in the background, perhaps without the newest
    events; at the exit of the interpreter, what was written by then is readable.
    """

    @staticmethod
    def to_file(path: str | PathLike[str], **options: Unpack[RecordOptions]) -> Recorder:
        """Begins a recording in a new MCAP file at `path`, whose folder has to be there.

        Options: `thinned`, whether cycles are kept at the full rate only around what is notable
        (reflexes, contacts, failures), else every tenth. `flush`, the longest time between two
        writes, 0.01 to 1 s (1): what a crash can lose. `sync`, whether each write is forced to the
        disk, against power cuts (`True`). `rotate_bytes` and `rotate_time`, s: after which a new
        file is begun, `run-0002.mcap` after `run.mcap`. `metadata`, a `dict` of texts, and
        `attachments`, a `dict` of file names and bytes, go into the file. `black_box`, a
        `recording.BlackBox`, also writes the last seconds before an incident to a file of their
        own.

        Raises `RecordError` if there is such a file or it cannot be made, `ValueError`.
        """
    @staticmethod
    def black_box(
        directory: str | PathLike[str], *, before: float = 30.0, after: float = 1.0, keep: int = 20
    ) -> Recorder:
        """Keeps the last `before` seconds, 1 to 300, in memory only. When a motion ends by a reflex, a
        lost link or a guard, it writes them and the `after` seconds that follow, 60 at most, to a
        file in `directory`, named by time, robot and cause. The newest `keep` files are kept.

        Raises `RecordError`, `ValueError`.
        """
    def attach(
        self, robot: Robot, name: str = "", *, with_address: bool = False, capacity: int | None = None
    ) -> Operation[None]:
        """Records a robot, which is connected, from now on: every cycle, goals and how they end,
        diagnoses, events and requests; of a supervised robot also after it was connected to again.
        `name`, of letters, digits, `-` and `_`, tells several robots of a recording apart.
        `with_address` writes the network address down. `capacity` is how many cycles may wait for
        the recorder, 4096 by default. Raises `RecordError`, `ValueError`. Cancelling gives it up.
        """
    def attach_team(
        self, team: Team, names: Sequence[str], *, with_address: bool = False, capacity: int | None = None
    ) -> Operation[None]:
        """Records the robots of a team, each under its name, and which member each is; otherwise like
        `attach`. Robots before the one that an error is about are recorded.
        """
    def attach_gripper(self, gripper: Gripper | VacuumGripper, robot: str = "") -> None:
        """Records an end effector, a connected `Gripper` or `VacuumGripper`, with the robot of this
        name: its states, and actions when they have ended. Raises `RecordError` unless that robot
        is attached.
        """
    def note(self, text: str) -> None:
        """Records a remark, for all robots. Raises `RecordError` if the recording has ended."""
    def episode(self, name: str, *, task: str) -> EpisodeUnderWay:
        """An episode, an attempt at a task, while a `with` block runs:
        `with recorder.episode("pick-1", task="pick the cube") as episode:`. The block sets
        `episode.success` to `True` or `False`; it is `None`, not judged, unless that was done, and
        `False` if the block raises. One episode runs at a time. `name` has letters, digits, `-` and
        `_`; raises `ValueError`.
        """
    def status(self) -> RecordStatus:
        """What was recorded so far and what has failed, a `recording.RecordStatus`."""
    def finish(self) -> Operation[RecordStatus]:
        """Ends the recording and waits, 10 s at most, until all of it is on the disk: what has
        happened before the call is in it. Returns the `recording.RecordStatus`, again if it has
        ended. Raises `RecordError` if the files could not be written to their end; what was written
        is readable. Once it has begun, it goes on even if it is cancelled.
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
        """What is to be done, in words."""
    @property
    def success(self) -> bool | None:
        """Whether it was done; `None` until somebody says so."""
    @success.setter
    def success(self, success: bool | None, /) -> None: ...
    def __enter__(self) -> EpisodeUnderWay: ...
    def __exit__(self, kind: object = None, *_rest: object) -> None: ...

@final
class RecordingFile:
    """What was recorded of a robot in a file, or in a part of its time, as
    `RecordingFile.open("run.mcap")` returns it.

    Nothing is read before it is asked for, and no more than the part that is asked for. Reading
    releases the interpreter. `column("q")` is an array with a row for each cycle; `for cycle in
    recording:` has the whole state of each. A damaged part raises `RecordingError`.

    Times in the file are this computer's clock, whole nanoseconds since 1970.
    """

    @staticmethod
    def open(path: str | PathLike[str]) -> RecordingFile:
        """Opens a recording. One whose end is missing is read as far as it goes: see `damage`. Raises
        `RecordingError`.
        """
    @staticmethod
    def recover(damaged: str | PathLike[str], whole: str | PathLike[str]) -> Recovery:
        """Writes all that is whole in the file `damaged` to a new file, with the index that was
        missing. Returns a `recording.Recovery`. Raises `RecordingError`.
        """
    @property
    def damage(self) -> str | None:
        """Why the file is not as its writer was to leave it, after a crash, a power cut or on a full
        disk; `None` if it is. What was flushed can be read all the same.
        """
    @property
    def span(self) -> tuple[int, int] | None:
        """Time of the first and the last message of the file; `None` if there is none."""
    @property
    def metadata(self) -> dict[str, str]:
        """What is known of the whole recording: versions, host, kernel, options."""
    @property
    def robots(self) -> list[RecordedRobot]:
        """The robots of the file, each a `recording.RecordedRobot`."""
    def attachments(self) -> list[str]:
        """The names of the files inside."""
    def attachment(self, name: str) -> bytes | None:
        """The bytes of a file inside; `None` if there is none of that name, or it is damaged."""
    def robot(self, name: str) -> RecordingFile:
        """The same for the robot of this name, where there are several. Raises `RecordingError`."""
    def between(self, begin: int | None = None, end: int | None = None) -> RecordingFile:
        """The same from one time to another, both included; `None` is as far as it goes."""
    def resampled(self, rate: float) -> RecordingFile:
        """The same at `rate` cycles per second of the robot's clock, 1000 at most: at each time the
        newest cycle that came before. Events and grippers are as they are.
        """
    def __iter__(self) -> Iterator[RecordedCycle]: ...
    def column(self, name: str) -> NDArray[Any]:
        """A column as a new array with a row for each cycle: one of `recording_columns()`, or `time`,
        the robot's clock, s, or `host_time`. Raises `ValueError`.
        """
    def columns(self, names: Sequence[str]) -> dict[str, NDArray[Any]]:
        """Columns as new arrays, in one go: a `dict` by name, `time` and `host_time` included."""
    def events(self) -> list[RecordedEvent]:
        """What happened, oldest first: a list of `recording.RecordedEvent`."""
    def episodes(self) -> list[Episode]:
        """The episodes, in their order: a list of `recording.Episode`. One without an end is left out."""
    def gripper_states(self) -> list[tuple[int, GripperState | VacuumGripperState]]:
        """What the gripper said of itself, oldest first: a list of tuples of time and `GripperState`
        or `VacuumGripperState`.
        """
    def to_csv(self, path: str | PathLike[str], columns: Sequence[str] | None = None, *, units: bool = True) -> int:
        """Writes a table as comma-separated text, a line for each cycle, and returns how many. First
        come `time`, ms of the robot's clock, and `host_time`; then these columns of
        `recording_columns()`, or all. The file has its name once it is complete, and never replaces
        another. With `units` the first line has the units. Raises `ExportError`, `ValueError`.
        """
    def to_parquet(self, path: str | PathLike[str], columns: Sequence[str] | None = None) -> int:
        """Writes a Parquet table, a row for each cycle, and returns how many; columns as of `to_csv`.
        The metadata of the file has the units, as JSON by the key `units`. The file has its name
        once it is complete, and never replaces another. Raises `ExportError`, `ValueError`.
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
        """Writes the episodes as a dataset in LeRobot's layout v3.0 to `folder`, which must not be
        there or be empty; returns how many episodes and frames. `append` adds them to the dataset
        that is there: twice, if the same recording is given twice. `fps` are frames per second.
        `robot_type` is `franka_fr3` or `franka_fer` unless given. `gripper`, whether its width is
        part of states and actions: by default, if the recording has one of a Hand. `action` is
        `reference`, where the arm was to be at the next frame, or `measured`, where it was: for
        demonstrations by hand. `episodes` are the names of those to write; all by default. Raises
        `ExportError`, `ValueError`; a dataset that is there is then as it was.
        """

@final
class _Cycles:
    """The cycles of a recording, one after the other. After an error `next()` goes on behind what is
    damaged.
    """
    def __iter__(self) -> _Cycles: ...
    def __next__(self) -> RecordedCycle: ...

@final
class RecordedCycle:
    """One cycle of a recording."""

    @property
    def host_time(self) -> int:
        """When this computer had the state, ns since 1970."""
    @property
    def state(self) -> RobotState:
        """What the robot said. Fields that recordings leave out are zero."""
    def __getitem__(self, name: str, /) -> Any: ...

def explain(of: RecordingFile | ControlError | ControlLog) -> Explanation:
    """What happened, and why a motion ended: of a `RecordingFile` or a part of one, of a
    `ControlError`, or of its log. What ended is the last motion that the robot stopped, a guard
    gave up or a lost link ended; if none did, it is the newest cycle. Raises `TypeError`, and
    `ValueError` for a recording that does not say which robot it is of.
    """

@final
class Explanation:
    """What happened in a series of cycles, and why a motion ended, as `explain` tells. `print`
    shows a report of a page, a notebook the figure as well. Times are the robot's clock, ms.
    """

    @property
    def robot(self) -> str:
        """The robot, `fr3` or `fer`."""
    @property
    def cycles(self) -> int:
        """How many cycles there were."""
    @property
    def first_ms(self) -> int:
        """The first cycle."""
    @property
    def last_ms(self) -> int:
        """The last cycle."""
    @property
    def end_ms(self) -> int:
        """The cycle that shows the end of the last motion that the robot stopped, a guard gave up or a
        lost link ended, of a guard that in which the arm rested; without one, the last cycle.
        """
    @property
    def end_host_time(self) -> int | None:
        """When this host had that cycle, ns since 1970: `recording.between(end=end_host_time - 1)`
        holds what came before. `None` where that is not known.
        """
    @property
    def earlier(self) -> int:
        """How many such ends came before."""
    @property
    def under_way(self) -> int | None:
        """The newest goal whose end was not recorded, where nothing has ended a motion."""
    @property
    def failed(self) -> str | None:
        """What the last goal that failed of itself said, as after a user stop or at an obstacle;
        `None` if the last one did not fail.
        """
    @property
    def cause(self) -> str | None:
        """Why that motion ended, in words: which limit was exceeded, what led up to it, what to
        change; `None` without such an end.
        """
    @property
    def errors(self) -> list[str]:
        """The errors that the robot named; none where a guard or a lost link ended the motion."""
    @property
    def findings(self) -> dict[str, Any] | None:
        """The diagnosis as data, as of `ControlError`; `None` where it is not known."""
    @property
    def timeline(self) -> list[Moment]:
        """What changed, oldest first: a list of `explanation.Moment`."""
    @property
    def margins(self) -> dict[str, Approach]:
        """The nearest approach to each limit, an `explanation.Approach` by what it is of: `position`,
        `velocity` and `torque` of joints, `translation` and `rotation` of the end effector.
        """
    @property
    def peaks(self) -> dict[str, Peak]:
        """The largest values, an `explanation.Peak` by what it is of: `external_torque`, `force`,
        `following_error`.
        """
    @property
    def contact(self) -> Contact | None:
        """Where something touched the arm as the motion ended, an `explanation.Contact`; `None` where
        the torques do not tell: `contact_unknown` says why.
        """
    @property
    def contact_unknown(self) -> str | None:
        """Why it is not known for sure what was touched, or nothing is known; `None` if it is."""
    @property
    def lost(self) -> int:
        """How many states were lost."""
    @property
    def late(self) -> int:
        """How many commands left after the next state was due."""
    def svg(self) -> str:
        """The last second before the end as an SVG image: what touched the arm, velocities and torques
        against their limits, what happened when, and where on the arm the contact was. It has no
        background, and colours that can be told apart on white and on black.
        """
    def _repr_html_(self) -> str:
        """What a notebook shows: the figure and the report."""

def recording_columns() -> dict[str, tuple[str, tuple[int, ...]]]:
    """What recordings in files have: a `dict` of each column's name to its unit and shape in one
    cycle.
    """
def record_columns() -> dict[str, tuple[str, tuple[int, ...]]]:
    """What can be recorded: a `dict` of each column's name to its unit and shape in one cycle."""
def enable_logging(level: int | str | None = None, *, queue: int = 4096) -> None:
    """Passes what the driver and the simulator report on to Python's `logging` from now on: to loggers
    below `franka_async`, such as `franka_async.bridge`, so
    `logging.getLogger("franka_async").setLevel(...)` and handlers choose as usual. Off by default:
    without this call, nothing is passed on.

    Reports below `level` are not even made: `trace`, `debug`, `info`, `warning` or `error`, in any
    case, or a number of `logging`; a later call changes it. What an event and the spans around it
    carry is in the message and in the record's `fields`, a `dict`; `record.rust_target` is the
    module. `trace` is the number 5.

    A thread of its own hands them on. No motion waits for it: where more than `queue` reports wait,
    of the first call, those that come then are dropped; a warning tells their number later.

    Raises `ValueError` for another level, and `RuntimeError` if another library in the process has
    taken what Rust reports.
    """
def _check_policy(policy: Policy) -> None:
    """Raises `ValueError` for a policy that makes no sense."""

_METRICS_CONTENT_TYPE: str

def _metrics(robots: Sequence[tuple[str, Robot]]) -> str:
    """The metrics of the robots that are connected, each with its value of the label `robot`, as one
    text.
    """
def _names() -> dict[str, dict[str, list[str]]]:
    """Returns all names, for the tests, which compare them with the types of Python and with the book:
    `errors` by class, `variants` by enum in the book, `values` by type in Python.
    """

@final
class StartTicket:
    """The part of one motion in a common start: made by `start_tickets`. One that goes before the
    start ends the wait of the others.
    """

def start_tickets(members: int, timeout: float = 10.0) -> list[StartTicket]:
    """Tickets of a common start, a list of one for each of `members` motions:
    `left.move_to(a, start_with=tickets[0])` and `right.move_to(b, start_with=tickets[1])`, awaited
    together, begin within a millisecond of each other, once all robots are ready. Such a motion
    supersedes nothing. If the others do not come within `timeout` seconds, or one is dropped
    before, it raises `MotionError` of the kind `start`, and nothing has moved.
    """

@final
class Team:
    """Two to four arms as one: `async with await Team.engage(left, right) as team:`. Their motions
    begin within a millisecond of each other, and the fault of one brakes the others within two
    cycles of their control threads, whatever Python is busy with.

    A joint motion returns a list of one `MotionReport` for each arm. If one of them has not
    arrived, it raises `TeamError` with `outcomes`, one for each arm, of which the error of the arm
    at fault is the cause. Cancelling a joint motion brakes all arms. When the last reference to the
    team and its arms goes, all brake and their sessions end.
    """

    @staticmethod
    def engage(*robots: Robot, silence: float = ..., **options: Unpack[TeamOptions]) -> Operation[Team]:
        """Begins a session for each robot, as `Robot.engage` does, with the same options for all:
        `speed`, `limits`, `gains`, `force_cap`, `leash`, `deviation`, `posture`, `speed_cap`;
        returns a `Team`. A robot that is silent for `silence` seconds brakes the others. Raises
        `MotionError` of the first arm that is not engaged; the others are then let go. Cancelling
        ends all sessions.
        """
    @property
    def arms(self) -> list[Arm]:
        """The arms, in the order of the robots."""
    def move_to(
        self, targets: Sequence[Destination], **options: Unpack[GoalOptions]
    ) -> Operation[list[MotionReport]]:
        """A motion of all arms, each to its target, which `Arm.move_to` takes; with the same options
        for all.
        """
    def run(self, motions: Sequence[Motion | Follow]) -> Operation[list[MotionReport]]:
        """A motion of all arms: `motions` are one of each arm, in their order,
        `[team.arms[0].move_to(a), team.arms[1].move_by(b)]`, which are then not to be awaited
        themselves. All begin together. An arm may follow a `Latest`, `team.arms[1].follow(latest)`:
        it begins with the first target, and the motion ends when the others have arrived and the
        `Latest` is closed.
        """
    def stop(self) -> None:
        """Brakes all arms, each within two of its cycles. Never waits, fit for any thread. Motions
        raise, the sessions go on and hold the arms. A joint motion that begins before every arm has
        seen the stop does not start, and raises in the same way.
        """
    def latch_stop(self) -> Operation[None]:
        """Brakes all arms as `stop` does, ends their sessions and latches the stop of each robot: see
        `Robot.latch_stop`. Waits until all rest, and raises `MotionError` of the first arm that was
        not seen to.
        """
    def release_stop(self) -> bool:
        """Releases the latched stop of each robot, and returns whether one was latched. The sessions
        have ended: the next motions are those of a new team.
        """
    def stopped(self) -> str | tuple[str, int] | None:
        """Why the newest joint motion, or what came after it, has stopped: `requested`, or the name of
        what happened with the number of the arm, `("robot_stopped", 1)`; `None` if nothing has.
        """
    def grasp(self, bases: Sequence[ArrayLike], object: ArrayLike) -> TeamGrasp:
        """Takes an object as held by all arms from now on, where it is: `bases` are the robots' base
        frames and `object` is the object's, poses in one frame of the program's choice. Nothing
        moves. Raises `MotionError` if a session has ended.
        """
    def disengage(self) -> Operation[list[MotionReport]]:
        """Brakes all arms, lets them go and ends their sessions. Raises `TeamError` if one ended
        otherwise.
        """
    def __aenter__(self) -> Operation[Team]: ...
    def __aexit__(self, kind: object = None, *_rest: object) -> Operation[None]: ...
    def __len__(self) -> int: ...

@final
class TeamGrasp:
    """An object that all arms of a team hold: made by `Team.grasp`."""

    def move_to(self, object: ArrayLike, **options: Unpack[GoalOptions]) -> Operation[list[MotionReport]]:
        """A motion of the object to this pose, in the frame of the bases, on a straight line; with
        options of `Arm.move_to` other than `limits`, the same for all arms. An arm that is held
        back holds up the others.
        """
    def measured(self) -> list[_Array]:
        """Where the object is by the newest state of each arm, in the frame of the bases: a list of
        `(4, 4)`.
        """
