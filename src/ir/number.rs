//! Integer expressions over values of any kind, and how two of them are compared.
//!
//! As with [`Expr`](super::expr::Expr), one type serves the text of a model, the machine and the PLC
//! project; only the values differ. A sum takes any number of operands, so a long chain is wide and
//! not deep; depth is bounded by the nesting limit of the source. It is computed from left to right,
//! and no part of it leaves the type INT of IEC 61131-3: [`Number::range`] says what it can be.

use std::fmt;

/// An integer expression over values `A`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Number<A> {
    /// A constant.
    Const(i64),
    /// The value of something.
    Value(A),
    /// The sum of the operands from left to right; what is [negative](Operand::negative) is
    /// subtracted, the first one from 0. At least one operand.
    Sum(Vec<Operand<A>>),
}

/// One operand of a sum.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Operand<A> {
    /// Whether it is subtracted.
    pub negative: bool,
    /// What is added or subtracted.
    pub value: Number<A>,
}

/// All integers from the lowest to the highest, both included; never empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Range {
    /// The lowest.
    pub lowest: i64,
    /// The highest.
    pub highest: i64,
}

impl Range {
    /// What a variable of the type INT can hold.
    pub const INT: Range = Range { lowest: -32_768, highest: 32_767 };

    /// The range of one value.
    pub fn of(value: i64) -> Range {
        Range { lowest: value, highest: value }
    }

    /// Whether all of `other` lies within it.
    pub fn holds(&self, other: Range) -> bool {
        self.lowest <= other.lowest && other.highest <= self.highest
    }
}

impl<A> Number<A> {
    /// The same expression over other values, or the first failure; `f` may put a whole expression
    /// for a value.
    pub fn try_map<B, E>(&self, f: &mut impl FnMut(&A) -> Result<Number<B>, E>) -> Result<Number<B>, E> {
        Ok(match self {
            Number::Const(n) => Number::Const(*n),
            Number::Value(a) => f(a)?,
            Number::Sum(operands) => Number::Sum(
                operands
                    .iter()
                    .map(|o| Ok(Operand { negative: o.negative, value: o.value.try_map(f)? }))
                    .collect::<Result<_, E>>()?,
            ),
        })
    }

    /// Its value when `value` gives that of each of its parts.
    pub fn eval(&self, value: &impl Fn(&A) -> i64) -> i64 {
        match self {
            Number::Const(n) => *n,
            Number::Value(a) => value(a),
            Number::Sum(operands) => operands.iter().fold(0, |sum, o| {
                let value = o.value.eval(value);
                if o.negative { sum - value } else { sum + value }
            }),
        }
    }

    /// Calls `f` with every value, from left to right, repetitions included.
    pub fn for_each_value<'a>(&'a self, f: &mut impl FnMut(&'a A)) {
        match self {
            Number::Const(_) => {}
            Number::Value(a) => f(a),
            Number::Sum(operands) => operands.iter().for_each(|o| o.value.for_each_value(f)),
        }
    }

    /// How many constants and values it mentions.
    pub fn size(&self) -> usize {
        match self {
            Number::Const(_) | Number::Value(_) => 1,
            Number::Sum(operands) => operands.iter().map(|o| o.value.size()).sum(),
        }
    }

    /// What it can be when `range` says what each value can be; nothing if a part of it can leave
    /// the type INT.
    pub fn range(&self, range: &impl Fn(&A) -> Range) -> Option<Range> {
        let range = match self {
            Number::Const(n) => Range::of(*n),
            Number::Value(a) => range(a),
            Number::Sum(operands) => {
                let mut sum = Range::of(0);
                for operand in operands {
                    let r = operand.value.range(range)?;
                    sum = if operand.negative {
                        Range { lowest: sum.lowest - r.highest, highest: sum.highest - r.lowest }
                    } else {
                        Range { lowest: sum.lowest + r.lowest, highest: sum.highest + r.highest }
                    };
                    // A single operand that is subtracted is subtracted from 0.
                    if !Range::INT.holds(sum) {
                        return None;
                    }
                }
                sum
            }
        };
        Range::INT.holds(range).then_some(range)
    }

    /// Writes the expression; `value` writes a value.
    pub fn write(
        &self,
        f: &mut dyn fmt::Write,
        value: &mut dyn FnMut(&A, &mut dyn fmt::Write) -> fmt::Result,
    ) -> fmt::Result {
        let Number::Sum(operands) = self else {
            return match self {
                Number::Const(n) => write!(f, "{n}"),
                Number::Value(a) => value(a, f),
                Number::Sum(_) => Ok(()),
            };
        };
        for (i, operand) in operands.iter().enumerate() {
            f.write_str(match (i, operand.negative) {
                (0, false) => "",
                (0, true) => "-",
                (_, false) => " + ",
                (_, true) => " - ",
            })?;
            match &operand.value {
                // Two signs side by side would be read as something else, or not at all.
                Number::Sum(_) => {
                    f.write_char('(')?;
                    operand.value.write(f, value)?;
                    f.write_char(')')?;
                }
                Number::Const(n) if *n < 0 && operand.negative => write!(f, "({n})")?,
                Number::Const(_) | Number::Value(_) => operand.value.write(f, value)?,
            }
        }
        Ok(())
    }
}

