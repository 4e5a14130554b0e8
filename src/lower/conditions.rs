//! What guards read from other programs to latched conditions, and who fires to coils.
//!
//! Every method gives the global that stands for a question, and on the first asking makes it and
//! its rung. All rungs run before the chart's step, on flags that the scan before has left.

use super::context::{Condition, Conditions, Context};
use super::entries::{Read, When};
use super::rungs::{self, rung};
use crate::ir::chart::{OutputId, RegionId, StateId, StateKind, TransitionId};
use crate::ir::expr::Expr;
use crate::ir::ladder::{CoilKind, Rung, Timer};
use crate::ir::plc::{GlobalId, Origin, Role};

/// From this many transitions out of one step on, their order is a chain of coils: pairwise
/// exclusion would grow with the square.
const CHAINED: usize = 8;

impl Context<'_> {
    /// The value of an input in the scan before; in the first scan that of this one.
    pub fn previous(&mut self, input: usize) -> GlobalId {
        if let Some(&id) = self.conditions.previous.get(&input) {
            return id;
        }
        let signal = &self.globals[self.inputs[input]];
        let (name, text, origin) = (signal.name.clone(), format!("{} in the scan before", signal.name), signal.origin);
        let name = self.names.give("Was", &name);
        let id = self.global(name, Role::Condition, text, origin);
        self.conditions.previous.insert(input, id);
        id
    }

    /// The value of an output in the scan before, for what runs after the filter has written the next one.
    pub fn decided(&mut self, output: OutputId) -> GlobalId {
        if let Some(&id) = self.conditions.decided.get(&output) {
            return id;
        }
        let now = self.outputs[output.index()];
        let signal = &self.globals[now];
        let (name, text, origin) = (signal.name.clone(), format!("{} in the scan before", signal.name), signal.origin);
        let name = self.names.give("Was", &name);
        let id = self.global(name, Role::Condition, text.clone(), origin);
        self.conditions.decided.insert(output, id);
        let mut rungs = std::mem::take(&mut self.conditions.latches);
        rung(self, &mut rungs, (id, CoilKind::Plain), &Expr::Atom(now), text);
        self.conditions.latches = rungs;
        id
    }

    /// Whether the state was active when the scan began.
    pub fn active(&mut self, state: StateId) -> GlobalId {
        if let Some(&id) = self.conditions.active.get(&state) {
            return id;
        }
        let path = self.machine.state_path(state);
        let name = self.names.state("In", state);
        let text = format!("{path} was active when the scan began");
        let flag = Expr::Atom(self.flags[state.index()]);
        let id = self.latch(name, text, Origin::Active(state), &flag);
        self.conditions.active.insert(state, id);
        id
    }

    /// Whether every region of the state was in a final state when the scan began.
    pub fn done(&mut self, state: StateId) -> GlobalId {
        if let Some(&id) = self.conditions.done.get(&state) {
            return id;
        }
        let path = self.machine.state_path(state);
        let name = self.names.state("Done", state);
        let text = format!("{path} was done when the scan began");
        let condition = self.done_by_flags(state);
        let id = self.latch(name, text, Origin::Done(state), &condition);
        self.conditions.done.insert(state, id);
        id
    }

    /// Whether the state has been active for `ms` milliseconds, counted from the first scan that
    /// began in it: a timer that runs at the start of each scan on the state's flag.
    pub fn elapsed(&mut self, state: StateId, ms: u32) -> GlobalId {
        if let Some((id, _)) = self.conditions.elapsed.get(&(state, ms)) {
            return *id;
        }
        let path = self.machine.state_path(state);
        let name = self.names.state(&format!("After{ms}ms"), state);
        let instance = self.names.state(&format!("TON{ms}ms"), state);
        let text = format!("{path} has been active for {ms} ms");
        let id = self.global(name, Role::Condition, text.clone(), Origin::After(state, ms));
        self.conditions.elapsed.insert((state, ms), (id, instance.clone()));
        let flag = Expr::Atom(self.flags[state.index()]);
        let mut rungs = std::mem::take(&mut self.conditions.timing);
        rungs::timer(self, &mut rungs, id, Timer { instance, preset: ms }, &flag, text);
        self.conditions.timing = rungs;
        id
    }

    fn latch(&mut self, name: String, text: String, origin: Origin, condition: &Condition) -> GlobalId {
        let id = self.global(name, Role::Condition, text.clone(), origin);
        let mut rungs = std::mem::take(&mut self.conditions.latches);
        rung(self, &mut rungs, (id, CoilKind::Plain), condition, text);
        self.conditions.latches = rungs;
        id
    }

    /// Whether the transition's source was active and its guard holds.
    pub fn enabled(&mut self, transition: TransitionId) -> GlobalId {
        if let Some(&id) = self.conditions.enabled.get(&transition) {
            return id;
        }
        let name = self.names.transition("En", transition);
        let text = self.says_of(transition, "is enabled");
        let id = self.global(name, Role::Condition, text.clone(), Origin::Transition(transition));
        self.conditions.enabled.insert(transition, id);
        let t = &self.machine.transitions[transition];
        let source = Expr::Atom(self.flags[t.source.index()]);
        // The source's own flag says all that its latched form would.
        let own = self.machine.states[t.source].region;
        let guard = self.guard(&t.guard, own);
        let mut rungs = std::mem::take(&mut self.conditions.enabling);
        rung(self, &mut rungs, (id, CoilKind::Plain), &Expr::all([source, guard]), text);
        self.conditions.enabling = rungs;
        id
    }

    /// Whether a transition out of the state or further out leaves it in this scan, if it is active; nothing if none can.
    fn is_left(&mut self, state: StateId) -> Option<GlobalId> {
        if let Some(&id) = self.conditions.left.get(&state) {
            return id;
        }
        let region = self.machine.states[state].region;
        let mut reasons: Vec<Condition> = self.overruled(region).map(Expr::Atom).into_iter().collect();
        for t in self.leaving(region, state) {
            reasons.push(Expr::Atom(self.enabled(t)));
        }
        let id = (!reasons.is_empty()).then(|| {
            let name = self.names.state("Bar", state);
            let text = format!("a transition leaves {} if it is active", self.machine.state_path(state));
            let id = self.global(name, Role::Condition, text.clone(), Origin::State(state));
            let mut rungs = std::mem::take(&mut self.conditions.ranking);
            rung(self, &mut rungs, (id, CoilKind::Plain), &Expr::any(reasons), text);
            self.conditions.ranking = rungs;
            id
        });
        self.conditions.left.insert(state, id);
        id
    }

    /// Whether a transition further out takes the region's branch away in this scan; nothing if none
    /// can.
    fn overruled(&mut self, region: RegionId) -> Option<GlobalId> {
        self.machine.regions[region].parent.and_then(|parent| self.is_left(parent))
    }

    /// The transitions of scope `region` that leave its state `state`, in the order in which they
    /// are tried.
    pub fn leaving(&self, region: RegionId, state: StateId) -> Vec<TransitionId> {
        let all = self.scoped[region.index()].iter().copied();
        all.filter(|&t| self.machine.child_in(region, self.machine.transitions[t].source) == Some(state)).collect()
    }

    /// Whether the transition fires in this scan: it is enabled, none before it is, none further out
    /// is.
    pub fn fires(&mut self, transition: TransitionId) -> GlobalId {
        if let Some(&id) = self.conditions.fires.get(&transition) {
            return id;
        }
        let name = self.names.transition("Go", transition);
        let text = self.says_of(transition, "fires");
        let id = self.global(name, Role::Condition, text.clone(), Origin::Transition(transition));
        self.conditions.fires.insert(transition, id);
        let t = &self.machine.transitions[transition];
        let state = self.machine.child_in(t.scope, t.source).expect("the scope holds the source");
        if t.internal {
            let left = self.is_left(state).map(|left| Expr::Atom(left).not());
            let condition = Expr::all([Expr::Atom(self.enabled(transition))].into_iter().chain(left));
            let mut rungs = std::mem::take(&mut self.conditions.firing);
            rung(self, &mut rungs, (id, CoilKind::Plain), &condition, text);
            self.conditions.firing = rungs;
            return id;
        }
        let rivals = self.leaving(t.scope, state);
        let rank = rivals.iter().position(|&r| r == transition).expect("a transition is its own rival");
        let mut parts = vec![Expr::Atom(self.enabled(transition))];
        if rivals.len() > CHAINED {
            if rank > 0 {
                parts.push(Expr::Atom(self.some_up_to(&rivals, rank - 1)).not());
            }
        } else {
            for &rival in &rivals[..rank] {
                parts.push(Expr::Atom(self.enabled(rival)).not());
            }
        }
        if let Some(bar) = self.overruled(t.scope) {
            parts.push(Expr::Atom(bar).not());
        }
        let mut rungs = std::mem::take(&mut self.conditions.firing);
        rung(self, &mut rungs, (id, CoilKind::Plain), &Expr::all(parts), text);
        self.conditions.firing = rungs;
        id
    }

    /// Whether one of `rivals[..=last]` is enabled: a chain of coils, each the one before or one more.
    fn some_up_to(&mut self, rivals: &[TransitionId], last: usize) -> GlobalId {
        let known = (0..=last).rev().find_map(|i| Some((i, *self.conditions.before.get(&rivals[i])?)));
        let (mut next, mut chain) = known.map_or((0, None), |(i, id)| (i + 1, Some(id)));
        while next <= last {
            let one = Expr::Atom(self.enabled(rivals[next]));
            let name = self.names.transition("Any", rivals[next]);
            let text = format!("{} or one tried before it is enabled", self.about_transition(rivals[next]));
            let id = self.global(name, Role::Condition, text.clone(), Origin::Transition(rivals[next]));
            let condition = Expr::any(chain.map(Expr::Atom).into_iter().chain([one]));
            let mut rungs = std::mem::take(&mut self.conditions.ranking);
            rung(self, &mut rungs, (id, CoilKind::Plain), &condition, text);
            self.conditions.ranking = rungs;
            self.conditions.before.insert(rivals[next], id);
            chain = Some(id);
            next += 1;
        }
        chain.expect("the chain has a link")
    }

    /// Whether the state's region is told in this scan to start at the state.
    pub fn entered(&mut self, state: StateId, by: &[(TransitionId, When)]) -> GlobalId {
        if let Some(&id) = self.conditions.entered.get(&state) {
            return id;
        }
        let path = self.machine.state_path(state);
        let name = self.names.state("Ent", state);
        let text = format!("a transition enters {path}");
        let id = self.global(name, Role::Condition, text.clone(), Origin::State(state));
        self.conditions.entered.insert(state, id);
        let condition = self.some_enters(by);
        let mut rungs = std::mem::take(&mut self.conditions.entering);
        rung(self, &mut rungs, (id, CoilKind::Plain), &condition, text);
        self.conditions.entering = rungs;
        id
    }

    /// Whether the state is left and entered again in this scan; nothing if it never is.
    pub fn again(&mut self, state: StateId) -> Option<GlobalId> {
        if let Some(&id) = self.conditions.again.get(&state) {
            return Some(id);
        }
        let by = self.entries.reentering(state).to_vec();
        if by.is_empty() {
            return None;
        }
        let path = self.machine.state_path(state);
        let name = self.names.state("Again", state);
        let text = format!("{path} is left and entered again");
        let id = self.global(name, Role::Condition, text.clone(), Origin::State(state));
        self.conditions.again.insert(state, id);
        let enters = self.some_enters(&by);
        let mut rungs = std::mem::take(&mut self.conditions.entering);
        rung(self, &mut rungs, (id, CoilKind::Plain), &enters, text);
        self.conditions.entering = rungs;
        Some(id)
    }

    /// Whether one of the transitions fires and enters what it is asked about.
    fn some_enters(&mut self, by: &[(TransitionId, When)]) -> Condition {
        let each = by.iter().map(|(transition, when)| {
            let fires = Expr::Atom(self.fires(*transition));
            let scope = self.machine.transitions[*transition].scope;
            let when = when.map(&mut |read| match *read {
                Read::Guard(atom) => self.guard(&Expr::Atom(atom), scope),
                Read::Last(state) => Expr::Atom(self.last(state)),
                Read::Unfinished(state) => Expr::Atom(self.unfinished(state)),
            });
            Expr::all([fires, when])
        });
        Expr::any(each.collect::<Vec<_>>())
    }

    /// Whether the state was the last one of its region. Its rung runs when the chart has taken its step
    /// ([`variables`](super::variables)); read before that it says what was when the scan began.
    fn last(&mut self, state: StateId) -> GlobalId {
        if let Some(&id) = self.conditions.last.get(&state) {
            return id;
        }
        let path = self.machine.state_path(state);
        let name = self.names.state("Last", state);
        let text = format!("{path} is where its region is or was last");
        let id = self.global(name, Role::History, text, Origin::Last(state));
        self.conditions.last.insert(state, id);
        id
    }

    /// Whether the state was active at some time and was not done as a whole.
    fn unfinished(&mut self, state: StateId) -> GlobalId {
        if let Some(&id) = self.conditions.unfinished.get(&state) {
            return id;
        }
        let machine = self.machine;
        let name = self.names.state("Left", state);
        let text = format!("{} has been left or is active, and has not ended", machine.state_path(state));
        let id = self.global(name, Role::Condition, text.clone(), Origin::Unfinished(state));
        self.conditions.unfinished.insert(state, id);
        let states = machine.states[state].regions.iter().flat_map(|&r| machine.regions[r].states.iter().copied());
        let states = states.filter(|&s| machine.states[s].kind != StateKind::Final);
        let some = Expr::any(states.map(|s| Expr::Atom(self.last(s))).collect::<Vec<_>>());
        let mut rungs = std::mem::take(&mut self.conditions.latches);
        rung(self, &mut rungs, (id, CoilKind::Plain), &some, text);
        self.conditions.latches = rungs;
        id
    }

    /// Whether the order of the transitions that leave a step is decided by coils.
    pub fn is_chained(&self, rivals: &[TransitionId]) -> bool {
        rivals.len() > CHAINED
    }
}

