//! A preset: a kind that is another kind, its base, with formulas; a TOML file in `presets/`.
//!
//! | in the file | |
//! |---|---|
//! | `name`, `equation`, `summary` | what listings say |
//! | `modelled`, `state` | what is integrated, in words; the quantities that make up the state |
//! | `figure`, `drawn` | `"lines"`, `"sphere"`, `"curve"` or `"points"`; the quantity that is drawn |
//! | `[[keys]]` | the keys: `name`, `meaning`, how many `numbers` where it is a list, `positive` for numbers > 0 |
//! | `[problem]` | the problem of the base; its formulas may name the keys |
//! | `[values]` | further keys of that problem: texts are formulas in the keys, and the base gets their values |
//! | `observed` | quantities of the base: their columns are the variables of the formulas of quantities |
//! | `[[quantities]]` | `name`, `columns`, `meaning`, `formulas`; `kept` is its law, by the `flow` or by the `action`: its degree, and the size of its `terms` |
//!
//! A key `x` that is a list of numbers is `x1`, `x2`, ... in formulas.

use std::sync::Arc;

use lieflow::RunError;
use lieflow::catalog::MethodSpec;
use lieflow::problems::Origin;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::prelude::{Error, KeyPath, Law, Read, ReadError, Real, Scale, Whole, read_by_keys};
use crate::formula::{Formula, Names, Parameters, Text, Texts};
use crate::problem::{
    Asked, CountOnVectors, Figure, Fit, Form, Forms, Kept, KeyInfo, Kind, Model, Orders, Outcome,
    PARAMETERS, Plan, Problem, QuantityInfo, ReadForms, RowCurve, Run, StepByStep, Stepper, Steps,
    Watcher, high_order,
};
use crate::reader::values::counted;
use crate::reader::{KeyReader, Mistake};
use crate::reader::{Refusal, Shape, Value};
use crate::schema::{Row, Schema};

/// The entry of a preset in the list of kinds, by the name of its file.
macro_rules! preset {
    ($name:literal) => {{
        use std::sync::LazyLock;
        use $crate::kinds::preset::Preset;
        use $crate::problem::Kind;
        static PRESET: LazyLock<Preset> = LazyLock::new(|| {
            Preset::parse(include_str!(concat!("../../presets/", $name, ".toml")))
        });
        static KIND: LazyLock<Kind> =
            LazyLock::new(|| PRESET.kind(|| PRESET.quantities(), |section| PRESET.read(section)));
        *KIND
    }};
}
pub(super) use preset;

/// A preset.
#[derive(Debug)]
pub(super) struct Preset {
    stated: Stated,
    /// The sections `problem` and `values`.
    problem: DeTable<'static>,
    values: DeTable<'static>,
    /// The keys as listings show them.
    key_infos: Vec<KeyInfo>,
    key_names: Vec<&'static str>,
}

read_by_keys! {
    /// What the file of a preset states.
    #[derive(Debug)]
    struct Stated {
        name: &'static str,
        equation: &'static str,
        summary: &'static str,
        modelled: &'static str,
        state: Vec<&'static str>,
        figure: Drawing,
        drawn: &'static str,
        observed: Vec<&'static str>,
        keys: Vec<KeyText>,
        quantities: Vec<QuantityText>,
    }
}

read_by_keys! {
    /// A key of a preset.
    #[derive(Debug)]
    struct KeyText {
        name: &'static str,
        meaning: &'static str,
        /// The length of the list; none for one number.
        numbers: Option<Whole<1>>,
        /// True if each number has to be > 0 with a finite reciprocal.
        positive: Option<bool>,
    }
}

read_by_keys! {
    /// A quantity of a preset.
    #[derive(Debug)]
    struct QuantityText {
        name: &'static str,
        columns: Option<Vec<&'static str>>,
        meaning: &'static str,
        /// One for each column.
        formulas: Texts,
        kept: Option<LawText>,
    }
}

