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
from ..streams import Reading, Stream
from ..supervision import CloseReason, Event, Health, Policy, Reflex
from .._native import ActiveControl, EpisodeUnderWay, Follow, GripperState, Identified, Latest, Model, Motion, Recording, RecordingFile, RobotState, VacuumGripperState, WrenchTare
from .. import _native
from . import tools as tools

__all__ = ['Arm', 'AsynchronousControl', 'Gripper', 'IdentificationPlan', 'Recorder', 'Robot', 'Team', 'TeamGrasp', 'VacuumGripper', 'tools']

_Array: TypeAlias = NDArray[np.float64]

_Command: TypeAlias = Literal['torques', 'joint_positions', 'joint_velocities', 'cartesian_pose', 'cartesian_velocities']

@final
class Arm:
    """A session of target control: the arm is held, and goes from goal to goal without a stop in
    between, whatever their kinds. Made by `Robot.engage`.

    When the last reference to it goes, the arm brakes and the session ends, in the background;
    `disengage()` does the same and can be awaited. `Robot.stop` ends it from outside, as does the
    robot by a reflex: whatever is asked of the session afterwards raises the reason. While it
    lasts, motions of the `Robot` itself are refused as `busy`.
    """

    def move_to(self, target: Destination, **options: Unpack[MotionOptions]) -> MotionReport:
        """As `Robot.move_to`; the arm is then held at the target. Cancelling it brakes the arm and
        holds it.
        """

    def replay(self, recording: RecordingFile, *, speed: float=1.0, source: Literal['reference', 'measured']='reference', targets: Literal['joints', 'poses']='joints') -> ReplayReport:
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

    def move_joints(self, q: ArrayLike, **options: Unpack[MotionOptions]) -> MotionReport:
        """As `Robot.move_joints`; the arm is then held."""

    def move_by(self, way: ArrayLike, frame: Literal['base', 'tool']='base', from_arm: bool=False, **options: Unpack[MotionOptions]) -> MotionReport:
        """As `Robot.move_by`, from the target that the arm is held at; the arm is then held."""

    def move_through(self, waypoints: Iterable[Target | Waypoint], blend: float=0.0, **options: Unpack[MotionOptions]) -> MotionReport:
        """As `Robot.move_through`; the arm is then held."""

    def follow(self, targets: Latest | Iterable[Target] | AsyncIterable[Target], **options: Unpack[FollowOptions]) -> MotionReport:
        """As `Robot.follow`; the arm is then held at the last target."""

    def hold(self, **options: Unpack[MotionOptions]) -> MotionReport:
        """Brakes, whatever the arm is doing, and is over when it rests; it is then held there."""

    def set(self, target: Destination) -> None:
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

    def at_rest(self, timeout: float | None=None) -> bool:
        """Waits until the arm rests at the target that was taken last, or where that has been given
        up; returns whether it does. Without a `timeout` it waits for ever for an arm that is pushed
        or held back, or that follows a stream; `False` says that it did not rest within so many
        seconds. Cancelling has no effect on the arm.
        """

    def chunk(self, points: ArrayLike | Chunk, dt: float | None=None, times: ArrayLike | None=None, *, velocities: ArrayLike | None=None, joints: bool=False, observed_at: RobotState | int | None=None, blend: float | None=None) -> None:
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

    def guide(self, axes: Sequence[bool]=..., elbow: bool=True) -> None:
        """Lets a hand guide the arm, once it rests, until the next goal; `hold()` ends it. `axes` are
        free: x y z and about x y z of the base frame, six truth values; the others stay where
        they are. Over as soon as it is taken. The load has to be declared, or it pulls the arm
        down.
        """

    def tune(self, **options: Unpack[TuneOptions]) -> None:
        """Changes `gains`, `limits`, `force_cap`, `leash`, `deviation` and `posture`, as far as they
        are given, of the goal under way and of those to come. Gains fade over 0.3 s.
        """

    def disengage(self) -> MotionReport:
        """Brakes, lets the arm go and ends the session, with a `MotionReport`; a goal under way raises
        `stopped`. Raises how the session ended if it ended otherwise.
        """

    def ended(self) -> MotionReport:
        """Waits until the session has ended, and returns or raises how. Cancelling has no effect on
        the arm.
        """

    def __enter__(self) -> Arm:
        ...

    def __exit__(self, kind: object=None, *_rest: object) -> None:
        ...

