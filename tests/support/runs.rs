//! Runs of one model side by side: what the chart simulator says against itself, against the rules of
//! its meaning, and against the program that the model is compiled to.

use super::rng::Rng;
use chartwright::ir::chart::{
    Atom, ConstraintId, EventId, FilterMode, Guard, IntegerId, Machine, Mark, OutputId, Phase, ScanNumber, StateId,
    VariableId,
};
use chartwright::ir::iec::VarId;
use chartwright::ir::number::{Number, Range};
use chartwright::ir::plc::{Origin, Role};
use chartwright::pipeline::{self, Dialect, Options, Output};
use chartwright::read::read;
use chartwright::simulate::chart::Chart;
use chartwright::simulate::plc::Plc;
use std::path::Path;

/// How many scans of a model are kept.
const KEPT: usize = 200;

/// Inputs that change rarely or often, the same for the same seed.
pub struct Inputs {
    rng: Rng,
    percent: usize,
    now: Vec<bool>,
}

impl Inputs {
    /// The inputs of that seed.
    pub fn new(machine: &Machine, seed: u64) -> Inputs {
        let mut rng = Rng::new(seed ^ 0x0069_6e70_7574_7321);
        let now = machine.inputs.ids().map(|_| rng.chance(50)).collect();
        Inputs { percent: rng.between(3, 50), rng, now }
    }

    /// Those of the next scan.
    pub fn next(&mut self) -> &[bool] {
        for value in &mut self.now {
            *value ^= self.rng.chance(self.percent);
        }
        &self.now
    }
}

/// What is wrong with a run of the chart simulator, if anything is. Invalid models have no run.
pub fn incoherence(source: &str, seed: u64, scans: usize) -> Option<String> {
    let machine = pipeline::check(source).0?;
    let (mut chart, mut again) = (Chart::new(&machine), Chart::new(&machine));
    let mut inputs = Inputs::new(&machine, seed);
    let mut before: Option<Vec<bool>> = None;
    // Which constraints acted first, since the last reset.
    let mut noted: Option<(Vec<bool>, u32)> = None;
    let mut past = vec![false; machine.outputs.len()];
    for scan in 1..=scans {
        let now = inputs.next().to_vec();
        chart.scan(&now);
        again.scan(&now);
        let wrong = |what: String| Some(format!("scan {scan}: {what}"));
        for (id, region) in machine.regions.iter() {
            let active = region.states.iter().filter(|&&s| chart.is_active(s)).count();
            let wanted = usize::from(region.parent.is_none_or(|p| chart.is_active(p)));
            if active != wanted {
                return wrong(format!("{active} active states in `{}`, not {wanted}", machine.region_path(id)));
            }
        }
        // Observers may have moved since the filter decided.
        let moved = || chart.fired().iter().map(|&t| &machine.transitions[t]).filter(|t| t.phase == Phase::End);
        let was = |s: StateId| match moved().find(|t| t.source == s || t.target == s) {
            Some(t) => t.source == s,
            None => chart.is_active(s),
        };
        let lost = |guard: &Guard| {
            let mut lost = false;
            guard.for_each_atom(&mut |a| {
                let written = |v| moved().any(|t| t.deeds.effects.iter().any(|e| e.variable == v));
                lost |= matches!(*a, Atom::Variable(v) if written(v));
            });
            lost
        };
        let value = |atom: &Atom| match *atom {
            Atom::Input(i) => now[i.index()],
            Atom::PrevInput(i) => before.as_ref().unwrap_or(&now)[i.index()],
            Atom::Output(o) => chart.output(o),
            Atom::PrevOutput(o) => past[o.index()],
            Atom::Variable(v) => chart.variable(v),
            Atom::Event(e) => chart.event(e),
            Atom::In(s) if machine.observes(s) => was(s),
            Atom::Compare(c) => {
                let compared = &machine.comparisons[c];
                let (left, right) = (number(&compared.left, &chart), number(&compared.right, &chart));
                compared.relation.decided(Range::of(left), Range::of(right)) == Some(true)
            }
            Atom::In(_) | Atom::Done(_) | Atom::After(..) => unreachable!("constraints do not know of states"),
        };
        for (id, integer) in machine.integers.iter() {
            let value = chart.integer(id);
            if !integer.range.holds(Range::of(value)) {
                return wrong(format!("{} is {value}", integer.name));
            }
        }
        let mut assumed = true;
        for (i, assumption) in machine.safety.assumptions.iter().enumerate() {
            let seen = assumption.never.eval(&mut |a| value(a));
            let broken = if lost(&assumption.never) { chart.broken(i) } else { seen };
            assumed &= !broken;
            if broken != chart.broken(i) {
                return wrong(format!("`{}` is broken: {broken}", assumption.name));
            }
        }
        if assumed && chart.filter_failed() {
            return wrong("the filter found no way".into());
        }
        let mut acted = false;
        for (id, constraint) in machine.safety.constraints.iter() {
            acted |= chart.acted(id);
            if !lost(&constraint.never) && constraint.never.eval(&mut |a| value(a)) && !chart.filter_failed() {
                return wrong(format!("the outputs violate `{}`", constraint.name));
            }
        }
        let stopped = machine.safety.mode == Some(FilterMode::Blocking) && chart.mark(Mark::Noted);
        if !acted && !stopped && machine.outputs.ids().any(|o| chart.output(o) != chart.command(o)) {
            return wrong("an output is not as commanded, and nothing has acted".into());
        }
        if machine.safety.mode == Some(FilterMode::Blocking) {
            let commanded = |atom: &Atom| match *atom {
                Atom::Output(o) => chart.command(o),
                ref other => value(other),
            };
            let acts = |c: ConstraintId| machine.safety.constraints[c].never.eval(&mut |a| commanded(a));
            if let Some(c) = machine.safety.constraints.ids().find(|&c| acts(c) != chart.acted(c)) {
                return wrong(format!("`{}` acts: {}", machine.safety.constraints[c].name, acts(c)));
            }
        }
        if let Some(reset) = machine.safety.reset {
            let rises = now[reset.index()] && before.as_ref().is_some_and(|b| !b[reset.index()]);
            let kept = noted.is_some() && !rises;
            let first = |c| chart.mark(Mark::First(c));
            let acting: Vec<bool> = machine.safety.constraints.ids().map(|c| chart.acted(c)).collect();
            if !kept {
                noted = acted.then_some((acting, scan as u32));
            }
            let expected = |c: ConstraintId| noted.as_ref().is_some_and(|(n, _)| n[c.index()]);
            let began = noted.as_ref().map_or(0, |(_, scan)| *scan);
            let right = chart.mark(Mark::Noted) == noted.is_some() && chart.scan_number(ScanNumber::First) == began;
            if !right || machine.safety.constraints.ids().any(|c| first(c) != expected(c)) {
                return wrong("what the filter remembers is not what it should".into());
            }
        }
        let same = chart.active().eq(again.active())
            && chart.fired() == again.fired()
            && machine.variables.ids().all(|v| chart.variable(v) == again.variable(v))
            && machine.events.ids().all(|e| chart.event(e) == again.event(e))
            && machine
                .outputs
                .ids()
                .all(|o| chart.output(o) == again.output(o) && chart.command(o) == again.command(o));
        if !same {
            return wrong("the second run differs".into());
        }
        past = machine.outputs.ids().map(|o| chart.output(o)).collect();
        before = Some(now);
    }
    None
}

