//! The rigid-body models and the velocity envelope of the FR3 against the vendor's libraries.

use franka_model::limits::CLIENT_MARGIN;
use franka_model::{EndEffector, Frame, JointVector, Load, Model, RobotKind, joint_vector};
use nalgebra::{Matrix3, Matrix4, Vector3};

use super::{Case, Malformed, Node, Report};

// What the numbers of the files may differ by: they went through other orders of summation. The
// vendor's own two routes to the Coriolis torques differ by 2.5e-14.
const POSE: f64 = 1e-13;
const JACOBIAN: f64 = 1e-13;
const MASS: f64 = 1e-13;
const TORQUE: f64 = 1e-12;
/// How far the physically consistent FER may be from the vendor's without a load: what its description
/// says, rounded up.
const FIT_MASS: f64 = 0.02;
const FIT_GRAVITY: f64 = 0.02;
const FIT_CORIOLIS: f64 = 0.09;
/// Totals of the loads, made of the same few operations.
const TOTALS: f64 = 1e-15;

/// Checks `model_vectors_fr3.json`: libfranka 0.20.4 with the FR3 URDF.
pub(super) fn fr3(root: &Node<'_>) -> Result<Report, Malformed> {
    rigid_body(root, Model::fr3())
}

/// Checks `model_vectors_fer.json`: the FER's own model library.
pub(super) fn fer(root: &Node<'_>) -> Result<Report, Malformed> {
    rigid_body(root, Model::fer())
}

/// Checks in `model_vectors_fer.json` how far the physically consistent FER is from the vendor's library, at
/// the configurations without a load.
pub(super) fn fer_physically_consistent(root: &Node<'_>) -> Result<Report, Malformed> {
    let mut report = Report::default();
    for sample in root.get("samples")?.list()? {
        let state = State::read(root, &sample)?;
        let bare = sample.get("loads")?.list()?.swap_remove(0);
        let torques = Torques::read(&bare)?;
        report.case(bare.path(), |case| {
            torques.check_physically_consistent(case, &state)
        });
    }
    Ok(report)
}

/// A case is one configuration with one load; the frames that no load moves are checked with each.
fn rigid_body(root: &Node<'_>, model: &Model) -> Result<Report, Malformed> {
    let mut report = Report::default();
    let tools = root.get("load_configs")?.list()?;
    let tools: Vec<Tool> = tools.iter().map(Tool::read).collect::<Result<_, _>>()?;

    for (index, tool) in tools.iter().enumerate() {
        report.case(format!("load_configs[{index}]"), |case| tool.check(case));
    }
    for sample in root.get("samples")?.list()? {
        let state = State::read(root, &sample)?;
        let common = Frames::read(&sample, &Frame::ALL[..8])?;
        for node in sample.get("loads")?.list()? {
            let index = node.get("load")?.integer()?;
            let tool = usize::try_from(index)
                .ok()
                .and_then(|index| tools.get(index))
                .ok_or_else(|| node.malformed("the index of a load"))?;
            let moved = Frames::read(&node, &Frame::ALL[8..])?;
            let torques = Torques::read(&node)?;
            report.case(node.path(), |case| {
                common.check(case, model, &state, &tool.ee);
                moved.check(case, model, &state, &tool.ee);
                torques.check(case, model, &state, tool);
                torques.check_one_pass(case, model, &state, tool, &moved);
            });
        }
    }
    Ok(report)
}

/// Checks `velocity_limit_vectors_fr3.json`, libfranka 0.21.3: equal to the last bit.
pub(super) fn velocity_envelope(root: &Node<'_>) -> Result<Report, Malformed> {
    let mut report = Report::default();
    for vector in root.get("vectors")?.list()? {
        let q = joint_vector(vector.get("q")?.numbers()?);
        let (lower, upper) = (
            vector.get("lower")?.vector()?,
            vector.get("upper")?.vector()?,
        );
        report.case(vector.path(), |case| {
            let limits = Model::fr3().joint_limits();
            let (low, high) = limits.velocity_envelope(&q, CLIENT_MARGIN);
            case.near("lower", low.as_slice(), &lower, 0.0);
            case.near("upper", high.as_slice(), &upper, 0.0);
        });
    }
    Ok(report)
}

