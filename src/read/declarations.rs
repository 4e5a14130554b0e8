//! Lists of variables to variables, blocks and names.

use super::Problem;
use super::literal;
use super::scope::{Globals, Names, Symbol};
use super::token::{Token, tokens};
use super::xml::{self, Node};
use crate::base::iec::fold;
use crate::base::{Code, Diagnostics};
use crate::ir::iec::{Block, BlockKind, Kind, Project, Scope, Variable};
use std::collections::BTreeMap;

/// What a type is good for.
enum Type {
    Value(Kind),
    Block(BlockKind),
    Other(String),
}

/// Whether that is the name of a type that is understood.
pub fn is_known(name: &str) -> bool {
    !matches!(type_named(name), Type::Other(_))
}

/// The function blocks of that type, if it is understood.
pub fn block_named(name: &str) -> Option<BlockKind> {
    match type_named(name) {
        Type::Block(kind) => Some(kind),
        Type::Value(_) | Type::Other(_) => None,
    }
}

/// Declares the variables of one list.
pub fn declare(list: Node<'_>, scope: Scope, names: &mut Names, project: &mut Project, problems: &mut Diagnostics) {
    for node in xml::children_named(list, "variable") {
        if let Err(problem) = variable(node, scope, names, project) {
            problems.push(problem);
        }
    }
}

/// The compiler behind Beremiz fails at an address in small letters.
pub fn small_letters(list: Node<'_>, problems: &mut Diagnostics) {
    for node in xml::children_named(list, "variable") {
        let address = xml::attribute(node, "address").unwrap_or_default();
        if address.chars().any(|c| c.is_ascii_lowercase()) {
            problems.push(xml::not_understood(format!("the address {address} in small letters"), node));
        }
    }
}

/// Beremiz loses the address of a variable that stands behind one without; `unlocated` is the first of those.
pub fn located_first<'a>(list: Node<'a>, unlocated: &mut Option<&'a str>, problems: &mut Diagnostics) {
    for node in xml::children_named(list, "variable") {
        let name = xml::attribute(node, "name").unwrap_or_default();
        match (xml::attribute(node, "address"), *unlocated) {
            (None, None) => *unlocated = Some(name),
            (Some(address), Some(first)) => {
                let what =
                    format!("the address {address} of `{name}`, which stands behind `{first}`, a variable without,");
                problems.push(xml::not_understood(what, node));
            }
            (None, Some(_)) | (Some(_), None) => {}
        }
    }
}

fn variable(node: Node<'_>, scope: Scope, names: &mut Names, project: &mut Project) -> Result<(), Problem> {
    let name = xml::required(node, "name")?;
    let initial = xml::child(node, "initialValue");
    let symbol = match kind_of(node)? {
        Type::Value(kind) => {
            let initial = initial.map_or(Ok(0), |n| initial_value(n, kind))?;
            let address = xml::attribute(node, "address").map(str::to_owned);
            let variable = Variable { name: name.to_owned(), scope, kind, initial, address };
            Symbol::Variable(project.variables.push(variable), kind)
        }
        Type::Block(_) if initial.is_some() => {
            return Err(xml::not_understood(format!("the initial value of function block `{name}`"), node));
        }
        // What stands at an address without being looked at may lie over an output.
        Type::Block(_) | Type::Other(_) if xml::attribute(node, "address").is_some_and(|a| !a.is_empty()) => {
            return Err(xml::not_understood(format!("the address of `{name}`, a variable of such a type,"), node));
        }
        Type::Block(kind) => Symbol::Block(project.blocks.push(Block { name: name.to_owned(), scope, kind })),
        Type::Other(name) => Symbol::Other(name),
    };
    introduce(name, symbol, names, node)
}

fn introduce(name: &str, symbol: Symbol, names: &mut Names, node: Node<'_>) -> Result<(), Problem> {
    match names.insert(fold(name), symbol) {
        None => Ok(()),
        Some(_) => Err(xml::problem(Code::Clash, format!("two variables have the name `{name}`"), node)),
    }
}

