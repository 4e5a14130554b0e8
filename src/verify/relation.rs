//! A system to a relation between states before and after a scan, in parts.
//!
//! The parts are never put together: the image of a set meets them one after another, and what no
//! later part reads is quantified at once (Burch, Clarke, Long, 1991; Ranjan et al., 1995). Where a gate
//! is large and several others read it, it becomes a variable of its own, with a part that says what it
//! is: shared functions are not multiplied out.

use super::aig::{Lit, Node};
use super::bdd::{Bdd, Edge, Var};
use super::limits::{Limit, Limits, Stop};
use super::order;
use super::system::System;
use std::collections::{HashMap, HashSet};

/// A gate that has more nodes than this and is read more than once becomes a variable.
const CUT: usize = 400;

/// Parts are put together up to this many nodes.
const CLUSTER: usize = 2_000;

/// A relation over the latches that claims depend on.
pub struct Relation<'a> {
    /// The diagrams.
    pub bdd: Bdd<'a>,
    /// Indices of those latches of the system that matter.
    pub latches: Vec<usize>,
    /// For each of these, its variable before the scan.
    pub now: Vec<Var>,
    /// For each of these, its variable after the scan.
    pub then: Vec<Var>,
    /// States before any scan.
    pub initial: Edge,
    /// For each literal asked for, and last for TRUE, what it takes to find the states from which inputs exist that satisfy
    /// the constraints and make it TRUE.
    asked: Vec<Asked>,
    forward: Schedule,
    backward: Schedule,
    to_now: Vec<Var>,
    to_then: Vec<Var>,
}

/// How to find out about a literal: whether any state of a set will do, and which.
struct Asked {
    whether: Schedule,
    which: Schedule,
}

/// In which order a set meets the parts, and what is quantified with each.
struct Schedule {
    /// What no part reads, quantified before all.
    before: Edge,
    parts: Vec<(Edge, Edge)>,
}

impl<'a> Relation<'a> {
    /// The relation, and what it takes to find out what is possible of `asked`.
    pub fn new(system: &System, asked: &[Lit], limits: &Limits, stop: Stop<'a>) -> Result<Self, Limit> {
        let mut build = Build::new(system, asked, limits, stop);
        let mut roots: Vec<Lit> = system.constraints.clone();
        roots.extend(build.latches.iter().map(|&l| system.latches[l].next));
        let images = build.functions(&roots, &[])?;
        let (constraints, nexts) = images.split_at(system.constraints.len());
        let constraints = constraints.to_vec();
        // What a latch will be need not be worked out again where something reads it.
        let mut defined = Vec::new();
        let mut updates = Vec::new();
        for (i, (&next, &then)) in nexts.iter().zip(&build.then.clone()).enumerate() {
            let var = build.bdd.var(then)?;
            updates.push((then, build.bdd.equal(var, next)?));
            defined.push((system.latches[build.latches[i]].next, var));
        }
        let mut claims = build.functions(asked, &defined)?;
        claims.push(Edge::TRUE);
        let Build { mut bdd, latches, now, then, given, cuts, .. } = build;
        let definitions: Vec<(Var, Edge)> = cuts.iter().chain(&updates).copied().collect();
        let everything: Vec<Var> = (0..bdd.variables()).collect();
        let hidden: Vec<Var> = given.iter().chain(&then).copied().collect();
        let mut asked = Vec::new();
        for function in claims {
            let mut parts = constraints.clone();
            parts.push(function);
            let parts = with_definitions(&bdd, parts, &definitions);
            asked.push(Asked {
                whether: Schedule::new(&mut bdd, &parts, &everything)?,
                which: Schedule::new(&mut bdd, &parts, &hidden)?,
            });
        }
        let parts = constraints.iter().copied().chain(definitions.iter().map(|d| d.1)).collect();
        let parts = cluster(&mut bdd, parts)?;
        let quantify = |vars: &[Var]| -> Vec<Var> { vars.iter().chain(&given).copied().collect() };
        let forward = Schedule::new(&mut bdd, &parts, &quantify(&now))?;
        let backward = Schedule::new(&mut bdd, &parts, &quantify(&then))?;
        let mut initial = Edge::TRUE;
        for (&l, &var) in latches.iter().zip(&now) {
            if let Some(value) = system.latches[l].initial {
                let var = bdd.var(var)?;
                initial = bdd.and(initial, var.xor(!value))?;
            }
        }
        let mut to_now: Vec<Var> = everything.clone();
        let mut to_then = everything;
        for (&now, &then) in now.iter().zip(&then) {
            to_now[then as usize] = now;
            to_then[now as usize] = then;
        }
        Ok(Relation { bdd, latches, now, then, initial, asked, forward, backward, to_now, to_then })
    }

