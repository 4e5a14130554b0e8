//! What `verify`, `test` and `prove` say: each kind of line is read here, as people do, and none of them can be read as its opposite.

use crate::support::binary::{Scratch, chartwright, code, stderr, stdout};
use crate::support::models::repository;
use chartwright::pipeline::findings::Findings;
use chartwright::pipeline::verify::{Answer, Kind, Options, Question, Status, verify};
use chartwright::verify::{Engine, Limit};
use std::collections::BTreeSet;

/// The snapshots of this file.
pub const SNAPSHOTS: [&str; 10] =
    ["found", "denied", "unknown", "stuck", "any", "needed", "test", "prove", "sentences", "derived"];

fn snapshot(name: &str, text: &str) {
    assert!(SNAPSHOTS.contains(&name), "{name}");
    insta::with_settings!({
        snapshot_path => repository("snapshots/findings"),
        prepend_module_to_snapshot => false,
        omit_expression => true,
    }, {
        insta::assert_snapshot!(name, text);
    });
}

/// Something of every kind.
const KINDS: &str = r#"machine Kinds "something of every kind is found"
cycle 10ms
inputs { Go Stop Hot }
outputs { LAMP HORN }
variables { Spare : BOOL  Count : 0..2 }
actuator Light onoff by LAMP
actuator Horn onoff by HORN
chart C {
  initial state Off
  state On {
    drives LAMP
    drives HORN when Hot and Count < 2
    internal when Go then reset Spare
    internal when Hot and Go then set Spare
  }
  state Lost
  from Off to On when Go
  from Off to Lost when Spare and Hot and not Hot
  from Off to On when Stop then set Count := Count + 1
  from On to Off when not Go and not Stop
}
safety supervisor {
  S1: never (LAMP
     and Hot)     // on two lines
  S2: never HORN and not Go and not Stop
  assume A1: never Go and Stop and Hot
}
properties {
  P1: never in(On) and   not Go   // blanks as they come
  P2: always (in(Off)) or Go
  P3: reachable in(Lost)
  P4: always possible in(Lost)
  P5: after Go eventually in(Off)
  P6: after in(Lost) eventually in(Off)
  P7: reachable LAMP
  P8: never in(Lost)
}
"#;

/// Nothing goes on.
const STUCK: &str = "machine Stuck
cycle 10ms
inputs { Go }
outputs { LAMP }
actuator Light onoff by LAMP
chart C {
  initial state Off
  state On { drives LAMP }
  from Off to On when Go
}
safety supervisor {
  S1: never LAMP and not Go
  assume A1: never LampHot and prev(Go)
}
properties {
  P1: always possible in(Off)
  P2: always eventually in(Off)
}
";

/// What a command says, without the last line, which tells the time.
fn says(model: &str, arguments: &str) -> (i32, String) {
    let directory = Scratch::new(&format!("findings_{}", arguments.replace(|c: char| !c.is_alphanumeric(), "_")));
    directory.write("m.chart", model);
    let output = chartwright(directory.path(), arguments);
    let said = stdout(&output);
    let end = said.trim_end().rfind('\n').map_or(0, |i| i + 1);
    let (rest, last) = said.split_at(end);
    assert!(last.contains(" of memory, ") || last.contains("all others in place"), "{said}");
    (code(&output), rest.to_owned())
}

#[test]
fn each_kind_of_finding_has_its_sentence_and_its_lines() {
    let (exit, said) = says(KINDS, "verify m.chart");
    assert_eq!(exit, 1);
    snapshot("found", &said);
    let (exit, said) = says(KINDS, "verify m.chart --deny all");
    assert_eq!(exit, 1);
    snapshot("denied", &said);
}

#[test]
fn what_nobody_knows_is_asked() {
    let (exit, said) = says(KINDS, "verify m.chart --time 0");
    assert_eq!(exit, 3);
    assert!(said.lines().filter(|l| l.starts_with("open")).all(|l| l.contains('?')), "{said}");
    snapshot("unknown", &said);
}

