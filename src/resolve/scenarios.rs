//! Written scenarios to lines whose names and times are known.

use super::Resolver;
use super::expressions::Context;
use super::names::describe;
use crate::base::{Code, Diagnostic, Span, limits};
use crate::ir::ast;
use crate::ir::scenario::{Doing, Given, Scenario, Step, Told};

pub fn resolve(r: &mut Resolver, tree: &ast::Machine) {
    let gives = r.machine.plant.gives(r.machine.inputs.len());
    for (i, written) in tree.scenarios.iter().enumerate() {
        let name = written.name.value.clone();
        if let Some(first) = tree.scenarios[..i].iter().find(|s| s.name.value == name) {
            r.diagnostics.push(
                Diagnostic::new(Code::DuplicateName, format!("two scenarios are called `{name}`"))
                    .label(written.name.span, "declared again")
                    .label(first.name.span, "first declared here"),
            );
        }
        let after = written.after.as_ref().and_then(|a| {
            let found = tree.scenarios.iter().position(|s| s.name.value == a.value);
            if found.is_none() {
                r.diagnostics.push(
                    Diagnostic::new(Code::UnknownName, format!("there is no scenario `{}`", a.value))
                        .label(a.span, "not declared"),
                );
            }
            found
        });
        // What was played before has run scans; a scenario that begins has run none.
        let mut ran = after.is_some();
        let steps = steps(r, &written.steps, &gives, &mut ran);
        r.machine.scenarios.push(Scenario { name, after, steps, span: written.name.span });
    }
    for i in 0..r.machine.scenarios.len() {
        circle_or_length(r, i);
    }
}

/// The lines; `ran` says whether a scan has run since something was last changed.
fn steps(r: &mut Resolver, written: &[ast::Step], gives: &[bool], ran: &mut bool) -> Vec<Step> {
    written.iter().filter_map(|step| self::step(r, step, gives, ran)).collect()
}

fn step(r: &mut Resolver, written: &ast::Step, gives: &[bool], ran: &mut bool) -> Option<Step> {
    let doing = match &written.doing {
        ast::Doing::Set(names, value) => {
            *ran = false;
            Doing::Set(free(r, names, gives).into_iter().map(|g| (g, *value)).collect())
        }
        ast::Doing::Any(_) => unreachable!("the grammar takes `any` only where a plant begins"),
        ast::Doing::Press(names, time) => {
            *ran = true;
            let scans = time.map_or(1, |t| r.scans(&t, 1));
            Doing::Press(free(r, names, gives), scans)
        }
        ast::Doing::Force(forced) => {
            *ran = false;
            Doing::Force(forced.iter().filter_map(|(name, value)| Some((r.input(name)?, *value))).collect())
        }
        ast::Doing::Release(names) => {
            *ran = false;
            Doing::Release(names.iter().filter_map(|name| r.input(name)).collect())
        }
        ast::Doing::Place(actuator, position) => {
            *ran = false;
            let (actuator, position) = r.place(actuator, position)?;
            Doing::Place(actuator, position)
        }
        ast::Doing::Happens(what, before) => {
            // What is expected behind it is expected at that moment.
            *ran |= what.is_some();
            Doing::Happens(told(r, what.as_ref(), *before, written.span)?)
        }
        ast::Doing::Wait(time) => {
            *ran = true;
            Doing::Wait(r.scans(time, 1))
        }
        ast::Doing::Until(condition, time) => {
            *ran = true;
            let condition = r.condition(condition, &Context::Expectation);
            Doing::Until(condition, r.scans(time, 1))
        }
        ast::Doing::Expect(condition) => {
            if !*ran {
                r.diagnostics.push(
                    Diagnostic::new(Code::NothingRan, "no scan has run since something was last changed")
                        .label(written.span, "this would look at the scan before")
                        .help("let time pass before it: `wait 1 scan`, `wait 100ms`, `wait until … within 1s`"),
                );
                // Once is enough.
                *ran = true;
            }
            Doing::Expect(r.condition(condition, &Context::Expectation))
        }
        ast::Doing::Watch(condition, value) => Doing::Watch(r.condition(condition, &Context::Expectation), *value),
        ast::Doing::Repeat(count, span, inner) => {
            let count = match count {
                Some(n @ 1..=limits::SCENARIO_SCANS) => *n,
                _ => {
                    r.bad_time("this repeats nothing, or more than there can be scans", *span);
                    1
                }
            };
            Doing::Repeat(count, steps(r, inner, gives, ran))
        }
    };
    Some(Step { doing, text: describe(&written.description), span: written.span })
}

