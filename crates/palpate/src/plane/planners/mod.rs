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

pub(crate) use ellis::Search;

use complete::complete;
use ellis::ellis;
use grimson::grimson;
use schneiter::schneiter;
use sweep::sweep;

use crate::best::Best;
use crate::plan::{PlanSettings, Planner};
use crate::scene::Proof;

/// Offers lines to `best`, as the planner of the settings chooses them.
pub(super) fn propose(
    best: &mut Best<'_>,
    settings: &PlanSettings,
    late: &dyn Fn() -> bool,
) -> (Proof, Option<EllisCounters>) {
    let (mut proof, mut counters) = (Proof::NONE, None);
    match settings.planner {
        Planner::Ellis => counters = Some(ellis(best, settings, late)),
        Planner::Grimson { cells, directions } => grimson(best, [cells, directions], settings, late),
        Planner::Schneiter { cells } => schneiter(best, cells, settings, late),
        // `Auto` and `Complete`: the settings were checked.
        _ => proof = swept(best, settings, late),
    }
    (proof, counters)
}

/// A sweep; where it tells nothing the usual rendering, and where that tells nothing, or everything is asked for, all lines.
fn swept(best: &mut Best<'_>, settings: &PlanSettings, late: &dyn Fn() -> bool) -> Proof {
    sweep(best, settings.stop, late);
    let tells = |best: &Best<'_>| best.num_left() < best.members.len().pow(2);
    if best.scene.one_part_at_one_pose(best.members) && best.path.is_some() {
        return Proof { bound: best.members.len() as f64, proved: true, num_boxes: 0 };
    }
    if settings.planner == Planner::Auto && !tells(best) {
        grimson(best, Planner::USUAL_GRID, settings, late);
    }
    if settings.planner == Planner::Complete || !tells(best) {
        return complete(best, settings, late);
    }
    Proof::NONE
}

/// The largest whole number up to a value; zero if there is none.
#[expect(clippy::cast_sign_loss, reason = "below zero it saturates at zero, as is meant")]
fn whole(value: f64) -> usize {
    value as usize
}
