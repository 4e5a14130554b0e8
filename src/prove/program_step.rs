//! One scan of a PLC project as Boolean functions: what its variables, steps and blocks hold before it
//! and its inputs to what they hold after it.
//!
//! Written from the meaning of a [`Project`], which stands at the head of [`iec`](crate::ir::iec).
//! Integers are rows of bits, see [`numbers`]. Times cannot be encoded, nor can qualifiers with durations or
//! programs that run in some scans only. They are refused with a sentence that says where.
//!
//! Of the timers, TON with a constant preset time is encoded: whether the time since its start has
//! passed is a literal that is given for each scan.

mod numbers;

use crate::bits::aig::{Aig, Lit};
use crate::ir::iec::{
    Action, Atom, Block, BlockId, BlockKind, Body, Bool, Call, CoilKind, Condition, Kind, Number, Project, Qualifier,
    Scope, Sfc, Statement, StepId, Target, Time, VarId, Variable,
};
use std::collections::{BTreeMap, BTreeSet};

/// Something that a program remembers from scan to scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Latch {
    /// A BOOL variable.
    Variable(VarId),
    /// A bit of an integer variable, counted from the lowest.
    Bit(VarId, u8),
    /// Flag X of a step of the program of that index.
    Step(usize, StepId),
    /// Whether the action of that index in the program of that index has been set and not yet reset.
    Stored(usize, usize),
    /// M of a trigger; the last input of a timer.
    Memory(BlockId),
    /// Q of a block.
    Output(BlockId),
    /// Whether a timer runs or has ended.
    Begun(BlockId),
    /// Whether a timer has started in the last scan; not read in the next.
    Starts(BlockId),
}

/// The value of every latch, in the order of [`ProgramStep::latches`].
pub type ProgramState = Vec<Lit>;

/// What the scans of one project share.
pub struct ProgramStep<'p> {
    project: &'p Project,
    latches: Vec<Latch>,
    variables: Vec<Option<usize>>,
    steps: Vec<usize>,
    stored: Vec<usize>,
    blocks: Vec<usize>,
    /// For each block, its preset time if it is a timer.
    presets: Vec<Option<Time>>,
    orders: Vec<Vec<usize>>,
}

impl<'p> ProgramStep<'p> {
    /// Lays out the latches, or says what cannot be encoded.
    pub fn new(project: &'p Project) -> Result<Self, String> {
        let tick = project.tick();
        let mut presets = vec![None; project.blocks.len()];
        for program in &project.programs {
            if let Some(task) = program.task
                && Some(project.tasks[task].interval) != tick
            {
                return Err(format!("program {} does not run in every scan", program.name));
            }
            Refusal { project, program: &program.name, presets: &mut presets }.body(&program.body)?;
        }
        let mut step = ProgramStep {
            project,
            latches: Vec::new(),
            variables: Vec::new(),
            steps: Vec::new(),
            stored: Vec::new(),
            blocks: Vec::new(),
            presets,
            orders: Vec::new(),
        };
        for (id, variable) in project.variables.iter() {
            let (first, width) = (step.latches.len(), numbers::width(variable.kind));
            match variable.kind {
                Kind::Bool => step.latches.push(Latch::Variable(id)),
                Kind::Int { bits, .. } => step.latches.extend((0..bits).map(|bit| Latch::Bit(id, bit))),
                Kind::Time => {}
            }
            step.variables.push(width.map(|_| first));
        }
        for (i, program) in project.programs.iter().enumerate() {
            step.steps.push(step.latches.len());
            let mut order = Vec::new();
            if let Body::Sfc(sfc) = &program.body {
                step.latches.extend(sfc.steps.ids().map(|s| Latch::Step(i, s)));
                order = sfc.test_order();
            }
            step.orders.push(order);
            step.stored.push(step.latches.len());
            if let Body::Sfc(sfc) = &program.body {
                step.latches.extend((0..sfc.actions.len()).map(|a| Latch::Stored(i, a)));
            }
        }
        for (id, block) in project.blocks.iter() {
            step.blocks.push(step.latches.len());
            step.latches.extend([Latch::Memory(id), Latch::Output(id)]);
            if block.kind == BlockKind::Ton {
                step.latches.extend([Latch::Begun(id), Latch::Starts(id)]);
            }
        }
        Ok(step)
    }

