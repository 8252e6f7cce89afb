//! The checks of runs fail on methods, dense output and drivers that are broken on purpose.

use lieflow::check::{MethodOn, Record, Reference, Subject, Trial, TrialSteps, runs_agree};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::tableau::{DOP853, DOPRI5, Dense, Row, VERNER6};
use lieflow::methods::{Embedded, ExactMotion, Rk, Rkmk, Tableau};
use lieflow::problems::RigidBody;
use nalgebra::Vector3;

use crate::maps::{Fault, Faulty};

const START: Vector3<f64> = Vector3::new(0.1, 2.0, 0.3);

/// A method whose runs go through `0`.
struct Planted<'a, F>(F, &'a dyn Subject);

impl<F: Fn(&dyn Subject, Trial) -> Result<Record, String>> Subject for Planted<'_, F> {
    fn order(&self) -> Option<usize> {
        self.1.order()
    }
    fn dense_order(&self) -> usize {
        self.1.dense_order()
    }
    fn run(&self, trial: Trial) -> Result<Record, String> {
        (self.0)(self.1, trial)
    }
}

/// The names of the checks that do not hold for a method, whose runs go through `run`.
fn broken_runs(
    method: &impl Embedded<RigidBody<f64>>,
    run: impl Fn(&dyn Subject, Trial) -> Result<Record, String>,
) -> Vec<String> {
    let problem = &RigidBody::new([1.0, 2.0, 3.0]).unwrap();
    let start = &START;
    let classical = MethodOn { problem, method: &Rk(DOP853), start };
    let lie = MethodOn { problem, method: &Rkmk::new(DOP853, Cay), start };
    let reference = Reference::new(&classical, &lie, [0.0, 4.0]).unwrap();
    let method = MethodOn { problem, method, start };
    let findings = runs_agree(&Planted(run, &method), &reference);
    assert!(findings.len() >= 7, "{findings:?}");
    findings.into_iter().filter(|finding| !finding.holds()).map(|finding| finding.name).collect()
}

/// The same for a method as it is.
fn broken(method: &impl Embedded<RigidBody<f64>>) -> Vec<String> {
    broken_runs(method, |method, trial| method.run(trial))
}

#[test]
fn sound_methods_pass() {
    let none: [String; 0] = [];
    assert_eq!(broken(&Rkmk::new(DOP853, Exp)), none);
    assert_eq!(broken(&Rkmk::new(VERNER6, Cay)), none);
    assert_eq!(broken(&Rkmk::new(DOPRI5, Exp)), none);
    assert_eq!(broken(&Rk(DOP853)), none);
    assert_eq!(broken(&ExactMotion), none);
}

/// DOP853 with other extra stages and other rows of its dense output.
fn dense(change: impl Fn(&mut Vec<(f64, Row)>, &mut Vec<Row>)) -> Rkmk<Exp, 12> {
    let Dense::Raised { order, stages, rows } = DOP853.dense else { panic!("{:?}", DOP853.dense) };
    let (mut stages, mut rows) = (stages.to_vec(), rows.to_vec());
    change(&mut stages, &mut rows);
    let (stages, rows) = (stages.leak(), rows.leak());
    Rkmk::new(Tableau { dense: Dense::Raised { order, stages, rows }, ..DOP853 }, Exp)
}

/// These weights with a change of the last one.
fn nudged(weights: &[f64]) -> &'static [f64] {
    let mut weights = weights.to_vec();
    *weights.last_mut().unwrap() += 1e-2;
    weights.leak()
}

#[test]
fn faults_of_dense_output_are_found() {
    let within = "order within steps".to_string();
    assert_eq!(broken(&dense(|_, _| ())), [""; 0]);
    for (what, method) in [
        (
            "a weight of an extra stage",
            dense(|stages, _| stages[1].1.extra = nudged(stages[1].1.extra)),
        ),
        ("a weight of a stage", dense(|stages, _| stages[2].1.stages = nudged(stages[2].1.stages))),
        ("a weight of a row", dense(|_, rows| rows[2].stages = nudged(rows[2].stages))),
        ("swapped rows", dense(|_, rows| rows.swap(1, 2))),
        ("one extra stage too few", dense(|stages, _| stages.truncate(2))),
        ("two rows too few", dense(|_, rows| rows.truncate(2))),
    ] {
        let found = broken(&method);
        assert!(found.contains(&within), "{what}: {found:?}");
        // What is right is not blamed.
        assert!(!found.iter().any(|name| name == "order of steps"), "{what}: {found:?}");
    }
    // The time of an extra stage matters where f sees the time, which that of a free body does not.
    assert_eq!(broken(&dense(|stages, _| stages[0].0 += 0.01)), [""; 0]);
}

