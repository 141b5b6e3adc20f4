use super::*;
use crate::geometry::{FLANGE, JOINT_ORIGINS};
use crate::{Load, READY};
use std::fmt::Write;
use std::format;
use std::vec::Vec;

/// Numbers with all digits, as Rust prints them.
fn list(numbers: impl IntoIterator<Item = f64>) -> String {
    let texts: Vec<String> = numbers.into_iter().map(|x| x.to_string()).collect();
    texts.join(" ")
}

fn inertial(body: &crate::RigidBody) -> String {
    let i = &body.inertia;
    format!(
        r#"<inertial><origin rpy="0 0 0" xyz="{}"/><mass value="{}"/><inertia ixx="{}" ixy="{}" ixz="{}" iyy="{}" iyz="{}" izz="{}"/></inertial>"#,
        list(body.com.iter().copied()),
        body.mass,
        i.xx,
        i.xy,
        i.xz,
        i.yy,
        i.yz,
        i.zz
    )
}

/// The FR3 with what a vendor's text has around it: a `base` link, meshes, dampings, accelerometers.
fn text() -> String {
    let model = Model::fr3();
    let mut text =
        String::from("<?xml version=\"1.0\" ?>\n<robot name=\"fr3\">\n<link name=\"base\"/>\n");
    let bodies = core::iter::once(model.base()).chain(model.links());
    for (i, body) in bodies.enumerate() {
        let inertial = inertial(body);
        writeln!(
            text,
            r#"<link name="link{i}"><visual><geometry><mesh filename="link{i}.dae"/></geometry></visual>{inertial}</link>"#
        )
        .expect("a string");
    }
    text += "<link name=\"link8\"/>\n<link name=\"link7_accelerometer\"/>\n";
    text += &fixed("base_joint", "base", "link0", "0 0 0", "0 0 0");
    let limits = model.joint_limits();
    let envelope = limits.envelope.expect("the FR3 has one");
    for (i, origin) in JOINT_ORIGINS.iter().enumerate() {
        let k = i + 1;
        writeln!(
            text,
            r#"<joint name="joint{k}" type="revolute"><origin rpy="{} 0 0" xyz="{}"/><parent link="link{i}"/><child link="link{k}"/><axis xyz="0 0 1"/><dynamics damping="0.003"/><limit lower="{}" upper="{}" velocity="{}" effort="{}"/><position_based_velocity_limits velocity_offset="{}" deceleration_limit="{}"/></joint>"#,
            origin.roll,
            list(origin.translation.iter().copied()),
            limits.hard_lower[i],
            limits.hard_upper[i],
            limits.velocity[i],
            limits.torque[i],
            envelope.offset[i],
            envelope.deceleration[i],
        )
        .expect("a string");
    }
    text += &fixed(
        "joint8",
        "link7",
        "link8",
        &format!("0 0 {FLANGE}"),
        "0 0 0",
    );
    text += &fixed(
        "link7_accelerometer_joint",
        "link7",
        "link7_accelerometer",
        "0.1 0 0",
        "0 0 1",
    );
    text + "</robot>\n"
}

fn fixed(name: &str, parent: &str, child: &str, xyz: &str, rpy: &str) -> String {
    format!(
        r#"<joint name="{name}" type="fixed"><origin xyz="{xyz}" rpy="{rpy}"/><parent link="{parent}"/><child link="{child}"/></joint>
"#
    )
}

/// The text with one passage replaced, which has to be there.
fn with(from: &str, to: &str) -> String {
    let text = text();
    assert!(text.contains(from), "{from} is not in the text");
    text.replacen(from, to, 1)
}

#[track_caller]
fn refused(text: &str) -> UrdfError {
    Model::from_urdf(text).expect_err("a description to refuse")
}

#[test]
fn the_vendors_numbers_give_the_constant_model_to_the_last_bit() {
    assert_eq!(&Model::from_urdf(&text()).expect("a model"), Model::fr3());
}

