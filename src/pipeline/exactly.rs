//! What is known of a machine whose times are left open to what is true of it at its declared cycle.
//!
//! With open times more happens than can happen. So what never is, or always comes, in all those runs does so at the declared cycle. A
//! run that shows something may be one that no fixed cycle gives: it is tried as it is, and with waits, and from the runs that are found
//! so others go on. What is left is asked of the machine with exact times, claim by claim: of as many clocks as it takes.

use super::refine;
use super::run::{Run, show};
use super::shortest::shortest;
use super::verify::{Options, Question};
use crate::verify::aig::{Lit, lanes};
use crate::verify::engine::{self, Choice, Engine, Finding, Progress};
use crate::verify::follow::{Found as Shown, follow};
use crate::verify::limits::Stop;
use crate::verify::machine::Subject;
use crate::verify::machine::clocks::{Clock, Counted, Times};
use crate::verify::parts;
use crate::verify::possible;
use crate::verify::symbolic;
use crate::verify::system::{Latch, Property, Trace};
use crate::verify::wander::{self, Around};
use crate::verify::{Limit, Limits, Verdict};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Transitions of a run that is played in no time.
const SHORT: usize = 50;

/// A verdict, with the run that shows it.
pub type Found = (Finding, Option<Run>);

/// How often walks go on from all runs that have been found.
const ROUNDS: usize = 3;

/// Gates that runs by chance evaluate in the end, for 64 runs at once.
const GATES: u64 = 2_000_000_000;

/// Conflicts for a first proof of a claim.
const GLANCE: u64 = 1_000;

/// Conflicts for a first proof that something stays possible.
const PLANS: u64 = 5_000;

/// What part of the operations one exploration gets before others are tried.
const STEPS: u64 = 16;

