//! The scans of a run to a table of changes and to CSV.

use super::frame::{Frame, Layout};
use super::run::milliseconds;
use super::scenario::Moment;
use crate::ir::chart::{Machine, ScanNumber, StateId};
use crate::ir::scenario::{Counted, Seen};
use std::collections::{BTreeMap, VecDeque};
use std::fmt::Write;

/// What the columns of a table hold.
const HEAD: [&str; 5] = ["scan", "time", "inputs", "outputs", "states"];

/// Lines at the beginning of a long run that are shown.
const FIRST: usize = 40;

/// Lines at the end of a long run that are shown.
const LAST: usize = 60;

/// What happened in a run, or in its last scans.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Frames with their scans, counted from 1, and what has happened since, if they are of a moment after the scan.
    moments: VecDeque<(u64, Option<String>, Frame)>,
    most: usize,
}

impl Recording {
    /// An empty recording that keeps the last `most` frames.
    pub fn last(most: usize) -> Recording {
        Recording { moments: VecDeque::new(), most }
    }

    /// An empty recording that keeps everything.
    pub fn all() -> Recording {
        Recording::last(usize::MAX)
    }

    /// Takes in a scan.
    pub fn push(&mut self, scan: u64, frame: &Frame) {
        self.take(Moment { scan, happens: None, frame });
    }

    /// Takes in a scan, or what happens after it.
    pub fn take(&mut self, moment: Moment<'_>) {
        let Moment { scan, happens, frame } = moment;
        if self.moments.len() == self.most {
            self.moments.pop_front();
        }
        self.moments.push_back((scan, happens.map(str::to_owned), frame.clone()));
    }

    /// The scans with their frames, in order.
    pub fn frames(&self) -> impl Iterator<Item = (u64, &Frame)> {
        self.moments.iter().filter(|(_, happens, _)| happens.is_none()).map(|(scan, _, frame)| (*scan, frame))
    }

    /// The same with the moments between them: the scan before, what has happened, the frame.
    pub fn moments(&self) -> impl Iterator<Item = (u64, Option<&str>, &Frame)> {
        self.moments.iter().map(|(scan, happens, frame)| (*scan, happens.as_deref(), frame))
    }

    /// A line for each thing that happened between scans, and the scans in which something changed, at most the last `most` of them: what became TRUE with `+`, what
    /// became FALSE with `-`, integers with their new values, elementary states that were entered and left, alarms with `!`, corrections that are none with `~`.
    pub fn table(&self, machine: &Machine, most: usize) -> String {
        let mut rows = self.rows(machine);
        rows.drain(..rows.len().saturating_sub(most));
        grid(HEAD, &rows)
    }

    /// The same of a run of any length: of many lines the first and the last ones, and between them which scans are left out.
    pub fn outline(&self, machine: &Machine) -> String {
        let mut rows = self.rows(machine);
        if rows.len() > FIRST + LAST + 1 {
            let end = rows.len() - LAST;
            let gap = &rows[FIRST..end];
            // There are at least two.
            let lines = gap.len();
            let mut scans = gap.iter().map(|row| &row[0]).filter(|scan| !scan.is_empty());
            let text = match (scans.next(), scans.next_back()) {
                (Some(from), Some(to)) => format!("{lines} lines are left out, of scans {from} to {to}"),
                (Some(scan), None) => format!("{lines} lines are left out, of scan {scan} and around it"),
                (None, _) => format!("{lines} lines between two scans are left out"),
            };
            rows.splice(FIRST..end, [[String::new(), "|".to_owned(), text, String::new(), String::new()]]);
        }
        grid(HEAD, &rows)
    }

