"""Kinematics, dynamics and limits against vectors, finite differences, and one against many."""

from __future__ import annotations

import pickle
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from vectors import load

import franka_async
from franka_async import Model

Array = NDArray[np.float64]

MODELS = {"fr3": Model.fr3(), "fer": Model.fer()}
FRAMES: list[Any] = [f"joint{i}" for i in range(1, 8)] + ["flange"]
READY = np.array([0.0, -0.25, 0.0, -0.75, 0.0, 0.5, 0.25]) * np.pi
TOOL = np.array([0.05, -0.02, 0.12, 0.1, -0.3, 0.2, 0.9])


def postures(count: int, seed: int, model: Model | None = None) -> Array:
    """Random positions inside the limits, ``(count, 7)``."""
    limits = (model or Model.fr3()).joint_limits
    return np.random.default_rng(seed).uniform(limits.lower, limits.upper, (count, 7))


def columns(numbers: list[float], rows: int) -> Array:
    """The column-major matrices in a list, ``(n, rows, ...)``."""
    width = {4: 4, 6: 7, 7: 7, 3: 3}[rows]
    return np.array(numbers).reshape(-1, width, rows).transpose(0, 2, 1)


@pytest.mark.parametrize("kind", ["fr3", "fer"])
def test_poses_and_jacobians_are_the_vendors(kind: str) -> None:
    model, vectors = MODELS[kind], load(f"model/model_vectors_{kind}")
    for sample in vectors["samples"]:
        for i, frame in enumerate(FRAMES):
            expected = {part: columns(sample[part], rows)[i] for part, rows in PARTS.items()}
            assert_parts(model, frame, sample["q"], expected)
        for load_of, config in zip(sample["loads"], vectors["load_configs"], strict=True):
            frames = [columns(config[name], 4)[0] for name in ("F_T_EE", "EE_T_K")]
            for i, frame in enumerate(["ee", "stiffness"]):
                expected = {part: columns(load_of[part], rows)[i] for part, rows in PARTS.items()}
                assert_parts(model, frame, sample["q"], expected, *frames)


PARTS = {"pose": 4, "zero_jacobian": 6, "body_jacobian": 6}


def assert_parts(model: Model, frame: str, q: list[float], expected: dict[str, Array], *frames: Array) -> None:
    for part, value in expected.items():
        got = getattr(model, part)(frame, q, *frames)
        np.testing.assert_allclose(got, value, rtol=0.0, atol=1e-12, err_msg=f"{part} of {frame}")


@pytest.mark.parametrize("kind", ["fr3", "fer"])
def test_dynamics_are_the_vendors(kind: str) -> None:
    model, vectors = MODELS[kind], load(f"model/model_vectors_{kind}")
    tilted = vectors["meta"]["gravity_alt"]
    for sample in vectors["samples"]:
        q, dq = sample["q"], sample["dq"]
        for expected, config in zip(sample["loads"], vectors["load_configs"], strict=True):
            mass, com = config["m_total"], config["F_x_Ctotal"]
            inertia = columns(config["I_total"], 3)[0]
            assert_close(model.mass(q, inertia, mass, com), columns(expected["mass"], 7)[0], 1e-11)
            assert_close(model.coriolis(q, dq, inertia, mass, com), expected["coriolis"], 1e-11)
            assert_close(model.gravity(q, mass, com), expected["gravity"], 1e-11)
            assert_close(model.gravity(q, mass, com, tilted), expected["gravity_alt"], 1e-11)
            frame = columns(config["F_T_EE"], 4)[0]
            whole = model.dynamics(q, dq, F_T_EE=frame, I_total=inertia, m_total=mass, F_x_Ctotal=com)
            assert_close(whole.pose, columns(expected["pose"], 4)[0], 1e-12)
            assert_close(whole.jacobian, columns(expected["zero_jacobian"], 6)[0], 1e-12)
            assert_close(whole.mass, columns(expected["mass"], 7)[0], 1e-11)
            assert_close(whole.coriolis, expected["coriolis"], 1e-11)
            assert_close(whole.gravity, expected["gravity"], 1e-11)


def assert_close(got: Array, expected: Array | list[float], tolerance: float) -> None:
    np.testing.assert_allclose(got, expected, rtol=0.0, atol=tolerance)


