//! A model to what happens without each of its constraints.

use super::args::{Format, Verify as Args, VerifyProgram};
use super::files::{self, Pending};
use super::report::{FileReport, Report};
use super::verify::{JsonPlace, places};
use super::watch::Watch;
use super::{Outcome, counterexample, finish, read, say, tell, verify};
use crate::base::figure;
use crate::ir::chart::{ConstraintId, Machine};
use crate::pipeline::findings::{Findings, once};
use crate::pipeline::needed::{Kept, Loss, Needed, Without, needed};
use crate::pipeline::verify::{Question, Run};
use crate::simulate::vcd;
use serde::Serialize;
use std::fmt::Write;
use std::time::Duration;

/// The JSON document's part.
#[derive(Serialize)]
struct Result {
    /// What is kept with all constraints.
    properties: Vec<JsonProperty>,
    constraints: Vec<JsonConstraint>,
}

#[derive(Serialize)]
struct JsonProperty {
    property: String,
    places: Vec<JsonPlace>,
    verdict: &'static str,
    reason: Option<String>,
    /// The hint for an open answer.
    help: Option<String>,
}

#[derive(Serialize)]
struct JsonConstraint {
    constraint: String,
    places: Vec<JsonPlace>,
    verdict: &'static str,
    /// The property that is violated without it, or stays open.
    property: Option<String>,
    /// How many scans the run takes that shows it.
    scans: Option<usize>,
    shortest: Option<bool>,
    replayed: Option<bool>,
    scenario: Option<String>,
    /// The code of the error for which the compiler refuses what is left.
    code: Option<String>,
    reason: Option<String>,
    /// The hint for an open answer.
    help: Option<String>,
    /// Those that imply it together with the assumptions, if that is so.
    implied_by: Option<Vec<String>>,
}

/// Runs `chartwright verify --needed`.
pub fn run(args: &Args) -> Outcome {
    let mut report = Report::default();
    let watch = Watch::new("verify", Some(args.time), args.output.format == Format::Human).listen();
    // Nothing is asked of the constraints before it is known what holds with all of them: that may take half of the
    // time. What one constraint leaves of its share is for those behind it.
    let mut whole = true;
    let mut begin = |parts: usize| {
        watch.say(if whole {
            "what holds with all constraints".to_owned()
        } else {
            figure(parts, "constraint") + " to go"
        });
        watch.share(if std::mem::take(&mut whole) { 2 } else { parts });
    };
    let options = verify::options(args, VerifyProgram::Any);
    let ask = |source: &str| needed(source, &options, &|| watch.stop(), &mut begin);
    let found = read(&args.file, &mut report, ask).flatten();
    let (interrupted, time) = (watch.interrupted(), watch.elapsed());
    drop(watch);
    let found = match found {
        Some(Ok(mut found)) => {
            if interrupted {
                found.interrupt();
            }
            found
        }
        refused => {
            let outcome = finish("verify", args.output.format, &report, &Option::<Result>::None);
            let Some(Err(refusal)) = refused else { return outcome };
            say(&format!("error: {refusal}\n"));
            return Outcome::Wrong;
        }
    };
    let mut written = true;
    for failed in write(args, &found) {
        report.files.push(failed);
        written = false;
    }
    let source = report.files.first().map_or("", |file| &file.source);
    let findings = Findings::new(&found.machine, source);
    let mut given = finish("verify", args.output.format, &report, &result(&found, &findings, source));
    if args.output.format == Format::Human {
        given = given.and(tell(&human(&found, &findings, time)));
    }
    let settled = found.without.iter().all(|(_, without)| match without {
        Without::Violated(loss) => loss.certain,
        Without::Refused(_) => true,
        // The only thing that can be denied here.
        Without::Kept(_) => args.deny.is_empty(),
        Without::Unknown(..) | Without::Unverified(_) => false,
    });
    let fine = settled && found.properties.iter().all(|(_, kept)| *kept == Kept::Yes) && !found.properties.is_empty();
    given.and(if fine && written { Outcome::Fine } else { Outcome::Wrong })
}

/// Writes what was asked for: all runs as scenarios, the first one as a value change dump.
fn write(args: &Args, found: &Needed) -> Vec<FileReport> {
    let runs = found.without.iter().filter_map(|(_, without)| match without {
        Without::Violated(loss) => loss.run.as_ref().map(|run| (&loss.machine, run)),
        _ => None,
    });
    let runs: Vec<(&Machine, &Run)> = runs.collect();
    let Some((machine, first)) = runs.first() else { return Vec::new() };
    let scenarios: Vec<&str> = runs.iter().map(|(_, run)| &*run.scenario).collect();
    let scenarios = args.scenario.as_ref().map(|path| (path, scenarios.join("\n")));
    let dump = args.vcd.as_ref().map(|path| (path, vcd::write(machine, &counterexample::recording(first))));
    let mut failed = Vec::new();
    for (path, text) in [scenarios, dump].into_iter().flatten() {
        if let Err(diagnostic) = Pending::prepare(path, text).and_then(Pending::commit) {
            failed.push(FileReport::failed(files::show(path), diagnostic));
        }
    }
    failed
}

fn verdict(without: &Without) -> &'static str {
    match without {
        Without::Violated(loss) if loss.certain => "needed",
        Without::Refused(_) => "needed",
        Without::Kept(_) => "not needed",
        Without::Violated(_) | Without::Unknown(..) | Without::Unverified(_) => "open",
    }
}

fn name(machine: &Machine, constraint: ConstraintId) -> &str {
    &machine.safety.constraints[constraint].name
}

