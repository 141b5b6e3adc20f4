//! `franka state`: shows the newest state, once or repeatedly.

use std::io::{self, IsTerminal, Write};
use std::pin::pin;
use std::time::Duration;

use anstream::ColorChoice;
use anstream::adapter::strip_str;
use clap::Args;
use console::Term;
use franka_async::Robot;

use super::view;
use crate::connection::{Place, Which};
use crate::ending::{Ending, Failure};
use crate::interrupt::interrupted;
use crate::output::{Output, json_line};
use crate::values::rate;

/// Show the state of the robot: mode, errors, joints, forces, link
#[derive(Debug, Args)]
pub(crate) struct State {
    #[command(flatten)]
    which: Which,
    /// Update until Ctrl-C; with --json, one line for each state
    #[arg(short, long)]
    watch: bool,
    /// Updates per second
    #[arg(long, value_name = "HZ", value_parser = rate, default_value = "10", requires = "watch")]
    rate: f64,
    #[command(flatten)]
    output: Output,
}

impl State {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        let draws = self.watch && !self.output.json;
        if draws && !io::stdout().is_terminal() {
            let failure = Failure::usage(
                "got --watch without a terminal, expected a terminal to \
                draw on",
            );
            return Err(failure
                .advice("With --json, --watch prints a line for each state instead.")
                .into());
        }
        let (robot, place) = self.which.connect().await?;
        let outcome = if self.watch {
            self.watch(&robot, &place).await
        } else {
            // The statistics of the link need this time.
            tokio::time::sleep(LOOK).await;
            let value = view::value(&robot, &place);
            self.output.print(&value, || view::text(&robot, &place))
        };
        robot.shutdown().await;
        outcome
    }

    async fn watch(&self, robot: &Robot, place: &Place) -> anyhow::Result<Ending> {
        let mut interrupt = pin!(interrupted()?);
        let mut states = robot.states();
        let mut clock = tokio::time::interval(Duration::from_secs_f64(1.0 / self.rate));
        let screen = match self.output.json {
            true => None,
            false => Some(Screen::open()?),
        };
        loop {
            tokio::select! {
                _ = &mut interrupt => return Ok(Ending::Done),
                _ = clock.tick() => {}
            }
            // A state that arrives after the last update shows that the link works.
            let newest = tokio::time::timeout(SILENCE, states.changed()).await;
            let lost = match newest {
                Ok(Ok(_)) => None,
                Ok(Err(error)) => Some(error.to_string()),
                Err(_) => Some(format!("no state for {} s", SILENCE.as_secs())),
            };
            if let Some(why) = lost {
                let message = format!("the link to the robot at {place} is lost: {why}");
                return Err(Failure::new(Ending::NoRobot, message).into());
            }
            match &screen {
                Some(screen) => screen.draw(&view::text(robot, place))?,
                None => json_line(&view::value(robot, place))?,
            }
        }
    }
}

/// The terminal's alternate screen. Dropping this value restores the terminal.
struct Screen {
    is_coloured: bool,
}

impl Screen {
    fn open() -> io::Result<Self> {
        let choice = anstream::AutoStream::choice(&io::stdout());
        // These codes select the alternate screen, hide the cursor, and cut long lines.
        let mut out = io::stdout().lock();
        out.write_all(b"\x1b[?1049h\x1b[?25l\x1b[?7l")?;
        out.flush()?;
        Ok(Self {
            is_coloured: choice != ColorChoice::Never,
        })
    }

    /// Replaces the displayed page. The screen is not blank in between.
    fn draw(&self, page: &str) -> io::Result<()> {
        // One more line would make the terminal scroll.
        let (rows, _) = Term::stdout().size();
        let lines = page.lines().chain(["", "Ctrl-C ends."]);
        let page: Vec<&str> = lines.take(usize::from(rows)).collect();
        let page = page.join("\n");
        let page = match self.is_coloured {
            true => page,
            false => strip_str(&page).to_string(),
        };
        // The codes clear the rest of each line, and the rest of the screen.
        let lines = page.replace('\n', "\x1b[K\r\n");
        let mut out = io::stdout().lock();
        write!(out, "\x1b[H{lines}\x1b[K\x1b[J")?;
        out.flush()
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // An error means that the terminal is closed, so it needs no restoration.
        let mut out = io::stdout().lock();
        let _ = out.write_all(b"\x1b[?7h\x1b[?25h\x1b[?1049l");
        let _ = out.flush();
    }
}

/// Time for which states are counted before the state is shown once.
const LOOK: Duration = Duration::from_millis(200);

/// Silence after which the link counts as lost.
const SILENCE: Duration = Duration::from_secs(1);
