//! Why a planner stopped where it did.

use crate::dimension::Dimension;
use crate::hypothesis::Hypothesis;
use crate::plan::{Plan, PlanSettings, Planner};

/// Why a plan is as it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Why {
    /// One hypothesis is left: there is nothing to tell apart.
    Solved,
    /// The path separates all.
    Perfect,
    /// The path is as good as `stop` asks for.
    Enough,
    /// Proved: no usable path of margin ≥ m has a better score.
    Best,
    /// Proved: no usable path of margin ≥ m is certain to tell anything.
    Inseparable,
    /// Proved: no path of margin ≥ m can be used.
    NoUsablePath,
    /// Time was up.
    Time,
    /// The search met the limit of its effort.
    Effort,
    /// The planner has looked at all that it looks at; what lies beyond was not searched.
    Searched,
}

impl Why {
    /// Its name: `"no_usable_path"`, say.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::Perfect => "perfect",
            Self::Enough => "enough",
            Self::Best => "best",
            Self::Inseparable => "inseparable",
            Self::NoUsablePath => "no_usable_path",
            Self::Time => "time",
            Self::Effort => "effort",
            Self::Searched => "searched",
        }
    }
}

impl<V: Dimension> Plan<V> {
    /// Why it is as it is, planned among the hypotheses; `late`: time was up.
    #[must_use]
    pub fn why(&self, hypotheses: &[Hypothesis<V>], settings: &PlanSettings<V>, late: bool) -> Why {
        let m = settings.margin * hypotheses.iter().map(|one| V::size(&one.model)).fold(0.0, f64::max);
        let work = match settings.planner {
            // Where there is a complete one, `Auto` ends with it.
            Planner::Auto if Planner::Complete.exists_in::<V>() => self.num_boxes,
            Planner::Complete => self.num_boxes,
            _ => self.num_judged,
        };
        match &self.path {
            _ if hypotheses.len() < 2 => Why::Solved,
            Some(path) if path.score <= 1.0 => Why::Perfect,
            Some(path) if self.proved && path.guaranteed() => Why::Best,
            Some(_) if self.proved => Why::Inseparable,
            None if self.proved => Why::NoUsablePath,
            Some(path) if path.enough(settings.stop, m) => Why::Enough,
            _ if late => Why::Time,
            _ if work >= settings.effort => Why::Effort,
            _ => Why::Searched,
        }
    }
}