def test_jacobians_are_the_derivatives_of_poses() -> None:
    model, step = Model.fr3(), 1e-6
    for q in postures(20, 1):
        jacobian = model.zero_jacobian("ee", q, TOOL)
        for joint in range(7):
            ahead, behind = (model.pose("ee", q + sign * step * np.eye(7)[joint], TOOL) for sign in (1, -1))
            change = (ahead - behind) / (2 * step)
            spin = change[:3, :3] @ model.pose("ee", q, TOOL)[:3, :3].T
            twist = [*change[:3, 3], spin[2, 1], spin[0, 2], spin[1, 0]]
            np.testing.assert_allclose(jacobian[:, joint], twist, rtol=0.0, atol=1e-8)


def test_the_last_part_of_the_dynamics_is_the_jacobians_derivative() -> None:
    model, step = Model.fr3(), 1e-6
    for q, dq in zip(postures(20, 2), np.random.default_rng(3).normal(size=(20, 7)), strict=True):
        ahead, behind = (model.zero_jacobian("ee", q + sign * step * dq) for sign in (1, -1))
        expected = (ahead - behind) @ dq / (2 * step)
        np.testing.assert_allclose(model.dynamics(q, dq).jdot_dq, expected, rtol=0.0, atol=1e-7)


def test_forward_dynamics_undo_inverse_dynamics() -> None:
    random = np.random.default_rng(4)
    q, (dq, ddq) = postures(50, 4), random.normal(size=(2, 50, 7))
    carried: dict[str, Any] = dict(m_total=1.5, F_x_Ctotal=[0.0, 0.01, 0.05], I_total=np.eye(3) * 2e-3)
    model = Model.fr3()
    tau = model.inverse_dynamics(q, dq, ddq, **carried)
    np.testing.assert_allclose(model.forward_dynamics(q, dq, tau, **carried), ddq, rtol=0.0, atol=1e-9)
    whole = np.einsum("nij,nj->ni", model.mass(q, **carried), ddq) + model.coriolis(q, dq, **carried)
    whole += model.gravity(q, 1.5, [0.0, 0.01, 0.05])
    np.testing.assert_allclose(tau, whole, rtol=0.0, atol=1e-9)


def test_velocity_limits_are_the_vendors() -> None:
    vectors = load("model/velocity_limit_vectors_fr3")["vectors"]
    limits = Model.fr3().joint_limits
    lower, upper = limits.velocity_envelope([vector["q"] for vector in vectors], margin=1e-3)
    np.testing.assert_array_equal(upper, [vector["upper"] for vector in vectors])
    np.testing.assert_array_equal(lower, [vector["lower"] for vector in vectors])


DYNAMICS = ["pose", "jacobian", "mass", "coriolis", "gravity", "jdot_dq"]
CLEARANCE = ["distance", "bodies", "gradient", "points"]

FUNCTIONS: dict[str, Callable[[Model, Array, Array], Any]] = {
    "pose": lambda m, q, dq: m.pose("stiffness", q, TOOL, TOOL),
    "zero_jacobian": lambda m, q, dq: m.zero_jacobian("ee", q, TOOL),
    "body_jacobian": lambda m, q, dq: m.body_jacobian("joint5", q),
    "link_poses": lambda m, q, dq: m.link_poses(q),
    "manipulability": lambda m, q, dq: m.manipulability(q),
    "mass": lambda m, q, dq: m.mass(q, np.eye(3) * 1e-3, 1.0, [0, 0, 0.1]),
    "coriolis": lambda m, q, dq: m.coriolis(q, dq),
    "gravity": lambda m, q, dq: m.gravity(q),
    "dynamics": lambda m, q, dq: [getattr(m.dynamics(q, dq), part) for part in DYNAMICS],
    "inverse_dynamics": lambda m, q, dq: m.inverse_dynamics(q, dq, dq),
    "forward_dynamics": lambda m, q, dq: m.forward_dynamics(q, dq, dq),
    "differential_ik": lambda m, q, dq: m.differential_ik(q, dq[..., :6]),
    "velocity_envelope": lambda m, q, dq: m.joint_limits.velocity_envelope(q),
    "contains": lambda m, q, dq: m.joint_limits.contains(q),
    "distance": lambda m, q, dq: m.joint_limits.distance(q),
    "clearance": lambda m, q, dq: [getattr(m.clearance(q), part) for part in CLEARANCE],
    "ik_near": lambda m, q, dq: m.ik_near(m.pose("flange", q), q),
    "ik_from": lambda m, q, dq: m.ik_from(m.pose("flange", q), q),
}


