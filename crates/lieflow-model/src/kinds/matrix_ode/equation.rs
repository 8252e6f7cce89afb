//! The equation of a scene: its field, its problem and its quantities.

use std::sync::Arc;

use lieflow::actions::Action;
use lieflow::dense::{largest_entry, multiply, norm, squared_norm};
use lieflow::groups::{AlgebraMatrix, LieAlgebra, LieGroup, MatrixGroup};
use lieflow::maps::{CoordinateMap, Exp};
use lieflow::problems::Flow;
use lieflow_runs::spaces::{MatrixAction, OnMatrices};

use super::{ACTIONS, NAMED_MAX, entry_names, letters};
use crate::formula::{Formula, without_value};
use crate::kinds::algebra::{Algebra, Miss, miss};
use crate::kinds::entries::{numbered, size_of_traces, traces, upper, upper_columns};
use crate::kinds::on_m::{check_complex, check_symmetric};
use crate::kinds::prelude::*;

/// The equation with its initial point.
#[derive(Clone, Debug)]
pub(super) struct Equation {
    pub(super) algebra: Algebra,
    pub(super) group: MatrixGroup,
    pub(super) action: MatrixAction,
    /// f, or its part above the diagonal: each formula with its row and its column. The rows of an imaginary part are below
    /// those of the real one.
    pub(super) field: Arc<[((usize, usize), Formula)]>,
    /// Is the part below the diagonal minus that above it?
    pub(super) by_upper: bool,
    /// Is f a function of t alone?
    pub(super) linear: bool,
    pub(super) start: Mat<f64>,
    /// Changes that were made to numbers of the scene.
    pub(super) notes: Vec<String>,
}

/// The distance from the algebra that f may have at the points where it is checked, relative to its size.
const IN_THE_ALGEBRA: f64 = 1e-8;

