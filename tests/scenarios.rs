//! The scenarios of the models, runs and what is shown of them.

use crate::support::binary::{Scratch, chartwright, code, run, stderr, stdout};
use crate::support::models::{self, repository};
use chartwright::ir::chart::Machine;
use chartwright::pipeline;
use chartwright::simulate::frame::Frame;
use chartwright::simulate::record;
use chartwright::simulate::scenario::{self, Expectation, Verdict};

fn machine(source: &str) -> Machine {
    let (machine, diagnostics) = pipeline::check(source);
    machine.unwrap_or_else(|| panic!("{diagnostics:#?}"))
}

/// How the scenario of that index goes for each program, with the frames of its scans.
fn play(machine: &Machine, index: usize) -> Vec<(&'static str, Verdict, Vec<Frame>)> {
    let programs = pipeline::programs(machine).into_iter();
    let played = programs.map(|(name, program)| {
        let mut frames = Vec::new();
        let verdict = scenario::play(machine, program, index, &mut |_, frame| frames.push(frame.clone()));
        (name, verdict, frames)
    });
    played.collect()
}

#[test]
fn the_scenarios_of_all_models_go_as_expected_on_the_chart_and_on_the_plc() {
    let mut count = 0;
    for model in models::all() {
        let machine = machine(&model.source);
        for (i, s) in machine.scenarios.iter().enumerate() {
            let played = play(&machine, i);
            for (program, verdict, frames) in &played {
                assert!(verdict.failure.is_none(), "{}: {} ({program}): {:?}", model.name, s.name, verdict.failure);
                // Not only the verdict: every value of every scan.
                for (scan, (ours, theirs)) in played[0].2.iter().zip(frames).enumerate() {
                    let names = record::columns(&machine);
                    let differ: Vec<_> = (0..ours.len()).filter(|&i| ours[i] != theirs[i]).map(|i| &names[i]).collect();
                    assert!(differ.is_empty(), "{}: {} ({program}): scan {}: {differ:?}", model.name, s.name, scan + 1);
                }
            }
            count += 1;
        }
    }
    assert!(count > 30, "there are scenarios");
}

/// A door with a plant, and a scenario with these lines.
fn door(lines: &str) -> Machine {
    machine(&format!(
        "machine Door cycle 10ms
         inputs {{ Call Shut Open Bell }} outputs {{ MOTOR }}
         actuator Leaf monostable {{ position Closed sensor Shut  position Opened output MOTOR sensor Open }}
         chart Door controls Leaf {{
           initial state Closed  state Opened
           move from Closed to Opened when rise(Call)
           move from Opened to Closed when Bell
         }}
         safety supervisor {{ S1: never MOTOR and Bell }}
         plant {{
           hidden Guest
           Leaf travels 100ms back 50ms
           Bell rises when Guest and Open after 3 scans
           Bell falls when not Guest
         }}
         scenario \"it\" {{ {lines} }}"
    ))
}

/// What goes wrong, and in which scan; the same for all programs.
fn fails(lines: &str) -> Option<(Expectation, u64)> {
    let machine = door(lines);
    let played = play(&machine, 0);
    let failures: Vec<_> = played.iter().map(|(_, v, _)| v.failure.as_ref().map(|f| (f.kind, f.scan))).collect();
    assert!(failures.iter().all(|f| *f == failures[0]), "{lines}: {failures:?}");
    failures[0]
}

#[test]
fn a_travel_takes_its_time() {
    // Pressed in scan 2, ordered in scan 2, seen by the plant from scan 3 on.
    assert_eq!(fails("press Call expect MOTOR and Shut wait 1 scan expect not Shut"), None);
    assert_eq!(fails("press Call wait 9 scans expect not Open wait 1 scan expect Open and in(Opened)"), None);
    assert_eq!(fails("press Call wait until Open within 10 scans"), None);
    assert_eq!(fails("press Call wait until Open within 9 scans"), Some((Expectation::Within(9), 11)));
    let back = "press Call wait until Open within 1s set Guest wait until Bell within 1s expect alarm(S1) or not MOTOR";
    assert_eq!(fails(&format!("{back} wait 5 scans expect Shut")), None);
    assert_eq!(fails(&format!("{back} wait 4 scans expect Shut")).map(|f| f.0), Some(Expectation::Now));
}

