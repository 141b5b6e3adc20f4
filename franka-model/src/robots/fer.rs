//! The Franka Emika Robot (FER, Panda).
//!
//! The robot contains a compiled model library. The numbers of the library do not correspond to any
//! set of seven physical bodies. Therefore this module has two models: a client model that matches
//! the library, and a physically possible model for simulation.

use super::Description;
use crate::geometry::Lengths;
use crate::inertia::RigidBody;
use crate::kind::RobotKind;
use crate::limits::{CartesianLimits, JointLimits, MotionLimits};
use crate::merge::Merge;
use crate::model::Model;
use crate::{JointVector, joint_vector};

pub(super) static FER: Description = Description {
    client: &CLIENT,
    physically_consistent: &PHYSICALLY_CONSISTENT,
    cartesian: CARTESIAN,
};

/// Model that matches the vendor's model library (libfranka 0.9, FCI version 5).
///
/// Source: `fer.urdf` of the crate franka-rs 0.4.0, identified from that library as exactly as
/// joint torques allow. Without a load it matches the library to 4e-15 kg·m² and 3e-14 N·m. Some
/// moments are negative, because only sums along the chain are meaningful.
static CLIENT: Model = Model {
    kind: RobotKind::Fer,
    base: BASE,
    links: [
        RigidBody::new(
            4.970684,
            [
                0.008212145719781648,
                -0.012489433728811434,
                -0.04762000000000013,
            ],
            [
                0.702616168960195,
                -0.0006889014261360759,
                0.005745380380637394,
                0.7063494182919353,
                0.02261787953853889,
                0.00252224154567267,
            ],
        ),
        RigidBody::new(
            0.6469260000000004,
            [
                -0.008847188777277989,
                -0.027478515098922834,
                -0.10845755996646182,
            ],
            [
                -0.010435853412563362,
                -0.005177260395266927,
                0.029034281597634885,
                0.01769709595829096,
                -0.0015692467290544213,
                0.032692302428138635,
            ],
        ),
        RigidBody::new(
            3.226078812759408,
            [
                0.02841819564298921,
                0.03858833128409879,
                -0.06679932425691104,
            ],
            [
                0.03931086918293672,
                -0.005053474288594204,
                -0.016811536796376148,
                0.037310455098084824,
                -0.013111663402157121,
                0.004872267100857771,
            ],
        ),
        RigidBody::new(
            3.588634337011673,
            [
                -0.052923582753299815,
                0.1041655281882056,
                0.028072528740131844,
            ],
            [
                0.01879326936772531,
                0.019613334939035772,
                -0.0005851665677740316,
                0.017929420205220613,
                0.007812946524814866,
                0.03591432048480523,
            ],
        ),
        RigidBody::new(
            1.224660602599113,
            [
                -0.00819919810222125,
                0.044849648534549445,
                -0.03912541618142476,
            ],
            [
                0.04250244229149407,
                -0.00418291650860753,
                -0.005749943950155883,
                0.027739448427164998,
                0.005555036692920862,
                0.0005098413569274763,
            ],
        ),
        RigidBody::new(
            1.665269602599113,
            [
                0.06064264248542852,
                -0.013792474511436911,
                -0.013276699467264706,
            ],
            [
                -0.003069941349005529,
                4.066514884184039e-05,
                -0.001354770129082226,
                0.0029132442028317164,
                0.0011252745943301765,
                0.0019853862104898127,
            ],
        ),
        RigidBody::new(
            0.7347474831348583,
            [
                0.008499343414525214,
                -0.0006345336526240304,
                0.060901871831290526,
            ],
            [
                0.0064418635784042975,
                0.001183620745107082,
                0.0021380029551365423,
                0.00815041377656671,
                -0.0006250487121552125,
                0.0012188799841693894,
            ],
        ),
    ],
    merge: Merge::WithoutOwnLever(LINK_7_INSIDE),
    joints: JOINTS,
    lengths: Lengths::DESCRIBED,
    origins: None,
};

/// Link 7 as in the vendor's library, in link axes. Only the composition of link 7 with a load
/// depends on these numbers.
///
/// The numbers were fitted to the library's mass matrices under one load of 1.23 kg. The fit has
/// three equations for two unknowns, and a residual of 4e-15 kg·m². For other loads, the only
/// confirmation is one published figure (7e-4 kg·m², compared with 7.1e-4 from this model).
const LINK_7_INSIDE: (f64, [f64; 3]) = (
    0.536221593609,
    [
        0.0116460643445825,
        -0.000869457720067336,
        0.0311908696917084,
    ],
);

