"""Writes a Rerun blueprint for recordings: `python rerun_blueprint.py recording.rbl`.

Needs `pip install rerun-sdk`. Then `rerun run.mcap recording.rbl` shows the recording: the frames of the arm, joints, wrench
and torques, and what happened. The version of the viewer has to be that of the package.
"""

import sys

import rerun.blueprint as rrb

# Entities are named after the channels; the fields of a message are its components.
CYCLE, FRAMES, TARGET, LOG = "/cycle", "/tf", "/target", "/log"


def blueprint() -> rrb.Blueprint:
    """The arrangement of the views."""
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(
                rrb.Spatial3DView(name="arm", contents=[f"{FRAMES}/**", f"{TARGET}/**"]),
                rrb.TextLogView(name="events", contents=[f"{LOG}/**"]),
                row_shares=[2, 1],
            ),
            rrb.DataframeView(name="cycles", contents=[f"{CYCLE}/**"]),
        ),
        collapse_panels=True,
    )


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    blueprint().save("franka-record", sys.argv[1])
