//! Magnus methods with the Cayley map: y⁺ = cay(u) y, without an exponential.
//!
//! With u = Ω − Ω³/12 + Ω⁵/120 − …, cay(u) = exp(Ω). Order 4:
//! u = h/2 (A₁ + A₂) − h²√3/12 \[A₁, A₂\] − h³/96 (A₁ + A₂)³. Symmetric odd products of elements of
//! 𝔤_M, such as uvu, lie in 𝔤_M. [`TripleProduct`] computes them.
//! Source: A. Iserles, On Cayley-transform methods for the discretization of Lie-group equations,
//! Found. Comput. Math. 1 (2001).

use super::{GAUSS_2, GAUSS_3, MagnusWork, ROOT_15, magnus_method, sum};
use crate::error::{Error, StepError};
use crate::groups::{LieAlgebra, Power, Product, Se3, Se23, So3, Translations};
use crate::maps::{Cay, CoordinateMap};
use crate::methods::{Step, Symmetric};
use crate::problems::{PointOf, ScalarOf};
use crate::scalar::Real;
use crate::so3::cross;
use crate::space::LinearSpace;

use nalgebra::Vector3;

/// An algebra of matrices with uvw + wvu ∈ 𝔤: gl(n) and every 𝔤_M.
pub trait TripleProduct: LieAlgebra {
    /// out ← uvw + wvu; `work` is scratch.
    fn triple(
        &self,
        u: &Self::Alg,
        v: &Self::Alg,
        w: &Self::Alg,
        work: &mut Self::Alg,
        out: &mut Self::Alg,
    );
}

/// On so(3) ≅ ℝ³: −(u·v) w − (v·w) u.
impl<S: Real> TripleProduct for So3<S> {
    #[inline]
    fn triple(
        &self,
        u: &Vector3<S>,
        v: &Vector3<S>,
        w: &Vector3<S>,
        _: &mut Vector3<S>,
        out: &mut Vector3<S>,
    ) {
        let dot = |a: &Vector3<S>, b: &Vector3<S>| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (uv, vw) = (dot(u, v), dot(v, w));
        for i in 0..3 {
            out[i] = -(uv * w[i]) - vw * u[i];
        }
    }
}

/// On se(3), (a, x): the triple product of the rotations, and a × (b × z) + c × (b × x).
impl<S: Real> TripleProduct for Se3<S> {
    #[inline]
    fn triple(
        &self,
        u: &Self::Alg,
        v: &Self::Alg,
        w: &Self::Alg,
        work: &mut Self::Alg,
        out: &mut Self::Alg,
    ) {
        So3::new().triple(&u.0, &v.0, &w.0, &mut work.0, &mut out.0);
        let first = cross(&u.0, &cross(&v.0, &w.1));
        let second = cross(&w.0, &cross(&v.0, &u.1));
        out.1 = Vector3::from_fn(|i, _| first[i] + second[i]);
    }
}

/// On se₂(3): the same with both translations.
impl<S: Real> TripleProduct for Se23<S> {
    #[inline]
    fn triple(
        &self,
        u: &Self::Alg,
        v: &Self::Alg,
        w: &Self::Alg,
        work: &mut Self::Alg,
        out: &mut Self::Alg,
    ) {
        So3::new().triple(&u.0, &v.0, &w.0, &mut work.0, &mut out.0);
        let moved = |x: &Vector3<S>, z: &Vector3<S>| {
            let first = cross(&u.0, &cross(&v.0, z));
            let second = cross(&w.0, &cross(&v.0, x));
            Vector3::from_fn(|i, _| first[i] + second[i])
        };
        out.1 = (moved(&u.1.0, &w.1.0), moved(&u.1.1, &w.1.1));
    }
}

/// 0: as matrices \[0 v; 0 0\], translations have no product.
impl<V: LinearSpace> TripleProduct for Translations<V> {
    #[inline]
    fn triple(&self, _: &V, _: &V, _: &V, _: &mut V, out: &mut V) {
        out.clear();
    }
}

