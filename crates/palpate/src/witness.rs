//! What a search for a pose ends with.

use crate::recognize::Limit;

/// A pose that satisfies the conditions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Witness<P> {
    pub pose: P,
    /// It does so only with bounds enlarged by τ.
    pub marginal: bool,
    /// The search met this limit: it may not be one. What it stands for is kept, so that nothing true is lost.
    pub undecided: Option<Limit>,
}

impl<P> Witness<P> {
    /// What a search had when it met a limit.
    pub fn guess(pose: P, limit: Limit) -> Self {
        Self { pose, marginal: true, undecided: Some(limit) }
    }

    /// Whether it is known to be one.
    pub fn is_decided(&self) -> bool {
        self.undecided.is_none()
    }
}