/// How two numbers are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Relation {
    /// `=`
    Equal,
    /// `<>`
    Unequal,
    /// `<`
    Less,
    /// `<=`
    LessOrEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterOrEqual,
}

impl Relation {
    /// All of them.
    pub const ALL: [Relation; 6] = [
        Relation::Equal,
        Relation::Unequal,
        Relation::Less,
        Relation::LessOrEqual,
        Relation::Greater,
        Relation::GreaterOrEqual,
    ];

    /// As models and IEC 61131-3 write it.
    pub fn symbol(self) -> &'static str {
        match self {
            Relation::Equal => "=",
            Relation::Unequal => "<>",
            Relation::Less => "<",
            Relation::LessOrEqual => "<=",
            Relation::Greater => ">",
            Relation::GreaterOrEqual => ">=",
        }
    }

    /// Whether it holds between two numbers.
    pub fn holds(self, left: i64, right: i64) -> bool {
        match self {
            Relation::Equal => left == right,
            Relation::Unequal => left != right,
            Relation::Less => left < right,
            Relation::LessOrEqual => left <= right,
            Relation::Greater => left > right,
            Relation::GreaterOrEqual => left >= right,
        }
    }

    /// Whether it holds, whatever the two numbers of these ranges are; nothing if that depends on
    /// them.
    pub fn decided(self, left: Range, right: Range) -> Option<bool> {
        let less = || match (left.highest < right.lowest, left.lowest >= right.highest) {
            (true, _) => Some(true),
            (_, true) => Some(false),
            _ => None,
        };
        let greater = || match (left.lowest > right.highest, left.highest <= right.lowest) {
            (true, _) => Some(true),
            (_, true) => Some(false),
            _ => None,
        };
        let equal = || {
            if left.highest < right.lowest || left.lowest > right.highest {
                return Some(false);
            }
            (left.lowest == right.highest && left.highest == right.lowest).then_some(true)
        };
        match self {
            Relation::Equal => equal(),
            Relation::Unequal => equal().map(|e| !e),
            Relation::Less => less(),
            Relation::GreaterOrEqual => less().map(|l| !l),
            Relation::Greater => greater(),
            Relation::LessOrEqual => greater().map(|g| !g),
        }
    }
}

/// A comparison of two integer expressions.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Comparison<A> {
    /// What stands on the left.
    pub left: Number<A>,
    /// How it is compared.
    pub relation: Relation,
    /// What stands on the right.
    pub right: Number<A>,
}

impl<A> Comparison<A> {
    /// Whether it holds when `value` gives that of each of its parts.
    pub fn holds(&self, value: &impl Fn(&A) -> i64) -> bool {
        self.relation.holds(self.left.eval(value), self.right.eval(value))
    }

    /// Writes the comparison; `value` writes a value.
    pub fn write(
        &self,
        f: &mut dyn fmt::Write,
        value: &mut dyn FnMut(&A, &mut dyn fmt::Write) -> fmt::Result,
    ) -> fmt::Result {
        self.left.write(f, value)?;
        write!(f, " {} ", self.relation.symbol())?;
        self.right.write(f, value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(n: &Number<char>) -> String {
        let mut out = String::new();
        n.write(&mut out, &mut |c, f| f.write_char(*c)).unwrap();
        out
    }

    #[test]
    fn sums_are_written_as_they_are_computed() {
        let plus = |value| Operand { negative: false, value };
        let minus = |value| Operand { negative: true, value };
        let a = || Number::Value('a');
        let inner = Number::Sum(vec![plus(a()), minus(Number::Const(1))]);
        assert_eq!(text(&Number::Sum(vec![minus(a()), minus(inner), plus(Number::Const(-3))])), "-a - (a - 1) + -3");
    }

    #[test]
    fn a_range_is_known_or_leaves_int() {
        let plus = |value| Operand { negative: false, value };
        let minus = |value| Operand { negative: true, value };
        let range = |_: &char| Range { lowest: -3, highest: 30_000 };
        let of = |operands| Number::Sum(operands).range(&range);
        let a = || Number::Value('a');
        assert_eq!(of(vec![minus(a())]), Some(Range { lowest: -30_000, highest: 3 }));
        assert_eq!(of(vec![plus(a()), minus(a())]), Some(Range { lowest: -30_003, highest: 30_003 }));
        // The sum of the first two is too large, whatever is taken away then.
        assert_eq!(of(vec![plus(a()), plus(a()), minus(a())]), None);
        assert_eq!(Number::<char>::Const(32_768).range(&range), None);
    }

    #[test]
    fn ranges_decide_comparisons_exactly() {
        let ranges: Vec<Range> = (-2..=2).flat_map(|l| (l..=2).map(move |h| Range { lowest: l, highest: h })).collect();
        for &left in &ranges {
            for &right in &ranges {
                for relation in Relation::ALL {
                    let mut seen = [false; 2];
                    for l in left.lowest..=left.highest {
                        for r in right.lowest..=right.highest {
                            seen[usize::from(relation.holds(l, r))] = true;
                        }
                    }
                    let expected = match seen {
                        [true, true] => None,
                        [_, value] => Some(value),
                    };
                    assert_eq!(relation.decided(left, right), expected, "{left:?} {relation:?} {right:?}");
                }
            }
        }
    }
}