impl<A: TripleProduct, B: TripleProduct<Scalar = A::Scalar>> TripleProduct for Product<A, B> {
    #[inline]
    fn triple(
        &self,
        u: &Self::Alg,
        v: &Self::Alg,
        w: &Self::Alg,
        work: &mut Self::Alg,
        out: &mut Self::Alg,
    ) {
        self.0.triple(&u.0, &v.0, &w.0, &mut work.0, &mut out.0);
        self.1.triple(&u.1, &v.1, &w.1, &mut work.1, &mut out.1);
    }
}

impl<G: TripleProduct> TripleProduct for Power<G> {
    #[inline]
    fn triple(
        &self,
        u: &Self::Alg,
        v: &Self::Alg,
        w: &Self::Alg,
        work: &mut Self::Alg,
        out: &mut Self::Alg,
    ) {
        for (i, (work, out)) in work.iter_mut().zip(out).enumerate() {
            self.group().triple(&u[i], &v[i], &w[i], work, out);
        }
    }
}

/// The Magnus method of order 4 with the Cayley map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CayleyMagnus4;
/// The Magnus method of order 6 with the Cayley map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CayleyMagnus6;

magnus_method!(CayleyMagnus4, 4, GAUSS_2, Cay, 2, 4, [TripleProduct], order_4, 1);
magnus_method!(CayleyMagnus6, 6, GAUSS_3, Cay, 3, 9, [TripleProduct], order_6, 5);

impl Symmetric for CayleyMagnus4 {}
impl Symmetric for CayleyMagnus6 {}

fn order_4<G: TripleProduct>(g: &G, h: G::Scalar, a: &[G::Alg; 2], work: &mut [G::Alg; 4]) {
    let lit = G::Scalar::lit;
    let [omega, s, x, y] = work;
    g.combine(h, &[0.5, 0.5], a, s);
    sum(g, [(lit(1.0), s)], omega);
    g.bracket(&a[0], &a[1], x);
    g.axpy(h * h * lit(-super::ROOT_3 / 12.0), x, omega);
    g.triple(s, s, s, y, x); // 2s³ with s = h/2 (A₁ + A₂)
    g.axpy(lit(-1.0 / 24.0), x, omega);
}

/// With w₁ = hA₂, w₂ = h√15/3 (A₃ − A₁), w₃ = 10h/3 (A₁ − 2A₂ + A₃):
/// u/2 = w₁/2 + (w₃ − \[w₁, w₂\] − w₁³)/24 + (\[w₂, w₃\] − \[w₂, \[w₁, w₂\]\] − w₁²w₃ − w₃w₁² +
/// \[w₁w₂w₁, w₁\])/480 − w₁w₃w₁/160 + (\[w₁³, w₂\] + w₁⁵)/240.
fn order_6<G: TripleProduct>(g: &G, h: G::Scalar, a: &[G::Alg; 3], work: &mut [G::Alg; 9]) {
    let lit = G::Scalar::lit;
    let [u, w1, w2, w3, c, cube, x, y, z] = work;
    g.combine(h, &[0.0, 1.0, 0.0], a, w1);
    g.combine(h, &[-ROOT_15 / 3.0, 0.0, ROOT_15 / 3.0], a, w2);
    g.combine(h, &[10.0 / 3.0, -20.0 / 3.0, 10.0 / 3.0], a, w3);
    g.bracket(w1, w2, c);
    g.triple(w1, w1, w1, x, cube); // 2w₁³
    let twelfth = 1.0 / 12.0;
    sum(
        g,
        [(lit(1.0), w1), (lit(twelfth), w3), (lit(-twelfth), c), (lit(-0.5 * twelfth), cube)],
        u,
    );
    let mut add = |weight: f64, x: &G::Alg| g.axpy(lit(weight), x, u);
    let t = 1.0 / 240.0;
    g.bracket(w2, w3, x);
    add(t, x);
    g.bracket(w2, c, x);
    add(-t, x);
    g.triple(w1, w1, w3, y, x);
    add(-t, x);
    g.triple(w1, w2, w1, y, x); // 2w₁w₂w₁
    g.bracket(x, w1, y);
    add(0.5 * t, y);
    g.triple(w1, w3, w1, y, x); // 2w₁w₃w₁
    add(-1.5 * t, x);
    g.bracket(cube, w2, x);
    add(t, x);
    g.triple(w1, cube, w1, y, z); // 4w₁⁵
    add(0.5 * t, z);
}