/// The value of an integer expression after a scan.
fn number(number: &Number<IntegerId>, chart: &Chart) -> i64 {
    match number {
        Number::Const(n) => *n,
        Number::Value(i) => chart.integer(*i),
        Number::Sum(operands) => operands
            .iter()
            .map(|o| if o.negative { -self::number(&o.value, chart) } else { self::number(&o.value, chart) })
            .sum(),
    }
}

/// What a global variable of the program has to equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Meaning {
    State(StateId),
    Variable(VariableId),
    Event(EventId),
    Integer(IntegerId),
    Command(OutputId),
    Output(OutputId),
    Alarm(ConstraintId),
    Broken(usize),
    Mark(Mark),
    Scan(ScanNumber),
}

impl Meaning {
    fn of(self, chart: &Chart) -> i64 {
        i64::from(match self {
            Meaning::Integer(i) => return chart.integer(i),
            Meaning::Scan(number) => return i64::from(chart.scan_number(number)),
            Meaning::State(s) => chart.is_active(s),
            Meaning::Variable(v) => chart.variable(v),
            Meaning::Event(e) => chart.event(e),
            Meaning::Command(o) => chart.command(o),
            Meaning::Output(o) => chart.output(o),
            Meaning::Alarm(c) => chart.acted(c),
            Meaning::Broken(a) => chart.broken(a),
            Meaning::Mark(mark) => chart.mark(mark),
        })
    }
}

/// What global variables of a program have to equal, by their names; what of the chart has no variable of its own,
/// or more than one, is an error.
fn meanings(built: &Output) -> Result<Vec<(String, Meaning)>, String> {
    let machine = &built.machine;
    let mut meanings: Vec<(String, Meaning)> = Vec::new();
    for global in built.project.globals.values() {
        let meaning = match (global.role, global.origin) {
            // What takes a long rung is computed in parts.
            _ if global.name.starts_with("Part") => None,
            (Role::StepFlag, Origin::State(s)) => Some(Meaning::State(s)),
            (Role::Variable, Origin::Variable(v)) => Some(Meaning::Variable(v)),
            (Role::Variable, Origin::Integer(i)) => Some(Meaning::Integer(i)),
            (Role::Event, Origin::Event(e)) => Some(Meaning::Event(e)),
            (Role::Command, Origin::Output(o)) => Some(Meaning::Command(o)),
            (Role::Output, Origin::Output(o)) => Some(Meaning::Output(o)),
            (Role::Scan, _) => Some(Meaning::Scan(ScanNumber::This)),
            (Role::FirstScan, _) => Some(Meaning::Scan(ScanNumber::First)),
            (Role::Noted, _) => Some(Meaning::Mark(Mark::Noted)),
            (Role::First, Origin::Constraint(c)) => Some(Meaning::Mark(Mark::First(c))),
            (Role::Alarm | Role::Acted, Origin::Constraint(c)) => Some(Meaning::Alarm(c)),
            (Role::Alarm, Origin::Assumption(a)) => Some(Meaning::Broken(a)),
            _ => None,
        };
        meanings.extend(meaning.map(|m| (global.name.clone(), m)));
    }
    // Each has to be there, and once.
    let wanted = (machine.states.ids().map(Meaning::State))
        .chain(machine.variables.ids().map(Meaning::Variable))
        .chain(machine.events.ids().map(Meaning::Event))
        .chain(machine.integers.ids().map(Meaning::Integer))
        .chain(machine.outputs.ids().map(Meaning::Output))
        .chain(machine.safety.constraints.ids().map(Meaning::Alarm))
        .chain(machine.safety.marks().map(Meaning::Mark))
        .chain(machine.safety.scan_numbers().map(Meaning::Scan));
    for meaning in wanted {
        let names: Vec<&str> = meanings.iter().filter(|(_, m)| *m == meaning).map(|(n, _)| n.as_str()).collect();
        if names.len() != 1 {
            return Err(format!("{meaning:?} of the chart is called {names:?} in the program"));
        }
    }
    Ok(meanings)
}

