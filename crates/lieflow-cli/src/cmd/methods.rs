//! `lieflow methods`: methods, coordinate maps and tableaus.

use lieflow::catalog::{MethodInfo, MethodSpec, Order, TABLEAUS, all_methods};
use lieflow::maps::MAPS;
use serde::Serialize;

use super::CliError;
use crate::args::MethodsArgs;
use crate::output::{print, print_json, table, wrap};
use lieflow_model::scene::Scene;

#[derive(Serialize)]
struct Listing {
    /// The scene that everything here fits.
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<String>,
    methods: Vec<MethodEntry>,
    maps: Vec<MapEntry>,
    tableaus: Vec<TableauEntry>,
}

#[derive(Serialize)]
struct MethodEntry {
    name: &'static str,
    summary: &'static str,
    /// None where it is the tableau's, or the method exact.
    order: Option<usize>,
    /// The order in words.
    #[serde(skip)]
    says_order: Order,
    maps: Vec<&'static str>,
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

/// The method as the catalog has it, with the maps and tableaus that `fits` lets through; nothing
/// when there is no way to run it.
fn method_entry(info: &MethodInfo, fits: impl Fn(&MethodSpec) -> bool) -> Option<MethodEntry> {
    let plain = MethodSpec::new(info.name, None);
    let mut entry = MethodEntry {
        name: info.name,
        summary: info.summary,
        order: info.order.number(),
        says_order: info.order,
        maps: Vec::new(),
        tableaus: Vec::new(),
        preserves: info.preserves_in_words(),
        cost: info.cost.to_string(),
        source: info.source,
    };
    if info.takes_map() {
        let names = MAPS.iter().map(|map| map.name);
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

fn listing(scene: Option<&Scene>) -> Result<Listing, CliError> {
    let model = scene.map(Scene::model).transpose()?;
    let fits = |spec: &MethodSpec| match &model {
        Some(model) => model.fits(spec).is_ok(),
        None => true,
    };
    let methods: Vec<_> = all_methods().filter_map(|info| method_entry(info, fits)).collect();
    let used = |map: &str| methods.iter().any(|method| method.maps.contains(&map));
    let maps = MAPS.iter().filter(|map| used(map.name));
    let maps =
        maps.map(|m| MapEntry { name: m.name, summary: m.summary, groups: m.groups.to_string() });
    let tableaus = TABLEAUS.iter().map(|t| TableauEntry { name: t.name, order: t.order });
    Ok(Listing {
        scene: scene.map(|scene| scene.name.clone()),
        maps: maps.collect(),
        tableaus: tableaus.collect(),
        methods,
    })
}

fn in_words(listing: &Listing) -> String {
    let mut text = match &listing.scene {
        Some(scene) => format!("Methods that fit the scene {scene}\n"),
        None => "Methods\n".into(),
    };
    let takes = |method: &MethodEntry| match (&method.maps[..], &method.tableaus[..]) {
        ([], []) => "",
        (_, []) => "map, q",
        ([], _) => "tableau",
        _ => "map, q, tableau",
    };
    let rows = listing.methods.iter().map(|m| {
        let order = m.says_order.to_string();
        [m.name.into(), order, takes(m).into(), m.preserves.clone(), m.cost.clone()]
    });
    text += &table(["name", "order", "takes", "preserves", "cost of a step"], rows);
    text += "\n";
    for method in &listing.methods {
        let source = method.source.trim_end_matches('.');
        text += &wrap(&format!("{}: {}. {source}.", method.name, method.summary), " ");
    }
    if !listing.maps.is_empty() {
        text += "\nCoordinate maps\n";
        let rows = listing.maps.iter().map(|m| [m.name.into(), m.groups.clone(), m.summary.into()]);
        text += &table(["name", "groups", "what it is"], rows);
    }
    text += "\nTableaus\n";
    let rows = listing.tableaus.iter().map(|t| [t.name.into(), t.order.to_string()]);
    text += &table(["name", "order"], rows);
    if listing.scene.is_some() {
        let differ = listing.methods.iter().filter(|method| !method.maps.is_empty());
        for method in differ.filter(|method| method.maps.len() < listing.maps.len()) {
            text += &format!("\n{} takes the maps {} only.\n", method.name, method.maps.join(", "));
        }
    }
    text
}

/// Run the command.
///
/// # Errors
/// The scene cannot be used; standard output cannot be written.
pub fn run(args: &MethodsArgs) -> Result<(), CliError> {
    let scene = args.scene.as_deref().map(Scene::open).transpose()?;
    let listing = listing(scene.as_ref())?;
    match args.json {
        true => print_json(&listing),
        false => print(&in_words(&listing)),
    }
}
