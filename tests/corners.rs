//! Corners of the reader: each a place where one more or one less, or a neighbour, would mean something else.

use crate::support::st::{self, read_as};

const VARIABLES: [(&str, &str); 10] = [
    ("A", "BOOL"),
    ("B", "BOOL"),
    ("C", "BOOL"),
    ("I", "INT"),
    ("J", "INT"),
    ("D", "TIME"),
    ("On", "TON"),
    ("Off", "TOF"),
    ("Up", "R_TRIG"),
    ("Down", "F_TRIG"),
];

fn beremiz(body: &str) -> String {
    st::file(&VARIABLES, body)
}

fn codesys(body: &str) -> String {
    beremiz(body).replace("tc6_0201", "tc6_0200")
}

fn ladder(parts: &[String]) -> String {
    format!(r#"<LD><leftPowerRail localId="1"/>{}</LD>"#, parts.concat())
}

/// An element with lines from others.
fn element(tag: &str, number: u32, attributes: &str, from: &[u32], rest: &str) -> String {
    let lines: String = from.iter().map(|n| format!(r#"<connection refLocalId="{n}"/>"#)).collect();
    let point = if from.is_empty() { String::new() } else { format!("<connectionPointIn>{lines}</connectionPointIn>") };
    format!(r#"<{tag} localId="{number}" {attributes}>{point}{rest}</{tag}>"#)
}

fn contact(number: u32, from: &[u32], name: &str) -> String {
    element("contact", number, "", from, &format!("<variable>{name}</variable>"))
}

fn coil(number: u32, from: &[u32], name: &str) -> String {
    element("coil", number, "", from, &format!("<variable>{name}</variable>"))
}

fn value(number: u32, text: &str) -> String {
    element("inVariable", number, "", &[], &format!("<expression>{text}</expression>"))
}

#[test]
fn a_coil_with_elements_after_it_has_one_line_before_it() {
    let body =
        |from: &[u32]| ladder(&[contact(2, &[1], "A"), contact(3, &[1], "B"), coil(4, from, "C"), coil(5, &[4], "C")]);
    assert_eq!(read_as(&beremiz(&body(&[2]))), "C := A; C := A");
    assert_eq!(read_as(&codesys(&body(&[2]))), "C := A; C := A");
    let both = read_as(&beremiz(&body(&[2, 3])));
    assert!(both.contains("coil `C` (number 4) with elements after it and parallel branches before it"), "{both}");
    let both = read_as(&codesys(&body(&[2, 3])));
    assert!(both.starts_with("C := (A or B); C := (A or B)") || both.contains("E602"), "{both}");
}

#[test]
fn a_text_in_series_has_parentheses() {
    let body = |text: &str| ladder(&[value(2, text), contact(3, &[2], "A"), coil(4, &[3], "C")]);
    assert_eq!(read_as(&beremiz(&body("A AND B"))), "C := (A and B and A)");
    assert_eq!(read_as(&beremiz(&body("(A OR B)"))), "C := ((A or B) and A)");
    assert_eq!(read_as(&beremiz(&body("NOT B"))), "C := (not B and A)");
    for loose in ["A OR B", "A XOR B"] {
        let found = read_as(&beremiz(&body(loose)));
        assert!(found.contains("in series, without parentheses around it"), "{loose}: {found}");
    }
    // Not in series.
    let alone = ladder(&[value(2, "A OR B"), coil(4, &[2], "C")]);
    assert_eq!(read_as(&beremiz(&alone)), "C := (A or B)");
}

#[test]
fn edges_rise_or_fall() {
    let body = |edge: &str| {
        ladder(&[
            element("contact", 2, &format!(r#"edge="{edge}""#), &[1], "<variable>A</variable>"),
            coil(3, &[2], "B"),
        ])
    };
    assert!(read_as(&beremiz(&body("rising"))).starts_with("RTrig "), "{}", read_as(&beremiz(&body("rising"))));
    assert!(read_as(&beremiz(&body("falling"))).starts_with("FTrig "), "{}", read_as(&beremiz(&body("falling"))));
    assert_eq!(read_as(&beremiz(&body("none"))), "B := A");
}

fn line(from: u32) -> String {
    format!(r#"<connection refLocalId="{from}"/>"#)
}

/// A line from the output of a block, as Beremiz needs it: with its end.
fn line_from_block(from: u32) -> String {
    format!(r#"<connection refLocalId="{from}" formalParameter="Q"><position x="0" y="0"/></connection>"#)
}

/// A block with pins that lines enter; blocks have numbers from 10 on.
fn block(number: u32, kind: &str, name: &str, pins: &[(&str, u32)]) -> String {
    let pins: String = pins
        .iter()
        .map(|(pin, from)| {
            format!(
                r#"<variable formalParameter="{pin}"><connectionPointIn>{}</connectionPointIn></variable>"#,
                if *from < 10 { line(*from) } else { line_from_block(*from) }
            )
        })
        .collect();
    format!(
        r#"<block localId="{number}" typeName="{kind}" instanceName="{name}"><inputVariables>{pins}</inputVariables><inOutVariables/><outputVariables><variable formalParameter="Q"/></outputVariables></block>"#
    )
}

#[test]
fn a_chain_of_blocks_has_a_greatest_length_and_a_row_has_none() {
    let variables: Vec<(String, &str)> =
        (0..70).map(|n| (format!("E{n}"), "R_TRIG")).chain([("A".into(), "BOOL")]).collect();
    let variables: Vec<(&str, &str)> = variables.iter().map(|(name, kind)| (name.as_str(), *kind)).collect();
    let read = |count: u32, nested: bool| {
        let blocks: String = (0..count)
            .map(|n| block(10 + n, "R_TRIG", &format!("E{n}"), &[("CLK", if nested && n > 0 { 9 + n } else { 1 })]))
            .collect();
        let point = format!("<connectionPointIn>{}</connectionPointIn>", line_from_block(9 + count));
        let body = ladder(&[blocks, element("coil", 5, "", &[], &format!("{point}<variable>A</variable>"))]);
        read_as(&st::file(&variables, &body))
    };
    assert!(read(64, true).ends_with("A := E63.Q"), "{}", read(64, true));
    assert!(read(65, true).contains("a chain of more than 64 function blocks"), "{}", read(65, true));
    assert!(read(70, false).contains("A := E69.Q"), "{}", read(70, false));
}

#[test]
fn a_number_comes_from_one_place() {
    let timer = |from: &str| {
        format!(
            r#"<block localId="4" typeName="TON" instanceName="On"><inputVariables><variable formalParameter="IN"><connectionPointIn><connection refLocalId="1"/></connectionPointIn></variable><variable formalParameter="PT"><connectionPointIn>{from}</connectionPointIn></variable></inputVariables><inOutVariables/><outputVariables><variable formalParameter="Q"/></outputVariables></block>"#
        )
    };
    let sum = r#"<block localId="3" typeName="ADD"><inputVariables><variable formalParameter="IN1"><connectionPointIn><connection refLocalId="2"/></connectionPointIn></variable></inputVariables><inOutVariables/><outputVariables><variable formalParameter="OUT"/></outputVariables></block>"#;
    let read_with =
        |sum: &str, from: &str| read_as(&beremiz(&ladder(&[value(2, "T#1s"), value(5, "D"), sum.into(), timer(from)])));
    let read = |from: &str| read_with("", from);
    assert_eq!(read(&line(2)), "Ton On in true preset 1000000");
    assert_eq!(read(&line(5)), "Ton On in true preset D");
    let text = ladder(&[timer("<expression>D</expression>")]);
    assert_eq!(read_as(&codesys(&text)), "Ton On in true preset D");
    assert!(read_as(&beremiz(&text)).contains("expression in `connectionPointIn` is not understood"));
    for (from, reason) in [(line(2) + &line(5), "several lines into one input"), (line(1), "as the source of a number")]
    {
        assert!(read(&from).contains(reason), "{from}: {}", read(&from));
    }
    let found = read_with(sum, &line(3));
    assert!(found.contains("as the source of a number"), "{found}");
    // Beremiz calls it whether its result is used or not.
    assert!(read_with(sum, &line(2)).contains("an expression at block `ADD`"), "{}", read_with(sum, &line(2)));
    let texts = |first: &str, second: &str| {
        let pin = |name: &str, text: &str| {
            format!(
                r#"<variable formalParameter="{name}"><connectionPointIn><expression>{text}</expression></connectionPointIn></variable>"#
            )
        };
        let inputs = pin("In1", first) + &pin("In2", second);
        let out = r#"<variable formalParameter="Out"><connectionPointOut><expression>I</expression></connectionPointOut></variable>"#;
        read_as(&codesys(&ladder(&[format!(
            r#"<block localId="3" typeName="SUB"><inputVariables>{inputs}</inputVariables><inOutVariables/><outputVariables>{out}</outputVariables></block>"#
        )])))
    };
    assert_eq!(texts("J", "3"), "I := (J - 3)");
    assert!(texts("J", "I + 1").contains("an expression at block `SUB`"), "{}", texts("J", "I + 1"));
}

#[test]
fn only_titles_of_networks_are_vendor_elements_that_do_nothing() {
    let title = |types: &str| {
        let vendor = format!(
            r#"<vendorElement localId="7"><alternativeText><p></p></alternativeText><addData><data name="http://www.3s-software.com/plcopenxml/fbdelementtype" handleUnknown="implementation">{types}</data></addData></vendorElement>"#
        );
        read_as(&codesys(&ladder(&[vendor, contact(2, &[1], "A"), coil(3, &[2], "B")])))
    };
    let one = |name: &str| format!(r#"<ElementType xmlns="">{name}</ElementType>"#);
    assert_eq!(title(&one("networktitle")), "B := A");
    for other in [one("jump"), String::new(), one("networktitle") + &one("networktitle")] {
        assert!(title(&other).starts_with("E602"), "{other}: {}", title(&other));
    }
}

fn step(number: u32, name: &str, from: &[u32]) -> String {
    let initial = if from.is_empty() { r#"initialStep="true""# } else { "" };
    element("step", number, &format!(r#"name="{name}" {initial}"#), from, "")
}

fn transition(number: u32, from: &[u32], condition: &str) -> String {
    let condition = format!(r#"<condition><inline name=""><ST><p>{condition}</p></ST></inline></condition>"#);
    element("transition", number, "", from, &condition)
}

fn jump(number: u32, from: &[u32], to: &str) -> String {
    element("jumpStep", number, &format!(r#"targetName="{to}""#), from, "")
}

fn does(number: u32, step: u32, action: &str) -> String {
    let action = format!(r#"<action localId="{number}0"><reference name="{action}"/></action>"#);
    element("actionBlock", number, "", &[step], &action)
}

const ACTIONS: &str = r#"<actions><action name="First"><body><ST><p>I := 1;</p></ST></body></action><action name="Second"><body><ST><p>I := 2;</p></ST></body></action></actions><body><SFC>"#;

#[test]
fn actions_run_in_the_order_of_the_steps_that_name_them() {
    let chart = |parts: &[String]| {
        let file = beremiz(&format!("<SFC>{}</SFC>", parts.concat()));
        read_as(&file.replacen("<body><SFC>", ACTIONS, 1))
    };
    // The second step is drawn first.
    let found = chart(&[
        step(4, "Two", &[3]),
        does(5, 4, "Second"),
        transition(6, &[4], "B"),
        jump(7, &[6], "One"),
        step(1, "One", &[]),
        does(2, 1, "First"),
        transition(3, &[1], "A"),
    ]);
    assert_eq!(
        found,
        "step One initial;   NonStored 0 action First; step Two;   NonStored 0 action Second; One > Two when A; \
         Two > One when B; action First;   I := 1; action Second;   I := 2"
    );
}

#[test]
fn blocks_of_conditions_run_with_the_first_step() {
    let parts = [
        step(1, "One", &[]),
        element("contact", 8, r#"edge="rising""#, &[9], "<variable>A</variable>"),
        r#"<leftPowerRail localId="9"/>"#.to_owned(),
        element(
            "transition",
            2,
            "",
            &[1],
            r#"<condition><connectionPointIn><connection refLocalId="8"/></connectionPointIn></condition>"#,
        ),
        jump(3, &[2], "One"),
    ];
    let found = read_as(&beremiz(&format!("<SFC>{}</SFC>", parts.concat())));
    assert!(found.contains("step One initial;   Set 0 action COMPUTE_FUNCTION_BLOCKS; One > One when"), "{found}");
    assert!(found.contains("action COMPUTE_FUNCTION_BLOCKS;   RTrig"), "{found}");
    let plain = [step(1, "One", &[]), transition(2, &[1], "A"), jump(3, &[2], "One")];
    let plain = read_as(&beremiz(&format!("<SFC>{}</SFC>", plain.concat())));
    assert_eq!(plain, "step One initial; One > One when A");
}

#[test]
fn implicit_variables_by_which_others_stop_a_chart_are_refused() {
    let chart = |flags: &str| {
        let parts = [step(1, "One", &[]), transition(2, &[1], "A"), jump(3, &[2], "One")];
        let data = format!(
            r#"</body><addData><data name="http://www.3s-software.com/plcopenxml/sfcsettings" handleUnknown="implementation"><SFCSettings xmlns=""><Flags>{flags}</Flags></SFCSettings></data></addData></pou>"#
        );
        let file = codesys(&format!("<SFC>{}</SFC>", parts.concat()));
        read_as(&file.replace("</body></pou>", &data))
    };
    for flag in ["Init", "Reset", "Pause", "Tip", "TipMode"] {
        let flag_of = |used: &str| format!(r#"<{flag} Use="{used}" Declare="true"/>"#);
        let found = chart(&flag_of("true"));
        assert!(found.contains(&format!("the SFC flag `SFC{flag}`")), "{found}");
        assert!(!chart(&flag_of("false")).contains("the SFC flag"), "{}", chart(&flag_of("false")));
    }
    assert!(!chart(r#"<Trans Use="true"/>"#).contains("the SFC flag"), "{}", chart(r#"<Trans Use="true"/>"#));
}

/// A file with these types and instances.
fn project(pous: &str, resource: &str) -> String {
    let file = beremiz("<ST><p>A := B;</p></ST>");
    let file = file.replacen("</pous>", &format!("{pous}</pous>"), 1);
    if resource.is_empty() {
        return file;
    }
    let end = format!(
        r#"<instances><configurations><configuration name="C"><resource name="Res">{resource}</resource></configuration></configurations></instances></project>"#
    );
    file.replacen("</project>", &end, 1)
}

const BLOCK: &str = r#"<pou name="Own" pouType="functionBlock"><interface/><body><ST><p>;</p></ST></body></pou>"#;

#[test]
fn only_programs_run() {
    let count = |file: &str| chartwright::read::read(file).0.map(|p| p.programs.len());
    assert_eq!(count(&project("", "")), Some(1));
    assert_eq!(count(&project(BLOCK, "")), Some(1));
    let task = |interval: &str, kind: &str| {
        let task = format!(
            r#"<task name="T" interval="{interval}" priority="0"><pouInstance name="Q" typeName="{kind}"/></task>"#
        );
        read_as(&project(BLOCK, &task))
    };
    assert_eq!(task("T#10ms", "P"), "A := B");
    for (interval, kind, reason) in [
        ("T#10ms", "Own", "`Own`, which is no program, as an instance"),
        ("T#10ms", "Nobody", "there is no program `Nobody`"),
        ("T#0s", "P", "`T#0s` is no interval of a task"),
        ("T#-1s", "P", "`T#-1s` is no interval of a task"),
        ("P0D", "P", "`P0D` is no interval of a task"),
    ] {
        let found = task(interval, kind);
        assert!(found.contains(reason), "{interval} {kind}: {found}");
    }
    let stray = project(BLOCK, "").replacen("</types>", &format!("{}</types>", BLOCK.replace("Own", "Stray")), 1);
    assert!(read_as(&stray).starts_with("E6"), "{}", read_as(&stray));
}

#[test]
fn what_an_external_variable_or_a_block_begins_with_is_refused() {
    let with = |variable: &str| {
        let file = project("", "").replacen("</interface>", &format!("{variable}</interface>"), 1);
        let globals = r#"<instances><configurations><configuration name="C"><resource name="Res"><task name="T" interval="T#10ms" priority="0"><pouInstance name="Q" typeName="P"/></task><globalVars><variable name="G"><type><INT/></type></variable></globalVars></resource></configuration></configurations></instances></project>"#;
        read_as(&file.replacen("</project>", globals, 1))
    };
    let initial = r#"<initialValue><simpleValue value="3"/></initialValue>"#;
    let external = |attributes: &str, rest: &str| {
        with(&format!(
            r#"<externalVars><variable name="G" {attributes}><type><INT/></type>{rest}</variable></externalVars>"#
        ))
    };
    assert_eq!(external("", ""), "A := B");
    for found in [external("", initial), external(r#"address="%MW0""#, ""), external(r#"address="%MW0""#, initial)] {
        assert!(found.contains("the value or address of the external variable `G`"), "{found}");
    }
    let local = |kind: &str| {
        with(&format!(
            r#"<tempVars></tempVars><localVars><variable name="Z"><type>{kind}</type>{initial}</variable></localVars>"#
        ))
    };
    let found = local(r#"<derived name="TON"/>"#);
    assert!(found.starts_with("E6"), "{found}");
}

#[test]
fn what_several_lines_leave_is_written_once() {
    let body = |before: &[String], from: u32| {
        let ends = [contact(20, &[from], "B"), contact(21, &[from], "C"), coil(22, &[20, 21], "B")];
        ladder(&[before.concat(), ends.concat()])
    };
    let one = [contact(2, &[1], "A")];
    assert_eq!(read_as(&beremiz(&body(&one, 2))), "B := ((A and B) or (A and C))");
    let two = [contact(2, &[1], "A"), contact(3, &[2], "B")];
    assert_eq!(read_as(&beremiz(&body(&two, 3))), "B := ((shared 0 and B) or (shared 0 and C)) with (A and B)");
    let not = [element("contact", 2, r#"negated="true""#, &[1], "<variable>A</variable>")];
    assert_eq!(read_as(&beremiz(&body(&not, 2))), "B := ((not A and B) or (not A and C))");
    // A long chain is cut into parts, each with a place of its own.
    let chain = |count: u32| {
        let contacts: String = (2..count + 2).map(|n| contact(n, &[n - 1], "A")).collect();
        read_as(&beremiz(&ladder(&[contacts, coil(99, &[count + 1], "B")])))
    };
    assert!(!chain(11).contains("with"), "{}", chain(11));
    assert!(chain(12).contains("with") && !chain(12).contains("shared 1"), "{}", chain(12));
    assert!(chain(40).contains("shared 1"), "{}", chain(40));
}

#[test]
fn a_problem_is_shown_where_it_is() {
    let text = beremiz(&ladder(&[contact(2, &[1], "A"), coil(3, &[2], "Nobody")]));
    let (_, diagnostics) = chartwright::read::read(&text);
    let shown: Vec<&str> =
        diagnostics.iter().flat_map(|d| &d.labels).map(|l| &text[l.span.start as usize..l.span.end as usize]).collect();
    assert_eq!(shown, ["<coil"]);
    let broken = text.replace("</coil>", "\n</cöil>");
    let (_, diagnostics) = chartwright::read::read(&broken);
    let at: Vec<&str> = diagnostics.iter().flat_map(|d| &d.labels).map(|l| &broken[l.span.start as usize..]).collect();
    assert!(at[0].starts_with("</cöil>"), "{}", at[0]);
}

#[test]
fn only_a_project_is_one() {
    let good = beremiz("<ST><p>A := B;</p></ST>");
    let other = good.replace("<project ", "<library ").replace("</project>", "</library>");
    assert!(read_as(&other).contains("the root element is not a PLCopen project"), "{}", read_as(&other));
}

#[test]
fn names_of_the_standard_are_not_declared_anew() {
    for name in ["ADD", "sel", "TON", "R_TRIG", "INT"] {
        let own = BLOCK.replace("Own", name);
        let found = read_as(&project(&own, ""));
        assert!(found.contains(&format!("a `{name}` other than that of the standard")), "{found}");
    }
}

#[test]
fn a_function_block_begins_with_nothing_else() {
    let file = project("", "");
    let block = r#"<localVars><variable name="Z"><type><derived name="TON"/></type><initialValue><simpleValue value="3"/></initialValue></variable></localVars></interface>"#;
    let found = read_as(&file.replacen("</interface>", block, 1));
    assert!(found.contains("the initial value of function block `Z`"), "{found}");
    let more = r#"<localVars><variable name="Z"><type><INT/></type></variable></localVars></interface>"#;
    assert_eq!(read_as(&file.replacen("</interface>", more, 1)), "A := B");
}

#[test]
fn a_transition_that_waits_for_a_step_out_of_reach_is_refused() {
    let join = |tag: &str, number: u32, from: &[u32]| {
        let points: String = from
            .iter()
            .map(|n| format!(r#"<connectionPointIn><connection refLocalId="{n}"/></connectionPointIn>"#))
            .collect();
        format!(r#"<{tag} localId="{number}">{points}</{tag}>"#)
    };
    let chart = |parts: &[String]| read_as(&beremiz(&format!("<SFC>{}</SFC>", parts.concat())));
    let alone = element("step", 5, r#"name="Alone""#, &[], "");
    let found = chart(&[
        step(1, "One", &[]),
        alone,
        join("simultaneousConvergence", 6, &[1, 5]),
        transition(7, &[6], "A"),
        jump(8, &[7], "One"),
    ]);
    assert!(found.contains("a transition waits for a step that is never reached"), "{found}");
    // Only a tool of the other family draws the end of a branch as a jump within a convergence.
    let branches = [
        step(1, "One", &[]),
        join("selectionDivergence", 2, &[1]),
        transition(3, &[2], "A"),
        transition(4, &[2], "B"),
        jump(5, &[3], "One"),
        join("selectionConvergence", 6, &[5, 4]),
        jump(7, &[6], "One"),
    ];
    let found = chart(&branches);
    assert!(found.contains("a line from jumpStep `One` (number 5) to selectionConvergence"), "{found}");
    let found = read_as(&codesys(&format!("<SFC>{}</SFC>", branches.concat())));
    assert!(found.contains("One > One when A") && found.contains("One > One when B"), "{found}");
}

#[test]
fn an_action_block_stands_for_its_step_in_the_order_of_a_drawing() {
    let chart = |first: String| {
        let parts = [
            first,
            step(1, "One", &[]),
            element("selectionDivergence", 2, "", &[1], ""),
            transition(3, &[2], "A"),
            step(4, "Two", &[3]),
            transition(5, &[2], "B"),
            step(6, "Three", &[5]),
            transition(7, &[4], "C"),
            jump(8, &[7], "One"),
            transition(9, &[6], "C"),
            jump(10, &[9], "One"),
        ];
        let file = beremiz(&format!("<SFC>{}</SFC>", parts.concat()));
        read_as(&file.replacen("<body><SFC>", ACTIONS, 1))
    };
    let order = |text: &str| (text.find("One > Two").expect("there"), text.find("One > Three").expect("there"));
    let (two, three) = order(&chart(String::new()));
    assert!(two < three);
    let (two, three) = order(&chart(does(20, 6, "First")));
    assert!(three < two, "{}", chart(does(20, 6, "First")));
}

#[test]
fn what_a_vendor_says_again_agrees() {
    let attributes = |list: &[(&str, &str)]| {
        let list: String =
            list.iter().map(|(guid, text)| format!(r#"<attribute guid="{guid}">{text}</attribute>"#)).collect();
        format!(
            r#"<addData><data name="http://www.3s-software.com/plcopenxml/sfc/element" handleUnknown="implementation"><attributes xmlns="">{list}</attributes></data></addData>"#
        )
    };
    let name = |text: &str| attributes(&[("38391c6d-6d4a-42f8-8ee7-9f45e5adafa8", text)]);
    let excluded = |text: &str| attributes(&[("01580b27-6378-448b-8ecb-0e4b795b58d6", text)]);
    let more = |guid: &str| attributes(&[(guid, "Other")]);
    let chart = |of_step: &str, of_jump: &str, of_action: &str| {
        let action = format!(r#"<action localId="50"><reference name="A"/>{of_action}</action>"#);
        let parts = [
            element("step", 1, r#"name="One" initialStep="true""#, &[], of_step),
            element("actionBlock", 5, "", &[1], &action),
            transition(2, &[1], "A"),
            element("jumpStep", 3, r#"targetName="One""#, &[2], of_jump),
        ];
        read_as(&codesys(&format!("<SFC>{}</SFC>", parts.concat())))
    };
    let good = chart("", "", "");
    assert!(good.starts_with("step One"), "{good}");
    assert_eq!(chart(&name("One"), &name("one"), &name("A")), good);
    assert_eq!(chart(&name(""), &excluded(""), &excluded("FALSE")), good);
    for (found, part) in [
        (chart(&name("Two"), "", ""), "`Two`, which contradicts step `One`"),
        (chart("", &name("Two"), ""), "`Two`, which contradicts jump"),
        (chart("", "", &name("B")), "`B`, which contradicts action"),
        (chart(&excluded("TRUE"), "", ""), "step `One` (number 1), excluded from execution"),
        (chart(&excluded("maybe"), "", ""), "`maybe`, which contradicts step `One`"),
        (chart(&more("700a583f-b4d4-43e4-8c14-629c7cd3bec8"), "", ""), "the main action of step `One`"),
        (chart(&more("a6b08bd8-b696-47e3-9cbf-7408b61c9ff8"), "", ""), "the entry action of step `One`"),
        (chart(&more("a2621e18-7de3-4ea6-ae6d-89e9e0b7befd"), "", ""), "the exit action of step `One`"),
        (chart(&more("cacf1a68-236e-47c2-b7b1-1cf9199718cb"), "", ""), "the minimal time of step `One`"),
        (chart(&more("b693554c-1b01-4a8d-afde-9e3a46f7465d"), "", ""), "the maximal time of step `One`"),
    ] {
        assert!(found.starts_with("E602") && found.contains(part), "{part}: {found}");
    }
}
