//! The page in a real browser, before simulated robots: what it shows is what the robot is, what a
//! person does with it has its effect, and a hold that is lost in any way has the arm rest.

mod checks;
mod driver;
mod panels;
mod served;
mod several;

use std::path::PathBuf;

use anyhow::Context;

use driver::{Browser, Driver};
use served::Served;

#[test]
#[ignore = "needs a browser: cargo xtask test --only dashboard"]
fn the_page_shows_and_moves_simulated_robots() -> anyhow::Result<()> {
    let variable = |name: &str| std::env::var(name).with_context(|| name.to_owned());
    let (driver, browser) = (variable("FRANKA_WEBDRIVER")?, variable("FRANKA_BROWSER")?);
    let pictures = PathBuf::from(variable("FRANKA_PICTURES")?);
    std::fs::create_dir_all(&pictures)?;
    let driver = Driver::start(&driver)?;
    let fr3 = Served::new(franka_sim::Sim::fr3(), "fr3")?;
    {
        let page = Browser::open(&driver, &browser, (900, 640))?;
        let panels = pictures.join("panels.png");
        let mut checked = checks::run(&page, &fr3);
        // Without it, the panels are tested by the server's requests alone: see `sockets`.
        if checked.is_ok() && std::env::var_os("FRANKA_THOROUGH").is_some() {
            checked = panels::run(&page, &fr3, &panels);
        }
        page.picture(&pictures.join("checked.png"))?;
        checked?;
        page.check_console()?;
    }
    let fer = Served::new(franka_sim::Sim::fer(), "fer")?;
    for (name, served, size, dark) in [
        ("fr3-light", &fr3, (1440, 900), false),
        ("fr3-dark", &fr3, (1440, 900), true),
        ("fer-light", &fer, (1440, 900), false),
        ("fer-tablet-dark", &fer, (820, 1180), true),
    ] {
        let page = Browser::open(&driver, &browser, size)?;
        checks::picture(&page, served, dark, &pictures.join(format!("{name}.png")))?;
        page.check_console()?;
    }
    let page = Browser::open(&driver, &browser, (1180, 820))?;
    several::run(&page, [&fr3, &fer], &pictures.join("several.png"))?;
    page.check_console()?;
    println!("pictures: {}", pictures.display());
    Ok(())
}
