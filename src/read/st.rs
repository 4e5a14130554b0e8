//! Structured text to expressions and statements, names resolved and types checked.
//!
//! What is taken: the operators of IEC 61131-3 table 55 over BOOL, integers and TIME, without
//! multiplication and what binds tighter; assignments; calls of function blocks by name.
//!
//! Only parentheses and chains that lean to one side make an expression deep, and [`DEPTH`] bounds
//! both, so that whoever walks an expression later may recurse.

use super::scope::{Meaning, Scope};
use super::token::{Token, tokens};
use crate::base::{Arena, Code};
use crate::ir::expr::Expr;
use crate::ir::iec::{
    Atom, Block, BlockId, BlockKind, Bool, Call, Coil, CoilKind, Condition, Kind, Number, Relation, Statement, VarId,
};

/// Deepest expression.
pub const DEPTH: usize = 128;

const OPERATORS: [&str; 5] = ["AND", "MOD", "NOT", "OR", "XOR"];

/// What is wrong with a text.
pub struct Fail {
    /// Which kind of problem.
    pub code: Code,
    /// What is the case.
    pub message: String,
}

/// A value of any type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// BOOL.
    Bool(Bool),
    /// Any of the integer types.
    Int(Number),
    /// TIME.
    Time(Number),
}

/// How strongly the outermost operator of an expression binds, as far as ladder has to know.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Binding {
    /// OR or XOR: it may not stand in a series without parentheses.
    Loose,
    /// Anything else.
    Tight,
}

impl Value {
    /// The value as BOOL; the literals 0 and 1 are.
    pub fn bool(self) -> Option<Bool> {
        match self {
            Value::Bool(b) => Some(b),
            Value::Int(Number::Const(n @ (0 | 1))) => Some(Expr::Const(n == 1)),
            Value::Int(_) | Value::Time(_) => None,
        }
    }

    fn type_name(&self) -> &'static str {
        match self {
            Value::Bool(_) => "BOOL",
            Value::Int(_) => "an integer",
            Value::Time(_) => "TIME",
        }
    }
}

/// An expression.
pub fn expression(text: &str, scope: &Scope<'_>, blocks: &Arena<Block>) -> Result<(Value, Binding), Fail> {
    let mut parser = Parser::new(text, scope, blocks)?;
    let value = parser.expression()?;
    if parser.next < parser.tokens.len() {
        return Err(parser.unexpected("the end"));
    }
    Ok((value.value, value.binding))
}

/// A list of statements.
pub fn statements(text: &str, scope: &Scope<'_>, blocks: &Arena<Block>) -> Result<Vec<Statement>, Fail> {
    let mut parser = Parser::new(text, scope, blocks)?;
    let mut list = Vec::new();
    while parser.next < parser.tokens.len() {
        if !parser.eat(";") {
            parser.statement(&mut list)?;
        }
    }
    Ok(list)
}

/// The body of a named transition: `:= expression;`, with or without the name before and the signs
/// around it.
pub fn transition_body(text: &str, scope: &Scope<'_>, blocks: &Arena<Block>) -> Result<Value, Fail> {
    let mut parser = Parser::new(text, scope, blocks)?;
    if let [Token::Word(_), Token::Sign(":="), ..] = parser.tokens[..] {
        parser.next += 1;
    }
    parser.eat(":=");
    let value = parser.expression()?;
    parser.eat(";");
    if parser.next < parser.tokens.len() {
        return Err(parser.unexpected("the end"));
    }
    Ok(value.value)
}

/// The statement that assigns `value` to the variable or pin that a path means.
pub fn assignment(path: &[&str], value: Value, scope: &Scope<'_>) -> Result<Statement, Fail> {
    let (variable, kind) = writable(path, scope)?;
    let mismatch = |value: &Value, kind: &str| {
        fail(Code::BrokenText, format!("`{}` is {kind} and cannot take {}", path.join("."), value.type_name()))
    };
    match (kind, value) {
        (Kind::Bool, value) => match value.clone().bool() {
            Some(condition) => {
                Ok(Statement::Coil(Coil { condition: Condition::simple(condition), variable, kind: CoilKind::Plain }))
            }
            None => Err(mismatch(&value, "BOOL")),
        },
        (Kind::Int { .. }, Value::Int(value)) | (Kind::Time, Value::Time(value)) => {
            Ok(Statement::Move { to: variable, value })
        }
        (Kind::Int { .. }, value) => Err(mismatch(&value, "an integer")),
        (Kind::Time, value) => Err(mismatch(&value, "TIME")),
    }
}

