//! The constraints leave the filter a way out: properties 1, 3 and 4 of the paper on logical constraints, for
//! all that the filter can come to under the declared assumptions ([`crate::constraints::properties`]).

use super::excuses::Excuses;
use crate::base::{Code, Diagnostic, Diagnostics};
use crate::constraints::properties::{self, Kind, Violation};
use crate::constraints::questions::Witness;
use crate::constraints::safe;
use crate::ir::chart::{ConstraintId, Machine, Relief};
use crate::ir::relief::Reliefs;
use crate::ir::scenario::Excused;

pub fn check(machine: &Machine, excuses: &mut Excuses<'_>, found: &mut Diagnostics) {
    if machine.safety.relief != Relief::Together {
        return; // What is in order is another matter.
    }
    let reliefs = Reliefs::of(&machine.safety);
    let constraints = &machine.safety.constraints;
    let violations = properties::violations(machine, &reliefs);
    let coherent = violations.is_empty();
    violations.iter().for_each(|v| found.push(describe(machine, v)));
    if !coherent {
        if violations.iter().all(|v| v.kind != Kind::Forced)
            && let Some(witness) = safe::hopeless(machine)
        {
            found.push(no_safe_outputs(machine, &witness));
        }
        return; // What is said of a cycle holds only for constraints that are coherent.
    }
    for cycle in &reliefs.cycles {
        let mut of: Vec<ConstraintId> = cycle.iter().map(|&j| reliefs.combined[j].constraint).collect();
        let mut names: Vec<&str> = of.iter().map(|&c| constraints[c].name.as_str()).collect();
        names.dedup();
        let d = Diagnostic::new(Code::CyclicReliefs, format!("the reliefs of {} set each other off", names.join(", ")))
            .label(constraints[of[0]].span, "one of them")
            .help("this is coherent, but the filter needs a round for each output in the cycle that yields");
        of.sort_unstable();
        of.dedup();
        excuses.warn(&Excused::Cyclic(of), d, found);
    }
}

/// Constraints that nobody can meet.
pub fn no_safe_outputs(machine: &Machine, witness: &Witness) -> Diagnostic {
    Diagnostic::new(Code::NoSafeOutputs, "no outputs meet all constraints")
        .label(machine.safety.span, "whoever yields")
        .help(format!("there are none when {}", witness.show(machine)))
        .help("add a condition to one of the constraints, or `assume` that this cannot happen")
}

/// A violated property in words.
pub fn describe(machine: &Machine, violation: &Violation) -> Diagnostic {
    let [a, b] = violation.constraints.map(|c| &machine.safety.constraints[c]);
    let output = &machine.outputs[violation.output].name;
    let case = violation.witness.show(machine);
    let word = |value| if value { "on" } else { "off" };
    match violation.kind {
        Kind::Forced => Diagnostic::new(
            Code::ContradictingConstraints,
            format!("`{}` forces `{output}` off while `{}` forces it on", a.name, b.name),
        )
        .label(b.span, "forces it on")
        .label(a.span, "forces it off")
        .help(format!("both at once when {case}"))
        .help("add a condition to one of them, or `assume` that this cannot happen"),
        Kind::Relieved => Diagnostic::new(
            Code::ContradictingReliefs,
            format!("`{output}` yields to `{}` by going off and to `{}` by going on", a.name, b.name),
        )
        .label(b.span, "here it must go on")
        .label(a.span, "here it must go off")
        .help(format!("both in one scan when {case}"))
        .help("let another output yield in one of them"),
        Kind::Blocked { value } => Diagnostic::new(
            Code::BlockedRelief,
            format!("`{output}` cannot go {} for `{}`: `{}` holds it {}", word(value), a.name, b.name, word(!value)),
        )
        .label(a.span, format!("needs `{output}` to yield"))
        .label(b.span, format!("holds `{output}` {}", word(!value)))
        .help(format!("both at once when {case}"))
        .help(
            "let another output yield, or write the constraint with the edge of the one that yields, such as `rise(…)`",
        ),
    }
}
