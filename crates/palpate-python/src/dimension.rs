//! The plane and space behind one class of Python each.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use palpate::{
    AmbiguityTree, Contact, Dimension, Error, Hypothesis, Miss, Outcome, Path, Plan, Recognition, Touch,
    plane, space,
};

/// Something of the plane, or its like in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum In<P, S> {
    Plane(P),
    Space(S),
}

/// The same of either: `either!(given, name => expression)`.
macro_rules! either {
    ($given:expr, $one:pat => $then:expr) => {
        match $given {
            $crate::dimension::In::Plane($one) => $then,
            $crate::dimension::In::Space($one) => $then,
        }
    };
}

/// The like of each: what the expression makes of it.
macro_rules! likewise {
    ($given:expr, $one:pat => $then:expr) => {
        match $given {
            $crate::dimension::In::Plane($one) => $crate::dimension::In::Plane($then),
            $crate::dimension::In::Space($one) => $crate::dimension::In::Space($then),
        }
    };
}

pub(crate) type AnyModel = In<Arc<plane::Model>, Arc<space::Model>>;
pub(crate) type AnyContact = In<Contact<DVec2>, Contact<DVec3>>;
pub(crate) type AnyMiss = In<Miss<DVec2>, Miss<DVec3>>;
pub(crate) type AnyPrior = In<palpate::Prior, space::Prior>;
pub(crate) type AnyHypothesis = In<Hypothesis<DVec2>, Hypothesis<DVec3>>;
pub(crate) type AnyRecognition = In<Recognition<DVec2>, Recognition<DVec3>>;
pub(crate) type AnyHypotheses = In<Vec<Hypothesis<DVec2>>, Vec<Hypothesis<DVec3>>>;
pub(crate) type AnyPlan = In<Plan<DVec2>, Plan<DVec3>>;
pub(crate) type AnyPath = In<Path<DVec2>, Path<DVec3>>;
pub(crate) type AnyOutcome = In<Outcome<DVec2>, Outcome<DVec3>>;
pub(crate) type AnyTouch = In<Touch<DVec2>, Touch<DVec3>>;
pub(crate) type AnyTree = In<AmbiguityTree<DVec2>, AmbiguityTree<DVec3>>;

impl<P, S> In<P, S> {
    pub fn dimension(&self) -> usize {
        match self {
            Self::Plane(_) => DVec2::DIMENSION,
            Self::Space(_) => DVec3::DIMENSION,
        }
    }
}

/// Which of the two a dimension is.
pub(crate) trait Side<P, S> {
    type One;

    /// `None` if it is the other.
    fn of(given: &In<P, S>) -> Option<&Self::One>;
    fn within(one: Self::One) -> In<P, S>;
}

impl<P, S> Side<P, S> for DVec2 {
    type One = P;

    fn of(given: &In<P, S>) -> Option<&P> {
        if let In::Plane(one) = given { Some(one) } else { None }
    }

    fn within(one: P) -> In<P, S> {
        In::Plane(one)
    }
}

impl<P, S> Side<P, S> for DVec3 {
    type One = S;

    fn of(given: &In<P, S>) -> Option<&S> {
        if let In::Space(one) = given { Some(one) } else { None }
    }

    fn within(one: S) -> In<P, S> {
        In::Space(one)
    }
}

/// Vectors, as rows of an array.
pub(crate) trait Vector:
    Dimension<Pose: Motion>
    + Side<Arc<plane::Model>, Arc<space::Model>, One = Arc<Self::Model>>
    + Side<Contact<DVec2>, Contact<DVec3>, One = Contact<Self>>
    + Side<Miss<DVec2>, Miss<DVec3>, One = Miss<Self>>
    + Side<palpate::Prior, space::Prior, One = Self::Prior>
    + Side<Hypothesis<DVec2>, Hypothesis<DVec3>, One = Hypothesis<Self>>
    + Side<Recognition<DVec2>, Recognition<DVec3>, One = Recognition<Self>>
    + Side<Plan<DVec2>, Plan<DVec3>, One = Plan<Self>>
    + Side<Path<DVec2>, Path<DVec3>, One = Path<Self>>
    + Side<Outcome<DVec2>, Outcome<DVec3>, One = Outcome<Self>>
    + Side<Touch<DVec2>, Touch<DVec3>, One = Touch<Self>>
    + Side<AmbiguityTree<DVec2>, AmbiguityTree<DVec3>, One = AmbiguityTree<Self>>
{
    /// How many coordinates.
    const DIMENSION: usize;
    /// The other one, as one speaks of it.
    const OTHER: &'static str;

    /// From as many numbers.
    fn from_coordinates(coordinates: &[f64]) -> Self;
}

impl Vector for DVec2 {
    const DIMENSION: usize = 2;
    const OTHER: &'static str = DVec3::NAME;

    fn from_coordinates(coordinates: &[f64]) -> Self {
        Self::from_slice(coordinates)
    }
}

impl Vector for DVec3 {
    const DIMENSION: usize = 3;
    const OTHER: &'static str = DVec2::NAME;

    fn from_coordinates(coordinates: &[f64]) -> Self {
        Self::from_slice(coordinates)
    }
}

/// Rigid motions, as homogeneous matrices.
pub(crate) trait Motion: Copy {
    type Vector: Vector;

    /// From the numbers of a matrix, row by row, as many as it has.
    fn from_numbers(argument: &str, numbers: &[f64]) -> Result<Self, Error>;
    /// The same of what was a motion before: no number changes.
    fn restored(numbers: &[f64]) -> Self;
    /// Row by row.
    fn numbers(self) -> Vec<f64>;
    fn translation(self) -> Self::Vector;
    /// Of its rotation, radians.
    fn angle(self) -> f64;
}

/// The numbers of a matrix as its rows.
fn rows<const SIDE: usize>(numbers: &[f64]) -> [[f64; SIDE]; SIDE] {
    std::array::from_fn(|i| std::array::from_fn(|j| numbers[SIDE * i + j]))
}

impl Motion for plane::Pose {
    type Vector = DVec2;

    fn from_numbers(argument: &str, numbers: &[f64]) -> Result<Self, Error> {
        Self::from_rows(argument, rows(numbers))
    }

    fn restored(numbers: &[f64]) -> Self {
        let [[cosine, _, x], [sine, _, y], _] = rows(numbers);
        Self { rotation: DVec2::new(cosine, sine), translation: DVec2::new(x, y) }
    }

    fn numbers(self) -> Vec<f64> {
        self.to_rows().as_flattened().to_vec()
    }

    fn translation(self) -> DVec2 {
        self.translation
    }

    fn angle(self) -> f64 {
        self.angle()
    }
}

impl Motion for space::Pose {
    type Vector = DVec3;

    fn from_numbers(argument: &str, numbers: &[f64]) -> Result<Self, Error> {
        Self::from_rows(argument, rows(numbers))
    }

    fn restored(numbers: &[f64]) -> Self {
        let rows: [[f64; 4]; 4] = rows(numbers);
        let column = |k: usize| DVec3::new(rows[0][k], rows[1][k], rows[2][k]);
        let rotation = glam::DMat3::from_cols(column(0), column(1), column(2));
        Self { rotation, translation: column(3) }
    }

    fn numbers(self) -> Vec<f64> {
        self.to_rows().as_flattened().to_vec()
    }

    fn translation(self) -> DVec3 {
        self.translation
    }

    fn angle(self) -> f64 {
        self.angle()
    }
}
