//! The capsules of the arm and of the Hand, and the pairs of capsules that can meet.

use super::shape::Capsule;

/// A capsule in the frame of a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LinkCapsule {
    pub(super) link: u8,
    pub(super) capsule: Capsule,
    /// Difference between the radius and the radius fitted to the link's surface, `[m]`. It is 0 if
    /// the capsule was not fitted.
    pub(super) margin: f64,
}

const fn link(link: u8, start: [f64; 3], end: [f64; 3], radius: f64) -> LinkCapsule {
    LinkCapsule {
        link,
        capsule: Capsule::new(start, end, radius),
        margin: 0.0,
    }
}

/// Returns a capsule that was fitted to the surface of a link with the radius `fit`, enlarged by
/// `margin` so that it contains the link.
const fn covering(link: u8, start: [f64; 3], end: [f64; 3], fit: f64, margin: f64) -> LinkCapsule {
    LinkCapsule {
        link,
        capsule: Capsule::new(start, end, fit + margin),
        margin,
    }
}

/// Largest number of capsules of an arm.
pub(super) const ARM_MAX: usize = FR3.len();

/// The outermost link against which a tool is checked. Only the last two joints move the tool
/// relative to this link.
pub(super) const TOOL_MEETS: u8 = 5;

/// Pairs of the vendor's capsules. [`Shape::vendor`] states how they were selected; the tests
/// repeat this search.
pub(super) static VENDOR_PAIRS: [(u8, u8); 23] = pairs(
    &VENDOR,
    &[
        (0, 5),
        (0, 6),
        (0, 7),
        (1, 5),
        (1, 6),
        (1, 7),
        (2, 5),
        (2, 6),
        (2, 7),
        (3, 5),
        (3, 7),
        (5, 7),
    ],
);

/// Pairs of the covering capsules of both robots; see [`Shape::covering`].
pub(super) static COVERING_PAIRS: [(u8, u8); 42] = pairs(
    &FR3,
    &[
        (0, 5),
        (0, 6),
        (0, 7),
        (1, 5),
        (1, 6),
        (1, 7),
        (2, 5),
        (2, 6),
        (2, 7),
    ],
);

// One list of pairs is valid for both robots, because their capsules are on the same links, in the
// same order.
const _: () = {
    assert!(FR3.len() == FER.len());
    let mut i = 0;
    while i < FR3.len() {
        assert!(FR3[i].link == FER[i].link);
        i += 1;
    }
};

/// Returns the `N` pairs of capsules on the given pairs of links.
const fn pairs<const N: usize>(capsules: &[LinkCapsule], links: &[(u8, u8)]) -> [(u8, u8); N] {
    let mut pairs = [(0, 0); N];
    let mut count = 0;
    let mut row = 0;
    while row < links.len() {
        let (inner, outer) = links[row];
        let mut a = 0;
        while a < capsules.len() {
            let mut b = 0;
            while b < capsules.len() {
                if capsules[a].link == inner && capsules[b].link == outer {
                    pairs[count] = (a as u8, b as u8);
                    count += 1;
                }
                b += 1;
            }
            a += 1;
        }
        row += 1;
    }
    assert!(count == N);
    pairs
}

/// Sine and cosine of the Hand's turn on the flange.
const HALF: f64 = core::f64::consts::FRAC_1_SQRT_2;

/// Returns a capsule of the Hand in the flange frame, after `RotZ(-45°)`.
const fn on_hand(start: [f64; 3], end: [f64; 3], radius: f64) -> Capsule {
    const fn turned([x, y, z]: [f64; 3]) -> [f64; 3] {
        [HALF * (x + y), HALF * (y - x), z]
    }
    Capsule::new(turned(start), turned(end), radius)
}

/// The vendor's capsules of the Hand. Source: `franka_description` 1.0.1,
/// `end_effectors/common/franka_hand.xacro`.
pub(super) static VENDOR_HAND: [Capsule; 2] = [
    on_hand([0.0, -0.05, 0.04], [0.0, 0.05, 0.04], 0.04),
    on_hand([0.0, -0.05, 0.1], [0.0, 0.05, 0.1], 0.02),
];

