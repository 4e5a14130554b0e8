//! Hidden integers and what may happen in a plant, to what they mean.

use super::Resolver;
use super::expressions::Context;
use super::integers::{Named, Reported};
use super::names::Symbol;
use crate::base::{Code, Diagnostic, Span};
use crate::ir::ast::{self, EffectValue, Name};
use crate::ir::expr::Expr;
use crate::ir::number::{Comparison, Number};
use crate::ir::scenario::{Alteration, Condition, CountId, Counted, Happening, Outcome, Seen};

/// What a plant counts.
const HIDDEN: Named<CountId> = Named {
    find: |symbol| if let Symbol::Count(id) = symbol { Some(id) } else { None },
    range: |machine, &c| machine.plant.counts[c].range,
    wanted: "a hidden integer",
};

/// The same where only the plant is looked at.
const PLANT: Named<Counted> = Named {
    find: |symbol| (HIDDEN.find)(symbol).map(Counted::Hidden),
    range: |machine, counted| (ALL.range)(machine, counted),
    wanted: "a hidden integer",
};

/// All that is counted.
const ALL: Named<Counted> = Named {
    find: |symbol| match symbol {
        Symbol::Integer(id) => Some(Counted::Program(id)),
        Symbol::Count(id) => Some(Counted::Hidden(id)),
        Symbol::Input(_) | Symbol::Output(_) | Symbol::Variable(_) | Symbol::Event(_) | Symbol::Bit(_) => None,
    },
    range: |machine, &counted| match counted {
        Counted::Program(i) => machine.integers[i].range,
        Counted::Hidden(c) => machine.plant.counts[c].range,
    },
    wanted: "an integer",
};

impl Resolver {
    /// Whether a comparison names a hidden integer.
    pub fn compares_hidden(&self, comparison: &Comparison<Name>) -> bool {
        let mut hidden = false;
        let mut look = |name: &Name| hidden |= matches!(self.symbol(&name.text), Some(Symbol::Count(_)));
        comparison.left.for_each_value(&mut look);
        comparison.right.for_each_value(&mut look);
        hidden
    }

    /// Resolves a comparison that does, where it may stand: in plants, scenarios and properties.
    pub fn compare_hidden(&mut self, written: &Comparison<Name>, span: Span, context: &Context) -> Condition {
        let named = if matches!(context, Context::Plant) { PLANT } else { ALL };
        let Some(comparison) = self.comparison(written, span, &named) else { return Expr::FALSE };
        let all = &mut self.machine.plant.comparisons;
        let known = all.iter().find(|(_, c)| **c == comparison).map(|(id, _)| id);
        Expr::Atom(Seen::Compare(known.unwrap_or_else(|| all.push(comparison))))
    }

    /// Resolves something that may happen.
    pub fn happening(&mut self, written: &ast::Happening) {
        let condition = self.condition(&written.condition, &Context::Plant);
        self.timeless(&condition, written.condition.span);
        let mut outcomes = Vec::new();
        // What has been changed whatever else is so; then a second change makes no sense.
        let mut always: Vec<(Symbol, Span)> = Vec::new();
        for (effect, when) in &written.outcomes {
            let name = &effect.variable;
            let symbol = self.symbol(&name.text);
            match (always.iter().find(|(s, _)| Some(*s) == symbol), when) {
                (Some(&(_, first)), None) => {
                    self.diagnostics.push(
                        Diagnostic::new(Code::Repeated, format!("`{}` changes twice in one step", name.text))
                            .label(name.span, "changed again")
                            .label(first, "first changed here"),
                    );
                    continue;
                }
                (None, None) => always.extend(symbol.map(|s| (s, name.span))),
                (_, Some(_)) => {}
            }
            let condition = match when {
                Some(when) => {
                    let condition = self.condition(when, &Context::Plant);
                    self.timeless(&condition, when.span);
                    condition
                }
                None => Expr::TRUE,
            };
            let change = match (symbol, &effect.value) {
                (Some(Symbol::Bit(bit)), EffectValue::Bool(value)) => Alteration::Bit(bit, *value),
                (Some(Symbol::Count(count)), EffectValue::Integer(value, span)) => {
                    let Some(value) = self.counted(count, value, *span) else { continue };
                    Alteration::Count(count, value)
                }
                (Some(Symbol::Count(_)), _) => {
                    self.wrong_symbol(name, symbol, "a hidden bit");
                    continue;
                }
                (_, EffectValue::Integer(..)) => {
                    self.wrong_symbol(name, symbol, "a hidden integer");
                    continue;
                }
                _ => {
                    self.wrong_symbol(name, symbol, "a hidden bit or integer");
                    continue;
                }
            };
            outcomes.push(Outcome { change, condition });
        }
        let (text, span) = (written.text.value.clone(), written.text.span);
        self.machine.plant.happenings.push(Happening { text, condition, outcomes, span });
    }

    fn counted(&mut self, count: CountId, value: &Number<Name>, span: Span) -> Option<Number<CountId>> {
        let (value, found) = match self.number(value, span, &HIDDEN) {
            Ok(value) => value,
            Err(Reported) => return None,
        };
        let declared = &self.machine.plant.counts[count];
        let (name, range, declared) = (declared.name.clone(), declared.range, declared.span);
        self.within(&name, range, declared, found, span);
        Some(value)
    }

    /// Reports a condition that reads the past where there is none: between two scans.
    pub fn timeless(&mut self, condition: &Condition, span: Span) {
        let mut past = false;
        condition.for_each_atom(&mut |seen| past |= seen.is_past());
        if past {
            self.diagnostics.push(
                Diagnostic::new(Code::PlantReads, "a step of the plant has no scan before it")
                    .label(span, "`prev`, `rise` or `fall` is read here")
                    .help("let a hidden bit keep what is worth remembering"),
            );
        }
    }
}
