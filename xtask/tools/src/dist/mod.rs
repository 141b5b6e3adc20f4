//! `cargo xtask dist` builds the program `franka` for machines without any other software. It
//! checks the program where it can run, and packs it for a release.
//!
//! ```text
//! standard library of the target? ── cargo zigbuild ──> franka ── static? size, time of --help
//!    ── here, or under qemu: a simulated robot, and a motion of it in virtual time
//!    ──> target/artefacts: archive, package for Debian, bill of materials; image of all; SHA256SUMS
//! ```
//!
//! | module | content |
//! |---|---|
//! | this | machines, and building for them |
//! | `archive` | archives that depend on their content only |
//! | `bill` | parts of the program, and their licences |
//! | `content` | files delivered with the program |
//! | `debian` | the package for Debian |
//! | `image` | the container image |
//! | `program` | checking a built program |
//! | `trial` | packed artefacts, used outside the repository |
//!
//! Two builds of one commit are the same, byte for byte: `--twice` builds twice and compares. All
//! times are the commit's, and the build contains no paths of this machine.

mod archive;
mod bill;
mod content;
mod debian;
mod image;
mod program;
mod trial;

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use sha2::{Digest as _, Sha256};
use toml_edit::DocumentMut;

use crate::cross::{architecture, lacks, sysroot, zig};
use crate::release;
use archive::gzip;
use bill::Bill;
use content::Content;
use image::Part;
use program::Program;
use xtask::step::is_ci;
use xtask::workspace::Workspace;

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
    epoch: u64,
    /// The commit.
    revision: String,
    /// Address of the repository; empty without one.
    repository: String,
    /// Maintainer of the package, `Name <address>`; empty without one.
    maintainer: String,
}

impl Release {
    fn of(workspace: &Workspace) -> anyhow::Result<Self> {
        let manifest = fs::read_to_string(workspace.root().join("Cargo.toml"))?;
        let manifest = manifest.parse::<DocumentMut>()?;
        let text = |table: &str, name: &str| {
            let value = manifest["workspace"].get(table).and_then(|it| it.get(name));
            value
                .and_then(|it| it.as_str())
                .unwrap_or_default()
                .to_owned()
        };
        let epoch = match env::var("SOURCE_DATE_EPOCH") {
            Ok(epoch) => epoch,
            Err(_) => release::git(workspace, &["log", "-1", "--format=%ct"])?,
        };
        Ok(Self {
            version: release::version::of(workspace)?,
            epoch: epoch
                .parse()
                .with_context(|| format!("got the time {epoch:?}"))?,
            revision: release::git(workspace, &["rev-parse", "HEAD"])?,
            repository: text("package", "repository"),
            maintainer: release::version::maintainer(workspace)?,
        })
    }

    #[cfg(test)]
    fn example() -> Self {
        Self {
            version: "0.1.0".to_owned(),
            epoch: 1_800_000_000,
            revision: "0".repeat(40),
            repository: String::new(),
            maintainer: String::new(),
        }
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
    let release = Release::of(workspace)?;
    let mut artefacts = Artefacts::begin(workspace)?;
    let (mut built, mut lines, mut parts) = (0, Vec::new(), Vec::new());
    let mut of_this_machine = None;
    for machine in &chosen {
        let line = match machine.build(workspace, &release, "")? {
            Ok(path) => {
                built += 1;
                let mut line = match Program::new(path.clone(), architecture(machine.target)) {
                    Err(why) => format!("NOT CHECKED, NOT PACKED: {why}"),
                    Ok(program) => {
                        let about = program.check(machine.is_static())?;
                        let packed = machine.pack(
                            workspace,
                            &release,
                            &program,
                            &mut artefacts,
                            &mut parts,
                        )?;
                        if program.is_of_this_machine() {
                            of_this_machine.get_or_insert(*machine);
                        }
                        format!("{about}; {packed}")
                    }
                };
                if depth.twice {
                    line += &machine.compare(workspace, &release, &path)?;
                }
                line
            }
            Err(why) => format!("NOT BUILT, NOT CHECKED: {why}"),
        };
        lines.push(format!("{}: {line}", machine.target));
    }
    lines.push(match parts.is_empty() {
        true => "image: NOT BUILT: it needs a static program".to_owned(),
        false => {
            let name = format!("franka-{}.oci.tar", release.version);
            let file = artefacts.add(&name, &image::image(&release, &parts)?)?;
            let work = workspace.target().join("image-copy");
            format!("{name}: {}", image::check(workspace, &file, &work)?)
        }
    });
    let directory = artefacts.end()?;
    if depth.trial {
        let machine = of_this_machine.context("no chosen program is for this machine")?;
        lines.extend(trial::run(workspace, &release, machine, &directory)?);
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
    /// The program, or the missing requirement to build it. The output goes to the build directory,
    /// or to a directory in it.
    fn build(
        &self,
        workspace: &Workspace,
        release: &Release,
        directory: &str,
    ) -> anyhow::Result<Result<PathBuf, String>> {
        let sysroot = sysroot()?;
        if let Some(why) = lacks(self.target, &sysroot) {
            return Ok(Err(why));
        }
        let path = match zig(workspace)? {
            Ok(path) => path,
            Err(why) => return Ok(Err(why)),
        };
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
        build.env("SOURCE_DATE_EPOCH", release.epoch.to_string());
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
        Ok(Ok(target.join(self.target).join("dist/franka")))
    }

    fn is_static(&self) -> bool {
        self.glibc.is_empty()
    }

    /// The name of its archive and of the directory in the archive.
    fn name(&self, release: &Release) -> String {
        format!("franka-{}-{}", release.version, self.target)
    }

    fn for_debian(&self) -> anyhow::Result<debian::Target<'static>> {
        let architecture = match architecture(self.target) {
            "x86_64" => "amd64",
            "aarch64" => "arm64",
            other => anyhow::bail!("no name for {other}"),
        };
        Ok(debian::Target {
            architecture,
            glibc: (!self.is_static()).then_some(self.glibc),
        })
    }

    /// Packs a program; adds it to the parts of the image if it can run in one. Returns a line
    /// about it.
    fn pack(
        &self,
        workspace: &Workspace,
        release: &Release,
        program: &Program,
        artefacts: &mut Artefacts,
        parts: &mut Vec<Part>,
    ) -> anyhow::Result<String> {
        let bill = Bill::of(workspace, self.target, &release.version)?;
        let work = workspace.target().join("man-pages");
        if work.exists() {
            fs::remove_dir_all(&work)?;
        }
        let content = Content::collect(workspace, program, &work, bill.licences()?)?;
        let name = self.name(release);
        artefacts.add(&format!("{name}.cdx.json"), bill.to_json()?.as_bytes())?;
        let archive = archive::tar(&content.portable(&name), release.epoch)?;
        artefacts.add(&format!("{name}.tar.gz"), &gzip(&archive)?)?;
        let for_debian = self.for_debian()?;
        // One package per architecture, of the static program, which is built first if possible.
        let package = artefacts.add_first(&debian::file_name(release, for_debian), || {
            debian::package(release, for_debian, &content)
        })?;
        if self.is_static() {
            parts.push(Part {
                architecture: for_debian.architecture,
                program: content.program,
                papers: content.papers,
            });
        }
        let count = bill.count();
        let package = match package {
            Some(package) => debian::check(workspace, &package)?,
            None => "is the bill of the static program".to_owned(),
        };
        Ok(format!("{count} crates in its bill; package {package}"))
    }

    /// Builds again, in another directory, and compares.
    fn compare(
        &self,
        workspace: &Workspace,
        release: &Release,
        first: &Path,
    ) -> anyhow::Result<String> {
        let second = self.build(workspace, release, "second")?;
        let second = second.map_err(|why| anyhow::anyhow!("the second build: {why}"))?;
        let [one, other] = [hash(&fs::read(first)?), hash(&fs::read(second)?)];
        ensure!(
            one == other,
            "two builds of {}: {one} and {other}",
            self.target
        );
        Ok(format!("; built twice, both times {one}"))
    }
}

/// The delivered files and their checksums.
struct Artefacts {
    directory: PathBuf,
    sums: Vec<(String, String)>,
}

impl Artefacts {
    /// Replaces the artefacts of an earlier run.
    fn begin(workspace: &Workspace) -> anyhow::Result<Self> {
        let directory = workspace.target().join("artefacts");
        if directory.exists() {
            fs::remove_dir_all(&directory)?;
        }
        fs::create_dir_all(&directory)?;
        Ok(Self {
            directory,
            sums: Vec::new(),
        })
    }