    /// All that is remembered.
    pub fn latches(&self) -> &[Latch] {
        &self.latches
    }

    /// Where a BOOL variable stands among the latches.
    pub fn variable(&self, id: VarId) -> Option<usize> {
        self.variables[id.index()].filter(|_| self.project.variables[id].kind == Kind::Bool)
    }

    /// Where a step stands among the latches.
    pub fn step(&self, program: usize, step: StepId) -> usize {
        self.steps[program] + step.index()
    }

    /// Where the first latch of a block stands: its memory, then its output, then, for a timer, whether
    /// it has begun and whether it starts.
    pub fn block(&self, id: BlockId) -> usize {
        self.blocks[id.index()]
    }

    /// For each block, its preset time if it is a timer that is called.
    pub fn presets(&self) -> &[Option<Time>] {
        &self.presets
    }

    /// What a latch is called, for people.
    pub fn name(&self, latch: Latch) -> String {
        match latch {
            Latch::Variable(id) => {
                let Variable { name, scope, .. } = &self.project.variables[id];
                format!("{}{name}", self.owner(*scope))
            }
            Latch::Bit(id, bit) => format!("{}.{bit}", self.name(Latch::Variable(id))),
            Latch::Step(p, id) => {
                let program = &self.project.programs[p];
                match &program.body {
                    Body::Sfc(sfc) => format!("{}.{}.X", program.kind, sfc.steps[id].name),
                    Body::Code(_) => unreachable!("only an SFC has steps"),
                }
            }
            Latch::Stored(p, a) => format!("{}.action {a}", self.project.programs[p].kind),
            Latch::Memory(id) => self.of_block(id, "M"),
            Latch::Output(id) => self.of_block(id, "Q"),
            Latch::Begun(id) => self.of_block(id, "STATE"),
            Latch::Starts(id) => self.of_block(id, "START"),
        }
    }

    fn owner(&self, scope: Scope) -> String {
        match scope {
            Scope::Global => String::new(),
            Scope::Program(p) => format!("{}.", self.project.programs[p].kind),
        }
    }

    fn of_block(&self, id: BlockId, pin: &str) -> String {
        let Block { name, scope, .. } = &self.project.blocks[id];
        let name = if name.is_empty() { format!("edge {}", id.index()) } else { name.clone() };
        format!("{}{name}.{pin}", self.owner(*scope))
    }

    /// What is remembered at power-up.
    pub fn power_up(&self) -> ProgramState {
        let value = |latch: &Latch| match *latch {
            Latch::Variable(id) => self.project.variables[id].initial != 0,
            Latch::Bit(id, bit) => self.project.variables[id].initial >> bit & 1 == 1,
            Latch::Step(p, id) => match &self.project.programs[p].body {
                Body::Sfc(sfc) => sfc.steps[id].initial,
                Body::Code(_) => false,
            },
            Latch::Stored(..) | Latch::Memory(_) | Latch::Output(_) | Latch::Begun(_) | Latch::Starts(_) => false,
        };
        self.latches.iter().map(|l| Lit::of(value(l))).collect()
    }

    /// For each latch, whether anything in the project writes it; the others keep their value for ever.
    pub fn written(&self) -> Vec<bool> {
        let last = self.last_writers();
        last.into_iter().map(|w| w.is_some()).collect()
    }