#[test]
fn a_rule_waits_for_its_delay_and_starts_anew() {
    let open = "press Call wait until Open within 1s";
    assert_eq!(fails(&format!("{open} set Guest wait 3 scans expect not Bell wait 1 scan expect Bell")), None);
    let interrupted = "set Guest wait 3 scans reset Guest wait 1 scan set Guest wait 3 scans expect not Bell";
    assert_eq!(fails(&format!("{open} {interrupted} wait 1 scan expect Bell")), None);
}

#[test]
fn a_press_is_an_edge() {
    assert_eq!(fails("press Call expect in(Closed_to_Opened)"), None, "even at power-up");
    let again =
        "press Call wait until Open within 1s set Guest wait until in(Closed) within 1s reset Guest wait 1 scan";
    assert_eq!(fails(&format!("{again} press Call press Call expect MOTOR")), None);
    assert_eq!(fails("set Call wait 10 scans expect in(Closed)"), None, "held down at power-up");
}

#[test]
fn what_is_forced_stays_and_what_is_released_goes_on() {
    let stuck = "force not Open press Call wait 20 scans expect in(Closed_to_Opened) release Open wait 1 scan";
    assert_eq!(fails(&format!("{stuck} expect Open and in(Opened)")), None);
    assert_eq!(fails("place Leaf at Opened wait 1 scan expect Open wait 5 scans expect Shut"), None, "the spring");
}

#[test]
fn always_and_never_watch_every_scan_from_the_next_one_on() {
    assert_eq!(fails("always Shut wait 5 scans press Call wait 1s"), Some((Expectation::Always, 7)));
    assert_eq!(fails("never Open press Call wait 1s"), Some((Expectation::Never, 12)));
    assert_eq!(fails("press Call never Shut wait 1s"), None);
    assert_eq!(fails("repeat 3 { wait 2 scans } expect Open"), Some((Expectation::Now, 6)));
}

#[test]
fn a_failure_says_what_it_read() {
    let machine = door("press Call expect in(Closed) and not rise(MOTOR) \"why\"");
    let failure = play(&machine, 0)[0].1.failure.clone().expect("it fails");
    assert_eq!((failure.scan, failure.text.as_str()), (2, "why"));
    let shown: Vec<String> = failure.values.iter().map(|(n, v)| format!("{n}={v}")).collect();
    assert_eq!(shown, ["in(Closed)=false", "prev(MOTOR)=false", "MOTOR=true"]);
}

#[test]
fn a_table_of_inputs_gives_the_known_outputs_on_both_programs() {
    let expected = std::fs::read_to_string(repository("tests/fixtures/indexa_cycle.expected.csv")).unwrap();
    let mut lines = expected.lines();
    let outputs: Vec<&str> = lines.next().unwrap().split(',').take(12).collect();
    for program in ["chart", "plc"] {
        let args = "simulate models/indexa.chart --inputs tests/fixtures/indexa_cycle.inputs.csv --output csv";
        let output = chartwright(&repository("."), &format!("{args} --scans 110 --program {program}"));
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let text = stdout(&output).to_owned();
        let mut rows = text.lines();
        let head: Vec<&str> = rows.next().unwrap().split(',').collect();
        let places: Vec<usize> = outputs.iter().map(|n| head.iter().position(|h| h == n).expect(n)).collect();
        let shown: Vec<String> = rows
            .map(|row| {
                let cells: Vec<&str> = row.split(',').collect();
                places.iter().map(|&p| cells[p]).collect::<Vec<_>>().join(",")
            })
            .collect();
        let known: Vec<String> =
            lines.clone().map(|row| row.split(',').take(12).collect::<Vec<_>>().join(",")).collect();
        assert_eq!(shown, known, "{program}");
    }
}

