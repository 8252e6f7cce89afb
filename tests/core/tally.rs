//! What matrices say that they have computed is what the same mathematics takes entry by entry on numbers
//! that count themselves.

use faer::Mat;
use lieflow::actions::{Action, Coadjoint, Conjugation};
use lieflow::catalog::MethodSpec;
use lieflow::dense::{Exponential, Structure};
use lieflow::groups::{AlgebraMatrix, GroupMatrix, LieAlgebra, LieGroup, MatrixGroup, Sample};
use lieflow::maps::{CCSK321, Cay, CoordinateMap};
use lieflow::methods::{Method, Step};
use lieflow::problems::{Problem, RigidBodyN};
use lieflow::scalar::{Counted, Ops, Real, Trig, tally};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::support::named;

/// A matrix of numbers that count, by rows.
#[derive(Clone, Debug)]
struct Naive(Vec<Vec<Counted>>);

impl Naive {
    fn of(x: &Mat<f64>) -> Self {
        let row = |i| (0..x.ncols()).map(|j| Counted(x[(i, j)])).collect();
        Naive((0..x.nrows()).map(row).collect())
    }
    fn shape(&self) -> (usize, usize) {
        (self.0.len(), self.0[0].len())
    }
    fn map(&self, f: impl Fn(usize, usize) -> Counted) -> Naive {
        let (rows, cols) = self.shape();
        Naive((0..rows).map(|i| (0..cols).map(|j| f(i, j)).collect()).collect())
    }
    fn transpose(&self) -> Naive {
        let (rows, cols) = self.shape();
        Naive((0..cols).map(|i| (0..rows).map(|j| self.0[j][i]).collect()).collect())
    }
    fn mul(&self, b: &Naive) -> Naive {
        let (rows, inner, cols) = (self.0.len(), b.0.len(), b.0[0].len());
        let entry = |i: usize, j: usize| {
            (1..inner).fold(self.0[i][0] * b.0[0][j], |s, k| s + self.0[i][k] * b.0[k][j])
        };
        Naive((0..rows).map(|i| (0..cols).map(|j| entry(i, j)).collect()).collect())
    }
    fn add(&self, a: f64, x: &Naive) -> Naive {
        self.map(|i, j| self.0[i][j] + Counted(a) * x.0[i][j])
    }
    fn sub(&self, x: &Naive) -> Naive {
        self.map(|i, j| self.0[i][j] - x.0[i][j])
    }
    fn add_one(&self) -> Naive {
        self.map(|i, j| if i == j { self.0[i][j] + Counted(1.0) } else { self.0[i][j] })
    }
    fn scaled(&self, a: f64) -> Naive {
        self.map(|i, j| Counted(a) * self.0[i][j])
    }
    /// x − xᵀ from one triangle.
    fn minus_transpose(&self) -> Naive {
        let n = self.0.len();
        let mut out = self.map(|_, _| Counted(0.0));
        for j in 0..n {
            for i in j + 1..n {
                let d = self.0[i][j] - self.0[j][i];
                (out.0[i][j], out.0[j][i]) = (d, -d);
            }
        }
        out
    }
    fn norm(&self) -> Counted {
        let all: Vec<Counted> = self.0.iter().flatten().copied().collect();
        let squares = all[1..].iter().fold(all[0] * all[0], |s, x| s + *x * *x);
        squares.sqrt()
    }
    /// The largest column sum.
    fn norm1(&self) -> f64 {
        let (rows, cols) = self.shape();
        let column = |j: usize| (1..rows).fold(self.0[0][j].abs(), |s, i| s + self.0[i][j].abs()).0;
        (0..cols).map(column).fold(0.0, f64::max)
    }
    /// self⁻¹·b by LU without pivots, a reciprocal for each: the factors are kept.
    fn solve(&self, b: &Naive) -> Naive {
        let n = self.0.len();
        let mut lu = self.clone();
        for k in 0..n {
            let inverse = Counted(1.0) / lu.0[k][k];
            for i in k + 1..n {
                lu.0[i][k] = lu.0[i][k] * inverse;
                for j in k + 1..n {
                    let x = lu.0[i][k] * lu.0[k][j];
                    lu.0[i][j] -= x;
                }
            }
        }
        let mut x = b.clone();
        let inverse: Vec<Counted> = (0..n).map(|i| Counted(1.0) / lu.0[i][i]).collect();
        for j in 0..b.0[0].len() {
            for k in 0..n {
                for i in k + 1..n {
                    let y = lu.0[i][k] * x.0[k][j];
                    x.0[i][j] -= y;
                }
            }
            for k in (0..n).rev() {
                x.0[k][j] = x.0[k][j] * inverse[k];
                for i in 0..k {
                    let y = lu.0[i][k] * x.0[k][j];
                    x.0[i][j] -= y;
                }
            }
        }
        x
    }
    fn near(&self, x: &Mat<f64>) -> bool {
        let (rows, cols) = self.shape();
        let gap = |i: usize, j: usize| (self.0[i][j].0 - x[(i, j)]).abs();
        (0..rows).all(|i| (0..cols).all(|j| gap(i, j) <= 1e-10))
    }
}

