//! A browser, driven by WebDriver over HTTP.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use anyhow::{Context, ensure};
use base64::prelude::{BASE64_STANDARD, Engine as _};
use serde_json::{Value, json};

/// The program that drives browsers.
pub(crate) struct Driver {
    process: Child,
    url: String,
}

impl Driver {
    pub(crate) fn start(program: &str) -> anyhow::Result<Self> {
        let mut command = Command::new(program);
        command.arg("--port=0").stdout(Stdio::piped());
        let mut process = command.spawn().with_context(|| program.to_owned())?;
        let output = process.stdout.take().context("its output")?;
        for line in BufReader::new(output).lines() {
            let line = line?;
            if let Some((_, port)) = line.split_once("on port ")
                && line.contains("success")
            {
                let port: u16 = port.trim_end_matches('.').parse()?;
                let url = format!("http://127.0.0.1:{port}");
                return Ok(Self { process, url });
            }
        }
        anyhow::bail!("{program} names no port")
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A window of a browser.
pub(crate) struct Browser {
    session: String,
}

impl Browser {
    pub(crate) fn open(
        driver: &Driver,
        program: &str,
        (width, height): (u32, u32),
    ) -> anyhow::Result<Self> {
        let arguments = [
            "--headless=new",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--no-sandbox",
            "--disable-dev-shm-usage",
            "--hide-scrollbars",
            &format!("--window-size={width},{height}"),
        ];
        let wanted = json!({"capabilities": {"alwaysMatch": {
            "goog:chromeOptions": {"binary": program, "args": arguments},
            "goog:loggingPrefs": {"browser": "ALL"},
        }}});
        let opened = post(&format!("{}/session", driver.url), &wanted)?;
        let id = opened["sessionId"].as_str().context("a session")?;
        let session = format!("{}/session/{id}", driver.url);
        Ok(Self { session })
    }

    pub(crate) fn post(&self, path: &str, body: &Value) -> anyhow::Result<Value> {
        post(&format!("{}/{path}", self.session), body)
    }

    pub(crate) fn go(&self, url: &str) -> anyhow::Result<()> {
        self.post("url", &json!({"url": url})).map(drop)
    }

    pub(crate) fn run(&self, script: &str) -> anyhow::Result<Value> {
        self.post("execute/sync", &json!({"script": script, "args": []}))
    }

    /// Returns the page's displayed state.
    pub(crate) fn state(&self) -> anyhow::Result<Value> {
        self.run("return window.__state ? window.__state() : {}")
    }

    /// True if the element with this `id` has this text.
    pub(crate) fn shows(&self, id: &str, text: &str) -> anyhow::Result<bool> {
        let all = self.run(&format!(
            "return document.getElementById({id:?}).textContent"
        ))?;
        Ok(all.as_str().is_some_and(|all| all.contains(text)))
    }

    /// Returns the position of an element's centre on the page.
    pub(crate) fn find(&self, selector: &str) -> anyhow::Result<(f64, f64)> {
        let middle = self.run(&format!(
            "const it = document.querySelector({selector:?}); it.scrollIntoView({{block: 'center'}}); \
             const box = it.getBoundingClientRect(); \
             return [box.left + box.width / 2, box.top + box.height / 2]"
        ))?;
        point(&middle)
    }

    pub(crate) fn click(&self, selector: &str) -> anyhow::Result<()> {
        let at = self.find(selector)?;
        self.pointer(&[move_to(at), down()])?;
        self.pointer(&[up()])
    }

    /// Performs pointer actions.
    pub(crate) fn pointer(&self, actions: &[Value]) -> anyhow::Result<()> {
        self.act(json!({"type": "pointer", "id": "pointer", "actions": actions}))
    }

    /// Presses or releases a key.
    pub(crate) fn key(&self, kind: &str, key: &str) -> anyhow::Result<()> {
        let action = json!({"type": kind, "value": key});
        self.act(json!({"type": "key", "id": "keys", "actions": [action]}))
    }

    fn act(&self, source: Value) -> anyhow::Result<()> {
        self.post("actions", &json!({"actions": [source]}))
            .map(drop)
    }

    /// Returns a screenshot of the window, as a PNG.
    pub(crate) fn shot(&self) -> anyhow::Result<Vec<u8>> {
        let url = format!("{}/screenshot", self.session);
        let answer: Value = ureq::get(&url).call()?.body_mut().read_json()?;
        let encoded = answer["value"].as_str().context("a picture")?;
        Ok(BASE64_STANDARD.decode(encoded)?)
    }

    pub(crate) fn picture(&self, path: &Path) -> anyhow::Result<()> {
        Ok(std::fs::write(path, self.shot()?)?)
    }

    /// Discards the messages that the page has logged so far.
    pub(crate) fn forget_console(&self) -> anyhow::Result<()> {
        self.post("se/log", &json!({"type": "browser"})).map(drop)
    }

    /// Fails if the page has logged an error.
    pub(crate) fn check_console(&self) -> anyhow::Result<()> {
        let lines = self.post("se/log", &json!({"type": "browser"}))?;
        let lines = lines.as_array().context("lines")?;
        let severe: Vec<_> = lines.iter().filter(|it| it["level"] == "SEVERE").collect();
        ensure!(severe.is_empty(), "the page has errors: {severe:?}");
        Ok(())
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Otherwise its driver ends it.
        let _ = ureq::delete(&self.session).call();
    }
}

pub(crate) fn move_to((x, y): (f64, f64)) -> Value {
    let (x, y) = (x.round() as i64, y.round() as i64);
    json!({"type": "pointerMove", "duration": 0, "x": x, "y": y})
}

pub(crate) fn down() -> Value {
    json!({"type": "pointerDown", "button": 0})
}

pub(crate) fn up() -> Value {
    json!({"type": "pointerUp", "button": 0})
}

pub(crate) fn point(value: &Value) -> anyhow::Result<(f64, f64)> {
    let x = value[0].as_f64().context("a point")?;
    let y = value[1].as_f64().context("a point")?;
    Ok((x, y))
}

fn post(url: &str, body: &Value) -> anyhow::Result<Value> {
    let agent: ureq::Agent = ureq::Agent::config_builder()
        .http_status_as_error(false)
        .build()
        .into();
    let mut answer = agent.post(url).send_json(body)?;
    let mut answer: Value = answer.body_mut().read_json()?;
    let value = answer["value"].take();
    ensure!(value.get("error").is_none(), "{url}: {value}");
    Ok(value)
}
