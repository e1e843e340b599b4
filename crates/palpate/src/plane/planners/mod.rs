//! Planners propose lines; the judge says what they are worth.

mod complete;
mod sweep;

pub(crate) use complete::{Proof, complete};
pub(crate) use sweep::sweep;
