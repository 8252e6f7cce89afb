//! Measured orders: every method of the catalog on problems that do not commute, depend on time and
//! depend on the state. `cargo test --test orders -- --nocapture` prints the table.

mod support;

use lieflow::actions::{Coadjoint, LeftTranslation, Linear};
use lieflow::catalog::{
    CatalogGroup, LINEAR_METHODS, MAPS, MethodSpec, OnMethod, with_linear_method, with_method,
};
use lieflow::groups::{MatrixGroup, Sample, So3};
use lieflow::maps::{Cay, CoordinateMap, Exp};
use lieflow::methods::Method;
use lieflow::methods::magnus::TripleProduct;
use lieflow::problems::{
    Ambient, LinearField, PointOf, Problem, RigidBody, RigidBodyAttitude, RigidBodyN,
    RigidBodyNAttitude,
};
use lieflow::{Error, LieAlgebra, LieGroup};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use support::orders::{
    Estimate, Field, Flow, LONG, MEMBERS, Reference, catalog, clock, estimate, grid, inertia,
    measure, measure_over, reference, reference_after, wave,
};
use support::points::Points;
use support::represent::Represent;

/// What happened to one method.
enum Outcome {
    /// It does not fit the group.
    Refused,
    /// Its order is above 4, and the ensembles for that are elsewhere.
    Elsewhere,
    Measured(Result<Estimate, String>),
}

/// Problems with their references. The first is for orders up to 4, all are for those above it.
struct Problems<P: Problem> {
    short: Vec<(P, Reference<P>)>,
    /// For orders from 8 on.
    long: Vec<(P, Reference<P>)>,
}

impl<P: Ambient> Problems<P>
where
    P::Group: Represent,
    P::Action: Points<P::Group>,
    Cay: CoordinateMap<P::Group>,
{
    /// A single one: orders above 4 are measured elsewhere.
    fn one(problem: P, start: PointOf<P>) -> Self {
        let reference = reference(&problem, start);
        Problems { short: vec![(problem, reference)], long: Vec::new() }
    }
    /// An ensemble, of problems by their number.
    fn many(make: impl Fn(u64) -> (P, PointOf<P>)) -> Self {
        let over = |length: f64| {
            move |(problem, start)| {
                let reference = reference_after(length, &problem, start);
                (problem, reference)
            }
        };
        Problems {
            short: (0..MEMBERS).map(&make).map(over(1.0)).collect(),
            long: (0..LONG.0).map(&make).map(over(LONG.1)).collect(),
        }
    }
}

/// What there is to measure on, and whether a single problem does for orders up to 4.
struct Measure<'a, P: Problem>(&'a Problems<P>, bool);

impl<P: Problem> OnMethod<P> for Measure<'_, P>
where
    P::Group: Represent,
    P::Action: Points<P::Group>,
{
    type Out = Outcome;
    fn call<M: Method<P>>(self, method: M) -> Outcome {
        let Measure(Problems { short, long }, single) = self;
        let (problem, reference) = &short[0];
        if matches!(method.work(problem, reference.start()), Err(Error::Unsupported { .. })) {
            return Outcome::Refused;
        }
        Outcome::Measured(match method.order(problem) {
            ..=4 if single => measure(problem, &method, reference),
            _ if long.is_empty() => return Outcome::Elsewhere,
            ..=7 => measure_over(short, &method),
            _ => measure_over(long, &method),
        })
    }
}

/// Does the catalog say that the method's map serves this group?
fn serves(spec: &MethodSpec, group: &str) -> bool {
    let Some(map) = &spec.map else { return true };
    let groups = MAPS.iter().find(|m| m.name == map).map_or("", |m| m.groups);
    let family = group.split('(').next().unwrap_or_default();
    let plain = !group.contains(','); // SO(p,q) is no SO(n)
    groups == "all" || (plain && groups.split(", ").any(|g| g.starts_with(&format!("{family}("))))
}

