//! The laws of Ad, ad and their duals, on every group.

use faer::Mat;
use lieflow::actions::Coadjoint;
use lieflow::groups::{
    Adjoint, AlgebraMatrix, ComplexMatrix, GroupMatrix, MatrixGroup, Sample, So3, Translations,
    UnitQuaternions, Unitary,
};
use lieflow::maps::{Cay, CoordinateMap, Exp, dexp};
use lieflow::{Action, Error, LieAlgebra, LieGroup, StepError};
use nalgebra::Vector3;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// What rounding may do, in units of n·ε·size.
const LAW: f64 = 8.0;

/// A dual whose numbers can be drawn and compared.
trait Numbers: Clone {
    fn numbers(&self) -> Vec<f64>;
}
impl Numbers for Vector3<f64> {
    fn numbers(&self) -> Vec<f64> {
        self.as_slice().to_vec()
    }
}
impl Numbers for Mat<f64> {
    fn numbers(&self) -> Vec<f64> {
        self.col_iter().flat_map(|c| c.iter().copied().collect::<Vec<_>>()).collect()
    }
}

impl Numbers for ComplexMatrix {
    fn numbers(&self) -> Vec<f64> {
        [self.re.numbers(), self.im.numbers()].concat()
    }
}

fn gap(a: &impl Numbers, b: &impl Numbers) -> f64 {
    let square = a.numbers().iter().zip(b.numbers()).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    square.sqrt()
}

