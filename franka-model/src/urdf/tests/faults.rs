//! Texts with one fault each, and their error messages.

use super::*;

#[test]
fn urdf_that_describes_no_arm_is_refused() {
    for (text, message) in [
        ("", "Failed to parse URDF: "),
        ("no XML at all", "Failed to parse URDF: "),
        ("<robot name=\"fr3\">", "Failed to parse URDF: "),
        ("<a/><b/>", "Failed to parse URDF: "),
        (
            "<!DOCTYPE x [<!ENTITY a \"b\">]><robot/>",
            "Failed to parse URDF: ",
        ),
        (
            "<sdf/>",
            "Failed to parse URDF: no <robot> element exists; the root element is <sdf>",
        ),
        (
            "<robot name=\"tmr_base\"/>",
            "the URDF describes the mobile robot 'tmr_base', expected an arm (libfranka: loadModel() is not",
        ),
        (
            "<robot name=\"fr3\"/>",
            "Missing required joints: joint1 joint2 joint3 joint4 joint5 joint6 joint7; got none",
        ),
    ] {
        let error = refused(text).to_string();
        assert!(error.starts_with(message), "{error}");
    }
}

#[test]
fn faults_of_joints_are_told_with_what_was_found_and_expected() {
    for (text, message) in [
        (
            with("name=\"joint5\"", "name=\"wrist\""),
            "Missing required joints: joint5; got base_joint joint1 joint2 joint3 joint4 wrist joint6 joint7 \
             joint8 link7_accelerometer_joint",
        ),
        (
            with(
                "name=\"joint4\" type=\"revolute\"",
                "name=\"joint4\" type=\"continuous\"",
            ),
            "joint joint4 is of type 'continuous', expected 'revolute'",
        ),
        (
            with(
                "name=\"joint2\" type=\"revolute\"",
                "name=\"joint2\" type=\"fixed\"",
            ),
            "joint joint2 is of type 'fixed', expected 'revolute'",
        ),
        (
            with(
                "name=\"joint8\" type=\"fixed\"",
                "name=\"finger_joint1\" type=\"prismatic\"",
            ),
            "got the additional joint finger_joint1 of type 'prismatic', expected seven movable \
             joints, joint1 to \
             joint7",
        ),
        (
            with("name=\"joint6\" type=\"revolute\"", "name=\"joint6\""),
            "Missing 'type' attribute in <joint> for joint: joint6",
        ),
        (
            with("name=\"joint6\" type=\"revolute\"", "type=\"revolute\""),
            "Missing 'name' attribute in <joint> for the robot",
        ),
        (
            with("name=\"joint6\"", "name=\"joint5\""),
            "two elements <joint> have the name 'joint5', expected one",
        ),
        (
            with("<parent link=\"link3\"/>", "<parent link=\"link33\"/>"),
            "joint joint4 has the parent 'link33', expected the name of a <link>",
        ),
        (
            with("<child link=\"link3\"/>", ""),
            "Missing <child> element for joint: joint3",
        ),
        (
            with("<parent link=\"link3\"/>", "<parent link=\"link2\"/>"),
            "joint joint4 has the parent link2, which joint 2 moves, expected a link that joint 3 moves",
        ),
        (
            with("<child link=\"link3\"/>", "<child link=\"link2\"/>"),
            "link link2 is the child of two joints, joint2 and joint3, expected one",
        ),
        (
            with(
                "<link name=\"base\"/>",
                "<link name=\"base\"/><link name=\"stray\"/>",
            ),
            "got several links without a parent joint (base stray), expected exactly one",
        ),
        (
            with(
                "<link name=\"link8\"/>",
                &format!(
                    "<link name=\"link8\"/><link name=\"a\"/><link name=\"b\"/>{}{}",
                    fixed("x", "a", "b", "0 0 0", "0 0 0"),
                    fixed("y", "b", "a", "0 0 0", "0 0 0")
                ),
            ),
            "no chain of joints connects link a to the root base, expected one for every link",
        ),
        (
            with("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 0\"/>"),
            "joint joint1 has the axis [0.0, 0.0, 0.0], expected [0, 0, 1]",
        ),
        (
            with("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 -1\"/>"),
            "joint joint1 has the axis [0.0, 0.0, -1.0], expected [0, 0, 1]",
        ),
        (
            with("<axis xyz=\"0 0 1\"/>", ""),
            "Missing <axis> element for joint: joint1",
        ),
        (
            with("xyz=\"0 -0.316 0\"", "xyz=\"0 -0.326 0\""),
            "the frame of joint: joint3 is off by [",
        ),
        (
            with(
                "rpy=\"1.5707963267948966 0 0\" xyz=\"0.0825",
                "rpy=\"1.57 0 0\" xyz=\"0.0825",
            ),
            "the frame of joint: joint4 is off by [",
        ),
        (
            with("xyz=\"0 -0.316 0\"", "xyz=\"0 -0.316\""),
            "'xyz' in <origin> for joint: joint3 is '0 -0.316', expected three numbers of at most 1e6 in size",
        ),
        (
            with(
                "xyz=\"0 0 0\" rpy=\"0 0 0\"/><parent link=\"base\"/>",
                "xyz=\"0 0 0.1\"/><parent link=\"base\"/>",
            ),
            "the frame of joint: joint1 is off by [",
        ),
        (
            with("xyz=\"0 0 0.107\"", "xyz=\"0 0 0.1\""),
            "the frame of the flange, link: link8 is off by [",
        ),
    ] {
        let error = refused(&text).to_string();
        assert!(error.starts_with(message), "{error}\nis not\n{message}");
    }
    let text = text().replace("\"link8\"", "\"tip\"");
    assert!(matches!(refused(&text), UrdfError::NoFlange { .. }));
}

