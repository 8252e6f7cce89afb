//! A run that is saved and restored goes on to the same bits, whatever its state was.

use std::cell::RefCell;
use std::time::Duration;

use lieflow::actions::LeftTranslation;
use lieflow::groups::{So3, Unitary};
use lieflow::maps::{CCSK, Exp};
use lieflow::methods::tableau::{DOPRI5, RK4};
use lieflow::methods::{AnyMethod, FluidMidpoint, Method, Rk, Rkmk};
use lieflow::problems::{PointOf, Problem, Zeitlin};
use lieflow::space::Numbers;
use lieflow::{Event, Integrator, Solve, TimeGrid};
use nalgebra::Matrix3;
use rand::SeedableRng;

use crate::hard_cases::{START, body, spin};
use crate::modes::V;
use crate::scipy::free;
use crate::support::boxed::{boxed_flow, boxed_of_time};

/// The bits of a point.
fn bits<Y: Numbers + Clone>(y: &Y) -> Vec<u64> {
    let mut all = Vec::new();
    y.clone().each_number(&mut |x| all.push(x.to_bits()));
    all
}

/// Save after every step, restore into a run that is new, and go on to the end: the same bits, the same statistics,
/// the same points within the last step.
fn goes_on<'a, P: Problem + 'a, M: Method<P> + 'a>(new: impl Fn() -> Integrator<'a, P, M>)
where
    PointOf<P>: Numbers,
{
    let mut whole = new();
    let (mut saved, mut ends) = (vec![whole.save()], Vec::new());
    while !whole.is_done() {
        whole.step().expect("a step");
        ends.push((whole.t().to_bits(), bits(whole.y())));
        saved.push(whole.save());
    }
    assert!(saved.len() > 8, "{} states", saved.len());
    for (n, bytes) in saved.iter().enumerate() {
        let mut later = new();
        later.restore(bytes).expect("a state");
        assert_eq!(&later.save(), bytes, "state {n}");
        if n > 0 {
            let Some((t, y)) = ends.get(n - 1) else { panic!("an end") };
            assert_eq!((later.t().to_bits(), &bits(later.y())), (*t, y), "state {n}");
        }
        for end in &ends[n..] {
            later.step().expect("a step");
            assert_eq!(&(later.t().to_bits(), bits(later.y())), end, "from state {n}");
        }
        assert_eq!(later.stats(), whole.stats(), "from state {n}");
        let (mut here, mut there) = (whole.y().clone(), whole.y().clone());
        let t = whole.t() - 0.4 * whole.last_step().h;
        later.interpolate(t, &mut here).expect("a point");
        // Asked of a copy of the run, so that its statistics stay.
        let mut copy = new();
        copy.restore(&saved[saved.len() - 1]).expect("a state");
        copy.interpolate(t, &mut there).expect("a point");
        assert_eq!(bits(&here), bits(&there), "from state {n}");
    }
}

#[test]
fn steps_of_one_size() {
    let (body, turn) = (body(), spin(|t| t.cos()));
    let (ccsk, exp, rk) = (Rkmk::new(RK4, CCSK), Rkmk::new(RK4, Exp), Rk(RK4));
    goes_on(|| Solve::new(&body, &ccsk, [0.1, 2.0]).dt(0.11).integrator(START).unwrap());
    // The orbit that the state is taken back to, and when: a hundred steps, and steps off the grid.
    goes_on(|| Solve::new(&turn, &exp, [1.0, 0.0]).steps(120).integrator(V::x()).unwrap());
    let split = || TimeGrid::new([0.1, 2.0], 0.11).unwrap().split();
    goes_on(|| Solve::new(&body, &ccsk, [0.1, 2.0]).grid(split()).integrator(START).unwrap());
    let off_the_grid = || {
        let mut run = Solve::new(&body, &rk, [0.0, 3.0]).dt(0.25).integrator(START).unwrap();
        run.advance_to(0.3).unwrap();
        run
    };
    goes_on(off_the_grid);
}

#[test]
fn steps_by_their_error() {
    let body = body();
    let method = Rkmk::new(DOPRI5, Exp);
    goes_on(|| {
        Solve::new(&body, &method, [0.0, 20.0]).tolerances(1e-8, 1e-8).integrator(START).unwrap()
    });
    // Rejected steps, and a wall: f has no value for a while.
    let jumps = spin(|t| if (1.0..1.05).contains(&(t % 2.0)) { 60.0 } else { 1.0 });
    goes_on(|| {
        Solve::new(&jumps, &method, [0.0, 5.0]).tolerances(1e-7, 0.0).integrator(V::x()).unwrap()
    });
    let group = So3::<f64>::new();
    let turning = boxed_of_time(group, LeftTranslation, |t: f64, v: &mut V| {
        *v = V::new(9.0 * t.sin(), t, 3.0)
    });
    let doubled = AnyMethod::new(Rkmk::new(RK4, CCSK));
    goes_on(|| {
        let solve = Solve::new(&turning, &doubled, [0.0, 3.0]).tolerances(1e-6, 1e-6);
        solve.integrator(Matrix3::identity()).unwrap()
    });
}