fn rng() -> Pcg64 {
    Pcg64::seed_from_u64(11)
}

/// The sizes of the kernels: in line, wide, by rows, faer's, by panels and by triangles.
const SIZES: [usize; 10] = [1, 2, 3, 4, 6, 8, 9, 16, 17, 40];

#[test]
fn products_solves_and_sums() {
    for n in SIZES {
        let gl = MatrixGroup::gl(n).unwrap();
        // Far from singular, so that a solve without pivots is as good.
        let dominant = |k: f64| pair_of(n) + faer::Scale(k * n as f64) * Mat::<f64>::identity(n, n);
        let [a, b] = [6.0, -5.0].map(|k| GroupMatrix::new_unchecked(dominant(k)));
        let (x, y) = (Naive::of(&a), Naive::of(&b));
        let mut out = gl.identity();

        let ((), product) = Counted::count(|| gl.compose(&a, &b, &mut out));
        let (naive, expected) = Counted::count(|| x.mul(&y));
        assert!(naive.near(&out));
        assert_eq!(product, expected, "product, n = {n}");

        // An n×2 factor, as vectors are.
        let pair = Mat::from_fn(n, 2, |i, j| (i + j) as f64);
        let mut image = pair.clone();
        let ((), product) = Counted::count(|| gl.apply(&a, &pair, &mut image));
        let (_, expected) = Counted::count(|| x.mul(&Naive::of(&pair)));
        assert_eq!(product, expected, "two columns, n = {n}");

        // g⁻ᵀ p gᵀ: a solve and a product.
        let (p, mut q) = (pair_of(n), pair_of(n));
        let mut work = Action::<MatrixGroup>::work(&Coadjoint, &gl);
        let ((), act) = Counted::count(|| Coadjoint.act(&gl, &a, &p, &mut q, &mut work));
        let (naive, expected) =
            Counted::count(|| x.transpose().solve(&Naive::of(&p)).mul(&x.transpose()));
        assert!(naive.near(&q), "n = {n}");
        assert_eq!(act, expected, "LU and product, n = {n}");

        let (u, v) = (AlgebraMatrix::new_unchecked(p.clone()), gl.zero());
        let mut sum = v.clone();
        let ((), axpy) = Counted::count(|| gl.axpy(0.3, &u, &mut sum));
        let (_, expected) = Counted::count(|| Naive::of(&v).add(0.3, &Naive::of(&u)));
        assert_eq!(axpy, expected, "sum, n = {n}");

        let (_, norm) = Counted::count(|| gl.norm(&u));
        let (_, expected) = Counted::count(|| Naive::of(&u).norm());
        assert_eq!(norm, expected, "norm, n = {n}");
    }
}

fn pair_of(n: usize) -> Mat<f64> {
    Mat::from_fn(n, n, |i, j| ((3 * i + 5 * j) % 7) as f64 - 3.0)
}