/// A variable that may be written.
pub fn writable(path: &[&str], scope: &Scope<'_>) -> Result<(VarId, Kind), Fail> {
    match find(path, scope)? {
        Meaning::Variable(id, kind) => Ok((id, kind)),
        Meaning::StepFlag(_) | Meaning::StepTime(_) | Meaning::Block(_) | Meaning::Pin(..) | Meaning::Other(_) => {
            Err(fail(Code::NotUnderstood, format!("writing to `{}` is not understood", path.join("."))))
        }
    }
}

/// The value that a path of names means.
pub fn named(path: &[&str], scope: &Scope<'_>, blocks: &Arena<Block>) -> Result<Value, Fail> {
    let name = || path.join(".");
    match find(path, scope)? {
        Meaning::Variable(id, Kind::Bool) => Ok(Value::Bool(Expr::Atom(Atom::Variable(id)))),
        Meaning::Variable(id, Kind::Int { .. }) => Ok(Value::Int(Number::Variable(id))),
        Meaning::Variable(id, Kind::Time) => Ok(Value::Time(Number::Variable(id))),
        Meaning::StepFlag(step) => Ok(Value::Bool(Expr::Atom(Atom::Step(step)))),
        Meaning::StepTime(step) => Ok(Value::Time(Number::StepTime(step))),
        Meaning::Block(_) => Err(fail(Code::BrokenText, format!("`{}` is a function block and has no value", name()))),
        Meaning::Pin(block, pin) => output(block, &pin, blocks)
            .ok_or_else(|| fail(Code::NotUnderstood, format!("reading `{}` is not understood", name()))),
        Meaning::Other(what) => {
            Err(fail(Code::NotUnderstood, format!("`{}` is of type {what}, which is not understood", name())))
        }
    }
}

fn find(path: &[&str], scope: &Scope<'_>) -> Result<Meaning, Fail> {
    scope.find(path).ok_or_else(|| fail(Code::Undeclared, format!("`{}` is not declared", path.join("."))))
}

/// An output of a function block, named without regard to case.
pub fn output(block: BlockId, pin: &str, blocks: &Arena<Block>) -> Option<Value> {
    let pin = pin.to_ascii_uppercase();
    match (blocks[block].kind, pin.as_str()) {
        (BlockKind::Ton | BlockKind::Tof | BlockKind::Tp | BlockKind::RTrig | BlockKind::FTrig, "Q")
        | (BlockKind::Sr | BlockKind::Rs, "Q1") => Some(Value::Bool(Expr::Atom(Atom::Output(block)))),
        (BlockKind::Ton | BlockKind::Tof | BlockKind::Tp, "ET") => Some(Value::Time(Number::Elapsed(block))),
        _ => None,
    }
}

/// What an input of a function block is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pin {
    /// [`Call::input`].
    Input,
    /// [`Call::reset`].
    Reset,
    /// [`Call::preset`].
    Preset,
}

/// An input of a function block, named without regard to case, by the standard or by CODESYS.
pub fn input(kind: BlockKind, pin: &str) -> Option<Pin> {
    match (kind, pin.to_ascii_uppercase().as_str()) {
        (BlockKind::Ton | BlockKind::Tof | BlockKind::Tp, "IN")
        | (BlockKind::RTrig | BlockKind::FTrig, "CLK")
        | (BlockKind::Sr, "S1" | "SET1")
        | (BlockKind::Rs, "S" | "SET") => Some(Pin::Input),
        (BlockKind::Sr, "R" | "RESET") | (BlockKind::Rs, "R1" | "RESET1") => Some(Pin::Reset),
        (BlockKind::Ton | BlockKind::Tof | BlockKind::Tp, "PT") => Some(Pin::Preset),
        _ => None,
    }
}

fn fail(code: Code, message: impl Into<String>) -> Fail {
    Fail { code, message: message.into() }
}

/// A value under construction.
struct Built {
    value: Value,
    depth: usize,
    binding: Binding,
}

struct Parser<'s, 'g> {
    tokens: Vec<Token>,
    next: usize,
    open: usize,
    scope: &'s Scope<'g>,
    blocks: &'s Arena<Block>,
}

