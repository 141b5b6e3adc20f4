//! Checks comments as rustfmt leaves them: within the width of the code, without tables and
//! examples that were wrapped like prose.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};

use xtask::workspace::Workspace;

/// Columns of a line, as rustfmt has them for code.
const WIDTH_MAX: usize = 100;

/// Fails with every comment line that is too wide or was wrapped like prose, by file and line.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<()> {
    let mut sources = Vec::new();
    collect(workspace.root(), &mut sources)?;
    sources.sort();
    let mut found = Vec::new();
    for source in &sources {
        let text = fs::read_to_string(source)?;
        let name = source.strip_prefix(workspace.root()).unwrap_or(source);
        for (line, width) in wide_comments(&text) {
            let most = format!("{width} columns, of {WIDTH_MAX} at most");
            found.push(format!("{}:{line}: {most}", name.display()));
        }
        for (line, what) in wrapped(&text) {
            found.push(format!("{}:{line}: {what}", name.display()));
        }
    }
    if !found.is_empty() {
        bail!("comments to mend:\n{}", found.join("\n"));
    }
    println!(
        "comments of {} files: {WIDTH_MAX} columns, rows and examples in whole lines",
        sources.len()
    );
    Ok(())
}

/// The Rust sources below `directory`, without built, fetched, generated or hidden files.
fn collect(directory: &Path, sources: &mut Vec<PathBuf>) -> anyhow::Result<()> {
    let entries =
        fs::read_dir(directory).with_context(|| format!("cannot read {}", directory.display()))?;
    for entry in entries {
        let entry = entry?;
        let (path, name) = (entry.path(), entry.file_name());
        if entry.file_type()?.is_dir() {
            if name != "target" && name != "generated" && !name.to_string_lossy().starts_with('.') {
                collect(&path, sources)?;
            }
        } else if path.extension() == Some(OsStr::new("rs")) {
            sources.push(path);
        }
    }
    Ok(())
}

/// Number and width of each comment line that is too wide. Tables, fenced blocks and unbreakable
/// words, such as addresses, may exceed the width.
fn wide_comments(text: &str) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    for line in comments(text) {
        let width = line.whole.chars().count();
        let is_table = line.content.starts_with('|');
        let word_max = line.content.split(' ').map(str::len).max().unwrap_or(0);
        let may_be_wide = line.block.is_some() || is_table || word_max >= WIDTH_MAX / 2;
        if width > WIDTH_MAX && !may_be_wide {
            found.push((line.number, width));
        }
    }
    found
}

/// Number and fault of each line that a tool has wrapped like prose: a row of a table that
/// continues in the next line, or several statements of an example in one.
fn wrapped(text: &str) -> Vec<(usize, &'static str)> {
    let mut found = Vec::new();
    for line in comments(text) {
        let (begins, ends) = (line.content.starts_with('|'), line.content.ends_with('|'));
        match line.block {
            None if line.is_doc && begins != ends => {
                found.push((line.number, "a row of a table in several lines"));
            }
            Some(language) if is_rust(language) && has_several_statements(line.content) => {
                found.push((line.number, "several statements of an example in one line"));
            }
            _ => {}
        }
    }
    found
}

/// A line of a comment.
struct CommentLine<'a> {
    /// Line number, from 1.
    number: usize,
    whole: &'a str,
    /// Content without the marks of the comment and the blanks around it.
    content: &'a str,
    is_doc: bool,
    /// The language of its fenced block.
    block: Option<&'a str>,
}

/// The lines of comments, without those that begin and end fenced blocks.
fn comments(text: &str) -> impl Iterator<Item = CommentLine<'_>> {
    let mut block = None;
    text.lines().enumerate().filter_map(move |(index, whole)| {
        let Some(comment) = whole.trim_start().strip_prefix("//") else {
            block = None;
            return None;
        };
        let content = comment.trim_start_matches(['/', '!']).trim();
        if let Some(language) = content.strip_prefix("```") {
            block = match block {
                Some(_) => None,
                None => Some(language),
            };
            return None;
        }
        Some(CommentLine {
            number: index + 1,
            whole,
            content,
            is_doc: comment.starts_with(['/', '!']),
            block,
        })
    })
}

/// True if rustdoc treats a block of this language as Rust.
fn is_rust(language: &str) -> bool {
    const ATTRIBUTES: [&str; 6] = [
        "",
        "rust",
        "no_run",
        "ignore",
        "compile_fail",
        "should_panic",
    ];
    let first = language.split(',').next().unwrap_or_default().trim();
    ATTRIBUTES.contains(&first)
}

/// True if code continues after the end of a statement, outside brackets, strings and comments.
fn has_several_statements(code: &str) -> bool {
    let mut depth = 0_i32;
    let mut is_text = false;
    let mut is_over = false;
    let mut characters = code.chars().peekable();
    while let Some(character) = characters.next() {
        match character {
            '\\' if is_text => drop(characters.next()),
            '"' => is_text = !is_text,
            _ if is_text => {}
            '/' if characters.peek() == Some(&'/') => return false,
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            ';' if depth <= 0 => is_over = true,
            ' ' => {}
            _ if is_over => return true,
            _ => {}
        }
    }
    false
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

    #[test]
    fn a_row_that_was_wrapped_is_found_and_a_table_is_not() {
        let text = "//! | a | b |\n//! |---|---|\n//! | c | d\n//! e |\n// |x| of a closure\n";
        let lines: Vec<_> = wrapped(text).iter().map(|found| found.0).collect();
        assert_eq!(lines, [3, 4]);
    }

    #[test]
    fn statements_that_were_joined_are_found() {
        let joined = |code: &str| wrapped(&format!("/// ```no_run\n/// {code}\n/// ```\n")).len();
        assert_eq!(joined("let a = 1; let b ="), 1);
        assert_eq!(joined("step(a)?; // never waits, b.wait()?;"), 0);
        assert_eq!(joined("step(a)?; b.wait()?;"), 1);
        assert_eq!(joined("for _ in 0..3 { a(); b(); }"), 0);
        assert_eq!(joined("let zeros = [0.0; 7];"), 0);
        assert_eq!(joined(r#"println!("a; b\"; c"); // d; e"#), 0);
        let text = "/// ```text\n/// a; b; c\n/// ```\n/// a; b; c\n";
        assert_eq!(wrapped(text), []);
    }
}
