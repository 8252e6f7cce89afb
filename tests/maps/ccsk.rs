//! Coordinates of the second kind on SO(n), GL(n) and Sp(2m): the group, the differential, and the
//! order of a method with them.

use faer::{Mat, mat};
use lieflow::actions::LeftTranslation;
use lieflow::groups::{AlgebraMatrix, MatrixGroup, Sample};
use lieflow::maps::{CCSK, CCSK123, CCSK321, CoordinateMap as Map, Exp, Pade22};
use lieflow::methods::{Rkmk, tableau::RK4};
use lieflow::problems::Flow;
use lieflow::{LieAlgebra, LieGroup, Problem, SaveAt, TimeGrid, integrate};
use rand::SeedableRng;
use rand_pcg::Pcg64;

const EPS: f64 = f64::EPSILON;

fn groups() -> Vec<MatrixGroup> {
    let so = [2, 4, 5].map(MatrixGroup::so);
    let gl = [1, 2, 3, 6].map(MatrixGroup::gl);
    let sp = [2, 4, 6].map(MatrixGroup::sp);
    so.into_iter().chain(gl).chain(sp).map(|g| g.expect("a group")).collect()
}

/// d/dε Ψ(u + εw) = v·Ψ(u) for w = dΨ_u⁻¹ v, by central differences extrapolated to order 6; Ψ on
/// the group; the orderings the inverses of each other.
fn differential<Psi: Map<MatrixGroup>>(psi: &Psi, group: &MatrixGroup, rng: &mut Pcg64) {
    for _ in 0..10 {
        let (u, v) = (group.sample_algebra(rng, 0.4), group.sample_algebra(rng, 1.0));
        let case = format!("{} on {}", psi.name(), group.name());
        let g = psi.eval(group, &u).expect("Ψ(u)");
        let size = 1.0 + g.norm_l2();
        assert!(group.defect(&g) <= 8.0 * EPS * size * size, "{case}: {:e}", group.defect(&g));
        let w = psi.eval_dpsi_inv(group, &u, &v).expect("dΨ⁻¹");
        assert!(group.algebra_within(w.clone().into_mat(), 16.0 * EPS).is_ok(), "{case}");
        let at = |h: f64| {
            let mut moved = u.clone();
            group.axpy(h, &w, &mut moved);
            psi.eval(group, &moved).expect("Ψ(u)").into_mat()
        };
        let h = 1e-2 / (1.0 + w.norm_l2());
        let slope = |h: f64| (at(h) - at(-h)) * faer::Scale(0.5 / h);
        // Richardson: (64 S(h/4) − 20 S(h/2) + S(h))/45.
        let total = slope(0.25 * h) * faer::Scale(64.0 / 45.0)
            - slope(0.5 * h) * faer::Scale(20.0 / 45.0)
            + slope(h) * faer::Scale(1.0 / 45.0);
        let gap = (total - v.as_ref() * g.as_ref()).norm_l2();
        let bound = 1e-9 * size * (1.0 + w.norm_l2());
        assert!(gap <= bound, "{case}: {gap:e} of {bound:e}");
    }
}

#[test]
fn differentials() {
    let mut rng = Pcg64::seed_from_u64(31);
    for group in groups() {
        differential(&CCSK321, &group, &mut rng);
        differential(&CCSK123, &group, &mut rng);
        let u = group.sample_algebra(&mut rng, 0.4);
        let mut minus = group.zero();
        group.axpy(-1.0, &u, &mut minus);
        let forward = CCSK123.eval(&group, &u).expect("Ψ(u)");
        let back = CCSK321.eval(&group, &minus).expect("Ψ(−u)");
        let mut product = group.identity();
        group.compose(&forward, &back, &mut product);
        let gap = group.distance(&product, &group.identity());
        assert!(gap <= 16.0 * EPS * forward.norm_l2() * back.norm_l2(), "{}", group.name());
        // Ψ(0) = 𝟙 and dΨ₀ = id, exactly.
        let zero = group.zero();
        assert_eq!(CCSK321.eval(&group, &zero).expect("Ψ(0)"), group.identity());
        assert_eq!(CCSK321.eval_dpsi_inv(&group, &zero, &u).expect("dΨ₀"), u);
        assert_eq!(CCSK123.eval_dpsi_inv(&group, &zero, &u).expect("dΨ₀"), u);
    }
    let lorentz = MatrixGroup::indefinite(3, 1).expect("SO(3,1)");
    assert!(CCSK321.at(&lorentz).is_err());
    let gl1 = MatrixGroup::gl(1).expect("GL(1)");
    assert!(CCSK321.eval(&gl1, &AlgebraMatrix::new_unchecked(faer::mat![[1e4]])).is_err());
}

