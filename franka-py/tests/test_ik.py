"""Inverse kinematics: every posture, the nearest one, and velocities within bounds."""

from __future__ import annotations

import numpy as np
import pytest
from test_model import MODELS, READY, TOOL, columns, postures
from vectors import load

from franka_async import Model


@pytest.mark.parametrize("kind", ["fr3", "fer"])
def test_every_posture_for_an_angle_of_joint_7_is_found(kind: str) -> None:
    model, vectors = MODELS[kind], load("model/ik_vectors")
    lower, upper = model.joint_limits.lower, model.joint_limits.upper
    compared = 0
    for vector in vectors["vectors"]:
        found = model.ik(columns(vector["O_T_F"], 4)[0], joint7=vector["q7"])
        expected = turned([solution["q"] for solution in vector["solutions"]], lower, upper)
        assert same_rows(found, expected), vector["id"]
        compared += len(expected)
        if q4 := vector.get("q4_free"):
            found = model.ik(columns(vector["O_T_F"], 4)[0], joint4=q4["q4"])
            expected = turned(q4["solutions"], lower, upper)
            assert same_rows(found, expected), vector["id"]
            compared += len(expected)
    assert compared > 300


def turned(all_of_them: list[list[float]], lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Returns the solutions within limits, with angles shifted by a turn where that brings them within."""
    q = np.array(all_of_them).reshape(-1, 7)
    q = np.where(q < lower, q + 2 * np.pi, np.where(q > upper, q - 2 * np.pi, q))
    return q[((q >= lower) & (q <= upper)).all(axis=1)]


def same_rows(one: np.ndarray, two: np.ndarray) -> bool:
    if one.shape != two.shape:
        return False
    distance = np.abs(one[:, None] - two[None]).max(axis=2)
    return len(one) == 0 or bool((distance.min(axis=0) < 1e-7).all() and (distance.min(axis=1) < 1e-7).all())


def test_postures_for_a_swivel_meet_the_pose() -> None:
    model = Model.fr3()
    pose = model.pose("ee", READY, TOOL)
    found = model.ik(pose, swivel=0.3, F_T_EE=TOOL)
    assert len(found) > 0
    np.testing.assert_allclose(model.pose("ee", found, TOOL), np.broadcast_to(pose, (len(found), 4, 4)), atol=1e-9)


def test_many_poses_give_a_list() -> None:
    model = Model.fr3()
    poses = model.pose("flange", postures(5, 1))
    found = model.ik_many(poses, joint7=0.5)
    assert len(found) == 5
    for pose, each in zip(poses, found, strict=True):
        np.testing.assert_array_equal(each, model.ik(pose, joint7=0.5))


@pytest.mark.parametrize("function", ["ik_near", "ik_from"])
def test_a_posture_is_found_for_every_pose_of_the_arm(function: str) -> None:
    model, q = Model.fr3(), postures(50, 2)
    poses = model.pose("ee", q, TOOL)
    found = getattr(model, function)(poses, READY, TOOL)
    np.testing.assert_allclose(model.pose("ee", found, TOOL), poses, rtol=0.0, atol=1e-7)
    assert model.joint_limits.contains(found).all()


def test_the_nearest_posture_is_at_least_as_near_as_any() -> None:
    model, q = Model.fr3(), postures(30, 3)
    poses = model.pose("flange", q)
    near = model.ik_near(poses, READY)
    for pose, found in zip(poses, near, strict=True):
        for angle in np.linspace(-2.8, 2.8, 41):
            others = model.ik(pose, joint7=angle)
            distances = np.square(others - READY).sum(axis=1)
            assert (distances > np.square(found - READY).sum() - 1e-9).all()
    np.testing.assert_allclose(model.ik_near(poses[0], q[0]), q[0], atol=1e-6)


@pytest.mark.parametrize("function", ["ik_near", "ik_from"])
def test_out_of_reach_is_an_error_alone_and_nan_among_others(function: str) -> None:
    model = Model.fr3()
    reached, far = model.pose("flange", READY), model.pose("flange", READY)
    far[0, 3] = 2.0
    with pytest.raises(ValueError, match=r"pose: the pose is out of reach: the nearest pose found is \d+\.\d mm"):
        getattr(model, function)(far, READY)
    found = getattr(model, function)([reached, far], READY)
    assert np.isfinite(found[0]).all() and np.isnan(found[1]).all()


def test_a_twist_is_met_where_it_can_be() -> None:
    model, q = Model.fr3(), np.tile(READY, (20, 1)) + np.random.default_rng(4).uniform(-0.3, 0.3, (20, 7))
    twist = np.random.default_rng(5).uniform(-0.1, 0.1, (20, 6))
    velocity, missing = model.differential_ik(q, twist)
    got = np.einsum("nij,nj->ni", model.zero_jacobian("ee", q), velocity)
    np.testing.assert_allclose(got + missing, twist, rtol=0.0, atol=1e-12)
    assert np.abs(missing).max() < 1e-4


def test_velocities_stay_exactly_within_bounds() -> None:
    model, bound = Model.fr3(), np.full(7, 0.2)
    velocity, missing = model.differential_ik(READY, [1.0, 0, 0, 0, 0, 0], lower=-bound, upper=bound)
    assert np.abs(velocity).max() <= 0.2 and np.abs(missing).max() > 0.1
    still, missing = model.differential_ik(READY, [0.1, 0, 0, 0, 0, 0], lower=np.zeros(7), upper=np.zeros(7))
    np.testing.assert_array_equal(still, np.zeros(7))
    np.testing.assert_allclose(missing, [0.1, 0, 0, 0, 0, 0], atol=1e-15)


def test_steps_lead_to_the_pose() -> None:
    model, q = Model.fr3(), READY
    target = model.pose("ee", READY + 0.2)
    for _ in range(8):
        pose = model.pose("ee", q)
        turn = target[:3, :3] @ pose[:3, :3].T
        error = [*(target - pose)[:3, 3], *(turn - turn.T)[[2, 0, 1], [1, 2, 0]] / 2]
        step, _ = model.differential_ik(q, error, lower=[-1.0] * 7, upper=[1.0] * 7)
        q = q + step
    np.testing.assert_allclose(model.pose("ee", q), target, rtol=0.0, atol=1e-6)