/// The rungs of all that has been asked for since the last time, but for inputs' past: observers ask
/// before they step, charts between that and their own step.
pub fn finish(context: &mut Context<'_>) -> Vec<Rung> {
    let restarts = restarts(context);
    let previous = std::mem::take(&mut context.conditions.previous);
    let Conditions { latches, timing, enabling, ranking, firing, entering, .. } =
        std::mem::replace(&mut context.conditions, Conditions { previous, ..Conditions::default() });
    let comparing = std::mem::take(&mut context.integers.comparing);
    context.integers.before.clear();
    [comparing, latches, timing, enabling, ranking, firing, entering, restarts].into_iter().flatten().collect()
}

/// A state that is left and entered again in one scan keeps its flag, so its timers would run on.
/// They are called once more when it is known who fires, with FALSE if the state starts anew.
fn restarts(context: &mut Context<'_>) -> Vec<Rung> {
    let mut rungs = Vec::new();
    for ((state, ms), (_, instance)) in context.conditions.elapsed.clone() {
        let Some(again) = context.again(state) else { continue };
        let path = context.machine.state_path(state);
        let name = context.names.state(&format!("Still{ms}ms"), state);
        let text = format!("{path} has been active for {ms} ms and is not entered again");
        let coil = context.global(name, Role::Condition, text.clone(), Origin::After(state, ms));
        let running = Expr::all([Expr::Atom(context.flags[state.index()]), Expr::Atom(again).not()]);
        rungs::timer(context, &mut rungs, coil, Timer { instance, preset: ms }, &running, text);
    }
    rungs
}

