//! User actions on the page, and their expected effects.

use std::time::{Duration, Instant};

use anyhow::{Context, ensure};
use franka_async::MotionError;
use franka_async::state::RobotMode;
use serde_json::{Value, json};

use crate::driver::{Browser, down, move_to, point, up};
use crate::panels;
use crate::served::{PATIENCE, Served, wait};
use crate::targets;

/// One user action or observation.
type Check = fn(&Browser, &Served) -> anyhow::Result<()>;

/// Runs all checks, one after the other.
pub(crate) fn run(page: &Browser, served: &Served) -> anyhow::Result<()> {
    let checks: [(&str, Check); 22] = [
        ("load", load),
        ("shows the robot", shows_the_robot),
        ("looks", looks),
        ("second viewer", second_viewer),
        ("space bar", space_bar),
        ("jog", jog),
        ("step", step),
        ("look back", look_back),
        ("plots and export", panels::plots_and_export),
        ("preview and go", targets::preview_and_go),
        ("keep out", targets::keep_out),
        ("sliders", targets::sliders),
        ("lose the hold", lose_the_hold),
        ("keyboard", keyboard),
        ("checkbox", checkbox),
        ("push", push),
        ("bend", bend),
        ("tune", panels::tune),
        ("tare", panels::tare),
        ("network cut", panels::cut),
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

/// Checks that the drawn end effector matches the robot's end effector.
pub(crate) fn shows_the_robot(page: &Browser, served: &Served) -> anyhow::Result<()> {
    wait("the drawn arm", || {
        let shown = page.state()?["endEffector"].clone();
        let robot = served.robot.pose().translation;
        let off = |i: usize| shown[i].as_f64().map(|x| (x - robot.vector[i]).abs());
        Ok((0..3).all(|i| off(i).is_some_and(|off| off < 1e-3)))
    })
}

/// Checks that the drawn fingers are as far apart as the robot's fingers.
fn shows_the_fingers(page: &Browser, served: &Served) -> anyhow::Result<()> {
    wait("the drawn fingers", || {
        let shown = page.state()?["width"].as_f64();
        let width = served.gripper.state().width;
        Ok(shown.is_some_and(|shown| (shown - width).abs() < 1e-3))
    })
}

/// Checks that another socket of the same page is another viewer, whose requests are refused,
/// except a stop.
fn second_viewer(page: &Browser, served: &Served) -> anyhow::Result<()> {
    take(page)?;
    let start = served.robot.state().q;
    let refused = page.run(
        "const it = new WebSocket(`ws://${location.host}/ws`, ['franka-dash']); \
         const asked = [{type: 'take', name: 'another'}, {type: 'recover'}, \
           {type: 'begin', motion: {kind: 'ready'}, speed: 0.05}, \
           {type: 'disturb', disturbance: {kind: 'reflex'}}, {type: 'stop'}]; \
         const heard = []; \
         return new Promise((resolve) => { \
           it.onopen = () => { for (const one of asked) it.send(JSON.stringify(one)); }; \
           it.onmessage = ({data}) => { \
             if (typeof data !== 'string') return; \
             const {type, why} = JSON.parse(data); \
             if (type === 'refused') heard.push(why); \
             if (heard.length === 4) { it.close(); resolve(heard); } \
           }; \
         })",
    )?;
    let refused = refused.as_array().context("refusals")?.len();
    ensure!(refused == 4, "{refused} refusals");
    wait("the stop of the other viewer", || {
        page.shows("events", "Stopped by a viewer")
    })?;
    served.check_still(start)?;
    ensure!(
        served.robot.state().robot_mode == RobotMode::Idle,
        "a reflex"
    );
    ensure!(page.state()?["commands"] == true, "the lease is gone");
    Ok(())
}

/// Checks that the page can replay the last seconds, and then returns to the live view.
fn look_back(page: &Browser, served: &Served) -> anyhow::Result<()> {
    let height = || page.state()?["endEffector"][2].as_f64().context("a height");
    // Uses the robot's value: a page on a busy machine shows it later.
    let now = served.height();
    let scrub = |seconds: f64| {
        page.run(&format!(
            "const it = document.getElementById('scrub'); it.value = {seconds}; \
             it.dispatchEvent(new Event('input'))"
        ))
    };
    // As far back as possible: before the jog.
    scrub(-60.0)?;
    wait("what was", || Ok(height()? < now - 2e-3))?;
    ensure!(page.state()?["live"] == false, "it is live");
    page.click("#pause")?;
    wait("what is", || Ok((height()? - now).abs() < 1e-3))?;
    page.click("#pause")?;
    ensure!(page.state()?["live"] == false, "it is not paused");
    page.click("#pause")?;
    ensure!(page.state()?["live"] == true, "it is paused");
    Ok(())
}

/// Checks that the page draws links and fingers as meshes. Later checks use capsules, which need
/// less computation without a graphics card.
pub(crate) fn looks(page: &Browser, served: &Served) -> anyhow::Result<()> {
    wait("the meshes", || Ok(page.state()?["meshes"] == true))?;
    shows_the_fingers(page, served)?;
    page.run(
        "const it = document.getElementById('looks'); it.value = 'capsules'; \
         it.dispatchEvent(new Event('change')); \
         const speed = document.getElementById('speed'); speed.value = 150; \
         speed.dispatchEvent(new Event('input'))",
    )?;
    Ok(())
}

/// Takes command of the robot. Tries again if the connection was lost because the page was too
/// busy.
pub(crate) fn take(page: &Browser) -> anyhow::Result<()> {
    let commands = || Ok(page.state()?["commands"] == true);
    let begin = Instant::now();
    while !commands()? {
        ensure!(begin.elapsed() < LONGEST, "the page gets no lease");
        page.click("#lease")?;
        // Otherwise the server is asked once more.
        let _ = wait("the lease", commands);
    }
    Ok(())
}

/// Presses the button that moves up until the arm has moved. The button is still pressed on return.
pub(crate) fn hold_up(page: &Browser, served: &Served) -> anyhow::Result<()> {
    let start = served.height();
    hold_until(page, "[data-jog='Z+']", || served.height() > start + 0.003)
}

/// Presses a button until `done` is true. Tries again if the machine was too busy for a hold. The
/// button may be pressed on return.
pub(crate) fn hold_until(
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
    let (mut shown, mut lost, begin) = (false, false, Instant::now());
    while !shown {
        ensure!(begin.elapsed() < LONGEST, "each hold was cut short");
        hold_up(page, served)?;
        wait("the top lines", || {
            shown = top_lines(page)? == json!(["held", "target control", "fed"]);
            Ok(shown || page.state()?["holding"] != true)
        })?;
        // On a machine that was too busy for the hold.
        lost = page.state()?["holding"] != true;
        page.pointer(&[up()])?;
    }
    served.check_rest()?;
    let deadman = if lost { "expired" } else { "off" };
    wait("the top lines at rest", || {
        Ok(top_lines(page)? == json!(["none", "none", deadman]))
    })
}

/// Checks that a step moves by its stated distance, and ends automatically.
fn step(page: &Browser, served: &Served) -> anyhow::Result<()> {
    let choose = |step| page.run(&format!("document.getElementById('step').value = '{step}'"));
    choose("10")?;
    let begin = Instant::now();
    loop {
        ensure!(begin.elapsed() < LONGEST, "each step was cut short");
        take(page)?;
        let start = served.height();
        page.pointer(&[move_to(page.find("[data-jog='Z+']")?), down()])?;
        // The step has ended, or was lost on a machine that is too busy for a hold.
        wait("the end", || Ok(page.state()?["holding"] == false))?;
        page.pointer(&[up()])?;
        served.check_rest()?;
        let gone = served.height() - start;
        ensure!(gone < 0.013, "{gone} m");
        if gone > 0.007 {
            break;
        }
    }
    choose("").map(drop)
}

/// Returns the displayed session, law and deadman.
fn top_lines(page: &Browser) -> anyhow::Result<Value> {
    page.run(
        "return ['session', 'law', 'deadman'] \
         .map((id) => document.getElementById(id).textContent)",
    )
}

/// Tests each way in which a browser can end the press of a button.
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
        // A page that hangs: timers do not run.
        format!("const until = Date.now() + {HANGS}; while (Date.now() < until);"),
    ] {
        hold_up(page, served)?;
        page.run(&way)?;
        served.check_rest().with_context(|| way.clone())?;
        wait("the page", || Ok(page.state()?["holding"] == false))?;
        page.pointer(&[up()])?;
    }
    wait("the top lines", || {
        Ok(top_lines(page)? == json!(["none", "none", "expired"]))
    })?;
    // The pointer leaves the button.
    hold_up(page, served)?;
    page.pointer(&[move_to((5.0, 300.0))])?;
    served.check_rest().context("the pointer left")?;
    page.pointer(&[up()])
}

