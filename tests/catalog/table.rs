//! One table: a row is a problem with what it offers to methods, a column is a check, a cell is a method
//! of the catalog, with each map and tableau that it takes.
//!
//! | column | claim |
//! |---|---|
//! | `Fit` | a method is served where the problem offers what it needs, with its order, and refused elsewhere |
//! | `Allocations` | a step allocates nothing, nor does the way back to M |
//! | `Promises` | what the catalog says that a method preserves is preserved, step after step |

use faer::Mat;
use lieflow::actions::LeftTranslation;
use lieflow::catalog::{MethodInfo, MethodSpec, Needs, Property};
use lieflow::groups::{AlgebraMatrix, ComplexMatrix, MatrixGroup, Sample, So3};
use lieflow::methods::Metric;
use lieflow::problems::{
    Flow, PointOf, Problem, RigidBody, RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude,
    RigidBodyQuaternion, RigidBodyState, Surface, Zeitlin,
};
use lieflow::{Error, LieAlgebra, LieGroup, Method, SaveAt, Step, TimeGrid, integrate};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::allocations::of_steps;
use super::symmetry::there_and_back;
use crate::support::named::{self, Named};
use crate::support::orders::specs;

/// A number of a state, with what it shows.
type Quantity<P> = (Property, fn(&P, &PointOf<P>) -> f64);

/// A problem with what it offers, as the catalog's documentation says: methods with other needs are refused.
struct Row<P: Problem> {
    name: String,
    offers: &'static [Needs],
    problem: P,
    start: PointOf<P>,
    quantities: Vec<Quantity<P>>,
    scope: Scope,
}

/// Which cells a row has.
#[derive(Clone, Copy, PartialEq)]
enum Scope {
    /// All.
    Whole,
    /// Those of allocations: on larger matrices other kernels run, and promises are as on small ones.
    Steps,
    /// Those with the classical tableau and the maps exp and cay.
    Few,
}

impl<P: Problem> Row<P> {
    fn new(name: &str, offers: &'static [Needs], problem: P, start: PointOf<P>) -> Self {
        Row {
            name: name.into(),
            offers,
            problem,
            start,
            quantities: Vec::new(),
            scope: Scope::Whole,
        }
    }
    fn with(mut self, quantities: &[Quantity<P>]) -> Self {
        self.quantities = quantities.to_vec();
        self
    }
    fn of(mut self, scope: Scope) -> Self {
        self.scope = scope;
        self
    }
}

/// A column of the table.
#[derive(Clone, Copy, PartialEq)]
enum Column {
    Fit,
    Allocations,
    Promises,
}

/// A column as it is filled: the cells that were seen, and what is broken.
struct Sheet {
    column: Column,
    cells: usize,
    broken: Vec<String>,
}

/// Every method of the catalog on a row, by one of the functions of [`named`].
macro_rules! row {
    ($sheet:ident, $family:ident, $row:expr) => {{
        let row = $row;
        for needs in Needs::ALL {
            for spec in &specs(&[needs]) {
                let info = spec.info().expect("a method of the list");
                if !$sheet.asks(spec, row.scope) {
                    continue;
                }
                let answer = named::$family(spec, |method| $sheet.cell(&row, info, spec, method));
                if let Err(error) = answer {
                    $sheet.refusal(&row, info, needs, error);
                }
            }
        }
    }};
}

const INERTIA: [f64; 3] = [1.0, 2.0, 3.0];

