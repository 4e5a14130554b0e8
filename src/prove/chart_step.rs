//! One scan of a chart as Boolean functions: configuration, memory and inputs before it to those
//! after it, to commands, outputs and alarms.
//!
//! It is written from the meaning of a [`Machine`], which stands at the head of
//! [`chart`](crate::ir::chart), and shares nothing with [`lower`](crate::lower): what a compiled program
//! is compared with must not have been made by the same hands.

use super::aig::{Aig, Lit};
use super::chart_filter;
use crate::ir::chart::{Atom, Guard, Machine, RegionId, StateId, StateKind, TransitionId};

/// What a chart remembers from scan to scan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChartState {
    /// For each state, whether it is active.
    pub active: Vec<Lit>,
    /// For each variable, its value.
    pub variables: Vec<Lit>,
    /// For each input, its value in the last scan.
    pub inputs: Vec<Lit>,
    /// For each output, what the filter let through in the last scan.
    pub outputs: Vec<Lit>,
}

/// What happens in one scan.
#[derive(Clone, Debug)]
pub struct ChartScan {
    /// What is remembered; its outputs are those of this scan.
    pub after: ChartState,
    /// For each transition, whether it fires.
    pub fires: Vec<Lit>,
    /// For each output, whether an active state drives it.
    pub commands: Vec<Lit>,
    /// For each constraint, whether it had to act on the commands.
    pub acted: Vec<Lit>,
    /// For each assumption, whether the plant breaks it.
    pub broken: Vec<Lit>,
}

/// What the scans of one machine share.
pub struct ChartStep<'m> {
    machine: &'m Machine,
    /// For each region, its transitions in the order in which they are tried.
    scoped: Vec<Vec<TransitionId>>,
    rounds: usize,
}

impl<'m> ChartStep<'m> {
    /// `rounds` is the number of rounds after which the filter is known to be at rest, see
    /// [`chart_filter::rounds`].
    pub fn new(machine: &'m Machine, rounds: usize) -> Self {
        ChartStep { machine, scoped: machine.scoped(), rounds }
    }

    /// The first scan after power-up: the initial states are entered, no transition fires, inputs
    /// have no other past than themselves.
    pub fn first(&self, aig: &mut Aig, inputs: &[Lit]) -> ChartScan {
        let m = self.machine;
        let before = ChartState {
            active: vec![Lit::FALSE; m.states.len()],
            variables: m.variables.values().map(|v| Lit::of(v.initial)).collect(),
            inputs: inputs.to_vec(),
            outputs: vec![Lit::FALSE; m.outputs.len()],
        };
        let fires = vec![Lit::FALSE; m.transitions.len()];
        let active = self.configuration(aig, &before.active, &fires, Lit::TRUE);
        self.rest(aig, &before, inputs, fires, active)
    }

    /// Any later scan.
    pub fn scan(&self, aig: &mut Aig, before: &ChartState, inputs: &[Lit]) -> ChartScan {
        let fires = self.fires(aig, before, inputs);
        let active = self.configuration(aig, &before.active, &fires, Lit::FALSE);
        self.rest(aig, before, inputs, fires, active)
    }

    /// Which transitions fire.
    fn fires(&self, aig: &mut Aig, before: &ChartState, inputs: &[Lit]) -> Vec<Lit> {
        let m = self.machine;
        let reading = Reading { machine: m, active: &before.active, variables: &before.variables, inputs, before };
        let mut fires = vec![Lit::FALSE; m.transitions.len()];
        // For each state, whether it is active and a transition further out takes it away or a
        // transition of its own region leaves it: either way nothing inside it moves.
        let mut moved = vec![Lit::FALSE; m.states.len()];
        for (id, region) in m.regions.iter() {
            let barred = region.parent.map_or(Lit::FALSE, |p| moved[p.index()]);
            // Of two transitions only those out of the same state of the region can be enabled
            // together, so each state has its own order.
            let mut tried = vec![Lit::FALSE; region.states.len()];
            let place: std::collections::HashMap<StateId, usize> =
                region.states.iter().enumerate().map(|(i, &s)| (s, i)).collect();
            for &t in &self.scoped[id.index()] {
                let transition = &m.transitions[t];
                let child = m.child_in(id, transition.source).expect("the scope holds the source");
                let tried = &mut tried[place[&child]];
                let guard = reading.guard(aig, &transition.guard);
                let enabled = aig.and(before.active[transition.source.index()], guard);
                let first = aig.and(enabled, !*tried);
                fires[t.index()] = aig.and(first, !barred);
                *tried = aig.or(*tried, enabled);
            }
            for (&s, &tried) in region.states.iter().zip(&tried) {
                moved[s.index()] = aig.or(barred, tried);
            }
        }
        fires
    }

