"""Made by ``tests/sync_stub.py`` from the stub of the native module."""

from collections.abc import AsyncIterable, Iterable, Sequence
from typing import Literal, TypeAlias, final
import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Unpack
from .goal import Budget, Chunk, Destination, Gains, Joints, Margin, Target, Waypoint
from .motion import MotionReport, Reference
from .options import EngageOptions, FollowOptions, MotionOptions, TuneOptions
from .streams import Reading, Stream
from ._native import Latest, RobotState

__all__ = ['Arm', 'Robot']

_Array: TypeAlias = NDArray[np.float64]

@final
class Arm:
    """A session of target control: the arm is held, and goes from goal to goal without a stop in between."""

    def move_to(self, target: Destination, **options: Unpack[MotionOptions]) -> MotionReport:
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

    def at_rest(self) -> None:
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
class Robot:
    """A robot at an address: ``async with Robot(address) as robot:`` connects, and shuts down at the end."""

    def __init__(self, address: str, *, realtime: Literal['enforce', 'ignore'] | None=None, priority: int | None=None, cpu: int | None=None, version: Literal[5, 10] | None=None, connect_timeout: float | None=None, link_timeout: float | None=None, log_size: int | None=None, nominal_model: bool=False, known: str | None=None, supervise: bool=False) -> None:
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

    def recover(self) -> None:
        ...

    def move_to(self, target: Destination, **options: Unpack[MotionOptions]) -> MotionReport:
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
