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

/// Checks the arguments offered by fish; skipped if fish is not installed.
#[test]
fn fish_offers_files_only_where_they_are_taken() {
    let home = Home::new();
    let script = home.run(&["completions", "fish"]).done();
    let (path, file) = (home.path("franka.fish"), "a_file.mcap");
    std::fs::write(&path, script).expect("a writable folder");
    std::fs::write(home.path(file), "").expect("a writable folder");
    for (line, offered, files) in [
        (
            "completions ",
            &["bash", "elvish", "fish", "powershell", "zsh"][..],
            false,
        ),
        ("sim ", &[], false),
        ("state ", &[], false),
        ("tool set ", &[], false),
        ("tool ", &["set"], false),
        ("cassette info ", &[], true),
        ("record --black-box ", &[], true),
    ] {
        let asked = format!("source {}; complete -C 'franka {line}'", path.display());
        let mut fish = std::process::Command::new("fish");
        let fish = fish.args(["--no-config", "-c", &asked]);
        let output = fish.current_dir(home.path("")).output();
        let output = match output {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                println!("skipped: fish is not installed");
                return;
            }
            output => output.expect("fish runs"),
        };
        let text = String::from_utf8(output.stdout).expect("text");
        let words: Vec<_> = text
            .lines()
            .filter_map(|line| line.split('\t').next())
            .collect();
        for word in offered {
            assert!(words.contains(word), "{line}: {words:?}");
        }
        assert_eq!(words.contains(&file), files, "{line}: {words:?}");
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
    assert_eq!(count, 10);
}

/// The script of the action for other repositories' CI.
#[test]
fn the_action_starts_a_simulator_and_says_why_not() {
    let home = Home::new();
    let start = |options: &str, wait: &str| {
        let script = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../.github/actions/simulator/start.sh"
        );
        let mut command = std::process::Command::new("bash");
        command
            .arg(script)
            .env("FRANKA", env!("CARGO_BIN_EXE_franka"));
        command.env("ROBOT", "fer").env("OPTIONS", options);
        command.env("WAIT", wait).env("RUNNER_TEMP", home.path(""));
        command.env("GITHUB_OUTPUT", home.path("outputs"));
        command.output().expect("bash")
    };
    // Arguments on several lines, and with quotes.
    let said = start("--port\n'0'\n--virtual-time", "60");
    let outputs = std::fs::read_to_string(home.path("outputs")).expect("it has outputs");
    let pid = outputs.lines().find_map(|line| line.strip_prefix("pid="));
    let pid = pid.and_then(|pid| pid.parse().ok()).expect("a process");
    let killed = nix::sys::signal::kill(nix::unistd::Pid::from_raw(pid), nix::sys::signal::SIGKILL);
    assert!(said.status.success(), "{said:?}");
    assert!(said.stdout.starts_with(b"listening on "), "{said:?}");
    killed.expect("it runs");

    let said = start("--port 99999", "60");
    let outputs = std::fs::read_to_string(home.path("outputs")).expect("more outputs");
    let logs: Vec<_> = outputs
        .lines()
        .filter(|line| line.starts_with("log="))
        .collect();
    assert!(logs.len() == 2 && logs[0] != logs[1], "{logs:?}");
    assert!(!said.status.success(), "{said:?}");
    let text = String::from_utf8_lossy(&said.stdout);
    assert!(
        text.contains("the simulator has ended:") && text.contains("99999"),
        "{text}"
    );
    assert!(
        !start("--port 0 --virtual-time \"half", "60")
            .status
            .success()
    );
    for wait in ["0", "1m", "1.5", "abc", ""] {
        let said = start("--port 0", wait);
        let text = String::from_utf8_lossy(&said.stdout);
        assert!(
            !said.status.success() && text.contains("expected whole seconds"),
            "{text}"
        );
    }
}
