"""Recorded motions that an arm makes again."""

from pathlib import Path

import numpy as np
import pytest
from conftest import PATIENT

from franka_async import FrankaError, MotionError, RecordingFile, ReplayError, Robot, Sim, sync


@pytest.fixture(scope="module", params=["fr3", "fer"])
def motion(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> RecordingFile:
    """The recording of a motion in a session."""
    path = tmp_path_factory.mktemp("motion") / f"{request.param}.mcap"
    with getattr(Sim, request.param)(virtual_time=True, patience=5.0) as sim:
        with sync.Robot(sim.address, **PATIENT) as robot, sync.Recorder.to_file(path) as recorder:
            recorder.attach(robot)
            with recorder.episode("up", task="move up"), robot.engage() as arm:
                arm.move_by([0.0, 0.0, 0.05])
    recording = RecordingFile.open(path)
    [episode] = recording.episodes()
    return recording.between(episode.begin, episode.end)


def test_a_recorded_motion_is_made_again(motion: RecordingFile) -> None:
    kind = motion.robots[0].kind
    recorded = motion.column("q")
    with getattr(Sim, str(kind))(patience=5.0) as sim:
        with sync.Robot(sim.address, **PATIENT) as robot:
            robot.move_by([0.05, 0.0, 0.0])
            # It begins where the recording does, regardless of the position of the arm.
            report = robot.replay(motion, speed=0.5)
            assert report.duration == pytest.approx(2 * len(recorded) / 1000, rel=0.1)
            assert report.states > 0  # A thread on a busy machine misses states.
            assert 0.0 <= report.joints.median <= report.joints.p95 <= report.joints.max < 0.05
            assert report.position.max < 0.02
            np.testing.assert_allclose(robot.state().q, recorded[-1], atol=0.01)
            with robot.engage() as arm:
                again = arm.replay(motion, source="measured", targets="poses")
                assert again.duration < report.duration
            np.testing.assert_allclose(robot.state().q, recorded[-1], atol=0.01)


def test_what_cannot_be_replayed_is_refused(motion: RecordingFile, fr3: Robot, fer: Robot) -> None:
    robots = {"fr3": fr3, "fer": fer}
    robot = robots.pop(str(motion.robots[0].kind))
    [other] = robots.values()
    before = robot.state().q
    with pytest.raises(ReplayError, match="the recorded robot is F.*, expected F") as kind:
        other.replay(motion).wait()
    assert (kind.value.kind, kind.value.party, kind.value.is_ready_for_more) == ("kind", "caller", True)
    assert isinstance(kind.value, MotionError)
    with pytest.raises(ValueError, match="the speed factor is 2, expected 0.01 to 1"):
        robot.replay(motion, speed=2.0).wait()
    with pytest.raises(ReplayError, match="0 cycles, expected 2 or more"):
        robot.replay(motion.between(end=0)).wait()
    with pytest.raises(ValueError, match="source is \"guess\", expected 'reference' or 'measured'"):
        robot.replay(motion, source="guess")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="targets is \"hand\", expected 'joints' or 'poses'"):
        robot.replay(motion, targets="hand")  # type: ignore[arg-type]
    np.testing.assert_allclose(robot.state().q, before, atol=1e-3)
    with pytest.raises(FrankaError, match="not connected"):
        Robot("localhost").replay(motion)
