//! What a model says in words reaches the people in front of the PLC: the XML and the table of names.

use crate::support::models::repository;
use crate::support::{proof, schema};
use chartwright::pipeline::{self, Dialect};
use std::collections::BTreeSet;

/// A model in which each place that takes a text has one: `says <rule of the grammar> <number>`.
pub const MODEL: &str = r#"
machine Press "says machine 1"
cycle 10ms
inputs { Go at %IX0.0 "says signal 1"  Up "says signal 2"  Down  Wide  Tight  Stop  Again  Deep "says signal 3" }
outputs { OUT "says signal 4"  BACK  CLAMP  LAMP  RUN  JOB }
variables { Hot : BOOL "says variable 1"  Count : 0..3 "says variable 2"  Late : BOOL  Odd : BOOL  Busy : BOOL  Risen : BOOL }
events { Ready "says event 1" }
actuator Ram bistable valve closed-centre "says actuator 1" {
  position Top output BACK sensor Up "says position 1"
  position Bottom output OUT sensor Down within 2s else set Late "says position 2"
}
actuator Jaw monostable "says actuator 2" {
  position Open sensor Wide "says position 3"
  position Shut output CLAMP sensor Tight "says position 4"
}
actuator Light onoff by LAMP "says actuator 3"
actuator Fan onoff "says actuator 4" {
  position Still "says position 5"
  position Blowing output RUN "says position 6"
}
actuator Tool onoff by JOB

observer Watch "says observer 1" {
  initial state Free "says state 1"
  state Used "says state 2"
  from Used to Free when Stop "says transition 1"
  after filter { from Free to Used when rise(OUT) "says transition 2" }
}
observer Still "says observer 2" {
  initial state Asleep
  state Awake { internal when Go then set Busy "says internal 1" }
  from Asleep to Awake when Go "says transition 3"
  from Awake to Asleep when Stop
}
function Punch "says function 1" {
  activate when Go
  deactivate when Stop
  drives JOB
}
function Blow automatic "says function 2" {
  deactivate when Stop
  drives RUN
}
sequence Round "says sequence 1" {
  wait until Go "says pause 1"
  do Punch until Stop "says run 1"
  do Blow, Punch until Again "says run 2"
  activate Blow "says ask 1"
  deactivate Blow "says ask 2"
  wait 30ms "says pause 2"
}
chart Main "says chart 1" {
  region Moving controls Ram "says region 1" {
    initial state Top "says state 3"
    state Bottom
    move from Top to Bottom when Go "says transition 4"
    move from Bottom to Top as Lifting when Stop then set Risen "says transition 5"
  }
  region Rest "says region 2" {
    initial choice Begin "says choice 1" {
      when Go to Warm "says branch 1"
      else to Cold "says branch 2"
    }
    state Warm "says state 4" {
      drives LAMP
      internal when Again then raise Ready "says internal 2"
      internal when Deep and Stop then set Count := Count + 1 "says internal 3"
    }
    state Cold
    final state End "says state 5"
    parallel state Both "says state 6" {
      region One controls Jaw "says region 3" {
        initial state Open
        state Shut "says state 7"
        from Open to Shut when Go "says transition 6"
      }
      region Two {
        initial state A
        state B
        from A to B when Again then set Hot "says transition 7"
      }
      internal when Deep then set Count := 2 "says internal 4"
    }
    choice Which "says choice 2" {
      when Again to Both "says branch 3"
      when Deep to More then set Odd "says branch 4"
      else to Cold "says branch 5"
    }
    choice More {
      when Stop to history of Both "says branch 6"
      else to Warm
    }
    from Warm to Which when Stop "says transition 8"
    from Cold to (Both.One.Shut, Both.Two.B) when Again "says transition 9"
    from (Both.One.Shut, Both.Two.B) to Warm when Stop "says transition 10"
    from any to End priority 1 when Go and Stop and Again "says transition 11"
  }
}
chart Crossing {
  initial state S1 { initial state In  state Out  from In to Out when Go  from In to S2 when Deep "says transition 12" }
  state S2
  from S2 to S1 when Stop
  from S2 to deep history of S1 when Again "says transition 13"
}
safety supervisor {
  C1: never OUT and not Deep "says never 1"
  assume A1: never Up and Down "says never 2"
  F1: forbid Ram between unless Jaw at Open "says forbid 1"
  F2: forbid Ram at Bottom and Jaw at Open "says forbid 2"
  derive all except F2
}
properties {
  P1: never OUT and BACK "says property 1"
  P2: after Go eventually Hot "says property 2"
  assume P3: always eventually Stop "says fairness 1"
  accept acts C1 "says acceptance 1"
}
plant by steps {
  hidden Warmth "says hidden 1"
  step "says happening 1" when Go then set Warmth
  Ram travels 300ms "says travel 1"
  Deep follows Warmth "says reaction 1"
}
scenario "says scenario 1" {
  set Go
  wait 2 scans "says wait 1"
  always Hot or not Hot "says watch 1"
  happens "says happening 1"
  expect Hot or not Hot "says expect 1"
}
"#;

