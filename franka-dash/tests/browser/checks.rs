//! What a person does with the page, and what has to come of it.

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, ensure};
use franka_async::state::RobotMode;
use serde_json::json;

use crate::driver::{Browser, down, move_to, point, up};
use crate::served::{Served, wait};

/// One thing that a person does or sees.
type Check = fn(&Browser, &Served) -> anyhow::Result<()>;

/// All checks, one after the other.
pub(crate) fn run(page: &Browser, served: &Served) -> anyhow::Result<()> {
    let checks: [(&str, Check); 12] = [
        ("load", load),
        ("shows the robot", shows_the_robot),
        ("looks", looks),
        ("jog", jog),
        ("preview and go", preview_and_go),
        ("keep out", keep_out),
        ("sliders", sliders),
        ("lose the hold", lose_the_hold),
        ("keyboard", keyboard),
        ("push", push),
        ("reflex and recovery", reflex_and_recovery),
        ("leave", leave),
    ];
    for (name, check) in checks {
        let begin = Instant::now();
        check(page, served).context(name)?;
        println!("{name}: {:.1?}", begin.elapsed());
    }
    Ok(())
}

/// Opens the page, and waits until it shows a state.
pub(crate) fn load(page: &Browser, served: &Served) -> anyhow::Result<()> {
    page.go(&format!("http://{}/", served.address))?;
    wait("the page", || Ok(page.state()?["ready"] == true))?;
    let drawn = page.run("return performance.getEntriesByName('ready')[0].startTime")?;
    println!("the page shows a state {drawn:.0} ms after it was asked for");
    Ok(())
}

/// The end effector of the scene is that of the robot.
fn shows_the_robot(page: &Browser, served: &Served) -> anyhow::Result<()> {
    wait("the drawn arm", || {
        let shown = page.state()?["endEffector"].clone();
        let robot = served.robot.pose().translation;
        let off = |i: usize| shown[i].as_f64().map(|x| (x - robot.vector[i]).abs());
        Ok((0..3).all(|i| off(i).is_some_and(|off| off < 1e-3)))
    })
}

/// The links are drawn as they look; from then on as capsules, which take less of a computer
/// without a graphics card, and the arm goes faster.
pub(crate) fn looks(page: &Browser, _: &Served) -> anyhow::Result<()> {
    wait("the meshes", || Ok(page.state()?["meshes"] == true))?;
    page.run(
        "const it = document.getElementById('looks'); it.value = 'capsules'; \
         it.dispatchEvent(new Event('change')); \
         const speed = document.getElementById('speed'); speed.value = 150; \
         speed.dispatchEvent(new Event('input'))",
    )?;
    Ok(())
}

/// Takes command, again where a page that was too busy has lost its connection.
pub(crate) fn take(page: &Browser) -> anyhow::Result<()> {
    let commands = || Ok(page.state()?["commands"] == true);
    let begin = Instant::now();
    while !commands()? {
        ensure!(begin.elapsed() < LONGEST, "the page gets no lease");
        page.click("#lease")?;
        // Else the server is asked once more.
        let _ = wait("the lease", commands);
    }
    Ok(())
}

/// Presses the button that moves up until the arm has moved. It is held on return.
fn hold_up(page: &Browser, served: &Served) -> anyhow::Result<()> {
    let start = served.height();
    hold_until(page, "[data-jog='Z+']", || served.height() > start + 0.003)
}

/// Presses a button, again if the machine was too busy for a hold, until `done`. It may be held on
/// return.
fn hold_until(
    page: &Browser,
    selector: &str,
    mut done: impl FnMut() -> bool,
) -> anyhow::Result<()> {
    let begin = Instant::now();
    while begin.elapsed() < LONGEST {
        take(page)?;
        page.pointer(&[move_to(page.find(selector)?), down()])?;
        while page.state()?["holding"] == true {
            if done() {
                return Ok(());
            }
        }
        page.pointer(&[up()])?;
        if done() {
            return Ok(());
        }
    }
    let log = page.run("return document.getElementById('events').textContent")?;
    let state = page.state()?;
    anyhow::bail!("{selector} does not have the effect of being held: {log}\n{state}")
}

