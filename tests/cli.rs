//! The command line as its users meet it.

use crate::support::binary::{Scratch, chartwright, code, command, stderr, stdout};
use crate::support::models::repository;
use chartwright::base::limits;
use serde_json::Value;

const LAMP: &str = "\
machine Lamp
cycle 10ms
inputs  { Switch at %IX0.0 }
outputs { LAMP at %QX0.0 }
actuator Light onoff by LAMP
chart Lamp controls Light {
  initial state Off
  state On
  from Off to On when Switch
  from On to Off when not Switch
}
";

/// Two errors and a warning.
const WRONG: &str = "\
machine Lamp
cycle 0ms
inputs  { Switch at %IX0.0  Spare }
outputs { LAMP at %QX0.0 }
actuator Light onoff by LAMP
chart Lamp controls Light {
  initial state Off
  state On
  from Off to On when Swich
  from On to Off when not Switch
}
";

fn json(output: &std::process::Output) -> Value {
    serde_json::from_str(stdout(output)).unwrap_or_else(|e| panic!("{e}: {}", stdout(output)))
}

#[track_caller]
fn assert_usage_error(directory: &Scratch, arguments: &str, says: &str) {
    let output = chartwright(directory.path(), arguments);
    assert_eq!(code(&output), 2, "{arguments}");
    assert!(stderr(&output).contains(says), "{arguments}: {}", stderr(&output));
    assert_eq!(stdout(&output), "", "{arguments}");
}

#[track_caller]
fn assert_wrong_input(directory: &Scratch, arguments: &str, says: &str) {
    let output = chartwright(directory.path(), arguments);
    assert_eq!(code(&output), 1, "{arguments}: {}", stderr(&output));
    assert!(stderr(&output).contains(says), "{arguments}: {}", stderr(&output));
    assert_eq!(stdout(&output), "", "{arguments}");
}

#[test]
fn a_proof_ends_when_its_time_is_over() {
    let d = Scratch::new("time");
    d.write("lamp.chart", LAMP);
    d.write("indexa.chart", std::fs::read_to_string(repository("models/indexa.chart")).expect("the model is there"));
    assert_eq!(code(&chartwright(d.path(), "build lamp.chart -o lamp.xml")), 0);
    // One that takes a while, so that the clock comes first on a busy machine, too.
    assert_eq!(code(&chartwright(d.path(), "build indexa.chart -o indexa.xml --no-proof")), 0);
    let open = "error[E802]: the program has neither been proved nor refuted within 0 s";
    let output = chartwright(d.path(), "prove indexa.chart indexa.xml --time 0");
    assert_eq!(code(&output), 1);
    assert!(stderr(&output).contains(open), "{}", stderr(&output));
    assert_eq!(code(&chartwright(d.path(), "prove lamp.chart lamp.xml --time 60")), 0);
}

#[test]
fn wrong_usage_exits_with_2() {
    let d = Scratch::new("usage");
    d.write("lamp.chart", LAMP);
    d.write("lamp.xml", LAMP);
    assert_usage_error(&d, "", "Usage: chartwright <COMMAND>");
    assert_usage_error(&d, "frobnicate", "unrecognized subcommand");
    assert_usage_error(&d, "check", "<FILE>");
    assert_usage_error(&d, "check --format yaml lamp.chart", "possible values: human, json");
    assert_usage_error(&d, "build lamp.chart lamp.chart", "unexpected argument");
    assert_usage_error(&d, "build lamp.chart --dialect siemens", "possible values: beremiz, codesys");
    assert_usage_error(&d, "build lamp.xml", "would overwrite the model");
    assert_usage_error(&d, "build lamp.chart -o ./lamp.chart", "would overwrite the model");
    assert_usage_error(&d, "build lamp.chart --names lamp.chart", "would overwrite the model");
    assert_usage_error(&d, "build lamp.chart -o new.xml --names ./new.xml", "cannot both be written");
    assert_usage_error(&d, "build lamp.chart -o - --names -", "cannot both be written");
    assert_usage_error(&d, "build lamp.chart -o - --format json", "standard output");
    assert_eq!(d.names(), ["lamp.chart", "lamp.xml"]);
    assert_eq!(d.read("lamp.chart"), LAMP);
    assert_eq!(d.read("lamp.xml"), LAMP);
}

