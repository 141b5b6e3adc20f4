"""Environments: Gymnasium's own check, many equal to one, reflexes, limits kept, seeds."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any, get_args

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from numpy.typing import NDArray

from franka_async import Model, VirtualRobots, gym

Array = NDArray[np.float64]

KINDS: list[Any] = list(get_args(gym.ActionKind))


@pytest.mark.parametrize("action", KINDS)
@pytest.mark.parametrize("robot", ["fr3", "fer"])
def test_the_environment_passes_gymnasiums_check(robot: Any, action: Any) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Observations are numbers without bounds.
        warnings.filterwarnings("ignore", ".*Box observation space (minimum|maximum) value is -?infinity.*")
        check_env(gym.FrankaEnv(robot, action=action), skip_render_check=True)


@pytest.mark.parametrize("action", KINDS)
def test_many_robots_act_as_one_each(action: Any) -> None:
    def reward(observation: Array, action: Array) -> Any:
        return gym.part(observation, "dq").sum(axis=-1) + action[..., 0]

    def start(random: np.random.Generator) -> Array:
        q = random.uniform(-0.2, 0.2, 7) + [0.0, -0.8, 0.0, -2.4, 0.0, 1.6, 0.8]
        return np.asarray(q)

    hooks: dict[str, Any] = dict(action=action, reward=reward, start=start, max_steps=7, arm="sampled", speed=0.3)
    many = gym.FrankaVectorEnv(3, threads=2, **hooks)
    ones = [gym.FrankaEnv(**hooks) for _ in range(3)]
    observations, _ = many.reset(seed=5)
    for i, one in enumerate(ones):
        np.testing.assert_array_equal(one.reset(seed=5 + i)[0], observations[i])
    many.action_space.seed(1)
    ended = [False] * 3
    for _ in range(20):
        actions = many.action_space.sample()
        observations, rewards, terminated, truncated, infos = many.step(actions)
        for i, one in enumerate(ones):
            if ended[i]:
                expected: Any = (one.reset()[0], 0.0, False, False, {})
            else:
                expected = one.step(actions[i])
            np.testing.assert_array_equal(observations[i], expected[0])
            assert (rewards[i], terminated[i], truncated[i]) == expected[1:4]
            ended[i] = expected[2] or expected[3]
            if ended[i]:
                assert infos["reason"][i] == expected[4]["reason"] and infos["_reason"][i]


def test_seeds_and_actions_decide_everything() -> None:
    def run(seed: int) -> Array:
        env = gym.FrankaEnv(arm="sampled", action="torque")
        env.reset(seed=seed)
        return np.stack([env.step(np.full(7, 0.05))[0] for _ in range(5)])

    np.testing.assert_array_equal(run(3), run(3))
    assert (run(3) != run(4)).any()


def test_a_reflex_ends_the_episode_and_says_why() -> None:
    env = gym.FrankaEnv(cycles=1, arm="ideal")
    env.reset(seed=0)
    env.robots.push(0, [0.0, 0.0, -300.0, 0.0, 0.0, 0.0], 500)
    for _ in range(500):
        observation, reward, terminated, truncated, info = env.step(np.zeros(7))
        if terminated:
            break
    assert terminated and not truncated and reward == 0.0
    assert info["reason"] == "reflex" and info["errors"] == ["cartesian_reflex"]
    assert env.robots.state(0).robot_mode == "reflex"
    np.testing.assert_array_equal(env.step(np.ones(7))[0], observation)
    observation, _ = env.reset()
    assert env.robots.state(0).robot_mode == "move"
    assert not env.step(np.zeros(7))[2]


@pytest.mark.parametrize("kind", ["fr3", "fer"])
@pytest.mark.parametrize("control", ["joint_velocity", "joint_delta", "cartesian_delta"])
@pytest.mark.parametrize("speed", [0.3, 1.0])
def test_no_action_breaks_a_limit_of_the_generator(kind: Any, control: Any, speed: float) -> None:
    robots = VirtualRobots(kind, 4, control=control, speed=speed, arm="ideal")
    random, bound = np.random.default_rng(7), robots.action_bound(20)
    limits, stops = Model.fr3().joint_limits if kind == "fr3" else Model.fer().joint_limits, set()
    for step in range(150):
        if step % 15 == 0:
            actions = np.sign(random.uniform(-1.0, 1.0, (4, len(bound)))) * bound * random.choice([1.0, 5.0])
        observations, running = robots.step(actions, 20)
        assert limits.contains(gym.part(observations, "q_d")).all()
        for i in np.flatnonzero(~running):
            stops.update(robots.errors(int(i)))
            robots.reset(int(i), seed=step)
    # Wild motions may come too near to the arm itself, and swing the hand too fast.
    allowed = {"self_collision_avoidance_violation", "cartesian_reflex", "cartesian_velocity_violation"}
    assert stops <= allowed


def test_actions_do_what_they_say() -> None:
    def run(control: Any, action: list[float], steps: int) -> tuple[Any, Any]:
        robots = VirtualRobots("fr3", control=control, arm="ideal")
        before = robots.state(0)
        for _ in range(steps):
            robots.step([action], 20)
        return before, robots.state(0)

    _, after = run("joint_velocity", [0.1, 0.0, 0.0, 0.0, 0.0, 0.0, -0.2], 50)
    np.testing.assert_allclose(after.dq_d, [0.1, 0, 0, 0, 0, 0, -0.2], atol=1e-6)
    robots = VirtualRobots("fr3", control="joint_delta", arm="ideal")
    before = robots.state(0)
    robots.step([[0.0, 0.0, 0.05, 0.0, 0.0, 0.0, -0.05]], 20)
    robots.step([[0.0] * 7], 2000)
    np.testing.assert_allclose(robots.state(0).q - before.q, [0, 0, 0.05, 0, 0, 0, -0.05], atol=2e-3)
    robots = VirtualRobots("fr3", control="cartesian_delta", arm="ideal")
    before = robots.state(0)
    robots.step([[0.02, 0.0, -0.03, 0.0, 0.0, 0.1]], 20)
    robots.step([[0.0] * 6], 2000)
    after = robots.state(0)
    np.testing.assert_allclose((after.O_T_EE_d - before.O_T_EE_d)[:3, 3], [0.02, 0.0, -0.03], atol=1e-5)
    turned = after.O_T_EE_d[:3, :3] @ before.O_T_EE_d[:3, :3].T
    np.testing.assert_allclose(turned, [[np.cos(0.1), -np.sin(0.1), 0], [np.sin(0.1), np.cos(0.1), 0], [0, 0, 1]], atol=1e-5)
    _, after = run("torque", [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], 2)
    assert after.tau_J_d[6] == pytest.approx(1.0) and after.dq[6] > 0.1


def test_hooks_end_and_truncate() -> None:
    env = gym.FrankaEnv(terminate=lambda observation: gym.part(observation, "q")[..., 0] > 0.05, max_steps=5)
    env.reset(seed=0)
    ends = [env.step(np.array([0.0, 0, 0, 0, 0, 0, 0]))[2:] for _ in range(5)]
    assert ends[-1] == (False, True, {"reason": "max_steps"}) and ends[-2] == (False, False, {})
    env.reset(options={"q": [0.04, -0.8, 0.0, -2.4, 0.0, 1.6, 0.8]})
    ends = [env.step(np.array([1.0, 0, 0, 0, 0, 0, 0]))[2:] for _ in range(5)]
    assert (True, False, {"reason": "terminated"}) in ends


def test_environments_are_made_by_name() -> None:
    env = gymnasium.make("franka_async/FER-v0", action="torque")
    observation, _ = env.reset(seed=1)
    assert observation.shape == (69,)
    many = gymnasium.make_vec("franka_async/FR3-v0", 2, vectorization_mode="vector_entry_point")
    assert many.reset(seed=1)[0].shape == (2, 69)
    many.reset(seed=1, options={"reset_mask": np.array([True, False])})


def unknown(name: str) -> Any:
    """A name that types would not let pass."""
    return name


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: VirtualRobots(unknown("ur5")), "kind is \"ur5\", expected one of fr3, fer"),
        (lambda: VirtualRobots(control=unknown("pose")), "control is \"pose\", expected one of joint_velocity, "),
        (lambda: VirtualRobots(arm=unknown("new")), "arm is \"new\", expected one of realistic, ideal"),
        (lambda: VirtualRobots(speed=0.0), "speed is 0, expected a share above 0 and up to 1"),
        (lambda: VirtualRobots(count=0), "count is 0 and threads 1, expected 1 or more"),
        (lambda: VirtualRobots().step([0.0] * 7), r"actions has the shape \[7\], expected \(1, 7\)"),
        (lambda: VirtualRobots().step([[np.nan] * 7]), "actions holds NaN"),
        (lambda: VirtualRobots().reset(0, q=[9.0] * 7), "expected positions within the joint limits"),
        (lambda: gym.FrankaEnv(cycles=0), "cycles is 0"),
        (lambda: gym.FrankaEnv(max_steps=0), "max_steps is 0"),
        (lambda: gym.FrankaEnv(action_scale=[1.0]), r"action_scale has the shape \(1,\), expected \(\) or \(7,\)"),
        (lambda: gym.FrankaEnv(action_scale=-1.0), "action_scale has numbers that are not positive"),
        (lambda: gym.part(np.zeros(69), "pose"), "name is 'pose', expected one of q, dq, "),
        (lambda: gym.FrankaVectorEnv(2).reset(seed=[1]), "seed has 1 numbers, expected 2"),
        (lambda: gym.FrankaVectorEnv(2, reward=lambda o, a: [0.0]).step(np.zeros((2, 7))), "reward returned the shape"),
        (lambda: gym.FrankaVectorEnv(2).reset(options={"reset_mask": [1]}), r"reset_mask has the shape \(1,\)"),
    ],
)
def test_mistakes_are_named(call: Callable[[], object], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        call()
    with pytest.raises(IndexError, match="index is 1, expected one of 0 to 0"):
        VirtualRobots().errors(1)
