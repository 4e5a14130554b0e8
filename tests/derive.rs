//! Constraints that follow from actuators and forbidden positions: those of the prehensor against the paper's
//! table, and any by trying all that a plant can do.

use crate::support::binary::{Scratch, chartwright, code, stderr, stdout};
use crate::support::models::{repository, timed};
use crate::support::rng::Rng;
use chartwright::base::Code;
use chartwright::ir::chart::{Atom, Machine, OutputId, Technology};
use chartwright::pipeline;
use std::collections::HashSet;

fn machine(source: &str) -> Machine {
    let (machine, diagnostics) = pipeline::check(source);
    machine.unwrap_or_else(|| panic!("{source}\n{diagnostics:?}"))
}

fn prehensor() -> String {
    std::fs::read_to_string(repository("models/prehensor.chart")).expect("the model is there")
}

/// What the products of a machine's constraints forbid, in order.
fn never(source: &str) -> Vec<String> {
    let (analysis, diagnostics) = pipeline::constraints(source);
    let analysis = analysis.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let products = analysis.constraints.into_iter().flat_map(|c| c.products);
    let mut all: Vec<String> = products.map(|p| format!("{} | {}", p.never, p.forces.join(", "))).collect();
    all.sort();
    all
}

#[test]
fn the_prehensor_has_the_constraints_of_the_table() {
    let k = [
        "Go_down and rise(Down) | Go_down := 0",
        "Go_in and not Up | Go_in := 0",
        "Go_in and rise(In) | Go_in := 0",
        "Go_out and not Up | Go_out := 0",
        "Go_out and rise(Out) | Go_out := 0",
        "Go_up and rise(Up) | Go_up := 0",
        "rise(Go_down) and Down | Go_down := 0",
        "rise(Go_down) and Go_in | Go_down := 0",
        "rise(Go_down) and Go_out | Go_down := 0",
        "rise(Go_down) and Go_up | Go_down := 0",
        "rise(Go_down) and not In and not Out | Go_down := 0",
        "rise(Go_down) and prev(Go_in) | Go_down := 0",
        "rise(Go_down) and prev(Go_out) | Go_down := 0",
        "rise(Go_in) and Go_down | Go_in := 0",
        "rise(Go_in) and Go_out | Go_in := 0",
        "rise(Go_in) and In | Go_in := 0",
        "rise(Go_in) and prev(Go_down) | Go_in := 0",
        "rise(Go_out) and Go_down | Go_out := 0",
        "rise(Go_out) and Go_in | Go_out := 0",
        "rise(Go_out) and Out | Go_out := 0",
        "rise(Go_out) and prev(Go_down) | Go_out := 0",
        "rise(Go_up) and Go_down | Go_up := 0",
        "rise(Go_up) and Up | Go_up := 0",
    ];
    let h = [
        "fall(Go_down) and not Down | Go_down := 1",
        "fall(Go_in) and not In and Up | Go_in := 1",
        "fall(Go_out) and not Out and Up | Go_out := 1",
    ];
    let by_edges = prehensor().replace("derive all", "derive all by edges");
    assert_eq!(never(&by_edges.replace("valve memory", "valve closed-centre")), k);
    let mut both: Vec<&str> = h.into_iter().chain(k).collect();
    both.sort_unstable();
    assert_eq!(never(&by_edges), both);
    // An end in one constraint: four instead of eight.
    assert_eq!(never(&prehensor()).len(), 22);
    let kept = never(&prehensor().replace("derive all", "derive all except End_Go_up, F1_Go_in_with_Go_down"));
    assert_eq!(kept.len(), 20);
    assert!(!kept.iter().any(|p| p.starts_with("Go_up and Up")));
    // From the forbidden positions alone: what holds orders is among it.
    assert_eq!(never(&prehensor().replace("derive all", "derive F1")).len(), 14);
    assert_eq!(never(&prehensor().replace("derive all", "derive F1  derive Hold_Go_in, Vertical")).len(), 18);
}

/// The prehensor under random commands.
#[test]
fn the_prehensor_never_comes_where_it_must_not() {
    let d = Scratch::new("prehensor");
    for valve in ["memory", "closed-centre"] {
        d.write("p.chart", timed("prehensor").replace("valve memory", &format!("valve {valve}")));
        for (seed, program) in [(1, "chart"), (2, "plc"), (3, "chart"), (4, "plc")] {
            let arguments = format!("simulate p.chart --seed {seed} --scans 20000 --program {program} --output csv");
            let output = chartwright(d.path(), &arguments);
            assert_eq!(code(&output), 0, "{}", stderr(&output));
            let mut lines = stdout(&output).lines();
            let head: Vec<&str> = lines.next().expect("a head").split(',').collect();
            let column =
                |name: &str| head.iter().position(|h| *h == name).unwrap_or_else(|| panic!("{name}: {head:?}"));
            let [up, down, inside, out] = ["Up", "Down", "In", "Out"].map(column);
            let mut seen = HashSet::new();
            for line in lines {
                let cells: Vec<&str> = line.split(',').collect();
                let at = |c: usize| cells[c] == "1";
                let place = |first: bool, second: bool| if first { 0 } else { 1 + usize::from(second) };
                seen.insert(3 * place(at(up), at(down)) + place(at(inside), at(out)));
            }
            let mut seen: Vec<usize> = seen.into_iter().collect();
            seen.sort_unstable();
            assert_eq!(seen, [0, 1, 2, 3, 5, 6, 8], "{valve}, seed {seed}, {program}");
        }
    }
}

