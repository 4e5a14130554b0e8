//! Drawn bodies: the order in which their elements run, lines from pins, and conditions that stand elsewhere.

use crate::support::st::{self, escaped, read_as};

const VARIABLES: [(&str, &str); 10] = [
    ("A", "BOOL"),
    ("B", "BOOL"),
    ("C", "BOOL"),
    ("I", "INT"),
    ("J", "INT"),
    ("D", "TIME"),
    ("On", "TON"),
    ("Up", "R_TRIG"),
    ("Down", "F_TRIG"),
    ("Keep", "SR"),
];

fn beremiz(language: &str, body: &str) -> String {
    st::file(&VARIABLES, &format!("<{language}>{body}</{language}>"))
}

fn codesys(language: &str, body: &str) -> String {
    beremiz(language, body).replace("tc6_0201", "tc6_0200")
}

fn from(number: u32) -> String {
    let end = r#"<position x="0" y="0"/>"#;
    format!(r#"<connectionPointIn><connection refLocalId="{number}">{end}</connection></connectionPointIn>"#)
}

fn contact(number: u32, before: u32, name: &str) -> String {
    format!(r#"<contact localId="{number}">{}<variable>{name}</variable></contact>"#, from(before))
}

fn coil(number: u32, before: u32, name: &str) -> String {
    format!(r#"<coil localId="{number}">{}<variable>{name}</variable></coil>"#, from(before))
}

/// A block with one line into each of these pins.
fn block(number: u32, attributes: &str, inputs: &[(&str, u32)], outputs: &str) -> String {
    let pin =
        |(pin, before): &(&str, u32)| format!(r#"<variable formalParameter="{pin}">{}</variable>"#, from(*before));
    let inputs: String = inputs.iter().map(pin).collect();
    format!(
        r#"<block localId="{number}" {attributes}><inputVariables>{inputs}</inputVariables><inOutVariables/><outputVariables>{outputs}</outputVariables></block>"#
    )
}

const RAIL: &str = r#"<leftPowerRail localId="1"/>"#;
const Q: &str = r#"<variable formalParameter="Q"/>"#;
const UP: &str = r#"typeName="R_TRIG" instanceName="Up""#;
const DOWN: &str = r#"typeName="F_TRIG" instanceName="Down""#;

#[test]
fn blocks_run_when_the_tool_of_the_file_runs_them() {
    let body = |up: &str, down: &str| {
        [
            RAIL,
            &contact(2, 1, "A"),
            &block(3, up, &[("CLK", 2)], Q),
            &block(4, down, &[("CLK", 2)], Q),
            &coil(5, 1, "B"),
            &coil(6, 4, "C"),
        ]
        .concat()
    };
    let ordered = |text: &str, place: u32| format!(r#"{text} executionOrderId="{place}""#);
    // Before its user, or after everything; one that stands in an order before all else, in that order.
    let plain = read_as(&beremiz("LD", &body(UP, DOWN)));
    assert_eq!(plain, "B := true; FTrig Down in A; C := Down.Q; RTrig Up in A");
    let zero = read_as(&beremiz("LD", &body(&ordered(UP, 0), &ordered(DOWN, 0))));
    assert_eq!(zero, plain);
    let both = read_as(&beremiz("LD", &body(&ordered(UP, 2), &ordered(DOWN, 1))));
    assert_eq!(both, "FTrig Down in A; RTrig Up in A; B := true; C := Down.Q");
    let both = read_as(&beremiz("LD", &body(&ordered(UP, 1), &ordered(DOWN, 2))));
    assert_eq!(both, "RTrig Up in A; FTrig Down in A; B := true; C := Down.Q");
    let one = read_as(&beremiz("LD", &body(&ordered(UP, 1), DOWN)));
    assert_eq!(one, "RTrig Up in A; B := true; FTrig Down in A; C := Down.Q");
    // Where it stands.
    let there = read_as(&codesys("LD", &body(UP, DOWN)));
    assert_eq!(there, "RTrig Up in A; FTrig Down in A; B := true; C := Down.Q");
}

#[test]
fn rungs_that_a_tool_would_sort_are_refused() {
    let at = |text: String, x: &str, y: &str| {
        text.replacen("<connectionPointIn>", &format!(r#"<position x="{x}" y="{y}"/><connectionPointIn>"#), 1)
    };
    let body = |x: &str, y: &str| {
        let second = at(coil(3, 1, "B"), x, y);
        [RAIL.to_owned(), at(coil(2, 1, "A"), "100", "50"), second].concat()
    };
    for (x, y, follows) in [
        ("100", "50", true),
        ("101", "50", true),
        ("99", "50", false),
        ("100", "59.5", true),
        ("99", "59.5", false),
        ("99", "60", true),
        ("101", "40.5", true),
        ("101", "40", false),
        ("100", "20", false),
    ] {
        let found = read_as(&beremiz("LD", &body(x, y)));
        let refused = found.contains("coil `B` (number 3), which stands above one that comes before it");
        assert_eq!(refused, !follows, "{x} {y}: {found}");
        assert!(refused || found == "A := true; B := true", "{found}");
        assert_eq!(read_as(&codesys("LD", &body(x, y))), "A := true; B := true");
    }
}

#[test]
fn a_line_ends_at_a_pin_of_its_block() {
    let pins = r#"<variable formalParameter="Q"><connectionPointOut><relPosition x="80" y="20"/></connectionPointOut></variable><variable formalParameter="ET"><connectionPointOut><relPosition x="80" y="40"/></connectionPointOut></variable>"#;
    let body = |end: &str, line: &str| {
        let timer = block(3, r#"typeName="TON" instanceName="On""#, &[("IN", 2)], pins);
        let timer = timer.replacen("<inputVariables>", r#"<position x="200" y="100"/><inputVariables>"#, 1);
        let line = format!(r#"<connectionPointIn><connection refLocalId="3"{line}</connection></connectionPointIn>"#);
        let end = if end == "D" {
            format!(r#"<outVariable localId="4">{line}<expression>D</expression></outVariable>"#)
        } else {
            format!(r#"<coil localId="4">{line}<variable>{end}</variable></coil>"#)
        };
        [RAIL, &contact(2, 1, "A"), &timer, &end].concat()
    };
    let read = |end: &str, line: &str| read_as(&beremiz("LD", &body(end, line)));
    let points = |x: u32, y: u32| format!(r#"><position x="400" y="120"/><position x="{x}" y="{y}"/>"#);
    assert_eq!(read("B", &points(280, 120)), "Ton On in A; B := On.Q");
    assert_eq!(read("D", &points(280, 140)), "Ton On in A; D := On.ET");
    let named = |name: &str| format!(r#" formalParameter="{name}"><position x="0" y="0"/>"#);
    assert_eq!(read("B", &named("Q")), "Ton On in A; B := On.Q");
    assert_eq!(read("D", &named("ET")), "Ton On in A; D := On.ET");
    // Beremiz finds nothing by another spelling, and fails without a position.
    assert!(read("B", &named("q")).contains("in capital letters"), "{}", read("B", &named("q")));
    assert!(read("B", r#" formalParameter="Q">"#).contains("without a position"));
    for nowhere in [points(280, 130), points(281, 120), points(120, 280), named("X"), points(0, 0)] {
        let found = read("B", &nowhere);
        assert!(found.contains("does not say from which output of block `On`"), "{nowhere}: {found}");
    }
    assert!(read("B", &points(280, 140)).contains("not of type BOOL"), "{}", read("B", &points(280, 140)));
    assert!(read("D", &points(280, 120)).contains("cannot take BOOL"), "{}", read("D", &points(280, 120)));
}

#[test]
fn codesys_assigns_at_the_output_pins_of_a_block() {
    let pin = |name: &str, more: &str, to: &str| {
        format!(
            r#"<variable formalParameter="{name}" {more}><connectionPointOut><expression>{to}</expression></connectionPointOut></variable>"#
        )
    };
    let body = |outputs: &str| {
        [RAIL, &contact(2, 1, "A"), &block(3, r#"typeName="TON" instanceName="On""#, &[("IN", 2)], outputs)].concat()
    };
    let read = |outputs: &str| read_as(&codesys("LD", &body(outputs)));
    assert_eq!(read(&(pin("Q", "", "B") + &pin("ET", "", " D "))), "Ton On in A; B := On.Q; D := On.ET");
    assert_eq!(read(&(pin("Q", "", "???") + &pin("ET", "", ""))), "Ton On in A");
    for (outputs, reason) in [
        (pin("Q", r#"negated="true""#, "B"), "pin `Q`, an assigned output, with negation or edge"),
        (pin("Q", r#"edge="rising""#, "B"), "pin `Q`, an assigned output, with negation or edge"),
        (pin("Q", "", "D"), "`D` is TIME and cannot take BOOL"),
        (pin("Q", "", "Z"), "`Z` is not declared"),
        (pin("Q1", "", "B"), "pin `Q1` of block `On`"),
        (pin("ENO", "", "B"), "the output pin `ENO`"),
    ] {
        let found = read(&outputs);
        assert!(found.starts_with("E6") && found.contains(reason), "{outputs}: {found}");
    }
    let sum = |outputs: &str| {
        let numbers = r#"<inVariable localId="8"><expression>J</expression></inVariable>"#;
        let sum = block(3, r#"typeName="ADD""#, &[("In1", 8), ("In2", 9)], outputs);
        read_as(&codesys("LD", &[RAIL, numbers, &numbers.replace('8', "9"), &sum].concat()))
    };
    assert_eq!(sum(&pin("Out", "", "I")), "I := (J + J)");
    assert_eq!(sum(&(pin("Out", "", "I") + &pin("ENO", "", ""))), "I := (J + J)");
    assert_eq!(sum(&pin("Out", "", "???")), "");
    for (outputs, reason) in [
        (pin("Out", r#"negated="true""#, "I"), "pin `Out`, an assigned output, with negation or edge"),
        (pin("Out", r#"edge="rising""#, "I"), "pin `Out`, an assigned output, with negation or edge"),
        (pin("Out", "", "I") + &pin("More", "", ""), "an assigned output of block `ADD`"),
        (pin("Out", "", "D"), "of another type than `D`"),
    ] {
        let found = sum(&outputs);
        assert!(found.starts_with("E602") && found.contains(reason), "{outputs}: {found}");
    }
}

/// A chart with one transition, whose condition stands elsewhere under the name `Go`.
fn named(list: &str) -> String {
    let chart = format!(
        r#"<step localId="1" name="S" initialStep="true"/><transition localId="2">{}<condition><reference name="Go"/></condition></transition><jumpStep localId="3" targetName="S">{}</jumpStep>"#,
        from(1),
        from(2)
    );
    read_as(&beremiz("SFC", &chart).replace("<body><SFC>", &format!("{list}<body><SFC>")))
}

#[test]
fn conditions_are_found_by_their_names() {
    let body = |language: &str, body: &str| {
        let body = format!("<{language}>{body}</{language}>");
        named(&format!(r#"<transitions><transition name="go"><body>{body}</body></transition></transitions>"#))
    };
    let text = |text: &str| body("ST", &format!("<p>{}</p>", escaped(text)));
    for (written, condition) in [
        (":= A AND B;", "(A and B)"),
        ("Go := A;", "A"),
        (":= A", "A"),
        ("A;", "A"),
        ("NOT A", "not A"),
        (":= S.X AND S.T > T#1s;", "(S.X and (S.T > 1000000))"),
        ("1", "true"),
    ] {
        assert_eq!(text(written), format!("step S initial; S > S when {condition}"), "{written}");
    }
    for (wrong, reason) in [
        (":= A B;", "`B` stands where the end is expected"),
        ("A; B;", "`B` stands where the end is expected"),
        (":= ;", "`;` stands where a value is expected"),
        (":= I;", "a condition is not of type BOOL"),
        (":= S.Y;", "`S.Y` is not declared"),
    ] {
        assert!(text(wrong).contains(reason), "{wrong}: {}", text(wrong));
    }
    let ladder = |ends: &str| body("LD", &[RAIL, &contact(2, 1, "A"), &contact(3, 2, "B"), ends].concat());
    let out = format!(r#"<outVariable localId="4">{}<expression>GO</expression></outVariable>"#, from(3));
    assert_eq!(ladder(&coil(4, 3, "Go")), "step S initial; S > S when (A and B)");
    assert_eq!(ladder(&out), "step S initial; S > S when (A and B)");
    let with = |attribute: &str| coil(4, 3, "Go").replace("<coil ", &format!("<coil {attribute} "));
    for wrong in [
        coil(4, 3, "C"),
        with(r#"negated="true""#),
        with(r#"edge="rising""#),
        with(r#"storage="set""#),
        coil(4, 3, "Go") + &coil(5, 2, "Go"),
        coil(4, 3, "Go") + &coil(5, 2, "C"),
    ] {
        assert!(ladder(&wrong).contains("in the body of transition `Go`"), "{wrong}: {}", ladder(&wrong));
    }
    assert!(ladder("").contains("gives it no condition"), "{}", ladder(""));
    assert!(body("IL", "").contains("the language of transition `Go`"), "{}", body("IL", ""));
    let go = r#"<transition name="Go"><body><ST><p>A</p></ST></body></transition>"#;
    let twice = named(&format!("<transitions>{go}{go}</transitions>"));
    assert!(twice.contains("two transitions have the name `Go`"), "{twice}");
    assert!(named("").contains("`Go` is not declared"), "{}", named(""));
}

/// A file whose program names global variables.
fn external(globals: &str, externals: &str, text: &str) -> String {
    let program = st::file(&[], &format!("<ST><p>{text}</p></ST>"));
    let program = program.replace("<localVars></localVars>", &format!("<externalVars>{externals}</externalVars>"));
    let task = r#"<task name="T" interval="T#10ms" priority="0"><pouInstance name="Q" typeName="P"/></task>"#;
    let end = format!(
        r#"<instances><configurations><configuration name="C"><resource name="Res">{task}<globalVars>{globals}</globalVars></resource></configuration></configurations></instances></project>"#
    );
    read_as(&program.replace("</project>", &end))
}

#[test]
fn external_variables_are_of_the_type_of_the_global_ones() {
    let variable = |kind: &str| format!(r#"<variable name="G"><type>{kind}</type></variable>"#);
    let derived = |name: &str| variable(&format!(r#"<derived name="{name}"/>"#));
    let int = variable("<INT/>");
    assert_eq!(external(&int, &int, "G := 3;"), "G := 3");
    assert_eq!(external(&derived("TON"), &derived("ton"), "G();"), "Ton G");
    assert_eq!(external(&derived("Own"), &derived("OWN"), ""), "");
    for (global, here) in [
        (variable("<INT/>"), variable("<UINT/>")),
        (variable("<BOOL/>"), variable("<INT/>")),
        (derived("TON"), derived("TOF")),
        (derived("TON"), variable("<BOOL/>")),
        (derived("Own"), derived("Other")),
        (derived("Own"), variable("<BOOL/>")),
    ] {
        let found = external(&global, &here, "");
        assert!(found.contains("the external variable `G` has another type than the global one"), "{here}: {found}");
    }
}

#[test]
fn a_variable_begins_as_its_declaration_says() {
    let begins = |kind: &str, value: &str| {
        let variable = format!(
            r#"<variable name="G"><type><{kind}/></type><initialValue><simpleValue value="{value}"/></initialValue></variable>"#
        );
        let file = st::file(&[], "<ST><p></p></ST>");
        let file = file.replace("<localVars></localVars>", &format!("<localVars>{variable}</localVars>"));
        chartwright::read::read(&file).0.map(|project| project.variables.values().next().expect("one").initial)
    };
    for (kind, value, expected) in [
        ("BOOL", "TRUE", Some(1)),
        ("BOOL", "false", Some(0)),
        ("BOOL", "1", Some(1)),
        ("BOOL", "0", Some(0)),
        ("BOOL", "2", None),
        ("BOOL", "T#1s", None),
        ("INT", "-7", Some(-7)),
        ("INT", "- 7", Some(-7)),
        ("INT", "INT#-7", Some(-7)),
        ("INT", "16#10", Some(16)),
        ("INT", "-32768", Some(-32768)),
        ("INT", "-32769", None),
        ("INT", "32768", None),
        ("INT", "+7", None),
        ("INT", "TRUE", None),
        ("UINT", "-1", None),
        ("UINT", "65535", Some(65535)),
        ("UINT", "65536", None),
        ("SINT", "127", Some(127)),
        ("SINT", "128", None),
        ("USINT", "255", Some(255)),
        ("USINT", "256", None),
        ("DINT", "-2147483648", Some(-2_147_483_648)),
        ("DINT", "2147483648", None),
        ("UDINT", "4294967295", Some(4_294_967_295)),
        ("UDINT", "4294967296", None),
        ("LINT", "9223372036854775807", Some(i64::MAX)),
        ("ULINT", "-1", None),
        ("TIME", "T#1s", Some(1_000_000)),
        ("TIME", "2s", Some(2_000_000)),
        ("TIME", "5", None),
    ] {
        assert_eq!(begins(kind, value), expected, "{kind} {value}");
    }
}
