//! Planners propose lines; the judge says what they are worth.

mod polish;
mod rendering;
mod sweep;

use glam::DVec3;

use crate::best::Best;
use crate::plan::PlanSettings;

/// Offers lines to `best`, as the settings say.
pub(super) fn propose(best: &mut Best<'_, DVec3>, settings: &PlanSettings<DVec3>, late: &dyn Fn() -> bool) {
    sweep::sweep(best, settings, late);
}
