//! The maps beside exact values: how accurate each one is and what it costs, over the angle and
//! over n, on both layers and in nalgebra.
//!
//! An error is in units of ε·cond: the unit is ε times the size of the exact value plus what the
//! exact value changes by when every number of the input moves by the relative amount ε, up or
//! down: all together, and as chance has it (the largest of the changes). 1 is what rounding the input and the result
//! already costs. The unit is the same for every contender.

mod contest;
pub mod exact;
mod page;

use core::convert::Infallible;
use core::f64::consts::{PI, TAU};

use faer::Mat;
use lieflow::RunError;
use lieflow::groups::{AlgebraMatrix, LieAlgebra, MatrixGroup, Sample, So3, hat};
use lieflow::maps::{Ccsk, CoordinateMap, Exp};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use self::contest::Contender;
use self::exact::Matrix;
use lieflow_figures::{Page, csv};
use lieflow_timing::{median, seconds_of};

/// A map or an inverse differential.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// exp.
    Exp,
    /// dexp⁻¹, after exp.
    Dexpinv,
    /// log.
    Log,
    /// cay.
    Cay,
    /// dcay⁻¹, after cay.
    Dcayinv,
    /// ccsk in the ordering 321.
    Ccsk,
    /// dccsk⁻¹, after ccsk.
    Dccskinv,
}

impl Topic {
    /// Every topic.
    pub const ALL: [Topic; 7] = [
        Topic::Exp,
        Topic::Dexpinv,
        Topic::Log,
        Topic::Cay,
        Topic::Dcayinv,
        Topic::Ccsk,
        Topic::Dccskinv,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Topic::Exp => "exp",
            Topic::Dexpinv => "dexp⁻¹",
            Topic::Log => "log",
            Topic::Cay => "cay",
            Topic::Dcayinv => "dcay⁻¹",
            Topic::Ccsk => "ccsk321",
            Topic::Dccskinv => "dccsk321⁻¹",
        }
    }

    /// Its name in files.
    pub fn key(self) -> String {
        self.name().replace("⁻¹", "inv")
    }

    /// Is its value in the algebra, and its time that of the map and its inverse differential?
    pub fn is_inverse_differential(self) -> bool {
        matches!(self, Topic::Dexpinv | Topic::Dcayinv | Topic::Dccskinv)
    }

    /// The exact value.
    fn exact(self, [u, v, g]: [&Matrix; 3], correct: &exact::Correct<'_>) -> Option<Matrix> {
        match self {
            Topic::Exp => Some(exact::exp(u)),
            Topic::Dexpinv => exact::dexpinv(u, v, correct),
            Topic::Log => exact::log(g, u, correct),
            Topic::Cay => Some(exact::cay(u)),
            Topic::Dcayinv => Some(exact::dcayinv(u, v)),
            Topic::Ccsk => Some(exact::ccsk(u)),
            Topic::Dccskinv => exact::dccskinv(u, v, correct),
        }
    }
}

/// What the horizontal axis is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// |u| on so(3).
    Angle,
    /// n on so(n), at ‖u‖ ≈ 1.
    Size,
}

/// A topic over the angle or over n.
#[derive(Clone, Debug)]
pub struct Study {
    /// The topic.
    pub topic: Topic,
    /// The axis.
    pub over: Over,
    /// One line a contender.
    pub lines: Vec<StudyLine>,
}

/// A contender.
#[derive(Clone, Debug)]
pub struct StudyLine {
    /// Its name.
    pub name: &'static str,
    /// Its results along the axis.
    pub points: Vec<StudyPoint>,
}

/// The result of a contender at a place of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StudyPoint {
    /// The place.
    pub at: f64,
    /// The number of inputs.
    pub cases: usize,
    /// The number of inputs that it refused.
    pub refused: usize,
    /// The largest error in units of ε·cond; not a number where every input was refused.
    pub error: f64,
    /// CPU time of a call.
    pub seconds: f64,
}

impl StudyLine {
    /// The point with the largest error.
    pub fn worst(&self) -> Option<&StudyPoint> {
        let points = self.points.iter().filter(|p| !p.error.is_nan());
        points.max_by(|p, q| p.error.total_cmp(&q.error))
    }

    /// The median over the points of the time of a call.
    pub fn seconds(&self) -> f64 {
        median(&mut self.points.iter().map(|p| p.seconds).collect::<Vec<_>>())
    }
}