fn result(found: &Needed, findings: &Findings<'_>, source: &str) -> Result {
    let machine = &found.machine;
    let place = |question| places(source, findings.places(question));
    let properties = found.properties.iter().map(|&(i, kept)| JsonProperty {
        property: findings.property(i),
        places: place(Question::Declared(i)),
        verdict: match kept {
            Kept::Yes => "holds",
            Kept::No => "violated",
            Kept::Unknown(_) => "open",
        },
        reason: if let Kept::Unknown(limit) = kept { Some(limit.to_string()) } else { None },
        help: if let Kept::Unknown(limit) = kept { findings.hint(limit, Question::Declared(i)) } else { None },
    });
    let constraints = found.without.iter().map(|(id, without)| {
        let mut json = JsonConstraint {
            constraint: name(machine, *id).to_owned(),
            places: place(Question::Acts(*id)),
            verdict: verdict(without),
            property: None,
            scans: None,
            shortest: None,
            replayed: None,
            scenario: None,
            code: None,
            reason: None,
            help: None,
            implied_by: None,
        };
        match without {
            Without::Violated(loss) => {
                json.property = Some(findings.property(loss.property));
                json.reason = (!loss.certain).then(|| DOUBT.to_owned());
                if let Some(run) = &loss.run {
                    json.scans = Some(run.frames.len());
                    json.shortest = Some(run.shortest);
                    json.replayed = run.replayed;
                    json.scenario = Some(run.scenario.clone());
                }
            }
            Without::Refused(error) => {
                json.code = Some(error.code.to_string());
                json.reason = Some(error.message.clone());
            }
            Without::Kept(implied) => {
                let names = |ids: &Vec<ConstraintId>| ids.iter().map(|&c| name(machine, c).to_owned()).collect();
                json.implied_by = implied.as_ref().map(names);
            }
            Without::Unknown(i, limit) => {
                json.property = Some(findings.property(*i));
                json.reason = Some(limit.to_string());
                json.help = findings.hint(*limit, Question::Declared(*i));
            }
            Without::Unverified(refusal) => json.reason = Some(refusal.to_string()),
        }
        json
    });
    Result { properties: properties.collect(), constraints: constraints.collect() }
}

/// Why a property that is violated without a constraint does not tell that this is needed.
const DOUBT: &str = "nobody knows whether it holds with all constraints";

fn human(found: &Needed, findings: &Findings<'_>, time: Duration) -> String {
    let machine = &found.machine;
    let mut text = String::new();
    for &(i, kept) in &found.properties {
        let _ = match kept {
            Kept::Yes => writeln!(text, "holds       {}", findings.property(i)),
            Kept::No => writeln!(
                text,
                "violated    {} (with all constraints, so it does not tell what is needed)",
                findings.property(i)
            ),
            Kept::Unknown(limit) => writeln!(text, "open        {}; is that so? ({limit})", findings.property(i)),
        };
    }
    if found.properties.iter().all(|(_, kept)| *kept == Kept::No) {
        return text + "No declared property holds, so there is nothing that a constraint could be needed for.\n";
    }
    for (id, without) in &found.without {
        let _ = write!(text, "{:<10}  {}", verdict(without), findings.constraint_name(*id));
        let _ = match without {
            Without::Violated(loss) => write!(text, ": without it {}", lost(machine, loss)),
            Without::Refused(error) => {
                write!(text, ": without it the compiler refuses the model ({}: {})", error.code, error.message)
            }
            Without::Kept(None) => write!(text, ": no property that is asked is violated without it"),
            Without::Kept(Some(implied)) if implied.is_empty() => write!(text, ": implied by the assumptions"),
            Without::Kept(Some(implied)) => {
                let names: Vec<&str> = implied.iter().map(|&c| name(machine, c)).collect();
                write!(text, ": implied by {}", names.join(", "))
            }
            Without::Unknown(i, limit) => {
                write!(text, ": does {} hold without it? ({limit})", machine.properties[*i].name)
            }
            Without::Unverified(refusal) => write!(text, ": {refusal}"),
        };
        text.push('\n');
    }
    for help in helps(found, findings) {
        let _ = writeln!(text, "help        {help}");
    }
    let count = |what: &str| found.without.iter().filter(|(_, without)| verdict(without) == what).count();
    let _ = writeln!(
        text,
        "\nof {}, each with all others in place, {} needed and {} not needed; {}.{:03} s",
        crate::base::count(found.without.len(), "constraint"),
        count("needed"),
        count("not needed"),
        time.as_secs(),
        time.subsec_millis()
    );
    text
}

/// The hints for all open answers.
fn helps(found: &Needed, findings: &Findings<'_>) -> Vec<String> {
    let kept = found.properties.iter().filter_map(|&(i, kept)| match kept {
        Kept::Unknown(limit) => findings.hint(limit, Question::Declared(i)),
        Kept::Yes | Kept::No => None,
    });
    let without = found.without.iter().filter_map(|(_, without)| match without {
        Without::Unknown(i, limit) => findings.hint(*limit, Question::Declared(*i)),
        _ => None,
    });
    once(kept.chain(without))
}

/// What is lost, and where that shows.
fn lost(machine: &Machine, loss: &Loss) -> String {
    let name = &machine.properties[loss.property].name;
    let scan = match &loss.run {
        Some(run) if run.is_empty() => " from the beginning".to_owned(),
        Some(run) => {
            let least = if run.shortest { "" } else { ", perhaps not the shortest run" };
            format!(" {}{least}", run.end())
        }
        None => String::new(),
    };
    let doubt = if loss.certain { String::new() } else { format!("; {DOUBT}") };
    format!("{name} is violated{scan}{doubt}")
}