/// Question by question what is true with exact times, if that makes a difference. `findings` is what is with open ones, `witness` what a
/// scenario shows of the question of that index.
pub fn judge(
    open: &Subject<'_>,
    findings: &[Finding],
    witness: &dyn Fn(usize) -> Option<Found>,
    options: &Options,
    stop: Stop<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Option<Vec<Found>> {
    if options.times == Times::Free || !open.timed {
        return None;
    }
    let exact = open.counting(&Counted::All);
    if exact.questions != open.questions {
        let unknown = |f: &Finding| (Finding { verdict: Verdict::Unknown(Limit::Kind), engine: f.engine }, None);
        return Some(findings.iter().map(unknown).collect());
    }
    let found = vec![None; findings.len()];
    let mut search = Search { open, findings, options, stop, found, runs: Vec::new() };
    search.keep(&exact);
    for (i, found) in search.found.iter_mut().enumerate().filter(|(_, found)| found.is_none()) {
        *found = witness(i);
    }
    search.parts(&exact, progress);
    search.find();
    search.explore();
    search.plan();
    search.refine(progress);
    search.ask(progress);
    Some(search.found.into_iter().map(|f| f.expect("all has been asked")).collect())
}

/// What has been found so far.
struct Search<'s, 'm> {
    /// The machine with its times left open.
    open: &'s Subject<'m>,
    /// What is true of it.
    findings: &'s [Finding],
    options: &'s Options,
    stop: Stop<'s>,
    /// Question by question what is known with exact times.
    found: Vec<Option<Found>>,
    /// Runs with exact times.
    runs: Vec<Trace>,
}

impl<'m> Search<'_, 'm> {
    /// What is not known yet, of which that can be said.
    fn left(&self, is: impl Fn(Property) -> bool) -> Vec<usize> {
        let claims = &self.open.system.claims;
        (0..self.found.len()).filter(|&i| self.found[i].is_none() && is(claims[i].property)).collect()
    }

    /// The machine with exact times, of which no more is asked than that.
    fn exact(&self, claims: &[usize]) -> Subject<'m> {
        self.open.counting(&Counted::All).wanting(claims)
    }

    /// Notes what was found about a claim in `subject`, where it has that place.
    fn note(&mut self, subject: &Subject<'_>, place: usize, claim: usize, mut finding: Finding) {
        let question = subject.questions[place];
        // What is demanded is worth a look at whether less shows it.
        if self.options.demands(question)
            && !question.hopes_for_a_run(subject.machine)
            && let Verdict::Violated(trace) = finding.verdict
        {
            let property = subject.system.claims[place].property;
            finding.verdict = Verdict::Violated(shortest(subject, property, trace, self.stop));
        }
        self.found[claim] = Some(shown(subject, question, finding, self.options, self.stop));
    }

    /// Keeps what is so with exact times because it is with open ones.
    fn keep(&mut self, exact: &Subject<'_>) {
        let claims = self.findings.iter().zip(&exact.system.claims).enumerate();
        for (i, (Finding { verdict, engine }, claim)) in claims {
            let certain = match (verdict, claim.property) {
                (Verdict::Holds, Property::Never(_) | Property::Eventually { .. }) => Some(Verdict::Holds),
                (Verdict::Violated(trace), Property::Never(_)) => {
                    let run = as_it_is(self.open, exact, trace);
                    self.runs.extend(run.clone());
                    run.filter(|t| exact.system.shows(t, claim.property)).map(Verdict::Violated)
                }
                _ => None,
            };
            if let Some(verdict) = certain {
                self.note(exact, i, i, Finding { verdict, engine: *engine });
            }
        }
    }

    /// Goes through the states of small parts by the clock: what depends on one timer is soon known.
    fn parts(&mut self, exact: &Subject<'_>, progress: &mut dyn FnMut(Progress)) {
        if self.options.choice != Choice::Automatic {
            return;
        }
        let wanted: Vec<bool> = self.found.iter().map(Option::is_none).collect();
        let open = wanted.iter().filter(|w| **w).count();
        let mut told = |_| progress(Progress { engine: Engine::Exact, claim: None, scans: 0, open });
        let verdicts = parts::explore(&exact.system, &wanted, &self.options.limits, self.stop, &mut told);
        for (claim, verdict) in verdicts.into_iter().enumerate() {
            let verdict = match verdict {
                Some(Ok(())) => Verdict::Holds,
                // Elsewhere something may have to come in for it to be a run.
                Some(Err(run)) if exact.system.shows(&run, exact.system.claims[claim].property) => {
                    Verdict::Violated(run)
                }
                Some(Err(_)) | None => continue,
            };
            let finding = Finding { verdict, engine: Engine::Exact };
            self.found[claim] = Some(shown(exact, exact.questions[claim], finding, self.options, self.stop));
        }
    }

    /// Looks for runs of what is shown with open times: along the runs that show it there, what is demanded first, and near them.
    fn find(&mut self) {
        let shown = |i: &usize| matches!(self.findings[*i].verdict, Verdict::Violated(_));
        let mut claims = self.left(|p| p.never().is_some());
        claims.retain(shown);
        if claims.is_empty() {
            return;
        }
        let exact = self.exact(&claims);
        let mut around = Around::new(&exact.system);
        let mut known = 0;
        let demands = |i: usize| {
            let question = self.open.questions[i];
            self.options.demands(question) && !question.hopes_for_a_run(self.open.machine)
        };
        // On a long way much shows.
        let mut order: Vec<usize> = (0..claims.len()).collect();
        order.sort_by_key(|&p| (!demands(claims[p]), Reverse(self.run(claims[p]).inputs.len())));
        let demanded = order.iter().filter(|&&p| demands(claims[p])).count();
        for (i, &place) in order.iter().enumerate() {
            if i == demanded {
                self.near(&exact, &claims, &mut around, &mut known, false);
            }
            if self.found[claims[place]].is_none() && self.along(&exact, &claims, place) && i >= demanded {
                self.near(&exact, &claims, &mut around, &mut known, false);
            }
        }
        for _ in 0..ROUNDS {
            self.near(&exact, &claims, &mut around, &mut known, true);
        }
        self.glance(&claims);
        let wanted: Vec<bool> = claims.iter().map(|&i| self.found[i].is_none()).collect();
        if wanted.contains(&true) {
            let walk = wander::wander(&exact.system, &wanted, GATES, self.stop);
            let runs = walk.runs.into_iter().enumerate();
            let found = runs.filter_map(|(place, run)| Some((place, run.filter(|_| wanted[place])?)));
            self.accept(&exact, &claims, found.collect());
        }
    }

    /// Tries short proofs of those of the claims that are still open.
    fn glance(&mut self, claims: &[usize]) {
        let claims: Vec<usize> = claims.iter().copied().filter(|&i| self.found[i].is_none()).collect();
        if claims.is_empty() || self.options.choice != Choice::Automatic {
            return;
        }
        let exact = self.exact(&claims);
        let limits = Limits { conflicts: GLANCE.min(self.options.limits.conflicts), ..self.options.limits };
        let choice = Choice::Only(Engine::Proof);
        let report = engine::check(&exact.system, None, &limits, choice, self.stop, &mut |_| {});
        for (place, finding) in report.findings.into_iter().enumerate() {
            if !matches!(finding.verdict, Verdict::Unknown(_)) {
                self.note(&exact, place, claims[place], finding);
            }
        }
    }

    /// Goes through all situations for what is left, if there are few.
    fn explore(&mut self) {
        let left = self.left(|_| true);
        if !left.is_empty() {
            let exact = self.exact(&left);
            self.explored(&exact, &left);
        }
    }

    /// Goes through all situations of a machine, if there are few.
    fn explored(&mut self, exact: &Subject<'_>, claims: &[usize]) {
        if self.options.choice != Choice::Automatic {
            return;
        }
        let limits = Limits { steps: self.options.limits.steps / STEPS, ..self.options.limits };
        let explored = symbolic::explore(&exact.system, &limits, self.stop, &mut |_| {});
        for (place, verdict) in explored.verdicts.into_iter().enumerate() {
            let verdict = match verdict {
                Some(Ok(())) => Verdict::Holds,
                // Nothing is believed that the system does not do.
                Some(Err(run)) if exact.system.shows(&run, exact.system.claims[place].property) => {
                    Verdict::Violated(run)
                }
                Some(Err(_)) | None => continue,
            };
            self.note(exact, place, claims[place], Finding { verdict, engine: Engine::Exact });
        }
    }

    /// The run that shows a claim with open times.
    fn run(&self, claim: usize) -> &Trace {
        match &self.findings[claim].verdict {
            Verdict::Violated(trace) => trace,
            _ => unreachable!("it is shown"),
        }
    }

    /// Looks for a run with exact times along one with open ones. What is demanded has to show itself; all else may show on the way to
    /// another one. Says whether there is a new run.
    fn along(&mut self, exact: &Subject<'_>, claims: &[usize], place: usize) -> bool {
        let never = |place: usize| exact.system.claims[place].property.never().expect("it is never");
        let is_open = |p: &usize| {
            let question = exact.questions[*p];
            let demanded = self.options.demands(question) && !question.hopes_for_a_run(exact.machine);
            *p != place && !demanded && self.found[claims[*p]].is_none()
        };
        let asked: Vec<usize> = [place].into_iter().chain((0..claims.len()).filter(is_open)).collect();
        let bads: Vec<Lit> = asked.iter().map(|&p| never(p)).collect();
        let found = follow(&self.open.system, &exact.system, self.run(claims[place]), &bads, self.stop);
        let mut new = false;
        for Shown { bad, trace } in found {
            let (place, claim) = (asked[bad], claims[asked[bad]]);
            if self.found[claim].is_none() && exact.system.shows(&trace, exact.system.claims[place].property) {
                let engine = self.findings[claim].engine;
                self.runs.push(trace.clone());
                self.note(exact, place, claim, Finding { verdict: Verdict::Violated(trace), engine });
                new = true;
            }
        }
        new
    }

    /// Looks for runs near those that have been found, of which so many are `known` there.
    fn near(&mut self, exact: &Subject<'_>, claims: &[usize], around: &mut Around<'_>, known: &mut usize, anew: bool) {
        let wanted: Vec<bool> = claims.iter().map(|&i| self.found[i].is_none()).collect();
        if wanted.contains(&true) {
            self.runs[*known..].iter().for_each(|run| around.follow(run));
            *known = self.runs.len();
            let found = around.near(&wanted, anew, self.stop);
            self.accept(exact, claims, found);
        }
    }

    /// Takes runs of claims for what they are.
    fn accept(&mut self, exact: &Subject<'_>, claims: &[usize], found: Vec<(usize, Trace)>) {
        for (place, trace) in found {
            if exact.system.shows(&trace, exact.system.claims[place].property) {
                self.runs.push(trace.clone());
                let finding = Finding { verdict: Verdict::Violated(trace), engine: Engine::Chance };
                self.note(exact, place, claims[place], finding);
            }
        }
    }

    /// Tries to prove by plans what is claimed to stay possible.
    fn plan(&mut self) {
        for claim in self.left(|p| matches!(p, Property::AlwaysPossible(_) | Property::NeverStuck)) {
            if self.options.choice != Choice::Automatic {
                return;
            }
            let exact = self.exact(&[claim]);
            self.explored(&exact, &[claim]);
            if self.found[claim].is_some() {
                continue;
            }
            let goal = match exact.system.claims[0].property {
                Property::AlwaysPossible(goal) => goal,
                _ => Lit::TRUE,
            };
            let states = states(&exact, &self.runs);
            let limits = Limits { conflicts: PLANS.min(self.options.limits.conflicts), ..self.options.limits };
            let limits = Limits { scans: limits.scans.min(possible::SHORT), ..limits };
            let proved = possible::prove(&exact.system, goal, &states, &[], &limits, self.stop, &mut |_| {});
            if proved.is_ok() {
                self.note(&exact, 0, claim, Finding { verdict: Verdict::Holds, engine: Engine::Proof });
            }
        }
    }

    /// Asks with as many clocks as it takes.
    fn refine(&mut self, progress: &mut dyn FnMut(Progress)) {
        let mut sets = Vec::new();
        for claim in self.left(|p| p.never().is_some()) {
            let Verdict::Violated(trace) = &self.findings[claim].verdict else { continue };
            let asked = refine::Asked { open: self.open, claim, trace };
            let found = refine::answer(&asked, &mut sets, self.options, self.stop, progress);
            if let Some((subject, finding)) = found {
                self.note(&subject, 0, claim, finding);
            }
        }
    }

    /// Asks all that is left.
    fn ask(&mut self, progress: &mut dyn FnMut(Progress)) {
        let exact = self.open.counting(&Counted::All);
        let system = &exact.system;
        // What depends on the same clocks is asked together.
        let mut groups: BTreeMap<BTreeSet<Clock>, Vec<usize>> = BTreeMap::new();
        for claim in self.left(|_| true) {
            let roots = match system.claims[claim].property {
                Property::Eventually { after, then } => system.roots_of(after, then),
                property => system.constraints.iter().copied().chain(property.literals()).collect(),
            };
            let (latches, _) = system.cone(&roots);
            groups.entry(exact.clocks.among(&latches)).or_default().push(claim);
        }
        for claims in groups.into_values() {
            let exact = self.exact(&claims);
            let Options { limits, choice, .. } = self.options;
            let report = engine::check(&exact.system, None, limits, *choice, self.stop, progress);
            for (place, finding) in report.findings.into_iter().enumerate() {
                self.note(&exact, place, claims[place], finding);
            }
        }
    }
}

