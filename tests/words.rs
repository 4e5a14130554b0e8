//! Words that PLCs keep to themselves, and addresses: what a signal cannot be called, and where it cannot be.

use crate::support::models::repository;
use chartwright::base::{iec, limits, words};
use chartwright::ir::chart::Machine;
use chartwright::ir::plc::Body;
use chartwright::pipeline::{self, Dialect, Options};
use std::collections::BTreeSet;
use std::fmt::Write;

fn codes(source: &str) -> Vec<&'static str> {
    let mut codes: Vec<_> = pipeline::check(source).1.iter().map(|d| d.code.number()).collect();
    codes.retain(|c| c.starts_with('E'));
    codes
}

/// Words as each of what goes into the program unchanged, in turn, in one case or the other.
fn declared(names: &[String]) -> String {
    let mut lists = [String::new(), String::new(), String::new(), String::new(), String::new()];
    for (i, name) in names.iter().enumerate() {
        let list = &mut lists[i % 5];
        let _ = if i % 5 == 3 {
            write!(list, "{name} : 0..3 ")
        } else if i % 5 == 2 {
            write!(list, "{name} : BOOL ")
        } else {
            write!(list, "{name} ")
        };
    }
    let [inputs, outputs, variables, integers, events] = lists;
    let actuators: String =
        outputs.split_whitespace().enumerate().map(|(i, o)| format!("actuator A{i} onoff by {o} ")).collect();
    format!(
        "machine M inputs {{ {inputs} }} outputs {{ {outputs} }} variables {{ {variables} {integers} }} events {{ {events} }}
         {actuators} chart C {{ initial state S }}"
    )
}

#[test]
fn every_word_is_in_upper_case_and_could_be_a_name() {
    for (word, what) in words::listed() {
        assert_eq!(word, iec::fold(word));
        assert_eq!(iec::illegal(word), None, "{word}");
        assert_eq!(words::clash(&word.to_ascii_lowercase()), Some(what), "{word}");
    }
}

#[test]
fn forms_for_one_type_are_words() {
    let forms = "Int_To_Real TO_INT Time_Of_Day_To_Date REAL_TRUNC_INT TRUNC_DINT BCD_TO_UINT WORD_BCD_TO_UINT \
                 UINT_TO_BCD_WORD To_Bit XWORD_TO_DWORD ADD_INT Ctu_Dint MUX_INT_BOOL MAX_TIME EQ_TIME_OF_DAY";
    for word in forms.split(' ') {
        assert!(words::clash(word).is_some(), "{word}");
    }
    for name in "In_To_Out TO_Box Way_To_Int MUX_Lamp_BOOL Count_INT Time_To_Go Max_Time_Of_Box IN".split(' ') {
        assert_eq!(words::clash(name), None, "{name}");
    }
}

#[test]
fn every_word_is_refused_with_a_name_that_is_not() {
    // In both cases, which is no word of the language.
    let mixed = |word: &str| format!("{}{}", &word[..1], word[1..].to_ascii_lowercase());
    let all: Vec<String> = words::listed().map(|(word, _)| mixed(word)).collect();
    assert!(all.len() > 500, "{}", all.len());
    let mut proposals = Vec::new();
    for some in all.chunks(40) {
        let (_, diagnostics) = pipeline::check(&declared(some));
        let refused: Vec<_> = diagnostics.iter().filter(|d| d.code.number() == "E107").collect();
        assert_eq!(refused.len(), some.len(), "{some:?}\n{diagnostics:?}");
        for d in refused {
            let proposal = d.help[0].split('`').nth(1).unwrap_or_else(|| panic!("{d:?}"));
            proposals.push(proposal.to_owned());
        }
    }
    for some in proposals.chunks(40) {
        assert_eq!(codes(&declared(some)), Vec::<&str>::new(), "{some:?}");
    }
}

