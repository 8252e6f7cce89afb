//! Every method that the catalog has for a fluid has its order and keeps what it says, on both surfaces.

use lieflow::catalog::{MethodInfo, MethodSpec, Property, all_methods};
use lieflow::groups::ComplexMatrix;
use lieflow::methods::Metric;
use lieflow::problems::{Surface, Zeitlin};
use lieflow::{Error, SaveAt, TimeGrid, integrate};
use lieflow::{StepControl, integrate_adaptive};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::support::named;

/// The end of a run over [0, ½] in so many steps.
fn run<S: Surface>(
    spec: &MethodSpec,
    fluid: &Zeitlin<S>,
    start: &ComplexMatrix,
    steps: u64,
) -> Result<ComplexMatrix, Error> {
    named::fluid(spec, |method| {
        let mut w = start.clone();
        let grid = TimeGrid::with_steps([0.0, 0.5], steps).expect("a grid");
        integrate(fluid, method, &grid, &SaveAt::Ends, &mut w, |_, _| {}).expect("a run");
        w
    })
}

fn spec(info: &MethodInfo, map: &str) -> MethodSpec {
    MethodSpec::new(info.name, info.takes_map().then_some(map))
}

fn check<S: Surface>(fluid: &Zeitlin<S>, start: &ComplexMatrix) {
    let run = |spec: &MethodSpec, steps| run(spec, fluid, start, steps);
    let finest = MethodSpec { tableau: Some("dop853".into()), ..MethodSpec::new("rkmk", None) };
    let exact = run(&finest, 64).expect("it fits");
    assert!(exact.distance(start) > 0.1 * start.size(), "it moves");
    let (levels, energy) = (fluid.spectrum(start).expect("levels"), fluid.energy(start));
    let mut seen = Vec::new();
    for info in all_methods() {
        for map in ["exp", "cay"].into_iter().take(1 + usize::from(info.takes_map())) {
            let spec = spec(info, map);
            let end = match run(&spec, 16) {
                Ok(end) => end,
                Err(error) => {
                    assert!(matches!(error, Error::Unsupported { .. }), "{error}");
                    continue;
                }
            };
            let order = info.order.number().unwrap_or(4); // of rk4
            let coarse = end.distance(&exact);
            let fine = run(&spec, 32).expect("it fits").distance(&exact);
            // Half a step takes 2^p from the error, until rounding is reached.
            let slope = (coarse / fine).log2();
            let label = spec.label();
            assert!(
                slope > order as f64 - 0.4 || fine < 1e-12 * start.size(),
                "{label}: {slope:.2}, {coarse:.1e} {fine:.1e}"
            );
            let rounding = 1e-13 * start.size();
            if info.keeps(Property::Casimirs) {
                let now = fluid.spectrum(&end).expect("levels");
                let gap = now.iter().zip(&levels).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(gap < rounding, "{label}: {gap:.1e}");
            }
            if info.keeps(Property::Energy) {
                let gap = (fluid.energy(&end) - energy).abs();
                assert!(gap < rounding, "{label}: {gap:.1e}");
            }
            seen.push(label);
        }
    }
    for name in [
        "isospectral4",
        "isospectral6",
        "isospectral-kahan-li6",
        "energy-casimir6 cay",
        "cf4",
        "cg4",
        "gauss6",
        "cf-ees27",
    ] {
        assert!(seen.iter().any(|label| label == name), "{name} is not among {seen:?}");
    }
    for map in [None, Some("cay")] {
        for tableau in ["bs3", "dopri5", "dop853"] {
            let pair = MethodSpec { tableau: Some(tableau.into()), ..MethodSpec::new("rkmk", map) };
            let mut w = start.clone();
            let control = StepControl::new(1e-9, 1e-9).expect("tolerances");
            named::pair(&pair, |method| {
                integrate_adaptive(
                    fluid,
                    method,
                    [0.0, 0.5],
                    &control,
                    &SaveAt::Ends,
                    &mut w,
                    |_, _| {},
                )
            })
            .expect("it fits")
            .expect("a run");
            assert!(w.distance(&exact) < 1e-6 * start.size(), "{}", pair.label());
        }
    }
}

#[test]
fn on_the_sphere() {
    let fluid = Zeitlin::sphere(6).expect("a sphere");
    let start = fluid.random(&mut Pcg64::seed_from_u64(3), 5).expect("a field");
    check(&fluid, &start);
}

#[test]
fn on_the_torus() {
    let fluid = Zeitlin::torus(7).expect("a torus");
    let start = fluid.random(&mut Pcg64::seed_from_u64(5), 3).expect("a field");
    check(&fluid, &start);
}

/// What U(n) has not, by name; and what no map or method is called.
#[test]
fn parts_that_do_not_fit() {
    let fluid = Zeitlin::torus(3).expect("a torus");
    let start = fluid.from_modes(&[([1, 0], [1.0, 0.0])]).expect("a field");
    let refusal = |spec: &MethodSpec| {
        let error = run(spec, &fluid, &start, 1).expect_err("it does not fit");
        error.to_string()
    };
    let cut = MethodSpec { q: Some(2), ..MethodSpec::new("rkmk4", None) };
    for (spec, words) in [
        (MethodSpec::new("rkmk4", Some("ccsk123")), "exp and cay"),
        (MethodSpec::new("gauss4", Some("cay")), "leave map out"),
        (MethodSpec::new("rkmk-gauss4", Some("log")), "unknown map"),
        (cut, "leave q out"),
        (MethodSpec::new("magnus4", None), "linear type"),
    ] {
        let message = refusal(&spec);
        assert!(message.contains(words), "{}: {message}", spec.label());
    }
}