#[test]
fn every_command_has_help_that_teaches() {
    let d = Scratch::new("help");
    for sub in ["", "check", "build", "show", "stats", "explain"] {
        let output = chartwright(d.path(), &format!("{sub} --help"));
        assert_eq!(code(&output), 0, "{sub}");
        for part in ["Usage: chartwright", "Examples:", "Exit codes:"] {
            assert!(stdout(&output).contains(part), "{sub}: {part}");
        }
    }
    let output = chartwright(d.path(), "--version");
    assert_eq!(stdout(&output), concat!("chartwright ", env!("CARGO_PKG_VERSION"), "\n"));
}

#[test]
fn a_right_model_is_checked_in_silence_but_for_the_count() {
    let d = Scratch::new("right");
    d.write("lamp.chart", LAMP);
    let output = chartwright(d.path(), "check lamp.chart");
    assert_eq!(code(&output), 0);
    assert_eq!((stdout(&output), stderr(&output)), ("", "no errors, no warnings\n"));
    assert_eq!(d.names(), ["lamp.chart"]);
}

#[test]
fn files_that_cannot_be_read_are_errors() {
    let d = Scratch::new("unreadable");
    d.write("latin.chart", b"machine Lamp \"\xe9\"");
    d.write("empty.chart", "");
    d.write("blank.chart", " \n\t\r\n");
    d.write("comment.chart", "// nothing\n");
    assert_wrong_input(&d, "check missing.chart", "error[E001]: `missing.chart` cannot be read: there is no such file");
    assert_wrong_input(&d, "check .", "error[E001]: `.` cannot be read: it is a directory");
    assert_wrong_input(&d, "check empty.chart/x", "error[E001]");
    assert_wrong_input(&d, "check latin.chart", "error[E002]");
    assert_wrong_input(&d, "check empty.chart", "error[E003]");
    assert_wrong_input(&d, "check blank.chart", "error[E003]");
    assert_wrong_input(&d, "check comment.chart", "error[E0");
    assert_wrong_input(&d, "build missing.chart", "error[E001]");
    assert_wrong_input(&d, "stats missing.chart", "error[E001]");
}

#[test]
fn a_byte_order_mark_and_other_line_ends_are_taken() {
    let d = Scratch::new("bom");
    d.write("lamp.chart", format!("\u{feff}{}", LAMP.replace('\n', "\r\n")));
    let output = chartwright(d.path(), "check lamp.chart");
    assert_eq!(code(&output), 0, "{}", stderr(&output));
}

#[test]
fn size_and_nesting_are_limited() {
    let d = Scratch::new("limits");
    d.write("huge.chart", vec![b' '; limits::SOURCE_BYTES + 1]);
    assert_wrong_input(&d, "check huge.chart", "error[E004]");
    for (name, open) in [("braces", "state S {"), ("parentheses", "(")] {
        d.write(&format!("{name}.chart"), format!("machine M chart C {{ {}", open.repeat(1_000_000)));
        assert_wrong_input(&d, &format!("check {name}.chart"), "error[E005]");
    }
    let operators = format!("{LAMP}safety supervisor {{ S: never {} LAMP }}", "not ".repeat(1_000_000));
    d.write("not.chart", operators);
    let output = chartwright(d.path(), "check not.chart");
    assert!([0, 1].contains(&code(&output)), "{}", stderr(&output));
}

/// Endless, and no file: only as much is read as is needed to refuse it.
#[test]
#[cfg(unix)]
fn a_device_without_end_is_refused() {
    let d = Scratch::new("device");
    assert_wrong_input(&d, "check /dev/zero", "error[E004]");
}