/// Checks that Enter toggles the compensation when the checkbox has the focus.
fn checkbox(page: &Browser, _: &Served) -> anyhow::Result<()> {
    take(page)?;
    let compensates = || anyhow::Ok(page.state()?["status"]["tuning"]["compensation"] == true);
    let sliders = "const it = [...document.querySelectorAll('#tuning input[type=range]')].at(-1);";
    page.run(&format!("{sliders} it.focus()"))?;
    press(page, TAB)?;
    for on in [false, true] {
        ensure!(compensates()? != on, "it is switched already");
        press(page, ENTER)?;
        wait("the compensation", || Ok(compensates()? == on))?;
    }
    Ok(())
}

/// Checks that the space bar stops a motion while an element of each kind has the focus, and that
/// it has no other effect there.
fn space_bar(page: &Browser, served: &Served) -> anyhow::Result<()> {
    take(page)?;
    press(page, TAB)?;
    let kinds = page.run(
        "const kinds = window.__kinds = {nothing: document.body}; \
         const all = 'a[href], button, input, select, textarea, summary, [tabindex]'; \
         for (const it of document.querySelectorAll(all)) { \
           if (!it.disabled && it.checkVisibility()) kinds[`${it.localName} ${it.type ?? ''}`] ??= it; \
         } \
         window.__effects = 0; \
         for (const type of ['click', 'input', 'change']) \
           addEventListener(type, () => { window.__effects += 1; }, {capture: true}); \
         return Object.keys(kinds)",
    )?;
    let kinds: Vec<String> = serde_json::from_value(kinds)?;
    for kind in [
        "button button",
        "input checkbox",
        "input range",
        "select select-one",
    ] {
        ensure!(kinds.iter().any(|it| it == kind), "no {kind} in {kinds:?}");
    }
    for kind in kinds {
        let motion = served.turn();
        wait("a motion", || {
            Ok(served.robot.state().motion_running() || motion.is_finished())
        })?;
        let focus = page.run(&format!(
            "const it = window.__kinds[{kind:?}]; document.activeElement.blur(); it.focus(); \
             return document.activeElement === it && (it === document.body || it.matches(':focus-visible'))"
        ))?;
        ensure!(focus == true, "{kind} has not got the focus of a keyboard");
        press(page, " ")?;
        let outcome = served.outcome(motion)?;
        let is_stopped = matches!(outcome, Err(MotionError::Stopped));
        ensure!(is_stopped, "the focus on {kind}: {outcome:?}");
        let effects = page.run("return window.__effects")?;
        ensure!(
            effects == 0,
            "the space bar has done {effects} things in {kind}"
        );
    }
    page.run("document.activeElement.blur()").map(drop)
}

