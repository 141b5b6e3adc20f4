//! Links and joints of the text, the joint that moves each link, and the poses of all frames.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use roxmltree::Node;
use std::borrow::ToOwned;
use std::string::String;
use std::vec::Vec;
use std::{format, vec};

use super::element::{self, Element};
use super::{ROTATION_OFF, TRANSLATION_OFF, UrdfError};
use crate::geometry::{FLANGE, JointOrigin, Lengths};

/// Joints and links of the text. They have been checked against the crate's geometry.
pub(super) struct Tree<'a, 'n> {
    /// Joints 1 to 7.
    pub(super) joints: [Joint<'a, 'n>; 7],
    /// Links in the order of the text.
    pub(super) links: Vec<Link<'a, 'n>>,
    /// The known set of lengths that matches the frames in the text.
    pub(super) lengths: Lengths,
}

pub(super) struct Joint<'a, 'n> {
    pub(super) node: Node<'a, 'n>,
    /// Text for messages: `joint: ` and the joint's name.
    pub(super) owner: String,
    pub(super) name: &'a str,
    kind: &'a str,
    parent: usize,
    child: usize,
    origin: Isometry3<f64>,
}

pub(super) struct Link<'a, 'n> {
    pub(super) node: Node<'a, 'n>,
    pub(super) name: &'a str,
    pub(super) place: Place,
}

/// The place of a link, relative to the last moving link before it, or to the base.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// Number of the last joint that moves the link; 0 for none.
    pub(super) moved_by: usize,
    /// True if the link is fixed to the link that the joint moves, or is part of the base.
    pub(super) is_fixed: bool,
    pub(super) pose: Isometry3<f64>,
}

const NAMES: [&str; 7] = [
    "joint1", "joint2", "joint3", "joint4", "joint5", "joint6", "joint7",
];

impl<'a, 'n> Tree<'a, 'n> {
    pub(super) fn read(robot: Node<'a, 'n>) -> Result<Self, UrdfError> {
        let links = named(robot, "link")?;
        let names: Vec<&str> = links.iter().map(|(name, _)| *name).collect();
        let joints = named(robot, "joint")?;
        let joints = joints
            .into_iter()
            .map(|(name, node)| Joint::read(name, node, &names));
        let joints = joints.collect::<Result<Vec<_>, _>>()?;
        let numbers = arm(&joints)?;
        let (places, lengths) = known_places(&names, &joints, &numbers)?;
        check_flange(&names, &places)?;
        let links = links.into_iter().zip(places);
        let links = links.map(|((name, node), place)| Link { node, name, place });
        let mut joints: Vec<_> = joints
            .into_iter()
            .zip(numbers)
            .filter_map(|(joint, number)| Some((number?, joint)))
            .collect();
        joints.sort_by_key(|(number, _)| *number);
        let joints: Vec<_> = joints.into_iter().map(|(_, joint)| joint).collect();
        let joints = joints.try_into();
        Ok(Self {
            joints: joints.unwrap_or_else(|_| unreachable!("each of seven numbers was given once")),
            links: links.collect(),
            lengths,
        })
    }

    /// Returns the links that the seven joints move, without the links fixed to them.
    pub(super) fn moved_links(&self) -> impl Iterator<Item = &Link<'a, 'n>> {
        self.links.iter().filter(|link| !link.place.is_fixed)
    }
}

