//! Planners propose lines; the judge says what they are worth.

mod blocking;
mod complete;
mod ellis;
mod grimson;
mod schneiter;
mod sweep;

pub use ellis::EllisCounters;

pub(crate) use complete::{Proof, complete};
pub(crate) use ellis::ellis;
pub(crate) use grimson::grimson;
pub(crate) use schneiter::schneiter;
pub(crate) use sweep::sweep;
