//! Composition of a load and link 7 into one body.

use nalgebra::Vector3;

use crate::inertia::{RigidBody, Symmetric3};

/// Rule that composes a load and link 7. The mass and the first moment, and therefore gravity, are
/// the same with both rules.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Merge {
    /// The physical rule: the inertias about the common centre of mass add up.
    Rigid,
    /// The rule of the FER's model library. The numbers are the mass and the centre of mass of link
    /// 7 in this library. Link 7 keeps its inertia about its own centre of mass, regardless of the
    /// distance to the common centre.
    WithoutOwnLever((f64, [f64; 3])),
}

impl Merge {
    /// Returns `link` and `load`, both in the axes of link 7, as one body.
    pub(crate) fn join(&self, link: &RigidBody, load: &RigidBody) -> RigidBody {
        let mut joined = link.joined(load);
        if let Self::WithoutOwnLever((mass, com)) = *self {
            let lever = (load.com - Vector3::from(com)) * (load.mass / (mass + load.mass));
            joined.inertia += Symmetric3::of_point(-mass, &lever);
        }
        joined
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINK: RigidBody = RigidBody::new(
        0.5,
        [0.01, -0.02, 0.03],
        [2e-3, 1e-4, -2e-4, 3e-3, 4e-4, 1e-3],
    );
    const LOAD: RigidBody =
        RigidBody::new(1.5, [0.02, 0.05, 0.13], [4e-3, 0.0, 0.0, 5e-3, 0.0, 6e-3]);

    #[test]
    fn merge_without_own_lever_keeps_inertias_and_load_lever() {
        let rule = Merge::WithoutOwnLever((LINK.mass, LINK.com.into()));
        let joined = rule.join(&LINK, &LOAD);
        let levered = Symmetric3::of_point(LOAD.mass, &(LOAD.com - joined.com));
        let expected = LINK.inertia.matrix() + LOAD.inertia.matrix() + levered.matrix();
        assert!((joined.inertia.matrix() - expected).amax() < 1e-17);
    }

    #[test]
    fn mass_and_centre_do_not_depend_on_the_rule() {
        let rigid = Merge::Rigid.join(&LINK, &LOAD);
        let other = Merge::WithoutOwnLever((0.3, [0.0, 0.0, 0.02])).join(&LINK, &LOAD);
        assert_eq!((rigid.mass, rigid.com), (other.mass, other.com));
        assert_ne!(rigid.inertia, other.inertia);
    }
}
