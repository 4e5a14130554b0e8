//! Diagnostics: what a stage has to say about a source text, apart from how it is shown.
//!
//! A message says what is, a label says what stands at a place, a help says what to write instead.

use super::span::Span;
use serde::{Serialize, Serializer};
use std::fmt;

/// Whether a diagnostic stops the compilation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Nothing is emitted.
    Error,
    /// Something looks wrong but means something definite.
    Warning,
}

/// One statement about one place, with the places that explain it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Diagnostic {
    /// Which kind of statement; `chartwright explain` has a page for each.
    pub code: Code,
    /// What is the case, in one sentence without a full stop.
    pub message: String,
    /// The places concerned. The first is where the user should look first; it may be missing only
    /// where there is no text at all (a file that cannot be read).
    pub labels: Vec<Label>,
    /// What to do about it, each a sentence.
    pub help: Vec<String>,
}

/// A place and what stands there.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Label {
    /// Where.
    pub span: Span,
    /// What stands there; may be empty.
    pub text: String,
}

impl Diagnostic {
    /// A diagnostic without places.
    pub fn new(code: Code, message: impl Into<String>) -> Self {
        Diagnostic { code, message: message.into(), labels: Vec::new(), help: Vec::new() }
    }

    /// Adds a place; the first one added is the main one.
    #[must_use]
    pub fn label(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into() });
        self
    }

    /// Adds advice.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help.push(text.into());
        self
    }

    /// Error or warning.
    pub fn severity(&self) -> Severity {
        self.code.severity()
    }
}

/// Collects diagnostics of one run, in the order in which they were found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
}

impl Diagnostics {
    /// Nothing said yet.
    pub fn new() -> Self {
        Diagnostics::default()
    }

    /// Takes one in.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.list.push(diagnostic);
    }

    /// Takes all of `other` in.
    pub fn append(&mut self, mut other: Diagnostics) {
        self.list.append(&mut other.list);
    }

    /// Whether one of them is an error.
    pub fn has_errors(&self) -> bool {
        self.list.iter().any(|d| d.severity() == Severity::Error)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// All of them.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.list.iter()
    }

    /// Orders them by place, errors and warnings mixed, and drops exact repetitions.
    pub fn sort(&mut self) {
        self.list.sort_by_key(|d| (d.labels.first().map(|l| l.span), d.code));
        self.list.dedup();
    }
}

impl<'a> IntoIterator for &'a Diagnostics {
    type Item = &'a Diagnostic;
    type IntoIter = std::slice::Iter<'a, Diagnostic>;
    fn into_iter(self) -> Self::IntoIter {
        self.list.iter()
    }
}

macro_rules! codes {
    ($($name:ident $number:literal $title:literal,)*) => {
        /// The kinds of diagnostics. `E…` are errors, `W…` warnings. A code is never reused for
        /// another meaning; `docs/errors/<code>.md` is its page, `models/invalid/<code>*.chart` its
        /// smallest wrong model.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code {
            $(#[doc = $title] $name,)*
        }

        impl Code {
            /// Every code, in order of number.
            pub const ALL: &'static [Code] = &[$(Code::$name,)*];

            /// The code as users see it, such as `E101`.
            pub fn number(self) -> &'static str {
                match self { $(Code::$name => $number,)* }
            }

            /// The rule in a few words.
            pub fn title(self) -> &'static str {
                match self { $(Code::$name => $title,)* }
            }

            /// The page that `chartwright explain` prints, in Markdown.
            pub fn page(self) -> &'static str {
                match self {
                    $(Code::$name => include_str!(concat!("../../docs/errors/", $number, ".md")),)*
                }
            }
        }
    };
}

