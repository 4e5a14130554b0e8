//! Ranges, assignments and comparisons of integers: everything stays within the type INT, whatever
//! values the integers have, so no PLC computes anything else.

use super::Resolver;
use super::expressions::Context;
use super::names::Symbol;
use crate::base::{Code, Diagnostic, Span, limits};
use crate::ir::ast::{Name, VariableKind};
use crate::ir::chart::{Assignment, Atom, Guard, IntegerId, Machine};
use crate::ir::expr::Expr;
use crate::ir::number::{Comparison, Number, Range};

/// What has been reported already.
pub struct Reported;

/// Which integers an expression may name.
pub struct Named<A> {
    /// What a symbol is there, if it may be named.
    pub find: fn(Symbol) -> Option<A>,
    /// What it can be.
    pub range: fn(&Machine, &A) -> Range,
    /// In words.
    pub wanted: &'static str,
}

/// The integers of the program.
const PROGRAM: Named<IntegerId> = Named {
    find: |symbol| if let Symbol::Integer(id) = symbol { Some(id) } else { None },
    range: |machine, &i| machine.integers[i].range,
    wanted: "an integer",
};

impl Resolver {
    /// The range of an integer and its initial value: 0 or the bound next to it if none is given.
    pub fn range(&mut self, kind: &VariableKind) -> (Range, i64) {
        let &VariableKind::Integer { lowest, highest, initial, span } = kind else {
            unreachable!("only integers have ranges");
        };
        let range = Range { lowest, highest };
        if lowest > highest || !Range::INT.holds(range) {
            let (message, label) = if lowest > highest {
                ("the lowest value of a range stands first", "no value lies between these")
            } else {
                ("an integer of a PLC goes from -32768 to 32767", "goes beyond")
            };
            self.diagnostics.push(Diagnostic::new(Code::BadRange, message).label(span, label));
            // What was probably meant, so that nothing is said of what follows from it.
            let fit = |n: i64| n.clamp(Range::INT.lowest, Range::INT.highest);
            return (Range { lowest: fit(lowest.min(highest)), highest: fit(lowest.max(highest)) }, fit(lowest));
        }
        match initial {
            Some((n, _)) if range.holds(Range::of(n)) => (range, n),
            Some((n, at)) => {
                self.diagnostics.push(
                    Diagnostic::new(Code::BadRange, format!("{n} is not in the range {lowest}..{highest}"))
                        .label(at, "the initial value")
                        .label(span, "the range"),
                );
                (range, lowest)
            }
            None => (range, 0.clamp(lowest, highest)),
        }
    }

    /// Resolves `set N := …`.
    pub fn assignment(&mut self, name: &Name, value: &Number<Name>, span: Span) -> Option<Assignment> {
        let value = self.number(value, span, &PROGRAM);
        let integer = match self.symbol(&name.text) {
            Some(Symbol::Integer(id)) => id,
            Some(Symbol::Variable(_)) => {
                self.diagnostics.push(
                    Diagnostic::new(Code::WrongAssignment, format!("`{}` is a BOOL and takes no number", name.text))
                        .label(name.span, "an integer is expected here")
                        .help(format!("write `set {0}` or `reset {0}`", name.text)),
                );
                return None;
            }
            other => {
                self.wrong_symbol(name, other, "an integer");
                return None;
            }
        };
        let (value, found) = value.ok()?;
        let declared = &self.machine.integers[integer];
        self.within(&name.text, declared.range, declared.span, found, span);
        Some(Assignment { integer, value, span })
    }

    /// Reports a value that is never within the range of what it is given to.
    pub fn within(&mut self, name: &str, range: Range, declared: Span, found: Range, span: Span) {
        let Range { lowest, highest } = range;
        if found.highest < lowest || found.lowest > highest {
            self.diagnostics.push(
                Diagnostic::new(
                    Code::NeverInRange,
                    format!("this always lies outside the range of `{name}`, {lowest}..{highest}"),
                )
                .label(span, if found.lowest > highest { "too large" } else { "too small" })
                .label(declared, "declared here"),
            );
        }
    }

