//! Distances within the arm.

use franka_model::JointVector;
use franka_model::collision::{Proximity, Shape};
use numpy::{PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use super::Model;
use crate::batch::{Batch, Cost, outputs};

/// The least distance between two bodies of the arm; with a leading axis for a batch.
#[pyclass(frozen, get_all, module = "franka_async")]
pub(crate) struct Clearance {
    /// Distance between the surfaces, m: an array without axes, or `(n,)`. Negative for overlapping
    /// bodies.
    distance: Py<PyArrayDyn<f64>>,
    /// Numbers of the bodies, the inner one first, `(2,)`: 0 is the base, 1 to 7 are the links, 8
    /// is the tool on the flange.
    bodies: Py<PyArrayDyn<i64>>,
    /// Change of the distance per joint position, `(7,)` m/rad.
    gradient: Py<PyArrayDyn<f64>>,
    /// The nearest points of the axes of the two capsules in the base frame, `(2, 3)` m.
    points: Py<PyArrayDyn<f64>>,
}

#[pymethods]
impl Model {
    /// The least distance within the arm, and its bodies. `hand` is true for a Franka Hand on the
    /// flange.
    ///
    /// `shape` is `vendor`, the vendor's capsules for self-collision, which do not cover the links
    /// everywhere, or `covering`, which contain them and are up to 3.5 cm thicker.
    #[pyo3(signature = (q, *, hand = true, shape = "vendor"))]
    fn clearance<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        hand: bool,
        shape: &str,
    ) -> PyResult<Clearance> {
        let arm = match shape {
            "vendor" => Shape::vendor().with_lengths(*self.numbers.lengths()),
            "covering" => {
                Shape::covering(self.numbers.kind()).with_lengths(*self.numbers.lengths())
            }
            other => {
                let text = format!("shape is {other:?}, expected 'vendor' or 'covering'");
                return Err(PyValueError::new_err(text));
            }
        };
        let arm = if hand { arm.with_hand() } else { arm };
        let q = Batch::<7>::read("q", q)?;
        let shapes: [&[usize]; 4] = [&[], &[2], &[7], &[2, 3]];
        let arrays = outputs(py, q.count(), shapes, Cost::Little, |i, rows| {
            let [distance, bodies, gradient, points] = rows;
            let Proximity {
                bodies: (inner, outer),
                distance: least,
                gradient: slope,
                points: [from, to],
                ..
            } = arm.at(&JointVector::from(*q.row(i))).nearest_pair();
            distance[0] = least;
            bodies.copy_from_slice(&[inner.number().into(), outer.number().into()]);
            gradient.copy_from_slice(slope.as_slice());
            points[..3].copy_from_slice(from.as_slice());
            points[3..].copy_from_slice(to.as_slice());
        });
        let [distance, bodies, gradient, points] = arrays;
        let bodies = bodies.call_method1("astype", ("int64",))?;
        Ok(Clearance {
            distance: distance.unbind(),
            bodies: bodies.cast_into()?.unbind(),
            gradient: gradient.unbind(),
            points: points.unbind(),
        })
    }
}

#[pymethods]
impl Clearance {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let (distance, bodies) = (self.distance.bind(py), self.bodies.bind(py));
        let (distance, bodies) = (distance.readonly(), bodies.readonly());
        let distance: Vec<f64> = distance.as_array().iter().copied().collect();
        let bodies: Vec<i64> = bodies.as_array().iter().copied().collect();
        Ok(match (&distance[..], &bodies[..]) {
            ([distance], [inner, outer]) => format!(
                "<Clearance {distance:.4} m between {} and {}>",
                name(*inner),
                name(*outer)
            ),
            (all, _) => {
                let least = all.iter().copied().fold(f64::INFINITY, f64::min);
                format!(
                    "<Clearance of {} postures, {least:.4} m at least>",
                    all.len()
                )
            }
        })
    }
}

fn name(body: i64) -> String {
    match body {
        0 => "the base".into(),
        8 => "the tool on the flange".into(),
        link => format!("link {link}"),
    }
}
