//! And-inverter graphs: Boolean functions of many variables as one graph of two-input ANDs and
//! inverted edges.
//!
//! It is the one bit-level form of machines and programs: what is proved about either is a question
//! about literals of such a graph. Structurally equal functions are one node (hash-consing), constants
//! fold, and a node's operands always come before it, so a pass over the nodes in order of their
//! index meets everything after what it depends on.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::ops::Not;

/// A node of an [`Aig`] or its opposite.
///
/// The index of the node is shifted left by one, the lowest bit says whether the opposite is meant.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Lit(u32);

impl Lit {
    /// FALSE in every graph.
    pub const FALSE: Lit = Lit(0);
    /// TRUE in every graph.
    pub const TRUE: Lit = Lit(1);

    /// The index of the node.
    #[inline]
    pub fn node(self) -> usize {
        (self.0 >> 1) as usize
    }

    /// Whether the opposite of the node is meant.
    #[inline]
    pub fn is_negated(self) -> bool {
        self.0 & 1 == 1
    }

    /// The value if it is constant.
    pub fn constant(self) -> Option<bool> {
        (self.node() == 0).then_some(self == Lit::TRUE)
    }

    /// `self`, or its opposite if `negate`.
    #[must_use]
    pub fn xor(self, negate: bool) -> Lit {
        Lit(self.0 ^ u32::from(negate))
    }

    /// The constant.
    pub fn of(value: bool) -> Lit {
        Lit::FALSE.xor(value)
    }

    fn of_node(node: usize) -> Lit {
        Lit(u32::try_from(node << 1).expect("a graph holds fewer than 2^31 nodes"))
    }
}

impl Not for Lit {
    type Output = Lit;
    fn not(self) -> Lit {
        self.xor(true)
    }
}

impl std::fmt::Debug for Lit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}", if self.is_negated() { "!" } else { "" }, self.node())
    }
}

/// What a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Node {
    /// FALSE: only the first node.
    False,
    /// A free variable: the leaf of that number.
    Leaf(u32),
    /// The conjunction of two literals of earlier nodes.
    And(Lit, Lit),
}

/// A graph.
#[derive(Clone, Debug)]
pub struct Aig {
    nodes: Vec<Node>,
    leaves: Vec<u32>,
    names: Vec<String>,
    known: HashMap<(Lit, Lit), u32, BuildHasherDefault<Mixer>>,
}

impl Default for Aig {
    fn default() -> Self {
        Aig::new()
    }
}

impl Aig {
    /// A graph of constants only.
    pub fn new() -> Self {
        Aig { nodes: vec![Node::False], leaves: Vec::new(), names: Vec::new(), known: HashMap::default() }
    }

    /// How many nodes there are, the constant and the leaves included.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is nothing but the constant.
    pub fn is_empty(&self) -> bool {
        self.nodes.len() == 1
    }

    /// What the node of that index is.
    #[inline]
    pub fn node(&self, index: usize) -> Node {
        self.nodes[index]
    }

