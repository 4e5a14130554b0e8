//! What is said of constraints, against all cases tried one by one.

#[path = "../benches/many_constraints.rs"]
mod many_constraints;

use crate::support::rng::Rng;
use chartwright::base::Severity;
use chartwright::constraints::Analysis;
use chartwright::constraints::analysis::Nature;
use chartwright::constraints::graphs::Matrix;
use chartwright::constraints::properties::{self, Kind};
use chartwright::constraints::redundancy::redundant;
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

    /// What goes wrong in the corrected algorithm, and whether its outputs are safe.
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

/// A machine with these outputs, inputs and variables, and these constraints.
fn machine_of(outputs: &[&str], inputs: &[&str], variables: &[&str], safety: &str) -> String {
    let actuators: String = outputs.iter().map(|o| format!("actuator Act{o} onoff by {o}\n")).collect();
    let drives: String = outputs.iter().map(|o| format!("drives {o} when {} ", inputs[0])).collect();
    let variables: String = variables.iter().map(|v| format!("{v} : BOOL ")).collect();
    format!(
        "machine M\ninputs {{ {} }}\noutputs {{ {} }}\nvariables {{ {variables} }}\n{actuators}\
         chart C {{ initial state S {{ {drives} }} }}\nsafety supervisor {{\n{safety}\n}}",
        inputs.join(" "),
        outputs.join(" ")
    )
}

fn analyse(source: &str) -> Analysis {
    let (analysis, diagnostics) = pipeline::constraints(source);
    analysis.unwrap_or_else(|| panic!("{:?}", diagnostics.iter().next()))
}

/// The entries of a matrix, counted from 1 as papers do.
fn ones(matrix: &Matrix) -> Vec<(usize, usize)> {
    matrix.iter().map(|&(i, j)| (i + 1, j + 1)).collect()
}

fn edges(matrix: &Matrix) -> Vec<(usize, usize)> {
    ones(matrix).into_iter().filter(|(i, j)| i < j).collect()
}

fn broken(analysis: &Analysis) -> Vec<u32> {
    analysis.properties.iter().filter(|p| !p.holds).map(|p| p.number).collect()
}

/// A worked example of five outputs.
fn worked(yields: &str) -> Analysis {
    let outputs = ["o1", "o2", "o3", "o4", "o5"];
    let inputs = ["i1", "i2", "i3", "i4", "i5"];
    let safety = format!(
        "CSc1: never i1 and o1 and o2 yields o1\nCSc2: never i2 and not o1 and o2 yields o2\n\
         CSc3: never i3 and o4 and not o5 yields o5\nCSc4: never i4 and not o3 and o4 yields o3\n\
         CSc5: never i5 and o2 and o3 and o5 yields {yields}"
    );
    analyse(&machine_of(&outputs, &inputs, &[], &safety))
}

#[test]
fn the_worked_example_has_the_matrices_of_the_paper() {
    let one = worked("o2");
    assert_eq!(one.combined, ["CSc1", "CSc2", "CSc3", "CSc4", "CSc5"]);
    assert_eq!(ones(&one.matrices.mx0), [(1, 2), (3, 4), (5, 3)]);
    assert_eq!(ones(&one.matrices.mx1), [(1, 1), (2, 1), (2, 2), (2, 5), (3, 5), (4, 3), (4, 4), (5, 5)]);
    assert_eq!(ones(&one.matrices.mc0), [(1, 1), (2, 2), (2, 5)]);
    assert_eq!(ones(&one.matrices.mc1), [(3, 4), (5, 3)]);
    assert_eq!(edges(&one.matrices.mx), [(1, 2), (3, 5), (4, 5)]);
    assert_eq!(ones(&one.matrices.mc), [(1, 2), (3, 5), (4, 5)]);
    assert!(broken(&one).is_empty());

    let two = worked("o2, o3");
    assert_eq!(ones(&two.matrices.mc), [(1, 2), (3, 5), (4, 5), (5, 4)]);
    // o3 yields to CSc4 by going on and to CSc5 by going off.
    assert_eq!(broken(&two), [1, 2]);
    assert_eq!(two.properties[2].witnesses, ["the reliefs of CSc4, CSc5 set each other off"]);
    let witness = &two.properties[1].witnesses[0];
    assert!(witness.starts_with("o3 yields to CSc5 by going off and to CSc4 by going on: "), "{witness}");
}

