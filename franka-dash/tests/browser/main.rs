//! Tests the page in a real browser with simulated robots: it shows the robot's true state, user
//! actions have their effects, and the arm stops after any loss of a hold.

mod access;
mod animation;
mod checks;
mod driver;
mod film;
mod panels;
mod pictures;
mod playground;
mod restart;
mod served;
mod several;
mod targets;

use std::path::{Path, PathBuf};

use anyhow::Context;

use driver::{Browser, Driver};
use served::Served;

#[test]
#[ignore = "needs a browser: cargo xtask nightly --only dashboard"]
fn the_page_shows_and_moves_simulated_robots() -> anyhow::Result<()> {
    let (driver, browser) = (variable("FRANKA_WEBDRIVER")?, variable("FRANKA_BROWSER")?);
    let folder = PathBuf::from(variable("FRANKA_PICTURES")?);
    std::fs::create_dir_all(&folder)?;
    let driver = Driver::start(&driver)?;
    let fr3 = Served::new(franka_sim::Sim::fr3(), "fr3")?;
    let fer = Served::new(franka_sim::Sim::fer(), "fer")?;
    let open = |size| Browser::open(&driver, &browser, size);
    std::thread::scope(|scope| {
        // In parallel, because most of the time is spent waiting for arms.
        let beside = scope.spawn(|| {
            let page = open((1440, 900))?;
            pictures::run(&page, &fer, "fer", &folder)?;
            page.check_console()
        });
        let page = open((900, 640))?;
        let mut checked = checks::run(&page, &fr3);
        // Without it, only the server's requests test these panels: see `sockets`.
        if checked.is_ok() && std::env::var_os("FRANKA_THOROUGH").is_some() {
            checked = panels::run(&page, &fr3, &folder.join("panels.png"));
        }
        page.picture(&folder.join("checked.png"))?;
        checked?;
        page.check_console()?;
        beside.join().expect("no panic")
    })?;
    let page = open((1440, 900))?;
    pictures::run(&page, &fr3, "fr3", &folder)?;
    pictures::resize(&page, 1180, 820)?;
    restart::run(&page, &fr3)?;
    several::run(&page, [&fr3, &fer], &folder.join("several.png"))?;
    page.check_console()?;
    // Its console contains the server's refusals.
    access::run(&open((900, 640))?, &fr3)?;
    println!("pictures: {}", folder.display());
    Ok(())
}

#[test]
#[ignore = "needs a browser: cargo xtask pictures"]
fn the_film_of_the_readme_is_recorded() -> anyhow::Result<()> {
    let (driver, browser) = (variable("FRANKA_WEBDRIVER")?, variable("FRANKA_BROWSER")?);
    let driver = Driver::start(&driver)?;
    // In slow virtual time, because a screenshot takes long without a graphics card.
    let sim = franka_sim::Sim::fr3().virtual_time(film::PATIENCE);
    let fr3 = Served::new(sim, "film")?;
    let page = Browser::open(&driver, &browser, (1440, 900))?;
    film::record(&page, &fr3, Path::new(&variable("FRANKA_FILM")?))?;
    page.check_console()
}

#[test]
#[ignore = "needs a browser: cargo xtask nightly --only playground"]
fn the_playground_of_the_book_aims_gives_way_stops_and_recovers() -> anyhow::Result<()> {
    let (driver, browser) = (variable("FRANKA_WEBDRIVER")?, variable("FRANKA_BROWSER")?);
    let pictures = PathBuf::from(variable("FRANKA_PICTURES")?);
    std::fs::create_dir_all(&pictures)?;
    let driver = Driver::start(&driver)?;
    let page = Browser::open(&driver, &browser, (750, 560))?;
    let built = PathBuf::from(variable("FRANKA_PLAYGROUND")?);
    playground::run(&page, built, &pictures)?;
    page.check_console()
}

fn variable(name: &str) -> anyhow::Result<String> {
    std::env::var(name).with_context(|| name.to_owned())
}
