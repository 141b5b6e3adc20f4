//! Sets parameters of the robot and recovers it: each request has one answer.
//!
//! The robot accepts parameters between motions and refuses them during a motion.

use std::fmt::Debug;
use std::sync::Arc;
use std::time::Duration;

use franka_model::transform;
use franka_proto::{
    CollisionBehavior, Command, Filters, Load, Refusal, Request, RobotState, SetterStatus, Status,
    VirtualWall,
};
use franka_rt::supervision::{Answer, SettingId};
use nalgebra::Matrix3;
use tokio::sync::Mutex;

use crate::command_channel::{Channel, Response};
use crate::error::CommandError;
use crate::newest_state::Newest;
use crate::robot::{Pose, Robot};
use crate::supervisor::Supervisor;
use crate::thresholds::Thresholds;
use crate::world::timeout;

/// Time limit for requests that the robot answers at once.
const ANSWER: Duration = Duration::from_secs(5);

/// Time limit for a recovery, which opens and closes brakes.
const RECOVERY: Duration = Duration::from_secs(30);

/// Time for which a robot may be silent during a recovery, in addition to the link timeout.
const SILENT: Duration = Duration::from_secs(3);

/// Payload of both arms, `[kg]`. Source: the vendor's data sheets.
const PAYLOAD: f64 = 3.0;

/// Time after the answer in which a state must show the new value, `[ms]`.
const SHOWN_MS: u64 = 200;

/// Time limit for this wait if no states come.
const SHOWN_WITHIN: Duration = Duration::from_secs(5);

impl Robot {
    /// Sets the torques and forces at which the robot reports contact (lower) and stops itself
    /// (upper). Use [`CollisionBehavior::careful`], [`compliant`](CollisionBehavior::compliant),
    /// [`insensitive`](CollisionBehavior::insensitive), or your own values. A goal whose force cap
    /// exceeds these forces begins with a warning (`tracing`). Below about 10 N, the friction of an
    /// untouched arm alone can trigger a reflex.
    ///
    /// The vendor documents no range. The simulator refuses negative and non-finite values.
    ///
    /// # Errors
    /// Returns [`CommandError`] if the robot refuses the request or does not answer.
    ///
    /// # Cancel safety
    /// If the future is dropped after it was polled, the robot may still carry out the request. The
    /// driver of a [supervised](crate::connection::Builder::supervise) robot then counts the value
    /// as set.
    pub async fn set_collision_behavior(
        &self,
        behavior: CollisionBehavior,
    ) -> Result<(), CommandError> {
        self.set(Request::SetCollisionBehavior(behavior)).await
    }

    /// Sets the stiffness of the robot's own joint impedance controller, `[N m/rad]`. Each value is
    /// in [0, 14250].
    ///
    /// # Errors
    /// See [`Self::set_collision_behavior`].
    ///
    /// # Cancel safety
    /// See [`Self::set_collision_behavior`].
    pub async fn set_joint_impedance(&self, stiffness: [f64; 7]) -> Result<(), CommandError> {
        self.set(Request::SetJointImpedance(stiffness)).await
    }

    /// Sets the stiffness of the robot's own Cartesian impedance controller in the stiffness frame:
    /// x, y and z in [10, 3000] N/m; roll, pitch and yaw in [1, 300] N m/rad.
    ///
    /// # Errors
    /// See [`Self::set_collision_behavior`].
    ///
    /// # Cancel safety
    /// See [`Self::set_collision_behavior`].
    pub async fn set_cartesian_impedance(&self, stiffness: [f64; 6]) -> Result<(), CommandError> {
        self.set(Request::SetCartesianImpedance(stiffness)).await
    }

    /// Sets the directions in which a person can guide the arm by hand: x, y, z, roll, pitch, yaw,
    /// and the elbow.
    ///
    /// # Errors
    /// See [`Self::set_collision_behavior`].
    ///
    /// # Cancel safety
    /// See [`Self::set_collision_behavior`].
    pub async fn set_guiding_mode(&self, free: [bool; 6], elbow: bool) -> Result<(), CommandError> {
        self.set(Request::SetGuidingMode {
            guiding_mode: free,
            nullspace: elbow,
        })
        .await
    }

