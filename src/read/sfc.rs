//! SFC bodies to charts.
//!
//! Lines are followed from each transition up to the steps before it, and from each step and jump up
//! to the transitions before them, through divergences and convergences of either kind. CODESYS
//! nests these, and puts jumps into convergences where they mean nothing; Beremiz loses what is drawn
//! so without a word, so in its files it is refused.
//!
//! Transitions of CODESYS files have no priorities; branches are tried from left to right, which is
//! document order, so that becomes their priority; priorities that say otherwise are refused.

use super::Problem;
use super::actions;
use super::body::{Body, Line, describe};
use super::flow::Flow;
use super::ladder;
use super::order::{self, Drawing, Element, Order};
use super::program::{Context, broken};
use super::st;
use super::vendor;
use super::xml::{self, Family, Node};
use crate::base::iec::fold;
use crate::base::{Code, Id};
use crate::ir::iec::{Association, Condition, Qualifier, Sfc, Statement, Step, StepId, Target, Transition};
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};

/// Most lines that are followed in one body, each as often as something lies behind it.
const LINES: usize = 2_000_000;

/// The things of a body by number, in document order.
struct Parts<'a> {
    body: &'a Body<'a>,
    /// Elements that are steps or transitions, by their index among all elements.
    steps: BTreeMap<usize, usize>,
    transitions: BTreeMap<usize, usize>,
    /// Folded names of steps.
    names: BTreeMap<String, usize>,
    step_nodes: Vec<Node<'a>>,
    transition_nodes: Vec<Node<'a>>,
    /// How many lines have been followed.
    followed: Cell<usize>,
}

/// Reads what stands within `SFC`; `pou` is the program around it.
pub fn read(pou: Node<'_>, content: Node<'_>, cx: &mut Context<'_, '_>) -> Sfc {
    let body = Body::new(content, cx.problems);
    let parts = Parts::new(&body, cx);
    refuse_flags(pou, cx);
    let drawing = parts.drawing(cx);
    if cx.family == Family::Codesys {
        parts.compare_orders(&drawing, cx);
    }
    let order = order::order(&drawing);
    if order.first.is_none() {
        cx.report(xml::problem(Code::Unconnected, "an SFC has no initial step", content));
    }

    let mut sfc = Sfc::default();
    let mut ids: Vec<Option<StepId>> = vec![None; parts.step_nodes.len()];
    for &step in &order.steps {
        let name = xml::attribute(parts.step_nodes[step], "name").unwrap_or_default().to_owned();
        let initial = drawing.initial[step];
        ids[step] = Some(sfc.steps.push(Step { name, initial, associations: Vec::new() }));
    }
    cx.scope.steps = parts.names.iter().filter_map(|(name, &step)| Some((name.clone(), ids[step]?))).collect();

    let (mut conditions, calls) = parts.conditions(pou, &order, cx);
    for &transition in &order.transitions {
        let node = parts.transition_nodes[transition];
        let resolve = |steps: &[usize]| steps.iter().map(|&s| ids[s]).collect::<Option<Vec<_>>>();
        let Some(condition) = conditions[transition].take() else { continue };
        match (resolve(&drawing.before[transition]), resolve(&order.after[transition])) {
            (Some(from), Some(to)) if !from.is_empty() && !to.is_empty() => {
                let priority = parts.priority(transition, cx);
                sfc.transitions.push(Transition { from, to, priority, condition });
            }
            (Some(_), Some(to)) if to.is_empty() => {
                let message = "a transition leads to no step";
                cx.report(xml::problem(Code::Unconnected, message, node));
            }
            _ => {
                let message = "a transition waits for a step that is never reached";
                cx.report(xml::problem(Code::Unconnected, message, node));
            }
        }
    }
    parts.associate(pou, &ids, &mut sfc, cx);
    if let Some(first) = order.first.and_then(|s| ids[s])
        && !calls.is_empty()
    {
        // So does Beremiz: the blocks of conditions run as a stored action of the first step.
        let target = Target::Action(Id::from_index(sfc.actions.len()));
        let association = Association { target, qualifier: Qualifier::Set, duration: 0 };
        sfc.steps[first].associations.push(association);
        actions::push(&mut sfc, "COMPUTE_FUNCTION_BLOCKS", calls);
    }
    actions::sort(&mut sfc);
    sfc
}