#[test]
fn a_keyword_that_ends_something_is_in_no_name() {
    let ends =
        ["END_PROGRAM", "END_FUNCTION", "END_FUNCTION_BLOCK", "END_CONFIGURATION", "END_TRANSITION", "END_ACTION"];
    for end in ends.into_iter().flat_map(|e| [e.to_owned(), e.to_ascii_lowercase(), e.replace("ND", "nd")]) {
        for name in [format!("At_{end}"), format!("{end}_2"), format!("The{end}ner"), format!("{end}_{end}")] {
            let broken = words::without_ends(&name);
            assert!(words::clash(&name).is_some(), "{name}");
            assert_eq!(words::clash(&broken), None, "{broken}");
            let signals = format!(
                "machine M inputs {{ {name} }} outputs {{ Q }} actuator L onoff by Q chart C {{ initial state S }}"
            );
            let (_, diagnostics) = pipeline::check(&signals);
            let d = diagnostics.iter().find(|d| d.code.number() == "E107").expect("a refusal");
            assert_eq!(d.help, [format!("call it `{broken}_I`, for example")]);
        }
        // States have a prefix, which leaves the keyword where it is.
        let states = format!(
            "machine M inputs {{ Go }} outputs {{ Q }} actuator L onoff by Q
             chart C {{ initial state End {{ initial state Program  state {end} {{ drives Q }}
               from Program to {end} when Go and after 1s }} state Endprogram from End to Endprogram when not Go }}"
        );
        for dialect in [Dialect::Beremiz, Dialect::Codesys] {
            let options = Options { dialect, created: "2000-01-01T00:00:00".into(), prove: true };
            let (output, diagnostics) = pipeline::build(&states, &options);
            let xml = output.unwrap_or_else(|| panic!("{diagnostics:?}")).xml.to_ascii_uppercase();
            for name in xml.split("NAME=\"").skip(1).filter_map(|rest| rest.split('"').next()) {
                assert!(!ends.iter().any(|end| name.contains(end)), "{name}");
            }
        }
    }
}

#[test]
fn a_word_is_said_with_its_target_and_a_name_that_is_free() {
    let said = |name: &str, more: &str| {
        let source = format!(
            "machine M inputs {{ {name} {more} }} outputs {{ Q }} actuator L onoff by Q chart C {{ initial state S }}"
        );
        let (_, diagnostics) = pipeline::check(&source);
        let d =
            diagnostics.iter().find(|d| d.code.number() == "E107").unwrap_or_else(|| panic!("{name}: {diagnostics:?}"));
        format!("{}; {}", d.message, d.help[0])
    };
    assert_eq!(said("Ramp", ""), "`Ramp` is a block in the library of Beremiz; call it `Ramp_I`, for example");
    assert_eq!(
        said("Eof", "EOF_I"),
        "`Eof` is a word of C, of which Beremiz makes the program; call it `Eof_I2`, for example"
    );
    assert_eq!(
        said("Buffer_Full", ""),
        "`Buffer_Full` is a word that Beremiz needs in the C code that it makes; call it `Buffer_Full_I`, for example"
    );
    assert_eq!(
        said("Union", ""),
        "`Union` is a keyword or operator of CODESYS and TwinCAT; call it `Union_I`, for example"
    );
    assert_eq!(
        said("SFCInit", ""),
        "`SFCInit` is a flag that CODESYS and TwinCAT give every SFC; call it `SFCInit_I`, for example"
    );
    assert_eq!(
        said("Int_To_Real", "").split(';').next(),
        Some("`Int_To_Real` is a standard function of IEC 61131-3 for one type")
    );
    // What is not in the program is free: hidden bits, and everything with a prefix.
    let free = "machine M inputs { Go } outputs { Q } actuator Ramp onoff by Q plant { hidden Pid }
         chart Integral { initial state Union  state Eof { drives Q } from Union to Eof when Go from Eof to Union when not Go }
         safety supervisor { Nan: never Q and not Go }";
    assert_eq!(codes(free), Vec::<&str>::new());
}