    fn rows(&self, machine: &Machine) -> Vec<[String; 5]> {
        let names = Names::of(machine);
        let mut rows: Vec<[String; 5]> = Vec::new();
        let mut before: Option<&Frame> = None;
        for (scan, happens, frame) in self.moments() {
            // Of a run whose beginning is not there, the first frame only says what was before.
            if let (Some(happens), true) = (happens, before.is_some() || scan == 0) {
                let [hidden, ..] = names.changes(before, frame);
                let line = if hidden.is_empty() { happens.to_owned() } else { format!("{happens}: {hidden}") };
                rows.push([String::new(), "|".to_owned(), line, String::new(), String::new()]);
            } else if before.is_some() || scan == 1 {
                let cells = names.changes(before, frame);
                if scan == 1 || cells.iter().any(|c| !c.is_empty()) {
                    let [inputs, outputs, states] = cells;
                    rows.push([scan.to_string(), seconds(milliseconds(machine, scan)), inputs, outputs, states]);
                }
            }
            before = Some(frame);
        }
        rows
    }

    /// All values of all scans, as CSV: `scan`, then each input, hidden bit, output, variable, state as
    /// `in(…)`, alarm as `alarm(…)`, correction that is none as `acts(…)`, what the filter remembers,
    /// integer and hidden integer, and as `scan(first)` the scan in which began what the filter notes.
    pub fn csv(&self, machine: &Machine) -> String {
        let layout = Layout::of(machine);
        let mut out = String::from("scan");
        for name in columns(machine) {
            let _ = write!(out, ",{name}");
        }
        out.push('\n');
        for (scan, frame) in self.frames() {
            let _ = write!(out, "{scan}");
            for &value in &frame[..layout.integers().start] {
                out.push_str(if value { ",1" } else { ",0" });
            }
            for integer in counted(machine) {
                let _ = write!(out, ",{}", layout.counted(integer, frame));
            }
            if let Some(number) = layout.first_scan(frame) {
                let _ = write!(out, ",{number}");
            }
            out.push('\n');
        }
        out
    }
}

/// What the columns behind the first one are called in CSV, in order: those of single places, then numbers.
pub fn columns(machine: &Machine) -> Vec<String> {
    let mut names: Vec<String> = machine.inputs.values().map(|i| i.name.clone()).collect();
    names.extend(machine.plant.bits.values().map(|b| b.name.clone()));
    names.extend(machine.outputs.values().map(|o| o.name.clone()));
    names.extend(machine.variables.values().map(|v| v.name.clone()));
    names.extend(machine.events.values().map(|e| e.name.clone()));
    names.extend(machine.states.ids().map(|s| format!("in({})", machine.state_path(s))));
    names.extend(machine.safety.constraints.ids().map(|c| machine.seen(Seen::Acted(c))));
    names.extend(machine.safety.assumptions.iter().map(|a| format!("alarm({})", a.name)));
    names.extend(machine.safety.marks().map(|mark| machine.mark(mark)));
    names.extend(counted(machine).map(|i| machine.counted(i).to_owned()));
    names.extend(machine.safety.reset.map(|_| machine.scan_number(ScanNumber::First).to_owned()));
    names
}

/// All integers in the order of frames.
pub fn counted(machine: &Machine) -> impl Iterator<Item = Counted> + '_ {
    machine.integers.ids().map(Counted::Program).chain(machine.plant.counts.ids().map(Counted::Hidden))
}

/// What a column asks about: `S1` for `alarm(S1)`, the column itself if it is a name.
pub fn bare(column: &str) -> &str {
    column.split_once('(').map_or(column, |(_, inner)| inner.trim_end_matches(')'))
}

/// For each state, the shortest end of its path that no other path ends in; all of it where there is none.
pub fn short_names(machine: &Machine) -> Vec<String> {
    let paths: Vec<String> = machine.states.ids().map(|s| machine.state_path(s)).collect();
    let mut count: BTreeMap<&str, usize> = BTreeMap::new();
    for path in &paths {
        for end in ends(path) {
            *count.entry(end).or_default() += 1;
        }
    }
    paths.iter().map(|p| ends(p).find(|e| count[e] == 1).unwrap_or(p).to_owned()).collect()
}

