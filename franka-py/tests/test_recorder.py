"""Recordings of robots in files."""

import asyncio
from pathlib import Path

import pytest
from conftest import PATIENT, connection

import franka_async
from franka_async import ControlError, RecordError, Recorder, Robot, Sim, Team, sync
from franka_async.recording import BlackBox

MCAP = b"\x89MCAP0\r\n"


def test_a_robot_and_its_hand_are_recorded_until_the_block_ends(tmp_path: Path) -> None:
    async def main(sim: Sim, path: Path) -> None:
        async with connection(sim) as robot, franka_async.Gripper(str(sim.hand_address)) as gripper:
            async with Recorder.to_file(path, metadata={"cell": "7"}, attachments={"plan.json": b"{}"}) as recorder:
                await recorder.attach(robot)
                recorder.attach_gripper(gripper)
                with recorder.episode("up-1", task="move up") as episode:
                    assert (episode.name, episode.task, episode.success) == ("up-1", "move up", None)
                    begin = robot.state().time_ms
                    await robot.move_by([0.0, 0.0, 0.03])
                    lasted = robot.state().time_ms - begin
                    episode.success = True
                recorder.note("half of it")
                await gripper.homing()
            status = await recorder.finish()
        assert status == recorder.status() and status.error is None and status.dropped == status.events_dropped == 0
        # The hand homes in the time of the robot: there are more.
        assert status.cycles >= 0.9 * lasted
        assert status.files == [path] and status.waiting == 0
        assert status.bytes == path.stat().st_size and path.read_bytes().startswith(MCAP)
        assert repr(recorder) == f"<Recorder to {path}, {status.cycles} cycles, 0 dropped>"

    for kind in (Sim.fr3, Sim.fer):
        with kind(virtual_time=True, patience=5.0, hand=True) as sim:
            asyncio.run(main(sim, tmp_path / f"{kind.__name__}.mcap"))


def test_threads_record_as_well(sim: Sim, tmp_path: Path) -> None:
    with sync.Robot(sim.address, **PATIENT) as robot:
        with sync.Recorder.to_file(tmp_path / "run.mcap", thinned=True) as recorder:
            assert isinstance(recorder, sync.Recorder)
            recorder.attach(robot, "arm")
            robot.move_by([0.0, 0.0, 0.02])
            with pytest.raises(KeyError), recorder.episode("down", task="move down") as episode:
                raise KeyError("of the program")
            assert episode.success is False
        status = recorder.status()
        assert status.cycles > 300 and status.error is None and recorder.finish() == status


def test_the_arms_of_a_team_are_recorded(fr3: Robot, fer: Robot, tmp_path: Path) -> None:
    async def main() -> None:
        async with Recorder.to_file(tmp_path / "team.mcap") as recorder:
            async with await Team.engage(fr3, fer, silence=10.0) as team:
                with pytest.raises(TypeError, match="got 1 names, expected 2"):
                    recorder.attach_team(team, ["left"])
                await recorder.attach_team(team, ["left", "right"])
                await team.arms[0].move_by([0.0, 0.0, 0.01])
            with pytest.raises(RecordError, match='a robot named "left" is already recorded') as raised:
                await recorder.attach(fr3, "left")
            assert (raised.value.kind, raised.value.party) == ("same_name", "caller")
        assert recorder.status().cycles > 300

    asyncio.run(main())


def test_a_reflex_writes_the_black_box(robot: Robot, sim: Sim, tmp_path: Path) -> None:
    async def main() -> None:
        box = BlackBox(tmp_path / "incidents", before=2.0, after=0.1, keep=3)
        async with Recorder.to_file(tmp_path / "run.mcap", black_box=box) as recorder:
            await recorder.attach(robot)
            assert recorder.status().black_boxes == []
            motion = asyncio.ensure_future(robot.move_by([0.0, 0.0, 0.1]))
            while robot.reference() is None:
                await asyncio.sleep(0)
            sim.trip("joint_reflex")
            with pytest.raises(ControlError):
                await motion
        status = recorder.status()
        [file] = status.black_boxes
        assert file.parent == tmp_path / "incidents" and file.name.endswith("-reflex.mcap")
        assert file.read_bytes().startswith(MCAP) and status.black_box_error is None
        async with Recorder.black_box(tmp_path / "nothing", before=2.0) as idle:
            await idle.attach(robot)
        assert idle.status().black_boxes == [] and idle.status().files == []

    asyncio.run(main())


def test_what_is_wrong_is_said(fr3: Robot, tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    recorder = Recorder.to_file(path)
    with pytest.raises(RecordError, match="a recording never overwrites a file") as exists:
        Recorder.to_file(path)
    assert (exists.value.kind, exists.value.party) == ("exists", "caller")
    with pytest.raises(RecordError, match="cannot create .*No such file") as create:
        Recorder.to_file(tmp_path / "missing" / "run.mcap")
    assert (create.value.kind, create.value.party) == ("create", "host")
    for options, text in (
        ({"flush": 5.0}, "flush is 5s, expected 0.01 s to 1 s"),
        ({"rotate_bytes": 10}, "rotation.bytes is 10, expected 1000000 or more"),
        ({"rotate_time": -1.0}, "rotate_time is -1 s, expected"),
        ({"black_box": BlackBox(tmp_path, before=0.5)}, "black_box.before is 500ms"),
    ):
        with pytest.raises(ValueError, match=text):
            Recorder.to_file(tmp_path / "other.mcap", **options)
    with pytest.raises(TypeError, match="unexpected keyword argument 'rotation'"):
        Recorder.to_file(tmp_path / "other.mcap", rotation=1)  # type: ignore[call-arg]
    assert not (tmp_path / "other.mcap").exists()

    with pytest.raises(ValueError, match="letters, digits"):
        recorder.attach(fr3, "left arm").wait()
    with pytest.raises(ValueError, match="ring of the reader has 0 cycles"):
        recorder.attach(fr3, capacity=0).wait()
    with pytest.raises(TypeError, match="gripper is Robot, expected a Gripper or a VacuumGripper"):
        recorder.attach_gripper(fr3)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="expected 1 to 128 letters"):
        recorder.episode("a/b", task="move")
    with pytest.raises(ValueError, match="has an empty task"):
        recorder.episode("up", task=" ")
    with recorder.episode("up", task="move up") as episode:
        with pytest.raises(RuntimeError, match="another episode of this recording is running"):
            recorder.episode("down", task="move down").__enter__()
        with pytest.raises(RuntimeError, match="has already begun"):
            episode.__enter__()
    recorder.finish().wait()
    ended = (lambda: recorder.note("late"), lambda: recorder.attach(fr3).wait(), recorder.episode("up", task="up").__enter__)
    for late in ended:
        with pytest.raises(RecordError, match="the recorder has ended"):
            late()
