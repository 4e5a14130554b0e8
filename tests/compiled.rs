//! Files that the official schema permits and that Beremiz cannot compile: they are refused, each with its reason.

use crate::support::models;
use crate::support::proof::build;
use chartwright::emit::Dialect;
use chartwright::read;

/// What is said of the program of the model of a timer after one replacement.
fn said(dialect: Dialect, from: &str, to: &str) -> String {
    let model = models::all().into_iter().find(|m| m.name == "timer").expect("it is a model");
    let xml = build(&model.source, dialect).unwrap_or_else(|e| panic!("{e}")).xml;
    assert!(xml.contains(from), "{from}");
    let (project, diagnostics) = read::read(&xml.replacen(from, to, 1));
    assert_eq!(project.is_none(), diagnostics.has_errors());
    diagnostics.iter().map(|d| format!("{} {}", d.code.number(), d.message)).collect::<Vec<_>>().join("; ")
}

#[test]
fn what_beremiz_cannot_compile_is_refused() {
    let contact = r#"<contact localId="99"><position x="0" y="0"/><connectionPointOut/><variable>LIGHT</variable></contact></LD>"#;
    let block = r#"<block localId="99" typeName="OWN"><position x="0" y="0"/><inputVariables/><inOutVariables/><outputVariables/></block></LD>"#;
    let function = r#"<pous><pou name="New" pouType="function"><interface/><body><ST><p/></ST></body></pou>"#;
    for (from, to, part) in [
        ("<configuration name=\"", "<configuration name=\"1", "the name of configuration"),
        ("<configuration name=\"Config\"", "<configuration name=\"\"", "the name of configuration"),
        ("<resource name=\"Res\"", "<resource name=\"TRUE\"", "the name of resource `TRUE`"),
        ("<task name=\"", "<task name=\"T#", "the name of task"),
        ("<pouInstance name=\"", "<pouInstance name=\"__", "the name of pouInstance"),
        ("</configuration>", "<globalVars/></configuration>", "a list of global variables without any"),
        ("</resource>", "<globalVars/></resource>", "a list of global variables without any"),
        (
            "<externalVars>\n      <variable ",
            "<externalVars>\n      <variable address=\"\" ",
            "the empty address of variable",
        ),
        ("qualifier=\"N\"", "qualifier=\"N\" indicator=\"\"", "the indicator of action"),
        ("</LD>", contact, "contact `LIGHT` (number 99), which has no place for a line,"),
        ("</LD>", block, "the type of block `OWN` (number 99)"),
        ("<pous>", "<pous><pou name=\"New\" pouType=\"program\"><interface/></pou>", "pou `New` without a body"),
        (
            "<pous>",
            "<pous><pou name=\"New\" pouType=\"program\"><body><ST><p/></ST></body></pou>",
            "pou `New` without an interface",
        ),
        ("<pous>", function, "pou `New` without a type"),
        (
            "<connection refLocalId=\"22\" formalParameter=\"Q\">",
            "<connection refLocalId=\"22\" formalParameter=\"\">",
            "without a name",
        ),
    ] {
        let found = said(Dialect::Beremiz, from, to);
        assert!(found.contains(part) && found.contains("E602"), "{part}: {found}");
    }
    for (from, to) in [
        ("<configuration name=\"Config\"", "<configuration name=\"other\""),
        ("<pous>", &function.replace("<interface/>", "<interface><returnType><BOOL/></returnType></interface>")),
    ] {
        assert_eq!(said(Dialect::Beremiz, from, to), "", "{to}");
    }
    // CODESYS compiles these, or does not know them.
    for (from, to) in [("</LD>", contact), ("<pous>", function)] {
        assert_eq!(said(Dialect::Codesys, from, to), "", "{to}");
    }
}