/// How much is surveyed.
#[derive(Clone, Copy, Debug)]
pub struct StudyExtent {
    /// Random directions at an angle.
    pub directions: usize,
    /// The largest n.
    pub largest: usize,
    /// Rounds of timing.
    pub rounds: u32,
}

/// An input: u and v in the algebra, g in the group, each as the doubles that it is.
struct Case {
    u: Mat<f64>,
    v: Mat<f64>,
    g: Mat<f64>,
}

impl Case {
    fn new(u: Mat<f64>, v: Mat<f64>) -> Self {
        let g = exact::exp(&Matrix::of(&u)).rounded();
        Case { u, v, g }
    }

    /// The exact value and the unit of its error. `None` if it is not found.
    fn reference(&self, topic: Topic, rng: &mut Pcg64) -> Option<(Matrix, f64)> {
        let group = MatrixGroup::so(self.u.nrows()).ok()?;
        let u = AlgebraMatrix::new_unchecked(self.u.clone());
        let correct = |residual: &Mat<f64>| {
            let v = AlgebraMatrix::new_unchecked(residual.clone());
            let w = match topic {
                Topic::Dccskinv => Ccsk::<2, 1, 0>::with_min_cos(0.0).eval_dpsi_inv(&group, &u, &v),
                _ => Exp.eval_dpsi_inv(&group, &u, &v),
            };
            w.ok().map(AlgebraMatrix::into_mat)
        };
        let [u, v, g] = [&self.u, &self.v, &self.g].map(Matrix::of);
        let value = topic.exact([&u, &v, &g], &correct)?;
        let mut change = 0f64;
        for draw in 0..=DRAWS {
            // All up first: where a map is singular, it is the size of u that matters.
            let chance = if draw == 0 { 0.0 } else { 0.5 };
            let moved =
                [(&u, true), (&v, true), (&g, false)].map(|(x, skew)| moved(x, skew, chance, rng));
            // log looks for g near u, and g alone moves.
            let u = if topic == Topic::Log { &u } else { &moved[0] };
            let other = topic.exact([u, &moved[1], &moved[2]], &correct)?;
            change = change.max((&other - &value).norm() / MOVE);
        }
        let unit = f64::EPSILON * (value.norm() + change);
        Some((value, unit))
    }
}

/// Random draws of the moves that condition is measured with, and the size of a move.
const DRAWS: usize = 2;
const MOVE: f64 = 1e-13;

/// x with every number moved by the relative amount [`MOVE`], down with this probability and up
/// otherwise; on so(n) the numbers are those below the diagonal.
fn moved(x: &Matrix, skew: bool, down: f64, rng: &mut Pcg64) -> Matrix {
    let n = x.n();
    let mut signs = Mat::from_fn(n, n, |_, _| if rng.random_bool(down) { -MOVE } else { MOVE });
    if skew {
        for i in 0..n {
            for j in i..n {
                signs[(i, j)] = signs[(j, i)];
            }
        }
    }
    Matrix::from_fn(n, |i, j| x.at(i, j) + x.at(i, j) * signs[(i, j)].into())
}

/// The angles from 1e-16 to 2π: every decade, then densely, closing in on π and 2π.
fn angles() -> Vec<f64> {
    let mut angles: Vec<f64> = (-16..0).map(|k| 10f64.powi(k)).collect();
    angles.extend([0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0]);
    for near in [1e-2, 1e-4, 1e-6, 1e-9] {
        angles.extend([PI * (1.0 - near), TAU * (1.0 - near)]);
    }
    angles.extend([PI, TAU]);
    angles.sort_by(f64::total_cmp);
    angles
}

/// Every n of the survey.
const SIZES: [usize; 8] = [3, 4, 6, 8, 12, 16, 24, 32];

/// From this angle on log gives another u than the one that g was made of.
const LOG_END: f64 = PI * (1.0 - 1e-10);

/// The inputs at an angle.
fn at_angle(angle: f64, count: usize, rng: &mut Pcg64) -> Vec<Case> {
    let mut vector = || So3::<f64>::new().sample_vector(&mut *rng);
    let dense = |x: Vector3<f64>| {
        let x = hat(&x);
        Mat::from_fn(3, 3, |i, j| x[(i, j)])
    };
    let case = |_| Case::new(dense(vector().normalize() * angle), dense(vector()));
    (0..count).map(case).collect()
}