impl<'s, 'g> Parser<'s, 'g> {
    fn new(text: &str, scope: &'s Scope<'g>, blocks: &'s Arena<Block>) -> Result<Self, Fail> {
        let tokens = tokens(text).map_err(|message| fail(Code::BrokenText, message))?;
        Ok(Parser { tokens, next: 0, open: 0, scope, blocks })
    }

    fn eat(&mut self, sign: &str) -> bool {
        let found = matches!(self.tokens.get(self.next), Some(Token::Sign(s)) if *s == sign);
        self.next += usize::from(found);
        found
    }

    fn eat_word(&mut self, word: &str) -> bool {
        let found = matches!(self.tokens.get(self.next), Some(Token::Word(w)) if w.eq_ignore_ascii_case(word));
        self.next += usize::from(found);
        found
    }

    fn expect(&mut self, sign: &str) -> Result<(), Fail> {
        if self.eat(sign) { Ok(()) } else { Err(self.unexpected(&format!("`{sign}`"))) }
    }

    fn unexpected(&self, expected: &str) -> Fail {
        let found = match self.tokens.get(self.next) {
            None => "the text ends".to_owned(),
            Some(Token::Word(w)) => format!("`{w}` stands"),
            Some(Token::Bool(b)) => format!("`{}` stands", if *b { "TRUE" } else { "FALSE" }),
            Some(Token::Int(n)) => format!("`{n}` stands"),
            Some(Token::Time(_)) => "a duration stands".to_owned(),
            Some(Token::Sign(s)) => format!("`{s}` stands"),
        };
        fail(Code::BrokenText, format!("{found} where {expected} is expected"))
    }

    fn expression(&mut self) -> Result<Built, Fail> {
        let first = self.exclusive()?;
        if !self.eat_word("OR") {
            return Ok(first);
        }
        let mut depth = first.depth;
        let mut operands = vec![self.truth(first.value, "OR")?];
        loop {
            let next = self.exclusive()?;
            depth = depth.max(next.depth);
            operands.push(self.truth(next.value, "OR")?);
            if !self.eat_word("OR") {
                break;
            }
        }
        built(Value::Bool(Expr::any(operands)), depth + 1, Binding::Loose)
    }

    fn exclusive(&mut self) -> Result<Built, Fail> {
        let mut left = self.conjunction()?;
        while self.eat_word("XOR") {
            let right = self.conjunction()?;
            let depth = left.depth.max(right.depth) + 1;
            let value = Expr::xor(self.truth(left.value, "XOR")?, self.truth(right.value, "XOR")?);
            left = built(Value::Bool(value), depth, Binding::Loose)?;
        }
        Ok(left)
    }

    fn conjunction(&mut self) -> Result<Built, Fail> {
        let first = self.equality()?;
        if !(self.eat_word("AND") || self.eat("&")) {
            return Ok(first);
        }
        let mut depth = first.depth;
        let mut operands = vec![self.truth(first.value, "AND")?];
        loop {
            let next = self.equality()?;
            depth = depth.max(next.depth);
            operands.push(self.truth(next.value, "AND")?);
            if !(self.eat_word("AND") || self.eat("&")) {
                break;
            }
        }
        built(Value::Bool(Expr::all(operands)), depth + 1, Binding::Tight)
    }

    fn equality(&mut self) -> Result<Built, Fail> {
        let mut left = self.relation()?;
        loop {
            let comparison = if self.eat("=") {
                Relation::Equal
            } else if self.eat("<>") {
                Relation::Unequal
            } else {
                return Ok(left);
            };
            let right = self.relation()?;
            left = self.compare(comparison, left, right)?;
        }
    }

    fn relation(&mut self) -> Result<Built, Fail> {
        let mut left = self.sum()?;
        loop {
            let comparison = if self.eat("<") {
                Relation::Less
            } else if self.eat("<=") {
                Relation::LessOrEqual
            } else if self.eat(">") {
                Relation::Greater
            } else if self.eat(">=") {
                Relation::GreaterOrEqual
            } else {
                return Ok(left);
            };
            let right = self.sum()?;
            left = self.compare(comparison, left, right)?;
        }
    }

