//! Programs as an engineer, an IDE or an attacker may have edited them, and what `prove` says of each.
//!
//! Many of these files do another thing than the chart although each scan of theirs, read kindly, is one of
//! its scans: a coil hangs on the address of another one, a variable is not what it was when power comes
//! back, one tool takes the first of two texts and the next the last. They are refused.

use crate::support::models;
use crate::support::proof::build;
use chartwright::emit::Dialect::{self, Beremiz, Codesys};
use chartwright::pipeline::{self, Judgement};

/// What is said of an edit.
enum Verdict {
    /// It changes nothing that is executed; says why.
    Proved(&'static str),
    /// A run shows the difference.
    Refuted,
    /// An error of this number that says this.
    Refused(&'static str, &'static str),
}
use Verdict::{Proved, Refused, Refuted};

/// One replacement: the first place, from a mark on, of a text that becomes another.
type Change = (&'static str, &'static str, &'static str);

/// What is done to the program of a model, and what comes of it.
type Edit = (&'static str, &'static str, Dialect, &'static [Change], Verdict);

const FILTER: &str = r#"<pou name="Filter""#;
const LAST: &str = r#"<pouInstance name="I_Filter" typeName="Filter"/>"#;
const CONTACT: &str = r#"<contact localId="3" height="16" width="20" negated="false""#;
const GUARD: &str = r#"<inVariable localId="7" height="24" width="52" negated="false""#;
const TEXT: &str = "<expression>Push</expression>";
const MORE: &str = "</globalVars>";
const NAME: &str = r#"<attribute guid="38391c6d-6d4a-42f8-8ee7-9f45e5adafa8">"#;
const INITIAL: &str = r#"<attribute guid="6844a48e-46c2-4cc8-a185-a478f3b99cc0">"#;

/// A program that writes WARN, and one with numbers; nothing runs them yet.
const EVIL: &str = r#"<pous><pou name="Evil" pouType="program"><interface><externalVars><variable name="WARN"><type><BOOL/></type></variable><variable name="Push"><type><BOOL/></type></variable></externalVars></interface><body><ST><xhtml:p>WARN := TRUE;</xhtml:p></ST></body></pou>"#;
const SUMS: &str = r#"<pous><pou name="Evil" pouType="program"><interface><localVars><variable name="U"><type><UDINT/></type></variable></localVars><externalVars><variable name="WARN"><type><BOOL/></type></variable></externalVars></interface><body><ST><xhtml:p>WARN := WARN OR (U - 1 &gt; 0);</xhtml:p></ST></body></pou>"#;
const TON: &str =
    r#"<pous><pou name="TON" pouType="functionBlock"><interface/><body><ST><xhtml:p>;</xhtml:p></ST></body></pou>"#;

const ADDRESSES: &[Edit] = &[
    (
        "outputs exchanged",
        "timer",
        Beremiz,
        &[("", "%QX0.0", "%Q"), ("", "%QX0.1", "%QX0.0"), ("", "%Q\"", "%QX0.1\"")],
        Refused("E802", "output LIGHT is at %QX0.0 in the model and at %QX0.1 in the program"),
    ),
    (
        "inputs exchanged",
        "timer",
        Codesys,
        &[("", "%IX0.0", "%I"), ("", "%IX0.1", "%IX0.0"), ("", "%I\"", "%IX0.1\"")],
        Refused("E802", "input Push is at %IX0.0 in the model and at %IX0.1 in the program"),
    ),
    ("an output nowhere", "timer", Beremiz, &[("", r#" address="%QX0.1""#, "")], Refused("E802", "and nowhere in")),
    ("an input nowhere", "timer", Codesys, &[("", r#" address="%IX0.0""#, "")], Refused("E802", "and nowhere in")),
    (
        "an input at an output",
        "timer",
        Beremiz,
        &[("", "%IX0.0", "%QX0.7")],
        Refused("E802", "is not that of an input"),
    ),
    ("another spelling", "timer", Beremiz, &[("", "%QX0.0", "%QX00.0")], Proved("it is the same bit")),
    ("small letters", "timer", Beremiz, &[("", "%QX0.0", "%qx0.0")], Refused("E602", "in small letters")),
    ("small letters in CODESYS", "timer", Codesys, &[("", "%QX0.0", "%qx0.0")], Proved("it is the same bit")),
    (
        "an address behind a variable without",
        "timer",
        Beremiz,
        &[("", "<globalVars>", r#"<globalVars><variable name="New"><type><BOOL/></type></variable>"#)],
        Refused("E602", "which stands behind `New`"),
    ),
    ("twice one bit", "timer", Beremiz, &[("", "%QX0.0", "%QX0.1")], Refused("E606", "both have the address")),
    (
        "a byte over all outputs",
        "timer",
        Codesys,
        &[("", MORE, r#"<variable name="All" address="%QB0"><type><SINT/></type></variable></globalVars>"#)],
        Refused("E802", "`All` at the address %QB0"),
    ),
    (
        "an output of another machine",
        "timer",
        Beremiz,
        &[(
            "",
            "<globalVars>",
            r#"<globalVars><variable name="More" address="%QX9.0"><type><BOOL/></type></variable>"#,
        )],
        Refused("E802", "`More` at the address %QX9.0"),
    ),
    (
        "addresses from the configuration",
        "timer",
        Beremiz,
        &[(
            "",
            "</configuration>",
            r#"<configVars><configVariable instancePathAndName="Res.I_Filter.A" address="%QX0.1"><type><BOOL/></type></configVariable></configVars></configuration>"#,
        )],
        Refused("E602", "configVars in `configuration`"),
    ),
];

const SCHEDULE: &[Edit] = &[
    (
        "slower",
        "timer",
        Beremiz,
        &[("", "T#10ms", "T#1s")],
        Refused("E802", "runs every 1000 ms, the model says 10 ms"),
    ),
    (
        "two settings of a task",
        "timer",
        Codesys,
        &[("", r#"Interval="t#10ms""#, r#"Interval="t#20ms""#)],
        Refused("E602", "vendor settings say something else"),
    ),
    (
        "no cycle at all",
        "timer",
        Codesys,
        &[("", r#"KindOfTask="Cyclic""#, r#"KindOfTask="Freewheeling""#)],
        Refused("E602", "vendor settings say something else"),
    ),
    (
        "nothing runs",
        "timer",
        Codesys,
        &[("", "<task ", "<!-- <task "), ("", "</task>", "</task> -->")],
        Refused("E802", "no task says"),
    ),
    (
        "two tasks of CODESYS",
        "timer",
        Codesys,
        &[(
            "",
            r#"<pouInstance name="Filter" typeName="">"#,
            r#"</task><task name="Two" interval="PT0.01S" priority="1"><pouInstance name="Filter" typeName="">"#,
        )],
        Refused("E602", "a second task with programs"),
    ),
    (
        "two tasks, one after the other",
        "timer",
        Beremiz,
        &[(
            "",
            LAST,
            r#"</task><task name="Two" interval="T#10ms" priority="0"><pouInstance name="I_Filter" typeName="Filter"/>"#,
        )],
        Proved("with one interval, programs run as they stand"),
    ),
    (
        "two tasks, the second one more urgent",
        "timer",
        Beremiz,
        &[
            ("", r#"priority="0""#, r#"priority="1""#),
            (
                "",
                LAST,
                r#"</task><task name="Two" interval="T#10ms" priority="0"><pouInstance name="I_Filter" typeName="Filter"/>"#,
            ),
        ],
        Refused("E602", "after one of lower priority"),
    ),
    (
        "a task that an event starts",
        "timer",
        Beremiz,
        &[("", "<task ", r#"<task single="Push" "#)],
        Refused("E602", "`single` = `Push` of task"),
    ),
    (
        "a time of XML Schema where IEC text is made of it",
        "timer",
        Beremiz,
        &[("", "T#10ms", "PT0.01S")],
        Refused("E605", "no interval of a task"),
    ),
    (
        "the time in vendor data alone",
        "timer",
        Codesys,
        &[
            ("", r#"interval="PT0.01S""#, r#"interval="PT0S""#),
            ("", r#"Interval="t#10ms" IntervalUnit="ms""#, r#"Interval="10000" IntervalUnit="us""#),
        ],
        Proved("so does TwinCAT"),
    ),
    (
        "another time in vendor data alone",
        "timer",
        Codesys,
        &[
            ("", r#"interval="PT0.01S""#, r#"interval="PT0S""#),
            ("", r#"Interval="t#10ms" IntervalUnit="ms""#, r#"Interval="10" IntervalUnit="us""#),
        ],
        Refused("E802", "runs every 0.01 ms"),
    ),
    (
        "no time at all",
        "timer",
        Codesys,
        &[
            ("", r#"interval="PT0.01S""#, r#"interval="PT0S""#),
            ("", "<TaskSettings ", "<!-- <TaskSettings "),
            ("", "</TaskSettings>", "</TaskSettings> -->"),
        ],
        Refused("E605", "no interval of a task"),
    ),
    ("no filter", "timer", Beremiz, &[("", LAST, "")], Refuted),
    (
        "a filter that only vendor data runs",
        "timer",
        Beremiz,
        &[
            ("", LAST, ""),
            (
                "",
                "</resource>",
                r#"<addData><data name="x" handleUnknown="discard"><resource name="Z"><task name="Two" interval="T#10ms" priority="0"><pouInstance name="I_Filter" typeName="Filter"/></task></resource></data></addData></resource>"#,
            ),
        ],
        Refuted,
    ),
    (
        "the filter twice",
        "timer",
        Beremiz,
        &[(
            "",
            LAST,
            r#"<pouInstance name="I_Filter" typeName="Filter"/><pouInstance name="I_Again" typeName="Filter"/>"#,
        )],
        Proved("it says the same twice"),
    ),
    (
        "charts in another order",
        "timer",
        Beremiz,
        &[
            ("", r#""I_Lit" typeName="Prg_Lit""#, "here"),
            ("", r#""I_StairLight" typeName="Prg_StairLight""#, r#""I_Lit" typeName="Prg_Lit""#),
            ("", "here", r#""I_StairLight" typeName="Prg_StairLight""#),
        ],
        Refuted,
    ),
    (
        "a second configuration",
        "timer",
        Beremiz,
        &[("", "</configuration>", r#"</configuration><configuration name="Two"/>"#)],
        Refused("E602", "a second configuration"),
    ),
    (
        "a second resource",
        "timer",
        Beremiz,
        &[("", "</resource>", r#"</resource><resource name="Two"/>"#)],
        Refused("E602", "a second resource"),
    ),
    (
        "another program writes an output after the filter",
        "timer",
        Beremiz,
        &[
            ("", "<pous>", EVIL),
            ("", LAST, r#"<pouInstance name="I_Filter" typeName="Filter"/><pouInstance name="I_E" typeName="Evil"/>"#),
        ],
        Refuted,
    ),
    (
        "another program writes an output before the filter",
        "timer",
        Beremiz,
        &[
            ("", "<pous>", EVIL),
            ("", LAST, r#"<pouInstance name="I_E" typeName="Evil"/><pouInstance name="I_Filter" typeName="Filter"/>"#),
        ],
        Proved("the filter writes it before anybody sees it"),
    ),
    (
        "a program writes an input",
        "timer",
        Beremiz,
        &[
            ("", "<pous>", EVIL),
            ("", "WARN := TRUE", "Push := TRUE"),
            ("", LAST, r#"<pouInstance name="I_Filter" typeName="Filter"/><pouInstance name="I_E" typeName="Evil"/>"#),
        ],
        Refuted,
    ),
];

const DECLARATIONS: &[Edit] = &[
    ("kept", "timer", Beremiz, &[("", "<globalVars>", r#"<globalVars retain="true">"#)], Refused("E602", "`retain`")),
    (
        "kept for good",
        "timer",
        Codesys,
        &[("", "<globalVars ", r#"<globalVars persistent="1" "#)],
        Refused("E602", "`persistent`"),
    ),
    (
        "an output that begins as TRUE",
        "timer",
        Beremiz,
        &[(
            r#"<variable name="LIGHT" address"#,
            "</type>",
            r#"</type><initialValue><simpleValue value="TRUE"/></initialValue>"#,
        )],
        Refused("E802", "output LIGHT is TRUE before the first scan"),
    ),
    (
        "an integer that begins beyond its type",
        "counter",
        Beremiz,
        &[(
            "<globalVars>",
            "<INT/>\n       </type>",
            r#"<INT/></type><initialValue><simpleValue value="65536"/></initialValue>"#,
        )],
        Refused("E605", "no initial value of this type"),
    ),
    (
        "constants",
        "timer",
        Codesys,
        &[("", "<globalVars ", r#"<globalVars constant="true" "#)],
        Refused("E602", "`constant` = `true` of globalVars"),
    ),
    (
        "constant externals",
        "timer",
        Beremiz,
        &[("", "<externalVars>", r#"<externalVars constant="true">"#)],
        Refused("E602", "`constant` = `true` of externalVars"),
    ),
    ("a TON of one's own", "timer", Beremiz, &[("", "<pous>", TON)], Refused("E602", "a `TON` other than")),
    (
        "an INT of one's own",
        "counter",
        Codesys,
        &[(
            "",
            "<dataTypes/>",
            r#"<dataTypes><dataType name="Int"><baseType><DINT/></baseType></dataType></dataTypes>"#,
        )],
        Refused("E602", "a `Int` other than"),
    ),
    (
        "a box of another type than its instance",
        "timer",
        Beremiz,
        &[("", r#"typeName="TON""#, r#"typeName="TOF""#)],
        Refused("E602", "not that of its declaration"),
    ),
    (
        "names in another case",
        "timer",
        Beremiz,
        &[(FILTER, "<variable>Cmd_LIGHT<", "<variable>CMD_light<")],
        Proved("names have no case"),
    ),
    (
        "one of two calls of a timer",
        "timer",
        Beremiz,
        &[("", "T#2500ms", "T#2501ms")],
        Refused("E802", "a timer with several times"),
    ),
    (
        "another spelling of a time",
        "timer",
        Beremiz,
        &[("", "T#500ms", "time#0s_500ms")],
        Proved("it is the same time"),
    ),
    (
        "sums as wide as the tool makes them",
        "timer",
        Beremiz,
        &[
            ("", "<pous>", SUMS),
            ("", LAST, r#"<pouInstance name="I_Filter" typeName="Filter"/><pouInstance name="I_E" typeName="Evil"/>"#),
        ],
        Refused("E602", "wider than INT"),
    ),
];

const DRAWINGS: &[Edit] = &[
    ("an edge", "timer", Beremiz, &[(FILTER, CONTACT, r#"<contact localId="3" edge="rising""#)], Refuted),
    (
        "negated=yes",
        "timer",
        Beremiz,
        &[(FILTER, r#"negated="false""#, r#"negated="yes""#)],
        Refused("E601", "`yes` is no value"),
    ),
    (
        "edge=Rising",
        "timer",
        Beremiz,
        &[(FILTER, CONTACT, r#"<contact localId="3" edge="Rising""#)],
        Refused("E601", "`Rising` is no value"),
    ),
    (
        "an edge of a value",
        "timer",
        Beremiz,
        &[("<SFC>", GUARD, r#"<inVariable localId="7" edge="rising""#)],
        Refused("E602", "`edge` = `rising` of inVariable"),
    ),
    (
        "a stored value",
        "timer",
        Codesys,
        &[("<SFC>", "<inVariable ", r#"<inVariable storage="set" "#)],
        Refused("E602", "`storage` = `set` of inVariable"),
    ),
    (
        "a stored output of a box",
        "counter",
        Codesys,
        &[("", r#"formalParameter="Out2""#, r#"formalParameter="Out2" storage="reset""#)],
        Refused("E602", "`storage` = `reset` of variable"),
    ),
    (
        "a negated number",
        "counter",
        Codesys,
        &[("", r#"formalParameter="Out2""#, r#"formalParameter="Out2" negated="true""#)],
        Refused("E602", "with negation or edge"),
    ),
    (
        "an edge of an operand",
        "counter",
        Beremiz,
        &[("", r#"formalParameter="IN2""#, r#"formalParameter="IN2" edge="falling""#)],
        Refused("E602", "with negation or edge"),
    ),
    (
        "a negated time",
        "timer",
        Beremiz,
        &[("", r#"formalParameter="PT""#, r#"formalParameter="PT" negated="true""#)],
        Refused("E602", "pin `PT`, of numbers, with negation"),
    ),
    (
        "a negated input of a timer",
        "timer",
        Beremiz,
        &[("", r#"formalParameter="IN""#, r#"formalParameter="IN" negated="true""#)],
        Refuted,
    ),
    (
        "a pin that another case makes another one",
        "timer",
        Beremiz,
        &[("", r#"formalParameter="IN""#, r#"formalParameter="In""#)],
        Refused("E602", "in capital letters"),
    ),
    (
        "a negated step",
        "timer",
        Codesys,
        &[("<SFC>", "<step ", r#"<step negated="true" "#)],
        Refused("E602", "`negated` = `true` of step"),
    ),
    (
        "a condition that is negated",
        "timer",
        Codesys,
        &[("<SFC>", "<condition>", r#"<condition negated="1">"#)],
        Refused("E602", "`negated` = `1` of condition"),
    ),
    (
        "a condition that is not negated",
        "timer",
        Codesys,
        &[("<SFC>", "<condition>", r#"<condition negated="0">"#)],
        Proved("that is what it is without"),
    ),
    (
        "a condition with two contents",
        "timer",
        Beremiz,
        &[("<SFC>", "<condition>", r#"<condition><inline name=""><ST><xhtml:p>TRUE</xhtml:p></ST></inline>"#)],
        Refused("E602", "both `inline` and `connectionPointIn` in one `condition`"),
    ),
    (
        "a variable of two types",
        "timer",
        Beremiz,
        &[("<globalVars>", "<BOOL/>", "<BOOL/><INT/>")],
        Refused("E602", "both `BOOL` and `INT` in one `type`"),
    ),
    (
        "an order of execution where there is none",
        "timer",
        Beremiz,
        &[(FILTER, "<coil ", r#"<coil executionOrderId="1" "#)],
        Refused("E602", "`executionOrderId` = `1` of coil"),
    ),
    (
        "an attribute that nobody knows",
        "timer",
        Beremiz,
        &[(FILTER, "<coil ", r#"<coil inverted="true" "#)],
        Refused("E602", "`inverted` = `true` of coil"),
    ),
    (
        "an element that nobody knows",
        "timer",
        Codesys,
        &[(FILTER, "<LD>", "<LD><invert/>")],
        Refused("E602", "invert in `LD`"),
    ),
    ("a text where elements are", "timer", Codesys, &[(FILTER, "<LD>", "<LD>NOT")], Refused("E602", "a text in LD")),
    (
        "what only describes",
        "timer",
        Codesys,
        &[
            (FILTER, "<coil ", r#"<coil height="1" width="2" globalId="g" "#),
            (
                FILTER,
                "</coil>",
                r#"<documentation><xhtml xmlns="http://www.w3.org/1999/xhtml">NOT</xhtml></documentation></coil>"#,
            ),
            ("", "<contentHeader ", r#"<contentHeader author="A" version="1" language="en" "#),
            ("", "<fileHeader ", r#"<fileHeader companyURL="u" productRelease="2" "#),
            (
                "",
                "<project ",
                r#"<project xmlns:i="http://www.w3.org/2001/XMLSchema-instance" i:schemaLocation="a b" "#,
            ),
        ],
        Proved("nobody executes it"),
    ),
    (
        "branches of unequal shape",
        "timer",
        Beremiz,
        &[(FILTER, r#"<connection refLocalId="1">"#, r#"<connection refLocalId="1"/><connection refLocalId="1">"#)],
        Refused("E602", "parallel branches of unequal shape"),
    ),
    (
        "two variables at a contact",
        "timer",
        Beremiz,
        &[(FILTER, "<variable>Cmd_LIGHT</variable>", "<variable>Cmd_LIGHT</variable><variable>Cmd_WARN</variable>")],
        Refused("E602", "a second `variable`"),
    ),
    (
        "two texts",
        "timer",
        Beremiz,
        &[("<SFC>", TEXT, "<expression>Push</expression><expression>TRUE</expression>")],
        Refused("E602", "a second `expression`"),
    ),
    (
        "a comment within a text",
        "timer",
        Beremiz,
        &[("<SFC>", TEXT, "<expression>Push<!-- --> OR FALSE</expression>")],
        Refused("E602", "a text in pieces"),
    ),
    (
        "another namespace",
        "timer",
        Beremiz,
        &[("<SFC>", TEXT, r#"<q:expression xmlns:q="urn:q">Push</q:expression>"#)],
        Refused("E602", "of another namespace"),
    ),
    (
        "an entity of XML",
        "timer",
        Beremiz,
        &[("<SFC>", TEXT, "<expression>&#80;ush</expression>")],
        Proved("it is a letter"),
    ),
    (
        "a CDATA section",
        "timer",
        Beremiz,
        &[("<SFC>", TEXT, "<expression><![CDATA[Push]]></expression>")],
        Proved("it is a text"),
    ),
    (
        "a comment",
        "timer",
        Beremiz,
        &[("<SFC>", TEXT, "<expression>Push (* or Hold *)</expression>")],
        Proved("comments are not executed"),
    ),
    (
        "a comment within a comment",
        "timer",
        Beremiz,
        &[("<SFC>", TEXT, "<expression>Push (* (* *) OR Push (* *)</expression>")],
        Refused("E605", "a comment stands within a comment"),
    ),
    (
        "words that mean nothing",
        "timer",
        Beremiz,
        &[("<SFC>", TEXT, "<expression>Push AND_THEN Push</expression>")],
        Refused("E605", "AND_THEN"),
    ),
    (
        "more than needed",
        "timer",
        Beremiz,
        &[("<SFC>", TEXT, "<expression>NOT NOT Push = BOOL#1</expression>")],
        Proved("NOT binds first"),
    ),
    (
        "two bodies",
        "timer",
        Beremiz,
        &[(FILTER, "</body>", "</body><body><ST><xhtml:p>;</xhtml:p></ST></body>")],
        Refused("E602", "a second `body`"),
    ),
    (
        "a body in two languages",
        "timer",
        Beremiz,
        &[(FILTER, "</LD>", "</LD><ST><xhtml:p>;</xhtml:p></ST>")],
        Refused("E602", "both `LD` and `ST` in one `body`"),
    ),
    (
        "zeros before a number",
        "timer",
        Beremiz,
        &[(FILTER, r#"refLocalId="3""#, r#"refLocalId="03""#)],
        Proved("it is the same number"),
    ),
    (
        "one number in two spellings",
        "timer",
        Beremiz,
        &[(FILTER, r#"localId="2""#, r#"localId="03""#)],
        Refused("E606", "have the number"),
    ),
    (
        "a rung drawn below the next one",
        "timer",
        Beremiz,
        &[(FILTER, r#"<position x="196" y="88"/>"#, r#"<position x="196" y="888"/>"#)],
        Refused("E602", "stands above one that comes before it"),
    ),
    (
        "fed by nothing",
        "timer",
        Beremiz,
        &[(FILTER, r#"refLocalId="3""#, r#"refLocalId="77""#)],
        Refused("E604", "element 77"),
    ),
];

const CHARTS: &[Edit] = &[
    ("no priority", "timer", Beremiz, &[("S_Lit_On", r#" priority="1""#, "")], Proved("conditions exclude each other")),
    (
        "priorities against the order from left to right",
        "timer",
        Codesys,
        &[
            ("Prg_Lit", "<transition ", r#"<transition name="a" "#),
            ("Prg_Lit", "<transition localId", r#"<transition priority="2" localId"#),
            ("priority=\"2\"", "<transition localId", r#"<transition priority="1" localId"#),
            ("priority=\"1\"", "<transition localId", r#"<transition priority="0" localId"#),
        ],
        Refused("E602", "contradicts the order from left to right"),
    ),
    (
        "two initial steps",
        "timer",
        Beremiz,
        &[("<SFC>", r#"name="S_Dark""#, r#"name="S_Dark" initialStep="true""#)],
        Refuted,
    ),
    ("a pulse", "timer", Beremiz, &[("<SFC>", r#"qualifier="N""#, r#"qualifier="P1""#)], Refuted),
    ("stored", "timer", Beremiz, &[("<SFC>", r#"qualifier="N""#, r#"qualifier="S""#)], Refuted),
    (
        "a step of another name",
        "timer",
        Beremiz,
        &[("<SFC>", r#"name="S_Dark""#, r#"name="S_Dusk""#), ("", r#"targetName="S_Dark""#, r#"targetName="S_Dusk""#)],
        Refused("E802", "no step `Prg_StairLight.S_Dark` that is reached"),
    ),
    (
        "a time for what has none",
        "timer",
        Beremiz,
        &[("<SFC>", r#"qualifier="N""#, r#"qualifier="N" duration="T#1s""#)],
        Refused("E602", "the duration `T#1s` of an action without time"),
    ),
    (
        "an indicator",
        "timer",
        Codesys,
        &[("<SFC>", r#"indicator="""#, r#"indicator="LIGHT""#)],
        Refused("E602", "`indicator` = `LIGHT`"),
    ),
    (
        "a line from where the actions are",
        "timer",
        Codesys,
        &[("<transition ", r#"formalParameter="sfc""#, r#"formalParameter="x""#)],
        Refused("E602", "a line from output `x` of step"),
    ),
    (
        "a time",
        "timer",
        Beremiz,
        &[("<SFC>", r#"qualifier="N""#, r#"qualifier="L" duration="T#1s""#)],
        Refused("E802", "an action with a duration"),
    ),
    (
        "a pulse in CODESYS",
        "timer",
        Codesys,
        &[("<SFC>", r#"qualifier="N""#, r#"qualifier="P""#)],
        Refused("E602", "which CODESYS runs otherwise"),
    ),
    (
        "a jump elsewhere",
        "timer",
        Beremiz,
        &[("<SFC>", r#"targetName="S_Dark""#, r#"targetName="S_Lit_On""#)],
        Refused("E604", "which is no step"),
    ),
    (
        "a vendor's name that says something else",
        "timer",
        Codesys,
        &[(
            "<SFC>",
            r#"<attribute guid="38391c6d-6d4a-42f8-8ee7-9f45e5adafa8">Push<"#,
            r#"<attribute guid="38391c6d-6d4a-42f8-8ee7-9f45e5adafa8">Hold<"#,
        )],
        Refused("E602", "`Hold`, which contradicts transition"),
    ),
    (
        "a vendor's initial step",
        "timer",
        Codesys,
        &[(INITIAL, "TRUE", "FALSE")],
        Refused("E602", "`FALSE`, which contradicts step"),
    ),
    (
        "a vendor attribute that nobody knows",
        "timer",
        Codesys,
        &[(
            NAME,
            NAME,
            r#"<attribute guid="00000000-0000-0000-0000-000000000000">1</attribute><attribute guid="38391c6d-6d4a-42f8-8ee7-9f45e5adafa8">"#,
        )],
        Refused("E602", "the vendor attribute `00000000"),
    ),
    (
        "left out of the build",
        "timer",
        Codesys,
        &[(
            FILTER,
            "</body>",
            r#"</body><addData><data name="http://www.3s-software.com/plcopenxml/buildproperties" handleUnknown="implementation"><BuildProperties xmlns=""/></data></addData>"#,
        )],
        Refused("E602", "the vendor data"),
    ),
];

/// The program with the changes, each of which must have something to change.
fn edited(program: &str, what: &str, changes: &[Change]) -> String {
    changes.iter().fold(program.to_owned(), |text, (mark, from, to)| {
        let start = text.find(mark).unwrap_or_else(|| panic!("{what}: there is no `{mark}`"));
        assert!(text[start..].contains(from), "{what}: there is no `{from}`");
        format!("{}{}", &text[..start], text[start..].replacen(from, to, 1))
    })
}

fn examine(edits: &[Edit]) {
    let mut wrong = Vec::new();
    for (what, model, dialect, changes, expected) in edits {
        let source = models::all().into_iter().find(|m| m.name == *model).expect("the model is there").source;
        let output = build(&source, *dialect).unwrap_or_else(|e| panic!("{e}"));
        let (judgement, about_model, about_program) = pipeline::prove(&source, &edited(&output.xml, what, changes));
        let errors: Vec<String> = about_model
            .iter()
            .chain(about_program.iter())
            .filter(|d| d.code.number().starts_with('E'))
            .map(|d| format!("{} {}", d.code.number(), d.message))
            .collect();
        let fits = match (expected, &judgement) {
            (Proved(_), Judgement::Proved(_)) | (Refuted, Judgement::Refuted(_)) => true,
            (Refused(code, part), Judgement::Undecided) => {
                errors.iter().any(|e| e.starts_with(code) && e.contains(part))
            }
            (Proved(_) | Refuted | Refused(..), _) => false,
        };
        let verdict = if matches!(judgement, Judgement::Proved(_)) { "proved".to_owned() } else { errors.join("; ") };
        let reason = if let Proved(why) = expected { format!(" (since {why})") } else { String::new() };
        println!("{what} ({model}, {dialect:?}): {verdict}{reason}");
        if !fits {
            wrong.push(format!("{what}: {verdict}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn outputs_and_inputs_stay_where_they_are() {
    examine(ADDRESSES);
}

#[test]
fn programs_run_as_often_and_in_the_order_that_was_proved() {
    examine(SCHEDULE);
}

#[test]
fn declarations_say_what_every_tool_reads_in_them() {
    examine(DECLARATIONS);
}

#[test]
fn drawings_say_what_every_tool_reads_in_them() {
    examine(DRAWINGS);
}

#[test]
fn charts_say_what_every_tool_reads_in_them() {
    examine(CHARTS);
}
