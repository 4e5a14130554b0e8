//! Whether one scan of a program is one scan of a chart, for all inputs and from everything that can
//! be reached.
//!
//! # What is proved
//!
//! After every scan, whatever the inputs have been since power-up: the flag and the step of each state
//! are what the chart says of it, and so are each output, each variable, each integer, each command, the flag of each
//! constraint and of each assumption, and what the filter remembers, numbers of scans included. In short, every [`Part`](super::parts::Part) that the program has something for.
//!
//! # How
//!
//! By induction over scans, under these invariants, each of which is proved along with the rest and
//! none assumed:
//!
//! - each integer is within its range;
//! - in each region exactly one state is active, or none if its parent is not;
//! - the idle step of each SFC is active exactly while the region's parent is not;
//! - what a region with a history remembers is its active state, or one or no state while it has none;
//! - a timer starts in exactly those scans that are the first to begin in its state, and while that state
//!   is active it remembers since when, and whether its time has passed, as the chart does;
//! - what else the program remembers and reads again holds what [`induction::guess`] has found for it:
//!   an input of the last scan, that the first scan is over, and the like;
//! - the filter is at rest after the number of rounds that the chart's side is given
//!   ([`chart_filter::rounds`]), and the products of a constraint say the same as its expression.
//!
//! Then, of the program alone and for all commands ([`guard`]): what its filter lets through violates no
//! constraint as long as no assumption is broken, and it is what was commanded where that violates none.
//!
//! And no number leaves its type ([`sums`]), since tools differ in what becomes of it.
//!
//! When a time has passed is left open, the same on both sides: so the proof holds for every course of
//! time, that of a late scan included.
//!
//! That is enough for what the compiler writes. A program that was changed by hand may need more: then
//! the induction looks some scans back, and learns [`lemmas`](super::lemmas) about what a chart cannot
//! reach. If it still fails, [`search`](mod@search) looks for a run that shows why.

use super::chart_filter;
use super::chart_step::ChartStep;
use super::correspondence::Correspondence;
use super::guard;
use super::induction::{self, Claim, Count, Failure, Shown, Situation};
use super::joint::Joint;
use super::lemmas::Lemmas;
use super::matching::{Match, Pair};
use super::parts::{SCAN_WIDTH, WIDTH};
use super::program_step::ProgramStep;
use super::search::{self, search};
use super::sums;
use super::trace::Trace;
use crate::bits::sat::{self, Sat};
use crate::bits::vector;
use crate::ir::chart::Machine;
use crate::ir::iec::Project;
use std::collections::BTreeSet;
use std::fmt;

/// How many scans back the induction looks before it gives up.
const HISTORY: usize = 2;

/// What came of the proof.
#[derive(Clone, Debug)]
pub enum Verdict {
    /// The program does what the chart says.
    Proved(Statistics),
    /// It does not, and this run shows it.
    Refuted(Box<Trace>),
    /// It is neither proved nor refuted.
    Unknown(Box<Doubt>),
}

/// How a proof was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// States of the chart.
    pub states: usize,
    /// What the program remembers from scan to scan.
    pub latches: usize,
    /// Latches whose meaning is known by construction or was found.
    pub meanings: usize,
    /// How many scans back the induction had to look: 0 unless the program is written unusually.
    pub history: usize,
    /// How many lemmas about what cannot be reached it needed: likewise.
    pub lemmas: usize,
    /// Rounds after which the filter was proved to be at rest.
    pub rounds: usize,
    /// Claims about what the filter lets through, whatever is commanded.
    pub guarded: usize,
    /// Claims about the first scan.
    pub base: Count,
    /// Claims about later scans.
    pub step: Count,
    /// What the solver was asked.
    pub effort: sat::Effort,
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// Program and machine cannot be compared; says why.
    Incomparable(String),
    /// From a situation that may or may not be reachable, the two differ. No run that leads to it or to
    /// another difference was found.
    NotInductive {
        /// What differs, and from where, in words.
        text: String,
        /// How many claims failed.
        failed: usize,
    },
    /// Program and chart agree, and yet the filter lets through what a constraint forbids, or corrects what
    /// none forbids; says which and when.
    Unsafe(String),
    /// The solver gave up on some claims, and nothing else speaks against them.
    GaveUp {
        /// The first of them, in words.
        text: String,
        /// How many.
        failed: usize,
    },
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Doubt::Incomparable(why) | Doubt::Unsafe(why) => f.write_str(why),
            Doubt::NotInductive { text, .. } | Doubt::GaveUp { text, .. } => f.write_str(text),
        }
    }
}

