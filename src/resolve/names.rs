//! Names to what they mean: the tables of declared names and the search for states.

use super::Resolver;
use crate::base::{Code, Diagnostic, Span, iec, limits, words};
use crate::ir::scenario::{BitId, CountId};
use crate::ir::{ast, chart};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// What a name of the machine's own list of names means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symbol {
    Input(chart::InputId),
    Output(chart::OutputId),
    Variable(chart::VariableId),
    Event(chart::EventId),
    Integer(chart::IntegerId),
    Bit(BitId),
    Count(CountId),
}

/// The tables, by folded name. They are only looked up, never walked, so that no order of hashing
/// reaches a result.
#[derive(Default)]
pub struct Names {
    symbols: HashMap<String, (Symbol, Span)>,
    actuators: HashMap<String, (chart::ActuatorId, Span)>,
    /// States and choices.
    states: HashMap<(chart::RegionId, String), Place>,
    /// Where each choice is declared.
    choices: Vec<Span>,
    regions: HashMap<(Option<chart::StateId>, usize, String), chart::RegionId>,
    /// All states and regions of a name, in order of declaration.
    everywhere: HashMap<String, Vec<Place>>,
    /// Spellings for suggestions, in order of declaration.
    symbol_list: Vec<String>,
    state_list: Vec<String>,
}

/// What a path can lead through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    State(chart::StateId),
    Region(chart::RegionId),
    /// The choice of that number.
    Choice(usize),
}

/// The braces between which a name of a state is written: where it is looked up first.
#[derive(Clone, Copy, Debug)]
pub enum Braces {
    /// Those of a region, or of a state without regions that is in it.
    Region(chart::RegionId),
    /// Those around the regions of a parallel state.
    Parallel(chart::StateId),
}

/// The text of a description, empty if there is none.
pub fn describe(text: &Option<ast::Text>) -> String {
    text.as_ref().map(|t| t.value.clone()).unwrap_or_default()
}

impl Resolver {
    /// Reports a name that has not the form of an IEC name.
    pub fn legal(&mut self, name: &ast::Name) {
        let problem = match iec::illegal(&name.text) {
            None if name.text.chars().count() > limits::NAME_LENGTH => {
                format!("`{}` is longer than {} characters", name.text, limits::NAME_LENGTH)
            }
            None => return,
            Some(iec::Illegal::FirstCharacter) => format!("`{}` does not begin with a letter", name.text),
            Some(iec::Illegal::Character(c)) => format!("`{}` holds `{c}`", name.text),
            Some(iec::Illegal::DoubleUnderscore) => format!("`{}` holds two underscores in a row", name.text),
            Some(iec::Illegal::TrailingUnderscore) => format!("`{}` ends in an underscore", name.text),
        };
        self.diagnostics.push(
            Diagnostic::new(Code::IllegalName, problem)
                .label(name.span, "not a legal name in a PLC")
                .help("a name is a letter, then letters and digits, with single underscores between them"),
        );
    }

    /// Enters an input, output, variable or event; its name goes into the PLC as it is.
    pub fn declare_symbol(&mut self, name: &ast::Name, symbol: Symbol) {
        self.legal(name);
        match self.names.symbols.entry(iec::fold(&name.text)) {
            Entry::Vacant(entry) => {
                entry.insert((symbol, name.span));
                self.names.symbol_list.push(name.text.clone());
            }
            Entry::Occupied(entry) => {
                let first = entry.get().1;
                self.duplicate(name, first);
            }
        }
    }

    /// Reports what goes into the PLC program as it is and cannot, with a name that can. `letter` tells apart what
    /// it is, as addresses do.
    pub fn refuse_word(&mut self, name: &str, span: Span, letter: char) {
        let Some(what) = words::clash(name) else { return };
        let free = |proposed: &String| {
            let fits = proposed.len() <= limits::NAME_LENGTH && words::clash(proposed).is_none();
            fits && !self.names.symbols.contains_key(&iec::fold(proposed))
        };
        let whole = words::without_ends(name);
        let kept = &whole[..whole.len().min(limits::NAME_LENGTH - 5)];
        let numbered = (2..1000).map(|n| format!("{kept}_{letter}{n}"));
        let proposed = std::iter::once(format!("{kept}_{letter}")).chain(numbered).find(free);
        let help = proposed.map_or_else(|| "choose another name".to_owned(), |p| format!("call it `{p}`, for example"));
        self.diagnostics.push(
            Diagnostic::new(Code::PlcWord, format!("`{name}` is {what}"))
                .label(span, "this name goes into the PLC program as it is")
                .help(help),
        );
    }

