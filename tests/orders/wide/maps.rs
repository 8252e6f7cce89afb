//! The maps of the catalog on [`Matrices`], from their definitions.
//!
//! | | Ψ(u) | dΨ_u⁻¹ v |
//! |---|---|---|
//! | exp | Taylor, scaling and squaring | Σ B_k/k! ad_u^k v, or cut at q |
//! | cay | (𝟙 − u/2)⁻¹(𝟙 + u/2) | (𝟙 − u/2) v (𝟙 + u/2) |
//! | pade22 | D(u)⁻¹D(−u), D(u) = 𝟙 − u/2 + u²/12 | the x with x − u x u/12 = D(u) v D(−u) |
//! | ccsk | ∏ exp(u_k e_k), in order or reversed | the x with Σ x_k Ad_{exp(u₁e₁)…exp(u_{k−1}e_{k−1})} e_k = v |

use std::sync::LazyLock;

use lieflow::maps::{Cay, Ccsk, CoordinateMap, Exp, Pade22, TruncatedExp};
use lieflow::methods::Metric;
use lieflow::problems::LinearSpace;
use lieflow::scalar::{Real, Trig};
use lieflow::{Error, LieAlgebra, StepError};

use super::D;
use super::group::Matrices;
use super::square::{Square, reduce};

/// B_k/k!: Σ_{j ≤ k} b_j/(k + 1 − j)! = 0 for k > 0.
static BAKER: LazyLock<[D; 60]> = LazyLock::new(|| {
    let mut b = [D::lit(1.0); 60];
    for k in 1..b.len() {
        let (mut sum, mut factorial) = (D::lit(0.0), D::lit(1.0));
        for j in (0..k).rev() {
            factorial = factorial * D::lit((k + 1 - j) as f64);
            sum += b[j] / factorial;
        }
        b[k] = -sum;
    }
    b
});

/// v ← Σ_{k ≤ q} B_k/k! ad_u^k v, until a term is rounding.
fn baker(group: &Matrices, u: &Square, q: usize, v: &mut Square) {
    let (mut power, rounding) = (*v, 1e-32 * v.size().value());
    for (k, b) in BAKER.iter().enumerate().skip(1).take(q) {
        let last = power;
        group.bracket(u, &last, &mut power);
        if k == 1 || k % 2 == 0 {
            let term = power * *b;
            *v = *v + term;
            if term.size().value() <= rounding {
                return;
            }
        }
    }
}

fn finite(x: &Square, what: &'static str) -> Result<(), StepError> {
    match LinearSpace::is_finite(x) {
        true => Ok(()),
        false => Err(StepError::NotFinite { what }),
    }
}

/// One `impl`: the map with its parameters, its name, on which groups, Ψ(u), dΨ_u⁻¹v in place, its order.
macro_rules! on_matrices {
    ($map:ty, $name:literal, $at:expr, $psi:expr, $dpsi_inv:expr, $order:expr) => {
        impl CoordinateMap<Matrices> for $map {
            type At = ();

            fn name(&self) -> &'static str {
                $name
            }
            fn at(&self, group: &Matrices) -> Result<(), Error> {
                $at(group)
            }
            fn psi(
                &self,
                group: &Matrices,
                u: &Square,
                (): &mut (),
                g: &mut Square,
            ) -> Result<(), StepError> {
                *g = $psi(group, *u);
                finite(g, "Ψ(u)")
            }
            fn dpsi_inv(
                &self,
                group: &Matrices,
                u: &Square,
                (): &mut (),
                v: &mut Square,
            ) -> Result<(), StepError> {
                $dpsi_inv(self, group, u, v);
                finite(v, "dΨ⁻¹")
            }
            fn order(&self, _: &Matrices) -> usize {
                $order(self)
            }
        }
    };
}

fn everywhere(_: &Matrices) -> Result<(), Error> {
    Ok(())
}
fn exact<Psi>(_: &Psi) -> usize {
    usize::MAX
}

fn exp(_: &Matrices, u: Square) -> Square {
    u.exp()
}
on_matrices!(
    Exp,
    "exp",
    everywhere,
    exp,
    |_: &Exp, group, u, v: &mut Square| baker(group, u, usize::MAX, v),
    exact
);
on_matrices!(
    TruncatedExp,
    "exp",
    everywhere,
    exp,
    |map: &TruncatedExp, group, u, v: &mut Square| baker(group, u, map.q(), v),
    |map: &TruncatedExp| map.order_kept()
);

/// D(±u) = 𝟙 ∓ u/2, and with u²/12 more.
fn halves(u: &Square, square: &Square) -> [Square; 2] {
    let even = Square::identity(u.n()) + *square;
    let half = *u * D::lit(0.5);
    [even - half, even + half]
}
on_matrices!(
    Cay,
    "cay",
    everywhere,
    |_: &Matrices, u: Square| {
        let [minus, plus] = halves(&u, &Square::zero(u.n()));
        minus.solve(plus)
    },
    |_: &Cay, _: &Matrices, u: &Square, v: &mut Square| {
        let [minus, plus] = halves(u, &Square::zero(u.n()));
        *v = minus * *v * plus;
    },
    exact
);

