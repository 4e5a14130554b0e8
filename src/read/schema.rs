//! What each element of PLCopen TC6 may hold, and what this reader makes of it: one table.
//!
//! A file is asked against it in one pass ([`shape`](super::shape)), before anything is read. Whatever the
//! table does not name at a place is refused, be it in the official schema or not: so nothing that could
//! mean something is passed over.
//!
//! Each line has an element, the elements in which it stands, its attributes, and the elements within it.
//!
//! - a name alone is interpreted, or looked at and refused, by the module that reads the element;
//! - `name=a,b` may have these values only: the others would mean something that is not interpreted;
//! - `name~` describes: where a thing is drawn, who made it, what people say of it. Nobody looks into it;
//! - `name*` may repeat, everything else stands once;
//! - `a/b` are a choice: one of them stands there;
//! - `addData` is looked at by [`vendor`](super::vendor);
//! - `text` is one piece of text, `markup` a text within elements that format it;
//! - `@beremiz` or `@codesys` behind an element: so in files of that family.

use super::xml::Family;
use std::collections::BTreeMap;

const TABLE: &str = "
# the project
project        | -                            |                                             | fileHeader~ contentHeader types instances addData documentation~
contentHeader  | project                      | name version~ modificationDateTime~ organization~ author~ language~ | Comment~ coordinateInfo~ addDataInfo~ addData
types          | project                      |                                             | dataTypes pous
dataTypes      | types                        |                                             | dataType*
dataType       | dataTypes                    | name                                        | baseType~ initialValue~ addData documentation~
pous           | types                        |                                             | pou*
instances      | project                      |                                             | configurations
configurations | instances                    |                                             | configuration*
configuration  | configurations               | name~ globalId~                             | resource* globalVars* addData documentation~
resource       | configuration data           | name~ globalId~                             | task* globalVars* pouInstance* addData documentation~
task           | resource                     | name interval priority globalId~            | pouInstance* addData documentation~
pouInstance    | task resource                | name typeName globalId~                     | addData documentation~

# programs and declarations; lists that share an attribute differ from what is declared when power comes back, or cannot be written
pou            | pous data                    | name pouType globalId~                      | interface actions transitions body addData documentation~
interface      | pou                          |                                             | localVars* inputVars* outputVars* externalVars* addData documentation~
globalVars     | configuration resource data  | name constant=false retain=false nonretain=false persistent=false nonpersistent=false | variable* addData documentation~
localVars      | interface                    | name~ constant=false retain=false nonretain=false persistent=false nonpersistent=false | variable* addData documentation~
inputVars      | interface                    | name~ constant=false retain=false nonretain=false persistent=false nonpersistent=false | variable* addData documentation~
outputVars     | interface                    | name~ constant=false retain=false nonretain=false persistent=false nonpersistent=false | variable* addData documentation~
externalVars   | interface                    | name~ constant=false retain=false nonretain=false persistent=false nonpersistent=false | variable* addData documentation~
variable       | globalVars localVars inputVars outputVars externalVars | name address globalId~ | type initialValue addData documentation~
type           | variable                     |                                             | BOOL/BYTE~/WORD~/DWORD~/LWORD~/SINT/INT/DINT/LINT/USINT/UINT/UDINT/ULINT/REAL~/LREAL~/TIME/DATE~/DT~/TOD~/string~/wstring~/ANY~/ANY_DERIVED~/ANY_ELEMENTARY~/ANY_MAGNITUDE~/ANY_NUM~/ANY_REAL~/ANY_INT~/ANY_BIT~/ANY_STRING~/ANY_DATE~/array~/derived/enum~/struct~/subrangeSigned~/subrangeUnsigned~/pointer~
BOOL           | type                         |                                             |
SINT           | type                         |                                             |
INT            | type                         |                                             |
DINT           | type                         |                                             |
LINT           | type                         |                                             |
USINT          | type                         |                                             |
UINT           | type                         |                                             |
UDINT          | type                         |                                             |
ULINT          | type                         |                                             |
TIME           | type                         |                                             |
derived        | type                         | name                                        | addData
initialValue   | variable                     |                                             | simpleValue/arrayValue~/structValue~
simpleValue    | initialValue                 | value                                       |

