//! Laws of a group action Λ and of the charts λ_p = Λ_p ∘ Ψ.

use faer::Mat;
use faer::prelude::Solve;
use lieflow::actions::Coadjoint;
use lieflow::chart::ChartStore;
use lieflow::groups::{MatrixGroup, Sample};
use lieflow::maps::Exp;
use lieflow::problems::Problem;
use lieflow::space::{LinearSpace, Metric};
use lieflow::{Action, CoordinateMap, LieGroup};
use rand_pcg::Pcg64;

use super::super::points::Points;
use super::super::represent::Represent;
use super::{EPS, Verdict, within};
use crate::support::{gap, size};

/// Roundings of one Λ(g, p), per ε·(the sizes of what it multiplies): up to four products and a solve.
const C_ACT: f64 = 8.0;

/// Λ(𝟙, p) = p and Λ(ab, p) = Λ(a, Λ(b, p)).
pub(crate) fn action<G: Represent, A: Points<G>>(
    group: &G,
    action: &A,
    rng: &mut Pcg64,
) -> Verdict {
    let (a, b) = (group.sample_element(rng), group.sample_element(rng));
    let p = action.draw(group, rng);
    let numbers = |p: &A::Point| action.numbers(group, p);
    let act = |g: &G::Elem, p: &A::Point| {
        let (mut q, mut work) = (p.clone(), action.work(group));
        action.act(group, g, p, &mut q, &mut work);
        q
    };
    let unit = 4.0 * C_ACT * EPS * numbers(&p).norm_l2();
    within("Λ(𝟙, p) = p", gap(&numbers(&act(&group.identity(), &p)), &numbers(&p)), unit)?;
    let once = act(&group.product(&a, &b), &p);
    let twice = act(&a, &act(&b, &p));
    // An action is linear in g or has g⁻¹ beside it.
    let size = spread(group, &a) * spread(group, &b);
    within("Λ(ab, p) = Λ(a, Λ(b, p))", gap(&numbers(&once), &numbers(&twice)), unit * size)
}

/// The step of the central differences of [`generator`]: rounding over ε and ε⁴ are then of one size.
const STEP: f64 = 1.0 / 256.0;

/// λ_*(v)(y) is the derivative of ε ↦ Λ(exp(εv), y) at 0, by central differences with ε and ε/2 that
/// leave an error of ε⁴|v|⁵; and λ_*(v + aw)(y) = λ_*(v)(y) + a λ_*(w)(y).
pub(crate) fn generator<G, A>(group: &G, action: &A, y: &A::Point, rng: &mut Pcg64) -> Verdict
where
    G: Sample<Scalar = f64>,
    A: Action<G, Point: LinearSpace<Scalar = f64>>,
    Exp: CoordinateMap<G>,
{
    let draw = |rng: &mut Pcg64| {
        let (u, mut v) = (group.sample_algebra(rng, 1.0), group.zero());
        group.axpy(1.0 / group.norm(&u), &u, &mut v);
        v
    };
    let (v, w, a) = (draw(rng), draw(rng), -0.7);
    let mut work = action.work(group);
    let mut generate = |v: &G::Alg| {
        let mut dy = y.clone();
        action.generate(group, v, y, &mut dy, &mut work);
        dy
    };
    let (of_v, of_w) = (generate(&v), generate(&w));
    // The Riccati action is of degree 2 in y, the others of degree 1.
    let size = (1.0 + y.size()).powi(2);

    let mut work = action.work(group);
    let mut moved = |epsilon: f64| -> Result<A::Point, String> {
        let (mut u, mut q) = (group.zero(), y.clone());
        group.axpy(epsilon, &v, &mut u);
        let g = Exp.eval(group, &u).map_err(|e| e.to_string())?;
        action.act(group, &g, y, &mut q, &mut work);
        Ok(q)
    };
    let mut derivative = y.clone();
    derivative.clear();
    for (epsilon, weight) in [(STEP, -1.0 / 3.0), (0.5 * STEP, 4.0 / 3.0)] {
        derivative.add(0.5 * weight / epsilon, &moved(epsilon)?);
        derivative.add(-0.5 * weight / epsilon, &moved(-epsilon)?);
    }
    let bound = (4.0 * C_ACT * EPS / STEP + STEP.powi(4)) * size;
    within("λ_*(v)(y) = d/dε Λ(exp(εv), y)", derivative.distance(&of_v), bound)?;

    let mut both = v.clone();
    group.axpy(a, &w, &mut both);
    let (together, mut apart) = (generate(&both), of_v);
    apart.add(a, &of_w);
    let bound = C_ACT * EPS * size;
    within("λ_* is linear in v", together.distance(&apart), bound)
}

/// The formula of λ_* is that of matrices in [`Points::generator`].
pub(crate) fn generator_of_matrices<G, A>(group: &G, action: &A, rng: &mut Pcg64) -> Verdict
where
    G: Represent,
    A: Points<G, Point: LinearSpace<Scalar = f64>>,
    Exp: CoordinateMap<G>,
{
    let (v, y) = (group.of_size(rng, 1.0), action.draw(group, rng));
    let (mut dy, mut zero) = (y.clone(), y.clone());
    action.generate(group, &v, &y, &mut dy, &mut action.work(group));
    zero.clear();
    // The numbers of a point may be affine in it, as \[R x; 0 1\] is.
    let ours = action.numbers(group, &dy) - action.numbers(group, &zero);
    let expected = action.generator(group, &group.algebra_matrix(&v), &y);
    let bound = C_ACT * EPS * (1.0 + action.numbers(group, &y).norm_l2());
    within("λ_*(v)(y) of matrices", gap(&ours, &expected), bound)?;
    generator(group, action, &y, rng)
}