#[test]
fn half_products_are_counted_as_halves() {
    for n in [48, 100, 230] {
        let so = MatrixGroup::so(n).unwrap();
        let (g, m) = (so.identity(), so.sample_algebra(&mut rng(), 1.0).into_mat());
        let (mut q, mut work) = (m.clone(), Action::<MatrixGroup>::work(&Conjugation, &so));
        let ((), ops) = Counted::count(|| Conjugation.act(&so, &g, &m, &mut q, &mut work));
        let whole = (n * n * (2 * n - 1)) as f64;
        let ratio = ops.total() as f64 / whole;
        // One product and half of one; panels compute a few entries above the diagonal.
        assert!((1.5..1.7).contains(&ratio), "n = {n}: {ratio}");
    }
}

#[test]
fn brackets() {
    for n in [2, 4, 6, 10] {
        for group in [MatrixGroup::so(n), MatrixGroup::gl(n), MatrixGroup::sp(n)] {
            let group = group.unwrap();
            let [u, v] = [1, 2].map(|_| group.sample_algebra(&mut rng(), 1.0));
            let mut out = group.zero();
            let ((), ops) = Counted::count(|| group.bracket(&u, &v, &mut out));
            let (_, expected) = Counted::count(|| {
                let (u, v) = (Naive::of(&u), Naive::of(&v));
                match group.name().as_bytes() {
                    [b'S', b'O', ..] => u.mul(&v).minus_transpose(),
                    [b'G', ..] => u.mul(&v).sub(&v.mul(&u)),
                    // A, −Aᵀ, and the two symmetric blocks: as many sums as there are parameters.
                    _ => {
                        let product = u.mul(&v);
                        let x = product.0[0][0];
                        let _ = (0..group.dim()).fold(x, |s, _| s + x);
                        product
                    }
                }
            });
            assert_eq!(ops, expected, "{}", group.name());
        }
    }
}

#[test]
fn the_cayley_map() {
    for n in SIZES.into_iter().filter(|n| *n > 1) {
        let so = MatrixGroup::so(n).unwrap();
        let u = so.algebra(so.sample_algebra(&mut rng(), 0.1 / n as f64).into_mat()).unwrap();
        let (mut at, mut g) = (Cay.at(&so).unwrap(), so.identity());
        let (done, psi) = Counted::count(|| Cay.psi(&so, &u, &mut at, &mut g));
        done.unwrap();
        let (naive, expected) = Counted::count(|| {
            let u = Naive::of(&u);
            let (minus, plus) = (u.scaled(-0.5).add_one(), u.scaled(0.5).add_one());
            // Is u small enough for the solve alone? Asked twice: in all, and for the correction.
            let _ = (u.norm(), u.norm());
            minus.solve(&plus)
        });
        assert!(naive.near(&g));
        assert_eq!(psi, expected, "cay, n = {n}");

        let mut v = so.sample_algebra(&mut rng(), 1.0);
        let (done, dpsi_inv) = Counted::count(|| Cay.dpsi_inv(&so, &u, &mut at, &mut v));
        done.unwrap();
        let (_, expected) = Counted::count(|| {
            let v = Naive::of(&v);
            v.mul(&v).mul(&v)
        });
        assert_eq!(dpsi_inv, expected, "dcay⁻¹, n = {n}");
    }
}

/// Columns c and r of x turned, and rows too where asked for.
fn turn(x: &mut Naive, r: usize, c: usize, (s, k): (Counted, Counted), rows: bool) {
    let n = x.0.len();
    for i in 0..n {
        let (a, b) = (x.0[i][c], x.0[i][r]);
        (x.0[i][c], x.0[i][r]) = (k * a + s * b, k * b - s * a);
    }
    for j in (0..n).filter(|_| rows) {
        let (a, b) = (x.0[c][j], x.0[r][j]);
        (x.0[c][j], x.0[r][j]) = (k * a + s * b, k * b - s * a);
    }
}

