//! From a text to an expression.
//!
//! ```text
//! sum     = product (("+" | "-") product)*
//! product = signed (("*" | "/") signed)*
//! signed  = "-" signed | power
//! power   = atom ("^" signed)?
//! atom    = number | name | function "(" sum ("," sum)* ")" | "(" sum ")"
//! ```

use babble_env::nearest;

use super::scan::{Token, Word, fault, tokens};
use super::syntax::{Expr, One, Quantity, Two};
use super::{MOST_CHARACTERS, RuleFault};

/// Most parentheses, signs and exponents inside each other.
const DEEPEST: usize = 32;

/// The expression that a text is.
pub(super) fn expression(text: &str) -> Result<Expr, RuleFault> {
    let length = text.chars().count();
    if length > MOST_CHARACTERS {
        let problem =
            format!("the rule has {length} characters; at most {MOST_CHARACTERS} are allowed");
        return Err(fault(MOST_CHARACTERS, problem));
    }
    let mut parser = Parser {
        tokens: tokens(text)?,
        next: 0,
        depth: 0,
    };
    if parser.peek().word == Word::End {
        return Err(fault(
            0,
            "the rule is empty; write what Δw equals, for instance eta * a * g",
        ));
    }
    let expr = parser.sum()?;
    match parser.peek() {
        Token {
            word: Word::End, ..
        } => Ok(expr),
        unexpected => Err(after_operand(unexpected)),
    }
}

struct Parser {
    tokens: Vec<Token>,
    next: usize,
    depth: usize,
}

impl Parser {
    fn peek(&self) -> &Token {
        // The end is never passed.
        &self.tokens[self.next]
    }

    fn take(&mut self) -> Token {
        let token = self.peek().clone();
        if token.word != Word::End {
            self.next += 1;
        }
        token
    }

    /// Takes one of these signs, if it comes next.
    fn sign(&mut self, signs: &[char]) -> Option<char> {
        let Word::Sign(sign) = self.peek().word else {
            return None;
        };
        signs.contains(&sign).then(|| {
            self.next += 1;
            sign
        })
    }

    fn sum(&mut self) -> Result<Expr, RuleFault> {
        let mut left = self.product()?;
        while let Some(sign) = self.sign(&['+', '-']) {
            let operation = if sign == '+' { Two::Add } else { Two::Subtract };
            left = two(operation, left, self.product()?);
        }
        Ok(left)
    }

    fn product(&mut self) -> Result<Expr, RuleFault> {
        let mut left = self.signed()?;
        while let Some(sign) = self.sign(&['*', '/']) {
            let operation = if sign == '*' {
                Two::Multiply
            } else {
                Two::Divide
            };
            left = two(operation, left, self.signed()?);
        }
        Ok(left)
    }

    fn signed(&mut self) -> Result<Expr, RuleFault> {
        self.deeper(|parser| {
            if parser.sign(&['-']).is_some() {
                return Ok(Expr::One(One::Negate, Box::new(parser.signed()?)));
            }
            let base = parser.atom()?;
            if parser.sign(&['^']).is_none() {
                return Ok(base);
            }
            Ok(two(Two::Power, base, parser.signed()?))
        })
    }

    fn deeper(
        &mut self,
        parse: impl FnOnce(&mut Self) -> Result<Expr, RuleFault>,
    ) -> Result<Expr, RuleFault> {
        self.depth += 1;
        if self.depth > DEEPEST {
            let problem =
                format!("more than {DEEPEST} parentheses, signs or exponents inside each other");
            return Err(fault(self.peek().at, problem));
        }
        let expr = parse(self)?;
        self.depth -= 1;
        Ok(expr)
    }

    fn atom(&mut self) -> Result<Expr, RuleFault> {
        let token = self.take();
        match token.word {
            Word::Number(x) => Ok(Expr::Number(x)),
            Word::Name(ref name) => self.named(name, token.at),
            Word::Sign('(') => {
                let expr = self.sum()?;
                self.closing(token.at)?;
                Ok(expr)
            }
            word => Err(fault(
                token.at,
                format!("{word} where a number, a name or ( was expected"),
            )),
        }
    }

    /// The quantity or the call of a function that begins with a name.
    fn named(&mut self, name: &str, at: usize) -> Result<Expr, RuleFault> {
        if let Some(quantity) = known(name, &Quantity::NAMES) {
            return Ok(Expr::Quantity(quantity));
        }
        if let Some(function) = known(name, &One::NAMES) {
            let [x] = self.arguments(name)?;
            return Ok(Expr::One(function, Box::new(x)));
        }
        if let Some(function) = known(name, &Two::NAMES) {
            let [x, y] = self.arguments(name)?;
            return Ok(two(function, x, y));
        }
        Err(unknown(name, at))
    }

    /// The N arguments of a function in parentheses.
    fn arguments<const N: usize>(&mut self, name: &str) -> Result<[Expr; N], RuleFault> {
        let at = self.peek().at;
        if self.sign(&['(']).is_none() {
            return Err(fault(at, format!("expected ( after {name}")));
        }
        let mut arguments = vec![self.sum()?];
        while self.sign(&[',']).is_some() {
            arguments.push(self.sum()?);
        }
        self.closing(at)?;
        let given = arguments.len();
        arguments.try_into().map_err(|_| {
            let plural = if N == 1 { "" } else { "s" };
            fault(
                at,
                format!("{name} takes {N} argument{plural}, and {given} are given"),
            )
        })
    }

    /// Takes the parenthesis that closes the one `at` a place.
    fn closing(&mut self, at: usize) -> Result<(), RuleFault> {
        if self.sign(&[')']).is_some() {
            return Ok(());
        }
        if self.peek().word == Word::End {
            return Err(fault(at, "this ( is never closed"));
        }
        Err(after_operand(self.peek()))
    }
}

fn two(operation: Two, left: Expr, right: Expr) -> Expr {
    Expr::Two(operation, Box::new(left), Box::new(right))
}

fn known<T: Copy>(name: &str, names: &[(&str, T)]) -> Option<T> {
    names
        .iter()
        .find(|(known, _)| *known == name)
        .map(|(_, meaning)| *meaning)
}

/// The fault of a word that cannot follow an operand.
fn after_operand(token: &Token) -> RuleFault {
    let problem = match &token.word {
        Word::Sign(')') => "this ) closes nothing".to_owned(),
        Word::Sign(',') => {
            "a comma separates the arguments of min and max; a decimal number has a point"
                .to_owned()
        }
        word @ (Word::Number(_) | Word::Name(_) | Word::Sign('(')) => {
            format!("{word} follows without an operator; write * to multiply")
        }
        word => format!("{word} where an operator or the end was expected"),
    };
    fault(token.at, problem)
}

/// The fault of an unknown name, with what was probably meant.
fn unknown(name: &str, at: usize) -> RuleFault {
    let quantities = Quantity::NAMES.iter().map(|(name, _)| *name);
    let functions = One::NAMES.iter().map(|(name, _)| *name);
    let functions = functions.chain(Two::NAMES.iter().map(|(name, _)| *name));
    let names: Vec<&str> = quantities.chain(functions).collect();
    // A short name is two edits away from any other.
    let near = nearest(name, names.iter().copied()).filter(|_| name.chars().count() > 2);
    let hint = near.map_or_else(
        || format!("known are {}", names.join(", ")),
        |near| format!("did you mean {near}?"),
    );
    fault(at, format!("{name:?} is unknown; {hint}"))
}
