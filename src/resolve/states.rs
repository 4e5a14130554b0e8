//! Declared observers, charts, regions and states to those of the machine; movements become states.

use super::names::describe;
use super::targets::Choice;
use super::{ResolvedBody, Resolver};
use crate::base::{Code, Diagnostic, Span};
use crate::ir::{ast, chart};

/// Enters the states of all charts and returns the braces that hold transitions and behaviour, in
/// the order in which they open, and the choices.
pub fn resolve<'a>(r: &mut Resolver, tree: &'a ast::Machine) -> (Vec<ResolvedBody<'a>>, Vec<Choice<'a>>) {
    let mut bodies = Vec::new();
    let mut choices = Vec::new();
    if tree.charts.is_empty() && !r.diagnostics.has_errors() {
        r.diagnostics.push(
            Diagnostic::new(Code::NoChart, format!("`{}` has no chart", tree.name.text))
                .label(tree.name.span, "nothing controls this machine")
                .help("add `chart NAME { … }` with its states"),
        );
    }
    for declared in &tree.observers {
        let kind = chart::ChartKind::Observer;
        let region = chart(
            r,
            (&mut bodies, &mut choices),
            kind,
            (&declared.name, &declared.description),
            (&declared.body, None),
        );
        for body in &declared.after_filter {
            let phase = chart::Phase::End;
            bodies.push(ResolvedBody { body, region, owns_region: true, state: None, phase, movements: Vec::new() });
        }
    }
    for declared in &tree.charts {
        let kind = chart::ChartKind::Control;
        let body = (&declared.body, declared.controls.as_ref());
        chart(r, (&mut bodies, &mut choices), kind, (&declared.name, &declared.description), body);
    }
    (bodies, choices)
}

/// Enters a chart or observer; returns its first region.
fn chart<'a>(
    r: &mut Resolver,
    (bodies, choices): (&mut Vec<ResolvedBody<'a>>, &mut Vec<Choice<'a>>),
    kind: chart::ChartKind,
    (name, description): (&'a ast::Name, &Option<ast::Text>),
    (body, controls): (&'a ast::Body, Option<&ast::Name>),
) -> chart::RegionId {
    r.legal(name);
    if let Some(first) = r.machine.charts.iter().find(|c| c.name.eq_ignore_ascii_case(&name.text)) {
        let first = first.span;
        r.duplicate(name, first);
    }
    let index = r.machine.charts.len();
    r.machine.charts.push(chart::Chart {
        name: name.text.clone(),
        kind,
        description: describe(description),
        regions: Vec::new(),
        span: name.span,
    });
    let mut builder = Builder { r, bodies, choices, chart: index };
    let regions = builder.regions(body, name, controls, None);
    let first = regions[0];
    r.machine.charts[index].regions = regions;
    first
}

struct Builder<'r, 'a, 'b> {
    r: &'r mut Resolver,
    bodies: &'b mut Vec<ResolvedBody<'a>>,
    choices: &'b mut Vec<Choice<'a>>,
    chart: usize,
}

impl<'a> Builder<'_, 'a, '_> {
    /// The regions of a chart or composite state. Recursion is bounded by the nesting limit.
    fn regions(
        &mut self,
        body: &'a ast::Body,
        owner: &ast::Name,
        controls: Option<&ast::Name>,
        parent: Option<chart::StateId>,
    ) -> Vec<chart::RegionId> {
        if body.regions.is_empty() {
            return vec![self.region(body, None, owner.span, String::new(), controls, parent)];
        }
        if let Some(state) = body.states.first() {
            self.r.diagnostics.push(
                Diagnostic::new(
                    Code::EmptyState,
                    format!("`{}` holds regions, so it holds no states itself", owner.text),
                )
                .label(state.name.span, "a state outside the regions")
                .label(body.regions[0].name.span, "the first region"),
            );
        }
        if let Some(choice) = body.choices.first() {
            self.r.diagnostics.push(
                Diagnostic::new(Code::WrongKind, "no region holds this choice")
                    .label(choice.name.span, "beside the regions")
                    .help("write it between the braces of the region whose states it leads to"),
            );
        }
        if let (None, Some(transition)) = (parent, body.transitions.first()) {
            self.r.diagnostics.push(
                Diagnostic::new(Code::WrongKind, "no region of the chart holds this transition")
                    .label(transition.span, "beside the regions")
                    .help("write it between the braces of the region whose states it joins"),
            );
        }
        if let [only] = body.regions.as_slice() {
            self.r.diagnostics.push(
                Diagnostic::new(Code::EmptyState, format!("`{}` has only one region", owner.text))
                    .label(only.name.span, "nothing runs beside it")
                    .help("a single region needs no name: put its states directly between the braces"),
            );
        }
        if let Some(name) = controls {
            self.r.diagnostics.push(
                Diagnostic::new(Code::WrongKind, format!("`{}` has several regions", owner.text))
                    .label(name.span, "which of them?")
                    .help("write `controls` behind the name of a region"),
            );
        }
        body.regions
            .iter()
            .map(|declared| {
                if let Some(nested) = declared.body.regions.first() {
                    self.r.diagnostics.push(
                        Diagnostic::new(
                            Code::EmptyState,
                            format!("`{}` stands directly in a region", nested.name.text),
                        )
                        .label(nested.name.span, "a region belongs to a parallel state")
                        .label(declared.name.span, "this is a region"),
                    );
                }
                let description = describe(&declared.description);
                let name = Some(&declared.name);
                self.region(&declared.body, name, declared.name.span, description, declared.controls.as_ref(), parent)
            })
            .collect()
    }

