//! The order in which a best-first search takes what is open.

use std::cmp::Ordering;

/// Something that misses by a length: in a heap, the least miss is on top; of equal ones, the first that came.
pub(crate) struct Nearest<T> {
    pub miss: f64,
    pub number: usize,
    pub value: T,
}

impl<T> Ord for Nearest<T> {
    fn cmp(&self, other: &Self) -> Ordering {
        other.miss.total_cmp(&self.miss).then(other.number.cmp(&self.number))
    }
}

impl<T> PartialOrd for Nearest<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> PartialEq for Nearest<T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<T> Eq for Nearest<T> {}
