//! Written conditions to guards: what may be read where.

use super::names::{Braces, Symbol, kind};
use super::{LONGEST_TIME, Resolver};
use crate::base::{Code, Diagnostic, Span};
use crate::ir::ast::{self, PathRef, Term};
use crate::ir::chart::{self, Atom, Guard, Phase};
use crate::ir::expr::Expr;

/// Where a condition stands, which decides what it may read.
#[derive(Clone, Copy, Debug)]
pub enum Context {
    /// `sensor …`: inputs.
    Sensor,
    /// `when …` of a transition: all but outputs of this scan, and these too after the filter.
    Guard {
        /// Where names of states are looked up first.
        braces: Braces,
        /// What `done` alone means.
        source: chart::StateId,
        /// When it is read.
        phase: Phase,
    },
    /// `when …` of a drive or action of an active state.
    Active {
        /// Where names of states are looked up first.
        braces: Braces,
    },
    /// `never …`: all but states of control charts.
    Constraint,
    /// `assume … never …`: all but states of control charts and outputs of this scan.
    Assumption,
    /// A condition of the plant: inputs and outputs.
    Plant,
    /// A condition of a scenario: everything.
    Expectation,
}

impl Resolver {
    /// Resolves a condition; what cannot be resolved is reported and reads FALSE.
    pub fn guard(&mut self, guard: &ast::Guard, context: &Context) -> Guard {
        guard.expr.map(&mut |term| self.term(term, context))
    }

    pub fn term(&mut self, term: &Term, context: &Context) -> Guard {
        match term {
            Term::Value(path) => self.value(path, context),
            Term::Compare(comparison, span) => self.compare(comparison, *span, context),
            Term::Prev(path) => self.previous(path, context),
            Term::Rise(path) => self.edge(path, context, true),
            Term::Fall(path) => self.edge(path, context, false),
            Term::In(path) => self.about_state(path, context, Atom::In),
            Term::PrevIn(path) | Term::RiseIn(path) | Term::FallIn(path) => {
                self.misplaced(
                    "only properties and scenarios ask for the past of a state",
                    path.span(),
                    "not remembered here",
                    "`in(STATE)` in a guard is from before the step; what is to be remembered longer needs a variable",
                );
                Expr::FALSE
            }
            Term::DoneOf(path) if matches!(context, Context::Constraint | Context::Assumption) => {
                self.knows_no_states(path, context)
            }
            Term::DoneOf(path) => self.about_state(path, context, Atom::Done),
            Term::After(time) => self.elapsed(time, context),
            Term::Done(span) => match context {
                Context::Guard { source, .. } => Expr::Atom(Atom::Done(*source)),
                _ => {
                    self.misplaced(
                        "`done` alone means the source of a transition",
                        *span,
                        "there is none here",
                        "write `done(STATE)`",
                    );
                    Expr::FALSE
                }
            },
            Term::Alarm(path) | Term::Acts(path) | Term::First(path) => {
                self.misplaced(
                    "only a scenario asks what constraints do",
                    path.span(),
                    "not allowed here",
                    "say it by what the constraint says",
                );
                Expr::FALSE
            }
            Term::Blocked(span) => {
                self.misplaced(
                    "only a scenario asks whether the machine is blocked",
                    *span,
                    "not allowed here",
                    "charts run on while it is, as if nobody looked at what they command",
                );
                Expr::FALSE
            }
        }
    }

    fn elapsed(&mut self, time: &ast::Duration, context: &Context) -> Guard {
        let Context::Guard { source, .. } = context else {
            self.misplaced(
                "`after` counts the time in the source of a transition",
                time.span,
                "there is none here",
                "let a transition wait, and ask for its target by `in(STATE)`",
            );
            return Expr::FALSE;
        };
        self.time(time).map_or(Expr::FALSE, |ms| Expr::Atom(Atom::After(*source, ms)))
    }

    /// A time that a state can wait for, in milliseconds, or an error.
    pub fn time(&mut self, time: &ast::Duration) -> Option<u32> {
        let ms = time.milliseconds.filter(|ms| (1..=LONGEST_TIME).contains(ms));
        if ms.is_none() {
            self.diagnostics.push(
                Diagnostic::new(Code::BadTime, "a time takes from 1 ms to one day").label(time.span, "out of range"),
            );
        }
        ms
    }

    /// The symbol that a path of one word means; reports what is none.
    fn single(&mut self, path: &PathRef) -> Option<Symbol> {
        let (name, span) = &path.parts[0];
        if path.parts.len() > 1 {
            let text = path.parts.iter().map(|p| p.0.as_str()).collect::<Vec<_>>().join(".");
            self.misplaced(
                &format!("`{text}` is no input, output or variable"),
                path.span(),
                "a value is expected here",
                &format!("to ask whether a state is active, write `in({text})`"),
            );
            return None;
        }
        let symbol = self.symbol(name);
        if symbol.is_none() {
            self.unknown_symbol(name, *span);
        }
        symbol
    }