    fn region(
        &mut self,
        body: &'a ast::Body,
        name: Option<&ast::Name>,
        span: Span,
        description: String,
        controls: Option<&ast::Name>,
        parent: Option<chart::StateId>,
    ) -> chart::RegionId {
        let actuator = controls.and_then(|name| {
            if self.r.machine.charts[self.chart].kind == chart::ChartKind::Observer {
                self.r.observes_only(name.span, "it controls an actuator");
            }
            self.r.actuator(name)
        });
        let id = self.r.machine.regions.push(chart::Region {
            name: name.map(|n| n.text.clone()),
            description,
            chart: self.chart,
            parent,
            actuator,
            states: Vec::new(),
            entries: Vec::new(),
            initial: chart::StateId::from_index(0),
            reasons: Vec::new(),
            span,
        });
        if let Some(name) = name {
            self.r.declare_region(name, parent, self.chart, id);
        }
        let at = self.bodies.len();
        self.bodies.push(ResolvedBody {
            body,
            region: id,
            owns_region: true,
            state: None,
            phase: chart::Phase::Start,
            movements: Vec::new(),
        });
        if body.states.is_empty() {
            self.r.diagnostics.push(
                Diagnostic::new(Code::EmptyState, "there is no state between these braces")
                    .label(span, "holds no state")
                    .help("write `initial state NAME` and others"),
            );
        }
        for state in &body.states {
            self.state(state, id);
        }
        for choice in &body.choices {
            self.r.declare_choice(&choice.name, id);
            self.choices.push(Choice { written: choice, region: id, used: false });
        }
        self.initial(body, id, span);
        for (i, transition) in body.transitions.iter().enumerate() {
            if let Some(state) = self.movement(transition, id) {
                self.bodies[at].movements.push((i, state));
            }
        }
        id
    }

    fn initial(&mut self, body: &ast::Body, region: chart::RegionId, span: Span) {
        let states = body.states.iter().enumerate().filter_map(|(i, s)| s.initial.map(|at| (Some(i), at)));
        // Where an initial choice leads is known later.
        let choices = body.choices.iter().filter_map(|c| c.initial.map(|at| (None, at)));
        let mut initial = states.chain(choices);
        match (initial.next(), initial.next()) {
            (Some((i, _)), None) => {
                if let Some(i) = i {
                    let state = self.r.machine.regions[region].states[i];
                    self.r.machine.regions[region].initial = state;
                }
            }
            (Some((_, first)), Some((_, second))) => self.r.diagnostics.push(
                Diagnostic::new(Code::SeveralInitialStates, "a region begins in two places")
                    .label(second, "the second one")
                    .label(first, "the first one"),
            ),
            (None, _) => {
                if let Some(first) = body.states.first() {
                    self.r.diagnostics.push(
                        Diagnostic::new(Code::NoInitialState, "no state is initial")
                            .label(span, "where does it begin?")
                            .help(format!("write `initial state {}`, or another one", first.name.text)),
                    );
                }
            }
        }
    }

