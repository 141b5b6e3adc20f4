//! Python names of the variants of Rust's enums: the kinds of errors, modes, events.
//!
//! They are part of the package's interface, and are listed only here: a variant renamed in Rust
//! keeps its name in Python. A new variant needs a row, and its kind one in `kinds.py`.

use franka_async::MotionError;
use franka_async::control::TargetStatus;
use franka_async::error::{
    ActiveError, CloseReason, CommandError, ConnectError, GripperError, IdentifyError, MoveStatus,
    Party, ReadError, Unready, VacuumGripperError,
};
use franka_async::explain::MomentKind;
use franka_async::export::ExportError;
use franka_async::model::RobotKind;
use franka_async::realtime::Phase;
use franka_async::record::{AttachError, Guard};
use franka_async::recording::{RecordError, RecordingError, TrackError, event};
use franka_async::replay::{ReplayError, ReplayFailure};
use franka_async::state::{ControllerMode, MotionGeneratorMode, RobotMode, TareRefused};
use franka_async::supervision::{Condition, EventKind, NotRecovered};
use franka_async::team::{MemberFault, TeamStop};
use franka_async::vacuum::DeviceStatus;
use franka_proto::{gripper, vacuum};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// An enum whose variants have names in Python.
pub(crate) trait Named {
    /// The names of all variants.
    const NAMES: &'static [&'static str];

    /// The name of this variant.
    fn python_name(&self) -> &'static str;
}

/// Implements [`Named`]. The last name of a non-exhaustive enum is for variants unknown to this
/// package.
macro_rules! names {
    (@ $type:ty => { $($variant:ident: $name:literal,)+ $(_: $unknown:literal,)? }) => {
        impl Named for $type {
            const NAMES: &'static [&'static str] = &[$($name),+];

            fn python_name(&self) -> &'static str {
                match self {
                    $(Self::$variant { .. } => $name,)+
                    $(_ => $unknown,)?
                }
            }
        }
    };
    ($($($type:ty),+ => $names:tt)+) => {
        $($(names!(@ $type => $names);)+)+
    };
}

// Errors.
names! {
    ConnectError, ConnectError<gripper::Version>, ConnectError<vacuum::Version> => {
        Realtime: "realtime", Endpoint: "endpoint", LinkTimeout: "link_timeout",
        LogSize: "log_size", Unsupervised: "unsupervised", Known: "known", System: "system",
        Refused: "refused", Timeout: "timeout", Network: "network", NoAddress: "no_address",
        IncompatibleVersion: "incompatible_version", ConnectionClosed: "connection_closed",
        Datagram: "datagram", Violation: "violation", Frame: "frame",
        HandshakeTimeout: "handshake_timeout", NoState: "no_state", Model: "model",
        Geometry: "geometry", _: "other",
    }
    CommandError => {
        Refused: "refused", InvalidArgument: "invalid_argument", Request: "request",
        NotFinite: "not_finite", Timeout: "timeout", LinkLost: "link_lost", Violation: "violation",
        ConnectionClosed: "connection_closed", _: "other",
    }
    GripperError, VacuumGripperError => {
        Failure: "failure", OutOfRange: "out_of_range", Request: "request", Violation: "violation",
        ConnectionClosed: "connection_closed", _: "other",
    }
    ReadError => {
        LinkLost: "link_lost", ConnectionClosed: "connection_closed", _: "other",
    }
    ActiveError => {
        Motion: "motion", Ended: "ended", Finished: "finished", Write: "write", Borrow: "borrow",
        _: "other",
    }
    IdentifyError => {
        Moved: "moved", Motion: "motion", Fit: "fit", _: "other",
    }
    TareRefused => {
        Moves: "moves", UnderWay: "under_way", Mode: "mode", Contact: "contact",
        NoEstimate: "no_estimate", Duration: "duration", _: "other",
    }
    MotionError => {
        Goal: "goal", Path: "path", Superseded: "superseded", Stopped: "stopped", Held: "held",
        Braked: "braked", Disengaged: "disengaged", Busy: "busy", Start: "start",
        Unsupported: "unsupported", Invalid: "invalid", GivenUp: "given_up", Panicked: "panicked",
        Stalled: "stalled", Hung: "hung", Rejected: "rejected", Control: "control",
        NotReady: "not_ready", TargetNotReached: "target_not_reached", NotAtRest: "not_at_rest",
        AfterReaction: "after_reaction", LinkLost: "link_lost",
        ConnectionClosed: "connection_closed", Violation: "violation", Protocol: "protocol",
        _: "other",
    }
    MoveStatus => {
        Success: "success", MotionStarted: "motion_started", Preempted: "preempted",
        PreemptedDueToActivatedSafetyFunctions: "preempted_due_to_activated_safety_functions",
        CommandRejectedDueToActivatedSafetyFunctions:
            "command_rejected_due_to_activated_safety_functions",
        CommandNotPossibleRejected: "command_not_possible_rejected",
        StartAtSingularPoseRejected: "start_at_singular_pose_rejected",
        InvalidArgumentRejected: "invalid_argument_rejected", ReflexAborted: "reflex_aborted",
        EmergencyAborted: "emergency_aborted", InputErrorAborted: "input_error_aborted",
        Aborted: "aborted",
    }
    RecordError => {
        Exists: "exists", Create: "create", Write: "write", BlackBox: "black_box",
        Unfinished: "unfinished", Option: "option", SameName: "same_name", Ended: "ended",
        Thread: "thread", Encode: "encode", _: "other",
    }
    RecordingError => {
        File: "file", NotMcap: "not_mcap", Read: "read", Chunk: "chunk", Compression: "compression",
        Message: "message", NoRobot: "no_robot", Foreign: "foreign", _: "other",
    }
    ExportError => {
        Exists: "exists", Io: "io", Write: "write", Cycles: "cycles", Table: "table",
        Episode: "episode", Dataset: "dataset", Option: "option", _: "other",
    }
    TrackError => {
        Cycles: "cycles", Record: "record", Unknown: "unknown", Attached: "attached", _: "other",
    }
    AttachError => {
        TooMany: "too_many", Capacity: "capacity", Busy: "busy", Ended: "ended", _: "other",
    }
    ReplayError => {
        Kind: "kind", Speed: "speed", Short: "short", Gap: "gap", NotFinite: "not_finite",
        Uncontrolled: "uncontrolled", Fast: "fast", Target: "target", Chunk: "chunk", _: "other",
    }
    ReplayFailure => {
        Refused: "refused", Motion: "motion", Off: "off", _: "other",
    }
    Party => {
        Caller: "caller", Robot: "robot", Link: "link", Host: "host", Peer: "peer", _: "other",
    }
}

