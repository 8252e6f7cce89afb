//! Who is compared: the closed forms, the general layer, and what nalgebra has.

use core::hint::black_box;

use faer::Mat;
use lieflow::groups::{AlgebraMatrix, GroupMatrix, LieGroup, MatrixGroup, So3, hat, vee};
use lieflow::maps::{CCSK321, Cay, CoordinateMap, Exp};
use lieflow::{Error, so3};
use nalgebra::{DMatrix, Matrix3, Rotation3, Vector3};

use super::{Case, Topic};

/// A way to compute a value: what it made of every input, and how to do it all again.
pub(super) struct Contender {
    pub(super) name: &'static str,
    /// `None` if it refused.
    pub(super) values: Vec<Option<Mat<f64>>>,
    /// Every input once.
    pub(super) run: Box<dyn FnMut()>,
}

impl Contender {
    /// `f` writes the value at an input and says whether there is one.
    fn new<I: 'static, O: AsMatrix + 'static>(
        name: &'static str,
        inputs: Vec<I>,
        mut out: O,
        mut f: impl FnMut(&I, &mut O) -> bool + 'static,
    ) -> Self {
        let values = inputs.iter().map(|x| f(x, &mut out).then(|| out.as_matrix())).collect();
        let run = Box::new(move || {
            for x in black_box(&inputs) {
                black_box(f(x, &mut out));
                black_box(&out);
            }
        });
        Contender { name, values, run }
    }

    /// `f` has a value at every input.
    fn total<I: 'static, O: AsMatrix + 'static>(
        name: &'static str,
        inputs: Vec<I>,
        out: O,
        mut f: impl FnMut(&I) -> O + 'static,
    ) -> Self {
        let write = move |x: &I, out: &mut O| {
            *out = f(x);
            true
        };
        Contender::new(name, inputs, out, write)
    }

    /// `f` has a value or refuses.
    fn partial<I: 'static, O: AsMatrix + 'static, E>(
        name: &'static str,
        inputs: Vec<I>,
        out: O,
        mut f: impl FnMut(&I) -> Result<O, E> + 'static,
    ) -> Self {
        let write = move |x: &I, out: &mut O| f(x).map(|value| *out = value).is_ok();
        Contender::new(name, inputs, out, write)
    }
}

/// An element of a group or an algebra as a matrix.
trait AsMatrix {
    fn as_matrix(&self) -> Mat<f64>;
}
impl AsMatrix for Matrix3<f64> {
    fn as_matrix(&self) -> Mat<f64> {
        Mat::from_fn(3, 3, |i, j| self[(i, j)])
    }
}
impl AsMatrix for Vector3<f64> {
    fn as_matrix(&self) -> Mat<f64> {
        hat(self).as_matrix()
    }
}
impl AsMatrix for DMatrix<f64> {
    fn as_matrix(&self) -> Mat<f64> {
        Mat::from_fn(self.nrows(), self.ncols(), |i, j| self[(i, j)])
    }
}
impl AsMatrix for GroupMatrix {
    fn as_matrix(&self) -> Mat<f64> {
        (**self).clone()
    }
}
impl AsMatrix for AlgebraMatrix {
    fn as_matrix(&self) -> Mat<f64> {
        (**self).clone()
    }
}

/// A map of the library or its inverse differential on a group.
fn of_map<G, Psi>(
    name: &'static str,
    topic: Topic,
    group: G,
    psi: Psi,
    inputs: Vec<(G::Alg, G::Alg)>,
) -> Result<Contender, Error>
where
    G: LieGroup + 'static,
    G::Alg: AsMatrix + 'static,
    G::Elem: AsMatrix + 'static,
    Psi: CoordinateMap<G> + 'static,
    Psi::At: 'static,
{
    let (mut at, mut g, w) = (psi.at(&group)?, group.identity(), group.zero());
    if topic.is_inverse_differential() {
        let both = move |(u, v): &(G::Alg, G::Alg), w: &mut G::Alg| {
            w.clone_from(v);
            psi.psi(&group, u, &mut at, &mut g).is_ok()
                && psi.dpsi_inv(&group, u, &mut at, w).is_ok()
        };
        return Ok(Contender::new(name, inputs, w, both));
    }
    let out = group.identity();
    let one =
        move |(u, _): &(G::Alg, G::Alg), g: &mut G::Elem| psi.psi(&group, u, &mut at, g).is_ok();
    Ok(Contender::new(name, inputs, out, one))
}

fn fixed(x: &Mat<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| x[(i, j)])
}

fn dynamic(x: &Mat<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(x.nrows(), x.ncols(), |i, j| x[(i, j)])
}

const CLOSED: &str = "closed form";
const GENERAL: &str = "general layer";

