"""Recordings read back, and exported."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from conftest import PATIENT

from franka_async import ExportError, GripperState, RecordingError, RecordingFile, Sim, record_columns, recording_columns, sync

from franka_async.options import RecordOptions


@pytest.fixture(scope="module", params=["fr3", "fer"])
def path(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording of a robot with its hand: two episodes, each a motion, and homing between them."""
    path = tmp_path_factory.mktemp("recording") / f"{request.param}.mcap"
    with getattr(Sim, request.param)(virtual_time=True, patience=5.0, hand=True) as sim:
        with sync.Robot(sim.address, **PATIENT) as robot, sync.Gripper(str(sim.hand_address)) as gripper:
            # The time of the robot is faster than the clock on the wall: chunks are short, so that there are some.
            options: RecordOptions = {"flush": 0.03, "metadata": {"cell": "7"}, "attachments": {"plan.json": b"{}"}}
            with sync.Recorder.to_file(path, **options) as recorder:
                recorder.attach(robot)
                recorder.attach_gripper(gripper)
                # Its width is known from here on.
                gripper.homing()
                with recorder.episode("up", task="move up") as episode:
                    robot.move_by([0.0, 0.0, 0.03])
                    episode.success = True
                with recorder.episode("down", task="move down"):
                    robot.move_by([0.0, 0.0, -0.02])
    return path


@pytest.fixture
def recording(path: Path) -> RecordingFile:
    return RecordingFile.open(path)


def test_a_file_says_what_it_holds(recording: RecordingFile, path: Path) -> None:
    assert recording.damage is None and recording.metadata["cell"] == "7"
    [robot] = recording.robots
    assert (robot.name, robot.kind) == ("", path.stem)
    assert robot.metadata["protocol"] == {"fr3": "10", "fer": "5"}[path.stem]
    assert recording.attachment("plan.json") == b"{}" and "plan.json" in recording.attachments()
    assert recording.attachment("other.json") is None
    assert recording.span is not None
    begin, end = recording.span
    assert repr(recording) == f"<RecordingFile of {path.stem}, {(end - begin) / 1e9:.1f} s>"


def test_columns_are_arrays_with_a_row_for_each_cycle(recording: RecordingFile) -> None:
    described = recording_columns()
    assert set(described) - {"host_time"} < set(record_columns())
    columns = recording.columns([name for name in described if name not in ("time", "host_time")])
    rows = len(columns["time"])
    assert rows > 1000 and (np.diff(columns["time"]) > 0.0005).all() and (np.diff(columns["host_time"]) >= 0).all()
    for name, (_, shape) in described.items():
        assert columns[name].shape == (rows, *shape), name
    assert columns["host_time"].dtype == np.int64 and columns["current_errors"].dtype == bool
    np.testing.assert_array_equal(recording.column("q"), columns["q"])
    runs = columns["activity"] == "running"
    assert runs.sum() > 500 and np.abs(columns["q"][runs] - columns["q_ref"][runs]).max() < 0.1
    with pytest.raises(ValueError, match='got the column "theta", expected columns from q, q_d'):
        recording.column("theta")


def test_every_cycle_has_its_state(recording: RecordingFile) -> None:
    columns = recording.columns(["q", "O_T_EE", "robot_mode"])
    count = 0
    for row, cycle in enumerate(recording):
        if row % 100 == 0:
            assert cycle.host_time == columns["host_time"][row]
            assert cycle.state.time_ms == round(1000 * columns["time"][row])
            np.testing.assert_array_equal(cycle.state.q, columns["q"][row])
            np.testing.assert_array_equal(cycle.state.O_T_EE, columns["O_T_EE"][row])
            assert cycle["robot_mode"] == columns["robot_mode"][row]
        count += 1
    assert count == len(columns["q"])