    /// Whether the literal of that index is possible in one of the states; `keep` must not be lost.
    pub fn is_possible(&mut self, asked: usize, states: Edge, keep: &[Edge]) -> Result<bool, Limit> {
        let keep = self.roots(keep);
        Ok(self.asked[asked].whether.meet(&mut self.bdd, states, &keep)? != Edge::FALSE)
    }

    /// Those of the states in which it is.
    pub fn possible(&mut self, asked: usize, states: Edge, keep: &[Edge]) -> Result<Edge, Limit> {
        let keep = self.roots(&[keep, &[states]].concat());
        let found = self.asked[asked].which.meet(&mut self.bdd, states, &keep)?;
        self.bdd.and(found, states)
    }

    /// The index to ask whether anything is possible.
    pub fn anything(&self) -> usize {
        self.asked.len() - 1
    }

    /// The states after one scan from `from`.
    pub fn image(&mut self, from: Edge, keep: &[Edge]) -> Result<Edge, Limit> {
        let keep = self.roots(keep);
        let after = self.forward.meet(&mut self.bdd, from, &keep)?;
        self.bdd.shift(after, &self.to_now, 0)
    }

    /// The states from which one scan can lead to `to`.
    pub fn preimage(&mut self, to: Edge, keep: &[Edge]) -> Result<Edge, Limit> {
        let keep = self.roots(keep);
        let to = self.bdd.shift(to, &self.to_then, 1)?;
        self.backward.meet(&mut self.bdd, to, &keep)
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
        let asked = self.asked.iter().flat_map(|a| [&a.whether, &a.which]);
        for schedule in [&self.forward, &self.backward].into_iter().chain(asked) {
            roots.push(schedule.before);
            roots.extend(schedule.parts.iter().flat_map(|&(part, cube)| [part, cube]));
        }
        roots
    }
}

impl Schedule {
    /// Greedy: next comes the part after which most can be quantified, and that brings in the least.
    fn new(bdd: &mut Bdd<'_>, parts: &[Edge], quantify: &[Var]) -> Result<Schedule, Limit> {
        let quantify: HashSet<Var> = quantify.iter().copied().collect();
        let support: Vec<Vec<Var>> = parts.iter().map(|&p| bdd.support(p)).collect();
        let mut readers = vec![0usize; bdd.variables() as usize];
        support.iter().flatten().for_each(|&v| readers[v as usize] += 1);
        let mut unread: Vec<Var> = quantify.iter().copied().filter(|&v| readers[v as usize] == 0).collect();
        unread.sort_unstable();
        let before = bdd.cube(&unread)?;
        let mut seen: HashSet<Var> = HashSet::new();
        let mut left: Vec<usize> = (0..parts.len()).collect();
        let mut schedule = Schedule { before, parts: Vec::new() };
        while !left.is_empty() {
            let cost = |&p: &usize| -> (i64, usize) {
                let ends = |v: &&Var| quantify.contains(v) && readers[**v as usize] == 1;
                let fresh = |v: &&Var| !quantify.contains(v) && !seen.contains(v);
                let ends = support[p].iter().filter(ends).count() as i64;
                let fresh = support[p].iter().filter(fresh).count() as i64;
                let open = support[p].iter().filter(|v| quantify.contains(v) && !seen.contains(v)).count() as i64;
                (fresh * 2 + open - ends * 3, p)
            };
            let next = *left.iter().min_by_key(|p| cost(p)).expect("there is one left");
            left.retain(|&p| p != next);
            support[next].iter().for_each(|&v| readers[v as usize] -= 1);
            seen.extend(&support[next]);
            let ended: Vec<Var> =
                support[next].iter().copied().filter(|&v| quantify.contains(&v) && readers[v as usize] == 0).collect();
            let cube = bdd.cube(&ended)?;
            schedule.parts.push((parts[next], cube));
        }
        Ok(schedule)
    }