    fn has(&self, name: &str) -> bool {
        self.sums.iter().any(|(other, _)| other == name)
    }

    fn add(&mut self, name: &str, content: &[u8]) -> anyhow::Result<PathBuf> {
        ensure!(!self.has(name), "two files are named {name}");
        let file = self.directory.join(name);
        fs::write(&file, content)?;
        self.sums.push((name.to_owned(), hash(content)));
        Ok(file)
    }

    /// Adds an artefact, unless a file of this name exists.
    fn add_first(
        &mut self,
        name: &str,
        make: impl FnOnce() -> anyhow::Result<Vec<u8>>,
    ) -> anyhow::Result<Option<PathBuf>> {
        if self.has(name) {
            return Ok(None);
        }
        self.add(name, &make()?).map(Some)
    }

    /// Writes the checksums, as `sha256sum --check` reads them; returns the directory.
    fn end(mut self) -> anyhow::Result<PathBuf> {
        self.sums.sort();
        let lines = self
            .sums
            .iter()
            .map(|(name, hash)| format!("{hash}  {name}\n"));
        let lines: String = lines.collect();
        println!("\n{}:\n{lines}", self.directory.display());
        fs::write(self.directory.join("SHA256SUMS"), lines)?;
        Ok(self.directory)
    }
}

/// SHA-256 in hexadecimal digits.
fn hash(content: &[u8]) -> String {
    format!("{:x}", Sha256::digest(content))
}

/// Cargo's directory with the sources of dependencies.
fn cargo_home() -> anyhow::Result<PathBuf> {
    if let Some(home) = env::var_os("CARGO_HOME") {
        return Ok(home.into());
    }
    let home = env::var_os("HOME").context("neither CARGO_HOME nor HOME is set")?;
    Ok(PathBuf::from(home).join(".cargo"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_file_of_a_name_is_the_one() -> anyhow::Result<()> {
        let name = format!("franka-xtask-{}-artefacts", std::process::id());
        let directory = env::temp_dir().join(name);
        fs::create_dir_all(&directory)?;
        let mut artefacts = Artefacts {
            directory: directory.clone(),
            sums: Vec::new(),
        };
        let first = artefacts.add_first("a.deb", || Ok(b"static".to_vec()))?;
        assert_eq!(fs::read(first.expect("the first"))?, b"static");
        let second = artefacts.add_first("a.deb", || unreachable!("it is not made"))?;
        assert_eq!(second, None);
        artefacts.add("a.deb", b"twice").unwrap_err();
        artefacts.end()?;
        let sums = fs::read_to_string(directory.join("SHA256SUMS"))?;
        assert_eq!(sums, format!("{}  a.deb\n", hash(b"static")));
        fs::remove_dir_all(directory)?;
        Ok(())
    }
}