impl<'a> Parts<'a> {
    fn new(body: &'a Body<'a>, cx: &mut Context<'_, '_>) -> Self {
        let mut parts = Parts {
            body,
            steps: BTreeMap::new(),
            transitions: BTreeMap::new(),
            names: BTreeMap::new(),
            step_nodes: Vec::new(),
            transition_nodes: Vec::new(),
            followed: Cell::new(0),
        };
        for (index, &node) in body.elements.iter().enumerate() {
            match node.tag_name().name() {
                "step" => {
                    let step = parts.step_nodes.len();
                    let name = xml::attribute(node, "name").unwrap_or_default();
                    if parts.names.insert(fold(name), step).is_some() {
                        cx.report(xml::problem(Code::Clash, format!("two steps have the name `{name}`"), node));
                    }
                    parts.steps.insert(index, step);
                    parts.step_nodes.push(node);
                }
                "transition" => {
                    parts.transitions.insert(index, parts.transition_nodes.len());
                    parts.transition_nodes.push(node);
                }
                "jumpStep"
                | "actionBlock"
                | "selectionDivergence"
                | "selectionConvergence"
                | "simultaneousDivergence"
                | "simultaneousConvergence"
                | "inVariable"
                | "comment"
                | "contact"
                | "leftPowerRail"
                | "rightPowerRail"
                | "block" => {}
                _ => {
                    cx.report(xml::not_understood(describe(node), node));
                    continue;
                }
            }
            vendor::refuse_attributes(node, body, cx);
        }
        parts
    }

    fn drawing(&self, cx: &mut Context<'_, '_>) -> Drawing {
        let mut drawing = Drawing {
            initial: self.step_nodes.iter().map(|&n| xml::flag(n, "initialStep")).collect(),
            ..Drawing::default()
        };
        for (index, &node) in self.body.elements.iter().enumerate() {
            match node.tag_name().name() {
                "step" => {
                    let into = self.transitions_before(node, cx).unwrap_or_else(|p| {
                        cx.report(p);
                        Vec::new()
                    });
                    drawing.elements.push(Element::Step(self.steps[&index]));
                    drawing.into.push(into);
                }
                "jumpStep" => match self.jump(node, cx) {
                    Ok((to, into)) => drawing.elements.push(Element::Jump(to, into)),
                    Err(problem) => cx.report(problem),
                },
                "actionBlock" => match self.owner(node) {
                    Ok(step) => drawing.elements.push(Element::Action(step)),
                    Err(problem) => cx.report(problem),
                },
                "transition" => {
                    let before = self.steps_before(node, cx).unwrap_or_else(|p| {
                        cx.report(p);
                        Vec::new()
                    });
                    drawing.elements.push(Element::Transition(self.transitions[&index]));
                    drawing.before.push(before);
                }
                _ => {}
            }
        }
        drawing
    }

    fn jump(&self, node: Node<'a>, cx: &Context<'_, '_>) -> Result<(usize, Vec<usize>), Problem> {
        let name = xml::required(node, "targetName")?;
        let Some(&to) = self.names.get(&fold(name)) else {
            let message = format!("a jump goes to `{name}`, which is no step");
            return Err(xml::problem(Code::Unconnected, message, node));
        };
        // Beremiz tells letters of either case apart.
        if cx.family == Family::Beremiz && xml::attribute(self.step_nodes[to], "name") != Some(name) {
            return Err(xml::not_understood(
                format!("a jump to `{name}`, a step of which the name is written otherwise,"),
                node,
            ));
        }
        Ok((to, self.transitions_before(node, cx)?))
    }

    /// The step that an action block belongs to.
    fn owner(&self, node: Node<'a>) -> Result<usize, Problem> {
        let line = self.single(node)?;
        line.and_then(|l| self.steps.get(&l.from).copied())
            .ok_or_else(|| xml::problem(Code::Unconnected, "an action block belongs to no step", node))
    }

