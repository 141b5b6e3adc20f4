//! `cargo xtask dist` builds the program `franka` for machines without any other software. It
//! checks the program where it can run, and packs it for a release.
//!
//! ```text
//! standard library of the target? ── cargo zigbuild ──> franka ── static? size
//!    ── here, or under qemu: a simulated robot, and a motion of it in virtual time
//!    ──> target/artefacts: archive, package for Debian, bill of materials; SHA256SUMS
//!    ──> target/image: the files of the image that `franka-cli/dist/image.sh` builds
//! ```
//!
//! | module | content |
//! |---|---|
//! | this | machines, building for them, and packing with tar and cargo-deb |
//! | `bill` | parts of the program, and their licences |
//! | `program` | checking a built program |
//! | `trial` | packed artefacts, used outside the repository |
//!
//! Two builds of one commit are the same program, byte for byte: `--twice` builds twice and
//! compares. All times are the commit's, and the build contains no paths of this machine.

mod bill;
mod program;
mod trial;

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use anyhow::{Context as _, bail, ensure};
use jiff::Timestamp;

use crate::cross::{STD, architecture, is_installed, lacks, sysroot, zig};
use crate::metadata::{self, copy_directory};
use crate::release;
use crate::tools;
use bill::Bill;
use program::Program;
use xtask::step::{Missing, or_missing};
use xtask::workspace::{Workspace, is_ci};

/// A machine to build for.
struct Machine {
    target: &'static str,
    /// The oldest supported C library; empty if the program contains it.
    glibc: &'static str,
}

const MACHINES: [Machine; 3] = [
    Machine {
        target: "x86_64-unknown-linux-musl",
        glibc: "",
    },
    Machine {
        target: "aarch64-unknown-linux-musl",
        glibc: "",
    },
    Machine {
        target: "x86_64-unknown-linux-gnu",
        glibc: "2.17",
    },
];

/// Common data of all files of a release.
#[derive(Debug)]
struct Release {
    version: String,
    /// Time of the commit, in seconds since 1970.
    epoch: String,
    /// Maintainer of the package for Debian, `Name <address>`.
    maintainer: String,
    /// The directory of the artefacts.
    artefacts: PathBuf,
}

impl Release {
    /// Removes the artefacts of an earlier run.
    fn begin(workspace: &Workspace) -> anyhow::Result<Self> {
        let metadata = metadata::of(workspace)?;
        let artefacts = empty(workspace.target().join("artefacts"))?;
        let maintainer = metadata.workspace_metadata["maintainer"].as_str();
        Ok(Self {
            version: release::version(&metadata),
            epoch: match env::var("SOURCE_DATE_EPOCH") {
                Ok(epoch) => epoch,
                Err(_) => workspace.git(&["log", "-1", "--format=%ct"])?,
            },
            maintainer: match maintainer.unwrap_or_default() {
                // No address below `.invalid` exists (RFC 2606).
                "" => "Unreleased build <nobody@franka-async.invalid>".to_owned(),
                maintainer => maintainer.to_owned(),
            },
            artefacts,
        })
    }

    /// Name of the package for Debian.
    fn package(&self, machine: &Machine) -> String {
        let architecture = machine.architecture();
        format!("franka-cli_{}-1_{architecture}.deb", self.version)
    }
}

/// Checks besides those of each program.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Depth {
    /// Build everything twice: differences are failures.
    pub(crate) twice: bool,
    /// Use the program for this machine, the crates and the wheel outside the repository.
    pub(crate) trial: bool,
}

/// Builds for every machine that this one can build for, checks the programs that can run here,
/// packs them, and reports the result of each. Fails if a check fails or if no program was built;
/// with `CI=true`, fails if any was not built.
pub(crate) fn run(workspace: &Workspace, only: &[String], depth: Depth) -> anyhow::Result<()> {
    let is_chosen =
        |machine: &&Machine| only.is_empty() || only.iter().any(|it| it == machine.target);
    let chosen: Vec<&Machine> = MACHINES.iter().filter(is_chosen).collect();
    let targets = MACHINES.map(|machine| machine.target).join(", ");
    ensure!(!chosen.is_empty(), "the targets are {targets}");
    let release = Release::begin(workspace)?;
    let image = empty(workspace.target().join("image"))?;
    let (mut built, mut lines) = (0, Vec::new());
    let mut of_this_machine = None;
    for machine in &chosen {
        let line = match or_missing(machine.build(workspace, &release, ""))? {
            Ok(path) => {
                built += 1;
                let program = Program::new(path.clone(), architecture(machine.target));
                let mut line = match or_missing(program)? {
                    Err(why) => format!("NOT CHECKED, NOT PACKED: {why}"),
                    Ok(program) => {
                        let about = program.check(machine.is_static())?;
                        let packed = machine.pack(workspace, &release, &program, &image)?;
                        if program.is_of_this_machine() {
                            of_this_machine.get_or_insert(*machine);
                        }
                        format!("{about}; {packed}")
                    }
                };
                if depth.twice {
                    line += machine.compare(workspace, &release, &path)?;
                }
                line
            }
            Err(why) => format!("NOT BUILT, NOT CHECKED: {why}"),
        };
        lines.push(format!("{}: {line}", machine.target));
    }
    let mut sums = workspace.program("sh");
    sums.current_dir(&release.artefacts);
    workspace.run(sums.args(["-c", "sha256sum -- * > SHA256SUMS"]))?;
    if depth.trial {
        let machine = of_this_machine.context("no chosen program is for this machine")?;
        lines.extend(trial::run(workspace, &release, machine)?);
    }
    println!("\n{}", lines.join("\n"));
    ensure!(built > 0, "nothing was built");
    ensure!(
        built == chosen.len() || !is_ci(),
        "with CI=true every chosen program must be built"
    );
    Ok(())
}

