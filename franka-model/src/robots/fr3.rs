//! The Franka Research 3.

use super::Description;
use crate::geometry::Lengths;
use crate::inertia::RigidBody;
use crate::joint_vector;
use crate::kind::RobotKind;
use crate::limits::{BrakingEnvelope, CartesianLimits, JointLimits, MotionLimits};
use crate::merge::Merge;
use crate::model::Model;

pub(super) static FR3: Description = Description {
    client: &MODEL,
    physically_consistent: &MODEL,
    cartesian: CARTESIAN,
};

/// Source: the URDF of libfranka 0.21 (`test/fr3.urdf`), identical to `franka_description` 1.0.1,
/// `robots/fr3/inertials.yaml`. Link 7 is close to a rod: its smallest principal moment is
/// 1.0e-6 kg·m².
static MODEL: Model = Model {
    kind: RobotKind::Fr3,
    base: RigidBody::new(
        2.3966,
        [-0.0172, 0.0004, 0.0745],
        [0.009, 0.0, 0.002, 0.0115, 0.0, 0.0085],
    ),
    links: [
        RigidBody::new(
            2.9274653454,
            [4.128e-07, -0.0181251324, -0.038603597],
            [
                0.023927316485107913,
                1.3317903455714081e-05,
                -0.00011404774918616684,
                0.0224821613275756,
                -0.0019950320628240115,
                0.006350098258530016,
            ],
        ),
        RigidBody::new(
            2.9355370338,
            [0.0031828864, -0.0743221644, 0.0088146084],
            [
                0.041938946257609425,
                0.00020257331521090626,
                0.004077784227179924,
                0.02514514885014724,
                -0.0042252158006570156,
                0.06170214472888839,
            ],
        ),
        RigidBody::new(
            2.2449013699,
            [0.0407015686, -0.0048200565, -0.0289730823],
            [
                0.02410142547240885,
                0.002404694559042109,
                -0.002856269270114313,
                0.01974053266708178,
                -0.002104212683891874,
                0.019044494482244823,
            ],
        ),
        RigidBody::new(
            2.6155955791,
            [-0.0459100965, 0.063049296, -0.0085187868],
            [
                0.03452998321913202,
                0.01322552265982813,
                0.01015142998484113,
                0.028881621933049058,
                -0.0009762833870704552,
                0.04125471171146641,
            ],
        ),
        RigidBody::new(
            2.3271207594,
            [-0.0016039605, 0.0292536262, -0.097296599],
            [
                0.051610278463662895,
                -0.005715173387783472,
                -0.0035673167625872135,
                0.04787729713371481,
                0.010673985108535986,
                0.016423625579357254,
            ],
        ),
        RigidBody::new(
            1.8170376524,
            [0.0597131221, -0.0410294666, -0.0101692726],
            [
                0.005412333594383447,
                0.006193456360285834,
                0.0014219289306117652,
                0.014058329545509979,
                -0.0013140753741120031,
                0.016080817924212554,
            ],
        ),
        RigidBody::new(
            0.6271432862,
            [0.0045225817, 0.0086261921, -0.0161633251],
            [
                0.00021092389150104718,
                -2.433299114461931e-05,
                4.564480393778983e-05,
                0.00017718568002411474,
                8.744070223226438e-05,
                5.993190599659971e-05,
            ],
        ),
    ],
    merge: Merge::Rigid,
    joints: JOINTS,
    lengths: Lengths::DESCRIBED,
    origins: None,
};

/// `lower` and `upper` come from the limits table of the FCI documentation (`franka_description`
/// 1.0.1, `robots/fr3/joint_limits.yaml`). `hard_*`, `velocity`, `envelope` and `torque` come from
/// the robot's URDF (libfranka 0.21, `test/fr3.urdf`). The other limits come from libfranka 0.21,
/// `rate_limiting.h`.
const JOINTS: JointLimits = JointLimits {
    lower: joint_vector([-2.7437, -1.7837, -2.9007, -3.0421, -2.8065, 0.5445, -3.0159]),
    upper: joint_vector([2.7437, 1.7837, 2.9007, -0.1518, 2.8065, 4.5169, 3.0159]),
    hard_lower: joint_vector([
        -2.7501, -1.7918, -2.9065, -3.0481, -2.8101, 0.54092, -3.0196,
    ]),
    hard_upper: joint_vector([2.7501, 1.7918, 2.9065, -0.1458, 2.8101, 4.5205, 3.0196]),
    velocity: joint_vector([2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26]),
    envelope: Some(BrakingEnvelope {
        deceleration: joint_vector([6.0, 2.585, 3.5, 4.0, 17.0, 5.5, 17.0]),
        offset: joint_vector([0.3, 0.2, 0.2, 0.3, 0.35, 0.35, 0.35]),
    }),
    acceleration: joint_vector([10.0; 7]),
    jerk: joint_vector([5000.0; 7]),
    torque: joint_vector([87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0]),
    torque_rate: joint_vector([1000.0; 7]),
};

/// Joints of a robot with system 5.9 or later. `lower`, `upper` and the offsets of the envelope
/// come from the vendor's documentation of 2025-10-14. No source publishes the hard range of these
/// systems. `hard_*` are therefore assumed to be the documented range plus the margins of
/// [`JOINTS`]. The other limits are unchanged.
pub(super) static JOINTS_5_9: JointLimits = JointLimits {
    lower: joint_vector([-2.9007, -1.8361, -2.9007, -3.077, -2.8763, 0.4398, -3.0508]),
    upper: joint_vector([2.9007, 1.8361, 2.9007, -0.1169, 2.8763, 4.6216, 3.0508]),
    hard_lower: joint_vector([-2.9071, -1.8442, -2.9065, -3.083, -2.8799, 0.43622, -3.0545]),
    hard_upper: joint_vector([2.9071, 1.8442, 2.9065, -0.1109, 2.8799, 4.6252, 3.0545]),
    envelope: Some(BrakingEnvelope {
        deceleration: joint_vector([6.0, 2.585, 3.5, 4.0, 17.0, 5.5, 17.0]),
        offset: joint_vector([0.6599, 0.2517, 0.2, 0.3533, 0.5757, 0.4878, 0.4628]),
    }),
    ..JOINTS
};

/// libfranka 0.21, `rate_limiting.h`.
const CARTESIAN: CartesianLimits = CartesianLimits {
    translation: MotionLimits {
        velocity: 3.0,
        acceleration: 9.0,
        jerk: 4500.0,
    },
    rotation: MotionLimits {
        velocity: 2.5,
        acceleration: 17.0,
        jerk: 8500.0,
    },
    elbow: MotionLimits {
        velocity: 1.5,
        acceleration: 10.0,
        jerk: 5000.0,
    },
};