#[test]
fn canonical_coordinates() {
    for n in [2, 3, 5, 9] {
        let so = MatrixGroup::so(n).unwrap();
        let u = so.sample_algebra(&mut rng(), 0.3);
        let (mut at, mut g) = (CCSK321.at(&so).unwrap(), so.identity());
        let (done, psi) = Counted::count(|| CCSK321.psi(&so, &u, &mut at, &mut g));
        done.unwrap();
        let mut angles = vec![vec![(Counted(0.0), Counted(1.0)); n]; n];
        let (naive, expected) = Counted::count(|| {
            let mut g = Naive::of(&Mat::identity(n, n));
            for c in 0..n {
                for r in c + 1..n {
                    angles[r][c] = Counted(u[(r, c)]).sin_cos();
                    turn(&mut g, r, c, angles[r][c], false);
                }
            }
            g
        });
        assert!(naive.near(&g));
        assert_eq!(psi, expected, "ccsk321, n = {n}");

        let v = so.sample_algebra(&mut rng(), 1.0);
        let mut w = v.clone();
        let (done, dpsi_inv) = Counted::count(|| CCSK321.dpsi_inv(&so, &u, &mut at, &mut w));
        done.unwrap();
        let (naive, expected) = Counted::count(|| {
            let (mut w, mut out) = (Naive::of(&v), Naive::of(&v));
            for c in 0..n {
                (c + 1..n).for_each(|r| turn(&mut w, r, c, angles[r][c], true));
                let mut rho = vec![vec![Counted(0.0); n]; n];
                let mut now: Vec<_> = (0..n).map(|i| Counted(f64::from(i == c))).collect();
                for r in (c + 1..n).rev() {
                    rho[r].clone_from(&now);
                    for i in c..n {
                        now[i] = now[i] * angles[r][c].1;
                    }
                    now[r] -= angles[r][c].0;
                }
                for r in c + 1..n {
                    let x = w.0[r][c] / rho[r][c];
                    (out.0[r][c], out.0[c][r]) = (x, -x);
                }
                for r in c + 1..n {
                    for i in c..n {
                        // One product serves the row and the column.
                        let x = out.0[r][c];
                        w.0[r][i] -= x * rho[r][i];
                        w.0[i][r] += x * rho[r][i];
                    }
                }
            }
            out
        });
        assert!(naive.near(&w), "n = {n}");
        assert_eq!(dpsi_inv, expected, "dccsk321⁻¹, n = {n}");
    }
}

/// What a Taylor polynomial of `degree` with squarings takes, by its table: products, products that are
/// added to something, and the lengths of the sums without and with a multiple of 𝟙.
fn polynomial(degree: usize) -> (usize, usize, &'static [usize], &'static [usize]) {
    match degree {
        1 => (0, 0, &[], &[1]),
        2 => (1, 0, &[], &[2]),
        4 => (1, 1, &[], &[2, 1]),
        8 => (2, 1, &[2, 2], &[3, 2]),
        12 => (2, 2, &[3, 3], &[4, 3]),
        _ => (3, 2, &[3, 3, 4], &[5, 4]),
    }
}

