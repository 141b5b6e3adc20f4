"""Columns of every cycle."""

import asyncio
from pathlib import Path

import numpy as np
import pytest

from conftest import PATIENT
import franka_async
from franka_async import Robot, record_columns


def test_a_motion_is_recorded_cycle_by_cycle(franka_robot: Robot, tmp_path: Path) -> None:
    columns = ["q", "O_T_EE", "q_ref", "tau_c", "goal", "activity", "robot_mode", "current_errors"]

    async def main() -> franka_async.Recording:
        async with franka_robot.record(columns) as recording:
            await franka_robot.move_by([0.0, 0.0, 0.05])
        return recording

    recording = asyncio.run(main())
    rows = len(recording)
    assert rows > 500
    assert recording.keys() == ["time", *columns]
    assert list(recording) == recording.keys() and "q" in recording and 1 not in recording
    shapes = {name: array.shape for name, array in recording.arrays().items()}
    assert shapes["q"] == (rows, 7) and shapes["O_T_EE"] == (rows, 4, 4)
    assert shapes["time"] == shapes["activity"] == (rows,) and shapes["current_errors"] == (rows, 41)
    milliseconds = np.rint(recording["time"] * 1000).astype(int)
    assert (np.diff(milliseconds) >= 1).all()
    # Rows and losses are all cycles between begin and end.
    inside = milliseconds[-1] - milliseconds[0] + 1 - rows
    assert inside <= recording.lost <= inside + 60
    # State and record of the same row belong to the same cycle: the arm follows its reference.
    runs = recording["activity"] == "running"
    assert runs.sum() > 500 and (recording["robot_mode"][runs] == "move").mean() > 0.9
    assert np.abs(recording["q"][runs] - recording["q_ref"][runs]).max() < 0.1
    assert recording["goal"].dtype == np.int64 and recording["goal"].max() > 0
    assert recording["current_errors"].dtype == bool and not recording["current_errors"].any()
    rise = recording["O_T_EE"][-1, 2, 3] - recording["O_T_EE"][0, 2, 3]
    assert rise == pytest.approx(0.05, abs=5e-3)
    np.testing.assert_array_equal(recording["O_T_EE"][:, 3], np.tile([0.0, 0.0, 0.0, 1.0], (rows, 1)))

    recording.save(tmp_path / "motion.npz")
    with np.load(tmp_path / "motion.npz") as saved:
        for name, array in recording.arrays().items():
            np.testing.assert_array_equal(saved[name], array)


def test_nothing_is_lost_while_the_interpreter_is_busy(fr3: Robot) -> None:
    with fr3.record(["q", "tau_c"]) as recording:
        before = fr3.stats()
        begin = fr3.state().time_ms
        # The interpreter is not released in this loop, which lasts for three seconds of the robot.
        while fr3.state().time_ms < begin + 3000:
            pass
        after = fr3.stats()
        end = fr3.state().time_ms
    # Only states that did not reach this computer's thread are lost.
    gone = sum(after[name] - before[name] for name in ("lost", "skipped"))
    assert len(recording) >= end - begin - gone - 5
    assert recording.lost <= gone + 50
    assert len(recording) + recording.lost >= 3000


def test_it_can_be_read_while_it_goes_on(fr3: Robot) -> None:
    with fr3.record(["dq"]) as recording:
        while len(recording) < 50:
            pass
        assert recording["dq"].shape[0] >= 50
    rows = len(recording)
    assert len(recording) == rows
    assert repr(recording) == "<Recording of time, dq, over>"


def test_only_the_first_seconds_are_kept_and_the_rest_is_counted(fr3: Robot) -> None:
    with fr3.record(["tau_c"], longest=0.1) as recording:
        begin = fr3.state().time_ms
        while fr3.state().time_ms < begin + 500:
            pass
    assert len(recording) == 100
    assert recording.lost >= 400


def test_a_connection_that_ends_ends_it(sim_fr3: franka_async.Sim) -> None:
    robot = Robot(sim_fr3.address, **PATIENT).connect().wait()
    with robot.record(["q", "slack"]) as recording:
        while len(recording) < 10:
            pass
        sim_fr3.stop()
        robot.closed().wait()
    assert len(recording) >= 10
    assert np.isnan(recording["slack"]).all()


def test_every_column_is_as_it_is_described(fr3: Robot) -> None:
    described = record_columns()
    assert described["time"] == ("s", ())
    names = [name for name in described if name != "time"]
    with fr3.record(names) as recording:
        while len(recording) < 5:
            pass
    state = fr3.state()
    for name, (unit, shape) in described.items():
        assert isinstance(unit, str)
        assert recording[name].shape == (len(recording), *shape), name
        if isinstance(getattr(state, name, None), np.ndarray):
            assert getattr(state, name).shape == shape, name
    np.testing.assert_allclose(recording["O_T_EE"][-1], state.O_T_EE, atol=1e-3)
    np.testing.assert_allclose(recording["I_ee"][-1], state.I_ee)


def test_columns_that_are_not_there_are_named(fr3: Robot) -> None:
    with pytest.raises(ValueError, match='got the column "speed", expected columns from time, q, q_d'):
        fr3.record(["speed"])
    recording = fr3.record(["q"])
    with pytest.raises(RuntimeError, match="this recording has not begun"):
        len(recording)
    with recording, pytest.raises(KeyError, match='got the column "dq", expected one of the recorded columns: time, q'):
        recording["dq"]
    with pytest.raises(RuntimeError, match="has already begun"):
        recording.__enter__()