impl<'a, 'n> Joint<'a, 'n> {
    fn read(name: &'a str, node: Node<'a, 'n>, links: &[&str]) -> Result<Self, UrdfError> {
        let owner = format!("joint: {name}");
        let kind = node.attribute("type").ok_or(UrdfError::MissingAttribute {
            attribute: "type",
            element: "joint",
            owner: owner.clone(),
        })?;
        let link = |role: &'static str| -> Result<usize, UrdfError> {
            let element = Element::child(node, role, &owner)?;
            // The owner does not live as long as the text.
            let got = element.text("link")?;
            links
                .iter()
                .position(|link| *link == got)
                .ok_or_else(|| UrdfError::UnknownLink {
                    joint: name.to_owned(),
                    role,
                    got: got.to_owned(),
                })
        };
        let (parent, child) = (link("parent")?, link("child")?);
        let origin = element::origin(node, &owner)?;
        Ok(Self {
            node,
            name,
            kind,
            parent,
            child,
            origin,
            owner,
        })
    }

    /// Checks that the joint turns about z of its frame.
    fn check_axis(&self) -> Result<(), UrdfError> {
        let got = Element::child(self.node, "axis", &self.owner)?.vector("xyz")?;
        let axis = Vector3::from(got).try_normalize(0.0);
        let off = axis.map(|axis| (axis - Vector3::z()).amax());
        match off {
            Some(off) if off <= ROTATION_OFF => Ok(()),
            _ => Err(UrdfError::Axis {
                joint: self.name.to_owned(),
                got,
            }),
        }
    }
}

/// Returns the elements named `element`, with their unique names.
fn named<'a, 'n>(
    robot: Node<'a, 'n>,
    element: &'static str,
) -> Result<Vec<(&'a str, Node<'a, 'n>)>, UrdfError> {
    let mut found: Vec<(&str, Node<'_, '_>)> = Vec::new();
    for node in robot.children().filter(|node| node.has_tag_name(element)) {
        let name = element::name(node, element)?;
        if found.iter().any(|(other, _)| *other == name) {
            return Err(UrdfError::Duplicate {
                element,
                name: name.to_owned(),
            });
        }
        found.push((name, node));
    }
    Ok(found)
}

/// Assigns the joints of the text to joints 1 to 7 of the arm.
///
/// As in the vendor's client, a name matches if it equals or contains the joint's name. Fixed
/// joints have other names.
fn arm(joints: &[Joint<'_, '_>]) -> Result<Vec<Option<usize>>, UrdfError> {
    let mut numbers = vec![None; joints.len()];
    let mut missing = Vec::new();
    for (i, name) in NAMES.into_iter().enumerate() {
        let find = |test: &dyn Fn(&Joint<'_, '_>) -> bool| joints.iter().position(test);
        let moves = |joint: &Joint<'_, '_>| joint.kind != "fixed";
        let found = find(&|joint| joint.name == name)
            .or_else(|| find(&|joint| moves(joint) && joint.name.contains(name)))
            .or_else(|| find(&|joint| joint.name.contains(name)));
        match found {
            Some(index) if numbers[index].is_none() => numbers[index] = Some(i + 1),
            _ => missing.push(name),
        }
    }
    if !missing.is_empty() {
        return Err(UrdfError::MissingJoints {
            missing,
            got: joints.iter().map(|joint| joint.name.to_owned()).collect(),
        });
    }
    for (joint, number) in joints.iter().zip(&numbers) {
        let (name, got) = (joint.name.to_owned(), joint.kind.to_owned());
        match (joint.kind, number) {
            ("revolute", Some(_)) => joint.check_axis()?,
            (_, Some(_)) => return Err(UrdfError::JointType { joint: name, got }),
            ("fixed", None) => {}
            (_, None) => return Err(UrdfError::ExtraJoint { joint: name, got }),
        }
    }
    Ok(numbers)
}

/// Returns the places of the links, and the known lengths that match every frame.
fn known_places(
    links: &[&str],
    joints: &[Joint<'_, '_>],
    numbers: &[Option<usize>],
) -> Result<(Vec<Place>, Lengths), UrdfError> {
    let [described, others @ ..] = Lengths::KNOWN;
    let with = |lengths: Lengths| {
        let places = places(links, joints, numbers, &lengths.joint_origins());
        places.map(|places| (places, lengths))
    };
    with(described).or_else(|error| match error {
        UrdfError::Origin { .. } => others
            .into_iter()
            .find_map(|lengths| with(lengths).ok())
            .ok_or(error),
        error => Err(error),
    })
}