@final
class AsynchronousControl:
    """A motion between sparse joint targets that the robot itself plans. Any thread may set targets.
    `stop()`, or dropping it, has the robot stop.
    """

    def set_target(self, q: ArrayLike) -> None:
        """Sends the robot to `q`, `(7,)` rad, wherever it was going before. Raises what ended the
        motion, if it has ended.
        """

    def status(self) -> tuple[Literal['idle', 'executing', 'target_reached', 'aborted'], str | None]:
        """How far the newest target has been followed: `idle`, `executing`, `target_reached` or
        `aborted`; and why it was aborted, if it was.
        """

    def reached(self) -> None:
        """Waits until the newest target is reached. Raises what ended the motion before. Cancelling
        leaves the robot on its way.
        """

    def stop(self) -> None:
        """Has the robot stop. Without effect once it was stopped."""

    def __enter__(self) -> AsynchronousControl:
        ...

    def __exit__(self, *_exception: object) -> None:
        ...

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

    def __init__(self, address: str) -> None:
        ...

    @property
    def address(self) -> str:
        """Where it is: as given, and resolved once it is connected."""

    @property
    def is_connected(self) -> bool:
        """Whether there is a connection. One that was lost counts until `disconnect()`."""

    def connect(self) -> Gripper:
        """Connects, and returns this object; without effect while it is connected. Raises
        `ConnectError`. Cancelling gives it up.
        """

    def disconnect(self) -> None:
        """Closes the connection, without waiting. An action under way is stopped. Without
        effect if there is no connection.
        """

    def __enter__(self) -> Gripper:
        ...

    def __exit__(self, *_exception: object) -> None:
        ...

    def state(self) -> GripperState:
        """The newest state, without waiting."""

    def states(self) -> Stream[GripperState]:
        """The newest state as it changes, for `async for`. Ends when the connection does."""

    def homing(self) -> bool:
        """Finds how wide the fingers open, `max_width` of the state; returns whether that succeeded.
        Needed once after power-on and after a change of fingers. Raises `ActionError`; cancelling
        stops the fingers.
        """

    def move_to(self, width: float, speed: float=0.1) -> bool:
        """Moves the fingers to `width`, m, at `speed`, m/s (the Hand's most is 0.1, and more is not
        refused); returns whether they arrived. Raises `ActionError`; cancelling stops the fingers.
        """

    def grasp(self, width: float, speed: float=0.1, force: float=20.0, epsilon_inner: float=0.005, epsilon_outer: float=0.005) -> bool:
        """Closes the fingers on an object of this `width`, m, at `speed`, m/s, and holds it with
        `force`, N. Returns whether they ended at most `epsilon_inner` narrower and `epsilon_outer`
        wider, m; the force stays applied either way, until the next action or `stop()`. Raises
        `ActionError`; cancelling stops the fingers and lets go.
        """

    def stop(self) -> bool:
        """Stops the fingers and lets go of what they hold; returns whether that succeeded. The action
        that runs raises `ActionError`. Once it has begun, it goes on even if it is cancelled.
        """

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

    def run(self) -> Identified:
        """Moves the arm, and returns an `Identified`. Nothing is changed at the robot: pass the result
        to `Robot(address, known=...)` of later connections, and declare the load by `set_load` if
        you like. Raises `MotionError`, and `IdentifyError` if the arm is no longer where this was
        planned, or was held or pushed. Cancelling brakes the arm; what was measured is lost.
        """

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
    def black_box(directory: str | PathLike[str], *, before: float=30.0, after: float=1.0, keep: int=20) -> Recorder:
        """Keeps the last `before` seconds, 1 to 300, in memory only. When a motion ends by a reflex, a
        lost link or a guard, it writes them and the `after` seconds that follow, 60 at most, to a
        file in `directory`, named by time, robot and cause. The newest `keep` files are kept.

        Raises `RecordError`, `ValueError`.
        """

    def attach(self, robot: Robot, name: str='', *, with_address: bool=False, capacity: int | None=None) -> None:
        """Records a robot, which is connected, from now on: every cycle, goals and how they end,
        diagnoses, events and requests; of a supervised robot also after it was connected to again.
        `name`, of letters, digits, `-` and `_`, tells several robots of a recording apart.
        `with_address` writes the network address down. `capacity` is how many cycles may wait for
        the recorder, 4096 by default. Raises `RecordError`, `ValueError`. Cancelling gives it up.
        """

    def attach_team(self, team: Team, names: Sequence[str], *, with_address: bool=False, capacity: int | None=None) -> None:
        """Records the robots of a team, each under its name, and which member each is; otherwise like
        `attach`. Robots before the one that an error is about are recorded.
        """

    def attach_gripper(self, gripper: Gripper | VacuumGripper, robot: str='') -> None:
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

    def finish(self) -> RecordStatus:
        """Ends the recording and waits, 10 s at most, until all of it is on the disk: what has
        happened before the call is in it. Returns the `recording.RecordStatus`, again if it has
        ended. Raises `RecordError` if the files could not be written to their end; what was written
        is readable. Once it has begun, it goes on even if it is cancelled.
        """

    def __enter__(self) -> Recorder:
        ...

    def __exit__(self, kind: object=None, *_rest: object) -> None:
        ...

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

    def __init__(self, address: str, *, realtime: Literal['enforce', 'ignore'] | None=None, priority: int | None=None, cpu: int | None=None, version: Literal[5, 10] | None=None, connect_timeout: float | None=None, link_timeout: float | None=None, log_size: int | None=None, nominal_model: bool=False, accept_geometry_error: bool=False, known: Identified | None=None, supervise: Policy | bool | None=None, ask_before_recovery: Callable[[Reflex], bool] | None=None) -> None:
        ...

    def connect(self) -> Robot:
        """Connects, and returns this robot; without effect while it is connected. Raises
        `ConnectError`. Cancelling gives it up.
        """

    def shutdown(self) -> None:
        """Brakes whatever moves, ends it and closes the connection; without effect if there is none.
        Once it has begun, it goes on even if it is cancelled.
        """

    def __enter__(self) -> Robot:
        ...

    def __exit__(self, *_exception: object) -> None:
        ...

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

    def states(self, rate: float | None=None) -> Stream[RobotState]:
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

    def stop(self) -> None:
        """Brakes whatever moves, and waits until the motion has ended and a state shows the arm at
        rest; that motion raises `MotionError` of the kind `stopped` at once, while the arm still
        brakes. A motion that another task asks for meanwhile takes over: `stop` then raises
        `MotionError` of the kind `superseded`. It raises others if the arm was not seen to rest:
        `protocol`, `not_at_rest`, `link_lost`, `connection_closed`. An arm that hands keep in motion
        for two seconds is stopped by the robot's own controller; the wait is over after eight. Once
        it has begun, it goes on even if it is cancelled.
        """

    def latch_stop(self) -> None:
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

    def recover(self) -> None:
        """Recovers the robot from a reflex, and waits until it takes motions again; without effect if
        there is nothing to recover from. Moves nothing. Raises `CommandError`.
        """

    def move_to(self, target: Destination, **options: Unpack[MotionOptions]) -> MotionReport:
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

    def replay(self, recording: RecordingFile, *, speed: float=1.0, source: Literal['reference', 'measured']='reference', targets: Literal['joints', 'poses']='joints') -> ReplayReport:
        """Moves to where a recorded motion begins, makes it again, and lets the arm go: a session with
        the defaults, and `Arm.replay` in it.
        """

    def move_joints(self, q: ArrayLike, **options: Unpack[MotionOptions]) -> MotionReport:
        """A motion of the joints to `q`, 7 numbers, rad; all arrive together. Options as of `move_to`."""

    def move_by(self, way: ArrayLike, frame: Literal['base', 'tool']='base', from_arm: bool=False, **options: Unpack[MotionOptions]) -> MotionReport:
        """A motion of the end effector away from where it is, or from the target of a motion under
        way: 3 numbers, m, or 6, with a rotation vector, rad; along and about the axes of the
        `base` or the `tool`. `from_arm` counts from the measured arm in any case. Options as of
        `move_to`.
        """

    def move_through(self, waypoints: Iterable[Target | Waypoint], blend: float=0.0, **options: Unpack[MotionOptions]) -> MotionReport:
        """A motion through several poses, or several `Joints`, to the last of them, without a stop
        where the corner is rounded: within `blend` (m; rad for joints), or as each `Waypoint`
        says. Options as of `move_to`.
        """

    def follow(self, targets: Latest | Iterable[Target] | AsyncIterable[Target], **options: Unpack[FollowOptions]) -> MotionReport:
        """Follows the newest of `targets`, poses or `Joints`, alone or with velocities as a pair,
        until they end, and then comes to rest at the last one. `targets` is a `Latest`, which
        any thread sets; an asynchronous iterator, which runs in the event loop that awaits; or
        a plain one, which runs on a thread of its own and may wait.

        Options as of `move_to`, and `lead`, a `Lead`: how far ahead of the arm a target may be; and
        `watchdog`, a pair of seconds and `brake` or `hold`: what happens if no target comes for so
        long. Nothing begins before the first target, and no watchdog counts until then. What the
        iterator raises brakes the arm and is raised.
        """

    def engage(self, **options: Unpack[EngageOptions]) -> Arm:
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

    def agree(self, reflex: int, yes: bool=True) -> bool:
        """Agrees, or not, to the recovery from the reflex of this number: for a `Policy` that asks
        first. Returns whether that was awaited. The number is that of the event or of
        `health().reflex`.
        """

    def closed(self) -> CloseReason:
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

    def set_collision_behavior(self, *thresholds: ArrayLike, **named: ArrayLike) -> None:
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

    def set_joint_impedance(self, stiffness: ArrayLike) -> None:
        """Sets the stiffness of the robot's own joint impedance controller, `(7,)` N m/rad, each 0 to
        14250. Raises and is cancelled as `set_collision_behavior`.
        """

    def set_cartesian_impedance(self, stiffness: ArrayLike) -> None:
        """Sets the stiffness of the robot's own Cartesian impedance controller in the stiffness frame,
        `(6,)`: x y z, 10 to 3000 N/m, and roll pitch yaw, 1 to 300 N m/rad. Raises and is cancelled
        as `set_collision_behavior`.
        """

    def set_guiding_mode(self, free: Sequence[bool], elbow: bool=True) -> None:
        """Sets which directions are free in hand guiding: six truth values, x y z and roll pitch yaw,
        and whether the `elbow` is. Raises and is cancelled as `set_collision_behavior`.
        """

    def set_k(self, EE_T_K: ArrayLike) -> None:
        """Sets the stiffness frame in the end effector's, `EE_T_K`: a pose. The vendor documents no
        range; the simulator refuses what is more than 2 m away. Resolves when a state shows it.
        Raises and is cancelled as `set_collision_behavior`.
        """

    def set_ee(self, NE_T_EE: ArrayLike) -> None:
        """Sets the end effector in the nominal end effector's frame, `NE_T_EE`: a pose. Its range,
        and when it resolves, are as of `set_k`. Raises and is cancelled as
        `set_collision_behavior`.
        """

    def set_load(self, mass: float, center: ArrayLike | None=None, inertia: ArrayLike | None=None) -> None:
        """Declares the load beyond the end effector: `mass`, kg; `center` of mass in the flange frame,
        `(3,)` m; `inertia` about it, `(3, 3)` or its nine numbers, kg m^2, zero unless given.

        The vendor documents no range. The simulator refuses more than 10 kg, a centre more than 1 m
        away, and an inertia that no body has or with a principal moment above 1 kg m^2. Resolves
        when a state shows it. Raises and is cancelled as `set_collision_behavior`.
        """

    def set_filters(self, *, joint_position: float=1000.0, joint_velocity: float=1000.0, cartesian_position: float=1000.0, cartesian_velocity: float=1000.0, controller: float=1000.0) -> None:
        """Sets the cutoff frequencies of the robot's own low-pass filters, each 1 to 1000 Hz; 1000
        switches a filter off. Franka Emika Robot only, and deprecated by the vendor. Raises and is
        cancelled as `set_collision_behavior`; `CommandError` of the kind `request` from a robot
        that has no such command.
        """

    def virtual_wall(self, id: int) -> VirtualWall:
        """Reads the virtual wall `id` as it is set up in Desk; returns a `VirtualWall`. Franka Emika
        Robot only. Raises `CommandError`, of the kind `request` from a robot that has no such
        command.
        """

    def urdf(self) -> str:
        """Reads the robot's description of itself; returns URDF text. Franka Research 3 only. Raises
        `CommandError`, of the kind `request` from a robot that has no such command.
        """

    def identify(self) -> IdentificationPlan:
        """Plans motions that show friction and bias of the joints and the load at the flange: in each
        of six poses around where the arm is, all joints go 0.2 rad to and fro twice, at 0.2 rad/s,
        about a minute in all. Nothing moves before `run()` of the plan is awaited. The arm has to
        be free to go so far, see `reach`, and to carry what it is to be identified with.
        """

    def tare(self, duration: float=0.5) -> WrenchTare:
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

    def record(self, columns: Iterable[str], *, longest: float=3600.0) -> Recording:
        """Records these columns of every cycle, of `record_columns()`, while a `with` or `async with`
        block runs: see `Recording`. It keeps the first `longest` seconds. Raises `ValueError` for a
        column that is not known.
        """

    def active_torques(self) -> ActiveControl:
        """Begins control by torques, `(7,)` N m, without gravity and friction. Returns an
        `ActiveControl`. The first command is due within a few milliseconds: read on the thread that
        controls at once. Raises `MotionError`, of the kind `busy` while anything else controls the
        arm. Cancelling has the robot stop.
        """

    def active_joint_positions(self, controller: Controller='joint_impedance') -> ActiveControl:
        """Begins control by joint positions, `(7,)` rad, for one of the robot's own controllers,
        `joint_impedance` or `cartesian_impedance`; with `external_controller` every command needs
        torques beside it. Otherwise like `active_torques`.
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

        `maximum_joint_velocities` are `(7,)` rad/s; within `goal_tolerance`, in rad as Euclidean
        norm, a target counts as reached. Raises `MotionError`: `unsupported` by another protocol,
        `busy` while anything else controls the arm. Cancelling has the robot stop.
        """

    def run_law(self, law: Any, *, command: _Command | None=None, elbow: bool=False, parameters: ArrayLike | None=None, memory: ArrayLike | None=None, controller: Controller='joint_impedance', limit_rate: bool | None=None, cutoff_frequency: float | None=None) -> MotionReport:
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
    def engage(*robots: Robot, silence: float=..., **options: Unpack[TeamOptions]) -> Team:
        """Begins a session for each robot, as `Robot.engage` does, with the same options for all:
        `speed`, `limits`, `gains`, `force_cap`, `leash`, `deviation`, `posture`, `speed_cap`;
        returns a `Team`. A robot that is silent for `silence` seconds brakes the others. Raises
        `MotionError` of the first arm that is not engaged; the others are then let go. Cancelling
        ends all sessions.
        """

    @property
    def arms(self) -> list[Arm]:
        """The arms, in the order of the robots."""

    def move_to(self, targets: Sequence[Destination], **options: Unpack[GoalOptions]) -> list[MotionReport]:
        """A motion of all arms, each to its target, which `Arm.move_to` takes; with the same options
        for all.
        """

    def run(self, motions: Sequence[Callable[[_native.Arm], Motion | Follow]]) -> list[MotionReport]:
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

    def latch_stop(self) -> None:
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

    def disengage(self) -> list[MotionReport]:
        """Brakes all arms, lets them go and ends their sessions. Raises `TeamError` if one ended
        otherwise.
        """

    def __enter__(self) -> Team:
        ...

    def __exit__(self, kind: object=None, *_rest: object) -> None:
        ...

    def __len__(self) -> int:
        ...