struct State {
    q: JointVector,
    dq: JointVector,
    gravity: Vector3<f64>,
    gravity_alt: Vector3<f64>,
}

impl State {
    fn read(root: &Node<'_>, sample: &Node<'_>) -> Result<Self, Malformed> {
        let meta = root.get("meta")?;
        Ok(Self {
            q: joint_vector(sample.get("q")?.numbers()?),
            dq: joint_vector(sample.get("dq")?.numbers()?),
            gravity: Vector3::from(meta.get("gravity")?.numbers::<3>()?),
            gravity_alt: Vector3::from(meta.get("gravity_alt")?.numbers::<3>()?),
        })
    }
}

/// A configuration of frames and loads, and the totals that the vendor's client makes of it.
struct Tool {
    ee: EndEffector,
    load: Load,
    total: Load,
}

impl Tool {
    fn read(node: &Node<'_>) -> Result<Self, Malformed> {
        let matrix = |name| -> Result<_, Malformed> {
            Ok(Matrix4::from_column_slice(
                &node.get(name)?.numbers::<16>()?,
            ))
        };
        let load = |mass, com, inertia| -> Result<_, Malformed> {
            Ok(Load {
                mass: node.get(mass)?.number()?,
                com: Vector3::from(node.get(com)?.numbers::<3>()?),
                inertia: Matrix3::from_column_slice(&node.get(inertia)?.numbers::<9>()?),
            })
        };
        let total = load("m_total", "F_x_Ctotal", "I_total")?;
        // The file of the FER gives totals only.
        let combined = if node.find("m_ee").is_some() {
            let tool = load("m_ee", "F_x_Cee", "I_ee")?;
            tool.combine(&load("m_load", "F_x_Cload", "I_load")?)
        } else {
            total
        };
        Ok(Self {
            ee: EndEffector {
                f_t_ee: matrix("F_T_EE")?,
                ee_t_k: matrix("EE_T_K")?,
            },
            load: combined,
            total,
        })
    }

    fn check(&self, case: &mut Case<'_>) {
        let (got, want) = (&self.load, &self.total);
        case.near("m_total", &[got.mass], &[want.mass], TOTALS);
        case.near(
            "F_x_Ctotal",
            got.com.as_slice(),
            want.com.as_slice(),
            TOTALS,
        );
        case.near(
            "I_total",
            got.inertia.as_slice(),
            want.inertia.as_slice(),
            TOTALS,
        );
    }
}

/// Poses and Jacobians of some frames.
struct Frames(Vec<FrameNumbers>);

struct FrameNumbers {
    frame: Frame,
    pose: Vec<f64>,
    zero_jacobian: Vec<f64>,
    body_jacobian: Vec<f64>,
}

impl Frames {
    /// Reads concatenated matrices, column-major, in the order of `frames`.
    fn read(node: &Node<'_>, frames: &[Frame]) -> Result<Self, Malformed> {
        let matrices = |name: &str, size: usize| -> Result<Vec<Vec<f64>>, Malformed> {
            let (member, expected) = (node.get(name)?, size * frames.len());
            let numbers = member.vector()?;
            if numbers.len() != expected {
                return Err(member.malformed(format!("{expected} numbers")));
            }
            Ok(numbers.chunks(size).map(<[f64]>::to_vec).collect())
        };
        let poses = matrices("pose", 16)?;
        let zero = matrices("zero_jacobian", 42)?;
        let body = matrices("body_jacobian", 42)?;
        let parts = frames.iter().zip(poses).zip(zero).zip(body);
        let numbers = parts.map(
            |(((&frame, pose), zero_jacobian), body_jacobian)| FrameNumbers {
                frame,
                pose,
                zero_jacobian,
                body_jacobian,
            },
        );
        Ok(Self(numbers.collect()))
    }

