//! What is shown of a program that does something else than its chart, to the letter.

use crate::support::proof::build;
use chartwright::emit::Dialect::Beremiz;
use chartwright::prove::parts::Part;
use chartwright::prove::search::Effort;
use chartwright::prove::{Correspondence, Verdict, equivalence_within};
use chartwright::read;

const MODEL: &str = "machine Gate
cycle 10ms
inputs { Open at %IX0.0 Shut at %IX0.1 }
outputs { MOTOR at %QX0.0 LAMP at %QX0.1 }
variables { Count : 0..3 }
actuator Motor onoff by MOTOR
actuator Lamp onoff by LAMP
chart Gate {
  initial state Closed
  state Moving { drives MOTOR }
  state Waiting { drives LAMP }
  from Closed to Moving when Open and Count < 3 then set Count := Count + 1
  from Moving to Waiting when Shut
  from Waiting to Closed when after 50ms
}
";

/// What is said of the program of the model after these replacements.
fn said(changes: &[(&str, &str)]) -> String {
    said_of(MODEL, changes)
}

fn said_of(model: &str, changes: &[(&str, &str)]) -> String {
    let output = build(model, Beremiz).unwrap_or_else(|e| panic!("{e}"));
    let text = changes.iter().fold(output.xml.clone(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    });
    let (program, diagnostics) = read::read(&text);
    let program = program.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let names = Correspondence::of(&output.machine, &output.project);
    match equivalence_within(&output.machine, &names, &program, Effort::FIRST) {
        Verdict::Proved(statistics) if statistics.history > 0 => format!("proved, {} scans back", statistics.history),
        Verdict::Proved(_) => "proved".to_owned(),
        Verdict::Refuted(trace) => {
            let differences = trace.differences();
            assert!(!differences.is_empty());
            for (i, compared) in trace.compared.iter().enumerate() {
                let last = trace.scans.last().expect("a scan");
                let begins = matches!(compared.part, Part::Begins(_));
                let differs = !begins && last.chart[i] != last.program[i];
                assert_eq!(differences.contains(&i), differs, "{}", compared.what);
            }
            trace.to_string()
        }
        Verdict::Unknown(doubt) => doubt.to_string(),
    }
}