/// Rules of the grammar whose texts describe how the machine is tried out, and not what runs in the PLC
/// (docs/language.md says so); `happens` repeats that of a happening.
const NOT_IN_PROGRAMS: [&str; 10] =
    ["acceptance", "hidden", "happening", "travel", "reaction", "scenario", "happens", "wait", "expect", "watch"];

/// The rules of the grammar in which a text can stand.
fn places() -> BTreeSet<String> {
    let grammar = std::fs::read_to_string(repository("grammar/chart.pest")).expect("the grammar is there");
    let mut places = BTreeSet::new();
    let mut rule = "";
    for line in grammar.lines() {
        let code = line.split("//").next().unwrap_or("");
        if let Some((name, _)) = code.split_once('=').filter(|(name, _)| !name.starts_with([' ', '\t'])) {
            rule = name.trim();
        }
        let words: Vec<&str> = code.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
        if words.iter().skip(1).any(|w| *w == "text") || (words.first() == Some(&"text") && rule != "text") {
            places.insert(rule.to_owned());
        }
    }
    places.retain(|name| !name.starts_with("lone_") && !name.starts_with("bad_"));
    places
}

fn texts() -> Vec<&'static str> {
    let texts: Vec<&str> = MODEL.split('"').skip(1).step_by(2).collect();
    let distinct: BTreeSet<&str> = texts.iter().copied().collect();
    // The happening stands twice.
    assert_eq!(distinct.len() + 1, texts.len(), "each text is unique");
    distinct.into_iter().collect()
}

/// The rule of the grammar that a text names.
fn rule(text: &str) -> &str {
    text.split(' ').nth(1).expect("a text names its rule")
}

#[test]
fn every_place_of_the_grammar_that_takes_a_text_is_tried() {
    let mut tried: BTreeSet<String> = texts().into_iter().map(|t| rule(t).to_owned()).collect();
    tried.insert("happens".to_owned());
    assert_eq!(tried, places());
}

#[test]
fn every_text_of_a_model_is_in_the_program_and_in_its_table_of_names() {
    for dialect in [Dialect::Beremiz, Dialect::Codesys] {
        let output = proof::build(MODEL, dialect).unwrap_or_else(|e| panic!("{e}"));
        schema::assert_valid("texts", &output.xml, dialect);
        proof::read_back(&output);
        let document = roxmltree::Document::parse(&output.xml).expect("well-formed");
        let said: Vec<String> =
            document.descendants().filter(|n| n.is_text()).map(|n| n.text().unwrap_or_default().to_owned()).collect();
        for text in texts() {
            let expected = !NOT_IN_PROGRAMS.contains(&rule(text));
            let holds = |whole: &str| {
                whole
                    .match_indices(text)
                    .any(|(at, _)| !whole[at + text.len()..].starts_with(|c: char| c.is_ascii_digit()))
            };
            assert_eq!(said.iter().any(|s| holds(s)), expected, "{dialect:?}: XML: {text}");
            assert_eq!(output.names.lines().any(holds), expected, "{dialect:?}: names: {text}");
        }
    }
}

/// A function whose event `Shift_Ended` nobody names, or what is said here.
fn shifting(machine: &str, function: &str, chart: &str) -> String {
    format!(
        "machine Shifter \"{machine}\" inputs {{ Near Far Push }} outputs {{ OVER GLOW }}
         actuator Slide monostable {{ position Back sensor Near  position Over output OVER sensor Far }}
         actuator Lamp onoff by GLOW
         function Shift automatic \"{function}\" {{
           request when rise(Push)  activate when Near  deactivate when Far  drives OVER
         }}
         chart Shown {{ initial state Dark  state Bright {{ drives GLOW }}  from Dark to Bright when {chart}  from Bright to Dark }}"
    )
}