    /// Reports `set N` and `reset N` of an integer; says whether it is one.
    pub fn wants_number(&mut self, name: &Name) -> bool {
        let Some(Symbol::Integer(_)) = self.symbol(&name.text) else { return false };
        self.diagnostics.push(
            Diagnostic::new(Code::WrongAssignment, format!("`{}` is an integer: which value does it take?", name.text))
                .label(name.span, "a BOOL is expected here")
                .help(format!("let a transition say so: `then set {} := …`", name.text)),
        );
        true
    }

    /// Resolves a comparison; what cannot be resolved is reported and reads FALSE.
    pub fn compare(&mut self, written: &Comparison<Name>, span: Span, context: &Context) -> Guard {
        match context {
            Context::Sensor => {
                let message = "a sensor is read as it is now";
                self.misplaced(message, span, "an input is expected here", "a position is confirmed by inputs");
                return Expr::FALSE;
            }
            Context::Plant => {
                self.plant_reads(span, "integers are variables of the program");
                return Expr::FALSE;
            }
            Context::Guard { .. }
            | Context::Active { .. }
            | Context::Constraint
            | Context::Assumption
            | Context::Expectation => {}
        }
        let Some(comparison) = self.comparison(written, span, &PROGRAM) else { return Expr::FALSE };
        let all = &mut self.machine.comparisons;
        let id = *self.comparisons.entry(comparison.clone()).or_insert_with(|| all.push(comparison));
        Expr::Atom(Atom::Compare(id))
    }

    /// Resolves both sides of a comparison, and reports one that the ranges decide.
    pub fn comparison<A>(&mut self, written: &Comparison<Name>, span: Span, named: &Named<A>) -> Option<Comparison<A>> {
        let (left, right) = (self.number(&written.left, span, named), self.number(&written.right, span, named));
        let (Ok((left, of_left)), Ok((right, of_right))) = (left, right) else { return None };
        if let Some(value) = written.relation.decided(of_left, of_right) {
            let word = if value { "TRUE" } else { "FALSE" };
            let show = |r: Range| {
                if r.lowest == r.highest { r.lowest.to_string() } else { format!("{}..{}", r.lowest, r.highest) }
            };
            self.diagnostics.push(
                Diagnostic::new(Code::DecidedComparison, format!("this comparison is always {word}"))
                    .label(span, format!("{} on the left, {} on the right", show(of_left), show(of_right)))
                    .help("compare with a value within the range, or change the range"),
            );
        }
        Some(Comparison { left, relation: written.relation, right })
    }

    /// Resolves an expression that stands at `span`, and says what it can be.
    pub fn number<A>(
        &mut self,
        written: &Number<Name>,
        span: Span,
        named: &Named<A>,
    ) -> Result<(Number<A>, Range), Reported> {
        let number = written.try_map(&mut |name| {
            let symbol = self.symbol(&name.text);
            symbol.and_then(named.find).map(Number::Value).ok_or_else(|| {
                self.wrong_symbol(name, symbol, named.wanted);
                Reported
            })
        })?;
        if number.size() > limits::OPERANDS {
            self.diagnostics.push(
                Diagnostic::new(Code::LeavesInt, format!("an expression has at most {} operands", limits::OPERANDS))
                    .label(span, format!("this one has {}", number.size()))
                    .help("keep a part of it in a variable of its own"),
            );
            return Err(Reported);
        }
        let Some(range) = number.range(&|a| (named.range)(&self.machine, a)) else {
            self.diagnostics.push(
                Diagnostic::new(Code::LeavesInt, "a part of this expression can leave the type INT, -32768 to 32767")
                    .label(span, "too large or too small for some values")
                    .help("give the integers narrower ranges"),
            );
            return Err(Reported);
        };
        Ok((number, range))
    }
}