/// Its iteration begins with what the steps before were.
#[test]
fn a_method_with_a_memory() {
    let fluid = Zeitlin::sphere(6).expect("a sphere");
    let mut rng = rand_pcg::Pcg64::seed_from_u64(5);
    let start = {
        use lieflow::groups::Sample;
        Unitary::new(6).expect("U(6)").sample_algebra(&mut rng, 0.3)
    };
    let method = FluidMidpoint::isospectral();
    goes_on(|| {
        Solve::new(&fluid, &method, [0.0, 1.0]).steps(20).integrator(start.clone()).unwrap()
    });
}

/// A whole run with events, output, stops and drift: from the state after any step, or any row, the rest is the same.
#[test]
fn whole_runs() {
    for every in [Duration::ZERO, Duration::from_nanos(1)] {
        goes_on_with_events(every);
    }
}

fn goes_on_with_events(every: Duration) {
    let problem =
        boxed_flow(free(), LeftTranslation, |_: f64, y: &V, v: &mut V| *v = V::new(y.y, -1.0, 0.3));
    let method = Rk(DOPRI5);
    type Shown = Vec<(u64, Vec<u64>)>;
    let run = |resume: Option<&Vec<u8>>, states: &RefCell<Vec<Vec<u8>>>, shown: &RefCell<Shown>| {
        let see = |t: f64, y: &V| shown.borrow_mut().push((t.to_bits(), bits(y)));
        // A ball that bounces, a third event that ends the run, and one that is told.
        let mut solve = Solve::new(&problem, &method, [0.0, 50.0])
            .tolerances(1e-9, 1e-9)
            .max_step(0.2)
            .times((0..1000).map(|k| 0.05 * f64::from(k)).collect::<Vec<_>>())
            .stops([0.55, 1.55, 4.5])
            .event(
                Event::new("floor", |_, y: &V| y.x)
                    .falling()
                    .change(|_, y| y.y *= -0.9)
                    .tell(|t, y, _| see(t, y)),
            )
            .event(
                Event::new("top", |_, y: &V| y.y).falling().stop_after(4).tell(|t, y, _| see(t, y)),
            )
            .checkpoints(every, |bytes| states.borrow_mut().push(bytes.to_vec()));
        if let Some(bytes) = resume {
            solve = solve.resume(bytes.clone());
        }
        let done = solve.run_with(V::new(1.0, 0.0, 0.0), |t, y: &mut V| see(t, y)).expect("a run");
        (bits(&done.y), done.t.to_bits(), done.status, done.stats)
    };
    let (states, shown) = (RefCell::default(), RefCell::default());
    let whole = run(None, &states, &shown);
    let (states, shown): (Vec<Vec<u8>>, Shown) = (states.into_inner(), shown.into_inner());
    // With a duration the state is also saved between two rows of a step.
    let least = if every.is_zero() { 20 } else { shown.len() * 3 / 4 };
    let counts = (states.len(), shown.len());
    assert!(states.len() > least && shown.len() > 80, "{counts:?}: states, points");
    for bytes in &states {
        let rest = RefCell::default();
        let mut resumed = run(Some(bytes), &RefCell::default(), &rest);
        // The first step after a restart evaluates f at its start. A run in one go has it from the step before.
        let evaluations = &mut resumed.3.evaluations;
        let more = evaluations.zip(whole.3.evaluations).map(|(n, of_whole)| n - of_whole);
        assert!(more <= Some(1), "{more:?}");
        *evaluations = whole.3.evaluations;
        assert_eq!(resumed, whole);
        let rest: Shown = rest.into_inner();
        assert_eq!(rest, shown[shown.len() - rest.len()..]);
    }
}