#[test]
fn no_word_in_a_text_changes_a_program() {
    let program = |machine: &str, function: &str, chart: &str| {
        let output =
            proof::build(&shifting(machine, function, chart), Dialect::Beremiz).unwrap_or_else(|e| panic!("{e}"));
        let globals = output.project.globals.values().map(|g| g.name.clone()).collect::<BTreeSet<_>>();
        let rungs = chartwright::ir::text::ladder(&output.project).lines().filter(|l| l.contains("|--")).count();
        (globals, rungs)
    };
    let plain = program("moves parts", "moves a part", "Far");
    for word in
        ["Shift_Ended", "and then Shift_Ended.", r#"says \"Shift_Ended\" \\"#, "Shift_Activate Shift_Deactivate"]
    {
        assert_eq!(program(word, "moves a part", "Far"), plain, "{word}");
        assert_eq!(program("moves parts", word, "Far"), plain, "{word}");
    }
    // Outside of texts it does.
    assert_ne!(program("moves parts", "moves a part", "Shift_Ended"), plain);
}

/// The names of all variables of the program that a model becomes.
fn globals(source: &str) -> BTreeSet<String> {
    let (machine, diagnostics) = pipeline::check(source);
    let machine = machine.unwrap_or_else(|| panic!("{diagnostics:?}\n{source}"));
    pipeline::lower(&machine).globals.values().map(|g| g.name.clone()).collect()
}

#[test]
fn a_word_in_a_text_of_any_kind_names_nothing() {
    let plain = globals(MODEL);
    assert!(!plain.contains("Punch_Ended") && plain.contains("Blow_Ended"));
    for text in texts() {
        let other = MODEL.replace(&format!("\"{text}\""), &format!("\"{text} Punch_Ended\""));
        assert_ne!(other, MODEL);
        assert_eq!(globals(&other), plain, "{text}");
    }
}

#[test]
fn a_name_of_something_else_names_no_event() {
    let source = shifting("moves parts", "moves a part", "Far");
    let plain = globals(&source);
    for (there, instead) in [
        ("chart Shown", "chart Shift_Ended"),
        ("machine Shifter", "machine Shift_Ended"),
        ("actuator Lamp", "actuator Shift_Ended"),
        ("position Over", "position Shift_Ended"),
    ] {
        assert!(source.contains(there));
        let events: BTreeSet<String> = globals(&source.replace(there, instead));
        assert!(!events.contains("Shift_Ended"), "{there}");
        assert_eq!(events.len(), plain.len(), "{there}");
    }
    let more = "properties { Shift_Ended: never OVER and Near } scenario \"Shift_Ended\" { wait 1 scan }";
    assert_eq!(globals(&format!("{source} {more}")), plain);
}

#[test]
fn an_event_is_there_for_whoever_names_it() {
    let source = shifting("moves parts", "moves a part", "Far");
    assert!(!globals(&source).contains("Shift_Ended"));
    let chart = |inside: &str| format!("chart More {{ initial state On {{ {inside} }} }}");
    for named in [
        chart("internal when Shift_Ended then set Seen"),
        chart("internal when prev(Push) and not Shift_Ended then set Seen"),
        chart("internal when Push then raise Shift_Ended"),
        chart("sets Seen when Shift_Ended"),
        chart("drives GLOW when Shift_Ended"),
        chart("entry raise Shift_Ended"),
        chart("exit raise Shift_Ended"),
        chart("initial choice Way { when Shift_Ended to B else to A } state A state B from A to B from B to A"),
        "safety supervisor { C: never GLOW and Shift_Ended }".to_owned(),
        "safety supervisor { assume A: never Near and Shift_Ended }".to_owned(),
        "properties { P: after Shift_Ended eventually Push }".to_owned(),
        "properties { P: reachable Shift_Ended }".to_owned(),
        "scenario \"s\" { repeat 2 { wait until Shift_Ended within 1 scan } }".to_owned(),
        "scenario \"s\" { never Shift_Ended }".to_owned(),
        "sequence Work { wait until Shift_Ended do Shift }".to_owned(),
        "function More { request when Push  release when Near  activate when Shift_Ended }".to_owned(),
        "function More { request when Push  release when Near  abort when Shift_Ended  sets Seen }".to_owned(),
    ] {
        let whole = format!("{source} variables {{ Seen : BOOL }} {named}");
        assert!(globals(&whole).contains("Shift_Ended"), "{named}");
    }
}

#[test]
fn a_condition_is_a_condition_and_nothing_besides() {
    let source = shifting("moves parts", "moves a part", "Far");
    for fine in ["Push", "in(Shown.Bright) and not GLOW", "(Near or Far) // both", " true ", "rise(in(Dark))"] {
        assert!(pipeline::condition(&source, fine).is_ok(), "{fine}");
    }
    // However the model ends, for the condition is not put behind it.
    for end in [" // a comment", " plant {", " \"", " }"] {
        let fits = end.starts_with(" //");
        assert_eq!(pipeline::condition(&format!("{source}{end}"), "Push").is_ok(), fits, "{end}");
    }
    for wrong in [
        "",
        "Push Near",
        "true within 1 scan } scenario \"more\" { wait until true",
        "Push within 3 scans wait until Near",
        "Push } scenario \"more\" { expect Near",
        "Push \"why\"",
        "(Push",
        "Push)",
        "Push } chart Another { initial state A",
        "Push\nwithin 1 scan } scenario \"more\" { expect Push",
        "Push /* why */",
        "after 10ms",
        "done",
        "Nowhere",
        "in(Nowhere)",
    ] {
        let refused = pipeline::condition(&source, wrong);
        assert!(refused.is_err_and(|found| !found.is_empty()), "{wrong}");
    }
}
