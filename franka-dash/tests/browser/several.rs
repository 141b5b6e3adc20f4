//! Several robots on one server.

use std::path::Path;

use anyhow::ensure;
use franka_async::MotionError;

use crate::driver::Browser;
use crate::served::{Served, wait};

/// Checks that both robots are shown side by side at their positions, that one button stops all
/// motions, and that each robot has its page.
pub(crate) fn run(
    page: &Browser,
    [left, right]: [&Served; 2],
    picture: &Path,
) -> anyhow::Result<()> {
    let address = left.beside(right)?;
    page.go(&format!("http://{address}/"))?;
    wait("both robots", || {
        let state = page.state()?;
        let is_shown = |card: usize, served: &Served| {
            let shown = &state["cards"][card]["endEffector"];
            let robot = served.robot.pose().translation.vector;
            (0..3).all(|i| {
                let off = shown[i].as_f64().map(|x| (x - robot[i]).abs());
                off.is_some_and(|off| off < 1e-3)
            })
        };
        Ok(is_shown(0, left) && is_shown(1, right))
    })?;
    wait("their meshes", || {
        let cards = page.state()?["cards"].clone();
        Ok((0..2).all(|i| cards[i]["meshes"] == true))
    })?;
    page.picture(picture)?;
    let title = page.run("return document.title")?;
    ensure!(title == "All robots – Franka dashboard", "{title}");
    let motion = left.turn();
    wait("a motion", || {
        Ok(left.robot.state().motion_running() || motion.is_finished())
    })?;
    page.click("#stop")?;
    let outcome = left.outcome(motion)?;
    let is_stopped = matches!(outcome, Err(MotionError::Stopped));
    ensure!(is_stopped, "{outcome:?}");
    page.run("document.querySelector('.card h2 a').click()")?;
    wait("the page of the left robot", || {
        Ok(page.state()?["endEffector"].is_array())
    })?;
    let title = page.run("return document.title")?;
    ensure!(
        title.as_str().is_some_and(|it| it.starts_with("left: ")),
        "{title}"
    );
    // This server was started without permission to move an arm.
    wait("why the page takes no command", || {
        page.shows("lease", "View only")
    })?;
    let marked = "return document.querySelector('#robots [aria-current]').textContent";
    ensure!(page.run(marked)? == "left", "the tab is not marked");
    page.run("[...document.querySelectorAll('#robots a')].at(-1).click()")?;
    wait("the page of the right robot", || {
        let there = "return location.pathname + (document.querySelector('#robots [aria-current]')?.textContent ?? '')";
        Ok(page.run(there)? == "/right/right")
    })
}
