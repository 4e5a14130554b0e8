//! What feeds a coil, a pin or a transition: lines through contacts and function blocks to values.
//!
//! Everything is walked without recursion but for chains of function blocks, which are bounded.

use super::Problem;
use super::body::{Body, Line, describe};
use super::branches::Branches;
use super::declarations;
use super::functions::{self, Function};
use super::program::{Context, broken};
use super::st::{self, Binding, Value};
use super::xml::{self, Family, Node};
use crate::base::Code;
use crate::ir::expr::Expr;
use crate::ir::iec::{Atom, BlockId, Bool, Call, Condition, Statement};
use std::collections::{BTreeMap, BTreeSet};

/// Longest chain of function blocks that feed each other.
const CHAIN: usize = 64;

/// How many elements and lines of one body may be looked at. Each end looks at all that feeds it.
const VISITS: usize = 2_000_000;

/// Depth from which on a part of a condition gets a place of its own.
const DEEP: usize = 24;

/// Follows lines in one body and collects the calls that have to come before their ends are read.
pub struct Flow<'b, 'a> {
    body: &'b Body<'a>,
    /// Whether the block that is being called has an execution order.
    ordered: bool,
    /// For each element, whether it is a block that has been called.
    called: Vec<bool>,
    chain: usize,
    visits: usize,
    /// The calls, in order. Whoever evaluates a condition puts them before it.
    pub calls: Vec<Statement>,
}

/// The value at the right end of an element, until its last user takes it.
struct Term {
    value: Bool,
    depth: usize,
    uses: usize,
}

/// What is known of the elements that feed an end.
#[derive(Default)]
struct Walk {
    /// Each after those that feed it, with the value of what it does by itself.
    order: Vec<(usize, Bool)>,
    /// Those that the walk has come upon.
    met: BTreeMap<usize, Met>,
}

struct Met {
    /// How many lines leave the element, as far as it was walked.
    uses: usize,
    /// Whether it is under way.
    open: bool,
}

type Terms = BTreeMap<usize, Term>;

/// An element under way.
struct Visit<'a> {
    element: usize,
    own: Bool,
    /// The lines that are still to be followed, the last one first.
    inputs: Vec<Line<'a>>,
}

impl<'b, 'a> Flow<'b, 'a> {
    /// Nothing called yet.
    pub fn new(body: &'b Body<'a>) -> Self {
        Flow { ordered: false, body, called: vec![false; body.elements.len()], chain: 0, visits: 0, calls: Vec::new() }
    }

    /// The disjunction of what comes along the lines into `end`.
    pub fn condition(&mut self, end: Node<'a>, cx: &mut Context<'_, '_>) -> Result<Condition, Problem> {
        let lines = &self.body.lines(end)?;
        let mut walk = Walk::default();
        for line in lines {
            self.walk(line, &mut walk, cx)?;
        }
        let mut branches = Branches::new(self.body, cx.family);
        for &(element, _) in &walk.order {
            branches.add(element)?;
        }
        branches.end(end)?;
        let mut terms = Terms::new();
        let mut shared = Vec::new();
        for (element, own) in walk.order {
            let uses = walk.met.get(&element).map_or(0, |met| met.uses);
            let (value, depth) = self.term(element, own, &mut terms, cx)?;
            let (value, depth) = if depth > DEEP || (uses > 1 && !simple(&value)) {
                shared.push(value);
                (Expr::Atom(Atom::Shared(shared.len() - 1)), 1)
            } else {
                (value, depth)
            };
            terms.insert(element, Term { value, depth, uses });
        }
        let mut operands = Vec::new();
        for line in lines {
            operands.push(self.along(line, &mut terms, cx)?.0);
        }
        Ok(Condition { shared, value: Expr::any(operands) })
    }