#[test]
fn what_cannot_go_on_is_said() {
    let text = STUCK.replace("inputs { Go }", "inputs { Go LampHot }");
    let text = text.replace("never LampHot and prev(Go)", "never (LampHot or not LampHot and Go) and prev(Go)");
    let text = text.replace("assume A1", "assume A0: never not Go and prev(Go)\n  assume A1");
    let (exit, said) = says(&text, "verify m.chart");
    assert_eq!(exit, 1);
    snapshot("stuck", &said);
}

#[test]
fn behind_any_program_the_same_words_serve() {
    snapshot("any", &says(KINDS, "verify m.chart --program any").1);
    snapshot("needed", &says(&KINDS.replace("P8:", "P9: never LAMP and Hot\n  P8:"), "verify m.chart --needed").1);
}

#[test]
fn a_test_that_fails_says_what_was_the_case() {
    let directory = Scratch::new("findings_test");
    let text = format!(
        "{STUCK}scenario \"as expected\" {{ set Go wait 3 scans expect LAMP }}
scenario \"never\" {{ never LAMP set Go wait 3 scans }}
scenario \"always\" {{ always not LAMP set Go wait 3 scans }}
scenario \"now\" {{ wait 2 scans expect LAMP \"it shines\" }}
scenario \"within\" {{ wait until LAMP within 3 scans }}
"
    );
    let text = text.replace("  assume A1: never LampHot and prev(Go)\n", "");
    directory.write("m.chart", text);
    let output = chartwright(directory.path(), "test m.chart");
    assert_eq!(code(&output), 1, "{}", stderr(&output));
    snapshot("test", stdout(&output));
}

#[test]
fn a_program_is_proved_refuted_or_neither() {
    let directory = Scratch::new("findings_prove");
    let model = KINDS;
    directory.write("m.chart", model);
    assert_eq!(code(&chartwright(directory.path(), "build m.chart -o m.xml")), 0);
    let xml = directory.read("m.xml");
    directory.write("wrong.xml", xml.replace("<expression>Hot</expression>", "<expression>Stop</expression>"));
    directory.write("wrong.chart", model.replace("when Go\n", "when Go and not Hot\n"));
    directory.write("renamed.xml", xml.replace("X_On", "X_Other"));
    let mut said = String::new();
    for arguments in ["prove m.chart m.xml", "prove wrong.chart m.xml", "prove m.chart renamed.xml"] {
        let output = chartwright(directory.path(), arguments);
        let told = stderr(&output);
        let begin = told.find("error[").unwrap_or(told.len());
        said += &format!("{arguments}: {}\n{}{}\n", code(&output), &told[begin..], stdout(&output));
    }
    snapshot("prove", &said);
}

/// Every sentence that there is, for each answer that a question can have.
#[test]
fn no_two_answers_read_alike() {
    let (verified, _) = verify(KINDS, &Options::default(), &|| false, &mut |_| {});
    let verified = verified.expect("it has no errors");
    let findings = Findings::new(&verified.machine, KINDS);
    let run = verified.answers.iter().find_map(|a| a.run.clone().filter(|r| r.repeats.is_none())).expect("some run");
    let round = verified.answers.iter().find_map(|a| a.run.clone().filter(|r| r.repeats.is_some())).expect("a loop");
    let mut sentences = Vec::new();
    for (i, a) in verified.answers.iter().enumerate() {
        // One of each kind, and every property.
        let seen = |b: &Answer| b.question.word() == a.question.word() && a.question.word() != "property";
        if verified.answers[..i].iter().any(seen) {
            continue;
        }
        for status in [Status::Holds, Status::Violated, Status::Unknown(Limit::Stopped)] {
            let hopes = a.question.hopes_for_a_run(&verified.machine);
            let shown = (status == Status::Holds) == hopes && !matches!(status, Status::Unknown(_));
            let run = match &a.run {
                Some(run) if run.repeats.is_some() => &round,
                _ => &run,
            };
            let run = shown.then(|| run.clone());
            let answer = Answer { question: a.question, demand: true, status, engine: Engine::Exact, run };
            sentences.push(findings.sentence(&answer));
        }
    }
    let distinct: BTreeSet<&String> = sentences.iter().collect();
    assert_eq!(distinct.len(), sentences.len(), "{sentences:#?}");
    assert_eq!(sentences.len(), 3 * (8 + 3 + Kind::ALL.len()));
    snapshot("sentences", &(sentences.join("\n") + "\n"));
}