/// A machine of two actuators whose positions are forbidden together, each at random.
fn pair(rng: &mut Rng) -> String {
    let actuator = |rng: &mut Rng, name: &str| match rng.below(3) {
        0 => format!(
            "actuator {name} monostable {{ position P sensor {name}P  position Q output {name}Out sensor {name}Q }}"
        ),
        n => format!(
            "actuator {name} bistable valve {} {{ position P output {name}Back sensor {name}P  position Q output {name}Out sensor {name}Q }}",
            ["memory", "closed-centre"][n - 1]
        ),
    };
    let (a, b) = (actuator(rng, "A"), actuator(rng, "B"));
    let outputs = |name: &str, text: &str| {
        let back = if text.contains("Back") { format!(" {name}Back") } else { String::new() };
        format!("{name}Out{back}")
    };
    let outputs = format!("{} {}", outputs("A", &a), outputs("B", &b));
    let drives: String = outputs.split_whitespace().map(|o| format!("drives {o} when W{o} ")).collect();
    let wants: String = outputs.split_whitespace().map(|o| format!(" W{o}")).collect();
    let place = |rng: &mut Rng| ["at P", "between", "at Q"][rng.below(3)];
    let forbids: Vec<String> = (0..rng.between(1, 3))
        .map(|i| {
            let word = if rng.chance(40) { "unless" } else { "and" };
            let (first, second) = if rng.chance(50) { ("A", "B") } else { ("B", "A") };
            format!("F{i}: forbid {first} {} {word} {second} {}", place(rng), place(rng))
        })
        .collect();
    let edges = if rng.chance(50) { " by edges" } else { "" };
    format!(
        "machine Pair\ninputs {{ AP AQ BP BQ{wants} }}\noutputs {{ {outputs} }}\n{a}\n{b}\n\
         chart C {{ initial state S {{ {drives} }} }}\nsafety controller {{\n{}\nderive all{edges}\n}}",
        forbids.join("\n")
    )
    .replace("drives ABack when WABack", "drives ABack when WABack and not WAOut")
    .replace("drives BBack when WBBack", "drives BBack when WBBack and not WBOut")
}

/// Where each actuator is (0, 1 between, 2), which order its valve remembers, what was written, what was read
/// in the scan before, and what is about to be written.
type Plant = ([usize; 2], [usize; 2], u32, u32, Option<u32>);

/// Tries all that orders can do to a plant: those that no constraint forbids, in any scan, with any movement
/// between reading and writing. Says whether a forbidden place is reached, or a scan has no way out.
fn explore(machine: &Machine, forbidden: &[[bool; 3]; 3], start: [usize; 2]) -> (usize, bool, bool) {
    let actuators: Vec<_> = machine.actuators.values().collect();
    let on = |written: u32, output: Option<OutputId>| output.is_some_and(|o| written >> o.index() & 1 == 1);
    let order = |i: usize, written: u32, remembered: usize| -> usize {
        let a = actuators[i];
        let (back, out) = (on(written, a.positions[0].output), on(written, a.positions[1].output));
        match (a.technology, back, out) {
            (Technology::Monostable, ..) => {
                if out {
                    2
                } else {
                    0
                }
            }
            (_, true, false) => 0,
            (_, false, true) => 2,
            _ => remembered,
        }
    };
    // A closed-centre valve remembers to stand: 1.
    let memory = |i: usize, text: usize| if machine.description.as_bytes()[i] == b'm' { text } else { 1 };
    let sensors = |at: [usize; 2]| {
        (0..2).fold(0, |s, i| s | u32::from(at[i] == 0) << (2 * i) | u32::from(at[i] == 2) << (2 * i + 1))
    };
    let products: Vec<_> = machine.safety.constraints.values().flat_map(|c| &c.products).collect();
    let allowed = |new: u32, old: u32, now: u32, before: u32| {
        let value = |a: Atom| match a {
            Atom::Input(i) => now >> i.index() & 1 == 1,
            Atom::PrevInput(i) => before >> i.index() & 1 == 1,
            Atom::Output(o) => new >> o.index() & 1 == 1,
            Atom::PrevOutput(o) => old >> o.index() & 1 == 1,
            other => panic!("{other:?}"),
        };
        !products.iter().any(|p| p.literals().iter().all(|l| value(l.atom) != l.negated))
    };
    let first: Plant = (start, [0, 1].map(|i| memory(i, start[i])), 0, sensors(start), None);
    let (mut seen, mut open) = (HashSet::from([first]), vec![first]);
    let mut stuck = false;
    while let Some((at, remembered, written, before, pending)) = open.pop() {
        let mut next: Vec<Plant> = Vec::new();
        for i in 0..2 {
            let mut moved = at;
            match order(i, written, remembered[i]) {
                0 if at[i] > 0 => moved[i] -= 1,
                2 if at[i] < 2 => moved[i] += 1,
                _ => continue,
            }
            next.push((moved, remembered, written, before, pending));
        }
        match pending {
            Some(new) => {
                let remembered = [0, 1].map(|i| memory(i, order(i, new, remembered[i])));
                next.push((at, remembered, new, before, None));
            }
            None => {
                let now = sensors(at);
                let ways = (0..1 << machine.outputs.len()).filter(|&new| allowed(new, written, now, before));
                let ways: Vec<u32> = ways.collect();
                stuck |= ways.is_empty();
                next.extend(ways.into_iter().map(|new| (at, remembered, written, now, Some(new))));
            }
        }
        for plant in next {
            if forbidden[plant.0[0]][plant.0[1]] {
                return (seen.len(), true, stuck);
            } else if seen.insert(plant) {
                open.push(plant);
            }
        }
    }
    (seen.len(), false, stuck)
}