    /// Enters an actuator.
    pub fn declare_actuator(&mut self, name: &ast::Name, id: chart::ActuatorId) {
        self.legal(name);
        match self.names.actuators.entry(iec::fold(&name.text)) {
            Entry::Vacant(entry) => {
                entry.insert((id, name.span));
            }
            Entry::Occupied(entry) => {
                let first = entry.get().1;
                self.duplicate(name, first);
            }
        }
    }

    /// Enters a state into its region.
    pub fn declare_state(&mut self, name: &ast::Name, region: chart::RegionId, id: chart::StateId) {
        self.declare_place(name, region, Place::State(id));
    }

    /// Enters a choice into its region; they are numbered as they come.
    pub fn declare_choice(&mut self, name: &ast::Name, region: chart::RegionId) {
        let place = Place::Choice(self.names.choices.len());
        self.names.choices.push(name.span);
        self.declare_place(name, region, place);
    }

    fn declare_place(&mut self, name: &ast::Name, region: chart::RegionId, place: Place) {
        self.legal(name);
        let folded = iec::fold(&name.text);
        self.names.everywhere.entry(folded.clone()).or_default().push(place);
        self.names.state_list.push(name.text.clone());
        match self.names.states.entry((region, folded)) {
            Entry::Vacant(entry) => {
                entry.insert(place);
            }
            Entry::Occupied(entry) => {
                let first = match *entry.get() {
                    Place::State(id) => self.machine.states[id].span,
                    Place::Choice(choice) => self.names.choices[choice],
                    Place::Region(_) => unreachable!("regions have a list of their own"),
                };
                self.duplicate(name, first);
            }
        }
    }

    /// Enters a named region into its state or chart.
    pub fn declare_region(
        &mut self,
        name: &ast::Name,
        parent: Option<chart::StateId>,
        chart: usize,
        id: chart::RegionId,
    ) {
        self.legal(name);
        let folded = iec::fold(&name.text);
        self.names.everywhere.entry(folded.clone()).or_default().push(Place::Region(id));
        match self.names.regions.entry((parent, chart, folded)) {
            Entry::Vacant(entry) => {
                entry.insert(id);
            }
            Entry::Occupied(entry) => {
                let first = self.machine.regions[*entry.get()].span;
                self.duplicate(name, first);
            }
        }
    }

    /// Reports a second declaration of a name.
    pub fn duplicate(&mut self, name: &ast::Name, first: Span) {
        self.diagnostics.push(
            Diagnostic::new(Code::DuplicateName, format!("`{}` is declared twice", name.text))
                .label(name.span, "declared again")
                .label(first, "first declared here")
                .help("names that differ only by case are the same name in a PLC"),
        );
    }

    /// What a name of the machine's list means.
    pub fn symbol(&self, name: &str) -> Option<Symbol> {
        self.names.symbols.get(&iec::fold(name)).map(|(s, _)| *s)
    }

    /// The output of that name, or an error.
    pub fn output(&mut self, name: &ast::Name) -> Option<chart::OutputId> {
        match self.symbol(&name.text) {
            Some(Symbol::Output(id)) => Some(id),
            other => {
                self.wrong_symbol(name, other, "an output");
                None
            }
        }
    }

    /// The input of that name, or an error.
    pub fn input(&mut self, name: &ast::Name) -> Option<chart::InputId> {
        match self.symbol(&name.text) {
            Some(Symbol::Input(id)) => Some(id),
            other => {
                self.wrong_symbol(name, other, "an input");
                None
            }
        }
    }

    /// The variable of that name, or an error.
    pub fn variable(&mut self, name: &ast::Name) -> Option<chart::VariableId> {
        match self.symbol(&name.text) {
            Some(Symbol::Variable(id)) => Some(id),
            other => {
                self.wrong_symbol(name, other, "a variable");
                None
            }
        }
    }

