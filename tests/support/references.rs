//! References of 25 digits and more, in one schema: see `tests/references/README.md`.

use std::collections::BTreeMap;

use faer::{Mat, c64};
use lieflow::groups::MatrixGroup;
use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;

/// Decimal digits: a real number, or the two parts of a complex one.
#[derive(Deserialize)]
#[serde(untagged)]
enum Number {
    Real(String),
    Complex([String; 2]),
}

impl Number {
    fn complex(&self) -> c64 {
        let number = |text: &str| text.parse().expect("a decimal number");
        match self {
            Number::Real(re) => c64::new(number(re), 0.0),
            Number::Complex([re, im]) => c64::new(number(re), number(im)),
        }
    }
}

/// What a function gives, with measures of it by name, such as its condition.
#[derive(Deserialize)]
pub(crate) struct Output {
    value: Option<Vec<Number>>,
    #[serde(flatten)]
    measures: BTreeMap<String, String>,
}

impl Output {
    /// Is the function defined there, and in the range of doubles?
    pub(crate) fn is_defined(&self) -> bool {
        self.value.is_some()
    }
    pub(crate) fn complex(&self) -> Vec<c64> {
        self.value.as_ref().expect("a value").iter().map(Number::complex).collect()
    }
    pub(crate) fn numbers(&self) -> Vec<f64> {
        self.complex().into_iter().map(|x| x.re).collect()
    }
    pub(crate) fn measure(&self, name: &str) -> Option<f64> {
        self.measures.get(name).map(|x| x.parse().expect("a decimal number"))
    }
    /// The condition, at least 1.
    pub(crate) fn cond(&self) -> f64 {
        self.measure("cond").unwrap_or(1.0).max(1.0)
    }
}

/// Inputs, and what functions give at them.
#[derive(Deserialize)]
pub(crate) struct Case {
    pub(crate) id: String,
    pub(crate) group: String,
    pub(crate) n: usize,
    input: BTreeMap<String, Vec<Number>>,
    pub(crate) output: BTreeMap<String, Output>,
}

impl Case {
    pub(crate) fn has(&self, input: &str) -> bool {
        self.input.contains_key(input)
    }
    fn entries(&self, name: &str) -> Vec<c64> {
        let missing = || panic!("{} has no input {name}", self.id);
        self.input.get(name).unwrap_or_else(missing).iter().map(Number::complex).collect()
    }
    pub(crate) fn numbers(&self, name: &str) -> Vec<f64> {
        self.entries(name).into_iter().map(|x| x.re).collect()
    }
    /// An element of so(3), given as a vector or as a matrix.
    pub(crate) fn vector(&self, name: &str) -> Vector3<f64> {
        Vector3::from_vec(vee(&self.numbers(name)))
    }
    pub(crate) fn matrix3(&self, name: &str) -> Matrix3<f64> {
        Matrix3::from_row_slice(&hat(&self.numbers(name)))
    }
    /// An n×n matrix, given as such or, on so(3), as a vector.
    pub(crate) fn matrix(&self, name: &str) -> Mat<f64> {
        square(self.n, &hat(&self.numbers(name)))
    }
    pub(crate) fn complex(&self, name: &str) -> Mat<c64> {
        square(self.n, &self.entries(name))
    }
    pub(crate) fn matrix_group(&self) -> MatrixGroup {
        let n = self.n;
        match self.group.as_str() {
            "so" => MatrixGroup::so(n),
            "sp" => MatrixGroup::sp(n),
            "gl" => MatrixGroup::gl(n),
            "lorentz" => MatrixGroup::indefinite(3, 1),
            "so22" => MatrixGroup::indefinite(2, 2),
            // U(m) = G_M with M = 𝟙 + J.
            "gm" => MatrixGroup::gm(Mat::from_fn(n, n, |i, j| {
                f64::from(i == j) + f64::from(j == i + n / 2) - f64::from(i == j + n / 2)
            })),
            other => panic!("no group `{other}`"),
        }
        .expect("a group")
    }
}

/// The matrix of these entries, row by row.
pub(crate) fn square<T: Copy>(n: usize, entries: &[T]) -> Mat<T> {
    Mat::from_fn(n, n, |i, j| entries[i * n + j])
}

/// The entries of a matrix, row by row.
pub(crate) fn rows(x: &Mat<f64>) -> Vec<f64> {
    (0..x.nrows()).flat_map(|i| (0..x.ncols()).map(move |j| x[(i, j)])).collect()
}

/// Three numbers as a skew matrix by rows; others as they are.
pub(crate) fn hat(x: &[f64]) -> Vec<f64> {
    match *x {
        [x, y, z] => vec![0.0, -z, y, z, 0.0, -x, -y, x, 0.0],
        _ => x.to_vec(),
    }
}

/// A skew 3×3 matrix by rows as three numbers; others as they are.
pub(crate) fn vee(x: &[f64]) -> Vec<f64> {
    match *x {
        [_, _, y, z, _, _, _, x, _] => vec![x, y, z],
        _ => x.to_vec(),
    }
}