    fn check(&self, case: &mut Case<'_>, model: &Model, state: &State, ee: &EndEffector) {
        let q = &state.q;
        for want in &self.0 {
            let frame = want.frame;
            let pose = model.pose(frame, q, ee);
            let name = format!("pose of {frame:?}");
            case.near(&name, pose.as_slice(), &want.pose, POSE);
            let zero = model.zero_jacobian(frame, q, ee);
            let name = format!("zero Jacobian of {frame:?}");
            case.near(&name, zero.as_slice(), &want.zero_jacobian, JACOBIAN);
            let body = model.body_jacobian(frame, q, ee);
            let name = format!("body Jacobian of {frame:?}");
            case.near(&name, body.as_slice(), &want.body_jacobian, JACOBIAN);
        }
    }
}

/// The dynamics of one configuration with one load.
struct Torques {
    mass: Vec<f64>,
    coriolis: Vec<f64>,
    gravity: Vec<f64>,
    gravity_alt: Vec<f64>,
}

impl Torques {
    fn read(node: &Node<'_>) -> Result<Self, Malformed> {
        let vector = |name| node.get(name)?.vector();
        Ok(Self {
            mass: vector("mass")?,
            coriolis: vector("coriolis")?,
            gravity: vector("gravity")?,
            gravity_alt: vector("gravity_alt")?,
        })
    }

    fn check(&self, case: &mut Case<'_>, model: &Model, state: &State, tool: &Tool) {
        let load = &tool.load;
        let State {
            q,
            dq,
            gravity,
            gravity_alt,
        } = state;
        case.near("mass", model.mass(q, load).as_slice(), &self.mass, MASS);
        let coriolis = model.coriolis(q, dq, load);
        case.near("Coriolis", coriolis.as_slice(), &self.coriolis, TORQUE);
        let standard = model.gravity(q, load, gravity);
        case.near("gravity", standard.as_slice(), &self.gravity, TORQUE);
        let tilted = model.gravity(q, load, gravity_alt);
        case.near(
            "gravity, tilted",
            tilted.as_slice(),
            &self.gravity_alt,
            TORQUE,
        );
    }

    /// Without a load.
    fn check_physically_consistent(&self, case: &mut Case<'_>, state: &State) {
        let (model, none) = (Model::physically_consistent(RobotKind::Fer), &Load::NONE);
        let State { q, dq, gravity, .. } = state;
        let mass = model.mass(q, none);
        case.near("mass", mass.as_slice(), &self.mass, FIT_MASS);
        let torque = model.gravity(q, none, gravity);
        case.near("gravity", torque.as_slice(), &self.gravity, FIT_GRAVITY);
        let torque = model.coriolis(q, dq, none);
        case.near("Coriolis", torque.as_slice(), &self.coriolis, FIT_CORIOLIS);
    }

    /// `moved` holds the end effector first.
    fn check_one_pass(
        &self,
        case: &mut Case<'_>,
        model: &Model,
        state: &State,
        tool: &Tool,
        moved: &Frames,
    ) {
        let State { q, dq, gravity, .. } = state;
        let all = model.dynamics(q, dq, &tool.ee, &tool.load, gravity);
        let want = &moved.0[0];
        for (name, got, want, tolerance) in [
            ("pose", all.pose.as_slice(), &want.pose, POSE),
            (
                "Jacobian",
                all.jacobian.as_slice(),
                &want.zero_jacobian,
                JACOBIAN,
            ),
            ("mass", all.mass.as_slice(), &self.mass, MASS),
            ("Coriolis", all.coriolis.as_slice(), &self.coriolis, TORQUE),
            ("gravity", all.gravity.as_slice(), &self.gravity, TORQUE),
        ] {
            case.near(&format!("one pass: {name}"), got, want, tolerance);
        }
    }
}
