//! What constraints are good for, and what is denied.

use crate::support::binary::{Scratch, chartwright, code, stderr, stdout};
use crate::support::models;
use chartwright::emit::{self, Header};
use chartwright::ir::chart::Machine;
use chartwright::pipeline::needed::{Kept, Needed, Without, needed};
use chartwright::pipeline::verify::{Kind, Options, Program, Question, Status, verify};
use chartwright::pipeline::{self, Dialect, without};

/// A press that two hands start, with a guard.
const PRESS: &str = r#"
    machine Press
    cycle 10ms
    inputs { LeftHand  RightHand  Guard  Top }
    outputs { DOWN  LAMP }
    actuator Ram onoff by DOWN
    actuator Lamp onoff by LAMP
    chart C {
      initial state Up { drives DOWN when LeftHand and RightHand and Guard }
    }
    safety supervisor {
      S1: never DOWN and not Guard "no stroke with an open guard"
      S2: never DOWN and not Guard and LeftHand "the same, but less"
      S3: never LAMP and not LeftHand "the lamp waits for the left hand"
      S4: never rise(LAMP) and RightHand "the lamp does not come on in the right hand"
      C1: never DOWN and LAMP yields LAMP "the lamp is dark below"
    }
    properties {
      P1: never DOWN and not Guard
      P2: never DOWN and LAMP
      P3: never acts(S3) and LeftHand
    }
"#;

fn any() -> Options {
    Options { program: Program::Any, ..Options::default() }
}

fn ask(text: &str, options: &Options) -> Needed {
    let (found, diagnostics) = needed(text, options, &|| false, &mut |_| {});
    found.unwrap_or_else(|| panic!("{diagnostics:?}")).expect("it can be verified")
}

/// Constraint by constraint, what happens without it.
fn told(found: &Needed) -> Vec<String> {
    let name = |c| found.machine.safety.constraints[c].name.as_str();
    let one = |(c, without): &(_, Without)| {
        let what = match without {
            Without::Violated(loss) => found.machine.properties[loss.property].name.clone(),
            Without::Refused(error) => error.code.to_string(),
            Without::Kept(None) => "kept".to_owned(),
            Without::Kept(Some(implied)) => {
                format!("kept by {}", implied.iter().map(|&c| name(c)).collect::<Vec<_>>().join(" "))
            }
            Without::Unknown(..) | Without::Unverified(_) => "unknown".to_owned(),
        };
        format!("{}: {what}", name(*c))
    };
    found.without.iter().map(one).collect()
}

#[test]
fn each_constraint_of_a_small_machine_is_judged() {
    let found = ask(PRESS, &any());
    assert!(found.properties.iter().all(|(_, kept)| *kept == Kept::Yes), "{:?}", found.properties);
    assert_eq!(told(&found), ["S1: P1", "S2: kept by S1", "S3: kept", "S4: kept", "C1: P2"]);
    // The chart gives no such commands.
    let charts = ask(PRESS, &Options::default());
    assert_eq!(told(&charts), ["S1: kept", "S2: kept by S1", "S3: kept", "S4: kept", "C1: kept"]);
}

#[test]
fn without_some_constraints_others_are_needed() {
    // S1 does all that S2 does, and is gone; half of what it kept is still kept.
    let found = ask(PRESS, &Options { without: vec!["s1".to_owned()], ..any() });
    let (first, kept) = found.properties[0];
    assert_eq!((found.machine.properties[first].name.as_str(), kept), ("P1", Kept::No));
    assert_eq!(told(&found), ["S2: kept", "S3: kept", "S4: kept", "C1: P2"]);
    let narrow = PRESS.replace("P1: never DOWN and not Guard", "P1: never DOWN and not Guard and LeftHand");
    let found = ask(&narrow, &Options { without: vec!["S1".to_owned()], ..any() });
    assert_eq!(told(&found)[0], "S2: P1");
}

#[test]
fn where_nothing_is_kept_nothing_is_needed() {
    let broken = PRESS.replace("P1: never DOWN and not Guard", "P1: never DOWN and Guard");
    let broken = broken.replace("P2: never DOWN and LAMP", "P2: never LAMP");
    let broken = broken.replace("P3: never acts(S3) and LeftHand", "P3: never acts(S3)");
    assert!(ask(&broken, &any()).without.is_empty());
}

