//! Written properties to conditions over all that can be seen at the end of a scan.

use super::Resolver;
use super::expressions::Context;
use super::names::describe;
use crate::base::{Span, iec};
use crate::ir::ast;
use crate::ir::scenario::Property;
use std::collections::HashMap;

pub fn resolve(r: &mut Resolver, tree: &ast::Machine) {
    let mut names: HashMap<String, Span> = HashMap::new();
    for written in &tree.properties {
        r.legal(&written.name);
        let name = iec::fold(&written.name.text);
        if let Some(&first) = names.get(&name) {
            r.duplicate(&written.name, first);
        } else {
            names.insert(name, written.name.span);
        }
        let after = written.after.as_ref().map(|after| r.condition(after, &Context::Expectation));
        let condition = r.condition(&written.condition, &Context::Expectation);
        r.machine.properties.push(Property {
            name: written.name.text.clone(),
            kind: written.kind,
            after,
            condition,
            says: match &written.after {
                Some(after) => format!("after {} eventually {}", after.written, written.condition.written),
                None => format!("{} {}", written.kind.words(), written.condition.written),
            },
            written: written.condition.written.clone(),
            text: describe(&written.text),
            span: written.name.span,
        });
    }
}