/// The pairs of transitions of which only the order decides, in words.
fn overlaps(text: &str) -> Vec<String> {
    let (verified, diagnostics) = verify(text, &Options::default(), &|| false, &mut |_| {});
    let verified = verified.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let findings = Findings::new(&verified.machine, text);
    let found = verified.answers.iter().filter(|a| matches!(a.question, Question::Together(..)));
    found.filter(|a| a.status == Status::Violated).map(|a| findings.sentence(a)).collect()
}

/// A machine whose state `A` has two ways out, and what these lead to.
fn ways(first: &str, second: &str) -> String {
    format!(
        "machine Ways cycle 10ms inputs {{ U V W }} outputs {{ LAMP }} actuator Light onoff by LAMP variables {{ X1 : BOOL N1 : 0..3 }} events {{ E }}
         chart C {{
           initial state A {{ drives LAMP {} {} }}
           state B {{ initial state B1 state B2 {{ initial state Deep state Deeper from Deep to Deeper when W }} from B1 to B2 when W }}
           state Flat {{ initial state F1 state F2 from F1 to F2 when W }}
           state Any {{ initial choice Which {{ when W to G1 else to G2 }} state G1 state G2 }}
           parallel state P {{
             region R {{ initial state R1 state R2 from R1 to R2 when W }}
             region Q {{ initial state Q1 state Q2 from Q1 to Q2 when W }}
           }}
           {} {}
           state Z
           from A to Z priority 9 when W and not U and not V
           from Z to B priority 1 when U  from Z to Flat priority 2 when V  from Z to Any priority 3 when W  from Z to P priority 4
           from B to A when U and V  from P to A when U and V  from Flat to A when U and V  from Any to A when U and V
         }}",
        if first.starts_with("internal") { first } else { "" },
        if second.starts_with("internal") { second } else { "" },
        if first.starts_with("from") { first } else { "" },
        if second.starts_with("from") { second } else { "" },
    )
}

#[test]
fn overlaps_are_found_wherever_order_decides() {
    for (first, second) in [
        ("from A to B when U", "from A to P when V"),
        ("from A to B when U", "from A to history of B when V"),
        ("from A to history of B when U", "from A to deep history of B when V"),
        ("from A to B when U", "from A to B.B2 when V"),
        ("from A to P when U", "from A to (P.R.R2, P.Q.Q2) when V"),
        ("from A to (P.R.R2, P.Q.Q1) when U", "from A to (P.R.R1, P.Q.Q2) when V"),
        ("from A to B when U then set X1", "from A to B when V"),
        ("from A to B when U then set X1", "from A to B when V then reset X1"),
        ("from A to B when U then set N1 := N1 + 1", "from A to B when V then set N1 := N1 + 2"),
        ("from A to B when U then raise E", "from A to B when V"),
        ("from A to Any when U", "from A to Any.G1 when V"),
        ("internal when U then set X1", "internal when V then reset X1"),
        ("internal when U then set N1 := 2", "internal when V then set N1 := 1"),
    ] {
        let found = overlaps(&ways(first, second));
        assert_eq!(found.len(), 1, "{first}; {second}: {found:?}");
        let happens = if first.starts_with("internal") { "happen" } else { "enabled" };
        assert!(found[0].starts_with(&format!("both {happens} in scan 2: ")), "{found:?}");
        // One that is never enabled with the other.
        let apart = ways(first, &second.replace(" when V", " when V and not U"));
        assert_eq!(overlaps(&apart), [""; 0], "{first}; {second}");
    }
}