    /// Sets the stiffness frame in the end effector's frame, `EE_T_K`. Resolves when a state shows
    /// the new frame, because later results are computed from states.
    ///
    /// The vendor documents no range. The simulator refuses a frame more than 2 m away.
    ///
    /// # Errors
    /// Returns [`CommandError`], for example [`CommandError::LinkLost`] if the robot answers but
    /// sends no states.
    ///
    /// # Cancel safety
    /// See [`Self::set_collision_behavior`].
    pub async fn set_k(&self, ee_t_k: Pose) -> Result<(), CommandError> {
        let frame = transform::array(&ee_t_k);
        self.set(Request::SetEEToK(frame)).await
    }

    /// Sets the end effector in the nominal end effector's frame, `NE_T_EE`. For the range, and for
    /// the time when this resolves, see [`Self::set_k`].
    ///
    /// # Errors
    /// See [`Self::set_k`].
    ///
    /// # Cancel safety
    /// See [`Self::set_collision_behavior`].
    pub async fn set_ee(&self, ne_t_ee: Pose) -> Result<(), CommandError> {
        let frame = transform::array(&ne_t_ee);
        self.set(Request::SetNEToEE(frame)).await
    }

    /// Declares the load beyond the end effector: its mass `[kg]`, its centre of mass in the flange
    /// frame `[m]`, and its inertia about that centre `[kg m^2]`, column-major. Resolves when a
    /// state shows the load.
    ///
    /// A load that is impossible for a rigid body is refused before it is sent. Such a load has a
    /// negative mass, an asymmetric inertia, or a principal moment that is negative or above the
    /// sum of the others. The vendor documents no range. The simulator also refuses a mass above 10
    /// kg and a centre more than 1 m away. It refuses a principal moment above 1 kg m^2. Its
    /// configuration can change these bounds.
    ///
    /// # Errors
    /// See [`Self::set_k`].
    ///
    /// # Cancel safety
    /// See [`Self::set_collision_behavior`].
    pub async fn set_load(&self, load: Load) -> Result<(), CommandError> {
        let request = Request::SetLoad(load);
        check_finite(&request)?;
        if let Some(why) = impossible(&load) {
            let status = Status::Setter(SetterStatus::InvalidArgumentRejected);
            let mode = self.state().robot_mode;
            let refusal = Refusal::new(Command::SetLoad, status, mode).expect("no success");
            return Err(CommandError::InvalidArgument { refusal, why });
        }
        self.set(request).await
    }

    /// Recovers from a reflex (`AutomaticErrorRecovery`) and resolves when the robot accepts
    /// motions again. If the robot has no error, this succeeds and does nothing. The recovery takes
    /// as long as the brakes do, at most 30 s.
    ///
    /// # Errors
    /// Returns [`CommandError`]. If a refusal names manual recovery, a person must recover the
    /// robot on site. Returns [`CommandError::LinkLost`] if the robot answers but sends no states.
    /// Also returns it if neither answers nor states come for three seconds more than the link
    /// timeout.
    ///
    /// # Cancel safety
    /// See [`Self::set_collision_behavior`].
    pub async fn recover(&self) -> Result<(), CommandError> {
        let link = self.link();
        tokio::select! {
            recovered = recover(&link.channel) => recovered?,
            silence = link.stays_silent(SILENT) => return Err(CommandError::LinkLost { silence }),
        }
        match link.silence() {
            Some(silence) => Err(CommandError::LinkLost { silence }),
            None => Ok(()),
        }
    }

    /// Returns the robot's description of itself, as URDF. Protocol 10 only.
    ///
    /// # Errors
    /// Returns [`CommandError`], for example [`CommandError::Request`] if the version has no such
    /// command.
    ///
    /// # Cancel safety
    /// Dropping the future loses only the answer.
    pub async fn urdf(&self) -> Result<String, CommandError> {
        urdf(&self.channel(), ANSWER).await
    }

    /// Sets the cutoff frequencies of the robot's own low-pass filters, each in [1, 1000] Hz. The
    /// value 1000 Hz switches a filter off. Protocol 5 only (Franka Emika Robot), and deprecated by
    /// the vendor: filter in this program instead.
    ///
    /// # Errors
    /// Returns [`CommandError`], for example [`CommandError::Request`] if the version has no such
    /// command.
    ///
    /// # Cancel safety
    /// See [`Self::set_collision_behavior`].
    pub async fn set_filters(&self, filters: Filters) -> Result<(), CommandError> {
        self.set(Request::SetFilters(filters)).await
    }

