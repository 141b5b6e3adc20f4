//! Options of recordings: keyword arguments.

use std::collections::BTreeMap;
use std::path::PathBuf;

use franka_async::recording::{Attachment, BlackBox, RecordOptions, Rotation};
use pyo3::prelude::*;

use crate::operation::seconds;
use crate::options::Keywords;

/// Reads the options of `Recorder.to_file`.
///
/// # Errors
/// `TypeError`, `ValueError`; ranges are checked when the recording begins.
pub(super) fn of_file(py: Python<'_>, keywords: &mut Keywords<'_>) -> PyResult<RecordOptions> {
    let default = RecordOptions::default();
    let mut time = |name| {
        let time = keywords.value::<f64>(name)?;
        time.map(|time| seconds(name, time)).transpose()
    };
    let flush = time("flush")?.unwrap_or(default.flush);
    let rotation = Rotation {
        time: time("rotate_time")?,
        bytes: keywords.value("rotate_bytes")?,
    };
    let attached: Option<BTreeMap<String, Vec<u8>>> = keywords.value("attachments")?;
    let mut attachments = Vec::new();
    for (name, data) in attached.unwrap_or_default() {
        let media_type = media_type(py, &name)?;
        attachments.push(Attachment {
            name,
            media_type,
            data,
        });
    }
    let black_box: Option<BlackBoxFields> = keywords.value("black_box")?;
    let black_box = black_box.map(|fields| {
        let BlackBoxFields {
            directory,
            before,
            after,
            keep,
        } = fields;
        self::black_box(directory, before, after, keep)
    });
    Ok(RecordOptions {
        thinned: keywords.value("thinned")?.unwrap_or(default.thinned),
        flush,
        sync: keywords.value("sync")?.unwrap_or(default.sync),
        rotation,
        metadata: keywords.value("metadata")?.unwrap_or_default(),
        attachments,
        black_box: black_box.transpose()?,
    })
}

/// `franka_async.recording.BlackBox`.
#[derive(FromPyObject)]
struct BlackBoxFields {
    directory: PathBuf,
    before: f64,
    after: f64,
    keep: usize,
}

/// Creates a black box with these seconds and files.
///
/// # Errors
/// `ValueError` for invalid times; ranges are checked when the recording begins.
pub(super) fn black_box(
    directory: PathBuf,
    before: f64,
    after: f64,
    keep: usize,
) -> PyResult<BlackBox> {
    Ok(BlackBox {
        directory,
        before: seconds("before", before)?,
        after: seconds("after", after)?,
        keep,
    })
}

/// Returns the media type for the name of a file.
fn media_type(py: Python<'_>, name: &str) -> PyResult<String> {
    let guessed = py
        .import("mimetypes")?
        .call_method1("guess_type", (name,))?;
    let (media_type, _): (Option<String>, Option<String>) = guessed.extract()?;
    Ok(media_type.unwrap_or_else(|| "application/octet-stream".to_owned()))
}