    /// For each latch, the last program that writes it.
    pub fn last_writers(&self) -> Vec<Option<usize>> {
        let mut last = vec![None; self.latches.len()];
        for (p, program) in self.project.programs.iter().enumerate() {
            let mut written = BTreeSet::new();
            match &program.body {
                Body::Sfc(sfc) => {
                    written.extend((0..sfc.steps.len()).map(|i| self.steps[p] + i));
                    written.extend((0..sfc.actions.len()).map(|i| self.stored[p] + i));
                    let associations = sfc.steps.values().flat_map(|s| &s.associations);
                    for association in associations {
                        if let Target::Variable(v) = association.target {
                            written.extend(self.variables[v.index()]);
                        }
                    }
                    sfc.actions.values().for_each(|a| self.written_by(&a.body, &mut written));
                }
                Body::Code(statements) => self.written_by(statements, &mut written),
            }
            written.into_iter().for_each(|l| last[l] = Some(p));
        }
        last
    }

    fn written_by(&self, statements: &[Statement], written: &mut BTreeSet<usize>) {
        for s in statements {
            match s {
                Statement::Coil(coil) => written.extend(self.variables[coil.variable.index()]),
                Statement::Move { to, .. } => written.extend(self.integer(*to).into_iter().flatten()),
                Statement::Call(call) => {
                    let block = self.blocks[call.block.index()];
                    let timer = self.presets[call.block.index()].is_some();
                    written.extend(block..block + if timer { 4 } else { 2 });
                }
            }
        }
    }

    /// One scan. `inputs` are set before it; `clocks` says for each block, if it is a timer, whether its
    /// time has passed by now, should it have started in an earlier scan; `after` is told whenever a program has run and may put
    /// other literals into the state, provided that they are equal to what stands there.
    pub fn scan(
        &self,
        aig: &mut Aig,
        before: &ProgramState,
        inputs: &[(usize, Lit)],
        clocks: &[Lit],
        after: &mut impl FnMut(&mut Aig, usize, &mut ProgramState),
    ) -> ProgramState {
        self.run(aig, before, inputs, clocks, after, None)
    }

    /// For each place where numbers are computed in a scan, what they make, and whether one leaves its type there.
    pub fn sums(
        &self,
        aig: &mut Aig,
        before: &ProgramState,
        inputs: &[(usize, Lit)],
        clocks: &[Lit],
    ) -> Vec<(String, Lit)> {
        let mut sums = Vec::new();
        self.run(aig, before, inputs, clocks, &mut |_, _, _| {}, Some(&mut sums));
        sums
    }

    fn run(
        &self,
        aig: &mut Aig,
        before: &ProgramState,
        inputs: &[(usize, Lit)],
        clocks: &[Lit],
        after: &mut impl FnMut(&mut Aig, usize, &mut ProgramState),
        mut sums: Option<&mut Vec<(String, Lit)>>,
    ) -> ProgramState {
        let mut state = before.clone();
        for &(latch, value) in inputs {
            state[latch] = value;
        }
        for (&block, _) in self.blocks.iter().zip(&self.presets).filter(|(_, preset)| preset.is_some()) {
            state[block + 3] = Lit::FALSE;
        }
        for (p, program) in self.project.programs.iter().enumerate() {
            let mut run = Run { step: self, aig, program: p, state: &mut state, clocks, sums: sums.as_deref_mut() };
            match &program.body {
                Body::Code(statements) => run.statements(statements, Lit::TRUE),
                Body::Sfc(sfc) => run.sfc(sfc),
            }
            after(aig, p, &mut state);
        }
        state
    }
}

/// One program in the midst of a scan.
struct Run<'a, 'p> {
    step: &'a ProgramStep<'p>,
    aig: &'a mut Aig,
    program: usize,
    state: &'a mut ProgramState,
    clocks: &'a [Lit],
    /// Where numbers leave their types, if somebody asks.
    sums: Option<&'a mut Vec<(String, Lit)>>,
}

impl Run<'_, '_> {
    fn variable(&self, id: VarId) -> usize {
        self.step.variables[id.index()].expect("what is not BOOL has been refused")
    }

    /// Assigns if `when`.
    fn assign(&mut self, latch: usize, when: Lit, value: Lit) {
        self.state[latch] = self.aig.select(when, value, self.state[latch]);
    }

