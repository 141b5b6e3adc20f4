//! The acceleration sensors on the boards of the joints.

use franka_model::{CYCLE, EndEffector, Frame, JointVector, Model};
use nalgebra::{Matrix3, Vector3};

use crate::signal::halves;

/// Motion of the boards of links 0 to 5. Each board is assumed to be at the origin of its link's
/// frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Boards {
    boards: [Board; 6],
}

#[derive(Debug, Clone, Copy)]
struct Board {
    /// Rotation from the board's link to base axes.
    rotation: Matrix3<f64>,
    /// Velocity of the board, `[m/s]`, in base axes.
    velocity: Vector3<f64>,
    /// Acceleration minus gravity, `[m/s²]`, in base axes.
    felt: Vector3<f64>,
}

impl Boards {
    /// Boards of an arm at rest at `q`, `[rad]`.
    pub(super) fn resting(model: &Model, q: &JointVector) -> Self {
        let board = Board {
            rotation: Matrix3::identity(),
            velocity: Vector3::zeros(),
            felt: -franka_model::GRAVITY_EARTH,
        };
        let mut boards = Self { boards: [board; 6] };
        boards.advance(model, q, &JointVector::zeros());
        boards
    }

    /// Advances by a millisecond, to the joint positions `q`, `[rad]`, and velocities `dq`,
    /// `[rad/s]`.
    pub(super) fn advance(&mut self, model: &Model, q: &JointVector, dq: &JointVector) {
        let frames = EndEffector::default();
        // Board 0 does not move.
        for (board, frame) in self.boards[1..].iter_mut().zip(Frame::ALL) {
            let (velocity, _) = halves(&(model.zero_jacobian(frame, q, &frames) * dq));
            let pose = model.pose(frame, q, &frames);
            board.rotation = pose.fixed_view::<3, 3>(0, 0).into_owned();
            board.felt = (velocity - board.velocity) / CYCLE - franka_model::GRAVITY_EARTH;
            board.velocity = velocity;
        }
    }

    /// Readings of the top sensors and of the bottom sensors of the boards, each in its own axes,
    /// `[m/s²]`.
    pub(super) fn read(&self) -> ([[f32; 3]; 6], [[f32; 3]; 6]) {
        let (mut top, mut bottom) = ([[0.0; 3]; 6], [[0.0; 3]; 6]);
        for (i, board) in self.boards.iter().enumerate() {
            let felt = board.rotation.tr_mul(&board.felt);
            let (over, under) = BOARDS[i];
            top[i] = over.read(&felt);
            bottom[i] = under.read(&felt);
        }
        (top, bottom)
    }
}

/// Rotation of a sensor's axes about the x axis of its link.
#[derive(Debug, Clone, Copy)]
enum Turn {
    None,
    Quarter,
    Half,
    QuarterBack,
}

impl Turn {
    /// Expresses a vector of the link in the sensor's axes.
    fn read(self, v: &Vector3<f64>) -> [f32; 3] {
        let (x, y, z) = (v.x as f32, v.y as f32, v.z as f32);
        match self {
            Self::None => [x, y, z],
            Self::Quarter => [x, z, -y],
            Self::Half => [x, -y, -z],
            Self::QuarterBack => [x, -z, y],
        }
    }
}

/// Top and bottom sensor of links 0 to 5 (libfranka 0.21, `test/fr3.urdf`, accelerometer links).
const BOARDS: [(Turn, Turn); 6] = [
    (Turn::Half, Turn::None),
    (Turn::Quarter, Turn::QuarterBack),
    (Turn::QuarterBack, Turn::Quarter),
    (Turn::QuarterBack, Turn::Quarter),
    (Turn::Quarter, Turn::QuarterBack),
    (Turn::QuarterBack, Turn::Quarter),
];
