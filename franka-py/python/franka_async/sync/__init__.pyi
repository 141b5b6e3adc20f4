"""Made by ``tests/stubs.py`` from the stub of the native module."""

from collections.abc import AsyncIterable, Callable, Iterable, Sequence
from os import PathLike
from typing import Any, Literal, TypeAlias, final
import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Unpack
from ..goal import Budget, Chunk, Controller, Destination, Gains, Joints, Margin, Target, Waypoint
from ..motion import MotionReport, Reference
from ..options import EngageOptions, FollowOptions, GoalOptions, MotionOptions, RecordOptions, TeamOptions, TuneOptions
from ..recording import RecordStatus, ReplayReport
from ..settings import VirtualWall
from ..streams import Reading, Stream, TaredState
from ..supervision import CloseReason, Event, Health, Policy, Reflex
from .._native import ActiveControl, EpisodeUnderWay, Follow, GripperState, Identified, Latest, Model, Motion, Recording, RecordingFile, RobotState, VacuumGripperState, WrenchTare
from .. import _native
from . import tools as tools

__all__ = ['Arm', 'AsynchronousControl', 'Gripper', 'IdentificationPlan', 'Recorder', 'Robot', 'Team', 'TeamGrasp', 'VacuumGripper', 'tools']

_Array: TypeAlias = NDArray[np.float64]

_Command: TypeAlias = Literal['torques', 'joint_positions', 'joint_velocities', 'cartesian_pose', 'cartesian_velocities']

@final
class Arm:
    """A session of target control: the arm is held, and moves from goal to goal without a stop in
    between, for all kinds of goals. Created by `Robot.engage`.

    When its last reference is dropped, the arm brakes and the session ends, in the background;
    `disengage()` does the same and can be awaited. `Robot.stop` or a reflex also ends the session:
    later calls then raise the reason. During the session, motions of the `Robot` itself are refused
    as `busy`.
    """

    def move_to(self, target: Destination, **options: Unpack[MotionOptions]) -> MotionReport:
        """Like `Robot.move_to`; the arm is then held at the target. Cancelling it brakes and holds the
        arm.
        """

    def replay(self, recording: RecordingFile, *, speed: float=1.0, source: Literal['reference', 'measured']='reference', targets: Literal['joints', 'poses']='joints') -> ReplayReport:
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

    def move_joints(self, q: ArrayLike, **options: Unpack[MotionOptions]) -> MotionReport:
        """Like `Robot.move_joints`; the arm is then held."""

    def move_by(self, way: ArrayLike, frame: Literal['base', 'tool']='base', from_arm: bool=False, **options: Unpack[MotionOptions]) -> MotionReport:
        """Like `Robot.move_by`, relative to the target at which the arm is held; the arm is then held."""

    def move_through(self, waypoints: Iterable[Target | Waypoint], blend: float=0.0, **options: Unpack[MotionOptions]) -> MotionReport:
        """Like `Robot.move_through`; the arm is then held."""

    def follow(self, targets: Latest | Iterable[Target] | AsyncIterable[Target], **options: Unpack[FollowOptions]) -> MotionReport:
        """Like `Robot.follow`; the arm is then held at the last target."""

    def hold(self, **options: Unpack[MotionOptions]) -> MotionReport:
        """Brakes the arm in any motion, and completes when it is at rest; the arm is then held there."""

    def set(self, target: Destination) -> None:
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

    def at_rest(self, timeout: float | None=None) -> bool:
        """Waits until the arm is at rest at the last accepted target, or where that target was
        aborted; returns `True` if it is. Without a `timeout` it waits indefinitely for an arm that
        is pushed or blocked, or that follows a stream; `False` means that it was not at rest within
        `timeout` seconds. Cancelling has no effect on the arm.
        """

    def chunk(self, points: ArrayLike | Chunk, dt: float | None=None, times: ArrayLike | None=None, *, velocities: ArrayLike | None=None, joints: bool=False, observed_at: RobotState | int | None=None, blend: float | None=None) -> None:
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

    def guide(self, axes: Sequence[bool]=..., elbow: bool=True) -> None:
        """Allows hand guiding, once the arm is at rest, until the next goal; `hold()` ends the
        guiding. `axes` are the free directions: along x y z and about x y z of the base frame, six
        truth values; the other directions are held. Completes as soon as the request is accepted.
        Declare the load first, or it pulls the arm down.
        """

    def tune(self, **options: Unpack[TuneOptions]) -> None:
        """Changes the given options among `gains`, `limits`, `force_cap`, `leash`, `deviation` and
        `posture`, for the current goal and for later goals. Gains change gradually over 0.3 s.
        """

    def disengage(self) -> MotionReport:
        """Brakes and releases the arm, ends the session, and returns a `MotionReport`. The motion
        under way raises `stopped`. If the session ended for a different reason, raises this reason.
        """

    def ended(self) -> MotionReport:
        """Waits until the session has ended, and returns its report or raises the reason. Cancelling
        has no effect on the arm.
        """

    def __enter__(self) -> Arm:
        ...

    def __exit__(self, kind: object=None, *_rest: object) -> None:
        ...

