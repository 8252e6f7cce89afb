//! `lieflow methods`: which method to take; methods, coordinate maps and tableaus.

use lieflow::catalog::{MethodInfo, MethodSpec, Needs, Order, TABLEAUS, TableauInfo, all_methods};
use lieflow::maps::{Exp, MAPS, MapInfo};
use lieflow::names::same;
use lieflow::problems::{Law, Origin};
use serde::Serialize;

use crate::args::{MethodsArgs, quoted};
use crate::error::CliError;
use crate::measure::Kept;
use crate::output::{print, print_json, table, wrap};
use lieflow_model::problem::{Layer, Model, high_order};
use lieflow_model::reader::suggest;
use lieflow_model::scene::Scene;
use lieflow_model::schema::Observable;

#[derive(Serialize)]
struct Listing {
    /// The scene that everything here fits.
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<String>,
    methods: Vec<MethodEntry>,
    maps: Vec<MapEntry>,
    tableaus: Vec<TableauEntry>,
}

#[derive(Clone, Serialize)]
struct MethodEntry {
    name: &'static str,
    summary: &'static str,
    #[serde(skip)]
    needs: Needs,
    /// `None` if the order is that of the tableau, or the method is exact.
    order: Option<usize>,
    /// The order in words.
    #[serde(skip)]
    says_order: Order,
    maps: Vec<&'static str>,
    #[serde(skip)]
    takes_q: bool,
    tableaus: Vec<&'static str>,
    preserves: String,
    cost: String,
    source: &'static str,
}

#[derive(Serialize)]
struct MapEntry {
    name: &'static str,
    summary: &'static str,
    groups: String,
}

#[derive(Serialize)]
struct TableauEntry {
    name: &'static str,
    order: usize,
}

impl MapEntry {
    fn of(map: &MapInfo) -> Self {
        MapEntry { name: map.name, summary: map.summary, groups: map.groups_in_words() }
    }
}

impl TableauEntry {
    fn of(tableau: &TableauInfo) -> Self {
        TableauEntry { name: tableau.name, order: tableau.order }
    }
}

/// The method as the catalog has it, with the maps and tableaus that `fits` lets through; nothing
/// when there is no way to run it.
fn method_entry(info: &MethodInfo, fits: impl Fn(&MethodSpec) -> bool) -> Option<MethodEntry> {
    let plain = MethodSpec::new(info.name, None);
    let mut entry = MethodEntry {
        name: info.name,
        summary: info.summary,
        needs: info.needs,
        order: info.order.number(),
        says_order: info.order,
        maps: Vec::new(),
        takes_q: info.takes_q(),
        tableaus: Vec::new(),
        preserves: info.preserves_in_words(),
        cost: info.cost.to_string(),
        source: info.source,
    };
    if info.takes_map() {
        let names = info.takes().map(|map| map.name);
        entry.maps = names.filter(|map| fits(&MethodSpec::new(info.name, Some(map)))).collect();
    }
    let base = MethodSpec { map: entry.maps.first().map(|&map| map.into()), ..plain };
    if info.takes_tableau {
        let with = |name: &str| MethodSpec { tableau: Some(name.into()), ..base.clone() };
        entry.tableaus = TABLEAUS.iter().map(|t| t.name).filter(|name| fits(&with(name))).collect();
    }
    let lost = (info.takes_map() && entry.maps.is_empty())
        || (info.takes_tableau && entry.tableaus.is_empty())
        || !fits(&base);
    (!lost).then_some(entry)
}

/// A scene, and what its methods are to keep.
#[derive(Clone, Copy)]
struct Wanted<'a> {
    scene: Option<&'a Scene>,
    keep: Option<&'a Kept>,
}

impl Wanted<'_> {
    /// Does a method fit, on the model of the scene?
    fn fits(&self, model: Option<&Model>, method: &MethodSpec) -> bool {
        model.is_none_or(|model| model.fits(method).is_ok())
            && self.keep.is_none_or(|kept| kept.by(method))
    }
}

