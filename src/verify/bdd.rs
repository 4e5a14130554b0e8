//! Sets of states as binary decision diagrams (Bryant, 1986), with complemented edges (Brace, Rudell,
//! Bryant, 1990).
//!
//! Our own and small, because of what it has to do: no unsafe code, the same result in every run, a
//! bound on memory that is met at once, and an end when it is told to stop. Equal functions are one
//! edge. What is not kept is lost at the next [`Bdd::collect`].

use super::count::Count;
use super::limits::{Limit, Stop};
use std::collections::HashMap;
use std::ops::Not;

/// A function: a node, or its opposite if the lowest bit is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Edge(u32);

impl Edge {
    /// The function that is TRUE everywhere.
    pub const TRUE: Edge = Edge(0);
    /// The function that is FALSE everywhere.
    pub const FALSE: Edge = Edge(1);

    fn node(self) -> usize {
        (self.0 >> 1) as usize
    }

    fn is_negated(self) -> bool {
        self.0 & 1 == 1
    }

    /// `self`, or its opposite if `negate`.
    #[must_use]
    pub fn xor(self, negate: bool) -> Edge {
        Edge(self.0 ^ u32::from(negate))
    }

    /// Whether it is one of the two constants.
    pub fn is_constant(self) -> bool {
        self.node() == 0
    }
}

impl Not for Edge {
    type Output = Edge;
    fn not(self) -> Edge {
        self.xor(true)
    }
}

/// A variable. Its place in the order is its level, which is another number.
pub type Var = u32;

/// The terminal stands below all variables.
const BOTTOM: u32 = u32::MAX;
/// Ends a chain.
const NONE: u32 = u32::MAX;

/// `high` is never negated: that makes equal functions equal edges.
#[derive(Clone, Copy)]
struct Node {
    var: Var,
    low: Edge,
    high: Edge,
    /// The next one of the same bucket, or of the free list.
    next: u32,
}

#[derive(Clone, Copy)]
struct Entry {
    key: (u32, u32, u32),
    value: Edge,
}

/// What tells conjunctions, shifts and restrictions apart in the cache; no cube has these numbers.
const AND: u32 = u32::MAX;
const SHIFT: u32 = u32::MAX - 1;
const RESTRICT: u32 = u32::MAX - 2;

/// How many operations pass between two looks at the clock.
const PATIENCE: u64 = 1 << 14;

/// A store of diagrams.
pub struct Bdd<'a> {
    nodes: Vec<Node>,
    buckets: Vec<u32>,
    free: u32,
    live: usize,
    /// Nodes that there may be at once.
    budget: usize,
    level: Vec<u32>,
    cache: Vec<Entry>,
    stop: Stop<'a>,
    /// Operations that may still follow.
    steps: u64,
}

impl<'a> Bdd<'a> {
    /// A store of at most `budget` nodes, for that many operations, and no variables yet.
    pub fn new(budget: usize, steps: u64, stop: Stop<'a>) -> Self {
        let terminal = Node { var: BOTTOM, low: Edge::TRUE, high: Edge::TRUE, next: NONE };
        Bdd {
            nodes: vec![terminal],
            buckets: vec![NONE; 1 << 10],
            free: NONE,
            live: 1,
            budget,
            level: Vec::new(),
            cache: vec![Entry { key: (0, 0, 0), value: Edge::FALSE }; 1 << 12],
            stop,
            steps,
        }
    }

    /// A new variable at that level; those from there on move down by one.
    pub fn insert(&mut self, level: u32) -> Var {
        self.level.iter_mut().filter(|l| **l >= level).for_each(|l| *l += 1);
        self.level.push(level);
        (self.level.len() - 1) as u32
    }

    /// How many variables there are.
    pub fn variables(&self) -> u32 {
        self.level.len() as u32
    }

    /// The place of a variable in the order.
    pub fn level(&self, var: Var) -> u32 {
        self.level[var as usize]
    }

    /// Whether half of the nodes that there may be are taken, by dead ones as well.
    pub fn is_half_full(&self) -> bool {
        self.live > self.budget / 2
    }

    fn level_of(&self, e: Edge) -> u32 {
        match self.nodes[e.node()].var {
            BOTTOM => BOTTOM,
            var => self.level[var as usize],
        }
    }

    /// Both cofactors by the variable of that level.
    fn split(&self, e: Edge, level: u32) -> (Edge, Edge) {
        if self.level_of(e) == level {
            let node = self.nodes[e.node()];
            (node.low.xor(e.is_negated()), node.high.xor(e.is_negated()))
        } else {
            (e, e)
        }
    }

