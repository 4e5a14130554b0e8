//! E305 and E308 are said of what is impossible in every run, and of nothing else.
//!
//! Small machines by chance are resolved, checked, and then run in spite of what was found: all inputs in each state, until
//! there is no new one. What the compiler calls impossible must not have happened.

use crate::support::rng::Rng;
use chartwright::base::{Code, Diagnostics};
use chartwright::ir::chart::{Machine, StateId};
use chartwright::pipeline::{self, Dialect, Options};
use chartwright::simulate::chart::Chart;
use chartwright::simulate::scenario;
use chartwright::{check, parse, resolve};
use std::collections::{HashSet, VecDeque};
use std::fmt::Write;

/// No error, proved in both dialects, and its scenarios go as they say on the chart and on the program.
fn assert_right(source: &str) {
    for dialect in [Dialect::Beremiz, Dialect::Codesys] {
        let options = Options { dialect, created: "2000-01-01T00:00:00".into(), prove: true };
        let (output, diagnostics) = pipeline::build(source, &options);
        assert!(output.is_some(), "{source}\n{diagnostics:#?}");
    }
    let machine = pipeline::check(source).0.expect("it was built");
    assert!(!machine.scenarios.is_empty(), "{source}");
    for index in 0..machine.scenarios.len() {
        for (program, run) in pipeline::programs(&machine) {
            let verdict = scenario::play(&machine, run, index, &mut |_, _| {});
            assert!(verdict.failure.is_none(), "{program}: {:?}\n{source}", verdict.failure);
        }
    }
}

const HEAD: &str = "machine M inputs { Go Stop Cont } outputs { LAMP } actuator Lamp onoff by LAMP";

#[test]
fn a_shallow_history_enters_what_is_inside_the_last_state() {
    assert_right(&format!(
        "{HEAD} chart C {{
           initial state Rest
           state Job {{
             initial state Load
             state Mill {{ initial state Rough {{ drives LAMP }}  state Fine  from Rough to Fine when Cont }}
           }}
           from Rest to Job.Mill.Fine when Go
           from Job to Rest when Stop
           from Rest to history of Job when Cont
         }}
         scenario \"by default\" {{ press Go expect in(Fine) press Stop press Cont expect in(Rough) and LAMP }}"
    ));
    // Two levels down, in one region of a parallel state, through a choice.
    assert_right(&format!(
        "{HEAD} chart C {{
           initial state Rest
           choice Back {{ when Go to Rest  else to history of Job }}
           parallel state Job {{
             region A {{
               initial state Load
               state Mill {{ initial state Deep {{ initial state Rough {{ drives LAMP }}  state Fine  from Rough to Fine when Cont }} }}
             }}
             region B {{ initial state Cold }}
           }}
           from Rest to Job.A.Mill.Deep.Fine when Go
           from Job to Rest when Stop
           from Rest to Back when Cont
         }}
         scenario \"by default\" {{ press Go expect in(Fine) press Stop press Cont expect in(Rough) and LAMP }}"
    ));
}

#[test]
fn a_history_begins_what_was_done_as_a_whole() {
    assert_right(&format!(
        "{HEAD} chart C {{
           initial state Rest
           state Job {{
             initial state Mill {{ initial state Rough {{ drives LAMP }}  final state Fine }}
           }}
           from Rest to Job.Mill.Fine when Go
           from Job to Rest when Stop
           from Rest to deep history of Job.Mill when Cont
         }}
         scenario \"by default\" {{ press Go expect in(Fine) press Stop press Cont expect in(Rough) and LAMP }}"
    ));
}