/// Decides whether `program` does what `machine` says; `names` says where to look.
pub fn equivalence(machine: &Machine, names: &Correspondence, program: &Project) -> Verdict {
    equivalence_within(machine, names, program, search::Effort::USUAL)
}

/// The same, with so much effort for finding a run if the proof fails.
pub fn equivalence_within(
    machine: &Machine,
    names: &Correspondence,
    program: &Project,
    effort: search::Effort,
) -> Verdict {
    match attempt(machine, names, program, effort) {
        Ok(verdict) => verdict,
        Err(why) => Verdict::Unknown(Box::new(Doubt::Incomparable(why))),
    }
}

fn attempt(
    machine: &Machine,
    names: &Correspondence,
    project: &Project,
    effort: search::Effort,
) -> Result<Verdict, String> {
    let mut sat = Sat::new();
    chart_filter::products_say_what_is_written(machine, &mut sat)?;
    let rounds = chart_filter::rounds(machine, &mut sat).ok_or("the rounds of the filter could not be counted")?;
    let chart = ChartStep::new(machine, rounds);
    let program = ProgramStep::new(project)?;
    let pair = Pair { machine, chart: &chart, program: &program };
    let mut matched = Match::of(pair, names, project)?;
    let mut hopeless = BTreeSet::new();
    let mut joint = None;
    let mut lemmas = Lemmas::new(pair);

    let mut history = 0;
    let mut failures = loop {
        while induction::guess(pair, &mut matched, &hopeless, false) > 0 {}
        let (base, mut failures) = induction::base(pair, &matched, history + 1, &mut sat);
        if failures.is_empty() {
            let (step, later) = induction::step(pair, &matched, history, &lemmas, &mut sat);
            failures = later;
            if failures.is_empty() && matched.missing.is_empty() {
                let shown = Shown { pair, matched: &matched, history, lemmas: &lemmas };
                let guarded = match guard::examine(shown, &mut sat) {
                    Ok(guarded) => guarded,
                    // The filter may read what these charts make no difference by.
                    Err(_) if induction::guess(pair, &mut matched, &hopeless, true) > 0 => continue,
                    Err(why) => return Ok(Verdict::Unknown(Box::new(Doubt::Unsafe(why)))),
                };
                sums::examine(shown, &mut sat)?;
                let meanings = matched.meanings.iter().flatten().count();
                let (states, latches) = (machine.states.len(), program.latches().len());
                let effort = sat.effort();
                return Ok(Verdict::Proved(Statistics {
                    states,
                    latches,
                    meanings,
                    rounds,
                    guarded,
                    history,
                    lemmas: lemmas.never().len(),
                    base,
                    step,
                    effort,
                }));
            }
        }
        // Before more is asked of the proof: is it wrong? Most errors show soon.
        if joint.is_none() {
            let both = Joint::new(pair, &matched);
            if let Some(stimuli) = search(&both, &mut sat, search::Effort::FIRST) {
                return Ok(Verdict::Refuted(Box::new(Trace::of(pair, &matched, &both, &stimuli))));
            }
            joint = Some(both);
        }
        if !matched.missing.is_empty() {
            break failures;
        }
        // A wrong guess says nothing about the program.
        let wrong: Vec<usize> = failures.iter().filter_map(|f| f.claim.guess(&matched)).collect();
        if !wrong.is_empty() {
            for latch in wrong {
                matched.meanings[latch] = None;
                matched.guessed[latch] = false;
                hopeless.insert(latch);
            }
        } else if history < HISTORY {
            history += 1;
        } else {
            let from = failures.iter().find_map(|f| f.from.as_ref());
            if !from.is_some_and(|from| lemmas.exclude(&from.memory)) {
                break failures;
            }
        }
    };
    if let Some(both) = &joint
        && let Some(stimuli) = search(both, &mut sat, effort)
    {
        return Ok(Verdict::Refuted(Box::new(Trace::of(pair, &matched, both, &stimuli))));
    }
    if let Some(missing) = matched.missing.into_iter().next() {
        return Err(missing);
    }
    // Those that the solver gave up on say less.
    failures.sort_by_key(|f| f.from.is_none());
    Ok(Verdict::Unknown(Box::new(doubt(machine, &program, &failures))))
}

