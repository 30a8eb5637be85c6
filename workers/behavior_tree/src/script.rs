//! The script language of version 4: assignments, comparisons and sums over blackboard entries.

use crate::blackboard::Value;

/// Why a script cannot be read or computed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(crate) enum ScriptFault {
    /// A character or word that has no place here.
    #[error(
        "`{found}` at character {at} of the script; allowed: names, numbers, 'texts', := = += -= *= /= + - * / .. == != < <= > >= && || ! & | ^ ~ ? : ( ) ;"
    )]
    Token { found: String, at: usize },
    /// The script ends too early.
    #[error("the script ends too early")]
    End,
    /// Deeper than any sensible script.
    #[error("the script is nested deeper than {MAX_DEPTH}")]
    Deep,
    /// More words and signs than any sensible script.
    #[error("the script has more than {MAX_TOKENS} words and signs")]
    Long,
    /// An entry is read or assigned with `=` before it was created with `:=`.
    #[error("an entry is used before it is set")]
    Unset,
    /// A sum of texts, or a comparison by size of texts.
    #[error("a text where a number is needed")]
    Number,
}

/// Deepest nesting of parentheses and signs.
const MAX_DEPTH: usize = 32;
/// Most words and signs; also bounds how deep a chain of sums can become.
const MAX_TOKENS: usize = 512;

#[derive(Debug, Clone, PartialEq)]
enum Expr {
    Value(Value),
    Entry(usize),
    Not(Box<Expr>),
    Minus(Box<Expr>),
    Flip(Box<Expr>),
    Pair(Op, Box<Expr>, Box<Expr>),
    Choose { condition: Box<Expr>, holds: Box<Expr>, otherwise: Box<Expr> },
    Assign { slot: usize, creates: bool, value: Box<Expr> },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Op {
    Or,
    And,
    Equal,
    Unequal,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Add,
    Subtract,
    Multiply,
    Divide,
    BitOr,
    BitXor,
    BitAnd,
    Join,
}

impl Op {
    /// Signs with what they do and how strongly they bind. `..` joins texts.
    const ALL: [(&'static str, Self, u8); 16] = [
        ("||", Self::Or, 1),
        ("&&", Self::And, 2),
        ("|", Self::BitOr, 3),
        ("^", Self::BitXor, 4),
        ("&", Self::BitAnd, 5),
        ("==", Self::Equal, 6),
        ("!=", Self::Unequal, 6),
        ("<=", Self::LessEqual, 7),
        (">=", Self::GreaterEqual, 7),
        ("<", Self::Less, 7),
        (">", Self::Greater, 7),
        ("..", Self::Join, 8),
        ("+", Self::Add, 9),
        ("-", Self::Subtract, 9),
        ("*", Self::Multiply, 10),
        ("/", Self::Divide, 10),
    ];
}

/// A script that has been read.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Script {
    statements: Vec<Expr>,
}

impl Script {
    /// Reads a script; `slot_of` gives the slot of a name.
    pub(crate) fn read(code: &str, slot_of: &mut dyn FnMut(&str) -> usize) -> Result<Self, ScriptFault> {
        let tokens = tokens(code)?;
        let mut reader = TokenReader { tokens: &tokens, at: 0, slot_of };
        let mut statements = Vec::new();
        loop {
            while reader.takes(";") {}
            if reader.is_done() {
                break;
            }
            statements.push(reader.statement()?);
            if !reader.is_done() && !reader.takes(";") {
                return Err(reader.stray());
            }
        }
        if statements.is_empty() { Err(ScriptFault::End) } else { Ok(Self { statements }) }
    }