    /// Walks against the lines from one end. Blocks are called when they are met, not looked behind.
    fn walk(&mut self, end: &Line<'a>, walk: &mut Walk, cx: &mut Context<'_, '_>) -> Result<(), Problem> {
        let mut stack: Vec<Visit<'a>> = Vec::new();
        let mut next = Some(end.from);
        loop {
            if let Some(element) = next {
                let node = self.body.elements[element];
                match walk.met.get_mut(&element) {
                    None => {
                        walk.met.insert(element, Met { uses: 1, open: true });
                        stack.push(self.visit(element, cx)?);
                    }
                    Some(met) if met.open => {
                        let message = format!("{} feeds itself", describe(node));
                        return Err(xml::problem(Code::Unconnected, message, node));
                    }
                    Some(met) => met.uses += 1,
                }
            }
            let Some(visit) = stack.last_mut() else { return Ok(()) };
            next = visit.inputs.pop().map(|line| line.from);
            if next.is_none() {
                if let Some(met) = walk.met.get_mut(&visit.element) {
                    met.open = false;
                }
                let own = std::mem::replace(&mut visit.own, Expr::TRUE);
                walk.order.push((visit.element, own));
                stack.pop();
            }
        }
    }

    /// Calls what has to be called when the walk comes upon an element.
    fn visit(&mut self, element: usize, cx: &mut Context<'_, '_>) -> Result<Visit<'a>, Problem> {
        let node = self.body.elements[element];
        let mut visit = Visit { element, own: Expr::TRUE, inputs: Vec::new() };
        match node.tag_name().name() {
            "leftPowerRail" => {}
            "inVariable" => visit.own = in_variable(node, cx)?.0.bool().ok_or_else(|| needs_bool(node))?,
            "contact" => {
                visit.own = self.contact(node, cx)?;
                visit.inputs = self.inputs(node)?;
                for line in &visit.inputs {
                    self.may_stand_in_series(line, cx)?;
                }
            }
            "coil" => {
                visit.inputs = self.inputs(node)?;
                // Beremiz makes AND of what is drawn as OR.
                if visit.inputs.len() > 1 && cx.family == Family::Beremiz {
                    let message = format!("{} with elements after it and parallel branches before it", describe(node));
                    return Err(xml::not_understood(message, node));
                }
            }
            "block" if functions::is_function(node) => {}
            "block" => self.call(element, cx)?,
            _ => return Err(xml::not_understood(format!("{} as a source", describe(node)), node)),
        }
        self.visits += 1 + visit.inputs.len();
        if self.visits > VISITS {
            return Err(xml::not_understood("a body in which so many lines meet", node));
        }
        visit.inputs.reverse();
        Ok(visit)
    }

    /// The lines into an element that needs some.
    pub fn inputs(&self, node: Node<'a>) -> Result<Vec<Line<'a>>, Problem> {
        let lines = self.body.lines(node)?;
        if lines.is_empty() {
            let message = format!("{} is connected to nothing", describe(node));
            return Err(xml::problem(Code::Unconnected, message, node));
        }
        Ok(lines)
    }

    /// The value at the right end of an element whose sources have terms.
    fn term(
        &mut self,
        element: usize,
        own: Bool,
        terms: &mut Terms,
        cx: &mut Context<'_, '_>,
    ) -> Result<(Bool, usize), Problem> {
        let node = self.body.elements[element];
        // A block has a value only by the output that a line leaves; see `along`.
        if xml::is(node, "block") {
            return Ok((own, 1));
        }
        let mut operands = Vec::new();
        let mut depth = 0;
        let lines = self.body.lines(node)?;
        for line in &lines {
            let (value, d) = self.along(line, terms, cx)?;
            operands.push(value);
            depth = depth.max(d);
        }
        if lines.is_empty() {
            return Ok((own, 1));
        }
        Ok((Expr::all([Expr::any(operands), own]), depth + 2))
    }

    /// What comes along one line.
    fn along(
        &mut self,
        line: &Line<'a>,
        terms: &mut Terms,
        cx: &mut Context<'_, '_>,
    ) -> Result<(Bool, usize), Problem> {
        let node = self.body.elements[line.from];
        if xml::is(node, "block") {
            let value = self.output(line, cx)?.bool().ok_or_else(|| needs_bool(node))?;
            return Ok((value, 2));
        }
        let Some(term) = terms.get_mut(&line.from) else { return Ok((Expr::FALSE, 1)) };
        term.uses = term.uses.saturating_sub(1);
        if term.uses == 0 {
            let value = std::mem::replace(&mut term.value, Expr::FALSE);
            return Ok((value, term.depth));
        }
        Ok((term.value.clone(), term.depth))
    }

    /// Texts of expressions go into a series as they stand.
    fn may_stand_in_series(&self, line: &Line<'a>, cx: &Context<'_, '_>) -> Result<(), Problem> {
        let node = self.body.elements[line.from];
        if xml::is(node, "inVariable") && in_variable(node, cx)?.1 == Binding::Loose {
            let message = format!("{} in series, without parentheses around it,", describe(node));
            return Err(xml::not_understood(message, node));
        }
        Ok(())
    }

    fn contact(&mut self, node: Node<'a>, cx: &mut Context<'_, '_>) -> Result<Bool, Problem> {
        let variable = xml::child(node, "variable").map(xml::text).unwrap_or_default();
        let value = cx.expression(&variable, node)?.0.bool().ok_or_else(|| needs_bool(node))?;
        if !matches!(value, Expr::Atom(_) | Expr::Const(_)) {
            return Err(xml::not_understood(format!("{} with an expression", describe(node)), node));
        }
        Ok(self.modify(Condition::simple(value), node, cx)?.value)
    }

    /// Applies the negation or edge detection that `node` asks for.
    pub fn modify(
        &mut self,
        mut condition: Condition,
        node: Node<'a>,
        cx: &mut Context<'_, '_>,
    ) -> Result<Condition, Problem> {
        let negated = xml::flag(node, "negated");
        match (negated, given(node, "edge")) {
            (false, None) => Ok(condition),
            (true, None) => {
                condition.value = condition.value.not();
                Ok(condition)
            }
            (false, Some(edge @ ("rising" | "falling"))) => {
                let block = cx.trigger(edge == "rising");
                self.calls.push(Statement::Call(Call { block, input: Some(condition), reset: None, preset: None }));
                Ok(Condition::simple(Expr::Atom(Atom::Output(block))))
            }
            (false, Some(_)) => Err(xml::not_understood(format!("the edge of {}", describe(node)), node)),
            (true, Some(_)) => {
                Err(xml::not_understood(format!("{} with both negation and edge", describe(node)), node))
            }
        }
    }

    /// The value of what one line brings to a place that takes numbers.
    pub fn number(&mut self, lines: &[Line<'a>], node: Node<'a>, cx: &mut Context<'_, '_>) -> Result<Value, Problem> {
        let [line] = lines else {
            return Err(xml::not_understood(format!("{} with several lines into one input", describe(node)), node));
        };
        let source = self.body.elements[line.from];
        match source.tag_name().name() {
            "inVariable" => Ok(in_variable(source, cx)?.0),
            "block" if !functions::is_function(source) => {
                self.call(line.from, cx)?;
                self.output(line, cx)
            }
            _ => Err(xml::not_understood(format!("{} as the source of a number", describe(source)), source)),
        }
    }

    /// Calls a block unless it has been called.
    pub fn call(&mut self, element: usize, cx: &mut Context<'_, '_>) -> Result<(), Problem> {
        if std::mem::replace(&mut self.called[element], true) {
            return Ok(());
        }
        let node = self.body.elements[element];
        if functions::is_function(node) {
            return self.assign_result(node, cx);
        }
        // Beremiz reads the outputs that another block had before, and calls that when it comes to it.
        if self.ordered {
            let what = format!("{}, which feeds a block with an execution order and has not run,", describe(node));
            return Err(xml::not_understood(what, node));
        }
        if self.chain == CHAIN {
            return Err(xml::not_understood(format!("a chain of more than {CHAIN} function blocks"), node));
        }
        self.chain += 1;
        let outer = std::mem::replace(&mut self.ordered, cx.family == Family::Beremiz && place(node).is_some());
        let result = self.call_new(node, cx);
        self.ordered = outer;
        self.chain -= 1;
        result
    }

    fn call_new(&mut self, node: Node<'a>, cx: &mut Context<'_, '_>) -> Result<(), Problem> {
        let name = xml::required(node, "instanceName")?;
        let block = instance(name, node, cx)?;
        let kind = xml::required(node, "typeName")?;
        exact(kind, node, cx)?;
        if declarations::block_named(kind) != Some(cx.blocks[block].kind) {
            let message = format!("{}, whose type is not that of its declaration,", describe(node));
            return Err(xml::not_understood(message, node));
        }
        let mut call = Call { block, input: None, reset: None, preset: None };
        let mut seen = BTreeSet::new();
        for variable in pins(node, "inputVariables") {
            let pin = xml::required(variable, "formalParameter")?;
            let point = xml::child(variable, "connectionPointIn");
            let lines = self.body.lines(variable)?;
            let text = point.and_then(|p| xml::child(p, "expression")).map(xml::text);
            let what = st::input(cx.blocks[block].kind, pin);
            let other = || xml::not_understood(format!("pin `{pin}` of {}", describe(node)), variable);
            if lines.is_empty() && text.is_none() {
                plain(variable, "fed by nothing")?;
                if what.is_none() && !pin.eq_ignore_ascii_case("EN") {
                    return Err(other());
                }
                continue;
            }
            exact(pin, variable, cx)?;
            let what = what.filter(|_| seen.insert(pin.to_ascii_uppercase())).ok_or_else(other)?;
            match what {
                st::Pin::Input | st::Pin::Reset => {
                    let condition = match &text {
                        Some(text) => {
                            let value = cx.expression(text, variable)?.0;
                            Condition::simple(value.bool().ok_or_else(|| needs_bool(variable))?)
                        }
                        None => self.condition(variable, cx)?,
                    };
                    let condition = self.modify(condition, variable, cx)?;
                    let place = if what == st::Pin::Input { &mut call.input } else { &mut call.reset };
                    *place = Some(condition);
                }
                st::Pin::Preset => {
                    plain(variable, "of numbers")?;
                    let value = match &text {
                        Some(text) => cx.expression(text, variable)?.0,
                        None => self.number(&lines, node, cx)?,
                    };
                    st::give(&mut call, what, value).map_err(|f| broken(f, pin, variable))?;
                }
            }
        }
        if pins(node, "inOutVariables").next().is_some() {
            return Err(xml::not_understood(format!("the in-out variables of {}", describe(node)), node));
        }
        self.calls.push(Statement::Call(call));
        for variable in pins(node, "outputVariables") {
            let pin = xml::required(variable, "formalParameter")?;
            if !pin.eq_ignore_ascii_case("ENO") && st::output(block, pin, cx.blocks).is_none() {
                return Err(xml::not_understood(format!("pin `{pin}` of {}", describe(node)), variable));
            }
            self.assign_output(variable, block, cx)?;
            // Where something comes from it, that is looked at with the line.
            if let Err(problem) = plain(variable, "used by nothing")
                && !self.body.is_left(node, xml::attribute(variable, "formalParameter"))
            {
                return Err(problem);
            }
        }
        Ok(())
    }

    /// CODESYS names within an output pin the variable that it is assigned to.
    fn assign_output(&mut self, variable: Node<'a>, block: BlockId, cx: &mut Context<'_, '_>) -> Result<(), Problem> {
        let target = xml::child(variable, "connectionPointOut").and_then(|p| xml::child(p, "expression"));
        let target = target.map(xml::text).unwrap_or_default();
        let target = target.trim();
        // The placeholder of a pin that nothing is assigned to.
        if target.is_empty() || target == "???" {
            return Ok(());
        }
        let pin = xml::required(variable, "formalParameter")?;
        let value = st::output(block, pin, cx.blocks)
            .ok_or_else(|| xml::not_understood(format!("the output pin `{pin}`"), variable))?;
        plain(variable, "an assigned output")?;
        let path: Vec<&str> = target.split('.').collect();
        let statement = st::assignment(&path, value, &cx.scope).map_err(|f| broken(f, target, variable))?;
        self.calls.push(statement);
        Ok(())
    }

    /// The function whose result comes along `line`, if one does. Each function has one user.
    pub fn function(&mut self, line: &Line<'a>, cx: &Context<'_, '_>) -> Result<Option<Function>, Problem> {
        let node = self.body.elements[line.from];
        if !functions::is_function(node) {
            return Ok(None);
        }
        leaves_box(line, node, cx)?;
        if std::mem::replace(&mut self.called[line.from], true) {
            return Err(xml::not_understood(format!("{}, which has several users,", describe(node)), node));
        }
        let pin = output_pin(node, line)?;
        if !matches!(functions::results(node).as_slice(), [only] if *only == pin) {
            return Err(xml::not_understood(format!("a line from another output of {}", describe(node)), line.node));
        }
        let function = functions::read(node, self.body, cx)?;
        if !matches!(function.value, Value::Bool(_)) {
            plain(pin, "of numbers")?;
        }
        Ok(Some(function))
    }

    /// CODESYS names within the output pin of a function the variable that takes the result.
    fn assign_result(&mut self, node: Node<'a>, cx: &mut Context<'_, '_>) -> Result<(), Problem> {
        if cx.family == Family::Beremiz {
            // It runs when its user does; without one it does nothing, unless it is to run before all else.
            if xml::attribute(node, "executionOrderId").is_some_and(|n| n != "0") {
                return Err(xml::not_understood(format!("the execution order of {}", describe(node)), node));
            }
            return functions::read(node, self.body, cx).map(|_| ());
        }
        // One that is not understood may write something, or may not be there.
        functions::read(node, self.body, cx)?;
        for pin in functions::results(node) {
            let target = xml::child(pin, "connectionPointOut").and_then(|p| xml::child(p, "expression"));
            let target = target.map(xml::text).unwrap_or_default();
            if target.trim().is_empty() || target.trim() == "???" {
                continue;
            }
            plain(pin, "an assigned output")?;
            if functions::results(node).len() > 1 {
                return Err(xml::not_understood(format!("an assigned output of {}", describe(node)), pin));
            }
            let function = functions::read(node, self.body, cx)?;
            self.calls.push(function.assign(&target, node, cx)?);
        }
        Ok(())
    }

    /// The output of a block that has been called, from which a line comes.
    fn output(&mut self, line: &Line<'a>, cx: &mut Context<'_, '_>) -> Result<Value, Problem> {
        let node = self.body.elements[line.from];
        leaves_box(line, node, cx)?;
        if let Some(function) = self.function(line, cx)? {
            return match function.value {
                Value::Bool(value) => {
                    let pin = output_pin(node, line)?;
                    Ok(Value::Bool(self.modify(Condition::simple(value), pin, cx)?.value))
                }
                Value::Int(_) | Value::Time(_) => Err(needs_bool(node)),
            };
        }
        let name = xml::required(node, "instanceName")?;
        let block = instance(name, node, cx)?;
        let pin = output_pin(node, line)?;
        let parameter = xml::required(pin, "formalParameter")?;
        exact(parameter, pin, cx)?;
        let value = st::output(block, parameter, cx.blocks)
            .ok_or_else(|| xml::not_understood(format!("pin `{parameter}` of {}", describe(node)), line.node))?;
        match value {
            Value::Bool(value) => Ok(Value::Bool(self.modify(Condition::simple(value), pin, cx)?.value)),
            Value::Int(_) | Value::Time(_) => {
                plain(pin, "of numbers")?;
                Ok(value)
            }
        }
    }
}

/// The pin of a block from which a line comes: the one it names, the one where it ends, or the only
/// one.
fn output_pin<'a>(node: Node<'a>, line: &Line<'a>) -> Result<Node<'a>, Problem> {
    let coordinates = |n: Node<'a>| -> Option<(i64, i64)> {
        Some((xml::attribute(n, "x")?.parse().ok()?, xml::attribute(n, "y")?.parse().ok()?))
    };
    let at = || -> Option<Node<'a>> {
        let (x, y) = coordinates(xml::children_named(line.node, "position").last()?)?;
        let (block_x, block_y) = coordinates(xml::child(node, "position")?)?;
        pins(node, "outputVariables").find(|pin| {
            let place = xml::child(*pin, "connectionPointOut").and_then(|p| xml::child(p, "relPosition"));
            place.and_then(coordinates) == Some((x.wrapping_sub(block_x), y.wrapping_sub(block_y)))
        })
    };
    let found = match line.parameter {
        Some(name) => pins(node, "outputVariables")
            .find(|pin| xml::attribute(*pin, "formalParameter").is_some_and(|p| p.eq_ignore_ascii_case(name))),
        None => at().or_else(|| {
            let mut all = pins(node, "outputVariables");
            all.next().filter(|_| all.next().is_none())
        }),
    };
    found.ok_or_else(|| {
        let message = format!("a line does not say from which output of {} it comes", describe(node));
        xml::problem(Code::Unconnected, message, line.node)
    })
}