/// The cases of a file in `tests/references`.
pub(crate) fn cases(file: &str) -> Vec<Case> {
    #[derive(Deserialize)]
    struct File {
        cases: Vec<Case>,
    }
    let path = format!("{}/references/{file}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    serde_json::from_str::<File>(&text).unwrap_or_else(|e| panic!("{path}: {e}")).cases
}

/// ‖x − r‖/‖r‖, scaled so that no square leaves the range.
pub(crate) fn relative_error(x: &[f64], r: &[f64]) -> f64 {
    let size = r.iter().fold(0.0f64, |s, r| s.max(r.abs()));
    if size == 0.0 {
        return if x.iter().all(|x| *x == 0.0) { 0.0 } else { f64::INFINITY };
    }
    let norm = |y: &mut dyn Iterator<Item = f64>| y.map(|y| (y / size).powi(2)).sum::<f64>().sqrt();
    assert_eq!(x.len(), r.len());
    norm(&mut x.iter().zip(r).map(|(x, r)| x - r)) / norm(&mut r.iter().copied())
}

/// A value by rows, or why it is refused; none where the implementation cannot do this.
pub(crate) type Answer = Option<Result<Vec<f64>, String>>;

/// An implementation of some of the functions.
pub(crate) struct Implementation {
    pub(crate) name: &'static str,
    /// The rounding unit of its numbers.
    pub(crate) eps: f64,
    pub(crate) compute: fn(&Case, &str) -> Answer,
    /// The promise at a case: the largest relative error in units of `eps`.
    pub(crate) bound: fn(&Case, &str, &Output) -> f64,
    /// May it refuse this?
    pub(crate) may_refuse: fn(&Case, &str, &Output) -> bool,
}

impl Implementation {
    /// Hold it to every reference of these files that it can do, at least so many.
    pub(crate) fn check(&self, files: &[&str], least: usize) {
        let mut rows: BTreeMap<String, (f64, String, usize)> = BTreeMap::new();
        let (mut seen, mut broken) = (0, Vec::new());
        for (file, case) in
            files.iter().flat_map(|file| cases(file).into_iter().map(move |c| (file, c)))
        {
            for (function, output) in case.output.iter().filter(|(_, output)| output.is_defined()) {
                let place = format!("{function} at {file} {} {}({})", case.id, case.group, case.n);
                let value = match (self.compute)(&case, function) {
                    None => continue,
                    Some(Ok(value)) => value,
                    Some(Err(error)) => {
                        if !(self.may_refuse)(&case, function, output) {
                            broken.push(format!("{place}: {error}"));
                        }
                        continue;
                    }
                };
                let exact = output.numbers();
                let exact = match value.len() {
                    3 => vee(&exact),
                    9 => hat(&exact),
                    len if len == exact.len() => exact,
                    _ => output.complex().into_iter().flat_map(|x| [x.re, x.im]).collect(),
                };
                let bound = (self.bound)(&case, function, output);
                let units = relative_error(&value, &exact) / self.eps;
                let row = rows.entry(function.clone()).or_default();
                row.2 += 1;
                seen += 1;
                if units / bound > row.0 || row.1.is_empty() {
                    (row.0, row.1) = (units / bound, place.clone());
                }
                if units.is_nan() || units > bound {
                    broken.push(format!("{place}: {units:.3e} eps, expected at most {bound:.3e}"));
                }
            }
        }
        for (function, (part, place, count)) in &rows {
            println!(
                "{}: {function:12} {count:3} cases, worst {part:.2} of the bound, {place}",
                self.name
            );
        }
        assert!(broken.is_empty(), "{}:\n  {}", self.name, broken.join("\n  "));
        assert!(seen >= least, "{}: {seen} values", self.name);
    }
}

/// A reference of the free rigid body, in numbers.
pub(crate) struct BodyMotion {
    pub(crate) id: String,
    pub(crate) inertia: [f64; 3],
    pub(crate) momentum: [f64; 3],
    pub(crate) attitude0: Option<Matrix3<f64>>,
    pub(crate) t: f64,
    pub(crate) m: Vector3<f64>,
    pub(crate) g: Matrix3<f64>,
    /// What one ulp of an input changes, of m and of g.
    pub(crate) ulp: [f64; 2],
}

/// The motions whose names begin so.
pub(crate) fn motions(of: &str) -> Vec<BodyMotion> {
    let motion = |case: Case| {
        let [m, g] = ["m", "g"].map(|name| &case.output[name]);
        BodyMotion {
            inertia: case.vector("inertia").into(),
            momentum: case.vector("momentum").into(),
            attitude0: case.has("attitude0").then(|| case.matrix3("attitude0")),
            t: case.numbers("t")[0],
            m: Vector3::from_vec(m.numbers()),
            g: Matrix3::from_row_slice(&g.numbers()),
            ulp: [m, g].map(|output| output.measure("ulp").expect("the change by one ulp")),
            id: case.id,
        }
    };
    let motions: Vec<_> =
        cases("rigid_body").into_iter().filter(|c| c.id.starts_with(of)).map(motion).collect();
    assert!(!motions.is_empty(), "no case of {of}");
    motions
}