/// Presses a key, and releases it.
fn press(page: &Browser, key: &str) -> anyhow::Result<()> {
    page.key("keyDown", key)?;
    page.key("keyUp", key)
}

/// Checks that Enter presses a button that has the focus, and that the space bar stops.
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

/// Drags link 6. Checks that the robot measures the force, and that the page draws it.
fn push(page: &Browser, served: &Served) -> anyhow::Result<()> {
    served.make_ready()?;
    drag_until(page, (0.0, -150.0), || {
        let force = served.robot.state().O_F_ext_hat_K;
        let newtons = force[..3].iter().map(|f| f * f).sum::<f64>().sqrt();
        newtons > 8.0
    })?;
    page.pointer(&[up()])?;
    wait("the end of the push", || {
        Ok(page.state()?["forceShown"] == false)
    })
}

/// Drags link 6 of the drawn arm until the page draws the force and `felt` is true. Tries again if
/// the page was too busy and released the link. The link is still dragged on return.
pub(crate) fn drag_until(
    page: &Browser,
    by: (f64, f64),
    felt: impl Fn() -> bool,
) -> anyhow::Result<()> {
    let begin = Instant::now();
    while begin.elapsed() < LONGEST {
        take(page)?;
        drag(page, by)?;
        for _ in 0..100 {
            if page.state()?["forceShown"] == true && felt() {
                return Ok(());
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        page.pointer(&[up()])?;
    }
    anyhow::bail!("no force is drawn: {}", page.state()?)
}

/// Presses on link 6 of the drawn arm, and drags it by this number of pixels.
pub(crate) fn drag(page: &Browser, (right, down_by): (f64, f64)) -> anyhow::Result<()> {
    page.run("scrollTo(0, 0)")?;
    let (x, y) = point(&page.state()?["links"][5])?;
    page.pointer(&[move_to((x, y)), down()])?;
    page.pointer(&[move_to((x + right, y + down_by))])
}

/// Starts to hold the arm in place with the keyboard, so that a pointer can push the arm.
pub(crate) fn hold_here(page: &Browser) -> anyhow::Result<()> {
    let button = "document.querySelector(\"[data-jog='Hold here']\")";
    page.run(&format!("{button}.focus({{preventScroll: true}})"))?;
    page.key("keyDown", ENTER)
}

/// Pushes the arm while it is held, by less than its collision thresholds. Checks that the arm
/// yields, and that the reference is drawn at the driver's position.
fn bend(page: &Browser, served: &Served) -> anyhow::Result<()> {
    let apart = |a: &Value, b: &Value| {
        let off = |i: usize| Some((a[i].as_f64()? - b[i].as_f64()?).powi(2));
        (0..3).map(off).sum::<Option<f64>>().map(f64::sqrt)
    };
    let (mut bent, begin) = (false, Instant::now());
    while !bent {
        ensure!(begin.elapsed() < LONGEST, "each hold was cut short");
        take(page)?;
        hold_here(page)?;
        drag(page, (0.0, -40.0))?;
        let mut state = Value::Null;
        let waited = wait("the arm to bend", || {
            state = page.state()?;
            let reference = served.robot.reference();
            bent = reference.is_some_and(|it| {
                let there = json!(it.pose.translation.vector.as_slice());
                let drawn = &state["reference"];
                apart(drawn, &there).is_some_and(|off| off < 1e-3)
                    && apart(drawn, &state["endEffector"]).is_some_and(|off| off > 0.005)
            });
            Ok(bent || state["holding"] != true)
        });
        waited.with_context(|| format!("{:?}, {state}", served.robot.reference()))?;
        page.pointer(&[up()])?;
        page.key("keyUp", ENTER)?;
    }
    served.check_rest()
}

fn reflex_and_recovery(page: &Browser, served: &Served) -> anyhow::Result<()> {
    take(page)?;
    page.click("[data-fault='Reflex']")?;
    let is = |mode| Ok(served.robot.state().robot_mode == mode);
    wait("the reflex", || is(RobotMode::Reflex))?;
    wait("the reflex in the log", || {
        page.shows("events", "cartesian_reflex")
    })?;
    take(page)?;
    page.click("#recover")?;
    wait("the recovery", || is(RobotMode::Idle))
}

/// Closes the page in the middle of a motion.
fn leave(page: &Browser, served: &Served) -> anyhow::Result<()> {
    hold_up(page, served)?;
    page.go("about:blank")?;
    served.check_rest().context("the page was left")
}

/// Time for which a page hangs, `[ms]`. It is longer than the server waits for a message.
const HANGS: u128 = PATIENCE.as_millis() + 500;

/// Time limit for a hold to begin, on a machine on which the page answers late.
const LONGEST: Duration = Duration::from_secs(60);

/// Keys, in WebDriver's notation.
pub(crate) const ENTER: &str = "\u{e007}";
const TAB: &str = "\u{e004}";