#[test]
fn faults_of_limits_are_told_with_what_was_found_and_expected() {
    let envelope =
        "<position_based_velocity_limits velocity_offset=\"0.3\" deceleration_limit=\"6\"/>";
    for (text, message) in [
        (
            with(envelope, ""),
            "Missing <position_based_velocity_limits> element for joint: joint1",
        ),
        (
            // The vendor's parser does not find the nested element either.
            with(envelope, &format!("<limits>{envelope}</limits>")),
            "Missing <position_based_velocity_limits> element for joint: joint1",
        ),
        (
            with("<limit lower", "<limits lower"),
            "Missing <limit> element for joint: joint1",
        ),
        (
            with(" velocity=\"2.62\"", ""),
            "Missing 'velocity' attribute in <limit> for joint: joint1",
        ),
        (
            with(" deceleration_limit=\"6\"", ""),
            "Missing 'deceleration_limit' attribute in <position_based_velocity_limits> for joint: joint1",
        ),
        (
            with(
                "lower=\"-2.7501\" upper=\"2.7501\"",
                "lower=\"2.7501\" upper=\"-2.7501\"",
            ),
            "joint joint1 has the lower limit 2.7501 rad and the upper limit -2.7501 rad, \
             expected the lower limit below \
             the upper limit",
        ),
        (
            with("upper=\"2.7501\"", "upper=\"nan\""),
            "'upper' in <limit> for joint: joint1 is 'nan', expected a number of at most 1e6 in size",
        ),
        (
            with("velocity=\"2.62\"", "velocity=\"2.62rad/s\""),
            "'velocity' in <limit> for joint: joint1 is '2.62rad/s', expected a number of at most 1e6 in size",
        ),
        (
            with("effort=\"87\"", "effort=\"-87\""),
            "'effort' in <limit> for joint: joint1 is '-87', expected a number above 0",
        ),
        (
            with("velocity_offset=\"0.3\"", "velocity_offset=\"-0.3\""),
            "'velocity_offset' in <position_based_velocity_limits> for joint: joint1 is '-0.3', \
             expected a number of 0 or more",
        ),
        (
            with("deceleration_limit=\"6\"", "deceleration_limit=\"0.3\""),
            "'deceleration_limit' in <position_based_velocity_limits> for joint: joint1 is '0.3', expected a number \
             of at least 1.2",
        ),
        (
            with(
                "lower=\"-2.7501\" upper=\"2.7501\"",
                "lower=\"1.5\" upper=\"1.51\"",
            ),
            "the range of joint joint1, from 1.5 to 1.51 rad, is 0.0100 rad, expected 0.2150 rad or \
             more: the driver keeps a \
             margin at both ends",
        ),
        (
            with("velocity_offset=\"0.3\"", "velocity_offset=\"6\""),
            "the range of joint joint1, from -2.7501 to 2.7501 rad, is 5.5002 rad, expected 6.2000 \
             rad or more: the driver \
             keeps a margin at both ends",
        ),
    ] {
        assert_eq!(refused(&text).to_string(), message);
    }
}

#[test]
fn faults_of_bodies_are_told_with_what_was_found_and_expected() {
    let mass = format!("mass value=\"{}\"", Model::fr3().links()[4].mass);
    let inertia = format!("ixx=\"{}\"", Model::fr3().links()[4].inertia.xx);
    let body = inertial(&Model::fr3().links()[4]);
    for (text, message) in [
        (
            with(&body, ""),
            "Missing <inertial> element for link: link5",
        ),
        (
            with(&mass, "mass value=\"-2\""),
            "'value' in <mass> for link: link5 is '-2', expected a number above 0",
        ),
        (
            with(&mass, "mass value=\"0\""),
            "'value' in <mass> for link: link5 is '0', expected a number above 0",
        ),
        (
            with(&mass, "mass value=\"inf\""),
            "'value' in <mass> for link: link5 is 'inf', expected a number of at most 1e6 in size",
        ),
        (
            with(&inertia, ""),
            "Missing 'ixx' attribute in <inertia> for link: link5",
        ),
        (
            with(&inertia, "ixx=\"\""),
            "'ixx' in <inertia> for link: link5 is '', expected a number of at most 1e6 in size",
        ),
        (
            with(&inertia, "ixx=\"-0.05\""),
            "the inertia of link link5 has principal moments of -0.05",
        ),
    ] {
        let error = refused(&text).to_string();
        assert!(error.starts_with(message), "{error}\nis not\n{message}");
    }
    let rod = r#"<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="0"/></inertial>"#;
    let error = refused(&with(&body, rod));
    assert!(
        matches!(
            error,
            UrdfError::Inertia {
                moments: [0.0, 1.0, 1.0],
                ..
            }
        ),
        "{error}"
    );
}
