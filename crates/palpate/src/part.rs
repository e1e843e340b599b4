//! What models of the plane and of space have in common.

use std::f64::consts::FRAC_PI_2;

use crate::Error;

/// What a face is to a probe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surface {
    /// Can be touched.
    Touchable,
    /// In the way of a path, but never the answer to a touch.
    Untouchable,
    /// Not there: a seam between two pieces of one part.
    Seam,
}

/// Something that was mended when a model was read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mend(pub String);

/// A name that says something.
pub(crate) fn checked_name(name: String) -> Result<String, Error> {
    if name.trim().is_empty() {
        let value = format!("{name:?}");
        return Err(Error::new(
            "name",
            "must not be empty",
            value,
            "give the part a name, such as \"bracket\"",
        ));
    }
    Ok(name)
}

/// Slacks that are bounds.
pub(crate) fn check_slacks(position_slack: f64, normal_slack: f64) -> Result<(), Error> {
    if !(position_slack.is_finite() && position_slack >= 0.0) {
        let problem = "must be a finite length, zero or more";
        return Err(Error::new("position_slack", problem, position_slack, "give 0 for an exact outline"));
    }
    if !(0.0..FRAC_PI_2).contains(&normal_slack) {
        let problem = "must be an angle in radians, at least 0 and less than π/2";
        return Err(Error::new("normal_slack", problem, normal_slack, "give 0 for an exact outline"));
    }
    Ok(())
}

/// Gives the numbered faces their surface.
pub(crate) fn mark(
    surfaces: &mut [Surface],
    argument: &str,
    numbers: &[usize],
    surface: Surface,
) -> Result<(), Error> {
    for &number in numbers {
        let count = surfaces.len();
        let Some(entry) = surfaces.get_mut(number) else {
            let problem = format!("there is no face of this number among {count}");
            return Err(Error::new(argument, problem, number, "number the faces as given, from 0"));
        };
        if *entry != Surface::Touchable && *entry != surface {
            let problem = "a face can't be both a seam and untouchable";
            return Err(Error::new(argument, problem, number, "name it in one of the two lists"));
        }
        *entry = surface;
    }
    Ok(())
}