/// The free rigid body in ℝ³, in all its forms.
fn bodies(sheet: &mut Sheet) {
    use Needs::{Attitude, Body, Field, LiePoisson, Momentum, Norm, Series, State};
    const ON_MOMENTA: &[Needs] = &[Field, Norm, Series, Body, Momentum, LiePoisson];
    const WITH_ATTITUDE: &[Needs] = &[Field, Norm, Series, Body, Attitude];
    let m = Vector3::new(0.9, 1.0, 2.1);
    let body = RigidBody::<f64>::new(INERTIA).expect("a body");
    row!(
        sheet,
        momentum,
        Row::new("the momentum", ON_MOMENTA, body, m).with(&[
            (Property::Energy, |body, m| body.energy(m)),
            (Property::Casimirs, |_, m| m.norm()),
            (Property::QuadraticInvariants, |_, m| m.norm_squared()),
        ])
    );
    let body = RigidBodyAttitude::<f64>::new(INERTIA, m.into()).expect("a body");
    row!(
        sheet,
        attitude,
        Row::new("the attitude", WITH_ATTITUDE, body, Matrix3::identity())
            .with(&[(Property::Group, |body, g| 1.0 + body.group().defect(g))])
    );
    let body = RigidBodyState::<f64>::new(INERTIA).expect("a body");
    let state = body.state(m.into(), Matrix3::identity()).expect("a state");
    let both = |offers| {
        Row::new("momentum and attitude", offers, body, state).with(&[
            (Property::Energy, |body, y| body.energy(y)),
            (Property::Casimirs, |_, y| y.m.norm()),
            (Property::QuadraticInvariants, |_, y| y.m.norm_squared()),
            (Property::Group, |body, y| 1.0 + body.group().defect(&y.g)),
        ])
    };
    row!(sheet, attitude, both(WITH_ATTITUDE));
    row!(sheet, body, both(&[Field, Norm, Series, Body]));
    row!(sheet, state, both(&[State]));
    let body = RigidBodyQuaternion::new(INERTIA, m.into()).expect("a body");
    row!(
        sheet,
        quaternion,
        Row::new("the quaternion", &[Field, Norm, Series, Body], body, UnitQuaternion::identity())
            .with(&[
                (Property::Group, |_, q| q.coords.norm()),
                (Property::QuadraticInvariants, |_, q| q.coords.norm()),
            ])
    );
}

/// Manakov's body in ℝⁿ, by its momentum and by its attitude.
fn bodies_in_n_dimensions(sheet: &mut Sheet) {
    use Needs::{Field, Isospectral, LiePoisson, Norm, Series};
    for n in [2usize, 3, 4, 5, 8, 9, 16, 17, 33] {
        let scope = if n > 5 { Scope::Steps } else { Scope::Whole };
        let lambda: Vec<f64> =
            (0..n).map(|i| 0.4 + 0.6 * i as f64 + 0.01 * (i * i) as f64).collect();
        let body = RigidBodyN::manakov(&lambda).expect("a body");
        let m = body.group().sample_algebra(&mut Pcg64::seed_from_u64(5), 0.7).into_mat();
        let attitude = RigidBodyNAttitude::new(body.clone(), m.clone()).expect("a body");
        let identity = attitude.group().identity();
        let name = format!("the momentum in ℝ^{n}");
        let offers = &[Field, Norm, Series, LiePoisson, Isospectral];
        let momentum = Row::new(&name, offers, body, m).of(scope).with(&[
            (Property::Energy, |body, m| body.energy(m)),
            (Property::Casimirs, |_, m| {
                let square = m * m;
                let trace = |x: &Mat<f64>| (0..x.nrows()).map(|i| x[(i, i)]).sum::<f64>();
                trace(&square) + trace(&(&square * &square))
            }),
        ]);
        row!(sheet, lie_poisson, momentum);
        let name = format!("the attitude in ℝ^{n}");
        let offers: &[_] = if n == 3 { &[Field, Norm] } else { &[Field, Norm, Series] };
        let attitude = Row::new(&name, offers, attitude, identity)
            .of(scope)
            .with(&[(Property::Group, |body, g| 1.0 + body.group().defect(g))]);
        match n {
            3 => row!(sheet, field, attitude),
            _ => row!(sheet, series, attitude),
        }
    }
}

/// ẏ = A(t)·y, on which time alone acts.
fn linear_equations(sheet: &mut Sheet) {
    let so3 = Flow::of_time(So3::new(), LeftTranslation, |t: f64, v: &mut Vector3<f64>| {
        *v = Vector3::new(t.cos(), t.sin(), 1.0);
    });
    row!(
        sheet,
        linear,
        Row::new("a linear equation on SO(3)", &[Needs::LinearType], so3, Matrix3::identity())
    );
    for n in [2usize, 3, 4, 5, 8, 10, 20] {
        let mut groups =
            vec![MatrixGroup::so(n), MatrixGroup::gl(n), MatrixGroup::indefinite(n - 1, 1)];
        groups.extend((n % 2 == 0).then(|| MatrixGroup::sp(n)));
        let scope = if n > 5 { Scope::Steps } else { Scope::Whole };
        for group in groups {
            let group = group.expect("a group");
            let name = format!("a linear equation on {}", group.name());
            let mut rng = Pcg64::seed_from_u64(n as u64);
            let [u, v] = [0, 1].map(|_| group.sample_algebra(&mut rng, 0.3));
            let (start, inner) = (group.identity(), group.clone());
            let field = move |t: f64, a: &mut AlgebraMatrix| {
                inner.set_zero(a);
                inner.axpy(t.cos(), &u, a);
                inner.axpy(t.sin(), &v, a);
            };
            let problem = Flow::of_time(group, LeftTranslation, field);
            row!(sheet, linear, Row::new(&name, &[Needs::LinearType], problem, start).of(scope));
        }
    }
}

