//! Fluids near the largest step that their iteration converges at, and beyond it.

use lieflow::groups::ComplexMatrix;
use lieflow::methods::{FluidMidpoint, MidpointRule};
use lieflow::methods::{Method, Metric, Step};
use lieflow::problems::{Sphere, Vortex, Zeitlin};
use lieflow::{SaveAt, Solve, StepError, TimeGrid, integrate};

/// Four strong vortices: ‖ω‖ is large, and a step of 0.025 contracts by 0.93 an iteration.
fn vortices() -> (Zeitlin<Sphere>, ComplexMatrix) {
    let fluid = Zeitlin::sphere(24).expect("a sphere");
    let places = [
        (0.5, -0.6, 6.0, 0.25),
        (0.4, 0.4, 6.0, 0.25),
        (-0.5, 0.2, -6.0, 0.3),
        (-0.3, 2.4, -6.0, 0.3),
    ];
    let vortex = |(latitude, longitude, circulation, width)| Vortex {
        latitude,
        longitude,
        circulation,
        width,
    };
    let w = fluid.vortices(&places.map(vortex)).expect("vortices");
    (fluid, w)
}

#[test]
fn a_slow_contraction_ends_at_rounding() {
    let (fluid, start) = vortices();
    let (levels, energy) = (fluid.spectrum(&start).expect("levels"), fluid.energy(&start));
    for method in [FluidMidpoint::isospectral(), FluidMidpoint::energy()] {
        let mut w = start.clone();
        let grid = TimeGrid::with_steps([0.0, 1.0], 40).expect("a grid");
        integrate(&fluid, &method, &grid, &SaveAt::Ends, &mut w, |_, _| {}).expect("a run");
        assert!(w.distance(&start) > 0.1 * start.size(), "it moves");
        let now = fluid.spectrum(&w).expect("levels");
        let gap = now.iter().zip(&levels).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let bound = 64.0 * f64::EPSILON * 40f64.sqrt();
        assert!(gap < bound * levels[23], "{method:?}: {gap:.1e}");
        let gap = (fluid.energy(&w) / energy - 1.0).abs();
        assert!(gap < bound || method.rule() == MidpointRule::Isospectral, "the energy: {gap:.1e}");
    }
}

#[test]
fn beyond_the_limit_a_step_fails_and_changes_nothing() {
    let (fluid, start) = vortices();
    for method in [FluidMidpoint::isospectral(), FluidMidpoint::energy()] {
        let mut work = method.work(&fluid, &start).expect("a workspace");
        for h in [0.06, 0.2, 1e6] {
            let mut w = start.clone();
            let error = method.step(&fluid, Step { n: 0, t: 0.0, h }, &mut w, &mut work);
            assert!(
                matches!(
                    error,
                    Err(StepError::FixedPointDidNotConverge { change_log10: -3.., .. })
                ),
                "{method:?}, {h}: {error:?}"
            );
            assert_eq!(w.distance(&start), 0.0);
        }
        // And the workspace is as good as new.
        let (mut w, mut of_new) = (start.clone(), start.clone());
        let step = Step { n: 0, t: 0.0, h: 0.005 };
        method.step(&fluid, step, &mut w, &mut work).expect("a step");
        let mut new = method.work(&fluid, &start).expect("a workspace");
        method.step(&fluid, step, &mut of_new, &mut new).expect("a step");
        assert!(w.distance(&of_new) < 1e-15 * start.size());
    }
}

/// Rows within steps do not change the run, and cost about as many iterations as they are points.
#[test]
fn rows_do_not_change_the_run() {
    let (fluid, w) = vortices();
    for method in [FluidMidpoint::isospectral(), FluidMidpoint::energy()] {
        let run = |rows: u64| {
            let times: Vec<f64> = (1..=rows).map(|k| (k as f64 - 0.3) / rows as f64).collect();
            let solve = Solve::new(&fluid, &method, [0.0, 1.0]).steps(200).times(times);
            let run = solve.run(w.clone()).expect("a run");
            (run.y, run.points, run.stats.iterations)
        };
        let (end, _, alone) = run(0);
        for rows in [20, 200] {
            let (same, points, iterations) = run(rows);
            assert!(same.distance(&end) == 0.0);
            assert!(
                iterations - alone < 30 * rows,
                "{rows} rows: {alone} and {iterations} iterations"
            );
            // Each has the spectrum of the start: tr W² is the sum of the squares.
            for point in points {
                assert!((point.size() / w.size() - 1.0).abs() < 1e-13);
            }
        }
    }
}