/// What was found on one problem: printed as a table, and all of it must hold.
struct Report {
    title: &'static str,
    table: String,
    failures: Vec<String>,
}

impl Report {
    fn new(title: &'static str) -> Self {
        Report { title, table: format!("{title}\n"), failures: Vec::new() }
    }
    /// A method that should be measured, or be refused.
    fn add(&mut self, label: &str, serves: bool, outcome: Outcome) {
        match outcome {
            Outcome::Refused if serves => self.failures.push(format!("{label}: refused")),
            Outcome::Refused | Outcome::Elsewhere => {}
            Outcome::Measured(_) if !serves => {
                self.failures.push(format!("{label}: taken although the catalog says otherwise"));
            }
            Outcome::Measured(measured) => {
                let verdict = measured.as_ref().map_err(Clone::clone).and_then(Estimate::check);
                if let Err(reason) = verdict {
                    self.failures.push(format!("{label}: {reason}"));
                }
                if let Ok(m) = measured {
                    let how = if m.two_terms { ", two terms" } else { "" };
                    self.table += &format!("  {label:<30} {}  {:.2?}{how}\n", m.claimed, m.slopes);
                }
            }
        }
    }
    fn assert(self) {
        let Report { title, table, failures } = self;
        println!("{table}");
        assert!(failures.is_empty(), "{title}:\n  {}", failures.join("\n  "));
    }
}

