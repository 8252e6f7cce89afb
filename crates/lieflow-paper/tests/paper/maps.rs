//! The page of the maps: the errors that it shows are those that are promised, and it is complete.

use core::f64::consts::{PI, TAU};

use lieflow_paper::maps::{Over, StudyExtent, Topic, page, points, survey};

/// What the closed forms on so(3) promise, in units of ε·cond.
const CLOSED: f64 = 4.0;
/// The same for the general layer at n = 3, where the two layers may differ by 8; its logarithm goes
/// through a Schur form and is allowed a rounding for each of its n² rotations.
const GENERAL: f64 = 8.0;

#[test]
fn maps_are_as_accurate_as_promised_and_all_are_shown() {
    let effort = StudyExtent { directions: 4, largest: 6, rounds: 1 };
    let studies = survey(&effort, 1, |_| {}).unwrap();
    assert_eq!(studies.len(), 2 * Topic::ALL.len());
    for study in &studies {
        let name = study.topic.name();
        for line in &study.lines {
            assert!(line.points.iter().all(|p| p.seconds > 0.0), "{name} by {}", line.name);
            let Some(worst) = line.worst() else { panic!("{name} by {}: no value", line.name) };
            let bound = match line.name {
                "closed form" => CLOSED,
                "general layer" => GENERAL,
                _ => continue,
            };
            assert!(worst.error <= bound, "{name} by {}: {worst:?}", line.name);
            // Values to the very end: only dexp⁻¹ has none at 2π.
            let refused = line.points.iter().filter(|p| p.refused > 0).map(|p| p.at);
            let allowed = |at: f64| study.topic == Topic::Dexpinv && at > 0.999 * TAU;
            assert!(
                refused.clone().all(allowed),
                "{name} refuses at {:?}",
                refused.collect::<Vec<_>>()
            );
        }
        if study.over == Over::Angle {
            let first = &study.lines[0].points;
            assert_eq!(first[0].at, 1e-16);
            let last = if study.topic == Topic::Log { 0.999 * PI } else { 0.999 * TAU };
            assert!(first.iter().any(|p| p.at > last && !p.error.is_nan()), "{name}");
        }
    }

    let html = page(&studies).html();
    assert_eq!(html.matches("<figure>").count(), 2 * studies.len());
    assert!(!html.contains("NaN") && html.contains("href=\"index.html\""));
    let all: usize = studies.iter().flat_map(|s| &s.lines).map(|l| l.points.len()).sum();
    assert_eq!(points(&studies).lines().count(), 1 + all);
}
