//! The engines of `verify` against each other and against going through all states.

use crate::support::rng::Rng;
use crate::support::systems::{Truth, comes, random, random_fair, truth};
use chartwright::verify::{Choice, Engine, Giver, Limits, Property, Report, System, Verdict, check};

const SYSTEMS: u64 = 1_000;

fn ask(system: &System, choice: Choice) -> Report {
    check(system, None, &Limits::default(), choice, &|| false, &mut |_| {})
}

/// A system all of whose latches matter to all claims.
fn whole(seed: u64) -> System {
    let mut system = random(&mut Rng::new(seed));
    let mut all = chartwright::verify::aig::Lit::FALSE;
    for i in 0..system.latches.len() {
        let leaf = system.latches[i].leaf;
        all = system.aig.xor(all, leaf);
    }
    system.claim("all", Property::Never(all));
    system
}

#[test]
fn the_exact_engine_knows_what_going_through_all_states_tells() {
    let mut violated = 0;
    for seed in 0..SYSTEMS {
        let system = whole(seed);
        let (expected, states) = truth(&system);
        let report = ask(&system, Choice::Only(Engine::Exact));
        assert_eq!(report.states.map(|s| s.to_string()), Some(states.to_string()), "states of {seed}");
        for (claim, (finding, expected)) in system.claims.iter().zip(report.findings.iter().zip(&expected)) {
            let found: Truth = match &finding.verdict {
                Verdict::Holds => Ok(()),
                Verdict::Violated(trace) => {
                    assert!(trace.shortest && system.shows(trace, claim.property));
                    violated += 1;
                    Err(trace.inputs.len())
                }
                Verdict::Unknown(limit) => panic!("{seed} {}: {limit}", claim.name),
            };
            assert_eq!(found, *expected, "{seed} {}", claim.name);
        }
    }
    assert!(violated > 1_000, "{violated} of {SYSTEMS} systems' claims are wrong");
}

#[test]
fn proofs_and_bounded_searches_come_to_the_same_verdicts() {
    let (mut proved, mut found) = (0, 0);
    for seed in 0..SYSTEMS {
        let system = whole(seed);
        let (expected, _) = truth(&system);
        let proof = ask(&system, Choice::Only(Engine::Proof));
        let bounded = check(
            &system,
            None,
            &Limits { scans: 20, ..Limits::default() },
            Choice::Only(Engine::Bounded),
            &|| false,
            &mut |_| {},
        );
        for (i, claim) in system.claims.iter().enumerate() {
            if !matches!(claim.property, Property::Never(_)) {
                continue;
            }
            match (&proof.findings[i].verdict, &expected[i]) {
                (Verdict::Holds, Ok(())) => proved += 1,
                (Verdict::Violated(trace), Err(scans)) => {
                    assert!(trace.shortest && system.shows(trace, claim.property));
                    assert_eq!(trace.inputs.len(), *scans, "{seed} {}", claim.name);
                }
                (found, expected) => panic!("{seed} {}: {found:?}, not {expected:?}", claim.name),
            }
            match (&bounded.findings[i].verdict, &expected[i]) {
                (Verdict::Unknown(_), Ok(())) => {}
                (Verdict::Violated(trace), Err(scans)) if trace.inputs.len() == *scans => found += 1,
                (Verdict::Unknown(_), Err(scans)) if *scans > 20 => {}
                (found, expected) => panic!("{seed} {}: {found:?}, not {expected:?}", claim.name),
            }
        }
    }
    assert!(proved > 1_000 && found > 1_000, "{proved} proved, {found} found");
}

#[test]
fn what_comes_sooner_or_later_is_what_going_through_all_loops_tells() {
    let (mut held, mut violated, mut proved, mut found) = (0, 0, 0, 0);
    for seed in 0..SYSTEMS {
        let system = random_fair(&mut Rng::new(seed));
        let exact = ask(&system, Choice::Only(Engine::Exact));
        let proof = ask(&system, Choice::Only(Engine::Proof));
        let limits = Limits { scans: 12, ..Limits::default() };
        let bounded = check(&system, None, &limits, Choice::Only(Engine::Bounded), &|| false, &mut |_| {});
        for (i, claim) in system.claims.iter().enumerate() {
            let Property::Eventually { after, then } = claim.property else { panic!("it claims nothing else") };
            let expected = comes(&system, after, then);
            for report in [&exact, &proof, &bounded] {
                let finding = &report.findings[i];
                match &finding.verdict {
                    Verdict::Holds => assert!(expected, "{seed} {}: {:?}", claim.name, finding.engine),
                    Verdict::Violated(trace) => {
                        assert!(!expected, "{seed} {}: {:?}", claim.name, finding.engine);
                        let begin = system.repeats(trace, claim.property).expect("it comes to a loop");
                        // Once more round is the same run.
                        let mut longer = trace.clone();
                        longer.inputs.extend_from_slice(&trace.inputs[begin..]);
                        assert!(system.shows(&longer, claim.property), "{seed} {}", claim.name);
                    }
                    Verdict::Unknown(limit) => {
                        let may = finding.engine == Engine::Bounded;
                        assert!(may, "{seed} {} {:?}: {limit}", claim.name, finding.engine);
                    }
                }
            }
            held += usize::from(expected);
            violated += usize::from(!expected);
            proved += usize::from(proof.findings[i].verdict == Verdict::Holds);
            if let Verdict::Violated(trace) = &bounded.findings[i].verdict {
                let Verdict::Violated(other) = &exact.findings[i].verdict else { panic!("both know") };
                assert!(trace.shortest && trace.inputs.len() <= other.inputs.len(), "{seed} {}", claim.name);
                found += 1;
            }
        }
    }
    assert!(held > 500 && violated > 500, "{held} hold, {violated} do not");
    assert!(proved == held && found > violated * 9 / 10, "{proved} proved, {found} found");
}