/// The four cylinders of the paper on logical constraints.
fn cylinders() -> Analysis {
    let mut safety = String::new();
    for k in 1..=4 {
        let (next, last) = (k % 4 + 1, (k + 2) % 4 + 1);
        let lines = [
            format!("CSs{}: never rise(o{k}) and not b{k}", 6 * k - 5),
            format!("CSs{}: never rise(o{k}) and i{k} and i{next}", 6 * k - 4),
            format!("CSs{}: never rise(o{k}) and not b{next}", 6 * k - 3),
            format!("CSs{}: never rise(o{k}) and T{last}", 6 * k - 2),
            format!("CSs{}: never rise(o{k}) and i{k} and prev(o{next})", 6 * k - 1),
            format!("CSs{}: never fall(o{k}) and not h{k}", 6 * k),
            format!("CSc{k}: never rise(o{k}) and rise(o{next}) and i{k} yields o{next}\n"),
        ];
        safety += &lines.join("\n");
    }
    let inputs = ["b1", "b2", "b3", "b4", "h1", "h2", "h3", "h4", "i1", "i2", "i3", "i4"];
    analyse(&machine_of(&["o1", "o2", "o3", "o4"], &inputs, &["T1", "T2", "T3", "T4"], &safety))
}

#[test]
fn the_four_cylinders_are_coherent() {
    let a = cylinders();
    assert_eq!((a.constraints.len(), a.combined.len()), (28, 4));
    assert!(a.matrices.mx.is_empty() && a.matrices.mc.is_empty() && a.matrices.mc1.is_empty());
    assert_eq!(ones(&a.matrices.mc0), [(1, 4), (2, 1), (3, 2), (4, 3)]);
    assert_eq!((broken(&a), a.redundant.len(), a.untouched.len()), (vec![], 0, 0));
    let first = &a.outputs[0];
    let fs0 = ["not prev(o1) and not b1", "not prev(o1) and i1 and i2", "not prev(o1) and not b2"];
    assert_eq!(first.fs0[..3], fs0);
    assert_eq!((first.fs0.len(), first.fs1.as_slice()), (5, ["prev(o1) and not h1".to_owned()].as_slice()));
    let natures: Vec<Nature> = a.constraints[..7].iter().map(|c| c.products[0].nature).collect();
    use Nature::{Combinatory, Sequential};
    assert_eq!(natures[..4], [Combinatory, Combinatory, Combinatory, Sequential]);
    assert_eq!(a.constraints[6].products[0].never, "rise(o1) and rise(o2) and i1");
}

/// The palletizer of the paper on ITS PLC.
fn palletizer(lift: &str, rollers: [&str; 2]) -> Analysis {
    let [second, third] = rollers;
    let safety = format!(
        "CSs1: never fall(O0) and not C5\nCSs2: never fall(O0) and prev(O1)\n\
         CSs3: never rise(O1) and not C3\nCSs4: never rise(O1) and not prev(O0)\nCSs5: never rise(O1) and P12\n\
         CSs6: never rise(O1) and P2\nCSs7: never rise(O1) and not C6\nCSs8: never fall(O1) and C0\n\
         CSs9: never O2 and not C9\nCSs10: never rise(O2) and prev(O6)\n\
         CSs11: never rise(O5) and not P2\nCSs12: never rise(O5) and not Pp\nCSs13: never rise(O5) and not C10\n\
         CSs14: never rise(O5) and cpt3\nCSs15: never rise(O5) and prev(O6)\nCSs16: never rise(O5) and prev(O7)\n\
         CSs17: never fall(O5) and C4\nCSs18: never O6 and not C6\nCSs19: never O6 and C7\nCSs20: never O6 and C8\n\
         CSs21: never rise(O6) and prev(O2)\nCSs22: never O7 and not C6\nCSs23: never O7 and C9\n\
         CSc1: never O6 and O7 yields O6\nCSc2: never O2 and O6 yields {lift}\nCSc3: never O5 and O6 yields O6\n\
         CSc4: never O2 and not O3 yields {second}\nCSc5: never not O2 and O3 yields {third}\n\
         CSc6: never O5 and O7 yields O7\nCSc7: never rise(O1) and not O0 yields O1"
    );
    let inputs = ["C0", "C3", "C4", "C5", "C6", "C7", "C8", "C9", "C10"];
    let outputs = ["O0", "O1", "O2", "O3", "O4", "O5", "O6", "O7"];
    analyse(&machine_of(&outputs, &inputs, &["P12", "P2", "Pp", "cpt3"], &safety))
}