impl Machine {
    /// The program. The output goes to the build directory, or to a directory in it.
    fn build(
        &self,
        workspace: &Workspace,
        release: &Release,
        directory: &str,
    ) -> anyhow::Result<PathBuf> {
        if let Some(why) = lacks(self.target, STD) {
            bail!(Missing(why));
        }
        let path = zig(workspace)?;
        let sysroot = sysroot(workspace)?;
        let target = match directory {
            "" => workspace.target().to_owned(),
            directory => workspace.target().join(directory),
        };
        let mut build = workspace.cargo();
        build.args(["zigbuild", "--locked", "--profile", "dist"]);
        build.args(["--package", "franka-cli", "--features", "full", "--target"]);
        build.arg(match self.glibc {
            "" => self.target.to_owned(),
            glibc => format!("{}.{glibc}", self.target),
        });
        build.env("PATH", path);
        build.env("CARGO_TARGET_DIR", &target);
        build.env("SOURCE_DATE_EPOCH", &release.epoch);
        // Panics and debug information use the file names of the repository. The last match counts,
        // and the build directory is inside the workspace.
        let places = [
            (&cargo_home()?, "/cargo"),
            (&sysroot, "/rust"),
            (&workspace.root().to_owned(), "/franka-async"),
            (&target, "/target"),
        ];
        let flags = places.map(|(from, to)| format!("--remap-path-prefix={}={to}", from.display()));
        build.env("RUSTFLAGS", flags.join(" "));
        let prefixes =
            places.map(|(from, to)| format!("-ffile-prefix-map={}={to}", from.display()));
        build.env("CFLAGS", prefixes.join(" "));
        workspace.run(&mut build)?;
        Ok(target.join(self.target).join("dist/franka"))
    }

    fn is_static(&self) -> bool {
        self.glibc.is_empty()
    }

    /// The name of its archive and of the directory in the archive.
    fn name(&self, release: &Release) -> String {
        format!("franka-{}-{}", release.version, self.target)
    }