/// Model with physical bodies, close to the vendor's library. At the 40 reference states without a
/// load, it deviates by at most 0.018 kg·m² (mass), 0.013 N·m (gravity) and 0.083 N·m (Coriolis).
///
/// The numbers come from a least-squares fit to the library's torques at 300 random states. It kept
/// every body's pseudo-inertia positive definite, and was regularised towards the feasible set of
/// Gaz, Cognetti, Oliva, Robuffo Giordano and De Luca, Dynamic Identification of the Franka Emika
/// Panda Robot, 2019.
static PHYSICALLY_CONSISTENT: Model = Model {
    kind: RobotKind::Fer,
    base: BASE,
    links: [
        RigidBody::new(
            4.970354,
            [5e-07, 3.59e-05, -0.047652],
            [0.70502529, 0.0, 8.1e-07, 0.70502481, 0.00025929, 0.00040048],
        ),
        RigidBody::new(
            1.339971,
            [-0.0045239, -0.0684121, -0.0096942],
            [
                0.01455775,
                -0.00320291,
                0.01817376,
                0.04344981,
                0.00114444,
                0.03732369,
            ],
        ),
        RigidBody::new(
            3.755393,
            [0.036031, 0.0141067, -0.0772646],
            [
                0.0651874,
                -0.00214599,
                -0.01866423,
                0.06982956,
                -0.00730604,
                0.00672224,
            ],
        ),
        RigidBody::new(
            2.208971,
            [-0.0540151, 0.1333629, 0.0131328],
            [
                0.03767756, 0.01736281, 0.00270846, 0.01538633, 0.00045951, 0.04676553,
            ],
        ),
        RigidBody::new(
            1.637217,
            [-0.0058058, 0.038485, -0.1813101],
            [
                0.03788828,
                -0.00166999,
                -0.0034508,
                0.03315715,
                -0.0039385,
                0.00650338,
            ],
        ),
        RigidBody::new(
            2.189568,
            [0.0495666, -0.0258961, -0.0062969],
            [
                0.00134257,
                0.00142883,
                -0.00050428,
                0.00304084,
                0.00027533,
                0.00377153,
            ],
        ),
        RigidBody::new(
            0.651877,
            [0.0098374, -0.0009174, 0.0169719],
            [
                0.00375885,
                0.00055624,
                0.00209887,
                0.00524609,
                -0.00074389,
                0.00228752,
            ],
        ),
    ],
    merge: Merge::Rigid,
    joints: JOINTS,
    lengths: Lengths::DESCRIBED,
    origins: None,
};

/// Source: `franka_description` 1.0.1, `robots/fer/inertials.yaml`.
const BASE: RigidBody = RigidBody::new(
    2.3966,
    [-0.0172, 0.0004, 0.0745],
    [0.009, 0.0, 0.002, 0.0115, 0.0, 0.0085],
);

/// Positions, velocities and torques come from the limits table of the FCI documentation for the
/// FER (`franka_description` 1.0.1, `robots/fer/joint_limits.yaml`), which has one pair of position
/// limits. The other limits come from libfranka 0.9, `rate_limiting.h`.
const JOINTS: JointLimits = JointLimits {
    lower: LOWER,
    upper: UPPER,
    hard_lower: LOWER,
    hard_upper: UPPER,
    velocity: joint_vector([2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61]),
    envelope: None,
    acceleration: joint_vector([15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0]),
    jerk: joint_vector([7500.0, 3750.0, 5000.0, 6250.0, 7500.0, 10000.0, 10000.0]),
    torque: joint_vector([87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0]),
    torque_rate: joint_vector([1000.0; 7]),
};

const LOWER: JointVector = joint_vector([
    -2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973,
]);
const UPPER: JointVector = joint_vector([2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973]);

/// Source: libfranka 0.9, `rate_limiting.h`. For the translation, the limits table of the FCI
/// documentation for the FER states 1.7 m/s, but the vendor's client uses 2.0 m/s.
const CARTESIAN: CartesianLimits = CartesianLimits {
    translation: MotionLimits {
        velocity: 2.0,
        acceleration: 13.0,
        jerk: 6500.0,
    },
    rotation: MotionLimits {
        velocity: 2.5,
        acceleration: 25.0,
        jerk: 12500.0,
    },
    elbow: MotionLimits {
        velocity: 2.175,
        acceleration: 10.0,
        jerk: 5000.0,
    },
};