/// The library's contenders on a group, by topic; none for the logarithm, which is no map.
macro_rules! of_topic {
    ($name:expr, $topic:expr, $group:expr, $inputs:expr) => {
        match $topic {
            Topic::Exp | Topic::Dexpinv => Some(of_map($name, $topic, $group, Exp, $inputs)?),
            Topic::Cay | Topic::Dcayinv => Some(of_map($name, $topic, $group, Cay, $inputs)?),
            Topic::Ccsk | Topic::Dccskinv => Some(of_map($name, $topic, $group, CCSK321, $inputs)?),
            Topic::Log => None,
        }
    };
}

/// Everybody who computes this on so(3).
pub(super) fn on_so3(topic: Topic, cases: &[Case]) -> Result<Vec<Contender>, Error> {
    let vector = |x: &Mat<f64>| vee(&fixed(x));
    let pairs = cases.iter().map(|case| (vector(&case.u), vector(&case.v))).collect();
    let vectors = || cases.iter().map(|case| vector(&case.u)).collect::<Vec<_>>();
    let matrices = || cases.iter().map(|case| fixed(&case.u)).collect::<Vec<_>>();
    let rotations = || cases.iter().map(|case| fixed(&case.g)).collect::<Vec<_>>();
    let zero = Vector3::<f64>::zeros;
    let one = Matrix3::<f64>::identity;
    let mut all: Vec<Contender> = Vec::new();
    all.extend(of_topic!(CLOSED, topic, So3::<f64>::new(), pairs));
    if topic == Topic::Log {
        all.push(Contender::partial(CLOSED, rotations(), zero(), so3::log));
    }
    all.extend(general(topic, cases)?);
    match topic {
        Topic::Exp => {
            let f = |u: &Vector3<f64>| Rotation3::from_scaled_axis(*u).into_inner();
            all.push(Contender::total("nalgebra Rotation3", vectors(), one(), f));
            let f = |u: &Matrix3<f64>| u.exp();
            all.push(Contender::total("nalgebra Matrix3::exp", matrices(), one(), f));
        }
        Topic::Log => {
            let f = |g: &Matrix3<f64>| Rotation3::from_matrix_unchecked(*g).scaled_axis();
            all.push(Contender::total("nalgebra Rotation3", rotations(), zero(), f));
        }
        Topic::Cay => {
            let f = |u: &Matrix3<f64>, g: &mut Matrix3<f64>| {
                let half = u * 0.5;
                g.copy_from(&(Matrix3::identity() + half));
                (Matrix3::identity() - half).lu().solve_mut(g)
            };
            all.push(Contender::new("nalgebra Matrix3 LU", matrices(), one(), f));
        }
        Topic::Ccsk => {
            let f = |u: &Vector3<f64>| Rotation3::from_euler_angles(u[0], u[1], u[2]).into_inner();
            all.push(Contender::total("nalgebra Euler angles", vectors(), one(), f));
        }
        Topic::Dexpinv | Topic::Dcayinv | Topic::Dccskinv => {}
    }
    Ok(all)
}

/// Everybody who computes this on so(n).
pub(super) fn on_so_n(topic: Topic, cases: &[Case]) -> Result<Vec<Contender>, Error> {
    let matrices = || cases.iter().map(|case| dynamic(&case.u)).collect::<Vec<_>>();
    let n = cases.first().map_or(0, |case| case.u.nrows());
    let one = DMatrix::<f64>::identity(n, n);
    let mut all = Vec::from_iter(general(topic, cases)?);
    match topic {
        Topic::Exp => {
            let f = |u: &DMatrix<f64>| u.exp();
            all.push(Contender::total("nalgebra DMatrix::exp", matrices(), one, f));
        }
        Topic::Cay => {
            let identity = one.clone();
            let f = move |u: &DMatrix<f64>, g: &mut DMatrix<f64>| {
                let half = u * 0.5;
                g.copy_from(&(&identity + &half));
                (&identity - half).lu().solve_mut(g)
            };
            all.push(Contender::new("nalgebra DMatrix LU", matrices(), one, f));
        }
        _ => {}
    }
    Ok(all)
}

/// The general layer.
fn general(topic: Topic, cases: &[Case]) -> Result<Option<Contender>, Error> {
    let group = MatrixGroup::so(cases.first().map_or(3, |case| case.u.nrows()))?;
    let algebra = |x: &Mat<f64>| AlgebraMatrix::new_unchecked(x.clone());
    if topic == Topic::Log {
        let inputs = cases.iter().map(|case| GroupMatrix::new_unchecked(case.g.clone())).collect();
        let zero = algebra(&Mat::zeros(group.n(), group.n()));
        let log = move |g: &GroupMatrix| group.log(g);
        return Ok(Some(Contender::partial(GENERAL, inputs, zero, log)));
    }
    let pairs = cases.iter().map(|case| (algebra(&case.u), algebra(&case.v))).collect();
    Ok(of_topic!(GENERAL, topic, group, pairs))
}