    /// The event of that name, or an error.
    pub fn event(&mut self, name: &ast::Name) -> Option<chart::EventId> {
        match self.symbol(&name.text) {
            Some(Symbol::Event(id)) => Some(id),
            other => {
                self.wrong_symbol(name, other, "an event");
                None
            }
        }
    }

    /// The actuator of that name, or an error.
    pub fn actuator(&mut self, name: &ast::Name) -> Option<chart::ActuatorId> {
        let found = self.names.actuators.get(&iec::fold(&name.text)).map(|(id, _)| *id);
        if found.is_none() {
            self.diagnostics.push(
                Diagnostic::new(Code::UnknownName, format!("there is no actuator `{}`", name.text))
                    .label(name.span, "not declared")
                    .help(format!("declare it: `actuator {} bistable {{ … }}`", name.text)),
            );
        }
        found
    }

    /// Reports an observer that does more than to observe.
    pub fn observes_only(&mut self, span: Span, message: &str) {
        self.diagnostics.push(
            Diagnostic::new(Code::ObserverActs, format!("an observer only observes, and {message}"))
                .label(span, "not in an observer")
                .help("let a chart do it, under a condition that asks for the observer's state: `in(STATE)`; what is to be remembered, the observer writes once: by `then`, `entry`, `exit` or `internal`"),
        );
    }

    pub fn wrong_symbol(&mut self, name: &ast::Name, found: Option<Symbol>, wanted: &str) {
        match found {
            Some(symbol) => self.diagnostics.push(
                Diagnostic::new(Code::WrongKind, format!("`{}` is {}, not {wanted}", name.text, kind(symbol)))
                    .label(name.span, format!("{wanted} is expected here")),
            ),
            None => self.unknown_symbol(&name.text, name.span),
        }
    }

    /// Reports a name that means nothing, with the nearest ones that do.
    pub fn unknown_symbol(&mut self, name: &str, span: Span) {
        let mut d = Diagnostic::new(Code::UnknownName, format!("`{name}` is not declared")).label(span, "not declared");
        if let Some(near) = nearest(name, &self.names.symbol_list) {
            d = d.help(format!("did you mean `{near}`?"));
        } else if self.names.everywhere.contains_key(&iec::fold(name)) {
            d = d.help(format!("to ask whether the state is active, write `in({name})`"));
        }
        self.diagnostics.push(d);
    }

    /// The outermost region that alone has something called `name`: where a search from outside begins.
    pub fn outermost(&self, name: &str) -> Option<Braces> {
        let regions = self.machine.charts.iter().flat_map(|c| &c.regions);
        let mut found: Vec<(Place, chart::RegionId)> =
            regions.filter_map(|&r| Some((self.outward(name, Braces::Region(r))?, r))).collect();
        found.dedup_by_key(|(place, _)| *place);
        if let [(_, region)] = found[..] { Some(Braces::Region(region)) } else { None }
    }

    /// The first region of the chart of that name, unless a state or region is called so, too.
    pub fn chart(&self, name: &str) -> Option<chart::RegionId> {
        let folded = iec::fold(name);
        let chart = self.machine.charts.iter().find(|c| iec::fold(&c.name) == folded)?;
        (!self.names.everywhere.contains_key(&folded)).then(|| chart.regions.first().copied()).flatten()
    }

    /// The state that `parts` mean in the chart of that name and first region.
    pub fn state_of_chart(
        &mut self,
        chart: &(&str, Span),
        parts: &[(&str, Span)],
        first: chart::RegionId,
    ) -> Option<chart::StateId> {
        let found = self.state(parts, Some(Braces::Region(first)))?;
        let of = |region: chart::RegionId| self.machine.regions[region].chart;
        if of(self.machine.states[found].region) == of(first) {
            return Some(found);
        }
        let path = self.machine.state_path(found);
        self.diagnostics.push(
            Diagnostic::new(Code::UnknownName, format!("`{}` holds no `{path}`", chart.0))
                .label(parts[0].1, "a state of another chart"),
        );
        None
    }

