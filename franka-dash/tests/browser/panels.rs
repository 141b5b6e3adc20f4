//! User actions on the panels of the page, and their expected effects.

use std::path::Path;

use anyhow::{Context as _, ensure};

use crate::checks::{hold_up, load, looks, take};
use crate::driver::{Browser, up};
use crate::served::{Served, wait};

/// Runs all checks, one after the other, and takes a picture of the panels at the end.
pub(crate) fn run(page: &Browser, served: &Served, picture: &Path) -> anyhow::Result<()> {
    load(page, served)?;
    looks(page, served)?;
    take(page)?;
    record(page, served)?;
    grip(page, served)?;
    page.run("document.getElementById('tuning-panel').scrollIntoView()")?;
    page.picture(picture)
}

pub(crate) fn tune(page: &Browser, _: &Served) -> anyhow::Result<()> {
    take(page)?;
    for (name, factor) in [("soft", 0.25), ("default", 1.0)] {
        page.click(&format!("[data-tuning='{name}']"))?;
        wait(name, || {
            let set = page.state()?["status"]["tuning"]["end_effector"] == factor;
            let held =
                format!("return document.querySelector(\"[data-tuning='{name}']\").className");
            Ok(set && page.run(&held)? == "held")
        })?;
    }
    Ok(())
}

/// Checks that a tare is shown with its range of validity, until it is cleared.
pub(crate) fn tare(page: &Browser, served: &Served) -> anyhow::Result<()> {
    served.check_rest()?;
    take(page)?;
    for (button, tared, said) in [
        ("#tare", true, "The tare is valid here"),
        ("#tare-clear", false, ""),
    ] {
        page.click(button)?;
        wait(button, || {
            let state = page.state()?;
            let text = state["wrenchSaid"].as_str().unwrap_or("?").to_owned();
            Ok(state["tared"] == tared && text.starts_with(said))
        })?;
    }
    Ok(())
}

/// Checks that every quantity draws a coloured line, and that the table has a row per frame, with
/// the newest joints in the last row.
pub(crate) fn plots_and_export(page: &Browser, served: &Served) -> anyhow::Result<()> {
    // The last quantities are about control, and the plot covers the last 20 s: so they are tested
    // first.
    hold_up(page, served)?;
    page.pointer(&[up()])?;
    served.check_rest()?;
    let empty = page.run(
        "const choice = document.getElementById('plotted'); \
         const coloured = () => { \
           const canvas = document.querySelector('#plot canvas'); \
           const all = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height); \
           for (let i = 0; i < all.data.length; i += 4) { \
             const [r, g, b, a] = all.data.subarray(i, i + 4); \
             if (a > 99 && Math.max(r, g, b) - Math.min(r, g, b) > 60) return true; \
           } \
           return false; \
         }; \
         return (async () => { \
           const empty = []; \
           for (const {value} of [...choice.options].reverse()) { \
             choice.value = value; \
             choice.dispatchEvent(new Event('change')); \
             for (let i = 0; i < 50 && !coloured(); i += 1) await new Promise((ok) => setTimeout(ok, 100)); \
             if (!coloured()) empty.push(value); \
           } \
           return empty; \
         })()",
    )?;
    ensure!(empty == serde_json::json!([]), "nothing is drawn: {empty}");
    let text = page.run(
        "let text; const make = URL.createObjectURL; \
         URL.createObjectURL = (blob) => { text = blob.text(); return make(blob); }; \
         document.getElementById('export').click(); URL.createObjectURL = make; return text",
    )?;
    let mut rows = text.as_str().context("a text")?.lines();
    let names: Vec<_> = rows.next().context("names")?.split(',').collect();
    let last: Vec<_> = rows.clone().last().context("rows")?.split(',').collect();
    ensure!(
        rows.count() > 100 && names.len() == last.len(),
        "{names:?}, {last:?}"
    );
    let q = names
        .iter()
        .position(|name| *name == "q_0")
        .context("q_0")?;
    for (i, real) in served.robot.state().q.iter().enumerate() {
        let off = last[q + i].parse::<f64>()? - real;
        ensure!(off.abs() < 2e-3, "joint {i} is {off} rad off");
    }
    Ok(())
}

fn record(page: &Browser, served: &Served) -> anyhow::Result<()> {
    let recording = || page.shows("record-panel", ".mcap");
    page.click("#record")?;
    wait("the recording", recording)?;
    page.click("#record")?;
    wait("the end of the recording", || Ok(!recording()?))?;
    let files = std::fs::read_dir(&served.folder)?.count();
    ensure!(files == 1, "{files} files");
    Ok(())
}

/// Homes the fingers, places an object of 40 mm, and grasps it.
fn grip(page: &Browser, served: &Served) -> anyhow::Result<()> {
    page.click("[data-gripper='Home']")?;
    wait("the homing", || Ok(served.gripper.state().max_width > 0.07))?;
    wait("the width in the page", || {
        page.shows("gripper", "80.0 mm of 80.0")
    })?;
    page.click("[data-world='put']")?;
    wait("the object", || {
        Ok(page.state()?["status"]["simulation"]["object"] == 0.04)
    })?;
    page.click("[data-gripper='Grasp width']")?;
    wait("the grasp", || Ok(served.gripper.state().is_grasped))?;
    page.click("[data-world='take']")?;
    wait("the loss of the object", || {
        Ok(!served.gripper.state().is_grasped)
    })
}

/// Cuts the network for 25 ms, while the arm is at rest.
pub(crate) fn cut(page: &Browser, served: &Served) -> anyhow::Result<()> {
    take(page)?;
    let lost = || served.robot.stats().lost.get();
    let before = lost();
    page.click("[data-world='cut-25']")?;
    wait("lost states", || Ok(lost() > before + 15)).context("25 ms without a network")
}
