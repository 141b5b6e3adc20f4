"""Made by ``tests/sync_stub.py`` from the stub of the native module."""

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
    """A session of target control: the arm is held, and goes from goal to goal without a stop in between."""

    def move_to(self, target: Destination, **options: Unpack[MotionOptions]) -> MotionReport:
        ...

    def replay(self, recording: RecordingFile, *, speed: float=1.0, source: Literal['reference', 'measured']='reference', targets: Literal['joints', 'poses']='joints') -> ReplayReport:
        ...

    def move_joints(self, q: ArrayLike, **options: Unpack[MotionOptions]) -> MotionReport:
        ...

    def move_by(self, way: ArrayLike, frame: Literal['base', 'tool']='base', from_arm: bool=False, **options: Unpack[MotionOptions]) -> MotionReport:
        ...

    def move_through(self, waypoints: Iterable[Target | Waypoint], blend: float=0.0, **options: Unpack[MotionOptions]) -> MotionReport:
        ...

    def follow(self, targets: Latest | Iterable[Target] | AsyncIterable[Target], **options: Unpack[FollowOptions]) -> MotionReport:
        ...

    def hold(self, **options: Unpack[MotionOptions]) -> MotionReport:
        ...

    def set(self, target: Destination) -> None:
        ...

    def try_set(self, target: Destination) -> None:
        ...

    def target(self) -> _Array | tuple[_Array, _Array] | Joints | None:
        ...

    def reference(self) -> Reference | None:
        ...

    def at_rest(self, timeout: float | None=None) -> bool:
        ...

    def chunk(self, points: ArrayLike | Chunk, dt: float | None=None, times: ArrayLike | None=None, *, velocities: ArrayLike | None=None, joints: bool=False, observed_at: RobotState | int | None=None, blend: float | None=None) -> None:
        ...

    def guide(self, axes: Sequence[bool]=..., elbow: bool=True) -> None:
        ...

    def tune(self, **options: Unpack[TuneOptions]) -> None:
        ...

    def disengage(self) -> MotionReport:
        ...

    def ended(self) -> MotionReport:
        ...

    def __enter__(self) -> Arm:
        ...

    def __exit__(self, kind: object=None, *_rest: object) -> None:
        ...

@final
class AsynchronousControl:
    """A motion between sparse joint targets that the robot itself plans."""

    def set_target(self, q: ArrayLike) -> None:
        ...

    def status(self) -> tuple[Literal['idle', 'executing', 'target_reached', 'aborted'], str | None]:
        ...

    def reached(self) -> None:
        ...

    def stop(self) -> None:
        ...

    def __enter__(self) -> AsynchronousControl:
        ...

    def __exit__(self, *_exception: object) -> None:
        ...

@final
class Gripper:
    """A Franka Hand at an address: ``async with Gripper(address) as gripper:``, or ``robot.gripper()``."""

    def __init__(self, address: str) -> None:
        ...

    @property
    def address(self) -> str:
        ...

    @property
    def is_connected(self) -> bool:
        ...

    def connect(self) -> Gripper:
        ...

    def disconnect(self) -> None:
        ...

    def __enter__(self) -> Gripper:
        ...

    def __exit__(self, *_exception: object) -> None:
        ...

    def state(self) -> GripperState:
        ...

    def states(self) -> Stream[GripperState]:
        ...

    def homing(self) -> bool:
        ...

    def move_to(self, width: float, speed: float=0.1) -> bool:
        ...

    def grasp(self, width: float, speed: float=0.1, force: float=20.0, epsilon_inner: float=0.005, epsilon_outer: float=0.005) -> bool:
        ...

    def stop(self) -> bool:
        ...

@final
class IdentificationPlan:
    """The motions that an identification makes, which are looked at before they run."""

    @property
    def waypoints(self) -> _Array:
        ...

    @property
    def duration(self) -> float:
        ...

    @property
    def reach_of_joints(self) -> _Array:
        ...

    @property
    def reach(self) -> float:
        ...

    @property
    def reach_down(self) -> float:
        ...

    def run(self) -> Identified:
        ...

