//! A model to a run: by a scenario, by a table of inputs, by chance or by hand.

use super::args::{Simulate as Args, Trace};
use super::files::{self, Pending};
use super::report::{FileReport, Report};
use super::{Outcome, read, say, session, tell, usage};
use crate::base::limits;
use crate::ir::chart::{InputId, Machine};
use crate::ir::scenario::Given;
use crate::pipeline;
use crate::simulate::record::{Recording, seconds};
use crate::simulate::run::{Program, Run, milliseconds};
use crate::simulate::trace::Inputs;
use crate::simulate::{chance, scenario, vcd};
use std::path::Path;

/// How many scans run where nothing says so.
const SCANS: u64 = 1000;

/// Runs `chartwright simulate`.
pub fn run(args: &Args) -> Outcome {
    let others = [Some(&args.file), args.inputs.as_ref()];
    if let Some(out) = &args.out
        && !files::is_standard(out)
        && others.into_iter().flatten().any(|f| files::same(f, out))
    {
        return usage("simulate", "writing the run would overwrite what is read");
    }
    let mut report = Report::default();
    let machine = read(&args.file, &mut report, pipeline::check).flatten();
    let (Some(machine), Some(file)) = (machine, report.files.first()) else {
        say(&report.human());
        return Outcome::Wrong;
    };
    let mut programs = pipeline::programs(&machine);
    let at = programs.iter().position(|(name, _)| *name == args.program.name()).expect("the program is one of ours");
    let program = programs.swap_remove(at).1;
    let (recording, outcome) = if let Some(name) = &args.scenario {
        let Some(index) = machine.scenarios.iter().position(|s| s.name == *name) else {
            let names: String = machine
                .scenarios
                .iter()
                .map(|s| format!("  {}\n", annotate_snippets::normalize_untrusted_str(&s.name)))
                .collect();
            let name = annotate_snippets::normalize_untrusted_str(name);
            say(&format!("error: there is no scenario `{name}`; there are\n{names}"));
            return Outcome::Wrong;
        };
        by_scenario(&machine, program, index, args.scans)
    } else if let Some(path) = &args.inputs {
        let inputs = files::read(path).map_err(|d| d.message).and_then(|text| {
            let inputs = Inputs::parse(&text).map_err(|e| format!("{}: {e}", files::show(path)))?;
            known(&machine, &inputs).map_err(|e| format!("{}: {e}", files::show(path)))
        });
        match inputs {
            Ok((inputs, columns)) => (by_table(&machine, program, &inputs, &columns, args.scans), Outcome::Fine),
            Err(error) => {
                say(&format!("error: {error}\n"));
                return Outcome::Wrong;
            }
        }
    } else if let Some(seed) = args.seed {
        (by_chance(&machine, program, seed, args.scans.unwrap_or(SCANS)), Outcome::Fine)
    } else if let Some(scans) = args.scans {
        (by_table(&machine, program, &Inputs::default(), &[], Some(scans)), Outcome::Fine)
    } else {
        return session::run(&file.source, &machine, program);
    };
    match write(args, &machine, &recording) {
        Ok(written) => outcome.and(written),
        Err(failed) => {
            report.files.push(failed);
            say(&report.human());
            Outcome::Wrong
        }
    }
}

fn write(args: &Args, machine: &Machine, recording: &Recording) -> Result<Outcome, FileReport> {
    let text = match args.output {
        Trace::Table => recording.table(machine, usize::MAX),
        Trace::Csv => recording.csv(machine),
        Trace::Vcd => vcd::write(machine, recording),
    };
    let path = args.out.as_deref().unwrap_or(Path::new("-"));
    if files::is_standard(path) {
        return Ok(tell(&text));
    }
    let written = Pending::prepare(path, text).and_then(Pending::commit);
    written.map(|()| Outcome::Fine).map_err(|d| FileReport::failed(files::show(path), d))
}

