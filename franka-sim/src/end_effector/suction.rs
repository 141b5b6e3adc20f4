//! The pump, the valve and the cup of a vacuum gripper.

use bytes::Bytes;
use franka_model::CYCLE;
use franka_proto::vacuum::{DeviceStatus, Request, State, Status, Vacuum, Version};

use super::{Mechanism, towards};

/// A pump that builds up a vacuum on an object, and a valve that ends the vacuum.
///
/// All figures are choices of the simulator; none has been measured. The four profiles of the
/// device have the same effect here.
///
/// * A vacuum requires an object, and is at most [`Suction::MAX_VACUUM`]. A request is unsuccessful
///   if the vacuum is not reached in time.
/// * The pump holds a vacuum once it is reached. A stop turns the pump off, and the vacuum slowly
///   leaks away.
/// * The loss of the object ends the vacuum.
#[derive(Debug, Clone)]
pub struct Suction {
    object: bool,
    /// Current vacuum, `[mbar]`.
    vacuum: f64,
    part_detached: bool,
    activity: Activity,
}

#[derive(Debug, Clone, Copy)]
enum Activity {
    /// The pump is off, and the valve is closed.
    Idle,
    /// The pump builds up the vacuum `target`, for at most `left` more milliseconds.
    Pumping { target: f64, left: i64 },
    /// The pump holds the vacuum.
    Holding { target: f64 },
    /// The valve is open, for `left` more milliseconds.
    Venting { left: i64 },
}

impl Suction {
    /// The deepest vacuum `[mbar]`.
    pub const MAX_VACUUM: f64 = 750.0;

    /// Rate at which the pump builds up the vacuum `[mbar/s]`.
    pub const PUMP_RATE: f64 = 1000.0;

    /// Rate at which the vacuum is lost through the open valve, or through a cup without an object
    /// `[mbar/s]`.
    pub const VENT_RATE: f64 = 4000.0;

    /// Rate at which the vacuum on an object leaks away while the pump is off `[mbar/s]`.
    pub const LEAK_RATE: f64 = 20.0;

    /// Vacuum above which the gripper reports that it holds an object `[mbar]`.
    pub const PART_PRESENT: f64 = 100.0;

    /// A gripper without an object in front of it.
    pub fn new() -> Self {
        Self {
            object: false,
            vacuum: 0.0,
            part_detached: false,
            activity: Activity::Idle,
        }
    }

    /// Puts an object in front of the cup.
    #[must_use]
    pub fn with_object(mut self) -> Self {
        self.place_object();
        self
    }

    /// Puts an object in front of the cup.
    pub fn place_object(&mut self) {
        self.object = true;
    }

    /// Removes the object. Returns false if the gripper had no object.
    pub fn take_object(&mut self) -> bool {
        std::mem::take(&mut self.object)
    }

    fn lose(&mut self, rate: f64) {
        self.vacuum = towards(self.vacuum, 0.0, rate * CYCLE);
    }

    fn pump(&mut self, target: f64) {
        if self.object {
            let reachable = target.min(Self::MAX_VACUUM);
            self.vacuum = towards(self.vacuum, reachable, Self::PUMP_RATE * CYCLE);
        } else {
            self.lose(Self::VENT_RATE);
        }
    }
}

impl Default for Suction {
    fn default() -> Self {
        Self::new()
    }
}

impl Mechanism for Suction {
    type Protocol = Version;
    type State = State;

    fn is_stop(request: &Request) -> bool {
        matches!(request, Request::Stop)
    }

    fn begin(&mut self, request: &Request) -> Option<Status> {
        let (activity, timeout) = match *request {
            Request::Vacuum(Vacuum {
                vacuum, timeout, ..
            }) => {
                let target = f64::from(vacuum) * 10.0;
                let left = timeout;
                (Activity::Pumping { target, left }, timeout)
            }
            Request::DropOff { timeout } => (Activity::Venting { left: timeout }, timeout),
            _ => return Some(Status::Fail),
        };
        if timeout <= 0 {
            return Some(Status::Fail);
        }
        self.part_detached = false;
        self.activity = activity;
        None
    }

    fn halt(&mut self) {
        self.activity = Activity::Idle;
    }

    fn tick(&mut self) -> Option<Status> {
        match self.activity {
            Activity::Idle => {
                self.lose(match self.object {
                    true => Self::LEAK_RATE,
                    false => Self::VENT_RATE,
                });
                None
            }
            Activity::Pumping { target, left } => {
                self.pump(target);
                if self.object && self.vacuum >= target {
                    self.activity = Activity::Holding { target };
                    return Some(Status::Success);
                }
                let left = left - 1;
                self.activity = Activity::Pumping { target, left };
                (left <= 0).then(|| {
                    self.halt();
                    Status::Unsuccessful
                })
            }
            Activity::Holding { target } => {
                self.pump(target);
                None
            }
            Activity::Venting { left } => {
                self.lose(Self::VENT_RATE);
                if self.vacuum == 0.0 {
                    self.part_detached = true;
                    self.halt();
                    return Some(Status::Success);
                }
                let left = left - 1;
                self.activity = Activity::Venting { left };
                (left <= 0).then(|| {
                    self.halt();
                    Status::Unsuccessful
                })
            }
        }
    }

    fn state(&self, message_id: u32) -> State {
        let (in_control_range, actual_power) = match self.activity {
            Activity::Pumping { .. } => (false, 100),
            Activity::Holding { target } => (self.vacuum >= target, 30),
            Activity::Idle | Activity::Venting { .. } => (false, 0),
        };
        State {
            message_id,
            in_control_range,
            part_detached: self.part_detached,
            part_present: self.object && self.vacuum >= Self::PART_PRESENT,
            device_status: DeviceStatus::Green,
            actual_power,
            // The value is at most 750, so the cast is exact.
            vacuum: self.vacuum.round() as i32,
        }
    }

    fn encode(state: &State) -> Bytes {
        Bytes::copy_from_slice(&state.encode())
    }
}