#[test]
fn one_run_reports_several_errors() {
    let d = Scratch::new("several");
    d.write("wrong.chart", WRONG);
    d.write("lamp.chart", LAMP);
    let output = chartwright(d.path(), "check wrong.chart lamp.chart missing.chart");
    assert_eq!(code(&output), 1);
    for part in ["error[E312]", "wrong.chart:2:7", "error[E104]", "wrong.chart:9:23", "error[E001]", "3 errors, "] {
        assert!(stderr(&output).contains(part), "{part}: {}", stderr(&output));
    }
}

#[test]
fn many_errors_are_counted_and_not_all_shown() {
    let d = Scratch::new("many");
    let lines: String = (0..1000).map(|i| format!("  from Off to Nowhere{i} when Switch\n")).collect();
    d.write("many.chart", LAMP.replace("  state On\n", &format!("  state On\n{lines}")));
    let output = chartwright(d.path(), "check many.chart");
    assert_eq!(code(&output), 1);
    assert_eq!(stderr(&output).matches("error[").count(), limits::REPORTED_ERRORS);
    assert!(stderr(&output).contains("1000 errors, "), "{}", stderr(&output));
    assert!(stderr(&output).contains("(950 of them not shown)"), "{}", stderr(&output));
    let output = chartwright(d.path(), "check --format json many.chart");
    let json = json(&output);
    assert_eq!(json["files"][0]["diagnostics"].as_array().unwrap().len(), limits::REPORTED_ERRORS);
    assert_eq!((&json["errors"], &json["omitted"]), (&Value::from(1000), &Value::from(950)));
}

/// A line of megabytes is not shown; where and what is.
#[test]
fn absurdly_long_lines_are_not_shown() {
    let d = Scratch::new("line");
    let states: String = (0..100).map(|i| format!("state S{i} at Off ")).collect();
    d.write("line.chart", LAMP.replace("  state On", &format!("{states}{}{states} state On", " ".repeat(5_000_000))));
    let output = chartwright(d.path(), "check line.chart");
    assert_eq!(code(&output), 1);
    assert!(stderr(&output).len() < 20_000);
    assert!(stderr(&output).contains("line.chart:8:5001697\n"), "{}", stderr(&output));
    assert!(stderr(&output).contains("note: 8:7: first declared here\n"), "{}", stderr(&output));
}

#[test]
fn json_says_the_same_as_the_text() {
    let d = Scratch::new("json");
    d.write("wrong.chart", WRONG);
    let output = chartwright(d.path(), "check --format json wrong.chart");
    assert_eq!((code(&output), stderr(&output)), (1, ""));
    let json = json(&output);
    assert_eq!(json["command"], "check");
    assert_eq!(json["errors"], 2);
    let file = &json["files"][0];
    assert_eq!(file["file"], "wrong.chart");
    let unknown = file["diagnostics"].as_array().unwrap().iter().find(|d| d["code"] == "E104").unwrap();
    assert_eq!(unknown["severity"], "error");
    assert_eq!(unknown["title"], "a name is not declared");
    let label = &unknown["labels"][0];
    let place = ["line", "column", "endLine", "endColumn"].map(|key| label[key].as_u64().unwrap());
    assert_eq!(place, [9, 23, 9, 28]);
    let bytes = ["start", "end"].map(|key| label[key].as_u64().unwrap() as usize);
    assert_eq!(&WRONG[bytes[0]..bytes[1]], "Swich");
    assert_eq!(unknown["help"][0], "did you mean `Switch`?");
    assert!(unknown["message"].is_string() && label["text"].is_string());
}

#[test]
fn json_columns_count_characters() {
    let d = Scratch::new("columns");
    d.write("lamp.chart", LAMP.replace("when Switch", "\"é\" when").replace("  from Off to On \"é\" when", "  \t/é"));
    let output = chartwright(d.path(), "check --format json lamp.chart");
    let json = json(&output);
    let label = &json["files"][0]["diagnostics"][0]["labels"][0];
    let (line, column) = (label["line"].as_u64().unwrap(), label["column"].as_u64().unwrap());
    let human = chartwright(d.path(), "check lamp.chart");
    assert!(stderr(&human).contains(&format!("lamp.chart:{line}:{column}\n")), "{}", stderr(&human));
}