    /// Runs it; the value is that of the last statement.
    pub(crate) fn run(&self, board: &mut [Option<Value>]) -> Result<Value, ScriptFault> {
        let mut last = Value::Number(0.0);
        for statement in &self.statements {
            last = evaluate(statement, board)?;
        }
        Ok(last)
    }
}

#[derive(Debug, Clone, PartialEq)]
enum Token {
    Name(String),
    Value(Value),
    Sign(&'static str),
}

/// Longer signs come before those they begin with.
const SIGNS: [&str; 29] = [
    ":=", "==", "!=", "<=", ">=", "&&", "||", "+=", "-=", "*=", "/=", "..", "=", "<", ">", "+", "-", "*", "/", "!",
    "~", "&", "|", "^", "?", ":", "(", ")", ";",
];

fn tokens(code: &str) -> Result<Vec<(Token, usize)>, ScriptFault> {
    let mut tokens = Vec::new();
    let mut rest = code;
    while let Some(first) = rest.chars().next() {
        let at = code.len() - rest.len();
        let token;
        let length;
        if first.is_whitespace() {
            rest = rest.trim_start();
            continue;
        } else if first == '\'' {
            let body = rest.get(1..).unwrap_or("");
            let end = body.find('\'').ok_or(ScriptFault::End)?;
            token = Token::Value(Value::of_text(body.get(..end).unwrap_or("")));
            length = end + 2;
        } else if first.is_ascii_digit() {
            length = number_length(rest);
            let text = rest.get(..length).unwrap_or("");
            let hex = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
            let number =
                hex.map_or_else(|| text.parse().ok(), |hex| i64::from_str_radix(hex, 16).ok().map(|n| n as f64));
            let number = number.ok_or_else(|| ScriptFault::Token { found: crate::xml::short_text(text), at })?;
            token = Token::Value(Value::Number(number));
        } else if first.is_alphabetic() || first == '_' {
            length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            token = match rest.get(..length).unwrap_or("") {
                "true" => Token::Value(Value::Number(1.0)),
                "false" => Token::Value(Value::Number(0.0)),
                name => Token::Name(name.to_owned()),
            };
        } else if let Some(sign) = SIGNS.iter().find(|sign| rest.starts_with(**sign)) {
            token = Token::Sign(sign);
            length = sign.len();
        } else {
            return Err(ScriptFault::Token { found: first.to_string(), at });
        }
        if tokens.len() >= MAX_TOKENS {
            return Err(ScriptFault::Long);
        }
        tokens.push((token, at));
        rest = rest.get(length..).unwrap_or("");
    }
    Ok(tokens)
}

/// Length of the number a text begins with: `12`, `0.5`, `1e-3`, `0xff`; `1..2` is two numbers.
fn number_length(text: &str) -> usize {
    if text.starts_with("0x") || text.starts_with("0X") {
        let digits = text.chars().skip(2).take_while(char::is_ascii_hexdigit).count();
        return 2 + digits;
    }
    let digits = |from: usize| text.chars().skip(from).take_while(char::is_ascii_digit).count();
    let mut length = digits(0);
    let rest = |length: usize| text.get(length..).unwrap_or("");
    if rest(length).starts_with('.') && !rest(length).starts_with("..") {
        length += 1 + digits(length + 1);
    }
    if rest(length).starts_with(['e', 'E']) {
        let sign = usize::from(rest(length + 1).starts_with(['+', '-']));
        let power = digits(length + 1 + sign);
        if power > 0 {
            length += 1 + sign + power;
        }
    }
    length
}

struct TokenReader<'a> {
    tokens: &'a [(Token, usize)],
    at: usize,
    slot_of: &'a mut dyn FnMut(&str) -> usize,
}

impl TokenReader<'_> {
    fn is_done(&self) -> bool {
        self.at >= self.tokens.len()
    }

    fn takes(&mut self, sign: &str) -> bool {
        let found = matches!(self.tokens.get(self.at), Some((Token::Sign(found), _)) if *found == sign);
        self.at += usize::from(found);
        found
    }

    fn stray(&self) -> ScriptFault {
        match self.tokens.get(self.at) {
            Some((token, at)) => {
                let found = match token {
                    Token::Name(name) => name.clone(),
                    Token::Value(value) => value.to_string(),
                    Token::Sign(sign) => (*sign).to_owned(),
                };
                ScriptFault::Token { found: crate::xml::short_text(&found), at: *at }
            }
            None => ScriptFault::End,
        }
    }

    fn statement(&mut self) -> Result<Expr, ScriptFault> {
        if let Some((Token::Name(name), _)) = self.tokens.get(self.at)
            && let Some((Token::Sign(sign @ (":=" | "=" | "+=" | "-=" | "*=" | "/=")), _)) =
                self.tokens.get(self.at + 1)
        {
            let slot = (self.slot_of)(name);
            self.at += 2;
            let value = self.choice(0)?;
            let changed = |op| Expr::Pair(op, Box::new(Expr::Entry(slot)), Box::new(value.clone()));
            let value = match *sign {
                "+=" => changed(Op::Add),
                "-=" => changed(Op::Subtract),
                "*=" => changed(Op::Multiply),
                "/=" => changed(Op::Divide),
                _ => value,
            };
            return Ok(Expr::Assign { slot, creates: *sign == ":=", value: Box::new(value) });
        }
        self.choice(0)
    }

