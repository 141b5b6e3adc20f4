//! The form of `CHANGELOG.md`: Keep a Changelog 1.1.0, with the unreleased changes first.
//!
//! ```text
//! # Changelog ... ## [Unreleased] ... ### Added ... ## [0.2.0] - 2026-12-24 ... ### Fixed
//! ```

use std::fs;

use anyhow::Context as _;
use semver::Version;

use xtask::workspace::Workspace;

/// Name of the file.
pub(crate) const FILE: &str = "CHANGELOG.md";

/// The titles that sections of a version have.
const KINDS: [&str; 6] = [
    "Added",
    "Changed",
    "Deprecated",
    "Removed",
    "Fixed",
    "Security",
];

/// The change log, section by section.
#[derive(Debug, Default)]
pub(crate) struct Changelog {
    /// Changes for the next release.
    pub(crate) unreleased: String,
    /// Title and text of each release, as in the file.
    releases: Vec<(String, String)>,
    /// True if the first section has the unreleased changes.
    begins: bool,
}

/// The change log of the workspace.
pub(crate) fn read(workspace: &Workspace) -> anyhow::Result<Changelog> {
    let text = fs::read_to_string(workspace.root().join(FILE));
    Ok(Changelog::parse(
        &text.with_context(|| format!("cannot read {FILE}"))?,
    ))
}

impl Changelog {
    fn parse(text: &str) -> Self {
        let mut log = Self::default();
        for (index, section) in text.split("\n## ").skip(1).enumerate() {
            let (title, body) = section.split_once('\n').unwrap_or((section, ""));
            match title.trim() {
                "[Unreleased]" => {
                    log.begins = index == 0;
                    log.unreleased = body.to_owned();
                }
                title => log.releases.push((title.to_owned(), body.to_owned())),
            }
        }
        log
    }

    /// Release date of a version, if it was released: `YYYY-MM-DD`.
    pub(crate) fn date_of(&self, version: &str) -> Option<&str> {
        let prefix = format!("[{version}] - ");
        let mut titles = self.releases.iter().map(|(title, _)| title.as_str());
        titles.find_map(|title| title.strip_prefix(&prefix))
    }

    /// The section of a version, if any.
    pub(crate) fn notes_of(&self, version: &str) -> Option<&str> {
        let prefix = format!("[{version}]");
        let mut releases = self.releases.iter();
        let release = releases.find(|(title, _)| title.starts_with(&prefix));
        release.map(|(_, text)| text.trim())
    }

    /// Deviations from the form.
    pub(crate) fn faults(&self) -> Vec<String> {
        let mut found = Vec::new();
        if !self.begins {
            found.push(format!("{FILE}: the first section must be [Unreleased]"));
        }
        let mut newer: Option<Version> = None;
        for (title, _) in &self.releases {
            let Some((version, date)) = version_and_date(title) else {
                found.push(format!(
                    "{FILE}: got the title {title:?}, expected [X.Y.Z] - YYYY-MM-DD"
                ));
                continue;
            };
            if !is_date(date) {
                found.push(format!("{FILE}: {version}: {date:?} is no date"));
            }
            if newer.as_ref().is_some_and(|newer| *newer <= version) {
                found.push(format!("{FILE}: {version} is below an older version"));
            }
            newer = Some(version);
        }
        let texts = self.releases.iter().map(|(_, text)| text);
        for text in std::iter::once(&self.unreleased).chain(texts) {
            let titles = text.lines().filter_map(|line| line.strip_prefix("### "));
            let others = titles.filter(|title| !KINDS.contains(&title.trim()));
            found.extend(others.map(|title| {
                let kinds = KINDS.join(", ");
                format!("{FILE}: got the section {title:?}, expected one of {kinds}")
            }));
        }
        found
    }
}

/// The parts of `[X.Y.Z] - YYYY-MM-DD`.
fn version_and_date(title: &str) -> Option<(Version, &str)> {
    let (version, date) = title.strip_prefix('[')?.split_once("] - ")?;
    Some((Version::parse(version).ok()?, date))
}

/// True if a text is a date as `YYYY-MM-DD`.
pub(crate) fn is_date(text: &str) -> bool {
    let mut parts = text.split('-');
    let mut number = |digits: usize| {
        let part = parts.next().filter(|part| part.len() == digits)?;
        part.parse::<u32>().ok()
    };
    let date = [number(4), number(2), number(2)];
    let [Some(year), Some(month), Some(day)] = date else {
        return false;
    };
    year >= 2026 && (1..=12).contains(&month) && (1..=31).contains(&day) && parts.next().is_none()
}

/// The text of a change log in which the unreleased changes become a version's, and nothing is
/// unreleased.
pub(crate) fn released(text: &str, version: &str, date: &str) -> String {
    let title = "\n## [Unreleased]\n";
    text.replacen(title, &format!("{title}\n## [{version}] - {date}\n"), 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "# Changelog\n\nText.\n\n## [Unreleased]\n\n### Added\n\n* a\n\n\
        ## [0.2.0] - 2026-12-24\n\n### Fixed\n\n* b\n\n## [0.1.0] - 2026-12-01\n\n* c\n";

    #[test]
    fn a_good_log_has_no_faults_and_tells_its_versions() {
        let log = Changelog::parse(GOOD);
        assert_eq!(log.faults(), Vec::<String>::new());
        assert_eq!(log.date_of("0.2.0"), Some("2026-12-24"));
        assert_eq!(log.date_of("0.3.0"), None);
        assert_eq!(log.notes_of("0.1.0"), Some("* c"));
        assert_eq!(log.unreleased.trim(), "### Added\n\n* a");
    }

    #[test]
    fn every_departure_from_the_form_is_a_fault() {
        let faults = |from: &str, to: &str| {
            let changed = GOOD.replacen(from, to, 1);
            assert_ne!(changed, GOOD, "{from}");
            Changelog::parse(&changed).faults()
        };
        for (from, to) in [
            ("## [Unreleased]", "## Unreleased"),
            ("## [Unreleased]", "## [0.3.0] - 2026-12-25"),
            ("### Added", "### Improved"),
            ("0.1.0", "0.2.0"),
            ("0.1.0", "one"),
            ("2026-12-24", "24.12.2026"),
            ("2026-12-24", "2026-13-24"),
        ] {
            assert!(!faults(from, to).is_empty(), "{from} -> {to}");
        }
    }

    #[test]
    fn a_release_takes_over_what_was_unreleased() {
        let log = Changelog::parse(&released(GOOD, "0.3.0", "2026-12-31"));
        assert_eq!(log.faults(), Vec::<String>::new());
        assert_eq!(log.unreleased.trim(), "");
        assert_eq!(log.notes_of("0.3.0"), Some("### Added\n\n* a"));
        assert_eq!(log.date_of("0.3.0"), Some("2026-12-31"));
    }
}