read_by_keys! {
    /// The law of a quantity.
    #[derive(Debug)]
    struct LawText {
        /// The degree of a law by the flow, or of one by the action.
        flow: Option<Whole<0>>,
        action: Option<Whole<0>>,
        terms: Option<String>,
    }
}

/// A text of a preset. It is kept until the program ends, like the preset.
impl Read for &'static str {
    const SHAPE: Shape = Shape::Text;

    fn read(value: &Value<'_>) -> Result<Self, ReadError> {
        String::read(value).map(|text| &*text.leak())
    }
}

/// The figure of a quantity.
#[derive(Clone, Copy, Debug)]
struct Drawing(fn(&'static str) -> Figure);

impl Read for Drawing {
    const SHAPE: Shape = Shape::Text;

    fn read(value: &Value<'_>) -> Result<Self, ReadError> {
        let figures = [
            ("lines", Drawing(Figure::Lines)),
            ("sphere", Drawing(Figure::Sphere)),
            ("curve", Drawing(Figure::Curve)),
            ("points", Drawing(Figure::Points)),
        ];
        let figure = figures.iter().find(|(name, _)| value.get_ref().as_str() == Some(name));
        let names = || figures.map(|(name, _)| name).join(", ");
        figure.map(|(_, figure)| *figure).ok_or_else(|| ReadError::expected(value, names()))
    }
}

impl Preset {
    /// The preset of an embedded file. A file with a mistake is a defect of the program, which every run shows.
    pub(super) fn parse(text: &'static str) -> Preset {
        let mut root = DeTable::parse(text).unwrap_or_else(|error| panic!("a preset: {error}"));
        let mut section = |name| match root.get_mut().remove(name).map(Spanned::into_inner) {
            Some(DeValue::Table(section)) => section,
            _ => panic!("a preset without the section [{name}]"),
        };
        let (problem, values) = (section("problem"), section("values"));
        let root = Spanned::new(root.span(), DeValue::Table(root.into_inner()));
        let stated = Stated::read(&root).unwrap_or_else(|error| panic!("a preset: {error:?}"));
        let info = |key: &KeyText| KeyInfo {
            name: key.name,
            meaning: key.meaning,
            shape: key.numbers.map_or(Shape::Number, |n| Shape::Numbers(n.0 as usize)),
            optional: false,
        };
        let key_infos: Vec<KeyInfo> = stated.keys.iter().map(info).chain([PARAMETERS]).collect();
        let key_names = key_infos.iter().map(|key| key.name).collect();
        Preset { stated, problem, values, key_infos, key_names }
    }

    pub(super) fn kind(
        &'static self,
        quantities: fn() -> Vec<QuantityInfo>,
        read: ReadForms,
    ) -> Kind {
        let Stated { name, equation, summary, .. } = self.stated;
        Kind { name, equation, summary, keys: &self.key_infos, instead: &[], quantities, read }
    }

    pub(super) fn quantities(&'static self) -> Vec<QuantityInfo> {
        self.stated.quantities.iter().map(QuantityText::info).collect()
    }

    pub(super) fn read(&'static self, section: &Value<'_>) -> Result<Forms, ReadError> {
        let parameters: Parameters = self.parameters(section)?.into_iter().collect();
        let base = self.base(&parameters)?;
        let mut variables = Vec::new();
        for quantity in &self.stated.observed {
            variables.extend(base.columns(quantity)?);
        }
        let names = parameters.names("observed", variables)?;
        let formulas = |quantity: &QuantityText| quantity.read(&names);
        let formulas = self.stated.quantities.iter().map(formulas).collect::<Result<_, _>>()?;
        let layer = base.layers()[0];
        let (preset, formula) = (&self.stated, base.formula().cloned());
        let base = base.model(layer, &preset.observed)?;
        let run = Arc::new(OnBase { preset, base, formulas, formula: formula.clone() });
        let (state, figure) = (&*preset.state, (preset.figure.0)(preset.drawn));
        let form = Form { layer, whole_state: false, state, figure, run };
        Ok(Forms { formula, ..Forms::one(form) })
    }

    /// The numbers of the keys.
    fn parameters(&'static self, section: &Value<'_>) -> Result<Vec<(String, Real)>, ReadError> {
        let (mut parameters, mut mistakes) = (Vec::new(), ReadError::default());
        let Some(mut section) = KeyReader::of(section, &self.key_names, &mut mistakes) else {
            return mistakes.or(None);
        };
        for KeyText { name, numbers, positive, .. } in &self.stated.keys {
            let list = section.read_by(name, |value, mistakes| {
                mistakes.keep(match numbers {
                    None => Real::read(value).map(|x| vec![x]),
                    Some(count) => counted(value, count.0 as usize, "numbers"),
                })
            });
            for (i, Real(x)) in list.into_iter().flatten().enumerate() {
                let (parameter, place) = match numbers {
                    None => ((*name).into(), (*name).into()),
                    Some(_) => (format!("{name}{}", i + 1), name.index(i)),
                };
                if *positive == Some(true) && !(x > 0.0 && x.recip().is_finite()) {
                    let message = format!("{place} = {x}, expected a finite number > 0");
                    section.refuse(Refusal::at(place, message));
                    break;
                }
                parameters.push((parameter, Real(x)));
            }
        }
        // The numbers know them already.
        let _: Option<Parameters> = section.read(PARAMETERS.name);
        mistakes.or(Some(parameters))
    }

    /// The problem of the base.
    fn base(&self, parameters: &Parameters) -> Result<Problem, ReadError> {
        let mut problem = self.problem.clone();
        let name = problem.remove("kind");
        let name = name.as_ref().and_then(|name| name.get_ref().as_str());
        let kind = super::named(name.unwrap_or_default())?;
        let names = parameters.names("values", [""; 0])?;
        let mut text = String::new();
        for (key, value) in &self.values {
            let key = key.get_ref();
            text += &format!("{key} = {}\n", evaluate(key, value, &names)?);
        }
        text += &format!("[{}]\n", PARAMETERS.name);
        text.extend(parameters.iter().map(|(name, x)| format!("{name} = {}\n", as_toml(x))));
        // What the base refuses stands in no line of the scene but its section.
        let values = DeTable::parse(&text).map_err(|error| Refusal::section(error.message()))?;
        problem.extend(values.into_inner());
        let in_words = |mistake| match mistake {
            Mistake::Refused(refusal) => refusal,
            wrong => Refusal::section(wrong.in_words("problem").0),
        };
        kind.read_problem(&Spanned::new(0..0, DeValue::Table(problem)))
            .map_err(|error| error.mistakes.into_iter().map(in_words).collect::<Vec<_>>().into())
    }
}

/// The values of formulas, as text of TOML.
fn evaluate(key: &str, value: &Value<'_>, names: &Names) -> Result<String, ReadError> {
    if let DeValue::Array(list) = value.get_ref() {
        let list = list.iter().map(|value| evaluate(key, value, names));
        return Ok(format!("[{}]", list.collect::<Result<Vec<_>, _>>()?.join(", ")));
    }
    let Text(text) = Text::read(value)?;
    Ok(as_toml(Formula::read(key, &text, names)?.value(&[])))
}

/// A number as TOML writes it.
fn as_toml(x: f64) -> String {
    format!("{x:?}").to_lowercase()
}

impl QuantityText {
    fn info(&'static self) -> QuantityInfo {
        let QuantityText { name, meaning, .. } = self;
        let kept = if self.kept.is_some() { Kept::Always } else { Kept::Never };
        let columns = self.columns();
        QuantityInfo { name, columns, meaning, dimension: None, drawn_as: "", kept }
    }

    fn columns(&self) -> &[&'static str] {
        self.columns.as_deref().unwrap_or_default()
    }

    fn read(&self, names: &Names) -> Result<QuantityFormulas, ReadError> {
        let terms = self.kept.as_ref().and_then(|law| law.terms.as_ref());
        let terms = terms.map(|text| Formula::read(self.name, text, names)).transpose()?;
        let values = self.formulas.read(self.name, self.columns().len().max(1), names)?;
        Ok(QuantityFormulas { values, terms })
    }

    fn law(&self) -> Option<Law> {
        let LawText { flow, action, terms } = self.kept.as_ref()?;
        let (origin, degree) = match (flow, action) {
            (Some(degree), _) => (Origin::Flow, degree.0),
            (_, degree) => (Origin::Action, degree.as_ref()?.0),
        };
        Some(Law {
            origin,
            degree: degree as u32,
            scale: if terms.is_some() { Scale::Terms } else { Scale::Value },
        })
    }
}

/// The formulas of a quantity, with the values of the keys.
#[derive(Clone, Debug)]
struct QuantityFormulas {
    values: Vec<Formula>,
    terms: Option<Formula>,
}

/// The quantities of a preset on its base.
#[derive(Debug)]
struct OnBase {
    preset: &'static Stated,
    base: Model,
    /// Those of each quantity.
    formulas: Vec<QuantityFormulas>,
    formula: Option<Formula>,
}

impl OnBase {
    /// The base with the rows of these quantities.
    fn mapped(&self, asked: Asked<'_>) -> Model {
        let quantities = || asked.quantities.iter().map(|&number| &self.formulas[number]);
        let values = quantities().flat_map(|quantity| &quantity.values);
        let formulas: Vec<Formula> =
            values.chain(quantities().filter_map(|q| q.terms.as_ref())).cloned().collect();
        let number =
            move |place: usize, _: f64, of_base: Row<'_>| formulas[place].value(of_base.values());
        self.base.clone().mapped(asked.schema.clone(), Arc::new(number))
    }
}

impl Run for OnBase {
    fn missing(&self, _: usize) -> Option<&'static str> {
        None
    }
    fn columns(&self, quantity: usize) -> Vec<String> {
        self.preset.quantities[quantity].info().column_names()
    }
    fn law(&self, quantity: usize) -> Option<Law> {
        self.preset.quantities[quantity].law()
    }
    fn describe(&self, quantity: usize, schema: &mut Schema) {
        let name = self.preset.quantities[quantity].name;
        schema.push(name, self.columns(quantity), self.law(quantity), false);
    }
    fn modelled(&self) -> String {
        self.preset.modelled.into()
    }
    fn start(&self) -> Result<Vec<f64>, Error> {
        self.base.start(&high_order())
    }
    fn drive(
        &self,
        asked: Asked<'_>,
        method: &MethodSpec,
        plan: Plan<'_>,
        watcher: &mut dyn Watcher,
    ) -> Result<Outcome, RunError> {
        self.mapped(asked).drive(method, plan, watcher)
    }
    fn exact(&self, asked: Asked<'_>, t_span: [f64; 2]) -> Option<Result<Vec<f64>, Error>> {
        self.mapped(asked).exact(t_span)
    }
    fn curve(
        &self,
        asked: Asked<'_>,
        method: &MethodSpec,
        numbers: &[f64],
    ) -> Result<Box<dyn RowCurve>, Error> {
        self.mapped(asked).curve(method, numbers)
    }
    fn stepper(
        &self,
        asked: Asked<'_>,
        method: &MethodSpec,
        steps: StepByStep<'_>,
    ) -> Result<Box<dyn Stepper>, RunError> {
        self.mapped(asked).stepper(method, steps)
    }
    fn orders(&self, method: &MethodSpec) -> Result<Orders, Error> {
        self.base.orders(method)
    }
    fn problem_type(&self) -> &'static str {
        self.base.problem_type(&high_order())
    }
    fn fits(&self, method: &MethodSpec) -> Result<Fit, Error> {
        self.base.fits(method)
    }
    fn operations(
        &self,
        method: &MethodSpec,
        steps: &Steps,
        on_vectors: CountOnVectors,
    ) -> Option<f64> {
        self.base.operations(method, steps, on_vectors)
    }
    fn knots(&self, t_span: [f64; 2]) -> Option<Vec<f64>> {
        let samples = self.formula.as_ref()?.samples()?;
        Some(samples.knots(t_span).collect())
    }
}