@final
class AsynchronousControl:
    """A motion between sparse joint targets that the robot itself plans. Any thread may set targets.
    The robot stops if you call `stop()` or drop this object.
    """

    def set_target(self, q: ArrayLike) -> None:
        """Moves the robot to `q`, `(7,)` rad, replacing the previous target. Raises the reason if the
        motion has ended.
        """

    def status(self) -> tuple[Literal['idle', 'executing', 'target_reached', 'aborted'], str | None]:
        """Status of the newest target: `idle`, `executing`, `target_reached` or `aborted`; and the
        reason if it was aborted.
        """

    def reached(self) -> None:
        """Waits until the newest target is reached. Raises the reason if the motion ends earlier.
        Cancelling does not stop the robot.
        """

    def stop(self) -> None:
        """Stops the robot. A second call has no effect."""

    def __enter__(self) -> AsynchronousControl:
        ...

    def __exit__(self, *_exception: object) -> None:
        ...

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

    def __init__(self, address: str) -> None:
        ...

    @property
    def address(self) -> str:
        """Address: as given, and resolved once it is connected."""

    @property
    def is_connected(self) -> bool:
        """True if there is a connection. A lost connection counts until `disconnect()`."""

    def connect(self) -> Gripper:
        """Connects, and returns this object; without effect while it is connected. Raises
        `ConnectError`. Cancelling aborts the connection.
        """

    def disconnect(self) -> None:
        """Closes the connection, without waiting. A running action is stopped. Without effect
        if there is no connection.
        """

    def __enter__(self) -> Gripper:
        ...

    def __exit__(self, *_exception: object) -> None:
        ...

    def state(self) -> GripperState:
        """Newest state, without waiting."""

    def states(self) -> Stream[GripperState]:
        """Newest state as it changes, for `async for`. Ends with the connection."""

    def homing(self) -> bool:
        """Determines the largest opening of the fingers, `max_width` of the state; returns `True` on
        success. Needed once after power-on and after a change of fingers. Raises `ActionError`;
        cancelling stops the fingers.
        """

    def move_to(self, width: float, speed: float=0.1) -> bool:
        """Moves the fingers to `width`, m, at `speed`, m/s (the Hand's largest speed is 0.1, and
        higher values are not refused); returns `True` if they arrived. Raises `ActionError`;
        cancelling stops the fingers.
        """

    def grasp(self, width: float, speed: float=0.1, force: float=20.0, epsilon_inner: float=0.005, epsilon_outer: float=0.005) -> bool:
        """Closes the fingers on an object of this `width`, m, at `speed`, m/s, and holds it with
        `force`, N. Returns `True` if they ended at most `epsilon_inner` narrower and
        `epsilon_outer` wider, m. The force stays applied in both cases, until the next action or
        `stop()`. Raises `ActionError`; cancelling stops the fingers and releases the object.
        """

    def stop(self) -> bool:
        """Stops the fingers and releases the object; returns `True` on success. The running action
        raises `ActionError`. Once begun, the stop continues even if it is cancelled.
        """

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

    def run(self) -> Identified:
        """Moves the arm, and returns an `Identified`. The robot's settings do not change: pass the
        result to `Robot(address, known=...)` of later connections, and declare the load with
        `set_load` if needed. Raises `MotionError`, and `IdentifyError` if the arm has moved since
        the plan, or was held or pushed. Cancelling brakes the arm and discards the measurement.
        """

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
    def black_box(directory: str | PathLike[str], *, before: float=30.0, after: float=1.0, keep: int=20) -> Recorder:
        """Keeps only the last `before` seconds, 1 to 300, in memory. When a motion ends because of a
        reflex, a lost link or a guard, it writes them to a file in `directory`, together with the
        following `after` seconds, at most 60. The file is named by time, robot and cause. The
        newest `keep` files are kept.

        Raises `RecordError`, `ValueError`.
        """

    def attach(self, robot: Robot, name: str='', *, with_address: bool=False, capacity: int | None=None) -> None:
        """Records a connected robot from now on: every cycle, goals and their outcomes, diagnoses,
        events and requests; if the robot is supervised, also after a reconnect. `name`, of letters,
        digits, `-` and `_`, distinguishes the robots of a recording. `with_address` stores the
        network address. `capacity` is the number of cycles that may wait for the recorder, 4096 by
        default. Raises `RecordError`, `ValueError`. Cancelling aborts it.
        """

    def attach_team(self, team: Team, names: Sequence[str], *, with_address: bool=False, capacity: int | None=None) -> None:
        """Records the robots of a team, each with its name and its member number; otherwise like
        `attach`. If an error concerns one robot, the previous ones are recorded.
        """

    def attach_gripper(self, gripper: Gripper | VacuumGripper, robot: str='') -> None:
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

    def finish(self) -> RecordStatus:
        """Ends the recording and waits, at most 10 s, until all of it is on the disk, including the
        events before the call. Returns the `recording.RecordStatus`, also if it has already ended.
        Raises `RecordError` if the files could not be completed; the written data is readable. Once
        begun, it continues even if it is cancelled.
        """

    def __enter__(self) -> Recorder:
        ...

    def __exit__(self, kind: object=None, *_rest: object) -> None:
        ...

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

    def __init__(self, address: str, *, realtime: Literal['enforce', 'ignore'] | None=None, priority: int | None=None, cpu: int | None=None, version: Literal[5, 10] | None=None, connect_timeout: float | None=None, link_timeout: float | None=None, log_size: int | None=None, nominal_model: bool=False, accept_geometry_error: bool=False, known: Identified | None=None, supervise: Policy | bool | None=None, ask_before_recovery: Callable[[Reflex], bool] | None=None) -> None:
        ...

    def connect(self) -> Robot:
        """Connects, and returns this robot. If the robot is already connected, nothing changes. Raises
        `ConnectError`. Cancelling aborts the connection.
        """

    def shutdown(self) -> None:
        """Brakes and ends any motion, and closes the connection, if there is one. Once begun, it
        continues even if it is cancelled.
        """

    def __enter__(self) -> Robot:
        ...

    def __exit__(self, *_exception: object) -> None:
        ...

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

    def states(self, rate: float | None=None) -> Stream[RobotState]:
        """Newest state as it changes, for `async for` or `for`. If `rate` is given, at most `rate`
        states per second, by the robot's clock. If several states arrive while the program is busy,
        only the newest is returned. Ends with the connection.
        """

    def tared_states(self, tare: WrenchTare, rate: float | None=None) -> Stream[TaredState]:
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

    def stop(self) -> None:
        """Brakes any motion, and waits until it has ended and a state shows the arm at rest. The
        braked motion raises `MotionError` of the kind `stopped` at once, while the arm still
        brakes. If another task requests a motion meanwhile, this motion begins: `stop` then raises
        `MotionError` of the kind `superseded`. It raises other kinds if the arm was not seen to be
        at rest: `protocol`, `not_at_rest`, `link_lost`, `connection_closed`. If people keep the arm
        in motion for two seconds, the robot's own controller stops it; the wait ends within eight
        seconds. Once begun, it continues even if it is cancelled.
        """

    def latch_stop(self) -> None:
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

    def recover(self) -> None:
        """Recovers the robot from a reflex, and waits until it accepts motions again. If no recovery
        is needed, nothing happens. It does not command a motion. Raises `CommandError`.
        """

    def move_to(self, target: Destination, **options: Unpack[MotionOptions]) -> MotionReport:
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

    def replay(self, recording: RecordingFile, *, speed: float=1.0, source: Literal['reference', 'measured']='reference', targets: Literal['joints', 'poses']='joints') -> ReplayReport:
        """Moves to the beginning of a recorded motion, repeats it, and releases the arm. This is
        `Arm.replay` in a session with default options.
        """

    def move_joints(self, q: ArrayLike, **options: Unpack[MotionOptions]) -> MotionReport:
        """A motion of the joints to `q`, 7 numbers, rad; all joints arrive together. Options as for
        `move_to`.
        """

    def move_by(self, way: ArrayLike, frame: Literal['base', 'tool']='base', from_arm: bool=False, **options: Unpack[MotionOptions]) -> MotionReport:
        """A motion of the end effector relative to its position, or to the target of the current
        motion. The offset is 3 numbers, m, or 6, with a rotation vector, rad, along and about the
        axes of the `base` or the `tool`. With `from_arm` it is always relative to the measured
        position. Options as for `move_to`.
        """

    def move_through(self, waypoints: Iterable[Target | Waypoint], blend: float=0.0, **options: Unpack[MotionOptions]) -> MotionReport:
        """A motion through several poses, or several `Joints`, to the last of them, without a stop at
        rounded corners: within `blend` (m; rad for joints), or within the blend of each `Waypoint`.
        Options as for `move_to`.
        """

    def follow(self, targets: Latest | Iterable[Target] | AsyncIterable[Target], **options: Unpack[FollowOptions]) -> MotionReport:
        """Follows the newest of `targets` until they end, and then stops at the last target. A target
        is a pose or `Joints`, alone or in a pair with its velocity. `targets` is a `Latest`, which
        any thread sets; an asynchronous iterator, which runs in the event loop that awaits; or a
        plain iterator, which runs on a separate thread and may wait.

        Options as for `move_to`, and `lead`, a `Lead`: the largest distance of a target ahead of
        the arm; and `watchdog`, a pair of a time in seconds and the reaction, `brake` or `hold`, if
        no target arrives for this time. The motion and the watchdog begin with the first target. An
        exception of the iterator brakes the arm and is raised.
        """

    def engage(self, **options: Unpack[EngageOptions]) -> Arm:
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

    def agree(self, reflex: int, yes: bool=True) -> bool:
        """Approves or rejects the recovery from the reflex with this number, for a `Policy` that asks
        first. Returns `True` if the policy was waiting for the answer. The number is in the event
        and in `health().reflex`.
        """

    def closed(self) -> CloseReason:
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

    def set_collision_behavior(self, *thresholds: ArrayLike, **named: ArrayLike) -> None:
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

    def set_joint_impedance(self, stiffness: ArrayLike) -> None:
        """Sets the stiffness of the robot's own joint impedance controller, `(7,)` N m/rad, each 0 to
        14250. Raises and is cancelled like `set_collision_behavior`.
        """

    def set_cartesian_impedance(self, stiffness: ArrayLike) -> None:
        """Sets the stiffness of the robot's own Cartesian impedance controller in the stiffness frame,
        `(6,)`: x y z, 10 to 3000 N/m, and roll pitch yaw, 1 to 300 N m/rad. Raises and is cancelled
        like `set_collision_behavior`.
        """

    def set_guiding_mode(self, free: Sequence[bool], elbow: bool=True) -> None:
        """Sets the free directions in hand guiding: six truth values, x y z and roll pitch yaw, and
        the `elbow`. Raises and is cancelled like `set_collision_behavior`.
        """

    def set_k(self, EE_T_K: ArrayLike) -> None:
        """Sets the stiffness frame in the end effector's, `EE_T_K`: a pose. The vendor does not
        document a range; the simulator refuses a distance of more than 2 m. Resolves when a state
        shows it. Raises and is cancelled like `set_collision_behavior`.
        """

    def set_ee(self, NE_T_EE: ArrayLike) -> None:
        """Sets the end effector in the nominal end effector's frame, `NE_T_EE`: a pose. Range and
        completion are as for `set_k`. Raises and is cancelled like `set_collision_behavior`.
        """

    def set_load(self, mass: float, center: ArrayLike | None=None, inertia: ArrayLike | None=None) -> None:
        """Declares the load in addition to the end effector: `mass`, kg; `center` of mass in the
        flange frame, `(3,)` m; `inertia` about it, `(3, 3)` or its nine numbers, kg m^2, zero
        unless given.

        The vendor does not document a range. The simulator refuses more than 10 kg, a centre more
        than 1 m away, and an inertia that is not physical or has a principal moment above 1 kg m^2.
        Resolves when a state shows it. Raises and is cancelled like `set_collision_behavior`.
        """

    def set_filters(self, *, joint_position: float=1000.0, joint_velocity: float=1000.0, cartesian_position: float=1000.0, cartesian_velocity: float=1000.0, controller: float=1000.0) -> None:
        """Sets the cutoff frequencies of the robot's own low-pass filters, each 1 to 1000 Hz; 1000
        disables a filter. Franka Emika Robot only, and deprecated by the vendor. Raises and is
        cancelled like `set_collision_behavior`; `CommandError` of the kind `request` if the robot
        has no such command.
        """

    def virtual_wall(self, id: int) -> VirtualWall:
        """Reads the virtual wall `id` from the configuration in Desk; returns a `VirtualWall`. Franka
        Emika Robot only. Raises `CommandError`, of the kind `request` if the robot has no such
        command.
        """

    def urdf(self) -> str:
        """Reads the robot's description; returns URDF text. Franka Research 3 only. Raises
        `CommandError`, of the kind `request` if the robot has no such command.
        """

    def identify(self) -> IdentificationPlan:
        """Plans motions that determine friction and bias of the joints and the load at the flange. In
        each of six poses around the current position, all joints move 0.2 rad back and forth twice,
        at 0.2 rad/s: about a minute in total. The arm does not move before `run()` of the plan is
        awaited. It must have free space, see `reach`, and carry the tool to be identified.
        """

    def tare(self, duration: float=0.5) -> WrenchTare:
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

    def record(self, columns: Iterable[str], *, longest: float=3600.0) -> Recording:
        """Records these columns of every cycle, of `record_columns()`, while a `with` or `async with`
        block runs: see `Recording`. It keeps the first `longest` seconds. Raises `ValueError` for
        an unknown column.
        """

    def active_torques(self) -> ActiveControl:
        """Begins control by torques, `(7,)` N m, without gravity and friction. Returns an
        `ActiveControl`. The first command is due within a few milliseconds: read at once on the
        controlling thread. Raises `MotionError`, of the kind `busy` while another motion controls
        the arm. Cancelling stops the robot.
        """

    def active_joint_positions(self, controller: Controller='joint_impedance') -> ActiveControl:
        """Begins control by joint positions, `(7,)` rad, for one of the robot's own controllers,
        `joint_impedance` or `cartesian_impedance`; with `external_controller` every command also
        needs torques. Otherwise like `active_torques`.
        """

    def active_joint_velocities(self, controller: Controller='joint_impedance') -> ActiveControl:
        """Begins control by joint velocities, `(7,)` rad/s; otherwise like `active_joint_positions`."""

    def active_cartesian_pose(self, controller: Controller='joint_impedance') -> ActiveControl:
        """Begins control by poses of the end effector in the base frame, `(4, 4)` or 3 + 4 numbers
        with a quaternion `x y z w`; otherwise like `active_joint_positions`.
        """

    def active_cartesian_velocities(self, controller: Controller='joint_impedance') -> ActiveControl:
        """Begins control by twists of the end effector in the base frame, `(6,)` m/s and rad/s;
        otherwise like `active_joint_positions`.
        """

    def asynchronous_joint_positions(self, maximum_joint_velocities: ArrayLike | None=None, goal_tolerance: float | None=None) -> AsynchronousControl:
        """Begins a motion in which the robot itself moves to sparse joint targets. Returns an
        `AsynchronousControl`. Protocol 10 (Franka Research 3) only, and experimental there.

        `maximum_joint_velocities` are `(7,)` rad/s. A target counts as reached within
        `goal_tolerance`, in rad as Euclidean norm. Raises `MotionError`: `unsupported` with another
        protocol, `busy` while another motion controls the arm. Cancelling stops the robot.
        """

    def run_law(self, law: Any, *, command: _Command | None=None, elbow: bool=False, parameters: ArrayLike | None=None, memory: ArrayLike | None=None, controller: Controller='joint_impedance', limit_rate: bool | None=None, cutoff_frequency: float | None=None) -> MotionReport:
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
    def engage(*robots: Robot, silence: float=..., **options: Unpack[TeamOptions]) -> Team:
        """Begins a session for each robot, like `Robot.engage`, with the same options for all:
        `speed`, `limits`, `gains`, `force_cap`, `leash`, `deviation`, `posture`, `speed_cap`;
        returns a `Team`. If a robot is silent for `silence` seconds, the other arms brake. Raises
        `MotionError` of the first arm that could not be engaged; the other arms are then released.
        Cancelling ends all sessions.
        """

    @property
    def arms(self) -> list[Arm]:
        """The arms, in the order of the robots."""

    def move_to(self, targets: Sequence[Destination], **options: Unpack[GoalOptions]) -> list[MotionReport]:
        """A motion of all arms, each to its own target as in `Arm.move_to`, with the same options for
        all arms.
        """

    def run(self, motions: Sequence[Callable[[_native.Arm], Motion | Follow]]) -> list[MotionReport]:
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

    def latch_stop(self) -> None:
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

    def disengage(self) -> list[MotionReport]:
        """Brakes and releases all arms and ends their sessions. Raises `TeamError` if a session ended
        in another way.
        """

    def __enter__(self) -> Team:
        ...

    def __exit__(self, kind: object=None, *_rest: object) -> None:
        ...

    def __len__(self) -> int:
        ...

