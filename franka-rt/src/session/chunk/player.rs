//! Computes the desired state of the current chunk at each time of the robot, and blends a new
//! chunk into the previous motion.

use core::time::Duration;

use super::curve::Curve;
use super::curve_state::CurveState;
use super::pace::{Pace, PathTime};
use super::value::{Chunk, Origin, milliseconds};
use crate::shaping::CYCLE;

/// Longest time in which the previous motion fades out on the way to the first point, `[s]`.
/// Without this limit, the previous motion would continue for half of the time to a distant point.
const LET_GO: f64 = 1.0;

/// A chunk that the session follows or followed.
#[derive(Debug)]
pub(super) struct Player<M: CurveState> {
    curve: Curve<M>,
    /// `message_id`, the robot's time, at the curve's origin.
    origin: u64,
    /// Original origin, blend and pace of the chunk, to return it to the writer.
    asked: (Origin, Duration, Option<Pace>),
    /// Time along the path, if the chunk is a path.
    own: Option<PathTime>,
    entry: Entry<M>,
}

/// Transition from the previous motion to the curve, with times as in the curve.
#[derive(Debug)]
enum Entry<M: CurveState> {
    /// The reference turns to the curve at once.
    Turn,
    /// The first point is in the future. The arm approaches it since the time `since`.
    Approach { from: M, since: f64 },
    /// The distance from the curve at the time `since` fades out within `duration`.
    Blend {
        gap: M::Gap,
        since: f64,
        duration: f64,
    },
}

impl<M: CurveState> Player<M> {
    /// Begins to follow a chunk through `curve`, while the state `now` is answered. In the previous
    /// answer, the reference was at `reference`, and the previous chunk's desired state was
    /// `wanted`.
    ///
    /// The motion begins at whichever of these two places is nearer to the chunk. If the reference
    /// lagged behind the previous chunk, it still catches up that lag within its limits while it
    /// follows the new chunk. If it had to reach the new chunk in time from the lagging place, it
    /// would need more than the limits allow, and each chunk would amplify the oscillation. A chunk
    /// that begins at the arm's place continues from there. The initial velocity is the velocity of
    /// the reference, because a chunk may demand any velocity.
    pub(super) fn new(
        curve: Curve<M>,
        (origin, blend, pace): (Origin, Duration, Option<Pace>),
        (reference, wanted): (&M, Option<M>),
        now: u64,
    ) -> Self {
        let counted_from = match origin {
            Origin::TakeUp => now,
            Origin::Robot(time) => time,
        };
        let since = milliseconds(now, counted_from) - CYCLE;
        let there = curve.at(since);
        let is_nearer = |wanted: &M| wanted.distance(&there) < reference.distance(&there);
        let wanted = wanted.filter(is_nearer);
        let last = wanted.map_or(*reference, |wanted| wanted.moving_as(reference));
        let entry = if since + CYCLE < curve.begin() {
            Entry::Approach { from: last, since }
        } else if blend.is_zero() {
            Entry::Turn
        } else {
            Entry::Blend {
                gap: last.gap_from(&there),
                since,
                duration: blend.as_secs_f64(),
            }
        };
        Self {
            curve,
            origin: counted_from,
            asked: (origin, blend, pace),
            own: pace.and_then(PathTime::new),
            entry,
        }
    }

    /// Returns the desired state in the answer to the state `now`.
    pub(super) fn at(&self, now: u64) -> M {
        let t = self.time(now);
        let there = match &self.entry {
            Entry::Approach { from, since } if t < self.curve.begin() => approach(
                from,
                self.curve.first(),
                self.curve.begin() - since,
                t - since,
            ),
            Entry::Blend {
                gap,
                since,
                duration,
            } if t - since < *duration => self.curve.at(t).displaced(gap, *duration, t - since),
            _ => self.curve.at(t),
        };
        match &self.own {
            Some(own) => there.paced(own.rate(), own.change()),
            None => there,
        }
    }

    /// Advances the time of a path by one cycle, for an arm whose lag is `lag` times the permitted
    /// lag.
    pub(super) fn step(&mut self, lag: f64) {
        if let Some(own) = &mut self.own {
            own.step(lag);
        }
    }

    /// Stops or resumes the time of a path. Chunks with fixed times do not pause.
    pub(super) fn set_paused(&mut self, paused: bool) {
        if let Some(own) = &mut self.own {
            own.set_paused(paused);
        }
    }

    /// Returns the seconds from the curve's origin.
    fn time(&self, now: u64) -> f64 {
        match &self.own {
            Some(own) => own.time,
            None => milliseconds(now, self.origin),
        }
    }

    pub(super) fn is_over(&self, now: u64) -> bool {
        let t = self.time(now);
        let entered = match self.entry {
            Entry::Blend {
                since, duration, ..
            } => t - since >= duration,
            Entry::Turn | Entry::Approach { .. } => true,
        };
        entered && t >= self.curve.end()
    }

