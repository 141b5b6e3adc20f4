//! Properties of whole motions. Each part has its tests in its own file.

mod allowed;
mod bounds;
mod closed_loop;
mod extreme;
mod least;
mod moving;
mod oracle;
mod random;
mod reading;
mod refusals;
mod straight_lines;
mod stretched;
mod walk;

pub(super) use random::cases;

use crate::{AxisLimits, AxisState, Limits, State};