#[test]
fn an_internal_transition_takes_no_turn() {
    assert_right(&format!(
        "{HEAD} variables {{ Seen : BOOL }} chart C {{
           initial state Run {{
             internal when Cont then set Seen
             initial state Slow
             state Fast {{ drives LAMP }}
             from Slow to Fast when Go
             from Slow to Off when Stop
           }}
           state Off {{ drives LAMP when Seen }}
           from Off to Run when Stop
         }}
         scenario \"inside\" {{ set Cont, Go wait 2 scans expect in(Fast) and LAMP }}
         scenario \"out\" {{ wait 1 scan set Cont press Stop expect in(Off) and not LAMP }}"
    ));
    // Beside one that leaves in the first scan that it can.
    assert_right(&format!(
        "{HEAD} variables {{ Seen : BOOL }} chart C {{
           initial state Run {{
             internal when Cont then set Seen
             initial state Slow
             parallel state Fast {{
               region A {{ initial state P  state Q {{ drives LAMP }}  from P to Q when Go }}
               region B {{ initial state S }}
             }}
             from Slow to Fast when Go
           }}
           state Off
           from Run to Off when Cont
           from Off to Run when Stop or Seen
         }}
         scenario \"inside\" {{ set Go wait 3 scans expect in(Q) and LAMP set Cont wait 1 scan expect in(Off) and not Seen }}"
    ));
}

/// The codes of what is found, and what is said of it.
fn found(lines: &str) -> Vec<(&'static str, String)> {
    let (_, diagnostics) = pipeline::check(&format!("{HEAD} variables {{ Seen : BOOL }} chart C {{ {lines} }}"));
    let said = |d: &chartwright::base::Diagnostic| (d.code.number(), format!("{}: {}", d.message, d.labels[0].text));
    diagnostics.iter().map(said).filter(|(code, _)| code.starts_with('E')).collect()
}

#[test]
fn what_is_impossible_is_said_as_it_is() {
    // An internal one takes no turn.
    let always = "initial state Run { internal when Cont then set Seen  initial state Slow  state Fast { drives LAMP }
                    from Slow to Fast when Go }
                  state Off  from Off to Run when Stop  from Run to Off priority 1 when true";
    for more in ["", "internal when Go then set Seen"] {
        let said = found(&always.replace("initial state Run {", &format!("initial state Run {{ {more}")));
        let beaten = ("E308", "this transition from `Run.Slow` to `Run.Fast` can never fire: never fires".to_owned());
        let inside = ("E308", "this internal transition of `Run` can never fire: never happens".to_owned());
        let fast = ("E305", "`Run.Fast` is never entered: no transition that leads here can ever fire".to_owned());
        assert!([beaten, inside, fast].iter().all(|d| said.contains(d)), "{said:?}");
    }
    // Deep history comes back to what was there; a shallow one of another state enters nothing here.
    let job = "initial state Rest  state Job { initial state Load  state Mill { initial state Rough { drives LAMP }  state Fine } }
               from Rest to Job.Mill.Fine when Go  from Job to Rest when Stop";
    for back in ["from Rest to deep history of Job when Cont", "from Rest to history of Job.Mill when false"] {
        let said = found(&format!("{job} {back}"));
        let rough =
            said.iter().find(|(code, text)| *code == "E305" && text.contains("Rough")).expect("Rough is never entered");
        assert!(rough.1.contains("Rough` is never entered: whatever enters `"), "{said:?}");
    }
    // A way through a choice that nobody takes.
    let said = found(
        "initial state A { drives LAMP }  state B  state D  choice X { when false to B  else to D }  from A to X when Go  from D to B when Stop from B to A",
    );
    assert_eq!(said, [("E308", "this transition from `A` to `B` can never fire: its condition is never TRUE".into())]);
}

/// A small machine by chance, with everything that decides what is entered and what fires.
struct Small {
    rng: Rng,
    names: usize,
    /// All states; composite ones; and for each parallel one two states side by side.
    states: Vec<String>,
    composite: Vec<String>,
    forks: Vec<(String, String)>,
    choices: Vec<String>,
}