    /// What is left of `set` when it has met all parts. Makes room where it has to; `keep` stays.
    fn meet(&self, bdd: &mut Bdd<'_>, set: Edge, keep: &[Edge]) -> Result<Edge, Limit> {
        let mut set = bdd.exists(set, self.before)?;
        for &(part, cube) in &self.parts {
            set = match bdd.and_exists(set, part, cube) {
                Err(Limit::Nodes) if !keep.is_empty() => {
                    bdd.collect(keep.iter().copied().chain([set]));
                    bdd.and_exists(set, part, cube)?
                }
                other => other?,
            };
        }
        Ok(set)
    }
}

/// The parts, and the definitions of what they read.
fn with_definitions(bdd: &Bdd<'_>, mut parts: Vec<Edge>, definitions: &[(Var, Edge)]) -> Vec<Edge> {
    let mut open: HashMap<Var, Edge> = definitions.iter().copied().collect();
    let mut at = 0;
    while at < parts.len() {
        for var in bdd.support(parts[at]) {
            parts.extend(open.remove(&var));
        }
        at += 1;
    }
    parts
}

/// Puts neighbouring parts together while they stay small.
fn cluster(bdd: &mut Bdd<'_>, mut parts: Vec<Edge>) -> Result<Vec<Edge>, Limit> {
    parts.retain(|&p| p != Edge::TRUE);
    // Parts that begin at similar levels share variables.
    let mut keyed: Vec<(u32, usize, Edge)> = Vec::new();
    for (i, &part) in parts.iter().enumerate() {
        let lowest = bdd.support(part).iter().map(|&v| bdd.level(v)).max().unwrap_or(0);
        keyed.push((lowest, i, part));
    }
    keyed.sort_unstable();
    let mut clusters: Vec<Edge> = Vec::new();
    for (_, _, part) in keyed {
        if let Some(last) = clusters.last_mut()
            && bdd.size(*last, CLUSTER) + bdd.size(part, CLUSTER) < CLUSTER
        {
            let both = bdd.and(*last, part)?;
            if bdd.size(both, CLUSTER) < CLUSTER {
                *last = both;
                continue;
            }
        }
        clusters.push(part);
    }
    Ok(clusters)
}

/// Gates to diagrams.
struct Build<'s, 'a> {
    system: &'s System,
    bdd: Bdd<'a>,
    latches: Vec<usize>,
    now: Vec<Var>,
    then: Vec<Var>,
    /// Inputs, and gates that became variables.
    given: Vec<Var>,
    /// The gates that became variables, each with that it is what the gate says.
    cuts: Vec<(Var, Edge)>,
    rank: Vec<Option<u32>>,
    /// For each leaf's node, its variable.
    variable: Vec<Option<Var>>,
    /// Ranks of nodes that are variables, each with the variable, in order.
    ranked: Vec<(u32, Var)>,
}

