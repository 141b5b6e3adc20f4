"""Explanations of stops, from recordings and from errors."""

import asyncio
import copy
import multiprocessing
import pickle
import xml.etree.ElementTree as ElementTree
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from conftest import PATIENT, begun

import franka_async
from franka_async import ControlError, Explanation, Recorder, RecordingFile, Robot, Sim, explain


@pytest.fixture(scope="module", params=["fr3", "fer"])
def hit(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, ControlError]:
    """A recording of a motion that is pushed to the left with 60 N until the robot stops, and the error."""
    path = tmp_path_factory.mktemp("hit") / f"{request.param}.mcap"

    async def main(sim: Sim) -> ControlError:
        async with Robot(sim.address, **PATIENT) as robot, Recorder.to_file(path) as recorder:
            await recorder.attach(robot)
            motion = asyncio.ensure_future(robot.move_by([0.0, 0.2, 0.0], speed=0.3))
            await begun(robot)
            sim.push([0.0, -60.0, 0.0])
            with pytest.raises(ControlError) as raised:
                await motion
            return raised.value

    with getattr(Sim, request.param)(virtual_time=True, patience=5.0) as sim:
        return path, asyncio.run(main(sim))


def check(explanation: Explanation, error: ControlError, kind: str) -> None:
    assert explanation.robot == kind and explanation.errors == error.errors
    assert explanation.first_ms < explanation.end_ms <= explanation.last_ms
    assert repr(explanation).startswith(f"<Explanation of {explanation.cycles} cycles of an {kind}, stopped by {error.errors[0]}")
    text = str(explanation)
    assert f"Why the robot stopped at {explanation.end_ms} ms" in text and "Contact with the arm" in text
    assert explanation.cause == error.diagnosis and explanation.findings == error.findings
    collisions = [moment for moment in explanation.timeline if moment.kind == "collision"]
    assert collisions and all(explanation.first_ms <= moment.time_ms <= explanation.last_ms for moment in collisions)
    velocity = explanation.margins["velocity"]
    assert velocity.joint in range(1, 8) and velocity.margin == pytest.approx(abs(velocity.limit) - abs(velocity.value), abs=1e-9)
    assert explanation.peaks["external_torque"].value > 10.0
    contact = explanation.contact
    assert contact is not None and contact.link in range(9) and 0.0 < contact.probability <= 1.0
    assert contact.point.shape == contact.force.shape == (3,)
    # It came from the left, along y.
    assert contact.force[1] < -30.0 and np.abs(contact.force[[0, 2]]).max() < 30.0


def test_a_recording_is_explained(hit: tuple[Path, ControlError]) -> None:
    path, error = hit
    recording = RecordingFile.open(path)
    explanation = explain(recording)
    check(explanation, error, path.stem)
    assert explanation.cycles == len(recording.column("q"))
    # The explanation uses the limits of the simulated robot's system.
    assert explanation.fallback is None
    expected = recording.model().joint_limits.upper[0]
    assert expected == pytest.approx(2.9007 if path.stem == "fr3" else 2.8973, abs=1e-3)
    svg = explanation.svg()
    assert ElementTree.fromstring(svg).tag.endswith("svg") and len(svg) < 200_000
    html = explanation._repr_html_()
    assert html.startswith(svg) and "<pre>" in html and "Contact with the arm" in html
    # Before the push there was nothing to explain.
    before = explain(recording.between(end=int(recording.column("host_time")[4])))
    assert before.cause is None and before.errors == [] and "not stopped" in repr(before)
    end = explanation.end_host_time
    assert end is not None and end in recording.column("host_time")
    assert (explanation.under_way, explanation.earlier) == (None, 0)
    # The motion had not ended then.
    cut = explain(recording.between(end=end - 1))
    assert cut.cause is None and cut.under_way is not None and "was running" in str(cut)


def test_an_error_is_explained_with_its_log(hit: tuple[Path, ControlError]) -> None:
    path, error = hit
    explanation = explain(error)
    check(explanation, error, path.stem)
    assert explanation.cycles == len(error.log) and explanation.end_host_time is None
    assert explanation.late == 0
    assert str(explain(error.log)) == str(explanation)


def test_an_error_is_pickled_with_its_log(hit: tuple[Path, ControlError]) -> None:
    _, error = hit
    same: ControlError = pickle.loads(pickle.dumps(error))
    assert type(same) is ControlError and str(same) == str(error)
    for name in ("kind", "party", "entry", "errors", "move_status", "is_ready_for_more", "diagnosis", "findings"):
        assert getattr(same, name) == getattr(error, name), name
    assert len(same.log) == len(error.log) and same.to_csv() == error.to_csv()
    assert same.log.states() == error.log.states()
    np.testing.assert_array_equal(same.log.sent("tau_J_d"), error.log.sent("tau_J_d"))
    assert copy.copy(error.log).to_csv() == error.to_csv()
    with pytest.raises(ValueError, match="this log was pickled"):
        explain(same)
    # As another process passes it on.
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        raised = pool.submit(_raise, pickle.dumps(error)).exception()
    assert isinstance(raised, ControlError) and raised.errors == error.errors and len(raised.log) == len(error.log)


def _raise(error: bytes) -> None:
    raise pickle.loads(error)


def test_what_cannot_be_explained_is_said() -> None:
    with pytest.raises(TypeError, match="got str, expected a RecordingFile, a ControlError or a ControlLog"):
        explain("run.mcap")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="got MotionError, expected"):
        explain(franka_async.MotionError("superseded"))  # type: ignore[arg-type]