/// What the lines of a model forbid of A and B.
fn forbidden(source: &str) -> [[bool; 3]; 3] {
    let mut all = [[false; 3]; 3];
    for line in source.lines().filter(|l| l.contains(": forbid ")) {
        let words: Vec<&str> = line.split(' ').collect();
        let unless = words.contains(&"unless");
        let zone = |name: &str| {
            let i = words.iter().position(|w| *w == name).expect("it is there");
            if words[i + 1] == "between" { 1 } else { 2 * usize::from(words[i + 2] == "Q") }
        };
        let (a, b) = (zone("A"), zone("B"));
        let a_first = words[2] == "A";
        for (x, row) in all.iter_mut().enumerate() {
            for (y, cell) in row.iter_mut().enumerate() {
                let (first, second) = if a_first { (x == a, y == b) } else { (y == b, x == a) };
                *cell |= first && second != unless;
            }
        }
    }
    all
}

#[test]
fn what_is_forbidden_is_never_reached() {
    let (mut explored, mut dangerous) = (0, 0);
    for seed in 0..120 {
        let source = pair(&mut Rng::new(seed));
        let forbidden = forbidden(&source);
        let (machine, diagnostics) = pipeline::check(&source);
        let Some(mut machine) = machine else {
            // Sensors and rules never contradict each other.
            panic!("{source}\n{diagnostics:?}");
        };
        let valve =
            |name: &str| if source.contains(&format!("actuator {name} bistable valve memory")) { 'm' } else { 'c' };
        machine.description = format!("{}{}", valve("A"), valve("B"));
        // At rest: monostable actuators at their first positions.
        for start in [[0, 0], [0, 2], [2, 0], [2, 2]] {
            let springs =
                machine.actuators.values().zip(start).any(|(a, at)| a.technology == Technology::Monostable && at != 0);
            if springs || forbidden[start[0]][start[1]] {
                continue;
            }
            let (states, reached, stuck) = explore(&machine, &forbidden, start);
            assert!(!reached, "{source}\nfrom {start:?}");
            assert!(!stuck, "{source}\nfrom {start:?}: no way out");
            explored += states;
            let mut bare = machine.clone();
            bare.safety.constraints = Default::default();
            dangerous += usize::from(explore(&bare, &forbidden, start).1);
        }
    }
    assert!(explored > 20_000 && dangerous > 60, "{explored} {dangerous}");
}

#[test]
fn derived_constraints_are_printed_as_a_model_writes_them() {
    let models = repository("models");
    let output = chartwright(&models, "constraints --derive prehensor.chart");
    assert_eq!(code(&output), 0);
    let lines: Vec<&str> = stdout(&output).lines().filter(|l| !l.starts_with("//")).collect();
    assert_eq!(lines.len(), 22);
    // Written instead of derived, they mean the same.
    let written =
        prehensor().replace("derive all", &format!("derive all except F1, Vertical, Horizontal\n{}", lines.join("\n")));
    assert_eq!(never(&written), never(&prehensor()));
    let json = chartwright(&models, "constraints --derive --format json prehensor.chart");
    assert!(stdout(&json).contains("\"Hold_Go_in\""));
    let none = chartwright(&models, "constraints --derive --format dot prehensor.chart");
    assert_eq!(code(&none), 2);
}

#[test]
fn a_constraint_is_derived_or_written_but_not_both() {
    let twice = prehensor().replace("derive all", "derive all\nEnd_Go_up: never Go_up and Up");
    assert!(pipeline::check(&twice).1.iter().any(|d| d.code == Code::DuplicateName));
    machine(&twice.replace("derive all", "derive all except End_Go_up"));
}
