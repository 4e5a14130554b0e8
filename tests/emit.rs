//! PLCopen XML of projects built by hand and by chance: valid, well-formed, numbered and nested as
//! IDEs want it, and meaning what the project means.

use crate::support::read::{self, Transition};
use crate::support::{charts, plc, schema};
use chartwright::emit::{Dialect, Header, plcopen};
use chartwright::ir::expr::IEC;
use chartwright::ir::ladder::CoilKind;
use chartwright::ir::plc::{Body, Project, Role};
use chartwright::ir::sfc::Sfc;
use proptest::prelude::*;
use roxmltree::{Document, Node};
use std::collections::BTreeSet;

const DIALECTS: [Dialect; 2] = [Dialect::Beremiz, Dialect::Codesys];

fn emit(project: &Project, dialect: Dialect) -> String {
    plcopen(project, dialect, &Header::default())
}

fn elements<'a, 'input>(document: &'a Document<'input>, name: &'a str) -> Vec<Node<'a, 'input>> {
    document.descendants().filter(|n| n.tag_name().name() == name).collect()
}

/// Fails unless the bodies of `xml` are those of `project`.
fn assert_meaning(project: &Project, xml: &str, dialect: Dialect) {
    let document = Document::parse(xml).expect("well-formed");
    let bodies = read::bodies(&document);
    assert_eq!(bodies.len(), project.programs.len());
    for (program, body) in project.programs.iter().zip(&bodies) {
        match &program.body {
            Body::Sfc(sfc) => {
                assert_eq!(body.transitions(), transitions(project, sfc), "{dialect:?}");
                assert_eq!(body.steps(), steps(project, sfc));
            }
            Body::Ladder(_) => assert_eq!(rungs(body.rungs()), expected_rungs(project, &program.body)),
        }
    }
}

fn transitions(project: &Project, sfc: &Sfc) -> Vec<Transition> {
    let mut all = Vec::new();
    for t in &sfc.transitions {
        let mut condition = String::new();
        t.condition.write(&mut condition, &IEC, &mut |&g, f| f.write_str(&project.globals[g].name)).unwrap();
        let place = t.priority as usize;
        all.push(Transition {
            from: sfc.steps[t.from].name.clone(),
            place,
            condition,
            to: sfc.steps[t.to].name.clone(),
        });
    }
    all.sort();
    all
}

fn steps(project: &Project, sfc: &Sfc) -> Vec<(String, Vec<String>)> {
    let action = |g| format!("N {}", project.globals[g].name);
    let mut all: Vec<_> =
        sfc.steps.values().map(|s| (s.name.clone(), s.flag.map(action).into_iter().collect())).collect();
    all.sort();
    all
}

type Rung = (String, String, BTreeSet<BTreeSet<String>>);

fn expected_rungs(project: &Project, body: &Body) -> Vec<Rung> {
    let Body::Ladder(ladder) = body else { panic!("a ladder") };
    let rung = |r: &chartwright::ir::ladder::Rung| {
        let kind = match r.kind {
            CoilKind::Plain => "",
            CoilKind::Set => "S",
            CoilKind::Reset => "R",
        };
        let literal = |l: &chartwright::ir::sop::Literal<_>| {
            format!("{}{}", if l.negated { "/" } else { "" }, project.globals[l.atom].name)
        };
        let one = || BTreeSet::from([BTreeSet::new()]);
        let products = r.condition.products().iter().map(|p| p.literals().iter().map(literal).collect()).collect();
        let products = if r.condition.is_one() { one() } else { products };
        (kind.to_owned(), project.globals[r.coil].name.clone(), products)
    };
    ladder.rungs.iter().map(rung).collect()
}

/// Contacts that are drawn twice count once; the rung of a ladder without rungs does not count.
fn rungs(read: Vec<(String, String, Vec<Vec<String>>)>) -> Vec<Rung> {
    let products = |all: Vec<Vec<String>>| all.into_iter().map(|p| p.into_iter().collect()).collect();
    let real = read.into_iter().filter(|(_, coil, _)| coil != "Unused");
    real.map(|(kind, coil, all)| (kind, coil, products(all))).collect()
}

#[test]
fn the_sample_is_valid_and_means_itself() {
    let project = plc::sample();
    for dialect in DIALECTS {
        let xml = emit(&project, dialect);
        schema::assert_valid("sample", &xml, dialect);
        assert_meaning(&project, &xml, dialect);
        assert_eq!(xml, emit(&project, dialect), "the same bytes twice");
    }
}

