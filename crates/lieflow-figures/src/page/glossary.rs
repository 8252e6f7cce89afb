//! The words that a reader of a page may not know.

use super::Block;

/// The words with what they mean.
const WORDS: [(&str, &str); 14] = [
    ("Attitude", "How a body is turned: the rotation that takes its own axes to those of space."),
    (
        "In the body, in space",
        "A vector has three numbers along the axes of the body, which turn with it, or along the axes of space, \
         which do not.",
    ),
    (
        "Quaternion",
        "Four numbers w, x, y, z of length 1 that describe a rotation. q and −q are the same rotation.",
    ),
    (
        "Lie group",
        "A set of matrices that can be multiplied and inverted, such as all rotations. Their products stay in \
         the set; their sums do not.",
    ),
    (
        "Lie group method",
        "A method that takes each step by multiplication with a member of the group. So the solution stays in the \
         group, however long the run is.",
    ),
    (
        "Coordinate map (exp, cay, ccsk)",
        "A formula that makes a member of the group, such as a rotation, from a small vector.",
    ),
    ("Tableau", "The coefficients of a Runge–Kutta method, such as rk4 or dopri5."),
    (
        "Order",
        "A method of order p makes its error 2ᵖ times smaller when the step is halved: 16 times for order 4.",
    ),
    ("Step h", "The time that the method advances at once. Smaller steps cost more and err less."),
    (
        "Tolerance",
        "The error that an adaptive method may make. It chooses its steps so that the estimate of the error stays below.",
    ),
    (
        "Invariant, drift",
        "An invariant is a quantity that the exact motion conserves, such as the energy. Its drift is how far the \
         computed value has moved from the start.",
    ),
    (
        "Casimir",
        "An invariant whatever the energy is, such as the length of the angular momentum in a free body.",
    ),
    (
        "Closed and general formulas",
        "Rotations in three dimensions have short formulas, called closed. The general code works for matrices of any \
         size.",
    ),
    (
        "Rounding",
        "A computer keeps 16 digits of a number. What is lost in each operation is rounding, about 10⁻¹⁶ of the value.",
    ),
];

/// What the fold with the words, and the link to it, are called.
pub(super) const GLOSSARY: &str = "What do these words mean?";

/// The words in a fold, for the foot of every page. The page docs/glossary.md has them too, and more.
pub(super) fn glossary() -> Block {
    Block::fold(GLOSSARY, vec![Block::Glossary(&WORDS)])
}

#[cfg(test)]
mod tests {
    use super::WORDS;

    #[test]
    fn the_page_of_words_says_the_same() {
        let page = include_str!("../../../../docs/glossary.md");
        for (word, meaning) in WORDS {
            assert!(page.contains(&format!("\n| {word} | {meaning} |\n")), "{word}");
        }
    }
}