    /// Reads the virtual wall `id` as it is set up in Desk (libfranka's `getVirtualWall`).
    /// Protocol 5 only (Franka Emika Robot).
    ///
    /// # Errors
    /// Returns [`CommandError`], for example [`CommandError::Request`] if the version has no such
    /// command.
    ///
    /// # Cancel safety
    /// Dropping the future loses only the answer.
    pub async fn virtual_wall(&self, id: i32) -> Result<VirtualWall, CommandError> {
        let request = Request::GetCartesianLimit { id };
        match self.channel().call(request, ANSWER).await? {
            Response::Wall(wall) => Ok(wall),
            _ => unreachable!("the session matches replies to the commands they answer"),
        }
    }

    /// Sets a value at the robot and waits for a state that shows it, if states contain this value.
    /// The answer may come before such a state; a motion that begins in between would compute with
    /// the old tool.
    async fn set(&self, request: Request) -> Result<(), CommandError> {
        check_finite(&request)?;
        let turn = self.setting().lock().await;
        let supervisor = self.supervisor();
        let (link, id) = supervisor.declare(request, || self.link());
        let mut declared = Declared {
            supervisor,
            id,
            answer: Answer::Unknown {
                text: String::from("the program did not await the answer"),
            },
        };
        let answer = link.channel.call_in_turn(request, ANSWER, turn);
        if let Err(error) = answer.await {
            let error = explained(error, &request);
            declared.answer = answer_of(&error);
            return Err(error);
        }
        note(&link.thresholds, &request);
        // If the connection has closed, the next call reports it.
        tokio::select! {
            biased;
            answer = shown(&link.newest, &request) => declared.answer = answer,
            _ = link.ended() => {}
            silence = link.stays_silent(Duration::ZERO) => {
                return Err(CommandError::LinkLost { silence });
            }
        }
        Ok(())
    }
}

/// A setting that was sent to the robot. Dropping it reports the answer to the supervisor, even if
/// the future of the call was dropped.
struct Declared<'a> {
    supervisor: &'a Supervisor,
    id: SettingId,
    answer: Answer,
}

impl Drop for Declared<'_> {
    fn drop(&mut self) {
        self.supervisor.on_set(self.id, &self.answer);
    }
}

/// Resources for sending settings again over one connection. They do not keep the robot open:
/// dropping its last handle closes the connection, even during a request.
pub(crate) struct Again {
    supervisor: Arc<Supervisor>,
    setting: Arc<Mutex<()>>,
    channel: Channel,
    newest: Newest,
    thresholds: Thresholds,
}

impl Again {
    pub(crate) fn at(robot: &Robot) -> Self {
        let link = robot.link();
        Self {
            supervisor: robot.supervisor().clone(),
            setting: robot.setting().clone(),
            channel: link.channel.clone(),
            newest: link.newest.clone(),
            thresholds: link.thresholds.clone(),
        }
    }

    /// Sends all settings of this program again that the robot does not have.
    pub(crate) async fn run(self) {
        loop {
            let turn = self.setting.lock().await;
            let Some((id, request)) = self.supervisor.next_setting() else {
                return;
            };
            let answer = self.channel.call_in_turn(request, ANSWER, turn).await;
            let answer = match answer {
                Ok(_) => {
                    note(&self.thresholds, &request);
                    shown(&self.newest, &request).await
                }
                // The supervisor is notified of the end of the connection.
                Err(CommandError::ConnectionClosed { .. }) => return,
                Err(error) => answer_of(&explained(error, &request)),
            };
            if answer != Answer::Taken {
                tracing::warn!(command = %request.command(), ?answer, "setting not restored after \
                    a reconnect");
            }
            self.supervisor.on_set_again(id, answer);
        }
    }
}

/// Converts an error into the answer to a setting.
fn answer_of(error: &CommandError) -> Answer {
    let text = error.to_string();
    match error {
        CommandError::Refused(_)
        | CommandError::InvalidArgument { .. }
        | CommandError::Request(_)
        | CommandError::NotFinite { .. } => Answer::Refused { text },
        CommandError::Timeout { .. }
        | CommandError::LinkLost { .. }
        | CommandError::Violation(_)
        | CommandError::ConnectionClosed { .. } => Answer::Unknown { text },
    }
}