    /// `condition ? value : other value`, or just a value.
    fn choice(&mut self, depth: usize) -> Result<Expr, ScriptFault> {
        let condition = self.pair(1, depth)?;
        if !self.takes("?") {
            return Ok(condition);
        }
        let holds = self.choice(depth + 1)?;
        if !self.takes(":") {
            return Err(self.stray());
        }
        let otherwise = self.choice(depth + 1)?;
        Ok(Expr::Choose { condition: Box::new(condition), holds: Box::new(holds), otherwise: Box::new(otherwise) })
    }

    /// Operators of this rank and above, left to right.
    fn pair(&mut self, rank: u8, depth: usize) -> Result<Expr, ScriptFault> {
        let mut left = self.single(depth)?;
        while let Some((op, its_rank)) = self.operator(rank) {
            self.at += 1;
            let right = self.pair(its_rank + 1, depth + 1)?;
            left = Expr::Pair(op, Box::new(left), Box::new(right));
        }
        Ok(left)
    }

    fn operator(&self, rank: u8) -> Option<(Op, u8)> {
        let (Token::Sign(sign), _) = self.tokens.get(self.at)? else { return None };
        let (_, op, its_rank) = Op::ALL.iter().find(|(text, _, _)| text == sign)?;
        (*its_rank >= rank).then_some((*op, *its_rank))
    }

    fn single(&mut self, depth: usize) -> Result<Expr, ScriptFault> {
        if depth > MAX_DEPTH {
            return Err(ScriptFault::Deep);
        }
        if self.takes("!") {
            return Ok(Expr::Not(Box::new(self.single(depth + 1)?)));
        }
        if self.takes("-") {
            return Ok(Expr::Minus(Box::new(self.single(depth + 1)?)));
        }
        if self.takes("~") {
            return Ok(Expr::Flip(Box::new(self.single(depth + 1)?)));
        }
        if self.takes("(") {
            let inner = self.choice(depth + 1)?;
            return if self.takes(")") { Ok(inner) } else { Err(self.stray()) };
        }
        let expr = match self.tokens.get(self.at) {
            Some((Token::Name(name), _)) => Expr::Entry((self.slot_of)(name)),
            Some((Token::Value(value), _)) => Expr::Value(value.clone()),
            Some((Token::Sign(_), _)) | None => return Err(self.stray()),
        };
        self.at += 1;
        Ok(expr)
    }
}

fn evaluate(expr: &Expr, board: &mut [Option<Value>]) -> Result<Value, ScriptFault> {
    Ok(match expr {
        Expr::Value(value) => value.clone(),
        Expr::Entry(slot) => board.get(*slot).cloned().flatten().ok_or(ScriptFault::Unset)?,
        Expr::Not(inner) => truth(!evaluate(inner, board)?.flag()),
        Expr::Minus(inner) => Value::Number(-number(&evaluate(inner, board)?)?),
        Expr::Flip(inner) => Value::Number(!bits(&evaluate(inner, board)?)? as f64),
        Expr::Choose { condition, holds, otherwise } => {
            let chosen = if evaluate(condition, board)?.flag() { holds } else { otherwise };
            evaluate(chosen, board)?
        }
        Expr::Pair(op, left, right) => {
            let left = evaluate(left, board)?;
            if (*op == Op::Or && left.flag()) || (*op == Op::And && !left.flag()) {
                return Ok(truth(*op == Op::Or));
            }
            combine(*op, &left, &evaluate(right, board)?)?
        }
        Expr::Assign { slot, creates, value } => {
            let value = evaluate(value, board)?;
            let entry = board.get_mut(*slot).ok_or(ScriptFault::Unset)?;
            if !creates && entry.is_none() {
                return Err(ScriptFault::Unset);
            }
            *entry = Some(value.clone());
            value
        }
    })
}