#[test]
fn build_writes_beside_the_model() {
    let d = Scratch::new("build");
    d.write("lamp.chart", LAMP);
    let output = chartwright(d.path(), "build lamp.chart --names names.csv");
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert_eq!(d.names(), ["lamp.chart", "lamp.xml", "names.csv"]);
    let xml = d.read("lamp.xml");
    let document = roxmltree::Document::parse(&xml).unwrap();
    assert_eq!(document.root_element().tag_name().name(), "project");
    assert!(xml.contains("creationDateTime=\"1970-01-01T00:00:00\""));
    assert!(
        stderr(&output).contains(&format!("lamp.xml written: {} bytes, proved\n", xml.len())),
        "{}",
        stderr(&output)
    );
    assert_eq!(stdout(&output), "");
    // The same on standard output, and again over the first.
    let output = chartwright(d.path(), "build lamp.chart -o -");
    assert_eq!(stdout(&output), xml);
    let output = chartwright(d.path(), "build lamp.chart --format json");
    assert_eq!(code(&output), 0);
    let json = json(&output);
    assert_eq!(json["written"][0]["what"], "program");
    assert_eq!(json["written"][0]["path"], "lamp.xml");
    assert_eq!(json["written"][0]["bytes"], xml.len());
    assert_eq!(d.read("lamp.xml"), xml);
    let output = chartwright(d.path(), "build lamp.chart -o other.xml --dialect codesys");
    assert_eq!(code(&output), 0);
    assert_ne!(d.read("other.xml"), xml);
    assert_eq!(d.names(), ["lamp.chart", "lamp.xml", "names.csv", "other.xml"]);
}

#[test]
fn the_time_of_creation_comes_from_the_environment() {
    let d = Scratch::new("epoch");
    d.write("lamp.chart", LAMP);
    let build =
        |epoch: &str| command(d.path(), "build lamp.chart -o -").env("SOURCE_DATE_EPOCH", epoch).output().unwrap();
    assert!(stdout(&build("951782400")).contains("creationDateTime=\"2000-02-29T00:00:00\""));
    for wrong in ["", "yesterday", "-1", "99999999999999999999"] {
        let output = build(wrong);
        assert_eq!(code(&output), 2, "{wrong}");
        assert!(stderr(&output).contains("SOURCE_DATE_EPOCH"), "{}", stderr(&output));
    }
}

#[test]
fn nothing_is_written_if_there_are_errors() {
    let d = Scratch::new("nothing");
    d.write("wrong.chart", WRONG);
    d.write("wrong.xml", "as it was");
    assert_wrong_input(&d, "build wrong.chart --names names.csv", "error[E312]");
    assert_wrong_input(&d, "build wrong.chart -o -", "error[E312]");
    assert_eq!(d.names(), ["wrong.chart", "wrong.xml"]);
    assert_eq!(d.read("wrong.xml"), "as it was");
}

#[test]
fn a_place_that_cannot_be_written_is_an_error_and_leaves_nothing() {
    let d = Scratch::new("unwritable");
    d.write("lamp.chart", LAMP);
    std::fs::create_dir(d.path().join("taken")).unwrap();
    assert_wrong_input(&d, "build lamp.chart -o taken", "error[E001]: `taken` cannot be written: it is a directory");
    assert_wrong_input(
        &d,
        "build lamp.chart -o no/where.xml",
        "`no/where.xml` cannot be written: there is no such directory",
    );
    assert_wrong_input(&d, "build lamp.chart -o lamp.chart/x", "error[E001]");
    // The names fail, so the program is not written either.
    assert_wrong_input(&d, "build lamp.chart --names taken", "error[E001]: `taken` cannot be written");
    assert_eq!(d.names(), ["lamp.chart", "taken"]);
    assert!(std::fs::read_dir(d.path().join("taken")).unwrap().next().is_none());
    d.write("kept.xml", "as it was");
    let mut rights = std::fs::metadata(d.path().join("kept.xml")).unwrap().permissions();
    rights.set_readonly(true);
    std::fs::set_permissions(d.path().join("kept.xml"), rights).unwrap();
    assert_wrong_input(&d, "build lamp.chart -o kept.xml", "`kept.xml` cannot be written: permission is denied");
    assert_eq!(d.read("kept.xml"), "as it was");
    let output = chartwright(d.path(), "build lamp.chart -o kept.xml --format json");
    let json = json(&output);
    assert_eq!(json["files"][1]["file"], "kept.xml");
    assert_eq!(json["files"][1]["diagnostics"][0]["code"], "E001");
    assert_eq!(json["written"], Value::Array(Vec::new()));
    assert_eq!(d.names(), ["kept.xml", "lamp.chart", "taken"]);
}

