//! What a line tells, without coordinates, and the best tree over a pool of such relations (MATH 2.4).

/// Hypotheses, one bit each.
pub type Set = u128;

/// Most hypotheses for which the best tree is sought.
pub const MOST_HYPOTHESES: usize = 12;

/// What a line tells of the hypotheses. Separation is a matter of two, usability of one: it holds in every subset.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Relation {
    /// Those that make the line unusable where they are present.
    faults: Set,
    /// `left[k]`: the others that are not separated from `k`; neither is in `faults`.
    left: Vec<Set>,
}

impl Relation {
    /// Of hypotheses `0..left.len()`; `left[k]` are those that are not separated from `k`, or from which `k` is not.
    ///
    /// ```
    /// use palpate::ambiguity::Relation;
    /// let relation = Relation::new(0, &[0b010, 0, 0]);
    /// assert_eq!(relation.classes(0b111), Some(vec![0b011, 0b100]));
    /// assert_eq!(relation.classes(0b110), Some(vec![0b010, 0b100]));
    /// ```
    ///
    /// # Panics
    /// More than 128 hypotheses.
    #[must_use]
    pub fn new(faults: Set, left: &[Set]) -> Self {
        assert!(left.len() <= Set::BITS as usize, "one bit for each hypothesis");
        let everyone = left.iter().enumerate().fold(0, |all, (k, _)| all | bit(k));
        let faults = faults & everyone;
        let mut mutual = vec![0; left.len()];
        for (k, others) in left.iter().enumerate().filter(|(k, _)| faults & bit(*k) == 0) {
            for j in members(others & everyone & !faults & !bit(k)) {
                mutual[k] |= bit(j);
                mutual[j] |= bit(k);
            }
        }
        Self { faults, left: mutual }
    }

    /// Its classes within a subset, in order of their first members; `None` if the line can't be used there.
    #[must_use]
    pub fn classes(&self, subset: Set) -> Option<Vec<Set>> {
        if self.faults & subset != 0 {
            return None;
        }
        let (mut rest, mut classes) = (subset, Vec::new());
        while rest != 0 {
            let class = self.class_of(rest);
            rest &= !class;
            classes.push(class);
        }
        Some(classes)
    }

    /// All that is connected with the first member of a set.
    fn class_of(&self, set: Set) -> Set {
        let mut class = set & set.wrapping_neg();
        let mut edge = class;
        while edge != 0 {
            let reached = members(edge).fold(0, |reached, k| reached | self.left[k]);
            edge = reached & set & !class;
            class |= edge;
        }
        class
    }

    /// Whether it is usable wherever the other is, and separates all that the other does: the other is not needed.
    #[must_use]
    pub fn dominates(&self, other: &Self) -> bool {
        let usable = !other.faults;
        self.faults & usable == 0
            && self.left.iter().zip(&other.left).all(|(own, others)| own & usable & !others == 0)
    }

    /// The largest number of classes that it has within any subset.
    #[must_use]
    pub fn most_outcomes(&self) -> usize {
        let everyone = (0..self.left.len()).fold(0, |all, k| all | bit(k));
        self.most_apart(everyone & !self.faults)
    }

    /// The largest number of members that are separated from each other.
    fn most_apart(&self, set: Set) -> usize {
        let Some(first) = members(set).next() else { return 0 };
        let with = 1 + self.most_apart(set & !bit(first) & !self.left[first]);
        if self.left[first] & set == 0 {
            return with;
        }
        with.max(self.most_apart(set & !bit(first)))
    }
}

/// The best that can be done from a subset on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Value {
    /// Touches, summed over the hypotheses: the number of hypotheses times the expected touches.
    pub touches: usize,
    /// Touches in the worst case.
    pub worst: usize,
    /// Of those that are as good the first in the pool; `None`: none divides the subset, which is left unsolved.
    pub relation: Option<usize>,
}

/// The tree of fewest expected touches over a pool, of these the one with the fewest in the worst case; exact, by dynamic
/// programming over subsets.
///
/// All hypotheses are equally likely. A subset of s that nothing divides counts s − 1 further touches for each.
#[derive(Debug)]
pub struct Optimum<'a> {
    relations: &'a [Relation],
    values: Vec<Option<Value>>,
}

impl<'a> Optimum<'a> {
    /// For subsets of `num_hypotheses`.
    ///
    /// ```
    /// use palpate::ambiguity::{Optimum, Relation};
    /// let pool = [Relation::new(0, &[0b010, 0, 0]), Relation::new(0b100, &[0, 0, 0])];
    /// let value = Optimum::new(3, &pool).value(0b111);
    /// assert_eq!((value.touches, value.worst), (5, 2));
    /// ```
    ///
    /// # Panics
    /// More than [`MOST_HYPOTHESES`].
    #[must_use]
    pub fn new(num_hypotheses: usize, relations: &'a [Relation]) -> Self {
        assert!(num_hypotheses <= MOST_HYPOTHESES, "a table of all subsets");
        Self { relations, values: vec![None; 1 << num_hypotheses] }
    }

    /// The value of a subset.
    pub fn value(&mut self, subset: Set) -> Value {
        if let Some(known) = self.values[subset as usize] {
            return known;
        }
        let size = subset.count_ones() as usize;
        let unsolved = size.saturating_sub(1);
        let mut best = Value { touches: size * unsolved, worst: unsolved, relation: None };
        for (number, relation) in self.relations.iter().enumerate() {
            let Some(classes) = relation.classes(subset).filter(|classes| classes.len() > 1) else {
                continue;
            };
            let at_least = size + classes.iter().copied().map(at_least).sum::<usize>();
            if best.relation.is_some() && at_least > best.touches {
                continue;
            }
            let value = self.value_with(size, &classes, number);
            if best.relation.is_none() || (value.touches, value.worst) < (best.touches, best.worst) {
                best = value;
            }
        }
        self.values[subset as usize] = Some(best);
        best
    }

    fn value_with(&mut self, size: usize, classes: &[Set], number: usize) -> Value {
        let mut value = Value { touches: size, worst: 0, relation: Some(number) };
        for class in classes {
            let part = self.value(*class);
            value.touches += part.touches;
            value.worst = value.worst.max(part.worst);
        }
        value.worst += 1;
        value
    }

    /// The subsets of more than one that the best tree meets, from the root on.
    pub fn subsets(&mut self, root: Set) -> Vec<Set> {
        let mut subsets = vec![root];
        let mut at = 0;
        while let Some(&subset) = subsets.get(at) {
            let relation = self.value(subset).relation.map(|number| &self.relations[number]);
            let classes = relation.and_then(|relation| relation.classes(subset)).unwrap_or_default();
            subsets.extend(classes.into_iter().filter(|class| class.count_ones() > 1));
            at += 1;
        }
        subsets
    }
}

/// Touches of a class, summed over its members: one is identified, more need at least one touch.
fn at_least(class: Set) -> usize {
    if class.count_ones() > 1 { class.count_ones() as usize } else { 0 }
}

/// The bit of a hypothesis.
pub(super) fn bit(number: usize) -> Set {
    1 << number
}

/// The numbers in a set, in order.
pub(super) fn members(set: Set) -> impl Iterator<Item = usize> {
    let mut rest = set;
    std::iter::from_fn(move || {
        let next = (rest != 0).then(|| rest.trailing_zeros() as usize);
        rest &= rest.wrapping_sub(1);
        next
    })
}