fn note(thresholds: &Thresholds, request: &Request) {
    if let Request::SetCollisionBehavior(behavior) = request {
        thresholds.note(*behavior);
    }
}

/// Waits for a state that shows the new value; stops when [`SHOWN_MS`] have passed without one.
async fn shown(newest: &Newest, request: &Request) -> Answer {
    if difference(request, &newest.state()).is_none() {
        return Answer::Taken;
    }
    let mut states = newest.changes();
    let answered = states.borrow().message_id;
    let is_last = |state: &RobotState| {
        difference(request, state).is_none() || state.message_id > answered + SHOWN_MS
    };
    // A robot that rounds the numbers never shows exactly the set ones.
    let last = match timeout(SHOWN_WITHIN, states.wait_for(is_last)).await {
        Ok(Ok(state)) => *state,
        _ => newest.state(),
    };
    match difference(request, &last) {
        None => Answer::Taken,
        Some(text) => Answer::NotShown { text },
    }
}

/// Refuses numbers that are not finite. The robot itself judges all other numbers.
fn check_finite(request: &Request) -> Result<(), CommandError> {
    for &(what, values) in &parts(request) {
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            let number = index + 1;
            return Err(CommandError::NotFinite { what, number });
        }
    }
    Ok(())
}

/// Returns the numbers of a request, by argument.
fn parts(request: &Request) -> Vec<(&'static str, &[f64])> {
    match request {
        Request::SetCollisionBehavior(CollisionBehavior {
            lower_torque_thresholds_acceleration: a,
            upper_torque_thresholds_acceleration: b,
            lower_torque_thresholds_nominal: c,
            upper_torque_thresholds_nominal: d,
            lower_force_thresholds_acceleration: e,
            upper_force_thresholds_acceleration: f,
            lower_force_thresholds_nominal: g,
            upper_force_thresholds_nominal: h,
        }) => vec![
            ("lower_torque_thresholds_acceleration", a),
            ("upper_torque_thresholds_acceleration", b),
            ("lower_torque_thresholds_nominal", c),
            ("upper_torque_thresholds_nominal", d),
            ("lower_force_thresholds_acceleration", e),
            ("upper_force_thresholds_acceleration", f),
            ("lower_force_thresholds_nominal", g),
            ("upper_force_thresholds_nominal", h),
        ],
        Request::SetJointImpedance(stiffness) => vec![("joint stiffness", stiffness)],
        Request::SetCartesianImpedance(stiffness) => vec![("Cartesian stiffness", stiffness)],
        Request::SetEEToK(frame) => vec![("stiffness frame", frame)],
        Request::SetNEToEE(frame) => vec![("end effector", frame)],
        Request::SetLoad(Load {
            m_load,
            F_x_Cload,
            I_load,
        }) => vec![
            ("m_load", core::slice::from_ref(m_load)),
            ("F_x_Cload", F_x_Cload),
            ("I_load", I_load),
        ],
        _ => Vec::new(),
    }
}

/// Returns the reason why no rigid body can have this load, whose numbers are finite; `None` if one
/// can.
fn impossible(load: &Load) -> Option<String> {
    if load.m_load < 0.0 {
        return Some(format!("m_load is {} kg, expected 0 or more", load.m_load));
    }
    let inertia = Matrix3::from_column_slice(&load.I_load);
    // States have single precision, and programs set what they have read.
    let rounding = 1e-9 + 1e-6 * inertia.amax();
    if (inertia - inertia.transpose()).amax() > rounding {
        return Some(format!(
            "I_load is {:?} kg m^2, expected a symmetric matrix",
            load.I_load
        ));
    }
    let mut moments: [f64; 3] = inertia.symmetric_eigenvalues().into();
    moments.sort_by(f64::total_cmp);
    let [least, middle, greatest] = moments;
    (least < -rounding || greatest > least + middle + rounding).then(|| {
        format!(
            "I_load has the principal moments {}, {} and {} kg m^2, expected no moment below 0 \
             and no moment above the sum of the other two",
            short(least),
            short(middle),
            short(greatest)
        )
    })
}

/// Rounds to six digits after the point, without zeros at the end.
fn short(number: f64) -> f64 {
    (number * 1e6).round() / 1e6
}

