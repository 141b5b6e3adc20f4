//! Comments within the width of the code: rustfmt leaves them as they are.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};

use crate::workspace::Workspace;

/// Columns of a line, as rustfmt has them for code.
const WIDTH_MAX: usize = 100;

/// Fails with every comment line that is too wide, by file and line.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<()> {
    let mut sources = Vec::new();
    collect(workspace.root(), &mut sources)?;
    sources.sort();
    let mut found = Vec::new();
    for source in &sources {
        let text = fs::read_to_string(source)?;
        let name = source.strip_prefix(workspace.root()).unwrap_or(source);
        for (line, width) in wide_comments(&text) {
            found.push(format!("{}:{line}: {width} columns", name.display()));
        }
    }
    if !found.is_empty() {
        bail!(
            "comments of more than {WIDTH_MAX} columns:\n{}",
            found.join("\n")
        );
    }
    println!("comments of {} files: {WIDTH_MAX} columns", sources.len());
    Ok(())
}

/// The Rust sources below `directory`, without what is built, fetched or hidden.
fn collect(directory: &Path, sources: &mut Vec<PathBuf>) -> anyhow::Result<()> {
    let entries =
        fs::read_dir(directory).with_context(|| format!("cannot read {}", directory.display()))?;
    for entry in entries {
        let entry = entry?;
        let (path, name) = (entry.path(), entry.file_name());
        if entry.file_type()?.is_dir() {
            if name != "target" && !name.to_string_lossy().starts_with('.') {
                collect(&path, sources)?;
            }
        } else if path.extension() == Some(OsStr::new("rs")) {
            sources.push(path);
        }
    }
    Ok(())
}

/// Number and width of each comment line that is too wide. Tables, fenced blocks and words that
/// cannot be broken, such as addresses, may be as wide as they are.
fn wide_comments(text: &str) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut is_fenced = false;
    for (index, line) in text.lines().enumerate() {
        let Some(comment) = line.trim_start().strip_prefix("//") else {
            is_fenced = false;
            continue;
        };
        let content = comment.trim_start_matches(['/', '!']).trim_start();
        if content.starts_with("```") {
            is_fenced = !is_fenced;
            continue;
        }
        let width = line.chars().count();
        let is_table = content.starts_with('|');
        let word_max = content.split(' ').map(str::len).max().unwrap_or(0);
        if width > WIDTH_MAX && !is_fenced && !is_table && word_max < WIDTH_MAX / 2 {
            found.push((index + 1, width));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wide_comment_is_found_and_a_wide_line_of_code_is_not() {
        let words = "word ".repeat(30);
        let text = format!("// {words}\nlet text = \"{words}\";\n    /// {words}\n// short\n");
        let lines: Vec<_> = wide_comments(&text).iter().map(|found| found.0).collect();
        assert_eq!(lines, [1, 3]);
    }

    #[test]
    fn tables_fenced_blocks_and_addresses_may_be_wide() {
        let words = "word ".repeat(30);
        let address = "a".repeat(120);
        let text = format!("//! | {words}\n//! ```text\n//! {words}\n//! ```\n// see {address}\n");
        assert_eq!(wide_comments(&text), []);
        let text = format!("//! ```text\n//! x\nfn code() {{}}\n//! {words}\n");
        assert_eq!(
            wide_comments(&text).len(),
            1,
            "a block ends with its comment"
        );
    }

    #[test]
    fn a_line_of_exactly_the_width_is_not_too_wide() {
        let line = |width: usize| format!("// {}", "ab ".repeat(width)[..width - 3].to_owned());
        assert_eq!(wide_comments(&line(WIDTH_MAX)), []);
        assert_eq!(wide_comments(&line(WIDTH_MAX + 1)), [(1, WIDTH_MAX + 1)]);
    }
}
