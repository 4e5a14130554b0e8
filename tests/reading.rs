//! PLCopen XML read back: what is understood, what is refused, and that nothing makes it panic.

use crate::support::models;
use chartwright::base::{Code, Diagnostics};
use chartwright::emit::Dialect;
use chartwright::ir::expr::Expr;
use chartwright::ir::iec::{Atom, Body, CoilKind, Kind, Project, Qualifier, Scope, Sfc, Statement, Target};
use chartwright::ir::plc;
use chartwright::{pipeline, read};
use std::path::Path;

const BEREMIZ: &str = "http://www.plcopen.org/xml/tc6_0201";
const CODESYS: &str = "http://www.plcopen.org/xml/tc6_0200";

/// A file with one program, whose variables `A` to `D` are BOOL, `I` INT, `D1` TIME, `T1` TON and
/// `E1` R_TRIG.
fn file(namespace: &str, actions: &str, body: &str) -> String {
    let variables: String =
        [("A", "BOOL"), ("B", "BOOL"), ("C", "BOOL"), ("D", "BOOL"), ("I", "INT"), ("D1", "TIME")]
            .iter()
            .map(|(name, kind)| format!(r#"<variable name="{name}"><type><{kind}/></type></variable>"#))
            .chain([("T1", "TON"), ("E1", "R_TRIG")].iter().map(|(name, kind)| {
                format!(r#"<variable name="{name}"><type><derived name="{kind}"/></type></variable>"#)
            }))
            .collect();
    format!(
        r#"<?xml version="1.0"?><project xmlns="{namespace}"><types><pous><pou name="P" pouType="program"><interface><localVars>{variables}</localVars></interface>{actions}<body>{body}</body></pou></pous></types></project>"#
    )
}

/// An element with lines from others.
fn element(tag: &str, number: u32, attributes: &str, from: &[u32], rest: &str) -> String {
    let lines: String = from.iter().map(|n| format!(r#"<connection refLocalId="{n}"/>"#)).collect();
    let input = if from.is_empty() { String::new() } else { format!("<connectionPointIn>{lines}</connectionPointIn>") };
    format!(r#"<{tag} localId="{number}" {attributes}>{input}{rest}</{tag}>"#)
}

fn contact(number: u32, from: &[u32], name: &str) -> String {
    element("contact", number, "", from, &format!("<variable>{name}</variable>"))
}

fn coil(number: u32, from: &[u32], attributes: &str, name: &str) -> String {
    element("coil", number, attributes, from, &format!("<variable>{name}</variable>"))
}

const RAIL: &str = r#"<leftPowerRail localId="1"/>"#;

fn step(number: u32, name: &str, from: &[u32]) -> String {
    let initial = if from.is_empty() { r#" initialStep="true""# } else { "" };
    element("step", number, &format!(r#"name="{name}"{initial}"#), from, "")
}

fn transition(number: u32, from: &[u32], condition: &str) -> String {
    let condition = format!(r#"<condition><inline name=""><ST><p>{condition}</p></ST></inline></condition>"#);
    element("transition", number, "", from, &condition)
}

fn jump(number: u32, from: &[u32], to: &str) -> String {
    element("jumpStep", number, &format!(r#"targetName="{to}""#), from, "")
}

fn joint(tag: &str, number: u32, from: &[u32]) -> String {
    let lines: String = from
        .iter()
        .map(|n| format!(r#"<connectionPointIn><connection refLocalId="{n}"/></connectionPointIn>"#))
        .collect();
    format!(r#"<{tag} localId="{number}">{lines}</{tag}>"#)
}

fn numbers(diagnostics: &Diagnostics) -> Vec<&'static str> {
    let mut codes: Vec<_> = diagnostics.iter().map(|d| d.code.number()).collect();
    codes.dedup();
    codes
}

#[track_caller]
fn project(text: &str) -> Project {
    let (project, diagnostics) = read::read(text);
    project.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

#[track_caller]
fn refused(text: &str, code: Code, part: &str) {
    let (project, diagnostics) = read::read(text);
    assert!(project.is_none(), "{part}");
    let found = diagnostics.iter().any(|d| d.code == code && d.message.contains(part));
    assert!(found, "{code} with `{part}` expected, found {diagnostics:?}");
}

#[track_caller]
fn sfc(text: &str) -> Sfc {
    match &project(text).programs[0].body {
        Body::Sfc(sfc) => sfc.clone(),
        Body::Code(_) => panic!("not an SFC"),
    }
}

#[track_caller]
fn code(text: &str) -> Vec<Statement> {
    match &project(text).programs[0].body {
        Body::Code(statements) => statements.clone(),
        Body::Sfc(_) => panic!("an SFC"),
    }
}

/// Transitions as `from>to` with names of steps.
fn ways(sfc: &Sfc) -> Vec<String> {
    let names = |steps: &[chartwright::ir::iec::StepId]| {
        steps.iter().map(|s| sfc.steps[*s].name.as_str()).collect::<Vec<_>>().join("+")
    };
    sfc.transitions.iter().map(|t| format!("{}>{}", names(&t.from), names(&t.to))).collect()
}

#[test]
fn every_model_reads_back_in_both_dialects() {
    for model in models::all() {
        for dialect in [Dialect::Beremiz, Dialect::Codesys] {
            let options = pipeline::Options { dialect, created: "1970-01-01T00:00:00".to_owned(), prove: false };
            let output = pipeline::build(&model.source, &options).0.expect("a model builds");
            let written = &output.project;
            let read = project(&output.xml);
            let name = &model.name;
            assert_eq!(read.name, written.name, "{name}");
            let globals = || read.variables.values().filter(|v| v.scope == Scope::Global);
            for global in written.globals.values() {
                let found =
                    globals().find(|v| v.name == global.name).unwrap_or_else(|| panic!("{name}: {}", global.name));
                let (kind, initial) = match global.initial {
                    plc::Value::Bool(value) => (Kind::Bool, i64::from(value)),
                    plc::Value::Int(value) => (Kind::Int { bits: 16, signed: true }, i64::from(value)),
                    plc::Value::Udint(value) => (Kind::Int { bits: 32, signed: false }, i64::from(value)),
                };
                assert_eq!((&found.address, found.initial), (&global.address, initial), "{name}");
                assert_eq!(found.kind, kind);
            }
            assert_eq!(globals().count(), written.globals.len(), "{name}");
            assert_eq!(read.tick(), Some(i64::from(written.task.interval) * 1000), "{name}");
            assert_eq!(read.programs.len(), written.programs.len(), "{name}");
            for (read, written) in read.programs.iter().zip(&written.programs) {
                assert_eq!(read.kind, written.name, "{name}");
                assert_same_shape(&read.body, &written.body, &written.name);
            }
        }
    }
}

/// Compares what can be counted; that they mean the same is for the simulator to say.
fn assert_same_shape(read: &Body, written: &plc::Body, name: &str) {
    match (read, written) {
        (Body::Sfc(read), plc::Body::Sfc(written)) => {
            let steps = |s: &Sfc| s.steps.values().map(|s| s.name.clone()).collect::<std::collections::BTreeSet<_>>();
            assert_eq!(steps(read), written.steps.values().map(|s| s.name.clone()).collect(), "{name}");
            // A step without a way out is drawn with one that is never taken.
            let read_ways = read.transitions.iter().filter(|t| t.condition.value != Expr::FALSE).count();
            let written_ways = written.transitions.iter().filter(|t| t.condition != Expr::FALSE).count();
            assert_eq!(read_ways, written_ways, "{name}");
            assert!(read.transitions.iter().all(|t| t.priority.is_some()), "{name}");
        }
        (Body::Code(read), plc::Body::Ladder(written)) => {
            assert!(read.len() >= written.rungs.len(), "{name}");
        }
        _ => panic!("{name}: bodies differ in kind"),
    }
}

#[test]
fn ladder_means_series_and_parallel() {
    let body = [
        RAIL.to_owned(),
        contact(2, &[1], "A"),
        contact(3, &[1], "B"),
        element("contact", 4, r#"negated="true""#, &[2, 3], "<variable>c</variable>"),
        coil(5, &[4], r#"negated="true""#, "D"),
        coil(6, &[4], r#"storage="set""#, "A"),
        element("rightPowerRail", 7, "", &[5], ""),
    ]
    .concat();
    let text = file(BEREMIZ, "", &format!("<LD>{body}</LD>"));
    let read = project(&text);
    let id = |name: &str| Expr::Atom(Atom::Variable(read.variables.iter().find(|v| v.1.name == name).unwrap().0));
    let flow = Expr::all([Expr::any([id("A"), id("B")]), id("C").not()]);
    let [Statement::Coil(first), Statement::Coil(second)] = &code(&text)[..] else { panic!("two coils") };
    assert_eq!((&first.condition.value, first.kind), (&flow.clone().not(), CoilKind::Plain));
    assert_eq!((&second.condition.value, second.kind), (&flow, CoilKind::Set));
}

#[test]
fn branches_that_meet_again_and_again_stay_small() {
    let mut body = RAIL.to_owned();
    let mut before = vec![1];
    for stage in 0..200 {
        let (left, right) = (2 * stage + 2, 2 * stage + 3);
        body += &contact(left, &before, "A");
        body += &contact(right, &before, "B");
        before = vec![left, right];
    }
    body += &coil(1000, &before, "", "C");
    let text = file(BEREMIZ, "", &format!("<LD>{body}</LD>"));
    let [Statement::Coil(coil)] = &code(&text)[..] else { panic!("one coil") };
    assert!(coil.condition.shared.len() <= 400);
}

#[test]
fn blocks_and_edges_run_before_what_reads_them() {
    let pin = |name: &str, from: u32| {
        format!(
            r#"<variable formalParameter="{name}"><connectionPointIn><connection refLocalId="{from}"/></connectionPointIn></variable>"#
        )
    };
    let block = format!(
        r#"<block localId="9" typeName="TON" instanceName="t1"><inputVariables>{}{}</inputVariables><inOutVariables/><outputVariables><variable formalParameter="Q"/><variable formalParameter="ET"/></outputVariables></block>"#,
        pin("IN", 2),
        pin("PT", 3)
    );
    let q = r#"<coil localId="4"><connectionPointIn><connection refLocalId="9" formalParameter="Q"><position x="0" y="0"/></connection></connectionPointIn><variable>B</variable></coil>"#;
    let et = r#"<outVariable localId="5"><connectionPointIn><connection refLocalId="9" formalParameter="ET"><position x="0" y="0"/></connection></connectionPointIn><expression>D1</expression></outVariable>"#;
    let body = [
        RAIL,
        &element("contact", 2, r#"edge="rising""#, &[1], "<variable>A</variable>"),
        &element("inVariable", 3, "", &[], "<expression>T#1s</expression>"),
        q,
        et,
        &block,
    ]
    .concat();
    let statements = code(&file(BEREMIZ, "", &format!("<LD>{body}</LD>")));
    let kinds: Vec<&str> = statements
        .iter()
        .map(|s| match s {
            Statement::Call(call) if call.preset.is_some() => "timer",
            Statement::Call(_) => "edge",
            Statement::Coil(_) => "coil",
            Statement::Move { .. } => "move",
        })
        .collect();
    assert_eq!(kinds, ["edge", "timer", "coil", "move"]);
}

#[test]
fn divergences_and_convergences_join_steps() {
    let body = [
        step(1, "S0", &[]),
        joint("selectionDivergence", 2, &[1]),
        transition(3, &[2], "A"),
        transition(4, &[2], "NOT A AND B"),
        joint("selectionConvergence", 5, &[3, 4]),
        joint("simultaneousDivergence", 6, &[5]),
        step(7, "S1", &[6]),
        step(8, "S2", &[6]),
        joint("simultaneousConvergence", 9, &[7, 8]),
        transition(10, &[9], "S1.T &gt;= T#1s"),
        jump(11, &[10], "S0"),
    ]
    .concat();
    let sfc = sfc(&file(BEREMIZ, "", &format!("<SFC>{body}</SFC>")));
    assert_eq!(ways(&sfc), ["S0>S1+S2", "S1+S2>S0", "S0>S1+S2"]);
    assert!(sfc.transitions.iter().all(|t| t.priority.is_none()));
    let other = body.replace(r#"targetName="S0""#, r#"targetName="s0""#);
    assert_eq!(project(&file(CODESYS, "", &format!("<SFC>{other}</SFC>"))).programs.len(), 1);
    refused(&file(BEREMIZ, "", &format!("<SFC>{other}</SFC>")), Code::NotUnderstood, "written otherwise");
}

#[test]
fn codesys_nests_branches_and_tries_them_from_left_to_right() {
    let body = [
        step(1, "S0", &[]),
        joint("selectionDivergence", 2, &[1]),
        transition(3, &[2], "A"),
        step(4, "S1", &[3]),
        transition(5, &[4], "B"),
        jump(6, &[5], "S1"),
        joint("selectionDivergence", 7, &[2]),
        transition(8, &[7], "C"),
        transition(9, &[7], "D"),
        joint("selectionConvergence", 10, &[8, 9]),
        joint("selectionConvergence", 11, &[6, 10]),
        jump(12, &[11], "S0"),
    ]
    .concat();
    let sfc = sfc(&file(CODESYS, "", &format!("<SFC>{body}</SFC>")));
    let mut ways = ways(&sfc).into_iter().zip(sfc.transitions.iter().map(|t| t.priority)).collect::<Vec<_>>();
    ways.sort_by_key(|w| w.1);
    let expected = [("S0>S1", 0), ("S1>S1", 1), ("S0>S0", 2), ("S0>S0", 3)];
    assert_eq!(ways, expected.map(|(w, p)| (w.to_owned(), Some(p))));
    // The same drawing means nothing sure elsewhere.
    refused(&file(BEREMIZ, "", &format!("<SFC>{body}</SFC>")), Code::NotUnderstood, "selectionDivergence");
}

#[test]
fn actions_are_variables_or_bodies() {
    let actions = r#"<actions><action name="Count"><body><ST><p>I := I + 1; T1(IN := A, PT := T#1s, ET => D1);</p></ST></body></action></actions>"#;
    let block = r#"<actionBlock localId="2"><connectionPointIn><connection refLocalId="1"/></connectionPointIn>
        <action localId="3"><reference name="a"/></action>
        <action localId="4" qualifier="SD" duration="T#1.5s"><reference name="COUNT"/></action>
        <action localId="5" qualifier="P"><inline><ST><p>B := NOT (C = A);</p></ST></inline></action></actionBlock>"#;
    let body = [step(1, "S0", &[]).as_str(), block, &transition(6, &[1], "A"), &jump(7, &[6], "S0")].concat();
    let sfc = sfc(&file(BEREMIZ, actions, &format!("<SFC>{body}</SFC>")));
    let associations = &sfc.steps.values().next().unwrap().associations;
    assert!(matches!(associations[0].target, Target::Variable(_)));
    assert_eq!((associations[1].qualifier, associations[1].duration), (Qualifier::StoredDelayed, 1_500_000));
    let Target::Action(count) = associations[1].target else { panic!("an action") };
    assert!(matches!(
        sfc.actions[count].body[..],
        [Statement::Move { .. }, Statement::Call(_), Statement::Move { .. }]
    ));
    let Target::Action(inline) = associations[2].target else { panic!("an action") };
    assert_eq!(sfc.actions[inline].body.len(), 1);
}

#[test]
fn expressions_bind_as_the_standard_says() {
    let value = |text: &str| {
        let escaped = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        match &code(&file(BEREMIZ, "", &format!("<ST><p>A := {escaped};</p></ST>")))[..] {
            [Statement::Coil(coil)] => coil.condition.value.clone(),
            other => panic!("{other:?}"),
        }
    };
    for (short, long) in [
        ("A OR B AND C", "A OR (B AND C)"),
        ("A XOR B AND C OR D", "(A XOR (B AND C)) OR D"),
        ("NOT A AND B", "(NOT A) AND B"),
        ("not A = B", "(NOT A) = B"),
        ("A & B and C", "A AND B AND C"),
        ("I + 1 > 3 = C", "((I + 1) > 3) = C"),
        ("D1 - T#1s < T#500ms", "(D1 - T#1000ms) < T#0.5s"),
        ("t1.q OR T1.et >= t#1m", "T1.Q OR (T1.ET >= T#60s)"),
        ("A (* or B *) OR FALSE", "A"),
        ("A = 1", "NOT (NOT A)"),
    ] {
        assert_eq!(value(short), value(long), "{short}");
    }
    for (wrong, code) in [
        ("A OR", Code::BrokenText),
        ("A OR OR B", Code::BrokenText),
        ("(A", Code::BrokenText),
        ("A B", Code::BrokenText),
        ("I", Code::BrokenText),
        ("A + B", Code::BrokenText),
        ("I = D1", Code::BrokenText),
        ("A < B", Code::BrokenText),
        ("T1", Code::BrokenText),
        ("I * 2 > 1", Code::NotUnderstood),
        ("MAX(I, 2) > 1", Code::NotUnderstood),
        ("%IX0.0", Code::BrokenText),
        ("X1", Code::Undeclared),
        ("T1.CV", Code::NotUnderstood),
    ] {
        let escaped = wrong.replace('<', "&lt;").replace('>', "&gt;");
        let text = file(BEREMIZ, "", &format!("<ST><p>A := {escaped};</p></ST>"));
        let (_, diagnostics) = read::read(&text);
        assert_eq!(numbers(&diagnostics), [code.number()], "{wrong}: {diagnostics:?}");
    }
}

#[test]
fn what_tools_are_known_to_get_wrong_is_refused() {
    let ladder = |parts: &[String]| file(BEREMIZ, "", &format!("<LD>{RAIL}{}</LD>", parts.concat()));
    let chart = |parts: &[String]| file(BEREMIZ, "", &format!("<SFC>{}</SFC>", parts.concat()));
    let both = r#"negated="true" edge="rising""#;
    let cases = [
        ladder(&[element("contact", 2, both, &[1], "<variable>A</variable>"), coil(3, &[2], "", "B")]),
        ladder(&[contact(2, &[1], "A"), coil(3, &[2], r#"negated="true" storage="set""#, "B")]),
        ladder(&[contact(2, &[1], "A"), contact(3, &[1], "B"), coil(4, &[2, 3], "", "C"), coil(5, &[4], "", "D")]),
        ladder(&[contact(2, &[1], "A OR B"), coil(3, &[2], "", "C")]),
        chart(&[
            step(1, "S", &[]),
            transition(2, &[1], "A").replace("<condition>", r#"<condition negated="true">"#),
            jump(3, &[2], "S"),
        ]),
        chart(&[step(1, "S", &[]), element("macroStep", 2, r#"name="M""#, &[], "")]),
    ];
    for text in &cases {
        let (_, diagnostics) = read::read(text);
        assert_eq!(numbers(&diagnostics), ["E602"], "{text}: {diagnostics:?}");
    }
}

#[test]
fn loose_ends_are_refused() {
    let ladder = |parts: &[String]| file(BEREMIZ, "", &format!("<LD>{RAIL}{}</LD>", parts.concat()));
    let chart = |parts: &[String]| file(BEREMIZ, "", &format!("<SFC>{}</SFC>", parts.concat()));
    let s = || step(1, "S", &[]);
    refused(&ladder(&[coil(2, &[], "", "A")]), Code::Unconnected, "coil `A` (number 2) is connected to nothing");
    refused(&ladder(&[coil(2, &[77], "", "A")]), Code::Unconnected, "element 77");
    let loop_ = [contact(2, &[3], "A"), contact(3, &[2], "B"), coil(4, &[3], "", "C")];
    refused(&ladder(&loop_), Code::Unconnected, "feeds itself");
    refused(&chart(&[step(1, "S", &[2]), transition(2, &[1], "A")]), Code::Unconnected, "no initial step");
    refused(&chart(&[s(), transition(2, &[1], "A")]), Code::Unconnected, "leads to no step");
    refused(&chart(&[s(), transition(2, &[1], "A"), jump(3, &[2], "T")]), Code::Unconnected, "`T`, which is no step");
    refused(
        &chart(&[s(), jump(2, &[3], "S"), element("transition", 3, "", &[1], "")]),
        Code::Unconnected,
        "no condition",
    );
    refused(&chart(&[s(), s()]), Code::Clash, "number 1");
    refused(&chart(&[s(), step(2, "s", &[])]), Code::Clash, "two steps have the name `s`");
}

#[test]
fn the_frame_of_the_file_is_checked() {
    let good = file(BEREMIZ, "", "<ST>A := B;</ST>");
    assert_eq!(code(&good).len(), 1);
    refused("", Code::NotPlcopen, "broken");
    refused("<project/>", Code::NotPlcopen, "root element");
    refused(&good.replace("tc6_0201", "tc6_0300"), Code::NotPlcopen, "root element");
    refused(&good.replace("<project", "<!DOCTYPE a><project"), Code::NotPlcopen, "DTD");
    refused(&good.replace("</body>", ""), Code::NotPlcopen, "broken");
    refused(&good.replace(r#"name="B""#, r#"name="a""#), Code::Clash, "two variables");
    let address = |name: &str| format!(r#"name="{name}" address="%IX0.0""#);
    let clash = good.replace(r#"name="A""#, &address("A")).replace(r#"name="B""#, &address("B"));
    refused(&clash, Code::Clash, "%IX0.0");
    let instances = |task: &str, more: &str| {
        let resource = format!(r#"<resource name="Res">{task}<globalVars>{more}</globalVars></resource>"#);
        let end = format!(
            "<instances><configurations><configuration name=\"Config\">{resource}</configuration></configurations></instances></project>"
        );
        good.replace("</project>", &end)
    };
    let task = |interval: &str, kind: &str| {
        format!(r#"<task name="T" interval="{interval}"><pouInstance name="Q" typeName="{kind}"/></task>"#)
    };
    let global = r#"<variable name="G"><type><BOOL/></type></variable>"#;
    let read = project(&instances(&task("T#20ms", "p"), global));
    assert_eq!((read.programs[0].name.as_str(), read.programs[0].kind.as_str(), read.tick()), ("Q", "P", Some(20_000)));
    refused(&instances(&task("20 ms", "P"), global), Code::BrokenText, "interval");
    refused(&instances(&task("T#20ms", "R"), global), Code::Undeclared, "no program `R`");
    // In the Beremiz family a program has to say which globals it uses.
    let hidden = instances(&task("T#20ms", "P"), global).replace("A := B", "A := G");
    refused(&hidden, Code::Undeclared, "`G` is not declared");
    assert_eq!(
        project(&hidden.replace("tc6_0201", "tc6_0200").replace(r#"name="Q""#, r#"name="P""#)).programs.len(),
        1
    );
    let external = r#"<externalVars><variable name="g"><type><BOOL/></type></variable></externalVars></interface>"#;
    assert_eq!(project(&hidden.replace("</interface>", external)).programs.len(), 1);
    refused(&good.replace("</interface>", external), Code::Undeclared, "external variable `g`");
}

#[test]
fn elements_with_thousands_of_attributes_are_refused_at_once() {
    let start = std::time::Instant::now();
    let many: String = (0..40_000).map(|n| format!(" a{n}=\"<\"").replace('<', "&lt;")).collect();
    let text = file(BEREMIZ, "", "<LD/>").replace("<LD/>", &format!("<LD{many}/>"));
    refused(&text, Code::NotPlcopen, "more than 256 attributes");
    assert!(start.elapsed() < std::time::Duration::from_secs(2), "{:?}", start.elapsed());
    // What looks like attributes within comments, texts and values is none.
    let quotes = "\"".repeat(2000);
    let text = file(BEREMIZ, "", &format!("<!-- <a {quotes}> --><LD/><?p {quotes}?>"));
    assert_eq!(project(&text.replace(r#"name="P""#, &format!("name='P{quotes}'"))).programs.len(), 1);
}

#[test]
fn every_code_of_reading_has_a_page_and_a_test() {
    let here = include_str!("reading.rs");
    for code in Code::ALL.iter().filter(|c| c.number().starts_with("E6")) {
        assert!(here.contains(&format!("Code::{code:?}")), "{code}");
    }
}

/// Files that real tools wrote; they are no part of the repository.
#[test]
fn files_of_other_tools_are_read_or_refused_with_a_reason() {
    let shared = std::env::var("CHARTWRIGHT_SHARED").unwrap_or_else(|_| "../shared".to_owned());
    let samples = Path::new(&shared).join("samples");
    let expected: [(&str, Result<usize, &str>); 8] = [
        ("beremiz_first_steps.xml", Err("a body in FBD")),
        ("beremiz_traffic_light_sfc.xml", Err("a body in FBD")),
        ("codesys_sp14_ld.xml", Ok(1)),
        ("codesys_sp14_nested_sfc.xml", Err("a body in SFC")),
        ("codesys_sp18_sfc_actionblocks.xml", Err("`outDS` is no BOOL variable")),
        ("codesys_sp4_ppu_scenario0.xml", Err("writing to `Mag.SliderNotMovedOut`")),
        ("openplc_spemmcra_ld.xml", Err("parallel branches before it")),
        ("wago_ecockpit_min.xml", Ok(1)),
    ];
    for (name, outcome) in expected {
        let Ok(bytes) = std::fs::read(samples.join(name)) else {
            eprintln!("SKIPPED: {} is not there", samples.join(name).display());
            continue;
        };
        let text = String::from_utf8(bytes).expect("samples are UTF-8");
        match outcome {
            Ok(programs) => assert_eq!(project(&text).programs.len(), programs, "{name}"),
            Err(reason) => {
                let (project, diagnostics) = read::read(&text);
                assert!(project.is_none(), "{name}");
                assert!(diagnostics.iter().any(|d| d.message.contains(reason)), "{name}: {diagnostics:?}");
            }
        }
    }
}

/// Cuts, swaps and garbles files. What comes out does not matter, only that something does.
#[test]
fn no_file_makes_it_panic() {
    let mut state = 1_u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below.max(1)
    };
    let words = [
        "\"0\"",
        "\"1\"",
        "\"-1\"",
        "contact",
        "block",
        "step",
        "simultaneousConvergence",
        "jumpStep",
        "",
        "A",
        "T#9999999999d",
    ];
    for name in ["parallel", "timer", "variables"] {
        let model = models::all().into_iter().find(|m| m.name == name).expect("the model is there");
        for dialect in [Dialect::Beremiz, Dialect::Codesys] {
            let options = pipeline::Options { dialect, created: String::new(), prove: false };
            let xml = pipeline::build(&model.source, &options).0.expect("it builds").xml;
            let lines: Vec<&str> = xml.lines().collect();
            for _ in 0..40 {
                let mut changed: Vec<String> = lines.iter().map(|l| (*l).to_owned()).collect();
                for _ in 0..1 + random(4) {
                    let (one, two) = (random(changed.len()), random(changed.len()));
                    match random(4) {
                        0 => changed.swap(one, two),
                        1 => changed[one] = changed[two].clone(),
                        2 => {
                            let (from, to) = (words[random(words.len())], words[random(words.len())]);
                            changed[one] = changed[one].replace(from, to);
                        }
                        _ => {
                            // Only digits change, so that the XML stays well-formed.
                            let digit = char::from(b'0' + random(10) as u8);
                            changed[one] =
                                changed[one].chars().map(|c| if c.is_ascii_digit() { digit } else { c }).collect();
                        }
                    }
                }
                let text = changed.join("\n");
                if let (Some(project), _) = read::read(&text) {
                    let mut plc = chartwright::simulate::plc::Plc::new(&project);
                    (0..3).for_each(|scan| plc.scan(scan * 10_000));
                }
            }
        }
    }
}
