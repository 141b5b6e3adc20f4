//! Targets: shown before a motion, refused with a reason, and reached while a button is held.

use std::time::Duration;

use anyhow::{Context, ensure};

use crate::checks::{hold_until, take};
use crate::driver::{Browser, down, move_to, point, up};
use crate::served::{Served, wait};

/// Types into the number fields of the target.
fn aim(page: &Browser, numbers: &[(&str, f64)]) -> anyhow::Result<()> {
    for (name, number) in numbers {
        page.run(&format!(
            "const it = document.querySelector('[data-goal={name}]'); \
             it.value = {number}; it.dispatchEvent(new Event('input'))"
        ))?;
    }
    Ok(())
}

/// Waits for the page's text about the target.
fn said(page: &Browser, wanted: &str) -> anyhow::Result<()> {
    let waited = wait(wanted, || {
        let said = page.state()?["said"].clone();
        Ok(said.as_str().is_some_and(|said| said.contains(wanted)))
    });
    waited.with_context(|| format!("{:?}", page.state().map(|state| state["said"].clone())))
}

/// Drags the handle of a target: the page shows the preview, and the arm does not move until a
/// button is held. Then the arm moves to the ghost.
pub(crate) fn preview_and_go(page: &Browser, served: &Served) -> anyhow::Result<()> {
    // A page that was too busy may lose the lease before the click.
    wait("the handle", || {
        take(page)?;
        page.click("#goal-place")?;
        Ok(!page.state()?["gizmo"].is_null())
    })?;
    page.run("scrollTo(0, 0)")?;
    let (x, y) = point(&page.state()?["gizmo"])?;
    let before = served.robot.state().q;
    // The centre of the handle moves in the plane of the picture.
    page.pointer(&[move_to((x, y)), down()])?;
    page.pointer(&[
        move_to((x + 15.0, y + 5.0)),
        move_to((x + 30.0, y + 10.0)),
        up(),
    ])?;
    let dragged = point(&page.state()?["gizmo"])?;
    ensure!(
        dragged.0 > x + 20.0,
        "the handle is at {dragged:?}, was at {x}"
    );
    said(page, "Takes")?;
    wait("the ghost", || Ok(!page.state()?["ghost"].is_null()))?;
    let ghost = page.state()?["ghost"].clone();
    ensure!(page.state()?["ahead"].as_u64() > Some(2), "no way ahead");
    std::thread::sleep(Duration::from_millis(300));
    let held = served.check_still(before);
    held.context("before a button was held")?;
    let there = || {
        let at = served.robot.pose().translation.vector;
        let off = (0..3).map(|i| ghost[i].as_f64().map_or(1.0, |x| (x - at[i]).abs()));
        off.fold(0.0, f64::max)
    };
    hold_until(page, "#goal-go", || there() < 3e-3)?;
    page.pointer(&[up()])?;
    served.check_rest()?;
    ensure!(page.state()?["behind"].as_u64() > Some(2), "no way behind");
    Ok(())
}

/// A target in a forbidden region, or out of reach, is refused with a reason, also by the server. A
/// path down to the region is slowed down, and its guard is highlighted.
pub(crate) fn keep_out(page: &Browser, served: &Served) -> anyhow::Result<()> {
    ensure!(page.state()?["regions"] == 1, "the region is not drawn");
    let at = served.robot.pose().translation.vector * 1e3;
    aim(page, &[("x", at.x), ("y", at.y), ("z", 1900.0)])?;
    said(page, "no joint positions")?;
    let below = served.region_top() * 1e3 - 30.0;
    aim(page, &[("z", below)])?;
    said(page, "keep-out region 1")?;
    let start = served.robot.state().q;
    wait("the refusal", || {
        take(page)?;
        page.click("#goal-go")?;
        page.shows("events", "Not moved: the arm would come")
    })?;
    served.check_still(start)?;
    aim(page, &[("z", served.region_top() * 1e3 + 40.0)])?;
    said(page, "Takes")?;
    hold_until(page, "#goal-go", || {
        let guards = page.state().map(|state| state["guards"].clone());
        guards.is_ok_and(|guards| guards.as_str().is_some_and(|it| it.contains("clearance")))
    })?;
    page.pointer(&[up()])?;
    served.check_rest()?;
    page.click("#goal-remove")?;
    wait("no ghost", || Ok(page.state()?["ghost"].is_null()))
}

/// A slider shows the target of its joint.
pub(crate) fn sliders(page: &Browser, served: &Served) -> anyhow::Result<()> {
    let wanted = served.robot.state().q[0] + 0.1;
    page.run(&format!(
        "const it = document.querySelector('.joint input'); \
         it.value = {wanted}; it.dispatchEvent(new Event('input'))"
    ))?;
    wait("the ghost", || Ok(!page.state()?["ghost"].is_null()))?;
    hold_until(page, "#go", || {
        (served.robot.state().q[0] - wanted).abs() < 0.02
    })?;
    page.pointer(&[up()])?;
    page.click("#joints-reset")?;
    served.check_rest()
}
