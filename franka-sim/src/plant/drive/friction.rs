//! The friction on one side of a joint: the motor's or the link's.

use crate::arm::Friction;

/// Friction parameters of one side, and the deflection of its bristles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contact {
    /// Breakaway torque, `[N·m]`.
    static_torque: f64,
    /// Torque while sliding fast, `[N·m]`.
    kinetic_torque: f64,
    /// Speed at which friction falls from static to kinetic, `[rad/s]`.
    stribeck_speed: f64,
    /// Viscous friction, `[N·m·s/rad]`.
    viscous: f64,
    bristle: Option<Bristle>,
}

#[derive(Debug, Clone, Copy)]
struct Bristle {
    /// Stiffness of the bristles, `[N·m/rad]`.
    stiffness: f64,
    /// Damping of the bristles, `[N·m·s/rad]`.
    damping: f64,
    /// Current deflection of the bristles, `[rad]`.
    deflection: f64,
}

/// A friction torque for an implicit step. If the velocity at the end of the step rises by `a`, the
/// torque rises by `slope · a`.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Tangent {
    /// Friction torque, `[N·m]`.
    pub(super) torque: f64,
    /// Increase of the torque with the velocity, `[N·m·s/rad]`.
    pub(super) slope: f64,
}

impl Contact {
    /// Returns this share of the friction of joint `i`, with unloaded bristles; `None` if the share
    /// is zero.
    pub(super) fn new(friction: &Friction, i: usize, share: f64) -> Option<Self> {
        (share > 0.0).then(|| Self {
            static_torque: friction.static_torque[i] * share,
            kinetic_torque: friction.kinetic_torque[i] * share,
            stribeck_speed: friction.stribeck_speed[i],
            viscous: friction.viscous[i] * share,
            bristle: friction.bristle.map(|bristle| Bristle {
                stiffness: bristle.stiffness[i] * share,
                damping: bristle.damping[i] * share,
                deflection: 0.0,
            }),
        })
    }

    pub(super) fn unload(&mut self) {
        if let Some(bristle) = &mut self.bristle {
            bristle.deflection = 0.0;
        }
    }

    /// Returns the torque over a step of `dt` seconds that begins at the velocity `v`, for a side
    /// with at least the inertia `inertia`.
    ///
    /// While a side sticks, its torque is the bristles' torque at the end of the step. While it
    /// slides, its torque follows the Stribeck curve. If a side stops within the step, the slope
    /// keeps it inside the range in which it sticks.
    pub(super) fn tangent(&self, v: f64, inertia: f64, dt: f64) -> Tangent {
        let Some(bristle) = &self.bristle else {
            let shape = (v / self.stribeck_speed).tanh();
            let steepness = (1.0 - shape * shape) / self.stribeck_speed;
            return Tangent {
                torque: self.kinetic_torque * shape + self.viscous * v,
                slope: self.kinetic_torque * steepness + self.viscous,
            };
        };
        let stuck = bristle.stiffness * dt + bristle.damping;
        let torque = bristle.stiffness * bristle.deflection + stuck * v;
        let limit = self.limit(v);
        let slope = if torque.abs() < limit {
            stuck
        } else {
            (stuck - inertia / dt).max(0.0)
        };
        Tangent {
            torque: torque.clamp(-limit, limit) + self.viscous * v,
            slope: slope + self.viscous,
        }
    }

    /// Advances the bristles by a step of `dt` seconds that ends with the velocity `v`, and returns
    /// their torque at its end.
    pub(super) fn advance(&mut self, v: f64, dt: f64) -> f64 {
        let Some(bristle) = self.bristle else {
            return 0.0;
        };
        let Bristle {
            stiffness,
            damping,
            deflection,
        } = bristle;
        let limit = self.limit(v);
        let torque = stiffness * deflection + (stiffness * dt + damping) * v;
        let torque = torque.clamp(-limit, limit);
        let deflection = (torque + damping * deflection / dt) / (stiffness + damping / dt);
        self.bristle = Some(Bristle {
            deflection,
            ..bristle
        });
        torque
    }

