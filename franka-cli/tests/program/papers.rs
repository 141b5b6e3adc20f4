//! Help, completions, man pages, the book.

use crate::program::Home;

#[test]
fn every_command_has_help_and_a_man_page() {
    let home = Home::new();
    let help = home.run(&["--help"]).done();
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let commands = commands.take_while(|line| !line.is_empty());
    let commands: Vec<&str> = commands
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    assert!(commands.len() > 20, "{commands:?}");
    home.run(&["man", "pages"]).done();
    for command in commands.into_iter().filter(|command| *command != "help") {
        let text = home.run(&[command, "--help"]).done();
        assert!(text.contains("Usage:"), "{text}");
        let page = home.path(&format!("pages/franka-{command}.1"));
        assert!(page.exists(), "{}", page.display());
    }
}

#[test]
fn shells_complete_arguments() {
    let home = Home::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = home.run(&["completions", shell]).done();
        assert!(script.contains("communication"), "{shell}");
    }
}

#[test]
fn output_that_nobody_reads_is_no_error() {
    let home = Home::new();
    let mut command = home.command(&["completions", "bash"]);
    command
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped());
    let mut child = command.spawn().expect("it starts");
    drop(child.stdout.take());
    let ended = child.wait_with_output().expect("it ends");
    assert!(
        ended.status.success() && ended.stderr.is_empty(),
        "{ended:?}"
    );
}

#[test]
fn the_book_has_the_exit_codes_of_the_help() {
    let help = Home::new().run(&["--help"]).done();
    let book = include_str!("../../../docs/src/cli.md");
    let codes = help
        .lines()
        .skip_while(|line| *line != "Exit codes:")
        .skip(1);
    let mut count = 0;
    for line in codes {
        let (code, meaning) = line.trim().split_once("  ").expect("code and meaning");
        let row = format!("| {code} | {meaning} |");
        assert!(book.contains(&row), "no row in the book: {row}");
        count += 1;
    }
    assert_eq!(count, 9);
}
