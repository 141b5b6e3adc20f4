mod faults;

use super::*;
use crate::geometry::{FLANGE, JOINT_ORIGINS, Lengths};
use crate::{Load, READY};
use std::fmt::Write;
use std::format;
use std::vec::Vec;

/// Returns the numbers with all digits, as Rust prints them.
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

/// Returns the URDF of the FR3 with the other parts of a vendor's text: a `base` link, meshes,
/// dampings, accelerometers.
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

/// Returns the text with one passage replaced. The passage must exist.
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
fn urdf_with_recorded_lengths_is_read_but_no_mixture() {
    let lengths = Lengths::RECORDED_FR3;
    let upper = with("0 -0.316 0", "0 -0.3162 0");
    let both = upper.replace("-0.0825 0.384 0", "-0.0825 0.3842 0");
    assert_eq!(
        Model::from_urdf(&both).expect("a model"),
        Model::fr3().clone().with_lengths(lengths)
    );
    let UrdfError::Origin { owner, .. } = refused(&upper) else {
        panic!("half of a set passed");
    };
    assert_eq!(owner, "joint: joint3");
}

#[test]
fn urdf_variants_of_the_vendors_parser_are_accepted() {
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
fn urdf_joint_order_is_free_and_angles_may_be_rounded() {
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
    // The range keeps the same distance from the limits as the documented range.
    assert!((limits.lower[0] + 1.0 - 0.0064).abs() < 1e-15);
    assert!((limits.upper[0] - 2.0 + 0.0064).abs() < 1e-15);
    let (_, upper) = limits.velocity_envelope(&READY, 0.0);
    assert_eq!(upper[0], 1.5);

    let wider = with("upper=\"2.7501\"", "upper=\"3.1\"");
    let limits = *Model::from_urdf(&wider).expect("a model").joint_limits();
    assert_eq!(limits.hard_upper[0], 3.1);
    assert!((limits.upper[0] - 3.1 + 0.0064).abs() < 1e-15);

    let envelope = with(
        "velocity_offset=\"0.3\" deceleration_limit=\"6\"",
        "velocity_offset=\"0.1\" deceleration_limit=\"3\"",
    );
    let limits = *Model::from_urdf(&envelope).expect("a model").joint_limits();
    let envelope = limits.envelope.expect("an envelope");
    assert_eq!((envelope.offset[0], envelope.deceleration[0]), (0.1, 3.0));
}

#[test]
fn fixed_part_counts_towards_its_link() {
    let part = r#"<inertial><origin xyz="0 0 0.02" rpy="0 1.5707963267948966 0"/><mass value="0.5"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.003"/></inertial>"#;
    let text = with(
        "<link name=\"link8\"/>",
        &format!("<link name=\"link8\">{part}</link>"),
    );
    let model = Model::from_urdf(&text).expect("a model");
    // The link's load, turned by a quarter turn about y (x and z swapped), is the same body as this
    // load.
    let load = Load {
        mass: 0.5,
        com: nalgebra::Vector3::new(0.0, 0.0, 0.02),
        inertia: nalgebra::Matrix3::from_diagonal(&nalgebra::Vector3::new(0.003, 0.002, 0.001)),
    };
    let expected = Model::fr3().mass(&READY, &load);
    assert!((model.mass(&READY, &Load::NONE) - expected).amax() < 1e-16);
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
        // Damage to white space or to a mesh does not change the robot. Other damage may change a
        // number.
        let _ = Model::from_urdf(&damaged);
    }
}

#[test]
fn replaced_number_gives_a_finite_model_or_a_refusal() {
    let text = text();
    // Every passage between quotation marks, and the numbers in it.
    let quoted = text.split('"').skip(1).step_by(2);
    let starts = quoted.map(|passage| passage.as_ptr() as usize - text.as_ptr() as usize);
    let (mut accepted, mut refused) = (0, 0);
    for start in starts {
        let end = start + text[start..].find('"').expect("an end");
        let numbers: Vec<&str> = text[start..end].split(' ').collect();
        if numbers.iter().any(|number| number.parse::<f64>().is_err()) {
            continue;
        }
        for bad in [
            "0", "1e6", "-1e6", "1e7", "1e308", "5e-324", "-inf", "NaN", "1e",
        ] {
            for i in 0..numbers.len() {
                let mut numbers = numbers.clone();
                numbers[i] = bad;
                let mut text = text.clone();
                text.replace_range(start..end, &numbers.join(" "));
                match Model::from_urdf(&text) {
                    Ok(model) => {
                        let mass = model.mass(&READY, &Load::NONE);
                        assert!(
                            mass.iter().all(|x| x.is_finite()),
                            "{bad} for {}",
                            &text[start..end]
                        );
                        accepted += 1;
                    }
                    Err(_) => refused += 1,
                }
            }
        }
    }
    assert!(
        accepted > 100 && refused > 1000,
        "{accepted} accepted, {refused} refused"
    );
}
