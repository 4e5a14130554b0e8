//! The runs that model checkers find, in the form of AIGER (`1`, the bad, output or justice, the latches before the
//! first scan, the inputs of each scan, `.`), whichever version of it they were given, of ABC (`write_cex -a`: rows alone, `# DONE`), or of BTOR2 (`sat`, the same, frames of states `#0` and inputs `@0`, `.`).
//!
//! Files are written by others and may be cut off or damaged: all is checked, and an error says which line is wrong.

use super::super::aig::{Lit, lanes};
use super::super::system::{Property, System, Trace};
use super::{Told, plain};
use crate::base::figure;
use std::fmt::Display;

/// A run that another tool found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Witness {
    /// Which of the claims of the system it refutes, by index.
    pub claim: usize,
    /// The run; nobody knows whether it is the shortest.
    pub trace: Trace,
}

/// Reads the first run in a text, in whichever form it is; what is left open is read as FALSE. Whether the system does
/// such a run is for a replay to tell. With `named` it is about that claim, whatever the text says: tools that are given one
/// claim alone count from it.
pub fn read(system: &System, text: &str, named: Option<usize>) -> Result<Witness, String> {
    let lines = text.lines().enumerate().map(|(i, l)| (i + 1, l.trim()));
    let row = |l: &str| l.len() > 1 && l.bytes().all(|b| matches!(b, b'0' | b'1' | b'x'));
    if lines.clone().next().is_some_and(|(_, l)| row(l)) {
        return abc(system, named, &mut lines.into_iter());
    }
    // Tools talk before and after.
    let mut lines = lines.filter(|(_, l)| !l.starts_with(['c', ';'])).skip_while(|&(_, l)| !is_head(l));
    let told = Told::new(system);
    match lines.next() {
        Some((_, "1")) => aiger(system, &told.system, named, &mut lines),
        Some((_, "sat")) => btor2(system, &told.system, named, &mut lines),
        Some((number, line)) => Err(format!("line {number}: `{line}` says that there is no run")),
        None => Err("there is no line `1` or `sat`, so no run".to_owned()),
    }
}

fn is_head(line: &str) -> bool {
    matches!(line, "0" | "1" | "2" | "sat" | "unsat" | "unknown")
}

type Line<'t> = (usize, &'t str);

const ENDS: &str = "the run does not end with `.`";

fn wrong(number: usize, what: impl Display) -> String {
    format!("line {number}: {what}")
}

/// The claim that a line such as `b0` or `j1` names.
fn claim(system: &System, named: Option<usize>, line: Option<Line<'_>>) -> Result<usize, String> {
    let (number, line) = line.ok_or("the text ends before a run")?;
    let words = line.split_whitespace().find_map(|word| {
        let kind = word.chars().next().filter(|c| matches!(c, 'b' | 'o' | 'j'))?;
        word[1..].parse::<usize>().ok().map(|index| (kind, index))
    });
    let (kind, index) =
        words.ok_or_else(|| wrong(number, "there is neither a bad such as `b0` nor a justice such as `j0`"))?;
    if let Some(claim) = named {
        return Ok(claim);
    }
    let of_kind = |property: Property| match property {
        Property::Never(_) => kind != 'j',
        Property::Eventually { .. } => kind == 'j',
        Property::AlwaysPossible(_) | Property::NeverStuck => false,
    };
    let mut claims = (0..system.claims.len()).filter(|&i| of_kind(system.claims[i].property));
    claims.nth(index).ok_or_else(|| wrong(number, format_args!("the model has no claim `{kind}{index}`")))
}

/// The run without what was added for the other tool.
fn bare(system: &System, mut initial: Vec<bool>, mut inputs: Vec<Vec<bool>>) -> Trace {
    initial.truncate(system.latches.len());
    inputs.iter_mut().for_each(|scan| scan.truncate(system.inputs.len()));
    Trace { initial, inputs, shortest: false }
}

fn aiger<'t>(
    system: &System,
    told: &System,
    named: Option<usize>,
    lines: &mut dyn Iterator<Item = Line<'t>>,
) -> Result<Witness, String> {
    let claim = claim(system, named, lines.next())?;
    let bits = |(number, line): Line<'_>, count: usize, what: &str| -> Result<Vec<bool>, String> {
        if line.len() != count || line.chars().any(|c| !matches!(c, '0' | '1' | 'x')) {
            return Err(wrong(number, format_args!("these are not the {count} {what} of the system")));
        }
        Ok(line.chars().map(|c| c == '1').collect())
    };
    let first = lines.next().ok_or(ENDS)?;
    // What is added for the first version of AIGER is as many latches as for the other only where neither adds anything.
    let plain = (first.1.len() != told.latches.len()).then(|| plain::of(system));
    let plain = plain.filter(|plain| first.1.len() == plain.system.latches.len());
    let exported = plain.as_ref().map_or(told, |plain| &plain.system);
    let initial = bits(first, exported.latches.len(), "latches")?;
    let mut inputs = Vec::new();
    for line in lines {
        if line.1 == "." {
            let trace = match plain {
                Some(plain) => plain.run(initial, inputs),
                None => bare(system, initial, inputs),
            };
            return Ok(Witness { claim, trace });
        }
        inputs.push(bits(line, exported.inputs.len(), "inputs")?);
    }
    Err(ENDS.to_owned())
}

