//! Masses and inertias of the links, and of the bodies that move together.

use nalgebra::{Isometry3, Matrix3, Vector3};
use std::borrow::ToOwned;
use std::format;

use super::UrdfError;
use super::element::{self, Element};
use super::tree::{Link, Tree};
use crate::inertia::{RigidBody, Symmetric3};

/// Returns the base and links 1 to 7. Each body includes all links that are fixed to it.
pub(super) fn bodies(tree: &Tree<'_, '_>) -> Result<[RigidBody; 8], UrdfError> {
    let mut bodies = [NOTHING; 8];
    for moved in tree.moved_links() {
        bodies[moved.place.moved_by] =
            read(moved, Weight::Needed)?.ok_or_else(|| UrdfError::MissingElement {
                element: "inertial",
                owner: format!("link: {}", moved.name),
            })?;
    }
    for attached in tree.links.iter().filter(|link| link.place.is_fixed) {
        let whole = &mut bodies[attached.place.moved_by];
        match read(attached, Weight::Optional)? {
            // A body without mass is not joined, because joining it could change the last digits.
            Some(part) if part.mass == 0.0 => {}
            Some(part) if whole.mass == 0.0 => *whole = part,
            Some(part) => *whole = whole.joined(&part),
            None => {}
        }
    }
    for moved in tree.moved_links() {
        let inertia = &bodies[moved.place.moved_by].inertia;
        check_moments(moved.name, inertia, "positive moments", |least, _| {
            least > 0.0
        })?;
    }
    Ok(bodies)
}

const NOTHING: RigidBody = RigidBody::new(0.0, [0.0; 3], [0.0; 6]);

/// States if a link must have a mass.
#[derive(Clone, Copy, PartialEq)]
enum Weight {
    Needed,
    Optional,
}

/// Returns the body of a link, in the frame in which the link is attached.
fn read(link: &Link<'_, '_>, weight: Weight) -> Result<Option<RigidBody>, UrdfError> {
    let owner = format!("link: {}", link.name);
    let Some(inertial) = Element::find(link.node, "inertial", &owner) else {
        return Ok(None);
    };
    let mass = inertial.inner("mass")?;
    let mass = match weight {
        Weight::Needed => mass.number_where("value", "a number above 0", |x| x > 0.0),
        Weight::Optional => mass.number_where("value", "a number of 0 or more", |x| x >= 0.0),
    }?;
    let tensor = inertial.inner("inertia")?;
    let inertia = Symmetric3 {
        xx: tensor.number("ixx")?,
        xy: tensor.number("ixy")?,
        xz: tensor.number("ixz")?,
        yy: tensor.number("iyy")?,
        yz: tensor.number("iyz")?,
        zz: tensor.number("izz")?,
    };
    check_moments(
        link.name,
        &inertia,
        "moments of 0 or more",
        |least, largest| {
            // The smallest moment of a rod is zero, except for rounding.
            least >= -1e-12 * largest
        },
    )?;
    let body = RigidBody {
        mass,
        com: Vector3::zeros(),
        inertia,
    };
    let on_link = moved(&body, &element::origin(inertial.node(), &owner)?);
    Ok(Some(moved(&on_link, &link.place.pose)))
}

/// Returns the body in the axes in which `pose` is given. The argument is in the axes of the frame
/// at `pose`.
fn moved(body: &RigidBody, pose: &Isometry3<f64>) -> RigidBody {
    let turn = pose.rotation.to_rotation_matrix();
    // An identity rotation must not change the last digits.
    if *turn.matrix() == Matrix3::identity() {
        return RigidBody {
            com: body.com + pose.translation.vector,
            ..*body
        };
    }
    RigidBody {
        mass: body.mass,
        com: turn * body.com + pose.translation.vector,
        inertia: body.inertia.rotated(turn.matrix()),
    }
}

fn check_moments(
    link: &str,
    inertia: &Symmetric3,
    expected: &'static str,
    is_sound: impl Fn(f64, f64) -> bool,
) -> Result<(), UrdfError> {
    let mut moments: [f64; 3] = inertia.matrix().symmetric_eigenvalues().into();
    moments.sort_unstable_by(f64::total_cmp);
    if is_sound(moments[0], moments[2]) {
        return Ok(());
    }
    Err(UrdfError::Inertia {
        link: link.to_owned(),
        moments,
        expected,
    })
}