    fn compare(&self, comparison: Relation, left: Built, right: Built) -> Result<Built, Fail> {
        let depth = left.depth.max(right.depth) + 2;
        let value = match (left.value, right.value) {
            (Value::Int(l), Value::Int(r)) | (Value::Time(l), Value::Time(r)) => {
                Expr::Atom(Atom::Compare(comparison, l, r))
            }
            (left, right) => {
                let types = (left.type_name(), right.type_name());
                match (comparison, left.bool(), right.bool()) {
                    (Relation::Equal, Some(l), Some(r)) => Expr::xor(l, r).not(),
                    (Relation::Unequal, Some(l), Some(r)) => Expr::xor(l, r),
                    _ => {
                        let message = format!("{} and {} cannot be compared so", types.0, types.1);
                        return Err(fail(Code::BrokenText, message));
                    }
                }
            }
        };
        built(Value::Bool(value), depth, Binding::Tight)
    }

    fn sum(&mut self) -> Result<Built, Fail> {
        let mut left = self.unary()?;
        loop {
            let plus = if self.eat("+") {
                true
            } else if self.eat("-") {
                false
            } else if let Some(Token::Sign(sign @ ("*" | "/" | "**"))) = self.tokens.get(self.next) {
                return Err(fail(Code::NotUnderstood, format!("the operator `{sign}` is not understood")));
            } else if self.eat_word("MOD") {
                return Err(fail(Code::NotUnderstood, "the operator `MOD` is not understood"));
            } else {
                return Ok(left);
            };
            let right = self.unary()?;
            let depth = left.depth.max(right.depth) + 1;
            let join = |l, r| {
                let (l, r) = (Box::new(l), Box::new(r));
                if plus { Number::Sum(l, r) } else { Number::Difference(l, r) }
            };
            let value = match (left.value, right.value) {
                (Value::Int(l), Value::Int(r)) => Value::Int(join(l, r)),
                (Value::Time(l), Value::Time(r)) => Value::Time(join(l, r)),
                (l, r) => {
                    let message = format!("{} and {} cannot be added or subtracted", l.type_name(), r.type_name());
                    return Err(fail(Code::BrokenText, message));
                }
            };
            left = built(value, depth, Binding::Tight)?;
        }
    }

    fn unary(&mut self) -> Result<Built, Fail> {
        let (mut nots, mut minus, mut any_sign) = (0_usize, false, false);
        loop {
            if !any_sign && self.eat_word("NOT") {
                nots += 1;
            } else if self.eat("-") {
                (minus, any_sign) = (!minus, true);
            } else if self.eat("+") {
                any_sign = true;
            } else {
                break;
            }
        }
        let mut operand = self.primary()?;
        if any_sign {
            let negative = |n| match n {
                Number::Const(n) => Number::Const(n.wrapping_neg()),
                n => Number::Negative(Box::new(n)),
            };
            operand.value = match operand.value {
                Value::Int(n) if minus => Value::Int(negative(n)),
                Value::Time(n) if minus => Value::Time(negative(n)),
                Value::Bool(_) => return Err(fail(Code::BrokenText, "BOOL has no sign")),
                value => value,
            };
            operand.depth += 1;
        }
        if nots > 0 {
            let truth = self.truth(operand.value, "NOT")?;
            operand.value = Value::Bool(if nots % 2 == 1 { truth.not() } else { truth });
            operand.depth += 1;
            operand.binding = Binding::Tight;
        }
        built(operand.value, operand.depth, operand.binding)
    }

    fn primary(&mut self) -> Result<Built, Fail> {
        let value = match self.tokens.get(self.next) {
            Some(Token::Bool(b)) => Value::Bool(Expr::Const(*b)),
            Some(Token::Int(n)) => Value::Int(Number::Const(*n)),
            Some(Token::Time(t)) => Value::Time(Number::Const(*t)),
            Some(Token::Sign("(")) => {
                self.next += 1;
                self.open += 1;
                if self.open > crate::base::limits::NESTING {
                    return Err(fail(Code::BrokenText, "parentheses are nested too deep"));
                }
                let mut inner = self.expression()?;
                self.expect(")")?;
                self.open -= 1;
                inner.binding = Binding::Tight;
                return Ok(inner);
            }
            Some(Token::Word(word)) if !OPERATORS.iter().any(|o| word.eq_ignore_ascii_case(o)) => {
                let path = self.path()?;
                if self.followed_by_sign_now("(") {
                    let message = format!("the function `{}` is not understood", path.join("."));
                    return Err(fail(Code::NotUnderstood, message));
                }
                let path: Vec<&str> = path.iter().map(String::as_str).collect();
                return built(named(&path, self.scope, self.blocks)?, 1, Binding::Tight);
            }
            Some(Token::Word(_) | Token::Sign(_)) | None => return Err(self.unexpected("a value")),
        };
        self.next += 1;
        built(value, 1, Binding::Tight)
    }

