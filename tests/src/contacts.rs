//! Random contacts on a simulated arm, and their estimates from the external torques.

use std::fmt;

use franka_model::collision::{Body, Capsule, Shape};
use franka_model::contact::{Contact, Tare, TorqueError, Unknown, locate};
use franka_model::{EndEffector, Frame, JointVector, Model, RobotKind, transform};
use franka_sim::{Arm, Config, Robot, Tool, Touch};
use nalgebra::{Isometry3, Point3, Rotation3, UnitVector3, Vector3};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

/// A push on the arm.
#[derive(Debug, Clone)]
pub struct Push {
    /// The arm's.
    pub kind: RobotKind,
    /// Joint positions at the time of the push.
    pub q: JointVector,
    /// Body that is pushed.
    pub body: Body,
    /// Point of the push, `[m]`, base axes.
    pub point: Vector3<f64>,
    /// On the arm, `[N]`, base axes.
    pub force: Vector3<f64>,
}

/// Result for a push.
#[derive(Debug, Clone)]
pub struct Told {
    /// The push.
    pub push: Push,
    /// The estimate.
    pub contact: Result<Contact, Unknown>,
}

/// Errors of an estimate against the push.
#[derive(Debug, Clone, Copy)]
pub struct Errors {
    /// `[m]`
    pub place: f64,
    /// As a fraction of the force.
    pub force: f64,
}

impl Errors {
    /// The medians of these, not a number of none.
    pub fn medians(of: impl IntoIterator<Item = Self>) -> Self {
        let (places, forces) = of.into_iter().map(|it| (it.place, it.force)).unzip();
        let [place, force] = [places, forces].map(|mut values: Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
        });
        Self { place, force }
    }
}

impl fmt::Display for Errors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (place, force) = (self.place * 1e3, self.force * 1e2);
        write!(f, "median {place:.0} mm, {force:.0} % of the force")
    }
}

/// The arm with the Hand.
fn shape(kind: RobotKind) -> Shape<'static> {
    Shape::covering(kind).with_hand()
}

impl Push {
    /// A push of 5 to 40 N into the surface of a random posture, within 30 degrees of its normal.
    ///
    /// The surface is the surface of the capsules that contain the arm, or up to 15 mm below it:
    /// the estimate knows neither.
    pub fn random(kind: RobotKind, body: Body, random: &mut SmallRng) -> Self {
        let q = posture(kind, random);
        let placed = shape(kind).at(&q);
        let capsules: Vec<_> = placed.capsules().collect();
        loop {
            let own: Vec<_> = capsules.iter().filter(|(of, _)| *of == body).collect();
            let (_, capsule) = own[random.random_range(0..own.len())];
            let Some((point, normal)) = place(capsule, random) else {
                continue;
            };
            let nearby = |of: &Body| of.number().abs_diff(body.number()) <= 1;
            let covered = capsules
                .iter()
                .any(|(of, by)| nearby(of) && by != capsule && inside(by, &point));
            if covered {
                continue;
            }
            let point = point - normal.into_inner() * random.random_range(0.0..0.015);
            let size = random.random_range(5.0..40.0);
            // Uniform over the directions of the cone.
            let lean = random.random_range(CONE.cos()..1.0_f64).acos();
            let turn = random.random_range(0.0..std::f64::consts::TAU);
            let across = Vector3::from_fn(|_, _| random.random_range(-1.0..1.0)).cross(&normal);
            let Some(across) = UnitVector3::try_new(across, 1e-3) else {
                continue;
            };
            let force = Rotation3::from_axis_angle(&normal, turn)
                * Rotation3::from_axis_angle(&across, lean)
                * (-normal.into_inner() * size);
            return Self {
                kind,
                q,
                body,
                point,
                force,
            };
        }
    }

    /// The frame of the body that is pushed.
    fn frame(&self) -> Frame {
        match self.body {
            Body::Link(link) => Frame::ALL[usize::from(link) - 1],
            Body::Tool => Frame::Flange,
        }
    }

    /// The pose of that frame.
    fn pose(&self, q: &JointVector) -> Isometry3<f64> {
        let model = Model::physically_consistent(self.kind);
        let pose = model.pose(self.frame(), q, &EndEffector::default());
        transform::isometry(&pose).expect("rigid")
    }

    /// Point of the push on the pushed body, in the frame of the body, `[m]`.
    fn place(&self) -> Point3<f64> {
        self.pose(&self.q)
            .inverse_transform_point(&self.point.into())
    }

