//! The package for Debian and its content: program, man pages, completions, examples. It changes
//! nothing on a host. The configuration of a real-time host is an example, and `franka doctor`
//! reports what is missing.
//!
//! ```text
//! ar: debian-binary, control.tar.gz (control, md5sums), data.tar.gz (files)
//! ```

use std::path::Path;

use jiff::Timestamp;
use md5::{Digest as _, Md5};

use super::Release;
use super::archive::{Entry, gzip, tar};
use super::content::Content;
use crate::cross::is_installed;
use xtask::workspace::Workspace;

/// The name of the package.
pub(super) const NAME: &str = "franka-cli";

/// Maintainer of a package that was built without a release's maintainer: no address below
/// `.invalid` exists (RFC 2606).
const NOBODY: &str = "Unreleased build <nobody@franka-async.invalid>";

/// Target of a package.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target<'a> {
    /// `amd64`, `arm64`.
    pub(super) architecture: &'a str,
    /// The oldest supported C library; `None` for a static program.
    pub(super) glibc: Option<&'a str>,
}

/// The name of the file.
pub(super) fn file_name(release: &Release, target: Target<'_>) -> String {
    format!("{NAME}_{}-1_{}.deb", release.version, target.architecture)
}

/// The package.
pub(super) fn package(
    release: &Release,
    target: Target<'_>,
    content: &Content,
) -> anyhow::Result<Vec<u8>> {
    let files = data(release, target, content)?;
    let size: usize = files
        .iter()
        .map(|file| file.content.len().div_ceil(1024))
        .sum();
    let sums = files.iter().map(|file| {
        let sum = Md5::digest(&file.content);
        format!("{sum:x}  {}\n", file.path)
    });
    let control = [
        Entry::text("control", control(release, target, size)),
        Entry::text("md5sums", sums.collect::<String>()),
    ];
    let mut package = ar::Builder::new(Vec::new());
    for (name, content) in [
        ("debian-binary", b"2.0\n".to_vec()),
        ("control.tar.gz", gzip(&tar(&control, release.epoch)?)?),
        ("data.tar.gz", gzip(&tar(&files, release.epoch)?)?),
    ] {
        let mut header = ar::Header::new(name.as_bytes().to_vec(), content.len() as u64);
        header.set_mode(0o100_644);
        header.set_mtime(release.epoch);
        package.append(&header, content.as_slice())?;
    }
    Ok(package.into_inner()?)
}

/// The fields of the package; `size` in KiB.
fn control(release: &Release, target: Target<'_>, size: usize) -> String {
    let mut text = format!(
        "Package: {NAME}\nVersion: {}-1\nArchitecture: {}\nMaintainer: {}\nInstalled-Size: {size}\n",
        release.version,
        target.architecture,
        maintainer(release),
    );
    if let Some(glibc) = target.glibc {
        text += &format!("Depends: libc6 (>= {glibc})\n");
    }
    text += "Section: science\nPriority: optional\n";
    if !release.repository.is_empty() {
        text += &format!("Homepage: {}\n", release.repository);
    }
    text + DESCRIPTION
}

const DESCRIPTION: &str = "\
Description: command line, simulator and dashboard for Franka robots
 The program franka reads the state of a Franka Research 3 or a Franka Emika
 Robot, moves it after asking, simulates one that any client accepts, shows
 it in the browser, records every cycle and explains why a motion ended. Its
 doctor checks a computer and the way to a robot before an arm moves.
 .
 It is no safety function, and has not been run on a real arm yet. Not
 affiliated with Franka Robotics.
";

fn maintainer(release: &Release) -> &str {
    match release.maintainer.as_str() {
        "" => NOBODY,
        maintainer => maintainer,
    }
}

/// The files that are installed.
fn data(release: &Release, target: Target<'_>, content: &Content) -> anyhow::Result<Vec<Entry>> {
    let doc = format!("usr/share/doc/{NAME}");
    let mut files = vec![
        Entry::program("usr/bin/franka", content.program.clone()),
        Entry::text(format!("{doc}/copyright"), copyright(content)),
        Entry::text(format!("{doc}/changelog.gz"), gzip(&content.changes)?),
        Entry::text(
            format!("{doc}/changelog.Debian.gz"),
            gzip(changelog(release)?.as_bytes())?,
        ),
    ];
    for (name, page) in &content.man_pages {
        files.push(Entry::text(
            format!("usr/share/man/man1/{name}.gz"),
            gzip(page)?,
        ));
    }
    for (shell, script) in &content.completions {
        let path = match *shell {
            "bash" => "usr/share/bash-completion/completions/franka",
            "zsh" => "usr/share/zsh/vendor-completions/_franka",
            _ => "usr/share/fish/vendor_completions.d/franka.fish",
        };
        files.push(Entry::text(path, script.clone()));
    }
    for (name, example) in &content.examples {
        files.push(Entry::text(
            format!("{doc}/examples/{name}"),
            example.clone(),
        ));
    }
    files.push(Entry::text(
        format!("usr/share/lintian/overrides/{NAME}"),
        overrides(target),
    ));
    let (_, third_parties) = paper(content, "THIRD-PARTY");
    let path = format!("{doc}/THIRD-PARTY.gz");
    files.push(Entry::text(path, gzip(third_parties)?));
    Ok(files)
}

/// Warnings that `lintian` must ignore, with reasons.
fn overrides(target: Target<'_>) -> String {
    let mut text =
        format!("# Not for Debian's own archive.\n{NAME}: initial-upload-closes-no-bugs [*]\n");
    if target.glibc.is_none() {
        text += "# One file for every distribution and release.\n";
        text += &format!("{NAME}: statically-linked-binary [usr/bin/franka]\n");
    }
    text
}

