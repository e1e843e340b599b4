//! Small linear programs with bounds that hold.
//!
//! Maximize `c·x` subject to `a_k·x ≤ b_k` within a box. The search is a simplex in floating point, dual until a point is
//! feasible and primal from there on to other objectives. It may end anywhere; its multipliers prove the bound. For any
//! `λ ≥ 0` and every feasible `x`,
//!
//! `c·x ≤ Σ λ_k b_k + Σ_j |c_j − Σ_k λ_k a_kj| · max |x_j|`,
//!
//! by weak duality; the last sum is what the multipliers miss, and rounding is added to it (Neumaier and Shcherbina,
//! Safe bounds in linear and mixed-integer linear programming, 2004).

use arrayvec::ArrayVec;

/// `normal · x ≤ bound`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row<const N: usize> {
    pub normal: [f64; N],
    pub bound: f64,
}

/// What a search found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Optimum<const N: usize> {
    /// A point that satisfies the rows, up to rounding, if there is one.
    pub point: [f64; N],
    /// No feasible point has more; `-∞`: there is none.
    pub bound: f64,
}

/// Steps after which the search stops where it is.
const MOST_STEPS: usize = 200;

/// A row is violated if it is so by this share of its scale.
const VIOLATED: f64 = 1e-11;

/// The share of what is summed by which a computed bound may be wrong: some hundred units of rounding.
const ROUNDING: f64 = 1e-13;

/// A bound that is above what a point has by no more than this, of its size, is attained.
const ATTAINED: f64 = 1e-7;

/// A way that nears a row by no more than this share of its length runs along it.
const FLAT: f64 = 1e-10;

/// Members that a way may meet at once.
const MOST_MET: usize = 16;

/// Shares of a row below this are rounding.
const NOTHING: f64 = 1e-12;

fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    let mut sum = 0.0;
    for j in 0..N {
        sum += a[j] * b[j];
    }
    sum
}

/// A member of the basis: a row, or a side of the box.
#[derive(Debug, Clone, Copy)]
enum Member {
    Row(usize),
    Low(usize),
    High(usize),
}

/// Rows within a box `|x_j| ≤ half_j`, for one objective after another.
#[derive(Debug, Clone)]
pub(crate) struct Program<const N: usize> {
    rows: Vec<Row<N>>,
    half: [f64; N],
    basis: [Member; N],
    /// `inverse[j]` is the row of the inverse that gives `x_j` from the members' bounds.
    inverse: [[f64; N]; N],
    point: [f64; N],
    state: State,
}

/// Where the search is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum State {
    /// No point is known to be feasible.
    Outside,
    Feasible,
    /// It is proved that nothing is.
    Empty,
}

impl<const N: usize> Program<N> {
    /// Rows that the box satisfies are left out.
    pub fn new(rows: impl Iterator<Item = Row<N>>, half: [f64; N]) -> Self {
        let cuts = |row: &Row<N>| {
            let most: f64 = (0..N).map(|j| row.normal[j].abs() * half[j]).sum();
            most * (1.0 - ROUNDING) > row.bound
        };
        let rows = rows.filter(cuts).collect();
        let basis = std::array::from_fn(Member::Low);
        Self { rows, half, basis, inverse: [[0.0; N]; N], point: [0.0; N], state: State::Outside }
    }

    /// Maximizes `objective · x`.
    pub fn maximize(&mut self, objective: &[f64; N]) -> Optimum<N> {
        if self.state == State::Feasible {
            let duals = self.climb(objective);
            let optimum = self.optimum(objective, &duals);
            let value = dot(objective, &self.point);
            if optimum.bound - value <= ATTAINED * (1.0 + value.abs()) {
                return optimum;
            }
        }
        // From the start, where there is none to climb from, or rounding has spoilt the corner.
        let duals = if self.state == State::Empty { None } else { self.enter(objective) };
        match duals {
            Some(duals) => self.optimum(objective, &duals),
            None => Optimum { point: self.point, bound: f64::NEG_INFINITY },
        }
    }

    fn optimum(&self, objective: &[f64; N], duals: &[f64; N]) -> Optimum<N> {
        let proof = self.basis.iter().zip(duals).map(|(one, dual)| (*one, dual.max(0.0)));
        let bound = self.proved(objective, proof);
        // Multipliers beyond all numbers prove nothing.
        Optimum { point: self.point, bound: if bound.is_nan() { f64::INFINITY } else { bound } }
    }

