//! `cargo xtask dist --try`: uses the artefacts of a release as users would, in a directory outside
//! the repository. That directory contains only the artefacts, and programs of the book.
//!
//! ```text
//! archive ────────────> franka sim --dash, no variables, PATH empty <── page, socket, motion
//! package for Debian ─> the same
//! packages of crates ─> a service, started against that simulator <── HTTP: a job; and its tests
//! wheel ──────────────> a program in a new virtual environment, PATH empty
//! ```

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Context as _, ensure};
use tungstenite::client::ClientRequestBuilder;

use super::program::moves;
use super::{Machine, Release};
use crate::cross::is_installed;
use crate::package::wheels;
use xtask::python::{ANY, Uv};
use xtask::running::Running;
use xtask::step::or_missing;
use xtask::workspace::Workspace;

/// Tries archive and package of a program for this machine, and crates and wheel as packed now;
/// returns a line about each. The directory stays after a failure.
pub(super) fn run(
    workspace: &Workspace,
    release: &Release,
    machine: &Machine,
) -> anyhow::Result<Vec<String>> {
    let packages = crate::release::packages(workspace)?;
    let wheel = or_missing(wheels::for_this_machine(workspace))?;
    let directory = env::temp_dir().join(format!("franka-try-{}", std::process::id()));
    let outside = Outside { directory };
    fs::create_dir_all(outside.at("nothing"))?;
    println!("\n{}:", outside.directory.display());

    let unpacked = outside.at("archive");
    let name = machine.name(release);
    let archive = release.artefacts.join(format!("{name}.tar.gz"));
    unpack(workspace, &archive, &unpacked)?;
    let franka = unpacked.join(name).join("franka");
    let mut lines = vec![timed("the archive", || outside.simulates(&franka))?];

    lines.push(match is_installed("dpkg-deb") {
        true => timed("the package for Debian", || {
            let package = release.artefacts.join(release.package(machine));
            let mut unpack = Command::new("dpkg-deb");
            unpack.arg("-x").arg(package);
            workspace.run(unpack.arg(outside.at("debian")))?;
            outside.simulates(&outside.at("debian/usr/bin/franka"))
        })?,
        false => "the package for Debian: NOT TRIED: dpkg-deb is not installed".to_owned(),
    });

    lines.push(timed("the crates", || {
        for package in &packages {
            unpack(workspace, package, &outside.at("crates"))?;
        }
        outside.serves(workspace, &franka, &packages, &release.version)
    })?);

    lines.push(match wheel {
        Ok(wheel) => timed("the wheel", || outside.scripts(workspace, &franka, &wheel))?,
        Err(why) => format!("the wheel: NOT TRIED: {why}"),
    });
    fs::remove_dir_all(&outside.directory)?;
    Ok(lines)
}

/// The directory outside the repository.
struct Outside {
    directory: PathBuf,
}

impl Outside {
    fn at(&self, name: &str) -> PathBuf {
        self.directory.join(name)
    }

    /// A program in the directory, without variables and without any other program: no compiler is
    /// available.
    fn alone(&self, program: &Path) -> Command {
        let mut command = Command::new(program);
        command.current_dir(&self.directory);
        command.env_clear().env("PATH", self.at("nothing"));
        command
    }

    /// Cargo or Python, with the variables of this process except those that refer to the
    /// repository.
    fn beside(&self, program: Command) -> Command {
        let mut command = program;
        command.current_dir(self.at("service"));
        command.env_remove("CARGO_TARGET_DIR");
        command
    }

    /// A simulator in virtual time, and its address.
    fn simulator(&self, franka: &Path) -> anyhow::Result<(Running, String)> {
        let mut sim = self.alone(franka);
        sim.args(["sim", "--port", "0", "--virtual-time=60"]);
        sim.args(["--dash", "127.0.0.1:0"]);
        let mut sim = Running::start("franka sim", sim)?;
        let address = sim.address("listening on ")?;
        Ok((sim, address))
    }

    /// `franka sim` with its dashboard, and a motion.
    fn simulates(&self, franka: &Path) -> anyhow::Result<String> {
        let (mut sim, address) = self.simulator(franka)?;
        let page = sim.address("dashboard on http://")?;
        let page = page.trim_end_matches('/');
        let html = get(&format!("http://{page}/"))?;
        ensure!(html.contains("dash.js"), "got the page {html:?}");
        let script = get(&format!("http://{page}/dash.js"))?.len();
        let socket = ClientRequestBuilder::new(format!("ws://{page}/ws").parse()?);
        tungstenite::connect(socket.with_sub_protocol("franka-dash"))?;
        moves(self.alone(franka), &address)?;
        Ok(format!(
            "franka sim with a dashboard ({script} bytes of script, a socket), franka move"
        ))
    }