impl Small {
    fn source(seed: u64) -> String {
        let mut small = Small {
            rng: Rng::new(seed),
            names: 0,
            states: Vec::new(),
            composite: Vec::new(),
            forks: Vec::new(),
            choices: Vec::new(),
        };
        let mut text = String::new();
        small.region(0, &mut text);
        // What leads where is written when all names are known.
        while let Some(at) = text.find('@') {
            let line = small.line();
            text.replace_range(at..=at, &line);
        }
        while let Some(at) = text.find('#') {
            let branches = format!("when {} to {} else to {}", small.guard(), small.goal(), small.goal());
            text.replace_range(at..=at, &branches);
        }
        format!("machine M inputs {{ I J }} variables {{ V : BOOL }} chart C {{ {text} }}")
    }

    fn name(&mut self, letter: char) -> String {
        self.names += 1;
        format!("{letter}{}", self.names)
    }

    /// A region; returns one of its states.
    fn region(&mut self, depth: usize, text: &mut String) -> String {
        let first = self.states.len();
        let count = self.rng.between(1, 3);
        let mut own = Vec::new();
        let begins = if count > 1 && self.rng.chance(15) { None } else { Some(self.rng.below(count)) };
        for i in 0..count {
            let name = self.name('S');
            own.push(name.clone());
            self.states.push(name.clone());
            let initial = if begins == Some(i) { "initial " } else { "" };
            let kind = self.rng.below(10);
            if depth < 2 && kind < 4 && self.states.len() < 9 {
                self.composite.push(name.clone());
                let mut inside = String::new();
                let internal = if self.rng.chance(40) { self.internal() } else { String::new() };
                if kind == 0 {
                    let (mut other, a, b) = (String::new(), self.name('R'), self.name('R'));
                    let one = self.region(depth + 1, &mut inside);
                    let two = self.region(depth + 1, &mut other);
                    self.forks.push((one, two));
                    let _ = write!(
                        text,
                        "{initial}parallel state {name} {{ {internal} region {a} {{ {inside} }} region {b} {{ {other} }} }} "
                    );
                } else {
                    self.region(depth + 1, &mut inside);
                    let _ = write!(text, "{initial}state {name} {{ {internal} {inside} }} ");
                }
            } else {
                let kind = if kind == 9 { "final " } else { "" };
                let inside = if self.rng.chance(15) { format!("{{ {} }}", self.internal()) } else { String::new() };
                let _ = write!(text, "{initial}{kind}state {name} {inside} ");
            }
        }
        if begins.is_none() {
            let (name, guard) = (self.name('X'), self.guard());
            let _ = write!(text, "initial choice {name} {{ when {guard} to {} else to {} }} ", own[0], own[1]);
        }
        if self.rng.chance(20) {
            let name = self.name('X');
            let _ = write!(text, "choice {name} {{ # }} ");
            self.choices.push(name);
        }
        let lines = self.rng.between(1, self.states.len() - first + 1);
        text.push_str(&"@ ".repeat(lines));
        self.rng.pick(&own).clone()
    }

    fn internal(&mut self) -> String {
        let guard = self.guard();
        format!("internal when {guard} then set V")
    }

    fn priority(&mut self) -> String {
        if self.rng.chance(25) {
            self.names += 1;
            return format!(" priority {}", self.names);
        }
        String::new()
    }

    fn guard(&mut self) -> String {
        match self.rng.below(12) {
            0..=2 => "true".into(),
            3 => "false".into(),
            4 => "V".into(),
            5 if !self.states.is_empty() => format!("in({})", self.rng.pick(&self.states)),
            6 => "I and J".into(),
            7 => "not I".into(),
            n => (if n % 2 == 0 { "I" } else { "J" }).into(),
        }
    }

    fn goal(&mut self) -> String {
        match self.rng.below(10) {
            0 | 1 if !self.composite.is_empty() => {
                let deep = if self.rng.chance(50) { "deep " } else { "" };
                format!("{deep}history of {}", self.rng.pick(&self.composite))
            }
            2 if !self.forks.is_empty() => {
                let (one, two) = self.rng.pick(&self.forks).clone();
                format!("({one}, {two})")
            }
            _ => self.rng.pick(&self.states).clone(),
        }
    }

