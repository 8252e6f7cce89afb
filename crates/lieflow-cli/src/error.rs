//! Why a command failed.

use std::io;
use std::path::{Path, PathBuf};

use lieflow_model::scene::SceneError;

/// Why a command ended without doing its work: one message for stderr.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CliError {
    /// The scene cannot be used.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// An argument cannot be used.
    #[error(transparent)]
    Setup(#[from] lieflow::Error),
    /// A run stopped early.
    #[error(transparent)]
    Run(#[from] lieflow::RunError),
    /// A file cannot be read or written.
    #[error("cannot {doing} `{}`: {source}", path.display())]
    Io {
        /// What was tried, as "write".
        doing: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The disk has no room for the rest of a run.
    #[error("{0}")]
    Full(String),
    /// A run wrote as much as it may.
    #[error("{0}")]
    TooMuch(String),
    /// Standard output cannot be written.
    #[error("cannot write to standard output: {0}")]
    Stdout(io::Error),
    /// The program cannot listen to signals.
    #[error("cannot listen to signals: {0}")]
    Signals(io::Error),
    /// A run stopped, and can go on; or some of several failed.
    #[error("{message}")]
    Stopped {
        /// Why, what is kept, and how to go on.
        message: String,
        /// The exit code.
        code: u8,
    },
    /// Anything else, in words.
    #[error("{0}")]
    Message(String),
    /// The command did its work and what it checked does not hold.
    #[error("{0}")]
    Failed(String),
}

impl CliError {
    /// For `map_err` on what is done with a file.
    pub fn io(doing: &'static str, path: &Path) -> impl FnOnce(io::Error) -> CliError {
        move |source| CliError::Io { doing, path: path.into(), source }
    }

    /// The exit code.
    ///
    /// It is 1 if a check fails or if a file cannot or must not be written. It is 130 for a run that was interrupted.
    /// It is 2 for everything else.
    pub fn exit_code(&self) -> u8 {
        match self {
            CliError::Failed(_)
            | CliError::Io { .. }
            | CliError::Full(_)
            | CliError::TooMuch(_)
            | CliError::Stdout(_) => 1,
            CliError::Stopped { code, .. } => *code,
            _ => 2,
        }
    }
}
