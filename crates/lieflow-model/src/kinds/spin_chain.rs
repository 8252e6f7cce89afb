//! `kind = "spin-chain"`: the Landau–Lifshitz chain on (S²)ᴺ; see [`SpinChain`], and [`CoupledSpins`] where couplings
//! are formulas of the site and of time, or there is more than exchange and an axis.

use std::sync::Arc;

use lieflow::actions::Linear;
use lieflow::problems::{Bond, Constant, CoupledSpins, Couplings, Site, SpinChain};
use lieflow::scalar::{Counted, Real as Scalar};
use lieflow::solve::Stops;
use lieflow_runs::spaces::OnSpheres;
use nalgebra::Vector3;

use super::on_m::check_unit;
use super::prelude::*;
use crate::formula::{Formula, Names, Text, Texts, without_value};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "spin-chain",
    equation: "ṡᵢ = Hᵢ × sᵢ + α (sᵢ × Hᵢ) × sᵢ, Hᵢ = −∂E/∂sᵢ, α the damping, \
               E = Σ (−sᵢ·J sᵢ₊₁ + D·(sᵢ × sᵢ₊₁) − ½ K (sᵢ)₃² − B·sᵢ)",
    summary: "a chain of spins with exchange, anisotropy, a Dzyaloshinskii–Moriya vector, a field and damping",
    ..Kind::of::<Keys, Chain>(|section| read_with(section, read))
};

keys! { Keys [sample_keys formula_keys] {
    spins: Option<Vec<Reals<3>>> = "initial directions, one row a spin, normalised",
    wave: Option<Wave> = "{count, turns, cone}, instead of spins: count spins at the angle cone to e3, \
                          that turn so often around it along the chain",
    ring: Option<bool> = "are the ends joined? optional, true; two spins are then joined twice",
    exchange: Option<Texts> =
        "J, > 0 for a ferromagnet: a formula of t and of the site i = 1, 2, …, for the bond of i and i + 1; or three, \
         [Jx, Jy, Jz]; optional, 1",
    dm: Option<Texts> =
        "D, the Dzyaloshinskii–Moriya vector of the bond of i and i + 1: three formulas of t and i; optional, 0",
    anisotropy: Option<Texts> =
        "K, > 0 for an easy axis e3: a formula of t and i; or three, of each axis; optional, 0",
    field: Option<Texts> = "B: three numbers, or formulas of t and i; optional, 0",
    damping: Option<Real> = "Gilbert's damping, at least 0; optional, 0",
} }

read_by_keys! {
    struct Wave {
        count: Whole<2>,
        turns: Real,
        cone: Real,
    }
}

/// More spins are not meant.
const SPINS_MAX: u64 = 1 << 16;

/// The chain with its initial spins.
#[derive(Clone, Debug)]
struct Chain {
    of: Of,
    damping: f64,
    start: Box<[Vector3<f64>]>,
    /// A formula of the samples.
    samples: Option<Formula>,
}

/// What couples the spins.
#[derive(Clone, Debug)]
enum Of {
    /// One exchange of all, an axis and a field: numbers.
    Numbers(SpinChain, Vector3<f64>),
    Formulas(Arc<Stated>),
}

/// Couplings as formulas of t and i.
#[derive(Debug)]
struct Stated {
    /// J, D, K and B.
    formulas: [[Formula; 3]; 4],
    /// Their values; 0 of those that depend on time.
    constant: Couplings,
}

type Q = Quantity<Chain>;

/// The key of the initial spins, and the spins.
fn spins_of(
    spins: Key<Option<Vec<Reals<3>>>>,
    wave: Key<Option<Wave>>,
) -> Result<(&'static str, Vec<Vector3<f64>>), ReadError> {
    match exactly_one(("spins", spins?), ("wave", wave?))? {
        Either::First(spins) => {
            Ok(("spins", spins.into_iter().map(|s| Vector3::from(s.0)).collect()))
        }
        Either::Second(Wave { count, turns, cone }) => {
            if count.0 > SPINS_MAX {
                let message = format!("count = {}, expected at most {SPINS_MAX}", count.0);
                return Err(Refusal::at("wave", message).into());
            }
            let (s, c) = cone.0.sin_cos();
            let step = core::f64::consts::TAU * turns.0 / count.0 as f64;
            let spin = |i: u64| {
                let phase = step * i as f64;
                Vector3::new(s * phase.cos(), s * phase.sin(), c)
            };
            Ok(("wave", (0..count.0).map(spin).collect()))
        }
    }
}

