//! The sequence of jerks that all motions share, and the pieces before this sequence.

use crate::brake::Pieces;

/// A push and a stop: jerks `first, 0, -first, 0, -1, 0, 1` in units of the limit, each for its
/// duration.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shape {
    /// Sign of the first jerk.
    pub(crate) first: f64,
    /// The seven durations, which are never negative.
    pub(crate) t: [f64; 7],
    /// Velocity between the two halves. If the fourth piece has a duration, this is the velocity of
    /// the fourth piece.
    pub(crate) cruise: f64,
}

impl Shape {
    pub(crate) fn duration(&self) -> f64 {
        self.t.iter().sum()
    }

    /// Returns the transfer from acceleration `a` to the velocity `cruise`, a cruise of duration
    /// `time`, and the transfer to rest. Each transfer is given as its ramp time and its hold time.
    pub(crate) fn two_transfers(
        a: f64,
        to_cruise: (f64, f64),
        (cruise, time): (f64, f64),
        to_rest: (f64, f64),
    ) -> Self {
        let ((x, first_hold), (y, second_hold)) = (to_cruise, to_rest);
        // A negative x means that the acceleration never reaches zero: there is one negative jerk
        // from x to -y.
        let (t3, t5) = if x < 0.0 {
            (0.0, (x + y).max(0.0))
        } else {
            (x, y)
        };
        let t1 = (x - a).max(0.0);
        Self {
            first: 1.0,
            t: [t1, first_hold, t3, time, t5, second_hold, y],
            cruise,
        }
    }
}

/// A motion of a given duration: some pieces, then a shape, in the frame of its least-time
/// solution.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stretched {
    pub(crate) before: Pieces,
    pub(crate) sign: f64,
    pub(crate) shape: Shape,
}

impl Stretched {
    /// Creates a motion of only the shape, in the shape's own frame.
    pub(crate) fn of(shape: Shape) -> Self {
        Self {
            before: Pieces::NONE,
            sign: 1.0,
            shape,
        }
    }
}
