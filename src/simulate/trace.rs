//! What goes into a run and what comes out, scan by scan, as tables that tests and people compare.
//!
//! Both are CSV. [`Inputs`] begin with `scan` and names; a value holds from its scan on, and an empty
//! cell leaves it as it is. A [`Trace`] begins with `scan`, `ms` and names, and has a row per scan.
//! BOOL is 0 or 1, TIME is in milliseconds.

use crate::base::figure;
use std::collections::BTreeMap;
use std::fmt;

/// What is set before which scan.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Names, as written.
    pub names: Vec<String>,
    /// For each scan in which something changes, the changed names' indices and new values.
    pub changes: BTreeMap<u64, Vec<(usize, i64)>>,
}

/// What was seen after each scan.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Trace {
    /// Names, as written.
    pub names: Vec<String>,
    /// The scans.
    pub rows: Vec<Row>,
}

/// What was seen after one scan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// Its number, from 1 on.
    pub scan: u64,
    /// Its time in milliseconds.
    pub time: i64,
    /// The value of each name.
    pub values: Vec<i64>,
}

/// The first place where two traces are not equal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The scan.
    pub scan: u64,
    /// The name.
    pub name: String,
    /// What the first trace says; `None` where it says nothing.
    pub left: Option<i64>,
    /// What the second one says.
    pub right: Option<i64>,
}

impl Inputs {
    /// Reads a table. An error says which line is wrong.
    pub fn parse(text: &str) -> Result<Inputs, String> {
        let (header, lines) = table(text)?;
        let [scan, names @ ..] = header.as_slice() else { return Err("the table is empty".to_owned()) };
        if *scan != "scan" {
            return Err("the first column is not `scan`".to_owned());
        }
        let mut inputs = Inputs { names: names.iter().map(|n| (*n).to_owned()).collect(), ..Inputs::default() };
        for (number, cells) in lines {
            let scan = value(cells[0], number)?;
            let scan = u64::try_from(scan).ok().filter(|scan| *scan > 0);
            let scan = scan.ok_or_else(|| format!("line {number}: there is no scan {}", cells[0]))?;
            let changes = inputs.changes.entry(scan).or_default();
            for (index, cell) in cells[1..].iter().enumerate().filter(|(_, c)| !c.is_empty()) {
                changes.push((index, value(cell, number)?));
            }
        }
        Ok(inputs)
    }

    /// What changes before a scan: indices of names, and values.
    pub fn before(&self, scan: u64) -> &[(usize, i64)] {
        self.changes.get(&scan).map_or(&[], Vec::as_slice)
    }

    /// The last scan before which something changes.
    pub fn last(&self) -> u64 {
        self.changes.keys().next_back().copied().unwrap_or(0)
    }
}

impl Trace {
    /// Reads a table. Without a column `ms` all times are 0. An error says which line is wrong.
    pub fn parse(text: &str) -> Result<Trace, String> {
        let (header, lines) = table(text)?;
        let (timed, names) = match header.as_slice() {
            ["scan", "ms", names @ ..] => (true, names),
            ["scan", names @ ..] => (false, names),
            _ => return Err("the first column is not `scan`".to_owned()),
        };
        let mut trace = Trace { names: names.iter().map(|n| (*n).to_owned()).collect(), rows: Vec::new() };
        for (number, cells) in lines {
            let scan = value(cells[0], number)?;
            let scan = u64::try_from(scan).map_err(|_| format!("line {number}: there is no scan {scan}"))?;
            let time = if timed { value(cells[1], number)? } else { 0 };
            let values = cells[1 + usize::from(timed)..].iter().map(|c| value(c, number)).collect::<Result<_, _>>()?;
            trace.rows.push(Row { scan, time, values });
        }
        Ok(trace)
    }

    /// The first difference from another trace in the names that both have, scan by scan, then in
    /// order of this trace's names. A scan that only one of them has is a difference.
    pub fn difference(&self, other: &Trace) -> Option<Difference> {
        let theirs: BTreeMap<&str, usize> = other.names.iter().enumerate().map(|(i, n)| (n.as_str(), i)).collect();
        let common: Vec<(usize, usize)> =
            self.names.iter().enumerate().filter_map(|(i, n)| Some((i, *theirs.get(n.as_str())?))).collect();
        for index in 0..self.rows.len().max(other.rows.len()) {
            let (left, right) = (self.rows.get(index), other.rows.get(index));
            let scan = left.or(right).map_or(0, |r| r.scan);
            let same_scan = left.map(|r| r.scan) == right.map(|r| r.scan);
            for &(ours, theirs) in &common {
                let left = left.map(|r| r.values[ours]);
                let right = right.filter(|_| same_scan || left.is_none()).map(|r| r.values[theirs]);
                if left != right {
                    return Some(Difference { scan, name: self.names[ours].clone(), left, right });
                }
            }
        }
        None
    }
}

impl fmt::Display for Trace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("scan,ms")?;
        for name in &self.names {
            write!(f, ",{name}")?;
        }
        f.write_str("\n")?;
        for row in &self.rows {
            write!(f, "{},{}", row.scan, row.time)?;
            for value in &row.values {
                write!(f, ",{value}")?;
            }
            f.write_str("\n")?;
        }
        Ok(())
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let show = |v: Option<i64>| v.map_or("nothing".to_owned(), |v| v.to_string());
        write!(f, "scan {}: {} is {} and {}", self.scan, self.name, show(self.left), show(self.right))
    }
}

type Lines<'t> = Vec<(usize, Vec<&'t str>)>;

/// The header and the numbered lines below it, all of one width.
fn table(text: &str) -> Result<(Vec<&str>, Lines<'_>), String> {
    let mut lines = text.lines().enumerate().map(|(i, l)| (i + 1, l.trim_end())).filter(|(_, l)| !l.is_empty());
    let Some((_, header)) = lines.next() else { return Err("the table is empty".to_owned()) };
    let header: Vec<&str> = header.split(',').map(str::trim).collect();
    let mut rest = Vec::new();
    for (number, line) in lines {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        if cells.len() != header.len() {
            return Err(format!("line {number} has {}, not {}", figure(cells.len(), "cell"), header.len()));
        }
        rest.push((number, cells));
    }
    Ok((header, rest))
}

fn value(cell: &str, line: usize) -> Result<i64, String> {
    cell.parse().map_err(|_| format!("line {line}: `{cell}` is no number"))
}