/// Zeitlin's fluids. There is no promise here: `problems/fluids_catalog.rs` measures them beside the orders.
fn fluids(sheet: &mut Sheet) {
    use Needs::{Field, Isospectral, LiePoisson, Norm};
    fn of<S: Surface>(sheet: &mut Sheet, fluid: Zeitlin<S>, w: ComplexMatrix) {
        let scope = if fluid.n() > 7 { Scope::Few } else { Scope::Whole };
        let (n, offers) = (fluid.n(), &[Field, Norm, LiePoisson, Isospectral]);
        row!(sheet, fluid, Row::new(&format!("a fluid, N = {n}"), offers, fluid, w).of(scope));
    }
    let mut rng = Pcg64::seed_from_u64(1);
    for n in [2, 7, 33, 65] {
        let sphere = Zeitlin::sphere(n).expect("a sphere");
        let w = sphere.random(&mut rng, 2.max(n / 3)).expect("a field");
        of(sheet, sphere, w);
    }
    let torus = Zeitlin::torus(33).expect("a torus");
    let w = torus.random(&mut rng, 5).expect("a field");
    of(sheet, torus, w);
}

/// Relative deviations that are rounding: of a thousand steps with one update each, and of two.
const KEPT: f64 = 2e-13;
/// The group at every step of a run: docs/promises.md, 5.
const ON_THE_GROUP: f64 = 2e-14;
const UNDONE: f64 = 3e-14;

/// Updates of the state a step, each with its own rounding: compositions have the steps of Suzuki and of
/// Kahan and Li.
fn updates(name: &str) -> f64 {
    match name {
        "cf-ls32" => 3.0,
        "energy-casimir4" | "isospectral-suzuki4" | "cf-ls5" => 5.0,
        "energy-casimir6" | "isospectral-kahan-li6" => 9.0,
        _ => 1.0,
    }
}

impl Sheet {
    fn new(column: Column) -> Self {
        Sheet { column, cells: 0, broken: Vec::new() }
    }

    /// Has this method a cell in this column?
    fn asks(&self, spec: &MethodSpec, scope: Scope) -> bool {
        let [map, tableau] = [(&spec.map, "exp"), (&spec.tableau, "rk4")]
            .map(|(name, otherwise)| name.as_deref().unwrap_or(otherwise));
        let plain = ["exp", "cay"].contains(&map) && tableau == "rk4" && spec.q.is_none();
        match self.column {
            Column::Allocations => plain || spec.q.is_none() && scope != Scope::Few,
            Column::Fit | Column::Promises => plain && scope == Scope::Whole,
        }
    }