    /// The state that `parts` mean where they are written: between those braces if there are any, then
    /// outward, else anywhere in the machine if only one fits.
    pub fn state(&mut self, parts: &[(&str, Span)], braces: Option<Braces>) -> Option<chart::StateId> {
        match self.find(parts, braces, false)? {
            Place::State(id) => Some(id),
            Place::Region(_) | Place::Choice(_) => None,
        }
    }

    /// The state that a path means.
    pub fn path(&mut self, path: &ast::Path, braces: Braces) -> Option<chart::StateId> {
        self.state(&words(path), Some(braces))
    }

    /// The state or choice that a path means.
    pub fn target(&mut self, path: &ast::Path, braces: Braces) -> Option<Place> {
        self.find(&words(path), Some(braces), true)
    }

    /// The state that `parts` mean, or choice if one may stand there.
    fn find(&mut self, parts: &[(&str, Span)], braces: Option<Braces>, choices: bool) -> Option<Place> {
        let span = parts[0].1.to(parts[parts.len() - 1].1);
        let text = parts.iter().map(|p| p.0).collect::<Vec<_>>().join(".");
        if let Some(start) = braces.and_then(|b| self.outward(parts[0].0, b)) {
            return match self.follow(start, &parts[1..]) {
                Ok(place) if choices || !matches!(place, Place::Choice(_)) => {
                    if let Place::Region(_) = place {
                        self.not_a_state(&text, span);
                        return None;
                    }
                    Some(place)
                }
                Ok(_) => {
                    self.is_a_choice(&text, span);
                    None
                }
                Err(i) => {
                    let (name, at) = parts[i + 1];
                    let outer = parts[..=i].iter().map(|p| p.0).collect::<Vec<_>>().join(".");
                    self.diagnostics.push(
                        Diagnostic::new(Code::UnknownName, format!("`{outer}` holds no `{name}`"))
                            .label(at, "not declared there"),
                    );
                    None
                }
            };
        }
        let found = self.places(parts);
        let fits = |p: &Place| match p {
            Place::State(_) => true,
            Place::Choice(_) => choices,
            Place::Region(_) => false,
        };
        let states: Vec<Place> = found.iter().copied().filter(fits).collect();
        match states[..] {
            [one] => Some(one),
            [] if found.iter().any(|p| matches!(p, Place::Choice(_))) => {
                self.is_a_choice(&text, span);
                None
            }
            [] if !found.is_empty() => {
                self.not_a_state(&text, span);
                None
            }
            [] => {
                let mut d = Diagnostic::new(Code::UnknownName, format!("there is no state `{text}`"))
                    .label(span, "not declared");
                if let (Some(near), true) = (nearest(parts[0].0, &self.names.state_list), parts.len() == 1) {
                    d = d.help(format!("did you mean `{near}`?"));
                }
                self.diagnostics.push(d);
                None
            }
            _ => {
                let path = |place: &Place| match *place {
                    Place::State(id) => Some(self.more_of(id, &text)),
                    Place::Region(_) | Place::Choice(_) => None,
                };
                let paths: Vec<String> = states.iter().filter_map(path).collect();
                let shown = paths.iter().take(4).map(|p| format!("`{p}`")).collect::<Vec<_>>().join(", ");
                let more = if paths.len() > 4 { format!(" and {} more", paths.len() - 4) } else { String::new() };
                self.diagnostics.push(
                    Diagnostic::new(Code::AmbiguousName, format!("`{text}` could mean several states"))
                        .label(span, "which one?")
                        .help(format!("write more of its path: {shown}{more}")),
                );
                None
            }
        }
    }

    /// The path of a state, with its chart's name before it if it says no more than `text`.
    fn more_of(&self, state: chart::StateId, text: &str) -> String {
        let path = self.machine.state_path(state);
        if !path.eq_ignore_ascii_case(text) {
            return path;
        }
        let chart = self.machine.regions[self.machine.states[state].region].chart;
        format!("{}.{path}", self.machine.charts[chart].name)
    }

    fn is_a_choice(&mut self, text: &str, span: Span) {
        self.diagnostics.push(
            Diagnostic::new(Code::WrongKind, format!("`{text}` is a choice"))
                .label(span, "a state is expected here")
                .help("a choice is never active: only transitions and branches lead to it, and none leaves it but its branches"),
        );
    }

