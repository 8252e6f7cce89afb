//! The checks of every method on every type of problem, in the build at hand.
//!
//! The methods are compiled once for each type of problem, so each type is checked by at least one scene.

use std::collections::BTreeSet;
use std::path::Path;
use std::time::Duration;

use lieflow::catalog::{Family, MethodSpec, TABLEAUS, all_methods};
use lieflow::check::{Finding, Record, Reference, Subject, Trial, TrialSteps, runs_agree};
use lieflow::problems::Origin;
use lieflow::solve::Next;
use lieflow::{SaveAt, StepControl, TimeGrid};
use lieflow_runs::schema::{Observable, Row};

use crate::problem::{EventPlan, Layer, Model, Plan, Steps, Watcher};
use crate::scene::{Scene, SceneError};

/// A bundled scene that is checked: its name, its layer, what is changed, and the span.
struct Case {
    scene: &'static str,
    layer: Layer,
    settings: &'static [&'static str],
    span: f64,
    /// True if a quick check takes all methods, too.
    every: bool,
}

const fn case(scene: &'static str, span: f64) -> Case {
    Case { scene, layer: Layer::General, settings: &[], span, every: false }
}

const fn closed(scene: &'static str, span: f64) -> Case {
    Case { layer: Layer::Closed, ..case(scene, span) }
}

const fn free_body(scene: &'static str, span: f64) -> Case {
    Case { every: true, ..closed(scene, span) }
}

/// The cases, in the order of the kinds. Spans are such that a method of order 8 needs some tens of steps.
const CASES: &[Case] = &[
    Case { settings: &["problem.omega_body=[0.5,1.0,0.5]"], ..free_body("flips", 20.0) },
    Case { settings: &["problem.omega_body=[0.5,1.0,0.5]"], ..case("flips", 20.0) },
    free_body("tumbling-attitude", 8.0),
    case("tumbling-attitude", 8.0),
    free_body("wing-nut", 4.0),
    closed("damped-satellite", 8.0),
    closed("nutating-top", 1.0),
    closed("many-bodies", 8.0),
    case("manakov-body", 4.0),
    closed("lagrange-top", 4.0),
    closed("ellipsoid-in-fluid", 8.0),
    case("euler-on-sl3", 2.0),
    Case { settings: &["output.quantities=[\"momentum\",\"group\"]"], ..case("euler-on-sl3", 2.0) },
    closed("cubic-anisotropy", 4.0),
    Case { settings: &["problem.n=4"], ..case("vortices-on-sphere", 4.0) },
    Case {
        settings: &["problem.n=5", "problem.jets=[[1,-0.58],[2,0.52]]"],
        ..case("shear-layer", 4.0)
    },
    closed("rolling-turn", 4.0),
    closed("spherical-pendulum", 2.0),
    closed("rotating-field", 8.0),
    closed("spin-wave", 4.0),
    closed("chiral-spin-wave", 4.0),
    case("toda-lattice", 2.0),
    case("sorting", 0.5),
    case("qr-flow", 3.0),
    case("oja", 1.0),
    case("subspaces", 2.0),
    case("mathieu", 6.0),
    case("riccati-pole", 1.2),
    case("crossed-fields", 4.0),
    case("rabi", 8.0),
    case("stirap", 8.0),
    case("thermal-qubit", 8.0),
    case("rotating-drive", 2.0),
    case("lorenz", 0.2),
    closed("gyrostat", 4.0),
    closed("spin-and-oscillator", 4.0),
];

/// The methods of a quick check.
const FEW: [&str; 8] = [
    "rkmk4 cay",
    "rkmk dop853 exp",
    "rk dop853",
    "rkmk dopri5 exp",
    "cf4",
    "gauss4",
    "cfm6-5",
    "exact",
];

/// The result for a scene.
#[derive(Clone, Debug)]
pub struct CheckedScene {
    /// The name of the scene with its layer.
    pub name: String,
    /// The types of the problem that its methods run on.
    pub problem_types: BTreeSet<&'static str>,
    /// The number of methods.
    pub methods: usize,
    /// The number of checks.
    pub checks: usize,
    /// The findings that do not hold, with their methods.
    pub failures: Vec<(String, Finding)>,
}

