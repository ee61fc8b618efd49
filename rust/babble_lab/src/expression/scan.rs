//! The words of an expression: numbers, names and signs.

use std::fmt;

use super::RuleFault;

/// A word of an expression, and the characters before it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Token {
    pub(super) word: Word,
    pub(super) at: usize,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Word {
    Number(f32),
    Name(String),
    Sign(char),
    End,
}

impl fmt::Display for Word {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(x) => write!(f, "the number {x:?}"),
            Self::Name(name) => write!(f, "{name:?}"),
            Self::Sign(sign) => write!(f, "{sign:?}"),
            Self::End => f.write_str("the end"),
        }
    }
}

/// Bar over the letter before it: `ā` may be written as two characters.
const BAR: char = '\u{304}';

/// The words of a text, the last of which is its end.
pub(super) fn tokens(text: &str) -> Result<Vec<Token>, RuleFault> {
    let text: Vec<char> = text.chars().collect();
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(&first) = text.get(at) {
        if first.is_whitespace() {
            at += 1;
            continue;
        }
        let (word, length) = word(first, &text[at..], at)?;
        found.push(Token { word, at });
        at += length;
    }
    found.push(Token {
        word: Word::End,
        at,
    });
    Ok(found)
}

/// The word that `rest` begins with, and its length.
fn word(first: char, rest: &[char], at: usize) -> Result<(Word, usize), RuleFault> {
    if first.is_ascii_digit() || first == '.' {
        return number(rest, at);
    }
    if first.is_alphabetic() {
        return Ok(name(rest));
    }
    let sign = match first {
        '−' | '–' => '-',
        '·' | '×' | '⋅' => '*',
        '+' | '-' | '*' | '/' | '^' | '(' | ')' | ',' => first,
        '=' => return Err(fault(at, "write only what Δw equals, without \"Δw =\"")),
        '<' | '>' => {
            return Err(fault(
                at,
                "comparisons are unknown; sign, min and max can replace them",
            ));
        }
        '|' => return Err(fault(at, "write abs(w) for the absolute value |w|")),
        _ => {
            return Err(fault(
                at,
                format!("{first:?} is unknown; expected a number, a name or one of + - * / ^ ( )"),
            ));
        }
    };
    Ok((Word::Sign(sign), 1))
}

fn number(rest: &[char], at: usize) -> Result<(Word, usize), RuleFault> {
    let digits = |from: usize| {
        rest[from..]
            .iter()
            .take_while(|c| c.is_ascii_digit() || **c == '.')
            .count()
    };
    let mut length = digits(0);
    if matches!(rest.get(length), Some('e' | 'E')) {
        let signed = usize::from(matches!(rest.get(length + 1), Some('+' | '-')));
        let exponent = rest[length + 1 + signed..]
            .iter()
            .take_while(|c| c.is_ascii_digit())
            .count();
        if exponent > 0 {
            length += 1 + signed + exponent;
        }
    }
    let text: String = rest[..length].iter().collect();
    match text.parse::<f32>() {
        Ok(x) if x.is_finite() => Ok((Word::Number(x), length)),
        Ok(_) => Err(fault(
            at,
            format!("{text} is too large; numbers go up to 3.4e38"),
        )),
        Err(_) => Err(fault(
            at,
            format!("{text:?} is not a number such as 0.5 or 1e-3"),
        )),
    }
}

fn name(rest: &[char]) -> (Word, usize) {
    let belongs = |c: &&char| c.is_alphanumeric() || matches!(**c, '_' | BAR);
    let length = rest.iter().take_while(belongs).count();
    let name: String = rest[..length].iter().collect();
    let composed = match name.as_str() {
        "a\u{304}" => "ā".to_owned(),
        "g\u{304}" => "ḡ".to_owned(),
        _ => name,
    };
    (Word::Name(composed), length)
}

pub(super) fn fault(at: usize, problem: impl Into<String>) -> RuleFault {
    RuleFault {
        problem: problem.into(),
        at,
    }
}
