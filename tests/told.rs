//! Plants that go by steps, and scenarios that tell them: what happens, when, and what is seen of it.

use crate::support::binary::{Scratch, chartwright, code, stdout};
use crate::support::models;
use chartwright::base::{Code, Severity};
use chartwright::pipeline;
use chartwright::pipeline::verify::{Options, Program, Question, Status, Verified, verify};
use chartwright::simulate::scenario::{Expectation, Failure, play};

/// A cylinder without constraints, and a scenario with these lines.
fn cylinder(lines: &str) -> String {
    format!(
        "machine Cylinder cycle 10ms
         inputs {{ B H Go Pin }} outputs {{ O }}
         actuator Rod monostable {{ position In sensor B  position Out output O sensor H }}
         chart Push {{
           initial state In  state Out {{ drives O }}
           from In to Out when Go
           from Out to In when not Go
         }}
         plant by steps {{
           hidden Stroke : 0..4
           hidden Seen hidden Valve hidden Guest
           initially {{ any Guest }}
           step \"out\" when O and Stroke < 4 and not Pin then set Stroke := Stroke + 1
           step \"in\" when not O and Stroke > 0 then set Stroke := Stroke - 1
           Valve rises when O
           Valve falls when not O
           Seen rises when Stroke > 0
           B follows Stroke = 0
           H follows Stroke = 4
         }}
         scenario \"out by itself\" {{ set Go wait until H within 6 scans }}
         scenario \"it\" {{ {lines} }}
         scenario \"later\" after \"out by itself\" {{ {lines} }}"
    )
}

/// How a scenario of the text goes; the same for all programs.
fn outcome(text: &str, name: &str) -> Option<Failure> {
    let (machine, diagnostics) = pipeline::check(text);
    let machine = machine.unwrap_or_else(|| panic!("{text}: {diagnostics:#?}"));
    let index = machine.scenarios.iter().rposition(|s| s.name == name).expect("the scenario is there");
    let played = pipeline::programs(&machine).into_iter();
    let mut failures: Vec<_> =
        played.map(|(_, program)| play(&machine, program, index, &mut |_, _| {}).failure).collect();
    assert!(failures.iter().all(|f| *f == failures[0]), "{failures:#?}");
    failures.swap_remove(0)
}

/// What goes wrong, in or after which scan, and whether after it.
fn fails(lines: &str) -> Option<(Expectation, u64, bool)> {
    outcome(&cylinder(lines), "it").map(|f| (f.kind, f.scan, f.between))
}

#[test]
fn nothing_happens_but_what_is_told() {
    assert_eq!(fails("set Go wait 5 scans expect Stroke = 3"), None, "by itself it moves");
    assert_eq!(fails("set Go happens nothing wait 5 scans expect Stroke = 0 and B"), None);
    assert_eq!(fails("set Go wait 5 scans repeat 1 { happens nothing } expect Stroke = 0"), None, "wherever it stands");
    let twice = "set Go wait 2 scans happens \"out\" happens \"out\"";
    assert_eq!(fails(&format!("{twice} expect Stroke = 2 and B wait 9 scans expect Stroke = 2 and not B")), None);
    // What was played before goes by itself, and the told one goes on from there.
    let later = outcome(&cylinder("reset Go wait 1 scan happens \"in\" wait 5 scans expect Stroke = 3"), "later");
    assert_eq!(later, None);
}

#[test]
fn what_cannot_happen_fails() {
    assert_eq!(fails("happens \"out\""), Some((Expectation::Happens, 0, true)), "nothing is written yet");
    assert_eq!(fails("wait 2 scans happens \"out\""), Some((Expectation::Happens, 2, true)));
    let out = "set Go wait 2 scans";
    assert_eq!(fails(&format!("{out} repeat 5 {{ happens \"out\" }}")), Some((Expectation::Happens, 2, true)));
    // Steps read inputs of operators as they are by then.
    assert_eq!(fails(&format!("{out} set Pin happens \"out\"")), Some((Expectation::Happens, 2, true)));
}

