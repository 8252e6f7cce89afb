//! The Magnus expansion: Ω by nested brackets of A at Gauss–Legendre nodes.
//!
//! Order 4: Ω = h/2 (A₁ + A₂) − h²√3/12 \[A₁, A₂\].
//! Order 6 has three brackets: S. Blanes, F. Casas, J. Ros, High order optimized geometric integrators for linear
//! differential equations, BIT 42 (2002). Order 8 has ten: the same authors, Improved high order integrators based on the
//! Magnus expansion, BIT 40 (2000).

use super::{GAUSS_2, GAUSS_3, GAUSS_4, MagnusWork, ROOT_3, ROOT_15, V, W, magnus_method, sum};
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::maps::{CoordinateMap, Exp};
use crate::methods::{Step, Symmetric};
use crate::problems::{PointOf, ScalarOf};
use crate::scalar::Real;

/// The Magnus method of order 4 with one bracket.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Magnus4;
/// The Magnus method of order 6 with three brackets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Magnus6;
/// The Magnus method of order 8 with ten brackets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Magnus8;

magnus_method!(Magnus4, 4, GAUSS_2, Exp, 2, 2, [], order_4, 1);
magnus_method!(Magnus6, 6, GAUSS_3, Exp, 3, 7, [], order_6, 3);
magnus_method!(Magnus8, 8, GAUSS_4, Exp, 4, 14, [], order_8, 10);

impl Symmetric for Magnus4 {}
impl Symmetric for Magnus6 {}
impl Symmetric for Magnus8 {}

fn order_4<G: LieAlgebra>(g: &G, h: G::Scalar, a: &[G::Alg; 2], [omega, x]: &mut [G::Alg; 2]) {
    g.combine(h, &[0.5, 0.5], a, omega);
    g.bracket(&a[0], &a[1], x);
    g.axpy(h * h * G::Scalar::lit(-ROOT_3 / 12.0), x, omega);
}

/// α₁ = hA₂, α₂ = h√15/3 (A₃ − A₁), α₃ = 10h/3 (A₃ − 2A₂ + A₁); C₁ = \[α₁, α₂\],
/// C₂ = −\[α₁, 2α₃ + C₁\]/60; Ω = α₁ + α₃/12 + \[−20α₁ − α₃ + C₁, α₂ + C₂\]/240.
fn order_6<G: LieAlgebra>(g: &G, h: G::Scalar, a: &[G::Alg; 3], work: &mut [G::Alg; 7]) {
    let lit = G::Scalar::lit;
    let [omega, a1, a2, a3, c1, x, y] = work;
    g.combine(h, &[0.0, 1.0, 0.0], a, a1);
    g.combine(h, &[-ROOT_15 / 3.0, 0.0, ROOT_15 / 3.0], a, a2);
    g.combine(h, &[10.0 / 3.0, -20.0 / 3.0, 10.0 / 3.0], a, a3);
    g.bracket(a1, a2, c1);
    sum(g, [(lit(2.0), a3), (lit(1.0), c1)], x);
    g.bracket(a1, x, y);
    g.axpy(lit(-1.0 / 60.0), y, a2); // α₂ + C₂
    sum(g, [(lit(-20.0), a1), (lit(-1.0), a3), (lit(1.0), c1)], x);
    g.bracket(x, a2, y);
    sum(g, [(lit(1.0), a1), (lit(1.0 / 12.0), a3), (lit(1.0 / 240.0), y)], omega);
}

/// The weights of B_k = h ∫ (s − ½)^k A ds over the step, by the Gauss rule.
const fn moment(k: usize) -> [f64; 4] {
    let (mut x, mut y) = (W[0], W[1]);
    let mut i = 0;
    while i < k {
        x *= V[0];
        y *= V[1];
        i += 1;
    }
    let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
    [sign * x, sign * y, y, x]
}
const MOMENTS: [[f64; 4]; 4] = [moment(0), moment(1), moment(2), moment(3)];

/// Ω = B₀ + Q₁ + Q₂ + Q₃ + Q₄ + Q₅ + Q₆ − Q₇/42; each Q at its line below.
fn order_8<G: LieAlgebra>(g: &G, h: G::Scalar, a: &[G::Alg; 4], work: &mut [G::Alg; 14]) {
    let lit = G::Scalar::lit;
    let [omega, b0, b1, b2, b3, q1, q2, q3, q4, q5, q6, q7, x, y] = work;
    for (b, moment) in [&mut *b0, b1, b2, b3].into_iter().zip(&MOMENTS) {
        g.combine(h, moment, a, b);
    }
    // Q₁ = [−38/5 B₀ + 24 B₂, B₃]
    sum(g, [(lit(-7.6), b0), (lit(24.0), b2)], x);
    g.bracket(x, b3, q1);
    // Q₂ = [63/5 B₀ − 84 B₂, −5/28 B₁ + B₃]
    sum(g, [(lit(12.6), b0), (lit(-84.0), b2)], x);
    sum(g, [(lit(-5.0 / 28.0), b1), (lit(1.0), b3)], y);
    g.bracket(x, y, q2);
    // Q₃ = [19/28 B₀ − 15/7 B₂, [B₀, B₂ + 61/588 Q₁ − 1/12 Q₂]]
    sum(g, [(lit(1.0), b2), (lit(61.0 / 588.0), q1), (lit(-1.0 / 12.0), q2)], x);
    g.bracket(b0, x, y);
    sum(g, [(lit(19.0 / 28.0), b0), (lit(-15.0 / 7.0), b2)], x);
    g.bracket(x, y, q3);
    // Q₄ = [B₃, 20/7 Q₁ + 10 Q₂]
    sum(g, [(lit(20.0 / 7.0), q1), (lit(10.0), q2)], x);
    g.bracket(b3, x, q4);
    // Q₅ = [−6025/4116 B₀ + 2875/343 B₂, [B₂, Q₁]]
    g.bracket(b2, q1, y);
    sum(g, [(lit(-6025.0 / 4116.0), b0), (lit(2875.0 / 343.0), b2)], x);
    g.bracket(x, y, q5);
    // Q₆ = [B₃, 20/7 (Q₃ + Q₄) + 820/189 Q₅]
    sum(g, [(lit(20.0 / 7.0), q3), (lit(20.0 / 7.0), q4), (lit(820.0 / 189.0), q5)], x);
    g.bracket(b3, x, q6);
    // Q₇ = [B₀, [B₀, Q₃ − Q₄/3 + Q₅]]
    sum(g, [(lit(1.0), q3), (lit(-1.0 / 3.0), q4), (lit(1.0), q5)], x);
    g.bracket(b0, x, y);
    g.bracket(b0, y, q7);
    let one = lit(1.0);
    let terms = [(one, &*b0), (one, q1), (one, q2), (one, q3), (one, q4), (one, q5), (one, q6)];
    sum(g, terms, omega);
    g.axpy(lit(-1.0 / 42.0), q7, omega);
}