/// Rows within a step change what the method remembers, and so does a state that is restored within a step.
#[test]
fn rows_within_a_step_of_a_method_with_a_memory() {
    let fluid = Zeitlin::sphere(6).expect("a sphere");
    let mut rng = rand_pcg::Pcg64::seed_from_u64(5);
    let start = {
        use lieflow::groups::Sample;
        Unitary::new(6).expect("U(6)").sample_algebra(&mut rng, 0.3)
    };
    let method = FluidMidpoint::isospectral();
    let run = |resume: Option<&Vec<u8>>| {
        let (mut states, mut shown) = (Vec::new(), Vec::new());
        let mut solve = Solve::new(&fluid, &method, [0.0, 1.0])
            .steps(10)
            .count(33)
            .checkpoints(Duration::from_nanos(1), |bytes| states.push(bytes.to_vec()));
        if let Some(bytes) = resume {
            solve = solve.resume(bytes.clone());
        }
        solve.run_with(start.clone(), |t, y| shown.push((t.to_bits(), bits(y)))).expect("a run");
        (states, shown)
    };
    let (states, shown) = run(None);
    assert!(states.len() > 25 && shown.len() == 34, "{} {}", states.len(), shown.len());
    for (n, bytes) in states.iter().enumerate() {
        let (_, rest) = run(Some(bytes));
        assert_eq!(rest, shown[shown.len() - rest.len()..], "from state {n}");
    }
}

#[test]
fn bytes_that_are_not_of_this_run_are_refused() {
    let body = body();
    let method = Rkmk::new(DOPRI5, Exp);
    let solve = |rtol| Solve::new(&body, &method, [0.0, 10.0]).tolerances(rtol, 1e-8);
    let mut run = solve(1e-8).integrator(START).unwrap();
    run.advance_to(3.0).unwrap();
    let (bytes, before) = (run.save(), bits(run.y()));
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        assert!(run.restore(&damaged).is_err(), "byte {at}");
    }
    for length in [0, 7, 8, 24, bytes.len() - 8, bytes.len() - 1] {
        assert!(run.restore(&bytes[..length]).is_err(), "{length} bytes");
    }
    assert!(run.restore(&[&bytes[..], &[0; 8]].concat()).is_err(), "more bytes");
    // A run to another end, or back, is another run: it would never come to the end that was saved.
    for end in [20.0, 0.1, -10.0] {
        let run = Solve::new(&body, &method, [0.0, end]).tolerances(1e-8, 1e-8);
        assert!(run.integrator(START).unwrap().restore(&bytes).is_err(), "to {end}");
        let last = RefCell::new(Vec::new());
        let whole = Solve::new(&body, &method, [0.0, 10.0]).tolerances(1e-8, 1e-8);
        let keep = |bytes: &[u8]| *last.borrow_mut() = bytes.to_vec();
        whole.checkpoints(Duration::ZERO, keep).run(START).unwrap();
        let run = Solve::new(&body, &method, [0.0, end]).tolerances(1e-8, 1e-8);
        assert!(run.resume(last.into_inner()).run(START).is_err(), "to {end}");
    }
    // From another start the rows would have other times.
    for start in [-1.0, 0.5] {
        let last = RefCell::new(Vec::new());
        let keep = |bytes: &[u8]| *last.borrow_mut() = bytes.to_vec();
        let whole = Solve::new(&body, &method, [0.0, 10.0]).tolerances(1e-8, 1e-8).interval(1.0);
        whole.checkpoints(Duration::ZERO, keep).run(START).unwrap();
        let run = Solve::new(&body, &method, [start, 10.0]).tolerances(1e-8, 1e-8).interval(1.0);
        assert!(run.resume(last.into_inner()).run(START).is_err(), "from {start}");
    }
    let mut others = [
        solve(1e-7).integrator(START).unwrap().save(),
        Solve::new(&body, &method, [0.0, 10.0]).dt(0.1).integrator(START).unwrap().save(),
    ];
    others.iter_mut().for_each(|other| assert!(run.restore(other).is_err()));
    let grid = TimeGrid::new([0.0, 10.0], 0.1).unwrap();
    let split = Solve::new(&body, &method, [0.0, 10.0]).grid(grid.split()).integrator(START);
    assert!(split.unwrap().restore(&others[1]).is_err());
    assert_eq!(bits(run.y()), before, "a refused state changes nothing");
    run.restore(&bytes).expect("its own state");
}

/// A state of a run with steps of another size is refused.
#[test]
fn steps_of_another_size_do_not_go_on() {
    let spin = spin(|_| 1.0);
    let method = Rkmk::new(RK4, Exp);
    let run = |steps: u64| Solve::new(&spin, &method, [0.0, 1.0]).steps(steps);
    let states = RefCell::new(Vec::new());
    let keep = |bytes: &[u8]| states.borrow_mut().push(bytes.to_vec());
    let start = V::new(0.6, 0.0, 0.8);
    run(10).checkpoints(Duration::ZERO, keep).run(start).expect("a run");
    let state = states.borrow()[0].clone();
    assert!(run(10).resume(state.clone()).run(start).is_ok());
    let refused = run(1000).resume(state).run(start).map(drop).map_err(|failed| failed.error);
    assert!(refused.is_err_and(|error| error.to_string().contains("choice of steps")));
}

