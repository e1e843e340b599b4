//! Planners, by their names.

use crate::Error;
use crate::dimension::Dimension;

/// Where candidate paths come from. Some are of the plane only, some of space only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Planner {
    /// The most promising of many lines: in the plane in evenly spaced directions, then, where these tell nothing, as
    /// `grimson` and `complete`; in space drawn at faces and all around, and of all other planners.
    #[default]
    Auto,
    /// In the plane, all lines, by branch and bound: no usable path of margin ≥ m is better.
    Complete,
    /// In the plane, the thesis's own search: lines through generators, at critical slopes (3.1 to 3.3, 4.1).
    Ellis,
    /// In space, the thesis's optimization (5.1, 5.2).
    Optimized,
    /// In space, the thesis's linearization (5.3).
    Linearized,
    /// In space, the thesis's decoupling into two problems of the plane (5.4.4).
    Decoupled,
    /// Grimson's: renderings in fixed directions, searched by divide and conquer (5.4.2).
    Grimson {
        /// Buckets of each rendering; in space, along each of its sides.
        cells: usize,
        /// Directions, evenly spaced.
        directions: usize,
    },
    /// Schneiter's: from the boundary of the union to that of the intersection, past blocking boundaries (5.4.3).
    Schneiter {
        /// Cells along each side of the grid.
        cells: usize,
    },
}

/// Grids of the planners that have one: the usual number, and the most that fits into memory.
#[derive(Debug, Clone, Copy)]
pub struct Grids {
    /// Cells of a rendering, along a side.
    pub grimson_cells: [usize; 2],
    /// Directions of renderings.
    pub grimson_directions: [usize; 2],
    /// Cells along a side.
    pub schneiter_cells: [usize; 2],
}

impl Planner {
    /// Grimson's, with the plane's usual grid.
    pub const GRIMSON: Self = Self::Grimson { cells: Self::USUAL_GRID[0], directions: Self::USUAL_GRID[1] };

    /// Cells and directions in the plane.
    pub(crate) const USUAL_GRID: [usize; 2] = [256, 72];

    /// Schneiter's, with the plane's usual grid.
    pub const SCHNEITER: Self = Self::Schneiter { cells: 256 };

    /// That of a name, of the plane or of space, with the usual grid of `V`.
    #[must_use]
    pub fn named<V: Dimension>(name: &str) -> Option<Self> {
        let Grids { grimson_cells: [cells, _], grimson_directions: [directions, _], .. } = V::GRIDS;
        let all = [
            Self::Auto,
            Self::Complete,
            Self::Ellis,
            Self::Optimized,
            Self::Linearized,
            Self::Decoupled,
            Self::Grimson { cells, directions },
            Self::Schneiter { cells: V::GRIDS.schneiter_cells[0] },
        ];
        all.into_iter().find(|one| one.name() == name)
    }

    /// Its name: `"auto"`, say.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Complete => "complete",
            Self::Ellis => "ellis",
            Self::Optimized => "optimized",
            Self::Linearized => "linearized",
            Self::Decoupled => "decoupled",
            Self::Grimson { .. } => "grimson",
            Self::Schneiter { .. } => "schneiter",
        }
    }

    /// Whether the plane has it, or space.
    #[must_use]
    pub fn exists_in<V: Dimension>(self) -> bool {
        V::PLANNERS.contains(&self.name())
    }

    /// Which ones there are, said to whom asks for another.
    #[must_use]
    pub fn remedy<V: Dimension>() -> String {
        let names: Vec<String> = V::PLANNERS.iter().map(|name| format!("\"{name}\"")).collect();
        match names.as_slice() {
            [others @ .., last] if !others.is_empty() => format!("give {} or {last}", others.join(", ")),
            names => format!("give {}", names.concat()),
        }
    }

    /// It is to exist; a grid is to have enough cells to show a part, and few enough to fit into memory.
    pub(crate) fn check<V: Dimension>(self) -> Result<(), Error> {
        if !self.exists_in::<V>() {
            let problem = format!("there is no such planner in {}", V::NAME);
            return Err(Error::new("planner", problem, format!("'{}'", self.name()), Self::remedy::<V>()));
        }
        let within = |argument: &str, value: usize, low: usize, [_, high]: [usize; 2]| {
            if (low..=high).contains(&value) {
                return Ok(());
            }
            let problem = format!("must be from {low} to {high}");
            Err(Error::new(argument, problem, value, "leave it out for the usual grid"))
        };
        match self {
            Self::Grimson { cells, directions } => {
                within("cells", cells, 8, V::GRIDS.grimson_cells)?;
                within("directions_tried", directions, 1, V::GRIDS.grimson_directions)
            }
            Self::Schneiter { cells } => within("cells", cells, 8, V::GRIDS.schneiter_cells),
            _ => Ok(()),
        }
    }
}