# bodies
actions        | pou                          |                                             | action*
action         | actions                      | name globalId~                              | body addData documentation~
transitions    | pou                          |                                             | transition*
transition     | transitions                  | name globalId~                              | body addData documentation~
body           | pou action transition        | WorksheetName~ globalId~                    | ST/LD/SFC/IL~/FBD~ addData documentation~
inline         | action                       | WorksheetName~ globalId~                    | ST/LD/SFC~/IL~/FBD~ addData documentation~
inline         | condition                    | name~ WorksheetName~ globalId~              | ST/LD~/SFC~/IL~/FBD~ addData documentation~
ST             | body inline                  |                                             | markup
LD             | body inline                  |                                             | leftPowerRail* rightPowerRail* contact* coil* block* inVariable* outVariable* comment* vendorElement*
SFC            | body                         |                                             | step* transition* jumpStep* actionBlock* selectionDivergence* selectionConvergence* simultaneousDivergence* simultaneousConvergence* inVariable* contact* block* leftPowerRail* rightPowerRail* comment*

# ladder
leftPowerRail  | LD SFC                       | localId executionOrderId=0 height~ width~ globalId~ | position~ connectionPointOut* addData documentation~
rightPowerRail | LD SFC                       | localId executionOrderId=0 height~ width~ globalId~ | position~ connectionPointIn* addData documentation~
contact        | LD SFC                       | localId negated edge storage=none executionOrderId=0 height~ width~ globalId~ | position~ connectionPointIn connectionPointOut variable addData documentation~
coil           | LD                           | localId negated edge storage executionOrderId=0 height~ width~ globalId~ | position connectionPointIn connectionPointOut variable addData documentation~
variable       | contact coil                 |                                             | text
inVariable     | LD SFC                       | localId negated=false edge=none storage=none executionOrderId=0 height~ width~ globalId~ | position~ connectionPointOut expression addData documentation~
outVariable@beremiz | LD                      | localId executionOrderId negated=false edge=none storage=none height~ width~ globalId~ | position connectionPointIn expression addData documentation~
outVariable@codesys | LD                      | localId executionOrderId=0 negated=false edge=none storage=none height~ width~ globalId~ | position connectionPointIn expression addData documentation~
expression     | inVariable outVariable       |                                             | text
expression@codesys | connectionPointIn connectionPointOut |                                 | text
comment        | LD SFC                       | localId height~ width~ globalId~            | position~ content~ addData documentation~
vendorElement  | LD                           | localId executionOrderId=0 height~ width~ globalId~ | position~ alternativeText~ addData

# boxes
block@beremiz  | LD                           | localId typeName instanceName executionOrderId height~ width~ globalId~ | position inputVariables inOutVariables outputVariables addData documentation~
block@beremiz  | SFC                          | localId typeName instanceName executionOrderId=0 height~ width~ globalId~ | position inputVariables inOutVariables outputVariables addData documentation~
block@codesys  | LD SFC                       | localId typeName instanceName executionOrderId=0 height~ width~ globalId~ | position inputVariables inOutVariables outputVariables addData documentation~
inputVariables | block                        |                                             | variable*
inOutVariables | block                        |                                             |
outputVariables | block                       |                                             | variable*
variable       | inputVariables               | formalParameter negated edge storage=none hidden~ | connectionPointIn documentation~
variable       | outputVariables              | formalParameter negated edge storage=none hidden~ | connectionPointOut documentation~