/// A run that left its grid goes on from its states: where a stop is no time of the grid, and where the caller took it off.
#[test]
fn runs_off_their_grid_go_on() {
    let (body, method) = (body(), Rkmk::new(RK4, Exp));
    let solve = || Solve::new(&body, &method, [0.0, 1.0]).dt(0.1).stops([0.31, 0.62]);
    let states = RefCell::new(Vec::new());
    let keep = |bytes: &[u8]| states.borrow_mut().push(bytes.to_vec());
    let whole = solve().checkpoints(Duration::ZERO, keep).run(START).expect("a run");
    assert_eq!(states.borrow().len() as u64, whole.stats.accepted);
    for state in states.into_inner() {
        let rest = solve().resume(state).run(START).expect("its own state");
        assert_eq!((bits(&rest.y), rest.stats.accepted), (bits(&whole.y), whole.stats.accepted));
    }
    let mut run = Solve::new(&body, &method, [0.0, 1.0]).dt(0.1).integrator(START).unwrap();
    run.step().unwrap();
    let early = run.save();
    for end in [0.33, 0.57, 0.771] {
        run.advance_to(end).unwrap();
        run.step().unwrap();
        let state = run.save();
        run.restore(&state).expect("its own state");
    }
    run.restore(&early).expect("its own state");
}

/// A run whose attempts were used up goes on with more of them. An integrator counts those of each call.
#[test]
fn a_run_goes_on_with_more_attempts() {
    let (body, method) = (body(), Rkmk::new(DOPRI5, Exp));
    let solve =
        |most: u64| Solve::new(&body, &method, [0.0, 10.0]).tolerances(1e-9, 1e-12).max_steps(most);
    let whole = solve(100_000).run(START).expect("a run");
    let last = RefCell::new(Vec::new());
    let keep = |bytes: &[u8]| *last.borrow_mut() = bytes.to_vec();
    assert!(solve(30).checkpoints(Duration::ZERO, keep).run(START).is_err());
    let last = last.into_inner();
    let rest = solve(100_000).resume(last.clone()).run(START).expect("the rest");
    assert_eq!((bits(&rest.y), rest.stats.accepted), (bits(&whole.y), whole.stats.accepted));
    let most = whole.stats.accepted / 2 + 20;
    let mut run = solve(most).integrator(START).expect("a start");
    run.advance_to(5.0).expect("half of the steps");
    let mut rest = solve(most).resume(run.save()).integrator(START).expect("a state");
    while !rest.advance_for(10.0, Duration::from_secs(60)).expect("the attempts of this call") {}
    run.advance_to(10.0).expect("the other half");
    assert_eq!(bits(rest.y()), bits(run.y()));
}

/// Zero means after every step, and checkpoints are taken without a flag or progress, too.
#[test]
fn checkpoints_of_methods_that_do_not_stay_on_m() {
    let (body, method) = (body(), Rk(RK4));
    let count = |every: Duration, steps: u64| {
        let mut count = 0;
        let solve = Solve::new(&body, &method, [0.0, 10.0]).steps(steps);
        solve.checkpoints(every, |_| count += 1).run(START).expect("a run");
        count
    };
    assert_eq!(count(Duration::ZERO, 1000), 1000);
    assert!(count(Duration::from_millis(1), 3_000_000) > 10);
}

/// A curve has the rows of the same call, also where the state was saved between two rows of a step.
#[test]
fn a_curve_has_the_rows_after_a_state() {
    let (body, method) = (body(), Rkmk::new(DOPRI5, Exp));
    let solve = || Solve::new(&body, &method, [0.0, 10.0]).tolerances(1e-9, 1e-12).interval(0.01);
    let states = RefCell::new(Vec::new());
    let keep = |bytes: &[u8]| states.borrow_mut().push(bytes.to_vec());
    solve().checkpoints(Duration::from_nanos(1), keep).run(START).expect("a run");
    let states = states.into_inner();
    assert!(states.len() > 500, "{} states, also between rows", states.len());
    for state in states.into_iter().step_by(7) {
        let (rest, curve) = solve().resume(state.clone()).run_interpolant(START).expect("a run");
        let mut reader = curve.reader().expect("a reader");
        for (t, y) in rest.times.iter().zip(&rest.points) {
            assert!((reader.at(*t).expect("a time of the curve") - y).norm() < 1e-12, "t = {t}");
        }
        let mut rest = solve().resume(state).run_continuous(START).expect("a run");
        let first = rest.solution.times[0];
        assert!(rest.at(first).is_ok(), "t = {first}");
    }
}