    /// Errors of this place and force against the push, on an arm at `q`.
    pub fn errors(&self, q: &JointVector, point: &Vector3<f64>, force: &Vector3<f64>) -> Errors {
        let pushed = self.pose(q) * self.place();
        Errors {
            place: (point - pushed.coords).norm(),
            force: (force - self.force).norm() / self.force.norm(),
        }
    }

    /// The push, for a simulated arm: it moves with the pushed body.
    pub fn touch(&self) -> Touch {
        let touch = Touch::force(self.force).at(self.frame());
        touch.offset(self.place().coords)
    }

    /// Torques on the joints, `[N·m]`.
    pub fn torque(&self) -> JointVector {
        let model = Model::physically_consistent(self.kind);
        let jacobian = model.zero_jacobian(self.frame(), &self.q, &EndEffector::default());
        let lever = self.point - self.pose(&self.q).translation.vector;
        let moment = lever.cross(&self.force);
        let linear = jacobian.fixed_rows::<3>(0).tr_mul(&self.force);
        linear + jacobian.fixed_rows::<3>(3).tr_mul(&moment)
    }

    /// Applies the push to an arm of its kind: half a second without contact, then the push for 0.3
    /// s.
    pub fn told(&self, arm: &Arm, seed: u64) -> Told {
        let mut robot = Robot::new(Config {
            kind: self.kind,
            q: self.q,
            tool: Tool::hand(),
            arm: Some(arm.clone()),
            seed,
            ..Config::default()
        });
        let mut tare = Tare::new();
        let mut read = |robot: &mut Robot, milliseconds: u32| {
            let mut left = JointVector::zeros();
            for _ in 0..milliseconds {
                robot.tick();
                let state = robot.state();
                let external = -JointVector::from(state.tau_ext_hat_filtered);
                left = tare.update(&external, &state.dq.into(), 1e-3);
            }
            left
        };
        read(&mut robot, 500);
        robot.touch(self.touch());
        let left = read(&mut robot, 300);
        let placed = shape(self.kind).at(&JointVector::from(robot.state().q));
        Told {
            push: self.clone(),
            contact: locate(&placed, &left, &TorqueError::AT_REST),
        }
    }
}

/// Half the opening of the cone of forces, `[rad]`.
const CONE: f64 = std::f64::consts::FRAC_PI_6;

fn posture(kind: RobotKind, random: &mut SmallRng) -> JointVector {
    let limits = Model::physically_consistent(kind).joint_limits();
    loop {
        let q = JointVector::from_fn(|i, _| {
            let (low, high) = (limits.lower[i], limits.upper[i]);
            let inset = 0.1 * (high - low);
            random.random_range(low + inset..high - inset)
        });
        if is_clear(&q) {
            return q;
        }
    }
}

/// True if the parts of an arm with the Hand are well away from each other.
pub fn is_clear(q: &JointVector) -> bool {
    Shape::vendor().with_hand().at(q).nearest_pair().distance > 0.03
}

/// A uniformly random place on a capsule, and the normal there.
fn place(capsule: &Capsule, random: &mut SmallRng) -> Option<(Vector3<f64>, UnitVector3<f64>)> {
    // In the box around it, until it is in the skin.
    let (r, skin) = (capsule.radius, 0.002);
    let low = capsule.start.inf(&capsule.end).add_scalar(-r);
    let high = capsule.start.sup(&capsule.end).add_scalar(r);
    let point = Vector3::from_fn(|i, _| random.random_range(low[i]..high[i]));
    let off = off_axis(capsule, &point);
    let distance = off.norm();
    (distance < r && distance > r - skin).then(|| (point, UnitVector3::new_normalize(off)))
}

fn off_axis(capsule: &Capsule, point: &Vector3<f64>) -> Vector3<f64> {
    let along = capsule.end - capsule.start;
    let square = along.norm_squared().max(1e-12);
    let share = ((point - capsule.start).dot(&along) / square).clamp(0.0, 1.0);
    point - capsule.start - along * share
}

fn inside(capsule: &Capsule, point: &Vector3<f64>) -> bool {
    off_axis(capsule, point).norm() < capsule.radius - 0.003
}

/// Pushes on links 1 to 7 and the Hand in turn, `count` in all.
pub fn pushes(kind: RobotKind, count: usize, seed: u64) -> Vec<Push> {
    let mut random = SmallRng::seed_from_u64(seed);
    (0..count)
        .map(|i| {
            let body = match i % 8 {
                7 => Body::Tool,
                link => Body::Link(link as u8 + 1),
            };
            Push::random(kind, body, &mut random)
        })
        .collect()
}