// Names in states, events and recordings.
names! {
    RobotMode => {
        Other: "other", Idle: "idle", Move: "move", Guiding: "guiding", Reflex: "reflex",
        UserStopped: "user_stopped", AutomaticErrorRecovery: "automatic_error_recovery",
    }
    MotionGeneratorMode => {
        Idle: "idle", JointPosition: "joint_position", JointVelocity: "joint_velocity",
        CartesianPosition: "cartesian_position", CartesianVelocity: "cartesian_velocity",
        None: "none", Unknown: "unknown",
    }
    ControllerMode => {
        JointImpedance: "joint_impedance", CartesianImpedance: "cartesian_impedance",
        ExternalController: "external_controller", Other: "other", Unknown: "unknown",
    }
    RobotKind => {
        Fr3: "fr3", Fer: "fer", _: "other",
    }
    Guard => {
        Leash: "leash", InverseKinematics: "inverse_kinematics", TorqueClamp: "torque_clamp",
        ForceCap: "force_cap", VelocityBarrier: "velocity_barrier", TorqueRate: "torque_rate",
        Watchdog: "watchdog", Deadman: "deadman", Backstop: "backstop",
        JointVelocity: "joint_velocity", PositionEnvelope: "position_envelope",
        Clearance: "clearance", Deviation: "deviation", Lead: "lead", PlanFailure: "plan_failure",
        Reaction: "reaction", Team: "team", SpeedCap: "speed_cap",
        Unresponsive: "unresponsive", _: "other",
    }
    Phase => {
        Arrival: "arrival", Answer: "answer", Orders: "orders", Decode: "decode",
        Program: "program", Send: "send", Publish: "publish", Prepare: "prepare", _: "other",
    }
    CloseReason => {
        ClosedByUs: "closed_by_us", ClosedByPeer: "closed_by_peer", Io: "io", Protocol: "protocol",
        ThreadEnded: "thread_ended", Silent: "silent", GivenUp: "given_up",
        AnotherRobot: "another_robot", RuntimeEnded: "runtime_ended", _: "other",
    }
    Condition => {
        Ready: "ready", Unready: "unready", Closed: "closed", _: "other",
    }
    Unready => {
        Disconnected: "disconnected", Silent: "silent", Recovering: "recovering",
        AgreementAwaited: "agreement_awaited", Unrecognised: "unrecognised", Reflex: "reflex",
        UserStopped: "user_stopped", Guided: "guided", Braked: "braked",
        StopLatched: "stop_latched", Configuring: "configuring",
        NotConfigured: "not_configured", _: "other",
    }
    EventKind => {
        Connected: "connected", RealtimeRefused: "realtime_refused", Unrecognised: "unrecognised",
        NotConfigured: "not_configured",
        Lost: "lost", Silent: "silent", Resumed: "resumed", Reflex: "reflex",
        NotRecovered: "not_recovered", Recovered: "recovered", UserStop: "user_stop",
        Guiding: "guiding", Brakes: "brakes", StopLatch: "stop_latch",
        MotionBegun: "motion_begun", MotionEnded: "motion_ended", LoadChanged: "load_changed",
        Closed: "closed", _: "other",
    }
    NotRecovered => {
        Never: "never", OtherError: "other_error", TooOften: "too_often", Declined: "declined",
        ByHand: "by_hand", _: "other",
    }
    TeamStop => {
        Requested: "requested", Member: "member", _: "other",
    }
    MemberFault => {
        RobotStopped: "robot_stopped", Silent: "silent", Failed: "failed", Gone: "gone",
        GivenUp: "given_up", NotReached: "not_reached", TakenBack: "taken_back", Refused: "refused",
        TimedOut: "timed_out", _: "other",
    }
    TargetStatus => {
        Idle: "idle", Executing: "executing", TargetReached: "target_reached", Aborted: "aborted",
        _: "other",
    }
    DeviceStatus => {
        Green: "green", Yellow: "yellow", Orange: "orange", Red: "red", Unknown: "unknown",
    }
    event::EventKind => {
        Goal: "goal", Outcome: "outcome", LinkLost: "link_lost", LinkRestored: "link_restored",
        Mode: "mode", Errors: "errors", Request: "request", Diagnosis: "diagnosis",
        EpisodeStart: "episode_start", EpisodeEnd: "episode_end", Note: "note", Dropped: "dropped",
        ClockStep: "clock_step", _: "other",
    }
    event::Ending => {
        Arrived: "arrived", Superseded: "superseded", Stopped: "stopped", Reflex: "reflex",
        LinkLost: "link_lost", Guard: "guard", Rejected: "rejected", Failed: "failed", _: "other",
    }
    event::Level => {
        Debug: "debug", Info: "info", Warning: "warning", Error: "error",
    }
    MomentKind => {
        Goal: "goal", Mode: "mode", Contact: "contact", Collision: "collision", Error: "error",
        Guard: "guard", Loss: "loss", Note: "note", _: "other",
    }
}

