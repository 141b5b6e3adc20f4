//! The motion of the fingers, computed by built-in kinematics or by a plant that has fingers.

use franka_model::CYCLE;

use super::towards;
use crate::plant::FingerDrive;

/// Width between the fingers, and the part that moves the fingers.
#[derive(Debug, Clone)]
pub(super) struct FingerMotion {
    width: f64,
    means: Means,
}

#[derive(Debug, Clone)]
enum Means {
    /// The fingers move at the commanded speed, up to an object of this width.
    Kinematic { object: Option<f64> },
    /// A plant moves the fingers and the objects between them.
    Driven { drive: FingerDrive, stall: Stall },
}

/// The result of one millisecond of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Progress {
    /// The fingers move, or may be blocked.
    Moving,
    /// An object stops the fingers.
    Blocked,
    Arrived,
}

impl FingerMotion {
    /// Fingers with this distance between them, and no object.
    pub(super) fn new(width: f64) -> Self {
        Self {
            width,
            means: Means::Kinematic { object: None },
        }
    }

    pub(super) fn width(&self) -> f64 {
        self.width
    }

    /// The object between the fingers; `None` if a plant simulates objects.
    pub(super) fn object(&mut self) -> Option<&mut Option<f64>> {
        match &mut self.means {
            Means::Kinematic { object } => Some(object),
            Means::Driven { .. } => None,
        }
    }

    /// Command for the plant's fingers. The fingers do not move until their width has been read
    /// once.
    pub(super) fn drive(&self) -> FingerDrive {
        match &self.means {
            Means::Driven { drive, .. } => *drive,
            Means::Kinematic { .. } => resting(self.width),
        }
    }

    /// Sets the width between the plant's fingers. After the first call, the plant moves the
    /// fingers.
    pub(super) fn feel(&mut self, width: f64) {
        self.width = width;
        if matches!(self.means, Means::Kinematic { .. }) {
            self.means = Means::Driven {
                drive: resting(width),
                stall: Stall::from(width),
            };
        }
    }

    /// Moves the fingers for one millisecond towards `target` `[m]`, at `speed` `[m/s]` and with up
    /// to `force` `[N]`.
    pub(super) fn approach(&mut self, target: f64, speed: f64, force: f64) -> Progress {
        match &mut self.means {
            Means::Kinematic { object } => {
                let reachable = target.max(object.unwrap_or(0.0));
                self.width = towards(self.width, reachable, speed * CYCLE);
                match self.width {
                    width if width == target => Progress::Arrived,
                    width if width == reachable => Progress::Blocked,
                    _ => Progress::Moving,
                }
            }
            Means::Driven { drive, stall } => {
                let wanted = FingerDrive {
                    width: target,
                    speed,
                    force,
                };
                if *drive != wanted {
                    *drive = wanted;
                    *stall = Stall::from(self.width);
                }
                if (self.width - target).abs() < NEAR {
                    return Progress::Arrived;
                }
                match stall.watch(self.width, speed) {
                    true => Progress::Blocked,
                    false => Progress::Moving,
                }
            }
        }
    }

    /// Releases the held object. The fingers keep their position.
    pub(super) fn rest(&mut self) {
        if let Means::Driven { drive, .. } = &mut self.means {
            // Fingers at their target must keep exactly the target width.
            let is_there = (self.width - drive.width).abs() < NEAR;
            *drive = resting(if is_there { drive.width } else { self.width });
        }
    }

    /// True if an object stops the fingers while they close.
    pub(super) fn is_held(&self) -> bool {
        match &self.means {
            Means::Kinematic { object } => self.width <= object.unwrap_or(0.0),
            Means::Driven { stall, .. } => stall.is_stalled,
        }
    }

    /// True if the object that held the fingers at `width` has gone.
    pub(super) fn has_lost(&self, width: f64) -> bool {
        match &self.means {
            Means::Kinematic { .. } => !self.is_held(),
            Means::Driven { .. } => self.width < width - SLIP,
        }
    }
}

fn resting(width: f64) -> FingerDrive {
    FingerDrive {
        width,
        speed: REST_SPEED,
        force: REST_FORCE,
    }
}

/// Detection of blocked fingers.
#[derive(Debug, Clone, Copy)]
struct Stall {
    /// Width at the start of the window, and number of milliseconds since then.
    mark: f64,
    age: u32,
    is_stalled: bool,
}

impl Stall {
    fn from(width: f64) -> Self {
        Self {
            mark: width,
            age: 0,
            is_stalled: false,
        }
    }

    /// Processes a millisecond at `speed`. Returns true if the fingers are blocked.
    fn watch(&mut self, width: f64, speed: f64) -> bool {
        self.age += 1;
        if self.age == STALL_WINDOW_MS {
            let way = speed * CYCLE * f64::from(STALL_WINDOW_MS);
            let is_stalled = (width - self.mark).abs() < STALLED * way;
            *self = Self {
                is_stalled,
                ..Self::from(width)
            };
        }
        self.is_stalled
    }
}

/// Tolerance `[m]` within which a plant's fingers have reached a width. This constant and the
/// constants below are choices of the simulator.
const NEAR: f64 = 5e-4;

/// If grasping fingers close by this distance `[m]`, the object is lost. The distance exceeds the
/// compliance of a contact.
const SLIP: f64 = 2e-3;

/// Time after which fingers count as blocked if they have covered too little of the distance. The
/// motor needs less time than this to build up the force of a grasp.
const STALL_WINDOW_MS: u32 = 200;
const STALLED: f64 = 0.05;

/// Command for idle fingers: a speed `[m/s]` and a force `[N]` that hold them in any pose of the
/// hand.
const REST_SPEED: f64 = 0.02;
const REST_FORCE: f64 = 2.0;