    /// The Stribeck curve: the torque at which bristles yield.
    fn limit(&self, v: f64) -> f64 {
        let ratio = v / self.stribeck_speed;
        let excess = self.static_torque - self.kinetic_torque;
        self.kinetic_torque + excess * (-ratio * ratio).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm;
    use franka_model::JointVector;

    const STEP: f64 = 0.000_25;

    fn friction(stiffness: f64, damping: f64) -> Friction {
        Friction {
            static_torque: JointVector::repeat(1.0),
            kinetic_torque: JointVector::repeat(0.7),
            stribeck_speed: JointVector::repeat(0.05),
            viscous: JointVector::repeat(0.3),
            bristle: Some(arm::Bristle {
                stiffness: JointVector::repeat(stiffness),
                damping: JointVector::repeat(damping),
            }),
            link_share: JointVector::zeros(),
        }
    }

    /// A body that is held only by friction.
    struct Body {
        contact: Contact,
        inertia: f64,
        v: f64,
        angle: f64,
        /// Torque of the friction in the last step.
        torque: f64,
    }

    impl Body {
        fn new(friction: &Friction, inertia: f64) -> Self {
            Self {
                contact: Contact::new(friction, 0, 1.0).expect("a share"),
                inertia,
                v: 0.0,
                angle: 0.0,
                torque: 0.0,
            }
        }

        fn step(&mut self, torque: f64) {
            let tangent = self.contact.tangent(self.v, self.inertia, STEP);
            let effective = self.inertia + STEP * tangent.slope;
            let acceleration = (torque - tangent.torque) / effective;
            self.v += STEP * acceleration;
            self.angle += STEP * self.v;
            self.torque = self.contact.advance(self.v, STEP) + 0.3 * self.v;
        }
    }

    #[test]
    fn a_torque_below_the_static_one_moves_nothing_for_minutes() {
        for (stiffness, inertia) in [(1e3, 0.1), (1e4, 1.2e-4), (1e4, 2e-3), (4e3, 3.0)] {
            let mut body = Body::new(&friction(stiffness, 5.0), inertia);
            let mut from = 0.0;
            for torque in [0.5, -0.9, 0.97] {
                // A ramp of four seconds, then time for a heavy body to settle.
                for step in 0..160_000 {
                    let way = (f64::from(step) / 16_000.0).min(1.0);
                    body.step(from + (torque - from) * way);
                }
                assert!((body.angle * stiffness - torque).abs() < 1e-6);
                from = torque;
                let angle = body.angle;
                for _ in 0..120 * 4000 {
                    body.step(torque);
                    assert!(body.v.abs() < 1e-9, "{} rad/s", body.v);
                }
                assert!((body.angle - angle).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn vibration_below_the_static_torque_does_not_make_it_creep() {
        let mut body = Body::new(&friction(2e3, 5.0), 0.1);
        let mut run = |seconds: u32| {
            for step in 0..seconds * 4000 {
                // Twenty steps per period, and whole periods.
                let phase = core::f64::consts::TAU * f64::from(step) / 20.0;
                body.step(0.6 + 0.3 * phase.sin());
            }
            body.angle
        };
        let from = run(1);
        assert!((run(20) - from).abs() < 1e-9);
    }

    #[test]
    fn sliding_body_comes_to_rest_without_chatter() {
        for (stiffness, damping, inertia) in [
            (1e4, 5.0, 1.2e-4),
            (1e4, 0.0, 1.2e-4),
            (1e3, 5.0, 1.2e-4),
            (4e3, 5.0, 2e-3),
            (1e3, 5.0, 0.07),
            (2e3, 5.0, 0.6),
        ] {
            let mut body = Body::new(&friction(stiffness, damping), inertia);
            body.v = 2.0;
            let (mut energy, mut most) = (inertia * 4.0, 0.0_f64);
            for _ in 0..40_000 {
                body.step(0.0);
                most = most.max(body.torque.abs() - 0.3 * body.v.abs());
                let stretch = body.contact.bristle.expect("one").deflection;
                let now = inertia * body.v * body.v + stiffness * stretch * stretch;
                let was = energy;
                energy = now;
                // Bristles absorb energy up to the yield point; the friction must not release more.
                assert!(now <= was + 1.0 / stiffness, "{now} J after {was} J");
            }
            assert!(most <= 1.0 + 1e-9, "{most} N m");
            assert!(
                body.v.abs() < 1e-9,
                "{stiffness} {inertia}: {} rad/s",
                body.v
            );
        }
    }

    #[test]
    fn friction_breaks_away_at_static_torque_and_then_drops() {
        let mut body = Body::new(&friction(2e3, 5.0), 0.1);
        let mut torque = 0.0;
        while body.v < 1e-3 {
            torque += 0.05 * STEP;
            body.step(torque);
        }
        assert!((torque - 1.0).abs() < 0.01, "{torque} N m");
        // Steady speeds, which a velocity loop maintains.
        let mut resistance = |speed: f64| {
            let mut torque = 0.0;
            for _ in 0..8000 {
                torque = 50.0 * (speed - body.v) + body.torque;
                body.step(torque);
            }
            torque
        };
        let [slow, middle, fast] = [0.005, 0.15, 2.0].map(&mut resistance);
        assert!((slow - 1.0).abs() < 0.01, "{slow}");
        assert!((middle - 0.745).abs() < 0.01, "{middle}: the dip");
        assert!((fast - 1.3).abs() < 0.01, "{fast}");
    }
}