fn by_scenario(machine: &Machine, program: Program, index: usize, scans: Option<u64>) -> (Recording, Outcome) {
    let mut recording = Recording::all();
    let wanted = scans.unwrap_or(u64::MAX);
    let verdict = scenario::watch(machine, program, index, &mut |moment| {
        if moment.scan <= wanted {
            recording.take(moment);
        }
    });
    let outcome = match verdict.failure {
        Some(failure) if failure.scan <= wanted => {
            let when = seconds(milliseconds(machine, failure.scan));
            let word = if failure.between { "after" } else { "in" };
            say(&format!("the scenario fails {word} scan {}, {when}; `chartwright test` says more\n", failure.scan));
            Outcome::Wrong
        }
        _ => Outcome::Fine,
    };
    (recording, outcome)
}

/// The inputs that the columns of a table mean. Columns of anything else that a run shows are left out, so that a
/// run can be played again.
fn known(machine: &Machine, inputs: &Inputs) -> Result<(Inputs, Vec<Option<InputId>>), String> {
    if inputs.last() > u64::from(limits::SCENARIO_SCANS) {
        return Err(format!("a run has at most {} scans", limits::SCENARIO_SCANS));
    }
    let shown = crate::simulate::record::columns(machine);
    let mut columns = Vec::new();
    for name in &inputs.names {
        let found = machine.inputs.iter().find(|(_, i)| i.name.eq_ignore_ascii_case(name)).map(|(id, _)| id);
        if found.is_none() && !shown.contains(name) {
            let name = annotate_snippets::normalize_untrusted_str(name);
            return Err(format!("the machine has no input `{name}`"));
        }
        if found.is_some() && columns.contains(&found) {
            return Err(format!("two columns are for the input `{name}`"));
        }
        columns.push(found);
    }
    let inputs_only = |(column, _): &&(usize, i64)| columns[*column].is_some();
    for scan in 0..=inputs.last() {
        let mut changes = inputs.before(scan).iter().filter(inputs_only);
        if let Some((column, value)) = changes.find(|(_, value)| !matches!(value, 0 | 1)) {
            let name = &inputs.names[*column];
            return Err(format!("the input `{name}` is given {value} in scan {scan}, which is neither 0 nor 1"));
        }
    }
    Ok((inputs.clone(), columns))
}

/// Inputs that the table names are held at what it says, from the first value on; the plant gives the others.
fn by_table(
    machine: &Machine,
    program: Program,
    inputs: &Inputs,
    columns: &[Option<InputId>],
    scans: Option<u64>,
) -> Recording {
    let mut run = Run::new(machine, program);
    let mut recording = Recording::all();
    for scan in 1..=scans.unwrap_or(inputs.last()) {
        for &(column, value) in inputs.before(scan) {
            if let Some(input) = columns[column] {
                run.plant().force(input, Some(value != 0));
            }
        }
        run.scan();
        recording.push(scan, run.frame());
    }
    recording
}

/// Every input that the plant does not give changes now and then, and steps of the plant happen by chance.
fn by_chance(machine: &Machine, program: Program, seed: u64, scans: u64) -> Recording {
    let gives = machine.plant.gives(machine.inputs.len());
    let free: Vec<InputId> = machine.inputs.ids().filter(|i| !gives[i.index()]).collect();
    let mut run = Run::new(machine, program);
    let mut recording = Recording::all();
    let mut state = seed;
    // A sequence of its own: how often inputs change does not depend on what the plant does.
    run.plant().leave_to_chance(machine, !seed);
    for scan in 1..=scans {
        for &input in &free {
            // In a sixteenth of the scans; in the first scan every other input is TRUE.
            let chance = chance::next(&mut state);
            if if scan == 1 { chance & 1 == 0 } else { chance & 15 == 0 } {
                let value = if scan == 1 { true } else { !run.input(input) };
                run.plant().set(Given::Input(input), value);
            }
        }
        run.scan();
        recording.push(scan, run.frame());
    }
    recording
}
