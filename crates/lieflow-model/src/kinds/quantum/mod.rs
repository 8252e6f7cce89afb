//! Quantum systems with n levels: the Hamiltonian H(t) as scenes state it, for a state (`pure`) and for a density
//! matrix (`mixed`).
//!
//! | keys | ħ⁻¹H(t) |
//! |---|---|
//! | `hamiltonian`, `hamiltonian_imaginary` | formulas of t: all entries, or those on and above the diagonal |
//! | `energies`, `coupling`, … | H₀ + a(t)H₁, a(t) = cos(ωt + φ), times exp(−((t − t₁)/w)²) where there is a pulse |

mod mixed;
mod pure;

use std::sync::Arc;

use lieflow::dense::largest_entry;
use lieflow::problems::amplitudes;
use lieflow::scalar::{Ops, tally};
use lieflow::solve::Stops;

pub(super) use self::mixed::KIND as DENSITY_MATRIX;
pub(super) use self::pure::KIND as SCHRODINGER;
use super::entries::{ROUNDING, above_diagonal, check_antisymmetric, square, symmetric};
use super::prelude::*;
use crate::formula::{Formula, Instead, Names, Text, without_value};
use crate::problem::{FormulaKeys, SampleKeys, group};

group! {
    /// The keys of H(t).
    HamiltonianKeys in (crate::kinds::quantum) = hamiltonian_keys $,
    before {
        hamiltonian: Option<Vec<Vec<crate::formula::Text>>> =
            "real part of H as formulas of t: n rows of n, symmetric; or n rows of n, n-1, …, 1, on and above the \
             diagonal",
        hamiltonian_imaginary: Option<Vec<Vec<crate::formula::Text>>> =
            "its imaginary part, antisymmetric, in either form, with 0 on the diagonal; optional, 0",
        energies: Option<List> = "instead of hamiltonian: energies of the levels without a drive",
        coupling: Option<Table> = "with energies: real part of the drive's matrix, symmetric",
        coupling_imaginary: Option<Table> = "its imaginary part, antisymmetric; optional, 0",
        frequency: Option<Real> = "angular frequency of the drive; optional, 0",
        phase: Option<Real> = "its phase at t = 0; optional, 0",
        pulse: Option<Reals<2>> =
            "[centre, width] of a Gaussian envelope; optional, a drive of constant strength",
        hbar: Option<Real> =
            "Planck's constant over 2π, in the units of the scene; optional, 1. With energies as frequencies E/h in \
             GHz and t in ns it is 1/(2π) = 0.15915494309189535",
    }
    after {}
}

/// What to use for energies and couplings that change with time.
const INSTEAD: Instead = {
    let entries = "an H that changes with time has its entries as formulas of t, those on and above the diagonal: \
                   hamiltonian = [[\"-v*t/2\", \"w\"], [\"v*t/2\"]]";
    &[("energies", entries), ("coupling", entries), ("coupling_imaginary", entries)]
};

/// H(t)/ħ.
#[derive(Clone, Debug)]
struct Hamiltonian {
    n: usize,
    of: Of,
    hbar: Option<f64>,
}

#[derive(Clone, Debug)]
enum Of {
    Formulas(Arc<Stated>),
    Drive(Drive),
}

/// The entries of H by their formulas.
#[derive(Debug)]
struct Stated {
    /// The real and the imaginary parts on and above the diagonal, row by row.
    upper: Vec<[Option<Formula>; 2]>,
    /// The parts below the diagonal, where they are stated: the part, the row, the column.
    lower: Vec<((usize, usize, usize), Formula)>,
}

/// Levels under a drive.
#[derive(Clone, Debug)]
struct Drive {
    energies: Vec<f64>,
    /// Real and imaginary parts.
    coupling: [Mat<f64>; 2],
    frequency: f64,
    phase: f64,
    pulse: Option<[f64; 2]>,
}

/// A width that is a smaller part of the span is one of a short pulse. Methods of order 5 have passed over pulses of a
/// twenty-fifth.
const SHORT: f64 = 0.1;
/// Where steps end within a short pulse, in widths from its centre. Beyond, the pulse is rounding.
const PULSE: [f64; 7] = [-6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0];

/// The keys of the two parts.
const PARTS: [&str; 2] = ["hamiltonian", "hamiltonian_imaginary"];

