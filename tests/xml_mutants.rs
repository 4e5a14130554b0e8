//! Program files with one thing changed as an editor, a merge or a hand may change it: what is proved of one is true.
//!
//! Each mutant is refused, or a run is shown that the simulators confirm, or it is proved and random runs say nothing
//! else. `CHARTWRIGHT_MUTANTS=N` makes the test look at that many in each dialect.

use crate::support::models;
use crate::support::proof::{agree_by_chance, build, confirm, read_back};
use crate::support::rng::Rng;
use crate::support::xml_damage::{ATTRIBUTES, Mutant, RULES, mutant};
use crate::support::xsd::{self, Schema};
use chartwright::ir::chart::Machine;
use chartwright::pipeline::Dialect;
use chartwright::prove::{Correspondence, Doubt, Verdict, equivalence};
use chartwright::read;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// The longest that an answer may take.
const LONGEST: Duration = Duration::from_secs(10);

#[derive(Debug, Default)]
struct Counts {
    made: usize,
    refused: usize,
    incomparable: usize,
    unchanged: usize,
    proved: usize,
    refuted: usize,
    weakened: usize,
    undecided: Vec<String>,
    longest: Duration,
    slowest: String,
}

/// A model as it is compared with the mutants of its program.
struct Original {
    name: String,
    machine: Machine,
    names: Correspondence,
    xml: String,
    read: String,
}

fn judge(original: &Original, Mutant { xml, what, means, .. }: &Mutant, seed: u64, counts: &mut Counts) {
    let Original { name, machine, names, read: same, .. } = original;
    let what = format!("{name}: {what}");
    counts.made += 1;
    let start = Instant::now();
    let project = read::read(xml).0;
    let Some(project) = project else {
        counts.refused += 1;
        return;
    };
    let unchanged = format!("{project:?}") == *same;
    let verdict = (!unchanged).then(|| equivalence(machine, names, &project));
    let took = start.elapsed();
    if took > counts.longest {
        (counts.longest, counts.slowest) = (took, what.clone());
    }
    match verdict {
        None => {
            counts.unchanged += 1;
            assert!(!means, "{what} is passed over");
        }
        Some(Verdict::Proved(_)) => {
            counts.proved += 1;
            println!("proved: {what}");
            agree_by_chance(machine, names, &project, &what, seed);
            if let Some(folder) = std::env::var_os("CHARTWRIGHT_MUTANTS_KEPT") {
                let file = std::path::Path::new(&folder).join(format!("{name}-{seed}.xml"));
                std::fs::write(file, xml).expect("the folder takes files");
            }
        }
        Some(Verdict::Refuted(trace)) => {
            counts.refuted += 1;
            confirm(machine, names, &project, &trace, &what);
        }
        Some(Verdict::Unknown(doubt)) => match *doubt {
            Doubt::Incomparable(_) => counts.incomparable += 1,
            Doubt::Unsafe(_) => {
                counts.weakened += 1;
                agree_by_chance(machine, names, &project, &what, seed);
            }
            Doubt::NotInductive { .. } | Doubt::GaveUp { .. } => counts.undecided.push(format!("{what}: {doubt}")),
        },
    }
}

/// Every element of the schema, as small as it can be.
fn elements() -> Vec<String> {
    let Some(text) = xsd::text() else { return Vec::new() };
    let schema = Schema::parse(&text);
    let smallest = |element| schema.smallest(element).replace("localId=\"1\"", "localId=\"9990\"");
    let all: BTreeSet<String> = (0..schema.elements.len()).map(smallest).collect();
    all.into_iter().collect()
}

fn examine(dialect: Dialect) {
    let wanted: usize = std::env::var("CHARTWRIGHT_MUTANTS").ok().and_then(|n| n.parse().ok()).unwrap_or(150);
    let originals: Vec<Original> = models::all()
        .into_iter()
        .map(|model| {
            let output = build(&model.source, dialect).expect("the models are right");
            let names = Correspondence::of(&output.machine, &output.project);
            let read = format!("{:?}", read_back(&output));
            Original { name: model.name, machine: output.machine, names, xml: output.xml, read }
        })
        .collect();
    let more = elements();
    let (mut rules, mut set) = (BTreeSet::new(), BTreeSet::new());
    let mut rng = Rng::new(23);
    let mut counts = Counts::default();
    while counts.made < wanted {
        // Large ones are seldom: they cost the most and say the same.
        let original = rng.pick(&originals);
        if original.xml.len() > 600_000 && rng.below(4) > 0 {
            continue;
        }
        let Some(mutant) = mutant(&original.xml, &more, &mut rng) else { continue };
        rules.insert(mutant.rule);
        set.extend(mutant.set);
        judge(original, &mutant, counts.made as u64, &mut counts);
    }
    println!("{dialect:?}: {counts:#?}");
    let idle: Vec<&str> = (0..RULES.len()).filter(|r| !rules.contains(r)).map(|r| RULES[r]).collect();
    assert!(idle.is_empty(), "never: {idle:?}");
    // So many that chance comes upon each.
    if counts.made >= 5000 {
        let all: BTreeSet<&str> = ATTRIBUTES.iter().map(|(name, _)| *name).collect();
        assert_eq!(all.difference(&set).collect::<Vec<_>>(), Vec::<&&str>::new());
    }
    assert!(counts.longest < LONGEST, "{:?}: {}", counts.longest, counts.slowest);
    assert!(counts.undecided.len() * 100 <= counts.made, "{}", counts.undecided.join("\n"));
    assert!(counts.refuted * 100 > counts.made && counts.refused * 5 > counts.made, "the mutants say something");
}

#[test]
fn mutants_of_files_for_beremiz_are_refused_or_told_truly() {
    examine(Dialect::Beremiz);
}

#[test]
fn mutants_of_files_for_codesys_are_refused_or_told_truly() {
    examine(Dialect::Codesys);
}

#[test]
fn the_rules_know_every_attribute_of_the_schema() {
    let Some(text) = xsd::text() else { return };
    let schema = Schema::parse(&text);
    let known: BTreeSet<&str> = ATTRIBUTES.iter().map(|(name, _)| *name).collect();
    let all: BTreeSet<&str> = schema.elements.iter().flat_map(|e| &e.attributes).map(|a| a.name.as_str()).collect();
    assert_eq!(all.difference(&known).collect::<Vec<_>>(), Vec::<&&str>::new());
}