fn listing(wanted: Wanted<'_>) -> Result<Listing, CliError> {
    let scene = wanted.scene;
    let model = scene.map(Scene::model).transpose()?;
    let fits = |spec: &MethodSpec| wanted.fits(model.as_ref(), spec);
    let methods: Vec<_> = all_methods().filter_map(|info| method_entry(info, fits)).collect();
    let used = |map: &str| methods.iter().any(|method| method.maps.contains(&map));
    let maps = MAPS.iter().filter(|map| used(map.name));
    Ok(Listing {
        scene: scene.map(|scene| scene.name.clone()),
        maps: maps.map(MapEntry::of).collect(),
        tableaus: TABLEAUS.iter().map(TableauEntry::of).collect(),
        methods,
    })
}

/// A need, and the methods that serve it.
struct Advice {
    want: &'static str,
    because: &'static str,
    /// A scene is advised the first that serves it.
    take: &'static [Take],
}

/// A method that serves a need.
struct Take {
    method: &'static str,
    /// The problems that it is for, in words. Empty for all that it fits.
    problems: &'static str,
    serves: Serves,
}

/// The problems that a method serves.
enum Serves {
    /// All that it fits.
    Fitting,
    /// Those whose invariants are polynomials of degree 2 at most.
    QuadraticInvariants,
    /// Those on the layer of matrices of any size, where cay costs less than exp.
    Matrices,
    /// Those on the layer of closed formulas, where a bracket costs less than exp.
    Closed,
}

const fn take(method: &'static str, problems: &'static str) -> Take {
    Take { method, problems, serves: Serves::Fitting }
}

const fn on_matrices(method: &'static str) -> Take {
    Take { method, problems: "matrices", serves: Serves::Matrices }
}

/// The usual wants. `tests/cli/advice.rs` holds the first two beside other methods.
const ADVICE: &[Advice] = &[
    Advice {
        want: "small errors",
        because: "a high order needs few steps",
        take: &[
            take("taylor16-m", "free bodies by their momentum alone"),
            take("taylor16", "free bodies, tops, pendulums"),
            Take {
                method: "magnus8",
                problems: "spins in a field of time",
                serves: Serves::Closed,
            },
            take("cfm6-5", "y' = A(t) y"),
            on_matrices("rkmk dop853 cay"),
            take("rkmk dop853", "all others"),
        ],
    },
    Advice {
        want: "rough answers, soon",
        because: "it takes little time to errors of 1e-2 to 1e-4",
        take: &[
            take("taylor12-m", "free bodies by their momentum alone"),
            take("taylor12", "free bodies, tops, pendulums"),
            take("cfm4-2", "y' = A(t) y"),
            on_matrices("rkmk dopri5 cay"),
            take("rkmk dopri5", "all others"),
        ],
    },
    Advice {
        want: "energy that stays",
        because: "it conserves the energy to rounding; each step iterates",
        take: &[
            take("dmv8", "free bodies"),
            Take {
                method: "gauss4",
                problems: "quadratic invariants only, as chains of spins: it conserves them all",
                serves: Serves::QuadraticInvariants,
            },
            take("energy-casimir4", "other Lie–Poisson systems"),
        ],
    },
    Advice {
        want: "long runs, large steps",
        because: "it is symplectic: the energy error stays within bounds",
        take: &[take("mr4", "free bodies"), take("isospectral4", "momenta as matrices")],
    },
    Advice {
        want: "y' = A(t) y",
        because: "f depends on t alone: one exponential is a step of order 6",
        take: &[take("magnus6", "")],
    },
    Advice {
        want: "symmetry in time",
        because: "a step back undoes a step; each step iterates",
        take: &[take("rkmk-gauss4-symmetric", "")],
    },
    Advice {
        want: "the exact motion",
        because: "any time at once, at one evaluation for each row of output",
        take: &[take("exact", "free bodies")],
    },
];

/// True if the problem has invariants, its energy among them, and the energy and all that the action keeps are polynomials of
/// degree 2 at most in the state. Methods that keep the energy promise nothing of further integrals.
fn has_quadratic_invariants(scene: &Scene) -> Result<bool, CliError> {
    let quantities: Vec<&str> = scene.quantities.iter().map(String::as_str).collect();
    let kept = scene.problem.invariants(&quantities);
    let model = scene.model_with(scene.layer, &kept)?;
    let mut laws = model.schema().laws();
    let is_quadratic = |observable: &Observable| {
        let is_further = |law: Law| law.origin == Origin::Flow && observable.name != "energy";
        observable.law.is_some_and(|law| is_further(law) || (1..=2).contains(&law.degree))
    };
    Ok(kept.contains(&"energy") && laws.all(is_quadratic))
}

