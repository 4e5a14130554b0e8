//! A run of chart and program side by side, as a table.

use super::joint::{Joint, Run, Stimulus};
use super::matching::{Match, Pair};
use super::parts::{Part, SCAN_WIDTH, WIDTH, said};
use super::program_step::Latch;
use crate::bits::aig::Lit;
use crate::bits::vector;
use crate::ir::chart::ScanNumber;
use crate::ir::iec::Time;
use std::fmt;

/// A run from power-up to the scan in which chart and program differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Trace {
    /// The cycle time in microseconds.
    pub cycle: Time,
    /// The names of the inputs.
    pub inputs: Vec<String>,
    /// What is compared.
    pub compared: Vec<Compared>,
    /// The scans, first to last.
    pub scans: Vec<Scan>,
}

/// Something that is compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Compared {
    /// Which part of the machine.
    pub part: Part,
    /// The same in words: `output OVC`.
    pub what: String,
    /// What stands for it in the program: a variable, or flag X of a step.
    pub name: String,
}

/// One scan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scan {
    /// When it takes place and with which inputs.
    pub stimulus: Stimulus,
    /// For each thing compared, its value in the chart at the end of the scan.
    pub chart: Vec<bool>,
    /// For each thing compared, its value in the program at the end of the scan.
    pub program: Vec<bool>,
}

impl Trace {
    /// Runs both sides.
    pub fn of(pair: Pair<'_>, matched: &Match, joint: &Joint, stimuli: &[Stimulus]) -> Trace {
        let compared = matched.parts.iter().map(|&(part, latch)| {
            // The bits of an integer are shown as the number that they are.
            let what = match part {
                Part::Bit(i, _) => format!("integer {}", pair.machine.integers[i].name),
                Part::Scan(number, _) => said(number).to_owned(),
                part => part.describe(pair.machine),
            };
            let latch = match pair.program.latches()[latch] {
                Latch::Bit(variable, _) => Latch::Variable(variable),
                latch => latch,
            };
            Compared { part, what, name: pair.program.name(latch) }
        });
        let mut trace = Trace {
            cycle: joint.cycle,
            inputs: pair.machine.inputs.values().map(|i| i.name.clone()).collect(),
            compared: compared.collect(),
            scans: Vec::new(),
        };
        let mut run = Run::new(joint);
        for stimulus in stimuli {
            let words: Vec<u64> = stimulus.inputs.iter().map(|&b| u64::from(b)).collect();
            run.scan(&words, stimulus.pause);
            let read = |lits: &[Lit]| lits.iter().map(|&l| run.word(l) & 1 == 1).collect();
            let (chart, program) = (read(&run.half().chart), read(&run.half().program));
            trace.scans.push(Scan { stimulus: stimulus.clone(), chart, program });
        }
        trace
    }

    /// What differs after the last scan, as indices into [`Trace::compared`].
    pub fn differences(&self) -> Vec<usize> {
        let Some(last) = self.scans.last() else { return Vec::new() };
        let visible = |i: &usize| !matches!(self.compared[*i].part, Part::Begins(_));
        (0..self.compared.len()).filter(visible).filter(|&i| last.chart[i] != last.program[i]).collect()
    }
}

impl Trace {
    /// What differs after the last scan, at most so many things, each with what the program has instead of what the
    /// chart says: `output RUN (on instead of off)`.
    pub fn said(&self, most: usize) -> Vec<String> {
        let Some(last) = self.scans.last() else { return Vec::new() };
        let mut said: Vec<String> = Vec::new();
        for i in self.differences() {
            let Compared { part, what, .. } = &self.compared[i];
            let (chart, program) = match part {
                // Of a number mostly several bits differ.
                Part::Bit(_, bit) | Part::Scan(_, bit) => {
                    let place = i - usize::from(*bit);
                    (value(*part, place, &last.chart).to_string(), value(*part, place, &last.program).to_string())
                }
                _ => (word(last.chart[i]).to_owned(), word(last.program[i]).to_owned()),
            };
            let one = format!("{what} ({program} instead of {chart})");
            if !said.contains(&one) {
                said.push(one);
            }
        }
        said.truncate(most);
        said
    }
}

