//! A preset: a kind that is another kind, its base, with formulas; a TOML file in `presets/`.
//!
//! | in the file | |
//! |---|---|
//! | `name`, `equation`, `summary` | what listings say |
//! | `modelled`, `state`, `figure` | what is integrated, in words; the quantities that make up the state; the figure |
//! | `[[keys]]` | the keys: `name`, `meaning`, how many `numbers` where it is a list, `condition` |
//! | `[problem]` | the problem of the base; its formulas may name the keys |
//! | `[values]` | further keys of that problem: texts are formulas in the keys, and the base gets their values |
//! | `observed` | quantities of the base: their columns are the variables of the formulas of quantities |
//! | `[[quantities]]` | `name`, `columns`, `meaning`, `formulas`; `kept` is its law, with the size of its `terms` |
//!
//! A key `x` that is a list of numbers is `x1`, `x2`, ... in formulas.

use core::fmt;

use lieflow::problems::Origin;
use serde::de::{DeserializeSeed, Deserializer, Error as _, MapAccess, Visitor};
use toml::{Table, Value};

use super::keys::PARAMETERS;
use super::prelude::{Deserialize, Error, KeyPath, Law, Scale, ValueDeserializer};
use super::system::no_such_layer;
use super::{Figure, KeyInfo, Kind, ProblemSpec, QuantityInfo, ReadProblem};
use crate::mapped::Mapped;
use crate::model::{Layer, Model};
use crate::scene::formula::{Formula, Names, Parameters, Texts};
use crate::scene::values::{NumberList, Real};
use crate::scene::{ReadError, Refusal};
use crate::schema::{Row, Schema};

/// The entry of a preset in the list of kinds, by the name of its file.
macro_rules! preset {
    ($name:literal) => {{
        use std::sync::LazyLock;
        use $crate::kinds::{Kind, preset::Preset};
        static PRESET: LazyLock<Preset> = LazyLock::new(|| {
            Preset::parse(include_str!(concat!("../../presets/", $name, ".toml")))
        });
        static KIND: LazyLock<Kind> = LazyLock::new(|| {
            PRESET.kind(|| PRESET.quantities(), |section| PRESET.read(&KIND, section))
        });
        *KIND
    }};
}
pub(super) use preset;

/// A preset as its file states it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Preset {
    name: &'static str,
    equation: &'static str,
    summary: &'static str,
    modelled: &'static str,
    #[serde(borrow)]
    state: Vec<&'static str>,
    figure: Figure,
    #[serde(borrow)]
    observed: Vec<&'static str>,
    keys: Vec<Key>,
    problem: Table,
    values: Table,
    quantities: Vec<QuantityText>,
    /// The keys as listings show them.
    #[serde(skip)]
    key_infos: Vec<KeyInfo>,
    #[serde(skip)]
    key_names: Vec<&'static str>,
}

/// A key of a preset.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Key {
    name: &'static str,
    meaning: &'static str,
    /// The length of the list; none for one number.
    numbers: Option<usize>,
    condition: Option<Condition>,
}

/// What the numbers of a key fulfil, besides being finite.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Condition {
    /// x and 1/x are finite, and x > 0.
    Positive,
}

impl Condition {
    fn check(self, key: &str, value: f64) -> Result<(), Refusal> {
        let (good, expected) = match self {
            Condition::Positive => {
                (value > 0.0 && value.recip().is_finite(), "a finite number > 0")
            }
        };
        match good {
            true => Ok(()),
            false => Err(Refusal::at(key, format!("{key} = {value}, expected {expected}"))),
        }
    }
}

/// A quantity of a preset.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct QuantityText {
    name: &'static str,
    #[serde(borrow, default)]
    columns: Vec<&'static str>,
    meaning: &'static str,
    /// One for each column.
    formulas: Texts,
    kept: Option<LawText>,
}

/// The law of a quantity.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct LawText {
    by: Keeper,
    degree: u32,
    terms: Option<String>,
}

/// What keeps a quantity.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Keeper {
    Flow,
    Action,
}