#[test]
fn before_writing_the_old_outputs_stand() {
    let before = "set Go wait 2 scans happens \"out\" before writing";
    assert_eq!(fails(before), Some((Expectation::Happens, 2, true)), "the order is not out yet");
    let back = "set Go wait 2 scans happens \"out\" reset Go wait 1 scan expect not O";
    assert_eq!(fails(&format!("{back} happens \"out\" before writing happens \"in\" expect Stroke = 1")), None);
    assert_eq!(fails(&format!("{back} happens \"out\"")), Some((Expectation::Happens, 3, true)));
    let late = format!("{back} happens \"in\" happens \"out\" before writing");
    assert_eq!(fails(&late), Some((Expectation::BeforeWriting, 3, true)));
    assert_eq!(fails("happens \"out\" before writing"), Some((Expectation::BeforeWriting, 0, false)));
    // Valves follow when outputs are written, and not before.
    assert_eq!(fails("set Go wait 2 scans expect O and not Valve happens \"out\" expect Valve"), None);
}

#[test]
fn what_is_never_so_is_looked_at_between_scans() {
    let out = "set Go wait 2 scans happens \"out\" happens \"out\" wait 1 scan";
    assert_eq!(fails(&format!("never Stroke = 1 {out}")), Some((Expectation::Never, 2, true)));
    assert_eq!(fails(&format!("never Stroke = 1 and O {out}")), Some((Expectation::Never, 2, true)));
    assert_eq!(fails(&format!("never Stroke = 2 and not B {out}")), Some((Expectation::Never, 3, false)));
    assert_eq!(fails(&format!("always Stroke = 0 or Valve {out}")), None);
    assert_eq!(fails(&format!("never Valve {out}")), Some((Expectation::Never, 2, true)), "at the writing");
    // What reads how it came to that has to wait for a scan.
    assert_eq!(fails(&format!("never Stroke = 1 and not prev(Go) {out}")), None);
    // By itself it goes through each place.
    assert_eq!(fails("never Stroke = 2 set Go wait 5 scans"), Some((Expectation::Never, 3, true)));
    // From the next moment on, and nothing has changed until then.
    assert_eq!(fails("set Go wait 2 scans happens \"out\" wait 1 scan never Stroke = 1 happens \"out\""), None);
}

#[test]
fn a_text_has_to_be_that_of_one_step() {
    let code = |text: &str| {
        let (_, diagnostics) = pipeline::check(text);
        diagnostics.iter().filter(|d| d.severity() == Severity::Error).map(|d| d.code).collect::<Vec<_>>()
    };
    assert_eq!(code(&cylinder("happens \"Out\"")), [Code::BadHappening; 2]);
    assert_eq!(code(&cylinder("happens \"in\"").replace("\"out\" when", "\"in\" when")), [Code::BadHappening; 2]);
    let timed = "machine M cycle 10ms inputs { A } outputs { O } actuator L onoff by O
        chart C { initial state S { drives O when A } }
        scenario \"it\" { happens nothing }";
    assert_eq!(code(timed), [Code::BadHappening]);
}

// ---- What verification finds ------------------------------------------------------------------------

fn model(name: &str) -> String {
    models::all().into_iter().find(|m| m.name == name).expect("the model is there").source
}

/// The text without the constraints of these names.
fn without(text: &str, names: &[&str]) -> String {
    let dropped = |l: &&str| l.split_once(": never").is_some_and(|(name, _)| names.contains(&name.trim()));
    let kept: Vec<&str> = text.lines().filter(|l| !dropped(l)).collect();
    assert_eq!(kept.len() + names.len(), text.lines().count(), "each is dropped");
    kept.join("\n")
}

