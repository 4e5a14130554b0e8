//! Filters against all cases tried one by one: sets of constraints by chance, and the three sets on which the
//! published algorithm fails.
//!
//! `CHARTWRIGHT_RANDOM_FILTERS=N` makes the first test look at that many sets instead of a few hundred.

use crate::support::filters::{Case, End, Product, Reading, Set};
use crate::support::proof::{build, read_back};
use crate::support::rng::Rng;
use chartwright::bits::sat::Sat;
use chartwright::ir::chart::{Machine, Relief};
use chartwright::pipeline::{self, Dialect};
use chartwright::prove::{Correspondence, Doubt, Verdict, chart_filter, equivalence};
use chartwright::simulate::plc::Plc;
use chartwright::{check, emit, lower, parse, read, resolve};
use std::collections::BTreeMap;

fn wanted() -> u64 {
    std::env::var("CHARTWRIGHT_RANDOM_FILTERS").ok().and_then(|n| n.parse().ok()).unwrap_or(400)
}

/// What the compiler says of a set.
fn codes(set: &Set) -> Vec<&'static str> {
    let (_, diagnostics) = pipeline::check(&set.source());
    diagnostics.iter().map(|d| d.code.number()).filter(|c| c.starts_with('E')).collect()
}

/// What is wrong with the compiler's judgement of a set, or with the program that it makes.
fn fault(set: &Set, seed: u64) -> Option<String> {
    let codes = codes(set);
    let (cases, vectors) = (set.cases(), set.vectors());
    let impossible = cases.iter().any(|c| vectors.iter().all(|v| !set.safe(c, v)));
    let all = || cases.iter().flat_map(|c| vectors.iter().map(move |v| (c, v)));
    let stuck = || all().any(|(c, v)| set.filter(c, v) == End::Stuck);
    if codes.contains(&"E405") || codes.contains(&"E414") {
        return None; // Constraints or assumptions that say nothing.
    }
    if !codes.is_empty() {
        if codes.contains(&"E412") && !impossible {
            return Some("E412, but there are safe outputs in every case".into());
        }
        if impossible && !codes.contains(&"E412") && !codes.contains(&"E406") && !set.in_order {
            return Some(format!("{codes:?}, but in some case there are no safe outputs at all"));
        }
        let simple = || cases.iter().any(|c| vectors.iter().any(|v| set.contradicts(c, v)));
        let reason = if set.in_order { stuck() || codes.contains(&"E406") && simple() } else { simple() };
        return (!reason).then(|| format!("{codes:?}, but the filter finds its way in every case"));
    }
    if impossible || stuck() {
        return Some("accepted, but in some case it is stuck".into());
    }
    if let Some((c, v)) = all().find(|(c, v)| set.safe(c, v) && set.filter(c, v) != End::Safe((*v).clone(), 0)) {
        return Some(format!("it corrects {v:?}, which is safe in {c:?}"));
    }
    let most = all().map(|(c, v)| if let End::Safe(_, n) = set.filter(c, v) { n } else { 0 }).max();
    let machine = pipeline::check(&set.source()).0.expect("it is accepted");
    match machine.safety.relief {
        Relief::InOrder { sweeps } if Some(sweeps) != most => {
            return Some(format!("{sweeps} sweeps, but {most:?} are needed"));
        }
        Relief::InOrder { .. } | Relief::Together => {}
    }
    run(set, &machine, seed)
}

/// Where the program that the machine becomes does not do what the algorithm says.
fn run(set: &Set, machine: &Machine, seed: u64) -> Option<String> {
    let dialect = if seed.is_multiple_of(2) { Dialect::Beremiz } else { Dialect::Codesys };
    let xml = emit::plcopen(&lower::lower(machine), dialect, &emit::Header::default());
    let program = read::read(&xml).0.expect("what is written can be read");
    let mut plc = Plc::new(&program);
    let global = |name: String| program.global(&name).expect("it has all signals");
    let mut rng = Rng::new(seed);
    let mut was = vec![false; set.outputs];
    for scan in 0..60 {
        let inputs: Vec<bool> = (0..set.inputs).map(|_| rng.chance(50)).collect();
        let commands: Vec<bool> = (0..set.outputs).map(|_| rng.chance(60)).collect();
        inputs.iter().enumerate().for_each(|(i, &x)| {
            // The reader may leave out what nothing reads.
            if let Some(id) = program.global(&format!("X{i}")) {
                plc.write(id, i64::from(x));
            }
        });
        commands.iter().enumerate().for_each(|(o, &c)| plc.write(global(format!("C{o}")), i64::from(c)));
        plc.scan(scan * 10_000);
        let outputs: Vec<bool> = (0..set.outputs).map(|o| plc.read(global(format!("Y{o}"))) != 0).collect();
        let case = Case { inputs, was };
        if set.assumed(&case) {
            match set.filter(&case, &commands) {
                End::Safe(expected, _) if expected == outputs && set.safe(&case, &outputs) => {}
                end => return Some(format!("{case:?}, {commands:?}: the program says {outputs:?}, not {end:?}")),
            }
        }
        was = outputs;
    }
    None
}