    /// All that a path can mean, searched in the whole machine.
    fn places(&self, parts: &[(&str, Span)]) -> Vec<Place> {
        let starts = self.names.everywhere.get(&iec::fold(parts[0].0)).map(Vec::as_slice).unwrap_or_default();
        starts.iter().filter_map(|&s| self.follow(s, &parts[1..]).ok()).collect()
    }

    fn not_a_state(&mut self, text: &str, span: Span) {
        self.diagnostics.push(
            Diagnostic::new(Code::WrongKind, format!("`{text}` is a region"))
                .label(span, "a state is expected here")
                .help(format!("name one of its states, such as `{text}.Home`")),
        );
    }

    /// The nearest place called `name`: one of the regions between these braces, a state of the region
    /// around them, this region itself or one beside it, then the same further out.
    fn outward(&self, name: &str, braces: Braces) -> Option<Place> {
        let folded = iec::fold(name);
        let region = self.around(braces);
        if let Braces::Parallel(state) = braces {
            let chart = self.machine.regions[region].chart;
            if let Some(&r) = self.names.regions.get(&(Some(state), chart, folded.clone())) {
                return Some(Place::Region(r));
            }
        }
        let mut at = Some(region);
        while let Some(r) = at {
            if let Some(&place) = self.names.states.get(&(r, folded.clone())) {
                return Some(place);
            }
            let region = &self.machine.regions[r];
            if let Some(&r) = self.names.regions.get(&(region.parent, region.chart, folded.clone())) {
                return Some(Place::Region(r));
            }
            at = region.parent.map(|p| self.machine.states[p].region);
        }
        None
    }

    /// The region that the braces belong to, or that holds their state.
    pub fn around(&self, braces: Braces) -> chart::RegionId {
        match braces {
            Braces::Region(region) => region,
            Braces::Parallel(state) => self.machine.states[state].region,
        }
    }

    /// Follows the rest of a path; the error is the index of the part that is not there.
    fn follow(&self, start: Place, rest: &[(&str, Span)]) -> Result<Place, usize> {
        let mut place = start;
        for (i, (name, _)) in rest.iter().enumerate() {
            let folded = iec::fold(name);
            let next = match place {
                Place::Region(r) => self.names.states.get(&(r, folded)).copied(),
                Place::Choice(_) => None,
                Place::State(s) => {
                    let state = &self.machine.states[s];
                    let chart = self.machine.regions[state.region].chart;
                    match state.regions.as_slice() {
                        [only] if self.machine.regions[*only].name.is_none() => {
                            self.names.states.get(&(*only, folded)).copied()
                        }
                        _ => self.names.regions.get(&(Some(s), chart, folded)).map(|&r| Place::Region(r)),
                    }
                }
            };
            place = next.ok_or(i)?;
        }
        Ok(place)
    }
}

/// The words of a path with their places.
fn words(path: &ast::Path) -> Vec<(&str, Span)> {
    path.parts.iter().map(|n| (n.text.as_str(), n.span)).collect()
}

/// What a symbol is, in words.
pub fn kind(symbol: Symbol) -> &'static str {
    match symbol {
        Symbol::Input(_) => "an input",
        Symbol::Output(_) => "an output",
        Symbol::Variable(_) => "a variable",
        Symbol::Event(_) => "an event",
        Symbol::Integer(_) => "an integer",
        Symbol::Bit(_) => "a hidden bit of the plant",
        Symbol::Count(_) => "a hidden integer of the plant",
    }
}

/// The declared name that is at most two slips away from `name`, the first of the nearest.
fn nearest<'a>(name: &str, declared: &'a [String]) -> Option<&'a str> {
    let folded = iec::fold(name);
    declared
        .iter()
        .map(|d| (distance(&folded, &iec::fold(d)), d))
        .filter(|&(n, d)| n <= 2 && n < d.chars().count().min(name.chars().count()))
        .min_by_key(|&(n, _)| n)
        .map(|(_, d)| d.as_str())
}

/// Levenshtein's distance.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &cb) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(ca != cb);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}
