//! The two fingers of a Franka Hand.

use bytes::Bytes;
use franka_proto::gripper::{Grasp, Move, Request, State, Status, Version};

use super::Mechanism;
use super::finger_motion::{FingerMotion, Progress};
use crate::plant::FingerDrive;

/// Two fingers that move at the commanded speed and stop at an object. They have built-in
/// kinematics and an object of a given width, unless they belong to a plant (physics) with its own
/// fingers and objects: see [`Robot::couple`](crate::Robot::couple).
///
/// libfranka documents the known behaviour of real hands. All other behaviour is a choice of the
/// simulator, not measured, and marked as a choice.
///
/// * Before the first homing, `max_width` is 0, and the hand refuses every larger width.
/// * If an object blocks a move, the hand continues to push, and the move fails after
///   [`Fingers::BLOCKED_MS`].
/// * A grasp closes the fingers until something stops them. The fingers then squeeze, even if their
///   width differs from the requested width. If an object is already held, a grasp is unsuccessful.
/// * If the object is lost, the fingers continue to close.
#[derive(Debug, Clone)]
pub struct Fingers {
    finger_motion: FingerMotion,
    max_width: f64,
    is_grasped: bool,
    temperature: u16,
    activity: Activity,
}

#[derive(Debug, Clone, Copy)]
enum Activity {
    /// The fingers rest, and exert no force.
    Idle,
    /// First part of a homing: the fingers close until something stops them.
    HomingClosed,
    /// Second part of a homing: the fingers open.
    HomingOpen,
    /// A move. `blocked` counts the milliseconds for which an object has blocked the fingers.
    Moving { motion: Move, blocked: u32 },
    /// A grasp: the fingers close until something stops them.
    Grasping(Grasp),
    /// After a grasp: the fingers push with this speed and force. `held` is their width at the end
    /// of the grasp.
    Squeezing { speed: f64, force: f64, held: f64 },
}

impl Fingers {
    /// Largest width, [`FingerDrive::STROKE`].
    pub const STROKE: f64 = FingerDrive::STROKE;

    /// Highest speed, [`FingerDrive::MAX_SPEED`]. The hand executes faster requests at this speed
    /// (a choice of the simulator).
    pub const MAX_SPEED: f64 = FingerDrive::MAX_SPEED;

    /// Speed of the width during a homing `[m/s]`, a choice of the simulator.
    pub const HOMING_SPEED: f64 = 0.05;

    /// Range of the force, [`FingerDrive::FORCE`].
    pub const FORCE: [f64; 2] = FingerDrive::FORCE;

    /// Time after which a blocked move fails `[ms]`. Users report 100 s to 120 s.
    pub const BLOCKED_MS: u32 = 110_000;

    /// Open fingers with nothing between them, before their first homing.
    pub fn new() -> Self {
        Self {
            finger_motion: FingerMotion::new(Self::STROKE),
            max_width: 0.0,
            is_grasped: false,
            temperature: 25,
            activity: Activity::Idle,
        }
    }

    /// Puts an object of this width `[m]` between the fingers.
    ///
    /// # Panics
    /// Panics if the object does not fit: see [`place_object`](Self::place_object).
    #[must_use]
    pub fn with_object(mut self, width: f64) -> Self {
        assert!(
            self.place_object(width),
            "got an object of {width} m, which does not fit between the fingers"
        );
        self
    }

    /// Sets the temperature `[deg C]`; the default is 25.
    #[must_use]
    pub fn with_temperature(mut self, temperature: u16) -> Self {
        self.temperature = temperature;
        self
    }

    /// Puts an object of this width `[m]` between the fingers, which replaces the current object.
    /// Returns false and changes nothing if the width is not positive or exceeds the opening, or if
    /// the fingers belong to a plant.
    pub fn place_object(&mut self, width: f64) -> bool {
        let fits = width > 0.0 && width <= self.finger_motion.width();
        match self.finger_motion.object() {
            Some(object) if fits => {
                *object = Some(width);
                true
            }
            _ => false,
        }
    }

    /// Removes the object and returns its width `[m]`; `None` if there is no object, or if the
    /// object belongs to a plant. If the object was grasped, the grasp is lost.
    pub fn take_object(&mut self) -> Option<f64> {
        self.finger_motion.object()?.take()
    }

    pub(crate) fn drive(&self) -> FingerDrive {
        self.finger_motion.drive()
    }

    /// Sets the width between the fingers of a plant, `[m]`. After the first call, the hand uses
    /// the plant's fingers.
    pub(crate) fn feel(&mut self, width: f64) {
        self.finger_motion.feel(width);
    }

    /// Force of the fingers on the object between them `[N]`.
    pub fn force(&self) -> f64 {
        match self.activity {
            Activity::Squeezing { force, .. } if self.finger_motion.is_held() => {
                force.clamp(Self::FORCE[0], Self::FORCE[1])
            }
            _ => 0.0,
        }
    }