/// What a scenario lets happen, if anything; reports what the plant does not know, or knows twice.
fn told(r: &mut Resolver, what: Option<&ast::Text>, before_writing: bool, line: Span) -> Option<Option<Told>> {
    let happenings = &r.machine.plant.happenings;
    let Some(what) = what else {
        if r.machine.plant.by_steps {
            return Some(None);
        }
        r.diagnostics.push(
            Diagnostic::new(Code::BadHappening, "the plant does not go by steps")
                .label(line, "nothing happens there by itself")
                .help("only in a `plant by steps` things happen between scans"),
        );
        return None;
    };
    let named: Vec<usize> = (0..happenings.len()).filter(|&i| happenings[i].text == what.value).collect();
    let diagnostic = match named[..] {
        [happening] => return Some(Some(Told { happening, before_writing })),
        [] => {
            let known = happenings.iter().map(|h| format!("`{}`", h.text)).collect::<Vec<_>>().join(", ");
            let help =
                if known.is_empty() { "the plant has no steps".to_owned() } else { format!("there are {known}") };
            Diagnostic::new(Code::BadHappening, format!("no step of the plant is called `{}`", what.value))
                .label(what.span, "no step has this text")
                .help(help)
        }
        [first, second, ..] => {
            Diagnostic::new(Code::BadHappening, format!("two steps of the plant are called `{}`", what.value))
                .label(what.span, "could be either of them")
                .label(happenings[first].span, "this one")
                .label(happenings[second].span, "or this one")
                .help("give steps that a scenario tells texts of their own")
        }
    };
    r.diagnostics.push(diagnostic);
    None
}

/// What the scenario itself may give; reports what the plant gives.
fn free(r: &mut Resolver, names: &[ast::Name], gives: &[bool]) -> Vec<Given> {
    let mut free = Vec::new();
    for name in names {
        let Some(given) = r.given(name) else { continue };
        if let Given::Input(input) = given
            && gives[input.index()]
        {
            r.diagnostics.push(
                Diagnostic::new(Code::GivenByPlant, format!("the plant gives `{}`", name.text))
                    .label(name.span, "the plant would take it back at once")
                    .help(format!(
                        "to hold it against the plant write `force {0}` or `force not {0}`, and later `release {0}`",
                        name.text
                    )),
            );
            continue;
        }
        free.push(given);
    }
    free
}

/// Reports a scenario that begins after itself, or that is longer than it may be.
fn circle_or_length(r: &mut Resolver, index: usize) {
    let scenarios = &r.machine.scenarios;
    let mut scans = 0u64;
    let (mut at, mut seen, mut first) = (Some(index), 0, index);
    while let Some(i) = at {
        scans = scans.saturating_add(length(&scenarios[i].steps));
        at = scenarios[i].after;
        first = first.min(i);
        seen += 1;
        if at == Some(index) || seen > scenarios.len() {
            // A circle is reported once, at the first scenario in it.
            if at == Some(index) && first == index {
                r.diagnostics.push(
                    Diagnostic::new(
                        Code::CyclicScenarios,
                        format!("`{}` would begin after itself", scenarios[index].name),
                    )
                    .label(scenarios[index].span, "this one comes after another, and so on, back to it"),
                );
            }
            return;
        }
    }
    if scans > u64::from(limits::SCENARIO_SCANS) {
        let text = format!("this may take {scans} scans; a scenario takes at most {}", limits::SCENARIO_SCANS);
        let span: Span = scenarios[index].span;
        r.bad_time(&text, span);
    }
}

/// For how many scans these lines run at most.
fn length(steps: &[Step]) -> u64 {
    let mut scans = 0u64;
    for step in steps {
        scans = scans.saturating_add(match &step.doing {
            // A press lets a scan run before it if it has to.
            Doing::Press(_, n) => u64::from(*n) + 1,
            Doing::Wait(n) | Doing::Until(_, n) => u64::from(*n),
            // What takes no scan takes time all the same when it is repeated.
            Doing::Repeat(n, inner) => length(inner).max(1).saturating_mul(u64::from(*n)),
            Doing::Set(..)
            | Doing::Force(..)
            | Doing::Release(..)
            | Doing::Place(..)
            | Doing::Happens(_)
            | Doing::Expect(..)
            | Doing::Watch(..) => 0,
        });
    }
    scans
}
