//! PLCopen XML with one thing changed by a rule: an attribute, an element, a line, a text, an order.

use super::rng::Rng;
use super::xml_edit::{exchanged, replaced, with_attribute, with_child, without_attribute};
use roxmltree::{Document, Node};

/// A changed file.
pub struct Mutant {
    pub xml: String,
    pub what: String,
    /// Which of [`RULES`] made it.
    pub rule: usize,
    /// The attribute that was set, if one was.
    pub set: Option<&'static str>,
    /// Whether a reader that makes of it what it made before has passed something over.
    pub means: bool,
}

const FLAG: &[&str] = &["true", "1", "false", "0"];
const NUMBER: &[&str] = &["0", "1", "2", "77"];
const WORD: &[&str] = &["", "X", "TRUE", "T#1s"];

/// All attributes of the schema, and values for them.
pub const ATTRIBUTES: &[(&str, &[&str])] = &[
    ("WorksheetName", WORD),
    ("address", &["%IX0.0", "%QX0.0", "%QX7.7", "%ix0.0", ""]),
    ("alias", WORD),
    ("author", WORD),
    ("companyName", WORD),
    ("companyURL", WORD),
    ("constant", FLAG),
    ("contentDescription", WORD),
    ("creationDateTime", WORD),
    ("direction", &["readOnly", "readWrite"]),
    ("duration", &["", "T#0s", "T#1s"]),
    ("edge", &["none", "rising", "falling"]),
    ("edgeIn", &["none", "rising", "falling"]),
    ("edgeOut", &["none", "rising", "falling"]),
    ("executionOrderId", NUMBER),
    ("formalParameter", &["", "Q", "IN", "PT", "ET", "IN1", "IN2", "Out2", "sfc", "x", "EN"]),
    ("globalId", WORD),
    ("handleUnknown", &["preserve", "discard", "implementation"]),
    ("height", NUMBER),
    ("hidden", FLAG),
    ("indicator", WORD),
    ("initialStep", FLAG),
    ("instanceName", WORD),
    ("instancePathAndName", WORD),
    ("interval", &["T#10ms", "T#20ms", "PT0.01S", "PT0S", "10ms", ""]),
    ("label", WORD),
    ("language", &["en", "de"]),
    ("length", NUMBER),
    ("localId", NUMBER),
    ("lower", NUMBER),
    ("member", WORD),
    ("modificationDateTime", WORD),
    ("name", WORD),
    ("negated", FLAG),
    ("negatedIn", FLAG),
    ("negatedOut", FLAG),
    ("nonpersistent", FLAG),
    ("nonretain", FLAG),
    ("organization", WORD),
    ("persistent", FLAG),
    ("pouType", &["function", "functionBlock", "program"]),
    ("priority", NUMBER),
    ("productName", WORD),
    ("productRelease", WORD),
    ("productVersion", WORD),
    ("qualifier", &["N", "R", "S", "L", "D", "P", "P0", "P1", "SD", "DS", "SL", "DL"]),
    ("refLocalId", NUMBER),
    ("repetitionValue", NUMBER),
    ("retain", FLAG),
    ("single", WORD),
    ("storage", &["none", "set", "reset"]),
    ("storageIn", &["none", "set", "reset"]),
    ("storageOut", &["none", "set", "reset"]),
    ("targetName", WORD),
    ("typeName", &["TON", "TOF", "TP", "ADD", "SUB", "GT", "GE", "LT", "EQ", "NE", "SEL", "LIMIT", "MOVE"]),
    ("upper", NUMBER),
    ("value", &["TRUE", "FALSE", "0", "1", "32767", "T#1s"]),
    ("vendor", WORD),
    ("version", NUMBER),
    ("width", NUMBER),
    ("x", NUMBER),
    ("y", NUMBER),
];

/// What is done to a file.
pub const RULES: [&str; 11] = [
    "an attribute is set",
    "an attribute is set that means something",
    "an attribute is left out",
    "an attribute has the value of another one",
    "an element is left out",
    "an element stands twice",
    "two elements change places",
    "an element becomes another one",
    "there is one more line",
    "a text becomes another one",
    "there is one more element",
];

/// Attributes of which each value but these says something at each of these elements.
pub const MEANING: [&str; 9] =
    ["constant", "edge", "initialStep", "negated", "nonpersistent", "nonretain", "persistent", "retain", "storage"];