@final
class Recorder:
    """A recording of robots in a file: ``async with Recorder.to_file(path) as recorder:``."""

    @staticmethod
    def to_file(path: str | PathLike[str], **options: Unpack[RecordOptions]) -> Recorder:
        ...

    @staticmethod
    def black_box(directory: str | PathLike[str], *, before: float=30.0, after: float=1.0, keep: int=20) -> Recorder:
        ...

    def attach(self, robot: Robot, name: str='', *, with_address: bool=False, capacity: int | None=None) -> None:
        ...

    def attach_team(self, team: Team, names: Sequence[str], *, with_address: bool=False, capacity: int | None=None) -> None:
        ...

    def attach_gripper(self, gripper: Gripper | VacuumGripper, robot: str='') -> None:
        ...

    def note(self, text: str) -> None:
        ...

    def episode(self, name: str, *, task: str) -> EpisodeUnderWay:
        ...

    def status(self) -> RecordStatus:
        ...

    def finish(self) -> RecordStatus:
        ...

    def __enter__(self) -> Recorder:
        ...

    def __exit__(self, kind: object=None, *_rest: object) -> None:
        ...

@final
class Robot:
    """A robot at an address: ``async with Robot(address) as robot:`` connects, and shuts down at the end."""

    def __init__(self, address: str, *, realtime: Literal['enforce', 'ignore'] | None=None, priority: int | None=None, cpu: int | None=None, version: Literal[5, 10] | None=None, connect_timeout: float | None=None, link_timeout: float | None=None, log_size: int | None=None, nominal_model: bool=False, known: Identified | None=None, supervise: Policy | bool | None=None, ask_before_recovery: Callable[[Reflex], bool] | None=None) -> None:
        ...

    def connect(self) -> Robot:
        ...

    def shutdown(self) -> None:
        ...

    def __enter__(self) -> Robot:
        ...

    def __exit__(self, *_exception: object) -> None:
        ...

    @property
    def address(self) -> str:
        ...

    @property
    def is_connected(self) -> bool:
        ...

    @property
    def fci_version(self) -> int:
        ...

    def state(self) -> RobotState:
        ...

    def states(self, rate: float | None=None) -> Stream[RobotState]:
        ...

    def state_stream(self) -> Stream[Reading]:
        ...

    def pose(self) -> _Array:
        ...

    def pose_at(self, q: ArrayLike) -> _Array:
        ...

    def reference(self) -> Reference | None:
        ...

    def budget(self) -> Budget:
        ...

    def margin(self, gains: Gains) -> Margin | None:
        ...

    def stop(self) -> None:
        ...

    def latch_stop(self) -> None:
        ...

    def release_stop(self) -> bool:
        ...

    @property
    def is_stop_latched(self) -> bool:
        ...

    def recover(self) -> None:
        ...

    def move_to(self, target: Destination, **options: Unpack[MotionOptions]) -> MotionReport:
        ...

    def replay(self, recording: RecordingFile, *, speed: float=1.0, source: Literal['reference', 'measured']='reference', targets: Literal['joints', 'poses']='joints') -> ReplayReport:
        ...

    def move_joints(self, q: ArrayLike, **options: Unpack[MotionOptions]) -> MotionReport:
        ...

    def move_by(self, way: ArrayLike, frame: Literal['base', 'tool']='base', from_arm: bool=False, **options: Unpack[MotionOptions]) -> MotionReport:
        ...

    def move_through(self, waypoints: Iterable[Target | Waypoint], blend: float=0.0, **options: Unpack[MotionOptions]) -> MotionReport:
        ...

    def follow(self, targets: Latest | Iterable[Target] | AsyncIterable[Target], **options: Unpack[FollowOptions]) -> MotionReport:
        ...

    def engage(self, **options: Unpack[EngageOptions]) -> Arm:
        ...

    def events(self) -> Stream[Event]:
        ...

    def health(self) -> Health:
        ...

    def health_changes(self) -> Stream[Health]:
        ...

    def agree(self, reflex: int, yes: bool=True) -> bool:
        ...

    def closed(self) -> CloseReason:
        ...

    def gripper(self) -> Gripper:
        ...

    def vacuum_gripper(self) -> VacuumGripper:
        ...

    def set_collision_behavior(self, *thresholds: ArrayLike, **named: ArrayLike) -> None:
        ...

    def set_joint_impedance(self, stiffness: ArrayLike) -> None:
        ...

    def set_cartesian_impedance(self, stiffness: ArrayLike) -> None:
        ...

    def set_guiding_mode(self, free: Sequence[bool], elbow: bool=True) -> None:
        ...

    def set_k(self, EE_T_K: ArrayLike) -> None:
        ...

    def set_ee(self, NE_T_EE: ArrayLike) -> None:
        ...

    def set_load(self, mass: float, center: ArrayLike | None=None, inertia: ArrayLike | None=None) -> None:
        ...

    def set_filters(self, *, joint_position: float=1000.0, joint_velocity: float=1000.0, cartesian_position: float=1000.0, cartesian_velocity: float=1000.0, controller: float=1000.0) -> None:
        ...

    def virtual_wall(self, id: int) -> VirtualWall:
        ...

    def urdf(self) -> str:
        ...

    def identify(self) -> IdentificationPlan:
        ...

    def tare(self, duration: float=0.5) -> WrenchTare:
        ...

    def stats(self) -> dict[str, Any]:
        ...

    def granted(self) -> dict[str, Any]:
        ...

    def metrics(self) -> str:
        ...

    def record(self, columns: Iterable[str], *, longest: float=3600.0) -> Recording:
        ...

    def active_torques(self) -> ActiveControl:
        ...

    def active_joint_positions(self, controller: Controller='joint_impedance') -> ActiveControl:
        ...

    def active_joint_velocities(self, controller: Controller='joint_impedance') -> ActiveControl:
        ...

    def active_cartesian_pose(self, controller: Controller='joint_impedance') -> ActiveControl:
        ...

    def active_cartesian_velocities(self, controller: Controller='joint_impedance') -> ActiveControl:
        ...

    def asynchronous_joint_positions(self, maximum_joint_velocities: ArrayLike | None=None, goal_tolerance: float | None=None) -> AsynchronousControl:
        ...

    def run_law(self, law: Any, *, command: _Command | None=None, elbow: bool=False, parameters: ArrayLike | None=None, memory: ArrayLike | None=None, controller: Controller='joint_impedance', limit_rate: bool | None=None, cutoff_frequency: float | None=None) -> MotionReport:
        ...

    def model(self) -> Model:
        ...

