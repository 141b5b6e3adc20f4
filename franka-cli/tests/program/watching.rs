//! `franka state --watch` in a terminal.

use nix::sys::signal::Signal;

use crate::program::{Home, until};
use crate::simulated::Simulated;
use crate::terminal::Terminal;

#[test]
fn watching_draws_on_the_other_screen_until_ctrl_c() {
    Simulated::each(|sim| {
        let home = Home::new();
        let arguments = ["state", &sim.address(), "--watch", "--rate", "50"];
        let terminal = Terminal::run(&home, &arguments);
        until("three pages", || {
            terminal.shown().matches("joint ").count() >= 3
        });
        terminal.signal(Signal::SIGINT);
        let (code, shown) = terminal.ended();
        assert_eq!(code, Some(0), "{shown}");
        assert!(shown.starts_with("\x1b[?1049h"), "{shown:?}");
        assert!(shown.contains("\x1b[32m●"), "coloured: {shown:?}");
        assert!(shown.ends_with("\x1b[?7h\x1b[?25h\x1b[?1049l"), "{shown:?}");
    });
}
