"""Decodes every message of recordings with the standard reader, and checks what they say.

Usage: decode.py CYCLES FILE...; prints a line per file.
"""

import sys

from mcap.reader import SeekingReader, make_reader
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory


def check(path: str, cycles: int) -> str:
    counts: dict[str, int] = {}
    newest: dict[str, int] = {}
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert isinstance(reader, SeekingReader), "no index"
        summary = reader.get_summary()
        assert summary is not None and summary.statistics is not None
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            assert schema is not None and schema.name == decoded.DESCRIPTOR.full_name
            topic = channel.topic
            counts[topic] = counts.get(topic, 0) + 1
            assert message.log_time >= newest.get(topic, 0), topic
            newest[topic] = message.log_time
            if schema.name == "franka.Cycle":
                assert decoded.robot_time == counts[topic], (decoded.robot_time, counts[topic])
                assert len(decoded.q) == 7 and len(decoded.O_F_ext) == 6
                assert abs(decoded.O_T_EE.x - 0.5) < 1e-6
            if schema.name == "foxglove.FrameTransforms":
                assert len(decoded.transforms) >= 9
        assert sum(counts.values()) == summary.statistics.message_count
        metadata = {entry.name for entry in reader.iter_metadata()}
        assert "recording" in metadata and any(name.startswith("robot:") for name in metadata)
        attachments = list(reader.iter_attachments())
        assert attachments, "the description of the robot is missing"
        for attachment in attachments:
            # Of the recording, not of 1970: viewers show the time from the earliest record on.
            off = attachment.log_time - summary.statistics.message_start_time
            assert abs(off) < 3600 * 10**9, (attachment.name, off)
    for topic in ("/cycle", "/tool", "/event", "/log", "/tf", "/target", "/joints", "/scene", "/gripper"):
        assert counts.get(topic, 0) > 0, f"nothing in {topic}"
    assert counts["/cycle"] == cycles, counts
    with open(path, "rb") as file:
        records = sum(1 for _ in StreamReader(file, validate_crcs=True).records)
    return f"{sum(counts.values())} messages, {records} records, {len(counts)} channels"


if __name__ == "__main__":
    for name in sys.argv[2:]:
        print("ok   ", name, check(name, int(sys.argv[1])))
