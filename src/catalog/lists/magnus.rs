//! Magnus methods, for equations of linear type.

use super::{GROUP_AND_TIME, plain};
use crate::catalog::facts::{Cost, Family, MethodInfo, Needs, Operation, WorkItem, times};
use crate::catalog::recipe::Recipe;
use Operation::{Bracket, Cay, Exp, LinearField, TripleProduct};

const fn magnus(
    name: &'static str,
    order: usize,
    summary: &'static str,
    work: &'static [WorkItem],
    source: &'static str,
    recipe: Recipe,
) -> MethodInfo {
    let family = (Family::Magnus, Needs::LinearType);
    plain(family, name, order, summary, GROUP_AND_TIME, Cost::of(work), source, recipe)
}

const ALVERMANN: &str = "Alvermann, Fehske 2011";

/// Methods for equations of linear type, ẏ = λ_*(A(t))(y).
pub(super) const LINEAR_TYPE: &[MethodInfo] = &[
    magnus(
        "magnus4",
        4,
        "Magnus, order 4",
        &[times(2, LinearField), times(1, Exp), times(1, Bracket)],
        "Iserles, Nørsett 1999",
        Recipe::Magnus4,
    ),
    magnus(
        "magnus6",
        6,
        "Magnus, order 6",
        &[times(3, LinearField), times(1, Exp), times(3, Bracket)],
        "Blanes, Casas, Ros 2002",
        Recipe::Magnus6,
    ),
    magnus(
        "magnus8",
        8,
        "Magnus, order 8",
        &[times(4, LinearField), times(1, Exp), times(10, Bracket)],
        "Blanes, Casas, Ros 2000",
        Recipe::Magnus8,
    ),
    magnus(
        "cfm4-2",
        4,
        "commutator-free Magnus, order 4",
        &[times(2, LinearField), times(2, Exp)],
        "Blanes, Moan 2006",
        Recipe::Cfm42,
    ),
    magnus(
        "cfm4-3",
        4,
        "commutator-free Magnus, order 4, optimised",
        &[times(3, LinearField), times(3, Exp)],
        ALVERMANN,
        Recipe::Cfm43,
    ),
    magnus(
        "cfm6-5",
        6,
        "commutator-free Magnus, order 6",
        &[times(3, LinearField), times(5, Exp)],
        ALVERMANN,
        Recipe::Cfm65,
    ),
    magnus(
        "cfm8-11",
        8,
        "commutator-free Magnus, order 8",
        &[times(4, LinearField), times(11, Exp)],
        ALVERMANN,
        Recipe::Cfm811,
    ),
    magnus(
        "cayley-magnus4",
        4,
        "Magnus in Cayley coordinates, order 4; on SL(n) and SU(n), n > 2, det = 1 only up to the error",
        &[times(2, LinearField), times(1, Cay), times(1, Bracket), times(1, TripleProduct)],
        "Iserles 2001",
        Recipe::CayleyMagnus4,
    ),
    magnus(
        "cayley-magnus6",
        6,
        "Magnus in Cayley coordinates, order 6; on SL(n) and SU(n), n > 2, det = 1 only up to the error",
        &[times(3, LinearField), times(1, Cay), times(5, Bracket), times(5, TripleProduct)],
        "Iserles 2001",
        Recipe::CayleyMagnus6,
    ),
];