/// The ends of a path in whole words, shortest first.
fn ends(path: &str) -> impl Iterator<Item = &str> {
    path.rmatch_indices('.').map(|(i, _)| &path[i + 1..]).chain(std::iter::once(path))
}

/// What is shown of a machine's values.
pub struct Names {
    layout: Layout,
    columns: Vec<String>,
    states: Vec<String>,
    elementary: Vec<StateId>,
    integers: Vec<(Counted, String, i64)>,
}

impl Names {
    /// The names for `machine`.
    pub fn of(machine: &Machine) -> Names {
        let elementary = machine.states.iter().filter(|(_, s)| s.regions.is_empty()).map(|(id, _)| id).collect();
        let (columns, states) = (columns(machine), short_names(machine));
        let initial = |i: Counted| match i {
            Counted::Program(i) => machine.integers[i].initial,
            Counted::Hidden(c) => machine.plant.counts[c].initial,
        };
        let integers = counted(machine).map(|i| (i, machine.counted(i).to_owned(), initial(i))).collect();
        Names { layout: Layout::of(machine), columns, states, elementary, integers }
    }

    /// What changed from one frame to the next: in inputs, in outputs and alarms, in states.
    pub fn changes(&self, before: Option<&Frame>, now: &Frame) -> [String; 3] {
        let was = |i: usize| before.is_some_and(|b| b[i]);
        let mut cells = [Vec::new(), Vec::new(), Vec::new()];
        let sign = |now: bool, name: &str| format!("{}{name}", if now { '+' } else { '-' });
        for (cell, places) in [(0, self.layout.given()), (1, self.layout.written())] {
            let changed = places.filter(|&i| was(i) != now[i]);
            cells[cell].extend(changed.map(|i| sign(now[i], &self.columns[i])));
        }
        for (id, name, initial) in &self.integers {
            let value = self.layout.counted(*id, now);
            if before.map_or(*initial, |b| self.layout.counted(*id, b)) != value {
                cells[usize::from(matches!(id, Counted::Program(_)))].push(format!("{name}={value}"));
            }
        }
        for i in self.layout.alarms().filter(|&i| now[i] && !was(i)) {
            let column = &self.columns[i];
            cells[1].push(format!("{}{}", if column.starts_with("alarm(") { '!' } else { '~' }, bare(column)));
        }
        let marks = self.layout.marks().filter(|&i| was(i) != now[i]);
        cells[1].extend(marks.map(|i| sign(now[i], &self.columns[i])));
        if let Some(number) = self.layout.first_scan(now)
            && before.map_or(0, |b| self.layout.first_scan(b).unwrap_or(0)) != number
        {
            cells[1].extend(self.columns.last().map(|column| format!("{column}={number}")));
        }
        for leaves in [true, false] {
            for &state in &self.elementary {
                let i = self.layout.state(state);
                if was(i) == leaves && now[i] != leaves {
                    cells[2].push(sign(now[i], &self.states[state.index()]));
                }
            }
        }
        cells.map(|c| c.join(" "))
    }
}

/// Milliseconds as seconds.
pub fn seconds(milliseconds: u64) -> String {
    format!("{}.{:03} s", milliseconds / 1000, milliseconds % 1000)
}

/// Columns of equal width; numbers to the right.
fn grid<const N: usize>(head: [&str; N], rows: &[[String; N]]) -> String {
    let mut widths = head.map(str::len);
    // What happened between scans is a line of its own, however long.
    for row in rows.iter().filter(|row| !row[0].is_empty()) {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = (*width).max(cell.chars().count());
        }
    }
    let mut out = String::new();
    let mut line = |cells: [&str; N]| {
        let mut text = String::new();
        for (i, (cell, width)) in cells.iter().zip(widths).enumerate() {
            let _ = if i < 2 { write!(text, "{cell:>width$}  ") } else { write!(text, "{cell:<width$}  ") };
        }
        out.push_str(text.trim_end());
        out.push('\n');
    };
    line(head);
    for row in rows {
        line(row.each_ref().map(String::as_str));
    }
    out
}