/// Capsules that contain the Hand. The body's capsule was fitted as the links' capsules. The
/// fingers have the vendor's capsule, and a second one where they join the body.
pub(super) static COVERING_HAND: [Capsule; 3] = [
    on_hand(
        [-0.0007, -0.0702, 0.0228],
        [0.0001, 0.0673, 0.0254],
        0.0363 + 0.0150,
    ),
    on_hand([0.0, -0.05, 0.08], [0.0, 0.05, 0.08], 0.02),
    on_hand([0.0, -0.05, 0.1], [0.0, 0.05, 0.1], 0.02),
];

/// The vendor's capsules, the same for the FER and the FR3. Source: `franka_description` 1.0.1,
/// `robots/common/franka_arm.xacro`, with a safety distance of 0. The second capsule of link 7
/// includes the 45° turn of its sub-link.
pub(super) static VENDOR: [LinkCapsule; 10] = [
    link(0, [-0.09, 0.0, 0.06], [-0.06, 0.0, 0.06], 0.06),
    link(1, [0.0, 0.0, -0.333], [0.0, 0.0, -0.05], 0.06),
    link(2, [0.0, 0.0, -0.06], [0.0, 0.0, 0.06], 0.06),
    link(3, [0.0, 0.0, -0.22], [0.0, 0.0, -0.07], 0.06),
    link(4, [0.0, 0.0, -0.06], [0.0, 0.0, 0.06], 0.06),
    link(5, [0.0, 0.0, -0.31], [0.0, 0.0, -0.21], 0.06),
    link(5, [0.0, 0.08, -0.2], [0.0, 0.08, -0.06], 0.025),
    link(6, [0.0, 0.0, -0.07], [0.0, 0.0, 0.01], 0.05),
    link(7, [0.0, 0.0, -0.06], [0.0, 0.0, 0.08], 0.04),
    link(
        7,
        [0.03889, 0.03889, 0.082],
        [0.04596, 0.04596, 0.082],
        0.03,
    ),
];

/// Franka Research 3: capsules fitted to the surface of the collision meshes of
/// `franka_description` 1.0.1 by least squares. The margin is the largest distance, rounded up, by
/// which the link's collision and visual meshes extend beyond the fit.
pub(super) static FR3: [LinkCapsule; 17] = [
    covering(
        0,
        [-0.0956, 0.0267, 0.0282],
        [-0.0892, -0.0342, 0.0295],
        0.0432,
        0.0341,
    ),
    covering(
        0,
        [-0.0071, 0.0009, 0.0446],
        [-0.0089, 0.0003, 0.0806],
        0.0721,
        0.0341,
    ),
    covering(
        1,
        [-0.0001, 0.0024, -0.1554],
        [-0.0003, -0.0197, -0.1023],
        0.0543,
        0.0183,
    ),
    covering(
        1,
        [0.0002, -0.0439, -0.0045],
        [-0.0003, -0.0678, -0.0057],
        0.0598,
        0.0183,
    ),
    covering(
        2,
        [-0.0007, 0.0147, -0.0367],
        [-0.0003, 0.0024, 0.0886],
        0.0449,
        0.0174,
    ),
    covering(
        2,
        [-0.0003, 0.0036, 0.0627],
        [0.0001, -0.1598, -0.0042],
        0.0523,
        0.0174,
    ),
    covering(
        3,
        [0.0004, 0.0004, -0.0883],
        [0.0031, 0.0019, -0.0674],
        0.0535,
        0.0165,
    ),
    covering(
        3,
        [0.0816, 0.0384, -0.0024],
        [0.079, 0.0574, -0.0046],
        0.0555,
        0.0165,
    ),
    covering(
        4,
        [-0.004, 0.0031, 0.0571],
        [-0.0004, 0.0001, 0.0389],
        0.0555,
        0.0149,
    ),
    covering(
        4,
        [-0.0796, 0.0662, 0.002],
        [-0.082, 0.0882, 0.0005],
        0.054,
        0.0149,
    ),
    covering(
        5,
        [0.0011, 0.0, -0.224],
        [-0.0005, 0.0206, -0.2127],
        0.0523,
        0.0162,
    ),
    covering(
        5,
        [-0.001, 0.067, -0.1855],
        [-0.0, 0.0994, -0.051],
        0.0281,
        0.0162,
    ),
    covering(
        5,
        [-0.0001, 0.0538, -0.0],
        [0.0001, 0.085, 0.0001],
        0.0502,
        0.0162,
    ),
    covering(
        6,
        [0.0239, 0.0067, 0.0154],
        [-0.0044, -0.0014, 0.0129],
        0.045,
        0.0152,
    ),
    covering(
        6,
        [0.0835, 0.0412, -0.001],
        [0.0862, -0.0219, -0.0007],
        0.0443,
        0.0152,
    ),
    covering(
        7,
        [0.0219, -0.0026, 0.0757],
        [-0.0087, -0.0174, 0.0756],
        0.0302,
        0.0135,
    ),
    covering(
        7,
        [-0.0211, 0.0089, 0.0744],
        [0.0454, 0.0431, 0.0809],
        0.0274,
        0.0135,
    ),
];

