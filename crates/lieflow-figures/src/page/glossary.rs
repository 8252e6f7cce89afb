//! The words that a reader of a page may not know: the first table of `glossary.md`, which has more.

use super::Block;

/// The glossary of the documentation.
const GLOSSARY_MD: &str = include_str!("../../glossary.md");

/// What the fold with the words, and the link to it, are called.
pub(super) const GLOSSARY: &str = "What do these words mean?";

/// The words with what they mean.
fn words() -> Vec<(&'static str, &'static str)> {
    let rows = GLOSSARY_MD.lines().skip_while(|line| !line.starts_with("|---|")).skip(1);
    let row = |line: &'static str| line.strip_prefix("| ")?.strip_suffix(" |")?.split_once(" | ");
    rows.map_while(row).collect()
}

/// The words in a fold, for the foot of every page.
pub(super) fn glossary() -> Block {
    Block::fold(GLOSSARY, vec![Block::Glossary(words())])
}

#[cfg(test)]
mod tests {
    use super::words;

    #[test]
    fn the_words_are_those_of_the_first_table() {
        let words = words();
        assert_eq!(words.len(), 14);
        assert!(words.iter().all(|(word, meaning)| !word.is_empty() && meaning.ends_with('.')));
        assert_eq!([words[0].0, words[13].0], ["Attitude", "Rounding"]);
    }
}
