//! Why a command ends early: one line for standard error and the exit status that goes with it.

use std::fmt::Display;
use std::path::Path;
use std::process::ExitCode;

/// A command's early end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    message: String,
    status: u8,
}

impl Failure {
    /// Wrong input, or a file that can't be read or written: exit status 1.
    pub fn new(message: impl Into<String>) -> Self {
        Failure { message: message.into(), status: 1 }
    }

    /// A wrong command line: exit status 2.
    pub fn usage(message: impl Display) -> Self {
        Failure { message: format!("error: {message}\n\nFor more information, try '--help'."), status: 2 }
    }

    /// A problem with `element` in this line of a file: `FILE:LINE: ELEMENT: PROBLEM`.
    pub fn in_line(path: &Path, line: usize, element: impl Display, problem: impl Display) -> Self {
        Self::new(format!("{}:{line}: {element}: {problem}", path.display()))
    }

    /// A problem with a file as a whole.
    pub fn in_file(path: &Path, problem: impl Display) -> Self {
        Self::new(format!("{}: {problem}", path.display()))
    }

    /// Standard output could not be written. A reader that went away (`| head`) is no failure.
    pub fn stdout(error: std::io::Error) -> Self {
        match error.kind() {
            std::io::ErrorKind::BrokenPipe => Failure { message: String::new(), status: 0 },
            _ => Self::new(format!("standard output: {error}")),
        }
    }

    /// Says why on standard error; the process's exit status.
    pub fn report(&self) -> ExitCode {
        if !self.message.is_empty() {
            eprintln!("{}", self.message);
        }
        ExitCode::from(self.status)
    }

    /// The line for standard error.
    pub fn message(&self) -> &str {
        &self.message
    }
}
