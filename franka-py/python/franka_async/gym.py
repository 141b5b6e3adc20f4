"""Gymnasium environments over simulated robots in virtual time: no sockets, no clock, no other process.

::

    from franka_async import gym

    def reward(observation, action):  # of one robot, (69,), or of many, (n, 69)
        tip = gym.part(observation, "O_T_EE_position")
        return -np.linalg.norm(tip - [0.5, 0.2, 0.4], axis=-1)

    env = gym.FrankaEnv("fr3", action="cartesian_delta", reward=reward, max_steps=200)
    many = gym.FrankaVectorEnv(64, "fr3", action="cartesian_delta", reward=reward, max_steps=200)

Observations are ``RobotState.flat()``, ``(69,)``, in the order of ``FLAT_LAYOUT``. Actions are within -1 and 1, in units of
``action_scale``; they mean the same as in ``VirtualRobots``. If a robot stops itself the episode terminates, with ``reason``
(``reflex``) and ``errors`` (the vendor's names) in ``info``. The extra ``gym`` installs what this module needs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import FLAT_LAYOUT, RobotState, VirtualRobots

if TYPE_CHECKING:
    from typing_extensions import Unpack

try:
    import gymnasium
    from gymnasium.vector import AutoresetMode, VectorEnv
    from gymnasium.vector.utils import batch_space
except ImportError as _cause:
    raise ImportError("franka_async.gym needs Gymnasium: pip install 'franka-async[gym]'") from _cause

__all__ = [
    "ActionKind",
    "EnvOptions",
    "FrankaEnv",
    "FrankaVectorEnv",
    "Reward",
    "Start",
    "Terminate",
    "VectorOptions",
    "part",
]

Array: TypeAlias = NDArray[np.float64]

ActionKind: TypeAlias = Literal["joint_velocity", "joint_delta", "cartesian_delta", "torque"]

Reward: TypeAlias = Callable[[Array, Array], ArrayLike]
"""Reward for an observation, ``(69,)``, and the action that led to it. For many robots, one reward for each row of ``(n,
69)``."""

Terminate: TypeAlias = Callable[[Array], ArrayLike]
"""True if an episode ends with an observation, ``(69,)``. For many robots, one value for each row of ``(n, 69)``."""

Start: TypeAlias = Callable[[np.random.Generator], ArrayLike]
"""Joint positions, ``(7,)`` rad, at which an episode begins."""


def part(observation: Array, name: str) -> Array:
    """Returns the part of an observation, or of many, that ``FLAT_LAYOUT`` calls ``name``, as a view."""
    for known, begin, end in FLAT_LAYOUT:
        if known == name:
            return observation[..., begin:end]
    raise ValueError(f"name is {name!r}, expected one of {', '.join(known for known, _, _ in FLAT_LAYOUT)}")


class EnvOptions(TypedDict, total=False):
    """Options of an environment."""

    action: ActionKind
    """Meaning of an action, ``joint_velocity`` by default: see ``VirtualRobots``."""

    cycles: int
    """Milliseconds of the robot's time in a step, 20 by default."""

    action_scale: ArrayLike | None
    """Size of an action of 1: one number, or one for each axis. The default is the distance that the robot covers in one
    step at ``speed``; for torques it is a tenth of the largest torque."""

    arm: Literal["realistic", "ideal", "nominal", "bad", "sampled"]
    """``realistic`` by default. ``sampled`` draws another realistic arm for each episode."""

    hand: bool
    """True if the robot has a Franka Hand, the default."""

    speed: float
    """Share of the robot's largest velocity, 0.5 by default."""

    start: Start | None
    """Function that draws the joint positions at the beginning of an episode. The default is the ready pose, or
    ``options={"q": ...}`` of ``reset``."""

    reward: Reward | None
    """Function that computes the reward after each step. Without it, the reward is 0."""

    terminate: Terminate | None
    """Function that decides after each step if the episode ends, even if the robot has stopped itself."""

    max_steps: int | None
    """Number of steps after which an episode is truncated."""


class VectorOptions(EnvOptions, total=False):
    """Options of many environments."""

    threads: int
    """Threads that share the work of a step, 1 by default."""


