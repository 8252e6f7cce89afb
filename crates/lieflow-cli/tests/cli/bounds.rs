//! `compare` and `order` keep to what bounds the steps of a scene: its largest step, and knots and magnets that end steps.

use std::time::Duration;

use lieflow::catalog::MethodSpec;
use lieflow_cli::measure::{Candidate, Judge, NEVER, Reference, Size};
use lieflow_model::scene::{Bundled, Scene};

/// The errors of `rkmk dop853 exp` in steps of these sizes, and the reference.
fn errors(scene: &Scene, sizes: &[Size]) -> (Vec<f64>, Reference) {
    let quantities: Vec<&str> = scene.quantities.iter().map(String::as_str).collect();
    let t_span = scene.grid.t_span();
    let judge =
        Judge::new(scene, &quantities, t_span, &[], Duration::from_secs(1), &NEVER).unwrap();
    let model = scene.model_with(scene.layer, &judge.quantities()).unwrap();
    let mut method = MethodSpec::new("rkmk", Some("exp"));
    method.tableau = Some("dop853".into());
    let candidate = Candidate { method, layer: scene.layer, adaptive: false };
    let error = |size: &Size| judge.point(&model, &candidate, *size).error;
    (sizes.iter().map(error).collect(), judge.reference.clone())
}

/// A pulse of a millisecond, which steps without the limit pass over: a run of few steps is wrong, and one by its error is
/// right with the limit alone. The reference has the pulse in both cases, without the limit by its own short steps.
#[test]
fn the_largest_step_is_kept() {
    let scene = |limit: &str| {
        let text = format!(
            "[problem]\nkind = \"driven-body\"\ninertia = [1, 2, 3]\nomega_body = [0.01, 0.02, 0.3]\n\
             torque = [\"0\", \"2000*exp(-((t - 4.13)/0.0005)^2)\", \"0\"]\n[time]\nt_span = [0, 10]\n{limit}\n"
        );
        Scene::parse("scene", &text).unwrap()
    };
    let sizes = [Size::Steps(23), Size::Tolerance(1e-9)];
    let (errors_with, reference) = errors(&scene("h_max = 0.0005"), &sizes);
    assert!(errors_with[0] > 0.1 && errors_with[1] < 1e-6, "{errors_with:?}");
    assert!(reference.floor() < 1e-8, "{reference:?}");
    assert!(matches!(reference, Reference::Own { largest: None, .. }), "{reference:?}");
    let (without, reference) = errors(&scene(""), &sizes);
    assert!(without.iter().all(|error| *error > 0.1), "{without:?}");
    assert!(matches!(reference, Reference::Own { largest: Some(0.005), .. }), "{reference:?}");
}

/// Steps end at magnets where the scene says so. Where the error chooses them, they do unless it says otherwise.
#[test]
fn steps_end_at_magnets() {
    let at_knots = |value: &str| {
        let text = Bundled::named("fodo-cell").unwrap().text;
        let text = text.replace("[time]\n", &format!("[time]\n{value}\n"));
        errors(&Scene::parse("scene", &text).unwrap(), &[Size::Steps(960), Size::Tolerance(1e-6)]).0
    };
    let [own, with, without] = ["", "at_knots = true", "at_knots = false"].map(at_knots);
    // In the bundled scene steps of one size end at magnets by their size, 1/8, of which 1/4 is no part.
    assert!(own[0] > 1e-3 && with[0] < 1e-11 && without[0] > 1e-3, "{own:?} {with:?} {without:?}");
    assert!(own[1] < 1e-9 && with[1] < 1e-9, "{own:?} {with:?}");
    // Else they pass the jumps there in short steps.
    assert!(without[1] < 1e-9, "{without:?}");
}
