//! Measured orders: every method of the catalog on problems that do not commute, depend on time and
//! depend on the state. `cargo test --test orders -- --nocapture` prints the table.

mod support;

use lieflow::LieAlgebra;
use lieflow::actions::{Coadjoint, LeftTranslation, Linear};
use lieflow::catalog::{CatalogGroup, MAPS, MethodSpec, OnMethod, TABLEAUS, with_method};
use lieflow::groups::{MatrixGroup, Sample, So3};
use lieflow::maps::{Cay, CoordinateMap, Exp};
use lieflow::methods::{Method, tableau};
use lieflow::problems::{
    Ambient, Problem, RigidBody, RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude,
};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use support::orders::{
    Estimate, Flow, Reference, catalog, estimate, grid, inertia, measure, order_conditions,
    reference, wave,
};
use support::points::Points;
use support::represent::Represent;

/// What happened to one method.
enum Outcome {
    /// It does not fit the group.
    Refused,
    /// Its order is above 4: on these grids its errors are rounding. `tests/tableaus.rs` and
    /// `tests/cf.rs` have problems and grids for it.
    Elsewhere,
    Measured(Result<Estimate, String>),
}

struct Measure<'a, P: Problem> {
    problem: &'a P,
    reference: &'a Reference<P>,
}

impl<P: Problem> OnMethod<P> for Measure<'_, P>
where
    P::Group: Represent,
    P::Action: Points<P::Group>,
{
    type Out = Outcome;
    fn call<M: Method<P>>(self, method: M) -> Outcome {
        if method.order(self.problem) > 4 {
            return Outcome::Elsewhere;
        }
        match method.work(self.problem, self.reference.start()) {
            Err(lieflow::Error::Unsupported { .. }) => Outcome::Refused,
            _ => Outcome::Measured(measure(self.problem, &method, self.reference)),
        }
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

/// Measure every method of the catalog, and require the orders that they claim.
fn every_method_on<P: Ambient>(title: &str, problem: P, start: lieflow::problems::PointOf<P>)
where
    P::Group: Represent + CatalogGroup,
    P::Action: Points<P::Group>,
    Cay: CoordinateMap<P::Group>,
    Exp: CoordinateMap<P::Group>,
{
    let reference = reference(&problem, start);
    let group = problem.group().name();
    let mut failures = Vec::new();
    let mut table = format!("{title}\n");
    for spec in catalog() {
        let measure = Measure { problem: &problem, reference: &reference };
        let label = spec.label();
        match with_method(&spec, measure).unwrap() {
            Outcome::Refused if serves(&spec, &group) => failures.push(format!("{label}: refused")),
            Outcome::Refused | Outcome::Elsewhere => {}
            Outcome::Measured(_) if !serves(&spec, &group) => {
                failures.push(format!("{label}: taken although the catalog says otherwise"));
            }
            Outcome::Measured(measured) => {
                let verdict = measured.as_ref().map_err(Clone::clone).and_then(Estimate::check);
                if let Err(reason) = verdict {
                    failures.push(format!("{label}: {reason}"));
                }
                if let Ok(m) = measured {
                    table += &format!("  {label:<30} {}  {:.2?}\n", m.claimed, m.slopes);
                }
            }
        }
    }
    println!("{table}");
    assert!(failures.is_empty(), "{title}:\n  {}", failures.join("\n  "));
}

/// One test a problem, from its group, its action and its field.
macro_rules! orders {
    ($($name:ident: $group:expr, $action:expr, $field:expr;)*) => {$(
        #[test]
        fn $name() {
            let flow = Flow::new($group, $action, $field);
            let start = flow.start(7);
            every_method_on(stringify!($name), flow, start);
        }
    )*};
}

orders! {
    translation_on_so3_closed: So3::new(), LeftTranslation, wave(3, 0.5, 11);
    translation_on_so3: MatrixGroup::so(3).unwrap(), LeftTranslation, wave(3, 0.5, 11);
    translation_on_so5: MatrixGroup::so(5).unwrap(), LeftTranslation, wave(5, 0.5, 12);
    translation_on_gl3: MatrixGroup::gl(3).unwrap(), LeftTranslation, wave(3, 0.25, 13);
    translation_on_sp4: MatrixGroup::sp(4).unwrap(), LeftTranslation, wave(4, 0.25, 14);
    translation_on_so31: MatrixGroup::indefinite(3, 1).unwrap(), LeftTranslation, wave(4, 0.25, 15);
    orbits_of_so3_closed: So3::new(), Coadjoint, inertia(3);
    orbits_of_so4: MatrixGroup::so(4).unwrap(), Coadjoint, inertia(4);
    orbits_of_sp4: MatrixGroup::sp(4).unwrap(), Coadjoint, wave(4, 0.25, 16);
    vectors_of_so3_closed: So3::new(), Linear, wave(3, 1.0, 17);
    vectors_of_gl3: MatrixGroup::gl(3).unwrap(), Linear, wave(3, 0.25, 18);
}

#[test]
fn rigid_bodies() {
    let (inertia, momentum) = ([1.0, 2.0, 3.5], [1.0, 0.8, -1.2]);
    let body = RigidBody::new(inertia).unwrap();
    every_method_on("the rigid body", body, momentum.into());
    let attitude = RigidBodyAttitude::new(inertia, momentum).unwrap();
    every_method_on("its attitude", attitude, nalgebra::Matrix3::identity());

    let manakov = RigidBodyN::manakov(&[0.4, 1.1, 1.9, 2.5]).unwrap();
    let group = manakov.group().clone();
    let mut rng = Pcg64::seed_from_u64(8);
    let start = group.sample_algebra(&mut rng, 2.0).into_mat();
    every_method_on("Manakov's body, n = 4", manakov.clone(), start.clone());
    let attitude = RigidBodyNAttitude::new(manakov, start).unwrap();
    every_method_on("its attitude, n = 4", attitude, group.sample_element(&mut rng));
}

#[test]
fn tableaus_satisfy_their_order_conditions() {
    let mut names = Vec::new();
    macro_rules! check {
        ($($tableau:ident)*) => {$(
            order_conditions(&tableau::$tableau).unwrap();
            names.push(tableau::$tableau.name);
        )*};
    }
    check!(EULER MIDPOINT HEUN RK4 THREE_EIGHTHS BS3);
    // `tests/tableaus.rs` has the trees of the higher orders.
    names.extend(["rkf45", "dopri5", "verner6", "dop853"]);
    assert_eq!(names, TABLEAUS, "a tableau of the catalog is not checked here");
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
