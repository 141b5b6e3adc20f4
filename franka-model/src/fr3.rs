//! Inertial parameters of the Franka Research 3.
//!
//! Source: the URDF of libfranka 0.21 (`test/fr3.urdf`), identical to `franka_description` 1.0.1,
//! `robots/fr3/inertials.yaml`. Each body in the axes of its link, the inertia about its centre of
//! mass. Link 7 is close to a rod: its smallest principal moment is 1.0e-6 kg·m².

use nalgebra::Vector3;

use crate::inertia::{RigidBody, Symmetric3};

/// Links 1 to 7.
pub(crate) const LINKS: [RigidBody; 7] = [
    RigidBody {
        mass: 2.9274653454,
        com: Vector3::new(4.128e-07, -0.0181251324, -0.038603597),
        inertia: Symmetric3 {
            xx: 0.023927316485107913,
            xy: 1.3317903455714081e-05,
            xz: -0.00011404774918616684,
            yy: 0.0224821613275756,
            yz: -0.0019950320628240115,
            zz: 0.006350098258530016,
        },
    },
    RigidBody {
        mass: 2.9355370338,
        com: Vector3::new(0.0031828864, -0.0743221644, 0.0088146084),
        inertia: Symmetric3 {
            xx: 0.041938946257609425,
            xy: 0.00020257331521090626,
            xz: 0.004077784227179924,
            yy: 0.02514514885014724,
            yz: -0.0042252158006570156,
            zz: 0.06170214472888839,
        },
    },
    RigidBody {
        mass: 2.2449013699,
        com: Vector3::new(0.0407015686, -0.0048200565, -0.0289730823),
        inertia: Symmetric3 {
            xx: 0.02410142547240885,
            xy: 0.002404694559042109,
            xz: -0.002856269270114313,
            yy: 0.01974053266708178,
            yz: -0.002104212683891874,
            zz: 0.019044494482244823,
        },
    },
    RigidBody {
        mass: 2.6155955791,
        com: Vector3::new(-0.0459100965, 0.063049296, -0.0085187868),
        inertia: Symmetric3 {
            xx: 0.03452998321913202,
            xy: 0.01322552265982813,
            xz: 0.01015142998484113,
            yy: 0.028881621933049058,
            yz: -0.0009762833870704552,
            zz: 0.04125471171146641,
        },
    },
    RigidBody {
        mass: 2.3271207594,
        com: Vector3::new(-0.0016039605, 0.0292536262, -0.097296599),
        inertia: Symmetric3 {
            xx: 0.051610278463662895,
            xy: -0.005715173387783472,
            xz: -0.0035673167625872135,
            yy: 0.04787729713371481,
            yz: 0.010673985108535986,
            zz: 0.016423625579357254,
        },
    },
    RigidBody {
        mass: 1.8170376524,
        com: Vector3::new(0.0597131221, -0.0410294666, -0.0101692726),
        inertia: Symmetric3 {
            xx: 0.005412333594383447,
            xy: 0.006193456360285834,
            xz: 0.0014219289306117652,
            yy: 0.014058329545509979,
            yz: -0.0013140753741120031,
            zz: 0.016080817924212554,
        },
    },
    RigidBody {
        mass: 0.6271432862,
        com: Vector3::new(0.0045225817, 0.0086261921, -0.0161633251),
        inertia: Symmetric3 {
            xx: 0.00021092389150104718,
            xy: -2.433299114461931e-05,
            xz: 4.564480393778983e-05,
            yy: 0.00017718568002411474,
            yz: 8.744070223226438e-05,
            zz: 5.993190599659971e-05,
        },
    },
];
