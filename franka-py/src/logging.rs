//! Events of `tracing` for Python's `logging`.
//!
//! ```text
//!  any thread: event --> bounded queue --> thread "franka-logging" --> interpreter --> logging
//! ```
//!
//! No thread of the driver waits for the interpreter: if the queue is full, an event is dropped and
//! counted.

use std::fmt;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::SystemTime;

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::layer::{Context, Layer, SubscriberExt};
use tracing_subscriber::registry::LookupSpan;

use crate::exit;

/// Forwards the reports of the driver and the simulator to Python's `logging` from now on, to
/// loggers below `franka_async`, such as `franka_async.bridge`.
/// `logging.getLogger("franka_async").setLevel(...)` and handlers filter them as usual. Off by
/// default: without this call, nothing is forwarded.
///
/// Reports below `level` are not created: `trace`, `debug`, `info`, `warning` or `error`, in any
/// case, or a number of `logging`; a later call changes it. The message and the record's `fields`,
/// a `dict`, contain the data of an event and of the spans around it; `record.rust_target` is the
/// module. `trace` is the number 5.
///
/// A separate thread forwards them, so no motion waits for it. If more than `queue` reports wait
/// (the value of the first call), new reports are dropped; a later warning contains the number of
/// dropped reports.
///
/// Raises `ValueError` for another level, and `RuntimeError` if another library in the process
/// already receives Rust's reports.
#[pyfunction]
#[pyo3(signature = (level = None, *, queue = 4096))]
pub(crate) fn enable_logging(level: Option<&Bound<'_, PyAny>>, queue: usize) -> PyResult<()> {
    let level = level.map_or(Ok(INFO), number_of)?;
    LEAST.store(level, Ordering::Relaxed);
    static ENABLED: OnceLock<Result<(), String>> = OnceLock::new();
    let enabled = ENABLED.get_or_init(|| {
        let (sender, receiver) = sync_channel(queue);
        let subscriber = tracing_subscriber::registry().with(Bridge(sender));
        tracing::subscriber::set_global_default(subscriber).map_err(|error| error.to_string())?;
        std::thread::Builder::new()
            .name("franka-logging".into())
            .spawn(move || hand_on(&receiver))
            .map(drop)
            .map_err(|error| error.to_string())
    });
    // Makes call sites check their level again.
    tracing::callsite::rebuild_interest_cache();
    enabled.clone().map_err(PyRuntimeError::new_err)
}

/// Returns the level as a number of `logging`.
fn number_of(level: &Bound<'_, PyAny>) -> PyResult<u8> {
    if let Ok(number) = level.extract::<u8>() {
        return Ok(number);
    }
    let name: String = level.extract()?;
    match name.to_ascii_lowercase().as_str() {
        "trace" => Ok(TRACE),
        "debug" => Ok(DEBUG),
        "info" => Ok(INFO),
        "warning" | "warn" => Ok(WARNING),
        "error" => Ok(ERROR),
        _ => {
            let expected = "'trace', 'debug', 'info', 'warning', 'error' or a number from 0 to 255";
            let text = format!("level is {name:?}, expected {expected}");
            Err(PyValueError::new_err(text))
        }
    }
}

/// An event in the queue.
struct Report {
    time: SystemTime,
    level: u8,
    target: &'static str,
    fields: Fields,
    /// Reports that were dropped before this one.
    dropped: u64,
}

/// The data of an event or a span, the outermost first.
#[derive(Clone, Default)]
struct Fields {
    message: String,
    values: Vec<(&'static str, Value)>,
}

#[derive(Clone)]
enum Value {
    Float(f64),
    Int(i64),
    Unsigned(u64),
    Bool(bool),
    Text(String),
}

impl Visit for Fields {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        let text = format!("{value:?}");
        match field.name() {
            "message" => self.message = text,
            name => self.values.push((name, Value::Text(text))),
        }
    }

    fn record_str(&mut self, field: &Field, value: &str) {
        match field.name() {
            "message" => self.message = value.into(),
            name => self.values.push((name, Value::Text(value.into()))),
        }
    }

    fn record_f64(&mut self, field: &Field, value: f64) {
        self.values.push((field.name(), Value::Float(value)));
    }

    fn record_i64(&mut self, field: &Field, value: i64) {
        self.values.push((field.name(), Value::Int(value)));
    }

    fn record_u64(&mut self, field: &Field, value: u64) {
        self.values.push((field.name(), Value::Unsigned(value)));
    }

    fn record_bool(&mut self, field: &Field, value: bool) {
        self.values.push((field.name(), Value::Bool(value)));
    }
}

/// Puts events into the queue.
struct Bridge(SyncSender<Report>);