#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "a debug build refuses a wrong tableau before its first step"
)]
fn faults_of_steps_are_found() {
    let mut coefficient = DOPRI5;
    coefficient.a[4][2] += 1e-3;
    coefficient.a[4][1] -= 1e-3;
    assert!(broken(&Rkmk::new(coefficient, Exp)).contains(&"order of steps".into()));
    let claims_more = Tableau { order: 7, ..VERNER6 };
    assert!(broken(&Rkmk::new(claims_more, Exp)).contains(&"order of steps".into()));
    let without_dexpinv = Rkmk::new(DOPRI5, Faulty(Exp, Fault::NoDifferential));
    assert!(broken(&without_dexpinv).contains(&"order of steps".into()));
    let off_group = Rkmk::new(DOP853, Faulty(Exp, Fault::OffGroup));
    assert!(broken(&off_group).contains(&"points on M".into()));
}

#[test]
fn faults_of_runs_are_found() {
    let method = Rkmk::new(DOPRI5, Exp);
    let is_adaptive = |trial: &Trial| matches!(trial.steps, TrialSteps::Tolerance(_));

    // Two rows change places.
    let swapped = broken_runs(&method, |method, trial| {
        let mut record = method.run(trial)?;
        let rows = record.rows.len();
        if rows > 4 {
            record.rows.swap(2, 3);
        }
        Ok(record)
    });
    assert!(swapped.contains(&"order within steps".into()), "{swapped:?}");
    assert!(swapped.contains(&"tolerance".into()), "{swapped:?}");

    // Rows are a millionth of the span late.
    let late = broken_runs(&method, |method, mut trial| {
        let end = trial.t_span[1];
        trial.times.iter_mut().for_each(|t| *t = (*t + 4e-6).min(end));
        method.run(trial)
    });
    assert!(late.contains(&"order within steps".into()), "{late:?}");
    assert!(!late.contains(&"order of steps".into()), "{late:?}");

    // The tolerance is forgotten.
    let loose = broken_runs(&method, |method, mut trial| {
        if let TrialSteps::Tolerance(tolerance) = &mut trial.steps {
            *tolerance *= 1e6;
        }
        method.run(trial)
    });
    assert!(loose.contains(&"tolerance".into()), "{loose:?}");

    // An event is placed by the secant of two rows.
    let secant = broken_runs(&method, |method, trial| {
        let (times, event) = (trial.times.clone(), trial.event);
        let mut record = method.run(trial)?;
        let Some((place, value)) = event else { return Ok(record) };
        let g: Vec<f64> = record.rows.iter().map(|row| row[place] - value).collect();
        record.events = (0..g.len() - 2)
            .filter(|&i| g[i] * g[i + 2] < 0.0)
            .map(|i| times[i] - g[i] * (times[i + 2] - times[i]) / (g[i + 2] - g[i]))
            .collect();
        Ok(record)
    });
    assert_eq!(secant, ["events"]);

    // No event is found.
    let none = broken_runs(&method, |method, trial| {
        Ok(Record { events: Vec::new(), ..method.run(trial)? })
    });
    assert_eq!(none, ["events"]);

    // Dense output where shorter steps were asked for, with an error of its own.
    let by_steps = broken_runs(&method, |method, trial| {
        let by_steps = trial.times_by_steps;
        let mut record = method.run(trial)?;
        if by_steps {
            record.rows[5][0] += 1e-3;
        }
        Ok(record)
    });
    assert_eq!(by_steps, ["points by steps"]);

    // The last bit of a number differs after a saved state.
    let ulp = broken_runs(&method, |method, trial| {
        let resumed = trial.resume.is_some();
        let mut record = method.run(trial)?;
        if resumed {
            record.rows.last_mut().unwrap()[1] *= 1.0 + f64::EPSILON;
        }
        Ok(record)
    });
    assert_eq!(ulp, ["saved state"]);

    // A row is lost.
    let lost = broken_runs(&method, |method, trial| {
        let adaptive = is_adaptive(&trial);
        let mut record = method.run(trial)?;
        if adaptive {
            record.rows.pop();
        }
        Ok(record)
    });
    assert!(lost.contains(&"tolerance".into()), "{lost:?}");

    // Points next to the end of a step are not next to its state.
    let jump = broken_runs(&method, |method, trial| {
        let few = trial.times.len() == 4;
        let mut record = method.run(trial)?;
        if few {
            record.rows[2][0] += 1e-6;
        }
        Ok(record)
    });
    assert_eq!(jump, ["ends of steps"]);
}

#[test]
fn steps_that_are_not_exact_are_found() {
    struct Claims<'a>(&'a dyn Subject);
    impl Subject for Claims<'_> {
        fn order(&self) -> Option<usize> {
            None
        }
        fn dense_order(&self) -> usize {
            self.0.dense_order()
        }
        fn run(&self, trial: Trial) -> Result<Record, String> {
            self.0.run(trial)
        }
    }
    let problem = &RigidBody::new([1.0, 2.0, 3.0]).unwrap();
    let start = &START;
    let classical = MethodOn { problem, method: &Rk(DOP853), start };
    let lie = MethodOn { problem, method: &Rkmk::new(DOP853, Cay), start };
    let reference = Reference::new(&classical, &lie, [0.0, 4.0]).unwrap();
    let findings = runs_agree(&Claims(&lie), &reference);
    let broken: Vec<_> = findings.iter().filter(|f| !f.holds()).map(|f| &f.name[..]).collect();
    assert!(broken.contains(&"order of steps"), "{findings:?}");
}