    fn state(&mut self, declared: &'a ast::State, region: chart::RegionId) {
        let depth = self.r.machine.regions[region].parent.map_or(0, |p| self.r.machine.states[p].depth + 1);
        let kind = if declared.is_final.is_some() { chart::StateKind::Final } else { chart::StateKind::Elementary };
        let id = self.r.machine.states.push(chart::State {
            name: declared.name.text.clone(),
            description: describe(&declared.description),
            region,
            kind,
            regions: Vec::new(),
            position: None,
            drives: Vec::new(),
            actions: Vec::new(),
            entry: chart::Deeds::default(),
            exit: chart::Deeds::default(),
            depth,
            span: declared.name.span,
        });
        self.r.machine.regions[region].states.push(id);
        self.r.declare_state(&declared.name, region, id);
        self.position(declared, region, id);
        let Some(body) = &declared.body else {
            if let Some(span) = declared.parallel {
                self.not_parallel(declared, span);
            }
            if let Some(name) = &declared.controls {
                self.nothing_to_control(declared, name);
            }
            return;
        };
        let composite = !body.states.is_empty() || !body.regions.is_empty() || !body.choices.is_empty();
        let mut inner = region;
        if composite {
            match (declared.parallel, body.regions.is_empty()) {
                (Some(span), true) => self.not_parallel(declared, span),
                (None, false) => self.r.diagnostics.push(
                    Diagnostic::new(
                        Code::EmptyState,
                        format!("`{}` has regions but is not parallel", declared.name.text),
                    )
                    .label(declared.name.span, "its regions run side by side")
                    .help(format!("write `parallel state {}`", declared.name.text)),
                ),
                _ => {}
            }
            if let Some(span) = declared.is_final {
                self.r.diagnostics.push(
                    Diagnostic::new(Code::EmptyState, format!("the final state `{}` holds states", declared.name.text))
                        .label(span, "a final state is elementary"),
                );
            }
            self.r.machine.states[id].kind = chart::StateKind::Composite;
            let regions = self.regions(body, &declared.name, declared.controls.as_ref(), Some(id));
            if body.regions.is_empty() {
                inner = regions[0];
            }
            self.r.machine.states[id].regions = regions;
        } else if let Some(span) = declared.parallel {
            self.not_parallel(declared, span);
        } else if let Some(name) = &declared.controls {
            self.nothing_to_control(declared, name);
        }
        // Transitions beside the regions of a parallel state have no region of their own; those of
        // a plain composite state are read with its region.
        self.bodies.push(ResolvedBody {
            body,
            region: inner,
            owns_region: false,
            state: Some(id),
            phase: chart::Phase::Start,
            movements: Vec::new(),
        });
    }

    fn not_parallel(&mut self, declared: &ast::State, span: Span) {
        self.r.diagnostics.push(
            Diagnostic::new(Code::EmptyState, format!("the parallel state `{}` has no regions", declared.name.text))
                .label(span, "what runs side by side?")
                .help("put `region A { … } region B { … }` between its braces"),
        );
    }

    fn nothing_to_control(&mut self, declared: &ast::State, name: &ast::Name) {
        self.r.diagnostics.push(
            Diagnostic::new(Code::WrongKind, format!("`{}` holds no states", declared.name.text))
                .label(name.span, "its states would be the actuator's positions")
                .help("write `controls` behind the state or region that holds the positions"),
        );
    }

    /// The position at which the state is: `at …`, else the one of the same name.
    fn position(&mut self, declared: &ast::State, region: chart::RegionId, id: chart::StateId) {
        let actuator = self.r.machine.regions[region].actuator.map(|a| &self.r.machine.actuators[a]);
        let Some(actuator) = actuator else {
            if let Some(name) = &declared.position {
                self.r.diagnostics.push(
                    Diagnostic::new(Code::WrongKind, "this region controls no actuator")
                        .label(name.span, "a position of what?")
                        .help("write `controls ACTUATOR` behind the name of the region"),
                );
            }
            return;
        };
        let name = declared.position.as_ref().unwrap_or(&declared.name);
        let found = actuator.positions.iter().position(|p| p.name.eq_ignore_ascii_case(&name.text));
        if found.is_none() {
            let known = actuator.positions.iter().map(|p| format!("`{}`", p.name)).collect::<Vec<_>>().join(", ");
            let d = Diagnostic::new(
                Code::NoPosition,
                format!("`{}` is at no position of `{}`", declared.name.text, actuator.name),
            )
            .label(name.span, "no position of that name")
            .help(format!("write `state {} at POSITION`; positions are {known}", declared.name.text));
            self.r.diagnostics.push(d);
        }
        self.r.machine.states[id].position = found;
    }

    /// Enters the state that a movement is; its name is `as …` or `A_to_B`.
    fn movement(&mut self, transition: &ast::Transition, region: chart::RegionId) -> Option<chart::StateId> {
        let movement = transition.movement.as_ref()?;
        let ast::Source::State(source) = &transition.source else { unreachable!("a movement starts in one state") };
        let ast::Target::State(target) = &transition.target else { unreachable!("a movement leads to one state") };
        let (from, to) = (&source.parts[source.parts.len() - 1], &target.parts[target.parts.len() - 1]);
        let name = movement
            .name
            .clone()
            .unwrap_or_else(|| ast::Name { text: format!("{}_to_{}", from.text, to.text), span: transition.span });
        let depth = self.r.machine.regions[region].parent.map_or(0, |p| self.r.machine.states[p].depth + 1);
        let id = self.r.machine.states.push(chart::State {
            name: name.text.clone(),
            description: describe(&transition.description),
            region,
            // Which position it leads to is known when its target is.
            kind: chart::StateKind::Movement { to: 0 },
            regions: Vec::new(),
            position: None,
            drives: Vec::new(),
            actions: Vec::new(),
            entry: chart::Deeds::default(),
            exit: chart::Deeds::default(),
            depth,
            span: name.span,
        });
        self.r.machine.regions[region].states.push(id);
        self.r.declare_state(&name, region, id);
        Some(id)
    }
}
