//! One scan of a program in the proof is one scan of it on the simulator: for everything that the proof encodes,
//! much of which the compiler never writes. And what it cannot encode is refused.

use crate::support::rng::Rng;
use crate::support::st::{self, escaped};
use chartwright::bits::aig::{Aig, Lit};
use chartwright::ir::iec::{Kind, Project, VarId};
use chartwright::prove::program_step::{Latch, ProgramState, ProgramStep};
use chartwright::read;
use chartwright::simulate::plc::Plc;

const VARIABLES: [(&str, &str); 23] = [
    ("A", "BOOL"),
    ("B", "BOOL"),
    ("C", "BOOL"),
    ("P", "BOOL"),
    ("Q", "BOOL"),
    ("R", "BOOL"),
    ("I", "INT"),
    ("J", "INT"),
    ("S", "SINT"),
    ("U", "USINT"),
    ("V", "UINT"),
    ("D", "DINT"),
    ("W", "UDINT"),
    ("L", "LINT"),
    ("T", "TIME"),
    ("Up", "R_TRIG"),
    ("Down", "F_TRIG"),
    ("Keep", "SR"),
    ("Lose", "RS"),
    ("On", "TON"),
    ("Later", "TON"),
    ("Off", "TOF"),
    ("Pulse", "TP"),
];

/// The variables that are set before each scan.
const INPUTS: [&str; 3] = ["A", "B", "C"];

const CYCLE: i64 = 10_000;

fn text(text: &str) -> Project {
    project(&st::file(&VARIABLES, &format!("<ST><p>{}</p></ST>", escaped(text))))
}