@final
class TeamGrasp:
    """An object that all arms of a team hold: made by `Team.grasp`."""

    def move_to(self, object: ArrayLike, **options: Unpack[GoalOptions]) -> list[MotionReport]:
        """A motion of the object to this pose, in the frame of the bases, on a straight line; with
        options of `Arm.move_to` other than `limits`, the same for all arms. An arm that is held
        back holds up the others.
        """

    def measured(self) -> list[_Array]:
        """Where the object is by the newest state of each arm, in the frame of the bases: a list of
        `(4, 4)`.
        """

@final
class VacuumGripper:
    """A vacuum gripper, which has a connection of its own beside the robot's. What `Gripper` says of
    connecting, of actions and of their ends holds for it as well; cancelling an action stops the
    pump.
    """

    def __init__(self, address: str) -> None:
        ...

    @property
    def address(self) -> str:
        """Where it is: as given, and resolved once it is connected."""

    @property
    def is_connected(self) -> bool:
        """Whether there is a connection. One that was lost counts until `disconnect()`."""

    def connect(self) -> VacuumGripper:
        """Connects, and returns this object; without effect while it is connected. Raises
        `ConnectError`. Cancelling gives it up.
        """

    def disconnect(self) -> None:
        """Closes the connection, without waiting. An action under way is stopped. Without
        effect if there is no connection.
        """

    def __enter__(self) -> VacuumGripper:
        ...

    def __exit__(self, *_exception: object) -> None:
        ...

    def state(self) -> VacuumGripperState:
        """The newest state, without waiting."""

    def states(self) -> Stream[VacuumGripperState]:
        """The newest state as it changes, for `async for`. Ends when the connection does."""

    def vacuum(self, vacuum: int, timeout: float, profile: int=0) -> bool:
        """Sucks an object on and holds it; returns whether the vacuum was reached within `timeout`
        seconds, which go out in whole milliseconds. `vacuum` is in units of 10 mbar, 0 to 255;
        `profile` is a production set-up profile of the device, 0 to 3. Raises `ActionError`;
        cancelling stops the pump.
        """

    def drop_off(self, timeout: float) -> bool:
        """Drops the object; returns whether that was done within `timeout` seconds. Raises
        `ActionError`; cancelling stops the pump.
        """

    def stop(self) -> bool:
        """Stops the action that runs, which raises `ActionError`; returns whether that succeeded. Once
        it has begun, it goes on even if it is cancelled.
        """
