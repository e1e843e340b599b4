//! What can be wrong with an input, said so that it can be mended.

use std::fmt::Display;

/// Bad input. Names the argument, its value and the remedy, in one line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{argument}: {problem} (got {value}); {remedy}")]
pub struct Error {
    /// The argument at fault, as the caller names it.
    pub argument: String,
    /// What is wrong with it.
    pub problem: String,
    /// The value that was given.
    pub value: String,
    /// What to do about it.
    pub remedy: String,
}

impl Error {
    /// An error about `argument`, which had `value`.
    pub fn new(
        argument: impl Into<String>,
        problem: impl Into<String>,
        value: impl Display,
        remedy: impl Into<String>,
    ) -> Self {
        Self {
            argument: argument.into(),
            problem: problem.into(),
            value: value.to_string(),
            remedy: remedy.into(),
        }
    }
}