# charts
step           | SFC                          | localId name initialStep negated=false executionOrderId=0 height~ width~ globalId~ | position~ connectionPointIn connectionPointOut connectionPointOutAction addData documentation~
transition     | SFC                          | localId priority executionOrderId=0 height~ width~ globalId~ | position~ connectionPointIn connectionPointOut condition addData documentation~
condition      | transition                   | negated=false                               | reference/connectionPointIn/inline
jumpStep       | SFC                          | localId targetName executionOrderId=0 height~ width~ globalId~ | position~ connectionPointIn addData documentation~
selectionDivergence | SFC                     | localId height~ width~ globalId~            | position~ connectionPointIn connectionPointOut* addData documentation~
selectionConvergence | SFC                    | localId height~ width~ globalId~            | position~ connectionPointIn* connectionPointOut addData documentation~
simultaneousDivergence | SFC                  | localId name~ height~ width~ globalId~      | position~ connectionPointIn connectionPointOut* addData documentation~
simultaneousConvergence | SFC                 | localId height~ width~ globalId~            | position~ connectionPointIn* connectionPointOut addData documentation~
actionBlock    | SFC                          | localId negated=false executionOrderId=0 height~ width~ globalId~ | position~ connectionPointIn action* addData documentation~
action         | actionBlock                  | localId qualifier duration indicator= executionOrderId=0 height~ width~ globalId~ | relPosition~ reference/inline connectionPointOut addData documentation~
reference      | action condition             | name                                        |

# lines; a text in place of lines, and a variable behind an output, are drawn by CODESYS and its kin alone
position       | coil outVariable block connection | x y                                    |
relPosition    | connectionPointIn connectionPointOut connectionPointOutAction | x y        |
connectionPointIn | contact coil outVariable rightPowerRail step transition condition jumpStep selectionDivergence selectionConvergence simultaneousDivergence simultaneousConvergence actionBlock | globalId~ | relPosition connection* addData
connectionPointIn@beremiz | variable          | globalId~                                   | relPosition connection* addData
connectionPointIn@codesys | variable          | globalId~                                   | relPosition connection*/expression addData
connectionPointOut | leftPowerRail step selectionDivergence simultaneousDivergence | formalParameter globalId~ | relPosition addData
connectionPointOut | contact coil inVariable transition selectionConvergence simultaneousConvergence action | globalId~ | relPosition addData
connectionPointOut@beremiz | variable         | globalId~                                   | relPosition addData
connectionPointOut@codesys | variable         | globalId~                                   | relPosition expression addData
connectionPointOutAction | step               | formalParameter globalId~                   | relPosition addData
connection     | connectionPointIn            | refLocalId formalParameter globalId~        | position* addData
";

/// What an attribute or an element within another one is to the reader.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Use {
    /// It is interpreted where the element is read; an element has a row of its own.
    Interpreted,
    /// An attribute that may have only these values.
    Only(Vec<&'static str>),
    /// It only describes.
    Describes,
}

/// A name within an element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// What it is good for.
    pub good_for: Use,
    /// Whether it may stand there several times.
    pub repeats: bool,
    /// Of those with the same number one stands there.
    pub choice: Option<usize>,
}

/// What holds what an element says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Content {
    /// Elements.
    #[default]
    Elements,
    /// One piece of text.
    Text,
    /// One piece of text, within elements that format it.
    Markup,
}

/// One line of the table.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// Its attributes.
    pub attributes: BTreeMap<&'static str, Use>,
    /// The elements within it.
    pub elements: BTreeMap<&'static str, Entry>,
    /// What it holds.
    pub content: Content,
}

/// The table for one family.
pub struct Table {
    /// By element, then by what it stands in.
    rows: BTreeMap<&'static str, BTreeMap<&'static str, Row>>,
}

impl Table {
    /// The lines that hold for that family.
    pub fn of(family: Family) -> Table {
        let mut rows: BTreeMap<_, BTreeMap<_, _>> = BTreeMap::new();
        for (element, parent, row) in lines(family) {
            rows.entry(element).or_default().insert(parent, row);
        }
        Table { rows }
    }

    /// What an element may hold that stands directly within `parent`; `-` for the root.
    pub fn row(&self, parent: &str, element: &str) -> Option<&Row> {
        self.rows.get(element)?.get(parent)
    }
}