#[test]
#[cfg(unix)]
fn links_and_devices_stay_what_they_are() {
    let d = Scratch::new("links");
    d.write("lamp.chart", LAMP);
    d.write("real.xml", "old");
    std::os::unix::fs::symlink("real.xml", d.path().join("link.xml")).unwrap();
    std::os::unix::fs::symlink("lamp.chart", d.path().join("model.xml")).unwrap();
    assert_eq!(code(&chartwright(d.path(), "build lamp.chart -o link.xml")), 0);
    assert!(d.path().join("link.xml").is_symlink());
    assert!(d.read("real.xml").starts_with("<?xml"));
    assert_usage_error(&d, "build lamp.chart -o model.xml", "would overwrite the model");
    assert_eq!(code(&chartwright(d.path(), "build lamp.chart -o /dev/null")), 0);
    assert_wrong_input(&d, "build lamp.chart -o /dev/full", "`/dev/full` cannot be written: the disk is full");
    assert_eq!(d.names(), ["lamp.chart", "link.xml", "model.xml", "real.xml"]);
}

#[test]
#[cfg(unix)]
fn a_reader_that_has_gone_makes_no_noise() {
    let d = Scratch::new("gone");
    d.write("lamp.chart", LAMP);
    for arguments in ["explain E101", "stats lamp.chart", "check --format json lamp.chart", "--help"] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = command(d.path(), arguments).stdout(writer).output().unwrap();
        assert_eq!(code(&output), 0, "{arguments}");
        assert!(!stderr(&output).contains("panic"), "{arguments}: {}", stderr(&output));
    }
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = command(d.path(), "build lamp.chart -o -").stdout(writer).output().unwrap();
    assert_eq!(code(&output), 1);
    assert!(stderr(&output).contains("standard output cannot be written: the reader has gone"), "{}", stderr(&output));
}

