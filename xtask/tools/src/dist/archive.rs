//! Archives that depend only on their content: a given time, no user, and ordered entries.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::Path;

use flate2::{Compression, GzBuilder};

/// A file of an archive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    /// Path relative to the root of the archive.
    pub(super) path: String,
    pub(super) mode: u32,
    pub(super) content: Vec<u8>,
}

impl Entry {
    /// A file that all users may read.
    pub(super) fn text(path: impl Into<String>, content: impl Into<Vec<u8>>) -> Self {
        Self {
            path: path.into(),
            mode: 0o644,
            content: content.into(),
        }
    }

    /// A program.
    pub(super) fn program(path: impl Into<String>, content: Vec<u8>) -> Self {
        Self {
            mode: 0o755,
            ..Self::text(path, content)
        }
    }
}

/// A tar archive of the entries and their parent directories, all with the time `epoch` in seconds
/// since 1970.
pub(super) fn tar(entries: &[Entry], epoch: u64) -> anyhow::Result<Vec<u8>> {
    let mut archive = tar::Builder::new(Vec::new());
    let mut sorted: Vec<&Entry> = entries.iter().collect();
    sorted.sort_by(|one, other| one.path.cmp(&other.path));
    let mut made = BTreeSet::new();
    let mut add = |path: &str, kind: tar::EntryType, mode: u32, content: &[u8]| {
        let mut header = tar::Header::new_gnu();
        header.set_entry_type(kind);
        header.set_mode(mode);
        header.set_mtime(epoch);
        header.set_uid(0);
        header.set_gid(0);
        header.set_size(content.len() as u64);
        archive.append_data(&mut header, path, content)
    };
    for entry in sorted {
        let above: Vec<_> = Path::new(&entry.path).ancestors().skip(1).collect();
        for directory in above.iter().rev() {
            let path = format!("{}/", directory.display());
            if path != "/" && made.insert(path.clone()) {
                add(&path, tar::EntryType::Directory, 0o755, &[])?;
            }
        }
        add(
            &entry.path,
            tar::EntryType::Regular,
            entry.mode,
            &entry.content,
        )?;
    }
    Ok(archive.into_inner()?)
}

/// The bytes compressed as `gzip -9n` does, without a time and a name.
pub(super) fn gzip(content: &[u8]) -> anyhow::Result<Vec<u8>> {
    let writer = GzBuilder::new().mtime(0);
    let mut writer = writer.write(Vec::new(), Compression::best());
    writer.write_all(content)?;
    Ok(writer.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Path and mode of each entry of an archive.
    fn unpack(archive: &[u8]) -> anyhow::Result<Vec<(String, u32)>> {
        let mut archive = tar::Archive::new(archive);
        let entries = archive.entries()?.map(|entry| {
            let entry = entry?;
            let path = entry.path()?.display().to_string();
            Ok((path, entry.header().mode()?))
        });
        entries.collect()
    }

    #[test]
    fn an_archive_depends_on_its_content_only() {
        let one = Entry::text("usr/share/doc/a", "a");
        let other = Entry::program("usr/bin/b", b"b".to_vec());
        let archive = tar(&[one.clone(), other.clone()], 7).unwrap();
        assert_eq!(archive, tar(&[other, one], 7).unwrap());
        let files = unpack(&archive).unwrap();
        let paths: Vec<_> = files
            .iter()
            .map(|(path, mode)| (path.as_str(), *mode))
            .collect();
        let expected = [
            ("usr/", 0o755),
            ("usr/bin/", 0o755),
            ("usr/bin/b", 0o755),
            ("usr/share/", 0o755),
            ("usr/share/doc/", 0o755),
            ("usr/share/doc/a", 0o644),
        ];
        assert_eq!(paths, expected);
        assert_eq!(gzip(&archive).unwrap(), gzip(&archive).unwrap());
    }
}