fn laws<G>(group: &G, rng: &mut impl Rng, dual: impl Fn(&G, &mut dyn FnMut() -> G::Alg) -> G::Dual)
where
    G: Adjoint<Scalar = f64> + Sample,
    G::Dual: Numbers,
    Exp: CoordinateMap<G>,
    Coadjoint: Action<G, Point = G::Dual>,
{
    let name = group.name();
    let n = (group.dim() as f64).max(3.0);
    let big_ad = |g: &G::Elem, u: &G::Alg| {
        let mut out = group.zero();
        group.big_ad(g, u, &mut out).expect("Ad");
        out
    };
    let ad = |u: &G::Alg, v: &G::Alg| {
        let mut out = group.zero();
        group.ad(u, v, &mut out);
        out
    };
    let difference = |a: &G::Alg, b: &G::Alg| {
        let mut d = a.clone();
        group.axpy(-1.0, b, &mut d);
        group.norm(&d)
    };
    for case in 0..40 {
        let [a, b] = [(); 2].map(|()| group.sample_element(rng));
        let [u, v] = [(); 2].map(|()| group.sample_algebra(rng, 1.0));
        let mut draw = || group.sample_algebra(rng, 1.0);
        let m = dual(group, &mut draw);
        let coad_group = |g: &G::Elem, m: &G::Dual| {
            let mut out = m.clone();
            group.coad_group(g, m, &mut out).expect("Ad*");
            out
        };
        let size = |g: &G::Elem| 1.0 + group.distance(g, &group.identity());
        // Ad multiplies by g and g⁻¹.
        let mut inverse = group.identity();
        group.inverse(&a, &mut inverse).expect("an inverse");
        let mut inverse_b = group.identity();
        group.inverse(&b, &mut inverse_b).expect("an inverse");
        let room = (size(&a) * size(&b) * size(&inverse) * size(&inverse_b)).powi(2);
        let unit = LAW * n * f64::EPSILON * room;
        let check = |law: &str, gap: f64, bound: f64| {
            assert!(gap <= bound, "{law} on {name}, case {case}: {gap:e} > {bound:e}");
        };

        // g g⁻¹ = 𝟙.
        let mut product = group.identity();
        group.compose(&a, &inverse, &mut product);
        check("inverse", group.distance(&product, &group.identity()), unit);
        // Ad_ab = Ad_a Ad_b.
        let mut ab = group.identity();
        group.compose(&a, &b, &mut ab);
        let both = big_ad(&a, &big_ad(&b, &u));
        check("Ad_ab = Ad_a Ad_b", difference(&big_ad(&ab, &u), &both), unit * group.norm(&u));
        // Ad_g [u, v] = [Ad_g u, Ad_g v].
        let left = big_ad(&a, &ad(&u, &v));
        let right = ad(&big_ad(&a, &u), &big_ad(&a, &v));
        let norms = group.norm(&u) * group.norm(&v);
        check("Ad_g is an automorphism", difference(&left, &right), unit * norms);
        // Ad*_a Ad*_b = Ad*_ba.
        let mut ba = group.identity();
        group.compose(&b, &a, &mut ba);
        let twice = coad_group(&a, &coad_group(&b, &m));
        let dual_size = gap(&m, &zero_like(&m)) * unit;
        check("Ad*_a Ad*_b = Ad*_ba", gap(&coad_group(&ba, &m), &twice), dual_size);
        // ⟨Ad*_g m, v⟩ = ⟨m, Ad_g v⟩, ⟨ad*_u m, v⟩ = ⟨m, [u, v]⟩.
        let pairing = group.pair(&coad_group(&a, &m), &v) - group.pair(&m, &big_ad(&a, &v));
        check("Ad* is dual to Ad", pairing.abs(), dual_size * group.norm(&v));
        let mut coad = m.clone();
        group.coad(&u, &m, &mut coad);
        let pairing = group.pair(&coad, &v) - group.pair(&m, &ad(&u, &v));
        check("ad* is dual to ad", pairing.abs(), dual_size * norms);
        // ⟨Ad*_{g⁻¹} m, Ad_g v⟩ = ⟨m, v⟩.
        let invariant = group.pair(&coad_group(&inverse, &m), &big_ad(&a, &v)) - group.pair(&m, &v);
        check("the pairing is invariant", invariant.abs(), dual_size * group.norm(&v));
        // Λ(g, m) = Ad*_{g⁻¹} m.
        let mut acted = m.clone();
        Coadjoint.act(group, &a, &m, &mut acted, &mut Coadjoint.work(group));
        check("Λ = Ad*_{g⁻¹}", gap(&acted, &coad_group(&inverse, &m)), dual_size);

        // d/dt Ad_{exp(tu)} v = [u, v] and d/dt Ad*_{exp(tu)} m = ad*_u m, by central differences.
        let h = 1e-5;
        let step = |t: f64| {
            let mut tu = group.zero();
            group.axpy(t, &u, &mut tu);
            Exp.eval(group, &tu).expect("exp")
        };
        let mut slope = big_ad(&step(h), &v);
        group.axpy(-1.0, &big_ad(&step(-h), &v), &mut slope);
        let mut expected = group.zero();
        group.axpy(2.0 * h, &ad(&u, &v), &mut expected);
        let third = (2.0 * group.norm(&u) * h).powi(3);
        let rounding = 4.0 * n * f64::EPSILON;
        check("Ad' = ad", difference(&slope, &expected), (third + rounding) * group.norm(&v));
        let (plus, minus) = (coad_group(&step(h), &m), coad_group(&step(-h), &m));
        let slope: Vec<f64> =
            plus.numbers().iter().zip(minus.numbers()).map(|(p, m)| p - m).collect();
        let gap = slope.iter().zip(coad.numbers()).map(|(s, c)| (s - 2.0 * h * c).powi(2));
        let m_size = self::gap(&m, &zero_like(&m));
        check("Ad*' = ad*", gap.sum::<f64>().sqrt(), (third + rounding) * m_size);
    }
}

/// Something whose numbers are all zero.
fn zero_like<N: Numbers>(m: &N) -> Zeros {
    Zeros(m.numbers().len())
}
#[derive(Clone)]
struct Zeros(usize);
impl Numbers for Zeros {
    fn numbers(&self) -> Vec<f64> {
        vec![0.0; self.0]
    }
}

#[test]
fn on_so3() {
    let mut rng = Pcg64::seed_from_u64(1);
    laws(&So3::<f64>::new(), &mut rng, |_, draw| draw());
}