fn project(file: &str) -> Project {
    let (project, diagnostics) = read::read(file);
    project.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

/// Runs a program for some hundred scans on both sides.
fn compare(project: &Project) {
    let step = ProgramStep::new(project).unwrap_or_else(|e| panic!("{e}"));
    let mut plc = Plc::new(project);
    let mut rng = Rng::new(7);
    let mut state: ProgramState = step.power_up();
    let mut started = vec![0; project.blocks.len()];
    let name = |name: &str| project.variables.iter().find(|(_, v)| v.name == name).expect("declared").0;
    for scan in 0..300 {
        let now = scan * CYCLE;
        let mut inputs = Vec::new();
        for input in INPUTS {
            let value = rng.chance(if scan % 2 == 0 { 30 } else { 60 });
            plc.write(name(input), i64::from(value));
            inputs.push((step.variable(name(input)).expect("a BOOL"), Lit::of(value)));
        }
        plc.scan(now);
        let clocks: Vec<Lit> =
            step.presets().iter().zip(&started).map(|(p, s)| Lit::of(p.is_some_and(|p| now >= s + p))).collect();
        state = step.scan(&mut Aig::new(), &state, &inputs, &clocks, &mut |_, _, _| {});
        let value = |latch: usize| state[latch].constant().expect("everything is known");
        for (block, _) in project.blocks.iter().filter(|(b, _)| step.presets()[b.index()].is_some()) {
            if value(step.block(block) + 3) {
                started[block.index()] = now;
            }
        }
        for (id, variable) in project.variables.iter() {
            let found = match variable.kind {
                Kind::Bool => i64::from(value(step.variable(id).expect("a BOOL"))),
                Kind::Int { .. } => number(&step, id, variable.kind, &value),
                Kind::Time => continue,
            };
            assert_eq!(found, plc.read(id), "scan {scan}: {}", variable.name);
        }
        for (latch, value) in step.latches().iter().zip(&state) {
            if let Latch::Step(program, id) = latch {
                assert_eq!(value.constant(), Some(plc.is_active(*program, *id)), "scan {scan}: {}", step.name(*latch));
            }
        }
    }
}

fn number(step: &ProgramStep<'_>, id: VarId, kind: Kind, value: &impl Fn(usize) -> bool) -> i64 {
    let bits = step.integer(id).expect("an integer");
    let width = bits.len();
    let found = bits.rev().fold(0_i64, |n, bit| n << 1 | i64::from(value(bit)));
    let negative = matches!(kind, Kind::Int { signed: true, .. }) && width < 64 && found >> (width - 1) == 1;
    if negative { found - (1 << width) } else { found }
}

#[test]
fn blocks_in_a_proof_do_what_they_do_in_a_simulator() {
    compare(&text("Up(CLK := A); Down(CLK := A); P := Up.Q; Q := Down.Q; R := P AND Q OR Up.Q XOR Down.Q;"));
    compare(&text("Keep(S1 := A, R := B); Lose(S := A, R1 := B); P := Keep.Q1; Q := Lose.Q1;"));
    compare(&text("On(IN := A OR B, PT := T#20ms); P := On.Q; Later(IN := NOT C OR B, PT := T#30ms); Q := Later.Q;"));
    compare(&text("P := A; P := P AND B OR C; Q := NOT P; R := Q = P <> C;"));
}

#[test]
fn integers_in_a_proof_are_those_of_a_simulator() {
    compare(&text("I := I + 1; J := J - I; S := S + 37; U := U - 11; V := V + 9999; D := D - 77777; W := W - 5;"));
    compare(&text("I := -J; J := J + 3; L := L - 1;"));
    for (name, kind) in [("I", "INT"), ("S", "SINT"), ("U", "USINT"), ("V", "UINT"), ("D", "DINT"), ("W", "UDINT")] {
        let small = if kind.starts_with('U') { "1" } else { "-1" };
        for relation in ["=", "<>", "<", "<=", ">", ">="] {
            compare(&text(&format!(
                "{name} := {name} + 83; P := {name} {relation} 77; Q := {small} {relation} {name};"
            )));
        }
    }
    compare(&text("I := I + 12345; J := J + 1; P := I + 1 > J; Q := I - J = J; R := -I < J - 100;"));
    let pins = |pins: &[(&str, u32)]| -> String {
        let pin = |(name, from): &(&str, u32)| {
            format!(
                r#"<variable formalParameter="{name}"><connectionPointIn><connection refLocalId="{from}"/></connectionPointIn></variable>"#
            )
        };
        pins.iter().map(pin).collect()
    };
    let boxed = |function: &str, inputs: &[(&str, u32)], to: &str, number: u32| {
        format!(
            r#"<block localId="{number}" typeName="{function}"><inputVariables>{}</inputVariables><inOutVariables/><outputVariables><variable formalParameter="OUT"/></outputVariables></block><outVariable localId="{}"><connectionPointIn><connection refLocalId="{number}" formalParameter="OUT"><position x="0" y="0"/></connection></connectionPointIn><expression>{to}</expression></outVariable>"#,
            pins(inputs),
            number + 1
        )
    };
    let values: String = [(2, "I"), (3, "J"), (4, "-3"), (5, "7"), (6, "5"), (7, "A")]
        .iter()
        .map(|(number, text)| format!(r#"<inVariable localId="{number}"><expression>{text}</expression></inVariable>"#))
        .collect();
    let body = [
        boxed("ADD", &[("IN1", 2), ("IN2", 6)], "I", 10),
        boxed("LIMIT", &[("MN", 4), ("IN", 2), ("MX", 5)], "I", 20),
        boxed("SEL", &[("G", 7), ("IN0", 2), ("IN1", 4)], "J", 30),
        boxed("SUB", &[("IN1", 3), ("IN2", 2)], "I", 40),
    ];
    compare(&project(&st::file(&VARIABLES, &format!("<LD>{values}{}</LD>", body.concat()))));
}

#[test]
fn coils_and_edges_in_a_proof_do_what_they_do_in_a_simulator() {
    let element = |tag: &str, number: u32, attributes: &str, from: u32, name: &str| {
        format!(
            r#"<{tag} localId="{number}" {attributes}><connectionPointIn><connection refLocalId="{from}"/></connectionPointIn><variable>{name}</variable></{tag}>"#
        )
    };
    let body = [
        r#"<leftPowerRail localId="1"/>"#.to_owned(),
        element("contact", 2, r#"edge="rising""#, 1, "A"),
        element("contact", 3, r#"edge="falling""#, 1, "B"),
        element("contact", 4, r#"negated="true""#, 1, "C"),
        element("coil", 5, r#"storage="set""#, 2, "P"),
        element("coil", 6, r#"storage="reset""#, 3, "P"),
        element("coil", 7, r#"negated="true""#, 4, "Q"),
        element("coil", 8, r#"edge="rising""#, 4, "R"),
    ];
    compare(&project(&st::file(&VARIABLES, &format!("<LD>{}</LD>", body.concat()))));
}

/// A chart of three steps, of which the middle one has associations.
fn chart(associations: &[(&str, &str)], more: &str) -> String {
    let from = |number: u32| format!(r#"<connectionPointIn><connection refLocalId="{number}"/></connectionPointIn>"#);
    let transition = |number: u32, before: u32, condition: &str| {
        format!(
            r#"<transition localId="{number}">{}<condition><inline name=""><ST><p>{condition}</p></ST></inline></condition></transition>"#,
            from(before)
        )
    };
    let block = |number: u32, step: u32, list: &[(&str, &str)]| {
        let actions: String = (1..)
            .zip(list)
            .map(|(i, (qualifier, target))| {
                format!(r#"<action localId="{number}{i}" {qualifier}><reference name="{target}"/></action>"#)
            })
            .collect();
        format!(r#"<actionBlock localId="{number}">{}{actions}</actionBlock>"#, from(step))
    };
    let body = [
        r#"<step localId="1" name="One" initialStep="true"/>"#.to_owned(),
        transition(2, 1, "A"),
        format!(r#"<step localId="3" name="Two">{}</step>"#, from(2)),
        block(40, 3, associations),
        transition(5, 3, "B"),
        format!(r#"<step localId="6" name="Three">{}</step>"#, from(5)),
        block(70, 6, &[(r#"qualifier="R""#, "P"), (r#"qualifier="R""#, "Act")]),
        transition(8, 6, "C"),
        format!(r#"<jumpStep localId="9" targetName="One">{}</jumpStep>"#, from(8)),
    ];
    let actions = format!(
        r#"<actions><action name="Act"><body><ST><p>I := I + 1; Q := NOT Q;</p></ST></body></action><action name="More"><body><ST><p>J := J + I; R := One.X OR Two.X AND C;</p></ST></body></action></actions>{more}<body><SFC>"#
    );
    st::file(&VARIABLES, &format!("<SFC>{}</SFC>", body.concat())).replacen("<body><SFC>", &actions, 1)
}

#[test]
fn actions_in_a_proof_run_when_they_run_in_a_simulator() {
    for qualifier in ["N", "P", "P1", "P0", "S", "R"] {
        let q = format!(r#"qualifier="{qualifier}""#);
        compare(&project(&chart(&[(&q, "P")], "")));
        compare(&project(&chart(&[(&q, "Act")], "")));
        compare(&project(&chart(&[(&q, "Act"), (r#"qualifier="N""#, "More")], "")));
        compare(&project(&chart(&[(&q, "More"), (r#"qualifier="S""#, "Act")], "")));
        compare(&project(&chart(&[(&q, "P"), (r#"qualifier="P0""#, "P")], "")));
    }
}

#[test]
fn what_a_proof_cannot_encode_is_refused() {
    let says = |project: &Project| match ProgramStep::new(project) {
        Ok(_) => "it is encoded".to_owned(),
        Err(why) => why,
    };
    for (written, reason) in [
        ("Off(IN := A, PT := T#1s);", "a timer TOF or TP"),
        ("Pulse(IN := A, PT := T#1s);", "a timer TOF or TP"),
        ("On(IN := A);", "a timer without a constant, positive time"),
        ("On(IN := A, PT := T);", "a timer without a constant, positive time"),
        ("On(IN := A, PT := T#0s);", "a timer without a constant, positive time"),
        ("On(IN := A, PT := T#-1s);", "a timer without a constant, positive time"),
        ("On(IN := A, PT := T#1s); On(IN := B, PT := T#2s);", "a timer with several times"),
        ("On(PT := T#1s);", "a call that leaves an input out"),
        ("Up();", "a call that leaves an input out"),
        ("Keep(S1 := A);", "a call that leaves an input out"),
        ("Keep(R := A);", "a call that leaves an input out"),
        ("Lose(R1 := A);", "a call that leaves an input out"),
        ("T := T#1s;", "a time"),
        ("P := T > T#1s;", "a time"),
        ("P := T#1s < T;", "a time"),
        ("P := A OR T + T#1s > T#1s;", "a time"),
        ("P := On.ET > T#1s;", "a time"),
        ("Up(CLK := T > T#1s);", "a time"),
        ("Keep(S1 := A, R := -T > T#1s);", "a time"),
    ] {
        let found = says(&text(written));
        assert!(found.contains(reason) && found.contains('P'), "{written}: {found}");
    }
    for qualifier in ["L", "D", "SL", "SD", "DS"] {
        let timed = project(&chart(&[(&format!(r#"qualifier="{qualifier}" duration="T#1s""#), "P")], ""));
        assert!(says(&timed).contains("an action with a duration"), "{}", says(&timed));
    }
    let twice = text("On(IN := A, PT := T#1s); P := On.Q; On(IN := B, PT := T#1s);");
    assert_eq!(says(&twice), "it is encoded");
    let condition = chart(&[], "").replace("<p>B</p>", "<p>T &gt; T#1s</p>");
    assert!(says(&project(&condition)).contains("a time"));
    // No reader gives that: a number where a BOOL is written or read.
    for written in ["P := A;", "Keep(S1 := P, R := A);"] {
        let mut damaged = text(written);
        let id = damaged.variables.iter().find(|(_, v)| v.name == "P").expect("declared").0;
        damaged.variables[id].kind = Kind::Time;
        assert!(says(&damaged).contains("a number as BOOL"), "{written}: {}", says(&damaged));
    }
    let act = chart(&[], "").replace("I := I + 1;", "T := T#1s;");
    assert!(says(&project(&act)).contains("a time"));
}

#[test]
fn what_a_program_remembers_has_a_name() {
    let project = project(&chart(&[(r#"qualifier="S""#, "Act"), (r#"qualifier="N""#, "More")], ""));
    let step = ProgramStep::new(&project).unwrap_or_else(|e| panic!("{e}"));
    let names: Vec<String> = step.latches().iter().map(|l| step.name(*l)).collect();
    for name in ["P.A", "P.I.0", "P.I.15", "P.S.7", "P.L.63", "P.One.X", "P.Three.X", "P.action 0", "P.Up.M", "P.Up.Q"]
    {
        assert_eq!(names.iter().filter(|n| *n == name).count(), 1, "{name} in {names:?}");
    }
    for name in ["P.On.M", "P.On.Q", "P.On.STATE", "P.On.START"] {
        assert_eq!(names.iter().filter(|n| *n == name).count(), 1, "{name} in {names:?}");
    }
    assert!(!names.iter().any(|n| n.contains("Up.STATE") || n.starts_with("P.T.")), "{names:?}");
    // Who writes what: steps and actions always, variables that an action or association names.
    let written: Vec<&String> = names.iter().zip(step.written()).filter(|(_, w)| *w).map(|(n, _)| n).collect();
    for (name, expected) in [
        ("P.A", false),
        ("P.P", true),
        ("P.Q", true),
        ("P.R", true),
        ("P.I.0", true),
        ("P.I.15", true),
        ("P.J.15", true),
        ("P.D.0", false),
        ("P.Up.M", false),
        ("P.One.X", true),
        ("P.action 1", true),
    ] {
        assert_eq!(written.iter().any(|n| *n == name), expected, "{name} in {written:?}");
    }
    let calls = text("On(IN := A, PT := T#1s); Up(CLK := A);");
    let step = ProgramStep::new(&calls).unwrap_or_else(|e| panic!("{e}"));
    let written: Vec<String> =
        step.latches().iter().zip(step.written()).filter(|(_, w)| *w).map(|(l, _)| step.name(*l)).collect();
    assert_eq!(written, ["P.Up.M", "P.Up.Q", "P.On.M", "P.On.Q", "P.On.STATE", "P.On.START"]);
}