    pub(super) fn remaining(&self, now: u64) -> f64 {
        (self.curve.end() - self.time(now)).max(0.0)
    }

    pub(super) fn curve(&self) -> &Curve<M> {
        &self.curve
    }

    /// Returns the original chunk, without the parts that are no longer needed.
    pub(super) fn into_chunk(self) -> Chunk {
        let (origin, blend, pace) = self.asked;
        Chunk {
            origin,
            blend,
            pace,
            ..Chunk::of(M::points(self.curve))
        }
    }
}

/// Returns the state at the time `t` on the way between two other states.
fn approach<M: CurveState>(from: &M, to: &M, duration: f64, t: f64) -> M {
    if duration <= LET_GO {
        return M::between(from, to, duration, t);
    }
    let rest = from.resting();
    let way = M::between(&rest, to, duration, t);
    if t < LET_GO {
        way.displaced(&from.gap_from(&rest), LET_GO, t)
    } else {
        way
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::chunk::value::Points;
    use crate::session::reference::Reference;
    use franka_model::JointVector;

    fn moving(q: f64, dq: f64, ddq: f64) -> Reference {
        Reference {
            q: JointVector::repeat(q),
            dq: JointVector::repeat(dq),
            ddq: JointVector::repeat(ddq),
        }
    }

    /// Returns a line with a speed of 1 rad/s and points every 40 ms, from 40 to 400 ms.
    fn line() -> Chunk {
        let point = |k: u32| (Duration::from_millis(40) * k, [0.04 * f64::from(k); 7]);
        Chunk::joints((1..=10).map(point)).unwrap()
    }

    fn play(chunk: Chunk, last: &Reference, now: u64) -> Player<Reference> {
        match chunk.points {
            Points::Joints(curve) => Player::new(
                curve,
                (chunk.origin, chunk.blend, chunk.pace),
                (last, None),
                now,
            ),
            Points::Poses(_) => panic!("these are joints"),
        }
    }

    fn distance(a: &Reference, b: &Reference) -> f64 {
        let apart = [a.q - b.q, a.dq - b.dq, a.ddq - b.ddq].map(|x| x.amax());
        apart.into_iter().fold(0.0, f64::max)
    }

    #[test]
    fn a_chunk_observed_120_ms_ago_goes_on_at_120_ms() {
        let player = play(
            line().observed_at(1000).replace(),
            &moving(0.0, 0.0, 0.0),
            1120,
        );
        assert!(distance(&player.at(1120), &moving(0.12, 1.0, 0.0)) < 1e-9);
        assert!(distance(&player.at(1137), &moving(0.137, 1.0, 0.0)) < 1e-9);
        assert!(!player.is_over(1399) && player.is_over(1400));
        assert_eq!(
            player.at(1400),
            Reference::at_rest(JointVector::repeat(0.4))
        );
    }

    #[test]
    fn blend_joins_motion_and_chunk_with_two_derivatives() {
        let before = moving(0.3, -0.5, 2.0);
        let player = play(line().observed_at(1000), &before, 1120);
        let blended = |t: f64| {
            let Entry::Blend {
                gap,
                since,
                duration,
            } = &player.entry
            else {
                panic!("{:?}", player.entry);
            };
            player.curve.at(t).displaced(gap, *duration, t - since)
        };
        assert!(distance(&blended(0.119), &before) < 1e-9);
        assert!(distance(&blended(0.219), &player.curve.at(0.219)) < 1e-9);
        // From one millisecond to the next nothing jumps: velocities and accelerations match the
        // positions.
        for now in 1121..1300 {
            let (a, b, c) = (player.at(now - 1), player.at(now), player.at(now + 1));
            let v = (c.q - a.q) / (2.0 * CYCLE);
            let acceleration = (c.dq - a.dq) / (2.0 * CYCLE);
            assert!((b.dq - v).amax() < 0.02, "{now}");
            assert!((b.ddq - acceleration).amax() < 2.0, "{now}");
        }
        assert!(distance(&player.at(1230), &moving(0.23, 1.0, 0.0)) < 1e-9);
    }

    #[test]
    fn the_same_prediction_once_more_changes_nothing() {
        let player = play(line().observed_at(1000), &moving(0.119, 1.0, 0.0), 1120);
        for now in 1120..1220 {
            let t = (now - 1000) as f64 * CYCLE;
            assert!(distance(&player.at(now), &moving(t, 1.0, 0.0)) < 1e-9);
        }
    }

    #[test]
    fn a_first_point_in_the_future_is_met_in_time_and_in_motion() {
        let before = moving(0.1, 0.2, 0.0);
        let player = play(line(), &before, 5000);
        assert!(distance(&player.at(5040), &moving(0.04, 1.0, 0.0)) < 1e-9);
        let (first, second) = (player.at(5039), player.at(5041));
        assert!(
            (second.q - first.q).amax() < 2.1e-3,
            "no jump at the first point"
        );
        assert!((player.at(5000).q - before.q).amax() < 1e-3);
    }
}