codes! {
    Unreadable "E001" "a file cannot be read or written",
    NotUtf8 "E002" "the file is not UTF-8 text",
    Empty "E003" "the file describes no machine",
    TooLarge "E004" "the file is larger than the stated limit",
    TooDeep "E005" "braces or parentheses are nested deeper than the stated limit",
    Unbalanced "E006" "a brace, parenthesis, comment or text is not closed",
    Syntax "E007" "something else was expected here",
    Reserved "E008" "a word of the language stands where a name is expected",
    IllegalName "E009" "a name is not legal in a PLC",
    Repeated "E010" "a part of the model is given more than once",

    DuplicateName "E101" "two things have one name",
    DuplicateAddress "E102" "two signals have one address",
    BadAddress "E103" "an address does not fit",
    UnknownName "E104" "a name is not declared",
    AmbiguousName "E105" "a name could mean several states",
    WrongKind "E106" "a name means something that cannot stand here",
    PlcWord "E107" "a name is a word that a PLC keeps to itself",

    NoTechnology "E201" "an output has no technology",
    SharedOutput "E202" "two actuators drive one output",
    ActuatorShape "E203" "an actuator does not have the positions and outputs of its technology",
    MoveWithoutSensor "E204" "nothing confirms the end of a movement",
    MoveWithoutActuator "E205" "a movement stands where nothing can move",
    NoPosition "E206" "a state of an actuator's region is at no position",
    JumpBetweenPositions "E207" "a transition changes the position without a movement",
    OpposedDrives "E208" "two states drive one actuator both ways at once",

    NoInitialState "E301" "a region has no initial state",
    SeveralInitialStates "E302" "a region has several initial states",
    EmptyState "E303" "braces hold no state, or a parallel state fewer than two regions",
    NeverEntered "E305" "a state is never entered",
    NeverDone "E306" "a state is never done",
    SamePriority "E307" "two transitions of one source have one priority",
    NeverFires "E308" "a transition can never fire",
    TooManyStates "E309" "a region has more states or transitions than one SFC may have",
    ParallelWrites "E310" "parallel regions may write one variable in the same scan",
    SetAndReset "E311" "one transition, entry or exit sets and resets a variable",
    BadTime "E312" "a time is out of range",
    NoChart "E313" "a machine has no chart",
    NotSideBySide "E320" "the states of a fork or join are not in different regions of one parallel state",
    NoElse "E321" "a choice does not end in its only `else`",
    CyclicChoice "E322" "choices lead back to each other",
    NoHistory "E323" "a state that holds no states is entered by its history",
    BadBeginning "E324" "an initial choice does more than choose a state of its region",
    TooManyWays "E325" "too many ways lead through choices",
    IdleInternal "E330" "an internal transition does nothing",
    LimitWithoutMovement "E331" "a time limit stands at a position that no movement leads to",

    BadRange "E340" "the range of an integer, or its initial value, does not fit",
    WrongAssignment "E341" "a variable is written in a way that its type does not allow",
    LeavesInt "E342" "an integer expression is too long, or can leave the type INT",
    DecidedComparison "E343" "a comparison is TRUE, or FALSE, whatever the integers are",
    NeverInRange "E344" "what is assigned to an integer always lies outside its range",
    ObserverReads "E350" "an observer reads what the charts decide",
    ObserverActs "E351" "an observer does more than to observe",
    NotFlat "E352" "an observer with a part after the filter is more than one region of elementary states",

    NoOutputInConstraint "E401" "a safety constraint names no output of this scan",
    NobodyYields "E402" "a combined constraint does not say who yields",
    CannotYield "E403" "an output is named to yield that cannot relieve the constraint",
    TooManyProducts "E404" "a safety constraint splits into too many products",
    ConstantConstraint "E405" "a safety constraint or assumption does not depend on anything",
    ContradictingConstraints "E406" "simple constraints can force one output both ways",
    ContradictingReliefs "E407" "combined constraints can force one output both ways",
    BlockedRelief "E408" "the output that should yield can be held by a simple constraint",
    BadAssumption "E409" "an assumption speaks of what the program decides",
    BadReset "E410" "a filter lacks its reset, or has one that it cannot use",
    RestlessReliefs "E411" "reliefs in order do not come to rest",
    NoSafeOutputs "E412" "no outputs meet all constraints",
    UnsafeFilter "E413" "a program's filter lets through what a constraint forbids",
    NothingPossible "E414" "assumptions exclude every case",
    NothingDerived "E420" "a name means nothing that constraints could be derived from",
    ValveNeeded "E421" "what keeps an actuator away depends on its valve, which is not declared",
    BadForbid "E422" "positions are forbidden that cannot be told or kept",
    BadValve "E423" "a valve does not fit its actuator or the plant",
    NotKept "E424" "positions are forbidden and nothing prevents them",

    NotPlcopen "E601" "the file is not PLCopen XML",
    NotUnderstood "E602" "a construct of the PLC project is not understood",
    Undeclared "E603" "a name is not declared in the PLC project",
    Unconnected "E604" "an element of a drawing is not connected as it must be",
    BrokenText "E605" "a text in a PLC language has a wrong form or type",
    Clash "E606" "two things in the PLC project have one name, number or address",

    CannotTravel "E701" "an actuator cannot travel as the plant says",
    GivenTwice "E702" "an input is given by an actuator and by a rule of the plant",
    PlantReads "E703" "the plant reads what it cannot know",
    BadScans "E704" "a time or a number of repetitions is out of range",
    GivenByPlant "E705" "a scenario sets an input that the plant gives",
    NothingRan "E706" "an expectation stands where no scan has run",
    CyclicScenarios "E707" "scenarios begin after each other",
    BadHappening "E708" "a scenario lets something happen that the plant does not know",

    Different "E801" "a program does not do what its chart says",
    Undecided "E802" "a program is neither proved nor refuted",
    BadWitness "E803" "a run that another tool found cannot be read",
    NotShown "E804" "a run that another tool found shows nothing",

    NeverDriven "W501" "an output is never driven",
    NeverUsed "W502" "something is declared and never used",
    CyclicReliefs "W503" "reliefs of combined constraints form a cycle",
    StaleAcceptance "W504" "a warning is accepted that there is not",
}

impl Code {
    /// Error or warning, by the letter of its number.
    pub fn severity(self) -> Severity {
        if self.number().starts_with('E') { Severity::Error } else { Severity::Warning }
    }

    /// The code with that number, in any case, such as `e101`.
    pub fn find(number: &str) -> Option<Code> {
        Code::ALL.iter().copied().find(|c| c.number().eq_ignore_ascii_case(number))
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.number())
    }
}

impl Serialize for Code {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.number())
    }
}