    /// From the corner of the box that is best, until no row is violated: a dual simplex. `None`: nothing is feasible.
    fn enter(&mut self, objective: &[f64; N]) -> Option<[f64; N]> {
        let mut duals = [0.0; N];
        self.state = State::Outside;
        self.inverse = [[0.0; N]; N];
        for j in 0..N {
            let up = objective[j] > 0.0;
            self.basis[j] = if up { Member::High(j) } else { Member::Low(j) };
            self.inverse[j][j] = if up { 1.0 } else { -1.0 };
            duals[j] = objective[j].abs();
            self.point[j] = if up { self.half[j] } else { -self.half[j] };
        }
        for _ in 0..MOST_STEPS {
            let Some(entering) = self.most_violated() else {
                self.state = State::Feasible;
                break;
            };
            let (normal, bound) = self.member(entering);
            let shares = self.shares(&normal);
            let mut leaving: Option<(usize, f64)> = None;
            for k in 0..N {
                if shares[k] > NOTHING {
                    let ratio = duals[k].max(0.0) / shares[k];
                    if leaving.is_none_or(|(_, least)| ratio < least) {
                        leaving = Some((k, ratio));
                    }
                }
            }
            let Some((out, _)) = leaving else {
                if self.refuted(entering, &shares) {
                    self.state = State::Empty;
                    return None;
                }
                break;
            };
            let excess = (dot(&normal, &self.point) - bound) / shares[out];
            for j in 0..N {
                self.point[j] -= self.inverse[j][out] * excess;
            }
            self.exchange(out, entering, &shares, &mut duals);
        }
        Some(duals)
    }

    /// From a feasible corner to better ones: a primal simplex.
    fn climb(&mut self, objective: &[f64; N]) -> [f64; N] {
        let mut duals = self.shares(objective);
        let scale = duals.iter().fold(0.0_f64, |most, dual| most.max(dual.abs()));
        for _ in 0..MOST_STEPS {
            let least = (0..N).min_by(|a, b| duals[*a].total_cmp(&duals[*b])).unwrap_or(0);
            if duals[least] >= -NOTHING * scale {
                break;
            }
            // Along the edge of the corner that leaves the member.
            let way: [f64; N] = std::array::from_fn(|j| -self.inverse[j][least]);
            let Some((entering, step)) = self.first_met(&way) else { break };
            for (x, along) in self.point.iter_mut().zip(way) {
                *x += step * along;
            }
            let shares = self.shares(&self.member(entering).0);
            self.exchange(least, entering, &shares, &mut duals);
        }
        duals
    }

    /// A normal as a sum of the members' normals.
    fn shares(&self, normal: &[f64; N]) -> [f64; N] {
        let mut shares = [0.0; N];
        for (amount, row) in normal.iter().zip(&self.inverse) {
            for (share, of_member) in shares.iter_mut().zip(row) {
                *share += amount * of_member;
            }
        }
        shares
    }

    /// Puts a member in the place of another.
    fn exchange(&mut self, out: usize, entering: Member, shares: &[f64; N], duals: &mut [f64; N]) {
        for row in &mut self.inverse {
            let column = row[out] / shares[out];
            for k in 0..N {
                row[k] -= column * shares[k];
            }
            row[out] = column;
        }
        let dual = duals[out] / shares[out];
        for k in 0..N {
            duals[k] -= dual * shares[k];
        }
        duals[out] = dual;
        self.basis[out] = entering;
    }

    fn most_violated(&self) -> Option<Member> {
        let (point, half) = (&self.point, &self.half);
        let mut worst: Option<(f64, Member)> = None;
        let mut offer = |excess: f64, scale: f64, one: Member| {
            if excess > VIOLATED * scale && worst.is_none_or(|(most, _)| excess > most) {
                worst = Some((excess, one));
            }
        };
        for (k, row) in self.rows.iter().enumerate() {
            offer(dot(&row.normal, point) - row.bound, 1.0 + row.bound.abs(), Member::Row(k));
        }
        for j in 0..N {
            offer(point[j] - half[j], 1.0 + half[j], Member::High(j));
            offer(-half[j] - point[j], 1.0 + half[j], Member::Low(j));
        }
        worst.map(|(_, one)| one)
    }

    /// What is met first on a way from the point, and how far along; of what is met within the tolerance, what the way meets
    /// most squarely, so that no corner hangs on rounding (Harris 1973).
    fn first_met(&self, way: &[f64; N]) -> Option<(Member, f64)> {
        let flat = FLAT * dot(way, way).sqrt();
        let mut met: ArrayVec<(f64, f64, Member), MOST_MET> = ArrayVec::new();
        let mut farthest = f64::INFINITY;
        let mut offer = |rate: f64, left: f64, scale: f64, one: Member| {
            if rate <= flat {
                return;
            }
            let step = left.max(0.0) / rate;
            if step > farthest {
                return;
            }
            farthest = farthest.min((left.max(0.0) + 10.0 * VIOLATED * scale) / rate);
            if met.is_full() {
                met.retain(|(step, ..)| *step <= farthest);
            }
            // Where too many are met at once, those that are met more squarely matter.
            if met.is_full() {
                let flattest = (0..met.len()).min_by(|a, b| met[*a].1.total_cmp(&met[*b].1)).unwrap_or(0);
                met.swap_remove(flattest);
            }
            met.push((step, rate, one));
        };
        for (k, row) in self.rows.iter().enumerate() {
            let left = row.bound - dot(&row.normal, &self.point);
            offer(dot(&row.normal, way), left, 1.0 + row.bound.abs(), Member::Row(k));
        }
        for (j, ((rate, half), x)) in way.iter().zip(&self.half).zip(&self.point).enumerate() {
            offer(*rate, half - x, 1.0 + half, Member::High(j));
            offer(-rate, half + x, 1.0 + half, Member::Low(j));
        }
        let first = met.iter().filter(|(step, ..)| *step <= farthest).max_by(|a, b| a.1.total_cmp(&b.1));
        first.map(|(step, _, one)| (*one, *step))
    }