#[test]
fn where_order_makes_no_difference_nothing_is_found() {
    for (first, second) in [
        ("from A to B when U", "from A to B when V"),
        ("from A to B when U", "from A to B.B1 when V"),
        ("from A to P when U", "from A to (P.R.R1, P.Q.Q1) when V"),
        ("from A to (P.R.R2, P.Q.Q2) when U", "from A to (P.Q.Q2, P.R.R2) when V"),
        ("from A to history of B when U", "from A to history of B when V"),
        ("from A to history of Flat when U", "from A to deep history of Flat when V"),
        ("from A to Any when U", "from A to Any when V"),
        ("from A to B when U then set X1, raise E", "from A to B when V then raise E, set X1"),
        ("from A to B when U", "from A to P priority 1 when V"),
        ("internal when U then set X1, set N1 := 1", "internal when V then set N1 := 1, set X1"),
        ("internal when U then set X1", "internal when V then set N1 := 1"),
        ("internal when U then set X1", "from A to B when V then reset X1"),
    ] {
        assert_eq!(overlaps(&ways(first, second)), [""; 0], "{first}; {second}");
    }
    // A third one comes before both: between them order decides nothing.
    let third = ways("from A to B when U", "from A to P when U from A to Flat priority 1 when U");
    assert_eq!(overlaps(&third), [""; 0]);
}

#[test]
fn overlaps_of_observers_are_found_before_and_after_the_filter() {
    let text = |ways: &str| {
        format!(
            "machine O cycle 10ms inputs {{ U V }} outputs {{ LAMP }} actuator Light onoff by LAMP
             observer Seen {{ initial state Free state Once state Twice
               from Once to Free when U  from Twice to Free when U
               {ways}
             }}
             chart C {{ initial state A {{ drives LAMP when U }} }}"
        )
    };
    let late = text("after filter { from Free to Once when U and LAMP  from Free to Twice when V and LAMP }");
    let found = "Free to Once (line 4) and Free to Twice (line 4); the first one fires";
    assert_eq!(overlaps(&late), [format!("both enabled in scan 1: {found}")]);
    let early = text("from Free to Once when U and prev(LAMP)  from Free to Twice when V and prev(LAMP)");
    assert_eq!(overlaps(&early), [format!("both enabled in scan 2: {found}")]);
}

#[test]
fn what_denies_overlaps_fails_by_effects_and_histories() {
    let directory = Scratch::new("findings_deny");
    for (first, second, exit) in [
        ("from A to B when U then set X1", "from A to B when V", 1),
        ("from A to B when U", "from A to history of B when V", 1),
        ("internal when U then set X1", "internal when V then reset X1", 1),
        ("from A to B when U", "from A to B when V", 0),
    ] {
        directory.write("m.chart", ways(first, second));
        let output = chartwright(directory.path(), "verify m.chart --deny overlap");
        assert_eq!(code(&output), exit, "{first}; {second}: {}", stderr(&output));
    }
}

#[test]
fn transitions_of_one_name_are_told_apart() {
    let text = "machine Two cycle 10ms inputs { U V W } variables { X1 : BOOL }
        chart C {
          initial state A
          state B
          choice Way { when U to B when V then set X1 to B else to A }
          from A to B when W from A to B when W and V then set X1
          from A to Way when U and not W
          from B to A
        }";
    let text = text.replace("when V then set X1 to B", "when V to B then set X1");
    let (verified, diagnostics) = verify(&text, &Options::default(), &|| false, &mut |_| {});
    let verified = verified.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let findings = Findings::new(&verified.machine, &text);
    let said: Vec<String> = verified.answers.iter().map(|a| findings.sentence(a)).collect();
    let distinct: BTreeSet<&String> = said.iter().collect();
    assert_eq!(distinct.len(), said.len(), "{said:#?}");
    let found =
        "both enabled in scan 2: A to B (line 6, column 11) and A to B (line 6, column 30); the first one fires";
    assert!(said.iter().any(|s| s == found), "{said:#?}");
    assert!(said.iter().any(|s| s.ends_with("A to B by way 2 of 2 (line 7)")), "{said:#?}");
}