impl Hamiltonian {
    /// The number of levels, and H.
    fn read(
        keys: HamiltonianKeys,
        formulas: &FormulaKeys,
        samples: SampleKeys,
    ) -> (Key<usize>, Key<Self>) {
        let by_formulas = [given(&keys.hamiltonian), given(&keys.hamiltonian_imaginary)];
        let by_formulas = PARTS.into_iter().zip(by_formulas).find(|(_, given)| *given);
        let by_drive = [
            ("energies", given(&keys.energies)),
            ("coupling", given(&keys.coupling)),
            ("coupling_imaginary", given(&keys.coupling_imaginary)),
            ("frequency", given(&keys.frequency)),
            ("phase", given(&keys.phase)),
            ("pulse", given(&keys.pulse)),
        ];
        if let (Some(first), Some(second)) =
            (by_formulas, by_drive.into_iter().find(|(_, given)| *given))
            && let Err(both) = at_most_one([first, second])
        {
            return (Err(ReadError::known()), Err(both.into()));
        }
        let hbar = keys.hbar.clone().and_then(|hbar| match hbar.map(|x| x.0) {
            Some(hbar) if hbar <= 0.0 || !hbar.recip().is_finite() => {
                Err(Refusal::at("hbar", format!("found {hbar}, expected a number > 0")).into())
            }
            hbar => Ok(hbar),
        });
        let (n, of) = match by_formulas {
            Some(_) => {
                let names = formulas.names(PARTS[0], ["t"], samples);
                let (real, imaginary) = (keys.hamiltonian, keys.hamiltonian_imaginary);
                let parts = all!(real, imaginary).map(|(re, im)| [re, im]);
                let n = seen(&parts).and_then(levels);
                let stated = parts.and_then(|parts| Stated::read(parts, *seen(&n)?, seen(&names)));
                let (size, names) = (n.clone(), names.and_then(Names::checked));
                let stated = all!(size, names, stated);
                let n = n.map_err(|_| ReadError::known());
                (n, stated.map(|(_, _, stated)| Of::Formulas(stated.into())))
            }
            None => {
                let unused = [
                    ("samples", given(&samples.samples)),
                    ("interpolation", given(&samples.interpolation)),
                ];
                let unused = unused.into_iter().find(|(_, given)| *given).map(|(key, _)| {
                    let message =
                        format!("`{key}` is for the formulas of `hamiltonian`: this one has none");
                    ReadError::from(Refusal::at(key, message))
                });
                // The named formulas are those of events alone.
                let names = formulas.names(PARTS[0], ["t"], SampleKeys::none());
                let (names, used) = (names.and_then(Names::checked), unused.map_or(Ok(()), Err));
                let (n, drive) = Drive::read(keys);
                let of = all!(names, used, drive).map(|(_, _, drive)| Of::Drive(drive));
                (n, of)
            }
        };
        let size = n.clone();
        let all = all!(size, of, hbar);
        (n, all.map(|(n, of, hbar)| Hamiltonian { n, of, hbar }))
    }

    /// The real and the imaginary part of an entry on or above the diagonal.
    fn entry(&self, t: f64, i: usize, j: usize) -> [f64; 2] {
        let entry = match &self.of {
            Of::Formulas(stated) => stated.upper[place(self.n, i, j)]
                .each_ref()
                .map(|part| part.as_ref().map_or(0.0, |formula| formula.value(&[t]))),
            Of::Drive(drive) => drive.entry(t, i, j),
        };
        match self.hbar {
            None => entry,
            Some(hbar) => {
                tally(|| Ops::divs(2));
                entry.map(|x| x / hbar)
            }
        }
    }

    fn formula(&self) -> Option<&Formula> {
        match &self.of {
            Of::Formulas(stated) => stated.formulas().next(),
            Of::Drive(_) => None,
        }
    }

    /// Where steps end: at knots of samples, and within a pulse that is short beside the span, which steps would pass over.
    fn knots(&self, [t0, t1]: [f64; 2]) -> Option<Stops> {
        if let Some(samples) = self.formula().and_then(Formula::samples) {
            return Some(Stops::at_knots(samples, [t0, t1]));
        }
        let Of::Drive(Drive { pulse: Some([at, width]), .. }) = self.of else { return None };
        let is_short = width < SHORT * (t1 - t0).abs();
        let within = PULSE.map(|part| at + part * width).into_iter();
        let within = within.filter(|t| is_short && t0.min(t1) < *t && *t < t0.max(t1));
        Some(Stops::at_kinks(within.collect::<Vec<_>>()))
    }
    fn check_start(&self, t0: f64) -> Vec<Refusal> {
        match &self.of {
            Of::Formulas(stated) => stated.check(self.n, t0),
            Of::Drive(_) => Vec::new(),
        }
    }
}

/// The formulas of a part of H.
type Rows = Vec<Vec<Text>>;

/// Does each row have an entry for each level?
fn is_whole(rows: &Rows) -> bool {
    rows.iter().all(|row| row.len() == rows.len())
}