fn read(mut keys: Keys) -> Result<Forms, ReadError> {
    let (formulas, samples) = (keys.formula_keys(), keys.sample_keys());
    let spins = spins_of(keys.spins, keys.wave).and_then(|(key, spins)| {
        let refused = |error: Error| Refusal::from(error).about(key);
        let chain = SpinChain::new(spins.len()).map_err(refused)?;
        let start = chain.spins(|i| spins[i]).map_err(refused)?;
        Ok((chain, start))
    });
    let names = formulas.names("field", VARIABLES, samples);
    let of = |key: &str, stated: Key<Option<Texts>>, alone| {
        read_three(key, stated?.as_ref(), alone, seen(&names))
    };
    let exchange = of("exchange", keys.exchange, Alone::All(1.0));
    let dm = of("dm", keys.dm, Alone::Refused);
    let anisotropy = of("anisotropy", keys.anisotropy, Alone::Third);
    let field = of("field", keys.field, Alone::Refused);
    let names = names.and_then(Names::checked);
    let (ring, damping) = (
        keys.ring,
        keys.damping.and_then(|damping| {
            let damping = damping.unwrap_or(Real(0.0));
            damping.checked("damping", "a finite number ≥ 0", |x| x >= 0.0)
        }),
    );
    let ((chain, start), names, exchange, dm, anisotropy, field, ring, damping) =
        all!(spins, names, exchange, dm, anisotropy, field, ring, damping)?;
    let chain = chain.with_damping(damping)?;
    let ring = ring != Some(false);
    let stated = Stated::new([exchange, dm, anisotropy, field], start.len(), ring);
    let of = match stated.numbers() {
        Some([anisotropy, x, y, z]) => {
            let chain = if ring { chain } else { chain.open() };
            let chain = chain.with_anisotropy(anisotropy)?.with_field([x, y, z])?;
            Of::Numbers(chain, Vector3::new(x, y, z))
        }
        None => Of::Formulas(stated.into()),
    };
    Ok(Forms::of(Chain { of, damping, start, samples: Formula::of_samples(&names) }))
}

/// The variables of formulas.
const VARIABLES: [&str; 2] = ["t", "i"];
/// Their places.
const TIME: usize = 0;
const SITE: usize = 1;

/// What a single formula means, of a key that has three.
#[derive(Clone, Copy)]
enum Alone {
    /// All three; left out, this number.
    All(f64),
    /// The third.
    Third,
    /// Nothing.
    Refused,
}

/// The three formulas of a key.
fn read_three(
    key: &str,
    stated: Option<&Texts>,
    alone: Alone,
    names: Result<&Names, ReadError>,
) -> Result<[Formula; 3], ReadError> {
    let (names, stated) = match (names, stated) {
        (Ok(names), stated) => (names, stated),
        (names, Some(texts @ Texts::List(_))) => {
            return Err(texts.read_by(key, Some(3), names).err().unwrap_or_default());
        }
        (Err(error), _) => return Err(error),
    };
    let number = |x: f64| Formula::read(key, &format!("{x:?}"), names);
    let all = |formula: Formula| [formula.clone(), formula.clone(), formula];
    // A formula whose value is a vector is three, too.
    if let Some(texts @ Texts::One(_)) = stated
        && let Ok(three) = texts.read(key, 3, names)
        && let Ok(three) = three.try_into()
    {
        return Ok(three);
    }
    match (stated, alone) {
        (None, Alone::All(x)) => number(x).map(all),
        (None, _) => number(0.0).map(all),
        (Some(Texts::One(Text(text))), Alone::All(_)) => Formula::read(key, text, names).map(all),
        (Some(Texts::One(Text(text))), Alone::Third) => {
            let zero = number(0.0)?;
            Ok([zero.clone(), zero, Formula::read(key, text, names)?])
        }
        (Some(texts), _) => {
            let three: Result<[Formula; 3], _> = texts.read(key, 3, names)?.try_into();
            three.map_err(|_| Refusal::at(key, "expected three formulas").into())
        }
    }
}

/// No coupling.
fn zero<N: Scalar>() -> Vector3<N> {
    Vector3::repeat(N::lit(0.0))
}