    /// The only line into an element, if it has one.
    fn single(&self, node: Node<'a>) -> Result<Option<Line<'a>>, Problem> {
        let lines = self.body.lines(node)?;
        if lines.len() > 1 {
            let message = format!("{} has several lines into it where one can be", describe(node));
            return Err(xml::problem(Code::Unconnected, message, node));
        }
        Ok(lines.first().copied())
    }

    /// Counts a line, so that no file costs more than a bounded multiple of its size.
    fn follow(&self, node: Node<'a>) -> Result<(), Problem> {
        self.followed.set(self.followed.get() + 1);
        if self.followed.get() > LINES {
            return Err(xml::not_understood("an SFC in which so many branches meet", node));
        }
        Ok(())
    }

    /// The steps that all must be active for a transition.
    fn steps_before(&self, transition: Node<'a>, cx: &Context<'_, '_>) -> Result<Vec<usize>, Problem> {
        // Collected from the last to the first.
        let mut steps = Vec::new();
        let mut open = vec![transition];
        let mut seen = BTreeSet::new();
        while let Some(node) = open.pop() {
            let lines = match node.tag_name().name() {
                "simultaneousConvergence" => self.body.lines(node)?,
                _ => self.single(node)?.into_iter().collect(),
            };
            if lines.is_empty() {
                let message = format!("{} has no step before it", describe(node));
                return Err(xml::problem(Code::Unconnected, message, node));
            }
            for line in lines.iter().rev() {
                self.follow(node)?;
                let source = self.body.elements[line.from];
                if let Some(&step) = self.steps.get(&line.from) {
                    if seen.insert(line.from) {
                        steps.push(step);
                    }
                    continue;
                }
                let (below, above) = (node.tag_name().name(), source.tag_name().name());
                let fits = match (below, above) {
                    ("transition", "selectionDivergence" | "simultaneousConvergence")
                    | ("selectionDivergence", "simultaneousConvergence") => true,
                    ("selectionDivergence", "selectionDivergence")
                    | ("simultaneousConvergence", "simultaneousConvergence") => cx.family == Family::Codesys,
                    _ => false,
                };
                if !fits || !seen.insert(line.from) {
                    return Err(misplaced(source, node));
                }
                open.push(source);
            }
        }
        steps.reverse();
        Ok(steps)
    }

    /// The transitions each of which leads into a step or jump.
    fn transitions_before(&self, target: Node<'a>, cx: &Context<'_, '_>) -> Result<Vec<usize>, Problem> {
        let mut transitions = Vec::new();
        let mut open: Vec<(Node<'a>, Line<'a>)> = self.single(target)?.into_iter().map(|l| (target, l)).collect();
        let mut seen = BTreeSet::new();
        while let Some((node, line)) = open.pop() {
            self.follow(node)?;
            let source = self.body.elements[line.from];
            if let Some(&transition) = self.transitions.get(&line.from) {
                if seen.insert(line.from) {
                    transitions.push(transition);
                }
                continue;
            }
            let (below, above) = (node.tag_name().name(), source.tag_name().name());
            let fits = match (below, above) {
                ("step" | "jumpStep", "selectionConvergence" | "simultaneousDivergence")
                | ("simultaneousDivergence", "selectionConvergence") => true,
                ("selectionConvergence", "selectionConvergence")
                | ("simultaneousDivergence", "simultaneousDivergence") => cx.family == Family::Codesys,
                // The branch has ended in the jump.
                ("selectionConvergence", "jumpStep") if cx.family == Family::Codesys => continue,
                _ => false,
            };
            if !fits || !seen.insert(line.from) {
                return Err(misplaced(source, node));
            }
            let lines = match above {
                "selectionConvergence" => self.body.lines(source)?,
                _ => self.single(source)?.into_iter().collect(),
            };
            open.extend(lines.into_iter().rev().map(|line| (source, line)));
        }
        Ok(transitions)
    }

    fn priority(&self, transition: usize, cx: &mut Context<'_, '_>) -> Option<u32> {
        let node = self.transition_nodes[transition];
        let written = xml::attribute(node, "priority").map(|text| {
            text.parse().unwrap_or_else(|_| {
                cx.report(xml::problem(Code::BrokenText, format!("`{text}` is no priority"), node));
                0
            })
        });
        match cx.family {
            Family::Beremiz => written,
            Family::Codesys => u32::try_from(transition).ok(),
        }
    }

    /// Refuses priorities that say something else than the order from left to right.
    fn compare_orders(&self, drawing: &Drawing, cx: &mut Context<'_, '_>) {
        let mut last: Vec<Option<u32>> = vec![None; self.step_nodes.len()];
        for (&node, before) in self.transition_nodes.iter().zip(&drawing.before) {
            let priority = xml::attribute(node, "priority").and_then(|text| text.parse::<u32>().ok());
            for &step in before {
                if let (Some(last), Some(priority)) = (last[step], priority)
                    && priority <= last
                {
                    cx.report(xml::not_understood("a priority that contradicts the order from left to right", node));
                }
                last[step] = priority.or(last[step]);
            }
        }
    }

    /// The condition of each transition that has one, and the calls of function blocks in them.
    fn conditions(
        &self,
        pou: Node<'a>,
        order: &Order,
        cx: &mut Context<'_, '_>,
    ) -> (Vec<Option<Condition>>, Vec<Statement>) {
        let mut conditions = vec![None; self.transition_nodes.len()];
        let mut calls = Vec::new();
        let mut flow = Flow::new(self.body);
        for &transition in &order.noted {
            let node = self.transition_nodes[transition];
            match condition(pou, node, self.body, &mut flow, &mut calls, cx) {
                Ok(condition) => conditions[transition] = Some(condition),
                Err(problem) => cx.report(problem),
            }
            calls.append(&mut flow.calls);
        }
        (conditions, calls)
    }

    fn associate(&self, pou: Node<'a>, ids: &[Option<StepId>], sfc: &mut Sfc, cx: &mut Context<'_, '_>) {
        let mut known = BTreeMap::new();
        for &node in self.body.elements.iter().filter(|n| xml::is(**n, "actionBlock")) {
            // A block without a step has been reported.
            let Some(step) = self.owner(node).ok().and_then(|s| ids[s]) else { continue };
            for action in xml::children_named(node, "action") {
                vendor::refuse_attributes(action, self.body, cx);
                match actions::association(pou, action, &sfc.steps[step].name.clone(), sfc, &mut known, cx) {
                    Ok(association) => sfc.steps[step].associations.push(association),
                    Err(problem) => cx.report(problem),
                }
            }
        }
    }
}

fn misplaced(source: Node<'_>, target: Node<'_>) -> Problem {
    let message = format!("a line from {} to {}", describe(source), describe(target));
    xml::not_understood(message, target)
}

fn condition<'a>(
    pou: Node<'a>,
    transition: Node<'a>,
    body: &Body<'a>,
    flow: &mut Flow<'_, 'a>,
    calls: &mut Vec<Statement>,
    cx: &mut Context<'_, '_>,
) -> Result<Condition, Problem> {
    let missing = || xml::problem(Code::Unconnected, format!("{} has no condition", describe(transition)), transition);
    let node = xml::child(transition, "condition").ok_or_else(missing)?;
    let content = xml::children(node).find(|n| !xml::is(*n, "addData")).ok_or_else(missing)?;
    match content.tag_name().name() {
        "connectionPointIn" => {
            let lines = body.lines(node)?;
            if lines.is_empty() {
                return Err(missing());
            }
            flow.condition(node, cx)
        }
        "inline" => match xml::child(content, "ST") {
            Some(text) => {
                let value = cx.expression(xml::text(text).trim().trim_end_matches(';'), text)?.0;
                ladder::truth(value, "a condition", text)
            }
            None => Err(xml::not_understood("an inline condition in a language other than ST", content)),
        },
        "reference" => {
            let name = xml::required(content, "name")?;
            let list = xml::child(pou, "transitions").into_iter();
            let mut list = list.flat_map(|n| xml::children_named(n, "transition"));
            let mut called = |n: &Node<'a>| xml::attribute(*n, "name").is_some_and(|n| n.eq_ignore_ascii_case(name));
            let found = list.find(&mut called);
            if let Some(second) = list.find(&mut called) {
                return Err(xml::problem(Code::Clash, format!("two transitions have the name `{name}`"), second));
            }
            let Some(found) = found else {
                // CODESYS names a variable here where it has no such body.
                let value = cx.expression(name, content)?.0;
                return ladder::truth(value, "a condition", content);
            };
            let body = xml::child(found, "body").and_then(|b| xml::children(b).next());
            match body {
                Some(body) if xml::is(body, "ST") => {
                    let text = xml::text(body);
                    let value = st::transition_body(&text, &cx.scope, cx.blocks).map_err(|f| broken(f, &text, body))?;
                    ladder::truth(value, "a condition", body)
                }
                Some(body) if xml::is(body, "LD") => {
                    let (condition, mut before) = ladder::transition(body, name, cx)?;
                    calls.append(&mut before);
                    Ok(condition)
                }
                _ => Err(xml::not_understood(format!("the language of transition `{name}`"), found)),
            }
        }
        _ => Err(xml::not_understood(describe(content), content)),
    }
}

/// Refuses implicit variables of CODESYS by which other programs reset or stop a chart.
fn refuse_flags(pou: Node<'_>, cx: &mut Context<'_, '_>) {
    let Some(flags) = xml::child(pou, "addData").and_then(|n| xml::descendants(n, "Flags").next()) else { return };
    for flag in xml::children(flags).filter(|n| xml::flag(*n, "Use")) {
        if matches!(flag.tag_name().name(), "Init" | "Reset" | "Pause" | "Tip" | "TipMode") {
            cx.report(xml::not_understood(format!("the SFC flag `SFC{}`", flag.tag_name().name()), flag));
        }
    }
}