/// Computes the places from the root outwards.
fn places(
    links: &[&str],
    joints: &[Joint<'_, '_>],
    numbers: &[Option<usize>],
    origins: &[JointOrigin; 7],
) -> Result<Vec<Place>, UrdfError> {
    let root = root(links, joints)?;
    let mut places = vec![None; links.len()];
    let base = Place {
        moved_by: 0,
        is_fixed: true,
        pose: Isometry3::identity(),
    };
    let mut open = vec![(root, base)];
    while let Some((link, place)) = open.pop() {
        places[link] = Some(place);
        for (joint, number) in joints.iter().zip(numbers) {
            if joint.parent == link {
                let beyond = joint.place_beyond(*number, links[link], &place, origins)?;
                open.push((joint.child, beyond));
            }
        }
    }
    let reached = places.into_iter().zip(links).map(|(place, link)| {
        place.ok_or_else(|| UrdfError::Circle {
            link: (*link).to_owned(),
            root: links[root].to_owned(),
        })
    });
    reached.collect()
}

impl Joint<'_, '_> {
    /// Returns the place of the joint's child, given the place of its parent.
    fn place_beyond(
        &self,
        number: Option<usize>,
        parent: &str,
        place: &Place,
        origins: &[JointOrigin; 7],
    ) -> Result<Place, UrdfError> {
        let pose = place.pose * self.origin;
        let Some(number) = number else {
            return Ok(Place {
                moved_by: place.moved_by,
                is_fixed: true,
                pose,
            });
        };
        if place.moved_by + 1 != number {
            return Err(UrdfError::Order {
                joint: self.name.to_owned(),
                got: parent.to_owned(),
                moved_by: place.moved_by,
                expected: number - 1,
            });
        }
        let origin = &origins[number - 1];
        let roll = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), origin.roll);
        let expected = Isometry3::from_parts(origin.translation.into(), roll);
        check_pose(&self.owner, &pose, &expected)?;
        Ok(Place {
            moved_by: number,
            is_fixed: false,
            pose: Isometry3::identity(),
        })
    }
}

/// Returns the only link that is not the child of a joint.
fn root(links: &[&str], joints: &[Joint<'_, '_>]) -> Result<usize, UrdfError> {
    let mut carriers: Vec<Option<&str>> = vec![None; links.len()];
    for joint in joints {
        if let Some(first) = carriers[joint.child].replace(joint.name) {
            return Err(UrdfError::TwoParents {
                link: links[joint.child].to_owned(),
                first: first.to_owned(),
                second: joint.name.to_owned(),
            });
        }
    }
    let free = carriers
        .iter()
        .enumerate()
        .filter(|(_, carrier)| carrier.is_none());
    let free: Vec<usize> = free.map(|(link, _)| link).collect();
    match free[..] {
        [root] => Ok(root),
        _ => Err(UrdfError::Roots {
            got: free.iter().map(|&link| links[link].to_owned()).collect(),
        }),
    }
}

/// Checks that a flange exists: `link8`, or a name that ends with it.
fn check_flange(links: &[&str], places: &[Place]) -> Result<(), UrdfError> {
    const NAME: &str = "link8";
    let found = links
        .iter()
        .position(|link| *link == NAME)
        .or_else(|| links.iter().position(|link| link.ends_with(NAME)));
    let Some(index) = found.filter(|&index| places[index].moved_by == 7) else {
        return Err(UrdfError::NoFlange {
            got: links.iter().map(|link| (*link).to_owned()).collect(),
        });
    };
    let owner = format!("the flange, link: {}", links[index]);
    check_pose(
        &owner,
        &places[index].pose,
        &Isometry3::translation(0.0, 0.0, FLANGE),
    )
}

fn check_pose(
    owner: &str,
    got: &Isometry3<f64>,
    expected: &Isometry3<f64>,
) -> Result<(), UrdfError> {
    let off = expected.inverse() * got;
    let translation = off.translation.vector;
    let turn = off.rotation.to_rotation_matrix();
    let turned = (turn.matrix() - nalgebra::Matrix3::identity()).amax();
    if translation.amax() <= TRANSLATION_OFF && turned <= ROTATION_OFF {
        return Ok(());
    }
    Err(UrdfError::Origin {
        owner: owner.to_owned(),
        translation: translation.into(),
        rotation: off.rotation.euler_angles().into(),
    })
}
