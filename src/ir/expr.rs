//! Boolean expressions over atoms of any kind.
//!
//! One type serves guards over the things of a chart and conditions over the variables of a PLC
//! project; only the atoms differ. `And` and `Or` take any number of operands, so a long chain is
//! wide and not deep; depth is bounded by the nesting limit of the source.

use std::fmt;

/// A Boolean expression over atoms `A`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Expr<A> {
    /// TRUE or FALSE.
    Const(bool),
    /// The value of one atom.
    Atom(A),
    /// The opposite.
    Not(Box<Expr<A>>),
    /// TRUE when all operands are; TRUE without operands.
    And(Vec<Expr<A>>),
    /// TRUE when one operand is; FALSE without operands.
    Or(Vec<Expr<A>>),
    /// TRUE when exactly one of the two is.
    Xor(Box<Expr<A>>, Box<Expr<A>>),
}

impl<A> Expr<A> {
    /// Always TRUE.
    pub const TRUE: Expr<A> = Expr::Const(true);
    /// Always FALSE.
    pub const FALSE: Expr<A> = Expr::Const(false);

    /// The opposite of `self`; a double negation and constants fold.
    #[must_use]
    #[allow(clippy::should_implement_trait)]
    pub fn not(self) -> Self {
        match self {
            Expr::Const(c) => Expr::Const(!c),
            Expr::Not(e) => *e,
            e => Expr::Not(Box::new(e)),
        }
    }

    /// The conjunction of all; constants fold, nested conjunctions flatten.
    pub fn all(operands: impl IntoIterator<Item = Self>) -> Self {
        let mut list = Vec::new();
        for e in operands {
            match e {
                Expr::Const(true) => {}
                Expr::Const(false) => return Expr::FALSE,
                Expr::And(inner) => list.extend(inner),
                e => list.push(e),
            }
        }
        match list.len() {
            0 => Expr::TRUE,
            1 => list.remove(0),
            _ => Expr::And(list),
        }
    }

    /// The disjunction of all; constants fold, nested disjunctions flatten.
    pub fn any(operands: impl IntoIterator<Item = Self>) -> Self {
        let mut list = Vec::new();
        for e in operands {
            match e {
                Expr::Const(false) => {}
                Expr::Const(true) => return Expr::TRUE,
                Expr::Or(inner) => list.extend(inner),
                e => list.push(e),
            }
        }
        match list.len() {
            0 => Expr::FALSE,
            1 => list.remove(0),
            _ => Expr::Or(list),
        }
    }

    /// Exactly one of the two; constants fold.
    pub fn xor(left: Self, right: Self) -> Self {
        match (left, right) {
            (Expr::Const(a), e) | (e, Expr::Const(a)) => {
                if a {
                    e.not()
                } else {
                    e
                }
            }
            (l, r) => Expr::Xor(Box::new(l), Box::new(r)),
        }
    }

    /// The same expression over other atoms; `f` may put a whole expression for an atom.
    pub fn map<B>(&self, f: &mut impl FnMut(&A) -> Expr<B>) -> Expr<B> {
        match self {
            Expr::Const(c) => Expr::Const(*c),
            Expr::Atom(a) => f(a),
            Expr::Not(e) => e.map(f).not(),
            Expr::And(es) => Expr::all(es.iter().map(|e| e.map(f)).collect::<Vec<_>>()),
            Expr::Or(es) => Expr::any(es.iter().map(|e| e.map(f)).collect::<Vec<_>>()),
            Expr::Xor(l, r) => Expr::xor(l.map(f), r.map(f)),
        }
    }

    /// Calls `f` with every atom, from left to right, repetitions included.
    pub fn for_each_atom<'a>(&'a self, f: &mut impl FnMut(&'a A)) {
        match self {
            Expr::Const(_) => {}
            Expr::Atom(a) => f(a),
            Expr::Not(e) => e.for_each_atom(f),
            Expr::And(es) | Expr::Or(es) => es.iter().for_each(|e| e.for_each_atom(f)),
            Expr::Xor(l, r) => {
                l.for_each_atom(f);
                r.for_each_atom(f);
            }
        }
    }

