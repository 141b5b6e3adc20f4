//! A server that ends while a page is open, and another server in its place.

use anyhow::{Context as _, ensure};
use franka_async::MotionError;

use crate::driver::Browser;
use crate::served::{Served, wait};

/// Presses a stop meanwhile. The page must show the stop as not sent, and send it as soon as it is
/// connected again. The page then resets its buffer.
pub(crate) fn run(page: &Browser, served: &Served) -> anyhow::Result<()> {
    let (address, server) = served.again("127.0.0.1:0".parse()?)?;
    page.go(&format!("http://{address}/"))?;
    let frames = || page.state()?["frames"].as_u64().context("frames");
    wait("frames", || {
        Ok(page.state()?["ready"] == true && frames()? > 60)
    })?;
    let titled = page.run("return document.title")?;
    ensure!(
        titled == "Franka Research 3, simulated – Franka dashboard",
        "{titled}"
    );
    let before = frames()?;
    drop(server);
    wait("the end of the connection", || {
        page.shows("mode", "no connection")
    })?;
    let motion = served.turn();
    wait("a motion", || {
        Ok(served.robot.state().motion_running() || motion.is_finished())
    })?;
    page.click("#stop")?;
    wait("the notice", || page.shows("stop-notice", "not sent"))?;
    ensure!(frames()? >= before, "the buffer is gone already");
    let (_, server) = served.again(address)?;
    let outcome = served.outcome(motion)?;
    ensure!(matches!(outcome, Err(MotionError::Stopped)), "{outcome:?}");
    wait("the answer", || page.shows("stop-notice", "received"))?;
    let shown = frames()?;
    ensure!(shown < before, "{shown} frames, {before} before");
    page.go("about:blank")?;
    drop(server);
    // The errors of the unanswered connections.
    page.forget_console()
}