    /// The variable that is asked first, and both cofactors; nothing for a constant.
    fn top(&self, e: Edge) -> Option<(Var, Edge, Edge)> {
        let node = self.nodes[e.node()];
        (node.var != BOTTOM).then(|| (node.var, node.low.xor(e.is_negated()), node.high.xor(e.is_negated())))
    }

    /// The function of one variable.
    pub fn var(&mut self, var: Var) -> Result<Edge, Limit> {
        self.node(var, Edge::FALSE, Edge::TRUE)
    }

    fn node(&mut self, var: Var, low: Edge, high: Edge) -> Result<Edge, Limit> {
        if low == high {
            return Ok(low);
        }
        if high.is_negated() {
            return Ok(!self.node(var, !low, !high)?);
        }
        let bucket = self.bucket(var, low, high);
        let mut at = self.buckets[bucket];
        while at != NONE {
            let n = self.nodes[at as usize];
            if n.var == var && n.low == low && n.high == high {
                return Ok(Edge(at << 1));
            }
            at = n.next;
        }
        if self.live >= self.budget {
            return Err(Limit::Nodes);
        }
        self.live += 1;
        let fresh = Node { var, low, high, next: self.buckets[bucket] };
        let index = if self.free == NONE {
            self.nodes.push(fresh);
            (self.nodes.len() - 1) as u32
        } else {
            let index = self.free;
            self.free = self.nodes[index as usize].next;
            self.nodes[index as usize] = fresh;
            index
        };
        self.buckets[bucket] = index;
        if self.live > self.buckets.len() {
            self.grow();
        }
        Ok(Edge(index << 1))
    }

    fn bucket(&self, var: Var, low: Edge, high: Edge) -> usize {
        mix(var, low.0, high.0) & (self.buckets.len() - 1)
    }

    /// Twice the buckets, and a cache to fit.
    fn grow(&mut self) {
        self.buckets = vec![NONE; self.buckets.len() * 2];
        self.chain(|_| true);
        if self.cache.len() < 1 << 20 {
            self.cache = vec![Entry { key: (0, 0, 0), value: Edge::FALSE }; self.cache.len() * 2];
        }
    }

    /// Chains those nodes that are kept anew and frees the others.
    fn chain(&mut self, keep: impl Fn(usize) -> bool) {
        self.buckets.fill(NONE);
        self.free = NONE;
        self.live = 1;
        for index in (1..self.nodes.len()).rev() {
            let Node { var, low, high, .. } = self.nodes[index];
            // A free node has the terminal's variable.
            if var != BOTTOM && keep(index) {
                let bucket = self.bucket(var, low, high);
                self.nodes[index].next = self.buckets[bucket];
                self.buckets[bucket] = index as u32;
                self.live += 1;
            } else {
                self.nodes[index] = Node { var: BOTTOM, low: Edge::TRUE, high: Edge::TRUE, next: self.free };
                self.free = index as u32;
            }
        }
    }

    /// Frees all that no root needs.
    pub fn collect(&mut self, roots: impl IntoIterator<Item = Edge>) {
        let mut keep = vec![false; self.nodes.len()];
        let mut open: Vec<usize> = roots.into_iter().map(Edge::node).collect();
        while let Some(n) = open.pop() {
            if !std::mem::replace(&mut keep[n], true) {
                open.extend([self.nodes[n].low.node(), self.nodes[n].high.node()]);
            }
        }
        self.chain(|n| keep[n]);
        self.cache.fill(Entry { key: (0, 0, 0), value: Edge::FALSE });
    }

    fn known(&self, key: (u32, u32, u32)) -> Option<Edge> {
        let entry = self.cache[mix(key.0, key.1, key.2) & (self.cache.len() - 1)];
        (entry.key == key).then_some(entry.value)
    }

    fn remember(&mut self, key: (u32, u32, u32), value: Edge) {
        let slot = mix(key.0, key.1, key.2) & (self.cache.len() - 1);
        self.cache[slot] = Entry { key, value };
    }

    fn tick(&mut self) -> Result<(), Limit> {
        if self.steps == 0 {
            return Err(Limit::Steps);
        }
        self.steps -= 1;
        if self.steps.is_multiple_of(PATIENCE) && (self.stop)() {
            return Err(Limit::Stopped);
        }
        Ok(())
    }