pub fn pins<'a>(node: Node<'a>, list: &'static str) -> impl Iterator<Item = Node<'a>> {
    xml::child(node, list).into_iter().flat_map(|n| xml::children_named(n, "variable"))
}

fn instance(name: &str, node: Node<'_>, cx: &Context<'_, '_>) -> Result<BlockId, Problem> {
    use super::scope::Meaning;
    match cx.scope.find(&name.split('.').collect::<Vec<_>>()) {
        Some(Meaning::Block(block)) => Ok(block),
        Some(_) => Err(xml::not_understood(format!("the function block {}", describe(node)), node)),
        None => Err(xml::problem(Code::Undeclared, format!("the function block `{name}` is not declared"), node)),
    }
}

/// The value of an inVariable.
pub fn in_variable(node: Node<'_>, cx: &Context<'_, '_>) -> Result<(Value, Binding), Problem> {
    let text = xml::child(node, "expression").map(xml::text).unwrap_or_default();
    cx.expression(&text, node)
}

/// The place that an element is given in the order; 0 is none.
pub fn place(node: Node<'_>) -> Option<u64> {
    xml::attribute(node, "executionOrderId").and_then(|n| n.parse::<u64>().ok()).filter(|&n| n > 0)
}

/// Only what is TRUE or FALSE, and is used, can be negated or have an edge.
pub fn plain(pin: Node<'_>, what: &str) -> Result<(), Problem> {
    if xml::flag(pin, "negated") || given(pin, "edge").is_some() {
        let name = xml::attribute(pin, "formalParameter").unwrap_or_default();
        return Err(xml::not_understood(format!("pin `{name}`, {what}, with negation or edge,"), pin));
    }
    Ok(())
}