#[test]
fn colours_are_for_terminals() {
    let d = Scratch::new("colours");
    d.write("wrong.chart", WRONG);
    let run = |variables: &[(&str, &str)]| {
        let output = command(d.path(), "check wrong.chart").envs(variables.iter().copied()).output().unwrap();
        stderr(&output).contains('\u{1b}')
    };
    assert!(!run(&[]));
    assert!(run(&[("CLICOLOR_FORCE", "1")]));
    assert!(!run(&[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")]));
}

#[test]
fn stats_counts() {
    let d = Scratch::new("stats");
    d.write("lamp.chart", LAMP);
    d.write("wrong.chart", WRONG);
    let output = chartwright(d.path(), "stats lamp.chart");
    assert_eq!(code(&output), 0);
    assert!(stdout(&output).contains("\n  elementary states         2\n"), "{}", stdout(&output));
    let output = chartwright(d.path(), "stats --format json lamp.chart");
    let json = json(&output);
    assert_eq!(json["stats"]["machine"]["macroStates"], 1);
    assert_eq!(json["stats"]["machine"]["levels"], 1);
    assert!(json["stats"]["program"]["steps"].as_u64().unwrap() >= 2);
    assert_wrong_input(&d, "stats wrong.chart", "error[E312]");
}

#[test]
fn every_stage_is_shown() {
    let d = Scratch::new("show");
    d.write("lamp.chart", LAMP);
    d.write("wrong.chart", WRONG);
    for (stage, says) in [
        ("tree", "chart"),
        ("chart", "machine"),
        ("sfc", "S_Off -> S_On"),
        ("ladder", "LD Outputs"),
        ("names", "name,kind,program,model,line,column,description\n"),
    ] {
        let output = chartwright(d.path(), &format!("show lamp.chart --stage {stage}"));
        assert_eq!(code(&output), 0, "{stage}: {}", stderr(&output));
        assert!(stdout(&output).contains(says), "{stage}: {}", stdout(&output));
        let output = chartwright(d.path(), &format!("show lamp.chart --stage {stage} --format json"));
        assert!(json(&output)["text"].as_str().unwrap().contains(says), "{stage}");
    }
    let chart = chartwright(d.path(), "show lamp.chart --stage chart");
    assert_eq!(stdout(&chartwright(d.path(), "show lamp.chart")), stdout(&chart));
    // What breaks a rule resolves all the same, and is shown beside the error.
    let output = chartwright(d.path(), "show wrong.chart --stage tree");
    assert_eq!((code(&output), stdout(&output).is_empty()), (0, false), "{}", stderr(&output));
    for stage in ["sfc", "ladder", "names"] {
        assert_wrong_input(&d, &format!("show wrong.chart --stage {stage}"), "error[E312]");
    }
}

/// The numbers that the paper gives for its machine (the paper on statecharts).
#[test]
fn indexa_has_the_published_size() {
    let output = chartwright(&repository("models"), "stats --format json indexa.chart");
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let machine = &json(&output)["stats"]["machine"];
    let size = ["macroStates", "elementaryStates", "levels"].map(|key| machine[key].as_u64().unwrap());
    assert_eq!(size, [32, 65, 5]);
}

#[test]
fn constraints_analyses_also_what_is_wrong() {
    let models = repository("models");
    let text = chartwright(&models, "constraints filter_combined.chart");
    assert_eq!((code(&text), stderr(&text)), (0, "no errors, no warnings\n"));
    assert!(stdout(&text).contains("  GO: C1 -> C2\n"), "{}", stdout(&text));
    let dot = chartwright(&models, "constraints --format dot filter_combined.chart");
    assert!(stdout(&dot).contains("digraph GO {") && stdout(&dot).contains("  0 -> 1;"), "{}", stdout(&dot));
    let wrong = chartwright(&models, "constraints --format json invalid/E407_contradicting_reliefs.chart");
    assert_eq!(code(&wrong), 1);
    let document = json(&wrong);
    assert_eq!(document["constraints"]["properties"][1]["holds"], false);
    assert_eq!(document["constraints"]["matrices"]["MX"], serde_json::json!([[0, 1], [1, 0]]));
    // Without a relief there is no filter, and no more to say.
    let nobody = json(&chartwright(&models, "constraints --format json invalid/E402_nobody_yields.chart"));
    assert_eq!(nobody["constraints"]["properties"].as_array().map(Vec::len), Some(1));
    let unknown = chartwright(&models, "constraints invalid/E104_unknown_name.chart");
    assert_eq!((code(&unknown), stdout(&unknown)), (1, ""));
}

#[test]
fn what_a_run_left_that_was_ended_while_it_wrote_is_removed_by_the_next_one() {
    let d = Scratch::new("leftovers");
    d.write("lamp.chart", LAMP);
    let left = [".chartwright-4194305-0.tmp", ".chartwright-7-12.tmp"];
    // One of a run that may still be writing, and what only looks like one.
    let kept = [".chartwright-4194306-0.tmp", ".chartwright-notes-1.tmp", ".chartwright-1-1.tmp.old", "1-0.tmp"];
    for name in left.iter().chain(&kept) {
        d.write(name, "<project>");
        if *name != kept[0] {
            let file = std::fs::File::options().write(true).open(d.path().join(name)).expect("it has been written");
            let old = std::time::SystemTime::now() - std::time::Duration::from_secs(2 * 60 * 60);
            file.set_modified(old).expect("a time can be set");
        }
    }
    assert_eq!(code(&chartwright(d.path(), "build lamp.chart -o lamp.xml")), 0);
    for name in left {
        assert!(!d.path().join(name).exists(), "{name}");
    }
    for name in kept {
        assert!(d.path().join(name).exists(), "{name}");
    }
}
