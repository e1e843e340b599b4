//! Planners propose lines; the judge says what they are worth.

mod blocking;
mod complete;
mod ellis;
mod grimson;
mod schneiter;
mod sheaves;
mod sweep;
mod views;

pub use ellis::EllisCounters;
pub use sheaves::{CriticalPoint, Overlap, ProjectionSpace, Sheaf};

pub(crate) use complete::{Proof, complete};
pub(crate) use ellis::{Search, ellis};
pub(crate) use grimson::grimson;
pub(crate) use schneiter::schneiter;
pub(crate) use sweep::sweep;

/// The largest whole number up to a value; zero if there is none.
#[expect(clippy::cast_sign_loss, reason = "below zero it saturates at zero, as is meant")]
fn whole(value: f64) -> usize {
    value as usize
}