    /// Whether both are TRUE.
    pub fn and(&mut self, f: Edge, g: Edge) -> Result<Edge, Limit> {
        if f == g || g == Edge::TRUE {
            return Ok(f);
        }
        if f == Edge::TRUE {
            return Ok(g);
        }
        if f == !g || f == Edge::FALSE || g == Edge::FALSE {
            return Ok(Edge::FALSE);
        }
        let key = (f.0.min(g.0), f.0.max(g.0), AND);
        if let Some(known) = self.known(key) {
            return Ok(known);
        }
        self.tick()?;
        let level = self.level_of(f).min(self.level_of(g));
        let var = if self.level_of(f) == level { self.nodes[f.node()].var } else { self.nodes[g.node()].var };
        let ((f0, f1), (g0, g1)) = (self.split(f, level), self.split(g, level));
        let low = self.and(f0, g0)?;
        let high = self.and(f1, g1)?;
        let result = self.node(var, low, high)?;
        self.remember(key, result);
        Ok(result)
    }

    /// Whether one is TRUE.
    pub fn or(&mut self, f: Edge, g: Edge) -> Result<Edge, Limit> {
        Ok(!self.and(!f, !g)?)
    }

    /// Whether both are the same.
    pub fn equal(&mut self, f: Edge, g: Edge) -> Result<Edge, Limit> {
        let both = self.and(f, g)?;
        let none = self.and(!f, !g)?;
        self.or(both, none)
    }

    /// The conjunction of variables, to be quantified.
    pub fn cube(&mut self, vars: &[Var]) -> Result<Edge, Limit> {
        let mut vars = vars.to_vec();
        vars.sort_by_key(|&v| std::cmp::Reverse(self.level[v as usize]));
        let mut cube = Edge::TRUE;
        for v in vars {
            cube = self.node(v, Edge::FALSE, cube)?;
        }
        Ok(cube)
    }

    /// Whether values of the cube's variables exist for which `f` is TRUE.
    pub fn exists(&mut self, f: Edge, cube: Edge) -> Result<Edge, Limit> {
        self.and_exists(Edge::TRUE, f, cube)
    }

    /// Whether values of the cube's variables exist for which both are TRUE: the relational product.
    pub fn and_exists(&mut self, f: Edge, g: Edge, cube: Edge) -> Result<Edge, Limit> {
        if f == Edge::FALSE || g == Edge::FALSE || f == !g {
            return Ok(Edge::FALSE);
        }
        if f == Edge::TRUE && g == Edge::TRUE {
            return Ok(Edge::TRUE);
        }
        let level = self.level_of(f).min(self.level_of(g));
        let mut cube = cube;
        while self.level_of(cube) < level {
            cube = self.nodes[cube.node()].high;
        }
        if cube == Edge::TRUE {
            return self.and(f, g);
        }
        let key = (f.0.min(g.0), f.0.max(g.0), cube.0);
        if let Some(known) = self.known(key) {
            return Ok(known);
        }
        self.tick()?;
        let var = if self.level_of(f) == level { self.nodes[f.node()].var } else { self.nodes[g.node()].var };
        let ((f0, f1), (g0, g1)) = (self.split(f, level), self.split(g, level));
        let low = self.and_exists(f0, g0, cube)?;
        let result = if self.level_of(cube) == level {
            if low == Edge::TRUE {
                Edge::TRUE
            } else {
                let high = self.and_exists(f1, g1, cube)?;
                self.or(low, high)?
            }
        } else {
            let high = self.and_exists(f1, g1, cube)?;
            self.node(var, low, high)?
        };
        self.remember(key, result);
        Ok(result)
    }

    /// A function that is `f` where `care` is TRUE, and whatever makes it small elsewhere (Coudert, Madre, 1990).
    pub fn restrict(&mut self, f: Edge, care: Edge) -> Result<Edge, Limit> {
        if care == Edge::TRUE || f.is_constant() {
            return Ok(f);
        }
        if f == care || f == !care {
            return Ok(if f == care { Edge::TRUE } else { Edge::FALSE });
        }
        let key = (f.0, care.0, RESTRICT);
        if let Some(known) = self.known(key) {
            return Ok(known);
        }
        self.tick()?;
        let level = self.level_of(f);
        let result = if self.level_of(care) < level {
            let (_, c0, c1) = self.top(care).expect("it is no constant");
            let care = self.or(c0, c1)?;
            self.restrict(f, care)?
        } else {
            let var = self.nodes[f.node()].var;
            let ((f0, f1), (c0, c1)) = (self.split(f, level), self.split(care, level));
            if c0 == Edge::FALSE {
                self.restrict(f1, c1)?
            } else if c1 == Edge::FALSE {
                self.restrict(f0, c0)?
            } else {
                let (low, high) = (self.restrict(f0, c0)?, self.restrict(f1, c1)?);
                self.node(var, low, high)?
            }
        };
        self.remember(key, result);
        Ok(result)
    }

