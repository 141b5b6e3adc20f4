"""States as arrays, text and dictionaries."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from franka_async import FLAT_LAYOUT, RobotState, VirtualRobots


@pytest.fixture(scope="module", params=["fr3", "fer"])
def state(request: pytest.FixtureRequest) -> RobotState:
    """A state of a robot in motion."""
    robots = VirtualRobots(request.param, control="joint_velocity")
    robots.step([[0.3, -0.2, 0.1, 0.2, 0.4, -0.1, 0.5]], 300)
    return robots.state(0)


def test_flat_has_the_parts_that_its_layout_names(state: RobotState) -> None:
    flat = state.flat()
    assert flat.shape == (69,) and flat.dtype == np.float64
    assert isinstance(FLAT_LAYOUT, list) and RobotState.FLAT_LAYOUT == FLAT_LAYOUT and RobotState.FLAT_LEN == 69
    assert [begin for _, begin, _ in FLAT_LAYOUT[1:]] == [end for _, _, end in FLAT_LAYOUT[:-1]]
    assert FLAT_LAYOUT[0][1] == 0 and FLAT_LAYOUT[-1] == ("time", 68, 69)
    for name, begin, end in FLAT_LAYOUT:
        if name.endswith("_position"):
            expected = getattr(state, name.removesuffix("_position"))[:3, 3]
        elif name.endswith("_quaternion"):
            rotation = getattr(state, name.removesuffix("_quaternion"))[:3, :3]
            expected = quaternion_of(rotation)
            assert flat[end - 1] >= 0.0
        else:
            expected = np.atleast_1d(getattr(state, name))
        np.testing.assert_allclose(flat[begin:end], expected, rtol=0.0, atol=1e-7, err_msg=name)


def quaternion_of(rotation: np.ndarray) -> np.ndarray:
    """x y z w with w >= 0: the eigenvector that is the quaternion of a rotation."""
    r = rotation
    if not r.any():
        # O_T_EE_c of a robot that no Cartesian command moves.
        return np.zeros(4)
    k = np.array([
        [r[0, 0] - r[1, 1] - r[2, 2], 0, 0, 0],
        [r[0, 1] + r[1, 0], r[1, 1] - r[0, 0] - r[2, 2], 0, 0],
        [r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], r[2, 2] - r[0, 0] - r[1, 1], 0],
        [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], np.trace(r)],
    ])
    _, vectors = np.linalg.eigh(k)
    quaternion = vectors[:, -1]
    return quaternion * (np.sign(quaternion[3]) or 1.0)


def test_a_dictionary_has_every_attribute(state: RobotState) -> None:
    all_of_it = state.to_dict()
    names = {name for name in dir(state) if not name.startswith("_")}
    assert names - set(all_of_it) == {"FLAT_LAYOUT", "FLAT_LEN", "flat", "to_dict"}
    assert {"q", "O_T_EE", "robot_mode", "time", "accelerometer_top", "I_total"} <= set(all_of_it)
    for name, value in all_of_it.items():
        np.testing.assert_array_equal(getattr(state, name), value)


def test_states_pickle_compare_and_do_not_hash(state: RobotState) -> None:
    again = pickle.loads(pickle.dumps(state))
    assert again == state and not again != state
    np.testing.assert_array_equal(again.flat(), state.flat())
    assert state != "a state"
    with pytest.raises(TypeError, match="unhashable"):
        hash(state)


def test_arrays_are_the_programs_own(state: RobotState) -> None:
    state.q[0] = 99.0
    assert state.q[0] != 99.0
    with pytest.raises(AttributeError):
        state.q = np.zeros(7)  # type: ignore[misc]


def test_text_fits_a_page(state: RobotState) -> None:
    lines = str(state).splitlines()
    assert lines[0].startswith("RobotState at ") and "move" in lines[0]
    assert max(map(len, lines)) <= 100 and 8 <= len(lines) <= 12
    assert f"{state.q[3]:.4f}" in lines[1] and lines[1].split()[0] == "q"
    assert "-0.0000" not in str(state)
    assert "\n" not in repr(state)
    html = state._repr_html_()
    assert html.count("<tr>") == html.count("</tr>") == len(lines) - 1
