//! Arguments whose values are checked.

use std::time::Duration;

use franka_async::nalgebra::{Translation3, UnitQuaternion};
use franka_async::{Pose, pose};
use franka_sim::command_line::numbers;

/// A pose from `x,y,z` (with the present orientation), `x,y,z,roll,pitch,yaw` (degrees), or
/// `x,y,z,qx,qy,qz,qw`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PartialPose {
    pub(crate) position: [f64; 3],
    pub(crate) rotation: Option<UnitQuaternion<f64>>,
}

impl PartialPose {
    /// Returns the complete pose. If the text contained no rotation, the rotation is the rotation
    /// of `now`.
    pub(crate) fn complete(self, now: &Pose) -> Pose {
        let translation = Translation3::from(self.position);
        Pose::from_parts(translation, self.rotation.unwrap_or(now.rotation))
    }
}

pub(crate) fn partial_pose(text: &str) -> Result<PartialPose, String> {
    match text.split(',').count() {
        3 => Ok(PartialPose {
            position: numbers::<3>(text)?,
            rotation: None,
        }),
        6 => {
            let [x, y, z, turns @ ..] = numbers::<6>(text)?;
            let [roll, pitch, yaw] = turns.map(f64::to_radians);
            Ok(PartialPose {
                position: [x, y, z],
                rotation: Some(UnitQuaternion::from_euler_angles(roll, pitch, yaw)),
            })
        }
        7 => {
            let [x, y, z, quaternion @ ..] = numbers::<7>(text)?;
            let pose = pose::from_xyzw([x, y, z], quaternion)
                .ok_or("got a quaternion of length 0, expected length 1")?;
            Ok(PartialPose {
                position: [x, y, z],
                rotation: Some(pose.rotation),
            })
        }
        count => Err(format!(
            "got {count} numbers, expected x,y,z or x,y,z,roll,pitch,yaw (degrees) or \
             x,y,z,qx,qy,qz,qw"
        )),
    }
}

/// Parses a number above zero.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    let [value] = numbers::<1>(text)?;
    if value <= 0.0 {
        return Err(format!("got {value}, expected more than 0"));
    }
    Ok(value)
}

/// Parses a duration in seconds, of at most one day.
pub(crate) fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = positive(text)?;
    match Duration::try_from_secs_f64(seconds) {
        Ok(duration) if duration <= DAY => Ok(duration),
        _ => Err(format!(
            "got {seconds} s, expected {} s at most",
            DAY.as_secs()
        )),
    }
}

/// Parses a rate per second.
pub(crate) fn rate(text: &str) -> Result<f64, String> {
    let rate = positive(text)?;
    if !(0.1..=100.0).contains(&rate) {
        return Err(format!(
            "got {rate} per second, expected 0.1 to 100 per second"
        ));
    }
    Ok(rate)
}

const DAY: Duration = Duration::from_secs(24 * 3600);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_is_given_in_three_ways() {
        let now = Pose::rotation([0.0, 0.0, 1.0].into());
        let pose = |text: &str| partial_pose(text).expect("a pose").complete(&now);
        assert_eq!(pose("0.4,0,0.3").rotation, now.rotation);
        assert_eq!(pose("0.4,0,0.3").translation.vector.z, 0.3);
        let turned = pose("0.4,0,0.3,180,0,0");
        let same = pose("0.4,0,0.3,1,0,0,0");
        assert!(turned.rotation.angle_to(&same.rotation) < 1e-12);
        for wrong in ["", "1,2", "1,2,3,4", "0,0,0,0,0,0,0", "a,b,c", "nan,0,0"] {
            assert!(partial_pose(wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn times_have_bounds() {
        assert_eq!(seconds("1.5"), Ok(Duration::from_millis(1500)));
        for wrong in ["0", "-1", "inf", "1e9", "x"] {
            assert!(seconds(wrong).is_err(), "{wrong:?}");
        }
        assert!(rate("10").is_ok() && rate("0.01").is_err() && rate("1000").is_err());
    }
}