    /// Which states are active after the transitions that fire; with `start` the outermost regions
    /// are entered.
    fn configuration(&self, aig: &mut Aig, before: &[Lit], fires: &[Lit], start: Lit) -> Vec<Lit> {
        let m = self.machine;
        // For each state, who leaves it as a state of the transition's scope, and who names it on the
        // way down to the target.
        let mut leave = vec![Vec::new(); m.states.len()];
        let mut name = vec![Vec::new(); m.states.len()];
        for (id, t) in m.transitions.iter() {
            let fires = fires[id.index()];
            if fires == Lit::FALSE {
                continue;
            }
            leave[m.child_in(t.scope, t.source).expect("the scope holds the source").index()].push(fires);
            for s in m.ancestors(t.target) {
                name[s.index()].push(fires);
                if m.states[s].region == t.scope {
                    break;
                }
            }
        }
        let mut left = vec![Lit::FALSE; m.states.len()];
        let mut entered = vec![Lit::FALSE; m.states.len()];
        let mut active = vec![Lit::FALSE; m.states.len()];
        for (_, region) in m.regions.iter() {
            let (gone, come) = match region.parent {
                Some(p) => (left[p.index()], entered[p.index()]),
                None => (Lit::FALSE, start),
            };
            let named: Vec<Lit> = region.states.iter().map(|s| aig.any(&name[s.index()])).collect();
            let some_named = aig.any(&named);
            let by_default = aig.and(come, !some_named);
            for (&s, &named) in region.states.iter().zip(&named) {
                let i = s.index();
                let own = aig.any(&leave[i]);
                left[i] = aig.or(gone, own);
                entered[i] = if s == region.initial { aig.or(named, by_default) } else { named };
                let stays = aig.and(before[i], !left[i]);
                active[i] = aig.or(stays, entered[i]);
            }
        }
        active
    }

    /// Everything after the transitions.
    fn rest(
        &self,
        aig: &mut Aig,
        before: &ChartState,
        inputs: &[Lit],
        fires: Vec<Lit>,
        active: Vec<Lit>,
    ) -> ChartScan {
        let m = self.machine;
        let mut writes = vec![[Vec::new(), Vec::new()]; m.variables.len()];
        for (id, t) in m.transitions.iter() {
            for &(v, value) in &t.effects {
                writes[v.index()][usize::from(value)].push(fires[id.index()]);
            }
        }
        let variables = write(aig, &before.variables, &writes);

        let mut writes = vec![[Vec::new(), Vec::new()]; m.variables.len()];
        let reading = Reading { machine: m, active: &active, variables: &variables, inputs, before };
        for (id, state) in m.states.iter() {
            for action in &state.actions {
                let condition = reading.guard(aig, &action.condition);
                let acts = aig.and(active[id.index()], condition);
                writes[action.variable.index()][usize::from(action.value)].push(acts);
            }
        }
        let variables = write(aig, &variables, &writes);

        let reading = Reading { machine: m, active: &active, variables: &variables, inputs, before };
        let mut drives = vec![Vec::new(); m.outputs.len()];
        for (id, state) in m.states.iter() {
            for drive in &state.drives {
                let condition = reading.guard(aig, &drive.condition);
                drives[drive.output.index()].push(aig.and(active[id.index()], condition));
            }
        }
        let commands: Vec<Lit> = drives.iter().map(|d| aig.any(d)).collect();

        let broken = m.safety.assumptions.iter().map(|a| reading.guard(aig, &a.never)).collect();
        let mut read = |aig: &mut Aig, atom: Atom| reading.atom(aig, atom);
        let filtered = chart_filter::filter(aig, m, &commands, &mut read, self.rounds);
        ChartScan {
            after: ChartState { active, variables, inputs: inputs.to_vec(), outputs: filtered.outputs },
            fires,
            commands,
            acted: filtered.acted,
            broken,
        }
    }
}

/// First all that set, then all that reset; `writes` holds for each variable who resets and who sets it.
fn write(aig: &mut Aig, before: &[Lit], writes: &[[Vec<Lit>; 2]]) -> Vec<Lit> {
    let each = before.iter().zip(writes);
    each.map(|(&before, [reset, set])| {
        let (reset, set) = (aig.any(reset), aig.any(set));
        let on = aig.or(before, set);
        aig.and(on, !reset)
    })
    .collect()
}

/// Where an expression is read: before or after the step.
struct Reading<'a> {
    machine: &'a Machine,
    active: &'a [Lit],
    variables: &'a [Lit],
    inputs: &'a [Lit],
    before: &'a ChartState,
}

impl Reading<'_> {
    fn guard(&self, aig: &mut Aig, guard: &Guard) -> Lit {
        aig.expression(guard, &mut |aig, &atom| self.atom(aig, atom))
    }

    fn atom(&self, aig: &mut Aig, atom: Atom) -> Lit {
        match atom {
            Atom::Input(i) => self.inputs[i.index()],
            Atom::PrevInput(i) => self.before.inputs[i.index()],
            Atom::Output(_) => unreachable!("outputs of this scan stand in constraints only"),
            Atom::PrevOutput(o) => self.before.outputs[o.index()],
            Atom::Variable(v) => self.variables[v.index()],
            Atom::In(s) => self.active[s.index()],
            Atom::Done(s) => {
                let regions: Vec<Lit> =
                    self.machine.states[s].regions.iter().map(|&r| self.ended(aig, r)).collect();
                aig.all(&regions)
            }
        }
    }

    fn ended(&self, aig: &mut Aig, region: RegionId) -> Lit {
        let states = self.machine.regions[region].states.iter();
        let last = states.filter(|&&s| self.machine.states[s].kind == StateKind::Final);
        let last: Vec<Lit> = last.map(|s| self.active[s.index()]).collect();
        aig.any(&last)
    }
}