    /// The value of the expression when `value` gives that of each atom.
    pub fn eval(&self, value: &mut impl FnMut(&A) -> bool) -> bool {
        match self {
            Expr::Const(c) => *c,
            Expr::Atom(a) => value(a),
            Expr::Not(e) => !e.eval(value),
            Expr::And(es) => es.iter().all(|e| e.eval(value)),
            Expr::Or(es) => es.iter().any(|e| e.eval(value)),
            Expr::Xor(l, r) => l.eval(value) != r.eval(value),
        }
    }

    /// Writes the expression with the operators `not and or xor` or their IEC spelling; `atom`
    /// writes an atom. Only the parentheses that precedence demands are written.
    pub fn write(
        &self,
        f: &mut impl fmt::Write,
        words: &Words,
        atom: &mut impl FnMut(&A, &mut dyn fmt::Write) -> fmt::Result,
    ) -> fmt::Result {
        self.write_at(f, words, atom, 0)
    }

    fn write_at<W: fmt::Write>(
        &self,
        f: &mut W,
        words: &Words,
        atom: &mut impl FnMut(&A, &mut dyn fmt::Write) -> fmt::Result,
        outer: u8,
    ) -> fmt::Result {
        let level = match self {
            Expr::Or(_) => 1,
            Expr::Xor(..) => 2,
            Expr::And(_) => 3,
            Expr::Not(_) => 4,
            Expr::Const(_) | Expr::Atom(_) => 5,
        };
        // Equal levels nest only below `xor`, where parentheses help the reader.
        let parenthesise = level < outer || (level == outer && level == 2);
        if parenthesise {
            f.write_char('(')?;
        }
        match self {
            Expr::Const(c) => f.write_str(if *c { words.t } else { words.f })?,
            Expr::Atom(a) => atom(a, f)?,
            Expr::Not(e) => {
                f.write_str(words.not)?;
                f.write_char(' ')?;
                e.write_at(f, words, atom, level)?;
            }
            Expr::And(es) => separated(f, words.and, es.iter(), |f, e| e.write_at(f, words, atom, level))?,
            Expr::Or(es) => separated(f, words.or, es.iter(), |f, e| e.write_at(f, words, atom, level))?,
            Expr::Xor(l, r) => {
                separated(f, words.xor, [&**l, &**r].into_iter(), |f, e| e.write_at(f, words, atom, level))?
            }
        }
        if parenthesise {
            f.write_char(')')?;
        }
        Ok(())
    }
}

fn separated<W: fmt::Write, T>(
    f: &mut W,
    word: &str,
    items: impl Iterator<Item = T>,
    mut each: impl FnMut(&mut W, T) -> fmt::Result,
) -> fmt::Result {
    for (i, item) in items.enumerate() {
        if i > 0 {
            write!(f, " {word} ")?;
        }
        each(f, item)?;
    }
    Ok(())
}

/// The spelling of operators and constants.
pub struct Words {
    not: &'static str,
    and: &'static str,
    or: &'static str,
    xor: &'static str,
    t: &'static str,
    f: &'static str,
}

/// As a model writes them.
pub const CHART: Words = Words { not: "not", and: "and", or: "or", xor: "xor", t: "true", f: "false" };

/// As IEC 61131-3 writes them; the precedence is the same (table 52).
pub const IEC: Words = Words { not: "NOT", and: "AND", or: "OR", xor: "XOR", t: "TRUE", f: "FALSE" };

#[cfg(test)]
mod tests {
    use super::*;

    fn show(e: &Expr<char>) -> String {
        let mut s = String::new();
        e.write(&mut s, &CHART, &mut |a, f| f.write_char(*a)).unwrap();
        s
    }

    #[test]
    fn only_needed_parentheses_are_written() {
        let a = || Expr::Atom('a');
        let b = || Expr::Atom('b');
        let c = || Expr::Atom('c');
        assert_eq!(show(&Expr::all([a(), Expr::any([b(), c()])])), "a and (b or c)");
        assert_eq!(show(&Expr::any([a(), Expr::all([b(), c()])])), "a or b and c");
        assert_eq!(show(&Expr::any([a(), b()]).not()), "not (a or b)");
        assert_eq!(show(&Expr::xor(a(), Expr::xor(b(), c()))), "a xor (b xor c)");
        assert_eq!(show(&Expr::all([a(), Expr::all([b(), c()])])), "a and b and c");
    }
}