fn combine(op: Op, left: &Value, right: &Value) -> Result<Value, ScriptFault> {
    if left.is_text() && right.is_text() {
        // Two texts are compared and joined as texts, also where both read as numbers.
        let order = || left.to_string().cmp(&right.to_string());
        match op {
            Op::Less => return Ok(truth(order().is_lt())),
            Op::LessEqual => return Ok(truth(order().is_le())),
            Op::Greater => return Ok(truth(order().is_gt())),
            Op::GreaterEqual => return Ok(truth(order().is_ge())),
            Op::Add => return Ok(Value::of_text(&format!("{left}{right}"))),
            Op::Or
            | Op::And
            | Op::Equal
            | Op::Unequal
            | Op::Subtract
            | Op::Multiply
            | Op::Divide
            | Op::BitOr
            | Op::BitXor
            | Op::BitAnd
            | Op::Join => {}
        }
    }
    Ok(match op {
        Op::Or | Op::And => truth(right.flag()),
        Op::Equal => truth(equal(left, right)),
        Op::Unequal => truth(!equal(left, right)),
        Op::Less => truth(number(left)? < number(right)?),
        Op::LessEqual => truth(number(left)? <= number(right)?),
        Op::Greater => truth(number(left)? > number(right)?),
        Op::GreaterEqual => truth(number(left)? >= number(right)?),
        Op::Add => Value::Number(number(left)? + number(right)?),
        Op::Subtract => Value::Number(number(left)? - number(right)?),
        Op::Multiply => Value::Number(number(left)? * number(right)?),
        Op::Divide => Value::Number(number(left)? / number(right)?),
        Op::BitOr => Value::Number((bits(left)? | bits(right)?) as f64),
        Op::BitXor => Value::Number((bits(left)? ^ bits(right)?) as f64),
        Op::BitAnd => Value::Number((bits(left)? & bits(right)?) as f64),
        Op::Join => Value::of_text(&format!("{left}{right}")),
    })
}

/// Two texts are compared as texts; with a number on either side both must be numbers.
fn equal(left: &Value, right: &Value) -> bool {
    if left.is_text() && right.is_text() {
        return left.same_text(right);
    }
    match (left.number(), right.number()) {
        (Some(a), Some(b)) => (a - b).abs() <= f64::EPSILON,
        (Some(_) | None, _) => false,
    }
}

fn number(value: &Value) -> Result<f64, ScriptFault> {
    value.number().ok_or(ScriptFault::Number)
}

/// A number as a whole one; parts of one are cut off.
fn bits(value: &Value) -> Result<i64, ScriptFault> {
    Ok(number(value)? as i64)
}

fn truth(holds: bool) -> Value {
    Value::Number(if holds { 1.0 } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn result(code: &str) -> Result<Value, ScriptFault> {
        let mut names: Vec<String> = Vec::new();
        let script = Script::read(code, &mut |name| {
            names.iter().position(|known| known == name).unwrap_or_else(|| {
                names.push(name.to_owned());
                names.len() - 1
            })
        })?;
        script.run(&mut vec![None; names.len()])
    }

    #[test]
    fn products_come_before_sums_and_sums_before_comparisons() {
        assert_eq!(result("1 + 2 * 3 == 7").unwrap(), Value::Number(1.0));
        assert_eq!(result("(1 + 2) * 3 - 1 - 1").unwrap(), Value::Number(7.0));
        assert_eq!(result("n := 1; n = n + 1; n > 1 && !(n >= 3)").unwrap(), Value::Number(1.0));
    }

    #[test]
    fn choices_changes_and_bits_are_computed() {
        assert_eq!(result("n := 3; n += 2; n *= 4; n -= 1; n /= 19; n == 1 ? 10 : 20").unwrap(), Value::Number(10.0));
        assert_eq!(result("a := false; a ? 1 : (a || true) ? 2 : 3").unwrap(), Value::Number(2.0));
        assert_eq!(result("6 & 3 | 8").unwrap(), Value::Number(10.0));
        assert_eq!(result("5 ^ 1").unwrap(), Value::Number(4.0));
        assert_eq!(result("~0").unwrap(), Value::Number(-1.0));
        assert!(result("0x1F + 1e1 + .5 * 2").is_err());
        assert_eq!(result("0x1F + 1e1 + 0.5 * 2").unwrap(), Value::Number(42.0));
        assert_eq!(result("'a' .. 'b' .. 1 == 'ab1'").unwrap(), Value::Number(1.0));
        assert_eq!(result("'a' + 'b' == 'ab' && 'abc' < 'abd' && '10' < '9' && '10' > 9").unwrap(), Value::Number(1.0));
    }

    #[test]
    fn an_entry_must_be_created_first() {
        assert_eq!(result("x = 1"), Err(ScriptFault::Unset));
        assert_eq!(result("x := 'a'; x == 'a'").unwrap(), Value::Number(1.0));
    }

    #[test]
    fn nonsense_is_refused_and_never_runs_away() {
        for code in ["", "x :=", "1 +", "'open", "(1", "x $ y", "1 2", ";"] {
            assert!(result(code).is_err(), "{code}");
        }
        assert_eq!(result(&"(".repeat(500)), Err(ScriptFault::Deep));
        assert_eq!(result(&"!".repeat(500)), Err(ScriptFault::Deep));
        assert_eq!(result(&"1+".repeat(500_000)), Err(ScriptFault::Long));
    }
}