/// Checks all types of problems, and calls `each` with each result. A quick check takes few methods.
///
/// # Errors
/// A scene that cannot be read, which is a fault of this program.
pub fn check_runs(quick: bool, mut each: impl FnMut(CheckedScene)) -> Result<(), SceneError> {
    for case in CASES {
        let settings: Vec<String> = case.settings.iter().map(|&text| text.into()).collect();
        let scene = Scene::open_with(Path::new(case.scene), &settings)?;
        let name = [&[case.scene], case.settings].concat().join(" ");
        let name = format!("{name} ({})", case.layer.name());
        let mut result = CheckedScene {
            name,
            methods: 0,
            checks: 0,
            problem_types: BTreeSet::new(),
            failures: Vec::new(),
        };
        match scene.model_with(case.layer, &quantities(&scene)) {
            Err(error) => result.fail("setup", error.to_string()),
            Ok(model) => {
                let classical = Method::named(&model, &scene, "rk dop853");
                let lie = Method::named(&model, &scene, "rkmk dop853 exp");
                match classical.zip(lie) {
                    None => result.fail("setup", "the reference methods do not fit".into()),
                    Some(both) => {
                        let methods =
                            if quick && !case.every { few_methods() } else { every_method() };
                        result.check(&scene, &model, case.span, both, methods);
                    }
                }
            }
        }
        each(result);
    }
    Ok(())
}

/// The quantities that a check needs: the state, and the laws.
fn quantities(scene: &Scene) -> Vec<&str> {
    let computed = scene.computed();
    let mut all = scene.problem.state(&computed).to_vec();
    for law in scene.problem.invariants(&computed) {
        if !all.contains(&law) {
            all.push(law);
        }
    }
    all
}

impl CheckedScene {
    fn fail(&mut self, method: &str, at: String) {
        let name = "reference".into();
        let finding = Finding { name, cases: 1, worst: f64::INFINITY, at, bound: 1.0 };
        self.failures.push((method.into(), finding));
    }

    fn check(
        &mut self,
        scene: &Scene,
        model: &Model,
        span: f64,
        (classical, lie): (Method<'_>, Method<'_>),
        methods: Vec<MethodSpec>,
    ) {
        let t0 = scene.grid.t_span()[0];
        let t_span = [t0, t0 + span];
        // Each of the two references is that of the methods of the other kind.
        let references = [(&classical, &lie), (&lie, &classical)]
            .map(|(method, other)| Reference::new(method, other, t_span));
        let [of_classical, of_lie] = match references {
            [Ok(a), Ok(b)] => [a, b],
            [Err(why), _] | [_, Err(why)] => return self.fail("rk dop853 and rkmk dop853", why),
        };
        if let Some(finding) = against_exact(model, &classical, &of_classical) {
            self.see("the exact motion", finding);
        }
        for spec in methods {
            let is_classical = spec
                .info()
                .is_ok_and(|info| matches!(info.family, Family::RungeKutta | Family::Projection));
            let Some(method) = Method::new(model, scene, spec) else { continue };
            self.methods += 1;
            self.problem_types.insert(method.problem_type());
            let reference = if is_classical { &of_lie } else { &of_classical };
            let label = method.spec.label();
            for finding in runs_agree(&method, reference) {
                self.see(&label, finding);
            }
        }
    }

    fn see(&mut self, method: &str, finding: Finding) {
        self.checks += 1;
        if !finding.holds() {
            self.failures.push((method.into(), finding));
        }
    }
}

/// The rows of the reference against the exact solution, if it is known.
fn against_exact(model: &Model, method: &Method<'_>, reference: &Reference) -> Option<Finding> {
    let [t0, _] = reference.t_span();
    let mut worst = 0.0;
    for (t, row) in reference.rows() {
        let exact = model.exact([t0, t])?.ok()?;
        let exact = method.numbers(model.schema().row(&exact));
        let gap = method.distance(row, &exact);
        worst = if gap > worst || gap.is_nan() { gap } else { worst };
    }
    let (name, at) = ("reference".into(), format!("{worst:e} from the exact solution"));
    Some(Finding { name, cases: 1, worst: worst / reference.floor(), at, bound: 1.0 })
}

/// Every method of the catalog, with each map and each tableau that it takes.
fn every_method() -> Vec<MethodSpec> {
    let mut all = Vec::new();
    for info in all_methods() {
        let names = |takes: bool, names: &mut dyn Iterator<Item = &'static str>| match takes {
            true => names.map(|name| Some(String::from(name))).collect(),
            false => vec![None],
        };
        let maps: Vec<_> = names(info.takes_map(), &mut info.takes().map(|map| map.name));
        let tableaus: Vec<_> = names(info.takes_tableau, &mut TABLEAUS.iter().map(|t| t.name));
        for map in &maps {
            for tableau in &tableaus {
                let (map, tableau) = (map.clone(), tableau.clone());
                all.push(MethodSpec { map, tableau, ..MethodSpec::new(info.name, None) });
            }
        }
    }
    all
}

