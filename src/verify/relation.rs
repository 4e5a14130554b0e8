//! A system to a relation between states before and after a scan, in parts.
//!
//! The parts are never put together: the image of a set meets them one after another, and what no
//! later part reads is quantified at once (Burch, Clarke, Long, 1991; Ranjan et al., 1995). Where a gate
//! is large and several others read it, it becomes a variable of its own, with a part that says what it
//! is: shared functions are not multiplied out. If there are several kinds of scans, each has parts of its own, which
//! say nothing of latches that it does not change.

mod build;
mod schedule;

use super::aig::Lit;
use super::bdd::{Bdd, Edge, Var};
use super::limits::{Limit, Limits, Stop};
use super::system::System;
use build::{Build, Graph};
use schedule::Schedule;

/// A relation over the latches that claims depend on.
pub struct Relation<'a> {
    /// The diagrams.
    pub bdd: Bdd<'a>,
    /// Indices of those latches of the system that matter.
    pub latches: Vec<usize>,
    /// For each of these, its variable before the scan.
    pub now: Vec<Var>,
    /// States before any scan.
    pub initial: Edge,
    /// For each literal asked for, and last for TRUE, what it takes, for each kind of scan in which it can be, to find the states
    /// from which inputs exist that satisfy the constraints and make it TRUE.
    asked: Vec<Vec<Asked>>,
    /// What each kind of scan does.
    kinds: Vec<Kind>,
}

/// A kind of scan.
struct Kind {
    forward: Schedule,
    backward: Schedule,
    /// Replacements of variables: those of changed latches by what they were before, and the other way round; all others by
    /// themselves.
    to_now: Vec<Var>,
    to_then: Vec<Var>,
}

/// How to find out about a literal: whether any state of a set will do, and which.
struct Asked {
    whether: Schedule,
    which: Schedule,
}

impl<'a> Relation<'a> {
    /// The relation, and what it takes to find out what is possible of `asked`.
    pub fn new(system: &System, asked: &[Lit], limits: &Limits, stop: Stop<'a>) -> Result<Self, Limit> {
        let (mut build, graph) = Build::new(system, asked, limits, stop);
        let mut parts = Parts { system, asked, questions: vec![Vec::new(); asked.len() + 1], changes: Vec::new() };
        let alternatives = parts.alternatives(&graph, &build);
        if alternatives.is_empty() {
            parts.add(&mut build, &graph, None)?;
        } else {
            for known in &alternatives {
                let (restricted, image) = graph.restrict(&parts.roots(&build), &known.gates);
                let kind = Restricted { graph: &restricted, image: &image };
                parts.add(&mut build, &graph, Some((kind, known)))?;
            }
        }
        let Parts { questions, changes, .. } = parts;
        let Build { mut bdd, latches, now, then, given, .. } = build;
        let everything: Vec<Var> = (0..bdd.variables()).collect();
        let hidden: Vec<Var> = given.iter().chain(&then).copied().collect();
        let mut asked = Vec::new();
        for question in questions {
            let mut kinds = Vec::new();
            for parts in question {
                kinds.push(Asked {
                    whether: Schedule::new(&mut bdd, &parts, &everything)?,
                    which: Schedule::new(&mut bdd, &parts, &hidden)?,
                });
            }
            asked.push(kinds);
        }
        let mut kinds = Vec::new();
        for Change { parts, changed } in changes {
            let parts = schedule::cluster(&mut bdd, parts)?;
            let of =
                |vars: &[Var]| -> Vec<Var> { changed.iter().map(|&i| vars[i]).chain(given.iter().copied()).collect() };
            let forward = Schedule::new(&mut bdd, &parts, &of(&now))?;
            let backward = Schedule::new(&mut bdd, &parts, &of(&then))?;
            let (mut to_now, mut to_then) = (everything.clone(), everything.clone());
            for &i in &changed {
                to_now[then[i] as usize] = now[i];
                to_then[now[i] as usize] = then[i];
            }
            kinds.push(Kind { forward, backward, to_now, to_then });
        }
        let mut initial = Edge::TRUE;
        for (&l, &var) in latches.iter().zip(&now) {
            if let Some(value) = system.latches[l].initial {
                let var = bdd.var(var)?;
                initial = bdd.and(initial, var.xor(!value))?;
            }
        }
        Ok(Relation { bdd, latches, now, initial, asked, kinds })
    }

