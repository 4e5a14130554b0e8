//! Functions drawn as boxes and sums in texts: each reading, and each refusal of what tools compute differently.

use crate::support::st::{self, escaped, read_as};

/// The types of the variables that are there.
const VARIABLES: [(&str, &str); 16] = [
    ("A", "BOOL"),
    ("B", "BOOL"),
    ("I", "INT"),
    ("J", "INT"),
    ("S", "SINT"),
    ("D", "DINT"),
    ("E", "DINT"),
    ("L", "LINT"),
    ("U", "USINT"),
    ("V", "UINT"),
    ("W", "UDINT"),
    ("K", "ULINT"),
    ("N", "ULINT"),
    ("T", "TIME"),
    ("X", "TIME"),
    ("Y", "TON"),
];

/// A pin with what comes to it: the text of an inVariable, the rail, or nothing.
type Pin<'a> = (&'a str, &'a str);
type Pins<'a> = &'a [Pin<'a>];

fn file(body: &str) -> String {
    st::file(&VARIABLES, body)
}

/// A box whose pins have the attributes that stand behind their names, with its result in a variable.
fn drawn(function: &str, pins: Pins<'_>, to: &str) -> String {
    let (mut values, mut inputs) = (String::new(), String::new());
    for (number, (pin, value)) in (10..).zip(pins) {
        let (name, attributes) = pin.split_once(' ').unwrap_or((pin, ""));
        let from = match *value {
            "" => String::new(),
            "rail" => r#"<connectionPointIn><connection refLocalId="1"/></connectionPointIn>"#.to_owned(),
            value => {
                values += &format!(r#"<inVariable localId="{number}"><expression>{value}</expression></inVariable>"#);
                format!(r#"<connectionPointIn><connection refLocalId="{number}"/></connectionPointIn>"#)
            }
        };
        inputs += &format!(r#"<variable formalParameter="{name}" {attributes}>{from}</variable>"#);
    }
    let function = format!(
        r#"<block localId="2" typeName="{function}"><inputVariables>{inputs}</inputVariables><inOutVariables/><outputVariables><variable formalParameter="OUT"/></outputVariables></block>"#
    );
    let result = match to {
        "A" | "B" => format!(
            r#"<coil localId="3"><connectionPointIn><connection refLocalId="2" formalParameter="OUT"><position x="0" y="0"/></connection></connectionPointIn><variable>{to}</variable></coil>"#
        ),
        _ => format!(
            r#"<outVariable localId="3"><connectionPointIn><connection refLocalId="2" formalParameter="OUT"><position x="0" y="0"/></connection></connectionPointIn><expression>{to}</expression></outVariable>"#
        ),
    };
    format!(r#"<LD><leftPowerRail localId="1"/>{values}{function}{result}</LD>"#)
}

fn boxed(function: &str, pins: Pins<'_>, to: &str) -> String {
    read_as(&file(&drawn(function, pins, to)))
}

/// The same in a file of CODESYS, where a box that is used stands behind its user.
fn boxed_in_codesys(function: &str, pins: Pins<'_>, to: &str) -> String {
    let text = drawn(function, pins, to);
    let (start, end) = (text.find("<block").expect("a box"), text.find("</block>").expect("its end") + 8);
    let behind = format!("{}{}", &text[..start], &text[end..]).replace("</LD>", &format!("{}</LD>", &text[start..end]));
    read_as(&file(&behind).replace("tc6_0201", "tc6_0200"))
}

#[test]
fn names_in_small_letters_and_places_are_for_codesys() {
    let cases: &[(&str, Pins<'_>, &str, &str)] = &[
        ("move", &[("in", "7")], "I", "I := 7"),
        ("Add", &[("in1", "I"), ("IN2", "J")], "I", "I := (I + J)"),
        ("ADD", &[("In1", "1"), ("In2", "2")], "I", "I := (1 + 2)"),
        ("ADD", &[("EN", ""), ("In2", "I"), ("In3", "1")], "I", "I := (I + 1)"),
        ("MOVE", &[("EN", ""), ("In2", "I")], "J", "J := I"),
        ("LIMIT", &[("In1", "-2"), ("In2", "I"), ("In3", "9")], "J", "J := limit(-2, I, 9)"),
    ];
    for (function, pins, to, expected) in cases {
        assert_eq!(boxed_in_codesys(function, pins, to), *expected, "{function} {pins:?}");
        // There Beremiz would look for other pins, and find none.
        let found = boxed(function, pins, to);
        assert!(found.starts_with("E602"), "{function} {pins:?}: {found}");
    }
}

#[test]
fn a_function_computes_from_the_inputs_that_it_names() {
    let cases: &[(&str, Pins<'_>, &str, &str)] = &[
        ("MOVE", &[("IN", "J")], "I", "I := J"),
        ("ADD", &[("IN1", "I"), ("IN2", "J")], "I", "I := (I + J)"),
        ("SUB", &[("IN1", "I"), ("IN2", "J")], "I", "I := (I - J)"),
        ("ADD", &[("EN", "rail"), ("IN1", "I"), ("IN2", "1")], "I", "I := (I + 1)"),
        ("LIMIT", &[("MN", "0"), ("IN", "I"), ("MX", "9")], "J", "J := limit(0, I, 9)"),
        ("LIMIT", &[("MN", "4"), ("IN", "I"), ("MX", "4")], "J", "J := limit(4, I, 4)"),
        ("SEL", &[("G", "B"), ("IN0", "I"), ("IN1", "J")], "I", "I := (J if B else I)"),
        ("SEL", &[("G", "A"), ("IN0", "3"), ("IN1", "J")], "I", "I := (J if A else 3)"),
        ("EQ", &[("IN1", "I"), ("IN2", "J")], "A", "A := (I = J)"),
        ("NE", &[("IN1", "I"), ("IN2", "J")], "A", "A := (I <> J)"),
        ("LT", &[("IN1", "I"), ("IN2", "J")], "A", "A := (I < J)"),
        ("LE", &[("IN1", "I"), ("IN2", "J")], "A", "A := (I <= J)"),
        ("GT", &[("IN1", "I"), ("IN2", "J")], "A", "A := (I > J)"),
        ("GE", &[("IN1", "3"), ("IN2", "J")], "A", "A := (3 >= J)"),
    ];
    for (function, pins, to, expected) in cases {
        assert_eq!(boxed(function, pins, to), *expected, "{function} {pins:?}");
    }
}

#[test]
fn a_function_with_other_inputs_than_its_own_is_refused() {
    let cases: &[(&str, Pins<'_>, &str)] = &[
        ("ADD", &[("IN1", "I"), ("IN2", "J"), ("IN3", "J")], "IN1, IN2, IN3"),
        ("ADD", &[("IN1", "I")], "IN1"),
        ("ADD", &[], ""),
        ("ADD", &[("IN2", "I"), ("IN1", "J")], "IN2, IN1"),
        ("SUB", &[("IN2", "I"), ("IN1", "J")], "IN2, IN1"),
        ("SUB", &[("IN1", "I"), ("IN1", "J")], "IN1, IN1"),
        ("SUB", &[("IN1", "I"), ("X", "J")], "IN1, X"),
        ("SUB", &[("X", "I"), ("IN2", "J")], "X, IN2"),
        // After EN the places count from 2 on, without it from 1 on, and they count for all or for none.
        ("SUB", &[("IN2", "I"), ("IN3", "J")], "IN2, IN3"),
        ("SUB", &[("EN", ""), ("IN1", "I"), ("IN3", "J")], "IN1, IN3"),
        ("SUB", &[("EN", ""), ("IN2", "I"), ("IN2", "J")], "IN2, IN2"),
        ("SUB", &[("EN", ""), ("IN2", "I"), ("IN1", "J")], "IN2, IN1"),
        ("LIMIT", &[("MX", "9"), ("IN", "I"), ("MN", "0")], "MX, IN, MN"),
        ("LIMIT", &[("MN", "0"), ("IN", "I")], "MN, IN"),
        ("SEL", &[("G", "A"), ("IN1", "I"), ("IN0", "J")], "G, IN1, IN0"),
        ("SEL", &[("G", "A"), ("IN0", "I")], "G, IN0"),
        ("MOVE", &[("IN", "I"), ("IN2", "J")], "IN, IN2"),
        ("MOVE", &[("X", "I")], "X"),
        ("GE", &[("IN2", "I"), ("IN1", "J")], "IN2, IN1"),
        ("EQ", &[("IN1", "I"), ("IN2", "J"), ("IN3", "J")], "IN1, IN2, IN3"),
    ];
    for (function, pins, list) in cases {
        let to = if matches!(*function, "GE" | "EQ") { "A" } else { "I" };
        let reason = format!("E602 the inputs {list} of block `{function}` (number 2)");
        for found in [boxed(function, pins, to), boxed_in_codesys(function, pins, to)] {
            assert!(found.starts_with(&reason), "{pins:?}: {found}");
        }
    }
}

#[test]
fn what_tools_make_of_a_function_in_different_ways_is_refused() {
    let two = |first, second| vec![("IN1", first), ("IN2", second)];
    let limit = |lowest, value, highest| vec![("MN", lowest), ("IN", value), ("MX", highest)];
    let cases: &[(&str, Vec<Pin<'_>>, &str, &str)] = &[
        ("ADD", two("I", "D"), "I", "operands of different types"),
        ("ADD", two("D", "I"), "D", "operands of different types"),
        ("EQ", two("I", "D"), "A", "operands of different types"),
        ("ADD", two("I", "40000"), "I", "a constant of another type"),
        ("GE", two("I", "40000"), "A", "a constant of another type"),
        ("MOVE", vec![("IN", "40000")], "I", "which is of another type than `I`"),
        ("ADD", two("I", "J"), "D", "which is of another type than `D`"),
        ("MOVE", vec![("IN", "T")], "X", "an expression at block"),
        ("LT", two("T", "X"), "A", "an expression at block"),
        ("ADD", two("I", "-J"), "I", "an expression at block"),
        ("EQ", two("1", "2"), "A", "which compares constants"),
        ("ADD", two("I", "A"), "I", "the type of an operand"),
        ("EQ", two("A", "B"), "A", "the type of an operand"),
        ("SEL", vec![("G", "I"), ("IN0", "I"), ("IN1", "J")], "I", "the type of an operand"),
        ("SEL", vec![("G", "A"), ("IN0", "B"), ("IN1", "J")], "I", "the type of an operand"),
        ("SEL", vec![("G", "1"), ("IN0", "I"), ("IN1", "J")], "I", "the type of an operand"),
        ("LIMIT", limit("I", "J", "9"), "I", "bounds that are no constants"),
        ("LIMIT", limit("0", "J", "I"), "I", "bounds that are no constants"),
        ("LIMIT", limit("5", "J", "4"), "I", "bounds in the wrong order"),
        ("LIMIT", limit("0", "J", "40000"), "I", "a constant of another type"),
        ("MUX", two("I", "J"), "I", "the function block `MUX`"),
        ("ADD", vec![("IN1 negated=\"true\"", "I"), ("IN2", "J")], "I", "pin `IN1`, an operand, with negation"),
        ("ADD", vec![("IN1 edge=\"rising\"", "I"), ("IN2", "J")], "I", "pin `IN1`, an operand, with negation"),
        ("ADD", vec![("IN1", "I"), ("IN2 storage=\"set\"", "J")], "I", "`storage` = `set`"),
        ("ADD", vec![("EN", "A"), ("IN1", "I"), ("IN2", "J")], "I", "a condition at EN"),
        ("ADD", two("I", ""), "I", "a pin of block `ADD` (number 2) is connected to nothing"),
        ("ADD", two("rail", "J"), "I", "what feeds block `ADD`"),
        ("EQ", two("I", "J"), "J", "`J` is an integer and cannot take BOOL"),
        ("ADD", two("I", "J"), "Z", "`Z` is not declared"),
    ];
    for (function, pins, to, reason) in cases {
        let found = boxed(function, pins, to);
        assert!(found.starts_with('E') && found.contains(reason), "{function} {pins:?}: {found}");
    }
}

#[test]
fn a_function_has_one_result_and_one_user() {
    let good = drawn("ADD", &[("IN1", "I"), ("IN2", "J")], "I");
    let again = |text: &str, from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        read_as(&file(&text.replacen(from, to, 1)))
    };
    assert_eq!(read_as(&file(&good)), "I := (I + J)");
    let end = r#"<outVariable localId="4"><connectionPointIn><connection refLocalId="2" formalParameter="OUT"><position x="0" y="0"/></connection></connectionPointIn><expression>J</expression></outVariable></LD>"#;
    let pin = r#"<variable formalParameter="OUT"/>"#;
    for (from, to, reason) in [
        ("</LD>", end, "which has several users"),
        (pin, r#"<variable formalParameter="OUT"/><variable formalParameter="ENO"/>"#, "I := (I + J)"),
        (pin, r#"<variable formalParameter="OUT"/><variable formalParameter="MORE"/>"#, "a line from another output"),
        ("<inOutVariables/>", r#"<inOutVariables><variable formalParameter="V"/></inOutVariables>"#, "the in-out"),
        (r#"refLocalId="2" formalParameter="OUT""#, r#"refLocalId="2" formalParameter="ENO""#, "from which output"),
    ] {
        let found = again(&good, from, to);
        assert!(found.contains(reason), "{to}: {found}");
    }
}

#[test]
fn sums_are_taken_where_their_width_does_not_matter() {
    let text = |text: &str| read_as(&file(&format!("<ST><p>{}</p></ST>", escaped(text))));
    for (good, expected) in [
        ("A := I + 1 > 3;", "A := ((I + 1) > 3)"),
        ("A := S - 1 > 3;", "A := ((S - 1) > 3)"),
        ("A := I + J = 3;", "A := ((I + J) = 3)"),
        ("A := D > 3;", "A := (D > 3)"),
        ("A := D = E;", "A := (D = E)"),
        ("A := V <= 65535;", "A := (V <= 65535)"),
        ("A := L > -1;", "A := (L > -1)"),
        ("A := K = N;", "A := (K = N)"),
        ("A := K <> 5;", "A := (K <> 5)"),
        // Whatever is cut when it is assigned may be as wide as a tool makes it.
        ("D := D + E;", "D := (D + E)"),
        ("V := V - 1;", "V := (V - 1)"),
        ("K := K + 1;", "K := (K + 1)"),
        ("T := T + X;", "T := (T + X)"),
        ("A := T + X > T#1s;", "A := ((T + X) > 1000000)"),
        ("A := Y.ET - T > X;", "A := ((Y.ET - T) > X)"),
        ("A := -I > 3;", "A := (-I > 3)"),
        ("Y(IN := I + 1 > 3, PT := T#1s);", "Ton Y in ((I + 1) > 3) preset 1000000"),
    ] {
        assert_eq!(text(good), expected);
    }
    let wide = "a comparison of a sum that is wider than INT or has no sign";
    let mixed = "integers of different types in one expression";
    for (wrong, reason) in [
        ("A := D + 1 > 3;", wide),
        ("A := D + 1 = 3;", wide),
        ("A := 3 <> D - E;", wide),
        ("A := L - 1 > 3;", wide),
        ("A := V - 1 > 3;", wide),
        ("A := U + 1 = 3;", wide),
        ("A := W - 1 > 3;", wide),
        ("A := -D > 3;", wide),
        ("A := K + 1 = 3;", wide),
        ("A := B AND NOT (A OR D + 1 > 3);", wide),
        ("Y(IN := D + 1 > 3, PT := T#1s);", wide),
        ("A := K > N;", "an order of integers of type ULINT"),
        ("A := K <= 5;", "an order of integers of type ULINT"),
        ("A := I > D;", mixed),
        ("A := D = I;", mixed),
        ("A := I + D = 3;", mixed),
        ("A := I - S > 3;", mixed),
        ("I := D;", mixed),
        ("I := J + D;", mixed),
        ("I := -D;", mixed),
        ("I := 40000;", "the constant 40000, which is not of the type"),
        ("I := J + 40000;", "the constant 40000, which is not of the type"),
        ("A := I > 40000;", "the constant 40000, which is not of the type"),
        ("A := 0 > I + 40000;", "the constant 40000, which is not of the type"),
        ("A := U > -1;", "the constant -1, which is not of the type"),
    ] {
        let found = text(wrong);
        assert!(found.starts_with("E602") && found.contains(reason), "{wrong}: {found}");
    }
}

#[test]
fn bounds_look_at_a_number_before_it_is_cut() {
    let limit = |value: &str, to: &str| boxed("LIMIT", &[("MN", "0"), ("IN", value), ("MX", "9")], to);
    assert_eq!(limit("D", "D"), "D := limit(0, D, 9)");
    assert_eq!(limit("V", "V"), "V := limit(0, V, 9)");
    assert!(limit("K", "K").contains("an order of integers of type ULINT"), "{}", limit("K", "K"));
}