    /// `f` with each variable replaced by what `to` says. The order of the variables that `f` reads must
    /// not change by that; `id` is a number of the replacement.
    pub fn shift(&mut self, f: Edge, to: &[Var], id: u32) -> Result<Edge, Limit> {
        let Some((var, low, high)) = self.top(f) else { return Ok(f) };
        let key = (f.0, id, SHIFT);
        if let Some(known) = self.known(key) {
            return Ok(known);
        }
        self.tick()?;
        let (low, high) = (self.shift(low, to, id)?, self.shift(high, to, id)?);
        let result = self.node(to[var as usize], low, high)?;
        self.remember(key, result);
        Ok(result)
    }

    /// The variables that `f` reads, in order of their numbers.
    pub fn support(&self, f: Edge) -> Vec<Var> {
        let mut seen = std::collections::HashSet::new();
        let mut vars = vec![false; self.level.len()];
        let mut open = vec![f.node()];
        while let Some(n) = open.pop() {
            if n != 0 && seen.insert(n) {
                vars[self.nodes[n].var as usize] = true;
                open.extend([self.nodes[n].low.node(), self.nodes[n].high.node()]);
            }
        }
        (0..self.level.len() as u32).filter(|&v| vars[v as usize]).collect()
    }

    /// How many nodes `f` has, or `most` if it has more.
    pub fn size(&self, f: Edge, most: usize) -> usize {
        let mut seen = std::collections::HashSet::new();
        let mut open = vec![f.node()];
        while let Some(n) = open.pop() {
            if n != 0 && seen.insert(n) {
                if seen.len() >= most {
                    return most;
                }
                open.extend([self.nodes[n].low.node(), self.nodes[n].high.node()]);
            }
        }
        seen.len()
    }

    /// Values of variables for which `f`, which is not FALSE, is TRUE; others may have any. FALSE is
    /// preferred.
    pub fn pick(&self, f: Edge) -> Vec<(Var, bool)> {
        let mut values = Vec::new();
        let mut at = f;
        while let Some((var, low, high)) = self.top(at) {
            let value = low == Edge::FALSE;
            values.push((var, value));
            at = if value { high } else { low };
        }
        values
    }

    /// For how many assignments of `vars` the function is TRUE. It reads no others.
    pub fn count(&self, f: Edge, vars: &[Var]) -> Count {
        let mut levels: Vec<u32> = vars.iter().map(|&v| self.level[v as usize]).collect();
        levels.sort_unstable();
        let rank = |level: u32| levels.partition_point(|&l| l < level);
        let mut known = HashMap::new();
        let below = self.count_below(f, &rank, &mut known);
        below.doubled(rank(self.level_of(f)))
    }

    /// The same over the variables from its own on.
    fn count_below(&self, f: Edge, rank: &impl Fn(u32) -> usize, known: &mut HashMap<Edge, Count>) -> Count {
        let Some((_, low, high)) = self.top(f) else {
            return if f == Edge::TRUE { Count::one() } else { Count::default() };
        };
        if let Some(count) = known.get(&f) {
            return count.clone();
        }
        let own = rank(self.level_of(f));
        let mut side = |e: Edge| self.count_below(e, rank, known).doubled(rank(self.level_of(e)) - own - 1);
        let count = side(low).plus(&side(high));
        known.insert(f, count.clone());
        count
    }
}

fn mix(a: u32, b: u32, c: u32) -> usize {
    let mut x = (u64::from(a) << 32 | u64::from(b)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x ^= x >> 29;
    x = (x ^ u64::from(c)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (x ^ x >> 32) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The function of three variables with that truth table.
    fn function(bdd: &mut Bdd<'_>, table: u32) -> Result<Edge, Limit> {
        let mut f = Edge::FALSE;
        for row in (0..8).filter(|row| table >> row & 1 == 1) {
            let mut only = Edge::TRUE;
            for var in 0..3 {
                let is = bdd.var(var)?.xor(row >> var & 1 == 0);
                only = bdd.and(only, is)?;
            }
            f = bdd.or(f, only)?;
        }
        Ok(f)
    }

    #[test]
    fn what_is_restricted_is_the_same_where_one_cares() -> Result<(), Limit> {
        let mut bdd = Bdd::new(10_000, u64::MAX, &|| false);
        for level in 0..3 {
            bdd.insert(level);
        }
        let mut smaller = 0;
        for f in 0..256 {
            let f = function(&mut bdd, f)?;
            for care in 1..256 {
                let care = function(&mut bdd, care)?;
                let restricted = bdd.restrict(f, care)?;
                assert_eq!(bdd.and(restricted, care)?, bdd.and(f, care)?);
                smaller += usize::from(bdd.size(restricted, 100) < bdd.size(f, 100));
            }
        }
        assert!(smaller > 10_000, "{smaller}");
        Ok(())
    }
}
