//! The program in a pseudo-terminal.

use std::fs::File;
use std::io::{Read, Write};
use std::process::Child;
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::{mem, thread};

use nix::pty::{Winsize, openpty};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

use crate::program::{Home, robot_address, until};

/// A program with its terminal. Dropping this value kills the program.
pub(crate) struct Terminal {
    child: Child,
    input: File,
    /// Output of the program so far.
    shown: Arc<Mutex<String>>,
    /// Thread that ends when the program has closed the terminal.
    reader: Option<JoinHandle<()>>,
}

impl Terminal {
    pub(crate) fn run(home: &Home, arguments: &[&str]) -> Self {
        Self::with(home, arguments, &[])
    }

    /// Starts the program with these environment variables.
    pub(crate) fn with(home: &Home, arguments: &[&str], variables: &[(&str, &str)]) -> Self {
        let size = Winsize {
            ws_row: 30,
            ws_col: 80,
            ws_xpixel: 0,
            ws_ypixel: 0,
        };
        let terminal = openpty(&size, None).expect("a pseudo-terminal");
        let slave = File::from(terminal.slave);
        let mut command = home.command(arguments);
        command
            .env("TERM", "xterm-256color")
            .envs(variables.iter().copied())
            .stdin(slave.try_clone().expect("a descriptor"))
            .stdout(slave.try_clone().expect("a descriptor"))
            .stderr(slave);
        let child = command.spawn().expect("the program starts");
        // It holds our copies of the terminal's end.
        drop(command);
        let input = File::from(terminal.master);
        let mut output = input.try_clone().expect("a descriptor");
        let shown = Arc::new(Mutex::new(String::new()));
        let noted = shown.clone();
        let reader = thread::spawn(move || {
            let mut buffer = [0; 4096];
            // Reading fails when the program has closed the terminal.
            while let Ok(count @ 1..) = output.read(&mut buffer) {
                let text = String::from_utf8_lossy(&buffer[..count]);
                noted.lock().expect("no panic").push_str(&text);
            }
        });
        Self {
            child,
            input,
            shown,
            reader: Some(reader),
        }
    }

    pub(crate) fn shown(&self) -> String {
        self.shown.lock().expect("no panic").clone()
    }

    /// Waits until the program has shown this text.
    #[track_caller]
    pub(crate) fn shows(&self, text: &str) {
        until(&format!("{text:?}"), || self.shown().contains(text));
    }

    /// Waits for the robot's address in the output of a tap or a player.
    pub(crate) fn address(&self) -> String {
        let mut address = None;
        until("an address", || {
            address = robot_address(&self.shown());
            address.is_some()
        });
        address.expect("it has come")
    }

    pub(crate) fn types(&mut self, text: &str) {
        self.input.write_all(text.as_bytes()).expect("it listens");
    }

    pub(crate) fn signal(&self, signal: Signal) {
        kill(Pid::from_raw(self.child.id() as i32), signal).expect("it runs");
    }

    /// Waits for the end of the program. Returns the exit code and the output.
    pub(crate) fn ended(mut self) -> (Option<i32>, String) {
        let code = self.child.wait().expect("it ends").code();
        // Its last output is in transit.
        let reader = self.reader.take().expect("not ended");
        reader.join().expect("no panic");
        let shown = mem::take(&mut *self.shown.lock().expect("no panic"));
        (code, shown)
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
