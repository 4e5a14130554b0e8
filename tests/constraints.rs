//! What is said of constraints, against all cases tried one by one.

use crate::support::rng::Rng;
use chartwright::base::Severity;
use chartwright::constraints::properties::{self, Kind};
use chartwright::ir::chart::{Atom, Machine, OutputId, outputs_of};
use chartwright::ir::relief::Reliefs;
use chartwright::{parse, pipeline, resolve};
use std::collections::BTreeSet;

/// A machine with three outputs and two inputs, and these constraints.
fn source(safety: &str) -> String {
    format!(
        "machine M\ninputs {{ A  B }}\noutputs {{ O1  O2  O3 }}\n\
         actuator A1 onoff by O1\nactuator A2 onoff by O2\nactuator A3 onoff by O3\n\
         chart C {{ initial state S {{ drives O1 when A  drives O2 when B  drives O3 when A }} }}\n\
         safety supervisor {{\n{safety}\n}}"
    )
}

/// The machine, whether its constraints are coherent or not; nothing if they are no constraints.
fn machine(safety: &str) -> Option<Machine> {
    let (tree, diagnostics) = parse::parse(&source(safety));
    let tree = tree.unwrap_or_else(|| panic!("{safety}\n{diagnostics:?}"));
    let (machine, diagnostics) = resolve::resolve(&tree);
    (!diagnostics.has_errors()).then_some(machine)
}

/// One case: what is read, and what is commanded.
#[derive(Clone, Copy)]
struct Case(usize);

impl Case {
    const ALL: usize = 1 << 10;

    fn reading(self, atom: Atom) -> bool {
        let bit = match atom {
            Atom::Input(i) => i.index(),
            Atom::PrevInput(i) => 2 + i.index(),
            Atom::PrevOutput(o) => 4 + o.index(),
            other => panic!("{other:?} is not read here"),
        };
        self.0 >> bit & 1 == 1
    }

    fn command(self, output: OutputId) -> bool {
        self.0 >> (7 + output.index()) & 1 == 1
    }

    /// Whether this is a case that the assumptions allow.
    fn allowed(self, machine: &Machine) -> bool {
        machine.safety.assumptions.iter().all(|a| !a.never.eval(&mut |&a| self.reading(a)))
    }

    /// What goes wrong in the corrected algorithm of method.md, and whether its outputs are safe.
    fn run(self, machine: &Machine) -> (BTreeSet<(u8, OutputId)>, bool) {
        let mut wrong = BTreeSet::new();
        let constraints: Vec<_> =
            machine.safety.constraints.values().flat_map(|c| c.products.iter().map(move |p| (c, p))).collect();
        let (mut fs, mut fc) = ([[false; 2]; 3], [[false; 2]; 3]);
        for (_, p) in &constraints {
            let outputs: Vec<_> = outputs_of(p).collect();
            let holds = |l: &chartwright::ir::sop::Literal<Atom>| {
                matches!(l.atom, Atom::Output(_)) || self.reading(l.atom) != l.negated
            };
            if let ([(o, negated)], true) = (&outputs[..], p.literals().iter().all(holds)) {
                fs[o.index()][usize::from(*negated)] = true;
            }
        }
        wrong.extend(machine.outputs.ids().filter(|o| fs[o.index()] == [true; 2]).map(|o| (0, o)));
        let mut safe = false;
        for _ in 0..20 {
            let select = |o: OutputId| {
                let ([fs0, fs1], [fc0, fc1]) = (fs[o.index()], fc[o.index()]);
                !fs0 && (!fc0 && self.command(o) || fc1) || fs1
            };
            let value = |a: &Atom| if let Atom::Output(o) = a { select(*o) } else { self.reading(*a) };
            let violated: Vec<_> =
                constraints.iter().filter(|(_, p)| p.literals().iter().all(|l| value(&l.atom) != l.negated)).collect();
            safe = violated.is_empty();
            for (c, p) in violated {
                let outputs: Vec<_> = outputs_of(p).collect();
                if outputs.len() == 1 {
                    continue; // It is forced both ways.
                }
                for (o, negated) in outputs.into_iter().filter(|(o, _)| c.yields.contains(o)) {
                    if fs[o.index()][usize::from(!negated)] {
                        wrong.insert((2 + u8::from(negated), o));
                    }
                    fc[o.index()][usize::from(negated)] = true;
                }
            }
        }
        wrong.extend(machine.outputs.ids().filter(|o| fc[o.index()] == [true; 2]).map(|o| (1, o)));
        (wrong, safe)
    }
}

fn number(kind: Kind) -> u8 {
    match kind {
        Kind::Forced => 0,
        Kind::Relieved => 1,
        Kind::Blocked { value } => 2 + u8::from(value),
    }
}