const MEANT: [&str; 9] =
    ["coil", "condition", "contact", "externalVars", "globalVars", "inVariable", "localVars", "outVariable", "step"];

/// Elements of a body, as short as they can be.
const ELEMENTS: [&str; 22] = [
    r#"<contact localId="9901"><position x="0" y="0"/><connectionPointIn/><connectionPointOut/><variable>TRUE</variable></contact>"#,
    r#"<coil localId="9902"><position x="0" y="0"/><variable>X</variable></coil>"#,
    r#"<inVariable localId="9903"><position x="0" y="0"/><expression>TRUE</expression></inVariable>"#,
    r#"<outVariable localId="9904"><position x="0" y="0"/><expression>X</expression></outVariable>"#,
    r#"<inOutVariable localId="9905"><position x="0" y="0"/><expression>X</expression></inOutVariable>"#,
    r#"<label localId="9906" label="L"><position x="0" y="0"/></label>"#,
    r#"<jump localId="9907" label="L"><position x="0" y="0"/></jump>"#,
    r#"<return localId="9908"><position x="0" y="0"/></return>"#,
    r#"<connector localId="9909" name="C"><position x="0" y="0"/></connector>"#,
    r#"<continuation localId="9910" name="C"><position x="0" y="0"/></continuation>"#,
    r#"<macroStep localId="9911"><position x="0" y="0"/></macroStep>"#,
    r#"<step localId="9912" name="New" initialStep="true"><position x="0" y="0"/></step>"#,
    r#"<transition localId="9913"><position x="0" y="0"/></transition>"#,
    r#"<jumpStep localId="9914" targetName="New"><position x="0" y="0"/></jumpStep>"#,
    r#"<actionBlock localId="9915"><position x="0" y="0"/></actionBlock>"#,
    r#"<documentation><xhtml xmlns="http://www.w3.org/1999/xhtml">words</xhtml></documentation>"#,
    r#"<addData><data name="urn:other" handleUnknown="discard"><x xmlns=""/></data></addData>"#,
    r#"<connectionPointIn><connection refLocalId="1"/></connectionPointIn>"#,
    r#"<expression>FALSE</expression>"#,
    r#"<inline name=""><ST><p>TRUE</p></ST></inline>"#,
    r#"<reference name="TRUE"/>"#,
    r#"<initialValue><simpleValue value="TRUE"/></initialValue>"#,
];

