//! What the filter of a program lets through: for all commands, not only for those that the charts can give.
//!
//! Once a program is known to be its chart, this cuts it before the filter. Commands become free, inputs
//! and all that is remembered are free already, and what the program itself makes of them is held against
//! the constraints as they are written:
//!
//! - as long as no assumption is broken, the outputs violate no constraint;
//! - where the commands violate none, and nothing stops the machine, the outputs are the commands.
//!
//! That the rounds that are written out are enough is among the claims about the chart
//! ([`chart_filter::rounds`](super::chart_filter::rounds)), with which the program agrees.

use super::induction::{Cut, Shown};
use crate::bits::aig::{Aig, Lit, lanes};
use crate::bits::sat::{Answer, Budget, Model, Sat};
use crate::ir::chart::{Atom, FilterMode, Guard, Machine};

/// Proves both claims, for the first scan and for any later one; returns how many questions that were. If
/// one fails, says which and when.
pub fn examine(shown: Shown<'_, '_>, sat: &mut Sat) -> Result<usize, String> {
    let mut count = 0;
    for mut cut in shown.cut() {
        count += violates_nothing(shown.pair.machine, &mut cut, sat)?;
        count += corrects_no_more(shown.pair.machine, &mut cut, sat)?;
    }
    sat.forget();
    Ok(count)
}

fn violates_nothing(machine: &Machine, cut: &mut Cut, sat: &mut Sat) -> Result<usize, String> {
    let assumed: Vec<Lit> = cut.chart.broken.iter().map(|&l| !l).chain([cut.given]).collect();
    let outputs = cut.outputs.clone();
    for constraint in machine.safety.constraints.values() {
        let violated = condition(cut, &constraint.never, &outputs);
        // Mostly assumptions have nothing to do with it.
        sat.forget();
        if matches!(sat.ask(&cut.aig, &[violated], Budget::PROOF), Answer::Never) {
            continue;
        }
        sat.forget();
        let goals: Vec<Lit> = assumed.iter().copied().chain([violated]).collect();
        let what = || format!("the filter lets through what `{}` forbids", constraint.name);
        match sat.ask(&cut.aig, &goals, Budget::PROOF) {
            Answer::Never => {}
            Answer::Sometimes(model) => return Err(format!("{}: {}", what(), case(machine, cut, &model))),
            Answer::GaveUp => return Err(format!("whether {} could not be decided", what())),
        }
    }
    Ok(machine.safety.constraints.len())
}

fn corrects_no_more(machine: &Machine, cut: &mut Cut, sat: &mut Sat) -> Result<usize, String> {
    let commands = cut.commands.clone();
    let mut reasons: Vec<Lit> =
        machine.safety.constraints.values().map(|c| condition(cut, &c.never, &commands)).collect();
    if let (Some(FilterMode::Blocking), Some(reset)) = (machine.safety.mode, machine.safety.reset) {
        let rises = cut.aig.and(cut.inputs[reset.index()], !cut.before.inputs[reset.index()]);
        reasons.push(cut.aig.and(cut.before.marks[0], !rises));
    }
    let quiet: Vec<Lit> = reasons.into_iter().map(|l| !l).collect();
    let differ: Vec<Lit> = commands.iter().zip(cut.outputs.clone()).map(|(&c, o)| cut.aig.xor(c, o)).collect();
    let differs = cut.aig.any(&differ);
    sat.forget();
    let goals: Vec<Lit> = quiet.into_iter().chain([cut.given, differs]).collect();
    let what = "the filter corrects commands that violate nothing";
    match sat.ask(&cut.aig, &goals, Budget::PROOF) {
        Answer::Never => Ok(1),
        Answer::Sometimes(model) => Err(format!("{what}: {}", case(machine, cut, &model))),
        Answer::GaveUp => Err(format!("whether {what} could not be decided")),
    }
}

/// A condition of a constraint with those outputs.
fn condition(cut: &mut Cut, guard: &Guard, outputs: &[Lit]) -> Lit {
    let Cut { aig, chart, .. } = cut;
    aig.expression(guard, &mut |_: &mut Aig, atom| match atom {
        Atom::Output(o) => outputs[o.index()],
        read => chart.readings[read],
    })
}

/// What is TRUE in that assignment.
fn case(machine: &Machine, cut: &Cut, model: &Model) -> String {
    let values = model.evaluate(&cut.aig);
    let mut parts = Vec::new();
    let mut add = |lits: &[Lit], name: &dyn Fn(usize) -> String| {
        let on = lits.iter().enumerate().filter(|(_, l)| lanes(&values, **l) & 1 == 1);
        parts.extend(on.map(|(i, _)| name(i)));
    };
    let outputs: Vec<&str> = machine.outputs.values().map(|o| o.name.as_str()).collect();
    let inputs: Vec<&str> = machine.inputs.values().map(|i| i.name.as_str()).collect();
    add(&cut.inputs, &|i| inputs[i].to_owned());
    add(&cut.before.inputs, &|i| format!("prev({})", inputs[i]));
    add(&cut.before.outputs, &|i| format!("prev({})", outputs[i]));
    add(&cut.commands, &|i| format!("{} commanded", outputs[i]));
    add(&cut.outputs, &|i| format!("{} let through", outputs[i]));
    if parts.is_empty() { "when everything is FALSE".to_owned() } else { format!("with {}", parts.join(", ")) }
}