fn run<P, Psi>(flow: &P, psi: Psi, steps: u64) -> Mat<f64>
where
    P: Problem<Group = MatrixGroup, Action = LeftTranslation>,
    Psi: Map<MatrixGroup>,
{
    let mut g = flow.group().identity();
    let grid = TimeGrid::with_steps([0.0, 1.0], steps).expect("a grid");
    integrate(flow, &Rkmk::new(RK4, psi), &grid, &SaveAt::Ends, &mut g, |_, _| {}).expect("a run");
    g.into_mat()
}

/// RKMK4 keeps its order 4 with each map, on each group: the last two pairwise slopes.
#[test]
fn order_of_rkmk4() {
    for group in [MatrixGroup::gl(3), MatrixGroup::sp(4), MatrixGroup::so(5), MatrixGroup::so(4)] {
        let group = group.expect("a group");
        let mut rng = Pcg64::seed_from_u64(32);
        let parts = [(); 3].map(|()| group.sample_algebra(&mut rng, 0.4));
        // ġ = A(t, g) g: non-commuting, in time and in g.
        let algebra = group.clone();
        let flow = Flow::new(group, LeftTranslation, move |t: f64, g, v| {
            algebra.set_zero(v);
            let weights = [(1.3 * t).cos() * g[(0, 0)], (g[(0, 1)] + t).sin(), g[(1, 0)].tanh()];
            for (w, part) in weights.into_iter().zip(&parts) {
                algebra.axpy(w, part, v);
            }
        });
        let exact = run(&flow, Exp, 2048);
        macro_rules! check {
            ($($psi:expr),*) => {$({
                let errors = [16, 32, 64].map(|n| (run(&flow, $psi, n) - &exact).norm_l2());
                let slopes = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
                let name = Map::<MatrixGroup>::name(&$psi);
                println!("{:6} {name:8} {errors:?} {slopes:.2?}", flow.group().name());
                assert!(slopes.iter().all(|s| (s - 4.0).abs() < 0.3), "{name} {slopes:?}");
            })*};
        }
        check!(CCSK321, CCSK123, CCSK, Pade22);
    }
}

/// Large u, whose Ψ(u) is badly conditioned: each entry has its digits. The references have 60 digits.
#[test]
fn the_reversed_ordering_of_large_u() {
    let near = |found: &AlgebraMatrix, expected: &Mat<f64>| {
        for j in 0..expected.ncols() {
            for i in 0..expected.nrows() {
                let (x, right) = (found[(i, j)], expected[(i, j)]);
                assert!((x - right).abs() < 1e-11 * right.abs(), "({i},{j}): {x:e}, {right:e}");
            }
        }
    };
    let gl = MatrixGroup::gl(3).expect("a group");
    let u = gl.algebra(mat![[3.0, -7.0, 1.0], [7.0, -2.0, 5.0], [-4.0, 6.0, -9.0]]).expect("u");
    let w = gl.algebra(mat![[1.0, 2.0, -1.0], [3.0, -1.0, 0.5], [0.25, -2.0, 4.0]]).expect("w");
    near(
        &CCSK123.eval_dpsi_inv(&gl, &u, &w).expect("dΨ⁻¹"),
        &mat![
            [-23.0, -0.026951787996341868387, 0.04786765897925877271],
            [176.0, 30.0, 0.00683911474165887156],
            [-1.75, -6.0, -3.0]
        ],
    );
    let sp = MatrixGroup::sp(4).expect("a group");
    let element = |a: [[f64; 2]; 2], b: [[f64; 2]; 2], c: [[f64; 2]; 2]| {
        let entries = Mat::from_fn(4, 4, |i, j| match (i < 2, j < 2) {
            (true, true) => a[i][j],
            (true, false) => b[i][j - 2],
            (false, true) => c[i - 2][j],
            (false, false) => -a[j - 2][i - 2],
        });
        sp.algebra(entries).expect("u")
    };
    let u =
        element([[4.0, -6.0], [5.0, -7.0]], [[3.0, -8.0], [-8.0, 2.0]], [[-9.0, 4.0], [4.0, 6.0]]);
    let w =
        element([[1.0, 2.0], [-3.0, 0.5]], [[2.0, -1.0], [-1.0, 4.0]], [[0.25, 3.0], [3.0, -2.0]]);
    near(
        &CCSK123.eval_dpsi_inv(&sp, &u, &w).expect("dΨ⁻¹"),
        &mat![
            [-1.0, 0.000066806803160982637251, 2770797619.4254427604, 461799824.17836812759],
            [129.5, 0.5, 461799824.17836812759, 76966674.186545713776],
            [-255.75, -29.0, 1.0, -129.5],
            [-29.0, -152.0, -0.000066806803160982637251, -0.5]
        ],
    );
}