#[test]
fn on_u_n_and_the_quaternions() {
    let mut rng = Pcg64::seed_from_u64(4);
    for n in [1, 2, 5] {
        laws(&Unitary::new(n).expect("U(n)"), &mut rng, |_, draw| draw());
    }
    laws(&UnitQuaternions, &mut rng, |_, draw| draw());
}

/// Nothing moves, and ⟨m, v⟩ is the dot product.
#[test]
fn on_translations() {
    let group = Translations::new(Vector3::<f64>::zeros(), 3);
    let [g, u, m] = [1.0, -2.0, 0.5].map(|x| Vector3::new(x, x * x, 3.0));
    let (mut out, mut there) = (group.zero(), group.zero());
    group.inverse(&g, &mut out).expect("−g");
    group.compose(&g, &out, &mut there);
    assert_eq!(there, group.identity());
    group.big_ad(&g, &u, &mut out).expect("Ad");
    assert_eq!(out, u);
    group.coad_group(&g, &m, &mut out).expect("Ad*");
    assert_eq!(out, m);
    group.coad(&u, &m, &mut out);
    assert_eq!((out, group.pair(&m, &u)), (Vector3::zeros(), m.dot(&u)));
}

#[test]
fn on_matrix_groups() {
    let mut rng = Pcg64::seed_from_u64(2);
    let skewed =
        Mat::from_fn(3, 3, |i, j| [[2.0, 0.5, 0.0], [0.0, 1.0, -1.0], [0.3, 0.0, 1.5]][i][j]);
    for group in [
        MatrixGroup::so(2),
        MatrixGroup::so(3),
        MatrixGroup::so(6),
        MatrixGroup::sp(2),
        MatrixGroup::sp(4),
        MatrixGroup::gl(1),
        MatrixGroup::gl(4),
        MatrixGroup::indefinite(3, 1),
        MatrixGroup::gm(skewed),
    ] {
        let group = group.expect("a group");
        // A functional on 𝔤 need not lie in 𝔤: a product of two elements serves.
        laws(&group, &mut rng, |group, draw| {
            let (x, y) = (draw(), draw());
            match group.name().starts_with("SO(") {
                true => x.into_mat(),
                false => &*x + &*x * &*y,
            }
        });
    }
}

/// The general layer at n = 3 is the closed form: Ad_g hat(u) = hat(g u), ⟨m̂, v̂⟩ = 2 m·v.
#[test]
fn layers_agree() {
    use lieflow::groups::hat;
    let (so3, general) = (So3::<f64>::new(), MatrixGroup::so(3).expect("a group"));
    let mut rng = Pcg64::seed_from_u64(3);
    let mat = |m: nalgebra::Matrix3<f64>| Mat::from_fn(3, 3, |i, j| m[(i, j)]);
    for _ in 0..50 {
        let g = so3.sample_element(&mut rng);
        let [u, m] = [(); 2].map(|()| so3.sample_algebra(&mut rng, 1.0));
        let element = GroupMatrix::new_unchecked(mat(g));
        let algebra = |u: &Vector3<f64>| general.algebra(mat(hat(u))).expect("skew");
        let (mut w, mut out) = (so3.zero(), general.zero());
        so3.big_ad(&g, &u, &mut w).expect("Ad");
        general.big_ad(&element, &algebra(&u), &mut out).expect("Ad");
        assert!((&*out - mat(hat(&w))).norm_l2() < 1e-14);
        let mut dual = out.clone().into_mat();
        so3.coad(&u, &m, &mut w);
        general.coad(&algebra(&u), &mat(hat(&m)), &mut dual);
        assert!((&dual - mat(hat(&w))).norm_l2() < 1e-14);
        so3.coad_group(&g, &m, &mut w).expect("Ad*");
        general.coad_group(&element, &mat(hat(&m)), &mut dual).expect("Ad*");
        assert!((&dual - mat(hat(&w))).norm_l2() < 1e-14);
        let pair = general.pair(&mat(hat(&m)), &algebra(&u));
        assert!((pair - 2.0 * so3.pair(&m, &u)).abs() < 1e-14);
    }
}

