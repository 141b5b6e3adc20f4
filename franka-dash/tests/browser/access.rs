//! A page whose server requires a token.

use anyhow::ensure;

use crate::driver::Browser;
use crate::served::{Served, wait};

/// Token of the server.
const SECRET: &str = "correct-horse-battery";

/// Checks that the page reports a missing or wrong token, and shows the robot with the right token.
pub(crate) fn run(page: &Browser, served: &Served) -> anyhow::Result<()> {
    let address = served.with_token(SECRET)?;
    for (fragment, why) in [
        ("", "the address needs a token"),
        (
            "#correct-horse-batterz",
            "the token in the address is wrong",
        ),
        ("#not,a,token", "the token in the address is wrong"),
    ] {
        page.go("about:blank")?;
        page.go(&format!("http://{address}/{fragment}"))?;
        wait(&format!("{why:?} at {fragment:?}"), || {
            page.shows("events", why)
        })?;
        ensure!(page.shows("mode", "no access")?, "{fragment}: another mode");
        let lines = page.run("return document.querySelectorAll('#events li').length")?;
        ensure!(lines == 1, "{fragment}: {lines} lines");
    }
    // The user corrects the address of an open page.
    page.run(&format!("location.hash = '#{SECRET}'"))?;
    wait("the robot", || Ok(page.state()?["ready"] == true))
}