    fn followed_by(&self, sign: &str) -> bool {
        matches!(self.tokens.get(self.next + 1), Some(Token::Sign(s)) if *s == sign)
    }

    fn followed_by_sign_now(&self, sign: &str) -> bool {
        matches!(self.tokens.get(self.next), Some(Token::Sign(s)) if *s == sign)
    }

    fn path(&mut self) -> Result<Vec<String>, Fail> {
        let mut path = Vec::new();
        loop {
            match self.tokens.get(self.next) {
                Some(Token::Word(word)) => path.push(word.clone()),
                _ => return Err(self.unexpected("a name")),
            }
            self.next += 1;
            if !self.eat(".") {
                return Ok(path);
            }
        }
    }

    fn truth(&self, value: Value, operator: &str) -> Result<Bool, Fail> {
        let kind = value.type_name();
        value.bool().ok_or_else(|| fail(Code::BrokenText, format!("{operator} needs BOOL, this is {kind}")))
    }

    fn statement(&mut self, list: &mut Vec<Statement>) -> Result<(), Fail> {
        if let Some(Token::Word(word)) = self.tokens.get(self.next)
            && !self.followed_by(":=")
            && !self.followed_by("(")
            && !self.followed_by(".")
        {
            return Err(fail(
                Code::NotUnderstood,
                format!("the statement that begins with `{word}` is not understood"),
            ));
        }
        let path = self.path()?;
        let path: Vec<&str> = path.iter().map(String::as_str).collect();
        if self.eat("(") {
            self.call(&path, list)?;
        } else {
            self.expect(":=")?;
            let value = self.expression()?.value;
            list.push(assignment(&path, value, self.scope)?);
        }
        self.expect(";")
    }

    fn call(&mut self, path: &[&str], list: &mut Vec<Statement>) -> Result<(), Fail> {
        let Meaning::Block(block) = find(path, self.scope)? else {
            return Err(fail(Code::NotUnderstood, format!("the call of `{}` is not understood", path.join("."))));
        };
        let kind = self.blocks[block].kind;
        let mut call = Call { block, input: None, reset: None, preset: None };
        let mut outputs = Vec::new();
        if !self.eat(")") {
            loop {
                let parameter = self.path()?.join(".");
                if self.eat("=>") {
                    let target = self.path()?;
                    let value = output(block, &parameter, self.blocks);
                    let value = value.ok_or_else(|| no_pin(path, &parameter))?;
                    let target: Vec<&str> = target.iter().map(String::as_str).collect();
                    outputs.push(assignment(&target, value, self.scope)?);
                } else {
                    self.expect(":=")?;
                    let value = self.expression()?.value;
                    let pin = input(kind, &parameter).ok_or_else(|| no_pin(path, &parameter))?;
                    give(&mut call, pin, value)?;
                }
                if !self.eat(",") {
                    self.expect(")")?;
                    break;
                }
            }
        }
        list.push(Statement::Call(call));
        list.append(&mut outputs);
        Ok(())
    }
}

fn no_pin(path: &[&str], parameter: &str) -> Fail {
    fail(Code::Undeclared, format!("`{}` has no parameter `{parameter}`", path.join(".")))
}

/// Connects an input of a call.
pub fn give(call: &mut Call, pin: Pin, value: Value) -> Result<(), Fail> {
    let kind = value.type_name();
    let wrong = |expected: &str| fail(Code::BrokenText, format!("an input of type {expected} is given {kind}"));
    match pin {
        Pin::Input | Pin::Reset => {
            let condition = Condition::simple(value.bool().ok_or_else(|| wrong("BOOL"))?);
            let place = if pin == Pin::Input { &mut call.input } else { &mut call.reset };
            *place = Some(condition);
        }
        Pin::Preset => match value {
            Value::Time(n) => call.preset = Some(n),
            Value::Bool(_) | Value::Int(_) => return Err(wrong("TIME")),
        },
    }
    Ok(())
}

fn built(value: Value, depth: usize, binding: Binding) -> Result<Built, Fail> {
    if depth > DEPTH {
        return Err(fail(Code::BrokenText, "the expression is nested too deep"));
    }
    Ok(Built { value, depth, binding })
}