impl Stated {
    fn new(formulas: [[Formula; 3]; 4], spins: usize, ring: bool) -> Self {
        let last = spins - 1;
        let bond = |i: usize| Bond {
            sites: [i, if i == last { 0 } else { i + 1 }],
            exchange: zero(),
            dm: zero(),
        };
        let bonds = (0..if ring { spins } else { last }).map(bond).collect();
        let sites = vec![Site { anisotropy: zero(), field: zero() }; spins].into();
        let mut stated = Stated { formulas, constant: Couplings { bonds, sites } };
        let mut constant = stated.constant.clone();
        stated.write(0.0, false, &mut constant);
        stated.constant = constant;
        stated
    }
    fn each(&self) -> impl Iterator<Item = &Formula> {
        self.formulas.iter().flat_map(|three| three.iter())
    }
    /// Does a formula depend on this variable?
    fn uses(&self, variable: usize) -> bool {
        self.each().any(|formula| formula.uses(variable))
    }
    fn in_time(&self) -> bool {
        self.uses(TIME)
    }
    /// K along e3 and B, where they are finite numbers and there is nothing else but an exchange of 1.
    fn numbers(&self) -> Option<[f64; 4]> {
        if self.in_time() || self.uses(SITE) {
            return None;
        }
        let number = |formula: &Formula| formula.value(&[0.0; 2]);
        let [j, d, k, b] = self.formulas.each_ref().map(|three| three.each_ref().map(number));
        let plain = j == [1.0; 3] && d == [0.0; 3] && k[..2] == [0.0; 2];
        let numbers = [k[2], b[0], b[1], b[2]];
        (plain && numbers.iter().all(|x| x.is_finite())).then_some(numbers)
    }
    /// The bonds and the sites at t, those that depend on time alone where that is said.
    fn write<N: Scalar + Into<f64>>(&self, t: N, moving: bool, couplings: &mut Couplings<N>) {
        let write = |which: usize, i: usize, x: &mut Vector3<N>| {
            for (x, formula) in x.iter_mut().zip(&self.formulas[which]) {
                if formula.uses(TIME) == moving {
                    *x = formula.value(&[t, N::lit((i + 1) as f64)]);
                }
            }
        };
        for bond in &mut couplings.bonds {
            write(0, bond.sites[0], &mut bond.exchange);
            write(1, bond.sites[0], &mut bond.dm);
        }
        for (i, site) in couplings.sites.iter_mut().enumerate() {
            write(2, i, &mut site.anisotropy);
            write(3, i, &mut site.field);
        }
    }
    /// The couplings that do not depend on time, on other numbers.
    fn constant<N: Scalar>(&self) -> Couplings<N> {
        let Couplings { bonds, sites } = &self.constant;
        let on = |x: &Vector3<f64>| x.map(N::lit);
        let bond = |b: &Bond| Bond { sites: b.sites, exchange: on(&b.exchange), dm: on(&b.dm) };
        let site = |s: &Site| Site { anisotropy: on(&s.anisotropy), field: on(&s.field) };
        Couplings {
            bonds: bonds.iter().map(bond).collect(),
            sites: sites.iter().map(site).collect(),
        }
    }
    /// Does a turn of all spins about e3 change nothing?
    fn turns_about_e3(&self) -> bool {
        let [j, d, k, b] = &self.formulas;
        let at = |formula: &Formula, i: usize| formula.value(&[0.0, i as f64]);
        let all = |holds: &dyn Fn(usize) -> bool| (1..=self.constant.sites.len()).all(holds);
        let zero = |formula: &Formula| !formula.uses(TIME) && all(&|i| at(formula, i) == 0.0);
        let equal = |a: &Formula, b: &Formula| {
            a.is(b) || ![a, b].iter().any(|x| x.uses(TIME)) && all(&|i| at(a, i) == at(b, i))
        };
        let lie = [&d[0], &d[1], &b[0], &b[1]];
        equal(&j[0], &j[1]) && equal(&k[0], &k[1]) && lie.into_iter().all(zero)
    }
}

