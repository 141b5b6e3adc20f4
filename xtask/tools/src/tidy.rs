//! The width of comments: rustfmt's own check of it (`wrap_comments`) needs a nightly compiler.

use std::fs;

use anyhow::bail;

use xtask::workspace::Workspace;

/// Columns of a line, as rustfmt has them for code.
const WIDTH_MAX: usize = 100;

/// Fails with every comment line that is too wide, by file and line.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<()> {
    let mut found = Vec::new();
    for source in workspace.files(&["*.rs", ":!*/generated/*"])? {
        let lines = wide_comments(&fs::read_to_string(workspace.root().join(&source))?);
        found.extend(
            lines
                .iter()
                .map(|line| format!("{}:{line}", source.display())),
        );
    }
    if !found.is_empty() {
        bail!(
            "comments wider than {WIDTH_MAX} columns:\n{}",
            found.join("\n")
        );
    }
    Ok(())
}

/// Numbers of the comment lines that are too wide. Tables, fenced blocks and words that cannot be
/// broken, such as addresses, may exceed the width.
fn wide_comments(text: &str) -> Vec<usize> {
    let mut found = Vec::new();
    let mut is_block = false;
    for (line, number) in text.lines().zip(1..) {
        let Some(comment) = line.trim_start().strip_prefix("//") else {
            is_block = false;
            continue;
        };
        let content = comment.trim_start_matches(['/', '!']).trim();
        is_block ^= content.starts_with("```");
        let has_long_word = content.split(' ').any(|word| word.len() >= WIDTH_MAX / 2);
        let may_be_wide = is_block || has_long_word || content.starts_with('|');
        if line.chars().count() > WIDTH_MAX && !may_be_wide {
            found.push(number);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wide_comment_is_found_and_code_tables_blocks_and_addresses_are_not() {
        let words = "word ".repeat(30);
        let text = format!(
            "// {words}\nlet text = \"{words}\";\n    /// {words}\n// short\n//! | {words}\n\
             //! ```text\n//! {words}\n//! ```\n// see {}\n",
            "a".repeat(120)
        );
        assert_eq!(wide_comments(&text), [1, 3]);
        let text = format!("//! ```text\n//! x\nfn code() {{}}\n//! {words}\n");
        assert_eq!(wide_comments(&text), [4], "a block ends with its comment");
    }
}