#[test]
fn exponentials_by_the_choice_they_made() {
    let (mut degrees, mut squared, mut corrected) = (Vec::new(), false, false);
    for n in [2, 3, 5, 10, 13] {
        for size in [1e-17, 1e-9, 1e-4, 0.02, 0.2, 0.9, 6.0, 40.0] {
            for structure in [Structure::Skew, Structure::General] {
                let so = MatrixGroup::so(n).unwrap();
                let x = so.sample_algebra(&mut rng(), 1.0).into_mat();
                let u = &x * faer::Scale(size / x.norm_l1());
                let (mut exponential, mut g) = (Exponential::new(n), Mat::zeros(n, n));
                let (choice, ops) = Counted::count(|| exponential.exp(&u, structure, &mut g));
                let choice = choice.unwrap();
                // One of which nothing is known, and that is large, may go the careful way.
                if choice.kind != lieflow::dense::Approximant::Taylor || choice.balanced {
                    continue;
                }
                let (products, added, sums, with_one) = polynomial(choice.degree);
                let (_, expected) = Counted::count(|| {
                    let a = Naive::of(&u);
                    let sum = |k: usize| (1..k).fold(a.scaled(1.0), |s, _| s.add(1.0, &a));
                    (0..products + added + choice.squarings as usize).for_each(|_| drop(a.mul(&a)));
                    (0..added).for_each(|_| drop(a.sub(&a)));
                    sums.iter().for_each(|k| drop(sum(*k)));
                    with_one.iter().for_each(|k| drop(sum(*k).add_one()));
                    let more = if structure == Structure::Skew { 1 } else { 3 };
                    let norms = 1 + if choice.squarings > 0 { more } else { 0 };
                    let _ = (0..norms).map(|_| a.norm1()).sum::<f64>();
                    for _ in 0..choice.corrections {
                        let half = a.mul(&a).scaled(-0.5).add_one();
                        half.norm1();
                        drop(a.sub(&a.mul(&half)));
                    }
                });
                let case = format!("n = {n}, norm {size}, {structure:?}: {choice:?}");
                if structure == Structure::Skew || size <= 16.0 {
                    assert_eq!(ops, expected, "{case}");
                }
                degrees.push(choice.degree);
                squared |= choice.squarings > 2;
                corrected |= choice.corrections > 0;
            }
        }
    }
    degrees.sort_unstable();
    degrees.dedup();
    assert_eq!(degrees, [1, 2, 4, 8, 12, 18], "every polynomial was met");
    assert!(squared && corrected);
}

/// Classical RK4 as a whole, on so(4): four fields and the sums of the tableau.
#[test]
fn a_step_of_rk4() {
    let body = RigidBodyN::manakov(&[1.0, 2.0, 3.0, 4.5]).unwrap();
    let m = body.group().sample_algebra(&mut rng(), 0.5).into_mat();
    let (y, ops) = named::lie_poisson(&MethodSpec::new("rk4", None), |method| {
        let mut y = m.clone();
        let mut work = method.work(&body, &y).unwrap();
        let step = Step { n: 0, t: 0.0, h: 0.1 };
        let (done, ops) = Counted::count(|| method.step(&body, step, &mut y, &mut work));
        done.unwrap();
        (y, ops)
    })
    .unwrap();
    let lambda = [1.0, 2.0, 3.0, 4.5];
    let (naive, expected) = Counted::count(|| {
        let field = |m: &Naive| {
            let mut omega = m.clone();
            for j in 0..4 {
                for i in j + 1..4 {
                    let weight = Counted(1.0 / (lambda[i] + lambda[j]));
                    let w = Counted(0.5) * (m.0[i][j] - m.0[j][i]) * weight;
                    (omega.0[i][j], omega.0[j][i]) = (w, -w);
                }
            }
            m.mul(&omega).minus_transpose()
        };
        let m = Naive::of(&m);
        let k1 = field(&m);
        let k2 = field(&m.add(0.05, &k1));
        let k3 = field(&m.add(0.05, &k2));
        let k4 = field(&m.add(0.1, &k3));
        let out = m.add(0.1 / 6.0, &k1).add(0.1 / 3.0, &k2);
        out.add(0.1 / 3.0, &k3).add(0.1 / 6.0, &k4)
    });
    assert!(naive.near(&y));
    assert_eq!(ops, expected);
}

#[test]
fn counts_are_kept_apart() {
    let said = Ops::muladds(3) + Ops::divs(1) * 2;
    let ((), outer) = Counted::count(|| {
        tally(|| said);
        // What is counted within is not counted around it.
        let ((), inner) = Counted::count(|| tally(|| Ops::trigs(5)));
        assert_eq!(inner.trig, 5);
    });
    assert_eq!(outer, Ops { add: 3, mul: 3, div: 2, ..Ops::NONE });
}