@pytest.mark.parametrize("kind", ["fr3", "fer"])
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_batch_equals_its_rows(name: str, kind: str) -> None:
    model, function = MODELS[kind], FUNCTIONS[name]
    q, dq = postures(9, 5, model), np.random.default_rng(6).normal(size=(9, 7)) * 0.3
    batch = parts(function(model, q, dq))
    singles = [parts(function(model, *row)) for row in zip(q, dq, strict=True)]
    for i, whole in enumerate(batch):
        assert whole.shape[0] == 9
        np.testing.assert_array_equal(whole, np.stack([single[i] for single in singles]))
    empty = parts(function(model, q[:0], dq[:0]))
    assert [part.shape for part in empty] == [(0, *part.shape[1:]) for part in batch]


def parts(result: Any) -> list[Array]:
    return [np.asarray(part) for part in result] if isinstance(result, (list, tuple)) else [np.asarray(result)]


def test_one_row_goes_with_a_batch() -> None:
    model, q, dq = Model.fr3(), postures(4, 7), np.full(7, 0.5)
    np.testing.assert_array_equal(model.coriolis(q, dq), model.coriolis(q, np.tile(dq, (4, 1))))
    np.testing.assert_array_equal(model.coriolis(q[0], q), model.coriolis(np.tile(q[0], (4, 1)), q))


