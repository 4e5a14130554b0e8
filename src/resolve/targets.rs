//! Where transitions lead: choices to the ways through them, forks and histories to how a state is
//! entered. Gone after it: choices.
//!
//! A choice is no place to stay. A transition that leads to one becomes a transition for each way
//! through it, with conditions that exclude each other.

use super::Resolver;
use super::expressions::Context;
use super::names::{Braces, Place};
use crate::base::{Code, Diagnostic, Span, limits};
use crate::ir::chart::{Guard, Inside, Phase, RegionId, StateId};
use crate::ir::{ast, expr::Expr};

/// A choice and the region in whose braces it stands.
pub struct Choice<'a> {
    pub written: &'a ast::Choice,
    pub region: RegionId,
    /// Whether something leads to it.
    pub used: bool,
}

/// One way through choices to a state.
#[derive(Clone)]
pub struct Way<'a> {
    pub target: StateId,
    pub inside: Inside,
    /// When it is taken, if none before it is.
    pub first: Guard,
    /// When it is taken.
    pub exact: Guard,
    pub effects: Vec<&'a ast::Effect>,
    pub descriptions: Vec<&'a str>,
}

/// The ways to a target that is written between these braces; at least one, nothing after an error.
/// With a source, conditions may ask how long it has been active and whether it is done.
pub fn ways<'a>(
    r: &mut Resolver,
    choices: &mut [Choice<'a>],
    target: &'a ast::Target,
    braces: Braces,
    source: Option<(StateId, Phase)>,
) -> Option<Vec<Way<'a>>> {
    let mut walk = Walk { r, choices, source, open: Vec::new(), ways: Vec::new(), too_many: false };
    let nothing = Taken { first: Expr::TRUE, exact: Expr::TRUE, effects: Vec::new(), descriptions: Vec::new() };
    walk.follow(target, braces, nothing).then_some(walk.ways)
}

/// What has been met on the way so far.
#[derive(Clone)]
struct Taken<'a> {
    first: Guard,
    exact: Guard,
    effects: Vec<&'a ast::Effect>,
    descriptions: Vec<&'a str>,
}

struct Walk<'w, 'a> {
    r: &'w mut Resolver,
    choices: &'w mut [Choice<'a>],
    source: Option<(StateId, Phase)>,
    /// The choices on the way.
    open: Vec<usize>,
    ways: Vec<Way<'a>>,
    /// Whether there are too many, which is said once.
    too_many: bool,
}