@final
class Team:
    """Two to four arms as one: motions that begin together, one stop."""

    @staticmethod
    def engage(*robots: Robot, silence: float=..., **options: Unpack[TeamOptions]) -> Team:
        ...

    @property
    def arms(self) -> list[Arm]:
        ...

    def move_to(self, targets: Sequence[Destination], **options: Unpack[GoalOptions]) -> list[MotionReport]:
        ...

    def run(self, motions: Sequence[Callable[[_native.Arm], Motion | Follow]]) -> list[MotionReport]:
        ...

    def stop(self) -> None:
        ...

    def latch_stop(self) -> None:
        ...

    def release_stop(self) -> bool:
        ...

    def stopped(self) -> str | tuple[str, int] | None:
        ...

    def grasp(self, bases: Sequence[ArrayLike], object: ArrayLike) -> TeamGrasp:
        ...

    def disengage(self) -> list[MotionReport]:
        ...

    def __enter__(self) -> Team:
        ...

    def __exit__(self, kind: object=None, *_rest: object) -> None:
        ...

    def __len__(self) -> int:
        ...

@final
class TeamGrasp:
    """An object that all arms of a team hold."""

    def move_to(self, object: ArrayLike, **options: Unpack[GoalOptions]) -> list[MotionReport]:
        ...

    def measured(self) -> list[_Array]:
        ...

@final
class VacuumGripper:
    """A vacuum gripper at an address: ``async with VacuumGripper(address) as gripper:``, or ``robot.vacuum_gripper()``."""

    def __init__(self, address: str) -> None:
        ...

    @property
    def address(self) -> str:
        ...

    @property
    def is_connected(self) -> bool:
        ...

    def connect(self) -> VacuumGripper:
        ...

    def disconnect(self) -> None:
        ...

    def __enter__(self) -> VacuumGripper:
        ...

    def __exit__(self, *_exception: object) -> None:
        ...

    def state(self) -> VacuumGripperState:
        ...

    def states(self) -> Stream[VacuumGripperState]:
        ...

    def vacuum(self, vacuum: int, timeout: float, profile: int=0) -> bool:
        ...

    def drop_off(self, timeout: float) -> bool:
        ...

    def stop(self) -> bool:
        ...
