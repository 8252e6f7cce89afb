//! SO(n), GL(n), Sp(4) and SO(3,1) in numbers of 32 digits: what `MatrixGroup` is in `f64`, from the
//! definitions, without a care for speed.
//!
//! M is 𝟙, J or diag(1, 1, 1, −1): a permutation with signs, M e_j = s_j e_p(j), so that
//! x♯ = M⁻¹xᵀM has the entries s_i s_j x_{p(j) p(i)}.

use lieflow::groups::RESIDUAL_MAX;
use lieflow::methods::{Metric, SeriesGroup};
use lieflow::problems::LinearSpace;
use lieflow::scalar::Real;
use lieflow::{LieAlgebra, LieGroup};

use super::D;
use super::fields::Wide;
use super::square::Square;

/// One of the groups.
#[derive(Clone)]
pub(crate) struct Matrices {
    name: &'static str,
    n: usize,
    /// (p(j), s_j), or that there is no M.
    form: Option<Vec<(usize, f64)>>,
    /// The entries that determine u ∈ 𝔤: its coordinates.
    coordinates: Vec<(usize, usize)>,
    /// The e_k with u = Σ u_k e_k.
    basis: Vec<Square>,
    /// Is the basis that of ccsk, in its order?
    ordered: bool,
}

impl Matrices {
    fn new(
        name: &'static str,
        n: usize,
        form: Option<Vec<(usize, f64)>>,
        coordinates: Vec<(usize, usize)>,
    ) -> Self {
        let basis = Vec::new();
        let mut group = Matrices { name, n, form, coordinates, basis, ordered: true };
        for &at in &group.coordinates {
            let unit = Square::from_fn(n, |i, j| D::lit(f64::from(u8::from((i, j) == at))));
            let e = group.adjoint(&unit).map_or(unit, |adjoint| unit - adjoint);
            group.basis.push(e * (D::lit(1.0) / e[at]));
        }
        group
    }

    /// SO(5): e_r e_cᵀ − e_c e_rᵀ by columns.
    pub(crate) fn so5() -> Self {
        let form = (0..5).map(|j| (j, 1.0)).collect();
        Self::new("SO(5)", 5, Some(form), below(5))
    }
    /// GL(3): (𝟙 + U₊)·D·(𝟙 + U₋).
    pub(crate) fn gl3() -> Self {
        Self::new("GL(3)", 3, None, triangles(3))
    }
    /// Sp(4): \[𝟙 B; 0 𝟙\]·diag(L, L⁻ᵀ)·\[𝟙 0; C 𝟙\].
    pub(crate) fn sp4() -> Self {
        let form = vec![(2, -1.0), (3, -1.0), (0, 1.0), (1, 1.0)];
        let mut entries = vec![(0, 2), (0, 3), (1, 3)];
        entries.extend(triangles(2));
        entries.extend([(2, 0), (3, 0), (3, 1)]);
        Self::new("Sp(4)", 4, Some(form), entries)
    }
    /// SO(3,1), on which there is no ccsk.
    pub(crate) fn so31() -> Self {
        let form = (0..4).map(|j| (j, if j < 3 { 1.0 } else { -1.0 })).collect();
        Matrices { ordered: false, ..Self::new("SO(3,1)", 4, Some(form), below(4)) }
    }

    pub(crate) fn n(&self) -> usize {
        self.n
    }
    /// The coordinates of u.
    pub(crate) fn coordinates(&self, u: &Square) -> impl Iterator<Item = D> {
        self.coordinates.iter().map(|&at| u[at])
    }
    /// The basis in the order of ccsk, where it is one.
    pub(crate) fn ordered_basis(&self) -> Option<&[Square]> {
        self.ordered.then_some(&self.basis)
    }

    /// M⁻¹xᵀM.
    fn adjoint(&self, x: &Square) -> Option<Square> {
        let form = self.form.as_ref()?;
        Some(Square::from_fn(self.n, |i, j| {
            let ((p, s), (q, r)) = (form[i], form[j]);
            x[(q, p)] * D::lit(s * r)
        }))
    }

    /// g⁻¹: g♯, or by solving.
    pub(crate) fn inverse(&self, g: &Square) -> Square {
        self.adjoint(g).unwrap_or_else(|| g.solve(Square::identity(self.n)))
    }
    /// The part of x in 𝔤: (x − x♯)/2, or x.
    pub(crate) fn project(&self, x: &Square) -> Square {
        self.adjoint(x).map_or(*x, |adjoint| (*x - adjoint) * D::lit(0.5))
    }