#[test]
fn json_has_the_kind_the_places_and_the_verdict() {
    let directory = Scratch::new("findings_json");
    directory.write("m.chart", KINDS);
    let output = chartwright(directory.path(), "verify m.chart --format json");
    let json: serde_json::Value = serde_json::from_str(stdout(&output)).expect("it is JSON");
    let answers = json["answers"].as_array().expect("there are answers");
    let silent: Vec<_> = answers.iter().filter(|a| a["kind"] == "silent" && a["verdict"] == "found").collect();
    let [silent] = silent[..] else { panic!("{silent:?}") };
    assert_eq!(silent["says"], "never fires: Off to Lost (line 18)");
    assert_eq!(silent["places"], serde_json::json!([{ "name": "Off to Lost", "line": 18, "column": 3 }]));
    let overlap = answers.iter().find(|a| a["kind"] == "overlap" && a["verdict"] == "found").expect("there is one");
    assert_eq!(overlap["places"].as_array().map(Vec::len), Some(2), "{overlap}");
    let kinds: BTreeSet<&str> = answers.iter().filter_map(|a| a["kind"].as_str()).collect();
    let all = [
        "acts",
        "assumptions",
        "constraint",
        "moves",
        "overlap",
        "property",
        "saturates",
        "silent",
        "unreachable",
        "void",
    ];
    assert_eq!(kinds, BTreeSet::from(all));
    let demands = ["property", "constraint", "assumptions", "moves"];
    for answer in answers {
        let (kind, verdict) = (answer["kind"].as_str().unwrap(), answer["verdict"].as_str().unwrap());
        let may = if demands.contains(&kind) { ["holds", "violated"] } else { ["absent", "found"] };
        assert!(may.contains(&verdict), "{answer}");
    }
    assert!(json["situations"].is_string());
}

/// The model with these lines among its properties.
fn with(lines: &str) -> String {
    KINDS.replace("  P8: never in(Lost)\n", &format!("  P8: never in(Lost)\n{lines}"))
}

const ACCEPTED: &str = r#"  accept unreachable Lost "kept for later"
  accept silent from Off to Lost "so is the way there"
  accept overlap from Off to On number 1 and from Off to On number 2 "who starts first counts nothing"
  accept overlap internal of On number 2 and internal of On number 1 "Spare means nothing"
  accept saturates Count "it counts to two"
  accept acts S1 "that is what it is for"
  accept void P6 "Lost is for later"
"#;

#[test]
fn what_is_accepted_is_counted_and_denied_no_more() {
    let directory = Scratch::new("findings_accepted");
    let demands = ["P1", "P2", "P3", "P4", "P5"];
    let kept = |text: &str| {
        let lines = text.lines().filter(|l| !demands.iter().any(|p| l.trim_start().starts_with(&format!("{p}:"))));
        lines.collect::<Vec<_>>().join("\n")
    };
    directory.write("m.chart", kept(&with(ACCEPTED)));
    let output = chartwright(directory.path(), "verify m.chart --deny all");
    let said = stdout(&output);
    assert_eq!(code(&output), 0, "{said}{}", stderr(&output));
    assert!(said.contains("\n7 accepted\n") && !said.contains("found  ") && !said.contains("stale"), "{said}");
    let output = chartwright(directory.path(), "verify m.chart --format json");
    let json: serde_json::Value = serde_json::from_str(stdout(&output)).expect("it is JSON");
    let fates: Vec<&str> = json["accepted"].as_array().unwrap().iter().filter_map(|a| a["fate"].as_str()).collect();
    assert_eq!(fates, ["accepted"; 7]);
    let accepted = json["answers"].as_array().unwrap().iter().filter(|a| a["verdict"] == "accepted").count();
    assert_eq!(accepted, 7);
    // One fewer, and that one is told again.
    directory.write("m.chart", kept(&with(&ACCEPTED.replace("  accept saturates Count \"it counts to two\"\n", ""))));
    let output = chartwright(directory.path(), "verify m.chart --deny all");
    assert_eq!(code(&output), 1);
    assert!(stdout(&output).contains("denied    assigned beyond 0..2") && stdout(&output).contains("\n6 accepted\n"));
}