impl<'s, 'a> Build<'s, 'a> {
    fn new(system: &'s System, asked: &[Lit], limits: &Limits, stop: Stop<'a>) -> Self {
        let roots: Vec<Lit> = system.constraints.iter().chain(asked).copied().collect();
        let (latches, inputs) = system.cone(&roots);
        let nexts = latches.iter().map(|&l| system.latches[l].next);
        let leaves = latches.iter().map(|&l| system.latches[l].leaf);
        let roots: Vec<Lit> = roots.iter().copied().chain(nexts).chain(leaves).collect();
        let rank = order::force(system, &latches, &system.aig.cone(&roots));
        let of_latches = latches.iter().map(|&l| (system.latches[l].leaf.node(), true));
        let of_inputs = inputs.iter().map(|&i| (system.inputs[i].leaf.node(), false));
        let mut leaves: Vec<(u32, usize, bool)> =
            of_latches.chain(of_inputs).map(|(n, latch)| (rank[n].expect("it is in the cone"), n, latch)).collect();
        leaves.sort_unstable();
        let mut build = Build {
            system,
            bdd: Bdd::new(limits.nodes, limits.steps, stop),
            latches,
            now: Vec::new(),
            then: Vec::new(),
            given: Vec::new(),
            cuts: Vec::new(),
            rank,
            variable: vec![None; system.aig.len()],
            ranked: Vec::new(),
        };
        let mut then = vec![0; system.aig.len()];
        for (rank, n, latch) in leaves {
            let var = build.bdd.insert(build.bdd.variables());
            build.variable[n] = Some(var);
            build.ranked.push((rank, var));
            if latch {
                // A latch's two values stand side by side.
                then[n] = build.bdd.insert(build.bdd.variables());
            } else {
                build.given.push(var);
            }
        }
        for &l in &build.latches {
            let n = system.latches[l].leaf.node();
            build.now.push(build.variable[n].expect("a latch has a variable"));
            build.then.push(then[n]);
        }
        build
    }

    /// The diagrams of `roots`, in which what is `known` need not be worked out.
    fn functions(&mut self, roots: &[Lit], known: &[(Lit, Edge)]) -> Result<Vec<Edge>, Limit> {
        let aig = &self.system.aig;
        let cone = aig.cone(roots);
        let mut readers = vec![0u32; aig.len()];
        for &n in &cone {
            if let Node::And(a, b) = aig.node(n) {
                readers[a.node()] += 1;
                readers[b.node()] += 1;
            }
        }
        roots.iter().for_each(|l| readers[l.node()] += 1);
        let mut image = vec![Edge::FALSE; aig.len()];
        let known: HashMap<usize, Edge> = known.iter().map(|&(l, e)| (l.node(), e.xor(l.is_negated()))).collect();
        for n in cone {
            if let (Some(&edge), Node::And(..)) = (known.get(&n), aig.node(n)) {
                image[n] = edge;
                continue;
            }
            image[n] = match aig.node(n) {
                Node::False => Edge::FALSE,
                Node::Leaf(_) => {
                    let var = self.variable[n].expect("leaves are latches and inputs");
                    self.bdd.var(var)?
                }
                Node::And(a, b) => {
                    let (a, b) = (image[a.node()].xor(a.is_negated()), image[b.node()].xor(b.is_negated()));
                    self.bdd.and(a, b)?
                }
            };
            if readers[n] > 1 && self.bdd.size(image[n], CUT) >= CUT {
                image[n] = self.cut(n, image[n])?;
            }
        }
        Ok(roots.iter().map(|l| image[l.node()].xor(l.is_negated())).collect())
    }

    /// Makes a variable of a gate, placed where the gate stands in the order.
    fn cut(&mut self, node: usize, function: Edge) -> Result<Edge, Limit> {
        let rank = self.rank[node].expect("a gate of the cone has a rank");
        let at = self.ranked.partition_point(|&(r, _)| r < rank);
        let level = self.ranked.get(at).map_or(self.bdd.variables(), |&(_, var)| self.bdd.level(var));
        let var = self.bdd.insert(level);
        self.ranked.insert(at, (rank, var));
        self.given.push(var);
        let edge = self.bdd.var(var)?;
        let definition = self.bdd.equal(edge, function)?;
        self.cuts.push((var, definition));
        Ok(edge)
    }
}