impl<'a> Walk<'_, 'a> {
    /// Whether nothing was wrong on the way. Recursion is bounded by [`limits::WAYS`].
    fn follow(&mut self, target: &'a ast::Target, braces: Braces, taken: Taken<'a>) -> bool {
        let end = match target {
            ast::Target::State(path) => match self.r.target(path, braces) {
                None => None,
                Some(Place::Choice(choice)) => return self.branch(choice, target.span(), taken),
                Some(Place::State(state)) => Some((state, Inside::Default)),
                Some(Place::Region(_)) => unreachable!("a region is no target"),
            },
            ast::Target::History { of, deep } => self.r.path(of, braces).and_then(|state| {
                let inside = if *deep { Inside::DeepHistory } else { Inside::History };
                self.r.has_history(state, of.span()).then_some((state, inside))
            }),
            ast::Target::Fork(paths) => {
                let fork = self.r.side_by_side(paths, braces);
                fork.map(|(parallel, states)| (parallel, Inside::Fork(states)))
            }
        };
        let Some((target, inside)) = end else { return false };
        let Taken { first, exact, effects, descriptions } = taken;
        self.ways.push(Way { target, inside, first, exact, effects, descriptions });
        true
    }

    fn branch(&mut self, choice: usize, span: Span, taken: Taken<'a>) -> bool {
        let Choice { written, region, .. } = self.choices[choice];
        self.choices[choice].used = true;
        if let Some(at) = self.open.iter().position(|&c| c == choice) {
            let names: Vec<String> =
                self.open[at..].iter().map(|&c| format!("`{}`", self.choices[c].written.name.text)).collect();
            self.r.diagnostics.push(
                Diagnostic::new(Code::CyclicChoice, format!("a way through {} leads back to it", names.join(" and ")))
                    .label(span, "leads back")
                    .label(written.name.span, "to this choice")
                    .help("lead each way to a state: nothing loops inside a scan"),
            );
            return false;
        }
        if self.open.len() >= limits::WAYS {
            return self.too_many(span);
        }
        self.open.push(choice);
        let braces = Braces::Region(region);
        let context = match self.source {
            Some((source, phase)) => Context::Guard { braces, source, phase },
            None => Context::Active { braces },
        };
        let mut taken = taken;
        taken.descriptions.extend(written.description.as_ref().map(|t| t.value.as_str()));
        let mut rest = taken.exact.clone();
        let mut fine = true;
        for branch in &written.branches {
            if self.ways.len() >= limits::WAYS {
                return self.too_many(span);
            }
            let guard = branch.guard.as_ref().map_or(Expr::TRUE, |g| self.r.guard(g, &context));
            let mut next = taken.clone();
            next.first = Expr::all([taken.first.clone(), guard.clone()]);
            next.exact = Expr::all([rest.clone(), guard.clone()]);
            next.effects.extend(&branch.effects);
            next.descriptions.extend(branch.description.as_ref().map(|t| t.value.as_str()));
            rest = Expr::all([rest, guard.not()]);
            fine &= self.follow(&branch.target, braces, next);
        }
        self.open.pop();
        fine
    }

    fn too_many(&mut self, span: Span) -> bool {
        if std::mem::replace(&mut self.too_many, true) {
            return false;
        }
        self.r.diagnostics.push(
            Diagnostic::new(Code::TooManyWays, format!("more than {} ways lead on from here", limits::WAYS))
                .label(span, "through this choice and those behind it")
                .help("a transition becomes one for each way: make some of these choices states"),
        );
        false
    }
}

impl Resolver {
    /// Whether the state has regions that can be entered where they were left.
    fn has_history(&mut self, state: StateId, span: Span) -> bool {
        let s = &self.machine.states[state];
        if !s.regions.is_empty() {
            return true;
        }
        self.diagnostics.push(
            Diagnostic::new(Code::NoHistory, format!("`{}` holds no states that it could have been in", s.name))
                .label(span, "an elementary state has no history")
                .label(s.span, "declared here")
                .help("name the composite or parallel state that is to go on where it was left"),
        );
        false
    }

    /// The states of a fork or join and the parallel state in whose regions they are, one in each.
    pub fn side_by_side(&mut self, paths: &[ast::Path], braces: Braces) -> Option<(StateId, Vec<StateId>)> {
        let found: Vec<Option<StateId>> = paths.iter().map(|p| self.path(p, braces)).collect();
        let states: Vec<StateId> = found.into_iter().collect::<Option<_>>()?;
        let m = &self.machine;
        let parallel = m.ancestors(states[0]).find(|&s| s != states[0] && m.contains(s, states[1]));
        let places: Vec<Option<RegionId>> = states
            .iter()
            .map(|&s| m.states[parallel?].regions.iter().copied().find(|&r| m.child_in(r, s).is_some()))
            .collect();
        let distinct = |i: usize| places[i].is_some() && !places[..i].contains(&places[i]);
        if let (Some(parallel), None) = (parallel, (0..places.len()).find(|&i| !distinct(i))) {
            return Some((parallel, states));
        }
        let wrong = (1..places.len()).find(|&i| !distinct(i)).unwrap_or(1);
        self.diagnostics.push(
            Diagnostic::new(
                Code::NotSideBySide,
                format!(
                    "`{}` and `{}` do not run side by side in one state",
                    m.states[states[0]].name, m.states[states[wrong]].name
                ),
            )
            .label(paths[wrong].span(), "is in no other region of the same parallel state")
            .label(paths[0].span(), "than this one")
            .help("name one state in each of some regions of one `parallel state`; regions that are not named are entered by default"),
        );
        None
    }
}