    fn member(&self, one: Member) -> ([f64; N], f64) {
        let unit = |j: usize, sign: f64| {
            let mut normal = [0.0; N];
            normal[j] = sign;
            (normal, self.half[j])
        };
        match one {
            Member::Row(k) => (self.rows[k].normal, self.rows[k].bound),
            Member::High(j) => unit(j, 1.0),
            Member::Low(j) => unit(j, -1.0),
        }
    }

    /// An upper bound of `objective · x` from multipliers.
    fn proved(&self, objective: &[f64; N], multipliers: impl Iterator<Item = (Member, f64)>) -> f64 {
        let mut left = *objective;
        let (mut sum, mut summed) = (0.0, 0.0);
        let mut weights = objective.map(f64::abs);
        for (one, multiplier) in multipliers {
            let (normal, bound) = self.member(one);
            sum += multiplier * bound;
            summed += (multiplier * bound).abs();
            for j in 0..N {
                left[j] -= multiplier * normal[j];
                weights[j] += (multiplier * normal[j]).abs();
            }
        }
        for j in 0..N {
            sum += left[j].abs() * self.half[j];
            summed += weights[j] * self.half[j];
        }
        sum + ROUNDING * summed
    }

    /// Whether a violated row and those members that it needs as multiples below zero prove that nothing is feasible.
    fn refuted(&self, entering: Member, shares: &[f64; N]) -> bool {
        let others = self.basis.iter().zip(shares).map(|(one, share)| (*one, (-share).max(0.0)));
        self.proved(&[0.0; N], others.chain([(entering, 1.0)])) < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::{Program, Row};

    /// Random programs against dense sampling of the box: no sample that is feasible beats the bound of any objective, one
    /// after another, and the point attains it.
    #[test]
    fn bounds_hold_and_are_attained() {
        let mut rng = fastrand::Rng::with_seed(7);
        let (mut attained, mut empty) = (0, 0);
        for k in 0..2000 {
            let mut draw = || 2.0 * rng.f64() - 1.0;
            let half = [1.0, 0.5, 2.0];
            let objectives: Vec<[f64; 3]> = (0..4).map(|_| [draw(), draw(), draw()]).collect();
            let mut rows: Vec<Row<3>> =
                (0..8).map(|_| Row { normal: [draw(), draw(), draw()], bound: 0.6 * draw() + 0.2 }).collect();
            if k % 3 == 0 {
                // Rows that repeat, and that meet in a point: corners of many members.
                let again = rows[0];
                rows.extend([again, again]);
                for row in &mut rows {
                    row.bound = row.bound.max(0.0).floor();
                }
            }
            let value =
                |objective: &[f64; 3], x: [f64; 3]| objective.iter().zip(x).map(|(c, x)| c * x).sum::<f64>();
            let excess = |x: [f64; 3]| {
                let rows = rows
                    .iter()
                    .map(|row| row.normal.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() - row.bound);
                rows.fold(f64::NEG_INFINITY, f64::max)
            };
            let samples: Vec<[f64; 3]> =
                (0..300).map(|_| [draw() * half[0], draw() * half[1], draw() * half[2]]).collect();
            let feasible: Vec<[f64; 3]> = samples.into_iter().filter(|x| excess(*x) <= 0.0).collect();
            let mut program = Program::new(rows.iter().copied(), half);
            for objective in &objectives {
                let optimum = program.maximize(objective);
                assert!(feasible.iter().all(|x| value(objective, *x) <= optimum.bound));
                if optimum.bound > f64::NEG_INFINITY {
                    assert!(excess(optimum.point) < 1e-9);
                    assert!((value(objective, optimum.point) - optimum.bound).abs() < 1e-9);
                    attained += 1;
                } else {
                    assert!(feasible.is_empty());
                    empty += 1;
                }
            }
        }
        assert!(attained > 4000 && empty > 400, "{attained} {empty}");
    }
}