#[test]
fn odd_projects_are_valid() {
    let empty = plc::project("Empty");
    let mut odd = plc::project("Odd");
    let mut alone = Sfc::default();
    plc::step(&mut alone, "Alone", None);
    plc::program(&mut odd, "Alone", Body::Sfc(alone));
    plc::program(&mut odd, "Nothing", Body::Ladder(Default::default()));
    for dialect in DIALECTS {
        schema::assert_valid("empty", &emit(&empty, dialect), dialect);
        let xml = emit(&odd, dialect);
        schema::assert_valid("odd", &xml, dialect);
        assert_meaning(&odd, &xml, dialect);
    }
    // A program without a variable is an error in Beremiz.
    let xml = emit(&odd, Dialect::Beremiz);
    let document = Document::parse(&xml).unwrap();
    assert_eq!(elements(&document, "localVars").len(), 2);
    // A body ends in a jump in CODESYS.
    let xml = emit(&odd, Dialect::Codesys);
    let document = Document::parse(&xml).unwrap();
    let last = elements(&document, "SFC")[0].last_element_child().unwrap();
    assert_eq!(last.attribute("targetName"), Some("S_Alone"));
}

#[test]
fn any_description_stays_what_it_is() {
    let evil = "a]]>b -->&amp;<tag attr=\"x\">'\u{1}\u{0}\r\n\u{7f}\u{ffff} -- 🙂 \u{202e}e\u{301}";
    let seen = "a]]>b -->&amp;<tag attr=\"x\">'\u{fffd}\u{fffd}\n\u{7f}\u{fffd} -- 🙂 \u{202e}e\u{301}";
    let mut project = plc::sample();
    project.description = evil.to_owned();
    let g = project.globals.ids().next().unwrap();
    project.globals[g].description = evil.to_owned();
    for program in &mut project.programs {
        program.description = evil.to_owned();
        match &mut program.body {
            Body::Sfc(sfc) => {
                sfc.steps[chartwright::ir::sfc::StepId::from_index(0)].description = evil.to_owned();
                sfc.transitions[0].description = evil.to_owned();
            }
            Body::Ladder(ladder) => ladder.rungs[0].comment = evil.to_owned(),
        }
    }
    for dialect in DIALECTS {
        let xml = emit(&project, dialect);
        schema::assert_valid("evil", &xml, dialect);
        assert_meaning(&project, &xml, dialect);
        let document = Document::parse(&xml).unwrap();
        let text = |n: &Node| -> String { n.descendants().filter(Node::is_text).filter_map(|t| t.text()).collect() };
        // Project, global, four programs, two first steps, two first transitions, two first rungs.
        assert_eq!(document.descendants().filter(|n| n.is_element() && text(n) == seen).count(), 12);
    }
}

#[test]
fn a_beremiz_project_declares_what_it_uses() {
    let project = plc::sample();
    let xml = emit(&project, Dialect::Beremiz);
    let document = Document::parse(&xml).unwrap();
    for (program, pou) in project.programs.iter().zip(elements(&document, "pou")) {
        let external = pou.descendants().find(|n| n.tag_name().name() == "externalVars").unwrap();
        let names: Vec<_> = external.children().filter_map(|v| v.attribute("name")).collect();
        let used: Vec<_> = program.globals().into_iter().map(|g| project.globals[g].name.as_str()).collect();
        assert_eq!(names, used);
    }
    let task = elements(&document, "task")[0];
    assert_eq!((task.attribute("interval"), task.attribute("priority")), (Some("T#10ms"), Some("0")));
    let order: Vec<_> = task.children().filter_map(|i| i.attribute("typeName")).collect();
    assert_eq!(order, ["P_Conditions", "P_Modes", "P_Run", "P_Outputs"]);
}

#[test]
fn located_globals_come_first() {
    let mut project = plc::project("Order");
    plc::global(&mut project, "B", Role::Variable, None);
    plc::global(&mut project, "A", Role::Input, Some("%IX0.1"));
    plc::global(&mut project, "C", Role::Variable, None);
    plc::global(&mut project, "D", Role::Input, Some("%IX0.0"));
    let xml = emit(&project, Dialect::Beremiz);
    let document = Document::parse(&xml).unwrap();
    let list = elements(&document, "globalVars")[0];
    let names: Vec<_> = list.children().filter_map(|v| v.attribute("name")).collect();
    assert_eq!(names, ["A", "D", "B", "C"]);
}

