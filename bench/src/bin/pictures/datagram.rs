//! The journey of a datagram: the actions of robot, control thread and program within a
//! millisecond.

use svg::Node as _;
use svg::node::element::Group;

use crate::canvas::{
    BLUE, GREEN, GREY, INK, ORANGE, arrow, centred, file, labelled, line, paper, text,
};

pub(crate) fn draw() -> String {
    let document = paper(
        WIDTH,
        HEIGHT,
        "From a state of the robot to its command, and what else happens in that millisecond",
    );
    file(
        document,
        [lanes(), exchange(), work(), program(), requests()],
    )
}

/// Names of the lanes, and the moments at which states leave.
fn lanes() -> Group {
    let mut group = Group::new();
    for (y, name, about) in [
        (ROBOT, "robot", "1 kHz"),
        (THREAD, "control thread", "SCHED_FIFO"),
        (TASKS, "your program", "any rate"),
    ] {
        group.append(text(14.0, y + 4.0, name).set("font-weight", "bold"));
        group.append(text(14.0, y + 21.0, about).set("fill", GREY));
    }
    for (moment, name) in [(0.0, "state n"), (1.0, "state n + 1")] {
        let x = at(moment);
        group.append(
            line((x, ROBOT + 12.0), (x, TASKS + 40.0), GREY).set("stroke-dasharray", "3 4"),
        );
        group.append(centred(x, ROBOT - 22.0, name));
    }
    group.append(line((at(-0.03), ROBOT), (at(1.13), ROBOT), GREEN).set("stroke-width", 2));
    group.append(arrow(
        (at(0.36), ROBOT - 26.0),
        (at(0.0) + 40.0, ROBOT - 26.0),
        GREY,
    ));
    group.append(arrow(
        (at(0.64), ROBOT - 26.0),
        (at(1.0) - 52.0, ROBOT - 26.0),
        GREY,
    ));
    group.append(centred(at(0.5), ROBOT - 22.0, "one millisecond").set("fill", GREY));
    group
}

/// The datagrams.
fn exchange() -> Group {
    Group::new()
        .add(arrow((at(0.0), ROBOT), (at(0.12), THREAD - 18.0), GREEN))
        .add(
            text(at(0.0) - 6.0, 104.0, "UDP")
                .set("text-anchor", "end")
                .set("fill", GREY),
        )
        .add(arrow(
            (at(0.45), THREAD - 18.0),
            (at(0.57), ROBOT + 3.0),
            BLUE,
        ))
        .add(text(at(0.53) + 14.0, 104.0, "command n"))
        .add(arrow((at(1.0), ROBOT), (at(1.12), THREAD - 18.0), GREEN))
}

/// The phases of the thread.
fn work() -> Group {
    let mut group = Group::new();
    for (from, to, name, colour) in [
        (0.12, 0.22, "decode", BLUE),
        (0.22, 0.38, "law, guards", BLUE),
        (0.38, 0.46, "send", BLUE),
        (0.47, 0.59, "publish", GREY),
        (0.59, 0.85, "prepare the next step", GREY),
    ] {
        let x = at(from);
        group.append(labelled(
            x,
            THREAD - 17.0,
            at(to) - x - 2.0,
            34.0,
            colour,
            name,
        ));
    }
    group.append(centred(at(0.925), THREAD + 4.5, "sleep").set("fill", GREY));
    group
}

/// The data exchanged with the program.
fn program() -> Group {
    let published = at(0.53);
    let goals = at(0.72);
    Group::new()
        .add(arrow(
            (published, THREAD + 18.0),
            (published, TASKS - 18.0),
            INK,
        ))
        .add(
            text(published - 8.0, 246.0, "newest state, records, events").set("text-anchor", "end"),
        )
        .add(arrow((goals, TASKS - 18.0), (goals, THREAD + 18.0), ORANGE))
        .add(text(goals + 8.0, 246.0, "newest goal"))
        .add(labelled(
            at(0.0) + 8.0,
            TASKS - 17.0,
            at(1.0) - at(0.0) - 16.0,
            34.0,
            ORANGE,
            "tasks of the runtime: web handlers, a policy, a planner; may be late, or blocked",
        ))
}

/// The requests in parallel, over TCP.
fn requests() -> Group {
    let y = TASKS + 62.0;
    Group::new()
        .add(text(14.0, y + 4.0, "beside, over TCP:").set("fill", GREY))
        .add(text(at(0.0) + 8.0, y + 4.0, "requests (move, stop, set a load, recover) and their replies; a motion is over when both sides say so").set("fill", GREY))
}

/// Returns the position of a moment, in milliseconds after the first state.
fn at(milliseconds: f64) -> f64 {
    158.0 + 590.0 * milliseconds
}

const WIDTH: f64 = 850.0;
const HEIGHT: f64 = 372.0;
const ROBOT: f64 = 56.0;
const THREAD: f64 = 176.0;
const TASKS: f64 = 290.0;