/// Changes one thing, if what chance chooses fits; `more` are elements that may be put in besides those of bodies.
pub fn mutant(xml: &str, more: &[String], rng: &mut Rng) -> Option<Mutant> {
    let document = Document::parse(xml).expect("the compiler writes XML");
    let nodes: Vec<Node<'_, '_>> = document.descendants().filter(|n| n.is_element() && !words(*n)).collect();
    // Most elements say where something is drawn.
    let mut node = *rng.pick(&nodes);
    while matches!(node.tag_name().name(), "position" | "relPosition" | "scaling") && rng.below(10) > 0 {
        node = *rng.pick(&nodes);
    }
    let about = describe(node);
    let parent = node.parent().filter(Node::is_element);
    let alike = |wanted: &dyn Fn(&Node<'_, '_>) -> bool| {
        let same = |n: &&Node<'_, '_>| n.tag_name().name() == node.tag_name().name() && **n != node && wanted(n);
        nodes.iter().filter(same).copied().collect::<Vec<_>>()
    };
    let chance = rng.below(17);
    let rule = [0, 0, 0, 0, 1, 1, 2, 3, 3, 4, 5, 6, 7, 8, 9, 10, 10][chance];
    let plain = |xml: String, what: String| Some(Mutant { xml, what, rule, set: None, means: false });
    match chance {
        0..4 => {
            let (name, values) = *rng.pick(ATTRIBUTES);
            attribute(xml, node, name, rng.pick::<&str>(values), rule)
        }
        // One that may stand there says more.
        4..6 => {
            let meaning: Vec<_> = ATTRIBUTES.iter().copied().filter(|(n, _)| MEANING.contains(n)).collect();
            let (name, values) = *rng.pick(&meaning);
            attribute(xml, node, name, rng.pick::<&str>(values), rule)
        }
        6 => {
            let own: Vec<_> = node.attributes().map(|a| a.name().to_owned()).collect();
            let name = own.get(rng.below(own.len().max(1)))?;
            plain(without_attribute(xml, node, name), format!("{about} has no {name}"))
        }
        7 | 8 => {
            let own: Vec<_> = node.attributes().map(|a| a.name().to_owned()).collect();
            let name = own.get(rng.below(own.len().max(1)))?;
            let others =
                alike(&|n| n.attribute(name.as_str()).is_some_and(|v| Some(v) != node.attribute(name.as_str())));
            let value = others.get(rng.below(others.len().max(1)))?.attribute(name.as_str())?;
            plain(with_attribute(xml, node, name, value), format!("{about}: {name} becomes {value}"))
        }
        9 => {
            parent?;
            plain(replaced(xml, node, ""), format!("{about} is left out"))
        }
        10 => {
            parent?;
            let twice = xml[node.range()].repeat(2);
            plain(replaced(xml, node, &twice), format!("{about} stands twice"))
        }
        11 => {
            let others = alike(&|n| n.parent() == node.parent());
            let other = *others.get(rng.below(others.len().max(1)))?;
            plain(exchanged(xml, node, other), format!("{about} and {} change places", describe(other)))
        }
        12 => {
            let others = alike(&|n| xml[n.range()] != xml[node.range()] && !n.ancestors().any(|a| a == node));
            let other = *others.get(rng.below(others.len().max(1)))?;
            plain(replaced(xml, node, &xml[other.range()]), format!("{about} becomes {}", describe(other)))
        }
        13 => {
            let lines = nodes.iter().filter(|n| n.tag_name().name() == "connection").copied().collect::<Vec<_>>();
            let line = *lines.get(rng.below(lines.len().max(1)))?;
            let more = format!(r#"<connection refLocalId="{}"><position x="0" y="0"/></connection>"#, rng.below(30));
            let text = with_child(xml, line.parent()?, &more, rng.below(2) == 0);
            plain(text, format!("{} gets one more line: {more}", describe(line.parent()?.parent()?)))
        }
        14 => {
            let texts: Vec<_> = nodes.iter().filter(|n| n.children().count() == 1 && n.text().is_some()).collect();
            let (one, two) = (**rng.pick(&texts), **rng.pick(&texts));
            let inner = one.first_child()?.range();
            let text = match rng.below(3) {
                0 => format!("NOT {}", one.text()?),
                1 => two.text()?.to_owned(),
                _ => ["TRUE", "FALSE", "0", "1", "", "T#1ms", "???"][rng.below(7)].to_owned(),
            };
            let shown = text.replace('&', "&amp;").replace('<', "&lt;");
            let changed = format!("{}{shown}{}", &xml[..inner.start], &xml[inner.end..]);
            plain(changed, format!("the text {:?} of {} becomes {text:?}", one.text()?, describe(one)))
        }
        _ => {
            let number = rng.below(ELEMENTS.len() + more.len());
            let more = ELEMENTS.get(number).copied().unwrap_or_else(|| more[number - ELEMENTS.len()].as_str());
            let text = with_child(xml, node, more, rng.below(2) == 0);
            plain(text, format!("{about} holds {more} as well"))
        }
    }
}

fn attribute(xml: &str, node: Node<'_, '_>, name: &'static str, value: &str, rule: usize) -> Option<Mutant> {
    let element = node.tag_name().name();
    let old = node.attribute(name);
    let says_nothing = |v: &str| matches!(v, "" | "none" | "false" | "0");
    let same = old == Some(value) || (says_nothing(value) && old.is_none_or(says_nothing));
    let yes = |v: &str| matches!(v, "true" | "1");
    let same = same || (yes(value) && old.is_some_and(yes));
    let means = !same && MEANING.contains(&name) && MEANT.contains(&element);
    let xml = with_attribute(xml, node, name, value);
    Some(Mutant { xml, what: format!("{}: {name} is {value:?}", describe(node)), rule, set: Some(name), means })
}

/// Whether an element only holds words for people.
fn words(node: Node<'_, '_>) -> bool {
    node.ancestors().any(|n| matches!(n.tag_name().name(), "documentation" | "content" | "alternativeText"))
}

fn describe(node: Node<'_, '_>) -> String {
    let pou = node.ancestors().find(|n| n.tag_name().name() == "pou").and_then(|n| n.attribute("name"));
    let own = ["name", "localId", "formalParameter", "refLocalId"].iter().find_map(|a| node.attribute(*a));
    format!("{} {} in {}", node.tag_name().name(), own.unwrap_or(""), pou.unwrap_or("the file"))
}