/// What is said if one more program runs after all others.
fn beside(text: &str) -> String {
    let [pou, instance] = one_more(r#"<variable name="N"><type><INT/></type></variable>"#, "", text);
    said(&[("<pous>", &pou), (LAST, &instance)])
}

const LAST: &str = r#"<pouInstance name="I_Filter" typeName="Filter"/>"#;

/// A program with variables of its own that knows the lamp and another variable, and its instance, to be put in.
fn one_more(own: &str, other: &str, text: &str) -> [String; 2] {
    let known = r#"<variable name="LAMP"><type><BOOL/></type></variable>"#;
    let variables = format!("<localVars>{own}</localVars><externalVars>{known}{other}</externalVars>");
    let pou = format!(
        r#"<pous><pou name="Evil" pouType="program"><interface>{variables}</interface><body><ST><xhtml:p>{text}</xhtml:p></ST></body></pou>"#
    );
    [pou, format!(r#"{LAST}<pouInstance name="I_E" typeName="Evil"/>"#)]
}

#[test]
fn a_run_shows_what_changes_and_what_differs() {
    assert_eq!(
        beside("N := N + 1; LAMP := LAMP OR N = 3;"),
        "scan                   chart  program\n   \
           1  state Closed     on     on\n   \
           2  nothing changes\n   \
           3  output LAMP      off    on  <- LAMP\n"
    );
}

#[test]
fn a_run_shows_numbers() {
    assert_eq!(
        said(&[("<expression>1</expression>", "<expression>2</expression>")]),
        "scan                    chart  program\n   \
           1  input Open        on\n      \
               state Closed      on     on\n   \
           2  state Closed      off    off\n      \
               state Moving      on     on\n      \
               output MOTOR      on     on\n      \
               command of MOTOR  on     on\n      \
               integer Count     1      2  <- Count\n"
    );
}

#[test]
fn a_run_shows_times() {
    assert_eq!(
        said(&[("T#50ms", "T#60ms")]),
        "scan                             chart  program\n   \
           1  input Open                 on\n      \
               input Shut                 on\n      \
               state Closed               on     on\n   \
           2  state Closed               off    off\n      \
               state Moving               on     on\n      \
               output MOTOR               on     on\n      \
               command of MOTOR           on     on\n      \
               integer Count              1      1\n   \
           3  state Moving               off    off\n      \
               state Waiting              on     on\n      \
               output MOTOR               off    off\n      \
               output LAMP                on     on\n      \
               command of MOTOR           off    off\n      \
               command of LAMP            on     on\n   \
           4  nothing changes\n   \
           5  50 ms after the last scan\n      \
               state Closed               on     off  <- X_Closed\n      \
               state Waiting              off    on  <- X_Waiting\n      \
               output LAMP                off    on  <- LAMP\n      \
               command of LAMP            off    on  <- Cmd_LAMP\n      \
               state Closed               on     off  <- Prg_Gate.S_Closed.X\n      \
               state Waiting              off    on  <- Prg_Gate.S_Waiting.X\n"
    );
}

#[test]
fn what_lies_too_deep_is_neither_proved_nor_refuted() {
    // The run that shows it has 30,000 scans.
    assert_eq!(
        beside("N := N + 1; LAMP := LAMP OR N = 30000;"),
        "it is not so that LAMP in the program is output LAMP after a scan that begins with in(Closed), Count = 2, and nobody \
         knows whether a run comes to that"
    );
}

#[test]
fn what_changes_nothing_is_proved() {
    assert_eq!(said(&[]), "proved");
    assert_eq!(beside("N := 2 + 3; LAMP := LAMP OR N &lt;&gt; N;"), "proved");
}

#[test]
fn a_sum_that_may_leave_its_type_is_not_proved() {
    for text in ["N := N + 1; LAMP := LAMP OR N &lt;&gt; N;", "N := N - 1; LAMP := LAMP OR N &lt;&gt; N;"] {
        assert_eq!(beside(text), "a sum may leave its type, where tools differ: what N becomes");
    }
    // In 16 bits the one is less than 0, in 32 it is not.
    let said = beside("N := 32767; LAMP := LAMP OR (N + 1 &lt; 0);");
    assert!(said.starts_with("a sum may leave its type, where tools differ: "), "{said}");
    assert_eq!(beside("N := 32766; LAMP := LAMP OR (N + 1 &lt; 0);"), "proved");
}

fn variable(name: &str, begins: bool) -> String {
    let initial = if begins { r#"<initialValue><simpleValue value="TRUE"/></initialValue>"# } else { "" };
    format!(r#"<variable name="{name}"><type><BOOL/></type>{initial}</variable>"#)
}

#[test]
fn what_a_timer_holds_outside_its_state_is_what_it_held_there() {
    // The program keeps an input of two scans ago twice, so the proof looks one scan back, and the first scan in which
    // the timer counts is among those that begin it.
    let model = MODEL.replacen("  from Closed", "  from Closed to Waiting when Shut and not Open\n  from Closed", 1);
    let own: String = ["P1", "P2", "Q1", "Q2"].map(|name| variable(name, false)).concat();
    let open = r#"<variable name="Open"><type><BOOL/></type></variable>"#;
    let text = "LAMP := LAMP OR (P2 XOR Q2); P2 := P1; Q2 := Q1; P1 := Open; Q1 := Open;";
    let [pou, instance] = one_more(&own, open, text);
    assert_eq!(said_of(&model, &[("<pous>", &pou), (LAST, &instance)]), "proved, 1 scans back");
}

#[test]
fn a_proof_that_looks_back_begins_with_as_many_scans() {
    // What the program keeps of the input begins with two values, which only shows in the second scan.
    let own: String = ["P1", "P2", "Q1", "Q2"].map(|name| variable(name, name == "P1")).concat();
    let open = r#"<variable name="Open"><type><BOOL/></type></variable>"#;
    let text = "LAMP := LAMP OR (P2 XOR Q2); P2 := P1; Q2 := Q1; P1 := Open; Q1 := Open;";
    let [pou, instance] = one_more(&own, open, text);
    assert_eq!(
        said(&[("<pous>", &pou), (LAST, &instance)]),
        "scan                chart  program\n   \
           1  state Closed  on     on\n   \
           2  output LAMP   off    on  <- LAMP\n"
    );
}

#[test]
fn what_happens_at_exits_happens_from_the_inside_out() {
    let model = "machine M
cycle 10ms
inputs { Go }
outputs { IN OUT }
variables { Kept : BOOL }
actuator A onoff by IN
actuator B onoff by OUT
chart C {
  initial state Off { drives OUT when Kept }
  state On { drives IN exit reset Kept
    initial state One { exit set Kept }
    state Two
    from One to Two when not Go
  }
  from Off to On when Go
  from On to Off when not Go
}
";
    assert_eq!(said_of(model, &[]), "proved");
}