/// ‖g‖·‖g⁻¹‖, which bounds how much an action on g and g⁻¹ stretches.
fn spread<G: Represent>(group: &G, g: &G::Elem) -> f64 {
    let g = group.element_matrix(g);
    g.norm_l2() * inverse(&g).norm_l2()
}

fn inverse(g: &Mat<f64>) -> Mat<f64> {
    g.partial_piv_lu().solve(Mat::<f64>::identity(g.nrows(), g.nrows()))
}

/// A field that is never asked: it carries a group and an action into a chart.
struct Still<'a, G, A>(&'a G, &'a A);

impl<G: LieGroup, A: Action<G>> Problem for Still<'_, G, A> {
    type Group = G;
    type Action = A;
    type Work = ();
    fn group(&self) -> &G {
        self.0
    }
    fn action(&self) -> &A {
        self.1
    }
    fn work(&self) {}
    fn f(&self, _: G::Scalar, _: &A::Point, v: &mut G::Alg, _: &mut ()) {
        self.0.set_zero(v);
    }
}

/// λ_p(u) by the chart is Λ(Ψ(u), p).
pub(crate) fn lambda<G: Represent, Psi: CoordinateMap<G>, A: Points<G>>(
    group: &G,
    psi: &Psi,
    action: &A,
    cap: f64,
    rng: &mut Pcg64,
) -> Verdict {
    let size = size(rng, cap);
    let (u, p) = (group.of_size(rng, size), action.draw(group, rng));
    let still = Still(group, action);
    let mut store = ChartStore::new(&still, psi, &p).map_err(|e| e.to_string())?;
    let mut by_chart = p.clone();
    store.around(&still, psi, 0, &p).lambda(&u, &mut by_chart).map_err(|e| e.to_string())?;
    let g = psi.eval(group, &u).map_err(|e| e.to_string())?;
    let (mut by_element, mut work) = (p.clone(), action.work(group));
    action.act(group, &g, &p, &mut by_element, &mut work);
    let numbers = |p: &A::Point| action.numbers(group, p);
    let bound = C_ACT * EPS * spread(group, &g) * numbers(&p).norm_l2();
    within("λ_p(u) = Λ(Ψ(u), p)", gap(&numbers(&by_chart), &numbers(&by_element)), bound)
}

/// ⟨Λ(g, m), v⟩ = ⟨m, g⁻¹vg⟩ on the dual of a matrix algebra: Λ is the coadjoint action.
pub(crate) fn coadjoint_pairing<A: Action<MatrixGroup, Point = Mat<f64>>>(
    group: &MatrixGroup,
    action: &A,
    rng: &mut Pcg64,
) -> Verdict {
    let g = group.sample_element(rng);
    let m = crate::support::gaussian(rng, group.n(), group.n());
    let v = group.sample_algebra(rng, 1.0).into_mat();
    let (mut q, mut work) = (m.clone(), action.work(group));
    action.act(group, &g, &m, &mut q, &mut work);
    let pairing = |m: &Mat<f64>, v: &Mat<f64>| -> f64 {
        (0..v.ncols()).flat_map(|j| (0..v.nrows()).map(move |i| m[(i, j)] * v[(i, j)])).sum()
    };
    let pulled = inverse(&g) * &v * g.as_ref();
    let bound = C_ACT * EPS * spread(group, &g) * m.norm_l2() * v.norm_l2();
    within("⟨Λ(g,m),v⟩ = ⟨m,g⁻¹vg⟩", (pairing(&q, &v) - pairing(&m, &pulled)).abs(), bound)
}

/// tr(mᵏ), k = 1 … n, the Casimirs, are constant on a coadjoint orbit.
pub(crate) fn coadjoint_spectrum(group: &MatrixGroup, rng: &mut Pcg64) -> Verdict {
    let (g, n) = (group.sample_element(rng), group.n());
    // tr of an odd power of a skew matrix is zero: a general m has them all.
    let m = Coadjoint.draw(group, rng);
    let (mut q, mut work) = (m.clone(), Coadjoint.work(group));
    Coadjoint.act(group, &g, &m, &mut q, &mut work);
    let (mut before, mut after) = (Mat::<f64>::identity(n, n), Mat::<f64>::identity(n, n));
    for k in 1..=n {
        (before, after) = (&before * &m, &after * &q);
        let trace = |x: &Mat<f64>| (0..n).map(|i| x[(i, i)]).sum::<f64>();
        let size = spread(group, &g) * q.norm_l2().max(m.norm_l2()).powi(k as i32);
        let bound = C_ACT * EPS * k as f64 * size;
        within(&format!("tr(m^{k})"), (trace(&before) - trace(&after)).abs(), bound)?;
    }
    Ok(())
}
