//! What a search for a pose ends with.

/// A pose that satisfies the conditions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Witness<P> {
    pub pose: P,
    /// It does so only with bounds enlarged by τ.
    pub marginal: bool,
    /// The search met its limit: it may not be one. What it stands for is kept, so that nothing true is lost.
    pub undecided: bool,
}

impl<P> Witness<P> {
    /// What a search had when it met its limit.
    pub fn guess(pose: P) -> Self {
        Self { pose, marginal: true, undecided: true }
    }
}