/// A model in which every word of the tables is a state, a region and a chart, and every name that is nearly one
/// is a signal.
pub fn full_of_words() -> String {
    let all: Vec<&str> = words::listed().map(|(word, _)| word).collect();
    // Words of compilers that are names to them where a variable stands, and names of ours.
    let near = "IN OUT CD CU CV PT ET PV Q Q1 QU QD R1 S1 FILE VOID SHORT LONG SIGNED STATIC REGISTER Config Res Cycle Conditions Variables \
                Outputs Filter Started Scan Main Program0 I_Filter Raise_Go S_S1 STEP_ X_S1 data value flags initialized";
    let near: Vec<String> = near
        .split_whitespace()
        .map(|w| w.trim_end_matches('_').to_owned())
        .filter(|w| words::clash(w).is_none() && w != "Q")
        .chain(all.iter().map(|w| format!("{w}_I")).filter(|w| words::clash(w).is_none()))
        .collect();
    let mut source =
        format!("machine Words\ninputs {{ {} }}\noutputs {{ Q }}\nactuator A onoff by Q\n", near.join(" "));
    for (n, some) in all.chunks(60).enumerate() {
        let _ = writeln!(source, "chart {} {{", some[0]);
        for (i, word) in some.iter().enumerate() {
            let initial = if i == 0 { "initial " } else { "" };
            let drives = if n == 0 && i == 1 { " { drives Q }" } else { "" };
            let _ = writeln!(source, "  {initial}state {word}{drives}");
        }
        for (i, word) in some.iter().enumerate() {
            let input = &near[(n * 60 + i) % near.len()];
            let _ = writeln!(source, "  from {word} to {} when {input}", some[(i + 1) % some.len()]);
        }
        let _ = writeln!(source, "}}");
    }
    let _ = writeln!(source, "chart Regions {{");
    for (i, word) in all.iter().take(40).enumerate() {
        let _ = writeln!(
            source,
            "  region {word} {{ initial state A{i}  state B{i}  from A{i} to B{i} when {}  from B{i} to A{i} when not {} }}",
            near[i], near[i]
        );
    }
    let _ = writeln!(source, "}}");
    source
}

#[test]
fn a_model_full_of_words_is_built_and_proved() {
    let source = full_of_words();
    for dialect in [Dialect::Beremiz, Dialect::Codesys] {
        let options = Options { dialect, created: "2000-01-01T00:00:00".into(), prove: true };
        let (output, diagnostics) = pipeline::build(&source, &options);
        let output = output.unwrap_or_else(|| panic!("{diagnostics:#?}"));
        // No name in the program is a word.
        for row in output.names.lines().skip(1) {
            let name = row.split(',').next().expect("a row begins with a name");
            assert_eq!(words::clash(name), None, "{row}");
        }
        if let (Dialect::Beremiz, Some(folder)) = (dialect, std::env::var_os("CHARTWRIGHT_RANDOM_KEEP")) {
            std::fs::write(std::path::Path::new(&folder).join("words.xml"), &output.xml).expect("the folder is there");
        }
    }
}

/// Every name in the program that a model becomes.
fn names(source: &str) -> Vec<String> {
    let (machine, diagnostics) = pipeline::check(source);
    let project = pipeline::lower(&machine.unwrap_or_else(|| panic!("{diagnostics:?}\n{source}")));
    let mut names: Vec<String> = project.globals.values().map(|g| g.name.clone()).collect();
    names.extend([&project.task.name, &project.task.configuration, &project.task.resource].map(Clone::clone));
    for program in &project.programs {
        names.extend([program.name.clone(), program.instance.clone()]);
        if let Body::Sfc(sfc) = &program.body {
            names.extend(sfc.steps.values().map(|s| s.name.clone()));
        }
    }
    names
}

/// The other letters of a name in lower case, the others in upper case.
fn mixed(name: &str) -> String {
    let case = |(i, c): (usize, char)| if i % 2 == 0 { c.to_ascii_lowercase() } else { c.to_ascii_uppercase() };
    name.chars().enumerate().map(case).collect()
}