    /// Moves the fingers for one millisecond towards `target`, with the force of a motion.
    fn approach(&mut self, target: f64, speed: f64) -> Progress {
        self.squeeze(target, speed, Self::FORCE[0])
    }

    fn squeeze(&mut self, target: f64, speed: f64, force: f64) -> Progress {
        let force = force.clamp(Self::FORCE[0], Self::FORCE[1]);
        self.finger_motion
            .approach(target, speed.min(Self::MAX_SPEED), force)
    }

    fn rest(&mut self) {
        self.activity = Activity::Idle;
        self.finger_motion.rest();
    }

    fn accepts(&self, width: f64, speed: f64) -> bool {
        (0.0..=self.max_width).contains(&width) && speed.is_finite() && speed > 0.0
    }

    fn is_in_tolerance(&self, grasp: &Grasp) -> bool {
        let least = grasp.width - grasp.epsilon_inner;
        let largest = grasp.width + grasp.epsilon_outer;
        let width = self.finger_motion.width();
        least < width && width < largest
    }

    fn begin_grasp(&mut self, grasp: Grasp) -> Option<Status> {
        let tolerances = [grasp.epsilon_inner, grasp.epsilon_outer];
        let makes_sense = grasp.force.is_finite()
            && grasp.force > 0.0
            && tolerances.iter().all(|tolerance| *tolerance >= 0.0);
        if !makes_sense || !self.accepts(grasp.width, grasp.speed) {
            return Some(Status::Fail);
        }
        if self.is_grasped {
            return Some(Status::Unsuccessful);
        }
        self.activity = Activity::Grasping(grasp);
        None
    }
}

impl Default for Fingers {
    fn default() -> Self {
        Self::new()
    }
}

impl Mechanism for Fingers {
    type Protocol = Version;
    type State = State;

    fn is_stop(request: &Request) -> bool {
        matches!(request, Request::Stop)
    }

    fn begin(&mut self, request: &Request) -> Option<Status> {
        match *request {
            Request::Grasp(grasp) if self.is_grasped => self.begin_grasp(grasp),
            Request::Grasp(grasp) => {
                self.halt();
                self.begin_grasp(grasp)
            }
            Request::Homing => {
                self.halt();
                self.activity = Activity::HomingClosed;
                None
            }
            Request::Move(motion) => {
                self.halt();
                if !self.accepts(motion.width, motion.speed) {
                    return Some(Status::Fail);
                }
                let blocked = 0;
                self.activity = Activity::Moving { motion, blocked };
                None
            }
            _ => Some(Status::Fail),
        }
    }

    fn halt(&mut self) {
        self.rest();
        self.is_grasped = false;
    }

    fn tick(&mut self) -> Option<Status> {
        match self.activity {
            Activity::Idle => None,
            Activity::HomingClosed => {
                if self.approach(0.0, Self::HOMING_SPEED) != Progress::Moving {
                    self.activity = Activity::HomingOpen;
                }
                None
            }
            Activity::HomingOpen => {
                let progress = self.approach(Self::STROKE, Self::HOMING_SPEED);
                (progress == Progress::Arrived).then(|| {
                    self.max_width = Self::STROKE;
                    self.rest();
                    Status::Success
                })
            }
            Activity::Moving { motion, blocked } => {
                let status = match self.approach(motion.width, motion.speed) {
                    Progress::Arrived => Status::Success,
                    Progress::Blocked if blocked >= Self::BLOCKED_MS => Status::Fail,
                    progress => {
                        let blocked = match progress {
                            Progress::Blocked => blocked + 1,
                            _ => 0,
                        };
                        self.activity = Activity::Moving { motion, blocked };
                        return None;
                    }
                };
                self.rest();
                Some(status)
            }
            Activity::Grasping(grasp) => {
                let Grasp { speed, force, .. } = grasp;
                let progress = self.squeeze(0.0, speed, force);
                (progress != Progress::Moving).then(|| {
                    self.is_grasped = self.is_in_tolerance(&grasp);
                    let held = self.finger_motion.width();
                    self.activity = Activity::Squeezing { speed, force, held };
                    match self.is_grasped {
                        true => Status::Success,
                        false => Status::Unsuccessful,
                    }
                })
            }
            Activity::Squeezing { speed, force, held } => {
                if self.finger_motion.has_lost(held) {
                    self.is_grasped = false;
                }
                self.squeeze(0.0, speed, force);
                None
            }
        }
    }

    fn state(&self, message_id: u32) -> State {
        State {
            message_id,
            width: self.finger_motion.width(),
            max_width: self.max_width,
            is_grasped: self.is_grasped,
            temperature: self.temperature,
        }
    }

    fn encode(state: &State) -> Bytes {
        Bytes::copy_from_slice(&state.encode())
    }
}