    fn value(&mut self, path: &PathRef, context: &Context) -> Guard {
        let Some(symbol) = self.single(path) else { return Expr::FALSE };
        let name = &path.parts[0].0;
        match (symbol, context) {
            (Symbol::Input(id), _) => Expr::Atom(Atom::Input(id)),
            (
                Symbol::Variable(id),
                Context::Guard { .. }
                | Context::Active { .. }
                | Context::Constraint
                | Context::Assumption
                | Context::Expectation,
            ) => Expr::Atom(Atom::Variable(id)),
            (
                Symbol::Event(id),
                Context::Guard { .. }
                | Context::Active { .. }
                | Context::Constraint
                | Context::Assumption
                | Context::Expectation,
            ) => Expr::Atom(Atom::Event(id)),
            (
                Symbol::Output(id),
                Context::Constraint | Context::Plant | Context::Expectation | Context::Guard { phase: Phase::End, .. },
            ) => Expr::Atom(Atom::Output(id)),
            (Symbol::Variable(_) | Symbol::Event(_), Context::Plant) => {
                self.plant_reads(path.span(), &format!("`{name}` is {} of the program", kind(symbol)));
                Expr::FALSE
            }
            (Symbol::Integer(_), Context::Plant) => {
                self.plant_reads(path.span(), &format!("`{name}` is a variable of the program"));
                Expr::FALSE
            }
            (Symbol::Integer(_), _) => self.neither_nor(path),
            (Symbol::Count(_), Context::Plant | Context::Expectation) => self.neither_nor(path),
            (Symbol::Bit(_) | Symbol::Count(_), _) => self.hidden(path),
            (Symbol::Output(_), Context::Assumption) => {
                self.bad_assumption(path.span(), &format!("`{name}` is what the program decides in this scan"));
                Expr::FALSE
            }
            (Symbol::Output(_), Context::Guard { .. } | Context::Active { .. }) => {
                self.misplaced(
                    &format!("the output `{name}` is not decided yet when this is read"),
                    path.span(),
                    "outputs are written at the end of the scan",
                    &format!("for its value of the scan before, write `prev({name})`"),
                );
                Expr::FALSE
            }
            (Symbol::Output(_) | Symbol::Variable(_) | Symbol::Event(_), Context::Sensor) => {
                self.only_inputs(path, symbol)
            }
        }
    }

    fn previous(&mut self, path: &PathRef, context: &Context) -> Guard {
        let Some(symbol) = self.single(path) else { return Expr::FALSE };
        match (symbol, context) {
            (_, Context::Sensor) => self.only_inputs(path, symbol),
            (Symbol::Input(id), _) => Expr::Atom(Atom::PrevInput(id)),
            (Symbol::Output(id), _) => Expr::Atom(Atom::PrevOutput(id)),
            (Symbol::Variable(_) | Symbol::Integer(_) | Symbol::Event(_), _) => self.no_past(path, symbol),
            (Symbol::Count(_), Context::Plant | Context::Expectation) => self.no_past(path, symbol),
            (Symbol::Bit(_) | Symbol::Count(_), _) => self.hidden(path),
        }
    }

    fn edge(&mut self, path: &PathRef, context: &Context, rising: bool) -> Guard {
        let Some(symbol) = self.single(path) else { return Expr::FALSE };
        let (now, before) = match (symbol, context) {
            (_, Context::Sensor) => return self.only_inputs(path, symbol),
            (Symbol::Input(id), _) => (Atom::Input(id), Atom::PrevInput(id)),
            (
                Symbol::Output(id),
                Context::Constraint | Context::Plant | Context::Expectation | Context::Guard { phase: Phase::End, .. },
            ) => (Atom::Output(id), Atom::PrevOutput(id)),
            (Symbol::Count(_), Context::Plant | Context::Expectation) => return self.no_past(path, symbol),
            (Symbol::Bit(_) | Symbol::Count(_), _) => return self.hidden(path),
            (Symbol::Output(_), _) => return self.value(path, context),
            (Symbol::Variable(_) | Symbol::Integer(_) | Symbol::Event(_), _) => return self.no_past(path, symbol),
        };
        let (now, before) = (Expr::Atom(now), Expr::Atom(before));
        if rising { Expr::all([before.not(), now]) } else { Expr::all([before, now.not()]) }
    }

