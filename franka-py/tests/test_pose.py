"""Poses from positions and quaternions, and back."""

from __future__ import annotations

import numpy as np
import pytest

from franka_async import READY, Model, pose


def test_there_and_back() -> None:
    there = Model.fr3().pose("flange", READY)
    position, quaternion = pose.to_xyzw(there)
    assert np.linalg.norm(quaternion) == pytest.approx(1.0) and quaternion[3] >= 0.0
    np.testing.assert_allclose(pose.from_xyzw(position, quaternion), there, atol=1e-12)
    # Any length will do, and either sign.
    np.testing.assert_allclose(pose.from_xyzw(position, -2.0 * quaternion), there, atol=1e-12)


def test_a_turn_keeps_the_position() -> None:
    there = pose.from_xyzw([0.4, 0.1, 0.3], [1.0, 0.0, 0.0, 0.0])
    turned = pose.rotated(there, [0.0, 0.0, np.pi / 2])
    np.testing.assert_allclose(turned[:3, 3], there[:3, 3])
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(turned[:3, :3], quarter @ there[:3, :3], atol=1e-12)
    turned = pose.rotated(there, [0.0, 0.0, np.pi / 2], frame="tool")
    np.testing.assert_allclose(turned[:3, :3], there[:3, :3] @ quarter, atol=1e-12)


def test_what_is_no_pose_is_refused() -> None:
    with pytest.raises(ValueError, match="expected a length above 0"):
        pose.from_xyzw([0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0])
    with pytest.raises(ValueError, match="pose"):
        pose.to_xyzw(np.zeros((4, 4)))
    with pytest.raises(ValueError, match="frame is \"hand\", expected 'base' or 'tool'"):
        pose.rotated(np.eye(4), [0.0, 0.0, 0.1], frame="hand")  # type: ignore[arg-type]