#[test]
fn what_the_vendors_parser_accepts_around_the_document_is_accepted() {
    let text = text();
    let undeclared = text.split_once("?>").expect("a declaration").1;
    for variant in [
        format!("\n  {text}"),
        format!("\u{feff}{text}"),
        format!("{text}\0\0\0"),
        undeclared.into(),
        text.replace("name=\"fr3\"", "name=\"anything\" version=\"1.0\""),
        text.replace("name=\"joint", "name=\"fr3_joint"),
        text.replace("\"link8\"", "\"fr3_link8\""),
        text.replace("<link name=\"base\"/>\n", "")
            .replace(&fixed("base_joint", "base", "link0", "0 0 0", "0 0 0"), ""),
    ] {
        assert_eq!(&Model::from_urdf(&variant).expect("a model"), Model::fr3());
    }
}

#[test]
fn joints_may_come_in_any_order_and_rounded_angles_count_as_right() {
    let text = text();
    let mut lines: Vec<&str> = text.lines().collect();
    let last = lines.len() - 1;
    lines[2..last].reverse();
    let text = lines.join("\n").replace("1.5707963267948966", "1.570796");
    assert_eq!(&Model::from_urdf(&text).expect("a model"), Model::fr3());
}

#[test]
fn numbers_of_the_text_are_those_of_the_model() {
    let mass = Model::fr3().links()[2].mass;
    let heavier = with(&format!("mass value=\"{mass}\""), "mass value=\"4.5\"");
    let model = Model::from_urdf(&heavier).expect("a model");
    assert_eq!(model.links()[2].mass, 4.5);
    assert_ne!(
        model.mass(&READY, &Load::NONE),
        Model::fr3().mass(&READY, &Load::NONE)
    );

    let narrower = with(
        "lower=\"-2.7501\" upper=\"2.7501\" velocity=\"2.62\"",
        "lower=\"-1\" upper=\"2\" velocity=\"1.5\"",
    );
    let limits = *Model::from_urdf(&narrower).expect("a model").joint_limits();
    assert_eq!(
        (
            limits.hard_lower[0],
            limits.hard_upper[0],
            limits.velocity[0]
        ),
        (-1.0, 2.0, 1.5)
    );
    // As far inside as the documented positions are.
    assert!((limits.lower[0] + 1.0 - 0.0064).abs() < 1e-15);
    assert!((limits.upper[0] - 2.0 + 0.0064).abs() < 1e-15);
    let (_, upper) = limits.velocity_envelope(&READY, 0.0);
    assert_eq!(upper[0], 1.5);

    let wider = with("upper=\"2.7501\"", "upper=\"3.1\"");
    let limits = *Model::from_urdf(&wider).expect("a model").joint_limits();
    assert_eq!((limits.hard_upper[0], limits.upper[0]), (3.1, 2.7437));

    let envelope = with(
        "velocity_offset=\"0.3\" deceleration_limit=\"6\"",
        "velocity_offset=\"0.1\" deceleration_limit=\"3\"",
    );
    let limits = *Model::from_urdf(&envelope).expect("a model").joint_limits();
    let envelope = limits.envelope.expect("an envelope");
    assert_eq!((envelope.offset[0], envelope.deceleration[0]), (0.1, 3.0));
}

#[test]
fn what_is_fixed_to_a_link_is_part_of_it() {
    let part = r#"<inertial><origin xyz="0 0 0.02" rpy="0 1.5707963267948966 0"/><mass value="0.5"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.003"/></inertial>"#;
    let text = with(
        "<link name=\"link8\"/>",
        &format!("<link name=\"link8\">{part}</link>"),
    );
    let model = Model::from_urdf(&text).expect("a model");
    // A load on the flange, with x and z swapped by the quarter turn about y, is the same body.
    let load = Load {
        mass: 0.5,
        com: nalgebra::Vector3::new(0.0, 0.0, 0.02),
        inertia: nalgebra::Matrix3::from_diagonal(&nalgebra::Vector3::new(0.003, 0.002, 0.001)),
    };
    let expected = Model::fr3().mass(&READY, &load);
    assert!((model.mass(&READY, &Load::NONE) - expected).amax() < 1e-16);
}

