//! What goes where: reports to standard output, messages to standard error, results into files that are whole or not
//! there. What cannot be written is an error, whichever command has made it.

use crate::support::binary::{Scratch, chartwright, code, command, stderr, stdout};
use crate::support::models::{all, repository};

/// A lamp, a property that does not hold and a scenario that does.
const LAMP: &str = "\
machine Lamp
cycle 10ms
inputs  { Switch at %IX0.0  Spare }
outputs { LAMP at %QX0.0 }
actuator Light onoff by LAMP
chart Lamp controls Light {
  initial state Off
  state On
  from Off to On when Switch
  from On to Off when not Switch
}
safety supervisor { S1: never LAMP and not Switch \"dark when it is off\" }
properties { P1: never LAMP \"it stays dark\" }
scenario \"switched on\" { set Switch wait 2 scans expect LAMP }
";

/// A place with the model, its program and a run that refutes its property.
fn place(name: &str) -> Scratch {
    let d = Scratch::new(name);
    d.write("lamp.chart", LAMP);
    d.write("inputs.csv", "scan,Switch\n2,1\n4,0\n");
    assert_eq!(code(&chartwright(d.path(), "build lamp.chart")), 0);
    d.write("wrong.xml", d.read("lamp.xml").replacen("NOT Switch", "Switch", 1));
    assert_eq!(code(&chartwright(d.path(), "export lamp.chart --format aag")), 0);
    let head = d.read("lamp.aag");
    let mut numbers = head.split_whitespace().skip(2).map(|n| n.parse::<usize>().expect("a number"));
    let (inputs, latches) = (numbers.next().expect("inputs"), numbers.next().expect("latches"));
    let on: String = (0..inputs).map(|_| '1').collect();
    let dark: String = (0..latches).map(|_| '0').collect();
    d.write("found", format!("1\nb0\n{dark}\n{on}\n{on}\n{on}\n.\n"));
    d
}

/// Commands that report something, with the exit code and what stands in the report.
const REPORTS: [(&str, i32, &str); 17] = [
    ("test lamp.chart", 0, "2 passed, 0 failed"),
    ("verify lamp.chart", 1, "violated  P1"),
    ("verify lamp.chart --needed", 1, "P1"),
    ("verify lamp.chart --format json", 1, "\"violated\""),
    ("prove lamp.chart lamp.xml", 0, "proved: one scan"),
    ("prove lamp.chart wrong.xml", 1, "scan"),
    ("prove lamp.chart inputs.csv", 1, "undecided"),
    ("replay lamp.chart found", 0, "P1 (line 13): never LAMP; the condition is TRUE in scan 2"),
    ("constraints lamp.chart", 0, "S1"),
    ("constraints lamp.chart --format dot", 0, "digraph"),
    ("stats lamp.chart", 0, "elementary states"),
    ("show lamp.chart --stage ladder", 0, "LD Outputs"),
    ("explain E101", 0, "# E101"),
    ("explain", 0, "E101  "),
    ("simulate lamp.chart --scans 3", 0, "inputs"),
    ("simulate lamp.chart --inputs inputs.csv --output csv", 0, "Switch"),
    ("check --format json lamp.chart", 0, "\"warnings\": 1"),
];

#[test]
fn reports_go_to_standard_output_and_messages_to_standard_error() {
    let d = place("outputs_where");
    for (arguments, expected, says) in REPORTS {
        let output = chartwright(d.path(), arguments);
        assert_eq!(code(&output), expected, "{arguments}: {}{}", stdout(&output), stderr(&output));
        assert!(stdout(&output).contains(says), "{arguments}: {}", stdout(&output));
        // A warning is a message, and no line of the report is one.
        assert!(!stdout(&output).contains("warning["), "{arguments}: {}", stdout(&output));
        let lines = stdout(&output).lines().map(str::trim).filter(|l| l.len() > 20);
        for line in lines {
            assert!(!stderr(&output).contains(line), "{arguments}: {line} is said twice");
        }
    }
    // What is only done is said, and what is wrong.
    for (arguments, expected, says) in [
        ("check lamp.chart", 0, "warning[W502]"),
        ("build lamp.chart -o new.xml --names new.csv", 0, "new.csv written: "),
        ("export lamp.chart --format aiger", 0, "lamp.aig written: "),
        ("verify missing.chart", 1, "error[E001]"),
        ("verify lamp.chart --without S9", 1, "E104"),
        ("test lamp.chart --filter nowhere", 1, "error: "),
        ("explain E999", 2, "error: there is no code"),
        ("simulate lamp.chart --scenario none", 1, "error: there is no scenario"),
        ("replay lamp.chart inputs.csv", 1, "E803"),
    ] {
        let output = chartwright(d.path(), arguments);
        assert_eq!(code(&output), expected, "{arguments}: {}", stderr(&output));
        assert!(stderr(&output).contains(says), "{arguments}: {}", stderr(&output));
        assert_eq!(stdout(&output), "", "{arguments}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_report_that_cannot_be_written_is_an_error_in_every_command() {
    let d = place("outputs_full");
    let full = || std::fs::OpenOptions::new().write(true).open("/dev/full").expect("the device is there");
    let more =
        ["build lamp.chart -o -", "build lamp.chart --names -", "test lamp.chart --junit -", "--help", "--version"];
    let exports = ["aiger", "aag", "aiger-1.9", "btor2", "smv"].map(|f| format!("export lamp.chart -o - --format {f}"));
    let reports = REPORTS.iter().map(|(arguments, ..)| *arguments).chain(more);
    for arguments in reports.chain(exports.iter().map(String::as_str)) {
        let output = command(d.path(), arguments).stdout(full()).output().expect("the binary runs");
        assert_eq!(code(&output), 1, "{arguments}: {}", stderr(&output));
        assert!(
            stderr(&output).contains("error[E001]: standard output cannot be written: the disk is full"),
            "{arguments}: {}",
            stderr(&output)
        );
    }
    // A session, too, though nobody looks at a prompt.
    let mut session = command(d.path(), "simulate lamp.chart");
    d.write("words", "step 3\nquit\n");
    session.stdin(std::fs::File::open(d.path().join("words")).expect("it is there")).stdout(full());
    assert_eq!(code(&session.output().expect("the binary runs")), 1);
}

#[test]
#[cfg(target_os = "linux")]
fn a_file_that_cannot_be_written_is_an_error_in_every_command() {
    let d = place("outputs_files");
    d.write("kept", "as it was");
    let before = d.names();
    for (arguments, file) in [
        ("build lamp.chart -o OUT", "OUT"),
        ("build lamp.chart -o - --names OUT", "OUT"),
        ("test lamp.chart --junit OUT", "OUT"),
        ("simulate lamp.chart --scans 3 -o OUT", "OUT"),
        ("verify lamp.chart --vcd OUT", "OUT"),
        ("verify lamp.chart --scenario OUT", "OUT"),
        ("replay lamp.chart found --vcd OUT", "OUT"),
        ("replay lamp.chart found --scenario OUT", "OUT"),
        ("export lamp.chart --format aiger -o OUT", "OUT"),
        ("export lamp.chart --format btor2 -o OUT", "OUT"),
        ("export lamp.chart --format smv -o OUT", "OUT"),
    ] {
        for (out, why) in [
            ("/dev/full", "the disk is full"),
            (".", "it is a directory"),
            ("none/file", "there is no such directory"),
            ("kept/file", "a part of the path is no directory"),
            ("/proc/file", "cannot be written"),
        ] {
            let arguments = arguments.replace(file, out);
            let output = chartwright(d.path(), &arguments);
            assert_eq!(code(&output), 1, "{arguments}: {}", stderr(&output));
            let said = stderr(&output);
            assert!(said.contains("error[E001]") && said.contains(why), "{arguments}: {said}");
        }
        // A pipe or a device that takes it is no file to be replaced.
        let output = chartwright(d.path(), &arguments.replace(file, "/dev/null"));
        assert!(!stderr(&output).contains("error["), "{arguments}: {}", stderr(&output));
    }
    assert_eq!(d.names(), before, "nothing is left half-written");
    assert_eq!(d.read("kept"), "as it was");
}

#[test]
#[cfg(unix)]
fn a_reader_that_goes_early_changes_no_verdict() {
    let d = place("outputs_gone");
    for (arguments, expected, _) in REPORTS {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let output = command(d.path(), arguments).stdout(writer).output().expect("the binary runs");
        assert_eq!(code(&output), expected, "{arguments}: {}", stderr(&output));
        assert!(!stderr(&output).contains("E001"), "{arguments}: {}", stderr(&output));
    }
}

#[test]
fn a_test_that_plays_nothing_fails_unless_told_otherwise() {
    let d = place("outputs_nothing");
    d.write("bare.chart", LAMP.split("scenario").next().expect("a beginning"));
    for (arguments, says) in [
        ("test bare.chart", "no scenario was played: the model has none\n"),
        ("test bare.chart bare.chart", "no scenario was played: the models have none\n"),
        ("test lamp.chart --filter nothing_like_that", "the model has none whose name holds `nothing_like_that`\n"),
        ("test lamp.chart bare.chart --filter nothing", "the models have none whose name holds `nothing`\n"),
        ("test lamp.chart --filter none --junit report.xml", "no scenario was played"),
        ("test lamp.chart --filter none --format json", "no scenario was played"),
    ] {
        let output = chartwright(d.path(), arguments);
        assert_eq!(code(&output), 1, "{arguments}");
        assert!(stderr(&output).starts_with("error: ") && stderr(&output).contains(says), "{}", stderr(&output));
        let output = chartwright(d.path(), &format!("{arguments} --allow-empty"));
        assert_eq!(code(&output), 0, "{arguments}");
        assert!(stderr(&output).starts_with("note: ") && stderr(&output).contains(says), "{}", stderr(&output));
    }
    // One that is played is enough, and a wrong model is one whatever is played.
    assert_eq!(code(&chartwright(d.path(), "test bare.chart lamp.chart")), 0);
    d.write("wrong.chart", LAMP.replace("when Switch", "when Swich"));
    assert_eq!(code(&chartwright(d.path(), "test wrong.chart --allow-empty")), 1);
    // So it is with all models that are shipped: each has scenarios, or says nothing by having none.
    for model in all().iter().filter(|m| !m.source.contains("\nscenario")) {
        let output = chartwright(&repository("models"), &format!("test {}.chart", model.name));
        assert!([1, 2].contains(&code(&output)), "{}", model.name);
    }
}
