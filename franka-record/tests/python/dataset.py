"""Reads a dataset in LeRobot's layout with pyarrow, and with `--lerobot` also with LeRobot's own loader.

Usage: dataset.py [--lerobot] FOLDER FRAMES; prints a line if all is as the layout says.
"""

import json
import pathlib
import sys

import pyarrow as pa
import pyarrow.parquet as pq

TYPES = {"float32": pa.float32(), "int64": pa.int64(), "bool": pa.bool_()}


def table(root: pathlib.Path, pattern: str) -> pa.Table:
    files = sorted(root.glob(pattern))
    assert files, f"no {pattern} in {root}"
    return pa.concat_tables([pq.read_table(file, partitioning=None) for file in files])


def check(root: pathlib.Path, frames: int) -> str:
    info = json.loads((root / "meta/info.json").read_text())
    assert info["codebase_version"] == "v3.0", info["codebase_version"]
    assert info["total_frames"] == frames, info["total_frames"]
    data = table(root, "data/*/*.parquet")
    assert data.num_rows == frames, data.num_rows
    assert set(data.column_names) == set(info["features"]), data.column_names
    for name, feature in info["features"].items():
        column, item = data.column(name), TYPES[feature["dtype"]]
        assert column.null_count == 0, name
        if feature["shape"] == [1]:
            assert column.type == item, f"{name} is {column.type}"
            continue
        (length,) = feature["shape"]
        assert len(feature["names"]) == length, name
        assert pa.types.is_list(column.type) or pa.types.is_fixed_size_list(column.type), f"{name} is {column.type}"
        assert column.type.value_type == item, f"{name} is {column.type}"
        assert {len(row) for row in column.to_pylist()} == {length}, name
    episodes = table(root, "meta/episodes/*/*.parquet").to_pylist()
    assert len(episodes) == info["total_episodes"] and info["splits"] == {"train": f"0:{len(episodes)}"}
    tasks = table(root, "meta/tasks.parquet").to_pylist()
    assert [task["task_index"] for task in tasks] == list(range(info["total_tasks"]))
    rows, index = data.to_pylist(), 0
    for number, episode in enumerate(episodes):
        assert episode["episode_index"] == number and episode["dataset_from_index"] == index, episode
        for frame in range(episode["length"]):
            row = rows[index]
            assert (row["index"], row["episode_index"], row["frame_index"]) == (index, number, frame), row
            # As exact as 32 bits are.
            assert abs(row["timestamp"] - frame / info["fps"]) <= 1e-6 * max(1.0, row["timestamp"]), row
            assert 0 <= row["task_index"] < info["total_tasks"], row
            index += 1
        assert episode["dataset_to_index"] == index, episode
    assert index == frames, index
    return f"{frames} frames, {len(episodes)} episodes, {len(info['features'])} columns"


def load(root: pathlib.Path, frames: int) -> str:
    """What LeRobot's own loader makes of it: each frame, with the one before and the one after."""
    import lerobot
    import torch
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    fps = json.loads((root / "meta/info.json").read_text())["fps"]
    steps = {"observation.state": [-1 / fps, 0.0], "action": [0.0, 1 / fps]}
    dataset = LeRobotDataset("local/recorded", root=root, delta_timestamps=steps)
    assert len(dataset) == frames, len(dataset)
    width = dataset.meta.features["observation.state"]["shape"][0]
    for item in dataset:
        assert item["observation.state"].shape == (2, width) and item["action"].shape == (2, width)
        assert torch.isfinite(item["observation.state"]).all() and isinstance(item["task"], str)
    batches = list(torch.utils.data.DataLoader(dataset, batch_size=8))
    assert sum(len(batch["index"]) for batch in batches) == frames
    return f"loaded by LeRobot {getattr(lerobot, '__version__', '')}"


if __name__ == "__main__":
    *options, folder, count = sys.argv[1:]
    said = check(pathlib.Path(folder), int(count))
    if options == ["--lerobot"]:
        said += ", " + load(pathlib.Path(folder), int(count))
    print("ok   ", said)
