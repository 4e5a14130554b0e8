//! What stands at one place of a file, and what the reader makes of it: pins, outputs, values of attributes, texts,
//! data of vendors.

use crate::support::st::{self, read_as};

const VARIABLES: [(&str, &str); 7] =
    [("A", "BOOL"), ("B", "BOOL"), ("I", "INT"), ("J", "INT"), ("On", "TON"), ("Off", "TOF"), ("Q", "BOOL")];

fn beremiz(body: &str) -> String {
    st::file(&VARIABLES, body)
}

fn codesys(body: &str) -> String {
    beremiz(body).replace("tc6_0201", "tc6_0200")
}

fn ladder(parts: &[&str]) -> String {
    format!(r#"<LD><leftPowerRail localId="1"/>{}</LD>"#, parts.concat())
}

fn timer(number: u32, name: &str, kind: &str, inputs: &str, outputs: &str) -> String {
    let input = r#"<variable formalParameter="IN"><connectionPointIn><connection refLocalId="1"/></connectionPointIn></variable>"#;
    format!(
        r#"<block localId="{number}" typeName="{kind}" instanceName="{name}"><inputVariables>{input}{inputs}</inputVariables><inOutVariables/><outputVariables>{outputs}</outputVariables></block>"#
    )
}

fn pin(name: &str, attributes: &str) -> String {
    format!(r#"<variable formalParameter="{name}" {attributes}/>"#)
}

/// A coil behind an output of a box.
fn behind(number: u32, output: &str) -> String {
    let output = if output.is_empty() { String::new() } else { format!(r#"formalParameter="{output}""#) };
    format!(
        r#"<coil localId="90"><connectionPointIn><connection refLocalId="{number}" {output}><position x="0" y="0"/></connection></connectionPointIn><variable>Q</variable></coil>"#
    )
}

#[track_caller]
fn says(found: &str, part: &str) {
    assert!(found.starts_with("E6") && found.contains(part), "{part}: {found}");
}

#[test]
fn an_output_is_negated_where_something_comes_from_it() {
    let not = r#"negated="true""#;
    let one = |outputs: &str, output: &str| {
        read_as(&beremiz(&ladder(&[&timer(3, "On", "TON", "", outputs), &behind(3, output)])))
    };
    assert_eq!(one(&pin("Q", not), "Q"), "Ton On in true; Q := not On.Q");
    assert_eq!(one(&pin("Q", not), ""), "Ton On in true; Q := not On.Q");
    says(&one(&(pin("Q", "") + &pin("ET", not)), "Q"), "pin `ET`, used by nothing, with negation or edge,");
    // A line from an output of that name, but of another box.
    let (first, second) = (timer(3, "On", "TON", "", &pin("Q", not)), timer(4, "Off", "TOF", "", &pin("Q", "")));
    let other = read_as(&beremiz(&ladder(&[&first, &second, &behind(4, "Q")])));
    says(&other, "pin `Q`, used by nothing, with negation or edge,");
}

#[test]
fn a_box_has_the_pins_of_its_type_and_no_others() {
    let with = |inputs: &str, outputs: &str| read_as(&beremiz(&ladder(&[&timer(3, "On", "TON", inputs, outputs)])));
    let open = |name: &str| format!(r#"<variable formalParameter="{name}"><connectionPointIn/></variable>"#);
    assert_eq!(with(&(open("PT") + &open("EN")), &(pin("Q", "") + &pin("ET", "") + &pin("ENO", ""))), "Ton On in true");
    says(&with(&open("X"), ""), "pin `X` of block `On`");
    says(&with("", &pin("X", "")), "pin `X` of block `On`");
}

#[test]
fn a_function_that_nobody_uses_is_understood_all_the_same() {
    let function = |kind: &str, attributes: &str, result: &str| {
        format!(
            r#"<inVariable localId="2"><expression>I</expression></inVariable><block localId="3" typeName="{kind}" {attributes}><inputVariables><variable formalParameter="IN"><connectionPointIn><connection refLocalId="2"/></connectionPointIn></variable></inputVariables><inOutVariables/><outputVariables>{result}</outputVariables></block>"#
        )
    };
    let out = pin("OUT", "");
    for file in [beremiz, codesys] {
        assert_eq!(read_as(&file(&ladder(&[&function("MOVE", "", &out)]))), "");
        assert_eq!(read_as(&file(&ladder(&[&function("MOVE", r#"executionOrderId="0""#, &out)]))), "");
        says(&read_as(&file(&ladder(&[&function("WRITE", "", &out)]))), "WRITE");
        let negated = out.clone() + &pin("ENO", r#"negated="true""#);
        says(&read_as(&file(&ladder(&[&function("MOVE", "", &negated)]))), "pin `ENO`, ENO, with negation or edge,");
    }
    let ordered = read_as(&beremiz(&ladder(&[&function("MOVE", r#"executionOrderId="1""#, &out)])));
    says(&ordered, "the execution order of block `MOVE`");
}

#[test]
fn the_result_of_a_comparison_is_negated_and_that_of_a_sum_is_not() {
    let result = |kind: &str, to: &str| {
        let values = [(2, "I"), (5, "J")].map(|(number, text)| {
            format!(r#"<inVariable localId="{number}"><expression>{text}</expression></inVariable>"#)
        });
        let pins = [("IN1", 2), ("IN2", 5)].map(|(name, number)| {
            format!(
                r#"<variable formalParameter="{name}"><connectionPointIn><connection refLocalId="{number}"/></connectionPointIn></variable>"#
            )
        });
        let out = pin("OUT", r#"negated="true""#);
        let function = format!(
            r#"<block localId="3" typeName="{kind}"><inputVariables>{}</inputVariables><inOutVariables/><outputVariables>{out}</outputVariables></block>"#,
            pins.concat()
        );
        read_as(&beremiz(&ladder(&[&values.concat(), &function, to])))
    };
    assert_eq!(result("GT", &behind(3, "OUT")), "Q := not (I > J)");
    let variable =
        behind(3, "OUT").replace("coil", "outVariable").replace("variable>Q</variable", "expression>I</expression");
    says(&result("ADD", &variable), "pin `OUT`, of numbers, with negation or edge,");
}

#[test]
fn a_line_to_a_transition_comes_from_the_output_for_transitions() {
    let chart = |main: &str, output: &str| {
        let line = format!(
            r#"<connectionPointIn><connection refLocalId="1" formalParameter="{output}"/></connectionPointIn>"#
        );
        let condition = r#"<condition><inline name=""><ST><p>A</p></ST></inline></condition>"#;
        let body = format!(
            r#"<SFC><step localId="1" name="One" initialStep="true"><connectionPointOut {main}/><connectionPointOutAction formalParameter="x"/></step><transition localId="2">{line}{condition}</transition><jumpStep localId="3" targetName="One"><connectionPointIn><connection refLocalId="2"/></connectionPointIn></jumpStep></SFC>"#
        );
        read_as(&codesys(&body))
    };
    for (main, output) in [("", "sfc"), (r#"formalParameter="sfc""#, "SFC"), (r#"formalParameter="x""#, "x")] {
        assert!(chart(main, output).starts_with("step One"), "{main} {output}: {}", chart(main, output));
    }
    for (main, output) in [("", "x"), (r#"formalParameter="sfc""#, "x"), (r#"formalParameter="sfc""#, "y")] {
        says(&chart(main, output), &format!("a line from output `{output}` of step `One`"));
    }
}

#[test]
fn addresses_stand_at_variables_that_are_understood_and_as_compilers_take_them() {
    let body = "<ST><p>A := B;</p></ST>";
    let at = |name: &str, address: &str| {
        beremiz(body).replacen(&format!(r#"name="{name}""#), &format!(r#"name="{name}" address="{address}""#), 1)
    };
    says(&read_as(&at("On", "%QX0.0")), "the address of `On`, a variable of such a type,");
    let word = beremiz(body).replacen("<INT/>", "<WORD/>", 1);
    assert_eq!(read_as(&word), "A := B");
    let word = word.replacen(r#"name="I""#, r#"name="I" address="%QW0""#, 1);
    says(&read_as(&word), "the address of `I`, a variable of such a type,");
    says(&read_as(&at("A", "%ix0.0")), "the address %ix0.0 in small letters");
    assert_eq!(read_as(&at("A", "%ix0.0").replace("tc6_0201", "tc6_0200")), "A := B");
}

#[test]
fn a_program_of_codesys_runs_in_a_task() {
    let instances = r#"<instances><configurations><configuration name="Config"><resource name="Res"><pouInstance name="P1" typeName="P"/></resource></configuration></configurations></instances></project>"#;
    let file = |text: String| text.replacen("</project>", instances, 1);
    assert_eq!(read_as(&file(beremiz("<ST><p>A := B;</p></ST>"))), "A := B");
    says(&read_as(&file(codesys("<ST><p>A := B;</p></ST>"))), "a program without a task");
}

#[test]
fn attributes_have_values_of_their_types_and_texts_are_of_one_piece() {
    let contact = |attributes: &str| {
        let contact = format!(
            r#"<contact localId="2" {attributes}><connectionPointIn><connection refLocalId="1"/></connectionPointIn><variable>A</variable></contact>"#
        );
        read_as(&beremiz(&ladder(&[&contact, &behind(2, "")])))
    };
    assert_eq!(contact(r#"negated="1""#), "Q := not A");
    assert_eq!(contact(r#"negated=" false ""#), "Q := A");
    for (attributes, part) in [
        (r#"negated="yes""#, "`yes` is no value of the attribute `negated`"),
        (r#"edge="up""#, "`up` is no value of the attribute `edge`"),
        (r#"storage="held""#, "`held` is no value of the attribute `storage`"),
        (r#"storage="set""#, "`storage` = `set` of contact `A`"),
        (r#"xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:nil="true""#, "`nil` = `true`"),
        (r#"schemaLocation="x""#, "`schemaLocation` = `x`"),
        (r#"xmlns:o="urn:other" o:negated="true""#, "`negated` = `true`"),
    ] {
        says(&contact(attributes), part);
    }
    let known = r#"xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:schemaLocation="a b""#;
    assert_eq!(contact(known), "Q := A");
    for (body, part) in [
        (ladder(&["words"]), "a text in LD"),
        ("<ST>A := B;<p>A := A;</p></ST>".to_owned(), "a text in pieces"),
        ("<ST><p>A := B;<!-- words --></p></ST>".to_owned(), "a text in pieces"),
        ("<ST><p>A := B;</p><p>A := A;</p></ST>".to_owned(), "a text in pieces"),
    ] {
        says(&read_as(&beremiz(&body)), part);
    }
    assert_eq!(read_as(&beremiz("<ST> <p>\n<b>A := B;</b> </p> </ST>")), "A := B");
}

/// A file of CODESYS in whose program, or list of global variables, a vendor has added something.
fn added(globals: bool, name: &str, data: &str) -> String {
    let data = format!(
        r#"<addData><data name="http://www.3s-software.com/plcopenxml/{name}" handleUnknown="implementation">{data}</data></addData>"#
    );
    let file = codesys("<ST><p>A := B;</p></ST>");
    if !globals {
        return read_as(&file.replacen("</pou>", &format!("{data}</pou>"), 1));
    }
    let list = format!(
        r#"<addData><data name="http://www.3s-software.com/plcopenxml/globalvars" handleUnknown="implementation"><globalVars name="More"><variable name="G"><type><INT/></type></variable>{data}</globalVars></data></addData></project>"#
    );
    read_as(&file.replacen("</project>", &list, 1))
}

#[test]
fn a_list_that_is_read_by_its_name_alone_is_read_and_nothing_else_of_a_list() {
    let attributes = |list: &[&str]| {
        let list: String = list.iter().map(|name| format!(r#"<Attribute Name="{name}" Value=""/>"#)).collect();
        format!(r#"<Attributes xmlns="">{list}</Attributes>"#)
    };
    let said = |list: &[&str]| added(true, "attributes", &attributes(list));
    assert_eq!(said(&["qualified_only"]), "A := B");
    for list in [&["init_on_onlchange"][..], &["qualified_only", "pack_mode"], &[]] {
        says(&said(list), "the vendor data `http://www.3s-software.com/plcopenxml/attributes`");
    }
    let other = attributes(&["qualified_only"]).replace("<Attribute ", "<Other ");
    says(&added(true, "attributes", &other), "the vendor data");
    let build = |inner: &str| {
        added(false, "buildproperties", &format!(r#"<BuildProperties xmlns="">{inner}</BuildProperties>"#))
    };
    assert_eq!(build("<LinkAlways>true</LinkAlways>"), "A := B");
    says(&build("<LinkAlways>true</LinkAlways><ExcludeFromBuild>true</ExcludeFromBuild>"), "the vendor data");
    says(&build(""), "the vendor data");
}

#[test]
fn declarations_in_words_say_what_the_lists_say() {
    let words = |globals: bool, text: &str| {
        added(
            globals,
            "interfaceasplaintext",
            &format!(r#"<InterfaceAsPlainText><p xmlns="x">{text}</p></InterfaceAsPlainText>"#),
        )
    };
    let list = "PROGRAM P\nVAR\n A, B : BOOL; I : INT; J : INT; On : TON; Off : TOF; Q : BOOL;\nEND_VAR\n";
    assert_eq!(words(false, list), "A := B");
    assert_eq!(words(true, "VAR_GLOBAL G : INT; END_VAR"), "A := B");
    assert_eq!(words(true, "{attribute 'qualified_only'}\nVAR_GLOBAL\n\tG : INT; // words\nEND_VAR\n"), "A := B");
    for (globals, text) in [
        (false, list.replace("Q : BOOL", "Q : BOOL := TRUE")),
        (false, list.replace("PROGRAM P", "PROGRAM Q")),
        (false, String::new()),
        (true, "VAR_GLOBAL CONSTANT G : INT; END_VAR".to_owned()),
        (true, "VAR_GLOBAL G : INT := 1; END_VAR".to_owned()),
        (true, "VAR G : INT; END_VAR".to_owned()),
    ] {
        says(&words(globals, &text), "a text of declarations that is not known to say what the lists say");
    }
}

#[test]
fn vendor_data_holds_parts_of_the_project_where_its_tool_looks_for_them() {
    let list = r#"<globalVars name="More"><variable name="A"><type><INT/></type></variable></globalVars>"#;
    let pou = r#"<pou name="New" pouType="program"><interface/><body><ST><p>;</p></ST></body></pou>"#;
    for (name, data) in [("globalvars", pou), ("pou", list), ("resource", list), ("projectstructure", list)] {
        let found = added(false, name, data);
        says(&found, "at this place");
    }
}