def test_parts_and_rates(recording: RecordingFile) -> None:
    times = recording.column("host_time")
    begin, end = int(times[100]), int(times[300])
    part = recording.between(begin, end)
    expected = times[(times >= begin) & (times <= end)]
    np.testing.assert_array_equal(part.column("host_time"), expected)
    assert len(part.between(end=begin - 1).column("q")) == 0
    np.testing.assert_array_equal(part.between(begin=0).column("host_time"), expected)
    seconds = recording.resampled(50.0).column("time")
    assert len(seconds) == pytest.approx(50 * (seconds[-1] - seconds[0]), abs=2)
    with pytest.raises(ValueError, match="rate is 0, expected more than 0"):
        recording.resampled(0.0)


def test_events_episodes_and_the_hand(recording: RecordingFile) -> None:
    events = recording.events()
    outcomes = [event for event in events if event.kind == "outcome"]
    goals = [event for event in events if event.kind == "goal"]
    assert [event.ending for event in outcomes] == ["arrived", "arrived"] and len(goals) == 2
    assert [event.goal for event in goals] == [event.goal for event in outcomes] and outcomes[0].level == "info"
    assert all(event.text and event.source for event in events)
    up, down = recording.episodes()
    assert (up.name, up.task, up.success) == ("up", "move up", True)
    assert (down.name, down.success) == ("down", None) and up.begin < up.end <= down.begin
    heights = recording.between(up.begin, up.end).column("O_T_EE")[:, 2, 3]
    assert heights[-1] - heights[0] == pytest.approx(0.03, abs=5e-3)
    states = recording.gripper_states()
    assert states and all(isinstance(state, GripperState) for _, state in states)
    assert max(state.width for _, state in states if isinstance(state, GripperState)) > 0.05


def test_tables_have_the_same_rows(recording: RecordingFile, tmp_path: Path) -> None:
    q = recording.column("q")
    assert recording.to_csv(tmp_path / "run.csv", ["q", "robot_mode"], units=False) == len(q)
    header, *lines = (tmp_path / "run.csv").read_text().splitlines()
    assert header == "time,host_time," + ",".join(f"q[{i}]" for i in range(7)) + ",robot_mode"
    np.testing.assert_allclose([[float(value) for value in line.split(",")[2:9]] for line in lines], q)
    assert recording.to_parquet(tmp_path / "run.parquet", ["q"]) == len(q)
    assert (tmp_path / "run.parquet").read_bytes()[:4] == b"PAR1"
    with pytest.raises(ValueError, match='got the column "speed"'):
        recording.to_csv(tmp_path / "other.csv", ["speed"])
    assert not (tmp_path / "other.csv").exists()
    with pytest.raises(ExportError, match="No such file") as missing:
        recording.to_csv(tmp_path / "missing" / "run.csv")
    assert (missing.value.kind, missing.value.party) == ("io", "host")


def test_episodes_become_a_dataset(recording: RecordingFile, path: Path, tmp_path: Path) -> None:
    folder = tmp_path / "dataset"
    commanded = recording.to_lerobot(tmp_path / "commanded", fps=20)
    episodes, frames = recording.to_lerobot(folder, fps=20, action="measured")
    cycles = sum(len(recording.between(episode.begin, episode.end).column("q")) for episode in recording.episodes())
    assert episodes == 2 and frames == pytest.approx(cycles * 20 / 1000, abs=4)
    assert commanded[0] == 2 and 0 < commanded[1] <= frames  # without the rest around the motions

    def info() -> dict[str, object]:
        info: dict[str, object] = json.loads((folder / "meta" / "info.json").read_text())
        return info

    assert info()["robot_type"] == f"franka_{path.stem}" and info()["total_frames"] == frames
    with pytest.raises(ExportError, match="expected an empty or new folder") as there:
        recording.to_lerobot(folder, fps=20, action="measured")
    assert (there.value.kind, there.value.party) == ("dataset", "caller")
    assert recording.to_lerobot(folder, fps=20, action="measured", append=True) == (2, frames)
    assert info()["total_episodes"] == 4
    name = recording.episodes()[1].name
    assert recording.to_lerobot(tmp_path / "one", fps=20, episodes=[name])[0] == 1
    first = recording.episodes()[0]
    with pytest.raises(ExportError, match=f'"{first.name}" has begun, but not ended'):
        recording.between(first.begin, first.end - 1).to_lerobot(tmp_path / "open")
    with pytest.raises(ValueError, match='got the episode "none", expected one of '):
        recording.to_lerobot(tmp_path / "none", episodes=["none"])
    with pytest.raises(ValueError, match="action is \"guess\", expected 'reference' or 'measured'"):
        recording.to_lerobot(folder, action="guess")  # type: ignore[arg-type]


