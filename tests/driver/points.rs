//! The points within steps at which events look.

use core::cell::{Cell, RefCell};

use lieflow::actions::LeftTranslation;
use lieflow::methods::Rk;
use lieflow::methods::tableau::DOPRI5;
use lieflow::{Event, Solve};

use crate::modes::V;
use crate::scipy::free;
use crate::support::boxed::boxed_of_time;

/// The points within a step are as many as the size of the step and g at its two ends say.
#[test]
fn points_by_the_ends_of_a_step() {
    let problem = boxed_of_time(free(), LeftTranslation, |_: f64, v: &mut V| *v = V::x());
    for span in [[0.0, 4.0], [4.0, 0.0]] {
        let seen = RefCell::new(Vec::new());
        let event = Event::new("rate", |t, _: &V| {
            seen.borrow_mut().push(t);
            4.0 + t
        });
        let event = event.points_by(|h, [first, last]| (h * first.max(last)) as u32);
        Solve::new(&problem, &Rk(DOPRI5), span)
            .dt(0.5)
            .event(event)
            .run(V::zeros())
            .expect("a run");
        let mut expected = vec![0.0];
        for step in 0..8 {
            let (start, n) = (0.5 * f64::from(step), (0.25 * f64::from(9 + step)) as u32);
            expected.extend((1..=n).map(|i| start + 0.5 * f64::from(i) / f64::from(n + 1)));
            expected.push(start + 0.5);
        }
        assert_eq!(expected.len(), 31);
        let mut seen = seen.into_inner();
        seen.sort_by(f64::total_cmp);
        seen.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
        let gaps = seen.iter().zip(&expected).map(|(a, b)| (a - b).abs());
        assert!(seen.len() == 31 && gaps.fold(0.0, f64::max) < 1e-12, "{seen:?}");
    }
}

/// Parts of a step are halved where g is large: few points, and none too far from the next.
#[test]
fn points_by_halves_are_close_where_g_is_large() {
    let problem = boxed_of_time(free(), LeftTranslation, |_: f64, v: &mut V| *v = V::x());
    let rate = |t: f64, width: f64| 1.0 / (t - 1.3).hypot(width);
    for (width, most) in [(0.3, 60), (1e-3, 100), (1e-7, 200)] {
        let seen = RefCell::new(Vec::new());
        let event = Event::new("rate", |t, _: &V| {
            seen.borrow_mut().push(t);
            rate(t, width)
        });
        let event = event.points_by_halves(|_, _| 3, |h, [a, b]| 2.0 * h * a.max(b) > 1.0);
        Solve::new(&problem, &Rk(DOPRI5), [0.0, 4.0])
            .dt(2.0)
            .event(event)
            .run(V::zeros())
            .expect("a run");
        let mut seen = seen.into_inner();
        seen.sort_by(f64::total_cmp);
        seen.dedup();
        assert!(seen.len() < most, "{width}: {} points", seen.len());
        for pair in seen.windows(2) {
            let most = pair.iter().map(|t| rate(*t, width)).fold(0.0, f64::max);
            assert!(2.0 * (pair[1] - pair[0]) * most <= 1.0, "{width}: {pair:?}");
        }
    }
    // A rule without an end has 100 000 points in a step.
    let seen = Cell::new(0);
    let event = Event::new("rate", |_, _: &V| {
        seen.set(seen.get() + 1);
        1.0
    });
    let event = event.points_by_halves(|_, _| 1, |_, _| true);
    let run = Solve::new(&problem, &Rk(DOPRI5), [0.0, 1.0]).dt(1.0).event(event).run(V::zeros());
    run.expect("a run");
    assert!((100_000..100_010).contains(&seen.get()), "{}", seen.get());
}

/// Zeros between the points are found, with halved parts and without.
#[test]
fn points_by_the_caller_have_zeros() {
    let problem = boxed_of_time(free(), LeftTranslation, |_: f64, v: &mut V| *v = V::x());
    let event = || Event::new("wave", |t: f64, _: &V| (3.0 * t - 1.0).sin());
    for event in [event().points_by(|_, _| 12), event().points_by_halves(|_, _| 0, |h, _| h > 0.3)]
    {
        let solve = Solve::new(&problem, &Rk(DOPRI5), [0.0, 8.0]).dt(4.0).event(event);
        let run = solve.run(V::zeros()).expect("a run");
        let found: Vec<f64> = run.times_of(0).collect();
        let expected = (0..8).map(|k| (1.0 + f64::from(k) * core::f64::consts::PI) / 3.0);
        let expected: Vec<f64> = expected.filter(|t| *t < 8.0).collect();
        assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
        for (t, expected) in found.iter().zip(&expected) {
            assert!((t - expected).abs() < 1e-12, "{t}, expected {expected}");
        }
    }
}