/// Adds the sent values and the documented range to an answer that names no number.
fn explained(error: CommandError, request: &Request) -> CommandError {
    let invalid = Status::Setter(SetterStatus::InvalidArgumentRejected);
    let refusal = match error {
        CommandError::Refused(refusal) if refusal.status() == invalid => refusal,
        other => return other,
    };
    let why = match request {
        Request::SetCollisionBehavior(_) => {
            let below = parts(request).into_iter().find_map(|(what, values)| {
                let number = values.iter().position(|value| *value < 0.0)?;
                Some((what, number, values[number]))
            });
            match below {
                Some((what, number, got)) => {
                    let number = number + 1;
                    format!("number {number} of {what} is {got}, expected 0 or more")
                }
                None => "all thresholds are 0 or more, as expected; the vendor documents no upper \
                    limits"
                    .to_owned(),
            }
        }
        Request::SetJointImpedance(got) => {
            format!("got {got:?} N m/rad, expected 0 to 14250 N m/rad for each joint")
        }
        Request::SetCartesianImpedance(got) => format!(
            "got {got:?}, expected 10 to 3000 N/m for x, y, z and 1 to 300 N m/rad for roll, \
             pitch, yaw"
        ),
        Request::SetEEToK(got) | Request::SetNEToEE(got) => {
            let [x, y, z] = [got[12], got[13], got[14]];
            format!("got a frame at [{x}, {y}, {z}] m; the vendor documents no range")
        }
        Request::SetLoad(got) => {
            let [x, y, z] = got.F_x_Cload;
            let trace = got.I_load[0] + got.I_load[4] + got.I_load[8];
            format!(
                "m_load is {} kg, expected {PAYLOAD} kg at most; F_x_Cload is [{x}, {y}, {z}] m \
                 from the flange; the trace of I_load is {} kg m^2; the vendor documents no ranges",
                got.m_load,
                short(trace)
            )
        }
        Request::SetFilters(got) => {
            let got = [
                got.joint_position_filter_frequency,
                got.joint_velocity_filter_frequency,
                got.cartesian_position_filter_frequency,
                got.cartesian_velocity_filter_frequency,
                got.controller_filter_frequency,
            ];
            format!("got {got:?} Hz, expected 1 to 1000 Hz for each filter")
        }
        _ => return CommandError::Refused(refusal),
    };
    CommandError::InvalidArgument { refusal, why }
}

/// Returns the difference between the value that was set and the value in a state, as a text.
/// Returns `None` if they are equal, or if states do not contain the value.
fn difference(request: &Request, state: &RobotState) -> Option<String> {
    let text = |got: &dyn Debug, set: &dyn Debug| {
        format!("the robot accepted the setting, but its states show {got:?}, expected {set:?}")
    };
    match request {
        Request::SetEEToK(frame) if !is_near(&state.EE_T_K, frame) => {
            Some(text(&state.EE_T_K, frame))
        }
        Request::SetNEToEE(frame) if !is_near(&state.NE_T_EE, frame) => {
            Some(text(&state.NE_T_EE, frame))
        }
        Request::SetLoad(load) => {
            let shown = Load {
                m_load: state.m_load,
                F_x_Cload: state.F_x_Cload,
                I_load: state.I_load,
            };
            let is_shown = is_near(&[shown.m_load], &[load.m_load])
                && is_near(&shown.F_x_Cload, &load.F_x_Cload)
                && is_near(&shown.I_load, &load.I_load);
            (!is_shown).then(|| text(&shown, load))
        }
        _ => None,
    }
}

/// True if a state, which may be of single precision, shows these numbers.
fn is_near<const N: usize>(shown: &[f64; N], set: &[f64; N]) -> bool {
    shown
        .iter()
        .zip(set)
        .all(|(shown, set)| (shown - set).abs() < 1e-5)
}

pub(crate) async fn recover(channel: &Channel) -> Result<(), CommandError> {
    let recovery = channel.call(Request::AutomaticErrorRecovery, RECOVERY);
    recovery.await.map(|_| ())
}

/// Returns the robot's description of itself; waits for `deadline` at most.
pub(crate) async fn urdf(channel: &Channel, deadline: Duration) -> Result<String, CommandError> {
    match channel.call(Request::GetRobotModel, deadline).await? {
        Response::Model(text) => Ok(String::from_utf8_lossy(&text).into_owned()),
        _ => unreachable!("the session matches replies to the commands they answer"),
    }
}
