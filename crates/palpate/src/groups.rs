//! What belongs together.

/// Sets of numbers that are united step by step.
pub(crate) struct Groups {
    parents: Vec<usize>,
}

impl Groups {
    pub fn new(count: usize) -> Self {
        Self { parents: (0..count).collect() }
    }

    /// The least member of the group.
    pub fn root(&mut self, mut member: usize) -> usize {
        while self.parents[member] != member {
            self.parents[member] = self.parents[self.parents[member]];
            member = self.parents[member];
        }
        member
    }

    pub fn unite(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b)] = a.min(b);
    }

    /// The members of each group, groups in the order of their least member.
    pub fn collect<T>(mut self, members: impl Iterator<Item = T>) -> Vec<Vec<T>> {
        let mut places = vec![usize::MAX; self.parents.len()];
        let mut collected: Vec<Vec<T>> = Vec::new();
        for (k, member) in members.enumerate() {
            let root = self.root(k);
            if root == k {
                places[k] = collected.len();
                collected.push(Vec::new());
            }
            collected[places[root]].push(member);
        }
        collected
    }
}