    /// The architecture's name in Go and for Debian.
    fn architecture(&self) -> &'static str {
        match architecture(self.target) {
            "aarch64" => "arm64",
            _ => "amd64",
        }
    }

    /// Packs a program; adds it to the files of the `image` if it can run in one. Returns a line
    /// about it.
    fn pack(
        &self,
        workspace: &Workspace,
        release: &Release,
        program: &Program,
        image: &Path,
    ) -> anyhow::Result<String> {
        let bill = Bill::of(workspace, self.target, &release.version)?;
        let name = self.name(release);
        let file = release.artefacts.join(format!("{name}.cdx.json"));
        fs::write(file, bill.to_json()?)?;
        // The directory where `package.metadata.deb` finds the files.
        let stage = empty(program.path.with_file_name("stage"))?;
        stage_files(workspace, program, &stage, &bill.licences()?)?;
        let mut archive = workspace.program("tar");
        archive.args(["--sort=name", "--owner=0", "--group=0", "--numeric-owner"]);
        archive.args(["--mode=u=rwX,go=rX", "--use-compress-program=gzip -9n"]);
        archive.arg(format!("--mtime=@{}", release.epoch));
        archive.arg(format!("--transform=s,^\\.,{name},"));
        archive.arg("--directory").arg(&stage).arg("--create");
        archive
            .arg("--file")
            .arg(release.artefacts.join(format!("{name}.tar.gz")));
        workspace.run(archive.arg("."))?;
        if self.is_static() {
            let root = image.join(self.architecture());
            let (programs, doc) = (root.join("usr/bin"), root.join("usr/share/doc/franka"));
            for directory in [&programs, &doc] {
                fs::create_dir_all(directory)?;
            }
            fs::copy(stage.join("franka"), programs.join("franka"))?;
            for paper in PAPERS.iter().chain(&["THIRD-PARTY"]) {
                fs::copy(stage.join(paper), doc.join(paper))?;
            }
        }
        let count = bill.count();
        let package = self.package(workspace, release, &stage)?;
        Ok(format!("{count} crates in its bill; package {package}"))
    }

    /// Makes the package for Debian, one per architecture. The static program, which is built first
    /// if possible, is in it. Returns a line about it.
    fn package(
        &self,
        workspace: &Workspace,
        release: &Release,
        stage: &Path,
    ) -> anyhow::Result<&'static str> {
        let package = release.artefacts.join(release.package(self));
        if package.exists() {
            return Ok("is that of the static program");
        }
        let time = Timestamp::from_second(release.epoch.parse()?)?;
        let changes = format!(
            "franka-cli ({}-1) unstable; urgency=medium\n\n  * See changelog.gz beside this file.\n\n -- {}  {}\n",
            release.version,
            release.maintainer,
            time.strftime("%a, %d %b %Y %H:%M:%S +0000"),
        );
        fs::write(stage.join("changelog.Debian"), changes)?;
        let mut gzip = workspace.program("gzip");
        gzip.args(["-9nr", "man", "THIRD-PARTY", "changelog.Debian"]);
        workspace.run(gzip.current_dir(stage))?;
        let mut deb = workspace.cargo();
        deb.args(["deb", "--no-build", "--no-strip", "--locked", "--quiet"]);
        deb.args(["--package", "franka-cli", "--profile", "dist"]);
        deb.args(["--target", self.target, "--maintainer", &release.maintainer]);
        if !self.is_static() {
            deb.args(["--variant", "glibc"]);
        }
        deb.arg("--output").arg(&package);
        deb.env("PATH", tools::path_with(workspace, tools::DEB)?);
        workspace.run(deb.env("SOURCE_DATE_EPOCH", &release.epoch))?;
        if !is_installed("lintian") {
            return Ok("NOT CHECKED: lintian is not installed");
        }
        let mut lintian = workspace.program("lintian");
        lintian.args(["--fail-on", "error,warning", "--allow-root"]);
        // The home page is the repository, which is not set yet.
        lintian.args(["--suppress-tags", "bad-homepage,empty-field"]);
        workspace.run(lintian.arg(package))?;
        Ok("checked by lintian")
    }

    /// Builds again, in another directory, and compares.
    fn compare(
        &self,
        workspace: &Workspace,
        release: &Release,
        first: &Path,
    ) -> anyhow::Result<&'static str> {
        let second = self.build(workspace, release, "second")?;
        let is_same = fs::read(first)? == fs::read(second)?;
        ensure!(is_same, "two builds of {} differ", self.target);
        Ok("; built twice, both times the same")
    }
}

/// Collects the files that are delivered with a program, from the workspace and from the program
/// itself.
fn stage_files(
    workspace: &Workspace,
    program: &Program,
    stage: &Path,
    licences: &str,
) -> anyhow::Result<()> {
    fs::copy(&program.path, stage.join("franka"))?;
    fs::write(stage.join("THIRD-PARTY"), licences)?;
    for name in ["LICENSE", "NOTICE", "CHANGELOG.md"] {
        fs::copy(workspace.root().join(name), stage.join(name))?;
    }
    let package = workspace.root().join("franka-cli");
    fs::copy(package.join("README.md"), stage.join("README.md"))?;
    copy_directory(&package.join("dist/examples"), &stage.join("examples"))?;
    let mut man = program.command();
    let status = man.arg("man").arg(stage.join("man")).stdout(Stdio::null());
    ensure!(status.status()?.success(), "no man pages were written");
    fs::create_dir(stage.join("completions"))?;
    for shell in ["bash", "fish", "zsh"] {
        let output = program.command().args(["completions", shell]).output()?;
        ensure!(output.status.success(), "no completions for {shell}");
        let file = stage.join(format!("completions/franka.{shell}"));
        fs::write(file, output.stdout)?;
    }
    Ok(())
}

/// An empty directory, in place of an earlier one.
fn empty(directory: PathBuf) -> anyhow::Result<PathBuf> {
    if directory.exists() {
        fs::remove_dir_all(&directory)?;
    }
    fs::create_dir_all(&directory)?;
    Ok(directory)
}

/// Cargo's directory with the sources of dependencies.
fn cargo_home() -> anyhow::Result<PathBuf> {
    if let Some(home) = env::var_os("CARGO_HOME") {
        return Ok(home.into());
    }
    let home = env::var_os("HOME").context("neither CARGO_HOME nor HOME is set")?;
    Ok(PathBuf::from(home).join(".cargo"))
}

/// Texts of the workspace in the image.
const PAPERS: [&str; 3] = ["LICENSE", "NOTICE", "README.md"];