/// States of some runs.
fn states(subject: &Subject<'_>, runs: &[Trace]) -> Vec<Vec<bool>> {
    let system = &subject.system;
    let mut states = Vec::new();
    for run in runs {
        let mut own = Vec::new();
        let next = |values: &[u64]| system.latches.iter().map(|l| lanes(values, l.next) & 1 == 1).collect();
        if system.replay(run, &mut |values| own.push(next(values))).is_ok() {
            states.append(&mut own);
        }
        if states.len() > STATES {
            break;
        }
    }
    states
}

/// States of runs that are looked at for plans.
const STATES: usize = 1_000;

/// A finding with its run. What the simulator does not repeat shows nothing where times are exact.
pub fn shown(subject: &Subject<'_>, question: Question, finding: Finding, options: &Options, stop: Stop<'_>) -> Found {
    let Verdict::Violated(trace) = &finding.verdict else { return (finding, None) };
    // What is wrong is worth the work when the time is up. What is long and shows no more than that something can be is not.
    let wrong = options.demands(question) && !question.hopes_for_a_run(subject.machine);
    if !wrong && trace.inputs.len() > SHORT && stop() {
        return (Finding { verdict: Verdict::Unknown(Limit::Unshown), engine: finding.engine }, None);
    }
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
    let there = |leaf| open.system.name(leaf);
    let inputs: HashMap<&str, usize> = open.system.inputs.iter().enumerate().map(|(i, l)| (there(l.leaf), i)).collect();
    let latches: HashMap<&str, usize> =
        open.system.latches.iter().enumerate().map(|(i, l)| (there(l.leaf), i)).collect();
    let input = |leaf| inputs.get(name(leaf)).copied();
    let latch = |leaf| latches.get(name(leaf)).copied();
    let from: Vec<Option<usize>> = exact.system.inputs.iter().map(|i| input(i.leaf)).collect();
    let begins = |l: &Latch| l.initial.unwrap_or_else(|| latch(l.leaf).is_some_and(|i| trace.initial[i]));
    let initial = exact.system.latches.iter().map(begins);
    let initial = initial.collect();
    let inputs = trace.inputs.iter().map(|scan| from.iter().map(|i| i.is_some_and(|i| scan[i])).collect()).collect();
    let trace = Trace { initial, inputs, shortest: trace.shortest };
    exact.system.replay(&trace, &mut |_| {}).is_ok().then_some(trace)
}