#[test]
fn what_is_accepted_and_not_found_any_more_is_stale() {
    let directory = Scratch::new("findings_stale");
    let text = with("  accept silent from Off to Lost \"once\"\n").replace("and Hot and not Hot", "and Hot");
    directory.write("m.chart", text);
    let output = chartwright(directory.path(), "verify m.chart");
    let said = stdout(&output);
    assert!(said.contains("stale     accept silent from Off to Lost (line 37): fires in scan "), "{said}");
    assert!(!said.contains("accepted"), "{said}");
    // Behind any program nobody asks for transitions.
    let output = chartwright(directory.path(), "verify m.chart --program any");
    assert!(!stdout(&output).contains("stale"), "{}", stdout(&output));
    let clean = STUCK.replace("  assume A1: never LampHot and prev(Go)\n", "").replace(
        "  P1: always possible in(Off)\n  P2: always eventually in(Off)\n",
        "  P1: never LAMP and not Go\n  accept acts S1 \"not so\"\n",
    );
    directory.write(
        "s.chart",
        clean.replace("  from Off to On when Go\n", "  from Off to On when Go\n  from On to Off when not Go\n"),
    );
    assert_eq!(code(&chartwright(directory.path(), "verify s.chart")), 0);
    let output = chartwright(directory.path(), "verify s.chart --deny stale");
    assert_eq!(code(&output), 1, "{}", stdout(&output));
}

#[test]
fn what_cannot_be_accepted_is_refused() {
    for (line, says) in [
        ("accept silent from Off to On \"x\"", "2 transitions have these ends"),
        ("accept silent from Off to On number 3 \"x\"", "2 transitions have these ends"),
        ("accept silent from Lost to On \"x\"", "no transition with these ends"),
        ("accept silent internal of Off \"x\"", "no transition with these ends"),
        ("accept overlap from Off to Lost and from On to Off \"x\"", "only two transitions of one source"),
        ("accept overlap from Off to Lost and from Off to Lost \"x\"", "only two transitions of one source"),
        ("accept unreachable Nowhere \"x\"", "Nowhere"),
        ("accept saturates Spare \"x\"", "not an integer"),
        ("accept acts S9 \"x\"", "there is no constraint `S9`"),
        ("accept void P1 \"x\"", "waits for nothing to come"),
        ("accept void P9 \"x\"", "there is no property `P9`"),
        ("accept acts S1 \"x\" accept acts S1 \"y\"", "accepted more than once"),
    ] {
        let (machine, diagnostics) = chartwright::pipeline::check(&with(&format!("  {line}\n")));
        assert!(machine.is_none(), "{line}");
        assert!(diagnostics.iter().any(|d| d.message.contains(says)), "{line}: {diagnostics:#?}");
    }
    // A reason is not left out.
    let (machine, diagnostics) = chartwright::pipeline::check(&with("  accept acts S1\n"));
    assert!(machine.is_none() && diagnostics.iter().any(|d| d.message.contains("text") || !d.labels.is_empty()));
    // Names that begin like it are names.
    assert!(chartwright::pipeline::check(&with("  accept: never HORN and not LAMP\n")).0.is_some());
}

