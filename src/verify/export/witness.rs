//! The runs that model checkers find, in the form of AIGER 1.9: `1`, the bads, the latches before the
//! first scan, the inputs of each scan, `.`.

use super::super::system::{System, Trace};

/// A run that another tool found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Witness {
    /// Which of the claims that something never is it refutes, counted from 0.
    pub bad: usize,
    /// The run; nobody knows whether it is the shortest.
    pub trace: Trace,
}

/// Reads the first run in a text; `x` is read as FALSE. An error says which line is wrong. Whether the
/// system does such a run is for a replay to tell.
pub fn read(system: &System, text: &str) -> Result<Witness, String> {
    let lines = text.lines().enumerate().map(|(i, l)| (i + 1, l.trim()));
    // Tools talk before and after. A line may be empty: there are systems without inputs.
    let mut lines = lines.filter(|(_, l)| !l.starts_with('c')).skip_while(|&(_, l)| l != "1");
    if lines.next().is_none() {
        return Err("there is no line `1`, so no run".to_owned());
    }
    let (number, bads) = lines.next().ok_or("the text ends before a run")?;
    let bad = bads.split_whitespace().find_map(|b| b.strip_prefix('b')).and_then(|b| b.parse().ok());
    let bad = bad.ok_or(format!("line {number}: there is no bad, such as `b0`"))?;
    let bits = |(number, line): (usize, &str), count: usize, what: &str| -> Result<Vec<bool>, String> {
        if line.len() != count || line.chars().any(|c| !matches!(c, '0' | '1' | 'x')) {
            return Err(format!("line {number}: these are not the {count} {what} of the system"));
        }
        Ok(line.chars().map(|c| c == '1').collect())
    };
    let mut inputs = Vec::new();
    let mut initial = None;
    for (number, line) in lines {
        if line == "." {
            let initial = initial.ok_or(format!("line {number}: the run has no beginning"))?;
            return Ok(Witness { bad, trace: Trace { initial, inputs, shortest: false } });
        }
        if initial.is_none() {
            initial = Some(bits((number, line), system.latches.len(), "latches")?);
        } else {
            inputs.push(bits((number, line), system.inputs.len(), "inputs")?);
        }
    }
    Err("the run does not end with `.`".to_owned())
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
