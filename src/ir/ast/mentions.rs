//! The words of a tree that can mean an input, an output, a variable, an event or something hidden.
//!
//! They are read off the tree, so no text and no name of anything else is among them. Each struct is taken apart
//! whole: a field that is added has to be decided on here.

use super::*;

/// Hands each word that declares a signal, or means one where it stands, to `f`: in declarations, conditions,
/// effects, actions, and in what the plant and scenarios do.
pub fn mentions<'t>(tree: &'t Machine, f: &mut impl FnMut(&'t str)) {
    let Machine {
        name: _,
        description: _,
        cycles: _,
        inputs,
        outputs,
        variables,
        events,
        actuators,
        functions,
        sequences,
        observers,
        charts,
        safety,
        properties,
        accepted: _,
        plants,
        scenarios,
    } = tree;
    let mut m = Mentions { f };
    inputs.iter().chain(outputs).for_each(|s| m.name(&s.name));
    variables.iter().for_each(|v| m.name(&v.name));
    events.iter().for_each(|e| m.name(&e.name));
    actuators.iter().for_each(|a| m.actuator(a));
    functions.iter().for_each(|function| m.function(function));
    sequences.iter().for_each(|s| m.sequence(s));
    for Observer { name: _, description: _, body, after_filter } in observers {
        m.body(body);
        after_filter.iter().for_each(|b| m.body(b));
    }
    charts.iter().for_each(|Chart { name: _, controls: _, description: _, body }| m.body(body));
    safety.iter().for_each(|s| m.safety(s));
    for Property { name: _, kind: _, after, condition, text: _ } in properties {
        m.guards(after.iter().chain([condition]));
    }
    plants.iter().for_each(|p| m.plant(p));
    for Scenario { name: _, after: _, steps } in scenarios {
        m.steps(steps);
    }
}

struct Mentions<'f, F> {
    f: &'f mut F,
}