/// The recommendations: for a scene, which was typed like this, or for all.
fn advice(wanted: Wanted<'_>, typed: &str) -> Result<String, CliError> {
    let scene = wanted.scene;
    let model = scene.map(Scene::model).transpose()?;
    let quadratic = scene.map(has_quadratic_invariants).transpose()?.unwrap_or(false);
    let default = scene.map_or_else(high_order, |scene| scene.problem.default_method());
    let mut rows = Vec::new();
    if wanted.fits(model.as_ref(), &default) {
        let of = if scene.is_some() { "the default" } else { "the default of most kinds" };
        rows.push([
            "nothing special".into(),
            format!("{} ({of})", default.label()),
            "it stays on the group, and chooses its steps by rtol".into(),
        ]);
    }
    for Advice { want, because, take } in ADVICE {
        let mut first = true;
        for Take { method, problems, serves } in *take {
            let serves = match serves {
                Serves::Fitting => true,
                Serves::QuadraticInvariants => quadratic,
                Serves::Matrices => scene.is_some_and(|scene| scene.layer == Layer::General),
                Serves::Closed => scene.is_some_and(|scene| scene.layer == Layer::Closed),
            };
            let take = match &model {
                None if problems.is_empty() => (*method).to_string(),
                None => format!("{method} ({problems})"),
                Some(model) if first && serves && wanted.fits(Some(model), &method.parse()?) => {
                    (*method).to_string()
                }
                Some(_) => continue,
            };
            let [want, because] = [want, because].map(|text| if first { *text } else { "" });
            first = false;
            // The default is in a row above.
            if take != default.label() {
                rows.push([want.into(), take, because.into()]);
            }
        }
    }
    let keep = wanted.keep.map_or_else(String::new, |kept| format!(" --keep {}", kept.name()));
    let high = if wanted.fits(model.as_ref(), &"dmv10".parse()?) { ", such as dmv10" } else { "" };
    let more = format!(
        "`lieflow compare {typed} --error 1e-8{keep}` measures which method is the fastest. Only pairs (methods with a \
         tableau such as dop853, and cf43, cf-ls32, magnus43), taylorN, taylorN-m and exact estimate their error. With \
         rtol all other methods take each step once whole and once in two halves. Then compositions, DMV, Gauss methods and \
         energy-casimir lose what makes them good over long times: give them dt, or take one of high order{high}. No \
         method here is made for stiff problems: the implicit ones need short steps there too."
    );
    let table = table(["you want", "take", "because"], rows);
    Ok(format!("Take this one\n{table}\n{}", wrap(&more, "")))
}

/// Methods that are one but for a number or the order of axes: they follow each other, and the catalog says the
/// same of them.
fn folded(methods: &[MethodEntry]) -> impl Iterator<Item = &[MethodEntry]> {
    methods
        .chunk_by(|a, b| (a.needs, a.summary, &a.preserves) == (b.needs, b.summary, &b.preserves))
}

/// The first and the last, where they differ.
fn from_to(fold: &[MethodEntry], of: impl Fn(&MethodEntry) -> String) -> String {
    let ends = [fold.first(), fold.last()].map(|entry| entry.map(&of).unwrap_or_default());
    match ends {
        [first, last] if first == last => first,
        [first, last] => format!("{first} … {last}"),
    }
}