    fn condition(&mut self, condition: &Condition) -> Lit {
        let mut shared = Vec::with_capacity(condition.shared.len());
        for part in &condition.shared {
            let value = self.value(part, &shared);
            shared.push(value);
        }
        self.value(&condition.value, &shared)
    }

    fn value(&mut self, e: &Bool, shared: &[Lit]) -> Lit {
        // Numbers are computed first, so that the rest needs nothing but the state.
        let mut compared = Vec::new();
        e.for_each_atom(&mut |atom| {
            if let Atom::Compare(relation, left, right) = atom {
                compared.push(self.compare(*relation, left, right));
            }
        });
        let mut compared = compared.into_iter();
        let (step, program, state) = (self.step, self.program, &*self.state);
        self.aig.expression(e, &mut |_, atom| match *atom {
            Atom::Variable(v) => state[step.variables[v.index()].expect("what is not BOOL has been refused")],
            Atom::Step(s) => state[step.steps[program] + s.index()],
            Atom::Output(b) => state[step.blocks[b.index()] + 1],
            Atom::Shared(i) => shared[i],
            Atom::Compare(..) => compared.next().expect("atoms come in one order"),
        })
    }

    /// Statements that have effect if `run`.
    fn statements(&mut self, statements: &[Statement], run: Lit) {
        for s in statements {
            match s {
                Statement::Coil(coil) => {
                    let power = self.condition(&coil.condition);
                    let latch = self.variable(coil.variable);
                    match coil.kind {
                        CoilKind::Plain => self.assign(latch, run, power),
                        CoilKind::Set => {
                            let when = self.aig.and(run, power);
                            self.assign(latch, when, Lit::TRUE);
                        }
                        CoilKind::Reset => {
                            let when = self.aig.and(run, power);
                            self.assign(latch, when, Lit::FALSE);
                        }
                    }
                }
                Statement::Move { to, value } => self.move_number(*to, value, run),
                Statement::Call(call) => self.call(call, run),
            }
        }
    }

    fn call(&mut self, call: &Call, run: Lit) {
        let memory = self.step.blocks[call.block.index()];
        let output = memory + 1;
        let input = self.condition(call.input.as_ref().expect("calls without input have been refused"));
        match self.step.project.blocks[call.block].kind {
            kind @ (BlockKind::RTrig | BlockKind::FTrig) => {
                let level = input.xor(kind == BlockKind::FTrig);
                let edge = self.aig.and(level, !self.state[memory]);
                self.assign(output, run, edge);
                self.assign(memory, run, level);
            }
            BlockKind::Sr => {
                let reset = self.condition(call.reset.as_ref().expect("calls without reset have been refused"));
                let kept = self.aig.and(!reset, self.state[output]);
                let q = self.aig.or(input, kept);
                self.assign(output, run, q);
            }
            BlockKind::Rs => {
                let reset = self.condition(call.reset.as_ref().expect("calls without reset have been refused"));
                let on = self.aig.or(input, self.state[output]);
                let q = self.aig.and(!reset, on);
                self.assign(output, run, q);
            }
            BlockKind::Ton => self.on_delay(memory, self.clocks[call.block.index()], input, run),
            BlockKind::Tof | BlockKind::Tp => unreachable!("these timers have been refused"),
        }
    }

    /// TON: a rising edge while idle starts it, else FALSE makes it idle, else the clock may end it.
    fn on_delay(&mut self, memory: usize, clock: Lit, input: Lit, run: Lit) {
        let (output, begun, starts) = (memory + 1, memory + 2, memory + 3);
        let idle = self.aig.and(!self.state[begun], !self.state[memory]);
        let start = self.aig.and(idle, input);
        // Preset times are positive, so what started in this scan does not end in it.
        let due = self.aig.and(clock, !self.state[starts]);
        let ends = self.aig.and(self.state[begun], due);
        let on = self.aig.or(self.state[output], ends);
        let on = self.aig.and(on, input);
        let on = self.aig.and(on, !start);
        let goes = self.aig.and(input, self.state[begun]);
        let goes = self.aig.or(goes, start);
        let started = self.aig.or(self.state[starts], start);
        self.assign(output, run, on);
        self.assign(begun, run, goes);
        self.assign(starts, run, started);
        self.assign(memory, run, input);
    }

