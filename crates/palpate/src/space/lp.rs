//! Small linear programs with bounds that hold.
//!
//! Maximize `c·x` subject to `a_k·x ≤ b_k` within a box. The search is a dual simplex in floating point and may end
//! anywhere; its multipliers prove the bound. For any `λ ≥ 0` and every feasible `x`,
//!
//! `c·x ≤ Σ λ_k b_k + Σ_j |c_j − Σ_k λ_k a_kj| · max |x_j|`,
//!
//! by weak duality; the last sum is what the multipliers miss, and rounding is added to it (Neumaier and Shcherbina,
//! Safe bounds in linear and mixed-integer linear programming, 2004).

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

fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A member of the basis: a row, or a side of the box.
#[derive(Clone, Copy)]
enum Member {
    Row(usize),
    Low(usize),
    High(usize),
}

/// Maximizes `objective · x` over the rows, within `|x_j| ≤ half_j`.
pub(crate) fn maximize<const N: usize>(objective: &[f64; N], rows: &[Row<N>], half: &[f64; N]) -> Optimum<N> {
    let mut basis = [Member::Low(0); N];
    // `inverse[j]` is the row of the inverse that gives x_j from the members' bounds.
    let mut inverse = [[0.0; N]; N];
    let mut duals = [0.0; N];
    let mut point = [0.0; N];
    for j in 0..N {
        let up = objective[j] > 0.0;
        basis[j] = if up { Member::High(j) } else { Member::Low(j) };
        inverse[j][j] = if up { 1.0 } else { -1.0 };
        duals[j] = objective[j].abs();
        point[j] = if up { half[j] } else { -half[j] };
    }
    for _ in 0..MOST_STEPS {
        let Some(entering) = most_violated(rows, half, &point) else { break };
        let (normal, bound) = member(entering, rows, half);
        // normal = Σ share_k member_k
        let mut shares = [0.0; N];
        for (k, share) in shares.iter_mut().enumerate() {
            *share = (0..N).map(|j| normal[j] * inverse[j][k]).sum();
        }
        let mut leaving: Option<(usize, f64)> = None;
        for k in 0..N {
            if shares[k] > 1e-12 {
                let ratio = duals[k].max(0.0) / shares[k];
                if leaving.is_none_or(|(_, least)| ratio < least) {
                    leaving = Some((k, ratio));
                }
            }
        }
        let Some((out, ratio)) = leaving else {
            if refuted(entering, &shares, &basis, rows, half) {
                return Optimum { point, bound: f64::NEG_INFINITY };
            }
            break;
        };
        let excess = dot(&normal, &point) - bound;
        let pivot = shares[out];
        for j in 0..N {
            let column = inverse[j][out] / pivot;
            for k in 0..N {
                if k == out {
                    inverse[j][k] = column;
                } else {
                    inverse[j][k] -= column * shares[k];
                }
            }
            point[j] -= column * excess;
        }
        for k in 0..N {
            if k == out {
                duals[k] = ratio;
            } else {
                duals[k] -= ratio * shares[k];
            }
        }
        basis[out] = entering;
    }
    let proof = basis.iter().zip(&duals).map(|(one, dual)| (*one, dual.max(0.0)));
    Optimum { point, bound: proved(objective, proof, rows, half) }
}

fn most_violated<const N: usize>(rows: &[Row<N>], half: &[f64; N], point: &[f64; N]) -> Option<Member> {
    let mut worst: Option<(f64, Member)> = None;
    let mut offer = |excess: f64, scale: f64, one: Member| {
        if excess > VIOLATED * scale && worst.is_none_or(|(most, _)| excess > most) {
            worst = Some((excess, one));
        }
    };
    for (k, row) in rows.iter().enumerate() {
        offer(dot(&row.normal, point) - row.bound, 1.0 + row.bound.abs(), Member::Row(k));
    }
    for j in 0..N {
        offer(point[j] - half[j], 1.0 + half[j], Member::High(j));
        offer(-half[j] - point[j], 1.0 + half[j], Member::Low(j));
    }
    worst.map(|(_, one)| one)
}

fn member<const N: usize>(one: Member, rows: &[Row<N>], half: &[f64; N]) -> ([f64; N], f64) {
    let unit = |j: usize, sign: f64| {
        let mut normal = [0.0; N];
        normal[j] = sign;
        (normal, half[j])
    };
    match one {
        Member::Row(k) => (rows[k].normal, rows[k].bound),
        Member::High(j) => unit(j, 1.0),
        Member::Low(j) => unit(j, -1.0),
    }
}

/// An upper bound of `objective · x` from multipliers.
fn proved<const N: usize>(
    objective: &[f64; N],
    multipliers: impl Iterator<Item = (Member, f64)>,
    rows: &[Row<N>],
    half: &[f64; N],
) -> f64 {
    let mut left = *objective;
    let (mut sum, mut summed) = (0.0, 0.0);
    let mut weights = objective.map(f64::abs);
    for (one, multiplier) in multipliers {
        let (normal, bound) = member(one, rows, half);
        sum += multiplier * bound;
        summed += (multiplier * bound).abs();
        for j in 0..N {
            left[j] -= multiplier * normal[j];
            weights[j] += (multiplier * normal[j]).abs();
        }
    }
    for j in 0..N {
        sum += left[j].abs() * half[j];
        summed += weights[j] * half[j];
    }
    sum + ROUNDING * summed
}

/// Whether a violated row and those members that it needs as multiples below zero prove that nothing is feasible.
fn refuted<const N: usize>(
    entering: Member,
    shares: &[f64; N],
    basis: &[Member; N],
    rows: &[Row<N>],
    half: &[f64; N],
) -> bool {
    let others = basis.iter().zip(shares).map(|(one, share)| (*one, (-share).max(0.0)));
    proved(&[0.0; N], others.chain([(entering, 1.0)]), rows, half) < 0.0
}

#[cfg(test)]
mod tests {
    use super::{Row, maximize};

    /// Random programs against dense sampling of the box: no sample that is feasible beats the bound, and the point
    /// attains it.
    #[test]
    fn bounds_hold_and_are_attained() {
        let mut rng = fastrand::Rng::with_seed(7);
        let mut attained = 0;
        for _ in 0..2000 {
            let mut draw = || 2.0 * rng.f64() - 1.0;
            let half = [1.0, 0.5, 2.0];
            let objective = [draw(), draw(), draw()];
            let rows: Vec<Row<3>> =
                (0..8).map(|_| Row { normal: [draw(), draw(), draw()], bound: 0.6 * draw() + 0.2 }).collect();
            let optimum = maximize(&objective, &rows, &half);
            let value = |x: [f64; 3]| objective.iter().zip(x).map(|(c, x)| c * x).sum::<f64>();
            let excess = |x: [f64; 3]| {
                let rows = rows
                    .iter()
                    .map(|row| row.normal.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() - row.bound);
                rows.fold(f64::NEG_INFINITY, f64::max)
            };
            let mut any = false;
            for _ in 0..300 {
                let x = [draw() * half[0], draw() * half[1], draw() * half[2]];
                if excess(x) <= 0.0 {
                    any = true;
                    assert!(value(x) <= optimum.bound);
                }
            }
            if optimum.bound > f64::NEG_INFINITY {
                assert!(excess(optimum.point) < 1e-9);
                assert!((value(optimum.point) - optimum.bound).abs() < 1e-9);
                attained += 1;
            } else {
                assert!(!any);
            }
        }
        assert!(attained > 1000);
    }
}
