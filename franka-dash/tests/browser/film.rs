//! The film of the README. It shows a target, the motion to it, and a push while the arm is held.

use std::path::Path;
use std::time::Duration;

use anyhow::ensure;

use crate::animation::{self, Frame};
use crate::checks::{ENTER, hold_here, load, shows_the_robot, take};
use crate::driver::{Browser, down, move_to, point, up};
use crate::pictures::resize_scaled;
use crate::served::{Served, wait};

/// Consecutive screenshots of the page, with times of the robot's clock.
struct Film<'a> {
    page: &'a Browser,
    served: &'a Served,
    frames: Vec<Frame>,
    pointer: (f64, f64),
}

impl Film<'_> {
    fn now(&self) -> Duration {
        Duration::from_millis(self.served.robot.state().message_id)
    }

    /// Takes a screenshot when it is due.
    fn shoot(&mut self) -> anyhow::Result<()> {
        ensure!(self.frames.len() < LONGEST, "the film does not end");
        if let Some(last) = self.frames.last().map(|last| last.at) {
            wait("the next shot", || Ok(self.now() >= last + EVERY))?;
        }
        let at = self.now();
        self.frames.push(Frame::of(&self.page.shot()?, at)?);
        Ok(())
    }

    /// Takes this number of screenshots.
    fn shoot_on(&mut self, shots: usize) -> anyhow::Result<()> {
        (0..shots).try_for_each(|_| self.shoot())
    }

    /// Moves the pointer within this number of screenshots.
    fn glide(&mut self, (x, y): (f64, f64), shots: u32) -> anyhow::Result<()> {
        let from = self.pointer;
        for shot in 1..=shots {
            let part = f64::from(shot) / f64::from(shots);
            // Slow at both ends.
            let part = part * part * (3.0 - 2.0 * part);
            self.pointer = (from.0 + part * (x - from.0), from.1 + part * (y - from.1));
            self.page.pointer(&[move_to(self.pointer)])?;
            self.shoot()?;
        }
        Ok(())
    }

    /// Returns the position of an element's centre on the page, which must not be scrolled.
    fn middle(&self, selector: &str) -> anyhow::Result<(f64, f64)> {
        point(&self.page.run(&format!(
            "const box = document.querySelector({selector:?}).getBoundingClientRect(); \
             return [box.left + box.width / 2, box.top + box.height / 2]"
        ))?)
    }

    fn press(&self, is_down: bool) -> anyhow::Result<()> {
        self.page.pointer(&[if is_down { down() } else { up() }])
    }
}

/// Records the film, with an arm that has not moved yet.
pub(crate) fn record(page: &Browser, served: &Served, file: &Path) -> anyhow::Result<()> {
    resize_scaled(page, 1200, 750, 0.7)?;
    load(page, served)?;
    shows_the_robot(page, served)?;
    wait("the meshes", || Ok(page.state()?["meshes"] == true))?;
    take(page)?;
    page.click("#goal-place")?;
    page.run(PREPARE)?;
    let mut film = Film {
        page,
        served,
        frames: Vec::new(),
        pointer: (640.0, 560.0),
    };
    page.pointer(&[move_to(film.pointer)])?;
    served.running.set_speed(Some(SPEED))?;
    film.shoot()?;
    let (x, y) = point(&page.state()?["gizmo"])?;
    film.glide((x, y), 3)?;
    film.press(true)?;
    film.glide((x + 40.0, y + 109.0), 9)?;
    film.press(false)?;
    film.shoot_on(2)?;
    film.glide(film.middle("#goal-go")?, 3)?;
    film.press(true)?;
    while page.state()?["holding"] == true {
        film.shoot()?;
    }
    film.press(false)?;
    let off = page.state()?["ghost"].clone();
    ensure!(off.is_null(), "it has not arrived: {}", page.state()?);
    film.glide(film.middle("#goal-remove")?, 3)?;
    film.press(true)?;
    film.press(false)?;
    hold_here(page)?;
    film.shoot()?;
    for _ in 0..3 {
        page.run(SCROLL)?;
        film.shoot()?;
    }
    let (x, y) = point(&page.state()?["links"][5])?;
    film.glide((x, y), 3)?;
    film.press(true)?;
    film.glide((x - 30.0, y - 122.0), 5)?;
    film.shoot_on(10)?;
    film.press(false)?;
    film.shoot_on(6)?;
    page.key("keyUp", ENTER)?;
    let end = film.frames.last().map_or(Duration::ZERO, |it| it.at) + REST;
    animation::write(file, &film.frames, end)?;
    let bytes = std::fs::metadata(file)?.len();
    println!(
        "{}: {bytes} bytes, {} frames",
        file.display(),
        film.frames.len()
    );
    Ok(())
}

/// Speed of the robot's time, relative to the wall clock.
const SPEED: f64 = 0.15;

/// Smallest interval between screenshots.
const EVERY: Duration = Duration::from_millis(100);

/// Duration of the last screenshot.
const REST: Duration = Duration::from_millis(600);

/// Number of screenshots after which a film has failed.
const LONGEST: usize = 200;

/// Time for which the robot waits for a command on a busy machine.
pub(crate) const PATIENCE: Duration = Duration::from_millis(500);

/// Script that sets a lower speed and a closer view, and draws a pointer, because screenshots show
/// none.
const PREPARE: &str = "\
    const speed = document.getElementById('speed'); \
    speed.value = 200; \
    speed.dispatchEvent(new Event('input')); \
    const scene = document.getElementById('scene'); \
    for (let i = 0; i < 4; i += 1) scene.dispatchEvent(new WheelEvent('wheel', {deltaY: -100})); \
    scrollTo(0, 0); \
    const it = document.createElement('div'); \
    it.style.cssText = 'position: fixed; z-index: 9; pointer-events: none; width: 28px; height: 28px'; \
    it.innerHTML = '<svg viewBox=\"0 0 24 24\"><path d=\"M2 1v19l5-4.5 3.3 7 3.4-1.6-3.3-6.8h6.8z\" \
      fill=\"#111\" stroke=\"#fff\" stroke-width=\"1.5\"/></svg>'; \
    document.body.append(it); \
    addEventListener('pointermove', (event) => { \
      it.style.left = `${event.clientX - 2}px`; it.style.top = `${event.clientY - 1}px`; \
    }, {capture: true})";

/// Script that scrolls a third of the way to the guards.
const SCROLL: &str = "\
    const panel = document.getElementById('guards-list').parentElement; \
    window.__way ??= panel.getBoundingClientRect().bottom + 8 - innerHeight; \
    scrollBy(0, window.__way / 3)";
