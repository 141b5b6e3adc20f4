"""The trajectory generator: least durations against vectors, limits kept, ends met."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from vectors import load

from franka_async import Model, otg


def test_durations_are_those_of_another_generator() -> None:
    for case in load("otg/multi_axis")["cases"]:
        trajectory = otg.plan(
            case["p0"],
            case["target"],
            otg.AxisLimits(case["vmax"], case["amax"], case["jmax"]),
            start_velocity=case["v0"],
            start_acceleration=case["a0"],
            synchronisation="time",
        )
        assert trajectory.axes == case["axes"]
        assert trajectory.duration == pytest.approx(case["duration"], abs=1e-7)
        assert trajectory.arrival == trajectory.duration
        np.testing.assert_array_equal(trajectory.end, case["target"])


@pytest.mark.parametrize("axes", [1, 2, 3, 4, 5, 6, 7, 8, 15, 16, 17, 64])
@pytest.mark.parametrize("synchronisation", ["straight", "time"])
def test_any_number_of_axes_keeps_its_limits(axes: int, synchronisation: otg.Synchronisation) -> None:
    random = np.random.default_rng(axes)
    start, target = random.uniform(-2, 2, (2, axes))
    bounds = random.uniform([[1.0], [5.0], [500.0]], [[3.0], [20.0], [9000.0]], (3, axes))
    trajectory = otg.plan(start, target, otg.AxisLimits(*bounds), synchronisation=synchronisation)
    times, position, velocity, acceleration = trajectory.sample(1e-3)
    assert position.shape == velocity.shape == acceleration.shape == (len(times), axes)
    np.testing.assert_array_equal(position[0], start)
    np.testing.assert_array_equal(position[-1], target)
    assert times[-2] < trajectory.duration <= times[-1] + 1e-9
    assert (np.abs(velocity) <= bounds[0] * (1 + 1e-9)).all()
    assert (np.abs(acceleration) <= bounds[1] * (1 + 1e-9)).all()
    assert (np.abs(np.diff(acceleration, axis=0)) <= bounds[2] * 1e-3 * (1 + 1e-6)).all()
    np.testing.assert_allclose(np.diff(position, axis=0)[:, 0] / 1e-3, (velocity[1:, 0] + velocity[:-1, 0]) / 2, atol=1e-2)
    if synchronisation == "straight":
        share = (position - start) / (target - start)
        np.testing.assert_allclose(share, share[:, :1] @ np.ones((1, axes)), rtol=0.0, atol=1e-12)


def test_axes_that_are_added_inside_change_nothing() -> None:
    limits = otg.AxisLimits(2.0, 10.0, 5000.0)
    start, target = np.array([0.1, -0.4, 0.2, 0.3, 1.0]), np.array([0.4, 0.3, -0.2, 1.0, 0.9])
    for synchronisation in ("straight", "time"):
        five = otg.plan(start, target, limits, synchronisation=synchronisation)
        six = otg.plan([*start, 7.0], [*target, 7.0], limits, synchronisation=synchronisation)
        times = np.linspace(0.0, five.duration, 100)
        assert five.duration == six.duration
        for of_five, of_six in zip(five.at(times), six.at(times), strict=True):
            np.testing.assert_array_equal(of_five, of_six[:, :5])


def test_one_time_is_a_row_of_many() -> None:
    trajectory = otg.plan([0.0, 0.0], [1.0, -2.0], otg.AxisLimits([1.0, 2.0], 10.0, [1000.0, 500.0]))
    times = np.array([-1.0, 0.0, 0.3, trajectory.duration, 99.0])
    many = trajectory.at(times)
    for i, t in enumerate(times):
        for part, row in zip(trajectory.at(t), many, strict=True):
            assert part.shape == (2,)
            np.testing.assert_array_equal(part, row[i])
    np.testing.assert_array_equal(many[0][0], [0.0, 0.0])
    np.testing.assert_array_equal(many[0][-1], [1.0, -2.0])
    assert trajectory.at([])[0].shape == (0, 2)


def test_a_target_in_motion_is_met_at_its_velocity() -> None:
    limits = otg.AxisLimits(2.0, 10.0, 1000.0)
    trajectory = otg.plan([0.0], [1.0], limits, target_velocity=[0.5])
    position, velocity, acceleration = trajectory.at(trajectory.arrival)
    np.testing.assert_allclose([position[0], velocity[0], acceleration[0]], [1.0, 0.5, 0.0], atol=1e-9)
    assert trajectory.duration > trajectory.arrival and trajectory.end[0] > 1.0


def test_without_a_target_it_stops() -> None:
    limits = otg.AxisLimits(2.0, 10.0, 1000.0)
    stop = otg.plan([0.0, 1.0], None, limits, start_velocity=[1.0, -0.5])
    # Braking from 1 m/s takes 0.1 s. Two ramps add 10 ms.
    assert stop.duration == pytest.approx(0.11)
    assert stop.end[0] == pytest.approx(0.5 * 0.11) and stop.end[1] < 1.0


def test_presets_are_the_robots_limits() -> None:
    for preset, model in [(otg.AxisLimits.fr3(), Model.fr3()), (otg.AxisLimits.fer(), Model.fer())]:
        for name in ("velocity", "acceleration", "jerk"):
            np.testing.assert_array_equal(getattr(preset, name), getattr(model.joint_limits, name))
    half = otg.AxisLimits.fr3().scaled(velocity=0.5)
    np.testing.assert_array_equal(half.velocity, otg.AxisLimits.fr3().velocity * 0.5)
    np.testing.assert_array_equal(half.jerk, otg.AxisLimits.fr3().jerk)
    assert half != otg.AxisLimits.fr3() and half == otg.AxisLimits.fr3().scaled(0.5)


LIMITS = otg.AxisLimits(1.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: otg.AxisLimits(0.0, 1.0, 1.0), "velocity holds 0, expected positive finite numbers"),
        (lambda: otg.AxisLimits(1.0, [1.0, np.inf], 1.0), "acceleration holds inf"),
        (lambda: otg.AxisLimits([1.0, 1.0], [1.0, 1.0, 1.0], 1.0), "acceleration has 3 axes, expected 2"),
        (lambda: otg.AxisLimits([[1.0]], 1.0, 1.0), r"velocity has the shape \[1, 1\]"),
        (lambda: LIMITS.scaled(jerk=-1.0), "jerk is -1, expected a positive finite factor"),
        (lambda: otg.plan(0.0, 1.0, LIMITS), r"start has the shape \[\], expected \(n,\) with n from 1 to 64"),
        (lambda: otg.plan(np.zeros(65), np.zeros(65), LIMITS), r"start has the shape \[65\]"),
        (lambda: otg.plan([0.0], [1.0, 2.0], LIMITS), r"target has the shape \[2\], expected \(1,\) as start has"),
        (lambda: otg.plan([0.0], [np.nan], LIMITS), "target holds NaN"),
        (lambda: otg.plan([0.0], [1.0], otg.AxisLimits.fr3()), "limits have 7 axes, expected 1 as start has"),
        (lambda: otg.plan([0.0], [1.0], LIMITS, synchronisation="none"), "synchronisation is \"none\""),  # type: ignore[arg-type]
        (lambda: otg.plan([0.0], [1.0], LIMITS, target_velocity=[2.0]), "moves faster than the limits allow"),
        (lambda: otg.plan([0.0], None, LIMITS, target_velocity=[0.5]), "target is None, expected a target"),
        (lambda: otg.plan([0.0], [1.0], LIMITS).sample(0.0), "dt is 0, expected a positive finite number"),
        (lambda: otg.plan([0.0], [1.0], LIMITS).sample(1e-12), "dt is 0.000000000001, which makes"),
        (lambda: otg.plan([0.0], [1.0], LIMITS).at([[0.0]]), r"t has the shape \[1, 1\], expected a number or \(m,\)"),
        (lambda: otg.plan([0.0], [1.0], LIMITS).at(np.nan), "t holds NaN"),
    ],
)
def test_mistakes_are_named(call: Callable[[], object], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        call()
