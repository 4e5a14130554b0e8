//! Functions drawn as boxes to numbers and comparisons.
//!
//! What a function computes, and when, differs from tool to tool where types mix, where EN is FALSE or
//! where one box feeds several others. So only this is understood: the operands are constants and
//! variables of one integer type, which is also that of what takes the result; EN comes from the rail or
//! is not connected; one line or one assigned pin uses the result. Then a box is no more than an
//! expression that is evaluated where it is used.

use super::Problem;
use super::body::{Body, describe};
use super::flow::{exact, in_variable, pins, plain};
use super::program::{Context, broken};
use super::st::{self, Value};
use super::xml::{self, Family, Node};
use crate::base::Code;
use crate::ir::expr::Expr;
use crate::ir::iec::{Atom, Kind, Number, Relation, Statement, VarId};

/// What a function gives.
pub struct Function {
    /// Its result.
    pub value: Value,
    /// The type of its operands; nothing if all are constants.
    kind: Option<Kind>,
    constants: Vec<i64>,
}

/// An operand of a function.
enum Operand {
    Number(Number, Option<Kind>),
    Bool(VarId),
}

/// The functions that are understood.
const KNOWN: [&str; 11] = ["ADD", "EQ", "GE", "GT", "LE", "LIMIT", "LT", "MOVE", "NE", "SEL", "SUB"];

/// Whether that is the name of a function that is understood.
pub fn is_known(name: &str) -> bool {
    KNOWN.iter().any(|known| name.eq_ignore_ascii_case(known))
}

/// Whether a box is a function, not an instance of a function block.
pub fn is_function(node: Node<'_>) -> bool {
    xml::is(node, "block") && xml::attribute(node, "instanceName").is_none()
}

/// Reads the function that stands at `node`.
pub fn read<'a>(node: Node<'a>, body: &Body<'a>, cx: &Context<'_, '_>) -> Result<Function, Problem> {
    let refuse = |what: String| Err(xml::not_understood(what, node));
    if pins(node, "inOutVariables").next().is_some() {
        return refuse(format!("the in-out variables of {}", describe(node)));
    }
    for pin in pins(node, "outputVariables").filter(|pin| !results(node).contains(pin)) {
        plain(pin, "ENO")?;
    }
    let mut operands = Vec::new();
    let mut names = Vec::new();
    let mut enabled = 0;
    for pin in pins(node, "inputVariables") {
        let name = xml::required(pin, "formalParameter")?;
        plain(pin, "an operand")?;
        if name.eq_ignore_ascii_case("EN") {
            always(pin, node, body)?;
            enabled = 1;
        } else {
            names.push(name);
            operands.push(operand(pin, node, body, cx)?);
        }
    }
    let function = xml::required(node, "typeName")?;
    exact(function, node, cx)?;
    let function = function.to_ascii_uppercase();
    let relation = |r| (&["IN1", "IN2"][..], Some(r));
    let (expected, relation) = match function.as_str() {
        "MOVE" => (&["IN"][..], None),
        "ADD" | "SUB" => (&["IN1", "IN2"][..], None),
        "LIMIT" => (&["MN", "IN", "MX"][..], None),
        "SEL" => (&["G", "IN0", "IN1"][..], None),
        "EQ" => relation(Relation::Equal),
        "NE" => relation(Relation::Unequal),
        "LT" => relation(Relation::Less),
        "LE" => relation(Relation::LessOrEqual),
        "GT" => relation(Relation::Greater),
        "GE" => relation(Relation::GreaterOrEqual),
        _ => return refuse(format!("the function {}", describe(node))),
    };
    // All by the names of the standard, or in CODESYS all by their places, with EN or without it.
    let exactly = cx.family == Family::Beremiz;
    let is = |name: &str, expected: &str| if exactly { name == expected } else { name.eq_ignore_ascii_case(expected) };
    let named = names.iter().zip(expected).all(|(name, expected)| is(name, expected));
    let mut places = (1 + enabled..).zip(&names);
    let placed = !exactly && places.all(|(place, name)| name.eq_ignore_ascii_case(&format!("In{place}")));
    if names.len() != expected.len() || !(named || placed) {
        return refuse(format!("the inputs {} of {}", names.join(", "), describe(node)));
    }

    let mut by = None;
    let mut numbers = Vec::new();
    let (mut kind, mut constants) = (None, Vec::new());
    for (place, operand) in operands.into_iter().enumerate() {
        match operand {
            Operand::Bool(variable) if function == "SEL" && place == 0 => by = Some(variable),
            Operand::Number(number, of) if function != "SEL" || place > 0 => {
                if of.is_some() && kind.is_some() && of != kind {
                    return refuse(format!("operands of different types at {}", describe(node)));
                }
                kind = kind.or(of);
                if let Number::Const(n) = number {
                    constants.push(n);
                }
                numbers.push(number);
            }
            _ => return refuse(format!("the type of an operand of {}", describe(node))),
        }
    }
    let mut numbers = numbers.into_iter();
    let mut next = || numbers.next().map(Box::new).ok_or_else(|| xml::not_understood(describe(node), node));
    let value = match (function.as_str(), relation, by) {
        (_, Some(relation), _) => Value::Bool(Expr::Atom(Atom::Compare(relation, *next()?, *next()?))),
        ("ADD", ..) => Value::Int(Number::Sum(next()?, next()?)),
        ("SUB", ..) => Value::Int(Number::Difference(next()?, next()?)),
        ("LIMIT", ..) => {
            let (lowest, value, highest) = (next()?, next()?, next()?);
            let (Number::Const(lowest), Number::Const(highest)) = (*lowest, *highest) else {
                return refuse(format!("bounds that are no constants at {}", describe(node)));
            };
            if lowest > highest {
                return refuse(format!("bounds in the wrong order at {}", describe(node)));
            }
            Value::Int(Number::Limit { lowest, value, highest })
        }
        ("SEL", _, Some(by)) => Value::Int(Number::Select { by, no: next()?, yes: next()? }),
        _ => Value::Int(*next()?),
    };
    let function = Function { value, kind, constants };
    match kind {
        Some(kind) if !function.holds(kind) => refuse(format!("a constant of another type at {}", describe(node))),
        None if relation.is_some() => refuse(format!("{}, which compares constants", describe(node))),
        _ => Ok(function),
    }
}