/// The generator of Beremiz looks for the end of a line from a box, and for its pin by a name as it stands.
fn leaves_box(line: &Line<'_>, node: Node<'_>, cx: &Context<'_, '_>) -> Result<(), Problem> {
    if cx.family == Family::Beremiz && xml::child(line.node, "position").is_none() {
        return Err(xml::not_understood(format!("a line from {} without a position", describe(node)), line.node));
    }
    if cx.family == Family::Beremiz && line.node.attribute("formalParameter").is_some_and(|name| name.trim().is_empty())
    {
        return Err(xml::not_understood(
            format!("a line from an output of {} without a name", describe(node)),
            line.node,
        ));
    }
    exact(line.parameter.unwrap_or_default(), line.node, cx)
}

/// Beremiz knows pins and types by names in which case counts, and leaves out what it does not know.
pub fn exact(name: &str, node: Node<'_>, cx: &Context<'_, '_>) -> Result<(), Problem> {
    if cx.family == Family::Beremiz && name != name.to_ascii_uppercase() {
        return Err(xml::not_understood(format!("`{name}`, which the standard writes in capital letters,"), node));
    }
    Ok(())
}

/// An attribute that may be `none`.
pub fn given<'a>(node: Node<'a>, name: &str) -> Option<&'a str> {
    xml::attribute(node, name).filter(|v| *v != "none")
}

fn needs_bool(node: Node<'_>) -> Problem {
    xml::problem(Code::BrokenText, format!("{} is not of type BOOL", describe(node)), node)
}

/// Whether repeating a value costs no more than referring to it.
fn simple(value: &Bool) -> bool {
    match value {
        Expr::Const(_) | Expr::Atom(_) => true,
        Expr::Not(inner) => matches!(**inner, Expr::Atom(_)),
        Expr::And(_) | Expr::Or(_) | Expr::Xor(..) => false,
    }
}