#[test]
fn the_compiler_may_refuse_what_is_left() {
    // What yields may do so only because S1 keeps the case away.
    let text = PRESS.replace(
        "C1: never DOWN and LAMP yields LAMP",
        "S0: never not LAMP and Top\n      S5: never DOWN and Top\n      C1: never DOWN and LAMP yields LAMP",
    );
    let text = text.replace("S3: never LAMP and not LeftHand", "").replace("S4: never rise(LAMP) and RightHand", "");
    let text = text.replace(r#""the lamp waits for the left hand""#, "").replace("P3: never acts(S3) and LeftHand", "");
    let text = text.replace(r#""the lamp does not come on in the right hand""#, "");
    let found = ask(&text, &any());
    let told = told(&found);
    let s5 = told.iter().find(|line| line.starts_with("S5")).expect("it is asked");
    assert!(s5.starts_with("S5: E4"), "{told:?}");
}

#[test]
fn the_prehensor_needs_what_it_needs() {
    let text = models::all().into_iter().find(|m| m.name == "prehensor").expect("it is there").source;
    let found = ask(&text, &any());
    let mut lost = Vec::new();
    for (c, without) in &found.without {
        let name = &found.machine.safety.constraints[*c].name;
        // Verified as a machine of its own.
        let (verified, _) = verify(&text, &Options { without: vec![name.clone()], ..any() }, &|| false, &mut |_| {});
        let answers = verified.expect("it is fine without one").answers;
        let hazard = answers.iter().find(|a| a.question == Question::Declared(0)).expect("it is asked");
        match without {
            Without::Violated(loss) => {
                assert_eq!(hazard.status, Status::Violated, "{name}");
                let run = loss.run.as_ref().expect("there is a run");
                let other = hazard.run.as_ref().expect("there is one");
                assert!(loss.certain && run.shortest && run.frames.len() == other.frames.len(), "{name}");
                assert!(run.scenario.contains(&format!("found by verification without {name}: ")), "{}", run.scenario);
                lost.push(name.as_str());
            }
            Without::Kept(_) => assert_eq!(hazard.status, Status::Holds, "{name}"),
            other => panic!("{name}: {other:?}"),
        }
    }
    assert_eq!(lost, ["F1_Go_in", "F1_Go_out", "Hold_Go_down", "Hold_Go_in", "Hold_Go_out"]);
}

#[test]
fn left_out_is_as_if_never_written() {
    let program = |machine: &Machine| emit::plcopen(&pipeline::lower(machine), Dialect::Beremiz, &Header::default());
    let mut compared = 0;
    for name in ["filter_simple", "filter_combined", "relief_in_order", "four_cylinders", "filter_blocking"] {
        let text = models::all().into_iter().find(|m| m.name == name).expect("it is there").source;
        let body: String = text.split("\nscenario").next().expect("it has a beginning").to_owned();
        let (machine, _) = pipeline::check(&body);
        for constraint in machine.expect("it is right").safety.constraints.values() {
            let name = &constraint.name;
            let is_it = |line: &&str| line.trim_start().starts_with(&format!("{name}:"));
            let by_hand: Vec<&str> = body.lines().filter(|line| !is_it(line)).collect();
            assert_eq!(by_hand.len() + 1, body.lines().count(), "{name}");
            let (by_hand, refused) = pipeline::check(&by_hand.join("\n"));
            let (left_out, too) = without::check(&text, std::slice::from_ref(name));
            assert_eq!(by_hand.is_some(), left_out.is_some(), "{name}: {refused:?} {too:?}");
            if let (Some(by_hand), Some(left_out)) = (by_hand, left_out) {
                assert_eq!(program(&by_hand), program(&left_out), "{name}");
                compared += 1;
            }
        }
    }
    assert!(compared > 30, "{compared}");
}

/// A counter that nobody stops, and two ways out of one state.
const COUNTER: &str = r"
    machine Counter
    cycle 10ms
    inputs { Part  Empty }
    outputs { FULL }
    variables { Parts : 0..3 }
    actuator Lamp onoff by FULL
    chart C {
      initial state Some { drives FULL when Parts = 3 }
      state None
      from Some to Some when rise(Part) then set Parts := Parts + 1
      from Some to None when rise(Empty) then set Parts := 0
      from None to Some when not Empty
    }
";

#[test]
fn integers_that_stop_at_a_bound_are_found() {
    let beyond = |text: &str| {
        let (verified, diagnostics) = verify(text, &Options::default(), &|| false, &mut |_| {});
        let answers = verified.unwrap_or_else(|| panic!("{diagnostics:?}")).answers;
        answers.into_iter().find(|a| matches!(a.question, Question::Beyond(_))).expect("it is asked")
    };
    let found = beyond(COUNTER);
    assert_eq!((found.status, found.demand), (Status::Violated, false));
    let run = found.run.expect("there is a run");
    // Power-up, and four parts with a pause between each and the next.
    assert!(run.shortest && run.replayed == Some(true) && run.frames.len() == 8, "{} scans", run.frames.len());
    assert_eq!(beyond(&COUNTER.replace("when rise(Part)", "when rise(Part) and Parts < 3")).status, Status::Holds);
    assert_eq!(beyond(&COUNTER.replace("Parts + 1", "Parts - 1")).run.expect("there is a run").frames.len(), 2);
}

#[test]
fn what_is_denied_is_demanded() {
    let ask = |deny: Vec<Kind>| {
        let options = Options { deny, ..Options::default() };
        verify(COUNTER, &options, &|| false, &mut |_| {}).0.expect("it has no errors").answers
    };
    for (kind, denied) in [(Kind::Overlap, 1), (Kind::Saturates, 1), (Kind::Acts, 0)] {
        let answers = ask(vec![kind]);
        let wrong = answers.iter().filter(|a| a.demand && a.status == Status::Violated);
        assert!(wrong.clone().all(|a| a.question.kind() == Some(kind)), "{kind:?}");
        assert_eq!(wrong.count(), denied, "{kind:?}");
        assert!(ask(Vec::new()).iter().all(|a| !a.demand || a.status == Status::Holds));
    }
    let all = ask(Kind::ALL.to_vec());
    assert!(all.iter().all(|a| a.demand));
}

#[test]
fn the_command_line_says_it_by_its_exit_code() {
    let place = Scratch::new("needed");
    place.write("p.chart", PRESS);
    place.write("c.chart", COUNTER);
    let run = |arguments: &str| {
        let output = chartwright(place.path(), arguments);
        (code(&output), stdout(&output).to_owned(), stderr(&output).to_owned())
    };
    let (fine, told, _) = run("verify p.chart --needed --scenario runs.chart");
    assert_eq!(fine, 0, "{told}");
    for line in [
        "needed      S1 (line 12): without it P1 is violated in scan 1",
        "not needed  S2 (line 13): implied by S1",
        "not needed  S4 (line 15): no property that is asked is violated without it\n",
        "of 5 constraints, each with all others in place, 2 needed and 3 not needed",
    ] {
        assert!(told.contains(line), "{told}");
    }
    let runs = place.read("runs.chart");
    assert_eq!(runs.matches("scenario \"found by verification without").count(), 2, "{runs}");
    assert_eq!(run("verify p.chart --needed --deny needless").0, 1);
    assert_eq!(run("verify p.chart --program any --without S2,S3,S4").0, 0);
    let (wrong, told, _) = run("verify p.chart --program any --without S1,C1");
    assert!(wrong == 1 && told.contains("violated  P1") && told.contains("violated  P2"), "{told}");
    let (wrong, _, told) = run("verify p.chart --without S9");
    assert!(wrong == 1 && told.contains("E104") && told.contains("no constraint `S9`"), "{told}");
    let (_, json, _) = run("verify p.chart --needed --format json");
    let json: serde_json::Value = serde_json::from_str(&json).expect("it is JSON");
    assert_eq!(json["constraints"][0]["verdict"], "needed");
    assert_eq!(json["constraints"][1]["implied_by"][0], "S1");

    assert_eq!(run("verify c.chart").0, 0);
    let (wrong, told, _) = run("verify c.chart --deny overlap,saturates");
    assert!(
        wrong == 1 && told.contains("denied    assigned beyond 0..3 in scan 8: Parts (line 6); it stops at the bound"),
        "{told}"
    );
    assert_eq!(run("verify c.chart --deny acts,void").0, 0);
    assert_eq!(run("verify p.chart --deny needless").0, 2);
    assert_eq!(run("verify p.chart --needed --deny overlap").0, 2);
}