impl Function {
    /// Whether all constants are of that type.
    fn holds(&self, kind: Kind) -> bool {
        matches!(kind, Kind::Int { .. }) && self.constants.iter().all(|&n| kind.holds(n))
    }

    /// The statement that assigns the result to the variable that a text at `node` names.
    pub fn assign(self, name: &str, node: Node<'_>, cx: &Context<'_, '_>) -> Result<Statement, Problem> {
        let path: Vec<&str> = name.trim().split('.').collect();
        let (_, kind) = st::writable(&path, &cx.scope).map_err(|f| broken(f, name, node))?;
        if let Value::Int(_) = self.value
            && (!self.holds(kind) || self.kind.is_some_and(|own| own != kind))
        {
            let message = format!("the result of {}, which is of another type than `{}`,", describe(node), name.trim());
            return Err(xml::not_understood(message, node));
        }
        st::assignment(&path, self.value, &cx.scope).map_err(|f| broken(f, name, node))
    }
}

/// Fails unless a pin EN is connected to the rail alone, or to nothing.
fn always<'a>(pin: Node<'a>, node: Node<'a>, body: &Body<'a>) -> Result<(), Problem> {
    let lines = body.lines(pin)?;
    let text = xml::child(pin, "connectionPointIn").and_then(|p| xml::child(p, "expression"));
    if text.is_none() && lines.iter().all(|line| xml::is(body.elements[line.from], "leftPowerRail")) {
        return Ok(());
    }
    Err(xml::not_understood(format!("{} with a condition at EN", describe(node)), node))
}

/// What comes to a pin: a constant or a variable.
fn operand<'a>(pin: Node<'a>, node: Node<'a>, body: &Body<'a>, cx: &Context<'_, '_>) -> Result<Operand, Problem> {
    let text = xml::child(pin, "connectionPointIn").and_then(|p| xml::child(p, "expression"));
    let lines = body.lines(pin)?;
    let value = match (text, lines.as_slice()) {
        (Some(text), []) => cx.expression(&xml::text(text), pin)?.0,
        (None, [line]) if xml::is(body.elements[line.from], "inVariable") => {
            in_variable(body.elements[line.from], cx)?.0
        }
        (None, []) => {
            let message = format!("a pin of {} is connected to nothing", describe(node));
            return Err(xml::problem(Code::Unconnected, message, pin));
        }
        _ => return Err(xml::not_understood(format!("what feeds {}", describe(node)), node)),
    };
    match value {
        Value::Int(number @ Number::Const(_)) => Ok(Operand::Number(number, None)),
        Value::Int(Number::Variable(id)) => Ok(Operand::Number(Number::Variable(id), Some(cx.kind(id)))),
        Value::Bool(Expr::Atom(Atom::Variable(id))) => Ok(Operand::Bool(id)),
        _ => Err(xml::not_understood(format!("an expression at {}", describe(node)), node)),
    }
}

/// The output pins other than ENO.
pub fn results<'a>(node: Node<'a>) -> Vec<Node<'a>> {
    let enables =
        |pin: &Node<'a>| xml::attribute(*pin, "formalParameter").is_some_and(|p| p.eq_ignore_ascii_case("ENO"));
    pins(node, "outputVariables").filter(|pin| !enables(pin)).collect()
}