/// A singular g has no inverse, and numbers that leave the range are no result.
#[test]
fn refusals() {
    let gl = MatrixGroup::gl(3).expect("a group");
    let singular =
        GroupMatrix::new_unchecked(Mat::from_fn(3, 3, |i, j| (i + j) as f64 * (i as f64)));
    let u = gl.algebra(Mat::identity(3, 3)).expect("u");
    let mut out = gl.zero();
    assert!(matches!(gl.big_ad(&singular, &u, &mut out), Err(StepError::NotFinite { .. })));
    let huge = gl.algebra(Mat::full(3, 3, 1e308)).expect("u");
    let g = gl.element(Mat::from_fn(3, 3, |i, j| if i == j { 2.0 } else { 1.0 })).expect("g");
    assert!(gl.big_ad(&g, &huge, &mut out).is_err());
}

/// Matrices of another size are told with their sizes.
#[test]
fn other_sizes_are_refused() {
    let groups = [
        MatrixGroup::so(3),
        MatrixGroup::gl(3),
        MatrixGroup::sl(3),
        MatrixGroup::indefinite(2, 1),
        MatrixGroup::gm(faer::mat![[2.0, 1.0, 0.0], [1.0, 3.0, 0.0], [0.0, 0.0, 1.0]]),
    ];
    for group in groups.map(|group| group.expect("a group")) {
        for (rows, cols) in [(2, 2), (4, 3), (4, 4), (0, 0), (3, 2)] {
            let told = format!("{rows}×{cols}, expected 3×3");
            let wrong = || Mat::<f64>::zeros(rows, cols);
            let (g, u) =
                (GroupMatrix::new_unchecked(wrong()), AlgebraMatrix::new_unchecked(wrong()));
            let (one, zero) = (group.identity(), group.zero());
            let (mut inverse, mut ad, mut coad) = (one.clone(), zero.clone(), wrong());
            let found = [
                group.inverse(&g, &mut inverse),
                group.big_ad(&g, &zero, &mut ad),
                group.big_ad(&one, &u, &mut ad),
                group.coad_group(&g, &Mat::zeros(3, 3), &mut coad),
                group.coad_group(&one, &wrong(), &mut coad),
            ];
            for found in found.map(|found| found.expect_err("another size").to_string()) {
                assert!(found.ends_with(&told), "{}: {found}", group.name());
            }
            assert_eq!([group.distance(&g, &one), group.defect(&g)], [f64::INFINITY; 2]);
            let member = group.check_member(&g).expect_err("another size").to_string();
            assert!(member.contains(&format!("{rows}×{cols}")), "{}: {member}", group.name());
        }
    }
    let group = Unitary::new(3).expect("U(3)");
    for n in [0, 2, 4] {
        let (x, mut out) = (ComplexMatrix::zeros(n, n), group.identity());
        let (one, mut zero) = (group.identity(), group.zero());
        let found = [
            group.inverse(&x, &mut out).map_err(Error::from),
            group.big_ad(&x, &one, &mut out).map_err(Error::from),
            group.big_ad(&one, &x, &mut out).map_err(Error::from),
            Exp.eval(&group, &x).map(drop),
            Cay.eval(&group, &x).map(drop),
            Exp.eval_dpsi_inv(&group, &x, &zero).map(drop),
            Exp.eval_dpsi_inv(&group, &zero, &x).map(drop),
            Cay.eval_dpsi_inv(&group, &zero, &x).map(drop),
        ];
        for found in found.map(|found| found.expect_err("another size").to_string()) {
            assert!(found.ends_with(&format!("{n}×{n}, expected 3×3")), "{found}");
        }
        zero.re[(0, 1)] = f64::NAN;
        let message = dexp(&group, &zero, &group.zero()).expect_err("NaN").to_string();
        assert!(message.starts_with("u in dexp_u(v) is not finite"), "{message}");
    }
}