class _Episodes:
    """Shared part of the two environments: robots, user functions, and the count of steps."""

    def __init__(
        self,
        count: int,
        robot: Literal["fr3", "fer"],
        *,
        action: ActionKind = "joint_velocity",
        cycles: int = 20,
        action_scale: ArrayLike | None = None,
        arm: Literal["realistic", "ideal", "nominal", "bad", "sampled"] = "realistic",
        hand: bool = True,
        speed: float = 0.5,
        threads: int = 1,
        start: Start | None = None,
        reward: Reward | None = None,
        terminate: Terminate | None = None,
        max_steps: int | None = None,
    ) -> None:
        if cycles < 1:
            raise ValueError(f"cycles is {cycles}, expected 1 or more")
        if max_steps is not None and max_steps < 1:
            raise ValueError(f"max_steps is {max_steps}, expected 1 or more, or None")
        self.robots = VirtualRobots(robot, count, control=action, arm=arm, hand=hand, speed=speed, threads=threads)
        self.cycles = cycles
        self.scale = _scale(self.robots.action_bound(cycles), action, action_scale)
        self.start, self.reward, self.terminate, self.max_steps = start, reward, terminate, max_steps
        self.steps = np.zeros(count, np.int64)
        size = self.robots.action_size
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (size,), np.float64)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (RobotState.FLAT_LEN,), np.float64)

    def begin(self, index: int, random: np.random.Generator, options: dict[str, Any] | None) -> Array:
        """Begins an episode of one robot, and returns its observation, ``(69,)``."""
        q = (options or {}).get("q")
        if q is None and self.start is not None:
            q = self.start(random)
        self.robots.reset(index, seed=int(random.integers(2**63)), q=q)
        self.steps[index] = 0
        return self.robots.state(index).flat()

    def advance(self, actions: Array) -> tuple[Array, Array, NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
        """Performs a step. Returns observations, rewards, and for each robot: terminated, truncated, stopped by the robot
        itself.
        """
        count = len(self.robots)
        observations, running = self.robots.step(np.clip(actions, -1.0, 1.0) * self.scale, self.cycles)
        self.steps += 1
        rewards = np.zeros(count)
        if self.reward is not None:
            rewards[:] = _per_robot("reward", self.reward(observations, actions), count)
        terminated = ~running
        if self.terminate is not None:
            terminated |= _per_robot("terminate", self.terminate(observations), count).astype(bool)
        truncated = np.zeros(count, bool)
        if self.max_steps is not None:
            truncated = ~terminated & (self.steps >= self.max_steps)
        return observations, rewards, terminated, truncated, ~running

    def why(self, index: int, terminated: bool, truncated: bool, stopped: bool) -> dict[str, Any]:
        """Returns the ``info`` of a robot after a step."""
        if stopped:
            return {"reason": "reflex", "errors": self.robots.errors(index)}
        if terminated:
            return {"reason": "terminated"}
        return {"reason": "max_steps"} if truncated else {}


def _scale(bound: Array, action: ActionKind, scale: ArrayLike | None) -> Array:
    if scale is None:
        # A tenth of the largest torque moves a gravity-compensated arm fast enough.
        return bound * 0.1 if action == "torque" else bound
    scale = np.asarray(scale, np.float64)
    if scale.shape not in ((), bound.shape):
        raise ValueError(f"action_scale has the shape {scale.shape}, expected () or {bound.shape}")
    if not (np.isfinite(scale) & (scale > 0.0)).all():
        raise ValueError("action_scale has numbers that are not positive and finite, expected positive finite numbers")
    return np.broadcast_to(scale, bound.shape).copy()


def _per_robot(name: str, returned: ArrayLike, count: int) -> NDArray[Any]:
    values = np.asarray(returned)
    if values.shape not in ((count,), ()) or (values.shape == () and count > 1):
        raise ValueError(f"{name} returned the shape {values.shape}, expected ({count},): one for each robot")
    return values


class FrankaEnv(gymnasium.Env[Array, Array]):
    """One simulated robot.

    ``robot`` is ``fr3`` or ``fer``; ``EnvOptions`` has the keyword arguments.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(self, robot: Literal["fr3", "fer"] = "fr3", **options: Unpack[EnvOptions]) -> None:
        self._episodes = _Episodes(1, robot, **options)
        self.action_space = self._episodes.action_space
        self.observation_space = self._episodes.observation_space

    @property
    def robots(self) -> VirtualRobots:
        """The robot, as number 0 of a group of one. Use it to push the robot, or to read whole states."""
        return self._episodes.robots

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        """Begins an episode, at the joint positions ``options["q"]`` if given."""
        super().reset(seed=seed)
        return self._episodes.begin(0, self.np_random, options), {}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Performs an action for ``cycles`` milliseconds of the robot's time."""
        actions = np.asarray(action, np.float64)[None]
        results = self._episodes.advance(actions)
        observation, reward, terminated, truncated, stopped = (result[0] for result in results)
        info = self._episodes.why(0, terminated, truncated, stopped)
        return observation, float(reward), bool(terminated), bool(truncated), info


class FrankaVectorEnv(VectorEnv[Array, Array, NDArray[Any]]):
    """Many simulated robots in one process. One call steps all of them, while the interpreter is free for other threads.

    The arguments are the arguments of ``FrankaEnv``, and ``threads``. ``reward`` and ``terminate`` get all robots together, ``(n,
    69)``. After an episode has ended, the next step begins another episode and ignores the action
    (``AutoresetMode.NEXT_STEP``). Robot i behaves as a ``FrankaEnv`` that is reset with ``seed + i``.
    """

    metadata: dict[str, Any] = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(self, num_envs: int, robot: Literal["fr3", "fer"] = "fr3", **options: Unpack[VectorOptions]) -> None:
        self._episodes = _Episodes(num_envs, robot, **options)
        self.num_envs = num_envs
        self.single_action_space = self._episodes.action_space
        self.single_observation_space = self._episodes.observation_space
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._random = [np.random.default_rng() for _ in range(num_envs)]
        self._ended = np.zeros(num_envs, bool)

    @property
    def robots(self) -> VirtualRobots:
        """The robots. Use them to push robots, or to read whole states."""
        return self._episodes.robots

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begins an episode of every robot, or of the robots that the array ``options["reset_mask"]``, ``(n,)``, selects."""
        options = dict(options or {})
        mask = np.asarray(options.pop("reset_mask", np.ones(self.num_envs, bool)))
        if mask.shape != (self.num_envs,) or mask.dtype != bool:
            raise ValueError(f"reset_mask has the shape {mask.shape} of {mask.dtype}, expected ({self.num_envs},) of bool")
        seeds: list[int | None]
        if seed is None or isinstance(seed, (int, np.integer)):
            seeds = [None if seed is None else int(seed) + i for i in range(self.num_envs)]
        else:
            seeds = list(seed)
        if len(seeds) != self.num_envs:
            raise ValueError(f"seed has {len(seeds)} numbers, expected {self.num_envs}")
        for i in np.flatnonzero(mask):
            if seeds[i] is not None:
                self._random[i], _ = gymnasium.utils.seeding.np_random(seeds[i])
            self._episodes.begin(int(i), self._random[i], options)
        self._ended[mask] = False
        return self._episodes.robots.observations(), {}

    def step(self, actions: Array) -> tuple[Array, NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Performs an action of every robot for ``cycles`` milliseconds of the robots' time, and begins new episodes for
        those that have ended.
        """
        begun = self._ended.copy()
        results = self._episodes.advance(np.asarray(actions, np.float64))
        observations, rewards, terminated, truncated, stopped = results
        for i in np.flatnonzero(begun):
            observations[i] = self._episodes.begin(int(i), self._random[i], None)
        for values in (terminated, truncated):
            values[begun] = False
        rewards[begun] = 0.0
        infos: dict[str, Any] = {}
        for i in np.flatnonzero(terminated | truncated):
            info = self._episodes.why(int(i), terminated[i], truncated[i], stopped[i])
            infos = self._add_info(infos, info, int(i))
        self._ended = terminated | truncated
        return observations, rewards, terminated, truncated, infos


for _robot in ("fr3", "fer"):
    gymnasium.register(
        f"franka_async/{_robot.upper()}-v0",
        entry_point="franka_async.gym:FrankaEnv",
        vector_entry_point="franka_async.gym:FrankaVectorEnv",
        kwargs={"robot": _robot},
    )
