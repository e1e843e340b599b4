//! What a tip swept freely, in the plane and in space: evidence that the part is not there (DESIGN §2).

use crate::contact::Evidence;
use crate::dimension::Dimension;

/// A swept segment, from the pivot, world frame, and the distance that the part keeps from it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sweep<V> {
    pub start: V,
    pub end: V,
    /// A pose is excluded iff the signed distance of some swept point to the part is smaller.
    pub clearance: f64,
}

impl<V: Dimension> Sweep<V> {
    /// Of every miss, and of every contact that says where its move began, as far as it may come near a model of that
    /// size; `slack` is the model's.
    ///
    /// A contact's own sweep ends its position error short of the centre. The true centre may be off the sensed one
    /// by that error, hence so may the line on which the tip came: it counts as the path error.
    ///
    /// Of each, the part counts that is near enough: the model is somewhere at the first contact.
    pub fn all(evidence: &Evidence<V>, size: f64, slack: f64, pivot: V) -> Vec<Self> {
        let misses = evidence.misses.iter().map(|miss| Self {
            start: miss.start - pivot,
            end: miss.end - pivot,
            clearance: miss.tip_radius - miss.path_error - slack,
        });
        let approaches = evidence.contacts.iter().filter_map(|contact| {
            let start = contact.start?;
            let way = contact.center - start;
            let short = way.length() - contact.position_error;
            (short > 0.0).then(|| Self {
                start: start - pivot,
                end: start - pivot + way * (short / way.length()),
                clearance: contact.tip_radius - contact.position_error - slack,
            })
        });
        let near = evidence.contacts.first().map(|contact| {
            let reach = size + contact.position_error + contact.tip_radius + slack;
            (contact.center - pivot, reach)
        });
        let all = misses.chain(approaches);
        all.filter_map(|sweep| near.map_or(Some(sweep), |(at, reach)| sweep.clipped(at, 1.01 * reach)))
            .collect()
    }

    /// The part of it that may come near a model within `reach` of a place; `None` if it comes nowhere near.
    fn clipped(self, place: V, reach: f64) -> Option<Self> {
        let reach = reach + self.clearance.max(0.0);
        let way = self.end - self.start;
        let length = way.length();
        let offset = place - self.start;
        let Some(along) = way.try_normalize() else {
            return (offset.length() <= reach).then_some(self);
        };
        let foot = along.dot(offset);
        let aside = (offset - along * foot).length();
        let half = (reach * reach - aside * aside).max(0.0).sqrt();
        let (from, to) = ((foot - half).max(0.0), (foot + half).min(length));
        // A sweep that is needed whole is kept as it was given.
        let cut = |t: f64| {
            if t <= 0.0 {
                self.start
            } else if t >= length {
                self.end
            } else {
                self.start + along * t
            }
        };
        (aside <= reach && from <= to).then(|| Self { start: cut(from), end: cut(to), ..self })
    }

    /// The farthest of it from the pivot.
    pub fn reach(&self) -> f64 {
        self.start.length().max(self.end.length())
    }
}