#[test]
fn the_compiler_judges_as_all_cases_do() {
    let mut said: BTreeMap<String, usize> = BTreeMap::new();
    for seed in 0..wanted() {
        let set = Set::random(seed);
        if let Some(what) = fault(&set, seed) {
            panic!("set {seed}: {what}\n{}", set.source());
        }
        let (mode, mut codes) = (if set.in_order { "in order" } else { "together" }, codes(&set));
        codes.sort_unstable();
        codes.dedup();
        *said
            .entry(format!("{mode}: {}", if codes.is_empty() { "accepted".into() } else { codes.join(" ") }))
            .or_default() += 1;
    }
    println!("{said:#?}");
    for mode in ["in order", "together"] {
        let accepted = said.get(&format!("{mode}: accepted")).copied().unwrap_or(0) as u64;
        assert!(accepted * 10 > wanted() && accepted * 2 < wanted(), "{mode}: {accepted} accepted");
    }
}

fn product(outputs: &[(usize, bool)], yields: usize) -> Product {
    Product { outputs: outputs.to_vec(), readings: Vec::new(), yields: vec![yields] }
}

fn set(outputs: usize, products: Vec<Product>) -> Set {
    Set { inputs: 1, outputs, in_order: false, products, assumptions: Vec::new() }
}

/// All outputs off before, no input.
fn rest(set: &Set) -> Case {
    Case { inputs: vec![false; set.inputs], was: vec![false; set.outputs] }
}

/// What ours makes of all outputs commanded at once: the algorithm, and the program in all its cases.
fn ours(set: &Set) -> End {
    assert_eq!(fault(set, 1), None, "{}", set.source());
    assert!(codes(set).is_empty(), "{}", set.source());
    set.filter(&rest(set), &vec![true; set.outputs])
}

#[test]
fn the_published_loop_forgets_and_swings_for_ever() {
    // Y0 and Y1 exclude each other, and Y2 needs Y1. Once Y1 has yielded it is no longer violated, so Y1
    // comes back, and so on.
    let set = set(3, vec![product(&[(0, false), (1, false)], 1), product(&[(1, true), (2, false)], 2)]);
    let (outputs, fallback) = set.published(&rest(&set), &[true, true, true]);
    assert!(fallback && outputs == [false, false, false], "{outputs:?}");
    assert_eq!(ours(&set), End::Safe(vec![true, false, false], 2));
}

#[test]
fn the_published_loop_throws_the_right_answer_away() {
    // Its second and last turn finds it, and then the counter says that it has found nothing.
    let set = set(2, vec![product(&[(0, false), (1, false)], 1)]);
    let (outputs, fallback) = set.published(&rest(&set), &[true, true]);
    assert!(fallback && outputs == [false, false], "{outputs:?}");
    assert_eq!(ours(&set), End::Safe(vec![true, false], 1));
}

#[test]
fn the_published_fallback_is_unsafe() {
    // X0 holds Y0, and Y0 needs Y1. The fallback asks simple constraints only and leaves Y1 off.
    let hold = Product { outputs: vec![(0, true)], readings: vec![(Reading::Input(0), false)], yields: Vec::new() };
    let set = set(2, vec![hold, product(&[(0, false), (1, true)], 1)]);
    let case = Case { inputs: vec![true], was: vec![false, false] };
    let (outputs, fallback) = set.published(&case, &[true, false]);
    assert!(fallback && !set.safe(&case, &outputs), "{outputs:?}");
    assert_eq!(ours(&set), End::Safe(vec![true, true], 0));
    assert_eq!(set.filter(&case, &[true, false]), End::Safe(vec![true, true], 1));
}