    fn sfc(&mut self, sfc: &Sfc) {
        let first = self.step.steps[self.program];
        let was: Vec<Lit> = self.state[first..first + sfc.steps.len()].to_vec();
        let x = |s: StepId| first + s.index();

        // Tests, one after the other; with priority a step that is left is left at once.
        let mut fired = vec![Lit::FALSE; sfc.transitions.len()];
        for &i in &self.step.orders[self.program] {
            let t = &sfc.transitions[i];
            let sources: Vec<Lit> = t.from.iter().map(|&s| self.state[x(s)]).collect();
            let enabled = self.aig.all(&sources);
            // The condition reads the flags as the tests before have left them.
            let condition = self.condition(&t.condition);
            fired[i] = self.aig.and(enabled, condition);
            if t.priority.is_some() {
                t.from.iter().for_each(|&s| self.assign(x(s), fired[i], Lit::FALSE));
            }
        }
        for (t, &fired) in sfc.transitions.iter().zip(&fired).filter(|(t, _)| t.priority.is_none()) {
            t.from.iter().for_each(|&s| self.assign(x(s), fired, Lit::FALSE));
        }
        let mut enter = vec![Vec::new(); sfc.steps.len()];
        for (t, &fired) in sfc.transitions.iter().zip(&fired) {
            t.to.iter().for_each(|s| enter[s.index()].push(fired));
        }
        for (s, by) in sfc.steps.ids().zip(&enter) {
            let entered = self.aig.any(by);
            self.assign(x(s), entered, Lit::TRUE);
        }
        self.actions(sfc, &was);
    }

    /// Associations, then what they have stored, then the bodies of the actions that run.
    fn actions(&mut self, sfc: &Sfc, was: &[Lit]) {
        let mut run = vec![Lit::FALSE; sfc.actions.len()];
        // For each target, whether it is set and reset in this scan.
        let mut stored: BTreeMap<Target, [Lit; 2]> = BTreeMap::new();
        for (id, step) in sfc.steps.iter() {
            let now = self.state[self.step.steps[self.program] + id.index()];
            let on = self.aig.and(now, !was[id.index()]);
            let off = self.aig.and(!now, was[id.index()]);
            for a in &step.associations {
                let either = self.aig.or(now, off);
                let writes = match a.qualifier {
                    Qualifier::NonStored => Some((either, now)),
                    Qualifier::Pulse | Qualifier::PulseRising => Some((Lit::TRUE, on)),
                    Qualifier::PulseFalling => Some((Lit::TRUE, off)),
                    Qualifier::Set | Qualifier::Reset => {
                        let slot = stored.entry(a.target).or_insert([Lit::FALSE; 2]);
                        let slot = &mut slot[usize::from(a.qualifier == Qualifier::Reset)];
                        *slot = self.aig.or(*slot, now);
                        None
                    }
                    Qualifier::Limited
                    | Qualifier::Delayed
                    | Qualifier::StoredLimited
                    | Qualifier::StoredDelayed
                    | Qualifier::DelayedStored => unreachable!("durations have been refused"),
                };
                match (writes, a.target) {
                    (None, _) => {}
                    (Some((when, value)), Target::Variable(v)) => self.assign(self.variable(v), when, value),
                    (Some((when, value)), Target::Action(a)) => {
                        run[a.index()] = self.aig.select(when, value, run[a.index()]);
                    }
                }
            }
        }
        for (&target, &[set, reset]) in &stored {
            let latch = match target {
                Target::Variable(v) => self.variable(v),
                Target::Action(a) => self.step.stored[self.program] + a.index(),
            };
            self.assign(latch, set, Lit::TRUE);
            self.assign(latch, reset, Lit::FALSE);
        }
        for (id, action) in sfc.actions.iter() {
            let stored = self.state[self.step.stored[self.program] + id.index()];
            let runs = self.aig.or(run[id.index()], stored);
            self.statements(&action.body, runs);
        }
    }
}