@final
class TeamGrasp:
    """An object that all arms of a team hold: created by `Team.grasp`."""

    def move_to(self, object: ArrayLike, **options: Unpack[GoalOptions]) -> list[MotionReport]:
        """A motion of the object to this pose, in the frame of the bases, on a straight line; with
        options of `Arm.move_to` except `limits`, the same for all arms. If one arm is blocked, the
        others wait.
        """

    def measured(self) -> list[_Array]:
        """Pose of the object from the newest state of each arm, in the frame of the bases: a list of
        `(4, 4)`.
        """

@final
class VacuumGripper:
    """A vacuum gripper, with its own connection in addition to the robot's. Connection, actions and
    their ends work as for `Gripper`; cancelling an action stops the pump.
    """

    def __init__(self, address: str) -> None:
        ...

    @property
    def address(self) -> str:
        """Address: as given, and resolved once it is connected."""

    @property
    def is_connected(self) -> bool:
        """True if there is a connection. A lost connection counts until `disconnect()`."""

    def connect(self) -> VacuumGripper:
        """Connects, and returns this object; without effect while it is connected. Raises
        `ConnectError`. Cancelling aborts the connection.
        """

    def disconnect(self) -> None:
        """Closes the connection, without waiting. A running action is stopped. Without effect
        if there is no connection.
        """

    def __enter__(self) -> VacuumGripper:
        ...

    def __exit__(self, *_exception: object) -> None:
        ...

    def state(self) -> VacuumGripperState:
        """Newest state, without waiting."""

    def states(self) -> Stream[VacuumGripperState]:
        """Newest state as it changes, for `async for`. Ends with the connection."""

    def vacuum(self, vacuum: int, timeout: float, profile: int=0) -> bool:
        """Picks up an object and holds it; returns `True` if the vacuum was reached within `timeout`
        seconds, which are sent in whole milliseconds. `vacuum` is in units of 10 mbar, 0 to 255;
        `profile` is a production set-up profile of the device, 0 to 3. Raises `ActionError`;
        cancelling stops the pump.
        """

    def drop_off(self, timeout: float) -> bool:
        """Drops the object; returns `True` if this succeeded within `timeout` seconds. Raises
        `ActionError`; cancelling stops the pump.
        """

    def stop(self) -> bool:
        """Stops the current action, which raises `ActionError`; returns `True` on success. Once begun,
        the stop continues even if it is cancelled.
        """