impl Preset {
    /// The preset of an embedded file. A file with a mistake is a defect of the program, which every run shows.
    pub(super) fn parse(text: &'static str) -> Preset {
        let read = toml::de::Deserializer::parse(text).and_then(Preset::deserialize);
        let mut preset = read.unwrap_or_else(|error| panic!("a preset: {error}"));
        let info = |key: &Key| KeyInfo { name: key.name, meaning: key.meaning };
        preset.key_infos = preset.keys.iter().map(info).collect();
        preset.key_names = preset.keys.iter().map(|key| key.name).collect();
        preset
    }

    pub(super) fn kind(
        &'static self,
        quantities: fn() -> Vec<QuantityInfo>,
        read: ReadProblem,
    ) -> Kind {
        let Preset { name, equation, summary, .. } = self;
        Kind { name, equation, summary, keys: &self.key_infos, quantities, read }
    }

    pub(super) fn quantities(&'static self) -> Vec<QuantityInfo> {
        let info = |QuantityText { name, columns, meaning, .. }: &'static QuantityText| {
            QuantityInfo { name, columns, meaning, unit: "" }
        };
        self.quantities.iter().map(info).collect()
    }

    pub(super) fn read(
        &'static self,
        kind: &'static Kind,
        section: ValueDeserializer<'_>,
    ) -> Result<Box<dyn ProblemSpec>, ReadError> {
        let lists = section.deserialize_struct("Keys", &self.key_names, ReadKeys(self))?;
        let mut parameters = Vec::new();
        for (Key { name, numbers, condition, .. }, list) in self.keys.iter().zip(&lists) {
            for (i, &x) in list.iter().enumerate() {
                let (parameter, place) = match numbers {
                    None => ((*name).into(), (*name).into()),
                    Some(_) => (format!("{name}{}", i + 1), name.index(i)),
                };
                if let Some(condition) = condition {
                    condition.check(&place, x)?;
                }
                parameters.push((parameter, Real(x)));
            }
        }
        let parameters: Parameters = parameters.into_iter().collect();
        let base = self.base(&parameters)?;
        let mut variables = Vec::new();
        for quantity in &self.observed {
            variables.extend(base.columns(quantity)?);
        }
        let names = parameters.names("observed", variables)?;
        let formulas = |quantity: &QuantityText| quantity.read(&names);
        let formulas = self.quantities.iter().map(formulas).collect::<Result<_, _>>()?;
        Ok(Box::new(Problem { kind, preset: self, base, formulas }))
    }

    /// The problem of the base.
    fn base(&self, parameters: &Parameters) -> Result<Box<dyn ProblemSpec>, ReadError> {
        let mut problem = self.problem.clone();
        let name = problem.remove("kind");
        let kind = Kind::named(name.as_ref().and_then(Value::as_str).unwrap_or_default())?;
        let names = parameters.names("values", [""; 0])?;
        for (key, value) in &self.values {
            problem.insert(key.clone(), evaluate(key, value, &names)?);
        }
        if kind.keys.contains(&PARAMETERS) {
            let table = parameters.iter().map(|(name, x)| (name.into(), Value::Float(x)));
            problem.insert(PARAMETERS.name.into(), Value::Table(table.collect()));
        }
        let text = Value::Table(problem).to_string();
        // What the base refuses stands in no line of the scene but its section.
        let refusal = |message: &str| Refusal::section(message).into();
        let section = ValueDeserializer::parse(&text).map_err(|error| refusal(error.message()))?;
        (kind.read)(section).map_err(|error| match error {
            ReadError::Toml(error) => refusal(error.message()),
            refused => refused,
        })
    }
}

/// Texts as the values of their formulas.
fn evaluate(key: &str, value: &Value, names: &Names) -> Result<Value, Refusal> {
    match value {
        Value::String(text) => Ok(Value::Float(Formula::read(key, text, names)?.value::<f64>(&[]))),
        Value::Array(list) => {
            let list = list.iter().map(|value| evaluate(key, value, names));
            Ok(Value::Array(list.collect::<Result<_, _>>()?))
        }
        other => Ok(other.clone()),
    }
}

impl QuantityText {
    fn read(&self, names: &Names) -> Result<QuantityFormulas, Refusal> {
        let terms = self.kept.as_ref().and_then(|law| law.terms.as_ref());
        let terms = terms.map(|text| Formula::read(self.name, text, names)).transpose()?;
        let values = self.formulas.read(self.name, self.columns.len().max(1), names)?;
        Ok(QuantityFormulas { values, terms })
    }

