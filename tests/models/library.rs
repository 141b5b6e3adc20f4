//! The model library of an FER, from its download to its results, with a stand-in for the vendor's
//! library.

use std::path::PathBuf;
use std::process::Command;
use std::{env, fs, process};

use franka_async::error::{CommandError, LibraryError, ModelLibraryError};
use franka_async::model::{Architecture, ModelLibrary, System};
use franka_model::{EndEffector, Frame, JointVector, Load};
use franka_proto::RequestError;
use franka_sim::Sim;
use nalgebra::{Matrix3, Matrix4, Vector3};

use crate::connected;

/// Compiles the stand-in and returns its bytes.
fn stand_in(name: &str, flags: &[&str]) -> Vec<u8> {
    let manifest = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let output = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let output = output.join(format!("{name}-{}.so", process::id()));
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let status = Command::new(rustc)
        .args([
            "--edition=2024",
            "--crate-type=cdylib",
            "--crate-name=stand_in",
        ])
        .args(flags)
        .arg("-o")
        .arg(&output)
        .arg(manifest.join("models/stand_in.rs"))
        .status();
    assert!(status.expect("a compiler").success());
    let bytes = fs::read(&output).expect("a library");
    fs::remove_file(output).expect("a file");
    bytes
}

/// The number at `place` of the result of the stand-in's function `tag`.
fn expected(tag: u32, place: usize, inputs: &[&[f64]]) -> f64 {
    let weighted = inputs.iter().copied().flatten().zip(1_u32..);
    let sum: f64 = weighted.map(|(x, weight)| x * f64::from(weight)).sum();
    f64::from(tag) + place as f64 / 64.0 + sum
}

#[track_caller]
fn assert_numbers(got: &[f64], tag: u32, inputs: &[&[f64]]) {
    for (place, &got) in got.iter().enumerate() {
        let want = expected(tag, place, inputs);
        assert_eq!(got, want, "function {tag}, place {place}");
    }
}

#[tokio::test]
async fn every_function_of_a_downloaded_library_gets_its_inputs() {
    let bytes = stand_in("whole", &[]);
    let sim = Sim::fer()
        .ideal()
        .configure(|config| config.model_library = Some(bytes.clone().into()));
    let (robot, _sim) = connected(sim).await;
    let downloaded = robot.load_model_library(Architecture::X64, System::Linux);
    assert_eq!(downloaded.await, Ok(bytes));
    // SAFETY: the library was compiled from the source next to this file, with the signatures that
    // `load` names.
    let library = unsafe { robot.model_library() }.await.expect("a library");
    robot.shutdown().await;

    let q = JointVector::from([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]);
    let dq = q.map(|x| 2.0 - x);
    let numbers = |scale: f64| Matrix4::from_fn(|i, j| scale * (i + 4 * j) as f64);
    let ee = EndEffector {
        f_t_ee: numbers(0.25),
        ee_t_k: numbers(0.5),
    };
    let load = Load {
        mass: 1.5,
        com: Vector3::new(0.01, 0.02, 0.03),
        inertia: Matrix3::from_fn(|i, j| (i + 3 * j) as f64),
    };
    let gravity_earth = Vector3::new(0.5, -1.0, -9.81);

    for (frame, number) in Frame::ALL.into_iter().zip(1..) {
        // Both user frames are evaluated as frame 9, at the pose given by the user.
        let stiffness = ee.f_t_ee * ee.ee_t_k;
        let (number, placed): (u32, &[f64]) = match frame {
            Frame::EndEffector => (9, ee.f_t_ee.as_slice()),
            Frame::Stiffness => (9, stiffness.as_slice()),
            _ => (number, &[]),
        };
        let inputs = [q.as_slice(), placed];
        let pose = library.pose(frame, &q, &ee);
        assert_numbers(pose.as_slice(), 10 + number, &inputs);
        // The Jacobian of joint 1 is the same everywhere.
        let inputs = if number == 1 { [&[][..], &[]] } else { inputs };
        let body = library.body_jacobian(frame, &q, &ee);
        assert_numbers(body.as_slice(), 20 + number, &inputs);
        let zero = library.zero_jacobian(frame, &q, &ee);
        assert_numbers(zero.as_slice(), 30 + number, &inputs);
    }
    let (q, dq, g) = (&q, &dq, &gravity_earth);
    let (inertia, mass, com) = (
        load.inertia.as_slice(),
        &[load.mass][..],
        load.com.as_slice(),
    );
    let inputs = [q.as_slice(), inertia, mass, com];
    assert_numbers(library.mass(q, &load).as_slice(), 1, &inputs);
    let inputs = [q.as_slice(), dq.as_slice(), inertia, mass, com];
    assert_numbers(library.coriolis(q, dq, &load).as_slice(), 2, &inputs);
    let inputs = [q.as_slice(), g.as_slice(), mass, com];
    assert_numbers(library.gravity(q, &load, g).as_slice(), 3, &inputs);
}

#[tokio::test]
async fn a_robot_without_a_library_refuses_with_the_vendors_text() {
    let (robot, _sim) = connected(Sim::fer().ideal()).await;
    let refused = robot.load_model_library(Architecture::Arm64, System::Linux);
    let error = refused.await.expect_err("a refusal");
    assert_eq!(
        error.to_string(),
        "libfranka: Server reports error when loading model library."
    );
    // SAFETY: the robot has no library, so nothing is loaded.
    let error = unsafe { robot.model_library() }
        .await
        .expect_err("a refusal");
    assert!(matches!(
        error,
        ModelLibraryError::Command(CommandError::Refused(_))
    ));
    robot.shutdown().await;
}

#[tokio::test]
async fn no_request_is_sent_to_an_fr3() {
    let (robot, _sim) = connected(Sim::fr3().ideal()).await;
    let refused = robot.load_model_library(Architecture::X64, System::Linux);
    let error = refused.await.expect_err("no such command");
    assert!(
        matches!(
            error,
            CommandError::Request(RequestError::Unsupported { .. })
        ),
        "{error}"
    );
    robot.shutdown().await;
}

#[test]
fn invalid_libraries_are_refused_with_the_vendors_text() {
    // SAFETY: these bytes are not a library, so none of their code can run.
    let error = unsafe { ModelLibrary::load(b"no library") }.expect_err("no library");
    assert!(matches!(error, LibraryError::Load { .. }));
    let text = error.to_string();
    assert!(
        text.starts_with("libfranka: Cannot load model library: "),
        "{text}"
    );

    let lacking = stand_in("lacking", &["--cfg", "lacking"]);
    // SAFETY: the library was compiled from the source next to this file, with the signatures that
    // `load` names.
    let error = unsafe { ModelLibrary::load(&lacking) }.expect_err("a function is missing");
    assert!(matches!(error, LibraryError::Symbol { .. }));
    let text = error.to_string();
    assert!(
        text.starts_with("libfranka: Symbol cannot be found: "),
        "{text}"
    );
    assert!(text.contains("g_NE"), "{text}");
}