impl Equation {
    /// n, of the field of n×n formulas.
    fn n(&self) -> usize {
        self.group.n() / self.parts()
    }
    /// 2 for complex matrices, else 1.
    fn parts(&self) -> usize {
        if self.algebra.is_complex() { 2 } else { 1 }
    }
    /// The numbers of the point.
    fn numbers(&self) -> Numbers {
        if self.algebra.is_complex() { Numbers::Complex } else { Numbers::Real }
    }
    /// The rows and the columns of the point, which may be complex.
    fn shape(&self) -> [usize; 2] {
        let columns = match self.action {
            MatrixAction::Linear => self.start.ncols(),
            _ => self.start.ncols() / self.parts(),
        };
        [self.start.nrows() / self.parts(), columns]
    }
    /// The names of the entries of a matrix of this shape: of a complex one the real and then the imaginary parts.
    fn names_of(&self, rows: usize, columns: usize) -> Vec<String> {
        entry_names(self.algebra, [rows, columns])
    }
    /// The entries of the point: of a complex one the real and then the imaginary parts.
    fn entries<'a>(&self, y: &'a Mat<f64>) -> impl Iterator<Item = f64> + use<'a> {
        let [_, columns] = self.shape();
        (0..y.nrows()).flat_map(move |i| (0..columns).map(move |j| y[(i, j)]))
    }
    /// t and the entries of y, for formulas: the first numbers of N.
    fn values<const N: usize>(&self, t: f64, y: &Mat<f64>) -> [f64; N] {
        let mut values = [t; N];
        values[1..].iter_mut().zip(self.entries(y)).for_each(|(value, y)| *value = y);
        values
    }
    /// v ← f(t, y) by the formulas.
    fn stated(&self, t: f64, y: &Mat<f64>, v: &mut Mat<f64>) {
        match self.algebra.is_complex() {
            true => self.by_values(&self.values::<{ 1 + 2 * NAMED_MAX * NAMED_MAX }>(t, y), v),
            false => self.by_values(&self.values::<{ 1 + NAMED_MAX * NAMED_MAX }>(t, y), v),
        }
    }
    fn by_values(&self, values: &[f64], v: &mut Mat<f64>) {
        if self.by_upper {
            v.fill(0.0);
        }
        for &((i, j), ref formula) in &*self.field {
            v[(i, j)] = formula.value(values);
            if self.by_upper {
                v[(j, i)] = -v[(i, j)];
            }
        }
    }
    fn formulas(&self) -> impl Iterator<Item = &Formula> {
        self.field.iter().map(|(_, formula)| formula)
    }
    /// v ← the projection of f(t, y) on 𝔤, where f is near it. Elsewhere f itself: the run ends with an error then.
    fn projected(&self, t: f64, y: &Mat<f64>, v: &mut AlgebraMatrix) {
        self.stated(t, y, v);
        if self.algebra.is_complex() {
            // The formulas are X and Y of [X −Y; Y X].
            let n = self.n();
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                (v[(i, n + j)], v[(n + i, n + j)]) = (-v[(n + i, j)], v[(i, j)]);
            }
        }
        let off = self.group.off_algebra(v);
        if off <= IN_THE_ALGEBRA * largest_entry(v.as_ref()) {
            self.algebra.project(v);
        }
    }
    /// A point of M beside the start: Λ(exp v, start) for a generic v ∈ 𝔤.
    fn beside_the_start(&self) -> Option<Mat<f64>> {
        let n = self.group.n();
        let mut v = self.group.zero();
        v.copy_from(Mat::from_fn(n, n, |i, j| 0.3 * ((1 + 3 * i + 5 * j) as f64).sin()));
        self.algebra.project(&mut v);
        let (mut g, mut at) = (self.group.identity(), Exp.at(&self.group).ok()?);
        Exp.psi(&self.group, &v, &mut at, &mut g).ok()?;
        let (mut moved, mut work) = (self.start.clone(), self.action.work(&self.group));
        self.action.act(&self.group, &g, &self.start, &mut moved, &mut work);
        Some(moved)
    }
    /// yᵀMy, where the group has an M.
    fn form(&self, y: &Mat<f64>) -> Option<Mat<f64>> {
        let ym = multiply(y.transpose(), self.group.m()?.as_ref());
        Some(multiply(ym.as_ref(), y.as_ref()))
    }
    /// tr y, tr y², …, tr yⁿ: of a complex y the real and then the imaginary parts.
    fn traces(&self, y: &Mat<f64>) -> Vec<f64> {
        let n = self.n();
        if !self.algebra.is_complex() {
            return traces(y).collect();
        }
        let mut power = Mat::<f64>::identity(2 * n, 2 * n);
        let mut all = vec![0.0; 2 * n];
        for k in 0..n {
            power = multiply(power.as_ref(), y.as_ref());
            all[k] = (0..n).map(|i| power[(i, i)]).sum();
            all[n + k] = (0..n).map(|i| power[(n + i, i)]).sum();
        }
        all
    }
    /// The quantity that the action keeps.
    fn kept(&self) -> Option<&'static str> {
        let keeps_a_form = !matches!(self.algebra, Algebra::Gl | Algebra::Sl);
        match self.action {
            MatrixAction::Conjugation | MatrixAction::Coadjoint => Some("traces"),
            // Each Lagrangian subspace can be moved to each.
            MatrixAction::Lagrangian => None,
            MatrixAction::Translation | MatrixAction::RightTranslation => {
                keeps_a_form.then_some("group_defect")
            }
            MatrixAction::Linear => keeps_a_form.then_some("form"),
        }
    }
    fn unless_kept(&self, name: &str, why: &'static str) -> Option<&'static str> {
        (self.kept() != Some(name)).then_some(why)
    }
}

type Q = Quantity<Equation>;

impl System for Equation {
    type Problem = OnMatrices;

