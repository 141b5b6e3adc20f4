//! Refusals of limiters and filters, and their error texts.
//!
//! The vectors describe each input in words; the rest of it is at rest.

use anyhow::{Context as _, bail};
use franka_rt::shaping::limiter::{self, AxisBounds, JointBounds};
use franka_rt::shaping::{Bounds, InvalidCommand, filter};
use serde::Deserialize;

use super::Report;

const IDENTITY: [f64; 16] = [
    1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.3, 0.2, 0.1, 1.0,
];

/// A refusal by a function. In some cases the filters accept the input.
#[derive(Deserialize)]
pub(super) struct Refused {
    function: String,
    case: String,
    error: Option<String>,
}

/// Checks the `errors` of `rate_limiting_vectors.json`.
pub(super) fn limiters(
    report: &mut Report,
    part: &str,
    bounds: &Bounds,
    errors: &[Refused],
) -> anyhow::Result<()> {
    let joints = bounds.joints_at(&[0.0, 0.0, 0.0, -1.5, 0.0, 2.0, 0.0]);
    for (index, refused) in errors.iter().enumerate() {
        let (name, words) = (refused.function.as_str(), refused.case.as_str());
        let unknown = || format!("{words}: expected a case of the limiters");
        let inputs: Vec<Input> = match words {
            "commanded non-finite" => [f64::NAN, f64::INFINITY, f64::NEG_INFINITY]
                .map(|value| Input::Element(0, value))
                .into(),
            "row-major matrix (translation in the bottom row)" => vec![Input::RowMajor],
            "first column norm 1.001" => vec![Input::Stretched(1.001)],
            _ => vec![Input::element(words).with_context(unknown)?],
        };
        report.case(format!("{part}.errors[{index}]: {name}, {words}"), |case| {
            for input in inputs {
                match limit(name, &input, bounds, &joints) {
                    Some(got) => case.equal("error", got, refused.error.clone()),
                    None => case.fail(format!("no limiter of this name for {input:?}")),
                }
            }
        });
    }
    Ok(())
}

/// Unusual input in a command.
#[derive(Debug)]
enum Input {
    /// One element has another value.
    Element(usize, f64),
    /// A pose is transposed.
    RowMajor,
    /// The first column of a pose has this length.
    Stretched(f64),
}

impl Input {
    /// Reads `NaN in element 3 of the commanded value`.
    fn element(words: &str) -> Option<Self> {
        let (value, rest) = words.split_once(" in element ")?;
        let index = rest.strip_suffix(" of the commanded value")?;
        Some(Self::Element(index.parse().ok()?, value.parse().ok()?))
    }

    /// Changes a command, if it can be changed that way.
    fn apply<const N: usize>(&self, mut command: [f64; N]) -> Option<[f64; N]> {
        match *self {
            Self::Element(index, value) => *command.get_mut(index)? = value,
            Self::RowMajor if N == 16 => {
                command = core::array::from_fn(|i| command[i % 4 * 4 + i / 4]);
            }
            Self::Stretched(length) if N == 16 => {
                command[..3].iter_mut().for_each(|x| *x *= length)
            }
            Self::RowMajor | Self::Stretched(_) => return None,
        }
        Some(command)
    }
}

/// The error of the limiter with this name; `None` if there is no such limiter.
fn limit(
    name: &str,
    input: &Input,
    bounds: &Bounds,
    joints: &JointBounds,
) -> Option<Option<String>> {
    let still = [0.0; 7];
    let elbow: &AxisBounds = &bounds.elbow;
    let error = match name {
        "torque" => limiter::torques(&input.apply(still)?, &still, &bounds.torque_rate).err(),
        "joint_velocities" => {
            limiter::joint_velocities(joints, &input.apply(still)?, &still, &still).err()
        }
        "joint_positions" => {
            limiter::joint_positions(joints, &input.apply(still)?, &still, &still, &still).err()
        }
        "scalar velocity" => limiter::velocity(elbow, input.apply([0.0])?[0], 0.0, 0.0).err(),
        "scalar position" => limiter::position(elbow, input.apply([0.0])?[0], 0.0, 0.0, 0.0).err(),
        "cartesian_velocity" => {
            let (command, last) = (input.apply([0.0; 6])?, [0.0; 6]);
            limiter::cartesian_velocity(&bounds.cartesian, &command, &last, &last).err()
        }
        "cartesian_pose" => {
            let (command, last) = (input.apply(IDENTITY)?, [0.0; 6]);
            limiter::cartesian_pose(&bounds.cartesian, &command, &IDENTITY, &last, &last).err()
        }
        _ => return None,
    };
    Some(error.map(|error: InvalidCommand| error.to_string()))
}

/// Checks the `errors` of `lowpass_vectors.json`; some cases are accepted.
pub(super) fn filters(report: &mut Report, part: &str, errors: &[Refused]) -> anyhow::Result<()> {
    for (index, refused) in errors.iter().enumerate() {
        let (name, words) = (refused.function.as_str(), refused.case.as_str());
        let unknown = || format!("{words}: expected an argument and its value");
        let split = words.split_once(" = ").or(words.split_once(" has "));
        let (argument, value) = split.with_context(unknown)?;
        let value: f64 = value.parse().with_context(unknown)?;
        let mut arguments = [
            ("sample_time", 1e-3),
            ("current", 0.5),
            ("last", 0.4),
            ("cutoff_frequency", 100.0),
        ];
        let changed = arguments.iter_mut().find(|(name, _)| *name == argument);
        changed.with_context(unknown)?.1 = value;
        let [time, current, last, cutoff] = arguments.map(|(_, value)| value);
        let pose = |element: f64| {
            let mut pose = IDENTITY;
            pose[12] = element;
            pose
        };
        let error = match name {
            "lowpass" => filter::low_pass(time, current, last, cutoff).err(),
            "cartesian_lowpass" => {
                filter::low_pass_pose(time, &pose(current), &pose(last), cutoff).err()
            }
            _ => bail!("{name}: expected a filter"),
        };
        report.case(format!("{part}.errors[{index}]: {name}, {words}"), |case| {
            let got = error.map(|error| error.to_string());
            case.equal("error", got, refused.error.clone());
        });
    }
    Ok(())
}