fn jog(page: &Browser, served: &Served) -> anyhow::Result<()> {
    hold_up(page, served)?;
    page.pointer(&[up()])?;
    served.check_rest()
}

/// Types into the numbers of the target.
fn aim(page: &Browser, numbers: &[(&str, f64)]) -> anyhow::Result<()> {
    for (name, number) in numbers {
        page.run(&format!(
            "const it = document.querySelector('[data-goal={name}]'); \
             it.value = {number}; it.dispatchEvent(new Event('input'))"
        ))?;
    }
    Ok(())
}

/// Waits for what the page says about the target.
fn said(page: &Browser, wanted: &str) -> anyhow::Result<()> {
    let waited = wait(wanted, || {
        let said = page.state()?["said"].clone();
        Ok(said.as_str().is_some_and(|said| said.contains(wanted)))
    });
    waited.with_context(|| format!("{:?}", page.state().map(|state| state["said"].clone())))
}

/// Drags the handle of a target: the page shows what the motion would do, and nothing moves until
/// a button is held. Then the arm goes where the ghost is.
fn preview_and_go(page: &Browser, served: &Served) -> anyhow::Result<()> {
    take(page)?;
    page.click("#goal-place")?;
    page.run("scrollTo(0, 0)")?;
    wait("the handle", || Ok(!page.state()?["gizmo"].is_null()))?;
    let (x, y) = point(&page.state()?["gizmo"])?;
    let before = served.robot.state().q;
    // The middle of the handle: in the plane of the picture.
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
    let moved = (0..7).map(|i| (served.robot.state().q[i] - before[i]).abs());
    ensure!(
        moved.fold(0.0, f64::max) < 2e-3,
        "it moved before a button was held"
    );
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

/// A target in a region to keep out of, and one out of reach, are refused with a reason, also by
/// the server; a way down to the region is slowed down, and its guard lights up.
fn keep_out(page: &Browser, served: &Served) -> anyhow::Result<()> {
    ensure!(page.state()?["regions"] == 1, "the region is not drawn");
    let at = served.robot.pose().translation.vector * 1e3;
    aim(page, &[("x", at.x), ("y", at.y), ("z", 1900.0)])?;
    said(page, "no joint positions")?;
    let below = served.region_top() * 1e3 - 30.0;
    aim(page, &[("z", below)])?;
    said(page, "region 1 to keep out of")?;
    let start = served.robot.state().q;
    page.pointer(&[move_to(page.find("#goal-go")?), down()])?;
    wait("the refusal", || {
        let text = page.run("return document.getElementById('events').textContent")?;
        Ok(text
            .as_str()
            .is_some_and(|text| text.contains("Not moved: the arm would come")))
    })?;
    page.pointer(&[up()])?;
    let moved = (0..7).map(|i| (served.robot.state().q[i] - start[i]).abs());
    ensure!(moved.fold(0.0, f64::max) < 2e-3, "it moved");
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

/// A slider shows where its joint would go.
fn sliders(page: &Browser, served: &Served) -> anyhow::Result<()> {
    let wanted = served.robot.state().q[0] + 0.2;
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

/// Each way in which a browser takes a held button away.
fn lose_the_hold(page: &Browser, served: &Served) -> anyhow::Result<()> {
    let button = "document.querySelector(\"[data-jog='Z+']\")";
    for way in [
        "dispatchEvent(new Event('blur'))".to_owned(),
        "dispatchEvent(new Event('pagehide'))".to_owned(),
        "dispatchEvent(new Event('resize'))".to_owned(),
        "dispatchEvent(new Event('orientationchange'))".to_owned(),
        "document.dispatchEvent(new Event('visibilitychange'))".to_owned(),
        format!("{button}.dispatchEvent(new PointerEvent('pointercancel'))"),
        format!("{button}.dispatchEvent(new PointerEvent('lostpointercapture'))"),
        // A page that hangs: no timer runs.
        "const until = Date.now() + 4000; while (Date.now() < until);".to_owned(),
    ] {
        hold_up(page, served)?;
        page.run(&way)?;
        served.check_rest().with_context(|| way.clone())?;
        wait("the page", || Ok(page.state()?["holding"] == false))?;
        page.pointer(&[up()])?;
    }
    // The pointer leaves the button.
    hold_up(page, served)?;
    page.pointer(&[move_to((5.0, 300.0))])?;
    served.check_rest().context("the pointer left")?;
    page.pointer(&[up()])
}

/// Enter holds a button that has the focus; the space bar stops.
fn keyboard(page: &Browser, served: &Served) -> anyhow::Result<()> {
    for stop in [false, true] {
        let start = served.height();
        let (mut moved, begin) = (false, Instant::now());
        while begin.elapsed() < LONGEST {
            take(page)?;
            page.run("document.querySelector(\"[data-jog='Z−']\").focus()")?;
            page.key("keyDown", ENTER)?;
            while !moved && page.state()?["holding"] == true {
                moved = served.height() < start - 0.003;
            }
            if moved {
                break;
            }
            page.key("keyUp", ENTER)?;
        }
        ensure!(moved, "the arm does not move while Enter is held");
        if stop {
            page.key("keyDown", " ")?;
            wait("the stop", || Ok(page.state()?["holding"] == false))?;
            page.key("keyUp", " ")?;
        }
        page.key("keyUp", ENTER)?;
        served.check_rest()?;
    }
    Ok(())
}

/// Drags link 6: the robot feels it, and the page draws the force.
fn push(page: &Browser, served: &Served) -> anyhow::Result<()> {
    take(page)?;
    page.run("scrollTo(0, 0)")?;
    let (x, y) = point(&page.state()?["links"][5])?;
    page.pointer(&[move_to((x, y)), down()])?;
    page.pointer(&[move_to((x, y - 150.0))])?;
    wait("the push", || {
        let force = served.robot.state().O_F_ext_hat_K;
        let newtons = force[..3].iter().map(|f| f * f).sum::<f64>().sqrt();
        Ok(newtons > 8.0 && page.state()?["forceShown"] == true)
    })?;
    page.pointer(&[up()])?;
    wait("the end of the push", || {
        Ok(page.state()?["forceShown"] == false)
    })
}

fn reflex_and_recovery(page: &Browser, served: &Served) -> anyhow::Result<()> {
    page.click("[data-fault='Reflex']")?;
    let is = |mode| Ok(served.robot.state().robot_mode == mode);
    wait("the reflex", || is(RobotMode::Reflex))?;
    wait("the reflex in the log", || {
        let text = page.run("return document.getElementById('events').textContent")?;
        Ok(text
            .as_str()
            .is_some_and(|text| text.contains("cartesian_reflex")))
    })?;
    page.click("#recover")?;
    wait("the recovery", || is(RobotMode::Idle))
}

/// The page goes away in mid-motion.
fn leave(page: &Browser, served: &Served) -> anyhow::Result<()> {
    hold_up(page, served)?;
    page.go("about:blank")?;
    served.check_rest().context("the page was left")
}

/// A picture of the page, with a hand that is pushed.
pub(crate) fn picture(
    page: &Browser,
    served: &Served,
    dark: bool,
    path: &Path,
) -> anyhow::Result<()> {
    let scheme = if dark { "dark" } else { "light" };
    let features = json!([{"name": "prefers-color-scheme", "value": scheme}]);
    let media = json!({"cmd": "Emulation.setEmulatedMedia", "params": {"features": features}});
    page.post("goog/cdp/execute", &media)?;
    load(page, served)?;
    shows_the_robot(page, served)?;
    take(page)?;
    let (x, y) = point(&page.state()?["links"][5])?;
    page.pointer(&[move_to((x, y)), down()])?;
    page.pointer(&[move_to((x + 60.0, y + 90.0))])?;
    wait("the force", || Ok(page.state()?["forceShown"] == true))?;
    wait("some history", || {
        Ok(page.state()?["frames"]
            .as_u64()
            .is_some_and(|frames| frames > 30))
    })?;
    page.picture(path)?;
    page.pointer(&[up()])
}

/// Until a hold begins, on a machine where the page answers late.
const LONGEST: Duration = Duration::from_secs(60);

/// The key, as WebDriver writes it.
const ENTER: &str = "\u{e007}";