    /// A service on the packaged crates, which moves a robot of the packaged simulator on request,
    /// and tests of a program that uses the simulator's library.
    fn serves(
        &self,
        workspace: &Workspace,
        franka: &Path,
        packages: &[PathBuf],
        version: &str,
    ) -> anyhow::Result<String> {
        let project = self.at("service");
        for (name, content) in [("src/main.rs", SERVICE), ("tests/template.rs", TESTS)] {
            let file = project.join(name);
            fs::create_dir_all(file.parent().context("in a directory")?)?;
            fs::write(file, content)?;
        }
        let names = packages.iter().filter_map(|it| it.file_stem()?.to_str());
        fs::write(project.join("Cargo.toml"), manifest(names, version))?;
        // The versions of dependencies that this release was tested with.
        let dash = format!("crates/franka-dash-{version}/Cargo.lock");
        fs::copy(self.at(&dash), project.join("Cargo.lock"))?;
        let mut build = self.beside(workspace.cargo());
        workspace.run(build.args(["build", "--quiet"]))?;
        let built = Instant::now();
        let (_sim, address) = self.simulator(franka)?;
        let mut service = self.alone(&project.join("target/debug/service"));
        service.arg(address);
        let mut service = Running::start("service", service)?;
        let listening = service.address("listening on ")?;
        let jobs = format!("http://{listening}/jobs");
        let taken = ureq::post(&jobs).send_json([0.0, 0.0, 0.05])?;
        ensure!(taken.status() == 202, "got {taken:?}");
        let outcomes = loop {
            let outcomes = get(&jobs)?;
            if outcomes != "[]" {
                break outcomes;
            }
            ensure!(built.elapsed() < SOON, "the job never ends");
            sleep(Duration::from_millis(50));
        };
        let expected = "[\"arrived\"]";
        ensure!(
            outcomes == expected,
            "got {outcomes:?}, expected {expected}"
        );
        let mut test = self.beside(workspace.cargo());
        workspace.run(test.args(["test", "--quiet"]))?;
        Ok("a service that moves the robot, and its tests".to_owned())
    }

    /// A program on the wheel.
    fn scripts(
        &self,
        workspace: &Workspace,
        franka: &Path,
        wheel: &Path,
    ) -> anyhow::Result<String> {
        let uv = Uv::find(workspace)?;
        let interpreter = uv.create(workspace, &self.at("python"), ANY)?;
        let mut install = self.beside(uv.pip(workspace, "install", &interpreter));
        workspace.run(install.arg("--only-binary=:all:").arg(wheel))?;
        let script = self.at("quickstart.py");
        fs::write(&script, SCRIPT)?;
        let (_sim, address) = self.simulator(franka)?;
        for robot in [Some(&address), None] {
            let mut program = self.alone(&interpreter);
            workspace.run(program.arg(&script).args(robot))?;
        }
        Ok("a program, with that simulator and with its own".to_owned())
    }
}

/// A line about a trial, and its duration.
fn timed(what: &str, attempt: impl FnOnce() -> anyhow::Result<String>) -> anyhow::Result<String> {
    let begin = Instant::now();
    let about = attempt().with_context(|| what.to_owned())?;
    let seconds = begin.elapsed().as_secs_f64();
    Ok(format!("{what}: {about}, in {seconds:.1} s"))
}

fn unpack(workspace: &Workspace, archive: &Path, directory: &Path) -> anyhow::Result<()> {
    fs::create_dir_all(directory)?;
    let mut tar = workspace.program("tar");
    tar.arg("--directory").arg(directory).arg("-xzf");
    workspace.run(tar.arg(archive))
}

fn get(address: &str) -> anyhow::Result<String> {
    Ok(ureq::get(address).call()?.body_mut().read_to_string()?)
}

/// The manifest of a program that finds these packages instead of a registry's packages.
fn manifest<'a>(packages: impl Iterator<Item = &'a str>, version: &str) -> String {
    let mut text = format!(
        "[package]\nname = \"service\"\nedition = \"2024\"\n\n\
         [dependencies]\nanyhow = \"1\"\naxum = \"0.8\"\n\
         franka-async = {{ version = \"{version}\", features = [\"admission\"] }}\n\
         tokio = {{ version = \"1\", features = [\"full\"] }}\n\n\
         [dev-dependencies]\nfranka-sim = \"{version}\"\n\n[patch.crates-io]\n"
    );
    for package in packages {
        let name = package.trim_end_matches(version).trim_end_matches('-');
        text += &format!("{name} = {{ path = \"../crates/{package}\" }}\n");
    }
    text
}

/// Time limit for a job.
const SOON: Duration = Duration::from_secs(60);

/// Programs of the book, which users copy.
const SERVICE: &str = include_str!("../../../../examples/24_job_queue.rs");
const TESTS: &str = include_str!("../../../../examples/tests/template.rs");
const SCRIPT: &str = include_str!("../../../../franka-py/examples/quickstart.py");