    /// 𝟙 − g♯g, or 0.
    fn residual(&self, g: &Square) -> Square {
        match self.adjoint(g) {
            Some(adjoint) => Square::identity(self.n) - adjoint * *g,
            None => Square::zero(self.n),
        }
    }
}

/// The entries below the diagonal, by columns.
fn below(n: usize) -> Vec<(usize, usize)> {
    (0..n).flat_map(|c| (c + 1..n).map(move |r| (r, c))).collect()
}

/// Those above the diagonal from the last column on, the diagonal, those below it: in this order
/// ∏ exp(u_rc e_r e_cᵀ) is (𝟙 + U₊)·D·(𝟙 + U₋), since no product of two factors adds a term.
fn triangles(n: usize) -> Vec<(usize, usize)> {
    let above = (0..n).rev().flat_map(|c| (0..c).map(move |r| (r, c)));
    above.chain((0..n).map(|i| (i, i))).chain(below(n)).collect()
}

impl LieAlgebra for Matrices {
    type Scalar = D;
    type Alg = Square;

    fn name(&self) -> String {
        self.name.into()
    }
    fn dim(&self) -> usize {
        self.basis.len()
    }
    fn zero(&self) -> Square {
        Square::zero(self.n)
    }
    fn set_zero(&self, u: &mut Square) {
        *u = self.zero();
    }
    fn axpy(&self, a: D, x: &Square, y: &mut Square) {
        LinearSpace::add(y, a, x);
    }
    /// uv − vu, where vu = (uv)♯ if there is an M.
    fn bracket(&self, u: &Square, v: &Square, out: &mut Square) {
        let product = *u * *v;
        *out = product - self.adjoint(&product).unwrap_or_else(|| *v * *u);
    }
    fn norm(&self, u: &Square) -> D {
        u.size()
    }
    fn is_finite(&self, u: &Square) -> bool {
        LinearSpace::is_finite(u)
    }
}

impl LieGroup for Matrices {
    type Elem = Square;
    type Vector = Square;

    fn identity(&self) -> Square {
        Square::identity(self.n)
    }
    fn compose(&self, a: &Square, b: &Square, out: &mut Square) {
        *out = *a * *b;
    }
    fn apply(&self, g: &Square, x: &Square, y: &mut Square) {
        *y = *g * *x;
    }
    fn tangent(&self, u: &Square, g: &Square, out: &mut Square) {
        *out = *u * *g;
    }
    fn apply_algebra(&self, u: &Square, x: &Square, y: &mut Square) {
        *y = *u * *x;
    }
    fn distance(&self, a: &Square, b: &Square) -> D {
        Metric::distance(a, b)
    }
    fn defect(&self, g: &Square) -> D {
        self.residual(g).size()
    }
    /// g ← g + g(𝟙 − g♯g)/2, until that is rounding.
    fn correct(&self, g: &mut Square, _: [&mut Square; 2]) -> D {
        let found = self.residual(g);
        let mut residual = found;
        while (1e-30..RESIDUAL_MAX).contains(&residual.size().value()) {
            *g = *g + *g * residual * D::lit(0.5);
            residual = self.residual(g);
        }
        found.size()
    }
}

impl SeriesGroup for Matrices {
    fn clear(&self, x: &mut Square) {
        LinearSpace::clear(x);
    }
    fn scale(&self, a: D, x: &mut Square) {
        *x = *x * a;
    }
    fn add(&self, x: &Square, y: &mut Square) {
        *y = *y + *x;
    }
    fn add_algebra(&self, a: D, u: &Square, out: &mut Square) {
        LinearSpace::add(out, a, u);
    }
    fn add_product(&self, a: D, u: &Square, x: &Square, from_right: bool, out: &mut Square) {
        let product = if from_right { *x * *u } else { *u * *x };
        LinearSpace::add(out, a, &product);
    }
    fn size(&self, x: &Square) -> D {
        x.size()
    }
}

impl Wide for Matrices {
    fn algebra(&self, next: &mut dyn FnMut() -> D) -> Square {
        let mut u = self.zero();
        for e in &self.basis {
            let x = next();
            e.nonzero().for_each(|at| u[at] += x * e[at]);
        }
        u
    }
}