/// The number of levels that the two parts have.
///
/// # Errors
/// Refusals of parts with other rows.
fn levels(parts: &[Option<Rows>; 2]) -> Result<usize, ReadError> {
    let n = parts.iter().flatten().next().map_or(0, Vec::len);
    // The second part is compared with the first one only where that is right.
    for (key, rows) in PARTS.into_iter().zip(parts) {
        let Some(rows) = rows else { continue };
        if rows.is_empty() || rows.len() != n {
            let expected = if n == 0 { "at least 1".into() } else { n.to_string() };
            let message = format!("found {}, expected {expected}", amount(rows.len(), "rows"));
            return Err(Refusal::at(key, message).into());
        }
        let whole = is_whole(rows);
        let expected = |i: usize| if whole { n } else { n - i };
        if let Some((i, row)) = rows.iter().enumerate().find(|(i, row)| row.len() != expected(*i)) {
            let message = format!(
                "row {} has {}, expected {}: all rows have {n}, or those on and above the diagonal alone, {n} in \
                 the first row and one less in each row below it",
                i + 1,
                amount(row.len(), "formulas"),
                n - i
            );
            return Err(Refusal::at(key.index(i), message).into());
        }
    }
    Ok(n)
}

/// The place of the entry (i, j), i ≤ j, among those on and above the diagonal, row by row.
fn place(n: usize, i: usize, j: usize) -> usize {
    i * (2 * n - i + 1) / 2 + j - i
}

/// Times after the start at which entries that are stated twice are compared.
const LATER: [f64; 6] = [0.0, 0.5, 2.0, 7.0, 30.0, 100.0];
/// How far such entries may be apart, relative to their size.
const SAME: f64 = 1e-8;

impl Stated {
    /// The formulas of the two parts, of n levels.
    fn read(
        parts: [Option<Rows>; 2],
        n: usize,
        names: Result<&Names, ReadError>,
    ) -> Result<Self, ReadError> {
        let mut mistakes = ReadError::default();
        let mut upper = vec![[None, None]; n * (n + 1) / 2];
        let mut lower = Vec::new();
        for (part, (key, rows)) in PARTS.into_iter().zip(parts).enumerate() {
            let rows = rows.unwrap_or_default();
            let whole = is_whole(&rows);
            for (i, row) in rows.into_iter().enumerate() {
                for (j, Text(text)) in row.into_iter().enumerate() {
                    let key = key.cell(i, j);
                    let formula = match &names {
                        Ok(names) => Formula::read(&key, &text, names),
                        Err(known) => {
                            Formula::check_form(&key, &text).and_then(|()| Err(known.clone()))
                        }
                    };
                    let Some(formula) = mistakes.keep(formula) else { continue };
                    let j = if whole { j } else { i + j };
                    match i <= j {
                        true => upper[place(n, i, j)][part] = Some(formula),
                        false => lower.push(((part, i, j), formula)),
                    }
                }
            }
        }
        mistakes.or(names.is_ok().then_some(Stated { upper, lower }))
    }

    fn formulas(&self) -> impl Iterator<Item = &Formula> {
        let lower = self.lower.iter().map(|(_, formula)| formula);
        self.upper.iter().flatten().flatten().chain(lower)
    }

    fn check(&self, n: usize, t0: f64) -> Vec<Refusal> {
        let wrong = without_value(self.formulas(), &[t0]);
        if !wrong.is_empty() {
            return wrong;
        }
        let found = LATER.iter().find_map(|later| self.not_hermitian(n, t0 + later));
        // A formula without a value at a later time is not refused.
        self.formulas().take(1).for_each(Formula::forget);
        found.into_iter().collect()
    }

    /// The first entry with which H(t) is not Hermitian.
    fn not_hermitian(&self, n: usize, t: f64) -> Option<Refusal> {
        let value = |part: usize, i: usize, j: usize| {
            self.upper[place(n, i, j)][part].as_ref().map_or(0.0, |formula| formula.value(&[t]))
        };
        let at = if t == 0.0 { String::new() } else { format!(" at t = {t}") };
        if let Some((i, x)) = (0..n).map(|i| (i, value(1, i, i))).find(|(_, x)| x.abs() > 0.0) {
            let key = PARTS[1].cell(i, i);
            return Some(Refusal::at(&*key, format!("{key} is {x}{at}, expected 0")));
        }
        self.lower.iter().find_map(|((part, i, j), formula)| {
            let (below, above) = (formula.value(&[t]), value(*part, *j, *i));
            let sign = if *part == 0 { 1.0 } else { -1.0 };
            let away = (below - sign * above).abs();
            // False where one of them has no value.
            let apart = away > SAME * below.abs().max(above.abs());
            apart.then(|| {
                let key = PARTS[*part];
                let (below_at, above_at) = (key.cell(*i, *j), key.cell(*j, *i));
                let expected = if *part == 0 { "the same" } else { "the negative of it" };
                let help = "H is Hermitian: the entries below the diagonal may be left out".into();
                let message = format!(
                    "{below_at} is {below} and {above_at} is {above}{at}, expected {expected}"
                );
                Refusal { help: Some(help), ..Refusal::at(below_at, message) }
            })
        })
    }
}