    const STATE: &'static [&'static str] = &["point"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers("point", &["y11", "…", "ynk"], "the point, row by row; re11, …, im11, … of a complex one", |equation, _, y, row| {
            row.extend(equation.entries(y));
        })
        .of_matrices(|equation| (letters(equation.algebra), equation.shape()))
        .of_numbers(Equation::numbers),
        Q::numbers(
            "column",
            &["y11", "…", "yn1"],
            "the first column of the point: where the first direction goes",
            |_, _, y, row| row.extend(y.col_as_slice(0)),
        )
        .with_columns(|equation| equation.names_of(equation.shape()[0], 1))
        .of_numbers(Equation::numbers),
        Q::number(
            "group_defect",
            "distance of y'My from M, for translation on so, sp, so(p,q), u and su",
            |equation, _, y| {
                let away = equation.form(y).zip(equation.group.m());
                // A complex matrix is there twice in its real one.
                let copies = (equation.parts() as f64).sqrt();
                away.map_or(f64::NAN, |(form, m)| norm((form - m).as_ref()) / copies)
            },
        )
        .kept(Law::by_the_action(2))
        .of_distance()
        .in_terms(|_, y| squared_norm(y.as_ref()))
        .missing_where(|equation| {
            equation.unless_kept("group_defect", "it is for translation on so, sp, so(p,q), u and su")
        }),
        Q::numbers(
            "form",
            &["f11", "…", "fkk"],
            "y'My, on and above the diagonal, for the linear action of so, sp, so(p,q), u and su; the real part of a \
             complex one",
            |equation, _, y, row| row.extend(equation.form(y).iter().flat_map(upper)),
        )
        .with_columns(|equation| upper_columns("f", equation.start.ncols()))
        .kept(Law::by_the_action(2))
        .in_terms(|_, y| squared_norm(y.as_ref()))
        .missing_where(|equation| {
            equation.unless_kept("form", "it is for the linear action of so, sp, so(p,q), u and su")
        }),
        Q::numbers(
            "traces",
            &["tr1", "…", "trn"],
            "traces of the powers of the point, for conjugation and coadjoint; of a complex one their imaginary parts, \
             ti1, …, too",
            |equation, _, y, row| row.extend(equation.traces(y)),
        )
        .with_columns(|equation| {
            let letters = &["tr", "ti"][..equation.parts()];
            letters.iter().flat_map(|letter| numbered(letter, equation.n())).collect()
        })
        .of_numbers(Equation::numbers)
        .kept(Law::by_the_action(0))
        .in_terms(|_, y| size_of_traces(y))
        .missing_where(|equation| {
            equation.unless_kept("traces", "it is for conjugation and coadjoint")
        }),
    ];

    fn problem(&self) -> Result<Start<OnMatrices>, Error> {
        let (this, group, action) = (self.clone(), self.group.clone(), self.action);
        let problem = if self.linear {
            let a = move |t: f64, v: &mut AlgebraMatrix| this.projected(t, &this.start, v);
            OnMatrices::linear(Flow::of_time(group, action, a), action)
        } else {
            let f = move |t, y: &Mat<f64>, v: &mut AlgebraMatrix| this.projected(t, y, v);
            OnMatrices::new(Flow::new(group, action, f), action)
        };
        Ok((problem, self.start.clone()))
    }
    fn check_start(&self, t0: f64) -> Vec<Refusal> {
        let n = self.n();
        let wrong = without_value(
            self.formulas(),
            &self.values::<{ 1 + 2 * NAMED_MAX * NAMED_MAX }>(t0, &self.start),
        );
        if !wrong.is_empty() {
            return wrong;
        }
        let mut f = self.group.zero();
        let beside = self.beside_the_start();
        let first = (t0, &self.start, "at the start");
        // At another time too. A field that has no value there is not refused.
        let second = beside.iter().map(|y| (t0 + 0.5, y, "beside the start"));
        for (t, y, place) in [first].into_iter().chain(second) {
            self.stated(t, y, &mut f);
            let missed = miss(self.algebra, "field", &f, IN_THE_ALGEBRA);
            if let Some(Miss { key, why, form }) = missed.filter(|_| f.is_all_finite()) {
                let algebra = self.algebra.name(n);
                let message = format!("the field is not in {algebra}: {place} {why}");
                return vec![Refusal { help: Some(form), ..Refusal::at(key, message) }];
            }
        }
        Vec::new()
    }
    fn formula(&self) -> Option<&Formula> {
        self.formulas().next()
    }
    fn check_state(&self, arg: &str, y: &Mat<f64>) -> Result<(), Error> {
        match self.action {
            MatrixAction::Lagrangian => check_symmetric(arg, y),
            MatrixAction::Conjugation | MatrixAction::Coadjoint if self.algebra.is_complex() => {
                check_complex(arg, y)
            }
            _ => Ok(()),
        }
    }
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
    fn modelled(&self) -> String {
        let [rows, columns] = self.shape();
        let action = ACTIONS.iter().find(|(_, action)| *action == self.action);
        let name = action.map_or("", |(name, _)| name);
        let complex = if self.algebra.is_complex() { "complex " } else { "" };
        format!("{complex}{rows}×{columns} matrix, {} by {name}", self.group.name())
    }
    fn figure(&self) -> Figure {
        match self.action {
            MatrixAction::Translation | MatrixAction::RightTranslation => Figure::Lines("column"),
            _ => Figure::Lines("point"),
        }
    }
}
