//! The motion of one axis over time, as segments of constant jerk.

use crate::brake::Pieces;
use crate::state::AxisState;

/// Up to [`MAX_SEGMENTS`] segments of constant jerk that end at rest.
///
/// Positions are relative to the start, so a large offset rounds the result only once, and not in
/// each segment. The last three segments of a motion to a target are computed backwards from the
/// target. Therefore the motion ends exactly at the target. The remaining rounding error occurs at
/// full speed, where it is relatively smallest.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Profile {
    origin: f64,
    end: f64,
    segments: [Segment; MAX_SEGMENTS],
    len: usize,
    duration: f64,
    /// State after the last segment that was computed forwards, relative to the origin.
    front: AxisState,
}

#[derive(Debug, Clone, Copy)]
struct Segment {
    start: f64,
    jerk: f64,
    /// State at the start, relative to the origin.
    state: AxisState,
}

impl Segment {
    /// Returns the state `t` after the start of the profile, relative to the origin.
    fn at(&self, t: f64) -> AxisState {
        self.state.after(self.jerk, t - self.start)
    }
}

impl Profile {
    pub(crate) const fn at_rest(position: f64) -> Self {
        Self {
            origin: position,
            end: position,
            segments: [Segment {
                start: 0.0,
                jerk: 0.0,
                state: AxisState::at_rest(0.0),
            }; MAX_SEGMENTS],
            len: 0,
            duration: 0.0,
            front: AxisState::at_rest(0.0),
        }
    }

    /// Removes all segments and begins at `state`.
    pub(crate) fn begin(&mut self, state: AxisState) {
        self.origin = state.position;
        self.end = state.position;
        self.len = 0;
        self.duration = 0.0;
        self.front = AxisState {
            position: 0.0,
            ..state
        };
    }

    /// Appends a segment of `jerk` for `t` seconds.
    pub(crate) fn push(&mut self, jerk: f64, t: f64) {
        if t > 0.0 {
            self.place(jerk, t, self.front);
            self.front = self.front.after(jerk, t);
        }
    }

    /// Appends `t` seconds of exactly constant `velocity`. The previous segments must end at this
    /// velocity, within rounding.
    ///
    /// A cruise may last millions of times longer than the ramps around it. Without an exact
    /// velocity, a rounding error of the acceleration would grow into a distance.
    pub(crate) fn cruise(&mut self, velocity: f64, t: f64) {
        if t > 0.0 {
            self.front.velocity = velocity;
            self.front.acceleration = 0.0;
            self.push(0.0, t);
        }
    }

    /// Appends pieces that are in units of the axis. `jerk` is the axis's unit of jerk, and `unit`
    /// is its unit of time.
    pub(crate) fn push_pieces(&mut self, pieces: &Pieces, jerk: f64, unit: f64) {
        for (sign, t) in pieces.iter() {
            self.push(sign * jerk, t * unit);
        }
    }

    /// Appends the jerks `jerk, 0, -jerk` for the times `t`. They end at `target`, or `beyond` the
    /// target.
    pub(crate) fn lead_to(&mut self, target: AxisState, beyond: f64, jerk: f64, t: [f64; 3]) {
        self.end = target.position;
        self.front = AxisState {
            position: target.position - self.origin + beyond,
            ..target
        };
        let mut states = [self.front; 4];
        let jerks = [jerk, 0.0, -jerk];
        for i in (0..3).rev() {
            states[i] = states[i + 1].after(jerks[i], -t[i]);
        }
        for i in 0..3 {
            if t[i] > 0.0 {
                self.place(jerks[i], t[i], states[i]);
            }
        }
    }

    /// Makes the end of the segments the end of the profile, exactly at rest.
    pub(crate) fn finish_here(&mut self) {
        self.end = self.origin + self.front.position;
    }

