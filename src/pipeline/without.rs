//! A model as it would be had some of its constraints not been written.
//!
//! They are taken out of the syntax tree, derived ones too, before anything looks at them: what comes out is what the
//! compiler makes of a model without them, or why it would refuse that model.

use super::front::front;
use crate::base::{Code, Diagnostic, Diagnostics, iec};
use crate::ir::ast::{self, Guard, Term};
use crate::ir::chart::Machine;
use std::collections::BTreeSet;

/// Text to a machine that keeps every rule, without the constraints of these names. Without errors among the
/// diagnostics there is one.
///
/// Where some are left out, so are scenarios, and the properties that ask what the filter does for them.
pub fn check(source: &str, without: &[String]) -> (Option<Machine>, Diagnostics) {
    let leave_out = |tree: &mut ast::Machine| match without {
        [] => Diagnostics::new(),
        names => leave_out(tree, names),
    };
    front(source, leave_out).whole()
}

/// Takes constraints out of a tree, and reports names that are none.
fn leave_out(tree: &mut ast::Machine, names: &[String]) -> Diagnostics {
    let mut diagnostics = Diagnostics::new();
    let folded: BTreeSet<String> = names.iter().map(|name| iec::fold(name)).collect();
    let is_out = |name: &str| folded.contains(&iec::fold(name));
    let written: BTreeSet<String> =
        tree.safety.iter().flat_map(|s| &s.constraints).map(|c| iec::fold(&c.name.text)).collect();
    for name in names.iter().filter(|name| !written.contains(&iec::fold(name))) {
        diagnostics.push(
            Diagnostic::new(Code::UnknownName, format!("there is no constraint `{name}` to be left out"))
                .help("`chartwright constraints FILE` lists them, derived ones too"),
        );
    }
    for safety in &mut tree.safety {
        safety.constraints.retain(|c| !is_out(&c.name.text));
    }
    let asks = |guard: &Guard| {
        let mut asks = false;
        guard.expr.for_each_atom(&mut |term| {
            if let Term::Acts(path) | Term::First(path) | Term::Alarm(path) = term {
                asks |= path.parts.iter().any(|(word, _)| is_out(word));
            }
        });
        asks
    };
    tree.accepted.retain(|a| match &a.finding {
        ast::Accepted::Acts(name) => !is_out(&name.text),
        // Which reliefs set each other off is another matter without them.
        ast::Accepted::Cyclic(_) => false,
        _ => true,
    });
    let gone: Vec<String> = {
        let goes = |p: &&ast::Property| asks(&p.condition) || p.after.as_ref().is_some_and(asks);
        tree.properties.iter().filter(goes).map(|p| iec::fold(&p.name.text)).collect()
    };
    tree.accepted.retain(|a| !matches!(&a.finding, ast::Accepted::Void(name) if gone.contains(&iec::fold(&name.text))));
    tree.properties.retain(|p| !asks(&p.condition) && !p.after.as_ref().is_some_and(asks));
    tree.scenarios.clear();
    diagnostics
}
