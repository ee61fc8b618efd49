//! Errors for unknown names, with the nearest known one.

use crate::error::EnvError;

/// Most edits between a name and the one that was probably meant.
const MOST_EDITS: usize = 2;

/// The error for an unknown name; `kind` says what it should name.
pub(crate) fn unknown(
    kind: &'static str,
    name: &str,
    known: impl IntoIterator<Item = &'static str>,
) -> EnvError {
    let known: Vec<&str> = known.into_iter().collect();
    let nearest = nearest(name, known.iter().copied());
    EnvError::UnknownName {
        kind,
        name: name.to_owned(),
        hint: nearest.map_or_else(String::new, |near| format!(" (did you mean {near:?}?)")),
        known: known.join(", "),
    }
}

/// The known name that was probably meant by `name`, whatever its case; None if all are more than two edits
/// away.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = name.to_ascii_lowercase();
    known
        .into_iter()
        .map(|candidate| (edits(&name, &candidate.to_ascii_lowercase()), candidate))
        .filter(|&(edits, _)| edits <= MOST_EDITS)
        .min_by_key(|&(edits, _)| edits)
        .map(|(_, candidate)| candidate)
}

/// Insertions, deletions and substitutions that turn `a` into `b` (Levenshtein's distance).
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &y) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