def test_any_numbers_will_do() -> None:
    model = Model.fr3()
    expected = model.pose("ee", [0.0, 0.0, 0.0, -2.0, 0.0, 2.0, 1.0])
    same: list[Any] = [(0, 0, 0, -2, 0, 2, 1), np.array([0, 0, 0, -2, 0, 2, 1], np.int8), np.array([0, 0, 0, -2, 0, 2, 1], "f4")]
    for q in same:
        np.testing.assert_array_equal(model.pose("ee", q), expected)
    q = postures(6, 8)
    np.testing.assert_array_equal(model.pose("ee", np.asfortranarray(q)), model.pose("ee", q))
    np.testing.assert_array_equal(model.pose("ee", q[::2]), model.pose("ee", q)[::2])


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda m: m.pose("ee", [0.0] * 6), r"q has the shape \[6\], expected \(7,\) or \(n, 7\)"),
        (lambda m: m.pose("ee", np.zeros((2, 6))), r"q has the shape \[2, 6\], expected"),
        (lambda m: m.pose("ee", np.zeros((7, 7, 7))), r"q has the shape \[7, 7, 7\], expected"),
        (lambda m: m.pose("ee", 1.0), r"q has the shape \[\], expected"),
        (lambda m: m.pose("hand", READY), "frame is \"hand\", expected one of joint1, .*, stiffness"),
        (lambda m: m.pose("ee", READY * np.nan), "q holds NaN, expected finite"),
        (lambda m: m.pose("ee", READY, np.eye(3)), r"F_T_EE has the shape \[3, 3\]"),
        (lambda m: m.pose("ee", READY, None, np.zeros((4, 4))), "EE_T_K is not a rigid"),
        (lambda m: m.coriolis(np.zeros((3, 7)), np.zeros((2, 7))), "dq has 2 rows, expected 3 as in q"),
        (lambda m: m.mass(READY, np.eye(2), 1.0), r"I_total has the shape \[2, 2\], expected \(3, 3\)"),
        (lambda m: m.mass(READY, None, -1.0), "m_total is -1, expected a mass of 0 kg or more"),
        (lambda m: m.gravity(READY, 1.0, [0.0]), r"F_x_Ctotal has the shape \[1\], expected \(3,\)"),
        (lambda m: m.gravity(READY, gravity_earth=[0.0]), r"gravity_earth has the shape \[1\]"),
        (lambda m: m.clearance(READY, shape="round"), "shape is \"round\", expected 'vendor' or 'covering'"),
        (lambda m: m.ik(np.eye(4)), "exactly one of joint7, joint4 and swivel"),
        (lambda m: m.ik(np.eye(4), joint7=0.0, swivel=0.0), "exactly one of"),
        (lambda m: m.ik(np.eye(4), joint7=float("inf")), "the angle is inf"),
        (lambda m: m.ik_near(np.eye(5), READY), r"pose has the shape \[5, 5\]"),
        (lambda m: m.ik_near([np.eye(4), np.zeros((4, 4))], READY), r"pose\[1\] is not a rigid"),
        (lambda m: m.differential_ik(READY, [0.0] * 5), r"twist has the shape \[5\]"),
        (lambda m: m.differential_ik(READY, [0.0] * 6, lower=[1.0] * 7, upper=[0.0] * 7), "lower is 1 for joint 1"),
        (lambda m: Model.from_urdf("<robot name='fr3'/>"), "text does not describe a supported arm: "),
    ],
)
def test_mistakes_are_named(call: Callable[[Model], object], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        call(Model.fr3())


def test_what_holds_no_numbers_is_a_type_error() -> None:
    with pytest.raises(TypeError, match="q has "):
        Model.fr3().pose("ee", "ready")
    with pytest.raises(TypeError, match="q has "):
        Model.fr3().pose("ee", [[0.0] * 7, [0.0] * 6])


def test_an_interrupt_while_numbers_are_read_is_passed_on() -> None:
    class Interrupted:
        def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray[Any, Any]:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Model.fr3().pose("ee", Interrupted())


def test_a_batch_leaves_the_interpreter_to_others() -> None:
    ticks, over = [0], threading.Event()

    def tick() -> None:
        while not over.is_set():
            ticks[0] += 1
            time.sleep(0)

    thread = threading.Thread(target=tick)
    thread.start()
    try:
        # A batch that holds the interpreter sees none however long it takes; a loaded machine may need a longer one.
        for count in (300, 3000, 30000):
            q = np.tile(READY, (count, 1))
            poses = Model.fr3().pose("flange", q)
            before = ticks[0]
            Model.fr3().ik_near(poses, q)
            if ticks[0] - before > 10:
                return
        pytest.fail(f"another thread ran {ticks[0] - before} times")
    finally:
        over.set()
        thread.join()


def test_models_compare_pickle_and_print() -> None:
    for model in MODELS.values():
        assert pickle.loads(pickle.dumps(model)) == model
    assert MODELS["fr3"] != MODELS["fer"]
    assert repr(MODELS["fr3"]) == "Model.fr3()"
    assert [MODELS[kind].kind for kind in MODELS] == ["fr3", "fer"]
    limits = MODELS["fr3"].joint_limits
    assert limits == Model.fr3().joint_limits and limits != Model.fer().joint_limits
    assert repr(limits).count("\n") == 7
    assert MODELS["fr3"].cartesian_limits.translation.velocity == 3.0
    assert MODELS["fer"].cartesian_limits.translation.velocity == 2.0


def test_a_links_pose_is_that_of_its_joint() -> None:
    model = Model.fr3()
    links = model.link_poses(READY)
    np.testing.assert_array_equal(links, [model.pose(frame, READY) for frame in FRAMES])


def test_the_least_clearance_is_the_nearest_pair() -> None:
    model = Model.fr3()
    ready = model.clearance(READY)
    assert ready.distance > 0.05 and "between" in repr(ready)
    q = postures(200, 9)
    found = model.clearance(q)
    assert found.bodies.dtype == np.int64 and (found.bodies[:, 0] < found.bodies[:, 1]).all()
    assert (model.clearance(q, hand=False).distance >= found.distance).all()
    assert "200 postures" in repr(found)
    # Away from kinks the gradient is the derivative.
    step, close = 1e-6, 0
    for posture, gradient in zip(q, found.gradient, strict=True):
        around = np.concatenate([posture + step * np.eye(7), posture - step * np.eye(7)])
        distances = model.clearance(around).distance
        close += np.abs((distances[:7] - distances[7:]) / (2 * step) - gradient).max() < 1e-4
    assert close > 190


def test_this_package_says_what_it_exports() -> None:
    for name in franka_async.__all__:
        assert hasattr(franka_async, name), name