#[test]
fn properties_and_scenarios_ask_for_the_past_of_a_state() {
    let text = |plant: &str, properties: &str, lines: &str| {
        format!(
            "machine Past cycle 10ms inputs {{ Push }} outputs {{ LAMP }} actuator Light onoff by LAMP
             chart Lamp {{ initial state Dark state Lit {{ drives LAMP }} from Dark to Lit when Push from Lit to Dark when not Push }}
             properties {{ {properties} }} {plant}
             scenario \"by hand\" {{ wait 1 scan expect rise(in(Dark)) and not prev(in(Dark))
               set Push wait 1 scan expect rise(in(Lit)) and fall(in(Dark)) and prev(in(Dark)) {lines}
               wait 1 scan expect prev(in(Lit)) and not rise(in(Lit)) }}"
        )
    };
    for plant in ["", "plant by steps { hidden Seen step \"seen\" when LAMP then set Seen }"] {
        for (property, wanted) in [
            ("never rise(in(Lit)) and not Push", Status::Holds),
            ("never in(Lit) and prev(in(Dark)) and not Push", Status::Holds),
            ("never fall(in(Lit)) and Push", Status::Holds),
            ("never rise(in(Dark)) and prev(in(Dark))", Status::Holds),
            ("never in(Lit) and prev(in(Lit))", Status::Violated),
            ("never fall(in(Lit))", Status::Violated),
            ("reachable rise(in(Lit)) and fall(in(Dark))", Status::Holds),
            ("reachable rise(in(Dark)) and prev(in(Lit))", Status::Holds),
        ] {
            let source = text(plant, &format!("P1: {property}"), "");
            let (verified, diagnostics) = verify(&source, &Options::default(), &|| false, &mut |_| {});
            let verified = verified.unwrap_or_else(|| panic!("{diagnostics:?}"));
            let answer = &verified.answers[0];
            assert_eq!(answer.status, wanted, "{plant} {property}");
            if let Some(run) = &answer.run {
                assert_eq!(run.replayed, Some(true), "{plant} {property}");
            }
        }
        let directory = Scratch::new(&format!("findings_past_{}", plant.len()));
        directory.write("m.chart", text(plant, "P1: never rise(in(Lit)) and not Push", ""));
        let output = chartwright(directory.path(), "test m.chart");
        assert_eq!(code(&output), 0, "{}{}", stdout(&output), stderr(&output));
        directory.write("m.chart", text(plant, "P1: never rise(in(Lit)) and not Push", "expect prev(in(Lit))"));
        assert_eq!(code(&chartwright(directory.path(), "test m.chart")), 1);
    }
    // The program does not remember it.
    let guard = text("", "P1: never LAMP", "").replace("when not Push", "when rise(in(Lit))");
    assert!(chartwright::pipeline::check(&guard).0.is_none());
}

/// What is derived, and conditions that are no products.
const DERIVED: &str = r#"machine Derived
cycle 10ms
inputs { Up Down Go Way }
outputs { LIFT LOWER LAMP HORN }
actuator Arm bistable valve memory {
  position Top    output LIFT  sensor Up
  position Bottom output LOWER sensor not (Down or Up)
}
actuator Light onoff by LAMP
actuator Horn onoff by HORN
chart C {
  initial state Off { drives LIFT when Way  drives LOWER when Go and not Way }
  state On { drives LAMP  drives HORN }
  from Off to On when Go and Way
  from On to Off when not Go
}
safety controller {
  S1: never LAMP and   // either way
    (HORN xor Go) yields LAMP
  assume A1: never (Up and Down) or (Go and Up)
  derive Arm
}
properties { P1: never LAMP   and (HORN // on two lines
  or Go) }
scenario "as written" { expect LAMP   // not yet
  or HORN }
"#;

#[test]
fn conditions_are_shown_as_they_are_written_everywhere() {
    let directory = Scratch::new("findings_derived");
    directory.write("m.chart", DERIVED.replace("scenario \"as written\" {", "scenario \"as written\" { wait 1 scan"));
    let mut text = String::new();
    for (arguments, expected) in [
        ("verify m.chart --engine exact", 1),
        ("constraints m.chart", 0),
        ("constraints m.chart --derive", 0),
        ("test m.chart", 1),
    ] {
        let output = chartwright(directory.path(), arguments);
        assert_eq!(code(&output), expected, "{arguments}: {}", stderr(&output));
        // How long it took, and how large it was, is nobody's wording.
        let lines = stdout(&output).lines().filter(|l| !l.contains("bits of memory"));
        text += &format!("== {arguments}\n{}\n", lines.collect::<Vec<_>>().join("\n"));
    }
    snapshot("derived", &text);
}