fn few_methods() -> Vec<MethodSpec> {
    FEW.iter().filter_map(|text| text.parse().ok()).collect()
}

/// A method on a model.
struct Method<'a> {
    model: &'a Model,
    spec: MethodSpec,
    order: Option<usize>,
    dense_order: usize,
    state: Vec<&'a Observable>,
    /// What the method conserves because it stays on M.
    laws: Vec<&'a Observable>,
}

impl<'a> Method<'a> {
    fn named(model: &'a Model, scene: &Scene, text: &str) -> Option<Self> {
        Self::new(model, scene, text.parse().ok()?)
    }

    fn new(model: &'a Model, scene: &Scene, spec: MethodSpec) -> Option<Self> {
        model.fits(&spec).ok()?;
        let orders = model.orders(&spec).ok()?;
        let state = scene.problem.state(&scene.computed());
        let state = state.iter().map(|name| model.schema().get(name)).collect::<Result<_, _>>();
        let on_the_group = |law: &&Observable| {
            orders.stays_on_manifold && law.law.is_some_and(|law| law.origin == Origin::Action)
        };
        let laws = model.schema().laws().filter(on_the_group).collect();
        let (order, dense_order) = (orders.step, orders.within);
        Some(Method { model, spec, order, dense_order, state: state.ok()?, laws })
    }

    fn problem_type(&self) -> &'static str {
        self.model.problem_type(&self.spec)
    }

    /// The numbers of the state.
    fn numbers(&self, row: Row<'_>) -> Vec<f64> {
        self.state.iter().flat_map(|part| row[part].iter().copied()).collect()
    }

    /// The values of the laws, each with the size that its rounding is relative to.
    fn values(&self, row: Row<'_>) -> Vec<[f64; 2]> {
        let of = |law: &&Observable| {
            let values = row[law].iter().enumerate();
            values.map(|(i, &x)| [x, row.size(law, i)]).collect::<Vec<_>>()
        };
        self.laws.iter().flat_map(of).collect()
    }
}

impl Subject for Method<'_> {
    fn order(&self) -> Option<usize> {
        self.order
    }
    fn dense_order(&self) -> usize {
        self.dense_order
    }
    fn run(&self, trial: Trial) -> Result<Record, String> {
        let Trial { t_span, steps, times, times_by_steps, event, save, resume } = trial;
        let steps = match steps {
            TrialSteps::Equal(steps) => TimeGrid::with_steps(t_span, steps).map(Steps::Equal),
            TrialSteps::Tolerance(tolerance) => StepControl::new(tolerance, tolerance)
                .map(|control| Steps::ByError { t_span, control }),
        };
        let steps = steps.map_err(|error| error.to_string())?;
        let mut plan = Plan { times_by_steps, resume, ..Plan::new(steps, SaveAt::Times(times)) };
        plan.checkpoints = save.then_some(Duration::ZERO);
        if let Some((place, value)) = event {
            let places = (0..self.model.schema().columns().count()).collect();
            let value = move |_: f64, row: Row<'_>| self.numbers(row)[place] - value;
            plan.events.push(EventPlan::new("the reference value", places, value));
        }
        let mut seen = Seen { method: self, record: Record::default(), start: None };
        let done = self.model.drive(&self.spec, plan, &mut seen);
        let done = done.map_err(|error| error.to_string())?;
        Ok(Record { steps: done.stats.accepted, ..seen.record })
    }
}

/// What a run shows.
struct Seen<'a> {
    method: &'a Method<'a>,
    record: Record,
    /// The values of the laws in the first row.
    start: Option<Vec<[f64; 2]>>,
}

impl Watcher for Seen<'_> {
    fn row(&mut self, _: f64, row: Row<'_>) -> Next {
        self.record.rows.push(self.method.numbers(row));
        let values = self.method.values(row);
        let start = self.start.get_or_insert_with(|| values.clone());
        for ([value, size], [before, first]) in values.iter().zip(start) {
            let off = (value - *before).abs() / size.max(*first).max(f64::MIN_POSITIVE);
            let most = self.record.off.unwrap_or(0.0);
            self.record.off = Some(if off > most || off.is_nan() { off } else { most });
        }
        Next::Continue
    }
    fn event(&mut self, _: usize, t: f64, _: bool, _: Row<'_>) {
        self.record.events.push(t);
    }
    fn state(&mut self, bytes: &[u8]) {
        self.record.states.push(bytes.to_vec());
    }
}