/// The lines that hold for a family: each element, one that it stands in, and what it may hold there.
fn lines(family: Family) -> Vec<(&'static str, &'static str, Row)> {
    let mut found = Vec::new();
    for line in TABLE.lines().filter(|l| l.contains('|')) {
        let mut columns = line.split('|').map(str::trim);
        let mut next = || columns.next().unwrap_or_default();
        let (element, parents, attributes, elements) = (next(), next(), next(), next());
        let (element, only) = element.split_once('@').unwrap_or((element, ""));
        let holds = match only {
            "beremiz" => family == Family::Beremiz,
            "codesys" => family == Family::Codesys,
            _ => true,
        };
        if holds {
            let row = row(attributes, elements);
            found.extend(parents.split_whitespace().map(|parent| (element, parent, row.clone())));
        }
    }
    found
}

fn row(attributes: &'static str, elements: &'static str) -> Row {
    let mut row = Row::default();
    for word in attributes.split_whitespace() {
        let (name, good_for) = match (word.split_once('='), word.strip_suffix('~')) {
            (Some((name, values)), _) => (name, Use::Only(values.split(',').collect())),
            (None, Some(name)) => (name, Use::Describes),
            (None, None) => (word, Use::Interpreted),
        };
        row.attributes.insert(name, good_for);
    }
    for (number, word) in elements.split_whitespace().enumerate() {
        match word {
            "text" => row.content = Content::Text,
            "markup" => row.content = Content::Markup,
            _ => {}
        }
        let choice = word.contains('/').then_some(number);
        for name in word.split('/').filter(|_| row.content == Content::Elements) {
            let (name, repeats) = name.strip_suffix('*').map_or((name, false), |name| (name, true));
            let (name, good_for) =
                name.strip_suffix('~').map_or((name, Use::Interpreted), |name| (name, Use::Describes));
            row.elements.insert(name, Entry { good_for, repeats, choice });
        }
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    const FAMILIES: [Family; 2] = [Family::Beremiz, Family::Codesys];

    #[test]
    fn every_element_that_is_interpreted_has_a_row_and_every_row_is_reached() {
        for family in FAMILIES {
            let mut seen = BTreeSet::new();
            assert!(lines(family).into_iter().all(|(element, parent, _)| seen.insert((element, parent))), "{family:?}");
            let table = Table::of(family);
            let mut reached = BTreeSet::from([("-", "project")]);
            let rows =
                || table.rows.iter().flat_map(|(element, places)| places.iter().map(move |(p, r)| (*p, *element, r)));
            for (_, element, row) in rows() {
                for (name, entry) in row.elements.iter().filter(|(name, _)| **name != "addData") {
                    if entry.good_for == Use::Interpreted {
                        assert!(table.row(element, name).is_some(), "{name} in {element} has no row");
                        reached.insert((element, *name));
                    }
                }
            }
            // What stands within vendor data is reached from there.
            let rows: BTreeSet<_> = rows().map(|(p, e, _)| (p, e)).filter(|(parent, _)| *parent != "data").collect();
            assert_eq!(rows, reached, "{family:?}");
        }
    }

    #[test]
    fn a_line_is_read_as_the_head_says() {
        let row = row("a b=0,1 c~ d=", "e f~ g* h*/i~ addData");
        assert_eq!(row.attributes["a"], Use::Interpreted);
        assert_eq!(row.attributes["b"], Use::Only(vec!["0", "1"]));
        assert_eq!(row.attributes["c"], Use::Describes);
        assert_eq!(row.attributes["d"], Use::Only(vec![""]));
        let entry = |good_for, repeats, choice| Entry { good_for, repeats, choice };
        assert_eq!(row.elements["e"], entry(Use::Interpreted, false, None));
        assert_eq!(row.elements["f"], entry(Use::Describes, false, None));
        assert_eq!(row.elements["g"], entry(Use::Interpreted, true, None));
        assert_eq!(row.elements["h"], entry(Use::Interpreted, true, Some(3)));
        assert_eq!(row.elements["i"], entry(Use::Describes, false, Some(3)));
        assert_eq!(super::row("", "text").content, Content::Text);
    }
}