impl<'t, F: FnMut(&'t str)> Mentions<'_, F> {
    fn name(&mut self, name: &'t Name) {
        (self.f)(&name.text);
    }

    fn names(&mut self, names: impl IntoIterator<Item = &'t Name>) {
        names.into_iter().for_each(|n| self.name(n));
    }

    fn guards(&mut self, guards: impl IntoIterator<Item = &'t Guard>) {
        for Guard { expr, written: _, span: _ } in guards {
            expr.for_each_atom(&mut |term| match term {
                Term::Value(path) | Term::Prev(path) | Term::Rise(path) | Term::Fall(path) => {
                    (self.f)(&path.parts[0].0);
                }
                Term::Compare(Comparison { left, right, relation: _ }, _) => {
                    left.for_each_value(&mut |n: &'t Name| (self.f)(&n.text));
                    right.for_each_value(&mut |n: &'t Name| (self.f)(&n.text));
                }
                // States, constraints, times.
                Term::In(_)
                | Term::PrevIn(_)
                | Term::RiseIn(_)
                | Term::FallIn(_)
                | Term::DoneOf(_)
                | Term::Done(_)
                | Term::Acts(_)
                | Term::First(_)
                | Term::Blocked(_)
                | Term::Alarm(_)
                | Term::After(_) => {}
            });
        }
    }

    fn effects(&mut self, effects: impl IntoIterator<Item = &'t Effect>) {
        for Effect { variable, value } in effects {
            self.name(variable);
            match value {
                EffectValue::Integer(number, _) => number.for_each_value(&mut |n: &'t Name| (self.f)(&n.text)),
                EffectValue::Bool(_) | EffectValue::Raised => {}
            }
        }
    }

    fn actuator(&mut self, actuator: &'t Actuator) {
        let Actuator { name: _, technology: _, technology_span: _, valve: _, by, description: _, positions } = actuator;
        self.names(by);
        for Position { name: _, output, sensor, limit, description: _ } in positions {
            self.names(output);
            self.guards(sensor);
            self.effects(limit.iter().flat_map(|Limit { time: _, effects, span: _ }| effects));
        }
    }

    fn function(&mut self, function: &'t Function) {
        let Function { name: _, automatic: _, description: _, activate, deactivate, abort, request, release, body } =
            function;
        self.guards([activate, deactivate, abort, request, release].into_iter().flatten());
        self.body(body);
    }

    fn sequence(&mut self, sequence: &'t Sequence) {
        let Sequence { name: _, description: _, abort, steps } = sequence;
        self.guards(abort);
        for SequenceStep { doing, span: _, description: _ } in steps {
            match doing {
                SequenceDoing::Do(jobs) => {
                    self.guards(jobs.iter().filter_map(|Job { function: _, until }| until.as_ref()));
                }
                SequenceDoing::Until(guard) => self.guards([guard]),
                SequenceDoing::Activate(_) | SequenceDoing::Deactivate(_) | SequenceDoing::Wait(_) => {}
            }
        }
    }

    fn body(&mut self, body: &'t Body) {
        let Body { states, regions, choices, transitions, drives, actions, entry, exit, internals, span: _ } = body;
        for state in states {
            let State { name: _, initial: _, is_final: _, parallel: _, position: _, controls: _, description: _, body } =
                state;
            body.iter().for_each(|b| self.body(b));
        }
        regions.iter().for_each(|Region { name: _, controls: _, description: _, body }| self.body(body));
        for Choice { name: _, initial: _, description: _, branches } in choices {
            for Branch { guard, target: _, effects, description: _, span: _ } in branches {
                self.guards(guard);
                self.effects(effects);
            }
        }
        for transition in transitions {
            let Transition { source: _, target: _, movement: _, priority: _, guard, effects, description: _, span: _ } =
                transition;
            self.guards(guard);
            self.effects(effects);
        }
        for Drive { output, condition } in drives {
            self.name(output);
            self.guards(condition);
        }
        for Action { variable, value: _, condition } in actions {
            self.name(variable);
            self.guards(condition);
        }
        self.effects(entry.iter().chain(exit));
        for Internal { guard, effects, description: _, span: _ } in internals {
            self.guards([guard]);
            self.effects(effects);
        }
    }

    fn safety(&mut self, safety: &'t Safety) {
        let Safety { mode: _, in_order: _, reset, constraints, assumptions, forbids: _, derives: _, unkept: _ } =
            safety;
        self.names(reset);
        for Constraint { name: _, never, yields, text: _, from: _ } in constraints.iter().chain(assumptions) {
            self.guards([never]);
            self.names(yields);
        }
    }

    fn plant(&mut self, plant: &'t Plant) {
        let Plant { by_steps: _, hidden, initially, travels, rules, steps } = plant;
        hidden.iter().for_each(|Hidden { name, integer: _, description: _ }| self.name(name));
        self.steps(initially);
        for travel in travels {
            let Travel { actuator: _, at_most: _, out: _, back: _, driven: _, power, description: _ } = travel;
            self.guards(power);
        }
        for Rule { target, change: _, condition, delay: _, description: _ } in rules {
            self.name(target);
            self.guards([condition]);
        }
        for Happening { text: _, condition, outcomes } in steps {
            self.guards([condition]);
            for (effect, condition) in outcomes {
                self.effects([effect]);
                self.guards(condition);
            }
        }
    }

    fn steps(&mut self, steps: &'t [Step]) {
        for Step { doing, span: _, description: _ } in steps {
            match doing {
                Doing::Set(names, _) | Doing::Any(names) | Doing::Press(names, _) | Doing::Release(names) => {
                    self.names(names);
                }
                Doing::Force(forced) => self.names(forced.iter().map(|(name, _)| name)),
                Doing::Until(guard, _) | Doing::Expect(guard) | Doing::Watch(guard, _) => self.guards([guard]),
                Doing::Repeat(_, _, inner) => self.steps(inner),
                Doing::Place(..) | Doing::Happens(..) | Doing::Wait(_) => {}
            }
        }
    }
}