fn in_words(listing: &Listing) -> String {
    let mut text = String::new();
    let takes = |method: &MethodEntry| match (&method.maps[..], &method.tableaus[..]) {
        ([], []) => "",
        (_, []) if method.takes_q => "map, q",
        (_, []) => "map",
        ([], _) => "tableau",
        _ => "map, q, tableau",
    };
    for needs in Needs::ALL {
        let of_need = |entry: &&MethodEntry| entry.needs == needs;
        let entries: Vec<MethodEntry> = listing.methods.iter().filter(of_need).cloned().collect();
        if entries.is_empty() {
            continue;
        }
        text += &match needs {
            Needs::Field => format!("\nMethods for {EVERY}\n"),
            Needs::Norm => "\nImplicit methods for every problem with a norm\n".to_string(),
            needs => format!("\nMethods that need {}\n", needs.describe()),
        };
        let rows = folded(&entries).map(|fold| {
            let (order, cost) =
                (|m: &MethodEntry| m.says_order.to_string(), |m: &MethodEntry| m.cost.clone());
            let name = from_to(fold, |m| m.name.into());
            let name = if fold.len() > 2 { format!("{name} ({})", fold.len()) } else { name };
            let [takes, keeps] = [takes(&fold[0]).to_string(), fold[0].preserves.clone()];
            [name, from_to(fold, order), takes, keeps, from_to(fold, cost)]
        });
        text += &table(["name", "order", "takes", "it keeps", "a step costs"], rows);
    }
    if !listing.maps.is_empty() {
        text += "\nCoordinate maps\n";
        let rows = listing.maps.iter().map(|m| [m.name.into(), m.groups.clone(), m.summary.into()]);
        text += &table(["name", "groups", "what it is"], rows);
    }
    let tableaus = listing.tableaus.iter().map(|t| format!("{} ({})", t.name, t.order));
    let tableaus = tableaus.collect::<Vec<_>>().join(", ");
    text += &format!("\nTableaus, with their orders\n{}", wrap(&tableaus, " "));
    if listing.scene.is_some() {
        let differ = listing.methods.iter().filter(|method| !method.maps.is_empty());
        for method in differ.filter(|method| method.maps.len() < listing.maps.len()) {
            text += &format!("\n{} takes the maps {} only.\n", method.name, method.maps.join(", "));
        }
    }
    text + "\n`lieflow methods NAME` tells what a method is, and where it comes from.\n"
}

/// What methods are for that need nothing but f.
const EVERY: &str = "every problem";

/// Everything about one method.
fn one_in_words(method: &MethodEntry) -> String {
    let (is_for, needs) = match method.needs {
        Needs::Field => (EVERY, ""),
        needs => ("", needs.describe()),
    };
    let mut text = format!("{}\n", method.name);
    text += &wrap(&format!("{}. {}.", method.summary, method.source.trim_end_matches('.')), " ");
    let rows = [
        ("for", is_for.to_string()),
        ("needs", needs.to_string()),
        ("order", method.says_order.to_string()),
        ("keeps", method.preserves.clone()),
        ("a step costs", method.cost.clone()),
        ("maps", method.maps.join(", ")),
        ("tableaus", method.tableaus.join(", ")),
    ];
    for (what, is) in rows.into_iter().filter(|(_, is)| !is.is_empty()) {
        text += &wrap(&format!("{what}: {is}"), " ");
    }
    text
}