    fn cell<'p, P>(
        &mut self,
        row: &Row<P>,
        info: &MethodInfo,
        spec: &MethodSpec,
        method: &Named<'p, P>,
    ) where
        P: Problem + 'p,
        P::Group: LieAlgebra<Scalar = f64>,
        PointOf<P>: Metric<Scalar = f64>,
    {
        self.cells += 1;
        let place = format!("{} on {}", spec.label(), row.name);
        match self.column {
            Column::Fit => {
                assert!(row.offers.contains(&info.needs), "{place}: served without what it needs");
                let order = method.facts(&row.problem).order;
                assert!(info.order.number().is_none_or(|p| p == order), "{place}: {order}");
                let mut y = row.start.clone();
                let mut work = method.work(&row.problem, &y).expect("it fits");
                let step = Step { n: 0, t: 0.0, h: 0.01 };
                method.step(&row.problem, step, &mut y, &mut work).expect("a step");
            }
            // Not every group has a formula for every map.
            Column::Allocations if method.work(&row.problem, &row.start).is_err() => {
                assert!(spec.map.as_deref().is_some_and(|map| map.starts_with("ccsk")), "{place}");
            }
            Column::Allocations => {
                assert_eq!(of_steps(&row.problem, method, &row.start), 0, "{place}");
            }
            Column::Promises => self.promises(row, info, &place, method),
        }
    }

    /// A method that the catalog does not serve on this problem, or not with this map.
    fn refusal<P: Problem>(&self, row: &Row<P>, info: &MethodInfo, needs: Needs, error: Error) {
        if self.column != Column::Fit {
            return;
        }
        match error {
            Error::Unsupported { what, .. } => {
                assert_eq!(what, info.name);
                assert!(error.to_string().contains(needs.describe()), "{error}");
            }
            other => panic!("{}: {other}", info.name),
        }
        let Row { name, offers, .. } = row;
        assert!(!offers.contains(&needs), "{}: refused on {name} with {needs:?}", info.name);
    }

    /// The largest relative deviation of each quantity, and the gap after a step there and back.
    fn promises<'p, P>(
        &mut self,
        row: &Row<P>,
        info: &MethodInfo,
        place: &str,
        method: &Named<'p, P>,
    ) where
        P: Problem + 'p,
        P::Group: LieAlgebra<Scalar = f64>,
        PointOf<P>: Metric<Scalar = f64>,
    {
        let Row { problem, start, quantities, .. } = row;
        let values = |y: &PointOf<P>| quantities.iter().map(|(_, q)| q(problem, y)).collect();
        let first: Vec<f64> = values(start);
        let mut worst = vec![0.0f64; first.len()];
        let grid = TimeGrid::with_steps([0.0, 50.0], 1000).expect("a grid");
        let mut y = start.clone();
        integrate(problem, method, &grid, &SaveAt::Every(10), &mut y, |_, y| {
            let now: Vec<f64> = values(y);
            for (worst, (now, first)) in worst.iter_mut().zip(now.iter().zip(&first)) {
                *worst = worst.max((now - first).abs() / first.abs().max(1.0));
            }
        })
        .unwrap_or_else(|error| panic!("{place}: {error}"));
        let mut deviations: Vec<_> = quantities.iter().map(|(word, _)| *word).zip(worst).collect();
        deviations.push((Property::TimeSymmetry, there_and_back(problem, method, start, 0.2)));
        let numbers: Vec<_> =
            deviations.iter().map(|(word, d)| format!("{word} {d:.0e}")).collect();
        println!("{place}: {}", numbers.join(", "));
        for (word, deviation) in &deviations {
            let bound = match *word {
                Property::TimeSymmetry => UNDONE,
                // A product of many exponentials, each with its rounding, between two ways back to the group.
                Property::Group if place.starts_with("cg4 on the attitude in") => {
                    1.5 * ON_THE_GROUP
                }
                Property::Group => ON_THE_GROUP,
                _ => KEPT * updates(info.name),
            };
            // No step of the exact motion undoes another to the last bit.
            let asked = info.preserves.contains(word)
                || info.keeps(*word) && *word != Property::TimeSymmetry;
            if asked && (deviation.is_nan() || *deviation >= bound) {
                self.broken.push(format!("{place}: {word} {deviation:e}"));
            }
        }
        // A method that promises none of it keeps none of it: the measurement sees.
        if info.name == "rk4" && quantities.len() == 4 {
            assert!(deviations.iter().all(|(_, deviation)| *deviation > 1e-10), "{deviations:?}");
        }
    }
}

/// The column over these parts of the table, with at least so many cells.
fn fill(column: Column, parts: &[fn(&mut Sheet)], least: usize) {
    let mut sheet = Sheet::new(column);
    parts.iter().for_each(|part| part(&mut sheet));
    println!("{} cells", sheet.cells);
    assert!(sheet.cells >= least, "{}", sheet.cells);
    assert!(sheet.broken.is_empty(), "{}", sheet.broken.join("\n"));
}

/// Each problem serves the methods that fit it, no more and no less, and a clear error names the others.
#[test]
fn methods_fit_as_the_catalog_says() {
    fill(Column::Fit, &[bodies, bodies_in_n_dimensions, linear_equations, fluids], 300);
    let body = RigidBodyN::manakov(&[0.4, 0.9, 1.3]).expect("a body");
    let refused =
        named::explicit(&MethodSpec::new("mr4", None), |method| method.facts(&body).order);
    let text = refused.expect_err("it does not fit").to_string();
    assert!(text.contains("mr4") && text.contains("a free rigid body"), "{text}");
    assert!(matches!(MethodSpec::new("mr9", None).info(), Err(Error::UnknownName { .. })));
}

#[test]
fn a_step_allocates_nothing() {
    fill(Column::Allocations, &[bodies, linear_equations], 300);
}

#[test]
fn a_step_of_matrices_allocates_nothing() {
    fill(Column::Allocations, &[bodies_in_n_dimensions, fluids], 1000);
}

#[test]
fn what_is_promised_is_preserved() {
    fill(Column::Promises, &[bodies, bodies_in_n_dimensions, linear_equations], 100);
}