/// u²/12.
fn twelfth(u: Square) -> Square {
    u * u * (D::lit(1.0) / D::lit(12.0))
}
on_matrices!(
    Pade22,
    "pade22",
    everywhere,
    |_: &Matrices, u: Square| {
        let [minus, plus] = halves(&u, &twelfth(u));
        minus.solve(plus)
    },
    // Σ (u/√12)^k w (u/√12)^k, two terms and then as many again each time.
    |_: &Pade22, _: &Matrices, u: &Square, v: &mut Square| {
        let mut power = twelfth(*u);
        let [minus, plus] = halves(u, &power);
        let w = minus * *v * plus;
        *v = w + *u * w * *u * (D::lit(1.0) / D::lit(12.0));
        while power.size().value() > 1e-17 {
            *v = *v + power * *v * power;
            power = power * power;
        }
    },
    exact
);

fn ordered(group: &Matrices) -> Result<(), Error> {
    match group.ordered_basis() {
        Some(_) => Ok(()),
        None => Err(Error::Unsupported {
            what: "ccsk",
            with: group.name(),
            why: "it has no basis with cheap factors",
        }),
    }
}

/// e_k and its exponentials: g ← g·exp(θe).
fn times_exponential(g: &mut Square, e: &Square, theta: D) {
    let n = e.n();
    if e.nonzero().all(|(i, j)| i == j) {
        let scale = Square::from_fn(1, |_, _| theta).exp()[(0, 0)];
        for (i, _) in e.nonzero() {
            let up = e[(i, i)] == D::lit(1.0);
            let scale = if up { scale } else { D::lit(1.0) / scale };
            (0..n).for_each(|k| g[(k, i)] = g[(k, i)] * scale);
        }
    } else if e.nonzero().all(|(i, j)| e[(j, i)] == -e[(i, j)]) {
        let (sin, cos) = theta.sin_cos();
        let Some((r, c)) = e.nonzero().find(|(r, c)| r > c) else { return };
        for k in 0..n {
            let (x, y) = (g[(k, c)], g[(k, r)]);
            (g[(k, c)], g[(k, r)]) = (cos * x + sin * y, cos * y - sin * x);
        }
    } else {
        // e² = 0
        for (i, j) in e.nonzero() {
            (0..n).for_each(|k| g[(k, j)] = g[(k, j)] + theta * e[(i, j)] * g[(k, i)]);
        }
    }
}

/// ∏ exp(u_k e_k) in this order.
fn product<'a>(n: usize, factors: impl Iterator<Item = (&'a Square, D)>) -> Square {
    let mut g = Square::identity(n);
    factors.for_each(|(e, theta)| times_exponential(&mut g, e, theta));
    g
}

/// No algebra has more dimensions.
const DIM: usize = 10;

/// v ← dΨ_u⁻¹ v by the matrix of dΨ_u, whose columns are the coordinates of P e_k P⁻¹ with P the product of
/// the factors before.
fn inverse_differential<'a>(
    group: &Matrices,
    factors: impl Iterator<Item = (&'a Square, D)>,
    v: &mut Square,
) {
    let dim = group.dim();
    let mut rows = [[D::lit(0.0); DIM + 1]; DIM];
    let mut p = Square::identity(group.n());
    let mut elements = Vec::with_capacity(dim);
    for (k, (e, theta)) in factors.enumerate() {
        let carried = p * *e * group.inverse(&p);
        group.coordinates(&carried).enumerate().for_each(|(i, x)| rows[i][k] = x);
        times_exponential(&mut p, e, theta);
        elements.push(*e);
    }
    group.coordinates(v).enumerate().for_each(|(i, x)| rows[i][dim] = x);
    reduce(&mut rows[..dim], dim + 1);
    *v = elements.iter().zip(&rows).fold(group.zero(), |v, (e, row)| v + *e * row[dim]);
}

/// The e_k, each with its coordinate of u.
fn factors<'a>(
    group: &'a Matrices,
    u: &'a Square,
) -> impl DoubleEndedIterator<Item = (&'a Square, D)> {
    let basis = group.ordered_basis().unwrap_or_default();
    let angles: Vec<D> = group.coordinates(u).collect();
    basis.iter().zip(angles)
}
on_matrices!(
    Ccsk<2, 1, 0>,
    "ccsk321",
    ordered,
    |group: &Matrices, u: Square| product(group.n(), factors(group, &u)),
    |_: &Self, group, u, v| inverse_differential(group, factors(group, u), v),
    exact
);
on_matrices!(
    Ccsk<0, 1, 2>,
    "ccsk123",
    ordered,
    |group: &Matrices, u: Square| product(group.n(), factors(group, &u).rev()),
    |_: &Self, group, u, v| inverse_differential(group, factors(group, u).rev(), v),
    exact
);