fn ask(text: &str, program: Program) -> Verified {
    let options = Options { program, ..Options::default() };
    let (verified, diagnostics) = verify(text, &options, &|| false, &mut |_| {});
    verified.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

/// Asserts that properties of the text are violated, each by a run that the simulators play to the very moment. Returns how
/// many runs end between two scans.
fn plays(text: &str) -> usize {
    let verified = ask(text, Program::Chart);
    let (mut violated, mut between) = (0, 0);
    for answer in verified.answers.iter().filter(|a| a.status == Status::Violated) {
        let (Question::Declared(_), Some(run)) = (answer.question, &answer.run) else { continue };
        assert_eq!(run.replayed, Some(true), "{}", run.scenario);
        let name = run.scenario.split('"').nth(1).expect("it has a name");
        if !run.scenario.contains("\n  never ") && !run.scenario.contains("\n  always ") {
            continue;
        }
        let failure = outcome(&format!("{text}\n{}", run.scenario), name);
        let failure = failure.unwrap_or_else(|| panic!("it passes: {}", run.scenario));
        assert!(matches!(failure.kind, Expectation::Never | Expectation::Always), "{failure:?}: {}", run.scenario);
        let ends_between = !run.end().starts_with("in scan");
        assert_eq!((failure.scan, failure.between), (run.frames.len() as u64, ends_between), "{}", run.scenario);
        violated += 1;
        between += usize::from(ends_between);
    }
    assert!(violated > 0, "something is violated");
    between
}

#[test]
fn what_is_violated_fails_in_the_simulators_at_the_same_moment() {
    let claims = "properties {
        P1: never Stroke = 3 and Guest
        P2: never Stroke = 2 and B
        P3: never Seen and Stroke = 0 and not B
        P4: never Valve and Stroke = 1 and Pin
        P5: always Stroke < 4 or not H
        P6: never rise(Go) and Stroke = 4
        P7: never not O and Stroke = 4 and prev(H)
        }\n scenario \"out by";
    let text = cylinder("wait 1 scan").replacen("scenario \"out by", claims, 1);
    assert!(plays(&text) >= 4);
}

#[test]
fn machines_that_lack_a_constraint_fail_in_the_simulators_at_the_same_moment() {
    assert!(plays(&without(&model("carts"), &["Z1", "Z2", "Q1", "Q2", "C1", "C2", "C3", "C4"])) > 0);
    assert!(plays(&without(&model("four_cylinders"), &["CS2", "CS3", "CS4"])) > 0);
    plays(&model("prehensor").replace("derive all", "derive all except F1_Go_in, F1_Go_out"));
}

#[test]
fn a_counterexample_shows_what_happens_between_scans_of_their_number_and_time() {
    let d = Scratch::new("told");
    let text =
        cylinder("wait 1 scan").replacen("scenario \"out", "properties { P: never Stroke = 2 }\n scenario \"out", 1);
    d.write("cylinder.chart", &text);
    let output = chartwright(d.path(), "verify cylinder.chart --scenario found.chart --vcd run.vcd");
    let shown = stdout(&output);
    let squeezed = shown.split_whitespace().collect::<Vec<_>>().join(" ");
    for says in [
        "P (line 21): never Stroke = 2; the condition is TRUE after scan 2",
        "2 0.010 s +Go +O -In +Out | outputs are written: +Valve | out: Stroke=1 | out: Stroke=2",
        "Active in scan 2:",
    ] {
        assert!(squeezed.contains(says), "{says}: {shown}");
    }
    let vcd = std::fs::read_to_string(d.path().join("run.vcd")).expect("it is written");
    assert!(vcd.contains("$timescale 1 us") && vcd.lines().any(|l| l == "#12500"), "{vcd}");
    let scenario = std::fs::read_to_string(d.path().join("found.chart")).expect("it is written");
    d.write("with.chart", format!("{text}\n{scenario}"));
    let output = chartwright(d.path(), "test with.chart --filter found");
    let said = stdout(&output);
    assert_eq!(code(&output), 1, "{said}");
    assert!(said.contains("the condition is TRUE after scan 2, 0.010 s") && said.contains("out: Stroke=2"), "{said}");
    let output = chartwright(d.path(), "verify cylinder.chart --format json");
    let json = stdout(&output);
    assert!(json.contains("\"between\"") && json.contains("\"happens\""), "{json}");
    // Of another program nobody knows the outputs, and its scans are counted all the same.
    let verified = ask(&text, Program::Any);
    let run = verified.answers[0].run.as_ref().expect("it is violated");
    assert_eq!((run.end().as_str(), run.replayed), ("after scan 1", None));
    assert!(!run.scenario.contains("happens"), "{}", run.scenario);
}