/// The machine-readable copyright file, and our notice.
fn copyright(content: &Content) -> Vec<u8> {
    let mut text = COPYRIGHT.to_owned();
    let (_, notice) = paper(content, "NOTICE");
    for line in String::from_utf8_lossy(notice).lines() {
        text += &match line.trim_end() {
            "" => " .\n".to_owned(),
            line => format!(" {line}\n"),
        };
    }
    text.into_bytes()
}

/// One of the papers, which are all collected.
fn paper<'a>(content: &'a Content, name: &str) -> &'a (String, Vec<u8>) {
    let mut papers = content.papers.iter();
    papers.find(|(it, _)| it == name).expect("collected")
}

const COPYRIGHT: &str = "\
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: franka-async

Files: *
Copyright: 2026 The authors of franka-async
License: Apache-2.0
 On Debian systems, the full text of the Apache License version 2.0 can be found
 in the file /usr/share/common-licenses/Apache-2.0.
Comment: Libraries that are part of the program have their own copyright and
 licences, which are in THIRD-PARTY.gz beside this file. Our own notice:
 .
";

/// Debian's own change log.
fn changelog(release: &Release) -> anyhow::Result<String> {
    let time = Timestamp::from_second(i64::try_from(release.epoch)?)?;
    let time = time.strftime("%a, %d %b %Y %H:%M:%S +0000");
    Ok(format!(
        "{NAME} ({}-1) unstable; urgency=medium\n\n  * See changelog.gz beside this file.\n\n -- {}  {time}\n",
        release.version,
        maintainer(release),
    ))
}

/// Makes `lintian` check the package if it is installed; returns the result.
pub(super) fn check(workspace: &Workspace, package: &Path) -> anyhow::Result<String> {
    if !is_installed("lintian") {
        return Ok("NOT CHECKED: lintian is not installed".to_owned());
    }
    let mut lintian = workspace.program("lintian");
    lintian.args(["--fail-on", "error,warning", "--allow-root"]);
    workspace.run(lintian.arg(package))?;
    Ok("checked by lintian".to_owned())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::fs;
    use std::io::Read as _;

    use flate2::read::GzDecoder;

    use super::*;

    fn example() -> Content {
        let file = |name: &str| vec![(name.to_owned(), format!("of {name}\n\nend").into_bytes())];
        Content {
            program: b"program".to_vec(),
            man_pages: file("franka.1"),
            completions: vec![("bash", b"bash".to_vec()), ("zsh", b"zsh".to_vec())],
            examples: file("franka-limits.conf"),
            papers: [file("NOTICE"), file("THIRD-PARTY")].concat(),
            changes: b"# Changelog\n".to_vec(),
        }
    }

    const TARGET: Target<'_> = Target {
        architecture: "amd64",
        glibc: Some("2.17"),
    };

    /// The files of an archive that is compressed.
    fn files(archive: &[u8]) -> BTreeMap<String, Vec<u8>> {
        let mut archive = tar::Archive::new(GzDecoder::new(archive));
        let entries = archive.entries().unwrap().map(|entry| {
            let mut entry = entry.unwrap();
            let mut content = Vec::new();
            entry.read_to_end(&mut content).unwrap();
            (entry.path().unwrap().display().to_string(), content)
        });
        entries.collect()
    }

    #[test]
    fn a_package_has_its_fields_sums_and_files() {
        let package = package(&Release::example(), TARGET, &example()).unwrap();
        let mut members = Vec::new();
        let mut archive = ar::Archive::new(package.as_slice());
        while let Some(member) = archive.next_entry() {
            let mut member = member.unwrap();
            let name = String::from_utf8(member.header().identifier().to_vec()).unwrap();
            let mut content = Vec::new();
            member.read_to_end(&mut content).unwrap();
            members.push((name, content));
        }
        let names: Vec<_> = members.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["debian-binary", "control.tar.gz", "data.tar.gz"]);
        assert_eq!(members[0].1, b"2.0\n");
        let control = files(&members[1].1);
        let fields = String::from_utf8(control["control"].clone()).unwrap();
        assert!(
            fields.starts_with("Package: franka-cli\nVersion: 0.1.0-1\n"),
            "{fields}"
        );
        assert!(fields.contains("\nDepends: libc6 (>= 2.17)\n"), "{fields}");
        let sums = String::from_utf8(control["md5sums"].clone()).unwrap();
        let data = files(&members[2].1);
        for line in sums.lines() {
            let (sum, path) = line.split_once("  ").unwrap();
            assert_eq!(sum, format!("{:x}", Md5::digest(&data[path])), "{path}");
        }
        let installed = data.values().filter(|content| !content.is_empty()).count();
        assert_eq!(sums.lines().count(), installed);
        let copyright = &data["usr/share/doc/franka-cli/copyright"];
        let copyright = String::from_utf8_lossy(copyright);
        let notice = "\n of NOTICE\n .\n end\n";
        assert!(copyright.ends_with(notice), "{copyright}");
    }

    /// Skipped without dpkg: then only the test above reads the package.
    #[test]
    fn dpkg_lists_the_package() {
        if !is_installed("dpkg-deb") {
            return println!("dpkg-deb is not installed");
        }
        let package = package(&Release::example(), TARGET, &example()).unwrap();
        let name = format!("franka-xtask-{}.deb", std::process::id());
        let file = std::env::temp_dir().join(name);
        fs::write(&file, package).unwrap();
        let mut list = std::process::Command::new("dpkg-deb");
        let output = list.arg("--contents").arg(&file).output().unwrap();
        fs::remove_file(file).unwrap();
        assert!(output.status.success(), "{output:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains("usr/share/man/man1/franka.1.gz"), "{text}");
    }
}