/// A counter of that many bits that can be held, and never gets beyond its last value but one.
fn counter(bits: usize) -> System {
    let mut system = System::default();
    let go = system.input("go", Giver::Operator);
    let count: Vec<_> = (0..bits).map(|i| system.latch(format!("b{i}"), Some(false))).collect();
    let last = {
        let mut lits = count.clone();
        lits[0] = !lits[0];
        system.aig.all(&lits)
    };
    let mut carry = system.aig.and(go, !last);
    for (i, &bit) in count.iter().enumerate() {
        system.latches[i].next = system.aig.xor(bit, carry);
        carry = system.aig.and(bit, carry);
    }
    let all = system.aig.all(&count);
    system.claim("full", Property::Never(all));
    system.claim("nearly full", Property::Never(last));
    system.claim("back", Property::AlwaysPossible(!count[0]));
    let some = system.aig.any(&count);
    system.claim("to the beginning", Property::AlwaysPossible(!some));
    system
}

#[test]
fn a_long_way_is_found_and_a_bound_is_met() {
    let system = counter(8);
    let report = ask(&system, Choice::Automatic);
    assert_eq!(report.states.as_ref().map(ToString::to_string).as_deref(), Some("255"));
    assert_eq!(report.findings[0].verdict, Verdict::Holds);
    let Verdict::Violated(trace) = &report.findings[1].verdict else { panic!("it gets there") };
    assert_eq!(trace.inputs.len(), 255);
    assert_eq!(report.findings[2].verdict, Verdict::Holds);
    assert!(matches!(report.findings[3].verdict, Verdict::Violated(_)));

    let few = Limits { nodes: 20, ..Limits::default() };
    let report = check(&system, None, &few, Choice::Only(Engine::Exact), &|| false, &mut |_| {});
    assert!(matches!(report.findings[0].verdict, Verdict::Unknown(chartwright::verify::Limit::Nodes)));
    let report = check(&system, None, &few, Choice::Automatic, &|| false, &mut |_| {});
    // So few states are gone through one by one.
    assert!(report.findings.iter().all(|f| f.engine == Engine::Exact));
    assert_eq!(report.findings[0].verdict, Verdict::Holds);
    let Verdict::Violated(trace) = &report.findings[1].verdict else { panic!("it gets there") };
    assert!(trace.inputs.len() == 255 && trace.shortest);
    assert!(matches!(report.findings[3].verdict, Verdict::Violated(_)));
    let report = check(&system, None, &few, Choice::Only(Engine::Proof), &|| false, &mut |_| {});
    assert!(matches!(report.findings[3].verdict, Verdict::Unknown(chartwright::verify::Limit::Kind)));
}

#[test]
fn what_is_known_when_the_time_is_up_is_kept() {
    use chartwright::verify::Limit::{Stopped, Unshown};
    let system = counter(8);
    let (mut kept, mut half) = (0, 0);
    for most in (0..2_000).step_by(20) {
        let asked = std::cell::Cell::new(0);
        let stop = || {
            asked.set(asked.get() + 1);
            asked.get() > most
        };
        let report = check(&system, None, &Limits::default(), Choice::Only(Engine::Exact), &stop, &mut |_| {});
        let [never, run, ..] = &report.findings[..] else { panic!("they are asked") };
        assert!(matches!(never.verdict, Verdict::Holds | Verdict::Unknown(Stopped)), "{most}: {never:?}");
        assert!(matches!(run.verdict, Verdict::Violated(_) | Verdict::Unknown(Stopped | Unshown)), "{most}: {run:?}");
        let unshown = run.verdict == Verdict::Unknown(Unshown);
        half += usize::from(unshown);
        kept += usize::from(unshown && never.verdict == Verdict::Holds);
    }
    assert!(half > 0 && kept > 0, "{half}, {kept}");
}

#[test]
fn who_is_told_to_stop_stops() {
    let report = check(&counter(20), None, &Limits::default(), Choice::Automatic, &|| true, &mut |_| {});
    for finding in &report.findings {
        assert_eq!(finding.verdict, Verdict::Unknown(chartwright::verify::Limit::Stopped));
    }
}