impl<S: Subscriber + for<'a> LookupSpan<'a>> Layer<S> for Bridge {
    fn enabled(&self, metadata: &tracing::Metadata<'_>, _: Context<'_, S>) -> bool {
        // Spans of all levels are kept, because events within them use their names.
        metadata.target().starts_with("franka")
            && (metadata.is_span() || number(*metadata.level()) >= LEAST.load(Ordering::Relaxed))
    }

    fn on_new_span(&self, attributes: &Attributes<'_>, id: &Id, context: Context<'_, S>) {
        if let Some(span) = context.span(id) {
            let mut fields = Fields::default();
            attributes.record(&mut fields);
            span.extensions_mut().insert(fields);
        }
    }

    fn on_record(&self, id: &Id, values: &Record<'_>, context: Context<'_, S>) {
        if let Some(span) = context.span(id)
            && let Some(fields) = span.extensions_mut().get_mut::<Fields>()
        {
            values.record(fields);
        }
    }

    fn on_event(&self, event: &Event<'_>, context: Context<'_, S>) {
        let mut fields = Fields::default();
        for span in context
            .event_scope(event)
            .into_iter()
            .flat_map(|it| it.from_root())
        {
            if let Some(of_span) = span.extensions().get::<Fields>() {
                fields.values.extend(of_span.values.iter().cloned());
            }
        }
        event.record(&mut fields);
        let metadata = event.metadata();
        let report = Report {
            time: SystemTime::now(),
            level: number(*metadata.level()),
            target: metadata.target(),
            fields,
            dropped: DROPPED.swap(0, Ordering::Relaxed),
        };
        if let Err(full) = self.0.try_send(report) {
            let (std::sync::mpsc::TrySendError::Full(report)
            | std::sync::mpsc::TrySendError::Disconnected(report)) = full;
            DROPPED.fetch_add(report.dropped + 1, Ordering::Relaxed);
        }
    }
}

/// Forwards events to `logging` until the interpreter exits.
fn hand_on(reports: &Receiver<Report>) {
    while let Ok(report) = reports.recv() {
        let logged = exit::in_python(|py| {
            if let Err(error) = log(py, &report) {
                error.write_unraisable(py, None);
            }
        });
        if logged.is_none() {
            return;
        }
    }
}

fn log(py: Python<'_>, report: &Report) -> PyResult<()> {
    let logging = py.import("logging")?;
    // `franka_async::bridge` is `franka_async.bridge`; the other crates are below it as well.
    let path = report.target.replace("::", ".");
    let name = match path.strip_prefix("franka_async") {
        Some(_) => path,
        None => format!("franka_async.{path}"),
    };
    let logger = logging.call_method1("getLogger", (name.as_str(),))?;
    if report.dropped > 0 {
        let text = format!(
            "{} log messages were dropped: they arrived faster than Python could handle them",
            report.dropped
        );
        logger.call_method1("warning", (text,))?;
    }
    if !logger
        .call_method1("isEnabledFor", (report.level,))?
        .is_truthy()?
    {
        return Ok(());
    }
    let fields = PyDict::new(py);
    let mut message = report.fields.message.clone();
    for (name, value) in &report.fields.values {
        match value {
            Value::Float(value) => fields.set_item(name, value)?,
            Value::Int(value) => fields.set_item(name, value)?,
            Value::Unsigned(value) => fields.set_item(name, value)?,
            Value::Bool(value) => fields.set_item(name, value)?,
            Value::Text(value) => fields.set_item(name, value)?,
        }
    }
    for (name, value) in fields.iter() {
        message.push_str(&format!(" {name}={value}"));
    }
    let extra = PyDict::new(py);
    extra.set_item("fields", fields)?;
    extra.set_item("rust_target", report.target)?;
    // No arguments, so that a per cent sign of the message is kept.
    let arguments = (
        name.as_str(),
        report.level,
        "(rust)",
        0,
        message,
        (),
        py.None(),
    );
    let named = PyDict::new(py);
    named.set_item("extra", extra)?;
    let record = logger.call_method("makeRecord", arguments, Some(&named))?;
    if let Ok(since) = report.time.duration_since(SystemTime::UNIX_EPOCH) {
        record.setattr("created", since.as_secs_f64())?;
        record.setattr("msecs", f64::from(since.subsec_millis()))?;
    }
    logger.call_method1("handle", (record,))?;
    Ok(())
}

/// Returns the number of a level in `logging`.
fn number(level: Level) -> u8 {
    match level {
        Level::TRACE => TRACE,
        Level::DEBUG => DEBUG,
        Level::INFO => INFO,
        Level::WARN => WARNING,
        Level::ERROR => ERROR,
    }
}

const TRACE: u8 = 5;
const DEBUG: u8 = 10;
const INFO: u8 = 20;
const WARNING: u8 = 30;
const ERROR: u8 = 40;

/// Number of the lowest level that is forwarded.
static LEAST: AtomicU8 = AtomicU8::new(INFO);

/// Number of reports dropped since the last forwarded one.
static DROPPED: AtomicU64 = AtomicU64::new(0);
