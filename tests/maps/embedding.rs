//! Rotations as blocks of larger ones: on SO(6), SO(7) and SO(8) the dense layer does with two blocks of
//! so(3), at any places of the matrix, what the closed formulas do with each.
//!
//! Unlike n = 3 alone this sees what mixes planes: eigenvalues that cluster or differ by all magnitudes,
//! and a kernel of more than one dimension.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use faer::Mat;
use lieflow::groups::{AlgebraMatrix, GroupMatrix, MatrixGroup, Sample, So3, hat};
use lieflow::maps::{Cay, CoordinateMap, Exp, Pade22};
use lieflow::so3;
use nalgebra::{Matrix3, Vector3};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const EPS: f64 = f64::EPSILON;
/// What the layers may differ by, in units of ε·cond, as at n = 3; the Frobenius norm of n×n numbers
/// instead of three vectors is the root of n beside it.
const BOUND: f64 = 8.0;

/// Where the two blocks lie: the first three places, the next three, the rest; a signed permutation
/// takes nothing from any digit.
struct Places {
    n: usize,
    at: Vec<usize>,
    sign: Vec<f64>,
}

impl Places {
    fn random(n: usize, rng: &mut Pcg64) -> Self {
        let mut at: Vec<usize> = (0..n).collect();
        at.shuffle(rng);
        Places { n, at, sign: (0..n).map(|_| if rng.random() { 1.0 } else { -1.0 }).collect() }
    }
    /// The blocks, `rest` on the diagonal after them, and a column beside the first of them with its
    /// negative across.
    fn fill(&self, blocks: [&Matrix3<f64>; 2], rest: f64, column: &Vector3<f64>) -> Mat<f64> {
        let mut x = Mat::zeros(self.n, self.n);
        let mut put = |i: usize, j: usize, value: f64| {
            x[(self.at[i], self.at[j])] = self.sign[i] * self.sign[j] * value;
        };
        for (b, block) in blocks.into_iter().enumerate() {
            for i in 0..3 {
                for j in 0..3 {
                    put(3 * b + i, 3 * b + j, block[(i, j)]);
                }
            }
        }
        for i in 6..self.n {
            put(i, i, rest);
        }
        if self.n > 6 {
            for i in 0..3 {
                put(i, 6, column[i]);
                put(6, i, -column[i]);
            }
        }
        x
    }
    fn algebra(&self, u: [&Vector3<f64>; 2], column: &Vector3<f64>) -> AlgebraMatrix {
        AlgebraMatrix::new_unchecked(self.fill([&hat(u[0]), &hat(u[1])], 0.0, column))
    }
    fn element(&self, g: [&Matrix3<f64>; 2]) -> Mat<f64> {
        self.fill(g, 1.0, &Vector3::zeros())
    }
}

/// A direction, on an axis at times, of a size over all magnitudes up to `largest`, or near a quarter
/// turn.
fn vector(rng: &mut Pcg64, largest: f64) -> Vector3<f64> {
    let direction = match rng.random_range(0..6) {
        0 => Vector3::ith(rng.random_range(0..3), 1.0),
        _ => Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0)).normalize(),
    };
    let size: f64 = match rng.random_range(0..8) {
        0 => FRAC_PI_2 * (1.0 + 10f64.powf(rng.random_range(-16.0..0.0))),
        1..4 => 10f64.powf(rng.random_range(-3.0..1.0)),
        _ => 10f64.powf(rng.random_range(-320.0..15.0)),
    };
    direction * size.min(largest)
}

/// Two of them, equal at times, so that planes turn alike.
fn pair(rng: &mut Pcg64, largest: f64) -> [Vector3<f64>; 2] {
    let a = vector(rng, largest);
    let b = match rng.random_range(0..5) {
        0 => a,
        1 => a * (1.0 + EPS * f64::from(rng.random_range(0..64))),
        _ => vector(rng, largest),
    };
    [a, b]
}

struct Worst(f64, String);

impl Worst {
    fn see(&mut self, gap: f64, scale: f64, at: impl Fn() -> String) {
        let ratio = gap / (EPS * scale);
        assert!(ratio.is_finite(), "{gap:e} of {scale:e} at {}", at());
        if ratio > self.0 {
            *self = Worst(ratio, at());
        }
    }
    fn holds(&self, what: &str) {
        println!("{what:16} worst {:.2} of {BOUND} at {}", self.0, self.1);
        assert!(self.0 <= BOUND, "{what}: {:.2} ε·cond at {}", self.0, self.1);
    }
}

#[test]
fn exp_cay_and_pade_of_blocks() {
    let mut rng = Pcg64::seed_from_u64(11);
    let mut worst = [(); 2].map(|()| Worst(0.0, String::new()));
    for n in [6, 7, 8] {
        let group = MatrixGroup::so(n).expect("SO(n)");
        let (root, none) = ((n as f64).sqrt(), Vector3::zeros());
        for _ in 0..1500 {
            let places = Places::random(n, &mut rng);
            let [a, b] = pair(&mut rng, 1e14);
            let at = || format!("n = {n}, |a| = {:e}, |b| = {:e}", a.norm(), b.norm());
            let u = places.algebra([&a, &b], &none);
            let size = a.norm().max(b.norm()).max(1.0);
            let mut against = |which: usize, mine: GroupMatrix, g: [Matrix3<f64>; 2], cond: f64| {
                let gap = (&*mine - places.element([&g[0], &g[1]])).norm_l2();
                worst[which].see(gap, root * cond, at);
            };
            let closed = |u| so3::exp(u).expect("exp");
            against(0, Exp.eval(&group, &u).expect("exp"), [closed(&a), closed(&b)], size);
            let closed = |u| so3::cay(u).expect("cay");
            let cond = 1.0 + 0.5 * size;
            if let Ok(mine) = Cay.eval(&group, &u) {
                against(1, mine, [closed(&a), closed(&b)], cond);
            } else {
                // Refused where rcond(𝟙 − u/2) < 1e-14 in the 1-norm.
                assert!(size > 1e12, "{}", at());
            }
        }
    }
    worst[0].holds("exp");
    worst[1].holds("cay");
}