    fn line(&mut self) -> String {
        let source = match self.rng.below(12) {
            0 => "any".into(),
            1 if !self.forks.is_empty() => {
                let (one, two) = self.rng.pick(&self.forks).clone();
                format!("({one}, {two})")
            }
            _ => self.rng.pick(&self.states).clone(),
        };
        let target = if !self.choices.is_empty() && self.rng.chance(20) {
            self.rng.pick(&self.choices).clone()
        } else {
            self.goal()
        };
        let priority = self.priority();
        let guard = if self.rng.chance(80) { format!(" when {}", self.guard()) } else { String::new() };
        format!("from {source} to {target}{priority}{guard}")
    }
}

/// What is entered and what fires in some run; nothing if there are too many states.
fn explore(machine: &Machine) -> Option<(Vec<bool>, Vec<bool>)> {
    let (mut entered, mut fired) = (vec![false; machine.states.len()], vec![false; machine.transitions.len()]);
    let mut seen = HashSet::new();
    let mut open = VecDeque::from([(Chart::new(machine), vec![None; machine.regions.len()])]);
    while let Some((chart, last)) = open.pop_front() {
        for inputs in [[false, false], [true, false], [false, true], [true, true]] {
            let (mut chart, mut last): (Chart, Vec<Option<StateId>>) = (chart.clone(), last.clone());
            chart.scan(&inputs);
            for state in chart.active() {
                entered[state.index()] = true;
                last[machine.states[state].region.index()] = Some(state);
            }
            chart.fired().iter().for_each(|t| fired[t.index()] = true);
            let variable = machine.variables.ids().any(|v| chart.variable(v));
            if seen.insert((chart.active().collect::<Vec<_>>(), last.clone(), variable)) {
                if seen.len() > 4_000 {
                    return None;
                }
                open.push_back((chart, last));
            }
        }
    }
    Some((entered, fired))
}

/// What is called impossible and happens; how much of it there is.
fn contradicted(machine: &Machine, found: &Diagnostics, entered: &[bool], fired: &[bool]) -> (usize, Option<String>) {
    let mut judged = 0;
    for d in found.iter() {
        let span = d.labels[0].span;
        let happens = match d.code {
            Code::NeverEntered => machine.states.iter().any(|(id, s)| s.span == span && entered[id.index()]),
            Code::NeverFires => machine.transitions.iter().any(|(id, t)| {
                let target = format!(" to `{}` can", machine.state_path(t.target));
                t.span == span && fired[id.index()] && (t.internal || d.message.contains(&target))
            }),
            _ => continue,
        };
        judged += 1;
        if happens {
            return (judged, Some(format!("{}: {}", d.code.number(), d.message)));
        }
    }
    (judged, None)
}

#[test]
fn what_is_called_impossible_never_happens() {
    let (mut never_entered, mut never_fires, mut missed, mut accepted) = (0, 0, 0, 0);
    for seed in crate::support::random::seeds(4_000) {
        let source = Small::source(seed);
        let (tree, diagnostics) = parse::parse(&source);
        let tree = tree.unwrap_or_else(|| panic!("{source}: {diagnostics:?}"));
        let (mut machine, resolved) = resolve::resolve(&tree);
        if resolved.has_errors() {
            continue;
        }
        let found = check::check(&mut machine);
        let Some((entered, fired)) = explore(&machine) else { continue };
        let (_, wrong) = contradicted(&machine, &found, &entered, &fired);
        assert_eq!(wrong, None, "seed {seed}: {source}");
        let count = |code: Code| found.iter().filter(|d| d.code == code).count();
        never_entered += count(Code::NeverEntered);
        never_fires += count(Code::NeverFires);
        if !found.has_errors() {
            accepted += 1;
            missed += entered.iter().filter(|&&e| !e).count();
        }
    }
    println!("{never_entered} states never entered, {never_fires} transitions never fire: all true");
    println!("{accepted} machines without an error, with {missed} states that conditions keep from being entered");
    assert!(never_entered > 500 && never_fires > 500 && accepted > 300, "{never_entered}, {never_fires}, {accepted}");
}