#[test]
fn the_palletizer_is_coherent_with_a_cycle() {
    let a = palletizer("O6", ["O2", "O3"]);
    assert_eq!((a.constraints.len(), a.combined.len()), (30, 7));
    assert!(a.matrices.mc.contains(&(3, 4)) && a.matrices.mc.contains(&(4, 3)));
    assert_eq!(broken(&a), [2], "{a}");
    assert_eq!(a.properties[2].witnesses, ["the reliefs of CSc4, CSc5 set each other off"]);
    assert_eq!(a.untouched, ["O4"]);
    // Where O2 follows O3, it would have to go on although the lift is not at ground. It yields both ways, but
    // never in one scan.
    assert_eq!(broken(&palletizer("O6", ["O2", "O2"])), [2, 4]);
    // Where O3 follows O2 and O2 yields to the lift, O3 goes on and then has to go off.
    let a = palletizer("O2", ["O3", "O3"]);
    assert_eq!(broken(&a), [1, 2]);
    let witness = &a.properties[1].witnesses[0];
    assert!(witness.ends_with("with O2 and not O3 and O6 commanded"), "{witness}");
}

#[test]
fn what_others_imply_is_redundant() {
    let of = |safety: &str| -> Vec<(String, Vec<String>)> {
        analyse(&source(safety)).redundant.into_iter().map(|r| (r.name, r.implied_by)).collect()
    };
    let implied = |name: &str, by: &[&str]| (name.to_owned(), by.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>());
    let safety =
        "S1: never O1 and A\nS2: never O1 and A and B\nS3: never O2 and B\nC4: never O1 and O2 and (A or B) yields O1";
    assert_eq!(of(safety), [implied("S2", &["S1"]), implied("C4", &["S1", "S3"])]);
    assert_eq!(of("S1: never O1 and A and B\nassume H: never A and B"), [implied("S1", &[])]);
    assert!(of("S1: never O1 and A\nS2: never O1 and B").is_empty());
}

/// Every redundant constraint, and no other, can be dropped without allowing anything more.
#[test]
fn redundancy_is_exact() {
    let mut dropped = 0;
    for seed in 0..400 {
        let Some(machine) = machine(&safety(&mut Rng::new(seed))) else { continue };
        let said: BTreeSet<_> = redundant(&machine).into_iter().map(|r| r.constraint).collect();
        let violated: Vec<Vec<bool>> = (0..Case::ALL)
            .map(Case)
            .filter(|c| c.allowed(&machine))
            .map(|c| {
                let value = |a: &Atom| if let Atom::Output(o) = a { c.command(*o) } else { c.reading(*a) };
                machine.safety.constraints.values().map(|k| k.never.eval(&mut |a| value(a))).collect()
            })
            .collect();
        for id in machine.safety.constraints.ids() {
            let alone = |v: &Vec<bool>| v[id.index()] && v.iter().filter(|v| **v).count() == 1;
            assert_eq!(said.contains(&id), !violated.iter().any(alone), "seed {seed}: {id:?}");
        }
        dropped += said.len();
    }
    assert!(dropped > 50, "{dropped}");
}

/// How long it takes, `cargo bench --bench constraints` says.
#[test]
fn a_large_set_is_analysed() {
    let analysis = analyse(&many_constraints::many(500, 2_000));
    assert_eq!(analysis.constraints.len(), 2_000);
    assert!(analysis.combined.len() > 500 && !analysis.redundant.is_empty());
    assert!(broken(&analysis).is_empty());
}
