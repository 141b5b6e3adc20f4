//! Why a model library cannot be loaded.

use std::string::String;

/// Why a model library cannot be used. The texts are those of libfranka 0.9.
///
/// One of its texts has no place here: a library that is loaded already cannot be loaded once more,
/// since each is a value of its own.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LibraryError {
    /// Host: there is no library for this processor.
    #[error("libfranka: Unsupported architecture!")]
    Architecture,
    /// Host: there is no library for this operating system.
    #[error("libfranka: Unsupported operating system!")]
    System,
    /// Host: the library cannot be written to a temporary file.
    #[error("libfranka: Cannot save model library.")]
    Save(#[source] std::io::Error),
    /// Robot, or link: the bytes are not a library that this system can load.
    #[error("libfranka: Cannot load model library: {reason}")]
    Load {
        /// What the system's loader says.
        reason: String,
    },
    /// Host: the loader itself failed.
    #[error("libfranka: Error while loading library: {reason}")]
    Loader {
        /// What the system's loader says.
        reason: String,
    },
    /// Robot: the library lacks a function.
    #[error("libfranka: Symbol cannot be found: {reason}")]
    Symbol {
        /// What the system's loader says; the name is in it.
        reason: String,
    },
    /// Host: the loader failed while functions were looked up.
    #[error("libfranka: Error while fetching symbols: {reason}")]
    Symbols {
        /// What the system's loader says.
        reason: String,
    },
}