    fn law(&self) -> Option<Law> {
        let LawText { by, degree, terms } = self.kept.as_ref()?;
        Some(Law {
            origin: match by {
                Keeper::Flow => Origin::Flow,
                Keeper::Action => Origin::Action,
            },
            degree: *degree,
            scale: if terms.is_some() { Scale::Terms } else { Scale::Value },
        })
    }
}

/// Reads the numbers of each key, in the order of the preset.
struct ReadKeys(&'static Preset);

impl<'de> Visitor<'de> for ReadKeys {
    type Value = Vec<Vec<f64>>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table of keys")
    }
    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let keys = &self.0.keys;
        let mut lists = vec![None; keys.len()];
        while let Some(i) = map.next_key_seed(KeyPlace(&self.0.key_names))? {
            lists[i] = Some(match keys[i].numbers {
                None => vec![map.next_value::<Real>()?.0],
                Some(count) => map.next_value_seed(NumberList(count))?,
            });
        }
        let list =
            |(key, list): (&Key, Option<_>)| list.ok_or_else(|| A::Error::missing_field(key.name));
        keys.iter().zip(lists).map(list).collect()
    }
}

/// The place of a key in the list.
struct KeyPlace(&'static [&'static str]);

impl<'de> DeserializeSeed<'de> for KeyPlace {
    type Value = usize;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<usize, D::Error> {
        deserializer.deserialize_identifier(self)
    }
}

impl Visitor<'_> for KeyPlace {
    type Value = usize;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a key")
    }
    fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<usize, E> {
        let place = self.0.iter().position(|key| *key == name);
        place.ok_or_else(|| E::unknown_field(name, self.0))
    }
}

/// The formulas of a quantity, with the values of the keys.
#[derive(Clone, Debug)]
struct QuantityFormulas {
    values: Vec<Formula>,
    terms: Option<Formula>,
}

/// The problem of a scene.
#[derive(Debug)]
struct Problem {
    kind: &'static Kind,
    preset: &'static Preset,
    base: Box<dyn ProblemSpec>,
    /// Those of each quantity.
    formulas: Vec<QuantityFormulas>,
}

impl ProblemSpec for Problem {
    fn kind(&self) -> &'static Kind {
        self.kind
    }
    fn layers(&self) -> &'static [Layer] {
        self.base.layers()
    }
    fn columns(&self, quantity: &str) -> Result<Vec<String>, Error> {
        Ok(self.kind.quantity(quantity)?.column_names())
    }
    fn formula(&self) -> Option<&Formula> {
        self.base.formula()
    }
    fn model(&self, layer: Layer, quantities: &[&str]) -> Result<Box<dyn Model>, Error> {
        if !self.layers().contains(&layer) {
            return Err(no_such_layer(layer, self.kind));
        }
        let base = self.base.model(layer, &self.preset.observed)?;
        let (mut schema, mut values, mut sizes) = (Schema::default(), Vec::new(), Vec::new());
        for name in quantities {
            let all = self.preset.quantities.iter().zip(&self.formulas);
            let known = all.into_iter().find(|(quantity, _)| quantity.name == *name);
            let (quantity, formulas) = known.ok_or_else(|| self.kind.unknown_quantity(name))?;
            schema.push(quantity.name, self.columns(name)?, quantity.law(), false);
            values.extend_from_slice(&formulas.values);
            sizes.extend(formulas.terms.clone());
        }
        let formulas = [values, sizes].concat();
        let number =
            move |place: usize, _: f64, of_base: Row<'_>| formulas[place].value(of_base.values());
        let modelled = Some(self.preset.modelled);
        Ok(Box::new(Mapped { base, schema, modelled, number: Box::new(number) }))
    }
    fn state(&self, _: &[&str]) -> &'static [&'static str] {
        &self.preset.state
    }
    fn invariants(&self, _: &[&str]) -> Vec<&'static str> {
        let kept = self.preset.quantities.iter().filter(|quantity| quantity.law().is_some());
        kept.map(|quantity| quantity.name).collect()
    }
    fn figure(&self, _: &[&str]) -> Figure {
        self.preset.figure
    }
}