    /// Whether the literal of that index is possible in one of the states; `keep` must not be lost.
    pub fn is_possible(&mut self, asked: usize, states: Edge, keep: &[Edge]) -> Result<bool, Limit> {
        let keep = self.roots(&[keep, &[states]].concat());
        for kind in &self.asked[asked] {
            if kind.whether.meet(&mut self.bdd, states, &keep)? != Edge::FALSE {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Those of the states in which it is.
    pub fn possible(&mut self, asked: usize, states: Edge, keep: &[Edge]) -> Result<Edge, Limit> {
        let mut keep = self.roots(&[keep, &[states]].concat());
        let mut all = Edge::FALSE;
        for kind in &self.asked[asked] {
            keep.push(all);
            let found = kind.which.meet(&mut self.bdd, states, &keep)?;
            all = self.bdd.or(all, found)?;
        }
        self.bdd.and(all, states)
    }

    /// The index to ask whether anything is possible.
    pub fn anything(&self) -> usize {
        self.asked.len() - 1
    }

    /// The states after one scan from `from`.
    pub fn image(&mut self, from: Edge, keep: &[Edge]) -> Result<Edge, Limit> {
        let mut keep = self.roots(&[keep, &[from]].concat());
        let mut all = Edge::FALSE;
        for (number, kind) in (0..).zip(&self.kinds) {
            keep.push(all);
            let after = kind.forward.meet(&mut self.bdd, from, &keep)?;
            let after = self.bdd.shift(after, &kind.to_now, 2 * number)?;
            all = self.bdd.or(all, after)?;
        }
        Ok(all)
    }

    /// The states from which one scan can lead to `to`.
    pub fn preimage(&mut self, to: Edge, keep: &[Edge]) -> Result<Edge, Limit> {
        let mut keep = self.roots(&[keep, &[to]].concat());
        let mut all = Edge::FALSE;
        for (number, kind) in (0..).zip(&self.kinds) {
            keep.push(all);
            let to = self.bdd.shift(to, &kind.to_then, 2 * number + 1)?;
            let before = kind.backward.meet(&mut self.bdd, to, &keep)?;
            all = self.bdd.or(all, before)?;
        }
        Ok(all)
    }

    /// Frees what nobody needs, except `keep`, when half of what is allowed is taken.
    pub fn make_room(&mut self, keep: &[Edge]) {
        if self.bdd.is_half_full() {
            let keep = self.roots(keep);
            self.bdd.collect(keep);
        }
    }

    /// The only state that is this assignment of the variables before a scan, FALSE where it says nothing.
    pub fn state(&self, values: &[(Var, bool)]) -> Vec<bool> {
        let value = |v: Var| values.iter().any(|&(var, value)| var == v && value);
        self.now.iter().map(|&v| value(v)).collect()
    }

    /// The set of one state.
    pub fn only(&mut self, state: &[bool]) -> Result<Edge, Limit> {
        let mut only = Edge::TRUE;
        for (i, &value) in state.iter().enumerate() {
            let var = self.bdd.var(self.now[i])?;
            only = self.bdd.and(only, var.xor(!value))?;
        }
        Ok(only)
    }

    /// All that must not be lost, together with `keep`.
    fn roots(&self, keep: &[Edge]) -> Vec<Edge> {
        let mut roots = vec![self.initial];
        roots.extend(keep);
        let asked = self.asked.iter().flatten().flat_map(|a| [&a.whether, &a.which]);
        let kinds = self.kinds.iter().flat_map(|k| [&k.forward, &k.backward]);
        for schedule in asked.chain(kinds) {
            roots.push(schedule.before);
            roots.extend(schedule.parts.iter().flat_map(|&(part, cube)| [part, cube]));
        }
        roots
    }
}

/// What is known of the gates in a kind of scan.
struct Known {
    gates: Vec<(Lit, bool)>,
    /// When it can be.
    when: Lit,
    /// Whether nothing asks if it is of this kind; then it mostly changes nothing that matters.
    is_other: bool,
}

/// The graph of a kind of scan, and what stands there for each node of the system.
#[derive(Clone, Copy)]
struct Restricted<'g> {
    graph: &'g Graph,
    image: &'g [Lit],
}

/// What a kind of scan changes.
struct Change {
    parts: Vec<Edge>,
    /// The latches, by their place among those that matter.
    changed: Vec<usize>,
}

/// The parts of all kinds of scans, while they are put together.
struct Parts<'s> {
    system: &'s System,
    asked: &'s [Lit],
    questions: Vec<Vec<Vec<Edge>>>,
    changes: Vec<Change>,
}

impl Parts<'_> {
    /// What is known in each kind of scan that matters; nothing if there is one kind only.
    fn alternatives(&self, graph: &Graph, build: &Build<'_>) -> Vec<Known> {
        let mut matters = vec![false; graph.aig.len()];
        graph.aig.cone(&self.roots(build)).into_iter().for_each(|n| matters[n] = true);
        let all = &self.system.alternatives;
        let (those, others): (Vec<_>, Vec<_>) = all.iter().partition(|a| a.is.node() != 0 && matters[a.is.node()]);
        let no = |except: Option<Lit>| {
            those.iter().filter(move |a| Some(a.is) != except).map(|a| (a.is, false)).collect::<Vec<_>>()
        };
        let mut known: Vec<Known> = those
            .iter()
            .map(|a| {
                let gates = a.choice.iter().copied().chain(no(Some(a.is))).chain([(a.is, true)]).collect();
                Known { gates, when: a.when, is_other: false }
            })
            .collect();
        // That nothing asks for the others does not say that they change nothing: what is none of those may.
        if !known.is_empty() {
            let others = others.into_iter().filter(|a| a.is.node() != 0);
            known.extend(others.map(|a| {
                let gates = a.choice.iter().copied().chain(no(None)).collect();
                Known { gates, when: a.when, is_other: true }
            }));
        }
        known
    }