#[test]
fn the_same_seed_gives_the_same_run_and_another_one_another() {
    let by_chance = |seed: u32, program: &str| {
        let args = format!("simulate models/drill_station.chart --seed {seed} --scans 500 --output csv");
        let output = chartwright(&repository("."), &format!("{args} --program {program}"));
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        stdout(&output).to_owned()
    };
    assert!(by_chance(1, "chart") == by_chance(1, "chart"));
    assert!(by_chance(1, "chart") == by_chance(1, "plc"));
    assert!(by_chance(1, "chart") != by_chance(2, "chart"));
}

#[test]
fn a_run_is_shown_as_a_table_of_changes() {
    let args = ["simulate", "models/bistable.chart", "--scenario", "a box is pushed off"];
    let output = run(&repository("."), &args, "");
    assert_eq!(code(&output), 0);
    insta::assert_snapshot!(stdout(&output), @r"
    scan     time  inputs   outputs  states
       1  0.000 s  +Behind           +Back
       2  0.010 s  +Go      +OUT     -Back +MovingForward
       3  0.020 s  -Behind
      32  0.310 s  +Ahead   -OUT     -MovingForward +Front
      33  0.320 s  -Go      +BACK    -Front +Front_to_Back
      34  0.330 s  -Ahead
      63  0.620 s  +Behind  -BACK    -Front_to_Back +Back
    ");
}

#[test]
fn a_dump_is_read_by_a_parser_of_dumps() {
    let output = chartwright(&repository("."), "simulate models/indexa.chart --seed 3 --scans 300 --output vcd");
    assert_eq!(code(&output), 0);
    let text = stdout(&output).to_owned();
    let mut parser = vcd::Parser::new(text.as_bytes());
    let header = parser.parse_header().expect("the header is well-formed");
    for path in [&["INDEXA", "inputs", "PE"][..], &["INDEXA", "hidden", "Work"], &["INDEXA", "outputs", "KEN"]] {
        assert!(header.find_var(path).is_some(), "{path:?}");
    }
    let region = ["INDEXA", "INDEXA", "InProduction", "Automatic", "Preparation", "V", "state"];
    assert_eq!(header.find_var(&region).expect("the region is there").var_type, vcd::VarType::String);
    assert!(parser.all(|command| command.is_ok()), "the changes are well-formed");
}

#[test]
fn a_session_takes_commands_from_a_pipe() {
    let commands = "help\nset Go\nstep 2\ntree\nrun until in(Front)\noutputs\nback 5\ntree\ntoggle Go\nstep\n\
                    set Ahead\nstep\nrelease Ahead\ninputs\nquit\nnonsense\n";
    let args = ["simulate", "models/bistable.chart"];
    let output = run(&repository("."), &args, commands);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let shown = stdout(&output).to_owned();
    let after_help = shown.split_once("quit           ends\n").expect("help was shown").1;
    insta::assert_snapshot!(after_help, @r#"
         1    0.000 s  +Go +Behind | +Back
         2    0.010 s  +OUT | -Back +MovingForward
    Pusher
      MovingForward (moving)
         3    0.020 s  -Behind
        32    0.310 s  +Ahead | -OUT | -MovingForward +Front
    0  OUT          cylinder out
    0  BACK         cylinder back
        27    0.260 s  as it was
    Pusher
      MovingForward (moving)
        28    0.270 s  -Go
        29    0.280 s  +Ahead | -OUT | -MovingForward +Front
    0  Go           a box is there
    0 ~Behind       cylinder is at the back
    1 ~Ahead        cylinder is at the front
    "#);
    let output = run(&repository("."), &args, "run until Nowhere\n");
    assert_eq!(code(&output), 1, "a script with a mistake is wrong");
    assert!(stdout(&output).contains("`Nowhere` is not declared"), "{}", stdout(&output));
}

#[test]
fn a_session_waits_for_what_the_model_never_asks() {
    // Neither comparison stands in the model.
    let commands = "set Start\nstep\nrun until Jars + 1 > 1\nrun until Jars + Jars = 0 and not Jars = 2\n";
    let model = "machine Counts inputs { Start } variables { Jars : 0..3 }
                 chart C { initial state A { internal when Start then set Jars := Jars + 1 } }";
    let directory = Scratch::new("session_comparisons");
    directory.write("counts.chart", model);
    let output = run(directory.path(), &["simulate", "counts.chart"], commands);
    assert!(stdout(&output).contains("Jars=1"), "{}{}", stdout(&output), stderr(&output));
    assert!(stdout(&output).contains("this did not happen in"), "{}", stdout(&output));
    assert_eq!(code(&output), 1);
}

/// A model with a scenario that fails, in a directory of its own.
fn failing(test: &str) -> Scratch {
    let directory = Scratch::new(test);
    let model = std::fs::read_to_string(repository("models/bistable.chart")).unwrap();
    let wrong = "\nscenario \"too slow\" {\n  wait 1 scan\n  set Go\n  wait until Ahead \
                 within 100ms \"it <must> be quick\"\n}\n";
    directory.write("wrong.chart", model + wrong);
    directory
}

#[test]
fn a_failure_is_reported_with_what_changed_before() {
    let directory = failing("scenario_report");
    let output = chartwright(directory.path(), "test wrong.chart --filter slow");
    assert_eq!(code(&output), 1);
    insta::assert_snapshot!(stdout(&output), @r#"
    wrong.chart
      FAILED  too slow (chart, 11 scans, 0.110 s)
      FAILED  too slow (plc, 11 scans, 0.110 s)

    wrong.chart:66:3: too slow (chart)
      wait until Ahead within 100ms
      "it <must> be quick"
      the condition has not become TRUE within 0.100 s, up to scan 11, 0.100 s
      Ahead = FALSE

      scan     time  inputs   outputs  states
         1  0.000 s  +Behind           +Back
         2  0.010 s  +Go      +OUT     -Back +MovingForward
         3  0.020 s  -Behind

    wrong.chart:66:3: too slow (plc)
      wait until Ahead within 100ms
      "it <must> be quick"
      the condition has not become TRUE within 0.100 s, up to scan 11, 0.100 s
      Ahead = FALSE

      scan     time  inputs   outputs  states
         1  0.000 s  +Behind           +Back
         2  0.010 s  +Go      +OUT     -Back +MovingForward
         3  0.020 s  -Behind

    0 passed, 2 failed
    "#);
}

#[test]
fn junit_and_json_say_the_same() {
    let directory = failing("scenario_junit");
    let output = chartwright(directory.path(), "test wrong.chart --junit report.xml --format json");
    assert_eq!(code(&output), 1);
    let report: serde_json::Value = serde_json::from_str(stdout(&output)).expect("one JSON document");
    assert_eq!((&report["passed"], &report["failed"]), (&4.into(), &2.into()), "{report}");
    let failed = report["tests"].as_array().unwrap().iter().find(|t| !t["failure"].is_null()).unwrap();
    assert_eq!(failed["failure"]["step"], "wait until Ahead within 100ms");
    let junit = directory.read("report.xml");
    let tree = roxmltree::Document::parse(&junit).expect("JUnit is XML");
    let suites = tree.root_element();
    assert_eq!((suites.attribute("tests"), suites.attribute("failures")), (Some("6"), Some("2")));
    let failure = tree.descendants().find(|n| n.has_tag_name("failure")).expect("a failure");
    assert!(failure.text().unwrap().contains("it <must> be quick"));
}

#[test]
fn what_cannot_be_run_is_said() {
    let root = repository(".");
    let output = run(&root, &["simulate", "models/bistable.chart", "--scenario", "none"], "");
    assert_eq!(code(&output), 1);
    assert!(stderr(&output).contains("a box is pushed off"), "{}", stderr(&output));
    let output = chartwright(&root, "simulate models/bistable.chart --seed 1 --inputs x.csv");
    assert_eq!(code(&output), 2);
    let output = chartwright(&root, "simulate models/bistable.chart --inputs Cargo.toml");
    assert_eq!(code(&output), 1);
    let d = Scratch::new("open_tables");
    for (text, part) in [
        ("scan,Go,Go\n1,1,0\n", "two columns are for the input `Go`"),
        ("scan,Go\n2,7\n", "`Go` is given 7 in scan 2"),
        ("scan,Go\n0,1\n", "no scan 0"),
    ] {
        d.write("open.csv", text);
        let output = run(
            &root,
            &["simulate", "models/bistable.chart", "--inputs", d.path().join("open.csv").to_str().unwrap()],
            "",
        );
        assert_eq!(code(&output), 1, "{text}");
        assert!(stderr(&output).contains(part), "{}", stderr(&output));
    }
    let output = chartwright(&root, "test models/invalid/E101_duplicate_name.chart");
    assert_eq!(code(&output), 1);
    assert!(stderr(&output).contains("E101"), "{}", stderr(&output));
}

fn indexa() -> String {
    std::fs::read_to_string(repository("models/indexa.chart")).unwrap()
}

#[test]
fn the_scenarios_of_indexa_are_in_every_state() {
    let machine = machine(&indexa());
    let layout = chartwright::simulate::frame::Layout::of(&machine);
    let mut seen = vec![false; machine.states.len()];
    for i in 0..machine.scenarios.len() {
        let mut each = |_, frame: &Frame| {
            for id in machine.states.ids() {
                seen[id.index()] |= frame[layout.state(id)];
            }
        };
        let program = pipeline::programs(&machine).swap_remove(0).1;
        scenario::play(&machine, program, i, &mut each);
    }
    let never: Vec<String> =
        machine.states.ids().filter(|id| !seen[id.index()]).map(|id| machine.state_path(id)).collect();
    assert!(never.is_empty(), "{never:?}");
}

/// The emergency stop and an open guard, in every state of the automatic mode and of the way there.
#[test]
fn indexa_stops_whenever_it_has_to() {
    let mut source = indexa();
    let outputs = "OHC or IHC or OVC or IVC or ROT or ASP or OFC or PMR or CMR or KEN";
    for after in ["energy", "initialisation brings the head home from the jar", "automatic production"] {
        for scans in (1..700).step_by(23) {
            for stop in ["ES", "PG"] {
                source += &format!(
                    "scenario \"{stop} {scans} scans after {after}\" after \"{after}\" {{
                       press PBI wait {scans} scans reset {stop} wait 1 scan
                       expect in(WithoutEnergy) and not ({outputs}) set {stop} wait 1s
                       expect in(WithoutEnergy) and not ({outputs})
                     }}\n"
                );
            }
        }
    }
    let machine = machine(&source);
    let ours = machine.scenarios.iter().enumerate().filter(|(_, s)| s.name.contains(" scans after "));
    let mut count = 0;
    for (i, s) in ours {
        for (program, verdict, _) in play(&machine, i) {
            assert!(verdict.failure.is_none(), "{} ({program}): {:?}", s.name, verdict.failure);
        }
        count += 1;
    }
    assert!(count > 150, "{count}");
}

#[test]
fn the_name_of_a_chart_leads_to_its_own_states_only() {
    let source = std::fs::read_to_string(crate::support::models::repository("models/two_charts.chart")).unwrap();
    assert!(pipeline::check(&source).0.is_some());
    let wrong = source.replace("in(Light.Stop)", "in(Barrier.Stop)");
    let codes: Vec<_> = pipeline::check(&wrong).1.iter().map(|d| d.code.number()).collect();
    assert_eq!(codes, ["E104"]);
}
