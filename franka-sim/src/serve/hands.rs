//! What a person beside a running robot does, from any task.

use franka_model::{JointVector, Load};
use franka_proto::RobotError;

use super::{Running, Stopped};
use crate::robot::{Touch, TouchId};

/// Hands on. Each acts between two milliseconds and returns when it has acted; what is not here
/// goes through [`Running::with`]. All fail with [`Stopped`] if the simulation has ended, and what
/// has once been polled may act although the future is dropped.
impl Running {
    /// [`Robot::touch`](crate::Robot::touch): push, pull, hold or block the arm.
    ///
    /// # Errors
    /// [`Stopped`]
    pub async fn touch(&self, touch: Touch) -> Result<TouchId, Stopped> {
        self.with(|robot| robot.touch(touch)).await
    }

    /// [`Robot::release`](crate::Robot::release): ends a touch.
    ///
    /// # Errors
    /// [`Stopped`]
    pub async fn release(&self, touch: TouchId) -> Result<bool, Stopped> {
        self.with(move |robot| robot.release(touch)).await
    }

    /// [`Robot::let_go`](crate::Robot::let_go): ends all touches.
    ///
    /// # Errors
    /// [`Stopped`]
    pub async fn let_go(&self) -> Result<(), Stopped> {
        self.with(|robot| robot.let_go()).await
    }

    /// [`Robot::press_user_stop`](crate::Robot::press_user_stop).
    ///
    /// # Errors
    /// [`Stopped`]
    pub async fn press_user_stop(&self, pressed: bool) -> Result<(), Stopped> {
        self.with(move |robot| robot.press_user_stop(pressed)).await
    }

    /// [`Robot::guide`](crate::Robot::guide): presses the guiding buttons, or lets go.
    ///
    /// # Errors
    /// [`Stopped`]
    pub async fn guide(&self, pressed: bool) -> Result<bool, Stopped> {
        self.with(move |robot| robot.guide(pressed)).await
    }

    /// [`Robot::open_brakes`](crate::Robot::open_brakes).
    ///
    /// # Errors
    /// [`Stopped`]
    pub async fn open_brakes(&self) -> Result<(), Stopped> {
        self.with(|robot| robot.open_brakes()).await
    }

    /// [`Robot::close_brakes`](crate::Robot::close_brakes).
    ///
    /// # Errors
    /// [`Stopped`]
    pub async fn close_brakes(&self) -> Result<(), Stopped> {
        self.with(|robot| robot.close_brakes()).await
    }

    /// [`Robot::activate_safety_function`](crate::Robot::activate_safety_function).
    ///
    /// # Errors
    /// [`Stopped`]
    pub async fn activate_safety_function(&self, active: bool) -> Result<(), Stopped> {
        self.with(move |robot| robot.activate_safety_function(active))
            .await
    }

    /// [`Robot::recover_manually`](crate::Robot::recover_manually).
    ///
    /// # Errors
    /// [`Stopped`]
    pub async fn recover_manually(&self) -> Result<(), Stopped> {
        self.with(|robot| robot.recover_manually()).await
    }

    /// [`Robot::trip`](crate::Robot::trip): makes the robot believe in an error.
    ///
    /// # Errors
    /// [`Stopped`]
    pub async fn trip(&self, error: RobotError) -> Result<(), Stopped> {
        self.with(move |robot| robot.trip(error)).await
    }

    /// [`Robot::attach`](crate::Robot::attach): changes what the flange carries.
    ///
    /// # Errors
    /// [`Stopped`]
    pub async fn attach(&self, load: Load) -> Result<(), Stopped> {
        self.with(move |robot| robot.attach(load)).await
    }

    /// [`Robot::place`](crate::Robot::place): puts the arm elsewhere, `[rad]`.
    ///
    /// # Errors
    /// [`Stopped`]
    pub async fn place(&self, q: JointVector) -> Result<(), Stopped> {
        self.with(move |robot| robot.place(&q)).await
    }

    /// Drops an object of this width between the fingers of the hand, `[m]`. False if it does not
    /// fit, or if there is no hand. What it weighs is a matter of [`attach`](Self::attach).
    ///
    /// False as well if the fingers are the plant's: between those goes a body of the scene
    /// (`MujocoArm::put_body`, by [`with`](Self::with) and
    /// [`Robot::plant_mut`](crate::Robot::plant_mut)).
    ///
    /// # Errors
    /// [`Stopped`]
    pub async fn drop_into_hand(&self, width: f64) -> Result<bool, Stopped> {
        match self.hand() {
            Some(hand) => {
                hand.with(move |hand| hand.mechanism_mut().place_object(width))
                    .await
            }
            None => Ok(false),
        }
    }

    /// Takes the object out of the hand, and returns its width, `[m]`, if there was one.
    ///
    /// # Errors
    /// [`Stopped`]
    pub async fn take_from_hand(&self) -> Result<Option<f64>, Stopped> {
        match self.hand() {
            Some(hand) => hand.with(|hand| hand.mechanism_mut().take_object()).await,
            None => Ok(None),
        }
    }
}