/// Some constraints and assumptions by chance; few of them are coherent.
fn safety(rng: &mut Rng) -> String {
    let reading = |rng: &mut Rng| {
        let not = if rng.chance(50) { "not " } else { "" };
        format!("{not}{}", rng.pick(&["A", "B", "A", "B", "prev(A)", "prev(B)", "prev(O1)", "prev(O2)", "prev(O3)"]))
    };
    let output = |rng: &mut Rng, o: usize| match rng.below(4) {
        0 => format!("not O{o}"),
        1 if rng.chance(50) => format!("fall(O{o})"),
        1 => format!("rise(O{o})"),
        _ => format!("O{o}"),
    };
    let mut lines = Vec::new();
    for i in 0..rng.between(2, 5) {
        let mut outputs = vec![1, 2, 3];
        rng.shuffle(&mut outputs);
        outputs.truncate(rng.between(1, 3));
        let yields = if outputs.len() == 1 { String::new() } else { format!(" yields O{}", outputs[0]) };
        let mut parts: Vec<String> = outputs.iter().map(|&o| output(rng, o)).collect();
        if let (true, [a, b]) = (rng.chance(15), parts.as_slice()) {
            parts = vec![format!("({a} xor {b})")];
        }
        for _ in 0..rng.below(3) {
            parts.push(reading(rng));
        }
        lines.push(format!("C{i}: never {}{yields}", parts.join(" and ")));
    }
    for i in 0..rng.below(3) {
        let (a, b) = (reading(rng), reading(rng));
        lines.push(format!("assume H{i}: never {a} and {b}"));
    }
    lines.join("\n")
}

#[test]
fn what_is_said_of_a_filter_is_so_and_nothing_is_left_out() {
    let (mut coherent, mut found) = (0, [0; 4]);
    for seed in 0..6_000 {
        let text = safety(&mut Rng::new(seed));
        let Some(machine) = machine(&text) else { continue };
        let cases: Vec<Case> = (0..Case::ALL).map(Case).filter(|c| c.allowed(&machine)).collect();
        let runs: Vec<_> = cases.iter().map(|c| c.run(&machine)).collect();
        let wrong: BTreeSet<_> = runs.iter().flat_map(|(wrong, _)| wrong.iter().copied()).collect();
        let said = properties::violations(&machine, &Reliefs::of(&machine.safety));
        assert_eq!(said.is_empty(), wrong.is_empty(), "{text}\n{said:?}\n{wrong:?}");
        if said.is_empty() {
            coherent += 1;
            assert!(runs.iter().all(|(_, safe)| *safe), "{text}");
        }
        for v in said {
            let key = (number(v.kind), v.output);
            found[usize::from(key.0)] += 1;
            let fits = |c: &Case| {
                v.witness.readings.iter().all(|&(a, value)| c.reading(a) == value)
                    && v.witness.commands.iter().all(|&(o, value)| c.command(o) == value)
            };
            let shown: Vec<_> = cases.iter().zip(&runs).filter(|(c, _)| fits(c)).map(|(_, (wrong, _))| wrong).collect();
            assert!(!shown.is_empty(), "{text}\nno case is {:?}", v.witness);
            assert!(shown.iter().all(|wrong| wrong.contains(&key)), "{text}\n{key:?} not always in {:?}", v.witness);
        }
    }
    assert!(coherent > 300 && found.iter().all(|&n| n > 100), "{coherent} {found:?}");
}

/// The errors and warnings about these constraints.
fn codes(safety: &str) -> Vec<(Severity, &'static str)> {
    pipeline::check(&source(safety)).1.iter().map(|d| (d.severity(), d.code.number())).collect()
}

#[test]
fn what_cannot_happen_is_no_contradiction() {
    let accepted = |safety: &str| {
        let said = codes(safety);
        assert!(said.iter().all(|(severity, _)| *severity == Severity::Warning), "{safety}\n{said:?}");
    };
    // No round leads from one of its products to the other.
    accepted("C1: never O1 xor O3 yields O3");
    assert!(codes("C1: never O1 xor O3 yields O3\nC2: never O1 and O2 yields O1").contains(&(Severity::Error, "E407")));
    // O3 is held only when O1 is off, and then C1 is not violated.
    accepted("C1: never O1 and O3 yields O3\nS1: never not O3 and A\nS2: never O1 and A");
    assert_eq!(
        codes("C1: never O1 and O3 yields O3\nS1: never not O3 and A\nS2: never O1 and B"),
        [(Severity::Error, "E408")]
    );
    assert_eq!(codes("S1: never O1 and A\nS2: never not O1 and B"), [(Severity::Error, "E406")]);
    accepted("S1: never O1 and A\nS2: never not O1 and B\nassume H: never A and B");
}