fn word(value: bool) -> &'static str {
    if value { "on" } else { "off" }
}

/// The number whose lowest bit is the thing compared at `place`.
fn value(part: Part, place: usize, values: &[bool]) -> i64 {
    match part {
        // Without a sign.
        Part::Scan(..) => vector::value(values[place..place + usize::from(SCAN_WIDTH)].iter().copied().chain([false])),
        _ => vector::value(values[place..place + usize::from(WIDTH)].iter().copied()),
    }
}

/// The row of the number whose lowest bit is the thing compared at `place`, if it is to be shown.
fn number(place: usize, compared: &Compared, scan: &Scan, before: Option<&Scan>) -> Option<[String; 4]> {
    let of = |values: &[bool]| value(compared.part, place, values);
    let (chart, program) = (of(&scan.chart), of(&scan.program));
    let was = before.map_or((0, 0), |b| (of(&b.chart), of(&b.program)));
    let found = match chart == program {
        // Which scan this is stands on the left.
        true if (chart, program) == was || matches!(compared.part, Part::Scan(ScanNumber::This, _)) => return None,
        true => program.to_string(),
        false => format!("{program}  <- {}", compared.name),
    };
    Some([String::new(), compared.what.clone(), chart.to_string(), found])
}

impl fmt::Display for Trace {
    /// A table of what changes from scan to scan. Before the first one everything counts as off.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows: Vec<[String; 4]> = vec![["scan", "", "chart", "program"].map(String::from)];
        let mut before: Option<&Scan> = None;
        for (n, scan) in self.scans.iter().enumerate() {
            let from = rows.len();
            if n > 0 && scan.stimulus.pause != self.cycle {
                let late = format!("{} ms after the last scan", scan.stimulus.pause / 1000);
                rows.push([String::new(), late, String::new(), String::new()]);
            }
            for (i, name) in self.inputs.iter().enumerate() {
                let now = scan.stimulus.inputs[i];
                if now != before.is_some_and(|b| b.stimulus.inputs[i]) {
                    rows.push([String::new(), format!("input {name}"), word(now).into(), String::new()]);
                }
            }
            for (i, compared) in self.compared.iter().enumerate() {
                if let Part::Bit(_, bit) | Part::Scan(_, bit) = compared.part {
                    if bit == 0 {
                        rows.extend(number(i, compared, scan, before));
                    }
                    continue;
                }
                let (chart, program) = (scan.chart[i], scan.program[i]);
                let changes = |value: bool, was: Option<bool>| value != was.unwrap_or(false);
                let shown = match compared.part {
                    // The same as flag, input or event as long as nothing is wrong.
                    Part::Step(_)
                    | Part::Input(_)
                    | Part::Raised(_)
                    | Part::Begins(_)
                    | Part::Bit(..)
                    | Part::Scan(..) => false,
                    Part::Flag(_)
                    | Part::Event(_)
                    | Part::Output(_)
                    | Part::Variable(_)
                    | Part::Command(_)
                    | Part::Acted(_)
                    | Part::Broken(_)
                    | Part::Mark(..) => {
                        changes(chart, before.map(|b| b.chart[i])) || changes(program, before.map(|b| b.program[i]))
                    }
                };
                if chart != program && !matches!(compared.part, Part::Begins(_)) {
                    let program = format!("{}  <- {}", word(program), compared.name);
                    rows.push([String::new(), compared.what.clone(), word(chart).into(), program]);
                } else if shown {
                    rows.push([String::new(), compared.what.clone(), word(chart).into(), word(program).into()]);
                }
            }
            if rows.len() == from {
                rows.push([String::new(), "nothing changes".into(), String::new(), String::new()]);
            }
            rows[from][0] = (n + 1).to_string();
            before = Some(scan);
        }
        let width = |column: usize| rows.iter().map(|r| r[column].chars().count()).max().unwrap_or(0);
        let (scan, what, chart) = (width(0), width(1), width(2));
        for [a, b, c, d] in &rows {
            let line = format!("{a:>scan$}  {b:<what$}  {c:<chart$}  {d}");
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}