impl Drive {
    /// The number of levels, and the drive.
    fn read(keys: HamiltonianKeys) -> (Key<usize>, Key<Self>) {
        let HamiltonianKeys { energies, coupling, coupling_imaginary, .. } = keys;
        let HamiltonianKeys { frequency, phase, pulse, .. } = keys;
        if !given(&energies) && !given(&coupling) {
            let message = "missing key `hamiltonian`, or `energies` with `coupling`, in [problem]";
            return (Err(ReadError::known()), Err(Refusal::section(message).into()));
        }
        let missing = |key| move || Refusal::section(format!("missing key `{key}` in [problem]"));
        let energies = energies.and_then(|x| Ok(x.ok_or_else(missing("energies"))?.values()));
        let n = seen(&energies).map(Vec::len);
        let size = n.as_ref().ok().copied();
        let real = coupling.and_then(|x| {
            let table = x.ok_or_else(missing("coupling"))?;
            symmetric("coupling", &table, size, ROUNDING)
        });
        let imaginary = coupling_imaginary
            .and_then(|table| imaginary_part("coupling_imaginary", table, size, 0.0));
        let pulse = pulse.and_then(|pulse| match pulse {
            Some(Reals([_, width])) if width <= 0.0 => {
                let message = format!("width = {width}, expected a number > 0");
                Err(Refusal::at("pulse".index(1), message).into())
            }
            pulse => Ok(pulse.map(|pulse| pulse.0)),
        });
        let all = all!(energies, real, imaginary, frequency, phase, pulse);
        let drive = all.map(|(energies, real, imaginary, frequency, phase, pulse)| Drive {
            energies,
            coupling: [real, imaginary],
            frequency: frequency.map_or(0.0, |x| x.0),
            phase: phase.map_or(0.0, |x| x.0),
            pulse,
        });
        (n, drive)
    }

    /// a(t).
    fn strength(&self, t: f64) -> f64 {
        let pulse = Ops::adds(1) + Ops::divs(1) + Ops::muls(1) + Ops::trigs(1);
        tally(|| pulse * self.pulse.iter().count() + Ops::muls(2) + Ops::adds(1) + Ops::trigs(1));
        let envelope = self.pulse.map_or(1.0, |[at, width]| (-((t - at) / width).powi(2)).exp());
        envelope * (self.frequency * t + self.phase).cos()
    }

    fn entry(&self, t: f64, i: usize, j: usize) -> [f64; 2] {
        let (drive, [re, im]) = (self.strength(t), &self.coupling);
        let energy = if i == j { self.energies[i] } else { 0.0 };
        tally(|| Ops::muls(2) + Ops::adds(1));
        [energy + drive * re[(i, j)], drive * im[(i, j)]]
    }
}

/// The antisymmetric n×n matrix of a key, to the rounding of numbers of this size. It is 0 if the key is left out.
fn imaginary_part(
    key: &str,
    table: Option<Table>,
    n: Option<usize>,
    size: f64,
) -> Result<Mat<f64>, ReadError> {
    let zero = || Mat::zeros(n.unwrap_or(0), n.unwrap_or(0));
    let x = table.map_or_else(|| Ok(zero()), |table| square(key, &table, n))?;
    let largest = largest_entry(x.as_ref());
    if largest > 0.0 {
        check_antisymmetric(key, &x, ROUNDING * (size / largest).max(1.0))?;
    }
    Ok(Mat::from_fn(x.nrows(), x.nrows(), |i, j| 0.5 * (x[(i, j)] - x[(j, i)])))
}

/// The state of n levels with these amplitudes.
fn state(
    n: &Key<usize>,
    real: Key<List>,
    imaginary: Key<Option<List>>,
) -> Result<Mat<f64>, ReadError> {
    let one_a_level = |key: &str, numbers: Option<List>| {
        let n = *seen(n)?;
        let numbers = numbers.map_or(vec![0.0; n], |numbers| numbers.values());
        let message = || {
            format!("found {}, expected {n}, one for each level", amount(numbers.len(), "numbers"))
        };
        match numbers.len() == n {
            true => Ok(numbers),
            false => Err(ReadError::from(Refusal::at(key, message()))),
        }
    };
    let re = real.and_then(|x| one_a_level("amplitudes", Some(x)));
    let im = imaginary.and_then(|x| one_a_level("amplitudes_imaginary", x));
    let (re, im) = all!(re, im)?;
    let psi: Vec<_> = re.iter().zip(&im).map(|(re, im)| [*re, *im]).collect();
    Ok(amplitudes(&psi).map_err(|error| Refusal::from(error).about("amplitudes"))?)
}
