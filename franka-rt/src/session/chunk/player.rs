//! Where the chunk that is in force wants the arm to be, at each time of the robot.

use core::time::Duration;

use super::curve::Curve;
use super::curve_state::CurveState;
use super::pace::{Pace, PathTime};
use super::value::{Chunk, Origin, milliseconds};
use crate::shaping::CYCLE;

/// Time, `[s]`, in which the motion before is let go on the way to a first point that lies later
/// than this: the motion would go on until half of the way there is over.
const LET_GO: f64 = 1.0;

/// A chunk that has been taken up.
#[derive(Debug)]
pub(super) struct Player<M: CurveState> {
    curve: Curve<M>,
    /// Time of the robot that the curve's times count from, `message_id`.
    origin: u64,
    /// As the chunk had it, to give it back with.
    asked: (Origin, Duration, Option<Pace>),
    /// The time of a path.
    own: Option<PathTime>,
    entry: Entry<M>,
}

/// How the motion before goes over into the curve. Times as the curve's.
#[derive(Debug)]
enum Entry<M: CurveState> {
    /// At once.
    Turn,
    /// The first point lies in the future: on the way to it since `since`.
    Approach { from: M, since: f64 },
    /// The distance from the curve at `since` is let go in `duration`.
    Blend {
        gap: M::Gap,
        since: f64,
        duration: f64,
    },
}

impl<M: CurveState> Player<M> {
    /// Takes up a chunk through `curve` in the answer to the state `now`, from a reference that was
    /// at `reference` in the answer before, where a chunk before this one wanted it at `wanted`.
    ///
    /// The way begins at the one of the two places that is nearer to the chunk. What the reference
    /// lags behind the chunk before, it makes up for within its limits, and goes on to do so: to be
    /// on a new chunk in time, from where it is, would ask for more than the limits allow, and each
    /// chunk would add to the swing. A chunk that begins where the arm is goes on from there. The
    /// velocity is that of the reference: a chunk may want any.
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

    /// Where to be in the answer to the state `now`.
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

    /// Lets the time of a path go on by one cycle, for an arm that is behind by `lag` in units of
    /// what it may be.
    pub(super) fn step(&mut self, lag: f64) {
        if let Some(own) = &mut self.own {
            own.step(lag);
        }
    }

    /// Stops the time of a path, or lets it go on. Points that have times do not wait.
    pub(super) fn set_paused(&mut self, paused: bool) {
        if let Some(own) = &mut self.own {
            own.set_paused(paused);
        }
    }

    /// Seconds from the curve's origin.
    fn time(&self, now: u64) -> f64 {
        match &self.own {
            Some(own) => own.time,
            None => milliseconds(now, self.origin),
        }
    }

    /// True if nothing moves any more from `now` on.
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

    /// Time from `now` to the last point, `[s]`.
    pub(super) fn remaining(&self, now: u64) -> f64 {
        (self.curve.end() - self.time(now)).max(0.0)
    }

    pub(super) fn curve(&self) -> &Curve<M> {
        &self.curve
    }

    /// The chunk as it came, but for what nobody asks for any more.
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

/// On the way from one state to another, `t` after its begin.
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

    /// A line of 1 rad/s, points 40 ms apart from 40 to 400 ms.
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
    fn a_blend_leaves_the_motion_before_and_enters_the_chunk_with_two_derivatives() {
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
        // One millisecond at a time nothing jumps: velocities and accelerations are those of the
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