#[test]
fn what_is_generated_gives_way_to_signals_of_its_name() {
    let read = |name: &str| {
        std::fs::read_to_string(repository("models").join(format!("{name}.chart"))).expect("a model of ours")
    };
    let models =
        "counter counting_observer filter_blocking filter_combined functions history relief_in_order timer choice";
    let models = models.split(' ').map(read).chain([crate::texts::MODEL.to_owned()]);
    for model in models {
        let mut signals: Vec<String> = Vec::new();
        // What gives way gets another name, and so it goes on.
        for round in 0..3 {
            let source =
                format!("{model}\ninputs {{ {} }}", signals.iter().map(|s| format!("{s} ")).collect::<String>());
            let all = names(&source);
            let distinct: BTreeSet<String> = all.iter().map(|n| iec::fold(n)).collect();
            assert_eq!(distinct.len(), all.len(), "two things have one name: {all:?}");
            let kept = |s: &String| all.contains(s);
            assert!(signals.iter().all(kept), "a signal keeps its name");
            let legal =
                |n: &str| iec::illegal(n).is_none() && words::clash(n).is_none() && n.len() <= limits::NAME_LENGTH;
            let own = |n: &&String| !signals.contains(n) && legal(n);
            let fresh: Vec<String> = all.iter().filter(own).map(|n| mixed(n)).collect();
            assert!(fresh.len() > 10, "round {round}: {all:?}");
            // Names of the model itself are taken.
            let (machine, _) = pipeline::check(&model);
            let machine = machine.expect("a model without errors");
            let taken: BTreeSet<String> = machine
                .inputs
                .values()
                .map(|i| &i.name)
                .chain(machine.outputs.values().map(|o| &o.name))
                .chain(machine.variables.values().map(|v| &v.name))
                .chain(machine.events.values().map(|e| &e.name))
                .chain(machine.integers.values().map(|i| &i.name))
                .map(|n| iec::fold(n))
                .chain(machine.plant.bits.values().map(|b| iec::fold(&b.name)))
                .chain(machine.plant.counts.values().map(|c| iec::fold(&c.name)))
                .collect();
            signals.extend(fresh.into_iter().filter(|n| !taken.contains(&iec::fold(n))));
        }
    }
}

/// The addresses of inputs as the machine has them, or the code and message of what is wrong.
fn addresses(inputs: &str) -> Result<Vec<String>, String> {
    let source = format!(
        "machine M inputs {{ {inputs} }} outputs {{ Q at %QX0 }} actuator L onoff by Q chart C {{ initial state S }}"
    );
    let (machine, diagnostics): (Option<Machine>, _) = pipeline::check(&source);
    match machine {
        Some(m) => Ok(m.inputs.values().filter_map(|i| i.address.clone()).collect()),
        None => Err(diagnostics
            .iter()
            .filter(|d| d.code.number().starts_with('E'))
            .map(|d| format!("{}: {}", d.code.number(), d.message))
            .collect::<Vec<_>>()
            .join("; ")),
    }
}

#[test]
fn two_spellings_of_one_address_are_one() {
    assert_eq!(
        addresses("A at %ix0.1 B at %IX00.008 C at %Ix1.0.5"),
        Ok(vec!["%IX0.1".into(), "%IX0.8".into(), "%IX1.0.5".into()])
    );
    assert_eq!(addresses("A at %IX0 B at %IX17"), Ok(vec!["%IX0".into(), "%IX17".into()]));
    for (a, b) in [("%IX0.1", "%ix0.1"), ("%IX00.01", "%IX0.1"), ("%IX7", "%ix007")] {
        assert_eq!(
            addresses(&format!("A at {a} B at {b}")),
            Err("E102: `B` and `A` have one address".into()),
            "{a} {b}"
        );
    }
}

#[test]
fn addresses_that_could_be_one_bit_are_refused() {
    for (a, b) in [("%IX0.0", "%IX9"), ("%IX8", "%IX1.0"), ("%IX3.1.2.3", "%IX9")] {
        let said = addresses(&format!("A at {a} B at {b}"));
        assert_eq!(said, Err(format!("E102: `B` and `A` may have one address: {b} and {a}")), "{a} {b}");
    }
    for (a, b) in [("%IX0.1", "%IX0.1.0"), ("%IX0.1.7.3", "%IX0.1"), ("%IX4.5.6", "%IX4.5.6.7")] {
        let said = addresses(&format!("A at {a} C at %IX0.2.0 G at %IX0.0 B at {b}"));
        assert_eq!(said, Err("E102: `B` and `A` have addresses of which one begins with the other".into()), "{a} {b}");
    }
    assert!(addresses("A at %IX0.1 B at %IX0.10 C at %IX0.11.1 G at %IX1.1").is_ok());
}

#[test]
fn other_addresses_are_refused() {
    for address in [
        "%QX0.1",
        "%IW0",
        "%IB3",
        "%I0.0",
        "%MX0.0",
        "%IX",
        "%IX0.",
        "%IX.1",
        "%IX0..1",
        "%IX0.1.2.3.4",
        "%IX65536.0",
        "%IX0.x",
        "%IX*",
    ] {
        let said = addresses(&format!("A at {address}"));
        assert_eq!(said, Err(format!("E103: `{address}` is no address of an input")), "{address}");
    }
}