def test_a_file_without_its_end_is_read_and_made_whole(path: Path, tmp_path: Path) -> None:
    whole = RecordingFile.open(path)
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(path.read_bytes()[: path.stat().st_size * 5 // 6])
    damaged = RecordingFile.open(cut)
    assert damaged.damage is not None and "damaged" in repr(damaged)
    rows = damaged.column("q")
    assert 0 < len(rows) < len(whole.column("q"))
    recovery = RecordingFile.recover(cut, tmp_path / "mended.mcap")
    assert recovery.messages > len(rows) and recovery.damage is not None
    mended = RecordingFile.open(tmp_path / "mended.mcap")
    assert mended.damage is None
    np.testing.assert_array_equal(mended.column("q"), rows)


def test_what_is_no_recording_is_said(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="No such file") as missing:
        RecordingFile.open(tmp_path / "missing.mcap")
    assert (missing.value.kind, missing.value.party) == ("file", "host")
    (tmp_path / "text.mcap").write_text("this is text")
    with pytest.raises(RecordingError, match="not an MCAP file") as text:
        RecordingFile.open(tmp_path / "text.mcap")
    assert (text.value.kind, text.value.party) == ("not_mcap", "caller")


def test_files_of_other_programs_are_named(tmp_path: Path) -> None:
    def record(kind: int, body: bytes) -> bytes:
        return bytes([kind]) + len(body).to_bytes(8, "little") + body

    def text(text: str) -> bytes:
        return len(text).to_bytes(4, "little") + text.encode()

    magic = b"\x89MCAP0\r\n"
    head = magic + record(0x01, text("ros2") + text("libmcap 0.8.0")) + record(0x0F, bytes(4))
    footer = len(head).to_bytes(8, "little") + bytes(12)
    (tmp_path / "bag.mcap").write_bytes(head + record(0x0B, bytes(46)) + record(0x02, footer) + magic)
    with pytest.raises(RecordingError, match='not a recording of this program.*"libmcap 0.8.0"') as error:
        RecordingFile.open(tmp_path / "bag.mcap")
    assert (error.value.kind, error.value.party) == ("foreign", "caller")


@pytest.fixture
def pair(tmp_path: Path) -> Iterator[RecordingFile]:
    """A recording of two robots."""
    with Sim.fr3(virtual_time=True) as left, Sim.fer(virtual_time=True) as right:
        with sync.Robot(left.address, **PATIENT) as one, sync.Robot(right.address, **PATIENT) as other:
            with sync.Recorder.to_file(tmp_path / "pair.mcap") as recorder:
                recorder.attach(one, "left")
                recorder.attach(other, "right")
                one.move_by([0.0, 0.0, 0.01])
                other.move_by([0.0, 0.0, 0.01])
        yield RecordingFile.open(tmp_path / "pair.mcap")


def test_of_several_robots_one_is_chosen(pair: RecordingFile, tmp_path: Path) -> None:
    assert [(robot.name, robot.kind) for robot in pair.robots] == [("left", "fr3"), ("right", "fer")]
    with pytest.raises(ValueError, match="the recording has 2 robots, .*: choose one with robot"):
        pair.column("q")
    left, right = pair.robot("left"), pair.robot("right")
    assert len(left.column("q")) > 100 and len(right.column("q")) > 100
    assert repr(left).startswith("<RecordingFile of left,")
    with pytest.raises(RecordingError, match='got the robot name "middle", expected one of'):
        pair.robot("middle")
    with pytest.raises(ValueError, match="the recording has 2 robots"):
        pair.to_lerobot(tmp_path / "dataset")