    /// Sets the profile to the mean of two motions with the same start and duration, weighted with
    /// `weight` and `1 - weight`. The mean ends at `target`.
    ///
    /// The states of the segments are means of the states of the two motions, and not sums over the
    /// previous segments. They are therefore equally exact at the start, at the end, and after a
    /// cruise.
    pub(crate) fn mean_of(&mut self, weight: f64, one: &Self, other: &Self, target: AxisState) {
        let mean = |a: f64, b: f64| weight * a + (1.0 - weight) * b;
        self.begin(AxisState {
            position: one.origin,
            ..AxisState::at_rest(0.0)
        });
        let (mut i, mut j, mut t) = (0, 0, 0.0);
        while i < one.len && j < other.len {
            let (a, b) = (&one.segments[i], &other.segments[j]);
            let ends = [one.end_of(i), other.end_of(j)];
            let next = ends[0].min(ends[1]);
            if next > t {
                let (p, q) = (a.at(t), b.at(t));
                let state = AxisState {
                    position: mean(p.position, q.position),
                    velocity: mean(p.velocity, q.velocity),
                    acceleration: mean(p.acceleration, q.acceleration),
                };
                self.place(mean(a.jerk, b.jerk), next - t, state);
                t = next;
            }
            i += usize::from(ends[0] <= next);
            j += usize::from(ends[1] <= next);
        }
        self.lead_to(target, 0.0, 0.0, [0.0; 3]);
    }

    fn end_of(&self, segment: usize) -> f64 {
        match self.segments[..self.len].get(segment + 1) {
            Some(next) => next.start,
            None => self.duration,
        }
    }

    fn place(&mut self, jerk: f64, t: f64, state: AxisState) {
        if let Some(segment) = self.segments.get_mut(self.len) {
            *segment = Segment {
                start: self.duration,
                jerk,
                state,
            };
            self.len += 1;
            self.duration += t;
        }
    }

    /// Returns the state after the segments that were computed forwards, relative to the origin.
    pub(crate) const fn front(&self) -> AxisState {
        self.front
    }

    pub(crate) const fn end(&self) -> f64 {
        self.end
    }

    /// Returns the duration of the profile, in seconds.
    pub(crate) const fn duration(&self) -> f64 {
        self.duration
    }

    /// Returns the state `t >= 0` seconds after the start. After the profile's duration, the state
    /// is exactly the end.
    pub(crate) fn sample(&self, t: f64) -> AxisState {
        if t >= self.duration {
            return AxisState::at_rest(self.end);
        }
        let later = self.segments[..self.len]
            .iter()
            .skip(1)
            .take_while(|segment| segment.start <= t)
            .count();
        let relative = self.segments[later.min(MAX_SEGMENTS - 1)].at(t);
        AxisState {
            position: self.origin + relative.position,
            ..relative
        }
    }
}

/// Largest number of segments: three to brake into the limits, thirteen for the mean of two shapes,
/// and four to stop beyond a target in motion. A motion that begins with part of a stop has at most
/// thirteen segments in total.
const MAX_SEGMENTS: usize = 20;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_profile_stays_where_it_is() {
        let profile = Profile::at_rest(0.1);
        for t in [0.0, 1.0, f64::INFINITY] {
            assert_eq!(profile.sample(t), AxisState::at_rest(0.1));
        }
    }

    #[test]
    fn segments_join_and_the_end_is_exact() {
        let mut profile = Profile::at_rest(0.0);
        profile.begin(AxisState::at_rest(0.3));
        profile.push(2.0, 1.0);
        profile.push(-2.0, 1.0);
        profile.lead_to(AxisState::at_rest(4.3), 0.0, -2.0, [1.0, 0.0, 1.0]);
        assert_eq!(profile.duration(), 4.0);
        for (t, p) in [(1.0, 0.3 + 1.0 / 3.0), (2.0, 2.3), (3.0, 4.3 - 1.0 / 3.0)] {
            for t in [t - 1e-12, t, t + 1e-12] {
                assert!((profile.sample(t).position - p).abs() < 1e-11, "{t}");
            }
        }
        assert_eq!(profile.sample(4.0), AxisState::at_rest(4.3));
    }
}
