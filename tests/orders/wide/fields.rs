//! One family of fields for every group: with the numbers x of g, the coordinates of f(t, g) ∈ 𝔤 are
//! strength·(w₀ a + w₁ b + w₂ C x), with a, b and C drawn from [−1, 1] and
//!
//! | | w₀ | w₁ | w₂ |
//! |---|---|---|---|
//! | wave | cos 1.3t · x₀ | sin(x₁ + t) | cos t |
//! | clock | cos 1.3t | sin t | 0 |
//! | polynomial | t | 1 | ½ |
//!
//! Each number of g is in each coordinate: the parts of a product are coupled.

use lieflow::LieGroup;
use lieflow::actions::LeftTranslation;
use lieflow::groups::{Power, Product, Se3, So3, Translations};
use lieflow::problems::{Flow, LinearField, LinearSpace, Problem, TaylorField};
use lieflow::scalar::{Real, Trig};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::D;
use super::members::Numbers;

/// A group in numbers of 32 digits.
pub(crate) trait Wide:
    LieGroup<Scalar = D, Elem: LinearSpace<Scalar = D> + Numbers> + Clone
{
    /// u ∈ 𝔤 whose coordinates are what `next` returns, one after the other.
    fn algebra(&self, next: &mut dyn FnMut() -> D) -> Self::Alg;
}

fn draw(next: &mut dyn FnMut() -> D) -> Vector3<D> {
    Vector3::from_fn(|_, _| next())
}

impl Wide for So3<D> {
    fn algebra(&self, next: &mut dyn FnMut() -> D) -> Vector3<D> {
        draw(next)
    }
}
/// (ω, v)·(R, x) = (ω̂R, ω × x + v).
impl Wide for Se3<D> {
    fn algebra(&self, next: &mut dyn FnMut() -> D) -> Self::Alg {
        (draw(next), draw(next))
    }
}
impl Wide for Translations<Vector3<D>> {
    fn algebra(&self, next: &mut dyn FnMut() -> D) -> Vector3<D> {
        draw(next)
    }
}
impl<A: Wide, B: Wide> Wide for Product<A, B> {
    fn algebra(&self, next: &mut dyn FnMut() -> D) -> Self::Alg {
        (self.0.algebra(next), self.1.algebra(next))
    }
}
impl<G: Wide> Wide for Power<G> {
    fn algebra(&self, next: &mut dyn FnMut() -> D) -> Self::Alg {
        (0..self.copies()).map(|_| self.group().algebra(next)).collect()
    }
}

/// Which of the fields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    Wave,
    Clock,
    Polynomial,
}

/// ġ = f(t, g) g.
pub(crate) struct CoupledField<G: Wide> {
    group: G,
    kind: Kind,
    strength: D,
    a: Vec<D>,
    b: Vec<D>,
    /// By rows, one for each coordinate.
    c: Vec<D>,
}

impl<G: Wide> CoupledField<G> {
    /// The field of this kind and seed, and where it starts: 𝟙.
    pub(crate) fn new(group: &G, kind: Kind, strength: f64, seed: u64) -> (Self, G::Elem) {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut numbers =
            |count| (0..count).map(|_| D::lit(rng.random_range(-1.0..1.0))).collect::<Vec<_>>();
        let (start, dim) = (group.identity(), group.dim());
        let (a, b) = (numbers(dim), numbers(dim));
        let c = numbers(dim * start.numbers().len());
        (CoupledField { group: group.clone(), kind, strength: D::lit(strength), a, b, c }, start)
    }

    fn f(&self, weights: [D; 3], x: &[D]) -> G::Alg {
        let [w0, w1, w2] = weights.map(|w| self.strength * w);
        let mut k = 0;
        self.group.algebra(&mut || {
            let mut sum = w0 * self.a[k] + w1 * self.b[k];
            if w2 != D::lit(0.0) {
                let row = self.c[k * x.len()..].iter().zip(x);
                sum += w2 * row.fold(D::lit(0.0), |sum, (c, x)| sum + *c * *x);
            }
            k += 1;
            sum
        })
    }

    fn at(&self, t: D, g: &G::Elem) -> G::Alg {
        let x = g.numbers();
        let cos_fast = || (D::lit(1.3) * t).sin_cos().1;
        self.f(
            match self.kind {
                Kind::Wave => [cos_fast() * x[0], (x[1] + t).sin_cos().0, t.sin_cos().1],
                Kind::Clock => [cos_fast(), t.sin_cos().0, D::lit(0.0)],
                Kind::Polynomial => [t, D::lit(1.0), D::lit(0.5)],
            },
            &x,
        )
    }
}

impl<G: Wide> Problem for CoupledField<G> {
    type Group = G;
    type Action = LeftTranslation;
    type Work = ();
    fn group(&self) -> &G {
        &self.group
    }
    fn action(&self) -> &LeftTranslation {
        &LeftTranslation
    }
    fn work(&self) {}
    fn f(&self, t: D, g: &G::Elem, v: &mut G::Alg, (): &mut ()) {
        *v = self.at(t, g);
    }
}

/// For [`Kind::Clock`], which does not look at g.
impl<G: Wide> LinearField for CoupledField<G> {}

/// For [`Kind::Polynomial`]: k g_k = h Σ_{i+j=k−1} f_i g_j, and f_k from g_k and the coefficients of θᵏ in
/// t + θh and 1.
impl<G: Wide> TaylorField for CoupledField<G> {
    type Series = Vec<G::Elem>;

    fn series(&self, order: usize) -> Vec<G::Elem> {
        vec![self.group.identity(); order + 1]
    }
    fn coefficient(
        &self,
        [t, h]: [D; 2],
        g: &G::Elem,
        k: usize,
        f: &mut [G::Alg],
        series: &mut Vec<G::Elem>,
    ) {
        let mut next = g.clone();
        if k > 0 {
            let mut term = g.clone();
            next.clear();
            for (f, g) in f[..k].iter().rev().zip(&series[..k]) {
                self.group.tangent(f, g, &mut term);
                LinearSpace::add(&mut next, h / D::lit(k as f64), &term);
            }
        }
        let [time, constant] = match k {
            0 => [t, D::lit(1.0)],
            1 => [h, D::lit(0.0)],
            _ => [D::lit(0.0); 2],
        };
        f[k] = self.f([time, constant, D::lit(0.5)], &next.numbers());
        series[k] = next;
    }
}

/// A faster clock by its derivatives, and where it starts: w₀ = cos 3t and w₁ = sin 2t. So the last coefficient of a
/// series shows in its order, up to order 10.
pub(crate) fn fast_clock<G: Wide>(
    group: &G,
    strength: f64,
    seed: u64,
) -> (impl TaylorField<Group = G, Action = LeftTranslation>, G::Elem) {
    let (clock, start) = CoupledField::new(group, Kind::Clock, strength, seed);
    let field = move |t: D, k: usize, v: &mut G::Alg| {
        // A derivative turns (cos, sin) by a right angle.
        let turned = |(sin, cos): (D, D)| match k % 4 {
            0 => [cos, sin],
            1 => [-sin, cos],
            2 => [-cos, -sin],
            _ => [sin, -cos],
        };
        let [cos, sin] = [(3.0, 0), (2.0, 1)].map(|(rate, which)| {
            let wave = turned((D::lit(rate) * t).sin_cos())[which];
            (0..k).fold(wave, |wave, _| wave * D::lit(rate))
        });
        *v = clock.f([cos, sin, D::lit(0.0)], &[]);
    };
    (Flow::of_derivatives(group.clone(), LeftTranslation, field), start)
}
