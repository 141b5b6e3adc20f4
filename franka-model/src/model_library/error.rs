//! Errors of loading a model library.

use std::string::String;

/// Reason why a model library cannot be used. The texts of the variants come from libfranka 0.9.
///
/// libfranka also has a text for a library that is already loaded. This crate does not need that
/// text, because each library is a separate value.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LibraryError {
    /// Host: no library exists for this processor.
    #[error("libfranka: Unsupported architecture!")]
    Architecture,
    /// Host: no library exists for this operating system.
    #[error("libfranka: Unsupported operating system!")]
    System,
    /// Host: the library cannot be written to a temporary file.
    #[error("libfranka: Cannot save model library.")]
    Save(#[source] std::io::Error),
    /// Robot, or link: the bytes are not a library that this system can load.
    #[error("libfranka: Cannot load model library: {reason}")]
    Load {
        /// Message of the system's loader.
        reason: String,
    },
    /// Host: the loader itself failed.
    #[error("libfranka: Error while loading library: {reason}")]
    Loader {
        /// Message of the system's loader.
        reason: String,
    },
    /// Robot: the library lacks a function.
    #[error("libfranka: Symbol cannot be found: {reason}")]
    Symbol {
        /// Message of the system's loader, which contains the name.
        reason: String,
    },
    /// Host: the loader failed while looking up functions.
    #[error("libfranka: Error while fetching symbols: {reason}")]
    Symbols {
        /// Message of the system's loader.
        reason: String,
    },
}