/// Makes the global variables that a list names as external known in a program.
pub fn import(list: Node<'_>, globals: &Globals, names: &mut Names, project: &Project, problems: &mut Diagnostics) {
    for node in xml::children_named(list, "variable") {
        let found = xml::required(node, "name").and_then(|name| match globals.names.get(&fold(name)) {
            None => {
                let message = format!("the external variable `{name}` is not declared globally");
                Err(xml::problem(Code::Undeclared, message, node))
            }
            Some(_) if xml::child(node, "initialValue").is_some() || xml::attribute(node, "address").is_some() => {
                Err(xml::not_understood(format!("the value or address of the external variable `{name}`"), node))
            }
            Some(symbol) => {
                let same = match (symbol, kind_of(node)?) {
                    (Symbol::Variable(_, kind), Type::Value(other)) => *kind == other,
                    (Symbol::Block(id), Type::Block(other)) => project.blocks[*id].kind == other,
                    (Symbol::Other(name), Type::Other(other)) => name.eq_ignore_ascii_case(&other),
                    _ => false,
                };
                if !same {
                    let message = format!("the external variable `{name}` has another type than the global one");
                    return Err(xml::problem(Code::BrokenText, message, node));
                }
                introduce(name, symbol.clone(), names, node)
            }
        });
        if let Err(problem) = found {
            problems.push(problem);
        }
    }
}

/// Says where two variables have one address.
pub fn clashing_addresses(root: Node<'_>, problems: &mut Diagnostics) {
    let mut seen: BTreeMap<String, &str> = BTreeMap::new();
    for node in xml::descendants(root, "variable") {
        // Contacts, pins and external variables have none.
        let (Some(address), Some(name)) = (xml::attribute(node, "address"), xml::attribute(node, "name")) else {
            continue;
        };
        // The configurator replaces an asterisk by an address.
        if address.contains(['*', '?']) {
            continue;
        }
        if let Some(first) = seen.insert(fold(address), name) {
            let message = format!("`{first}` and `{name}` both have the address {address}");
            problems.push(xml::problem(Code::Clash, message, node));
        }
    }
}

fn kind_of(variable: Node<'_>) -> Result<Type, Problem> {
    let kind = xml::child(variable, "type").and_then(|n| xml::children(n).next());
    let kind = kind.ok_or_else(|| xml::problem(Code::NotPlcopen, "a variable has no type", variable))?;
    let name = match kind.tag_name().name() {
        "derived" => xml::required(kind, "name")?,
        other => other,
    };
    Ok(type_named(name))
}

fn type_named(name: &str) -> Type {
    let int = |bits, signed| Type::Value(Kind::Int { bits, signed });
    match fold(name).as_str() {
        "BOOL" => Type::Value(Kind::Bool),
        "TIME" => Type::Value(Kind::Time),
        "SINT" => int(8, true),
        "INT" => int(16, true),
        "DINT" => int(32, true),
        "LINT" => int(64, true),
        "USINT" => int(8, false),
        "UINT" => int(16, false),
        "UDINT" => int(32, false),
        "ULINT" => int(64, false),
        "TON" => Type::Block(BlockKind::Ton),
        "TOF" => Type::Block(BlockKind::Tof),
        "TP" => Type::Block(BlockKind::Tp),
        "R_TRIG" => Type::Block(BlockKind::RTrig),
        "F_TRIG" => Type::Block(BlockKind::FTrig),
        "SR" => Type::Block(BlockKind::Sr),
        "RS" => Type::Block(BlockKind::Rs),
        _ => Type::Other(name.to_owned()),
    }
}

fn initial_value(node: Node<'_>, kind: Kind) -> Result<i64, Problem> {
    let value = xml::child(node, "simpleValue").map(|n| n.attribute("value").unwrap_or_default());
    let value = value.ok_or_else(|| xml::not_understood("a compound initial value", node))?;
    let broken = || xml::problem(Code::BrokenText, format!("`{value}` is no initial value of this type"), node);
    // Beremiz leaves the prefix of durations out.
    let bare_duration = (kind == Kind::Time).then(|| literal::duration(value.trim())).flatten();
    let list = match bare_duration {
        Some(time) => vec![Token::Time(time)],
        None => tokens(value).map_err(|_| broken())?,
    };
    let found = match (kind, list.as_slice()) {
        (Kind::Bool, [Token::Bool(b)]) => i64::from(*b),
        (Kind::Bool, [Token::Int(n @ (0 | 1))]) | (Kind::Int { .. }, [Token::Int(n)]) => *n,
        (Kind::Int { .. }, [Token::Sign("-"), Token::Int(n)]) => n.wrapping_neg(),
        (Kind::Time, [Token::Time(t)]) => *t,
        _ => return Err(broken()),
    };
    if kind.holds(found) { Ok(found) } else { Err(broken()) }
}