/// The inputs at n, of spectral norm about 1: that of a Gaussian matrix is 2/√n times its Frobenius
/// norm.
fn at_size(n: usize, rng: &mut Pcg64) -> Result<Vec<Case>, RunError> {
    let group = MatrixGroup::so(n)?;
    let mut draw = |size: f64| {
        let x = group.sample_algebra(&mut *rng, 1.0);
        let factor = size / group.norm(&x);
        Mat::from_fn(n, n, |i, j| x[(i, j)] * factor)
    };
    let count = (16 / n).max(1);
    Ok((0..count).map(|_| Case::new(draw(0.5 * (n as f64).sqrt()), draw(1.0))).collect())
}

/// A contender to be timed, and where its time goes.
struct Entry {
    place: [usize; 3],
    contender: Contender,
    times: Vec<f64>,
}

/// A timing shorter than this is repeated within its round.
const SHORTEST: f64 = 1e-4;

/// Survey everything. `tick` gets the share of the work that is done.
pub fn survey(
    effort: &StudyExtent,
    seed: u64,
    mut tick: impl FnMut(f64),
) -> Result<Vec<Study>, RunError> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut inputs: Vec<(Over, f64, Vec<Case>)> = Vec::new();
    for angle in angles() {
        inputs.push((Over::Angle, angle, at_angle(angle, effort.directions, &mut rng)));
    }
    for n in SIZES.into_iter().filter(|n| *n <= effort.largest) {
        inputs.push((Over::Size, n as f64, at_size(n, &mut rng)?));
    }
    let mut studies = Vec::new();
    for over in [Over::Angle, Over::Size] {
        studies.extend(Topic::ALL.map(|topic| Study { topic, over, lines: Vec::new() }));
    }
    let mut entries: Vec<Entry> = Vec::new();
    for (k, (over, at, cases)) in inputs.iter().enumerate() {
        tick(0.5 * k as f64 / inputs.len() as f64);
        for (s, study) in studies.iter_mut().enumerate().filter(|(_, study)| study.over == *over) {
            if study.topic == Topic::Log && *over == Over::Angle && *at > LOG_END {
                continue;
            }
            let exact: Vec<_> =
                cases.iter().map(|case| case.reference(study.topic, &mut rng)).collect();
            let contenders = match over {
                Over::Angle => contest::on_so3(study.topic, cases)?,
                Over::Size => contest::on_so_n(study.topic, cases)?,
            };
            for contender in contenders {
                let point = judged(*at, &contender, &exact);
                let line = study.line(contender.name);
                study.lines[line].points.push(point);
                let place = [s, line, study.lines[line].points.len() - 1];
                entries.push(Entry { place, contender, times: Vec::new() });
            }
        }
    }
    for round in 0..effort.rounds {
        for entry in &mut entries {
            entry.time();
        }
        tick(0.5 + 0.5 * f64::from(round + 1) / f64::from(effort.rounds));
    }
    for Entry { place: [study, line, point], mut times, .. } in entries {
        studies[study].lines[line].points[point].seconds = median(&mut times);
    }
    Ok(studies)
}

/// The page of the maps.
pub const MAPS_PAGE: &str = "maps.html";

/// The page with the figures.
pub fn page(studies: &[Study]) -> Page {
    page::page(studies)
}

/// The file of every point.
pub const MAPS_FILE: &str = "maps.csv";

/// Every point, as CSV.
pub fn points(studies: &[Study]) -> String {
    let header =
        ["map", "over", "contender", "at", "cases", "refused", "error_eps_cond", "seconds"];
    csv::table(header, page::points(studies))
}

impl Study {
    /// The place of the line of that name, made where there is none.
    fn line(&mut self, name: &'static str) -> usize {
        self.lines.iter().position(|line| line.name == name).unwrap_or_else(|| {
            self.lines.push(StudyLine { name, points: Vec::new() });
            self.lines.len() - 1
        })
    }
}

impl Entry {
    fn time(&mut self) {
        let calls = self.contender.values.len() as f64;
        let Ok(seconds) = seconds_of(SHORTEST, || {
            (self.contender.run)();
            Ok::<_, Infallible>(())
        });
        self.times.push(seconds / calls);
    }
}

fn judged(at: f64, contender: &Contender, exact: &[Option<(Matrix, f64)>]) -> StudyPoint {
    let (mut error, mut refused) = (f64::NAN, 0);
    for (value, exact) in contender.values.iter().zip(exact) {
        match (value, exact) {
            (None, _) => refused += 1,
            (Some(value), Some((exact, unit))) => {
                error = error.max((exact - &Matrix::of(value)).norm() / unit);
            }
            (Some(_), None) => {}
        }
    }
    StudyPoint { at, cases: contender.values.len(), refused, error, seconds: f64::NAN }
}
