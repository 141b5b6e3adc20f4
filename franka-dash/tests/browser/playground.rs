//! The book's playground: driver and simulated robot in the page itself.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use axum::Router;
use axum::http::{StatusCode, Uri, header};
use axum::response::IntoResponse as _;
use serde_json::Value;
use tokio::runtime::Runtime;

use crate::driver::{Browser, down, move_to, point, up};
use crate::pictures;
use crate::served::wait;

/// Tests the page that was built in a folder, first with a realistic arm, then with an ideal arm of
/// the other kind.
pub(crate) fn run(page: &Browser, built: PathBuf, folder: &Path) -> anyhow::Result<()> {
    let runtime = Runtime::new()?;
    let address = serve(&runtime, built)?;
    pictures::resize(page, 750, 560)?;
    page.go(&format!("http://{address}/index.html"))?;
    wait("the meshes", || Ok(page.state()?["meshes"] == true))?;
    drawn_where_it_is(page)?;
    step(page, 1e-3)?;
    drag_the_target(page)?;
    let pictured = folder.join("playground-pushed.png");
    push(page, &pictured).context("push")?;
    stop_and_recover(page, &folder.join("playground-stopped.png")).context("stop")?;
    page.click("[data-kind='fer']")?;
    page.click("[data-arm='ideal']")?;
    wait("the meshes", || Ok(page.state()?["meshes"] == true))?;
    drawn_where_it_is(page)?;
    step(page, 1e-4)?;
    ensure!(page.state()?["errors"] == 0, "errors in the page");
    Ok(())
}

/// Checks that the drawn end effector is at the robot's measured position, which the page computes
/// from the joints.
fn drawn_where_it_is(page: &Browser) -> anyhow::Result<()> {
    wait("the drawn arm", || {
        let state = page.state()?;
        let off = |i: usize| {
            let drawn = state["endEffector"][i].as_f64()?;
            Some((drawn - state["view"]["endEffector"][i].as_f64()?).abs())
        };
        Ok((0..3).all(|i| off(i).is_some_and(|off| off < 1e-4)))
    })
}

/// Checks that the arm follows a jump of the target, and arrives without exceeding its speed cap.
fn step(page: &Browser, near: f64) -> anyhow::Result<()> {
    wait("the start", || Ok(number(page, "state")? == 0.0))?;
    page.click("#next")?;
    wait("the step", || Ok(number(page, "distance")? > 0.1))?;
    arrive(page, near)
}

fn arrive(page: &Browser, near: f64) -> anyhow::Result<()> {
    wait("the arm to arrive", || {
        let speed = number(page, "speed")?;
        // The measured value contains noise.
        ensure!(speed < 0.3, "{speed} m/s");
        Ok(number(page, "distance")? < near)
    })
}

/// Drags the centre of the handle. Checks that the target follows, and then the arm.
fn drag_the_target(page: &Browser) -> anyhow::Result<()> {
    let (x, y) = point(&page.state()?["gizmo"])?;
    page.pointer(&[move_to((x, y)), down()])?;
    page.pointer(&[move_to((x + 30.0, y + 40.0)), up()])?;
    wait("the target", || Ok(number(page, "distance")? > 0.02))?;
    arrive(page, 1e-3)
}

/// Drags the hand. Checks that the robot measures the force, and yields until the hand is released.
fn push(page: &Browser, picture: &Path) -> anyhow::Result<()> {
    press_the_hand(page, (-35.0, 10.0))?;
    wait("the force", || {
        Ok(force(page)? > 12.0 && number(page, "distance")? > 3e-3)
    })?;
    ensure!(page.state()?["pullShown"] == true, "no arrow");
    page.picture(picture)?;
    page.pointer(&[up()])?;
    // Friction and bias of a realistic arm also appear as a force of some newtons.
    wait("the end of the force", || Ok(force(page)? < 7.0))?;
    arrive(page, 1e-3)
}

/// Pushes the hand too hard. Checks that the robot stops, and then continues. Then an obstacle
/// blocks the arm during a motion.
fn stop_and_recover(page: &Browser, picture: &Path) -> anyhow::Result<()> {
    press_the_hand(page, (-300.0, 150.0))?;
    wait("the reflex", || Ok(number(page, "state")? == 2.0))?;
    wait("the reason", || page.shows("message", "reflex"))?;
    page.picture(picture)?;
    page.pointer(&[up()])?;
    page.click("#recover")?;
    step(page, 1e-3)?;
    page.click("#block")?;
    page.click("#next")?;
    wait("the force of the obstacle", || Ok(force(page)? > 12.0))?;
    ensure!(number(page, "distance")? > 0.1, "the arm went through it");
    page.click("#reset")
}

/// Presses on the drawn hand, and drags it by this number of pixels.
fn press_the_hand(page: &Browser, (right, down_by): (f64, f64)) -> anyhow::Result<()> {
    let state = page.state()?;
    let ((x7, y7), (x, y)) = (point(&state["links"][6])?, point(&state["gizmo"])?);
    // The flange is between joint 7 and the handle at the end effector.
    let along = |from: f64, to: f64| from + 0.64 * (to - from);
    let hand = (along(x7, x), along(y7, y));
    page.pointer(&[move_to(hand), down()])?;
    page.pointer(&[move_to((hand.0 + right, hand.1 + down_by))])
}

/// Returns a number from the page's state of the arm.
fn number(page: &Browser, name: &str) -> anyhow::Result<f64> {
    let state = page.state()?;
    state["view"][name]
        .as_f64()
        .with_context(|| name.to_owned())
}

/// Returns the force estimated by the robot, `[N]`.
fn force(page: &Browser) -> anyhow::Result<f64> {
    let state = page.state()?;
    let force = state["view"]["force"].as_array().context("a force")?;
    let squares = force.iter().filter_map(Value::as_f64).map(|f| f * f);
    Ok(squares.sum::<f64>().sqrt())
}

/// Serves the files of a folder until the runtime ends.
fn serve(runtime: &Runtime, folder: PathBuf) -> anyhow::Result<SocketAddr> {
    let answer = async move |uri: Uri| {
        let path = folder.join(uri.path().trim_start_matches('/'));
        let kind = match path.extension().and_then(|it| it.to_str()) {
            Some("html") => "text/html",
            Some("js") => "text/javascript",
            Some("css") => "text/css",
            Some("svg") => "image/svg+xml",
            _ => "application/octet-stream",
        };
        match std::fs::read(&path) {
            Ok(content) => ([(header::CONTENT_TYPE, kind)], content).into_response(),
            Err(_) => StatusCode::NOT_FOUND.into_response(),
        }
    };
    runtime.block_on(async {
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await?;
        let address = listener.local_addr()?;
        let router = Router::new().fallback(answer);
        tokio::spawn(async move { axum::serve(listener, router).await });
        Ok(address)
    })
}