fn doubt(machine: &Machine, program: &ProgramStep<'_>, failures: &[Failure]) -> Doubt {
    let says = |claim: Claim| match claim {
        Claim::Configuration(region) => {
            format!("that region {} has one active state", machine.region_path(region))
        }
        Claim::History(region) => {
            format!("that region {} remembers one state", machine.region_path(region))
        }
        Claim::Range(integer) => format!("that {} stays within its range", machine.integers[integer].name),
        Claim::Clock(_) => "that no time has passed in a state just entered".to_owned(),
        Claim::Part(part, latch) => {
            format!("that {} in the program is {}", program.name(program.latches()[latch]), part.describe(machine))
        }
        Claim::Memory(meaning, latch) => {
            format!("that {} in the program is {}", program.name(program.latches()[latch]), meaning.describe(machine))
        }
    };
    let first = &failures[0];
    match &first.from {
        Some(from) => Doubt::NotInductive {
            text: format!(
                "it is not so {} after a scan that begins with {}, and nobody knows whether a run comes to that",
                says(first.claim),
                describe(machine, from)
            ),
            failed: failures.len(),
        },
        None => Doubt::GaveUp {
            text: format!("the solver gave up before it showed {}", says(first.claim)),
            failed: failures.len(),
        },
    }
}

/// A situation in words: innermost active states, then what else is TRUE.
fn describe(machine: &Machine, s: &Situation) -> String {
    let innermost = machine.states.iter().filter(|(id, state)| s.memory[id.index()] && state.regions.is_empty());
    let mut parts: Vec<String> = innermost.map(|(id, _)| format!("in({})", machine.state_path(id))).collect();
    let variables = machine.variables.values().map(|v| v.name.clone());
    let inputs = machine.inputs.values().map(|i| format!("prev({})", i.name));
    let outputs = machine.outputs.values().map(|o| format!("prev({})", o.name));
    let events = machine.events.values().map(|e| format!("raised({})", e.name));
    let names = variables.chain(inputs).chain(outputs).chain(events);
    let remembered = s.memory.iter().skip(machine.states.len()).zip(names);
    parts.extend(remembered.filter(|(v, _)| **v).map(|(_, name)| name));
    let scans = machine.safety.scan_numbers().count() * usize::from(SCAN_WIDTH);
    let bits = &s.memory[s.memory.len() - scans - machine.integers.len() * usize::from(WIDTH)..];
    let integers = machine.integers.values().zip(bits.chunks(usize::from(WIDTH)));
    parts.extend(integers.map(|(i, bits)| format!("{} = {}", i.name, vector::value(bits.iter().copied()))));
    let now = s.inputs.iter().zip(machine.inputs.values());
    parts.extend(now.filter(|(v, _)| **v).map(|(_, input)| input.name.clone()));
    parts.join(", ")
}