    pub fn about_state(&mut self, path: &PathRef, context: &Context, atom: impl Fn(chart::StateId) -> Atom) -> Guard {
        let braces = match context {
            Context::Guard { braces, .. } | Context::Active { braces } => Some(*braces),
            Context::Constraint | Context::Assumption | Context::Expectation => self.outermost(&path.parts[0].0),
            Context::Plant => {
                self.plant_reads(path.span(), "the active states are what the program knows");
                return Expr::FALSE;
            }
            Context::Sensor => {
                self.misplaced(
                    "a sensor does not know of states",
                    path.span(),
                    "an input is expected here",
                    "name inputs only",
                );
                return Expr::FALSE;
            }
        };
        let parts: Vec<(&str, Span)> = path.parts.iter().map(|(t, s)| (t.as_str(), *s)).collect();
        let found = match (self.chart(parts[0].0), &parts[1..]) {
            // The name of a chart may stand before the path.
            (Some(first), rest @ [_, ..]) => self.state_of_chart(&parts[0], rest, first),
            _ => self.state(&parts, braces),
        };
        let Some(state) = found else { return Expr::FALSE };
        // What an observer has rebuilt is a fact like an input.
        if matches!(context, Context::Constraint | Context::Assumption) && !self.machine.observes(state) {
            return self.knows_no_states(path, context);
        }
        if let Context::Guard { braces, .. } | Context::Active { braces } = context
            && self.machine.kind(self.around(*braces)) == chart::ChartKind::Observer
            && !self.machine.observes(state)
        {
            let name = self.machine.state_path(state);
            self.diagnostics.push(
                Diagnostic::new(Code::ObserverReads, format!("`{name}` is a state of a control chart"))
                    .label(path.span(), "an observer cannot see it")
                    .help("let the observer follow what the chart does to the outputs: `prev(…)`"),
            );
        }
        Expr::Atom(atom(state))
    }

    /// Reports a state where only those of observers may be asked for.
    fn knows_no_states(&mut self, path: &PathRef, context: &Context) -> Guard {
        if matches!(context, Context::Assumption) {
            self.bad_assumption(path.span(), "the active states are what the program decides");
        } else {
            self.misplaced(
                "a safety constraint knows of states only whether those of observers are active",
                path.span(),
                "not allowed here",
                "constraints hold whatever the charts do: say it by inputs, outputs, their past and `in(…)` of observers",
            );
        }
        Expr::FALSE
    }

    fn only_inputs(&mut self, path: &PathRef, symbol: Symbol) -> Guard {
        let text = match symbol {
            Symbol::Input(_) => "a sensor is read as it is now".to_owned(),
            other => format!("`{}` is {}, not an input", path.parts[0].0, kind(other)),
        };
        self.misplaced(
            &text,
            path.span(),
            "an input is expected here",
            "a position is confirmed by inputs, joined by `and`, `or`, `not`",
        );
        Expr::FALSE
    }

    fn neither_nor(&mut self, path: &PathRef) -> Guard {
        let name = &path.parts[0].0;
        self.misplaced(
            &format!("`{name}` is an integer, neither TRUE nor FALSE"),
            path.span(),
            "a condition is expected here",
            &format!("compare it: `{name} = 1`"),
        );
        Expr::FALSE
    }

    fn hidden(&mut self, path: &PathRef) -> Guard {
        let name = &path.parts[0].0;
        self.misplaced(
            &format!("`{name}` is hidden in the plant"),
            path.span(),
            "the program cannot see it",
            "no sensor tells it; only the plant and scenarios may name it",
        );
        Expr::FALSE
    }

    pub fn plant_reads(&mut self, span: Span, message: &str) {
        self.diagnostics.push(
            Diagnostic::new(Code::PlantReads, message)
                .label(span, "a plant sees what stands at the terminals")
                .help("name inputs, outputs and hidden bits only"),
        );
    }

    fn no_past(&mut self, path: &PathRef, symbol: Symbol) -> Guard {
        let name = &path.parts[0].0;
        let help = match symbol {
            Symbol::Event(_) => format!("`{name}` is TRUE for one scan only: write `{name}` itself"),
            Symbol::Count(_) => "a hidden bit can keep what is worth remembering".to_owned(),
            _ => format!("guards read `{name}` as it was before the step anyway"),
        };
        self.misplaced(
            &format!("`{name}` is {}: it has no previous value", kind(symbol)),
            path.span(),
            "an input or output is expected here",
            &help,
        );
        Expr::FALSE
    }

    pub fn misplaced(&mut self, message: &str, span: Span, label: &str, help: &str) {
        self.diagnostics.push(Diagnostic::new(Code::WrongKind, message).label(span, label).help(help));
    }

    fn bad_assumption(&mut self, span: Span, message: &str) {
        self.diagnostics.push(
            Diagnostic::new(Code::BadAssumption, message)
                .label(span, "an assumption speaks of the plant")
                .help("name inputs, previous values (`prev(…)`) and variables only"),
        );
    }
}