#[test]
fn what_is_no_description_of_an_arm_is_refused() {
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
            "the URDF describes the mobile robot 'tmr_base', expected an arm; libfranka: loadModel() is not",
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
            "joint finger_joint1 of type 'prismatic' is one too many, expected seven movable joints, joint1 to \
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
            "link link2 is the child of the joints joint2 and joint3, expected one of them",
        ),
        (
            with(
                "<link name=\"base\"/>",
                "<link name=\"base\"/><link name=\"stray\"/>",
            ),
            "the links without a joint above are: base stray; expected one",
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
            "link a does not hang on base, expected every link to",
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
            "the frame of joint: joint3 is [",
        ),
        (
            with(
                "rpy=\"1.5707963267948966 0 0\" xyz=\"0.0825",
                "rpy=\"1.57 0 0\" xyz=\"0.0825",
            ),
            "the frame of joint: joint4 is [",
        ),
        (
            with("xyz=\"0 -0.316 0\"", "xyz=\"0 -0.316\""),
            "'xyz' in <origin> for joint: joint3 is '0 -0.316', expected three finite numbers",
        ),
        (
            with(
                "xyz=\"0 0 0\" rpy=\"0 0 0\"/><parent link=\"base\"/>",
                "xyz=\"0 0 0.1\"/><parent link=\"base\"/>",
            ),
            "the frame of joint: joint1 is [",
        ),
        (
            with("xyz=\"0 0 0.107\"", "xyz=\"0 0 0.1\""),
            "the frame of the flange, link: link8 is [",
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
            // The vendor's parser does not find it inside either.
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
            "the limits of joint joint1 are 2.7501 to -2.7501 rad, expected the lower one first",
        ),
        (
            with("upper=\"2.7501\"", "upper=\"nan\""),
            "'upper' in <limit> for joint: joint1 is 'nan', expected a finite number",
        ),
        (
            with("velocity=\"2.62\"", "velocity=\"2.62rad/s\""),
            "'velocity' in <limit> for joint: joint1 is '2.62rad/s', expected a finite number above 0",
        ),
        (
            with("effort=\"87\"", "effort=\"-87\""),
            "'effort' in <limit> for joint: joint1 is '-87', expected a finite number above 0",
        ),
        (
            with("velocity_offset=\"0.3\"", "velocity_offset=\"-0.3\""),
            "'velocity_offset' in <position_based_velocity_limits> for joint: joint1 is '-0.3', expected a finite \
             number, not negative",
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
            "'value' in <mass> for link: link5 is '-2', expected a finite number above 0",
        ),
        (
            with(&mass, "mass value=\"0\""),
            "'value' in <mass> for link: link5 is '0', expected a finite number above 0",
        ),
        (
            with(&mass, "mass value=\"inf\""),
            "'value' in <mass> for link: link5 is 'inf', expected a finite number above 0",
        ),
        (
            with(&inertia, ""),
            "Missing 'ixx' attribute in <inertia> for link: link5",
        ),
        (
            with(&inertia, "ixx=\"\""),
            "'ixx' in <inertia> for link: link5 is '', expected a finite number",
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

#[test]
fn no_prefix_and_no_single_deletion_of_a_text_panics() {
    let text = text();
    for end in (0..text.len()).step_by(17) {
        assert!(Model::from_urdf(&text[..end]).is_err());
    }
    for start in (0..text.len() - 40).step_by(7) {
        let mut damaged = text.clone();
        damaged.replace_range(start..start + 1 + start % 37, "");
        // Some of it is white space or a mesh: then it is the same robot, or one with another number.
        let _ = Model::from_urdf(&damaged);
    }
}