    /// All leaves, in order of creation.
    pub fn leaves(&self) -> impl ExactSizeIterator<Item = Lit> + '_ {
        self.leaves.iter().map(|&n| Lit::of_node(n as usize))
    }

    /// The name of the leaf of that number.
    pub fn name(&self, leaf: u32) -> &str {
        &self.names[leaf as usize]
    }

    /// A new free variable. The name is for people; nothing demands that it be unique.
    pub fn leaf(&mut self, name: impl Into<String>) -> Lit {
        let node = self.nodes.len();
        let leaf = u32::try_from(self.leaves.len()).expect("a graph holds fewer than 2^31 nodes");
        self.nodes.push(Node::Leaf(leaf));
        self.leaves.push(node as u32);
        self.names.push(name.into());
        Lit::of_node(node)
    }

    /// The operands if the literal is a conjunction, not negated.
    fn operands(&self, l: Lit) -> Option<(Lit, Lit)> {
        match self.nodes[l.node()] {
            Node::And(a, b) if !l.is_negated() => Some((a, b)),
            _ => None,
        }
    }

    /// Whether both are TRUE.
    pub fn and(&mut self, mut a: Lit, mut b: Lit) -> Lit {
        // Rules that look at operands of operands (Brummayer and Biere, 2006). Substitution makes one
        // of the two smaller and starts again, so the loop ends.
        loop {
            if a == b {
                return a;
            }
            if a == !b || a == Lit::FALSE || b == Lit::FALSE {
                return Lit::FALSE;
            }
            if a == Lit::TRUE {
                return b;
            }
            if b == Lit::TRUE {
                return a;
            }
            match self.fold(a, b).or_else(|| self.fold(b, a)) {
                Some(Folded::To(l)) => return l,
                Some(Folded::Pair(l, r)) => (a, b) = (l, r),
                None => break,
            }
        }
        let key = if a < b { (a, b) } else { (b, a) };
        if let Some(&node) = self.known.get(&key) {
            return Lit::of_node(node as usize);
        }
        let node = self.nodes.len();
        self.nodes.push(Node::And(key.0, key.1));
        self.known.insert(key, node as u32);
        Lit::of_node(node)
    }

    /// What `a and b` comes down to when the operands of `a` tell.
    fn fold(&self, a: Lit, b: Lit) -> Option<Folded> {
        if let Some((x, y)) = self.operands(a) {
            if b == !x || b == !y {
                return Some(Folded::To(Lit::FALSE));
            }
            if b == x || b == y {
                return Some(Folded::To(a));
            }
            if let Some((u, v)) = self.operands(b)
                && (x == !u || x == !v || y == !u || y == !v)
            {
                return Some(Folded::To(Lit::FALSE));
            }
        }
        if let Some((x, y)) = self.operands(!a) {
            // not (x and y) and b
            if b == !x || b == !y {
                return Some(Folded::To(b));
            }
            if b == x {
                return Some(Folded::Pair(!y, b));
            }
            if b == y {
                return Some(Folded::Pair(!x, b));
            }
            if let Some((u, v)) = self.operands(b) {
                if u == !x || u == !y || v == !x || v == !y {
                    return Some(Folded::To(b));
                }
                if u == x || v == x {
                    return Some(Folded::Pair(!y, b));
                }
                if u == y || v == y {
                    return Some(Folded::Pair(!x, b));
                }
            }
            if let Some((u, v)) = self.operands(!b) {
                // not (x and y) and not (x and not y) is not x.
                if (x == u && y == !v) || (x == v && y == !u) {
                    return Some(Folded::To(!x));
                }
                if (y == u && x == !v) || (y == v && x == !u) {
                    return Some(Folded::To(!y));
                }
            }
        }
        None
    }

    /// Whether one is TRUE.
    pub fn or(&mut self, a: Lit, b: Lit) -> Lit {
        !self.and(!a, !b)
    }

    /// Whether exactly one is TRUE.
    pub fn xor(&mut self, a: Lit, b: Lit) -> Lit {
        let left = self.and(a, !b);
        let right = self.and(!a, b);
        self.or(left, right)
    }

    /// Whether both are the same.
    pub fn equal(&mut self, a: Lit, b: Lit) -> Lit {
        !self.xor(a, b)
    }

    /// `then` if `condition`, else `otherwise`.
    pub fn select(&mut self, condition: Lit, then: Lit, otherwise: Lit) -> Lit {
        if then == otherwise {
            return then;
        }
        let left = self.and(condition, then);
        let right = self.and(!condition, otherwise);
        self.or(left, right)
    }

    /// Whether all are TRUE. Long lists become balanced trees, so that depth stays logarithmic.
    pub fn all(&mut self, lits: &[Lit]) -> Lit {
        match lits {
            [] => Lit::TRUE,
            [l] => *l,
            _ => {
                let (left, right) = lits.split_at(lits.len() / 2);
                let (left, right) = (self.all(left), self.all(right));
                self.and(left, right)
            }
        }
    }

    /// Whether one is TRUE.
    pub fn any(&mut self, lits: &[Lit]) -> Lit {
        match lits {
            [] => Lit::FALSE,
            [l] => *l,
            _ => {
                let (left, right) = lits.split_at(lits.len() / 2);
                let (left, right) = (self.any(left), self.any(right));
                self.or(left, right)
            }
        }
    }

    /// Whether more than one is TRUE. Linear in the number of literals.
    pub fn two_or_more(&mut self, lits: &[Lit]) -> Lit {
        let (mut one, mut two) = (Lit::FALSE, Lit::FALSE);
        for &l in lits {
            let both = self.and(one, l);
            two = self.or(two, both);
            one = self.or(one, l);
        }
        two
    }

    /// An expression, each of whose atoms `value` turns into a literal.
    pub fn expression<A>(&mut self, e: &crate::ir::expr::Expr<A>, value: &mut impl FnMut(&mut Aig, &A) -> Lit) -> Lit {
        use crate::ir::expr::Expr;
        match e {
            Expr::Const(c) => Lit::of(*c),
            Expr::Atom(a) => value(self, a),
            Expr::Not(e) => !self.expression(e, value),
            Expr::And(es) => {
                let parts: Vec<Lit> = es.iter().map(|e| self.expression(e, value)).collect();
                self.all(&parts)
            }
            Expr::Or(es) => {
                let parts: Vec<Lit> = es.iter().map(|e| self.expression(e, value)).collect();
                self.any(&parts)
            }
            Expr::Xor(l, r) => {
                let (l, r) = (self.expression(l, value), self.expression(r, value));
                self.xor(l, r)
            }
        }
    }

    /// The number of a leaf.
    ///
    /// # Panics
    ///
    /// If the literal is no leaf.
    pub fn number(&self, leaf: Lit) -> usize {
        match self.nodes[leaf.node()] {
            Node::Leaf(number) => number as usize,
            Node::False | Node::And(..) => panic!("a leaf is asked for"),
        }
    }

    /// Copies the functions `roots` of `from` into this graph, where `leaf` stands for each leaf that
    /// they reach; what comes back stands for the roots.
    pub fn import(&mut self, from: &Aig, roots: &[Lit], leaf: &mut impl FnMut(&mut Aig, u32) -> Lit) -> Vec<Lit> {
        let image = self.copy(from, roots, &mut |aig, n| match from.nodes[n] {
            Node::Leaf(number) => Some(leaf(aig, number)),
            Node::False | Node::And(..) => None,
        });
        roots.iter().map(|l| image[l.node()].xor(l.is_negated())).collect()
    }

    /// The functions that are left of `roots` where some literals are known: a graph with the same leaves, and what stands
    /// there for each node that the roots depend on.
    pub fn restrict(&self, roots: &[Lit], known: &[(Lit, bool)]) -> (Aig, Vec<Lit>) {
        let mut aig = Aig::new();
        let mut value = vec![None; self.len()];
        for (leaf, name) in self.leaves().zip(&self.names) {
            value[leaf.node()] = Some(aig.leaf(name.as_str()));
        }
        known.iter().for_each(|(l, v)| value[l.node()] = Some(Lit::of(*v != l.is_negated())));
        let image = aig.copy(self, roots, &mut |_, n| value[n]);
        (aig, image)
    }

    /// Copies what `roots` depend on; `given` says what stands for a node, for leaves at least. Returns what stands for each node.
    fn copy(&mut self, from: &Aig, roots: &[Lit], given: &mut impl FnMut(&mut Aig, usize) -> Option<Lit>) -> Vec<Lit> {
        let mut image = vec![Lit::FALSE; from.len()];
        for n in from.cone(roots) {
            image[n] = given(self, n).unwrap_or_else(|| match from.nodes[n] {
                Node::And(a, b) => self.and(image[a.node()].xor(a.is_negated()), image[b.node()].xor(b.is_negated())),
                Node::False | Node::Leaf(_) => Lit::FALSE,
            });
        }
        image
    }

    /// The nodes that `roots` depend on, themselves included, in topological order.
    pub fn cone(&self, roots: &[Lit]) -> Vec<usize> {
        let mut seen = vec![false; self.nodes.len()];
        let mut open: Vec<usize> = roots.iter().map(|l| l.node()).collect();
        let mut cone = Vec::new();
        while let Some(n) = open.pop() {
            if std::mem::replace(&mut seen[n], true) {
                continue;
            }
            cone.push(n);
            if let Node::And(a, b) = self.nodes[n] {
                open.extend([a.node(), b.node()]);
            }
        }
        cone.sort_unstable();
        cone
    }

    /// Evaluates 64 assignments at once: `leaves` holds a word for each leaf, bit `i` of each belongs
    /// to assignment `i`. Nodes that `values` has already keep their values, so a graph that has grown
    /// costs only what is new.
    pub fn simulate(&self, leaves: &[u64], values: &mut Vec<u64>) {
        values.reserve(self.nodes.len().saturating_sub(values.len()));
        for node in &self.nodes[values.len()..] {
            let word = match *node {
                Node::False => 0,
                Node::Leaf(number) => leaves[number as usize],
                Node::And(a, b) => lanes(values, a) & lanes(values, b),
            };
            values.push(word);
        }
    }
}

