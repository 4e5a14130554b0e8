//! What is known of a machine whose times are left open to what is true of it at its declared cycle.
//!
//! With open times more happens than can happen. So what never is, or always comes, in all those runs does so at the declared cycle. A
//! run that shows something may be one that no fixed cycle gives: it is tried as it is, and what does not come to the same is asked
//! of the machine with exact times.

use super::run::{Run, show};
use super::verify::{Options, Question};
use crate::verify::aig::Lit;
use crate::verify::engine::{self, Finding, Progress};
use crate::verify::follow::{Found as Shown, follow};
use crate::verify::limits::Stop;
use crate::verify::machine::Subject;
use crate::verify::machine::clocks::Times;
use crate::verify::system::{Latch, Property, Trace};
use crate::verify::{Limit, Verdict};

/// A verdict, with the run that shows it.
pub type Found = (Finding, Option<Run>);

/// Question by question what is true with exact times, if that makes a difference. `findings` is what is with open ones.
pub fn judge(
    open: &Subject<'_>,
    findings: &[Finding],
    options: &Options,
    stop: Stop<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Option<Vec<Found>> {
    if options.times == Times::Free || !open.timed {
        return None;
    }
    let exact = || Subject::new(open.machine, options.program, options.open, Times::Exact);
    let exact = exact().ok()?;
    if exact.questions != open.questions {
        let unknown = |f: &Finding| (Finding { verdict: Verdict::Unknown(Limit::Kind), engine: f.engine }, None);
        return Some(findings.iter().map(unknown).collect());
    }
    let mut found: Vec<Option<Found>> = Vec::new();
    for (finding, claim) in findings.iter().zip(&exact.system.claims) {
        let certain = match (&finding.verdict, claim.property) {
            (Verdict::Holds, Property::Never(_) | Property::Eventually { .. }) => Some(Verdict::Holds),
            (Verdict::Violated(trace), Property::Never(_)) => {
                as_it_is(open, &exact, trace).filter(|t| exact.system.shows(t, claim.property)).map(Verdict::Violated)
            }
            _ => None,
        };
        let certain = certain.map(|verdict| Finding { verdict, engine: finding.engine });
        let question = exact.questions[found.len()];
        found.push(certain.map(|finding| shown(&exact, question, finding, options, stop)));
    }
    let left = |found: &[Option<Found>]| (0..found.len()).filter(|&i| found[i].is_none()).collect::<Vec<usize>>();
    let again = left(&found);
    if !again.is_empty() {
        let exact = exact.wanting(&again);
        along(open, &exact, findings, &again, &mut found, options, stop);
    }
    let wanted = left(&found);
    if !wanted.is_empty() {
        let exact = Subject::new(open.machine, options.program, options.open, Times::Exact).ok()?.wanting(&wanted);
        let report = engine::check(&exact.system, None, &options.limits, options.choice, stop, progress);
        for (&i, finding) in wanted.iter().zip(report.findings) {
            found[i] = Some(shown(&exact, open.questions[i], finding, options, stop));
        }
    }
    Some(found.into_iter().map(|f| f.expect("all has been asked")).collect())
}

/// Looks for runs with exact times along those with open ones: of all claims of `exact`, which are `claims` by index. One of what is hoped
/// for may show on the way to another one.
fn along(
    open: &Subject<'_>,
    exact: &Subject<'_>,
    findings: &[Finding],
    claims: &[usize],
    found: &mut [Option<Found>],
    options: &Options,
    stop: Stop<'_>,
) {
    let run = |claim: usize| match &findings[claim].verdict {
        Verdict::Violated(trace) => Some(trace),
        _ => None,
    };
    let hopes = |place: usize| exact.questions[place].hopes_for_a_run(exact.machine);
    let never = |place: usize| exact.system.claims[place].property.never();
    let mut places: Vec<usize> =
        (0..claims.len()).filter(|&p| never(p).is_some() && run(claims[p]).is_some()).collect();
    // On a long way much shows.
    places.sort_by_key(|&p| std::cmp::Reverse(run(claims[p]).map_or(0, |trace| trace.inputs.len())));
    for &place in &places {
        if found[claims[place]].is_some() {
            continue;
        }
        let others = places.iter().copied().filter(|&p| p != place && hopes(p) && found[claims[p]].is_none());
        let asked: Vec<usize> = [place].into_iter().chain(others).collect();
        let bads: Vec<Lit> = asked.iter().filter_map(|&p| never(p)).collect();
        let trace = run(claims[place]).expect("it has a run");
        for Shown { bad, trace } in follow(&open.system, &exact.system, trace, &bads, stop) {
            let (place, claim) = (asked[bad], claims[asked[bad]]);
            if found[claim].is_none() && exact.system.shows(&trace, exact.system.claims[place].property) {
                let finding = Finding { verdict: Verdict::Violated(trace), ..findings[claim].clone() };
                found[claim] = Some(shown(exact, exact.questions[place], finding, options, stop));
            }
        }
    }
}

/// A finding with its run. What the simulator does not repeat shows nothing where times are exact.
pub fn shown(subject: &Subject<'_>, question: Question, finding: Finding, options: &Options, stop: Stop<'_>) -> Found {
    let Verdict::Violated(trace) = &finding.verdict else { return (finding, None) };
    let run = show(subject, question, trace, options, stop);
    if subject.clocks.exact() && run.replayed == Some(false) {
        let verdict = Verdict::Unknown(Limit::Replay);
        return (Finding { verdict, engine: finding.engine }, None);
    }
    (finding, Some(run))
}

/// A run with open times as one with exact ones: the same inputs come in, and what may happen happens.
fn as_it_is(open: &Subject<'_>, exact: &Subject<'_>, trace: &Trace) -> Option<Trace> {
    let name = |leaf| exact.system.name(leaf);
    let input = |leaf| open.system.inputs.iter().position(|i| open.system.name(i.leaf) == name(leaf));
    let latch = |leaf| open.system.latches.iter().position(|l| open.system.name(l.leaf) == name(leaf));
    let from: Vec<Option<usize>> = exact.system.inputs.iter().map(|i| input(i.leaf)).collect();
    let begins = |l: &Latch| l.initial.unwrap_or_else(|| latch(l.leaf).is_some_and(|i| trace.initial[i]));
    let initial = exact.system.latches.iter().map(begins);
    let initial = initial.collect();
    let inputs = trace.inputs.iter().map(|scan| from.iter().map(|i| i.is_some_and(|i| scan[i])).collect()).collect();
    let trace = Trace { initial, inputs, shortest: trace.shortest };
    exact.system.replay(&trace, &mut |_| {}).is_ok().then_some(trace)
}