/// Returns all names, for the tests, which compare them with the types of Python and with the book:
/// `errors` by class, `variants` by enum in the book, `values` by type in Python.
#[pyfunction]
pub(crate) fn _names(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    type Table<'a> = &'a [(&'a str, &'a [&'a [&'a str]])];
    let errors: Table<'_> = &[
        ("ActionError", &[GripperError::NAMES, &["aborted"]]),
        ("ActiveError", &[ActiveError::NAMES]),
        ("CommandError", &[CommandError::NAMES]),
        ("ConnectError", &[<ConnectError>::NAMES]),
        ("ControlError", &[MoveStatus::NAMES]),
        ("ExportError", &[ExportError::NAMES]),
        ("IdentifyError", &[IdentifyError::NAMES]),
        ("MotionError", &[MotionError::NAMES]),
        ("ReadError", &[ReadError::NAMES]),
        (
            "RecordError",
            &[RecordError::NAMES, TrackError::NAMES, AttachError::NAMES],
        ),
        ("RecordingError", &[RecordingError::NAMES]),
        ("ReplayError", &[ReplayError::NAMES, ReplayFailure::NAMES]),
        ("TareError", &[TareRefused::NAMES]),
    ];
    let variants: Table<'_> = &[
        ("ActionError", &[GripperError::NAMES]),
        ("ActiveError", &[ActiveError::NAMES]),
        ("CloseReason", &[CloseReason::NAMES]),
        ("CommandError", &[CommandError::NAMES]),
        ("ConnectError", &[<ConnectError>::NAMES]),
        ("ExportError", &[ExportError::NAMES]),
        ("IdentifyError", &[IdentifyError::NAMES]),
        ("MemberFault", &[MemberFault::NAMES]),
        ("MotionError", &[MotionError::NAMES]),
        ("ReadError", &[ReadError::NAMES]),
        ("RecordError", &[RecordError::NAMES]),
        ("RecordingError", &[RecordingError::NAMES]),
        ("ReplayError", &[ReplayError::NAMES]),
        ("ReplayFailure", &[ReplayFailure::NAMES]),
        ("TareRefused", &[TareRefused::NAMES]),
        ("TrackError", &[TrackError::NAMES]),
        ("Unready", &[Unready::NAMES]),
    ];
    let values: Table<'_> = &[
        ("Condition", &[Condition::NAMES, Unready::NAMES]),
        ("EventKind", &[EventKind::NAMES]),
        ("Guard", &[Guard::NAMES]),
    ];
    let all = PyDict::new(py);
    for (name, table) in [
        ("errors", errors),
        ("variants", variants),
        ("values", values),
    ] {
        let lists = PyDict::new(py);
        for (of, names) in table {
            lists.set_item(of, names.concat())?;
        }
        all.set_item(name, lists)?;
    }
    Ok(all)
}
