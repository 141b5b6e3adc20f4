//! Positions of all joint frames and directions of all joint axes, in base axes.
//!
//! The FER and the FR3 have the same [geometry](crate::geometry) except for two lengths: an
//! alternating chain in which every joint frame is rolled by 0 or ±90° relative to the previous
//! frame. A joint therefore costs one plane rotation and a permutation of columns. Positions are
//! relative to the shoulder S, where axes 1, 2 and 3 meet, because these axes then have no moment
//! about the reference point.

use nalgebra::{Matrix3, Vector3};

use crate::JointVector;
use crate::geometry::{ELBOW, FLANGE, Lengths, SHOULDER, WRIST};
use crate::inertia::cross;
use crate::scalar::sin_cos;

/// Rotations, origins and screws of the seven joint frames, in base axes.
#[derive(Clone)]
pub(crate) struct Chain {
    /// Axes of frame i as columns.
    pub(crate) rotation: [Matrix3<f64>; 7],
    /// Origin of frame i, relative to the shoulder.
    pub(crate) origin: [Vector3<f64>; 7],
    /// Direction of axis i.
    pub(crate) axis: [Vector3<f64>; 7],
    /// Velocity, per unit rate of joint i, of the body's point at the shoulder: `origin × axis`.
    pub(crate) moment: [Vector3<f64>; 7],
}

/// Columns of a frame while the chain is built.
#[derive(Clone, Copy)]
struct Axes {
    x: Vector3<f64>,
    y: Vector3<f64>,
    z: Vector3<f64>,
}

impl Axes {
    /// Applies `RotX(+90°)`, then `RotZ` of the joint.
    #[inline(always)]
    fn roll_up(self, (sin, cos): (f64, f64)) -> Self {
        Self {
            x: self.x * cos + self.z * sin,
            y: self.z * cos - self.x * sin,
            z: -self.y,
        }
    }

    /// Applies `RotX(−90°)`, then `RotZ` of the joint.
    #[inline(always)]
    fn roll_down(self, (sin, cos): (f64, f64)) -> Self {
        Self {
            x: self.x * cos - self.z * sin,
            y: -(self.x * sin + self.z * cos),
            z: self.y,
        }
    }

    #[inline(always)]
    fn matrix(&self) -> Matrix3<f64> {
        Matrix3::new(
            self.x.x, self.y.x, self.z.x, //
            self.x.y, self.y.y, self.z.y, //
            self.x.z, self.y.z, self.z.z,
        )
    }
}

impl Chain {
    /// Returns all frames at the positions `q`.
    #[inline(always)]
    pub(crate) fn at(lengths: &Lengths, q: &JointVector) -> Self {
        let [t1, t2, t3, t4, t5, t6, t7] = q.data.0[0].map(sin_cos);
        let zero = Vector3::zeros();

        let f1 = Axes {
            x: Vector3::new(t1.1, t1.0, 0.0),
            y: Vector3::new(-t1.0, t1.1, 0.0),
            z: Vector3::new(0.0, 0.0, 1.0),
        };
        let f2 = f1.roll_down(t2);
        let f3 = f2.roll_up(t3);
        let f4 = f3.roll_up(t4);
        let f5 = f4.roll_down(t5);
        let f6 = f5.roll_up(t6);
        let f7 = f6.roll_up(t7);

        let p3 = f3.z * lengths.upper_arm;
        let p4 = p3 + f3.x * ELBOW;
        let p5 = p4 + f4.y * lengths.forearm - f4.x * ELBOW;
        let p7 = p5 + f6.x * WRIST;

        Self {
            rotation: [f1, f2, f3, f4, f5, f6, f7].map(|frame| frame.matrix()),
            origin: [zero, zero, p3, p4, p5, p5, p7],
            axis: [f1.z, f2.z, f3.z, f4.z, f5.z, f6.z, f7.z],
            moment: [
                zero,
                zero,
                zero,
                cross(&p4, &f4.z),
                cross(&p5, &f5.z),
                cross(&p5, &f6.z),
                cross(&p7, &f7.z),
            ],
        }
    }

    /// Returns all frames at the positions `q` of an arm with the joint frames `origins`. Each
    /// origin is a rotation and a translation in the frame of the previous link, at joint position
    /// zero.
    pub(crate) fn through(origins: &[(Matrix3<f64>, Vector3<f64>); 7], q: &JointVector) -> Self {
        let mut chain = Self {
            rotation: [Matrix3::identity(); 7],
            origin: [Vector3::zeros(); 7],
            axis: [Vector3::zeros(); 7],
            moment: [Vector3::zeros(); 7],
        };
        let mut rotation = Matrix3::identity();
        let mut origin = Vector3::new(0.0, 0.0, -SHOULDER);
        for (i, (turn, shift)) in origins.iter().enumerate() {
            origin += rotation * shift;
            let (sin, cos) = sin_cos(q[i]);
            let joint = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
            rotation *= turn * joint;
            let axis = rotation.column(2).into_owned();
            chain.rotation[i] = rotation;
            chain.origin[i] = origin;
            chain.axis[i] = axis;
            chain.moment[i] = cross(&origin, &axis);
        }
        chain
    }

    /// Returns the origin of the flange, relative to the shoulder.
    #[inline(always)]
    pub(crate) fn flange(&self) -> Vector3<f64> {
        self.origin[6] + self.axis[6] * FLANGE
    }
}