/// ad_u has the differences of the eigenvalues of u: its distance to 2πik says what dexp⁻¹ does to
/// rounding in any place.
fn distance([a, b]: [f64; 2]) -> f64 {
    let spectrum = [a, b, a + b, (a - b).abs()];
    let to = |x: f64| (x - TAU * (x / TAU).round().max(1.0)).abs();
    spectrum.into_iter().map(to).fold(f64::INFINITY, f64::min)
}

#[test]
fn inverse_differentials_of_blocks_and_columns() {
    let mut rng = Pcg64::seed_from_u64(12);
    let mut worst = [(); 3].map(|()| Worst(0.0, String::new()));
    let (mut compared, mut refused) = (0, 0);
    for n in [6, 7, 8] {
        let group = MatrixGroup::so(n).expect("SO(n)");
        let so3_group = So3::<f64>::new();
        for _ in 0..1000 {
            let places = Places::random(n, &mut rng);
            let [a, b] = pair(&mut rng, 40.0);
            let at = || format!("n = {n}, a = {a:?}, b = {b:?}");
            let [c, d, w] = [(); 3].map(|()| so3_group.sample_vector(&mut rng));
            // A column beside the block of a is turned by â alone: the same function of â acts on it.
            let w = if n > 6 { w } else { Vector3::zeros() };
            let u = places.algebra([&a, &b], &Vector3::zeros());
            let v = places.algebra([&c, &d], &w);
            let size = v.norm_l2();
            let gap = |mine: AlgebraMatrix, closed: [Vector3<f64>; 2], column: Vector3<f64>| {
                (&*mine - &*places.algebra([&closed[0], &closed[1]], &column)).norm_l2()
            };

            let (alpha, beta) = (a.norm(), b.norm());
            let far = distance([alpha, beta]);
            let largest = 1.0 + (alpha + beta) / far;
            match Exp.eval_dpsi_inv(&group, &u, &v) {
                Ok(mine) => {
                    let f = |u, v| so3::dexpinv(u, v).expect("dexp⁻¹");
                    let gap = gap(mine, [f(&a, &c), f(&b, &d)], f(&a, &w));
                    worst[0].see(gap, size * largest * largest.max(1.0), at);
                    compared += 1;
                }
                Err(error) => {
                    assert!(far < 1e-10 * (1.0 + alpha + beta), "{error}, {far:e} away: {}", at());
                    refused += 1;
                }
            }

            let mine = Cay.eval_dpsi_inv(&group, &u, &v).expect("dcay⁻¹");
            let f = |u, v| so3::dcayinv(u, v).expect("dcay⁻¹");
            let column = w - a.cross(&w) * 0.5;
            let cond = (1.0 + 0.5 * alpha.max(beta)).powi(2);
            worst[1].see(gap(mine, [f(&a, &c), f(&b, &d)], column), size * cond, at);

            // dΨ⁻¹ of the Padé map, with no closed form of its own beside the one on so(3) as a group.
            let closed =
                |u: &Vector3<f64>, v: &Vector3<f64>| Pade22.eval_dpsi_inv(&so3_group, u, v);
            let no_column = places.algebra([&c, &d], &Vector3::zeros());
            if let (Ok(mine), Ok(c), Ok(d)) =
                (Pade22.eval_dpsi_inv(&group, &u, &no_column), closed(&a, &c), closed(&b, &d))
            {
                // Two planes meet where the angles φ of Ψ add up to a full turn, as with exp.
                let phi = |x: f64| 2.0 * (0.5 * x).atan2(1.0 - x * x / 12.0);
                let far = (TAU - phi(alpha) - phi(beta)).abs().min(1.0);
                let cond = (1.0 + 0.25 * alpha.max(beta).powi(2)).powi(2) / far;
                worst[2].see(gap(mine, [c, d], Vector3::zeros()), size * cond, at);
            }
        }
    }
    assert!(compared > 2900, "{compared} compared, {refused} refused");
    worst[0].holds("dexp⁻¹");
    worst[1].holds("dcay⁻¹");
    worst[2].holds("dΨ⁻¹ of Padé");
}

#[test]
fn log_of_blocks() {
    let mut rng = Pcg64::seed_from_u64(13);
    let mut worst = Worst(0.0, String::new());
    for n in [6, 7, 8] {
        let group = MatrixGroup::so(n).expect("SO(n)");
        for _ in 0..1000 {
            let places = Places::random(n, &mut rng);
            let [a, b] = pair(&mut rng, PI - 1e-6);
            let at = || format!("n = {n}, a = {a:?}, b = {b:?}");
            let g = places.element([&so3::exp(&a).expect("exp"), &so3::exp(&b).expect("exp")]);
            let g = group.element(g).expect("in SO(n)");
            let u = group.log(&g).expect("log");
            let closed = places.algebra([&a, &b], &Vector3::zeros());
            // cond of log at a rotation by α: α/(2 sin(α/2)) in its plane, 1/(π − α) across two that are
            // both near a half turn.
            let near = |x: f64| 1.0 / (PI - x);
            let cond = near(a.norm()).max(near(b.norm())).max(1.0);
            let gap = (&*u - &*closed).norm_l2();
            // n ε·cond, as promised of log on any group.
            worst.see(gap, n as f64 * cond * a.norm().max(b.norm()).max(1.0), at);
        }
    }
    worst.holds("log");
}