/// Looks for what cannot be encoded.
struct Refusal<'p> {
    project: &'p Project,
    program: &'p str,
    presets: &'p mut Vec<Option<Time>>,
}

impl Refusal<'_> {
    fn because<T>(&self, what: &str) -> Result<T, String> {
        Err(format!("program {} uses {what}, which is not encoded yet", self.program))
    }

    fn body(&mut self, body: &Body) -> Result<(), String> {
        match body {
            Body::Code(statements) => self.statements(statements),
            Body::Sfc(sfc) => {
                for step in sfc.steps.values() {
                    for a in &step.associations {
                        self.qualifier(a.qualifier)?;
                        if let Target::Variable(v) = a.target {
                            self.variable(v)?;
                        }
                    }
                }
                sfc.transitions.iter().try_for_each(|t| self.condition(&t.condition))?;
                sfc.actions.values().try_for_each(|Action { body, .. }| self.statements(body))
            }
        }
    }

    fn qualifier(&self, qualifier: Qualifier) -> Result<(), String> {
        match qualifier {
            Qualifier::NonStored
            | Qualifier::Set
            | Qualifier::Reset
            | Qualifier::Pulse
            | Qualifier::PulseRising
            | Qualifier::PulseFalling => Ok(()),
            Qualifier::Limited
            | Qualifier::Delayed
            | Qualifier::StoredLimited
            | Qualifier::StoredDelayed
            | Qualifier::DelayedStored => self.because("an action with a duration"),
        }
    }

    fn statements(&mut self, statements: &[Statement]) -> Result<(), String> {
        statements.iter().try_for_each(|s| match s {
            Statement::Coil(coil) => {
                self.variable(coil.variable)?;
                self.condition(&coil.condition)
            }
            Statement::Move { to, value } => {
                self.integer(*to)?;
                self.number(value)
            }
            Statement::Call(call) => {
                let both = match self.project.blocks[call.block].kind {
                    BlockKind::RTrig | BlockKind::FTrig => false,
                    BlockKind::Sr | BlockKind::Rs => true,
                    BlockKind::Ton => {
                        self.preset(call)?;
                        false
                    }
                    BlockKind::Tof | BlockKind::Tp => return self.because("a timer TOF or TP"),
                };
                if call.input.is_none() || (both && call.reset.is_none()) {
                    return self.because("a call that leaves an input out");
                }
                call.input.iter().chain(&call.reset).try_for_each(|c| self.condition(c))
            }
        })
    }

    fn preset(&mut self, call: &Call) -> Result<(), String> {
        let Some(Number::Const(time @ 1..)) = call.preset else {
            return self.because("a timer without a constant, positive time");
        };
        match self.presets[call.block.index()].replace(time) {
            Some(other) if other != time => self.because("a timer with several times"),
            _ => Ok(()),
        }
    }

    fn condition(&self, condition: &Condition) -> Result<(), String> {
        let mut result = Ok(());
        for e in condition.shared.iter().chain([&condition.value]) {
            e.for_each_atom(&mut |atom| {
                let found = match atom {
                    Atom::Variable(v) => self.variable(*v),
                    Atom::Step(_) | Atom::Shared(_) | Atom::Output(_) => Ok(()),
                    Atom::Compare(_, left, right) => self.number(left).and_then(|()| self.number(right)),
                };
                if result.is_ok() {
                    result = found;
                }
            });
        }
        result
    }

    fn variable(&self, id: VarId) -> Result<(), String> {
        match self.project.variables[id].kind {
            Kind::Bool => Ok(()),
            Kind::Int { .. } | Kind::Time => self.because("a number as BOOL"),
        }
    }
}