    /// All that has to become diagrams: constraints, next values, and what is asked.
    fn roots(&self, build: &Build<'_>) -> Vec<Lit> {
        let nexts = build.latches.iter().map(|&l| self.system.latches[l].next);
        self.system.constraints.iter().copied().chain(nexts).chain(self.asked.iter().copied()).collect()
    }

    /// Adds a kind of scan: the system with some gates known, which says nothing about latches that it keeps; or the only one there is.
    fn add(
        &mut self,
        build: &mut Build<'_>,
        whole: &Graph,
        kind: Option<(Restricted<'_>, &Known)>,
    ) -> Result<(), Limit> {
        let here = |l: Lit| kind.map_or(l, |(k, _)| k.image[l.node()].xor(l.is_negated()));
        let graph = kind.map_or(whole, |(k, _)| k.graph);
        let when = kind.map(|(_, known)| known.when);
        let system = self.system;
        build.cuts.clear();
        let when = build.functions(whole, when.as_slice(), &[])?.first().copied();
        let mut roots: Vec<Lit> = system.constraints.iter().map(|&c| here(c)).collect();
        roots.extend(build.latches.iter().map(|&l| here(system.latches[l].next)));
        let functions = build.functions(graph, &roots, &[])?;
        let (constraints, nexts) = functions.split_at(system.constraints.len());
        let constraints: Vec<Edge> = constraints.iter().copied().chain(when).collect();
        // What a latch will be need not be worked out again where something reads it.
        let mut defined = Vec::new();
        let mut updates = Vec::new();
        let mut changed = Vec::new();
        for (i, &next) in nexts.iter().enumerate() {
            if let Some(when) = when {
                let was = build.bdd.var(build.now[i])?;
                let kept = build.bdd.equal(was, next)?;
                if build.bdd.and(when, !kept)? == Edge::FALSE {
                    continue;
                }
            }
            let then = build.then[i];
            let var = build.bdd.var(then)?;
            updates.push((then, build.bdd.equal(var, next)?));
            defined.push((here(system.latches[build.latches[i]].next), var));
            changed.push(i);
        }
        let asked: Vec<Lit> = self.asked.iter().map(|&l| here(l)).collect();
        let mut claims = build.functions(graph, &asked, &defined)?;
        claims.push(Edge::TRUE);
        let definitions: Vec<(Var, Edge)> = build.cuts.iter().chain(&updates).copied().collect();
        for (question, function) in self.questions.iter_mut().zip(claims) {
            if function != Edge::FALSE {
                let mut parts = constraints.clone();
                parts.push(function);
                question.push(schedule::with_definitions(&build.bdd, parts, &definitions));
            }
        }
        // What changes nothing leads nowhere.
        if !(changed.is_empty() && kind.is_some_and(|(_, known)| known.is_other)) {
            let parts = constraints.iter().copied().chain(definitions.iter().map(|d| d.1)).collect();
            self.changes.push(Change { parts, changed });
        }
        Ok(())
    }
}