/// A machine that nothing has been checked of.
fn unchecked(source: &str) -> Machine {
    let (machine, diagnostics) = resolve::resolve(&parse::parse(source).0.expect("it can be parsed"));
    assert!(!diagnostics.has_errors(), "{diagnostics:?}");
    machine
}

#[test]
fn a_proof_does_not_rest_on_the_checks() {
    // What the checks refuse is lowered and proved all the same: the program does what the chart says, and
    // that is not safe.
    let hold = Product { outputs: vec![(0, true)], readings: vec![(Reading::Input(0), false)], yields: Vec::new() };
    let set = set(2, vec![hold, product(&[(0, false), (1, false)], 0)]);
    assert_eq!(codes(&set), ["E408"]);
    let machine = unchecked(&set.source());
    let project = lower::lower(&machine);
    let xml = emit::plcopen(&project, Dialect::Beremiz, &emit::Header::default());
    let program = read::read(&xml).0.expect("what is written can be read");
    let Verdict::Unknown(doubt) = equivalence(&machine, &Correspondence::of(&machine, &project), &program) else {
        panic!("it is not safe");
    };
    let Doubt::Unsafe(why) = *doubt else { panic!("{doubt}") };
    assert_eq!(
        why,
        "the filter lets through what `S1` forbids: with X0, prev(X0), Y0 commanded, Y1 commanded, Y0 let through, Y1 let through"
    );
}

#[test]
fn too_few_sweeps_are_noticed() {
    let source = std::fs::read_to_string(crate::support::models::repository("models/relief_in_order.chart")).unwrap();
    let mut machine = unchecked(&source);
    assert!(check::check(&mut machine).is_empty());
    assert_eq!(machine.safety.relief, Relief::InOrder { sweeps: 2 });
    assert_eq!(chart_filter::rounds(&machine, &mut Sat::new()), Some(2));
    machine.safety.relief = Relief::InOrder { sweeps: 1 };
    assert_eq!(chart_filter::rounds(&machine, &mut Sat::new()), None);
    let project = lower::lower(&machine);
    let xml = emit::plcopen(&project, Dialect::Beremiz, &emit::Header::default());
    let program = read::read(&xml).0.expect("what is written can be read");
    let verdict = equivalence(&machine, &Correspondence::of(&machine, &project), &program);
    assert!(matches!(verdict, Verdict::Unknown(_)), "{verdict:?}");
}

#[test]
fn what_is_let_through_is_proved_in_every_build() {
    let source = "machine M\ninputs { A B }\noutputs { O }\nactuator X onoff by O\n\
        chart C { initial state S { drives O when A } }\nsafety supervisor { S1: never O and B }\n";
    let output = build(source, Dialect::Beremiz).unwrap_or_else(|e| panic!("{e}"));
    let names = Correspondence::of(&output.machine, &output.project);
    match equivalence(&output.machine, &names, &read_back(&output)) {
        // One constraint and the commands that violate nothing, in the first scan and in any later one.
        Verdict::Proved(s) => assert_eq!(s.guarded, 4),
        other => panic!("{other:?}"),
    }
}

#[test]
fn sweeps_suffice_where_the_assumptions_hold() {
    let source = "machine M\ninputs { Ready Raise Go }\noutputs { IN OUT }\nactuator A onoff by IN\nactuator B onoff by OUT\n\
        chart C { initial state S { drives IN when Go } }\nsafety controller relief in-order {\n\
        F1: never IN and not OUT yields IN, OUT\nS1: never OUT and Ready\nS2: never not IN and Raise\n\
        assume A1: never Ready and Raise\n}\n";
    let mut machine = pipeline::check(source).0.expect("it is accepted");
    assert_eq!(machine.safety.relief, Relief::InOrder { sweeps: 1 });
    assert_eq!(chart_filter::rounds(&machine, &mut Sat::new()), Some(1));
    machine.safety.assumptions.clear();
    assert_eq!(chart_filter::rounds(&machine, &mut Sat::new()), None);
    let output = build(source, Dialect::Beremiz).unwrap_or_else(|e| panic!("{e}"));
    let names = Correspondence::of(&output.machine, &output.project);
    let verdict = equivalence(&output.machine, &names, &read_back(&output));
    assert!(matches!(verdict, Verdict::Proved(_)), "{verdict:?}");
}

