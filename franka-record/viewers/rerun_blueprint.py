"""Writes a Rerun blueprint for recordings: `python rerun_blueprint.py recording.rbl fr3`, or `fer`.

Needs `pip install rerun-sdk`, in the version of the viewer; 0.41.0 was tried. A blueprint is applied to recordings with its
application id, and the viewer gives each MCAP file an id of its own. Convert a recording first, then show both:

    rerun mcap convert run.mcap --application-id franka-record -o run.rrd
    rerun run.rrd recording.rbl

The views are the frames of the arm, the events, and the cycles as a table. Robots with names have them before their kinds, as
in `left_fr3 right_fer`; each arm has a view of its own, as a recording does not say how their bases stand to each other.
"""

import sys

import rerun as rr
import rerun.blueprint as rrb

# Blueprints are found by it.
APPLICATION_ID = "franka-record"

# Entities are named after the channels; the fields of a message are its components.
CYCLE, FRAMES, LOG = "/cycle", "/tf", "/log"


def arm(robot: str) -> rrb.Spatial3DView:
    """The frames of one arm, which has no axes of its own to be seen by."""
    name, _, _ = robot.rpartition("_")
    frames = f"/{name}{FRAMES}" if name else FRAMES
    return rrb.Spatial3DView(
        name=name or "arm",
        contents=[f"{frames}/**"],
        overrides={frames: rr.TransformAxes3D(0.1)},
        spatial_information=rrb.SpatialInformation(target_frame=f"{robot}_link0"),
    )


def blueprint(robots: list[str]) -> rrb.Blueprint:
    """The arrangement of the views."""
    names = [robot.rpartition("_")[0] for robot in robots]

    def channels(channel: str) -> list[str]:
        return [f"/{name}{channel}/**" if name else f"{channel}/**" for name in names]

    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(
                rrb.Horizontal(*map(arm, robots)),
                rrb.TextLogView(name="events", contents=channels(LOG)),
                row_shares=[2, 1],
            ),
            rrb.DataframeView(name="cycles", contents=channels(CYCLE)),
        ),
        collapse_panels=True,
    )


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    blueprint(sys.argv[2:]).save(APPLICATION_ID, sys.argv[1])
