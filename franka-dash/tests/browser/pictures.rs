//! Pictures of the page: both sizes, light and dark.

use std::path::Path;

use serde_json::{Value, json};

use crate::checks::{drag_until, load, shows_the_robot};
use crate::driver::{Browser, up};
use crate::served::{Served, wait};

/// Takes pictures of the page while the hand is pushed, named `NAME-SIZE-SCHEME.png`. Also takes a
/// picture of a window that shows the whole page.
pub(crate) fn run(
    page: &Browser,
    served: &Served,
    name: &str,
    folder: &Path,
) -> anyhow::Result<()> {
    load(page, served)?;
    shows_the_robot(page, served)?;
    wait("the meshes", || Ok(page.state()?["meshes"] == true))?;
    for (size, width, height) in [("desktop", 1440, 900), ("tablet", 820, 1180)] {
        resize(page, width, height)?;
        for scheme in ["light", "dark"] {
            let features = json!([{"name": "prefers-color-scheme", "value": scheme}]);
            tell(
                page,
                "Emulation.setEmulatedMedia",
                json!({"features": features}),
            )?;
            drag_until(page, (45.0, 65.0), || true)?;
            page.picture(&folder.join(format!("{name}-{size}-{scheme}.png")))?;
            page.pointer(&[up()])?;
        }
    }
    resize(page, 820, 3400)?;
    page.picture(&folder.join(format!("{name}-all.png")))
}

/// Sets the size of the page, in pixels.
pub(crate) fn resize(page: &Browser, width: u32, height: u32) -> anyhow::Result<()> {
    resize_scaled(page, width, height, 1.0)
}

/// Like [`resize`], with this number of picture pixels per page pixel.
pub(crate) fn resize_scaled(
    page: &Browser,
    width: u32,
    height: u32,
    scale: f64,
) -> anyhow::Result<()> {
    let screen =
        json!({"width": width, "height": height, "deviceScaleFactor": scale, "mobile": false});
    tell(page, "Emulation.setDeviceMetricsOverride", screen)?;
    wait("the new size", || {
        Ok(page.run("return [innerWidth, innerHeight]")? == json!([width, height]))
    })?;
    page.run("scrollTo(0, 0)")?;
    // The next frame of the browser draws the scene in its new size.
    page.run(
        "return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))",
    )?;
    Ok(())
}

/// Sends a command to the browser itself.
fn tell(page: &Browser, what: &str, how: Value) -> anyhow::Result<()> {
    page.post("goog/cdp/execute", &json!({"cmd": what, "params": how}))?;
    Ok(())
}
