//! The library uses neither the standard library nor an allocator.
//!
//! Without `extern crate alloc` or `extern crate std`, a `no_std` crate cannot name either of them.
//! The test therefore only checks the sources, and needs no target without a standard library.

use std::fs;
use std::path::Path;

#[test]
fn no_source_file_asks_for_std_or_alloc() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let root = fs::read_to_string(src.join("lib.rs")).unwrap();
    assert!(root.lines().any(|line| line == "#![no_std]"));
    assert!(root.lines().any(|line| line == "#![forbid(unsafe_code)]"));
    let files = check(&src);
    assert!(files > 20, "only {files} files were looked at");
}

/// Checks every file below `dir` and returns the number of files.
fn check(dir: &Path) -> usize {
    let mut files = 0;
    for entry in fs::read_dir(dir).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files += check(&path);
            continue;
        }
        files += 1;
        let text = fs::read_to_string(&path).unwrap();
        let mut before = "";
        for line in text.lines() {
            let wanted = line.contains("extern crate") && !line.trim_start().starts_with("//");
            let for_tests = line == "extern crate std;" && before == "#[cfg(test)]";
            assert!(!wanted || for_tests, "{}: {line}", path.display());
            before = line;
        }
    }
    files
}