/// An oven with three warnings, and what is accepted of it.
fn oven(properties: &str) -> String {
    format!(
        "machine Oven inputs {{ Start Spare }} outputs {{ HEAT FAN BELL }}
         actuator Heater onoff by HEAT actuator Blower onoff by FAN actuator Bell onoff by BELL
         chart Oven {{ initial state Off  state On {{ drives HEAT  drives FAN }}  from Off to On when Start  from On to Off when not Start }}
         safety supervisor {{
           C1: never HEAT and not FAN yields HEAT
           C2: never FAN and not HEAT yields FAN
           C3: never HEAT and not Start
         }}
         plant {{ hidden Sooty }}
         properties {{ {properties} }}"
    )
}

fn codes(source: &str) -> Vec<&'static str> {
    let mut codes: Vec<_> = chartwright::pipeline::check(source).1.iter().map(|d| d.code.number()).collect();
    codes.sort_unstable();
    codes
}

#[test]
fn warnings_are_accepted_by_what_they_speak_of() {
    let all = "accept unused Spare \"a\" accept unused BELL \"b\" accept cyclic C2, C1 \"c\"";
    for (properties, expected) in [
        ("", &["W501", "W502", "W503"][..]),
        (all, &[]),
        ("accept unused spare \"case means nothing\"", &["W501", "W503"]),
        ("accept unused BELL \"b\"", &["W502", "W503"]),
        // Of no more and no fewer constraints.
        ("accept cyclic C1 \"c\"", &["W501", "W502", "W503", "W504"]),
        ("accept cyclic C1, C2, C3 \"c\"", &["W501", "W502", "W503", "W504"]),
        // What is used.
        ("accept unused HEAT \"b\"", &["W501", "W502", "W503", "W504"]),
        ("accept unused Spare \"a\" accept unused SPARE \"again\"", &["E010"]),
        ("accept cyclic C1, C2 \"c\" accept cyclic C2, C1 \"again\"", &["E010"]),
        ("accept unused Nothing \"a\"", &["E104"]),
        ("accept cyclic C1, C9 \"c\"", &["E104"]),
        ("accept unused Sooty \"no part of the program\"", &["E106"]),
        ("accept unused Heater \"no signal\"", &["E104"]),
    ] {
        assert_eq!(codes(&oven(properties)), expected, "{properties}");
    }
    // In every command, and an error where that is asked for.
    let (exit, _) = says(&oven(all), "verify m.chart --deny stale");
    assert_eq!(exit, 0);
    let (exit, _) = says(&oven("accept unused HEAT \"b\""), "verify m.chart --deny stale");
    assert_eq!(exit, 1);
    let (exit, _) = says(&oven("accept unused HEAT \"b\""), "verify m.chart");
    assert_eq!(exit, 0);
    // Without one of them the others are no cycle, and nobody said that they were.
    let (machine, diagnostics) = chartwright::pipeline::without::check(&oven(all), &["C1".to_owned()]);
    assert!(machine.is_some() && diagnostics.is_empty(), "{diagnostics:?}");
}

#[test]
fn the_model_that_shows_acceptances_has_nothing_else_to_be_told() {
    let output = chartwright(&repository("models"), "verify accepted.chart --deny all --time 60");
    let said = stdout(&output);
    assert_eq!(code(&output), 0, "{said}{}", stderr(&output));
    assert!(stderr(&output).contains("no errors, no warnings"), "{}", stderr(&output));
    assert!(said.contains("\n7 accepted\n"), "{said}");
    let words = ["found", "denied", "stale", "open", "violated"];
    assert!(!said.lines().any(|line| words.iter().any(|word| line.starts_with(word))), "{said}");
    // Each kind of finding and of warning is there.
    let model = std::fs::read_to_string(repository("models/accepted.chart")).expect("the model is there");
    for kind in ["unreachable", "silent", "overlap", "saturates", "acts", "void", "unused", "cyclic"] {
        assert!(model.contains(&format!("accept {kind} ")), "{kind}");
    }
}
