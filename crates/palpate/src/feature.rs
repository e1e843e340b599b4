//! Features of a model, by which contacts are explained.

/// What a contact may lie on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Feature {
    /// A face, by its number.
    Face(u32),
    /// An edge, by its number; only in space.
    Edge(u32),
    /// A vertex, by its number.
    Vertex(u32),
}

impl Feature {
    /// `"face"`, `"edge"` or `"vertex"`.
    #[must_use]
    pub fn kind(self) -> &'static str {
        match self {
            Self::Face(_) => "face",
            Self::Edge(_) => "edge",
            Self::Vertex(_) => "vertex",
        }
    }

    /// Its number among the features of its kind.
    #[must_use]
    pub fn number(self) -> u32 {
        match self {
            Self::Face(number) | Self::Edge(number) | Self::Vertex(number) => number,
        }
    }
}