/// What was raised in the scan before is TRUE from here on until the next scan.
pub fn events(context: &mut Context<'_>) -> Vec<Rung> {
    let mut rungs = Vec::new();
    for (event, (now, next)) in context.machine.events.values().zip(context.events.clone()) {
        let text = format!("{} was raised in the scan before", event.name);
        rung(context, &mut rungs, (now, CoilKind::Plain), &Expr::Atom(next), text);
    }
    rungs
}

/// Two coils per input whose past is read: what it was, and what it is for the next scan. In the
/// first scan, when nothing has started yet, it was what it is.
pub fn previous_values(context: &mut Context<'_>) -> Vec<Rung> {
    let mut rungs = Vec::new();
    let previous = context.conditions.previous.clone();
    if previous.is_empty() {
        return rungs;
    }
    let name = context.names.fixed("Started");
    let started = context.global(name, Role::Condition, "the first scan is over".into(), rungs::own());
    for (&input, &was) in &previous {
        let signal = context.inputs[input];
        let now_name = context.names.give("Now", &context.globals[signal].name.clone());
        let text = format!("{} for the next scan", context.globals[signal].name);
        let kept = context.globals[signal].origin;
        let now = context.global(now_name, Role::Condition, text.clone(), kept);
        let then = Expr::any([
            Expr::all([Expr::Atom(started), Expr::Atom(now)]),
            Expr::all([Expr::Atom(started).not(), Expr::Atom(signal)]),
        ]);
        let comment = context.globals[was].description.clone();
        rung(context, &mut rungs, (was, CoilKind::Plain), &then, comment);
        rung(context, &mut rungs, (now, CoilKind::Plain), &Expr::Atom(signal), text);
    }
    rung(context, &mut rungs, (started, CoilKind::Plain), &Expr::TRUE, "the first scan is over".into());
    rungs
}