/// Reports choices whose branches are not complete.
pub fn complete(r: &mut Resolver, choices: &[Choice<'_>]) {
    for Choice { written, .. } in choices {
        let otherwise = written.branches.iter().position(|b| b.guard.is_none());
        match (otherwise, written.branches.last()) {
            (Some(at), Some(last)) if at + 1 == written.branches.len() || last.guard.is_some() => {
                if let Some(late) = written.branches.get(at + 1) {
                    let d = Diagnostic::new(Code::NoElse, format!("`else` is not the end of `{}`", written.name.text))
                        .label(late.span, "this is never taken")
                        .label(written.branches[at].span, "this is always taken")
                        .help("write `else` last");
                    r.diagnostics.push(d);
                }
            }
            (Some(at), _) => r.diagnostics.push(
                Diagnostic::new(Code::NoElse, format!("`{}` has more than one `else`", written.name.text))
                    .label(written.branches[at + 1].span, "this is never taken")
                    .label(written.branches[at].span, "this is always taken"),
            ),
            (None, _) => r.diagnostics.push(
                Diagnostic::new(Code::NoElse, format!("`{}` has no `else`", written.name.text))
                    .label(written.name.span, "what if no condition holds?")
                    .help("add `else to STATE` as its last branch: a choice always leads on"),
            ),
        }
    }
}

/// Reports choices that nothing leads to.
pub fn used(r: &mut Resolver, choices: &[Choice<'_>]) {
    if r.diagnostics.has_errors() {
        return; // What leads to them may be what is wrong.
    }
    for Choice { written, .. } in choices.iter().filter(|c| !c.used) {
        r.diagnostics.push(
            Diagnostic::new(Code::NeverEntered, format!("`{}` is never entered", written.name.text))
                .label(written.name.span, "no transition leads here")
                .help("lead a transition to it, make it initial, or remove it"),
        );
    }
}

/// Initial choices to where their regions begin.
pub fn begin<'a>(r: &mut Resolver, choices: &mut [Choice<'a>]) {
    for i in 0..choices.len() {
        let Choice { written, region, .. } = choices[i];
        if written.initial.is_none() {
            continue;
        }
        let mut walk = Walk {
            r: &mut *r,
            choices: &mut *choices,
            source: None,
            open: Vec::new(),
            ways: Vec::new(),
            too_many: false,
        };
        let taken = Taken { first: Expr::TRUE, exact: Expr::TRUE, effects: Vec::new(), descriptions: Vec::new() };
        let fine = walk.branch(i, written.name.span, taken);
        let mut ways = walk.ways;
        let wrong = ways.iter().find_map(|way| {
            let name = &r.machine.states[way.target].name;
            if let Some(effect) = way.effects.first() {
                Some((effect.variable.span, "nothing is set or reset on the way into a region".to_owned()))
            } else if way.inside != Inside::Default {
                Some((written.name.span, format!("it leads to `{name}` by history or fork")))
            } else if r.machine.states[way.target].region != region {
                Some((written.name.span, format!("it leads to `{name}`, which is no state of this region")))
            } else {
                None
            }
        });
        if let Some((span, what)) = wrong {
            r.diagnostics.push(
                Diagnostic::new(Code::BadBeginning, format!("a region cannot begin with `{}`", written.name.text))
                    .label(span, what)
                    .help("let each branch lead to a state of the region, and set variables by `sets` in that state"),
            );
            continue;
        }
        let reasons: Vec<String> = ways.iter().map(|way| way.descriptions.join(", ")).collect();
        if let (true, Some(last)) = (fine, ways.pop()) {
            r.machine.regions[region].reasons = reasons;
            r.machine.regions[region].initial = last.target;
            r.machine.regions[region].entries = ways.into_iter().map(|way| (way.first, way.target)).collect();
        }
    }
}