impl Chain {
    fn in_time(&self) -> bool {
        matches!(&self.of, Of::Formulas(stated) if stated.in_time())
    }
    /// A Lie–Poisson system where nothing damps it.
    fn on<S: Scalar + Into<f64> + 'static>(&self) -> Result<OnSpheres<S>, Error> {
        let damped = self.damping != 0.0;
        let stated = match &self.of {
            Of::Numbers(chain, _) if damped => return Ok(OnSpheres::new(chain.on::<S>()?, Linear)),
            Of::Numbers(chain, _) => return Ok(OnSpheres::lie_poisson(chain.on::<S>()?, Linear)),
            Of::Formulas(stated) => stated.clone(),
        };
        let (couplings, damping) = (stated.constant(), S::lit(self.damping));
        if stated.in_time() {
            let at = move |t: S, to: &mut Couplings<S>| stated.write(t, true, to);
            return Ok(OnSpheres::new(CoupledSpins::new(couplings, damping, at)?, Linear));
        }
        let spins = CoupledSpins::new(couplings, damping, Constant)?;
        Ok(match damped {
            true => OnSpheres::new(spins, Linear),
            false => OnSpheres::lie_poisson(spins, Linear),
        })
    }
    /// True if a turn of all spins about e₃ changes nothing.
    fn turns_about_e3(&self) -> bool {
        match &self.of {
            Of::Numbers(_, field) => field.x == 0.0 && field.y == 0.0,
            Of::Formulas(stated) => stated.turns_about_e3(),
        }
    }
    fn energy(&self, s: &[Vector3<f64>]) -> f64 {
        match &self.of {
            Of::Numbers(chain, _) => chain.energy(s),
            Of::Formulas(stated) => stated.constant.energy(s),
        }
    }
    /// The size of the terms of sums over the chain: each spin has an energy of some units.
    fn size(&self, s: &[Vector3<f64>]) -> f64 {
        match &self.of {
            Of::Numbers(_, field) => sum_of_squares(s) * (1.0 + length(field)),
            Of::Formulas(stated) => {
                let Couplings { bonds, sites } = &stated.constant;
                let bonds = bonds.iter().map(|bond| length(&bond.exchange) + length(&bond.dm));
                let sites = sites.iter().map(|site| length(&site.anisotropy) + length(&site.field));
                sum_of_squares(s).max(bonds.chain(sites).sum())
            }
        }
    }
}

fn sum(spins: &[Vector3<f64>]) -> Vector3<f64> {
    spins.iter().sum()
}
fn sum_of_squares(spins: &[Vector3<f64>]) -> f64 {
    spins.iter().map(Vector3::norm_squared).sum()
}

impl System for Chain {
    type Problem = OnSpheres;

    const STATE: &'static [&'static str] = &["spins"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "spins",
            &["s1x", "s1y", "s1z", "…", "sNz"],
            "the spins, one after the other",
            |_, _, s, row| row.extend(s.iter().flat_map(|s| s.iter())),
        )
        .with_columns(|chain| {
            let spin = |i: usize| ["x", "y", "z"].map(|axis| format!("s{i}{axis}"));
            (1..=chain.start.len()).flat_map(spin).collect()
        }),
        Q::numbers("magnetisation", &["mx", "my", "mz"], "mean of the spins", |_, _, s, row| {
            row.extend((sum(s) / s.len() as f64).iter());
        }),
        Q::number("energy", "energy, where no coupling depends on t", |chain, _, s| {
            chain.energy(s)
        })
        .kept_where(|chain| (chain.damping == 0.0).then_some(Law::by_the_flow(2)))
        .in_terms(|chain, s| chain.size(s))
        .missing_where(|chain| chain.in_time().then_some("its couplings depend on t")),
        Q::number("total_spin3", "sum of the third components", |_, _, s| sum(s)[2])
            .kept_where(|chain| {
                let is_kept = chain.damping == 0.0 && chain.turns_about_e3();
                is_kept.then_some(Law::by_the_flow(1))
            })
            .in_terms(|chain, s| chain.size(s)),
        Q::number("lengths2", "sum of the squares of the lengths", |_, _, s| sum_of_squares(s))
            .kept(Law::by_the_action(2)),
    ];

    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<Start<OnSpheres>, Error> {
        Ok((self.on()?, self.start.clone()))
    }
    fn counted(&self) -> Option<Counting> {
        let start = self.start.iter().map(|s| s.map(Counted)).collect();
        counting(self.on().ok()?, start)
    }
    fn check_start(&self, t0: f64) -> Vec<Refusal> {
        let Of::Formulas(stated) = &self.of else { return Vec::new() };
        let wrong = (1..=self.start.len()).map(|i| without_value(stated.each(), &[t0, i as f64]));
        wrong.into_iter().find(|wrong| !wrong.is_empty()).unwrap_or_default()
    }
    fn formula(&self) -> Option<&Formula> {
        match &self.of {
            Of::Numbers(..) => self.samples.as_ref(),
            Of::Formulas(stated) => stated.each().next(),
        }
    }
    /// Those of samples that a coupling may depend on.
    fn knots(&self, t_span: [f64; 2]) -> Option<Stops> {
        let Of::Formulas(stated) = &self.of else { return None };
        Some(Stops::at_knots(stated.each().next()?.samples()?, t_span))
    }
    fn check_state(&self, arg: &str, spins: &Box<[Vector3<f64>]>) -> Result<(), Error> {
        let mut spins = spins.iter().enumerate();
        spins.try_for_each(|(i, spin)| check_unit(&format!("spin {}", i + 1), arg, spin.norm()))
    }
    fn modelled(&self) -> String {
        format!("{} spins on spheres", self.start.len())
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("spins")
    }
}