/// The 64 values of a literal after [`Aig::simulate`].
#[inline]
pub fn lanes(values: &[u64], l: Lit) -> u64 {
    values[l.node()] ^ if l.is_negated() { u64::MAX } else { 0 }
}

/// Rows to columns, so that bit `i` of word `j` becomes bit `j` of word `i` (Warren, Hacker's Delight, 7-3).
pub fn transpose(rows: &mut [u64; 64]) {
    let (mut j, mut mask) = (32, 0x0000_0000_ffff_ffffu64);
    while j != 0 {
        let mut k = 0;
        while k < 64 {
            let t = ((rows[k] >> j) ^ rows[k | j]) & mask;
            rows[k] ^= t << j;
            rows[k | j] ^= t;
            k = ((k | j) + 1) & !j;
        }
        j >>= 1;
        mask ^= mask << j;
    }
}

enum Folded {
    To(Lit),
    Pair(Lit, Lit),
}

/// Hashes pairs of literals: a multiplication and a fold. The same in every run.
#[derive(Default)]
struct Mixer(u64);

impl Hasher for Mixer {
    fn write(&mut self, bytes: &[u8]) {
        for &b in bytes {
            self.write_u32(u32::from(b));
        }
    }
    fn write_u32(&mut self, n: u32) {
        let x = (self.0.rotate_left(32) ^ u64::from(n)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = x ^ (x >> 29);
    }
    fn finish(&self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::expr::Expr;
    use proptest::prelude::*;

    fn expressions() -> impl Strategy<Value = Expr<u8>> {
        let leaf = prop_oneof![8 => (0u8..6).prop_map(Expr::Atom), 1 => any::<bool>().prop_map(Expr::Const)];
        leaf.prop_recursive(6, 60, 3, |inner| {
            prop_oneof![
                inner.clone().prop_map(|e| Expr::Not(Box::new(e))),
                prop::collection::vec(inner.clone(), 0..4).prop_map(Expr::And),
                prop::collection::vec(inner.clone(), 0..4).prop_map(Expr::Or),
                (inner.clone(), inner).prop_map(|(a, b)| Expr::Xor(Box::new(a), Box::new(b))),
            ]
        })
    }

    proptest! {
        #[test]
        fn a_graph_means_what_the_expression_means(e in expressions()) {
            let mut aig = Aig::new();
            let leaves: Vec<Lit> = (0..6).map(|i| aig.leaf(format!("x{i}"))).collect();
            let root = aig.expression(&e, &mut |_, a| leaves[*a as usize]);
            // Lane i is assignment i: the classic truth table words.
            let words: Vec<u64> = (0..6).map(|v| (0..64).filter(|i| i >> v & 1 == 1).fold(0, |w, i| w | 1 << i)).collect();
            let mut values = Vec::new();
            aig.simulate(&words, &mut values);
            for i in 0..64u64 {
                prop_assert_eq!(lanes(&values, root) >> i & 1 == 1, e.eval(&mut |a| i >> a & 1 == 1));
            }
        }
    }

    #[test]
    fn equal_structure_is_one_node() {
        let mut aig = Aig::new();
        let (a, b, c) = (aig.leaf("a"), aig.leaf("b"), aig.leaf("c"));
        let ab = aig.and(a, b);
        assert_eq!(ab, aig.and(b, a));
        assert_eq!(aig.and(ab, a), ab);
        assert_eq!(aig.and(ab, !a), Lit::FALSE);
        let (p, q) = (aig.and(a, c), aig.and(a, !c));
        assert_eq!(aig.or(p, q), a);
        let before = aig.len();
        let (x, y) = (aig.select(c, a, b), aig.select(!c, b, a));
        assert_eq!(x, y);
        assert!(aig.len() <= before + 3);
    }

    #[test]
    fn two_of_many_are_counted() {
        let mut aig = Aig::new();
        let leaves: Vec<Lit> = (0..5).map(|i| aig.leaf(format!("{i}"))).collect();
        let two = aig.two_or_more(&leaves);
        for bits in 0u32..32 {
            let words: Vec<u64> = (0..5).map(|v| u64::from(bits >> v & 1)).collect();
            let mut values = Vec::new();
            aig.simulate(&words, &mut values);
            assert_eq!(lanes(&values, two) & 1 == 1, bits.count_ones() > 1);
        }
    }

    #[test]
    fn an_import_with_constants_folds() {
        let mut from = Aig::new();
        let (a, b) = (from.leaf("a"), from.leaf("b"));
        let x = from.xor(a, b);
        let mut to = Aig::new();
        let c = to.leaf("c");
        let leaf = |_: &mut Aig, n| if n == 0 { Lit::TRUE } else { c };
        assert_eq!(to.import(&from, &[x, !x], &mut { leaf }), [!c, c]);
        assert_eq!(to.len(), 2);
    }
}