/// Measure every method of the catalog, and require the orders that they claim.
fn every_method_on<P: Ambient>(title: &'static str, problems: Problems<P>)
where
    P::Group: Represent + CatalogGroup,
    P::Action: Points<P::Group>,
    Cay: CoordinateMap<P::Group>,
    Exp: CoordinateMap<P::Group>,
{
    let group = problems.short[0].0.group().name();
    let mut report = Report::new(title);
    for spec in catalog() {
        let outcome = with_method(&spec, Measure(&problems, true)).unwrap();
        report.add(&spec.label(), serves(&spec, &group), outcome);
    }
    report.assert();
}

/// The same for the methods that want a field of linear type. Some of order 4 are so accurate there
/// that the grid of that order has rounding on it.
fn every_linear_method_on<P: LinearField + Ambient>(title: &'static str, problems: Problems<P>)
where
    P::Group: Represent + TripleProduct,
    P::Action: Points<P::Group>,
    Cay: CoordinateMap<P::Group>,
    Exp: CoordinateMap<P::Group>,
{
    let mut report = Report::new(title);
    for info in LINEAR_METHODS {
        report.add(
            info.name,
            true,
            with_linear_method(info.name, Measure(&problems, false)).unwrap(),
        );
    }
    report.assert();
}

/// One test a problem, from its group, its action and its field; `one` of them, or `many` with the
/// number of each in the seeds.
macro_rules! orders {
    ($every:ident: $($name:ident: $count:ident, $group:expr, $action:expr, $field:expr;)*) => {$(
        #[test]
        fn $name() {
            let flow = |i: u64| Flow::new($group, $action, $field(i));
            $every(stringify!($name), problems!($count, flow));
        }
    )*};
}
macro_rules! problems {
    (one, $flow:ident) => {{
        let flow = $flow(0);
        let start = flow.start(7);
        Problems::one(flow, start)
    }};
    (many, $flow:ident) => {
        Problems::many(|i| ($flow(i), $flow(i).group().identity()))
    };
}

/// [`wave`] in dimension n, so strong, with coefficients from this seed on.
fn waves(n: usize, strength: f64, seed: u64) -> impl Fn(u64) -> Field {
    move |i| wave(n, strength, seed + 100 * i)
}

/// [`clock`] in the same way.
fn clocks(n: usize, strength: f64) -> impl Fn(u64) -> Field {
    move |i| clock(n, strength, 21 + 100 * i)
}

orders! {
    every_method_on:
    translation_on_so3_closed: many, So3::new(), LeftTranslation, waves(3, 0.5, 11);
    translation_on_so3: one, MatrixGroup::so(3).unwrap(), LeftTranslation, waves(3, 0.5, 11);
    translation_on_so5: many, MatrixGroup::so(5).unwrap(), LeftTranslation, waves(5, 0.5, 11);
    translation_on_gl3: many, MatrixGroup::gl(3).unwrap(), LeftTranslation, waves(3, 0.2, 12);
    translation_on_sp4: many, MatrixGroup::sp(4).unwrap(), LeftTranslation, waves(4, 0.25, 12);
    translation_on_so31: many, MatrixGroup::indefinite(3, 1).unwrap(), LeftTranslation, waves(4, 0.35, 11);
    orbits_of_so3_closed: one, So3::new(), Coadjoint, |_| inertia(3);
    orbits_of_so4: one, MatrixGroup::so(4).unwrap(), Coadjoint, |_| inertia(4);
    orbits_of_sp4: one, MatrixGroup::sp(4).unwrap(), Coadjoint, waves(4, 0.25, 16);
    vectors_of_so3_closed: one, So3::new(), Linear, waves(3, 1.0, 17);
    vectors_of_gl3: one, MatrixGroup::gl(3).unwrap(), Linear, waves(3, 0.25, 18);
}

orders! {
    every_linear_method_on:
    linear_on_so3_closed: many, So3::new(), LeftTranslation, clocks(3, 1.5);
    linear_on_so5: many, MatrixGroup::so(5).unwrap(), LeftTranslation, clocks(5, 1.0);
    linear_on_gl3: many, MatrixGroup::gl(3).unwrap(), LeftTranslation, clocks(3, 0.7);
    linear_on_sp4: many, MatrixGroup::sp(4).unwrap(), LeftTranslation, clocks(4, 0.7);
    linear_on_so31: many, MatrixGroup::indefinite(3, 1).unwrap(), LeftTranslation, clocks(4, 1.0);
}

#[test]
fn rigid_bodies() {
    let (inertia, momentum) = ([1.0, 2.0, 3.5], [1.0, 0.8, -1.2]);
    let body = RigidBody::new(inertia).unwrap();
    every_method_on("the rigid body", Problems::one(body, momentum.into()));
    let attitude = RigidBodyAttitude::new(inertia, momentum).unwrap();
    every_method_on("its attitude", Problems::one(attitude, nalgebra::Matrix3::identity()));

    let manakov = RigidBodyN::manakov(&[0.4, 1.1, 1.9, 2.5]).unwrap();
    let group = manakov.group().clone();
    let mut rng = Pcg64::seed_from_u64(8);
    let start = group.sample_algebra(&mut rng, 2.0).into_mat();
    every_method_on("Manakov's body, n = 4", Problems::one(manakov.clone(), start.clone()));
    let attitude = RigidBodyNAttitude::new(manakov, start).unwrap();
    every_method_on("its attitude, n = 4", Problems::one(attitude, group.sample_element(&mut rng)));
}

#[test]
fn the_estimator_reads_the_ratios_of_the_grid() {
    let steps = grid(4);
    let errors = |p: i32, size: f64| steps.map(|n| size * (n as f64).powi(-p));
    // Exact powers are read exactly, and a wrong claim is refused.
    let measured = estimate(3, &steps, &errors(3, 0.1)).unwrap();
    assert!((measured.order() - 3.0).abs() < 1e-12);
    assert!(measured.check().is_ok());
    assert!(estimate(4, &steps, &errors(3, 0.1)).unwrap().check().is_err());
    // An average would hide one bad pair; the pairwise rule does not.
    let mut dented = errors(4, 1.0);
    dented[5] *= 1.1;
    assert!(estimate(4, &steps, &dented).unwrap().check().is_err());
    // Errors at the level of rounding, too large or not numbers are not points.
    for flat in [1e-14, 0.5, f64::NAN] {
        assert!(estimate(4, &steps, &[flat; 7]).is_err());
    }
}
