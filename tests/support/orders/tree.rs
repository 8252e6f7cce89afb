//! The order conditions of a tableau, as verdicts.

use lieflow::methods::Tableau;
use lieflow::methods::tableau::order_of;

use super::super::Verdict;

/// The row b with the stages a has exactly this order: the conditions hold up to it, and one of the
/// next order fails.
pub(crate) fn row_conditions<const S: usize>(
    name: &str,
    a: &[[f64; S]; S],
    b: &[f64; S],
    order: usize,
) -> Verdict {
    match order_of(order + 1, a, b) {
        held if held < order => Err(format!("{name}: a condition of order {} fails", held + 1)),
        held if held > order => Err(format!("{name}: it has a higher order than {order}")),
        _ => Ok(()),
    }
}

/// A tableau is explicit, its c_i are the row sums, and its b has exactly the order that it states.
pub(crate) fn order_conditions<const S: usize>(t: &Tableau<S>) -> Verdict {
    t.check().map_err(|error| error.to_string())?;
    row_conditions(t.name, &t.a, &t.b, t.order)
}