/// Franka Emika Robot: capsules fitted to the surface of the collision meshes of
/// `franka_description` 1.0.1 by least squares. The margin is the largest distance, rounded up, by
/// which the link's visual mesh extends beyond the fit.
pub(super) static FER: [LinkCapsule; 17] = [
    covering(
        0,
        [-0.0969, -0.041, 0.0288],
        [-0.1019, 0.038, 0.0269],
        0.0407,
        0.0287,
    ),
    covering(
        0,
        [-0.0111, -0.0006, 0.0543],
        [-0.0135, -0.0006, 0.0676],
        0.082,
        0.0287,
    ),
    covering(
        1,
        [-0.0003, 0.0023, -0.1516],
        [0.0001, -0.0358, 0.0009],
        0.0568,
        0.0125,
    ),
    covering(
        1,
        [0.0, -0.0149, -0.1499],
        [0.0001, -0.0757, -0.0002],
        0.0542,
        0.0125,
    ),
    covering(
        2,
        [0.0002, -0.0006, 0.0323],
        [-0.0001, -0.0045, 0.0741],
        0.0566,
        0.0137,
    ),
    covering(
        2,
        [-0.0001, -0.0493, 0.0379],
        [-0.0004, -0.1472, 0.0053],
        0.0629,
        0.0137,
    ),
    covering(
        3,
        [0.0016, 0.0011, -0.0771],
        [0.0237, 0.0131, -0.0701],
        0.0589,
        0.0133,
    ),
    covering(
        3,
        [0.033, 0.0174, -0.0495],
        [0.0795, 0.0454, -0.0027],
        0.0628,
        0.0133,
    ),
    covering(
        4,
        [-0.0678, 0.0695, 0.0075],
        [-0.0026, 0.0035, 0.0447],
        0.0632,
        0.0174,
    ),
    covering(
        4,
        [-0.1089, 0.0996, 0.0149],
        [-0.097, 0.1007, -0.0268],
        0.0307,
        0.0174,
    ),
    covering(
        5,
        [-0.0102, 0.0429, 0.0109],
        [-0.0159, -0.0103, -0.2315],
        0.0391,
        0.0160,
    ),
    covering(
        5,
        [0.0001, 0.0233, -0.216],
        [-0.0001, 0.0812, -0.0009],
        0.0529,
        0.0160,
    ),
    covering(
        5,
        [0.0106, 0.0438, 0.008],
        [0.0132, -0.0127, -0.2313],
        0.0399,
        0.0160,
    ),
    covering(
        6,
        [0.0499, -0.0084, 0.0086],
        [0.0012, 0.0028, 0.0126],
        0.049,
        0.0118,
    ),
    covering(
        6,
        [0.0881, -0.0153, 0.0003],
        [0.0761, 0.0401, 0.002],
        0.0472,
        0.0118,
    ),
    covering(
        7,
        [-0.0126, -0.0184, 0.0781],
        [0.0277, 0.0007, 0.0785],
        0.0308,
        0.0113,
    ),
    covering(
        7,
        [0.042, 0.0427, 0.0825],
        [-0.0194, 0.0097, 0.077],
        0.0294,
        0.0113,
    ),
];