/// Rows of the first version of AIGER: memory, which begins as it does, then the inputs of each scan. ABC does not say
/// which output they are about, and leaves out memory that does not matter.
fn abc<'t>(
    system: &System,
    named: Option<usize>,
    lines: &mut dyn Iterator<Item = Line<'t>>,
) -> Result<Witness, String> {
    let claim = named.ok_or("it does not say what it is about: give `--property NAME`")?;
    let plain = plain::of(system);
    let initial = plain.system.latches.iter().map(|l| l.initial.unwrap_or(false)).collect();
    let mut inputs = Vec::new();
    for (number, line) in lines.skip(1) {
        let row = line.split('#').next().unwrap_or_default().trim();
        if row.len() != plain.system.inputs.len() || row.chars().any(|c| !matches!(c, '0' | '1' | 'x')) {
            let count = figure(plain.system.inputs.len(), "value");
            return Err(wrong(number, format_args!("each scan has {count}, one for each input of the system")));
        }
        inputs.push(row.chars().map(|c| c == '1').collect());
        if line.ends_with("# DONE") {
            return Ok(Witness { claim, trace: plain.run(initial, inputs) });
        }
    }
    Err("the run does not end with `# DONE`".to_owned())
}

fn btor2<'t>(
    system: &System,
    told: &System,
    named: Option<usize>,
    lines: &mut dyn Iterator<Item = Line<'t>>,
) -> Result<Witness, String> {
    let claim = claim(system, named, lines.next())?;
    let mut initial: Vec<bool> = told.latches.iter().map(|l| l.initial.unwrap_or(false)).collect();
    let mut inputs: Vec<Vec<bool>> = Vec::new();
    // Whether states are being told, and of which scan.
    let mut frame: Option<(bool, usize)> = None;
    for (number, line) in lines {
        if line == "." {
            return Ok(Witness { claim, trace: bare(system, initial, inputs) });
        }
        if let Some(scan) = line.strip_prefix(['#', '@']) {
            let scan: usize = scan.parse().map_err(|_| wrong(number, "a frame has a number, such as `@0`"))?;
            let states = line.starts_with('#');
            if !states {
                if scan != inputs.len() {
                    return Err(wrong(number, format_args!("the inputs of scan {} are missing", inputs.len())));
                }
                inputs.push(vec![false; told.inputs.len()]);
            }
            frame = Some((states, scan));
            continue;
        }
        let Some((states, scan)) = frame else {
            return Err(wrong(number, "a value stands before the first frame, such as `#0` or `@0`"));
        };
        let mut words = line.split_whitespace();
        let index = words.next().and_then(|w| w.parse::<usize>().ok());
        let value = match words.next() {
            Some("1") => Some(true),
            Some("0" | "x") => Some(false),
            _ => None,
        };
        let (Some(index), Some(value)) = (index, value) else {
            return Err(wrong(number, "a value is the number of an input or state, and `0` or `1`"));
        };
        let place = match states {
            // What states are later follows.
            true if scan > 0 => continue,
            true => initial.get_mut(index),
            false => inputs.last_mut().and_then(|scan| scan.get_mut(index)),
        };
        let what = if states { "state" } else { "input" };
        *place.ok_or_else(|| wrong(number, format_args!("the system has no {what} {index}")))? = value;
    }
    Err(ENDS.to_owned())
}

/// Writes a run for tools that check it.
pub fn write(bad: usize, trace: &Trace) -> String {
    let bits = |values: &[bool]| -> String { values.iter().map(|&v| if v { '1' } else { '0' }).collect() };
    let mut text = format!("1\nb{bad}\n{}\n", bits(&trace.initial));
    for scan in &trace.inputs {
        text += &bits(scan);
        text.push('\n');
    }
    text + ".\n"
}

/// The run up to where it shows the violation of the claim, or why it shows none.
pub fn judge(system: &System, witness: &Witness) -> Result<Trace, String> {
    let Witness { claim, trace } = witness;
    let property = system.claims[*claim].property;
    for (i, latch) in system.latches.iter().enumerate() {
        if latch.initial.is_some_and(|value| trace.initial.get(i) != Some(&value)) {
            return Err(format!("no run begins with this value of `{}`", system.name(latch.leaf)));
        }
    }
    let up_to = |scans: usize| Trace { inputs: trace.inputs[..scans].to_vec(), ..trace.clone() };
    let scans = trace.inputs.len();
    let bad = property.never().unwrap_or(Lit::FALSE);
    let (mut scan, mut shown) = (0, None);
    let replayed = system.replay(trace, &mut |values| {
        scan += 1;
        shown = shown.or((lanes(values, bad) & 1 == 1).then_some(scan));
    });
    if let Err(broken) = replayed {
        return Err(format!("scan {broken} breaks an assumption or what the plant can do"));
    }
    match property {
        Property::Never(_) => {
            if let Some(scan) = shown {
                return Ok(up_to(scan));
            }
        }
        Property::Eventually { .. } if system.shows(trace, property) => return Ok(trace.clone()),
        Property::Eventually { .. } | Property::AlwaysPossible(_) | Property::NeverStuck => {}
    }
    Err(match property {
        Property::Eventually { .. } => "the run does not come to a fair loop without an answer".to_owned(),
        _ => format!("the run has {}, and the claim is violated in none", figure(scans, "scan")),
    })
}