/// Where a run of the machine and one of its program, written as XML and read back, first differ.
/// Invalid models have no run.
pub fn disagreement(source: &str, seed: u64, scans: usize, dialect: Dialect) -> Option<String> {
    let options = Options { dialect, created: "1970-01-01T00:00:00".into(), prove: false };
    let built = pipeline::build(source, &options).0?;
    let machine = &built.machine;
    let (read_back, problems) = read(&built.xml);
    let Some(program) = read_back else {
        return Some(format!("the XML cannot be read: {:?}", problems.iter().next().map(|p| &p.message)));
    };
    let variable = |name: &str| -> Option<VarId> {
        program.variables.iter().find(|(_, v)| v.name.eq_ignore_ascii_case(name)).map(|(id, _)| id)
    };

    let meanings = match meanings(&built) {
        Ok(meanings) => meanings,
        Err(what) => return Some(what),
    };
    let mut watched = Vec::new();
    for (name, meaning) in meanings {
        let Some(id) = variable(&name) else { return Some(format!("`{name}` is not in the XML")) };
        watched.push((name, id, meaning));
    }
    // An input that nothing reads may be left out.
    let inputs: Vec<Option<VarId>> = machine.inputs.values().map(|i| variable(&i.name)).collect();

    let (mut chart, mut plc) = (Chart::new(machine), Plc::new(&program));
    let mut values = Inputs::new(machine, seed);
    for scan in 1..=scans {
        let now = values.next();
        for (&id, &value) in inputs.iter().zip(now) {
            if let Some(id) = id {
                plc.write(id, i64::from(value));
            }
        }
        chart.scan(now);
        plc.scan(scan as i64 * i64::from(machine.cycle) * 1000);
        let differ = watched.iter().filter(|(_, id, meaning)| plc.read(*id) != meaning.of(&chart));
        let differ: Vec<String> =
            differ.map(|(name, _, meaning)| format!("{name} is {} in the chart", meaning.of(&chart))).collect();
        if !differ.is_empty() {
            return Some(format!("scan {scan}: {}, and not so in the program", differ.join(", ")));
        }
    }
    None
}

/// Puts a model, its program, inputs and what the program has to make of them into files, if the model is valid:
/// tables with a row per scan, and columns that are called like variables of the program.
pub fn keep(source: &str, seed: u64, folder: &Path) {
    let options = Options { dialect: Dialect::Beremiz, created: "1970-01-01T00:00:00".into(), prove: false };
    let Some(built) = pipeline::build(source, &options).0 else { return };
    let machine = &built.machine;
    let meanings = meanings(&built).expect("all that the chart has is in the program");
    let head = |names: &mut dyn Iterator<Item = &String>| names.fold("scan".to_owned(), |row, name| row + "," + name);
    let mut inputs = vec![head(&mut machine.inputs.values().map(|i| &i.name))];
    let mut expected = vec![head(&mut meanings.iter().map(|(name, _)| name))];
    let mut chart = Chart::new(machine);
    let mut values = Inputs::new(machine, seed);
    for scan in 1..=KEPT {
        let row = |values: &mut dyn Iterator<Item = i64>| values.fold(scan.to_string(), |row, v| format!("{row},{v}"));
        let now = values.next();
        inputs.push(row(&mut now.iter().map(|&v| i64::from(v))));
        chart.scan(now);
        expected.push(row(&mut meanings.iter().map(|(_, meaning)| meaning.of(&chart))));
    }
    std::fs::create_dir_all(folder).expect("the folder can be made");
    let table = |rows: Vec<String>| rows.join("\n") + "\n";
    let files = [("chart", source.to_owned()), ("xml", built.xml), ("inputs.csv", table(inputs))];
    for (kind, text) in files.into_iter().chain([("expected.csv", table(expected))]) {
        std::fs::write(folder.join(format!("{seed}.{kind}")), text).expect("files can be written");
    }
}