/// What a name in a listing is: a method, with parts where it has some, a tableau or a map.
enum Named {
    Method(MethodEntry),
    Tableau(&'static TableauInfo),
    Map(&'static MapInfo),
}

/// The tableau with this name.
fn tableau_named(name: &str) -> Option<&'static TableauInfo> {
    TABLEAUS.iter().find(|tableau| same(tableau.name, name))
}

/// What is called by this name: a method, if one is.
///
/// # Errors
/// Nothing is.
fn named(name: &str) -> Result<Named, CliError> {
    let is_method = all_methods().any(|info| same(info.name, name));
    if let Some(tableau) = tableau_named(name).filter(|_| !is_method) {
        return Ok(Named::Tableau(tableau));
    }
    if let Some(map) = MAPS.iter().find(|map| same(map.name, name)) {
        return Ok(Named::Map(map));
    }
    let nothing = |why: String| CliError::Message(format!("there is no method `{name}`{why}"));
    let first = name.split_whitespace().next().unwrap_or_default();
    let Some(info) = all_methods().find(|info| same(info.name, first)) else {
        let names = all_methods().map(|info| info.name);
        let parts = TABLEAUS.iter().map(|t| t.name).chain(MAPS.iter().map(|map| map.name));
        let names: Vec<&str> = names.chain(parts).collect();
        let near = suggest(name, &names).map(|near| format!("; did you mean `{near}`?"));
        return Err(nothing(near.unwrap_or_else(|| ": `lieflow methods` lists them".into())));
    };
    let spec: MethodSpec = name.parse().map_err(|why| nothing(format!(": {why}")))?;
    let is_part = |given: &Option<String>, part: &Option<String>| {
        given.as_ref().is_none_or(|given| part.as_ref() == Some(given))
    };
    let fits = |other: &MethodSpec| {
        (other.map.is_none() || is_part(&spec.map, &other.map))
            && (other.tableau.is_none() || is_part(&spec.tableau, &other.tableau))
    };
    let entry = method_entry(info, fits).ok_or_else(|| nothing(String::new()))?;
    let of_tableau = spec.tableau.as_deref().and_then(|tableau| {
        TABLEAUS.iter().find(|info| info.name == tableau).map(|info| info.order)
    });
    let order = of_tableau.or(entry.order).map(|order| match spec.q {
        Some(q) => order.min(Exp.truncated(q).order_kept()),
        None => order,
    });
    let says_order = order.map_or(entry.says_order, Order::Of);
    Ok(Named::Method(MethodEntry { order, says_order, ..entry }))
}

/// Everything about a tableau.
fn tableau_in_words(TableauInfo { name, order, stages, pair, .. }: &TableauInfo) -> String {
    let with = if *pair { "with an error estimate" } else { "without an error estimate" };
    let takes = all_methods().filter(|info| info.takes_tableau).map(|info| info.name);
    let takes: Vec<_> = takes.collect();
    let mut text = format!("{name}\n");
    let many = if *stages == 1 { "" } else { "s" };
    let what = format!("A Runge–Kutta tableau of order {order} with {stages} stage{many}, {with}.");
    text += &wrap(&what, " ");
    text += &wrap(&format!("methods that take it: {}", takes.join(", ")), " ");
    text += &wrap(&format!("in a scene: name = \"{}\", tableau = \"{name}\"", takes[0]), " ");
    text
}

/// Everything about a map.
fn map_in_words(map: &MapInfo) -> String {
    let takes = all_methods().filter(|info| info.takes().any(|one| one.name == map.name));
    let takes = takes.map(|info| info.name);
    let takes: Vec<_> = takes.collect();
    let mut text = format!("{}\n", map.name);
    text += &wrap(&format!("A coordinate map: {}.", map.summary), " ");
    text += &wrap(&format!("groups: {}", map.groups_in_words()), " ");
    text += &wrap(&format!("methods that take it: {}", takes.join(", ")), " ");
    text
}

/// Run the command.
///
/// # Errors
/// There is no such method; the scene cannot be used; standard output cannot be written.
pub fn run(args: &MethodsArgs) -> Result<(), CliError> {
    if args.scene.is_none() && !args.settings.set.is_empty() {
        return Err(CliError::Message("--set changes a scene: name it with --for".into()));
    }
    if let Some(name) = &args.name {
        return match (named(name)?, args.json) {
            (Named::Method(entry), true) => print_json(&entry),
            (Named::Method(entry), false) => {
                let tableau =
                    tableau_named(name).map(|info| "\n".to_owned() + &tableau_in_words(info));
                print(&(one_in_words(&entry) + &tableau.unwrap_or_default()))
            }
            (Named::Tableau(tableau), true) => print_json(&TableauEntry::of(tableau)),
            (Named::Tableau(tableau), false) => print(&tableau_in_words(tableau)),
            (Named::Map(map), true) => print_json(&MapEntry::of(map)),
            (Named::Map(map), false) => print(&map_in_words(map)),
        };
    }
    let scene = args.scene.as_deref().map(|scene| args.settings.open(scene)).transpose()?;
    let keep = match (&scene, &args.keep) {
        (Some(scene), Some(name)) => Some(Kept::of(scene, name)?),
        _ => None,
    };
    let wanted = Wanted { scene: scene.as_ref(), keep: keep.as_ref() };
    let listing = listing(wanted)?;
    if args.json {
        return print_json(&listing);
    }
    let about = match &scene {
        Some(scene) => format!("Methods for the scene {}\n\n", scene.name),
        None => String::new(),
    };
    let typed = args.scene.as_ref().map_or("SCENE".into(), |path| {
        quoted(&path.display().to_string()) + &args.settings.typed()
    });
    print(&(about + &advice(wanted, &typed)? + &in_words(&listing)))
}