#[test]
fn a_codesys_project_tells_its_task_in_vendor_data() {
    let mut project = plc::sample();
    plc::global(&mut project, "gvl", Role::Variable, None);
    for (interval, written) in [(10, "PT0.01S"), (1000, "PT1S"), (1500, "PT1.5S"), (20_000, "PT20S"), (1, "PT0.001S")] {
        project.task.interval = interval;
        let xml = emit(&project, Dialect::Codesys);
        let document = Document::parse(&xml).unwrap();
        assert_eq!(elements(&document, "task")[0].attribute("interval"), Some(written));
    }
    let xml = emit(&project, Dialect::Codesys);
    let document = Document::parse(&xml).unwrap();
    assert!(!elements(&document, "configurations")[0].has_children());
    let order: Vec<_> = elements(&document, "pouInstance").iter().filter_map(|i| i.attribute("name")).collect();
    assert_eq!(order, ["P_Conditions", "P_Modes", "P_Run", "P_Outputs"]);
    // The list of globals is an object itself, so its name is none of theirs.
    assert_eq!(elements(&document, "globalVars")[0].attribute("name"), Some("GVL_1"));
}

/// Numbers ascend and are unique, and connections refer to what was there before.
fn assert_numbered(document: &Document, dialect: Dialect) {
    for body in document.descendants().filter(|n| matches!(n.tag_name().name(), "SFC" | "LD")) {
        let number = |n: &Node, a| n.attribute(a).map(|v| v.parse::<u64>().unwrap());
        let ids: Vec<u64> = body.children().filter_map(|n| number(&n, "localId")).collect();
        assert!(ids.windows(2).all(|w| w[0] < w[1]), "ascending");
        let mut all: Vec<u64> = body.descendants().filter_map(|n| number(&n, "localId")).collect();
        all.sort_unstable();
        assert!(all.windows(2).all(|w| w[0] < w[1]), "unique");
        if dialect == Dialect::Codesys {
            let own = all.iter().filter(|id| **id != 2_147_483_646).copied();
            assert!(own.enumerate().all(|(i, id)| i as u64 == id), "without gaps");
        }
        for element in body.children().filter(Node::is_element) {
            let id = number(&element, "localId").unwrap();
            for reference in element.descendants().filter_map(|n| number(&n, "refLocalId")) {
                assert!(reference < id && ids.contains(&reference));
            }
        }
    }
}

/// In Beremiz, the branches of a rung are all single contacts or all series; elsewhere no contact is
/// drawn that the rung does not have.
fn assert_shapes(project: &Project, document: &Document, dialect: Dialect) {
    let Body::Ladder(ladder) = &project.programs[0].body else { panic!("a ladder") };
    let drawn = read::bodies(document)[0].rungs();
    for (rung, (_, _, series)) in ladder.rungs.iter().zip(drawn) {
        match dialect {
            Dialect::Beremiz => assert!(series.iter().all(|s| s.len() <= 1) || series.iter().all(|s| s.len() > 1)),
            Dialect::Codesys if rung.condition.is_one() => assert_eq!(series, [Vec::<String>::new()]),
            Dialect::Codesys => {
                let products = rung.condition.products().iter().map(|p| p.literals().len());
                assert!(products.eq(series.iter().map(Vec::len)));
            }
        }
    }
}

/// Blocks are nested strictly and one jump ends the body.
fn assert_balanced(document: &Document) {
    for body in elements(document, "SFC") {
        let count = |name| body.children().filter(|c| c.tag_name().name() == name).count();
        assert_eq!(count("selectionDivergence"), count("selectionConvergence"));
        assert_eq!(body.last_element_child().unwrap().tag_name().name(), "jumpStep");
        let mut open = Vec::new();
        for element in body.children().filter(Node::is_element) {
            let ways = |name| element.children().filter(|c| c.tag_name().name() == name).count();
            match element.tag_name().name() {
                "selectionDivergence" => open.push(ways("connectionPointOut")),
                "selectionConvergence" => assert_eq!(open.pop(), Some(ways("connectionPointIn"))),
                _ => {}
            }
        }
    }
}

proptest! {
    #[test]
    fn any_sfc_means_itself(project in charts::sfc()) {
        for dialect in DIALECTS {
            let xml = emit(&project, dialect);
            assert_meaning(&project, &xml, dialect);
            let document = Document::parse(&xml).unwrap();
            assert_numbered(&document, dialect);
            match dialect {
                Dialect::Beremiz => assert!(elements(&document, "selectionConvergence").is_empty()),
                Dialect::Codesys => assert_balanced(&document),
            }
        }
    }

    #[test]
    fn any_ladder_means_itself(project in charts::ladder()) {
        for dialect in DIALECTS {
            let xml = emit(&project, dialect);
            assert_meaning(&project, &xml, dialect);
            let document = Document::parse(&xml).unwrap();
            assert_numbered(&document, dialect);
            assert_shapes(&project, &document, dialect);
        }
    }
}