#[test]
fn products_that_do_not_say_what_is_written_are_noticed() {
    let source = "machine M\ninputs { A B }\noutputs { O }\nactuator X onoff by O\nchart C { initial state S { drives O when A } }\n\
        safety supervisor { S1: never O and (A and B or not A)\nassume A1: never A and B }\n";
    let output = build(source, Dialect::Beremiz).unwrap_or_else(|e| panic!("{e}"));
    let mut sat = Sat::new();
    assert_eq!(chart_filter::products_say_what_is_written(&output.machine, &mut sat), Ok(()));
    let names = Correspondence::of(&output.machine, &output.project);
    let said = |machine: &Machine| match equivalence(machine, &names, &read_back(&output)) {
        Verdict::Unknown(doubt) => doubt.to_string(),
        other => panic!("{other:?}"),
    };
    let constraint = output.machine.safety.constraints.ids().next().expect("there is one");
    for change in [0, 1] {
        let mut machine = output.machine.clone();
        let products = &mut machine.safety.constraints[constraint].products;
        match change {
            0 => drop(products.pop()),
            _ => products.clear(),
        }
        assert_eq!(said(&machine), "the products of S1 do not say what is written");
    }
    let mut machine = output.machine.clone();
    machine.safety.assumptions[0].products.clear();
    assert_eq!(said(&machine), "the products of A1 do not say what is written");
}

/// What is said of a program whose filter has been changed; its chart commands always one of both outputs.
fn with_another_filter(changes: &[(&str, &str)]) -> String {
    let source = "machine M\ninputs { A B }\noutputs { ONE TWO }\nactuator X onoff by ONE\nactuator Y onoff by TWO\n\
        chart C { initial state S { drives ONE when A\ndrives TWO when not A } }\n\
        safety supervisor { S1: never ONE and TWO yields TWO\nS2: never TWO and A and B }\n";
    let output = build(source, Dialect::Beremiz).unwrap_or_else(|e| panic!("{e}"));
    let filter = output.xml.find(r#"<pou name="Filter""#).expect("there is a filter");
    let mut text = output.xml[filter..].to_owned();
    for (mark, variable) in changes {
        let (number, from) = mark.split_once(' ').expect("a number and a variable");
        let at = text.find(&format!(r#"<contact localId="{number}""#)).expect("a contact");
        let end = at + text[at..].find("</contact>").expect("its end");
        assert!(text[at..end].contains(&format!("<variable>{from}</variable>")), "{mark}: {}", &text[at..end]);
        let (negated, variable) = variable.strip_prefix('/').map_or(("false", *variable), |v| ("true", v));
        let changed = text[at..end].replace(&format!("<variable>{from}<"), &format!("<variable>{variable}<"));
        let changed = changed.replace(r#"negated="false""#, &format!(r#"negated="{negated}""#));
        text.replace_range(at..end, &changed);
    }
    let (program, diagnostics) = read::read(&format!("{}{text}", &output.xml[..filter]));
    let program = program.unwrap_or_else(|| panic!("{diagnostics:?}"));
    match equivalence(&output.machine, &Correspondence::of(&output.machine, &output.project), &program) {
        Verdict::Proved(_) => "proved".to_owned(),
        Verdict::Refuted(trace) => format!("refuted\n{trace}"),
        Verdict::Unknown(doubt) => doubt.to_string(),
    }
}

#[test]
fn a_filter_is_held_against_commands_that_no_chart_gives() {
    assert_eq!(with_another_filter(&[]), "proved");
    // ONE is commanded exactly while A is on and TWO is not; but a filter has to do without knowing that.
    let hit = with_another_filter(&[("20 Cmd_ONE", "A")]);
    assert!(hit.starts_with("the filter lets through what `S1` forbids: with "), "{hit}");
    let output = with_another_filter(&[("41 Cmd_ONE", "/Cmd_TWO")]);
    assert!(output.starts_with("the filter corrects commands that violate nothing: with "), "{output}");
    assert!(output.ends_with("ONE let through"), "{output}");
}
